//! Pieces: nearly flat parts of a face's Bézier patches, each with a hull that holds it and grows with the pixels.
//!
//! A hull is a parallelepiped along the piece's mean derivatives and its mean normal. It holds the control points of
//! the piece and so, by the convex hull property, the piece. It is grown by [`GROW_PX`] pixels at its farthest depth,
//! so that no snapping of its corners keeps a pixel from it whose centre sees the surface.

use super::newton::PATIENCE;
use super::record::PieceRecord;
use crate::triangles::patches::patches_on;
use glam::DVec3;
use nurbs::{BezierPatch, Hull};
use pipeline::PackedScene;
use std::ops::Range;

/// How far a piece may turn along either parameter, radians: the second differences of its control points over the
/// first.
///
/// Less makes more hulls, which fit better and need fewer steps; more makes hulls that overlap in the picture.
const TURN: f64 = 0.5;

/// Halvings of a patch in each direction at most. A cusp never gets flat.
const GREATEST_LEVEL: u32 = 4;

/// Halvings in a direction along which weights vary by more than [`WEIGHTS_VARY`]: parameters run faster at one end of a piece by
/// as much, and each halving takes the root of it.
const GREATEST_LEVEL_BY_WEIGHTS: u32 = 8;

/// See [`GREATEST_LEVEL_BY_WEIGHTS`].
const WEIGHTS_VARY: f64 = 4.0;

/// Growth of a hull, pixels: corners snap to 1/256 pixel, and a proxy is drawn again while its model turns.
const GROW_PX: f64 = 1.0 / 16.0;

/// Growth of a hull as a share of itself: a flat piece has a hull of some thickness.
const GROW_SHARE: f64 = 1.0 / 4096.0;

/// Below this sine the mean derivatives span no parallelepiped.
const PARALLEL: f64 = 1e-3;

/// A piece before it is narrowed.
pub(crate) struct Piece {
    pub record: PieceRecord,
    /// The hull's corners in the face's local coordinates; bits 0, 1 and 2 of the index choose along its three axes.
    pub corners: [[f32; 3]; 8],
}

/// The 12 triangles of a hull by its corners, counterclockwise seen from outside.
pub(crate) const HULL_TRIANGLES: [[u32; 3]; 12] = [
    [0, 4, 6],
    [0, 6, 2], // first axis, −
    [1, 3, 7],
    [1, 7, 5], // first axis, +
    [0, 1, 5],
    [0, 5, 4], // second axis, −
    [2, 6, 7],
    [2, 7, 3], // second axis, +
    [0, 2, 3],
    [0, 3, 1], // third axis, −
    [4, 5, 7],
    [4, 7, 6], // third axis, +
];

/// The pieces of a face of `scene` whose surface has these patches. `model_units_a_pixel` tells what a pixel measures
/// at the farthest point of a box.
///
/// `patches` are all of the surface's, row-major in u; those on `spans` are cut.
pub(crate) fn pieces_of(
    scene: &PackedScene,
    face: usize,
    patches: &[BezierPatch],
    spans: &[Range<usize>; 2],
    model_units_a_pixel: impl Fn(&Hull) -> f64,
) -> Vec<Piece> {
    let frame = &scene.frames()[face];
    let spans_v = frame.breaks[1].len() - 1;
    let mut pieces = vec![];
    let numbered = patches_on(spans, spans_v).flat_map(|index| {
        let span = [index / spans_v, index % spans_v].map(|k| k as u32);
        nearly_flat(&patches[index]).into_iter().map(move |part| (span, part))
    });
    for (span, Part { patch, rectangle: [[u0, u1], [v0, v1]] }) in numbered {
        let points: Vec<DVec3> =
            patch.control.iter().map(|c| (patch.origin + c.truncate() / c.w - frame.origin) / frame.scale).collect();
        let axes = axes(&patch, &points);
        let grow = GROW_PX * model_units_a_pixel(&patch.hull()) / frame.scale + 4.0 * f64::from(f32::EPSILON);
        let hull = Parallelepiped::around(&points, axes, grow);
        let middle = points.iter().sum::<DVec3>() / points.len() as f64;
        // The piece as if it were flat: parameters grow along the first two axes.
        let [mid, gain] = hull.flat(middle, [[u0, u1], [v0, v1]].map(|t| t.map(f64::from)));
        let row = |k: usize| [hull.rows[k].x, hull.rows[k].y, hull.rows[k].z, hull.center[k]].map(|x| x as f32);
        pieces.push(Piece {
            record: PieceRecord {
                hull_from_local: [row(0), row(1), row(2)],
                flat: [mid[0], mid[1], gain[0], gain[1]].map(|x| x as f32),
                rectangle: [u0, v0, u1, v1],
                face: face as u32,
                span_u: span[0],
                span_v: span[1],
                patience: if is_twisted(&patch) { PATIENCE } else { 0 },
            },
            corners: hull.corners(),
        });
    }
    pieces
}

/// A part of a Bézier patch and its parameters, 0 … 1 over the whole of it: halves of halves, which f32 holds exactly.
struct Part {
    patch: BezierPatch,
    rectangle: [[f32; 2]; 2],
}

/// A patch cut until it turns by at most [`TURN`] along either parameter.
fn nearly_flat(patch: &BezierPatch) -> Vec<Part> {
    let mut flat = vec![];
    // By parameters of its own: far from zero the middle of a knot span is not in f64.
    let whole = BezierPatch { domain: [[0.0, 1.0]; 2], ..patch.clone() };
    let mut rest = vec![(Part { patch: whole, rectangle: [[0.0, 1.0]; 2] }, [0u32; 2])];
    while let Some((part, level)) = rest.pop() {
        let turn = turns(&part.patch);
        let varies = part.patch.weight_ratios_along();
        let cut = |k: usize| {
            (turn[k] > TURN && level[k] < GREATEST_LEVEL)
                || (varies[k] > WEIGHTS_VARY && level[k] < GREATEST_LEVEL_BY_WEIGHTS)
        };
        let middle = |k: usize| 0.5 * (part.patch.domain[k][0] + part.patch.domain[k][1]);
        let (halves, k) = if cut(0) && (turn[0] >= turn[1] || !cut(1)) {
            (part.patch.split_u(middle(0)), 0)
        } else if cut(1) {
            (part.patch.split_v(middle(1)), 1)
        } else {
            flat.push(part);
            continue;
        };
        let mut next = level;
        next[k] += 1;
        let [low, high] = part.rectangle[k];
        let between = 0.5 * (low + high);
        let ends = [[low, between], [between, high]];
        let halves = halves.into_iter().zip(ends).map(|(patch, ends)| {
            let mut rectangle = part.rectangle;
            rectangle[k] = ends;
            Part { patch, rectangle }
        });
        rest.extend(halves.rev().map(|half| (half, next)));
    }
    flat
}

/// Whether a derivative differs from its mean by more than [`TURN`] of its own least length somewhere.
fn is_twisted(patch: &BezierPatch) -> bool {
    let [p, q] = patch.degree;
    let at = |i: usize, j: usize| {
        let c = patch.control[i * (q + 1) + j];
        c.truncate() / c.w
    };
    let varies = |differences: Vec<DVec3>| {
        let least = differences.iter().fold(f64::INFINITY, |m: f64, d| m.min(d.length()));
        let mean = differences.iter().sum::<DVec3>() / differences.len() as f64;
        differences.iter().any(|d| d.distance(mean) > TURN * least)
    };
    let grid = |rows: usize, columns: usize| (0..rows).flat_map(move |i| (0..columns).map(move |j| (i, j)));
    varies(grid(p, q + 1).map(|(i, j)| at(i + 1, j) - at(i, j)).collect())
        || varies(grid(p + 1, q).map(|(i, j)| at(i, j + 1) - at(i, j)).collect())
}

/// How far the control polygons turn along u and v, about, in radians; twist counts for both.
fn turns(patch: &BezierPatch) -> [f64; 2] {
    let [p, q] = patch.degree;
    let at = |i: usize, j: usize| {
        let c = patch.control[i * (q + 1) + j];
        c.truncate() / c.w
    };
    let greatest = |rows: usize, columns: usize, f: &dyn Fn(usize, usize) -> DVec3| {
        (0..rows).flat_map(|i| (0..columns).map(move |j| (i, j))).fold(0.0, |m: f64, (i, j)| m.max(f(i, j).length()))
    };
    let first_u = p as f64 * greatest(p, q + 1, &|i, j| at(i + 1, j) - at(i, j));
    let first_v = q as f64 * greatest(p + 1, q, &|i, j| at(i, j + 1) - at(i, j));
    let second = |n: usize| (n * (n - 1)) as f64;
    let second_u = second(p) * greatest(p - 1, q + 1, &|i, j| at(i + 2, j) - 2.0 * at(i + 1, j) + at(i, j));
    let second_v = second(q) * greatest(p + 1, q - 1, &|i, j| at(i, j + 2) - 2.0 * at(i, j + 1) + at(i, j));
    let twist = (p * q) as f64 * greatest(p, q, &|i, j| at(i + 1, j + 1) - at(i + 1, j) - at(i, j + 1) + at(i, j));
    // A twisted piece turns about its u direction by the twist along v over the length in u, and the other way round.
    let over = |x: f64, length: f64| if length > 0.0 { x / length } else { 0.0 };
    let longest = first_u.max(first_v);
    [over(second_u, first_u).max(over(twist, longest)), over(second_v, first_v).max(over(twist, longest))]
}

/// Mean derivatives by u and v over the piece, and a normal; orthogonal ones in their place where they are parallel.
fn axes(patch: &BezierPatch, points: &[DVec3]) -> [DVec3; 3] {
    let [p, q] = patch.degree;
    let at = |i: usize, j: usize| points[i * (q + 1) + j];
    let mean_u = (0..=q).map(|j| at(p, j) - at(0, j)).sum::<DVec3>() / (q + 1) as f64;
    let mean_v = (0..=p).map(|i| at(i, q) - at(i, 0)).sum::<DVec3>() / (p + 1) as f64;
    let normal = mean_u.cross(mean_v);
    if normal.length() > PARALLEL * mean_u.length() * mean_v.length() && normal.length() > f64::MIN_POSITIVE {
        return [mean_u, mean_v, normal.normalize() * mean_u.length().max(mean_v.length())];
    }
    let longer = if mean_u.length() >= mean_v.length() { mean_u } else { mean_v };
    let Some(along) = longer.try_normalize() else { return [DVec3::X, DVec3::Y, DVec3::Z] };
    let across = along.any_orthonormal_vector();
    let frame = [along, across, along.cross(across)].map(|axis| axis * longer.length());
    if longer == mean_u { frame } else { [frame[1], -frame[0], frame[2]] }
}

/// A hull: its centre, and rows that give a point's three coordinates in it, −1 … 1.
struct Parallelepiped {
    center: DVec3,
    axes: [DVec3; 3],
    rows: [DVec3; 3],
    /// Half the hull along each axis, in axes.
    half: [f64; 3],
}

impl Parallelepiped {
    /// The parallelepiped along `axes` that holds `points`, grown by `grow` in every direction.
    fn around(points: &[DVec3], axes: [DVec3; 3], grow: f64) -> Self {
        let volume = axes[0].cross(axes[1]).dot(axes[2]);
        let dual = [axes[1].cross(axes[2]), axes[2].cross(axes[0]), axes[0].cross(axes[1])].map(|x| x / volume);
        let mut center = DVec3::ZERO;
        let mut half = [0.0; 3];
        for k in 0..3 {
            let (low, high) = points
                .iter()
                .map(|p| dual[k].dot(*p))
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
            center += axes[k] * (0.5 * (low + high));
            half[k] = 0.5 * (high - low) * (1.0 + GROW_SHARE) + GROW_SHARE + grow * dual[k].length();
        }
        let rows = std::array::from_fn(|k| dual[k] / half[k]);
        Self { center, axes, rows, half }
    }

    /// Parameters at the centre, and what they gain along the first two coordinates, of a flat piece whose middle is at
    /// `middle` and whose parameters run along the axes.
    fn flat(&self, middle: DVec3, domain: [[f64; 2]; 2]) -> [[f64; 2]; 2] {
        let gain = [0, 1].map(|k| (domain[k][1] - domain[k][0]) * self.half[k]);
        let mid =
            [0, 1].map(|k| 0.5 * (domain[k][0] + domain[k][1]) + gain[k] * self.rows[k].dot(self.center - middle));
        [mid, gain]
    }

    fn corners(&self) -> [[f32; 3]; 8] {
        std::array::from_fn(|i| {
            let corner = (0..3).fold(self.center, |p, k| {
                p + self.axes[k] * if i >> k & 1 == 0 { -self.half[k] } else { self.half[k] }
            });
            corner.to_array().map(|x| x as f32)
        })
    }
}
