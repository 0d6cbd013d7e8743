//! What a file says beyond its shapes: the unit, and of each face its name, its colour, its layers and the kind of its surface.

use super::raw::{RawFace, RawUnit};
use crate::document::{Attributes, Colour, SurfaceKind, Unit};
use crate::error::FormatError;
use crate::member::Member;
use std::sync::Arc;

/// The unit of a document.
pub(super) fn unit(raw: RawUnit, place: &Member) -> Result<Unit, FormatError> {
    let RawUnit { name, millimetres } = raw;
    if !(0.0 < millimetres && millimetres.is_finite()) {
        return Err(place.key("millimetres").value(millimetres, "a finite number above 0"));
    }
    Ok(Unit { name, millimetres })
}

/// What is said of a face; taken out of it.
pub(super) fn attributes(raw: &mut RawFace, place: &Member) -> Result<Attributes, FormatError> {
    let colour = raw.colour.take().map(|text| {
        Colour::of_text(&text).ok_or_else(|| place.key("colour").value(text, "\"#rrggbb\", six hexadecimal digits"))
    });
    let kind = raw.kind.take().map(|text| {
        let found = SurfaceKind::ALL.into_iter().find(|kind| kind.to_string() == text);
        found.ok_or_else(|| place.key("kind").value(text, "a kind of surface, as \"plane\" or \"b-spline\""))
    });
    let name = raw.name.take().map(Arc::from);
    let layers = raw.layers.take().unwrap_or_default().into_iter().map(Arc::from).collect();
    Ok(Attributes { name, colour: colour.transpose()?, layers, surface: kind.transpose()?.unwrap_or_default() })
}

/// The document's member for the unit, after a comma; nothing where there is none.
pub(super) fn unit_text(unit: Option<&Unit>) -> String {
    let text =
        |unit: &Unit| format!(",\n\"unit\":{{\"name\":{},\"millimetres\":{:?}}}", quoted(&unit.name), unit.millimetres);
    unit.map_or_else(String::new, text)
}

/// A face's members for what is said of it, each after a comma; nothing where nothing is said.
pub(super) fn attributes_text(attributes: &Attributes) -> String {
    let Attributes { name, colour, layers, surface } = attributes;
    let name = name.as_ref().map(|name| format!(",\"name\":{}", quoted(name)));
    let colour = colour.map(|colour| format!(",\"colour\":\"{colour}\""));
    let kind = (*surface != SurfaceKind::default()).then(|| format!(",\"kind\":\"{surface}\""));
    let layers = (!layers.is_empty()).then(|| {
        let names: Vec<String> = layers.iter().map(|name| quoted(name)).collect();
        format!(",\"layers\":[{}]", names.join(","))
    });
    name.into_iter().chain(colour).chain(layers).chain(kind).collect()
}

fn quoted(text: &str) -> String {
    serde_json::Value::from(text).to_string()
}
