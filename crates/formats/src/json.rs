//! `nurbs-neutral` version 1: the project's own files, JSON that keeps every f64 exactly.
//!
//! ```text
//! {"format": "nurbs-neutral", "version": 1, "name": "…", "unit": {"name": "millimetre", "millimetres": 1.0},
//!  "surfaces": [{"degree": [p, q], "knots_u": [..], "knots_v": [..], "nu": n, "nv": m,
//!                "points": [[x, y, z], ..], "weights": [..]}],
//!  "faces": [{"surface": k, "name": "…", "colour": "#rrggbb", "layers": ["…"], "kind": "plane", "reversed": false, "tolerance": t,
//!             "loops": [{"outer": true, "trims": [
//!                {"degree": p, "knots": [..], "points": [[u, v], ..], "weights": [..],
//!                 "reversed": false, "seam": false, "degenerate": false, "edge": id,
//!                 "edge_tolerance": t, "vertex_tolerance": t}]}]}]}
//! ```
//!
//! Points are Euclidean, not multiplied by their weights; index i m + j, i along u. Knot vectors have all n + p + 1
//! knots and may be unclamped. Trims stand in loop order; `reversed` says that the loop runs the curve backwards; with
//! the face's own orientation removed, material is on the left of the loop. A face without loops is its whole surface.
//!
//! Tolerances are in model units. `vertex_tolerance` is that of the vertex at which the loop enters the trim: the radius of
//! a ball in which both edges end, so that a gap of twice that is healed. A gap is healed, too, up to the tolerance of the
//! face and of both edges, and up to 1e-7 of the model's greatest coordinate. Where a face has a tolerance and the vertex
//! none, a wider gap is closed up to 1e-3 of its loop's size, and noted: files lose the vertices' tolerances more often
//! than the faces'. Both keys may also stand in a face, for those of its trims that have none.
//!
//! A face whose loops bound no region is left out, the others are drawn, and [`Model::notes`] says why: which face, loop and
//! trim. A model of which no face is left is refused, and so is a file with a wrong number, count or key anywhere.
//!
//! Inside a knot vector a knot may occur p + 1 times: Bézier pieces in a row. Where the two points there are one, so is the
//! spline; where they are two, the surface is cut into several, and its faces with it, which is noted. A torn trim is refused.
//!
//! `unit` is that of the coordinates, with its length. A face's `colour` is sRGB; `layers` are names; its `kind` says what the surface was in
//! the file that it comes from: `plane`, `cylinder`, `cone`, `sphere`, `torus`, `revolution`, `extrusion`, `sum`, `offset`, or
//! `b-spline` where it is absent. None of them changes what is drawn.
//!
//! May be absent or null: `name` (then the file's name), `unit`, a face's `name`, `colour`, `layers` and `kind`, `faces` (then one whole face a surface), `weights` (then
//! polynomial), `tolerance` and `edge_tolerance` (0), `vertex_tolerance` (unknown), `loops` (none), `edge`, and the flags
//! `reversed`, `seam` and `degenerate` (false). Keys in any order; a key given twice is refused, and so is one that is not
//! named here, lest a slip in a name pass for an absent key. Read over are only `view` and `meta` of the document and
//! `pixel` of a face, which `isophote scene` adds. Counts may be written `3.0`.
//!
//! Two extensions, both understood when read and never written:
//!
//! - `"knot_convention": "short"` (or `"full"`) in the document, overridden by the same key in a surface or a trim: the
//!   two superfluous end knots are left out, so that n + p − 1 stand in the file. Each end knot is repeated once, which
//!   is exact where the vector is clamped, and in general, as no point of the domain depends on them.
//! - `"periodic": [bool, bool]` in a surface: in a periodic direction there are n points and n + 1 knots, one period
//!   of n spans, whatever the convention. The knots are unrolled by [`KnotVector::periodic`], and the first p points
//!   repeated after the last.

mod pieces;
mod raw;
mod said;
mod write;

use crate::document::{Attributes, Document};
use crate::error::FormatError;
use crate::format::{Format, file_name, text, text_head};
use crate::member::Member;
use crate::wrap::wrap;
use glam::{DVec2, DVec3};
use nurbs::{KnotVector, NurbsError, Surface};
use pieces::{Cut, Net};
use raw::{Convention, RawDocument, RawFace, RawLoop, RawSurface, RawTrim, Version};
use scene::{Face, FaceId, Loop, Model, Note, SceneError, Trim};
use std::ops::Range;

pub use write::{write, write_document};

/// The most faces and trims that stand in no file, but are copies for the parts of torn surfaces.
const COPIED: usize = 100_000;

/// The format.
pub struct Json;

impl Format for Json {
    fn name(&self) -> &'static str {
        "JSON"
    }

    fn extensions(&self) -> &'static [&'static str] {
        &["json"]
    }

    fn start(&self) -> &'static str {
        "starts with '{'"
    }

    fn sniff(&self, head: &[u8]) -> bool {
        text_head(head).trim_start().starts_with('{')
    }

    fn read(&self, bytes: &[u8], file: &str) -> Result<Document, FormatError> {
        document(text(bytes, file)?, file)
    }
}

/// Reads a model from JSON text, as [`document`] does, without what is said beyond its shape.
///
/// # Errors
/// As [`document`].
pub fn parse(text: &str, file: &str) -> Result<Model, FormatError> {
    document(text, file).map(|document| document.model)
}

/// Reads a document from JSON text; `file` names it in messages, and its last component names a model without a name.
///
/// # Errors
/// [`Cause::Syntax`](crate::Cause::Syntax) and [`Cause::Kind`](crate::Cause::Kind) with line, column and member; `Value`,
/// `Count`, `Nurbs` and `Scene` with the member.
pub fn document(text: &str, file: &str) -> Result<Document, FormatError> {
    let place = Member::document(file);
    let RawDocument {
        format: raw::Format,
        version: Version,
        surfaces: raw_surfaces,
        name,
        unit,
        knot_convention,
        faces: faces_of_file,
    } = raw::parse(text, file)?;
    let unit = unit.map(|unit| said::unit(unit, &place.key("unit"))).transpose()?;
    let convention = knot_convention.unwrap_or(Convention::Full);
    if raw_surfaces.is_empty() {
        return Err(place.key("surfaces").value("[]", "at least one surface"));
    }
    let mut surfaces = Vec::with_capacity(raw_surfaces.len());
    // Where the surfaces begin that a surface of the file was cut into, and where they end.
    let mut parts: Vec<Range<usize>> = vec![];
    let mut notes = vec![];
    for (i, surface) in raw_surfaces.into_iter().enumerate() {
        let first = surfaces.len();
        let cuts = build_surface(surface, convention, &place.key("surfaces").index(i), &mut surfaces)?;
        let note =
            |cut: Cut| Note::SurfaceCut { surface: i, parameter: ['u', 'v'][cut.axis], at: cut.at, apart: cut.apart };
        notes.extend(cuts.into_iter().map(note));
        parts.push(first..surfaces.len());
    }
    let name = name.unwrap_or_else(|| file_name(file));
    let mut faces = vec![];
    // Of each face of the file.
    let mut attributes: Vec<Attributes> = vec![];
    match faces_of_file {
        None => {
            for (i, part) in parts.iter().enumerate() {
                faces.extend(part.clone().map(|surface| (i, Face::whole(surface))));
            }
        }
        Some(raw_faces) => {
            let mut copied = 0;
            for (i, mut face) in raw_faces.into_iter().enumerate() {
                let place_of_face = place.key("faces").index(i);
                attributes.push(said::attributes(&mut face, &place_of_face)?);
                let face = build_face(face, convention, &place_of_face)?;
                let Some(part) = parts.get(face.surface) else {
                    let (surface, count) = (face.surface, parts.len());
                    return Err(place.scene(SceneError::NoSuchSurface { face: i, surface, count }));
                };
                let trims: usize = face.loops.iter().map(|boundary| boundary.trims.len()).sum();
                copied += (part.len() - 1) * (1 + trims);
                if COPIED < copied {
                    let place = place.key("surfaces").index(face.surface);
                    return Err(
                        place.value(format!("torn into {} parts", part.len()), "fewer for so many faces and trims")
                    );
                }
                faces.extend(part.clone().map(|surface| (i, Face { surface, ..face.clone() })));
            }
        }
    }
    let model = Model::of_sound_faces(name, surfaces, faces, notes).map_err(|cause| place.scene(cause))?;
    let mut document = Document { unit, ..Document::of_model(model) };
    for (id, own) in document.attributes.iter_mut().enumerate() {
        let number = document.model.number_in_file(FaceId(id as u32));
        *own = attributes.get(number).cloned().unwrap_or_default();
    }
    Ok(document)
}

/// Checks the number of knots for `count` control points, and adds those that the convention leaves out.
fn full_knots(
    degree: usize,
    knots: Vec<f64>,
    count: usize,
    convention: Convention,
    place: &Member,
) -> Result<Vec<f64>, FormatError> {
    // Saturating: no list has usize::MAX entries, so that an overflow is found to be a wrong count.
    let order = degree + 1;
    match convention {
        Convention::Full => {
            place.count(knots.len(), count.saturating_add(order), "the degree and the number of points (n + p + 1)")?;
            Ok(knots)
        }
        Convention::Short => {
            let expected = count.saturating_add(order) - 2;
            place.count(knots.len(), expected, "the degree and the number of points (n + p - 1, short convention)")?;
            let ends = knots.first().zip(knots.last()).map(|(first, last)| [[*first], [*last]]);
            Ok(ends.map_or(vec![], |[first, last]| [&first, knots.as_slice(), &last].concat()))
        }
    }
}

/// The place of a list of knots, with what was done to it.
fn knots_place<'a>(convention: Convention, place: &Member<'a>) -> Member<'a> {
    match convention {
        Convention::Full => place.clone(),
        Convention::Short => place.remark("with its end knots added"),
    }
}

/// Adds the surface, or the surfaces that it has to be cut into, to `surfaces`; returns where it is torn.
fn build_surface(
    raw: RawSurface,
    inherited: Convention,
    place: &Member,
    surfaces: &mut Vec<Surface>,
) -> Result<Vec<Cut>, FormatError> {
    let convention = raw.knot_convention.unwrap_or(inherited);
    let (degree, counts) = (raw.degree.map(|d| d.0), [raw.nu.0, raw.nv.0]);
    let periodic = raw.periodic.unwrap_or([false; 2]);
    for (count, key) in counts.into_iter().zip(["nu", "nv"]) {
        if count == 0 {
            return Err(place.key(key).value(count, "at least one control point"));
        }
    }
    let expected = counts[0].saturating_mul(counts[1]);
    place.key("points").count(raw.points.len(), expected, "nu and nv")?;
    if let Some(weights) = &raw.weights {
        place.key("weights").count(weights.len(), expected, "nu and nv")?;
    }
    let keys = ["knots_u", "knots_v"].map(|key| place.key(key));
    let points: Vec<DVec3> = raw.points.into_iter().map(DVec3::from_array).collect();
    let weights = raw.weights;
    if periodic == [false; 2] {
        let [u, v] = [raw.knots_u, raw.knots_v];
        let knots = [
            full_knots(degree[0], u, counts[0], convention, &keys[0])?,
            full_knots(degree[1], v, counts[1], convention, &keys[1])?,
        ];
        let keys = keys.map(|key| knots_place(convention, &key));
        let (nets, cuts) = pieces::parts(Net { degree, knots, counts, points, weights });
        let remark = (nets.len() > 1).then_some("cut at its knots of full multiplicity");
        for Net { degree, knots, points, weights, .. } in nets {
            let mut vectors = vec![];
            for ((degree, knots), key) in degree.into_iter().zip(knots).zip(&keys) {
                vectors.push(KnotVector::new(degree, knots).map_err(|cause| key.nurbs(cause))?);
            }
            surfaces.push(checked_surface(vectors, points, weights, remark, place)?);
        }
        return Ok(cuts);
    }
    let mut vectors = vec![];
    for (d, (knots, place)) in [raw.knots_u, raw.knots_v].into_iter().zip(keys).enumerate() {
        let vector = if periodic[d] {
            let reason = "the number of points of the period (n + 1)";
            place.count(knots.len(), counts[d].saturating_add(1), reason)?;
            let place = place.remark("unrolled from its period");
            KnotVector::periodic(degree[d], &knots).map_err(|cause| place.nurbs(cause))
        } else {
            let knots = full_knots(degree[d], knots, counts[d], convention, &place)?;
            KnotVector::new(degree[d], knots).map_err(|cause| knots_place(convention, &place).nurbs(cause))
        };
        vectors.push(vector?);
    }
    let wraps = [0, 1].map(|d| periodic[d].then_some(degree[d]));
    let points = wrap(&points, counts, wraps);
    let weights = weights.map(|w| wrap(&w, counts, wraps));
    surfaces.push(checked_surface(vectors, points, weights, Some("with its period repeated"), place)?);
    Ok(vec![])
}

fn checked_surface(
    vectors: Vec<KnotVector>,
    points: Vec<DVec3>,
    weights: Option<Vec<f64>>,
    remark: Option<&str>,
    place: &Member,
) -> Result<Surface, FormatError> {
    let [knots_u, knots_v] = vectors.try_into().expect("one vector a direction");
    Surface::new(knots_u, knots_v, points, weights).map_err(|cause| {
        let key = match cause {
            NurbsError::WeightCount { .. } | NurbsError::Weight { .. } => "weights",
            _ => "points",
        };
        let place = place.key(key);
        remark.map_or(place.clone(), |remark| place.remark(remark)).nurbs(cause)
    })
}

fn build_face(raw: RawFace, convention: Convention, place: &Member) -> Result<Face, FormatError> {
    let usual = Usual { convention, edge_tolerance: raw.edge_tolerance, vertex_tolerance: raw.vertex_tolerance };
    let mut loops = vec![];
    for (i, raw) in raw.loops.unwrap_or_default().into_iter().enumerate() {
        loops.push(build_loop(raw, &usual, &place.key("loops").index(i))?);
    }
    let face = Face {
        surface: raw.surface.0,
        reversed: raw.reversed.unwrap_or(false),
        tolerance: raw.tolerance.unwrap_or(0.0),
        loops,
    };
    check_face(&face, place)?;
    Ok(face)
}

/// What holds for all trims of a face that say nothing else.
struct Usual {
    convention: Convention,
    edge_tolerance: Option<f64>,
    vertex_tolerance: Option<f64>,
}

fn build_loop(raw: RawLoop, usual: &Usual, place: &Member) -> Result<Loop, FormatError> {
    let mut trims = vec![];
    for (i, raw) in raw.trims.into_iter().enumerate() {
        trims.push(build_trim(raw, usual, &place.key("trims").index(i))?);
    }
    Ok(Loop { outer: raw.outer, trims })
}

fn build_trim(raw: RawTrim, usual: &Usual, place: &Member) -> Result<Trim, FormatError> {
    let convention = raw.knot_convention.unwrap_or(usual.convention);
    let degree = raw.degree.0;
    let mut points: Vec<DVec2> = raw.points.into_iter().map(DVec2::from_array).collect();
    let mut weights = raw.weights;
    let place = place.key("knots");
    let mut knots = full_knots(degree, raw.knots, points.len(), convention, &place)?;
    pieces::merge(degree, &mut knots, &mut points, weights.as_mut());
    Ok(Trim {
        reversed: raw.reversed.unwrap_or(false),
        seam: raw.seam.unwrap_or(false),
        degenerate: raw.degenerate.unwrap_or(false),
        edge: raw.edge,
        edge_tolerance: raw.edge_tolerance.or(usual.edge_tolerance).unwrap_or(0.0),
        vertex_tolerance: raw.vertex_tolerance.or(usual.vertex_tolerance),
        ..Trim::new(
            KnotVector::new(degree, knots).map_err(|cause| knots_place(convention, &place).nurbs(cause))?,
            points,
            weights,
        )
    })
}

/// What a face's type does not prove, checked when it is read and when it is written: tolerance, counts and values.
fn check_face(face: &Face, place: &Member) -> Result<(), FormatError> {
    if !(face.tolerance >= 0.0 && face.tolerance.is_finite()) {
        return Err(place.key("tolerance").value(face.tolerance, "a finite number not below 0"));
    }
    for (i, boundary) in face.loops.iter().enumerate() {
        let place = place.key("loops").index(i).key("trims");
        if boundary.trims.is_empty() {
            return Err(place.value("[]", "at least one curve"));
        }
        for (i, trim) in boundary.trims.iter().enumerate() {
            check_trim(trim, &place.index(i))?;
        }
    }
    Ok(())
}

fn check_trim(trim: &Trim, place: &Member) -> Result<(), FormatError> {
    let tolerances = [("edge_tolerance", Some(trim.edge_tolerance)), ("vertex_tolerance", trim.vertex_tolerance)];
    for (key, tolerance) in tolerances {
        if let Some(tolerance) = tolerance.filter(|t| !(*t >= 0.0 && t.is_finite())) {
            return Err(place.key(key).value(tolerance, "a finite number not below 0"));
        }
    }
    let expected = trim.knots.control_count();
    let points = place.key("points");
    points.count(trim.points.len(), expected, "the degree and the knots")?;
    if let Some(i) = trim.points.iter().position(|p| !p.is_finite()) {
        return Err(points.index(i).value(trim.points[i], "a pair of finite numbers"));
    }
    let Some(weights) = &trim.weights else { return Ok(()) };
    let place = place.key("weights");
    place.count(weights.len(), expected, "the degree and the knots")?;
    match weights.iter().position(|&w| !(w > 0.0 && w.is_finite())) {
        Some(i) => Err(place.index(i).value(weights[i], "a finite number above 0")),
        None => Ok(()),
    }
}
