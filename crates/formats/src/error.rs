//! What can be wrong with a model file, and where.

use crate::place::Place;
use nurbs::NurbsError;
use scene::{SceneError, escaped};
use std::fmt;

/// Why a file could not be read or a model could not be written: the file, the place in it, and the cause.
///
/// Printed as `file: place: cause`. Values quoted from the file are shortened to 80 characters, and escaped
/// ([`scene::escaped`]) as the path is.
#[derive(Debug)]
pub struct FormatError {
    /// The path as it was given; where a model is written, its name.
    pub file: String,
    /// Where in the file; boxed, so that results stay small.
    pub place: Box<Place>,
    /// What is wrong there.
    pub cause: Cause,
}

impl FormatError {
    pub(crate) fn new(file: &str, place: Place, cause: Cause) -> Self {
        Self { file: escaped(file), place: Box::new(place), cause }
    }
}

impl fmt::Display for FormatError {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Self { file, place, cause } = self;
        match (&**place, cause.continues_the_place()) {
            (Place::File, _) => write!(f, "{file}: {cause}"),
            (_, true) => write!(f, "{file}: {place} {cause}"),
            (_, false) => write!(f, "{file}: {place}: {cause}"),
        }
    }
}

impl std::error::Error for FormatError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match &self.cause {
            Cause::Io(cause) => Some(cause),
            Cause::Nurbs(cause) => Some(cause),
            Cause::Scene(cause) => Some(cause),
            _ => None,
        }
    }
}

/// What is wrong with a file at some place.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Cause {
    /// The operating system refused.
    #[error("{0}")]
    Io(std::io::Error),
    /// The path is a directory, a pipe or a device.
    #[error("not a regular file")]
    NotAFile,
    /// The file is larger than [`crate::MAX_FILE_BYTES`]; nothing was read.
    #[error("{bytes} bytes are more than the {limit} allowed")]
    TooLarge {
        /// Its size.
        bytes: u64,
        /// The limit.
        limit: u64,
    },
    /// A byte of a text is not UTF-8.
    #[error("is 0x{0:02x}, not UTF-8 text")]
    NotText(u8),
    /// Neither the extension nor the content is that of a known format.
    #[error("neither {known}: it starts \"{start}\"")]
    UnknownFormat {
        /// The known formats and how their files start.
        known: String,
        /// The first characters of the file.
        start: String,
    },
    /// The text breaks the grammar of its format.
    #[error("{message}{}", near_text(near))]
    Syntax {
        /// What is wrong.
        message: String,
        /// The word at that place; empty where the file ends.
        near: String,
    },
    /// A value is of the wrong kind, out of range, missing, or given twice: what was found, and what was expected.
    #[error("{0}")]
    Kind(String),
    /// A member has a value that is not allowed there.
    #[error("is {value}, where {expected} is needed")]
    Value {
        /// Its value.
        value: String,
        /// What is allowed.
        expected: &'static str,
    },
    /// A list has the wrong number of entries.
    #[error("has {found} entries where {reason} ask for {expected}")]
    Count {
        /// Number of entries.
        found: usize,
        /// Number of entries needed.
        expected: usize,
        /// The members that fix this number.
        reason: &'static str,
    },
    /// The numbers do not make a knot vector or a surface.
    #[error("{0}")]
    Nurbs(NurbsError),
    /// The surfaces and faces do not make a model.
    #[error("{0}")]
    Scene(SceneError),
    /// A word or line is not what it should be.
    #[error("found \"{found}\" where {expected} should be")]
    Found {
        /// The word or line found.
        found: String,
        /// What should be there.
        expected: String,
    },
    /// The file ends too early.
    #[error("the file ends where {0} should be")]
    Truncated(String),
}

impl Cause {
    /// Whether its text is the rest of a sentence that begins with the place.
    fn continues_the_place(&self) -> bool {
        matches!(self, Self::NotText(_) | Self::Value { .. } | Self::Count { .. })
    }
}

fn near_text(near: &str) -> String {
    if near.is_empty() { String::new() } else { format!(", near \"{near}\"") }
}

/// The longest quotation from a file in a message, in characters.
const LONGEST_QUOTE: usize = 80;

/// `text`, or its start and an ellipsis, made fit to print.
pub(crate) fn shorten(text: &str) -> String {
    match text.char_indices().nth(LONGEST_QUOTE) {
        Some((end, _)) => format!("{}…", escaped(&text[..end])),
        None => escaped(text),
    }
}
