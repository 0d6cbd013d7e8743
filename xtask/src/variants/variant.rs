//! A program in other words, by a seed.

use super::rewriting::{expressions, statements};
use super::text::{Edit, Text, edited};
use crate::mutants::mutant::is_legal;
use crate::mutants::token::Kind;
use crate::random::Random;
use std::collections::{BTreeMap, BTreeSet};

/// Of the proposals about a program, how many are taken up: one in so many.
const ONE_IN: usize = 5;

/// The program as this seed writes it: the same function of the same bindings, with entry points and `called` functions of the
/// same names.
///
/// # Panics
/// Where `program` is no WGSL.
pub fn variant(program: &str, seed: u64, called: &[&str]) -> String {
    let mut random = Random::new(seed);
    let by_statements = rewritten(program, statements, &mut random);
    let by_expressions = rewritten(&by_statements, expressions, &mut random);
    let renamed = renamed(&by_expressions, called, &mut random);
    let reordered = reordered(&renamed, &mut random);
    assert!(is_legal(&reordered), "renamed and reordered, a program stays one (seed {seed})");
    reordered
}

/// Takes up some of the proposals, those with which the program still compiles.
fn rewritten(program: &str, propose: fn(&Text) -> Vec<Edit>, random: &mut Random) -> String {
    let mut chosen: Vec<Edit> =
        propose(&Text::new(program)).into_iter().filter(|_| random.below(ONE_IN) == 0).collect();
    random.shuffle(&mut chosen);
    let all = edited(program, &chosen);
    if is_legal(&all) {
        return all;
    }
    // By itself each that compiles; together they do, too, but for what one of them hides from another.
    chosen.retain(|edit| is_legal(&edited(program, std::slice::from_ref(edit))));
    while !is_legal(&edited(program, &chosen)) && chosen.pop().is_some() {}
    edited(program, &chosen)
}

/// Every name of the program's own becomes another, but for those by which the host knows it.
fn renamed(program: &str, called: &[&str], random: &mut Random) -> String {
    let text = Text::new(program);
    let mut names = BTreeSet::new();
    let (mut functions, mut with_arguments) = (BTreeSet::new(), BTreeSet::new());
    let mut kept: BTreeSet<&str> = called.iter().copied().collect();
    let mut members = vec![false; text.tokens.len()];
    let mut is_entry = false;
    for i in 0..text.tokens.len() {
        let word = text.word(i);
        if text.kind(i) == Some(Kind::Attribute) {
            is_entry |= ["@vertex", "@fragment", "@compute"].contains(&word);
            // Constants of sizes stand inside.
            kept.extend(word.split(|c: char| !(c.is_alphanumeric() || c == '_')));
            continue;
        }
        match word {
            "struct" => {
                names.insert(text.word(i + 1));
                let open = i + 2;
                let close = text.closing(open).unwrap_or(open);
                // A member's name stands before a colon, and nowhere else but behind a point.
                (open..close).filter(|&k| text.word(k + 1) == ":").for_each(|k| members[k] = true);
            }
            "fn" => {
                (if is_entry { &mut kept } else { &mut names }).insert(text.word(i + 1));
                functions.insert(text.word(i + 1));
                is_entry = false;
                let close = text.closing(i + 2).unwrap_or(i);
                names.extend((i + 3..close).filter(|&k| text.word(k + 1) == ":").map(|k| text.word(k)));
            }
            "override" => {
                kept.insert(text.word(i + 1));
            }
            "let" | "const" => {
                names.insert(text.word(i + 1));
            }
            "var" => {
                let list = text.kind(i + 1) == Some(Kind::Template);
                let end = (i + 1..text.tokens.len()).find(|&k| text.word(k) == ">").unwrap_or(i);
                names.insert(text.word(if list { end + 1 } else { i + 1 }));
            }
            _ if text.word(i + 1) == "(" => {
                with_arguments.insert(word);
            }
            _ => {}
        }
    }
    // A local may be called as a function of the language is; elsewhere in the program that function keeps its name.
    kept.extend(with_arguments.difference(&functions));
    let salt = random.bits() & 0xffff;
    let names: BTreeMap<&str, String> =
        names.difference(&kept).enumerate().map(|(k, name)| (*name, format!("w{k}_{salt:x}"))).collect();
    let is_free = |i: &usize| !members[*i] && (*i == 0 || text.word(i - 1) != ".");
    let edits: Vec<Edit> = (0..text.tokens.len())
        .filter(is_free)
        .filter_map(|i| Some((text.bytes(i..i + 1), names.get(text.word(i))?.clone())))
        .collect();
    // None overlaps another, and there are thousands.
    let (mut out, mut copied) = (String::new(), 0);
    for (range, name) in edits {
        out += &program[copied..range.start];
        out += &name;
        copied = range.end;
    }
    out + &program[copied..]
}

/// The declarations in another order; directives stay in front.
fn reordered(program: &str, random: &mut Random) -> String {
    let text = Text::new(program);
    let declarations = text.declarations();
    let is_directive =
        |tokens: &std::ops::Range<usize>| ["enable", "requires", "diagnostic"].contains(&text.word(tokens.start));
    let (front, mut rest): (Vec<_>, Vec<_>) = declarations.into_iter().partition(is_directive);
    random.shuffle(&mut rest);
    front.into_iter().chain(rest).map(|tokens| text.between(tokens).to_owned() + "\n").collect()
}
