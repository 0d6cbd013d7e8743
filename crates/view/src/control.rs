//! Control points under the mouse: which one is meant, and where a drag takes it.

use glam::DVec2;
use nurbs::{NurbsError, Surface};
use scene::{Camera, Viewport};

/// The control point, as its indices in u and v, that is seen nearest to `at`, pixels, and no farther from it than `within_px`.
///
/// Of several at one place the first is meant. Points that the camera does not see in front of it are left out.
pub fn nearest(
    surface: &Surface,
    camera: &Camera,
    viewport: Viewport,
    at: DVec2,
    within_px: f64,
) -> Option<[usize; 2]> {
    let columns = surface.control_counts()[1];
    let distances = surface.points().iter().enumerate().filter_map(|(k, point)| {
        let (seen, _) = camera.project(viewport, *point)?;
        Some(([k / columns, k % columns], seen.distance(at)))
    });
    let near = distances.filter(|(_, distance)| *distance <= within_px);
    near.min_by(|(_, a), (_, b)| a.total_cmp(b)).map(|(index, _)| index)
}

/// The surface with a control point moved as far as the mouse, `by_px` to the right and down, at the point's own depth: it stays
/// under the mouse, in the plane through it that is parallel to the picture.
///
/// # Errors
/// [`NurbsError`] where the place is none for a control point.
pub fn pulled(
    surface: &Surface,
    index: [usize; 2],
    camera: &Camera,
    viewport: Viewport,
    by_px: DVec2,
) -> Result<Surface, NurbsError> {
    let point = surface.points()[index[0] * surface.control_counts()[1] + index[1]];
    let pixels_a_unit = camera.pixels_per_unit(viewport, camera.depth(point));
    let way = (camera.right() * by_px.x - camera.above() * by_px.y) / pixels_a_unit;
    surface.with_point(index, point + way)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pulled_point_stays_under_the_mouse_and_alone_moves() {
        let model = models::builtin("teapot").expect("built in");
        let viewport = Viewport::new(320, 240).expect("a size");
        let camera = Camera::framing(&model, viewport);
        let surface = &model.surfaces()[0];
        let seen = |surface: &Surface, [i, j]: [usize; 2]| {
            camera.project(viewport, surface.points()[i * surface.control_counts()[1] + j]).expect("in front").0
        };
        let meant = [1, 2];
        let (at, by) = (seen(surface, meant), DVec2::new(17.0, -9.0));
        let found = nearest(surface, &camera, viewport, at + DVec2::new(0.3, -0.2), 2.0).expect("one is near");
        assert!(seen(surface, found).distance(at) < 1.0);
        let edited = pulled(surface, meant, &camera, viewport, by).expect("a place");
        assert!(seen(&edited, meant).distance(at + by) < 1e-9);
        assert_eq!(edited.points().iter().zip(surface.points()).filter(|(a, b)| a != b).count(), 1);
        assert_eq!(nearest(surface, &camera, viewport, DVec2::new(-500.0, 0.0), 12.0), None);
    }
}
