//! Branch and bound over an edge: the greatest gap, angle and difference of curvature, proven from above and seen from below.
//!
//! Two searches are made: over A with the feet of its places on B, and over B with the feet of its places on A. Each bound is the
//! greater of the two. A stretch of the edge whose bound is too far above what was seen is halved, the worst first. What is too short to be halved
//! and still has no bound, since a normal vanishes there, is a [`Degenerate`] place of the edge, a result of its own: the bounds
//! of angle and curvature are about the rest. The bound of the gap is about all.

use crate::border::Border;
use crate::limits::{Limits, Verdict};
use crate::measure::{Criterion, Measured, UNKNOWN, measured};
use crate::nearest::distance_at_least;
use crate::taylor::Taylor;
use crate::tube::{Pair, Stretch};
use glam::{DVec2, DVec3};
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// A bound this near to what was seen is close enough, where no limit lies between.
const CLOSE: f64 = 1e-2;

/// A bound below this share of its limit is not refined.
const FAR_BELOW: f64 = 1e-2;

/// A bound this share above a limit is left there: the answer is undecided within it.
const MARGIN: f64 = 1e-6;

/// Halvings in a row that may leave a bound nearly as wide as it was: then it is rounding that makes it wide.
const STALLS: u32 = 6;

/// A halving that leaves more than this of the width between a bound and what was seen is such a one.
const STALLED: f64 = 0.8;

/// What is left open of r, of the stretch's, where it is as good as known.
const NARROW: f64 = 1e-4;

/// Stretches that are evaluated for one edge before what is left stays undecided.
const MOST_STRETCHES: usize = 5_000;

/// Halvings of a stretch between two pins before it is left as it is.
const HALVINGS: u32 = 26;

/// Halvings after which a stretch without a bound is a degenerate place: about a millionth of the edge.
const DEGENERATE: u32 = 20;

/// What a relative difference of curvature is measured by where none is judged.
const UNJUDGED: f64 = 1.0;

/// Degenerate places within this share of an edge are one.
const ONE_PLACE: f64 = 1e-3;

/// Of two numbers the difference is at most twice the greater.
const MOST_RELATIVE: f64 = 2.0;

/// Two borders that run the same way along an edge, and what counts as flat.
#[derive(Debug, Clone)]
pub struct Joint<'m> {
    /// A.
    pub first: Border<'m>,
    /// B.
    pub second: Border<'m>,
    /// The curvature below which a surface counts as flat, 1 / model units.
    pub flat: f64,
}

/// A place of an edge.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place {
    /// The borders' own parameters.
    pub parameters: [f64; 2],
    /// The share of A's border before it, by length.
    pub share: f64,
    /// The point of A, model units.
    pub position: DVec3,
    /// In the domains of both surfaces.
    pub uv: [DVec2; 2],
}

/// The greatest value of a criterion over an edge.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Finding {
    /// Nowhere greater: proven.
    pub bound: f64,
    /// At least this, at the place: proven, too.
    pub seen: f64,
    /// Where; the middle of the edge where nothing was seen.
    pub at: Place,
}

/// A place where a normal, or the direction of a border, vanishes or may vanish.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Degenerate {
    /// Where.
    pub at: Place,
    /// The length of the edge that is left out there, by chords, model units.
    pub length: f64,
    /// What has no bound there: the angle and with it the curvature, or the curvature alone.
    pub criterion: Criterion,
}

/// What is proven of an edge.
#[derive(Debug, Clone, PartialEq)]
pub struct Certificate {
    findings: [Finding; Criterion::COUNT],
    /// Places without a normal or a direction.
    pub degenerate: Vec<Degenerate>,
    /// Whether corresponding places are proven feet of perpendiculars everywhere; elsewhere the bounds hold for all pairs of
    /// places in a stretch.
    pub is_perpendicular: bool,
    /// The length of A's border by chords, model units: measured, not bounded.
    pub length: f64,
    /// How many stretches were evaluated.
    pub stretches: usize,
}

struct Open {
    stretch: Stretch,
    halvings: u32,
    stalls: u32,
    measured: Measured,
    is_foot: bool,
    urgency: f64,
    /// Between the most urgent bound and what was seen on this stretch.
    width: f64,
}

impl PartialEq for Open {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Open {}

impl PartialOrd for Open {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Open {
    fn cmp(&self, other: &Self) -> Ordering {
        let place = |open: &Self| open.stretch.s[0];
        self.urgency.total_cmp(&other.urgency).then(place(other).total_cmp(&place(self)))
    }
}

impl Certificate {
    /// The finding of a criterion.
    pub fn finding(&self, criterion: Criterion) -> Finding {
        self.findings[criterion as usize]
    }

    /// The verdicts on gap, angle and, where it is judged, curvature.
    pub fn verdicts(&self, limits: &Limits) -> Vec<(Criterion, Verdict)> {
        let verdict = |aim: Aim| {
            let finding = self.finding(aim.criterion);
            (aim.criterion, Verdict::of(finding.seen, finding.bound, aim.limit))
        };
        aims(limits).into_iter().filter(|aim| aim.is_judged).map(verdict).collect()
    }

    /// The worst of [`Self::verdicts`].
    pub fn verdict(&self, limits: &Limits) -> Verdict {
        self.verdicts(limits).into_iter().map(|(_, verdict)| verdict).max().unwrap_or(Verdict::Pass)
    }
}

/// A criterion and its limit, in its own units.
#[derive(Clone, Copy)]
struct Aim {
    criterion: Criterion,
    limit: f64,
    is_judged: bool,
}

fn aims(limits: &Limits) -> [Aim; 3] {
    let aim =
        |criterion, limit: Option<f64>| Aim { criterion, limit: limit.unwrap_or(UNJUDGED), is_judged: limit.is_some() };
    [
        aim(Criterion::Gap, Some(limits.gap)),
        aim(Criterion::Angle, Some(limits.angle_deg.to_radians())),
        aim(Criterion::Curvature, limits.curvature),
    ]
}

impl Aim {
    /// How far a bound is above what it need not be below; at most 1 where nothing is left to do.
    fn urgency(&self, upper: f64, seen: f64) -> f64 {
        let close = ((1.0 + CLOSE) * seen).max(FAR_BELOW * self.limit);
        let is_open = self.is_judged && seen <= self.limit;
        upper / if is_open { close.min(self.limit * (1.0 + MARGIN)) } else { close }
    }
}

impl Joint<'_> {
    /// Bounds all criteria, as close as the limits make it matter.
    pub fn certify(&self, limits: &Limits) -> Certificate {
        let mut search = Search { joint: self, aims: aims(limits), best: [None; Criterion::COUNT], stretches: 0 };
        let forward = search.run();
        let swapped = |(seen, [s, r]): (f64, [f64; 2])| (seen, [r, s]);
        let turned = Self { first: self.second.clone(), second: self.first.clone(), flat: self.flat };
        let mut search = Search { joint: &turned, best: search.best.map(|best| best.map(swapped)), ..search };
        let backward = search.run();
        forward.with(backward, |place| {
            let [r, s] = place.parameters;
            self.place([s, r])
        })
    }

    fn pair(&self) -> Pair<'_, '_> {
        Pair { a: &self.first, b: &self.second }
    }

    fn place(&self, parameters: [f64; 2]) -> Place {
        let [s, r] = parameters;
        let (a, b) = (self.first.at(s), self.second.at(r));
        let share = self.first.length_to(s) / self.first.length();
        Place { parameters, share, position: a.position, uv: [a.uv, b.uv] }
    }
}

impl Certificate {
    /// Both together; `turned` gives a place of the other as one of this.
    fn with(mut self, other: Self, turned: impl Fn(&Place) -> Place) -> Self {
        for (own, other) in self.findings.iter_mut().zip(&other.findings) {
            if own.seen < other.seen {
                (own.seen, own.at) = (other.seen, turned(&other.at));
            }
            own.bound = own.bound.max(other.bound);
        }
        for place in other.degenerate {
            let place = Degenerate { at: turned(&place.at), ..place };
            if self.degenerate.iter().all(|known| !known.is_same(&place)) {
                self.degenerate.push(place);
            }
        }
        self.is_perpendicular &= other.is_perpendicular;
        self.stretches += other.stretches;
        self
    }
}

impl Degenerate {
    fn is_same(&self, other: &Self) -> bool {
        self.criterion == other.criterion && (self.at.share - other.at.share).abs() <= ONE_PLACE
    }
}

/// What was seen of a criterion: the value, and s and r.
type Seen = Option<(f64, [f64; 2])>;

struct Search<'a, 'm> {
    joint: &'a Joint<'m>,
    aims: [Aim; 3],
    best: [Seen; Criterion::COUNT],
    stretches: usize,
}

impl Search<'_, '_> {
    fn run(&mut self) -> Certificate {
        let before = self.stretches;
        let pair = self.joint.pair();
        let mut heap = BinaryHeap::new();
        for stretch in pair.stretches() {
            heap.push(self.evaluated(stretch, None));
        }
        let mut bounds = [0.0; Criterion::COUNT];
        let mut degenerate = vec![];
        let mut is_perpendicular = true;
        while let Some(open) = heap.pop() {
            let is_unbounded = open.measured.iter().any(|peak| peak.upper == f64::INFINITY);
            let is_short = open.halvings >= if is_unbounded { DEGENERATE } else { HALVINGS };
            let is_done = is_short || STALLS <= open.stalls || MOST_STRETCHES <= self.stretches - before;
            if 1.0 < self.urgency(&open.measured).0 && !is_done {
                for half in pair.halves(&open.stretch) {
                    heap.push(self.evaluated(half, Some(&open)));
                }
                continue;
            }
            is_perpendicular &= open.is_foot;
            let is_without =
                |criterion: Criterion| is_short && open.measured[criterion as usize].upper == f64::INFINITY;
            let without = [Criterion::Angle, Criterion::Curvature].into_iter().find(|criterion| is_without(*criterion));
            degenerate.extend(without.map(|criterion| self.degenerate(&open.stretch, criterion)));
            for (k, peak) in open.measured.iter().enumerate() {
                // The gap has a bound everywhere, or the edge is undecided.
                if without.is_none() || k == Criterion::Gap as usize || peak.upper < f64::INFINITY {
                    bounds[k] = f64::max(bounds[k], peak.upper);
                }
            }
        }
        let findings = std::array::from_fn(|k| self.finding(k, bounds[k]));
        let (length, stretches) = (self.joint.first.length(), self.stretches - before);
        Certificate { findings, degenerate: joined(degenerate), is_perpendicular, length, stretches }
    }

    fn evaluated(&mut self, stretch: Stretch, parent: Option<&Open>) -> Open {
        self.stretches += 1;
        let (mut values, mut is_foot, mut is_narrow) = ([UNKNOWN; Criterion::COUNT], false, false);
        if let Some(tube) = self.joint.pair().tube(&stretch) {
            let is_opposite = self.joint.first.is_left != self.joint.second.is_left;
            values = measured(&tube, is_opposite, self.joint.flat);
            is_foot = tube.is_foot;
            is_narrow = is_foot && tube.r.radius() <= NARROW * (stretch.r[1] - stretch.r[0]);
            for (best, peak) in self.best.iter_mut().zip(&values) {
                if best.is_none_or(|(seen, _)| seen < peak.lower) && peak.lower.is_finite() {
                    let clamped = |f: Taylor, [low, high]: [f64; 2]| f.value(peak.at).0.clamp(low, high);
                    *best = Some((peak.lower, [clamped(tube.s, stretch.s), clamped(tube.r, stretch.r)]));
                }
            }
        }
        let (urgency, width) = self.urgency(&values);
        let halvings = parent.map_or(0, |parent| parent.halvings + 1);
        let is_stalled = |parent: &Open| is_narrow && width.is_finite() && STALLED * parent.width < width;
        let stalls = parent.map_or(0, |parent| if is_stalled(parent) { parent.stalls + 1 } else { 0 });
        Open { stretch, halvings, stalls, measured: values, is_foot, urgency, width }
    }

    /// How much is left to do on a stretch, and how far the bound is above what was seen there by the criterion that says so.
    fn urgency(&self, measured: &Measured) -> (f64, f64) {
        let of = |aim: &Aim| {
            let peak = measured[aim.criterion as usize];
            let seen = self.best[aim.criterion as usize].map_or(0.0, |(seen, _)| seen.max(0.0));
            (aim.urgency(peak.upper, seen), peak.upper - peak.lower.max(0.0))
        };
        let most = |a: (f64, f64), b: (f64, f64)| if a.0 < b.0 { b } else { a };
        self.aims.iter().map(of).fold((0.0, 0.0), most)
    }

    fn degenerate(&self, stretch: &Stretch, criterion: Criterion) -> Degenerate {
        let [s, r] = [stretch.s, stretch.r].map(|[from, to]| 0.5 * (from + to));
        let [from, to] = stretch.s.map(|s| self.joint.first.length_to(s));
        Degenerate { at: self.joint.place([s, r]), length: to - from, criterion }
    }

    fn finding(&self, k: usize, bound: f64) -> Finding {
        let Joint { first, second, .. } = self.joint;
        let nothing = (0.0, [0.5 * first.end(), 0.5 * second.end()]);
        let (mut seen, at) = self.best[k].unwrap_or(nothing);
        if k == Criterion::Gap as usize {
            // Of a pair it is only known how far its two points are apart; the other border may be nearer elsewhere.
            seen = distance_at_least(first, at[0], second).max(distance_at_least(second, at[1], first)).min(seen);
        }
        let bound = if k == Criterion::Curvature as usize { bound.min(MOST_RELATIVE) } else { bound };
        Finding { bound, seen: seen.max(0.0), at: self.joint.place(at) }
    }
}

/// Places that follow each other are one.
fn joined(mut places: Vec<Degenerate>) -> Vec<Degenerate> {
    places.sort_by(|a, b| (a.criterion as usize).cmp(&(b.criterion as usize)).then(a.at.share.total_cmp(&b.at.share)));
    let mut joined: Vec<Degenerate> = vec![];
    for place in places {
        match joined.last_mut() {
            Some(last) if last.is_same(&place) => last.length += place.length,
            _ => joined.push(place),
        }
    }
    joined
}
