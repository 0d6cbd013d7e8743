//! Whether a face has material at (u, v), by a mask drawn beforehand. Twin of `shaders/mask.wgsl`.
//!
//! After Guthe and Geiger (*Tessellation of Trimmed NURBS Surfaces using Multipass Shader Algorithms on the GPU*): each
//! trimmed face has a mask over the box of its region, one where there is material, and a fragment takes the texel that
//! it is in. A [`MaskPlan`] says how fine masks are and where each stands in one atlas; [`MaskPlan::fill`] draws them on
//! the CPU by one of the [`MaskFill`]s, and the GPU draws its own from the same plan, by fans of triangles and parity.
//!
//! # Accuracy
//! Where a mask is wrong an edge passes within [`PackedFrame::edge_band`](crate::PackedFrame::edge_band), which here is
//! a texel and a half (half for the texel's own extent, one for what rasterizers of polygons may be off) and the
//! distance between a curve and its chords. All of it, in space and in pixels, is [`Tile::error_px`].

mod atlas;
mod fill;
mod plan;
#[cfg(test)]
mod tests;
mod tile;

pub use plan::{MaskError, MaskFill, MaskOptions, MaskPlan, MaskQuality};
pub(crate) use tile::placement;
pub use tile::{MaskCurve, Ring, Tile};

use crate::layout::FaceRecord;

/// How it is decided where a trimmed face has material.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Trimming {
    /// At each fragment, from the curves ([`crate::trim`]).
    #[default]
    Exact,
    /// By masks.
    Texture(MaskOptions),
}

impl Trimming {
    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Exact => "exact",
            Self::Texture(_) => "texture",
        }
    }
}

/// A drawn atlas.
#[derive(Debug, Clone, PartialEq)]
pub struct Masks {
    /// Where all is.
    pub plan: MaskPlan,
    /// Row-major; 255 is material.
    pub texels: Vec<u8>,
}

impl Masks {
    /// Draws the masks of a plan on the CPU.
    pub fn new(plan: MaskPlan, fill: MaskFill) -> Self {
        Self { texels: plan.fill(fill), plan }
    }
}

/// Whether `face` of a scene with these knots has material at local parameters, 0 … 1: nearest texel, none outside the box.
pub(crate) fn is_material(knots: &[f32], masks: &Masks, face: &FaceRecord, uv: [f32; 2]) -> bool {
    let tile: &[f32; 10] = knots[face.trims as usize..].first_chunk().expect("packing put ten numbers there");
    let inside = |k: usize| uv[k] >= tile[k] && uv[k] <= tile[2 + k];
    if !(inside(0) && inside(1)) {
        return false;
    }
    let at = |k: usize| (tile[6 + k] + ((uv[k] - tile[k]) * tile[4 + k]).floor().min(tile[8 + k])) as usize;
    masks.texels[at(1) * masks.plan.size[0] as usize + at(0)] > 127
}
