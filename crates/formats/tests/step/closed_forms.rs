//! The project's own files: area and volume of each are those of their closed form.

use crate::cases::{Case, cases};
use crate::corpus;
use crate::green::area_and_volume;
use formats::Document;
use glam::DVec2;
use scene::Model;

/// Relative error of area and volume.
const ERROR: f64 = 1e-9;

fn opened(case: &Case) -> Document {
    corpus::opened(["step", "step"], case.name, &case.text)
}

#[test]
fn areas_and_volumes_are_those_of_the_closed_form() {
    let mut wrong = vec![];
    for case in cases() {
        let document = opened(&case);
        let found = area_and_volume(&document.model);
        let expected = DVec2::new(case.area, case.volume);
        let error = ((found - expected) / expected).abs().max_element();
        eprintln!("{}: {} faces, off by {error:.1e}", case.name, document.model.faces().len());
        if document.model.faces().len() != case.faces || error > ERROR || error.is_nan() {
            let notes: Vec<String> = document.notes.iter().map(ToString::to_string).collect();
            wrong.push(format!("{}: {found} for {expected}; {}", case.name, notes.join("; ")));
        }
    }
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
}

/// The check itself is tried: a face turned round, and a hole filled, change what it finds.
#[test]
fn a_face_turned_round_changes_the_volume() {
    let case = cases().into_iter().find(|case| case.name == "oblique-cut").unwrap();
    let model = opened(&case).model;
    for k in 0..model.faces().len() {
        let mut faces = model.faces().to_vec();
        faces[k].reversed = !faces[k].reversed;
        let wrong = Model::new("wrong", model.surfaces().to_vec(), faces).unwrap();
        let found = area_and_volume(&wrong);
        assert!((found.x / case.area - 1.0).abs() < ERROR, "{found}");
        // The bottom lies in a plane with the origin, and adds nothing.
        assert!(k == 2 || (found.y / case.volume - 1.0).abs() > 0.1, "face {k}: {found}");
    }
}
