//! Technique `fragment`: a coarse tessellation carries (u, v, face); each fragment evaluates the surface there (Kanai 2007).
//!
//! `tessellation` cuts cells by a bound on the chord error, `joints` finds the borders that faces share, so that all have the same corners
//! there; `gpu` feeds the triangles to the device.

mod cells;
mod gpu;
mod grid;
mod joints;
mod tessellation;

pub use tessellation::Tessellation;

use crate::error::PrepareError;
use crate::technique::{Prepared, Setting, Technique};
use crate::triangles::cpu::Triangles;
use compare::{Cells, Claims, Seams};
use pipeline::wgsl::Part;
use pipeline::{Mesh, PackedScene};
use raster::Drawing;
use raster::visibility::Visibility;
use scene::{FaceId, Model};
use std::borrow::Cow;
use std::sync::Arc;

/// The technique.
#[derive(Debug)]
pub struct Fragment;

impl Technique for Fragment {
    fn name(&self) -> &'static str {
        gpu::NAME
    }

    fn about(&self) -> &'static str {
        "A coarse tessellation carries (u, v, face); each fragment evaluates the surface (Kanai 2007)"
    }

    fn parts(&self) -> &'static [Part] {
        gpu::PARTS
    }

    fn claims(&self) -> Claims {
        Claims::Chord
    }

    fn prepare(&self, setting: &Setting) -> Result<Arc<dyn Prepared>, PrepareError> {
        Ok(Arc::new(Tessellation::new(setting)?))
    }

    fn uniform(
        &self,
        model: &Model,
        scene: &PackedScene,
        cells: usize,
    ) -> Result<Option<Arc<dyn Prepared>>, PrepareError> {
        Ok(Some(Arc::new(Tessellation::uniform(model, scene, cells)?)))
    }
}

impl Prepared for Tessellation {
    fn triangles(&self) -> usize {
        self.mesh.triangles()
    }

    fn mesh(&self) -> Option<&Mesh> {
        Some(&self.mesh)
    }

    fn chord(&self) -> &[Vec<f64>] {
        &self.chord
    }

    fn cells(&self) -> &[Vec<Cells>] {
        self.normal_cells()
    }

    fn seams(&self) -> Arc<Seams> {
        self.seams.clone()
    }

    fn built_px(&self) -> Option<f64> {
        Some(self.built_px)
    }

    fn visibility<'a>(&'a self, drawing: Drawing<'a>) -> Box<dyn Visibility + 'a> {
        Box::new(Triangles::new(Cow::Borrowed(&self.mesh), drawing))
    }

    /// The triangles keep their parameters, so that few bytes are new, unless the edit parts faces or joins them.
    fn edited(&self, setting: &Setting, face: FaceId) -> Result<Arc<dyn Prepared>, PrepareError> {
        match self.followed(setting.model, setting.scene, face) {
            Some(edited) => Ok(Arc::new(edited)),
            None => Fragment.prepare(setting),
        }
    }
}
