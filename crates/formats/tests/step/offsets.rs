//! Curves and surfaces at a distance from splines: within what the note says, or left out by name.

use crate::corpus;
use crate::green::area_and_volume;
use crate::writer::{DOWN, Units, Writer, X, Z, list};
use formats::{Document, FORMATS, NoteKind};
use std::f64::consts::{FRAC_1_SQRT_2, PI};

fn read(text: &str) -> Document {
    let step = FORMATS.iter().find(|format| format.name() == "STEP").expect("it is in the list");
    step.read(text.as_bytes(), "part.step").unwrap_or_else(|error| panic!("{error}"))
}

fn notes(document: &Document, kind: NoteKind) -> Vec<String> {
    document.notes.iter().filter(|note| note.kind == kind).map(ToString::to_string).collect()
}

/// A square with round corners, its sides' middles 2 from its own: a closed uniform quadratic, counter-clockwise.
fn rounded(w: &mut Writer, z: f64) -> u64 {
    let corners =
        [[2.0, 0.0], [2.0, 2.0], [0.0, 2.0], [-2.0, 2.0], [-2.0, 0.0], [-2.0, -2.0], [0.0, -2.0], [2.0, -2.0]];
    let points: Vec<u64> = (0..10).map(|k| w.point([corners[k % 8][0], corners[k % 8][1], z])).collect();
    w.add(format_args!("UNIFORM_CURVE('',2,{},.UNSPECIFIED.,.T.,.F.)", list(&points)))
}

/// Around a convex section of length L and area A, an offset by d has L + 2 π d and A + L d + π d² (Steiner).
#[test]
fn a_prism_within_offset_curves_and_an_offset_wall_is_that_of_steiner() {
    let (d, height) = (0.5, 3.0);
    let mut w = Writer::new("AUTOMOTIVE_DESIGN");
    let [up, down] = [Z, DOWN].map(|axis| w.direction(axis));
    // Outward is the tangent's right hand: −z × T.
    let beside = |w: &mut Writer, z: f64| {
        let curve = rounded(w, z);
        (curve, w.add(format_args!("OFFSET_CURVE_3D('',#{curve},{d:?},.F.,#{down})")))
    };
    let ((base, low), (_, high)) = (beside(&mut w, 0.0), beside(&mut w, height));
    let vector = w.add(format_args!("VECTOR('',#{up},1.)"));
    let wall = w.add(format_args!("SURFACE_OF_LINEAR_EXTRUSION('',#{base},#{vector})"));
    let wall = w.add(format_args!("OFFSET_SURFACE('',#{wall},{d:?},.F.)"));
    // A quadratic passes the middle of its first side.
    let [a, b] = [0.0, height].map(|z| w.vertex([2.0 + d, 1.0, z]));
    let (bottom, top) = (w.edge([a, a], low, true), w.edge([b, b], high, true));
    let bounds = [w.bound("FACE_BOUND", &[(bottom, true)]), w.bound("FACE_BOUND", &[(top, false)])];
    let mut faces = vec![w.face(&bounds, wall, true)];
    for (z, edge, is_up) in [(0.0, bottom, false), (height, top, true)] {
        let bound = w.bound("FACE_BOUND", &[(edge, is_up)]);
        let placement = w.placement([0.0, 0.0, z], if is_up { Z } else { DOWN }, X);
        let plane = w.add(format_args!("PLANE('',#{placement})"));
        faces.push(w.face(&[bound], plane, true));
    }
    let solid = w.solid(&faces);
    let context = w.context(Units::MillimetreRadian);
    w.representation(&[solid], context);
    let document = corpus::opened(["step", "step"], "offset-prism", &w.file());
    // As in `cases::extrusion`.
    let (area, length) = (14.0 + 4.0 / 3.0, 8.0 + 4.0 * (1.0 + (1.0 + 2f64.sqrt()).ln() / 2f64.sqrt()));
    let (area, length) = (area + length * d + PI * d * d, length + 2.0 * PI * d);
    let found = area_and_volume(&document.model);
    let expected = [2.0 * area + length * height, area * height];
    assert!((found.x / expected[0] - 1.0).abs() < 1e-9 && (found.y / expected[1] - 1.0).abs() < 1e-9, "{found}");
    let told = notes(&document, NoteKind::Approximated);
    assert!(told.iter().any(|note| note.contains("3 faces") && note.contains("offsets of splines")), "{told:?}");
}

/// A sphere of radius 2 as a rational spline, with poles and a seam; its offset is a sphere, inside or outside.
#[test]
fn the_offset_of_a_spline_ball_is_a_ball() {
    for distance in [0.5, -0.5] {
        let mut w = Writer::new("AUTOMOTIVE_DESIGN");
        let square =
            [[1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [-1.0, 1.0], [-1.0, 0.0], [-1.0, -1.0], [0.0, -1.0], [1.0, -1.0]];
        let half = [[0.0, -2.0], [2.0, -2.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]];
        let row = |w: &mut Writer, k: usize| {
            let [x, y] = square[k % 8];
            list(&half.map(|[r, z]| w.point([r * x, r * y, z])))
        };
        let rows: Vec<String> = (0..9).map(|k| row(&mut w, k)).collect();
        let weight = |k: usize| [1.0, FRAC_1_SQRT_2][k % 2];
        let weights = (0..9).map(|i| {
            format!("({})", (0..5).map(|j| format!("{:?}", weight(i) * weight(j))).collect::<Vec<_>>().join(","))
        });
        let weights: Vec<String> = weights.collect();
        let surface = w.add(format_args!(
            "(BOUNDED_SURFACE()B_SPLINE_SURFACE(2,2,({}),.UNSPECIFIED.,.F.,.F.,.F.)B_SPLINE_SURFACE_WITH_KNOTS((3,2,2,2,3),(3,2,3),\
             (0.,1.,2.,3.,4.),(0.,1.,2.),.UNSPECIFIED.)GEOMETRIC_REPRESENTATION_ITEM()RATIONAL_B_SPLINE_SURFACE(({}))\
             REPRESENTATION_ITEM('')SURFACE())",
            rows.join(","),
            weights.join(",")
        ));
        let offset = w.add(format_args!("OFFSET_SURFACE('',#{surface},{distance:?},.F.)"));
        let set = w.add(format_args!("GEOMETRIC_SET('',(#{offset}))"));
        let context = w.context(Units::MillimetreRadian);
        w.add(format_args!("GEOMETRICALLY_BOUNDED_SURFACE_SHAPE_REPRESENTATION('',(#{set}),#{context})"));
        let document = read(&w.file());
        let (found, r) = (area_and_volume(&document.model), 2.0 + distance);
        let off = [found.x / (4.0 * PI * r * r) - 1.0, found.y / (4.0 / 3.0 * PI * r.powi(3)) - 1.0];
        assert!(off.iter().all(|off| off.abs() < 1e-9), "{distance}: {off:?}");
        assert_eq!(document.attributes[0].surface, formats::SurfaceKind::Offset);
        let told = notes(&document, NoteKind::Approximated);
        assert!(told.len() == 1 && told[0].contains("1 faces, this one the first, are on offsets"), "{told:?}");
    }
}

/// A crease has no offset that is one surface, and a point has no normal: each costs its face, and is named.
#[test]
fn what_has_no_offset_is_left_out_by_name() {
    let roof = "((#1,#2),(#3,#4),(#5,#6)),.UNSPECIFIED.,.F.,.F.,.F.,(2,1,2),(2,2),(0.,1.,2.),(0.,1.),.UNSPECIFIED.";
    let point = "((#1,#1),(#1,#1)),.UNSPECIFIED.,.F.,.F.,.F.,(2,2),(2,2),(0.,1.),(0.,1.),.UNSPECIFIED.";
    for (net, why) in [(roof, "a crease"), (point, "no normal at (0, 0)")] {
        let mut w = Writer::new("AUTOMOTIVE_DESIGN");
        for k in 0..6 {
            let (i, j) = (f64::from(k / 2), f64::from(k % 2));
            w.point([i, j, if k / 2 == 1 { 1.0 } else { 0.0 }]);
        }
        let surface = w.add(format_args!("B_SPLINE_SURFACE_WITH_KNOTS('',1,1,{net})"));
        let offset = w.add(format_args!("OFFSET_SURFACE('',#{surface},0.1,.F.)"));
        let placement = w.placement([0.0; 3], Z, X);
        let ball = w.add(format_args!("SPHERICAL_SURFACE('',#{placement},1.)"));
        let set = w.add(format_args!("GEOMETRIC_SET('',(#{offset},#{ball}))"));
        let context = w.context(Units::MillimetreRadian);
        w.add(format_args!("GEOMETRICALLY_BOUNDED_SURFACE_SHAPE_REPRESENTATION('',(#{set}),#{context})"));
        let document = read(&w.file());
        let told = notes(&document, NoteKind::LeftOut);
        assert_eq!((document.model.faces().len(), told.len()), (1, 1), "{told:?}");
        assert!(told[0].contains(&format!("#{offset} OFFSET_SURFACE: left out")) && told[0].contains(why), "{told:?}");
    }
}

/// Offsets of a surface with creases cost much, and come to nothing: what they may cost is theirs alone, and ends.
#[test]
fn offsets_that_come_to_nothing_cost_their_faces_alone() {
    let mut w = Writer::new("AUTOMOTIVE_DESIGN");
    let rows: Vec<String> = (0..20u32)
        .map(|i| {
            let bumps = |j: u32| 0.5 * f64::from((7 * i + 5 * j) % 11);
            list(&(0..20).map(|j| w.point([f64::from(i), f64::from(j), bumps(j)])).collect::<Vec<u64>>())
        })
        .collect();
    let inner = |value: &dyn Fn(u32) -> String| (0..18).map(value).collect::<Vec<String>>().join(",");
    let multiplicities = inner(&|k| if k % 17 == 0 { "4" } else { "1" }.to_owned());
    let knots = inner(&|k| format!("{k}."));
    let surface = w.add(format_args!(
        "B_SPLINE_SURFACE_WITH_KNOTS('',3,3,({}),.UNSPECIFIED.,.F.,.F.,.F.,({multiplicities}),({multiplicities}),({knots}),({knots}),.U.)",
        rows.join(",")
    ));
    let offsets: Vec<u64> =
        (1..=300).map(|k| w.add(format_args!("OFFSET_SURFACE('',#{surface},{:?},.F.)", 0.01 * f64::from(k)))).collect();
    let placement = w.placement([0.0; 3], Z, X);
    let ball = w.add(format_args!("SPHERICAL_SURFACE('',#{placement},1.)"));
    let set = w.add(format_args!("GEOMETRIC_SET('',{})", list(&[offsets, vec![ball]].concat())));
    let context = w.context(Units::MillimetreRadian);
    w.add(format_args!("GEOMETRICALLY_BOUNDED_SURFACE_SHAPE_REPRESENTATION('',(#{set}),#{context})"));
    let document = read(&w.file());
    let told = notes(&document, NoteKind::LeftOut);
    assert_eq!((document.model.faces().len(), told.len()), (1, 300), "{told:?}");
    assert!(told[0].contains("a crease, or too many parts"), "{}", told[0]);
    assert!(told[299].contains("more work than is spent on them"), "{}", told[299]);
}
