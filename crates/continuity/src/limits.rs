//! What is asked of an edge, and what the answer may be.

use serde::Serialize;

/// The greatest deviations that an edge may have.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Limits {
    /// Of the distance, model units.
    pub gap: f64,
    /// Of the angle between the tangent planes, degrees.
    pub angle_deg: f64,
    /// Of the relative difference of the normal curvatures across the edge; `None` where it is reported and not judged.
    pub curvature: Option<f64>,
}

/// A named quality of edges.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
pub enum Class {
    /// 0.01 mm and 0.1°.
    A,
    /// 0.02 and 0.2°.
    B,
    /// 0.05 and 0.5°.
    C,
}

/// The answer for one criterion.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Verdict {
    /// The bound is within the limit.
    Pass,
    /// The limit is between what was seen and the bound.
    Undecided,
    /// A value above the limit was seen.
    Fail,
}

impl Limits {
    /// The same limits for a model of which a unit is so many millimetres long, where these are in millimetres.
    pub fn in_units_of(self, millimetres: f64) -> Self {
        Self { gap: self.gap / millimetres, ..self }
    }
}

impl Class {
    /// From the finest to the coarsest.
    pub const ALL: [Self; 3] = [Self::A, Self::B, Self::C];

    /// The limits of distance, in millimetres, and angle; curvature is not judged.
    pub fn limits(self) -> Limits {
        let (gap, angle_deg) = match self {
            Self::A => (0.01, 0.1),
            Self::B => (0.02, 0.2),
            Self::C => (0.05, 0.5),
        };
        Limits { gap, angle_deg, curvature: None }
    }
}

impl Verdict {
    /// The verdict on a greatest value that is at least `seen` and at most `bound`.
    pub fn of(seen: f64, bound: f64, limit: f64) -> Self {
        if bound <= limit {
            Self::Pass
        } else if limit < seen {
            Self::Fail
        } else {
            Self::Undecided
        }
    }
}
