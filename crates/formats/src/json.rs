//! `nurbs-neutral` version 1: the project's own files, JSON that keeps every f64 exactly.
//!
//! ```text
//! {"format": "nurbs-neutral", "version": 1, "name": "…",
//!  "surfaces": [{"degree": [p, q], "knots_u": [..], "knots_v": [..], "nu": n, "nv": m,
//!                "points": [[x, y, z], ..], "weights": [..]}],
//!  "faces": [{"surface": k, "reversed": false, "tolerance": t,
//!             "loops": [{"outer": true, "trims": [
//!                {"degree": p, "knots": [..], "points": [[u, v], ..], "weights": [..],
//!                 "reversed": false, "seam": false, "degenerate": false, "edge": id}]}]}]}
//! ```
//!
//! Points are Euclidean, not multiplied by their weights; index i m + j, i along u. Knot vectors have all n + p + 1
//! knots and may be unclamped. Trims stand in loop order; `reversed` says that the loop runs the curve backwards; with
//! the face's own orientation removed, material is on the left of the loop. A face without loops is its whole surface.
//!
//! May be absent or null: `name` (then the file's name), `faces` (then one whole face a surface), `weights` (then
//! polynomial), `tolerance` (0), `loops` (none), `edge`, and the flags `reversed`, `seam` and `degenerate` (false).
//! Keys in any order; unknown keys are ignored; a known key given twice is refused. Counts may be written `3.0`.
//!
//! Two extensions, both understood when read and never written:
//!
//! - `"knot_convention": "short"` (or `"full"`) in the document, overridden by the same key in a surface or a trim: the
//!   two superfluous end knots are left out, so that n + p − 1 stand in the file. Each end knot is repeated once, which
//!   is exact where the vector is clamped, and in general, as no point of the domain depends on them.
//! - `"periodic": [bool, bool]` in a surface: in a periodic direction there are n points and n + 1 knots, one period
//!   of n spans, whatever the convention. The knots are unrolled by [`KnotVector::periodic`], and the first p points
//!   repeated after the last.

mod raw;
mod write;

use crate::FormatError;
use crate::place::Place;
use crate::wrap::wrap;
use glam::{DVec2, DVec3};
use nurbs::{KnotVector, NurbsError, Surface};
use raw::{Convention, Format, RawDocument, RawFace, RawLoop, RawSurface, RawTrim, Version};
use scene::{Face, Loop, Model, Trim};
use std::path::Path;

pub use write::write;

/// The value of `format`.
const FORMAT: &str = "nurbs-neutral";

/// The value of `version`.
const VERSION: u64 = 1;

/// Reads a model from JSON text; `file` names it in messages, and its last component names a model without a name.
///
/// # Errors
/// [`FormatError::Syntax`] and [`FormatError::Kind`] with line, column and member; [`FormatError::Value`],
/// [`FormatError::Count`], [`FormatError::Nurbs`] and [`FormatError::Scene`] with the member.
pub fn parse(text: &str, file: &str) -> Result<Model, FormatError> {
    let place = Place::document(file);
    let RawDocument { format: Format, version: Version, surfaces: raw_surfaces, name, knot_convention, faces } =
        raw::parse(text, file)?;
    let convention = knot_convention.unwrap_or(Convention::Full);
    if raw_surfaces.is_empty() {
        return Err(place.key("surfaces").value("[]", "at least one surface"));
    }
    let mut surfaces = Vec::with_capacity(raw_surfaces.len());
    for (i, surface) in raw_surfaces.into_iter().enumerate() {
        surfaces.push(build_surface(surface, convention, &place.key("surfaces").index(i))?);
    }
    let name = name.unwrap_or_else(|| file_name(file));
    let Some(raw_faces) = faces else {
        return Model::of_surfaces(name, surfaces).map_err(|cause| place.scene(cause));
    };
    let mut faces = Vec::with_capacity(raw_faces.len());
    for (i, face) in raw_faces.into_iter().enumerate() {
        faces.push(build_face(face, convention, &place.key("faces").index(i))?);
    }
    Model::new(name, surfaces, faces).map_err(|cause| place.scene(cause))
}

/// The last component of a path.
pub(crate) fn file_name(file: &str) -> String {
    Path::new(file).file_name().map_or_else(|| file.to_owned(), |name| name.to_string_lossy().into_owned())
}

/// Checks the number of knots for `count` control points and builds the vector.
fn build_knots(
    degree: usize,
    knots: Vec<f64>,
    count: usize,
    convention: Convention,
    place: &Place,
) -> Result<KnotVector, FormatError> {
    // Saturating: no list has usize::MAX entries, so that an overflow is found to be a wrong count.
    let order = degree + 1;
    match convention {
        Convention::Full => {
            place.count(knots.len(), count.saturating_add(order), "the degree and the number of points (n + p + 1)")?;
            KnotVector::new(degree, knots).map_err(|cause| place.nurbs(cause))
        }
        Convention::Short => {
            let expected = count.saturating_add(order) - 2;
            place.count(knots.len(), expected, "the degree and the number of points (n + p - 1, short convention)")?;
            let ends = knots.first().zip(knots.last()).map(|(first, last)| [[*first], [*last]]);
            let knots = ends.map_or(vec![], |[first, last]| [&first, knots.as_slice(), &last].concat());
            let place = place.remark("with its end knots added");
            KnotVector::new(degree, knots).map_err(|cause| place.nurbs(cause))
        }
    }
}

fn build_surface(raw: RawSurface, inherited: Convention, place: &Place) -> Result<Surface, FormatError> {
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
    let mut vectors = vec![];
    for (d, (knots, key)) in [(raw.knots_u, "knots_u"), (raw.knots_v, "knots_v")].into_iter().enumerate() {
        let place = place.key(key);
        vectors.push(if periodic[d] {
            let reason = "the number of points of the period (n + 1)";
            place.count(knots.len(), counts[d].saturating_add(1), reason)?;
            let place = place.remark("unrolled from its period");
            KnotVector::periodic(degree[d], &knots).map_err(|cause| place.nurbs(cause))?
        } else {
            build_knots(degree[d], knots, counts[d], convention, &place)?
        });
    }
    let mut points: Vec<DVec3> = raw.points.into_iter().map(DVec3::from_array).collect();
    let mut weights = raw.weights;
    if periodic != [false; 2] {
        let wraps = [0, 1].map(|d| periodic[d].then_some(degree[d]));
        points = wrap(&points, counts, wraps);
        weights = weights.map(|w| wrap(&w, counts, wraps));
    }
    let [knots_u, knots_v] = vectors.try_into().expect("one vector a direction");
    Surface::new(knots_u, knots_v, points, weights).map_err(|cause| {
        let key = match cause {
            NurbsError::WeightCount { .. } | NurbsError::Weight { .. } => "weights",
            _ => "points",
        };
        let place = place.key(key);
        if periodic == [false; 2] { place.nurbs(cause) } else { place.remark("with its period repeated").nurbs(cause) }
    })
}

fn build_face(raw: RawFace, convention: Convention, place: &Place) -> Result<Face, FormatError> {
    let mut loops = vec![];
    for (i, raw) in raw.loops.unwrap_or_default().into_iter().enumerate() {
        loops.push(build_loop(raw, convention, &place.key("loops").index(i))?);
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

fn build_loop(raw: RawLoop, convention: Convention, place: &Place) -> Result<Loop, FormatError> {
    let mut trims = vec![];
    for (i, raw) in raw.trims.into_iter().enumerate() {
        trims.push(build_trim(raw, convention, &place.key("trims").index(i))?);
    }
    Ok(Loop { outer: raw.outer, trims })
}

fn build_trim(raw: RawTrim, inherited: Convention, place: &Place) -> Result<Trim, FormatError> {
    let convention = raw.knot_convention.unwrap_or(inherited);
    let points: Vec<DVec2> = raw.points.into_iter().map(DVec2::from_array).collect();
    Ok(Trim {
        knots: build_knots(raw.degree.0, raw.knots, points.len(), convention, &place.key("knots"))?,
        points,
        weights: raw.weights,
        reversed: raw.reversed.unwrap_or(false),
        seam: raw.seam.unwrap_or(false),
        degenerate: raw.degenerate.unwrap_or(false),
        edge: raw.edge,
        edge_tolerance: 0.0,
        vertex_tolerance: None,
    })
}

/// What a face's type does not prove, checked when it is read and when it is written: tolerance, counts and values.
fn check_face(face: &Face, place: &Place) -> Result<(), FormatError> {
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

fn check_trim(trim: &Trim, place: &Place) -> Result<(), FormatError> {
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
