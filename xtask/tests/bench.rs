//! `bench --suite tessellation` on the smallest of its models.

use serde_json::Value;
use std::process::Command;

fn suite(more: &[&str]) -> Value {
    let output = Command::new(env!("CARGO_BIN_EXE_xtask"))
        .args(["bench", "--suite", "tessellation", "--format", "json", "--size", "64x48", "--error", "0.5"])
        .args(["--frames", "3", "--seconds", "0.001"])
        .args(more)
        .output()
        .expect("it runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("one JSON document")
}

#[test]
fn each_technique_has_a_line_on_each_renderer_beside_the_papers_numbers() {
    let report = suite(&["--patches", "26", "--only", "tea-s1"]);
    let lines = report["lines"].as_array().unwrap();
    assert_eq!(lines.len(), 18, "three techniques draw the cup's flat triangles in three ways on two renderers");
    // As the paper draws: levels up to L = 4, and normals of the corners, at two errors.
    let as_there = |line: &&Value| line["level"] == 5 && line["vertex_normals"] == true;
    assert_eq!(lines.iter().filter(as_there).count(), 12);
    let has_gpu = report["adapter"].is_string() && report["driver"].is_string();
    for line in lines {
        assert_eq!((&line["model"], &line["patches"]), (&"tea-s1".into(), &26.into()));
        let cost = &line["cost"];
        if line["renderer"] == "gpu" {
            assert_eq!(cost.is_object(), has_gpu, "{line}");
            assert_eq!(line["not_timed"].is_string(), !has_gpu);
            // One view of 96 bytes a face: a size that does not depend on how many triangles there are.
            assert!(!has_gpu || cost["bytes_uploaded"].as_u64().unwrap() % 26 == 0);
        } else {
            assert!(cost["frame_ms"].as_f64().unwrap() > 0.0);
        }
        assert!(line["triangles"].as_u64().unwrap() > 0 && line["set_up_ms"].as_f64().unwrap() > 0.0);
    }
    let counts = report["counts"].as_array().unwrap();
    assert_eq!(counts.len(), 1);
    // Level 4 is 31 x 31 cells of two triangles on 26 surfaces, over 1,024, built and counted.
    assert_eq!(counts[0]["uniform_4"].as_f64(), Some((26 * 2 * 31 * 31) as f64 / 1024.0));
    let adaptive = counts[0]["adaptive"].as_array().unwrap();
    assert!(adaptive.iter().all(|pair| pair[1][0].as_f64().unwrap() < counts[0]["uniform_4"].as_f64().unwrap()));
    assert!(adaptive.iter().all(|pair| pair[1][0].as_f64().unwrap() <= pair[1][1].as_f64().unwrap()));
}

#[test]
fn a_size_or_a_limit_that_is_none_is_refused() {
    for wrong in [
        ["--only", "teapot"],
        ["--level", "12"],
        ["--batch", "0"],
        ["--emit", "3"],
        ["--size", "64"],
        ["--size", "0x5"],
        ["--patches", "25"],
        ["--patches", "200000"],
    ] {
        let command =
            Command::new(env!("CARGO_BIN_EXE_xtask")).args(["bench", "--suite", "tessellation"]).args(wrong).output();
        assert_eq!(command.expect("it runs").status.code(), Some(2), "{wrong:?}");
    }
}
