//! Why a pixel differs.

use serde::Serialize;

/// The one cause a differing pixel is given. [`Judge::pair`](crate::Judge::pair) documents the order of the tests.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Cause {
    /// One renderer sees the surface and the other does not, and no edge is near enough to excuse it.
    Coverage,
    /// A point is shown that a nearer one hides.
    Depth,
    /// All is right but the distance along the ray, which is not that of the point shown.
    Distance,
    /// The numbers are those of another face.
    Face,
    /// The numbers are those of another knot span's polynomial, or the program left the knot vector.
    Span,
    /// u and v are exchanged.
    Parameters,
    /// The control net was read with rows and columns exchanged.
    ControlNet,
    /// The rational quotient is missing.
    Rational,
    /// The position is right and the normal, of unit length, is not: a derivative is wrong.
    Derivative,
    /// The normal's direction is right and its length is not 1.
    NormalLength,
    /// One side calls the normal degenerate and the other, with a bound that decides it, does not.
    DegenerateNormal,
    /// Position and normal are right and a principal curvature is not.
    Curvature,
    /// S at the candidate's (u, v) is right, but those parameters belong to another place in the picture.
    Interpolation,
    /// Outside its interval by less than [`NEARLY`](crate::NEARLY) half-widths: rounding worse than WGSL allows.
    Rounding,
    /// A value is NaN or infinite, with no better explanation.
    NotFinite,
    /// The position is wrong and no hypothesis explains it.
    Position,
    /// Material is shown where the face has been trimmed away, or none where a trimmed face has some, and no edge is near
    /// enough to excuse it.
    Trim,
    /// The candidate says that its root finding did not end at this pixel, and the pixel differs.
    NewtonNotConverged,
    /// The candidate, which solves for the surface at each pixel (technique `exact`), does not show the nearest surface
    /// there, and no edge of it is near enough to excuse that.
    MissedRoot,
    /// The reference could not decide the pixel; neither agreement nor difference.
    Undecided,
}

impl Cause {
    /// The cause in a few words, for tables.
    pub fn label(self) -> &'static str {
        match self {
            Cause::Coverage => "coverage",
            Cause::Depth => "depth",
            Cause::Distance => "distance along the ray",
            Cause::Face => "face",
            Cause::Span => "span",
            Cause::Parameters => "u and v exchanged",
            Cause::ControlNet => "control net transposed",
            Cause::Rational => "rational quotient missing",
            Cause::Derivative => "derivative",
            Cause::NormalLength => "normal not unit",
            Cause::DegenerateNormal => "degenerate normal",
            Cause::Curvature => "curvature",
            Cause::Interpolation => "interpolation",
            Cause::Rounding => "rounding",
            Cause::NotFinite => "not finite",
            Cause::Position => "position",
            Cause::Trim => "trim",
            Cause::NewtonNotConverged => "Newton not converged",
            Cause::MissedRoot => "missed root",
            Cause::Undecided => "undecided",
        }
    }
}
