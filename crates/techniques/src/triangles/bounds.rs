//! Bounds of a surface's derivatives over its Bézier patches, from which the cells of a tessellation are counted.

use super::floor::floor;
use nurbs::{BezierPatch, DerivativeBounds};

/// Bounds of the derivatives of a surface's Bézier patches, part by part: of a patch with a large weight they differ by orders of
/// magnitude from one place to another.
pub struct Bounds {
    /// How many equal parts each span in u and in v is cut into.
    pub parts: [Vec<usize>; 2],
    /// Of each patch, row-major in u, its width and height, and of its parts, row-major in u, the bounds.
    pub patches: Vec<([f64; 2], Vec<DerivativeBounds>)>,
}

/// A span has one part where the weights of each patch on it vary by no more than this, else as many as the root of their ratio,
/// up to [`GREATEST_PARTS`]: parameters run so many times faster near the heavy point.
const WEIGHTS_VARY_MUCH: f64 = 8.0;

/// See [`WEIGHTS_VARY_MUCH`].
const GREATEST_PARTS: usize = 64;

impl Bounds {
    /// Those of all patches of a surface, row-major in u.
    pub fn of(patches: &[BezierPatch]) -> Self {
        let parts = part_counts(patches);
        let of_patch = |(index, patch): (usize, &BezierPatch)| {
            let size = patch.domain.map(|[start, end]| end - start);
            let counts = [parts[0][index / parts[1].len()], parts[1][index % parts[1].len()]];
            (size, parts_of(patch, counts).iter().map(BezierPatch::derivative_bounds).collect())
        };
        let patches = patches.iter().enumerate().map(of_patch).collect();
        Self { parts, patches }
    }

    /// Of each of these patches, whose surface they are, and each of its parts, row-major in u, the least levels by which normals at
    /// corners are known between them.
    pub fn floors(&self, patches: &[BezierPatch]) -> Vec<Vec<[u32; 2]>> {
        let of_patch = |(index, patch): (usize, &BezierPatch)| {
            let [k, l] = self.spans(index);
            parts_of(patch, [self.parts[0][k], self.parts[1][l]]).iter().map(floor).collect()
        };
        patches.iter().enumerate().map(of_patch).collect()
    }

    /// The spans of a patch, by their places in the lists of parts.
    pub fn spans(&self, index: usize) -> [usize; 2] {
        [index / self.parts[1].len(), index % self.parts[1].len()]
    }

    /// The greatest chord of a patch whose parts are cut into so many cells, along u and along v.
    pub fn chord(&self, index: usize, [u, v]: [&[usize]; 2]) -> f64 {
        let ([width, height], bounds) = &self.patches[index];
        let [width, height] = [width / u.len() as f64, height / v.len() as f64];
        let of_part = |(k, bounds): (usize, &DerivativeBounds)| {
            bounds.chord(width / u[k / v.len()] as f64, height / v[k % v.len()] as f64)
        };
        bounds.iter().enumerate().map(of_part).fold(0.0, f64::max)
    }
}

/// How many equal parts each span in u and in v of a surface with these patches, row-major in u, is cut into.
pub fn part_counts(patches: &[BezierPatch]) -> [Vec<usize>; 2] {
    let spans_v = patches.iter().take_while(|patch| patch.domain[0] == patches[0].domain[0]).count();
    let mut parts = [vec![1; patches.len() / spans_v], vec![1; spans_v]];
    for (index, ratio) in
        patches.iter().map(BezierPatch::weight_ratio).enumerate().filter(|(_, ratio)| *ratio > WEIGHTS_VARY_MUCH)
    {
        let count = (ratio.sqrt() as usize).next_power_of_two().min(GREATEST_PARTS);
        let [k, l] = [index / spans_v, index % spans_v];
        parts[0][k] = count.max(parts[0][k]);
        parts[1][l] = count.max(parts[1][l]);
    }
    parts
}

/// A patch cut into so many equal parts along u and along v, row-major in u.
pub fn parts_of(patch: &BezierPatch, [rows, columns]: [usize; 2]) -> Vec<BezierPatch> {
    let strips = cut(patch.clone(), rows, patch.domain[0], BezierPatch::split_u);
    let of_strip = |strip: BezierPatch| cut(strip, columns, patch.domain[1], BezierPatch::split_v);
    strips.into_iter().flat_map(of_strip).collect()
}

/// A patch cut into so many equal parts of a direction, by `split`.
fn cut(
    patch: BezierPatch,
    parts: usize,
    [start, end]: [f64; 2],
    split: impl Fn(&BezierPatch, f64) -> [BezierPatch; 2],
) -> Vec<BezierPatch> {
    let mut all = Vec::with_capacity(parts);
    let mut rest = patch;
    for k in 1..parts {
        let [part, beyond] = split(&rest, start + (end - start) * k as f64 / parts as f64);
        all.push(part);
        rest = beyond;
    }
    all.push(rest);
    all
}
