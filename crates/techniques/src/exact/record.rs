//! The record of a piece, as the CPU and the GPU read it. `shaders/exact/place.wgsl` declares the same one.

use bytemuck::{Pod, Zeroable};

/// A Bézier piece of a face, on which technique `exact` looks for the point that a pixel sees. 96 bytes.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct PieceRecord {
    /// Rows that take p − c, local, to the coordinates of the piece's hull, −1 … 1 in each; behind each row a coordinate
    /// of the hull's centre c.
    pub hull_from_local: [[f32; 4]; 3],
    /// Parameters at the hull's centre, then what they gain along its first two coordinates: the piece as if it were flat.
    pub flat: [f32; 4],
    /// The piece's parameters, local to its spans: u from, v from, u to, v to.
    pub rectangle: [f32; 4],
    /// The face.
    pub face: u32,
    /// Its span in u.
    pub span_u: u32,
    /// Its span in v.
    pub span_v: u32,
    /// How many steps that promise little a search on it takes before it gives up: 0, but where the piece is far from
    /// flat in its parameters.
    pub patience: u32,
}
