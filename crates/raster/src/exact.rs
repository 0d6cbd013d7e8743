//! Technique `exact`: hulls cover pixels, and each looks for the piece inside.
//!
//! A hull is drawn by its far side alone: each pixel of it has one fragment then, and has it, too, where the near plane
//! or the eye is inside the hull.

use crate::Rasterizer;
use crate::setup::Triangle;
use pipeline::Sight;
use pipeline::newton::{self, Outcome};

/// Vertices of a hull.
const CORNERS: u32 = 8;

/// The piece of a triangle of a hull's far side, and the triangle set up for samples `shift` pixels off the pixels'
/// centres; `None` for the near side, and where snapping leaves no area.
pub fn far_side(raster: &Rasterizer, id: u32, shift: [f32; 2]) -> Option<(usize, Triangle)> {
    let Rasterizer { drawing, geometry } = raster;
    let triangle = Triangle::new(geometry.corners(drawing, id), shift)?;
    // Triangles run counterclockwise seen from outside, so what is seen from inside runs clockwise.
    let piece = geometry.first_vertex(drawing, id) / CORNERS;
    (!triangle.is_counterclockwise()).then_some((piece as usize, triangle))
}

/// Looks for a piece at a position of the picture, pixels from the top left corner.
pub fn look(raster: &Rasterizer, piece: usize, at: [f32; 2]) -> Outcome {
    let drawing = &raster.drawing;
    let piece = &drawing.proxy.pieces[piece];
    newton::solve(drawing.scene, piece, &Sight::new(&drawing.views[piece.face as usize], at)).outcome
}
