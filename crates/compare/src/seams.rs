//! Where a renderer's triangles meet vertex on vertex, so that no pixel shows what lies behind two faces that share a border.

use scene::FaceId;

/// Borders along which faces meet without a gap; none by default.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Seams {
    faces: Vec<[Vec<Vec<FaceId>>; 4]>,
}

impl Seams {
    /// Of each face and each of its sides, u = 0, u = 1, v = 0, v = 1, and each span along it, the faces beyond; a face may meet itself.
    /// None where it meets nobody, or leaves a gap.
    pub fn new(faces: Vec<[Vec<Vec<FaceId>>; 4]>) -> Self {
        Self { faces }
    }

    /// The faces beyond a span of a side; `side` and `span` as of [`Self::new`].
    pub(crate) fn beyond(&self, face: FaceId, side: usize, span: usize) -> &[FaceId] {
        self.faces.get(face.0 as usize).and_then(|sides| sides[side].get(span)).map_or(&[], Vec::as_slice)
    }
}

/// What there is of a face's borders near a pixel.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Nearby {
    /// Whether the face ends there, and a chord or snapping may leave the pixel uncovered.
    pub ends: bool,
    /// The faces that go on where it does not end.
    pub beyond: Vec<FaceId>,
}

impl Nearby {
    /// A border that is not known to be closed.
    pub const END: Self = Self { ends: true, beyond: vec![] };
}
