//! The faces of a file in their places, and the document that they make: what readers of boundary representations do alike.

use super::frame::Motion;
use super::source::Made;
use super::total::Total;
use crate::document::{Attributes, Document, Note, NoteKind, Unit};
use crate::error::{Cause, FormatError};
use crate::format::file_name;
use crate::place::Place;
use nurbs::{Hull, NurbsError, Surface};
use scene::{Face, Model};
use std::collections::BTreeMap;

/// How many control points all faces have at most, those of a face that stands at several places counted at each: so many,
/// and one more for so many bytes of the file. A few bytes may place a large face again and again.
const POINTS: usize = 1 << 22;
const BYTES_A_POINT: usize = 4;

/// A tolerance above this share of the model's size is told: it may hide what a face is.
const COARSE: f64 = 0.01;

/// Why a face is left out that is one too many.
pub(crate) const TOO_MANY: &str = "it and all faces after it are more than are shown";

/// Faces as they are added, each with a surface of its own.
pub(crate) struct Gathered {
    /// How many more control points there may be.
    room: Option<usize>,
    surfaces: Vec<Surface>,
    /// With their numbers in the file.
    faces: Vec<(usize, Face)>,
    attributes: Vec<Attributes>,
    /// The model's number of each edge, by the instance that it is in and the reader's number.
    edges: BTreeMap<(usize, i64), i64>,
    total: Total,
}

impl Gathered {
    /// None yet, of a file of so many bytes.
    pub fn new(bytes: usize) -> Self {
        Self {
            room: Some(POINTS + bytes / BYTES_A_POINT),
            surfaces: vec![],
            faces: vec![],
            attributes: vec![],
            edges: BTreeMap::new(),
            total: Total::default(),
        }
    }

    /// Whether no more faces may be added.
    pub fn is_full(&self) -> bool {
        self.room.is_none()
    }

    /// Adds a face where `motion` places it; `reversed` says that what holds it takes it the other way round. Faces share edges
    /// only within one `instance`.
    ///
    /// # Errors
    /// Those of [`Made::placed`]; then nothing is added.
    pub fn add(
        &mut self,
        number: u64,
        made: Made,
        (motion, reversed): (&Motion, bool),
        instance: usize,
        attributes: Attributes,
    ) -> Result<(), NurbsError> {
        let found = made.found;
        let (surface, mut face) = made.placed(motion, reversed)?;
        self.total.add(number, &found);
        self.room = self.room.and_then(|room| room.checked_sub(surface.points().len()));
        face.surface = self.surfaces.len();
        for trim in face.loops.iter_mut().flat_map(|l| &mut l.trims) {
            let next = self.edges.len() as i64;
            trim.edge = trim.edge.map(|edge| *self.edges.entry((instance, edge)).or_insert(next));
        }
        self.surfaces.push(surface);
        self.attributes.push(attributes);
        self.faces.push((usize::try_from(number).unwrap_or(usize::MAX), face));
        Ok(())
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
        let length = unit.as_ref().map_or("model unit", |unit| &unit.name);
        notes.extend(self.total.notes(&place, length));
        let tolerance = self.faces.iter().map(|(_, face)| face.tolerance).fold(0.0, f64::max);
        let size = self.surfaces.iter().map(Surface::hull).reduce(Hull::union).map_or(0.0, |hull| hull.diagonal());
        if COARSE * size < tolerance {
            let text = format!(
                "points up to {tolerance:.1e} {length} apart count as one, which is more than {COARSE} of the model's size, {size:.1e}"
            );
            notes.push(Note { kind: NoteKind::Approximated, place: Place::File, text });
        }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::brep::source::Found;
    use glam::DVec3;
    use nurbs::KnotVector;

    /// A face of four control points, in a file that has room for ten: the third one is too many, and the last.
    #[test]
    fn a_large_face_is_not_placed_without_end() {
        let line = KnotVector::new(1, vec![0.0, 0.0, 1.0, 1.0]).unwrap();
        let points = [[0.0, 0.0], [0.0, 1.0], [1.0, 0.0], [1.0, 1.0]].map(|[x, y]| DVec3::new(x, y, 0.0));
        let surface = Surface::new(line.clone(), line, points.to_vec(), None).unwrap();
        let made = Made { surface, face: Face::whole(0), found: Found::default() };
        let mut gathered = Gathered { room: Some(10), ..Gathered::new(0) };
        let mut placed = 0;
        while !gathered.is_full() {
            gathered.add(1, made.clone(), (&Motion::IDENTITY, false), 0, Attributes::default()).unwrap();
            placed += 1;
        }
        assert_eq!(placed, 3);
        assert_eq!(Gathered::new(1 << 20).room, Some((1 << 22) + (1 << 18)));
    }
}
