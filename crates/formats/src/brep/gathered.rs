//! The faces of a file in their places, and the document that they make: what readers of boundary representations do alike.

use super::frame::Motion;
use super::source::Made;
use super::total::Total;
use crate::document::{Attributes, Document, Note, Unit};
use crate::error::{Cause, FormatError};
use crate::format::file_name;
use crate::place::Place;
use nurbs::Surface;
use scene::{Face, Model};
use std::collections::BTreeMap;

/// Faces as they are added, each with a surface of its own.
#[derive(Default)]
pub(crate) struct Gathered {
    surfaces: Vec<Surface>,
    /// With their numbers in the file.
    faces: Vec<(usize, Face)>,
    attributes: Vec<Attributes>,
    /// The model's number of each edge, by the instance that it is in and the reader's number.
    edges: BTreeMap<(usize, i64), i64>,
    total: Total,
}

impl Gathered {
    /// Adds a face where `motion` places it; `reversed` says that what holds it takes it the other way round. Faces share edges
    /// only within one `instance`.
    pub fn add(
        &mut self,
        number: u64,
        made: Made,
        (motion, reversed): (&Motion, bool),
        instance: usize,
        attributes: Attributes,
    ) {
        self.total.add(number, &made.found);
        let (surface, mut face) = made.placed(motion, reversed);
        face.surface = self.surfaces.len();
        for trim in face.loops.iter_mut().flat_map(|l| &mut l.trims) {
            let next = self.edges.len() as i64;
            trim.edge = trim.edge.map(|edge| *self.edges.entry((instance, edge)).or_insert(next));
        }
        self.surfaces.push(surface);
        self.attributes.push(attributes);
        self.faces.push((usize::try_from(number).unwrap_or(usize::MAX), face));
    }

    pub fn is_empty(&self) -> bool {
        self.faces.is_empty()
    }

    /// The document, with notes of what was found in all faces and of what the model says; `place` says where a face stands.
    ///
    /// # Errors
    /// Where the faces make no model.
    pub fn document(
        self,
        file: &str,
        unit: Option<Unit>,
        mut notes: Vec<Note>,
        place: impl Fn(u64) -> Place,
    ) -> Result<Document, FormatError> {
        notes.extend(self.total.notes(&place, unit.as_ref().map_or("model unit", |unit| &unit.name)));
        let model = Model::of_sound_faces(file_name(file), self.surfaces, self.faces, vec![])
            .map_err(|cause| FormatError::new(file, Place::File, Cause::Scene(cause)))?;
        notes.extend(model.notes().iter().map(|note| {
            let face = note.face().map(|face| face as u64);
            Note::of_model(face.map_or(Place::File, &place), note)
        }));
        let attributes = model.faces().iter().map(|face| self.attributes[face.surface].clone()).collect();
        Ok(Document { model, unit, attributes, notes })
    }
}
