//! Why a scene could not be prepared.

use pipeline::GREATEST_TRIANGLES;

/// Why a technique could not prepare a scene.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PrepareError {
    /// The chord bound asks for more triangles than are allowed.
    #[error("a chord error of {chord_px} pixels asks for over {GREATEST_TRIANGLES} triangles; allow a larger one")]
    TooManyTriangles {
        /// The chord error asked for.
        chord_px: f64,
    },
    /// The faces have more nearly flat pieces than are allowed.
    #[error("the model has {count} nearly flat pieces; technique `exact` draws at most {}", GREATEST_TRIANGLES / 12)]
    TooManyPieces {
        /// How many there are.
        count: usize,
    },
    /// A patch has more zones than a step may emit, and steps are of whole patches.
    #[error(
        "patch ({}, {}) of face {face} has {zones} zones; a step of whole patches may emit {most}", span[0], span[1]
    )]
    TooManyZones {
        /// The face.
        face: u32,
        /// The patch, by its spans in u and in v.
        span: [u32; 2],
        /// Its zones.
        zones: u32,
        /// Zones of a step at most.
        most: u32,
    },
    /// The chord bound is not a positive number.
    #[error("a chord error of {chord_px} pixels: it must be positive")]
    Chord {
        /// The chord error asked for.
        chord_px: f64,
    },
}
