//! Highlight lines (Beier & Chen 1994, doi:10.1016/0010-4485(94)90073-6): where the surface's normals, made longer, meet
//! straight lamps that hang above it.
//!
//! They do not depend on the eye: a car's body keeps them while one walks around it. A lamp is seen as a band: the points
//! whose normal line passes it within a radius, by their distance |(B × N) · (A − Q)| / |B × N|.

use crate::shade::{DARK_TONE, LIGHT_TONE};
use crate::{GBuffer, GBufferError, Hit, Picture, background, unorm8};
use glam::{DVec2, DVec3};
use scene::{Camera, Model};

/// Radius of a lamp, as a share of the way to the next.
const RADIUS_SHARE: f64 = 0.2;

/// Lamps hang a diagonal of the model from its middle, over this many diagonals.
const WIDTH: f64 = 4.0;

/// A row of parallel lamps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lamps {
    /// How many, at least 1.
    pub count: u32,
    /// Toward them from the model, in the camera's frame: right, above, toward the viewer. Of any length but nought.
    pub toward: DVec3,
    /// How far they are turned from upright in the picture, counterclockwise, radians.
    pub turn_rad: f64,
}

/// Lamps in their places about a model.
#[derive(Debug, Clone, PartialEq)]
pub struct HungLamps {
    /// From the model toward them, world, of unit length.
    pub light: DVec3,
    /// Along each, world, of unit length.
    pub along: DVec3,
    /// A point of each, in order across.
    pub lamps: Vec<DVec3>,
    /// From one to the next, model units.
    pub spacing: f64,
}

impl Lamps {
    /// The lamps about a model, as a camera has them.
    ///
    /// # Errors
    /// [`GBufferError::Light`] where the direction is nought or not finite.
    pub fn hung(&self, model: &Model, camera: &Camera) -> Result<HungLamps, GBufferError> {
        let Self { count, toward, turn_rad } = *self;
        let world = |v: DVec3| v.x * camera.right() + v.y * camera.above() - v.z * camera.forward();
        let light = toward.try_normalize().map(world).ok_or(GBufferError::Light { direction: toward.to_array() })?;
        // Along the lamps, as the picture shows them, across the way to them; of lamps that hang straight that way, any.
        let upright = DVec2::from_angle(turn_rad).perp();
        let flat = |v: DVec3| (v - v.dot(light) * light).try_normalize();
        let along = flat(world(upright.extend(0.0))).unwrap_or_else(|| light.any_orthonormal_vector());
        let size = model.hull().diagonal();
        let (middle, spacing) = (model.hull().center() + size * light, WIDTH * size / f64::from(count));
        let lamp = |k: u32| middle + (f64::from(k) - 0.5 * f64::from(count - 1)) * spacing * along.cross(light);
        Ok(HungLamps { light, along, lamps: (0..count).map(lamp).collect(), spacing })
    }
}

impl GBuffer {
    /// The highlight lines of a model: dark bands on a light body.
    ///
    /// # Errors
    /// [`GBufferError::Light`] where the direction is nought or not finite.
    pub fn highlighted(&self, lamps: &Lamps, model: &Model, camera: &Camera) -> Result<Picture, GBufferError> {
        let HungLamps { light, along, lamps, spacing } = lamps.hung(model, camera)?;
        let is_lit = |hit: &Hit, n: DVec3| {
            let height = (lamps[0] - hit.position).dot(light);
            let place = hit.position + height / n.dot(light) * n;
            // The lamp whose plane crossing is nearest.
            let k = ((place - lamps[0]).dot(along.cross(light)) / spacing).round().clamp(0.0, (lamps.len() - 1) as f64);
            let normal = along.cross(n);
            let distance = normal.dot(lamps[k as usize] - hit.position).abs() / normal.length();
            place.is_finite() && distance <= RADIUS_SHARE * spacing
        };
        let viewport = self.viewport();
        let colour = |i: usize, hit: Option<&Hit>| {
            let Some(hit) = hit else { return background() };
            let Some(n) = hit.normal.unit() else { return unorm8(LIGHT_TONE) };
            let (x, y) = ((i % viewport.width()) as f64 + 0.5, (i / viewport.width()) as f64 + 0.5);
            let facing = camera.ray(viewport, x, y).direction.dot(n).abs() as f32;
            let tone = if is_lit(hit, n) { DARK_TONE } else { LIGHT_TONE };
            unorm8(tone * (0.7 + 0.3 * facing))
        };
        let rgb = self.pixels().enumerate().map(|(i, hit)| colour(i, hit)).collect();
        Picture::new(viewport.width(), viewport.height(), rgb)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Meta;
    use nurbs::{KnotVector, Normal, Surface};
    use scene::{FaceId, Projection, Viewport};

    /// On a sphere about the middle all normal lines pass through that. Along its equator the way from a lamp to the line is
    /// plane geometry: a point's distance from a line through the origin.
    #[test]
    fn bands_of_a_sphere_lie_where_plane_geometry_has_them() {
        let knots = || KnotVector::new(1, vec![0.0, 0.0, 1.0, 1.0]).unwrap();
        // A square of diagonal 2 about the origin: lamps hang at height 2, 4 · 2 / 8 = 1 apart.
        let corner = |x: f64, y: f64| DVec3::new(x, y, 0.0) / 2f64.sqrt();
        let points = vec![corner(-1.0, -1.0), corner(-1.0, 1.0), corner(1.0, -1.0), corner(1.0, 1.0)];
        let model = Model::of_surfaces("square", vec![Surface::new(knots(), knots(), points, None).unwrap()]).unwrap();
        let size = model.hull().diagonal();
        let spacing = WIDTH * size / 9.0;
        let projection = Projection::Orthographic { height: 2.0 };
        let camera = Camera::look_at(5.0 * DVec3::Z, DVec3::ZERO, DVec3::Y, projection).unwrap();
        let angles: Vec<f64> = (-80..=80).map(|degrees| (f64::from(degrees) + 0.25).to_radians()).collect();
        let hits = angles.iter().map(|angle| {
            let n = DVec3::new(angle.sin(), 0.0, angle.cos());
            let normal = Normal::Regular(n);
            let uv = DVec2::ZERO;
            Some(Hit { face: FaceId(0), uv, local: None, t: 1.0, position: n, normal, curvature: None, edge: None })
        });
        let viewport = Viewport::new(angles.len(), 1).unwrap();
        let meta = Meta::new("test", "by hand", &model, &camera);
        let buffer = GBuffer::from_rows(viewport, meta, [hits.collect()]);
        let lamps = Lamps { count: 9, toward: DVec3::Z, turn_rad: 0.0 };
        let picture = buffer.highlighted(&lamps, &model, &camera).unwrap();
        let mut dark = 0;
        for (x, angle) in angles.iter().enumerate() {
            let away = |k: i32| (f64::from(k) * spacing * angle.cos() - size * angle.sin()).abs();
            let expected = (-4..=4).map(away).fold(f64::INFINITY, f64::min) <= RADIUS_SHARE * spacing;
            let [r, _, b] = picture.pixel(x, 0);
            assert_eq!(b > r, expected, "{} degrees", angle.to_degrees());
            dark += usize::from(expected);
        }
        assert!((20..140).contains(&dark), "{dark}");
        let nowhere = buffer.highlighted(&Lamps { toward: DVec3::ZERO, ..lamps }, &model, &camera);
        assert!(matches!(nowhere, Err(GBufferError::Light { .. })));
    }
}
