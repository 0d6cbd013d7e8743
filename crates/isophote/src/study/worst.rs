//! The pictures at the worst pixel: what a technique shows there, and what the ray caster does.

use anyhow::Result;
use gbuffer::Picture;

/// Pixels on each side of the worst one.
const REACH: usize = 12;

/// Each pixel is shown by as many along either side.
const ENLARGED: usize = 7;

/// Colour of the frame round the pixel.
const FRAME: [u8; 3] = [255, 255, 0];

/// The surroundings of a pixel, enlarged, and a frame round it; pixels beyond the picture are black.
///
/// # Errors
/// None that can occur: a picture of that size is legal.
pub fn surroundings(picture: &Picture, [x, y]: [usize; 2]) -> Result<Picture> {
    let side = (2 * REACH + 1) * ENLARGED;
    let pixel = |k: usize| {
        let (column, row) = (k % side, k / side);
        let at = |middle: usize, offset: usize| (middle + offset / ENLARGED).checked_sub(REACH);
        let is_worst = column / ENLARGED == REACH && row / ENLARGED == REACH;
        let is_rim = [column % ENLARGED, row % ENLARGED].iter().any(|&t| t == 0 || t == ENLARGED - 1);
        match (at(x, column), at(y, row)) {
            _ if is_worst && is_rim => FRAME,
            (Some(x), Some(y)) if x < picture.width() && y < picture.height() => picture.pixel(x, y),
            _ => [0; 3],
        }
    };
    Ok(Picture::new(side, side, (0..side * side).map(pixel).collect())?)
}
