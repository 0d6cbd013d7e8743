//! `pixel`: one pixel, stage by stage, in three columns.

use crate::compare::DrawingArgs;
use crate::stage::{Rendered, Stage};
use crate::view::{ModelArgs, ViewArgs};
use anyhow::{Context, Result, bail};
use clap::Args;
use comfy_table::{Table, presets::UTF8_FULL_CONDENSED};
use compare::ToleranceModel;
use gbuffer::Hit;
use glam::DVec3;
use nurbs::{Direction, Normal};
use raycast::Caster;
use std::process::ExitCode;

/// Explain one pixel: each stage's values in each renderer, and what the comparison says of it
#[derive(Debug, Args)]
pub struct PixelArgs {
    /// A model file (.json, .bpt) or the name of a built-in model
    model: String,
    /// Column and row, from the top left corner, from 0
    #[arg(value_name = "X,Y")]
    pixel: String,
    #[command(flatten)]
    view: ViewArgs,
    #[command(flatten)]
    drawing: DrawingArgs,
}

/// Runs the command.
///
/// # Errors
/// Where input is bad or the pixel is outside the picture.
pub fn run(args: &PixelArgs) -> Result<ExitCode> {
    let model = ModelArgs { model: args.model.clone() }.open()?;
    let viewport = args.view.viewport()?;
    let camera = args.view.camera(&model, viewport)?;
    let (x, y): (usize, usize) = args
        .pixel
        .split_once(',')
        .and_then(|(x, y)| Some((x.trim().parse().ok()?, y.trim().parse().ok()?)))
        .with_context(|| format!("{:?} is not X,Y, as in 120,80", args.pixel))?;
    if x >= viewport.width() || y >= viewport.height() {
        bail!("pixel ({x}, {y}) is outside the picture of {}x{}", viewport.width(), viewport.height());
    }
    let stage = Stage::new(&model, camera, viewport, args.drawing.plan())?;
    let caster = Caster::new(&model);
    let rendered = stage.render(&caster, args.drawing.adapter.as_deref(), None);
    let ray = camera.ray(viewport, x as f64 + 0.5, y as f64 + 0.5);
    println!("pixel ({x}, {y}) of {}x{}", viewport.width(), viewport.height());
    println!("ray   origin {}, direction {}, near {}", text(ray.origin), text(ray.direction), ray.near);
    let cast = caster.first(&ray);
    if let Some(undecided) = cast.undecided {
        println!("the ray caster is undecided: {undecided:?}");
    }
    print_columns(&stage, &rendered, x, y);
    if let Err(why) = &rendered.gpu {
        println!("gpu not run: {why}");
        return Ok(ExitCode::from(2));
    }
    for pair in stage.compare(&caster, &rendered)? {
        let verdict = pair.worst.iter().find(|p| (p.x, p.y) == (x, y));
        let words = verdict
            .map_or("agree, or not among the worst".to_owned(), |p| format!("{}: {}", p.cause.label(), p.detail));
        println!("{} | {}: {words}", pair.reference, pair.candidate);
    }
    Ok(ExitCode::SUCCESS)
}

fn print_columns(stage: &Stage, rendered: &Rendered, x: usize, y: usize) {
    let gpu = rendered.gpu.as_ref().ok().and_then(|gpu| gpu.gbuffer.get(x, y));
    let hits = [rendered.raycast.get(x, y), rendered.raster.get(x, y), gpu];
    let mut table = Table::new();
    table.load_style(UTF8_FULL_CONDENSED);
    table.set_header(["stage", "raycast (f64)", "raster (f32)", "gpu (f32)"]);
    let mut row = |name: &str, value: &dyn Fn(&Hit) -> String| {
        let cell = |hit: Option<&Hit>| hit.map_or("—".to_owned(), value);
        table.add_row([name.to_owned(), cell(hits[0]), cell(hits[1]), cell(hits[2])]);
    };
    let surface = |hit: &Hit| stage.model.surface(hit.face);
    let derivatives = |hit: &Hit| surface(hit).second_derivatives(hit.uv.x, hit.uv.y);
    row("face", &|hit| hit.face.0.to_string());
    row("u", &|hit| hit.uv.x.to_string());
    row("v", &|hit| hit.uv.y.to_string());
    row("knot span", &|hit| format!("{:?}", spans(stage, hit)));
    row("S", &|hit| text(hit.position));
    row("S_u, f64 at this (u, v)", &|hit| text(derivatives(hit).su));
    row("S_v, f64 at this (u, v)", &|hit| text(derivatives(hit).sv));
    row("|S − S f64| (tolerance)", &|hit| {
        let error = hit.position.distance(derivatives(hit).s);
        format!("{error:.3e} ({:.3e})", tolerance(stage, hit).position)
    });
    row("normal", &|hit| match hit.normal {
        Normal::Regular(n) => text(n),
        Normal::Limit(n) => format!("limit {}", text(n)),
        Normal::Undefined => "undefined".to_owned(),
    });
    row("|n − n f64| (tolerance)", &|hit| {
        let reversed = stage.model.faces()[hit.face.0 as usize].reversed;
        let exact = surface(hit).inspect(hit.uv.x, hit.uv.y).normal.unit().map(|n| if reversed { -n } else { n });
        match (hit.normal.unit(), exact, tolerance(stage, hit).normal) {
            (Some(a), Some(b), Some(allowed)) => format!("{:.3e} ({allowed:.3e})", a.distance(b)),
            _ => "no bound".to_owned(),
        }
    });
    row("k1", &|hit| hit.curvature.map_or("—".to_owned(), |k| k.k1.to_string()));
    row("k2", &|hit| hit.curvature.map_or("—".to_owned(), |k| k.k2.to_string()));
    row("t", &|hit| hit.t.to_string());
    row("off the pixel's centre, px", &|hit| {
        let picture = stage.camera.project(stage.viewport, derivatives(hit).s);
        picture.map_or("behind the near plane".to_owned(), |(p, _)| {
            format!("({:+.6}, {:+.6})", p.x - x as f64 - 0.5, p.y - y as f64 - 0.5)
        })
    });
    row("chord bound, px", &|hit| {
        let depth = stage.camera.depth(hit.position).max(f64::MIN_POSITIVE);
        format!("{:.6}", stage.proxy.chord[hit.face.0 as usize] * stage.camera.pixels_per_unit(stage.viewport, depth))
    });
    println!("{table}");
}

fn spans(stage: &Stage, hit: &Hit) -> [usize; 2] {
    let surface = stage.model.surface(hit.face);
    [surface.knots(Direction::U).find_span(hit.uv.x), surface.knots(Direction::V).find_span(hit.uv.y)]
}

fn tolerance(stage: &Stage, hit: &Hit) -> compare::Tolerance {
    let surface = stage.model.surface(hit.face);
    let point = surface.inspect(hit.uv.x, hit.uv.y);
    let model = ToleranceModel::new(surface);
    model.at(spans(stage, hit), hit.uv.x, hit.uv.y, &point.derivatives, point.curvature.as_ref())
}

fn text(v: DVec3) -> String {
    format!("({:.9}, {:.9}, {:.9})", v.x, v.y, v.z)
}
