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

/// The program without the declarations that neither entry points nor `called` functions come to.
pub fn lean(program: &str, called: &[&str]) -> String {
    let text = Text::new(program);
    let declarations = text.declarations();
    let name = |tokens: &std::ops::Range<usize>| {
        let names_one = |i: &usize| ["fn", "struct", "const", "override", "alias", "var"].contains(&text.word(*i));
        let at = tokens.clone().find(names_one)?;
        // Behind the address space of a variable, if it has one.
        let list = text.kind(at + 1) == Some(Kind::Template);
        let end = (at..tokens.end).find(|&k| list && text.word(k) == ">").unwrap_or(at);
        Some(text.word(end + 1))
    };
    let is_root = |tokens: &std::ops::Range<usize>| {
        let stage = |i: usize| {
            text.kind(i) == Some(Kind::Attribute) && ["@vertex", "@fragment", "@compute"].contains(&text.word(i))
        };
        name(tokens).is_none_or(|name| called.contains(&name)) || tokens.clone().any(stage)
    };
    let mut kept: Vec<bool> = declarations.iter().map(is_root).collect();
    let mut used: BTreeSet<&str> = BTreeSet::new();
    let mut waiting: Vec<usize> = (0..kept.len()).filter(|&k| kept[k]).collect();
    while let Some(k) = waiting.pop() {
        let words = declarations[k].clone().map(|i| text.word(i));
        // The sizes of a workgroup stand inside of an attribute.
        used.extend(words.flat_map(|word| word.split(|c: char| !(c.is_alphanumeric() || c == '_'))));
        for (other, tokens) in declarations.iter().enumerate() {
            if !kept[other] && name(tokens).is_some_and(|name| used.contains(name)) {
                kept[other] = true;
                waiting.push(other);
            }
        }
    }
    let kept = declarations.into_iter().zip(kept).filter(|(_, kept)| *kept);
    kept.map(|(tokens, _)| text.between(tokens).to_owned() + "\n").collect()
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lean_program_keeps_what_its_entry_points_come_to() {
        let program = "const A: u32 = 1u;\nconst B: u32 = A;\nconst LANES: u32 = 4u;\n\
                       @group(0) @binding(0) var<storage, read> read_here: array<u32>;\n\
                       @group(0) @binding(1) var<storage, read> never: array<u32>;\n\
                       struct Kept {\n x: f32,\n}\nstruct Dropped {\n x: f32,\n}\n\
                       fn taken(k: Kept) -> f32 { return k.x; }\nfn dropped(d: Dropped) -> f32 { return d.x; }\n\
                       fn called() -> u32 { return B; }\n\
                       @compute @workgroup_size(LANES)\nfn entry() { let x = taken(Kept(f32(read_here[0]))); }\n";
        let kept = |name: &str, lean: &str| lean.contains(name);
        let lean_program = lean(program, &["called"]);
        assert!(is_legal(program) && is_legal(&lean_program));
        for name in ["A", "B", "LANES", "read_here", "Kept", "fn taken", "fn called", "fn entry"] {
            assert!(kept(name, &lean_program), "{name}: {lean_program}");
        }
        assert!(!["never", "Dropped", "dropped"].iter().any(|name| kept(name, &lean_program)), "{lean_program}");
        assert!(!kept("fn called", &lean(program, &[])));
    }
}
