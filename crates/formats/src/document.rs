//! What a reader makes of a file: a model, what the file says of its faces, and what is to be known of how it was read.

use crate::place::Place;
use scene::Model;
use std::fmt;
use std::sync::Arc;

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
    /// What the file says of each face beyond its shape, in the order of [`scene::FaceId`].
    ///
    /// Which faces share an edge is not here but in the model itself: trims with the same [`scene::Trim::edge`] run along one.
    pub attributes: Vec<Attributes>,
    /// What of the file is not drawn as it stands there, and what was found by approximation.
    pub notes: Vec<Note>,
}

impl Document {
    /// A file without units, names, colours and layers, of which is to be known what the model itself notes.
    pub fn of_model(model: Model) -> Self {
        let notes = model.notes().iter().map(|note| Note::of_model(Place::File, note)).collect();
        let attributes = vec![Attributes::default(); model.faces().len()];
        Self { model, unit: None, attributes, notes }
    }
}

/// What a file says of a face beyond its shape.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Attributes {
    /// The face's name, else that of what it is a part of: a body, an object, a product. Shared, as faces of one part have one.
    pub name: Option<Arc<str>>,
    /// The face's colour, else that of what it is a part of.
    pub colour: Option<Colour>,
    /// The layers that the file puts the face on, else those of what it is a part of, in the file's order.
    ///
    /// A layer is called by its name: in Rhino by its path, as `Body::Panels`; in IGES by its level's number where that has no name.
    pub layers: Layers,
    /// The surface as the file has it; the model has a spline in its place.
    pub surface: SurfaceKind,
}

/// The most layers of one face that are kept; beyond them a note says so.
pub(crate) const MOST_LAYERS: usize = 64;

/// The most characters of a name that are kept. A file may give one long name to very many faces.
const MOST_NAME: usize = 1000;

/// A name as it is kept: without blanks about it, and with `…` in place of what is beyond the thousandth character; `None` for none.
pub(crate) fn name(text: &str) -> Option<Arc<str>> {
    let text = text.trim();
    let kept = text.char_indices().nth(MOST_NAME).map(|(end, _)| format!("{}…", &text[..end]));
    (!text.is_empty()).then(|| kept.map_or_else(|| text.into(), Arc::from))
}

/// Names of layers, shared by all that is on them.
pub type Layers = Arc<[Arc<str>]>;

/// A colour in sRGB.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Colour(
    /// Red, green and blue.
    pub [u8; 3],
);

impl Colour {
    /// From parts of 0 to 1; what is beyond is clamped. `None` where a part is no number.
    pub fn of_parts(parts: [f64; 3]) -> Option<Self> {
        let is_number = parts.iter().all(|part| !part.is_nan());
        is_number.then(|| Self(parts.map(|part| (255.0 * part.clamp(0.0, 1.0)).round() as u8)))
    }

    /// From `#rrggbb`, as it is displayed, in digits of either case; `None` where the text is none.
    pub fn of_text(text: &str) -> Option<Self> {
        let digits =
            text.strip_prefix('#').filter(|rest| rest.len() == 6 && rest.bytes().all(|b| b.is_ascii_hexdigit()))?;
        let part = |k: usize| u8::from_str_radix(&digits[2 * k..2 * k + 2], 16).expect("two hexadecimal digits");
        Some(Self([0, 1, 2].map(part)))
    }
}

impl fmt::Display for Colour {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let [red, green, blue] = self.0;
        write!(f, "#{red:02x}{green:02x}{blue:02x}")
    }
}

/// A kind of surface, as files have them.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum SurfaceKind {
    /// A plane.
    Plane,
    /// A circular cylinder.
    Cylinder,
    /// A circular cone.
    Cone,
    /// A sphere.
    Sphere,
    /// A torus, or a part of one that meets itself.
    Torus,
    /// A curve turned about an axis.
    Revolution,
    /// A curve moved along a line.
    Extrusion,
    /// A curve moved along a curve.
    Sum,
    /// At a distance from another surface.
    Offset,
    /// A spline or Bézier surface, rational or not.
    #[default]
    Spline,
}

impl SurfaceKind {
    /// Every kind.
    pub const ALL: [Self; 10] = [
        Self::Plane,
        Self::Cylinder,
        Self::Cone,
        Self::Sphere,
        Self::Torus,
        Self::Revolution,
        Self::Extrusion,
        Self::Sum,
        Self::Offset,
        Self::Spline,
    ];
}

impl fmt::Display for SurfaceKind {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.pad(match self {
            Self::Plane => "plane",
            Self::Cylinder => "cylinder",
            Self::Cone => "cone",
            Self::Sphere => "sphere",
            Self::Torus => "torus",
            Self::Revolution => "revolution",
            Self::Extrusion => "extrusion",
            Self::Sum => "sum",
            Self::Offset => "offset",
            Self::Spline => "b-spline",
        })
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

impl fmt::Display for NoteKind {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.pad(match self {
            Self::LeftOut => "left out",
            Self::Healed => "healed",
            Self::Approximated => "approximated",
        })
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_is_cut_where_it_is_too_long() {
        assert_eq!((name(" \t"), name(" Träger ").as_deref()), (None, Some("Träger")));
        let (whole, long) = ("ä".repeat(MOST_NAME), "ä".repeat(MOST_NAME + 1));
        assert_eq!(name(&whole).as_deref(), Some(whole.as_str()));
        assert_eq!(name(&long), Some(format!("{whole}…").into()));
    }
}
