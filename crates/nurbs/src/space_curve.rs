//! NURBS curves in space: the profiles that Wildcat trims surfaces with, and the edges of files.

use crate::blossom::{blossom, restricted};
use crate::surface::usable;
use crate::weights::checked_weights;
use crate::{KnotVector, MAX_DEGREE, NurbsError};
use glam::{DVec3, DVec4};

/// A NURBS curve of degree p over n control points in model units. Its knots need not be clamped.
#[derive(Debug, Clone, PartialEq)]
pub struct SpaceCurve {
    knots: KnotVector,
    homogeneous: Vec<DVec4>,
}

impl SpaceCurve {
    /// Builds a curve from Euclidean points and, where it is rational, their weights.
    ///
    /// # Errors
    /// [`NurbsError::PointCount`], [`NurbsError::PointNotFinite`], [`NurbsError::WeightCount`], [`NurbsError::Weight`].
    pub fn new(knots: KnotVector, points: &[DVec3], weights: Option<&[f64]>) -> Result<Self, NurbsError> {
        let homogeneous = homogeneous(&knots, points.iter().copied(), weights)?;
        Ok(Self { knots, homogeneous })
    }

    /// Knots and degree.
    pub fn knots(&self) -> &KnotVector {
        &self.knots
    }

    /// The Euclidean control points.
    pub fn points(&self) -> impl DoubleEndedIterator<Item = DVec3> + '_ {
        self.homogeneous.iter().map(|c| c.truncate() / c.w)
    }

    /// The weights; `None` for a polynomial curve.
    pub fn weights(&self) -> Option<Vec<f64>> {
        let weights = || self.homogeneous.iter().map(|c| c.w);
        weights().any(|w| w != 1.0).then(|| weights().collect())
    }

    /// The part of the curve over a range of its domain, with the same parameter, clamped at both ends, as [`restricted`] has it.
    ///
    /// # Errors
    /// Those of [`restricted`].
    pub fn restricted(&self, range: [f64; 2]) -> Result<Self, NurbsError> {
        let (knots, homogeneous) = restricted(&self.knots, &self.homogeneous, range)?;
        Ok(Self { knots, homogeneous })
    }

    /// C(t) and C'(t), on the span that `t` is in; within 4 p ulp of the largest control point, times the weights' ratio.
    pub fn first_derivative(&self, t: f64) -> [DVec3; 2] {
        let (p, span, u) = (self.knots.degree(), self.knots.find_span(t), self.knots.knots());
        let (a, b) = (u[span], u[span + 1]);
        let local = &self.homogeneous[span - p..=span];
        let mut arguments = [t; MAX_DEGREE];
        let mut at = |last: f64| {
            arguments[p - 1] = last;
            blossom(&self.knots, span, local, &arguments[..p])
        };
        // The derivative of a blossom in its last argument is constant (Ramshaw 1989).
        let (c, c_t) = (at(t), (at(b) - at(a)) * (p as f64 / (b - a)));
        let point = c.truncate() / c.w;
        [point, (c_t.truncate() - point * c_t.w) / c.w]
    }
}

/// The checked control points of a curve, (w x, w y, w z, w).
pub(crate) fn homogeneous(
    knots: &KnotVector,
    points: impl ExactSizeIterator<Item = DVec3> + Clone,
    weights: Option<&[f64]>,
) -> Result<Vec<DVec4>, NurbsError> {
    let expected = knots.control_count();
    if points.len() != expected {
        return Err(NurbsError::PointCount { expected, found: points.len() });
    }
    let mut coordinates = points.clone().enumerate().flat_map(|(i, p)| p.to_array().map(|x| (i, x)));
    if let Some((index, value)) = coordinates.find(|(_, x)| !usable(*x)) {
        return Err(NurbsError::PointNotFinite { index, value });
    }
    let weights = weights.map(|weights| checked_weights(weights.to_vec(), expected)).transpose()?;
    let weight = |i: usize| weights.as_ref().map_or(1.0, |w| w[i]);
    Ok(points.enumerate().map(|(i, p)| (p * weight(i)).extend(weight(i))).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_part_of_a_curve_is_the_same_curve() {
        let knots = KnotVector::new(3, vec![0.0, 0.5, 1.0, 2.0, 3.0, 3.5, 3.5, 5.0, 6.0, 6.5, 7.0]).unwrap();
        let points: Vec<DVec3> =
            (0..7).map(|k| DVec3::new(f64::from(k), f64::from(k * k % 5), f64::from(k % 3))).collect();
        let weights = [1.0, 2.0, 0.5, 1.0, 3.0, 1.0, 0.7];
        let curve = SpaceCurve::new(knots, &points, Some(&weights)).unwrap();
        for range in [[2.0, 5.0], [2.25, 4.0], [3.0, 3.5], [3.1, 3.2], [4.0, 5.0]] {
            let part = curve.restricted(range).unwrap();
            assert_eq!(part.knots().domain(), range.into());
            for k in 0..=10 {
                let t = range[0] + (range[1] - range[0]) * f64::from(k) / 10.0;
                let [a, b] = [&curve, &part].map(|c| c.first_derivative(t));
                assert!(a[0].distance(b[0]) < 1e-13, "{range:?} {t}");
            }
        }
        assert!(matches!(curve.restricted([1.0, 3.0]), Err(NurbsError::OutsideDomain { value: 1.0, .. })));
        assert!(matches!(curve.restricted([3.0, 3.0]), Err(NurbsError::EmptyDomain { .. })));
    }
}
