//! The way out: lines and tables for people, one JSON object for machines, what a person sees while waiting, and pictures
//! where the terminal can show them.
//!
//! A line that cannot be written is an error, and no panic: an answer that did not arrive is no answer. Nothing is ever
//! asked of the terminal, since one that does not answer would be waited for.

use anyhow::Result;
use comfy_table::{ContentArrangement, Table, presets::UTF8_FULL_CONDENSED};
use gbuffer::Picture;
use serde::Serialize;
use std::fmt;
use std::io::{self, IsTerminal, Write};
use suite::text::{escaped_json, escaped_lines};

pub use suite::progress::{note, progress, step};

/// Columns of a picture on the terminal.
const COLUMNS: usize = 72;

/// Steps of a channel in the colour cube of 256-colour terminals.
const CUBE: [u8; 6] = [0, 95, 135, 175, 215, 255];

/// Standard output does not take what is written.
#[derive(Debug)]
pub struct OutputError(io::Error);

impl OutputError {
    /// Whether nobody reads any more, as below `| head`: no failure that needs words.
    pub fn is_closed(&self) -> bool {
        self.0.kind() == io::ErrorKind::BrokenPipe
    }
}

impl fmt::Display for OutputError {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "standard output: {}", self.0)
    }
}

impl std::error::Error for OutputError {}

/// Whether standard output is a terminal: only then are colours and pictures printed.
pub fn is_terminal() -> bool {
    io::stdout().is_terminal()
}

fn print(text: &str) -> Result<()> {
    bytes(format!("{text}\n").as_bytes())
}

/// Writes a file's bytes to standard output.
///
/// # Errors
/// [`OutputError`].
pub fn bytes(bytes: &[u8]) -> Result<()> {
    let mut out = io::stdout().lock();
    Ok(out.write_all(bytes).and_then(|()| out.flush()).map_err(OutputError)?)
}

/// Prints lines, without the characters that would do something else than be read; [`say!`](crate::say) calls it.
///
/// # Errors
/// [`OutputError`].
pub fn lines(text: fmt::Arguments) -> Result<()> {
    print(&escaped_lines(&text.to_string()))
}

/// Prints lines to standard output, as `println!` does; gives a `Result`, so that a full device is no panic.
#[macro_export]
macro_rules! say {
    ($($part:tt)*) => { $crate::terminal::lines(format_args!($($part)*)) };
}

/// Columns of the terminal that tables keep to.
pub const WIDTH: u16 = 80;

/// An empty table that keeps to [`WIDTH`]: cells that are too wide take several lines.
pub fn narrow_table() -> Table {
    let mut table = Table::new();
    table.load_style(UTF8_FULL_CONDENSED).set_content_arrangement(ContentArrangement::Dynamic).set_width(WIDTH);
    table
}

/// Prints a table, with its colours. Cells must not hold text from outside but by [`escaped`](suite::text::escaped).
///
/// # Errors
/// [`OutputError`].
pub fn table(table: &Table) -> Result<()> {
    styled(&table.to_string())
}

/// Prints lines with colours in them, in which all text from outside is escaped already.
///
/// # Errors
/// [`OutputError`].
pub fn styled(text: &str) -> Result<()> {
    print(text)
}

/// Prints one JSON object on a line.
///
/// # Errors
/// [`OutputError`], or where it is none.
pub fn json(value: &impl Serialize) -> Result<()> {
    print(&escaped_json(&serde_json::to_string(value)?))
}

/// Prints one JSON object, laid out over lines.
///
/// # Errors
/// As [`json`].
pub fn json_lines(value: &impl Serialize) -> Result<()> {
    print(&escaped_json(&serde_json::to_string_pretty(value)?))
}

/// How a terminal takes colours.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Colours {
    /// 24 bits.
    True,
    /// A cube of 6 × 6 × 6.
    Cube,
}

/// What a terminal with these variables takes; nothing where it shows no colours. `NO_COLOR`: see no-color.org.
fn colours(term: Option<&str>, colorterm: Option<&str>, no_color: Option<&str>) -> Option<Colours> {
    let plain = term.is_none_or(|term| term.is_empty() || term == "dumb") || no_color.is_some_and(|no| !no.is_empty());
    let cube = if matches!(colorterm, Some("truecolor" | "24bit")) { Colours::True } else { Colours::Cube };
    (!plain).then_some(cube)
}

/// Prints a picture in half blocks, two pixels a character, where standard output is a terminal that shows colours.
///
/// # Errors
/// [`OutputError`].
pub fn show(picture: &Picture) -> Result<()> {
    let variable = |name| std::env::var(name).ok();
    let [term, colorterm, no_color] = ["TERM", "COLORTERM", "NO_COLOR"].map(variable);
    match colours(term.as_deref(), colorterm.as_deref(), no_color.as_deref()).filter(|_| is_terminal()) {
        Some(colours) => print(half_blocks(picture, colours).trim_end_matches('\n')),
        None => Ok(()),
    }
}

/// The picture as lines of half blocks, at most [`COLUMNS`] wide; each of their pixels is the mean of those below it.
fn half_blocks(picture: &Picture, colours: Colours) -> String {
    let columns = COLUMNS.min(picture.width());
    let rows = (picture.height() * columns).div_ceil(picture.width()).next_multiple_of(2);
    let mean = |column: usize, row: usize| {
        let range = |place: usize, of: usize, length: usize| {
            let start = place * length / of;
            start..((place + 1) * length / of).max(start + 1)
        };
        let (xs, ys) = (range(column, columns, picture.width()), range(row, rows, picture.height()));
        let count = xs.len() * ys.len();
        let mut sum = [0; 3];
        for (x, y) in ys.flat_map(|y| xs.clone().map(move |x| (x, y))) {
            for (sum, channel) in sum.iter_mut().zip(picture.pixel(x, y)) {
                *sum += usize::from(channel);
            }
        }
        sum.map(|sum| (sum / count) as u8)
    };
    let code = |[r, g, b]: [u8; 3]| match colours {
        Colours::True => format!("2;{r};{g};{b}"),
        Colours::Cube => {
            let step = |x: u8| (0..6).min_by_key(|&i| CUBE[i].abs_diff(x)).expect("six steps");
            format!("5;{}", 16 + 36 * step(r) + 6 * step(g) + step(b))
        }
    };
    let mut text = String::new();
    for row in (0..rows).step_by(2) {
        for column in 0..columns {
            let (upper, lower) = (code(mean(column, row)), code(mean(column, row + 1)));
            text.push_str(&format!("\u{1b}[38;{upper};48;{lower}m▀"));
        }
        text.push_str("\u{1b}[0m\n");
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_terminals_that_show_colours_are_sent_some() {
        assert_eq!(colours(Some("xterm-256color"), Some("truecolor"), None), Some(Colours::True));
        assert_eq!(colours(Some("xterm"), None, Some("")), Some(Colours::Cube));
        for (term, no_color) in [(Some("dumb"), None), (None, None), (Some(""), None), (Some("xterm"), Some("1"))] {
            assert_eq!(colours(term, Some("truecolor"), no_color), None);
        }
    }

    #[test]
    fn half_blocks_show_means_and_end_each_line_in_plain_colours() {
        let rgb = (0..4).map(|i| if i < 2 { [255, 0, 0] } else { [0, 0, 255] }).collect();
        let picture = Picture::new(2, 2, rgb).expect("four colours");
        let block = "\u{1b}[38;2;255;0;0;48;2;0;0;255m▀";
        assert_eq!(half_blocks(&picture, Colours::True), format!("{block}{block}\u{1b}[0m\n"));
        assert!(half_blocks(&picture, Colours::Cube).starts_with("\u{1b}[38;5;196;48;5;21m▀"));
        let wide = Picture::new(512, 100, vec![[9; 3]; 51_200]).expect("so many colours");
        let text = half_blocks(&wide, Colours::True);
        assert_eq!((text.lines().count(), text.matches('▀').count()), (8, 8 * COLUMNS));
        let pixel = Picture::new(1, 1, vec![[7; 3]]).expect("one colour");
        assert_eq!(half_blocks(&pixel, Colours::Cube).matches('▀').count(), 1);
    }
}
