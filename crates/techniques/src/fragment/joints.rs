//! Where faces meet along whole borders: all of them have the same corners there, at the same places to the bit.
//!
//! A border that faces share is cut where any of them cuts it. Each of its corners, and each corner in which faces meet, is evaluated on
//! one of the faces for all. So triangles of faces that are cut differently meet vertex on vertex.

use super::cells::Cells;
use crate::triangles::borders::{Curve, SAME, Sets, join_borders, join_corners};
use compare::Seams;
use nurbs::{BezierPatch, Direction, Surface};
use pipeline::Parameters;
use rayon::prelude::*;
use scene::{FaceId, Model};
use std::cmp::Ordering;
use std::ops::Range;

/// A place on a border, as a share of its parameters: exactly known, as two faces compare theirs.
#[derive(Debug, Clone, Copy)]
pub(super) struct Fraction {
    above: u64,
    below: u64,
}

impl Fraction {
    /// The start of cell `cell` of `cells` in part `part` of `parts`.
    fn new([part, parts]: [usize; 2], [cell, cells]: [usize; 2]) -> Self {
        Self { above: (part * cells + cell) as u64, below: (parts * cells) as u64 }
    }

    /// As seen from the border's other end.
    fn turned(self) -> Self {
        Self { above: self.below - self.above, ..self }
    }

    fn cmp(&self, other: &Self) -> Ordering {
        let product = |a: u64, b: u64| u128::from(a) * u128::from(b);
        product(self.above, other.below).cmp(&product(other.above, self.below))
    }

    pub(super) fn value(self) -> f32 {
        (self.above as f64 / self.below as f64) as f32
    }
}

/// Of a border and each of the cells along it the corners that other faces have there; empty where no other one cuts it.
pub(super) type Foreign = Vec<Vec<Fraction>>;

/// The lines of a span that is cut into parts, each into so many cells: from 0 to 1.
pub(super) fn lines(parts: &[usize]) -> Vec<Fraction> {
    let of_part = |(k, &cells): (usize, &usize)| (0..cells).map(move |i| Fraction::new([k, parts.len()], [i, cells]));
    parts.iter().enumerate().flat_map(of_part).chain([Fraction { above: 1, below: 1 }]).collect()
}

const DIRECTIONS: [Direction; 2] = [Direction::U, Direction::V];

/// The direction along a side, u or v.
fn along(side: usize) -> usize {
    if side < 2 { 1 } else { 0 }
}

/// Where all faces evaluate a corner that they share.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Site {
    pub(super) face: usize,
    pub(super) at: Parameters,
}

/// A side of a span of a face.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Border {
    face: usize,
    span: [u32; 2],
    /// u = 0, u = 1, v = 0, v = 1.
    side: usize,
    /// The border that stands for all that coincide with it.
    owner: usize,
    /// Whether it runs backwards as seen from the owner.
    is_turned: bool,
    /// The corners that stand for its ends: twice a border, and 1 at its end.
    corners: [usize; 2],
    /// Whether it is one point.
    is_collapsed: bool,
}

/// What faces share that no loops bound; none by default.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Joints {
    curves: Vec<Curve>,
    borders: Vec<Border>,
    /// Of each face and each of its sides, the borders, span by span; none of a face that loops bound.
    of_faces: Vec<[Range<usize>; 4]>,
    /// Borders that coincide, of which there are two or more: the first stands for them.
    shared: Vec<Vec<usize>>,
}

impl Joints {
    /// Those of all faces.
    pub(super) fn new(model: &Model) -> Self {
        let mut joints = Self::default();
        for id in 0..model.faces().len() {
            let face = FaceId(id as u32);
            let first = joints.borders.len();
            let counts = match model.region(face) {
                Some(_) => [0; 2],
                None => DIRECTIONS.map(|along| model.surface(face).knots(along).spans().count()),
            };
            for side in 0..4 {
                for k in 0..counts[along(side)] {
                    let across = if side % 2 == 0 { 0 } else { counts[1 - along(side)] - 1 };
                    let span = if side < 2 { [across, k] } else { [k, across] }.map(|k| k as u32);
                    let owner = joints.borders.len();
                    let corners = [2 * owner, 2 * owner + 1];
                    let own = Border { face: id, span, side, owner, is_turned: false, corners, is_collapsed: false };
                    joints.borders.push(own);
                }
            }
            let [rows, columns] = counts;
            let ends =
                [first, first + columns, first + 2 * columns, first + 2 * columns + rows, first + 2 * (columns + rows)];
            joints.of_faces.push(std::array::from_fn(|side| ends[side]..ends[side + 1]));
        }
        let curves =
            |(id, sides): (usize, &[Range<usize>; 4])| joints.curves_of(model.surface(FaceId(id as u32)), sides);
        let curves: Vec<Vec<Curve>> = joints.of_faces.par_iter().enumerate().map(curves).collect();
        joints.curves = curves.into_iter().flatten().collect();
        joints.join(SAME * model.hull().diagonal());
        joints
    }

    /// The same after control points of a face have moved.
    pub(super) fn edited(&self, model: &Model, face: FaceId) -> Self {
        let mut joints = self.clone();
        for curve in self.curves_of(model.surface(face), &self.of_faces[face.0 as usize]) {
            let number = curve.border;
            joints.curves[number] = curve;
        }
        joints.join(SAME * model.hull().diagonal());
        joints
    }

    /// The borders of a face along its four sides, in their order.
    fn curves_of(&self, surface: &Surface, sides: &[Range<usize>; 4]) -> Vec<Curve> {
        let spans = DIRECTIONS.map(|direction| surface.knots(direction).spans().collect::<Vec<_>>());
        let numbers = sides[0].start..sides[3].end;
        let mut known: Option<([u32; 2], BezierPatch)> = None;
        let curve = |number: usize| {
            let Border { span, side, .. } = self.borders[number];
            // All four sides of a face of one patch are its.
            let patch = match &mut known {
                Some((at, patch)) if *at == span => &*patch,
                known => &known.insert((span, surface.bezier_patch([0, 1].map(|k| spans[k][span[k] as usize])))).1,
            };
            Curve::new(patch, side, number, [2 * number, 2 * number + 1], None)
        };
        numbers.map(curve).collect()
    }

    /// Finds what coincides.
    fn join(&mut self, near: f64) {
        let count = self.borders.len();
        let [mut borders, mut corners] = [count, 2 * count].map(Sets::new);
        let mut is_turned = vec![false; count];
        join_borders(&self.curves, near, &mut borders, &mut is_turned);
        join_corners(&self.curves, near, &mut corners);
        let mut members = vec![vec![]; count];
        for (number, border) in self.borders.iter_mut().enumerate() {
            let owner = borders.least(number);
            border.owner = owner;
            border.is_turned = is_turned[number] != is_turned[owner];
            border.corners = [2 * number, 2 * number + 1].map(|corner| corners.least(corner));
            border.is_collapsed = self.curves[number].is_collapsed(near);
            members[owner].push(number);
        }
        self.shared = members.into_iter().filter(|members| members.len() > 1).collect();
    }

    /// Whether the same borders and corners coincide.
    pub(super) fn are_as(&self, other: &Self) -> bool {
        self.borders == other.borders
    }

    /// The faces that each meets along whole borders.
    pub(super) fn seams(&self) -> Seams {
        let mut beyond = vec![vec![]; self.borders.len()];
        for members in &self.shared {
            for number in members {
                let others = members.iter().filter(|other| *other != number);
                beyond[*number] = others.map(|other| FaceId(self.borders[*other].face as u32)).collect();
            }
        }
        let of_face = |sides: &[Range<usize>; 4]| sides.clone().map(|side| beyond[side].to_vec());
        Seams::new(self.of_faces.iter().map(of_face).collect())
    }

    /// The border along a side of a span of a face; `None` inside the face, and where loops bound it.
    pub(super) fn border(&self, face: usize, span: [u32; 2], side: usize) -> Option<usize> {
        let borders = self.of_faces.get(face)?.get(side)?.clone();
        let k = span[along(side)] as usize;
        let number = borders.start + k;
        (number < borders.end && self.borders[number].span == span).then_some(number)
    }

    /// Where all faces evaluate the place of a border that is `along` it.
    pub(super) fn site(&self, number: usize, along: Fraction) -> Site {
        let border = &self.borders[number];
        let ends = [0, along.below].map(|end| along.above == end || border.is_collapsed);
        match ends.iter().position(|is_end| *is_end) {
            Some(end) => {
                let corner = border.corners[end];
                self.borders[corner / 2].place((corner % 2) as f32)
            }
            None => {
                let on_owner = if border.is_turned { along.turned() } else { along };
                self.borders[border.owner].place(on_owner.value())
            }
        }
    }

    /// How many corners at most all borders get from others beside, where faces are cut so.
    pub(super) fn most_foreign(&self, cells: &[[Vec<Vec<usize>>; 2]]) -> f64 {
        let of_shared = |members: &Vec<usize>| {
            let is_alike = members.iter().all(|number| {
                let [own, first] = [*number, members[0]].map(|number| self.borders[number].parts(cells));
                match self.borders[*number].is_turned {
                    true => own.iter().rev().eq(first),
                    false => own == first,
                }
            });
            let inner = |number: &usize| (self.borders[*number].parts(cells).iter().sum::<usize>() - 1) as f64;
            if is_alike { 0.0 } else { (members.len() - 1) as f64 * members.iter().map(inner).sum::<f64>() }
        };
        self.shared.iter().map(of_shared).sum()
    }

    /// Of each border the corners that other faces have between its own.
    pub(super) fn foreign(&self, cells: &[Cells]) -> Vec<Foreign> {
        let mut foreign = vec![vec![]; self.borders.len()];
        let own_lines = |number: usize| -> Vec<Fraction> {
            let border = &self.borders[number];
            let Cells::OfSpans(counts) = &cells[border.face] else { return vec![] };
            lines(border.parts_of(counts))
        };
        for members in &self.shared {
            let along_owner = |number: &usize| {
                let lines = own_lines(*number).into_iter();
                lines.map(|line| if self.borders[*number].is_turned { line.turned() } else { line }).collect::<Vec<_>>()
            };
            let mut all: Vec<Fraction> = members.iter().flat_map(along_owner).collect();
            all.sort_by(Fraction::cmp);
            all.dedup_by(|a, b| (*a).cmp(b).is_eq());
            for &number in members {
                let lines = own_lines(number);
                if lines.len() == all.len() {
                    continue;
                }
                let mut along: Vec<Fraction> = all.clone();
                if self.borders[number].is_turned {
                    along.reverse();
                    along.iter_mut().for_each(|line| *line = line.turned());
                }
                let within = |ends: &[Fraction]| {
                    let first = along.partition_point(|line| line.cmp(&ends[0]).is_le());
                    let end = along.partition_point(|line| line.cmp(&ends[1]).is_lt());
                    along[first..end].to_vec()
                };
                foreign[number] = lines.windows(2).map(within).collect();
            }
        }
        foreign
    }
}

impl Border {
    /// How its span is cut along it.
    fn parts_of<'c>(&self, counts: &'c [Vec<Vec<usize>>; 2]) -> &'c [usize] {
        let k = along(self.side);
        &counts[k][self.span[k] as usize]
    }

    fn parts<'c>(&self, cells: &'c [[Vec<Vec<usize>>; 2]]) -> &'c [usize] {
        self.parts_of(&cells[self.face])
    }

    /// Its place at `along`, 0 … 1.
    fn place(&self, along: f32) -> Site {
        let across = (self.side % 2) as f32;
        let uv = if self.side < 2 { [across, along] } else { [along, across] };
        Site { face: self.face, at: Parameters { span: self.span, uv } }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn values(lines: &[Fraction]) -> Vec<f32> {
        lines.iter().map(|line| line.value()).collect()
    }

    #[test]
    fn parts_are_cut_each_by_itself_and_equal_places_are_equal_from_either_end() {
        let all = lines(&[2, 1]);
        assert_eq!(values(&all), [0.0, 0.25, 0.5, 1.0]);
        let turned: Vec<Fraction> = lines(&[3, 6]).into_iter().rev().map(Fraction::turned).collect();
        assert!(turned.iter().zip(lines(&[6, 3])).all(|(a, b)| a.cmp(&b).is_eq()), "{turned:?}");
    }

    #[test]
    fn a_border_of_two_faces_has_the_corners_of_both() {
        let model = models::builtin("teapot").expect("built in");
        let joints = Joints::new(&model);
        assert!(joints.shared.len() > 40, "{}", joints.shared.len());
        let cells = |face: usize| Cells::OfSpans([vec![vec![2 + face % 3]], vec![vec![2 + face % 5]]]);
        let cells: Vec<Cells> = (0..model.faces().len()).map(cells).collect();
        let foreign = joints.foreign(&cells);
        for members in &joints.shared {
            // From the owner's end, each has the same places, whichever are its own.
            let places = |number: &usize| {
                let border = &joints.borders[*number];
                let Cells::OfSpans(counts) = &cells[border.face] else { unreachable!("cut by spans") };
                let own = lines(border.parts_of(counts));
                let cells = own.windows(2).enumerate();
                let mut all: Vec<Fraction> = cells
                    .flat_map(|(k, ends)| {
                        let between = foreign[*number].get(k).cloned().unwrap_or_default();
                        std::iter::once(ends[0]).chain(between)
                    })
                    .chain([own[own.len() - 1]])
                    .collect();
                if border.is_turned {
                    all.reverse();
                    all.iter_mut().for_each(|line| *line = line.turned());
                }
                all
            };
            let expected = places(&members[0]);
            for number in members {
                let found = places(number);
                let are_equal =
                    found.len() == expected.len() && found.iter().zip(&expected).all(|(a, b)| a.cmp(b).is_eq());
                assert!(are_equal, "{found:?}, not {expected:?}");
            }
        }
    }
}
