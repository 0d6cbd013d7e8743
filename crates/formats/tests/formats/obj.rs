//! Free-form `.obj`: the examples of its specification, and what is wrong, refused and damaged.

use crate::common::{model_bits, outline, root, winding};
use formats::{Document, FORMATS, Format, FormatError, NoteKind, Place, open};
use glam::{DVec2, DVec3, dvec3};
use models::builtin;
use nurbs::Direction;
use proptest::prelude::*;
use scene::FaceId;
use std::fmt::Write;

fn read(text: &str) -> Result<Document, FormatError> {
    format().read(text.as_bytes(), "test.obj")
}

fn format() -> &'static dyn Format {
    *FORMATS.iter().find(|format| format.name() == "OBJ").unwrap()
}

fn sample(name: &str) -> Document {
    open(root().join("testdata/obj").join(name)).unwrap_or_else(|e| panic!("{e}"))
}

fn notes(document: &Document) -> Vec<String> {
    document.notes.iter().map(ToString::to_string).collect()
}

/// Bernstein's polynomials at t, by their definition.
fn bernstein<const N: usize>(t: f64) -> [f64; N] {
    let choose = |i: usize| (1..=i).fold(1.0, |c, k| c * (N - k) as f64 / k as f64);
    std::array::from_fn(|i| choose(i) * t.powi(i as i32) * (1.0 - t).powi((N - 1 - i) as i32))
}

#[test]
fn the_trimmed_surface_of_the_specification_is_its_formula() {
    let document = sample("trimmed.obj");
    let surface = document.model.surface(FaceId(0));
    assert_eq!(surface.domain(), [[-1.0, 2.5], [-2.0, 2.0]]);
    // As in the file, u fastest.
    let points = [
        (dvec3(-1.35, -1.03, 0.0), 1.0),
        (dvec3(0.13, -1.03, 0.432), 7.6),
        (dvec3(1.48, -1.03, 0.0), 2.3),
        (dvec3(-1.46, 0.06, 0.201), 1.0),
        (dvec3(0.12, 0.06, 0.915), 0.5),
        (dvec3(1.38, 0.06, 0.454), 1.5),
        (dvec3(-1.48, 1.03, 0.0), 2.3),
        (dvec3(0.12, 1.03, 0.394), 6.1),
        (dvec3(1.17, 1.03, 0.0), 3.3),
    ];
    for k in 0..400 {
        let (s, t) = ((k / 20) as f64 / 19.0, (k % 20) as f64 / 19.0);
        let (a, b) = (bernstein::<3>(s), bernstein::<3>(t));
        let (mut sum, mut weight) = (DVec3::ZERO, 0.0);
        for (i, (p, w)) in points.iter().enumerate() {
            let share = w * a[i % 3] * b[i / 3];
            (sum, weight) = (sum + *p * share, weight + share);
        }
        let off = surface.point(-1.0 + 3.5 * s, -2.0 + 4.0 * t).distance(sum / weight);
        assert!(off < 1e-14, "{s} {t}: {off:e}");
    }
}

#[test]
fn the_trim_of_the_specification_lets_in_what_is_inside_its_curve() {
    let document = sample("trimmed.obj");
    let weighted = [
        (DVec2::new(-0.675, 1.85), 3.0),
        (DVec2::new(0.915, 1.93), 1.0),
        (DVec2::new(2.485, 0.47), 2.0),
        (DVec2::new(2.485, -1.03), 1.0),
        (DVec2::new(1.605, -1.89), 10.7),
        (DVec2::new(-0.745, -0.654), 0.5),
        (DVec2::new(-0.675, 1.85), 3.0),
    ];
    let mut polygon = vec![];
    for k in 0..2000 {
        let b = bernstein::<4>((k % 1000) as f64 / 1000.0);
        let piece = &weighted[3 * (k / 1000)..];
        let weight: f64 = (0..4).map(|i| b[i] * piece[i].1).sum();
        polygon.push((0..4).map(|i| piece[i].0 * (b[i] * piece[i].1)).sum::<DVec2>() / weight);
    }
    let sides = outline(&document.model.faces()[0].loops);
    let (mut inside, mut outside) = (0, 0);
    for k in 0..900 {
        let uv = DVec2::new(-1.0 + 3.5 * ((k / 30) as f64 + 0.5) / 30.0, -2.0 + 4.0 * ((k % 30) as f64 + 0.5) / 30.0);
        if polygon.iter().any(|p| p.distance(uv) < 0.01) {
            continue;
        }
        // An even number of the polygon's sides crosses a ray from a point outside.
        let crosses = |k: &usize| {
            let (a, b) = (polygon[*k], polygon[(k + 1) % polygon.len()]);
            (a.y > uv.y) != (b.y > uv.y) && uv.x < a.x + (b.x - a.x) * (uv.y - a.y) / (b.y - a.y)
        };
        let is_inside = (0..polygon.len()).filter(crosses).count() % 2 == 1;
        assert_eq!(winding(&sides, uv) != 0, is_inside, "{uv}");
        *if is_inside { &mut inside } else { &mut outside } += 1;
    }
    assert!(inside > 200 && outside > 200, "{inside} in, {outside} out");
    assert_eq!(notes(&document), ["line 36: scrv: special curves are not drawn: they are for triangles"]);
}

#[test]
fn points_run_fastest_along_u_over_continued_lines() {
    let document = sample("patch.obj");
    let surface = document.model.surface(FaceId(0));
    assert_eq!(surface.degree(), [3, 3]);
    assert_eq!(surface.point(0.0, 0.0), dvec3(5.0, -5.0, 0.0));
    assert_eq!(surface.point(1.0, 0.0), dvec3(5.0, 5.0, 0.0));
    assert_eq!(surface.point(0.0, 1.0), dvec3(-5.0, -5.0, 0.0));
    assert_eq!(document.notes, []);
}

#[test]
fn newells_teapot_comes_back_bit_for_bit() {
    let teapot = builtin("teapot").unwrap();
    let mut text = "cstype bezier\ndeg 3 3\n".to_owned();
    for surface in teapot.surfaces() {
        for p in surface.points() {
            writeln!(text, "v {} {} {}", p.x, p.y, p.z).unwrap();
        }
        let order = (0..4).flat_map(|j| (0..4).map(move |i| (4 * i + j) - 16));
        let references = order.map(|k: i32| k.to_string()).collect::<Vec<_>>().join(" ");
        writeln!(text, "surf 0 1 0 1 {references}\nparm u 0 1\nparm v 0 1\nend").unwrap();
    }
    let document = read(&text).unwrap();
    assert!(model_bits(&document.model) == model_bits(&teapot));
    assert_eq!(document.notes, []);
}

#[test]
fn holes_alone_have_the_surface_for_their_outer_boundary() {
    let document = sample("holes.obj");
    let model = &document.model;
    assert_eq!(model.surface(FaceId(0)).knots(Direction::U).domain(), (0.0, 2.0));
    let sides = outline(&model.faces()[0].loops);
    let circle = |uv: DVec2| uv.distance(DVec2::new(0.7, 0.5)) - 0.2;
    // The corners (1.2, 0.2), (1.5, 0.2), (1.5, 0.6), on whose left side material is not.
    let triangle = |uv: DVec2| {
        let slope = DVec2::new(0.3, 0.4).normalize();
        (0.2 - uv.y).max(uv.x - 1.5).max(slope.perp_dot(uv - DVec2::new(1.2, 0.2)))
    };
    let mut compared = 0;
    for k in 0..1600 {
        let uv = DVec2::new(2.0 * ((k / 40) as f64 + 0.5) / 40.0, ((k % 40) as f64 + 0.5) / 40.0);
        let hole = circle(uv).min(triangle(uv));
        if hole.abs() > 1e-3 {
            assert_eq!(winding(&sides, uv) == 0, hole < 0.0, "{uv}");
            compared += 1;
        }
    }
    assert!(compared > 1500);
    let area = std::f64::consts::PI * 0.04 + 0.06;
    assert!((model.region(FaceId(0)).unwrap().area() - (2.0 - area)).abs() < 1e-12);
}

#[test]
fn a_surface_stated_over_less_than_its_knots_ends_there() {
    let document = sample("holes.obj");
    let model = &document.model;
    assert_eq!(model.surface(FaceId(1)).domain(), [[0.0, 3.0], [10.0, 20.0]]);
    assert!((model.region(FaceId(1)).unwrap().area() - 25.0).abs() < 1e-12);
    // Two pieces of degree 2 that share their middle point.
    assert_eq!(model.surface(FaceId(1)).point(1.0, 10.0), dvec3(2.0, 0.0, 1.0));
}

#[test]
fn what_is_not_drawn_is_noted_with_its_line() {
    let found = notes(&sample("holes.obj"));
    let expected = [
        "line 55: 2 statements f, the first here: polygons are not drawn",
        "line 57: p: points are not drawn",
        "line 60: surf \"strip\": cstype \"cardinal\" (line 58) is not converted",
    ];
    assert_eq!(found, expected);
}

#[test]
fn a_wrong_element_costs_itself_and_is_named() {
    let good = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\ncstype bezier\ndeg 1 1\n";
    let end = "parm u 0 1\nparm v 0 1\nend\n";
    let whole = format!("surf 0 1 0 1 1 2 3 4\n{end}");
    for (wrong, expected) in [
        (format!("surf 0 1 0 1 1 2 3 9\n{end}"), "line 7: surf: surf: there is no number 9 among 4 before it"),
        (format!("surf 0 1 0 1 1 2 3 -5\n{end}"), "there is no number -5 among 4"),
        (format!("surf 0 1 0 1 1 2 3 0\n{end}"), "there is no number 0 among 4"),
        (format!("surf 0 1 0 1 1 2 3\n{end}"), "3 control points, and deg and parm ask for 4"),
        (format!("surf 0 nan 0 1 1 2 3 4\n{end}"), "NaN is not finite"),
        (format!("surf 0 2 0 1 1 2 3 4\n{end}"), "its knots are over"),
        ("surf 0 1 0 1 1 2 3 4\nparm u 0 1\nend\n".into(), "parm v has 0 values"),
        ("surf 0 1 0 1 1 2 3 4\nparm u 1 0\nparm v 0 1\nend\n".into(), "parm u: "),
        (
            "surf 0 1 0 1 1 2 3 4\ntrim 0 1 1\nparm u 0 1\nparm v 0 1\nend\n".into(),
            "line 8: surf: trim: there is no number 1",
        ),
        ("surf 0 1 0 1 1 2 3 4\n".into(), "line 7: surf: it has no end"),
        (
            format!("cstype taylor\nsurf 0 1 0 1 1 2 3 4\n{end}cstype bezier\n"),
            "cstype \"taylor\" (line 7) is not converted",
        ),
        (format!("deg 16 1\nsurf 0 1 0 1 1 2 3 4\n{end}deg 1 1\n"), "parm u: "),
        ("v 1 2\n".into(), "line 7: v: a number is missing"),
        ("frobnicate 1\n".into(), "line 7: frobnicate: an unknown statement"),
        ("trim 0 1 1\n".into(), "line 7: trim: there is no number 1 among 0"),
        ("end\n".into(), "line 7: end: no element is open"),
    ] {
        let document = read(&format!("{good}{wrong}{whole}")).unwrap_or_else(|e| panic!("{wrong}: {e}"));
        assert_eq!(document.model.faces().len(), 1, "{wrong}");
        let found = notes(&document);
        assert!(found.len() == 1 && found[0].contains(expected), "{wrong}: {found:?}");
        assert!(document.notes[0].kind == NoteKind::LeftOut && matches!(document.notes[0].place, Place::Line(7 | 8)));
    }
}

#[test]
fn a_file_of_polygons_alone_is_an_error_that_says_so() {
    let error = read("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap_err().to_string();
    assert_eq!(error, "test.obj: nothing in it can be drawn; the first of 1 notes: line 4: f: polygons are not drawn");
    assert!(read("").unwrap_err().to_string().contains("it has no surf"));
}

#[test]
fn loops_that_repeat_a_curve_without_end_are_refused() {
    let head = "vp 0 0\nvp 1 0\ncstype bezier\ndeg 1\ncurv2 1 2\nparm u 0 1\nend\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\ndeg 1 1\n";
    let text = format!("{head}surf 0 1 0 1 1 2 3 4\ntrim {}\nparm u 0 1\nparm v 0 1\nend\n", "0 1 1 ".repeat(1000));
    let error = read(&text).unwrap_err().to_string();
    assert!(error.contains("line 14: surf: trim: loops repeat the file's curves more than 16 times"), "{error}");
}

#[test]
fn a_file_without_an_extension_is_known_by_its_first_statement() {
    assert!(format().sniff(b"# a comment\n\nmtllib a.mtl\nv 0 0 0"));
    assert!(!format().sniff(b"32\n1 2 3"));
    assert!(!format().sniff(b"{}"));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    #[test]
    fn changed_and_cut_files_give_a_document_or_an_error(
        name in prop::sample::select(&["trimmed.obj", "patch.obj", "holes.obj"][..]),
        changes in prop::collection::vec((any::<prop::sample::Index>(), prop::sample::select(b"0123456789-. \n\\/#e\xff".to_vec())), 1..12),
        cut in prop::option::of(any::<prop::sample::Index>()),
    ) {
        let mut bytes = std::fs::read(root().join("testdata/obj").join(name)).unwrap();
        for (place, byte) in changes {
            let place = place.index(bytes.len());
            bytes[place] = byte;
        }
        if let Some(cut) = cut {
            bytes.truncate(cut.index(bytes.len()));
        }
        if let Err(error) = format().read(&bytes, "changed.obj") {
            prop_assert!(error.to_string().starts_with("changed.obj: "));
        }
    }
}

#[test]
fn a_surface_has_the_name_of_the_group_or_the_object_before_it() {
    let patch = "surf 0 1 0 1 1 2 3 4\nparm u 0 1\nparm v 0 1\nend\n";
    let text = format!(
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\ncstype bezier\ndeg 1 1\n{patch}g left wing\n{patch}o tail\n{patch}"
    );
    let document = read(&text).unwrap();
    let names: Vec<Option<&str>> = document.attributes.iter().map(|said| said.name.as_deref()).collect();
    assert_eq!(names, [None, Some("left wing"), Some("tail")]);
}

/// A point that makes no sense costs the surfaces that name it, and the numbers of those behind it stay.
#[test]
fn a_point_that_makes_no_sense_keeps_its_number() {
    let start = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\n";
    let end = "cstype bezier\ndeg 1 1\nsurf 0 1 0 1 1 2 3 4\nparm u 0 1\nparm v 0 1\nend\n";
    let whole = read(&format!("{start}{end}")).unwrap();
    for wrong in ["v NaN 0 0", "v 1e999 0 0", "v 1 2", "v 1 2 3 4 5", "v 1 2 3 4 5 6 7 8"] {
        let text = format!("{wrong}\n{start}{}", end.replace("1 2 3 4", "2 3 4 5"));
        let document = read(&text).unwrap();
        assert_eq!(model_bits(&document.model), model_bits(&whole.model), "{wrong}");
        let notes = notes(&document);
        assert!(notes.len() == 1 && notes[0].starts_with("line 1: v: "), "{wrong}: {notes:?}");
        let document = read(&format!("{text}{end}")).unwrap();
        let is_told = document.notes.iter().any(|note| note.text.contains("its point 1 makes no sense"));
        assert!(is_told && document.model.faces().len() == 1, "{wrong}: {:?}", document.notes);
    }
    // So it is in a parameter space.
    let trimmed = |points: &str, numbers: &str| {
        format!(
            "{points}{start}cstype bspline\ndeg 1\ncurv2 {numbers}\nparm u 0 0 1 2 3 3\nend\n{}",
            end.replace("parm v 0 1\n", "parm v 0 1\ntrim 0 3 1\n")
        )
    };
    let whole = read(&trimmed("vp 0 0\nvp 1 0\nvp 1 1\n", "1 2 3 1")).unwrap();
    let document = read(&trimmed("vp 0 x\nvp 0 0\nvp 1 0\nvp 1 1\n", "2 3 4 2")).unwrap();
    assert_eq!(model_bits(&document.model), model_bits(&whole.model));
    let text = trimmed("vp 0 x\nvp 0 0\nvp 1 0\nvp 1 1\n", "1 2 3 1");
    let document = read(&format!("{text}{end}")).unwrap();
    let is_told = document.notes.iter().any(|note| note.text.contains("its point 1 makes no sense"));
    assert!(is_told && document.model.faces().len() == 1, "{:?}", document.notes);
}
