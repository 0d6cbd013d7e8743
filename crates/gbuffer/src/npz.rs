//! G-buffers in files: NumPy's `.npz`, a zip archive of one array a member.
//!
//! `numpy.load` opens what is written here, and what `numpy.savez` or `numpy.savez_compressed` wrote is read here, if
//! it has the arrays below, H × W and in C order:
//!
//! | array | type | value | where nothing is hit |
//! | --- | --- | --- | --- |
//! | `hit` | u8 | 1 where the pixel sees a point, else 0 | 0 |
//! | `face` | i32 | number of the face | −1 |
//! | `u`, `v` | f64 | parameters in the surface's own knot domain | NaN |
//! | `t` | f64 | distance along the pixel's unit ray, model units | NaN |
//! | `pos` | f64, H × W × 3 | the point, world coordinates | NaN |
//! | `normal` | f64, H × W × 3 | unit normal; NaN where its status is undefined | NaN |
//! | `status` | u8 | [`NormalStatus`]: 0 regular, 1 limit, 2 undefined | 255 |
//! | `k1`, `k2` | f64 | principal curvatures, 1 / model unit; NaN where there are none | NaN |
//! | `undecided` | u8 | 1 where the renderer could not decide, else 0 | 0 or 1 |
//! | `meta` | one text, `<U…` | a JSON object, see [`Meta`]; `json.loads(str(z["meta"]))` | |
//!
//! Read are also `<f4` for `<f8`, and `|u1`, `|b1`, `<i4`, `<i8` for one another, as long as the value fits; `meta`
//! may be bytes (`|S…`, UTF-8). Where `hit` is 0 nothing else but `undecided` is looked at. Whether a value is
//! plausible (a normal of unit length, a point on the surface) is not judged here: that is the comparer's work, and a
//! file with wrong values must reach it.
//!
//! The zip reader is the `zip` crate; array headers are read by `npy`, as the `npyz` crate takes memory for as long a
//! header as a file claims to have and overflows on the product of a shape.

use crate::buffer::{NO_HIT, Parts};
use crate::npy::Header;
use crate::{GBuffer, GBufferError, Hit, Meta, PrincipalCurvatures};
use glam::{DVec2, DVec3};
use nurbs::{Normal, NormalStatus};
use scene::{FaceId, Viewport};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::fs::File;
use std::io::{self, BufReader, BufWriter, Cursor, Read, Seek, SeekFrom, Write};
use std::path::Path;
use zip::result::ZipError;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipArchive, ZipWriter};

/// `status` where nothing is hit.
const NO_STATUS: u8 = 255;

/// The longest `meta` read, characters.
const MAX_META: usize = 1 << 20;

/// Bytes of an entry from which on the zip64 form is written: 32-bit sizes end at 2³² − 1, and deflate may add a little.
const ZIP64_FROM: u64 = 0xf000_0000;

/// Deflate's effort. Digits of f64 hardly compress; more effort gains little and costs much.
const DEFLATE_LEVEL: i64 = 1;

/// Deflate makes no more than this out of a byte (258 bytes from two bits), so no honest array is longer than this many
/// times its file.
const DEFLATE_RATIO: u64 = 1032;

/// Elements decoded at a time.
const CHUNK_ELEMENTS: usize = 4096;

impl GBuffer {
    /// Writes the buffer to a file, replacing what is there.
    ///
    /// The bytes depend on the buffer alone: times are fixed, the order of arrays too. Values that are not finite in a
    /// hit are written as they are; [`Self::read_npz`] then refuses the file.
    ///
    /// # Errors
    /// [`GBufferError::Io`], [`GBufferError::FaceTooLarge`]. A file that could not be finished may be left behind.
    pub fn write_npz(&self, path: impl AsRef<Path>) -> Result<(), GBufferError> {
        let path = path.as_ref();
        self.check_faces()?;
        let io = |source| GBufferError::Io { path: path.to_owned(), source };
        let file = File::create(path).map_err(io)?;
        let mut writer = self.write_archive(BufWriter::new(file)).map_err(io)?;
        writer.flush().map_err(io)
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
    /// Memory is that of the buffer it gives. A file can ask for no more than its own length lets it hold.
    ///
    /// # Errors
    /// Any of the reading variants of [`GBufferError`], naming file, array and value.
    pub fn read_npz(path: impl AsRef<Path>) -> Result<Self, GBufferError> {
        let path = path.as_ref();
        let file = File::open(path).map_err(|source| GBufferError::Io { path: path.to_owned(), source })?;
        read_archive(BufReader::new(file), path)
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
        archive.numbers("t", |hit| hit.t)?;
        archive.vectors("pos", |hit| hit.position)?;
        archive.vectors("normal", |hit| hit.normal.unit().unwrap_or(DVec3::NAN))?;
        archive.pixels("status", "|u1", |hit| [hit.map_or(NO_STATUS, |h| h.normal.status() as u8)])?;
        archive.numbers("k1", |hit| hit.curvature.map_or(f64::NAN, |k| k.k1))?;
        archive.numbers("k2", |hit| hit.curvature.map_or(f64::NAN, |k| k.k2))?;
        archive.undecided()?;
        archive.meta()?;
        Ok(archive.zip.finish()?)
    }
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

    /// An array of `N` bytes a pixel; `components` is the length of its last dimension.
    fn write<const N: usize>(
        &mut self,
        array: &str,
        descr: &str,
        components: Option<u64>,
        values: impl Iterator<Item = [u8; N]>,
    ) -> io::Result<()> {
        let viewport = self.buffer.viewport();
        self.start(array, Header::new(descr, shape(viewport, components)), (viewport.pixels() * N) as u64)?;
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
        self.write(array, descr, None, self.buffer.pixels().map(value))
    }

    fn numbers(&mut self, array: &str, value: impl Fn(&Hit) -> f64) -> io::Result<()> {
        self.pixels(array, "<f8", |hit| hit.map_or(f64::NAN, &value).to_le_bytes())
    }

    fn vectors(&mut self, array: &str, value: impl Fn(&Hit) -> DVec3) -> io::Result<()> {
        let bytes = |hit: Option<&Hit>| {
            let mut bytes = [0; 24];
            for (part, x) in bytes.chunks_exact_mut(8).zip(hit.map_or(DVec3::NAN, &value).to_array()) {
                part.copy_from_slice(&x.to_le_bytes());
            }
            bytes
        };
        self.write(array, "<f8", Some(3), self.buffer.pixels().map(bytes))
    }

    fn undecided(&mut self) -> io::Result<()> {
        let viewport = self.buffer.viewport();
        let (width, buffer) = (viewport.width(), self.buffer);
        let values = (0..viewport.pixels()).map(|i| [u8::from(buffer.is_undecided(i % width, i / width))]);
        self.write("undecided", "|u1", None, values)
    }

    fn meta(&mut self) -> io::Result<()> {
        let text = serde_json::to_string(&MetaText::new(self.buffer)).map_err(io::Error::from)?;
        let units: Vec<u8> = text.chars().flat_map(|c| u32::from(c).to_le_bytes()).collect();
        self.start("meta", Header::new(format!("<U{}", units.len() / 4), vec![]), units.len() as u64)?;
        self.zip.write_all(&units)
    }
}

/// Rows, columns and, for vectors, components.
fn shape(viewport: Viewport, components: Option<u64>) -> Vec<u64> {
    [viewport.height() as u64, viewport.width() as u64].into_iter().chain(components).collect()
}

/// `meta` as it stands in the file.
#[derive(Serialize, Deserialize)]
struct MetaText {
    renderer: String,
    technique: String,
    model: String,
    model_hash: String,
    camera: Value,
    /// Width, height.
    size: [usize; 2],
    adapter: Option<String>,
    driver: Option<String>,
    version: String,
}

impl MetaText {
    fn new(buffer: &GBuffer) -> Self {
        let Meta { renderer, technique, model, model_hash, camera, adapter, driver, version } = buffer.meta().clone();
        let size = [buffer.viewport().width(), buffer.viewport().height()];
        Self { renderer, technique, model, model_hash, camera, size, adapter, driver, version }
    }

    fn into_meta(self) -> Meta {
        let Self { renderer, technique, model, model_hash, camera, size: _, adapter, driver, version } = self;
        Meta { renderer, technique, model, model_hash, camera, adapter, driver, version }
    }
}

fn read_archive<R: Read + Seek>(mut reader: R, path: &Path) -> Result<GBuffer, GBufferError> {
    let unreadable = |e: String| GBufferError::Archive { path: path.to_owned(), reason: lower_case(e) };
    let file_bytes = reader.seek(SeekFrom::End(0)).map_err(|e| unreadable(e.to_string()))?;
    let zip = ZipArchive::new(reader).map_err(|e| unreadable(e.to_string()))?;
    let mut archive = Source { zip, path, file_bytes };
    let viewport = archive.viewport()?;
    // All that the arrays claim to be is checked before memory is taken for any.
    for array in ["hit", "face", "status", "undecided"] {
        archive.array::<i64, 1>(array, viewport)?;
    }
    for array in ["u", "v", "t", "k1", "k2"] {
        archive.array::<f64, 1>(array, viewport)?;
    }
    for array in ["pos", "normal"] {
        archive.array::<f64, 3>(array, viewport)?;
    }
    let meta = archive.meta(viewport)?;
    let (mut index, mut hits) = (vec![], vec![]);
    archive.visit("hit", viewport, |_, [hit]: [i64; 1]| {
        let seen = flag(hit)?;
        index.push(if seen { hits.len() as u32 } else { NO_HIT });
        hits.extend(seen.then_some(BLANK));
        Ok(())
    })?;
    let fill = &mut Fill { index: &index, hits: &mut hits };
    archive.fill("face", viewport, fill, |hit, [face]: [i64; 1]| {
        let legal = i32::try_from(face).ok().and_then(|f| u32::try_from(f).ok());
        hit.face = FaceId(legal.ok_or(Wrong { value: face as f64, expected: "a face's number" })?);
        Ok(())
    })?;
    archive.fill("u", viewport, fill, |hit, u| number(u).map(|u| hit.uv.x = u))?;
    archive.fill("v", viewport, fill, |hit, v| number(v).map(|v| hit.uv.y = v))?;
    archive.fill("t", viewport, fill, |hit, t| number(t).map(|t| hit.t = t))?;
    archive.fill("pos", viewport, fill, |hit, p| vector(p).map(|p| hit.position = p))?;
    archive.fill("status", viewport, fill, |hit, [status]: [i64; 1]| {
        hit.normal = match status {
            s if s == NormalStatus::Regular as i64 => Normal::Regular(DVec3::NAN),
            s if s == NormalStatus::Limit as i64 => Normal::Limit(DVec3::NAN),
            s if s == NormalStatus::Undefined as i64 => Normal::Undefined,
            _ => return Err(Wrong { value: status as f64, expected: "0, 1 or 2" }),
        };
        Ok(())
    })?;
    archive.fill("normal", viewport, fill, |hit, n| {
        hit.normal = match hit.normal {
            Normal::Regular(_) => Normal::Regular(vector(n)?),
            Normal::Limit(_) => Normal::Limit(vector(n)?),
            Normal::Undefined => Normal::Undefined,
        };
        Ok(())
    })?;
    archive.fill("k1", viewport, fill, |hit, k: [f64; 1]| {
        hit.curvature = match k {
            [k1] if k1.is_nan() => None,
            _ => Some(PrincipalCurvatures { k1: number(k)?, k2: f64::NAN }),
        };
        Ok(())
    })?;
    archive.fill("k2", viewport, fill, |hit, k| {
        match &mut hit.curvature {
            Some(curvature) => curvature.k2 = number(k)?,
            None if k[0].is_nan() => {}
            None => return Err(Wrong { value: k[0], expected: "NaN as k1 is" }),
        }
        Ok(())
    })?;
    let mut undecided = vec![];
    archive.visit("undecided", viewport, |pixel, [open]: [i64; 1]| {
        undecided.extend(flag(open)?.then_some(pixel as u32));
        Ok(())
    })?;
    Ok(GBuffer::from_parts(Parts { viewport, meta, index, hits, undecided }))
}

/// What a hit is before its arrays are read.
const BLANK: Hit = Hit {
    face: FaceId(0),
    uv: DVec2::NAN,
    t: f64::NAN,
    position: DVec3::NAN,
    normal: Normal::Undefined,
    curvature: None,
};

/// An element that must not be as it is.
struct Wrong {
    value: f64,
    expected: &'static str,
}

fn flag(value: i64) -> Result<bool, Wrong> {
    match value {
        0 => Ok(false),
        1 => Ok(true),
        _ => Err(Wrong { value: value as f64, expected: "0 or 1" }),
    }
}

fn number([x]: [f64; 1]) -> Result<f64, Wrong> {
    if x.is_finite() { Ok(x) } else { Err(Wrong { value: x, expected: "a finite number" }) }
}

fn vector([x, y, z]: [f64; 3]) -> Result<DVec3, Wrong> {
    Ok(DVec3::new(number([x])?, number([y])?, number([z])?))
}

/// The zip crate begins its messages with capitals.
fn lower_case(message: String) -> String {
    let mut chars = message.chars();
    chars.next().map(|first| first.to_lowercase().chain(chars).collect()).unwrap_or_default()
}

/// Bytes of an element, and how to read it from them.
type Decoder<T> = (usize, fn(&[u8]) -> T);

/// The type that elements have in memory.
trait Element: Copy {
    /// Zero, to begin with.
    const ZERO: Self;
    /// The types that are read, for messages.
    const EXPECTED: &'static str;
    /// How to read an element of NumPy type `descr`; `None` where it might lose something.
    fn decoder(descr: &str) -> Option<Decoder<Self>>;
}

/// The first `N` bytes, of which the caller has that many.
fn bytes<const N: usize>(bytes: &[u8]) -> [u8; N] {
    *bytes.first_chunk().expect("elements are cut to their own length")
}

impl Element for f64 {
    const ZERO: Self = 0.0;
    const EXPECTED: &'static str = "<f8, <f4";
    fn decoder(descr: &str) -> Option<Decoder<Self>> {
        match descr {
            "<f8" => Some((8, |b| f64::from_le_bytes(bytes(b)))),
            "<f4" => Some((4, |b| f64::from(f32::from_le_bytes(bytes(b))))),
            _ => None,
        }
    }
}

impl Element for i64 {
    const ZERO: Self = 0;
    const EXPECTED: &'static str = "|u1, |b1, <i4, <i8";
    fn decoder(descr: &str) -> Option<Decoder<Self>> {
        match descr {
            "|u1" | "|b1" => Some((1, |b| i64::from(b[0]))),
            "<i4" => Some((4, |b| i64::from(i32::from_le_bytes(bytes(b))))),
            "<i8" => Some((8, |b| i64::from_le_bytes(bytes(b)))),
            _ => None,
        }
    }
}

/// The hits under construction.
struct Fill<'a> {
    index: &'a [u32],
    hits: &'a mut [Hit],
}

/// A zip archive being read.
struct Source<'a, R> {
    zip: ZipArchive<R>,
    path: &'a Path,
    /// Length of the whole file.
    file_bytes: u64,
}

impl<R: Read + Seek> Source<'_, R> {
    /// Opens an array: its header, the bytes of its elements as the archive has them, and a reader at the first.
    fn open(&mut self, array: &'static str) -> Result<(Header, u64, impl Read), GBufferError> {
        let path = self.path;
        let mut entry = self.zip.by_name(&format!("{array}.npy")).map_err(|e| match e {
            ZipError::FileNotFound => GBufferError::MissingArray { path: path.to_owned(), array },
            e => GBufferError::Data { path: path.to_owned(), array, reason: lower_case(e.to_string()) },
        })?;
        let (header, length) =
            Header::read(&mut entry).map_err(|reason| GBufferError::Header { path: path.to_owned(), array, reason })?;
        if header.fortran_order {
            return Err(GBufferError::FortranOrder { path: path.to_owned(), array });
        }
        Ok((header, entry.size().saturating_sub(length), entry))
    }

    /// The picture's size, from the shape of `hit`.
    fn viewport(&mut self) -> Result<Viewport, GBufferError> {
        let path = self.path;
        let (header, ..) = self.open("hit")?;
        let &[height, width] = &header.shape[..] else {
            let expected = vec![1, 1];
            return Err(GBufferError::Shape { path: path.to_owned(), array: "hit", found: header.shape, expected });
        };
        let side = |n: u64| usize::try_from(n).unwrap_or(usize::MAX);
        Viewport::new(side(width), side(height)).map_err(|source| GBufferError::Size { path: path.to_owned(), source })
    }

    /// Opens an array of `N` elements a pixel and checks its shape, type and length: how to read an
    /// element, and a reader at the first.
    fn array<T: Element, const N: usize>(
        &mut self,
        array: &'static str,
        viewport: Viewport,
    ) -> Result<(Decoder<T>, impl Read), GBufferError> {
        let (path, file_bytes) = (self.path, self.file_bytes);
        let (header, size, reader) = self.open(array)?;
        let expected = shape(viewport, (N > 1).then_some(N as u64));
        if header.shape != expected {
            return Err(GBufferError::Shape { path: path.to_owned(), array, found: header.shape, expected });
        }
        let Some(decoder) = T::decoder(&header.descr) else {
            let (found, expected) = (header.descr, T::EXPECTED);
            return Err(GBufferError::Dtype { path: path.to_owned(), array, found, expected });
        };
        let needed = (viewport.pixels() * N * decoder.0) as u64;
        if size != needed {
            let reason = format!("{size} bytes where its shape asks for {needed}");
            return Err(GBufferError::Data { path: path.to_owned(), array, reason });
        }
        if needed > file_bytes.saturating_mul(DEFLATE_RATIO) {
            let reason = format!("{needed} bytes cannot come from a file of {file_bytes}");
            return Err(GBufferError::Data { path: path.to_owned(), array, reason });
        }
        Ok((decoder, reader))
    }

    /// Gives all elements of an array of `N` a pixel to `visit`, with the pixel's number.
    fn visit<T: Element, const N: usize>(
        &mut self,
        array: &'static str,
        viewport: Viewport,
        mut visit: impl FnMut(usize, [T; N]) -> Result<(), Wrong>,
    ) -> Result<(), GBufferError> {
        let path = self.path;
        let ((width, decode), mut reader) = self.array::<T, N>(array, viewport)?;
        let damaged = |reason: String| GBufferError::Data { path: path.to_owned(), array, reason };
        let stride = N * width;
        let mut chunk = vec![0; stride * CHUNK_ELEMENTS.min(viewport.pixels())];
        let mut pixel = 0;
        while pixel < viewport.pixels() {
            let count = CHUNK_ELEMENTS.min(viewport.pixels() - pixel);
            let chunk = &mut chunk[..count * stride];
            reader.read_exact(chunk).map_err(|e| damaged(e.to_string()))?;
            for bytes in chunk.chunks_exact(stride) {
                let mut values = [T::ZERO; N];
                for (value, bytes) in values.iter_mut().zip(bytes.chunks_exact(width)) {
                    *value = decode(bytes);
                }
                visit(pixel, values).map_err(|Wrong { value, expected }| {
                    let (x, y) = (pixel % viewport.width(), pixel / viewport.width());
                    GBufferError::Value { path: path.to_owned(), array, x, y, value, expected }
                })?;
                pixel += 1;
            }
        }
        at_end(&mut reader).map_err(damaged)
    }

    /// As [`Self::visit`], for the pixels that hit something.
    fn fill<T: Element, const N: usize>(
        &mut self,
        array: &'static str,
        viewport: Viewport,
        fill: &mut Fill,
        mut set: impl FnMut(&mut Hit, [T; N]) -> Result<(), Wrong>,
    ) -> Result<(), GBufferError> {
        self.visit(array, viewport, |pixel, values| match fill.index[pixel] {
            NO_HIT => Ok(()),
            i => set(&mut fill.hits[i as usize], values),
        })
    }

    fn meta(&mut self, viewport: Viewport) -> Result<Meta, GBufferError> {
        let (path, array) = (self.path, "meta");
        let (header, size, mut reader) = self.open(array)?;
        if !header.shape.is_empty() {
            let (found, expected) = (header.shape, vec![]);
            return Err(GBufferError::Shape { path: path.to_owned(), array, found, expected });
        }
        let dtype =
            || GBufferError::Dtype {
                path: path.to_owned(), array, found: header.descr.clone(), expected: "<U…, |S…"
            };
        let (unicode, count) = match header.descr.split_at_checked(2) {
            Some(("<U", count)) => (true, count),
            Some(("|S", count)) => (false, count),
            _ => return Err(dtype()),
        };
        let count: usize = count.parse().map_err(|_| dtype())?;
        let damaged = |reason: String| GBufferError::Data { path: path.to_owned(), array, reason };
        if count > MAX_META {
            return Err(damaged(format!("{count} characters, above {MAX_META}")));
        }
        let needed = if unicode { 4 * count } else { count };
        if size != needed as u64 {
            return Err(damaged(format!("{size} bytes where its type asks for {needed}")));
        }
        let mut text = vec![0; needed];
        reader.read_exact(&mut text).map_err(|e| damaged(e.to_string()))?;
        at_end(&mut reader).map_err(damaged)?;
        let text = if unicode {
            text.chunks_exact(4).map(|c| char::from_u32(u32::from_le_bytes(bytes(c)))).collect()
        } else {
            String::from_utf8(text).ok()
        };
        let malformed = |reason: String| GBufferError::Meta { path: path.to_owned(), reason };
        let text = text.ok_or_else(|| malformed("it is not Unicode text".to_owned()))?;
        let meta: MetaText = serde_json::from_str(text.trim_end_matches('\0')).map_err(|e| malformed(e.to_string()))?;
        let arrays = [viewport.width(), viewport.height()];
        if meta.size != arrays {
            return Err(GBufferError::MetaSize { path: path.to_owned(), meta: meta.size, arrays });
        }
        Ok(meta.into_meta())
    }
}

/// Nothing may follow the elements; the zip reader compares the checksum when it comes to the end.
fn at_end(reader: &mut impl Read) -> Result<(), String> {
    match reader.read(&mut [0]) {
        Ok(0) => Ok(()),
        Ok(_) => Err("more bytes than its shape asks for".to_owned()),
        Err(e) => Err(lower_case(e.to_string())),
    }
}
