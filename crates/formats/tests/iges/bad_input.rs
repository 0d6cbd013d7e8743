//! Files that are not as they should be: each answer is a document or an error, and a bad entity costs its face alone.

use crate::cases::cases;
use crate::writer::{BLANKED, DEPENDENT, INDEPENDENT, Writer, list};
use formats::{Document, FORMATS, Format, FormatError, NoteKind, Place};
use std::time::{Duration, Instant};

/// The longest that one bad file may take, on a loaded machine, too.
const PATIENCE: Duration = Duration::from_secs(10);

fn iges() -> &'static dyn Format {
    *FORMATS.iter().find(|format| format.name() == "IGES").expect("it is in the list")
}

fn read(text: &str) -> Result<Document, FormatError> {
    let start = Instant::now();
    let result = iges().read(text.as_bytes(), "part.igs");
    assert!(start.elapsed() < PATIENCE, "{:?} for {}", start.elapsed(), &text[..text.len().min(2000)]);
    result
}

fn case(name: &str) -> String {
    cases().into_iter().find(|case| case.name == name).expect("it is there").text
}

fn error(text: &str) -> String {
    match read(text) {
        Ok(document) => panic!("it was read: {:?}", document.notes),
        Err(error) => error.to_string(),
    }
}

/// The bilinear square, with its points from (0, 0) to (10, 10), as a face of its own or not.
fn square(w: &mut Writer, z: f64, status: &'static str) -> usize {
    let points = [[0.0, 0.0, z], [10.0, 0.0, z], [0.0, 10.0, z], [10.0, 10.0, z]].concat();
    let ends = "0.0,0.0,1.0,1.0,0.0,0.0,1.0,1.0";
    let text = format!("1,1,1,1,0,0,1,0,0,{ends},{},{},0.0,1.0,0.0,1.0", list(&[1.0; 4]), list(&points));
    let surface = w.add(128, 0, &text);
    w.set_status(surface, status)
}

/// A file of one good face and what `add` adds to it; the good one is always drawn, and what is lost of the rest is returned.
fn beside(add: impl FnOnce(&mut Writer)) -> Vec<(Place, String)> {
    let mut w = Writer::new();
    square(&mut w, 0.0, INDEPENDENT);
    add(&mut w);
    let document = read(&w.file()).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(document.model.faces().len(), 1, "{:?}", document.notes);
    let lost = document.notes.into_iter().filter(|note| note.kind == NoteKind::LeftOut);
    lost.map(|note| (note.place, note.text)).collect()
}

#[test]
fn every_truncation_is_a_document_or_an_error_that_names_the_file() {
    for name in ["cylinder-seam", "holes", "assembly"] {
        let text = case(name);
        // Up to the letter of the last card.
        for end in (0..text.len() - 9).step_by(37) {
            match read(&text[..end]) {
                Ok(document) => assert!(document.notes.iter().any(|note| note.kind.is_loss()), "{name} cut at {end}"),
                Err(error) => assert!(error.to_string().starts_with("part.igs: "), "{error}"),
            }
        }
    }
}

#[test]
fn changed_bytes_never_panic() {
    // A generator of its own: a linear congruence (Knuth, MMIX).
    let mut state = 1u64;
    let mut random = |limit: usize| {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 33) as usize % limit
    };
    let letters = b"0123456789,;.-+DEH \n9999";
    for case in cases() {
        for _ in 0..60 {
            let mut bytes = case.text.clone().into_bytes();
            for _ in 0..1 + random(6) {
                let at = random(bytes.len());
                bytes[at] = letters[random(letters.len())];
            }
            let _ = iges().read(&bytes, "part.igs");
        }
    }
}

#[test]
fn other_forms_of_the_file_are_refused_by_name() {
    let good = case("holes");
    let with_letter = |letter: &str| format!("{:72}{letter}{}", "", &good[73..]);
    assert!(error(&with_letter("C")).contains("line 1: IGES in compressed form is not read"));
    assert!(error(&with_letter("B")).contains("line 1: IGES in binary form is not read"));
    assert!(error("solid cube\n").contains("found \"solid cube\" where a line with an S in column 73 should be"));
    assert!(error("").contains("a line with an S in column 73"));
    // Nothing but a start.
    let start = good.lines().next().unwrap();
    assert!(error(start).contains("it shows no faces"), "{}", error(start));
}

#[test]
fn a_bad_part_costs_its_face_and_is_named() {
    // Each makes a trimmed surface of a sound one, and something that is wrong.
    type Add = fn(&mut Writer, usize) -> String;
    let wrong: [(&str, Add); 14] = [
        ("there is no directory entry of this number", |_, s| format!("{s},1,0,999")),
        ("parameter 3 counts 3 items", |_, s| format!("{s},0,3,0")),
        ("it is of type 128, where a curve on a surface (142) is needed", |_, s| format!("{s},1,0,{s}")),
        ("it has no curve", |w, s| format!("{s},1,0,{}", w.add(142, 0, "0,0,0,0,0"))),
        ("it has no outer boundary", |_, s| format!("{s},1,0,0")),
        ("is not a number", |w, s| {
            let line = w.add(110, 0, "0.0,NaN,0.0,1.0,1.0,0.0");
            format!("{s},1,0,{}", w.on_surface(s, line, 0))
        }),
        ("is not a number", |w, s| {
            let line = w.add(110, 0, "0.0,1E999,0.0,1.0,1.0,0.0");
            format!("{s},1,0,{}", w.on_surface(s, line, 0))
        }),
        ("curves of type 116 are not read", |w, s| {
            let point = w.point([0.0; 3]);
            format!("{s},1,0,{}", w.on_surface(s, point, 0))
        }),
        ("it has no length", |w, s| {
            let line = w.line([0.5, 0.5, 0.0], [0.5, 0.5, 0.0]);
            let curve = w.add(102, 0, &format!("0,{line}"));
            format!("{s},1,0,{}", w.on_surface(s, curve, 0))
        }),
        ("it is made of curves too deep", |w, s| {
            let curve = w.add(102, 0, "");
            w.set_parameters(curve, &format!("1,{curve}"));
            format!("{s},1,0,{}", w.on_surface(s, curve, 0))
        }),
        ("offsets by a function are not read", |w, s| {
            let line = w.line([0.0; 3], [1.0, 0.0, 0.0]);
            let curve = w.add(130, 0, &format!("{line},3,{line},1,2,1.0,0.0,1.0,1.0,0.0,0.0,1.0,0.0,1.0"));
            format!("{s},1,0,{}", w.on_surface(s, curve, 0))
        }),
        ("the arc has no radius", |w, s| {
            let arc = w.numbers(100, 0, &[0.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0]);
            format!("{s},1,0,{}", w.on_surface(s, arc, 0))
        }),
        ("degree", |w, s| {
            let spline = w.add(126, 0, "900,800,0,0,1,0,1.0");
            format!("{s},1,0,{}", w.on_surface(s, spline, 0))
        }),
        ("is not in that of its knots", |w, s| {
            let text = "1,1,0,0,1,0,0.0,0.0,1.0,1.0,1.0,1.0,0.0,0.0,0.0,1.0,1.0,0.0,3.0,7.0,0.0,0.0,1.0";
            let spline = w.add(126, 0, text);
            format!("{s},1,0,{}", w.on_surface(s, spline, 0))
        }),
    ];
    for (expected, add) in wrong {
        let mut number = 0;
        let lost = beside(|w| {
            let surface = square(w, 5.0, "00010000");
            let text = add(w, surface);
            number = w.add(144, 0, &text) as u64;
            w.set_status(number as usize, INDEPENDENT);
        });
        let is_told = lost.iter().any(|(place, text)| {
            matches!(place, Place::Entity { number: own, line, .. } if *own == number && 0 < *line)
                && text.contains(expected)
        });
        assert!(is_told || expected == "degree" && lost.len() == 1, "{expected}: {lost:?}");
    }
}

#[test]
fn surfaces_that_say_too_much_or_too_little_are_left_out() {
    let texts = [
        (128, "999999999,999999999,1,1,0,0,1,0,0"),
        (128, "1,1,1,1,0,0,1,0,0,1.0,0.0"),
        (128, "1,1,1,1,0,0,1,0,0,0.0,0.0,1.0,1.0,0.0,0.0,1.0,1.0,1.0,-1.0,1.0,1.0"),
        (114, "3,1,900000,900000,0.0"),
        (120, "0,0,0.0,1.0"),
        (122, "0,1.0,0.0,0.0"),
        (118, "1,1,0,0"),
        (140, "0.0,0.0,1.0,1.0,0"),
        (192, "0,0,1.0"),
        (108, "0.0,0.0,0.0,1.0,0"),
        (186, "0,1,0"),
        (514, "77777,1,1"),
        (150, "1.0,1.0,1.0"),
    ];
    for (kind, text) in texts {
        let lost = beside(|w| {
            let number = w.add(kind, 0, text);
            w.set_status(number, INDEPENDENT);
        });
        assert_eq!(lost.len(), 1, "{kind}: {lost:?}");
    }
}

#[test]
fn a_string_of_a_gigabyte_is_an_error_at_once() {
    for text in ["1,1000000000Habc,1", "99999999999999999999H"] {
        let lost = beside(|w| {
            let number = w.add(128, 0, text);
            w.set_status(number, INDEPENDENT);
        });
        assert_eq!(lost.len(), 1, "{lost:?}");
    }
    let good = case("holes");
    let changed = good.replacen("4Hpart,", "999999999Hpart,", 1);
    assert!(read(&changed).is_ok_and(|document| document.unit.is_none()));
}

#[test]
fn cycles_of_matrices_surfaces_and_definitions_end() {
    let lost = beside(|w| {
        let surface = square(w, 1.0, INDEPENDENT);
        let matrix = w.matrix([[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]]);
        w.set_matrix(matrix, matrix);
        w.set_matrix(surface, matrix);
        let offset = w.add(140, 0, "");
        w.set_parameters(offset, &format!("0.0,0.0,1.0,1.0,{offset}"));
        let definition = w.add(308, 0, "");
        let instance = w.add(408, 0, &format!("{definition},0.0,0.0,0.0,1.0"));
        w.set_parameters(definition, &format!("0,1Hx,1,{instance}"));
        let outside = w.add(408, 0, &format!("{definition},0.0,0.0,0.0,1.0"));
        w.set_status(outside, INDEPENDENT);
    });
    let told = |part: &str| lost.iter().any(|(_, text)| text.contains(part));
    assert!(told("matrices have matrices too deep") && told("it stands in itself"), "{lost:?}");
}

/// Sixty definitions, each of which holds the next one twice: 2⁶⁰ faces.
#[test]
fn definitions_that_double_are_cut_off() {
    let mut w = Writer::new();
    let surface = square(&mut w, 0.0, "00010000");
    let mut inner = w.add(308, 0, &format!("0,1Hx,1,{surface}"));
    for _ in 0..60 {
        let [a, b] = [0, 1].map(|k| w.add(408, 0, &format!("{inner},{k}.0,0.0,0.0,1.0")));
        inner = w.add(308, 0, &format!("0,1Hx,2,{a},{b}"));
    }
    let whole = w.add(408, 0, &format!("{inner},0.0,0.0,0.0,1.0"));
    w.set_status(whole, INDEPENDENT);
    let document = read(&w.file()).unwrap();
    assert!(document.notes.iter().any(|note| note.text.contains("more than are shown")), "{:?}", document.notes);
}

#[test]
fn what_the_file_hides_is_noted() {
    let lost = beside(|w| {
        square(w, 3.0, BLANKED);
    });
    assert!(lost.len() == 1 && lost[0].1.contains("1 entities that the file hides"), "{lost:?}");
    let mut w = Writer::new();
    square(&mut w, 3.0, BLANKED);
    assert!(error(&w.file()).contains("it hides all that it shows: 1 entities"));
}

/// Lines that were lost: numbers that ascend are believed, so that what is left keeps its names.
#[test]
fn lost_lines_cost_what_they_hold() {
    let text = case("copious");
    let lines: Vec<&str> = text.lines().collect();
    let first = lines.iter().position(|line| line.as_bytes()[72] == b'D').unwrap();
    for k in first..lines.len() {
        let kept: Vec<&str> = lines.iter().enumerate().filter(|(i, _)| *i != k).map(|(_, line)| *line).collect();
        let document = read(&kept.join("\n"));
        // One of the two faces, if any, is what it was.
        let losses = document.map(|d| d.notes.iter().filter(|note| note.kind.is_loss()).count());
        assert!(losses.as_ref().map_or(true, |losses| 0 < *losses), "without line {}: {losses:?}", k + 1);
    }
}

/// A boundary of ten thousand pieces in (u, v) beside one in space of as many spans, which is elsewhere or not.
#[test]
fn boundaries_of_many_pieces_are_compared_in_time() {
    const MANY: usize = 10_000;
    let mut w = Writer::new();
    let surface = square(&mut w, 0.0, "00010000");
    let place = |k: usize| {
        let angle = std::f64::consts::TAU * (k % MANY) as f64 / MANY as f64;
        [0.5 + 0.4 * angle.cos(), 0.5 + 0.4 * angle.sin(), 0.0]
    };
    let sides: Vec<usize> = (0..MANY).map(|k| w.line(place(k), place(k + 1))).collect();
    let plane = w.composite(&sides);
    let points: Vec<f64> = (0..=MANY).flat_map(|k| place(k).map(|x| 10.0 * x)).collect();
    let space = w.add(106, 12, &format!("2,{},{}", MANY + 1, list(&points)));
    let outer = w.on_surface(surface, plane, space);
    w.trimmed(surface, outer, &[]);
    let document = read(&w.file()).unwrap();
    assert_eq!(document.model.faces()[0].loops[0].trims.len(), MANY, "{:?}", document.notes);
}

/// What only its own parts name is reached from nowhere: it is told, and not left out in silence.
#[test]
fn what_is_a_part_of_itself_is_told() {
    let lost = beside(|w| {
        let own = w.add(140, 0, "");
        w.set_parameters(own, &format!("0.0,0.0,1.0,0.1,{own}"));
    });
    assert!(lost.len() == 1 && lost[0].1.contains("it is a part of itself"), "{lost:?}");
    let lost = beside(|w| {
        let [a, b] = [w.add(140, 0, ""), w.add(140, 0, "")];
        w.set_parameters(a, &format!("0.0,0.0,1.0,0.1,{b}"));
        w.set_parameters(b, &format!("0.0,0.0,1.0,0.1,{a}"));
    });
    assert!(lost.len() == 2 && lost.iter().all(|(_, why)| why.contains("it is a part of itself")), "{lost:?}");
    let lost = beside(|w| {
        let definition = w.add(308, 0, "");
        let instance = w.add(408, 0, &format!("{definition},0.0,0.0,0.0,1.0"));
        w.set_parameters(definition, &format!("0,1Hx,1,{instance}"));
    });
    assert!(lost.len() == 1 && lost[0].1.contains("it is a part of itself"), "{lost:?}");
    // A definition that nothing places is no loss: no file shows it.
    let lost = beside(|w| {
        let surface = square(w, 5.0, DEPENDENT);
        w.add(308, 0, &format!("0,1Hx,1,{surface}"));
    });
    assert!(lost.is_empty(), "{lost:?}");
}

/// What is scaled beyond all numbers is left out, and not drawn at another size; so is what is scaled by no number.
#[test]
fn what_cannot_be_scaled_is_left_out() {
    for (scale, why) in [("1.0E300", "not a finite number of usable size"), ("NaN", "its scale is no number above 0")] {
        let lost = beside(|w| {
            let surface = square(w, 5.0, DEPENDENT);
            let definition = w.add(308, 0, &format!("0,1Hx,1,{surface}"));
            w.add(408, 0, &format!("{definition},0.0,0.0,0.0,{scale}"));
        });
        assert!(lost.len() == 1 && lost[0].1.contains(why), "{scale}: {lost:?}");
    }
}

#[test]
fn a_scale_and_a_resolution_that_are_no_numbers_are_told() {
    let good = case("holes");
    let global: Vec<&str> = good.lines().filter(|line| line.as_bytes().get(72) == Some(&b'G')).collect();
    let text: String = global.iter().map(|line| &line[..72]).collect();
    let values: Vec<&str> = text.trim_end().trim_end_matches(';').split(',').collect();
    for (at, what) in [(13, "model scale"), (19, "resolution")] {
        for wrong in ["NaN", "-1.0", "1.0E999"] {
            // The first parameter is a comma itself.
            let mut values = values.clone();
            values[at] = wrong;
            let text = values.join(",") + ";";
            let cards: String = text
                .as_bytes()
                .chunks(72)
                .enumerate()
                .map(|(k, card)| format!("{:72}G{:7}\n", String::from_utf8_lossy(card), k + 1))
                .collect();
            let old = global.iter().map(|line| format!("{line}\n")).collect::<String>();
            assert!(good.contains(&old));
            let document = read(&good.replacen(&old, &cards, 1)).unwrap_or_else(|error| panic!("{error}"));
            let told = document
                .notes
                .iter()
                .any(|note| note.to_string().contains(&format!("its {what} is no number above 0")));
            assert!(told, "{what} {wrong}: {:?}", document.notes);
        }
    }
}
