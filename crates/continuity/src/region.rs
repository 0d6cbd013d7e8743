//! Where a face has material: asked of points, and of rectangles that no trim comes near.

use glam::DVec2;
use nurbs::Rectangle;
use scene::{FaceId, Model, Piece};

/// Bisections for the place at which a trim has a given v.
const BISECTIONS: u32 = 50;

/// The material of a face.
pub struct Material<'m> {
    pieces: Vec<(&'m Piece, Rectangle)>,
    is_whole: bool,
}

impl<'m> Material<'m> {
    /// That of a face of a model.
    pub fn new(model: &'m Model, face: FaceId) -> Self {
        let region = model.trimmed_region(face);
        let pieces = region.map_or(&[][..], |region| region.pieces());
        Self { pieces: pieces.iter().map(|piece| (piece, piece.curve.hull())).collect(), is_whole: region.is_none() }
    }

    /// Whether a point of the domain is material: the winding number of the pieces, which are monotone.
    pub fn holds(&self, point: DVec2) -> bool {
        self.is_whole || self.pieces.iter().map(|(piece, hull)| crossing(piece, hull, point)).sum::<i32>() != 0
    }

    /// Whether a rectangle has no material; one that a trim comes near has.
    pub fn is_without(&self, min: DVec2, max: DVec2) -> bool {
        let rectangle = Rectangle { min, max };
        let is_met = || self.pieces.iter().any(|(piece, hull)| !piece.on_border && hull.meets(rectangle));
        !self.is_whole && !is_met() && !self.holds(0.5 * (min + max))
    }
}

/// What a piece adds to the winding number of a point: where the line from there to greater u crosses it.
fn crossing(piece: &Piece, hull: &Rectangle, point: DVec2) -> i32 {
    let [start, end] = [piece.curve.start(), piece.curve.end()];
    let is_level = (start.y <= point.y) != (end.y <= point.y);
    if !is_level || hull.max.x < point.x {
        return 0;
    }
    if point.x < hull.min.x {
        return piece.winding();
    }
    let [mut below, mut above] = if start.y < end.y { [0.0, 1.0] } else { [1.0, 0.0] };
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (below + above);
        *(if piece.curve.point(middle).y <= point.y { &mut below } else { &mut above }) = middle;
    }
    if point.x < piece.curve.point(below).x { piece.winding() } else { 0 }
}
