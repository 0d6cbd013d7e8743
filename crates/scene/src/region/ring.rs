//! Rings: loops that close only around a closed surface.
//!
//! A ring is unrolled over the domain and closed beyond the far border of the other direction, so that it encloses
//! what lies above it. Rings do not cross, so that material and none alternate from one to the next; the lowest one's
//! own direction says on which side of it material is, and whether the natural boundary below belongs to it. Where the
//! surface is closed in the other direction, too, there is no boundary below, and an odd number of rings bounds nothing.

use super::chain::Chain;
use super::contour::signed_area;
use super::frame::Frame;
use super::repairs::Repairs;
use super::segment::{ClosedLoop, Segment};
use crate::SceneError;
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
    if rings.len() % 2 == 1 && frame.closed[1 - axis] {
        let boundaries = rings.iter().map(|ring| ring.source).collect();
        return Err(SceneError::OddRings { face: frame.face, boundaries });
    }
    let mut closed: Vec<Unrolled> = vec![];
    for ring in rings {
        closed.extend(offsets_across(frame, ring, 1 - axis).map(|across| Unrolled::new(frame, ring, axis, across)));
    }
    closed.sort_by(|a, b| a.height.total_cmp(&b.height));
    let mut loops = vec![];
    // A clockwise closure takes away what is above it: then material lies below the lowest ring.
    let mut material = !closed[0].is_above;
    if material {
        loops.push(ClosedLoop { segments: frame.boundary(), depth: 0, source: None });
    }
    for Unrolled { ring, is_above, mut segments, .. } in closed {
        if is_above == material {
            segments = segments.iter().rev().map(Segment::reversed).collect();
            repairs.reoriented.push(ring.source);
        }
        loops.push(ClosedLoop { segments, depth: usize::from(material), source: Some(ring.source) });
        material = !material;
    }
    repairs.reoriented.dedup();
    Ok(loops)
}

/// The moves by whole periods, in the direction across it, at which a ring reaches into the domain.
///
/// One, unless the surface is closed that way too and the ring crosses that seam.
fn offsets_across(frame: &Frame, ring: &Chain, across: usize) -> impl Iterator<Item = f64> {
    let (period, min, max) = (frame.domain.size()[across], frame.domain.min[across], frame.domain.max[across]);
    let (low, high) = (ring.hull.min[across], ring.hull.max[across]);
    let is_inside = min <= low && high <= max;
    let is_repeated = !is_inside && frame.closed[across];
    let base = if is_repeated { -((0.5 * (low + high) - min) / period).floor() } else { 0.0 };
    let copies = if is_repeated { -1..=1 } else { 0..=0 };
    let offset = move |copy: i32| (base + f64::from(copy)) * period;
    copies.map(offset).filter(move |offset| !is_repeated || (min < high + offset && low + offset < max))
}

/// A ring as a closed loop.
struct Unrolled<'a> {
    ring: &'a Chain,
    segments: Vec<Segment>,
    /// Its mean position in the direction across it: of rings that do not cross, the order.
    height: f64,
    /// Whether it runs so that material is on the far side of it.
    is_above: bool,
}

impl<'a> Unrolled<'a> {
    /// Copies of the ring from before the domain to behind it, moved by `offset` across, closed beyond its far border.
    fn new(frame: &Frame, ring: &'a Chain, axis: usize, offset: f64) -> Self {
        let across = 1 - axis;
        let period = frame.domain.size()[axis];
        let direction = f64::from(ring.periods[axis]);
        let start = ring.segments[0].curve.start();
        let mut base = DVec2::ZERO;
        base[axis] = -((start[axis] - frame.domain.min[axis]) / period).floor() * period;
        base[across] = offset;
        let mut segments: Vec<Segment> = vec![];
        for copy in -COPIES..=COPIES {
            let mut moved_by = base;
            moved_by[axis] += direction * f64::from(copy) * period;
            for segment in &ring.segments {
                let mut moved = segment.translated(moved_by);
                if let Some(last) = segments.last().map(|s| s.curve.end()) {
                    let end = moved.curve.end();
                    moved.curve.set_ends(last, end);
                }
                segments.push(moved);
            }
        }
        let (from, to) = (segments[0].curve.start(), segments[segments.len() - 1].curve.end());
        let beyond = frame.domain.max[across].max(ring.hull.max[across] + offset) + frame.domain.size()[across];
        let (mut corner, mut other) = (to, from);
        corner[across] = beyond;
        other[across] = beyond;
        segments.extend([Segment::line(to, corner), Segment::line(corner, other), Segment::line(other, from)]);
        let area = signed_area(&segments);
        let height = beyond - area.abs() / (period * f64::from(2 * COPIES + 1));
        Self { ring, segments, height, is_above: 0.0 < area }
    }
}
