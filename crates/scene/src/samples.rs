//! Where in a pixel a picture is sampled, and a camera for each of these places.
//!
//! Anti-aliasing by whole pictures: each sample is a picture of its own, taken by the same camera with its lens shifted by
//! a part of a pixel, and evaluated exactly where it is. Nothing that renders or judges needs to know of it, and two faces
//! that share an edge cover each sample once: what is behind them does not show through, as it does where each is blended
//! by a share of its own (Porter & Duff 1984, on coverage taken for opacity).

use crate::{Camera, Viewport};
use glam::DVec2;

/// How many samples a pixel has, and where: the standard sample locations of Vulkan (1.3, section 28.3, Multisampling:
/// `standardSampleLocations`), which are Direct3D's standard patterns too, and for 4 those of WebGPU.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum SamplePattern {
    /// The pixel's centre.
    #[default]
    One,
    /// 4 samples.
    Four,
    /// 8 samples.
    Eight,
    /// 16 samples; their mean is 1/32 pixel left of the centre and above, as published.
    Sixteen,
}

impl SamplePattern {
    /// All patterns.
    pub const ALL: [Self; 4] = [Self::One, Self::Four, Self::Eight, Self::Sixteen];

    /// The samples' places in the pixel, from its top left corner, right and down, in pixels, 0 to 1; in the order in
    /// which samples are numbered, from 0.
    pub fn positions(self) -> &'static [[f64; 2]] {
        match self {
            Self::One => &[[0.5, 0.5]],
            Self::Four => &[[0.375, 0.125], [0.875, 0.375], [0.125, 0.625], [0.625, 0.875]],
            Self::Eight => &[
                [0.5625, 0.3125],
                [0.4375, 0.6875],
                [0.8125, 0.5625],
                [0.3125, 0.1875],
                [0.1875, 0.8125],
                [0.0625, 0.4375],
                [0.6875, 0.9375],
                [0.9375, 0.0625],
            ],
            Self::Sixteen => &[
                [0.5625, 0.5625],
                [0.4375, 0.3125],
                [0.3125, 0.625],
                [0.75, 0.4375],
                [0.1875, 0.375],
                [0.625, 0.8125],
                [0.8125, 0.6875],
                [0.6875, 0.1875],
                [0.375, 0.875],
                [0.5, 0.0625],
                [0.25, 0.125],
                [0.125, 0.75],
                [0.0, 0.5],
                [0.9375, 0.25],
                [0.875, 0.9375],
                [0.0625, 0.0],
            ],
        }
    }

    /// A camera a sample, in the order of [`Self::positions`], whose pixels' centres see what `camera` sees at that place of
    /// each pixel.
    pub fn cameras(self, camera: &Camera, viewport: Viewport) -> Vec<Camera> {
        let shifted = |&[x, y]: &[f64; 2]| {
            let shift = DVec2::new(x - 0.5, 0.5 - y) / viewport.height() as f64;
            camera.with_lens_shift(camera.lens_shift() + shift).expect("less than a picture off a finite shift")
        };
        self.positions().iter().map(shifted).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Projection;
    use glam::DVec3;

    #[test]
    fn each_sample_has_a_row_and_a_column_of_its_own() {
        for (pattern, count) in SamplePattern::ALL.into_iter().zip([1, 4, 8, 16]) {
            let positions = pattern.positions();
            assert_eq!(positions.len(), count);
            for axis in [0, 1] {
                let mut strips: Vec<usize> = positions.iter().map(|p| (p[axis] * count as f64) as usize).collect();
                strips.sort_unstable();
                assert_eq!(strips, (0..count).collect::<Vec<_>>(), "{pattern:?}");
            }
        }
    }

    #[test]
    fn a_samples_camera_sees_at_the_centre_what_is_at_the_samples_place() {
        let viewport = Viewport::new(320, 200).unwrap();
        for projection in [Projection::Perspective { fov_deg: 50.0 }, Projection::Orthographic { height: 3.0 }] {
            let camera = Camera::look_at(DVec3::new(3.0, -4.0, 2.0), DVec3::ZERO, DVec3::Z, projection).unwrap();
            let camera = camera.with_lens_shift(DVec2::new(-0.01, 0.2)).unwrap();
            assert_eq!(SamplePattern::One.cameras(&camera, viewport), [camera]);
            for pattern in SamplePattern::ALL {
                for (sample, [x, y]) in pattern.cameras(&camera, viewport).iter().zip(pattern.positions()) {
                    let seen = sample.ray(viewport, 17.5, 42.5);
                    let expected = camera.ray(viewport, 17.0 + x, 42.0 + y);
                    assert!(seen.origin.distance(expected.origin) < 1e-14);
                    assert!(seen.direction.distance(expected.direction) < 1e-14);
                }
            }
        }
    }
}
