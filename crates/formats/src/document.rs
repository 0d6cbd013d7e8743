//! What a reader makes of a file: a model, and what is to be known of how it was read.

use crate::place::Place;
use scene::Model;
use std::fmt;

/// A file as it was read.
#[derive(Debug, Clone, PartialEq)]
pub struct Document {
    /// What is drawn.
    pub model: Model,
    /// The unit of the model's coordinates; `None` where the file names none.
    ///
    /// Coordinates are those of the file: scaling them would round every one, and the file's tolerances are stated in
    /// its own unit.
    pub unit: Option<Unit>,
    /// What of the file is not drawn as it stands there, and what was found by approximation.
    pub notes: Vec<Note>,
}

impl Document {
    /// A file without units, of which is to be known what the model itself notes.
    pub fn of_model(model: Model) -> Self {
        let notes = model.notes().iter().map(|note| Note::of_model(Place::File, note)).collect();
        Self { model, unit: None, notes }
    }
}

/// A unit of length.
#[derive(Debug, Clone, PartialEq)]
pub struct Unit {
    /// As the file spells it, in lower case: `millimetre`, `inch`.
    pub name: String,
    /// How many millimetres long it is.
    pub millimetres: f64,
}

/// What happened to a part of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum NoteKind {
    /// It is not drawn.
    LeftOut,
    /// It was mended, and is drawn otherwise than it stands in the file.
    Healed,
    /// It is drawn within a distance that the note states.
    Approximated,
}

impl NoteKind {
    /// Whether something is lost or changed: what `--strict` refuses.
    pub fn is_loss(self) -> bool {
        self != Self::Approximated
    }
}

/// Something to be known of how a file was read.
#[derive(Debug, Clone, PartialEq)]
pub struct Note {
    /// What happened.
    pub kind: NoteKind,
    /// To which part of the file.
    pub place: Place,
    /// The reason, in words.
    pub text: String,
}

impl Note {
    /// What a model says of itself, about the part of the file at `place`.
    pub fn of_model(place: Place, note: &scene::Note) -> Self {
        let kind = match note {
            scene::Note::FaceLeftOut { .. } => NoteKind::LeftOut,
            _ => NoteKind::Healed,
        };
        Self { kind, place, text: note.to_string() }
    }
}

impl fmt::Display for Note {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self.place {
            Place::File => write!(f, "{}", self.text),
            ref place => write!(f, "{place}: {}", self.text),
        }
    }
}
