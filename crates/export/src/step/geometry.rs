//! Surfaces, curves and points as B-splines of ISO 10303-42, every number bit for bit.

use super::text::{Text, flag, knots, real, reals, references};
use glam::{DVec2, DVec3};
use nurbs::{Direction, KnotVector, SpaceCurve, Surface};
use scene::{Trim, closed};

/// A point in space.
pub(super) fn point(text: &mut Text, p: DVec3) -> u64 {
    text.add(&format!("CARTESIAN_POINT('',{})", reals(p.to_array())))
}

/// A surface.
pub(super) fn surface(text: &mut Text, surface: &Surface) -> u64 {
    let ([p, q], [_, columns]) = (surface.degree(), surface.control_counts());
    let points: Vec<u64> = surface.points().iter().map(|p| point(text, *p)).collect();
    let rows: Vec<String> = points.chunks(columns).map(references).collect();
    let rows = rows.join(",");
    let [closed_u, closed_v] = closed(surface).map(flag);
    let base = format!("{p},{q},({rows}),.UNSPECIFIED.,{closed_u},{closed_v},.F.");
    let [mu, ku] = knots(surface.knots(Direction::U).knots());
    let [mv, kv] = knots(surface.knots(Direction::V).knots());
    let knots = format!("{mu},{mv},{ku},{kv},.UNSPECIFIED.");
    match surface.weights() {
        None => text.add(&format!("B_SPLINE_SURFACE_WITH_KNOTS('',{base},{knots})")),
        Some(weights) => {
            let rows: Vec<String> = weights.chunks(columns).map(|row| reals(row.iter().copied())).collect();
            text.add(&format!(
                "(BOUNDED_SURFACE()B_SPLINE_SURFACE({base})B_SPLINE_SURFACE_WITH_KNOTS({knots})\
                 GEOMETRIC_REPRESENTATION_ITEM()RATIONAL_B_SPLINE_SURFACE(({}))REPRESENTATION_ITEM('')SURFACE())",
                rows.join(",")
            ))
        }
    }
}

/// A curve in space.
pub(super) fn curve(text: &mut Text, curve: &SpaceCurve) -> u64 {
    let points: Vec<u64> = curve.points().map(|p| point(text, p)).collect();
    b_spline(text, curve.knots(), curve.knots().knots(), &points, curve.weights().as_deref())
}

/// A trim as a curve in its surface's parameters, run along the domain `[start, end]` of its edge; backwards where `turned`.
///
/// Knots stay bit for bit where that is the trim's own domain.
pub(super) fn trim_curve(text: &mut Text, trim: &Trim, [start, end]: [f64; 2], turned: bool) -> u64 {
    let own = trim.knots.domain();
    let map = |t: f64| match (turned, [own.0, own.1] == [start, end]) {
        (false, true) => t,
        (false, false) if t == own.1 => end,
        (false, false) => start + (t - own.0) / (own.1 - own.0) * (end - start),
        (true, _) if t == own.0 => end,
        (true, _) => start + (own.1 - t) / (own.1 - own.0) * (end - start),
    };
    let mut values: Vec<f64> = trim.knots.knots().iter().map(|t| map(*t)).collect();
    let mut points: Vec<DVec2> = trim.points.clone();
    let mut weights = trim.weights.clone();
    if turned {
        values.reverse();
        points.reverse();
        weights.iter_mut().for_each(|weights| weights.reverse());
    }
    let points: Vec<u64> =
        points.iter().map(|p| text.add(&format!("CARTESIAN_POINT('',({},{}))", real(p.x), real(p.y)))).collect();
    b_spline(text, &trim.knots, &values, &points, weights.as_deref())
}

fn b_spline(text: &mut Text, knot_vector: &KnotVector, values: &[f64], points: &[u64], weights: Option<&[f64]>) -> u64 {
    let base = format!("{},{},.UNSPECIFIED.,.F.,.F.", knot_vector.degree(), references(points));
    let [multiplicities, values] = knots(values);
    let knots = format!("{multiplicities},{values},.UNSPECIFIED.");
    match weights {
        None => text.add(&format!("B_SPLINE_CURVE_WITH_KNOTS('',{base},{knots})")),
        Some(weights) => text.add(&format!(
            "(BOUNDED_CURVE()B_SPLINE_CURVE({base})B_SPLINE_CURVE_WITH_KNOTS({knots})CURVE()\
             GEOMETRIC_REPRESENTATION_ITEM()RATIONAL_B_SPLINE_CURVE({})REPRESENTATION_ITEM(''))",
            reals(weights.iter().copied())
        )),
    }
}
