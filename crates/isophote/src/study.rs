//! `study`: the seeds' argument on one machine. Kanai evaluates at the fragment, Guthe, Geiger and Concheiro at grids' corners.

mod error;
mod goal;
mod page;
mod plot;
pub mod report;
mod row;
mod table;
mod worst;

use crate::approximate::ApproximateArgs;
use crate::compare::Shade;
use crate::cost::Patience;
use crate::format::Format;
use crate::number;
use crate::view::{ModelArgs, ViewArgs};
use crate::{output, say, terminal};
use anyhow::Result;
use clap::Args;
use gbuffer::GBuffer;
use raycast::Caster;
use std::path::PathBuf;
use suite::embedded::data_uri;
use suite::stage::{Plan, Stage};
use techniques::Technique;

pub use error::{Errors, Place, Spread};
pub use goal::Goal;
pub use page::{Worst, page};
pub use report::{Adapter, Report};
pub use row::{Measured, Outcome, Row, Scene};

/// Compare all techniques at equal triangles, then at equal error
///
/// It says how far off they are, and what a frame costs.
///
/// Every technique is made to meet each budget of triangles and each bound on the error in pixels. Printed of each: errors in
/// pixels and degrees against the ray caster, the greatest, the 99th percentile and where; outlines; triangles; time on CPU and
/// GPU; bytes held and sent. A technique that fails is shown with its reason; a renderer that disagrees is not timed.
#[derive(Debug, Args)]
#[command(after_help = "\
Example:
  isophote study teapot --size 128x96 --out study")]
pub struct StudyArgs {
    #[command(flatten)]
    model: ModelArgs,
    #[command(flatten)]
    view: ViewArgs,
    /// Part of the GPU adapter's name (`isophote adapters`)
    #[arg(long, help_heading = "What is measured", value_name = "NAME")]
    adapter: Option<String>,
    #[command(flatten)]
    approximate: ApproximateArgs,
    /// Budgets of triangles
    ///
    /// Unless given: 8, 32, 128 and 512 for each Bézier patch, two million at most.
    #[arg(long, help_heading = "What is measured", value_delimiter = ',')]
    triangles: Vec<usize>,
    /// Errors, pixels
    #[arg(long, help_heading = "What is measured", value_delimiter = ',', value_name = "PX", default_values_t = [4.0, 1.0, 0.5, 0.25], value_parser = number::error_px)]
    errors: Vec<f64>,
    /// Frames of a time, at most
    #[arg(long, help_heading = "What is measured", default_value_t = 100, value_parser = clap::value_parser!(u16).range(3..=10000))]
    frames: u16,
    /// Seconds that a time may take
    #[arg(long, help_heading = "What is measured", default_value_t = 0.5, value_parser = number::positive)]
    seconds: f64,
    /// Write report.json and study.html to this folder
    ///
    /// The page has plots, and pictures at the worst pixels.
    #[arg(long, help_heading = "Output", value_name = "DIR")]
    out: Option<PathBuf>,
    /// For people or for machines
    #[arg(long, help_heading = "Output", value_enum, default_value_t)]
    format: Format,
}

/// Runs the command.
///
/// # Errors
/// Where input is bad, the named adapter is not there, or the answer cannot be written.
pub fn run(args: &StudyArgs) -> Result<()> {
    // Before minutes of work.
    let _lock = args.out.as_deref().map(output::claim).transpose()?;
    let model = args.model.open()?;
    let viewport = args.view.viewport()?;
    let camera = args.view.camera(&model, viewport)?;
    let device = match gpu::Device::open(args.adapter.as_deref()) {
        Err(error) if args.adapter.is_some() => return Err(error.into()),
        device => device.map_err(|error| error.to_string()),
    };
    let patience = Patience { frames: usize::from(args.frames), seconds: args.seconds };
    let budgets = if args.triangles.is_empty() { budgets(report::patches(&model)) } else { args.triangles.clone() };
    let triangles = budgets.into_iter().map(Goal::Triangles);
    let goals: Vec<Goal> = triangles.chain(args.errors.iter().map(|&px| Goal::Error(px))).collect();
    // What follows prepares by each technique anew: this one only packs the model.
    let drawn = args.approximate.drawn(&model, &camera, viewport)?;
    let plan = Plan { chord_px: number::MAX_ERROR_PX, ..Plan::default() };
    let stage = match &drawn {
        None => Stage::new(&model, camera, viewport, plan)?,
        Some(drawn) => {
            terminal::note(format_args!("{}", drawn.facts.line()));
            Stage::new(&drawn.model, camera, viewport, plan)?.in_place_of(&model, &drawn.stand_in)?
        }
    };
    let adapter = device.as_ref().map(Adapter::of).map_err(Clone::clone);
    let report = Report::new(stage.model, camera, viewport, adapter, patience);
    let stage = Stage { plan: Plan::default(), ..stage };
    let (report, worst) = study(&stage, techniques::ALL, &goals, device.as_ref().ok(), patience, report)?;
    if let Some(folder) = &args.out {
        output::folder(folder)?;
        output::write_json(&folder.join("report.json"), &report)?;
        output::write(&folder.join("study.html"), page(&report, &worst)?.as_bytes())?;
    }
    match args.format {
        Format::Json => terminal::json(&report),
        Format::Table => print(&report, args.out.as_deref()),
    }
}

/// Triangles for each patch by which budgets go up.
const PER_PATCH: [usize; 4] = [8, 32, 128, 512];

/// The greatest budget that is not asked for: half of what techniques draw at most.
const GREATEST_BUDGET: usize = 2_000_000;

/// The budgets of a model of so many patches, each larger than the one before.
fn budgets(patches: usize) -> Vec<usize> {
    let mut budgets = PER_PATCH.map(|per_patch| (per_patch * patches).min(GREATEST_BUDGET)).to_vec();
    budgets.dedup();
    budgets
}

/// The rows of `techniques` at all goals, and the pictures at the worst pixel of each that was drawn.
///
/// # Errors
/// Where a picture cannot be encoded; what happens to a technique is in its row.
pub fn study(
    stage: &Stage,
    techniques: &[&'static dyn Technique],
    goals: &[Goal],
    device: Option<&gpu::Device>,
    patience: Patience,
    mut report: Report,
) -> Result<(Report, Vec<Worst>)> {
    let caster = Caster::new(stage.truth());
    let exact = stage.raycast(&caster);
    let scene = Scene { stage, caster: &caster, exact: &exact, device, patience };
    let shaded = |buffer: &GBuffer| buffer.shaded(&Shade::Isophotes.shading(), stage.model, &stage.camera);
    let truth = shaded(&exact)?;
    let mut worst = vec![];
    for &goal in goals.iter().chain(&[Goal::Own]) {
        for &technique in techniques.iter().filter(|technique| goal.suits(**technique)) {
            let (row, picture) = row::row(&scene, technique, goal);
            let at = match &row.outcome {
                Outcome::Measured(measured) => measured.errors.offset_px.at,
                Outcome::Failed(_) => None,
            };
            if let Some((picture, at)) = picture.zip(at) {
                let own = worst::surroundings(&shaded(&picture)?, at.pixel)?;
                let pictures = [data_uri(&own)?, data_uri(&worst::surroundings(&truth, at.pixel)?)?];
                worst.push(Worst { row: report.rows.len(), pictures });
            }
            report.rows.push(row);
        }
    }
    Ok((report, worst))
}

fn print(report: &Report, out: Option<&std::path::Path>) -> Result<()> {
    for fact in page::facts(report) {
        say!("{fact}")?;
    }
    for columns in table::PARTS {
        let mut part = terminal::narrow_table();
        let keys = 0..table::KEYS;
        part.set_header(keys.clone().chain(columns.clone()).map(|k| table::HEADS[k]));
        for cells in report.rows.iter().map(table::cells) {
            part.add_row(keys.clone().chain(columns.clone()).map(|k| cells[k].clone()));
        }
        terminal::table(&part)?;
    }
    for (row, measured) in report.measured() {
        for why in &measured.not_timed {
            say!("not timed: {}, {}: {why}", row.technique, row.goal)?;
        }
    }
    for caveat in report.caveats {
        say!("- {caveat}")?;
    }
    if let Some(folder) = out {
        say!("report.json and study.html are in {}", folder.display())?;
    }
    Ok(())
}
