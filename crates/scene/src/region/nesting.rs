//! Which loop lies in which, and what that says of orientation.
//!
//! The depth of a loop is fact; the file has two witnesses for it, the `outer` flag and the direction of the loop. Where
//! one is wrong the other corrects it; where both are, the loops do not say what is material.
//!
//! Loops do not cross, so that of two whose insides meet the larger holds the smaller, whatever sides they share.

use super::contour::{Contour, curves, monotone, winding};
use super::frame::Frame;
use super::repairs::Repairs;
use super::segment::{ClosedLoop, Segment};
use crate::SceneError;
use glam::DVec2;

/// Relative difference of areas below which neither loop is the larger: that of their computation.
const EQUAL: f64 = 1e-11;

/// Adds the loops that close by themselves to `loops`, which holds those that go around, each turned by its depth.
pub(super) fn place(
    frame: &Frame,
    contours: &[Contour],
    loops: &mut Vec<ClosedLoop>,
    repairs: &mut Repairs,
) -> Result<(), SceneError> {
    let is_cut_from_whole = loops.is_empty() && are_cut_from_whole(frame, contours);
    if is_cut_from_whole {
        loops.push(ClosedLoop { segments: frame.boundary(), depth: 0, source: None });
    }
    let around: Vec<Vec<Segment>> = loops.iter().map(|l| monotone(&l.segments)).collect();
    for contour in contours {
        let within = if is_cut_from_whole { Around::Whole } else { Around::Rings(&around) };
        let depth = depth(frame, contour, contours, &within);
        let (chain, expected) = (contour.chain, depth.is_multiple_of(2));
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
        if contour.copies != [DVec2::ZERO] {
            repairs.across_seam.push(chain.source);
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
fn are_cut_from_whole(frame: &Frame, contours: &[Contour]) -> bool {
    let clockwise = contours.iter().all(|c| c.area < 0.0);
    let holes = contours.iter().all(|c| !c.chain.outer);
    clockwise && (holes || frame.is_unbounded(0) && frame.is_unbounded(1))
}

/// What holds loops that close by themselves, beside their like.
enum Around<'a> {
    /// The natural boundary, which holds all, also what leaves an open domain.
    Whole,
    /// Closed chains of monotone pieces: the loops that go around.
    Rings(&'a [Vec<Segment>]),
}

/// In how many of the other loops a loop lies: what most points inside it say.
fn depth(frame: &Frame, contour: &Contour, all: &[Contour], around: &Around) -> usize {
    let holders: Vec<&Contour> = all.iter().filter(|other| may_hold(other, contour)).collect();
    let count = |point: DVec2| {
        let point = into_domain(frame, &contour.copies, point);
        let is_around = match around {
            Around::Whole => true,
            Around::Rings(rings) => rings.iter().map(|ring| winding(curves(ring), point)).sum::<i32>() != 0,
        };
        usize::from(is_around) + holders.iter().filter(|other| other.holds(point)).count()
    };
    let mut depths: Vec<usize> = contour.interior().into_iter().map(count).collect();
    depths.sort_unstable();
    depths.get(depths.len().saturating_sub(1) / 2).copied().unwrap_or(0)
}

/// Whether a loop is larger than another and stands about where that does.
fn may_hold(other: &Contour, contour: &Contour) -> bool {
    let is_repeated = [contour, other].iter().any(|c| c.copies != [DVec2::ZERO]);
    let is_near = is_repeated || contour.chain.hull.meets(other.chain.hull);
    is_near && {
        let (a, b) = (contour.area.abs(), other.area.abs());
        if (a - b).abs() <= EQUAL * b {
            // Of two that are equal an outer loop holds a hole, else the one that is listed first.
            let order = |c: &Contour| (!c.chain.outer, c.chain.source);
            order(other) < order(contour)
        } else {
            a < b
        }
    }
}

/// The point moved by the first of `copies` that brings it into the domain.
fn into_domain(frame: &Frame, copies: &[DVec2], point: DVec2) -> DVec2 {
    let inside = |p: &DVec2| frame.domain.min.cmple(*p).all() && p.cmple(frame.domain.max).all();
    copies.iter().map(|offset| point + *offset).find(inside).unwrap_or(point)
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
