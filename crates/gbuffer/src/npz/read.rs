//! Reading: what the archive claims is checked before memory is taken, then the arrays are read one by one.

use super::array::{CHUNK_ELEMENTS, shape};
use super::element::{Decoder, Element};
use crate::buffer::{NO_HIT, Parts};
use crate::npy::Header;
use crate::{GBuffer, GBufferError, Hit, LocalParameters, Meta, PrincipalCurvatures};
use glam::{DVec2, DVec3};
use nurbs::{Normal, NormalStatus};
use scene::{Camera, FaceId, Viewport};
use serde::Deserialize;
use std::io::{Read, Seek, SeekFrom};
use std::path::Path;
use zip::ZipArchive;
use zip::result::ZipError;

/// Deflate makes no more than this out of a byte (258 bytes from two bits), so no honest array is longer than this many
/// times its file.
const DEFLATE_RATIO: u64 = 1032;

/// Characters of an unknown entry's name in a message.
const SHOWN_NAME: usize = 64;

/// All arrays that a file may have.
const ARRAYS: [&str; 15] =
    ["hit", "face", "u", "v", "span", "local", "t", "pos", "normal", "status", "k1", "k2", "edge", "undecided", "meta"];

/// What an archive says of its arrays and its making, before any array is read.
struct Opened<'a, R> {
    source: Source<'a, R>,
    present: Present,
    viewport: Viewport,
    meta: Meta,
}

fn opened<R: Read + Seek>(mut reader: R, path: &Path) -> Result<Opened<'_, R>, GBufferError> {
    let unreadable = |e: String| GBufferError::Archive { path: path.to_owned(), reason: lower_case(e) };
    let file_bytes = reader.seek(SeekFrom::End(0)).map_err(|e| unreadable(e.to_string()))?;
    let zip = ZipArchive::new(reader).map_err(|e| unreadable(e.to_string()))?;
    let mut source = Source { zip, path, file_bytes };
    source.no_stranger()?;
    let present = Present::in_archive(&source);
    let viewport = source.viewport(if present.hit { "hit" } else { "face" })?;
    source.check(&present, viewport)?;
    let meta = source.meta(viewport)?;
    Ok(Opened { source, present, viewport, meta })
}

/// Reads the facts of a buffer and its size; `path` names it in messages.
pub(super) fn facts<R: Read + Seek>(reader: R, path: &Path) -> Result<(Meta, Viewport), GBufferError> {
    opened(reader, path).map(|Opened { meta, viewport, .. }| (meta, viewport))
}

/// Reads a buffer; `path` names it in messages.
pub(super) fn archive<R: Read + Seek>(reader: R, path: &Path) -> Result<GBuffer, GBufferError> {
    let Opened { mut source, present, viewport, meta } = opened(reader, path)?;
    let rays = match present.t {
        true => None,
        false => Some(Camera::deserialize(&meta.camera).map_err(|e| GBufferError::Meta {
            path: path.to_owned(),
            reason: format!(
                "the array \"t\" is missing, and the camera, by which it could be computed, is not one: {e}"
            ),
        })?),
    };
    let (index, mut hits) = source.index(&present, viewport)?;
    let fill = &mut Fill { index: &index, hits: &mut hits };
    source.points(viewport, fill)?;
    if present.local {
        source.local(viewport, fill)?;
    }
    match rays {
        None => source.fill("t", viewport, fill, |hit, t| number(t).map(|t| hit.t = t))?,
        Some(camera) => measure(&camera, viewport, fill),
    }
    source.normals(&present, viewport, fill)?;
    if present.curvature {
        source.curvatures(viewport, fill)?;
    }
    if present.edge {
        source.edges(viewport, fill)?;
    }
    let mut undecided = vec![];
    if present.undecided {
        source.visit("undecided", viewport, |pixel, [open]: [i64; 1]| {
            undecided.extend(flag(open)?.then_some(pixel as u32));
            Ok(())
        })?;
    }
    Ok(GBuffer::from_parts(Parts { viewport, meta, index, hits, undecided, edges: present.edge }))
}

/// Which of the arrays that may be absent a file has.
struct Present {
    hit: bool,
    t: bool,
    /// Either of `span` and `local`; then both must be there.
    local: bool,
    status: bool,
    /// Either of `k1` and `k2`; then both must be there.
    curvature: bool,
    edge: bool,
    undecided: bool,
}

impl Present {
    fn in_archive<R: Read + Seek>(source: &Source<'_, R>) -> Self {
        let has = |array: &str| source.zip.index_for_name(&format!("{array}.npy")).is_some();
        Self {
            hit: has("hit"),
            t: has("t"),
            local: has("span") || has("local"),
            status: has("status"),
            curvature: has("k1") || has("k2"),
            edge: has("edge"),
            undecided: has("undecided"),
        }
    }
}

/// Distance of the points along their pixels' rays.
fn measure(camera: &Camera, viewport: Viewport, fill: &mut Fill) {
    for (pixel, &i) in fill.index.iter().enumerate().filter(|(_, i)| **i != NO_HIT) {
        let (x, y) = (pixel % viewport.width(), pixel / viewport.width());
        let ray = camera.ray(viewport, x as f64 + 0.5, y as f64 + 0.5);
        let hit = &mut fill.hits[i as usize];
        hit.t = (hit.position - ray.origin).dot(ray.direction);
    }
}

/// What a hit is before its arrays are read.
const BLANK: Hit = Hit {
    face: FaceId(0),
    uv: DVec2::NAN,
    local: None,
    t: f64::NAN,
    position: DVec3::NAN,
    normal: Normal::Undefined,
    curvature: None,
    edge: None,
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

fn face_id(face: i64, expected: &'static str) -> Result<FaceId, Wrong> {
    let id = i32::try_from(face).ok().and_then(|f| u32::try_from(f).ok()).map(FaceId);
    id.ok_or(Wrong { value: face as f64, expected })
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

/// The hits under construction.
struct Fill<'a> {
    index: &'a [u32],
    hits: &'a mut [Hit],
}

/// A zip archive being read.
pub(super) struct Source<'a, R> {
    zip: ZipArchive<R>,
    pub path: &'a Path,
    /// Length of the whole file.
    file_bytes: u64,
}

impl<R: Read + Seek> Source<'_, R> {
    /// Every entry is one of [`ARRAYS`]: an array that may be absent must not be so by a slip in its name.
    fn no_stranger(&self) -> Result<(), GBufferError> {
        let known = |raw: &[u8]| {
            let array = raw.strip_suffix(b".npy");
            array.is_some_and(|array| ARRAYS.iter().any(|known| known.as_bytes() == array))
        };
        match self.zip.file_names_raw().find(|raw| !known(raw)) {
            None => Ok(()),
            Some(raw) => Err(GBufferError::UnknownArray {
                path: self.path.to_owned(),
                entry: String::from_utf8_lossy(raw).chars().take(SHOWN_NAME).collect(),
                known: ARRAYS.join(", "),
            }),
        }
    }

    /// All that the arrays claim to be is checked before memory is taken for any.
    fn check(&mut self, present: &Present, viewport: Viewport) -> Result<(), GBufferError> {
        let integers =
            [(present.hit, "hit"), (true, "face"), (present.status, "status"), (present.undecided, "undecided")];
        for (_, array) in integers.into_iter().filter(|(there, _)| *there) {
            self.array::<i64, 1>(array, viewport)?;
        }
        let numbers =
            [(true, "u"), (true, "v"), (present.t, "t"), (present.curvature, "k1"), (present.curvature, "k2")];
        for (_, array) in numbers.into_iter().filter(|(there, _)| *there) {
            self.array::<f64, 1>(array, viewport)?;
        }
        for array in ["pos", "normal"] {
            self.array::<f64, 3>(array, viewport)?;
        }
        if present.local {
            self.array::<i64, 2>("span", viewport)?;
            self.array::<f64, 2>("local", viewport)?;
        }
        if present.edge {
            self.array::<f64, 2>("edge", viewport)?;
        }
        Ok(())
    }

    /// Which pixels hit something, as indices into the hits, and the hits with their faces.
    fn index(&mut self, present: &Present, viewport: Viewport) -> Result<(Vec<u32>, Vec<Hit>), GBufferError> {
        // Counted first: a vector that grows takes up to three times as much while it moves.
        let mut count = 0;
        let (array, blank) = if present.hit { ("hit", 0) } else { ("face", -1) };
        self.visit(array, viewport, |_, [value]: [i64; 1]| {
            count += usize::from(value != blank);
            Ok(())
        })?;
        let (mut index, mut hits) = (Vec::with_capacity(viewport.pixels()), Vec::with_capacity(count));
        let mut add = |face: Option<FaceId>| {
            index.push(if face.is_some() { hits.len() as u32 } else { NO_HIT });
            hits.extend(face.map(|face| Hit { face, ..BLANK }));
        };
        if !present.hit {
            self.visit("face", viewport, |_, [face]: [i64; 1]| {
                add(if face == -1 { None } else { Some(face_id(face, "a face's number, or -1")?) });
                Ok(())
            })?;
            return Ok((index, hits));
        }
        self.visit("hit", viewport, |_, [hit]: [i64; 1]| {
            add(flag(hit)?.then_some(BLANK.face));
            Ok(())
        })?;
        self.fill("face", viewport, &mut Fill { index: &index, hits: &mut hits }, |hit, [face]: [i64; 1]| {
            hit.face = face_id(face, "a face's number")?;
            Ok(())
        })?;
        Ok((index, hits))
    }

    fn points(&mut self, viewport: Viewport, fill: &mut Fill) -> Result<(), GBufferError> {
        self.fill("u", viewport, fill, |hit, u| number(u).map(|u| hit.uv.x = u))?;
        self.fill("v", viewport, fill, |hit, v| number(v).map(|v| hit.uv.y = v))?;
        self.fill("pos", viewport, fill, |hit, p| vector(p).map(|p| hit.position = p))
    }

    fn normals(&mut self, present: &Present, viewport: Viewport, fill: &mut Fill) -> Result<(), GBufferError> {
        if !present.status {
            return self.fill("normal", viewport, fill, |hit, n: [f64; 3]| {
                let none = n.iter().all(|x| x.is_nan());
                hit.normal = if none { Normal::Undefined } else { Normal::Regular(vector(n)?) };
                Ok(())
            });
        }
        self.fill("status", viewport, fill, |hit, [status]: [i64; 1]| {
            hit.normal = match status {
                s if s == NormalStatus::Regular as i64 => Normal::Regular(DVec3::NAN),
                s if s == NormalStatus::Limit as i64 => Normal::Limit(DVec3::NAN),
                s if s == NormalStatus::Undefined as i64 => Normal::Undefined,
                _ => return Err(Wrong { value: status as f64, expected: "0, 1 or 2" }),
            };
            Ok(())
        })?;
        self.fill("normal", viewport, fill, |hit, n| {
            hit.normal = match hit.normal {
                Normal::Regular(_) => Normal::Regular(vector(n)?),
                Normal::Limit(_) => Normal::Limit(vector(n)?),
                Normal::Undefined => Normal::Undefined,
            };
            Ok(())
        })
    }

    fn curvatures(&mut self, viewport: Viewport, fill: &mut Fill) -> Result<(), GBufferError> {
        self.fill("k1", viewport, fill, |hit, k: [f64; 1]| {
            hit.curvature = match k {
                [k1] if k1.is_nan() => None,
                _ => Some(PrincipalCurvatures { k1: number(k)?, k2: f64::NAN }),
            };
            Ok(())
        })?;
        self.fill("k2", viewport, fill, |hit, k| {
            match &mut hit.curvature {
                Some(curvature) => curvature.k2 = number(k)?,
                None if k[0].is_nan() => {}
                None => return Err(Wrong { value: k[0], expected: "NaN as k1 is" }),
            }
            Ok(())
        })
    }

    fn local(&mut self, viewport: Viewport, fill: &mut Fill) -> Result<(), GBufferError> {
        let span = |k: i64| u32::try_from(k).map_err(|_| Wrong { value: k as f64, expected: "the number of a span" });
        let share = |t: f64| match t {
            0.0..=1.0 => Ok(t),
            _ => Err(Wrong { value: t, expected: "a number from 0 to 1" }),
        };
        self.fill("span", viewport, fill, |hit, [u, v]: [i64; 2]| {
            hit.local = Some(LocalParameters { span: [span(u)?, span(v)?], uv: DVec2::NAN });
            Ok(())
        })?;
        self.fill("local", viewport, fill, |hit, [u, v]: [f64; 2]| {
            let uv = DVec2::new(share(u)?, share(v)?);
            hit.local = hit.local.map(|local| LocalParameters { uv, ..local });
            Ok(())
        })
    }

    fn edges(&mut self, viewport: Viewport, fill: &mut Fill) -> Result<(), GBufferError> {
        self.fill("edge", viewport, fill, |hit, [x, y]: [f64; 2]| {
            let none = x.is_nan() && y.is_nan();
            hit.edge = if none { None } else { Some(DVec2::new(number([x])?, number([y])?)) };
            Ok(())
        })
    }

    /// Opens an array: its header, the bytes of its elements as the archive has them, and a reader at the first.
    pub fn open(&mut self, array: &'static str) -> Result<(Header, u64, impl Read), GBufferError> {
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

    /// The picture's size, from the shape of `array`.
    fn viewport(&mut self, array: &'static str) -> Result<Viewport, GBufferError> {
        let path = self.path;
        let (header, ..) = self.open(array)?;
        let &[height, width] = &header.shape[..] else {
            return Err(GBufferError::NotRows { path: path.to_owned(), array, found: header.shape });
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
}

/// Nothing may follow the elements; the zip reader compares the checksum when it comes to the end.
pub(super) fn at_end(reader: &mut impl Read) -> Result<(), String> {
    match reader.read(&mut [0]) {
        Ok(0) => Ok(()),
        Ok(_) => Err("more bytes than its shape asks for".to_owned()),
        Err(e) => Err(lower_case(e.to_string())),
    }
}
