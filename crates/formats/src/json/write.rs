//! Writing: one surface's row of control points a line, so that files compare well line by line.

use super::check_face;
use super::raw::{FORMAT, VERSION};
use super::said::{attributes_text, unit_text};
use crate::document::{Attributes, Document, Unit};
use crate::error::FormatError;
use crate::member::Member;
use nurbs::{Direction, KnotVector, Surface};
use scene::{Face, Loop, Model, Trim};
use std::fmt::Display;

/// The model as JSON text, ending in a newline. [`super::parse`] returns an equal model, bit for bit.
///
/// # Errors
/// As [`write_document`].
pub fn write(model: &Model) -> Result<String, FormatError> {
    text(model, None, &[])
}

/// The document as JSON text, ending in a newline: the model with its unit, and the names, colours, layers and kinds of its faces.
/// [`super::document`] returns an equal one, bit for bit, but for the notes on how the file was read.
///
/// # Errors
/// [`Cause::Value`](crate::Cause::Value) and [`Cause::Count`](crate::Cause::Count), with the model's name for the file, where a face's tolerance or
/// trim curves hold what could not be read back; models that were read never do.
pub fn write_document(document: &Document) -> Result<String, FormatError> {
    text(&document.model, document.unit.as_ref(), &document.attributes)
}

/// `attributes` may be fewer than the faces.
fn text(model: &Model, unit: Option<&Unit>, attributes: &[Attributes]) -> Result<String, FormatError> {
    let place = Member::document(model.name()).key("faces");
    for (i, face) in model.faces().iter().enumerate() {
        check_face(face, &place.index(i))?;
    }
    let surfaces = model.surfaces().iter().map(surface_text).collect::<Vec<_>>().join(",\n");
    let said = attributes.iter().map(attributes_text).chain(std::iter::repeat(String::new()));
    let faces =
        model.faces().iter().zip(said).map(|(face, said)| face_text(face, &said)).collect::<Vec<_>>().join(",\n");
    Ok(format!(
        "{{\"format\":\"{FORMAT}\",\"version\":{VERSION},\"name\":{name}{unit},\n\"surfaces\":[\n{surfaces}\n],\n\
         \"faces\":[\n{faces}\n]}}\n",
        name = serde_json::Value::from(model.name()),
        unit = unit_text(unit),
    ))
}

/// The shortest digits that read back as the same f64; Rust's `Debug` form of a finite number is JSON.
fn number(x: f64) -> String {
    format!("{x:?}")
}

fn list<T: Display>(items: impl IntoIterator<Item = T>) -> String {
    let items: Vec<String> = items.into_iter().map(|item| item.to_string()).collect();
    format!("[{}]", items.join(","))
}

fn numbers(items: &[f64]) -> String {
    list(items.iter().copied().map(number))
}

fn weights_text(weights: Option<&[f64]>) -> String {
    weights.map_or_else(|| "null".to_owned(), numbers)
}

fn surface_text(surface: &Surface) -> String {
    let ([p, q], [nu, nv]) = (surface.degree(), surface.control_counts());
    let rows: Vec<String> = surface
        .points()
        .chunks(nv)
        .map(|row| row.iter().map(|point| numbers(&point.to_array())).collect::<Vec<_>>().join(","))
        .collect();
    format!(
        "{{\"degree\":[{p},{q}],\"nu\":{nu},\"nv\":{nv},\n\"knots_u\":{knots_u},\n\"knots_v\":{knots_v},\n\
         \"points\":[\n{points}],\n\"weights\":{weights}}}",
        knots_u = numbers(surface.knots(Direction::U).knots()),
        knots_v = numbers(surface.knots(Direction::V).knots()),
        points = rows.join(",\n"),
        weights = weights_text(surface.weights()),
    )
}

/// `said` stands before the loops.
fn face_text(face: &Face, said: &str) -> String {
    format!(
        "{{\"surface\":{}{said},\"reversed\":{},\"tolerance\":{},\"loops\":[{}]}}",
        face.surface,
        face.reversed,
        number(face.tolerance),
        face.loops.iter().map(loop_text).collect::<Vec<_>>().join(","),
    )
}

fn loop_text(boundary: &Loop) -> String {
    let trims: Vec<String> = boundary.trims.iter().map(trim_text).collect();
    format!("\n{{\"outer\":{},\"trims\":[{}]}}", boundary.outer, trims.join(","))
}

fn trim_text(trim: &Trim) -> String {
    let knots: &KnotVector = &trim.knots;
    format!(
        "\n{{\"degree\":{},\"knots\":{},\"points\":{},\"weights\":{},\"reversed\":{},\"seam\":{},\"degenerate\":{},\
         \"edge\":{}{}}}",
        knots.degree(),
        numbers(knots.knots()),
        list(trim.points.iter().map(|p| numbers(&p.to_array()))),
        weights_text(trim.weights.as_deref()),
        trim.reversed,
        trim.seam,
        trim.degenerate,
        trim.edge.map_or_else(|| "null".to_owned(), |edge| edge.to_string()),
        tolerances_text(trim),
    )
}

/// The members of a trim's own tolerances, each after a comma; none where there are none.
fn tolerances_text(trim: &Trim) -> String {
    let edge = (trim.edge_tolerance != 0.0).then(|| format!(",\"edge_tolerance\":{}", number(trim.edge_tolerance)));
    let vertex = trim.vertex_tolerance.map(|t| format!(",\"vertex_tolerance\":{}", number(t)));
    edge.into_iter().chain(vertex).collect()
}
