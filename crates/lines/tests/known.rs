//! Lines whose shape is known, on the unit sphere: circles about an axis, and nothing else.

use glam::{DVec2, DVec3};
use lines::{Drawing, Eye, Family, Place, WireKind, combs, draw, dxf, net, svg};
use scene::{Camera, FaceId, Model, Projection, Viewport};
use std::f64::consts::TAU;

/// Nothing is cut away, and nothing hides anything.
struct Glass;

impl Eye for Glass {
    fn has_material(&self, _: FaceId, _: DVec2) -> bool {
        true
    }

    fn sees(&self, _: &Place, _: f64) -> bool {
        true
    }
}

/// Model units that a pixel covers.
const PIXEL: f64 = 0.01;

fn sphere() -> Model {
    models::builtin("sphere").expect("built in")
}

/// From above, 240 pixels along each side.
fn camera() -> (Camera, Viewport) {
    let viewport = Viewport::new(240, 240).expect("a size");
    let projection = Projection::Orthographic { height: 240.0 * PIXEL };
    (Camera::look_at(4.0 * DVec3::Z, DVec3::ZERO, DVec3::Y, projection).expect("a camera"), viewport)
}

fn drawn(family: Family) -> Drawing {
    let (camera, viewport) = camera();
    let drawing = draw(&sphere(), &camera, viewport, &[family], &Glass);
    assert!(drawing.unfinished.is_empty(), "{:?}", drawing.unfinished);
    drawing
}

/// The length of all lines in space; each must close.
fn length(drawing: &Drawing) -> f64 {
    let of = |places: &[Place]| {
        assert_eq!(places.first(), places.last(), "it closes");
        places.windows(2).map(|pair| pair[0].position.distance(pair[1].position)).sum::<f64>()
    };
    drawing.lines.iter().map(|line| of(&line.places)).sum()
}

#[test]
fn a_closed_line_of_a_third_of_a_pixel_is_found_once() {
    let radius = 0.17 * PIXEL;
    let height = (1.0 - radius * radius).sqrt();
    let drawing = drawn(Family::Sections { normal: DVec3::Z, distances: vec![height] });
    assert_eq!(drawing.lines.len(), 1);
    assert!((length(&drawing) / (TAU * radius) - 1.0).abs() < 0.1, "{}", length(&drawing));
    let above = drawn(Family::Sections { normal: DVec3::Z, distances: vec![1.0 + 1e-9] });
    assert!(above.lines.is_empty(), "a plane above the sphere cuts nothing");
}

/// The plane runs along the borders of patches, where the polynomials of both sides are nought but for rounding.
#[test]
fn a_line_along_the_borders_of_patches_is_found_once() {
    for normal in [DVec3::X, DVec3::Y, DVec3::Z] {
        let drawing = drawn(Family::Sections { normal, distances: vec![0.0] });
        assert_eq!(drawing.lines.len(), 1, "{normal}");
        assert!((length(&drawing) / TAU - 1.0).abs() < 1e-2, "{normal}: {}", length(&drawing));
    }
}

/// At angle φ to the axis the circle has radius sin φ; the normals' polynomial is nought at the poles, which lie on no line.
#[test]
fn isophotes_of_a_sphere_are_circles_within_the_tolerance() {
    for light in [DVec3::Z, DVec3::new(0.0, 0.6, 0.8)] {
        let degrees = vec![1.0, 30.0, 37.0, 89.0];
        let drawing = drawn(Family::Isophotes { light, degrees: degrees.clone() });
        // The angle is the acute one: a circle on either side.
        assert_eq!(drawing.lines.len(), 2 * degrees.len(), "{light}");
        for line in &drawing.lines {
            let level = degrees[line.index];
            for pair in line.places.windows(2) {
                let middle = 0.5 * (pair[0].position + pair[1].position);
                let axis = light * middle.dot(light);
                let off = [middle.distance(axis) - level.to_radians().sin(), axis.length() - level.to_radians().cos()];
                assert!(off.iter().all(|off| off.abs() < lines::TOLERANCE * PIXEL), "{level}°: {off:?}");
            }
        }
    }
}

/// Seen along an axis a sphere mirrors the view by twice the angle, and its outline is a great circle.
#[test]
fn reflections_silhouettes_and_highlights_of_a_sphere_are_where_plane_geometry_has_them() {
    let outline = drawn(Family::Silhouettes);
    assert!((length(&outline) / TAU - 1.0).abs() < 1e-2, "{}", length(&outline));
    // r = d − 2 (d · n) n with d = −z: its x is 2 n_z n_x.
    let mirrored = drawn(Family::Reflections { axis: DVec3::X, components: vec![0.5] });
    for place in mirrored.lines.iter().flat_map(|line| &line.places) {
        let p = place.position;
        assert!((2.0 * p.z * p.x - 0.5).abs() < 0.01, "{p}");
    }
    assert!(!mirrored.lines.is_empty());
    // All normal lines pass through the middle: those that meet the lamp are in its plane with that.
    let lamp = DVec3::new(0.0, 1.0, 1.0);
    let highlight = drawn(Family::Highlights { along: DVec3::X, lamps: vec![lamp] });
    assert!((length(&highlight) / TAU - 1.0).abs() < 1e-2, "{}", length(&highlight));
    assert!(
        highlight
            .lines
            .iter()
            .flat_map(|line| &line.places)
            .all(|place| (place.position.y - place.position.z).abs() < 1e-3)
    );
}

#[test]
fn files_hold_the_lines_with_their_levels_and_faces() {
    let (camera, viewport) = camera();
    let drawing = drawn(Family::Isophotes { light: DVec3::Z, degrees: vec![30.0] });
    let text = svg(&drawing, &camera, viewport, "a <sphere>", false);
    assert!(text.starts_with("<svg ") && text.contains("<title>a &lt;sphere&gt;</title>"), "{text}");
    assert_eq!(text.matches("<path data-level=\"30\" data-faces=\"0\" d=\"M").count(), 2);
    // The circles of half the sphere's radius, 50 pixels.
    let circle: Vec<DVec2> = text
        .split(['M', 'L', '"'])
        .filter_map(|step| step.split_once(' ').and_then(|(x, y)| Some(DVec2::new(x.parse().ok()?, y.parse().ok()?))))
        .collect();
    assert!(circle.len() > 80, "{}", circle.len());
    assert!(circle.windows(2).all(|pair| {
        let middle = 0.5 * (pair[0] + pair[1]);
        pair[0].distance(pair[1]) > 20.0 || (middle.distance(DVec2::splat(120.0)) - 50.0).abs() < 0.1
    }));
    let points = drawing.lines.iter().map(|line| line.places.len()).sum::<usize>();
    let text = dxf(&drawing, false);
    assert_eq!(text.matches("\nPOLYLINE\n8\nisophotes_30\n").count(), 2);
    assert_eq!(text.matches("\nVERTEX\n").count(), points);
    assert!(text.ends_with("0\nENDSEC\n0\nEOF\n"));
}

/// Of the sphere's sections at one height all teeth are as long, and files hold each once.
#[test]
fn nets_and_combs_are_written_beside_the_lines() {
    let (camera, viewport) = camera();
    let mut drawing = drawn(Family::Sections { normal: DVec3::Z, distances: vec![0.6] });
    let found = combs(&sphere(), &camera, viewport, &drawing, false, &Glass);
    assert!((found.curvature.expect("it is curved") - 1.0 / 0.8).abs() < 1e-9, "{:?}", found.curvature);
    let teeth = found.wires();
    let lengths =
        teeth.iter().filter(|wire| wire.points.len() == 2).map(|wire| wire.points[0].distance(wire.points[1]));
    let lengths: Vec<f64> = lengths.collect();
    assert!(60 < lengths.len() && lengths.iter().all(|length| (length / lengths[0] - 1.0).abs() < 1e-6), "{lengths:?}");
    let nets = net(&sphere());
    let points: usize = sphere().surfaces().iter().map(|surface| surface.points().len()).sum();
    assert_eq!(nets.iter().map(|wire| wire.points.len()).sum::<usize>(), 2 * points, "each is on a row and a column");
    let written = nets.len() + teeth.len();
    drawing.wires = nets.into_iter().chain(teeth).collect();
    let picture = svg(&drawing, &camera, viewport, "test", false);
    for kind in WireKind::ALL {
        assert!(picture.contains(&format!("<g class=\"{}\"", kind.name())), "{kind:?}");
    }
    let space = dxf(&drawing, false);
    assert_eq!(space.matches("\nPOLYLINE\n").count(), drawing.lines.len() + written);
}
