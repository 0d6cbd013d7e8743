//! Loops as chains of Bézier segments, as all steps hand them on.

use glam::DVec2;
use nurbs::BezierCurve;

/// A Bézier segment of a loop.
#[derive(Debug, Clone, PartialEq)]
pub struct Segment {
    /// The curve, in standard form.
    pub curve: BezierCurve,
    /// Which trim of its loop it is a part of; `None` where it closes a gap or runs along the natural boundary.
    pub trim: Option<usize>,
}

impl Segment {
    pub(super) fn line(start: DVec2, end: DVec2) -> Self {
        Self { curve: BezierCurve::line(start, end), trim: None }
    }

    pub(super) fn translated(&self, offset: DVec2) -> Self {
        Self { curve: self.curve.translated(offset), ..*self }
    }

    pub(super) fn reversed(&self) -> Self {
        Self { curve: self.curve.reversed(), ..*self }
    }
}

/// A closed loop of Bézier segments; the end of each is to the bit the start of the next.
#[derive(Debug, Clone, PartialEq)]
pub struct ClosedLoop {
    /// The segments, in the loop's (normalised) direction.
    pub segments: Vec<Segment>,
    /// How many loops it lies in: even for an outer boundary, odd for a hole.
    pub depth: usize,
    /// Which of the face's loops it was made of; `None` for the natural boundary, added where no loop bounds the face.
    pub source: Option<usize>,
}
