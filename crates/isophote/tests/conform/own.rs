//! A user's own corpus: a line a file, and a bad one ends nothing.

use crate::setting::folder;
use isophote::conform::report::{Report, State};
use isophote::conform::{html, junit, table};
use std::path::Path;
use std::process::Command;

const SQUARE: &str = r#"{"format": "nurbs-neutral", "version": 1, "surfaces": [{"degree": [1, 1], "nu": 2, "nv": 2,
    "knots_u": [0, 0, 1, 1], "knots_v": [0, 0, 1, 1], "weights": null,
    "points": [[-1, -1, 0], [-1, 1, 0], [1, -1, 0], [1, 1, 0.5]]}]}"#;

fn conform(arguments: &[&str], out: &Path) -> Option<i32> {
    let output = Command::new(env!("CARGO_BIN_EXE_isophote"))
        .args(["conform", "--format", "json", "--out", out.to_str().expect("UTF-8")])
        .args(arguments)
        // Without a GPU, the CPU rasterizer is judged.
        .env("VK_DRIVER_FILES", "/nonexistent.json")
        .env("VK_ICD_FILENAMES", "/nonexistent.json")
        .output()
        .expect("isophote starts");
    output.status.code()
}

#[test]
fn a_bad_file_is_a_line_of_its_own_everywhere_and_the_others_are_judged() {
    let models = folder("own-models");
    std::fs::create_dir(models.join("more")).expect("a folder");
    std::fs::write(models.join("more/square.json"), SQUARE).expect("written");
    std::fs::write(models.join("cut.json"), &SQUARE[..100]).expect("written");
    std::fs::write(models.join("notes.txt"), "no model").expect("written");
    let out = folder("own");
    assert_eq!(conform(&["--models", models.to_str().expect("UTF-8")], &out), Some(2));
    let report = Report::read(&out.join("report.json")).expect("a report");
    let scenes: Vec<&str> = report.scenes.iter().map(|scene| scene.name.rsplit('/').next().expect("a name")).collect();
    assert_eq!(scenes, ["cut.json", "square.json"], "sorted, and no text");
    let (bad, good): (Vec<_>, Vec<_>) = report.cases.iter().partition(|case| case.error.is_some());
    assert_eq!((bad.len(), good.len()), (1, techniques::ALL.len()));
    let cpu = &report.subjects[0].id;
    assert!(report.outcomes(cpu).all(|(_, outcome)| outcome.state() == State::Agree), "{}", table::text(&report));
    // The words of the reader stand in each document.
    let words = "line 2";
    let junit = String::from_utf8(junit::xml(&report).expect("XML")).expect("UTF-8");
    for (name, text) in
        [("table", table::text(&report)), ("junit", junit), ("html", html::page(&report).expect("a page"))]
    {
        assert!(text.contains("cut.json/framed/") && text.contains(words), "{name}: {text}");
    }
    assert!(good[0].options.contains("square.json --eye "), "{}", good[0].options);
}

#[test]
fn a_pattern_that_matches_nothing_is_no_success() {
    assert_eq!(conform(&["--models", "no-such-*.step"], &folder("own-nothing")), Some(2));
}
