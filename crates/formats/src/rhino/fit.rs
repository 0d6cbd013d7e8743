//! Trims on surfaces whose own parameter is an angle: the same curves in the parameters of the rational surface.
//!
//! Borders and lines of constant parameter, which are most, stay what they are. Any other curve is followed by cubics.

use super::curve::{Turn, parameter};
use crate::spline::Spline;
use glam::{DVec2, DVec4};
use nurbs::NurbsError;

/// How far cubics may be from a trim, as a share of the surface's domain.
const CLOSE: f64 = 1e-8;

/// How often the parameter range of a span is halved.
const HALVINGS: u32 = 12;

/// The most cubics for a curve, and for each of its spans; a curve that asks for more is as close as they make it.
const CUBICS: [usize; 2] = [1000, 50];

/// Where a cubic through four points of a curve is compared with it, as shares of its range.
const COMPARED: [f64; 3] = [1.0 / 6.0, 0.5, 5.0 / 6.0];

/// A trim in the parameters of the rational surface over a domain, and how far it is off where it was compared, as a share of that:
/// 0 where it is exact.
///
/// # Errors
/// Where its numbers are too large.
pub(super) fn fitted(
    curve: &Spline,
    turns: &[Vec<Turn>; 2],
    domain: [[f64; 2]; 2],
) -> Result<(Spline, f64), NurbsError> {
    let map = |p: DVec2| DVec2::new(parameter(&turns[0], p.x), parameter(&turns[1], p.y));
    let first = curve.plane_points().next().expect("a spline has points");
    let is_constant = [0, 1].map(|axis| curve.plane_points().all(|p| p[axis] == first[axis]));
    if [0, 1].into_iter().all(|axis| turns[axis].is_empty() || is_constant[axis]) {
        let moved = map(first);
        let place = |p: DVec4| {
            let [x, y] = [0, 1].map(|axis| if is_constant[axis] { moved[axis] * p.w } else { p[axis] });
            DVec4::new(x, y, 0.0, p.w)
        };
        return Ok((curve.mapped(place), 0.0));
    }
    let range = curve.domain();
    let at = |t: f64| {
        let p = curve.point(t);
        map(DVec2::new(p.x, p.y) / p.w)
    };
    if is_constant[0] || is_constant[1] {
        let ends = range.map(|t| at(t).extend(0.0).extend(1.0));
        return Ok((Spline::bezier(ends.to_vec(), range)?, 0.0));
    }
    let size = DVec2::from(domain.map(|[start, end]| end - start));
    let u = curve.knots().knots();
    let mut spans: Vec<([f64; 2], u32)> = curve.knots().spans().map(|k| ([u[k], u[k + 1]], 0)).collect();
    spans.reverse();
    let most = 3 * (CUBICS[0] + CUBICS[1] * spans.len());
    let (mut knots, mut points) = (vec![range[0]; 4], vec![at(range[0])]);
    let mut off = 0.0;
    while let Some(([a, b], halvings)) = spans.pop() {
        let t = |share: f64| a + (b - a) * share;
        let on = [0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0].map(|share| at(t(share)));
        // The cubic through four points at equal steps, by its control points.
        let inner = [
            (on[1] * 18.0 - on[2] * 9.0 - on[0] * 5.0 + on[3] * 2.0) / 6.0,
            (on[2] * 18.0 - on[1] * 9.0 - on[3] * 5.0 + on[0] * 2.0) / 6.0,
        ];
        let cubic = |s: f64| {
            let r = 1.0 - s;
            on[0] * (r * r * r) + inner[0] * (3.0 * r * r * s) + inner[1] * (3.0 * r * s * s) + on[3] * (s * s * s)
        };
        let apart = |s: f64| ((cubic(s) - at(t(s))) / size).abs().max_element();
        let worst = COMPARED.map(apart).into_iter().fold(0.0, f64::max);
        let middle = t(0.5);
        let is_open = halvings < HALVINGS && points.len() < most && a < middle && middle < b;
        if worst > CLOSE && is_open {
            spans.extend([([middle, b], halvings + 1), ([a, middle], halvings + 1)]);
            continue;
        }
        off = worst.max(off);
        points.extend([inner[0], inner[1], on[3]]);
        knots.extend([b; 3]);
    }
    knots.push(range[1]);
    Ok((Spline::new(3, knots, points.into_iter().map(|p| p.extend(0.0).extend(1.0)).collect())?, off))
}

#[cfg(test)]
mod tests {
    use super::super::curve::arc;
    use super::*;

    /// A quarter turn in u over [0, 1], v as it is.
    fn quarter() -> ([Vec<Turn>; 2], [[f64; 2]; 2]) {
        ([arc([0.0, 1.5], [0.0, 1.0]).2, vec![]], [[0.0, 1.0], [0.0, 1.0]])
    }

    fn line(from: [f64; 2], to: [f64; 2]) -> Spline {
        Spline::bezier([from, to].map(|[u, v]| DVec4::new(u, v, 0.0, 1.0)).to_vec(), [2.0, 5.0]).unwrap()
    }

    #[test]
    fn lines_of_constant_parameter_stay_lines() {
        let (turns, domain) = quarter();
        let (along, off) = fitted(&line([0.25, 0.5], [0.75, 0.5]), &turns, domain).unwrap();
        assert_eq!((along.knots().degree(), off), (1, 0.0));
        let ends: Vec<DVec2> = along.plane_points().collect();
        assert_eq!(ends, [0.25, 0.75].map(|u| DVec2::new(parameter(&turns[0], u), 0.5)));
        let (across, off) = fitted(&line([0.25, 0.0], [0.25, 1.0]), &turns, domain).unwrap();
        assert_eq!((across.knots().degree(), off), (1, 0.0));
        assert!(across.plane_points().all(|p| p.x == ends[0].x));
    }

    #[test]
    fn a_helix_is_followed_as_closely_as_is_said() {
        let (turns, domain) = quarter();
        let own = line([0.0, 0.0], [1.0, 1.0]);
        let (helix, off) = fitted(&own, &turns, domain).unwrap();
        assert!(0.0 < off && off <= CLOSE, "{off}");
        let mut worst: f64 = 0.0;
        for k in 0..=1000 {
            let t = 2.0 + 3.0 * f64::from(k) / 1000.0;
            let share = f64::from(k) / 1000.0;
            let p = helix.point(t);
            worst = worst.max((DVec2::new(p.x, p.y) - DVec2::new(parameter(&turns[0], share), share)).length());
        }
        assert!(worst <= 2.0 * CLOSE, "{worst}, and straight in the rational parameters it would be 0.01");
    }
}
