//! A face of a file as a face of a scene: loops put together in the surface's own parameters, the part of the surface
//! that they need as a spline, and trims on it.

use super::fit::{Fitted, fit};
use super::patch::Patch;
use super::path::{Path, Use};
use super::shape::{Inverter, Shape};
use glam::DVec2;
use nurbs::{NurbsError, SpaceCurve, Surface};
use scene::{Face, Loop, Trim};

/// A trim is fitted to this share of the file's tolerance, and not coarser or finer than these shares of the face's size.
const FIT: f64 = 0.01;
const COARSEST_FIT: f64 = 1e-8;
const FINEST_FIT: f64 = 1e-10;

/// Room beside loops that do not run along the side of a patch, as a share of their extent.
const ROOM: f64 = 1.0 / 16.0;

/// A share of a period below which two parameters are one.
const SAME: f64 = 1e-9;

/// A face as a reader found it.
#[derive(Debug)]
pub(crate) struct Source {
    pub shape: Shape,
    /// Whether the face's normal is that of its surface, S_u × S_v.
    pub same_sense: bool,
    /// Its loops, with material on the left of each as seen from the face's normal; none for the whole surface.
    pub bounds: Vec<Bound>,
    /// The file's tolerance, model units.
    pub tolerance: f64,
}

/// A loop as a reader found it.
#[derive(Debug)]
pub(crate) struct Bound {
    /// Whether the file calls it the outer one.
    pub outer: bool,
    /// Its edges in order; none for a loop that is a single point.
    pub uses: Vec<Use>,
}

/// A face of a scene, with its surface.
#[derive(Debug, Clone)]
pub(crate) struct Made {
    pub surface: Surface,
    /// Its `surface` is 0.
    pub face: Face,
    pub found: Found,
}

/// What was found by approximation.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Found {
    /// Edges that the file does not give in (u, v), or not on the surface.
    pub projected: usize,
    /// How far any trim was measured to be from its path, model units.
    pub error: f64,
    /// How far any edge was measured to be from the surface, model units.
    pub gap: f64,
}

/// Why no face can be made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub(crate) enum FaceError {
    #[error("{0}")]
    Nurbs(#[from] NurbsError),
    #[error("an edge has no curve")]
    NoCurve,
    #[error("its loops do not bound the surface, which is endless in {0}")]
    Endless(char),
    #[error("an edge is {gap:.3e} from the surface, above {most:.3e}")]
    OffSurface { gap: f64, most: f64 },
    #[error("an edge has a point without finite parameters on the surface")]
    NotFinite,
}

/// Edges farther from their surface than this many tolerances, and than this share of the face's size, are not its own.
const OFF_TOLERANCES: f64 = 100.0;
const OFF_SHARE: f64 = 0.01;

/// Puts a face together.
///
/// # Errors
/// Where an edge is not on the surface, where the surface is endless and the loops do not bound it, and where numbers
/// are not usable.
pub(crate) fn make(source: &Source) -> Result<Made, FaceError> {
    let size = size(source);
    let tolerance = (FIT * source.tolerance).clamp(FINEST_FIT * size, COARSEST_FIT * size);
    let inverter = Inverter::new(&source.shape, size);
    let mut found = Found::default();
    let mut loops = vec![];
    for bound in source.bounds.iter().filter(|bound| !bound.uses.is_empty()) {
        loops.push(Closed::new(source, bound, &inverter, tolerance, &mut found)?);
    }
    let most = (OFF_TOLERANCES * source.tolerance).max(OFF_SHARE * size);
    if most < found.gap {
        return Err(FaceError::OffSurface { gap: found.gap, most });
    }
    if !loops.iter().flat_map(|l| &l.parts).all(|part| part.path.uv.iter().all(|uv| uv.is_finite())) {
        return Err(FaceError::NotFinite);
    }
    let rectangle = rectangle(&source.shape, &mut loops)?;
    let patch = Patch::new(&source.shape, rectangle)?;
    let named = source.bounds.iter().filter(|bound| bound.outer).count();
    let greatest = loops.iter().map(|l| l.area().abs()).fold(0.0, f64::max);
    let mut bounds = vec![];
    for closed in &loops {
        // Where none is named, or several are, the direction says it; the greatest is never a hole of a surface that ends.
        let by_area = 0.0 < closed.area() || (closed.area().abs() == greatest && source.shape.periods() == [None; 2]);
        let outer = if named == 1 { closed.outer } else { by_area };
        let mut trims = vec![];
        for part in &closed.parts {
            trims.extend(part.trims(source, &inverter, &patch, tolerance, &mut found)?);
        }
        bounds.push(Loop { outer, trims });
    }
    let face = Face { surface: 0, reversed: !source.same_sense, tolerance: source.tolerance, loops: bounds };
    Ok(Made { surface: patch.surface, face, found })
}

/// The diagonal of the box of the face's edges, or of its surface.
fn size(source: &Source) -> f64 {
    let pieces = source.bounds.iter().flat_map(|bound| &bound.uses).filter_map(|u| u.space.as_ref());
    let edges = nurbs::Hull::of(pieces.flat_map(|piece| (0..=8).map(|k| piece.point(f64::from(k) / 8.0))));
    let of_surface = match &source.shape {
        Shape::Spline { surface, .. } => surface.hull().diagonal(),
        shape => {
            let corner = |uv: [f64; 2]| shape.point(DVec2::from_array(uv.map(|t| if t.is_finite() { t } else { 0.0 })));
            let [[u0, u1], [v0, v1]] = shape.natural();
            let middle = 0.5 * (u0 + u1);
            nurbs::Hull::of([[u0, v0], [u1, v1], [middle, v0], [middle, v1]].map(corner)).diagonal()
        }
    };
    let of_edges = if edges.min.is_finite() { edges.diagonal() } else { 0.0 };
    of_edges.max(of_surface).max(f64::MIN_POSITIVE)
}

/// A part of a loop.
struct Part<'u> {
    path: Path<'u>,
    edge: &'u Use,
    /// Whether the loop runs the path backwards.
    reversed: bool,
}

impl Part<'_> {
    /// Where the loop enters the part, and where it leaves it.
    fn ends(&self) -> [DVec2; 2] {
        let [start, end] = self.path.ends();
        if self.reversed { [end, start] } else { [start, end] }
    }

    fn free(&self) -> [Option<usize>; 2] {
        let [start, end] = self.path.free;
        if self.reversed { [end, start] } else { [start, end] }
    }

    fn places(&self) -> Vec<DVec2> {
        if self.reversed { self.path.places().rev().collect() } else { self.path.places().collect() }
    }

    fn trims(
        &self,
        source: &Source,
        inverter: &Inverter,
        patch: &Patch,
        tolerance: f64,
        found: &mut Found,
    ) -> Result<Vec<Trim>, FaceError> {
        let mut trims = match (&source.shape, self.path.given_curve(), &self.edge.space) {
            // A plane's coordinates are an affine map, under which splines stay splines.
            (Shape::Plane(frame), None, Some(space)) => {
                plane_trims(&space.curve.splines(space.range)?, |p| frame.local(p).truncate() + self.path.offset)?
            }
            (_, Some(given), _) if patch.is_same() && self.path.iso.is_none() => {
                plane_trims(&given.curve.splines(given.range)?, |p| p.truncate() + self.path.offset)?
            }
            _ => {
                let Fitted { trim, error } = fit(&self.path, inverter, patch, tolerance)?;
                found.error = found.error.max(error);
                vec![trim]
            }
        };
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
fn plane_trims(splines: &[SpaceCurve], map: impl Fn(glam::DVec3) -> DVec2) -> Result<Vec<Trim>, FaceError> {
    let trim =
        |spline: &SpaceCurve| Trim::new(spline.knots().clone(), spline.points().map(&map).collect(), spline.weights());
    Ok(splines.iter().map(trim).collect())
}

/// A loop in the surface's own parameters: each part begins where the one before it ends.
struct Closed<'u> {
    parts: Vec<Part<'u>>,
    outer: bool,
    /// How often it goes around in u and in v.
    turns: [f64; 2],
}

impl<'u> Closed<'u> {
    fn new(
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
                    let given = Path::given(shape, plane, space.as_ref());
                    let better = space.as_ref().filter(|_| source.tolerance.max(COARSEST_FIT * tolerance) < given.gap);
                    let better = better.map(|space| Path::found(shape, inverter, space, tolerance));
                    better.filter(|path| path.gap < 0.5 * given.gap).unwrap_or(given)
                }
                (None, Some(space)) => Path::found(shape, inverter, space, tolerance),
                (None, None) => return Err(FaceError::NoCurve),
            };
            if path.is_found() {
                found.projected += 1;
            } else {
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
    fn extent(&self, axis: usize) -> [f64; 2] {
        let widen = |[low, high]: [f64; 2], uv: DVec2| [low.min(uv[axis]), high.max(uv[axis])];
        self.places().fold([f64::INFINITY, f64::NEG_INFINITY], widen)
    }

    /// The signed area of the loop by its samples, where it goes around nothing: positive counter-clockwise.
    fn area(&self) -> f64 {
        if self.turns != [0.0; 2] {
            return 0.0;
        }
        let places: Vec<DVec2> = self.places().collect();
        let about = places[0];
        let next = |i: usize| places[(i + 1) % places.len()] - about;
        0.5 * (0..places.len()).map(|i| (places[i] - about).perp_dot(next(i))).sum::<f64>()
    }

    fn shift(&mut self, offset: DVec2) {
        self.parts.iter_mut().for_each(|part| part.path.offset += offset);
    }

    /// The values of a parameter that is constant along a part.
    fn straight(&self, axis: usize) -> impl Iterator<Item = f64> + '_ {
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

/// The rectangle of the surface's parameters that a patch has to cover; loops are moved into it by whole periods.
fn rectangle(shape: &Shape, loops: &mut [Closed]) -> Result<[[f64; 2]; 2], FaceError> {
    let mut rectangle = shape.natural();
    let periods = shape.periods();
    let is_spline = matches!(shape, Shape::Spline { .. });
    // A closed surface with holes alone goes on around.
    let greatest = loops.iter().max_by(|a, b| a.area().abs().total_cmp(&b.area().abs()));
    let is_around = loops.iter().all(|l| l.turns == [0.0; 2]) && greatest.is_none_or(|l| l.area() < 0.0);
    for axis in [0, 1] {
        let natural = rectangle[axis];
        if is_spline {
            // Each to where its middle is inside.
            if let Some(period) = periods[axis] {
                for closed in loops.iter_mut() {
                    let [low, high] = closed.extent(axis);
                    let mut by = DVec2::ZERO;
                    by[axis] = -((0.5 * (low + high) - natural[0]) / period).floor() * period;
                    closed.shift(by);
                }
            }
            continue;
        }
        rectangle[axis] = match periods[axis] {
            Some(period) => closed_range(axis, period, natural, is_around, loops),
            None => open_range(axis, natural, shape.apex().filter(|_| axis == 1), is_around, loops),
        };
        if !(rectangle[axis][0].is_finite() && rectangle[axis][1].is_finite()) {
            return Err(FaceError::Endless(['u', 'v'][axis]));
        }
    }
    Ok(rectangle)
}

/// The range of a parameter in which the surface is closed.
fn closed_range(axis: usize, period: f64, natural: [f64; 2], is_around: bool, loops: &mut [Closed]) -> [f64; 2] {
    let other = 1 - axis;
    let ring = loops.iter().position(|l| l.turns[axis] != 0.0);
    if loops.is_empty() || (is_around && ring.is_none()) {
        return [natural[0], natural[0] + period];
    }
    let across: Vec<usize> = (0..loops.len()).filter(|i| loops[*i].turns[other] != 0.0).collect();
    // The loop that is largest along the parameter comes first, the others follow into the period that it begins.
    let length = |l: &Closed| {
        let [low, high] = l.extent(axis);
        high - low
    };
    let first = ring.unwrap_or_else(|| {
        (0..loops.len()).max_by(|a, b| length(&loops[*a]).total_cmp(&length(&loops[*b]))).expect("there is one")
    });
    let start = match ring {
        Some(ring) => loops[ring].parts[0].ends()[0][axis],
        None => loops[first].extent(axis)[0],
    };
    for i in 0..loops.len() {
        let [low, high] = loops[i].extent(axis);
        let mut by = DVec2::ZERO;
        by[axis] = -((0.5 * (low + high) - start) / period + SAME).floor() * period;
        if i != first {
            loops[i].shift(by);
        }
    }
    if ring.is_some() {
        return [start, start + period];
    }
    if !across.is_empty() {
        // Rings the other way around: between a lower one with material above it and the next there is a band.
        for _ in 0..across.len() {
            let lowest =
                across.iter().copied().min_by(|a, b| loops[*a].extent(axis)[0].total_cmp(&loops[*b].extent(axis)[0]));
            let Some(lowest) = lowest.filter(|i| !material_above(axis, &loops[*i])) else { break };
            let mut by = DVec2::ZERO;
            by[axis] = period;
            loops[lowest].shift(by);
        }
        if across.len() % 2 == 1 {
            return [start, start + period];
        }
    }
    let [low, high] = with_room(axis, loops);
    if period * (1.0 - SAME) <= high - low {
        let least = loops.iter().map(|l| l.extent(axis)[0]).fold(f64::INFINITY, f64::min);
        return [least, least + period];
    }
    [low, high]
}

/// The range of a parameter that is not closed; at `apex` the surface is a point.
fn open_range(axis: usize, natural: [f64; 2], apex: Option<f64>, is_around: bool, loops: &[Closed]) -> [f64; 2] {
    if loops.is_empty() || is_around {
        return natural;
    }
    let [mut low, mut high] = with_room(axis, loops);
    let rings: Vec<&Closed> = loops.iter().filter(|l| l.turns[1 - axis] != 0.0).collect();
    let by = |a: &&&Closed, b: &&&Closed| a.extent(axis)[0].total_cmp(&b.extent(axis)[0]);
    if let Some(lowest) = rings.iter().min_by(by).filter(|ring| !material_above(axis, ring)) {
        let end = apex.filter(|apex| *apex <= lowest.extent(axis)[0]);
        low = end.unwrap_or(natural[0]);
    }
    if let Some(highest) = rings.iter().max_by(by).filter(|ring| material_above(axis, ring)) {
        let end = apex.filter(|apex| highest.extent(axis)[1] <= *apex);
        high = end.unwrap_or(natural[1]);
    }
    // A cone ends at its apex, though there be room beyond.
    if let Some(apex) = apex {
        let middle = loops
            .iter()
            .map(|l| l.extent(axis))
            .fold([f64::INFINITY, f64::NEG_INFINITY], |a, b| [a[0].min(b[0]), a[1].max(b[1])]);
        let middle = 0.5 * (middle[0] + middle[1]);
        if apex < middle { low = low.max(apex) } else { high = high.min(apex) }
    }
    [low.max(natural[0]), high.min(natural[1])]
}

/// Whether a ring has material where `axis`, the parameter across it, is greater: on its left.
fn material_above(axis: usize, ring: &Closed) -> bool {
    (0.0 < ring.turns[1 - axis]) == (axis == 1)
}

/// The extent of all loops, with room beside it where no part runs straight along its side.
fn with_room(axis: usize, loops: &[Closed]) -> [f64; 2] {
    let extents = loops.iter().map(|l| l.extent(axis));
    let [low, high] = extents.fold([f64::INFINITY, f64::NEG_INFINITY], |a, b| [a[0].min(b[0]), a[1].max(b[1])]);
    let slack = SAME * (high - low).max(SAME * low.abs().max(high.abs()));
    let straight = |side: f64| loops.iter().flat_map(|l| l.straight(axis)).find(|value| (value - side).abs() <= slack);
    let room = ROOM * (high - low);
    [straight(low).unwrap_or(low - room), straight(high).unwrap_or(high + room)]
}
