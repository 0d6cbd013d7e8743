//! Lines on a model's surfaces over a picture of it: those that `--out X.svg` holds, as far as they are seen, and what leaves the
//! surface whole.
//!
//! They are drawn once, after the samples of a pixel are put together.

use crate::brush::{Brush, STEP};
use anyhow::Result;
use gbuffer::Picture;
use glam::{DVec2, DVec3};
use lines::{Drawing, Family, WireKind};
use scene::{Camera, Viewport};

/// How a kind of lines is drawn.
struct Ink {
    /// Half its width, pixels.
    radius: f64,
    colour: [u8; 3],
    /// How much of what is below it covers.
    strength: f64,
    /// How much its border covers, [`BORDER`] pixels wide, white.
    border: f64,
}

/// How far a border reaches beyond its line, pixels.
const BORDER: f64 = 1.0;

/// Half the side of a control point's mark, pixels.
const MARK: f64 = 1.4;

fn ink(family: &Family) -> Ink {
    let ink = |radius, colour, strength, border| Ink { radius, colour, strength, border };
    match family {
        Family::Parameters { .. } => ink(0.25, [20, 22, 28], 0.7, 0.25),
        Family::Isophotes { .. } | Family::Reflections { .. } | Family::Highlights { .. } => {
            ink(0.4, [31, 111, 235], 1.0, 0.4)
        }
        Family::Sections { .. } => ink(0.7, [200, 20, 40], 1.0, 0.6),
        Family::Borders => ink(0.6, [20, 22, 28], 1.0, 0.6),
        Family::Trims => ink(0.7, [0, 130, 90], 1.0, 0.6),
        Family::Silhouettes => ink(0.7, [0, 0, 0], 1.0, 0.6),
    }
}

fn wire_ink(kind: WireKind) -> Ink {
    match kind {
        WireKind::Net => Ink { radius: 0.3, colour: [200, 40, 140], strength: 0.8, border: 0.15 },
        WireKind::Combs => Ink { radius: 0.2, colour: [240, 120, 0], strength: 0.9, border: 0.0 },
    }
}

/// A picture with the lines of a drawing over it, from the same camera.
///
/// # Errors
/// None where the picture is as large as the viewport.
pub fn drawn_over(picture: &Picture, drawing: &Drawing, camera: &Camera, viewport: Viewport) -> Result<Picture> {
    let mut brush = Brush::new(picture);
    let way = |points: &mut dyn Iterator<Item = DVec3>| places(points, camera, viewport);
    let mut draw = |places: &[DVec2], ink: &Ink| {
        if 0.0 < ink.border {
            brush.draw(places, ink.radius + BORDER, [255; 3], ink.border);
        }
        brush.draw(places, ink.radius, ink.colour, ink.strength);
    };
    for (number, family) in drawing.families.iter().enumerate() {
        let lines = drawing.lines.iter().filter(|line| line.family == number && line.is_seen);
        let places: Vec<DVec2> =
            lines.flat_map(|line| way(&mut line.places.iter().map(|place| place.position))).collect();
        draw(&places, &ink(family));
    }
    for kind in WireKind::ALL {
        let wires = || drawing.wires.iter().filter(|wire| wire.kind == kind);
        let places: Vec<DVec2> = wires().flat_map(|wire| way(&mut wire.points.iter().copied())).collect();
        draw(&places, &wire_ink(kind));
        if kind == WireKind::Net {
            let points = wires().flat_map(|wire| &wire.points);
            let marks: Vec<DVec2> = points.filter_map(|point| Some(camera.project(viewport, *point)?.0)).collect();
            draw(&marks, &Ink { radius: MARK, strength: 1.0, ..wire_ink(kind) });
        }
    }
    brush.picture()
}

/// Places along the straight ways between points, close to each other, as far as they are in the picture or near it.
fn places(points: &mut dyn Iterator<Item = DVec3>, camera: &Camera, viewport: Viewport) -> Vec<DVec2> {
    let size = DVec2::new(viewport.width() as f64, viewport.height() as f64);
    let mut places = vec![];
    let mut last = None::<DVec2>;
    for point in points {
        let place = camera.project(viewport, point).map(|(place, _)| place);
        if let (Some(a), Some(b)) = (last, place)
            && let Some([from, to]) = clipped(a, b, size)
        {
            let steps = (from.distance(to) / STEP).ceil().max(1.0) as usize;
            places.extend((0..=steps).map(|k| from.lerp(to, k as f64 / steps as f64)));
        }
        last = place;
    }
    places
}

/// The part of a way that is in the picture, or as far beside it as a wide line reaches (Liang & Barsky 1984).
fn clipped(a: DVec2, b: DVec2, size: DVec2) -> Option<[DVec2; 2]> {
    let (low, high) = (DVec2::splat(-8.0), size + 8.0);
    let step = b - a;
    let mut range = [0.0f64, 1.0];
    for axis in 0..2 {
        let ends = [low[axis] - a[axis], high[axis] - a[axis]];
        if step[axis] == 0.0 {
            if !(ends[0] <= 0.0 && 0.0 <= ends[1]) {
                return None;
            }
            continue;
        }
        let [p, q] = ends.map(|end| end / step[axis]);
        range = [range[0].max(p.min(q)), range[1].min(p.max(q))];
    }
    (range[0] <= range[1]).then(|| range.map(|share| a.lerp(b, share)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sight::Sight;
    use lines::{Wire, draw};
    use nurbs::{KnotVector, Surface};
    use scene::{Model, Projection};

    #[test]
    fn a_way_is_cut_at_the_pictures_edge_and_one_beside_it_is_none() {
        let size = DVec2::new(100.0, 50.0);
        let across = clipped(DVec2::new(-1e6, 25.0), DVec2::new(1e6, 25.0), size).expect("it crosses");
        assert!(
            across[0].distance(DVec2::new(-8.0, 25.0)) < 1e-6 && across[1].distance(DVec2::new(108.0, 25.0)) < 1e-6
        );
        assert_eq!(clipped(DVec2::new(0.0, 60.0), DVec2::new(90.0, 60.0), size), None);
        assert_eq!(clipped(DVec2::new(-50.0, 40.0), DVec2::new(40.0, 130.0), size), None, "it passes a corner");
        let inside = [DVec2::ONE, DVec2::new(9.0, 7.0)];
        assert_eq!(clipped(inside[0], inside[1], size), Some(inside));
    }

    /// A sheet in the plane z = 0, and another above it that covers it all, seen from above.
    fn pixels(families: &[Family], wires: Vec<Wire>, is_covered: bool, colour: [u8; 3]) -> usize {
        let sheet = |half: f64, z: f64| {
            let knots = || KnotVector::new(1, vec![0.0, 0.0, 1.0, 1.0]).expect("one span");
            let corner = |x: f64, y: f64| DVec3::new(half * x, half * y, z);
            let points = vec![corner(-1.0, -1.0), corner(-1.0, 1.0), corner(1.0, -1.0), corner(1.0, 1.0)];
            Surface::new(knots(), knots(), points, None).expect("a sheet")
        };
        let above = is_covered.then(|| sheet(0.9, 1.0));
        let model = Model::of_surfaces("sheets", [sheet(0.51, 0.0)].into_iter().chain(above).collect());
        let model = model.expect("surfaces");
        let viewport = Viewport::new(100, 100).expect("a size");
        let projection = Projection::Orthographic { height: 2.0 };
        let camera = Camera::look_at(5.0 * DVec3::Z, DVec3::ZERO, DVec3::Y, projection).expect("a camera");
        let sight = Sight::new(&model, camera, viewport);
        let mut drawing = draw(&model, &camera, viewport, families, &sight);
        drawing.lines.retain(|line| line.places[0].face.0 == 0);
        drawing.wires = wires;
        let grey = Picture::new(100, 100, vec![[128; 3]; 10_000]).expect("a picture");
        let drawn = drawn_over(&grey, &drawing, &camera, viewport).expect("of its size");
        // Beside the middle of a line some of what is below shines through.
        let is_near = |rgb: &&[u8; 3]| rgb.iter().zip(colour).all(|(own, part)| own.abs_diff(part) <= 40);
        drawn.rgb().iter().filter(is_near).count()
    }

    /// The sides of the sheet run through pixel centres and are 51 pixels long each.
    #[test]
    fn lines_are_drawn_where_they_are_seen_and_wires_everywhere() {
        let borders = [Family::Borders];
        let [open, covered] =
            [false, true].map(|is_covered| pixels(&borders, vec![], is_covered, ink(&borders[0]).colour));
        assert!((196..=212).contains(&open), "{open}");
        assert_eq!(covered, 0, "another sheet hides the border");
        let wire = Wire { kind: WireKind::Net, points: vec![DVec3::new(-0.5, 0.0, -1.0), DVec3::new(0.5, 0.0, -1.0)] };
        let mark = wire_ink(WireKind::Net).colour;
        let [open, covered] = [false, true].map(|is_covered| pixels(&[], vec![wire.clone()], is_covered, mark));
        assert!(0 < open && open == covered, "{open} {covered}: nothing hides the control net");
    }
}
