//! What the parts of a picture cost on one thread: points, fragments, rays.

use anyhow::Result;
use glam::{DVec2, DVec3};
use nurbs::Evaluation;
use pipeline::eval::find_span;
use pipeline::fragment::{Fragment, fragment_row};
use pipeline::{PackedScene, Parameters, Scheme};
use raycast::Caster;
use scene::{Camera, Model, Projection, Ray, Viewport};
use std::hint::black_box;
use std::time::Instant;

/// Points of an evaluation sample.
pub const POINTS: usize = 65_536;

/// Points that are asked for together, a square number: their answers stay in the processor's cache.
const BATCH: usize = 1024;

/// Rays of a ray sample, a side.
const RAYS: usize = 128;

/// A reproducible sample of the unit square (an additive recurrence with the plastic number).
pub fn points() -> Vec<[f64; 2]> {
    let g = 1.324_717_957_244_746;
    (0..POINTS).map(|i| [(i as f64 / g).fract(), (i as f64 / (g * g)).fract()]).collect()
}

/// How points are asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Together {
    /// Each by itself.
    One,
    /// Some as a list, in no order.
    List,
    /// Some as a grid of ascending parameters.
    Grid,
}

/// S, S_u, S_v and the normal of a model's first surface, on one thread, ns a point.
pub fn evaluate_f64(model: &Model, points: &[[f64; 2]], together: Together) -> f64 {
    let surface = &model.surfaces()[0];
    let [[u0, u1], [v0, v1]] = surface.domain();
    let uv: Vec<DVec2> = points.iter().map(|[s, t]| DVec2::new(u0 + (u1 - u0) * s, v0 + (v1 - v0) * t)).collect();
    let mut out: Vec<Evaluation> = Vec::with_capacity(BATCH);
    let start = Instant::now();
    for uv in uv.chunks(BATCH) {
        out.clear();
        match together {
            Together::One => {
                for uv in uv {
                    let d = surface.first_derivatives(uv.x, uv.y);
                    black_box((d.s, d.su.cross(d.sv).normalize()));
                }
            }
            Together::List => surface.evaluate_many(uv, &mut out),
            Together::Grid => {
                let side = uv.len().isqrt();
                let [u, v] = [0, 1].map(|k| {
                    let mut steps: Vec<f64> = uv[..side].iter().map(|uv| uv[k]).collect();
                    steps.sort_by(f64::total_cmp);
                    steps
                });
                surface.evaluate_grid(&u, &v, &mut out);
            }
        }
        black_box(&out);
    }
    start.elapsed().as_nanos() as f64 / uv.len() as f64
}

/// The fragment program in the rasterizer's inner loop, ns a point.
///
/// # Errors
/// Where the model cannot be packed.
pub fn evaluate_f32(model: &Model, points: &[[f64; 2]]) -> Result<f64> {
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
pub fn rays(model: &Model) -> [Vec<Ray>; 2] {
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

/// The nearest hits of rays, on one thread, µs a ray.
pub fn cast(caster: &Caster, rays: &[Ray]) -> f64 {
    let start = Instant::now();
    for ray in rays {
        black_box(caster.first(ray));
    }
    start.elapsed().as_secs_f64() * 1e6 / rays.len() as f64
}
