//! Suite `tessellation`: what Geiger (2015) and Concheiro et al. (2011) measured, for each technique on each renderer.

mod counts;
mod line;

use crate::format::Format;
use crate::number;
use crate::stage::Plan;
use crate::{say, terminal};
use anyhow::{Context, Result, bail};
use clap::Args;
use comfy_table::{Table, presets::UTF8_FULL_CONDENSED};
use counts::{Count, counts};
use line::{Line, Measuring};
use scene::Viewport;
use serde::Serialize;
use techniques::Technique;

/// How much of the suite is run.
#[derive(Debug, Args)]
pub struct TessellationArgs {
    /// Of suite tessellation: models of at most this many patches
    #[arg(long, default_value_t = 100_000, value_parser = clap::value_parser!(u32).range(26..=100_000))]
    patches: u32,
    /// Of suite tessellation: the size of the pictures, Concheiro's unless another is asked for
    #[arg(long, value_name = "WxH", default_value = "1280x1024", value_parser = size)]
    size: Viewport,
    /// Of suite tessellation: seconds that a time may take; three frames are drawn whatever they take
    #[arg(long, default_value_t = 0.5, value_parser = number::positive)]
    seconds: f64,
}

fn size(text: &str) -> Result<Viewport, String> {
    let sides = text.split_once(['x', 'X']).and_then(|(w, h)| Some((w.parse().ok()?, h.parse().ok()?)));
    let (width, height) = sides.ok_or("not WIDTHxHEIGHT, as in 1280x1024")?;
    Viewport::new(width, height).map_err(|error| error.to_string())
}

/// Concheiro's scenes that are timed: his smallest, those that his text names, and both with a table for an elephant.
const TIMED: [&str; 5] = ["tea-s1", "tea-s5", "tea-s8", "tea-s14", "tea-s16"];

/// Errors at which the aircraft has more and more triangles, pixels.
const ERRORS_PX: [f64; 5] = [8.0, 2.0, 0.5, 0.125, 0.03125];

/// What is not measured, and why.
const NOTES: [&str; 4] = [
    "Fig. 2 (002) is not measured: by how many draw calls a frame is made is no parameter of what techniques offer.",
    "Fig. 4 (002) compares with a tessellation unit, which WebGPU has not.",
    "Geiger's camera for Fig. 27 did not face the model; ours does, since what is out of view may be left out.",
    "The models have the papers' counts and shapes of our own. tea-s8 and tea-s16 are laid tables where the paper has elephants.",
];

/// Everything that was measured, as JSON has it.
#[derive(Serialize)]
struct Report<'a> {
    version: u32,
    adapter: Option<String>,
    driver: Option<String>,
    threads: usize,
    size: [usize; 2],
    error_px: f64,
    patches: u32,
    frames: usize,
    seconds: f64,
    lines: &'a [Line],
    counts: &'a [Count],
    notes: &'static [&'static str],
}

/// Runs the suite.
///
/// # Errors
/// Where renderers disagree on a model: it is not timed, and all others are.
pub fn run(
    args: &TessellationArgs,
    plan: Plan,
    device: Option<&gpu::Device>,
    frames: usize,
    format: Format,
) -> Result<()> {
    let patience = crate::cost::Patience { frames, seconds: args.seconds };
    let most = args.patches as usize;
    let mut measuring = Measuring::new(plan, args.size, device, patience, most);
    let chords: Vec<&'static dyn Technique> =
        techniques::ALL.iter().copied().filter(|technique| technique.claims() == compare::Claims::Chord).collect();
    let by_patches = "Fig. 29 (001): by patches";
    for (name, [columns, rows]) in models::QUILTS {
        let reference = "Geiger: 60 frames/s at 9,800 patches";
        measuring.model(by_patches, name, columns * rows, techniques::ALL, reference);
    }
    let whole = "Figs. 26, 30 (001): his models";
    measuring.model(whole, "aircraft", 3157, techniques::ALL, "Geiger: 185 frames/s with 6,314 triangles");
    measuring.model(whole, "turbine", 87_383, techniques::ALL, "Geiger: 9 frames/s");
    for px in ERRORS_PX {
        let reference = "Geiger: level to 1 million triangles, 60 frames/s at 3.7 million";
        measuring.at_error("Fig. 27 (001): by triangles", "aircraft", 3157, &chords, px, reference);
    }
    for scene in models::SCENES.iter().filter(|scene| TIMED.contains(&scene.name)) {
        let reference = match scene.name {
            "tea-s5" => {
                "VST 113.8, GST 10.0, Guthe 4.05 frames/s (GeForce 9800 GTX); VST 606, GST 743 (Radeon 5870); levels to 4"
            }
            _ => "a figure without numbers",
        };
        measuring.model("Fig. 3 (002): tea", scene.name, scene.patches, &chords, reference);
    }
    let (lines, disagreements) = measuring.done();
    let counts = counts(plan, args.size, most, &chords)?;
    let info = device.map(gpu::Device::info);
    let report = Report {
        version: 1,
        adapter: info.map(|info| info.name.clone()),
        driver: info.map(|info| format!("{} {}", info.driver, info.driver_info).trim().to_owned()),
        threads: rayon::current_num_threads(),
        size: [args.size.width(), args.size.height()],
        error_px: plan.chord_px,
        patches: args.patches,
        frames,
        seconds: args.seconds,
        lines: &lines,
        counts: &counts,
        notes: &NOTES,
    };
    match format {
        Format::Json => terminal::json(&report)?,
        Format::Table => print(&report)?,
    }
    match disagreements.first() {
        None => Ok(()),
        Some(first) => bail!("{} of the models by technique were not timed; the first: {first}", disagreements.len()),
    }
}

fn table(heads: &[&str], rows: impl Iterator<Item = Vec<String>>) -> Result<()> {
    let mut table = Table::new();
    table.load_style(UTF8_FULL_CONDENSED);
    table.set_header(heads);
    rows.for_each(|row| {
        table.add_row(row);
    });
    terminal::table(&table)
}

fn print(report: &Report) -> Result<()> {
    let gpu = report.adapter.as_deref().zip(report.driver.as_deref());
    let gpu = gpu.map_or_else(|| "none".to_owned(), |(adapter, driver)| format!("{adapter} ({driver})"));
    let [width, height] = report.size;
    say!("gpu: {gpu}; raster on {} threads; {width}x{height}, error {} px", report.threads, report.error_px)?;
    let figure = |line: &Line| line.figure;
    for lines in report.lines.chunk_by(|a, b| figure(a) == figure(b)) {
        say!("{}; {}", lines[0].figure, lines[0].reference)?;
        table(&line::HEADS, lines.iter().map(Line::cells))?;
        let mut told: Vec<&str> = vec![];
        for (line, why) in lines.iter().filter_map(|line| Some((line, line.not_timed.as_deref()?))) {
            if !told.contains(&why) {
                say!("not timed: {} by {} on {}: {why}", line.model, line.technique, line.renderer)?;
                told.push(why);
            }
        }
        let others = lines.iter().filter(|line| line.reference != lines[0].reference && line.renderer == "raster");
        for line in others {
            if !told.contains(&line.model.as_str()) {
                say!("{}: {}", line.model, line.reference)?;
                told.push(&line.model);
            }
        }
    }
    say!("Table 1 (002): thousands of 1,024 triangles; ours adaptive: the mean of {} views", counts::VIEWS)?;
    let first = report.counts.first().context("the least limit lets one scene through")?;
    let mut heads = vec!["scene", "N_s", "uniform L=4: paper", "ours", "adaptive L=4: paper", "adaptive L=6: paper"];
    heads.extend(first.adaptive.iter().map(|(technique, _)| *technique));
    table(&heads, report.counts.iter().map(Count::cells))?;
    report.notes.iter().try_for_each(|note| say!("- {note}"))
}
