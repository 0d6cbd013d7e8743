//! Dawn plays what wgpu plays: the Node program of `hosts/node`, where it and its package are there.

use serde_json::Value;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// Set where Dawn must be there, as in CI: then a test without it fails.
const NEEDED: &str = "ISOPHOTE_NEED_DAWN";

/// A driver that Dawn takes as it is; where Debian's chromium has none, the system's own are tried.
const SWIFTSHADER: &str = "/usr/lib/chromium/vk_swiftshader_icd.json";

fn host() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../hosts/node")
}

/// Whether Node and the package are there; where they are not, says plainly that `test` does not run.
fn is_there(test: &str) -> bool {
    let node = Command::new("node").arg("--version").output().is_ok_and(|output| output.status.success());
    let there = node && host().join("node_modules/webgpu").is_dir();
    if !there {
        assert!(std::env::var_os(NEEDED).is_none(), "{NEEDED} is set, and there is no node, or no package webgpu");
        let line = format!("NOT RUN: dawn::{test}: no node with the package webgpu here (npm ci in hosts/node)\n");
        std::io::stderr().write_all(line.as_bytes()).expect("standard error takes a line");
    }
    there
}

/// A program on the driver that both hosts take.
fn run(program: &str, arguments: &[&str]) -> Output {
    let mut command = Command::new(program);
    command.args(arguments);
    if Path::new(SWIFTSHADER).is_file() {
        command.env("VK_ICD_FILENAMES", SWIFTSHADER);
    }
    command.output().expect("it starts")
}

fn isophote(arguments: &[&str]) -> Output {
    run(env!("CARGO_BIN_EXE_isophote"), arguments)
}

fn said(output: &Output) -> String {
    [&output.stdout, &output.stderr].map(|text| String::from_utf8_lossy(text)).concat()
}

fn folder(name: &str) -> PathBuf {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("dawn").join(name);
    let _ = std::fs::remove_dir_all(&path);
    std::fs::create_dir_all(&path).expect("a folder can be made");
    path
}

#[test]
fn a_capsule_that_dawn_plays_agrees_with_the_rays() {
    if !is_there("a_capsule_that_dawn_plays_agrees_with_the_rays") {
        return;
    }
    let folder = folder("plays");
    let at = |name: &str| folder.join(name).display().to_string();
    let play = host().join("play.mjs").display().to_string();
    let scenes = [["teapot", "--technique", "fragment"], ["sphere", "--technique", "exact"]];
    for (scene, technique) in scenes.map(|scene| (scene, scene[2])) {
        let (capsule, answer, picture) = (at("capsule"), at("answer"), at("dawn.npz"));
        let recorded = isophote(&[&["capsule"][..], &scene, &["--size", "48x48", "--out", &capsule]].concat());
        assert!(recorded.status.success(), "{}", said(&recorded));
        let played = run("node", &[&play, &capsule, "--out", &answer]);
        assert!(played.status.success(), "{}", said(&played));
        let read = isophote(&["capsule", "read", &capsule, "--answer", &answer, "--gbuffer", &picture]);
        assert!(read.status.success(), "{}", said(&read));
        let judged = isophote(&["compare", &picture, "--technique", technique]);
        assert!(judged.status.success(), "{}", said(&judged));
        let document = std::fs::read(folder.join("answer/answer.json")).expect("an answer");
        let document: Value = serde_json::from_slice(&document).expect("JSON");
        assert_eq!(document["host"]["compiler"], "tint");
    }
}

#[test]
fn dawn_refuses_a_capsule_with_a_flipped_byte() {
    if !is_there("dawn_refuses_a_capsule_with_a_flipped_byte") {
        return;
    }
    let folder = folder("flipped");
    let at = |name: &str| folder.join(name).display().to_string();
    let recorded = isophote(&["capsule", "sphere", "--size", "8x8", "--out", &at("capsule")]);
    assert!(recorded.status.success(), "{}", said(&recorded));
    let file = folder.join("capsule/module-0.wgsl");
    let mut bytes = std::fs::read(&file).expect("a shader");
    bytes[7] ^= 1;
    std::fs::write(&file, bytes).expect("a file can be written");
    let play = host().join("play.mjs").display().to_string();
    let played = run("node", &[&play, &at("capsule"), "--out", &at("answer")]);
    assert_eq!(played.status.code(), Some(1), "{}", said(&played));
    assert!(said(&played).contains("module-0.wgsl: hash"), "{}", said(&played));
    assert!(!folder.join("answer/answer.json").exists());
}

#[test]
fn a_host_that_is_not_there_is_named_and_never_a_pass() {
    let folder = folder("absent");
    let out = folder.join("out").display().to_string();
    let model = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../testdata/models/teaspoon.json").display().to_string();
    let output = isophote(&["conform", "--models", &model, "--hosts", "dawn", "--dawn", "nowhere", "--out", &out]);
    assert_eq!(output.status.code(), Some(2), "{}", said(&output));
    assert!(said(&output).contains("nowhere/play.mjs is not there"), "{}", said(&output));
}
