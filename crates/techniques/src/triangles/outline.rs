//! Where in the picture a triangle may cover anything: a box and a strip, for a quick no.

use raster::geometry::Geometry;

/// More than snapping, and rounding within the guard band, move a corner, a position or an edge by, pixels.
const MARGIN_PX: f32 = 1.0 / 32.0;

/// The box of a triangle, and the strip along its longest edge as wide as the triangle is high: slivers have large boxes.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Outline {
    low: [f32; 2],
    high: [f32; 2],
    /// Of the strip, of length 1; zero where the triangle is a point.
    normal: [f32; 2],
    /// Between which places along the normal the strip lies.
    strip: [f32; 2],
}

impl Outline {
    pub(super) fn new(geometry: &Geometry, id: u32) -> Self {
        let [low, high] = geometry.extent(id);
        let corners = geometry.corners(id).map(|corner| corner.position.map(f64::from));
        let edge = |i: usize| [0, 1].map(|axis| corners[(i + 1) % 3][axis] - corners[i][axis]);
        let length = |i: usize| edge(i)[0].hypot(edge(i)[1]);
        let longest = (0..3).max_by(|&a, &b| length(a).total_cmp(&length(b))).expect("three edges");
        let ([x, y], length) = (edge(longest), length(longest));
        let normal = if length > 0.0 { [-y / length, x / length] } else { [0.0; 2] };
        let along = [0, 1, 2].map(|i| normal[0] * corners[i][0] + normal[1] * corners[i][1]);
        let strip =
            [along.into_iter().fold(f64::INFINITY, f64::min), along.into_iter().fold(f64::NEG_INFINITY, f64::max)];
        Self { low, high, normal: normal.map(|x| x as f32), strip: strip.map(|x| x as f32) }
    }

    /// Whether the triangle, its corners snapped, may cover a position.
    pub(super) fn may_cover(&self, at: [f32; 2]) -> bool {
        let within = |low: f32, x: f32, high: f32| low - MARGIN_PX <= x && x <= high + MARGIN_PX;
        let along = self.normal[0] * at[0] + self.normal[1] * at[1];
        (0..2).all(|axis| within(self.low[axis], at[axis], self.high[axis]))
            && within(self.strip[0], along, self.strip[1])
    }
}
