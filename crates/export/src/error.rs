//! Why a document is not written.

use formats::FormatError;
use nurbs::NurbsError;
use std::io;

/// Why a document is not written.
#[derive(Debug, thiserror::Error)]
pub enum ExportError {
    /// The path has an extension of no writer, or none.
    #[error("{extension:?} is no extension of a file that is written; there are {known}")]
    UnknownExtension {
        /// As it was given, in lower case; empty where there is none.
        extension: String,
        /// Those that there are.
        known: String,
    },
    /// The error is no length.
    #[error("the error {0} is not a positive, finite number of model units")]
    Error(f64),
    /// The triangles of that error are more than are made; nothing was allocated for them.
    #[error(
        "an error of {error:e} asks for about {needed:.3e} triangles, most of them of face {face}, and at most {limit} are made"
    )]
    TooManyTriangles {
        /// The error that was asked for, model units.
        error: f64,
        /// The face that asks for most, by its number in the file.
        face: usize,
        /// How many triangles it would take.
        needed: f64,
        /// How many are made at most.
        limit: usize,
    },
    /// A trim is no curve.
    #[error("face {face}, loop {boundary}, trim {trim}: {cause}")]
    Trim {
        /// The face, by its number in the file.
        face: usize,
        /// Index of the loop in the face.
        boundary: usize,
        /// Index of the trim in the loop.
        trim: usize,
        /// What is wrong.
        cause: NurbsError,
    },
    /// The JSON writer refused.
    #[error(transparent)]
    Json(#[from] FormatError),
    /// The file cannot be written.
    #[error(transparent)]
    Io(#[from] io::Error),
}
