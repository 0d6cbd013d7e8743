//! What all faces of a file have in common to be noted: edges that were followed on surfaces, and vertices that are off.

use super::source::Found;
use crate::document::{Note, NoteKind};
use crate::place::Place;

/// What was approximated and mended in the whole file.
#[derive(Default)]
pub(crate) struct Total {
    faces: usize,
    first: Option<u64>,
    /// Faces of which a shape or a curve is not quite the file's: how many, and the first.
    beside: usize,
    first_beside: Option<u64>,
    /// A face with the vertex that is farthest from its edges.
    vertex: Option<u64>,
    found: Found,
}

impl Total {
    pub fn add(&mut self, face: u64, found: &Found) {
        if 0 < found.projected {
            self.faces += 1;
            self.first.get_or_insert(face);
        }
        if 0.0 < found.off {
            self.beside += 1;
            self.first_beside.get_or_insert(face);
        }
        self.found.off = self.found.off.max(found.off);
        self.found.projected += found.projected;
        self.found.error = self.found.error.max(found.error);
        self.found.gap = self.found.gap.max(found.gap);
        if self.found.vertex < found.vertex {
            self.found.vertex = found.vertex;
            self.vertex = Some(face);
        }
    }

    /// The notes of it; `place` says where a face stands in the file.
    pub fn notes(&self, place: impl Fn(u64) -> Place, unit: &str) -> impl Iterator<Item = Note> {
        let Found { projected, error, gap, .. } = self.found;
        let text = format!(
            "{projected} edges of {} faces, this one the first, have no (u, v) curve on their surface: they are followed there \
             within {error:.1e} {unit}, and are at most {gap:.1e} from it, both as measured",
            self.faces
        );
        let edges = self.first.map(|face| Note { kind: NoteKind::Approximated, place: place(face), text });
        let text = format!(
            "{} faces, this one the first, are on offsets of splines, or within such curves: these are followed within {:.1e} {unit}, \
             as measured",
            self.beside, self.found.off
        );
        let beside = self.first_beside.map(|face| Note { kind: NoteKind::Approximated, place: place(face), text });
        let text = format!(
            "vertices are up to {:.1e} {unit} from their edges, at this face; gaps there are closed, above the file's tolerance",
            self.found.vertex
        );
        let vertex = self.vertex.map(|face| Note { kind: NoteKind::Healed, place: place(face), text });
        edges.into_iter().chain(beside).chain(vertex)
    }
}
