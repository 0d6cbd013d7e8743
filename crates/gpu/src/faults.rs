//! Faults put into a renderer on purpose, to see whether a comparison finds them.

use crate::masks::MaskBlend;
use pipeline::wgsl::Variant;

/// Which of several surfaces at a pixel is kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum DepthOrder {
    /// The nearest; at equal depth the one drawn first.
    #[default]
    Nearest,
    /// The farthest: a fault, for tests of the comparer.
    Farthest,
}

/// Faults put into a renderer to see whether a comparison finds them. The default puts in none.
#[derive(Clone, Copy, Default)]
pub struct Overrides<'f> {
    /// Makes the WGSL of a variant in place of [`pipeline::wgsl::source`].
    pub source: Option<&'f dyn Fn(Variant) -> String>,
    /// The depth test.
    pub depth: DepthOrder,
    /// How masks are drawn.
    pub mask: MaskBlend,
}
