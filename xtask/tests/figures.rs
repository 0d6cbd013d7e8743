//! The papers' figures, drawn small.

use serde_json::Value;
use std::path::Path;
use std::process::{Command, Output};

fn xtask(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_xtask")).args(arguments).output().expect("xtask starts")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

#[test]
fn numbers_out_of_their_domain_are_refused_by_name() {
    for arguments in [["kanai", "--cells", "0"], ["mutants", "--jobs", "0"]] {
        let output = xtask(&arguments);
        let message = text(&output.stderr);
        assert!(output.status.code() == Some(2) && message.contains(arguments[1]), "{arguments:?}: {message}");
    }
}

/// Kanai's Fig. 3: per-fragment normals follow the surface, interpolated ones do not.
#[test]
fn fragment_normals_are_closer_than_interpolated_ones() {
    let out = Path::new(env!("CARGO_TARGET_TMPDIR")).join("kanai");
    let output =
        xtask(&["kanai", "surface", "--size", "96x96", "--format", "json", "--out", out.to_str().expect("UTF-8")]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let report: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let median = |which: &str| report[which]["median_deg"].as_f64().expect("a number");
    assert!(median("fragment_normals") < median("vertex_normals"), "{report}");
    for name in ["vertex-normals", "fragment-normals", "raycast", "beside"] {
        assert!(out.join(format!("{name}.png")).exists());
    }
}

/// Geiger's Figs. 17, 32 and 33.
#[test]
fn geiger_s_figures_are_drawn_and_timed() {
    let out = Path::new(env!("CARGO_TARGET_TMPDIR")).join("geiger");
    let output =
        xtask(&["geiger", "islands", "--rounds", "1", "--format", "json", "--out", out.to_str().expect("UTF-8")]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let report: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let bytes = |i: usize| report["by_side"][i]["bytes"].as_u64().expect("a number");
    assert_eq!((bytes(0), bytes(5)), (64 * 64, 2048 * 2048), "{report}");
    assert!(
        report["by_chords"].as_array().is_some_and(|rows| rows.iter().all(|row| row["gpu_ms"].as_f64() > Some(0.0)))
    );
    for name in ["fig17.png", "zoom.png"] {
        assert!(std::fs::metadata(out.join(name)).expect("a picture").len() > 1000, "{name}");
    }
}
