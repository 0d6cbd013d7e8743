//! Which renderer draws a picture.

use clap::ValueEnum;

/// A renderer, by name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum With {
    /// The CPU rasterizer, f32
    Raster,
    /// The GPU, f32
    Gpu,
    /// The ray caster, f64
    Raycast,
}
