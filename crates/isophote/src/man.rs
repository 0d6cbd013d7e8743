//! `man`: the manual's pages.

use crate::{output, say};
use anyhow::Result;
use clap::{Args, Command};
use clap_mangen::Man;
use std::path::PathBuf;

/// Write the manual's pages: isophote.1, and one for each command
///
/// Examples:
///   isophote man ~/.local/share/man/man1
///   man isophote-compare
#[derive(Debug, Args)]
#[command(verbatim_doc_comment)]
pub struct ManArgs {
    /// Where they go
    #[arg(value_name = "DIR")]
    folder: PathBuf,
}

/// Writes a page for `program` and one for each of its commands.
///
/// # Errors
/// Where a file cannot be written.
pub fn run(args: &ManArgs, mut program: Command) -> Result<()> {
    program.build();
    output::folder(&args.folder)?;
    let commands = program.get_subcommands().filter(|command| command.get_name() != "help");
    for command in commands.chain([&program]) {
        let (man, mut page) = (Man::new(command.clone()), vec![]);
        man.render(&mut page)?;
        output::write(&args.folder.join(man.get_filename()), &page)?;
    }
    say!("the manual's pages are in {}", args.folder.display())
}
