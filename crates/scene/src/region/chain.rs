//! One loop as a chain of Bézier segments without gaps.

use super::{Frame, Repairs, Segment};
use crate::{Loop, SceneError, Trim};
use glam::DVec2;
use nurbs::{BezierCurve, Curve, Rectangle};

/// Two ends nearer than this share of the domain's length are made one point; farther ones are joined by a segment.
///
/// Moving an end bends the curve by as much: below the parameters that files print.
const SAME_POINT: f64 = 1e-9;

/// A loop as one chain: closed, or closed but for whole periods of its surface.
pub(super) struct Chain {
    /// Index of the loop in the face.
    pub source: usize,
    /// What the file says of it.
    pub outer: bool,
    /// The segments, each ending to the bit where the next begins; the last ends `periods` from where the first begins.
    pub segments: Vec<Segment>,
    /// How often it goes around the surface in u and in v.
    pub periods: [i32; 2],
    /// The box of the segments' control points.
    pub hull: Rectangle,
}

impl Chain {
    pub(super) fn new(
        frame: &Frame,
        source: usize,
        boundary: &Loop,
        repairs: &mut Repairs,
    ) -> Result<Self, SceneError> {
        let face = frame.face;
        let mut segments: Vec<Segment> = vec![];
        // Whole periods that were taken off the trims so far, so that each begins where the last one ended.
        let mut shift = DVec2::ZERO;
        for (trim, curve) in boundary.trims.iter().enumerate() {
            let part = bezier_segments(curve).map_err(|cause| SceneError::TrimCurve {
                face,
                boundary: source,
                trim,
                cause,
            })?;
            let mut part: Vec<Segment> =
                part.iter().map(|s| Segment { curve: s.translated(shift), trim: Some(trim) }).collect();
            if let Some(last) = segments.last().map(|s| s.curve.end()) {
                let joint = frame.joint(last, part[0].curve.start());
                let joint = joint.map_err(|gap| gap.error(frame, source, trim))?;
                let offset = -joint.periods.as_dvec2() * frame.domain.size();
                if offset != DVec2::ZERO {
                    part = part.iter().map(|s| s.translated(offset)).collect();
                    shift += offset;
                }
                repairs.largest_gap = repairs.largest_gap.max(joint.gap);
                join(frame, &mut segments, part[0].curve.start());
            }
            segments.append(&mut part);
        }
        let Some((first, last)) = segments.first().zip(segments.last()) else {
            return Err(SceneError::EmptyLoop { face, boundary: source });
        };
        let start = first.curve.start();
        let joint = frame.joint(last.curve.end(), start).map_err(|gap| gap.error(frame, source, 0))?;
        repairs.largest_gap = repairs.largest_gap.max(joint.gap);
        join(frame, &mut segments, start - joint.periods.as_dvec2() * frame.domain.size());
        // Splines that fold to a point are no part of a boundary.
        segments.retain(|s| s.curve.hull().size() != DVec2::ZERO);
        let hull = segments.iter().map(|s| s.curve.hull()).fold(Rectangle::EMPTY, Rectangle::union);
        if segments.is_empty() {
            return Err(SceneError::EmptyLoop { face, boundary: source });
        }
        let periods = [-joint.periods.x, -joint.periods.y];
        if periods != [0, 0] {
            repairs.across_seam.push(source);
        }
        Ok(Self { source, outer: boundary.outer, segments, periods, hull })
    }
}

/// A trim's segments in the loop's direction.
fn bezier_segments(trim: &Trim) -> Result<Vec<BezierCurve>, nurbs::NurbsError> {
    let segments = Curve::new(trim.knots.clone(), &trim.points, trim.weights.as_deref())?.bezier_segments();
    Ok(match trim.reversed {
        false => segments,
        true => segments.iter().rev().map(BezierCurve::reversed).collect(),
    })
}

/// Makes the chain end at `to`: by moving its end where that is near, else by a segment.
fn join(frame: &Frame, segments: &mut Vec<Segment>, to: DVec2) {
    let Some(last) = segments.last_mut() else { return };
    let (start, end) = (last.curve.start(), last.curve.end());
    if (end - to).abs().cmple(SAME_POINT * frame.domain.size()).all() {
        last.curve.set_ends(start, to);
    } else {
        segments.push(Segment::line(end, to));
    }
}

/// How two trims meet.
struct Joint {
    /// Periods from the end of the first to the start of the second.
    periods: glam::IVec2,
    /// What is left, model units along the surface.
    gap: f64,
}

/// Two trims that do not meet: how far they are apart in space.
struct Gap(f64);

impl Gap {
    fn error(self, frame: &Frame, boundary: usize, trim: usize) -> SceneError {
        SceneError::TrimGap { face: frame.face, boundary, trim, gap: self.0, tolerance: frame.tolerance }
    }
}

impl Frame<'_> {
    /// How a trim that ends at `a` meets one that begins at `b`.
    ///
    /// First as they stand, which includes any way along a pole; then with whole periods between.
    fn joint(&self, a: DVec2, b: DVec2) -> Result<Joint, Gap> {
        if a == b {
            return Ok(Joint { periods: glam::IVec2::ZERO, gap: 0.0 });
        }
        let gap = self.distance(a, b);
        if gap <= self.tolerance {
            return Ok(Joint { periods: glam::IVec2::ZERO, gap });
        }
        let periods = ((b - a) / self.domain.size()).round();
        let closed = |axis: usize| periods[axis] == 0.0 || self.is_closed(axis);
        let around = self.distance(a, b - periods * self.domain.size());
        if periods != DVec2::ZERO && around <= self.tolerance && closed(0) && closed(1) {
            return Ok(Joint { periods: periods.as_ivec2(), gap: around });
        }
        Err(Gap(gap))
    }
}
