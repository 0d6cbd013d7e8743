//! What all faces of a file have in common to be noted: edges that were followed on surfaces, and vertices that are off.

use super::source::Found;
use crate::document::{Note, NoteKind};
use crate::place::Place;

/// What was approximated and mended in the whole file.
#[derive(Default)]
pub(crate) struct Total {
    faces: usize,
    first: Option<u64>,
    /// Faces of which a shape or a curve is within a proven distance of the file's, and not the same.
    beside: Beside,
    /// Those of which how far they are is measured alone.
    measured: Beside,
    /// A face with the vertex that is farthest from its edges.
    vertex: Option<u64>,
    found: Found,
}

/// Faces that are not quite the file's: how many, the first, and how far any is at most, model units.
#[derive(Default)]
struct Beside {
    faces: usize,
    first: Option<u64>,
    most: f64,
}

impl Total {
    pub fn add(&mut self, face: u64, found: &Found) {
        if 0 < found.followed {
            self.faces += 1;
            self.first.get_or_insert(face);
        }
        if 0.0 < found.off.most {
            let own = if found.off.is_measured { &mut self.measured } else { &mut self.beside };
            own.faces += 1;
            own.first.get_or_insert(face);
            own.most = own.most.max(found.off.most);
        }
        self.found.followed += found.followed;
        self.found.error = self.found.error.max(found.error);
        self.found.gap = self.found.gap.max(found.gap);
        if self.found.vertex < found.vertex {
            self.found.vertex = found.vertex;
            self.vertex = Some(face);
        }
    }

    /// The notes of it; `place` says where a face stands in the file.
    pub fn notes(&self, place: impl Fn(u64) -> Place, unit: &str) -> impl Iterator<Item = Note> {
        let Found { followed, error, gap, .. } = self.found;
        let text = format!(
            "{followed} edges of {} faces, this one the first, are followed on their surfaces within {error:.1e} {unit}, and are at \
             most {gap:.1e} from them, both as measured",
            self.faces
        );
        let edges = self.first.map(|face| Note { kind: NoteKind::Approximated, place: place(face), text });
        let beside = [(&self.beside, "proven"), (&self.measured, "measured")].map(|(Beside { faces, first, most }, how)| {
            let text = format!(
                "{faces} faces, this one the first, are on offsets of splines, or within such curves: these are followed within \
                 {most:.1e} {unit}, as {how}"
            );
            first.map(|face| Note { kind: NoteKind::Approximated, place: place(face), text })
        });
        let text = format!(
            "vertices are up to {:.1e} {unit} from their edges, at this face; gaps there are closed, above the file's tolerance",
            self.found.vertex
        );
        let vertex = self.vertex.map(|face| Note { kind: NoteKind::Healed, place: place(face), text });
        edges.into_iter().chain(beside.into_iter().flatten()).chain(vertex)
    }
}
