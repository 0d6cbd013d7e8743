//! How a model is drawn.

use anyhow::{Result, bail};
use clap::ValueEnum;
use compare::UNBOUNDED_SHARE;
use pipeline::mask::{MaskPlan, Masks, Trimming};
use pipeline::{PackedScene, Scheme};
use scene::{Camera, Model, Viewport};
use std::sync::Arc;
use techniques::{ByCompute, DEFAULT_CHORD_PX, Limits, Prepared, Technique};

/// Who finds the triangles that the GPU shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
pub enum Path {
    /// The rasterizer of the GPU; the program runs in the fragment stage
    #[default]
    Fragment,
    /// Compute kernels, with 64-bit atomics where the adapter has them
    Compute,
    /// Compute kernels, with 32-bit atomics
    #[value(name = "compute-32")]
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
    /// What the kernels use; `None` where no kernels are asked for.
    fn atomics(self, device: &gpu::Device) -> Option<gpu::Atomics> {
        match self {
            Path::Fragment => None,
            Path::Compute => Some(device.atomics()),
            Path::Compute32 | Path::Strict => Some(gpu::Atomics::Bits32),
        }
    }

    /// A renderer of what is prepared of a scene, by this path where it has triangles.
    ///
    /// # Errors
    /// Where the adapter refuses.
    pub fn renderer<'a>(
        self,
        device: &'a gpu::Device,
        scene: &'a PackedScene,
        prepared: &Arc<dyn Prepared>,
        options: gpu::RendererOptions<'_>,
    ) -> Result<gpu::Renderer<'a>, gpu::GpuError> {
        let by_compute = |atomics| match self {
            Path::Strict => ByCompute::strict(prepared.clone()),
            _ => ByCompute::new(prepared.clone(), atomics),
        };
        match self.atomics(device).and_then(by_compute) {
            Some(drawn) => gpu::Renderer::new(device, scene, &drawn, options),
            None => gpu::Renderer::new(device, scene, &**prepared, options),
        }
    }
}

impl Plan {
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
