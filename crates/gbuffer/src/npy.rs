//! One NumPy array as bytes: the header that stands before its elements.
//!
//! The header is a Python dictionary in text. Only the one that `numpy.save` writes for plain arrays is read: no
//! structured types, no nesting, nothing whose size grows with what the file claims.
//! Source: NumPy, NEP 1, "A simple file format for NumPy arrays", versions 1.0 to 3.0.

use std::fmt::Write as _;
use std::io::{self, Read};

/// First bytes of every array.
const MAGIC: &[u8; 6] = b"\x93NUMPY";

/// The longest header text read, bytes: NumPy's own limit (`max_header_size`).
const MAX_HEADER: u32 = 10_000;

/// More dimensions than this are never an array of ours.
const MAX_DIMENSIONS: usize = 8;

/// What a header says.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Header {
    /// NumPy's name of the element type, such as `<f8`.
    pub descr: String,
    /// Whether the first index runs fastest.
    pub fortran_order: bool,
    /// Number of elements along each dimension; none for a single element.
    pub shape: Vec<u64>,
}

impl Header {
    /// A header in C order.
    pub fn new(descr: impl Into<String>, shape: Vec<u64>) -> Self {
        Self { descr: descr.into(), fortran_order: false, shape }
    }

    /// The bytes before the elements, version 1.0, padded with spaces to a multiple of 64 as NumPy does.
    pub fn to_bytes(&self) -> Vec<u8> {
        let order = if self.fortran_order { "True" } else { "False" };
        let mut shape = String::new();
        for n in &self.shape {
            write!(shape, "{n}, ").expect("a string takes all");
        }
        // One dimension keeps its comma; more lose the last.
        let shape = if self.shape.len() == 1 { shape.trim_end() } else { shape.trim_end_matches(", ") };
        let text = format!("{{'descr': '{}', 'fortran_order': {order}, 'shape': ({shape}), }}", self.descr);
        let before = MAGIC.len() + 4;
        let padded = (before + text.len() + 1).next_multiple_of(64) - before;
        let length = u16::try_from(padded).expect("types and shapes of ours are short");
        let mut bytes = MAGIC.to_vec();
        bytes.extend([1, 0]);
        bytes.extend(length.to_le_bytes());
        bytes.extend(text.bytes());
        bytes.resize(before + padded - 1, b' ');
        bytes.push(b'\n');
        bytes
    }

    /// Reads a header and leaves `reader` at the first element; also gives the number of bytes read.
    ///
    /// # Errors
    /// In words, what is wrong.
    pub fn read(reader: &mut impl Read) -> Result<(Self, u64), String> {
        let mut exactly = |bytes: &mut [u8]| match reader.read_exact(bytes) {
            Err(e) if e.kind() == io::ErrorKind::UnexpectedEof => Err("it ends inside the header".to_owned()),
            other => other.map_err(|e| e.to_string()),
        };
        let mut start = [0; 8];
        exactly(&mut start)?;
        if start[..6] != MAGIC[..] {
            return Err("it does not begin with NumPy's magic bytes".to_owned());
        }
        let (length, before) = match start[6] {
            1 => {
                let mut length = [0; 2];
                exactly(&mut length)?;
                (u32::from(u16::from_le_bytes(length)), 10)
            }
            2 | 3 => {
                let mut length = [0; 4];
                exactly(&mut length)?;
                (u32::from_le_bytes(length), 12)
            }
            version => return Err(format!("version {version} is not 1, 2 or 3")),
        };
        if length > MAX_HEADER {
            return Err(format!("its length, {length} bytes, is above {MAX_HEADER}"));
        }
        let mut text = vec![0; length as usize];
        exactly(&mut text)?;
        let text = str::from_utf8(&text).map_err(|_| "it is not text".to_owned())?;
        Ok((Parser { rest: text }.header()?, before + u64::from(length)))
    }
}

/// Reads the dictionary from the left.
struct Parser<'a> {
    rest: &'a str,
}

impl<'a> Parser<'a> {
    fn header(mut self) -> Result<Header, String> {
        let (mut descr, mut fortran_order, mut shape) = (None, None, None);
        self.expect('{')?;
        while !self.accept('}') {
            let key = self.string()?;
            self.expect(':')?;
            match key {
                "descr" => descr = Some(self.string()?.to_owned()),
                "fortran_order" => fortran_order = Some(self.boolean()?),
                "shape" => shape = Some(self.tuple()?),
                _ => return Err(format!("the key {key:?} is none of descr, fortran_order, shape")),
            }
            if !self.accept(',') {
                self.expect('}')?;
                break;
            }
        }
        if !self.rest.trim().is_empty() {
            return Err("something follows the dictionary".to_owned());
        }
        let missing = |key: &str| format!("the key {key:?} is missing");
        Ok(Header {
            descr: descr.ok_or_else(|| missing("descr"))?,
            fortran_order: fortran_order.ok_or_else(|| missing("fortran_order"))?,
            shape: shape.ok_or_else(|| missing("shape"))?,
        })
    }

    fn accept(&mut self, symbol: char) -> bool {
        self.rest = self.rest.trim_start();
        let after = self.rest.strip_prefix(symbol);
        self.rest = after.unwrap_or(self.rest);
        after.is_some()
    }

    fn expect(&mut self, symbol: char) -> Result<(), String> {
        if self.accept(symbol) { Ok(()) } else { Err(format!("{symbol:?} is expected before {:?}", self.next_few())) }
    }

    /// What comes next, cut short for a message.
    fn next_few(&self) -> String {
        self.rest.chars().take(24).collect()
    }

    fn string(&mut self) -> Result<&'a str, String> {
        let quote = if self.accept('"') { '"' } else { '\'' };
        if quote == '\'' && !self.accept('\'') {
            return Err(format!("a plain type or key is expected before {:?}", self.next_few()));
        }
        let (string, rest) = self.rest.split_once(quote).ok_or("a string does not end")?;
        self.rest = rest;
        Ok(string)
    }

    fn boolean(&mut self) -> Result<bool, String> {
        self.rest = self.rest.trim_start();
        for (word, value) in [("True", true), ("False", false)] {
            if let Some(rest) = self.rest.strip_prefix(word) {
                self.rest = rest;
                return Ok(value);
            }
        }
        Err(format!("True or False is expected before {:?}", self.next_few()))
    }

    fn tuple(&mut self) -> Result<Vec<u64>, String> {
        let mut values = vec![];
        self.expect('(')?;
        while !self.accept(')') {
            let digits = self.rest.len() - self.rest.trim_start_matches(|c: char| c.is_ascii_digit()).len();
            let (number, rest) = self.rest.split_at(digits);
            values.push(number.parse().map_err(|_| format!("a length is expected before {:?}", self.next_few()))?);
            self.rest = rest;
            if values.len() > MAX_DIMENSIONS {
                return Err(format!("more than {MAX_DIMENSIONS} dimensions"));
            }
            if !self.accept(',') {
                self.expect(')')?;
                break;
            }
        }
        Ok(values)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Result<Header, String> {
        Parser { rest: text }.header()
    }

    #[test]
    fn a_header_is_read_as_it_was_written() {
        for shape in [vec![], vec![7], vec![2, 3], vec![16384, 16384, 3]] {
            let header = Header::new("<f8", shape);
            let bytes = header.to_bytes();
            assert_eq!(bytes.len() % 64, 0);
            let mut reader = &bytes[..];
            assert_eq!(Header::read(&mut reader), Ok((header, bytes.len() as u64)));
            assert!(reader.is_empty());
        }
    }

    #[test]
    fn text_is_the_one_that_numpy_writes() {
        let text = |shape| String::from_utf8(Header::new("<f8", shape).to_bytes()[10..].to_vec()).unwrap();
        assert!(text(vec![]).starts_with("{'descr': '<f8', 'fortran_order': False, 'shape': (), } "));
        assert!(text(vec![5]).starts_with("{'descr': '<f8', 'fortran_order': False, 'shape': (5,), } "));
        assert!(text(vec![5, 6]).starts_with("{'descr': '<f8', 'fortran_order': False, 'shape': (5, 6), } "));
        assert!(text(vec![5, 6]).ends_with(" \n"));
    }

    #[test]
    fn spacing_quotes_and_order_of_keys_are_free() {
        let header = parse("{\"shape\":(4,),'fortran_order' : True,'descr':\"|u1\"}\n").unwrap();
        assert_eq!(header, Header { descr: "|u1".to_owned(), fortran_order: true, shape: vec![4] });
    }

    #[test]
    fn malformed_headers_are_refused_in_words() {
        let good = "{'descr': '<f8', 'fortran_order': False, 'shape': (3, 4), }";
        for (from, to) in [
            ("{", ""),
            ("}", ""),
            ("}", "} x"),
            ("'<f8'", "'<f8"),
            ("'<f8'", "[('a', '<f8')]"),
            ("'<f8'", "1"),
            ("False", "0"),
            ("(3, 4)", "(3, -4)"),
            ("(3, 4)", "(3, 99999999999999999999)"),
            ("(3, 4)", "((3, 4)"),
            ("(3, 4)", "(,)"),
            ("(3, 4)", "(1,1,1,1,1,1,1,1,1)"),
            ("'shape'", "'size'"),
            ("'shape': (3, 4), ", ""),
        ] {
            let bad = good.replacen(from, to, 1);
            assert!(parse(&bad).is_err(), "{bad}");
        }
        assert!(parse(good).is_ok());
    }

    #[test]
    fn a_header_that_claims_to_be_huge_is_refused_before_memory_is_taken() {
        let mut bytes = MAGIC.to_vec();
        bytes.extend([2, 0, 0xff, 0xff, 0xff, 0xff]);
        assert!(Header::read(&mut &bytes[..]).unwrap_err().contains("4294967295"));
        assert!(Header::read(&mut &bytes[..9]).unwrap_err().contains("ends"));
        assert!(Header::read(&mut &b"PK\x03\x04xxxxxxxx"[..]).unwrap_err().contains("magic"));
    }
}
