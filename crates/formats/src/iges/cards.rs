//! The cards of a file: lines of 80 columns, sorted by the letter in column 73.
//!
//! A card's number stands in columns 74 to 80, and pointers of the file are such numbers. Where the numbers of a section do
//! not ascend they are not believed: its cards are counted instead.

/// Columns before the letter.
const LETTER: usize = 72;

/// Columns of a card without line ends.
const CARD: usize = 80;

/// A card of a section.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Card {
    /// The byte at which it begins.
    at: u32,
    pub number: u32,
    /// The line of the file, from 1.
    pub line: u32,
}

/// The sections that are read.
#[derive(Debug)]
pub(super) struct Cards<'b> {
    bytes: &'b [u8],
    pub global: Vec<Card>,
    pub directory: Vec<Card>,
    pub parameters: Vec<Card>,
    /// What is wrong with the cards: the line, and why.
    pub damage: Vec<(usize, String)>,
}

/// Why a file has no cards.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum NoCards {
    Compressed,
    Binary,
    Unknown,
}

/// What the first card says of the file's form.
pub(super) fn form(head: &[u8]) -> Result<(), NoCards> {
    let (line, _) = next_line(head, 0, false);
    match letter(line) {
        Some(b'S') => Ok(()),
        Some(b'C') => Err(NoCards::Compressed),
        Some(b'B') => Err(NoCards::Binary),
        _ => Err(NoCards::Unknown),
    }
}

impl<'b> Cards<'b> {
    /// Sorts the lines of a file.
    ///
    /// # Errors
    /// Where the file is in compressed or binary form, or its first line is no card.
    pub fn new(bytes: &'b [u8]) -> Result<Self, NoCards> {
        form(bytes)?;
        let is_fixed = !bytes[..bytes.len().min(CARD + 1)].iter().any(|b| matches!(b, b'\n' | b'\r'));
        let mut cards = Self { bytes, global: vec![], directory: vec![], parameters: vec![], damage: vec![] };
        let (mut at, mut line, mut section, mut bare, mut end) = (0, 0u32, b'S', 0, None);
        while at < bytes.len() && end.is_none() {
            let (text, next) = next_line(bytes, at, is_fixed);
            line += 1;
            match letter(text) {
                Some(letter) => section = letter,
                None if text.iter().all(|b| *b <= b' ') => {
                    at = next;
                    continue;
                }
                None => {
                    bare += 1;
                    if bare == 1 {
                        let why =
                            format!("no section letter in column 73: taken as a card of section {}", section as char);
                        cards.damage.push((line as usize, why));
                    }
                }
            }
            let number = text.get(LETTER + 1..).map_or(0, |digits| whole(digits).unwrap_or(0));
            let card = Card { at: u32::try_from(at).unwrap_or(u32::MAX), number, line };
            match section {
                b'G' => cards.global.push(card),
                b'D' => cards.directory.push(card),
                b'P' => cards.parameters.push(card),
                b'T' => end = Some((line, text)),
                _ => {}
            }
            at = next;
        }
        if 1 < bare {
            cards.damage.push((line as usize, format!("{bare} lines have no section letter")));
        }
        for (name, section) in [('D', &mut cards.directory), ('P', &mut cards.parameters)] {
            if let Some(k) = (1..section.len()).find(|k| section[*k].number <= section[k - 1].number) {
                let why = format!("the numbers of section {name} do not ascend: its cards are counted");
                cards.damage.push((section[k].line as usize, why));
                section.iter_mut().zip(1..).for_each(|(card, number)| card.number = number);
            }
        }
        cards.check_end(end, line);
        Ok(cards)
    }

    /// Compares the counts of the last card with the cards that are there.
    fn check_end(&mut self, end: Option<(u32, &[u8])>, last: u32) {
        let Some((line, text)) = end else {
            self.damage.push((last as usize, "the file has no last card (section T): it may be cut short".to_owned()));
            return;
        };
        let sections = [('G', 8, self.global.len()), ('D', 16, self.directory.len()), ('P', 24, self.parameters.len())];
        for (name, column, found) in sections {
            let count = text.get(column + 1..column + 8).and_then(whole);
            if let Some(count) = count.filter(|count| *count as usize != found) {
                let why = format!("the last card counts {count} cards in section {name}, which has {found}");
                self.damage.push((line as usize, why));
            }
        }
    }

    /// The first columns of a card, at most `columns` of them.
    pub fn columns(&self, card: Card, columns: usize) -> &'b [u8] {
        let start = (card.at as usize).min(self.bytes.len());
        let text = &self.bytes[start..self.bytes.len().min(start + columns)];
        let length = text.iter().position(|b| matches!(b, b'\n' | b'\r')).unwrap_or(text.len());
        &text[..length]
    }

    /// The first columns of cards one after the other, each filled up with blanks.
    pub fn joined(&self, cards: &[Card], columns: usize) -> Vec<u8> {
        let mut text = Vec::with_capacity(cards.len() * columns);
        for (k, card) in cards.iter().enumerate() {
            text.extend_from_slice(self.columns(*card, columns));
            text.resize((k + 1) * columns, b' ');
        }
        text
    }
}

/// The line that begins at a byte, and where the next one begins.
fn next_line(bytes: &[u8], at: usize, is_fixed: bool) -> (&[u8], usize) {
    let rest = &bytes[at..];
    if is_fixed {
        let length = rest.len().min(CARD);
        return (&rest[..length], at + length);
    }
    let length = rest.iter().position(|b| matches!(b, b'\n' | b'\r')).unwrap_or(rest.len());
    let end = if rest[length..].starts_with(b"\r\n") { 2 } else { 1 };
    (&rest[..length], (at + length + end).min(bytes.len()))
}

/// The letter of a card's section; the first card of other forms of the file has B or C.
fn letter(line: &[u8]) -> Option<u8> {
    let is_number = |rest: &[u8]| rest.iter().all(|b| b.is_ascii_digit() || b.is_ascii_whitespace());
    let letter = *line.get(LETTER)?;
    let rest = &line[LETTER + 1..line.len().min(CARD)];
    (matches!(letter, b'S' | b'G' | b'D' | b'P' | b'T' | b'B' | b'C') && is_number(rest)).then_some(letter)
}

/// A whole number from 0 between blanks.
pub(super) fn whole(text: &[u8]) -> Option<u32> {
    std::str::from_utf8(text.trim_ascii()).ok()?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn card(text: &str, letter: char, number: usize) -> String {
        format!("{text:72}{letter}{number:7}")
    }

    fn three() -> [String; 4] {
        [
            card("", 'S', 1),
            card("1H,,1H;;", 'G', 1),
            card("110,1.;", 'P', 1),
            card("S      1G      1D      0P      1", 'T', 1),
        ]
    }

    #[test]
    fn cards_are_found_whatever_ends_their_lines() {
        for end in ["\n", "\r\n", "\r", ""] {
            let text = three().join(end);
            let cards = Cards::new(text.as_bytes()).unwrap();
            assert_eq!(cards.damage, [], "{end:?}");
            assert_eq!((cards.global.len(), cards.parameters.len()), (1, 1), "{end:?}");
            assert_eq!(cards.joined(&cards.parameters, 9), b"110,1.;  ", "{end:?}");
        }
    }

    #[test]
    fn numbers_that_do_not_ascend_are_counted() {
        let text = [card("", 'S', 1), card("", 'P', 4), card("", 'P', 4), card("", 'P', 4)].join("\n");
        let cards = Cards::new(text.as_bytes()).unwrap();
        assert_eq!(cards.parameters.iter().map(|card| card.number).collect::<Vec<_>>(), [1, 2, 3]);
        assert_eq!(cards.damage.len(), 2, "and there is no last card: {:?}", cards.damage);
    }
}
