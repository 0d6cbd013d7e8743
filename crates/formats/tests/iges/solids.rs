//! Random solids that OpenCASCADE wrote, as solids (186) and as trimmed surfaces (144): area and volume are those that it
//! found, and each face is what it reads itself.
//!
//! `tests/oracle/iges_solids.py` makes them. A few stand in `testdata/iges/solids`; `IGES_SOLIDS` names a folder of more.

use crate::common::root;
use crate::opencascade::{difference, rows};
use crate::same_faces::compare;
use std::path::Path;

fn differences(folder: &Path) -> (usize, Vec<String>) {
    let (mut files, mut wrong) = (0, vec![]);
    for row in rows(folder) {
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
            wrong.extend(difference(&document, &row, &path, end == "b"));
            let faces = document.model.faces().len();
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
