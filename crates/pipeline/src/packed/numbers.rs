//! The arrays that all faces share.

/// What the records of faces index.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Numbers {
    /// Single numbers.
    pub(crate) knots: Vec<f32>,
    /// Numbers by four.
    pub(crate) points: Vec<[f32; 4]>,
}
