//! What a note says of edges: nothing of those that their trims are, and how far the others are followed.

use crate::cases::cases;
use crate::common::root;
use formats::{Document, FORMATS, NoteKind};

fn told(document: &Document) -> Vec<String> {
    document.notes.iter().filter(|note| note.kind == NoteKind::Approximated).map(ToString::to_string).collect()
}

fn read(text: &str) -> Vec<String> {
    let step = FORMATS.iter().find(|format| format.name() == "STEP").expect("it is in the list");
    told(&step.read(text.as_bytes(), "part.step").unwrap_or_else(|error| panic!("{error}")))
}

fn case(name: &str) -> String {
    cases().into_iter().find(|case| case.name == name).expect("a case").text
}

/// Circles on planes, and around a cylinder: their trims are the edges themselves.
#[test]
fn exact_edges_are_told_of_by_nobody() {
    for name in ["cylinder-rings", "cylinder-seam", "cone-apex", "ball-cut", "torus"] {
        assert_eq!(read(&case(name)), Vec::<String>::new(), "{name}");
    }
}

#[test]
fn an_ellipse_on_a_cylinder_is_followed_and_told() {
    let told = read(&case("oblique-cut"));
    assert!(told.len() == 1 && told[0].contains("2 edges of 1 faces"), "{told:?}");
}

/// The lid of a cylinder is a hundredth of a tolerance above its edge: that is no exact edge.
#[test]
fn an_edge_beside_its_plane_is_told() {
    let text = case("cylinder-rings");
    let at = text.rfind("CARTESIAN_POINT('',(0.0,0.0,5.0))").expect("the lid's origin");
    let moved = format!("{}{}", &text[..at], text[at..].replacen("5.0))", "5.000000001))", 1));
    let told = read(&moved);
    assert!(
        told.len() == 1 && told[0].contains("1 edges of 1 faces") && told[0].contains("at most 1.0e-9 from them"),
        "{told:?}"
    );
}

/// A curve in the file's own (u, v) is no spline in a cylinder's rational parameters: it is followed there, and that is told.
#[test]
fn a_given_curve_that_is_no_spline_on_its_surface_is_told() {
    let folder = root().join("testdata/step/solids");
    let mut given = 0;
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if !path.file_name().unwrap().to_string_lossy().ends_with("_p.step") {
            continue;
        }
        let document = formats::open(&path).unwrap_or_else(|error| panic!("{error}"));
        given += usize::from(!told(&document).is_empty());
    }
    assert!(0 < given, "{given}");
}
