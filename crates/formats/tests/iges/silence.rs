//! What a file says wrong is told: nothing takes its place in silence.

use crate::writer::{INDEPENDENT, Style, Writer, list};
use formats::{Document, FORMATS};

fn read(text: &str) -> Document {
    let iges = FORMATS.iter().find(|format| format.name() == "IGES").expect("it is in the list");
    iges.read(text.as_bytes(), "part.igs").unwrap_or_else(|error| panic!("{error}"))
}

fn losses(document: &Document) -> Vec<String> {
    document.notes.iter().filter(|note| note.kind.is_loss()).map(ToString::to_string).collect()
}

/// A square in the plane of height z; `ends` are those of its knots.
fn square(w: &mut Writer, z: f64, ends: &str) -> usize {
    let points = [[0.0, 0.0, z], [10.0, 0.0, z], [0.0, 10.0, z], [10.0, 10.0, z]].concat();
    let knots = "0.0,0.0,1.0,1.0,0.0,0.0,1.0,1.0";
    let text = format!("1,1,1,1,0,0,1,0,0,{knots},{},{}{ends}", list(&[1.0; 4]), list(&points));
    let surface = w.add(128, 0, &text);
    w.set_status(surface, INDEPENDENT)
}

/// A file of two squares, the second moved up by a matrix, with one field of the second's entry replaced: on its first or
/// second line, from 0.
fn with_field(line: usize, field: usize, text: &str) -> Document {
    let mut w = Writer::new();
    square(&mut w, 0.0, ",0.0,1.0,0.0,1.0");
    let second = square(&mut w, 0.0, ",0.0,1.0,0.0,1.0");
    let matrix = w.matrix([[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 5.0]]);
    w.set_matrix(second, matrix);
    let mut lines: Vec<String> = w.file().lines().map(str::to_owned).collect();
    let first = lines.iter().position(|line| line.as_bytes().get(72) == Some(&b'D')).expect("a directory");
    let card = &mut lines[first + second - 1 + line];
    card.replace_range(8 * field..8 * field + 8, &format!("{text:>8}"));
    read(&(lines.join("\n") + "\n"))
}

/// A field of the directory that is no number costs its entity, and is told; it is never a zero. Blanks are one.
#[test]
fn a_field_of_the_directory_that_is_no_number_is_told() {
    let good = with_field(0, 8, "");
    assert_eq!((good.model.faces().len(), losses(&good)), (2, vec![]), "a blank status");
    assert!((good.model.surface(scene::FaceId(1)).point(0.5, 0.5).z - 5.0).abs() < 1e-12);
    for (line, field, text) in
        [(0, 6, "5x"), (0, 6, "-5"), (0, 1, "one"), (0, 8, "0x0y0000"), (0, 4, "top"), (1, 2, "red"), (1, 4, "1.5")]
    {
        let document = with_field(line, field, text);
        let losses = losses(&document);
        assert_eq!((document.model.faces().len(), losses.len()), (1, 1), "{text}: {losses:?}");
        assert!(losses[0].contains("line 7: a directory entry makes no sense, and is left out"), "{text}: {losses:?}");
    }
}

#[test]
fn a_colour_that_is_none_is_told() {
    for (text, part) in [("9", "it has colour 9, which there is not"), ("-3", "no definition of a colour (314)")] {
        let document = with_field(1, 2, text);
        let losses = losses(&document);
        assert_eq!((document.model.faces().len(), losses.len()), (2, 1), "{text}: {losses:?}");
        assert!(losses[0].starts_with("line ") && losses[0].contains(part), "{text}: {losses:?}");
        assert_eq!(document.attributes[1].colour, None);
    }
}

/// The ends of a domain: absent, or zeros, they are those of the knots; what is no number is an error.
#[test]
fn ends_of_a_domain_that_are_no_numbers_are_told() {
    for (ends, faces) in
        [("", 2), (",0.0,0.0,0.0,0.0", 2), (",0.0,NaN,0.0,1.0", 1), (",0.5,0.5,0.0,1.0", 1), (",0.0", 1)]
    {
        let mut w = Writer::new();
        square(&mut w, 0.0, ",0.0,1.0,0.0,1.0");
        square(&mut w, 5.0, ends);
        let document = read(&w.file());
        let losses = losses(&document);
        assert_eq!((document.model.faces().len(), losses.len()), (faces, 2 - faces), "{ends}: {losses:?}");
    }
}

/// The unit of a file whose flag and name are these.
fn unit(flag: i32, name: &'static str) -> (Option<String>, Vec<String>) {
    let mut w = Writer::new();
    w.style = Style { unit: (flag, name, 1.0), ..Style::default() };
    square(&mut w, 0.0, "");
    let document = read(&w.file());
    (document.unit.as_ref().map(|unit| unit.name.clone()), losses(&document))
}

#[test]
fn units_that_contradict_each_other_or_are_none_are_told() {
    for (flag, name, found) in
        [(2, "MM", "millimetre"), (1, "INCH", "inch"), (3, "CM", "centimetre"), (1, "XX", "inch")]
    {
        assert_eq!(unit(flag, name), (Some(found.to_owned()), vec![]), "{flag} {name}");
    }
    let (found, losses) = unit(1, "MM");
    assert_eq!(found.as_deref(), Some("inch"));
    assert!(
        losses.len() == 1 && losses[0].contains("says inch, and its unit's name is MM: the flag counts"),
        "{losses:?}"
    );
    for (flag, name) in [(77, "MM"), (0, "MM"), (3, "ELL")] {
        let (found, losses) = unit(flag, name);
        assert_eq!(found, None, "{flag}");
        assert!(losses.len() == 1 && losses[0].contains("names no known unit"), "{losses:?}");
    }
}

/// A definition that cannot be read names no parts: they would be drawn where they stand, and nobody would know why.
#[test]
fn a_definition_that_cannot_be_read_is_told() {
    let mut w = Writer::new();
    let surface = square(&mut w, 0.0, "");
    w.add(308, 0, &format!("0,1Hx,3,{surface}"));
    let losses = losses(&read(&w.file()));
    assert!(losses.len() == 1 && losses[0].contains("type 308: left out: parameter 3 counts 3 items"), "{losses:?}");
}
