//! `isophote`: parses and dispatches.

use isophote::commands::Cli;
use isophote::entry;
use std::process::ExitCode;

fn main() -> ExitCode {
    entry::main(|cli: Cli| cli.command.run())
}
