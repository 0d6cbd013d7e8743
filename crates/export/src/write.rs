//! The one list of writers, and the way of a document into a file.

use crate::error::ExportError;
use crate::gltf::Gltf;
use crate::json::Json;
use crate::obj::Obj;
use crate::step::Step;
use crate::stl::Stl;
use crate::writer::{Asked, Beside, Writer, Written};
use formats::Document;
use std::path::Path;

/// All writers, each chosen by its extensions.
pub static WRITERS: &[&dyn Writer] = &[&Json, &Step, &Obj, &Stl, &Gltf];

/// The writer of a path, by its extension, in upper or lower case.
///
/// # Errors
/// [`ExportError::UnknownExtension`], which lists those that there are.
pub fn writer_of(path: &Path) -> Result<&'static dyn Writer, ExportError> {
    let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
    let found = WRITERS.iter().find(|writer| writer.extensions().contains(&extension.as_str()));
    found.copied().ok_or_else(|| {
        let known = WRITERS.iter().flat_map(|writer| writer.extensions()).map(|e| format!(".{e}"));
        ExportError::UnknownExtension { extension, known: known.collect::<Vec<_>>().join(", ") }
    })
}

/// The bytes of a document in a format. What a file would name beside it, as materials of an OBJ file, is left out, and a note
/// says so.
///
/// # Errors
/// [`ExportError::Error`], those of the writer, and [`ExportError::Io`].
pub fn exported(writer: &dyn Writer, document: &Document, asked: Asked) -> Result<(Written, Vec<u8>), ExportError> {
    is_legal(asked)?;
    let ready = writer.prepare("model", document, asked)?;
    let mut bytes = vec![];
    (ready.fill)(&mut bytes)?;
    let mut written = ready.written;
    written.notes.extend(ready.beside.map(|beside| format!("{} is named, and not written", beside.name)));
    Ok((written, bytes))
}

fn is_legal(asked: Asked) -> Result<(), ExportError> {
    match 0.0 < asked.error && asked.error.is_finite() {
        true => Ok(()),
        false => Err(ExportError::Error(asked.error)),
    }
}

/// Writes a document to a file of the format that its extension names, whole or not at all. What it names is written first, so
/// that a file that is there is complete.
///
/// # Errors
/// [`ExportError::UnknownExtension`], [`ExportError::Error`], those of the writer, and [`ExportError::Io`].
pub fn export(path: &Path, document: &Document, asked: Asked) -> Result<Written, ExportError> {
    let writer = writer_of(path)?;
    is_legal(asked)?;
    let stem = path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
    let ready = writer.prepare(&stem, document, asked)?;
    if let Some(Beside { name, fill }) = ready.beside {
        files::write(&path.with_file_name(name), |out| fill(out))?;
    }
    files::write(path, |out| (ready.fill)(out))?;
    Ok(ready.written)
}
