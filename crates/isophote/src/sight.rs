//! What is seen of a line, by the ray caster: nothing is in front on the ray through its place.

use glam::DVec2;
use lines::{Eye, Place};
use raycast::{Caster, Classifier};
use rayon::prelude::*;
use scene::{Camera, FaceId, Model, Viewport};

/// Where rays pass by a place, in the distance within which it is enough that one comes as far: across a border there may be a gap
/// to the next face, and the chord of a silhouette may be a hair behind the surface.
const RAYS: [DVec2; 5] = [DVec2::ZERO, DVec2::X, DVec2::NEG_X, DVec2::Y, DVec2::NEG_Y];

/// What is so much nearer hides nothing: two faces' points of one edge may be that far apart. A share of the model's size.
const NEARER: f64 = 1e-6;

/// A camera that looks at a model.
pub struct Sight<'m> {
    caster: Caster<'m>,
    /// Of the faces that are trimmed.
    classifiers: Vec<Option<Classifier>>,
    camera: Camera,
    viewport: Viewport,
    /// Model units.
    nearer: f64,
}

impl<'m> Sight<'m> {
    /// Prepares a model for a camera.
    pub fn new(model: &'m Model, camera: Camera, viewport: Viewport) -> Self {
        let region = |id: usize| model.trimmed_region(FaceId(id as u32));
        let classifiers = (0..model.faces().len()).into_par_iter().map(|id| region(id).map(Classifier::new)).collect();
        let nearer = NEARER * model.hull().diagonal();
        Self { caster: Caster::new(model), classifiers, camera, viewport, nearer }
    }
}

impl Eye for Sight<'_> {
    fn has_material(&self, face: FaceId, uv: DVec2) -> bool {
        self.classifiers[face.0 as usize].as_ref().is_none_or(|classifier| classifier.inside(uv))
    }

    fn sees(&self, place: &Place, within_px: f64) -> bool {
        let Some((pixel, _)) = self.camera.project(self.viewport, place.position) else { return false };
        let size = DVec2::new(self.viewport.width() as f64, self.viewport.height() as f64);
        if pixel.cmplt(-DVec2::ONE).any() || pixel.cmpgt(size + 1.0).any() {
            return false;
        }
        let rays = if within_px > 0.0 { &RAYS[..] } else { &RAYS[..1] };
        rays.iter().any(|offset| {
            let at = pixel + within_px * offset;
            let ray = self.camera.ray(self.viewport, at.x, at.y);
            let t = (place.position - ray.origin).dot(ray.direction);
            self.caster.first(&ray).hit.is_none_or(|hit| t - self.nearer <= hit.t)
        })
    }
}
