//! The sides of a face: monotone curves in (u, v) that bound it, with points on them in the order of the curve.
//!
//! A side has a point at its ends, wherever it crosses a line of the face's cells, and as many more as keep its chords near
//! enough to it. Between two neighbours the curve, monotone in both parameters, and its chord lie in one cell.

use super::cells::{Bounds, Grid};
use super::points::Points;
use glam::{DVec2, DVec3};
use nurbs::{BezierCurve, Hull, Rectangle, Surface};
use scene::{FaceId, Model, Piece, Trim, closed};
use std::collections::HashSet;

/// What is at most this share of a face's size is a point in space, and more where its tolerance says so, up to [`SMALL`].
pub(super) const POINT: f64 = 1e-7;

/// See [`POINT`].
const SMALL: f64 = 1e-3;

/// A trim whose control points are all within this share of a period of a seam runs along it.
const ALONG: f64 = 1e-6;

/// Chords by which a curve's extent in space is measured.
const CHORDS: usize = 8;

/// What is known of a side beside its curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Kind {
    /// Nothing.
    Free,
    /// It is a point in space: a pole, or a gap between two trims.
    Point,
    /// The surface goes on across it, in this parameter.
    Seam(usize),
    /// The file numbers the edge that this trim, by its loop and its place there, is a use of.
    Edge { edge: i64, boundary: usize, trim: usize },
}

/// A point of a side.
#[derive(Debug, Clone, Copy)]
pub(super) struct Node {
    /// The curve's parameter, 0 to 1.
    pub s: f64,
    pub uv: DVec2,
    /// Its number, where it has one already.
    pub point: Option<usize>,
}

/// A side of a face.
pub(super) struct Side {
    pub curve: BezierCurve,
    pub kind: Kind,
    /// Ascending, two at least.
    pub nodes: Vec<Node>,
    /// Bounds of the curve's second derivatives, (u'', v'').
    bend: DVec2,
}

/// A face as its sides and the lines of its cells.
pub(super) struct Outline<'m> {
    pub surface: &'m Surface,
    pub grid: Grid,
    pub sides: Vec<Side>,
    /// In which parameters the surface is closed.
    pub closed: [bool; 2],
}

impl Outline<'_> {
    /// The surface's point.
    pub fn place(&self, uv: DVec2) -> DVec3 {
        self.surface.point(uv.x, uv.y)
    }

    /// Puts a point on a side, between its neighbours; on an end, or another point of that parameter, it is one with that.
    pub fn insert(&mut self, side: usize, s: f64, point: usize, points: &mut Points) {
        let own = &mut self.sides[side];
        let at = own.nodes.partition_point(|node| node.s < s);
        if let Some(node) = own.nodes.get_mut(at).filter(|node| node.s == s) {
            match node.point {
                Some(other) => points.join(other, point),
                None => node.point = Some(point),
            }
            return;
        }
        let between = Between::of(own.nodes[at - 1].uv, own.nodes[at].uv);
        let uv = between.clamped(self.grid.snapped(between.clamped(own.curve.point(s))));
        own.nodes.insert(at, Node { s, uv, point: Some(point) });
    }

    /// Puts points on a seam side at all `values` of its parameter.
    pub fn insert_along(&mut self, side: usize, along: usize, values: &[f64]) {
        let own = &mut self.sides[side];
        let [start, end] = [own.curve.start(), own.curve.end()];
        let (low, high) = (start[along].min(end[along]), start[along].max(end[along]));
        let known: HashSet<u64> = own.nodes.iter().map(|node| node.uv[along].to_bits()).collect();
        for value in
            values.iter().copied().filter(|value| low < *value && *value < high && !known.contains(&value.to_bits()))
        {
            let mut uv = start;
            uv[along] = value;
            own.nodes.push(Node { s: (value - start[along]) / (end[along] - start[along]), uv, point: None });
        }
        let rises = start[along] < end[along];
        own.nodes.sort_by(|a, b| {
            if rises { a.uv[along].total_cmp(&b.uv[along]) } else { b.uv[along].total_cmp(&a.uv[along]) }
        });
    }

    /// How many equal parts the curve between a node and the next needs so that its chords are within `allowed` of it in space.
    pub fn parts(&self, bounds: &Bounds, side: usize, node: usize, allowed: f64) -> f64 {
        (self.bow(bounds, side, node) / allowed).sqrt().ceil().max(1.0)
    }

    /// How far at most the curve between a node and the next is from its chord, on the surface.
    pub fn bow(&self, bounds: &Bounds, side: usize, node: usize) -> f64 {
        let own = &self.sides[side];
        let (a, b) = (own.nodes[node], own.nodes[node + 1]);
        let speed = bounds.at((0.5 * (a.uv + b.uv)).to_array());
        (speed.u * own.bend.x + speed.v * own.bend.y) * (b.s - a.s) * (b.s - a.s) / 8.0
    }
}

/// The box of two points.
struct Between(Rectangle);

impl Between {
    fn of(a: DVec2, b: DVec2) -> Self {
        Self(Rectangle { min: a.min(b), max: a.max(b) })
    }

    fn clamped(&self, uv: DVec2) -> DVec2 {
        uv.clamp(self.0.min, self.0.max)
    }
}

/// The parameters that a face comes to.
pub(super) fn ranges(model: &Model, face: FaceId) -> [[f64; 2]; 2] {
    match model.region(face) {
        None => model.surface(face).domain(),
        Some(region) => {
            let hull = region.hull();
            [[hull.min.x, hull.max.x], [hull.min.y, hull.max.y]]
        }
    }
}

/// The sides of a face, with points at their ends and on the lines of the grid.
pub(super) fn outline<'m>(model: &'m Model, id: FaceId, grid: Grid) -> Outline<'m> {
    let surface = model.surface(id);
    let sheet = Sheet::new(model, id);
    let sides = match model.region(id) {
        None => {
            let [[u0, u1], [v0, v1]] = surface.domain();
            let corners = [[u0, v0], [u1, v0], [u1, v1], [u0, v1]].map(DVec2::from_array);
            let side = |k: usize| {
                let curve = BezierCurve::line(corners[k], corners[(k + 1) % 4]);
                let kind = sheet.border_kind(&curve).unwrap_or(Kind::Free);
                Side::new(curve, kind, &grid)
            };
            (0..4).map(side).collect()
        }
        Some(region) => {
            let of_piece = |piece: &Piece| {
                let source = region.loops()[piece.loop_index].source;
                let kind = sheet.kind(piece, source.zip(piece.trim));
                Side::new(piece.curve.clone(), kind, &grid)
            };
            region.pieces().iter().map(of_piece).collect()
        }
    };
    Outline { surface, grid, sides, closed: sheet.closed }
}

/// A face's surface, to ask what a piece of its border is.
struct Sheet<'m> {
    model: &'m Model,
    id: FaceId,
    surface: &'m Surface,
    closed: [bool; 2],
    /// The greatest extent of a point, model units.
    point: f64,
}

impl<'m> Sheet<'m> {
    fn new(model: &'m Model, id: FaceId) -> Self {
        let surface = model.surface(id);
        let size = surface.hull().diagonal();
        let tolerance = model.faces()[id.0 as usize].tolerance;
        let point = tolerance.min(SMALL * size).max(POINT * size);
        let mut sheet = Self { model, id, surface, closed: closed(surface), point };
        if let Some(region) = model.region(id) {
            // A region knows the file's tolerance, by which a surface may be closed.
            for axis in [0, 1] {
                let has_no_end = [0, 1].iter().all(|side| !region.ends_at(axis, *side));
                sheet.closed[axis] |=
                    has_no_end && [0, 1].iter().any(|side| !sheet.is_point(&sheet.domain_side(axis, *side)));
            }
        }
        sheet
    }

    fn domain_side(&self, axis: usize, side: usize) -> BezierCurve {
        let domain = self.surface.domain();
        let mut ends = [0, 1].map(|k: usize| DVec2::new(domain[0][k], domain[1][k]));
        ends.iter_mut().for_each(|end| end[axis] = domain[axis][side]);
        BezierCurve::line(ends[0], ends[1])
    }

    fn is_point(&self, curve: &BezierCurve) -> bool {
        let place = |k: usize| {
            let uv = curve.point(k as f64 / CHORDS as f64);
            self.surface.point(uv.x, uv.y)
        };
        Hull::of((0..=CHORDS).map(place)).diagonal() <= self.point
    }

    /// What a curve along the border of the domain is, where it is a point or a seam.
    fn border_kind(&self, curve: &BezierCurve) -> Option<Kind> {
        let axis = usize::from(curve.start().x != curve.end().x);
        let side = usize::from(curve.start()[axis] == self.surface.domain()[axis][1]);
        match () {
            () if self.is_point(&self.domain_side(axis, side)) => Some(Kind::Point),
            () if self.closed[axis] => Some(Kind::Seam(axis)),
            () => None,
        }
    }

    /// Whether a trim with a number runs along a seam, as all of a piece of it does, and does not just leave the domain there.
    fn runs_along(&self, piece: &Piece, trim: &Trim) -> bool {
        let axis = usize::from(piece.curve.start().x != piece.curve.end().x);
        let [start, end] = self.surface.domain()[axis];
        let is_along = |at: f64| {
            let share = (at - piece.curve.start()[axis]) / (end - start);
            (share - share.round()).abs() <= ALONG
        };
        trim.edge.is_some() && trim.points.iter().all(|uv| is_along(uv[axis]))
    }

    fn kind(&self, piece: &Piece, trim: Option<(usize, usize)>) -> Kind {
        let border = piece.on_border.then(|| self.border_kind(&piece.curve)).flatten();
        let runs_along = |(boundary, trim): (usize, usize)| {
            self.runs_along(piece, &self.model.faces()[self.id.0 as usize].loops[boundary].trims[trim])
        };
        match border {
            // A seam that the file names is matched as other edges are: its two trims may be a little off the border.
            Some(Kind::Seam(_)) if trim.is_some_and(runs_along) => {}
            Some(kind) => return kind,
            None => {}
        }
        let Some((boundary, trim)) = trim else {
            // What closes a gap, also where the trims beside it run along the border of the domain.
            return if self.is_point(&piece.curve) { Kind::Point } else { Kind::Free };
        };
        let own = &self.model.faces()[self.id.0 as usize].loops[boundary].trims[trim];
        match own.edge {
            _ if own.degenerate && self.is_point(&piece.curve) => Kind::Point,
            Some(edge) => Kind::Edge { edge, boundary, trim },
            None => Kind::Free,
        }
    }
}

impl Side {
    fn new(curve: BezierCurve, kind: Kind, grid: &Grid) -> Self {
        let [start, end] = [curve.start(), curve.end()].map(|uv| grid.snapped(uv));
        let mut nodes = vec![];
        for axis in [0, 1] {
            for &line in grid.between(axis, start[axis], end[axis]) {
                let s = curve.crossing(axis, line);
                let mut uv = grid.snapped(curve.point(s).clamp(start.min(end), start.max(end)));
                uv[axis] = line;
                nodes.push(Node { s, uv, point: None });
            }
        }
        nodes.sort_by(|a, b| a.s.total_cmp(&b.s));
        // Rounding puts no point behind the one before it.
        let mut last = start;
        for node in &mut nodes {
            for axis in [0, 1] {
                let rises = start[axis] < end[axis];
                node.uv[axis] = if rises { node.uv[axis].max(last[axis]) } else { node.uv[axis].min(last[axis]) };
            }
            last = node.uv;
        }
        nodes.retain(|node| 0.0 < node.s && node.s < 1.0 && node.uv != start && node.uv != end);
        nodes.dedup_by(|b, a| a.uv == b.uv || a.s == b.s);
        nodes.insert(0, Node { s: 0.0, uv: start, point: None });
        nodes.push(Node { s: 1.0, uv: end, point: None });
        let bend = curve.second_derivative_bounds();
        Self { curve, kind, nodes, bend }
    }
}
