//! Which borders and corners patches share, so that all of them may have the same there.
//!
//! Inside a face neighbours share them by their spans. Between faces that no loops bound, borders are shared whose control points
//! coincide, in either direction, and corners that do. Where a border of one face runs along a part of another's, or in another
//! parametrization, nothing is shared: a gap is left there, as wide as both chords together.

use super::record::{BorderRecord, CornerRecord};
use glam::DVec3;
use nurbs::BezierPatch;
use std::ops::Range;

/// Points that are nearer to each other than this share of the model's size are one.
const SAME: f64 = 1e-12;

/// Weights that differ by less than this share are one.
const SAME_WEIGHT: f64 = 1e-12;

/// A patch of a face.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Site {
    /// The face.
    pub face: u32,
    /// Its spans.
    pub span: [u32; 2],
}

/// What a face comes to.
pub struct FacePatches<'a> {
    /// All patches of its surface, row-major in u.
    pub patches: &'a [BezierPatch],
    /// The spans in u and in v that it comes to.
    pub spans: [Range<usize>; 2],
    /// How many spans the surface has in v.
    pub columns: usize,
    /// Whether loops bound it: then its outer borders are its own, and have skirts.
    pub is_bounded: bool,
}

/// A border: which patch's, and the place of its side in [`GridRecord::borders`](super::record::GridRecord::borders).
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Border {
    site: Site,
    side: usize,
}

/// A border in space.
struct Curve {
    border: Border,
    points: Vec<DVec3>,
    /// Relative to the first.
    weights: Vec<f64>,
}

/// What patches share.
pub struct Joints {
    /// Of each face and each of its patches by number among those that it comes to, row-major: for each side the group of borders
    /// that it is of.
    pub groups: Vec<Vec<[usize; 4]>>,
    /// Where each patch evaluates its borders, without levels.
    pub borders: Vec<Vec<[BorderRecord; 4]>>,
    /// Where each patch evaluates its corners.
    pub corners: Vec<Vec<[CornerRecord; 4]>>,
    /// How many groups of borders there are.
    pub count: usize,
}

/// Sets of numbers, joined pair by pair.
struct Sets(Vec<usize>);

impl Sets {
    /// The least number of the set that a number is of.
    fn least(&self, mut k: usize) -> usize {
        while self.0[k] != k {
            k = self.0[k];
        }
        k
    }

    /// The least number of both stands for the joined set.
    fn join(&mut self, a: usize, b: usize) {
        let roots = [self.least(a), self.least(b)];
        let [least, other] = [roots[0].min(roots[1]), roots[0].max(roots[1])];
        self.0[other] = least;
        // What was asked about is near its root the next time.
        (self.0[a], self.0[b]) = (least, least);
    }
}

impl Joints {
    /// Those of all faces; `size` is the model's.
    pub fn new(faces: &[FacePatches], size: f64) -> Self {
        let sites: Vec<Vec<Site>> = faces.iter().enumerate().map(|(id, face)| face.sites(id as u32)).collect();
        let firsts: Vec<usize> = sites
            .iter()
            .scan(0, |sum, sites| {
                *sum += sites.len();
                Some(*sum - sites.len())
            })
            .collect();
        let all: Vec<Site> = sites.iter().flatten().copied().collect();
        let mut borders = Sets((0..4 * all.len()).collect());
        let mut corners = Sets((0..4 * all.len()).collect());
        let mut curves = vec![];
        for (id, face) in faces.iter().enumerate() {
            let [us, vs] = face.spans.clone();
            let (rows, columns) = (us.len(), vs.len());
            let number = |k: usize, l: usize| 4 * (firsts[id] + k * columns + l);
            for k in 0..rows {
                for l in 0..columns {
                    if k + 1 < rows {
                        borders.join(number(k, l) + 1, number(k + 1, l));
                        (0..2).for_each(|end| corners.join(number(k, l) + 2 + end, number(k + 1, l) + end));
                    }
                    if l + 1 < columns {
                        borders.join(number(k, l) + 3, number(k, l + 1) + 2);
                        (0..2).for_each(|end| corners.join(number(k, l) + 2 * end + 1, number(k, l + 1) + 2 * end));
                    }
                    if !face.is_bounded {
                        let is_outer = [k == 0, k + 1 == rows, l == 0, l + 1 == columns];
                        let patch = &face.patches[(us.start + k) * face.columns + vs.start + l];
                        let site = all[number(k, l) / 4];
                        let outer = (0..4).filter(|side| is_outer[*side]);
                        curves.extend(outer.map(|side| Curve::new(Border { site, side }, patch, number(k, l) + side)));
                    }
                }
            }
        }
        let near = SAME * size;
        let mut reversed = vec![false; 4 * all.len()];
        join_curves(&curves, near, &mut borders, &mut reversed);
        join_corners(&curves, near, &mut corners);
        let of_patch = |number: usize| {
            let record = |side: usize| {
                let own = 4 * number + side;
                let owner = borders.least(own);
                let is_turned = reversed[own] != reversed[owner];
                border_record(all[owner / 4], owner % 4, is_turned)
            };
            std::array::from_fn(record)
        };
        let corner = |number: usize| {
            let record = |k: usize| {
                let owner = corners.least(4 * number + k);
                let (Site { face, span }, k) = (all[owner / 4], owner % 4);
                CornerRecord { face, padding: 0, span, uv: [(k / 2) as f32, (k % 2) as f32] }
            };
            std::array::from_fn(record)
        };
        let group = |number: usize| std::array::from_fn(|side| borders.least(4 * number + side));
        let per_face = |id: usize| firsts[id]..firsts[id] + sites[id].len();
        Self {
            groups: (0..faces.len()).map(|id| per_face(id).map(group).collect()).collect(),
            borders: (0..faces.len()).map(|id| per_face(id).map(of_patch).collect()).collect(),
            corners: (0..faces.len()).map(|id| per_face(id).map(corner).collect()).collect(),
            count: 4 * all.len(),
        }
    }
}

impl FacePatches<'_> {
    fn sites(&self, face: u32) -> Vec<Site> {
        let [us, vs] = self.spans.clone();
        let columns = |k: usize| vs.clone().map(move |l| Site { face, span: [k as u32, l as u32] });
        us.flat_map(columns).collect()
    }
}

impl Curve {
    fn new(border: Border, patch: &BezierPatch, number: usize) -> (Self, usize) {
        let [rows, columns] = [0, 1].map(|k| patch.degree[k] + 1);
        let control = |i: usize, j: usize| patch.control[i * columns + j];
        let points: Vec<_> = match border.side {
            0 => (0..columns).map(|j| control(0, j)).collect(),
            1 => (0..columns).map(|j| control(rows - 1, j)).collect(),
            2 => (0..rows).map(|i| control(i, 0)).collect(),
            _ => (0..rows).map(|i| control(i, columns - 1)).collect(),
        };
        let weights = points.iter().map(|c| c.w).collect();
        let points = points.iter().map(|c| patch.origin + c.truncate() / c.w).collect();
        (Self { border, points, weights }, number)
    }

    fn ends(&self) -> [DVec3; 2] {
        [self.points[0], self.points[self.points.len() - 1]]
    }

    /// Whether another is the same curve, parametrized alike, or backwards where `turned`.
    fn is_same(&self, other: &Self, turned: bool, near: f64) -> bool {
        let count = self.points.len();
        let of = |k: usize| if turned { count - 1 - k } else { k };
        let ratio = self.weights[0] / other.weights[of(0)];
        let alike = |k: usize| {
            let (a, b) = (self.weights[k], ratio * other.weights[of(k)]);
            self.points[k].distance(other.points[of(k)]) <= near && (a - b).abs() <= SAME_WEIGHT * a
        };
        count == other.points.len() && (0..count).all(alike)
    }

    fn is_collapsed(&self, near: f64) -> bool {
        self.points.iter().all(|p| p.distance(self.points[0]) <= near)
    }
}

/// Joins borders that coincide, and says which of them run backwards as seen from the others.
fn join_curves(curves: &[(Curve, usize)], near: f64, borders: &mut Sets, reversed: &mut [bool]) {
    let key = |curve: &Curve| curve.ends().iter().map(|p| p.x).sum::<f64>();
    let mut order: Vec<&(Curve, usize)> = curves.iter().filter(|(curve, _)| !curve.is_collapsed(near)).collect();
    order.sort_by(|a, b| key(&a.0).total_cmp(&key(&b.0)).then(a.0.border.cmp(&b.0.border)));
    let mut is_joined = vec![false; reversed.len()];
    for (first, (a, number)) in order.iter().enumerate() {
        for (b, other) in order[first + 1..].iter().take_while(|(b, _)| key(b) - key(a) <= 4.0 * near) {
            // One that was joined before keeps its direction.
            let turned = [false, true].into_iter().find(|turned| !is_joined[*other] && a.is_same(b, *turned, near));
            if let Some(turned) = turned {
                is_joined[*other] = true;
                reversed[*other] = reversed[*number] != turned;
                borders.join(*number, *other);
            }
        }
    }
}

/// Joins corners that coincide.
fn join_corners(curves: &[(Curve, usize)], near: f64, corners: &mut Sets) {
    // The corners at either end of a side, by the side's number.
    const ENDS: [[usize; 2]; 4] = [[0, 1], [2, 3], [0, 2], [1, 3]];
    let ends = |(curve, number): &(Curve, usize)| {
        let first = number - curve.border.side;
        [0, 1].map(|end| (curve.ends()[end], first + ENDS[curve.border.side][end]))
    };
    let mut points: Vec<(DVec3, usize)> = curves.iter().flat_map(ends).collect();
    points.sort_by(|a, b| a.0.x.total_cmp(&b.0.x).then(a.1.cmp(&b.1)));
    for (first, (a, number)) in points.iter().enumerate() {
        for (b, other) in points[first + 1..].iter().take_while(|(b, _)| b.x - a.x <= near) {
            if a.distance(*b) <= near {
                corners.join(*number, *other);
            }
        }
    }
}

/// Where a border that is `side` of a patch runs there, backwards where `turned`.
fn border_record(Site { face, span }: Site, side: usize, turned: bool) -> BorderRecord {
    let across = (side % 2) as f32;
    let at = |along: f32| if side < 2 { [across, along] } else { [along, across] };
    let [start, end] = if turned { [at(1.0), at(0.0)] } else { [at(0.0), at(1.0)] };
    BorderRecord { face, level: 0, span, start, end }
}
