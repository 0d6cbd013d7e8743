//! Trim curves and loops of them, as the trimmed models need them beside their surfaces.

use super::letters::ContourPoint;
use crate::construction::{clamped, even, knots};
use glam::{DVec2, dvec2};
use nurbs::{KnotVector, Surface};
use scene::{Loop, Trim};
use std::f64::consts::FRAC_1_SQRT_2;

/// A surface and the loops of the face on it.
pub(super) type TrimmedSurface = (Surface, Vec<Loop>);

/// The way that a closed curve runs in (u, v), u to the right and v up.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Way {
    /// Counter-clockwise, material inside: outer boundaries and islands.
    Around,
    /// Clockwise, material outside: holes.
    Against,
}

/// A loop that is its face's outer boundary.
pub(super) fn outer(trims: Vec<Trim>) -> Loop {
    Loop { outer: true, trims }
}

/// A loop inside another: a hole, or an island in one, by the way that it runs.
pub(super) fn inner(trims: Vec<Trim>) -> Loop {
    Loop { outer: false, trims }
}

pub(super) fn polynomial(knots: KnotVector, points: Vec<DVec2>) -> Trim {
    debug_assert_eq!(knots.control_count(), points.len());
    Trim::new(knots, points, None)
}

/// A single Bézier segment, of the degree that its control points make.
pub(super) fn bezier(points: &[DVec2]) -> Trim {
    polynomial(clamped(points.len() - 1, &[]), points.to_vec())
}

pub(super) fn line(from: DVec2, to: DVec2) -> Trim {
    bezier(&[from, to])
}

/// The same curve, run through backwards.
pub(super) fn reversed(trim: Trim) -> Trim {
    Trim { reversed: !trim.reversed, ..trim }
}

/// A line on the seam of a surface that is closed in u.
pub(super) fn seam(from: DVec2, to: DVec2, edge: i64) -> Trim {
    Trim { seam: true, edge: Some(edge), ..line(from, to) }
}

/// A line along a side that is one point in space.
pub(super) fn pole(from: DVec2, to: DVec2, edge: i64) -> Trim {
    Trim { degenerate: true, edge: Some(edge), ..line(from, to) }
}

/// Lines from corner to corner and back to the first.
pub(super) fn polygon(corners: &[DVec2]) -> Vec<Trim> {
    let next = corners.iter().cycle().skip(1);
    corners.iter().zip(next).map(|(&from, &to)| line(from, to)).collect()
}

/// The box from `low` to `high`, counter-clockwise.
pub(super) fn rectangle(low: DVec2, high: DVec2) -> Vec<Trim> {
    polygon(&[low, dvec2(high.x, low.y), high, dvec2(low.x, high.y)])
}

/// The quarter of an ellipse from `from` to `to` whose tangents at its ends meet in `corner` (Piegl & Tiller, Sec. 7.3).
pub(super) fn quarter(from: DVec2, corner: DVec2, to: DVec2) -> Trim {
    Trim { weights: Some(vec![1.0, FRAC_1_SQRT_2, 1.0]), ..bezier(&[from, corner, to]) }
}

/// Directions of the eight control points round a circle, counter-clockwise from +u; those of odd index are corners.
const COMPASS: [[f64; 2]; 8] =
    [[1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [-1.0, 1.0], [-1.0, 0.0], [-1.0, -1.0], [0.0, -1.0], [1.0, -1.0]];

fn compass(center: DVec2, radii: DVec2, k: usize) -> DVec2 {
    center + radii * DVec2::from_array(COMPASS[k % 8])
}

/// An exact ellipse in one rational quadratic curve of nine control points (Piegl & Tiller, Sec. 7.5).
///
/// `Against` reverses the curve rather than its control points.
pub(super) fn ellipse(center: DVec2, radii: DVec2, way: Way) -> Vec<Trim> {
    let points = (0..9).map(|k| compass(center, radii, k)).collect();
    let weights = (0..9).map(|k| if k % 2 == 0 { 1.0 } else { FRAC_1_SQRT_2 }).collect();
    let curve = polynomial(clamped(2, &[0.25, 0.25, 0.5, 0.5, 0.75, 0.75]), points);
    vec![Trim { weights: Some(weights), reversed: way == Way::Against, ..curve }]
}

/// The same ellipse clockwise, in four quarters.
pub(super) fn quarters_against(center: DVec2, radii: DVec2) -> Vec<Trim> {
    let at = |k: usize| compass(center, radii, 8 - k);
    (0..4).map(|k| quarter(at(2 * k), at(2 * k + 1), at(2 * k + 2))).collect()
}

/// A box with corners rounded by quarters of a circle, clockwise from the start of its left side.
pub(super) fn rounded_against(low: DVec2, high: DVec2, radius: f64) -> Vec<Trim> {
    let corners = [low, dvec2(low.x, high.y), high, dvec2(high.x, low.y)];
    let along = |k: usize| (corners[(k + 1) % 4] - corners[k % 4]).normalize() * radius;
    let side = |k: usize| [corners[k] + along(k), corners[(k + 1) % 4] - along(k)];
    let turn = |k: usize| quarter(side(k)[1], corners[(k + 1) % 4], corners[(k + 1) % 4] + along(k + 1));
    (0..4).flat_map(|k| [line(side(k)[0], side(k)[1]), turn(k)]).collect()
}

/// A closed uniform cubic B-spline, its knots not repeated at the ends, that runs as its control points do.
pub(super) fn closed_cubic(points: &[DVec2]) -> Vec<Trim> {
    let count = points.len() + 3;
    let wrapped = points.iter().cycle().take(count).copied().collect();
    vec![polynomial(knots(3, &(0..count + 4).map(|k| k as f64 - 3.0).collect::<Vec<_>>()), wrapped)]
}

/// A cubic B-spline with evenly spaced knots through the ends of its control polygon.
pub(super) fn open_cubic(points: Vec<DVec2>) -> Trim {
    polynomial(even(3, points.len()), points)
}

/// The cubic from `from` to `to`, level with each other in v, with a cusp half way between and ¾ `height` above.
///
/// Its inner control points are exchanged, so that both components of the derivative have their zero at ½:
/// C′ = 3 ((to − from) (1 − 2t)², height (1 − 2t)).
pub(super) fn cusp(from: DVec2, to: DVec2, height: f64) -> Trim {
    let up = dvec2(0.0, height);
    bezier(&[from, to + up, from + up, to])
}

/// The segments of a font's contour: between two points that it does not pass through lies one half way that it does.
pub(super) fn contour(points: &[ContourPoint], place: impl Fn(DVec2) -> DVec2) -> Vec<Trim> {
    let at = |k: usize| {
        let (x, y, on) = points[k % points.len()];
        (dvec2(f64::from(x), f64::from(y)), on)
    };
    let (mut trims, mut from) = (vec![], at(0).0);
    debug_assert!(at(0).1);
    let mut k = 1;
    while k <= points.len() {
        let (point, on) = at(k);
        if on {
            trims.push(line(place(from), place(point)));
            from = point;
        } else {
            let (after, passed) = at(k + 1);
            let to = if passed { after } else { (point + after) / 2.0 };
            trims.push(bezier(&[place(from), place(point), place(to)]));
            from = to;
            k += usize::from(passed);
        }
        k += 1;
    }
    trims
}
