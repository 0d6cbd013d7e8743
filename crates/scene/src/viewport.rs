//! The grid of pixels.

use crate::{MAX_PIXELS, MAX_SIDE, SceneError};
use serde::{Deserialize, Serialize};

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
