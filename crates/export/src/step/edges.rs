//! Edges and vertices of a model: trims that the model says are one edge become one, with two uses.
//!
//! A face without loops is bounded by the sides of its domain; the two sides of a closed surface are one edge, and a side
//! that is a point in space is none.

use super::space::{InSpace, Sheet, in_space};
use crate::error::ExportError;
use glam::{DVec2, DVec3};
use nurbs::{Curve, KnotVector};
use scene::{Face, FaceId, Loop, Model, Trim, closed};
use std::borrow::Cow;
use std::collections::BTreeMap;

/// Two trims of one edge are its two uses where they run within this share of its length of each other, or within ten
/// uncertainties: files may give one number to all their edges.
const NEAR: f64 = 1e-2;
const NEAR_UNCERTAINTIES: f64 = 10.0;

/// The share of the uncertainty that an edge in space may be from its trim.
const OF_UNCERTAINTY: f64 = 0.1;

/// Places on a trim that are looked at, and chords of the other.
const PLACES: usize = 16;
const CHORDS: usize = 64;

/// A side of a domain below this share of its surface's box is a point.
const POINT: f64 = 1e-9;

/// An edge, run as its first use's trim is.
pub(super) struct Edge {
    /// One or two.
    pub uses: Vec<Use>,
    /// The first use's trim in space.
    pub space: InSpace,
    /// Its vertices, where it starts and ends.
    pub vertices: [usize; 2],
}

/// A trim as a use of an edge.
pub(super) struct Use {
    pub face: usize,
    /// Which of [`Topology::parts`] it bounds.
    pub part: usize,
    pub trim: Trim,
    /// Whether the trim's curve runs against the edge.
    pub turned: bool,
    /// Whether the loop, with the face's own orientation removed, runs the edge forwards.
    pub forward: bool,
}

/// A loop of edges.
pub(super) struct Bound {
    pub outer: bool,
    /// Edges, and which of their uses.
    pub uses: Vec<(usize, usize)>,
    /// A point of the loop, for one that is a point.
    pub at: DVec3,
}

/// A face of the file: a model's face, or what one of its outer loops bounds, since STEP has one to a face.
pub(super) struct Part {
    pub face: usize,
    pub bounds: Vec<Bound>,
}

/// The topology of a model.
pub(super) struct Topology {
    pub edges: Vec<Edge>,
    pub parts: Vec<Part>,
    /// The points of the vertices.
    pub vertices: Vec<DVec3>,
}

/// What names an edge.
#[derive(PartialEq, Eq, PartialOrd, Ord, Clone, Copy)]
enum Key {
    /// The file's number.
    Named(i64),
    /// The two sides of a face's closed surface, across u or v.
    Seam(usize, usize),
}

impl Topology {
    /// Finds edges and vertices; those in space are within `uncertainty` of the trims.
    ///
    /// # Errors
    /// [`ExportError::Trim`].
    pub fn new(model: &Model, uncertainty: f64) -> Result<Self, ExportError> {
        let mut edges: Vec<Edge> = vec![];
        let mut known: BTreeMap<Key, Vec<usize>> = BTreeMap::new();
        let mut parts: Vec<Part> = vec![];
        for (index, face) in model.faces().iter().enumerate() {
            let sheet = Sheet::new(model.surface(FaceId(index as u32)));
            let loops = loops(&sheet, index, face);
            for members in outers(model, index, &loops) {
                let mut own = Part { face: index, bounds: vec![] };
                for boundary in members {
                    let (outer, trims) = &loops[boundary];
                    let at = sheet.point(trims[0].0.points[0]);
                    let mut uses = vec![];
                    for (number, (trim, key)) in trims.iter().enumerate().filter(|(_, (trim, _))| !trim.degenerate) {
                        let wrong = |cause| ExportError::Trim {
                            face: model.number_in_file(FaceId(index as u32)),
                            boundary,
                            trim: number,
                            cause,
                        };
                        let ran = Ran::new(&sheet, trim).map_err(wrong)?;
                        let shared =
                            key.iter().flat_map(|key| known.get(key).into_iter().flatten()).find_map(|&edge| {
                                let turned = ran.turned(model, &edges[edge], uncertainty)?;
                                Some((edge, turned))
                            });
                        let (edge, turned) = match shared {
                            Some(found) => found,
                            None => {
                                let space = in_space(&sheet, trim, OF_UNCERTAINTY * uncertainty).map_err(wrong)?;
                                edges.push(Edge { uses: vec![], space, vertices: [0; 2] });
                                let edge = edges.len() - 1;
                                if let Some(key) = key {
                                    known.entry(*key).or_default().push(edge);
                                }
                                (edge, false)
                            }
                        };
                        uses.push((edge, edges[edge].uses.len()));
                        let forward = trim.reversed == turned;
                        let trim = trim.as_ref().clone();
                        edges[edge].uses.push(Use { face: index, part: parts.len(), trim, turned, forward });
                    }
                    own.bounds.push(Bound { outer: *outer, uses, at });
                }
                parts.push(own);
            }
        }
        let vertices = vertices(&mut edges, parts.iter().flat_map(|part| &part.bounds));
        Ok(Self { edges, parts, vertices })
    }

    /// The parts of each shell, and whether it is closed: each edge run once each way.
    pub fn shells(&self, model: &Model) -> Vec<(Vec<usize>, bool)> {
        let mut shell = Groups::new(self.parts.len());
        for edge in &self.edges {
            edge.uses.iter().for_each(|other| shell.join(edge.uses[0].part, other.part));
        }
        let mut shells: BTreeMap<usize, (Vec<usize>, bool)> = BTreeMap::new();
        for part in 0..self.parts.len() {
            shells.entry(shell.of(part)).or_insert((vec![], true)).0.push(part);
        }
        for edge in &self.edges {
            let ahead = |own: &Use| own.forward != model.faces()[own.face].reversed;
            let is_closed = matches!(&edge.uses[..], [a, b] if ahead(a) != ahead(b));
            shells.get_mut(&shell.of(edge.uses[0].part)).expect("every part is in one").1 &= is_closed;
        }
        shells.into_values().collect()
    }
}

/// A loop's trims and what names their edges.
type Named<'m> = (bool, Vec<(Cow<'m, Trim>, Option<Key>)>);

/// The loops of a face: the file's, or the sides of its domain.
fn loops<'m>(sheet: &Sheet, index: usize, face: &'m Face) -> Vec<Named<'m>> {
    if face.loops.is_empty() {
        return vec![natural(sheet, index)];
    }
    let named = |trim: &'m Trim| (Cow::Borrowed(trim), trim.edge.map(Key::Named));
    let of_loop = |Loop { outer, trims }: &'m Loop| (*outer, trims.iter().map(named).collect());
    face.loops.iter().filter(|boundary| !boundary.trims.is_empty()).map(of_loop).collect()
}

/// The loops of a face by the outer ones: each with its holes, first. All together where there is one outer loop, or none.
fn outers(model: &Model, index: usize, loops: &[Named]) -> Vec<Vec<usize>> {
    let all = (0..loops.len()).collect();
    let Some(region) = model.region(FaceId(index as u32)) else { return vec![all] };
    // The region knows which loop is which, whatever the file says; a loop without area is no part of it.
    let depth = |k: usize| region.loops().iter().find(|own| own.source == Some(k)).map(|own| own.depth);
    let outer: Vec<usize> = (0..loops.len()).filter(|k| depth(*k).is_some_and(|depth| depth % 2 == 0)).collect();
    if outer.len() < 2 || loops.len() != model.faces()[index].loops.len() {
        return vec![all];
    }
    let polygons: Vec<Vec<DVec2>> = loops.iter().map(polygon).collect();
    let mut parts: Vec<Vec<usize>> = outer.iter().map(|k| vec![*k]).collect();
    for hole in (0..loops.len()).filter(|k| !outer.contains(k)) {
        let holders = (0..outer.len()).filter(|own| {
            let votes = polygons[hole].iter().filter(|uv| holds(&polygons[outer[*own]], **uv)).count();
            polygons[hole].len() < 2 * votes
        });
        let least = holders.min_by(|a, b| area(&polygons[outer[*a]]).total_cmp(&area(&polygons[outer[*b]])));
        parts[least.unwrap_or(0)].push(hole);
    }
    parts
}

/// A loop by chords.
fn polygon((_, trims): &Named) -> Vec<DVec2> {
    let places = |trim: &Trim| {
        let curve = Curve::new(trim.knots.clone(), &trim.points, trim.weights.as_deref()).ok();
        let (start, end) = trim.knots.domain();
        let share = |k: usize| if trim.reversed { 1.0 - k as f64 / PLACES as f64 } else { k as f64 / PLACES as f64 };
        let at = move |k: usize| curve.as_ref().map(|curve| curve.point(start + (end - start) * share(k)));
        (0..PLACES).filter_map(at).collect::<Vec<_>>()
    };
    trims.iter().flat_map(|(trim, _)| places(trim)).collect()
}

/// Twice the area that chords enclose, whichever way they run.
fn area(polygon: &[DVec2]) -> f64 {
    let next = |k: usize| polygon[(k + 1) % polygon.len()] - polygon[0];
    (0..polygon.len()).map(|k| (polygon[k] - polygon[0]).perp_dot(next(k))).sum::<f64>().abs()
}

/// Whether chords enclose a point: by the crossings of a ray.
fn holds(polygon: &[DVec2], uv: DVec2) -> bool {
    let is_crossed = |k: &usize| {
        let (a, b) = (polygon[*k], polygon[(k + 1) % polygon.len()]);
        (a.y <= uv.y) != (b.y <= uv.y) && uv.x < a.x + (uv.y - a.y) / (b.y - a.y) * (b.x - a.x)
    };
    (0..polygon.len()).filter(is_crossed).count() % 2 == 1
}

/// The sides of a domain, counter-clockwise; those of a closed surface run the same way and are one edge.
fn natural(sheet: &Sheet, index: usize) -> Named<'static> {
    let [[u0, u1], [v0, v1]] = sheet.surface.domain();
    let closed = closed(sheet.surface);
    let side = |from: [f64; 2], to: [f64; 2], across: usize, is_second: bool| {
        let [from, to] = [from, to].map(DVec2::from_array);
        let points = if is_second { vec![to, from] } else { vec![from, to] };
        let knots = KnotVector::new(1, vec![0.0, 0.0, 1.0, 1.0]).expect("one span");
        let mut trim = Trim::new(knots, points, None);
        (trim.reversed, trim.seam) = (is_second, closed[across]);
        let places = (0..=PLACES).map(|k| sheet.point(from.lerp(to, k as f64 / PLACES as f64)));
        trim.degenerate = nurbs::Hull::of(places).diagonal() <= POINT * sheet.surface.hull().diagonal();
        (Cow::Owned(trim), closed[across].then_some(Key::Seam(index, across)))
    };
    let sides = vec![
        side([u0, v0], [u1, v0], 1, false),
        side([u1, v0], [u1, v1], 0, false),
        side([u1, v1], [u0, v1], 1, true),
        side([u0, v1], [u0, v0], 0, true),
    ];
    (true, sides)
}

/// A trim in space, by points of it.
struct Ran {
    places: Vec<DVec3>,
}

impl Ran {
    fn new(sheet: &Sheet, trim: &Trim) -> Result<Self, nurbs::NurbsError> {
        let curve = Curve::new(trim.knots.clone(), &trim.points, trim.weights.as_deref())?;
        let (start, end) = trim.knots.domain();
        let place = |k: usize| sheet.point(curve.point(start + (end - start) * (k as f64 / CHORDS as f64)));
        Ok(Self { places: (0..=CHORDS).map(place).collect() })
    }

    /// Whether the trim, as a second use of an edge, runs against it; `None` where it is not one.
    fn turned(&self, model: &Model, edge: &Edge, uncertainty: f64) -> Option<bool> {
        let [first] = &edge.uses[..] else { return None };
        let other = Self::new(&Sheet::new(model.surface(FaceId(first.face as u32))), &first.trim).ok()?;
        let length: f64 = other.places.windows(2).map(|pair| pair[0].distance(pair[1])).sum();
        let most = (NEAR * length).max(NEAR_UNCERTAINTIES * uncertainty);
        let is_near = |k: usize| other.distance(self.places[k * CHORDS / PLACES]) <= most;
        (0..=PLACES).all(is_near).then(|| {
            // The quarters tell the way around a closed edge, too.
            let apart = |along: [usize; 3], against: [usize; 3]| -> f64 {
                along.iter().zip(against).map(|(a, b)| self.places[*a].distance(other.places[b])).sum()
            };
            let places = [0, CHORDS / 4, CHORDS];
            apart(places, places.map(|k| CHORDS - k)) < apart(places, places)
        })
    }

    /// The distance of a point from the chords.
    fn distance(&self, p: DVec3) -> f64 {
        let from_chord = |pair: &[DVec3]| {
            let (a, along) = (pair[0], pair[1] - pair[0]);
            let square = along.length_squared();
            let share = if square > 0.0 { ((p - a).dot(along) / square).clamp(0.0, 1.0) } else { 0.0 };
            p.distance(a + along * share)
        };
        self.places.windows(2).map(from_chord).fold(f64::INFINITY, f64::min)
    }
}

/// Numbers the vertices: an edge ends where the next of the loop begins. Returns their points.
fn vertices<'p>(edges: &mut [Edge], bounds: impl Iterator<Item = &'p Bound>) -> Vec<DVec3> {
    let mut ends = Groups::new(2 * edges.len());
    for Bound { uses, .. } in bounds {
        for (k, &(edge, number)) in uses.iter().enumerate() {
            let (next, next_number) = uses[(k + 1) % uses.len()];
            let leaves = 2 * edge + usize::from(edges[edge].uses[number].forward);
            let enters = 2 * next + usize::from(!edges[next].uses[next_number].forward);
            ends.join(leaves, enters);
        }
    }
    let (mut numbers, mut points): (BTreeMap<usize, usize>, Vec<DVec3>) = (BTreeMap::new(), vec![]);
    for (index, edge) in edges.iter_mut().enumerate() {
        let (start, end) = edge.space.curve.knots().domain();
        for (side, t) in [start, end].into_iter().enumerate() {
            edge.vertices[side] = *numbers.entry(ends.of(2 * index + side)).or_insert_with(|| {
                points.push(edge.space.curve.first_derivative(t)[0]);
                points.len() - 1
            });
        }
    }
    points
}

/// Disjoint sets (Tarjan 1975), by halving of paths.
struct Groups(Vec<usize>);

impl Groups {
    fn new(count: usize) -> Self {
        Self((0..count).collect())
    }

    fn of(&self, mut member: usize) -> usize {
        while self.0[member] != member {
            member = self.0[member];
        }
        member
    }

    fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.of(a), self.of(b));
        let (low, high) = (a.min(b), a.max(b));
        self.0[high] = low;
    }
}
