//! How far quintics may be from the offset that they interpolate: a bound at all places, not a measurement.
//!
//! On a part where the offset F is smooth, the quintic through its values at six nodes is off by at most max |ω| max |F⁽⁶⁾| / 6!, where ω
//! is the product of the distances from the nodes (Davis, *Interpolation and Approximation*, 1963, Th. 3.1.1). Lobatto's nodes on 0 to 1
//! have max |ω| = 2⁻¹⁰. In two directions, F − I_u I_v F = (F − I_u F) + I_u (F − I_v F), and I_u makes nothing more than
//! [`LEBESGUE`] times as large. The sixth derivatives are those of a [`Series`], which holds them at all places. So the bound
//! is proven but for the rounding of the nodes and of control points.

use super::across::{Across, Ramp};
use super::curve::Curve;
use super::frame::Frame;
use super::series::{Interval, Series, TERMS, Vector, cross, scaled, sum, unit};
use glam::{DVec3, DVec4};
use nurbs::{BezierPatch, QUINTIC};

/// The greatest product of the distances from Lobatto's six nodes on 0 to 1: sin θ sin 5θ / 2⁴ on −1 to 1, halved six times.
const NODES_APART: f64 = 1.0 / 1024.0;

/// No interpolation at Lobatto's six nodes is more than this times the greatest of the values there: 1.989 by a test.
const LEBESGUE: f64 = 2.0;

/// The derivative that counts.
const SIXTH: usize = QUINTIC + 1;

/// How often a patch is quartered in the search for its bound, and how much the sixth derivative along a half is less by its own parameter.
const QUARTERINGS: u32 = 5;
const SHARE: f64 = 64.0;

/// How far the quintic over a part of a curve may be from the offset there; `None` where nothing is known.
pub(super) fn curve_bound(curve: &Curve, [a, b]: [f64; 2], across: &Across, ramp: Ramp) -> Option<f64> {
    let point = along_curve(curve, [a, b])?;
    let tangent = point.map(Series::derivative);
    let direction = match across {
        Across::Beside(vector) => cross(tangent, constant(*vector)),
        Across::Outward(Frame { origin, z, .. }) => {
            let arm = sum(point, constant(-*origin));
            cross(cross(constant(*z), arm), tangent)
        }
    };
    let mut distance = Series::ZERO;
    distance.0[0] = Interval::around([a, b].map(|t| ramp.at(t)).into_iter(), 0.0);
    distance.0[1] = Interval::around(std::iter::once(ramp.slope * (b - a)), 0.0);
    known(NODES_APART * sixth(sum(point, scaled(unit(direction)?, distance))))
}

/// How far the biquintic over a patch is at most from the offset there; `None` where no bound within `limit` was found before so many
/// `boxes` were tried.
pub(super) fn patch_bound(patch: &BezierPatch, distance: f64, limit: f64, boxes: &mut usize) -> Option<f64> {
    patch_bound_within(patch, distance, limit, boxes, QUARTERINGS)
}

/// Derivatives over a quarter are known more closely; those by its own parameters are a 64th of the patch's.
fn patch_bound_within(
    patch: &BezierPatch,
    distance: f64,
    limit: f64,
    boxes: &mut usize,
    quarterings: u32,
) -> Option<f64> {
    *boxes = boxes.checked_sub(1)?;
    // With u and v exchanged the normal is the other one.
    let both = [(patch.clone(), distance), (patch.transposed(), -distance)];
    let [u, v] = both.map(|(patch, distance)| Net::new(&patch).offset(distance).map(sixth));
    let bound = u.zip(v).map(|(u, v)| NODES_APART * (u + LEBESGUE * v));
    if bound.is_some_and(|bound| bound <= limit) {
        return bound;
    }
    let quarterings = quarterings.checked_sub(1)?;
    patch.quarters().iter().try_fold(0.0f64, |most, quarter| {
        Some(most.max(SHARE * patch_bound_within(quarter, distance, limit / SHARE, boxes, quarterings)?))
    })
}

fn known(bound: f64) -> Option<f64> {
    bound.is_finite().then_some(bound)
}

/// No sixth derivative is longer, divided by 6!.
fn sixth(f: Vector) -> f64 {
    f.map(|x| x.0[SIXTH].magnitude().powi(2)).iter().sum::<f64>().sqrt() * (1.0 + 8.0 * f64::EPSILON)
}

fn constant(v: DVec3) -> Vector {
    v.to_array().map(Series::constant)
}

/// Homogeneous coordinates, from a net of Bézier points: its derivatives along the first direction, all over the second.
fn homogeneous(rows: &[Vec<DVec4>]) -> [Series; 4] {
    let most = rows.iter().flatten().fold(DVec4::ZERO, |most, c| most.max(c.abs()));
    let mut differences = rows.to_vec();
    let mut all = [Series::ZERO; 4];
    let (mut factor, p) = (1.0, rows.len() - 1);
    for k in 0..TERMS.min(p + 1) {
        if 0 < k {
            factor *= (p + 1 - k) as f64 / k as f64;
            differences = differences
                .windows(2)
                .map(|pair| pair[0].iter().zip(&pair[1]).map(|(a, b)| *b - *a).collect())
                .collect();
        }
        // A difference of order k sums 2ᵏ numbers.
        let lost = most * (4.0 * f64::EPSILON * f64::from(1u32 << k) * (k + 1) as f64);
        for (axis, series) in all.iter_mut().enumerate() {
            let numbers = differences.iter().flatten().map(|c| c[axis]);
            series.0[k] = Interval::around(numbers, lost[axis]) * Interval::of(factor);
        }
    }
    all
}

/// The Bézier points of a patch, row by row of its first direction.
struct Net {
    rows: Vec<Vec<DVec4>>,
}

impl Net {
    fn new(patch: &BezierPatch) -> Self {
        Self { rows: patch.control.chunks(patch.degree[1] + 1).map(<[DVec4]>::to_vec).collect() }
    }

    /// The offset along the first direction.
    fn offset(&self, distance: f64) -> Option<Vector> {
        let [x, y, z, w] = homogeneous(&self.rows);
        let point = scaled([x, y, z], w.reciprocal()?);
        let normal = cross(point.map(Series::derivative), self.across(point, w)?);
        Some(sum(point, scaled(unit(normal)?, Series::constant(distance))))
    }

    /// The derivative across, of (x, y, z) / w, whose value is `point`.
    fn across(&self, point: Vector, w: Series) -> Option<Vector> {
        let degree = self.rows[0].len() as f64 - 1.0;
        let differences = |row: &Vec<DVec4>| row.windows(2).map(|pair| (pair[1] - pair[0]) * degree).collect();
        let [x, y, z, slope] = homogeneous(&self.rows.iter().map(differences).collect::<Vec<_>>());
        let moved = scaled(point, Series::ZERO - slope);
        Some(scaled(sum([x, y, z], moved), w.reciprocal()?))
    }
}

/// A curve over a range within one of its spans, as a function of 0 to 1.
fn along_curve(curve: &Curve, [a, b]: [f64; 2]) -> Option<Vector> {
    let step = b - a;
    // Coefficients of what has these derivatives by the parameter.
    let series = |derivative: &dyn Fn(usize) -> Interval| {
        let mut factor = Interval::of(1.0);
        Series(std::array::from_fn(|k| {
            if 0 < k {
                factor = factor * Interval::around(std::iter::once(step / k as f64), 0.0);
            }
            derivative(k) * factor
        }))
    };
    let turned = |frame: &Frame, x: Series, y: Series| {
        let [x, y] = [(frame.x, x), (frame.y, y)].map(|(axis, length)| scaled(constant(axis), length));
        sum(constant(frame.origin), sum(x, y))
    };
    let scale = |length: f64, series: Series| series * Series::constant(length);
    let ends = || [a, b].into_iter();
    Some(match curve {
        Curve::Line { origin, direction } => {
            let t = series(&|k| match k {
                0 => Interval::around(ends(), 0.0),
                1 => Interval::of(1.0),
                _ => Interval::ZERO,
            });
            sum(constant(*origin), scaled(constant(*direction), t))
        }
        Curve::Ellipse { frame, radii } => {
            // The k-th derivative of cos is cos (t + k π / 2); none is steeper than 1.
            let (middle, half) = (0.5 * (a + b), 0.5 * step);
            let cosine = |quarters: usize| {
                let (sin, cos) = (libm::sin(middle), libm::cos(middle));
                let value = [cos, -sin, -cos, sin][quarters % 4];
                Interval { low: (value - half).next_down().max(-1.0), high: (value + half).next_up().min(1.0) }
            };
            turned(frame, scale(radii.x, series(&cosine)), scale(radii.y, series(&|k| cosine(k + 3))))
        }
        Curve::Parabola { frame, focal } => {
            let t = series(&|k| match k {
                0 => Interval::around(ends(), 0.0),
                1 => Interval::of(1.0),
                _ => Interval::ZERO,
            });
            turned(frame, scale(*focal, t * t), scale(2.0 * focal, t))
        }
        Curve::Hyperbola { frame, radii } => {
            let least = if a <= 0.0 && 0.0 <= b { 0.0 } else { a.abs().min(b.abs()) };
            let cosh = Interval::around([least, a, b].map(f64::cosh).into_iter(), 1e-15 * a.abs().max(b.abs()).cosh());
            let sinh = Interval::around(ends().map(f64::sinh), 1e-15 * a.abs().max(b.abs()).cosh());
            let hyperbolic = |k: usize| if k.is_multiple_of(2) { cosh } else { sinh };
            turned(frame, scale(radii.x, series(&hyperbolic)), scale(radii.y, series(&|k| hyperbolic(k + 1))))
        }
        Curve::Spline { .. } => {
            let [part] = <[_; 1]>::try_from(curve.splines([a, b]).ok()?).ok()?;
            let weights = part.weights();
            let weight = |k: usize| weights.as_ref().map_or(1.0, |w| w[k]);
            let rows: Vec<Vec<DVec4>> =
                part.points().enumerate().map(|(k, p)| vec![(p * weight(k)).extend(weight(k))]).collect();
            if rows.len() != part.knots().degree() + 1 {
                return None;
            }
            let [x, y, z, w] = homogeneous(&rows);
            scaled([x, y, z], w.reciprocal()?)
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use nurbs::NODES;

    #[test]
    fn the_constants_are_those_of_the_nodes() {
        let places = || (0..=100_000).map(|k| f64::from(k) / 100_000.0);
        let apart = |x: f64| NODES.iter().map(|node| x - node).product::<f64>().abs();
        let greatest = places().map(apart).fold(0.0, f64::max);
        assert!(greatest <= NODES_APART * (1.0 + 1e-9) && NODES_APART * 0.999 < greatest, "{greatest}");
        let share = |x: f64, i: usize| {
            let others = || NODES.iter().enumerate().filter(|(j, _)| *j != i);
            others().map(|(_, node)| (x - node) / (NODES[i] - node)).product::<f64>().abs()
        };
        let greatest = places().map(|x| (0..6).map(|i| share(x, i)).sum()).fold(0.0, f64::max);
        assert!(greatest <= LEBESGUE && 0.99 * LEBESGUE < greatest, "{greatest}");
    }
}
