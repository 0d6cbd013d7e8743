//! `bench`: what each part costs, in one interleaved run, medians and ratios.

mod agree;
mod frames;
mod kernels;
mod parts;
mod paths;
mod sample;
mod tessellation;
mod trimming;

use agree::disagreement;
use anyhow::{Result, bail};
use clap::{Args, ValueEnum};
use comfy_table::{Table, presets::UTF8_FULL_CONDENSED};
use compare::Claims;
use frames::{Frames, turning};
use isophote::compare::DrawingArgs;
use isophote::format::Format;
use isophote::stage::{Plan, Stage};
use isophote::{say, terminal};
use parts::{Together, cast, evaluate_f32, evaluate_f64, points, rays};
use raycast::Caster;
use sample::{Figure, Sample};
use scene::{Camera, Model, Viewport};
use std::hint::black_box;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;
use tessellation::TessellationArgs;
use trimming::Trimming;

/// Kanai's Table 1: a model, cells a face so that the triangles are about his, his frames per second on a GeForce
/// 7900 GTX in 2007.
const TABLE_1: &[(&str, usize, f64)] = &[("surface", 50, 212.0), ("teapot", 10, 201.0), ("spray", 10, 126.0)];

/// Time evaluation, rays, the CPU rasterizer and the GPU, and print medians
///
/// Refuses to time renderers whose pictures disagree. Everything is measured in one run, round by round.
#[derive(Debug, Args)]
pub struct BenchArgs {
    #[command(flatten)]
    drawing: DrawingArgs,
    /// What is timed
    #[arg(long, value_enum, default_value = "parts")]
    suite: Suite,
    #[command(flatten)]
    tessellation: TessellationArgs,
    /// Rounds of suite parts; the median of each figure is printed
    #[arg(long, default_value_t = 7, value_parser = clap::value_parser!(u16).range(1..=1000))]
    rounds: u16,
    /// Frames of the GPU a round, where the CPU draws one; of suite tessellation, at most, on either
    #[arg(long, default_value_t = 8, value_parser = clap::value_parser!(u16).range(1..=10000))]
    frames: u16,
    /// Side of the square picture of Table 1, pixels
    #[arg(long, default_value_t = 512)]
    side: usize,
    /// Of suite kernels: the report of an earlier run (`--format json`) that this one is held to
    #[arg(long, value_name = "FILE")]
    baseline: Option<PathBuf>,
    /// What callgrind counts: one kernel, `--repeats` times
    #[arg(long, hide = true)]
    kernel: Option<String>,
    #[arg(long, hide = true, default_value_t = 1)]
    repeats: usize,
    /// For people or for machines
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

/// What is timed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Suite {
    /// Evaluation, rays, Kanai's Table 1, judging and trimming
    Parts,
    /// Geiger's Figs. 27, 29 and 30, Concheiro's Table 1 and Fig. 3: frames by patches and by triangles, for each technique
    Tessellation,
    /// Who finds the triangles on the GPU: frames by its rasterizer, and by compute kernels with each kind of atomics
    Paths,
    /// What strict arithmetic costs: frames by kernels with 32-bit atomics, and by --path strict
    Strict,
    /// Instructions of the CPU's kernels, counted by valgrind's callgrind: other programs on the machine do not count
    Kernels,
}

/// Runs the command. Code 1: a kernel takes a tenth more instructions than the baseline says.
///
/// # Errors
/// Where renderers disagree, the named adapter is not there, or callgrind cannot count.
pub fn run(args: &BenchArgs) -> Result<ExitCode> {
    if let Some(kernel) = &args.kernel {
        kernels::work(kernel, args.repeats)?;
        return Ok(ExitCode::SUCCESS);
    }
    if args.suite == Suite::Kernels {
        return kernels::run(args.baseline.as_deref(), args.format);
    }
    time(args)?;
    Ok(ExitCode::SUCCESS)
}

fn time(args: &BenchArgs) -> Result<()> {
    let device = match gpu::Device::open(args.drawing.adapter.as_deref()) {
        Ok(device) => Some(device),
        Err(error) if args.drawing.adapter.is_some() => return Err(error.into()),
        Err(error) => {
            terminal::note(format_args!("gpu not run: {error}"));
            None
        }
    };
    if args.suite == Suite::Tessellation {
        let frames = usize::from(args.frames);
        return tessellation::run(&args.tessellation, args.drawing.plan(), device.as_ref(), frames, args.format);
    }
    let of_paths = match args.suite {
        Suite::Paths => Some(paths::PATHS),
        Suite::Strict => Some(paths::STRICT),
        _ => None,
    };
    if let Some(of_paths) = of_paths {
        let Some(device) = &device else { bail!("suites of paths time the GPU, and there is none") };
        let amount = (args.rounds, usize::from(args.frames));
        return paths::run(of_paths, args.drawing.plan(), device, amount, args.format);
    }
    let viewport = Viewport::new(args.side, args.side)?;
    let models: Vec<(Model, usize, f64)> =
        TABLE_1.iter().map(|&(name, cells, fps)| (models::builtin(name).expect("built in"), cells, fps)).collect();
    for (model, _, _) in &models {
        for &technique in techniques::ALL {
            if let Some(text) = disagreement(model, device.as_ref(), Plan { technique, ..args.drawing.plan() })? {
                bail!(text);
            }
        }
    }
    let rational = models::builtin("rational").expect("built in");
    let points = points();
    let caster = Caster::new(&rational);
    let [top_down, grazing] = rays(&rational);
    let mut evaluation = [
        Sample::new("S, S_u, S_v, normal; bicubic rational, f64, one thread", "ns/point", "≤ 96".to_owned()),
        Sample::new("the same, a list in no order", "ns/point", "below the first line".to_owned()),
        Sample::new("the same, a grid", "ns/point", "≤ half of the first line".to_owned()),
        Sample::new(
            "the same in the rasterizer's inner loop, f32, runs of one span",
            "ns/point",
            "below the first line".to_owned(),
        ),
    ];
    let mut casting = [
        Sample::new("ray, top-down, bicubic rational 14x6, one thread", "µs/ray", "≤ 12".to_owned()),
        Sample::new("ray, grazing, the same", "µs/ray", "≤ 35".to_owned()),
    ];
    let adapter = device.as_ref().map(|d| format!("{} ({} {})", d.info().name, d.info().driver, d.info().driver_info));
    let drawn = models.iter().flat_map(|of_model| techniques::ALL.iter().map(move |technique| (of_model, *technique)));
    let mut drawing: Vec<[Sample; 2]> = drawn
        .clone()
        .map(|((model, _, fps), technique)| {
            let reference = match technique.claims() {
                Claims::Chord => format!("Kanai, GeForce 7900 GTX: {fps}"),
                Claims::OnRay => "≥ 1/4 of technique fragment".to_owned(),
            };
            let what = format!("{} {}x{}, {}", model.name(), args.side, args.side, technique.name());
            ["raster", "gpu"].map(|renderer| Sample::new(format!("{renderer}, {what}"), "frames/s", reference.clone()))
        })
        .collect();
    let mut checking: Vec<Sample> = drawn
        .clone()
        .map(|((model, ..), technique)| {
            let what = format!("raycast | raster, {} {}x{}, {}", model.name(), args.side, args.side, technique.name());
            Sample::new(format!("checking {what}"), "× the slower renderer", "≤ 3".to_owned())
        })
        .collect();
    let mut trimming = Trimming::new(args.side)?;
    let bar = isophote::terminal::progress("rounds", usize::from(args.rounds));
    for round in 0..args.rounds {
        for (sample, together) in evaluation.iter_mut().zip([Together::One, Together::List, Together::Grid]) {
            sample.values.push(evaluate_f64(&rational, &points, together));
        }
        evaluation[3].values.push(evaluate_f32(&rational, &points)?);
        casting[0].values.push(cast(&caster, &top_down));
        casting[1].values.push(cast(&caster, &grazing));
        for (((model, cells, _), technique), [raster, on_gpu]) in drawn.clone().zip(&mut drawing) {
            let cameras = turning(model, viewport, usize::from(args.frames), f64::from(round));
            let frames =
                Frames::new(model, Plan { technique, ..args.drawing.plan() }, Some(*cells), &cameras, viewport)?;
            raster.values.push(frames.on_cpu());
            if let Some(device) = &device {
                on_gpu.values.push(frames.on_gpu(device)?);
            }
        }
        for (((model, ..), technique), sample) in drawn.clone().zip(&mut checking) {
            sample.values.push(check(model, viewport, Plan { technique, ..args.drawing.plan() })?);
        }
        let frames = usize::from(args.frames);
        trimming.measure(device.as_ref(), args.drawing.plan(), viewport, frames, f64::from(round))?;
        bar.inc(1);
    }
    bar.finish_and_clear();
    let figures: Vec<Figure> = evaluation
        .into_iter()
        .chain(casting)
        .chain(drawing.into_iter().flatten())
        .chain(checking)
        .chain(trimming.samples())
        .filter(|sample| !sample.values.is_empty())
        .map(Sample::figure)
        .collect();
    print(args, adapter.as_deref(), &figures)
}

fn print(args: &BenchArgs, adapter: Option<&str>, figures: &[Figure]) -> Result<()> {
    let threads = rayon::current_num_threads();
    if args.format == Format::Json {
        say!("{}", serde_json::json!({ "adapter": adapter, "threads": threads, "figures": figures }))?;
        return Ok(());
    }
    say!("gpu: {}; raster on {threads} threads; medians of {} rounds", adapter.unwrap_or("none"), args.rounds)?;
    let mut table = Table::new();
    table.load_style(UTF8_FULL_CONDENSED);
    table.set_header(["what", "median", "least", "greatest", "unit", "to compare with"]);
    let number = |x: f64| if x >= 100.0 { format!("{x:.0}") } else { format!("{x:.2}") };
    for f in figures {
        let reference = f.reference.clone().unwrap_or_default();
        table.add_row([
            f.what.clone(),
            number(f.median),
            number(f.least),
            number(f.greatest),
            f.unit.to_owned(),
            reference,
        ]);
    }
    terminal::table(&table)?;
    Ok(())
}

/// The time of comparing a picture of the rasterizer with one of the ray caster, over that of the slower of the two.
fn check(model: &Model, viewport: Viewport, plan: Plan) -> Result<f64> {
    let stage = Stage::new(model, Camera::framing(model, viewport), viewport, plan)?;
    let caster = Caster::new(model);
    let seconds = |since: Instant| since.elapsed().as_secs_f64();
    let start = Instant::now();
    let raycast = stage.raycast(&caster);
    let cast = seconds(start);
    let start = Instant::now();
    let raster = stage.raster();
    let drawn = seconds(start);
    let start = Instant::now();
    black_box(stage.against_raycast(&caster, &raycast, &raster)?);
    Ok(seconds(start) / cast.max(drawn))
}
