//! Files in, faces out: readers of surface models.
//!
//! [`read`] opens a file of any known format; each format is a module that turns text into a checked
//! [`scene::Model`]. Input is not trusted: whatever the bytes, the answer is a model or a [`FormatError`] that names
//! the file, the place and the value; memory stays within a constant times the size of the file, which is at most
//! [`MAX_FILE_BYTES`].

pub mod bpt;
mod error;
pub mod json;
mod open;
mod place;
mod wrap;

pub use error::FormatError;
pub use open::{MAX_FILE_BYTES, read};
