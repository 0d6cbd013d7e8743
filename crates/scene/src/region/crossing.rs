//! Whether boundaries cross: of one loop with itself, or of two.
//!
//! Touching is legal: a cusp, two holes that meet at a point, holes that share sides with their parent, an edge run there
//! and back. So is what a gap within the tolerance makes: trims that overshoot their joint. Loops cross where the one has
//! parts inside of the other and parts outside, or encloses a place twice, both by more than a margin: the tolerance, in
//! space, and a millionth of the domain.
//!
//! Curves are first searched for places where they meet. These cut each curve into arcs, and of every arc's middle the two
//! points a margin to its left and right are asked where they lie. It holds outside the domain, too.

use super::contour::{Contour, monotone, winding};
use super::frame::Frame;
use super::segment::{ClosedLoop, Segment};
use crate::{SceneError, TrimPlace};
use glam::DVec2;
use nurbs::{BezierCurve, Rectangle};
use std::ops::Range;

/// How far, as a share of the domain's length, two curves must pass through each other to be said to cross.
const MARGIN: f64 = 1e-6;

/// The widest margin, as a share of the domain, however large the tolerance, or slow the surface at a pole.
const WIDEST: f64 = 1e-2;

/// Halvings of a pair of pieces before what is left counts as touching.
const HALVINGS: u32 = 40;

/// The sine below which two chords are parallel.
const PARALLEL: f64 = 1e-9;

/// The most pairs of pieces, halves of them and places that are looked at for one face: some seconds.
///
/// A plate with ten thousand holes, circles of four arcs, takes 3e5 to 6e5; two circles that are one but for rounding 1.3e5.
const STEPS: usize = 1_000_000;

/// Pairs of boxes that count as one step: each is two comparisons.
const BOXES_A_STEP: usize = 64;

/// Steps that a meeting counts for, so that the most steps bound memory, too: 25 MB.
const MEETING_STEPS: usize = 4;

/// A part of a loop on which u and v are both monotone, in shares of the domain.
struct Piece {
    curve: BezierCurve,
    hull: Rectangle,
    /// Which of the paths it is a part of.
    path: usize,
    trim: Option<usize>,
    /// Where other pieces meet it.
    meetings: Vec<Meeting>,
}

#[derive(Clone, Copy)]
struct Meeting {
    t: f64,
    at: DVec2,
    /// The other piece.
    other: usize,
}

/// A closed chain: the range of its pieces.
struct Path {
    source: usize,
    /// Which copy of its loop.
    copy: usize,
    pieces: Range<usize>,
}

/// The first crossing that is found is an error, and so is a loop that overlaps its copy a period on.
pub(super) fn check(
    frame: &Frame,
    rings: &[ClosedLoop],
    contours: &[Contour],
    largest_gap: f64,
) -> Result<(), SceneError> {
    let mut search =
        Search { frame, paths: vec![], pieces: vec![], steps: 0, spare: 2.0 * frame.tolerance.max(largest_gap) };
    for (copy, ring) in rings.iter().enumerate() {
        if let Some(source) = ring.source {
            search.add(source, copy, monotone(&ring.segments), DVec2::ZERO);
        }
    }
    for contour in contours {
        for (copy, offset) in contour.copies.iter().enumerate() {
            search.add(contour.chain.source, copy, contour.monotone.iter().cloned(), *offset);
        }
    }
    search.find_meetings()?;
    for path in 0..search.paths.len() {
        search.check_path(path)?;
    }
    Ok(())
}

struct Search<'a> {
    frame: &'a Frame<'a>,
    paths: Vec<Path>,
    pieces: Vec<Piece>,
    steps: usize,
    /// The margin in space, model units.
    spare: f64,
}

impl Search<'_> {
    fn add(&mut self, source: usize, copy: usize, pieces: impl IntoIterator<Item = Segment>, offset: DVec2) {
        let (min, size) = (self.frame.domain.min, self.frame.domain.size());
        let first = self.pieces.len();
        for Segment { curve, trim } in pieces {
            let points = curve.control().iter().map(|p| {
                let q = (p.truncate() / p.z + offset - min) / size;
                (q * p.z).extend(p.z)
            });
            // A domain so small that its inverse overflows has no crossing that f64 could name.
            let Some(curve) = BezierCurve::new(points.collect()) else { continue };
            let hull = ends_box(&curve);
            self.pieces.push(Piece { curve, hull, path: self.paths.len(), trim, meetings: vec![] });
        }
        self.paths.push(Path { source, copy, pieces: first..self.pieces.len() });
    }

    /// Counts work, and refuses more than [`STEPS`].
    fn step(&mut self, count: usize) -> Result<(), SceneError> {
        self.steps = self.steps.saturating_add(count);
        if self.steps <= STEPS { Ok(()) } else { Err(SceneError::TrimWork { face: self.frame.face, limit: STEPS }) }
    }

    /// Where pieces meet, by a sweep along the axis on which they are short.
    fn find_meetings(&mut self) -> Result<(), SceneError> {
        let lengths: DVec2 = self.pieces.iter().map(|piece| piece.hull.size()).sum();
        let axis = usize::from(lengths.y < lengths.x);
        let mut order: Vec<usize> = (0..self.pieces.len()).collect();
        order.sort_by(|a, b| self.pieces[*a].hull.min[axis].total_cmp(&self.pieces[*b].hull.min[axis]));
        let mut found = vec![];
        for (k, &i) in order.iter().enumerate() {
            for (n, &j) in order[k + 1..].iter().enumerate() {
                let (a, b) = (&self.pieces[i], &self.pieces[j]);
                if a.hull.max[axis] < b.hull.min[axis] {
                    break;
                }
                let meets = a.hull.meets(b.hull);
                if n % BOXES_A_STEP == BOXES_A_STEP - 1 {
                    self.step(1)?;
                }
                if !meets {
                    continue;
                }
                let (a, b) = (&self.pieces[i], &self.pieces[j]);
                found.clear();
                let mut left = STEPS - self.steps;
                let whole = |piece: &Piece| Part::new(piece.curve.clone(), [0.0, 1.0]);
                meet(&whole(a), &whole(b), HALVINGS, &mut found, &mut left);
                self.step(STEPS - self.steps - left + usize::from(left == 0))?;
                for &(t, s, at) in &found {
                    self.pieces[i].meetings.push(Meeting { t, at, other: j });
                    self.pieces[j].meetings.push(Meeting { t: s, at, other: i });
                }
            }
        }
        for piece in &mut self.pieces {
            piece.meetings.sort_by(|a, b| a.t.total_cmp(&b.t));
        }
        Ok(())
    }

    /// Whether a path crosses itself or another one.
    fn check_path(&mut self, path: usize) -> Result<(), SceneError> {
        let range = self.paths[path].pieces.clone();
        // The others that it meets, and whether it meets itself elsewhere than at its joints.
        let mut met: Vec<usize> = vec![];
        for i in range.clone() {
            for meeting in &self.pieces[i].meetings {
                let other = self.pieces[meeting.other].path;
                if other != path || !self.is_joint(i, *meeting) {
                    met.push(other);
                }
            }
        }
        met.sort_unstable();
        met.dedup();
        for other in met {
            if other == path { self.check_windings(path)? } else { self.check_sides(path, other)? }
        }
        Ok(())
    }

    /// Whether two pieces of a path meet only as neighbours do, where the one begins as the other ends.
    fn is_joint(&self, piece: usize, meeting: Meeting) -> bool {
        let Range { start, end } = self.paths[self.pieces[piece].path].pieces.clone();
        let next = |i: usize| if i + 1 == end { start } else { i + 1 };
        let joint =
            |a: usize, b: usize| next(a) == b && self.is_within_margin(self.pieces[b].curve.start(), meeting.at);
        joint(piece, meeting.other) || joint(meeting.other, piece)
    }

    fn is_within_margin(&self, joint: DVec2, at: DVec2) -> bool {
        let way = at - joint;
        way.length() <= MARGIN || way.length() <= self.margin(joint, way.normalize_or_zero())
    }

    /// A path that meets itself: it encloses each place at most once, and all in the same direction.
    fn check_windings(&mut self, path: usize) -> Result<(), SceneError> {
        let range = self.paths[path].pieces.clone();
        let mut seen = [0; 2];
        let mut last = None;
        for i in range.clone() {
            for arc in self.arcs(i)? {
                self.step(2 * range.len())?;
                last = arc
                    .from
                    .filter(|m| self.pieces[m.other].path == path && !self.is_joint(i, *m))
                    .map(|m| (i, m))
                    .or(last);
                for point in arc.beside {
                    let winding = winding(self.curves(range.clone()), point);
                    seen = [seen[0].min(winding), seen[1].max(winding)];
                }
                if 1 < seen[1] - seen[0] {
                    let next = self.next_meeting(i, arc.end, path);
                    let (piece, meeting) = last.or(next).expect("a path is checked where it meets itself");
                    return Err(self.crossing(piece, meeting));
                }
            }
        }
        Ok(())
    }

    /// The first meeting of `path` with itself from parameter `t` of a piece on, elsewhere than at joints.
    fn next_meeting(&self, piece: usize, t: f64, path: usize) -> Option<(usize, Meeting)> {
        let range = self.paths[path].pieces.clone();
        let from = |i: usize| if i == piece { t } else { 0.0 };
        let meetings = (piece..range.end).chain(range.clone());
        meetings
            .flat_map(|i| self.pieces[i].meetings.iter().map(move |m| (i, *m)))
            .find(|(i, m)| from(*i) <= m.t && self.pieces[m.other].path == path && !self.is_joint(*i, *m))
    }

    /// Two paths that meet: all of the one is inside the other, or all of it outside.
    fn check_sides(&mut self, path: usize, other: usize) -> Result<(), SceneError> {
        let (range, holder) = (self.paths[path].pieces.clone(), self.paths[other].pieces.clone());
        let is_copy =
            self.paths[path].source == self.paths[other].source && self.paths[path].copy != self.paths[other].copy;
        let mut last = None;
        let mut side = None;
        for i in range {
            for arc in self.arcs(i)? {
                self.step(2 * holder.len())?;
                last = arc.from.filter(|m| self.pieces[m.other].path == other).map(|m| (i, m)).or(last);
                let is_inside = arc.beside.map(|p| winding(self.curves(holder.clone()), p) != 0);
                if is_inside[0] != is_inside[1] {
                    continue;
                }
                if is_copy && is_inside[0] {
                    let at = self.in_parameters(arc.beside[0]);
                    return Err(SceneError::LoopOverlap {
                        face: self.frame.face,
                        boundary: self.paths[path].source,
                        at,
                    });
                }
                if side.is_some_and(|side| side != is_inside[0]) {
                    let any = || self.any_meeting(path, other);
                    let (piece, meeting) = last.or_else(any).expect("the paths meet");
                    return Err(self.crossing(piece, meeting));
                }
                side = Some(is_inside[0]);
            }
        }
        Ok(())
    }

    fn curves(&self, range: Range<usize>) -> impl Iterator<Item = &BezierCurve> {
        self.pieces[range].iter().map(|piece| &piece.curve)
    }

    fn any_meeting(&self, path: usize, other: usize) -> Option<(usize, Meeting)> {
        let range = self.paths[path].pieces.clone();
        let mut meetings = range.flat_map(|i| self.pieces[i].meetings.iter().map(move |m| (i, *m)));
        meetings.find(|(_, m)| self.pieces[m.other].path == other)
    }

    /// The arcs of a piece between its meetings that count: inside the domain where the surface is closed, for there
    /// each loop is repeated; not what closes a ring, and not along a seam, over which others may go. Each meeting counts as a
    /// step: a path is asked for its arcs once for every other one that it meets.
    fn arcs(&mut self, index: usize) -> Result<Vec<Arc>, SceneError> {
        if self.is_on_seam(&self.pieces[index]) {
            return Ok(vec![]);
        }
        self.step(self.pieces[index].meetings.len())?;
        let piece = &self.pieces[index];
        let mut arcs = vec![];
        let (mut start, mut from) = (0.0, None);
        let end = Meeting { t: 1.0, at: piece.curve.end(), other: index };
        for (k, meeting) in piece.meetings.iter().chain([&end]).enumerate() {
            let [a, b] = [start, meeting.t].map(|t| piece.curve.point(t));
            if MARGIN < a.distance(b) {
                let middle = piece.curve.point(0.5 * (start + meeting.t));
                let across = (b - a).perp().normalize_or_zero();
                let margin = self.margin(middle, across);
                let beside = [middle + margin * across, middle - margin * across];
                let counts = |axis: usize| !self.frame.closed[axis] || (0.0..=1.0).contains(&middle[axis]);
                let is_in_domain = middle.cmpge(DVec2::ZERO).all() && middle.cmple(DVec2::ONE).all();
                let closes_ring = piece.trim.is_none() && !is_in_domain;
                if counts(0) && counts(1) && !closes_ring {
                    arcs.push(Arc { from, end: meeting.t, beside });
                }
            }
            if k < piece.meetings.len() {
                (start, from) = (meeting.t, Some(*meeting));
            }
        }
        Ok(arcs)
    }

    fn is_on_seam(&self, piece: &Piece) -> bool {
        let ends = [piece.curve.start(), piece.curve.end()];
        let is_along = |axis: usize, border: f64| ends.iter().all(|end| (end[axis] - border).abs() <= MARGIN);
        (0..2).any(|axis| self.frame.closed[axis] && [0.0, 1.0].iter().any(|&border| is_along(axis, border)))
    }

    /// How far a point on one side of a curve must be from it, in shares of the domain, in a direction of such.
    fn margin(&self, at: DVec2, direction: DVec2) -> f64 {
        let size = self.frame.domain.size();
        let uv =
            self.frame.wrapped(self.frame.domain.min + at * size).clamp(self.frame.domain.min, self.frame.domain.max);
        let d = self.frame.surface.first_derivatives(uv.x, uv.y);
        let speed = (d.su * (direction.x * size.x) + d.sv * (direction.y * size.y)).length();
        let margin = self.spare / speed;
        // Where the surface does not move, no number of parameters is the spare.
        if margin < WIDEST { margin.max(MARGIN) } else { WIDEST }
    }

    fn in_parameters(&self, at: DVec2) -> [f64; 2] {
        (self.frame.domain.min + at * self.frame.domain.size()).to_array()
    }

    fn crossing(&self, piece: usize, meeting: Meeting) -> SceneError {
        // Lists longer than u32 counts do not fit in a file.
        let index = |i: usize| u32::try_from(i).unwrap_or(u32::MAX);
        let [first, second] = [&self.pieces[piece], &self.pieces[meeting.other]].map(|piece| TrimPlace {
            boundary: Some(index(self.paths[piece.path].source)),
            trim: piece.trim.map(index),
        });
        SceneError::TrimsCross { face: self.frame.face, first, second, at: self.in_parameters(meeting.at) }
    }
}

/// A stretch of a piece between two meetings.
struct Arc {
    /// The meeting at which it begins; `None` at the piece's own start.
    from: Option<Meeting>,
    /// The parameter at which it ends.
    end: f64,
    /// Points a margin to the left and to the right of its middle.
    beside: [DVec2; 2],
}

/// The box of a monotone curve is that of its ends.
fn ends_box(curve: &BezierCurve) -> Rectangle {
    let (a, b) = (curve.start(), curve.end());
    Rectangle { min: a.min(b), max: a.max(b) }
}

/// A part of a piece, and the parameters of its ends there.
struct Part {
    curve: BezierCurve,
    hull: Rectangle,
    range: [f64; 2],
    /// How far the control points are from the chord.
    bend: f64,
}

impl Part {
    fn new(curve: BezierCurve, range: [f64; 2]) -> Self {
        Self { bend: bend(&curve), hull: ends_box(&curve), range, curve }
    }

    fn halves(&self) -> [Self; 2] {
        let middle = 0.5 * (self.range[0] + self.range[1]);
        let [low, high] = self.curve.split(0.5);
        [Self::new(low, [self.range[0], middle]), Self::new(high, [middle, self.range[1]])]
    }

    fn at(&self, share: f64) -> f64 {
        self.range[0] + (self.range[1] - self.range[0]) * share
    }
}

/// Adds the places at which two monotone curves meet, with the parameter of each; ends early where `left` steps are gone.
fn meet(a: &Part, b: &Part, halvings: u32, found: &mut Vec<(f64, f64, DVec2)>, left: &mut usize) {
    if *left == 0 || halvings == 0 || !a.hull.meets(b.hull) {
        return;
    }
    *left -= 1;
    if let Some((s, t, at)) = common_end(a, b) {
        *left = left.saturating_sub(MEETING_STEPS);
        found.push((a.at(s), b.at(t), at));
        return;
    }
    let is_same = a.curve == b.curve;
    if is_same || a.curve.control().iter().eq(b.curve.control().iter().rev()) {
        // One curve twice: they meet all along, and what follows tells their sides apart.
        let [start, end] = if is_same { b.range } else { [b.range[1], b.range[0]] };
        found.extend([(a.range[0], start, a.curve.start()), (a.range[1], end, a.curve.end())]);
        *left = left.saturating_sub(2 * MEETING_STEPS);
    } else if a.bend.max(b.bend) <= 0.5 * MARGIN {
        let chords = [[a.curve.start(), a.curve.end()], [b.curve.start(), b.curve.end()]];
        let meetings = chords_meet(chords);
        *left = left.saturating_sub(meetings.len() * MEETING_STEPS);
        found.extend(meetings.into_iter().map(|(s, t, at)| (a.at(s), b.at(t), at)));
    } else if a.bend < b.bend {
        b.halves().iter().for_each(|half| meet(a, half, halvings - 1, found, left));
    } else {
        a.halves().iter().for_each(|half| meet(half, b, halvings - 1, found, left));
    }
}

/// The common end, as shares of each, of two parts whose boxes lie side by side: where else they could meet both would
/// have to run along the line between the boxes, and what is monotone only ends there.
fn common_end(a: &Part, b: &Part) -> Option<(f64, f64, DVec2)> {
    let beside = |axis: usize| {
        let has_width = |part: &Part| part.hull.min[axis] < part.hull.max[axis];
        let touch = a.hull.max[axis] == b.hull.min[axis] || b.hull.max[axis] == a.hull.min[axis];
        touch && has_width(a) && has_width(b)
    };
    let ends = |part: &Part| [(0.0, part.curve.start()), (1.0, part.curve.end())];
    let mut pairs = ends(a).into_iter().flat_map(|(s, p)| ends(b).map(|(t, q)| (s, p, t, q)));
    let common = pairs.find(|(_, p, _, q)| p == q).filter(|_| beside(0) || beside(1));
    common.map(|(s, at, t, _)| (s, t, at))
}

fn bend(curve: &BezierCurve) -> f64 {
    let (a, b) = (curve.start(), curve.end());
    let along = (b - a).normalize_or_zero();
    curve.control().iter().map(|c| (c.truncate() / c.z - a).perp_dot(along).abs()).fold(0.0, f64::max)
}

/// Where two segments meet, as shares of each: a point; or, where they run side by side, the ends of what they share.
fn chords_meet([[a, b], [c, d]]: [[DVec2; 2]; 2]) -> Vec<(f64, f64, DVec2)> {
    let (ab, cd) = (b - a, d - c);
    let area = ab.perp_dot(cd);
    if area.abs() <= PARALLEL * ab.length() * cd.length() {
        let share = |from: DVec2, way: DVec2, p: DVec2| (p - from).dot(way) / way.length_squared();
        let on = |from: DVec2, way: DVec2, p: DVec2| {
            let s = share(from, way, p);
            let is_on = (0.0..=1.0).contains(&s) && (p - from - way * s).length() <= MARGIN;
            is_on.then_some(s)
        };
        let of_cd = [(c, 0.0), (d, 1.0)].into_iter().filter_map(|(p, t)| Some((on(a, ab, p)?, t, p)));
        let of_ab = [(a, 0.0), (b, 1.0)].into_iter().filter_map(|(p, s)| Some((s, on(c, cd, p)?, p)));
        return of_cd.chain(of_ab).collect();
    }
    let (s, t) = ((c - a).perp_dot(cd) / area, (c - a).perp_dot(ab) / area);
    // An end that all but reaches the other segment meets it.
    let slack = |way: DVec2| MARGIN / way.length();
    let reaches = |x: f64, slack: f64| -slack <= x && x <= 1.0 + slack;
    let meets = reaches(s, slack(ab)) && reaches(t, slack(cd));
    meets.then(|| (s.clamp(0.0, 1.0), t.clamp(0.0, 1.0), a + ab * s)).into_iter().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    fn part(points: [[f64; 2]; 3]) -> Part {
        let control = points.map(|[u, v]| DVec3::new(u, v, 1.0)).to_vec();
        Part::new(BezierCurve::new(control).expect("a legal curve"), [0.0, 1.0])
    }

    #[test]
    fn parts_beside_each_other_meet_at_their_common_end() {
        let rising = part([[0.0, 0.0], [0.0, 1.0], [1.0, 1.0]]);
        let falling = part([[1.0, 1.0], [2.0, 1.0], [2.0, 0.0]]);
        let on = part([[1.0, 1.0], [1.0, 2.0], [2.0, 2.0]]);
        for next in [falling, on] {
            assert_eq!(common_end(&rising, &next), Some((1.0, 0.0, DVec2::ONE)));
            assert_eq!(common_end(&next, &rising), Some((0.0, 1.0, DVec2::ONE)));
        }
    }

    #[test]
    fn parts_that_may_meet_elsewhere_too_are_looked_at() {
        let rising = part([[0.0, 0.0], [0.0, 1.0], [1.0, 1.0]]);
        let back = part([[1.0, 1.0], [0.5, 0.5], [0.0, 0.5]]);
        let beside = part([[1.0, 0.5], [2.0, 0.5], [2.0, 0.0]]);
        // Along the line between the boxes.
        let upright = part([[1.0, 1.0], [1.0, 0.5], [1.0, 0.0]]);
        for other in [back, beside, upright] {
            assert_eq!(common_end(&rising, &other), None);
        }
    }
}
