//! What a model's user should know of how it was read: faces left out, loops dropped, gaps closed, surfaces cut.

use crate::{SceneError, WideGap};
use std::fmt;

/// Something of a file that is not drawn as it stands there.
///
/// Faces are numbered as in the file.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Note {
    /// A face is not drawn.
    FaceLeftOut {
        /// Its number.
        face: usize,
        /// Why; it names the face, and the loop and the trim where there is one.
        cause: SceneError,
    },
    /// A loop encloses nothing.
    LoopDropped {
        /// Number of the face.
        face: usize,
        /// Index of the loop in the face.
        boundary: usize,
    },
    /// A gap was closed that is wider than the file's tolerances.
    WideGap {
        /// Number of the face.
        face: usize,
        /// The gap.
        gap: WideGap,
    },
    /// A surface is torn along a knot, and was cut there.
    SurfaceCut {
        /// Its number.
        surface: usize,
        /// The parameter that is constant along the cut: `u` or `v`.
        parameter: char,
        /// The knot.
        at: f64,
        /// How far the control points on its two sides are apart at most, model units.
        apart: f64,
    },
}

impl Note {
    /// The number of the face that it is about; `None` where it is about a surface.
    pub fn face(&self) -> Option<usize> {
        match self {
            Self::FaceLeftOut { face, .. } | Self::LoopDropped { face, .. } | Self::WideGap { face, .. } => Some(*face),
            Self::SurfaceCut { .. } => None,
        }
    }
}

impl fmt::Display for Note {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::FaceLeftOut { cause, .. } => write!(f, "left out: {cause}"),
            Self::LoopDropped { face, boundary } => {
                write!(f, "face {face}, loop {boundary}: dropped, as it encloses nothing")
            }
            Self::WideGap { face, gap: WideGap { boundary, trim, gap, tolerance } } => write!(
                f,
                "face {face}, loop {boundary}, trim {trim}: closed a gap of {gap:.3e} model units before it, above the \
                 file's tolerance of {tolerance:.3e}"
            ),
            Self::SurfaceCut { surface, parameter, at, apart } => {
                write!(
                    f,
                    "surface {surface}: cut at {parameter} = {at}, where its control points are {apart:.3e} apart"
                )
            }
        }
    }
}
