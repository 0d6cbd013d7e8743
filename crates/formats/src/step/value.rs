//! The parameters of an instance, parsed from its text.

use super::fault::{Fault, fault};
use super::text::decode;
use crate::document::name;
use std::sync::Arc;

/// How deep lists may be nested.
const DEEPEST: usize = 32;

/// An instance with its parameters: one part, or several for a complex instance.
#[derive(Debug)]
pub(super) struct Entity<'b> {
    pub number: u64,
    pub parts: Vec<(&'b str, Vec<Value<'b>>)>,
}

/// A parameter.
#[derive(Debug, Clone)]
pub(super) enum Value<'b> {
    /// A real, or an integer: files write one for the other.
    Number(f64),
    /// Another instance.
    Reference(u64),
    /// A text, as it stands in the file.
    Text(&'b [u8]),
    /// A word between dots.
    Word(&'b str),
    List(Vec<Value<'b>>),
    /// A value that says its type: `LENGTH_MEASURE(1.)`.
    Typed(Vec<Value<'b>>),
    /// `$` or `*`.
    Absent,
}

impl<'b> Entity<'b> {
    /// The keyword; for a complex instance the first.
    pub fn keyword(&self) -> &'b str {
        self.parts[0].0
    }

    /// Whether one of its parts has this keyword.
    pub fn is(&self, keyword: &str) -> bool {
        self.parts.iter().any(|(own, _)| *own == keyword)
    }

    /// The parameters of the part of that keyword.
    pub fn part(&self, keyword: &str) -> Option<Parameters<'_, 'b>> {
        let (_, values) = self.parts.iter().find(|(own, _)| *own == keyword)?;
        Some(Parameters { number: self.number, values, before: 0 })
    }

    /// The parameters of a simple instance, or of the first part of a complex one.
    pub fn parameters(&self) -> Parameters<'_, 'b> {
        Parameters { number: self.number, values: &self.parts[0].1, before: 0 }
    }
}

/// Parameters of an instance, by position from 0.
#[derive(Debug, Clone, Copy)]
pub(super) struct Parameters<'e, 'b> {
    pub number: u64,
    pub values: &'e [Value<'b>],
    /// How many parameters of its part stand before these.
    before: usize,
}

impl<'e, 'b> Parameters<'e, 'b> {
    /// Those from position `first` on.
    pub fn from(self, first: usize) -> Self {
        Self { values: self.values.get(first..).unwrap_or(&[]), before: self.before + first, ..self }
    }

    fn value(self, at: usize) -> &'e Value<'b> {
        self.values.get(at).unwrap_or(&Value::Absent)
    }

    pub fn wrong(self, at: usize, expected: &str) -> Fault {
        fault(self.number, format!("parameter {} is not {expected}", self.before + at + 1))
    }

    pub fn number(self, at: usize) -> Result<f64, Fault> {
        self.value(at).as_number().ok_or_else(|| self.wrong(at, "a number"))
    }

    pub fn count(self, at: usize) -> Result<usize, Fault> {
        self.value(at).as_count().ok_or_else(|| self.wrong(at, "a whole number from 0"))
    }

    pub fn reference(self, at: usize) -> Result<u64, Fault> {
        self.value(at).as_reference().ok_or_else(|| self.wrong(at, "an instance"))
    }

    /// An instance; `None` for `$`, `*`, and where the parameters end before it.
    pub fn optional_reference(self, at: usize) -> Result<Option<u64>, Fault> {
        match self.value(at) {
            Value::Absent => Ok(None),
            _ => self.reference(at).map(Some),
        }
    }

    /// A number; `None` for `$`, `*`, and where the parameters end before it.
    pub fn optional_number(self, at: usize) -> Result<Option<f64>, Fault> {
        match self.value(at) {
            Value::Absent => Ok(None),
            _ => self.number(at).map(Some),
        }
    }

    /// `.T.` or `.F.`.
    pub fn flag(self, at: usize) -> Result<bool, Fault> {
        match self.value(at) {
            Value::Word("T") => Ok(true),
            Value::Word("F") => Ok(false),
            _ => Err(self.wrong(at, "a flag")),
        }
    }

    pub fn word(self, at: usize) -> Option<&'b str> {
        match self.value(at) {
            Value::Word(word) => Some(word),
            _ => None,
        }
    }

    pub fn text(self, at: usize) -> Option<&'b [u8]> {
        match self.value(at) {
            Value::Text(text) => Some(text),
            _ => None,
        }
    }

    /// A text that names something, decoded; `None` where it is blank, or what some write for that: `NONE`.
    pub fn name(self, at: usize) -> Option<Arc<str>> {
        name(&decode(self.text(at)?)).filter(|name| &**name != "NONE")
    }

    pub fn list(self, at: usize) -> Result<&'e [Value<'b>], Fault> {
        match self.value(at) {
            Value::List(list) => Ok(list),
            _ => Err(self.wrong(at, "a list")),
        }
    }

    pub fn references(self, at: usize) -> Result<Vec<u64>, Fault> {
        let all = self.list(at)?.iter().map(Value::as_reference).collect::<Option<_>>();
        all.ok_or_else(|| self.wrong(at, "a list of instances"))
    }

    pub fn numbers(self, at: usize) -> Result<Vec<f64>, Fault> {
        let all = self.list(at)?.iter().map(Value::as_number).collect::<Option<_>>();
        all.ok_or_else(|| self.wrong(at, "a list of numbers"))
    }

    pub fn counts(self, at: usize) -> Result<Vec<usize>, Fault> {
        let all = self.list(at)?.iter().map(Value::as_count).collect::<Option<_>>();
        all.ok_or_else(|| self.wrong(at, "a list of whole numbers from 0"))
    }
}

impl<'b> Value<'b> {
    pub fn as_number(&self) -> Option<f64> {
        match self {
            Self::Number(number) => Some(*number),
            Self::Typed(values) => values.first()?.as_number(),
            _ => None,
        }
    }

    fn as_count(&self) -> Option<usize> {
        let number = self.as_number()?;
        ((0.0..1e9).contains(&number) && number.fract() == 0.0).then_some(number as usize)
    }

    pub fn as_reference(&self) -> Option<u64> {
        match self {
            Self::Reference(number) => Some(*number),
            _ => None,
        }
    }

    pub fn as_list(&self) -> Option<&[Value<'b>]> {
        match self {
            Self::List(list) => Some(list),
            _ => None,
        }
    }
}

/// A parser of one instance's text.
pub(super) struct Parser<'b> {
    text: &'b [u8],
    at: usize,
}

impl<'b> Parser<'b> {
    pub fn new(text: &'b [u8]) -> Self {
        Self { text, at: 0 }
    }

    /// The instance; `None` where its text makes no sense.
    pub fn entity(&mut self, number: u64) -> Option<Entity<'b>> {
        self.skip_blanks();
        let mut parts = vec![];
        if self.peek()? == b'(' {
            self.at += 1;
            self.skip_blanks();
            while self.peek()? != b')' {
                let keyword = self.keyword()?;
                parts.push((keyword, self.list(0)?));
                self.skip_blanks();
            }
        } else {
            let keyword = self.keyword()?;
            parts.push((keyword, self.list(0)?));
        }
        (!parts.is_empty()).then_some(Entity { number, parts })
    }

    fn peek(&self) -> Option<u8> {
        self.text.get(self.at).copied()
    }

    fn skip_blanks(&mut self) {
        while let Some(byte) = self.peek() {
            if byte == b'/' && self.text.get(self.at + 1) == Some(&b'*') {
                let rest = &self.text[self.at + 2..];
                self.at += rest.windows(2).position(|pair| pair == b"*/").map_or(self.text.len(), |length| length + 4);
            } else if byte.is_ascii_whitespace() || byte == 0 {
                self.at += 1;
            } else {
                return;
            }
        }
    }

    /// The bytes from here while `inside` holds.
    fn take(&mut self, inside: impl Fn(u8) -> bool) -> &'b str {
        let rest = &self.text[self.at.min(self.text.len())..];
        let length = rest.iter().position(|b| !(b.is_ascii() && inside(*b))).unwrap_or(rest.len());
        self.at += length;
        std::str::from_utf8(&rest[..length]).expect("ASCII")
    }

    fn keyword(&mut self) -> Option<&'b str> {
        self.skip_blanks();
        let word = self.take(|b| b.is_ascii_alphanumeric() || b == b'_' || b == b'!');
        (!word.is_empty()).then_some(word)
    }

    /// The values between parentheses.
    fn list(&mut self, depth: usize) -> Option<Vec<Value<'b>>> {
        self.skip_blanks();
        if self.peek()? != b'(' || depth > DEEPEST {
            return None;
        }
        self.at += 1;
        let mut values = vec![];
        loop {
            self.skip_blanks();
            match self.peek()? {
                b')' => {
                    self.at += 1;
                    return Some(values);
                }
                b',' => self.at += 1,
                _ => values.push(self.value(depth)?),
            }
        }
    }

    fn value(&mut self, depth: usize) -> Option<Value<'b>> {
        Some(match self.peek()? {
            b'#' => {
                self.at += 1;
                Value::Reference(self.take(|b| b.is_ascii_digit()).parse().ok()?)
            }
            b'\'' => Value::Text(self.string()?),
            b'"' => {
                self.at += 1;
                self.take(|b| b != b'"');
                self.at += 1;
                Value::Absent
            }
            b'.' if self.text.get(self.at + 1).is_some_and(|b| b.is_ascii_alphabetic()) => {
                self.at += 1;
                let word = self.take(|b| b.is_ascii_alphanumeric() || b == b'_');
                if self.peek() == Some(b'.') {
                    self.at += 1;
                }
                Value::Word(word)
            }
            b'$' | b'*' => {
                self.at += 1;
                Value::Absent
            }
            b'(' => Value::List(self.list(depth + 1)?),
            b'+' | b'-' | b'.' | b'0'..=b'9' => Value::Number(self.number()?),
            _ => {
                self.keyword()?;
                Value::Typed(self.list(depth + 1)?)
            }
        })
    }

    /// A number that is finite; a Fortran exponent (`1.D0`) counts, too.
    fn number(&mut self) -> Option<f64> {
        let text = self.take(|b| b.is_ascii_digit() || matches!(b, b'+' | b'-' | b'.' | b'E' | b'e' | b'D' | b'd'));
        let number: f64 = match text.parse() {
            Ok(number) => number,
            Err(_) => text.replace(['D', 'd'], "E").parse().ok()?,
        };
        number.is_finite().then_some(number)
    }

    /// The text between quotation marks; two in a row are one of its own.
    fn string(&mut self) -> Option<&'b [u8]> {
        let start = self.at + 1;
        let mut at = start;
        loop {
            at += self.text.get(at..)?.iter().position(|b| *b == b'\'')?;
            if self.text.get(at + 1) != Some(&b'\'') {
                self.at = at + 1;
                return Some(&self.text[start..at]);
            }
            at += 2;
        }
    }
}
