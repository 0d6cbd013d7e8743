//! `compare`: render by all three, or take what others rendered, compare, and show a person the answer. Two models are measured
//! from each other.

mod answer;
mod args;
mod judged;
mod maps;
mod next;
mod page;
mod pictures;
mod rendered;
mod report;
mod saved;
mod table;
mod verdict;
mod versions;

pub use args::{CompareArgs, DrawingArgs, Shade};
pub use saved::{Saved, SavedComparison, SavedFile, SavedPixel};

use crate::format::Format;
use crate::output;
use crate::view::ModelArgs;
use anyhow::{Result, bail};
use std::path::Path;
use std::process::ExitCode;

/// Runs the command.
///
/// # Errors
/// Where input is bad or a picture cannot be written.
pub fn run(args: &CompareArgs) -> Result<ExitCode> {
    // Before minutes of work: a folder that cannot be made, or that another run writes to, is refused now.
    let _lock = args.out.as_deref().map(output::claim).transpose()?;
    if let Some(path) = &args.report {
        match (output::is_standard(path), args.format) {
            (true, Format::Json) => bail!("--report - and --format json both write to standard output"),
            (true, Format::Table) => {}
            (false, _) => output::check(path, "html")?,
        }
    }
    let is_saved = |subject: &&String| Path::new(subject).extension().is_some_and(|e| e.eq_ignore_ascii_case("npz"));
    let subjects: Vec<&String> = args.subjects.iter().collect();
    let (files, models) = subjects.iter().copied().partition::<Vec<_>, _>(is_saved);
    if args.within.is_some() && models.len() < 2 {
        bail!("--within goes with two models, and is the distance that is allowed between them");
    }
    match ((files, models), &args.of_model) {
        ((_, models), _) if models.is_empty() && args.approximate.is_asked() => {
            bail!("--approximate draws a model, and saved G-buffers are drawn already")
        }
        ((files, models), _) if models.is_empty() => judged::run(args, &files),
        ((files, models), None) if files.is_empty() && models.len() == 1 => {
            rendered::run(args, &ModelArgs { model: models[0].clone(), strict: args.strict })
        }
        ((files, models), None) if files.is_empty() && models.len() == 2 => versions::run(args, [models[0], models[1]]),
        ((_, models), Some(_)) => {
            bail!("--model names what saved G-buffers (.npz) show, and {:?} is not one", models[0])
        }
        ((_, models), None) => bail!(
            "compare takes one model or two, or one or two saved G-buffers (.npz) and their model by --model; {:?} is no .npz",
            models[0]
        ),
    }
}
