//! The grid of pixels.

use crate::SceneError;
use serde::{Deserialize, Serialize};

/// The longest side of a viewport, in pixels: what wgpu devices take as a texture at least in practice.
pub const MAX_SIDE: usize = 16384;

/// The most pixels of a viewport: 8K. A G-buffer takes 116 bytes a covered pixel, a GPU's targets 68 a pixel.
pub const MAX_PIXELS: usize = 7680 * 4320;

/// A grid of `width` × `height` pixels. Row 0 is on top; pixel (x, y) is sampled at (x + ½, y + ½).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Viewport {
    width: usize,
    height: usize,
}

impl Viewport {
    /// A viewport of at least 1 × 1 pixel.
    ///
    /// # Errors
    /// [`SceneError::Viewport`] where a side is 0 or above [`MAX_SIDE`], or there are more than [`MAX_PIXELS`] pixels.
    pub fn new(width: usize, height: usize) -> Result<Self, SceneError> {
        let legal = 1..=MAX_SIDE;
        if !legal.contains(&width) || !legal.contains(&height) || width * height > MAX_PIXELS {
            return Err(SceneError::Viewport { width, height });
        }
        Ok(Self { width, height })
    }

    /// Width in pixels.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Height in pixels.
    pub fn height(&self) -> usize {
        self.height
    }

    /// Number of pixels.
    pub fn pixels(&self) -> usize {
        self.width * self.height
    }

    /// Width over height.
    pub fn aspect(&self) -> f64 {
        self.width as f64 / self.height as f64
    }
}
