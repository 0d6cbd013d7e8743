//! What an object is drawn as: surfaces, faces on them, and what is to be known of those that are not drawn.

use super::archive::Fault;
use crate::document::{NoteKind, SurfaceKind};
use glam::{DMat3, DVec3};
use nurbs::{Direction, Surface};
use scene::Face;

/// The faces of an object.
#[derive(Debug, Clone, Default)]
pub(super) struct Body {
    pub surfaces: Vec<Surface>,
    /// What each surface is in the file.
    pub kinds: Vec<SurfaceKind>,
    /// Each on one of these surfaces.
    pub faces: Vec<Face>,
    pub remarks: Vec<Remark>,
}

/// Something to be known of a part of an object.
#[derive(Debug, Clone)]
pub(super) struct Remark {
    pub kind: NoteKind,
    /// The byte of the file that it is about.
    pub at: usize,
    pub text: String,
}

impl Remark {
    /// That something is drawn otherwise than it stands in the file.
    pub fn healed(at: usize, text: String) -> Self {
        Self { kind: NoteKind::Healed, at, text }
    }

    /// That a part is not drawn.
    pub fn left_out(part: &str, fault: Fault) -> Self {
        Self { kind: NoteKind::LeftOut, at: fault.at, text: format!("{part}: {}", fault.text) }
    }
}

/// Where a block is placed: p ↦ matrix p + offset.
#[derive(Debug, Clone, Copy)]
pub(super) struct Placement {
    pub matrix: DMat3,
    pub offset: DVec3,
}

impl Placement {
    pub const IDENTITY: Self = Self { matrix: DMat3::IDENTITY, offset: DVec3::ZERO };

    /// First `inner`, then this.
    pub fn after(&self, inner: &Self) -> Self {
        Self { matrix: self.matrix * inner.matrix, offset: self.matrix * inner.offset + self.offset }
    }

    fn is_identity(&self) -> bool {
        self.matrix == DMat3::IDENTITY && self.offset == DVec3::ZERO
    }
}

impl Body {
    /// How many control points of surfaces and trims it has.
    pub fn size(&self) -> usize {
        let trims = self.faces.iter().flat_map(|face| &face.loops).flat_map(|boundary| &boundary.trims);
        self.surfaces.iter().map(|s| s.points().len()).sum::<usize>()
            + trims.map(|trim| trim.points.len()).sum::<usize>()
    }

    /// The same faces elsewhere. A mirrored face turns its other side; distances grow by the longest column of the matrix.
    ///
    /// # Errors
    /// Where coordinates are too large.
    pub fn placed(mut self, placement: &Placement) -> Result<Self, nurbs::NurbsError> {
        if placement.is_identity() {
            return Ok(self);
        }
        for surface in &mut self.surfaces {
            let [u, v] = [Direction::U, Direction::V].map(|d| surface.knots(d).clone());
            let points = surface.points().iter().map(|p| placement.matrix * *p + placement.offset).collect();
            *surface = Surface::new(u, v, points, surface.weights().map(<[f64]>::to_vec))?;
        }
        let is_mirrored = placement.matrix.determinant() < 0.0;
        let columns = [placement.matrix.x_axis, placement.matrix.y_axis, placement.matrix.z_axis];
        let scale = columns.map(DVec3::length).into_iter().fold(0.0, f64::max);
        for face in &mut self.faces {
            face.reversed ^= is_mirrored;
            face.tolerance *= scale;
            for trim in face.loops.iter_mut().flat_map(|boundary| &mut boundary.trims) {
                trim.edge_tolerance *= scale;
                trim.vertex_tolerance = trim.vertex_tolerance.map(|t| t * scale);
            }
        }
        Ok(self)
    }
}
