//! Faces whose joints pass through the centres of pixels: there a border that is a hair too narrow leaves a hole.
//!
//! A picture is filled by strips of one surface z = bend (x² + y²). Each is a face of its own, whose parameters are
//! sheared, and far longer along one direction than along the other, so that no slope can stand for another. The joints
//! between them run through pixel centres as the camera sees them.
//!
//! Where strips end at the borders of their parameters, which the other parameter comes to at a slant, centres lie in a
//! gap between two, a hair beyond either: there a face shows the nearest place of its border, and no other is near enough.

use crate::mutants::shown::{Shown, framed, viewport};
use glam::{DVec2, DVec3, Vec2Swizzles, dvec2};
use nurbs::{KnotVector, Surface};
use pipeline::Scheme;
use scene::{Camera, Face, Loop, Model, Projection, Trim};

/// How far the outer strips go on beyond the outer joints where the surface is not seen edge-on; the camera sees less.
const MARGIN: f64 = 3.0;

/// The angles from a joint to the longer direction of the parameters beside it, and to the shorter one, degrees.
const SHEAR: [f64; 2] = [3.0, 63.0];

/// The same where the joint is a border of the parameters.
const SLANT: [f64; 2] = [4.0, 180.0];

/// The same where the joint runs along the parameters: upright in one strip, level in the next.
const ALONG: [f64; 2] = [0.0, 90.0];

/// How far the parameters of a strip go on beyond its outline on each side, as a share of its size, where joints along them
/// are no borders.
const BEYOND: f64 = 0.0625;

/// The same where f32 tells parameters apart by about a thousandth of a pixel: less than a face covers beyond its border, and
/// enough that half of the centres on a joint lie beyond it as f32 sees them.
const FAR_BEYOND: f64 = 200.0;

/// Sine of the angle to the surface of a view that sees it edge-on, where a face covers a third of what it else does beyond
/// its border.
const EDGE_ON: f64 = 1.0 / 48.0;

/// The same of a view that sees next to nothing of it.
const NEARLY_GONE: f64 = 1.0 / 1024.0;

/// What corners of an outline are rounded to, of the parameters: far less than f32 tells apart.
const ROUNDED: f64 = 1.0 / (1u64 << 40) as f64;

/// By how much strips reach across a joint where f64 alone would leave holes in the reference, pixels; f32 does not tell it.
const OVERLAP_PX: f64 = 1e-8;

/// Half of a gap, pixels: less than a face covers beyond its border.
const HALF_GAP_PX: f64 = 1.0 / 512.0;

/// Inner knots of the surfaces, unlike each other so that no span has the length of another.
const KNOTS: [&[f64]; 2] = [&[0.25], &[0.375, 0.5]];

/// How the strips lie.
#[derive(Clone, Copy)]
struct Strips {
    name: &'static str,
    camera: Camera,
    bend: f64,
    /// The angles from a joint to the directions of the parameters, degrees.
    angles: [f64; 2],
    /// Half of the gap at a joint, pixels.
    half_gap_px: f64,
    /// Pixels from one centre on a joint to the next, right and down.
    step: [i32; 2],
    /// How many steps a joint has.
    steps: i32,
    /// Whether the joints are borders of the parameters, with gaps between them.
    are_borders: bool,
    /// Whether u and v are exchanged in the first strip and every second one from there, and in the others.
    exchanged: [bool; 2],
    /// How far the outer strips go on.
    margin: f64,
    /// How far the parameters go on beyond an outline on each side, as a share of its size.
    beyond: f64,
    /// Where the joints begin: pixels, right and down, outside of the picture. Later ones lie to the left of earlier ones,
    /// as one looks along them.
    starts: [[i32; 2]; 3],
}

/// Views from above without perspective, a steep one, and one of a bent surface.
pub(super) fn joints() -> Vec<Shown> {
    let near = from(DVec3::new(0.3, -0.5, 1.3), Projection::Perspective { fov_deg: 50.0 });
    let down = [[15, -9], [28, -9], [41, -9]];
    let rightward = rightward();
    let strips = [
        Strips { name: "joints downward", step: [-1, 3], steps: 18, starts: down, ..rightward },
        Strips { name: "gaps to the right", angles: SLANT, half_gap_px: HALF_GAP_PX, are_borders: true, ..rightward },
        Strips {
            name: "gaps downward",
            step: [-1, 3],
            steps: 18,
            angles: SLANT,
            half_gap_px: HALF_GAP_PX,
            are_borders: true,
            exchanged: [true, false],
            starts: down,
            ..rightward
        },
        rightward,
        Strips { name: "joints aslant", camera: aslant(), ..rightward },
        Strips { name: "joints of a bent surface", camera: near, bend: -0.08, ..rightward },
    ];
    strips.into_iter().map(shown).collect()
}

/// Joints that run along the parameters, upright on one side and level on the other.
pub(super) fn joints_along_parameters() -> Shown {
    let name = "joints along the parameters";
    shown(Strips { name, camera: aslant(), exchanged: [true, false], ..along(BEYOND) })
}

/// What shows how far a face covers centres beyond its border: joints along rows of centres that f32 sees on either side, all
/// level or all upright; joints at a slant that are seen edge-on; and gaps about centres that are a little too wide for that.
pub(super) fn close_joints() -> Vec<Shown> {
    let edge_on = |sine: f64, half_gap_px: f64| {
        // So far off that all of the surface that fills the picture is before the eye.
        let eye = 4.0 / sine * DVec3::new(0.0, -(1.0 - sine * sine).sqrt(), sine);
        let camera = from(eye, Projection::Orthographic { height: 4.0 });
        // Across the joints a pixel is that much longer there.
        let starts = rightward().starts.map(|[x, y]| [x - 40 * 2, y - 40]);
        let steps = rightward().steps + 2 * 40;
        Strips { camera, margin: MARGIN / sine, half_gap_px: half_gap_px / sine, starts, steps, ..rightward() }
    };
    // There one parameter is all across and the other all along the picture.
    let along_rows = Strips { step: [1, 0], steps: 56, ..along(FAR_BEYOND) };
    let strips = [
        Strips { name: "level joints", exchanged: [false; 2], ..along_rows },
        Strips { name: "upright joints", exchanged: [true; 2], ..along_rows },
        Strips { name: "joints seen edge-on", beyond: FAR_BEYOND * EDGE_ON, ..edge_on(EDGE_ON, -OVERLAP_PX) },
        Strips { name: "gaps seen edge-on", ..edge_on(NEARLY_GONE, 0.125) },
        Strips { name: "narrow gaps", half_gap_px: 1.0 / 24.0, exchanged: [true; 2], ..rightward() },
    ];
    strips.into_iter().map(shown).collect()
}

/// Joints along the parameters, which go on `beyond`, seen from above.
fn along(beyond: f64) -> Strips {
    Strips { angles: ALONG, half_gap_px: -OVERLAP_PX, beyond, ..rightward() }
}

/// Seen from above, from one side of the picture to the other.
fn rightward() -> Strips {
    Strips {
        name: "joints to the right",
        camera: from(4.0 * DVec3::Z, Projection::Orthographic { height: 4.0 }),
        bend: 0.0,
        angles: SHEAR,
        half_gap_px: 0.0,
        step: [2, 1],
        steps: 28,
        are_borders: false,
        exchanged: [false, true],
        margin: MARGIN,
        beyond: 0.0,
        starts: [[-8, 30], [-8, 17], [-8, 4]],
    }
}

fn aslant() -> Camera {
    from(DVec3::new(0.2, -1.3, 1.1), Projection::Perspective { fov_deg: 45.0 })
}

fn from(eye: DVec3, projection: Projection) -> Camera {
    Camera::look_at(eye, DVec3::ZERO, DVec3::Y, projection).expect("legal")
}

fn shown(strips: Strips) -> Shown {
    Shown {
        camera: strips.camera,
        fills: !strips.are_borders && strips.half_gap_px <= 0.0,
        ..framed(strips.name, model(&strips), Scheme::Specialised)
    }
}

fn model(strips: &Strips) -> Model {
    let joints = strips.starts.map(|start| joint(strips, start));
    let left = (joints[0][strips.steps as usize] - joints[0][0]).normalize().perp();
    let beside = |joint: &[DVec2], by: f64| joint.iter().map(|p| p + by * left).collect::<Vec<_>>();
    let [first, .., last] = &joints;
    let mut borders = vec![beside(first, -strips.margin)];
    borders.extend_from_slice(&joints);
    borders.push(beside(last, strips.margin));
    let gap = strips.half_gap_px / strips.camera.pixels_per_unit(viewport(), 1.0);
    let cut = |(index, pair): (usize, &[Vec<DVec2>])| {
        // A joint along the parameters is one line, which rounding must not break.
        let ends =
            |joint: Vec<DVec2>| if strips.angles == ALONG { vec![joint[0], joint[joint.len() - 1]] } else { joint };
        let (right, left) = (ends(beside(&pair[0], gap)), ends(beside(&pair[1], -gap)));
        let outline: Vec<DVec2> = right.into_iter().chain(left.into_iter().rev()).collect();
        strip(index, &outline, strips)
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

/// The face inside a counterclockwise outline that begins along a joint.
fn strip(index: usize, outline: &[DVec2], strips: &Strips) -> (Surface, Face) {
    let along = outline[1] - outline[0];
    let [long, short] = strips.angles.map(|angle| DVec2::from_angle(angle.to_radians()).rotate(along));
    // Coordinates along the two, and the box that holds the outline.
    let coordinates = |p: DVec2| dvec2(p.perp_dot(short), long.perp_dot(p)) / long.perp_dot(short);
    let box_of =
        |pick: fn(DVec2, DVec2) -> DVec2| outline.iter().map(|&p| coordinates(p)).reduce(pick).expect("corners");
    let (low, high) = (box_of(DVec2::min), box_of(DVec2::max));
    let is_along = strips.angles == ALONG;
    // Three times as far before the outline as behind it: in the middle, and where a span begins, f32 rounds less.
    let beyond = strips.beyond * (high - low);
    let (low, size) = (low - 1.5 * beyond, high - low + 2.0 * beyond);
    let origin = low.x * long + low.y * short;
    let (mut u, mut v) = (size.x * long, size.y * short);
    let mut corners: Vec<DVec2> = outline.iter().map(|&p| (coordinates(p) - low) / size).collect();
    if is_along {
        // A line along the parameters is one in f64, too.
        corners.iter_mut().for_each(|p| *p = (*p / ROUNDED).round() * ROUNDED);
    }
    if strips.are_borders {
        corners = vec![DVec2::ZERO, DVec2::X, DVec2::ONE, DVec2::Y];
    }
    let is_exchanged = strips.exchanged[index % 2];
    if is_exchanged {
        (u, v) = (v, u);
        corners = corners.iter().rev().map(|p| p.yx()).collect();
    }
    let knots = KNOTS.map(|inner| [&[0.0; 3], inner, &[1.0; 3]].concat());
    // The blossom of the surface over the parallelogram: of a parameter its mean over two knots, of its square their product.
    let blossom = |axis: usize, i: usize| {
        let (a, b) = (knots[axis][i + 1], knots[axis][i + 2]);
        (0.5 * (a + b), a * b)
    };
    let columns = KNOTS[1].len() + 3;
    let point = |k: usize| {
        let ((i, ii), (j, jj)) = (blossom(0, k / columns), blossom(1, k % columns));
        let mean = origin + i * u + j * v;
        let squares = mean.length_squared() + (ii - i * i) * u.length_squared() + (jj - j * j) * v.length_squared();
        mean.extend(strips.bend * squares)
    };
    let points = (0..(KNOTS[0].len() + 3) * columns).map(point).collect();
    let [ku, kv] = knots.clone().map(|knots| KnotVector::new(2, knots).expect("legal"));
    let surface = Surface::new(ku, kv, points, None).expect("legal");
    let line = |from: DVec2, to: DVec2| {
        Trim::new(KnotVector::new(1, vec![0.0, 0.0, 1.0, 1.0]).expect("legal"), vec![from, to], None)
    };
    let next = corners.iter().cycle().skip(1);
    let trims = corners.iter().zip(next).map(|(&from, &to)| line(from, to)).collect();
    let loops = vec![Loop { outer: true, trims }];
    (surface, Face { loops, reversed: is_exchanged, ..Face::whole(index) })
}
