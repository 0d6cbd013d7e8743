//! The rule of *trim*: where a pixel's ray meets a face that loops bound, the face has material, or an edge is near.

use crate::Cause;
use crate::difference::Difference;
use crate::setting::Setting;
use crate::trim::{self, Place};
use gbuffer::Hit;
use glam::DVec2;
use pipeline::sight::REACH_PX;
use scene::FaceId;

impl Setting<'_> {
    /// Whether an edge passes as near the pixel's centre as a renderer may mistake sides, where it shows a face: `edge_px`,
    /// and what one step of Newton's method leaves of the way to the pixel's ray.
    ///
    /// # Errors
    /// Where loops bound the face and it has no material there, nor so near.
    pub(crate) fn trimming(&self, hit: &Hit, center: DVec2, edge_px: f64) -> Result<bool, Difference> {
        let Some((place, uv)) = self.trim_place(hit, center) else { return Ok(false) };
        if place == Place::Material {
            return Ok(false);
        }
        let radius = edge_px + self.step_leaves_px(hit.face, hit.uv, center);
        if place == Place::Edge || self.edge_passes(hit.face, center, radius) {
            return Ok(true);
        }
        let detail = format!("face {} has no material at (u, v) = {uv}, nor within {radius:.4} px", hit.face.0);
        Err(Difference::new(Cause::Trim, f64::INFINITY, detail))
    }

    /// Whether an edge of a bounded face passes as near a position where it is seen as a renderer may mistake sides that
    /// started within `bound_px` of it.
    pub(crate) fn is_at_edge(&self, hit: &Hit, center: DVec2, edge_px: f64, bound_px: f64) -> bool {
        let Some((place, uv)) = self.trim_place(hit, center) else { return false };
        let starts = [DVec2::X, DVec2::Y, DVec2::NEG_X, DVec2::NEG_Y].map(|direction| {
            let d = self.model.surface(hit.face).first_derivatives(uv.x, uv.y);
            uv + self.parameters_of(d.s, [d.su, d.sv], bound_px * direction)
        });
        let leaves = |start: DVec2| self.step_leaves_px(hit.face, start, center);
        place == Place::Edge
            || self.edge_passes(hit.face, center, edge_px + starts.into_iter().map(leaves).fold(0.0, f64::max))
    }

    /// How far from position `at` the point is seen where the fragment program decides about a pixel there, when
    /// its parameters are `uv`: one step from them, or, where that is too long, at them.
    fn step_leaves_px(&self, face: FaceId, uv: DVec2, at: DVec2) -> f64 {
        let surface = self.model.surface(face);
        let [[u0, u1], [v0, v1]] = surface.domain();
        let inside = |uv: DVec2| uv.clamp(DVec2::new(u0, v0), DVec2::new(u1, v1));
        let uv = inside(uv);
        let d = surface.first_derivatives(uv.x, uv.y);
        let Some(seen) = self.picture(d.s) else { return f64::INFINITY };
        let step = self.parameters_of(d.s, [d.su, d.sv], at - seen);
        let pixels = self.camera.pixels_per_unit(self.viewport, self.camera.depth(d.s));
        let far = (d.su.length() * step.x.abs()).max(d.sv.length() * step.y.abs()) * pixels;
        let end = if far <= f64::from(REACH_PX) { inside(uv + step) } else { uv };
        self.picture(surface.point(end.x, end.y)).map_or(f64::INFINITY, |p| p.distance(at))
    }

    /// Where the surface of a bounded face is seen at a position close to a hit, and which parameters that are; close by a
    /// fold, where the ray may pass the surface by, the hit's own.
    fn trim_place(&self, hit: &Hit, center: DVec2) -> Option<(Place, DVec2)> {
        let region = self.model.region(hit.face)?;
        let band = self.scene.frames()[hit.face.0 as usize].edge_band * region.domain().size();
        let uv = self.seen_at(hit, center).unwrap_or(hit.uv);
        Some((trim::place(region, uv, band), uv))
    }

    /// Whether an edge of a bounded face is seen within `radius` pixels of a position.
    fn edge_passes(&self, face: FaceId, center: DVec2, radius: f64) -> bool {
        let surface = self.model.surface(face);
        let distance = |uv: DVec2| {
            let seen = self.picture(surface.point(uv.x, uv.y));
            seen.map_or(f64::INFINITY, |p| p.distance(center))
        };
        self.model.region(face).is_some_and(|region| trim::edge_passes(region, distance, radius))
    }
}
