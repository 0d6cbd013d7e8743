//! From f64 to f32: the one place that narrows.
//!
//! Each face moves to its own origin and to a scale that is a power of two, so that its control box fills −1 … 1; each
//! knot span that is not empty becomes 0 … 1, with the knots around it. What is lost is 2⁻²⁴ of the face's own size, wherever in
//! the world it lies, and 2⁻²⁴ of a span, however short it is.

use crate::eval::Span;
use crate::fragment::Fragment;
use crate::layout::{BOUNDED, FaceRecord, Parameters, RATIONAL, REVERSED, SEARCHED, SPAN_HEAD, View};
use crate::mask::{self, Masks};
use gbuffer::{Hit, LocalParameters, PrincipalCurvatures};
use glam::{DMat4, DVec2, DVec3};
use nurbs::{Direction, KnotVector, Normal, NormalStatus, Surface, power_of_two};
use scene::{Camera, FaceId, Model, Projection, Ray, Viewport};

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

/// The program of a face.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Program {
    /// Loops run to the face's own degrees.
    General,
    /// Degree known to the compiler, the same in both directions.
    Degree(u32),
}

/// Why a model could not be packed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PackError {
    /// More numbers than 32-bit indices reach.
    #[error("the model has {count} {what}, more than a packed scene can index ({greatest})")]
    TooLarge {
        /// What there is too much of.
        what: &'static str,
        /// How many there are.
        count: usize,
        /// How many there may be.
        greatest: usize,
    },
    /// A face's coordinates are too small or too large for a scale that is a finite power of two.
    #[error("face {face} measures {size:e} model units: too small or too large for f32 at any scale")]
    Scale {
        /// The face.
        face: usize,
        /// Its size.
        size: f64,
    },
}

/// The most control points or knots of a packed scene: their bytes stay below 4 GiB, the reach of a GPU binding.
pub(crate) const GREATEST_COUNT: usize = 1 << 27;

/// How far from a span, in lengths of it, a knot is put at most: what lies beyond changes the basis functions on the span by less
/// than f32 can tell.
const FARTHEST_KNOT: f64 = (1u64 << 60) as f64;

/// How a face's local coordinates and parameters become the model's.
#[derive(Debug, Clone, PartialEq)]
pub struct PackedFrame {
    /// World position of the local origin.
    pub origin: DVec3,
    /// Model units a local unit; a power of two.
    pub scale: f64,
    /// The ends of the knot spans that are not empty, in u and v, ascending: span k is from number k to k + 1.
    pub breaks: [Vec<f64>; 2],
    /// How near an edge of a trimmed face may pass a fragment that is told the wrong side of it, in u and v, local
    /// parameters; zeros where the face is whole.
    pub edge_band: DVec2,
}

impl PackedFrame {
    /// World position of a local one.
    pub fn world(&self, local: [f32; 3]) -> DVec3 {
        self.origin + DVec3::from_array(local.map(f64::from)) * self.scale
    }

    /// Local coordinates of a world position, narrowed.
    pub fn local(&self, world: DVec3) -> [f32; 3] {
        ((world - self.origin) / self.scale).to_array().map(|x| x as f32)
    }

    /// Parameters in the knot domain from those of a span; 1 gives the span's end exactly.
    ///
    /// # Panics
    /// Where the face has no such span.
    pub fn uv(&self, span: [u32; 2], local: [f32; 2]) -> DVec2 {
        let one = |k: usize| {
            let [start, end] = self.span(k, span[k]);
            let t = f64::from(local[k]);
            if t >= 1.0 { end } else { start + (end - start) * t }
        };
        DVec2::new(one(0), one(1))
    }

    /// How many Bézier pieces the face has.
    pub fn pieces(&self) -> usize {
        (self.breaks[0].len() - 1) * (self.breaks[1].len() - 1)
    }

    /// The ends of a span in direction `k` (0 for u, 1 for v), in the knot domain.
    ///
    /// # Panics
    /// Where the face has no such span.
    pub fn span(&self, k: usize, span: u32) -> [f64; 2] {
        [self.breaks[k][span as usize], self.breaks[k][span as usize + 1]]
    }
}

/// A model in f32, as both the CPU and the GPU read it.
#[derive(Debug, Clone, PartialEq)]
pub struct PackedScene {
    /// One record a face.
    pub faces: Vec<FaceRecord>,
    /// All knots; among them the intervals of trimmed faces.
    pub knots: Vec<f32>,
    /// All homogeneous control points (w x, w y, w z, w); among them the pieces and edges of trimmed faces.
    pub points: Vec<[f32; 4]>,
    /// One frame a face.
    pub frames: Vec<PackedFrame>,
    /// One program a face.
    pub programs: Vec<Program>,
    /// The masks by which faces are trimmed, where they are not by their curves.
    pub masks: Option<Masks>,
    /// Whether fragments of trimmed faces look for the edge that passes by ([`crate::edge`]).
    pub edges: bool,
}

impl PackedScene {
    /// Packs all faces of a model.
    ///
    /// # Errors
    /// [`PackError`] where the model is too large to index or a face has no usable size.
    pub fn new(model: &Model, scheme: Scheme) -> Result<Self, PackError> {
        Self::untrimmed(model, scheme)?.trimmed(model)
    }

    /// As [`Self::new`], for fragments that look for the trim edge that passes by.
    ///
    /// # Errors
    /// As of [`Self::new`].
    pub fn with_edges(model: &Model, scheme: Scheme) -> Result<Self, PackError> {
        Self { edges: true, ..Self::untrimmed(model, scheme)? }.trimmed(model)
    }

    /// The whole surfaces with all regions.
    fn trimmed(self, model: &Model) -> Result<Self, PackError> {
        let mut packed = self;
        for id in 0..packed.faces.len() {
            if let Some(region) = model.trimmed_region(FaceId(id as u32)) {
                let (trims, intervals, band) = packed.push_region(region)?;
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
        let mut packed = Self::untrimmed(model, scheme)?;
        for (id, tile) in masks.plan.tiles.iter().enumerate() {
            if let Some(tile) = tile {
                (packed.faces[id].trims, packed.faces[id].intervals) = (packed.knots.len() as u32, 1);
                packed.frames[id].edge_band = tile.band;
                packed.knots.extend(mask::placement(tile));
            }
        }
        Ok(Self { masks: Some(masks), ..packed })
    }

    /// Packs the whole surfaces.
    fn untrimmed(model: &Model, scheme: Scheme) -> Result<Self, PackError> {
        let mut packed = Self {
            faces: vec![],
            knots: vec![],
            points: vec![],
            frames: vec![],
            programs: vec![],
            masks: None,
            edges: false,
        };
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
        let points = self.points.len();
        let count = points + count_u * count_v;
        if count > GREATEST_COUNT {
            return Err(PackError::TooLarge { what: "control points", count, greatest: GREATEST_COUNT });
        }
        self.points.extend(surface.homogeneous().iter().map(|c| {
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
        let table = self.knots.len();
        let (degree, all) = (knots.degree(), knots.knots());
        let ((low, _), whole) = (knots.domain(), knots.length());
        self.knots.extend(knots.spans().map(|span| ((all[span] - low) / whole) as f32));
        self.knots.push(1.0);
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
            self.knots.extend(head.into_iter().chain(local).map(|x| x as f32));
        }
        if self.knots.len() > GREATEST_COUNT {
            return Err(PackError::TooLarge { what: "knots", count: self.knots.len(), greatest: GREATEST_COUNT });
        }
        Ok(table)
    }

    /// Whether loops bound any face.
    pub fn is_trimmed(&self) -> bool {
        self.faces.iter().any(|face| face.flags & BOUNDED != 0)
    }

    /// A span of a face in u and one in v.
    #[inline(always)]
    pub fn spans(&self, face: &FaceRecord, span: [u32; 2]) -> [Span<'_>; 2] {
        let one = |table: u32, spans: u32, degree: u32, k: u32| {
            Span::new(&self.knots, table as usize, spans as usize, degree as usize, k as usize)
        };
        [
            one(face.table_u, face.spans_u, face.degree_u, span[0]),
            one(face.table_v, face.spans_v, face.degree_v, span[1]),
        ]
    }

    /// Where the spans of a face start in u and in v, in parameters of the whole domain, and 1.
    #[inline(always)]
    pub fn starts(&self, face: &FaceRecord) -> [&[f32]; 2] {
        let one = |table: u32, spans: u32| &self.knots[table as usize..][..spans as usize + 1];
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

    /// How each face is seen by a camera.
    pub fn views(&self, model: &Model, camera: &Camera, viewport: Viewport) -> Vec<View> {
        let hull = model.hull();
        let farthest = hull.corners().iter().fold(camera.near(), |far: f64, corner| far.max(camera.depth(*corner)));
        // Twice the depth needed, so that no rounding pushes the farthest point behind the far plane.
        let range = 2.0 * (farthest - camera.near()).max(hull.diagonal()).max(f64::MIN_POSITIVE);
        let clip_from_world = camera.clip_from_world(viewport, range);
        let perspective = matches!(camera.projection(), Projection::Perspective { .. });
        self.frames
            .iter()
            .map(|frame| {
                let world_from_local =
                    DMat4::from_translation(frame.origin) * DMat4::from_scale(DVec3::splat(frame.scale));
                let clip_from_local = clip_from_world * world_from_local;
                // Homogeneous coordinates are any multiple: one that f32 holds, whatever the scale of the scene.
                let greatest = clip_from_local.to_cols_array().iter().fold(0.0, |most: f64, x| most.max(x.abs()));
                let clip_from_local = clip_from_local * (1.0 / power_of_two(greatest));
                let eye = if perspective {
                    ((camera.eye() - frame.origin) / frame.scale).extend(1.0)
                } else {
                    camera.forward().extend(0.0)
                };
                View {
                    clip_from_local: clip_from_local.to_cols_array_2d().map(|column| column.map(|x| x as f32)),
                    eye: eye.to_array().map(|x| x as f32),
                    units: [
                        (1.0 / frame.scale) as f32,
                        viewport.width() as f32 * 0.5,
                        viewport.height() as f32 * 0.5,
                        0.0,
                    ],
                }
            })
            .collect()
    }

    /// What a fragment of this scene found, widened to the model's units, for the pixel seen along `ray`; of a fragment whose
    /// face has no such spans, parameters that are NaN.
    pub fn hit(&self, fragment: &Fragment, ray: &Ray) -> Hit {
        let frame = &self.frames[fragment.face as usize];
        let position = frame.world(fragment.position);
        let regular = fragment.status == NormalStatus::Regular;
        // A GPU may write anything.
        let is_there = (0..2).all(|k| (fragment.span[k] as usize) + 1 < frame.breaks[k].len());
        let [k1, k2] = fragment.curvature.map(|k| f64::from(k) / frame.scale);
        Hit {
            face: FaceId(fragment.face),
            uv: if is_there { frame.uv(fragment.span, fragment.uv) } else { DVec2::NAN },
            local: is_there.then(|| LocalParameters { span: fragment.span, uv: fragment.uv.map(f64::from).into() }),
            t: (position - ray.origin).dot(ray.direction),
            position,
            normal: if regular {
                Normal::Regular(DVec3::from_array(fragment.normal.map(f64::from)))
            } else {
                Normal::Undefined
            },
            curvature: regular.then_some(PrincipalCurvatures { k1, k2 }),
            edge: fragment.edge.map(|[x, y]| DVec2::new(f64::from(x), f64::from(y))),
        }
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
