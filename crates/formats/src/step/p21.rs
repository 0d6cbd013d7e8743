//! The text of a STEP file (ISO 10303-21): where each instance stands, and its parameters when they are asked for.
//!
//! One pass finds the statements; nothing of them is kept but their places, 24 bytes an instance. The reader takes files as
//! they are found: integers for reals, a missing `;`, missing sections or header, Latin-1, a quotation mark too few. A
//! statement that makes no sense is noted with its line, and the next one is read.

use super::value::{Entity, Parser};
use std::collections::BTreeMap;

/// The most faults of the text that are listed; the others are counted.
const LISTED: usize = 100;

/// A file, by its instances.
#[derive(Debug)]
pub(super) struct Instances<'b> {
    bytes: &'b [u8],
    /// In order of their numbers.
    records: Vec<Record>,
    /// What makes no sense: the line, and why.
    pub faults: Vec<(usize, &'static str)>,
    /// How many more there were.
    pub more_faults: usize,
}

/// Where an instance stands.
#[derive(Debug, Clone, Copy)]
struct Record {
    number: u64,
    /// After the `=`.
    start: u32,
    end: u32,
    line: u32,
}

/// Why there is no instance of a number.
pub(super) const MISSING: &str = "it is not in the file, or its text makes no sense";

impl<'b> Instances<'b> {
    /// Finds the instances of a file, which has at most 4 GiB.
    pub fn new(bytes: &'b [u8]) -> Self {
        let mut scan = Scan { bytes, at: 0, line: 1, faults: vec![], more_faults: 0 };
        let mut records: Vec<Record> = vec![];
        while scan.skip_blanks() {
            let (line, from) = (scan.line, scan.at);
            let number = scan.number();
            let start = scan.at;
            let end = scan.statement();
            match number {
                Some(number) => {
                    records.push(Record { number, start: start as u32, end: end as u32, line: line as u32 })
                }
                None if bytes[from] == b'#' => scan.fault(line, "no instance: its number is not followed by '='"),
                // The header, and the names of sections.
                None => {}
            }
        }
        // Stable, so that of equal numbers the first one stays.
        records.sort_by_key(|record| record.number);
        let lines: Vec<u32> =
            records.windows(2).filter(|pair| pair[0].number == pair[1].number).map(|pair| pair[1].line).collect();
        lines.into_iter().for_each(|line| scan.fault(line as usize, "an instance has the number of an earlier one"));
        records.dedup_by_key(|record| record.number);
        Self { bytes, records, faults: scan.faults, more_faults: scan.more_faults }
    }

    /// How many instances there are.
    pub fn len(&self) -> usize {
        self.records.len()
    }

    /// How long the file is.
    pub fn bytes(&self) -> usize {
        self.bytes.len()
    }

    /// The instance of a number, with its parameters; `None` where there is none, or its text makes no sense.
    pub fn get(&self, number: u64) -> Option<Entity<'b>> {
        let record = self.records[self.index(number)?];
        Parser::new(self.text(record)).entity(number)
    }

    /// The line on which an instance begins; 0 where there is none.
    pub fn line(&self, number: u64) -> usize {
        self.index(number).map_or(0, |index| self.records[index].line as usize)
    }

    /// What an instance is: its keyword, or for a complex one the first; empty where it has none.
    pub fn keyword(&self, number: u64) -> &'b str {
        self.index(number).map_or("", |index| first_keyword(self.text(self.records[index])))
    }

    /// The numbers of the instances of each of these keywords, or of complex ones that name it.
    pub fn of(&self, keywords: &[&'static str]) -> BTreeMap<&'static str, Vec<u64>> {
        let mut found: BTreeMap<&'static str, Vec<u64>> = keywords.iter().map(|keyword| (*keyword, vec![])).collect();
        for record in &self.records {
            let text = self.text(*record);
            match first_keyword(text) {
                "" => {
                    let Some(entity) = Parser::new(text).entity(record.number) else { continue };
                    for (keyword, _) in &entity.parts {
                        if let Some(list) = found.get_mut::<str>(keyword) {
                            list.push(record.number);
                        }
                    }
                }
                keyword => {
                    if let Some(list) = found.get_mut::<str>(keyword) {
                        list.push(record.number);
                    }
                }
            }
        }
        found
    }

    fn text(&self, record: Record) -> &'b [u8] {
        &self.bytes[record.start as usize..record.end as usize]
    }

    fn index(&self, number: u64) -> Option<usize> {
        // Most files number their instances in a row.
        let first = self.records.first()?.number;
        let guess = usize::try_from(number.checked_sub(first)?).ok()?;
        if self.records.get(guess).is_some_and(|record| record.number == number) {
            return Some(guess);
        }
        self.records.binary_search_by_key(&number, |record| record.number).ok()
    }
}

/// The keyword with which a body begins; empty for a complex instance.
fn first_keyword(text: &[u8]) -> &str {
    let start = text.iter().position(|b| !b.is_ascii_whitespace()).unwrap_or(text.len());
    let rest = &text[start..];
    let end = rest.iter().position(|b| !(b.is_ascii_alphanumeric() || *b == b'_')).unwrap_or(rest.len());
    std::str::from_utf8(&rest[..end]).expect("ASCII")
}

/// The pass over the text.
struct Scan<'b> {
    bytes: &'b [u8],
    at: usize,
    line: usize,
    faults: Vec<(usize, &'static str)>,
    more_faults: usize,
}

impl Scan<'_> {
    fn fault(&mut self, line: usize, why: &'static str) {
        if self.faults.len() < LISTED { self.faults.push((line, why)) } else { self.more_faults += 1 }
    }

    fn peek(&self) -> Option<u8> {
        self.bytes.get(self.at).copied()
    }

    /// Skips blanks, comments and empty statements; whether anything is left.
    fn skip_blanks(&mut self) -> bool {
        while let Some(byte) = self.peek() {
            match byte {
                b'\n' => self.line += 1,
                b';' | b' ' | b'\t' | b'\r' | 0 => {}
                b'/' if self.bytes.get(self.at + 1) == Some(&b'*') => {
                    self.comment();
                    continue;
                }
                _ => return true,
            }
            self.at += 1;
        }
        false
    }

    /// Skips a comment, at whose start this is; one that does not end reaches to the end of its line.
    fn comment(&mut self) {
        let rest = &self.bytes[self.at + 2..];
        match rest.windows(2).position(|pair| pair == b"*/") {
            Some(length) => {
                self.line += rest[..length].iter().filter(|b| **b == b'\n').count();
                self.at += length + 4;
            }
            None => {
                self.fault(self.line, "a comment does not end");
                self.at += rest.iter().position(|b| *b == b'\n').unwrap_or(rest.len()) + 2;
            }
        }
    }

    /// The number of an instance, where one begins here: `#12 =`, and goes on behind the `=`.
    fn number(&mut self) -> Option<u64> {
        let text = self.bytes[self.at..].strip_prefix(b"#")?;
        let digits = text.iter().take_while(|b| b.is_ascii_digit()).count();
        let number = std::str::from_utf8(&text[..digits]).expect("digits").parse().ok()?;
        self.at += 1 + digits;
        self.skip_blanks();
        if self.peek()? != b'=' {
            return None;
        }
        self.at += 1;
        Some(number)
    }

    /// Skips to the end of a statement, and says where its text ends.
    fn statement(&mut self) -> usize {
        let line = self.line;
        while let Some(byte) = self.peek() {
            match byte {
                b'\'' => self.string(),
                b'/' if self.bytes.get(self.at + 1) == Some(&b'*') => self.comment(),
                b';' => {
                    self.at += 1;
                    return self.at - 1;
                }
                b'\n' => {
                    self.line += 1;
                    self.at += 1;
                    // The next one begins: nothing else in a statement has a number and then a '='.
                    let blanks = self.bytes[self.at..].iter().take_while(|b| matches!(b, b' ' | b'\t' | b'\r')).count();
                    if self.bytes.get(self.at + blanks) == Some(&b'#')
                        && instance_start(&self.bytes[self.at + blanks..]).is_some()
                    {
                        self.fault(line, "no ';' before the next instance");
                        return self.at;
                    }
                }
                _ => self.at += 1,
            }
        }
        self.fault(line, "the file ends inside a statement");
        self.at
    }

    /// Skips a string, at whose start this is; one that does not end before the next instance reaches to the end of its
    /// line.
    fn string(&mut self) {
        let (start, line) = (self.at, self.line);
        self.at += 1;
        while let Some(byte) = self.peek() {
            self.at += 1;
            match byte {
                // Two in a row are one that is meant: the next string begins at once.
                b'\'' => return,
                b'\n' => {
                    self.line += 1;
                    if self.peek() == Some(b'#') && instance_start(&self.bytes[self.at..]).is_some() {
                        break;
                    }
                }
                _ => {}
            }
        }
        self.fault(line, "a string does not end");
        let length = self.bytes[start..].iter().position(|b| *b == b'\n').unwrap_or(self.bytes.len() - start);
        (self.at, self.line) = (start + length, line);
    }
}

/// The number and the length of `#12 =`, where a text begins so.
fn instance_start(text: &[u8]) -> Option<(u64, usize)> {
    let digits = text.strip_prefix(b"#")?.iter().take_while(|b| b.is_ascii_digit()).count();
    let number = std::str::from_utf8(&text[1..=digits]).expect("digits").parse().ok()?;
    let rest = &text[1 + digits..];
    let blanks = rest.iter().take(MOST_BLANKS).take_while(|b| b.is_ascii_whitespace()).count();
    (rest.get(blanks) == Some(&b'=')).then_some((number, digits + blanks + 2))
}

/// The most blanks between an instance's number and its `=`.
const MOST_BLANKS: usize = 64;
