//! One seen point.

use glam::{DVec2, DVec3};
use nurbs::Normal;
use scene::FaceId;

/// The surface point that a pixel sees.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// The face.
    pub face: FaceId,
    /// Parameters in the surface's own knot domain.
    pub uv: DVec2,
    /// The same place by its knot spans, exactly; `None` where the renderer knows no more than `uv`.
    pub local: Option<LocalParameters>,
    /// Distance of the point along the pixel's unit ray, (S − o) · d, model units.
    pub t: f64,
    /// S(u, v) as the renderer evaluated it, world coordinates, model units.
    pub position: DVec3,
    /// Unit normal of the face (−(S_u × S_v) on a reversed face) with its status, as the renderer found it.
    pub normal: Normal,
    /// Principal curvatures, signed with that normal; `None` where the renderer has none (a degenerate point).
    pub curvature: Option<PrincipalCurvatures>,
    /// From the pixel's centre to the nearest place of the hit's own face's trim edges as they are seen in the picture:
    /// pixels, to the right and down, no longer than [`EDGE_REACH_PX`]. Its length is the signed distance of the centre,
    /// which has material: a half-plane bounded there covers more than half of the pixel. A renderer that shows a centre a
    /// little beyond the edge records the opposite offset.
    ///
    /// `None` where no edge is that near, and where edges were not asked for ([`GBuffer::has_edges`](crate::GBuffer::has_edges)).
    pub edge: Option<DVec2>,
}

/// Parameters local to a Bézier piece: f64 may not hold them in a knot domain that lies far from zero.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LocalParameters {
    /// The knot spans in u and v, counted from 0 among those that are not empty.
    pub span: [u32; 2],
    /// 0 … 1 across the spans.
    pub uv: DVec2,
}

/// How far from a pixel's centre trim edges are recorded, pixels, in any direction.
pub const EDGE_REACH_PX: f64 = 1.0;

/// The two principal curvatures, 1 / model unit, k1 ≥ k2.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PrincipalCurvatures {
    /// The greater.
    pub k1: f64,
    /// The lesser.
    pub k2: f64,
}

impl PrincipalCurvatures {
    /// The same surface seen from its other side: signs change, and with them the order.
    pub fn reversed(self) -> Self {
        Self { k1: -self.k2, k2: -self.k1 }
    }
}
