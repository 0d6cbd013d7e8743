//! What can be wrong with the numbers from which a spline is built.

use crate::{MAX_DEGREE, MAX_KNOTS};

/// Why a knot vector, a curve or a surface could not be built or changed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum NurbsError {
    /// The degree is 0 or above [`MAX_DEGREE`].
    #[error("degree {degree} is outside 1 to {MAX_DEGREE}")]
    Degree {
        /// The degree that was given.
        degree: usize,
    },
    /// Fewer knots than a single span needs, 2 (p + 1).
    #[error("{count} knots are too few: degree {degree} needs at least {least}")]
    TooFewKnots {
        /// Number of knots given.
        count: usize,
        /// The degree.
        degree: usize,
        /// The least number of knots.
        least: usize,
    },
    /// More than [`MAX_KNOTS`] knots.
    #[error("{count} knots are more than the {MAX_KNOTS} allowed")]
    TooManyKnots {
        /// Number of knots given.
        count: usize,
    },
    /// A knot is NaN or infinite.
    #[error("knot {index} is {value:?}, not a finite number")]
    KnotNotFinite {
        /// Index of the knot.
        index: usize,
        /// Its value.
        value: f64,
    },
    /// A knot is smaller than the one before it.
    #[error("knot {index} is {next:?}, below the knot before it, {previous:?}")]
    NotSorted {
        /// Index of the second knot.
        index: usize,
        /// The knot before it.
        previous: f64,
        /// The knot itself.
        next: f64,
    },
    /// A knot is repeated more often than continuity allows: p inside the domain, p + 1 at its ends.
    #[error("knot {value:?} at index {index} has multiplicity {multiplicity}, above {greatest}")]
    Multiplicity {
        /// Index of the first of the equal knots.
        index: usize,
        /// Their value.
        value: f64,
        /// How many there are.
        multiplicity: usize,
        /// How many may be.
        greatest: usize,
    },
    /// The domain \[u_p, u_n\] is empty, or its length overflows.
    #[error("the knot domain from {start:?} to {end:?} is empty or overflows")]
    EmptyDomain {
        /// u_p.
        start: f64,
        /// u_n.
        end: f64,
    },
    /// A nonempty span is so short that 1 / length overflows.
    #[error("the knot span from {start:?} to {end:?} is too short: its reciprocal overflows")]
    SpanUnderflow {
        /// First knot of the difference.
        start: f64,
        /// Second knot of the difference.
        end: f64,
    },
    /// The number of control points is not the one that the knots ask for.
    #[error("{found} control points where the knot vectors ask for {expected}")]
    PointCount {
        /// n_u × n_v from the knots.
        expected: usize,
        /// Points given.
        found: usize,
    },
    /// A coordinate is NaN, infinite or so large that sums of squares overflow.
    #[error("control point {index} has the coordinate {value:?}, not a finite number of usable size")]
    PointNotFinite {
        /// Index of the point.
        index: usize,
        /// The coordinate.
        value: f64,
    },
    /// The number of weights is not that of the control points.
    #[error("{found} weights for {expected} control points")]
    WeightCount {
        /// Number of control points.
        expected: usize,
        /// Weights given.
        found: usize,
    },
    /// A weight is zero, negative, NaN, infinite, or too far from the largest.
    #[error("weight {index} is {value:?}: weights are positive, finite and within a ratio of 1e12")]
    Weight {
        /// Index of the weight.
        index: usize,
        /// Its value.
        value: f64,
    },
    /// A parameter at which to insert or split is not inside the open domain.
    #[error("parameter {value:?} is not inside the open domain from {start:?} to {end:?}")]
    OutsideDomain {
        /// The parameter.
        value: f64,
        /// Start of the domain.
        start: f64,
        /// End of the domain.
        end: f64,
    },
    /// Halving a curve does not bring the error of its lower degree within the bound.
    #[error("degree {degree} is {reached:e} off after all halvings, and {bound:e} was asked for")]
    ReductionBound {
        /// The degree asked for.
        degree: usize,
        /// The bound asked for, in units of u and v.
        bound: f64,
        /// The bound reached.
        reached: f64,
    },
    /// Halving a patch does not bring its bicubic patches within the tolerance.
    #[error("a part of the patch is {reached:e} off after {parts} parts, and {tolerance:e} was asked for")]
    BicubicTolerance {
        /// The tolerance asked for, in model units.
        tolerance: f64,
        /// The bound reached for the part that stays above it; infinite where a weight is not positive.
        reached: f64,
        /// Parts found before.
        parts: usize,
    },
}
