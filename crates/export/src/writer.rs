//! What a writer is: a name, the extensions of its files, and what it makes of a document.

use crate::error::ExportError;
use crate::mesh::Facts;
use formats::Document;
use std::io::{self, Write};

/// What is asked of a writer beside the document.
#[derive(Clone, Copy)]
pub struct Asked<'a> {
    /// How far a triangle may be from its surface, model units; positive and finite.
    pub error: f64,
    /// Is told how many faces are done, each time that one is: long work says so.
    pub progress: &'a (dyn Fn(usize) + Sync),
}

/// What a file holds.
#[derive(Debug, Clone, PartialEq)]
pub struct Written {
    /// Faces of the model.
    pub faces: usize,
    /// What is known of the triangles; `None` where surfaces were written.
    pub mesh: Option<Facts>,
    /// What the file does not say as the document does, in words.
    pub notes: Vec<String>,
}

/// Writes the bytes of a file.
pub type Fill<'d> = Box<dyn FnOnce(&mut dyn Write) -> io::Result<()> + 'd>;

/// A file that is ready to be written.
pub struct Ready<'d> {
    /// What it will hold.
    pub written: Written,
    /// Writes its bytes.
    pub fill: Fill<'d>,
    /// A second file that it names.
    pub beside: Option<Beside<'d>>,
}

/// A file that stands in the folder of another, which names it.
pub struct Beside<'d> {
    /// Its name; no path.
    pub name: String,
    /// Writes its bytes.
    pub fill: Fill<'d>,
}

/// A format that documents are written in, with its writer in a file or folder of its own.
pub trait Writer: Sync {
    /// What people call it.
    fn name(&self) -> &'static str;

    /// The extensions of its files, in lower case, without a dot.
    fn extensions(&self) -> &'static [&'static str];

    /// Whether it writes triangles, so that the error counts.
    fn is_tessellated(&self) -> bool;

    /// Makes the file's content; nothing is written yet. `stem` is the file's name without its extension: what stands beside
    /// it bears the same.
    ///
    /// # Errors
    /// What of the document cannot be written, and [`ExportError::TooManyTriangles`].
    fn prepare<'d>(&self, stem: &str, document: &'d Document, asked: Asked) -> Result<Ready<'d>, ExportError>;
}
