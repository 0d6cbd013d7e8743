//! Bad STEP files: a clear error or a note with line and instance, and never a panic, a hang or a lost neighbour.

use crate::cases::cases;
use crate::common::root;
use formats::{Document, FORMATS, FormatError, NoteKind};
use proptest::prelude::Rng;
use proptest::test_runner::{RngAlgorithm, TestRng};
use std::time::{Duration, Instant};

fn read(bytes: &[u8]) -> Result<Document, FormatError> {
    let step = FORMATS.iter().find(|format| format.name() == "STEP").expect("it is in the list");
    step.read(bytes, "dir/bad.step")
}

fn case(name: &str) -> String {
    cases().into_iter().find(|case| case.name == name).expect("a case").text
}

/// Three faces, a line each for every instance.
fn good() -> String {
    case("oblique-cut")
}

fn opened(text: &str) -> Document {
    read(text.as_bytes()).unwrap_or_else(|error| panic!("{error}"))
}

/// What is left of a file whose text was changed: the number of faces, and the notes of losses.
fn after(old: &str, new: &str) -> (usize, Vec<String>) {
    assert!(good().contains(old), "{old}");
    let document = opened(&good().replacen(old, new, 1));
    let losses = document.notes.iter().filter(|note| note.kind.is_loss()).map(ToString::to_string);
    (document.model.faces().len(), losses.collect())
}

#[test]
fn text_as_it_is_found_in_the_wild_is_read() {
    let whole = opened(&good());
    assert_eq!(whole.model.faces().len(), 3);
    let header_end = good().find("DATA;").expect("a section");
    let variants = [
        ("CRLF", good().replace('\n', "\r\n")),
        ("no header", good()[header_end..].to_owned()),
        ("no sections", good()[header_end + 6..].to_owned()),
        ("one line", good().replace('\n', "")),
        ("comments", good().replace("=CIRCLE", " /* it's; #9=x( */ = /**/ CIRCLE")),
        ("integers for reals", good().replace("0.0,", "0,")),
        ("Fortran's exponents", good().replace("5.0", "0.5D1")),
        ("names", good().replace("PLANE(''", "PLANE('it''s \\X2\\00E4\\X0\\; (#1=\\S\\d'")),
        ("no ;", good().replacen("');\n", "')\n", 3).replacen("0));\n", "0))\n", 4)),
    ];
    for (name, text) in variants {
        assert_ne!(text, good(), "{name}");
        let document = opened(&text);
        assert_eq!(document.model.hash(), whole.model.hash(), "{name}: {:?}", document.notes);
    }
    let mut latin = good().into_bytes();
    let at = good().find("PLANE('").expect("a plane") + 7;
    latin.splice(at..at, [0xe4, 0xff]);
    assert_eq!(read(&latin).expect("a model").model.hash(), whole.model.hash());
}

#[test]
fn a_bad_instance_costs_its_face_and_is_named() {
    for (old, new, part) in [
        ("=CYLINDRICAL_SURFACE(", "=CONE_OF_SILENCE(", "CONE_OF_SILENCE: a surface of this kind is not read"),
        ("=CYLINDRICAL_SURFACE('',#", "=CYLINDRICAL_SURFACE('',#99", "it is not in the file"),
        ("=CYLINDRICAL_SURFACE('',", "=CYLINDRICAL_SURFACE('',((", "it is not in the file, or its text makes no sense"),
        (",2.0);", ",-2.0);", "a radius is not above 0"),
        (",2.0);", ",NaN);", "its text makes no sense"),
        (",2.0);", ",1e999);", "its text makes no sense"),
        (",2.0);", ",);", "parameter 3 is not a number"),
    ] {
        // The last radius is the cylinder's own.
        let text = good();
        let at = if old == ",2.0);" { text.find("=CYLINDRICAL").expect("one") } else { 0 };
        let changed = format!("{}{}", &text[..at], text[at..].replacen(old, new, 1));
        let document = opened(&changed);
        let losses: Vec<String> =
            document.notes.iter().filter(|note| note.kind == NoteKind::LeftOut).map(ToString::to_string).collect();
        assert_eq!((document.model.faces().len(), losses.len()), (2, 1), "{new}: {losses:?}");
        assert!(losses[0].starts_with("line ") && losses[0].contains("ADVANCED_FACE: left out: "), "{losses:?}");
        assert!(losses[0].contains(part), "{new}: {losses:?}");
    }
}

#[test]
fn dangling_cyclic_and_doubled_instances_are_named() {
    // A shell that names a face twice, and one that is not there.
    let (faces, losses) = after("=CLOSED_SHELL('',(", "=CLOSED_SHELL('',(#99999,");
    assert_eq!((faces, losses.len()), (3, 1), "{losses:?}");
    assert!(losses[0].contains("#99999"), "{losses:?}");
    // A representation that stands in itself.
    let mut text = case("assembly");
    let mapped = text.find("=REPRESENTATION_MAP(").expect("a map");
    let group = text[mapped..].split(['#', ')']).nth(2).expect("a group").to_owned();
    let line = text.lines().find(|line| line.starts_with(&format!("#{group}="))).expect("the group").to_owned();
    let item = text
        .lines()
        .find(|line| line.contains("=MAPPED_ITEM("))
        .expect("an item")
        .split('=')
        .next()
        .unwrap()
        .to_owned();
    text = text.replacen(&line, &line.replacen("((", "(", 1).replacen("('',(", &format!("('',({item},"), 1), 1);
    let document = opened(&text);
    let is_named = |note: &formats::Note| note.to_string().contains("it stands in itself");
    assert!(document.notes.iter().any(is_named), "{:?}", document.notes);
    assert_eq!(document.model.faces().len(), 12);
    // A curve that is made of itself.
    let circle = good();
    let line = circle.lines().find(|line| line.contains("=ELLIPSE(")).expect("an ellipse").to_owned();
    let number = line.split('=').next().unwrap();
    let (faces, losses) = after(&line, &format!("{number}=TRIMMED_CURVE('',{number},(),(),.T.,.PARAMETER.);"));
    assert_eq!((faces, losses.len()), (1, 2), "{losses:?}");
    assert!(losses[0].contains("made of curves too deep"), "{losses:?}");
    // The first of two with one number counts.
    let (faces, losses) = after("ENDSEC;\nEND-ISO", "#1=CARTESIAN_POINT('',(9.,9.,9.));\nENDSEC;\nEND-ISO");
    assert_eq!((faces, losses.len()), (3, 1), "{losses:?}");
    assert!(losses[0].contains("has the number of an earlier one"), "{losses:?}");
}

#[test]
fn assemblies_that_double_at_each_level_end() {
    let mut text = case("sphere-vertex");
    let representation = text.lines().find(|line| line.contains("=ADVANCED_BREP")).expect("one").to_owned();
    let number: u64 = representation[1..].split('=').next().unwrap().parse().expect("a number");
    let context = representation.rsplit('#').next().unwrap().trim_end_matches(");").to_owned();
    let mut data = String::from("#9000=CARTESIAN_POINT('',(0.,0.,0.));\n#9001=AXIS2_PLACEMENT_3D('',#9000,$,$);\n");
    let mut below = number;
    for level in 0..60u64 {
        let base = 10_000 + 10 * level;
        data += &format!(
            "#{}=REPRESENTATION_MAP(#9001,#{below});\n#{}=MAPPED_ITEM('',#{base},#9001);\n#{}=MAPPED_ITEM('',#{base},#9001);\n\
             #{}=SHAPE_REPRESENTATION('',(#{},#{}),#{context});\n",
            base,
            base + 1,
            base + 2,
            base + 3,
            base + 1,
            base + 2
        );
        below = base + 3;
    }
    text = text.replacen("ENDSEC;\nEND-ISO", &format!("{data}ENDSEC;\nEND-ISO"), 1);
    let start = Instant::now();
    match read(text.as_bytes()) {
        Ok(document) => assert!(document.notes.iter().any(|note| note.kind == NoteKind::LeftOut)),
        Err(error) => panic!("{error}"),
    }
    assert!(start.elapsed() < Duration::from_secs(20), "{:?}", start.elapsed());
}

#[test]
fn depth_and_length_are_bounded() {
    let deep = format!("#1=A({}{});", "(".repeat(1_000_000), ")".repeat(1_000_000));
    let long = format!("#1=PLANE('{}',#2);", "x".repeat(20_000_000));
    let quotes = format!("#1=PLANE('{}", "\n#2=PLANE('x".repeat(200_000));
    let comments = format!("#1=PLANE(''{}", "/*".repeat(500_000));
    let hashes = "#".repeat(2_000_000);
    let numbers = format!("#{}=A();", "9".repeat(1_000_000));
    for (name, text) in [
        ("deep", deep),
        ("long", long),
        ("quotes", quotes),
        ("comments", comments),
        ("hashes", hashes),
        ("numbers", numbers),
    ] {
        let start = Instant::now();
        let error = read(text.as_bytes()).expect_err(name).to_string();
        assert!(error.starts_with("dir/bad.step: ") && error.len() < 800, "{name}: {error}");
        assert!(start.elapsed() < Duration::from_secs(5), "{name}: {:?}", start.elapsed());
    }
}

#[test]
fn every_truncation_is_read_or_refused() {
    let text = good();
    let (mut opened, mut refused) = (0, 0);
    for end in (0..text.len()).step_by(7) {
        match read(&text.as_bytes()[..end]) {
            Ok(document) => {
                opened += 1;
                assert!(document.model.faces().len() <= 3);
            }
            Err(error) => {
                refused += 1;
                assert!(error.to_string().starts_with("dir/bad.step: "), "{error}");
            }
        }
    }
    assert!(0 < opened && 0 < refused, "{opened} {refused}");
}

#[test]
fn mutated_files_never_panic() {
    let mut dice = TestRng::from_seed(RngAlgorithm::ChaCha, &[7; 32]);
    let mut below = |n: usize| (dice.next_u64() % n as u64) as usize;
    let mut texts: Vec<Vec<u8>> = cases().into_iter().map(|case| case.text.into_bytes()).collect();
    let folder = root().join("testdata/step");
    texts.extend(
        ["attributes", "layers", "offset-prism"]
            .map(|name| std::fs::read(folder.join(format!("{name}.step"))).unwrap()),
    );
    const WORDS: [&[u8]; 14] = [
        b"-",
        b"1e999",
        b"1e-400",
        b"1e300",
        b"(",
        b")",
        b"'",
        b"#1",
        b"$",
        b"*",
        b".F.",
        b"/*",
        b";",
        b"18446744073709551616",
    ];
    let (mut opened, mut lossless) = (0, 0);
    for round in 0..1500 {
        let mut bytes = texts[below(texts.len())].clone();
        for _ in 0..=below(3) {
            let at = below(bytes.len());
            match below(5) {
                0 => bytes[at] = below(256) as u8,
                1 => bytes[at] = b"0123456789.-E,()#' "[below(19)],
                2 => drop(bytes.drain(at..(at + 1 + below(30)).min(bytes.len()))),
                3 => drop(bytes.splice(at..at + 1, WORDS[below(WORDS.len())].iter().copied())),
                _ => {
                    let from = below(bytes.len());
                    let copy = bytes[from..(from + below(40)).min(bytes.len())].to_vec();
                    drop(bytes.splice(at..at, copy));
                }
            }
        }
        match std::panic::catch_unwind(|| read(&bytes)) {
            Ok(Ok(document)) => {
                opened += 1;
                lossless += usize::from(document.notes.iter().all(|note| !note.kind.is_loss()));
            }
            Ok(Err(error)) => assert!(error.to_string().starts_with("dir/bad.step: "), "round {round}: {error}"),
            Err(_) => panic!("round {round}: panicked on\n{}", String::from_utf8_lossy(&bytes)),
        }
    }
    assert!((100..1500).contains(&opened) && lossless < opened, "{opened} opened, {lossless} of them without a loss");
}

/// A text of so many bytes of points, and how long it takes to find that it shows no face.
fn seconds_for(bytes: usize) -> f64 {
    let mut text = String::from("DATA;\n");
    let mut number = 1;
    while text.len() < bytes {
        text += &format!("#{number}=CARTESIAN_POINT('',(-2.{number}E+01,4.5,1.E-03));\n");
        number += 1;
    }
    let start = Instant::now();
    let error = read(text.as_bytes()).expect_err("it has no face").to_string();
    assert!(error.contains("it shows no faces"), "{error}");
    start.elapsed().as_secs_f64()
}

#[test]
fn time_grows_as_the_text_does() {
    let (short, long) = (seconds_for(2_000_000), seconds_for(32_000_000));
    eprintln!("{:.0} and {:.0} MB/s", 2.0 / short, 32.0 / long);
    // 16 times the text; a machine that does other things besides may be four times slower meanwhile.
    assert!(long < 64.0 * short.max(0.02), "{short} s for 2 MB, {long} s for 32 MB");
}

/// A curve of 20,000 points, named by 20,000 edges of one loop, and that loop by 2,000 faces.
#[test]
fn a_large_curve_that_is_named_again_and_again_ends() {
    let mut text = case("oblique-cut");
    let points: Vec<String> = (0..20_000).map(|k| format!("#{}", 100_000 + k % 7)).collect();
    let mut data: String = (0..7).map(|k| format!("#{}=CARTESIAN_POINT('',({k}.,1.,0.));\n", 100_000 + k)).collect();
    let ends = "#90002=VERTEX_POINT('',#100000);\n#90003=VERTEX_POINT('',#100006);\n";
    data += &format!("#90000=POLYLINE('',({}));\n{ends}", points.join(","));
    data += "#90001=EDGE_CURVE('',#90002,#90003,#90000,.T.);\n";
    data +=
        &format!("#90004=EDGE_LOOP('',({}));\n#90005=FACE_BOUND('',#90004,.T.);\n", vec!["#90001"; 20_000].join(","));
    let surface = text.split("=CYLINDRICAL_SURFACE").next().unwrap().rsplit('#').next().unwrap().to_owned();
    let faces: Vec<u64> = (0..2000).map(|k| 200_000 + k).collect();
    data.extend(faces.iter().map(|k| format!("#{k}=ADVANCED_FACE('',(#90005),#{surface},.T.);\n")));
    text = text.replacen("ENDSEC;\nEND-ISO", &format!("{data}ENDSEC;\nEND-ISO"), 1);
    let start = Instant::now();
    let document = opened(&text);
    assert_eq!(document.model.faces().len(), 3);
    let is_named = |note: &formats::Note| note.to_string().contains("so often that no more are read");
    assert!(document.notes.iter().any(is_named), "{}", document.notes.len());
    assert!(start.elapsed() < Duration::from_secs(30), "{:?}", start.elapsed());
}

/// A name of two million characters, for each of 100 faces: what is kept of it is short.
#[test]
fn a_long_name_of_many_faces_is_cut() {
    let text = good();
    let face = text.lines().find(|line| line.contains("=ADVANCED_FACE(")).expect("a face");
    let (_, rest) = face.split_once("=ADVANCED_FACE('").expect("a name");
    let numbers: Vec<u64> = (0..100).map(|k| 200_000 + k).collect();
    let mut data: String = numbers.iter().map(|k| format!("#{k}=ADVANCED_FACE('{rest}\n")).collect();
    let list: Vec<String> = numbers.iter().map(|k| format!("#{k}")).collect();
    let name = "n".repeat(2_000_000);
    data += &format!("#300000=PRESENTATION_LAYER_ASSIGNMENT('{name}','',({}));\n", list.join(","));
    data += &format!("#300001=OPEN_SHELL('{name}',({}));\n", list.join(","));
    data += "#300002=SHELL_BASED_SURFACE_MODEL('',(#300001));\n#300003=SHAPE_REPRESENTATION('',(#300002),$);\n";
    let document = opened(&text.replacen("ENDSEC;\nEND-ISO", &format!("{data}ENDSEC;\nEND-ISO"), 1));
    let long = |said: &&formats::Attributes| {
        let names = said.layers.iter().chain(&said.name);
        said.layers.len() == 1 && names.clone().count() == 2 && names.clone().all(|name| name.ends_with("n…"))
    };
    assert_eq!(document.attributes.iter().filter(long).count(), 100);
    let lengths =
        document.attributes.iter().flat_map(|said| said.layers.iter().chain(&said.name)).map(|name| name.len());
    assert!(lengths.max() < Some(1010), "{:?}", document.attributes[0]);
}

/// A face as large as numbers go where it stands, and units that are none: each is told, and nothing is drawn elsewhere instead.
#[test]
fn what_cannot_stand_where_it_is_said_is_left_out() {
    let text = case("assembly");
    let line = text.lines().find(|line| line.contains("=REPRESENTATION_MAP(")).expect("a map");
    let (map, _) = line.split_once('=').expect("a number");
    let item = text.lines().find(|line| line.contains(&format!("=MAPPED_ITEM('',{map},"))).expect("an item");
    let (number, rest) = item.split_once("=MAPPED_ITEM(").expect("one");
    let target = rest.rsplit('#').next().expect("a placement").trim_end_matches(");");
    let origin = text.lines().find(|line| line.starts_with(&format!("#{target}="))).expect("it is there");
    let point = origin.split('#').nth(2).expect("its origin").trim_end_matches(',');
    let huge = format!("#90000=CARTESIAN_TRANSFORMATION_OPERATOR_3D('',$,$,#{point},1.E+200,$);\n");
    let changed = text.replacen(item, &format!("{number}=MAPPED_ITEM('',{map},#90000);"), 1).replacen(
        "ENDSEC;\nEND-ISO",
        &format!("{huge}ENDSEC;\nEND-ISO"),
        1,
    );
    let document = opened(&changed);
    let losses: Vec<String> =
        document.notes.iter().filter(|note| note.kind == NoteKind::LeftOut).map(ToString::to_string).collect();
    assert_eq!((document.model.faces().len(), losses.len()), (6, 6), "{losses:?}");
    assert!(losses.iter().all(|loss| loss.contains("ADVANCED_FACE: left out: ")), "{losses:?}");
}

#[test]
fn units_that_are_none_are_told() {
    for (old, new, part) in [
        ("SI_UNIT(.MILLI.,.METRE.)", "SI_UNIT(.MEGALO.,.METRE.)", "no unit of length"),
        ("SI_UNIT(.MILLI.,.METRE.)", "SI_UNIT(.MILLI.,NaN)", "no unit that is known"),
        ("LENGTH_MEASURE(1.E-07)", "LENGTH_MEASURE(-1.)", "no uncertainty"),
        ("LENGTH_MEASURE(1.E-07)", "LENGTH_MEASURE(NaN)", "no uncertainty"),
    ] {
        let (faces, losses) = after(old, new);
        assert!(faces == 3 && losses.iter().any(|loss| loss.contains(part)), "{new}: {losses:?}");
    }
}
