//! Surfaces and curves that are Bézier pieces in one knot vector: inside it stand knots of multiplicity p + 1.
//!
//! Such a knot parts the control points in two, and a spline on either side of it knows nothing of the other. Where the two
//! points at the knot are one, one of them goes, and a knot with it: multiplicity p, as [`KnotVector`](nurbs::KnotVector)
//! has it. Where they are two, a surface is torn, and is cut there into surfaces of their own.

use glam::{DVec2, DVec3};

/// Two points within this share of the greatest coordinate are one: 16 digits, less what a program loses.
const SAME: f64 = 1e-12;

/// A surface as it stands in a file: counts fit, no more is known.
#[derive(Debug, Clone)]
pub(super) struct Net {
    pub degree: [usize; 2],
    pub knots: [Vec<f64>; 2],
    pub counts: [usize; 2],
    pub points: Vec<DVec3>,
    pub weights: Option<Vec<f64>>,
}

/// Where a surface was cut.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Cut {
    /// The direction whose parameter is constant along it: 0 = u, 1 = v.
    pub axis: usize,
    pub at: f64,
    /// How far the points on its two sides are apart at most.
    pub apart: f64,
}

/// The parts of a surface between its tears, along u and then along v, and where it was cut.
pub(super) fn parts(net: Net) -> (Vec<Net>, Vec<Cut>) {
    let mut cuts = vec![];
    let columns = along(net, 0, &mut cuts);
    let mut parts = vec![];
    let mut across = vec![];
    for column in columns {
        across.clear();
        parts.extend(along(column, 1, &mut across));
        for cut in &across {
            match cuts.iter_mut().find(|known| (known.axis, known.at) == (cut.axis, cut.at)) {
                Some(known) => known.apart = known.apart.max(cut.apart),
                None => cuts.push(cut.clone()),
            }
        }
    }
    (parts, cuts)
}

/// Takes the second of two equal points out of a plane curve, and a knot with it, wherever p + 1 knots are one.
pub(super) fn merge(degree: usize, knots: &mut Vec<f64>, points: &mut Vec<DVec2>, weights: Option<&mut Vec<f64>>) {
    let firsts = full_knots(knots, degree);
    if firsts.is_empty() || weights.as_ref().is_some_and(|w| w.len() != points.len()) {
        return;
    }
    let net = Net {
        degree: [degree, 1],
        knots: [knots.clone(), vec![]],
        counts: [points.len(), 1],
        points: points.iter().map(|p| p.extend(0.0)).collect(),
        weights: weights.as_ref().map(|w| w.to_vec()),
    };
    let mut merged = vec![false; points.len()];
    for first in firsts {
        merged[first] = matches!(net.gap(0, first), Gap::None);
    }
    let part = net.part(0, 0..points.len(), &merged);
    [*knots, _] = part.knots;
    *points = part.points.iter().map(|p| p.truncate()).collect();
    if let Some((weights, merged)) = weights.zip(part.weights) {
        *weights = merged;
    }
}

fn along(net: Net, axis: usize, cuts: &mut Vec<Cut>) -> Vec<Net> {
    let firsts = full_knots(&net.knots[axis], net.degree[axis]);
    if firsts.is_empty() {
        return vec![net];
    }
    // The row of points at such a knot has the knot's own index.
    let (mut merged, mut borders) = (vec![false; net.counts[axis]], vec![0]);
    for first in firsts {
        match net.gap(axis, first) {
            Gap::None => merged[first] = true,
            Gap::Within => borders.push(first),
            Gap::Wide(apart) => {
                cuts.push(Cut { axis, at: net.knots[axis][first], apart });
                borders.push(first);
            }
        }
    }
    borders.push(net.counts[axis]);
    let part = |range: &[usize]| net.part(axis, range[0]..range[1], &merged);
    borders.windows(2).map(part).collect()
}

/// The indices of the first of each p + 1 equal knots inside the domain.
fn full_knots(knots: &[f64], degree: usize) -> Vec<usize> {
    // What is not sorted, or too short, is refused when a knot vector is made of it.
    if !knots.is_sorted() || knots.len() < 2 * (degree + 1) {
        return vec![];
    }
    let (start, end) = (knots[degree], knots[knots.len() - degree - 1]);
    let mut firsts = vec![];
    let mut index = 0;
    for run in knots.chunk_by(|a, b| a == b) {
        if start < run[0] && run[0] < end && run.len() == degree + 1 {
            firsts.push(index);
        }
        index += run.len();
    }
    firsts
}

/// What lies between the two rows of points at a knot.
enum Gap {
    /// They are one, weights and all.
    None,
    /// Their points are one; their weights are not, so that no knot can go.
    Within,
    /// The greatest distance.
    Wide(f64),
}

impl Net {
    fn indices(&self, axis: usize, row: usize) -> impl Iterator<Item = usize> + '_ {
        let [_, columns] = self.counts;
        (0..self.counts[1 - axis]).map(move |k| if axis == 0 { row * columns + k } else { k * columns + row })
    }

    /// Between the rows before and at `row`.
    fn gap(&self, axis: usize, row: usize) -> Gap {
        let pairs = || self.indices(axis, row - 1).zip(self.indices(axis, row));
        let size = self.points.iter().map(|p| p.abs().max_element()).fold(0.0, f64::max);
        let apart = pairs().map(|(a, b)| self.points[a].distance(self.points[b])).fold(0.0, f64::max);
        if apart.is_nan() || SAME * size < apart {
            return Gap::Wide(apart);
        }
        let is_same = |w: &Vec<f64>| pairs().all(|(a, b)| (w[a] - w[b]).abs() <= SAME * w[a]);
        if self.weights.as_ref().is_none_or(is_same) { Gap::None } else { Gap::Within }
    }

    /// The rows in a range that are not merged with the one before, and the knots that they have.
    fn part(&self, axis: usize, range: std::ops::Range<usize>, merged: &[bool]) -> Self {
        let is_kept = |row: &usize| !merged.get(*row).is_some_and(|is_merged| *is_merged);
        let knots = range.start..range.end + self.degree[axis] + 1;
        let kept: Vec<usize> = range.filter(is_kept).collect();
        let (mut part_knots, mut counts) = (self.knots.clone(), self.counts);
        part_knots[axis] = knots.filter(is_kept).map(|k| self.knots[axis][k]).collect();
        counts[axis] = kept.len();
        let columns = self.counts[1];
        let indices: Vec<usize> = match axis {
            0 => kept.iter().flat_map(|row| row * columns..(row + 1) * columns).collect(),
            _ => (0..self.counts[0]).flat_map(|i| kept.iter().map(move |row| i * columns + row)).collect(),
        };
        Self {
            degree: self.degree,
            knots: part_knots,
            counts,
            points: indices.iter().map(|&i| self.points[i]).collect(),
            weights: self.weights.as_ref().map(|w| indices.iter().map(|&i| w[i]).collect()),
        }
    }
}
