//! The project's own files: area and volume of each are those of their closed form.

use crate::cases::cases;
use crate::closed::Case;
use crate::corpus;
use crate::green::area_and_volume;
use formats::Document;
use scene::Model;

/// Relative error of area and volume.
const ERROR: f64 = 1e-9;

fn opened(case: &Case) -> Document {
    corpus::opened(["iges", "igs"], case.name, &case.text)
}

#[test]
fn areas_and_volumes_are_those_of_the_closed_form() {
    let mut wrong = vec![];
    for case in cases() {
        let document = opened(&case);
        let found = area_and_volume(&document.model);
        let off = |found: f64, expected: f64| (found / expected - 1.0).abs();
        let error = off(found.x, case.area).max(case.volume.map_or(0.0, |volume| off(found.y, volume)));
        eprintln!("{}: {} faces, off by {error:.1e}", case.name, document.model.faces().len());
        let lost = document.notes.iter().any(|note| note.kind.is_loss());
        if document.model.faces().len() != case.faces || error > ERROR || error.is_nan() || lost {
            let notes: Vec<String> = document.notes.iter().map(ToString::to_string).collect();
            let expected = (case.area, case.volume);
            wrong.push(format!("{}: {found} for {expected:?}; {}", case.name, notes.join("; ")));
        }
    }
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
}

/// The check itself is tried: a face turned round changes the volume.
#[test]
fn a_face_turned_round_changes_the_volume() {
    let case = cases().into_iter().find(|case| case.name == "oblique-cut").unwrap();
    let model = opened(&case).model;
    for k in 0..2 {
        let mut faces = model.faces().to_vec();
        faces[k].reversed = !faces[k].reversed;
        let wrong = Model::new("wrong", model.surfaces().to_vec(), faces).unwrap();
        let found = area_and_volume(&wrong);
        assert!((found.x / case.area - 1.0).abs() < ERROR, "{found}");
        assert!((found.y / case.volume.unwrap() - 1.0).abs() > 0.1, "face {k}: {found}");
    }
}

#[test]
fn units_are_those_that_the_file_names() {
    let units = [("cylinder-seam", "millimetre", 1.0), ("cone-inch", "inch", 25.4), ("assembly", "inch", 25.4)];
    for (name, unit, millimetres) in units.into_iter().chain([("cylinder-terse", "centimetre at scale 0.5", 20.0)]) {
        let case = cases().into_iter().find(|case| case.name == name).unwrap();
        let found = opened(&case).unit.unwrap();
        assert_eq!((found.name.as_str(), found.millimetres), (unit, millimetres), "{name}");
    }
}
