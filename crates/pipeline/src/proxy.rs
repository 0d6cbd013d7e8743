//! Proxies: what is rasterized so that fragments run. A coarse tessellation, whose triangles carry (u, v, face), or the
//! hulls of pieces, on which fragments look for the surface themselves.

mod bounds;
mod cells;
mod frustum;
mod grid;

use crate::Technique;
use crate::layout::{Parameters, PieceRecord, SEARCHED, Vertex};
use crate::packed::{PackedScene, Program};
use crate::patches::spans_of;
use crate::pieces::{HULL_TRIANGLES, pieces_of};
use bounds::Bounds;
use cells::{Cells, GREATEST_CELLS, REFINED_TRIANGLES, Wanted, chord_bounds, total};
use frustum::Frustum;
use grid::{Grid, Skirt, corner, grids_of_spans, mesh};
use nurbs::{BezierPatch, Hull, Surface};
use rayon::prelude::*;
use scene::{Camera, Face, FaceId, Model, Region, Viewport};

/// Chord error in pixels to which a proxy is built unless another is asked for.
pub const DEFAULT_CHORD_PX: f64 = 0.25;

/// How much wider than the chord error the skirt of a bounded face is, pixels: what snapping moves its corners by, and what
/// a pixel may be beyond the border and still be covered.
const SKIRT_PX: f64 = 1.0 / 16.0;

/// Triangles of a proxy at most: about 80 bytes each with their vertices, so under 1.4 GB.
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

/// Triangles over all faces of a scene; none by default.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Proxy {
    /// Corners, shared within a face.
    pub vertices: Vec<Vertex>,
    /// Three a triangle, in drawing order: at equal depth the earlier triangle stays.
    pub indices: Vec<u32>,
    /// One batch a program, in drawing order.
    pub batches: Vec<Batch>,
    /// For each face and each of its Bézier pieces, row-major in u as of [`Surface::bezier_patches`], the greatest distance in
    /// model units from a point of a flat triangle to S at its parameters; zeros where fragments find S themselves.
    pub chord: Vec<Vec<f64>>,
    /// Chord error in pixels to which it was built: more than was asked for where that would take too many triangles.
    pub built_px: f64,
    /// How each face is cut into cells; empty for hulls.
    cells: Vec<Cells>,
    /// Technique `exact`: the pieces in drawing order. Piece i has vertices 8 i to 8 i + 7 and triangles 12 i to 12 i + 11.
    /// Empty for a tessellation.
    pub pieces: Vec<PieceRecord>,
}

impl Proxy {
    /// A tessellation whose flat triangles stay within `chord_px` pixels of the surface as `camera` sees it.
    ///
    /// The bound is that of Filip, Magedson & Markot (1986) on each cell of a grid that follows the knots, from
    /// second derivatives bounded over the cell's Bézier patch, seen at the nearest depth of the patch's box
    /// ([`Camera::pixel_at`]). A patch that is out of the picture is not cut. Where the bound asks for over four million
    /// triangles the chord error is doubled until it does not: [`Self::built_px`].
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
        let in_picture = Frustum::new(camera, viewport);
        let pixel = |patch: &BezierPatch| {
            let hull = patch.close_hull();
            if in_picture.meets(&hull) { camera.pixel_at(viewport, hull) } else { f64::INFINITY }
        };
        let of_surface = |surface: &Surface| {
            let patches = surface.bezier_patches();
            (Bounds::of(&patches), patches.iter().map(pixel).collect())
        };
        let surfaces: Vec<(Bounds, Vec<f64>)> = model.surfaces().par_iter().map(of_surface).collect();
        let of_face = |(id, face): (usize, &Face)| {
            let (bounds, pixels) = &surfaces[face.surface];
            let spans = spans_of(model.region(FaceId(id as u32)), &scene.frames()[id].breaks);
            Wanted { bounds, pixels, spans }
        };
        let wanted: Vec<Wanted> = model.faces().iter().enumerate().map(of_face).collect();
        let mut built_px = chord_px;
        let cells: Vec<[Vec<Vec<usize>>; 2]> = loop {
            let cells: Vec<_> = wanted.par_iter().map(|face| face.cells(built_px)).collect();
            let along = |spans: &[Vec<usize>]| spans.iter().map(|parts| total(parts)).sum::<f64>();
            let triangles = wanted
                .iter()
                .zip(&cells)
                .map(|(face, cells)| [0, 1].map(|k| along(&cells[k][face.spans[k].clone()])).iter().product::<f64>());
            let triangles = 2.0 * triangles.sum::<f64>();
            let least = wanted.iter().map(|face| {
                [0, 1].map(|k| total(&face.bounds.parts[k][face.spans[k].clone()])).iter().product::<f64>()
            });
            let least = 2.0 * least.sum::<f64>();
            if triangles <= (REFINED_TRIANGLES as f64).max(2.0 * least) {
                break cells;
            }
            built_px *= 2.0;
        };
        let grids = cells
            .par_iter()
            .enumerate()
            .map(|(id, cells)| {
                let face = FaceId(id as u32);
                let skirt = model.region(face).map(|region| {
                    let pixels = wanted[id].patches().map(|index| wanted[id].pixels[index]);
                    let pixel = pixels.filter(|pixel| pixel.is_finite()).fold(0.0, f64::max);
                    Skirt { surface: model.surface(face), region, width: (built_px + SKIRT_PX) * pixel }
                });
                grids_of_spans(&scene.frames()[id].breaks, cells, &wanted[id].spans, skirt.as_ref())
            })
            .collect();
        let cells = cells.into_iter().map(Cells::OfSpans).collect();
        let bounds: Vec<&Bounds> = wanted.iter().map(|face| face.bounds).collect();
        Self::over(model, scene, &bounds, cells, grids, built_px).ok_or(ProxyError::TooManyTriangles { chord_px })
    }

    /// A tessellation of every face into `cells` × `cells` cells of equal parameters, wherever its knots lie, as
    /// Kanai's Table 1 counts them. Fragments find their knot spans by binary search.
    ///
    /// # Errors
    /// [`ProxyError::TooManyTriangles`].
    pub fn uniform(model: &Model, scene: &PackedScene, cells: usize) -> Result<Self, ProxyError> {
        let too_many = ProxyError::TooManyTriangles { chord_px: f64::NAN };
        if cells == 0 || cells > GREATEST_CELLS || model.faces().len() * cells * cells > GREATEST_TRIANGLES / 2 {
            return Err(too_many);
        }
        let lines: Vec<f32> = (0..=cells).map(|i| (i as f64 / cells as f64) as f32).collect();
        let grid = || Grid::new([SEARCHED; 2], &lines, &lines);
        let grids = model.faces().iter().map(|_| vec![grid()]).collect();
        let of_surface: Vec<Bounds> = model.surfaces().par_iter().map(|s| Bounds::of(&s.bezier_patches())).collect();
        let bounds: Vec<&Bounds> = model.faces().iter().map(|face| &of_surface[face.surface]).collect();
        let cells = vec![Cells::OfDomain(cells); model.faces().len()];
        Self::over(model, scene, &bounds, cells, grids, f64::NAN).ok_or(too_many)
    }

    fn over(
        model: &Model,
        scene: &PackedScene,
        bounds: &[&Bounds],
        cells: Vec<Cells>,
        grids: Vec<Vec<Grid>>,
        built_px: f64,
    ) -> Option<Self> {
        let triangles: usize = grids.iter().flatten().map(|grid| 2 * (grid.rows() - 1) * (grid.columns - 1)).sum();
        if triangles > GREATEST_TRIANGLES {
            return None;
        }
        let meshes: Vec<Vec<Vertex>> =
            grids.par_iter().enumerate().map(|(id, grids)| mesh(model, scene, id, grids)).collect();
        let chord = |(id, cells): (usize, &Cells)| {
            let face = FaceId(id as u32);
            chord_bounds(bounds[id], model.surface(face), model.region(face), &scene.frames()[id], cells)
        };
        let mut proxy = Self {
            vertices: vec![],
            indices: Vec::with_capacity(3 * triangles),
            batches: vec![],
            chord: cells.par_iter().enumerate().map(chord).collect(),
            built_px,
            cells,
            pieces: vec![],
        };
        for id in in_drawing_order(scene) {
            let mut base = proxy.vertices.len() as u32;
            let first = proxy.indices.len() as u32;
            proxy.vertices.extend_from_slice(&meshes[id]);
            for grid in &grids[id] {
                let [columns, rows] = [grid.columns, grid.rows()].map(|count| count as u32);
                for i in 0..rows - 1 {
                    for j in 0..columns - 1 {
                        let a = base + i * columns + j;
                        let (b, c, d) = (a + columns, a + columns + 1, a + 1);
                        proxy.indices.extend([a, b, c, a, c, d]);
                    }
                }
                base += rows * columns;
            }
            proxy.batch(scene.programs()[id], first);
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
        for vertex in self.vertices[first..].iter_mut().take_while(|vertex| of_face(vertex)) {
            *vertex = corner(model, scene, id, Parameters { span: vertex.span, uv: vertex.uv });
        }
        let surface = model.surface(face);
        let bounds = Bounds::of(&surface.bezier_patches());
        self.chord[id] = chord_bounds(&bounds, surface, model.region(face), &scene.frames()[id], &self.cells[id]);
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
        let of_surface: Vec<_> = model.surfaces().par_iter().map(Surface::bezier_patches).collect();
        let of_faces: Vec<_> = model
            .faces()
            .par_iter()
            .enumerate()
            .map(|(id, face)| {
                let region = model.region(FaceId(id as u32));
                let spans = spans_of(region, &scene.frames()[id].breaks);
                let mut pieces = pieces_of(scene, id, &of_surface[face.surface], &spans, model_units_a_pixel);
                if let Some(region) = region {
                    pieces.retain(|piece| may_have_material(region, scene, id, &piece.record));
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
            chord: scene.frames().iter().map(|frame| vec![0.0; frame.pieces()]).collect(),
            built_px: 0.0,
            cells: vec![],
            pieces: Vec::with_capacity(count),
        };
        for id in in_drawing_order(scene) {
            let first = proxy.indices.len() as u32;
            for piece in &of_faces[id] {
                let base = proxy.vertices.len() as u32;
                let vertex =
                    |position| Vertex { position, uv: [0.0; 2], face: id as u32, span: [0; 2], normal: [0.0; 3] };
                proxy.vertices.extend(piece.corners.map(vertex));
                proxy.indices.extend(HULL_TRIANGLES.as_flattened().iter().map(|corner| base + corner));
                proxy.pieces.push(piece.record);
            }
            proxy.batch(scene.programs()[id], first);
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

/// Whether a piece of a face meets the box of its region, grown by what f32 may mistake.
fn may_have_material(region: &Region, scene: &PackedScene, face: usize, piece: &PieceRecord) -> bool {
    let frame = &scene.frames()[face];
    let band = frame.edge_band * region.domain().size();
    let hull = region.hull();
    let [u0, v0, u1, v1] = piece.rectangle;
    let at = |uv: [f32; 2]| frame.uv([piece.span_u, piece.span_v], uv);
    at([u0, v0]).cmple(hull.max + band).all() && at([u1, v1]).cmpge(hull.min - band).all()
}

/// Faces grouped by their programs.
fn in_drawing_order(scene: &PackedScene) -> Vec<usize> {
    let mut order: Vec<usize> = (0..scene.faces().len()).collect();
    order.sort_by_key(|&id| (scene.programs()[id], id));
    order
}
