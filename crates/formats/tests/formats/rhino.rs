//! Files of Rhino against what rhino3dm says of them (`tests/oracle/make_3dm.py`), and against damage.

use crate::common::{models, outline, root, winding};
use formats::{Document, FORMATS, Format, NoteKind, Place, open};
use glam::{DVec2, DVec3};
use proptest::prelude::*;
use scene::FaceId;
use serde_json::Value;
use std::path::PathBuf;

/// Points along each side of a face in the answers.
const SIDE: usize = 20;

fn parts(version: u32) -> PathBuf {
    root().join(format!("testdata/3dm/parts-{version}.3dm"))
}

fn answers_of(name: &str) -> Vec<Value> {
    let text = std::fs::read_to_string(root().join(format!("testdata/3dm/{name}.json"))).unwrap();
    serde_json::from_str(&text).unwrap()
}

fn answers() -> Vec<Value> {
    answers_of("parts")
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect()
}

/// A share of a range, counted in steps.
fn between([start, end]: [f64; 2], k: f64, steps: f64) -> f64 {
    start + (end - start) * (k / steps)
}

/// What differs from the answers, one line a face; empty where nothing does.
fn differences(document: &Document, answers: &[Value]) -> Vec<String> {
    let model = &document.model;
    let mut found = vec![];
    if model.faces().len() != answers.len() {
        found.push(format!("{} faces, {} by rhino3dm", model.faces().len(), answers.len()));
    }
    for (k, (face, answer)) in model.faces().iter().zip(answers).enumerate() {
        let name = format!("face {k}, {}", answer["object"]);
        let surface = model.surface(FaceId(k as u32));
        let domain = numbers(&answer["domain"]);
        let theirs = [[domain[0], domain[1]], [domain[2], domain[3]]];
        let points: Vec<DVec3> = numbers(&answer["points"]).chunks(3).map(DVec3::from_slice).collect();
        let size = points.iter().map(|p| p.abs().max_element()).fold(1.0, f64::max);
        if face.reversed != answer["reversed"].as_bool().unwrap() {
            found.push(format!("{name}: reversed {}", face.reversed));
        }
        // Planes that we make for caps have other borders: there (u, v) follows from the point.
        let is_same = surface.domain() == theirs;
        if !is_same && surface.degree() != [1, 1] {
            found.push(format!("{name}: domain {:?}", surface.domain()));
            continue;
        }
        let [[u0, u1], [v0, v1]] = surface.domain();
        let corner = surface.point(u0, v0);
        let [along_u, along_v] = [surface.point(u1, v0) - corner, surface.point(u0, v1) - corner];
        let flat = |p: DVec3| {
            let d = p - corner;
            let normal = along_u.cross(along_v);
            let a = d.cross(along_v).dot(normal) / normal.length_squared();
            let b = along_u.cross(d).dot(normal) / normal.length_squared();
            DVec2::new(u0 + (u1 - u0) * a, v0 + (v1 - v0) * b)
        };
        let mut worst: f64 = 0.0;
        for (i, p) in points.iter().enumerate() {
            let [u, v] = [theirs[0], theirs[1]];
            let steps = SIDE as f64 - 1.0;
            let on_theirs = DVec2::new(between(u, (i / SIDE) as f64, steps), between(v, (i % SIDE) as f64, steps));
            let uv = if is_same { on_theirs } else { flat(*p) };
            worst = worst.max(surface.point(uv.x, uv.y).distance(*p));
        }
        if worst > 1e-10 * size {
            found.push(format!("{name}: {worst:e} off"));
        }
        let Some(inside) = answer["inside"].as_str() else { continue };
        let at = |i: usize, j: usize| points[i * SIDE + j];
        let (low, high_u, high_v) = (at(0, 0), at(SIDE - 1, 0), at(0, SIDE - 1));
        let (mut wrong, sides) = (0, outline(&face.loops));
        for (i, said) in inside.chars().enumerate().filter(|(_, said)| *said != 'x') {
            let (a, b) = ((i / SIDE) as f64 + 0.5, (i % SIDE) as f64 + 0.5);
            let shares = [a, b].map(|k| k / SIDE as f64);
            let uv = if is_same {
                DVec2::new(between(theirs[0], a, SIDE as f64), between(theirs[1], b, SIDE as f64))
            } else {
                flat(low + (high_u - low) * shares[0] + (high_v - low) * shares[1])
            };
            let is_inside = face.loops.is_empty() || winding(&sides, uv) != 0;
            wrong += usize::from(is_inside != (said == '1'));
        }
        if wrong > 0 {
            found.push(format!("{name}: {wrong} of {} points on the wrong side of trims", inside.len()));
        }
    }
    found
}

#[test]
fn faces_of_every_version_are_those_of_rhino3dm() {
    let answers = answers();
    for version in 3..=8 {
        let document = open(parts(version)).unwrap_or_else(|e| panic!("{e}"));
        let found = differences(&document, &answers);
        assert!(found.is_empty(), "version {version}:\n{}", found.join("\n"));
    }
}

#[test]
fn mitred_and_transposed_extrusions_are_those_of_rhino3dm() {
    for name in ["mitred", "transposed"] {
        let document = open(root().join(format!("testdata/3dm/{name}.3dm"))).unwrap_or_else(|e| panic!("{e}"));
        let found = differences(&document, &answers_of(name));
        assert!(found.is_empty(), "{name}:\n{}", found.join("\n"));
        assert_eq!(document.notes, [], "{name}");
    }
}

#[test]
fn a_wrong_answer_is_found() {
    let document = open(parts(8)).unwrap();
    let wrong = |change: &dyn Fn(&mut Vec<Value>)| {
        let mut answers = answers();
        change(&mut answers);
        differences(&document, &answers).len()
    };
    assert_eq!(wrong(&|answers| drop(answers.pop())), 1, "a face too many");
    assert_eq!(wrong(&|answers| answers[1]["reversed"] = true.into()), 1);
    let moved = numbers(&answers()[0]["points"])[300] + 1e-8;
    assert_eq!(wrong(&|answers| answers[0]["points"][300] = moved.into()), 1);
    let plate = answers().iter().position(|face| face["object"] == "plate").unwrap();
    let inside = answers()[plate]["inside"].as_str().unwrap().replacen('1', "0", 1);
    assert_eq!(wrong(&|answers| answers[plate]["inside"] = inside.clone().into()), 1, "a point on the wrong side");
}

#[test]
fn what_is_not_drawn_is_noted_with_its_name_and_its_byte() {
    for version in 3..=8 {
        let document = open(parts(version)).unwrap();
        assert_eq!(document.unit.as_ref().map(|unit| (unit.name.as_str(), unit.millimetres)), Some(("inch", 25.4)));
        let texts: Vec<String> = document.notes.iter().map(ToString::to_string).collect();
        let expected = [
            ("\"under a hidden layer\"", "its layer \"Hidden\" is hidden"),
            ("\"hidden itself\"", "it is hidden"),
            ("ON_Mesh \"mesh\"", "not drawn"),
            ("ON_Point", "not drawn"),
            ("\"wire\"", "not drawn"),
        ];
        for (name, reason) in expected {
            let is_said = |text: &&String| text.contains(name) && text.contains(reason);
            assert_eq!(texts.iter().filter(is_said).count(), 1, "version {version}, {name}: {texts:#?}");
        }
        assert_eq!(texts.len(), expected.len(), "version {version}: {texts:#?}");
        assert!(document.notes.iter().all(|note| note.kind == NoteKind::LeftOut));
        assert!(document.notes.iter().all(|note| matches!(note.place, Place::Byte(at) if at > 32)));
    }
}

#[test]
fn mirrored_blocks_turn_their_other_side_and_edges_are_not_shared_between_copies() {
    let document = open(parts(8)).unwrap();
    let answers = answers();
    let copies: Vec<usize> =
        (0..answers.len()).filter(|k| answers[*k]["object"].as_str().unwrap().contains("bolt")).collect();
    assert_eq!(copies.len(), 3);
    let faces = copies.iter().map(|k| &document.model.faces()[*k]);
    assert_eq!(faces.clone().map(|face| face.reversed).collect::<Vec<_>>(), [false, true, false]);
    let edges: Vec<Vec<i64>> =
        faces.map(|face| face.loops.iter().flat_map(|l| l.trims.iter().filter_map(|t| t.edge)).collect()).collect();
    assert!(edges.iter().all(|edges| !edges.is_empty()));
    assert!(edges[0].iter().all(|edge| !edges[1].contains(edge) && !edges[2].contains(edge)), "{edges:?}");
}

#[test]
fn the_samples_of_rhino_open() {
    let Some(folder) = models() else { return };
    let answers = std::fs::read_to_string(root().join("testdata/3dm/samples.json")).unwrap();
    let answers: Value = serde_json::from_str(&answers).unwrap();
    for (name, unit) in [("nurbssurface.3dm", Some("millimetre")), ("nurbsSurface_r5.3dm", None)] {
        let document = open(folder.join("rhino").join(name)).unwrap_or_else(|e| panic!("{e}"));
        let model = &document.model;
        assert_eq!(model.faces().len(), 1, "{name}");
        let surface = model.surface(FaceId(0));
        assert_eq!((surface.degree(), surface.control_counts()), ([3, 3], [6, 6]), "{name}");
        assert!(!model.faces()[0].loops.is_empty(), "{name}");
        assert!(model.region(FaceId(0)).unwrap().is_whole(), "{name}");
        let found = differences(&document, answers[name].as_array().unwrap());
        assert!(found.is_empty(), "{name}:\n{}", found.join("\n"));
        assert_eq!(document.notes, [], "{name}");
        assert_eq!(document.unit.map(|unit| unit.name).as_deref(), unit, "{name}");
    }
}

/// The identifier of a block of version 8, in the file's own bytes: it stands before a parent's flag, the index and the name.
fn block_id(bytes: &[u8], name: &str) -> Vec<u8> {
    let name: Vec<u8> = name.encode_utf16().flat_map(u16::to_le_bytes).collect();
    let at = bytes.windows(name.len()).position(|part| part == name).unwrap();
    bytes[at - 27..at - 11].to_vec()
}

#[test]
fn a_block_in_itself_ends_with_a_note() {
    let mut bytes = std::fs::read(parts(8)).unwrap();
    let [bolt, nested] = ["bolt", "nested"].map(|name| block_id(&bytes, name));
    let whole = format().read(&bytes, "whole.3dm").unwrap().model.faces().len();
    let places: Vec<usize> = (0..bytes.len() - 16).filter(|k| bytes[*k..k + 16] == bolt).collect();
    // In the table of blocks, and in three references, one of which is in the other block.
    assert_eq!(places.len(), 4);
    for place in &places[1..] {
        bytes[*place..place + 16].copy_from_slice(&nested);
    }
    let document = format().read(&bytes, "cyclic.3dm").unwrap();
    assert_eq!(document.model.faces().len(), whole - 3);
    let deep = |note: &&formats::Note| note.text.contains("blocks stand in blocks more than 16 deep");
    assert_eq!(document.notes.iter().filter(deep).count(), 3, "{:?}", document.notes);
}

fn format() -> &'static dyn Format {
    *FORMATS.iter().find(|format| format.name() == "3DM").unwrap()
}

#[test]
fn another_head_is_refused_by_its_byte() {
    let mut bytes = std::fs::read(parts(8)).unwrap();
    bytes[24..32].copy_from_slice(b"       2");
    let error = format().read(&bytes, "old.3dm").unwrap_err().to_string();
    assert!(error.contains("byte 24") && error.contains("version of an archive"), "{error}");
    let error = format().read(b"3D Geometry", "short.3dm").unwrap_err().to_string();
    assert!(error.contains("byte 0"), "{error}");
    let error = format().read(&bytes[..24], "bare.3dm").unwrap_err().to_string();
    assert!(error.contains("byte 24"), "{error}");
}

#[test]
fn a_file_cut_off_keeps_the_objects_before_that_and_says_so() {
    let bytes = std::fs::read(parts(8)).unwrap();
    let whole = format().read(&bytes, "whole.3dm").unwrap().model.faces().len();
    let document = format().read(&bytes[..bytes.len() / 2], "half.3dm").unwrap();
    let faces = document.model.faces().len();
    assert!(0 < faces && faces < whole, "{faces} of {whole}");
    assert!(
        document.notes.iter().any(|note| note.to_string().contains("the file ends inside it")),
        "{:?}",
        document.notes
    );
    let error = format().read(&bytes[..64], "head.3dm").unwrap_err().to_string();
    assert!(error.contains("nothing in it can be drawn"), "{error}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    #[test]
    fn changed_and_cut_files_give_a_document_or_an_error(
        version in 3u32..=8,
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..12),
        cut in prop::option::of(any::<prop::sample::Index>()),
    ) {
        let mut bytes = std::fs::read(parts(version)).unwrap();
        for (place, byte) in changes {
            let place = place.index(bytes.len());
            bytes[place] = byte;
        }
        if let Some(cut) = cut {
            bytes.truncate(cut.index(bytes.len()));
        }
        if let Err(error) = format().read(&bytes, "changed.3dm") {
            prop_assert!(error.to_string().starts_with("changed.3dm: "));
        }
    }
}

#[test]
fn a_face_has_its_objects_name_and_the_colour_that_its_source_says() {
    for version in [3, 4, 5, 8] {
        let path = root().join(format!("testdata/3dm/colours-{version}.3dm"));
        let document = open(path).unwrap_or_else(|e| panic!("{e}"));
        let said = document.attributes.iter().map(|said| (said.name.as_deref().unwrap(), said.colour.map(|c| c.0)));
        let answers = answers_of("colours");
        let colour = |answer: &Value| -> Option<[u8; 3]> { serde_json::from_value(answer["colour"].clone()).unwrap() };
        let expected = answers.iter().map(|answer| (answer["name"].as_str().unwrap(), colour(answer)));
        assert_eq!(said.collect::<Vec<_>>(), expected.collect::<Vec<_>>(), "version {version}");
    }
    for version in 3..=8 {
        let document = open(parts(version)).unwrap();
        let names = document.attributes.iter().map(|said| said.name.as_deref().unwrap());
        let answers = answers();
        let objects = answers.iter().map(|answer| answer["object"].as_str().unwrap());
        // The answers call what a block shows by the reference that places it.
        let expected = objects.map(|name| if name.contains("bolt") { "shank" } else { name });
        assert_eq!(names.collect::<Vec<_>>(), expected.collect::<Vec<_>>(), "version {version}");
    }
}

#[test]
fn a_face_is_on_its_objects_layer_by_the_path_that_rhino3dm_says() {
    let answers = answers_of("layers");
    let text = |answer: &Value, key: &str| answer[key].as_str().unwrap().to_owned();
    let mut expected: Vec<_> = answers.iter().map(|answer| (text(answer, "name"), text(answer, "layer"))).collect();
    expected.sort();
    for version in [5, 8] {
        let document =
            open(root().join(format!("testdata/3dm/layers-{version}.3dm"))).unwrap_or_else(|e| panic!("{e}"));
        let said = document.attributes.iter();
        let mut found: Vec<_> =
            said.map(|said| (said.name.as_deref().unwrap().to_owned(), said.layers.join("; "))).collect();
        found.sort();
        assert_eq!(found, expected, "version {version}");
    }
}

/// Its path ends, however often it is above itself.
#[test]
fn a_layer_above_itself_has_a_path() {
    let mut bytes = std::fs::read(root().join("testdata/3dm/layers-5.3dm")).unwrap();
    let name: Vec<u8> = "Karosserie\0".encode_utf16().flat_map(u16::to_le_bytes).collect();
    let at = bytes.windows(name.len()).position(|part| part == name).unwrap() + name.len();
    // Visibility, the pattern, colour and weight on paper, whether it is locked; then the layer's own number and its parent's.
    let own = at + 1 + 4 + 4 + 8 + 1;
    bytes.copy_within(own..own + 16, own + 16);
    let document = format().read(&bytes, "cyclic.3dm").unwrap();
    let shell = document.attributes.iter().find(|said| said.name.as_deref() == Some("shell")).unwrap();
    assert_eq!(*shell.layers[0], *["Karosserie"; 64].join("::"));
}

/// A unit and a tolerance that are none are told; no other takes their place in silence.
#[test]
fn a_unit_and_a_tolerance_that_are_none_are_told() {
    let good = std::fs::read(parts(5)).unwrap();
    // Code, length, version; then the number of the unit, and the tolerance.
    let code = 0x2000_8031u32.to_le_bytes();
    let is_record = |part: &[u8]| part[..4] == code && (100..110).contains(&part[12]) && part[13..16] == [0; 3];
    let at = 16 + good.windows(32).position(is_record).expect("units");
    let document = format().read(&good, "good.3dm").unwrap();
    assert!(document.unit.is_some() && document.notes.iter().all(|note| !note.text.contains("none is taken")));
    let changed = |offset: usize, new: &[u8]| {
        let mut bytes = good.clone();
        bytes[at + offset..at + offset + new.len()].copy_from_slice(new);
        let document = format().read(&bytes, "changed.3dm").unwrap();
        let told = document.notes.iter().filter(|note| note.kind == NoteKind::Healed).map(ToString::to_string);
        (document.unit.is_some(), told.filter(|note| note.contains("none is taken")).collect::<Vec<_>>())
    };
    let (has_unit, told) = changed(0, &77i32.to_le_bytes());
    assert!(!has_unit && told.len() == 1 && told[0].contains("there is no unit 77"), "{told:?}");
    assert_eq!(changed(0, &0i32.to_le_bytes()), (false, vec![]), "a file may have no unit");
    for tolerance in [f64::NAN, -1.0, f64::INFINITY] {
        let (has_unit, told) = changed(4, &tolerance.to_le_bytes());
        assert!(has_unit && told.len() == 1 && told[0].contains("a tolerance of "), "{tolerance}: {told:?}");
    }
}
