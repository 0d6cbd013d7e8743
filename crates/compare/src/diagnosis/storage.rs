//! Pictures that are right before their numbers were rounded for storage.
//!
//! What was rounded away cannot be had again. So the question is whether a sound picture rounds to this one: of each number
//! the interval is known that rounds to it, and there the one is taken that comes nearest to the model.

use super::fault::Fault;
use super::view::{Hypothesis, Seen, View};
use gbuffer::Hit;
use glam::{DVec2, DVec3};
use nurbs::Normal;
use scene::Ray;

/// How often parameters are brought nearer to what the other numbers say: what a step leaves is of second order in steps
/// between half floats, so after four nothing is left.
const TURNS: usize = 4;

/// A number is one of a lattice where it is this near to it, in steps: narrowing to f32 leaves 1e-5.
const ON_LATTICE: f64 = 1e-3;

/// Significant bits of a half float, and the exponent of its least normal number (IEEE 754 binary16).
const HALF_BITS: i32 = 11;
const HALF_LEAST: i32 = -14;

/// The step between half floats about `x`.
fn half_step(x: f64) -> f64 {
    let exponent = if x == 0.0 { HALF_LEAST } else { (x.abs().log2().floor() as i32).max(HALF_LEAST) };
    f64::from(exponent + 1 - HALF_BITS).exp2()
}

fn is_half(x: f64) -> bool {
    (x / half_step(x)).fract() == 0.0
}

/// The point of the box of half-width `reach` about `center` that is nearest to `wanted`.
fn within(wanted: DVec3, center: DVec3, reach: DVec3) -> DVec3 {
    wanted.clamp(center - reach, center + reach)
}

fn half_reach(v: DVec3) -> DVec3 {
    0.5 * DVec3::from_array(v.to_array().map(half_step))
}

/// Half floats in some arrays, or normals of 8 bits.
pub(super) fn hypotheses(view: &View, samples: &[Seen]) -> Vec<Hypothesis> {
    [half_floats(view, samples), eight_bits(view, samples)].into_iter().flatten().collect()
}

fn half_floats(view: &View, samples: &[Seen]) -> Option<Hypothesis> {
    let all = |numbers: &dyn Fn(&Hit) -> Vec<f64>| samples.iter().all(|s| numbers(&s.hit).into_iter().all(is_half));
    let unit = |hit: &Hit| hit.normal.unit().map_or(vec![], |n| n.to_array().to_vec());
    let rounded = Rounded {
        parameters: all(&|hit| hit.uv.to_array().to_vec()),
        position: all(&|hit| hit.position.to_array().to_vec()),
        normal: all(&unit),
        distance: all(&|hit| vec![hit.t]),
    };
    let Rounded { parameters, position, normal, distance } = rounded;
    let named = [("u", parameters), ("v", parameters), ("pos", position), ("normal", normal), ("t", distance)];
    let arrays: Vec<&'static str> = named.into_iter().filter(|(_, is)| *is).map(|(name, _)| name).collect();
    if arrays.is_empty() {
        return None;
    }
    let viewport = view.buffer.viewport();
    let undone = view.made(|x, y| {
        let hit = view.buffer.get(x, y)?;
        if !hit.uv.is_finite() {
            return Some(*hit);
        }
        let ray = view.camera.ray(viewport, x as f64 + 0.5, y as f64 + 0.5);
        let mut sound = Hit { local: None, ..*hit };
        if parameters {
            sound.uv = parameters_of(view, hit, &ray, rounded);
        }
        let s = view.model.surface(hit.face).point(sound.uv.x, sound.uv.y);
        if position {
            sound.position = within(s, hit.position, half_reach(hit.position));
        }
        if distance {
            let reach = 0.5 * half_step(hit.t);
            sound.t = (s - ray.origin).dot(ray.direction).clamp(hit.t - reach, hit.t + reach);
        }
        if normal && let (Some(shown), Some(n)) = (hit.normal.unit(), view.normal(&sound)) {
            sound.normal = Normal::Regular(within(n, shown, half_reach(shown)));
        }
        Some(sound)
    });
    Some(view.hypothesis(Fault::HalfFloats { arrays }, undone))
}

/// Which arrays hold half floats.
#[derive(Clone, Copy)]
struct Rounded {
    parameters: bool,
    position: bool,
    normal: bool,
    distance: bool,
}

/// Parameters that round to a hit's own, and at which the model rounds to all else that it says, as far as such can be found.
///
/// About a place the model's numbers are linear in u and v, so each rounded number leaves a strip of the plane. The box of
/// what rounds to u and v is cut by all strips, and the middle of what is left is the next place. A position that is not
/// rounded is followed by itself.
fn parameters_of(view: &View, hit: &Hit, ray: &Ray, rounded: Rounded) -> DVec2 {
    let surface = view.model.surface(hit.face);
    let sign = if view.model.faces()[hit.face.0 as usize].reversed { -1.0 } else { 1.0 };
    let [[u0, u1], [v0, v1]] = surface.domain();
    let reach = 0.5 * DVec2::new(half_step(hit.uv.x), half_step(hit.uv.y));
    let low = (hit.uv - reach).max(DVec2::new(u0, v0));
    let high = (hit.uv + reach).min(DVec2::new(u1, v1)).max(low);
    let mut uv = hit.uv.clamp(low, high);
    for _ in 0..TURNS {
        let d = surface.second_derivatives(uv.x, uv.y);
        if !rounded.position {
            // Least squares on the tangent plane.
            let (a, b, c) = (d.su.length_squared(), d.su.dot(d.sv), d.sv.length_squared());
            let (p, q) = (d.su.dot(hit.position - d.s), d.sv.dot(hit.position - d.s));
            let step = DVec2::new(p * c - q * b, q * a - p * b) / (a * c - b * b);
            uv = if step.is_finite() { (uv + step).clamp(low, high) } else { uv };
            continue;
        }
        let mut strips = vec![];
        let mut hold = |value: f64, along_u: f64, along_v: f64, stored: f64| {
            let (gradient, reach) = (DVec2::new(along_u, along_v), 0.5 * half_step(stored));
            strips.push((gradient, stored - reach - value, stored + reach - value));
        };
        (0..3).for_each(|k| hold(d.s[k], d.su[k], d.sv[k], hit.position[k]));
        let cross = d.su.cross(d.sv);
        if let Normal::Regular(shown) = hit.normal
            && rounded.normal
            && cross != DVec3::ZERO
        {
            let n = cross.normalize();
            let along = |c: DVec3| sign * (c - c.dot(n) * n) / cross.length();
            let n_u = along(d.suu.cross(d.sv) + d.su.cross(d.suv));
            let n_v = along(d.suv.cross(d.sv) + d.su.cross(d.svv));
            (0..3).for_each(|k| hold(sign * n[k], n_u[k], n_v[k], shown[k]));
        }
        if rounded.distance {
            let t = (d.s - ray.origin).dot(ray.direction);
            hold(t, d.su.dot(ray.direction), d.sv.dot(ray.direction), hit.t);
        }
        let [a, b] = [low - uv, high - uv];
        let mut left = vec![a, DVec2::new(b.x, a.y), b, DVec2::new(a.x, b.y)];
        for (gradient, least, most) in strips {
            left = cut(left, gradient, most);
            left = cut(left, -gradient, -least);
        }
        uv = (uv + left.iter().sum::<DVec2>() / left.len() as f64).clamp(low, high);
    }
    uv
}

/// The part of a convex polygon where gradient · p ≤ most (Sutherland & Hodgman 1974, doi:10.1145/360767.360802); all of it
/// where there is none.
fn cut(polygon: Vec<DVec2>, gradient: DVec2, most: f64) -> Vec<DVec2> {
    let beyond = |p: DVec2| gradient.dot(p) - most;
    let mut left = vec![];
    for (i, &p) in polygon.iter().enumerate() {
        let q = polygon[(i + 1) % polygon.len()];
        let (at_p, at_q) = (beyond(p), beyond(q));
        if at_p <= 0.0 {
            left.push(p);
        }
        if (at_p < 0.0) != (at_q < 0.0) && at_p != at_q {
            left.push(p + (q - p) * (at_p / (at_p - at_q)));
        }
    }
    if left.is_empty() { polygon } else { left }
}

/// Normals on a lattice of 8 bits, of −1 to 1 as 0 to 255, or of −127 to 127.
fn eight_bits(view: &View, samples: &[Seen]) -> Option<Hypothesis> {
    let units: Vec<DVec3> = samples.iter().filter_map(|seen| seen.hit.normal.unit()).collect();
    let on = |steps: f64, offset: f64| {
        let is_on = |x: f64| {
            let place = x * steps + offset;
            (place - place.round()).abs() <= ON_LATTICE
        };
        !units.is_empty() && units.iter().all(|n| n.to_array().into_iter().all(is_on))
    };
    let steps = [(127.5, 127.5), (127.0, 0.0)].into_iter().find(|&(steps, offset)| on(steps, offset))?.0;
    let reach = DVec3::splat((0.5 + ON_LATTICE) / steps);
    let undone = view.each(|hit| match (hit.normal, view.normal(hit)) {
        (Normal::Regular(shown), Some(n)) => Hit { normal: Normal::Regular(within(n, shown, reach)), ..*hit },
        _ => *hit,
    });
    Some(view.hypothesis(Fault::NormalsOfEightBits, undone))
}
