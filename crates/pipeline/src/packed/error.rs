//! Why a model could not be packed.

/// Why a model could not be packed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PackError {
    /// More numbers than 32-bit indices reach.
    #[error("the model has {count} {what}, more than a packed scene can index ({greatest})")]
    TooLarge {
        /// What there is too much of.
        what: &'static str,
        /// How many there are.
        count: usize,
        /// How many there may be.
        greatest: usize,
    },
    /// A face's coordinates are too small or too large for a scale that is a finite power of two.
    #[error("face {face} measures {size:e} model units: too small or too large for f32 at any scale")]
    Scale {
        /// The face.
        face: usize,
        /// Its size.
        size: f64,
    },
}

/// The most control points or knots of a packed scene: their bytes stay below 4 GiB, the reach of a GPU binding.
pub(crate) const GREATEST_COUNT: usize = 1 << 27;
