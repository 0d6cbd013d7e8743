//! Trims as curves in space, with the trim's own parameter: exactly where that is a spline, else within a distance.
//!
//! Exact, to rounding, are all trims of a surface that is an affine map, and straight trims along a parameter. Others are
//! interpolated by quintics at Lobatto's nodes, halved until they keep to the distance where it is measured between nodes.

use glam::{DVec2, DVec3};
use nurbs::{
    Curve, Direction, Halving, KnotVector, NurbsError, QUINTIC, Quintics, SpaceCurve, Surface, basis_derivatives,
    quintics,
};
use scene::{Trim, closed};

/// Halvings of a span of the trim before it is taken as it is.
const HALVINGS: u32 = 14;

/// A surface's four points span a parallelogram where the fourth is within this share of their box of it.
const PARALLELOGRAM: f64 = 4.0 * f64::EPSILON;

/// A surface, with what lies beyond a seam of it.
pub(super) struct Sheet<'m> {
    pub surface: &'m Surface,
    closed: [bool; 2],
}

impl<'m> Sheet<'m> {
    pub fn new(surface: &'m Surface) -> Self {
        Self { surface, closed: closed(surface) }
    }

    /// The parameters in the domain: by whole periods across a seam, else by the nearest end.
    fn inside(&self, mut uv: DVec2) -> DVec2 {
        for (axis, [low, high]) in self.surface.domain().into_iter().enumerate() {
            if !(low <= uv[axis] && uv[axis] <= high) {
                uv[axis] = match self.closed[axis] {
                    true => low + (uv[axis] - low).rem_euclid(high - low),
                    false => uv[axis].clamp(low, high),
                };
            }
        }
        uv
    }

    /// The surface's point.
    pub fn point(&self, uv: DVec2) -> DVec3 {
        let uv = self.inside(uv);
        self.surface.point(uv.x, uv.y)
    }
}

/// A trim in space.
pub(super) struct InSpace {
    pub curve: SpaceCurve,
    /// How far it was measured to be from the trim's own points, model units; 0 where it is exact.
    pub error: f64,
}

/// The curve in space of a trim, within `tolerance` in model units.
///
/// # Errors
/// Where numbers are not usable.
pub(super) fn in_space(sheet: &Sheet, trim: &Trim, tolerance: f64) -> Result<InSpace, NurbsError> {
    let exact = match is_affine(sheet.surface) {
        true => {
            let points: Vec<DVec3> = trim.points.iter().map(|p| sheet.surface.point(p.x, p.y)).collect();
            Some(SpaceCurve::new(trim.knots.clone(), &points, trim.weights.as_deref())?)
        }
        false => iso_line(sheet, trim)?,
    };
    match exact {
        Some(curve) => Ok(InSpace { curve, error: 0.0 }),
        None => fitted(sheet, trim, tolerance),
    }
}

/// Whether the surface is an affine map of its parameters: a parallelogram.
fn is_affine(surface: &Surface) -> bool {
    let (points, weights) = (surface.points(), surface.weights().unwrap_or_default());
    surface.degree() == [1, 1] && points.len() == 4 && weights.iter().all(|w| *w == weights[0]) && {
        let size = points.iter().fold(0.0, |size: f64, p| size.max(p.abs().max_element()));
        (points[0] - points[1] - points[2] + points[3]).abs().max_element() <= PARALLELOGRAM * size
    }
}

/// The part of the surface's own line that a straight trim along a parameter runs; `None` for any other.
fn iso_line(sheet: &Sheet, trim: &Trim) -> Result<Option<SpaceCurve>, NurbsError> {
    let [start, end] = match trim.points[..] {
        [start, end] if trim.knots.degree() == 1 && trim.weights.is_none() => [start, end],
        _ => return Ok(None),
    };
    let Some(axis) = [0, 1].into_iter().find(|axis| start[*axis] == end[*axis]) else { return Ok(None) };
    let (along, at) = (1 - axis, sheet.inside(start)[axis]);
    let (low, high) = (start[along].min(end[along]), start[along].max(end[along]));
    let [first, last] = sheet.surface.domain()[along];
    if !(first <= low && low < high && high <= last) {
        return Ok(None);
    }
    let whole = line(sheet.surface, axis, at)?.restricted([low, high])?;
    let (a, b) = trim.knots.domain();
    let is_backward = end[along] < start[along];
    let share = |t: f64| if is_backward { (high - t) / (high - low) } else { (t - low) / (high - low) };
    let mut knots: Vec<f64> =
        whole.knots().knots().iter().map(|t| if share(*t) == 1.0 { b } else { a + (b - a) * share(*t) }).collect();
    let mut points: Vec<DVec3> = whole.points().collect();
    let mut weights = whole.weights();
    if is_backward {
        knots.reverse();
        points.reverse();
        weights.iter_mut().for_each(|weights| weights.reverse());
    }
    // Knots that are one in the trim's parameter are none of a curve.
    let Ok(knots) = KnotVector::new(whole.knots().degree(), knots) else { return Ok(None) };
    SpaceCurve::new(knots, &points, weights.as_deref()).map(Some)
}

/// The surface's line at parameter `at` of `axis`, over its whole domain (Piegl & Tiller, Sec. 3.3).
fn line(surface: &Surface, axis: usize, at: f64) -> Result<SpaceCurve, NurbsError> {
    let directions = [Direction::U, Direction::V];
    let (across, along) = (surface.knots(directions[axis]), surface.knots(directions[1 - axis]));
    let (span, p) = (across.find_span(at), across.degree());
    let basis = basis_derivatives(across, span, at, 0).swap_remove(0);
    let columns = surface.control_counts()[1];
    let (mut points, mut weights) = (vec![], vec![]);
    for j in 0..along.control_count() {
        let mut sum = [0.0; 4];
        for i in 0..=p {
            let [row, column] = if axis == 0 { [span - p + i, j] } else { [j, span - p + i] };
            let control = surface.homogeneous()[row * columns + column];
            (0..4).for_each(|k| sum[k] += basis[i] * control[k]);
        }
        points.push(surface.origin() + DVec3::new(sum[0], sum[1], sum[2]) / sum[3]);
        weights.push(sum[3]);
    }
    let weights = surface.weights().map(|_| weights);
    SpaceCurve::new(along.clone(), &points, weights.as_deref())
}

fn fitted(sheet: &Sheet, trim: &Trim, tolerance: f64) -> Result<InSpace, NurbsError> {
    let curve = Curve::new(trim.knots.clone(), &trim.points, trim.weights.as_deref())?;
    let at = |t: f64| sheet.point(curve.point(t));
    let end = trim.knots.domain().1;
    let own = trim.knots.knots();
    let breaks: Vec<f64> = trim.knots.spans().map(|k| own[k]).chain([end]).collect();
    let halving = Halving { tolerance, depth: HALVINGS, parts: usize::MAX };
    let Quintics { knots, points, error } = quintics(&breaks, at, DVec3::distance, halving);
    Ok(InSpace { curve: SpaceCurve::new(KnotVector::new(QUINTIC, knots)?, &points, None)?, error })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The teapot's handle is bicubic: a slanted trim on it is no spline of low degree, one along a parameter is a cubic.
    #[test]
    fn a_trim_in_space_has_the_trims_own_points() {
        let model = models::builtin("teapot").expect("built in");
        let sheet = Sheet::new(&model.surfaces()[9]);
        let line = |a: [f64; 2], b: [f64; 2]| {
            let knots = KnotVector::new(1, vec![2.0, 2.0, 5.0, 5.0]).expect("two points");
            Trim::new(knots, vec![DVec2::from_array(a), DVec2::from_array(b)], None)
        };
        for (trim, is_exact) in [
            (line([0.25, 0.1], [0.25, 0.9]), true),
            (line([0.9, 0.5], [0.2, 0.5]), true),
            (line([0.0, 1.0], [1.0, 1.0]), true),
            (line([0.1, 0.2], [0.9, 0.7]), false),
        ] {
            let found = in_space(&sheet, &trim, 1e-9).expect("usable");
            assert_eq!(found.error == 0.0, is_exact);
            assert_eq!(found.curve.knots().domain(), (2.0, 5.0));
            for k in 0..=30 {
                let t = 2.0 + 0.1 * f64::from(k);
                let expected = sheet.point(trim.points[0].lerp(trim.points[1], (t - 2.0) / 3.0));
                let distance = found.curve.first_derivative(t)[0].distance(expected);
                assert!(distance < if is_exact { 1e-14 } else { 2e-9 }, "{t}: {distance:e}");
            }
        }
    }
}
