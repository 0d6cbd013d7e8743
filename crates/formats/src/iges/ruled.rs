//! Ruled surfaces (118): straight lines between corresponding places of two curves.

use super::curve::{joined, reversed, whole};
use super::entities::Entity;
use super::fault::{Fault, fault};
use super::geometry::Geometry;
use crate::brep::curve::Curve;
use crate::brep::path::Piece;
use crate::spline::Spline;
use glam::{DVec3, DVec4};
use nurbs::{Direction, KnotVector, NurbsError, Surface};

/// At how many places of the two curves it is measured how far the surface is from the file's.
const PLACES: usize = 32;

/// Samples of the first curve among which a ruling's beginning is looked for, and steps of the search beside the nearest.
const SAMPLES: usize = 16 * PLACES;
const THIRDS: usize = 60;

/// A share of the size below which nothing is said.
const SAME: f64 = 1e-6;

/// The surface, u along the curves and v across them, both from 0 to 1; and, where the two curves do not correspond as the
/// file says, how far it is off.
pub(super) fn ruled(geometry: &Geometry, entity: &Entity) -> Result<(Surface, Option<String>), Fault> {
    let own = entity.parameters();
    let number = entity.entry.number;
    let wrong = |cause: NurbsError| fault(number, cause.to_string());
    let mut pieces = [whole(geometry, own.pointer(1)?)?, whole(geometry, own.pointer(2)?)?];
    if own.flag(3)? {
        pieces[1] = reversed(&pieces[1]).ok_or_else(|| fault(number, "its second curve cannot be run backwards"))?;
    }
    let splines = pieces.each_ref().map(|piece| {
        let spline = joined(std::slice::from_ref(piece), f64::INFINITY).map_err(wrong)?.expect("any gap is allowed");
        spline.over([0.0, 1.0]).map_err(wrong)
    });
    let [first, second] = splines;
    let surface = between([first?, second?]).map_err(wrong)?;
    // Form 1 asks for equal parameters, form 0 for equal lengths: both curves as run from 0 to 1.
    let by_length = entity.entry.form == 0;
    let rows = pieces.each_ref().map(|piece| places(piece, by_length));
    let size = nurbs::Hull::of(rows.iter().flatten().copied()).diagonal();
    let off = off_rulings(&surface, &rows);
    let remark = (SAME * size < off).then(|| {
        let how = if by_length { "length" } else { "parameter" };
        format!("its curves correspond by {how} in the file, and by the parameters of splines here: rulings are up to {off:.1e} off")
    });
    Ok((surface, remark))
}

/// Places of a curve at equal steps of its parameter, or of its length.
fn places(piece: &Piece, by_length: bool) -> Vec<DVec3> {
    let at = |s: f64| piece.point(s);
    if !by_length || matches!(piece.curve, Curve::Line { .. }) {
        return (0..=PLACES).map(|k| at(k as f64 / PLACES as f64)).collect();
    }
    // Lengths by chords of short steps.
    const FINE: usize = 64;
    let fine: Vec<DVec3> = (0..=PLACES * FINE).map(|k| at(k as f64 / (PLACES * FINE) as f64)).collect();
    let mut lengths = vec![0.0];
    for pair in fine.windows(2) {
        lengths.push(lengths[lengths.len() - 1] + pair[0].distance(pair[1]));
    }
    let total = lengths[lengths.len() - 1];
    let place = |k: usize| {
        let length = total * k as f64 / PLACES as f64;
        let next = lengths.partition_point(|l| *l < length).clamp(1, fine.len() - 1);
        let (a, b) = (lengths[next - 1], lengths[next]);
        let share = if a < b { (length - a) / (b - a) } else { 0.0 };
        at((next as f64 - 1.0 + share) / (PLACES * FINE) as f64)
    };
    (0..=PLACES).map(place).collect()
}

/// How far the end of a ruling of the file is from that of the surface's ruling which begins where it does, at most.
fn off_rulings(surface: &Surface, rows: &[Vec<DVec3>; 2]) -> f64 {
    let off = |k: usize| {
        let (start, end) = (rows[0][k], rows[1][k]);
        let distance = |u: f64| surface.point(u, 0.0).distance_squared(start);
        // From the nearest sample of the first curve on, by thirds.
        let sample = |i: usize| i as f64 / SAMPLES as f64;
        let nearest = (0..=SAMPLES).min_by(|a, b| distance(sample(*a)).total_cmp(&distance(sample(*b))));
        let nearest = nearest.expect("there are some");
        let (mut low, mut high) = (sample(nearest.saturating_sub(1)), sample((nearest + 1).min(SAMPLES)));
        for _ in 0..THIRDS {
            let (a, b) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
            if distance(a) < distance(b) { high = b } else { low = a }
        }
        surface.point(0.5 * (low + high), 1.0).distance(end)
    };
    // At both ends of a closed curve the nearest place is not told from the other; they correspond in any case.
    (1..PLACES).map(off).fold(0.0, f64::max)
}

/// The surface between two curves from 0 to 1.
fn between(curves: [Spline; 2]) -> Result<Surface, NurbsError> {
    let degree = curves[0].knots().degree().max(curves[1].knots().degree());
    let [first, second] = curves;
    let [first, second] = [first.raised(degree)?, second.raised(degree)?];
    let rows = [refined(&first, &second)?, refined(&second, &first)?];
    let knots = rows[0].knots(Direction::U).clone();
    let along = KnotVector::new(1, vec![0.0, 0.0, 1.0, 1.0])?;
    // Each strip holds its curve twice, side by side.
    let point = |k: usize, side: usize| -> DVec4 {
        let weight = rows[side].weights().map_or(1.0, |w| w[2 * k]);
        rows[side].points()[2 * k].extend(weight)
    };
    let pairs: Vec<DVec4> = (0..knots.control_count()).flat_map(|k| [point(k, 0), point(k, 1)]).collect();
    let weights = pairs.iter().any(|p| p.w != 1.0).then(|| pairs.iter().map(|p| p.w).collect());
    Surface::new(knots, along, pairs.iter().map(|p| p.truncate()).collect(), weights)
}

/// A strip along a curve, with the knots of another curve, too.
fn refined(curve: &Spline, other: &Spline) -> Result<Surface, NurbsError> {
    let points: Vec<DVec3> = curve.points().iter().flat_map(|p| [p.truncate() / p.w; 2]).collect();
    let weights = curve.points().iter().flat_map(|p| [p.w; 2]).collect();
    let along = KnotVector::new(1, vec![0.0, 0.0, 1.0, 1.0])?;
    let strip = Surface::new(curve.knots().clone(), along, points, Some(weights))?;
    let mut missing = vec![];
    let theirs = other.knots();
    for k in theirs.spans() {
        let t = theirs.knots()[k];
        let count = if 0.0 < t { theirs.multiplicity(t).saturating_sub(curve.knots().multiplicity(t)) } else { 0 };
        missing.extend(std::iter::repeat_n(t, count));
    }
    strip.refined(Direction::U, &missing)
}
