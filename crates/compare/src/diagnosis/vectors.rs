//! Pictures whose normals or positions are right but for the axes they are by, or for one step of their making.

use super::fault::{Fault, Stored};
use super::view::{Hypothesis, Seen, View, mostly};
use gbuffer::Hit;
use glam::{DVec3, DVec4};
use nurbs::{Direction, Normal, Surface, basis_derivatives};

/// Normals within this angle of each other, radians, are taken for one to be tried: f32 leaves a millionth.
const ALIKE_RAD: f64 = 1e-3;

/// Positions within this share of the model's size are taken for one to be tried.
const ALIKE_SHARE: f64 = 1e-4;

/// What turns the shown normals, or positions, into the model's.
pub(super) fn hypotheses<'a>(view: &'a View, samples: &[Seen]) -> Vec<Hypothesis> {
    let mut found = vec![];
    let is_normal = |turn: &dyn Fn(DVec3) -> DVec3| {
        mostly(samples, |seen| match (seen.hit.normal.unit(), seen.normal) {
            (Some(shown), Some(n)) => turn(shown).distance(n) <= ALIKE_RAD,
            _ => false,
        })
    };
    // Where normals are right there is no telling what else would make them so.
    if !is_normal(&|n| n) {
        found.extend(turns(view).find(|(_, turn)| is_normal(turn)).map(|(fault, turn)| {
            view.hypothesis(fault, view.each(|hit| Hit { normal: turned(hit.normal, &turn), ..*hit }))
        }));
        found.extend(of_numerator(view, samples));
    }
    let size = view.model.hull().diagonal();
    for (fault, turn) in [
        (Fault::PositionsEncoded, Box::new(decoded) as Turn<'a>),
        (Fault::PositionsOfView, Box::new(|p| view.camera.eye() + from_view(view, p, false))),
    ] {
        let is_near = |seen: &Seen| turn(seen.hit.position).distance(seen.s) <= ALIKE_SHARE * size;
        if mostly(samples, is_near) && !mostly(samples, |seen| seen.hit.position.distance(seen.s) <= ALIKE_SHARE * size)
        {
            let undone = view.each(|hit| Hit { position: turn(hit.position), ..*hit });
            found.push(view.hypothesis(fault, undone));
        }
    }
    found
}

type Turn<'a> = Box<dyn Fn(DVec3) -> DVec3 + 'a>;

/// What may have been done to all normals, the simplest first, each with what undoes it.
fn turns<'a>(view: &'a View) -> impl Iterator<Item = (Fault, Turn<'a>)> {
    let first: [(Fault, Turn<'a>); 3] = [
        (Fault::NormalsFlipped, Box::new(|n| -n)),
        (Fault::NormalsOfView { forward: false }, Box::new(|n| from_view(view, n, false))),
        (Fault::NormalsOfView { forward: true }, Box::new(|n| from_view(view, n, true))),
    ];
    let orders = [[1, 0, 2], [0, 2, 1], [2, 1, 0], [1, 2, 0], [2, 0, 1], [0, 1, 2]];
    let signs = (0..8u32).map(|bits| [0, 1, 2].map(|axis| bits >> axis & 1 == 1));
    let swaps = signs.flat_map(move |negated| orders.map(move |order| (order, negated)));
    first.into_iter().chain(swaps.map(|(order, negated)| {
        let stored = [0, 1, 2].map(|k| Stored { axis: order[k], negated: negated[k] });
        let undo = move |n: DVec3| {
            let mut own = DVec3::ZERO;
            for (k, Stored { axis, negated }) in stored.into_iter().enumerate() {
                own[axis] = if negated { -n[k] } else { n[k] };
            }
            own
        };
        (Fault::NormalsSwapped { stored }, Box::new(undo) as Turn<'a>)
    }))
}

fn turned(normal: Normal, turn: &dyn Fn(DVec3) -> DVec3) -> Normal {
    match normal {
        Normal::Regular(n) => Normal::Regular(turn(n)),
        Normal::Limit(n) => Normal::Limit(turn(n)),
        Normal::Undefined => Normal::Undefined,
    }
}

/// A vector by the camera's axes, in the world's.
fn from_view(view: &View, v: DVec3, forward: bool) -> DVec3 {
    let depth = if forward { v.z } else { -v.z };
    v.x * view.camera.right() + v.y * view.camera.above() + depth * view.camera.forward()
}

/// The inverse of the sRGB transfer function (IEC 61966-2-1), of either sign.
fn decoded(p: DVec3) -> DVec3 {
    let linear = |x: f64| if x <= 0.04045 { x / 12.92 } else { ((x + 0.055) / 1.055).powf(2.4) };
    DVec3::from_array(p.to_array().map(|x| linear(x.abs()).copysign(x)))
}

/// Normals of A_u × A_v, where S = A / w: about the world's origin, or the surface's own.
fn of_numerator(view: &View, samples: &[Seen]) -> Option<Hypothesis> {
    let is_of = |hit: &Hit, of_world: bool| {
        let surface = view.model.surface(hit.face);
        let reversed = view.model.faces()[hit.face.0 as usize].reversed;
        let sign = if reversed { -1.0 } else { 1.0 };
        let n =
            surface.weights().filter(|_| hit.uv.is_finite()).map(|_| sign * numerator_normal(surface, hit, of_world));
        hit.normal.unit().zip(n).is_some_and(|(shown, n)| shown.distance(n) <= ALIKE_RAD)
    };
    let of_world = [true, false].into_iter().find(|&of_world| mostly(samples, |seen| is_of(&seen.hit, of_world)))?;
    let undone = view.each(|hit| match view.normal(hit) {
        Some(n) if is_of(hit, of_world) => Hit { normal: turned(hit.normal, &|_| n), ..*hit },
        _ => *hit,
    });
    Some(view.hypothesis(Fault::NormalsOfNumerator, undone))
}

fn numerator_normal(surface: &Surface, hit: &Hit, of_world: bool) -> DVec3 {
    let [ku, kv] = [Direction::U, Direction::V].map(|direction| surface.knots(direction));
    let (k, l) = (ku.find_span(hit.uv.x), kv.find_span(hit.uv.y));
    let nu = basis_derivatives(ku, k, hit.uv.x, 1);
    let nv = basis_derivatives(kv, l, hit.uv.y, 1);
    let columns = surface.control_counts()[1];
    let (mut along_u, mut along_v) = (DVec4::ZERO, DVec4::ZERO);
    for i in 0..=ku.degree() {
        for j in 0..=kv.degree() {
            let at = (k - ku.degree() + i) * columns + l - kv.degree() + j;
            let c = DVec4::from_array(surface.homogeneous()[at]);
            along_u += nu[1][i] * nv[0][j] * c;
            along_v += nu[0][i] * nv[1][j] * c;
        }
    }
    let origin = if of_world { surface.origin() } else { DVec3::ZERO };
    let [a, b] = [along_u, along_v].map(|d| d.truncate() + d.w * origin);
    a.normalize_or_zero().cross(b.normalize_or_zero()).normalize_or_zero()
}
