//! How a model is drawn.

use anyhow::{Result, bail};
use compare::UNBOUNDED_SHARE;
use pipeline::mask::{MaskPlan, Masks, Trimming};
use pipeline::{PackedScene, Scheme};
use scene::{Camera, Model, Viewport};
use techniques::{DEFAULT_CHORD_PX, Limits, Technique};

/// How a model is drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plan {
    /// Where the surface is evaluated.
    pub technique: &'static dyn Technique,
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
