//! Rectangles that trim a surface: from the first parameter to the second, in its sense or against it, also across a seam.

use crate::green::area_and_volume;
use crate::writer::{Units, Writer, X, Z};
use formats::{Document, FORMATS};
use std::f64::consts::TAU;

fn read(text: &str) -> Document {
    let step = FORMATS.iter().find(|format| format.name() == "STEP").expect("it is in the list");
    step.read(text.as_bytes(), "part.step").unwrap_or_else(|error| panic!("{error}"))
}

/// A surface over a rectangle; the surface's parameters follow its placement.
fn trimmed(surface: &str, parameters: &str, rectangle: &str, units: Units) -> Document {
    let mut w = Writer::new("AUTOMOTIVE_DESIGN");
    let placement = w.placement([0.0; 3], Z, X);
    let basis = w.add(format_args!("{surface}('',#{placement}{parameters})"));
    let item = w.add(format_args!("RECTANGULAR_TRIMMED_SURFACE('',#{basis},{rectangle})"));
    let set = w.add(format_args!("GEOMETRIC_SET('',(#{item}))"));
    let context = w.context(units);
    w.add(format_args!("GEOMETRICALLY_BOUNDED_SURFACE_SHAPE_REPRESENTATION('',(#{set}),#{context})"));
    read(&w.file())
}

/// Radius 2, height 3: areas of 6 for each radian.
#[test]
fn a_rectangle_on_a_cylinder_runs_from_the_first_angle_to_the_second() {
    for (rectangle, angle, reversed) in [
        ("0.5,2.,0.,3.,.T.,.T.", 1.5, false),
        ("5.,1.,0.,3.,.T.,.T.", TAU - 4.0, false),
        ("1.,5.,0.,3.,.T.,.T.", 4.0, false),
        ("5.,1.,0.,3.,.F.,.T.", 4.0, true),
        ("1.,5.,0.,3.,.F.,.T.", TAU - 4.0, true),
        ("0.5,2.,3.,0.,.T.,.F.", 1.5, true),
        ("2.,0.5,3.,0.,.F.,.F.", 1.5, false),
        ("-1.,1.,0.,3.,.T.,.T.", 2.0, false),
    ] {
        let document = trimmed("CYLINDRICAL_SURFACE", ",2.", rectangle, Units::MillimetreRadian);
        let area = area_and_volume(&document.model).x;
        assert!((area - 6.0 * angle).abs() < 1e-9, "{rectangle}: {area}, {:?}", document.notes);
        assert_eq!(document.model.faces()[0].reversed, reversed, "{rectangle}");
    }
    let degrees = trimmed("CYLINDRICAL_SURFACE", ",2.", "350.,10.,0.,3.,.T.,.T.", Units::InchDegree);
    assert!((area_and_volume(&degrees.model).x - 6.0 * 20f64.to_radians()).abs() < 1e-9);
}

/// Around a torus, too: radii 3 and 1, a quarter of each turn, across both seams.
#[test]
fn a_rectangle_on_a_torus_runs_across_both_seams() {
    let document = trimmed("TOROIDAL_SURFACE", ",3.,1.", "5.5,0.7,6.,1.,.T.,.T.", Units::MillimetreRadian);
    // ∫ (3 + cos v) dv times the angle.
    let (turn, angle) = (TAU - 5.0, TAU - 4.8);
    let expected = angle * (3.0 * turn + 1f64.sin() - 6f64.sin());
    let area = area_and_volume(&document.model).x;
    assert!((area - expected).abs() < 1e-9, "{area} for {expected}");
}

/// A plane is not cyclic, and a sphere is so in one direction alone; a rectangle of no width is none.
#[test]
fn a_rectangle_elsewhere_lies_between_its_ends() {
    let plane = trimmed("PLANE", "", "2.,0.,0.,3.,.F.,.T.", Units::MillimetreRadian);
    assert!((area_and_volume(&plane.model).x - 6.0).abs() < 1e-12);
    let sphere = trimmed("SPHERICAL_SURFACE", ",1.", "6.,0.5,0.,1.,.T.,.T.", Units::MillimetreRadian);
    assert!((area_and_volume(&sphere.model).x - (TAU - 5.5) * 1f64.sin()).abs() < 1e-9);
    let mut w = Writer::new("AUTOMOTIVE_DESIGN");
    let placement = w.placement([0.0; 3], Z, X);
    let basis = w.add(format_args!("SPHERICAL_SURFACE('',#{placement},1.)"));
    let none = w.add(format_args!("RECTANGULAR_TRIMMED_SURFACE('',#{basis},1.,1.,0.,1.,.T.,.T.)"));
    let set = w.add(format_args!("GEOMETRIC_SET('',(#{none},#{basis}))"));
    let context = w.context(Units::MillimetreRadian);
    w.add(format_args!("GEOMETRICALLY_BOUNDED_SURFACE_SHAPE_REPRESENTATION('',(#{set}),#{context})"));
    let document = read(&w.file());
    let told: Vec<String> = document.notes.iter().map(ToString::to_string).collect();
    assert!(told.len() == 1 && told[0].contains("it is trimmed to nothing"), "{told:?}");
}
