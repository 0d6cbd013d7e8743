//! A GPU's bits beside the CPU rasterizer's, where `--path strict` asks for the same ones.

use gbuffer::GBuffer;
use serde::{Deserialize, Serialize};

/// How far a GPU has the CPU rasterizer's bits.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Bits {
    /// Pixels of which any number has other bits, of all pictures together.
    pub unlike: usize,
    /// Which arrays, how often, and the first number, of the first picture that has any.
    pub first: Option<String>,
}

impl Bits {
    /// What two buffers of one picture come to.
    pub fn new(raster: &GBuffer, gpu: &GBuffer) -> Self {
        let unlike = raster.unlike(gpu);
        Self { unlike: unlike.pixels, first: (unlike.pixels > 0).then(|| unlike.to_string()) }
    }

    /// Of several pictures; `None` where there are none.
    pub fn of_all(pictures: impl Iterator<Item = Self>) -> Option<Self> {
        pictures.reduce(|a, b| Self { unlike: a.unlike + b.unlike, first: a.first.or(b.first) })
    }
}
