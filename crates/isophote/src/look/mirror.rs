//! What a surface mirrors: a colour for each direction that the eye is sent to.

use anyhow::Result;
use gbuffer::{GBuffer, Hit, Picture, background, unorm8};
use glam::DVec3;
use rayon::prelude::*;
use scene::Camera;

/// Where the surface has no normal, as in other shadings.
const UNDEFINED: [f32; 3] = [1.0, 0.0, 1.0];

/// A picture of the mirrored view. `colour` is asked for directions of unit length, world, from the surface outward.
/// Mirrored at either normal a view is the same.
///
/// # Errors
/// None: the picture is of the buffer's size.
pub fn mirrored(buffer: &GBuffer, camera: &Camera, colour: impl Fn(DVec3) -> [f32; 3] + Sync) -> Result<Picture> {
    let viewport = buffer.viewport();
    let of = |x: usize, y: usize, hit: &Hit| {
        let Some(n) = hit.normal.unit() else { return UNDEFINED };
        let view = camera.ray(viewport, x as f64 + 0.5, y as f64 + 0.5).direction;
        colour(view - 2.0 * view.dot(n) * n)
    };
    let pixel = |i: usize| {
        let (x, y) = (i % viewport.width(), i / viewport.width());
        buffer.get(x, y).map_or_else(background, |hit| unorm8(of(x, y, hit)))
    };
    let rgb = (0..viewport.pixels()).into_par_iter().map(pixel).collect();
    Ok(Picture::new(viewport.width(), viewport.height(), rgb)?)
}
