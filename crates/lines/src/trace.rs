//! Zeros of a polynomial on a Bézier patch as chords, each proven to be within the tolerance of its line.
//!
//! The patch is halved until every piece is one of these. It has no zero: all coefficients have one sign. It is smaller in the
//! picture than the tolerance: nothing of it would be seen. Or its zeros are one arc from side to side: one derivative has no zero,
//! and along the two sides that this leaves open the polynomial has a sign or rises or falls. Then the signs at the corners say
//! where the arc enters and leaves. So no closed line is lost: a piece that holds one has zeros of both derivatives, and is halved.
//!
//! The arc's slope dy/dx = −f_x / f_y is between two numbers m and M, and so the arc is within (M − m) |Δx| / 4 of its chord. A step
//! in y is as long as |S_y| says; what the surface leaves of the chord in space is Filip's bound. Both are taken in pixels.

use crate::bernstein::Bernstein;
use crate::equation::Equation;
use crate::frame::Frame;
use glam::DVec2;
use nurbs::{BezierPatch, DerivativeBounds, Hull};

/// Pieces of a patch that are looked at for one line.
const MOST_PIECES: usize = 1 << 17;

/// Steps of the search for a root along a side; a bisection would need 53.
const STEPS: u32 = 64;

/// A straight piece of a line in the surface's parameters, and so a chord of it in space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Chord {
    /// (u, v) of its two ends, in no order.
    pub ends: [DVec2; 2],
}

/// What was found on a patch.
#[derive(Debug, Clone, Default)]
pub struct Traced {
    /// In no order.
    pub chords: Vec<Chord>,
    /// Pieces that were left as they were, since [`MOST_PIECES`] had been looked at.
    pub unfinished: usize,
}

/// A part of the patch, over the unit square.
struct Piece {
    zero: Bernstein,
    positive: Option<Bernstein>,
    patch: BezierPatch,
}

/// What is known of a piece's zeros.
enum Found {
    /// None, or none that are wanted.
    Nothing,
    /// One arc, within so many pixels of its chord.
    Arc(Chord, f64),
    /// Too little.
    Unknown,
}

/// The lines of an equation on a patch; `bounds` are those of the patch.
pub fn trace(equation: &Equation, patch: &BezierPatch, bounds: &DerivativeBounds, frame: &Frame) -> Traced {
    let mut traced = Traced::default();
    let zero = equation.zero.clone().lifted();
    let mut stack = vec![Piece { zero, positive: equation.positive.clone(), patch: patch.clone() }];
    let mut looked_at = 0;
    while let Some(piece) = stack.pop() {
        if has_sign(piece.zero.range()) || piece.positive.as_ref().is_some_and(|f| f.range()[1] < 0.0) {
            continue;
        }
        let hull = piece.patch.hull();
        if frame.excludes(hull) {
            continue;
        }
        let scale = frame.pixels_per_unit(hull);
        let size = hull.diagonal() * scale;
        looked_at += 1;
        match piece.arc(bounds, scale) {
            Found::Nothing => {}
            Found::Arc(chord, off) if off.min(size) <= frame.tolerance => traced.chords.push(chord),
            _ if size <= frame.tolerance => {}
            _ if MOST_PIECES < looked_at => traced.unfinished += 1,
            _ => stack.extend(piece.halves(hull)),
        }
    }
    traced
}

fn has_sign([low, high]: [f64; 2]) -> bool {
    low > 0.0 || high < 0.0
}

impl Piece {
    fn arc(&self, bounds: &DerivativeBounds, scale: f64) -> Found {
        if self.positive.as_ref().is_some_and(|f| f.range()[0] <= 0.0) {
            return Found::Unknown;
        }
        let slopes = [self.zero.derivative(0).range(), self.zero.derivative(1).range()];
        let mut best: Option<(Chord, f64)> = None;
        for y in [1, 0] {
            let x = 1 - y;
            if !has_sign(slopes[y])
                || ![0, 1].iter().all(|side| is_simple(&self.zero.side(y, *side), self.zero.error()))
            {
                continue;
            }
            let ends = self.ends();
            let [a, b] = match ends[..] {
                [] => return Found::Nothing,
                [a, b] => [a, b],
                // Four: rounding, since f rises or falls along y.
                _ => continue,
            };
            let quotients = [0, 1].map(|i| [0, 1].map(|j| -slopes[x][i] / slopes[y][j]));
            let all = quotients.as_flattened();
            let spread = all.iter().fold(f64::NEG_INFINITY, |m: f64, q| m.max(*q))
                - all.iter().fold(f64::INFINITY, |m: f64, q| m.min(*q));
            let size = self.size();
            let off = 0.25 * spread * (b - a)[x].abs() * size[y] * [bounds.u, bounds.v][y];
            let along = (b - a).abs() * size;
            let off = (off + bounds.chord(along.x, along.y)) * scale;
            if !best.as_ref().is_some_and(|(_, least)| *least <= off) {
                let [[u, _], [v, _]] = self.patch.domain;
                best = Some((Chord { ends: [a, b].map(|end| DVec2::new(u, v) + end * size) }, off));
            }
        }
        best.map_or(Found::Unknown, |(chord, off)| Found::Arc(chord, off))
    }

    /// Of the parameters.
    fn size(&self) -> DVec2 {
        let [u, v] = self.patch.domain.map(|[start, end]| end - start);
        DVec2::new(u, v)
    }

    /// Where the zeros cross the sides, one a side at most: it is known that there are no more.
    fn ends(&self) -> Vec<DVec2> {
        let mut ends = vec![];
        for (axis, side) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            if let Some(t) = crossing(&self.zero.side(axis, side)) {
                let mut end = DVec2::splat(t);
                end[axis] = side as f64;
                ends.push(end);
            }
        }
        ends
    }

    /// The halves across the longer way.
    fn halves(self, hull: Hull) -> [Self; 2] {
        let [p, q] = self.patch.degree;
        let point = |i: usize, j: usize| {
            let c = self.patch.control[i * (q + 1) + j];
            c.truncate() / c.w
        };
        let length =
            |n: usize, at: &dyn Fn(usize) -> glam::DVec3| (0..n).map(|i| at(i).distance(at(i + 1))).sum::<f64>();
        let along_u = (0..=q).map(|j| length(p, &|i| point(i, j))).fold(0.0, f64::max);
        let along_v = (0..=p).map(|i| length(q, &|j| point(i, j))).fold(0.0, f64::max);
        // What has no length in space is halved the other way, unless neither has.
        let axis = usize::from(along_u < along_v || hull.diagonal() == 0.0);
        let [start, end] = self.patch.domain[axis];
        let middle = 0.5 * (start + end);
        let [a, b] = if axis == 0 { self.patch.split_u(middle) } else { self.patch.split_v(middle) };
        let [low, high] = self.zero.halves(axis);
        let [first, second] = match &self.positive {
            Some(f) => f.halves(axis).map(Some),
            None => [None, None],
        };
        [Self { zero: low, positive: first, patch: a }, Self { zero: high, positive: second, patch: b }]
    }
}

/// Whether a polynomial of one variable has a sign, or rises or falls all the way.
fn is_simple(coefficients: &[f64], error: f64) -> bool {
    let signed = coefficients.iter().all(|c| *c > error) || coefficients.iter().all(|c| *c < -error);
    let steps = || coefficients.windows(2).map(|pair| pair[1] - pair[0]);
    signed || steps().all(|step| step > 2.0 * error) || steps().all(|step| step < -2.0 * error)
}

/// Where the one root is of a polynomial of one variable that has at most one, if it has it: the method of Illinois.
///
/// Nought counts as positive.
fn crossing(coefficients: &[f64]) -> Option<f64> {
    let (mut low, mut high) = (0.0, 1.0);
    let (mut f_low, mut f_high) = (coefficients[0], coefficients[coefficients.len() - 1]);
    if (f_low >= 0.0) == (f_high >= 0.0) {
        return None;
    }
    let (mut t, mut kept) = (0.0, 0);
    let mut line = coefficients.to_vec();
    for _ in 0..STEPS {
        let last = std::mem::replace(&mut t, ((low * f_high - high * f_low) / (f_high - f_low)).clamp(low, high));
        line.copy_from_slice(coefficients);
        for r in 1..line.len() {
            for i in 0..line.len() - r {
                line[i] = line[i] * (1.0 - t) + line[i + 1] * t;
            }
        }
        let f = line[0];
        if f == 0.0 || (t - last).abs() <= f64::EPSILON {
            break;
        }
        // An end that stays twice counts half, so that the other one comes.
        if (f >= 0.0) == (f_low >= 0.0) {
            (low, f_low) = (t, f);
            f_high *= if kept == 1 { 0.5 } else { 1.0 };
            kept = 1;
        } else {
            (high, f_high) = (t, f);
            f_low *= if kept == 2 { 0.5 } else { 1.0 };
            kept = 2;
        }
    }
    Some(t)
}
