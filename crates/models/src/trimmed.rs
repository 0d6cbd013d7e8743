//! Trimmed models: each is hard for the trimming of a renderer in the one way that its line in [`TRIMMED`] names.
//!
//! They open by name like the other built-in models, and are the same numbers on every machine. Material lies on the left
//! of every loop in (u, v). Loops that are not a face's outer boundary alternate by depth: a hole runs clockwise, an
//! island in it counter-clockwise.

mod letters;
mod outline;
mod seam_pair;
#[cfg(test)]
mod tests;

use crate::construction::{clamped, even, knots, revolved, sampled, sphere};
use glam::{DVec2, DVec3, dvec2};
use letters::WORD;
use libm::{cos, sin};
use nurbs::Surface;
use outline::{
    TrimmedSurface, Way, bezier, closed_cubic, contour, cusp, ellipse, inner, line, open_cubic, outer, pole, polygon,
    quarters_against, rectangle, reversed, rounded_against, seam,
};
use scene::{Face, Loop, Model, Trim};
use std::f64::consts::TAU;

/// Names of the trimmed models, each with a line on what it stresses.
pub const TRIMMED: &[(&str, &str)] = &[
    ("plate", "a bent plate with 100 holes: bicubic, exact rational circles in (u, v)"),
    ("window", "a cylinder with windows across its seam, in parameters that run beyond the domain"),
    ("cap", "a sphere's cap round one pole, and a gore that ends in the other: trims that are a point in space"),
    ("islands", "a hole, an island in it, a hole in the island; domain -2 to 2, an outer loop with unclamped knots"),
    ("cusp", "loops of two cubics with a cusp, outside and in a hole"),
    ("sliver", "a waist 1e-4 of the domain wide"),
    ("text", "a word cut out of a banner: letters of a font in quadratic Béziers, counters as islands"),
    ("pieces", "16 bicubic faces of 50 trims each, all single Bézier segments that are monotone in u and in v"),
    ("seam-pair", "two surfaces that share a trimmed edge, with curves that agree to 1e-6 in space"),
];

/// The trimmed model of that name.
pub(crate) fn trimmed(name: &str) -> Option<Model> {
    let faces = match name {
        "plate" => vec![plate()],
        "window" => vec![window()],
        "cap" => cap(),
        "islands" => vec![islands()],
        "cusp" => vec![cusps()],
        "sliver" => vec![sliver()],
        "text" => vec![text()],
        "pieces" => pieces(),
        "seam-pair" => seam_pair::seam_pair().into(),
        _ => return None,
    };
    let (surfaces, loops): (Vec<Surface>, Vec<Vec<Loop>>) = faces.into_iter().unzip();
    let face = |(k, loops)| Face { loops, ..Face::whole(k) };
    let faces = loops.into_iter().enumerate().map(face).collect();
    Some(Model::new(name, surfaces, faces).expect("each face has its surface"))
}

/// Holes along each side of the plate.
const HOLES: usize = 10;

/// Circles of radius 0.02 to 0.04 about the centres of a 10 × 10 grid; every other one runs its curve backwards.
fn plate() -> TrimmedSurface {
    let surface = sampled(even(3, 6), even(3, 6), |u, v| {
        let (x, y) = (1.6 * u - 0.8, 1.6 * v - 0.8);
        DVec3::new(x, y, 0.25 - 0.3 * x * x + 0.12 * sin(2.5 * y + x))
    });
    let mut loops = vec![outer(rectangle(DVec2::ZERO, DVec2::ONE))];
    for k in 0..HOLES * HOLES {
        let (i, j) = (k / HOLES, k % HOLES);
        let center = dvec2(i as f64 + 0.5, j as f64 + 0.5) / HOLES as f64;
        let radius = 0.02 + 0.005 * ((3 * i + 2 * j) % 5) as f64;
        loops.push(inner(if (i + j) % 2 == 0 {
            ellipse(center, DVec2::splat(radius), Way::Against)
        } else {
            // The same circle in a curve that is itself clockwise.
            ellipse(center, dvec2(radius, -radius), Way::Around)
        }));
    }
    (surface, loops)
}

/// One window lies about u = 0 with half its parameters below the domain, one about u = 1 with half above, and a
/// porthole away from the seam. The outer loop is the natural boundary, which runs the seam up and down. A point has
/// material where the winding numbers of its shifts by −1, 0 and 1 periods add up to 1.
fn window() -> TrimmedSurface {
    let surface = revolved(&[[0.6, -0.7, 1.0], [0.6, 0.7, 1.0]], clamped(1, &[]));
    let [low, right, high, left] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(DVec2::from_array);
    let boundary = outer(vec![line(low, right), seam(right, high, 1), line(high, left), seam(left, low, 1)]);
    let loops = vec![
        boundary,
        inner(rounded_against(dvec2(-0.12, 0.55), dvec2(0.12, 0.9), 0.04)),
        inner(ellipse(dvec2(1.0, 0.28), dvec2(0.09, 0.16), Way::Against)),
        inner(ellipse(dvec2(0.78, 0.5), dvec2(0.05, 0.11), Way::Against)),
    ];
    (surface, loops)
}

/// The cap's loop runs its wavy rim, the seam up to the pole, the pole, and the seam down. The gore's runs a stretch of
/// the other pole, a meridian up, a curve and a meridian down.
fn cap() -> Vec<TrimmedSurface> {
    let rim: Vec<DVec2> = (0..=12).map(|k| dvec2(k as f64 / 12.0, 0.62 + 0.08 * cos(TAU * k as f64 / 4.0))).collect();
    let [start, end] = [rim[0], rim[12]];
    let top = [dvec2(1.0, 1.0), dvec2(0.0, 1.0)];
    let cap = vec![open_cubic(rim), seam(end, top[0], 1), pole(top[0], top[1], 2), seam(top[1], start, 1)];
    let [west, east] = [dvec2(0.7, 0.0), dvec2(0.93, 0.0)];
    let [shoulder, crown] = [dvec2(0.93, 0.38), dvec2(0.7, 0.42)];
    let brow = bezier(&[shoulder, dvec2(0.88, 0.52), dvec2(0.76, 0.3), crown]);
    let gore = vec![pole(west, east, 3), line(east, shoulder), brow, line(crown, west)];
    vec![(sphere(), vec![outer(cap)]), (sphere(), vec![outer(gore)])]
}

/// Four loops, each inside the one before.
fn islands() -> TrimmedSurface {
    let direction = || knots(3, &[-2.0, -2.0, -2.0, -2.0, -0.5, 1.0, 2.0, 2.0, 2.0, 2.0]);
    let surface = sampled(direction(), direction(), |u, v| {
        let (x, y) = (1.6 * u - 0.8, 1.6 * v - 0.8);
        DVec3::new(x, y, 0.3 - 0.35 * (x * x + y * y) + 0.05 * sin(5.0 * x) * cos(4.0 * y))
    });
    let round = |count: usize, radius: &dyn Fn(usize) -> f64| -> Vec<DVec2> {
        let at = |k: usize| dvec2(cos(TAU * k as f64 / count as f64), sin(TAU * k as f64 / count as f64)) * radius(k);
        (0..count).map(at).collect()
    };
    let coast = round(12, &|k| 1.9 - 0.15 * (k % 3) as f64);
    let island = round(10, &|k| if k % 2 == 0 { 1.0 } else { 0.75 });
    let loops = vec![
        outer(closed_cubic(&coast)),
        inner(ellipse(dvec2(0.05, -0.03), dvec2(1.35, 1.2), Way::Against)),
        inner(polygon(&island)),
        inner(ellipse(dvec2(0.05, 0.1), dvec2(0.45, 0.35), Way::Against)),
    ];
    (surface, loops)
}

/// The outer loop has its cusp at (½, 0.875), the hole's is at (½, 0.525); both point up.
fn cusps() -> TrimmedSurface {
    let surface = sampled(even(3, 5), even(3, 5), |u, v| {
        let (x, y) = (1.8 * u - 0.9, 1.8 * v - 0.9);
        DVec3::new(x, y, 0.3 * x * x - 0.25 * y * y + 0.1 * x * y)
    });
    let [a, b] = [dvec2(0.1, 0.2), dvec2(0.9, 0.2)];
    let keel = bezier(&[a, dvec2(0.3, 0.02), dvec2(0.7, 0.02), b]);
    let [c, d] = [dvec2(0.35, 0.3), dvec2(0.65, 0.3)];
    let bowl = bezier(&[d, dvec2(0.6, 0.17), dvec2(0.4, 0.17), c]);
    (surface, vec![outer(vec![keel, reversed(cusp(a, b, 0.9))]), inner(vec![cusp(c, d, 0.3), bowl])])
}

/// How wide the waist of `sliver` is, in the unit of its domain, which is one long.
const WAIST: f64 = 1e-4;

/// Two parabolas bulge towards each other about v = ½ until [`WAIST`] is left between them, at u = ½.
fn sliver() -> TrimmedSurface {
    let surface = sampled(even(3, 5), even(3, 4), |u, v| {
        let (x, y) = (1.8 * u - 0.9, 1.2 * v - 0.6);
        DVec3::new(x, y, 0.2 * cos(2.5 * x) + 0.2 * y * y)
    });
    let parabola = |ends: f64, middle: f64| {
        // A quadratic at ½ is a quarter of each end and half of its middle control point.
        bezier(&[dvec2(0.05, ends), dvec2(0.5, 2.0 * middle - ends), dvec2(0.95, ends)])
    };
    let (below, above) = (parabola(0.15, 0.5 - WAIST / 2.0), parabola(0.85, 0.5 + WAIST / 2.0));
    let side = |from: &Trim, to: &Trim, k: usize| line(from.points[k], to.points[k]);
    let (east, west) = (side(&below, &above, 2), side(&above, &below, 0));
    (surface, vec![outer(vec![below, east, reversed(above), west])])
}

/// Parameters are ems of the font: the baseline is v = 0, the pen starts at u = 0.
fn text() -> TrimmedSurface {
    const EM: f64 = 2048.0;
    let advance: f64 = WORD.iter().map(|(advance, _)| f64::from(*advance)).sum();
    let (low, high) = (dvec2(-0.25, -0.5), dvec2(advance / EM + 0.25, 1.0));
    let direction = |degree, a: f64, b: f64| knots(degree, &[vec![a; degree + 1], vec![b; degree + 1]].concat());
    let surface = sampled(direction(3, low.x, high.x), direction(2, low.y, high.y), |u, v| {
        let (x, y) = (2.0 * u - 1.0, 0.6 * v - 0.3);
        DVec3::new(x, y, 0.4 * sin(3.0 * x) + 0.3 * y * y)
    });
    let mut loops = vec![outer(rectangle(low, high))];
    let mut pen = 0.0;
    for (advance, contours) in WORD {
        let place = |p: DVec2| (p + dvec2(pen, 0.0)) / EM;
        loops.extend(contours.iter().map(|points| inner(contour(points, place))));
        pen += f64::from(advance);
    }
    (surface, loops)
}

/// Faces along each side of `pieces`.
const PIECES_SIDE: usize = 4;

/// A wave cut into 4 × 4 patches, with 14 cubics round each and 9 holes of four quarters in it: 14 + 36 = 50.
fn pieces() -> Vec<TrimmedSurface> {
    let patch = |k: usize| {
        let (i, j) = ((k / PIECES_SIDE) as f64, (k % PIECES_SIDE) as f64);
        let surface = sampled(even(3, 4), even(3, 4), |u, v| {
            let (x, y) = (0.4 * (i + u) - 0.8, 0.4 * (j + v) - 0.8);
            DVec3::new(x, y, 0.15 * sin(3.0 * x) * cos(2.5 * y))
        });
        let mut loops = vec![outer(ruffle())];
        for hole in 0..9 {
            let center = dvec2(0.26 + 0.24 * (hole / 3) as f64, 0.26 + 0.24 * (hole % 3) as f64);
            let size = |step: usize| 0.06 + 0.02 * ((k + step * hole) % 3) as f64;
            loops.push(inner(quarters_against(center, dvec2(size(1), size(2)))));
        }
        (surface, loops)
    };
    (0..PIECES_SIDE * PIECES_SIDE).map(patch).collect()
}

/// Round the unit square between 0.02 and 0.06 inside its sides: 4, 3, 4 and 3 cubics, each from a crest to a trough or
/// back with level ends, so that none has an extremum inside.
fn ruffle() -> Vec<Trim> {
    let corners = [dvec2(0.02, 0.02), dvec2(0.98, 0.02), dvec2(0.98, 0.98), dvec2(0.02, 0.98)];
    let mut trims = vec![];
    for (side, count) in [4, 3, 4, 3].into_iter().enumerate() {
        let (from, to) = (corners[side], corners[(side + 1) % 4]);
        let along = (to - from) / count as f64;
        let inward = along.perp().normalize() * 0.04;
        // The last point of a side is the corner itself, whichever way the wave stands there.
        let at = |k: usize| from + along * k as f64 + if k % 2 == 1 && k < count { inward } else { DVec2::ZERO };
        for k in 0..count {
            let (a, b) = (at(k), if k + 1 == count { to } else { at(k + 1) });
            trims.push(bezier(&[a, a + along / 3.0, b - along / 3.0, b]));
        }
    }
    trims
}
