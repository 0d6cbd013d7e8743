//! Levels as layers: by number, by the name that a function gives, and by a list.

use crate::common::models;
use crate::corpus;
use crate::writer::{INDEPENDENT, Writer};
use formats::{Document, FORMATS};

fn read(w: &Writer) -> Document {
    let iges = FORMATS.iter().find(|format| format.name() == "IGES").expect("it is in the list");
    iges.read(w.file().as_bytes(), "part.igs").unwrap_or_else(|error| panic!("{error}"))
}

fn layers(document: &Document) -> Vec<Vec<&str>> {
    document.attributes.iter().map(|said| said.layers.iter().map(|layer| &**layer).collect()).collect()
}

/// Spheres on these levels.
fn spheres(w: &mut Writer, levels: &[i32]) {
    let center = w.point([0.0; 3]);
    for level in levels {
        let sphere = w.add(196, 0, &format!("{center},1.0"));
        w.set_status(sphere, INDEPENDENT);
        w.set_level(sphere, *level);
    }
}

#[test]
fn a_level_is_called_by_its_function_else_by_its_number() {
    let mut w = Writer::new();
    let list = w.add(406, 1, "3,7,40,7");
    let function = w.add(406, 3, "2,0,5HNiete");
    w.set_level(function, 7);
    spheres(&mut w, &[0, 7, 40, -(list as i32)]);
    let document = corpus::opened(["iges", "igs"], "levels", &w.file());
    assert_eq!(layers(&document), [vec![], vec!["Niete"], vec!["40"], vec!["Niete", "40"]]);
    assert_eq!(document.notes, []);
}

#[test]
fn a_face_is_on_its_own_level_before_that_of_its_surface_and_of_its_group() {
    for (own, surface, group, expected) in [(1, 2, 3, "1"), (0, 2, 3, "2"), (0, 0, 3, "3")] {
        let mut w = Writer::new();
        let center = w.point([0.0; 3]);
        let sphere = w.add(196, 0, &format!("{center},1.0"));
        w.set_level(sphere, surface);
        let face = w.trimmed(sphere, 0, &[]);
        w.set_level(face, own);
        let members = w.add(402, 7, &format!("1,{face}"));
        w.set_level(members, group);
        assert_eq!(layers(&read(&w)), [[expected]]);
    }
}

/// A list that is none, and one of too many levels, are told; the faces are drawn.
#[test]
fn levels_that_are_not_kept_are_told() {
    let mut w = Writer::new();
    let many: String = (1..=100).map(|level| format!(",{level}")).collect();
    let many = w.add(406, 1, &format!("100{many}"));
    let short = w.add(406, 1, "3,7");
    spheres(&mut w, &[-(many as i32), -(short as i32), -9999, -5]);
    let document = read(&w);
    let counts: Vec<usize> = layers(&document).iter().map(Vec::len).collect();
    assert_eq!(counts, [64, 0, 0, 0]);
    let notes: Vec<String> = document.notes.iter().map(ToString::to_string).collect();
    assert_eq!(notes.len(), 4, "{notes:?}");
    for reason in ["its levels beyond 64", "counts 3 items", "no directory entry", "no list of levels"] {
        assert_eq!(notes.iter().filter(|note| note.contains(reason)).count(), 1, "{reason}: {notes:?}");
    }
}

#[test]
fn a_real_teapot_is_on_level_four() {
    let Some(folder) = models() else { return };
    let document = formats::open(folder.join("gpucast/teapot.igs")).unwrap_or_else(|error| panic!("{error}"));
    assert!(layers(&document).iter().all(|layers| *layers == ["4"]));
}
