//! The oracle: a ray caster in f64 that finds every point of a NURBS surface on a ray, or says that it could not tell.
//!
//! Data come from `scene` (models, rays, cameras) and go to `gbuffer` (hits). Surfaces are cut into nearly flat Bézier
//! pieces; a box tree in f32 culls them, never wrongly; inside a piece the ray is two planes, and all common
//! roots of the two distances are isolated by sign and uniqueness proofs; each root is finished on the
//! un-extracted surface. Nothing is shared with the fragment programs that this crate judges.
//!
//! # Accuracy
//! A point counts as on the ray within 3 ((4 (p + q) + 3 (p + q) L + 6) u (r + f) + 12 u e): u = 2⁻⁵³, L ≤ 3 the
//! halvings of a patch, r the radius of the surface's control points about the centre of their box, f the ray's
//! distance from that centre, e the eye's (`pieces.rs` and `line.rs` derive the terms). That is at most
//! 252 u (r + f) + 36 u e for a bicubic surface; [`Caster::residual_bound`] gives the number. Where parameters are too
//! coarse for that, the way on the surface of 5 ulp of them comes on top. Typical residuals are a few ulp of the size.
//! No point beyond the bound is reported, and none within a third of it is passed over in silence: it is a hit, part of
//! a hit's run along the ray, or undecided.
//!
//! A root is a hit of the faces of its surface that have material there ([`Classifier`]), edges included; the others are
//! trimmed away.
//!
//! # Examples
//! ```
//! use glam::DVec3;
//! use nurbs::{KnotVector, Surface};
//! use raycast::Caster;
//! use scene::{Model, Ray};
//!
//! let knots = KnotVector::new(1, vec![0.0, 0.0, 1.0, 1.0])?;
//! let points = vec![DVec3::ZERO, DVec3::Y, DVec3::X, DVec3::X + DVec3::Y];
//! let model = Model::of_surfaces("square", vec![Surface::new(knots.clone(), knots, points, None)?])?;
//! let ray = Ray { origin: DVec3::new(0.25, 0.5, 3.0), direction: DVec3::NEG_Z, near: 0.0 };
//! let hit = Caster::new(&model).first(&ray).hit.expect("the ray meets the square");
//! assert!((hit.t - 3.0).abs() < 1e-12 && (hit.uv.x - 0.25).abs() < 1e-12);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod edge;
mod faces;
mod line;
mod pieces;
mod roots;
mod tree;
mod tree_2d;
mod trim;

use faces::Faces;
use gbuffer::{GBuffer, Hit, LocalParameters, Meta, PrincipalCurvatures};
use glam::DVec2;
use line::{Line, Point, normals};
use nurbs::{Direction, Normal};
use pieces::{Body, Piece, Pieces};
use rayon::prelude::*;
use roots::{Found, Search};
use scene::{Camera, FaceId, Model, Ray, Viewport};
use std::cell::{LazyCell, RefCell};
use tree::Tree;
pub use trim::{Classifier, PictureMap, Side};

/// Twice the distance at which a point counts as on the ray: two faces' points may be that far apart.
const EDGE_BOUNDS: f64 = 2.0;

/// Rows of a picture that are cast together, so that only these rows' hits are held twice.
const BAND: usize = 64;

/// Casts rays at a model. Built once; `Sync`, and the same answers from every thread and every build.
pub struct Caster<'m> {
    model: &'m Model,
    pieces: Pieces,
    tree: Tree,
    /// Of the faces that are trimmed.
    classifiers: Vec<Option<Classifier>>,
    /// Of each body, where its faces are.
    faces: Vec<Faces>,
    edges: bool,
}

/// What is first on a ray.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cast {
    /// The nearest hit with t ≥ `near`.
    pub hit: Option<Hit>,
    /// Something as near or nearer that could neither be shown to be a hit nor excluded.
    pub undecided: Option<Undecided>,
}

/// All hits of a ray.
#[derive(Debug, Clone, PartialEq)]
pub struct AllHits {
    /// Hits with t ≥ `near`, by (t, face). One for each point, although pieces share borders and closed surfaces
    /// meet themselves at a seam; a run of a ray inside a surface is one hit, its first point as far as found.
    pub hits: Vec<Hit>,
    /// What could not be decided; empty where the list of hits is proven complete.
    pub undecided: Vec<Undecided>,
    /// Parameter boxes that were examined.
    pub boxes: u64,
}

/// A box of parameters in which a hit could not be excluded.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Undecided {
    /// The face.
    pub face: FaceId,
    /// Least parameters of the box.
    pub uv_low: DVec2,
    /// Greatest parameters of the box.
    pub uv_high: DVec2,
    /// Least distance from the ray that was found in the box, model units.
    pub distance: f64,
    /// Distance along the ray of the point where it was found, model units.
    pub t: f64,
    /// Why the search ended there.
    pub limit: Limit,
}

/// Why a search ended without a decision.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Limit {
    /// The polynomials cannot be told from zero in f64, yet no point was found close enough to count.
    Rounding,
    /// The box is as small as parameters allow.
    Depth,
    /// The piece took more boxes than allowed.
    Boxes,
}

thread_local! {
    static SEARCH: RefCell<Search> = RefCell::new(Search::default());
}

impl<'m> Caster<'m> {
    /// Cuts the surfaces and builds the tree: about 0.7 kB a bicubic piece, at most 150 MB unless the patches
    /// themselves are more than 100,000.
    pub fn new(model: &'m Model) -> Self {
        let pieces = Pieces::new(model);
        let tree = Tree::new(&pieces);
        let region = |id: usize| model.trimmed_region(FaceId(id as u32));
        let classifiers: Vec<Option<Classifier>> =
            (0..model.faces().len()).into_par_iter().map(|id| region(id).map(Classifier::new)).collect();
        let classifier = |face: u32| classifiers[face as usize].as_ref();
        let faces = pieces.bodies.iter().map(|body| Faces::new(&body.faces, classifier)).collect();
        Self { model, pieces, tree, classifiers, faces, edges: false }
    }

    /// The same, by which [`Self::render`] enters the trim edge that passes by each pixel, or (`false`) does not.
    pub fn with_edges(self, edges: bool) -> Self {
        Self { edges, ..self }
    }

    /// Number of pieces that the surfaces were cut into.
    pub fn piece_count(&self) -> usize {
        self.pieces.pieces.len()
    }

    /// The model.
    pub fn model(&self) -> &'m Model {
        self.model
    }

    /// The distance from `ray`, in model units, below which a point of `face` counts as on it.
    ///
    /// # Panics
    /// Where the model has no such face.
    pub fn residual_bound(&self, ray: &Ray, face: FaceId) -> f64 {
        let body = self.body_of(face);
        Line::new(ray, normals(ray.direction), body).tolerance * body.scale
    }

    /// The nearest hit with t ≥ `ray.near`; of equal ones that with the least face, then u, then v.
    ///
    /// A ray whose numbers are not finite hits nothing.
    pub fn first(&self, ray: &Ray) -> Cast {
        let mut best: Option<(Point, u32)> = None;
        let mut doubt: Option<Undecided> = None;
        self.walk(ray, |body, outcome| {
            match outcome {
                Ok(point) if point.t >= ray.near && best.as_ref().is_none_or(|(old, _)| point.t <= old.t) => {
                    let key = |(point, face): &(Point, u32)| (point.t, *face, point.uv.x, point.uv.y);
                    let found = self.material_faces(ray, body, point.uv).next().map(|face| (point, face));
                    best = match (found, best) {
                        (Some(found), Some(old)) if key(&found) < key(&old) => Some(found),
                        (found, old) => old.or(found),
                    };
                }
                Err(undecided)
                    if undecided.t >= ray.near
                        && doubt.is_none_or(|old| undecided.t < old.t)
                        && self.may_be_material(body, &undecided) =>
                {
                    doubt = Some(undecided);
                }
                _ => {}
            }
            best.map_or(f64::INFINITY, |(point, _)| point.t)
        });
        let hit = best.map(|(point, face)| self.hit(FaceId(face), &point));
        Cast { hit, undecided: doubt.filter(|doubt| hit.is_none_or(|hit| doubt.t <= hit.t)) }
    }

    /// Every hit with t ≥ `ray.near`.
    ///
    /// A ray whose numbers are not finite hits nothing.
    pub fn all(&self, ray: &Ray) -> AllHits {
        let mut found: Vec<(Point, u32)> = vec![];
        let mut undecided = vec![];
        let boxes = self.walk(ray, |body, outcome| {
            match outcome {
                Ok(point) if point.t >= ray.near => found.push((point, body.faces[0])),
                Err(doubt) if doubt.t >= ray.near && self.may_be_material(body, &doubt) => undecided.push(doubt),
                _ => {}
            }
            f64::INFINITY
        });
        found.sort_by(|(a, f), (b, g)| {
            a.t.total_cmp(&b.t).then(f.cmp(g)).then(a.uv.x.total_cmp(&b.uv.x)).then(a.uv.y.total_cmp(&b.uv.y))
        });
        let mut kept: Vec<(Point, u32)> = vec![];
        for (point, face) in found {
            let body = self.body_of(FaceId(face));
            let line = Line::new(ray, normals(ray.direction), body);
            match kept.iter_mut().find(|(old, other)| *other == face && same(body, &line, old, &point)) {
                Some((old, _)) => old.leaves = later(old.leaves, point.leaves),
                None => kept.push((point, face)),
            }
        }
        let mut hits = vec![];
        for (point, face) in kept {
            for face in self.material_faces(ray, self.body_of(FaceId(face)), point.uv) {
                hits.push(self.hit(FaceId(face), &point));
            }
        }
        hits.sort_by(|a, b| a.t.total_cmp(&b.t).then(a.face.cmp(&b.face)));
        undecided.sort_by(|a, b| a.t.total_cmp(&b.t).then(a.face.cmp(&b.face)));
        AllHits { hits, undecided, boxes }
    }

    /// Casts a ray through the centre of every pixel, rows in parallel; `progress` is told of each finished row.
    pub fn render(&self, camera: &Camera, viewport: Viewport, progress: &(dyn Fn(usize) + Sync)) -> GBuffer {
        let undecided = RefCell::new(vec![]);
        let cast_row = |y: usize| {
            let mut doubts = vec![];
            let row: Vec<Option<Hit>> = (0..viewport.width())
                .map(|x| {
                    let cast = self.first(&camera.ray(viewport, x as f64 + 0.5, y as f64 + 0.5));
                    doubts.extend(cast.undecided.map(|_| (x, y)));
                    let center = DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
                    let edge = |hit: &Hit| {
                        let classifier = self.classifiers[hit.face.0 as usize].as_ref()?;
                        edge::offset(classifier, self.model.surface(hit.face), hit.uv, camera, viewport, center)
                    };
                    cast.hit.map(|hit| Hit { edge: self.edges.then(|| edge(&hit)).flatten(), ..hit })
                })
                .collect();
            progress(1);
            (row, doubts)
        };
        let rows = (0..viewport.height()).step_by(BAND).flat_map(|top| {
            let bottom = viewport.height().min(top + BAND);
            let (rows, doubts): (Vec<_>, Vec<_>) = (top..bottom).into_par_iter().map(cast_row).unzip();
            undecided.borrow_mut().extend(doubts.into_iter().flatten());
            rows
        });
        let buffer = GBuffer::from_rows(viewport, Meta::new("raycast", "rays", self.model, camera), rows);
        buffer.with_undecided(undecided.into_inner()).with_edges(self.edges)
    }

    /// The hit of a face at a point of its body: position, normal and curvature by `Surface::inspect_local`.
    fn hit(&self, face: FaceId, found: &Point) -> Hit {
        let reversed = self.model.faces()[face.0 as usize].reversed;
        let point = self.model.surface(face).inspect_local(found.span, found.local);
        let span = self.body_of(face).span_number(found.span);
        let (uv, t, local) = (found.uv, found.t, Some(LocalParameters { span, uv: found.local }));
        let curvature = point.curvature.map(|c| PrincipalCurvatures { k1: c.k1, k2: c.k2 });
        let (normal, curvature) = if reversed {
            let normal = match point.normal {
                Normal::Regular(n) => Normal::Regular(-n),
                Normal::Limit(n) => Normal::Limit(-n),
                Normal::Undefined => Normal::Undefined,
            };
            (normal, curvature.map(PrincipalCurvatures::reversed))
        } else {
            (point.normal, curvature)
        };
        Hit { face, uv, local, t, position: point.derivatives.s, normal, curvature, edge: None }
    }

    /// The faces of a body that have material at parameters `uv`, ascending: a trim edge within [`EDGE_BOUNDS`] times the
    /// distance at which a point counts as on the ray is material, so that a ray at an edge that two faces share meets one.
    fn material_faces<'a>(&'a self, ray: &'a Ray, body: &'a Body, uv: DVec2) -> impl Iterator<Item = u32> + 'a {
        // Seldom wanted: most points are well inside of a face.
        let metric = LazyCell::new(move || {
            let d = body.surface.first_derivatives(uv.x, uv.y);
            let reach = EDGE_BOUNDS * Line::new(ray, normals(ray.direction), body).tolerance;
            (DVec2::new(d.su.length(), d.sv.length()), reach)
        });
        let faces = self.faces[body.index].near(|| {
            let (speeds, reach) = *metric;
            [uv - reach / speeds, uv + reach / speeds]
        });
        let is_material = move |face: &u32| {
            self.classifiers[*face as usize].as_ref().is_none_or(|classifier| {
                classifier.inside(uv) || {
                    let (speeds, reach) = *metric;
                    classifier.is_at_edge(uv, speeds, reach)
                }
            })
        };
        (0..faces.len()).map(move |k| faces[k]).filter(is_material)
    }

    /// Whether some face of a body has material in a box of parameters, as far as the distance of the edges tells.
    fn may_be_material(&self, body: &Body, Undecided { uv_low, uv_high, .. }: &Undecided) -> bool {
        let (middle, half) = (0.5 * (*uv_low + *uv_high), 0.5 * (*uv_high - *uv_low));
        let reach = DVec2::splat(half.length());
        self.faces[body.index].near(|| [middle - reach, middle + reach]).iter().any(|&face| {
            self.classifiers[face as usize].as_ref().is_none_or(|classifier| {
                let side = classifier.side(middle, DVec2::ONE);
                side.inside || side.distance <= half.length()
            })
        })
    }

    fn body_of(&self, face: FaceId) -> &Body {
        let surface = self.model.faces()[face.0 as usize].surface;
        &self.pieces.bodies[self.pieces.body_of_surface[surface] as usize]
    }

    /// Searches every piece that the ray may meet; `visit` takes each outcome and returns the distance beyond which
    /// nothing is wanted. Returns the number of boxes examined.
    fn walk(&self, ray: &Ray, mut visit: impl FnMut(&Body, Result<Point, Undecided>) -> f64) -> u64 {
        if !(ray.origin.is_finite() && ray.direction.is_finite()) {
            return 0;
        }
        let normals = normals(ray.direction);
        let mut wanted = f64::INFINITY;
        SEARCH.with_borrow_mut(|search| {
            let before = search.boxes;
            self.tree.visit(ray, |index| {
                let piece = &self.pieces.pieces[index];
                let body = &self.pieces.bodies[piece.body as usize];
                let line = Line::new(ray, normals, body);
                line.search(body, piece, self.pieces.control(piece), search);
                for found in &search.found {
                    match line.resolve(body, piece, found, ray.near) {
                        Some(Ok(point)) => wanted = visit(body, Ok(point)),
                        Some(Err(point)) => wanted = visit(body, Err(undecided(body, piece, found, &point))),
                        None => {}
                    }
                }
                wanted
            });
            search.boxes - before
        })
    }
}

/// What is told of a finding that did not become a hit.
fn undecided(body: &Body, piece: &Piece, found: &Found, nearest: &Point) -> Undecided {
    let (low, high, limit) = match *found {
        Found::Root(x) => (x, x, Limit::Rounding),
        Found::Tangent { low, high, .. } => (low, high, Limit::Rounding),
        Found::Unresolved { low, high, deepest } => (low, high, if deepest { Limit::Depth } else { Limit::Boxes }),
    };
    let [[u0, u1], [v0, v1]] = piece.domain;
    let local = |x: DVec2| DVec2::new(u0 + (u1 - u0) * x.x, v0 + (v1 - v0) * x.y);
    let at = |x: DVec2| body.parameters(piece.span, local(x));
    Undecided {
        face: FaceId(body.faces[0]),
        uv_low: at(low),
        uv_high: at(high),
        distance: nearest.residual * body.scale,
        t: nearest.t,
        limit,
    }
}

/// Whether two roots of a face, `a` the nearer one, are one.
fn same(body: &Body, line: &Line, a: &Point, b: &Point) -> bool {
    // Two runs along the ray that share a distance share the point there.
    let slack = 2.0 * line.tolerance * body.scale + 4.0 * f64::EPSILON * b.t.abs();
    let overlap = a.leaves.is_some_and(|leaves| b.leaves.is_some() && b.t <= leaves + slack);
    overlap || line.joined(body, a.uv, b.uv) || meet_at_seam(body, line, a, b)
}

/// Whether two roots are one point of a seam: the same place, on opposite sides of the domain.
fn meet_at_seam(body: &Body, line: &Line, a: &Point, b: &Point) -> bool {
    let opposite =
        [(Direction::U, a.uv.x, b.uv.x), (Direction::V, a.uv.y, b.uv.y)].into_iter().any(|(direction, a, b)| {
            let (start, end) = body.surface.knots(direction).domain();
            (a == start && b == end) || (a == end && b == start)
        });
    opposite && body.surface.point(a.uv.x, a.uv.y).distance(body.surface.point(b.uv.x, b.uv.y)) <= 4.0 * line.tolerance
}

/// The greater of two distances that may be absent.
fn later(a: Option<f64>, b: Option<f64>) -> Option<f64> {
    match (a, b) {
        (Some(a), Some(b)) => Some(a.max(b)),
        (a, b) => a.or(b),
    }
}
