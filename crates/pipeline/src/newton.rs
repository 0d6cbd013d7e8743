//! Ray ∩ piece by Newton's method, at a fragment of technique `exact`. Twin of `shaders/newton.wgsl`.
//!
//! The ray of a pixel is two planes ([`Sight`]): S(u, v) is on it where its offset from the pixel, in pixels, vanishes
//! in x and in y. The offset is the projection of S less the pixel's position, so its size means the same whatever the
//! distance, the focal length and the scale of the face.
//!
//! * **Seeds.** The ray enters and leaves the piece's hull; at both places the piece, taken as flat, says (u, v). Where
//!   the two are within a quarter of the piece they are one seed, half way. A piece is nearly flat, so a ray that
//!   meets it twice (a fold) meets it once from either end.
//! * **Steps.** Newton's step on the 2 × 2 system; where its columns are nearly parallel (a silhouette, a pole), a
//!   step of Levenberg and Marquardt. No step is longer than the piece, none leaves it by more than [`BEYOND`] of it. A
//!   step that brings the offset no nearer to zero is halved.
//! * **End.** At [`FINE_PX`]; where no step helps any more; after [`EVALUATIONS`].
//! * **Outcome.** A hit where the offset at the nearest (u, v) inside the piece is at most [`NEAR_PX`] (or what one
//!   ulp of the parameters moves) and the point is between the near and the far plane. A miss where the search came
//!   to the border, or where the offset has a minimum that is no zero. Anything else has not converged, and says so.

use crate::PackedScene;
use crate::eval::{self, Basis, Derivatives};
use crate::lanes::Lanes;
use crate::layout::{PieceRecord, View};
use nurbs::MAX_ORDER;

/// Evaluations of S from one seed, at most.
pub const EVALUATIONS: u32 = 24;

/// An offset that needs no further step, pixels.
pub const FINE_PX: f32 = 1.0 / 2048.0;

/// The greatest offset of a point that counts as on the ray, pixels.
pub const NEAR_PX: f32 = 1.0 / 256.0;

/// How far beyond the piece the search may go, as a share of it: there the polynomial goes on.
pub const BEYOND: f32 = 1.0 / 8.0;

/// Seeds nearer to each other than this share of the piece are one.
pub const ONE_SEED: f32 = 1.0 / 4.0;

/// Below this determinant, as a share of the squared columns, the columns count as nearly parallel.
pub const NEARLY_SINGULAR: f32 = 1.0 / 1024.0;

/// Weight of the damping then, as a share of the squared columns.
pub const DAMPING: f32 = 1.0 / 4096.0;

/// A rounding of either parameter, in local units: an ulp just below 1.
pub const PARAMETER_ULP: f32 = 1.0 / 16777216.0;

/// What a piece is to a pixel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Outcome {
    /// The pixel's ray meets it.
    Hit {
        /// Local parameters, inside the piece.
        uv: [f32; 2],
        /// z / w there.
        depth: f32,
    },
    /// It does not.
    Miss,
    /// The search ended without an answer.
    Unconverged,
}

/// A pixel's ray as planes in a face's local coordinates: offsets times w in x (right) and y (up), z, and w.
#[derive(Debug, Clone, Copy)]
pub struct Sight {
    x: [f32; 4],
    y: [f32; 4],
    z: [f32; 4],
    w: [f32; 4],
}

impl Sight {
    /// The ray through picture position `at`, pixels from the top left corner.
    #[inline]
    pub fn new(view: &View, at: [f32; 2]) -> Self {
        let m = &view.clip_from_local;
        let row = |r: usize| [m[0][r], m[1][r], m[2][r], m[3][r]];
        let (w, z) = (row(3), row(2));
        let [right, up] = [at[0] - view.units[1], view.units[2] - at[1]];
        let plane = |half: f32, clip: [f32; 4], across: f32| std::array::from_fn(|i| half * clip[i] - across * w[i]);
        Self { x: plane(view.units[1], row(0), right), y: plane(view.units[2], row(1), up), z, w }
    }
}

/// A place of the search.
#[derive(Debug, Clone, Copy)]
struct Place {
    uv: [f32; 2],
    /// Offset from the pixel, pixels.
    offset: [f32; 2],
    /// Its square; the greatest number behind the eye.
    squared: f32,
    /// Derivative of the offset by u times the piece's extent in u.
    along_u: [f32; 2],
    /// The same for v.
    along_v: [f32; 2],
    /// z / w.
    depth: f32,
    /// Whether the point is in front of the eye.
    in_front: bool,
}

/// The nearest point of a piece on a pixel's ray.
pub fn solve(scene: &PackedScene, piece: &PieceRecord, sight: &Sight) -> Outcome {
    let Some(seeds) = seeds(piece, sight) else { return Outcome::Miss };
    let face = &scene.faces[piece.face as usize];
    match [face.degree_u, face.degree_v] {
        [3, 3] => search_all::<4>(scene, piece, sight, [3, 3], seeds),
        [5, 5] => search_all::<6>(scene, piece, sight, [5, 5], seeds),
        [p, q] => search_all::<MAX_ORDER>(scene, piece, sight, [p as usize, q as usize], seeds),
    }
}

/// Parameters where the ray enters and leaves the hull, as if the piece were flat; `None` where it does not meet it in
/// front of the near plane.
#[inline]
fn seeds(piece: &PieceRecord, sight: &Sight) -> Option<[[f32; 2]; 2]> {
    let rows = &piece.hull_from_local;
    let center = [rows[0][3], rows[1][3], rows[2][3]];
    let [x, y] = [&sight.x, &sight.y].map(|p| [p[0], p[1], p[2]]);
    // The point of the ray nearest to the centre, about the centre.
    let (at_x, at_y) = (plane(&sight.x, center), plane(&sight.y, center));
    let (xx, xy, yy) = (dot(x, x), dot(x, y), dot(y, y));
    let det = xx * yy - xy * xy;
    let (a, b) = ((xy * at_y - yy * at_x) / det, (xy * at_x - xx * at_y) / det);
    let from: [f32; 3] = std::array::from_fn(|i| a * x[i] + b * y[i]);
    let direction = [x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0]];
    // The part of the ray inside the hull, and behind the near plane: w − z is not negative.
    let (mut near, mut far) = (f32::MIN, f32::MAX);
    for row in rows {
        let row = [row[0], row[1], row[2]];
        let (start, speed) = (dot(row, from), dot(row, direction));
        if speed != 0.0 {
            let (first, last) = ((-1.0 - start) / speed, (1.0 - start) / speed);
            near = near.max(first.min(last));
            far = far.min(first.max(last));
        }
    }
    let beyond: [f32; 4] = std::array::from_fn(|i| sight.w[i] - sight.z[i]);
    let start = plane(&beyond, std::array::from_fn(|i| center[i] + from[i]));
    let speed = dot([beyond[0], beyond[1], beyond[2]], direction);
    if speed > 0.0 {
        near = near.max(-start / speed);
    }
    if speed < 0.0 {
        far = far.min(-start / speed);
    }
    if near > far {
        return None;
    }
    let parameters = |along: f32| {
        let h = [0, 1].map(|k| {
            let row = [rows[k][0], rows[k][1], rows[k][2]];
            dot(row, from) + along * dot(row, direction)
        });
        let [u, v] = [0, 1].map(|k| piece.flat[k] + piece.flat[2 + k] * h[k]);
        [u.max(piece.rectangle[0]).min(piece.rectangle[2]), v.max(piece.rectangle[1]).min(piece.rectangle[3])]
    };
    Some([parameters(near), parameters(far)])
}

#[inline(always)]
fn search_all<const CAPACITY: usize>(
    scene: &PackedScene,
    piece: &PieceRecord,
    sight: &Sight,
    degree: [usize; 2],
    [first, last]: [[f32; 2]; 2],
) -> Outcome {
    let together = |k: usize| (first[k] - last[k]).abs() <= ONE_SEED * extent(piece)[k];
    let middle = [0, 1].map(|k| 0.5 * (first[k] + last[k]));
    let seeds: &[[f32; 2]] = if together(0) && together(1) { &[middle] } else { &[first, last] };
    let mut best = Outcome::Miss;
    for &seed in seeds {
        let next = search::<CAPACITY>(scene, piece, sight, degree, seed);
        best = match (best, next) {
            (Outcome::Hit { depth: old, .. }, Outcome::Hit { depth: new, .. }) if new <= old => best,
            (_, Outcome::Hit { .. }) | (Outcome::Miss, Outcome::Unconverged) => next,
            _ => best,
        };
    }
    best
}

fn extent(piece: &PieceRecord) -> [f32; 2] {
    [piece.rectangle[2] - piece.rectangle[0], piece.rectangle[3] - piece.rectangle[1]]
}

#[inline(always)]
fn search<const CAPACITY: usize>(
    scene: &PackedScene,
    piece: &PieceRecord,
    sight: &Sight,
    degree: [usize; 2],
    seed: [f32; 2],
) -> Outcome {
    let extent = extent(piece);
    let low = [0, 1].map(|k| piece.rectangle[k] - BEYOND * extent[k]);
    let high = [0, 1].map(|k| piece.rectangle[2 + k] + BEYOND * extent[k]);
    let mut uv = seed;
    let mut best = place::<CAPACITY>(scene, piece, sight, degree, uv);
    let mut step = newton_step(&best);
    let mut settled = false;
    for k in 0..EVALUATIONS {
        if k > 0 {
            let next = place::<CAPACITY>(scene, piece, sight, degree, uv);
            if settled {
                best = next;
                break;
            }
            if next.squared < best.squared {
                best = next;
                step = newton_step(&best);
            } else {
                settled = best.squared <= NEAR_PX * NEAR_PX;
                step = step.map(|x| x * 0.5);
            }
        }
        uv = [0, 1].map(|k| (best.uv[k] + step[k] * extent[k]).max(low[k]).min(high[k]));
        settled = settled || best.squared <= FINE_PX * FINE_PX || is_least(&best, low, high) || uv == best.uv;
        if settled {
            // Once more, at the nearest place inside the piece.
            uv = [0, 1].map(|k| best.uv[k].max(piece.rectangle[k]).min(piece.rectangle[2 + k]));
            if uv == best.uv {
                break;
            }
        }
    }
    if !settled || best.uv != uv {
        return Outcome::Unconverged;
    }
    if best.squared <= near_squared(&best, extent) && best.depth >= 0.0 && best.depth <= 1.0 {
        return Outcome::Hit { uv: best.uv, depth: best.depth };
    }
    Outcome::Miss
}

/// The square of the greatest offset of a hit: [`NEAR_PX`], or what an ulp of either parameter moves.
fn near_squared(at: &Place, extent: [f32; 2]) -> f32 {
    let along = |a: [f32; 2], extent: f32| (a[0] * a[0] + a[1] * a[1]).sqrt() / extent;
    let coarse = PARAMETER_ULP * (along(at.along_u, extent[0]) + along(at.along_v, extent[1]));
    let near = NEAR_PX.max(coarse);
    near * near
}

#[inline(always)]
fn place<const CAPACITY: usize>(
    scene: &PackedScene,
    piece: &PieceRecord,
    sight: &Sight,
    degree: [usize; 2],
    uv: [f32; 2],
) -> Place {
    let face = &scene.faces[piece.face as usize];
    let [ku, kv] = scene.knots(face);
    let [span_u, span_v] = [piece.span_u as usize, piece.span_v as usize];
    let nu: Basis<CAPACITY, 1> = eval::basis(ku, degree[0], span_u, Lanes([uv[0]]), false);
    let nv: Basis<CAPACITY, 1> = eval::basis(kv, degree[1], span_v, Lanes([uv[1]]), false);
    let d: Derivatives<1> = eval::surface(face, degree, &scene.points, span_u, span_v, &nu, &nv, false);
    let [s, su, sv] = [d.s, d.su, d.sv].map(|x| x.map(|x| x.0[0]));
    let extent = extent(piece);
    let w = plane(&sight.w, s);
    let offset = [plane(&sight.x, s) / w, plane(&sight.y, s) / w];
    // The derivative of a quotient: what is left of the plane's own slope is that of w, seen at the offset.
    let along = |derivative: [f32; 3], extent: f32| {
        let of = |p: &[f32; 4]| dot([p[0], p[1], p[2]], derivative);
        let slope = of(&sight.w);
        [(of(&sight.x) - offset[0] * slope) * (extent / w), (of(&sight.y) - offset[1] * slope) * (extent / w)]
    };
    Place {
        uv,
        offset,
        squared: if w > 0.0 { offset[0] * offset[0] + offset[1] * offset[1] } else { f32::MAX },
        along_u: along(su, extent[0]),
        along_v: along(sv, extent[1]),
        depth: plane(&sight.z, s) / w,
        in_front: w > 0.0,
    }
}

/// The step toward zero offset, as shares of the piece, at most one piece long.
#[inline]
fn newton_step(at: &Place) -> [f32; 2] {
    let Place { offset, along_u: a, along_v: b, .. } = *at;
    let det = a[0] * b[1] - a[1] * b[0];
    let (aa, bb) = (a[0] * a[0] + a[1] * a[1], b[0] * b[0] + b[1] * b[1]);
    let step = if det.abs() > NEARLY_SINGULAR * (aa + bb) {
        [(b[0] * offset[1] - b[1] * offset[0]) / det, (a[1] * offset[0] - a[0] * offset[1]) / det]
    } else {
        let damping = DAMPING * (aa + bb);
        let ab = a[0] * b[0] + a[1] * b[1];
        let (gu, gv) = (a[0] * offset[0] + a[1] * offset[1], b[0] * offset[0] + b[1] * offset[1]);
        let (uu, vv) = (aa + damping, bb + damping);
        let det = uu * vv - ab * ab;
        if det == 0.0 {
            return [0.0; 2];
        }
        [(ab * gv - vv * gu) / det, (ab * gu - uu * gv) / det]
    };
    let longest = step[0].abs().max(step[1].abs());
    if longest > 1.0 { [step[0] / longest, step[1] / longest] } else { step }
}

/// Whether the offset's tangent plane reaches nothing that is half as near, however far on the piece it is followed:
/// the offset has a minimum there that is no zero. At a border, what leads out of it does not count.
#[inline]
fn is_least(at: &Place, low: [f32; 2], high: [f32; 2]) -> bool {
    let Place { uv, offset, squared, along_u, along_v, in_front, .. } = *at;
    let fall = |along: [f32; 2], k: usize| {
        let slope = along[0] * offset[0] + along[1] * offset[1];
        let outward = (uv[k] <= low[k] && slope > 0.0) || (uv[k] >= high[k] && slope < 0.0);
        if outward { 0.0 } else { slope.abs() }
    };
    in_front && fall(along_u, 0) + fall(along_v, 1) < 0.25 * squared
}

#[inline(always)]
fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// A plane's value at a point.
#[inline(always)]
fn plane(p: &[f32; 4], at: [f32; 3]) -> f32 {
    p[0] * at[0] + p[1] * at[1] + p[2] * at[2] + p[3]
}
