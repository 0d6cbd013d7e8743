//! How a camera sees the faces of a packed scene.

use super::scene::PackedScene;
use crate::layout::View;
use glam::{DMat4, DVec3};
use nurbs::power_of_two;
use scene::{Camera, Model, Projection, Viewport};

impl PackedScene {
    /// How each face is seen by a camera.
    pub fn views(&self, model: &Model, camera: &Camera, viewport: Viewport) -> Vec<View> {
        let hull = model.hull();
        let farthest = hull.corners().iter().fold(camera.near(), |far: f64, corner| far.max(camera.depth(*corner)));
        // Twice the depth needed, so that no rounding pushes the farthest point behind the far plane.
        let range = 2.0 * (farthest - camera.near()).max(hull.diagonal()).max(f64::MIN_POSITIVE);
        let clip_from_world = camera.clip_from_world(viewport, range);
        let perspective = matches!(camera.projection(), Projection::Perspective { .. });
        let matrices: Vec<DMat4> = self
            .frames()
            .iter()
            .map(|frame| {
                let world_from_local =
                    DMat4::from_translation(frame.origin) * DMat4::from_scale(DVec3::splat(frame.scale));
                clip_from_world * world_from_local
            })
            .collect();
        // Homogeneous coordinates are any multiple: one that f32 holds, whatever the scale of the scene, and the same for all
        // faces, so that a triangle may have corners in the coordinates of several.
        let greatest = |matrix: &DMat4| matrix.to_cols_array().iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        let unit = power_of_two(matrices.iter().map(greatest).fold(0.0, f64::max));
        self.frames()
            .iter()
            .zip(matrices)
            .map(|(frame, matrix)| {
                let clip_from_local = matrix * (1.0 / unit);
                let eye = if perspective {
                    ((camera.eye() - frame.origin) / frame.scale).extend(1.0)
                } else {
                    camera.forward().extend(0.0)
                };
                View {
                    clip_from_local: clip_from_local.to_cols_array_2d().map(|column| column.map(|x| x as f32)),
                    eye: eye.to_array().map(|x| x as f32),
                    units: [
                        (1.0 / frame.scale) as f32,
                        viewport.width() as f32 * 0.5,
                        viewport.height() as f32 * 0.5,
                        (unit / (camera.pixels_per_unit(viewport, 1.0) * frame.scale)) as f32,
                    ],
                }
            })
            .collect()
    }
}
