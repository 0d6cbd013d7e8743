//! Boundary representations: faces on surfaces, bounded by loops of trims, each with its curve in (u, v).
//!
//! The curves of edges in space are not needed and not read. A trim names a curve and the part of it that it runs along.

use super::archive::{Cursor, Fault, code};
use super::body::{Body, Remark};
use super::class::{Class, Object};
use super::curve::{Curve, parameter, pieces, unfit};
use super::extrusion::Extrusion;
use super::fit::fitted;
use super::sheet::Sheet;
use crate::document::NoteKind;
use scene::{Face, Loop, Trim};
use std::cell::Cell;

/// How many times the bytes of a brep its trims may read: files name each curve once.
const USES: usize = 4;

/// What a loop is of, as numbered in the file.
mod loop_kind {
    pub const OUTER: i32 = 1;
    pub const INNER: i32 = 2;
}

/// What a trim is, as numbered in the file.
mod trim_kind {
    pub const SEAM: i32 = 3;
    pub const SINGULAR: i32 = 4;
}

/// The lists of a brep, as they stand in the file.
struct Lists<'a> {
    curves: Vec<Option<Object<'a>>>,
    surfaces: Vec<Option<Object<'a>>>,
    /// Where the balls of vertices and edges are known, their radii; else `None`.
    vertices: Vec<Option<f64>>,
    edges: Vec<Option<f64>>,
    trims: Vec<RawTrim>,
    loops: Vec<(Vec<i32>, i32)>,
    faces: Vec<RawFace>,
    /// How many bytes of curves trims may still read.
    unread: Cell<usize>,
    /// How many trims name an edge or a vertex that is not there.
    loose: Cell<usize>,
}

struct RawTrim {
    at: usize,
    curve: i32,
    /// The part of the curve.
    range: [f64; 2],
    is_reversed: bool,
    edge: i32,
    first_vertex: i32,
    kind: i32,
}

struct RawFace {
    at: usize,
    loops: Vec<i32>,
    surface: i32,
    is_reversed: bool,
}

/// The faces of a brep; `tolerance` is the file's, model units. A face that cannot be made costs itself.
pub(super) fn read(object: &Object, tolerance: f64) -> Result<Body, Fault> {
    let lists = Lists::read(&mut object.data.clone())?;
    let mut body = Body::default();
    // Where each surface of the file is in the body, or why it is not.
    let sheets: Vec<Result<Sheet, Fault>> =
        lists.surfaces.iter().map(|surface| sheet(surface.as_ref(), &object.data, tolerance)).collect();
    let mut index = vec![None; sheets.len()];
    for (number, raw) in lists.faces.iter().enumerate() {
        let part = format!("face {number}");
        match lists.face(raw, &sheets, tolerance) {
            Ok((mut face, slits, off)) => {
                let surface = face.surface;
                let next = body.surfaces.len();
                face.surface = *index[surface].get_or_insert(next);
                if face.surface == next {
                    body.surfaces.extend(sheets[surface].as_ref().ok().map(|sheet| sheet.surface.clone()));
                    body.kinds.extend(lists.surfaces[surface].as_ref().map(Object::surface_kind));
                }
                body.faces.push(face);
                if slits > 0 {
                    let text = format!("{slits} loops that enclose nothing (slits, points, curves)");
                    body.remarks.push(Remark::left_out(&part, Fault { at: raw.at, text }));
                }
                if off > 0.0 {
                    let text =
                        format!("{part}: trims across angles are cubics, off by {off:.1e} of the surface's domain");
                    body.remarks.push(Remark { kind: NoteKind::Approximated, at: raw.at, text });
                }
            }
            Err(fault) => body.remarks.push(Remark::left_out(&part, fault)),
        }
        let loose = lists.loose.take();
        if loose > 0 {
            let text = format!("{part}: {loose} trims name an edge or a vertex that is not there: they have none");
            body.remarks.push(Remark::healed(raw.at, text));
        }
    }
    Ok(body)
}

fn sheet(surface: Option<&Object>, data: &Cursor, tolerance: f64) -> Result<Sheet, Fault> {
    match surface {
        Some(object) if object.class == Class::Extrusion => Extrusion::read(object)?.wall(tolerance),
        Some(object) => Sheet::read(object, tolerance),
        None => data.fault("its surface is missing"),
    }
}

/// The entry of a list that an index of the file names.
fn entry<'l, T>(list: &'l [T], index: i32, what: &str, at: usize) -> Result<&'l T, Fault> {
    let found = usize::try_from(index).ok().and_then(|index| list.get(index));
    found.ok_or_else(|| Fault { at, text: format!("there is no {what} {index} among {}", list.len()) })
}

impl<'a> Lists<'a> {
    fn read(data: &mut Cursor<'a>) -> Result<Self, Fault> {
        let unread = Cell::new(USES * data.left());
        data.packed_version(3)?;
        let curves = objects(data)?;
        data.content(code::ANONYMOUS)?;
        let surfaces = objects(data)?;
        let vertices = list(data, 40, |c| {
            c.skip(4 + 3 * 8)?;
            c.indices()?;
            radius(c)
        })?;
        let edges = list(data, 64, |c| {
            c.skip(3 * 4 + 2 * 8 + 2 * 4)?;
            c.indices()?;
            let radius = radius(c)?;
            c.skip(2 * 8)?;
            Ok(radius)
        })?;
        let trims = list(data, 132, trim)?;
        let loops = list(data, 16, |c| {
            c.skip(4)?;
            let trims = c.indices()?;
            let kind = c.i32()?;
            c.skip(4)?;
            Ok((trims, kind))
        })?;
        let faces = list(data, 20, |c| {
            let at = c.at();
            c.skip(4)?;
            let face = RawFace { at, loops: c.indices()?, surface: c.i32()?, is_reversed: c.i32()? != 0 };
            // A material.
            c.skip(4)?;
            Ok(face)
        })?;
        Ok(Self { curves, surfaces, vertices, edges, trims, loops, faces, unread, loose: Cell::new(0) })
    }

    /// A face on the surface of the file that its index names, how many of its loops enclose nothing, and how far trims are off.
    fn face(
        &self,
        raw: &RawFace,
        sheets: &[Result<Sheet, Fault>],
        tolerance: f64,
    ) -> Result<(Face, usize, f64), Fault> {
        let sheet = entry(sheets, raw.surface, "surface", raw.at)?.as_ref().map_err(Clone::clone)?;
        let (mut loops, mut slits, mut off) = (vec![], 0, 0.0);
        for index in &raw.loops {
            let (trims, kind) = entry(&self.loops, *index, "loop", raw.at)?;
            if !matches!(*kind, loop_kind::OUTER | loop_kind::INNER) {
                slits += 1;
                continue;
            }
            let mut boundary = Loop { outer: *kind == loop_kind::OUTER, trims: vec![] };
            for index in trims {
                let raw = entry(&self.trims, *index, "trim", raw.at)?;
                off = self.run(raw, sheet, &mut boundary.trims)?.max(off);
            }
            if boundary.trims.is_empty() {
                return Err(Fault { at: raw.at, text: format!("its loop {index} has no trims") });
            }
            loops.push(boundary);
        }
        if loops.is_empty() {
            return Err(Fault { at: raw.at, text: "it has no loop".into() });
        }
        let surface = usize::try_from(raw.surface).expect("an entry has it");
        Ok((Face { surface, reversed: raw.is_reversed, tolerance, loops }, slits, off))
    }

    /// Adds what a trim of the file runs along; returns how far that is off.
    fn run(&self, raw: &RawTrim, sheet: &Sheet, trims: &mut Vec<Trim>) -> Result<f64, Fault> {
        let curve = entry(&self.curves, raw.curve, "curve", raw.at)?;
        let Some(curve) = curve else { return Err(Fault { at: raw.at, text: "its curve is missing".into() }) };
        match self.unread.get().checked_sub(curve.data.left()) {
            Some(unread) => self.unread.set(unread),
            None => return Err(Fault { at: raw.at, text: "trims repeat curves too often".into() }),
        }
        if !raw.range.iter().all(|t| t.is_finite()) {
            return Err(Fault { at: raw.at, text: format!("it runs from {} to {}", raw.range[0], raw.range[1]) });
        }
        // Below 0 is none, as at a pole.
        let edge = usize::try_from(raw.edge).ok().and_then(|index| self.edges.get(index));
        let vertex = usize::try_from(raw.first_vertex).ok().and_then(|index| self.vertices.get(index));
        if (0 <= raw.edge && edge.is_none()) || (0 <= raw.first_vertex && vertex.is_none()) {
            self.loose.set(self.loose.get() + 1);
        }
        let (first, mut off) = (trims.len(), 0.0);
        for piece in pieces(curve)? {
            let Some(part) = part(&piece, raw.range).map_err(unfit(raw.at))? else { continue };
            let (spline, apart) = fitted(&part, &sheet.turns, sheet.surface.domain()).map_err(unfit(raw.at))?;
            off = apart.max(off);
            trims.push(Trim {
                reversed: raw.is_reversed,
                seam: raw.kind == trim_kind::SEAM,
                degenerate: raw.kind == trim_kind::SINGULAR,
                edge: edge.map(|_| i64::from(raw.edge)),
                edge_tolerance: edge.copied().flatten().unwrap_or(0.0),
                ..spline.trim()
            });
        }
        if raw.is_reversed {
            trims[first..].reverse();
        }
        match trims.get_mut(first) {
            Some(trim) => trim.vertex_tolerance = vertex.copied().flatten(),
            None => return Err(Fault { at: raw.at, text: "it runs along no part of its curve".into() }),
        }
        Ok(off)
    }
}

/// The part of a piece of a curve over a range of the file's own parameter; `None` where the range does not meet it.
fn part(piece: &Curve, [start, end]: [f64; 2]) -> Result<Option<crate::spline::Spline>, nurbs::NurbsError> {
    let [first, last] = piece.spline.domain();
    // A range that is not set does not ascend.
    let is_set = start < end;
    if !is_set || (start <= first && last <= end) {
        return Ok(Some(piece.spline.clone()));
    }
    let [start, end] = [start.max(first), end.min(last)];
    if end <= start {
        return Ok(None);
    }
    piece.spline.restricted([start, end].map(|t| parameter(&piece.turns, t).clamp(first, last))).map(Some)
}

/// A radius that a modeller has set.
fn radius(cursor: &mut Cursor) -> Result<Option<f64>, Fault> {
    // Not set is −1.23432101234321e308.
    Ok(Some(cursor.f64()?).filter(|r| *r >= 0.0 && r.is_finite()))
}

fn trim(c: &mut Cursor) -> Result<RawTrim, Fault> {
    let at = c.at();
    c.skip(4)?;
    let curve = c.i32()?;
    let range = [c.f64()?, c.f64()?];
    let (edge, first_vertex) = (c.i32()?, c.i32()?);
    // The last vertex; whether the edge runs the other way.
    c.skip(2 * 4)?;
    let kind = c.i32()?;
    // Along which border it runs, its loop, two tolerances, its own domain.
    c.skip(2 * 4 + 4 * 8)?;
    let is_reversed = c.u8()? == 1;
    // Reserved, and two tolerances of old.
    c.skip(7 + 24 + 2 * 8)?;
    Ok(RawTrim { at, curve, range, is_reversed, edge, first_vertex, kind })
}

/// A list in a chunk of its own, of entries of at least `size` bytes.
fn list<'a, T>(
    data: &mut Cursor<'a>,
    size: usize,
    mut read: impl FnMut(&mut Cursor<'a>) -> Result<T, Fault>,
) -> Result<Vec<T>, Fault> {
    let mut content = data.content(code::ANONYMOUS)?;
    content.packed_version(1)?;
    (0..content.count(size)?).map(|_| read(&mut content)).collect()
}

/// A list of curves or surfaces, some of which may be missing.
fn objects<'a>(data: &mut Cursor<'a>) -> Result<Vec<Option<Object<'a>>>, Fault> {
    list(data, 4, |c| match c.i32()? {
        1 => Object::read(c).map(Some),
        _ => Ok(None),
    })
}
