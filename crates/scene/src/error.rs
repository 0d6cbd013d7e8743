//! What can be wrong with a scene.

use crate::{MAX_PIXELS, MAX_SIDE};

/// Why a model, camera or viewport could not be built.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SceneError {
    /// The model has no face.
    #[error("the model has no faces")]
    NoFaces,
    /// A face names a surface that the model does not have.
    #[error("face {face} names surface {surface}, but there are only {count}")]
    NoSuchSurface {
        /// Index of the face.
        face: usize,
        /// The surface it names.
        surface: usize,
        /// Number of surfaces.
        count: usize,
    },
    /// Width or height is zero or above [`MAX_SIDE`], or there are more than [`MAX_PIXELS`] pixels.
    #[error(
        "a viewport of {width}x{height} pixels: each side must be 1 to {MAX_SIDE}, and both at most {MAX_PIXELS} pixels"
    )]
    Viewport {
        /// Width in pixels.
        width: usize,
        /// Height in pixels.
        height: usize,
    },
    /// A camera vector has a coordinate that is NaN or infinite.
    #[error("the camera's {name} is {value}, not a finite number")]
    CameraNotFinite {
        /// Which value.
        name: &'static str,
        /// The coordinate.
        value: f64,
    },
    /// Eye and target coincide.
    #[error("the camera's eye and target coincide at {at:?}")]
    EyeIsTarget {
        /// Where.
        at: [f64; 3],
    },
    /// The up vector is zero or parallel to the view.
    #[error("the camera's up vector {up:?} is zero or parallel to the view direction")]
    UpIsParallel {
        /// The up vector.
        up: [f64; 3],
    },
    /// The field of view is outside its range.
    #[error("a field of view of {degrees} degrees: it must be above 0 and below 180")]
    FieldOfView {
        /// The angle, degrees.
        degrees: f64,
    },
    /// The height of an orthographic view is not positive.
    #[error("an orthographic view of height {height}: it must be above 0")]
    OrthographicHeight {
        /// The height, model units.
        height: f64,
    },
    /// The near distance is not positive (perspective) or is negative (orthographic).
    #[error("a near distance of {near}: it must be above 0 (perspective) or not below 0 (orthographic)")]
    Near {
        /// The distance, model units.
        near: f64,
    },
}
