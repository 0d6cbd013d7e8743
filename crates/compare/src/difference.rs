//! What is wrong with a pixel.

use crate::Cause;

/// A difference: cause, how many times over, in words.
pub(crate) struct Difference {
    pub cause: Cause,
    pub excess: f64,
    pub detail: String,
}

impl Difference {
    pub fn new(cause: Cause, excess: f64, detail: String) -> Self {
        Self { cause, excess: if excess.is_nan() { f64::INFINITY } else { excess }, detail }
    }
}
