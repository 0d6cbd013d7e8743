//! Bicubic patches that stand for a Bézier patch of any degrees within a bound that is proven, halved until it is met.
//!
//! From the patches of a surface ([`crate::Surface::bezier_patches`]) to renderers that know bicubic patches alone.

mod distance;
mod fit;
mod line;
mod whole;

pub use whole::BicubicSurface;

use crate::surface::usable;
use crate::{BezierPatch, Direction, MAX_DEGREE, NurbsError};
use glam::DVec4;

/// Halvings of one part, both directions together. `distance` counts their rounding.
const HALVINGS: u32 = 24;

/// The most parts of one patch: 32 MB of control points, and some seconds.
const MOST_PARTS: usize = 1 << 16;

/// A bicubic patch, what it stands for, and how far it is from that.
#[derive(Debug, Clone, PartialEq)]
pub struct Bicubic {
    /// The patch, of degrees 3 and 3, over the part's rectangle of the parent's knot domain.
    pub patch: BezierPatch,
    /// The same rectangle in shares of the original patch's own, \[\[u0, u1\], \[v0, v1\]\]: each is k / 2ⁿ exactly,
    /// from 0 to 1.
    pub shares: [[f64; 2]; 2],
    /// The greatest distance, at equal parameters, from the original, at most; model units. The rounding of control
    /// points is counted, that of an evaluator is not.
    pub error: f64,
}

impl BezierPatch {
    /// The bicubic patch that stands for this one (Geiger 2015, Sec. 3.2.1, after Guthe 2005); `None` where one of its
    /// weights would not be positive, so that only parts have one.
    ///
    /// A bicubic patch is returned as it is, with error 0; lower degrees are raised. A line of control points P₀ … P_p
    /// of a higher degree becomes Q₀ = P₀, Q₁ = P₀ + λ₀ p/3 (P₁ − P₀), and from the other end alike with λ₁; both
    /// factors are those for which the integral of the squared difference is least, and at least 1/4, so that no
    /// tangent turns round. All is done to homogeneous points. So corners are kept to the bit, and so are, but for
    /// rounding, the directions of both tangents there, where the lines' own are not zero, hence the normal. How the
    /// factors are found is ours: the formulas are missing from the source as we have it.
    ///
    /// The error holds for rational patches too (derived in `approximation/distance.rs`). Over 10,000 random patches of
    /// degrees 4 to 9, a quarter of them with weights from 0.5 to 2, it was at most 1.27 times the greatest distance
    /// found on a grid of 17 × 17 and uphill from there; with weights from 1 to 1,000 at most 2.8 times. Where it is
    /// mostly rounding it is about 2e-12 of the largest coordinate from `origin`, times the greatest ratio of two
    /// weights.
    ///
    /// # Errors
    /// [`NurbsError::Degree`], [`NurbsError::PointCount`], [`NurbsError::Weight`], [`NurbsError::PointNotFinite`] for
    /// fields that no patch of a surface has.
    pub fn bicubic(&self) -> Result<Option<Bicubic>, NurbsError> {
        self.check()?;
        Ok(self.unit().stand_in(self, distance::noise(self), f64::INFINITY))
    }

    /// Bicubic patches that tile this one, each within `tolerance` of it (model units, at equal parameters): this one's
    /// ([`Self::bicubic`]), or those of its halves, halved until the error of each is within the tolerance (Guthe
    /// 2005's binary hierarchy, its leaves in order, the lower half first).
    ///
    /// Halved is the direction in which fourth derivatives are greater: the error of a cubic goes with them. To halve
    /// whichever way leaves the smaller error takes 1 to 2 % fewer parts and three times as long. The error falls
    /// sixteenfold where both directions have been halved, about.
    ///
    /// A border of a part depends on that border's control points alone, and its own mirror image has the mirrored
    /// result, all to the bit. So two patches of one surface, or two parts, that share a border and are cut there alike
    /// have the same border curve. Where one side is halved and the other is not, each is within its error of the same
    /// curve of the surface at equal parameters, so that the gap is at most the sum of both errors; the ends of the
    /// halves lie on the surface. Normals are those of the surface at corners, and elsewhere on a border may differ
    /// between its sides: no bound.
    ///
    /// # Errors
    /// Those of [`Self::bicubic`]; [`NurbsError::BicubicTolerance`] where 24 halvings or 65,536 parts do not reach the
    /// tolerance, as when it is below rounding, negative or NaN.
    pub fn bicubics(&self, tolerance: f64) -> Result<Vec<Bicubic>, NurbsError> {
        self.check()?;
        let noise = distance::noise(self);
        let mut parts = vec![];
        let mut left = vec![(self.unit(), HALVINGS)];
        while let Some((piece, halvings)) = left.pop() {
            let found = piece.stand_in(self, noise, tolerance);
            let reached = found.as_ref().map_or(f64::INFINITY, |part| part.error);
            if let Some(part) = found.filter(|part| part.error <= tolerance) {
                parts.push(part);
                continue;
            }
            if halvings == 0 || MOST_PARTS < parts.len() + left.len() + 2 {
                return Err(NurbsError::BicubicTolerance { tolerance, reached, parts: parts.len() });
            }
            let [u, v] = piece.domain.map(|[start, end]| 0.5 * (start + end));
            let [low, high] = match piece.rougher() {
                Direction::U => piece.split_u(u),
                Direction::V => piece.split_v(v),
            };
            left.extend([(high, halvings - 1), (low, halvings - 1)]);
        }
        Ok(parts)
    }

    /// The same patch over the unit square, where halves are at ½ exactly.
    fn unit(&self) -> Self {
        Self { domain: [[0.0, 1.0]; 2], ..self.clone() }
    }

    /// What stands for this part of `whole`, whose domain here is its shares.
    fn stand_in(&self, whole: &Self, noise: f64, tolerance: f64) -> Option<Bicubic> {
        let (fitted, error) = if self.degree == [3, 3] {
            (self.clone(), 0.0)
        } else {
            let fitted = fit::bicubic(self)?;
            let error = distance::bound(self, &fitted, noise, tolerance);
            (fitted, error)
        };
        let shares = self.domain;
        let domain = [0, 1].map(|k| {
            let [start, end] = whole.domain[k];
            shares[k].map(|share| start * (1.0 - share) + end * share)
        });
        Some(Bicubic { patch: Self { domain, ..fitted }, shares, error })
    }

    /// The direction of the greater fourth derivatives by the patch's own parameters: Hermite's cubic is off by 1/384
    /// of them at most.
    fn rougher(&self) -> Direction {
        let control = line::about_middle(&self.control);
        let [p, q] = self.degree;
        let by_u = (0..=q).map(|j| fourth_derivative(p, |i| control[i * (q + 1) + j])).fold(0.0, f64::max);
        let by_v = (0..=p).map(|i| fourth_derivative(q, |j| control[i * (q + 1) + j])).fold(0.0, f64::max);
        if by_v <= by_u { Direction::U } else { Direction::V }
    }

    fn check(&self) -> Result<(), NurbsError> {
        if let Some(degree) = self.degree.into_iter().find(|degree| !(1..=MAX_DEGREE).contains(degree)) {
            return Err(NurbsError::Degree { degree });
        }
        let expected = (self.degree[0] + 1) * (self.degree[1] + 1);
        if self.control.len() != expected {
            return Err(NurbsError::PointCount { expected, found: self.control.len() });
        }
        for (index, c) in self.control.iter().enumerate() {
            if !(0.0 < c.w && c.w.is_finite()) {
                return Err(NurbsError::Weight { index, value: c.w });
            }
            if let Some(value) = (c.truncate() / c.w).to_array().into_iter().find(|&x| !usable(x)) {
                return Err(NurbsError::PointNotFinite { index, value });
            }
        }
        Ok(())
    }
}

/// The greatest fourth derivative of a line of p + 1 control points, at most.
fn fourth_derivative(p: usize, at: impl Fn(usize) -> DVec4) -> f64 {
    let difference = |i: usize| at(i) + at(i + 4) - 4.0 * (at(i + 1) + at(i + 3)) + 6.0 * at(i + 2);
    let greatest = (0..(p + 1).saturating_sub(4)).map(|i| difference(i).length()).fold(0.0, f64::max);
    (p.saturating_sub(3)..=p).product::<usize>() as f64 * greatest
}
