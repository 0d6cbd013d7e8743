//! The grids of all patches: what each depends on, and the triangles that they come to in a picture.

use super::corner::corner;
use super::joints::{FaceParts, Joints, Part};
use super::levels::{Asked, Chosen, settled};
use super::record::{GridRecord, Measure};
use super::tiles::{Run, Tile, in_drawing_order};
use crate::error::PrepareError;
use crate::limits::GREATEST_LEVEL;
use crate::technique::Setting;
use crate::triangles::bounds::{part_counts, parts_of};
use crate::triangles::cell;
use crate::triangles::coarsened::coarsened;
use crate::triangles::floor::{floor, height};
use crate::triangles::patches::spans_of;
use crate::triangles::rounding::rounding;
use compare::{Cells, Seams};
use nurbs::{BezierPatch, DerivativeBounds, Hull, Surface};
use pipeline::{GREATEST_TRIANGLES, Mesh, PackedScene, Program, Vertex, View};
use rayon::prelude::*;
use scene::{FaceId, Model};
use std::ops::Range;
use std::sync::Arc;

/// Grids over all patches of a scene, as a picture has them; none by default.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Grids {
    /// What of them no view changes, grouped by programs.
    pub records: Vec<GridRecord>,
    /// What their levels depend on.
    pub measures: Vec<Measure>,
    /// The programs, and the grids of each.
    pub programs: Vec<(Program, Range<usize>)>,
    /// What levels are asked for.
    pub asked: Asked,
    /// Error in pixels to which it was built: more than was asked for where that would take too many triangles or levels.
    pub built_px: f64,
    /// How the picture sees each face.
    views: Vec<View>,
    /// The picture.
    pub picture: Picture,
    /// For each face and each of its Bézier pieces the greatest distance in model units from a point of a flat triangle to S at
    /// its parameters.
    pub chord: Vec<Vec<f64>>,
    /// How each of them is cut.
    pub cells: Vec<Vec<Cells>>,
    /// Where faces meet.
    pub seams: Arc<Seams>,
}

/// The grids of one picture; none by default.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Picture {
    /// With levels.
    pub records: Vec<GridRecord>,
    /// In drawing order.
    pub tiles: Vec<Tile>,
    /// Those of each draw call that draws any.
    pub runs: Vec<Run>,
    /// The triangles as the vertex stage makes them.
    pub mesh: Mesh,
}

/// A part of a surface, and what its grid depends on.
struct Measured {
    part: Part,
    /// Number of its patch among the surface's, row-major in u.
    patch: usize,
    bounds: DerivativeBounds,
    /// Least levels that normals at corners ask for; each 0 where normals are not theirs.
    floor: [u32; 2],
    /// A box that holds its whole patch: the chord is one number for all parts of a patch, so all are as far away.
    hull: Hull,
}

/// The parts of a surface: of each span in u and each in v its rows and columns.
struct SurfaceParts {
    counts: [Vec<usize>; 2],
    /// Patch by patch, each row-major in u.
    parts: Vec<Vec<Measured>>,
}

impl Measured {
    /// How long its parameters run.
    fn size(&self) -> [f64; 2] {
        self.part.patch.domain.map(|[start, end]| end - start)
    }

    /// The chord of its grid of these levels.
    fn chord(&self, level: [u32; 2]) -> f64 {
        let [width, height] = self.size();
        self.bounds.chord(width / f64::from(1u32 << level[0]), height / f64::from(1u32 << level[1]))
    }

    /// What its levels depend on, as a part of a face with this number of the scene.
    fn measure(&self, model: &Model, scene: &PackedScene, id: FaceId, groups: [usize; 4]) -> Measure {
        let frame = &scene.frames()[id.0 as usize];
        let [low, high] = [self.hull.min, self.hull.max].map(|p| (p - frame.origin) / frame.scale);
        let center = ((low + high) * 0.5).as_vec3();
        let exact = center.as_dvec3();
        let half = (high - exact).max(exact - low).to_array().map(outward);
        let [width, height] = self.size();
        let DerivativeBounds { uu, uv, vv, .. } = self.bounds;
        let bend = [uu * width * width, 2.0 * uv * width * height, vv * height * height];
        Measure {
            center: center.to_array(),
            diagonal: ((high - low).length()) as f32,
            half,
            skirts: skirts(model, scene, id, &self.part),
            bend: bend.map(|x| outward(x / (8.0 * frame.scale))),
            floor: Measure::packed_floor(self.floor),
            groups: groups.map(|group| group as u32),
        }
    }
}

/// The least f32 that is not less, or the one after it.
fn outward(x: f64) -> f32 {
    (x * (1.0 + f64::from(f32::EPSILON))) as f32
}

impl SurfaceParts {
    fn new(surface: &Surface, vertex_normals: bool) -> Self {
        let patches = surface.bezier_patches();
        let counts = part_counts(&patches);
        let columns = counts[1].len();
        let of_patch = |(patch, whole): (usize, &BezierPatch)| {
            let span = [patch / columns, patch % columns];
            let (count, hull) = ([counts[0][span[0]], counts[1][span[1]]], whole.close_hull());
            let measured = |(index, part): (usize, BezierPatch)| {
                let at = [index / count[1], index % count[1]];
                let size = count.map(|count| 1.0 / count as f32);
                let from = [0, 1].map(|k| at[k] as f32 * size[k]);
                let bounds = part.derivative_bounds();
                let floor = if vertex_normals { floor(&part) } else { [0, 0] };
                let part = Part { span: span.map(|k| k as u32), from, size, patch: part };
                Measured { part, patch, bounds, floor, hull }
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
    /// Grids whose flat triangles stay within the chord error of the surface as the camera sees it, as far as levels go.
    ///
    /// The bound on a cell is that of Filip, Magedson & Markot (1986; Geiger 2015, Eqs. 20–23), from second derivatives bounded over
    /// the patch, seen at the nearest depth of the patch's box. No cell at a border is longer than the patch beside it needs
    /// (`levels::settled`), so the bound holds there, too.
    ///
    /// # Errors
    /// [`PrepareError`].
    pub fn new(setting: &Setting) -> Result<Self, PrepareError> {
        let Setting { model, scene, camera, viewport, chord_px, limits, vertex_normals } = *setting;
        let surfaces: Vec<SurfaceParts> = {
            let of_surface = |surface: &Surface| SurfaceParts::new(surface, vertex_normals);
            model.surfaces().par_iter().map(of_surface).collect()
        };
        let faces = faces(model, scene, &surfaces);
        let joints = Joints::new(
            &faces.iter().map(|face| face.parts(model, scene)).collect::<Vec<_>>(),
            model.hull().diagonal(),
        );
        let mut placed: Vec<Placed> = faces
            .par_iter()
            .enumerate()
            .flat_map_iter(|(index, face)| face.placed(model, scene, &joints, index))
            .collect();
        // Within a program in the order of faces.
        placed.sort_by_key(|placed| scene.programs()[placed.record.face as usize]);
        let records: Vec<GridRecord> = placed.iter().map(|placed| placed.record).collect();
        let measures: Vec<Measure> = placed.iter().map(|placed| placed.measure).collect();
        let programs = programs(scene, &records);
        let views = scene.views(model, camera, viewport);
        let least = 4 * records.len();
        if least > GREATEST_TRIANGLES {
            return Err(PrepareError::TooManyTriangles { chord_px });
        }
        let seams = Arc::new(joints.seams);
        let mut grids = Self { records, measures, programs, views, seams, ..Self::default() };
        let most = limits.level.min(GREATEST_LEVEL);
        if vertex_normals {
            grids.asked = Asked::new(f64::INFINITY, most);
            height(|height| {
                grids.lower_floors(&placed, height.min(most));
                triangles(&grids.settled(&grids.views).0)
            });
        }
        let ((records, chosen), kept_px) = coarsened(chord_px, [least, limits.triangles].map(|n| n as f64), |px| {
            grids.asked = Asked::new(px, most);
            let (records, chosen) = grids.settled(&grids.views);
            let triangles = triangles(&records);
            ((records, chosen), triangles)
        })?;
        let short = chosen.iter().filter(|chosen| chosen.is_seen).map(|chosen| chosen.short).fold(1.0, f32::max);
        grids.built_px = kept_px * f64::from(short);
        grids.picture = Picture::new(scene, &grids.views, &grids.programs, records);
        (grids.chord, grids.cells) = of_pieces(scene, &placed, &chosen);
        Ok(grids)
    }

    /// The grids as another picture has them, whose views of the same scene these are.
    pub fn seen(&self, scene: &PackedScene, views: &[View]) -> Picture {
        Picture::new(scene, views, &self.programs, self.settled(views).0)
    }

    /// Gives each grid its floor up to a height.
    fn lower_floors(&mut self, placed: &[Placed], height: u32) {
        for (measure, placed) in self.measures.iter_mut().zip(placed) {
            measure.floor = Measure::packed_floor(placed.measure.least().map(|level| level.min(height)));
        }
    }

    /// Whether the picture is that of these views.
    pub fn is_of(&self, views: &[View]) -> bool {
        self.views == views
    }

    fn settled(&self, views: &[View]) -> (Vec<GridRecord>, Vec<Chosen>) {
        settled(&self.records, &self.measures, views, &self.asked)
    }
}

/// Triangles of settled records.
fn triangles(records: &[GridRecord]) -> f64 {
    2.0 * records.iter().map(|record| record.cells().map(f64::from).iter().product::<f64>()).sum::<f64>()
}

impl Picture {
    /// The picture of settled records, of which these are each program's.
    fn new(
        scene: &PackedScene,
        views: &[View],
        programs: &[(Program, Range<usize>)],
        records: Vec<GridRecord>,
    ) -> Self {
        let (tiles, runs) = in_drawing_order(&records, programs);
        let mesh = mesh(scene, views, &records, &tiles, &runs);
        Self { records, tiles, runs, mesh }
    }
}

/// The triangles of tiles as the vertex stage makes them; the corners of each grid stand together, row by row.
fn mesh(scene: &PackedScene, views: &[View], records: &[GridRecord], tiles: &[Tile], runs: &[Run]) -> Mesh {
    let corners = |record: &GridRecord| -> Vec<Vertex> {
        let [rows, columns] = record.cells();
        if rows == 0 {
            return vec![];
        }
        let view = &views[record.face as usize];
        (0..=rows).flat_map(|i| (0..=columns).map(move |j| corner(scene, view, record, i, j))).collect()
    };
    let of_records: Vec<Vec<Vertex>> = records.par_iter().map(corners).collect();
    let mut firsts = Vec::with_capacity(records.len());
    let mut mesh = Mesh::with_capacity(of_records.iter().map(Vec::len).sum(), 0);
    for vertices in &of_records {
        firsts.push(mesh.vertices.len() as u32);
        mesh.vertices.extend_from_slice(vertices);
    }
    for Run { program, size, tiles: range } in runs {
        let first = mesh.indices.len() as u32;
        for Tile { grid, at: [row, column] } in &tiles[range.clone()] {
            let across = records[*grid as usize].cells()[1] + 1;
            for (i, j) in (0..1 << size[0]).flat_map(|i| (0..1 << size[1]).map(move |j| (i, j))) {
                mesh.indices.extend(cell(firsts[*grid as usize] + (row + i) * across + column + j, across));
            }
        }
        mesh.batch(*program, first);
    }
    mesh
}

/// A part of a face with its records.
struct Placed<'s> {
    record: GridRecord,
    measure: Measure,
    measured: &'s Measured,
}

/// The parts that a face comes to.
struct Face<'s> {
    id: FaceId,
    measured: Vec<&'s Measured>,
    columns: usize,
}

impl<'s> Face<'s> {
    fn parts(&self, model: &Model, scene: &PackedScene) -> FaceParts {
        let parts = self.measured.iter().map(|measured| measured.part.clone()).collect();
        let program = scene.programs()[self.id.0 as usize];
        FaceParts { parts, columns: self.columns, is_bounded: model.region(self.id).is_some(), program }
    }

    /// Its parts with their records; it is number `index` of those whose joints these are.
    fn placed(&self, model: &Model, scene: &PackedScene, joints: &Joints, index: usize) -> Vec<Placed<'s>> {
        let place = |(number, measured): (usize, &&'s Measured)| Placed {
            record: GridRecord {
                face: self.id.0,
                sides: 0,
                span: measured.part.span,
                level: [0, 0],
                from: measured.part.from,
                size: measured.part.size,
                skirt: 0.0,
                padding: 0,
                borders: joints.borders[index][number],
                corners: joints.corners[index][number],
            },
            measure: measured.measure(model, scene, self.id, joints.groups[index][number]),
            measured,
        };
        self.measured.iter().enumerate().map(place).collect()
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

/// [`Measure::skirts`] of a part of a bounded face: outer sides into whose cells the region comes.
fn skirts(model: &Model, scene: &PackedScene, id: FaceId, part: &Part) -> u32 {
    let Some(region) = model.region(id) else { return 0 };
    let (hull, breaks) = (region.hull(), &scene.frames()[id.0 as usize].breaks);
    let of = |side: usize| {
        let k = side / 2;
        let [start, end] = part.patch.domain[k];
        let is_first = part.span[k] == 0 && part.from[k] == 0.0;
        let is_last = part.span[k] as usize + 2 == breaks[k].len() && part.from[k] + part.size[k] == 1.0;
        // How far from the side the region stays.
        let (is_outer, away) =
            if side.is_multiple_of(2) { (is_first, hull.min[k] - start) } else { (is_last, end - hull.max[k]) };
        let reaches = |level: &u32| is_outer && away <= (end - start) / f64::from(1u32 << level);
        (0..=GREATEST_LEVEL).take_while(reaches).count() as u32
    };
    (0..4).fold(0, |skirts, side| skirts | of(side) << (8 * side))
}

/// Runs of grids of one program.
fn programs(scene: &PackedScene, records: &[GridRecord]) -> Vec<(Program, Range<usize>)> {
    let program = |record: &GridRecord| scene.programs()[record.face as usize];
    let mut first = 0;
    let of_run = |run: &[GridRecord]| {
        let grids = first..first + run.len();
        first = grids.end;
        (program(&run[0]), grids)
    };
    records.chunk_by(|a, b| program(a) == program(b)).map(of_run).collect()
}

/// Of each Bézier piece of each face the chord and the greatest cells of its parts, by the levels that each patch asks for alone, seen
/// or not: borders make cells shorter. All are 0 where the face does not come to.
///
/// To the bound on cells the chord adds what f32 makes of corners ([`rounding`]). What lies on a shared border is evaluated in another
/// face's units.
fn of_pieces(scene: &PackedScene, placed: &[Placed], chosen: &[Chosen]) -> (Vec<Vec<f64>>, Vec<Vec<Cells>>) {
    let mut chords: Vec<Vec<f64>> = scene.frames().iter().map(|frame| vec![0.0; frame.pieces()]).collect();
    let mut cells: Vec<Vec<Cells>> =
        scene.frames().iter().map(|frame| vec![Cells::in_parts([1, 1]); frame.pieces()]).collect();
    for (Placed { record, measured, .. }, Chosen { level, .. }) in placed.iter().zip(chosen) {
        let borders = record.borders.iter().map(|border| border.face);
        let faces = borders.chain(record.corners.iter().map(|corner| corner.face)).chain([record.face]);
        let rounding = faces.map(|face| rounding(scene, face)).fold(0.0, f64::max);
        let [width, height] = measured.size();
        let size = measured.part.size.map(f64::from);
        let speed = (measured.bounds.u * width / size[0]).max(measured.bounds.v * height / size[1]);
        let chord = measured.chord(*level) + rounding + f64::from(f32::EPSILON) * speed;
        let (face, patch) = (record.face as usize, measured.patch);
        chords[face][patch] = chord.max(chords[face][patch]);
        let cells = &mut cells[face][patch];
        let parts = size.map(|size| (1.0 / size).round() as usize);
        if cells.parts != parts {
            *cells = Cells::in_parts(parts);
        }
        let at = [0, 1].map(|k| (f64::from(measured.part.from[k]) * parts[k] as f64).round() as usize);
        cells.sizes[at[0] * parts[1] + at[1]] = level.map(|level| 1.0 / f64::from(1u32 << level));
    }
    (chords, cells)
}
