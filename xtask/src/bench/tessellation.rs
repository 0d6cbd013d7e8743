//! Suite `tessellation`: what Geiger (2015) and Concheiro et al. (2011) measured, for each technique on each renderer.

mod counts;
mod line;

use anyhow::{Result, bail};
use clap::Args;
use comfy_table::{Table, presets::UTF8_FULL_CONDENSED};
use counts::{Count, counts, of_paper};
use isophote::format::Format;
use isophote::number;
use isophote::stage::Plan;
use isophote::{say, terminal};
use line::{Line, Measuring};
use models::TeaScene;
use pipeline::GREATEST_TRIANGLES;
use scene::Viewport;
use serde::Serialize;
use techniques::zones::ByZones;
use techniques::{Limits, Technique};

/// How much of the suite is run.
#[derive(Debug, Args)]
pub struct TessellationArgs {
    /// Of suite tessellation: models of at most this many patches
    #[arg(long, default_value_t = 100_000, value_parser = clap::value_parser!(u32).range(26..=100_000))]
    patches: u32,
    /// Of suite tessellation: this model alone
    #[arg(long, value_name = "NAME", value_parser = timed_model)]
    only: Option<String>,
    /// Of suite tessellation: the size of the pictures, Concheiro's unless another is asked for
    #[arg(long, value_name = "WxH", default_value = "1280x1024", value_parser = size)]
    size: Viewport,
    /// Of suite tessellation: seconds that a time may take; three frames are drawn whatever they take
    #[arg(long, default_value_t = 0.5, value_parser = number::positive)]
    seconds: f64,
}

/// The name of a model that the suite times.
fn timed_model(text: &str) -> Result<String, String> {
    match models::PUBLISHED.iter().any(|(name, _)| *name == text) {
        true => Ok(text.to_owned()),
        false => Err("none of aircraft, turbine, tea-s1 … tea-s16, quilt-100 … quilt-100000".to_owned()),
    }
}

fn size(text: &str) -> Result<Viewport, String> {
    let sides = text.split_once(['x', 'X']).and_then(|(w, h)| Some((w.parse().ok()?, h.parse().ok()?)));
    let (width, height) = sides.ok_or("not WIDTHxHEIGHT, as in 1280x1024")?;
    Viewport::new(width, height).map_err(|error| error.to_string())
}

/// Concheiro's scenes that are timed: his smallest, those that his text names, and both with a table for an elephant.
const TIMED: [&str; 5] = ["tea-s1", "tea-s5", "tea-s8", "tea-s14", "tea-s16"];

/// Error at which tea-s5 comes to about as many triangles with L = 4 as in the paper, pixels: 504 thousands of 1,024, and 510.
const PAPER_PX: f64 = 0.16;

/// Error of Fig. 2, pixels: so small that its levels decide.
const FIG_2_PX: f64 = 0.03125;

/// Errors at which the aircraft has more and more triangles, pixels.
const ERRORS_PX: [f64; 5] = [8.0, 2.0, 0.5, 0.125, 0.03125];

/// Draw calls a frame in Concheiro's Fig. 2, and the levels L that it has lines of.
const DRAW_CALLS: [u32; 6] = [1, 2, 4, 8, 16, 32];

/// See there.
const FIG_2_LEVELS: [u32; 3] = [4, 5, 6];

/// What is measured in another way than in the papers, and what is not.
const NOTES: [&str; 6] = [
    "Fig. 2 (002) varies the draw calls of VST; ours has one for each size of tiles, so the steps of technique zones are varied.",
    "Of normals at corners few have a bound in the pictures of 96 x 96 pixels that are compared before: no pixel may differ, that is all.",
    "Concheiro's L = 4 has 31 cells along a side of a patch, ours at most 32. Technique fragment has no levels.",
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
    let patience = isophote::cost::Patience { frames, seconds: args.seconds };
    let is_asked = |name: &str, patches: usize| {
        patches <= args.patches as usize && args.only.as_ref().is_none_or(|only| only == name)
    };
    let mut measuring = Measuring::new(plan, args.size, device, patience, &is_asked);
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
        let plan = Plan { chord_px: px, ..plan };
        measuring.drawn("Fig. 27 (001): by triangles", "aircraft", 3157, &chords, plan, reference);
    }
    // Where a picture is small its cells are no smaller than pixels, and few interpolated normals have a bound: none may differ.
    let as_drawn_there = Plan { vertex_normals: true, unbounded_share: 1.0, ..plan };
    for scene in models::SCENES.iter().filter(|scene| TIMED.contains(&scene.name)) {
        let reference = match scene.name {
            "tea-s5" => {
                "VST 113.8, GST 10.0, Guthe 4.05 frames/s (GeForce 9800 GTX); VST 606, GST 743 (Radeon 5870); levels to 4"
            }
            _ => "a figure without numbers",
        };
        measuring.model("Fig. 3 (002): tea", scene.name, scene.patches, &chords, reference);
        // As he draws: levels to 4, and normals of the triangles' corners.
        for px in [plan.chord_px, PAPER_PX] {
            let plan = Plan { chord_px: px, limits: of_paper(4), ..as_drawn_there };
            measuring.drawn("Fig. 3 (002): tea, L = 4", scene.name, scene.patches, &chords, plan, reference);
        }
    }
    let s5 = models::SCENES.iter().find(|scene| scene.name == "tea-s5").expect("built in");
    for (level, calls) in FIG_2_LEVELS.into_iter().flat_map(|level| DRAW_CALLS.map(|calls| (level, calls))) {
        let batch = Some((s5.patches as u32).div_ceil(calls));
        let limits = Limits { batch, zones: u32::MAX, triangles: GREATEST_TRIANGLES, ..of_paper(level) };
        let plan = Plan { chord_px: FIG_2_PX, limits, ..as_drawn_there };
        let reference =
            "1.42 times as fast in 4 calls as in 1 with L = 5, 1.31 times in 8 with L = 6 (GeForce 9800 GTX)";
        measuring.drawn("Fig. 2 (002): by patches a step", s5.name, s5.patches, &[&ByZones], plan, reference);
    }
    let (lines, disagreements) = measuring.done();
    let scenes: Vec<&TeaScene> = models::SCENES.iter().filter(|scene| is_asked(scene.name, scene.patches)).collect();
    let counts = counts(plan, args.size, &scenes, &chords)?;
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

fn table<T: ToString>(heads: &[T], rows: impl Iterator<Item = Vec<String>>) -> Result<()> {
    let mut table = Table::new();
    table.load_style(UTF8_FULL_CONDENSED);
    table.set_header(heads.iter().map(T::to_string));
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
    if let Some(first) = report.counts.first() {
        say!("Table 1 (002): thousands of 1,024 triangles; ours adaptive: the mean of {} views", counts::VIEWS)?;
        let heads = ["scene", "N_s", "uniform L=4: paper", "ours", "adaptive L=4: paper", "adaptive L=6: paper"];
        let mut heads = heads.map(str::to_owned).to_vec();
        heads.extend(first.adaptive.iter().map(|(technique, _)| format!("{technique}, L=4 / L=6")));
        table(&heads, report.counts.iter().map(Count::cells))?;
    }
    report.notes.iter().try_for_each(|note| say!("- {note}"))
}
