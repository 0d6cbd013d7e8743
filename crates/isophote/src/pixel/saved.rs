//! `pixel B.npz X,Y`: a saved G-buffer's pixel in words.

use super::args::PixelArgs;
use crate::compare::{Saved, SavedPixel};
use crate::say;
use crate::words;
use anyhow::{Result, bail};
use compare::{PixelVerdict, Shares};
use gbuffer::{Hit, Meta};
use glam::DVec3;
use nurbs::Normal;
use std::path::PathBuf;
use std::process::ExitCode;
use suite::text::escaped;

/// Runs the command on a saved file.
pub(super) fn run(args: &PixelArgs) -> Result<ExitCode> {
    if let Some(option) = args.view.given().or(args.drawing.adapter.as_ref().map(|_| "--adapter")) {
        bail!("{option} does not go with a saved G-buffer, which brings its own camera, size and adapter");
    }
    let path = PathBuf::from(&args.model);
    let saved = Saved::open(std::slice::from_ref(&path), args.of_model.as_deref())?;
    let [x, y] = args.place(saved.viewport)?;
    let SavedPixel { cast, verdict, allowed } =
        saved.pixel(args.drawing.plan(), args.drawing.trim.masks_px(), [x, y])?;
    let buffer = &saved.files[0].buffer;
    let Meta { renderer, technique, .. } = buffer.meta();
    say!("pixel ({x}, {y}) of {}x{}, {}", saved.viewport.width(), saved.viewport.height(), escaped(&args.model))?;
    say!("{}, technique {}, shows:", escaped(renderer), escaped(technique))?;
    let own = buffer.get(x, y);
    tell(&saved, own, [x, y])?;
    if let Some(hit) = own {
        held(&saved, hit, [x, y])?;
    }
    say!("the ray through the pixel's centre meets:")?;
    tell(&saved, cast.hit.as_ref(), [x, y])?;
    if let Some(undecided) = cast.undecided {
        say!("  the ray caster is undecided: {undecided:?}")?;
    }
    if let Some((hit, ray)) = own.zip(cast.hit.as_ref()) {
        apart(&saved, hit, ray)?;
    }
    let PixelVerdict { cause, detail, unbounded, shares } = verdict;
    say!("allowed: {allowed}")?;
    match (cause, unbounded) {
        (Some(cause), _) => say!("verdict: it differs, by {}: {detail}", cause.label())?,
        (None, Some(reason)) => say!("verdict: none, {}: {detail}", reason.label())?,
        (None, None) => say!("verdict: it agrees: {detail}")?,
    }
    let Shares { position, normal, curvature, ambiguous, .. } = shares;
    let share = |share: Option<f64>| share.map_or("—".to_owned(), |share| format!("{:.1} %", 100.0 * share));
    say!("  of the intervals: S {}, n {}, k {}", share(position), share(normal), share(curvature))?;
    if ambiguous {
        say!("  f32 leaves a decision open here: any of its answers is right")?;
    }
    if cause.is_some() {
        let model = args.of_model.iter().flat_map(|name| words::option("--model", name));
        let compare = ["isophote", "compare", &args.model].map(str::to_owned).into_iter().chain(model);
        say!("next: {}", words::line(compare.chain(["--report", "report.html"].map(str::to_owned))))?;
    }
    Ok(ExitCode::SUCCESS)
}

/// What is seen, in a line a fact.
fn tell(saved: &Saved, hit: Option<&Hit>, [x, y]: [usize; 2]) -> Result<()> {
    let Some(hit) = hit else { return say!("  nothing") };
    say!("  face {} at (u, v) = ({}, {})", hit.face.0, hit.uv.x, hit.uv.y)?;
    say!("  place {}, {} from the ray's origin", point(hit.position), hit.t)?;
    let normal = match hit.normal {
        Normal::Regular(n) => point(n),
        Normal::Limit(n) => format!("{}, a limit", point(n)),
        Normal::Undefined => "undefined".to_owned(),
    };
    let curvature = hit.curvature.map_or("no curvatures".to_owned(), |k| format!("curvatures {} and {}", k.k1, k.k2));
    say!("  normal {normal}; {curvature}")?;
    match saved.camera.project(saved.viewport, hit.position) {
        None => say!("  that place is behind the near plane"),
        Some((p, _)) => {
            // Rounded to what is printed, without the sign of nought.
            let [right, down] = [p.x - x as f64 - 0.5, p.y - y as f64 - 0.5].map(|px| (px * 1e4).round() / 1e4 + 0.0);
            say!("  that place is seen {right:+.4} px right of the centre and {down:+.4} px below it")
        }
    }
}

/// How far what a file holds is from what the surface has there.
fn held(saved: &Saved, hit: &Hit, [x, y]: [usize; 2]) -> Result<()> {
    let surface = saved.model.surface(hit.face);
    let s = surface.point(hit.uv.x, hit.uv.y);
    let seen = saved.camera.project(saved.viewport, s).map_or(String::new(), |(p, _)| {
        let off = glam::DVec2::new(x as f64 + 0.5, y as f64 + 0.5).distance(p);
        format!("; S(u, v) is seen {off:.4} px from the centre")
    });
    say!("  S(u, v) is {:.3e} units from that place{seen}", s.distance(hit.position))
}

/// How far two hits are from each other.
fn apart(saved: &Saved, hit: &Hit, ray: &Hit) -> Result<()> {
    let across =
        saved.camera.project(saved.viewport, hit.position).zip(saved.camera.project(saved.viewport, ray.position));
    let across = across.map_or(String::new(), |((a, _), (b, _))| format!(", {:.4} px", a.distance(b)));
    let turned = hit.normal.unit().zip(ray.normal.unit());
    let turned = turned.map(|(a, b)| a.cross(b).length().atan2(a.dot(b)).to_degrees());
    let turned = turned.map_or(String::new(), |degrees| format!("; the normals are {degrees:.3e}° apart"));
    let faces = if hit.face == ray.face { "the same face" } else { "another face" };
    say!("the two: {faces}, {:.3e} units{across} apart{turned}", hit.position.distance(ray.position))
}

fn point(v: DVec3) -> String {
    format!("({}, {}, {})", v.x, v.y, v.z)
}
