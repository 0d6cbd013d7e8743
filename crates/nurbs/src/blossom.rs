//! The blossom (polar form) of a spline: the one tool behind Bézier extraction, knot insertion and degree elevation.

use crate::{KnotVector, MAX_ORDER, NurbsError};
use glam::DVec4;

/// The blossom of the polynomial on `span` at `arguments` (degree many, in any order).
///
/// `control` holds the p + 1 control points of the span. De Boor's algorithm with a different parameter at each
/// level (Ramshaw 1989; Piegl & Tiller, Sec. 5.1). Where all arguments lie in the span every step is a convex
/// combination, so the error is at most 2 p ulp of the largest control point.
pub(crate) fn blossom(knots: &KnotVector, span: usize, control: &[DVec4], arguments: &[f64]) -> DVec4 {
    let p = knots.degree();
    debug_assert!(control.len() == p + 1 && arguments.len() == p);
    let u = knots.knots();
    let mut d = [DVec4::ZERO; MAX_ORDER];
    d[..=p].copy_from_slice(control);
    for (r, &t) in (1..=p).zip(arguments) {
        for j in (r..=p).rev() {
            let (low, high) = (u[j + span - p], u[j + 1 + span - r]);
            let alpha = (t - low) / (high - low);
            d[j] = d[j - 1] * (1.0 - alpha) + d[j] * alpha;
        }
    }
    d[p]
}

/// The Bézier points of `span`: blossoms at (a, …, a, b, …, b), all convex.
pub(crate) fn bezier_points(knots: &KnotVector, span: usize, control: &[DVec4], [a, b]: [f64; 2]) -> Vec<DVec4> {
    let p = knots.degree();
    let u = knots.knots();
    // Between knots of full multiplicity the control points are the Bézier points.
    if u[span + 1 - p] == a && u[span + p] == b {
        return control.to_vec();
    }
    (0..=p)
        .map(|k| {
            let mut arguments = [a; MAX_ORDER];
            arguments[p - k..p].fill(b);
            blossom(knots, span, control, &arguments[..p])
        })
        .collect()
}

/// The control points of the same spline over `finer`, whose degree may be one higher.
///
/// `finer` contains every knot of `knots` at least as often (once more each, where the degree is raised) over the
/// same domain. The new point i is the blossom at the knots i+1 … i+p' of `finer`; for a raised degree it is the mean
/// of the blossoms that leave out one argument each.
pub(crate) fn reexpress(knots: &KnotVector, control: &[DVec4], finer: &KnotVector) -> Vec<DVec4> {
    let (p, q) = (knots.degree(), finer.degree());
    debug_assert!(q == p || q == p + 1);
    let (start, end) = knots.domain();
    (0..finer.control_count())
        .map(|i| {
            let arguments = &finer.knots()[i + 1..=i + q];
            // A span inside the support of the new basis function i, the one nearest to the middle argument.
            let span = support_span(knots, finer, i, start, end);
            let local = &control[span - p..=span];
            if q == p {
                return blossom(knots, span, local, arguments);
            }
            let mut rest = [0.0; MAX_ORDER];
            let mut sum = DVec4::ZERO;
            for omitted in 0..q {
                rest[..omitted].copy_from_slice(&arguments[..omitted]);
                rest[omitted..p].copy_from_slice(&arguments[omitted + 1..]);
                sum += blossom(knots, span, local, &rest[..p]);
            }
            sum / q as f64
        })
        .collect()
}

/// The part of a spline over a range of its domain, with the same parameter, clamped at both ends: its knots and control points.
///
/// The points are within 4 p ulp of the largest control point (Piegl & Tiller, Sec. 5.2, here by blossoms); a clamped spline over its
/// whole domain stays as it is. `control` holds as many homogeneous points (w x, w y, w z, w) as `knots` asks for.
///
/// # Errors
/// [`NurbsError::EmptyDomain`] where the range is empty, [`NurbsError::OutsideDomain`] where it is not in the domain.
pub fn restricted(
    knots: &KnotVector,
    control: &[DVec4],
    [start, end]: [f64; 2],
) -> Result<(KnotVector, Vec<DVec4>), NurbsError> {
    let (p, u, (first, last)) = (knots.degree(), knots.knots(), knots.domain());
    if let Some(value) = [start, end].into_iter().find(|t| !(first <= *t && *t <= last)) {
        return Err(NurbsError::OutsideDomain { value, start: first, end: last });
    }
    if [start, end] == [first, last] && knots.is_clamped() {
        return Ok((knots.clone(), control.to_vec()));
    }
    let inner = u.iter().copied().filter(|k| start < *k && *k < end);
    let ends = [start, end].map(|t| vec![t; p + 1]);
    let finer: Vec<f64> = ends[0].iter().copied().chain(inner).chain(ends[1].iter().copied()).collect();
    let finer = KnotVector::new(p, finer)?;
    let points = reexpress(knots, control, &finer);
    Ok((finer, points))
}

/// A nonempty span of `knots` inside [finer_i, finer_{i+q+1}] and the domain.
fn support_span(knots: &KnotVector, finer: &KnotVector, i: usize, start: f64, end: f64) -> usize {
    let q = finer.degree();
    let (low, high) = (finer.knots()[i].max(start), finer.knots()[i + q + 1].min(end));
    knots.find_span(low + 0.5 * (high - low))
}
