//! Triangles after the vertex stage and clipping.

use crate::clip::{self, ClipVertex};
use crate::rect::Rect;
use crate::setup::covered_bounds;
use crate::vertex::{Corner, Screen, clip_position};
use pipeline::{Mesh, Vertex, View};
use rayon::prelude::*;
use scene::Viewport;
use std::borrow::Cow;

/// Corners in the picture, and the pieces of triangles that had to be clipped.
///
/// Triangle `id` below the mesh's count is the mesh's own; from there on ids count pieces.
#[derive(Debug)]
pub struct Geometry<'a> {
    mesh: Cow<'a, Mesh>,
    /// One a vertex of the mesh; `None` where it is outside the clip volume or the guard band.
    corners: Vec<Option<Corner>>,
    /// Pieces, in drawing order.
    pieces: Vec<Piece>,
}

/// What a triangle carries to its fragments.
#[derive(Debug, Clone, Copy)]
pub struct Attributes {
    /// The face.
    pub face: u32,
    /// The spans that its parameters are of.
    pub span: [u32; 2],
    /// Parameters at the corners.
    pub uv: [[f32; 2]; 3],
    /// Normals at the corners.
    pub normal: [[f32; 3]; 3],
}

#[derive(Debug)]
struct Piece {
    source: u32,
    corners: [Corner; 3],
    attributes: Attributes,
}

impl<'a> Geometry<'a> {
    /// Runs the vertex stage on every vertex, and clips what needs it.
    pub fn new(mesh: Cow<'a, Mesh>, views: &[View], viewport: Viewport) -> Self {
        let screen = Screen::new(viewport);
        let clip_of = |v: &Vertex| clip_position(&views[v.frame as usize], v.position);
        let corners: Vec<Option<Corner>> = mesh
            .vertices
            .par_iter()
            .map(|v| {
                let clip = clip_of(v);
                if clip::is_inside(clip) { screen.corner(clip) } else { None }
            })
            .collect();
        let pieces: Vec<Piece> = mesh
            .indices
            .par_chunks_exact(3)
            .enumerate()
            .filter(|(_, t)| t.iter().any(|&i| corners[i as usize].is_none()))
            .flat_map_iter(|(source, t)| {
                let vertices = [t[0], t[1], t[2]].map(|i| &mesh.vertices[i as usize]);
                let polygon = clip::clip(vertices.map(|v| ClipVertex { clip: clip_of(v), uv: v.uv, normal: v.normal }));
                let Vertex { face, span, .. } = *vertices[0];
                let fan = (1..polygon.len().saturating_sub(1)).map(move |i| [polygon[0], polygon[i], polygon[i + 1]]);
                fan.filter_map(move |t| {
                    let [Some(a), Some(b), Some(c)] = t.map(|v| screen.corner(v.clip)) else { return None };
                    let attributes = Attributes { face, span, uv: t.map(|v| v.uv), normal: t.map(|v| v.normal) };
                    Some(Piece { source: source as u32, corners: [a, b, c], attributes })
                })
            })
            .collect();
        Self { mesh, corners, pieces }
    }

    /// Number of triangles of the mesh.
    pub fn triangles(&self) -> usize {
        self.mesh.triangles()
    }

    /// The mesh.
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// Calls `add` with the ids of triangle `i` or of its pieces.
    pub fn ids(&self, i: usize, mut add: impl FnMut(u32)) {
        if self.vertices(i).iter().all(|&v| self.corners[v].is_some()) {
            add(i as u32);
        } else {
            let first = self.pieces.partition_point(|p| (p.source as usize) < i);
            let pieces = self.pieces[first..].iter().take_while(|p| p.source as usize == i).count();
            (first..first + pieces).for_each(|p| add((self.triangles() + p) as u32));
        }
    }

    /// Calls `add` with the id and the box of every part of triangle `i` that covers any sample.
    pub fn boxes(&self, i: usize, add: &mut dyn FnMut(u32, Rect)) {
        self.ids(i, |id| {
            if let Some(rect) = covered_bounds(&self.corners(id)) {
                add(id, rect);
            }
        });
    }

    /// The corners of a triangle or piece whose id came from [`Self::ids`].
    pub fn corners(&self, id: u32) -> [Corner; 3] {
        match (id as usize).checked_sub(self.triangles()) {
            Some(piece) => self.pieces[piece].corners,
            None => self.vertices(id as usize).map(|v| self.corners[v].expect("ids names no outside corners")),
        }
    }

    /// The least and the greatest x and y of its corners, pixels.
    pub fn extent(&self, id: u32) -> [[f32; 2]; 2] {
        let corners = self.corners(id);
        let of = |pick: fn(f32, f32) -> f32| {
            [0, 1].map(|axis| {
                let [a, b, c] = corners.map(|corner| corner.position[axis]);
                pick(pick(a, b), c)
            })
        };
        [of(f32::min), of(f32::max)]
    }

    /// One more than the greatest id.
    pub fn ids_end(&self) -> usize {
        self.triangles() + self.pieces.len()
    }

    /// Index of the first vertex of a triangle, or of the one that a piece was cut from.
    pub fn first_vertex(&self, id: u32) -> u32 {
        let triangle = (id as usize).checked_sub(self.triangles()).map_or(id, |piece| self.pieces[piece].source);
        self.mesh.indices[3 * triangle as usize]
    }

    /// What it carries.
    pub fn attributes(&self, id: u32) -> Attributes {
        match (id as usize).checked_sub(self.triangles()) {
            Some(piece) => self.pieces[piece].attributes,
            None => {
                let v = self.vertices(id as usize).map(|v| &self.mesh.vertices[v]);
                Attributes { face: v[0].face, span: v[0].span, uv: v.map(|v| v.uv), normal: v.map(|v| v.normal) }
            }
        }
    }

    /// Indices of the vertices of a mesh's triangle.
    fn vertices(&self, triangle: usize) -> [usize; 3] {
        let t = &self.mesh.indices[3 * triangle..3 * triangle + 3];
        [t[0], t[1], t[2]].map(|i| i as usize)
    }
}
