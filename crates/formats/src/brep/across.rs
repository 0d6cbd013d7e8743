//! Which way, and how far, something stands beside a curve at each of its parameters.

use super::curve::Curve;
use super::frame::Frame;
use glam::DVec3;

/// A share of a profile's size below which a point is on the axis.
const ON_AXIS: f64 = 1e-12;

/// The way from a curve with tangent T.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Across {
    /// T × this vector.
    Beside(DVec3),
    /// S_u × S_v of the curve turned about this frame's z.
    Outward(Frame),
}

impl Across {
    /// The unit vector of the way at parameter `t`; in the limit where a curve that turns meets the axis.
    pub fn unit(&self, curve: &Curve, t: f64) -> Option<DVec3> {
        let tangent = curve.tangent(t);
        match self {
            Self::Beside(vector) => tangent.cross(*vector).try_normalize(),
            Self::Outward(frame) => {
                let across = |v: DVec3| v - frame.z * v.dot(frame.z);
                let point = curve.point(t);
                let arm = across(point - frame.origin);
                // It leaves the axis at its start, and comes to it at its end.
                let is_start = curve.domain().is_none_or(|[start, end]| t - start < end - t);
                let size = tangent.length().max(point.distance(frame.origin));
                let arm = if arm.length() <= ON_AXIS * size {
                    across(if is_start { tangent } else { -tangent })
                } else {
                    arm
                };
                frame.z.cross(arm.try_normalize()?).cross(tangent).try_normalize()
            }
        }
    }
}

/// A distance that changes evenly with a curve's parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Ramp {
    /// At parameter 0, and by how much it grows in 1.
    pub start: f64,
    pub slope: f64,
}

impl Ramp {
    pub fn even(distance: f64) -> Self {
        Self { start: distance, slope: 0.0 }
    }

    pub fn at(&self, t: f64) -> f64 {
        self.start + self.slope * t
    }
}
