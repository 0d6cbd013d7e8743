//! Where a face ends, as chords: curves in (u, v) halved until each is within the tolerance of its chord in the picture.
//!
//! A Bézier curve is nowhere farther from its chord than its control points are. Lengths in space follow from the bounds of |S_u|
//! and |S_v|, and what the surface leaves of the chord is Filip's bound.

use crate::frame::Frame;
use crate::trace::{Chord, Traced};
use glam::{DVec2, DVec3};
use nurbs::{BezierCurve, DerivativeBounds, Hull, Surface};
use scene::{FaceId, Model, closed};

/// Pieces of one curve that are looked at.
const MOST_PIECES: usize = 1 << 16;

/// Places of a side that are compared, and the share of the surface's box within which they are one point.
const PLACES: usize = 8;
const ONE_POINT: f64 = 1e-9;

/// The borders of a face; `bounds` are those of its whole surface.
pub fn borders(model: &Model, face: FaceId, bounds: &DerivativeBounds, frame: &Frame) -> Traced {
    let surface = model.surface(face);
    let mut traced = Traced::default();
    for curve in curves(model, face) {
        let mut stack = vec![curve];
        let mut looked_at = 0;
        while let Some(curve) = stack.pop() {
            let [start, end] = [curve.start(), curve.end()];
            let size = curve.hull().size();
            let radius = bounds.u * size.x + bounds.v * size.y;
            let middle = surface.point(0.5 * (start.x + end.x), 0.5 * (start.y + end.y));
            let hull = Hull { min: middle - DVec3::splat(radius), max: middle + DVec3::splat(radius) };
            if radius == 0.0 || frame.excludes(hull) {
                continue;
            }
            looked_at += 1;
            let step = (end - start).abs();
            let off = off_chord(&curve, DVec2::new(bounds.u, bounds.v)) + bounds.chord(step.x, step.y);
            if off * frame.pixels_per_unit(hull) <= frame.tolerance {
                traced.chords.push(Chord { ends: [start, end] });
            } else if looked_at < MOST_PIECES {
                stack.extend(curve.split(0.5));
            } else {
                traced.unfinished += 1;
            }
        }
    }
    traced
}

/// The curves in (u, v) at which a face ends, in the order of its loops or sides.
pub fn curves(model: &Model, face: FaceId) -> Vec<BezierCurve> {
    match model.region(face) {
        Some(region) => region.edges().map(|piece| piece.curve.clone()).collect(),
        None => sides(model.surface(face)),
    }
}

/// The sides of a surface's domain at which it ends: no seam, and no point.
fn sides(surface: &Surface) -> Vec<BezierCurve> {
    let [[u0, u1], [v0, v1]] = surface.domain();
    let [closed_u, closed_v] = closed(surface);
    let corners = [DVec2::new(u0, v0), DVec2::new(u1, v0), DVec2::new(u1, v1), DVec2::new(u0, v1)];
    let smallest = ONE_POINT * surface.hull().diagonal();
    let is_line = |from: DVec2, to: DVec2| {
        let point = |k: usize| {
            let uv = from.lerp(to, k as f64 / PLACES as f64);
            surface.point(uv.x, uv.y)
        };
        (1..=PLACES).any(|k| smallest < point(0).distance(point(k)))
    };
    let ends = [0, 1, 2, 3].map(|k| (corners[k], corners[(k + 1) % 4]));
    let ends = ends.into_iter().filter(|(from, to)| if from.x == to.x { !closed_u } else { !closed_v });
    ends.filter(|(from, to)| is_line(*from, *to)).map(|(from, to)| BezierCurve::line(from, to)).collect()
}

/// How far a curve may be from the points of its chord, where du and dv are as long as `lengths` say.
fn off_chord(curve: &BezierCurve, lengths: DVec2) -> f64 {
    let (start, step) = (curve.start() * lengths, (curve.end() - curve.start()) * lengths);
    let distance = |c: &DVec3| {
        let p = c.truncate() / c.z * lengths - start;
        let share = (p.dot(step) / step.length_squared()).clamp(0.0, 1.0);
        p.distance(if share.is_nan() { DVec2::ZERO } else { share * step })
    };
    curve.control().iter().map(distance).fold(0.0, f64::max)
}
