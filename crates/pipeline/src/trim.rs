//! Whether a face has material at (u, v): trimming at the fragment, in f32. Twin of `shaders/trim.wgsl`.
//!
//! Direct trimming after Schollmeyer & Fröhlich, *Direct trimming of NURBS surfaces on the GPU* (SIGGRAPH 2009): the
//! boundary is cut into pieces on which u and v are monotone, and the domain at the ends of all pieces into intervals of
//! v. Inside an interval every piece runs from its lower to its upper end and none crosses another, so that they stand
//! in order of u. A fragment finds its interval and then, among the edges there, how many pass on its left: an odd
//! number means material. Both are binary searches; boxes answer nearly all questions, and a piece is bisected only where the
//! fragment is in its box.
//!
//! # Accuracy
//! Ends of pieces are the same f32 for both pieces that meet there, so no ray slips between them. Parameters can be told
//! the wrong side only of an edge that passes within [`PackedFrame::edge_band`](crate::PackedFrame::edge_band) of them.

mod pack;

use crate::layout::FaceRecord;
use crate::mask;
use crate::pack::PackedScene;
use std::ops::Range;

/// The greatest f32 below 1: parameters at the domain's end are classified as their neighbours inside.
pub const BELOW_ONE: f32 = 1.0 - f32::EPSILON / 2.0;

/// Halvings of a piece at most: then its parameter has no bits left.
pub const BISECTIONS: u32 = 24;

/// Whether `face` of the scene has material at local parameters, 0 … 1.
pub fn is_material(scene: &PackedScene, face: &FaceRecord, uv: [f32; 2]) -> bool {
    if face.intervals == 0 {
        return true;
    }
    if let Some(masks) = &scene.masks {
        return mask::is_material(scene, masks, face, uv);
    }
    locate(scene, face, uv.map(|t| t.min(BELOW_ONE))).is_some_and(|at| (at.left - at.edges.start) % 2 == 1)
}

/// Whether an edge of a face that is trimmed by its curves may be within `reach` of local parameters, in u and v: one of
/// the two beside them is, or another interval. A texel knows of no edges.
pub(crate) fn is_at_edge(scene: &PackedScene, face: &FaceRecord, uv: [f32; 2], reach: [f32; 2]) -> bool {
    if face.intervals == 0 || scene.masks.is_some() {
        return false;
    }
    let [u, v] = uv.map(|t| t.min(BELOW_ONE));
    let ends = &scene.knots[face.trims as usize..][..face.intervals as usize + 1];
    let Some(Located { interval, edges, left }) = locate(scene, face, [u, v]) else {
        return v + reach[1] >= ends[0] && v - reach[1] < ends[face.intervals as usize];
    };
    v - reach[1] < ends[interval]
        || v + reach[1] >= ends[interval + 1]
        || (left > edges.start && u - reach[0] < scene.points[left - 1][1])
        || (left < edges.end && u + reach[0] >= scene.points[left][0])
}

/// Where parameters are among a face's edges.
struct Located {
    /// Index of the interval that v is in.
    interval: usize,
    /// Its edges among the points.
    edges: Range<usize>,
    /// Those before this one pass on the left, the others do not.
    left: usize,
}

/// Finds parameters below 1 among the edges of a face; `None` below all intervals and above them.
fn locate(scene: &PackedScene, face: &FaceRecord, [u, v]: [f32; 2]) -> Option<Located> {
    let intervals = face.intervals as usize;
    let trims = &scene.knots[face.trims as usize..][..2 * (intervals + 1)];
    let (ends, starts) = trims.split_at(intervals + 1);
    if !(v >= ends[0] && v < ends[intervals]) {
        return None;
    }
    // ends[low] ≤ v < ends[high].
    let (mut low, mut high) = (0, intervals);
    while high - low > 1 {
        let middle = (low + high) / 2;
        if v < ends[middle] { high = middle } else { low = middle }
    }
    let edges = starts[low] as usize..starts[low + 1] as usize;
    let (mut left, mut right) = (edges.start, edges.end);
    while left < right {
        let middle = (left + right) / 2;
        if passes_left(&scene.points, scene.points[middle], [u, v]) { left = middle + 1 } else { right = middle }
    }
    Some(Located { interval: low, edges, left })
}

/// Whether an edge, (least u, greatest u, index of its piece) in the fragment's interval, passes on the left of it.
fn passes_left(points: &[[f32; 4]], edge: [f32; 4], at: [f32; 2]) -> bool {
    if at[0] < edge[0] {
        return false;
    }
    if at[0] >= edge[1] {
        return true;
    }
    let piece = edge[2] as usize;
    let [u, v, per_u, per_v] = points[piece];
    let (x, y) = ((at[0] - u) * per_u, (at[1] - v) * per_v);
    let degree = points[piece + 1][3] as usize;
    let control = &points[piece + 1..piece + 2 + degree];
    let (mut low, mut high) = (0.0, 1.0);
    let mut x_low = control[0][0] / control[0][2];
    let mut x_high = control[degree][0] / control[degree][2];
    for _ in 0..BISECTIONS {
        if x < x_low.min(x_high) {
            return false;
        }
        if x >= x_low.max(x_high) {
            return true;
        }
        let t = 0.5 * (low + high);
        let c = point(control, t);
        if c[1] <= y * c[2] {
            (low, x_low) = (t, c[0] / c[2]);
        } else {
            (high, x_high) = (t, c[0] / c[2]);
        }
    }
    x >= 0.5 * (x_low + x_high)
}

/// The homogeneous point of a piece, whose control points hold their binomial coefficients: Horner's scheme in t and
/// 1 − t (Farin, *Curves and Surfaces for CAGD*, Sec. 5.3).
pub(crate) fn point(control: &[[f32; 4]], t: f32) -> [f32; 3] {
    let s = 1.0 - t;
    let (last, rest) = control.split_last().expect("a curve has control points");
    let mut power = 1.0;
    let mut sum = [0.0; 3];
    for c in rest {
        for k in 0..3 {
            sum[k] = (sum[k] + power * c[k]) * s;
        }
        power *= t;
    }
    std::array::from_fn(|k| sum[k] + power * last[k])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Scheme;
    use scene::FaceId;

    /// The side by f64 bisection of the region's own pieces, and whether an edge passes within `band`.
    fn by_pieces(region: &scene::Region, uv: glam::DVec2, band: glam::DVec2) -> (bool, bool) {
        let (mut winding, mut near) = (0, false);
        for piece in region.pieces() {
            let hull = piece.curve.hull();
            let close = |k: usize| hull.min[k] - band[k] <= uv[k] && uv[k] <= hull.max[k] + band[k];
            if close(0) && close(1) {
                near |= (0..=4096).any(|i| {
                    let c = piece.curve.point(f64::from(i) / 4096.0) - uv;
                    let step = hull.size() / 2048.0;
                    c.x.abs() <= band.x + step.x && c.y.abs() <= band.y + step.y
                });
            }
            let (low, high) =
                (piece.curve.start().y.min(piece.curve.end().y), piece.curve.start().y.max(piece.curve.end().y));
            if !(low <= uv.y && uv.y < high) {
                continue;
            }
            let rises = piece.winding() > 0;
            let (mut a, mut b) = (0.0, 1.0);
            for _ in 0..60 {
                let t = 0.5 * (a + b);
                if (piece.curve.point(t).y <= uv.y) == rises { a = t } else { b = t }
            }
            if piece.curve.point(a).x > uv.x {
                winding += piece.winding();
            }
        }
        (winding != 0, near)
    }

    #[test]
    fn the_fragment_knows_its_side_but_for_a_band_along_the_edges() {
        for name in formats::TRIMMED.iter().map(|(name, _)| name) {
            let model = formats::builtin(name).expect("built in");
            let scene = PackedScene::new(&model, Scheme::General).expect("small");
            for (index, face) in scene.faces.iter().enumerate() {
                let Some(region) = model.region(FaceId(index as u32)) else { continue };
                let frame = &scene.frames[index];
                let size = region.domain().size();
                assert!(frame.edge_band.max_element() < 1e-5, "{name}: {}", frame.edge_band);
                let (mut tried, mut inside) = (0, 0);
                for i in 0..4000 {
                    let t =
                        [0.754_877_666_246_69, 0.569_840_290_998_05].map(|g: f64| (g * f64::from(i)).fract() as f32);
                    let (expected, near) = by_pieces(region, frame.uv(t), frame.edge_band * size);
                    if near {
                        continue;
                    }
                    assert_eq!(is_material(&scene, face, t), expected, "{name}, face {index}, at {t:?}");
                    tried += 1;
                    inside += usize::from(expected);
                }
                assert!(tried > 3000 && inside > 0, "{name}, face {index}: {inside} of {tried}");
            }
        }
    }
}
