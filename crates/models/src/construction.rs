//! What built-in models are made of: embedded files, knots, control points on a shape, and turned profiles.
//!
//! A model's own module gives the numbers; what is made of them is checked by `nurbs` and goes back to it.

use formats::json;
use glam::DVec3;
use nurbs::{KnotVector, Surface};
use scene::Model;
use std::f64::consts::FRAC_1_SQRT_2;

/// The model of a file of this repository.
pub(crate) fn embedded(text: &str) -> Model {
    json::parse(text, "built in").expect("the embedded files are legal, as a test shows")
}

pub(crate) fn knots(degree: usize, knots: &[f64]) -> KnotVector {
    KnotVector::new(degree, knots.to_vec()).expect("written out, or made sorted")
}

/// Clamped knots over \[0, 1\] with the given interior ones.
pub(crate) fn clamped(degree: usize, interior: &[f64]) -> KnotVector {
    knots(degree, &[&vec![0.0; degree + 1], interior, &vec![1.0; degree + 1]].concat())
}

/// Clamped knots over \[0, 1\] for `count` control points, evenly spaced.
pub(crate) fn even(degree: usize, count: usize) -> KnotVector {
    let spans = count - degree;
    clamped(degree, &(1..spans).map(|i| i as f64 / spans as f64).collect::<Vec<_>>())
}

pub(crate) fn surface(
    knots_u: KnotVector,
    knots_v: KnotVector,
    points: Vec<DVec3>,
    weights: Option<Vec<f64>>,
) -> Surface {
    Surface::new(knots_u, knots_v, points, weights).expect("counts follow from the knots, and numbers are finite")
}

/// The Greville abscissa of control point `i`, as a share of the domain.
pub(crate) fn greville(knots: &KnotVector, i: usize) -> f64 {
    let p = knots.degree();
    let sum: f64 = knots.knots()[i + 1..=i + p].iter().sum();
    (sum / p as f64 - knots.domain().0) / knots.length()
}

/// Control points on `shape`, which maps the unit square, at the Greville abscissae.
pub(crate) fn sample(knots_u: &KnotVector, knots_v: &KnotVector, shape: impl Fn(f64, f64) -> DVec3) -> Vec<DVec3> {
    let mut points = vec![];
    for i in 0..knots_u.control_count() {
        for j in 0..knots_v.control_count() {
            points.push(shape(greville(knots_u, i), greville(knots_v, j)));
        }
    }
    points
}

pub(crate) fn sampled(knots_u: KnotVector, knots_v: KnotVector, shape: impl Fn(f64, f64) -> DVec3) -> Surface {
    let points = sample(&knots_u, &knots_v, shape);
    surface(knots_u, knots_v, points, None)
}

/// Bicubic, closed in u by periodic knots, of `around` × `along` spans; `shape` maps the unit square and is periodic in u.
pub(crate) fn closed([around, along]: [usize; 2], shape: impl Fn(f64, f64) -> DVec3) -> Surface {
    let period: Vec<f64> = (0..=around).map(|k| k as f64).collect();
    let knots_u = KnotVector::periodic(3, &period).expect("sorted, and as long as asked for");
    let knots_v = even(3, along + 3);
    let mut points = vec![];
    for i in 0..knots_u.control_count() {
        for j in 0..knots_v.control_count() {
            points.push(shape(greville(&knots_u, i % around), greville(&knots_v, j)));
        }
    }
    surface(knots_u, knots_v, points, None)
}

/// The unit circle in nine points (Piegl & Tiller, Sec. 7.5): x, y, weight.
pub(crate) const CIRCLE: [[f64; 3]; 9] = [
    [1.0, 0.0, 1.0],
    [1.0, 1.0, FRAC_1_SQRT_2],
    [0.0, 1.0, 1.0],
    [-1.0, 1.0, FRAC_1_SQRT_2],
    [-1.0, 0.0, 1.0],
    [-1.0, -1.0, FRAC_1_SQRT_2],
    [0.0, -1.0, 1.0],
    [1.0, -1.0, FRAC_1_SQRT_2],
    [1.0, 0.0, 1.0],
];

/// Interior knots of [`CIRCLE`].
pub(crate) const QUARTERS: [f64; 6] = [0.25, 0.25, 0.5, 0.5, 0.75, 0.75];

/// A profile of radius, height and weight, turned about the z axis; u goes round, v along the profile.
pub(crate) fn revolved(profile: &[[f64; 3]], knots_v: KnotVector) -> Surface {
    let (mut points, mut weights) = (vec![], vec![]);
    for [x, y, w] in CIRCLE {
        for [radius, z, w_profile] in profile {
            points.push(DVec3::new(radius * x, radius * y, *z));
            weights.push(w * w_profile);
        }
    }
    surface(clamped(2, &QUARTERS), knots_v, points, Some(weights))
}

/// The unit sphere; u goes round, v from its south pole to the north one.
pub(crate) fn sphere() -> Surface {
    let meridian =
        [[0.0, -1.0, 1.0], [1.0, -1.0, FRAC_1_SQRT_2], [1.0, 0.0, 1.0], [1.0, 1.0, FRAC_1_SQRT_2], [0.0, 1.0, 1.0]];
    revolved(&meridian, clamped(2, &[0.5, 0.5]))
}
