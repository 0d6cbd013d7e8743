//! Faces whose joints pass through the centres of pixels: there a border that is a hair too narrow leaves a hole.
//!
//! A picture is filled by strips of one surface z = bend (x² + y²). Each is a face of its own, whose parameters are
//! sheared, and far longer along one direction than along the other, so that no slope can stand for another. The joints
//! between them run through pixel centres as the camera sees them.

use super::{Shown, framed, viewport};
use glam::{DVec2, DVec3, Vec2Swizzles, dvec2};
use nurbs::{KnotVector, Surface};
use pipeline::Scheme;
use scene::{Camera, Face, Loop, Model, Projection, Trim};

/// How far the outer strips go on beyond the outer joints; the camera sees less.
const MARGIN: f64 = 3.0;

/// The angle from a joint to the longer direction of the parameters beside it, and from there to the shorter one, degrees.
const SHEAR: [f64; 2] = [3.0, 60.0];

/// How the strips lie.
struct Strips {
    name: &'static str,
    camera: Camera,
    bend: f64,
    /// Pixels from one centre on a joint to the next, right and down.
    step: [i32; 2],
    /// How many steps a joint has.
    steps: i32,
    /// Where the joints begin: pixels, right and down, outside of the picture. Later ones lie to the left of earlier ones,
    /// as one looks along them.
    starts: [[i32; 2]; 3],
}

/// Views from above without perspective, a steep one, and one of a bent surface.
pub(super) fn joints() -> Vec<Shown> {
    let from = |eye: DVec3, projection| Camera::look_at(eye, DVec3::ZERO, DVec3::Y, projection).expect("legal");
    let above = from(4.0 * DVec3::Z, Projection::Orthographic { height: 4.0 });
    let aslant = from(DVec3::new(0.2, -1.3, 1.1), Projection::Perspective { fov_deg: 45.0 });
    let near = from(DVec3::new(0.3, -0.5, 1.3), Projection::Perspective { fov_deg: 50.0 });
    let (right, down) = ([[-8, 30], [-8, 17], [-8, 4]], [[15, -9], [28, -9], [41, -9]]);
    let strips = [
        Strips { name: "joints to the right", camera: above, bend: 0.0, step: [2, 1], steps: 28, starts: right },
        Strips { name: "joints downward", camera: above, bend: 0.0, step: [-1, 3], steps: 18, starts: down },
        Strips { name: "joints aslant", camera: aslant, bend: 0.0, step: [2, 1], steps: 28, starts: right },
        Strips { name: "joints of a bent surface", camera: near, bend: -0.08, step: [2, 1], steps: 28, starts: right },
    ];
    strips.into_iter().map(shown).collect()
}

fn shown(strips: Strips) -> Shown {
    Shown { camera: strips.camera, fills: true, ..framed(strips.name, model(&strips), Scheme::Specialised) }
}

fn model(strips: &Strips) -> Model {
    let joints = strips.starts.map(|start| joint(strips, start));
    let left = (joints[0][strips.steps as usize] - joints[0][0]).normalize().perp();
    let beside = |joint: &[DVec2], by: f64| joint.iter().map(|p| p + by * left).collect::<Vec<_>>();
    let [first, .., last] = &joints;
    let mut borders = vec![beside(first, -MARGIN)];
    borders.extend_from_slice(&joints);
    borders.push(beside(last, MARGIN));
    let cut = |(index, pair): (usize, &[Vec<DVec2>])| {
        let outline: Vec<DVec2> = pair[0].iter().chain(pair[1].iter().rev()).copied().collect();
        strip(index, &outline, left.perp(), strips.bend)
    };
    let (surfaces, faces) = borders.windows(2).enumerate().map(cut).unzip();
    Model::new(strips.name, surfaces, faces).expect("legal")
}

/// Where the rays through the centres on a joint meet the surface: x and y.
fn joint(strips: &Strips, start: [i32; 2]) -> Vec<DVec2> {
    let at = |k: i32, axis: usize| f64::from(start[axis] + k * strips.step[axis]) + 0.5;
    let meet = |k: i32| {
        let ray = strips.camera.ray(viewport(), at(k, 0), at(k, 1));
        let (o, d) = (ray.origin, ray.direction);
        // The nearer root of a t² + b t + c, which is the only one where a is 0.
        let a = strips.bend * d.truncate().length_squared();
        let b = 2.0 * strips.bend * o.truncate().dot(d.truncate()) - d.z;
        let c = strips.bend * o.truncate().length_squared() - o.z;
        let t = -2.0 * c / (b + b.signum() * (b * b - 4.0 * a * c).sqrt());
        ray.at(t).truncate()
    };
    (0..=strips.steps).map(meet).collect()
}

/// The face inside a counterclockwise outline, whose long direction is `along`; u and v are exchanged in every second one.
fn strip(index: usize, outline: &[DVec2], along: DVec2, bend: f64) -> (Surface, Face) {
    let long = DVec2::from_angle(SHEAR[0].to_radians()).rotate(along);
    let short = DVec2::from_angle(SHEAR[1].to_radians()).rotate(long);
    // Coordinates along the two, and the box that holds the outline.
    let coordinates = |p: DVec2| dvec2(p.perp_dot(short), long.perp_dot(p)) / long.perp_dot(short);
    let box_of =
        |pick: fn(DVec2, DVec2) -> DVec2| outline.iter().map(|&p| coordinates(p)).reduce(pick).expect("corners");
    let (low, size) = (box_of(DVec2::min), box_of(DVec2::max) - box_of(DVec2::min));
    let origin = low.x * long + low.y * short;
    let (mut u, mut v) = (size.x * long, size.y * short);
    let mut corners: Vec<DVec2> = outline.iter().map(|&p| (coordinates(p) - low) / size).collect();
    let is_exchanged = index % 2 == 1;
    if is_exchanged {
        (u, v) = (v, u);
        corners = corners.iter().rev().map(|p| p.yx()).collect();
    }
    // The blossom of the surface over the parallelogram: of a parameter its mean over the two arguments, of its square
    // their product.
    let point = |k: usize| {
        let (i, j) = ((k / 3) as f64 / 2.0, (k % 3) as f64 / 2.0);
        let mean = origin + i * u + j * v;
        let squares =
            mean.length_squared() + (i.floor() - i * i) * u.length_squared() + (j.floor() - j * j) * v.length_squared();
        mean.extend(bend * squares)
    };
    let knots = || KnotVector::new(2, vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0]).expect("legal");
    let surface = Surface::new(knots(), knots(), (0..9).map(point).collect(), None).expect("legal");
    let line = |from: DVec2, to: DVec2| {
        Trim::new(KnotVector::new(1, vec![0.0, 0.0, 1.0, 1.0]).expect("legal"), vec![from, to], None)
    };
    let next = corners.iter().cycle().skip(1);
    let trims = corners.iter().zip(next).map(|(&from, &to)| line(from, to)).collect();
    let loops = vec![Loop { outer: true, trims }];
    (surface, Face { loops, reversed: is_exchanged, ..Face::whole(index) })
}
