//! Models made of others, and the view without perspective: what scenes of several kinds are built from.

use crate::mutants::shown::Shown;
use glam::DVec3;
use nurbs::{Direction, KnotVector, Surface};
use scene::{Camera, Face, Model, Projection};
use std::f64::consts::FRAC_1_SQRT_2;

pub(super) fn builtin(name: &str) -> Model {
    models::builtin(name).expect("built in")
}

/// The same view, without perspective.
pub(super) fn orthographic(shown: Shown) -> Shown {
    let hull = shown.model.hull();
    let projection = Projection::Orthographic { height: 0.8 * hull.diagonal() };
    let camera = Camera::look_at(shown.camera.eye(), hull.center(), DVec3::Z, projection).expect("legal");
    Shown { camera, ..shown }
}

/// The same surfaces with u and v exchanged.
pub(super) fn transposed(model: &Model) -> Model {
    let surfaces = model.surfaces().iter().map(|surface| {
        let [rows, columns] = surface.control_counts();
        let order: Vec<usize> = (0..columns).flat_map(|j| (0..rows).map(move |i| i * columns + j)).collect();
        let points = order.iter().map(|&k| surface.points()[k]).collect();
        let weights = surface.weights().map(|weights| order.iter().map(|&k| weights[k]).collect());
        let [ku, kv] = [Direction::U, Direction::V].map(|direction| surface.knots(direction).clone());
        Surface::new(kv, ku, points, weights).expect("as legal as before")
    });
    Model::new(model.name(), surfaces.collect(), model.faces().to_vec()).expect("as legal as before")
}

/// A quarter of a cylinder: the weights' derivative in v is exactly 0.
pub(super) fn cylinder() -> Model {
    let knots = |degree, knots: &[f64]| KnotVector::new(degree, knots.to_vec()).expect("legal");
    let arc = [(DVec3::X, 1.0), (DVec3::X + DVec3::Y, FRAC_1_SQRT_2), (DVec3::Y, 1.0)];
    let points = arc.iter().flat_map(|(p, _)| [*p, *p + DVec3::Z]).collect();
    let weights = arc.iter().flat_map(|(_, w)| [*w, *w]).collect();
    let (u, v) = (knots(2, &[0.0, 0.0, 0.0, 1.0, 1.0, 1.0]), knots(1, &[0.0, 0.0, 1.0, 1.0]));
    let surface = Surface::new(u, v, points, Some(weights)).expect("legal");
    Model::of_surfaces("cylinder", vec![surface]).expect("one face")
}

/// The same model, its surfaces of a higher degree along v.
pub(super) fn raised(model: Model) -> Model {
    let surfaces = model.surfaces().iter().map(|surface| surface.elevated(Direction::V).expect("a low degree"));
    Model::new(model.name(), surfaces.collect(), model.faces().to_vec()).expect("as legal as before")
}

/// The faces of both.
pub(super) fn joined(a: &Model, b: &Model) -> Model {
    let moved = b.faces().iter().map(|face| Face { surface: face.surface + a.surfaces().len(), ..face.clone() });
    let faces = a.faces().iter().cloned().chain(moved).collect();
    Model::new(a.name(), [a.surfaces(), b.surfaces()].concat(), faces).expect("as legal as before")
}

/// The same model elsewhere.
pub(super) fn moved(model: &Model, by: DVec3) -> Model {
    let surfaces = model.surfaces().iter().map(|surface| {
        let [ku, kv] = [Direction::U, Direction::V].map(|direction| surface.knots(direction).clone());
        let points = surface.points().iter().map(|point| *point + by).collect();
        Surface::new(ku, kv, points, surface.weights().map(<[f64]>::to_vec)).expect("as legal as before")
    });
    Model::new(model.name(), surfaces.collect(), model.faces().to_vec()).expect("as legal as before")
}

/// So many of a model, each above the last by a sixteenth of its size: as many faces lie behind one pixel.
pub(super) fn stacked(model: &Model, count: usize) -> Model {
    let step = DVec3::Z * (model.hull().diagonal() / 16.0);
    (1..count).fold(model.clone(), |below, k| joined(&below, &moved(model, step * k as f64)))
}

/// A teapot, and above it a face of another degree: programs of two degrees, each with pieces of its own in the picture.
pub(super) fn of_two_degrees() -> Model {
    let (teapot, face) = (builtin("teapot"), builtin("quintic-quadratic"));
    let above = teapot.hull().center() - face.hull().center() + DVec3::Z * 0.5 * teapot.hull().diagonal();
    joined(&teapot, &moved(&face, above))
}

/// The same surfaces, seen from their other side.
pub(super) fn reversed(model: Model) -> Model {
    let faces = model.faces().iter().map(|face| Face { reversed: !face.reversed, ..face.clone() }).collect();
    Model::new(model.name(), model.surfaces().to_vec(), faces).expect("as legal as before")
}
