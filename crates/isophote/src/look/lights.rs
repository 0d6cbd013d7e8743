//! A body in three lights that stand with the camera: the key models it, the fill opens its shadows, the rim parts it from what is
//! behind.
//!
//! Diffuse light, and Blinn's highlights of the key and of the rim (doi:10.1145/965141.563893), in linear light, encoded by a square
//! root as the shading by one light is. The surface has two sides: normals are turned toward the eye.

use super::by_view::coloured;
use anyhow::Result;
use gbuffer::{GBuffer, Picture};
use glam::{DVec3, Vec3};
use scene::Camera;

/// The body's colour.
const BASE: Vec3 = Vec3::new(0.44, 0.56, 0.66);

/// Light from everywhere.
const AMBIENT: f32 = 0.03;

/// A light of the camera's: toward it (right, above, toward the viewer), its colour, and how bright its highlight is.
struct Light {
    toward: DVec3,
    colour: Vec3,
    shine: f32,
}

const LIGHTS: [Light; 3] = [
    Light { toward: DVec3::new(-0.9, 0.8, 0.7), colour: Vec3::new(1.02, 0.98, 0.92), shine: 0.35 },
    Light { toward: DVec3::new(1.0, 0.1, 0.7), colour: Vec3::new(0.08, 0.10, 0.14), shine: 0.0 },
    Light { toward: DVec3::new(0.5, 0.7, -0.9), colour: Vec3::new(0.72, 0.78, 0.88), shine: 0.25 },
];

/// The exponent of highlights.
const GLOSS: i32 = 48;

/// The picture of a buffer in the three lights.
///
/// # Errors
/// None: it is of the buffer's size.
pub fn lit(buffer: &GBuffer, camera: &Camera) -> Result<Picture> {
    let world = |v: DVec3| (v.x * camera.right() + v.y * camera.above() - v.z * camera.forward()).normalize();
    let lights = LIGHTS.map(|light| Light { toward: world(light.toward), ..light });
    coloured(buffer, camera, |n, view| shaded(if n.dot(view) < 0.0 { n } else { -n }, -view, &lights).to_array())
}

/// The colour of a normal that is turned toward the eye; all directions are of unit length.
fn shaded(n: DVec3, to_eye: DVec3, lights: &[Light]) -> Vec3 {
    let mut linear = AMBIENT * BASE;
    for Light { toward, colour, shine } in lights {
        let diffuse = n.dot(*toward).max(0.0) as f32;
        let half = (to_eye + *toward).normalize_or_zero();
        let gloss = if 0.0 < diffuse { (n.dot(half).max(0.0) as f32).powi(GLOSS) } else { 0.0 };
        linear += *colour * (BASE * diffuse + Vec3::splat(shine * gloss));
    }
    linear.clamp(Vec3::ZERO, Vec3::ONE).map(f32::sqrt)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What each light is for, on a sphere seen from +z with y up.
    #[test]
    fn the_key_side_is_brightest_no_side_is_black_and_the_rim_is_brighter_than_what_is_beside_it() {
        let lights = LIGHTS.map(|light| Light { toward: light.toward.normalize(), ..light });
        let bright = |x: f64, y: f64| {
            let n = DVec3::new(x, y, (1.0 - x * x - y * y).max(0.0).sqrt());
            shaded(n.normalize(), DVec3::Z, &lights).element_sum() / 3.0
        };
        assert!(bright(-0.45, 0.55) > 0.7, "the key: {}", bright(-0.45, 0.55));
        assert!(bright(-0.45, 0.55) > bright(0.6, -0.5) + 0.3);
        assert!(bright(0.6, -0.5) > 0.2, "the fill: {}", bright(0.6, -0.5));
        assert!(bright(0.58, 0.81) > bright(0.4, 0.5), "the rim: {} {}", bright(0.58, 0.81), bright(0.4, 0.5));
        // From the key's highlight to the other side it only grows darker, until the rim.
        let along: Vec<f32> = (1..8).map(|k| bright(-0.45 + 0.1 * f64::from(k), 0.55 - 0.12 * f64::from(k))).collect();
        assert!(along.windows(2).all(|pair| pair[1] < pair[0]), "{along:?}");
    }
}
