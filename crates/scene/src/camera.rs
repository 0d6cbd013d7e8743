//! Look-at cameras: a ray for every point of the picture, and the way back.

use crate::{Model, SceneError, Viewport};
use glam::{DMat4, DVec2, DVec3, DVec4};
use nurbs::Hull;
use serde::{Deserialize, Serialize};

/// Full vertical field of view of the default camera, degrees.
const DEFAULT_FOV: f64 = 40.0;

/// Direction from the model to the default eye: a three-quarter view from the front right, above.
const DEFAULT_DIRECTION: DVec3 = DVec3::new(1.0, -1.6, 0.9);

/// How much farther than needed to hold the model the default eye stands.
const DEFAULT_MARGIN: f64 = 1.03;

/// Near distance of a perspective camera as a share of its distance from the target, unless one is given.
const DEFAULT_NEAR: f64 = 1.0 / 1024.0;

/// A box that reaches the near plane counts as this share of its diagonal away, where pixels are measured on it.
const NEAREST_SHARE: f64 = 1.0 / 16.0;

/// A line of sight: `origin + t direction` for t from 0, `direction` of unit length, t in model units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ray {
    /// Where t = 0: on the eye (perspective) or on the eye's plane (orthographic).
    pub origin: DVec3,
    /// Unit direction.
    pub direction: DVec3,
    /// Nothing nearer than this t is seen.
    pub near: f64,
}

impl Ray {
    /// The point at distance `t`.
    pub fn at(&self, t: f64) -> DVec3 {
        self.origin + self.direction * t
    }
}

/// How depth becomes size.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Projection {
    /// Full vertical angle in degrees.
    Perspective {
        /// The angle.
        fov_deg: f64,
    },
    /// Height of the picture in model units.
    Orthographic {
        /// The height.
        height: f64,
    },
}

/// A right-handed look-at camera.
///
/// Serialises to `eye`, `target`, `up`, `projection`, `near` and, unless it is zero, `lens_shift`, and is read back from
/// them by [`Self::look_at`], [`Self::with_near`] and [`Self::with_lens_shift`], bit for bit; `near` and `lens_shift` may
/// be absent.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "CameraText")]
pub struct Camera {
    eye: DVec3,
    target: DVec3,
    up: DVec3,
    projection: Projection,
    near: f64,
    /// Right and up, in heights of the picture.
    #[serde(skip_serializing_if = "is_zero")]
    lens_shift: DVec2,
    #[serde(skip)]
    right: DVec3,
    #[serde(skip)]
    above: DVec3,
    #[serde(skip)]
    forward: DVec3,
    /// Half the picture's height at distance 1 (perspective) or anywhere (orthographic).
    #[serde(skip)]
    half_height: f64,
}

/// Cameras without a lens shift are written as before there were any, so that files keep their bytes.
fn is_zero(shift: &DVec2) -> bool {
    *shift == DVec2::ZERO
}

/// A camera as it stands in a file.
#[derive(Deserialize)]
struct CameraText {
    eye: DVec3,
    target: DVec3,
    up: DVec3,
    projection: Projection,
    near: Option<f64>,
    #[serde(default)]
    lens_shift: DVec2,
}

impl TryFrom<CameraText> for Camera {
    type Error = SceneError;

    fn try_from(text: CameraText) -> Result<Self, SceneError> {
        let CameraText { eye, target, up, projection, near, lens_shift } = text;
        let camera = Self::look_at(eye, target, up, projection)?.with_lens_shift(lens_shift)?;
        near.map_or(Ok(camera), |near| camera.with_near(near))
    }
}

impl Camera {
    /// A camera at `eye` that looks at `target`; `up` points upward in the picture.
    ///
    /// The near plane lies at 1/1024 of the distance to the target (perspective) or at the eye's plane
    /// (orthographic); see [`Self::with_near`]. There is no lens shift.
    ///
    /// # Errors
    /// [`SceneError`]'s camera variants, naming the value.
    pub fn look_at(eye: DVec3, target: DVec3, up: DVec3, projection: Projection) -> Result<Self, SceneError> {
        for (name, v) in [("eye", eye), ("target", target), ("up vector", up)] {
            if let Some(value) = v.to_array().into_iter().find(|x| !x.is_finite()) {
                return Err(SceneError::CameraNotFinite { name, value });
            }
        }
        let offset = target - eye;
        if !offset.is_finite() {
            return Err(SceneError::CameraNotFinite { name: "way from eye to target", value: f64::INFINITY });
        }
        let Some((forward, distance)) = unit(offset) else {
            return Err(SceneError::EyeIsTarget { at: eye.to_array() });
        };
        let right = forward.cross(unit(up).map_or(DVec3::ZERO, |(up, _)| up));
        // The sine of the angle between view and up: below a millionth the picture's roll is noise.
        if right.length() <= 1e-6 {
            return Err(SceneError::UpIsParallel { up: up.to_array() });
        }
        let right = right.normalize();
        let (half_height, near) = match projection {
            Projection::Perspective { fov_deg } => {
                if !(fov_deg > 0.0 && fov_deg < 180.0) {
                    return Err(SceneError::FieldOfView { degrees: fov_deg });
                }
                // libm's tangent, so that pictures do not depend on the platform's.
                (libm::tan(fov_deg.to_radians() / 2.0), distance * DEFAULT_NEAR)
            }
            Projection::Orthographic { height } => {
                if !(height > 0.0 && height.is_finite()) {
                    return Err(SceneError::OrthographicHeight { height });
                }
                (height / 2.0, 0.0)
            }
        };
        let above = right.cross(forward);
        let lens_shift = DVec2::ZERO;
        Ok(Self { eye, target, up, projection, near, lens_shift, right, above, forward, half_height })
    }

    /// The same camera with the near plane at depth `near`, in model units along the view direction.
    ///
    /// # Errors
    /// [`SceneError::Near`] unless it is positive (perspective) or not negative (orthographic), and finite.
    pub fn with_near(self, near: f64) -> Result<Self, SceneError> {
        let orthographic = matches!(self.projection, Projection::Orthographic { .. });
        if !near.is_finite() || near < 0.0 || (near == 0.0 && !orthographic) {
            return Err(SceneError::Near { near });
        }
        Ok(Self { near, ..self })
    }

    /// The same camera with its picture moved by `shift` in its own plane, right and up, in heights of the picture, as a
    /// photographer shifts a lens: the frustum is off the view's axis, and nothing turns.
    ///
    /// What an unshifted camera shows in the picture's middle is `shift` left of it and below. A positive shift of
    /// 1 / height to the right shows in each pixel what its right neighbour showed.
    ///
    /// # Errors
    /// [`SceneError::CameraNotFinite`].
    pub fn with_lens_shift(self, shift: DVec2) -> Result<Self, SceneError> {
        match shift.to_array().into_iter().find(|x| !x.is_finite()) {
            Some(value) => Err(SceneError::CameraNotFinite { name: "lens shift", value }),
            None => Ok(Self { lens_shift: shift, ..self }),
        }
    }

    /// A camera that frames `model` from the front right, above: along (−1, 1.6, −0.9), z up, 40° high, 3 % farther than
    /// holds all that is seen, which it has in the picture's middle.
    pub fn framing(model: &Model, viewport: Viewport) -> Self {
        Self::framing_from(model, viewport, DEFAULT_DIRECTION).expect("a direction that is not straight along z")
    }

    /// As [`Self::framing`], from another side: `direction` is that from the model to the eye, of any length. z is up; along z
    /// itself, y is.
    ///
    /// # Errors
    /// [`SceneError`]'s camera variants, where the direction is zero or not finite.
    pub fn framing_from(model: &Model, viewport: Viewport, direction: DVec3) -> Result<Self, SceneError> {
        let Some(direction) = direction.try_normalize() else {
            return Self::look_at(direction, DVec3::ZERO, DVec3::Z, Projection::Perspective { fov_deg: DEFAULT_FOV });
        };
        let up = if direction.x == 0.0 && direction.y == 0.0 { DVec3::Y } else { DVec3::Z };
        let forward = -direction;
        let right = forward.cross(up).normalize();
        let above = right.cross(forward);
        let k = libm::tan(DEFAULT_FOV.to_radians() / 2.0);
        let (extent, center) = (model.extent(), model.hull().center());
        // With the eye at c − d forward + x right, a point q from c is left of the picture's right border where
        // q · (right / k − forward) ≤ d + x / k; and so on for the other three.
        let frame = |across: DVec3, k: f64| {
            let reach = |along: DVec3| extent.reach(along) - center.dot(along);
            let (one, other) = (reach(across / k - forward), reach(-across / k - forward));
            (0.5 * (one + other), 0.5 * k * (one - other))
        };
        let [(by_width, x), (by_height, y)] = [frame(right, k * viewport.aspect()), frame(above, k)];
        // A model of a single point has no size, or less than its coordinates can tell; any distance shows it.
        let least = 16.0 * f64::EPSILON * center.abs().max_element();
        let distance = by_width.max(by_height);
        let distance = if distance > least { distance } else { 1.0f64.max(2.0 * least) };
        let target = center + x * right + y * above;
        let eye = target + direction * distance * DEFAULT_MARGIN;
        Self::look_at(eye, target, up, Projection::Perspective { fov_deg: DEFAULT_FOV })
    }

    /// Where the camera stands.
    pub fn eye(&self) -> DVec3 {
        self.eye
    }

    /// The point that the camera looks at.
    pub fn target(&self) -> DVec3 {
        self.target
    }

    /// What points upward in the picture, as it was given: of any length.
    pub fn up(&self) -> DVec3 {
        self.up
    }

    /// Unit view direction.
    pub fn forward(&self) -> DVec3 {
        self.forward
    }

    /// Unit vector to the right in the picture.
    pub fn right(&self) -> DVec3 {
        self.right
    }

    /// Unit vector upward in the picture.
    pub fn above(&self) -> DVec3 {
        self.above
    }

    /// Half the picture's height at distance 1 (perspective) or anywhere (orthographic), model units.
    pub fn half_height(&self) -> f64 {
        self.half_height
    }

    /// How depth becomes size.
    pub fn projection(&self) -> Projection {
        self.projection
    }

    /// Depth of the near plane, model units.
    pub fn near(&self) -> f64 {
        self.near
    }

    /// How far the picture is moved in its own plane, right and up, in heights of the picture.
    pub fn lens_shift(&self) -> DVec2 {
        self.lens_shift
    }

    /// The ray through picture position (x, y), in pixels from the top left corner; a pixel's centre is at + ½.
    pub fn ray(&self, viewport: Viewport, x: f64, y: f64) -> Ray {
        let [shift_right, shift_up] = (2.0 * self.lens_shift).to_array();
        let across = ((2.0 * x / viewport.width() as f64 - 1.0) * viewport.aspect() + shift_right) * self.half_height;
        let up = (1.0 - 2.0 * y / viewport.height() as f64 + shift_up) * self.half_height;
        let offset = across * self.right + up * self.above;
        match self.projection {
            Projection::Perspective { .. } => {
                let direction = (self.forward + offset).normalize();
                Ray { origin: self.eye, direction, near: self.near / direction.dot(self.forward) }
            }
            Projection::Orthographic { .. } => {
                Ray { origin: self.eye + offset, direction: self.forward, near: self.near }
            }
        }
    }

    /// Depth of a world point along the view direction, model units.
    pub fn depth(&self, p_world: DVec3) -> f64 {
        (p_world - self.eye).dot(self.forward)
    }

    /// Picture position of a world point, in pixels, and its depth along the view direction.
    ///
    /// `None` where the point is not in front of the near plane.
    pub fn project(&self, viewport: Viewport, p_world: DVec3) -> Option<(DVec2, f64)> {
        let depth = self.depth(p_world);
        let picture = self.picture(viewport, p_world)?;
        (depth >= self.near).then_some((picture, depth))
    }

    /// Picture position of a world point, in pixels, whatever the near plane.
    ///
    /// `None` where a perspective camera has it beside or behind it.
    pub fn picture(&self, viewport: Viewport, p_world: DVec3) -> Option<DVec2> {
        let q = p_world - self.eye;
        let depth = q.dot(self.forward);
        if depth <= 0.0 && matches!(self.projection, Projection::Perspective { .. }) {
            return None;
        }
        let scale = self.pixels_per_unit(viewport, depth);
        let shift_px = self.lens_shift * viewport.height() as f64;
        let x = 0.5 * viewport.width() as f64 - shift_px.x + q.dot(self.right) * scale;
        let y = 0.5 * viewport.height() as f64 + shift_px.y - q.dot(self.above) * scale;
        Some(DVec2::new(x, y))
    }

    /// By how many pixels the picture of a point in front of the eye moves, x to the right and y down, for each model unit
    /// that the point moves along `direction`, as a derivative.
    pub fn picture_derivative(&self, viewport: Viewport, p_world: DVec3, direction: DVec3) -> DVec2 {
        let q = p_world - self.eye;
        let depth = q.dot(self.forward);
        // In perspective what recedes moves toward the picture's middle.
        let recedes = match self.projection {
            Projection::Perspective { .. } => direction.dot(self.forward) / depth,
            Projection::Orthographic { .. } => 0.0,
        };
        let across = direction - q * recedes;
        DVec2::new(across.dot(self.right), -across.dot(self.above)) * self.pixels_per_unit(viewport, depth)
    }

    /// The most pixels by which the pictures of two points can differ that are `radius` model units apart, one of
    /// them at `p_world`.
    ///
    /// Perspective: the derivative of the projection has the norm f / (z cos θ), θ from the view's axis; z and θ are
    /// taken at their worst within the radius. Infinite where the radius reaches the eye's plane.
    pub fn pixels_within(&self, viewport: Viewport, p_world: DVec3, radius: f64) -> f64 {
        match self.projection {
            Projection::Orthographic { .. } => radius * self.pixels_per_unit(viewport, 1.0),
            Projection::Perspective { .. } => {
                let q = p_world - self.eye;
                let nearest = self.depth(p_world) - radius;
                if nearest <= 0.0 {
                    return f64::INFINITY;
                }
                let across = (q - self.forward * q.dot(self.forward)).length() + radius;
                radius * self.pixels_per_unit(viewport, nearest) * (1.0 + (across / nearest).powi(2)).sqrt()
            }
        }
    }

    /// Pixels that a model unit across the view covers at `depth` (positive, for a perspective camera).
    pub fn pixels_per_unit(&self, viewport: Viewport, depth: f64) -> f64 {
        let half = 0.5 * viewport.height() as f64 / self.half_height;
        match self.projection {
            Projection::Perspective { .. } => half / depth,
            Projection::Orthographic { .. } => half,
        }
    }

    /// Model units that a pixel covers at the nearest depth of a box: what a chord error in pixels is measured in.
    ///
    /// A box that reaches the near plane is taken to begin there, and at 1/16 of its diagonal at least: a camera inside
    /// it would ask for any number of triangles.
    pub fn pixel_at(&self, viewport: Viewport, hull: Hull) -> f64 {
        let nearest = hull.corners().iter().fold(f64::INFINITY, |near: f64, corner| near.min(self.depth(*corner)));
        let nearest = nearest.max(self.near).max(hull.diagonal() * NEAREST_SHARE);
        1.0 / self.pixels_per_unit(viewport, nearest.max(f64::MIN_POSITIVE))
    }

    /// Clip coordinates from world coordinates, for depth that grows toward the eye ("reversed z").
    ///
    /// Perspective: z / w = near / depth, from 1 at the near plane to 0 at infinity. Orthographic:
    /// 1 − (depth − near) / `range`, so `range` must be at least the depth of the farthest point drawn.
    pub fn clip_from_world(&self, viewport: Viewport, range: f64) -> DMat4 {
        let (x, y) = (1.0 / (self.half_height * viewport.aspect()), 1.0 / self.half_height);
        let row = |axis: DVec3, scale: f64, shift: f64| (axis * scale).extend(shift - axis.dot(self.eye) * scale);
        let (depth, last) = match self.projection {
            Projection::Perspective { .. } => (DVec4::new(0.0, 0.0, 0.0, self.near), row(self.forward, 1.0, 0.0)),
            Projection::Orthographic { .. } => (row(self.forward, -1.0 / range, 1.0 + self.near / range), DVec4::W),
        };
        // A shift of the picture is a multiple of w.
        let across = row(self.right, x, 0.0) - last * (2.0 * self.lens_shift.x / viewport.aspect());
        let up = row(self.above, y, 0.0) - last * (2.0 * self.lens_shift.y);
        DMat4::from_cols(across, up, depth, last).transpose()
    }
}

/// The unit vector along `v` and the length of `v`, however small or large it is; `None` for zero.
fn unit(v: DVec3) -> Option<(DVec3, f64)> {
    let greatest = v.abs().max_element();
    if greatest == 0.0 {
        return None;
    }
    // A power of two, by which all is exact: squares of 1e-163 and 1e163 leave f64.
    let scale = f64::from_bits(greatest.max(f64::MIN_POSITIVE).to_bits() & 0x7ff0_0000_0000_0000);
    let scaled = v / scale;
    let length = scaled.length();
    Some((scaled / length, length * scale))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cameras() -> [Camera; 4] {
        let [a, b] =
            [Projection::Perspective { fov_deg: 50.0 }, Projection::Orthographic { height: 3.0 }].map(|projection| {
                Camera::look_at(DVec3::new(3.0, -4.0, 2.0), DVec3::new(0.1, 0.2, 0.3), DVec3::Z, projection).unwrap()
            });
        let shifted = |camera: Camera| camera.with_lens_shift(DVec2::new(0.31, -0.17)).unwrap();
        [a, b, shifted(a), shifted(b)]
    }

    #[test]
    fn a_lens_shift_shows_in_each_pixel_what_another_place_showed() {
        let viewport = Viewport::new(320, 200).unwrap();
        let [a, b, shifted_a, shifted_b] = cameras();
        for (plain, shifted) in [(a, shifted_a), (b, shifted_b)] {
            for (x, y) in [(0.5, 0.5), (160.0, 100.0), (319.5, 12.25)] {
                let (seen, expected) =
                    (shifted.ray(viewport, x, y), plain.ray(viewport, x + 0.31 * 200.0, y + 0.17 * 200.0));
                assert!(seen.origin.distance(expected.origin) < 1e-14, "{seen:?} {expected:?}");
                assert!(seen.direction.distance(expected.direction) < 1e-14, "{seen:?} {expected:?}");
                assert!((seen.near - expected.near).abs() < 1e-14);
            }
        }
    }

    #[test]
    fn a_lens_shift_that_is_not_finite_is_refused() {
        let error = cameras()[0].with_lens_shift(DVec2::new(0.0, f64::NAN)).unwrap_err();
        assert!(matches!(error, SceneError::CameraNotFinite { name: "lens shift", .. }));
    }

    #[test]
    fn a_point_on_a_ray_projects_to_where_the_ray_was_cast() {
        let viewport = Viewport::new(320, 200).unwrap();
        for camera in cameras() {
            for (x, y) in [(0.5, 0.5), (160.0, 100.0), (319.5, 12.25)] {
                let p = camera.ray(viewport, x, y).at(4.0);
                let (pixel, depth) = camera.project(viewport, p).unwrap();
                assert!(pixel.distance(DVec2::new(x, y)) < 1e-11);
                let clip = camera.clip_from_world(viewport, 10.0) * p.extend(1.0);
                let ndc = clip / clip.w;
                assert!((160.0 * (1.0 + ndc.x) - x).abs() < 1e-11 && (100.0 * (1.0 - ndc.y) - y).abs() < 1e-11);
                let expected = match camera.projection() {
                    Projection::Perspective { .. } => camera.near() / depth,
                    Projection::Orthographic { .. } => 1.0 - depth / 10.0,
                };
                assert!((ndc.z - expected).abs() < 1e-14);
            }
        }
    }

    #[test]
    fn the_derivative_of_the_picture_is_the_limit_of_its_differences() {
        let viewport = Viewport::new(320, 200).unwrap();
        for camera in cameras() {
            let (p, along) = (DVec3::new(0.4, 0.3, 0.6), DVec3::new(0.3, -0.7, 0.5));
            let at = |h: f64| camera.picture(viewport, p + h * along).unwrap();
            let expected = (at(1e-5) - at(-1e-5)) / 2e-5;
            assert!(camera.picture_derivative(viewport, p, along).distance(expected) < 1e-6 * expected.length());
        }
    }

    #[test]
    fn row_zero_is_on_top_and_column_zero_on_the_left() {
        let viewport = Viewport::new(100, 100).unwrap();
        for camera in cameras() {
            let corner = camera.ray(viewport, 0.5, 0.5).at(5.0) - camera.ray(viewport, 50.0, 50.0).at(5.0);
            assert!(corner.dot(camera.above()) > 0.0 && corner.dot(camera.right()) < 0.0);
        }
    }

    #[test]
    fn a_camera_is_the_same_at_every_scale() {
        let viewport = Viewport::new(320, 200).unwrap();
        let at = |scale: f64| {
            let perspective = Projection::Perspective { fov_deg: 50.0 };
            let (eye, target) = (DVec3::new(3.0, -4.0, 2.0) * scale, DVec3::new(0.5, 0.25, 0.125) * scale);
            Camera::look_at(eye, target, DVec3::new(0.0, 0.1, 1.0) * scale, perspective).unwrap()
        };
        for exponent in [-1000, -600, -40, 40, 600, 1000] {
            let scale = 2f64.powi(exponent);
            let [plain, scaled] = [at(1.0), at(scale)].map(|camera| camera.ray(viewport, 17.5, 42.5));
            assert_eq!(plain.direction, scaled.direction, "2^{exponent}");
            assert_eq!(plain.near * scale, scaled.near, "2^{exponent}");
        }
    }

    #[test]
    fn degenerate_cameras_are_refused_with_the_value() {
        let fov = |fov_deg| Projection::Perspective { fov_deg };
        let look = |eye, target, up, projection| Camera::look_at(eye, target, up, projection).unwrap_err();
        let (zero, x) = (DVec3::ZERO, DVec3::X);
        assert!(matches!(look(zero, zero, DVec3::Z, fov(40.0)), SceneError::EyeIsTarget { .. }));
        assert!(matches!(look(zero, x, x, fov(40.0)), SceneError::UpIsParallel { .. }));
        assert!(matches!(look(zero, x, zero, fov(40.0)), SceneError::UpIsParallel { .. }));
        assert!(matches!(look(zero, x, DVec3::Z, fov(180.0)), SceneError::FieldOfView { .. }));
        assert!(matches!(look(zero, x, DVec3::Z, fov(f64::NAN)), SceneError::FieldOfView { .. }));
        let flat = Projection::Orthographic { height: 0.0 };
        assert!(matches!(look(zero, x, DVec3::Z, flat), SceneError::OrthographicHeight { .. }));
        assert!(matches!(look(DVec3::NAN, x, DVec3::Z, fov(40.0)), SceneError::CameraNotFinite { name: "eye", .. }));
    }
}
