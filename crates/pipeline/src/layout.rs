//! The records that the CPU and the GPU read alike. `shaders/layout.wgsl` declares the same ones.

use bytemuck::{Pod, Zeroable};

/// [`FaceRecord::flags`]: control points carry weights that differ, so the quotient is taken.
pub const RATIONAL: u32 = 1;

/// [`FaceRecord::flags`]: the face's normal is −(S_u × S_v).
pub const REVERSED: u32 = 2;

/// [`FaceRecord::flags`]: loops bound the face, along the domain's border or inside it, and it is cut there
/// ([`crate::sight::is_shown`]); a tessellation of it goes on beyond the border.
pub const BOUNDED: u32 = 4;

/// [`Vertex::span`] where parameters are those of the whole domain: the program finds the knot span by binary search
/// (Kanai 2007, Sec. 3.1).
pub const SEARCHED: u32 = u32::MAX;

/// Numbers of a span's record before its knots: [`crate::eval::Span`].
pub const SPAN_HEAD: usize = 4;

/// Where a face's numbers stand in the shared knot and point arrays. 48 bytes.
///
/// Spans are the knot spans that are not empty, counted from 0. A direction's table among the knots holds, for `spans` spans of
/// degree p:
///
/// | numbers | what |
/// | --- | --- |
/// | spans + 1 | where each span starts, in parameters of the whole domain, 0 … 1; last, 1 |
/// | 4 + 2 p for each span | its [`Span`](crate::eval::Span): first control point, length, gain, 1 / (length × gain), and the 2 p knots that its basis functions rest on, moved so that the span is 0 … 1 |
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Pod, Zeroable)]
pub struct FaceRecord {
    /// Degree in u.
    pub degree_u: u32,
    /// Degree in v.
    pub degree_v: u32,
    /// Number of spans in u.
    pub spans_u: u32,
    /// Number of spans in v.
    pub spans_v: u32,
    /// Index of the first number of the table of spans in u.
    pub table_u: u32,
    /// Index of the first number of the table of spans in v.
    pub table_v: u32,
    /// Index of the first control point; row-major in u.
    pub points: u32,
    /// Number of control points in v: a row's length.
    pub count_v: u32,
    /// [`RATIONAL`], [`REVERSED`] and [`BOUNDED`].
    pub flags: u32,
    /// Index among the knots of the first number of the face's region ([`crate::trim`]), or of its mask's place
    /// ([`crate::mask`]).
    pub trims: u32,
    /// Number of the region's intervals, or 1 for a mask; 0 where the face is its whole surface.
    pub intervals: u32,
    /// Unused: 48 bytes.
    pub padding: u32,
}

/// A place of a face: parameters local to a Bézier piece, so that f32 resolves any span that f64 does.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameters {
    /// Spans in u and v, counted among those that are not empty; [`SEARCHED`] where `uv` are those of the whole domain.
    pub span: [u32; 2],
    /// 0 … 1 across the span.
    pub uv: [f32; 2],
}

impl Parameters {
    /// A place by parameters of the whole domain, 0 … 1: the program finds the span.
    pub fn searched(uv: [f32; 2]) -> Self {
        Self { span: [SEARCHED; 2], uv }
    }
}

/// How a face's local coordinates are seen. 96 bytes.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct View {
    /// Columns of the matrix from local to clip coordinates.
    pub clip_from_local: [[f32; 4]; 4],
    /// The eye in local coordinates and 1 (perspective), or the unit view direction and 0 (orthographic).
    pub eye: [f32; 4],
    /// 1 / (model units a local unit), by which a local curvature becomes one of the model; half the picture's width and
    /// height in pixels; the local units that a pixel covers where w is 1, which is as many times more elsewhere.
    pub units: [f32; 4],
}

/// A corner of a triangle of a mesh. 48 bytes.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct Vertex {
    /// S(u, v), or a hull's corner, in the local coordinates of the face `frame`.
    pub position: [f32; 3],
    /// [`Parameters::uv`], beyond 0 … 1 at the corner of a skirt; zeros where a technique has none.
    pub uv: [f32; 2],
    /// The face.
    pub face: u32,
    /// [`Parameters::span`]; zeros where a technique has none.
    pub span: [u32; 2],
    /// Unit normal of the surface there (zero where it has none, and at a hull's corner), for interpolated
    /// shading only.
    pub normal: [f32; 3],
    /// The face whose local coordinates the position has: of a corner that faces share, the same for all of them, so that it is
    /// seen at the same place to the bit.
    pub frame: u32,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn records_have_the_sizes_that_wgsl_gives_them() {
        assert_eq!(size_of::<FaceRecord>(), 48);
        assert_eq!(size_of::<View>(), 96);
        assert_eq!(size_of::<Vertex>(), 48);
    }
}
