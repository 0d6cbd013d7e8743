//! From f64 to f32: the one place that narrows.
//!
//! Each face moves to its own origin and to a scale that is a power of two, so that its control box fills −1 … 1;
//! each knot domain becomes 0 … 1. What is lost is 2⁻²⁴ of the face's own size, wherever in the world it lies.

use crate::fragment::Fragment;
use crate::layout::{BOUNDED, FaceRecord, RATIONAL, REVERSED, View};
use crate::mask::{self, Masks};
use gbuffer::{Hit, PrincipalCurvatures};
use glam::{DMat4, DVec2, DVec3};
use nurbs::{Direction, KnotVector, Normal, NormalStatus, Surface};
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

/// How a face's local coordinates and parameters become the model's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PackedFrame {
    /// World position of the local origin.
    pub origin: DVec3,
    /// Model units a local unit; a power of two.
    pub scale: f64,
    /// The knot domain \[\[u0, u1\], \[v0, v1\]\] that 0 … 1 stands for.
    pub domain: [[f64; 2]; 2],
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

    /// Parameters in the knot domain from local ones; 1 gives the domain's end exactly.
    pub fn uv(&self, local: [f32; 2]) -> DVec2 {
        let one = |[start, end]: [f64; 2], t: f32| {
            if t >= 1.0 { end } else { start + (end - start) * f64::from(t) }
        };
        DVec2::new(one(self.domain[0], local[0]), one(self.domain[1], local[1]))
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
        Self::whole(model, scheme)?.trimmed(model)
    }

    /// As [`Self::new`], for fragments that look for the trim edge that passes by.
    ///
    /// # Errors
    /// As of [`Self::new`].
    pub fn with_edges(model: &Model, scheme: Scheme) -> Result<Self, PackError> {
        Self { edges: true, ..Self::whole(model, scheme)? }.trimmed(model)
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
        let mut packed = Self::whole(model, scheme)?;
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
    fn whole(model: &Model, scheme: Scheme) -> Result<Self, PackError> {
        let mut packed = Self {
            faces: vec![],
            knots: vec![],
            points: vec![],
            frames: vec![],
            programs: vec![],
            masks: None,
            edges: false,
        };
        for (id, face) in model.faces().iter().enumerate() {
            let surface = &model.surfaces()[face.surface];
            let flags = if face.reversed { REVERSED } else { 0 } | if face.loops.is_empty() { 0 } else { BOUNDED };
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
        let unit = power_of_two_above(greatest).expect("weights are positive and finite");
        let rational = surface.weights().is_some_and(|w| w.iter().any(|&x| x != w[0]));
        let [count_u, count_v] = surface.control_counts();
        let knots_u = self.push_knots(ku)?;
        let knots_v = self.push_knots(kv)?;
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
        self.faces.push(FaceRecord {
            degree_u: ku.degree() as u32,
            degree_v: kv.degree() as u32,
            count_u: count_u as u32,
            count_v: count_v as u32,
            knots_u: knots_u as u32,
            knots_v: knots_v as u32,
            points: points as u32,
            last_u: last_span(&self.knots[knots_u..], ku.control_count()),
            last_v: last_span(&self.knots[knots_v..], kv.control_count()),
            flags: flags | if rational { RATIONAL } else { 0 },
            trims: 0,
            intervals: 0,
        });
        self.frames.push(PackedFrame {
            origin: surface.origin(),
            scale,
            domain: surface.domain(),
            edge_band: DVec2::ZERO,
        });
        self.programs.push(program);
        Ok(())
    }

    /// Appends the knots moved to 0 … 1 over the domain; returns where they start.
    fn push_knots(&mut self, knots: &KnotVector) -> Result<usize, PackError> {
        let start = self.knots.len();
        let (low, length) = (knots.domain().0, knots.length());
        self.knots.extend(knots.knots().iter().map(|k| ((k - low) / length) as f32));
        // Rounding keeps the order; the domain's ends are exact: 0 / L and L / L.
        if self.knots.len() > GREATEST_COUNT {
            return Err(PackError::TooLarge { what: "knots", count: self.knots.len(), greatest: GREATEST_COUNT });
        }
        Ok(start)
    }

    /// Whether loops bound any face.
    pub fn is_trimmed(&self) -> bool {
        self.faces.iter().any(|face| face.flags & BOUNDED != 0)
    }

    /// The knots of a face in u and in v.
    #[inline]
    pub fn knots(&self, face: &FaceRecord) -> [&[f32]; 2] {
        let one =
            |start: u32, count: u32, degree: u32| &self.knots[start as usize..(start + count + degree + 1) as usize];
        [one(face.knots_u, face.count_u, face.degree_u), one(face.knots_v, face.count_v, face.degree_v)]
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

    /// What a fragment of this scene found, widened to the model's units, for the pixel seen along `ray`.
    pub fn hit(&self, fragment: &Fragment, ray: &Ray) -> Hit {
        let frame = &self.frames[fragment.face as usize];
        let position = frame.world(fragment.position);
        let regular = fragment.status == NormalStatus::Regular;
        let [k1, k2] = fragment.curvature.map(|k| f64::from(k) / frame.scale);
        Hit {
            face: FaceId(fragment.face),
            uv: frame.uv(fragment.uv),
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

/// The last span that is not empty in f32.
fn last_span(knots: &[f32], count: usize) -> u32 {
    (0..count).rev().find(|&k| knots[k] < knots[k + 1]).expect("the domain runs from 0 to 1") as u32
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
    let below = f64::from_bits(x.to_bits() & !((1 << 52) - 1));
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
