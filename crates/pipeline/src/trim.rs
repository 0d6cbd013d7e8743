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
use crate::packed::PackedScene;

/// The greatest f32 below 1: parameters at the domain's end are classified as their neighbours inside.
pub const BELOW_ONE: f32 = 1.0 - f32::EPSILON / 2.0;

/// Halvings of a piece at most: then its parameter has no bits left.
pub const BISECTIONS: u32 = 24;

/// Whether `face` of the scene has material at local parameters, 0 … 1.
pub fn is_material(scene: &PackedScene, face: &FaceRecord, uv: [f32; 2]) -> bool {
    is_near_material(scene, face, uv, &Reach::NONE)
}

/// An ellipse of parameters: what is near a place, whatever the direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reach {
    /// A symmetric matrix G (uu, uv, vv): the ellipse goes as far as G n / √(n · G n) toward direction n.
    pub metric: [f32; 3],
    /// How far it goes in u and in v.
    pub extent: [f32; 2],
}

impl Reach {
    /// The place alone.
    pub const NONE: Self = Self { metric: [0.0; 3], extent: [0.0; 2] };

    /// How far it goes toward `n`.
    #[inline]
    fn toward(&self, n: [f32; 2]) -> [f32; 2] {
        let [uu, uv, vv] = self.metric;
        let g = [uu * n[0] + uv * n[1], uv * n[0] + vv * n[1]];
        let squared = n[0] * g[0] + n[1] * g[1];
        if squared > 0.0 { g.map(|x| x / squared.sqrt()) } else { [0.0; 2] }
    }
}

/// Whether `face` of the scene has material within reach of local parameters, 0 … 1. Of masks, only in the middle.
pub fn is_near_material(scene: &PackedScene, face: &FaceRecord, uv: [f32; 2], reach: &Reach) -> bool {
    if face.intervals == 0 {
        return true;
    }
    if let Some(masks) = scene.masks() {
        return mask::is_material(scene.knots(), masks, face, uv);
    }
    let at = uv.map(|t| t.min(BELOW_ONE));
    let here = side(scene, face, at, reach);
    // Beyond a level edge or a corner is another interval.
    let beyond = |sign: f32| {
        let up = reach.toward([0.0, 1.0]);
        side(scene, face, [0, 1].map(|k| (at[k] + sign * up[k]).min(BELOW_ONE)), &Reach::NONE).material
    };
    here.material
        || (at[1] - reach.extent[1] < here.low && beyond(-1.0))
        || (at[1] + reach.extent[1] >= here.high && beyond(1.0))
}

/// On which side of its edges a face has parameters.
struct Side {
    material: bool,
    /// The interval of v that they are in, or that is beside all intervals.
    low: f32,
    high: f32,
}

/// Finds parameters below 1 among the edges of a face, each moved out of the material as far as `reach` goes.
fn side(scene: &PackedScene, face: &FaceRecord, at: [f32; 2], reach: &Reach) -> Side {
    let intervals = face.intervals as usize;
    let trims = &scene.knots()[face.trims as usize..][..2 * (intervals + 1)];
    let (ends, starts) = trims.split_at(intervals + 1);
    if at[1] < ends[0] {
        return Side { material: false, low: f32::MIN, high: ends[0] };
    }
    if at[1] >= ends[intervals] {
        return Side { material: false, low: ends[intervals], high: f32::MAX };
    }
    // ends[low] ≤ v < ends[high].
    let (mut low, mut high) = (0, intervals);
    while high - low > 1 {
        let middle = (low + high) / 2;
        if at[1] < ends[middle] { high = middle } else { low = middle }
    }
    let [first, end] = [starts[low], starts[low + 1]].map(|index| index as usize);
    // Edges before `left` pass on the left, those from `right` on do not. Two that were moved past each other are both
    // before it or both behind: between them is material.
    let (mut left, mut right) = (first, end);
    while left < right {
        let middle = (left + right) / 2;
        let inward = if (middle - first) % 2 == 0 { 1.0 } else { -1.0 };
        if passes_left(scene.points(), scene.points()[middle], at, reach, inward) {
            left = middle + 1;
        } else {
            right = middle;
        }
    }
    Side { material: (left - first) % 2 == 1, low: ends[low], high: ends[high] }
}

/// Whether an edge, (least u, greatest u, index of its piece, 1 or −1 as u rises or falls with v) in the fragment's
/// interval, passes on the left of it; `inward` is 1 where the material is on the edge's right, and −1 where it is on
/// the left.
fn passes_left(points: &[[f32; 4]], edge: [f32; 4], at: [f32; 2], reach: &Reach, inward: f32) -> bool {
    let moved = at[0] + inward * reach.extent[0];
    if at[0].max(moved) < edge[0] {
        return false;
    }
    if at[0].min(moved) >= edge[1] {
        return true;
    }
    let piece = edge[2] as usize;
    let [u, v, per_u, per_v] = points[piece];
    // Across the piece's chord; an upright one has no extent in u.
    let across = if per_u > 0.0 { [per_u, -edge[3] * per_v] } else { [1.0, 0.0] };
    let shift = reach.toward(across);
    if per_u <= 0.0 {
        return at[0] + inward * shift[0] >= u;
    }
    let (x, y) = ((at[0] + inward * shift[0] - u) * per_u, (at[1] + inward * shift[1] - v) * per_v);
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
    use glam::DVec2;
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
        for name in models::TRIMMED.iter().map(|(name, _)| name) {
            let model = models::builtin(name).expect("built in");
            let scene = PackedScene::new(&model, Scheme::General).expect("small");
            for (index, face) in scene.faces().iter().enumerate() {
                let Some(region) = model.region(FaceId(index as u32)) else { continue };
                let frame = &scene.frames()[index];
                let size = region.domain().size();
                let uv = |t: [f32; 2]| region.domain().min + size * DVec2::from_array(t.map(f64::from));
                assert!(frame.edge_band.max_element() < 1e-5, "{name}: {}", frame.edge_band);
                let (mut tried, mut inside) = (0, 0);
                for i in 0..4000 {
                    let t =
                        [0.754_877_666_246_69, 0.569_840_290_998_05].map(|g: f64| (g * f64::from(i)).fract() as f32);
                    let (expected, near) = by_pieces(region, uv(t), frame.edge_band * size);
                    if near {
                        continue;
                    }
                    assert_eq!(is_material(&scene, face, t), expected, "{name}, face {index}, at {t:?}");
                    // An ellipse with its longer axis in any direction, and a band that holds it.
                    let [a, b] = [f64::from(i).sin(), f64::from(i).cos()].map(|x| x as f32 * 1e-3);
                    let metric = [a * a + 0.01 * b * b, 0.99 * a * b, b * b + 0.01 * a * a];
                    let reach = Reach { metric, extent: [metric[0].sqrt(), metric[2].sqrt()] };
                    let (_, near) = by_pieces(region, uv(t), DVec2::splat(1.1e-3) * size);
                    if !near {
                        let found = is_near_material(&scene, face, t, &reach);
                        assert_eq!(found, expected, "{name}, face {index}, near {t:?}");
                    }
                    tried += 1;
                    inside += usize::from(expected);
                }
                assert!(tried > 3000 && inside > 0, "{name}, face {index}: {inside} of {tried}");
            }
        }
    }
}
