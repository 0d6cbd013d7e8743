//! `conform merge`: shards joined, and each way in which they may not belong together.

use crate::setting::{AGREEING, DIFFERING, folder};
use std::path::PathBuf;
use std::process::{Command, Output};
use xtask::conform::corpus::{Shard, Suite};
use xtask::conform::merge::merged;
use xtask::conform::report::{Report, State};

/// The part of a whole report that a shard would have measured.
fn shard(whole: &Report, index: usize, count: usize) -> (Report, PathBuf) {
    let mut part = whole.clone();
    part.shard = Shard { index, count };
    part.sources[0].shard = part.shard;
    let place = |name: &str| whole.scenes.iter().position(|scene| scene.name == name).expect("a scene");
    part.cases.retain(|case| part.shard.holds(place(&case.key.scene)));
    (part, PathBuf::from(format!("shard-{index}.json")))
}

fn shards(whole: &Report) -> Vec<(Report, PathBuf)> {
    (1..=3).map(|index| shard(whole, index, 3)).collect()
}

fn refused(reports: &[(Report, PathBuf)], words: &[&str]) {
    let message = format!("{:#}", merged(reports).expect_err("they do not belong together"));
    assert!(words.iter().all(|word| message.contains(word)), "{message}");
}

#[test]
fn shards_in_any_order_make_the_whole() {
    let mut parts = shards(&AGREEING);
    assert!(parts.iter().all(|(part, _)| part.cases.len() == 1 && part.state() == State::Agree));
    parts.rotate_left(1);
    let whole = merged(&parts).expect("they belong together");
    assert_eq!((&whole.cases, &whole.subjects), (&AGREEING.cases, &AGREEING.subjects));
    assert_eq!((whole.state(), whole.sources.len(), whole.shard), (State::Agree, 3, Shard::WHOLE));
    assert_eq!(merged(&[(whole.clone(), PathBuf::new())]).expect("once more").cases, whole.cases);
}

#[test]
fn adapters_of_two_machines_stand_side_by_side() {
    let mut other = DIFFERING.clone();
    other.subjects[1].id = "another card".to_owned();
    other.subjects[1].name = "another card".to_owned();
    other.sources[0].subjects[1] = "another card".to_owned();
    for case in &mut other.cases {
        case.outcomes[1].subject = "another card".to_owned();
    }
    let both = merged(&[(AGREEING.clone(), "a".into()), (other, "b".into())]).expect("they belong together");
    let states: Vec<State> = both.subjects.iter().map(|subject| both.state_of(subject)).collect();
    assert_eq!((states, both.state()), (vec![State::Agree, State::Agree, State::Differ], State::Differ));
    assert!(both.cases.iter().all(|case| case.outcomes.len() == 3));
}

#[test]
fn a_missing_shard_is_named_and_the_rest_is_kept() {
    let mut parts = shards(&AGREEING);
    parts.remove(1);
    let partial = merged(&parts).expect("they belong together");
    assert_eq!((partial.state(), partial.cases.len()), (State::NotRun, 2));
    assert!(partial.notes[0].contains("shard 2/3 is missing"), "{:?}", partial.notes);
    assert_eq!(partial.missing(&partial.subjects[1].id)[0].scene, "repeated-knots");
}

#[test]
fn a_shard_that_is_there_twice_is_refused_with_both_files() {
    let mut parts = shards(&AGREEING);
    parts.push((parts[1].0.clone(), "again.json".into()));
    refused(&parts, &["shard 2/3", "twice", "shard-2.json", "again.json"]);
    let halves = vec![shard(&AGREEING, 1, 3), shard(&AGREEING, 1, 2)];
    refused(&halves, &["pole/above", "twice"]);
}

#[test]
fn other_programs_suites_and_corpora_are_refused() {
    let with = |change: fn(&mut Report)| {
        let mut parts = shards(&AGREEING);
        change(&mut parts[2].0);
        parts
    };
    refused(&with(|part| part.program = "9.9.9".to_owned()), &["shard-3.json", "9.9.9", "shard-1.json"]);
    refused(&with(|part| part.suite = Suite::Full), &["shard-3.json", "full", "smoke"]);
    refused(&with(|part| part.scenes[0].unbounded_share = 0.5), &["shard-3.json", "another corpus"]);
}

#[test]
fn a_cpu_that_gives_two_answers_is_refused() {
    let mut other = AGREEING.clone();
    other.subjects.truncate(1);
    for case in &mut other.cases {
        case.outcomes.truncate(1);
    }
    assert!(merged(&[(AGREEING.clone(), "a".into()), (other.clone(), "b".into())]).is_ok());
    other.cases[1].outcomes[0].pairs[0].position.max *= 1.5;
    refused(&[(AGREEING.clone(), "a".into()), (other, "b".into())], &["two answers", "repeated-knots"]);
}

fn merge(name: &str, files: &[(&str, String)]) -> Output {
    let folder = folder(name);
    let paths: Vec<PathBuf> = files.iter().map(|(name, _)| folder.join(name)).collect();
    for (path, (_, text)) in paths.iter().zip(files) {
        std::fs::write(path, text).expect("a file can be written");
    }
    let mut command = Command::new(env!("CARGO_BIN_EXE_xtask"));
    command.args(["conform", "merge"]).args(&paths).arg("--out").arg(folder.join("merged"));
    command.output().expect("xtask starts")
}

#[test]
fn exit_codes_tell_agreement_difference_and_partial_apart() {
    let text = |report: &Report| serde_json::to_string(report).expect("JSON");
    let parts: Vec<String> = shards(&AGREEING).iter().map(|(part, _)| text(part)).collect();
    let [a, b, c] = [0, 1, 2].map(|i| parts[i].clone());
    let cases = [
        ("merge-0", vec![("a.json", a.clone()), ("b.json", b.clone()), ("c.json", c.clone())], 0, "all agree"),
        ("merge-1", vec![("whole.json", text(&DIFFERING))], 1, "DIFFERS"),
        ("merge-2", vec![("a.json", a.clone()), ("c.json", c)], 2, "shard 2/3 is missing"),
    ];
    for (name, files, code, words) in cases {
        let output = merge(name, &files);
        let said = String::from_utf8_lossy(&output.stdout);
        assert_eq!(output.status.code(), Some(code), "{name}: {said} {}", String::from_utf8_lossy(&output.stderr));
        assert!(said.contains(words), "{name}: {said}");
    }
    let damaged = [
        ("cut.json", a[..a.len() / 2].to_owned(), "cut off"),
        ("empty.json", String::new(), "cut off"),
        ("foreign.json", "{\"model\": \"teapot\"}".to_owned(), "not a conformance report"),
        ("picture.json", "\u{89}PNG".to_owned(), "not JSON"),
        ("later.json", a.replacen("\"schema_version\":1", "\"schema_version\":7", 1), "schema_version 7"),
        ("changed.json", a.replacen("\"covered\":", "\"covert\":", 1), "damaged"),
        (
            "stray.json",
            a.replacen("\"cases\":[{\"key\":{\"scene\":\"pole\"", "\"cases\":[{\"key\":{\"scene\":\"hole\"", 1),
            "not planned",
        ),
    ];
    for (file, content, words) in damaged {
        let output = merge(&format!("merge-{file}"), &[("b.json", b.clone()), (file, content)]);
        let message = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{file}: {message}");
        assert!(
            message.contains(file) && message.contains(words) && !message.contains("panicked"),
            "{file}: {message}"
        );
    }
}
