//! The triangles of technique `fragment`: a coarse tessellation, whose corners carry (u, v, face).

use super::cells::{Cells, GREATEST_CELLS, Wanted, chord_bounds, total};
use super::grid::{FaceMesh, Grid, Skirt, corner, grids_of_spans, mesh};
use super::joints::{Joints, Site};
use crate::error::PrepareError;
use crate::technique::Setting;
use crate::triangles::SKIRT_PX;
use crate::triangles::bounds::Bounds;
use crate::triangles::coarsened::{REFINED_TRIANGLES, coarsened};
use crate::triangles::cut::is_at_border;
use crate::triangles::floor::height;
use crate::triangles::frustum::pixels;
use crate::triangles::patches::spans_of;
use crate::triangles::rounding::rounding;
use compare::Seams;
use nurbs::Surface;
use pipeline::{Batch, GREATEST_TRIANGLES, Mesh, PackedScene, Parameters, SEARCHED, Vertex, in_drawing_order};
use rayon::prelude::*;
use scene::{Face, FaceId, Model};
use std::collections::BTreeSet;
use std::sync::Arc;

/// Flat triangles over all faces of a scene; none by default.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Tessellation {
    /// The triangles; their corners are shared within a face.
    pub mesh: Mesh,
    /// For each face and each of its Bézier pieces, row-major in u as of [`Surface::bezier_patches`], the greatest distance in
    /// model units from a point of a flat triangle to S at its parameters.
    pub chord: Vec<Vec<f64>>,
    /// Chord error in pixels to which it was built: more than was asked for where that would take too many triangles.
    pub built_px: f64,
    /// How each face is cut into cells.
    cells: Vec<Cells>,
    /// How each piece is cut.
    normal_cells: Vec<Vec<compare::Cells>>,
    /// Of each face that loops bound.
    skirts: Vec<Option<Skirt>>,
    /// What faces share.
    joints: Joints,
    /// The same, in the judge's words.
    pub(super) seams: Arc<Seams>,
    /// The corners that are evaluated for several faces at once, ascending by their places in the mesh.
    shared: Vec<(u32, Site)>,
    /// Whether what is shown is what the triangles carry.
    vertex_normals: bool,
}

impl Tessellation {
    /// A tessellation whose flat triangles stay within the chord error of the surface as the camera sees it.
    ///
    /// The bound is that of Filip, Magedson & Markot (1986) on each cell of a grid that follows the knots, from
    /// second derivatives bounded over the cell's Bézier patch, seen at the nearest depth of the patch's box
    /// (`Camera::pixel_at`). A patch that is out of the picture is not cut. Where the bound asks for over four million
    /// triangles the chord error is doubled until it does not: [`Self::built_px`].
    ///
    /// A face that loops bound has a skirt: its triangles go on beyond the domain's border, straight away from it as the camera
    /// sees it, by what they may fall short of the border; their parameters go on too. What lies beyond the border is cut
    /// ([`is_shown`](pipeline::sight::is_shown)). No skirt goes on from a collapsed border.
    ///
    /// Faces that no loops bound and that have a whole border in common meet there vertex on vertex: each has the corners of all.
    ///
    /// # Errors
    /// [`PrepareError`].
    pub fn new(setting: &Setting) -> Result<Self, PrepareError> {
        let Setting { model, scene, camera, viewport, chord_px, vertex_normals, .. } = *setting;
        let pixel = pixels(camera, viewport);
        let of_surface = |surface: &Surface| {
            let patches = surface.bezier_patches();
            let bounds = Bounds::of(&patches);
            let floors = if vertex_normals { bounds.floors(&patches) } else { vec![] };
            (bounds, patches.iter().map(&pixel).collect(), floors)
        };
        type OfSurface = (Bounds, Vec<f64>, Vec<Vec<[u32; 2]>>);
        let surfaces: Vec<OfSurface> = model.surfaces().par_iter().map(of_surface).collect();
        let of_face = |(id, face): (usize, &Face)| {
            let (bounds, pixels, floors) = &surfaces[face.surface];
            let spans = spans_of(model.region(FaceId(id as u32)), &scene.frames()[id].breaks);
            Wanted { bounds, pixels, spans, floors }
        };
        let wanted: Vec<Wanted> = model.faces().iter().enumerate().map(of_face).collect();
        let parts =
            |face: &Wanted| [0, 1].map(|k| total(&face.bounds.parts[k][face.spans[k].clone()])).iter().product::<f64>();
        let least = 4.0 * wanted.iter().map(parts).sum::<f64>();
        type Counts = [Vec<Vec<usize>>; 2];
        let along = |spans: &[Vec<usize>]| spans.iter().map(|parts| total(parts)).sum::<f64>();
        let joints = Joints::new(model);
        let triangles = |cells: &[Counts]| {
            let of_face = |(face, cells): (&Wanted, &Counts)| {
                [0, 1].map(|k| along(&cells[k][face.spans[k].clone()])).iter().product::<f64>()
            };
            // A corner from another face brings one triangle, and the fan that it makes of its cell two.
            2.0 * wanted.iter().zip(cells).map(of_face).sum::<f64>() + 3.0 * joints.most_foreign(cells)
        };
        let floors = |height: u32| wanted.par_iter().map(|face| face.least(height)).collect::<Vec<Counts>>();
        let floors = floors(if vertex_normals { height(|height| triangles(&floors(height))) } else { 0 });
        let (cells, built_px) = coarsened(chord_px, [least, REFINED_TRIANGLES as f64], |px| {
            let of_face = |(face, floors): (&Wanted, &Counts)| face.cells(px, floors.clone());
            let cells: Vec<Counts> = wanted.par_iter().zip(&floors).map(of_face).collect();
            let triangles = triangles(&cells);
            (cells, triangles)
        })?;
        let grids = cells
            .par_iter()
            .enumerate()
            .map(|(id, cells)| {
                let region = model.region(FaceId(id as u32));
                grids_of_spans(&scene.frames()[id].breaks, cells, &wanted[id].spans, region)
            })
            .collect();
        let skirt = |(id, face): (usize, &Wanted)| {
            let pixels = face.patches().map(|index| face.pixels[index]).filter(|pixel| pixel.is_finite());
            let width = (built_px + SKIRT_PX) * pixels.fold(0.0, f64::max);
            model.region(FaceId(id as u32)).map(|_| Skirt { camera: *camera, width })
        };
        let skirts = wanted.iter().enumerate().map(skirt).collect();
        let cells = cells.into_iter().map(Cells::OfSpans).collect();
        let bounds: Vec<&Bounds> = wanted.iter().map(|face| face.bounds).collect();
        Self::over(model, scene, &bounds, cells, (grids, skirts, joints), (built_px, vertex_normals))
            .ok_or(PrepareError::TooManyTriangles { chord_px })
    }

    /// A tessellation of every face into `cells` × `cells` cells of equal parameters, wherever its knots lie, as
    /// Kanai's Table 1 counts them. Fragments find their knot spans by binary search.
    ///
    /// # Errors
    /// [`PrepareError::TooManyTriangles`].
    pub fn uniform(model: &Model, scene: &PackedScene, cells: usize) -> Result<Self, PrepareError> {
        let too_many = PrepareError::TooManyTriangles { chord_px: f64::NAN };
        if cells == 0 || cells > GREATEST_CELLS || model.faces().len() * cells * cells > GREATEST_TRIANGLES / 2 {
            return Err(too_many);
        }
        let lines: Vec<f32> = (0..=cells).map(|i| (i as f64 / cells as f64) as f32).collect();
        let grid = || Grid::new([SEARCHED; 2], &lines, &lines);
        let grids = model.faces().iter().map(|_| vec![grid()]).collect();
        let of_surface: Vec<Bounds> = model.surfaces().par_iter().map(|s| Bounds::of(&s.bezier_patches())).collect();
        let bounds: Vec<&Bounds> = model.faces().iter().map(|face| &of_surface[face.surface]).collect();
        let cells = vec![Cells::OfDomain(cells); model.faces().len()];
        let skirts = vec![None; model.faces().len()];
        Self::over(model, scene, &bounds, cells, (grids, skirts, Joints::default()), (f64::NAN, false)).ok_or(too_many)
    }

    fn over(
        model: &Model,
        scene: &PackedScene,
        bounds: &[&Bounds],
        cells: Vec<Cells>,
        (grids, skirts, joints): (Vec<Vec<Grid>>, Vec<Option<Skirt>>, Joints),
        (built_px, vertex_normals): (f64, bool),
    ) -> Option<Self> {
        let triangles: usize = grids.iter().flatten().map(|grid| 2 * (grid.rows() - 1) * (grid.columns - 1)).sum();
        if triangles > GREATEST_TRIANGLES {
            return None;
        }
        let foreign = joints.foreign(&cells);
        let of_face = |(id, grids): (usize, &Vec<Grid>)| {
            mesh(model, scene, id, (grids, skirts[id].as_ref()), &joints, &foreign, &cells[id])
        };
        let mut meshes: Vec<FaceMesh> = grids.par_iter().enumerate().map(of_face).collect();
        let total = |count: fn(&FaceMesh) -> usize| meshes.iter().map(count).sum::<usize>();
        let [vertices, indices] = [total(|mesh| mesh.vertices.len()), total(|mesh| mesh.indices.len())];
        if indices > 3 * GREATEST_TRIANGLES {
            return None;
        }
        let mut all = Mesh::with_capacity(vertices, indices / 3);
        let mut shared = vec![];
        for id in in_drawing_order(scene) {
            let base = all.vertices.len() as u32;
            let first = all.indices.len() as u32;
            let mesh = std::mem::take(&mut meshes[id]);
            all.vertices.extend(mesh.vertices);
            all.indices.extend(mesh.indices.iter().map(|index| base + index));
            shared.extend(mesh.shared.iter().map(|(vertex, site)| (base + vertex, *site)));
            all.batch(scene.programs()[id], first);
        }
        // A corner of a face's program comes after those of programs before.
        shared.sort_by_key(|(vertex, _)| *vertex);
        shared.dedup_by_key(|(vertex, _)| *vertex);
        let of_pieces = |(cells, bounds): (&Cells, &&Bounds)| cells.of_pieces(bounds);
        let normal_cells = cells.iter().zip(bounds).map(of_pieces).collect();
        let chord = vec![vec![]; cells.len()];
        let mut all = Self {
            mesh: all,
            chord,
            built_px,
            cells,
            normal_cells,
            skirts,
            seams: Arc::new(joints.seams()),
            joints,
            shared,
            vertex_normals,
        };
        let narrowed = all.narrowed(scene);
        let chord = |(id, narrowed): (usize, &[f64; 2])| all.chord_of(model, scene, id, bounds[id], *narrowed);
        all.chord = narrowed.par_iter().enumerate().map(chord).collect();
        Some(all)
    }

    /// For each face and each of its Bézier pieces how it is cut.
    pub fn normal_cells(&self) -> &[Vec<compare::Cells>] {
        &self.normal_cells
    }

    /// The triangles that are of a skirt or touch the border before one, from where interpolation may step onto it by a rounding error:
    /// their indices, and those of each program.
    pub(super) fn beside_skirts(&self) -> (Vec<u32>, Vec<Batch>) {
        let is_beside = |number: &u32| {
            let Vertex { face, span, uv, .. } = self.mesh.vertices[*number as usize];
            let Cells::OfSpans(spans) = &self.cells[face as usize] else { return false };
            let spans = spans.each_ref().map(|spans| spans.len() as u32);
            self.skirts[face as usize].is_some() && is_at_border(Parameters { span, uv }, spans)
        };
        let mut beside = Mesh::default();
        for batch in &self.mesh.batches {
            let first = beside.indices.len() as u32;
            let triangles = self.mesh.indices[batch.first as usize..][..batch.count as usize].chunks_exact(3);
            triangles
                .filter(|corners| corners.iter().any(is_beside))
                .for_each(|corners| beside.indices.extend(corners));
            beside.batch(batch.program, first);
        }
        (beside.indices, beside.batches)
    }

    /// Of each face, model units: the greatest local unit in which its corners are narrowed; and how far off the device evaluates some of
    /// them by itself, where it shows what lies on the triangles.
    fn narrowed(&self, scene: &PackedScene) -> Vec<[f64; 2]> {
        let scale = |id: usize| scene.frames()[id].scale;
        let mut narrowed: Vec<[f64; 2]> = (0..self.cells.len()).map(|id| [scale(id), 0.0]).collect();
        for (vertex, site) in &self.shared {
            let face = self.mesh.vertices[*vertex as usize].face;
            if face as usize != site.face {
                let own = &mut narrowed[face as usize];
                let evaluated = if self.vertex_normals { rounding(scene, face) } else { 0.0 };
                *own = [own[0].max(scale(site.face)), evaluated];
            }
        }
        narrowed
    }

    /// [`chord_bounds`] of a face.
    fn chord_of(&self, model: &Model, scene: &PackedScene, id: usize, bounds: &Bounds, narrowed: [f64; 2]) -> Vec<f64> {
        let face = FaceId(id as u32);
        let frame = (&scene.frames()[id], narrowed);
        chord_bounds(bounds, model.surface(face), model.region(face), frame, &self.cells[id])
    }

    /// Moves the corners of a face with its surface, and those that its neighbours share with it, at the parameters that they have: after
    /// an edit nothing is tessellated anew. [`Self::chord`] says what the triangles are good for then.
    ///
    /// `None` where the edit has changed which borders faces share.
    ///
    /// # Panics
    /// Where the model has no such face.
    pub fn followed(&self, model: &Model, scene: &PackedScene, face: FaceId) -> Option<Self> {
        let joints = self.joints.edited(model, face);
        if !joints.are_as(&self.joints) {
            return None;
        }
        let id = face.0 as usize;
        let mut all = Self { joints, ..self.clone() };
        let of_face = |vertex: &Vertex| vertex.face == face.0;
        let first = all.mesh.vertices.iter().position(of_face).unwrap_or(all.mesh.vertices.len());
        for vertex in all.mesh.vertices[first..].iter_mut().take_while(|vertex| of_face(vertex)) {
            let at = Parameters { span: vertex.span, uv: vertex.uv };
            *vertex = corner(model, scene, id, at, self.skirts[id].as_ref());
        }
        let mut moved = BTreeSet::from([id]);
        for (number, site) in &self.shared {
            let vertex = &mut all.mesh.vertices[*number as usize];
            if vertex.face == face.0 || site.face == id {
                site.place(model, scene, vertex);
                moved.insert(vertex.face as usize);
            }
        }
        let narrowed = all.narrowed(scene);
        for id in moved {
            let bounds = Bounds::of(&model.surface(FaceId(id as u32)).bezier_patches());
            all.chord[id] = all.chord_of(model, scene, id, &bounds, narrowed[id]);
        }
        Some(all)
    }
}
