//! How far two Bézier patches over one rectangle are apart at equal parameters: a bound that is proven, and near what
//! is attained.

use super::fit::raised_to;
use crate::{BezierPatch, Hull, power_of_two};
use glam::DVec3;

/// The search ends where the bound is within this factor of a distance that is attained.
const SHARP: f64 = 1.25;

/// Pieces that are halved before the bound is taken as it is.
const SPLITS: usize = 256;

/// Halvings of one piece, which carry its rounding.
const HALVINGS: u32 = 24;

/// Rounding of the bound's numerator, in units of the greatest weight times the greatest length |P| over √3.
///
/// 24 halvings before and 24 here, of 15 steps of half an ulp each, and 24 raisings of 2 ulp come to 816 half ulp,
/// 1e-13, for a control point of S; for S̃, which is halved here only, to 6e-14. Their sum, 1.6e-13, counts once in d,
/// once in m d_w, and twice in (S − m) d_w, as |S − m| is at most twice the greatest |P|.
const ROUNDING: f64 = 1.2e-12;

/// What rounding adds to the numerator of the bound of any part of this patch, at most; model units times weight.
pub(super) fn noise(of: &BezierPatch) -> f64 {
    let size = of.control.iter().map(|c| (c.truncate() / c.w).abs().max_element()).fold(0.0, f64::max);
    ROUNDING * size * of.control.iter().map(|c| c.w).fold(0.0, f64::max)
}

/// An upper bound of |S̃(u, v) − S(u, v)| over the rectangle, in model units, with rounding counted: `noise` is that of the
/// original patch ([`noise`]).
///
/// Both patches are brought to a common degree. With d the difference of their homogeneous control points and d_w its
/// weight part, S̃ − S = (d − S d_w) / w̃, and for any point m this is (d − m d_w − (S − m) d_w) / w̃. By the convex
/// hull property it is at most (max |d − m d_w| + max |P − m| max |d_w|) / min w̃ over the control points, with m the
/// middle of the box of the control points P of S. The piece with the greatest such bound is halved until its bound is
/// within [`SHARP`] of the greatest distance at a corner of a piece, or [`SPLITS`] are spent; or until a corner is off
/// by more than `tolerance`: then the bound is not sharp, but true. Weights are sums of positive numbers: they keep 12
/// digits.
pub(super) fn bound(of: &BezierPatch, stand_in: &BezierPatch, noise: f64, tolerance: f64) -> f64 {
    let degree = [0, 1].map(|k| of.degree[k].max(stand_in.degree[k]));
    // Squares of what is above rounding stay in range.
    let unit = power_of_two(of.control.iter().map(|c| (c.truncate() / c.w).abs().max_element()).fold(0.0, f64::max));
    let scaled = |patch: &BezierPatch| {
        let mut patch = BezierPatch { domain: [[0.0, 1.0]; 2], ..raised_to(patch, degree) };
        patch.control.iter_mut().for_each(|c| *c = (c.truncate() * unit.recip()).extend(c.w));
        patch
    };
    let noise = noise.max(self::noise(stand_in)) * unit.recip();
    let whole = Piece::new(scaled(of), scaled(stand_in), noise, HALVINGS);
    let mut attained = whole.attained();
    let mut pieces = vec![whole];
    let mut greatest = 0;
    for _ in 0..SPLITS {
        let piece = &pieces[greatest];
        let enough = piece.bound <= (SHARP * attained).max(2.0 * piece.rounding);
        if enough || tolerance < attained * unit || piece.halvings == 0 {
            break;
        }
        for half in pieces.swap_remove(greatest).halves(noise) {
            attained = attained.max(half.attained());
            pieces.push(half);
        }
        let bound = |k: usize| pieces[k].bound;
        greatest = (1..pieces.len()).fold(0, |best, k| if bound(best) < bound(k) { k } else { best });
    }
    pieces[greatest].bound * unit
}

/// Both patches over a rectangle, in a common degree.
struct Piece {
    of: BezierPatch,
    stand_in: BezierPatch,
    halvings: u32,
    /// Of their distance here.
    bound: f64,
    /// What of it is rounding.
    rounding: f64,
}

impl Piece {
    fn new(of: BezierPatch, stand_in: BezierPatch, noise: f64, halvings: u32) -> Self {
        let middle = Hull::of(of.control.iter().map(|c| c.truncate() / c.w)).center();
        let (mut offset, mut weight, mut reach, mut lightest) = (0.0f64, 0.0f64, 0.0f64, f64::INFINITY);
        for (a, b) in of.control.iter().zip(&stand_in.control) {
            let d = *b - *a;
            offset = offset.max((d.truncate() - middle * d.w).length_squared());
            weight = weight.max(d.w.abs());
            reach = reach.max((a.truncate() / a.w).distance_squared(middle));
            lightest = lightest.min(b.w);
        }
        let rounding = noise / lightest;
        let bound = (offset.sqrt() + reach.sqrt() * weight) / lightest + rounding;
        Self { of, stand_in, halvings, bound, rounding }
    }

    /// The greatest distance at a corner.
    fn attained(&self) -> f64 {
        let [p, q] = self.of.degree;
        let point = |patch: &BezierPatch, i: usize| -> DVec3 { patch.control[i].truncate() / patch.control[i].w };
        let at = |i: usize| point(&self.of, i).distance(point(&self.stand_in, i));
        [0, q, p * (q + 1), (p + 1) * (q + 1) - 1].into_iter().map(at).fold(0.0, f64::max)
    }

    /// Both halves, across the longer side of the rectangle.
    fn halves(self, noise: f64) -> [Self; 2] {
        let [u, v] = self.of.domain.map(|[start, end]| (end - start, 0.5 * (start + end)));
        let split = |patch: &BezierPatch| if v.0 <= u.0 { patch.split_u(u.1) } else { patch.split_v(v.1) };
        let ([a, b], [c, d]) = (split(&self.of), split(&self.stand_in));
        [Self::new(a, c, noise, self.halvings - 1), Self::new(b, d, noise, self.halvings - 1)]
    }
}
