//! Random solids that OpenCASCADE wrote, as solids (186) and as trimmed surfaces (144): area and volume are those that it
//! found, and each face is what it reads itself.
//!
//! `tests/oracle/iges_solids.py` makes them. A few stand in `testdata/iges/solids`; `IGES_SOLIDS` names a folder of more.

use crate::common::root;
use crate::green::area_and_volume;
use crate::same_faces::compare;
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
        for end in ["b", "f"] {
            files += 1;
            let path = folder.join(format!("{}_{end}.igs", row["name"].as_str().expect("a name")));
            let document = match formats::open(&path) {
                Ok(document) => document,
                Err(error) => {
                    wrong.push(error.to_string());
                    continue;
                }
            };
            // Trimmed surfaces do not say which side is out.
            let is_solid = end == "b";
            let known = |v: DVec2| if is_solid { v } else { DVec2::new(v.x, 0.0) };
            let expected = DVec2::new(number("area"), number("volume"));
            let found = area_and_volume(&document.model);
            let tolerance = document.model.faces()[0].tolerance * DVec2::new(expected.x.sqrt(), expected.x);
            let error = (known((found - expected).abs() - tolerance) / expected).max_element();
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
            // Some faces OpenCASCADE converts to loops that do not close: then its conversion says nothing.
            if formats::read(path.with_extension("json")).map_or(true, |oracle| oracle.faces().len() != faces) {
                eprintln!("{}: not compared", path.display());
                continue;
            }
            let same = compare(&path, &path.with_extension("json"));
            let sides = same.lines.iter().filter(|line| line.contains(" inside "));
            wrong.extend(sides.map(|line| format!("{}: {line}", path.display())));
            if same.compared < 100 * faces {
                wrong.push(format!("{}: {} sides compared of {faces} faces", path.display(), same.compared));
            }
        }
    }
    (files, wrong)
}

#[test]
fn solids_of_opencascade_are_what_it_reads_itself() {
    let named = std::env::var_os("IGES_SOLIDS").map(|folder| Path::new(&folder).to_owned());
    let (files, wrong) = differences(&named.unwrap_or_else(|| root().join("testdata/iges/solids")));
    assert!(0 < files && wrong.is_empty(), "{} of {files} differ:\n{}", wrong.len(), wrong.join("\n"));
}
