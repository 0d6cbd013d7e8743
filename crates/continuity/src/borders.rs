//! The borders of a model's faces: trims where loops bound a face, the sides of its domain where none do.
//!
//! Trims are taken from the face's [`scene::Region`], so that material is on their left whatever a file says of its loops. A
//! trim that crosses a seam is one border.

use crate::border::{Border, Origin};
use crate::surface::Patches;
use glam::DVec2;
use nurbs::{BezierCurve, Rectangle, Surface};
use scene::{ClosedLoop, FaceId, Model, Region, closed};
use std::collections::BTreeSet;

/// A border with what its file says of it.
pub struct Given<'m> {
    /// The border.
    pub border: Border<'m>,
    /// The edge that the file names.
    pub edge: Option<i64>,
}

/// The borders of all faces, in the order of these.
pub fn borders(model: &Model) -> Vec<Given<'_>> {
    let faces = (0..model.faces().len()).map(|index| FaceId(index as u32));
    faces.flat_map(|face| of_face(model, face)).collect()
}

fn of_face(model: &Model, face: FaceId) -> Vec<Given<'_>> {
    let surface = model.surface(face);
    let closed = closed(surface);
    let mut patches = Patches::new(surface);
    let edge = |origin: Origin| match origin {
        Origin::Trim { boundary, trim } => {
            let trim = &model.faces()[face.0 as usize].loops[boundary].trims[trim];
            // A point in space is no edge of two faces, whatever number it has.
            trim.edge.filter(|_| !trim.degenerate)
        }
        Origin::Side(_) => None,
    };
    let curves = model.region(face).map_or_else(|| sides(surface), curves);
    let given = |(origin, curves): (Origin, Vec<BezierCurve>)| Given {
        border: Border::new(face, origin, &curves, closed, &mut patches),
        edge: edge(origin),
    };
    curves.into_iter().map(given).collect()
}

/// The four sides of a domain, material on the left.
fn sides(surface: &Surface) -> Vec<(Origin, Vec<BezierCurve>)> {
    let [[u0, u1], [v0, v1]] = surface.domain();
    let [a, b, c, d] = [[u0, v0], [u1, v0], [u1, v1], [u0, v1]].map(DVec2::from_array);
    let side = |number: usize, from: DVec2, to: DVec2| (Origin::Side(number), vec![BezierCurve::line(from, to)]);
    vec![side(0, d, a), side(1, b, c), side(2, a, b), side(3, c, d)]
}

/// What bounds a region.
fn curves(region: &Region) -> Vec<(Origin, Vec<BezierCurve>)> {
    let mut found: Vec<(Origin, Vec<BezierCurve>)> = vec![];
    let mut known = BTreeSet::new();
    for ClosedLoop { segments, source, .. } in region.loops() {
        let Some(boundary) = *source else { continue };
        for run in segments.chunk_by(|a, b| a.trim == b.trim) {
            let Some(trim) = run[0].trim else { continue };
            // Copies a period apart are one trim.
            if known.insert((boundary, trim)) {
                let curves = run.iter().map(|segment| segment.curve.clone()).collect();
                found.push((Origin::Trim { boundary, trim }, curves));
            }
        }
    }
    // Where no trim runs, the domain's own sides bound a face.
    let natural = |piece: &&scene::Piece| piece.trim.is_none() && piece.on_border && region.is_edge(piece);
    let mut last: Option<usize> = None;
    for piece in region.pieces().iter().filter(natural) {
        let side = side_of(&piece.curve, region.domain());
        match found.last_mut() {
            Some((_, curves)) if last == Some(side) && curves[curves.len() - 1].end() == piece.curve.start() => {
                curves.push(piece.curve.clone());
            }
            _ => found.push((Origin::Side(side), vec![piece.curve.clone()])),
        }
        last = Some(side);
    }
    found
}

/// Which side of the domain a piece runs along.
fn side_of(curve: &BezierCurve, domain: Rectangle) -> usize {
    let (start, end) = (curve.start(), curve.end());
    let axis = usize::from(start.x != end.x);
    2 * axis + usize::from(start[axis] == domain.max[axis])
}
