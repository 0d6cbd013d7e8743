//! Flat quads that ask of kernels what curved models do not: to cut triangles that go on behind the eye, to share out
//! thousands of large ones, to count exactly, and to fill the room for questions to the last place.

use crate::mutants::shown::{Shown, framed};
use glam::{DVec2, DVec3, dvec2, dvec3};
use nurbs::{KnotVector, Surface};
use pipeline::Scheme;
use scene::{Camera, Face, Loop, Model, Projection, Trim, Viewport};
use std::f64::consts::TAU;

/// Corners at (u, v) = (0, 0), (0, 1), (1, 0) and (1, 1).
type Quad = [DVec3; 4];

/// How far tunnels go on, before the eye and behind it; their radius is 1.
const LENGTH: f64 = 4.0;

/// Strips that are more triangles than workgroups share out (`SHARING` in `techniques`), two a strip.
const MANY: usize = 1200;

/// Faces that go on behind the eye: a tunnel, and a face of two triangles, of which one is cut.
pub(super) fn behind_the_eye() -> Vec<Shown> {
    vec![
        along_y("a tunnel", closed_tunnel(), (72, 48), 50.0, None),
        along_y("one is cut, one is large", model_of(&[beside_the_eye()]), (120, 100), 60.0, None),
    ]
}

/// What kernels cut, count and share out: triangles by thousands, areas, centres on edges, and questions.
pub(super) fn cut_and_counted() -> Vec<Shown> {
    let thousands = model_of(&[tunnel(MANY), slats(MANY, 1.5)].concat());
    vec![
        along_y("a tunnel from the near plane on", closed_tunnel(), (72, 48), 90.0, Some(0.8)),
        // So near that i32 holds no corner there that is not cut at the sides.
        along_y("a tunnel from the eye on", closed_tunnel(), (72, 48), 50.0, Some(1e-7)),
        along_y("thousands cut, thousands large", thousands, (70, 40), 60.0, None),
        on_the_near_plane(),
        areas(),
        on_centres(),
        crossing(),
        beyond_the_room(),
    ]
}

/// A tunnel whose end a wall closes, so that some triangles are whole; the wall's number is among those of the strips.
fn closed_tunnel() -> Model {
    let wall = [[-1.0, -1.0], [-1.0, 1.0], [1.0, -1.0], [1.0, 1.0]].map(|[x, z]| dvec3(x, 0.75 * LENGTH, z));
    let strips = tunnel(40);
    model_of(&[&strips[..25], &[wall], &strips[25..]].concat())
}

/// Two parallelograms with a corner on the near plane itself, to the bit. Of one the next corner is nearer; of the other it is far
/// to the left, so that the triangle is cut there.
fn on_the_near_plane() -> Shown {
    let spanned = |corner: DVec3, u: DVec3, v: DVec3| -> Quad { [corner, corner + v, corner + u, corner + u + v] };
    let cut_there = spanned(dvec3(0.25, 1.0, -0.25), dvec3(0.25, 3.0, 0.5), dvec3(0.5, -0.5, 0.25));
    let cut_elsewhere = spanned(dvec3(-0.25, 1.0, -0.25), dvec3(0.25, 3.0, 0.5), dvec3(-16.0, 1.0, 0.25));
    let projection = Projection::Perspective { fov_deg: 70.0 };
    let camera = Camera::look_at(DVec3::ZERO, DVec3::Y, DVec3::Z, projection).expect("legal");
    let camera = camera.with_near(1.0).expect("legal");
    Shown { camera, ..framed("corners on the near plane", model_of(&[cut_there, cut_elsewhere]), Scheme::Specialised) }
}

/// Two faces that fill the picture and cross there, flat, so that a search ends after one long step: depth is right only by
/// its slopes.
pub(super) fn flat() -> Shown {
    let across = |slope: f64| -> Quad {
        [[-5.0, -5.0], [-5.0, 5.0], [5.0, -5.0], [5.0, 5.0]]
            .map(|[x, z]| dvec3(x + 0.3 * z, 3.0 + slope * (x - 0.4 * z), 0.6 * z))
    };
    let model = model_of(&[across(0.25), across(-0.35)]);
    Shown { fills: true, ..along_y("flat faces that cross", model, (44, 40), 40.0, None) }
}

/// A model along y, from a place and in a direction beside the axis, a little turned; the near plane is where it is said to be.
fn along_y(
    name: &'static str,
    model: Model,
    (width, height): (usize, usize),
    fov_deg: f64,
    near: Option<f64>,
) -> Shown {
    let eye = dvec3(0.11, 0.0, -0.06);
    let projection = Projection::Perspective { fov_deg };
    let camera = Camera::look_at(eye, eye + dvec3(0.07, 1.0, 0.04), dvec3(0.2, 0.0, 1.0), projection).expect("legal");
    let camera = near.map_or(camera, |near| camera.with_near(near).expect("legal"));
    let viewport = Viewport::new(width, height).expect("a legal size");
    Shown { camera, viewport, ..framed(name, model, Scheme::Specialised) }
}

/// Strips along y about the eye, each a face.
fn tunnel(count: usize) -> Vec<Quad> {
    let at = |k: usize, y: f64| {
        let (sine, cosine) = (TAU * k as f64 / count as f64).sin_cos();
        dvec3(cosine, y, sine)
    };
    (0..count).map(|k| [at(k, -LENGTH), at(k, LENGTH), at(k + 1, -LENGTH), at(k + 1, LENGTH)]).collect()
}

/// A square across the view at y, in slats along its diagonal: however thin one is, centres of pixels are in its box.
fn slats(count: usize, y: f64) -> Vec<Quad> {
    let at = |k: usize, end: f64| {
        let aside = 2.0 * k as f64 / count as f64 - 1.0;
        dvec3(0.5 * (end + aside), y, 0.5 * (end - aside))
    };
    (0..count).map(|k| [at(k, -1.0), at(k, 1.0), at(k + 1, -1.0), at(k + 1, 1.0)]).collect()
}

/// A parallelogram far beyond the picture, one corner of it behind the eye: two triangles, of which one has that corner.
fn beside_the_eye() -> Quad {
    let at = |x: f64, y: f64| dvec3(x, y, 0.5 * x - 0.4 * (y - 2.0));
    [at(-2.5, 4.0), at(-2.5, -0.5), at(2.5, 6.0), at(2.5, 1.5)]
}

/// Rectangles of 1024 × 64 pixels and of 1/256 × 1/256: twice the area of a triangle is 2³² and 1 of the units in which it
/// is counted. The small one has a corner on a pixel's centre, in front of the large one; so have slats, whose triangles are
/// narrow, but far from the picture's other end.
fn areas() -> Shown {
    let quad = |[x, y]: [f64; 2], across: DVec2, down: DVec2, depth: f64| -> Quad {
        [DVec2::ZERO, down, across, across + down].map(|at| (dvec2(x, y) + at).extend(depth))
    };
    let (unit, right, down) = (1.0 / 256.0, DVec2::X, DVec2::NEG_Y);
    let slat = |k: usize| quad([530.0 + 2.0 * k as f64, 30.0], 1.1 * right, 60.0 * down + 7.0 * right, 0.25);
    let large = quad([-512.0, 32.0], 1024.0 * right, 64.0 * down, 0.0);
    let small = quad([-511.5, 4.5], unit * right, unit * down, 0.5);
    let model = model_of(&[vec![large, small], (0..30).map(slat).collect()].concat());
    let camera = Camera::look_at(DVec3::Z, DVec3::ZERO, DVec3::Y, Projection::Orthographic { height: 16.0 });
    let viewport = Viewport::new(1200, 16).expect("a legal size");
    Shown { camera: camera.expect("legal"), viewport, ..framed("areas of 2^32 and of 1", model, Scheme::General) }
}

/// Parallelograms side by side whose corners are centres of pixels: each centre on an edge is of one face, whichever way
/// the edge runs and the corners go round.
fn on_centres() -> Shown {
    let lattice = |corner: DVec2, a: DVec2, b: DVec2| {
        (0..64).map(move |k| {
            let (i, j) = (k % 8, k / 8);
            let first = corner + f64::from(i) * a + f64::from(j) * b;
            let (u, v) = if (i + j) % 2 == 0 { (a, b) } else { (b, a) };
            [first, first + v, first + u, first + u + v].map(|at| at.extend(0.0))
        })
    };
    let quads: Vec<Quad> = lattice(dvec2(-24.5, -15.5), dvec2(3.0, 1.0), dvec2(-1.0, 2.0))
        .chain(lattice(dvec2(2.5, -15.5), dvec2(2.0, 0.0), dvec2(0.0, 3.0)))
        .chain(lattice(dvec2(26.5, -15.5), dvec2(1.0, 2.0), dvec2(-1.0, 2.0)))
        .collect();
    let camera = Camera::look_at(DVec3::Z, DVec3::ZERO, DVec3::Y, Projection::Orthographic { height: 40.0 });
    let viewport = Viewport::new(72, 40).expect("a legal size");
    Shown {
        camera: camera.expect("legal"),
        viewport,
        ..framed("corners on centres", model_of(&quads), Scheme::Specialised)
    }
}

/// Two faces with loops that cross in the picture and fill it both: as many questions as there is room for, two a pixel, and
/// more than a dispatch has threads (`SHARING` workgroups).
fn crossing() -> Shown {
    let sloping = |slope: f64| -> Quad {
        [[-4.0, -3.0], [-4.0, 3.0], [4.0, -3.0], [4.0, 3.0]].map(|[x, y]| dvec3(x, y, slope * (x + 0.3 * y)))
    };
    let model = bounded(&[sloping(0.25), sloping(-0.25)]);
    let camera = Camera::look_at(8.0 * DVec3::Z, DVec3::ZERO, DVec3::Y, Projection::Orthographic { height: 4.0 });
    let shown = framed("as many questions as there is room for", model, Scheme::Specialised);
    let viewport = Viewport::new(256, 264).expect("a legal size");
    Shown { camera: camera.expect("legal"), viewport, fills: true, ..shown }
}

/// Four faces with loops that fill the picture between them, each reaching behind the eye: more questions than there is room
/// for, of triangles that are cut and of such that go on beyond every side of the picture.
fn beyond_the_room() -> Shown {
    let turned = |x: f64, z: f64| beside_the_eye().map(|p| dvec3(x * p.x, p.y, z * p.z));
    let model = bounded(&[turned(1.0, 1.0), turned(1.0, -1.0), turned(-1.0, 1.0), turned(-1.0, -1.0)]);
    along_y("more questions than there is room for", model, (48, 40), 60.0, None)
}

/// The same, each bounded by a loop along its sides.
fn bounded(quads: &[Quad]) -> Model {
    let plain = model_of(quads);
    let corners = [DVec2::ZERO, dvec2(1.0, 0.0), DVec2::ONE, dvec2(0.0, 1.0)];
    let knots = || KnotVector::new(1, vec![0.0, 0.0, 1.0, 1.0]).expect("legal");
    let side = |k: usize| Trim::new(knots(), vec![corners[k], corners[(k + 1) % 4]], None);
    let border = || Loop { outer: true, trims: (0..4).map(side).collect() };
    let faces = (0..quads.len()).map(|k| Face { loops: vec![border()], ..Face::whole(k) }).collect();
    Model::new("bounded quads", plain.surfaces().to_vec(), faces).expect("legal")
}

fn model_of(quads: &[Quad]) -> Model {
    let knots = || KnotVector::new(1, vec![0.0, 0.0, 1.0, 1.0]).expect("legal");
    let surface = |quad: &Quad| Surface::new(knots(), knots(), quad.to_vec(), None).expect("legal");
    Model::of_surfaces("quads", quads.iter().map(surface).collect()).expect("legal")
}
