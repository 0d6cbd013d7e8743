//! Proxies: what is rasterized so that fragments run. A coarse tessellation, whose triangles carry (u, v, face), or the
//! hulls of pieces, on which fragments look for the surface themselves.

use crate::Technique;
use crate::layout::{PieceRecord, Vertex};
use crate::pack::{PackedScene, Program};
use crate::pieces::{HULL_TRIANGLES, pieces_of};
use glam::DVec2;
use nurbs::{DerivativeBounds, Direction, Hull, Surface};
use rayon::prelude::*;
use scene::{Camera, FaceId, Model, Region, Viewport};

/// Chord error in pixels to which a proxy is built unless another is asked for.
pub const DEFAULT_CHORD_PX: f64 = 0.25;

/// How much wider than the chord error the skirt of a bounded face is, pixels: what snapping moves its corners by, and what
/// a pixel may be beyond the border and still be covered.
const SKIRT_PX: f64 = 1.0 / 16.0;

/// How many times that a skirt may measure along a parameter that comes to the border at a slant.
const SLANT: f64 = 4.0;

/// Cells a knot span is cut into at most, in each direction; a camera inside a face would ask for any number.
const GREATEST_CELLS: usize = 256;

/// Triangles of a proxy at most: 72 bytes each with their vertices, so under 1.3 GB.
const GREATEST_TRIANGLES: usize = 1 << 24;

/// Why a proxy could not be built.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ProxyError {
    /// The chord bound asks for more triangles than are allowed.
    #[error("a chord error of {chord_px} pixels asks for over {GREATEST_TRIANGLES} triangles; allow a larger one")]
    TooManyTriangles {
        /// The chord error asked for.
        chord_px: f64,
    },
    /// The faces have more nearly flat pieces than are allowed.
    #[error("the model has {count} nearly flat pieces; technique `exact` draws at most {}", GREATEST_TRIANGLES / 12)]
    TooManyPieces {
        /// How many there are.
        count: usize,
    },
    /// The chord bound is not a positive number.
    #[error("a chord error of {chord_px} pixels: it must be positive")]
    Chord {
        /// The chord error asked for.
        chord_px: f64,
    },
}

/// A range of indices that one program draws.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Batch {
    /// The program.
    pub program: Program,
    /// First index.
    pub first: u32,
    /// Number of indices, three a triangle.
    pub count: u32,
}

/// Triangles over all faces of a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Proxy {
    /// Corners, shared within a face.
    pub vertices: Vec<Vertex>,
    /// Three a triangle, in drawing order: at equal depth the earlier triangle stays.
    pub indices: Vec<u32>,
    /// One batch a program, in drawing order.
    pub batches: Vec<Batch>,
    /// For each face, the greatest distance in model units from a point of a flat triangle to S at its (u, v); zeros
    /// where fragments find S themselves.
    pub chord: Vec<f64>,
    /// Technique `exact`: the pieces in drawing order. Piece i has vertices 8 i to 8 i + 7 and triangles 12 i to 12 i + 11.
    /// Empty for a tessellation.
    pub pieces: Vec<PieceRecord>,
}

/// Parameters of the grid lines of one direction, local (0 … 1), ascending.
struct Lines {
    local: Vec<f32>,
}

/// The corners of a face.
struct Grid {
    lines: [Lines; 2],
    /// Parameters of the corners, u outer; those of a skirt lie beyond the domain.
    corners: Vec<[f32; 2]>,
    /// How many corners a row in v has.
    columns: usize,
}

impl Proxy {
    /// A tessellation whose flat triangles stay within `chord_px` pixels of the surface as `camera` sees it.
    ///
    /// The bound is that of Filip, Magedson & Markot (1986) on each cell of a grid that follows the knots, from
    /// second derivatives bounded over the cell's Bézier patch, seen at the nearest depth of the face's box
    /// ([`Camera::pixel_at`]). A face at the near plane, or one that would need over 256 cells a span, is coarser; what holds
    /// is always [`Self::chord`].
    ///
    /// A face that loops bound has a skirt: its triangles go on beyond the domain's border, along the tangents there, by what
    /// they may fall short of the border; their parameters go on too. What lies beyond the border is cut
    /// ([`is_shown`](crate::sight::is_shown)). No skirt goes on from a collapsed border.
    ///
    /// # Errors
    /// [`ProxyError`].
    pub fn tessellated(
        model: &Model,
        scene: &PackedScene,
        camera: &Camera,
        viewport: Viewport,
        chord_px: f64,
    ) -> Result<Self, ProxyError> {
        if chord_px <= 0.0 || !chord_px.is_finite() {
            return Err(ProxyError::Chord { chord_px });
        }
        let grids = model
            .faces()
            .par_iter()
            .map(|face| {
                let surface = &model.surfaces()[face.surface];
                let pixel = camera.pixel_at(viewport, surface.hull());
                let lines = chord_lines(surface, chord_px * pixel);
                if face.loops.is_empty() {
                    Grid::plain(lines)
                } else {
                    Grid::with_skirts(surface, lines, (chord_px + SKIRT_PX) * pixel)
                }
            })
            .collect();
        Self::over(model, scene, grids).ok_or(ProxyError::TooManyTriangles { chord_px })
    }

    /// A tessellation of every face into `cells` × `cells` cells of equal parameters, wherever its knots lie, as
    /// Kanai's Table 1 counts them.
    ///
    /// # Errors
    /// [`ProxyError::TooManyTriangles`].
    pub fn uniform(model: &Model, scene: &PackedScene, cells: usize) -> Result<Self, ProxyError> {
        let lines = || Lines { local: (0..=cells).map(|i| (i as f64 / cells as f64) as f32).collect() };
        let grids = model.faces().iter().map(|_| Grid::plain([lines(), lines()])).collect();
        Self::over(model, scene, grids).ok_or(ProxyError::TooManyTriangles { chord_px: f64::NAN })
    }

    fn over(model: &Model, scene: &PackedScene, grids: Vec<Grid>) -> Option<Self> {
        let triangles: usize = grids.iter().map(|grid| 2 * (grid.rows() - 1) * (grid.columns - 1)).sum();
        if triangles > GREATEST_TRIANGLES {
            return None;
        }
        let meshes: Vec<Vec<Vertex>> =
            grids.par_iter().enumerate().map(|(id, grid)| mesh(model, scene, id, &grid.corners)).collect();
        let chord = |(id, grid): (usize, &Grid)| {
            chord_bound(model.surface(FaceId(id as u32)), scene.frames[id].scale, &grid.lines)
        };
        let mut proxy = Self {
            vertices: vec![],
            indices: Vec::with_capacity(3 * triangles),
            batches: vec![],
            chord: grids.par_iter().enumerate().map(chord).collect(),
            pieces: vec![],
        };
        for id in in_drawing_order(scene) {
            let base = proxy.vertices.len() as u32;
            let first = proxy.indices.len() as u32;
            proxy.vertices.extend_from_slice(&meshes[id]);
            let [columns, rows] = [grids[id].columns, grids[id].rows()].map(|count| count as u32);
            for i in 0..rows - 1 {
                for j in 0..columns - 1 {
                    let a = base + i * columns + j;
                    let (b, c, d) = (a + columns, a + columns + 1, a + 1);
                    proxy.indices.extend([a, b, c, a, c, d]);
                }
            }
            proxy.batch(scene.programs[id], first);
        }
        Some(proxy)
    }

    /// Enters the indices from `first` on as drawn by `program`.
    fn batch(&mut self, program: Program, first: u32) {
        let count = self.indices.len() as u32 - first;
        match self.batches.last_mut() {
            Some(batch) if batch.program == program => batch.count += count,
            _ => self.batches.push(Batch { program, first, count }),
        }
    }

    /// Moves the corners of a face with its surface, at the parameters that they have: after an edit nothing is tessellated
    /// anew. [`Self::chord`] says what the triangles are good for then.
    ///
    /// Hulls do not follow: after an edit [`Self::hulls`] makes them anew.
    ///
    /// # Panics
    /// Where the model has no such face.
    pub fn follow(&mut self, model: &Model, scene: &PackedScene, face: FaceId) {
        let id = face.0 as usize;
        let of_face = |vertex: &Vertex| vertex.face == face.0;
        let Some(first) = self.vertices.iter().position(of_face).filter(|_| self.pieces.is_empty()) else { return };
        let corners = &self.vertices[first..];
        let count = corners.iter().take_while(|vertex| of_face(vertex)).count();
        let corners: Vec<[f32; 2]> = corners[..count].iter().map(|vertex| vertex.uv).collect();
        let lines = [0, 1].map(|k| {
            let mut local: Vec<f32> = corners.iter().map(|uv| uv[k].clamp(0.0, 1.0)).collect();
            local.sort_by(f32::total_cmp);
            local.dedup();
            Lines { local }
        });
        let moved = mesh(model, scene, id, &corners);
        self.vertices[first..first + count].copy_from_slice(&moved);
        self.chord[id] = chord_bound(model.surface(face), scene.frames[id].scale, &lines);
    }

    /// The hulls of all pieces of all faces, for technique `exact`: no pixel whose centre sees a piece, as `camera` has
    /// it, lies outside its hull.
    ///
    /// # Errors
    /// [`ProxyError::TooManyPieces`].
    pub fn hulls(model: &Model, scene: &PackedScene, camera: &Camera, viewport: Viewport) -> Result<Self, ProxyError> {
        let model_units_a_pixel = |hull: &Hull| {
            let farthest = hull.corners().iter().fold(camera.near(), |far: f64, c| far.max(camera.depth(*c)));
            1.0 / camera.pixels_per_unit(viewport, farthest.max(f64::MIN_POSITIVE))
        };
        let of_faces: Vec<_> = model
            .faces()
            .par_iter()
            .enumerate()
            .map(|(id, face)| {
                let patches = model.surfaces()[face.surface].bezier_patches();
                let mut pieces = pieces_of(scene, id, &patches, model_units_a_pixel);
                if let Some(region) = model.region(FaceId(id as u32)) {
                    pieces
                        .retain(|piece| may_have_material(region, scene.frames[id].edge_band, piece.record.rectangle));
                }
                pieces
            })
            .collect();
        let count: usize = of_faces.iter().map(Vec::len).sum();
        if count > GREATEST_TRIANGLES / HULL_TRIANGLES.len() {
            return Err(ProxyError::TooManyPieces { count });
        }
        let mut proxy = Self {
            vertices: Vec::with_capacity(8 * count),
            indices: Vec::with_capacity(3 * HULL_TRIANGLES.len() * count),
            batches: vec![],
            chord: vec![0.0; of_faces.len()],
            pieces: Vec::with_capacity(count),
        };
        for id in in_drawing_order(scene) {
            let first = proxy.indices.len() as u32;
            for piece in &of_faces[id] {
                let base = proxy.vertices.len() as u32;
                let vertex = |position| Vertex { position, uv: [0.0; 2], face: id as u32, normal: [0.0; 3] };
                proxy.vertices.extend(piece.corners.map(vertex));
                proxy.indices.extend(HULL_TRIANGLES.as_flattened().iter().map(|corner| base + corner));
                proxy.pieces.push(piece.record);
            }
            proxy.batch(scene.programs[id], first);
        }
        Ok(proxy)
    }

    /// The technique that draws it.
    pub fn technique(&self) -> Technique {
        if self.pieces.is_empty() { Technique::Fragment } else { Technique::Exact }
    }

    /// Number of triangles.
    pub fn triangles(&self) -> usize {
        self.indices.len() / 3
    }
}

/// Whether a rectangle of local parameters meets the box of a region, grown by what f32 may mistake.
fn may_have_material(region: &Region, band: DVec2, [u0, v0, u1, v1]: [f32; 4]) -> bool {
    let (domain, hull) = (region.domain(), region.hull());
    let [low, high] = [hull.min - domain.min, hull.max - domain.min].map(|corner| corner / domain.size());
    let [from, to] = [[u0, v0], [u1, v1]].map(|uv| DVec2::from_array(uv.map(f64::from)));
    from.cmple(high + band).all() && to.cmpge(low - band).all()
}

/// Faces grouped by their programs.
fn in_drawing_order(scene: &PackedScene) -> Vec<usize> {
    let mut order: Vec<usize> = (0..scene.faces.len()).collect();
    order.sort_by_key(|&id| (scene.programs[id], id));
    order
}

/// Grid lines at all knots and between them, so that every cell's chord bound is at most `allowed` model units.
fn chord_lines(surface: &Surface, allowed: f64) -> [Lines; 2] {
    let [ku, kv] = [Direction::U, Direction::V].map(|d| surface.knots(d));
    let (spans_u, spans_v) = (ku.spans().count(), kv.spans().count());
    let mut cells = [vec![1usize; spans_u], vec![1usize; spans_v]];
    for (index, patch) in surface.bezier_patches().iter().enumerate() {
        let (k, l) = (index / spans_v, index % spans_v);
        let bounds = patch.derivative_bounds();
        let [width, height] = patch.domain.map(|[start, end]| end - start);
        let [nu, nv] = cells_needed(&bounds, width, height, allowed, [cells[0][k], cells[1][l]]);
        cells[0][k] = nu;
        cells[1][l] = nv;
    }
    let lines = |knots: &nurbs::KnotVector, cells: &[usize]| {
        let (start, length) = (knots.domain().0, knots.length());
        let mut local = vec![0.0f32];
        for (span, &n) in knots.spans().zip(cells) {
            let (a, b) = (knots.knots()[span], knots.knots()[span + 1]);
            local.extend((1..=n).map(|i| ((a - start + (b - a) * (i as f64 / n as f64)) / length) as f32));
        }
        *local.last_mut().expect("not empty") = 1.0;
        // Lines that a tiny span puts on the same f32 are one line.
        local.dedup();
        Lines { local }
    };
    [lines(ku, &cells[0]), lines(kv, &cells[1])]
}

/// The fewest cells, from `least` on, that bring the chord bound under `allowed`: always the direction that gains more.
fn cells_needed(bounds: &DerivativeBounds, width: f64, height: f64, allowed: f64, least: [usize; 2]) -> [usize; 2] {
    let chord = |n: [usize; 2]| bounds.chord(width / n[0] as f64, height / n[1] as f64);
    let mut n = least;
    while chord(n) > allowed && n[0].min(n[1]) < GREATEST_CELLS {
        let grown = [[(n[0] + 1).min(GREATEST_CELLS), n[1]], [n[0], (n[1] + 1).min(GREATEST_CELLS)]];
        // A step in u adds n[1] cells, a step in v n[0]: compare what each cell buys.
        let gain = [(chord(n) - chord(grown[0])) / n[1] as f64, (chord(n) - chord(grown[1])) / n[0] as f64];
        n = if gain[0] >= gain[1] { grown[0] } else { grown[1] };
    }
    n
}

impl Grid {
    fn plain(lines: [Lines; 2]) -> Self {
        let [u, v] = &lines;
        let corners = u.local.iter().flat_map(|&s| v.local.iter().map(move |&t| [s, t])).collect();
        Self { columns: v.local.len(), corners, lines }
    }

    /// A grid that goes on beyond the domain by at least `width` model units along the tangents, but where the border
    /// is collapsed.
    fn with_skirts(surface: &Surface, lines: [Lines; 2], width: f64) -> Self {
        let [u, v] = &lines;
        // With the ends twice, once for the skirt: a share of the domain and whether, and to which side, to go beyond it.
        let places = |lines: &Lines| -> Vec<(f32, f64)> {
            let inside = lines.local.iter().map(|&t| (t, 0.0));
            std::iter::once((0.0, -1.0)).chain(inside).chain([(1.0, 1.0)]).collect()
        };
        let (rows, columns) = (places(u), places(v));
        let [[u0, u1], [v0, v1]] = surface.domain();
        let corner = |(s, beyond_u): (f32, f64), (t, beyond_v): (f32, f64)| {
            let d = surface.first_derivatives(u0 + (u1 - u0) * f64::from(s), v0 + (v1 - v0) * f64::from(t));
            let area = d.su.cross(d.sv).length();
            // Straight away from the border, whose tangent is `along`, it is a part of the way.
            let gain = |speed: f64, along: f64, side: f64| {
                let gain = (width * along / area).min(SLANT * width / speed);
                if side != 0.0 && gain.is_finite() { side * gain } else { 0.0 }
            };
            let (speed_u, speed_v) = (d.su.length(), d.sv.length());
            let beyond = [gain(speed_u, speed_v, beyond_u) / (u1 - u0), gain(speed_v, speed_u, beyond_v) / (v1 - v0)];
            [s + beyond[0] as f32, t + beyond[1] as f32]
        };
        let corners = rows.iter().flat_map(|&row| columns.iter().map(move |&column| corner(row, column))).collect();
        Self { columns: columns.len(), corners, lines }
    }

    fn rows(&self) -> usize {
        self.corners.len() / self.columns
    }
}

/// The vertices of one face at local parameters.
fn mesh(model: &Model, scene: &PackedScene, id: usize, corners: &[[f32; 2]]) -> Vec<Vertex> {
    let surface = model.surface(FaceId(id as u32));
    let reversed = model.faces()[id].reversed;
    let frame = &scene.frames[id];
    let vertex = |&corner: &[f32; 2]| {
        let border = corner.map(|t| t.clamp(0.0, 1.0));
        let uv = frame.uv(border);
        let d = surface.first_derivatives(uv.x, uv.y);
        let cross = d.su.cross(d.sv);
        let normal = match cross.try_normalize() {
            Some(n) if cross.length() > 1e-9 * d.su.length() * d.sv.length() => n,
            _ => surface.inspect(uv.x, uv.y).normal.unit().unwrap_or_default(),
        };
        let normal = if reversed { -normal } else { normal };
        let [width, height] = frame.domain.map(|[start, end]| end - start);
        let beyond = [corner[0] - border[0], corner[1] - border[1]].map(f64::from);
        let position = d.s + d.su * (beyond[0] * width) + d.sv * (beyond[1] * height);
        Vertex {
            position: frame.local(position),
            uv: corner,
            face: id as u32,
            normal: normal.to_array().map(|x| x as f32),
        }
    };
    corners.iter().map(vertex).collect()
}

/// The greatest chord of any cell, from the bounds of the patches that it touches, plus what narrowing moves.
fn chord_bound(surface: &Surface, scale: f64, [u, v]: &[Lines; 2]) -> f64 {
    let domain = surface.domain();
    let widest = |lines: &Lines, [start, end]: [f64; 2], [low, high]: [f64; 2]| {
        // Cells that overlap [low, high]; a line narrowed to f32 may stand half an ulp off its knot.
        let local = |t: f64| (t - start) / (end - start);
        let (low, high) = (local(low) + f64::from(f32::EPSILON), local(high) - f64::from(f32::EPSILON));
        let overlapping = lines.local.windows(2).map(|w| [f64::from(w[0]), f64::from(w[1])]);
        overlapping.filter(|[a, b]| *a < high && *b > low).fold(0.0, |most: f64, [a, b]| most.max(b - a))
            * (end - start)
    };
    let mut chord = 0.0f64;
    let mut speed = 0.0f64;
    for patch in surface.bezier_patches() {
        let bounds = patch.derivative_bounds();
        let du = widest(u, domain[0], patch.domain[0]);
        let dv = widest(v, domain[1], patch.domain[1]);
        chord = chord.max(bounds.chord(du, dv));
        let length = |[start, end]: [f64; 2]| end - start;
        speed = speed.max(bounds.u * length(domain[0])).max(bounds.v * length(domain[1]));
    }
    // Vertices narrow to f32 (half an ulp of the local unit in each coordinate), and a grid line may stand half an
    // ulp beside its knot.
    chord + f64::from(f32::EPSILON) * (scale + speed)
}
