//! IGES files (version 5.3, and those before it): their faces, with the file's own curves for trims.
//!
//! Lines are sorted into sections by [`cards`]; [`global`] says what numbers mean, and [`entities`] finds an entity when
//! something needs it, so that a bad one costs the face that it is part of and nothing else. [`assembly`] says which faces are
//! shown, and where; [`topology`] and [`sheet`] hand each to the boundary representation that all readers feed (`brep`).
//!
//! Coordinates stay in the file's unit, which the document names. [`looks`] has names (406 form 15) and colours (314), [`levels`]
//! layers.

mod assembly;
mod cards;
mod conic;
mod curve;
mod edges;
mod entities;
mod fault;
mod geometry;
mod global;
mod levels;
mod looks;
mod ruled;
mod sheet;
mod spline;
mod support;
mod topology;
mod value;

use crate::brep::effort::Effort;
use crate::brep::face::make;
use crate::brep::frame::Motion;
use crate::brep::gathered::{Gathered, TOO_MANY};
use crate::brep::off::Off;
use crate::brep::once::Once;
use crate::brep::source::Made;
use crate::document::{Document, Note, NoteKind};
use crate::error::{Cause, FormatError, shorten};
use crate::format::{Format, Support};
use crate::place::Place;
use assembly::Assembly;
use cards::{Cards, NoCards};
use entities::Entities;
use fault::{Fault, fault};
use geometry::Geometry;
use global::Global;
use levels::Levels;
use std::cell::Cell;
use std::collections::BTreeMap;
use topology::Faces;

/// How many control points and edges are made at most, those that are named again counted again: so many, and more for each
/// byte. Real files come to a hundredth of that.
const WORK: usize = 1 << 21;
const WORK_A_BYTE: usize = 4;

/// The format.
pub struct Iges;

impl Format for Iges {
    fn name(&self) -> &'static str {
        "IGES"
    }

    fn extensions(&self) -> &'static [&'static str] {
        &["igs", "iges"]
    }

    fn start(&self) -> &'static str {
        "has an S in column 73"
    }

    fn sniff(&self, head: &[u8]) -> bool {
        cards::form(head) != Err(NoCards::Unknown)
    }

    fn entities(&self) -> &'static [(&'static str, Support)] {
        support::ENTITIES
    }

    fn read(&self, bytes: &[u8], file: &str) -> Result<Document, FormatError> {
        read(bytes, file)
    }
}

fn read(bytes: &[u8], file: &str) -> Result<Document, FormatError> {
    let cards = Cards::new(bytes).map_err(|why| {
        let line = bytes.split(|b| matches!(b, b'\n' | b'\r')).next().unwrap_or_default();
        let cause = match why {
            NoCards::Compressed => {
                Cause::Kind("IGES in compressed form is not read: write it in fixed form".to_owned())
            }
            NoCards::Binary => Cause::Kind("IGES in binary form is not read: write it in fixed form".to_owned()),
            NoCards::Unknown => {
                let found = shorten(&String::from_utf8_lossy(&line[..line.len().min(1000)]));
                Cause::Found { found, expected: "a line with an S in column 73".to_owned() }
            }
        };
        FormatError::new(file, Place::Line(1), cause)
    })?;
    let global = Global::new(&cards);
    let mut damage = cards.damage.clone();
    damage.extend(global.damage.clone());
    let entities = Entities::new(cards, global.delimiters);
    damage.extend(entities.damage.clone());
    let work = Cell::new(WORK + WORK_A_BYTE * bytes.len());
    let off = Cell::new(Off::default());
    let effort = Effort::new(bytes.len());
    let geometry =
        Geometry { entities: &entities, tolerance: global.resolution, off: &off, work: &work, effort: &effort };
    let mut assembly = Assembly::new(&geometry);
    let mut reader = Faces::new(&geometry);
    let mut made = Once::new(assembly.placed.iter().map(|placed| placed.number));
    let mut gathered = Gathered::new(bytes.len());
    let mut faults = std::mem::take(&mut assembly.faults);
    let mut levels = Levels::new(&entities);
    let mut colours: BTreeMap<u32, String> = BTreeMap::new();
    let mut remarks: BTreeMap<u32, String> = BTreeMap::new();
    for placed in &assembly.placed {
        if gathered.is_full() {
            faults.push(fault(placed.number, TOO_MANY));
            break;
        }
        match made.get(placed.number, || face(&mut reader, placed.number, &entities)) {
            Ok(Own { made, motion, remark }) => {
                remarks.extend(remark.map(|remark| (placed.number, remark)));
                let at = (&placed.motion.after(&motion), placed.reversed);
                let attributes = looks::looks(&entities, placed, &mut levels, &mut colours);
                if let Err(cause) = gathered.add(u64::from(placed.number), made, at, placed.instance, attributes) {
                    faults.push(fault(placed.number, cause.to_string()));
                }
            }
            Err(fault) => faults.push(fault),
        }
    }
    faults.append(&mut levels.faults);
    let place = |number: u32| place(&entities, number);
    let note = |kind: NoteKind, place: Place, text: String| Note { kind, place, text };
    let mut notes: Vec<Note> =
        damage.into_iter().map(|(line, why)| note(NoteKind::Healed, Place::Line(line), why)).collect();
    let left_out = |fault: &Fault| note(NoteKind::LeftOut, place(fault.number), format!("left out: {}", fault.why));
    notes.extend(faults.iter().map(left_out));
    notes.extend(colours.into_iter().map(|(number, why)| note(NoteKind::Healed, place(number), why)));
    if let Some(first) = assembly.hidden.first() {
        let text = format!("left out: {} entities that the file hides, this one the first", assembly.hidden.len());
        notes.push(note(NoteKind::LeftOut, place(*first), text));
    }
    if let Some(first) = assembly.orphans.first() {
        let text = format!(
            "{} surfaces or faces, this one the first, say that they are parts of something, which nothing names: drawn as they \
             stand",
            assembly.orphans.len()
        );
        notes.push(note(NoteKind::Healed, place(*first), text));
    }
    notes.extend(remarks.into_iter().map(|(face, text)| note(NoteKind::Approximated, place(face), text)));
    if gathered.is_empty() {
        let why = match (faults.first(), assembly.hidden.len()) {
            (Some(fault), _) => format!("no face can be drawn; the first: {}: {}", place(fault.number), fault.why),
            (None, 0) => "it shows no faces".to_owned(),
            (None, hidden) => format!("it hides all that it shows: {hidden} entities"),
        };
        let damage = notes.iter().find(|note| note.kind == NoteKind::Healed).map(|note| format!("; {note}"));
        return Err(FormatError::new(file, Place::File, Cause::Kind(why + &damage.unwrap_or_default())));
    }
    gathered.document(file, global.unit, notes, |face| place(u32::try_from(face).unwrap_or(u32::MAX)))
}

/// A directory entry as a place: its line, its number, its type.
fn place(entities: &Entities, number: u32) -> Place {
    let entry = entities.entry(number);
    Place::Entity {
        number: u64::from(number),
        line: entry.map_or(0, |entry| entry.line as usize),
        keyword: entry.map_or_else(|| "without an entry".to_owned(), |entry| format!("type {}", entry.kind)),
    }
}

/// A face in its own coordinates, and how its own matrix moves it.
#[derive(Debug, Clone)]
struct Own {
    made: Made,
    motion: Motion,
    remark: Option<String>,
}

/// The face of a number.
fn face(faces: &mut Faces, number: u32, entities: &Entities) -> Result<Own, Fault> {
    // What is wrong with a part of it is told with the part's own place, and the face's number.
    let read = faces.read(number).map_err(|cause| match cause.number == number {
        true => cause,
        false => fault(number, format!("{}: {}", place(entities, cause.number), cause.why)),
    })?;
    let made = make(&read.source).map_err(|cause| fault(number, cause.to_string()))?;
    Ok(Own { made, motion: read.motion, remark: read.remark })
}
