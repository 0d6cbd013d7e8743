//! Which loop lies in which, and what that says of orientation.
//!
//! The depth of a loop is fact; the file has two witnesses for it, the `outer` flag and the direction of the loop. Where
//! one is wrong the other corrects it; where both are, the loops do not say what is material.

use super::{ClosedLoop, Frame, Repairs, Segment};
use crate::SceneError;
use crate::region::chain::Chain;
use glam::DVec2;
use nurbs::{BezierCurve, Rectangle};

/// Points of a loop that are asked for its depth, so that a place where two loops touch does not decide.
const WITNESSES: usize = 5;

/// A copy of a loop counts where it reaches into the domain by more than this share of the domain's length.
const REACHES_IN: f64 = 1e-6;

/// Adds the loops that close by themselves to `loops`, which holds those that go around, each turned by its depth.
pub(super) fn place(
    frame: &Frame,
    chains: &[Chain],
    loops: &mut Vec<ClosedLoop>,
    repairs: &mut Repairs,
) -> Result<(), SceneError> {
    let around = loops.len();
    let mut contours: Vec<Contour> = vec![];
    for chain in chains {
        contours.push(Contour::new(frame, chain, repairs)?);
    }
    if around == 0 && is_cut_from_whole(frame, chains, &contours) {
        loops.push(ClosedLoop { segments: frame.boundary(), depth: 0, source: None });
    }
    let given: Vec<Vec<BezierCurve>> = loops.iter().map(|l| monotone(&l.segments)).collect();
    for (i, contour) in contours.iter().enumerate() {
        let depth = contour.depth(frame, &contours[..i], &contours[i + 1..], &given);
        let (chain, expected) = (contour.chain, depth % 2 == 0);
        let turned = (0.0 < contour.area) != expected;
        match (chain.outer != expected, turned) {
            (true, true) => {
                return Err(SceneError::Nesting {
                    face: frame.face,
                    boundary: chain.source,
                    depth,
                    outer: chain.outer,
                });
            }
            (true, false) => repairs.mislabelled.push(chain.source),
            (false, true) => repairs.reoriented.push(chain.source),
            (false, false) => {}
        }
        for &offset in &contour.copies {
            let moved = chain.segments.iter().map(|s| s.translated(offset));
            let mut segments: Vec<Segment> =
                if turned { moved.rev().map(|s| s.reversed()).collect() } else { moved.collect() };
            close(&mut segments);
            loops.push(ClosedLoop { segments, depth, source: Some(chain.source) });
        }
    }
    Ok(())
}

/// Whether the loops are all holes in a natural boundary that the file leaves out.
///
/// No loop says that it is outer and all run clockwise; or the surface has no boundary at all, where the direction of
/// a lone loop is all that tells which of its sides is meant.
fn is_cut_from_whole(frame: &Frame, chains: &[Chain], contours: &[Contour]) -> bool {
    let clockwise = contours.iter().all(|c| c.area < 0.0);
    let holes = chains.iter().all(|c| !c.outer);
    clockwise && (holes || frame.is_unbounded(0) && frame.is_unbounded(1))
}

/// A loop with what is needed to say whether a point lies in it.
struct Contour<'a> {
    chain: &'a Chain,
    monotone: Vec<BezierCurve>,
    /// Signed, of one copy.
    area: f64,
    /// Offsets by whole periods at which it reaches into the domain.
    copies: Vec<DVec2>,
}

impl<'a> Contour<'a> {
    fn new(frame: &Frame, chain: &'a Chain, repairs: &mut Repairs) -> Result<Self, SceneError> {
        let area = signed_area(&chain.segments);
        let size = chain.hull.size();
        // A loop that runs back on itself encloses nothing but rounding.
        if area.abs() <= f64::EPSILON * chain.segments.len() as f64 * size.x * size.y {
            return Err(SceneError::EmptyLoop { face: frame.face, boundary: chain.source });
        }
        let copies = copies(frame, chain.hull);
        if copies != [DVec2::ZERO] {
            repairs.across_seam.push(chain.source);
        }
        Ok(Self { chain, monotone: monotone(&chain.segments), area, copies })
    }

    /// In how many of the other loops this one lies.
    fn depth(&self, frame: &Frame, before: &[Self], after: &[Self], given: &[Vec<BezierCurve>]) -> usize {
        // Nothing holds a border of the domain; where that is a seam, a hole across it does not hold the loop.
        let middles = self.monotone.iter().map(|piece| into_domain(frame, &self.copies, piece.point(0.5)));
        let witnesses: Vec<DVec2> = middles.filter(|point| !frame.is_on_border(*point)).collect();
        if witnesses.is_empty() {
            return 0;
        }
        let step = witnesses.len().div_ceil(WITNESSES);
        let mut depths: Vec<usize> = (witnesses.into_iter().step_by(step))
            .map(|point| {
                let around: i32 = given.iter().map(|g| winding(g, point)).sum();
                let others = before.iter().chain(after).filter(|other| other.holds(point)).count();
                usize::from(around != 0) + others
            })
            .collect();
        depths.sort_unstable();
        depths[(depths.len() - 1) / 2]
    }

    fn holds(&self, point: DVec2) -> bool {
        let inside = |offset: &DVec2| {
            let local = point - *offset;
            let hull = self.chain.hull;
            hull.min.cmple(local).all() && local.cmple(hull.max).all() && winding(&self.monotone, local) != 0
        };
        self.copies.iter().any(inside)
    }
}

/// The offsets by whole periods at which a loop in `hull` reaches into the domain; none but zero on an open surface.
fn copies(frame: &Frame, hull: Rectangle) -> Vec<DVec2> {
    let (size, Rectangle { min, max }) = (frame.domain.size(), frame.domain);
    let range = |axis: usize| {
        let slack = REACHES_IN * size[axis];
        let outside = hull.min[axis] < min[axis] - slack || max[axis] + slack < hull.max[axis];
        if !outside || !frame.is_closed(axis) {
            return 0..=0;
        }
        // hull + k period meets the domain by more than the slack
        let first = ((min[axis] + slack - hull.max[axis]) / size[axis]).ceil() as i32;
        let last = ((max[axis] - slack - hull.min[axis]) / size[axis]).floor() as i32;
        if first <= last { first..=last } else { 0..=0 }
    };
    let (along_u, along_v) = (range(0), range(1));
    along_u.flat_map(|i| along_v.clone().map(move |j| DVec2::new(f64::from(i), f64::from(j)) * size)).collect()
}

/// The point moved by the first of `copies` that brings it into the domain.
fn into_domain(frame: &Frame, copies: &[DVec2], point: DVec2) -> DVec2 {
    let Rectangle { min, max } = frame.domain;
    let inside = |p: &DVec2| min.cmple(*p).all() && p.cmple(max).all();
    copies.iter().map(|offset| point + *offset).find(inside).unwrap_or(point)
}

/// The signed area of a closed chain: positive counter-clockwise.
pub(super) fn signed_area(segments: &[Segment]) -> f64 {
    let about = segments[0].curve.start();
    segments.iter().map(|s| s.curve.area(about)).sum()
}

fn monotone(segments: &[Segment]) -> Vec<BezierCurve> {
    segments.iter().flat_map(|s| s.curve.monotone_pieces()).collect()
}

/// Makes each segment begin to the bit where the last one ends, around the loop.
fn close(segments: &mut [Segment]) {
    let mut joint = segments[segments.len() - 1].curve.end();
    for segment in segments {
        let end = segment.curve.end();
        segment.curve.set_ends(joint, end);
        joint = end;
    }
}

/// The winding number of a closed chain of monotone pieces about a point, by crossings with the ray toward +u.
///
/// Exact but for points nearer to a piece than its evaluation's rounding.
fn winding(pieces: &[BezierCurve], point: DVec2) -> i32 {
    let mut sum = 0;
    for piece in pieces {
        let (a, b) = (piece.start(), piece.end());
        let (low, high) = (a.y.min(b.y), a.y.max(b.y));
        if !(low <= point.y && point.y < high) || a.x.max(b.x) <= point.x {
            continue;
        }
        let right = point.x < a.x.min(b.x) || point.x < at_height(piece, point.y);
        sum += i32::from(right) * if a.y < b.y { 1 } else { -1 };
    }
    sum
}

/// u of a piece, monotone in v, at height `v` within its range.
fn at_height(piece: &BezierCurve, v: f64) -> f64 {
    let rises = piece.start().y < piece.end().y;
    let (mut low, mut high) = (0.0, 1.0);
    loop {
        let middle = 0.5 * (low + high);
        let point = piece.point(middle);
        if middle <= low || middle >= high {
            return point.x;
        }
        if (point.y <= v) == rises { low = middle } else { high = middle }
    }
}
