//! The answer: a report with its pictures, and an exit code.

use super::args::CompareArgs;
use super::page::Page;
use super::pictures::Pictures;
use crate::format::Format;
use crate::{output, say, terminal};
use anyhow::Result;
use compare::{PairReport, Verdict};
use gbuffer::Picture;
use serde::Serialize;

/// The version of both documents that a comparison writes; a key that changes its meaning raises it.
pub(super) const SCHEMA_VERSION: u32 = 1;

/// 0 where all pairs agree; 1 where some pixel differs, or too many have no verdict; 2 where no pair shows anything.
///
/// A pair of which neither shows anything says nothing, and is passed over where others do.
pub(super) fn exit_code(pairs: &[PairReport]) -> u8 {
    let shown: Vec<&PairReport> = pairs.iter().filter(|pair| pair.covered > 0).collect();
    match shown.iter().all(|pair| pair.verdict == Verdict::Agree) {
        _ if shown.is_empty() => 2,
        true => 0,
        false => 1,
    }
}

/// Writes and shows a report with its pictures; `page` is what people read in a browser, and `print` in a terminal.
pub(super) fn answer(
    args: &CompareArgs,
    report: &impl Serialize,
    pictures: &Pictures,
    page: &Page,
    print: impl Fn() -> Result<()>,
) -> Result<()> {
    if let Some(folder) = &args.out {
        pictures.write(folder)?;
        output::write_json(&folder.join("report.json"), report)?;
    }
    if let Some(path) = &args.report {
        output::write(path, page.text(pictures)?.as_bytes())?;
        if output::is_standard(path) {
            return Ok(());
        }
    }
    match args.format {
        Format::Json => terminal::json(report)?,
        Format::Table => {
            terminal::show(&Picture::beside(&pictures.views()?.iter().collect::<Vec<_>>()))?;
            if let Some(folder) = &args.out {
                say!("pictures and report.json are in {}", folder.display())?;
            }
            if let Some(path) = &args.report {
                say!("the report is {}", path.display())?;
            }
            print()?;
        }
    }
    Ok(())
}
