//! Triangles over all faces of a scene, by which a technique finds who covers a pixel.

use crate::layout::Vertex;
use crate::packed::{PackedScene, Program};

/// Triangles of a mesh at most: about 80 bytes each with their vertices, so under 1.4 GB.
pub const GREATEST_TRIANGLES: usize = 1 << 24;

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

/// Triangles in drawing order; none by default.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Mesh {
    /// Corners, shared within a face.
    pub vertices: Vec<Vertex>,
    /// Three a triangle: at equal depth the earlier triangle stays.
    pub indices: Vec<u32>,
    /// One batch a program, in drawing order.
    pub batches: Vec<Batch>,
}

impl Mesh {
    /// No triangles, with room for so many.
    pub fn with_capacity(vertices: usize, triangles: usize) -> Self {
        Self { vertices: Vec::with_capacity(vertices), indices: Vec::with_capacity(3 * triangles), batches: vec![] }
    }

    /// Enters the indices from `first` on as drawn by `program`.
    pub fn batch(&mut self, program: Program, first: u32) {
        let count = self.indices.len() as u32 - first;
        match self.batches.last_mut() {
            Some(batch) if batch.program == program => batch.count += count,
            _ => self.batches.push(Batch { program, first, count }),
        }
    }

    /// Number of triangles.
    pub fn triangles(&self) -> usize {
        self.indices.len() / 3
    }
}

/// The faces of a scene as they are drawn: grouped by their programs.
pub fn in_drawing_order(scene: &PackedScene) -> Vec<usize> {
    let mut order: Vec<usize> = (0..scene.faces().len()).collect();
    order.sort_by_key(|&id| (scene.programs()[id], id));
    order
}
