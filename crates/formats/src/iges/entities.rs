//! The entities of a file: directory entries, found in one pass, and parameters, parsed when something asks for them.

use super::cards::{Card, Cards, whole};
use super::fault::{Fault, fault};
use super::value::{Delimiters, Parameters, Parser, Value};
use std::cell::Cell;

/// Columns of a parameter card that hold parameters.
const COLUMNS: usize = 64;

/// Columns of a field of a directory entry.
const FIELD: usize = 8;

/// How often the parameter cards are read at most, those that are read again counted again, and so many cards more.
const READINGS: usize = 8;
const CARDS: usize = 1 << 16;

/// How many places of damage are told one by one.
const TOLD: usize = 20;

/// A directory entry.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Entry {
    /// Its sequence number, by which others point to it.
    pub number: u32,
    /// The entity's type.
    pub kind: u16,
    pub form: i16,
    /// The line on which it begins, from 1.
    pub line: u32,
    /// The entry of its transformation matrix; 0 for none.
    pub matrix: u32,
    /// The first of its parameter cards.
    parameters: u32,
    /// Whether the file hides it: blank status 01.
    pub is_blanked: bool,
    /// Whether it says that it is a part of another entity: subordinate status 01 or 03.
    pub is_dependent: bool,
    /// The number of its colour; negative, that of the entry that defines it; 0 for none.
    pub colour: i32,
    /// Its level, 0 for none; negative, that of the entry that lists several.
    pub level: i32,
    /// Its label.
    pub label: [u8; FIELD],
}

/// An entity with its parameters.
#[derive(Debug)]
pub(super) struct Entity {
    pub entry: Entry,
    values: Vec<Value>,
}

impl Entity {
    pub fn parameters(&self) -> Parameters<'_> {
        Parameters { number: self.entry.number, values: &self.values }
    }
}

/// All entities of a file.
#[derive(Debug)]
pub(super) struct Entities<'b> {
    cards: Cards<'b>,
    delimiters: Delimiters,
    /// Ascending by number.
    entries: Vec<Entry>,
    /// The first parameter cards of all entries, ascending: each record ends before the next.
    starts: Vec<u32>,
    /// How many parameter cards may still be read: entries may name the same long record again and again.
    readable: Cell<usize>,
    /// Lines of directory entries that make no sense.
    pub damage: Vec<(usize, String)>,
}

impl<'b> Entities<'b> {
    pub fn new(cards: Cards<'b>, delimiters: Delimiters) -> Self {
        let mut entries: Vec<Entry> = Vec::with_capacity(cards.directory.len() / 2);
        let (mut damage, mut wrong) = (vec![], 0);
        let mut at = 0;
        while at < cards.directory.len() {
            let first = cards.directory[at];
            // The second line of an entry has the next number; one that stands alone has lost its other half.
            let second = cards.directory.get(at + 1).filter(|second| second.number == first.number + 1);
            let second = second.filter(|_| first.number % 2 == 1);
            let entry = second.and_then(|second| entry(&cards, first, *second));
            at += if second.is_some() { 2 } else { 1 };
            match entry {
                Some(entry) => entries.push(entry),
                None => {
                    wrong += 1;
                    if wrong <= TOLD {
                        damage.push((
                            first.line as usize,
                            "a directory entry makes no sense, and is left out".to_owned(),
                        ));
                    }
                }
            }
        }
        if TOLD < wrong {
            let line = cards.directory.last().map_or(1, |card| card.line as usize);
            damage.push((line, format!("{} more directory entries make no sense", wrong - TOLD)));
        }
        let mut starts: Vec<u32> = entries.iter().map(|entry| entry.parameters).collect();
        starts.sort_unstable();
        starts.dedup();
        let readable = Cell::new(CARDS + READINGS * cards.parameters.len());
        Self { cards, delimiters, entries, starts, readable, damage }
    }

    /// The directory, ascending by number.
    pub fn entries(&self) -> &[Entry] {
        &self.entries
    }

    /// The directory entry of a number.
    pub fn entry(&self, number: u32) -> Option<&Entry> {
        let at = self.entries.binary_search_by_key(&number, |entry| entry.number).ok()?;
        Some(&self.entries[at])
    }

    /// The entity of a number.
    ///
    /// # Errors
    /// Where there is none, its parameters are of another type, or too much has been read.
    pub fn get(&self, number: u32) -> Result<Entity, Fault> {
        let entry = *self.entry(number).ok_or_else(|| fault(number, "there is no directory entry of this number"))?;
        let cards = &self.cards.parameters;
        let place = |number: u32| cards.partition_point(|card| card.number < number);
        let start = place(entry.parameters);
        if cards.get(start).is_none_or(|card| card.number != entry.parameters) {
            return Err(fault(
                number,
                format!("its parameters should begin at card {}, which is not there", entry.parameters),
            ));
        }
        let next = self.starts.partition_point(|start| *start <= entry.parameters);
        let end = self.starts.get(next).map_or(cards.len(), |next| place(*next));
        let left = self.readable.get().checked_sub(end - start);
        self.readable.set(left.unwrap_or(0));
        left.ok_or_else(|| fault(number, "the file names its entities so often that no more are read"))?;
        let text = self.cards.joined(&cards[start..end], COLUMNS);
        let values: Vec<Value> = Parser::new(&text, self.delimiters).collect();
        match values.first() {
            Some(Value::Number(kind)) if *kind == f64::from(entry.kind) => Ok(Entity { entry, values }),
            _ => Err(fault(number, format!("its parameters do not begin with its type, {}", entry.kind))),
        }
    }
}

/// The entry of two cards.
fn entry(cards: &Cards, first: Card, second: Card) -> Option<Entry> {
    let [top, bottom] = [first, second].map(|card| cards.columns(card, 9 * FIELD));
    let field = |text: &'_ [u8], at: usize| -> Vec<u8> {
        let start = (at * FIELD).min(text.len());
        text[start..text.len().min(start + FIELD)].to_vec()
    };
    // Blanks are a zero.
    let signed = |text: &[u8]| match std::str::from_utf8(text.trim_ascii()).ok()? {
        "" => Some(0),
        text => text.parse::<i32>().ok(),
    };
    let number = |text: &[u8], at: usize| u32::try_from(signed(&field(text, at))?).ok();
    let kind = u16::try_from(whole(&field(top, 0))?).ok()?;
    // Eight digits in pairs: blank, subordinate, use, hierarchy.
    let status = field(top, 8);
    let pair = |at: usize| status.get(at..at + 2).map_or(Some(0), signed);
    let form = i16::try_from(signed(&field(bottom, 4))?).ok()?;
    let mut label = [b' '; FIELD];
    field(bottom, 7).iter().zip(&mut label).for_each(|(byte, place)| *place = *byte);
    Some(Entry {
        number: first.number,
        kind,
        form,
        line: first.line,
        matrix: number(top, 6)?,
        parameters: number(top, 1)?,
        is_blanked: pair(0)? == 1,
        is_dependent: matches!(pair(2)?, 1 | 3),
        colour: signed(&field(bottom, 2))?,
        level: signed(&field(top, 4))?,
        label,
    })
}
