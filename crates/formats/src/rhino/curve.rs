//! Curves of an archive as rational splines, and the way from their own parameter to the spline's.
//!
//! Lines, polylines and NURBS keep their parameter. An arc's own parameter is its angle; its spline has a rational quadratic a
//! quarter (Piegl & Tiller, A7.1), the parameter of which is the tangent of an angle. They agree where quarters meet.

use super::archive::{Cursor, Fault};
use super::class::{Class, Object};
use crate::spline::Spline;
use glam::{DVec3, DVec4};
use libm::{cos, sin, tan};
use nurbs::NurbsError;
use std::f64::consts::{FRAC_PI_2, TAU};

/// How deep curves may stand in curves.
const DEEPEST: usize = 16;

/// How far beyond a whole turn, or a quarter, an angle of rounded numbers may reach, radians.
const ANGLE_ROUNDING: f64 = 1e-9;

/// A span of a spline over which the file's own parameter is an angle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Turn {
    /// Where both parameters begin and end.
    pub range: [f64; 2],
    /// The angle over that, radians, at most a quarter turn.
    pub angle: f64,
}

/// A curve of the file.
#[derive(Debug, Clone)]
pub(super) struct Curve {
    pub spline: Spline,
    /// In ascending order.
    pub turns: Vec<Turn>,
}

/// The spline's parameter at the file's own.
pub(super) fn parameter(turns: &[Turn], t: f64) -> f64 {
    // A curve may run a little beyond its surface: the outermost turn goes on.
    let k = turns.partition_point(|turn| turn.range[1] < t).min(turns.len().saturating_sub(1));
    let Some(turn) = turns.get(k) else { return t };
    let [start, end] = turn.range;
    if t == start || t == end || (k > 0 && t < start) {
        return t;
    }
    // From the middle of the arc, tan(φ / 2) runs as the parameter does.
    let phi = (t - 0.5 * (start + end)) / (end - start) * turn.angle;
    0.5 * (start + end) + 0.5 * (end - start) * tan(0.5 * phi) / tan(0.25 * turn.angle)
}

/// A circular arc of radius 1 between two angles over a range of parameters: for each control point its coordinates along the two
/// axes, multiplied by the weight, and the weight; the knots; the turns.
///
/// It has one, two or four spans, as in openNURBS, so that its parameter is that of their rational form.
pub(super) fn arc([from, to]: [f64; 2], [start, end]: [f64; 2]) -> (Vec<[f64; 3]>, Vec<f64>, Vec<Turn>) {
    let quarters = (to - from) / FRAC_PI_2 - ANGLE_ROUNDING;
    let count = if quarters <= 1.0 {
        1.0
    } else if quarters <= 2.0 {
        2.0
    } else {
        4.0
    };
    let at = |k: f64| from + (to - from) * (k / count);
    let knot = |k: f64| if k == count { end } else { start + (end - start) * (k / count) };
    let half = 0.5 * (to - from) / count;
    let mut points = vec![[cos(from), sin(from), 1.0]];
    let (mut knots, mut turns) = (vec![start; 3], vec![]);
    let mut k = 0.0;
    while k < count {
        let middle = at(k + 0.5);
        // The middle point is at 1 / w from the centre.
        points.extend([[cos(middle), sin(middle), cos(half)], [cos(at(k + 1.0)), sin(at(k + 1.0)), 1.0]]);
        turns.push(Turn { range: [knot(k), knot(k + 1.0)], angle: 2.0 * half });
        k += 1.0;
        knots.extend([knot(k), knot(k)]);
    }
    knots.push(end);
    (points, knots, turns)
}

/// A range of angles of at most one turn.
pub(super) fn angles(cursor: &mut Cursor) -> Result<[f64; 2], Fault> {
    let at = cursor.at();
    let [from, to] = cursor.interval()?;
    if to - from <= TAU + ANGLE_ROUNDING && from.abs() <= 4.0 * TAU {
        return Ok([from, to]);
    }
    Err(Fault { at, text: format!("an arc runs from {from} to {to} radians") })
}

/// The knots of a spline with the two outer ones added that archives leave out, on which no point of the domain depends.
pub(super) fn knots(cursor: &mut Cursor) -> Result<Vec<f64>, Fault> {
    let count = cursor.count(8)?;
    let mut knots = Vec::with_capacity(count + 2);
    for _ in 0..count {
        knots.push(cursor.finite()?);
    }
    if let Some((first, last)) = knots.first().copied().zip(knots.last().copied()) {
        knots.insert(0, first);
        knots.push(last);
    }
    Ok(knots)
}

/// Points of `dimension` coordinates, multiplied by the weight that follows them where they are rational.
pub(super) fn points(cursor: &mut Cursor, dimension: i32, is_rational: bool) -> Result<Vec<DVec4>, Fault> {
    let coordinates = match dimension {
        2 | 3 => dimension as usize,
        _ => return cursor.fault(format!("its points have {dimension} coordinates")),
    };
    let count = cursor.count(8 * (coordinates + usize::from(is_rational)))?;
    let mut points = Vec::with_capacity(count);
    for _ in 0..count {
        let mut point = DVec4::W;
        for k in 0..coordinates {
            point[k] = cursor.finite()?;
        }
        if is_rational {
            point.w = cursor.finite()?;
        }
        points.push(point);
    }
    Ok(points)
}

/// The degree of a stated order.
pub(super) fn degree(cursor: &mut Cursor) -> Result<usize, Fault> {
    let order = cursor.i32()?;
    match usize::try_from(order) {
        Ok(order @ 2..) => Ok(order - 1),
        _ => cursor.fault(format!("its order is {order}")),
    }
}

/// What a spline says of its numbers, as a fault of the data at `at`.
pub(super) fn unfit(at: usize) -> impl Fn(NurbsError) -> Fault {
    move |cause| Fault { at, text: cause.to_string() }
}

/// The pieces of a curve: one, or those of a polycurve, which follow each other in parameter.
pub(super) fn pieces(object: &Object) -> Result<Vec<Curve>, Fault> {
    nested(object, 0)
}

fn nested(object: &Object, depth: usize) -> Result<Vec<Curve>, Fault> {
    let mut data = object.data.clone();
    let at = data.at();
    if depth == DEEPEST {
        return data.fault(format!("curves stand in curves more than {DEEPEST} deep"));
    }
    let same =
        |spline: Result<Spline, NurbsError>| Ok(vec![Curve { spline: spline.map_err(unfit(at))?, turns: vec![] }]);
    match object.class {
        Class::NurbsCurve => {
            data.packed_version(1)?;
            let (dimension, is_rational) = (data.i32()?, data.i32()? != 0);
            let degree = degree(&mut data)?;
            // The number of points, which comes again; two reserved numbers, and a box.
            data.skip(3 * 4 + 6 * 8)?;
            let knots = knots(&mut data)?;
            same(Spline::new(degree, knots, points(&mut data, dimension, is_rational)?))
        }
        Class::LineCurve => {
            data.packed_version(1)?;
            let ends = vec![data.point()?.extend(1.0), data.point()?.extend(1.0)];
            same(Spline::bezier(ends, data.interval()?))
        }
        Class::PolylineCurve => {
            data.packed_version(1)?;
            let mut vertices = vec![];
            for _ in 0..data.count(24)? {
                vertices.push(data.point()?.extend(1.0));
            }
            same(Spline::new(1, knots(&mut data)?, vertices))
        }
        Class::ArcCurve => Ok(vec![circular(&mut data)?]),
        Class::PolyCurve => polycurve(&mut data, depth),
        _ => data.fault(format!("{} is not read as a curve", object.kind())),
    }
}

fn circular(data: &mut Cursor) -> Result<Curve, Fault> {
    data.packed_version(1)?;
    let at = data.at();
    let plane = Plane::read(data)?;
    let radius = data.finite()?;
    // Three points on the circle.
    data.skip(9 * 8)?;
    let (angles, domain) = (angles(data)?, data.interval()?);
    let (unit, knots, turns) = arc(angles, domain);
    let point = |[x, y, w]: [f64; 3]| {
        // Control points are on the circle's plane at x / w, y / w; those of middles are given at distance 1.
        (plane.origin * w + (plane.x * x + plane.y * y) * radius).extend(w)
    };
    let spline = Spline::new(2, knots, unit.into_iter().map(point).collect()).map_err(unfit(at))?;
    Ok(Curve { spline, turns })
}

fn polycurve(data: &mut Cursor, depth: usize) -> Result<Vec<Curve>, Fault> {
    data.packed_version(1)?;
    let at = data.at();
    let count = data.count(1)?;
    // Two reserved numbers, and a box.
    data.skip(2 * 4 + 6 * 8)?;
    let mut ends = vec![];
    for _ in 0..data.count(8)? {
        ends.push(data.finite()?);
    }
    if count == 0 || ends.len() != count + 1 {
        return Err(Fault { at, text: format!("a polycurve of {count} segments has {} parameters", ends.len()) });
    }
    let mut pieces: Vec<Curve> = vec![];
    for range in ends.windows(2) {
        let own = nested(&Object::read(data)?, depth + 1)?;
        let [first, last] = [own[0].spline.domain()[0], own[own.len() - 1].spline.domain()[1]];
        let place = |t: f64| {
            let share = (t - first) / (last - first);
            if t == last { range[1] } else { range[0] + (range[1] - range[0]) * share }
        };
        for Curve { spline, turns } in own {
            let spline = spline.over(spline.domain().map(place)).map_err(unfit(at))?;
            let turns = turns.into_iter().map(|turn| Turn { range: turn.range.map(place), ..turn }).collect();
            pieces.push(Curve { spline, turns });
        }
    }
    Ok(pieces)
}

/// The pieces as one curve, where no gap between them is wider than `widest`, model units.
pub(super) fn joined(pieces: Vec<Curve>, widest: f64, at: usize) -> Result<Curve, Fault> {
    let (splines, turns): (Vec<Spline>, Vec<Vec<Turn>>) = pieces.into_iter().map(|c| (c.spline, c.turns)).unzip();
    if let [spline] = &splines[..] {
        return Ok(Curve { spline: spline.clone(), turns: turns.concat() });
    }
    let (spline, gap) = Spline::joined(&splines).map_err(unfit(at))?;
    if gap <= widest {
        return Ok(Curve { spline, turns: turns.concat() });
    }
    Err(Fault {
        at,
        text: format!("two segments of a polycurve are {gap:.3e} apart, above the tolerance of {widest:.3e}"),
    })
}

/// A plane's origin and its first two axes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Plane {
    pub origin: DVec3,
    pub x: DVec3,
    pub y: DVec3,
}

impl Plane {
    pub fn read(cursor: &mut Cursor) -> Result<Self, Fault> {
        let plane = Self { origin: cursor.point()?, x: cursor.point()?, y: cursor.point()? };
        // The normal, and the equation.
        cursor.skip(7 * 8)?;
        Ok(plane)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_parameter_of_an_arc_is_where_its_spline_has_that_angle() {
        let (from, to) = (0.3, 5.0);
        let (unit, knots, turns) = arc([from, to], [-2.0, 7.0]);
        assert_eq!(turns.len(), 4);
        let spline = Spline::new(2, knots, unit.iter().map(|[x, y, w]| DVec4::new(*x, *y, 0.0, *w)).collect()).unwrap();
        for k in 0..=40 {
            let share = f64::from(k) / 40.0;
            let t = parameter(&turns, -2.0 + 9.0 * share);
            let p = spline.point(t.clamp(-2.0, 7.0));
            let angle = from + (to - from) * share;
            let off = DVec3::new(cos(angle), sin(angle), 0.0).distance(p.truncate() / p.w);
            assert!(off < 1e-14, "{share}: {off}");
        }
    }

    #[test]
    fn no_turn_leaves_a_parameter_as_it_is() {
        assert_eq!(parameter(&[], 3.25), 3.25);
        let turns = [Turn { range: [1.0, 2.0], angle: 1.5 }, Turn { range: [4.0, 5.0], angle: 1.5 }];
        assert_eq!(parameter(&turns, 3.25), 3.25, "between two arcs");
        assert_eq!(parameter(&turns, 1.5), 1.5);
        assert!(parameter(&turns, 1.25) < 1.26 && parameter(&turns, 1.25) > 1.24);
    }
}
