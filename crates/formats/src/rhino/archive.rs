//! The bytes of an archive: numbers, and chunks with their lengths.
//!
//! An archive is a line of chunks, and most chunks are lines of chunks again. A chunk begins with a type code and a
//! length: 4 bytes in archives of version 3 and 4, 8 bytes from version 50 on. A code with its highest bit set has a
//! value in the place of the length, and no content. A code with bit 15 set ends with a checksum of 4 bytes, which is
//! not looked at. All numbers are little-endian. Every length and count is checked against the bytes that are there
//! before anything is kept.

use crate::document::Colour;
use glam::DVec3;
use std::fmt;

/// What is wrong at a byte of the file.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Fault {
    /// The byte, from 0.
    pub at: usize,
    pub text: String,
}

/// A universally unique identifier, in the order of its canonical text.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) struct Uuid(pub u128);

impl Uuid {
    pub const NIL: Self = Self(0);

    pub fn is_nil(self) -> bool {
        self == Self::NIL
    }
}

impl fmt::Display for Uuid {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let hex = format!("{:032x}", self.0);
        write!(f, "{}-{}-{}-{}-{}", &hex[..8], &hex[8..12], &hex[12..16], &hex[16..20], &hex[20..])
    }
}

/// Type codes (openNURBS, `opennurbs_3dm.h`).
pub(super) mod code {
    pub const SETTINGS_TABLE: u32 = 0x1000_0015;
    pub const MATERIAL_TABLE: u32 = 0x1000_0010;
    pub const LAYER_TABLE: u32 = 0x1000_0011;
    pub const INSTANCE_DEFINITION_TABLE: u32 = 0x1000_0021;
    pub const OBJECT_TABLE: u32 = 0x1000_0013;
    pub const UNITS_AND_TOLERANCES: u32 = 0x2000_8031;
    pub const MATERIAL_RECORD: u32 = 0x2000_8040;
    pub const LAYER_RECORD: u32 = 0x2000_8050;
    pub const INSTANCE_DEFINITION_RECORD: u32 = 0x2000_8076;
    pub const OBJECT_RECORD: u32 = 0x2000_8070;
    pub const OBJECT_ATTRIBUTES: u32 = 0x0200_8072;
    pub const CLASS: u32 = 0x0002_7ffa;
    pub const CLASS_UUID: u32 = 0x0002_fffb;
    pub const CLASS_DATA: u32 = 0x0002_fffc;
    pub const ANONYMOUS: u32 = 0x4000_8000;
    /// What tables' entries have in common, from version 60 on.
    pub const MODEL_ATTRIBUTES: u32 = 0x4000_8002;
    pub const END_OF_TABLE: u32 = 0xffff_ffff;
    pub const END_OF_FILE: u32 = 0x0000_7fff;
    /// A value and no content.
    pub const SHORT: u32 = 0x8000_0000;
    /// A checksum at the end.
    pub const CHECKSUM: u32 = 0x0000_8000;
}

/// A chunk, with a cursor at the start of its content.
#[derive(Debug, Clone)]
pub(super) struct Chunk<'a> {
    pub code: u32,
    /// The byte at which it begins.
    pub at: usize,
    pub content: Cursor<'a>,
    /// Whether its length goes beyond what holds it; then the content ends there.
    pub is_cut: bool,
}

/// A place in a chunk, from which numbers are read up to the chunk's end.
#[derive(Debug, Clone)]
pub(super) struct Cursor<'a> {
    bytes: &'a [u8],
    at: usize,
    end: usize,
    /// Bytes of a chunk's length: 4 or 8.
    length_bytes: usize,
}

impl<'a> Cursor<'a> {
    /// The whole file behind its first `start` bytes.
    pub fn new(bytes: &'a [u8], start: usize, length_bytes: usize) -> Self {
        Self { bytes, at: start.min(bytes.len()), end: bytes.len(), length_bytes }
    }

    /// The byte that is read next.
    pub fn at(&self) -> usize {
        self.at
    }

    /// How many bytes are left.
    pub fn left(&self) -> usize {
        self.end - self.at
    }

    pub fn fault<T>(&self, text: impl Into<String>) -> Result<T, Fault> {
        Err(Fault { at: self.at, text: text.into() })
    }

    pub fn skip(&mut self, count: usize) -> Result<&'a [u8], Fault> {
        if self.left() < count {
            return self.fault(format!("its data end after {} of {count} bytes", self.left()));
        }
        let taken = &self.bytes[self.at..self.at + count];
        self.at += count;
        Ok(taken)
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N], Fault> {
        Ok(self.skip(N)?.try_into().expect("as many as were taken"))
    }

    /// The code of the chunk that begins here, if any does.
    pub fn next_code(&self) -> Option<u32> {
        self.clone().array().ok().map(u32::from_le_bytes)
    }

    pub fn u8(&mut self) -> Result<u8, Fault> {
        Ok(self.array::<1>()?[0])
    }

    pub fn i32(&mut self) -> Result<i32, Fault> {
        Ok(i32::from_le_bytes(self.array()?))
    }

    pub fn f64(&mut self) -> Result<f64, Fault> {
        Ok(f64::from_le_bytes(self.array()?))
    }

    /// A number that is finite.
    pub fn finite(&mut self) -> Result<f64, Fault> {
        let at = self.at;
        let x = self.f64()?;
        if x.is_finite() { Ok(x) } else { Err(Fault { at, text: format!("a number is {x}") }) }
    }

    /// A point or a vector.
    pub fn point(&mut self) -> Result<DVec3, Fault> {
        Ok(DVec3::new(self.finite()?, self.finite()?, self.finite()?))
    }

    /// Two numbers of which the first is less.
    pub fn interval(&mut self) -> Result<[f64; 2], Fault> {
        let at = self.at;
        let [start, end] = [self.finite()?, self.finite()?];
        if start < end {
            Ok([start, end])
        } else {
            Err(Fault { at, text: format!("a range is from {start} to {end}") })
        }
    }

    /// How many entries of at least `size` bytes follow.
    pub fn count(&mut self, size: usize) -> Result<usize, Fault> {
        let at = self.at;
        let count = self.i32()?;
        match usize::try_from(count) {
            Ok(n) if n <= self.left() / size => Ok(n),
            _ => Err(Fault { at, text: format!("a count is {count}, where {} bytes are left", self.left()) }),
        }
    }

    pub fn indices(&mut self) -> Result<Vec<i32>, Fault> {
        (0..self.count(4)?).map(|_| self.i32()).collect()
    }

    pub fn uuid(&mut self) -> Result<Uuid, Fault> {
        let mut bytes = self.array::<16>()?;
        // The first three groups are little-endian numbers.
        bytes[..4].reverse();
        bytes[4..6].reverse();
        bytes[6..8].reverse();
        Ok(Uuid(u128::from_be_bytes(bytes)))
    }

    /// UTF-16 behind its length; a null character at the end is left away.
    pub fn string(&mut self) -> Result<String, Fault> {
        let count = self.count(2)?;
        let units: Vec<u16> = self.skip(2 * count)?.chunks(2).map(|b| u16::from_le_bytes([b[0], b[1]])).collect();
        Ok(String::from_utf16_lossy(units.strip_suffix(&[0]).unwrap_or(&units)))
    }

    /// A colour: red, green, blue, and how transparent it is, which is read over.
    pub fn colour(&mut self) -> Result<Colour, Fault> {
        let [red, green, blue, _] = self.array()?;
        Ok(Colour([red, green, blue]))
    }

    /// The version of a class's data, packed into a byte; another major version than `major` is a fault.
    pub fn packed_version(&mut self, major: u8) -> Result<u8, Fault> {
        let at = self.at;
        let packed = self.u8()?;
        self.of_version(at, i32::from(packed >> 4), i32::from(major))?;
        Ok(packed & 15)
    }

    /// The version of a chunk's data, as two numbers.
    pub fn version(&mut self, major: i32) -> Result<i32, Fault> {
        let at = self.at;
        let found = self.i32()?;
        self.of_version(at, found, major)?;
        self.i32()
    }

    fn of_version(&self, at: usize, found: i32, major: i32) -> Result<(), Fault> {
        let text = || format!("its data are of version {found}, where {major} is known");
        if found == major { Ok(()) } else { Err(Fault { at, text: text() }) }
    }

    /// The chunk that begins here, as far as it goes; the cursor moves behind it.
    pub fn open(&mut self) -> Result<Chunk<'a>, Fault> {
        let at = self.at;
        let code = u32::from_le_bytes(self.array()?);
        let value = match self.length_bytes {
            4 => i64::from(i32::from_le_bytes(self.array()?)),
            _ => i64::from_le_bytes(self.array()?),
        };
        let mut content = Self { end: self.at, ..self.clone() };
        if code & code::SHORT != 0 {
            return Ok(Chunk { code, at, content, is_cut: false });
        }
        let Ok(length) = usize::try_from(value) else {
            return Err(Fault { at, text: format!("a chunk (code 0x{code:08x}) has {value} bytes") });
        };
        let is_cut = self.left() < length;
        content.end += length.min(self.left());
        self.at = content.end;
        if code & code::CHECKSUM != 0 && !is_cut {
            content.end -= length.min(4);
        }
        Ok(Chunk { code, at, content, is_cut })
    }

    /// The chunk that begins here, all of it; the cursor moves behind it.
    pub fn chunk(&mut self) -> Result<Chunk<'a>, Fault> {
        let chunk = self.open()?;
        if chunk.is_cut {
            let text = format!("a chunk (code 0x{:08x}) goes beyond what holds it", chunk.code);
            return Err(Fault { at: chunk.at, text });
        }
        Ok(chunk)
    }

    /// The content of the chunk that begins here, which has to be of a code.
    pub fn content(&mut self, code: u32) -> Result<Self, Fault> {
        let chunk = self.chunk()?;
        if chunk.code != code {
            let text = format!("a chunk has code 0x{:08x}, where 0x{code:08x} should be", chunk.code);
            return Err(Fault { at: chunk.at, text });
        }
        Ok(chunk.content)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_length_is_checked_against_what_holds_the_chunk() {
        let mut bytes = code::OBJECT_RECORD.to_le_bytes().to_vec();
        bytes.extend(9i32.to_le_bytes());
        bytes.extend([1, 2, 3, 4, 5, 0, 0, 0, 0]);
        let chunk = Cursor::new(&bytes, 0, 4).chunk().unwrap();
        assert_eq!((chunk.code, chunk.content.left()), (code::OBJECT_RECORD, 5), "the checksum is left away");
        let cut = Cursor::new(&bytes[..16], 0, 4).chunk().unwrap_err();
        assert!(cut.text.contains("beyond"), "{cut:?}");
        bytes[4..8].copy_from_slice(&(-1i32).to_le_bytes());
        assert!(Cursor::new(&bytes, 0, 4).chunk().unwrap_err().text.contains("-1 bytes"));
    }

    #[test]
    fn a_count_beyond_the_bytes_is_a_fault_before_anything_is_kept() {
        let bytes = [0xff, 0xff, 0xff, 0x7f, 0, 0];
        let fault = Cursor::new(&bytes, 0, 8).indices().unwrap_err();
        assert_eq!(fault, Fault { at: 0, text: "a count is 2147483647, where 2 bytes are left".into() });
    }

    #[test]
    fn an_identifier_is_shown_as_rhino_shows_it() {
        let bytes = [0xc5, 0xdb, 0xb5, 0x60, 0x60, 0xe6, 0xd3, 0x11, 0xbf, 0xe4, 0, 0x10, 0x83, 1, 0x22, 0xf0];
        let uuid = Cursor::new(&bytes, 0, 8).uuid().unwrap();
        assert_eq!(uuid.to_string(), "60b5dbc5-e660-11d3-bfe4-0010830122f0");
    }
}
