//! STEP files (ISO 10303-21) of AP203, AP214 and AP242: their faces, with the file's own edges for trims.
//!
//! The text is read by [`p21`]; instances are looked up when something needs them, so that a bad one costs the face that
//! it is part of and nothing else. [`assembly`] says which faces are shown, and where; [`topology`] and [`geometry`] hand
//! each to the boundary representation that all readers feed (`brep`).
//!
//! Coordinates stay in the unit of the file's first root representation, which the document names: scaling would round
//! each of them, and the file's uncertainty is stated in its own unit. Parts in another unit are scaled to that.

mod assembly;
mod fault;
mod geometry;
mod layers;
mod p21;
mod said;
mod spline;
mod structure;
mod styles;
mod support;
mod text;
mod topology;
mod units;
mod value;

use crate::brep::effort::Effort;
use crate::brep::face::make;
use crate::brep::gathered::{Gathered, TOO_MANY};
use crate::brep::off::Off;
use crate::brep::once::Once;
use crate::brep::source::Made;
use crate::document::{Attributes, Document, Note, NoteKind, SurfaceKind};
use crate::error::{Cause, FormatError};
use crate::format::{Format, Support, text_head};
use crate::place::Place;
use assembly::{Assembly, Placed};
use fault::{Fault, fault};
use geometry::Geometry;
use p21::Instances;
use std::cell::{Cell, RefCell};
use std::collections::{BTreeMap, BTreeSet};
use structure::{RELATIONS, REPRESENTATIONS};
use styles::STYLES;
use units::Units;

/// How many control points and edges are read at most, those that are named again counted again: so many, and more for each
/// byte. Real files come to a hundredth of that.
const WORK: usize = 1 << 21;
const WORK_A_BYTE: usize = 4;

/// The format.
pub struct Step;

impl Format for Step {
    fn name(&self) -> &'static str {
        "STEP"
    }

    fn extensions(&self) -> &'static [&'static str] {
        &["step", "stp", "p21"]
    }

    fn start(&self) -> &'static str {
        "starts with ISO-10303-21"
    }

    fn sniff(&self, head: &[u8]) -> bool {
        text_head(head).trim_start().starts_with("ISO-10303-21")
    }

    fn entities(&self) -> &'static [(&'static str, Support)] {
        support::ENTITIES
    }

    fn read(&self, bytes: &[u8], file: &str) -> Result<Document, FormatError> {
        read(bytes, file)
    }
}

fn read(bytes: &[u8], file: &str) -> Result<Document, FormatError> {
    let instances = Instances::new(bytes);
    if instances.len() == 0 {
        return Err(FormatError::new(file, Place::File, Cause::Kind("it has no instances: #1 = …".to_owned())));
    }
    let keywords = REPRESENTATIONS.into_iter().chain(RELATIONS).chain(STYLES).chain(["ADVANCED_FACE"]);
    let of = instances.of(&keywords.collect::<Vec<&'static str>>());
    let mut assembly = Assembly::new(&instances, &of);
    let mut notes: Vec<Note> = vec![];
    if let Some((count, first)) = assembly.lost {
        let text = format!("{count} faces that no representation shows are drawn where they stand");
        notes.push(Note { kind: NoteKind::Healed, place: place(&instances, first), text });
    }
    let work = Cell::new(WORK + WORK_A_BYTE * bytes.len());
    let (effort, turned) = (Effort::new(bytes.len()), RefCell::default());
    let mut reader =
        Reader { instances: &instances, contexts: BTreeMap::new(), work: &work, effort: &effort, turned: &turned };
    let key = |placed: &Placed| (placed.number, placed.context);
    let mut made = Once::new(assembly.placed.iter().map(key));
    let mut gathered = Gathered::new(bytes.len());
    let mut kinds: BTreeMap<u64, SurfaceKind> = BTreeMap::new();
    let mut faults = std::mem::take(&mut assembly.faults);
    for placed in &assembly.placed {
        if gathered.is_full() {
            faults.push(fault(placed.number, TOO_MANY));
            break;
        }
        match made.get(key(placed), || reader.face(placed)) {
            Ok(made) => {
                let kind = || geometry::kind(&instances, placed.number);
                let surface = *kinds.entry(placed.number).or_insert_with(kind);
                let attributes = Attributes { surface, ..placed.attributes.clone() };
                let at = (&placed.motion, placed.reversed);
                if let Err(cause) = gathered.add(placed.number, made, at, placed.instance, attributes) {
                    faults.push(fault(placed.number, cause.to_string()));
                }
            }
            Err(fault) => faults.push(fault),
        }
    }
    let units = reader.units(assembly.context).clone();
    let contexts = std::mem::take(&mut reader.contexts);
    drop(reader);
    if let Some(first) = turned.borrow().first() {
        let text = format!(
            "{} placements, this one the first, have a second direction that has no length, or is that of their axis: they are \
             read as if they had none",
            turned.borrow().len()
        );
        notes.push(Note { kind: NoteKind::Healed, place: place(&instances, *first), text });
    }
    let of_units = contexts.values().flat_map(|units| &units.faults);
    notes.extend(of_units.chain(&assembly.healed).map(|fault| Note {
        kind: NoteKind::Healed,
        place: place(&instances, fault.number),
        text: fault.why.clone(),
    }));
    notes.extend(instances.faults.iter().map(|(line, why)| Note {
        kind: NoteKind::Healed,
        place: Place::Line(*line),
        text: format!("the text makes no sense: {why}"),
    }));
    if 0 < instances.more_faults {
        let text = format!("{} more places of the text make no sense", instances.more_faults);
        notes.push(Note { kind: NoteKind::Healed, place: Place::File, text });
    }
    notes.extend(faults.iter().map(|fault| Note {
        kind: NoteKind::LeftOut,
        place: place(&instances, fault.number),
        text: format!("left out: {}", fault.why),
    }));
    if gathered.is_empty() {
        let why = faults.first().map_or_else(
            || "it shows no faces".to_owned(),
            |fault| format!("no face can be drawn; the first: {}: {}", place(&instances, fault.number), fault.why),
        );
        return Err(FormatError::new(file, Place::File, Cause::Kind(why)));
    }
    gathered.document(file, units.length, notes, |face| place(&instances, face))
}

fn place(instances: &Instances, number: u64) -> Place {
    let first = || instances.get(number).map_or("", |entity| entity.keyword());
    let keyword = Some(instances.keyword(number)).filter(|keyword| !keyword.is_empty()).unwrap_or_else(first);
    let keyword = scene::escaped(keyword);
    Place::Entity { number, line: instances.line(number), keyword }
}

/// Makes faces.
struct Reader<'f, 'b> {
    instances: &'f Instances<'b>,
    work: &'f Cell<usize>,
    effort: &'f Effort,
    turned: &'f RefCell<BTreeSet<u64>>,
    contexts: BTreeMap<Option<u64>, Units>,
}

impl Reader<'_, '_> {
    fn units(&mut self, context: Option<u64>) -> &Units {
        self.contexts.entry(context).or_insert_with(|| Units::of_context(self.instances, context))
    }

    /// The face, in the coordinates of its representation.
    fn face(&mut self, placed: &Placed) -> Result<Made, Fault> {
        let (instances, work, effort, turned) = (self.instances, self.work, self.effort, self.turned);
        let units = self.units(placed.context);
        let off = Cell::new(Off::default());
        let geometry =
            Geometry { instances, angle: units.angle, tolerance: units.uncertainty, off: &off, work, effort, turned };
        let is_face = matches!(instances.keyword(placed.number), "ADVANCED_FACE" | "FACE_SURFACE");
        let source = if is_face {
            topology::face(&geometry, placed.number)
        } else {
            topology::surface(&geometry, placed.number)
        };
        // What is wrong with a part of it is told with the part's own place, and the face's number.
        source
            .map_err(|cause| match cause.number == placed.number {
                true => cause,
                false => fault(placed.number, format!("{}: {}", place(instances, cause.number), cause.why)),
            })
            .and_then(|source| make(&source).map_err(|cause| fault(placed.number, cause.to_string())))
    }
}
