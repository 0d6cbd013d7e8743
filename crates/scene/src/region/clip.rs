//! Loops cut into monotone pieces and held to the domain.
//!
//! Clamping a curve to a rectangle moves only what is outside, along segments that stay outside: no winding number of
//! an interior point changes. What was outside becomes straight pieces along the border.

use super::frame::Frame;
use super::segment::{ClosedLoop, Segment};
use glam::DVec2;
use nurbs::BezierCurve;

/// A part of the region's boundary on which u and v are both monotone.
#[derive(Debug, Clone, PartialEq)]
pub struct Piece {
    /// The curve, in standard form, inside the domain; material is on its left.
    pub curve: BezierCurve,
    /// Whether it runs along a border of the domain, so that the domain's own limit does its work.
    pub on_border: bool,
    /// Which loop of [`Region::loops`](super::Region::loops) it is a part of.
    pub loop_index: usize,
    /// Which trim of that loop's source it is a part of; `None` as in [`Segment::trim`].
    pub trim: Option<usize>,
}

impl Piece {
    /// What a crossing adds to the winding number of a point on the piece's left side in u: 1 where v rises, −1 where
    /// it falls, 0 where it is constant.
    pub fn winding(&self) -> i32 {
        let (start, end) = (self.curve.start().y, self.curve.end().y);
        i32::from(start < end) - i32::from(end < start)
    }
}

/// All pieces of all loops, in order.
pub(super) fn pieces(frame: &Frame, loops: &[ClosedLoop]) -> Vec<Piece> {
    let mut pieces = vec![];
    for (loop_index, boundary) in loops.iter().enumerate() {
        for Segment { curve, trim } in &boundary.segments {
            for monotone in curve.monotone_pieces() {
                for (curve, on_border) in clamped(frame, &monotone) {
                    if curve.start() != curve.end() {
                        pieces.push(Piece { curve, on_border, loop_index, trim: *trim });
                    }
                }
            }
        }
    }
    pieces
}

/// The monotone pieces of a monotone curve clamped to the domain, and whether each lies on its border.
fn clamped(frame: &Frame, curve: &BezierCurve) -> Vec<(BezierCurve, bool)> {
    let mut cuts: Vec<f64> = vec![];
    let (start, end) = (frame.snapped(curve.start()), frame.snapped(curve.end()));
    for axis in [0, 1] {
        for border in [frame.domain.min[axis], frame.domain.max[axis]] {
            let (a, b) = (start[axis] - border, end[axis] - border);
            if a * b < 0.0 {
                cuts.push(curve.crossing(axis, border));
            }
        }
    }
    cuts.sort_by(f64::total_cmp);
    let mut parts = vec![];
    let (mut rest, mut from, mut joint) = (curve.clone(), 0.0, start);
    for t in cuts {
        let local = (t - from) / (1.0 - from);
        if !(0.0 < local && local < 1.0) {
            continue;
        }
        let [low, high] = rest.split(local);
        let cut = frame.snapped(low.end());
        parts.push(frame.part(low, joint, cut));
        (rest, from, joint) = (high, t, cut);
    }
    parts.push(frame.part(rest, joint, end));
    parts
}

impl Frame<'_> {
    /// The point, put on a border of the domain that it is within [`Frame::on_border`] of.
    fn snapped(&self, mut point: DVec2) -> DVec2 {
        for axis in [0, 1] {
            for border in [self.domain.min[axis], self.domain.max[axis]] {
                if (point[axis] - border).abs() <= self.on_border[axis] {
                    point[axis] = border;
                }
            }
        }
        point
    }

    /// A part that crosses no border, from `start` to `end`, clamped.
    fn part(&self, curve: BezierCurve, start: DVec2, end: DVec2) -> (BezierCurve, bool) {
        let (min, max) = (self.domain.min, self.domain.max);
        let beyond = |axis: usize| {
            (start[axis] <= min[axis] && end[axis] <= min[axis]) || (max[axis] <= start[axis] && max[axis] <= end[axis])
        };
        let [a, b] = [start, end].map(|p| p.clamp(min, max));
        if beyond(0) || beyond(1) {
            return (BezierCurve::line(a, b), true);
        }
        let mut inside = curve.standardised();
        inside.set_ends(a, b);
        (inside, false)
    }
}
