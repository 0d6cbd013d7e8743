//! Technique `grid`: the grid of each Bézier patch is evaluated in the vertex stage (Geiger 2015, Sec. 3.3; Concheiro et al. 2011's
//! VST); each fragment evaluates the surface at the (u, v) that a triangle carries.
//!
//! `grids` chooses how fine each grid is, by a proven bound on its error in pixels; `joints` finds the borders and corners
//! that patches share, and `corner` evaluates these alike for all of them, so that grids of different levels meet vertex on
//! vertex. `gpu` draws grids of one size by one call. No vertex is stored on the device.

mod corner;
mod gpu;
mod grids;
mod joints;
mod record;

pub(crate) use gpu::CORNER;
pub use grids::Grids;

use crate::error::PrepareError;
use crate::technique::{Prepared, Setting, Technique};
use crate::triangles::cpu::Triangles;
use compare::Claims;
use pipeline::wgsl::Part;
use raster::Drawing;
use raster::visibility::Visibility;
use scene::FaceId;
use std::sync::Arc;

/// The technique.
#[derive(Debug)]
pub struct Grid;

impl Technique for Grid {
    fn name(&self) -> &'static str {
        gpu::NAME
    }

    fn about(&self) -> &'static str {
        "A grid a Bézier patch, evaluated in the vertex stage, without cracks (Geiger 2015, Concheiro 2011)"
    }

    fn parts(&self) -> &'static [Part] {
        gpu::PARTS
    }

    fn claims(&self) -> Claims {
        Claims::Chord
    }

    fn prepare(&self, setting: &Setting) -> Result<Arc<dyn Prepared>, PrepareError> {
        let Setting { model, scene, camera, viewport, chord_px } = *setting;
        Ok(Arc::new(Grids::new(model, scene, camera, viewport, chord_px)?))
    }
}

impl Prepared for Grids {
    fn triangles(&self) -> usize {
        self.triangles()
    }

    fn chord(&self) -> &[Vec<f64>] {
        &self.chord
    }

    fn built_px(&self) -> Option<f64> {
        Some(self.built_px)
    }

    fn visibility<'a>(&'a self, drawing: Drawing<'a>) -> Box<dyn Visibility + 'a> {
        Box::new(Triangles::new(&self.mesh, drawing))
    }

    /// The grids keep their parameters; on the device nothing of them is new.
    fn edited(&self, setting: &Setting, _face: FaceId) -> Result<Arc<dyn Prepared>, PrepareError> {
        match Grids::edited(self, setting.model, setting.scene) {
            Some(edited) => Ok(Arc::new(edited)),
            None => Grid.prepare(setting),
        }
    }
}
