//! The mutation run as CI runs it: a few mutants by chance, each caught; and a change that must survive is not.

use serde_json::Value;
use std::process::{Command, Output};

fn mutants(arguments: &[&str]) -> Output {
    let all = [&["mutants", "--format", "json"], arguments].concat();
    Command::new(env!("CARGO_BIN_EXE_xtask")).args(all).output().expect("xtask starts")
}

fn json(output: &Output) -> Value {
    serde_json::from_slice(&output.stdout).unwrap_or_else(|_| panic!("{}", String::from_utf8_lossy(&output.stderr)))
}

#[test]
fn twelve_mutants_drawn_by_chance_are_all_caught() {
    // The parts whose survivors are all reviewed.
    let program = ["--at", "eval.wgsl", "--at", "fragment.wgsl"];
    let output = mutants(&[&program[..], &["--sample", "12", "--seed", "7"]].concat());
    let report = json(&output);
    assert_eq!((&report["tried"], &report["caught"]), (&12.into(), &12.into()), "{report:#}");
    assert_eq!(output.status.code(), Some(0), "{report:#}");
}

#[test]
fn a_mutant_that_computes_the_same_survives_by_its_written_reason_alone() {
    // Turning e2 round changes signs that are squared.
    let line = pipeline::wgsl::EVAL.text.lines().position(|line| line.contains("let e2 = cross(n, e1);"));
    let place = format!("eval.wgsl:{}", line.expect("the line is there") + 1);
    let output = mutants(&["--at", &place]);
    let report = json(&output);
    assert_eq!(output.status.code(), Some(0), "{report:#}");
    assert!(report["reviewed"]["equivalent"].as_u64() > Some(0), "{report:#}");
    let outcomes = report["mutants"].as_array().expect("a list");
    let survived = outcomes.iter().filter(|m| m["outcome"].get("survived").is_some()).count();
    assert_eq!(Some(survived as u64), report["reviewed"]["equivalent"].as_u64());
    assert!(survived < outcomes.len(), "{report:#}");
}

#[test]
fn a_place_where_nothing_stands_is_refused_by_name() {
    let output = mutants(&["--at", "nowhere.wgsl"]);
    assert_eq!(output.status.code(), Some(2));
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(message.contains("nowhere.wgsl") && message.contains("eval.wgsl"), "{message}");
}
