//! Surfaces and curves that a file gives as others, moved, turned, scaled and mirrored.

use crate::green::area_and_volume;
use crate::writer::{DOWN, Units, Writer, X, Z};
use formats::{Document, FORMATS};
use glam::DVec3;
use std::f64::consts::PI;

fn read(text: &str) -> Document {
    let step = FORMATS.iter().find(|format| format.name() == "STEP").expect("it is in the list");
    step.read(text.as_bytes(), "part.step").unwrap_or_else(|error| panic!("{error}"))
}

/// A move that takes x to z, y to x or, mirrored, to −x, z to y, and the origin to (5, 6, 7), and makes all three times as long.
fn operator(w: &mut Writer, is_mirrored: bool) -> u64 {
    let origin = w.point([5.0, 6.0, 7.0]);
    let axes = [Z, if is_mirrored { [-1.0, 0.0, 0.0] } else { X }, [0.0, 1.0, 0.0]];
    let [x, y, z] = axes.map(|axis| w.direction(axis));
    w.add(format_args!("CARTESIAN_TRANSFORMATION_OPERATOR_3D('',#{x},#{y},#{origin},3.,#{z})"))
}

fn finished(mut w: Writer, keyword: &str, item: u64) -> Document {
    let context = w.context(Units::MillimetreRadian);
    w.add(format_args!("{keyword}('',(#{item}),#{context})"));
    read(&w.file())
}

/// A disc of radius 2, plane and circle replicas of those about z; also where the move mirrors.
#[test]
fn a_replica_of_a_plane_within_a_replica_of_a_circle_is_a_disc() {
    for is_mirrored in [false, true] {
        let mut w = Writer::new("AUTOMOTIVE_DESIGN");
        let motion = operator(&mut w, is_mirrored);
        let circle = w.circle([0.0; 3], 2.0);
        let curve = w.add(format_args!("CURVE_REPLICA('',#{circle},#{motion})"));
        let placement = w.placement([0.0; 3], if is_mirrored { DOWN } else { Z }, X);
        let plane = w.add(format_args!("PLANE('',#{placement})"));
        let surface = w.add(format_args!("SURFACE_REPLICA('',#{plane},#{motion})"));
        // Three times (2, 0, 0) along z.
        let vertex = w.vertex([5.0, 6.0, 13.0]);
        let edge = w.edge([vertex, vertex], curve, true);
        let bound = w.bound("FACE_OUTER_BOUND", &[(edge, true)]);
        let face = w.face(&[bound], surface, true);
        let shell = w.add(format_args!("OPEN_SHELL('',(#{face}))"));
        let model = w.add(format_args!("SHELL_BASED_SURFACE_MODEL('',(#{shell}))"));
        let document = finished(w, "MANIFOLD_SURFACE_SHAPE_REPRESENTATION", model);
        let area = area_and_volume(&document.model).x;
        assert!((area / (36.0 * PI) - 1.0).abs() < 1e-12, "mirrored {is_mirrored}: {area}");
        let region = document.model.region(scene::FaceId(0)).expect("a loop");
        let middle = 0.5 * (region.hull().min + region.hull().max);
        let centre = document.model.surface(scene::FaceId(0)).point(middle.x, middle.y);
        assert!(centre.distance(DVec3::new(5.0, 6.0, 7.0)) < 1e-9, "mirrored {is_mirrored}: {centre}");
    }
}

#[test]
fn a_replica_of_a_sphere_is_a_sphere_and_a_mirrored_one_is_noted() {
    let sphere = |is_mirrored: bool| {
        let mut w = Writer::new("AUTOMOTIVE_DESIGN");
        let motion = operator(&mut w, is_mirrored);
        let placement = w.placement([1.0, 0.0, 0.0], Z, X);
        let ball = w.add(format_args!("SPHERICAL_SURFACE('',#{placement},2.)"));
        let replica = w.add(format_args!("SURFACE_REPLICA('',#{ball},#{motion})"));
        let set = w.add(format_args!("GEOMETRIC_SET('',(#{ball},#{replica}))"));
        (replica, finished(w, "GEOMETRICALLY_BOUNDED_SURFACE_SHAPE_REPRESENTATION", set))
    };
    let (_, document) = sphere(false);
    let surface = document.model.surface(scene::FaceId(1));
    let [[u0, u1], [v0, v1]] = surface.domain();
    for k in 0..100 {
        let [s, t] = [(k % 10) as f64 / 9.0, (k / 10) as f64 / 9.0];
        let point = surface.point(u0 + (u1 - u0) * s, v0 + (v1 - v0) * t);
        assert!((point.distance(DVec3::new(5.0, 6.0, 10.0)) - 6.0).abs() < 1e-12, "{point}");
    }
    let (replica, document) = sphere(true);
    let losses: Vec<String> =
        document.notes.iter().filter(|note| note.kind.is_loss()).map(ToString::to_string).collect();
    assert_eq!((document.model.faces().len(), losses.len()), (1, 1), "{losses:?}");
    assert!(losses[0].contains(&format!("#{replica} SURFACE_REPLICA")) && losses[0].contains("mirrored"), "{losses:?}");
}
