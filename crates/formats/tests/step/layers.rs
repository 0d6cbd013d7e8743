//! Layers, against what OpenCASCADE's own reader says (`tests/oracle/step_layers.py`), and those that no writer makes.

use crate::attributes::{discs, finished, mapped, read};
use crate::common::root;
use crate::writer::{Writer, list};
use formats::Document;
use serde_json::Value;

fn layers(document: &Document) -> Vec<Vec<String>> {
    document.attributes.iter().map(|said| said.layers.iter().map(|layer| layer.to_string()).collect()).collect()
}

fn on(w: &mut Writer, layer: &str, items: &[u64]) -> u64 {
    w.add(format_args!("PRESENTATION_LAYER_ASSIGNMENT('{layer}','',{})", list(items)))
}

#[test]
fn faces_are_on_the_layers_that_opencascade_reads() {
    let folder = root().join("testdata/step");
    let answers: Vec<Value> =
        serde_json::from_str(&std::fs::read_to_string(folder.join("layers.json")).unwrap()).unwrap();
    let numbers = |answer: &Value| -> [f64; 3] { serde_json::from_value(answer["centre"].clone()).unwrap() };
    let names = |answer: &Value| -> Vec<String> { serde_json::from_value(answer["layers"].clone()).unwrap() };
    let mut expected: Vec<(String, Vec<String>)> =
        answers.iter().map(|answer| (format!("{:.6?}", numbers(answer)), names(answer))).collect();
    expected.sort();
    let document = formats::open(folder.join("layers.step")).unwrap_or_else(|error| panic!("{error}"));
    let centre = |face: &scene::Face| document.model.surfaces()[face.surface].hull().center() + glam::DVec3::ZERO;
    let centres = document.model.faces().iter().map(|face| format!("{:.6?}", centre(face).to_array()));
    let mut found: Vec<(String, Vec<String>)> = centres.zip(layers(&document)).collect();
    found.iter_mut().for_each(|(_, layers)| layers.sort());
    found.sort();
    assert_eq!(found, expected);
    assert!(expected.iter().any(|(_, layers)| layers.len() == 2) && expected.iter().any(|(_, l)| l.is_empty()));
}

#[test]
fn a_face_is_on_its_own_layers_before_those_of_its_body_and_of_its_instance() {
    let mut w = Writer::new("AUTOMOTIVE_DESIGN");
    let ([low, _], shell, model) = discs(&mut w, ["low", "high"]);
    let (items, _) = mapped(&mut w, model, 2);
    on(&mut w, "placed", &[items[1]]);
    assert_eq!(layers(&read(&w.file())), [vec![], vec![], vec!["placed"], vec!["placed"]]);
    on(&mut w, r"K\X2\00F6\X0\rper", &[shell, shell]);
    on(&mut w, "low", &[low]);
    on(&mut w, "", &[low]);
    on(&mut w, "also", &[low]);
    let found = layers(&read(&w.file()));
    assert_eq!(found, [vec!["low", "also"], vec!["Körper"], vec!["low", "also"], vec!["Körper"]]);
}

/// A layer of too many for one face, and a list that is none, are told; the face is drawn.
#[test]
fn layers_that_are_not_kept_are_told() {
    let mut w = Writer::new("AUTOMOTIVE_DESIGN");
    let ([low, _], _, model) = discs(&mut w, ["low", "high"]);
    (0..100).for_each(|k| _ = on(&mut w, &format!("layer {k}"), &[low]));
    w.add("PRESENTATION_LAYER_ASSIGNMENT('no list','',7)");
    let document = read(&finished(&mut w, model));
    let found = layers(&document);
    assert_eq!((found[0].len(), found[0][63].as_str(), found[1].len()), (64, "layer 63", 0));
    let losses = document.notes.iter().filter(|note| note.kind.is_loss());
    let notes: Vec<String> = losses.map(ToString::to_string).collect();
    assert_eq!(notes.len(), 2, "{notes:?}");
    assert!(
        notes.iter().any(|note| note.contains(&format!("#{low}")) && note.contains("layers beyond 64")),
        "{notes:?}"
    );
    assert!(notes.iter().any(|note| note.contains("PRESENTATION_LAYER_ASSIGNMENT")), "{notes:?}");
}
