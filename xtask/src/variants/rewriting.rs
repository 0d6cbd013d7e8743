//! Ways to write a piece of a program differently that leave its meaning as WGSL has it.
//!
//! A rule looks at the tokens alone and proposes; where it proposes what is no WGSL (−(b − a) of unsigned numbers, 1.0 times an
//! integer), the program does not compile, and the proposal is dropped. What compiles means the same: operands of + and ×
//! change sides, a difference is turned round, a factor of 1 is added, two products become a scalar product, a comparison is
//! read from the right, conditions are negated and branches swapped, loops are written as `loop`, their first turn unrolled,
//! an assignment under a condition becomes a `select`, and there is code that never runs.

use super::text::{Edit, Text};
use crate::mutants::token::Kind;
use std::ops::Range;

/// Before a sum or a difference that may change: what binds it to nothing on its left.
const OPEN: &[&str] = &["(", ",", "=", "return", "["];

/// After it.
const CLOSED: &[&str] = &[")", ",", ";", "]"];

/// Proposals about statements.
pub fn statements(text: &Text) -> Vec<Edit> {
    let mut edits = vec![];
    for (number, body) in text.bodies().into_iter().enumerate() {
        let at = text.tokens[body.start - 1].range.end;
        edits.push((at..at, format!(" var idle_{number} = 0u; if (idle_{number} > 1u) {{ idle_{number} = 3u; }} ")));
        for i in body {
            let word = text.word(i);
            let edit = match word {
                "if" => branch(text, i).into_iter().chain(selected(text, i)).collect(),
                "while" => as_loop(text, i).into_iter().collect(),
                "for" => counted(text, i),
                "let" => vec![(text.bytes(i..i + 1), "var".to_owned())],
                _ => vec![],
            };
            edits.extend(edit);
        }
    }
    edits
}

/// The condition in brackets behind token `at`, and the block behind it.
fn condition(text: &Text, at: usize) -> Option<(Range<usize>, Range<usize>)> {
    let close = (text.word(at + 1) == "(").then(|| text.closing(at + 1))??;
    let end = (text.word(close + 1) == "{").then(|| text.closing(close + 1))??;
    Some((at + 2..close, close + 2..end))
}

/// `if (c) {A} else {B}` as `if (!(c)) {B} else {A}`.
fn branch(text: &Text, at: usize) -> Option<Edit> {
    let (condition, accept) = condition(text, at)?;
    let mut end = accept.end + 1;
    let mut reject = "";
    if text.word(end) == "else" {
        let close = (text.word(end + 1) == "{").then(|| text.closing(end + 1))??;
        reject = text.between(end + 2..close);
        end = close + 1;
    }
    let (condition, accept) = (text.between(condition), text.between(accept));
    Some((text.bytes(at..end), format!("if (!({condition})) {{ {reject} }} else {{ {accept} }}")))
}

/// `if (c) { x = e; }` as `x = select(x, e, c);`: what is computed in vain has no effect.
fn selected(text: &Text, at: usize) -> Option<Edit> {
    let (condition, body) = condition(text, at)?;
    let is_free = text.word(body.end + 1) != "else" && (at == 0 || text.word(at - 1) != "else");
    let is_one = text.kind(body.start) == Some(Kind::Word)
        && text.word(body.start + 1) == "="
        && body.clone().filter(|&i| text.word(i) == ";").count() == 1
        && text.word(body.end - 1) == ";";
    if !is_free || !is_one {
        return None;
    }
    let (name, value) = (text.word(body.start), text.between(body.start + 2..body.end - 1));
    let condition = text.between(condition);
    Some((text.bytes(at..body.end + 1), format!("{name} = select({name}, {value}, {condition});")))
}

/// `while (c) {B}` as a loop that breaks.
fn as_loop(text: &Text, at: usize) -> Option<Edit> {
    let (condition, body) = condition(text, at)?;
    let written = format!("loop {{ if (!({})) {{ break; }} {} }}", text.between(condition), text.between(body.clone()));
    Some((text.bytes(at..body.end + 1), written))
}

/// `for (i; c; s) {B}` as a loop that breaks; and, where nothing leaves or cuts short a turn, with its first turn before it.
fn counted(text: &Text, at: usize) -> Vec<Edit> {
    let Some((head, body)) = condition(text, at) else { return vec![] };
    let ends: Vec<usize> = head.clone().filter(|&i| text.word(i) == ";").collect();
    let &[first, second] = &ends[..] else { return vec![] };
    let (init, condition) = (text.between(head.start..first), text.between(first + 1..second));
    let (step, turn) = (text.between(second + 1..head.end), text.between(body.clone()));
    let rest = format!("loop {{ if (!({condition})) {{ break; }} {{ {turn} }} continuing {{ {step}; }} }}");
    let range = text.bytes(at..body.end + 1);
    let mut edits = vec![(range.clone(), format!("{{ {init}; {rest} }}"))];
    if !body.clone().any(|i| ["break", "continue", "return"].contains(&text.word(i))) {
        edits.push((range, format!("{{ {init}; if ({condition}) {{ {{ {turn} }} {step}; {rest} }} }}")));
    }
    edits
}

/// Proposals about expressions.
pub fn expressions(text: &Text) -> Vec<Edit> {
    let operators = text.bodies().into_iter().flatten().filter(|&i| text.kind(i) == Some(Kind::Symbol));
    operators.flat_map(|i| of_operator(text, i)).collect()
}

fn of_operator(text: &Text, at: usize) -> Vec<Edit> {
    let operator = text.word(at);
    let Some((start, end)) = text.primary_start(at).zip(text.primary_end(at + 1)) else { return vec![] };
    let Some(before) = start.checked_sub(1).map(|i| text.word(i)) else { return vec![] };
    let after = text.word(end);
    let is_within = |more_before: &[&str], more_after: &[&str]| {
        (OPEN.contains(&before) || more_before.contains(&before))
            && (CLOSED.contains(&after) || more_after.contains(&after))
    };
    let (a, b, range) = (text.between(start..at), text.between(at + 1..end), text.bytes(start..end));
    let comparisons = ["<", "<=", ">", ">=", "==", "!="];
    match operator {
        "*" if is_within(&["+", "-", "<", "<=", ">", ">="], &["+", "-", "*", "<", "<=", ">", ">="]) => {
            let mut edits = vec![(range.clone(), format!("{b} * {a}")), (range.clone(), format!("(1.0 * {a}) * {b}"))];
            edits.extend(as_scalar_product(text, start, end, [a, b]));
            edits
        }
        "+" if is_within(&["+"], &["+", "-"]) => vec![(range, format!("{b} + {a}"))],
        "-" if is_within(&[], &[]) => vec![(range, format!("-({b} - {a})"))],
        _ if comparisons.contains(&operator) && is_within(&["&&", "||"], &["&&", "||"]) => {
            let turned = match operator {
                "<" => ">",
                "<=" => ">=",
                ">" => "<",
                ">=" => "<=",
                same => same,
            };
            vec![(range, format!("{b} {turned} {a}"))]
        }
        _ => vec![],
    }
}

/// a b + c d of scalars as the scalar product of (a, c) and (b, d).
fn as_scalar_product(text: &Text, start: usize, end: usize, [a, b]: [&str; 2]) -> Option<Edit> {
    let next = (text.word(end) == "+").then_some(end + 1)?;
    let star = text.primary_end(next).filter(|&i| text.word(i) == "*")?;
    let last = text.primary_end(star + 1)?;
    let before = text.word(start.checked_sub(1)?);
    if !OPEN.contains(&before) || !CLOSED.contains(&text.word(last)) {
        return None;
    }
    let (c, d) = (text.between(next..star), text.between(star + 1..last));
    Some((text.bytes(start..last), format!("dot(vec2<f32>({a}, {c}), vec2<f32>({b}, {d}))")))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::variants::text::edited;

    fn rewritten(body: &str) -> Vec<String> {
        let program = format!("fn f() {{ {body} }}");
        let text = Text::new(&program);
        let edits = statements(&text).into_iter().chain(expressions(&text)).filter(|(_, to)| !to.contains("idle"));
        let whole = edits.map(|edit| edited(&program, &[edit]));
        whole.map(|text| text["fn f() { ".len()..text.len() - 2].to_owned()).collect()
    }

    #[test]
    fn each_rule_writes_what_it_says() {
        assert_eq!(rewritten("x = a * b;"), ["x = b * a;", "x = (1.0 * a) * b;"]);
        assert_eq!(rewritten("x = a + b.c;"), ["x = b.c + a;"]);
        assert_eq!(rewritten("x = a[i] - b;"), ["x = -(b - a[i]);"]);
        assert_eq!(rewritten("f(a < b);"), ["f(b > a);"]);
        assert_eq!(rewritten("if (c) { f(); } else { g(); }"), ["if (!(c)) { g(); } else { f(); }"]);
        assert!(rewritten("if (c) { x = e; }").contains(&"x = select(x, e, c);".to_owned()));
        assert!(rewritten("x = a * b + c * d;").contains(&"x = dot(vec2<f32>(a, c), vec2<f32>(b, d));".to_owned()));
        assert_eq!(rewritten("while (c) { f(); }"), ["loop { if (!(c)) { break; } f(); }"]);
        let loops = rewritten("for (var i = 0u; i < n; i++) { f(i); }");
        assert!(loops[0].starts_with("{ var i = 0u; loop {") && loops[1].starts_with("{ var i = 0u; if (i < n) {"));
    }

    #[test]
    fn nothing_is_proposed_that_would_bind_otherwise() {
        for kept in ["x = a - b * c + d;", "x = a / b * c;", "x = a - b + c;", "x = a * b - c;"] {
            for found in rewritten(kept) {
                assert!(
                    ["x = a - c * b + d;", "x = a - (1.0 * b) * c + d;", "x = b * a - c;", "x = (1.0 * a) * b - c;"]
                        .contains(&&*found),
                    "{kept} as {found}"
                );
            }
        }
    }
}
