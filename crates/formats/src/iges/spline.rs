//! B-splines (126, 128) and parametric splines (112, 114).

use super::fault::{Fault, fault};
use super::geometry::Geometry;
use super::value::Parameters;
use crate::brep::curve::Curve;
use crate::brep::path::Piece;
use glam::DVec3;
use nurbs::{Direction, KnotVector, NurbsError, SpaceCurve, Surface};

/// An end of a domain that is nearer than this to a knot vector's own, as a share of its length, is that.
const SAME: f64 = 1e-9;

/// Degree of parametric splines, and how many coefficients a coordinate has in a piece of a curve and of a surface.
const CUBIC: usize = 3;

fn wrong(number: u32) -> impl Fn(NurbsError) -> Fault {
    move |cause| fault(number, cause.to_string())
}

fn points(values: &[f64]) -> Vec<DVec3> {
    values.chunks_exact(3).map(DVec3::from_slice).collect()
}

/// Weights that say something: not all the same.
fn weights(values: Vec<f64>) -> Option<Vec<f64>> {
    values.iter().any(|w| *w != values[0]).then_some(values)
}

/// A rational B-spline curve (126) over its own range.
pub(super) fn spline_curve(geometry: &Geometry, own: Parameters) -> Result<Piece, Fault> {
    let (last, degree) = (own.whole(1)?, own.whole(2)?);
    let (count, knots) = (last + 1, last + degree + 2);
    geometry.spend(own.number, count)?;
    let vector = KnotVector::new(degree, own.numbers(7, knots)?).map_err(wrong(own.number))?;
    let weights = weights(own.numbers(7 + knots, count)?);
    let points = points(&own.numbers(7 + knots + count, 3 * count)?);
    let spline = SpaceCurve::new(vector, &points, weights.as_deref()).map_err(wrong(own.number))?;
    let ends = ends(own, 7 + knots + 4 * count, 2)?;
    let range = range(own.number, &ends, spline.knots())?;
    Ok(Piece { curve: Curve::spline(spline, geometry.tolerance), range })
}

/// The ends of domains behind the control points; none where the record ends before them.
fn ends(own: Parameters, from: usize, count: usize) -> Result<Vec<f64>, Fault> {
    if own.values.len() <= from { Ok(vec![]) } else { own.numbers(from, count) }
}

/// The part of a knot vector's domain that the file names; all of it where it names none.
fn range(number: u32, ends: &[f64], knots: &KnotVector) -> Result<[f64; 2], Fault> {
    let (start, end) = knots.domain();
    let &[a, b] = ends else { return Ok([start, end]) };
    let slack = SAME * (end - start);
    let snapped = |t: f64, own: f64| if (t - own).abs() <= slack { own } else { t };
    let [a, b] = [snapped(a, start), snapped(b, end)];
    match start <= a && a < b && b <= end {
        true => Ok([a, b]),
        // Some writers leave zeros there.
        false if a == 0.0 && b == 0.0 => Ok([start, end]),
        false => Err(fault(number, format!("its range {a} to {b} is not in that of its knots, {start} to {end}"))),
    }
}

/// A rational B-spline surface (128) over its own rectangle; its control points come with u fastest.
pub(super) fn spline_surface(geometry: &Geometry, own: Parameters) -> Result<Surface, Fault> {
    let [k1, k2, m1, m2] = [own.whole(1)?, own.whole(2)?, own.whole(3)?, own.whole(4)?];
    let [nu, nv] = [k1 + 1, k2 + 1];
    let [knots_u, knots_v] = [nu + m1 + 1, nv + m2 + 1];
    let count = nu.saturating_mul(nv);
    // What is not there is not asked for: each point takes four parameters.
    if own.values.len() / 4 < count {
        return Err(fault(own.number, format!("it has {} parameters for {nu} × {nv} points", own.values.len())));
    }
    geometry.spend(own.number, count)?;
    let u = KnotVector::new(m1, own.numbers(10, knots_u)?).map_err(wrong(own.number))?;
    let v = KnotVector::new(m2, own.numbers(10 + knots_u, knots_v)?).map_err(wrong(own.number))?;
    let first = 10 + knots_u + knots_v;
    let weights = weights(transposed(&own.numbers(first, count)?, nu));
    let points = transposed(&points(&own.numbers(first + count, 3 * count)?), nu);
    let ends = ends(own, first + 4 * count, 4)?;
    let ranges = [
        range(own.number, ends.get(..2).unwrap_or_default(), &u)?,
        range(own.number, ends.get(2..).unwrap_or_default(), &v)?,
    ];
    let mut surface = Surface::new(u, v, points, weights).map_err(wrong(own.number))?;
    for (direction, [start, end]) in [Direction::U, Direction::V].into_iter().zip(ranges) {
        let whole = surface.knots(direction).domain();
        if whole.0 < start {
            let [_, above] = surface.split(direction, start).map_err(wrong(own.number))?;
            surface = above;
        }
        if end < whole.1 {
            let [below, _] = surface.split(direction, end).map_err(wrong(own.number))?;
            surface = below;
        }
    }
    Ok(surface)
}

/// A list with u fastest, rows of `nu`, as one with v fastest.
fn transposed<T: Copy>(list: &[T], nu: usize) -> Vec<T> {
    let nv = list.len() / nu;
    (0..list.len()).map(|k| list[k % nv * nu + k / nv]).collect()
}

/// The knots of cubic pieces that meet with their ends and no smoother, which holds what any file says of them.
fn cubic_knots(number: u32, breaks: &[f64]) -> Result<KnotVector, Fault> {
    let (first, last) = (breaks[0], breaks[breaks.len() - 1]);
    let all = breaks.iter().flat_map(|t| [*t; CUBIC]);
    let knots = [first].into_iter().chain(all).chain([last]).collect();
    KnotVector::new(CUBIC, knots).map_err(wrong(number))
}

/// Bézier coefficients of a + b s + c s² + d s³ for s from 0 to `h`.
fn bezier<T>([a, b, c, d]: [T; 4], h: f64) -> [T; 4]
where
    T: Copy + std::ops::Add<Output = T> + std::ops::Mul<f64, Output = T>,
{
    let [b, c, d] = [b * h, c * (h * h), d * (h * h * h)];
    [a, a + b * (1.0 / 3.0), a + b * (2.0 / 3.0) + c * (1.0 / 3.0), a + b + c + d]
}

/// A parametric spline curve (112): cubic pieces, each in a parameter of its own from 0.
pub(super) fn cubic_curve(geometry: &Geometry, own: Parameters) -> Result<Piece, Fault> {
    let count = own.count(4, 4 * CUBIC)?;
    if count == 0 {
        return Err(fault(own.number, "it has no pieces"));
    }
    geometry.spend(own.number, CUBIC * count)?;
    let breaks = own.numbers(5, count + 1)?;
    let values = own.numbers(6 + count, 12 * count)?;
    let mut points: Vec<DVec3> = vec![];
    for (piece, pair) in values.chunks_exact(12).zip(breaks.windows(2)) {
        let coefficient = |k: usize| DVec3::new(piece[k], piece[4 + k], piece[8 + k]);
        points.pop();
        points.extend(bezier([0, 1, 2, 3].map(coefficient), pair[1] - pair[0]));
    }
    let spline = SpaceCurve::new(cubic_knots(own.number, &breaks)?, &points, None).map_err(wrong(own.number))?;
    let range = spline.knots().domain().into();
    Ok(Piece { curve: Curve::spline(spline, geometry.tolerance), range })
}

/// A parametric spline surface (114): bicubic pieces, each in parameters of its own from 0.
pub(super) fn cubic_surface(geometry: &Geometry, own: Parameters) -> Result<Surface, Fault> {
    const EACH: usize = 3 * 16;
    let [m, n] = [own.whole(3)?, own.whole(4)?];
    let there = own.values.len() / EACH;
    if m == 0 || n == 0 || there < m.saturating_mul(n) {
        return Err(fault(own.number, format!("it has {} parameters for {m} × {n} pieces", own.values.len())));
    }
    geometry.spend(own.number, 16 * m * n)?;
    let (breaks_u, breaks_v) = (own.numbers(5, m + 1)?, own.numbers(6 + m, n + 1)?);
    let first = 7 + m + n;
    // The standard asks for one more row and column, whose numbers say nothing.
    let columns = if first + (m * (n + 1)) * EACH <= own.values.len() { n + 1 } else { n };
    let [rows, across] = [CUBIC * m + 1, CUBIC * n + 1];
    let mut points = vec![DVec3::ZERO; rows * across];
    for (i, pair_u) in breaks_u.windows(2).enumerate() {
        for (j, pair_v) in breaks_v.windows(2).enumerate() {
            let values = own.numbers(first + (i * columns + j) * EACH, EACH)?;
            // Powers of s run fastest, those of t slower, coordinates slowest.
            let coefficient = |s: usize, t: usize| {
                let at = 4 * t + s;
                DVec3::new(values[at], values[16 + at], values[32 + at])
            };
            let along_s = [0, 1, 2, 3].map(|t| bezier([0, 1, 2, 3].map(|s| coefficient(s, t)), pair_u[1] - pair_u[0]));
            for a in 0..=CUBIC {
                let control = bezier([0, 1, 2, 3].map(|t| along_s[t][a]), pair_v[1] - pair_v[0]);
                for (b, point) in control.into_iter().enumerate() {
                    points[(CUBIC * i + a) * across + CUBIC * j + b] = point;
                }
            }
        }
    }
    let [u, v] = [cubic_knots(own.number, &breaks_u)?, cubic_knots(own.number, &breaks_v)?];
    Surface::new(u, v, points, None).map_err(wrong(own.number))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cubic_is_its_bezier_form() {
        let (own, h) = ([1.0, -2.0, 3.0, 0.5], 1.5);
        let control = bezier(own, h);
        for k in 0..=4 {
            let t = f64::from(k) / 4.0;
            let s = h * t;
            let expected = own[0] + s * (own[1] + s * (own[2] + s * own[3]));
            let u = 1.0 - t;
            let found = control[0] * u * u * u
                + 3.0 * control[1] * u * u * t
                + 3.0 * control[2] * u * t * t
                + control[3] * t * t * t;
            assert!((found - expected).abs() < 1e-14, "{found} {expected}");
        }
    }

    #[test]
    fn rows_with_u_fastest_become_rows_with_v_fastest() {
        assert_eq!(transposed(&[11, 21, 31, 12, 22, 32], 3), [11, 12, 21, 22, 31, 32]);
    }
}
