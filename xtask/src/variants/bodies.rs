//! A program that does less: what can go out of its functions while something about it stays.
//!
//! Functions return zero at once, statements go (half of a block at a time, and at last one at a time), of a branch one side stays, and
//! a value is zero. A step proposes by tokens; what does not compile is dropped, and what compiles is asked about.

use super::text::{Text, edited};
use super::variant::lean;
use crate::mutants::mutant::is_legal;
use std::ops::Range;

/// Programs that are asked about, at most: each is drawn twice.
const MOST: usize = 600;

/// What a value may be instead; of these one at most compiles in most places.
const ZEROS: [&str; 7] = ["0.0", "0u", "false", "vec2<f32>()", "vec3<f32>()", "vec4<f32>()", "vec2<u32>()"];

/// A program on its way.
struct Shrinking<'k> {
    program: String,
    called: &'k [&'k str],
    is_kept: &'k mut dyn FnMut(&str) -> bool,
    asked: usize,
}

/// The program with the least that is still as `is_kept` asks, as far as `MOST` questions go; it may mean something else.
pub fn shrunk(program: &str, called: &[&str], is_kept: &mut dyn FnMut(&str) -> bool) -> String {
    let mut shrinking = Shrinking { program: lean(program, called), called, is_kept, asked: 0 };
    loop {
        let before = shrinking.program.len();
        shrinking.zero_functions();
        shrinking.fewer_statements();
        shrinking.one_side_of_branches();
        shrinking.zero_values();
        if shrinking.program.len() >= before || shrinking.asked >= MOST {
            return without_empty_lines(&shrinking.program);
        }
    }
}

/// The text without lines that hold nothing.
fn without_empty_lines(text: &str) -> String {
    text.lines().filter(|line| !line.trim().is_empty()).map(|line| line.to_owned() + "\n").collect()
}

impl Shrinking<'_> {
    /// Takes the program with some bytes replaced, where it is kept; whether it is.
    fn take(&mut self, bytes: Range<usize>, by: &str) -> bool {
        let candidate = edited(&self.program, &[(bytes, by.to_owned())]);
        if self.asked >= MOST || candidate == self.program || !is_legal(&candidate) {
            return false;
        }
        let candidate = lean(&candidate, self.called);
        self.asked += 1;
        let is_kept = (self.is_kept)(&candidate);
        if is_kept {
            self.program = candidate;
        }
        is_kept
    }

    /// Makes functions return zero at once.
    fn zero_functions(&mut self) {
        // Those further down call those above.
        let mut from_the_end = 0;
        loop {
            let text = Text::new(&self.program);
            let bodies = text.bodies();
            let Some(body) = bodies.len().checked_sub(from_the_end + 1).map(|place| bodies[place].clone()) else {
                break;
            };
            let function = (0..body.start).rev().find(|&i| text.word(i) == "fn").unwrap_or(0);
            let returned = text.closing(function + 2).map_or(0..0, |close| close + 2..body.start - 1);
            let zero =
                if returned.is_empty() { String::new() } else { format!("return {}();", text.between(returned)) };
            let bytes = inside(&text, &body);
            if self.program[bytes.clone()].trim() == zero || !self.take(bytes, &format!(" {zero} ")) {
                from_the_end += 1;
            }
        }
    }

    /// Takes statements out of each block, half of them at a time and at last one at a time.
    fn fewer_statements(&mut self) {
        let mut block = 0;
        while let Some(count) = self.statements(block).map(|statements| statements.len()) {
            let mut part = count.div_ceil(2);
            while part > 0 {
                let mut start = 0;
                while let Some(statements) = self.statements(block).filter(|statements| start < statements.len()) {
                    let end = (start + part).min(statements.len());
                    if !self.take(statements[start].start..statements[end - 1].end, "") {
                        start += part;
                    }
                }
                part /= 2;
            }
            block += 1;
        }
    }

    /// The bytes of each statement of a block; `None` beyond the last block.
    fn statements(&self, block: usize) -> Option<Vec<Range<usize>>> {
        let text = Text::new(&self.program);
        let block = blocks(&text).get(block)?.clone();
        Some(statements(&text, block).into_iter().map(|tokens| text.bytes(tokens)).collect())
    }

    /// Leaves of each `if` what it guards, or what it does else.
    fn one_side_of_branches(&mut self) {
        let mut number = 0;
        loop {
            let text = Text::new(&self.program);
            let Some(at) = (0..text.tokens.len()).filter(|&i| text.word(i) == "if").nth(number) else { break };
            let open = text.closing(at + 1).map_or(at, |close| close + 1);
            let Some(close) = text.closing(open).filter(|_| text.word(open) == "{") else { break };
            let guarded = text.between(open..close + 1).to_owned();
            let other = (text.word(close + 1) == "else" && text.word(close + 2) == "{")
                .then(|| text.closing(close + 2).map(|end| (text.between(close + 2..end + 1).to_owned(), end)))
                .flatten();
            let end = other.as_ref().map_or(close, |(_, end)| *end);
            let bytes = text.bytes(at..end + 1);
            let is_chained = at > 0 && text.word(at - 1) == "else" || text.word(end + 1) == "else";
            let is_taken = !is_chained
                && (self.take(bytes.clone(), &guarded) || other.is_some_and(|(other, _)| self.take(bytes, &other)));
            number += usize::from(!is_taken);
        }
    }

    /// Makes what is declared or assigned zero.
    fn zero_values(&mut self) {
        let mut number = 0;
        loop {
            let text = Text::new(&self.program);
            let bodies = text.bodies();
            let is_inside = |i: &usize| bodies.iter().any(|body| body.contains(i));
            let Some(at) = (0..text.tokens.len()).filter(|&i| text.word(i) == "=").filter(is_inside).nth(number) else {
                break;
            };
            number += 1;
            let end = (at + 1..text.tokens.len()).find(|&i| text.word(i) == ";").unwrap_or(at + 1);
            // A name or a number is as short as zero.
            if end > at + 2 {
                let bytes = text.bytes(at + 1..end);
                // What a function of the program returns, if the value is a call of one.
                let called = returned(&text, text.word(at + 1)).map(|name| format!("{name}()"));
                let zeros: Vec<String> = called.into_iter().chain(ZEROS.map(str::to_owned)).collect();
                let is_zero = zeros.iter().any(|zero| *zero == self.program[bytes.clone()]);
                let _ = !is_zero && zeros.iter().any(|zero| self.take(bytes.clone(), zero));
            }
        }
    }
}

/// The name of the type that a function of the program returns.
fn returned(text: &Text, name: &str) -> Option<String> {
    let function = (0..text.tokens.len()).find(|&i| text.word(i) == "fn" && text.word(i + 1) == name)?;
    let close = text.closing(function + 2)?;
    let end = (close..text.tokens.len()).find(|&i| text.word(i) == "{")?;
    (end > close + 2).then(|| text.between(close + 2..end).to_owned())
}

/// The bytes between the brackets of a body.
fn inside(text: &Text, body: &Range<usize>) -> Range<usize> {
    text.tokens[body.start - 1].range.end..text.tokens[body.end].range.start
}

/// The tokens in each pair of curly brackets of the functions, those around others first.
fn blocks(text: &Text) -> Vec<Range<usize>> {
    let bodies = text.bodies();
    let nested = |body: &Range<usize>| -> Vec<Range<usize>> {
        let opens = body.clone().filter(|&i| text.word(i) == "{");
        opens.filter_map(|open| Some(open + 1..text.closing(open)?)).collect()
    };
    let all = bodies.into_iter().flat_map(|body| [vec![body.clone()], nested(&body)].concat());
    all.filter(|block| !block.is_empty()).collect()
}

/// The statements of a block: up to a semicolon, or a closing bracket that no `else` follows.
fn statements(text: &Text, block: Range<usize>) -> Vec<Range<usize>> {
    let (mut found, mut start, mut depth) = (vec![], block.start, 0i32);
    for i in block {
        depth += match text.word(i) {
            "(" | "[" | "{" => 1,
            ")" | "]" | "}" => -1,
            _ => 0,
        };
        let ends = text.word(i) == ";" || (text.word(i) == "}" && text.word(i + 1) != "else");
        if depth == 0 && ends {
            found.push(start..i + 1);
            start = i + 1;
        }
    }
    found
}
