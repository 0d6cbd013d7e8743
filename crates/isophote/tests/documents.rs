//! Commands that documents and help show are commands that the program takes.

use clap::{CommandFactory, Parser};
use isophote::commands::Cli;
use std::path::{Path, PathBuf};

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
        let end = [" # ", " > ", " | ", "  "].iter().filter_map(|mark| line.find(mark)).min().unwrap_or(line.len());
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
