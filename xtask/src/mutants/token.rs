//! WGSL cut into tokens: as much of the grammar as mutation operators need.
//!
//! Naga's own lexer is private, and a general one would not know that `<` opens a list in `vec3<f32>` and compares in
//! `t < u`. Comments and white space fall away; an attribute with its arguments is one token.

use std::ops::Range;

/// What a token is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// A name or a keyword.
    Word,
    /// A literal with its suffix.
    Number,
    /// `<` or `>` around the arguments of a type.
    Template,
    /// `@name` or `@name(…)`.
    Attribute,
    /// An operator or a bracket, as long as WGSL reads it.
    Symbol,
}

/// A piece of the source.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Token {
    /// What it is.
    pub kind: Kind,
    /// Where it stands, bytes.
    pub range: Range<usize>,
}

/// Symbols of more than one character, longer ones first.
const LONG_SYMBOLS: &[&str] =
    &["<<=", ">>=", "->", "++", "--", "+=", "-=", "*=", "/=", "%=", "==", "!=", "<=", ">=", "&&", "||", "<<", ">>"];

/// Whether `<` after this word opens a list of type arguments.
fn takes_arguments(word: &str) -> bool {
    ["vec", "mat", "texture_"].iter().any(|start| word.starts_with(start))
        || ["array", "ptr", "atomic", "bitcast", "var"].contains(&word)
}

/// The tokens of a WGSL text that is legal; of another, whatever resembles them.
pub fn tokens(text: &str) -> Vec<Token> {
    let mut tokens: Vec<Token> = vec![];
    let mut lists = 0usize;
    let mut at = 0;
    while let Some(first) = text[at..].chars().next() {
        let rest = &text[at..];
        let run = |keep: fn(char) -> bool| rest.find(|c| !keep(c)).unwrap_or(rest.len());
        let after_type = tokens
            .last()
            .is_some_and(|t| t.kind == Kind::Word && t.range.end == at && takes_arguments(&text[t.range.clone()]));
        let (kind, length) = if first.is_whitespace() {
            at += first.len_utf8();
            continue;
        } else if rest.starts_with("//") {
            at += run(|c| c != '\n');
            continue;
        } else if rest.starts_with("/*") {
            at += rest.find("*/").map_or(rest.len(), |end| end + 2);
            continue;
        } else if first == '@' {
            (Kind::Attribute, attribute(rest))
        } else if first.is_alphabetic() || first == '_' {
            (Kind::Word, run(|c| c.is_alphanumeric() || c == '_'))
        } else if first.is_ascii_digit() {
            (Kind::Number, number(rest))
        } else if first == '<' && after_type {
            lists += 1;
            (Kind::Template, 1)
        } else if first == '>' && lists > 0 {
            lists -= 1;
            (Kind::Template, 1)
        } else {
            let long = LONG_SYMBOLS.iter().find(|symbol| rest.starts_with(**symbol));
            (Kind::Symbol, long.map_or(first.len_utf8(), |symbol| symbol.len()))
        };
        tokens.push(Token { kind, range: at..at + length });
        at += length;
    }
    tokens
}

/// Length of the attribute that the text begins with; its arguments hold no brackets.
fn attribute(text: &str) -> usize {
    let name = text[1..].find(|c: char| !(c.is_alphanumeric() || c == '_')).map_or(text.len(), |end| end + 1);
    if !text[name..].starts_with('(') {
        return name;
    }
    text[name..].find(')').map_or(text.len(), |end| name + end + 1)
}

/// Length of the number that the text begins with: digits, point, exponent, suffix.
fn number(text: &str) -> usize {
    let bytes = text.as_bytes();
    let is_part = |i: usize| match bytes[i] {
        b'+' | b'-' => matches!(bytes[i - 1], b'e' | b'E') && !text.starts_with("0x"),
        byte => byte.is_ascii_alphanumeric() || byte == b'.',
    };
    (1..bytes.len()).find(|&i| !is_part(i)).unwrap_or(bytes.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(text: &str) -> Vec<(Kind, &str)> {
        tokens(text).into_iter().map(|t| (t.kind, &text[t.range])).collect()
    }

    #[test]
    fn angle_brackets_of_types_are_told_from_comparisons_and_shifts() {
        let found = words("var a: array<vec4<f32>, 9>; if (a < b && c >> 8u > d) {}");
        let brackets: Vec<_> = found.into_iter().filter(|(_, text)| text.contains(['<', '>'])).collect();
        let template = |text| (Kind::Template, text);
        let symbol = |text| (Kind::Symbol, text);
        let expected =
            [template("<"), template("<"), template(">"), template(">"), symbol("<"), symbol(">>"), symbol(">")];
        assert_eq!(brackets, expected);
    }

    #[test]
    fn comments_fall_away_and_attributes_and_numbers_are_whole() {
        let found = words("@location(0) @vertex x = 1e-3f - 2u; // y + z\n/* w */ v++");
        let expected = ["@location(0)", "@vertex", "x", "=", "1e-3f", "-", "2u", ";", "v", "++"];
        assert_eq!(found.iter().map(|(_, text)| *text).collect::<Vec<_>>(), expected);
    }
}
