//! Technique `exact`: conservative hulls of Bézier pieces; each pixel solves for the point on its own ray.
//!
//! `hulls` cuts pieces and draws hulls around them, [`newton`] solves, [`together`] for several pixels at once, `cpu` and `gpu` find who is nearest.

mod cpu;
pub mod fold;
mod gpu;
mod hulls;
pub mod newton;
mod pieces;
pub mod place;
mod record;
pub mod together;

pub use gpu::Strict;
pub use hulls::Hulls;
pub use record::PieceRecord;

use crate::error::PrepareError;
use crate::technique::{Prepared, Setting, Technique};
use ::gpu::Drawable;
use compare::Claims;
use pipeline::wgsl::Part;
use raster::Drawing;
use raster::visibility::Visibility;
use scene::FaceId;
use std::sync::Arc;

/// The technique.
#[derive(Debug)]
pub struct Exact;

impl Technique for Exact {
    fn name(&self) -> &'static str {
        gpu::NAME
    }

    fn about(&self) -> &'static str {
        "Hulls of nearly flat pieces; each fragment solves for the point on its pixel's ray"
    }

    fn parts(&self) -> &'static [Part] {
        gpu::PARTS
    }

    fn claims(&self) -> Claims {
        Claims::OnRay
    }

    fn prepare(&self, setting: &Setting) -> Result<Arc<dyn Prepared>, PrepareError> {
        let Setting { model, scene, camera, viewport, .. } = *setting;
        Ok(Arc::new(Hulls::new(model, scene, camera, viewport)?))
    }
}

impl Prepared for Hulls {
    fn triangles(&self) -> usize {
        self.mesh.triangles()
    }

    fn strict(&self) -> Option<Box<dyn Drawable>> {
        Some(Box::new(Strict(self.clone())))
    }

    fn visibility<'a>(&'a self, drawing: Drawing<'a>) -> Box<dyn Visibility + 'a> {
        Box::new(cpu::Searches::new(self, drawing))
    }

    /// Hulls are made anew.
    fn edited(&self, setting: &Setting, _face: FaceId) -> Result<Arc<dyn Prepared>, PrepareError> {
        Exact.prepare(setting)
    }
}
