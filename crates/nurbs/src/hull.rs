//! Boxes along the axes of space that hold points, rounded outward.

use crate::scale::power_of_two;
use glam::DVec3;

/// Relative slack by which bounds are widened, so that rounding in their own computation cannot make them false.
///
/// The longest chain behind a bound is under 100 operations, each within 2⁻⁵³ of the running maximum.
pub(crate) const OUTWARD: f64 = 1e-13;

/// An axis-aligned box in model units that holds all it was made of.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hull {
    /// Least coordinates.
    pub min: DVec3,
    /// Greatest coordinates.
    pub max: DVec3,
}

impl Hull {
    /// The box of `points`, rounded outward; of none, the empty box (`min` = +∞, `max` = −∞).
    pub fn of(points: impl IntoIterator<Item = DVec3>) -> Self {
        let empty = Self { min: DVec3::INFINITY, max: DVec3::NEG_INFINITY };
        points.into_iter().fold(empty, |hull, p| {
            let slack = p.abs() * OUTWARD;
            Self { min: hull.min.min(p - slack), max: hull.max.max(p + slack) }
        })
    }

    /// The smallest box that holds both.
    pub fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// The middle of the box.
    pub fn center(&self) -> DVec3 {
        self.min + 0.5 * (self.max - self.min)
    }

    /// Length of the diagonal.
    pub fn diagonal(&self) -> f64 {
        length(self.max - self.min)
    }

    /// The eight corners.
    pub fn corners(&self) -> [DVec3; 8] {
        std::array::from_fn(|i| {
            let pick = |bit: usize, low: f64, high: f64| if i >> bit & 1 == 0 { low } else { high };
            DVec3::new(
                pick(0, self.min.x, self.max.x),
                pick(1, self.min.y, self.max.y),
                pick(2, self.min.z, self.max.z),
            )
        })
    }
}

/// The length of a vector, also where the square of it leaves f64.
fn length(v: DVec3) -> f64 {
    let unit = power_of_two(v.abs().max_element());
    (v * unit.recip()).length() * unit
}
