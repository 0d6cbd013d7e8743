//! Two surfaces that share a trimmed edge: exact on one, approximated on the other, as modellers write them.
//!
//! Both are graphs over −1 ≤ x, y ≤ 1 that are polynomials: z = f(x, y) below the curve y = q(x), and
//! z = f(x, y) + ½ (y − q(x)) above it. q has degree 4: the lower face's trim is that quartic, the upper face's the
//! piecewise cubic that interpolates it and its slope in 28 intervals of h = 1/14. Their difference is at most
//! max|q⁗| h⁴ / 384 = 8.4 / (384 · 14⁴) = 5.7e-7 in y, and by the slopes of the surfaces at most 1e-6 in space.

use super::outline::{TrimmedSurface, bezier, line, outer, polynomial, reversed};
use crate::construction::{clamped, surface};
use glam::{DVec2, DVec3, dvec2};
use nurbs::KnotVector;
use scene::Trim;

/// The edge that both faces name.
const EDGE: i64 = 1;

/// Coefficients of q, from the constant up.
const EDGE_CURVE: [f64; 5] = [0.1, 0.3, -0.5, 0.0, 0.35];

/// Rise of the upper surface over the lower one, a unit of y above the edge.
const CREASE: f64 = 0.5;

/// Intervals of the piecewise cubic.
const INTERVALS: usize = 28;

/// Degree of both surfaces in x and in y.
const DEGREE: [usize; 2] = [4, 2];

/// The lower face, u along x and v along y, both from 0 to 1; and the upper one, u from 2 to 5 along y, v from 0 to 1
/// against x.
pub(super) fn seam_pair() -> [TrimmedSurface; 2] {
    [lower(), upper()]
}

/// q(x) and its slope.
fn edge_curve(x: f64) -> [f64; 2] {
    let [c0, c1, c2, c3, c4] = EDGE_CURVE;
    let value = c0 + x * (c1 + x * (c2 + x * (c3 + x * c4)));
    [value, c1 + x * (2.0 * c2 + x * (3.0 * c3 + x * 4.0 * c4))]
}

/// Bernstein coefficient `i` of x^`power` over −1 ≤ x ≤ 1, in `degree`: its polar form at −1, degree − i times, and 1,
/// i times.
fn polar(power: usize, degree: usize, i: usize) -> f64 {
    // Elementary symmetric polynomials of the arguments, adding one after the other.
    let mut symmetric = [0.0; 6];
    symmetric[0] = 1.0;
    for k in 0..degree {
        let argument = if k < i { 1.0 } else { -1.0 };
        for m in (1..=power).rev() {
            symmetric[m] += argument * symmetric[m - 1];
        }
    }
    let choices = (0..power).fold(1.0, |product, k| product * (degree - k) as f64 / (k + 1) as f64);
    symmetric[power] / choices
}

/// Control point (i, j) of the graph over x and y, with `rise` times (y − q(x)) added.
fn control(i: usize, j: usize, rise: f64) -> DVec3 {
    let [x, y] = [|power, i| polar(power, DEGREE[0], i), |power, i| polar(power, DEGREE[1], i)];
    let f = 0.2 - 0.15 * x(2, i) + 0.1 * x(1, i) * y(1, j) - 0.2 * y(2, j);
    let q: f64 = EDGE_CURVE.iter().enumerate().map(|(power, c)| c * x(power, i)).sum();
    DVec3::new(x(1, i), y(1, j), f + rise * (y(1, j) - q))
}

fn lower() -> TrimmedSurface {
    let mut points = vec![];
    for i in 0..=DEGREE[0] {
        points.extend((0..=DEGREE[1]).map(|j| control(i, j, 0.0)));
    }
    let uv = |x: f64, y: f64| dvec2((x + 1.0) / 2.0, (y + 1.0) / 2.0);
    let quartic = |i: usize| {
        let y: f64 = EDGE_CURVE.iter().enumerate().map(|(power, c)| c * polar(power, 4, i)).sum();
        uv(polar(1, 4, i), y)
    };
    let edge: Vec<DVec2> = (0..=4).map(quartic).collect();
    let [left, right, first, last] = [uv(-1.0, -1.0), uv(1.0, -1.0), edge[0], edge[4]];
    let edge = Trim { edge: Some(EDGE), ..reversed(bezier(&edge)) };
    let boundary = vec![line(left, right), line(right, last), edge, line(first, left)];
    (surface(clamped(DEGREE[0], &[]), clamped(DEGREE[1], &[]), points, None), vec![outer(boundary)])
}

fn upper() -> TrimmedSurface {
    let mut points = vec![];
    for j in 0..=DEGREE[1] {
        points.extend((0..=DEGREE[0]).rev().map(|i| control(i, j, CREASE)));
    }
    let knots_u = KnotVector::new(2, vec![2.0, 2.0, 2.0, 5.0, 5.0, 5.0]).expect("sorted");
    let uv = |x: f64, y: f64| dvec2(2.0 + 1.5 * (y + 1.0), (1.0 - x) / 2.0);
    let edge = hermite();
    let edge = Trim { points: edge.points.iter().map(|p| uv(p.x, p.y)).collect(), edge: Some(EDGE), ..edge };
    let [first, last] = [edge.points[0], edge.points[edge.points.len() - 1]];
    let [right, left] = [uv(1.0, 1.0), uv(-1.0, 1.0)];
    // The edge runs along +x, which is from v = 1 down to v = 0.
    let boundary = vec![edge, line(last, right), line(right, left), line(left, first)];
    (surface(knots_u, clamped(DEGREE[0], &[]), points, None), vec![outer(boundary)])
}

/// The piecewise cubic over x, with double knots: continuous in its slope, so that no control point stands at a joint.
fn hermite() -> Trim {
    let h = 2.0 / INTERVALS as f64;
    let at = |k: usize| -1.0 + h * k as f64;
    let beside = |x: f64, third: f64| {
        let [value, slope] = edge_curve(x);
        dvec2(x + third, value + slope * third)
    };
    let mut points = vec![beside(-1.0, 0.0)];
    for k in 0..INTERVALS {
        points.extend([beside(at(k), h / 3.0), beside(at(k + 1), -h / 3.0)]);
    }
    points.push(beside(1.0, 0.0));
    let interior: Vec<f64> = (1..INTERVALS).flat_map(|k| [k as f64 / INTERVALS as f64; 2]).collect();
    polynomial(clamped(3, &interior), points)
}
