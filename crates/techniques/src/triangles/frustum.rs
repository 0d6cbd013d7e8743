//! What a picture may show of a box, and how near.

use glam::DVec4;
use nurbs::{BezierPatch, Hull};
use scene::{Camera, Viewport};

/// The half-spaces that hold what a picture shows.
struct Frustum {
    /// A plane (n, d) has what is outside at n · p + d < 0.
    planes: [DVec4; 5],
}

/// What a pixel measures where a patch is nearest, model units; infinite out of the picture.
pub fn pixels(camera: &Camera, viewport: Viewport) -> impl Fn(&BezierPatch) -> f64 {
    let in_picture = Frustum::new(camera, viewport);
    move |patch| {
        let hull = patch.close_hull();
        if in_picture.meets(&hull) { camera.pixel_at(viewport, hull) } else { f64::INFINITY }
    }
}

/// How far beyond the picture's border what a patch shows may matter to a pixel in it, as a share of the picture.
const MARGIN: f64 = 1.0 / 16.0;

impl Frustum {
    fn new(camera: &Camera, viewport: Viewport) -> Self {
        let rows = camera.clip_from_world(viewport, 1.0).transpose();
        let [x, y, w] = [rows.x_axis, rows.y_axis, rows.w_axis];
        let wide = w * (1.0 + MARGIN);
        let near = camera.forward().extend(-camera.forward().dot(camera.eye()) - camera.near());
        Self { planes: [wide - x, wide + x, wide - y, wide + y, near] }
    }

    /// Whether a box is not wholly outside one of the planes.
    fn meets(&self, hull: &Hull) -> bool {
        let corners = hull.corners();
        self.planes.iter().all(|plane| corners.iter().any(|corner| plane.dot(corner.extend(1.0)) >= 0.0))
    }
}
