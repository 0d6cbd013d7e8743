//! Commands that documents and help show are commands that the program takes, and blocks of them run as they are written.

use clap::{CommandFactory, Parser};
use isophote::commands::Cli;
use std::path::{Path, PathBuf};
use std::process::Command;

/// How the line above a block begins that is not run; the reason follows.
const NOT_RUN: &str = "<!-- not run: ";

/// The text files of a folder and those in it.
fn texts(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path());
    let (folders, files): (Vec<PathBuf>, Vec<PathBuf>) = entries.partition(|path| path.is_dir());
    let is_text = |path: &PathBuf| path.extension().is_some_and(|e| e == "md" || e == "yml");
    folders.iter().flat_map(|folder| texts(folder)).chain(files.into_iter().filter(is_text)).collect()
}

/// The commands of a text: lines that begin with the program's name, up to what the shell makes of the rest.
fn commands(text: &str) -> Vec<String> {
    let line = |line: &str| {
        let line = line.trim().trim_start_matches("- run: ").trim_start_matches("- ");
        let line = line.rsplit("&& ").next().unwrap_or(line);
        let end = [" # ", " > ", " < ", " | ", " || ", "  "]
            .iter()
            .filter_map(|mark| line.find(mark))
            .min()
            .unwrap_or(line.len());
        line[..end].trim().strip_prefix("isophote ").map(str::to_owned)
    };
    text.lines().filter_map(line).collect()
}

fn refusal(command: &str) -> Option<String> {
    let words = command.split_whitespace().map(|word| word.trim_matches(['\'', '"']));
    let words: Vec<&str> = std::iter::once("isophote").chain(words).collect();
    Cli::try_parse_from(words).err().filter(|error| error.use_stderr()).map(|error| format!("{command}: {error}"))
}

#[test]
fn every_command_in_the_documents_and_in_the_help_is_taken() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut shown: Vec<String> = texts(&root.join("docs"))
        .into_iter()
        .chain([root.join("README.md")])
        .flat_map(|path| commands(&std::fs::read_to_string(path).expect("a text")))
        .collect();
    assert!(shown.len() >= 15, "{shown:?}");
    let program = Cli::command();
    let helps: Vec<String> = program
        .get_subcommands()
        .filter_map(|command| Some(command.get_after_help()?.to_string()))
        .flat_map(|help| commands(&help))
        .collect();
    assert!(helps.len() >= 15, "{helps:?}");
    shown.extend(helps);
    let refused: Vec<String> = shown.iter().filter_map(|command| refusal(command)).collect();
    assert!(refused.is_empty(), "{}", refused.join("\n"));
    assert!(refusal("render teapot --shade plaid").is_some() && refusal("compare a b c").is_some());
}

/// The blocks of shell commands of a text, but those that say why they are not run.
fn blocks(text: &str) -> Vec<String> {
    let mut blocks = vec![];
    let (mut above, mut lines) = ("", text.lines());
    while let Some(line) = lines.next() {
        if line == "```sh" {
            let block: Vec<&str> = lines.by_ref().take_while(|line| *line != "```").collect();
            if !above.starts_with(NOT_RUN) {
                blocks.push(block.join("\n"));
            }
        }
        above = if line.is_empty() { above } else { line };
    }
    blocks
}

/// What a block says when it fails.
fn failure(block: &str, folder: &Path) -> Option<String> {
    let programs = Path::new(env!("CARGO_BIN_EXE_isophote")).parent().expect("a folder of programs");
    let path = format!("{}:{}", programs.display(), std::env::var("PATH").expect("a path"));
    let output = Command::new("bash").args(["-euc", block]).current_dir(folder).env("PATH", path).output();
    let output = output.expect("bash starts");
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    (!output.status.success()).then(|| format!("{block}\n{said}"))
}

/// `part.step` and two answers of a renderer are there from the start.
#[test]
fn blocks_of_commands_in_the_documents_run_as_they_are_written() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("documents");
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).expect("a folder");
    for name in ["yours.npz", "new.npz"] {
        std::fs::copy(root.join("testdata/foreign/teapot.npz"), folder.join(name)).expect("a copy");
    }
    assert_eq!(failure("isophote convert seam-pair --out part.step", &folder), None);
    let texts = texts(&root.join("docs")).into_iter().chain([root.join("README.md")]);
    let blocks: Vec<String> = texts.flat_map(|path| blocks(&std::fs::read_to_string(path).expect("a text"))).collect();
    assert!(blocks.len() >= 10, "{}", blocks.len());
    let failures: Vec<String> = blocks.iter().filter_map(|block| failure(block, &folder)).collect();
    assert!(failures.is_empty(), "{}", failures.join("\n\n"));
    // A command that fails is told, and a block that says why is not run.
    assert!(failure("isophote render teapto\ntrue", &folder).is_some_and(|said| said.contains("did you mean")));
    assert_eq!(self::blocks("<!-- not run: it is long -->\n\n```sh\nfalse\n```\n\n```sh\ntrue\n```\n"), ["true"]);
}

/// The most words that the sentences of a page have, on average.
const WORDS: f64 = 16.0;

/// How many words sentences have on average, without tables, code and links' addresses; nought where there are none.
fn mean_words(text: &str) -> f64 {
    let without = |pattern: &str, text: &str, with: &str| {
        regex::Regex::new(pattern).expect("a pattern").replace_all(text, with).into_owned()
    };
    let text = without(r"(?s)```.*?```", text, "");
    let is_prose = |line: &&str| !["|", "#", "<!--", "!["].iter().any(|start| line.starts_with(start));
    let text = text.lines().filter(is_prose).collect::<Vec<_>>().join("\n");
    let text = without(r"`[^`]*`", &text, "x");
    let text = without(r"\]\([^)]*\)", &text, "]");
    let text = without(r"\n(?:[-*]|\d+\.) ", &text, "\n\n");
    let ends = regex::Regex::new(r"[.!?:](?:\s|$)|\n\n").expect("a pattern");
    let lengths = ends.split(&text).map(|sentence| sentence.split_whitespace().count());
    let lengths: Vec<usize> = lengths.filter(|words| *words > 1).collect();
    lengths.iter().sum::<usize>() as f64 / lengths.len().max(1) as f64
}

#[test]
fn sentences_of_documents_and_help_are_short() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let pages = texts(&root.join("docs")).into_iter().chain([root.join("README.md")]);
    let pages = pages.filter(|path| path.extension().is_some_and(|e| e == "md"));
    let mut found: Vec<(String, f64)> = pages
        .map(|path| (path.display().to_string(), mean_words(&std::fs::read_to_string(&path).expect("a text"))))
        .collect();
    assert!(found.len() >= 20);
    let program = Cli::command();
    let about = |command: &clap::Command| command.get_long_about().map(|about| about.to_string());
    found.extend(program.get_subcommands().filter_map(|c| Some((c.get_name().to_owned(), mean_words(&about(c)?)))));
    let long: Vec<_> = found.iter().filter(|(_, words)| *words > WORDS).collect();
    assert!(long.is_empty(), "{long:?}");
    assert!(mean_words(&format!("{}end. A word.", "and so on ".repeat(20))) > WORDS);
    assert_eq!(mean_words("One two three. `a b c` four\n\n- five six\n\n| a | table of many words |\n"), 7.0 / 3.0);
}
