//! `continuity`: gap, angle and curvature along every edge that faces share, each with a proven bound.

mod codes;
mod html;
mod picture;
mod table;

use self::codes::{CODES, Codes};
use crate::view::ModelArgs;
use crate::{number, output, terminal};
use ::continuity::{Class, Limits, Report, Settings, Verdict, report};
use anyhow::Result;
use clap::Args;
use serde::Serialize;
use std::path::PathBuf;
use std::process::ExitCode;

/// Certify the edges that faces share: gap, angle, curvature
///
/// Each has a proven bound and the place of the worst.
///
/// Exit code 0: every edge passes. 1: an edge fails, at a place that is named. 2: an error, no shared edge, or no edge fails but
/// one is undecided. docs/continuity.md says what is proven.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  isophote continuity wing.step                 by class A: 0.01 mm and 0.1 degrees
  isophote continuity wing.step --class C
  isophote continuity wing.step --format html --out wing.html")]
pub struct ContinuityArgs {
    #[command(flatten)]
    model: ModelArgs,
    /// Limits of a class
    ///
    /// A: 0.01 and 0.1 degrees; B: 0.02 and 0.2; C: 0.05 and 0.5. Lengths are in mm, which a model without units is taken for.
    #[arg(long, value_enum, default_value_t)]
    class: ClassName,
    /// The greatest gap, model units, instead of the class's
    #[arg(long, value_name = "LEN", value_parser = number::positive, allow_hyphen_values = true)]
    gap: Option<f64>,
    /// The greatest angle between the tangent planes, degrees, instead of the class's
    #[arg(long, value_name = "DEG", value_parser = number::positive, allow_hyphen_values = true)]
    angle: Option<f64>,
    /// The greatest relative difference of the normal curvatures across the edge
    ///
    /// Without it, curvature is reported and not judged.
    #[arg(long, value_name = "REL", value_parser = number::positive, allow_hyphen_values = true)]
    curvature: Option<f64>,
    /// How near borders must run to be neighbours where the file names none, model units
    ///
    /// Unless given it is 10 gaps, and at most 1/1000 of the model.
    #[arg(long, value_name = "LEN", value_parser = number::positive, allow_hyphen_values = true)]
    reach: Option<f64>,
    /// How to answer
    #[arg(long, value_enum, default_value_t)]
    format: PageFormat,
    /// Write a picture, too: isophotes beside zebra stripes, edges by their class
    #[arg(long, value_name = "X.png")]
    overlay: Option<PathBuf>,
    /// Write to this file instead of standard output
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

/// A class by its name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, clap::ValueEnum)]
enum ClassName {
    /// 0.01 and 0.1 degrees
    #[default]
    #[value(name = "A", alias = "a")]
    A,
    /// 0.02 and 0.2 degrees
    #[value(name = "B", alias = "b")]
    B,
    /// 0.05 and 0.5 degrees
    #[value(name = "C", alias = "c")]
    C,
}

/// For people, for machines, or to sign.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, clap::ValueEnum)]
enum PageFormat {
    /// A table.
    #[default]
    Table,
    /// One JSON object.
    Json,
    /// A page with a picture, to print and sign.
    Html,
}

/// The report, and the codes of what it judges.
#[derive(Debug, Serialize)]
struct Coded<'r> {
    codes: Codes,
    #[serde(flatten)]
    report: &'r Report,
}

impl ContinuityArgs {
    /// The limits, in units of which each is so many millimetres.
    fn limits(&self, millimetres: f64) -> Limits {
        let class = match self.class {
            ClassName::A => Class::A,
            ClassName::B => Class::B,
            ClassName::C => Class::C,
        };
        let Limits { gap, angle_deg, .. } = class.limits().in_units_of(millimetres);
        Limits { gap: self.gap.unwrap_or(gap), angle_deg: self.angle.unwrap_or(angle_deg), curvature: self.curvature }
    }
}

/// Runs the command; the exit code is the verdict.
///
/// # Errors
/// Where input is bad or the file cannot be written.
pub fn run(args: &ContinuityArgs) -> Result<ExitCode> {
    args.overlay.iter().try_for_each(|path| output::check(path, "png"))?;
    args.out.iter().filter(|path| !output::is_standard(path)).try_for_each(|path| output::check_place(path))?;
    let document = args.model.document()?;
    let (model, millimetres) = (document.model, document.unit.map_or(1.0, |unit| unit.millimetres));
    let mut settings = Settings { millimetres, ..Settings::new(args.limits(millimetres), &model) };
    settings.reach = args.reach.unwrap_or(settings.reach);
    let found = report(&model, settings);
    let pictures = match (&args.overlay, args.format) {
        (None, PageFormat::Table | PageFormat::Json) => None,
        _ => Some(picture::pair(&found, &model)?),
    };
    if let (Some(path), Some(pictures)) = (&args.overlay, &pictures) {
        pictures.write_png(path)?;
    }
    let coded = Coded { codes: CODES, report: &found };
    let text = match args.format {
        PageFormat::Table => table::text(&found),
        PageFormat::Json => serde_json::to_string_pretty(&coded)?,
        PageFormat::Html => html::page(&found, pictures.as_ref().expect("a page has them"))?,
    };
    match (&args.out, args.format) {
        (Some(path), _) => output::write(path, (text + "\n").as_bytes())?,
        (None, PageFormat::Json) => terminal::json_lines(&coded)?,
        (None, _) => terminal::styled(&text)?,
    }
    Ok(ExitCode::from(code(&found)))
}

/// See [`ContinuityArgs`].
fn code(report: &Report) -> u8 {
    match report.verdict {
        _ if report.edges.is_empty() => 2,
        Verdict::Pass => 0,
        Verdict::Fail => 1,
        Verdict::Undecided => 2,
    }
}
