//! Rays, boxes and numbers of the field: the f64 side.

use super::field;
use super::models::hostile;
use formats::read;
use gbuffer::GBuffer;
use glam::{DVec2, DVec3};
use nurbs::{Direction, Surface};
use raycast::Caster;
use scene::{Camera, FaceId, Model, Viewport};
use std::path::PathBuf;

fn opened(path: PathBuf) -> Model {
    read(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

fn cast(model: &Model) -> GBuffer {
    let viewport = Viewport::new(48, 36).expect("legal");
    Caster::new(model).render(&Camera::framing(model, viewport), viewport, &|_| ())
}

/// The model of one surface with its points and weights times other factors.
fn scaled(model: &Model, by_points: f64, by_weights: f64) -> Model {
    let surface = model.surface(FaceId(0));
    let [u, v] = [Direction::U, Direction::V].map(|direction| surface.knots(direction).clone());
    let weights = surface.weights().map(|weights| weights.iter().map(|w| w * by_weights).collect());
    let points = surface.points().iter().map(|&p| p * by_points).collect();
    Model::of_surfaces("scaled", vec![Surface::new(u, v, points, weights).expect("legal")]).expect("a model")
}

/// Pixels that only one of two pictures covers, or whose distances differ by more than rounding; and those that both cover.
fn differences(a: &GBuffer, b: &GBuffer, scale: f64) -> (usize, usize) {
    let (mut differ, mut both) = (0, 0);
    for (x, y) in (0..36).flat_map(|y| (0..48).map(move |x| (x, y))) {
        match (a.get(x, y), b.get(x, y)) {
            (Some(a), Some(b)) => {
                both += 1;
                differ += usize::from(1e-9 * a.t < (a.t - b.t / scale).abs());
            }
            (a, b) => differ += usize::from(a.is_some() != b.is_some()),
        }
    }
    (differ, both)
}

#[test]
fn a_sphere_cut_by_tilted_planes_is_boxed_and_fills_the_default_view() {
    let model = opened(field("23-sphere-tilted-cuts"));
    let hull = model.hull();
    assert!(hull.max.cmple(DVec3::splat(2.02)).all() && hull.min.cmpge(DVec3::splat(-2.02)).all(), "{hull:?}");
    let buffer = cast(&model);
    let covered =
        (0..36).flat_map(|y| (0..48).map(move |x| (x, y))).filter(|&(x, y)| buffer.get(x, y).is_some()).count();
    assert!(0.4 < covered as f64 / (48.0 * 36.0), "{covered} pixels");
}

#[test]
fn coordinates_of_any_legal_size_are_cast_alike() {
    for name in ["sc-39", "tiny-1e-163"] {
        let model = opened(hostile(name));
        let size = model.hull().diagonal();
        let (differ, both) = differences(&cast(&scaled(&model, 1.0 / size, 1.0)), &cast(&model), size);
        assert!(differ <= 1 && 300 < both, "{name}: {differ} of {both}");
    }
}

#[test]
fn weights_of_any_legal_size_are_cast_alike() {
    for (name, factor) in [("weights-small-1e-300", 1e300), ("w-1e308", 1e-290)] {
        let model = opened(hostile(name));
        let (differ, both) = differences(&cast(&scaled(&model, 1.0, factor)), &cast(&model), 1.0);
        assert!(differ <= 1 && 300 < both, "{name}: {differ} of {both}");
    }
}

#[test]
fn the_smaller_curvature_of_truth_tiny_1_keeps_its_digits() {
    let model = opened(field("truth-tiny_1"));
    // 50 digits, `testdata/oracle/eval`'s way; the other is -3.74e10. The program printed 1.0100631713867.
    let k = model.surface(FaceId(0)).inspect(0.5704540113062216, 0.03815935024624922).curvature.expect("regular");
    assert!((k.k1 - 1.010062038880165).abs() < 1e-9, "{}", k.k1);
}

#[test]
fn rays_at_knots_of_1e9_lie_on_the_surface_as_others_do() {
    let model = opened(field("49-domain-1e+09-0.00100005"));
    let surface = model.surface(FaceId(0));
    let viewport = Viewport::new(48, 36).expect("legal");
    let camera = Camera::framing(&model, viewport);
    let buffer = Caster::new(&model).render(&camera, viewport, &|_| ());
    let mut hits = 0;
    for (x, y) in (0..36).flat_map(|y| (0..48).map(move |x| (x, y))) {
        let Some(hit) = buffer.get(x, y) else { continue };
        let local = hit.local.expect("the caster knows the span");
        let span = [(Direction::U, 0), (Direction::V, 1)]
            .map(|(direction, axis)| surface.knots(direction).spans().nth(local.span[axis] as usize).expect("a span"));
        let at = camera.ray(viewport, x as f64 + 0.5, y as f64 + 0.5).at(hit.t);
        let off = surface.point_local(span, DVec2::new(local.uv.x, local.uv.y)).distance(at);
        assert!(off < 1e-14 * model.hull().diagonal(), "{off:e} at ({x}, {y})");
        hits += 1;
    }
    assert!(300 < hits, "{hits}");
}
