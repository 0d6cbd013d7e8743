//! A loop in the surface's own parameters: a row of paths, each of which begins where the one before it ends.

use super::fit::{Fitted, fit};
use super::inverse::Inverter;
use super::patch::Patch;
use super::path::{Path, Use};
use super::shape::Shape;
use super::source::{Bound, FaceError, Found, Source};
use glam::{DVec2, DVec3};
use nurbs::SpaceCurve;
use scene::Trim;
use std::collections::BTreeSet;

/// A share of a period below which two parameters are one.
const SAME: f64 = 1e-9;

/// A share of the greatest coordinate within which an edge is on its surface: what a file's decimals and rounding leave.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// A part of a loop.
pub(super) struct Part<'u> {
    pub path: Path<'u>,
    edge: &'u Use,
    /// Whether the loop runs the path backwards.
    reversed: bool,
}

impl Part<'_> {
    /// Where the loop enters the part, and where it leaves it.
    pub fn ends(&self) -> [DVec2; 2] {
        let [start, end] = self.path.ends();
        if self.reversed { [end, start] } else { [start, end] }
    }

    /// How far the vertices are off where the loop enters the part, and where it leaves it, model units.
    pub fn vertices(&self) -> [f64; 2] {
        let [start, end] = self.edge.vertices;
        if self.reversed { [end, start] } else { [start, end] }
    }

    fn free(&self) -> [Option<usize>; 2] {
        let [start, end] = self.path.free;
        if self.reversed { [end, start] } else { [start, end] }
    }

    fn places(&self) -> Vec<DVec2> {
        if self.reversed { self.path.places().rev().collect() } else { self.path.places().collect() }
    }

    /// How far a trim may be from its edge by rounding alone, model units.
    fn rounding(&self, shape: &Shape) -> f64 {
        ROUNDING * self.path.uv.iter().map(|uv| shape.point(*uv).abs().max_element()).fold(0.0, f64::max)
    }

    pub fn trims(
        &self,
        source: &Source,
        inverter: &Inverter,
        patch: &Patch,
        tolerance: f64,
        found: &mut Found,
    ) -> Result<Vec<Trim>, FaceError> {
        let (mut trims, error) = match (&source.shape, self.path.given_curve(), &self.edge.space) {
            // A plane's coordinates are an affine map, under which splines stay splines.
            (Shape::Plane(frame), None, Some(space)) => {
                let map = |p: DVec3| frame.local(p).truncate() + self.path.offset;
                (plane_trims(&space.curve.splines(space.range)?, map)?, 0.0)
            }
            (_, Some(given), _) if patch.is_same() && self.path.iso.is_none() => {
                let map = |p: DVec3| p.truncate() + self.path.offset;
                (plane_trims(&given.curve.splines(given.range)?, map)?, 0.0)
            }
            _ => {
                let Fitted { trim, error } = fit(&self.path, inverter, patch, tolerance)?;
                (vec![trim], error)
            }
        };
        found.error = found.error.max(error);
        // Of an edge that the trim is, but for rounding, there is nothing to say.
        let off = if self.path.is_found() { self.path.gap.max(error) } else { error };
        if self.rounding(&source.shape) < off {
            found.followed += 1;
        }
        if self.reversed {
            trims.reverse();
        }
        for trim in &mut trims {
            trim.reversed = self.reversed;
            trim.edge = self.edge.edge;
        }
        Ok(trims)
    }
}

/// Splines in space as trims, by an affine map to (u, v).
fn plane_trims(splines: &[SpaceCurve], map: impl Fn(DVec3) -> DVec2) -> Result<Vec<Trim>, FaceError> {
    let trim =
        |spline: &SpaceCurve| Trim::new(spline.knots().clone(), spline.points().map(&map).collect(), spline.weights());
    Ok(splines.iter().map(trim).collect())
}

/// A loop in the surface's own parameters: each part begins where the one before it ends.
pub(super) struct Closed<'u> {
    pub parts: Vec<Part<'u>>,
    pub outer: bool,
    /// How often it goes around in u and in v.
    pub turns: [f64; 2],
}

impl<'u> Closed<'u> {
    pub fn new(
        source: &'u Source,
        bound: &'u Bound,
        inverter: &Inverter,
        tolerance: f64,
        found: &mut Found,
    ) -> Result<Self, FaceError> {
        let shape = &source.shape;
        let mut parts: Vec<Part<'u>> = vec![];
        for edge in &bound.uses {
            let mut path = match (&edge.plane, &edge.space) {
                (Some(plane), space) => {
                    let mut given = Path::given(shape, plane, space.as_ref());
                    let enough = source.tolerance.max(tolerance);
                    if let Some(space) = space.as_ref().filter(|_| enough < given.gap) {
                        given.measure(shape, space, enough);
                    }
                    let better = space.as_ref().filter(|_| enough < given.gap);
                    let better = better.map(|space| Path::found(shape, inverter, space, tolerance));
                    better.filter(|path| path.gap < 0.5 * given.gap).unwrap_or(given)
                }
                (None, Some(space)) => Path::found(shape, inverter, space, tolerance),
                (None, None) => return Err(FaceError::NoCurve),
            };
            if !path.is_found() {
                path.find_poles(shape, inverter, tolerance);
            }
            found.gap = found.gap.max(path.gap);
            path.straighten(shape, tolerance);
            parts.push(Part { path, edge, reversed: edge.reversed == source.same_sense });
        }
        // With the face's own orientation removed, material is on the left.
        if !source.same_sense {
            parts.reverse();
        }
        let periods = shape.periods();
        for k in 1..parts.len() {
            let (before, after) = parts.split_at_mut(k);
            let (before, after) = (&before[k - 1], &mut after[0]);
            after.path.offset += offset(&periods, before, after);
        }
        let [first, last] = [&parts[0], &parts[parts.len() - 1]];
        let apart = last.ends()[1] - first.ends()[0];
        let at_pole = last.free()[1].filter(|_| last.free()[1] == first.free()[0]);
        let turns = [0, 1].map(|axis| match periods[axis] {
            Some(period) if at_pole != Some(axis) => (apart[axis] / period).round(),
            _ => 0.0,
        });
        Ok(Self { parts, outer: bound.outer, turns })
    }

    fn places(&self) -> impl Iterator<Item = DVec2> + '_ {
        self.parts.iter().flat_map(Part::places)
    }

    /// The least and the greatest value of a parameter.
    pub fn extent(&self, axis: usize) -> [f64; 2] {
        let widen = |[low, high]: [f64; 2], uv: DVec2| [low.min(uv[axis]), high.max(uv[axis])];
        self.places().fold([f64::INFINITY, f64::NEG_INFINITY], widen)
    }

    /// The signed area of the loop by its samples, where it goes around nothing: positive counter-clockwise.
    pub fn area(&self) -> f64 {
        if self.turns != [0.0; 2] {
            return 0.0;
        }
        let places: Vec<DVec2> = self.places().collect();
        let about = places[0];
        let next = |i: usize| places[(i + 1) % places.len()] - about;
        0.5 * (0..places.len()).map(|i| (places[i] - about).perp_dot(next(i))).sum::<f64>()
    }

    /// Whether the loop runs along an edge twice: the face is on both sides of it, and within the loop.
    pub fn has_seam(&self) -> bool {
        let mut edges = BTreeSet::new();
        self.parts.iter().filter_map(|part| part.edge.edge).any(|edge| !edges.insert(edge))
    }

    pub fn shift(&mut self, offset: DVec2) {
        self.parts.iter_mut().for_each(|part| part.path.offset += offset);
    }

    /// The values of a parameter that is constant along a part.
    pub fn straight(&self, axis: usize) -> impl Iterator<Item = f64> + '_ {
        let iso = move |part: &Part| {
            let (_, value) = part.path.iso.filter(|(iso, _)| *iso == axis)?;
            Some(value + part.path.offset[axis])
        };
        self.parts.iter().filter_map(iso)
    }
}

/// The whole periods by which `after` is moved to begin where `before` ends.
///
/// At a pole the parameter that turns about it is free, and the loop goes on along the collapsed side with material on its
/// left: toward lower u at the greatest v, toward greater u at the least; and as u and v exchange places, the other way.
fn offset(periods: &[Option<f64>; 2], before: &Part, after: &Part) -> DVec2 {
    let (from, to) = (before.ends()[1], after.ends()[0]);
    let mut offset = DVec2::ZERO;
    for axis in [0, 1] {
        let Some(period) = periods[axis] else { continue };
        let jump = to[axis] - from[axis];
        offset[axis] = -(jump / period).round() * period;
        let is_pole = before.free()[1] == Some(axis) && after.free()[0] == Some(axis);
        if is_pole {
            let other = 1 - axis;
            let inside = before.places()[before.path.uv.len() / 2][other];
            let is_greatest = inside < from[other];
            let falls = is_greatest == (axis == 0);
            let (jump, slack) = (jump + offset[axis], SAME * period);
            if falls && -slack < jump {
                offset[axis] -= period;
            } else if !falls && jump < slack {
                offset[axis] += period;
            }
        }
    }
    offset
}
