//! The statements of a file: its lines without comments, those that are continued put together.

use std::borrow::Cow;

/// A statement.
#[derive(Debug, PartialEq)]
pub(super) struct Statement<'a> {
    /// The line on which it begins, from 1.
    pub line: usize,
    /// Not blank. Bytes that are not UTF-8 are replaced: only names and comments have them.
    pub text: Cow<'a, str>,
}

/// The statements of a text, in order.
pub(super) struct Statements<'a> {
    rest: &'a [u8],
    line: usize,
}

impl<'a> Statements<'a> {
    pub fn new(text: &'a [u8]) -> Self {
        Self { rest: text, line: 0 }
    }

    /// The next line without its end and its comment; a comment begins a line or follows a blank.
    fn line(&mut self) -> Option<&'a [u8]> {
        if self.rest.is_empty() {
            return None;
        }
        self.line += 1;
        let end = self.rest.iter().position(|b| *b == b'\n').unwrap_or(self.rest.len());
        let line = &self.rest[..end];
        self.rest = &self.rest[(end + 1).min(self.rest.len())..];
        let is_comment = |k: &usize| line[*k] == b'#' && (*k == 0 || line[*k - 1].is_ascii_whitespace());
        let end = (0..line.len()).find(is_comment).unwrap_or(line.len());
        Some(line[..end].trim_ascii_end())
    }
}

impl<'a> Iterator for Statements<'a> {
    type Item = Statement<'a>;

    fn next(&mut self) -> Option<Statement<'a>> {
        loop {
            let first = self.line()?;
            let line = self.line;
            let text = match first.strip_suffix(b"\\") {
                None => String::from_utf8_lossy(first),
                Some(start) => {
                    let mut whole = start.to_vec();
                    while let Some(more) = self.line() {
                        whole.push(b' ');
                        let part = more.strip_suffix(b"\\");
                        whole.extend(part.unwrap_or(more));
                        if part.is_none() {
                            break;
                        }
                    }
                    Cow::Owned(String::from_utf8_lossy(&whole).into_owned())
                }
            };
            if !text.trim().is_empty() {
                return Some(Statement { line, text });
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_continued_and_comments_left_away() {
        let text = b"# v 0 0 0\r\n\nv 1 2 \\\r\n 3 # here\ng a#b\ncurv2 1 \\\n\\\n2\n  \nend\\";
        let all: Vec<(usize, String)> =
            Statements::new(text).map(|s| (s.line, s.text.split_whitespace().collect::<Vec<_>>().join(" "))).collect();
        let expected = [(3, "v 1 2 3"), (5, "g a#b"), (6, "curv2 1 2"), (10, "end")];
        assert_eq!(all, expected.map(|(line, text)| (line, text.to_owned())));
    }

    #[test]
    fn names_need_not_be_utf8() {
        let all: Vec<Statement> = Statements::new(b"g caf\xe9\nend").collect();
        assert_eq!(all[0].text, "g caf\u{fffd}");
        assert_eq!(all.len(), 2);
    }
}
