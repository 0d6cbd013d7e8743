//! Pictures whose colours follow from the normal and from where the eye is.

use anyhow::Result;
use gbuffer::{GBuffer, Hit, Picture, background, unorm8};
use glam::DVec3;
use rayon::prelude::*;
use scene::Camera;

/// Where the surface has no normal, as in other shadings.
const UNDEFINED: [f32; 3] = [1.0, 0.0, 1.0];

/// The picture of a buffer; `colour` is asked of a normal and of the ray that the pixel sees along, world, of unit length.
///
/// # Errors
/// None: it is of the buffer's size.
pub fn coloured(
    buffer: &GBuffer,
    camera: &Camera,
    colour: impl Fn(DVec3, DVec3) -> [f32; 3] + Sync,
) -> Result<Picture> {
    let viewport = buffer.viewport();
    let of = |x: usize, y: usize, hit: &Hit| match hit.normal.unit() {
        Some(n) => colour(n, camera.ray(viewport, x as f64 + 0.5, y as f64 + 0.5).direction),
        None => UNDEFINED,
    };
    let pixel = |i: usize| {
        let (x, y) = (i % viewport.width(), i / viewport.width());
        buffer.get(x, y).map_or_else(background, |hit| unorm8(of(x, y, hit)))
    };
    let rgb = (0..viewport.pixels()).into_par_iter().map(pixel).collect();
    Ok(Picture::new(viewport.width(), viewport.height(), rgb)?)
}
