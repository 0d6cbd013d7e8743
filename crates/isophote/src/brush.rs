//! Lines over a picture, each so wide, smooth at its sides.

use anyhow::Result;
use gbuffer::Picture;
use glam::DVec2;

/// The step along a line, pixels: far less than its width.
pub const STEP: f64 = 0.4;

/// A picture that is drawn on.
pub struct Brush {
    width: usize,
    height: usize,
    rgb: Vec<[u8; 3]>,
}

impl Brush {
    /// One on a copy of a picture.
    pub fn new(picture: &Picture) -> Self {
        Self { width: picture.width(), height: picture.height(), rgb: picture.rgb().to_vec() }
    }

    /// Draws a line through places close to each other, `radius` pixels to either side, in a colour that covers as much as `strength`.
    pub fn draw(&mut self, places: &[DVec2], radius: f64, colour: [u8; 3], strength: f64) {
        let [width, height] = [self.width as i64, self.height as i64];
        let mut covered = vec![0.0f64; self.rgb.len()];
        let reach = radius.ceil() as i64;
        for place in places {
            let (column, row) = (place.x.floor() as i64, place.y.floor() as i64);
            for y in (row - reach).max(0)..=(row + reach).min(height - 1) {
                for x in (column - reach).max(0)..=(column + reach).min(width - 1) {
                    let distance = place.distance(DVec2::new(x as f64 + 0.5, y as f64 + 0.5));
                    let share = (radius + 0.5 - distance).clamp(0.0, 1.0);
                    let own = &mut covered[(y * width + x) as usize];
                    *own = own.max(share);
                }
            }
        }
        for (rgb, share) in self.rgb.iter_mut().zip(covered) {
            let share = strength * share;
            for (own, part) in rgb.iter_mut().zip(colour) {
                *own = (f64::from(*own) + share * (f64::from(part) - f64::from(*own))).round() as u8;
            }
        }
    }

    /// The picture with all that was drawn.
    ///
    /// # Errors
    /// None: it is of the size that it was.
    pub fn picture(self) -> Result<Picture> {
        Ok(Picture::new(self.width, self.height, self.rgb)?)
    }
}
