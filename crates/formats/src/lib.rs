//! Files in, faces out: readers of surface models.
//!
//! [`open()`] reads a file of any format of the one list, [`FORMATS`]. Each format is a folder with a [`Format`]: bytes in, a
//! [`Document`] out, which is a checked [`scene::Model`] and what is to be known of how it was read. Input is not trusted:
//! whatever the bytes, the answer is a document or a [`FormatError`] that names the file, the place and the cause; memory
//! stays within a constant times the size of the file, which is at most [`MAX_FILE_BYTES`].
//!
//! # Examples
//! ```
//! let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../testdata/models/teapot.json");
//! let document = formats::open(file)?;
//! assert_eq!(document.model.faces().len(), 32);
//! assert!(formats::open("no-such-file.step").is_err_and(|error| error.to_string().contains("no-such-file.step")));
//! # Ok::<(), formats::FormatError>(())
//! ```

pub mod bpt;
mod brep;
mod document;
mod error;
mod format;
mod iges;
pub mod json;
mod member;
mod obj;
mod open;
mod place;
mod rhino;
mod spline;
mod step;
mod wrap;

pub use document::{Attributes, Colour, Document, Layers, Note, NoteKind, SurfaceKind, Unit};
pub use error::{Cause, FormatError};
pub use format::{Format, Support};
pub use open::{FORMATS, MAX_FILE_BYTES, open, read};
pub use place::Place;
