//! What a file says of a face beyond its shape: its name, its colour, its layers, and the kind of its surface.

use super::assembly::Placed;
use super::entities::{Entities, Entity};
use super::fault::{Fault, fault};
use super::levels::Levels;
use super::value::words;
use crate::document::{Attributes, Colour, SurfaceKind};
use std::collections::BTreeMap;
use std::sync::Arc;

/// The colours that a directory entry may name by number, from 1: black, red, green, blue, yellow, magenta, cyan, white.
const COLOURS: [[u8; 3]; 8] =
    [[0, 0, 0], [255, 0, 0], [0, 255, 0], [0, 0, 255], [255, 255, 0], [255, 0, 255], [0, 255, 255], [255, 255, 255]];

/// How far a colour's part may be outside its range, of 1: files print it with six digits or more.
const PRINTED: f64 = 1e-6;

/// The form of a property (406) that is a name.
const NAME: i16 = 15;

/// A face's own looks, else those of its surface, else those of what holds it. Of colours that make no sense is `told`.
pub(super) fn looks(
    entities: &Entities,
    placed: &Placed,
    levels: &mut Levels,
    told: &mut BTreeMap<u32, String>,
) -> Attributes {
    let surface = basis(entities, placed.number);
    let those = || [Some(placed.number), surface, placed.holder].into_iter().flatten();
    Attributes {
        name: those().find_map(|number| name(entities, number)),
        colour: those().find_map(|number| colour(entities, number, told)),
        layers: those()
            .map(|number| levels.layers(entities, number))
            .find(|layers| !layers.is_empty())
            .unwrap_or_default(),
        surface: kind(entities, surface.unwrap_or(placed.number)),
    }
}

/// The surface that a face names.
fn basis(entities: &Entities, face: u32) -> Option<u32> {
    let at = match entities.entry(face)?.kind {
        143 => 2,
        144 | 510 => 1,
        _ => return None,
    };
    entities.get(face).ok()?.parameters().pointer(at).ok()
}

fn kind(entities: &Entities, surface: u32) -> SurfaceKind {
    match entities.entry(surface).map_or(0, |entry| entry.kind) {
        108 | 190 => SurfaceKind::Plane,
        120 => SurfaceKind::Revolution,
        122 => SurfaceKind::Extrusion,
        140 => SurfaceKind::Offset,
        192 => SurfaceKind::Cylinder,
        194 => SurfaceKind::Cone,
        196 => SurfaceKind::Sphere,
        198 => SurfaceKind::Torus,
        _ => SurfaceKind::Spline,
    }
}

/// The colour that the directory entry names: by number, or by a pointer to a definition (314), whose parts are per cent.
fn colour(entities: &Entities, number: u32, told: &mut BTreeMap<u32, String>) -> Option<Colour> {
    let own = entities.entry(number)?.colour;
    if own < 0 {
        let definition = own.unsigned_abs();
        let parts =
            defined(entities, definition).map_err(|fault| told.insert(fault.number, fault.why + ": no colour")).ok()?;
        if !parts.iter().all(|part| (-PRINTED..=1.0 + PRINTED).contains(part)) {
            told.insert(definition, "its parts are not from 0 to 100: the nearest that are count".to_owned());
        }
        return Colour::of_parts(parts);
    }
    let known = COLOURS.get(usize::try_from(own).ok()?.checked_sub(1)?);
    if known.is_none() {
        told.insert(number, format!("it has colour {own}, which there is not: no colour"));
    }
    known.map(|&parts| Colour(parts))
}

/// The parts of the colour of a definition, from 0 to 1.
fn defined(entities: &Entities, number: u32) -> Result<[f64; 3], Fault> {
    let entity = entities.get(number)?;
    if entity.entry.kind != 314 {
        return Err(fault(number, "it is no definition of a colour (314)"));
    }
    let parts = entity.parameters().numbers(1, 3)?;
    Ok([parts[0], parts[1], parts[2]].map(|part| part / 100.0))
}

/// The name that a property gives, or a definition itself, else the label of the directory entry.
fn name(entities: &Entities, number: u32) -> Option<Arc<str>> {
    let entry = entities.entry(number)?;
    let given = entities.get(number).ok().and_then(|entity| match entry.kind {
        308 => entity.parameters().text(2),
        _ => property(entities, &entity),
    });
    given.or_else(|| words(&entry.label))
}

/// The name among the properties of an entity: their pointers follow those of associations, behind its own parameters.
fn property(entities: &Entities, entity: &Entity) -> Option<Arc<str>> {
    let own = entity.parameters();
    let counted = |at: usize, each: usize| own.count(at, each).ok().map(|count| at + 1 + each * count);
    let associations = match entity.entry.kind {
        143 => counted(3, 1)?,
        402 => counted(1, 1)?,
        144 => 5 + own.whole(3).ok()?,
        186 => counted(3, 2)?,
        510 => 4 + own.whole(2).ok()?,
        514 => counted(1, 2)?,
        _ => return None,
    };
    let first = counted(associations, 1)?;
    let count = own.count(first, 1).ok()?;
    own.pointers(first + 1, count).ok()?.into_iter().find_map(|property| {
        entities.entry(property).filter(|entry| entry.kind == 406 && entry.form == NAME)?;
        entities.get(property).ok()?.parameters().text(2)
    })
}
