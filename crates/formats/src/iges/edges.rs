//! Loops, edges and vertices of shells (508, 504, 502).

use super::curve::{Space, pieces, reversed};
use super::fault::{Fault, fault};
use super::geometry::Geometry;
use super::sheet::Sheet;
use crate::brep::path::{Piece, Use};
use crate::brep::shape::Shape;
use glam::DVec3;
use std::collections::BTreeMap;
use std::rc::Rc;

/// What an edge takes beside its control points, as so many of these.
const EDGE: usize = 16;

/// A curve in (u, v) that is farther than so many resolutions, and than this share of its size, from its curve in space is
/// not believed.
const OFF: f64 = 10.0;
const OFF_SHARE: f64 = 1e-4;

/// At which places of a piece that is asked, from 0 to 1.
const PLACES: [f64; 5] = [0.0, 0.25, 0.5, 0.75, 1.0];

/// Pieces of a loop, in one of two spaces.
pub(super) enum Pieces {
    Plane(Vec<Piece>),
    Space(Vec<Piece>),
}

impl Pieces {
    /// Each run forwards, as a part of edge `edge`.
    pub fn uses(self, edge: Option<i64>) -> Vec<Use> {
        let empty = || Use { space: None, plane: None, reversed: false, edge, vertices: [0.0; 2] };
        match self {
            Self::Plane(pieces) => pieces.into_iter().map(|piece| Use { plane: Some(piece), ..empty() }).collect(),
            Self::Space(pieces) => pieces.into_iter().map(|piece| Use { space: Some(piece), ..empty() }).collect(),
        }
    }
}

/// About how many points of a span a search of the nearest place looks at, and how many all searches of a loop do at most.
const SAMPLES_A_SPAN: usize = 16;
const MOST_SAMPLES: usize = 1 << 20;

/// An entry of an edge list: its curve, and its vertices as lists and indices from 1.
#[derive(Debug, Clone, Copy)]
struct Edge {
    curve: u32,
    vertices: [(u32, usize); 2],
}

/// Edge lists and vertex lists, each read once; what cannot be read is told to each that asks.
#[derive(Debug, Default)]
pub(super) struct Edges {
    edges: BTreeMap<u32, Result<Rc<Vec<Edge>>, Fault>>,
    vertices: BTreeMap<u32, Result<Rc<Vec<DVec3>>, Fault>>,
}

impl Edges {
    /// An edge by its list and its index from 1.
    fn edge(&mut self, geometry: &Geometry, list: u32, index: usize) -> Result<Edge, Fault> {
        let read = || {
            let entity = geometry.get_of(list, 504, "an edge list")?;
            let own = entity.parameters();
            let edge = |k: usize| {
                let at = 2 + 5 * k;
                let vertex = |at: usize| Ok((own.pointer(at)?, own.whole(at + 1)?));
                Ok(Edge { curve: own.pointer(at)?, vertices: [vertex(at + 1)?, vertex(at + 3)?] })
            };
            Ok(Rc::new((0..own.count(1, 5)?).map(edge).collect::<Result<Vec<_>, Fault>>()?))
        };
        let edges = self.edges.entry(list).or_insert_with(read).as_ref().map_err(Clone::clone)?;
        let edge = index.checked_sub(1).and_then(|k| edges.get(k));
        edge.copied().ok_or_else(|| fault(list, format!("it has no edge {index}, but {} edges", edges.len())))
    }

    /// A vertex by its list and its index from 1.
    fn vertex(&mut self, geometry: &Geometry, (list, index): (u32, usize)) -> Result<DVec3, Fault> {
        let read = || {
            let entity = geometry.get_of(list, 502, "a vertex list")?;
            let own = entity.parameters();
            let values = own.numbers(2, 3 * own.count(1, 3)?)?;
            Ok(Rc::new(values.chunks_exact(3).map(DVec3::from_slice).collect::<Vec<_>>()))
        };
        let vertices = self.vertices.entry(list).or_insert_with(read).as_ref().map_err(Clone::clone)?;
        let vertex = index.checked_sub(1).and_then(|k| vertices.get(k));
        vertex.copied().ok_or_else(|| fault(list, format!("it has no vertex {index}, but {} vertices", vertices.len())))
    }

    /// The edges of a loop (508) in order; a vertex that it uses is a pole, where the loop goes on by itself.
    pub fn uses(&mut self, geometry: &Geometry, number: u32, sheet: &Sheet) -> Result<Vec<Use>, Fault> {
        let entity = geometry.get_of(number, 508, "a loop")?;
        let own = entity.parameters();
        let (mut uses, mut at) = (vec![], 2);
        for _ in 0..own.count(1, 5)? {
            let is_vertex = own.flag(at)?;
            let (list, index, runs_with) = (own.pointer(at + 1)?, own.whole(at + 2)?, own.flag(at + 3)?);
            let count = own.whole(at + 4)?;
            if own.values.len().saturating_sub(at + 5) / 2 < count {
                return Err(fault(number, format!("it counts {count} curves in (u, v), which are not all there")));
            }
            let plane: Vec<u32> = (0..count).map(|k| own.pointer(at + 6 + 2 * k)).collect::<Result<_, _>>()?;
            at += 5 + 2 * count;
            if is_vertex {
                self.vertex(geometry, (list, index))?;
                continue;
            }
            geometry.spend(number, EDGE)?;
            uses.extend(self.edge_use(geometry, (list, index), runs_with, &plane, sheet)?);
        }
        Ok(uses)
    }

    /// An edge as a loop uses it: one use, or for a composite curve one for each of its pieces.
    fn edge_use(
        &mut self,
        geometry: &Geometry,
        (list, index): (u32, usize),
        runs_with: bool,
        plane: &[u32],
        sheet: &Sheet,
    ) -> Result<Vec<Use>, Fault> {
        let edge = self.edge(geometry, list, index)?;
        let [from, to] = [self.vertex(geometry, edge.vertices[0])?, self.vertex(geometry, edge.vertices[1])?];
        let mut space = pieces(geometry, edge.curve, Space::Model)?;
        let id = Some((i64::from(list) << 32) | i64::try_from(index).expect("below 1e9"));
        let (first, last) = (space[0].point(0.0), space[space.len() - 1].point(1.0));
        let mut ends = [first.distance(from), last.distance(to)];
        let size = nurbs::Hull::of(space.iter().flat_map(|piece| PLACES.map(|s| piece.point(s)))).diagonal();
        // Vertices that are not where the curve ends say which part of it the edge is.
        if let [piece] = &mut space[..]
            && geometry.tolerance.max(OFF_SHARE * size) < ends[0].max(ends[1])
        {
            let (range, is_against) = piece.curve.range([from, to], true, geometry.tolerance);
            let part = Piece { curve: piece.curve.clone(), range };
            let off = [part.point(0.0).distance(from), part.point(1.0).distance(to)];
            if !is_against && range[0] < range[1] && off[0].max(off[1]) < ends[0].max(ends[1]) {
                (*piece, ends) = (part, off);
            }
        }
        // With the loop, in (u, v): those that are there and lie on the edge.
        let plane = plane.iter().map(|curve| {
            let pieces = pieces(geometry, *curve, Space::Parameters).ok()?;
            pieces.iter().map(|piece| sheet.plane_piece(piece)).collect::<Option<Vec<_>>>()
        });
        let plane: Vec<Piece> = plane.collect::<Option<Vec<_>>>().unwrap_or_default().concat();
        let given = match (&space[..], &plane[..]) {
            ([space], [plane]) => along(&sheet.shape, plane, space),
            _ => None,
        };
        let empty = |vertices: [f64; 2]| Use { space: None, plane: None, reversed: !runs_with, edge: id, vertices };
        if let Some(given) = given {
            let space = space.remove(0);
            return Ok(vec![Use { space: Some(space), plane: Some(given), ..empty(ends) }]);
        }
        if !plane.is_empty() && space.len() != 1 && on_surface(&sheet.shape, &plane, &space, geometry.tolerance) {
            // Several pieces run as the loop does.
            return Ok(Pieces::Plane(plane).uses(id));
        }
        let count = space.len();
        let piece = |(k, space): (usize, Piece)| {
            let vertices = [if k == 0 { ends[0] } else { 0.0 }, if k + 1 == count { ends[1] } else { 0.0 }];
            Use { space: Some(space), ..empty(vertices) }
        };
        let mut uses: Vec<Use> = space.into_iter().enumerate().map(piece).collect();
        if !runs_with {
            uses.reverse();
        }
        Ok(uses)
    }
}

/// A curve in (u, v) run as its edge in space: files differ in whether it runs as the edge or as the loop does. `None` where
/// it cannot be turned.
fn along(shape: &Shape, plane: &Piece, space: &Piece) -> Option<Piece> {
    let off = |turned: bool| -> f64 {
        let place =
            |s: f64| shape.point(plane.point(s).truncate()).distance(space.point(if turned { 1.0 - s } else { s }));
        PLACES.into_iter().map(place).sum()
    };
    if off(true) < off(false) { reversed(plane) } else { Some(plane.clone()) }
}

/// Whether pieces in (u, v) lie on pieces in space, wherever along them.
pub(super) fn on_surface(shape: &Shape, plane: &[Piece], space: &[Piece], tolerance: f64) -> bool {
    let places = |piece: &Piece| PLACES.map(|s| piece.point(s));
    let size = nurbs::Hull::of(space.iter().flat_map(places)).diagonal();
    let enough = (OFF * tolerance).max(OFF_SHARE * size);
    let distance = |point: DVec3, piece: &Piece| {
        let [start, end] = piece.range;
        let mut t = piece.curve.parameter(point);
        if let Some(period) = piece.curve.period() {
            t += ((0.5 * (start + end) - t) / period).round() * period;
        }
        piece.curve.point(t.clamp(start, end)).distance(point)
    };
    // Each search samples the curves in space: of many pieces, some are asked.
    let samples: usize = space.iter().map(|piece| SAMPLES_A_SPAN * piece.curve.breaks(piece.range).len().max(1)).sum();
    let asked = (MOST_SAMPLES / samples.saturating_mul(PLACES.len())).max(1);
    let step = plane.len().div_ceil(asked).max(1);
    plane.iter().enumerate().step_by(step).all(|(k, piece)| {
        places(piece).into_iter().enumerate().all(|(i, uv)| {
            let point = shape.point(uv.truncate());
            // As many pieces in both: first those that correspond, at the same place.
            let own = space.get(k).filter(|_| space.len() == plane.len());
            own.is_some_and(|own| own.point(PLACES[i]).distance(point) <= enough)
                || space.iter().any(|other| distance(point, other) <= enough)
        })
    })
}
