//! Curves of the file as pieces of curves, each run forwards from its start to its end.

use super::conic::conic;
use super::entities::Entity;
use super::fault::{Fault, fault};
use super::geometry::{DEEPEST, Geometry, moved_frame};
use super::spline::{cubic_curve, spline_curve};
use super::value::Parameters;
use crate::brep::across::Ramp;
use crate::brep::curve::Curve;
use crate::brep::frame::{Frame, Motion};
use crate::brep::parallel::sideways;
use crate::brep::path::Piece;
use crate::spline::Spline;
use glam::{DAffine2, DVec2, DVec3};
use nurbs::{KnotVector, NurbsError, SpaceCurve};
use std::f64::consts::TAU;

/// The most pieces of one curve.
const MOST_PIECES: usize = 1 << 16;

/// Where a curve lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Space {
    Model,
    /// In the parameters of a surface, where matrices say nothing.
    Parameters,
}

/// The pieces of a curve in order: one, but several for a composite.
pub(super) fn pieces(geometry: &Geometry, number: u32, space: Space) -> Result<Vec<Piece>, Fault> {
    pieces_within(geometry, number, space, 0)
}

fn pieces_within(geometry: &Geometry, number: u32, space: Space, depth: usize) -> Result<Vec<Piece>, Fault> {
    if DEEPEST < depth {
        return Err(fault(number, "it is made of curves too deep"));
    }
    let entity = geometry.get(number)?;
    let mut pieces = if entity.entry.kind == 102 {
        let own = entity.parameters();
        let mut pieces: Vec<Piece> = vec![];
        for part in own.pointers(2, own.count(1, 1)?)? {
            // Points in a composite say nothing of where it runs.
            if geometry.entities.entry(part).is_some_and(|entry| matches!(entry.kind, 116 | 132)) {
                continue;
            }
            pieces.extend(pieces_within(geometry, part, space, depth + 1)?);
            if MOST_PIECES < pieces.len() {
                return Err(fault(number, "it has too many pieces"));
            }
        }
        pieces
    } else {
        vec![single(geometry, &entity, depth)?]
    };
    geometry.spend(number, pieces.len())?;
    if space == Space::Model && entity.entry.matrix != 0 {
        let motion = geometry.motion(entity.entry.matrix)?;
        for piece in &mut pieces {
            *piece =
                moved(piece, &motion).ok_or_else(|| fault(number, "its matrix is no rotation, and it is a conic"))?;
        }
    }
    let is_run = |piece: &Piece| piece.range[0] < piece.range[1] && piece.range.iter().all(|t| t.is_finite());
    if pieces.is_empty() || !pieces.iter().all(is_run) {
        return Err(fault(number, "it has no length"));
    }
    Ok(pieces)
}

/// A curve of one piece, without its matrix.
fn single(geometry: &Geometry, entity: &Entity, depth: usize) -> Result<Piece, Fault> {
    let own = entity.parameters();
    let number = entity.entry.number;
    let wrong = |cause: NurbsError| fault(number, cause.to_string());
    match entity.entry.kind {
        100 => {
            let v = own.numbers(1, 7)?;
            let [center, start, end] = [1, 3, 5].map(|k| DVec2::new(v[k], v[k + 1]));
            arc(center, start, end, v[0]).ok_or_else(|| fault(number, "the arc has no radius"))
        }
        104 => conic(&own.numbers(1, 11)?)
            .ok_or_else(|| fault(number, "its numbers make no ellipse, parabola or hyperbola")),
        106 => {
            let kind = own.whole(1)?;
            let each = match kind {
                1 => 2,
                2 => 3,
                3 => 6,
                _ => return Err(fault(number, "it holds no points")),
            };
            if !matches!(entity.entry.form, 1..=3 | 11..=13 | 63) {
                return Err(fault(
                    number,
                    format!("copious data of form {} are not read as a curve", entity.entry.form),
                ));
            }
            let (count, first) = if kind == 1 { (own.count(2, each)?, 4) } else { (own.count(2, each)?, 3) };
            geometry.spend(number, count)?;
            let z = if kind == 1 { own.number(3)? } else { 0.0 };
            let values = own.numbers(first, each * count)?;
            let point = |v: &[f64]| DVec3::new(v[0], v[1], if kind == 1 { z } else { v[2] });
            let mut points: Vec<DVec3> = values.chunks_exact(each).map(point).collect();
            points.dedup();
            let curve = Curve::polyline(&points, geometry.tolerance).map_err(wrong)?;
            let range = curve.domain().expect("a spline has one");
            Ok(Piece { curve, range })
        }
        110 => {
            let v = own.numbers(1, 6)?;
            let (start, end) = (DVec3::from_slice(&v), DVec3::from_slice(&v[3..]));
            match entity.entry.form {
                0 => {}
                1 => return Err(fault(number, "it is half a line (form 1), which has no end")),
                form => return Err(fault(number, format!("it is a whole line (form {form}), which has no ends"))),
            }
            Ok(Piece { curve: Curve::Line { origin: start, direction: end - start }, range: [0.0, 1.0] })
        }
        112 => cubic_curve(geometry, own),
        126 => spline_curve(geometry, own),
        130 => beside(geometry, own, depth),
        kind => Err(fault(number, format!("curves of type {kind} are not read"))),
    }
}

/// A curve (130) beside another, at a distance that is even, or changes evenly with the parameter.
fn beside(geometry: &Geometry, own: Parameters, depth: usize) -> Result<Piece, Fault> {
    let base = own.pointer(1)?;
    let Piece { curve, range: [a, b] } = whole_within(geometry, base, depth + 1)?;
    // The file counts a composite's parameter from 0, and an arc's angle from 0 to a whole turn.
    let [start, end] = [own.number(13)?, own.number(14)?];
    let shift = match curve {
        Curve::Ellipse { .. } => ((a - start) / TAU).round() * TAU,
        _ if geometry.get(base)?.entry.kind == 102 => a,
        _ => 0.0,
    };
    let slack = JOINT * (b - a);
    let [start, end] = [start, end].map(|t| own_parameter(&curve, t + shift));
    if !(a - slack <= start && start < end && end <= b + slack) {
        return Err(fault(own.number, format!("it runs from {start} to {end}, and its curve from {a} to {b}")));
    }
    let distance = own.number(6)?;
    let ramp = match (own.whole(2)?, own.whole(5)?) {
        (1, _) => Ramp::even(distance),
        (2, 2) if matches!(curve, Curve::Hyperbola { .. }) => {
            return Err(fault(own.number, "offsets that change along a hyperbola are not read"));
        }
        (2, 2) => {
            let v = own.numbers(7, 3)?;
            let [from, to] = [v[0], v[2]].map(|t| own_parameter(&curve, t + shift));
            let slope = (v[1] - distance) / (to - from);
            Ramp { start: distance - slope * from, slope }
        }
        (2, _) => return Err(fault(own.number, "offsets that change with the arc's length are not read")),
        _ => return Err(fault(own.number, "offsets by a function are not read")),
    };
    let reference = DVec3::from_slice(&own.numbers(10, 3)?);
    let curve = geometry
        .beside(own.number, sideways(&curve, reference, ramp, Some([a, b]), geometry.tolerance, geometry.effort))?;
    Ok(Piece { curve, range: [start.max(a), end.min(b)] })
}

/// The parameter of a curve at which the file's is `t`: a parabola's is the way along its tangent at the apex there, and a hyperbola is
/// (a sec t, b tan t).
fn own_parameter(curve: &Curve, t: f64) -> f64 {
    match curve {
        Curve::Parabola { focal, .. } => t / (2.0 * focal),
        Curve::Hyperbola { .. } => libm::tan(t).asinh(),
        _ => t,
    }
}

/// A circle's part from `start` to `end`, counter-clockwise; a whole one where they are the same.
fn arc(center: DVec2, start: DVec2, end: DVec2, z: f64) -> Option<Piece> {
    let radius = start.distance(center);
    let frame = Frame::new(center.extend(z), None, None)?;
    let angle = |p: DVec2| libm::atan2(p.y - center.y, p.x - center.x);
    let first = angle(start);
    let mut last = if start == end { first } else { angle(end) };
    if last <= first {
        last += TAU;
    }
    let curve = Curve::Ellipse { frame, radii: DVec2::splat(radius) };
    (0.0 < radius).then_some(Piece { curve, range: [first, last] })
}

/// A piece moved; `None` where it is a conic and the move does not keep shapes.
pub(super) fn moved(piece: &Piece, motion: &Motion) -> Option<Piece> {
    let curve = match &piece.curve {
        Curve::Line { origin, direction } => {
            Curve::Line { origin: motion.point(*origin), direction: motion.vector(*direction) }
        }
        Curve::Ellipse { frame, radii } => Curve::Ellipse { frame: moved_frame(frame, motion)?, radii: *radii },
        Curve::Parabola { frame, focal } => Curve::Parabola { frame: moved_frame(frame, motion)?, focal: *focal },
        Curve::Hyperbola { frame, radii } => Curve::Hyperbola { frame: moved_frame(frame, motion)?, radii: *radii },
        Curve::Spline { spline, is_closed } => {
            Curve::Spline { spline: with_points(spline, |p| motion.point(p))?, is_closed: *is_closed }
        }
    };
    Some(Piece { curve, range: piece.range })
}

fn with_points(spline: &SpaceCurve, map: impl Fn(DVec3) -> DVec3) -> Option<SpaceCurve> {
    let points: Vec<DVec3> = spline.points().map(map).collect();
    SpaceCurve::new(spline.knots().clone(), &points, spline.weights().as_deref()).ok()
}

/// A curve in a surface's parameters, mapped to other parameters: a conic becomes a spline of another parameter.
pub(super) fn mapped(piece: &Piece, map: &DAffine2) -> Option<Piece> {
    if *map == DAffine2::IDENTITY {
        return Some(piece.clone());
    }
    let point = |p: DVec3| map.transform_point2(p.truncate()).extend(0.0);
    match &piece.curve {
        Curve::Line { origin, direction } => {
            let direction = map.transform_vector2(direction.truncate()).extend(0.0);
            Some(Piece { curve: Curve::Line { origin: point(*origin), direction }, range: piece.range })
        }
        Curve::Spline { spline, is_closed } => {
            let spline = with_points(spline, point)?;
            Some(Piece { curve: Curve::Spline { spline, is_closed: *is_closed }, range: piece.range })
        }
        conic => {
            let [spline] = <[SpaceCurve; 1]>::try_from(conic.splines(piece.range).ok()?).ok()?;
            let range = spline.knots().domain().into();
            Some(Piece { curve: Curve::Spline { spline: with_points(&spline, point)?, is_closed: false }, range })
        }
    }
}

/// The piece run from its end to its start: a line or a spline; others become splines.
pub(super) fn reversed(piece: &Piece) -> Option<Piece> {
    if let Curve::Line { origin, direction } = piece.curve {
        let [start, end] = piece.range;
        let curve = Curve::Line { origin: origin + direction * (start + end), direction: -direction };
        return Some(Piece { curve, range: piece.range });
    }
    let spline = joined(std::slice::from_ref(piece), f64::INFINITY).ok()??;
    let [start, end]: [f64; 2] = spline.domain();
    let knots = spline.knots().knots().iter().rev().map(|k| start + end - k).collect();
    let points = spline.points().iter().rev().copied().collect();
    let spline = space_curve(&Spline::new(spline.knots().degree(), knots, points).ok()?).ok()?;
    let range = spline.knots().domain().into();
    Some(Piece { curve: Curve::Spline { spline, is_closed: false }, range })
}

/// One spline of pieces that follow each other, with their parameters put in a row; `None` where gaps are wider than
/// `tolerance`.
///
/// # Errors
/// Where a piece is no spline.
pub(super) fn joined(pieces: &[Piece], tolerance: f64) -> Result<Option<Spline>, NurbsError> {
    let mut parts: Vec<Spline> = vec![];
    for piece in pieces {
        for spline in piece.curve.splines(piece.range)? {
            let weights = spline.weights();
            let weight = |k: usize| weights.as_ref().map_or(1.0, |w| w[k]);
            let points = spline.points().enumerate().map(|(k, p)| (p * weight(k)).extend(weight(k))).collect();
            let knots = spline.knots();
            let own = Spline::new(knots.degree(), knots.knots().to_vec(), points)?;
            let [start, end] = own.domain();
            let from = parts.last().map_or(start, |last| last.domain()[1]);
            parts.push(own.over([from, from + (end - start)])?);
        }
    }
    let (whole, gap) = Spline::joined(&parts)?;
    Ok((gap <= tolerance).then_some(whole))
}

/// A spline as a curve in space.
pub(super) fn space_curve(spline: &Spline) -> Result<SpaceCurve, NurbsError> {
    let points: Vec<DVec3> = spline.points().iter().map(|p| p.truncate() / p.w).collect();
    let weights = crate::spline::weights(spline.points());
    SpaceCurve::new(
        KnotVector::new(spline.knots().degree(), spline.knots().knots().to_vec())?,
        &points,
        weights.as_deref(),
    )
}

/// Two points of a line, which may be endless.
pub(super) fn axis(geometry: &Geometry, number: u32) -> Result<[DVec3; 2], Fault> {
    let entity = geometry.get_of(number, 110, "an axis")?;
    let (own, motion) = (entity.parameters(), geometry.motion(entity.entry.matrix)?);
    let v = own.numbers(1, 6)?;
    Ok([&v[..3], &v[3..]].map(|p| motion.point(DVec3::from_slice(p))))
}

/// A curve of one piece: a composite is joined to one spline.
pub(super) fn whole(geometry: &Geometry, number: u32) -> Result<Piece, Fault> {
    whole_within(geometry, number, 0)
}

fn whole_within(geometry: &Geometry, number: u32, depth: usize) -> Result<Piece, Fault> {
    let mut pieces = pieces_within(geometry, number, Space::Model, depth)?;
    if pieces.len() == 1 {
        return Ok(pieces.remove(0));
    }
    let wrong = |cause: NurbsError| fault(number, cause.to_string());
    let ends = |piece: &Piece| [piece.point(0.0), piece.point(1.0)];
    let size = nurbs::Hull::of(pieces.iter().flat_map(ends)).diagonal();
    let spline = joined(&pieces, geometry.tolerance.max(JOINT * size)).map_err(wrong)?;
    let spline = space_curve(&spline.ok_or_else(|| fault(number, "its pieces do not meet"))?).map_err(wrong)?;
    let range = spline.knots().domain().into();
    Ok(Piece { curve: Curve::spline(spline, geometry.tolerance), range })
}

/// Pieces in (u, v) in the order in which each begins where the one before it ends. On closed surfaces some files put
/// them in another order: each then begins a period away from where the one before it ends. Where no order is right, theirs
/// stays.
pub(super) fn chained(pieces: Vec<Piece>) -> Vec<Piece> {
    let ends: Vec<[DVec3; 2]> = pieces.iter().map(|piece| [piece.point(0.0), piece.point(1.0)]).collect();
    let count = pieces.len();
    let size = nurbs::Hull::of(ends.iter().flatten().copied()).diagonal();
    let meet = |a: usize, b: usize| ends[a][1].distance(ends[b][0]) <= MEETING * size;
    if MOST_REORDERED < count || (0..count).all(|k| meet(k, (k + 1) % count)) {
        return pieces;
    }
    let mut order = vec![0];
    while order.len() < count {
        let last = order[order.len() - 1];
        match (1..count).find(|next| !order.contains(next) && meet(last, *next)) {
            Some(next) => order.push(next),
            None => return pieces,
        }
    }
    if !meet(order[count - 1], 0) {
        return pieces;
    }
    order.into_iter().map(|k| pieces[k].clone()).collect()
}

/// A share of a loop's size in (u, v): ends nearer than that meet. And the most pieces that are put in another order.
const MEETING: f64 = 1e-3;
const MOST_REORDERED: usize = 64;

/// How far pieces of a composite may be from each other beyond the file's resolution, as a share of its size.
const JOINT: f64 = 1e-6;
