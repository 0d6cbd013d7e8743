//! `ci`: the project's own check, as CI runs it.

use anyhow::{Context, Result};
use clap::Args;
use std::process::{Command, ExitCode};

/// Run what CI runs: formatting, lints, all tests, documentation
#[derive(Debug, Args)]
pub struct CiArgs {}

/// Runs the command.
///
/// # Errors
/// Where the script cannot be started.
pub fn run(_: &CiArgs) -> Result<ExitCode> {
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/..");
    let status = Command::new("bash").arg(".ci/run").current_dir(root).status().context(".ci/run cannot be started")?;
    Ok(ExitCode::from(if status.success() { 0 } else { 1 }))
}
