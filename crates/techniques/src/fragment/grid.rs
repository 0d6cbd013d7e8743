//! The corners of a tessellation: a grid a span, with a skirt where loops bound the face.

use super::cells::Cells;
use super::joints::{Foreign, Fraction, Joints, Site, lines};
use crate::triangles::{BEYOND, STEEPEST, cell};
use glam::{DVec2, DVec3};
use nurbs::{Direction, FirstDerivatives};
use pipeline::{PackedScene, Parameters, SEARCHED, Vertex};
use scene::{Camera, FaceId, Model, Projection, Region};
use std::ops::Range;

/// The corners of a part of a face: a grid of them.
pub(super) struct Grid {
    span: [u32; 2],
    /// Parameters of the corners, u outer; those of a skirt lie beyond the domain.
    corners: Vec<[f32; 2]>,
    /// How many corners a row in v has.
    pub(super) columns: usize,
}

/// What a bounded face goes on by beyond its border.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Skirt {
    /// Who sees it.
    pub(super) camera: Camera,
    /// Model units.
    pub(super) width: f64,
}

impl Skirt {
    /// The way from a border's point `s`, as the camera sees it straight away from the border, whose tangent is `along`; to the
    /// side to which `out` leads. None from a collapsed border, nor from one that is seen end-on.
    ///
    /// In depth it goes as the surface goes on the way in, up to where that is seen under [`STEEPEST`]: a pixel of a
    /// skirt shows what lies there, and of two faces that meet at a border the one stays in front.
    fn way(&self, s: DVec3, along: DVec3, out: DVec3) -> DVec3 {
        let sight = match self.camera.projection() {
            Projection::Perspective { .. } => s - self.camera.eye(),
            Projection::Orthographic { .. } => self.camera.forward(),
        };
        let (sight, along) = (sight.normalize_or_zero(), along.normalize_or_zero());
        let across = sight.cross(along).normalize_or_zero();
        if across == DVec3::ZERO {
            return across;
        }
        let across = if across.dot(out) < 0.0 { -across } else { across };
        let straight = (out - along * out.dot(along)).normalize_or_zero();
        self.width * (across - sight * (straight.dot(sight) / straight.dot(across).max(f64::from(STEEPEST))))
    }
}

/// The grids of a face's spans, with a skirt where loops bound it.
pub(super) fn grids_of_spans(
    breaks: &[Vec<f64>; 2],
    cells: &[Vec<Vec<usize>>; 2],
    spans: &[Range<usize>; 2],
    region: Option<&Region>,
) -> Vec<Grid> {
    let lines = |parts: &Vec<usize>| lines(parts).into_iter().map(Fraction::value).collect::<Vec<f32>>();
    let [rows, columns] = [0, 1].map(|k| cells[k][spans[k].clone()].iter().map(lines).collect::<Vec<_>>());
    let mut grids = Vec::with_capacity(rows.len() * columns.len());
    for (k, u) in spans[0].clone().zip(&rows) {
        for (l, v) in spans[1].clone().zip(&columns) {
            let span = [k as u32, l as u32];
            grids.push(match region {
                None => Grid::new(span, u, v),
                Some(region) => Grid::with_skirt(span, [u, v], breaks, region),
            });
        }
    }
    grids
}

impl Site {
    /// Moves a vertex to where all faces have it that share it.
    pub(super) fn place(&self, model: &Model, scene: &PackedScene, vertex: &mut Vertex) {
        let uv = Place::new(model, scene, self.face, self.at).uv;
        let s = model.surface(FaceId(self.face as u32)).first_derivatives(uv.x, uv.y).s;
        (vertex.position, vertex.frame) = (scene.frames()[self.face].local(s), self.face as u32);
    }
}

impl Grid {
    pub(super) fn new(span: [u32; 2], u: &[f32], v: &[f32]) -> Self {
        let corners = u.iter().flat_map(|&s| v.iter().map(move |&t| [s, t])).collect();
        Self { span, corners, columns: v.len() }
    }

    /// A grid that goes on beyond the sides of the domain into whose cells the region comes.
    fn with_skirt(span: [u32; 2], lines: [&[f32]; 2], breaks: &[Vec<f64>; 2], region: &Region) -> Self {
        let hull = region.hull();
        let ends = [0, 1].map(|k| [breaks[k][span[k] as usize], breaks[k][span[k] as usize + 1]]);
        let at = |k: usize, t: f32| ends[k][0] + (ends[k][1] - ends[k][0]) * f64::from(t);
        let places = |k: usize| -> Vec<f32> {
            let lines = lines[k];
            let is_first = span[k] == 0;
            let is_last = span[k] as usize + 2 == breaks[k].len();
            let before = (is_first && hull.min[k] <= at(k, lines[1])).then_some(-BEYOND);
            let after = (is_last && hull.max[k] >= at(k, lines[lines.len() - 2])).then_some(1.0 + BEYOND);
            before.into_iter().chain(lines.iter().copied()).chain(after).collect()
        };
        Self::new(span, &places(0), &places(1))
    }

    pub(super) fn rows(&self) -> usize {
        self.corners.len() / self.columns
    }

    /// Calls with the row and the column of each cell.
    fn cells(&self, mut call: impl FnMut([usize; 2])) {
        (0..self.rows() - 1).for_each(|i| (0..self.columns - 1).for_each(|j| call([i, j])));
    }

    /// The corners of a cell's two triangles, where the grid's are `first` and those that follow.
    fn triangles(&self, first: u32, [row, column]: [usize; 2]) -> [u32; 6] {
        cell(first + (row * self.columns + column) as u32, self.columns as u32)
    }
}

/// The triangles of one face.
#[derive(Default)]
pub(super) struct FaceMesh {
    pub(super) vertices: Vec<Vertex>,
    /// Three a triangle, from the face's first vertex on.
    pub(super) indices: Vec<u32>,
    /// The corners that are evaluated where all faces do that share them, by their places among the vertices.
    pub(super) shared: Vec<(u32, Site)>,
}

/// The triangles of a face: two a cell of its grids; where another face cuts a cell's side, a fan about the cell's middle.
///
/// `foreign` are the corners that other faces have on each border.
pub(super) fn mesh(
    model: &Model,
    scene: &PackedScene,
    id: usize,
    (grids, skirt): (&[Grid], Option<&Skirt>),
    joints: &Joints,
    foreign: &[Foreign],
    cells: &Cells,
) -> FaceMesh {
    let surface = model.surface(FaceId(id as u32));
    let corners = grids.iter().map(|grid| grid.corners.len()).sum();
    let mut mesh = FaceMesh { vertices: Vec::with_capacity(corners), indices: vec![], shared: vec![] };
    let mut evaluated = vec![];
    for grid in grids {
        let places = grid.corners.iter().map(|&uv| Place::new(model, scene, id, Parameters { span: grid.span, uv }));
        let places: Vec<Place> = places.collect();
        evaluated.clear();
        surface.evaluate_many(&places.iter().map(|place| place.uv).collect::<Vec<_>>(), &mut evaluated);
        let known = places.iter().zip(&evaluated);
        mesh.vertices.extend(known.map(|(place, known)| place.vertex(model, scene, id, known.derivatives, skirt)));
    }
    let mut first = 0;
    for grid in grids {
        let sides = std::array::from_fn(|side| joints.border(id, grid.span, side));
        match cells {
            Cells::OfSpans(counts) if sides.iter().any(Option::is_some) => {
                let lines = [0, 1].map(|k| lines(&counts[k][grid.span[k] as usize]));
                let vertex = |uv| corner(model, scene, id, Parameters { span: grid.span, uv }, skirt);
                mesh.stitch(grid, first, (joints, &sides, foreign), &lines, vertex);
            }
            _ => grid.cells(|at| mesh.indices.extend(grid.triangles(first, at))),
        }
        first += grid.corners.len() as u32;
    }
    for &(number, site) in &mesh.shared {
        site.place(model, scene, &mut mesh.vertices[number as usize]);
    }
    mesh
}

impl FaceMesh {
    /// Appends the triangles of a grid with borders along some of its sides, whose corners are `first` and those that follow.
    fn stitch(
        &mut self,
        grid: &Grid,
        first: u32,
        (joints, sides, foreign): (&Joints, &[Option<usize>; 4], &[Foreign]),
        lines: &[Vec<Fraction>; 2],
        vertex: impl Fn([f32; 2]) -> Vertex,
    ) {
        let [rows, columns] = [grid.rows(), grid.columns];
        let mut between: [Vec<Vec<u32>>; 4] = Default::default();
        for (side, border) in (0..4).zip(sides).filter_map(|(side, border)| Some((side, (*border)?))) {
            let (along, end) = (1 - side / 2, side % 2);
            for (k, line) in lines[along].iter().enumerate() {
                let [i, j] = if side < 2 { [end * (rows - 1), k] } else { [k, end * (columns - 1)] };
                self.shared.push((first + (i * columns + j) as u32, joints.site(border, *line)));
            }
            let mut of_cell = |places: &Vec<Fraction>| {
                let append = |place: &Fraction| {
                    let mut uv = [end as f32; 2];
                    uv[along] = place.value();
                    let number = self.vertices.len() as u32;
                    self.vertices.push(vertex(uv));
                    self.shared.push((number, joints.site(border, *place)));
                    number
                };
                places.iter().map(append).collect()
            };
            between[side] = foreign[border].iter().map(&mut of_cell).collect();
        }
        grid.cells(|[i, j]| {
            let on = |side: usize, is_there: bool, k: usize| -> &[u32] {
                between[side].get(k).filter(|_| is_there).map_or(&[], Vec::as_slice)
            };
            // In the order in which the cell's outline runs.
            let [v0, u1] = [on(2, j == 0, i), on(1, i + 2 == rows, j)];
            let [v1, u0] = [on(3, j + 2 == columns, i), on(0, i == 0, j)];
            let [a, b, c, _, _, d] = grid.triangles(first, [i, j]);
            if [v0, u1, v1, u0].iter().all(|side| side.is_empty()) {
                self.indices.extend([a, b, c, a, c, d]);
                return;
            }
            let middle = self.vertices.len() as u32;
            let [low, high] = [grid.corners[i * columns + j], grid.corners[(i + 1) * columns + j + 1]];
            self.vertices.push(vertex([0, 1].map(|k| 0.5 * (low[k] + high[k]))));
            let backwards = |side: &[u32]| side.iter().rev().copied().collect::<Vec<_>>();
            let outline = [&[a], v0, &[b], u1, &[c], &backwards(v1), &[d], &backwards(u0), &[a]].concat();
            self.indices.extend(outline.windows(2).flat_map(|ends| [middle, ends[0], ends[1]]));
        });
    }
}

/// A normal is taken from tangents that are longer, across the span, than this share of the face, and whose angle's sine is greater; else
/// from a closer look.
const CLEAR: f64 = 1e-9;

/// A vertex of a face, which has the skirt beyond its domain.
pub(super) fn corner(model: &Model, scene: &PackedScene, id: usize, at: Parameters, skirt: Option<&Skirt>) -> Vertex {
    let place = Place::new(model, scene, id, at);
    let d = model.surface(FaceId(id as u32)).first_derivatives(place.uv.x, place.uv.y);
    place.vertex(model, scene, id, d, skirt)
}

/// Where a vertex stands on its surface.
struct Place {
    at: Parameters,
    /// The nearest parameters of the domain.
    uv: DVec2,
    /// Where the span starts, and its size.
    start: DVec2,
    length: DVec2,
}

impl Place {
    fn new(model: &Model, scene: &PackedScene, id: usize, at: Parameters) -> Self {
        let border = at.uv.map(|t| t.clamp(0.0, 1.0));
        if at.span[0] == SEARCHED {
            let [[u0, u1], [v0, v1]] = model.surface(FaceId(id as u32)).domain();
            let (start, length) = (DVec2::new(u0, v0), DVec2::new(u1 - u0, v1 - v0));
            return Self { at, uv: start + length * DVec2::from_array(border.map(f64::from)), start, length };
        }
        let frame = &scene.frames()[id];
        let [u, v] = [0, 1].map(|k| frame.span(k, at.span[k]));
        let (start, length) = (DVec2::new(u[0], v[0]), DVec2::new(u[1] - u[0], v[1] - v[0]));
        Self { at, uv: frame.uv(at.span, border), start, length }
    }

    /// The derivatives of the span's own polynomial: at its end the surface's are those of the next span, which a crease has elsewhere.
    fn own(&self, model: &Model, id: usize, d: FirstDerivatives) -> FirstDerivatives {
        let is_at_end = self.at.uv.iter().any(|&t| t >= 1.0) && self.at.span[0] != SEARCHED;
        if !is_at_end {
            return d;
        }
        let surface = model.surface(FaceId(id as u32));
        let middle = self.start + 0.5 * self.length;
        let span = |direction, t| surface.knots(direction).find_span(t);
        let spans = [span(Direction::U, middle.x), span(Direction::V, middle.y)];
        // The point stays that of the corner on the next span, to the bit.
        FirstDerivatives { s: d.s, ..surface.first_derivatives_on(spans[0], spans[1], self.uv.x, self.uv.y) }
    }

    /// The vertex there, from the surface's point and tangents.
    fn vertex(
        &self,
        model: &Model,
        scene: &PackedScene,
        id: usize,
        d: FirstDerivatives,
        skirt: Option<&Skirt>,
    ) -> Vertex {
        let &Self { at, uv, length, .. } = self;
        let d = self.own(model, id, d);
        let frame = &scene.frames()[id];
        let cross = d.su.cross(d.sv);
        // On a side that is a point, rounding leaves a tangent of no direction.
        let shorter = (d.su.length() * length.x).min(d.sv.length() * length.y);
        let is_clear = shorter > CLEAR * frame.scale && cross.length() > CLEAR * d.su.length() * d.sv.length();
        let normal = match cross.try_normalize() {
            Some(n) if is_clear => n,
            _ => model.surface(FaceId(id as u32)).inspect(uv.x, uv.y).normal.unit().unwrap_or_default(),
        };
        let normal = if model.faces()[id].reversed { -normal } else { normal };
        let [u, v] = at.uv.map(|t| f64::from(t - t.clamp(0.0, 1.0)));
        let way = |beyond: f64, along: DVec3, out: DVec3| {
            skirt.filter(|_| beyond != 0.0).map_or(DVec3::ZERO, |skirt| skirt.way(d.s, along, out * beyond))
        };
        let position = d.s + way(u, d.sv, d.su) + way(v, d.su, d.sv);
        Vertex {
            position: frame.local(position),
            uv: at.uv,
            face: id as u32,
            span: at.span,
            normal: normal.to_array().map(|x| x as f32),
            frame: id as u32,
        }
    }
}
