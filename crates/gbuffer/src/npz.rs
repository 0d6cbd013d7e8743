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

use crate::npy::Header;
use crate::{GBuffer, GBufferError, Hit, Meta};
use array::{CHUNK_ELEMENTS, shape};
use files::ReadError;
use glam::{DVec2, DVec3};
use meta::MetaText;
use scene::Viewport;
use std::fs::File;
use std::io::{self, BufReader, Cursor, Seek, Write};
use std::path::Path;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

/// The largest file that is read, bytes: 16 GiB, more than the largest picture takes.
const MAX_BYTES: u64 = 1 << 34;

/// `status` where nothing is hit.
const NO_STATUS: u8 = 255;

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
        archive.pixels("hit", "|u1", |hit| [u8::from(hit.is_some())])?;
        archive.pixels("face", "<i4", |hit| hit.map_or(-1, |h| h.face.0 as i32).to_le_bytes())?;
        archive.numbers("u", |hit| hit.uv.x)?;
        archive.numbers("v", |hit| hit.uv.y)?;
        if self.has_local() {
            archive.spans()?;
            archive.vectors("local", |hit| hit.local.map_or(DVec2::NAN, |local| local.uv).to_array())?;
        }
        archive.numbers("t", |hit| hit.t)?;
        archive.vectors("pos", |hit| hit.position.to_array())?;
        archive.vectors("normal", |hit| hit.normal.unit().unwrap_or(DVec3::NAN).to_array())?;
        archive.pixels("status", "|u1", |hit| [hit.map_or(NO_STATUS, |h| h.normal.status() as u8)])?;
        archive.numbers("k1", |hit| hit.curvature.map_or(f64::NAN, |k| k.k1))?;
        archive.numbers("k2", |hit| hit.curvature.map_or(f64::NAN, |k| k.k2))?;
        if self.has_edges() {
            archive.vectors("edge", |hit| hit.edge.unwrap_or(DVec2::NAN).to_array())?;
        }
        archive.undecided()?;
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

    /// An array of `N` bytes a pixel.
    fn write<const N: usize>(
        &mut self,
        array: &str,
        descr: &str,
        values: impl Iterator<Item = [u8; N]>,
    ) -> io::Result<()> {
        let viewport = self.buffer.viewport();
        self.start(array, Header::new(descr, shape(viewport, None)), (viewport.pixels() * N) as u64)?;
        let mut chunk = Vec::with_capacity(N * CHUNK_ELEMENTS);
        for value in values {
            chunk.extend(value);
            if chunk.len() == N * CHUNK_ELEMENTS {
                self.zip.write_all(&chunk)?;
                chunk.clear();
            }
        }
        self.zip.write_all(&chunk)
    }

    fn pixels<const N: usize>(
        &mut self,
        array: &str,
        descr: &str,
        value: impl Fn(Option<&Hit>) -> [u8; N],
    ) -> io::Result<()> {
        self.write(array, descr, self.buffer.pixels().map(value))
    }

    fn numbers(&mut self, array: &str, value: impl Fn(&Hit) -> f64) -> io::Result<()> {
        self.pixels(array, "<f8", |hit| hit.map_or(f64::NAN, &value).to_le_bytes())
    }

    fn vectors<const N: usize>(&mut self, array: &str, value: impl Fn(&Hit) -> [f64; N]) -> io::Result<()> {
        let viewport = self.buffer.viewport();
        let bytes = (viewport.pixels() * N * size_of::<f64>()) as u64;
        self.start(array, Header::new("<f8", shape(viewport, Some(N as u64))), bytes)?;
        let full = N * size_of::<f64>() * CHUNK_ELEMENTS;
        let mut chunk = Vec::with_capacity(full);
        for hit in self.buffer.pixels() {
            chunk.extend(hit.map_or([f64::NAN; N], &value).into_iter().flat_map(f64::to_le_bytes));
            if chunk.len() == full {
                self.zip.write_all(&chunk)?;
                chunk.clear();
            }
        }
        self.zip.write_all(&chunk)
    }

    fn spans(&mut self) -> io::Result<()> {
        let viewport = self.buffer.viewport();
        let bytes: Vec<u8> = self
            .buffer
            .pixels()
            .flat_map(|hit| hit.and_then(|hit| hit.local).map_or([-1; 2], |local| local.span.map(|k| k as i32)))
            .flat_map(i32::to_le_bytes)
            .collect();
        self.start("span", Header::new("<i4", shape(viewport, Some(2))), bytes.len() as u64)?;
        self.zip.write_all(&bytes)
    }

    fn undecided(&mut self) -> io::Result<()> {
        let viewport = self.buffer.viewport();
        let (width, buffer) = (viewport.width(), self.buffer);
        let values = (0..viewport.pixels()).map(|i| [u8::from(buffer.is_undecided(i % width, i / width))]);
        self.write("undecided", "|u1", values)
    }

    fn meta(&mut self) -> io::Result<()> {
        let text = serde_json::to_string(&MetaText::new(self.buffer)).map_err(io::Error::from)?;
        let units: Vec<u8> = text.chars().flat_map(|c| u32::from(c).to_le_bytes()).collect();
        self.start("meta", Header::new(format!("<U{}", units.len() / 4), vec![]), units.len() as u64)?;
        self.zip.write_all(&units)
    }
}
