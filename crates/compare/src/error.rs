//! What can be wrong with two buffers before a pixel of them is compared.

/// Why two buffers cannot be compared.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CompareError {
    /// Both come from the same renderer: that would be no check.
    #[error("both G-buffers come from the renderer {name:?}")]
    SameRenderer {
        /// Its name.
        name: String,
    },
    /// The sizes differ from each other or from the judge's.
    #[error("the G-buffers measure {reference:?} and {candidate:?} where {expected:?} is compared")]
    Size {
        /// Size of the reference.
        reference: [usize; 2],
        /// Size of the candidate.
        candidate: [usize; 2],
        /// Size of the judge's viewport.
        expected: [usize; 2],
    },
    /// A buffer shows another model or another view.
    #[error("the {what} of the G-buffer from {renderer:?} is not the one compared")]
    OtherScene {
        /// `model` or `camera`.
        what: &'static str,
        /// Whose buffer it is.
        renderer: String,
    },
    /// A hit names a face that the model does not have.
    #[error("the G-buffer from {renderer:?} names face {face}; the model has {count}")]
    NoSuchFace {
        /// Whose buffer it is.
        renderer: String,
        /// The face.
        face: u32,
        /// Faces of the model.
        count: usize,
    },
}
