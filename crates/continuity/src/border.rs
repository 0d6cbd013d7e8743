//! A border of a face as a curve: pieces of a curve in (u, v), each on one polynomial of the surface.
//!
//! A [`Border`] is a side of a surface's domain or a trim of a loop, or a part of one. It is cut where its curve has a knot
//! and where it crosses a knot line of the surface, so that on each [`Piece`] all is one polynomial over another. Its parameter
//! runs from 0 to the number of pieces.
//!
//! A curve within [`ON_KNOT`] of a knot line runs along it: then the polynomial on the side of the face's material is taken.
//! Where a curve leaves the domain of a closed surface it goes on across the seam; of an open one, it is held to the border, as
//! [`scene::Region`] does.

use crate::net::{Jet, Net};
use crate::surface::{Patch, Patches};
use crate::taylor::{Taylor, UNIT, Vector};
use glam::{DVec2, DVec3};
use nurbs::{BezierCurve, Direction, Hull, KnotVector, Surface};
use scene::FaceId;
use std::sync::Arc;

/// Curves within this share of a domain's length of a knot line lie on it, as [`scene::Region`] has it for borders.
const ON_KNOT: f64 = 1e-10;

/// Bisections for the place where a curve crosses a knot line: all bits of it.
const BISECTIONS: u32 = 60;

/// Cuts nearer to each other than this share of a segment are one.
const SAME_CUT: f64 = 1e-12;

/// Periods outside the domain in which knot lines are looked for; [`scene::Region`] refuses loops that reach so far.
const PERIODS: i64 = 64;

/// Newton's method ends where a step is this small: a foot that is off by it costs nothing but a wider proof.
const SAME_PLACE: f64 = 1e-14;

/// Chords that measure the length of a piece.
const CHORDS: usize = 8;

/// Where a border comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Origin {
    /// A trim of a loop, both by their indices in the face.
    Trim {
        /// Index of the loop.
        boundary: usize,
        /// Index of the trim in it.
        trim: usize,
    },
    /// A side of the surface's domain, where no trim runs: u = least, u = greatest, v = least, v = greatest.
    Side(usize),
}

/// A part of a border on which curve and surface are one polynomial each.
#[derive(Debug, Clone)]
struct Piece<'m> {
    surface: &'m Surface,
    curve: Arc<BezierCurve>,
    /// The curve in the patch's own parameters.
    net: Arc<Net>,
    patch: Arc<Patch>,
    span: [usize; 2],
    /// What is added to the curve's (u, v): whole periods.
    shift: DVec2,
    /// The border of the domain that u, or v, is held to, where the curve is outside.
    held: [Option<f64>; 2],
    /// The curve's parameters at the ends.
    range: [f64; 2],
}

/// A border of a face, or a part of one.
#[derive(Debug, Clone)]
pub struct Border<'m> {
    /// The face.
    pub face: FaceId,
    /// Where it comes from.
    pub origin: Origin,
    /// Whether the face's material is on its left, seen along S_u × S_v; after [`Self::reversed`] it is on the right.
    pub is_left: bool,
    pieces: Vec<Piece<'m>>,
    /// The points at the chords' ends.
    samples: Vec<DVec3>,
    /// The length up to each chord's end, [`CHORDS`] a piece; measured, not bounded.
    lengths: Vec<f64>,
}

/// A point of a border, in f64.
#[derive(Debug, Clone, Copy)]
pub struct Point {
    /// In space.
    pub position: DVec3,
    /// By the border's parameter.
    pub velocity: DVec3,
    /// In the surface's domain.
    pub uv: DVec2,
}

/// A border at a function instead of a number: what its face is there.
pub struct Along {
    /// What positions count from.
    pub origin: DVec3,
    /// The surface.
    pub surface: Jet,
    /// Of the curve in the patch's parameters.
    pub direction: [Taylor; 2],
    /// Velocity and acceleration in space by the border's parameter.
    pub motion: [Vector; 2],
}

impl<'m> Border<'m> {
    /// The border along curves in (u, v), each beginning where the last ends, material on their left.
    ///
    /// `closed` says whether the surface's two sides across u, and those across v, are one.
    pub fn new(
        face: FaceId,
        origin: Origin,
        curves: &[BezierCurve],
        closed: [bool; 2],
        patches: &mut Patches<'m>,
    ) -> Self {
        let pieces = curves.iter().flat_map(|curve| pieces(curve, closed, patches)).collect();
        let mut border = Self { face, origin, is_left: true, pieces, samples: vec![], lengths: vec![] };
        border.measure();
        border
    }

    fn measure(&mut self) {
        self.samples = (0..=CHORDS * self.count()).map(|i| self.at(i as f64 / CHORDS as f64).position).collect();
        self.lengths = vec![0.0];
        for pair in self.samples.windows(2) {
            self.lengths.push(self.length() + pair[0].distance(pair[1]));
        }
    }

    /// This border and then `next`, of the same face, which begins where this one ends.
    pub fn joined(&self, next: &Self) -> Self {
        let mut border = self.clone();
        border.pieces.extend(next.pieces.iter().cloned());
        border.measure();
        border
    }

    /// First and last point.
    pub fn ends(&self) -> [DVec3; 2] {
        [self.samples[0], self.samples[self.samples.len() - 1]]
    }

    /// A box that holds the border, as far as measured: that of points on it, larger by the longest way between two.
    pub fn hull(&self) -> Hull {
        let longest = self.lengths.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max);
        let hull = Hull::of(self.samples.iter().copied());
        Hull { min: hull.min - longest, max: hull.max + longest }
    }

    /// The parameter of the point nearest to `point`, by Newton's method from the nearest of a few on each piece.
    pub fn nearest(&self, point: DVec3) -> f64 {
        let squared = |i: &usize| self.samples[*i].distance_squared(point);
        let nearest = (0..self.samples.len()).min_by(|a, b| squared(a).total_cmp(&squared(b))).expect("two ends");
        self.foot(point, nearest as f64 / CHORDS as f64)
    }

    /// How many pieces there are: the end of the parameter.
    pub fn count(&self) -> usize {
        self.pieces.len()
    }

    /// The end of the parameter.
    pub fn end(&self) -> f64 {
        self.count() as f64
    }

    /// The length, by chords: measured, not bounded.
    pub fn length(&self) -> f64 {
        self.lengths[self.lengths.len() - 1]
    }

    /// The length up to `t`, by chords.
    pub fn length_to(&self, t: f64) -> f64 {
        let chords = (t * CHORDS as f64).clamp(0.0, (self.lengths.len() - 1) as f64);
        let i = (chords as usize).min(self.lengths.len() - 2);
        self.lengths[i] + (self.lengths[i + 1] - self.lengths[i]) * (chords - i as f64)
    }

    /// The parameter at which the length by chords is `length`.
    pub fn at_length(&self, length: f64) -> f64 {
        let i = self.lengths.partition_point(|l| *l < length).clamp(1, self.lengths.len() - 1);
        let (low, high) = (self.lengths[i - 1], self.lengths[i]);
        let share = if low < high { ((length - low) / (high - low)).clamp(0.0, 1.0) } else { 0.0 };
        (i as f64 - 1.0 + share) / CHORDS as f64
    }

    /// The point at `t`.
    pub fn at(&self, t: f64) -> Point {
        self.at_on(self.index(t), t)
    }

    /// The point at `t` by the polynomials of piece `index`.
    pub fn at_on(&self, index: usize, t: f64) -> Point {
        self.pieces[index].at(t - index as f64)
    }

    /// The piece that `t` is on: at a cut the one after it.
    pub fn index(&self, t: f64) -> usize {
        (t.max(0.0) as usize).min(self.count() - 1)
    }

    /// The border on piece `index`, at the parameter `x`, 0 … 1 there; `None` where it has no bound.
    pub fn along(&self, index: usize, x: Taylor) -> Option<Along> {
        self.pieces[index].along(x)
    }

    /// The same run backwards.
    pub fn reversed(&self) -> Self {
        let pieces = self.pieces.iter().rev().map(|piece| {
            let [start, end] = piece.range;
            Piece { range: [end, start], ..piece.clone() }
        });
        let mut border = Self { is_left: !self.is_left, pieces: pieces.collect(), ..self.clone() };
        let length = self.length();
        border.lengths = self.lengths.iter().rev().map(|l| length - l).collect();
        border.samples.reverse();
        border
    }

    /// The part between two parameters.
    pub fn part(&self, start: f64, end: f64) -> Self {
        let (first, last) = (self.index(start), (end.ceil() as usize).clamp(1, self.count()) - 1);
        let mut pieces = self.pieces[first..=last.max(first)].to_vec();
        let cut = |piece: &Piece, x: f64| piece.range[0] + (piece.range[1] - piece.range[0]) * x;
        let (low, high) = (cut(&pieces[0], start - first as f64), {
            let piece = &pieces[pieces.len() - 1];
            cut(piece, end - last as f64)
        });
        let count = pieces.len();
        pieces[0].range[0] = low;
        pieces[count - 1].range[1] = high;
        let mut border = Self { pieces, ..self.clone() };
        border.measure();
        border
    }

    /// The parameter of the point nearest to `point` as Newton's method finds it from `guess`.
    pub fn foot(&self, point: DVec3, guess: f64) -> f64 {
        newton(point, guess, [0.0, self.end()], |t| self.at(t))
    }

    /// The parameter of this border whose foot on another is `place`, a point of that, by Newton's method from `guess`.
    pub fn with_foot(&self, place: &Point, guess: f64) -> f64 {
        through(place.position, place.velocity, guess, [0.0, self.end()], |t| self.at(t))
    }

    /// As [`Self::with_foot`], on piece `index` and between two parameters of it.
    pub fn with_foot_on(&self, index: usize, place: &Point, guess: f64, range: [f64; 2]) -> f64 {
        through(place.position, place.velocity, guess, range, |t| self.at_on(index, t))
    }

    /// As [`Self::foot`], on piece `index` and between two parameters of it.
    pub fn foot_on(&self, index: usize, point: DVec3, guess: f64, range: [f64; 2]) -> f64 {
        newton(point, guess, range, |t| self.at_on(index, t))
    }
}

/// The parameter at which a curve goes through the plane through `point` at right angles to `normal`, by Newton's method from
/// `guess`, within `low` … `high`.
fn through(point: DVec3, normal: DVec3, guess: f64, [low, high]: [f64; 2], at: impl Fn(f64) -> Point) -> f64 {
    const STEPS: usize = 16;
    let mut t = guess.clamp(low, high);
    for _ in 0..STEPS {
        let here = at(t);
        let step = (point - here.position).dot(normal) / here.velocity.dot(normal);
        let next = (t + step).clamp(low, high);
        if !step.is_finite() || (next - t).abs() <= SAME_PLACE * (1.0 + t.abs()) {
            break;
        }
        t = next;
    }
    t
}

/// Gauss and Newton's method for the foot of the perpendicular, never away from the point; whatever it finds, bounds are
/// proven afterwards.
fn newton(point: DVec3, guess: f64, [low, high]: [f64; 2], at: impl Fn(f64) -> Point) -> f64 {
    const STEPS: usize = 16;
    let mut t = guess.clamp(low, high);
    let mut here = at(t);
    let mut share = 1.0;
    for _ in 0..STEPS {
        let step = share * (point - here.position).dot(here.velocity) / here.velocity.length_squared();
        let next = (t + step).clamp(low, high);
        if !step.is_finite() || (next - t).abs() <= SAME_PLACE * (1.0 + t.abs()) {
            break;
        }
        let there = at(next);
        if there.position.distance_squared(point) <= here.position.distance_squared(point) {
            (t, here, share) = (next, there, 1.0);
        } else {
            share *= 0.25;
        }
    }
    t
}

impl Piece<'_> {
    fn at(&self, x: f64) -> Point {
        let [start, end] = self.range;
        let [uv, velocity] = self.curve.first_derivative(start + (end - start) * x);
        let (mut uv, mut velocity) = (uv + self.shift, velocity * (end - start));
        for axis in [0, 1] {
            if let Some(border) = self.held[axis] {
                (uv[axis], velocity[axis]) = (border, 0.0);
            }
        }
        let d = self.surface.first_derivatives_on(self.span[0], self.span[1], uv.x, uv.y);
        Point { position: d.s, velocity: d.su * velocity.x + d.sv * velocity.y, uv }
    }

    fn along(&self, x: Taylor) -> Option<Along> {
        let [start, end] = self.range;
        // The difference of the ends is rounded, too.
        let t = x.scaled(end - start).widened(UNIT * (end - start).abs() * x.magnitude()).plus(start);
        let curve = self.net.jet(t, Taylor::ZERO)?;
        let scale = end - start;
        let direction = [0, 1].map(|axis| curve.su[axis].scaled(scale));
        let bend = [0, 1].map(|axis| curve.suu[axis].scaled(scale * scale));
        let surface = self.patch.net.jet(curve.s[0], curve.s[1])?;
        Some(Along { origin: self.patch.origin, motion: surface.along(direction, bend), surface, direction })
    }
}

/// The pieces of a Bézier curve in (u, v).
fn pieces<'m>(curve: &BezierCurve, closed: [bool; 2], patches: &mut Patches<'m>) -> Vec<Piece<'m>> {
    let surface = patches.surface;
    let knots = [Direction::U, Direction::V].map(|direction| surface.knots(direction));
    let mut cuts = vec![0.0, 1.0];
    for axis in [0, 1] {
        cuts.extend(crossings(curve, axis, knots[axis], closed[axis]));
    }
    cuts.sort_by(f64::total_cmp);
    cuts.dedup_by(|b, a| *b - *a <= SAME_CUT);
    let last = cuts.len() - 1;
    cuts[last] = 1.0;
    let shared = Arc::new(curve.clone());
    let mut found: Vec<Piece> = vec![];
    for range in cuts.windows(2).map(|pair| [pair[0], pair[1]]) {
        let [uv, tangent] = curve.first_derivative(0.5 * (range[0] + range[1]));
        let inward = DVec2::new(-tangent.y, tangent.x);
        let (mut span, mut shift, mut held) = ([0; 2], DVec2::ZERO, [None; 2]);
        for axis in [0, 1] {
            let (low, high) = knots[axis].domain();
            let length = high - low;
            let step = 2.0 * ON_KNOT * length;
            let lean = if inward[axis].abs() <= ON_KNOT * inward.length() { 0.0 } else { inward[axis].signum() };
            let near = |k: &f64| (uv[axis] - k).abs() <= ON_KNOT * length;
            let is_on = wrapped(knots[axis], closed[axis], [uv[axis] - step, uv[axis] + step]).any(|k| near(&k));
            let mut inside = if is_on { uv[axis] + lean * step } else { uv[axis] };
            if closed[axis] && !(low..=high).contains(&inside) {
                shift[axis] = -((inside - low) / length).floor() * length;
                inside += shift[axis];
            }
            if !is_on && !(low..=high).contains(&inside) {
                held[axis] = Some(inside.clamp(low, high));
            }
            span[axis] = knots[axis].find_span(inside);
        }
        let last = found.last().filter(|last| (last.span, last.shift, last.held) == (span, shift, held));
        let net = match last {
            Some(last) => last.net.clone(),
            None => Arc::new(local(curve, shift, held, knots, span)),
        };
        found.push(Piece { surface, curve: shared.clone(), net, patch: patches.get(span), span, shift, held, range });
    }
    found
}

/// The knots of the domain, repeated a period apart where the surface is closed, within a range.
fn wrapped(knots: &KnotVector, closed: bool, [from, to]: [f64; 2]) -> impl Iterator<Item = f64> + '_ {
    let (low, high) = knots.domain();
    let length = high - low;
    let copy = |t: f64| (((t - low) / length).floor() as i64).clamp(-PERIODS, PERIODS);
    let copies = if closed { copy(from) - 1..=copy(to) } else { 0..=0 };
    let ends = move || knots.spans().map(|k| knots.knots()[k]).chain([high]);
    copies.flat_map(move |copy| ends().map(move |k| k + copy as f64 * length)).filter(move |k| from <= *k && *k <= to)
}

/// Where a curve crosses knot lines of one direction.
fn crossings(curve: &BezierCurve, axis: usize, knots: &KnotVector, closed: bool) -> Vec<f64> {
    let on_knot = ON_KNOT * knots.length();
    let value = |t: f64| curve.point(t)[axis];
    let mut turns = vec![0.0];
    turns.extend(curve.extrema(axis));
    turns.push(1.0);
    let mut found = vec![];
    for pair in turns.windows(2) {
        let [start, end] = [value(pair[0]), value(pair[1])];
        let (low, high) = (start.min(end) + on_knot, start.max(end) - on_knot);
        for knot in wrapped(knots, closed, [low, high]) {
            let [mut below, mut above] = if start < end { [pair[0], pair[1]] } else { [pair[1], pair[0]] };
            for _ in 0..BISECTIONS {
                let middle = 0.5 * (below + above);
                *(if value(middle) < knot { &mut below } else { &mut above }) = middle;
            }
            found.push(0.5 * (below + above));
        }
    }
    found
}

/// The curve in the own parameters of the patch of a span.
fn local(curve: &BezierCurve, shift: DVec2, held: [Option<f64>; 2], knots: [&KnotVector; 2], span: [usize; 2]) -> Net {
    let mut error = [0.0; 4];
    let control = curve.control().iter().map(|c| {
        let mut point = [0.0, 0.0, 0.0, c.z];
        for axis in [0, 1] {
            let (start, length) = knots[axis].span(span[axis]);
            if let Some(border) = held[axis] {
                point[axis] = if border == start { 0.0 } else { c.z };
                continue;
            }
            point[axis] = (c[axis] + (shift[axis] - start) * c.z) / length;
            // The sum, the difference in brackets, the product, the quotient, and the length itself.
            let size = c[axis].abs() + (shift[axis].abs() + start.abs()) * c.z;
            error[axis] = f64::max(error[axis], 6.0 * UNIT * size / length);
        }
        point
    });
    Net::new([curve.degree(), 0], control.collect(), error)
}
