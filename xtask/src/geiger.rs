//! `geiger`: Figs. 17, 32 and 33 of Geiger's thesis on trimming textures, on the CPU and on the GPU.

mod zoom;

use anyhow::Result;
use clap::Args;
use comfy_table::{Table, presets::UTF8_FULL_CONDENSED};
use gbuffer::Picture;
use glam::{DVec3, dvec2};
use gpu::{Device, MaskBlend, MaskPainter};
use isophote::compare::Shade;
use isophote::format::Format;
use isophote::stage::{Plan, Stage};
use isophote::view::ModelArgs;
use isophote::{output, say, terminal};
use nurbs::{KnotVector, Surface};
use pipeline::mask::{MaskFill, MaskOptions, MaskPlan, MaskQuality, Trimming};
use scene::{Camera, Face, Loop, Model, Projection, Trim, Viewport};
use serde::Serialize;
use std::hint::black_box;
use std::path::PathBuf;
use std::time::Instant;

/// Resolutions of Fig. 32, texels a side.
const SIDES: [u32; 6] = [64, 128, 256, 512, 1024, 2048];

/// Samplings of Fig. 33, chords a curve.
const CHORDS: [u32; 7] = [1, 2, 4, 8, 16, 32, 64];

/// Reproduce Geiger's Figs. 17, 32 and 33: what trimming textures show, and what they cost to set up
///
/// Draws an ellipse whose mask has too few texels, too few chords, too few of both, and enough of both, and as the exact
/// trims show it, side by side in fig17.png; in zoom.png, a trim edge at 20 times the size by masks, exactly, and by 16
/// samples a pixel. Then times the masks of MODEL: planning them, drawing them on the CPU by
/// scan lines and by ears, and on the GPU by fans; first by resolution, with 64 chords a curve, then by chords, at 1024 texels a
/// side.
#[derive(Debug, Args)]
pub struct GeigerArgs {
    /// A model file or the name of a built-in model (see `isophote info --list`)
    #[arg(value_name = "MODEL", default_value = "pieces")]
    model: String,
    /// The most memory of all masks together, MB of a million bytes; beyond it they are made coarser, and the table says so
    #[arg(long, value_name = "MB", default_value_t = 256)]
    mask_memory: u32,
    /// Rounds; medians are printed
    #[arg(long, default_value_t = 3, value_parser = clap::value_parser!(u16).range(1..=100))]
    rounds: u16,
    /// Part of the GPU adapter's name [default: a hardware one, else a software one]
    #[arg(long, value_name = "NAME")]
    adapter: Option<String>,
    /// Where the pictures go
    #[arg(long, value_name = "DIR", default_value = "out/geiger")]
    out: PathBuf,
    /// For people or for machines
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

/// What masks of one quality cost.
#[derive(Debug, Clone, Serialize)]
struct Cost {
    side: u32,
    chords: u32,
    /// Bytes of the atlas.
    bytes: u64,
    /// By how much the masks are coarser than `side`, for want of memory.
    coarser: f64,
    plan_ms: f64,
    even_odd_ms: f64,
    earcut_ms: f64,
    gpu_ms: Option<f64>,
}

/// Runs the command.
///
/// # Errors
/// Where input is bad, the named adapter is not there, or the picture cannot be written.
pub fn run(args: &GeigerArgs) -> Result<()> {
    let device = match Device::open(args.adapter.as_deref()) {
        Ok(device) => Some(device),
        Err(error) if args.adapter.is_some() => return Err(error.into()),
        Err(error) => {
            terminal::note(format_args!("gpu not run: {error}"));
            None
        }
    };
    let picture = ellipses()?;
    output::folder(&args.out)?;
    picture.write_png(args.out.join("fig17.png"))?;
    let zoomed = zoom::pictures()?;
    zoomed.write_png(args.out.join("zoom.png"))?;
    let model = ModelArgs::named(&args.model).open()?;
    let cost = |side, chords| cost(&model, device.as_ref(), [side, chords], args);
    let by_side: Vec<Cost> = SIDES.into_iter().map(|side| cost(side, 64)).collect::<Result<_>>()?;
    let by_chords: Vec<Cost> = CHORDS.into_iter().map(|chords| cost(1024, chords)).collect::<Result<_>>()?;
    let adapter = device.as_ref().map(|device| device.info().name.clone());
    if args.format == Format::Json {
        let report = serde_json::json!({
            "model": model.name(), "faces": model.faces().len(), "adapter": adapter,
            "threads": rayon::current_num_threads(), "by_side": by_side, "by_chords": by_chords,
        });
        return terminal::json(&report);
    }
    terminal::show(&picture)?;
    say!(
        "too few texels, too few chords, too few of both, enough of both, exact: {}",
        args.out.join("fig17.png").display()
    )?;
    terminal::show(&zoomed)?;
    say!("{}: {}", zoom::SHOWS, args.out.join("zoom.png").display())?;
    say!(
        "{}: masks of {} faces; gpu: {}; {} threads; medians of {} rounds",
        model.name(),
        model.faces().len(),
        adapter.as_deref().unwrap_or("none"),
        rayon::current_num_threads(),
        args.rounds
    )?;
    print(&by_side)?;
    print(&by_chords)
}

fn print(costs: &[Cost]) -> Result<()> {
    let mut table = Table::new();
    table.load_style(UTF8_FULL_CONDENSED);
    table.set_header(["texels a side", "chords", "MB", "plan, ms", "even-odd, ms", "earcut, ms", "gpu fans, ms"]);
    let ms = |x: f64| format!("{x:.2}");
    for c in costs {
        let coarser = if c.coarser > 1.0 { format!(" (÷ {:.2})", c.coarser) } else { String::new() };
        table.add_row([
            format!("{}{coarser}", c.side),
            c.chords.to_string(),
            format!("{:.2}", c.bytes as f64 / 1e6),
            ms(c.plan_ms),
            ms(c.even_odd_ms),
            ms(c.earcut_ms),
            c.gpu_ms.map_or("—".to_owned(), ms),
        ]);
    }
    terminal::table(&table)
}

fn cost(model: &Model, device: Option<&Device>, [side, chords]: [u32; 2], args: &GeigerArgs) -> Result<Cost> {
    let viewport = Viewport::new(zoom::SIDE, zoom::SIDE)?;
    let camera = Camera::framing(model, viewport);
    let memory = u64::from(args.mask_memory) * 1_000_000;
    let quality = MaskQuality::Fixed { side, chords };
    let options = MaskOptions { quality, memory, ..MaskOptions::default() };
    let plan = MaskPlan::new(model, &camera, viewport, &options)?;
    let median = |work: &mut dyn FnMut() -> Result<()>| -> Result<f64> {
        let mut times = vec![];
        for _ in 0..args.rounds {
            let start = Instant::now();
            work()?;
            times.push(start.elapsed().as_secs_f64() * 1e3);
        }
        times.sort_by(f64::total_cmp);
        Ok(times[times.len() / 2])
    };
    let filled = |fill| {
        median(&mut || {
            black_box(plan.fill(fill));
            Ok(())
        })
    };
    let (even_odd_ms, earcut_ms) = (filled(MaskFill::EvenOdd)?, filled(MaskFill::Earcut)?);
    let plan_ms = median(&mut || {
        black_box(MaskPlan::new(model, &camera, viewport, &options)?);
        Ok(())
    })?;
    let gpu_ms = device.map(|device| {
        let painter = MaskPainter::new(device, MaskBlend::Parity)?;
        median(&mut || {
            black_box(painter.draw(device, &plan)?);
            Ok(())
        })
    });
    Ok(Cost {
        side,
        chords,
        bytes: plan.bytes(),
        coarser: plan.coarser,
        plan_ms,
        even_odd_ms,
        earcut_ms,
        gpu_ms: gpu_ms.transpose()?,
    })
}

/// Fig. 17, and what it should look like.
fn ellipses() -> Result<Picture> {
    let model = ellipse()?;
    let viewport = Viewport::new(zoom::SIDE, zoom::SIDE)?;
    let center = model.hull().center();
    let projection = Projection::Orthographic { height: 1.1 };
    let camera = Camera::look_at(center + DVec3::Z, center, DVec3::Y, projection)?;
    let fixed = |side, chords| MaskOptions { quality: MaskQuality::Fixed { side, chords }, ..MaskOptions::default() };
    let trims = [
        Trimming::Texture(fixed(20, 64)),
        Trimming::Texture(fixed(1024, 1)),
        Trimming::Texture(fixed(20, 1)),
        Trimming::Texture(MaskOptions::default()),
        Trimming::Exact,
    ];
    let mut pictures = vec![];
    for trim in trims {
        let stage = Stage::new(&model, camera, viewport, Plan { trim, ..Plan::default() })?;
        pictures.push(stage.raster().shaded(&Shade::Checker.shading(), &model, &camera)?);
    }
    Ok(Picture::beside(&pictures.iter().collect::<Vec<_>>()))
}

/// A flat square with an ellipse of two cubic Bézier curves for its boundary.
fn ellipse() -> Result<Model> {
    let line = || KnotVector::new(1, vec![0.0, 0.0, 1.0, 1.0]);
    let corners = [[0.0, 0.0], [0.0, 1.0], [1.0, 0.0], [1.0, 1.0]].map(|[x, y]| DVec3::new(x, y, 0.0));
    let surface = Surface::new(line()?, line()?, corners.to_vec(), None)?;
    let half = |turn: f64| -> Result<Trim> {
        let at = |x: f64, y: f64| dvec2(0.5 + turn * x, 0.5 + turn * y);
        // A half of an ellipse, to the eye: the handles are 4/3 of the half axis.
        let points = vec![at(0.45, 0.0), at(0.45, 0.4), at(-0.45, 0.4), at(-0.45, 0.0)];
        let knots = KnotVector::new(3, vec![0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0])?;
        Ok(Trim::new(knots, points, None))
    };
    let boundary = Loop { outer: true, trims: vec![half(1.0)?, half(-1.0)?] };
    Ok(Model::new("ellipse", vec![surface], vec![Face { loops: vec![boundary], ..Face::whole(0) }])?)
}
