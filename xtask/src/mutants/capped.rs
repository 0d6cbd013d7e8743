//! Programs whose loops end: one that turns for ever would hold up the GPU for every worker, until its process is killed.

use super::token::{Kind, tokens};

/// Turns that all loops of one invocation may take together. The sources as they are take fewer on every scene: they are
/// drawn so, too, before any mutant is, and an end too early would show.
const TURNS: u32 = 1 << 20;

/// The program, none of whose invocations takes more than 2^20 turns.
pub fn capped(program: &str) -> String {
    let tokens = tokens(program);
    let word = |i: usize| &program[tokens[i].range.clone()];
    let is_loop = |i: &usize| tokens[*i].kind == Kind::Word && ["for", "while", "loop"].contains(&word(*i));
    let bodies = (0..tokens.len()).filter(is_loop).filter_map(|i| (i..tokens.len()).find(|&k| word(k) == "{"));
    let (mut text, mut copied) = (String::new(), 0);
    for body in bodies {
        let start = tokens[body].range.end;
        text += &program[copied..start];
        text += &format!(" turns_taken += 1u; if (turns_taken > {TURNS}u) {{ break; }}");
        copied = start;
    }
    text + &program[copied..] + "\nvar<private> turns_taken: u32;\n"
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mutants::mutant::is_legal;
    use crate::mutants::way::Way;
    use pipeline::wgsl::{self, Variant};
    use pipeline::{Program, TrimMethod};

    #[test]
    fn every_loop_of_every_program_counts_its_turns() {
        for way in Way::all() {
            let variant = Variant {
                parts: way.parts(),
                program: Program::General,
                curvature: true,
                vertex_normals: false,
                trims: TrimMethod::CurvesWithEdges,
            };
            let program = wgsl::source(variant);
            let text = capped(&program);
            let lines = program.lines().map(|line| line.split("//").next().unwrap_or_default().trim());
            let loops = lines.filter(|line| ["for (", "while (", "loop {"].iter().any(|s| line.starts_with(s))).count();
            assert!(loops > 0 && text.matches("turns_taken += 1u").count() == loops, "{}", way.label());
            assert!(is_legal(&text), "{}", way.label());
        }
    }

    #[test]
    fn a_loop_without_end_has_one() {
        let text = capped("fn f() { /* for { */ loop { for (var i = 0u; true; i += 0u) { g(i); } } }");
        let turn = " turns_taken += 1u; if (turns_taken > 1048576u) { break; }";
        let expected =
            format!("fn f() {{ /* for {{ */ loop {{{turn} for (var i = 0u; true; i += 0u) {{{turn} g(i); }} }} }}");
        assert_eq!(text, expected + "\nvar<private> turns_taken: u32;\n");
    }
}
