//! A spline surface at a distance from another along S_u × S_v, as a net of biquintic patches.
//!
//! Each patch has the offset's own points at Lobatto's nodes in both directions, so that neighbours have one border. It is
//! measured between the nodes, and then bounded ([`bound`]). Rows or columns of patches that are too far off are halved, each along its
//! whole length.
//!
//! [`bound`]: super::bound

use super::bound::patch_bound;
use super::effort::{BOUND, Effort};
use super::off::{Interpolated, nearest};
use super::parallel::{Offset, OffsetError};
use glam::DVec3;
use nurbs::{BezierPatch, Direction, KnotVector, NODES, QUINTIC, Quintic, Surface, between_nodes};

/// Halvings of one row or column.
const HALVINGS: u32 = 8;

/// The most patches that halving makes.
const MOST_PATCHES: usize = 1 << 11;

/// How many boxes of parameters are tried in the search for a bound: so many, and more for each patch.
const BOXES: usize = 1 << 12;
const BOXES_A_PATCH: usize = 4;

/// A part of a direction within one span of the surface.
#[derive(Debug, Clone, Copy)]
struct Part {
    range: [f64; 2],
    span: usize,
    /// How far patches on it were found to be off along the direction.
    off: f64,
}

impl Part {
    fn of(surface: &Surface, direction: Direction) -> Vec<Self> {
        let knots = surface.knots(direction);
        let part =
            |span: usize| Self { range: knots.knots()[span..=span + 1].try_into().expect("two"), span, off: 0.0 };
        knots.spans().map(part).collect()
    }

    /// The parameter at `x` of 0 to 1.
    fn at(&self, x: f64) -> f64 {
        let [a, b] = self.range;
        if x == 1.0 { b } else { a + (b - a) * x }
    }

    /// Both halves; itself where there is no number between its ends.
    fn halved(self) -> impl Iterator<Item = Self> {
        let [a, b] = self.range;
        let middle = 0.5 * (a + b);
        let halves = if a < middle && middle < b { vec![[a, middle], [middle, b]] } else { vec![self.range] };
        halves.into_iter().map(move |range| Self { range, ..self })
    }
}

/// The surface at `distance`, within `aim`, model units, or as near as halving comes, within `most`.
///
/// # Errors
/// [`OffsetError::NoNormal`], [`OffsetError::Rough`], [`OffsetError::Costly`], and where points are too far off to be a surface.
pub(super) fn net(
    surface: &Surface,
    distance: f64,
    [aim, most]: [f64; 2],
    effort: &Effort,
) -> Result<Offset<Surface>, OffsetError> {
    let (made, off) = nearest(most, |share| interpolated(surface, distance, [share * aim, most], effort))?;
    Ok(Offset { made, off })
}

fn interpolated(
    surface: &Surface,
    distance: f64,
    [aim, most]: [f64; 2],
    effort: &Effort,
) -> Result<Interpolated<Surface>, OffsetError> {
    let mut parts = [Direction::U, Direction::V].map(|direction| Part::of(surface, direction));
    let place = |u: &Part, v: &Part, x: f64, y: f64| {
        effort.spend(1)?;
        let (u_at, v_at) = (u.at(x), v.at(y));
        let at = surface.inspect_on(u.span, v.span, u_at, v_at);
        let normal = at.normal.unit().ok_or(OffsetError::NoNormal(u_at, v_at))?;
        Ok::<DVec3, OffsetError>(at.derivatives.s + normal * distance)
    };
    for halving in 0..=HALVINGS {
        let count = parts[0].len() * parts[1].len();
        let nodes = nodes(&parts, place)?;
        let mut off = 0.0f64;
        let [us, vs] = &mut parts;
        us.iter_mut().chain(vs.iter_mut()).for_each(|part| part.off = 0.0);
        for k in 0..us.len() {
            for l in 0..vs.len() {
                let own = measured(&nodes, [k, l], |x, y| place(&us[k], &vs[l], x, y))?;
                us[k].off = us[k].off.max(own[0]);
                vs[l].off = vs[l].off.max(own[1]);
                off = own.into_iter().fold(off, f64::max);
            }
        }
        // Where neither direction alone is off, both together are.
        let limit = 0.25 * aim;
        let is_any = us.iter().chain(&*vs).any(|part| limit < part.off);
        let halve = |parts: &[Part]| -> Vec<Part> {
            let own = |part: &Part| if is_any && part.off <= limit { vec![*part] } else { part.halved().collect() };
            parts.iter().flat_map(own).collect()
        };
        let finer = [halve(us), halve(vs)];
        let is_finer = count < finer[0].len() * finer[1].len();
        let is_last = halving == HALVINGS || !is_finer || MOST_PATCHES < finer[0].len() * finer[1].len();
        if off <= if is_last { most } else { aim } {
            let mut boxes = BOXES + BOXES_A_PATCH * count;
            let (all, bound) = (boxes, bound(surface, &parts, distance, most, &mut boxes));
            effort.spend(BOUND * (all - boxes))?;
            let made = patches(&parts, &nodes)?;
            return Ok(Interpolated { made, measured: off, bound });
        }
        if is_last {
            return Err(OffsetError::Rough { off, tolerance: most });
        }
        parts = finer;
    }
    unreachable!("the last halving returns")
}

/// The offset's points at all nodes, row by row along v; a border's are those of the patch that begins there.
fn nodes(
    [us, vs]: &[Vec<Part>; 2],
    place: impl Fn(&Part, &Part, f64, f64) -> Result<DVec3, OffsetError>,
) -> Result<Vec<Vec<DVec3>>, OffsetError> {
    let places = |parts: &[Part]| -> Vec<(Part, f64)> {
        let inner = parts.iter().flat_map(|part| NODES[..QUINTIC].iter().map(|x| (*part, *x)));
        inner.chain(parts.last().map(|last| (*last, 1.0))).collect()
    };
    let along = places(vs);
    let row = |(u, x): (Part, f64)| along.iter().map(|(v, y)| place(&u, v, x, *y)).collect();
    places(us).into_iter().map(row).collect()
}

/// How far a patch is off along u, along v, and in both, between the nodes.
fn measured(
    nodes: &[Vec<DVec3>],
    [k, l]: [usize; 2],
    place: impl Fn(f64, f64) -> Result<DVec3, OffsetError>,
) -> Result<[f64; 3], OffsetError> {
    let value = |i: usize, j: usize| nodes[QUINTIC * k + i][QUINTIC * l + j];
    let six = |value: &dyn Fn(usize) -> DVec3| Quintic::through(std::array::from_fn(value));
    let columns: [Quintic<DVec3>; 6] = std::array::from_fn(|j| six(&|i| value(i, j)));
    let rows: [Quintic<DVec3>; 6] = std::array::from_fn(|i| six(&|j| value(i, j)));
    let mut off = [0.0f64; 3];
    for x in between_nodes() {
        let across = six(&|j| columns[j].at(x));
        for (k, y) in NODES.iter().enumerate() {
            off[0] = off[0].max(columns[k].at(x).distance(place(x, *y)?));
            off[1] = off[1].max(rows[k].at(x).distance(place(*y, x)?));
        }
        for y in between_nodes() {
            off[2] = off[2].max(across.at(y).distance(place(x, y)?));
        }
    }
    Ok(off)
}

/// How far the patches are off at most, all of them; `None` where no bound within `limit` was found for one before so many `boxes` were
/// tried.
fn bound(surface: &Surface, [us, vs]: &[Vec<Part>; 2], distance: f64, limit: f64, boxes: &mut usize) -> Option<f64> {
    let mut most = 0.0f64;
    let (mut span, mut whole) = (None, None);
    for u in us {
        for v in vs {
            if span != Some([u.span, v.span]) {
                span = Some([u.span, v.span]);
                whole = Some(surface.bezier_patch([u.span, v.span]));
            }
            let patch = whole.as_ref().expect("that of the span");
            let patch = cut(cut(patch.clone(), u.range, Direction::U), v.range, Direction::V);
            most = most.max(patch_bound(&patch, distance, limit, boxes)?);
        }
    }
    Some(most)
}

/// The part of a patch over a range of one direction.
fn cut(mut patch: BezierPatch, [start, end]: [f64; 2], direction: Direction) -> BezierPatch {
    let split = |patch: &BezierPatch, at: f64| match direction {
        Direction::U => patch.split_u(at),
        Direction::V => patch.split_v(at),
    };
    if patch.domain[direction as usize][0] < start {
        let [_, above] = split(&patch, start);
        patch = above;
    }
    if end < patch.domain[direction as usize][1] {
        let [below, _] = split(&patch, end);
        patch = below;
    }
    patch
}

/// The surface of all patches: knots of multiplicity 5 between them.
fn patches([us, vs]: &[Vec<Part>; 2], nodes: &[Vec<DVec3>]) -> Result<Surface, OffsetError> {
    let knots = |parts: &[Part]| {
        let ends = parts.iter().flat_map(|part| [part.range[1]; QUINTIC]);
        let first = parts[0].range[0];
        let last = parts[parts.len() - 1].range[1];
        KnotVector::new(QUINTIC, [first; QUINTIC + 1].into_iter().chain(ends).chain([last]).collect())
    };
    // Along v in each row of nodes, then along u in each column of what comes of it.
    let rows: Vec<Vec<DVec3>> = nodes.iter().map(|row| controls(row)).collect();
    let columns = (0..rows[0].len()).map(|j| controls(&rows.iter().map(|row| row[j]).collect::<Vec<DVec3>>()));
    let columns: Vec<Vec<DVec3>> = columns.collect();
    let points = (0..rows.len()).flat_map(|i| columns.iter().map(move |column| column[i])).collect();
    Ok(Surface::new(knots(us)?, knots(vs)?, points, None)?)
}

/// Control points through values at the nodes of parts in a row.
fn controls(values: &[DVec3]) -> Vec<DVec3> {
    let part = |k: usize| Quintic::through(std::array::from_fn(|i| values[QUINTIC * k + i]));
    let parts = (values.len() - 1) / QUINTIC;
    let inner = (0..parts).flat_map(|k| part(k).points()[..QUINTIC].to_vec());
    inner.chain(values.last().copied()).collect()
}
