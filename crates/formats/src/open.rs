//! Opening a file: its kind and size are checked before it is read, then the format is chosen from the one list.

use crate::bpt::Bpt;
use crate::document::Document;
use crate::error::{Cause, FormatError, shorten};
use crate::format::Format;
use crate::iges::Iges;
use crate::json::Json;
use crate::obj::Obj;
use crate::place::Place;
use crate::rhino::Rhino;
use crate::step::Step;
use files::ReadError;
use scene::Model;
use std::path::Path;

/// The largest file that is opened, in bytes: 1 GiB.
pub const MAX_FILE_BYTES: u64 = 1 << 30;

/// All formats. A file whose extension is none of theirs is read by the first that knows its content.
pub static FORMATS: &[&dyn Format] = &[&Json, &Bpt, &Step, &Iges, &Rhino, &Obj];

/// The start of a file that is shown to [`Format::sniff`], bytes.
const HEAD: usize = 4096;

/// Reads a file of any of [`FORMATS`]: by its extension, in upper or lower case, or else by its content.
///
/// Pipes and devices are refused, since they may never end.
///
/// # Errors
/// [`Cause::Io`], [`Cause::NotAFile`], [`Cause::TooLarge`], [`Cause::UnknownFormat`], and what the format's own reader says.
pub fn open(path: impl AsRef<Path>) -> Result<Document, FormatError> {
    let path = path.as_ref();
    let name = path.display().to_string();
    let bytes = read_bytes(path, &name)?;
    let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase());
    let head = &bytes[..bytes.len().min(HEAD)];
    let by_extension = |format: &&&dyn Format| extension.as_deref().is_some_and(|e| format.extensions().contains(&e));
    let format = FORMATS.iter().find(by_extension).or_else(|| FORMATS.iter().find(|format| format.sniff(head)));
    match format {
        Some(format) => format.read(&bytes, &name),
        None => {
            let known = FORMATS.iter().map(|f| format!("{}, which {}", f.name(), f.start())).collect::<Vec<_>>();
            let text = String::from_utf8_lossy(head);
            let start = shorten(text.lines().next().unwrap_or_default());
            Err(FormatError::new(&name, Place::File, Cause::UnknownFormat { known: known.join(", nor "), start }))
        }
    }
}

/// Reads a file as [`open`] does, for its model alone.
///
/// # Errors
/// Those of [`open`].
pub fn read(path: impl AsRef<Path>) -> Result<Model, FormatError> {
    Ok(open(path)?.model)
}

fn read_bytes(path: &Path, name: &str) -> Result<Vec<u8>, FormatError> {
    files::read(path, MAX_FILE_BYTES).map_err(|error| {
        let cause = match error {
            ReadError::Io(cause) => Cause::Io(cause),
            ReadError::NotAFile => Cause::NotAFile,
            ReadError::TooLarge { bytes, limit } => Cause::TooLarge { bytes, limit },
        };
        FormatError::new(name, Place::File, cause)
    })
}
