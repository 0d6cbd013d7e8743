//! Borders of patches that are the same curve in space, and corners that are the same point.
//!
//! Between faces that no loops bound, borders are shared whose control points coincide, in either direction, and corners that do. Where a
//! border of one face runs along a part of another's, or in another parametrization, nothing is shared: a gap is left there, as wide as
//! both chords together.

use glam::DVec3;
use nurbs::BezierPatch;
use pipeline::Program;

/// Points that are nearer to each other than this share of the model's size are one.
pub const SAME: f64 = 1e-12;

/// Weights that differ by less than this share are one.
const SAME_WEIGHT: f64 = 1e-12;

/// Sets of numbers, joined pair by pair.
#[derive(Debug)]
pub struct Sets(Vec<usize>);

impl Sets {
    /// So many numbers, each by itself.
    pub fn new(count: usize) -> Self {
        Self((0..count).collect())
    }

    /// The least number of the set that a number is of.
    pub fn least(&self, mut k: usize) -> usize {
        while self.0[k] != k {
            k = self.0[k];
        }
        k
    }

    /// The least number of both stands for the joined set.
    pub fn join(&mut self, a: usize, b: usize) {
        let roots = [self.least(a), self.least(b)];
        let [least, other] = [roots[0].min(roots[1]), roots[0].max(roots[1])];
        self.0[other] = least;
        // What was asked about is near its root the next time.
        (self.0[a], self.0[b]) = (least, least);
    }
}

/// A border in space.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// Its number among all borders.
    pub border: usize,
    /// The numbers of its ends among all corners.
    pub corners: [usize; 2],
    /// What evaluates it, where one program cannot evaluate a border of another.
    pub program: Option<Program>,
    points: Vec<DVec3>,
    weights: Vec<f64>,
}

/// The direction along which borders and corners are sorted: models have planes across an axis, and none across this.
const ACROSS_NOTHING: DVec3 = DVec3::new(0.538_2, 0.331_7, 0.774_9);

impl Curve {
    /// A side of a patch: u = 0, u = 1, v = 0, v = 1.
    pub fn new(patch: &BezierPatch, side: usize, border: usize, corners: [usize; 2], program: Option<Program>) -> Self {
        let [rows, columns] = [0, 1].map(|k| patch.degree[k] + 1);
        let control = |i: usize, j: usize| patch.control[i * columns + j];
        let points: Vec<_> = match side {
            0 => (0..columns).map(|j| control(0, j)).collect(),
            1 => (0..columns).map(|j| control(rows - 1, j)).collect(),
            2 => (0..rows).map(|i| control(i, 0)).collect(),
            _ => (0..rows).map(|i| control(i, columns - 1)).collect(),
        };
        let weights = points.iter().map(|c| c.w).collect();
        let points = points.iter().map(|c| patch.origin + c.truncate() / c.w).collect();
        Self { border, corners, program, points, weights }
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

    /// Whether all of it is one point.
    pub fn is_collapsed(&self, near: f64) -> bool {
        self.points.iter().all(|p| p.distance(self.points[0]) <= near)
    }
}

/// Joins borders that coincide, and says which of them run backwards as seen from the others. One that has collapsed is none.
pub fn join_borders(curves: &[Curve], near: f64, borders: &mut Sets, reversed: &mut [bool]) {
    let key = |curve: &Curve| curve.ends().iter().map(|p| p.dot(ACROSS_NOTHING)).sum::<f64>();
    let mut order: Vec<(f64, &Curve)> =
        curves.iter().filter(|curve| !curve.is_collapsed(near)).map(|curve| (key(curve), curve)).collect();
    order.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.border.cmp(&b.1.border)));
    let mut is_joined = vec![false; reversed.len()];
    for (first, &(from, a)) in order.iter().enumerate() {
        // What is as one that was joined before is as the first of them.
        if is_joined[a.border] {
            continue;
        }
        for (_, b) in order[first + 1..].iter().take_while(|(at, _)| at - from <= 4.0 * near) {
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
pub fn join_corners(curves: &[Curve], near: f64, corners: &mut Sets) {
    let ends = |curve: &Curve| {
        let [start, end] = curve.ends();
        [(start, curve.program, curve.corners[0]), (end, curve.program, curve.corners[1])]
    };
    let mut points: Vec<(DVec3, Option<Program>, usize)> = curves.iter().flat_map(ends).collect();
    let key = |point: &DVec3| point.dot(ACROSS_NOTHING);
    points.sort_by(|a, b| key(&a.0).total_cmp(&key(&b.0)).then(a.2.cmp(&b.2)));
    let mut is_joined = vec![false; points.len()];
    for first in 0..points.len() {
        let (a, program, number) = points[first];
        if is_joined[first] {
            continue;
        }
        for (index, &(b, other_program, other)) in points.iter().enumerate().skip(first + 1) {
            if key(&b) - key(&a) > 2.0 * near {
                break;
            }
            if program == other_program && a.distance(b) <= near {
                is_joined[index] = true;
                corners.join(number, other);
            }
        }
    }
}
