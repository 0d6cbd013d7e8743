//! G-buffers in files: NumPy's `.npz`, a zip archive of one array a member.
//!
//! `numpy.load` opens what is written here, and what `numpy.savez` or `numpy.savez_compressed` wrote is read here, if
//! it has the arrays below, H × W from the top left and in C order; `docs/gbuffer.md` tells a foreign renderer's author
//! the same at length:
//!
//! | array | type | value | where nothing is hit | where the array is absent |
//! | --- | --- | --- | --- | --- |
//! | `hit` | u8 | 1 where the pixel sees a point, else 0 | 0 | `face` is not −1 |
//! | `face` | i32 | number of the face | −1 | refused |
//! | `u`, `v` | f64 | parameters in the surface's own knot domain | NaN | refused |
//! | `span` | i32, H × W × 2 | knot spans in u and v, counted from 0 among those that are not empty | −1 | no local parameters |
//! | `local` | f64, H × W × 2 | u and v across those spans, 0 … 1 | NaN | absent with `span` |
//! | `t` | f64 | distance along the pixel's unit ray, model units | NaN | computed from `pos` and `meta`'s camera |
//! | `pos` | f64, H × W × 3 | the point, world coordinates | NaN | refused |
//! | `normal` | f64, H × W × 3 | unit normal; NaN where its status is undefined | NaN | refused |
//! | `status` | u8 | [`nurbs::NormalStatus`]: 0 regular, 1 limit, 2 undefined | 255 | undefined where `normal` is all NaN, else regular |
//! | `k1`, `k2` | f64 | principal curvatures, 1 / model unit; NaN where there are none | NaN | both: none |
//! | `edge` | f64, H × W × 2 | offset to the nearest trim edge of the face, pixels, right and down; NaN where none is within 1 | NaN | not asked for |
//! | `undecided` | u8 | 1 where the renderer could not decide, else 0 | 0 or 1 | 0 |
//! | `meta` | one text, `<U…` | a JSON object, see [`Meta`]; `json.loads(str(z["meta"]))` | | refused |
//!
//! Read are also `<f4` for `<f8`, and `|u1`, `|b1`, `|i1`, `<u2`, `<i2`, `<u4`, `<i4`, `<i8` for one another, as long as
//! the value fits; `meta` may be bytes (`|S…`, or one dimension of `|u1` or `|i1`; UTF-8). Where nothing is hit nothing else but `undecided` is looked at.
//! Any other entry is refused, so that a slip in a name does not pass for an absent array.
//! Whether a value is plausible (a normal of unit length, a point on the surface) is not judged here: that is the
//! comparer's work, and a file with wrong values must reach it.
//!
//! The zip reader is the `zip` crate; array headers are read by `npy`, as the `npyz` crate takes memory for as long a
//! header as a file claims to have and overflows on the product of a shape.

mod array;
mod element;
mod meta;
mod read;

use crate::columns::{Column, Pixel};
use crate::npy::Header;
use crate::{GBuffer, GBufferError, Hit, Meta};
use array::{CHUNK_ELEMENTS, shape};
use files::ReadError;
use meta::MetaText;
use scene::Viewport;
use std::fs::File;
use std::io::{self, BufReader, Cursor, Seek, Write};
use std::path::Path;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

/// The largest file that is read, bytes: 16 GiB, more than the largest picture takes.
const MAX_BYTES: u64 = 1 << 34;

/// Bytes of an entry from which on the zip64 form is written: 32-bit sizes end at 2³² − 1, and deflate may add a little.
const ZIP64_FROM: u64 = 0xf000_0000;

/// Deflate's effort. Digits of f64 hardly compress; more effort gains little and costs much.
const DEFLATE_LEVEL: i64 = 1;

impl GBuffer {
    /// Writes the buffer to a file, replacing what is there.
    ///
    /// The bytes depend on the buffer alone: times are fixed, the order of arrays too. Values that are not finite in a
    /// hit are written as they are; [`Self::read_npz`] then refuses the file.
    ///
    /// # Errors
    /// [`GBufferError::Io`], [`GBufferError::FaceTooLarge`]. What was there then stays.
    pub fn write_npz(&self, path: impl AsRef<Path>) -> Result<(), GBufferError> {
        let path = path.as_ref();
        self.check_faces()?;
        let io = |source| GBufferError::Io { path: path.to_owned(), source };
        files::write(path, |writer| self.write_archive(writer).map(|_| ())).map_err(io)
    }

    /// The bytes that [`Self::write_npz`] writes.
    ///
    /// # Errors
    /// [`GBufferError::FaceTooLarge`].
    pub fn npz_bytes(&self) -> Result<Vec<u8>, GBufferError> {
        self.check_faces()?;
        let cursor = self.write_archive(Cursor::new(vec![])).expect("memory takes all that is written");
        Ok(cursor.into_inner())
    }

    /// Reads a file of the form described in this module.
    ///
    /// Memory is that of the buffer it gives. A file can ask for no more than its own length lets it hold, which may be a
    /// thousand times that length: [`Self::read_npz_meta`] is for what can be refused without. Pipes and devices are
    /// refused, since they may never end.
    ///
    /// # Errors
    /// Any of the reading variants of [`GBufferError`], naming file, array and value.
    pub fn read_npz(path: impl AsRef<Path>) -> Result<Self, GBufferError> {
        let path = path.as_ref();
        read::archive(BufReader::new(open(path)?), path)
    }

    /// Reads bytes of the same form; `name` stands for the file's in messages.
    ///
    /// # Errors
    /// As [`Self::read_npz`].
    pub fn from_npz_bytes(bytes: &[u8], name: &str) -> Result<Self, GBufferError> {
        read::archive(Cursor::new(bytes), Path::new(name))
    }

    /// `meta` as files hold it: a JSON object.
    pub fn meta_text(&self) -> String {
        serde_json::to_string(&MetaText::new(self)).expect("names and numbers are JSON")
    }

    /// The facts of a file and the picture's size, without its arrays: memory is that of `meta`.
    ///
    /// # Errors
    /// As [`Self::read_npz`], but for values of arrays.
    pub fn read_npz_meta(path: impl AsRef<Path>) -> Result<(Meta, Viewport), GBufferError> {
        let path = path.as_ref();
        read::facts(BufReader::new(open(path)?), path)
    }

    fn check_faces(&self) -> Result<(), GBufferError> {
        let too_large = |hit: &&Hit| i32::try_from(hit.face.0).is_err();
        match self.pixels().flatten().find(too_large) {
            Some(hit) => Err(GBufferError::FaceTooLarge { face: hit.face.0 }),
            None => Ok(()),
        }
    }

    fn write_archive<W: Write + Seek>(&self, writer: W) -> io::Result<W> {
        let mut archive = Archive { zip: ZipWriter::new(writer), buffer: self };
        for (array, column) in self.columns() {
            match column {
                Column::Byte(value) => archive.pixels(array, "|u1", value, |x| [x])?,
                Column::Integer(value) => archive.pixels(array, "<i4", value, i32::to_le_bytes)?,
                Column::Integers(value) => archive.vectors(array, "<i4", value, i32::to_le_bytes)?,
                Column::Number(value) => archive.pixels(array, "<f8", value, f64::to_le_bytes)?,
                Column::Pair(value) => archive.vectors(array, "<f8", value, f64::to_le_bytes)?,
                Column::Triple(value) => archive.vectors(array, "<f8", value, f64::to_le_bytes)?,
            }
        }
        archive.meta()?;
        Ok(archive.zip.finish()?)
    }
}

fn open(path: &Path) -> Result<File, GBufferError> {
    files::open(path, MAX_BYTES).map_err(|error| GBufferError::Io {
        path: path.to_owned(),
        source: match error {
            ReadError::Io(source) => source,
            other => io::Error::other(other),
        },
    })
}

/// A zip archive in the making.
struct Archive<'a, W: Write + Seek> {
    zip: ZipWriter<W>,
    buffer: &'a GBuffer,
}

impl<W: Write + Seek> Archive<'_, W> {
    fn start(&mut self, array: &str, header: Header, bytes: u64) -> io::Result<()> {
        let options = SimpleFileOptions::default()
            .compression_method(CompressionMethod::Deflated)
            .compression_level(Some(DEFLATE_LEVEL))
            .last_modified_time(DateTime::default())
            .large_file(bytes >= ZIP64_FROM);
        self.zip.start_file(format!("{array}.npy"), options)?;
        self.zip.write_all(&header.to_bytes())
    }

    /// An array of one element a pixel.
    fn pixels<T, const B: usize>(
        &mut self,
        array: &str,
        descr: &str,
        value: fn(Pixel) -> T,
        bytes: fn(T) -> [u8; B],
    ) -> io::Result<()> {
        let values = self.buffer.values(value).map(|x| [x]);
        self.write(array, descr, None, values, bytes)
    }

    /// An array of several elements a pixel.
    fn vectors<T, const N: usize, const B: usize>(
        &mut self,
        array: &str,
        descr: &str,
        value: fn(Pixel) -> [T; N],
        bytes: fn(T) -> [u8; B],
    ) -> io::Result<()> {
        let values = self.buffer.values(value);
        self.write(array, descr, Some(N as u64), values, bytes)
    }

    fn write<T, const N: usize, const B: usize>(
        &mut self,
        array: &str,
        descr: &str,
        components: Option<u64>,
        values: impl Iterator<Item = [T; N]>,
        bytes: fn(T) -> [u8; B],
    ) -> io::Result<()> {
        let viewport = self.buffer.viewport();
        self.start(array, Header::new(descr, shape(viewport, components)), (viewport.pixels() * N * B) as u64)?;
        let full = N * B * CHUNK_ELEMENTS;
        let mut chunk = Vec::with_capacity(full);
        for value in values {
            chunk.extend(value.into_iter().flat_map(bytes));
            if chunk.len() == full {
                self.zip.write_all(&chunk)?;
                chunk.clear();
            }
        }
        self.zip.write_all(&chunk)
    }

    fn meta(&mut self) -> io::Result<()> {
        let text = self.buffer.meta_text();
        let units: Vec<u8> = text.chars().flat_map(|c| u32::from(c).to_le_bytes()).collect();
        self.start("meta", Header::new(format!("<U{}", units.len() / 4), vec![]), units.len() as u64)?;
        self.zip.write_all(&units)
    }
}
