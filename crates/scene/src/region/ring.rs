//! Rings: loops that close only around a closed surface.
//!
//! A ring is unrolled over the domain and closed beyond the far border of the other direction, so that it encloses
//! what lies above it. Rings do not cross, so that material and none alternate from one to the next; the lowest one's
//! own direction says on which side of it material is, and whether the natural boundary below belongs to it.

use super::{ClosedLoop, Frame, Repairs, Segment};
use crate::SceneError;
use crate::region::chain::Chain;
use crate::region::nesting::signed_area;
use glam::DVec2;

/// How many copies on either side of the domain are unrolled: a ring begins at most a period off, and may lean by one.
const COPIES: i32 = 2;

/// The rings as closed loops, and the natural boundary where they leave material to it.
pub(super) fn close(frame: &Frame, rings: &[Chain], repairs: &mut Repairs) -> Result<Vec<ClosedLoop>, SceneError> {
    let Some(first) = rings.first() else { return Ok(vec![]) };
    let axis = usize::from(first.periods[0] == 0);
    for ring in rings {
        if ring.periods[axis].abs() != 1 || ring.periods[1 - axis] != 0 {
            let [u, v] = ring.periods;
            return Err(SceneError::LoopPeriod { face: frame.face, boundary: ring.source, u, v });
        }
    }
    let mut closed: Vec<(f64, bool, &Chain, Vec<Segment>)> = rings
        .iter()
        .map(|ring| {
            let segments = unrolled(frame, ring, axis);
            let loops_area = signed_area(&segments);
            (height(frame, ring, axis), 0.0 < loops_area, ring, segments)
        })
        .collect();
    closed.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut loops = vec![];
    // A clockwise closure takes away what is above it: then material lies below the lowest ring.
    let mut material = !closed[0].1;
    if material {
        loops.push(ClosedLoop { segments: frame.boundary(), depth: 0, source: None });
    }
    for (_, rises, ring, mut segments) in closed {
        if rises == material {
            segments = segments.iter().rev().map(Segment::reversed).collect();
            repairs.reoriented.push(ring.source);
        }
        loops.push(ClosedLoop { segments, depth: usize::from(material), source: Some(ring.source) });
        material = !material;
    }
    Ok(loops)
}

/// Where the ring stands in the direction across it: the middle of its box, moved into the domain.
fn height(frame: &Frame, ring: &Chain, axis: usize) -> f64 {
    let across = 1 - axis;
    0.5 * (ring.hull.min[across] + ring.hull.max[across]) - into_domain(frame, ring, across)
}

/// The whole periods, in parameters, by which a ring's box is off the domain in the direction across it.
fn into_domain(frame: &Frame, ring: &Chain, across: usize) -> f64 {
    let middle = 0.5 * (ring.hull.min[across] + ring.hull.max[across]);
    let period = frame.domain.size()[across];
    ((middle - frame.domain.min[across]) / period).floor() * period * f64::from(u8::from(frame.is_closed(across)))
}

/// Copies of the ring from before the domain to behind it, closed beyond its far border.
fn unrolled(frame: &Frame, ring: &Chain, axis: usize) -> Vec<Segment> {
    let across = 1 - axis;
    let period = frame.domain.size()[axis];
    let direction = f64::from(ring.periods[axis]);
    let start = ring.segments[0].curve.start();
    let mut base = DVec2::ZERO;
    base[axis] = -((start[axis] - frame.domain.min[axis]) / period).floor() * period;
    base[across] = -into_domain(frame, ring, across);
    let mut segments: Vec<Segment> = vec![];
    for copy in -COPIES..=COPIES {
        let mut offset = base;
        offset[axis] += direction * f64::from(copy) * period;
        for segment in &ring.segments {
            let mut moved = segment.translated(offset);
            if let Some(last) = segments.last().map(|s| s.curve.end()) {
                let end = moved.curve.end();
                moved.curve.set_ends(last, end);
            }
            segments.push(moved);
        }
    }
    let (from, to) = (segments[0].curve.start(), segments[segments.len() - 1].curve.end());
    let beyond = frame.domain.max[across].max(ring.hull.max[across] + base[across]) + frame.domain.size()[across];
    let (mut corner, mut other) = (to, from);
    corner[across] = beyond;
    other[across] = beyond;
    segments.extend([Segment::line(to, corner), Segment::line(corner, other), Segment::line(other, from)]);
    segments
}
