//! The mask of one face: its texels, its loops and their curves.

use bytemuck::{Pod, Zeroable};
use glam::DVec2;
use std::ops::Range;

/// The mask of a face in the atlas.
#[derive(Debug, Clone, PartialEq)]
pub struct Tile {
    /// Its first texel: column, row. Columns run along u, rows along v.
    pub corner: [u32; 2],
    /// Its texels; zeros where the region is empty.
    pub size: [u32; 2],
    /// The box of the region, local parameters. Outside there is no material.
    pub hull: [DVec2; 2],
    /// How far from an edge the mask may be wrong, in u and v, local parameters.
    pub band: DVec2,
    /// The same in space, pixels at the nearest depth of the face's control points.
    pub error_px: f64,
    /// The loops.
    pub rings: Vec<Ring>,
}

/// A loop of a mask.
#[derive(Debug, Clone, PartialEq)]
pub struct Ring {
    /// How many loops it lies in.
    pub depth: usize,
    /// Its curves among [`MaskPlan::curves`](super::MaskPlan::curves), closed in their order.
    pub curves: Range<usize>,
}

/// A curve of a loop, which is drawn as chords of equal parameter. 32 bytes; `MaskCurve` in `shaders/entry_mask.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct MaskCurve {
    /// The first texel of its tile.
    pub corner: [f32; 2],
    /// The loop's first point, from which fans of triangles start; texels from the corner.
    pub origin: [f32; 2],
    /// Index of its first control point.
    pub control: u32,
    /// Degree.
    pub degree: u32,
    /// How many chords all curves before it have.
    pub first_chord: u32,
    /// How many it has itself.
    pub chords: u32,
}

/// What a fragment needs to know of its tile, as numbers among the knots.
pub(crate) fn placement(tile: &Tile) -> [f32; 10] {
    let [low, high] = tile.hull;
    let size = DVec2::from_array(tile.size.map(f64::from));
    let texels = size / (high - low);
    let last = tile.size.map(|n| n.saturating_sub(1));
    if tile.size.contains(&0) {
        // No parameter is above 1 and below 0.
        return [1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    }
    let [[u, v], [u1, v1], [per_u, per_v]] = [low, high, texels].map(|x| x.to_array().map(|x| x as f32));
    let [[x, y], [x1, y1]] = [tile.corner, last].map(|x| x.map(|x| x as f32));
    [u, v, u1, v1, per_u, per_v, x, y, x1, y1]
}

/// The point of a curve at `t`, 0 to 1, texels from its tile's corner, by de Casteljau's algorithm.
pub(crate) fn curve_point(control: &[[f32; 4]], t: f32) -> [f32; 2] {
    let s = 1.0 - t;
    let mut points = [[0.0f32; 3]; nurbs::MAX_ORDER];
    for (point, c) in points.iter_mut().zip(control) {
        *point = [c[0], c[1], c[2]];
    }
    for remaining in (1..control.len()).rev() {
        for i in 0..remaining {
            points[i] = std::array::from_fn(|k| s * points[i][k] + t * points[i + 1][k]);
        }
    }
    let [x, y, w] = points[0];
    [x / w, y / w]
}
