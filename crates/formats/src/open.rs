//! Opening a file: its kind and size are checked before it is read, then the format is chosen.

use crate::error::shorten;
use crate::{FormatError, bpt, json};
use files::ReadError;
use scene::{Model, escaped};
use std::path::Path;

/// The largest file that is opened, in bytes: 1 GiB.
pub const MAX_FILE_BYTES: u64 = 1 << 30;

/// Reads a model from a file.
///
/// `.json` is read by [`json::parse`], `.bpt` by [`bpt::parse`] (in upper or lower case); any other file by its
/// content: `{` begins JSON, a first line that is a whole number begins patches. A byte order mark is skipped.
/// Pipes and devices are refused, since they may never end.
///
/// # Errors
/// [`FormatError::Io`], [`FormatError::NotAFile`], [`FormatError::TooLarge`], [`FormatError::NotText`],
/// [`FormatError::UnknownFormat`], and what the format's own reader says.
pub fn read(path: impl AsRef<Path>) -> Result<Model, FormatError> {
    let path = path.as_ref();
    let name = path.display().to_string();
    let file = escaped(&name);
    let text = read_text(path, &file)?;
    let text = text.strip_prefix('\u{feff}').unwrap_or(&text);
    let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase());
    match extension.as_deref() {
        Some("json") => json::parse(text, &name),
        Some("bpt") => bpt::parse(text, &name),
        _ if text.trim_start().starts_with('{') => json::parse(text, &name),
        _ if text.lines().map(str::trim).find(|l| !l.is_empty()).is_some_and(|l| l.parse::<usize>().is_ok()) => {
            bpt::parse(text, &name)
        }
        _ => Err(FormatError::UnknownFormat { file, start: shorten(text.lines().next().unwrap_or_default()) }),
    }
}

fn read_text(path: &Path, file: &str) -> Result<String, FormatError> {
    let file = || file.to_owned();
    let bytes = files::read(path, MAX_FILE_BYTES).map_err(|error| match error {
        ReadError::Io(cause) => FormatError::Io { file: file(), cause },
        ReadError::NotAFile => FormatError::NotAFile { file: file() },
        ReadError::TooLarge { bytes, limit } => FormatError::TooLarge { file: file(), bytes, limit },
    })?;
    String::from_utf8(bytes).map_err(|error| {
        let offset = error.utf8_error().valid_up_to();
        FormatError::NotText { file: file(), offset, value: error.as_bytes()[offset] }
    })
}
