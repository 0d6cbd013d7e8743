//! Strings of a STEP file as text: ISO 10303-21, clause 6.4.3, and what is found beside it.
//!
//! | in the file | is |
//! | --- | --- |
//! | `''`, `\\` | one of the two |
//! | `\S\c` | the character 128 places behind `c` in ISO 8859-1 |
//! | `\X\hh` | the character of that number, two hexadecimal digits |
//! | `\X2\hhhh…\X0\` | UTF-16, four digits a unit |
//! | `\X4\hhhhhhhh…\X0\` | UTF-32, eight digits a character |
//! | ends of lines | nothing: they are no part of a string |
//! | bytes from 128 on | UTF-8 where all of the string is, else ISO 8859-1 |
//!
//! What is none of this stays as it stands in the file, also `\P?\` with pages other than ISO 8859-1 and their `\S\`.

/// The text of a string, given by the bytes between its quotation marks.
pub(super) fn decode(bytes: &[u8]) -> String {
    // Directives are ASCII, so that they stay what they are either way.
    let text = match std::str::from_utf8(bytes) {
        Ok(text) => text.to_owned(),
        Err(_) => bytes.iter().map(|byte| char::from(*byte)).collect(),
    };
    let mut decoded = String::with_capacity(text.len());
    let mut rest = text.as_str();
    let mut is_latin = true;
    while let Some(first) = rest.chars().next() {
        let (found, length) = match first {
            '\r' | '\n' => (Some(String::new()), 1),
            '\'' if rest.starts_with("''") => (Some("'".to_owned()), 2),
            '\\' => directive(rest, &mut is_latin),
            _ => (None, 0),
        };
        match found {
            Some(found) => {
                decoded += &found;
                rest = &rest[length..];
            }
            None => {
                decoded.push(first);
                rest = &rest[first.len_utf8()..];
            }
        }
    }
    decoded
}

/// What a directive at the start of a text stands for, and its length; `None` where it makes no sense.
fn directive(text: &str, is_latin: &mut bool) -> (Option<String>, usize) {
    if text.starts_with(r"\\") {
        return (Some(r"\".to_owned()), 2);
    }
    if let Some(page) = text.strip_prefix(r"\P") {
        let mut rest = page.chars();
        if let (Some(page @ 'A'..='I'), Some('\\')) = (rest.next(), rest.next()) {
            *is_latin = page == 'A';
            return (Some(if *is_latin { String::new() } else { text[..4].to_owned() }), 4);
        }
    }
    if let Some(rest) = text.strip_prefix(r"\S\") {
        let shifted = rest.chars().next().filter(|c| *is_latin && matches!(c, ' '..='~'));
        return (shifted.map(|c| char::from(c as u8 | 0x80).to_string()), 4);
    }
    if let Some(rest) = text.strip_prefix(r"\X\") {
        let byte = rest.get(..2).and_then(hexadecimal);
        return (byte.and_then(char::from_u32).map(String::from), 5);
    }
    for (start, digits) in [(r"\X2\", 4), (r"\X4\", 8)] {
        let Some(rest) = text.strip_prefix(start) else { continue };
        let Some((body, _)) = rest.split_once(r"\X0\") else { continue };
        let units: Option<Vec<u32>> = body.as_bytes().chunks(digits).map(|unit| unit_of(unit, digits)).collect();
        let decoded = units.and_then(|units| match digits {
            4 => String::from_utf16(&units.iter().map(|unit| *unit as u16).collect::<Vec<_>>()).ok(),
            _ => units.into_iter().map(char::from_u32).collect(),
        });
        return (decoded, start.len() + body.len() + r"\X0\".len());
    }
    (None, 0)
}

fn unit_of(digits: &[u8], count: usize) -> Option<u32> {
    std::str::from_utf8(digits).ok().filter(|text| text.len() == count).and_then(hexadecimal)
}

fn hexadecimal(digits: &str) -> Option<u32> {
    let is_plain = digits.bytes().all(|byte| byte.is_ascii_hexdigit());
    is_plain.then(|| u32::from_str_radix(digits, 16).ok()).flatten()
}

#[cfg(test)]
mod tests {
    use super::decode;

    #[test]
    fn strings_are_decoded_as_the_standard_says() {
        let cases: [(&[u8], &str); 12] = [
            (b"plain 'x", "plain 'x"),
            (b"it''s", "it's"),
            (br"C:\\parts", r"C:\parts"),
            (br"Tr\X\E4ger", "Träger"),
            (br"\X2\00530074006F00DF\X0\fl\X2\00E4\X0\che", "Stoßfläche"),
            (br"\X2\4E2D6587\X0\", "中文"),
            (br"\X2\D83DDE00\X0\", "😀"),
            (br"\X4\0001F6000000004E\X0\", "😀N"),
            // ISO 8859-1: 'd' is 64 hexadecimal, E4 is an ä.
            (br"Tr\S\dger", "Träger"),
            (br"\PA\\S\|", "ü"),
            (b"two\r\nlines", "twolines"),
            ("Träger 面".as_bytes(), "Träger 面"),
        ];
        for (bytes, expected) in cases {
            assert_eq!(decode(bytes), expected, "{}", bytes.escape_ascii());
        }
        assert_eq!(decode(b"Tr\xe4ger"), "Träger", "Latin-1 as it is found");
    }

    #[test]
    fn what_makes_no_sense_stays_as_it_stands() {
        let cases = [
            r"\X2\00E4",
            r"\X2\00E\X0\",
            r"\X2\D83D\X0\",
            r"\X4\00110000\X0\",
            r"\X\G1",
            r"\X\e",
            r"\X\+1",
            r"\S\",
            r"\Q",
            r"\",
            r"\PC\\S\d",
            r"\X2\é\X0\",
            r"\X\é",
        ];
        for text in cases {
            assert_eq!(decode(text.as_bytes()), text);
        }
    }
}
