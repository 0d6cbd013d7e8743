//! From the words of four targets to fragments, and from fragments to the hits of a G-buffer.

use crate::GpuError;
use crate::readback::Record;
use gbuffer::{GBuffer, Hit, Meta};
use pipeline::PackedFrame;
use pipeline::fragment::Fragment;
use scene::{Camera, Viewport};

/// Pixels a word of the marks of [`undecided`].
const WORD: usize = 32;

/// What is known of a picture beside what its targets hold.
pub(crate) struct Seen<'a> {
    /// How each face's numbers become the model's.
    pub(crate) frames: &'a [PackedFrame],
    /// Whether hits have curvatures.
    pub(crate) curvature: bool,
    /// Whether trim edges were looked for.
    pub(crate) edges: bool,
    /// Who looks.
    pub(crate) camera: &'a Camera,
    /// At how many pixels.
    pub(crate) viewport: Viewport,
}

impl Seen<'_> {
    /// The G-buffer of what `row` returns of each row, from the top.
    ///
    /// # Errors
    /// Those of `row`.
    pub(crate) fn gbuffer(
        &self,
        meta: Meta,
        mut row: impl FnMut(usize) -> Result<Vec<Option<Fragment>>, GpuError>,
    ) -> Result<GBuffer, GpuError> {
        let mut failure = None;
        let hits = (0..self.viewport.height()).map(|y| {
            let fragments = if failure.is_none() { row(y) } else { Ok(vec![]) };
            let mut fragments = fragments.unwrap_or_else(|error| {
                failure = Some(error);
                vec![]
            });
            // After a failure nothing is returned; a row must be as wide all the same.
            fragments.resize(self.viewport.width(), None);
            let hit = |(x, fragment): (usize, Option<Fragment>)| fragment.map(|fragment| self.hit(&fragment, x, y));
            fragments.into_iter().enumerate().map(hit).collect()
        });
        let buffer = GBuffer::from_rows(self.viewport, meta, hits).with_edges(self.edges);
        failure.map_or(Ok(buffer), Err)
    }

    fn hit(&self, fragment: &Fragment, x: usize, y: usize) -> Hit {
        let ray = self.camera.ray(self.viewport, x as f64 + 0.5, y as f64 + 0.5);
        let hit = self.frames[fragment.face as usize].hit(fragment, &ray);
        Hit { curvature: hit.curvature.filter(|_| self.curvature), ..hit }
    }
}

/// The fragments of row `y` of four targets, of a scene of so many faces, with edges or without. A row has at least as many
/// texels of four words as the picture is wide.
///
/// # Errors
/// [`GpuError::Malformed`] where a pixel shows a face that is none, [`GpuError::NotCleared`].
pub(crate) fn fragments(
    targets: [&[u32]; 4],
    y: usize,
    viewport: Viewport,
    (faces, edges): (usize, bool),
) -> Result<Vec<Option<Fragment>>, GpuError> {
    let word = |target: usize, x: usize| -> [u32; 4] { std::array::from_fn(|i| targets[target][4 * x + i]) };
    let float = |target: usize, x: usize| word(target, x).map(f32::from_bits);
    let pixel = |x: usize| {
        let record = Record { identity: word(0, x), position: float(1, x), normal: float(2, x), shape: float(3, x) };
        record.pixel(x, y, faces, edges)
    };
    (0..viewport.width()).map(pixel).collect()
}

/// Bytes of the marks of a picture.
pub(crate) fn marks(viewport: Viewport) -> usize {
    4 * viewport.pixels().div_ceil(WORD)
}

/// The pixels (x, y) whose marks are set: pixel k, row-major from the top, is bit k % 32 of word k / 32.
pub(crate) fn undecided(words: &[u32], viewport: Viewport) -> Vec<(usize, usize)> {
    let is_set = |pixel: &usize| words[pixel / WORD] >> (pixel % WORD) & 1 == 1;
    let width = viewport.width();
    (0..viewport.pixels()).filter(is_set).map(|pixel| (pixel % width, pixel / width)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_are_counted_row_by_row_from_the_lowest_bit() {
        let viewport = Viewport::new(20, 3).unwrap();
        assert_eq!(marks(viewport), 8);
        assert_eq!(undecided(&[1 << 3 | 1 << 21, 1 << 8], viewport), [(3, 0), (1, 1), (0, 2)]);
    }
}
