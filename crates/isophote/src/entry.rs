//! The way into a program and out of it: its command line, and its exit code.

use crate::terminal::{self, OutputError};
use anyhow::Result;
use clap::Parser;
use std::process::ExitCode;

/// Reads the command line and runs what it asks for. An error is told on standard error, and its exit code is 2.
pub fn main<C: Parser>(run: impl FnOnce(C) -> Result<ExitCode>) -> ExitCode {
    let cli = match C::try_parse() {
        Ok(cli) => cli,
        // Help goes to standard output, and a full device is none that it reached.
        Err(stopped) => match stopped.print() {
            Ok(()) => return ExitCode::from(stopped.exit_code() as u8),
            Err(_) => return ExitCode::from(2),
        },
    };
    run(cli).unwrap_or_else(|error| {
        // Nobody reads on, as below `| head`: no words, and yet no success, since the answer did not arrive.
        let closed = error.downcast_ref::<OutputError>().is_some_and(OutputError::is_closed);
        if !closed {
            terminal::note(format_args!("error: {error:#}"));
        }
        ExitCode::from(2)
    })
}
