//! A model in triangles, each proven to be within an asked error of its surface, and watertight where the model is.
//!
//! 1. Every face is cut by lines of its parameters into cells whose triangles are near enough (`cells`).
//! 2. The curves that bound it get points at the lines and between (`side`), and the sides of a seam the same ones.
//! 3. Trims that the file names as one edge get the same points in space (`share`, `points`).
//! 4. Each cell is triangulated, under constraints where the border comes to it (`cell`). Corners that are one point, as
//!    all along a pole, leave no triangle.
//! 5. Edges of one triangle alone are counted (`count`): where borders coincide that the file does not name, there are
//!    such.
//!
//! Of the error, cells have 6 parts in 10 and chords of borders 3. What the model's own edges run apart comes on top, and
//! [`Facts`] says how far it is in all.

mod cell;
mod cells;
mod count;
mod points;
mod share;
mod side;

pub use count::Facts;

use crate::error::ExportError;
use cell::{Crossed, Triangulated, triangulate};
use cells::{Bounds, Plan};
use count::count;
use glam::{DVec2, DVec3};
use nurbs::Normal;
use points::Points;
use rayon::prelude::*;
use scene::{FaceId, Model};
use side::{Kind, Outline, outline, ranges};
use std::collections::HashMap;
use std::sync::atomic::{AtomicUsize, Ordering};

/// The most triangles that are made.
pub const GREATEST_TRIANGLES: usize = 1 << 22;

/// The shares of the error that the cells and the chords of the borders have.
const OF_CELLS: f64 = 0.6;
const OF_BORDERS: f64 = 0.3;

/// Where chords of a face cross, its borders' part of the error is divided by [`FINER`], so many times at most. Chords that still
/// cross are of trims that do, within the file's tolerance: they get a corner there that no neighbour has.
const ROUNDS: u32 = 2;
const FINER: f64 = 16.0;

/// A model in triangles.
#[derive(Debug, Clone, PartialEq)]
pub struct Mesh {
    /// Points in space, model units; each stands here once.
    pub points: Vec<DVec3>,
    /// The model's faces, in order.
    pub faces: Vec<FaceMesh>,
    /// What is known of all.
    pub facts: Facts,
}

/// A face in triangles.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct FaceMesh {
    /// The corners of its triangles.
    pub corners: Vec<Corner>,
    /// By number among the corners; counter-clockwise as seen from the face's normal.
    pub triangles: Vec<[u32; 3]>,
}

/// A corner: a point with the face's own normal there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Corner {
    /// Index in [`Mesh::points`].
    pub point: u32,
    /// The unit normal of the face's surface; the triangle's own where the surface has none, or only in the limit.
    pub normal: DVec3,
}

/// The model in triangles within `error` of it, model units. `progress` is told how many faces are done.
///
/// # Errors
/// [`ExportError::TooManyTriangles`] where they would be more than [`GREATEST_TRIANGLES`], before they are made.
pub fn mesh(model: &Model, error: f64, progress: &(dyn Fn(usize) + Sync)) -> Result<Mesh, ExportError> {
    let of_surfaces: Vec<Bounds> = model.surfaces().par_iter().map(Bounds::new).collect();
    let bounds: Vec<&Bounds> = model.faces().iter().map(|face| &of_surfaces[face.surface]).collect();
    let ids: Vec<FaceId> = (0..model.faces().len()).map(|index| FaceId(index as u32)).collect();
    let plan = |id: &FaceId| Plan::new(bounds[id.0 as usize], ranges(model, *id), OF_CELLS * error);
    let plans: Vec<Plan> = ids.par_iter().map(plan).collect();
    let counts: Vec<f64> = plans.iter().zip(&bounds).map(|(plan, bounds)| plan.triangles(bounds)).collect();
    few_enough(model, error, &counts)?;
    let mut allowed = vec![OF_BORDERS * error; ids.len()];
    for round in 0..=ROUNDS {
        let outlines = ids.par_iter().map(|id| outline(model, *id, plans[id.0 as usize].grid(bounds[id.0 as usize])));
        let mut outlines: Vec<Outline> = outlines.collect();
        let borders = |outlines: &[Outline]| -> Vec<f64> {
            let of_face = |(face, outline): (usize, &Outline)| {
                let parts = |side: usize| {
                    let nodes = outline.sides[side].nodes.len();
                    (0..nodes - 1).map(|node| outline.parts(bounds[face], side, node, allowed[face])).sum::<f64>()
                };
                counts[face] + 2.0 * (0..outline.sides.len()).map(parts).sum::<f64>()
            };
            outlines.iter().enumerate().map(of_face).collect()
        };
        few_enough(model, error, &borders(&outlines))?;
        let mut points = Points::default();
        outlines.iter_mut().for_each(seams);
        share::share(&mut outlines, &bounds, &allowed, &mut points);
        for (face, outline) in outlines.iter_mut().enumerate() {
            refine(outline, bounds[face], allowed[face], &mut points);
        }
        let borders: Vec<Border> = outlines.iter().map(|outline| border(outline, &mut points)).collect();
        let (places, numbers) = points.settled();
        let done = AtomicUsize::new(0);
        let cut = |id: &FaceId| {
            let index = id.0 as usize;
            let Border { corners, chords, .. } = &borders[index];
            let cut = |may_split: bool| triangulate(&outlines[index].grid, corners.clone(), chords, may_split);
            let cut = cut(false).or_else(|Crossed| if round == ROUNDS { cut(true) } else { Err(Crossed) });
            progress(done.fetch_add(1, Ordering::Relaxed) + 1);
            cut
        };
        let cuts: Vec<Result<Triangulated, Crossed>> = ids.par_iter().map(cut).collect();
        let crossed: Vec<usize> = (0..ids.len()).filter(|face| cuts[*face].is_err()).collect();
        if round < ROUNDS && !crossed.is_empty() {
            crossed.iter().for_each(|face| allowed[*face] /= FINER);
            continue;
        }
        let faces = Faces { model, bounds: &bounds, plans: &plans, outlines: &outlines, borders: &borders };
        return Ok(faces.mesh(cuts, places, &numbers));
    }
    unreachable!("the last round returns")
}

/// # Errors
/// [`ExportError::TooManyTriangles`].
fn few_enough(model: &Model, error: f64, counts: &[f64]) -> Result<(), ExportError> {
    let needed: f64 = counts.iter().sum();
    if needed <= GREATEST_TRIANGLES as f64 {
        return Ok(());
    }
    let most = (0..counts.len()).max_by(|a, b| counts[*a].total_cmp(&counts[*b])).expect("a model has a face");
    let face = model.number_in_file(FaceId(most as u32));
    Err(ExportError::TooManyTriangles { error, face, needed, limit: GREATEST_TRIANGLES })
}

/// Gives both sides of each seam points at the same parameters.
fn seams(outline: &mut Outline) {
    for axis in [0, 1] {
        let sides: Vec<usize> =
            (0..outline.sides.len()).filter(|k| outline.sides[*k].kind == Kind::Seam(axis)).collect();
        let nodes = sides.iter().flat_map(|side| &outline.sides[*side].nodes);
        let mut values: Vec<f64> = nodes.map(|node| node.uv[1 - axis]).collect();
        values.sort_by(f64::total_cmp);
        values.dedup();
        sides.iter().for_each(|side| outline.insert_along(*side, 1 - axis, &values));
    }
}

/// Puts as many points on curves that no edge shares as their chords need; an edge's have them already.
fn refine(outline: &mut Outline, bounds: &Bounds, allowed: f64, points: &mut Points) {
    for side in 0..outline.sides.len() {
        let nodes = outline.sides[side].nodes.clone();
        for (node, pair) in nodes.windows(2).enumerate().rev() {
            let parts = outline.parts(bounds, side, node, allowed);
            let step = (pair[1].s - pair[0].s) / parts;
            for k in 1..parts as usize {
                let s = pair[0].s + step * k as f64;
                let uv = outline.sides[side].curve.point(s);
                let point = points.add(outline.place(uv));
                outline.insert(side, s, point, points);
            }
        }
    }
}

/// The border of a face: corners, each once, the points that they are, and chords with material on their left.
struct Border {
    corners: Vec<DVec2>,
    points: Vec<usize>,
    chords: Vec<[u32; 2]>,
}

/// Names the corners of a border; those that are one point in space are joined.
fn border(outline: &Outline, points: &mut Points) -> Border {
    let mut found = Border { corners: vec![], points: vec![], chords: vec![] };
    let (mut known, mut across) = (Near::new(outline), HashMap::<[u64; 2], usize>::new());
    let bits = |uv: DVec2| (uv + DVec2::ZERO).to_array().map(f64::to_bits);
    for side in &outline.sides {
        let mut last: Option<u32> = None;
        for node in &side.nodes {
            let own = known.get(node.uv, &found.corners).unwrap_or_else(|| {
                let point = node.point.unwrap_or_else(|| points.add(outline.place(node.uv)));
                found.corners.push(node.uv);
                found.points.push(point);
                found.corners.len() as u32 - 1
            });
            known.set(found.corners[own as usize], own);
            let point = found.points[own as usize];
            if let Some(other) = node.point {
                points.join(point, other);
            }
            // The two sides of a seam are one.
            let mut wrapped = found.corners[own as usize];
            for (axis, [start, end]) in outline.surface.domain().into_iter().enumerate() {
                if outline.closed[axis] && wrapped[axis] == end {
                    wrapped[axis] = start;
                }
            }
            let first = *across.entry(bits(wrapped)).or_insert(point);
            points.join(first, point);
            if let Some(last) = last.filter(|last| *last != own) {
                found.chords.push([last, own]);
                if side.kind == Kind::Point {
                    points.join(found.points[last as usize], point);
                }
            }
            last = Some(own);
        }
    }
    found
}

/// Corners by where they are: those next to each other are one.
struct Near {
    snap: DVec2,
    start: DVec2,
    /// By squares of twice the distance that is next.
    known: HashMap<[i64; 2], Vec<u32>>,
}

impl Near {
    fn new(outline: &Outline) -> Self {
        let start = outline.surface.domain().map(|[start, _]| start);
        Self { snap: outline.grid.snap.into(), start: start.into(), known: HashMap::new() }
    }

    fn square(&self, uv: DVec2) -> [i64; 2] {
        ((uv - self.start) / (2.0 * self.snap)).round().to_array().map(|k| k as i64)
    }

    fn get(&self, uv: DVec2, corners: &[DVec2]) -> Option<u32> {
        let [i, j] = self.square(uv);
        let beside = (i - 1..=i + 1).flat_map(|i| (j - 1..=j + 1).map(move |j| [i, j]));
        let mut near = beside.filter_map(|square| self.known.get(&square)).flatten();
        near.find(|corner| (corners[**corner as usize] - uv).abs().cmple(self.snap).all()).copied()
    }

    fn set(&mut self, uv: DVec2, corner: u32) {
        let square = self.square(uv);
        let own = self.known.entry(square).or_default();
        if !own.contains(&corner) {
            own.push(corner);
        }
    }
}

/// All that the triangles of a model are made of.
struct Faces<'a, 'm> {
    model: &'m Model,
    bounds: &'a [&'a Bounds],
    plans: &'a [Plan],
    outlines: &'a [Outline<'m>],
    borders: &'a [Border],
}

impl Faces<'_, '_> {
    /// The mesh of what each face was cut into; `numbers` says where among the `places` each point of a border is.
    fn mesh(&self, cuts: Vec<Result<Triangulated, Crossed>>, places: Vec<DVec3>, numbers: &[u32]) -> Mesh {
        let mut points = places;
        let mut firsts = vec![];
        for ((cut, border), outline) in cuts.iter().zip(self.borders).zip(self.outlines) {
            firsts.push(points.len() as u32);
            if let Ok(cut) = cut {
                points.extend(cut.corners[border.corners.len()..].iter().map(|uv| outline.place(*uv)));
            }
        }
        let face = |(index, cut): (usize, &Result<Triangulated, Crossed>)| match cut {
            Ok(cut) => {
                let border = &self.borders[index].points;
                let point = |corner: u32| {
                    if let Some(point) = border.get(corner as usize) {
                        return numbers[*point];
                    }
                    let own = firsts[index] + corner - border.len() as u32;
                    // Trims that meet cross next to where they do: it is one point.
                    let next = cut.beside.get(&corner).and_then(|next| border.get(*next as usize));
                    let next = next.map(|point| numbers[*point]);
                    next.filter(|next| self.is_one(index, points[*next as usize], points[own as usize])).unwrap_or(own)
                };
                self.face(index, cut, &points, &point)
            }
            Err(Crossed) => FaceMesh::default(),
        };
        let faces: Vec<FaceMesh> = cuts.par_iter().enumerate().map(face).collect();
        let mut facts = self.facts(&cuts, &faces, &points, numbers);
        let lost = (0..faces.len()).filter(|face| faces[*face].triangles.is_empty());
        facts.left_out = lost.map(|face| self.model.number_in_file(FaceId(face as u32))).collect();
        Mesh { points, faces, facts }
    }

    /// Whether two places on a face are one, by its tolerance.
    fn is_one(&self, index: usize, a: DVec3, b: DVec3) -> bool {
        let size = self.outlines[index].surface.hull().diagonal();
        a.distance(b) <= self.model.faces()[index].tolerance.max(side::POINT * size)
    }

    /// A face's corners with their normals, and its triangles turned as the face is; none with two corners in one point.
    fn face(
        &self,
        index: usize,
        cut: &Triangulated,
        points: &[DVec3],
        point: &(dyn Fn(u32) -> u32 + Sync),
    ) -> FaceMesh {
        let (surface, is_reversed) = (self.outlines[index].surface, self.model.faces()[index].reversed);
        let mut own = FaceMesh::default();
        // Corner of the domain to corner of the mesh, where the surface has a normal of its own.
        let mut known: HashMap<u32, Option<u32>> = HashMap::new();
        for triangle in &cut.triangles {
            let [a, b, c] = *triangle;
            let triangle = if is_reversed { [a, c, b] } else { [a, b, c] };
            let [a, b, c] = triangle.map(point);
            if a == b || b == c || c == a {
                continue;
            }
            let [p, q, r] = [a, b, c].map(|point| points[point as usize]);
            let flat = (q - p).cross(r - p).normalize_or_zero();
            let corners = triangle.map(|corner| {
                let regular = *known.entry(corner).or_insert_with(|| {
                    let uv = cut.corners[corner as usize];
                    match surface.inspect(uv.x, uv.y).normal {
                        Normal::Regular(normal) => {
                            let normal = if is_reversed { -normal } else { normal };
                            own.corners.push(Corner { point: point(corner), normal });
                            Some(own.corners.len() as u32 - 1)
                        }
                        _ => None,
                    }
                });
                regular.unwrap_or_else(|| {
                    own.corners.push(Corner { point: point(corner), normal: flat });
                    own.corners.len() as u32 - 1
                })
            });
            own.triangles.push(corners);
        }
        own
    }

    fn facts(
        &self,
        cuts: &[Result<Triangulated, Crossed>],
        faces: &[FaceMesh],
        points: &[DVec3],
        numbers: &[u32],
    ) -> Facts {
        let all = faces.iter().flat_map(|face| {
            face.triangles.iter().map(|triangle| triangle.map(|corner| face.corners[corner as usize].point))
        });
        let (open, non_manifold, euler) = count(all);
        let [mut distance, mut border, mut moved] = [0.0f64; 3];
        for (index, outline) in
            self.outlines.iter().enumerate().filter(|(index, _)| !faces[*index].triangles.is_empty())
        {
            let Border { corners, points: own, .. } = &self.borders[index];
            let off = corners.iter().zip(own).map(|(uv, p)| outline.place(*uv).distance(points[numbers[*p] as usize]));
            // Corners that were put into the one next to them.
            let crossings = cuts[index].iter().flat_map(|cut| cut.beside.iter().map(move |(at, next)| (cut, at, next)));
            let crossed = crossings.filter_map(|(cut, at, next)| {
                let next = points[numbers[*own.get(*next as usize)?] as usize];
                let place = outline.place(cut.corners[*at as usize]);
                self.is_one(index, next, place).then(|| next.distance(place))
            });
            let off = off.chain(crossed).fold(0.0, f64::max);
            let bows = outline.sides.iter().enumerate().flat_map(|(side, own)| {
                (0..own.nodes.len() - 1).map(move |node| outline.bow(self.bounds[index], side, node))
            });
            let near = self.plans[index].chord + off;
            distance = distance.max(near);
            border = border.max(near + bows.fold(0.0, f64::max));
            moved = moved.max(off);
        }
        let triangles = faces.iter().map(|face| face.triangles.len()).sum();
        Facts { triangles, distance, border, moved, open, non_manifold, euler, left_out: vec![] }
    }
}
