//! What a format is: a name, how its files are known, and a reader.

use crate::document::Document;
use crate::error::{Cause, FormatError};
use crate::place::Place;

/// A format of model files, with its reader in a folder of its own.
pub trait Format: Sync {
    /// What people call it.
    fn name(&self) -> &'static str;

    /// The extensions of its files, in lower case, without a dot.
    fn extensions(&self) -> &'static [&'static str];

    /// How its files start, as the end of a sentence: `starts with '{'`.
    fn start(&self) -> &'static str;

    /// Whether a file that starts with `head`, its first bytes or all of them, is of this format.
    fn sniff(&self, head: &[u8]) -> bool;

    /// The kinds of entity that its reader knows, and how it takes each; none where the format has no such kinds.
    fn entities(&self) -> &'static [(&'static str, Support)] {
        &[]
    }

    /// Reads a whole file; `file` names it in messages, and its last component names a model without a name.
    ///
    /// Input is not trusted: memory stays within a constant times the size of the file.
    ///
    /// # Errors
    /// Where nothing of the file can be drawn. What else is wrong stands among [`Document::notes`].
    fn read(&self, bytes: &[u8], file: &str) -> Result<Document, FormatError>;
}

/// How a reader takes a kind of entity.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Support {
    /// Converted exactly, to rounding.
    Exact,
    /// Converted within a distance that is measured, and noted.
    Approximated,
    /// Read for what it says of others: structure, placement, units.
    Followed,
    /// Left out, with a note.
    LeftOut,
}

/// The bytes as text, without a byte order mark: for formats that are text in UTF-8.
///
/// # Errors
/// [`Cause::NotText`] with the first byte that is not.
pub(crate) fn text<'b>(bytes: &'b [u8], file: &str) -> Result<&'b str, FormatError> {
    match std::str::from_utf8(bytes) {
        Ok(text) => Ok(text.strip_prefix('\u{feff}').unwrap_or(text)),
        Err(error) => {
            let offset = error.valid_up_to();
            Err(FormatError::new(file, Place::Byte(offset), Cause::NotText(bytes[offset])))
        }
    }
}

/// The start of a text as text: what follows the last whole character of `head` is left away.
pub(crate) fn text_head(head: &[u8]) -> &str {
    let text = match std::str::from_utf8(head) {
        Ok(text) => text,
        Err(error) => std::str::from_utf8(&head[..error.valid_up_to()]).expect("valid up to there"),
    };
    text.strip_prefix('\u{feff}').unwrap_or(text)
}

/// The last component of a path.
pub(crate) fn file_name(file: &str) -> String {
    let name = std::path::Path::new(file).file_name();
    name.map_or_else(|| file.to_owned(), |name| name.to_string_lossy().into_owned())
}
