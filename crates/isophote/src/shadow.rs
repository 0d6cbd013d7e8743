//! The shadow of a model on the ground below it, where nothing else is seen.
//!
//! The ground is the plane z = least, of the model's box. Light falls from a disc high over the viewer's left shoulder; of a place in the
//! shadow of half the disc half the light is left.

use gbuffer::{GBuffer, Picture};
use glam::DVec3;
use nurbs::Hull;
use raycast::Caster;
use rayon::prelude::*;
use scene::{Camera, Model, Ray};

/// The disc's places, and its radius as a tangent.
const PLACES: u32 = 40;
const RADIUS: f64 = 0.16;

/// How far its middle is from the zenith, as a tangent, to the left and toward the viewer.
const LEFT: f64 = 0.45;
const NEARER: f64 = 0.25;

/// How much of what is behind is left in full shadow.
const LEAST: f64 = 0.35;

/// A ray begins so far above the ground, a share of the model's size: what stands on it does not touch it.
const ABOVE: f64 = 1e-6;

/// What light comes from, and what stands in its way.
pub struct Ground<'m> {
    caster: Caster<'m>,
    hull: Hull,
    lights: Vec<DVec3>,
}

impl<'m> Ground<'m> {
    /// The ground below a model, lit as `camera` has it.
    pub fn new(model: &'m Model, camera: &Camera) -> Self {
        let flat = |v: DVec3| v.with_z(0.0).normalize_or_zero();
        let middle = DVec3::Z - LEFT * flat(camera.right()) - NEARER * flat(camera.forward());
        // A sunflower's seeds are spread evenly (Vogel 1979, doi:10.1016/0025-5564(79)90080-4).
        let golden = std::f64::consts::PI * (3.0 - 5f64.sqrt());
        let place = |k: u32| {
            let radius = RADIUS * ((f64::from(k) + 0.5) / f64::from(PLACES)).sqrt();
            let (sine, cosine) = (golden * f64::from(k)).sin_cos();
            (middle + radius * DVec3::new(cosine, sine, 0.0)).normalize()
        };
        Self { caster: Caster::new(model), hull: model.hull(), lights: (0..PLACES).map(place).collect() }
    }

    /// A picture with the shadow where `buffer`, of the same camera, shows nothing. From below the ground there is none.
    pub fn shaded(&self, picture: &Picture, buffer: &GBuffer, camera: &Camera) -> Picture {
        let viewport = buffer.viewport();
        let lit = |i: usize| {
            let (x, y) = (i % viewport.width(), i / viewport.width());
            let seen = camera.ray(viewport, x as f64 + 0.5, y as f64 + 0.5);
            let t = (self.hull.min.z - seen.origin.z) / seen.direction.z;
            let is_ground = buffer.get(x, y).is_none() && seen.direction.z < 0.0 && seen.near <= t && t.is_finite();
            if is_ground { self.lit(seen.at(t)) } else { 1.0 }
        };
        let lit: Vec<f64> = (0..viewport.pixels()).into_par_iter().map(lit).collect();
        let darker = |part: u8, lit: f64| (f64::from(part) * (LEAST + (1.0 - LEAST) * lit)).round() as u8;
        let rgb = picture.rgb().iter().zip(lit).map(|(rgb, lit)| rgb.map(|part| darker(part, lit))).collect();
        Picture::new(picture.width(), picture.height(), rgb).expect("it is of the size that it was")
    }

    /// How much of the disc a place on the ground sees, 0 to 1.
    fn lit(&self, place: DVec3) -> f64 {
        let origin = place + ABOVE * self.hull.diagonal() * DVec3::Z;
        let ray = |direction: &DVec3| Ray { origin, direction: *direction, near: 0.0 };
        let is_hidden = |ray: &Ray| meets(ray, self.hull) && self.caster.first(ray).hit.is_some();
        let hidden = self.lights.iter().map(ray).filter(is_hidden).count();
        1.0 - hidden as f64 / self.lights.len() as f64
    }
}

/// Whether a ray passes through a box.
fn meets(ray: &Ray, hull: Hull) -> bool {
    let [a, b] = [hull.min, hull.max].map(|corner| (corner - ray.origin) / ray.direction);
    let (enters, leaves) = (a.min(b).max_element(), a.max(b).min_element());
    enters.max(0.0) <= leaves
}

#[cfg(test)]
mod tests {
    use super::*;
    use nurbs::{KnotVector, Surface};
    use scene::{Projection, Viewport};

    /// A square at height 1 over another that marks the ground, far away: its shadow's middle is where the disc's middle says.
    #[test]
    fn a_shadow_falls_away_from_the_light_and_is_soft_at_its_sides() {
        let sheet = |middle: DVec3, half: f64| {
            let knots = || KnotVector::new(1, vec![0.0, 0.0, 1.0, 1.0]).unwrap();
            let corner = |x: f64, y: f64| middle + half * DVec3::new(x, y, 0.0);
            let points = vec![corner(-1.0, -1.0), corner(-1.0, 1.0), corner(1.0, -1.0), corner(1.0, 1.0)];
            Surface::new(knots(), knots(), points, None).unwrap()
        };
        let sheets = vec![sheet(DVec3::Z, 0.5), sheet(DVec3::new(3.0, 3.0, 0.0), 0.1)];
        let model = Model::of_surfaces("sheets", sheets).unwrap();
        let projection = Projection::Orthographic { height: 4.0 };
        let camera = Camera::look_at(DVec3::new(0.0, -5.0, 5.0), DVec3::ZERO, DVec3::Z, projection).unwrap();
        let ground = Ground::new(&model, &camera);
        let away = DVec3::new(LEFT, NEARER, ground.hull.min.z);
        assert_eq!(ground.lit(away), 0.0, "the middle of the shadow");
        assert_eq!(ground.lit(away - 2.0 * DVec3::X), 1.0, "beside it");
        let side = ground.lit(away + 0.5 * DVec3::X);
        assert!((0.25..0.75).contains(&side), "half of the disc is seen from below the side: {side}");
        let viewport = Viewport::new(40, 40).unwrap();
        let buffer = Caster::new(&model).render(&camera, viewport, &|_| {});
        let white = Picture::new(40, 40, vec![[255; 3]; 1600]).unwrap();
        let dark = |camera: &Camera, buffer: &GBuffer| {
            ground.shaded(&white, buffer, camera).rgb().iter().filter(|rgb| rgb[0] < 255).count()
        };
        assert!(50 < dark(&camera, &buffer), "{}", dark(&camera, &buffer));
        let below = Camera::look_at(DVec3::new(0.0, -5.0, -5.0), DVec3::ZERO, DVec3::Z, projection).unwrap();
        assert_eq!(dark(&below, &Caster::new(&model).render(&below, viewport, &|_| {})), 0, "from below the ground");
    }
}
