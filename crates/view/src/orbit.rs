//! A camera that is turned about what it looks at, moved along with the picture, and brought nearer.

use glam::{DQuat, DVec2, DVec3};
use scene::{Camera, Projection, SceneError, Viewport};

/// The steepest view up or down that turning reaches, degrees: beyond it the picture would tip over.
pub const STEEPEST_DEG: f64 = 89.0;

/// The camera turned about its target: by `azimuth` about `axis`, counterclockwise as seen from its tip, and `elevation` higher
/// above the horizon, radians. The axis, of unit length, points upward in the picture from then on.
///
/// Views along the axis begin to turn from where the picture's upper border points.
///
/// # Errors
/// [`SceneError`]'s camera variants, where the numbers are not finite.
pub fn turned(camera: &Camera, axis: DVec3, azimuth: f64, elevation: f64) -> Result<Camera, SceneError> {
    let offset = camera.eye() - camera.target();
    let height = offset.dot(axis);
    let steepest = STEEPEST_DEG.to_radians();
    let now = (height / offset.length()).clamp(-1.0, 1.0).asin();
    let level = offset - axis * height;
    // From above the picture's upper border points away from the viewer, from below toward them.
    let above = -camera.above() * height.signum();
    let level = if now.abs() > steepest { above - axis * above.dot(axis) } else { level };
    let Some(level) = level.try_normalize() else { return Ok(*camera) };
    let (sin, cos) = (now + elevation).clamp(-steepest, steepest).sin_cos();
    let direction = DQuat::from_axis_angle(axis, azimuth) * (level * cos) + axis * sin;
    placed(camera, camera.target() + direction * offset.length(), camera.target(), axis, camera.projection())
}

/// The camera moved so that what it looks at moves with the mouse, `by_px` to the right and down.
///
/// # Errors
/// As [`turned`].
pub fn panned(camera: &Camera, viewport: Viewport, by_px: DVec2) -> Result<Camera, SceneError> {
    let way = across(camera, viewport, by_px);
    placed(camera, camera.eye() - way, camera.target() - way, camera.up(), camera.projection())
}

/// The camera at `share` of its distance, or with that share of an orthographic picture's height. What is seen at `at`, pixels, at the
/// target's depth, stays there.
///
/// # Errors
/// As [`turned`]; a share of nought leaves no distance.
pub fn nearer(camera: &Camera, viewport: Viewport, at: DVec2, share: f64) -> Result<Camera, SceneError> {
    let Some(middle) = camera.picture(viewport, camera.target()) else { return Ok(*camera) };
    let target = camera.target() + across(camera, viewport, at - middle) * (1.0 - share);
    let offset = camera.eye() - camera.target();
    match camera.projection() {
        Projection::Perspective { .. } => {
            placed(camera, target + offset * share, target, camera.up(), camera.projection())
        }
        Projection::Orthographic { height } => {
            let projection = Projection::Orthographic { height: height * share };
            placed(camera, target + offset, target, camera.up(), projection)
        }
    }
}

/// The camera with the other kind of projection, which shows what is as far away as the target at the same size.
///
/// # Errors
/// As [`turned`].
pub fn projected(camera: &Camera, fov_deg: f64) -> Result<Camera, SceneError> {
    let offset = camera.eye() - camera.target();
    let (eye, projection) = match camera.projection() {
        Projection::Perspective { .. } => {
            (camera.eye(), Projection::Orthographic { height: 2.0 * camera.half_height() * offset.length() })
        }
        Projection::Orthographic { height } => {
            let distance = 0.5 * height / (0.5 * fov_deg.to_radians()).tan();
            (camera.target() + offset.normalize() * distance, Projection::Perspective { fov_deg })
        }
    };
    Camera::look_at(eye, camera.target(), camera.up(), projection)?.with_lens_shift(camera.lens_shift())
}

/// Whether a camera has the near plane that it would have if none were asked for.
pub fn has_usual_near(camera: &Camera) -> bool {
    let usual = Camera::look_at(camera.eye(), camera.target(), camera.up(), camera.projection());
    usual.is_ok_and(|usual| usual.near() == camera.near())
}

/// The way at the target's depth that is `by_px` long in the picture, to the right and down.
fn across(camera: &Camera, viewport: Viewport, by_px: DVec2) -> DVec3 {
    let pixels_a_unit = camera.pixels_per_unit(viewport, camera.depth(camera.target()));
    (camera.right() * by_px.x - camera.above() * by_px.y) / pixels_a_unit
}

/// The camera elsewhere, with the lens shift that it has, and with the near plane that was asked for, where one was.
fn placed(camera: &Camera, eye: DVec3, target: DVec3, up: DVec3, projection: Projection) -> Result<Camera, SceneError> {
    let moved = Camera::look_at(eye, target, up, projection)?.with_lens_shift(camera.lens_shift())?;
    if has_usual_near(camera) { Ok(moved) } else { moved.with_near(camera.near()) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_PI_2, PI};

    fn viewport() -> Viewport {
        Viewport::new(320, 200).expect("a size")
    }

    fn cameras() -> [Camera; 2] {
        let projections = [Projection::Perspective { fov_deg: 40.0 }, Projection::Orthographic { height: 3.0 }];
        projections.map(|projection| {
            let camera = Camera::look_at(DVec3::new(1.0, -7.0, 2.0), DVec3::new(1.0, 1.0, 0.5), DVec3::Z, projection);
            camera.and_then(|camera| camera.with_lens_shift(DVec2::new(0.1, -0.05))).expect("a camera")
        })
    }

    #[test]
    fn turning_keeps_the_distance_and_a_whole_turn_comes_back() {
        for camera in cameras() {
            let quarter = turned(&camera, DVec3::Z, FRAC_PI_2, 0.0).expect("a camera");
            let (before, after) = (camera.eye() - camera.target(), quarter.eye() - quarter.target());
            assert!((before.length() - after.length()).abs() < 1e-12 && (before.z - after.z).abs() < 1e-12);
            // From the front, a quarter counterclockwise from above is the right side.
            assert!(after.x > 7.9 && after.y.abs() < 1e-12, "{after}");
            let whole = (0..4).try_fold(camera, |camera, _| turned(&camera, DVec3::Z, FRAC_PI_2, 0.0));
            assert!(whole.expect("a camera").eye().distance(camera.eye()) < 1e-12);
        }
    }

    #[test]
    fn no_turn_tips_the_picture_over() {
        for camera in cameras() {
            let over = turned(&camera, DVec3::Z, 0.3, 10.0).expect("a camera");
            assert!(over.above().z > 0.0 && over.eye().z > over.target().z);
            let back = turned(&over, DVec3::Z, 0.0, -2.0 * PI).expect("a camera");
            assert!(back.above().z > 0.0 && back.eye().z < back.target().z);
        }
    }

    #[test]
    fn a_view_from_above_turns_from_where_its_upper_border_points() {
        let (eye, projection) = (DVec3::new(0.0, 0.0, 5.0), Projection::Perspective { fov_deg: 40.0 });
        let top = Camera::look_at(eye, DVec3::ZERO, DVec3::Y, projection).expect("a camera");
        let tilted = turned(&top, DVec3::Z, 0.0, -0.5).expect("a camera");
        assert!(tilted.eye().x.abs() < 1e-12 && tilted.eye().y < 0.0, "{}", tilted.eye());
        let bottom = Camera::look_at(-eye, DVec3::ZERO, DVec3::Y, projection).expect("a camera");
        let tilted = turned(&bottom, DVec3::Z, 0.0, 0.5).expect("a camera");
        assert!(tilted.eye().x.abs() < 1e-12 && tilted.eye().y > 0.0 && tilted.above().y > 0.0, "{}", tilted.eye());
    }

    #[test]
    fn what_is_looked_at_moves_with_the_mouse() {
        for camera in cameras() {
            let by = DVec2::new(31.0, -12.0);
            let panned = panned(&camera, viewport(), by).expect("a camera");
            let seen = |of: &Camera| of.picture(viewport(), camera.target()).expect("in front");
            assert!((seen(&panned) - seen(&camera)).distance(by) < 1e-9);
            assert_eq!(panned.lens_shift(), camera.lens_shift());
        }
    }

    #[test]
    fn what_is_under_the_mouse_stays_there_while_it_grows() {
        for camera in cameras() {
            let at = DVec2::new(250.0, 40.0);
            let ray = camera.ray(viewport(), at.x, at.y);
            let depth = camera.depth(camera.target());
            let place = ray.at(depth / ray.direction.dot(camera.forward()));
            let near = nearer(&camera, viewport(), at, 0.5).expect("a camera");
            assert!(near.picture(viewport(), place).expect("in front").distance(at) < 1e-9);
            let size = |of: &Camera| of.pixels_per_unit(viewport(), of.depth(place));
            assert!((size(&near) / size(&camera) - 2.0).abs() < 1e-12);
        }
    }

    #[test]
    fn the_other_projection_shows_the_target_as_large() {
        for camera in cameras() {
            let other = projected(&camera, 40.0).expect("a camera");
            let size = |of: &Camera| of.pixels_per_unit(viewport(), of.depth(of.target()));
            assert!((size(&other) / size(&camera) - 1.0).abs() < 1e-12);
            assert_ne!(other.projection(), camera.projection());
        }
    }

    #[test]
    fn a_near_plane_that_was_asked_for_stays() {
        for camera in cameras() {
            assert!(
                has_usual_near(&camera) && has_usual_near(&nearer(&camera, viewport(), DVec2::ZERO, 0.1).expect("one"))
            );
            let asked = camera.with_near(0.25).expect("a plane");
            assert_eq!(nearer(&asked, viewport(), DVec2::ZERO, 0.1).expect("a camera").near(), 0.25);
        }
    }
}
