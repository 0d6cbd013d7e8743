//! `bench`: what each part costs, in one interleaved run, medians and ratios.

mod agree;
mod frames;
mod sample;
mod tessellation;
mod trimming;

use agree::disagreement;
use anyhow::{Result, bail};
use clap::{Args, ValueEnum};
use comfy_table::{Table, presets::UTF8_FULL_CONDENSED};
use compare::Claims;
use frames::{Frames, turning};
use glam::DVec3;
use isophote::compare::DrawingArgs;
use isophote::format::Format;
use isophote::stage::{Plan, Stage};
use isophote::{say, terminal};
use pipeline::eval::find_span;
use pipeline::fragment::{Fragment, fragment_row};
use pipeline::{PackedScene, Parameters, Scheme};
use raycast::Caster;
use sample::{Figure, Sample};
use scene::{Camera, Model, Projection, Ray, Viewport};
use std::hint::black_box;
use std::time::Instant;
use tessellation::TessellationArgs;
use trimming::Trimming;

/// Kanai's Table 1: a model, cells a face so that the triangles are about his, his frames per second on a GeForce
/// 7900 GTX in 2007.
const TABLE_1: &[(&str, usize, f64)] = &[("surface", 50, 212.0), ("teapot", 10, 201.0), ("spray", 10, 126.0)];

/// Points of an evaluation sample.
const POINTS: usize = 65_536;

/// Rays of a ray sample, a side.
const RAYS: usize = 128;

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
}

/// Runs the command.
///
/// # Errors
/// Where renderers disagree, or the named adapter is not there.
pub fn run(args: &BenchArgs) -> Result<()> {
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
        Sample::new(
            "the same in the rasterizer's inner loop, f32, runs of one span",
            "ns/point",
            "below the line above".to_owned(),
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
        evaluation[0].values.push(evaluate_f64(&rational, &points));
        evaluation[1].values.push(evaluate_f32(&rational, &points)?);
        casting[0].values.push(cast(&caster, &top_down));
        casting[1].values.push(cast(&caster, &grazing));
        for (((model, cells, _), technique), [raster, on_gpu]) in drawn.clone().zip(&mut drawing) {
            let cameras = turning(model, viewport, usize::from(args.frames), f64::from(round));
            let frames = Frames::new(model, technique, args.drawing.plan().scheme, Some(*cells), &cameras, viewport)?;
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

/// A reproducible sample of the unit square (an additive recurrence with the plastic number).
fn points() -> Vec<[f64; 2]> {
    let g = 1.324_717_957_244_746;
    (0..POINTS).map(|i| [(i as f64 / g).fract(), (i as f64 / (g * g)).fract()]).collect()
}

fn evaluate_f64(model: &Model, points: &[[f64; 2]]) -> f64 {
    let surface = &model.surfaces()[0];
    let [[u0, u1], [v0, v1]] = surface.domain();
    let uv: Vec<[f64; 2]> = points.iter().map(|[s, t]| [u0 + (u1 - u0) * s, v0 + (v1 - v0) * t]).collect();
    let start = Instant::now();
    for &[u, v] in &uv {
        let d = surface.first_derivatives(u, v);
        black_box((d.s, d.su.cross(d.sv).normalize()));
    }
    start.elapsed().as_nanos() as f64 / uv.len() as f64
}

fn evaluate_f32(model: &Model, points: &[[f64; 2]]) -> Result<f64> {
    let scene = PackedScene::new(model, Scheme::Specialised)?;
    let mut uv: Vec<[f32; 2]> = points.iter().map(|uv| uv.map(|t| t as f32)).collect();
    // As a rasterizer meets them: one span after the other.
    let starts = scene.starts(&scene.faces()[0]);
    uv.sort_by_key(|uv| [0, 1].map(|k| find_span(starts[k], uv[k])));
    let uv: Vec<Parameters> = uv
        .into_iter()
        .map(|uv| {
            let span = [0, 1].map(|k| find_span(starts[k], uv[k]) as u32);
            let spans = scene.spans(&scene.faces()[0], span);
            Parameters { span, uv: [0, 1].map(|k| spans[k].local(uv[k])) }
        })
        .collect();
    let mut out: Vec<Fragment> = Vec::with_capacity(uv.len());
    let start = Instant::now();
    fragment_row(&scene, 0, &uv, false, &mut out);
    let time = start.elapsed().as_nanos() as f64;
    black_box(&out);
    Ok(time / uv.len() as f64)
}

/// Rays straight down on a model's first face, and rays that skim it at 4°.
fn rays(model: &Model) -> [Vec<Ray>; 2] {
    let hull = model.hull();
    let (center, size) = (hull.center(), hull.diagonal());
    let viewport = Viewport::new(RAYS, RAYS).expect("a legal size");
    let grid = |direction: DVec3, up: DVec3, height: f64| {
        let eye = center - direction.normalize() * size;
        let camera = Camera::look_at(eye, center, up, Projection::Orthographic { height }).expect("a legal camera");
        let pixels = (0..RAYS * RAYS).map(move |i| (i % RAYS, i / RAYS));
        pixels.map(move |(x, y)| camera.ray(viewport, x as f64 + 0.5, y as f64 + 0.5)).collect()
    };
    [grid(-DVec3::Z, DVec3::Y, size / 2.0), grid(DVec3::new(-1.0, 0.0, -0.07), DVec3::Z, size / 4.0)]
}

fn cast(caster: &Caster, rays: &[Ray]) -> f64 {
    let start = Instant::now();
    for ray in rays {
        black_box(caster.first(ray));
    }
    start.elapsed().as_secs_f64() * 1e6 / rays.len() as f64
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
