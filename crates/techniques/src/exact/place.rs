//! A piece at one place of a search: where it is seen from a pixel, and how that changes. Twin of `shaders/exact/place.wgsl`.

use super::record::PieceRecord;
use lanes::{Kernel, Lanes};
use pipeline::PackedScene;
use pipeline::eval::{self, Basis, Derivatives};
use pipeline::sight::{Sight, dot, plane};
use std::cell::Cell;

/// What f32 may leave of an offset, as a share of the pixels that the face's own frame measures: eight roundings of S, and of
/// the parameters, each a share of itself.
pub const ROUNDING: f32 = 1.0 / 2097152.0;

/// How far beyond the piece the search may go, as a share of it: there the polynomial goes on.
pub const BEYOND: f32 = 1.0 / 8.0;

/// Below this sine of the angle between the ray and the piece, a piece counts as seen edge-on: as far as it turns, it
/// may have a fold.
pub const EDGE_ON: f32 = 3.0 / 8.0;

/// A place of the search.
#[derive(Debug, Clone, Copy)]
pub struct Place {
    /// Parameters of the span.
    pub uv: [f32; 2],
    /// w there.
    pub w: f32,
    /// Offset from the pixel, pixels; behind the eye, where w is not positive, this and all that follows are times w.
    pub offset: [f32; 2],
    /// Its square.
    pub squared: f32,
    /// The square of what f32 may leave of it.
    pub rounding_squared: f32,
    /// Derivative of the offset by u times the piece's extent in u.
    pub along_u: [f32; 2],
    /// The same for v.
    pub along_v: [f32; 2],
    /// The square of the piece's longer side in pixels, were it seen at a right angle.
    pub side_squared: f32,
    /// The square of the product of both sides.
    pub sides_squared: f32,
    /// Derivatives of the logarithm of w by u and v times the piece's extents.
    pub recedes: [f32; 2],
    /// z / w, and its derivatives by u and v times the piece's extents.
    pub depth: [f32; 3],
}

/// A pixel's ray, and the piece that it may meet.
pub struct Problem<'a> {
    /// The scene.
    pub scene: &'a PackedScene,
    /// The piece.
    pub piece: &'a PieceRecord,
    /// The ray.
    pub sight: &'a Sight,
    /// w where the ray comes into the hull, in front of the near plane.
    pub nearest_w: f32,
    /// Degrees of its face.
    pub degree: [usize; 2],
    /// How often the surface has been evaluated.
    pub evaluations: Cell<u32>,
}

/// The piece's surface at `N` places: S, S_u and S_v. `CAPACITY` is 4 for degrees 3, 6 for degrees 5, else the greatest order.
pub struct Points<'a, const CAPACITY: usize, const N: usize> {
    /// The scene.
    pub scene: &'a PackedScene,
    /// The piece.
    pub piece: &'a PieceRecord,
    /// Degrees of its face.
    pub degree: [usize; 2],
    /// Parameters of the span.
    pub uv: [[f32; 2]; N],
}

impl<const CAPACITY: usize, const N: usize> Kernel for Points<'_, CAPACITY, N> {
    type Output = [[Lanes<f32, N>; 3]; 3];

    #[inline(always)]
    fn run(self) -> Self::Output {
        let Self { scene, piece, degree, uv } = self;
        // Known to the compiler, which then unrolls every loop.
        let degree = match CAPACITY {
            4 => [3, 3],
            6 => [5, 5],
            _ => degree,
        };
        let face = &scene.faces()[piece.face as usize];
        let [span_u, span_v] = scene.spans(face, [piece.span_u, piece.span_v]);
        let [u, v] = [0, 1].map(|k| Lanes(uv.map(|uv| uv[k])));
        let nu: Basis<CAPACITY, N> = eval::basis(span_u.knots, degree[0], u, 1.0, false);
        let nv: Basis<CAPACITY, N> = eval::basis(span_v.knots, degree[1], v, 1.0, false);
        let first = [span_u.first, span_v.first];
        let d: Derivatives<N> = eval::surface(face, degree, scene.points(), first, &nu, &nv, false);
        [d.s, d.su, d.sv]
    }
}

impl Problem<'_> {
    /// Evaluates the piece; `is_divided` where the offset is wanted in pixels, in front of the eye.
    #[inline(always)]
    pub fn place<const CAPACITY: usize>(&self, uv: [f32; 2], is_divided: bool) -> Place {
        let &Self { scene, piece, degree, .. } = self;
        let point = Points::<CAPACITY, 1> { scene, piece, degree, uv: [uv] }.run();
        self.seen(uv, point.map(|x| x.map(|x| x.0[0])), is_divided)
    }

    /// The place where the surface is this.
    #[inline(always)]
    pub fn seen(&self, uv: [f32; 2], [s, su, sv]: [[f32; 3]; 3], is_divided: bool) -> Place {
        let &Self { piece, sight, ref evaluations, .. } = self;
        evaluations.set(evaluations.get() + 1);
        let extent = extent(piece);
        let w = plane(&sight.w, s);
        let divided = is_divided && w > 0.0;
        let divisor = if divided { w } else { 1.0 };
        let [x, y, depth] = [&sight.x, &sight.y, &sight.z].map(|p| plane(p, s) / divisor);
        // Times w, the offset has slopes of its own.
        let (offset, value) = ([x, y], if divided { [x, y, depth] } else { [0.0; 3] });
        let along = |derivative, extent: f32| sight.along(value, derivative).map(|slope| slope * (extent / divisor));
        let (along_u, along_v) = (along(su, extent[0]), along(sv, extent[1]));
        let squared_pixels = sight.squared_pixels(divisor);
        let side_u = dot(su, su) * (extent[0] * extent[0]) * squared_pixels;
        let side_v = dot(sv, sv) * (extent[1] * extent[1]) * squared_pixels;
        Place {
            uv,
            w,
            offset,
            squared: offset[0] * offset[0] + offset[1] * offset[1],
            rounding_squared: ROUNDING * ROUNDING * squared_pixels * (1.0 + shifted_squared(uv, su, sv)),
            along_u: [along_u[0], along_u[1]],
            along_v: [along_v[0], along_v[1]],
            side_squared: side_u.max(side_v),
            sides_squared: side_u * side_v,
            recedes: [along_u[3], along_v[3]],
            depth: [depth, along_u[2], along_v[2]],
        }
    }
}

/// The square of what S moves by where its parameters grow by shares of themselves. Their rounding is such a share, however fast S
/// runs: near 0 parameters are as fine as can be. Basis functions are sums of positive products, so that theirs is a share, too.
#[inline(always)]
fn shifted_squared(uv: [f32; 2], su: [f32; 3], sv: [f32; 3]) -> f32 {
    dot(su, su) * (uv[0] * uv[0]) + dot(sv, sv) * (uv[1] * uv[1])
}

/// The least and the greatest parameters to which the search may go.
#[inline(always)]
pub fn searched(piece: &PieceRecord) -> [[f32; 2]; 2] {
    let extent = extent(piece);
    [
        [0, 1].map(|k| piece.rectangle[k] - BEYOND * extent[k]),
        [0, 1].map(|k| piece.rectangle[2 + k] + BEYOND * extent[k]),
    ]
}

/// The piece's parameters, from first to last.
pub fn extent(piece: &PieceRecord) -> [f32; 2] {
    [piece.rectangle[2] - piece.rectangle[0], piece.rectangle[3] - piece.rectangle[1]]
}

/// Whether the piece is seen nearly edge-on there: what the tangent plane says does not reach far.
#[inline(always)]
pub fn is_edge_on(at: &Place) -> bool {
    let Place { along_u: a, along_v: b, .. } = *at;
    let det = a[0] * b[1] - a[1] * b[0];
    det * det < EDGE_ON * EDGE_ON * at.sides_squared
}
