//! The lines of a face's parameters between which every flat triangle is near enough to the surface.
//!
//! A triangle in a rectangle of du × dv is within (M_uu du² + 2 M_uv du dv + M_vv dv²) / 8 of the surface, where M bounds the
//! second derivatives there. Filip, Magedson & Markot (1986) say so of the rectangle's two halves, and it holds of any
//! triangle T in it: with L the linear interpolation and λ the barycentric coordinates of x, L(x) − S(x) = Σ λᵢ Rᵢ with
//! |Rᵢ| ≤ ½ q(|vᵢ − x|) by Taylor's formula, q the quadratic form of M; Σ λᵢ (vᵢ − x)² is a variance, at most du² / 4 along u
//! (Popoviciu), and so along v, and the mixed term by Cauchy and Schwarz.

use nurbs::{BezierPatch, DerivativeBounds, Surface};
use std::ops::Range;

/// Cells of one span in one direction at most.
const GREATEST_CELLS: usize = 1 << 22;

/// A border's point within this share of the domain of a line, and within [`SNAP_CELLS`] of the narrowest cell, lies on it:
/// no triangle is thinner.
const SNAP: f64 = 1e-9;

/// See [`SNAP`].
const SNAP_CELLS: f64 = 1e-3;

/// Bounds of a surface's derivatives by its Bézier patches.
pub(super) struct Bounds {
    /// Starts and ends of the spans in u and in v.
    spans: [Vec<[f64; 2]>; 2],
    /// Row-major in u.
    patches: Vec<DerivativeBounds>,
}

impl Bounds {
    pub fn new(surface: &Surface) -> Self {
        let patches = surface.bezier_patches();
        let columns = patches.iter().take_while(|patch| patch.domain[0] == patches[0].domain[0]).count();
        let u = patches.iter().step_by(columns).map(|patch| patch.domain[0]).collect();
        let v = patches[..columns].iter().map(|patch| patch.domain[1]).collect();
        Self { spans: [u, v], patches: patches.iter().map(BezierPatch::derivative_bounds).collect() }
    }

    /// Those of the patch at (u, v).
    pub fn at(&self, uv: [f64; 2]) -> &DerivativeBounds {
        let [k, l] = [0, 1].map(|axis| {
            let spans = &self.spans[axis];
            spans.partition_point(|[_, end]| *end <= uv[axis]).min(spans.len() - 1)
        });
        &self.patches[k * self.spans[1].len() + l]
    }

    /// The spans that meet a range of each parameter.
    fn meeting(&self, ranges: [[f64; 2]; 2]) -> [Range<usize>; 2] {
        [0, 1].map(|axis| {
            let (spans, [low, high]) = (&self.spans[axis], ranges[axis]);
            let first = spans.partition_point(|[_, end]| *end <= low).min(spans.len() - 1);
            let last = spans.partition_point(|[start, _]| *start < high).max(first + 1);
            first..last
        })
    }
}

/// How a face is cut: the counts of cells that each span has.
pub(super) struct Plan {
    ranges: [[f64; 2]; 2],
    meeting: [Range<usize>; 2],
    counts: [Vec<usize>; 2],
    /// No point of a triangle within the cells is farther from the surface, model units.
    pub chord: f64,
}

impl Plan {
    /// The cells of the part of a surface within `ranges` whose chords are at most `allowed`, model units.
    pub fn new(bounds: &Bounds, ranges: [[f64; 2]; 2], allowed: f64) -> Self {
        let meeting = bounds.meeting(ranges);
        let mut counts = [0, 1].map(|axis: usize| vec![1usize; meeting[axis].len()]);
        let size = |axis: usize, k: usize| bounds.spans[axis][k][1] - bounds.spans[axis][k][0];
        let each = || meeting[0].clone().flat_map(|k| meeting[1].clone().map(move |l| [k, l]));
        for [k, l] in each() {
            let own = &bounds.patches[k * bounds.spans[1].len() + l];
            let [i, j] = [k - meeting[0].start, l - meeting[1].start];
            let least = [counts[0][i], counts[1][j]];
            [counts[0][i], counts[1][j]] =
                own.cells([size(0, k), size(1, l)], allowed, least, [GREATEST_CELLS, usize::MAX]);
        }
        let chord = each().map(|[k, l]| {
            let [i, j] = [k - meeting[0].start, l - meeting[1].start];
            let own = &bounds.patches[k * bounds.spans[1].len() + l];
            own.chord(size(0, k) / counts[0][i] as f64, size(1, l) / counts[1][j] as f64)
        });
        let chord = chord.fold(0.0, f64::max);
        Self { ranges, meeting, counts, chord }
    }

    /// How many triangles the cells come to, about.
    pub fn triangles(&self, bounds: &Bounds) -> f64 {
        let along = |axis: usize| -> f64 {
            let [low, high] = self.ranges[axis];
            let of_span = |(k, n): (usize, &usize)| {
                let [start, end] = bounds.spans[axis][self.meeting[axis].start + k];
                (*n as f64 * ((end.min(high) - start.max(low)) / (end - start)).clamp(0.0, 1.0)).max(1.0)
            };
            self.counts[axis].iter().enumerate().map(of_span).sum()
        };
        2.0 * along(0) * along(1)
    }

    /// The lines between the cells.
    pub fn grid(&self, bounds: &Bounds) -> Grid {
        let lines = [0, 1].map(|axis: usize| {
            let [low, high] = self.ranges[axis];
            let spans = &bounds.spans[axis][self.meeting[axis].clone()];
            let of_span = |([start, end], n): (&[f64; 2], &usize)| {
                let (start, end, n) = (*start, *end, *n as f64);
                (0..n as usize).map(move |i| start + (end - start) * (i as f64 / n))
            };
            let end = spans[spans.len() - 1][1];
            let mut lines: Vec<f64> = spans.iter().zip(&self.counts[axis]).flat_map(of_span).chain([end]).collect();
            lines.dedup();
            let first = lines.partition_point(|line| *line <= low).saturating_sub(1);
            let last = lines.partition_point(|line| *line < high).min(lines.len() - 1).max(first + 1);
            lines[first..=last].to_vec()
        });
        let snap = [0, 1].map(|axis: usize| {
            let all = &bounds.spans[axis];
            let narrowest = lines[axis].windows(2).map(|pair| pair[1] - pair[0]).fold(f64::INFINITY, f64::min);
            (SNAP * (all[all.len() - 1][1] - all[0][0])).min(SNAP_CELLS * narrowest)
        });
        Grid { lines, snap }
    }
}

/// Lines of constant u and of constant v, ascending; at least two of each.
pub(super) struct Grid {
    pub lines: [Vec<f64>; 2],
    /// Two points of the border within this of each other, and of a line, are one, and on it.
    pub snap: [f64; 2],
}

impl Grid {
    /// The point, put on the lines that it is next to.
    pub fn snapped(&self, mut uv: glam::DVec2) -> glam::DVec2 {
        for axis in [0, 1] {
            let lines = &self.lines[axis];
            let next = lines.partition_point(|line| *line <= uv[axis]);
            for near in [next.checked_sub(1), Some(next)].into_iter().flatten().filter_map(|k| lines.get(k)) {
                if (near - uv[axis]).abs() <= self.snap[axis] {
                    uv[axis] = *near;
                }
            }
        }
        uv
    }

    /// The lines of an axis strictly between two values.
    pub fn between(&self, axis: usize, a: f64, b: f64) -> &[f64] {
        let (lines, low, high) = (&self.lines[axis], a.min(b), a.max(b));
        let first = lines.partition_point(|line| *line <= low);
        let end = lines.partition_point(|line| *line < high).max(first);
        &lines[first..end]
    }

    /// The line of an axis that is exactly at a value.
    pub fn line(&self, axis: usize, at: f64) -> Option<usize> {
        let k = self.lines[axis].partition_point(|line| *line < at);
        (self.lines[axis].get(k) == Some(&at)).then_some(k)
    }

    /// The cell of an axis that holds a value, the upper one on a line between two.
    pub fn cell(&self, axis: usize, at: f64) -> usize {
        let lines = &self.lines[axis];
        lines.partition_point(|line| *line <= at).clamp(1, lines.len() - 1) - 1
    }
}
