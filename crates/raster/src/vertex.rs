//! The vertex stage and the viewport transform: from a proxy's corners to picture positions.
//!
//! [`clip_position`] is the twin of `vertex` in `shaders/entry.wgsl`. What follows it here is fixed function on a GPU:
//! the division by w and the map to pixels, in f32, each operation rounded once.

use pipeline::View;
use scene::Viewport;

/// Clip coordinates of a local position, in the operation order of the WGSL vertex stage.
pub fn clip_position(view: &View, position: [f32; 3]) -> [f32; 4] {
    let m = &view.clip_from_local;
    let [x, y, z] = position;
    std::array::from_fn(|i| m[0][i] * x + m[1][i] * y + m[2][i] * z + m[3][i])
}

/// A corner as setup takes it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Corner {
    /// Position in the picture, pixels from the top left corner, not snapped.
    pub position: [f32; 2],
    /// z / w: 1 at the near plane, less behind it.
    pub depth: f32,
    /// 1 / w.
    pub inverse_w: f32,
}

/// Half the viewport's width and height, pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Screen {
    half: [f32; 2],
}

impl Screen {
    /// The map of a viewport.
    pub fn new(viewport: Viewport) -> Self {
        // A side is at most 2^14, so half of it is exact.
        Self { half: [viewport.width() as f32 * 0.5, viewport.height() as f32 * 0.5] }
    }

    /// Divides by w and maps to pixels, y down. `None` unless w is positive and all that comes out is finite: what
    /// clipping lets through is, unless clip coordinates overflow f32.
    pub fn corner(&self, clip: [f32; 4]) -> Option<Corner> {
        let [x, y, z, w] = clip;
        if w <= 0.0 {
            return None;
        }
        let position = [self.half[0] + self.half[0] * (x / w), self.half[1] - self.half[1] * (y / w)];
        let corner = Corner { position, depth: z / w, inverse_w: 1.0 / w };
        let finite = [position[0], position[1], corner.depth, corner.inverse_w].iter().all(|c| c.is_finite());
        finite.then_some(corner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clip_space_maps_to_pixels_with_row_zero_on_top() {
        let screen = Screen::new(Viewport::new(300, 100).unwrap());
        let corner = |clip| screen.corner(clip).unwrap();
        assert_eq!(corner([-2.0, 2.0, 1.0, 2.0]).position, [0.0, 0.0]);
        assert_eq!(corner([2.0, -2.0, 1.0, 2.0]).position, [300.0, 100.0]);
        assert_eq!(corner([0.0, 0.0, 1.0, 2.0]), Corner { position: [150.0, 50.0], depth: 0.5, inverse_w: 0.5 });
    }

    #[test]
    fn a_corner_behind_the_eye_or_beyond_f32_is_none() {
        let screen = Screen::new(Viewport::new(8, 8).unwrap());
        for clip in [[0.0, 0.0, 1.0, -1.0], [1.0, 0.0, 0.0, 0.0], [1e30, 0.0, 0.0, 1e-30], [f32::NAN, 0.0, 0.0, 1.0]] {
            assert_eq!(screen.corner(clip), None);
        }
    }
}
