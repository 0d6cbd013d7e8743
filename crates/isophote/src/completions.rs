//! `completions`: what a shell needs to complete a command line.

use crate::terminal;
use anyhow::Result;
use clap::{Args, Command};
use clap_complete::Shell;

/// Print what a shell needs to complete these commands
///
/// Examples:
///   isophote completions bash > ~/.local/share/bash-completion/completions/isophote
///   isophote completions fish > ~/.config/fish/completions/isophote.fish
///   isophote completions zsh > ~/.zfunc/_isophote
#[derive(Debug, Args)]
#[command(verbatim_doc_comment)]
pub struct CompletionsArgs {
    /// Which shell
    #[arg(value_enum, value_name = "SHELL")]
    shell: Shell,
}

/// Prints the script that completes `program`.
///
/// # Errors
/// Where standard output takes no more.
pub fn run(args: &CompletionsArgs, program: &mut Command) -> Result<()> {
    let name = program.get_name().to_owned();
    let mut script = vec![];
    clap_complete::generate(args.shell, program, name, &mut script);
    terminal::styled(String::from_utf8(script)?.trim_end())
}
