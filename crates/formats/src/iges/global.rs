//! The global section: delimiters, unit, and resolution.

use super::cards::Cards;
use super::value::{Delimiters, Parser, Value};
use crate::document::Unit;

/// Columns of a card of this section.
const COLUMNS: usize = 72;

/// Parameters of the section by the standard's numbers, counted from 0.
const SCALE: usize = 13 - 1;
const UNIT: usize = 14 - 1;
const UNIT_NAME: usize = 15 - 1;
const RESOLUTION: usize = 19 - 1;

/// What the section says of the whole file.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Global {
    pub delimiters: Delimiters,
    /// `None` where the section ends before it names one.
    pub unit: Option<Unit>,
    /// Points nearer to each other than this are one, model units; 0 where it is not stated.
    pub resolution: f64,
    /// What is wrong with it: the line, and why.
    pub damage: Vec<(usize, String)>,
}

impl Global {
    pub fn new(cards: &Cards) -> Self {
        let text = cards.joined(&cards.global, COLUMNS);
        let line = cards.global.first().map_or(1, |card| card.line as usize);
        let mut damage = vec![];
        let mut parser = Parser::new(&text, Delimiters::default());
        let mut delimiters = Delimiters::default();
        if let Some(field) = parser.delimiter() {
            delimiters.field = field;
        }
        parser.set_delimiters(delimiters);
        parser.step_over();
        if let Some(record) = parser.delimiter() {
            delimiters.record = record;
        }
        let is_legal = |b: u8| b.is_ascii_graphic() && !b.is_ascii_alphanumeric() && !matches!(b, b'+' | b'-' | b'.');
        if !(is_legal(delimiters.field) && is_legal(delimiters.record) && delimiters.field != delimiters.record) {
            damage
                .push((line, "its delimiters cannot be told from numbers: commas and semicolons are taken".to_owned()));
            delimiters = Delimiters::default();
        }
        parser.set_delimiters(delimiters);
        parser.step_over();
        let mut values = vec![Value::Absent; 2];
        values.extend(parser);
        if values.len() <= RESOLUTION {
            damage.push((line, format!("the global section ends after parameter {}", values.len())));
        }
        let mut above_0 = |at: usize, what: &str, usual: f64| match values.get(at) {
            None | Some(Value::Absent) => usual,
            Some(Value::Number(number)) if 0.0 < *number && number.is_finite() => *number,
            // Some write 0 where they state no resolution.
            Some(Value::Number(number)) if *number == usual => usual,
            Some(_) => {
                damage.push((line, format!("its {what} is no number above 0: {usual} is taken")));
                usual
            }
        };
        let scale = above_0(SCALE, "model scale", 1.0);
        let resolution = above_0(RESOLUTION, "resolution", 0.0);
        let name = match values.get(UNIT_NAME) {
            Some(Value::Text(text)) => Some(String::from_utf8_lossy(text).trim().to_owned()),
            _ => None,
        };
        // An empty field means inches; a section that ends before it says nothing.
        let unit = match values.get(UNIT) {
            None => None,
            Some(Value::Absent) => unit(None, name.as_deref()),
            Some(Value::Number(flag)) => unit(Some(*flag), name.as_deref()),
            Some(_) => {
                damage.push((line, "its unit flag is no number".to_owned()));
                unit(Some(BY_NAME), name.as_deref())
            }
        };
        if unit.is_none() && UNIT < values.len() {
            damage.push((line, "the global section names no known unit".to_owned()));
        }
        if let (Some((own, _)), Some(name)) = (unit, name.as_deref())
            && by_name(name).is_some_and(|(.., other, _)| *other != own)
        {
            damage.push((line, format!("its unit flag says {own}, and its unit's name is {name}: the flag counts")));
        }
        let unit = unit.map(|(name, millimetres)| Unit {
            name: if scale == 1.0 { name.to_owned() } else { format!("{name} at scale {scale}") },
            millimetres: millimetres / scale,
        });
        Self { delimiters, unit, resolution, damage }
    }
}

/// The unit flag of a unit that its name says.
const BY_NAME: f64 = 3.0;

/// Units by flag and by names, what they are called here, and how many millimetres they are.
type Known = (u8, &'static [&'static str], &'static str, f64);
const UNITS: [Known; 10] = [
    (1, &["IN", "INCH"], "inch", 25.4),
    (2, &["MM"], "millimetre", 1.0),
    (4, &["FT"], "foot", 304.8),
    (5, &["MI"], "mile", 1_609_344.0),
    (6, &["M"], "metre", 1e3),
    (7, &["KM"], "kilometre", 1e6),
    (8, &["MIL"], "mil", 0.0254),
    (9, &["UM"], "micron", 1e-3),
    (10, &["CM"], "centimetre", 10.0),
    (11, &["UIN"], "microinch", 2.54e-5),
];

fn by_name(name: &str) -> Option<&'static Known> {
    let name = name.to_uppercase();
    UNITS.iter().find(|(_, names, ..)| names.contains(&name.as_str()))
}

/// A unit by its flag, or by its name where the flag is 3; an absent flag means inches.
fn unit(flag: Option<f64>, name: Option<&str>) -> Option<(&'static str, f64)> {
    let by_flag = |flag: f64| UNITS.iter().find(|(own, ..)| f64::from(*own) == flag);
    let found = match flag {
        Some(BY_NAME) => by_name(name?),
        Some(flag) => by_flag(flag),
        None => name.and_then(by_name).or_else(|| by_flag(1.0)),
    };
    found.map(|(.., name, millimetres)| (*name, *millimetres))
}
