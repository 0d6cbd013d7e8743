//! One loop as a chain of Bézier segments without gaps.

use super::frame::{Frame, GAP_FLOOR, SMALL};
use super::repairs::{Repairs, WideGap};
use super::segment::Segment;
use crate::{Loop, SceneError, Trim};
use glam::{DVec2, IVec2};
use nurbs::{BezierCurve, Curve, Hull, Rectangle};

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
    /// The loop as a chain; `None` where it is a single point.
    pub(super) fn new(
        frame: &Frame,
        source: usize,
        boundary: &Loop,
        repairs: &mut Repairs,
    ) -> Result<Option<Self>, SceneError> {
        let face = frame.face;
        let mut parts: Vec<Vec<BezierCurve>> = vec![];
        for (trim, curve) in boundary.trims.iter().enumerate() {
            let part = bezier_segments(curve);
            parts.push(part.map_err(|cause| SceneError::TrimCurve { face, boundary: source, trim, cause })?);
        }
        let joints = Joints { frame, source, boundary, size: size_in_space(frame, &parts) };
        let mut segments: Vec<Segment> = vec![];
        // Whole periods that were taken off the trims so far, so that each begins where the last one ended.
        let mut shift = DVec2::ZERO;
        for (trim, part) in parts.iter().enumerate() {
            let mut part: Vec<Segment> =
                part.iter().map(|s| Segment { curve: s.translated(shift), trim: Some(trim) }).collect();
            if let Some(last) = segments.last().map(|s| s.curve.end()) {
                let periods = joints.heal(trim, last, part[0].curve.start(), repairs)?;
                let offset = -periods.as_dvec2() * frame.domain.size();
                if offset != DVec2::ZERO {
                    part = part.iter().map(|s| s.translated(offset)).collect();
                    shift += offset;
                }
                join(frame, &mut segments, part[0].curve.start());
            }
            segments.append(&mut part);
        }
        let Some((first, last)) = segments.first().zip(segments.last()) else {
            return Err(SceneError::EmptyLoop { face, boundary: source });
        };
        let start = first.curve.start();
        let periods = joints.heal(0, last.curve.end(), start, repairs)?;
        join(frame, &mut segments, start - periods.as_dvec2() * frame.domain.size());
        // Splines that fold to a point are no part of a boundary.
        segments.retain(|s| s.curve.hull().size() != DVec2::ZERO);
        let hull = segments.iter().map(|s| s.curve.hull()).fold(Rectangle::EMPTY, Rectangle::union);
        if segments.is_empty() {
            return Ok(None);
        }
        let periods = [-periods.x, -periods.y];
        if periods != [0, 0] {
            repairs.across_seam.push(source);
        }
        Ok(Some(Self { source, outer: boundary.outer, segments, periods, hull }))
    }
}

/// The diagonal of the box in space of a loop's segments, by their ends and middles.
fn size_in_space(frame: &Frame, parts: &[Vec<BezierCurve>]) -> f64 {
    let places = parts.iter().flatten().flat_map(|curve| [0.0, 0.5, 1.0].map(|t| frame.wrapped(curve.point(t))));
    let hull = Hull::of(places.map(|uv| frame.surface.point(uv.x, uv.y)));
    hull.diagonal()
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

/// The joints of a loop, and how wide they may be.
struct Joints<'a> {
    frame: &'a Frame<'a>,
    source: usize,
    boundary: &'a Loop,
    /// How large the loop is in space, model units.
    size: f64,
}

impl Joints<'_> {
    /// Heals the joint before trim `trim`, from `a` to `b`, and notes it; returns the whole periods between them.
    fn heal(&self, trim: usize, a: DVec2, b: DVec2, repairs: &mut Repairs) -> Result<IVec2, SceneError> {
        let (frame, trims) = (self.frame, &self.boundary.trims);
        let before = &trims[if trim == 0 { trims.len() - 1 } else { trim - 1 }];
        let edges = before.edge_tolerance.max(trims[trim].edge_tolerance);
        let vertex = trims[trim].vertex_tolerance;
        // Two edges end in one ball.
        let tolerance = frame.tolerance.max(edges).max(2.0 * vertex.unwrap_or(0.0));
        let (periods, gap) = frame.joint(a, b);
        let most = if frame.is_lenient && vertex.is_none() { tolerance.max(SMALL * self.size) } else { tolerance };
        if gap.is_nan() || most < gap {
            return Err(SceneError::TrimGap { face: frame.face, boundary: self.source, trim, gap, tolerance });
        }
        repairs.largest_gap = repairs.largest_gap.max(gap);
        if tolerance < gap {
            repairs.wide_gaps.push(WideGap { boundary: self.source, trim, gap, tolerance });
        }
        Ok(periods)
    }
}

impl Frame<'_> {
    /// How far apart a trim that ends at `a` and one that begins at `b` are in space, and the whole periods between.
    ///
    /// As they stand where they meet, which includes any way along a pole; else with whole periods where that is nearer.
    fn joint(&self, a: DVec2, b: DVec2) -> (IVec2, f64) {
        if a == b {
            return (IVec2::ZERO, 0.0);
        }
        let direct = self.distance(a, b);
        let mut periods = ((b - a) / self.domain.size()).round();
        for axis in [0, 1] {
            if !self.closed[axis] {
                periods[axis] = 0.0;
            }
        }
        let around = self.distance(a, b - periods * self.domain.size());
        let is_joint = direct <= GAP_FLOOR * self.surface.hull().diagonal();
        if periods != DVec2::ZERO && !is_joint && around < direct {
            (periods.as_ivec2(), around)
        } else {
            (IVec2::ZERO, direct)
        }
    }
}
