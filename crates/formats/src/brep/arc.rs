//! Arcs as rational splines, and the way from an angle to their parameter.
//!
//! An arc of angle δ is the rational quadratic of weights 1, cos(δ/2), 1. With φ counted from its middle and t from 0 to 1,
//! tan(φ/2) = (2t − 1) tan(δ/4): a stereographic projection (Piegl & Tiller, Sec. 7.3). Arcs of equal angles stand in a row, and
//! the knot of each is its angle, so that parameter and angle agree at the ends and in the middle of every span.

use nurbs::KnotVector;
use std::f64::consts::FRAC_PI_2;

/// A range of angles cut into arcs of equal size, at most a quarter of a turn each.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Arcs {
    pub start: f64,
    pub step: f64,
    pub count: usize,
}

impl Arcs {
    /// The arcs from `start` to `end`, which is greater.
    pub fn new([start, end]: [f64; 2]) -> Self {
        // A quarter that rounding made longer is one arc still.
        let count = ((end - start) / FRAC_PI_2 - 1e-9).ceil().max(1.0);
        Self { start, step: (end - start) / count, count: count as usize }
    }

    /// The quadratic knots: each inner angle twice.
    pub fn knots(&self) -> Vec<f64> {
        let angle = |k: usize| self.start + self.step * k as f64;
        let inner = (1..self.count).flat_map(|k| [angle(k); 2]);
        [self.start; 3].into_iter().chain(inner).chain([angle(self.count); 3]).collect()
    }

    /// For each control point its angle, and how many times as far from the centre it is as the arc; the weight is the
    /// inverse of that.
    pub fn controls(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        let reach = libm::cos(0.5 * self.step).recip();
        (0..=2 * self.count)
            .map(move |i| (self.start + 0.5 * self.step * i as f64, if i % 2 == 0 { 1.0 } else { reach }))
    }

    /// The spline's parameter at an angle. Beyond the range arcs of the same size go on.
    pub fn parameter(&self, angle: f64) -> f64 {
        let arcs = (angle - self.start) / self.step;
        let k = arcs.floor();
        let phi = (arcs - k - 0.5) * self.step;
        let t = 0.5 + 0.5 * libm::tan(0.5 * phi) / libm::tan(0.25 * self.step);
        self.start + (k + t) * self.step
    }
}

/// The knots of a Bézier piece.
pub(crate) fn bezier_knots(degree: usize, [start, end]: [f64; 2]) -> Result<KnotVector, nurbs::NurbsError> {
    KnotVector::new(degree, [vec![start; degree + 1], vec![end; degree + 1]].concat())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_spline_of_arcs_stands_at_the_angle_of_its_parameter() {
        for [start, end] in [[0.0, 1.0], [-2.0, 4.28], [0.3, 0.3 + std::f64::consts::TAU]] {
            let arcs = Arcs::new([start, end]);
            let knots = KnotVector::new(2, arcs.knots()).unwrap();
            let points: Vec<_> = arcs
                .controls()
                .map(|(angle, reach)| reach * glam::DVec2::from_angle(angle))
                .map(|p| p.extend(0.0))
                .collect();
            let weights: Vec<f64> = arcs.controls().map(|(_, reach)| reach.recip()).collect();
            let curve = nurbs::SpaceCurve::new(knots, &points, Some(&weights)).unwrap();
            for k in 0..=37 {
                let angle = start + (end - start) * f64::from(k) / 37.0;
                let t = arcs.parameter(angle);
                let [point, _] = curve.first_derivative(t);
                assert!(point.truncate().distance(glam::DVec2::from_angle(angle)) < 1e-14, "{angle}: {point}");
            }
        }
    }
}
