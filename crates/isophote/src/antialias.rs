//! Anti-aliasing from the command line.

use clap::ValueEnum;
use scene::{Camera, SamplePattern, Viewport};
use serde::Serialize;

/// How the edges of a picture are smoothed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
pub enum Antialias {
    /// Not: one sample, in the pixel's centre
    #[default]
    None,
    /// Trim edges alone, by the distance that each pixel records to its own face's (Persson 2011): one sample a pixel;
    /// G-buffers have it as `edge`
    Trims,
    /// The mean of 4 samples a pixel, in linear light, at the standard places of Vulkan, Direct3D and WebGPU
    #[value(name = "4")]
    Four,
    /// Of 8 samples
    #[value(name = "8")]
    Eight,
    /// Of 16 samples
    #[value(name = "16")]
    Sixteen,
}

impl Antialias {
    /// Where a pixel is sampled.
    pub fn pattern(self) -> SamplePattern {
        match self {
            Self::None | Self::Trims => SamplePattern::One,
            Self::Four => SamplePattern::Four,
            Self::Eight => SamplePattern::Eight,
            Self::Sixteen => SamplePattern::Sixteen,
        }
    }
}

/// One sample of a picture's pixels, for reports.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct SampleReport {
    /// Its place in the pixel, from the top left corner, right and down, pixels.
    pub position: [f64; 2],
    /// The lens shift that puts it into the pixel's centre: `--lens-shift` of other commands.
    pub lens_shift: [f64; 2],
}

impl SampleReport {
    /// The samples of a pattern as `camera` takes them.
    pub fn of(pattern: SamplePattern, camera: &Camera, viewport: Viewport) -> Vec<Self> {
        let cameras = pattern.cameras(camera, viewport);
        let places = pattern.positions().iter().zip(&cameras);
        places.map(|(&position, camera)| Self { position, lens_shift: camera.lens_shift().to_array() }).collect()
    }
}
