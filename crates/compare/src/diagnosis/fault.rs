//! Mistakes of a whole picture, by their names.

use serde::Serialize;
use std::fmt;

/// A component of a vector, as another one is stored in its place.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Stored {
    /// Which component: 0 for x, 1 for y, 2 for z.
    pub axis: usize,
    /// Whether its sign is changed.
    pub negated: bool,
}

impl fmt::Display for Stored {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{}{}", if self.negated { "−" } else { "" }, ["x", "y", "z"][self.axis])
    }
}

/// One mistake that a whole picture has.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "name", rename_all = "snake_case")]
pub enum Fault {
    /// What it shows lies beside where it belongs: right and down, pixels.
    Shifted {
        /// By how much.
        px: [f64; 2],
    },
    /// Another full vertical field of view than the camera's.
    FieldOfView {
        /// The one that it is drawn with, degrees.
        drawn_deg: f64,
        /// The camera's.
        asked_deg: f64,
        /// Whether the camera's was taken for the angle across the picture.
        across: bool,
    },
    /// Another height than the orthographic camera's, model units.
    Height {
        /// The one that it is drawn with.
        drawn: f64,
        /// The camera's.
        asked: f64,
    },
    /// Left for right.
    Mirrored,
    /// The first row is the lowest.
    RowsFlipped,
    /// Both of them.
    HalfTurned,
    /// The arrays hold column after column.
    Transposed,
    /// Normals point to the other side.
    NormalsFlipped,
    /// Normals by the camera's axes: right, above, toward the viewer.
    NormalsOfView {
        /// Whether the third points forward instead.
        forward: bool,
    },
    /// Components of normals stand in each other's places.
    NormalsSwapped {
        /// What stands in the place of x, y and z.
        stored: [Stored; 3],
    },
    /// Normals of the numerator's derivatives: the weights' own derivatives are missing.
    NormalsOfNumerator,
    /// Normals of 8 bits a component.
    NormalsOfEightBits,
    /// Positions went through the sRGB transfer function.
    PositionsEncoded,
    /// Positions by the camera's axes from its eye: right, above, toward the viewer.
    PositionsOfView,
    /// Numbers of 16 bits.
    HalfFloats {
        /// Which arrays.
        arrays: Vec<&'static str>,
    },
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Shifted { px: [x, y] } => write!(f, "the picture is shifted by ({x:+}, {y:+}) px, right and down"),
            Self::FieldOfView { drawn_deg, asked_deg, across: false } => {
                write!(f, "its field of view is {drawn_deg}°, not {asked_deg}°")
            }
            Self::FieldOfView { drawn_deg, asked_deg, across: true } => {
                write!(f, "its field of view is {drawn_deg}°: the {asked_deg}° are meant up the picture, not across it")
            }
            Self::Height { drawn, asked } => write!(f, "its orthographic height is {drawn}, not {asked}"),
            Self::Mirrored => write!(f, "the picture is mirrored, left for right"),
            Self::RowsFlipped => write!(f, "rows are flipped: the lowest is stored first"),
            Self::HalfTurned => write!(f, "rows and columns are both flipped: the picture is upside down"),
            Self::Transposed => write!(f, "arrays are transposed: they hold column after column"),
            Self::NormalsFlipped => write!(f, "normals are flipped: they point to the other side"),
            Self::NormalsOfView { forward: false } => write!(f, "normals are in view space, not in the world's"),
            Self::NormalsOfView { forward: true } => {
                write!(f, "normals are in view space with z forward, not in the world's")
            }
            Self::NormalsSwapped { stored: [x, y, z] } => {
                write!(f, "axes of normals are swapped: ({x}, {y}, {z}) is stored for (x, y, z)")
            }
            Self::NormalsOfNumerator => {
                write!(
                    f,
                    "normals lack the quotient rule: they are of the numerator, before it is divided by the weight"
                )
            }
            Self::NormalsOfEightBits => write!(f, "normals are stored in 8 bits a component"),
            Self::PositionsEncoded => write!(f, "positions are sRGB-encoded"),
            Self::PositionsOfView => write!(f, "positions are in view space, not in the world's"),
            Self::HalfFloats { arrays } => write!(f, "half floats (16 bits) store {}", arrays.join(", ")),
        }
    }
}
