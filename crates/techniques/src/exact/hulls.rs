//! The hulls that technique `exact` draws: of all pieces of all faces.

use super::pieces::{HULL_TRIANGLES, pieces_of};
use super::record::PieceRecord;
use crate::error::PrepareError;
use crate::triangles::patches::spans_of;
use nurbs::{Hull, Surface};
use pipeline::{GREATEST_TRIANGLES, Mesh, PackedScene, Vertex, in_drawing_order};
use rayon::prelude::*;
use scene::{Camera, FaceId, Model, Region, Viewport};

/// Vertices of a hull.
pub const CORNERS: usize = 8;

/// Indices of a hull.
pub const INDICES: usize = 3 * HULL_TRIANGLES.len();

/// Hulls of all pieces; none by default.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Hulls {
    /// Their triangles: piece i has vertices 8 i to 8 i + 7 and triangles 12 i to 12 i + 11.
    pub mesh: Mesh,
    /// The pieces, in drawing order.
    pub pieces: Vec<PieceRecord>,
}

impl Hulls {
    /// The hulls of all pieces of all faces: no pixel whose centre sees a piece, as `camera` has
    /// it, lies outside its hull.
    ///
    /// # Errors
    /// [`PrepareError::TooManyPieces`].
    pub fn new(model: &Model, scene: &PackedScene, camera: &Camera, viewport: Viewport) -> Result<Self, PrepareError> {
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
            return Err(PrepareError::TooManyPieces { count });
        }
        let mut mesh = Mesh::with_capacity(CORNERS * count, HULL_TRIANGLES.len() * count);
        let mut pieces = Vec::with_capacity(count);
        for id in in_drawing_order(scene) {
            let first = mesh.indices.len() as u32;
            for piece in &of_faces[id] {
                let base = mesh.vertices.len() as u32;
                let vertex = |position| Vertex {
                    position,
                    uv: [0.0; 2],
                    face: id as u32,
                    span: [0; 2],
                    normal: [0.0; 3],
                    frame: id as u32,
                };
                mesh.vertices.extend(piece.corners.map(vertex));
                mesh.indices.extend(HULL_TRIANGLES.as_flattened().iter().map(|corner| base + corner));
                pieces.push(piece.record);
            }
            mesh.batch(scene.programs()[id], first);
        }
        Ok(Self { mesh, pieces })
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
