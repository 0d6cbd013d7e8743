//! The grids of all patches: how fine each is, and the triangles that they come to.

use super::corner::corner;
use super::joints::{FacePatches, Joints};
use super::record::{GridRecord, LOW_U};
use crate::error::PrepareError;
use crate::triangles::bounds::Bounds;
use crate::triangles::frustum::Frustum;
use crate::triangles::patches::spans_of;
use nurbs::{BezierPatch, DerivativeBounds, Surface};
use pipeline::{GREATEST_TRIANGLES, Mesh, PackedScene, Program, RATIONAL, Vertex};
use rayon::prelude::*;
use scene::{Camera, FaceId, Model, Viewport};
use std::ops::Range;

/// Triangles up to which the error asked for decides, but for one grid cell a patch.
const REFINED_TRIANGLES: f64 = (1 << 22) as f64;

/// log₂ of the cells of a patch in one direction at most.
const GREATEST_LEVEL: u32 = 11;

/// How much wider than the error the skirt of a bounded face is, pixels: what snapping moves its corners by, and what a pixel
/// may be beyond the border and still be covered.
const SKIRT_PX: f64 = 1.0 / 16.0;

/// Grids of one program with as many cells, which one draw call instances.
#[derive(Debug, Clone, PartialEq)]
pub struct Class {
    /// The program.
    pub program: Program,
    /// Cells of each along u and along v.
    pub cells: [u32; 2],
    /// Its grids.
    pub grids: Range<u32>,
}

/// Grids over all patches of a scene; none by default.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Grids {
    /// In drawing order.
    pub records: Vec<GridRecord>,
    /// The same, class by class.
    pub classes: Vec<Class>,
    /// The triangles, as the vertex stage makes them.
    pub mesh: Mesh,
    /// For each face and each of its Bézier pieces the greatest distance in model units from a point of a flat triangle to S at
    /// its parameters.
    pub chord: Vec<Vec<f64>>,
    /// Error in pixels to which it was built: more than was asked for where that would take too many triangles.
    pub built_px: f64,
}

/// What the patches of one face need.
struct Wanted<'a> {
    bounds: &'a Bounds,
    /// Of each patch of the surface, what a pixel measures where it is nearest, infinite out of the picture.
    pixels: &'a [f64],
    spans: [Range<usize>; 2],
}

impl Wanted<'_> {
    /// Numbers of its patches among the surface's, row-major in u.
    fn patches(&self) -> impl Iterator<Item = usize> {
        crate::triangles::patches::patches_on(&self.spans, self.columns())
    }

    fn columns(&self) -> usize {
        self.bounds.parts[1].len()
    }

    /// The chord of a patch with grids of these levels.
    fn chord(&self, index: usize, level: [u32; 2]) -> f64 {
        let [k, l] = self.bounds.spans(index);
        let parts = [self.bounds.parts[0][k], self.bounds.parts[1][l]];
        let cells = [0, 1].map(|k| vec![(1usize << level[k]) / parts[k]; parts[k]]);
        self.bounds.chord(index, [&cells[0], &cells[1]])
    }

    /// The least levels, the direction that gains more first, so that the chord bound of every cell is at most `error_px`.
    fn level(&self, index: usize, error_px: f64) -> [u32; 2] {
        let [k, l] = self.bounds.spans(index);
        let mut level = [self.bounds.parts[0][k], self.bounds.parts[1][l]].map(usize::ilog2);
        let allowed = error_px * self.pixels[index];
        while self.chord(index, level) > allowed {
            let finer = [[level[0] + 1, level[1]], [level[0], level[1] + 1]];
            let chords = finer.map(|level| {
                let is_legal = level.iter().all(|&level| level <= GREATEST_LEVEL);
                if is_legal { self.chord(index, level) } else { f64::INFINITY }
            });
            let best = usize::from(chords[1] < chords[0]);
            if chords[best] == f64::INFINITY {
                break;
            }
            level = finer[best];
        }
        level
    }
}

impl Grids {
    /// Grids whose flat triangles stay within `error_px` pixels of the surface as `camera` sees it.
    ///
    /// The bound on a cell is that of Filip, Magedson & Markot (1986; Geiger 2015, Eqs. 20–23), from second derivatives bounded over
    /// the patch, seen at the nearest depth of the patch's box. A border has as many parts as that patch beside it needs that
    /// needs more; then each patch has at least as many cells as its borders have parts. No cell at a border is longer than
    /// the patch itself needs, so the bound holds there, too.
    ///
    /// # Errors
    /// [`PrepareError`].
    pub fn new(
        model: &Model,
        scene: &PackedScene,
        camera: &Camera,
        viewport: Viewport,
        error_px: f64,
    ) -> Result<Self, PrepareError> {
        if error_px <= 0.0 || !error_px.is_finite() {
            return Err(PrepareError::Chord { chord_px: error_px });
        }
        let in_picture = Frustum::new(camera, viewport);
        let pixel = |patch: &BezierPatch| {
            let hull = patch.close_hull();
            if in_picture.meets(&hull) { camera.pixel_at(viewport, hull) } else { f64::INFINITY }
        };
        let of_surface = |surface: &Surface| {
            let patches = surface.bezier_patches();
            let pixels: Vec<f64> = patches.iter().map(pixel).collect();
            (Bounds::of(&patches), pixels, patches)
        };
        let surfaces: Vec<_> = model.surfaces().par_iter().map(of_surface).collect();
        let ids = || (0..model.faces().len()).map(|id| FaceId(id as u32));
        let wanted: Vec<Wanted> = ids()
            .map(|id| {
                let (bounds, pixels, _) = &surfaces[model.faces()[id.0 as usize].surface];
                let spans = spans_of(model.region(id), &scene.frames()[id.0 as usize].breaks);
                Wanted { bounds, pixels, spans }
            })
            .collect();
        let faces: Vec<FacePatches> = ids()
            .zip(&wanted)
            .map(|(id, wanted)| FacePatches {
                patches: &surfaces[model.faces()[id.0 as usize].surface].2,
                spans: wanted.spans.clone(),
                columns: wanted.columns(),
                is_bounded: model.region(id).is_some(),
            })
            .collect();
        let joints = Joints::new(&faces, model.hull().diagonal());
        let mut built_px = error_px;
        let (levels, borders) = loop {
            let (levels, borders) = levels(&wanted, &joints, built_px);
            let cells = |level: &[u32; 2]| f64::from(1u32 << level[0]) * f64::from(1u32 << level[1]);
            let triangles = 2.0 * levels.iter().flatten().map(cells).sum::<f64>();
            let least =
                2.0 * wanted.iter().flat_map(|face| face.patches().map(|i| cells(&face.level(i, 1e300)))).sum::<f64>();
            if triangles <= REFINED_TRIANGLES.max(2.0 * least) {
                break (levels, borders);
            }
            built_px *= 2.0;
        };
        let mut records = vec![];
        for (id, wanted) in ids().zip(&wanted) {
            let width = model.region(id).map_or(0.0, |_| {
                let pixels = wanted.patches().map(|index| wanted.pixels[index]).filter(|pixel| pixel.is_finite());
                (built_px + SKIRT_PX) * pixels.fold(0.0, f64::max)
            });
            let face = id.0 as usize;
            for (number, index) in wanted.patches().enumerate() {
                let [k, l] = wanted.bounds.spans(index);
                let level = levels[face][number];
                let mut record = GridRecord {
                    face: id.0,
                    sides: sides(model, scene, id, [k, l], level),
                    span: [k as u32, l as u32],
                    level,
                    skirt: (width / scene.frames()[face].scale) as f32,
                    padding: 0,
                    borders: joints.borders[face][number],
                    corners: joints.corners[face][number],
                };
                for (side, border) in record.borders.iter_mut().enumerate() {
                    border.level = borders[joints.groups[face][number][side]];
                }
                records.push(record);
            }
        }
        records.sort_by_key(|record| {
            (scene.programs()[record.face as usize], record.cells(), record.sides, record.face, record.span)
        });
        let chord = chords(scene, &wanted, &records);
        let mut grids = Self { classes: classes(scene, &records), records, mesh: Mesh::default(), chord, built_px };
        if grids.triangles() > GREATEST_TRIANGLES {
            return Err(PrepareError::TooManyTriangles { chord_px: error_px });
        }
        grids.mesh = grids.made(scene);
        Ok(grids)
    }

    /// The same grids over a scene whose control points have moved. Chords are those of the new surfaces.
    pub fn edited(&self, model: &Model, scene: &PackedScene) -> Self {
        let of_surface: Vec<Bounds> = model.surfaces().par_iter().map(|s| Bounds::of(&s.bezier_patches())).collect();
        let wanted: Vec<Wanted> = model
            .faces()
            .iter()
            .enumerate()
            .map(|(id, face)| {
                let spans = spans_of(model.region(FaceId(id as u32)), &scene.frames()[id].breaks);
                Wanted { bounds: &of_surface[face.surface], pixels: &[], spans }
            })
            .collect();
        let chord = chords(scene, &wanted, &self.records);
        Self { mesh: self.made(scene), chord, ..self.clone() }
    }

    /// Number of triangles.
    pub fn triangles(&self) -> usize {
        let of_class =
            |class: &Class| class.grids.len() * 2 * class.cells.iter().map(|&n| n as usize).product::<usize>();
        self.classes.iter().map(of_class).sum()
    }

    /// The triangles as the vertex stage makes them.
    fn made(&self, scene: &PackedScene) -> Mesh {
        let corners = |record: &GridRecord| -> Vec<Vertex> {
            let [rows, columns] = record.cells();
            (0..=rows).flat_map(|i| (0..=columns).map(move |j| corner(scene, record, i, j))).collect()
        };
        let of_records: Vec<Vec<Vertex>> = self.records.par_iter().map(corners).collect();
        let mut mesh = Mesh::with_capacity(of_records.iter().map(Vec::len).sum(), self.triangles());
        for (record, vertices) in self.records.iter().zip(&of_records) {
            let (base, first) = (mesh.vertices.len() as u32, mesh.indices.len() as u32);
            let [rows, columns] = record.cells();
            mesh.vertices.extend_from_slice(vertices);
            for i in 0..rows {
                for j in 0..columns {
                    let a = base + i * (columns + 1) + j;
                    let (b, c, d) = (a + columns + 1, a + columns + 2, a + 1);
                    mesh.indices.extend([a, b, c, a, c, d]);
                }
            }
            mesh.batch(scene.programs()[record.face as usize], first);
        }
        mesh
    }
}

/// The levels of all patches of all faces, and of all groups of borders.
fn levels(wanted: &[Wanted], joints: &Joints, error_px: f64) -> (Vec<Vec<[u32; 2]>>, Vec<u32>) {
    let mut levels: Vec<Vec<[u32; 2]>> =
        wanted.par_iter().map(|face| face.patches().map(|index| face.level(index, error_px)).collect()).collect();
    let mut borders = vec![0; joints.count];
    let each = |levels: &[Vec<[u32; 2]>]| -> Vec<([usize; 4], [u32; 2])> {
        joints.groups.iter().flatten().copied().zip(levels.iter().flatten().copied()).collect()
    };
    for (groups, [u, v]) in each(&levels) {
        // Along u = 0 and u = 1 runs v.
        for (group, level) in groups.into_iter().zip([v, v, u, u]) {
            borders[group] = level.max(borders[group]);
        }
    }
    for (groups, levels) in joints.groups.iter().flatten().zip(levels.iter_mut().flatten()) {
        let [low_u, high_u, low_v, high_v] = groups.map(|group| borders[group]);
        *levels = [levels[0].max(low_v).max(high_v), levels[1].max(low_u).max(high_u)];
    }
    (levels, borders)
}

/// On which sides of a bounded face a patch has a skirt: outer ones into whose cells the region comes.
fn sides(model: &Model, scene: &PackedScene, id: FaceId, span: [usize; 2], level: [u32; 2]) -> u32 {
    let Some(region) = model.region(id) else { return 0 };
    let (hull, breaks) = (region.hull(), &scene.frames()[id.0 as usize].breaks);
    let of = |k: usize| {
        let [start, end] = [breaks[k][span[k]], breaks[k][span[k] + 1]];
        let cell = (end - start) / f64::from(1u32 << level[k]);
        let is_low = span[k] == 0 && hull.min[k] <= start + cell;
        let is_high = span[k] + 2 == breaks[k].len() && hull.max[k] >= end - cell;
        (u32::from(is_low) | u32::from(is_high) << 1) * (LOW_U << (2 * k))
    };
    of(0) | of(1)
}

/// Runs of records that one draw call instances.
fn classes(scene: &PackedScene, records: &[GridRecord]) -> Vec<Class> {
    let key = |record: &GridRecord| (scene.programs()[record.face as usize], record.cells(), record.sides);
    let mut first = 0;
    let class = |run: &[GridRecord]| {
        let grids = first..first + run.len() as u32;
        first = grids.end;
        Class { program: key(&run[0]).0, cells: run[0].cells(), grids }
    };
    records.chunk_by(|a, b| key(a) == key(b)).map(class).collect()
}

/// The chord of each Bézier piece of each face; 0 where the face does not come to.
///
/// A cell at a border is as long as a part of the border. To the bound on cells it adds what f32 makes of corners: of the basis
/// functions, which are sums of products of what is not negative, 10 roundings a degree; of the sums over control points, which
/// are at most 1, one a term; and as much for the weights' sum. What lies on a shared border is evaluated in another face's units.
fn chords(scene: &PackedScene, wanted: &[Wanted], records: &[GridRecord]) -> Vec<Vec<f64>> {
    const UNIT: f64 = 1.0 / (1u64 << 24) as f64;
    let rounding = |face: u32| {
        let f = &scene.faces()[face as usize];
        let degrees = f64::from(f.degree_u + f.degree_v);
        let of_weights = if f.flags & RATIONAL != 0 { 2.0 } else { 1.0 };
        (11.0 * degrees + 8.0) * of_weights * UNIT * scene.frames()[face as usize].scale
    };
    let mut chords: Vec<Vec<f64>> = wanted.iter().map(|face| vec![0.0; face.bounds.patches.len()]).collect();
    for record in records {
        let face = &wanted[record.face as usize];
        let index = record.span[0] as usize * face.columns() + record.span[1] as usize;
        let [low_u, high_u, low_v, high_v] = record.borders.map(|border| border.level);
        let least = [record.level[0].min(low_v).min(high_v), record.level[1].min(low_u).min(high_u)];
        let faces =
            record.borders.iter().map(|border| border.face).chain(record.corners.iter().map(|corner| corner.face));
        let rounding = faces.chain([record.face]).map(rounding).fold(0.0, f64::max);
        let (size, parts) = &face.bounds.patches[index];
        let whole = parts.iter().copied().fold(DerivativeBounds::default(), DerivativeBounds::max);
        let speed = (whole.u * size[0]).max(whole.v * size[1]);
        chords[record.face as usize][index] = face.chord(index, least) + rounding + f64::from(f32::EPSILON) * speed;
    }
    chords
}
