//! A model in f32, as the processor and a GPU read it alike.

use super::frame::PackedFrame;
use super::numbers::Numbers;
use crate::eval::Span;
use crate::layout::{BOUNDED, FaceRecord, Parameters, SEARCHED};
use crate::mask::Masks;

/// The program of a face.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Program {
    /// Loops run to the face's own degrees.
    General,
    /// Degree known to the compiler, the same in both directions.
    Degree(u32),
}

/// By what it is decided where a face that loops bound has material.
#[derive(Debug, Clone, PartialEq)]
pub enum Trims {
    /// Its curves ([`crate::trim`]).
    Curves,
    /// Its curves; and fragments look for the one that passes by ([`crate::edge`]).
    CurvesWithEdges,
    /// Masks drawn beforehand ([`crate::mask`]).
    Masks(Masks),
}

/// What the programs of a scene do about trims.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum TrimMethod {
    /// Nothing: no loops bound any face, and no fragment is ever discarded, so that hidden ones may be culled early.
    Whole,
    /// [`Trims::Curves`].
    Curves,
    /// [`Trims::CurvesWithEdges`].
    CurvesWithEdges,
    /// [`Trims::Masks`].
    Masks,
}

/// A model in f32, as both the CPU and the GPU read it.
///
/// A record a face says where the face's numbers stand in two shared arrays. Two faces of one surface share the numbers of it.
/// Trim data stand in the same arrays, because WebGPU promises only eight storage buffers a stage.
///
/// | array | of | numbers | made by |
/// | --- | --- | --- | --- |
/// | knots | a surface, in u | spans + 1 starts; 4 + 2 p a span ([`FaceRecord`]) | packing |
/// | | the same in v | alike | packing |
/// | | a region by curves | n + 1 ends of its n intervals of v; n + 1 indices of their first edges among the points | [`crate::trim`] |
/// | | the same, with edges | first and last index of its box tree among the points | [`crate::edge`] |
/// | | a region by masks | 10: its box, texels a parameter, first texel, last texel | [`crate::mask`] |
/// | points | a surface | homogeneous control points (w x, w y, w z, w), row-major in u | packing |
/// | | a piece of a region | its box (u, v, 1 / Δu, 1 / Δv); p + 1 homogeneous control points in it, times their binomials | [`crate::trim`] |
/// | | an edge in an interval | least u, greatest u, index of its piece, 1 or −1 as u rises or falls with v | [`crate::trim`] |
/// | | a node of a box tree | its box; index behind all under it, index of its piece or −1, 0, 0 | [`crate::edge`] |
#[derive(Debug, Clone, PartialEq)]
pub struct PackedScene {
    pub(super) faces: Vec<FaceRecord>,
    pub(super) numbers: Numbers,
    pub(super) frames: Vec<PackedFrame>,
    pub(super) programs: Vec<Program>,
    pub(super) trims: Trims,
}

impl TrimMethod {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Whole, Self::Curves, Self::CurvesWithEdges, Self::Masks];
}

impl PackedScene {
    /// One record a face.
    #[inline(always)]
    pub fn faces(&self) -> &[FaceRecord] {
        &self.faces
    }

    /// The shared array of single numbers.
    #[inline(always)]
    pub fn knots(&self) -> &[f32] {
        &self.numbers.knots
    }

    /// The shared array of numbers by four.
    #[inline(always)]
    pub fn points(&self) -> &[[f32; 4]] {
        &self.numbers.points
    }

    /// One frame a face.
    #[inline(always)]
    pub fn frames(&self) -> &[PackedFrame] {
        &self.frames
    }

    /// One program a face.
    pub fn programs(&self) -> &[Program] {
        &self.programs
    }

    /// By what faces that loops bound are trimmed.
    #[inline(always)]
    pub fn trims(&self) -> &Trims {
        &self.trims
    }

    /// The masks, where faces are trimmed by them.
    #[inline(always)]
    pub fn masks(&self) -> Option<&Masks> {
        match &self.trims {
            Trims::Masks(masks) => Some(masks),
            Trims::Curves | Trims::CurvesWithEdges => None,
        }
    }

    /// Whether fragments look for the trim edge that passes by.
    #[inline(always)]
    pub fn has_edges(&self) -> bool {
        matches!(self.trims, Trims::CurvesWithEdges)
    }

    /// What its programs do about trims.
    pub fn trim_method(&self) -> TrimMethod {
        match &self.trims {
            _ if !self.is_trimmed() => TrimMethod::Whole,
            Trims::Curves => TrimMethod::Curves,
            Trims::CurvesWithEdges => TrimMethod::CurvesWithEdges,
            Trims::Masks(_) => TrimMethod::Masks,
        }
    }

    /// Whether loops bound any face.
    pub fn is_trimmed(&self) -> bool {
        self.faces.iter().any(|face| face.flags & BOUNDED != 0)
    }

    /// A span of a face in u and one in v.
    #[inline(always)]
    pub fn spans(&self, face: &FaceRecord, span: [u32; 2]) -> [Span<'_>; 2] {
        let one = |table: u32, spans: u32, degree: u32, k: u32| {
            Span::new(&self.numbers.knots, table as usize, spans as usize, degree as usize, k as usize)
        };
        [
            one(face.table_u, face.spans_u, face.degree_u, span[0]),
            one(face.table_v, face.spans_v, face.degree_v, span[1]),
        ]
    }

    /// Where the spans of a face start in u and in v, in parameters of the whole domain, and 1.
    #[inline(always)]
    pub fn starts(&self, face: &FaceRecord) -> [&[f32]; 2] {
        let one = |table: u32, spans: u32| &self.numbers.knots[table as usize..][..spans as usize + 1];
        [one(face.table_u, face.spans_u), one(face.table_v, face.spans_v)]
    }

    /// The parameters of the whole domain that a place of a face has.
    pub fn whole(&self, face: u32, at: Parameters) -> [f32; 2] {
        if at.span[0] == SEARCHED {
            return at.uv;
        }
        let spans = self.spans(&self.faces[face as usize], at.span);
        [0, 1].map(|k| spans[k].whole(at.uv[k]))
    }
}
