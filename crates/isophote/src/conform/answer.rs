//! Where the answer goes: a folder that nobody else writes to, and a person or a machine that reads it.

use super::{html, junit, table};
use crate::format::Format;
use crate::{output, say, terminal};
use anyhow::{Result, bail};
use clap::Args;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use suite::corpus::Suite;
use suite::report::{Report, State};
use suite::shard::Shard;

/// Where the answer goes.
#[derive(Debug, Clone, Args)]
pub struct OutputArgs {
    /// The folder of report.html, report.json and junit.xml
    #[arg(long, value_name = "DIR", default_value = "out/conform")]
    pub(super) out: PathBuf,
    /// For people or for machines
    #[arg(long, value_enum, default_value_t)]
    pub(super) format: Format,
}

/// Makes a folder, if need be, to which nobody else writes until the lock is dropped, and that holds no other part of a suite.
pub(super) fn claim(folder: &Path, suite: Suite, shard: Shard) -> Result<files::Lock> {
    let lock = output::claim(folder)?;
    let report = folder.join("report.json");
    // Anything but a part of a suite is what an earlier run left, and is replaced by this one's.
    if let Ok(there) = Report::read(&report)
        && there.shard.count > 1
        && (there.suite, there.shard) != (suite, shard)
    {
        bail!(
            "{}: it is shard {} of suite {}, and shard {shard} of {} would replace it: give each its own --out",
            report.display(),
            there.shard,
            there.suite.name(),
            suite.name()
        );
    }
    Ok(lock)
}

/// Writes and prints a report.
pub(super) fn finish(report: &Report, output: &OutputArgs) -> Result<ExitCode> {
    write(report, &output.out)?;
    match output.format {
        Format::Json => terminal::json(report)?,
        Format::Table => {
            terminal::styled(&table::text(report))?;
            say!("report.html, report.json and junit.xml are in {}", output.out.display())?;
        }
    }
    Ok(match report.state() {
        State::Agree => ExitCode::SUCCESS,
        State::Differ => ExitCode::from(1),
        State::NotRun => ExitCode::from(2),
    })
}

/// Writes the three files.
///
/// # Errors
/// Where the folder cannot be written.
pub fn write(report: &Report, folder: &Path) -> Result<()> {
    report.write(folder)?;
    output::write(&folder.join("junit.xml"), &junit::xml(report)?)?;
    output::write(&folder.join("report.html"), html::page(report)?.as_bytes())
}
