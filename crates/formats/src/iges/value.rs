//! Free-format parameters: fields between delimiters, and what they hold.

use super::fault::{Fault, fault};
use crate::document::name;
use std::sync::Arc;

/// A parameter.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Value {
    /// A real, or an integer: files write one for the other.
    Number(f64),
    /// A Hollerith string, as it stands in the file.
    Text(Box<[u8]>),
    /// An empty field: its default.
    Absent,
    /// A field that makes no sense.
    Bad,
}

/// The bytes that end a field and a record.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Delimiters {
    pub field: u8,
    pub record: u8,
}

impl Default for Delimiters {
    fn default() -> Self {
        Self { field: b',', record: b';' }
    }
}

/// A parser of one record.
pub(super) struct Parser<'t> {
    text: &'t [u8],
    at: usize,
    delimiters: Delimiters,
    is_over: bool,
}

impl<'t> Parser<'t> {
    pub fn new(text: &'t [u8], delimiters: Delimiters) -> Self {
        Self { text, at: 0, delimiters, is_over: false }
    }

    fn skip_blanks(&mut self) {
        let blanks = self.text[self.at..].iter().take_while(|b| matches!(b, b' ' | 0)).count();
        self.at += blanks;
    }

    /// The string at this place, if one begins here; one that is longer than the text ends the record.
    fn string(&mut self) -> Option<Value> {
        let digits = self.text[self.at..].iter().take_while(|b| b.is_ascii_digit()).count();
        if digits == 0 || self.text.get(self.at + digits) != Some(&b'H') {
            return None;
        }
        let count = self.text[self.at..self.at + digits]
            .iter()
            .fold(0usize, |count, digit| count.saturating_mul(10).saturating_add(usize::from(digit - b'0')));
        let start = self.at + digits + 1;
        let Some(text) = start.checked_add(count).and_then(|end| self.text.get(start..end)) else {
            self.is_over = true;
            return Some(Value::Bad);
        };
        self.at = start + count;
        Some(Value::Text(text.into()))
    }

    /// Sets other delimiters from here on: global parameters 1 and 2 name them.
    pub fn set_delimiters(&mut self, delimiters: Delimiters) {
        self.delimiters = delimiters;
    }

    /// A string that is said to be one character long and holds a delimiter itself.
    pub fn delimiter(&mut self) -> Option<u8> {
        self.skip_blanks();
        match self.string()? {
            Value::Text(text) if text.len() == 1 => Some(text[0]),
            _ => None,
        }
    }

    /// Steps over the delimiter at this place.
    pub fn step_over(&mut self) {
        self.skip_blanks();
        if self.text.get(self.at) == Some(&self.delimiters.field) {
            self.at += 1;
        }
    }
}

impl Iterator for Parser<'_> {
    type Item = Value;

    fn next(&mut self) -> Option<Value> {
        if self.is_over {
            return None;
        }
        self.skip_blanks();
        let string = self.string();
        if self.is_over {
            return string;
        }
        let Delimiters { field, record } = self.delimiters;
        let rest = &self.text[self.at..];
        let length = rest.iter().position(|b| *b == field || *b == record);
        let own = rest[..length.unwrap_or(rest.len())].trim_ascii();
        self.is_over = length.is_none_or(|length| rest[length] == record);
        self.at += length.map_or(rest.len(), |length| length + 1);
        match string {
            // A record without its end: what is left of the text says nothing.
            None if length.is_none() && own.is_empty() => None,
            Some(string) if own.is_empty() => Some(string),
            Some(_) => Some(Value::Bad),
            None if own.is_empty() => Some(Value::Absent),
            None => Some(number(own).map_or(Value::Bad, Value::Number)),
        }
    }
}

/// A number that is finite; Fortran's exponents (`1.D0`) count, too.
fn number(text: &[u8]) -> Option<f64> {
    if !text.iter().all(|b| b.is_ascii_digit() || matches!(b, b'+' | b'-' | b'.' | b'E' | b'e' | b'D' | b'd')) {
        return None;
    }
    let text = std::str::from_utf8(text).expect("ASCII");
    let number: f64 = match text.parse() {
        Ok(number) => number,
        Err(_) => text.replace(['D', 'd'], "E").parse().ok()?,
    };
    number.is_finite().then_some(number)
}

/// Text without the blanks about it; `None` for none.
pub(super) fn words(bytes: &[u8]) -> Option<Arc<str>> {
    name(&String::from_utf8_lossy(bytes))
}

/// Parameters of an entity, by position; its type stands at 0, as in the standard's tables.
#[derive(Debug, Clone, Copy)]
pub(super) struct Parameters<'e> {
    pub number: u32,
    pub values: &'e [Value],
}

impl Parameters<'_> {
    fn wrong(self, at: usize, expected: &str) -> Fault {
        let what = match self.values.get(at) {
            None => format!("ends before parameter {at}, {expected}"),
            Some(_) => format!("has a parameter {at} that is not {expected}"),
        };
        fault(self.number, format!("it {what}"))
    }

    /// A number; 0 for an empty field.
    pub fn number(self, at: usize) -> Result<f64, Fault> {
        match self.values.get(at) {
            Some(Value::Number(number)) => Ok(*number),
            Some(Value::Absent) => Ok(0.0),
            _ => Err(self.wrong(at, "a number")),
        }
    }

    pub fn whole(self, at: usize) -> Result<usize, Fault> {
        let number = self.number(at)?;
        let is_whole = (0.0..1e9).contains(&number) && number.fract() == 0.0;
        if is_whole { Ok(number as usize) } else { Err(self.wrong(at, "a whole number from 0")) }
    }

    /// A pointer to a directory entry; `None` for 0, an empty field, or a record that ends before it.
    pub fn optional_pointer(self, at: usize) -> Result<Option<u32>, Fault> {
        if self.values.len() <= at {
            return Ok(None);
        }
        let number = u32::try_from(self.whole(at)?).expect("below 1e9");
        Ok((number != 0).then_some(number))
    }

    pub fn pointer(self, at: usize) -> Result<u32, Fault> {
        self.optional_pointer(at)?.ok_or_else(|| self.wrong(at, "a pointer"))
    }

    /// A count of items that follow it, so many parameters each; more than are there is refused.
    pub fn count(self, at: usize, each: usize) -> Result<usize, Fault> {
        let count = self.whole(at)?;
        let there = self.values.len().saturating_sub(at + 1) / each.max(1);
        if count <= there {
            Ok(count)
        } else {
            Err(fault(self.number, format!("parameter {at} counts {count} items, of which there are {there}")))
        }
    }

    /// Numbers in a row.
    pub fn numbers(self, from: usize, count: usize) -> Result<Vec<f64>, Fault> {
        let end = from.checked_add(count).filter(|end| *end <= self.values.len());
        let end = end.ok_or_else(|| {
            fault(
                self.number,
                format!("it has {} parameters where {} are asked for", self.values.len(), from.saturating_add(count)),
            )
        })?;
        (from..end).map(|at| self.number(at)).collect()
    }

    /// Pointers in a row.
    pub fn pointers(self, from: usize, count: usize) -> Result<Vec<u32>, Fault> {
        (from..from + count).map(|at| self.pointer(at)).collect()
    }

    /// A text without the blanks about it; `None` for none.
    pub fn text(self, at: usize) -> Option<Arc<str>> {
        match self.values.get(at) {
            Some(Value::Text(bytes)) => words(bytes),
            _ => None,
        }
    }

    /// A flag: 0 or 1.
    pub fn flag(self, at: usize) -> Result<bool, Fault> {
        match self.whole(at)? {
            0 => Ok(false),
            1 => Ok(true),
            _ => Err(self.wrong(at, "0 or 1")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_are_what_they_hold() {
        let text = b"126, 1.5D-3 ,,4H;,;,,-.5E2,1.0.0,+7;rest";
        let values: Vec<Value> = Parser::new(text, Delimiters::default()).collect();
        let expected = [
            Value::Number(126.0),
            Value::Number(1.5e-3),
            Value::Absent,
            Value::Text((*b";,;,").into()),
            Value::Number(-50.0),
            Value::Bad,
            Value::Number(7.0),
        ];
        assert_eq!(values, expected);
    }

    #[test]
    fn a_string_longer_than_the_text_ends_the_record() {
        for text in ["116,1000000000Habc,1.;", "116,99999999999999999999999999H"] {
            let values: Vec<Value> = Parser::new(text.as_bytes(), Delimiters::default()).collect();
            assert_eq!(values, [Value::Number(116.0), Value::Bad]);
        }
    }

    #[test]
    fn what_is_not_finite_is_no_number() {
        for text in ["1E400", "NaN", "inf", "-", "1D", "1.5-3"] {
            assert_eq!(number(text.as_bytes()), None, "{text}");
        }
    }
}
