//! How far across the ray a candidate's point may lie from what the reference shows, before any rounding of S itself.

use nurbs::{DerivativeBounds, Surface};
use rayon::prelude::*;
use scene::{Camera, Model, Viewport};

/// Vertices snap to 1/256 pixel, each coordinate by at most half of it; a viewport transform in f32 adds less than
/// the other half up to 16384 pixels.
pub const SNAP_PX: f64 = 1.0 / 256.0;

/// Interpolated parameters may be off by this many units of 2⁻²⁴ of the domain: WGSL states no accuracy of
/// interpolation. Of the models of the conformance tests, none needs more on llvmpipe or an H100.
pub const ATTRIBUTE_ULPS: f64 = 16.0;

/// A renderer that finds the point on the pixel's own ray, rather than on a triangle's, may be this far off, pixels.
pub const EXACT_PX: f64 = 0.01;

/// Loops are followed at the point on the pixel's own ray by every technique, to this, pixels: what a face is drawn too far
/// ([`pipeline::sight::NEAR_PX`]), what technique `exact` leaves of the way to that point, and rounding of positions.
pub const EDGE_PX: f64 = 0.01;

/// What the accuracy of interpolated parameters amounts to on each face of a model, model units.
#[derive(Debug, Clone, PartialEq)]
pub struct Interpolation(Vec<f64>);

impl Interpolation {
    /// [`ATTRIBUTE_ULPS`] of each domain at the greatest speeds of its surface.
    pub fn of(model: &Model) -> Self {
        let per_surface: Vec<f64> = model.surfaces().par_iter().map(attribute_of).collect();
        Self(model.faces().iter().map(|face| per_surface[face.surface]).collect())
    }
}

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
    /// Pixels: snapping of vertices; [`EXACT_PX`] where there are none.
    pub snap_px: f64,
    /// How near an edge of a face that loops bound may pass the centre of a pixel that is shown the wrong side of it, pixels.
    pub edge_px: f64,
    /// All of it in words.
    pub text: String,
}

impl Deviation {
    /// A rasterizer of flat triangles, whose chord bounds are given a face, against the surface itself.
    pub fn of_proxy(interpolation: &Interpolation, chord: &[Vec<f64>]) -> Self {
        let chord = greatest(chord);
        Self {
            chord: chord.clone(),
            edge_chord: chord,
            attribute: interpolation.0.clone(),
            snap_px: SNAP_PX,
            edge_px: EDGE_PX,
            text: format!(
                "chord bound of the tessellation (Filip, Magedson & Markot 1986) + {SNAP_PX} px of vertex snapping + \
                 {ATTRIBUTE_ULPS} ulp of interpolated parameters; rounding of S: its proven interval"
            ),
        }
    }

    /// Two rasterizers of the same triangles, whose chord bounds are given a face.
    pub fn of_same_proxy(interpolation: &Interpolation, chord: &[Vec<f64>]) -> Self {
        Self {
            chord: vec![0.0; chord.len()],
            edge_chord: greatest(chord),
            attribute: interpolation.0.clone(),
            snap_px: 2.0 * SNAP_PX,
            edge_px: 2.0 * EDGE_PX,
            text: format!(
                "the same triangles, so no chord but at their edges: {} px of vertex snapping + {ATTRIBUTE_ULPS} ulp of interpolated \
                 parameters; rounding of S: its proven interval",
                2.0 * SNAP_PX
            ),
        }
    }

    /// A rasterizer of flat triangles that are not known, but said to stay within `chord_px` pixels of S at their (u, v),
    /// pixels being measured at the nearest depth of each face's control points ([`Camera::pixel_at`]).
    ///
    /// `chord_px` is what the caller is ready to grant, not what a G-buffer says of itself.
    pub fn of_claimed_chord(model: &Model, camera: &Camera, viewport: Viewport, chord_px: f64) -> Self {
        let chord = |face: usize| chord_px * camera.pixel_at(viewport, model.surfaces()[face].hull());
        let chord: Vec<Vec<f64>> = model.faces().iter().map(|face| vec![chord(face.surface)]).collect();
        Self {
            edge_px: chord_px + SNAP_PX,
            text: format!(
                "claimed chord of {chord_px} px at each face's nearest depth + {SNAP_PX} px of vertex snapping + \
                 {ATTRIBUTE_ULPS} ulp of interpolated parameters"
            ),
            ..Self::of_proxy(&Interpolation::of(model), &chord)
        }
    }

    /// A renderer that solves for the point on the pixel's ray, against another that does: [`EXACT_PX`], and no chord.
    ///
    /// Rounding of the parameters found is not granted anything beside it.
    pub fn exact(model: &Model) -> Self {
        let none = vec![0.0; model.faces().len()];
        Self {
            chord: none.clone(),
            edge_chord: none.clone(),
            attribute: none,
            snap_px: EXACT_PX,
            edge_px: EDGE_PX,
            text: format!("{EXACT_PX} px from the pixel's ray"),
        }
    }

    /// What two renderers may differ by, each of which has an allowance of its own against the surface.
    pub fn either(&self, other: &Self) -> Self {
        let sum = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a + b).collect();
        Self {
            chord: sum(&self.chord, &other.chord),
            edge_chord: sum(&self.edge_chord, &other.edge_chord),
            attribute: sum(&self.attribute, &other.attribute),
            snap_px: self.snap_px + other.snap_px,
            edge_px: self.edge_px + other.edge_px,
            text: if self.text == other.text {
                format!("on either side {}", self.text)
            } else {
                format!("both of: {} | {}", self.text, other.text)
            },
        }
    }

    /// The allowance in model units at face `face`.
    pub fn model_units(&self, face: usize) -> f64 {
        self.chord[face] + self.attribute[face]
    }
}

/// The greatest of each face.
fn greatest(chord: &[Vec<f64>]) -> Vec<f64> {
    chord.iter().map(|pieces| pieces.iter().fold(0.0, |most: f64, chord| most.max(*chord))).collect()
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
