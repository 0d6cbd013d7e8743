//! One line of homogeneous control points as a cubic: raised exactly, or lowered with its ends and their tangents kept.
//!
//! A line read from its other end gives the same cubic from its other end, to the bit: whatever is done at one end is
//! done at the other by the same operations in the same order. So two patches agree about a border, whichever way it
//! runs.

use crate::basis::binomial;
use crate::{Hull, power_of_two};
use glam::DVec4;

/// The least factor of a tangent: a negative one would turn the curve round at its end, zero would leave it a cusp.
///
/// Where a curve is smooth at the scale of its piece the factors are near 1, so that halving ends its use.
const LEAST_FACTOR: f64 = 0.25;

/// ∫ B₁,₃² and ∫ B₁,₃ B₂,₃ over 0 to 1.
const GRAM: [f64; 2] = [3.0 / 35.0, 9.0 / 140.0];

/// The control points of the same curve one degree higher (Piegl & Tiller, Eq. 5.36), to 2 ulp.
///
/// Equal weights stay equal to the bit.
pub(super) fn raised(control: &[DVec4]) -> Vec<DVec4> {
    let order = control.len();
    let inner = (1..order).map(|i| {
        let (a, b) = (control[i - 1], control[i]);
        let mean = (a * i as f64 + b * (order - i) as f64) / order as f64;
        if a.w == b.w { mean.truncate().extend(a.w) } else { mean }
    });
    [control[0]].into_iter().chain(inner).chain([control[order - 1]]).collect()
}

/// ∫ B₁,₃ B_{i,p} over 0 to 1, for i = 0 to p: the product is a multiple of B_{i+1,p+3}, whose integral is 1 / (p + 4).
fn moments(p: usize) -> impl Iterator<Item = f64> {
    (0..=p).map(move |i| 3.0 * binomial(p, i) / (binomial(p + 3, i + 1) * (p + 4) as f64))
}

/// Control points counted from the middle m of their box, (w (P − m), w r) with its half diagonal r, all times one
/// power of two that brings r to 1 or 2: a unit of weight then counts as what it moves at most, and squares stay in
/// range.
pub(super) fn about_middle(control: &[DVec4]) -> Vec<DVec4> {
    let hull = Hull::of(control.iter().map(|c| c.truncate() / c.w));
    let (middle, reach) = (hull.center(), 0.5 * hull.diagonal());
    let unit = power_of_two(reach).recip();
    control.iter().map(|c| ((c.truncate() - middle * c.w) * unit).extend(c.w * (reach * unit))).collect()
}

/// The cubic that stands for a line of control points: itself where its degree p is at most 3.
///
/// Else Q₀ = P₀, Q₁ = P₀ + λ₀ p/3 (P₁ − P₀), and from the other end alike with λ₁ (Geiger 2015, Sec. 3.2.1): at both
/// ends the point, the weight and the direction of the tangent are kept, and λ = 1 keeps its length, too.
pub(super) fn cubic(control: &[DVec4]) -> [DVec4; 4] {
    let mut raising = control.to_vec();
    while raising.len() < 4 {
        raising = raised(&raising);
    }
    let p = raising.len() - 1;
    if p == 3 {
        return std::array::from_fn(|i| raising[i]);
    }
    let [first, last] = tangent_factors(control);
    let third = p as f64 / 3.0;
    let inner = |end: DVec4, next: DVec4, factor: f64| end + (next - end) * (factor * third);
    let (start, end) = (control[0], control[p]);
    [start, inner(start, control[1], first), inner(end, control[p - 1], last), end]
}

/// λ₀ and λ₁ for which ∫ |Q − P|² is least over homogeneous points as [`about_middle`] counts them.
fn tangent_factors(control: &[DVec4]) -> [f64; 2] {
    let forward = about_middle(control);
    let backward: Vec<DVec4> = forward.iter().rev().copied().collect();
    let ends = [End::of(&forward), End::of(&backward)];
    [ends[0].factor(&ends[1]), ends[1].factor(&ends[0])]
}

/// What one end says about the factors.
struct End {
    /// Length of p/3 (P₁ − P₀).
    length: f64,
    /// Its direction, or zero.
    direction: DVec4,
    /// ∫ B₁,₃ (P − Q) for the cubic with both factors zero, along the direction.
    moment: f64,
}

impl End {
    fn of(line: &[DVec4]) -> Self {
        let p = line.len() - 1;
        let tangent = (line[1] - line[0]) * (p as f64 / 3.0);
        let direction = tangent.normalize_or_zero();
        // Counted from P₀, where Q has B₂ and B₃ only.
        let whole: DVec4 = line.iter().zip(moments(p)).map(|(c, m)| (*c - line[0]) * m).sum();
        let far: f64 = moments(3).skip(2).sum();
        Self { length: tangent.length(), direction, moment: direction.dot(whole - (line[p] - line[0]) * far) }
    }

    /// The factor of this end. With x = λ |T|, c the cosine between both directions and g = [`GRAM`], the normal
    /// equations are g₀ x + g₁ c y = m and g₁ c x + g₀ y = n; their determinant is at least 7/16 g₀².
    ///
    /// Where the other end's factor would be below [`LEAST_FACTOR`] it is that, and this one the best beside it, at
    /// least that, too. So the integral is the least that factors allowed have. Where one alone would be below, going
    /// from anywhere toward the free best place lowers the integral until that one is the least. Where both would be,
    /// the integral grows with one factor at least from where both are the least, as its gradient leads away from the
    /// free best place.
    fn factor(&self, other: &Self) -> f64 {
        if self.length == 0.0 {
            return 1.0;
        }
        let [own, cross] = [GRAM[0], GRAM[1] * self.direction.dot(other.direction)];
        let determinant = own * own - cross * cross;
        let beside = (own * other.moment - cross * self.moment) / determinant;
        let least = LEAST_FACTOR * other.length;
        let length = if beside < least {
            (self.moment - cross * least) / own
        } else {
            (own * self.moment - cross * other.moment) / determinant
        };
        (length / self.length).max(LEAST_FACTOR)
    }
}
