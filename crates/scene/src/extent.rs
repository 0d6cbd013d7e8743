//! How far what a model shows reaches along a direction: boxes and framing rest on it.
//!
//! Control points are no measure of that: those of a sphere cut by a tilted plane lie five radii away, and a region may
//! show a small part of its surface. So the farthest point is sought by branch and bound. A cell is a Bézier piece of a
//! face's surface, or a part of one. Its control points bound it from above; points of it that are seen bound the
//! answer from below. Cells that may reach beyond the best point are halved, until the two agree to [`TIGHT`].
//!
//! The curves that bound a region are halved with the cells that they pass, and a cell that none passes is seen as a
//! whole or not at all. So the answer is that of the region, not of the box of its curves.

use crate::region::contour::is_crossed;
use crate::{Face, Piece, Region};
use glam::{DVec2, DVec3};
use nurbs::{BezierCurve, BezierPatch, Direction, Hull, Rectangle, Surface};
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// The answer is above the true one by at most this share of the extent along the direction.
const TIGHT: f64 = 1.0 / 1024.0;

/// Extents below this share of the model's size count as this much: a plane's rounding is not worth halving for.
const FLAT: f64 = 1e-6;

/// What rounding may take from a bound, as a share of its terms; the same as that of [`Hull::of`].
const OUTWARD: f64 = 1e-13;

/// The most work for one direction, in control points that are computed or curves that are looked at.
///
/// The eleven CAD models of the tests take at most a twenty-fifth of it, and the cells that wait then take 60 MB at most.
/// Where it ends a search, the bound so far is the answer: still beyond all that is seen, but not tight.
const MOST_WORK: usize = 1 << 21;

/// Where in a span, as shares of it along u and along v, points measure the size of a face. The corners alone are one point
/// where a span is closed.
const MEASURED: [f64; 3] = [0.0, 0.381_966, 1.0];

/// What a model shows, ready to be asked for its reach.
pub(crate) struct Extent<'a> {
    parts: Vec<Part<'a>>,
    /// The spans of each surface that a face uses.
    grids: Vec<Option<Grid>>,
    /// The box of some points that are seen, or on a border beside it: what sizes are measured by.
    seen: Hull,
}

/// A face.
struct Part<'a> {
    surface: &'a Surface,
    /// Index into [`Extent::grids`].
    grid: usize,
    /// Of the grid's spans in u and in v, the first that the region comes to and the one past the last.
    range: [[usize; 2]; 2],
    /// The region and its box, where it cuts something away.
    region: Option<(&'a Region, Rectangle)>,
}

/// The nonempty spans of a surface.
struct Grid {
    /// Their indices, in u and in v.
    spans: [Vec<usize>; 2],
    /// The boxes of their control points, row-major in u.
    hulls: Vec<Hull>,
}

/// A part of a Bézier piece of a face, not yet known to be beside the point.
struct Cell {
    /// No point of it is farther.
    bound: f64,
    part: usize,
    patch: BezierPatch,
    /// Parts of the region's boundary that may pass it; none where all of it is seen.
    curves: Vec<BezierCurve>,
}

/// What waits to be looked at: a span of a face, or a cell.
enum Waiting {
    Span { bound: f64, part: usize, span: [usize; 2] },
    Cell(Box<Cell>),
}

impl<'a> Extent<'a> {
    pub fn new(surfaces: &'a [Surface], faces: &[Face], regions: &'a [Option<Region>]) -> Self {
        let mut grids: Vec<Option<Grid>> = surfaces.iter().map(|_| None).collect();
        let mut parts = vec![];
        for (face, region) in faces.iter().zip(regions) {
            let surface = &surfaces[face.surface];
            let grid = grids[face.surface].get_or_insert_with(|| Grid::new(surface));
            let region = region.as_ref().filter(|region| !region.is_whole()).map(|region| (region, region.hull()));
            parts.push(Part { surface, grid: face.surface, range: grid.range(surface, region.map(|r| r.1)), region });
        }
        let points = parts.iter().flat_map(|part| {
            let pieces = part.region.into_iter().flat_map(|(region, _)| region.pieces());
            let spans = part.spans(&grids).filter(|_| part.region.is_none());
            let inside = spans.flat_map(|(span, _)| MEASURED.map(|share| at_share(part.surface, span, share)));
            pieces.map(|piece| piece.curve.start()).chain(inside).map(|uv| part.surface.point(uv.x, uv.y))
        });
        let seen = points.fold(Hull::of([]), |hull, p| Hull { min: hull.min.min(p), max: hull.max.max(p) });
        Self { parts, grids, seen }
    }

    /// A box that holds all that is seen, and is larger than it by at most [`TIGHT`] of it on each side.
    pub fn hull(&self) -> Hull {
        let reach = |along: DVec3| self.reach(along);
        let max = DVec3::new(reach(DVec3::X), reach(DVec3::Y), reach(DVec3::Z));
        let min = -DVec3::new(reach(DVec3::NEG_X), reach(DVec3::NEG_Y), reach(DVec3::NEG_Z));
        // Rounded outward.
        Hull::of([min, max])
    }

    /// The greatest p · `along` of all points p that are seen, or a little more: see [`TIGHT`].
    pub fn reach(&self, along: DVec3) -> f64 {
        let size = self.seen.diagonal() * along.length();
        let across = bound(&self.seen, along) + bound(&self.seen, -along);
        // Never less than what rounding outward may take.
        let farthest = self.seen.min.abs().max(self.seen.max.abs()).dot(along.abs());
        let slack = TIGHT * across.max(FLAT * size) + 4.0 * OUTWARD * farthest;
        let (reached, left) = (f64::NEG_INFINITY, f64::NEG_INFINITY);
        let search = Search { extent: self, along, reached, left, slack, work: 0, heap: BinaryHeap::new() };
        search.run()
    }
}

/// A search for the farthest point along one direction.
struct Search<'a> {
    extent: &'a Extent<'a>,
    along: DVec3,
    /// The farthest point that is known to be seen.
    reached: f64,
    /// The greatest bound of what was not looked at further.
    left: f64,
    slack: f64,
    work: usize,
    heap: BinaryHeap<Waiting>,
}

impl Search<'_> {
    fn run(mut self) -> f64 {
        for (index, part) in self.extent.parts.iter().enumerate() {
            for (span, hull) in part.spans(&self.extent.grids) {
                let bound = bound(hull, self.along);
                if self.matters(bound) {
                    self.heap.push(Waiting::Span { bound, part: index, span });
                    if part.region.is_none() {
                        let corner = at_share(part.surface, span, 0.0);
                        self.reached = self.reached.max(part.surface.point(corner.x, corner.y).dot(self.along));
                    }
                }
            }
        }
        while let Some(next) = self.heap.pop() {
            if !self.matters(next.bound()) || MOST_WORK <= self.work {
                return self.reached.max(self.left).max(next.bound());
            }
            match next {
                Waiting::Span { part, span, bound } => self.open(part, span, bound),
                Waiting::Cell(cell) => self.halve(*cell),
            }
        }
        self.reached.max(self.left)
    }

    /// Whether what may reach to `bound` is worth looking at; if not, the answer holds it all the same.
    fn matters(&mut self, bound: f64) -> bool {
        let matters = self.reached + self.slack < bound;
        if !matters {
            self.left = self.left.max(bound);
        }
        matters
    }

    /// A span becomes the cell of its Bézier piece in the box of the region.
    fn open(&mut self, part: usize, span: [usize; 2], bound: f64) {
        let Part { surface, region, .. } = self.extent.parts[part];
        let mut patch = surface.bezier_patch(span);
        self.work += patch.control.len();
        let Some((region, hull)) = region else {
            return self.admit(Cell { bound, part, patch, curves: vec![] }, true);
        };
        let within = |[low, high]: [f64; 2], t: f64| low < t && t < high;
        if within(patch.domain[0], hull.min.x) {
            patch = patch.split_u(hull.min.x)[1].clone();
        }
        if within(patch.domain[0], hull.max.x) {
            patch = patch.split_u(hull.max.x)[0].clone();
        }
        if within(patch.domain[1], hull.min.y) {
            patch = patch.split_v(hull.min.y)[1].clone();
        }
        if within(patch.domain[1], hull.max.y) {
            patch = patch.split_v(hull.max.y)[0].clone();
        }
        let domain = domain(&patch);
        let curves = inner(region).filter(|piece| piece.curve.hull().meets(domain)).map(|p| p.curve.clone()).collect();
        self.work += region.pieces().len();
        self.admit(Cell { bound, part, patch, curves }, false);
    }

    /// The two halves of a cell, across the direction in which its control points are farther apart.
    fn halve(&mut self, cell: Cell) {
        let Cell { bound, part, patch, curves } = cell;
        let [[u0, u1], [v0, v1]] = patch.domain;
        let middle = DVec2::new(u0 + 0.5 * (u1 - u0), v0 + 0.5 * (v1 - v0));
        let apart = [u0 < middle.x && middle.x < u1, v0 < middle.y && middle.y < v1];
        let [by_u, by_v] = spread(&patch);
        let halves = match apart {
            [true, true] if by_u < by_v => patch.split_v(middle.y),
            [true, _] => patch.split_u(middle.x),
            [_, true] => patch.split_v(middle.y),
            // As small as parameters allow: its bound is as good as a point.
            [false, false] => return self.reached = self.reached.max(bound),
        };
        let is_seen = curves.is_empty();
        let size = domain(&halves[0]).size();
        let finer: Vec<BezierCurve> = curves
            .into_iter()
            .flat_map(
                |curve| if curve.hull().size().cmpgt(size).any() { curve.split(0.5).to_vec() } else { vec![curve] },
            )
            .collect();
        self.work += 2 * patch.control.len() + finer.len();
        for patch in halves {
            let domain = domain(&patch);
            let curves = finer.iter().filter(|curve| curve.hull().meets(domain)).cloned().collect();
            self.admit(Cell { bound, part, patch, curves }, is_seen);
        }
    }

    /// Takes a cell in, unless none of it is seen or all of it is too near; `is_seen` where its parent is seen as a whole.
    fn admit(&mut self, mut cell: Cell, is_seen: bool) {
        let Part { surface, region, .. } = self.extent.parts[cell.part];
        cell.bound = cell.bound.min(bound_of_patch(&cell.patch, self.along));
        if !self.matters(cell.bound) {
            return;
        }
        let domain = domain(&cell.patch);
        if cell.curves.is_empty() {
            if let (false, Some((region, _))) = (is_seen, region) {
                self.work += region.pieces().len();
                if winding(region, 0.5 * (domain.min + domain.max)) == 0 {
                    return;
                }
            }
            // Its corners are points of the surface.
            let [p, q] = cell.patch.degree;
            for k in [0, q, p * (q + 1), p * (q + 1) + q] {
                let c = cell.patch.control[k];
                let corner = cell.patch.origin + c.truncate() / c.w;
                self.reached = self.reached.max(corner.dot(self.along));
            }
        } else {
            for uv in cell.curves.iter().map(BezierCurve::start) {
                let inside = domain.min.cmple(uv).all() && uv.cmple(domain.max).all();
                if inside {
                    self.reached = self.reached.max(surface.point(uv.x, uv.y).dot(self.along));
                }
            }
        }
        self.heap.push(Waiting::Cell(Box::new(cell)));
    }
}

impl Waiting {
    fn bound(&self) -> f64 {
        match self {
            Self::Span { bound, .. } => *bound,
            Self::Cell(cell) => cell.bound,
        }
    }
}

impl PartialEq for Waiting {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Waiting {}

impl PartialOrd for Waiting {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Waiting {
    fn cmp(&self, other: &Self) -> Ordering {
        self.bound().total_cmp(&other.bound())
    }
}

impl Grid {
    fn new(surface: &Surface) -> Self {
        let [u, v] = [Direction::U, Direction::V].map(|direction| surface.knots(direction).spans().collect::<Vec<_>>());
        let hulls = u.iter().flat_map(|&k| v.iter().map(move |&l| surface.span_hull([k, l]))).collect();
        Self { spans: [u, v], hulls }
    }

    /// The spans in u and in v that a box comes to; without one, all.
    fn range(&self, surface: &Surface, region: Option<Rectangle>) -> [[usize; 2]; 2] {
        let axis = |axis: usize| {
            let spans = &self.spans[axis];
            let Some(hull) = region else { return [0, spans.len()] };
            let knots = surface.knots([Direction::U, Direction::V][axis]).knots();
            let first = spans.partition_point(|&k| knots[k + 1] < hull.min[axis]);
            [first, first + spans[first..].partition_point(|&k| knots[k] <= hull.max[axis])]
        };
        [axis(0), axis(1)]
    }
}

impl Part<'_> {
    /// The spans that the face comes to, with their boxes.
    fn spans<'g>(&self, grids: &'g [Option<Grid>]) -> impl Iterator<Item = ([usize; 2], &'g Hull)> + use<'g> {
        let grid = grids[self.grid].as_ref().expect("of a surface that a face uses");
        let [u, v] = self.range;
        let columns = grid.spans[1].len();
        (u[0]..u[1]).flat_map(move |i| {
            (v[0]..v[1]).map(move |j| ([grid.spans[0][i], grid.spans[1][j]], &grid.hulls[i * columns + j]))
        })
    }
}

/// The parameters at a share of a span, the same along u and along v.
fn at_share(surface: &Surface, [k, l]: [usize; 2], share: f64) -> DVec2 {
    let along = |direction, k: usize| {
        let knots = surface.knots(direction).knots();
        knots[k] + share * (knots[k + 1] - knots[k])
    };
    DVec2::new(along(Direction::U, k), along(Direction::V, l))
}

/// The pieces of a region that run through the inside of the domain: along its borders nothing is cut.
fn inner(region: &Region) -> impl Iterator<Item = &Piece> {
    region.pieces().iter().filter(|piece| !piece.on_border)
}

fn domain(patch: &BezierPatch) -> Rectangle {
    let [[u0, u1], [v0, v1]] = patch.domain;
    Rectangle { min: DVec2::new(u0, v0), max: DVec2::new(u1, v1) }
}

/// The greatest p · `along` of a box.
fn bound(hull: &Hull, along: DVec3) -> f64 {
    // The axes that `along` has no part of may be infinite in an empty box.
    let farthest = |k: usize| match along[k] {
        0.0 => 0.0,
        x if x < 0.0 => x * hull.min[k],
        x => x * hull.max[k],
    };
    farthest(0) + farthest(1) + farthest(2)
}

/// The greatest p · `along` of a patch's control points, rounded outward: not of their box, which is off in first order
/// where `along` is no axis.
fn bound_of_patch(patch: &BezierPatch, along: DVec3) -> f64 {
    patch.control.iter().fold(f64::NEG_INFINITY, |most, c| {
        let p = patch.origin + c.truncate() / c.w;
        most.max(p.dot(along) + OUTWARD * p.abs().dot(along.abs()))
    })
}

/// The greatest distance between neighbouring control points in u, times the degree, and in v.
fn spread(patch: &BezierPatch) -> [f64; 2] {
    let [p, q] = patch.degree;
    let points: Vec<DVec3> = patch.control.iter().map(|c| c.truncate() / c.w).collect();
    let apart = |k: usize, l: usize| (points[k] - points[l]).abs().max_element();
    let mut most = [0.0f64; 2];
    for i in 0..=p {
        for j in 0..=q {
            let k = i * (q + 1) + j;
            if i < p {
                most[0] = most[0].max(apart(k, k + q + 1));
            }
            if j < q {
                most[1] = most[1].max(apart(k, k + 1));
            }
        }
    }
    [most[0] * p as f64, most[1] * q as f64]
}

/// How often a region's boundary winds about a point that no piece passes.
fn winding(region: &Region, point: DVec2) -> i32 {
    region.pieces().iter().filter(|piece| is_crossed(&piece.curve, point)).map(Piece::winding).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use nurbs::KnotVector;

    /// Without a size nothing is tight enough, and a search goes on until its work ends.
    #[test]
    fn one_span_has_a_size_even_where_it_is_closed() {
        let knots = || KnotVector::new(3, vec![0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0]).unwrap();
        let open = |i: f64, j: f64| DVec3::new(i, j, i * (3.0 - i) * j);
        // Both borders in u are one curve, and both in v.
        let closed =
            |i: f64, j: f64| DVec3::new(i * (3.0 - i), j * (3.0 - j), i * (3.0 - i) * j * (3.0 - j) * (i - j + 0.5));
        for point in [&open as &dyn Fn(f64, f64) -> DVec3, &closed] {
            let points = (0..16).map(|k| point((k / 4) as f64, (k % 4) as f64)).collect();
            let surfaces = [Surface::new(knots(), knots(), points, None).unwrap()];
            let extent = Extent::new(&surfaces, &[Face::whole(0)], &[None]);
            let (size, seen) = (extent.hull().diagonal(), extent.seen.diagonal());
            assert!(0.25 * size < seen && seen <= size, "{seen} of {size}");
        }
    }
}
