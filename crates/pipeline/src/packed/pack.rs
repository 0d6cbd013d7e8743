//! From f64 to f32: the one place that narrows.
//!
//! Each face moves to its own origin and to a scale that is a power of two, so that its control box fills −1 … 1; each
//! knot span that is not empty becomes 0 … 1, with the knots around it. What is lost is 2⁻²⁴ of the face's own size, wherever in
//! the world it lies, and 2⁻²⁴ of a span, however short it is.

use super::error::{GREATEST_COUNT, PackError};
use super::frame::PackedFrame;
use super::numbers::Numbers;
use super::scene::{PackedScene, Program, Trims};
use crate::layout::{BOUNDED, FaceRecord, RATIONAL, REVERSED, SPAN_HEAD};
use crate::mask::{MaskPlan, Masks, placement};
use glam::DVec2;
use nurbs::{Direction, KnotVector, Surface, power_of_two};
use scene::{FaceId, Model};

/// Which programs evaluate a scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Scheme {
    /// A few specialised degrees (3, 5, 7, … 15): a face is raised, both directions alike, to the next of them
    /// (Kanai 2007, Sec. 3.3). The common bicubic face then pays for nothing else.
    #[default]
    Specialised,
    /// One program for any degrees p ≠ q; every face keeps its own.
    General,
}

/// How far from a span, in lengths of it, a knot is put at most: what lies beyond changes the basis functions on the span by less
/// than f32 can tell.
const FARTHEST_KNOT: f64 = (1u64 << 60) as f64;

impl PackedScene {
    /// Packs all faces of a model, trimmed by their curves.
    ///
    /// # Errors
    /// [`PackError`] where the model is too large to index or a face has no usable size.
    pub fn new(model: &Model, scheme: Scheme) -> Result<Self, PackError> {
        Self::by_curves(model, scheme, false)
    }

    /// As [`Self::new`], for fragments that look for the trim edge that passes by.
    ///
    /// # Errors
    /// As of [`Self::new`].
    pub fn with_edges(model: &Model, scheme: Scheme) -> Result<Self, PackError> {
        Self::by_curves(model, scheme, true)
    }

    fn by_curves(model: &Model, scheme: Scheme, edges: bool) -> Result<Self, PackError> {
        let trims = if edges { Trims::CurvesWithEdges } else { Trims::Curves };
        let mut packed = Self::untrimmed(model, scheme, trims)?;
        for id in 0..packed.faces.len() {
            if let Some(region) = model.trimmed_region(FaceId(id as u32)) {
                let (trims, intervals, band) = packed.numbers.push_region(region, edges)?;
                (packed.faces[id].trims, packed.faces[id].intervals) = (trims, intervals);
                packed.frames[id].edge_band = band;
            }
        }
        Ok(packed)
    }

    /// Packs all faces of a model, trimmed by masks that were made of it.
    ///
    /// # Errors
    /// As of [`Self::new`].
    pub fn masked(model: &Model, scheme: Scheme, masks: Masks) -> Result<Self, PackError> {
        let mut packed = Self::untrimmed(model, scheme, Trims::Curves)?;
        for (id, tile) in masks.plan.tiles.iter().enumerate() {
            if let Some(tile) = tile {
                (packed.faces[id].trims, packed.faces[id].intervals) = (packed.numbers.knots.len() as u32, 1);
                packed.frames[id].edge_band = tile.band;
                packed.numbers.knots.extend(placement(tile));
            }
        }
        Ok(Self { trims: Trims::Masks(masks), ..packed })
    }

    /// The same scene, which a judge reads, with the bands of masks about its edges: those of a plan, where a face's
    /// are off by more than `px` pixels as much narrower.
    pub fn in_bands_of(mut self, masks: &MaskPlan, px: f64) -> Self {
        for (frame, tile) in self.frames.iter_mut().zip(&masks.tiles) {
            if let Some(tile) = tile {
                frame.edge_band = tile.band * (px / tile.error_px).min(1.0);
            }
        }
        self
    }

    /// Packs the whole surfaces.
    fn untrimmed(model: &Model, scheme: Scheme, trims: Trims) -> Result<Self, PackError> {
        let mut packed = Self { faces: vec![], numbers: Numbers::default(), frames: vec![], programs: vec![], trims };
        // Faces of one surface share its numbers.
        let mut of_surface = vec![None; model.surfaces().len()];
        for (id, face) in model.faces().iter().enumerate() {
            let surface = &model.surfaces()[face.surface];
            let flags = if face.reversed { REVERSED } else { 0 } | if face.loops.is_empty() { 0 } else { BOUNDED };
            let first = *of_surface[face.surface].get_or_insert(id);
            if first < id {
                packed
                    .faces
                    .push(FaceRecord { flags: packed.faces[first].flags & RATIONAL | flags, ..packed.faces[first] });
                packed.frames.push(packed.frames[first].clone());
                packed.programs.push(packed.programs[first]);
                continue;
            }
            match scheme {
                Scheme::General => packed.push(id, surface, flags, Program::General)?,
                Scheme::Specialised => {
                    let (raised, degree) = specialised(surface);
                    packed.push(id, &raised, flags, Program::Degree(degree))?;
                }
            }
        }
        Ok(packed)
    }

    fn push(&mut self, id: usize, surface: &Surface, flags: u32, program: Program) -> Result<(), PackError> {
        let [ku, kv] = [Direction::U, Direction::V].map(|d| surface.knots(d));
        let size = surface.hull().diagonal() / 2.0;
        let scale = power_of_two_above(size).ok_or(PackError::Scale { face: id, size })?;
        let greatest = surface.weights().map_or(1.0, |w| w.iter().fold(0.0, |m: f64, &w| m.max(w)));
        let unit = power_of_two(greatest);
        let rational = surface.weights().is_some_and(|w| w.iter().any(|&x| x != w[0]));
        let [count_u, count_v] = surface.control_counts();
        let table_u = self.push_spans(ku)?;
        let table_v = self.push_spans(kv)?;
        let points = self.numbers.points.len();
        let count = points + count_u * count_v;
        if count > GREATEST_COUNT {
            return Err(PackError::TooLarge { what: "control points", count, greatest: GREATEST_COUNT });
        }
        self.numbers.points.extend(surface.homogeneous().iter().map(|c| {
            // A polynomial face keeps weight 1 exactly, so that its program may leave out the quotient.
            let w = if rational { unit } else { c[3] };
            [c[0] / scale / w, c[1] / scale / w, c[2] / scale / w, c[3] / w].map(|x| x as f32)
        }));
        let breaks = [ku, kv].map(|knots| {
            let start = knots.spans().map(|span| knots.knots()[span]);
            start.chain([knots.domain().1]).collect::<Vec<f64>>()
        });
        self.faces.push(FaceRecord {
            degree_u: ku.degree() as u32,
            degree_v: kv.degree() as u32,
            spans_u: breaks[0].len() as u32 - 1,
            spans_v: breaks[1].len() as u32 - 1,
            table_u: table_u as u32,
            table_v: table_v as u32,
            points: points as u32,
            count_v: count_v as u32,
            flags: flags | if rational { RATIONAL } else { 0 },
            trims: 0,
            intervals: 0,
            padding: 0,
        });
        self.frames.push(PackedFrame { origin: surface.origin(), scale, breaks, edge_band: DVec2::ZERO });
        self.programs.push(program);
        Ok(())
    }

    /// Appends the table of the spans of a direction ([`FaceRecord`]); returns where it starts.
    fn push_spans(&mut self, knots: &KnotVector) -> Result<usize, PackError> {
        let table = self.numbers.knots.len();
        let (degree, all) = (knots.degree(), knots.knots());
        let ((low, _), whole) = (knots.domain(), knots.length());
        self.numbers.knots.extend(knots.spans().map(|span| ((all[span] - low) / whole) as f32));
        self.numbers.knots.push(1.0);
        for span in knots.spans() {
            let (start, length) = (all[span], all[span + 1] - all[span]);
            let local: Vec<f64> = all[span + 1 - degree..=span + degree]
                .iter()
                .map(|knot| ((knot - start) / length).clamp(-FARTHEST_KNOT, FARTHEST_KNOT))
                .collect();
            // The knots that the derivatives are divided by, degree apart.
            let narrowest = (0..degree).fold(f64::INFINITY, |least, r| least.min(local[degree + r] - local[r]));
            let gain = power_of_two(narrowest);
            if span - degree >= 1 << f32::MANTISSA_DIGITS {
                let (count, greatest) = (span - degree, 1 << f32::MANTISSA_DIGITS);
                return Err(PackError::TooLarge { what: "control points in one direction", count, greatest });
            }
            let share = (length / whole).max(f64::from(f32::MIN_POSITIVE));
            let head: [f64; SPAN_HEAD] = [(span - degree) as f64, share, gain, 1.0 / (share * gain)];
            self.numbers.knots.extend(head.into_iter().chain(local).map(|x| x as f32));
        }
        if self.numbers.knots.len() > GREATEST_COUNT {
            return Err(PackError::TooLarge {
                what: "knots",
                count: self.numbers.knots.len(),
                greatest: GREATEST_COUNT,
            });
        }
        Ok(table)
    }
}

/// The surface with both degrees raised to the next specialised one, and that degree.
fn specialised(surface: &Surface) -> (Surface, u32) {
    let target = (surface.degree().into_iter().max().expect("two degrees").max(3)) | 1;
    let mut raised = surface.clone();
    for direction in [Direction::U, Direction::V] {
        while raised.knots(direction).degree() < target {
            raised = raised.elevated(direction).expect("the target is odd and at most 15, the cap");
        }
    }
    (raised, target as u32)
}

/// The least power of two at or above a positive `x`, if it and its reciprocal are normal in f32 and f64 alike.
fn power_of_two_above(x: f64) -> Option<f64> {
    if x == 0.0 {
        // A face collapsed to a point has no size; any scale serves it.
        return Some(1.0);
    }
    if !(x.is_normal() && x < 1e300) {
        return None;
    }
    let below = power_of_two(x);
    Some(if below == x { x } else { below * 2.0 })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_power_of_two_is_found_at_or_above() {
        for (x, above) in [(1.0, 1.0), (1.1, 2.0), (0.75, 1.0), (4.0, 4.0), (1e6, 1048576.0), (0.0, 1.0)] {
            assert_eq!(power_of_two_above(x), Some(above));
        }
        assert_eq!(power_of_two_above(f64::INFINITY), None);
    }
}
