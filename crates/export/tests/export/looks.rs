//! Names and colours in every form that has a place for them, read back by lines that know the form's own description.

use crate::bytes::glb;
use crate::{beside, document, usual, write};
use formats::{Colour, Document, json};
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};

/// Colours of faces, of bodies and of layers, names of the same, and faces that have neither.
const MODELS: [&str; 3] = ["step/attributes.step", "iges/looks.igs", "3dm/colours-8.3dm"];

/// Faces on a layer, on two, on one of a path, and on none.
const LAYERED: [&str; 2] = ["step/layers.step", "3dm/layers-8.3dm"];

/// What is said of a face: its name and colour.
type Look = (Option<String>, Option<Colour>);

/// How many triangles the faces of each look have, as the document and its mesh say.
fn expected(document: &Document) -> BTreeMap<Look, usize> {
    let mesh = export::mesh::mesh(&document.model, usual(&document.model), &|_| {}).expect("a mesh");
    let mut looks = BTreeMap::new();
    for (face, said) in mesh.faces.iter().zip(&document.attributes) {
        let look = (said.name.as_deref().map(str::to_owned), said.colour);
        *looks.entry(look).or_default() += face.triangles.len();
    }
    looks
}

/// The same, as an OBJ and the library that it names say.
fn of_obj(text: &str, library: &str) -> BTreeMap<Look, usize> {
    let (mut colours, mut named) = (BTreeMap::new(), "");
    for line in library.lines() {
        match line.split_once(' ').expect("a keyword") {
            ("newmtl", name) => named = name,
            ("Kd", parts) => {
                let parts: Vec<f64> = parts.split(' ').map(|part| part.parse().expect("a number")).collect();
                colours.insert(named, Colour::of_parts(parts.try_into().expect("three parts")).expect("a colour"));
            }
            other => panic!("{other:?}"),
        }
    }
    let (mut name, mut colour, mut looks) = (None, None, BTreeMap::new());
    for line in text.lines() {
        match line.split_once(' ').expect("a keyword") {
            ("o", own) => name = Some(own.to_owned()),
            ("usemtl", "uncoloured") => colour = None,
            ("usemtl", own) => colour = Some(colours[own]),
            ("f", _) => *looks.entry((name.clone(), colour)).or_default() += 1,
            _ => {}
        }
    }
    looks
}

/// The same, as a glTF says.
fn of_glb(head: &Value) -> BTreeMap<Look, usize> {
    let list = |value: &Value| value.as_array().cloned().unwrap_or_default();
    let mut looks = BTreeMap::new();
    for child in list(&head["nodes"][0]["children"]) {
        let node = &head["nodes"][child.as_u64().expect("a node") as usize];
        let name = node["name"].as_str().map(str::to_owned);
        for primitive in list(&head["meshes"][node["mesh"].as_u64().expect("a mesh") as usize]["primitives"]) {
            let material = primitive["material"].as_u64().map(|at| &head["materials"][at as usize]);
            let colour = material.map(|material| {
                let parts = list(&material["pbrMetallicRoughness"]["baseColorFactor"]);
                let light = [0, 1, 2].map(|k| parts[k].as_f64().expect("a number"));
                let part = |x: f64| if x <= 0.0031308 { 12.92 * x } else { 1.055 * x.powf(1.0 / 2.4) - 0.055 };
                Colour::of_parts(light.map(part)).expect("a colour")
            });
            let indices = primitive["indices"].as_u64().expect("an accessor") as usize;
            let count = head["accessors"][indices]["count"].as_u64().expect("a count") as usize;
            *looks.entry((name.clone(), colour)).or_default() += count / 3;
        }
    }
    looks
}

#[test]
fn triangles_keep_the_names_and_colours_of_their_faces() {
    for name in MODELS {
        let document = document(name);
        let error = usual(&document.model);
        let looks = expected(&document);
        assert!(1 < looks.len() && looks.keys().any(|(_, colour)| colour.is_some()), "{name}: {looks:?}");
        let (bytes, written) = write(&document, "obj", error).expect("written");
        let (library, materials) = beside(&document, "obj", error).expect("a library");
        let text = String::from_utf8(bytes).expect("text");
        assert!(text.lines().any(|line| line == format!("mtllib {library}")), "{name}");
        assert!(written.notes.iter().any(|note| note.contains(&library)), "{name}: {:?}", written.notes);
        let materials = String::from_utf8(materials).expect("text");
        let words = |look: &Look| (look.0.as_ref().map(|name| name.replace(' ', "_")), look.1);
        let in_words: BTreeMap<Look, usize> = looks.iter().map(|(look, count)| (words(look), *count)).collect();
        assert_eq!(of_obj(&text, &materials), in_words, "{name}");
        // A colour that is another one is seen.
        let grey = |line: &str| if line.starts_with("Kd") { "Kd 0.25 0.25 0.25\n".into() } else { format!("{line}\n") };
        assert_ne!(of_obj(&text, &materials.lines().map(grey).collect::<String>()), in_words, "{name}");
        let (bytes, _) = write(&document, "glb", error).expect("written");
        let mut head = glb(&bytes).0;
        assert_eq!(of_glb(&head), looks, "{name}");
        head["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"][1] = 0.5.into();
        assert_ne!(of_glb(&head), looks, "{name}");
    }
}

/// Primitives have their own part of each buffer: together they are all of it, and no number is beyond its own corners.
#[test]
fn primitives_of_a_glb_share_its_bytes_out() {
    for name in MODELS {
        let document = document(name);
        let (bytes, _) = write(&document, "glb", usual(&document.model)).expect("written");
        let (head, body) = glb(&bytes);
        let number = |value: &Value| value.as_u64().unwrap_or(0) as usize;
        let accessor = |at: &Value| &head["accessors"][number(at)];
        let mut covered: [BTreeSet<(usize, usize)>; 3] = Default::default();
        for primitive in
            head["meshes"].as_array().expect("meshes").iter().flat_map(|m| m["primitives"].as_array().expect("a list"))
        {
            let parts =
                [&primitive["attributes"]["POSITION"], &primitive["attributes"]["NORMAL"], &primitive["indices"]];
            for (view, part) in parts.into_iter().enumerate() {
                let (own, size) = (accessor(part), if view == 2 { 4 } else { 12 });
                assert_eq!(number(&own["bufferView"]), view);
                covered[view]
                    .insert((number(&own["byteOffset"]), number(&own["byteOffset"]) + size * number(&own["count"])));
            }
            let (indices, corners) = (accessor(parts[2]), number(&accessor(parts[0])["count"]));
            let start = number(&head["bufferViews"][2]["byteOffset"]) + number(&indices["byteOffset"]);
            let corner = |k: usize| {
                u32::from_le_bytes(body[start + 4 * k..start + 4 * k + 4].try_into().expect("four")) as usize
            };
            assert!((0..number(&indices["count"])).all(|k| corner(k) < corners), "{name}");
        }
        for (view, parts) in covered.iter().enumerate() {
            let end = parts.iter().fold(0, |end, (a, b)| if *a == end { *b } else { usize::MAX });
            assert_eq!(end, number(&head["bufferViews"][view]["byteLength"]), "{name}: {parts:?}");
        }
    }
}

/// How many triangles are on each set of layers.
type Layered = BTreeMap<Vec<String>, usize>;

fn layered_of_obj(text: &str) -> Layered {
    let (mut layers, mut all) = (vec![], Layered::new());
    for line in text.lines() {
        match line.split_once(' ') {
            Some(("g", groups)) => {
                layers =
                    groups.split(' ').filter_map(|group| group.strip_prefix("layer_")).map(str::to_owned).collect();
            }
            Some(("f", _)) => *all.entry(layers.clone()).or_default() += 1,
            _ => {}
        }
    }
    all
}

fn layered_of_glb(head: &Value) -> Layered {
    let mut all = Layered::new();
    for node in head["nodes"].as_array().expect("nodes").iter().skip(1) {
        let named = node["extras"]["layers"].as_array().cloned().unwrap_or_default();
        let layers: Vec<String> = named.iter().map(|layer| layer.as_str().expect("a name").to_owned()).collect();
        let mesh = &head["meshes"][node["mesh"].as_u64().expect("a mesh") as usize];
        for primitive in mesh["primitives"].as_array().expect("primitives") {
            let indices = primitive["indices"].as_u64().expect("an accessor") as usize;
            let count = head["accessors"][indices]["count"].as_u64().expect("a count") as usize;
            *all.entry(layers.clone()).or_default() += count / 3;
        }
    }
    all
}

#[test]
fn triangles_are_on_the_layers_of_their_faces() {
    for name in LAYERED {
        let document = document(name);
        let error = usual(&document.model);
        let mesh = export::mesh::mesh(&document.model, error, &|_| {}).expect("a mesh");
        let mut expected = Layered::new();
        for (face, said) in mesh.faces.iter().zip(&document.attributes) {
            let layers = said.layers.iter().map(|layer| layer.to_string()).collect();
            *expected.entry(layers).or_default() += face.triangles.len();
        }
        assert!(3 <= expected.len(), "{name}: {expected:?}");
        let (bytes, _) = write(&document, "glb", error).expect("written");
        assert_eq!(layered_of_glb(&glb(&bytes).0), expected, "{name}");
        let words = |layers: &[String]| layers.iter().map(|layer| layer.replace(' ', "_")).collect();
        let in_words: Layered = expected.iter().map(|(layers, count)| (words(layers), *count)).collect();
        let text = String::from_utf8(write(&document, "obj", error).expect("written").0).expect("text");
        assert_eq!(layered_of_obj(&text), in_words, "{name}");
        // A face that is on no layer is seen.
        assert_ne!(layered_of_obj(&text.replacen(" layer_", " other_", 1)), in_words, "{name}");
    }
}

#[test]
fn what_has_no_place_in_a_file_is_told() {
    let layered = document("3dm/layers-8.3dm");
    let (_, written) = write(&layered, "stl", usual(&layered.model)).expect("written");
    assert!(written.notes.iter().any(|note| note.contains("names, colours and layers")), "{:?}", written.notes);
    let named = document("step/attributes.step");
    let (_, written) = write(&named, "stl", usual(&named.model)).expect("written");
    assert!(written.notes.iter().any(|note| note.contains("names and colours")), "{:?}", written.notes);
    let plain = document("plate");
    assert!(beside(&plain, "obj", usual(&plain.model)).is_none());
    for form in ["stl", "obj", "glb"] {
        let (_, written) = write(&plain, form, usual(&plain.model)).expect("written");
        assert!(!written.notes.iter().any(|note| note.contains("colour")), "{form}: {:?}", written.notes);
    }
}

#[test]
fn the_json_says_all_that_the_document_does() {
    for name in MODELS.into_iter().chain(LAYERED).chain(["step/cone-inch-degree.step", "plate"]) {
        let document = document(name);
        let (bytes, written) = write(&document, "json", 1.0).expect("written");
        let text = String::from_utf8(bytes).expect("text");
        let again = json::document(&text, "again.json").unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(written.notes, Vec::<String>::new(), "{name}");
        let said = |document: &Document| (document.unit.clone(), document.attributes.clone());
        assert_eq!((said(&again), again.model.hash()), (said(&document), document.model.hash()), "{name}");
        assert_eq!(json::write_document(&again).expect("written"), text, "{name}");
    }
}
