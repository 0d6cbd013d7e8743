//! The picture that lines are drawn for: how large a piece of a surface is in it, and whether it is there at all.

use glam::DVec3;
use nurbs::Hull;
use scene::{Camera, Viewport};

/// A camera, its picture, and how far a chord may be from its line there.
#[derive(Debug, Clone, Copy)]
pub struct Frame {
    /// From where.
    pub camera: Camera,
    /// How large the picture is.
    pub viewport: Viewport,
    /// Pixels.
    pub tolerance: f64,
}

/// Ends that are so far apart are joined, in tolerances.
const JOINT: f64 = 2.0;

impl Frame {
    /// The widest gap between two ends that are joined, pixels.
    pub fn joint(&self) -> f64 {
        JOINT * self.tolerance
    }

    /// The most pixels that a model unit covers anywhere in a box, across the view; of a box that reaches the eye, as
    /// [`Camera::pixel_at`] has it.
    pub fn pixels_per_unit(&self, hull: Hull) -> f64 {
        let radius = 0.5 * hull.diagonal();
        let pixels = self.camera.pixels_within(self.viewport, hull.center(), radius) / radius;
        if pixels.is_finite() { pixels } else { 1.0 / self.camera.pixel_at(self.viewport, hull) }
    }

    /// Whether a box is out of the picture, or all behind the near plane.
    pub fn excludes(&self, hull: Hull) -> bool {
        let corners = hull.corners();
        if corners.iter().all(|corner| self.camera.depth(*corner) < self.camera.near()) {
            return true;
        }
        let Some(places) =
            corners.map(|corner| self.camera.picture(self.viewport, corner)).into_iter().collect::<Option<Vec<_>>>()
        else {
            return false;
        };
        let (width, height) = (self.viewport.width() as f64, self.viewport.height() as f64);
        places.iter().all(|p| p.x < 0.0)
            || places.iter().all(|p| p.x > width)
            || places.iter().all(|p| p.y < 0.0)
            || places.iter().all(|p| p.y > height)
    }

    /// How many pixels two points are apart in the picture; infinitely many where one is not in front of the eye.
    pub fn distance(&self, a: DVec3, b: DVec3) -> f64 {
        let [a, b] = [a, b].map(|p| self.camera.picture(self.viewport, p));
        a.zip(b).map_or(f64::INFINITY, |(a, b)| a.distance(b))
    }
}
