//! What a technique is to all others.

use crate::error::PrepareError;
use crate::limits::Limits;
use compare::{Cells, Claims, Seams};
use gpu::Drawable;
use pipeline::wgsl::Part;
use pipeline::{Mesh, PackedScene};
use raster::Drawing;
use raster::visibility::Visibility;
use scene::{Camera, FaceId, Model, Viewport};
use std::fmt::{self, Debug, Formatter};
use std::sync::Arc;

/// What a technique prepares.
#[derive(Debug, Clone, Copy)]
pub struct Setting<'a> {
    /// The model.
    pub model: &'a Model,
    /// The same, packed.
    pub scene: &'a PackedScene,
    /// Who looks.
    pub camera: &'a Camera,
    /// At how many pixels.
    pub viewport: Viewport,
    /// Chord error that flat triangles may have, pixels.
    pub chord_px: f64,
    /// What grids may come to beside.
    pub limits: Limits,
    /// Whether normals are those of the triangles' corners: then cells are so small that these are known, however coarse the picture is.
    pub vertex_normals: bool,
}

/// A technique: where the surface is evaluated, and what carries (u, v, face) to a pixel.
pub trait Technique: Sync {
    /// Its name on the command line and in a G-buffer's facts.
    fn name(&self) -> &'static str;

    /// A line of help.
    fn about(&self) -> &'static str;

    /// Its shaders beside those that all techniques share; the first holds the entry points.
    fn parts(&self) -> &'static [Part];

    /// What its pictures may be judged by.
    fn claims(&self) -> Claims;

    /// Makes what both the CPU and the GPU draw.
    ///
    /// # Errors
    /// [`PrepareError`].
    fn prepare(&self, setting: &Setting) -> Result<Arc<dyn Prepared>, PrepareError>;

    /// The same with every face cut into `cells` × `cells` cells of equal parameters, wherever its knots lie, as Kanai's Table 1
    /// counts triangles; `None` for a technique that has no such cells.
    ///
    /// # Errors
    /// [`PrepareError`].
    fn uniform(
        &self,
        _model: &Model,
        _scene: &PackedScene,
        _cells: usize,
    ) -> Result<Option<Arc<dyn Prepared>>, PrepareError> {
        Ok(None)
    }
}

impl PartialEq for dyn Technique {
    fn eq(&self, other: &Self) -> bool {
        self.name() == other.name()
    }
}

impl Eq for dyn Technique {}

impl Debug for dyn Technique {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// A scene that a technique has prepared.
pub trait Prepared: Drawable {
    /// Number of triangles that are drawn.
    fn triangles(&self) -> usize;

    /// The triangles in the picture that it was prepared for, as the CPU draws them; `None` for a technique that draws none.
    fn mesh(&self) -> Option<&Mesh> {
        None
    }

    /// The same by programs with the CPU rasterizer's bits in all that a G-buffer holds, on every adapter; `None` for a technique whose
    /// triangles [`ByCompute::strict`](crate::ByCompute::strict) draws.
    fn strict(&self) -> Option<Box<dyn Drawable>> {
        None
    }

    /// For each face and each of its Bézier pieces, row-major in u, the greatest distance in model units from a point of a
    /// flat triangle to S at its parameters; empty where no flat triangle is shown.
    fn chord(&self) -> &[Vec<f64>] {
        &[]
    }

    /// For each face and each of its Bézier pieces, as [`Self::chord`], the cells that it is cut into: what may be said of normals that
    /// are interpolated over triangles. Empty where no triangle has corners on the surface.
    fn cells(&self) -> &[Vec<Cells>] {
        &[]
    }

    /// Borders along which triangles of faces meet vertex on vertex.
    fn seams(&self) -> Arc<Seams> {
        Arc::default()
    }

    /// Chord error in pixels to which it was built, where it has one: more than was asked for where that takes too much, or more
    /// cells than [`Limits::level`] has.
    fn built_px(&self) -> Option<f64> {
        None
    }

    /// Who is seen, on the CPU.
    fn visibility<'a>(&'a self, drawing: Drawing<'a>) -> Box<dyn Visibility + 'a>;

    /// The same after an edit that moved control points of `face`; the setting is that of the edited model.
    ///
    /// # Errors
    /// [`PrepareError`].
    fn edited(&self, setting: &Setting, face: FaceId) -> Result<Arc<dyn Prepared>, PrepareError>;
}
