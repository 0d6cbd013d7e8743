//! Plane NURBS curves: the trims of a face, in its surface's parameters.

use crate::bezier_curve::BezierCurve;
use crate::blossom::bezier_points;
use crate::space_curve::homogeneous;
use crate::{KnotVector, NurbsError};
use glam::{DVec2, DVec3, DVec4};

/// A NURBS curve of degree p over n control points (u, v).
///
/// Its knots need not be clamped; its domain is that of the knot vector.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    knots: KnotVector,
    /// (w u, w v, 0, w), in the form that blossoms take.
    homogeneous: Vec<DVec4>,
}

impl Curve {
    /// Builds a curve from Euclidean points and, where it is rational, their weights.
    ///
    /// # Errors
    /// [`NurbsError::PointCount`], [`NurbsError::PointNotFinite`], [`NurbsError::WeightCount`], [`NurbsError::Weight`].
    pub fn new(knots: KnotVector, points: &[DVec2], weights: Option<&[f64]>) -> Result<Self, NurbsError> {
        let homogeneous = homogeneous(&knots, points.iter().map(|p| p.extend(0.0)), weights)?;
        Ok(Self { knots, homogeneous })
    }

    /// Knots and degree.
    pub fn knots(&self) -> &KnotVector {
        &self.knots
    }

    /// C(t), by de Boor's algorithm (Piegl & Tiller, A4.1). Outside the domain the outermost segment is extrapolated.
    ///
    /// Error: at most 4 p ulp of the largest control point, times the ratio of the weights.
    pub fn point(&self, t: f64) -> DVec2 {
        let (p, span) = (self.knots.degree(), self.knots.find_span(t));
        let arguments = [t; crate::MAX_DEGREE];
        let c = crate::blossom::blossom(&self.knots, span, &self.homogeneous[span - p..=span], &arguments[..p]);
        DVec2::new(c.x, c.y) / c.w
    }

    /// The Bézier segments of all nonempty spans, in the curve's direction (Piegl & Tiller, A5.6, here by blossoms).
    ///
    /// Each is in standard form ([`BezierCurve::standardised`]), and the last point of one is to the bit the first
    /// of the next. A segment's parameter is therefore not an affine function of the curve's where that is rational.
    pub fn bezier_segments(&self) -> Vec<BezierCurve> {
        let (p, u) = (self.knots.degree(), self.knots.knots());
        let mut segments: Vec<BezierCurve> = vec![];
        for k in self.knots.spans() {
            let control = bezier_points(&self.knots, k, &self.homogeneous[k - p..=k], [u[k], u[k + 1]]);
            let control = control.into_iter().map(|c| DVec3::new(c.x, c.y, c.w)).collect();
            let mut segment = BezierCurve { control }.standardised();
            if let Some(last) = segments.last() {
                let end = segment.end();
                segment.set_ends(last.end(), end);
            }
            segments.push(segment);
        }
        segments
    }
}
