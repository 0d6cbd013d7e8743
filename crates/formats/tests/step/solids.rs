//! Random solids that OpenCASCADE wrote, with (u, v) curves and without: area and volume are those that it found.
//!
//! `tests/oracle/step_solids.py` makes them. A few stand in `testdata/step/solids`; `STEP_SOLIDS` names a folder of more.

use crate::common::root;
use crate::opencascade::{difference, rows};
use std::path::Path;

fn differences(folder: &Path) -> (usize, Vec<String>) {
    let (mut files, mut wrong) = (0, vec![]);
    for row in rows(folder) {
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
            wrong.extend(difference(&document, &row, &path, true));
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
