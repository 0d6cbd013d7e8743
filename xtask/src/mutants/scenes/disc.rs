//! A disc of patches that fills the picture, for techniques that draw grids: where two grids do not meet, a pixel shows nothing.
//!
//! The patches lie in rings about a pole, and borders between them are curved, the more pixels the farther out. So a patch has
//! other levels than its neighbours, and a corner that is not where the neighbour's border is leaves a gap. One face closes upon
//! itself and has a collapsed side; of many faces each runs along its borders in a direction of its own.

use crate::mutants::shown::{Shown, framed};
use glam::{DVec2, DVec3};
use isophote::stage::Plan;
use nurbs::{Direction, KnotVector, Surface};
use pipeline::Scheme;
use scene::{Camera, Face, Loop, Model, Projection, Trim};
use std::f64::consts::TAU;

/// Patches around the pole.
const AROUND: usize = 5;

/// Distances of control points from the pole; every second one lies on a border.
const DISTANCES: [f64; 7] = [0.0, 0.1, 0.3, 0.45, 0.7, 1.0, 2.5];

/// By how much each ring of control points is turned against the one within it, radians.
const TURN: f64 = 0.09;

/// One face and many, with and without loops, in few cells and in many; and a corner, near by.
pub(super) fn discs() -> Vec<Shown> {
    vec![
        seen("a disc of one face", one_face(), 2.0),
        seen("a disc of many faces", many_faces(false), 1.0),
        seen("a disc of faces with skirts", many_faces(true), 1.0),
        seen("a disc in many cells", one_face(), 1.0 / 64.0),
        at_a_corner(seen("a corner of four faces", many_faces(false), 1.0)),
    ]
}

/// Many faces with loops, of two degrees and of spans of several lengths. Their borders are curved: without skirts pixels between two
/// of them show nothing, and the nearest place of a border may be of another span than a skirt's.
pub(super) fn of_several_spans() -> Shown {
    let plain = many_faces(true);
    let refined = |surface: &Surface| {
        let raised = surface.elevated(Direction::V).expect("a low degree");
        let along_u = raised.refined(Direction::U, &[0.3]).expect("inside");
        along_u.refined(Direction::V, &[0.15, 0.6]).expect("inside")
    };
    let surfaces = plain.surfaces().iter().map(refined).collect();
    let model = Model::new("disc", surfaces, plain.faces().to_vec()).expect("as legal as before");
    seen("a disc of faces of several spans", model, 1.0)
}

fn seen(name: &'static str, model: Model, chord_px: f64) -> Shown {
    let projection = Projection::Perspective { fov_deg: 45.0 };
    let camera = Camera::look_at(DVec3::new(0.3, -0.4, 2.0), DVec3::ZERO, DVec3::Y, projection).expect("legal");
    let shown = framed(name, model, Scheme::Specialised);
    let plan = Plan { chord_px, ..shown.plan };
    Shown { camera, plan, fills: true, ..shown }
}

/// A view of the place where four patches meet, so near that a pixel is four times what f32 rounds there: corners that are not
/// evaluated alike leave gaps.
fn at_a_corner(shown: Shown) -> Shown {
    let corner = control(2, 2);
    let projection = Projection::Orthographic { height: 1e-5 };
    let camera = Camera::look_at(corner + DVec3::Z, corner, DVec3::Y, projection).expect("legal");
    Shown { camera, cells: Some(1), ..shown }
}

/// A control point: which around, which outward.
fn control(a: usize, r: usize) -> DVec3 {
    let angle = TAU * (a % (2 * AROUND)) as f64 / (2 * AROUND) as f64;
    // Between two borders the control point of an arc lies where its tangents meet.
    let bulge = if a % 2 == 1 { (TAU / (2 * AROUND) as f64).cos().recip() } else { 1.0 };
    let p = DISTANCES[r] * bulge * DVec2::from_angle(angle + TURN * r as f64);
    p.extend(0.1 * p.x * p.y)
}

/// A closed face, u around and v outward.
fn one_face() -> Model {
    let knots = |patches: usize| {
        let inner = (1..patches).flat_map(|k| [k as f64; 2]);
        let all = [0.0; 3].into_iter().chain(inner).chain([patches as f64; 3]).collect();
        KnotVector::new(2, all).expect("legal")
    };
    let columns = DISTANCES.len();
    let points = (0..(2 * AROUND + 1) * columns).map(|k| control(k / columns, k % columns)).collect();
    let surface = Surface::new(knots(AROUND), knots(columns / 2), points, None).expect("legal");
    Model::of_surfaces("disc", vec![surface]).expect("one face")
}

/// A face a patch: u and v exchanged or turned round in each of the eight ways in turn.
fn many_faces(bounded: bool) -> Model {
    let rings = DISTANCES.len() / 2;
    let knots = || KnotVector::new(2, vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0]).expect("legal");
    let surface = |n: usize| {
        let turned = |k: usize, round: bool| if round { 2 - k } else { k };
        let point = |k: usize| {
            let (i, j) = if n & 1 == 0 { (k / 3, k % 3) } else { (k % 3, k / 3) };
            control(2 * (n / rings) + turned(i, n & 2 != 0), 2 * (n % rings) + turned(j, n & 4 != 0))
        };
        Surface::new(knots(), knots(), (0..9).map(point).collect(), None).expect("legal")
    };
    let corners = [DVec2::ZERO, DVec2::X, DVec2::ONE, DVec2::Y];
    let line = |k: usize| {
        let ends = vec![corners[k], corners[(k + 1) % 4]];
        Trim::new(KnotVector::new(1, vec![0.0, 0.0, 1.0, 1.0]).expect("legal"), ends, None)
    };
    let border = || Loop { outer: true, trims: (0..4).map(line).collect() };
    let count = AROUND * rings;
    let faces = (0..count).map(|k| Face { loops: if bounded { vec![border()] } else { vec![] }, ..Face::whole(k) });
    Model::new("disc", (0..count).map(surface).collect(), faces.collect()).expect("legal")
}
