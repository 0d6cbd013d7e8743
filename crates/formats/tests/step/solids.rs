//! Random solids that OpenCASCADE wrote, with (u, v) curves and without: area and volume are those that it found.
//!
//! `tests/oracle/step_solids.py` makes them. A few stand in `testdata/step/solids`; `STEP_SOLIDS` names a folder of more.

use crate::common::root;
use crate::green::area_and_volume;
use glam::DVec2;
use serde_json::Value;
use std::path::Path;

/// Relative error of area and volume, beside what the file's tolerance all over the surface comes to: OpenCASCADE
/// integrates over trims that it approximates itself.
const ERROR: f64 = 2e-5;

fn differences(folder: &Path) -> (usize, Vec<String>) {
    let text =
        std::fs::read_to_string(folder.join("solids.json")).unwrap_or_else(|e| panic!("{}: {e}", folder.display()));
    let rows: Vec<Value> = serde_json::from_str(&text).expect("a list");
    let (mut files, mut wrong) = (0, vec![]);
    for row in rows {
        let number = |key: &str| row[key].as_f64().expect("a number");
        let expected = DVec2::new(number("area"), number("volume"));
        for end in ["p", "n"] {
            files += 1;
            let path = folder.join(format!("{}_{end}.step", row["name"].as_str().expect("a name")));
            let document = match formats::open(&path) {
                Ok(document) => document,
                Err(error) => {
                    wrong.push(error.to_string());
                    continue;
                }
            };
            let found = area_and_volume(&document.model);
            let tolerance = document.model.faces()[0].tolerance * DVec2::new(expected.x.sqrt(), expected.x);
            let error = (((found - expected).abs() - tolerance) / expected).max_element();
            let faces = document.model.faces().len();
            if error > ERROR || error.is_nan() || faces as f64 != number("faces") {
                let notes: Vec<String> = document.notes.iter().map(ToString::to_string).collect();
                wrong.push(format!(
                    "{}: {faces} faces of {}, off by {error:.1e}: {found} for {expected}; {}",
                    path.display(),
                    number("faces"),
                    notes.join("; ")
                ));
            }
        }
    }
    (files, wrong)
}

#[test]
fn solids_of_opencascade_have_its_area_and_volume() {
    let named = std::env::var_os("STEP_SOLIDS").map(|folder| Path::new(&folder).to_owned());
    let (files, wrong) = differences(&named.unwrap_or_else(|| root().join("testdata/step/solids")));
    assert!(0 < files && wrong.is_empty(), "{} of {files} differ:\n{}", wrong.len(), wrong.join("\n"));
}
