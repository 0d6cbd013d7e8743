//! A place on a face, and what is asked of the renderer about it.

use glam::{DVec2, DVec3};
use scene::{FaceId, Model};

/// A place on a face.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place {
    /// Whose.
    pub face: FaceId,
    /// In the surface's own knot domain.
    pub uv: DVec2,
    /// S(u, v), world.
    pub position: DVec3,
}

impl Place {
    /// The place of a face at (u, v).
    pub fn new(model: &Model, face: FaceId, uv: DVec2) -> Self {
        Self { face, uv, position: model.surface(face).point(uv.x, uv.y) }
    }

    /// A share of the way from this place to another: on the face, where both are of one, else straight.
    pub fn toward(&self, other: &Self, share: f64, model: &Model) -> Self {
        let uv = self.uv.lerp(other.uv, share);
        if self.face == other.face {
            return Self::new(model, self.face, uv);
        }
        let nearer = if share < 0.5 { self } else { other };
        Self { position: self.position.lerp(other.position, share), ..*nearer }
    }
}

/// Who knows of a model what lines alone do not tell.
pub trait Eye: Sync {
    /// Whether a face has material at (u, v): it is not cut away.
    fn has_material(&self, face: FaceId, uv: DVec2) -> bool;

    /// Whether nothing hides a place, or one within so many pixels of it.
    fn sees(&self, place: &Place, within_px: f64) -> bool;
}
