//! Triangle setup: snapped corners and edge functions for coverage, weights for interpolation.
//!
//! Coverage is integer: corners are snapped to 1/256 pixel, edge functions are products in i64. Interpolation is f32 from
//! the *unsnapped* corners, as Mesa's rasterizer does, so that an attribute is not displaced by what snapping moves.
//!
//! Weights are the areas of the three triangles that a sample makes with the corners, each from differences of f32
//! positions whose products are taken exactly (two f32 multiply exactly in f64), subtracted, and rounded to f32 once.
//! A plane equation per attribute, as hardware has it, loses all digits on slivers, of which proxies have many at
//! silhouettes; here the point that the weights describe stays within about 2⁻²² of the triangle's size of the sample,
//! whatever its shape. Snapping can cover a sample that is outside the unsnapped triangle, by at most √2 / 512 pixel.
//! There the triangle's plane is followed beyond its edge, but by no more than [`BEYOND`] of the triangle: from a sliver,
//! extrapolation has no bound. Where it would go farther, the weights are those of the snapped triangle; they describe a
//! point of the triangle that lies within √2 / 512 pixel of the sample.

use crate::rect::Rect;
use crate::vertex::Corner;

/// Fractional bits of a snapped position.
pub const SUBPIXEL_BITS: u32 = 8;

/// Snapped units a pixel.
pub const SUBPIXEL_ONE: i32 = 1 << SUBPIXEL_BITS;

/// How far beyond an edge a triangle is extrapolated, as a share of its height over that edge.
///
/// On one edge a flat triangle and the surface agree as well as anywhere; beyond it by ε they part by at most 4 ε of the
/// chord bound more (an interpolation error M x (x − h) / 2 at x = −ε h, against M h² / 8). Triangles higher than
/// 64 √2 / 512 = 0.18 pixel never need more.
pub const BEYOND: f32 = 1.0 / 64.0;

/// Added to a small f64, it leaves the nearest whole number (halves to even) in the last bits of the sum.
const ROUND_TO_WHOLE: f64 = 1.5 * (1u64 << 52) as f64;

/// A position snapped to 1/256 pixel: to nearest, halves to even.
///
/// Positions inside the guard band are below 5 × 2^13 pixels, hence below 2^24 units: far below the 2^31 that the trick
/// bears, and a difference of snapped positions fits 25 bits, a product of two 50.
#[inline]
fn snap(position: f32) -> i32 {
    (f64::from(position * SUBPIXEL_ONE as f32) + ROUND_TO_WHOLE).to_bits() as i32
}

/// The pixels whose centres lie in the box of snapped corners.
#[inline]
fn bounds([a, b, c]: [[i32; 2]; 3]) -> Rect {
    // The centre of pixel k is at 256 k + 128: the first k at or above the box's start, one past the last at or below
    // its end.
    let half = SUBPIXEL_ONE / 2;
    let first = |axis: usize| (a[axis].min(b[axis]).min(c[axis]) - half + SUBPIXEL_ONE - 1) >> SUBPIXEL_BITS;
    let end = |axis: usize| ((a[axis].max(b[axis]).max(c[axis]) - half) >> SUBPIXEL_BITS) + 1;
    Rect { left: first(0), top: first(1), right: end(0), bottom: end(1) }
}

/// Twice the signed area of snapped corners.
#[inline]
fn area([a, b, c]: [[i32; 2]; 3]) -> i64 {
    let difference = |to: i32, from: i32| i64::from(to - from);
    difference(b[0], a[0]) * difference(c[1], a[1]) - difference(b[1], a[1]) * difference(c[0], a[0])
}

#[inline]
fn snap_corners([a, b, c]: &[Corner; 3]) -> [[i32; 2]; 3] {
    let one = |corner: &Corner| [snap(corner.position[0]), snap(corner.position[1])];
    [one(a), one(b), one(c)]
}

/// The pixels that a triangle may cover; none where it covers nothing.
#[inline]
pub fn covered_bounds(corners: &[Corner; 3]) -> Option<Rect> {
    let snapped = snap_corners(corners);
    let rect = bounds(snapped);
    (!rect.is_empty() && area(snapped) != 0).then_some(rect)
}

/// a × b, in f64: the products are exact.
#[inline]
fn cross(a: [f32; 2], b: [f32; 2]) -> f32 {
    let product = |x: f32, y: f32| f64::from(x) * f64::from(y);
    (product(a[0], b[1]) - product(a[1], b[0])) as f32
}

/// A triangle of some area, ready to be sampled. Either winding is drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Triangle {
    corners: [Corner; 3],
    snapped: [[i32; 2]; 3],
    /// Whether the corners run counterclockwise in the picture (y down): then signs and edges are turned round.
    counterclockwise: bool,
    /// 1 / w relative to the greatest of the three, so that no product with a weight underflows.
    share: [f32; 3],
    slope: Slope,
}

/// How depth grows with the values of the edges opposite to the second and the third corner.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Slope {
    /// The power of two that takes twice the area to 1 … 2, so that nothing below underflows.
    scale: f32,
    /// What depth gains over the whole of either edge's value, by the scaled area.
    gain: [f32; 2],
}

impl Slope {
    #[inline]
    fn new([a, b, c]: [f32; 3], area: u64) -> Self {
        let area = area as f32;
        // Biased exponents e and 254 − e belong to powers of two whose product is 1.
        let scale = f32::from_bits((254 - (area.to_bits() >> 23)) << 23);
        let area = area * scale;
        Self { scale, gain: [(b - a) / area, (c - a) / area] }
    }
}

/// An edge function: its value at a pixel's centre is positive inside; it grows by `step` from pixel to pixel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Edge {
    from: [i32; 2],
    delta: [i64; 2],
}

impl Edge {
    /// Twice the area, in square snapped units, that the edge spans with the centre of pixel (x, y).
    #[inline]
    pub fn at(&self, x: i32, y: i32) -> i64 {
        let center = |pixel: i32| i64::from(pixel) * i64::from(SUBPIXEL_ONE) + i64::from(SUBPIXEL_ONE / 2);
        self.delta[0] * (center(y) - i64::from(self.from[1])) - self.delta[1] * (center(x) - i64::from(self.from[0]))
    }

    /// Increments of the value from one pixel to the next in x and in y.
    #[inline]
    pub fn step(&self) -> [i64; 2] {
        [-self.delta[1] * i64::from(SUBPIXEL_ONE), self.delta[0] * i64::from(SUBPIXEL_ONE)]
    }

    /// The least value that counts as covered: 0 on a top or a left edge, else 1.
    ///
    /// A left edge runs upward (y is down), a top edge is level and runs right. Of two triangles that share an edge,
    /// one has it in each direction, so exactly one of them owns it.
    #[inline]
    pub fn least(&self) -> i64 {
        let [dx, dy] = self.delta;
        if dy < 0 || (dy == 0 && dx > 0) { 0 } else { 1 }
    }
}

impl Triangle {
    /// Sets a triangle up for samples that lie `shift` pixels off the pixels' centres. `None` where snapping leaves no
    /// area: such a triangle covers nothing.
    #[inline]
    pub fn new(mut corners: [Corner; 3], shift: [f32; 2]) -> Option<Self> {
        for corner in &mut corners {
            corner.position = [corner.position[0] - shift[0], corner.position[1] - shift[1]];
        }
        let snapped = snap_corners(&corners);
        let area = area(snapped);
        if area == 0 {
            return None;
        }
        let greatest = corners.iter().fold(0.0, |m: f32, c| m.max(c.inverse_w));
        let share = corners.map(|c| c.inverse_w / greatest);
        let slope = Slope::new(corners.map(|c| c.depth), area.unsigned_abs());
        Some(Self { corners, snapped, counterclockwise: area < 0, share, slope })
    }

    /// The edges opposite to corners 0, 1 and 2, each with the triangle on its positive side.
    #[inline]
    pub fn edges(&self) -> [Edge; 3] {
        std::array::from_fn(|i| {
            let (mut from, mut to) = (self.snapped[(i + 1) % 3], self.snapped[(i + 2) % 3]);
            if self.counterclockwise {
                std::mem::swap(&mut from, &mut to);
            }
            Edge { from, delta: [i64::from(to[0] - from[0]), i64::from(to[1] - from[1])] }
        })
    }

    /// Whether the snapped corners run counterclockwise in the picture.
    #[inline]
    pub fn is_counterclockwise(&self) -> bool {
        self.counterclockwise
    }

    /// The pixels whose centres lie in the snapped triangle's box.
    #[inline]
    pub fn bounds(&self) -> Rect {
        bounds(self.snapped)
    }

    /// Areas that the sample of a covered pixel makes with the corners; see the module. Their sum is positive, none is
    /// more negative than [`BEYOND`] allows.
    #[inline]
    pub fn weights(&self, x: i32, y: i32) -> [f32; 3] {
        let sample = [x as f32 + 0.5, y as f32 + 0.5];
        let from_sample = |i: usize| {
            let [x, y] = self.corners[i].position;
            [x - sample[0], y - sample[1]]
        };
        let [a, b, c] = [from_sample(0), from_sample(1), from_sample(2)];
        let mut weights = [cross(b, c), cross(c, a), cross(a, b)];
        if self.counterclockwise {
            weights = [-weights[0], -weights[1], -weights[2]];
        }
        let [p, q, r] = [weights[0] * self.share[0], weights[1] * self.share[1], weights[2] * self.share[2]];
        let sum = p + q + r;
        let least = sum * -BEYOND;
        if sum > 0.0 && p >= least && q >= least && r >= least {
            weights
        } else {
            self.edges().map(|edge| edge.at(x, y) as f32)
        }
    }

    /// z / w at the centre of a pixel that it covers, by the snapped triangle; never beyond the corners' own. This decides who is
    /// seen: it is exact but for five roundings, whatever the triangle's shape, and kernels in `shaders/raster` have the same bits.
    #[inline]
    pub fn depth(&self, x: i32, y: i32) -> f32 {
        let edges = self.edges();
        let [p, q] = [1, 2].map(|i| edges[i].at(x, y) as f32 * self.slope.scale);
        let [a, b, c] = self.corners.map(|c| c.depth);
        let depth = a + (p * self.slope.gain[0] + q * self.slope.gain[1]);
        depth.clamp(a.min(b).min(c), self.nearest())
    }

    /// z / w by weights, linear in the picture: where the unsnapped triangle meets the pixel's ray. Never beyond the corners' own.
    #[inline]
    pub fn carried_depth(&self, weights: [f32; 3]) -> f32 {
        let [a, b, c] = self.corners.map(|c| c.depth);
        let [depth] = combine(weights, [[a], [b], [c]]);
        depth.clamp(a.min(b).min(c), self.nearest())
    }

    /// The greatest z / w of the corners.
    #[inline]
    pub fn nearest(&self) -> f32 {
        let [a, b, c] = self.corners.map(|c| c.depth);
        a.max(b).max(c)
    }

    /// An attribute of the corners by weights, linear on the triangle in space (perspective-correct).
    #[inline]
    pub fn interpolate<const N: usize>(&self, weights: [f32; 3], attribute: [[f32; N]; 3]) -> [f32; N] {
        combine(std::array::from_fn(|i| weights[i] * self.share[i]), attribute)
    }
}

/// The weighted mean, from the first value on: equal values give that value exactly.
#[inline]
fn combine<const N: usize>(q: [f32; 3], [a, b, c]: [[f32; N]; 3]) -> [f32; N] {
    let sum = q[0] + q[1] + q[2];
    std::array::from_fn(|i| a[i] + (q[1] * (b[i] - a[i]) + q[2] * (c[i] - a[i])) / sum)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn snapping_rounds_to_nearest_and_halves_to_even() {
        for (x, units) in [(0.0, 0), (1.0, 256), (-1.0, -256), (0.5 / 256.0, 0), (1.5 / 256.0, 2), (2.5 / 256.0, 2)] {
            assert_eq!(snap(x), units, "{x}");
        }
        for (x, units) in [(-0.5 / 256.0, 0), (-1.5 / 256.0, -2), (0.51 / 256.0, 1), (-0.51 / 256.0, -1)] {
            assert_eq!(snap(x), units, "{x}");
        }
        for i in 0..200_000u32 {
            let x = (i.wrapping_mul(2_654_435_761) as i32) as f32 / 65536.0;
            assert_eq!(f64::from(snap(x)), (f64::from(x) * 256.0).round_ties_even(), "{x}");
        }
    }

    #[test]
    fn weights_of_a_sliver_describe_the_sample() {
        // 200 pixels long, 1/300 pixel wide, across the centre of pixel (100, 50).
        let corner = |x, y| Corner { position: [x, y], depth: 0.5, inverse_w: 1.0 };
        let corners = [corner(0.3, 0.4), corner(200.7, 100.6), corner(100.5, 50.4967)];
        let triangle = Triangle::new(corners, [0.0; 2]).unwrap();
        let w = triangle.weights(100, 50);
        let sum = w.iter().map(|&w| f64::from(w)).sum::<f64>();
        for (axis, center) in [(0, 100.5), (1, 50.5)] {
            let at = (0..3).map(|i| f64::from(w[i]) * f64::from(corners[i].position[axis])).sum::<f64>() / sum;
            // 2⁻²² of 200 pixels.
            assert!((at - center).abs() < 5e-5, "{at} for {center}");
        }
    }

    #[test]
    fn a_sample_that_only_snapping_covers_is_not_extrapolated() {
        let corner = |x, y| Corner { position: [x, y], depth: 0.5, inverse_w: 1.0 };
        // A sliver that ends below the row of centres at y = 0.5 and is snapped across it.
        let y = 0.5 + 0.4 / 256.0;
        let triangle =
            Triangle::new([corner(0.0, y), corner(100.0, y), corner(50.0, y + 0.2 / 256.0)], [0.0; 2]).unwrap();
        let edges = triangle.edges();
        let covered = (0..100).filter(|&x| edges.iter().all(|e| e.at(x, 0) >= e.least()));
        let mut count = 0;
        for x in covered {
            count += 1;
            let [at] = triangle.interpolate(triangle.weights(x, 0), [[0.0], [100.0], [50.0]]);
            assert!((at - (x as f32 + 0.5)).abs() < 0.01, "{at} for {x}");
        }
        assert!(count > 90, "{count}");
    }
}
