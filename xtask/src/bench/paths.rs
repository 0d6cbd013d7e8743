//! Suites `paths` and `strict`: frames of one technique by the GPU's rasterizer and by compute kernels, side by side; and what
//! strict arithmetic costs these.

use super::agree::disagreement;
use super::sample::Sample;
use anyhow::{Result, bail};
use clap::ValueEnum;
use comfy_table::{Table, presets::UTF8_FULL_CONDENSED};
use isophote::cost::{self, Patience};
use isophote::format::Format;
use isophote::stage::{Path, Plan, Stage};
use isophote::{say, terminal};
use scene::{Camera, Viewport};
use serde::Serialize;

/// Models that are drawn, and at which sizes; those with trims last.
const DRAWN: &[(&str, [usize; 2])] = &[
    ("teapot", [512, 512]),
    ("spray", [512, 512]),
    ("spray", [1920, 1080]),
    ("tea-s5", [1920, 1080]),
    ("aircraft", [1920, 1080]),
    ("turbine", [1920, 1080]),
];

/// What a suite draws, and by which paths.
pub struct Race {
    /// The first is that with which the others are compared.
    paths: &'static [Path],
    drawn: &'static [(&'static str, [usize; 2])],
}

/// Suite `paths`.
pub const PATHS: Race = Race { paths: &[Path::Fragment, Path::Compute, Path::Compute32], drawn: DRAWN };

/// Suite `strict`: the same atomics, in the adapter's arithmetic and in IEEE 754's. Drivers compile trimmed strict programs for minutes,
/// so there are none.
pub const STRICT: Race = Race { paths: &[Path::Compute32, Path::Strict], drawn: DRAWN.split_at(4).0 };

/// Seconds that the frames of one line may take in a round.
const SECONDS: f64 = 0.5;

/// What was measured of a model at a size by a path.
#[derive(Serialize)]
struct Line {
    model: &'static str,
    size: [usize; 2],
    triangles: usize,
    path: String,
    /// Median of the rounds, each the mean of its frames.
    frame_ms: f64,
    /// Median of the rounds' medians, by the device's clock.
    gpu_ms: Option<f64>,
    /// The least and the greatest of the rounds, by the device's clock where it has one.
    spread_ms: [f64; 2],
    /// Medians of the frame's parts in the last round, by the device's clock.
    parts_ms: Vec<(&'static str, f64)>,
    /// By how much the first path takes longer.
    speedup: f64,
}

/// Everything, as JSON has it.
#[derive(Serialize)]
struct Report {
    version: u32,
    adapter: String,
    driver: String,
    technique: &'static str,
    chord_px: f64,
    rounds: u16,
    lines: Vec<Line>,
}

/// What the command line calls a path.
fn name_of(path: Path) -> String {
    path.to_possible_value().expect("none is left out").get_name().to_owned()
}

/// Runs the suite.
///
/// # Errors
/// Where the paths' pictures disagree with the CPU rasterizer's, or the technique draws no triangles.
pub fn run(
    Race { paths, drawn }: Race,
    plan: Plan,
    device: &gpu::Device,
    (rounds, frames): (u16, usize),
    format: Format,
) -> Result<()> {
    let mut lines = vec![];
    let bar = terminal::progress("models", drawn.len());
    for &(name, size) in drawn {
        let model = models::builtin(name).expect("built in");
        for &path in paths {
            if let Some(text) = disagreement(&model, Some(device), Plan { path, ..plan })? {
                bail!("--path {}: {text}", name_of(path));
            }
        }
        let viewport = Viewport::new(size[0], size[1])?;
        let camera = Camera::framing(&model, viewport);
        let mut stage = Stage::new(&model, camera, viewport, Plan { path: paths[1], ..plan })?;
        let sample = || Sample::new(name, "ms", None);
        let mut times: Vec<_> = paths.iter().map(|_| (sample(), sample(), vec![])).collect();
        let patience = Patience { frames: frames.max(64), seconds: SECONDS };
        for _ in 0..rounds {
            for (path, (frame, gpu, parts_ms)) in paths.iter().zip(&mut times) {
                stage.plan.path = *path;
                let cost = cost::on_gpu(&stage, device, patience)?;
                frame.values.push(cost.frame_ms);
                gpu.values.extend(cost.gpu_ms);
                *parts_ms = cost.parts_ms;
            }
        }
        let triangles = stage.prepared.triangles();
        let mut measured: Vec<Line> = vec![];
        for (&path, (frame, gpu, parts_ms)) in paths.iter().zip(times) {
            let frame = frame.figure();
            let gpu = (!gpu.values.is_empty()).then(|| gpu.figure());
            let timed = gpu.as_ref().unwrap_or(&frame);
            measured.push(Line {
                model: name,
                size,
                triangles,
                path: name_of(path),
                frame_ms: frame.median,
                gpu_ms: gpu.as_ref().map(|gpu| gpu.median),
                spread_ms: [timed.least, timed.greatest],
                parts_ms,
                speedup: 1.0,
            });
        }
        let time = |line: &Line| line.gpu_ms.unwrap_or(line.frame_ms);
        let first = time(&measured[0]);
        measured.iter_mut().for_each(|line| line.speedup = first / time(line));
        lines.extend(measured);
        bar.inc(1);
    }
    bar.finish_and_clear();
    let info = device.info();
    let report = Report {
        version: 1,
        adapter: info.name.clone(),
        driver: format!("{} {}", info.driver, info.driver_info).trim().to_owned(),
        technique: plan.technique.name(),
        chord_px: plan.chord_px,
        rounds,
        lines,
    };
    match format {
        Format::Json => terminal::json(&report),
        Format::Table => print(&report),
    }
}

fn print(report: &Report) -> Result<()> {
    let Report { adapter, driver, technique, chord_px, rounds, .. } = report;
    say!("gpu: {adapter} ({driver}); technique {technique}, chord error {chord_px} px, {rounds} rounds")?;
    let mut table = Table::new();
    table.load_style(UTF8_FULL_CONDENSED);
    table.set_header([
        "model",
        "size",
        "triangles",
        "path",
        "ms a frame",
        "ms on the GPU",
        "of rounds",
        "of which",
        "x first path",
    ]);
    for line in &report.lines {
        table.add_row([
            line.model.to_owned(),
            format!("{}x{}", line.size[0], line.size[1]),
            line.triangles.to_string(),
            line.path.clone(),
            format!("{:.3}", line.frame_ms),
            line.gpu_ms.map_or_else(|| "-".to_owned(), |ms| format!("{ms:.3}")),
            format!("{:.3} … {:.3}", line.spread_ms[0], line.spread_ms[1]),
            line.parts_ms.iter().map(|(name, ms)| format!("{name} {ms:.3}")).collect::<Vec<_>>().join(", "),
            format!("{:.2}", line.speedup),
        ]);
    }
    terminal::table(&table)?;
    say!(
        "ms a frame: the processor's clock, three frames under way; ms on the GPU: its own clock, from clearing to the last pixel."
    )
}
