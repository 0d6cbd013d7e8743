//! Which borders and corners patches share, so that all of them may have the same there.
//!
//! Inside a face neighbours share them by their spans. Between faces of one program that no loops bound, borders are shared whose control points
//! coincide, in either direction, and corners that do. Where a border of one face runs along a part of another's, or in another
//! parametrization, nothing is shared: a gap is left there, as wide as both chords together.

use super::record::{BorderRecord, CornerRecord};
use crate::triangles::borders::{Curve, SAME, Sets, join_borders, join_corners};
use compare::Seams;
use nurbs::BezierPatch;
use pipeline::Program;
use scene::FaceId;
use std::collections::BTreeMap;

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

/// The corners at either end of a side: (u, v) = (0, 0), (0, 1), (1, 0), (1, 1).
const ENDS: [[usize; 2]; 4] = [[0, 1], [2, 3], [0, 2], [1, 3]];

/// What parts share.
pub struct Joints {
    /// Of each face and each of its parts: for each side the group of borders that it is of.
    pub groups: Vec<Vec<[usize; 4]>>,
    /// Where each part evaluates its borders, without levels.
    pub borders: Vec<Vec<[BorderRecord; 4]>>,
    /// Where each part evaluates its corners.
    pub corners: Vec<Vec<[CornerRecord; 4]>>,
    /// The faces that each meets along whole borders.
    pub seams: Seams,
}

impl Joints {
    /// Those of all faces; `size` is the model's.
    pub fn new(faces: &[FaceParts], size: f64) -> Self {
        let all: Vec<(u32, &Part)> =
            (0..).zip(faces).flat_map(|(id, face)| face.parts.iter().map(move |part| (id, part))).collect();
        let mut borders = Sets::new(4 * all.len());
        let mut corners = Sets::new(4 * all.len());
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
                    curves.extend(outer.map(|side| {
                        let corners = ENDS[side].map(|k| number(index) + k);
                        Curve::new(&part.patch, side, number(index) + side, corners, Some(face.program))
                    }));
                }
            }
            starts.push(start + face.parts.len());
        }
        let near = SAME * size;
        let mut reversed = vec![false; 4 * all.len()];
        join_borders(&curves, near, &mut borders, &mut reversed);
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
        let groups: Vec<Vec<[usize; 4]>> = (0..faces.len()).map(|id| numbers(id).map(group).collect()).collect();
        Self {
            seams: seams(faces, &groups),
            groups,
            borders: (0..faces.len()).map(|id| numbers(id).map(border).collect()).collect(),
            corners: (0..faces.len()).map(|id| numbers(id).map(corner).collect()).collect(),
        }
    }
}

/// The faces that each meets along its sides, of the groups of borders.
fn seams(faces: &[FaceParts], groups: &[Vec<[usize; 4]>]) -> Seams {
    let outer = |id: usize| {
        let FaceParts { parts, columns, is_bounded, .. } = &faces[id];
        let (columns, rows) = (*columns, parts.len() / (*columns).max(1));
        let of_side = move |side: usize| {
            let parts: Vec<usize> = match side {
                0 => (0..columns).collect(),
                1 => (0..columns).map(|j| (rows - 1) * columns + j).collect(),
                2 => (0..rows).map(|i| i * columns).collect(),
                _ => (0..rows).map(|i| (i + 1) * columns - 1).collect(),
            };
            parts.into_iter().map(move |index| (side, index))
        };
        (0..if *is_bounded || rows == 0 { 0 } else { 4 }).flat_map(of_side)
    };
    let mut members: BTreeMap<usize, Vec<(usize, usize, usize)>> = BTreeMap::new();
    for id in 0..faces.len() {
        outer(id).for_each(|(side, index)| members.entry(groups[id][index][side]).or_default().push((id, side, index)));
    }
    let of_face = |id: usize| {
        let mut sides: [Vec<Vec<FaceId>>; 4] = Default::default();
        let mut last: [Option<u32>; 4] = [None; 4];
        for (side, index) in outer(id) {
            let others = members[&groups[id][index][side]].iter().filter(|other| **other != (id, side, index));
            let beyond: Vec<FaceId> = others.map(|(face, ..)| FaceId(*face as u32)).collect();
            let span = faces[id].parts[index].span[1 - side / 2];
            // A span in parts meets whom all of its parts meet.
            if last[side] != Some(span) {
                sides[side].push(beyond);
            } else if let Some(known) = sides[side].last_mut().filter(|known| **known != beyond) {
                known.clear();
            }
            last[side] = Some(span);
        }
        sides
    };
    Seams::new((0..faces.len()).map(of_face).collect())
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
