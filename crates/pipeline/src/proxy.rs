//! Proxies: what is rasterized so that fragments run. A coarse tessellation, whose triangles carry (u, v, face), or the
//! hulls of pieces, on which fragments look for the surface themselves.

use crate::Technique;
use crate::layout::{Parameters, PieceRecord, SEARCHED, Vertex};
use crate::pack::{PackedFrame, PackedScene, Program};
use crate::patches::{patches_on, spans_of};
use crate::pieces::{HULL_TRIANGLES, pieces_of};
use glam::{DVec2, DVec4};
use nurbs::{BezierPatch, DerivativeBounds, Hull, Surface};
use rayon::prelude::*;
use scene::{Camera, Face, FaceId, Model, Region, Viewport};
use std::ops::Range;

/// Chord error in pixels to which a proxy is built unless another is asked for.
pub const DEFAULT_CHORD_PX: f64 = 0.25;

/// How much wider than the chord error the skirt of a bounded face is, pixels: what snapping moves its corners by, and what
/// a pixel may be beyond the border and still be covered.
const SKIRT_PX: f64 = 1.0 / 16.0;

/// How many times that a skirt may measure along a parameter that comes to the border at a slant.
const SLANT: f64 = 4.0;

/// Triangles of a proxy at most: about 80 bytes each with their vertices, so under 1.4 GB.
const GREATEST_TRIANGLES: usize = 1 << 24;

/// Triangles up to which the chord error decides; a camera on a face would ask for any number, and gets a coarser tessellation
/// beyond ([`Proxy::built_px`]).
const REFINED_TRIANGLES: usize = 1 << 22;

/// Cells of one span in one direction at most: what [`REFINED_TRIANGLES`] leaves of it however narrow it is.
const GREATEST_CELLS: usize = REFINED_TRIANGLES / 2;

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

/// How the parameters of a face are cut.
#[derive(Debug, Clone, PartialEq)]
enum Cells {
    /// Every span by itself, in u and in v: of each of its equal parts, the cells. A span of polynomial patches is one part.
    OfSpans([Vec<Vec<usize>>; 2]),
    /// The whole domain, in both directions alike.
    OfDomain(usize),
}

/// The corners of a part of a face: a grid of them.
struct Grid {
    span: [u32; 2],
    /// Parameters of the corners, u outer; those of a skirt lie beyond the domain.
    corners: Vec<[f32; 2]>,
    /// How many corners a row in v has.
    columns: usize,
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
            let hull = close_hull(patch, HULL_HALVINGS);
            if in_picture.meets(&hull) { camera.pixel_at(viewport, hull) } else { f64::INFINITY }
        };
        let of_surface = |surface: &Surface| {
            let patches = surface.bezier_patches();
            (Bounds::of(&patches), patches.iter().map(pixel).collect())
        };
        let surfaces: Vec<(Bounds, Vec<f64>)> = model.surfaces().par_iter().map(of_surface).collect();
        let of_face = |(id, face): (usize, &Face)| {
            let (bounds, pixels) = &surfaces[face.surface];
            let spans = spans_of(model.region(FaceId(id as u32)), &scene.frames[id].breaks);
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
                grids_of_spans(&scene.frames[id].breaks, cells, &wanted[id].spans, skirt.as_ref())
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
            chord_bounds(bounds[id], model.surface(face), model.region(face), &scene.frames[id], cells)
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
        for vertex in self.vertices[first..].iter_mut().take_while(|vertex| of_face(vertex)) {
            *vertex = corner(model, scene, id, Parameters { span: vertex.span, uv: vertex.uv });
        }
        let surface = model.surface(face);
        let bounds = Bounds::of(&surface.bezier_patches());
        self.chord[id] = chord_bounds(&bounds, surface, model.region(face), &scene.frames[id], &self.cells[id]);
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
                let spans = spans_of(region, &scene.frames[id].breaks);
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
            chord: scene.frames.iter().map(|frame| vec![0.0; frame.pieces()]).collect(),
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

/// Whether a piece of a face meets the box of its region, grown by what f32 may mistake.
fn may_have_material(region: &Region, scene: &PackedScene, face: usize, piece: &PieceRecord) -> bool {
    let frame = &scene.frames[face];
    let band = frame.edge_band * region.domain().size();
    let hull = region.hull();
    let [u0, v0, u1, v1] = piece.rectangle;
    let at = |uv: [f32; 2]| frame.uv([piece.span_u, piece.span_v], uv);
    at([u0, v0]).cmple(hull.max + band).all() && at([u1, v1]).cmpge(hull.min - band).all()
}

/// Faces grouped by their programs.
fn in_drawing_order(scene: &PackedScene) -> Vec<usize> {
    let mut order: Vec<usize> = (0..scene.faces.len()).collect();
    order.sort_by_key(|&id| (scene.programs[id], id));
    order
}

/// What a face asks of its tessellation.
struct Wanted<'a> {
    bounds: &'a Bounds,
    /// Of each Bézier patch, row-major in u, what a pixel measures where it is nearest, infinite out of the picture.
    pixels: &'a [f64],
    /// The spans in u and in v that the face comes to.
    spans: [Range<usize>; 2],
}

/// Bounds of the derivatives of a surface's Bézier patches, part by part: of a patch with a large weight they differ by orders of
/// magnitude from one place to another.
struct Bounds {
    /// How many equal parts each span in u and in v is cut into.
    parts: [Vec<usize>; 2],
    /// Of each patch, row-major in u, its width and height, and of its parts, row-major in u, the bounds.
    patches: Vec<([f64; 2], Vec<DerivativeBounds>)>,
}

/// A span has one part where the weights of each patch on it vary by no more than this, else as many as the root of their ratio,
/// up to [`GREATEST_PARTS`]: parameters run so many times faster near the heavy point.
const WEIGHTS_VARY_MUCH: f64 = 8.0;

/// See [`WEIGHTS_VARY_MUCH`].
const GREATEST_PARTS: usize = 64;

impl Bounds {
    /// Those of all patches of a surface, row-major in u.
    fn of(patches: &[BezierPatch]) -> Self {
        let spans_v = patches.iter().take_while(|patch| patch.domain[0] == patches[0].domain[0]).count();
        let mut parts = [vec![1; patches.len() / spans_v], vec![1; spans_v]];
        for (index, ratio) in
            patches.iter().map(weights_vary).enumerate().filter(|(_, ratio)| *ratio > WEIGHTS_VARY_MUCH)
        {
            let count = (ratio.sqrt() as usize).next_power_of_two().min(GREATEST_PARTS);
            let [k, l] = [index / spans_v, index % spans_v];
            parts[0][k] = count.max(parts[0][k]);
            parts[1][l] = count.max(parts[1][l]);
        }
        let of_patch = |(index, patch): (usize, &BezierPatch)| {
            let size = patch.domain.map(|[start, end]| end - start);
            let [rows, columns] = [parts[0][index / spans_v], parts[1][index % spans_v]];
            let strips = cut(patch.clone(), rows, patch.domain[0], BezierPatch::split_u);
            let of_strip = |strip: BezierPatch| cut(strip, columns, patch.domain[1], BezierPatch::split_v);
            (size, strips.into_iter().flat_map(of_strip).map(|part| part.derivative_bounds()).collect())
        };
        let patches = patches.iter().enumerate().map(of_patch).collect();
        Self { parts, patches }
    }

    /// The spans of a patch, by their places in the lists of parts.
    fn spans(&self, index: usize) -> [usize; 2] {
        [index / self.parts[1].len(), index % self.parts[1].len()]
    }

    /// The greatest chord of a patch whose parts are cut into so many cells, along u and along v.
    fn chord(&self, index: usize, [u, v]: [&[usize]; 2]) -> f64 {
        let ([width, height], bounds) = &self.patches[index];
        let [width, height] = [width / u.len() as f64, height / v.len() as f64];
        let of_part = |(k, bounds): (usize, &DerivativeBounds)| {
            bounds.chord(width / u[k / v.len()] as f64, height / v[k % v.len()] as f64)
        };
        bounds.iter().enumerate().map(of_part).fold(0.0, f64::max)
    }
}

/// A patch cut into so many equal parts of a direction, by `split`.
fn cut(
    patch: BezierPatch,
    parts: usize,
    [start, end]: [f64; 2],
    split: impl Fn(&BezierPatch, f64) -> [BezierPatch; 2],
) -> Vec<BezierPatch> {
    let mut all = Vec::with_capacity(parts);
    let mut rest = patch;
    for k in 1..parts {
        let [part, beyond] = split(&rest, start + (end - start) * k as f64 / parts as f64);
        all.push(part);
        rest = beyond;
    }
    all.push(rest);
    all
}

/// The greatest ratio of two weights of a patch.
fn weights_vary(patch: &BezierPatch) -> f64 {
    let weights = patch.control.iter().map(|c| c.w);
    let (least, most) = weights.fold((f64::INFINITY, 0.0f64), |(least, most), w| (least.min(w), most.max(w)));
    most / least
}

impl Wanted<'_> {
    /// The patches that the face comes to.
    fn patches(&self) -> impl Iterator<Item = usize> {
        patches_on(&self.spans, self.bounds.parts[1].len())
    }

    /// The fewest cells of each part of the spans in u and in v so that the chord bound of every cell is at most `chord_px`.
    fn cells(&self, chord_px: f64) -> [Vec<Vec<usize>>; 2] {
        let mut cells =
            self.bounds.parts.each_ref().map(|spans| spans.iter().map(|&n| vec![1usize; n]).collect::<Vec<_>>());
        for index in self.patches() {
            let (size, bounds) = &self.bounds.patches[index];
            let [k, l] = self.bounds.spans(index);
            let [rows, columns] = [cells[0][k].len(), cells[1][l].len()];
            let size = [size[0] / rows as f64, size[1] / columns as f64];
            for (part, bounds) in bounds.iter().enumerate() {
                let (i, j) = (part / columns, part % columns);
                let least = [cells[0][k][i], cells[1][l][j]];
                [cells[0][k][i], cells[1][l][j]] = cells_needed(bounds, size, chord_px * self.pixels[index], least);
            }
        }
        cells
    }
}

/// A patch whose weights vary by more than this reaches far less far than its control points.
const WEIGHTS_VARY: f64 = 1.5;

/// Halvings both ways of such a patch, for its box.
const HULL_HALVINGS: u32 = 4;

/// A box that holds a patch: that of its control points, or where weights vary, of those of its quarters' quarters.
fn close_hull(patch: &BezierPatch, halvings: u32) -> Hull {
    if halvings == 0 || weights_vary(patch) <= WEIGHTS_VARY {
        return patch.hull();
    }
    let [u, v] = patch.domain.map(|[start, end]| 0.5 * (start + end));
    let quarters = patch.split_u(u).into_iter().flat_map(|half| half.split_v(v));
    quarters.map(|part| close_hull(&part, halvings - 1)).reduce(Hull::union).expect("four quarters")
}

fn total(counts: &[usize]) -> f64 {
    counts.iter().sum::<usize>() as f64
}

/// The fewest cells, from `least` on, that bring the chord bound under `allowed`: always the direction that gains more. From
/// eight cells on they grow by an eighth, so that the number of steps is bounded by the number of bits of the count.
fn cells_needed(bounds: &DerivativeBounds, [width, height]: [f64; 2], allowed: f64, least: [usize; 2]) -> [usize; 2] {
    let chord = |n: [usize; 2]| bounds.chord(width / n[0] as f64, height / n[1] as f64);
    let more = |n: usize| (n + (n / 8).max(1)).min(GREATEST_CELLS);
    let mut n = least;
    while chord(n) > allowed && n[0] * n[1] < REFINED_TRIANGLES {
        let grown = [[more(n[0]), n[1]], [n[0], more(n[1])]];
        // A cell more in u adds n[1] cells, one in v n[0]: compare what each buys.
        let gain = [0, 1].map(|k| (chord(n) - chord(grown[k])) / ((grown[k][k] - n[k]).max(1) * n[1 - k]) as f64);
        let next = if gain[0] >= gain[1] { grown[0] } else { grown[1] };
        if next == n {
            break;
        }
        n = next;
    }
    n
}

/// The half-spaces that hold what a picture shows.
struct Frustum {
    /// A plane (n, d) has what is outside at n · p + d < 0.
    planes: [DVec4; 5],
}

/// How far beyond the picture's border what a patch shows may matter to a pixel in it, as a share of the picture.
const MARGIN: f64 = 1.0 / 16.0;

impl Frustum {
    fn new(camera: &Camera, viewport: Viewport) -> Self {
        let rows = camera.clip_from_world(viewport, 1.0).transpose();
        let [x, y, w] = [rows.x_axis, rows.y_axis, rows.w_axis];
        let wide = w * (1.0 + MARGIN);
        let near = camera.forward().extend(-camera.forward().dot(camera.eye()) - camera.near());
        Self { planes: [wide - x, wide + x, wide - y, wide + y, near] }
    }

    /// Whether a box is not wholly outside one of the planes.
    fn meets(&self, hull: &Hull) -> bool {
        let corners = hull.corners();
        self.planes.iter().all(|plane| corners.iter().any(|corner| plane.dot(corner.extend(1.0)) >= 0.0))
    }
}

/// What a bounded face goes on by.
struct Skirt<'a> {
    surface: &'a Surface,
    region: &'a Region,
    /// Model units along the tangents.
    width: f64,
}

/// The grids of a face's spans, with a skirt where loops bound it.
fn grids_of_spans(
    breaks: &[Vec<f64>; 2],
    cells: &[Vec<Vec<usize>>; 2],
    spans: &[Range<usize>; 2],
    skirt: Option<&Skirt>,
) -> Vec<Grid> {
    let lines = |parts: &Vec<usize>| -> Vec<f32> {
        let of_part = |(k, &n): (usize, &usize)| {
            (0..n).map(move |i| ((k as f64 + i as f64 / n as f64) / parts.len() as f64) as f32).collect::<Vec<_>>()
        };
        parts.iter().enumerate().flat_map(of_part).chain([1.0]).collect()
    };
    let [rows, columns] = [0, 1].map(|k| cells[k][spans[k].clone()].iter().map(lines).collect::<Vec<_>>());
    let mut grids = Vec::with_capacity(rows.len() * columns.len());
    for (k, u) in spans[0].clone().zip(&rows) {
        for (l, v) in spans[1].clone().zip(&columns) {
            let span = [k as u32, l as u32];
            grids.push(match skirt {
                None => Grid::new(span, u, v),
                Some(skirt) => Grid::with_skirt(span, [u, v], breaks, skirt),
            });
        }
    }
    grids
}

impl Grid {
    fn new(span: [u32; 2], u: &[f32], v: &[f32]) -> Self {
        let corners = u.iter().flat_map(|&s| v.iter().map(move |&t| [s, t])).collect();
        Self { span, corners, columns: v.len() }
    }

    /// A grid that goes on beyond the sides of the domain into whose cells the region comes, by at least the skirt's width
    /// along the tangents, but where the side is collapsed.
    fn with_skirt(span: [u32; 2], lines: [&[f32]; 2], breaks: &[Vec<f64>; 2], skirt: &Skirt) -> Self {
        let &Skirt { surface, region, width } = skirt;
        let hull = region.hull();
        let ends = [0, 1].map(|k| [breaks[k][span[k] as usize], breaks[k][span[k] as usize + 1]]);
        let at = |k: usize, t: f32| ends[k][0] + (ends[k][1] - ends[k][0]) * f64::from(t);
        // With the ends twice, once for the skirt: the parameter and whether, and to which side, to go beyond it.
        let places = |k: usize| -> Vec<(f32, f64)> {
            let lines = lines[k];
            let is_first = span[k] == 0;
            let is_last = span[k] as usize + 2 == breaks[k].len();
            let before = (is_first && hull.min[k] <= at(k, lines[1])).then_some((0.0, -1.0));
            let after = (is_last && hull.max[k] >= at(k, lines[lines.len() - 2])).then_some((1.0, 1.0));
            let inside = lines.iter().map(|&t| (t, 0.0));
            before.into_iter().chain(inside).chain(after).collect()
        };
        let (rows, columns) = (places(0), places(1));
        let corner = |(s, beyond_u): (f32, f64), (t, beyond_v): (f32, f64)| {
            let d = surface.first_derivatives(at(0, s), at(1, t));
            let area = d.su.cross(d.sv).length();
            // Straight away from the border, whose tangent is `along`, it is a part of the way.
            let gain = |speed: f64, along: f64, side: f64| {
                let gain = (width * along / area).min(SLANT * width / speed);
                if side != 0.0 && gain.is_finite() { side * gain } else { 0.0 }
            };
            let (speed_u, speed_v) = (d.su.length(), d.sv.length());
            let length = ends.map(|[start, end]| end - start);
            let beyond = [gain(speed_u, speed_v, beyond_u) / length[0], gain(speed_v, speed_u, beyond_v) / length[1]];
            [s + beyond[0] as f32, t + beyond[1] as f32]
        };
        let corners = rows.iter().flat_map(|&row| columns.iter().map(move |&column| corner(row, column))).collect();
        Self { span, columns: columns.len(), corners }
    }

    fn rows(&self) -> usize {
        self.corners.len() / self.columns
    }
}

/// The vertices of one face.
fn mesh(model: &Model, scene: &PackedScene, id: usize, grids: &[Grid]) -> Vec<Vertex> {
    let of_grid = |grid: &Grid| {
        let span = grid.span;
        grid.corners.iter().map(|&uv| corner(model, scene, id, Parameters { span, uv })).collect::<Vec<_>>()
    };
    grids.iter().flat_map(of_grid).collect()
}

/// A vertex of a face.
fn corner(model: &Model, scene: &PackedScene, id: usize, at: Parameters) -> Vertex {
    let surface = model.surface(FaceId(id as u32));
    let frame = &scene.frames[id];
    let border = at.uv.map(|t| t.clamp(0.0, 1.0));
    let (uv, length) = if at.span[0] == SEARCHED {
        let [[u0, u1], [v0, v1]] = surface.domain();
        let size = DVec2::new(u1 - u0, v1 - v0);
        (DVec2::new(u0, v0) + size * DVec2::from_array(border.map(f64::from)), size)
    } else {
        let [width, height] = [0, 1].map(|k| frame.span(k, at.span[k])).map(|[start, end]| end - start);
        (frame.uv(at.span, border), DVec2::new(width, height))
    };
    let d = surface.first_derivatives(uv.x, uv.y);
    let cross = d.su.cross(d.sv);
    let normal = match cross.try_normalize() {
        Some(n) if cross.length() > 1e-9 * d.su.length() * d.sv.length() => n,
        _ => surface.inspect(uv.x, uv.y).normal.unit().unwrap_or_default(),
    };
    let normal = if model.faces()[id].reversed { -normal } else { normal };
    let beyond = [at.uv[0] - border[0], at.uv[1] - border[1]].map(f64::from);
    let position = d.s + d.su * (beyond[0] * length.x) + d.sv * (beyond[1] * length.y);
    Vertex {
        position: frame.local(position),
        uv: at.uv,
        face: id as u32,
        span: at.span,
        normal: normal.to_array().map(|x| x as f32),
    }
}

/// The chord of each Bézier piece of a face, from the bounds of its surface's derivatives and the cells that it is cut into, plus
/// what narrowing moves; 0 where the face does not come to.
fn chord_bounds(
    bounds: &Bounds,
    surface: &Surface,
    region: Option<&Region>,
    frame: &PackedFrame,
    cells: &Cells,
) -> Vec<f64> {
    let domain = surface.domain().map(|[start, end]| end - start);
    let mut chords = vec![0.0; bounds.patches.len()];
    for index in patches_on(&spans_of(region, &frame.breaks), bounds.parts[1].len()) {
        let (size, parts) = &bounds.patches[index];
        let whole = parts.iter().copied().fold(DerivativeBounds::default(), DerivativeBounds::max);
        let (chord, interpolated) = match cells {
            Cells::OfSpans([u, v]) => {
                let [k, l] = bounds.spans(index);
                (bounds.chord(index, [&u[k], &v[l]]), *size)
            }
            Cells::OfDomain(n) => (whole.chord(domain[0] / *n as f64, domain[1] / *n as f64), domain),
        };
        // Vertices narrow to f32 (half an ulp of the local unit in each coordinate), and a grid line may stand half an
        // ulp beside its parameter.
        let speed = (whole.u * interpolated[0]).max(whole.v * interpolated[1]);
        chords[index] = chord + f64::from(f32::EPSILON) * (frame.scale + speed);
    }
    chords
}
