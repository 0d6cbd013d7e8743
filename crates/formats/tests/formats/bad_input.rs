//! Bad input of every kind gets a message with the file, the place and the value, and never a panic.

use crate::common::root;
use formats::{Cause, FormatError, MAX_FILE_BYTES, bpt, json, read};
use models::builtin;
use proptest::test_runner::{RngAlgorithm, TestRng};
use scene::{Face, Model};
use std::fs::{self, File};
use std::path::PathBuf;

/// A legal document on many lines, for one piece of it to be replaced.
const GOOD: &str = r#"{"format": "nurbs-neutral", "version": 1, "name": "two",
"surfaces": [
 {"degree": [1, 1], "nu": 2, "nv": 2, "knots_u": [0, 0, 1, 1], "knots_v": [0, 0, 1, 1],
  "points": [[0, 0, 0], [0, 1, 0], [1, 0, 0], [1, 1, 0]], "weights": null},
 {"degree": [2, 1], "nu": 3, "nv": 2, "knots_u": [0.5, 0.5, 0.5, 1.5, 1.5, 1.5], "knots_v": [4, 4, 5, 5],
  "points": [[0, 0, 7], [0, 1, 7], [1, 0, 8], [1, 1, 8], [2, 0, 7], [2, 1, 7]], "weights": [1, 1, 2, 2, 1, 1.5]}
],
"faces": [
 {"surface": 0, "reversed": false, "tolerance": 1e-7, "loops": []},
 {"surface": 1, "reversed": true, "tolerance": 0.0, "loops": [{"outer": true, "trims": [
  {"degree": 1, "knots": [10, 10, 11, 11], "points": [[0.5, 4], [1.5, 4]], "weights": [1, 3], "reversed": false,
   "seam": false, "degenerate": false, "edge": 12},
  {"degree": 1, "knots": [0, 0, 1, 2, 2], "points": [[1.5, 4], [1, 5], [0.5, 4]]}]}]}
]}
"#;

fn message(text: &str) -> String {
    match json::parse(text, "dir/bad.json") {
        Ok(model) => panic!("opened: {model:?}"),
        Err(error) => error.to_string(),
    }
}

/// The message for [`GOOD`] with `old`, which occurs in it, replaced by `new`.
fn after(old: &str, new: &str) -> String {
    assert!(GOOD.contains(old), "{old}");
    message(&GOOD.replacen(old, new, 1))
}

/// Checks that a message names the file and holds each of `parts`.
fn assert_holds(message: &str, parts: &[&str]) {
    assert!(message.starts_with("dir/bad.json: "), "{message}");
    for part in parts {
        assert!(message.contains(part), "no {part:?} in {message:?}");
    }
    // A greatest f64 written out has 309 digits, and a message can name two.
    assert!(message.len() < 800 && !message.ends_with('.'), "{message}");
}

#[test]
fn the_good_document_is_good() {
    json::parse(GOOD, "dir/bad.json").unwrap();
}

#[test]
fn syntax_errors_name_line_column_and_word() {
    let cases: &[(&str, &str, &[&str])] = &[
        ("[0, 1, 0]", "[0, NaN, 0]", &["line 4, column 29", "surfaces[0].points[1][1]", "\"NaN\""]),
        ("[0, 1, 0]", "[0, -Infinity, 0]", &["line 4", "surfaces[0].points[1][1]", "\"-Infinity\""]),
        ("[0, 1, 0]", "[0, Infinity, 0]", &["line 4", "surfaces[0].points[1][1]", "\"Infinity\""]),
        ("1.5]}", "1e999]}", &["line 6", "surfaces[1].weights[5]", "\"1e999\"", "out of range"]),
        ("1.5]}", "-1e999]}", &["surfaces[1].weights[5]", "\"-1e999\""]),
        ("1.5]}", "1.5}", &["line 6", "surfaces[1].weights", "\"}\""]),
        ("\"faces\": [", "\"faces\" [", &["line 8", "faces", "\"[\""]),
        ("\"name\": \"two\"", "\"name\": two", &["line 1", "\"two\""]),
        ("]}\n]}\n", "]}\n]} more", &["line 14", "trailing", "\"more\""]),
        ("\"two\"", "\"two", &["line 1", "name"]),
    ];
    for (old, new, parts) in cases {
        assert_holds(&after(old, new), parts);
    }
    assert_holds(&message(""), &["line 1", "EOF", "the document"]);
    assert_holds(&message("ü"), &["line 1, column 1", "\"ü\""]);
}

#[test]
fn every_truncation_is_an_error_that_names_the_file() {
    let text = GOOD.trim_end();
    for end in 0..text.len() {
        assert_holds(&message(&text[..end]), &["line "]);
    }
    assert_holds(&message(&GOOD[..GOOD.find("1.5, 1.5]").unwrap()]), &["line 5", "surfaces[1].knots_u[4]", "EOF"]);
}

#[test]
fn values_of_the_wrong_kind_are_named_with_line_and_member() {
    let huge = "9".repeat(30);
    let nested = format!("[{}", "[".repeat(10_000));
    let cases: &[(&str, &str, &[&str])] = &[
        ("nurbs-neutral", "gltf", &["line 1", "format: ", "\"gltf\"", "\"nurbs-neutral\""]),
        ("\"version\": 1", "\"version\": 2", &["version: ", "`2`", "version 1"]),
        ("\"version\": 1", "\"version\": \"1\"", &["version: ", "string \"1\""]),
        ("\"name\": \"two\"", "\"unit\": \"inch\"", &["unit: ", "string \"inch\"", "an object"]),
        ("\"name\": \"two\"", "\"unit\": {\"name\": \"inch\"}", &["unit.millimetres: ", "missing"]),
        ("\"surface\": 0", "\"surface\": 0, \"colour\": [1, 0, 0]", &["faces[0].colour: ", "a string"]),
        ("\"format\": \"nurbs-neutral\", ", "", &["format: ", "missing"]),
        ("\"version\": 1, ", "", &["version: ", "missing"]),
        ("\"surfaces\": [", "\"surface\": [", &["line 2", "the document: ", "no key \"surface\""]),
        ("\"degree\": [1, 1], ", "", &["line 4", "surfaces[0].degree: ", "missing"]),
        ("\"knots_v\": [4, 4, 5, 5],", "", &["surfaces[1].knots_v: ", "missing"]),
        ("\"nu\": 2", "\"nu\": null", &["surfaces[0].nu: ", "missing"]),
        ("\"nu\": 2", "\"nu\": 2, \"nu\": 2", &["surfaces[0].nu: ", "twice"]),
        ("\"nu\": 2", "\"nu\": -2", &["line 3", "surfaces[0].nu: ", "`-2`", "whole number"]),
        ("\"nu\": 2", "\"nu\": 2.5", &["surfaces[0].nu: ", "`2.5`"]),
        ("\"nu\": 2", "\"nu\": 1e30", &["surfaces[0].nu: ", "whole number"]),
        ("\"nu\": 2", &format!("\"nu\": {huge}"), &["surfaces[0].nu: ", "whole number"]),
        ("[2, 1]", "[16, 1]", &["line 5", "surfaces[1].degree[0]: ", "`16`", "from 1 to 15"]),
        ("[2, 1]", "[2, 0]", &["surfaces[1].degree[1]: ", "`0`", "from 1 to 15"]),
        ("[2, 1]", "[2, -1]", &["surfaces[1].degree[1]: ", "`-1`"]),
        ("[2, 1]", "[1.5, 1]", &["surfaces[1].degree[0]: ", "`1.5`"]),
        ("[2, 1]", "[2]", &["surfaces[1].degree", "length 1", "a list of 2"]),
        ("[2, 1]", "[2, 1, 1]", &["surfaces[1].degree: ", "length 3", "a list of 2"]),
        ("[0, 1, 7]", "[0, 1]", &["line 6", "surfaces[1].points[1]", "length 2", "a list of 3"]),
        ("[0, 1, 7]", "[0, 1, \"7\"]", &["surfaces[1].points[1][2]: ", "string \"7\""]),
        ("[0, 1, 7]", "[0, null, 7]", &["surfaces[1].points[1][1]: ", "null"]),
        ("[0, 1, 7]", "{}", &["surfaces[1].points[1]: ", "map", "a list of 3"]),
        ("\"weights\": null", "\"weights\": 1", &["surfaces[0].weights: ", "`1`", "a list"]),
        ("\"weights\": null", "\"weights\": [true]", &["surfaces[0].weights[0]: ", "`true`"]),
        ("\"weights\": null", "\"periodic\": [true]", &["surfaces[0].periodic", "a list of 2"]),
        (
            "\"weights\": null",
            "\"knot_convention\": \"long\"",
            &["knot_convention: ", "\"long\"", "\"full\" or \"short\""],
        ),
        ("\"surface\": 1", "\"surface\": -1", &["line 10", "faces[1].surface: ", "`-1`"]),
        ("\"surface\": 0, ", "", &["faces[0].surface: ", "missing"]),
        ("\"outer\": true, ", "", &["faces[1].loops[0].outer: ", "missing"]),
        ("\"reversed\": true", "\"reversed\": 1", &["faces[1].reversed: ", "`1`"]),
        ("\"edge\": 12", "\"edge\": 1.5", &["faces[1].loops[0].trims[0].edge: ", "`1.5`"]),
        ("\"degree\": 1,", "\"degree\": 99,", &["faces[1].loops[0].trims[0].degree: ", "`99`"]),
        ("[0, 0, 1, 1]", &nested, &["surfaces[0].knots_u[0]: ", "sequence"]),
    ];
    for (old, new, parts) in cases {
        assert_holds(&after(old, new), parts);
    }
    assert_holds(&message("[1]"), &["the document: ", "sequence", "an object"]);
    assert_holds(&message(&"[".repeat(1_000_000)), &["the document: ", "sequence"]);
    assert_holds(&after("\"two\"", &format!("[\"{}\"]", "x".repeat(1_000_000))), &["name: "]);
    assert_holds(&after("\"version\": 1", &format!("\"version\": \"{}\"", "x".repeat(1_000_000))), &["xxx", "…"]);
}

#[test]
fn numbers_that_make_no_model_are_named_with_their_member() {
    let cases: &[(&str, &str, &[&str])] = &[
        ("[0, 0, 1, 1]", "[0, 2, 1, 1]", &["surfaces[0].knots_u: ", "knot 2 is 1", "2"]),
        ("[4, 4, 5, 5]", "[4, 4, 4, 4]", &["surfaces[1].knots_v: ", "empty"]),
        ("[4, 4, 5, 5]", "[4, 4, 5]", &["surfaces[1].knots_v has 3 entries", "ask for 4"]),
        ("[4, 4, 5, 5]", "[]", &["surfaces[1].knots_v has 0 entries", "ask for 4"]),
        ("[4, 4, 5, 5]", "[-1e308, -1e308, 1e308, 1e308]", &["surfaces[1].knots_v: ", "overflows"]),
        ("\"nv\": 2", "\"nv\": 3", &["surfaces[0].points has 4 entries", "nu and nv ask for 6"]),
        ("\"nv\": 2", "\"nv\": 0", &["surfaces[0].nv is 0"]),
        ("\"nv\": 2", "\"nv\": 18446744073709551615", &["surfaces[0].points has 4 entries", "18446744073709551615"]),
        ("\"nu\": 2, \"nv\": 2", "\"nu\": 4294967296, \"nv\": 4294967296", &["points has 4 entries"]),
        (", [1, 1, 0]]", "]", &["surfaces[0].points has 3 entries", "ask for 4"]),
        ("[0, 1, 7]", "[0, 1e61, 7]", &["surfaces[1].points: ", "control point 1", "1e61"]),
        ("1, 1.5]", "1, 0]", &["surfaces[1].weights: ", "weight 5 is 0"]),
        ("1, 1.5]", "1, -1.5]", &["surfaces[1].weights: ", "weight 5 is -1.5"]),
        ("1, 1.5]", "1]", &["surfaces[1].weights has 5 entries", "ask for 6"]),
        ("\"weights\": null", "\"weights\": []", &["surfaces[0].weights has 0 entries", "ask for 4"]),
        ("\"name\": \"two\"", "\"unit\": {\"name\": \"x\", \"millimetres\": 0}", &["unit.millimetres is 0"]),
        ("\"surface\": 1", "\"surface\": 1, \"colour\": \"#12345\"", &["faces[1].colour is #12345", "#rrggbb"]),
        ("\"surface\": 1", "\"surface\": 1, \"colour\": \"#+12345\"", &["faces[1].colour is #+12345"]),
        ("\"surface\": 1", "\"surface\": 1, \"kind\": \"plan\"", &["faces[1].kind is plan", "a kind of surface"]),
        ("\"surface\": 1", "\"surface\": 2", &["faces[1].surface: ", "surface 2", "only 2"]),
        ("\"tolerance\": 0.0", "\"tolerance\": -0.5", &["faces[1].tolerance is -0.5"]),
        ("[10, 10, 11, 11]", "[10, 12, 11, 11]", &["faces[1].loops[0].trims[0].knots: ", "knot 2 is 11"]),
        ("[10, 10, 11, 11]", "[10, 10, 11]", &["faces[1].loops[0].trims[0].knots has 3 entries", "ask for 4"]),
        ("[1, 3]", "[1]", &["faces[1].loops[0].trims[0].weights has 1 entries", "ask for 2"]),
        ("[1, 3]", "[1, 0]", &["faces[1].loops[0].trims[0].weights[1] is 0"]),
        ("\"loops\": []", "\"loops\": [{\"outer\": true, \"trims\": []}]", &["faces[0].loops[0].trims is []"]),
        (
            "\"knots_u\": [0, 0, 1, 1]",
            "\"periodic\": [true, false], \"knots_u\": [0, 2, 1]",
            &["surfaces[0].knots_u (unrolled from its period): ", "below the knot before"],
        ),
        (
            "\"knots_u\": [0, 0, 1, 1]",
            "\"periodic\": [true, false], \"knots_u\": [0, 1]",
            &["surfaces[0].knots_u has 2 entries", "ask for 3"],
        ),
        (
            "\"knots_v\": [4, 4, 5, 5]",
            "\"knot_convention\": \"short\", \"knots_v\": [4, 5]",
            &["surfaces[1].knots_u has 6 entries", "short convention", "ask for 4"],
        ),
        (
            "\"knots_u\": [0, 0, 1, 1], \"knots_v\": [0, 0, 1, 1]",
            "\"knot_convention\": \"short\", \"knots_u\": [0, 1], \"knots_v\": [1, 0]",
            &["surfaces[0].knots_v (with its end knots added): ", "knot 2 is 0"],
        ),
    ];
    for (old, new, parts) in cases {
        assert_holds(&after(old, new), parts);
    }
    let empty = |more: &str| format!(r#"{{"format": "nurbs-neutral", "version": 1{more}}}"#);
    assert_holds(&message(&empty(r#", "surfaces": []"#)), &["surfaces is []", "at least one surface"]);
    let (start, end) = (GOOD.find("\"faces\"").unwrap(), GOOD.rfind('}').unwrap());
    assert_holds(&message(&format!("{}\"faces\": []{}", &GOOD[..start], &GOOD[end..])), &["faces: ", "no faces"]);
}

#[test]
fn what_could_not_be_read_back_is_not_written() {
    let surfaces = || builtin("sphere").unwrap().surfaces().to_vec();
    let face = Face { tolerance: f64::NAN, ..Face::whole(0) };
    let error = json::write(&Model::new("a model", surfaces(), vec![face]).unwrap()).unwrap_err().to_string();
    assert!(error.starts_with("a model: faces[0].") && error.contains("tolerance is NaN"), "{error}");
}

const PATCH: &str = "1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16\n";

/// A patch of 16 vertices in the indexed form.
fn indexed() -> String {
    format!("1\n{PATCH}16\n{}", vertices())
}

fn vertices() -> String {
    (0..16).map(|k| format!("{} {} {}.5\n", k / 4, k % 4, k)).collect()
}

fn bpt_message(text: &str) -> String {
    match bpt::parse(text, "dir/bad.json") {
        Ok(model) => panic!("opened: {model:?}"),
        Err(error) => error.to_string(),
    }
}

#[test]
fn both_forms_of_patches_and_both_separators_say_the_same() {
    let plain = bpt::parse(&indexed(), "a.bpt").unwrap();
    let degrees = bpt::parse(&format!("1\n3 3\n{}", vertices()), "a.bpt").unwrap();
    let commas = indexed().replace(' ', ",").replace('\n', "\r\n\r\n");
    assert_eq!(plain, degrees);
    assert_eq!(plain, bpt::parse(&commas, "a.bpt").unwrap());
    let mixed =
        bpt::parse("2\n1 2\n0 0 0\n0 1 0\n0 2 0\n1 0 0\n1 1 0\n1 2 0\n1 1\n0 0 0\n0 1 0\n1 0 0\n1 1 9", "b.bpt");
    let mixed = mixed.unwrap();
    assert_eq!((mixed.name(), mixed.surfaces().len()), ("b.bpt", 2));
    assert_eq!(mixed.surfaces()[0].control_counts(), [2, 3]);
    assert_eq!(mixed.surfaces()[1].point(1.0, 1.0), glam::DVec3::new(1.0, 1.0, 9.0));
}

#[test]
fn bad_patches_are_named_with_line_and_word() {
    let last = "3 3 15.5\n";
    let cases: &[(&str, &str, &[&str])] = &[
        ("1\n1 2", "x\n1 2", &["line 1", "\"x\"", "number of patches"]),
        ("1\n1 2", "0\n1 2", &["line 1", "\"0\"", "above 0"]),
        ("1\n1 2", "-1\n1 2", &["line 1", "\"-1\""]),
        ("1\n1 2", "1.5\n1 2", &["line 1", "\"1.5\""]),
        ("1\n1 2", "99999999999\n1 2", &["line 1", "\"99999999999\"", "18 lines that follow"]),
        ("1\n1 2", "99999999999999999999999\n1 2", &["line 1", "\"99999999999999999999999\""]),
        ("1\n1 2", "2\n1 2", &["line 3", "\"16\"", "16 vertex numbers"]),
        (" 15 16", " 15", &["line 2", "16 vertex numbers"]),
        (" 15 16", " 15 16 17", &["line 2", "16 vertex numbers"]),
        (" 15 16", " 15 17", &["line 2", "\"17\"", "from 1 to 16"]),
        (" 15 16", " 15 0", &["line 2", "\"0\"", "from 1 to 16"]),
        (" 15 16", " 15 4294967297", &["line 2", "\"4294967297\"", "a vertex number"]),
        (" 15 16", " 15 -1", &["line 2", "\"-1\"", "a vertex number"]),
        ("\n16\n", "\n17\n", &["line 3", "\"17\"", "16 lines"]),
        ("\n16\n", "\n15\n", &["line 2", "\"16\"", "from 1 to 15"]),
        (last, "3 3 nan\n", &["line 19", "\"nan\"", "finite coordinate"]),
        (last, "3 3 inf\n", &["line 19", "\"inf\""]),
        (last, "3 3 1e999\n", &["line 19", "\"1e999\""]),
        (last, "3 3 x\n", &["line 19", "\"x\""]),
        (last, "3 3\n", &["line 19", "\"3 3\"", "three coordinates"]),
        (last, "3 3 1e61\n", &["patches[0]", "control point 15"]),
        (last, "3 3 15.5\nmore", &["line 20", "\"more\"", "end of the file"]),
    ];
    for (old, new, parts) in cases {
        let good = indexed();
        assert!(good.contains(old), "{old}");
        assert_holds(&bpt_message(&good.replacen(old, new, 1)), parts);
    }
    assert_holds(&bpt_message(""), &["line 0", "ends", "the number of patches"]);
    assert_holds(&bpt_message("1\n"), &["line 1", "\"1\"", "0 lines"]);
    assert_holds(&bpt_message(&indexed()[..60]), &["line ", "vertices"]);
    assert_holds(&bpt_message(&format!("1\n3 16\n{}", vertices())), &["line 2", "\"16\"", "degree from 1 to 15"]);
    assert_holds(&bpt_message(&format!("1\n0 3\n{}", vertices())), &["line 2", "\"0\"", "degree from 1 to 15"]);
    assert_holds(&bpt_message(&format!("1\n3 4\n{}", vertices())), &["line 18", "ends", "three coordinates"]);
    assert_holds(&bpt_message(&format!("1\n2 2\n{}", vertices())), &["line 12", "end of the file"]);
}

/// A folder for one test's files, emptied first.
fn scratch(test: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(test);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    folder
}

#[test]
fn files_that_cannot_be_read_are_named() {
    let folder = scratch("unreadable");
    let refused = |name: &str, parts: &[&str]| {
        let path = folder.join(name);
        let error = read(&path).unwrap_err().to_string();
        assert!(error.starts_with(&path.display().to_string()) && parts.iter().all(|p| error.contains(p)), "{error}");
    };
    refused("absent.json", &["o such file"]);
    fs::create_dir(folder.join("folder.json")).unwrap();
    refused("folder.json", &["not a regular file"]);
    fs::write(folder.join("latin1.json"), b"{\"name\": \"caf\xe9\"}").unwrap();
    refused("latin1.json", &["byte 13", "0xe9"]);
    fs::write(folder.join("noise.bin"), "solid cube\nfacet").unwrap();
    refused("noise.bin", &["\"solid cube\""]);
    fs::write(folder.join("empty"), "").unwrap();
    refused("empty", &["neither JSON"]);
    fs::write(folder.join("empty.json"), "").unwrap();
    refused("empty.json", &["EOF"]);
    // A file with a hole, which takes no room.
    File::create(folder.join("large.json")).unwrap().set_len(MAX_FILE_BYTES + 1).unwrap();
    refused("large.json", &["1073741825 bytes", "1073741824 allowed"]);
    fs::remove_dir_all(&folder).unwrap();
}

#[cfg(unix)]
#[test]
fn a_device_that_never_ends_is_refused() {
    assert!(matches!(read("/dev/zero"), Err(FormatError { cause: Cause::NotAFile, .. })));
}

#[test]
fn the_format_is_chosen_by_extension_or_content() {
    let folder = scratch("sniff");
    let open = |name: &str, text: &str| {
        fs::write(folder.join(name), text).unwrap();
        read(folder.join(name)).unwrap()
    };
    let document = open("a.json", GOOD);
    for (name, text) in [("b.JSON", GOOD.to_owned()), ("c", format!("\n {GOOD}")), ("d.txt", format!("\u{feff}{GOOD}"))]
    {
        assert_eq!(open(name, &text), document);
    }
    let patches = open("e.bpt", &indexed());
    for name in ["f.BPT", "teapot"] {
        assert_eq!(open(name, &indexed()).surfaces(), patches.surfaces());
    }
    fs::remove_dir_all(&folder).unwrap();
}

/// A reader of text with a name for its messages.
type Parse = fn(&str, &str) -> Result<Model, FormatError>;

/// Seeded random bytes; the seed is the one number that decides a run.
struct Dice(TestRng);

impl Dice {
    fn new(seed: u8) -> Self {
        Self(TestRng::from_seed(RngAlgorithm::ChaCha, &[seed; 32]))
    }

    fn below(&mut self, n: usize) -> usize {
        use proptest::prelude::Rng;
        (self.0.next_u64() % n as u64) as usize
    }
}

/// `text` cut short, or with a few bytes changed, removed, repeated or replaced by a telling word.
fn mutated(text: &str, dice: &mut Dice) -> Vec<u8> {
    const WORDS: [&str; 14] =
        ["-", "1e999", "NaN", "null", "[", "]", "{", "}", ",", "\"", "18446744073709551616", "0", "1e-400", "\u{0}"];
    let mut bytes = text.as_bytes().to_vec();
    for _ in 0..=dice.below(3) {
        let at = dice.below(bytes.len());
        let end = (at + dice.below(40)).min(bytes.len());
        match dice.below(6) {
            0 => bytes.truncate(at.max(1)),
            1 => bytes[at] = dice.below(256) as u8,
            2 => bytes[at] = b"0123456789.-e,[]{}\" "[dice.below(20)],
            3 => drop(bytes.drain(at..end.max(at + 1).min(bytes.len()))),
            4 => {
                let copy = bytes[at..end].to_vec();
                bytes.splice(at..at, copy);
            }
            _ => drop(bytes.splice(at..at + 1, WORDS[dice.below(WORDS.len())].bytes())),
        }
        if bytes.is_empty() {
            bytes.push(b' ');
        }
    }
    bytes
}

#[test]
fn mutated_files_never_panic() {
    let cases = root().join("testdata/cases");
    let text = |name: &str| fs::read_to_string(cases.join(name)).unwrap();
    let documents = [GOOD.to_owned(), text("bezier_2.json"), text("periodic_1.json"), text("quadric_2.json")];
    let patches = [indexed(), format!("2\n3 3\n{}1 1\n0 0 0\n0 1 0\n1 0 0\n1 1 0\n", vertices())];
    let mut opened = 0;
    for seed in 0..4 {
        let mut dice = Dice::new(seed);
        for round in 0..1000 {
            // On a panic the seed and the round are what is needed to see it again.
            let context = format!("seed {seed}, round {round}");
            let (text, parse): (&str, Parse) = match round % 2 {
                0 => (&documents[dice.below(documents.len())], json::parse),
                _ => (&patches[dice.below(patches.len())], bpt::parse),
            };
            let bytes = mutated(text, &mut dice);
            let text = String::from_utf8_lossy(&bytes);
            match std::panic::catch_unwind(|| parse(&text, "fuzz")) {
                Ok(Ok(model)) => {
                    opened += 1;
                    // What opens is whole: it evaluates, and it can be written and read.
                    let written = json::write(&model).unwrap_or_else(|e| panic!("{context}: {e}"));
                    json::parse(&written, "fuzz").unwrap_or_else(|e| panic!("{context}: {e}"));
                }
                Ok(Err(error)) => assert!(error.to_string().starts_with("fuzz: "), "{context}: {error}"),
                Err(_) => panic!("{context}: panicked on {text:?}"),
            }
        }
    }
    // A mutation that always fails, or never does, tests little.
    assert!((100..3900).contains(&opened), "{opened} of 4000 opened");
}
