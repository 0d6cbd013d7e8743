//! What a surface mirrors: a colour for each direction that the eye is sent to.

use super::by_view::coloured;
use anyhow::Result;
use gbuffer::{GBuffer, Picture};
use glam::DVec3;
use scene::Camera;

/// A picture of the mirrored view. `colour` is asked for directions of unit length, world, from the surface outward.
/// Mirrored at either normal a view is the same.
///
/// # Errors
/// None: the picture is of the buffer's size.
pub fn mirrored(buffer: &GBuffer, camera: &Camera, colour: impl Fn(DVec3) -> [f32; 3] + Sync) -> Result<Picture> {
    coloured(buffer, camera, |n, view| colour(view - 2.0 * view.dot(n) * n))
}
