//! Rhino's files, `.3dm`: openNURBS archives of versions 3 to 8, all of whose surfaces and trims are exact rational splines.
//!
//! 1. [`archive`] gives chunks and numbers, [`tables`] the unit, the layers, the blocks and the objects, with what these
//!    say of themselves ([`attributes`], [`material`]).
//! 2. An object becomes a [`body::Body`]: a [`brep`], an [`extrusion`], or a surface alone ([`sheet`]).
//! 3. Curves are in [`curve`]. Where a surface's own parameter is an angle, [`fit`] takes trims to the rational one.
//! 4. [`assembly`] puts bodies in their places, those of blocks wherever a reference places them.
//!
//! What Rhino would not show is not drawn, and noted: objects that are hidden or on a hidden layer, and those on a page. Meshes,
//! points, curves and other classes are noted. Checksums, user data and cached meshes are read over without a note; so are
//! blocks that no reference places. An object that cannot be read costs itself; a face that cannot be made costs itself.
//!
//! The layout of all classes follows openNURBS (McNeel, MIT-like licence); the code is ours.

mod archive;
mod assembly;
mod attributes;
mod body;
mod brep;
mod class;
mod curve;
mod extrusion;
mod fit;
mod material;
mod sheet;
mod tables;

use crate::document::Document;
use crate::error::{Cause, FormatError, shorten};
use crate::format::Format;
use crate::place::Place;
use archive::Cursor;
use tables::Tables;

/// How an archive begins; its version follows in eight characters, padded with blanks.
const MAGIC: &[u8] = b"3D Geometry File Format ";

/// Bytes before the first chunk.
const HEAD: usize = 32;

/// The format.
pub struct Rhino;

impl Format for Rhino {
    fn name(&self) -> &'static str {
        "3DM"
    }

    fn extensions(&self) -> &'static [&'static str] {
        &["3dm"]
    }

    fn start(&self) -> &'static str {
        "starts with \"3D Geometry File Format\""
    }

    fn sniff(&self, head: &[u8]) -> bool {
        head.starts_with(MAGIC)
    }

    /// # Errors
    /// [`Cause::Found`] with the byte where the head is not that of an archive we read; [`Cause::Kind`] where nothing in it can be
    /// drawn, and [`Cause::Scene`] where no face has a region.
    fn read(&self, bytes: &[u8], file: &str) -> Result<Document, FormatError> {
        let fail = |at: usize, found: &[u8], expected: &str| {
            let found = shorten(&String::from_utf8_lossy(found));
            FormatError::new(file, Place::Byte(at), Cause::Found { found, expected: expected.into() })
        };
        if !self.sniff(bytes) {
            return Err(fail(0, &bytes[..bytes.len().min(MAGIC.len())], "\"3D Geometry File Format\""));
        }
        let version = &bytes[MAGIC.len()..bytes.len().min(HEAD)];
        let number = std::str::from_utf8(version).ok().and_then(|text| text.trim().parse::<u32>().ok());
        let length_bytes = match number {
            Some(3..=5) => 4,
            Some(50..=89) => 8,
            _ => return Err(fail(MAGIC.len(), version, "the version of an archive, 3, 4 or 50 to 89,")),
        };
        let tables = Tables::read(Cursor::new(bytes, HEAD, length_bytes));
        assembly::document(tables, file)
    }
}
