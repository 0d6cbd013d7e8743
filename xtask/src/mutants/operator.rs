//! Mutation operators: where in a WGSL text something small may be changed, and into what.
//!
//! The operators are those of mutation testing for C-like languages (Agrawal et al. 1989; King & Offutt 1991): of
//! arithmetic, relations, logic, constants, variables of one type, statements, returned values; with those of shaders
//! added: components, and the two parameters exchanged.

use super::token::{Kind, Token, tokens};
use std::ops::Range;

/// A place and what may be put there.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Site {
    /// The operator's name.
    pub operator: &'static str,
    /// The function, or the constant, that holds it.
    pub function: String,
    /// What is replaced, bytes.
    pub range: Range<usize>,
    /// By what: the first that is legal.
    pub replacements: Vec<String>,
}

/// Words that no variable is called.
const KEYWORDS: &[&str] = &[
    "let", "var", "const", "if", "else", "for", "while", "loop", "return", "switch", "case", "default", "break",
    "continue", "discard", "true", "false", "fn", "struct",
];

/// Functions that give the same whichever way round their first two arguments are.
const SYMMETRIC: &[&str] = &["dot", "dot3", "min", "max", "select"];

/// Functions without which their argument stays.
const UNARY: &[&str] = &["sqrt", "abs", "floor", "normalize", "clamp01"];

/// Every site of a text.
pub fn sites(text: &str) -> Vec<Site> {
    let tokens = tokens(text);
    let mut sites = vec![];
    let mut at = 0;
    while at < tokens.len() {
        let word = |i: usize| tokens.get(i).map_or("", |t: &Token| &text[t.range.clone()]);
        match word(at) {
            "fn" => {
                let open = (at..tokens.len()).find(|&i| word(i) == "{").unwrap_or(tokens.len());
                let close = closing(text, &tokens, open);
                let returned = (at..open).find(|&i| word(i) == "->");
                let returned = returned.filter(|&i| i + 1 < open).map(|i| {
                    let skip = usize::from(tokens[i + 1].kind == Kind::Attribute);
                    text[tokens[i + 1 + skip].range.start..tokens[open].range.start].trim()
                });
                let scope = Scope { text, tokens: &tokens, name: word(at + 1), header: at + 2, body: open + 1..close };
                scope.collect(returned, &mut sites);
                at = close;
            }
            "const" => {
                let end = (at..tokens.len()).find(|&i| word(i) == ";").unwrap_or(tokens.len());
                let start = (at..end).find(|&i| word(i) == "=").map_or(end, |i| i + 1);
                let scope = Scope { text, tokens: &tokens, name: word(at + 1), header: at, body: start..end };
                (start..end).for_each(|i| scope.at_token(i, &mut sites));
                at = end;
            }
            _ if tokens[at].kind == Kind::Attribute && word(at) == "@interpolate(perspective)" => {
                sites.push(Site {
                    operator: "interpolation",
                    function: String::new(),
                    range: tokens[at].range.clone(),
                    replacements: vec!["@interpolate(linear)".to_owned()],
                });
            }
            _ => {}
        }
        at += 1;
    }
    sites
}

/// The bracket that closes the one at `open`.
fn closing(text: &str, tokens: &[Token], open: usize) -> usize {
    let mut depth = 0;
    for i in open..tokens.len() {
        match &text[tokens[i].range.clone()] {
            "(" | "[" | "{" => depth += 1,
            ")" | "]" | "}" => depth -= 1,
            _ => {}
        }
        if depth == 0 {
            return i;
        }
    }
    tokens.len()
}

/// A function's body or a constant's value.
struct Scope<'a> {
    text: &'a str,
    tokens: &'a [Token],
    name: &'a str,
    /// First token of the parameters.
    header: usize,
    body: Range<usize>,
}

impl<'a> Scope<'a> {
    fn word(&self, i: usize) -> &'a str {
        self.tokens.get(i).map_or("", |t| &self.text[t.range.clone()])
    }

    fn kind(&self, i: usize) -> Option<Kind> {
        self.tokens.get(i).map(|t| t.kind)
    }

    /// The text from one token to before another.
    fn between(&self, start: usize, end: usize) -> &'a str {
        if start >= end {
            return "";
        }
        &self.text[self.tokens[start].range.start..self.tokens[end - 1].range.end]
    }

    fn push(&self, sites: &mut Vec<Site>, operator: &'static str, tokens: Range<usize>, replacements: &[String]) {
        let range = self.tokens[tokens.start].range.start..self.tokens[tokens.end - 1].range.end;
        let replacements = replacements.to_vec();
        sites.push(Site { operator, function: self.name.to_owned(), range, replacements });
    }

    fn one(&self, sites: &mut Vec<Site>, operator: &'static str, tokens: Range<usize>, replacement: &str) {
        self.push(sites, operator, tokens, &[replacement.to_owned()]);
    }

    /// All sites of a function that returns a value of type `returned`.
    fn collect(&self, returned: Option<&str>, sites: &mut Vec<Site>) {
        self.statements(returned, sites);
        for i in self.body.clone() {
            self.at_token(i, sites);
            self.at_variable(i, sites);
        }
    }

    /// Statements left out, and returned values replaced by the zero value of their type.
    fn statements(&self, returned: Option<&str>, sites: &mut Vec<Site>) {
        let mut depth = 0usize;
        let mut starts = true;
        for i in self.body.clone() {
            let word = self.word(i);
            let is_assignment = self.kind(i) == Some(Kind::Word) && !KEYWORDS.contains(&word);
            if starts && depth == 0 && (is_assignment || word == "return") {
                let end = (i..self.body.end).find(|&j| self.word(j) == ";");
                match (end, returned) {
                    (Some(end), _) if is_assignment => self.one(sites, "statement removed", i..end + 1, ""),
                    (Some(end), Some(returned)) => {
                        self.one(sites, "returned value", i + 1..end, &format!("{returned}()"));
                    }
                    _ => {}
                }
            }
            match word {
                "(" | "[" => depth += 1,
                ")" | "]" => depth -= 1,
                _ => {}
            }
            starts = [";", "{", "}"].contains(&word);
        }
    }

    /// What may be changed at a token alone.
    fn at_token(&self, i: usize, sites: &mut Vec<Site>) {
        let word = self.word(i);
        match self.kind(i) {
            Some(Kind::Number) => {
                constants(word).iter().for_each(|text| self.one(sites, "constant", i..i + 1, text));
            }
            Some(Kind::Symbol) => self.at_symbol(i, sites),
            Some(Kind::Word) => self.at_word(i, sites),
            _ => {}
        }
    }

    fn at_symbol(&self, i: usize, sites: &mut Vec<Site>) {
        let word = self.word(i);
        let before = self.word(i.wrapping_sub(1));
        let after_value = matches!(self.kind(i.wrapping_sub(1)), Some(Kind::Word | Kind::Number))
            && !KEYWORDS.contains(&before)
            || [")", "]"].contains(&before);
        if word == "-" && !after_value {
            self.one(sites, "sign", i..i + 1, "");
        }
        if word == "!" {
            self.one(sites, "logic", i..i + 1, "");
        }
        if word == "[" && after_value {
            let close = closing(self.text, self.tokens, i);
            // A literal index is changed as a constant.
            if close > i + 2 || self.kind(i + 1) != Some(Kind::Number) {
                let index = self.between(i + 1, close);
                self.one(sites, "index", i + 1..close, &format!("{index} + 1u"));
            }
        }
        if !after_value {
            return;
        }
        let (operator, others): (_, &[&str]) = match word {
            "+" => ("arithmetic", &["-"]),
            "-" => ("arithmetic", &["+"]),
            "*" => ("arithmetic", &["/"]),
            "/" | "%" => ("arithmetic", &["*"]),
            "+=" => ("arithmetic", &["-="]),
            "-=" => ("arithmetic", &["+="]),
            "++" => ("step", &[" += 2u"]),
            "<<" => ("arithmetic", &[">>"]),
            ">>" => ("arithmetic", &["<<"]),
            "<" => ("relation", &["<=", ">="]),
            "<=" => ("relation", &["<", ">"]),
            ">" => ("relation", &[">=", "<="]),
            ">=" => ("relation", &[">", "<"]),
            "==" => ("relation", &["!="]),
            "!=" => ("relation", &["=="]),
            "&&" => ("logic", &["||"]),
            "||" => ("logic", &["&&"]),
            "&" => ("logic", &["|"]),
            "|" => ("logic", &["&"]),
            _ => return,
        };
        others.iter().for_each(|other| self.one(sites, operator, i..i + 1, other));
    }

    fn at_word(&self, i: usize, sites: &mut Vec<Site>) {
        let word = self.word(i);
        if self.word(i.wrapping_sub(1)) == "." {
            let others = components(word);
            if !others.is_empty() {
                self.push(sites, "component", i..i + 1, &others);
            }
            return;
        }
        match word {
            "true" => self.one(sites, "logic", i..i + 1, "false"),
            "false" => self.one(sites, "logic", i..i + 1, "true"),
            "if" | "while" if self.word(i + 1) == "(" => {
                let close = closing(self.text, self.tokens, i + 1);
                self.one(sites, "condition", i + 2..close, "false");
                if word == "if" {
                    self.one(sites, "condition", i + 2..close, "true");
                }
            }
            _ => {}
        }
        let open = if self.word(i + 1) == "(" { Some(i + 1) } else { self.after_type_arguments(i) };
        let Some(open) = open.filter(|_| !KEYWORDS.contains(&word)) else { return };
        match word {
            "min" => self.one(sites, "function", i..i + 1, "max"),
            "max" => self.one(sites, "function", i..i + 1, "min"),
            _ if UNARY.contains(&word) => self.one(sites, "function", i..i + 1, ""),
            _ => {}
        }
        let arguments = self.arguments(open);
        if let ([a, b, ..], false) = (&arguments[..], SYMMETRIC.contains(&word)) {
            let (first, second) = (self.between(a.start, a.end), self.between(b.start, b.end));
            if first != second {
                self.one(sites, "arguments", a.start..b.end, &format!("{second}, {first}"));
            }
        }
        if word == "select" && arguments.len() == 3 {
            let [a, b] = [&arguments[0], &arguments[1]];
            let swapped = format!("{}, {}", self.between(b.start, b.end), self.between(a.start, a.end));
            self.one(sites, "select", a.start..b.end, &swapped);
        }
    }

    /// The bracket after `vec2<f32>` and the like.
    fn after_type_arguments(&self, i: usize) -> Option<usize> {
        if self.kind(i + 1) != Some(Kind::Template) || self.word(i + 1) != "<" {
            return None;
        }
        let mut depth = 0usize;
        for j in i + 1..self.body.end {
            match (self.kind(j), self.word(j)) {
                (Some(Kind::Template), "<") => depth += 1,
                (Some(Kind::Template), _) => depth -= 1,
                _ => {}
            }
            if depth == 0 {
                return Some(j + 1).filter(|&next| self.word(next) == "(");
            }
        }
        None
    }

    /// The arguments within a pair of brackets, as ranges of tokens.
    fn arguments(&self, open: usize) -> Vec<Range<usize>> {
        let close = closing(self.text, self.tokens, open);
        let (mut arguments, mut start, mut depth) = (vec![], open + 1, 0usize);
        for i in open + 1..close {
            match self.word(i) {
                "(" | "[" => depth += 1,
                ")" | "]" => depth -= 1,
                "<" if self.kind(i) == Some(Kind::Template) => depth += 1,
                ">" if self.kind(i) == Some(Kind::Template) => depth -= 1,
                "," if depth == 0 => {
                    arguments.push(start..i);
                    start = i + 1;
                }
                _ => {}
            }
        }
        arguments.push(start..close);
        arguments.retain(|argument| !argument.is_empty());
        arguments
    }

    /// A variable replaced by another of its type: by its counterpart in the other parameter, else by the one declared
    /// nearest to it. Which are of its type, the compiler says.
    fn at_variable(&self, i: usize, sites: &mut Vec<Site>) {
        let word = self.word(i);
        let previous = self.word(i.wrapping_sub(1));
        if self.kind(i) != Some(Kind::Word) || [".", "let", "var", "const", "->"].contains(&previous) {
            return;
        }
        let locals = self.locals(i);
        let Some(own) = locals.iter().position(|name| *name == word) else { return };
        let mut others: Vec<(usize, &str)> = locals
            .iter()
            .enumerate()
            .filter(|(_, name)| **name != word)
            .map(|(k, name)| (k.abs_diff(own), *name))
            .collect();
        others.sort_by_key(|&(distance, name)| (counterpart(word).as_deref() != Some(name), distance));
        others.dedup_by_key(|(_, name)| *name);
        let names: Vec<String> = others.into_iter().map(|(_, name)| name.to_owned()).collect();
        if !names.is_empty() {
            self.push(sites, "variable", i..i + 1, &names);
        }
    }

    /// Parameters and variables declared before a token, in order.
    fn locals(&self, before: usize) -> Vec<&'a str> {
        let declared = |i: &usize| {
            let previous = self.word(i - 1);
            if *i < self.body.start {
                return self.word(i + 1) == ":" && (previous == "(" || previous == ",");
            }
            ["let", "var"].contains(&previous)
        };
        (self.header..before).filter(declared).map(|i| self.word(i)).collect()
    }
}

/// What a literal becomes.
fn constants(literal: &str) -> Vec<String> {
    let suffix = if literal.starts_with("0x") {
        ""
    } else {
        literal.trim_start_matches(|c: char| !matches!(c, 'u' | 'i' | 'f' | 'h'))
    };
    let digits = literal.trim_end_matches(suffix);
    if let Ok(whole) = digits.parse::<u64>() {
        return match whole {
            1 => vec![format!("0{suffix}"), format!("2{suffix}")],
            _ => vec![format!("{}{suffix}", whole + 1)],
        };
    }
    match digits.parse::<f64>() {
        Ok(0.0) => vec![format!("1.0{suffix}")],
        Ok(1.0) => vec![format!("0.0{suffix}"), format!("2.0{suffix}")],
        Ok(0.5) => vec![format!("1.0{suffix}")],
        Ok(x) => vec![format!("{:?}{suffix}", x * 0.5)],
        Err(_) => vec![],
    }
}

/// What the components or the member after a point become.
fn components(word: &str) -> Vec<String> {
    if !word.is_empty() && word.chars().all(|c| "xyzw".contains(c)) {
        let mut letters: Vec<char> = word.chars().collect();
        if letters.len() > 1 {
            letters.swap(0, 1);
            return vec![letters.into_iter().collect()];
        }
        let others = match letters[0] {
            'x' => "yz",
            'y' => "xz",
            'z' => "xy",
            _ => "xy",
        };
        return others.chars().map(String::from).collect();
    }
    let other = match word {
        "suv" => Some("suu".to_owned()),
        "value" => Some("first".to_owned()),
        "first" => Some("second".to_owned()),
        "second" => Some("first".to_owned()),
        _ => counterpart(word),
    };
    other.into_iter().collect()
}

/// The same word of the other parameter: `span_u` and `span_v`, `p` and `q`.
fn counterpart(word: &str) -> Option<String> {
    match word {
        "p" => return Some("q".to_owned()),
        "q" => return Some("p".to_owned()),
        "uv" => return None,
        _ => {}
    }
    let exchange = |c: char| match c {
        'u' => 'v',
        'v' => 'u',
        other => other,
    };
    let tail = word.rfind('_').map_or(0, |at| at + 1);
    let (head, last) = word.split_at(tail);
    let is_parameter = |part: &str| part.trim_start_matches(['s', 'n']).chars().all(|c| c == 'u' || c == 'v');
    if is_parameter(last) && !last.trim_start_matches(['s', 'n']).is_empty() {
        return Some(head.to_owned() + &last.chars().map(exchange).collect::<String>());
    }
    let (first, rest) = word.split_at(word.find('_')?);
    (is_parameter(first) && !first.trim_start_matches(['s', 'n']).is_empty())
        .then(|| first.chars().map(exchange).collect::<String>() + rest)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Each changed text of the line in braces.
    fn changed(body: &str) -> Vec<String> {
        let text = format!("fn f(u: f32, v: f32, d: D) -> f32 {{ {body} }}");
        let apply = |site: Site| {
            let changed = [&text[..site.range.start], &site.replacements[0], &text[site.range.end..]].concat();
            changed.split_once("{ ").and_then(|(_, rest)| rest.rsplit_once(" }")).map(|(body, _)| body.to_owned())
        };
        sites(&text).into_iter().filter_map(apply).collect()
    }

    #[test]
    fn every_operator_applies_where_it_should_and_nowhere_else() {
        let found = changed("return -u;");
        assert_eq!(found, ["return f32();", "return u;", "return -v;"]);
        let found = changed("v = a[i] * 0.5;");
        assert_eq!(found, ["", "u = a[i] * 0.5;", "v = a[i + 1u] * 0.5;", "v = a[i] / 0.5;", "v = a[i] * 1.0;"]);
        let found = changed("if (a.x < 1u) { x = select(b, c, true); }");
        let expected = [
            "if (a.x < 1u) {  }",
            "if (false) { x = select(b, c, true); }",
            "if (true) { x = select(b, c, true); }",
            "if (a.y < 1u) { x = select(b, c, true); }",
            "if (a.x <= 1u) { x = select(b, c, true); }",
            "if (a.x >= 1u) { x = select(b, c, true); }",
            "if (a.x < 0u) { x = select(b, c, true); }",
            "if (a.x < 2u) { x = select(b, c, true); }",
            "if (a.x < 1u) { x = select(c, b, true); }",
            "if (a.x < 1u) { x = select(b, c, false); }",
        ];
        assert_eq!(found, expected);
        let found = changed("let n = cross(d.su, w);");
        assert_eq!(found, ["let n = cross(w, d.su);", "let n = cross(v.su, w);", "let n = cross(d.sv, w);"]);
    }

    #[test]
    fn counterparts_exchange_the_parameters() {
        for (word, other) in
            [("span_u", "span_v"), ("nu", "nv"), ("a_uu", "a_vv"), ("su_squared", "sv_squared"), ("p", "q")]
        {
            assert_eq!(counterpart(word).as_deref(), Some(other));
        }
        for word in ["n", "saved", "value", "sum", "run"] {
            assert_eq!(counterpart(word), None, "{word}");
        }
    }
}
