//! Technique `grid`: the grid of each Bézier patch is evaluated in the vertex stage (Geiger 2015, Sec. 3.3; Concheiro et al. 2011's
//! VST); each fragment evaluates the surface at the (u, v) that a triangle carries.
//!
//! `levels` chooses how fine each grid is in a picture, by a proven bound on its error in pixels; `joints` finds the borders and
//! corners that patches share, and `corner` evaluates these alike for all of them, so that grids of different levels meet vertex
//! on vertex. `tiles` cuts grids into what one draw call instances. `gpu` does all of that on the device, for each frame anew; no
//! vertex is stored there.

mod choice;
mod corner;
mod gpu;
mod grids;
mod joints;
mod levels;
mod record;
mod tiles;

pub use choice::wrong_levels;
pub(crate) use gpu::CORNER;
pub use grids::{Grids, Picture};
pub use record::GridRecord;

use crate::error::PrepareError;
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
        Ok(Arc::new(Grids::new(setting)?))
    }
}

impl Prepared for Grids {
    fn triangles(&self) -> usize {
        self.picture.mesh.triangles()
    }

    fn mesh(&self) -> Option<&Mesh> {
        Some(&self.picture.mesh)
    }

    fn chord(&self) -> &[Vec<f64>] {
        &self.chord
    }

    fn cells(&self) -> &[Vec<Cells>] {
        &self.cells
    }

    fn seams(&self) -> Arc<Seams> {
        self.seams.clone()
    }

    fn built_px(&self) -> Option<f64> {
        Some(self.built_px)
    }

    fn visibility<'a>(&'a self, drawing: Drawing<'a>) -> Box<dyn Visibility + 'a> {
        // Other views of the scene, of samples of a pixel say, have levels of their own, as on the device.
        let mesh = match self.is_of(drawing.views) {
            true => Cow::Borrowed(&self.picture.mesh),
            false => Cow::Owned(self.seen(drawing.scene, drawing.views).mesh),
        };
        Box::new(Triangles::new(mesh, drawing))
    }

    /// Levels, borders that are shared and bounds are those of the new control points; what is uploaded is what they change.
    fn edited(&self, setting: &Setting, _face: FaceId) -> Result<Arc<dyn Prepared>, PrepareError> {
        Grid.prepare(setting)
    }
}
