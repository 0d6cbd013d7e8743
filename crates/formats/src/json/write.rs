//! Writing: one surface's row of control points a line, so that files compare well line by line.

use super::check_face;
use super::raw::{FORMAT, VERSION};
use crate::error::FormatError;
use crate::member::Member;
use nurbs::{Direction, KnotVector, Surface};
use scene::{Face, Loop, Model, Trim};
use std::fmt::Display;

/// The model as JSON text, ending in a newline. [`super::parse`] returns an equal model, bit for bit.
///
/// # Errors
/// [`Cause::Value`](crate::Cause::Value) and [`Cause::Count`](crate::Cause::Count), with the model's name for the file, where a face's tolerance or
/// trim curves hold what could not be read back; models that were read never do.
pub fn write(model: &Model) -> Result<String, FormatError> {
    let place = Member::document(model.name()).key("faces");
    for (i, face) in model.faces().iter().enumerate() {
        check_face(face, &place.index(i))?;
    }
    let surfaces = model.surfaces().iter().map(surface_text).collect::<Vec<_>>().join(",\n");
    let faces = model.faces().iter().map(face_text).collect::<Vec<_>>().join(",\n");
    Ok(format!(
        "{{\"format\":\"{FORMAT}\",\"version\":{VERSION},\"name\":{name},\n\"surfaces\":[\n{surfaces}\n],\n\
         \"faces\":[\n{faces}\n]}}\n",
        name = serde_json::Value::from(model.name()),
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

fn face_text(face: &Face) -> String {
    format!(
        "{{\"surface\":{},\"reversed\":{},\"tolerance\":{},\"loops\":[{}]}}",
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
