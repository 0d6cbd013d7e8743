//! How a model is drawn.

use anyhow::{Result, bail};
use clap::ValueEnum;
use compare::UNBOUNDED_SHARE;
use gpu::Drawable;
use pipeline::mask::{MaskPlan, Masks, Trimming};
use pipeline::{PackedScene, Scheme};
use scene::{Camera, Model, Viewport};
use serde::{Deserialize, Serialize};
use std::sync::Arc;
use techniques::{ByCompute, DEFAULT_CHORD_PX, Limits, Prepared, Setting, Technique};

/// Who finds the triangles that the GPU shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Path {
    /// The rasterizer of the GPU; the program runs in the fragment stage
    #[default]
    Fragment,
    /// Compute kernels, with 64-bit atomics where the adapter has them
    Compute,
    /// Compute kernels, with 32-bit atomics
    #[value(name = "compute-32")]
    #[serde(rename = "compute-32")]
    Compute32,
    /// Compute kernels with the CPU rasterizer's bits in all that they return, on every adapter; slow
    Strict,
}

/// How a model is drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plan {
    /// Where the surface is evaluated.
    pub technique: &'static dyn Technique,
    /// Who finds its triangles on the GPU.
    pub path: Path,
    /// Which programs evaluate it.
    pub scheme: Scheme,
    /// Chord error of a tessellation, pixels.
    pub chord_px: f64,
    /// How faces are trimmed.
    pub trim: Trimming,
    /// Whether each pixel records where a trim edge of its face passes.
    pub edges: bool,
    /// Whether pixels show the points of flat triangles, and normals interpolated over them, in place of the surface's own.
    pub vertex_normals: bool,
    /// What grids may come to beside the chord error.
    pub limits: Limits,
    /// The share of covered pixels that may have no verdict for want of a bound: what the scene states.
    pub unbounded_share: f64,
}

impl Default for Plan {
    fn default() -> Self {
        Self {
            technique: techniques::ALL[0],
            path: Path::default(),
            scheme: Scheme::default(),
            chord_px: DEFAULT_CHORD_PX,
            trim: Trimming::default(),
            edges: false,
            vertex_normals: false,
            limits: Limits::default(),
            unbounded_share: UNBOUNDED_SHARE,
        }
    }
}

impl Path {
    /// Whether it is the one that is taken unless another is asked for.
    pub fn is_default(&self) -> bool {
        *self == Self::default()
    }

    /// What is drawn in place of what is prepared of a scene; `None` where that itself is, or it has no triangles for kernels.
    pub fn drawn(self, device: &gpu::Device, prepared: &Arc<dyn Prepared>) -> Option<Box<dyn Drawable>> {
        let by_kernels = |drawn: ByCompute| -> Box<dyn Drawable> { Box::new(drawn) };
        let with = |atomics| ByCompute::new(prepared.clone(), atomics).map(by_kernels);
        match self {
            Path::Fragment => None,
            Path::Compute => with(device.atomics()),
            Path::Compute32 => with(gpu::Atomics::Bits32),
            Path::Strict => ByCompute::strict(prepared.clone()).map(by_kernels).or_else(|| prepared.strict()),
        }
    }

    /// A renderer of what is prepared of a scene, by this path where it has triangles.
    ///
    /// # Errors
    /// Where the adapter refuses.
    pub fn renderer<'a>(
        self,
        device: &'a gpu::Device,
        scene: &PackedScene,
        prepared: &Arc<dyn Prepared>,
        options: gpu::RendererOptions<'_>,
    ) -> Result<gpu::Renderer<'a>, gpu::GpuError> {
        match self.drawn(device, prepared) {
            Some(drawn) => gpu::Renderer::new(device, scene, &*drawn, options),
            None => gpu::Renderer::new(device, scene, &**prepared, options),
        }
    }
}

impl Plan {
    /// What the technique draws of a model that is packed, as `camera` sees it.
    ///
    /// # Errors
    /// Where the technique cannot draw it so, or the chord error asks for too many triangles.
    pub fn prepared(
        &self,
        model: &Model,
        scene: &PackedScene,
        camera: &Camera,
        viewport: Viewport,
    ) -> Result<Arc<dyn Prepared>> {
        let prepared = self.technique.prepare(&self.setting(model, scene, camera, viewport))?;
        if matches!(self.path, Path::Compute | Path::Compute32) && prepared.mesh().is_none() {
            bail!("technique {} draws no triangles, so there are none for --path compute", self.technique.name())
        }
        if self.path == Path::Strict && self.vertex_normals {
            bail!("--path strict covers the surface's own normals, not those of --normals vertex");
        }
        if self.vertex_normals && prepared.cells().is_empty() {
            bail!(
                "technique {} draws no triangles with corners on the surface, so it has no vertex normals",
                self.technique.name()
            )
        }
        Ok(prepared)
    }

    /// What the technique is asked to prepare.
    pub fn setting<'a>(
        &self,
        model: &'a Model,
        scene: &'a PackedScene,
        camera: &'a Camera,
        viewport: Viewport,
    ) -> Setting<'a> {
        let Self { chord_px, limits, vertex_normals, .. } = *self;
        Setting { model, scene, camera, viewport, chord_px, limits, vertex_normals }
    }

    /// A model as the rasterizers read it.
    ///
    /// # Errors
    /// Where it cannot be packed, masks do not fit, or trim edges are asked for of masks, which have none.
    pub fn packed(&self, model: &Model, camera: &Camera, viewport: Viewport) -> Result<PackedScene> {
        Ok(match (&self.trim, self.edges) {
            (Trimming::Exact, false) => PackedScene::new(model, self.scheme)?,
            (Trimming::Exact, true) => PackedScene::with_edges(model, self.scheme)?,
            (Trimming::Texture(_), true) => {
                bail!(
                    "--antialias trims measures distances to trim curves, and --trim texture has masks instead of them"
                )
            }
            (Trimming::Texture(options), false) => {
                let masks = Masks::new(MaskPlan::new(model, camera, viewport, options)?, options.fill);
                PackedScene::masked(model, self.scheme, masks)?
            }
        })
    }
}
