//! How far across the ray a candidate's point may lie from what the reference shows, before any rounding of S itself.

use nurbs::{DerivativeBounds, Surface};
use scene::Model;

/// Vertices snap to 1/256 pixel, each coordinate by at most half of it; a viewport transform in f32 adds less than
/// the other half up to 16384 pixels.
pub const SNAP_PX: f64 = 1.0 / 256.0;

/// Interpolated parameters may be off by this many units of 2⁻²⁴ of the domain: WGSL states no accuracy of
/// interpolation. Of the models of the conformance tests, none needs more on llvmpipe or an H100.
pub const ATTRIBUTE_ULPS: f64 = 16.0;

/// The allowance of a pair of renderers.
#[derive(Debug, Clone, PartialEq)]
pub struct Deviation {
    /// Per face: the greatest distance of a flat proxy triangle from S at its (u, v), model units. Zeros where both
    /// renderers draw the same triangles.
    pub chord: Vec<f64>,
    /// Per face: the chord bound of the triangles that are drawn, even where it does not count between two renderers of
    /// the same ones, model units. It holds the pixels at an edge of the triangles: snapping may put a pixel's centre
    /// outside the triangle that covers it, and a renderer then follows the triangle's plane beyond the edge.
    pub edge_chord: Vec<f64>,
    /// Per face: what the accuracy of interpolated parameters amounts to, model units.
    pub attribute: Vec<f64>,
    /// Pixels: snapping of vertices.
    pub snap_px: f64,
    /// The first three in words.
    pub text: String,
}

impl Deviation {
    /// A rasterizer of flat triangles, whose chord bounds are given a face, against the surface itself.
    pub fn of_proxy(model: &Model, chord: &[f64]) -> Self {
        Self {
            chord: chord.to_vec(),
            edge_chord: chord.to_vec(),
            attribute: attribute(model),
            snap_px: SNAP_PX,
            text: format!(
                "chord bound of the tessellation (Filip, Magedson & Markot 1986) + {SNAP_PX} px of vertex snapping + \
                 {ATTRIBUTE_ULPS} ulp of interpolated parameters; rounding of S: its proven interval"
            ),
        }
    }

    /// Two rasterizers of the same triangles, whose chord bounds are given a face.
    pub fn of_same_proxy(model: &Model, chord: &[f64]) -> Self {
        Self {
            chord: vec![0.0; model.faces().len()],
            edge_chord: chord.to_vec(),
            attribute: attribute(model),
            snap_px: 2.0 * SNAP_PX,
            text: format!(
                "the same triangles, so no chord but at their edges: {} px of vertex snapping + {ATTRIBUTE_ULPS} ulp of interpolated \
                 parameters; rounding of S: its proven interval",
                2.0 * SNAP_PX
            ),
        }
    }

    /// The allowance in model units at face `face`.
    pub fn model_units(&self, face: usize) -> f64 {
        self.chord[face] + self.attribute[face]
    }
}

fn attribute(model: &Model) -> Vec<f64> {
    let per_surface: Vec<f64> = model.surfaces().iter().map(attribute_of).collect();
    model.faces().iter().map(|face| per_surface[face.surface]).collect()
}

fn attribute_of(surface: &Surface) -> f64 {
    let bounds = surface
        .bezier_patches()
        .iter()
        .map(|patch| patch.derivative_bounds())
        .fold(DerivativeBounds::default(), DerivativeBounds::max);
    let [[u0, u1], [v0, v1]] = surface.domain();
    ATTRIBUTE_ULPS / (1u64 << 24) as f64 * (bounds.u * (u1 - u0) + bounds.v * (v1 - v0))
}
