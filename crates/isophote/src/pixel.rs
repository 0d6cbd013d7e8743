//! `pixel`: one pixel, stage by stage, in three columns; that of a saved G-buffer in words (`saved`).

mod args;
mod saved;

pub use args::PixelArgs;

use crate::view::ModelArgs;
use crate::{say, terminal};
use anyhow::{Result, bail};
use comfy_table::{ColumnConstraint, Width};
use gbuffer::Hit;
use glam::DVec3;
use nurbs::{Direction, Normal};
use pipeline::enclosure::{Enclosure, Enclosures, Interval};
use raycast::Caster;
use std::path::Path;
use std::process::ExitCode;
use suite::stage::{Rendered, Stage};

/// Characters of the columns: a number of 17 digits fits one of the last three.
const WIDTHS: [u16; 4] = [10, 19, 19, 19];

/// Blanks beside what a cell holds.
const PADDING: u16 = 2;

/// Runs the command.
///
/// # Errors
/// Where input is bad or the pixel is outside the picture.
pub fn run(args: &PixelArgs) -> Result<ExitCode> {
    if Path::new(&args.model).extension().is_some_and(|end| end.eq_ignore_ascii_case("npz")) {
        return saved::run(args);
    }
    if args.of_model.is_some() {
        bail!("--model names what a saved G-buffer (.npz) shows, and {:?} is not one", args.model);
    }
    let model = ModelArgs::named(&args.model).open()?;
    let viewport = args.view.viewport()?;
    let camera = args.view.camera(&model, viewport)?;
    let [x, y] = args.place(viewport)?;
    let stage = Stage::new(&model, camera, viewport, args.drawing.plan())?;
    let caster = Caster::new(&model);
    let rendered = stage.render(&caster, args.drawing.adapter.as_deref(), None);
    let ray = camera.ray(viewport, x as f64 + 0.5, y as f64 + 0.5);
    say!("pixel ({x}, {y}) of {}x{}", viewport.width(), viewport.height())?;
    let [origin, direction] = [ray.origin, ray.direction].map(|v| text(v).replace('\n', ", "));
    say!("ray   origin ({origin})\n      direction ({direction})\n      near {}", ray.near)?;
    let cast = caster.first(&ray);
    if let Some(undecided) = cast.undecided {
        say!("the ray caster is undecided: {undecided:?}")?;
    }
    print_columns(&stage, &rendered, x, y)?;
    if let Err(why) = &rendered.gpu {
        say!("gpu not run: {why}")?;
        return Ok(ExitCode::from(2));
    }
    for (reference, candidate, verdict) in stage.pixel(&caster, &rendered, [x, y])? {
        let open = verdict.unbounded.map_or("agree".to_owned(), |reason| format!("no verdict: {}", reason.label()));
        let cause = verdict.cause.map_or(open, |cause| cause.label().to_owned());
        say!("{reference} | {candidate}: {cause}: {}", verdict.detail)?;
        let share = |share: Option<f64>| share.map_or("—".to_owned(), |share| format!("{:.1} %", 100.0 * share));
        let compare::Shares { position, normal, curvature, ambiguous, .. } = verdict.shares;
        say!("  of the intervals: S {}, n {}, k {}", share(position), share(normal), share(curvature))?;
        if ambiguous {
            say!("  f32 leaves a decision open here: any of its answers is right")?;
        }
    }
    Ok(ExitCode::SUCCESS)
}

fn print_columns(stage: &Stage, rendered: &Rendered, x: usize, y: usize) -> Result<()> {
    let gpu = rendered.gpu.as_ref().ok().and_then(|gpu| gpu.gbuffer.get(x, y));
    let hits = [rendered.raycast.get(x, y), rendered.raster.get(x, y), gpu];
    let mut table = terminal::narrow_table();
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
    row("place on the spans", &|hit| {
        hit.local.map_or("—".to_owned(), |local| format!("{:?}\n{}\n{}", local.span, local.uv.x, local.uv.y))
    });
    row("S", &|hit| text(hit.position));
    row("S_u, f64 at this (u, v)", &|hit| text(derivatives(hit).su));
    row("S_v, f64 at this (u, v)", &|hit| text(derivatives(hit).sv));
    let enclosures = |hit: &Hit| stage.enclosures(hit, true);
    row("interval of S, local", &|hit| intervals(&enclosures(hit), |e| e.position));
    row("S, local", &|hit| {
        let frame = &stage.scene.frames()[hit.face.0 as usize];
        let s = (hit.position - frame.origin) / frame.scale;
        s.to_array().map(|x| format!("{x:+.9e}")).join("\n")
    });
    row("normal", &|hit| match hit.normal {
        Normal::Regular(n) => text(n),
        Normal::Limit(n) => format!("limit\n{}", text(n)),
        Normal::Undefined => "undefined".to_owned(),
    });
    row("interval of the normal", &|hit| intervals(&enclosures(hit), |e| e.normal));
    row("k1", &|hit| hit.curvature.map_or("—".to_owned(), |k| k.k1.to_string()));
    row("k2", &|hit| hit.curvature.map_or("—".to_owned(), |k| k.k2.to_string()));
    row("interval of k1, k2", &|hit| {
        let scale = stage.scene.frames()[hit.face.0 as usize].scale;
        intervals(&enclosures(hit), |e| e.curvature.map(|k| k.map(|k| k.scaled(1.0 / scale))))
    });
    row("decisions", &|hit| {
        let each = enclosures(hit)
            .iter()
            .map(|e| format!("spans {:?}: {:?}", e.on.map(|on| on.span), e.regularity))
            .collect::<Vec<_>>();
        each.join("\n")
    });
    row("t", &|hit| hit.t.to_string());
    row("off the pixel's centre, px", &|hit| {
        let picture = stage.camera.project(stage.viewport, derivatives(hit).s);
        picture.map_or("behind the near plane".to_owned(), |(p, _)| {
            format!("{:+.6}\n{:+.6}", p.x - x as f64 - 0.5, p.y - y as f64 - 0.5)
        })
    });
    row("chord bound, px", &|hit| {
        let depth = stage.camera.depth(hit.position).max(f64::MIN_POSITIVE);
        let chord = stage.prepared.chord().get(hit.face.0 as usize).into_iter().flatten();
        let chord = chord.fold(0.0, |most: f64, chord| most.max(*chord));
        format!("{:.6}", chord * stage.camera.pixels_per_unit(stage.viewport, depth))
    });
    for (column, width) in WIDTHS.into_iter().enumerate() {
        let column = table.column_mut(column).expect("the header has four");
        column.set_constraint(ColumnConstraint::Absolute(Width::Fixed(width + PADDING)));
    }
    terminal::table(&table)
}

fn spans(stage: &Stage, hit: &Hit) -> [usize; 2] {
    let surface = stage.model.surface(hit.face);
    [surface.knots(Direction::U).find_span(hit.uv.x), surface.knots(Direction::V).find_span(hit.uv.y)]
}

/// A line for each coordinate, under each other for each pair of spans.
fn intervals<const N: usize>(enclosures: &Enclosures, of: impl Fn(&Enclosure) -> Option<[Interval; N]>) -> String {
    let one = |enclosure: &Enclosure| match of(enclosure) {
        None => "no bound".to_owned(),
        Some(intervals) => intervals.map(|x| format!("{:+.9e}\n  ± {:.2e}", x.middle, x.half_width)).join("\n"),
    };
    enclosures.iter().map(one).collect::<Vec<_>>().join("\nor\n")
}

/// The components of a vector, each on a line.
fn text(v: DVec3) -> String {
    v.to_array().map(|x| format!("{x:.9}")).join("\n")
}
