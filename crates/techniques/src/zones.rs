//! Technique `zones`: two kernels generate the triangles of grids zone by zone (Concheiro et al. 2011, Sec. 4, GST); each
//! fragment evaluates the surface at the (u, v) that a triangle carries.
//!
//! How fine grids are, and how they meet, is what technique `grid` says. Their corners are evaluated once a zone and not once a
//! triangle, and none is kept beyond the step that draws it. WGSL has no geometry stage: `gpu` has compute kernels in its place.

mod gpu;
mod plan;

pub use plan::Zones;

use crate::error::PrepareError;
use crate::grid::Grids;
use crate::technique::{Prepared, Setting, Technique};
use crate::triangles::cpu::Triangles;
use compare::{Cells, Claims, Seams};
use pipeline::Mesh;
use pipeline::wgsl::Part;
use raster::Drawing;
use raster::visibility::Visibility;
use scene::FaceId;
use std::borrow::Cow;
use std::sync::Arc;

/// The technique.
#[derive(Debug)]
pub struct ByZones;

impl Technique for ByZones {
    fn name(&self) -> &'static str {
        gpu::NAME
    }

    fn about(&self) -> &'static str {
        "The same grids, generated zone by zone by compute kernels (Concheiro 2011)"
    }

    fn parts(&self) -> &'static [Part] {
        gpu::PARTS
    }

    fn claims(&self) -> Claims {
        Claims::Chord
    }

    fn prepare(&self, setting: &Setting) -> Result<Arc<dyn Prepared>, PrepareError> {
        Ok(Arc::new(Zones::new(Grids::new(setting)?, setting.scene, &setting.limits)?))
    }
}

impl Prepared for Zones {
    fn triangles(&self) -> usize {
        self.mesh.triangles()
    }

    fn mesh(&self) -> Option<&Mesh> {
        Some(&self.mesh)
    }

    fn chord(&self) -> &[Vec<f64>] {
        &self.grids.chord
    }

    fn cells(&self) -> &[Vec<Cells>] {
        &self.grids.cells
    }

    fn seams(&self) -> Arc<Seams> {
        self.grids.seams.clone()
    }

    fn built_px(&self) -> Option<f64> {
        Some(self.grids.built_px)
    }

    fn visibility<'a>(&'a self, drawing: Drawing<'a>) -> Box<dyn Visibility + 'a> {
        Box::new(Triangles::new(Cow::Borrowed(&self.mesh), drawing))
    }

    fn edited(&self, setting: &Setting, _face: FaceId) -> Result<Arc<dyn Prepared>, PrepareError> {
        ByZones.prepare(setting)
    }
}
