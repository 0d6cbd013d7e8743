//! What can be wrong with a model file.

use nurbs::NurbsError;
use scene::{SceneError, escaped};

/// Why a file could not be read or a model could not be written.
///
/// `file` is the path as it was given; where a model is written, its name. `path` names a member of a JSON document
/// (`surfaces[3].knots_u`). Values quoted from the file are shortened to 80 characters, and escaped ([`scene::escaped`])
/// as the path is.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FormatError {
    /// The operating system refused.
    #[error("{file}: {cause}")]
    Io {
        /// The file.
        file: String,
        /// What the operating system says.
        cause: std::io::Error,
    },
    /// The path is a directory, a pipe or a device.
    #[error("{file}: not a regular file")]
    NotAFile {
        /// The path.
        file: String,
    },
    /// The file is larger than [`crate::MAX_FILE_BYTES`]; nothing was read.
    #[error("{file}: {bytes} bytes are more than the {limit} allowed")]
    TooLarge {
        /// The file.
        file: String,
        /// Its size.
        bytes: u64,
        /// The limit.
        limit: u64,
    },
    /// The file is not UTF-8 text.
    #[error("{file}: byte {offset} is 0x{value:02x}, not UTF-8 text")]
    NotText {
        /// The file.
        file: String,
        /// Offset of the first byte that is not text, from 0.
        offset: usize,
        /// That byte.
        value: u8,
    },
    /// Neither the extension nor the content is that of a known format.
    #[error("{file}: neither JSON, which starts with '{{', nor .bpt, which starts with a count: it starts \"{start}\"")]
    UnknownFormat {
        /// The file.
        file: String,
        /// The first characters of the file.
        start: String,
    },
    /// The text is not JSON.
    #[error("{file}: line {line}, column {column}, in {path}: {message}{}", near_text(near))]
    Syntax {
        /// The file.
        file: String,
        /// Line, from 1.
        line: usize,
        /// Column in bytes, from 1.
        column: usize,
        /// The innermost member in which reading stopped.
        path: String,
        /// What is wrong.
        message: String,
        /// The word at that place; empty where the file ends.
        near: String,
    },
    /// A JSON value is of the wrong kind, out of range, missing, or given twice.
    #[error("{file}: line {line}, column {column}: {path}: {message}")]
    Kind {
        /// The file.
        file: String,
        /// Line, from 1.
        line: usize,
        /// Column in bytes, from 1.
        column: usize,
        /// The member.
        path: String,
        /// What was found, and what was expected.
        message: String,
    },
    /// A member has a value that is not allowed there.
    #[error("{file}: {path} is {value}, where {expected} is needed")]
    Value {
        /// The file.
        file: String,
        /// The member.
        path: String,
        /// Its value.
        value: String,
        /// What is allowed.
        expected: &'static str,
    },
    /// A list has the wrong number of entries.
    #[error("{file}: {path} has {found} entries where {reason} ask for {expected}")]
    Count {
        /// The file.
        file: String,
        /// The list.
        path: String,
        /// Number of entries.
        found: usize,
        /// Number of entries needed.
        expected: usize,
        /// The members that fix this number.
        reason: &'static str,
    },
    /// The numbers do not make a knot vector or a surface.
    #[error("{file}: {path}: {cause}")]
    Nurbs {
        /// The file.
        file: String,
        /// The member.
        path: String,
        /// What is wrong.
        cause: NurbsError,
    },
    /// The surfaces and faces do not make a model.
    #[error("{file}: {path}: {cause}")]
    Scene {
        /// The file.
        file: String,
        /// The member.
        path: String,
        /// What is wrong.
        cause: SceneError,
    },
    /// A line of a .bpt file is not what it should be.
    #[error("{file}: line {line}: found \"{found}\" where {expected} should be")]
    Line {
        /// The file.
        file: String,
        /// Line, from 1.
        line: usize,
        /// The word or line found.
        found: String,
        /// What should be there.
        expected: String,
    },
    /// A .bpt file ends too early.
    #[error("{file}: line {line}: the file ends where {expected} should be")]
    Truncated {
        /// The file.
        file: String,
        /// Number of the last line.
        line: usize,
        /// What should follow.
        expected: String,
    },
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
