//! A WGSL text by its tokens: brackets, primary expressions, functions and declarations, and how edits are put into it.

use crate::mutants::token::{Kind, Token, tokens};
use std::ops::Range;

/// Words that begin no expression and name nothing.
const KEYWORDS: &[&str] =
    &["if", "else", "for", "while", "loop", "return", "switch", "let", "var", "const", "break_if"];

/// A text with its tokens.
pub struct Text<'t> {
    /// It.
    pub text: &'t str,
    /// Its tokens.
    pub tokens: Vec<Token>,
}

/// Something written in another way: what is replaced, bytes, and by what.
pub type Edit = (Range<usize>, String);

impl<'t> Text<'t> {
    /// Cuts a text.
    pub fn new(text: &'t str) -> Self {
        Self { text, tokens: tokens(text) }
    }

    /// Token `i` as it stands there; nothing beyond the last.
    pub fn word(&self, i: usize) -> &'t str {
        self.tokens.get(i).map_or("", |token| &self.text[token.range.clone()])
    }

    /// What token `i` is.
    pub fn kind(&self, i: usize) -> Option<Kind> {
        self.tokens.get(i).map(|token| token.kind)
    }

    /// The text of some tokens.
    pub fn between(&self, tokens: Range<usize>) -> &'t str {
        if tokens.is_empty() { "" } else { &self.text[self.bytes(tokens)] }
    }

    /// Where some tokens stand, at least one.
    pub fn bytes(&self, tokens: Range<usize>) -> Range<usize> {
        self.tokens[tokens.start].range.start..self.tokens[tokens.end - 1].range.end
    }

    /// The token that closes the bracket at `open`.
    pub fn closing(&self, open: usize) -> Option<usize> {
        let mut depth = 0;
        (open..self.tokens.len()).find(|&i| {
            depth += depth_of(self.word(i));
            depth == 0
        })
    }

    /// The token that opens the bracket at `close`.
    fn opening(&self, close: usize) -> Option<usize> {
        let mut depth = 0;
        (0..=close).rev().find(|&i| {
            depth -= depth_of(self.word(i));
            depth == 0
        })
    }

    fn is_name(&self, i: usize) -> bool {
        self.kind(i) == Some(Kind::Word) && !KEYWORDS.contains(&self.word(i))
    }

    /// One past the primary expression that begins at token `start`: a name, a literal or a bracket, and what follows it at once.
    pub fn primary_end(&self, start: usize) -> Option<usize> {
        let mut end = match self.word(start) {
            "(" => self.closing(start)? + 1,
            _ if self.kind(start) == Some(Kind::Number) || self.is_name(start) => start + 1,
            _ => return None,
        };
        if self.word(end) == "<" && self.kind(end) == Some(Kind::Template) {
            let mut lists = 0;
            end = 1
                + (end..self.tokens.len()).find(|&i| {
                    if self.kind(i) == Some(Kind::Template) {
                        lists += if self.word(i) == "<" { 1 } else { -1 };
                    }
                    lists == 0
                })?;
        }
        loop {
            match self.word(end) {
                "." => end += 2,
                "[" => end = self.closing(end)? + 1,
                "(" if self.kind(end - 1) != Some(Kind::Number) && self.word(end - 1) != ")" => {
                    end = self.closing(end)? + 1;
                }
                _ => return Some(end),
            }
        }
    }

    /// Where the primary expression begins that ends before token `end`.
    pub fn primary_start(&self, end: usize) -> Option<usize> {
        // Of a chain of calls, indices and members, the beginning.
        let mut start = end.checked_sub(1)?;
        loop {
            match self.word(start) {
                ")" | "]" => {
                    let bracket = self.word(start);
                    start = self.opening(start)?;
                    let before = start.checked_sub(1)?;
                    if self.kind(before) == Some(Kind::Template) && self.word(before) == ">" {
                        let list =
                            (0..before).rev().find(|&i| self.kind(i) == Some(Kind::Word) && self.word(i + 1) == "<")?;
                        start = list;
                    } else if self.is_name(before) || (bracket == "]" && [")", "]"].contains(&self.word(before))) {
                        start = before;
                        continue;
                    }
                }
                _ if self.kind(start) == Some(Kind::Number) || self.is_name(start) => {}
                _ => return None,
            }
            match start.checked_sub(1) {
                Some(before) if self.word(before) == "." => start = before.checked_sub(1)?,
                _ => break,
            }
        }
        // What was found must end there, read forward.
        (self.primary_end(start) == Some(end)).then_some(start)
    }

    /// The tokens between the brackets of each function's body.
    pub fn bodies(&self) -> Vec<Range<usize>> {
        let functions = (0..self.tokens.len()).filter(|&i| self.word(i) == "fn");
        let body = |i: usize| {
            let open = (i..self.tokens.len()).find(|&k| self.word(k) == "{")?;
            Some(open + 1..self.closing(open)?)
        };
        functions.filter_map(body).collect()
    }

    /// The tokens of each declaration of the module, in their order.
    pub fn declarations(&self) -> Vec<Range<usize>> {
        let (mut found, mut start, mut depth) = (vec![], 0, 0);
        for i in 0..self.tokens.len() {
            depth += depth_of(self.word(i));
            if depth == 0 && [";", "}"].contains(&self.word(i)) {
                found.push(start..i + 1);
                start = i + 1;
            }
        }
        found
    }
}

fn depth_of(word: &str) -> i32 {
    match word {
        "(" | "[" | "{" => 1,
        ")" | "]" | "}" => -1,
        _ => 0,
    }
}

/// The text with edits put in; of two that overlap the first in `edits` stays.
pub fn edited(text: &str, edits: &[Edit]) -> String {
    let mut kept: Vec<&Edit> = vec![];
    for edit in edits {
        let apart = |other: &&Edit| edit.0.end <= other.0.start || other.0.end <= edit.0.start;
        if kept.iter().all(apart) {
            kept.push(edit);
        }
    }
    kept.sort_by_key(|(range, _)| range.start);
    let (mut out, mut copied) = (String::new(), 0);
    for (range, replacement) in kept {
        out += &text[copied..range.start];
        out += replacement;
        copied = range.end;
    }
    out + &text[copied..]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_primary_expression_is_found_from_either_end() {
        let text = Text::new("return (a).b * vec3<f32>(c, d[e + f]) + (*p)[g].h * 2.0;");
        let product = |n: usize| (0..text.tokens.len()).filter(|&i| text.word(i) == "*").nth(n).expect("a product");
        let sides = |at: usize| {
            let (start, end) = (text.primary_start(at).expect("left"), text.primary_end(at + 1).expect("right"));
            (text.between(start..at), text.between(at + 1..end))
        };
        assert_eq!(sides(product(0)), ("(a).b", "vec3<f32>(c, d[e + f])"));
        assert_eq!(sides(product(2)), ("(*p)[g].h", "2.0"));
        assert_eq!(text.primary_start(product(1)), None, "a pointer's star has nothing on its left");
    }

    #[test]
    fn of_overlapping_edits_the_first_stays() {
        assert_eq!(edited("abcdef", &[(3..5, "X".into()), (0..1, "Y".into()), (4..6, "Z".into())]), "YbcXf");
    }
}
