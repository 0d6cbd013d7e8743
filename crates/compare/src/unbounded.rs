//! Why a pixel has no verdict.

use serde::Serialize;

/// Why nothing useful can be said of a covered pixel: it is counted, and neither agrees nor differs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Unbounded {
    /// The triangles that are drawn may be too far from the surface there.
    Chord,
    /// What interpolation may lose of (u, v) amounts to too much there.
    Interpolation,
    /// f32 may return S too far from where it is, or has no bound of it.
    Rounding,
    /// The normal has no bound in f32, as at a pole.
    Normal,
    /// The curvatures have no bound in f32.
    Curvature,
    /// f64, in which a G-buffer holds them, tells fewer (u, v) apart there than f32 does on a piece of its own.
    Parameters,
}

impl Unbounded {
    /// The reason in a few words, for tables.
    pub fn label(self) -> &'static str {
        match self {
            Self::Chord => "triangles too far from the surface",
            Self::Interpolation => "interpolated (u, v) too coarse",
            Self::Rounding => "S without a bound in f32",
            Self::Normal => "normal without a bound in f32",
            Self::Curvature => "curvature without a bound in f32",
            Self::Parameters => "f64 cannot hold (u, v) here",
        }
    }
}
