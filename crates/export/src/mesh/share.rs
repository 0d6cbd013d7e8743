//! Points of an edge, the same for all faces that share it.
//!
//! The trims of an edge run through space at different speeds and up to a gap apart. Each point that one of them needs is
//! looked for on the others: the nearest place there gets the same point. It stands where the first trim has it.

use super::cells::Bounds;
use super::points::Points;
use super::side::{Kind, Outline};
use glam::DVec3;
use std::collections::BTreeMap;

/// Trims are uses of one edge where they run within this share of its length of each other: files may give one number to all
/// their edges.
const NEAR: f64 = 1e-2;

/// Places of a side between which the nearest point is sought.
const STATIONS: usize = 16;

/// Stations are as near as the nearest within this share of the distance and the edge's length: where two sides meet, or a closed
/// edge begins, there are two.
const AS_NEAR: f64 = 1e-9;

/// Steps of that search: the bracket is halved at least every third.
const STEPS: u32 = 160;

/// Points of several trims are one within this many gaps between them, and this share of the edge's length.
const GAPS: f64 = 4.0;

/// See [`GAPS`].
const SAME: f64 = 1e-7;

/// A trim as a use of an edge: the sides that it is cut into.
struct Use {
    face: usize,
    sides: Vec<usize>,
    stations: Vec<Station>,
    /// Of its chords, model units.
    length: f64,
}

struct Station {
    side: usize,
    s: f64,
    place: DVec3,
}

/// A place on a use.
#[derive(Clone, Copy)]
struct Found {
    side: usize,
    s: f64,
    place: DVec3,
}

/// The trims of an edge, by face, loop and place in it, with the sides that each is cut into.
type Trims = BTreeMap<(usize, usize, usize), Vec<usize>>;

/// Gives the trims of each edge the same points. Each has enough that its chords are within what is `allowed` on its face of
/// it, model units.
pub(super) fn share(outlines: &mut [Outline], bounds: &[&Bounds], allowed: &[f64], points: &mut Points) {
    let mut trims: BTreeMap<i64, Trims> = BTreeMap::new();
    for (face, outline) in outlines.iter().enumerate() {
        for (side, own) in outline.sides.iter().enumerate() {
            if let Kind::Edge { edge, boundary, trim } = own.kind {
                trims.entry(edge).or_default().entry((face, boundary, trim)).or_default().push(side);
            }
        }
    }
    for uses in trims.into_values().filter(|uses| 1 < uses.len()) {
        let mut groups: Vec<Vec<Use>> = vec![];
        for ((face, ..), sides) in uses {
            let own = Use::new(&outlines[face], face, sides);
            match groups.iter_mut().find(|group| own.is_near(&group[0])) {
                Some(group) => group.push(own),
                None => groups.push(vec![own]),
            }
        }
        for group in groups.iter().filter(|group| 1 < group.len()) {
            one_set(outlines, group, points);
            refine(outlines, bounds, group, allowed, points);
        }
    }
}

/// Joins the points that the uses have, and puts each on all of them.
fn one_set(outlines: &mut [Outline], group: &[Use], points: &mut Points) {
    struct Candidate {
        /// Along the first use.
        at: f64,
        place: DVec3,
        own: usize,
        side: usize,
        node: usize,
    }
    let first = &group[0];
    let order = |side: usize| first.sides.iter().position(|own| *own == side).expect("a side of it") as f64;
    // One of the two may end before the other: its way to the other counts.
    let apart = |other: &Use| other.farthest(outlines, first).min(first.farthest(outlines, other));
    let mut gap = group[1..].iter().map(apart).fold(0.0, f64::max);
    let mut candidates: Vec<Candidate> = vec![];
    for (own, other) in group.iter().enumerate() {
        for &side in &other.sides {
            for (node, given) in outlines[other.face].sides[side].nodes.iter().enumerate() {
                let place = outlines[other.face].place(given.uv);
                let at = if own == 0 {
                    order(side) + given.s
                } else {
                    let found = first.nearest(&outlines[first.face], place);
                    gap = gap.max(found.place.distance(place));
                    order(found.side) + found.s
                };
                candidates.push(Candidate { at, place, own, side, node });
            }
        }
    }
    candidates.sort_by(|a, b| a.at.total_cmp(&b.at).then(a.own.cmp(&b.own)));
    let merged = (GAPS * gap).max(SAME * first.length);
    let mut missing: Vec<(usize, usize)> = vec![];
    let mut from = 0;
    while from < candidates.len() {
        let leader = candidates[from].place;
        let count = candidates[from..].iter().take_while(|c| c.place.distance(leader) <= merged).count();
        let cluster = &candidates[from..from + count];
        let place = cluster.iter().find(|c| c.own == 0).map_or(leader, |c| c.place);
        let point = points.add(place);
        for Candidate { own, side, node, .. } in cluster {
            outlines[group[*own].face].sides[*side].nodes[*node].point = Some(point);
        }
        missing.extend((0..group.len()).filter(|own| cluster.iter().all(|c| c.own != *own)).map(|own| (own, point)));
        from += count;
    }
    // Inserted last, since that moves the nodes of a side.
    for (own, point) in missing {
        put(outlines, &group[own], point, 2.0 * merged, points);
    }
    let ends = [&candidates[0], &candidates[candidates.len() - 1]];
    if ends[0].place.distance(ends[1].place) <= merged {
        let point = |c: &Candidate| first.end_point(&outlines[first.face], c.at < 0.5);
        if let [Some(a), Some(b)] = ends.map(point) {
            points.join(a, b);
        }
    }
}

/// Halves what is too long for any of the uses, on all of them.
fn refine(outlines: &mut [Outline], bounds: &[&Bounds], group: &[Use], allowed: &[f64], points: &mut Points) {
    for (number, own) in group.iter().enumerate() {
        let outline = &outlines[own.face];
        let mut new = vec![];
        for &side in &own.sides {
            for (node, pair) in outline.sides[side].nodes.windows(2).enumerate() {
                let parts = outline.parts(bounds[own.face], side, node, allowed[own.face]);
                let step = (pair[1].s - pair[0].s) / parts;
                new.extend((1..parts as usize).map(|k| (side, pair[0].s + step * k as f64)));
            }
        }
        for (side, s) in new {
            let uv = outlines[own.face].sides[side].curve.point(s);
            let point = points.add(outlines[own.face].place(uv));
            outlines[own.face].insert(side, s, point, points);
            for (_, other) in group.iter().enumerate().filter(|(other, _)| *other != number) {
                put(outlines, other, point, f64::INFINITY, points);
            }
        }
    }
}

/// Puts a point where a use is nearest to it, unless that is farther than `reach`: the use ends before.
fn put(outlines: &mut [Outline], own: &Use, point: usize, reach: f64, points: &mut Points) {
    let place = points.place(point);
    let found = own.nearest(&outlines[own.face], place);
    if found.place.distance(place) <= reach {
        outlines[own.face].insert(found.side, found.s, point, points);
    }
}

impl Use {
    fn new(outline: &Outline, face: usize, sides: Vec<usize>) -> Self {
        let stations = sides.iter().flat_map(|&side| {
            let count = STATIONS.max(4 * outline.sides[side].curve.degree());
            (0..=count).map(move |k| {
                let s = k as f64 / count as f64;
                Station { side, s, place: outline.place(outline.sides[side].curve.point(s)) }
            })
        });
        let stations: Vec<Station> = stations.collect();
        let chords = stations.windows(2).filter(|pair| pair[0].side == pair[1].side);
        let length = chords.map(|pair| pair[0].place.distance(pair[1].place)).sum();
        Self { face, sides, stations, length }
    }

    /// Whether all of the use is near the chords of another.
    fn is_near(&self, other: &Self) -> bool {
        let most = NEAR * other.length;
        let from_chord = |p: DVec3, pair: &[Station]| {
            let (a, along) = (pair[0].place, pair[1].place - pair[0].place);
            let square = along.length_squared();
            let share = if square > 0.0 { ((p - a).dot(along) / square).clamp(0.0, 1.0) } else { 0.0 };
            p.distance(a + along * share)
        };
        let chords = || other.stations.windows(2).filter(|pair| pair[0].side == pair[1].side);
        self.stations.iter().all(|station| chords().any(|pair| from_chord(station.place, pair) <= most))
    }

    /// The greatest distance of the use from another, by its stations.
    fn farthest(&self, outlines: &[Outline], other: &Self) -> f64 {
        let outline = &outlines[other.face];
        let from = |station: &Station| other.nearest(outline, station.place).place.distance(station.place);
        self.stations.iter().map(from).fold(0.0, f64::max)
    }

    /// The point at the start or the end of the first use.
    fn end_point(&self, outline: &Outline, is_start: bool) -> Option<usize> {
        let side = if is_start { self.sides.first() } else { self.sides.last() };
        let nodes = &outline.sides[*side?].nodes;
        if is_start { nodes.first() } else { nodes.last() }?.point
    }

    /// The place of the use that is nearest to a point.
    fn nearest(&self, outline: &Outline, p: DVec3) -> Found {
        let distance = |station: &Station| station.place.distance(p);
        let least = self.stations.iter().map(distance).fold(f64::INFINITY, f64::min);
        let near = least + AS_NEAR * (least + self.length);
        let candidates = (0..self.stations.len()).filter(|k| distance(&self.stations[*k]) <= near);
        let found = candidates.map(|k| self.search(outline, k, p));
        found
            .min_by(|a, b| a.place.distance_squared(p).total_cmp(&b.place.distance_squared(p)))
            .expect("a station is nearest")
    }

    /// The nearest place between the stations on both sides of one: a root of (C − p) · C', by false position (Dowell &
    /// Jarratt 1971, "Illinois") with halving.
    fn search(&self, outline: &Outline, k: usize, p: DVec3) -> Found {
        let Station { side, s, place } = self.stations[k];
        let curve = &outline.sides[side].curve;
        let slope = |s: f64| {
            let [uv, uv_s] = curve.first_derivative(s);
            let d = outline.surface.first_derivatives(uv.x, uv.y);
            (d.s - p).dot(d.su * uv_s.x + d.sv * uv_s.y)
        };
        let beside = |k: Option<usize>| {
            let station = k.and_then(|k| self.stations.get(k)).filter(|station| station.side == side);
            station.map_or(s, |station| station.s)
        };
        let [mut low, mut high] = [beside(k.checked_sub(1)), beside(Some(k + 1))];
        let (mut at_low, mut at_high) = (slope(low), slope(high));
        if !(at_low < 0.0 && 0.0 < at_high) {
            // At an end of the side, or no single root: the better of the ends and the station.
            let end = if 0.0 <= at_low { low } else { high };
            let end = Found { side, s: end, place: outline.place(curve.point(end)) };
            let own = Found { side, s, place };
            return if end.place.distance_squared(p) < place.distance_squared(p) { end } else { own };
        }
        let mut kept = 0;
        for step in 0..STEPS {
            let middle = match step % 3 {
                2 => 0.5 * (low + high),
                _ => (low * at_high - high * at_low) / (at_high - at_low),
            };
            if !(low < middle && middle < high) {
                break;
            }
            let at = slope(middle);
            // An end that stays twice counts half.
            if at < 0.0 {
                (low, at_low) = (middle, at);
                at_high *= if kept == 1 { 0.5 } else { 1.0 };
                kept = 1;
            } else {
                (high, at_high) = (middle, at);
                at_low *= if kept == -1 { 0.5 } else { 1.0 };
                kept = -1;
            }
            if high - low <= f64::EPSILON {
                break;
            }
        }
        // One end of the bracket is at the root, or next to it; the other may have stayed far.
        let ends = [low, high].map(|s| Found { side, s, place: outline.place(curve.point(s)) });
        let [a, b] = ends.map(|end| end.place.distance_squared(p));
        ends[usize::from(b < a)]
    }
}
