//! `info`: what a model consists of; of many files, a line each.

mod approximation;
mod detail;
mod overview;

use crate::format::Format;
use crate::listing::{Listed, is_many, listed};
use crate::view::ModelArgs;
use crate::{number, say, terminal};
use anyhow::{Result, bail};
use approximation::{ApproximationInfo, approximated};
use clap::Args;
pub use detail::{describe, text};
use overview::Overview;
use serde::Serialize;
use std::process::ExitCode;

/// Show what a model consists of, and what of its file is not drawn
///
/// Of one model: faces by surface, degrees, knots, boxes, trims, gaps.
///
/// Of several files, directories or patterns it prints a line a file. A bad file is a line with its error, and the exit code is 2.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  isophote info part.step         faces, trims, gaps, and what is not drawn
  isophote info 'parts/*.step'    a line a file
  isophote info --list            the built-in models")]
pub struct InfoArgs {
    /// Model files, directories, patterns such as 'parts/*.step', or built-in models
    #[arg(value_name = "MODEL", default_value = "teapot")]
    models: Vec<String>,
    /// Refuse a file that is not drawn as it stands
    ///
    /// A face left out, a loop dropped and a wide gap closed are such.
    #[arg(long)]
    strict: bool,
    /// List the built-in models instead
    #[arg(long)]
    list: bool,
    /// Say how many bicubic patches stand for the model within this distance, model units
    ///
    /// It also says how far off they are at most.
    #[arg(long, value_name = "TOL", value_parser = number::positive, allow_hyphen_values = true)]
    approximate: Option<f64>,
    /// For people or for machines; of several files, a JSON object a line
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

/// Runs the command.
///
/// # Errors
/// Where the one model cannot be read, or nothing can be printed.
pub fn run(args: &InfoArgs) -> Result<ExitCode> {
    if args.list {
        for (name, description) in models::all() {
            say!("{name:20} {description}")?;
        }
        return Ok(ExitCode::SUCCESS);
    }
    if is_many(&args.models) {
        if args.approximate.is_some() {
            bail!("--approximate takes one model");
        }
        return many(args);
    }
    let document = ModelArgs { model: args.models[0].clone(), strict: args.strict }.document()?;
    let model = &document.model;
    let approximation = args.approximate.map(|tolerance| approximated(model, tolerance)).transpose()?;
    match args.format {
        Format::Json => terminal::json_lines(&describe(&document, approximation))?,
        Format::Table => {
            say!("{}", text(&document))?;
            if let Some(ApproximationInfo { tolerance, patches, bicubic_patches, bound, .. }) = approximation {
                say!(
                    "within {tolerance:e}: {bicubic_patches} bicubic patches stand for {patches} Bézier patches, at most {bound:.3e} off"
                )?;
            }
        }
    }
    Ok(ExitCode::SUCCESS)
}

/// A file among several.
#[derive(Serialize)]
struct Line {
    file: String,
    #[serde(flatten)]
    overview: Option<Overview>,
    /// Why it cannot be read, or is refused.
    #[serde(skip_serializing_if = "Option::is_none")]
    error: Option<String>,
}

/// A line a file, as soon as it is read; a bad one is its line with its error, and the others go on.
fn many(args: &InfoArgs) -> Result<ExitCode> {
    let mut errors = 0;
    let files = listed(&args.models);
    for Listed { name, fault } in &files {
        let model = ModelArgs { model: name.clone(), strict: args.strict };
        let read = match fault {
            Some(fault) => Err(format!("{name}: {fault}")),
            None => model.read().map_err(|error| error.to_string()),
        };
        let (overview, error) = match read {
            Ok(document) if model.refuses(&document) => {
                (Some(Overview::of(&document)), Some(format!("{name}: not drawn as it stands, and --strict is given")))
            }
            Ok(document) => (Some(Overview::of(&document)), None),
            Err(error) => (None, Some(error)),
        };
        errors += usize::from(error.is_some());
        match args.format {
            Format::Json => terminal::json(&Line { file: name.clone(), overview, error })?,
            Format::Table => {
                if let Some(overview) = overview {
                    say!("{name}: {}", overview.line())?;
                }
                if let Some(error) = error {
                    say!("error: {error}")?;
                }
            }
        }
    }
    if args.format == Format::Table {
        say!("{} files, {errors} errors", files.len())?;
    }
    Ok(if errors == 0 { ExitCode::SUCCESS } else { ExitCode::from(2) })
}
