//! Whether boundaries cross: of one loop with itself, or of two.
//!
//! Touching is legal (a cusp, two holes that meet at a point, an edge run there and back), so that only a crossing
//! counts from which both curves get away by more than a margin on both sides.

use super::{ClosedLoop, Frame, Piece};
use crate::{SceneError, TrimPlace};
use glam::DVec2;
use nurbs::{BezierCurve, Rectangle};

/// How far, as a share of the domain's length, two curves must pass through each other to be said to cross.
const MARGIN: f64 = 1e-6;

/// Halvings of a pair of pieces before what is left counts as touching.
const HALVINGS: u32 = 40;

/// The first crossing that is found is an error.
pub(super) fn check(frame: &Frame, loops: &[ClosedLoop], pieces: &[Piece]) -> Result<(), SceneError> {
    let size = frame.domain.size();
    let unit = |c: &BezierCurve| {
        let points = c.control().iter().map(|p| {
            let q = (p.truncate() / p.z - frame.domain.min) / size;
            (q * p.z).extend(p.z)
        });
        BezierCurve::new(points.collect())
    };
    let mut curves: Vec<(usize, BezierCurve, Rectangle)> = vec![];
    for (i, piece) in pieces.iter().enumerate().filter(|(_, piece)| !piece.on_border) {
        // A domain so small that its inverse overflows has no crossing that f64 could name.
        let Some(curve) = unit(&piece.curve) else { continue };
        let hull = ends_box(&curve);
        curves.push((i, curve, hull));
    }
    curves.sort_by(|a, b| a.2.min.x.total_cmp(&b.2.min.x));
    for (k, (i, a, box_a)) in curves.iter().enumerate() {
        for (j, b, box_b) in curves[k + 1..].iter().take_while(|(_, _, other)| other.min.x <= box_a.max.x) {
            if box_a.meets(*box_b)
                && let Some(at) = crossing(a, b, HALVINGS)
            {
                return Err(error(frame, loops, [&pieces[*i], &pieces[*j]], at * size + frame.domain.min));
            }
        }
    }
    Ok(())
}

fn error(frame: &Frame, loops: &[ClosedLoop], [a, b]: [&Piece; 2], at: DVec2) -> SceneError {
    // Lists longer than u32 counts do not fit in a file.
    let index = |i: usize| u32::try_from(i).unwrap_or(u32::MAX);
    let [first, second] = [a, b]
        .map(|piece| TrimPlace { boundary: loops[piece.loop_index].source.map(index), trim: piece.trim.map(index) });
    SceneError::TrimsCross { face: frame.face, first, second, at: at.to_array() }
}

/// The box of a monotone curve is that of its ends.
fn ends_box(curve: &BezierCurve) -> Rectangle {
    let (a, b) = (curve.start(), curve.end());
    Rectangle { min: a.min(b), max: a.max(b) }
}

/// A point at which two monotone curves cross, of several any.
fn crossing(a: &BezierCurve, b: &BezierCurve, halvings: u32) -> Option<DVec2> {
    if !ends_box(a).meets(ends_box(b)) || halvings == 0 {
        return None;
    }
    let (bent_a, bent_b) = (bend(a), bend(b));
    if bent_a.max(bent_b) <= 0.5 * MARGIN {
        return chords_cross([a.start(), a.end()], [b.start(), b.end()]);
    }
    if bent_a < bent_b {
        let halves = b.split(0.5);
        return halves.iter().find_map(|half| crossing(a, half, halvings - 1));
    }
    let halves = a.split(0.5);
    halves.iter().find_map(|half| crossing(half, b, halvings - 1))
}

/// How far the control points are from the chord.
fn bend(curve: &BezierCurve) -> f64 {
    let (a, b) = (curve.start(), curve.end());
    let along = (b - a).normalize_or_zero();
    curve.control().iter().map(|c| (c.truncate() / c.z - a).perp_dot(along).abs()).fold(0.0, f64::max)
}

/// Where two segments cross, if each end is more than the margin from the other's line.
fn chords_cross([a, b]: [DVec2; 2], [c, d]: [DVec2; 2]) -> Option<DVec2> {
    let (along, across) = ((b - a).normalize_or_zero(), (d - c).normalize_or_zero());
    let sides = |from: DVec2, line: DVec2, p: DVec2, q: DVec2| (line.perp_dot(p - from), line.perp_dot(q - from));
    let apart = |(p, q): (f64, f64)| p * q < 0.0 && MARGIN < p.abs() && MARGIN < q.abs();
    let (of_cd, of_ab) = (sides(a, along, c, d), sides(c, across, a, b));
    (apart(of_cd) && apart(of_ab)).then(|| c + (d - c) * (of_cd.0 / (of_cd.0 - of_cd.1)))
}
