//! `isophote convert`, run as a program, in every form of file: what it says it wrote, and what stands there.

use formats::{Colour, Document};
use serde_json::Value;
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// A STEP file of one solid: names and colours of faces and of the whole, and faces without.
const MODEL: &str = "step/attributes.step";

fn model() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../testdata").join(MODEL)
}

/// What the program says of the model written to `name`, and where that is.
fn convert(name: &str) -> (String, PathBuf) {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("convert");
    fs::create_dir_all(&folder).expect("a folder");
    let path = folder.join(name);
    let mut command = Command::new(env!("CARGO_BIN_EXE_isophote"));
    let output = command.arg("convert").arg(model()).arg("--out").arg(&path).output().expect("isophote starts");
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).expect("UTF-8");
    let (said, complained) = (text(output.stdout), text(output.stderr));
    assert!(output.status.success(), "{name}: {complained}");
    (said, path)
}

/// The number before a word in what the program says.
fn count(said: &str, word: &str) -> usize {
    let words: Vec<&str> = said.split([' ', ',', '\n']).filter(|word| !word.is_empty()).collect();
    let at = words.iter().position(|own| *own == word).unwrap_or_else(|| panic!("no {word} in {said}"));
    words[at - 1].parse().unwrap_or_else(|_| panic!("no number before {word} in {said}"))
}

fn opened(path: &Path) -> Document {
    formats::open(path).unwrap_or_else(|error| panic!("{error}"))
}

fn names(document: &Document) -> BTreeSet<String> {
    document.attributes.iter().filter_map(|said| said.name.as_deref()).map(str::to_owned).collect()
}

fn colours(document: &Document) -> BTreeSet<Colour> {
    document.attributes.iter().filter_map(|said| said.colour).collect()
}

#[test]
fn surfaces_keep_numbers_names_and_colours() {
    let document = opened(&model());
    assert!(1 < names(&document).len() && 1 < colours(&document).len());
    for name in ["part.json", "part.step", "part.STP"] {
        let (said, path) = convert(name);
        let again = opened(&path);
        assert_eq!(count(&said, "faces"), document.model.faces().len(), "{said}");
        assert_eq!(again.unit, document.unit, "{name}");
        assert_eq!((names(&again), colours(&again)), (names(&document), colours(&document)), "{name}");
        let surfaces = |document: &Document| document.model.surfaces().to_vec();
        assert!(surfaces(&again) == surfaces(&document), "{name}: other control points, knots or weights");
    }
}

#[test]
fn an_obj_has_its_triangles_and_names_its_colours_beside_it() {
    let document = opened(&model());
    let (said, path) = convert("a part.obj");
    let text = fs::read_to_string(&path).expect("text");
    let lines = |keyword: &str| text.lines().filter_map(|line| line.strip_prefix(keyword)).collect::<Vec<_>>();
    assert_eq!(lines("f ").len(), count(&said, "triangles"), "{said}");
    assert_eq!(lines("g ").len(), document.model.faces().len());
    let objects: BTreeSet<String> = lines("o ").into_iter().map(str::to_owned).collect();
    assert_eq!(objects, names(&document).into_iter().map(|name| name.replace(' ', "_")).collect());
    let [library] = lines("mtllib ")[..] else { panic!("one library") };
    let library = fs::read_to_string(path.with_file_name(library)).expect("a library");
    let used: BTreeSet<&str> = lines("usemtl ").into_iter().collect();
    assert!(
        used.iter().all(|name| library.lines().any(|line| line.strip_prefix("newmtl ") == Some(name))),
        "{library}"
    );
    let said_colours: BTreeSet<Colour> =
        used.iter().filter_map(|name| Colour::of_text(&name.replace("colour_", "#"))).collect();
    assert_eq!(said_colours, colours(&document));
}

#[test]
fn an_stl_has_as_many_triangles_as_are_told() {
    let (said, path) = convert("part.stl");
    let bytes = fs::read(path).expect("bytes");
    let count = count(&said, "triangles");
    assert_eq!((bytes.len(), &bytes[80..84]), (84 + 50 * count, &(count as u32).to_le_bytes()[..]));
}

#[test]
fn a_glb_has_its_triangles_under_names_and_colours() {
    let document = opened(&model());
    let (said, path) = convert("part.glb");
    let bytes = fs::read(path).expect("bytes");
    let length = u32::from_le_bytes(bytes[12..16].try_into().expect("four bytes")) as usize;
    let head: Value = serde_json::from_slice(&bytes[20..20 + length]).expect("JSON");
    let texts = |list: &Value| -> BTreeSet<String> {
        list.as_array().into_iter().flatten().filter_map(|item| item["name"].as_str()).map(str::to_owned).collect()
    };
    let nodes = Value::from(head["nodes"].as_array().expect("nodes")[1..].to_vec());
    assert_eq!(texts(&nodes), names(&document));
    assert_eq!(texts(&head["materials"]), colours(&document).iter().map(Colour::to_string).collect());
    let accessors = head["accessors"].as_array().expect("accessors").iter();
    let scalars = accessors.filter(|own| own["type"] == "SCALAR").map(|own| own["count"].as_u64().expect("a count"));
    assert_eq!(scalars.sum::<u64>() as usize, 3 * count(&said, "triangles"), "{said}");
}
