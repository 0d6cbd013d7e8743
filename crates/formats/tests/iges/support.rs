//! The table of support in the docs, against what the code lists and what files with each type show.

use crate::cases::cases;
use crate::common::root;
use crate::table::assert_table_is_listed;
use crate::writer::{INDEPENDENT, Writer};
use formats::{FORMATS, Format, NoteKind, Support};
use std::collections::{BTreeMap, BTreeSet};

fn iges() -> &'static dyn Format {
    *FORMATS.iter().find(|format| format.name() == "IGES").expect("it is in the list")
}

#[test]
fn the_table_of_support_says_what_the_code_lists() {
    assert_table_is_listed("IGES");
}

/// Rows that a type's number does not tell apart, and others, each by a file of that kind.
const BY_FILE: [(&str, &str); 8] = [
    ("130 offset curve of lines and arcs", "offset-curves"),
    ("130 offset curve of others", "offset-conics"),
    ("140 offset surface of 108 and 190 to 198", "offset-sphere"),
    ("140 offset surface of others", "offset-prism"),
    ("118 ruled surface of lines, splines, or like arcs", "ruled-lines"),
    ("104 conic arc", "paraboloid"),
    ("112 parametric spline curve", "parametric-curve"),
    ("114 parametric spline surface", "parametric-spline"),
];

#[test]
fn what_is_exact_has_no_note_and_what_is_approximated_has_one() {
    for (row, file) in BY_FILE {
        let (_, support) = iges().entities().iter().find(|(name, _)| *name == row).expect("a row");
        let path = root().join(format!("testdata/iges/{file}.igs"));
        let text = std::fs::read_to_string(&path).unwrap();
        let is_there = text.lines().any(|line| line.as_bytes().get(72) == Some(&b'D') && line[..8].trim() == &row[..3]);
        assert!(is_there, "{row}: {file} has no such entity");
        let notes = formats::open(&path).unwrap_or_else(|error| panic!("{error}")).notes;
        let has = |text: &str| notes.iter().any(|note| note.text.contains(text));
        assert!(!notes.iter().any(|note| note.kind.is_loss()), "{row}: {notes:?}");
        match support {
            // A circle's edge is followed on its plane, which is exact there, and noted with the distance.
            Support::Exact => assert!(!has("offsets of splines") && !has("rulings"), "{row}: {notes:?}"),
            Support::Approximated => assert!(has("offsets of splines"), "{row}: {notes:?}"),
            other => panic!("{row}: {other:?}"),
        }
    }
}

/// The corpus, all of which is drawn to rounding, has each type that the table does not leave out. Which rows of one type are exact, the
/// test above asks.
#[test]
fn the_corpus_has_each_type_that_is_read() {
    let looks = std::fs::read_to_string(root().join("testdata/iges/looks.igs")).unwrap();
    let types: BTreeSet<String> = cases()
        .iter()
        .map(|case| &case.text)
        .chain([&looks])
        .flat_map(|text| text.lines().map(str::to_owned).collect::<Vec<_>>())
        .filter(|line| line.as_bytes().get(72) == Some(&b'D'))
        .map(|line| line[..8].trim().to_owned())
        .collect();
    for (name, support) in iges().entities() {
        let kind = name.split([' ', ',']).next().expect("a type");
        assert!(*support == Support::LeftOut || types.contains(kind), "{name}");
    }
}

/// Each row that is left out costs its face, or its body, and a note; the sphere beside it is drawn.
#[test]
fn what_the_table_leaves_out_is_noted() {
    /// A plane within a curve.
    fn within(w: &mut Writer, curve: usize) -> usize {
        w.add(108, 1, &format!("0.0,0.0,1.0,0.0,{curve},0.0,0.0,0.0,0.0"))
    }
    type Add = fn(&mut Writer) -> usize;
    let wrong: BTreeMap<&str, Add> = [
        (
            "106 copious data, other forms",
            (|w| {
                let curve = w.add(106, 20, "1,2,0.0,0.0,0.0,1.0,1.0");
                within(w, curve)
            }) as Add,
        ),
        ("108 plane, other forms", |w| w.add(108, 0, "0.0,0.0,1.0,0.0,0,0.0,0.0,0.0,0.0")),
        ("110 line, forms 1 and 2", |w| {
            let curve = w.add(110, 1, "0.0,0.0,0.0,1.0,0.0,0.0");
            within(w, curve)
        }),
        ("130 offset curve by the arc's length, by a function, or changing along a hyperbola", |w| {
            let x = 2f64.sqrt();
            let conic = w.numbers(104, 2, &[1.0, 0.0, -1.0, 0.0, 0.0, -1.0, 0.0, x, -1.0, x, 1.0]);
            let curve = w.add(130, 0, &format!("{conic},2,0,0,2,0.1,-0.5,0.2,0.5,0.0,0.0,1.0,-0.5,0.5"));
            within(w, curve)
        }),
        ("140 offset surface of a surface with a crease", |w| {
            let points = "0.0,0.0,0.0,1.0,0.0,1.0,2.0,0.0,0.0,0.0,1.0,0.0,1.0,1.0,1.0,2.0,1.0,0.0";
            let knots = "0.0,0.0,1.0,2.0,2.0,0.0,0.0,1.0,1.0,1.0,1.0,1.0,1.0,1.0,1.0";
            let roof = w.add(128, 0, &format!("2,1,1,1,0,0,1,0,0,{knots},{points},0.0,2.0,0.0,1.0"));
            w.add(140, 0, &format!("0.0,0.0,1.0,0.1,{roof}"))
        }),
        ("150 to 168 primitives and sweeps", |w| w.add(154, 0, "1.0,1.0")),
        ("180 Boolean tree", |w| w.add(180, 0, "3,1,1,1")),
        ("182, 184, 430 selected, assembled, placed solids", |w| w.add(430, 0, "1")),
        ("416 external reference", |w| w.add(416, 0, "1Hx,1Hy")),
        ("420 network subfigure instance", |w| w.add(420, 0, "1,0.0,0.0,0.0")),
    ]
    .into();
    for (name, support) in iges().entities() {
        assert_eq!(*support == Support::LeftOut, wrong.contains_key(name), "{name}");
        let Some(add) = wrong.get(name) else { continue };
        let mut w = Writer::new();
        let center = w.point([0.0; 3]);
        let sphere = w.add(196, 0, &format!("{center},1.0"));
        w.set_status(sphere, INDEPENDENT);
        let number = add(&mut w);
        w.set_status(number, INDEPENDENT);
        let document = iges().read(w.file().as_bytes(), "part.igs").unwrap_or_else(|error| panic!("{name}: {error}"));
        let lost: Vec<String> =
            document.notes.iter().filter(|note| note.kind.is_loss()).map(ToString::to_string).collect();
        assert_eq!((document.model.faces().len(), lost.len()), (1, 1), "{name}: {lost:?}");
        assert!(lost[0].contains(&format!("#{number} type")), "{lost:?}");
    }
}

/// An arc and a line correspond by angle, which no spline does: the note says how far rulings are off.
#[test]
fn rulings_that_are_off_are_measured() {
    let mut w = Writer::new();
    let (arc, line) = (w.circle(0.0, 1.0, [0.0, 1.5]), w.line([1.0, 0.0, 1.0], [1.0, 1.0, 1.0]));
    let surface = w.add(118, 1, &format!("{arc},{line},0,0"));
    w.set_status(surface, INDEPENDENT);
    let document = iges().read(w.file().as_bytes(), "part.igs").unwrap();
    let notes: Vec<String> =
        document.notes.iter().filter(|note| note.kind == NoteKind::Approximated).map(ToString::to_string).collect();
    // The spline of an arc of 1.5 is at the angle of its parameter at both ends and in the middle; between them
    // φ = 4 atan(tan(0.375) (2 t − 1)) is at most 0.0148 of 1.5 from 1.5 (t − ½), as maximised by hand.
    let off: f64 = notes[0].split("up to ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
    let greatest = (0..=1000)
        .map(|k| f64::from(k) / 1000.0)
        .map(|t| (2.0 * (0.375f64.tan() * (2.0 * t - 1.0)).atan() / 1.5 - (t - 0.5)).abs())
        .fold(0.0, f64::max);
    assert!((off / greatest - 1.0).abs() < 0.06, "{notes:?} {greatest}");
}
