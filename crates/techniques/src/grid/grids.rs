//! The grids of all patches: how fine each is, and the triangles that they come to.

use super::corner::corner;
use super::joints::{FaceParts, Joints, Part};
use super::record::{GridRecord, LOW_U};
use crate::error::PrepareError;
use crate::triangles::bounds::{part_counts, parts_of};
use crate::triangles::frustum::pixels;
use crate::triangles::patches::spans_of;
use crate::triangles::{REFINED_TRIANGLES, SKIRT_PX, cell};
use nurbs::{BezierPatch, DerivativeBounds, Surface};
use pipeline::{GREATEST_TRIANGLES, Mesh, PackedScene, Program, RATIONAL, Vertex};
use rayon::prelude::*;
use scene::{Camera, FaceId, Model, Viewport};
use std::ops::Range;

/// log₂ of the cells of a patch in one direction at most.
const GREATEST_LEVEL: u32 = 11;

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

/// A part of a surface, and what its grid depends on.
struct Measured {
    part: Part,
    /// Number of its patch among the surface's, row-major in u.
    patch: usize,
    bounds: DerivativeBounds,
    /// What a pixel measures where it is nearest, model units; infinite out of the picture.
    pixel: f64,
}

/// The parts of a surface: of each span in u and each in v its rows and columns.
struct SurfaceParts {
    counts: [Vec<usize>; 2],
    /// Patch by patch, each row-major in u.
    parts: Vec<Vec<Measured>>,
}

impl Measured {
    /// The chord of its grid of these levels.
    fn chord(&self, level: [u32; 2]) -> f64 {
        let [width, height] =
            [0, 1].map(|k| (self.part.patch.domain[k][1] - self.part.patch.domain[k][0]) / f64::from(1u32 << level[k]));
        self.bounds.chord(width, height)
    }

    /// The least levels, the direction that gains more first, so that the chord bound of every cell is at most `error_px`.
    fn level(&self, error_px: f64) -> [u32; 2] {
        let mut level = [0, 0];
        while self.chord(level) > error_px * self.pixel {
            let finer = [[level[0] + 1, level[1]], [level[0], level[1] + 1]];
            let chord = |level: [u32; 2]| {
                let is_legal = level.iter().all(|&level| level <= GREATEST_LEVEL);
                if is_legal { self.chord(level) } else { f64::INFINITY }
            };
            let chords = finer.map(chord);
            let best = usize::from(chords[1] < chords[0]);
            if chords[best] == f64::INFINITY {
                break;
            }
            level = finer[best];
        }
        level
    }
}

impl SurfaceParts {
    fn new(surface: &Surface, pixel: impl Fn(&BezierPatch) -> f64) -> Self {
        let patches = surface.bezier_patches();
        let counts = part_counts(&patches);
        let columns = counts[1].len();
        let of_patch = |(patch, whole): (usize, &BezierPatch)| {
            let span = [patch / columns, patch % columns];
            let count = [counts[0][span[0]], counts[1][span[1]]];
            let measured = |(index, part): (usize, BezierPatch)| {
                let at = [index / count[1], index % count[1]];
                let size = count.map(|count| 1.0 / count as f32);
                let from = [0, 1].map(|k| at[k] as f32 * size[k]);
                let (bounds, pixel) = (part.derivative_bounds(), pixel(&part));
                let part = Part { span: span.map(|k| k as u32), from, size, patch: part };
                Measured { part, patch, bounds, pixel }
            };
            parts_of(whole, count).into_iter().enumerate().map(measured).collect()
        };
        let parts = patches.iter().enumerate().map(of_patch).collect();
        Self { counts, parts }
    }

    /// The parts on ranges of spans, row by row, and how many a row has.
    fn on(&self, [us, vs]: &[Range<usize>; 2]) -> (Vec<&Measured>, usize) {
        let columns = self.counts[1].len();
        let row = |k: usize, i: usize| {
            vs.clone().flat_map(move |l| {
                let count = self.counts[1][l];
                self.parts[k * columns + l][i * count..(i + 1) * count].iter()
            })
        };
        let rows = us.clone().flat_map(|k| (0..self.counts[0][k]).map(move |i| (k, i)));
        (rows.flat_map(|(k, i)| row(k, i)).collect(), vs.clone().map(|l| self.counts[1][l]).sum())
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
        let pixel = pixels(camera, viewport);
        let surfaces: Vec<SurfaceParts> =
            model.surfaces().par_iter().map(|surface| SurfaceParts::new(surface, &pixel)).collect();
        let faces = faces(model, scene, &surfaces);
        let joints =
            Joints::new(&faces.iter().map(|face| face.parts(model)).collect::<Vec<_>>(), model.hull().diagonal());
        let mut built_px = error_px;
        let (levels, borders) = loop {
            let (levels, borders) = levels(&faces, &joints, built_px);
            let cells = |level: &[u32; 2]| f64::from(1u32 << level[0]) * f64::from(1u32 << level[1]);
            let triangles = 2.0 * levels.iter().flatten().map(cells).sum::<f64>();
            let least = 2.0 * faces.iter().map(|face| face.measured.len() as f64).sum::<f64>();
            if triangles <= (REFINED_TRIANGLES as f64).max(2.0 * least) {
                break (levels, borders);
            }
            built_px *= 2.0;
        };
        let mut records = vec![];
        for (face, of_face) in faces.iter().enumerate() {
            let width = model.region(of_face.id).map_or(0.0, |_| {
                let pixels = of_face.measured.iter().map(|part| part.pixel).filter(|pixel| pixel.is_finite());
                (built_px + SKIRT_PX) * pixels.fold(0.0, f64::max)
            });
            for (number, Measured { part, .. }) in of_face.measured.iter().enumerate() {
                let level = levels[face][number];
                let mut record = GridRecord {
                    face: of_face.id.0,
                    sides: sides(model, scene, of_face.id, part, level),
                    span: part.span,
                    level,
                    from: part.from,
                    size: part.size,
                    skirt: (width / scene.frames()[face].scale) as f32,
                    padding: 0,
                    borders: joints.borders[face][number],
                    corners: joints.corners[face][number],
                };
                for (side, border) in record.borders.iter_mut().enumerate() {
                    border.level = borders[joints.groups[face][number][side]];
                }
                records.push((record, of_face.measured[number]));
            }
        }
        let chord = chords(scene, &records);
        let mut records: Vec<GridRecord> = records.into_iter().map(|(record, _)| record).collect();
        records.sort_by_key(|record| {
            let place = record.from.map(f32::to_bits);
            (scene.programs()[record.face as usize], record.cells(), record.sides, record.face, record.span, place)
        });
        let mut grids = Self { classes: classes(scene, &records), records, mesh: Mesh::default(), chord, built_px };
        if grids.triangles() > GREATEST_TRIANGLES {
            return Err(PrepareError::TooManyTriangles { chord_px: error_px });
        }
        grids.mesh = grids.made(scene);
        Ok(grids)
    }

    /// The same grids over a scene whose control points have moved; `None` where the edit leaves other parts than there were.
    /// Chords are those of the new surfaces.
    pub fn edited(&self, model: &Model, scene: &PackedScene) -> Option<Self> {
        let surfaces: Vec<SurfaceParts> =
            model.surfaces().par_iter().map(|surface| SurfaceParts::new(surface, |_| f64::INFINITY)).collect();
        let faces = faces(model, scene, &surfaces);
        let measured = |record: &GridRecord| {
            let is_own = |part: &&&Measured| part.part.span == record.span && part.part.from == record.from;
            faces.get(record.face as usize)?.measured.iter().find(is_own).map(|part| (*record, *part))
        };
        let records: Vec<_> = self.records.iter().map(measured).collect::<Option<_>>()?;
        if records.len() != faces.iter().map(|face| face.measured.len()).sum::<usize>() {
            return None;
        }
        let chord = chords(scene, &records);
        Some(Self { mesh: self.made(scene), chord, ..self.clone() })
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
                    mesh.indices.extend(cell(base + i * (columns + 1) + j, columns + 1));
                }
            }
            mesh.batch(scene.programs()[record.face as usize], first);
        }
        mesh
    }
}

/// The parts that a face comes to.
struct Face<'s> {
    id: FaceId,
    measured: Vec<&'s Measured>,
    columns: usize,
}

impl Face<'_> {
    fn parts(&self, model: &Model) -> FaceParts {
        let parts = self.measured.iter().map(|measured| measured.part.clone()).collect();
        FaceParts { parts, columns: self.columns, is_bounded: model.region(self.id).is_some() }
    }
}

fn faces<'s>(model: &Model, scene: &PackedScene, surfaces: &'s [SurfaceParts]) -> Vec<Face<'s>> {
    let of_face = |(k, face): (usize, &scene::Face)| {
        let id = FaceId(k as u32);
        let spans = spans_of(model.region(id), &scene.frames()[k].breaks);
        let (measured, columns) = surfaces[face.surface].on(&spans);
        Face { id, measured, columns }
    };
    model.faces().iter().enumerate().map(of_face).collect()
}

/// The levels of all parts of all faces, and of all groups of borders.
fn levels(faces: &[Face], joints: &Joints, error_px: f64) -> (Vec<Vec<[u32; 2]>>, Vec<u32>) {
    let mut levels: Vec<Vec<[u32; 2]>> =
        faces.par_iter().map(|face| face.measured.iter().map(|part| part.level(error_px)).collect()).collect();
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

/// On which sides of a bounded face a part has a skirt: outer ones into whose cells the region comes.
fn sides(model: &Model, scene: &PackedScene, id: FaceId, part: &Part, level: [u32; 2]) -> u32 {
    let Some(region) = model.region(id) else { return 0 };
    let (hull, breaks) = (region.hull(), &scene.frames()[id.0 as usize].breaks);
    let of = |k: usize| {
        let [start, end] = part.patch.domain[k];
        let cell = (end - start) / f64::from(1u32 << level[k]);
        let is_first = part.span[k] == 0 && part.from[k] == 0.0;
        let is_last = part.span[k] as usize + 2 == breaks[k].len() && part.from[k] + part.size[k] == 1.0;
        let is_low = is_first && hull.min[k] <= start + cell;
        let is_high = is_last && hull.max[k] >= end - cell;
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
fn chords(scene: &PackedScene, records: &[(GridRecord, &Measured)]) -> Vec<Vec<f64>> {
    const UNIT: f64 = 1.0 / (1u64 << 24) as f64;
    let rounding = |face: u32| {
        let f = &scene.faces()[face as usize];
        let degrees = f64::from(f.degree_u + f.degree_v);
        let of_weights = if f.flags & RATIONAL != 0 { 2.0 } else { 1.0 };
        (11.0 * degrees + 8.0) * of_weights * UNIT * scene.frames()[face as usize].scale
    };
    let mut chords: Vec<Vec<f64>> = scene.frames().iter().map(|frame| vec![0.0; frame.pieces()]).collect();
    for (record, measured) in records {
        let [low_u, high_u, low_v, high_v] = record.borders.map(|border| border.level);
        let least = [record.level[0].min(low_v).min(high_v), record.level[1].min(low_u).min(high_u)];
        let borders = record.borders.iter().map(|border| border.face);
        let faces = borders.chain(record.corners.iter().map(|corner| corner.face)).chain([record.face]);
        let rounding = faces.map(rounding).fold(0.0, f64::max);
        let [width, height] = measured.part.patch.domain.map(|[start, end]| end - start);
        let size = measured.part.size.map(f64::from);
        let speed = (measured.bounds.u * width / size[0]).max(measured.bounds.v * height / size[1]);
        let chord = measured.chord(least) + rounding + f64::from(f32::EPSILON) * speed;
        let of_patch = &mut chords[record.face as usize][measured.patch];
        *of_patch = chord.max(*of_patch);
    }
    chords
}
