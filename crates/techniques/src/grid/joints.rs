//! Which borders and corners patches share, so that all of them may have the same there.
//!
//! Inside a face neighbours share them by their spans. Between faces of one program that no loops bound, borders are shared whose control points
//! coincide, in either direction, and corners that do. Where a border of one face runs along a part of another's, or in another
//! parametrization, nothing is shared: a gap is left there, as wide as both chords together.

use super::record::{BorderRecord, CornerRecord};
use glam::DVec3;
use nurbs::BezierPatch;
use pipeline::Program;

/// Points that are nearer to each other than this share of the model's size are one.
const SAME: f64 = 1e-12;

/// Weights that differ by less than this share are one.
const SAME_WEIGHT: f64 = 1e-12;

/// A patch of a face, or a part of one.
#[derive(Debug, Clone, PartialEq)]
pub struct Part {
    /// Its spans.
    pub span: [u32; 2],
    /// Its least parameters there, and how far they run.
    pub from: [f32; 2],
    /// See there.
    pub size: [f32; 2],
    /// The part itself.
    pub patch: BezierPatch,
}

/// What a face comes to: rows of parts along u, each with as many along v.
pub struct FaceParts {
    /// Row-major in u.
    pub parts: Vec<Part>,
    /// How many there are in a row.
    pub columns: usize,
    /// Whether loops bound it: then its outer borders are its own, and have skirts.
    pub is_bounded: bool,
    /// What evaluates it: one program cannot evaluate a face of another.
    pub program: Program,
}

/// A border in space.
struct Curve {
    /// Four times the number of its part among those of all faces, and its side: u = 0, u = 1, v = 0, v = 1.
    border: usize,
    program: Program,
    points: Vec<DVec3>,
    /// Relative to the first.
    weights: Vec<f64>,
}

/// What parts share.
pub struct Joints {
    /// Of each face and each of its parts: for each side the group of borders that it is of.
    pub groups: Vec<Vec<[usize; 4]>>,
    /// Where each part evaluates its borders, without levels.
    pub borders: Vec<Vec<[BorderRecord; 4]>>,
    /// Where each part evaluates its corners.
    pub corners: Vec<Vec<[CornerRecord; 4]>>,
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
    pub fn new(faces: &[FaceParts], size: f64) -> Self {
        let all: Vec<(u32, &Part)> =
            (0..).zip(faces).flat_map(|(id, face)| face.parts.iter().map(move |part| (id, part))).collect();
        let mut borders = Sets((0..4 * all.len()).collect());
        let mut corners = Sets((0..4 * all.len()).collect());
        let mut curves = vec![];
        let mut starts = vec![0];
        for face in faces {
            let start = starts[starts.len() - 1];
            let columns = face.columns;
            let rows = face.parts.len() / columns.max(1);
            for (index, part) in face.parts.iter().enumerate() {
                let (k, l) = (index / columns, index % columns);
                let number = |index: usize| 4 * (start + index);
                if k + 1 < rows {
                    borders.join(number(index) + 1, number(index + columns));
                    (0..2).for_each(|end| corners.join(number(index) + 2 + end, number(index + columns) + end));
                }
                if l + 1 < columns {
                    borders.join(number(index) + 3, number(index + 1) + 2);
                    (0..2).for_each(|end| corners.join(number(index) + 2 * end + 1, number(index + 1) + 2 * end));
                }
                if !face.is_bounded {
                    let is_outer = [k == 0, k + 1 == rows, l == 0, l + 1 == columns];
                    let outer = (0..4).filter(|side| is_outer[*side]);
                    curves.extend(outer.map(|side| Curve::new(&part.patch, number(index) + side, face.program)));
                }
            }
            starts.push(start + face.parts.len());
        }
        let near = SAME * size;
        let mut reversed = vec![false; 4 * all.len()];
        join_curves(&curves, near, &mut borders, &mut reversed);
        join_corners(&curves, near, &mut corners);
        let border = |number: usize| {
            std::array::from_fn(|side| {
                let own = 4 * number + side;
                let owner = borders.least(own);
                border_record(all[owner / 4], owner % 4, reversed[own] != reversed[owner])
            })
        };
        let corner = |number: usize| {
            std::array::from_fn(|k| {
                let owner = corners.least(4 * number + k);
                let ((face, part), k) = (all[owner / 4], owner % 4);
                let end = [k / 2, k % 2];
                let uv = [0, 1].map(|k| part.from[k] + part.size[k] * end[k] as f32);
                CornerRecord { face, padding: 0, span: part.span, uv }
            })
        };
        let group = |number: usize| std::array::from_fn(|side| borders.least(4 * number + side));
        let numbers = |id: usize| starts[id]..starts[id + 1];
        Self {
            groups: (0..faces.len()).map(|id| numbers(id).map(group).collect()).collect(),
            borders: (0..faces.len()).map(|id| numbers(id).map(border).collect()).collect(),
            corners: (0..faces.len()).map(|id| numbers(id).map(corner).collect()).collect(),
        }
    }
}

impl Curve {
    fn new(patch: &BezierPatch, border: usize, program: Program) -> Self {
        let [rows, columns] = [0, 1].map(|k| patch.degree[k] + 1);
        let control = |i: usize, j: usize| patch.control[i * columns + j];
        let points: Vec<_> = match border % 4 {
            0 => (0..columns).map(|j| control(0, j)).collect(),
            1 => (0..columns).map(|j| control(rows - 1, j)).collect(),
            2 => (0..rows).map(|i| control(i, 0)).collect(),
            _ => (0..rows).map(|i| control(i, columns - 1)).collect(),
        };
        let weights = points.iter().map(|c| c.w).collect();
        let points = points.iter().map(|c| patch.origin + c.truncate() / c.w).collect();
        Self { border, program, points, weights }
    }

    fn ends(&self) -> [DVec3; 2] {
        [self.points[0], self.points[self.points.len() - 1]]
    }

    /// Whether another is the same curve, parametrized alike, or backwards where `turned`.
    fn is_same(&self, other: &Self, turned: bool, near: f64) -> bool {
        let count = self.points.len();
        if count != other.points.len() || self.program != other.program {
            return false;
        }
        let of = |k: usize| if turned { count - 1 - k } else { k };
        let ratio = self.weights[0] / other.weights[of(0)];
        let alike = |k: usize| {
            let (a, b) = (self.weights[k], ratio * other.weights[of(k)]);
            self.points[k].distance(other.points[of(k)]) <= near && (a - b).abs() <= SAME_WEIGHT * a
        };
        (0..count).all(alike)
    }

    fn is_collapsed(&self, near: f64) -> bool {
        self.points.iter().all(|p| p.distance(self.points[0]) <= near)
    }
}

/// Joins borders that coincide, and says which of them run backwards as seen from the others.
fn join_curves(curves: &[Curve], near: f64, borders: &mut Sets, reversed: &mut [bool]) {
    let key = |curve: &Curve| curve.ends().iter().map(|p| p.x).sum::<f64>();
    let mut order: Vec<&Curve> = curves.iter().filter(|curve| !curve.is_collapsed(near)).collect();
    order.sort_by(|a, b| key(a).total_cmp(&key(b)).then(a.border.cmp(&b.border)));
    let mut is_joined = vec![false; reversed.len()];
    for (first, a) in order.iter().enumerate() {
        for b in order[first + 1..].iter().take_while(|b| key(b) - key(a) <= 4.0 * near) {
            // One that was joined before keeps its direction.
            let turned = [false, true].into_iter().find(|turned| !is_joined[b.border] && a.is_same(b, *turned, near));
            if let Some(turned) = turned {
                is_joined[b.border] = true;
                reversed[b.border] = reversed[a.border] != turned;
                borders.join(a.border, b.border);
            }
        }
    }
}

/// Joins corners that coincide.
fn join_corners(curves: &[Curve], near: f64, corners: &mut Sets) {
    // The corners at either end of a side, by the side's number.
    const ENDS: [[usize; 2]; 4] = [[0, 1], [2, 3], [0, 2], [1, 3]];
    let ends = |curve: &Curve| {
        let (part, side) = (curve.border / 4, curve.border % 4);
        [0, 1].map(|end| (curve.ends()[end], curve.program, 4 * part + ENDS[side][end]))
    };
    let mut points: Vec<(DVec3, Program, usize)> = curves.iter().flat_map(ends).collect();
    points.sort_by(|a, b| a.0.x.total_cmp(&b.0.x).then(a.2.cmp(&b.2)));
    for (first, (a, program, number)) in points.iter().enumerate() {
        for (b, other_program, other) in points[first + 1..].iter().take_while(|(b, ..)| b.x - a.x <= near) {
            if program == other_program && a.distance(*b) <= near {
                corners.join(*number, *other);
            }
        }
    }
}

/// Where a border that is `side` of a part runs there, backwards where `turned`.
fn border_record((face, part): (u32, &Part), side: usize, turned: bool) -> BorderRecord {
    let across = (side % 2) as f32;
    let at = |along: f32| {
        let t = if side < 2 { [across, along] } else { [along, across] };
        [0, 1].map(|k| part.from[k] + part.size[k] * t[k])
    };
    let [start, end] = if turned { [at(1.0), at(0.0)] } else { [at(0.0), at(1.0)] };
    BorderRecord { face, level: 0, span: part.span, start, end }
}
