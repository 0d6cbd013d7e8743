//! What all geometry of a file shares: entities, tolerance, a limit on the work, points and matrices.

use super::entities::{Entities, Entity};
use super::fault::{Fault, fault};
use crate::brep::effort::Effort;
use crate::brep::frame::{Frame, Motion};
use crate::brep::off::Off;
use crate::brep::parallel::{Offset, OffsetError};
use glam::DVec3;
use std::cell::Cell;

/// How deep matrices, curves and surfaces may be made of others.
pub(super) const DEEPEST: usize = 16;

/// How far a matrix may be from a rotation, and its axes are taken as such: files print them with six digits or more.
const PRINTED: f64 = 1e-5;

/// The geometry of a file.
#[derive(Debug, Clone, Copy)]
pub(super) struct Geometry<'f, 'b> {
    pub entities: &'f Entities<'b>,
    /// Points nearer to each other than this are one, model units.
    pub tolerance: f64,
    /// How far anything that was made is from what the file says, at most, as measured, model units.
    pub off: &'f Cell<Off>,
    /// How many control points and edges may still be made.
    pub work: &'f Cell<usize>,
    /// How much offsets may still cost.
    pub effort: &'f Effort,
}

impl Geometry<'_, '_> {
    pub fn get(&self, number: u32) -> Result<Entity, Fault> {
        self.entities.get(number)
    }

    /// An entity that has to be of one type.
    pub fn get_of(&self, number: u32, kind: u16, what: &str) -> Result<Entity, Fault> {
        let entity = self.get(number)?;
        match entity.entry.kind == kind {
            true => Ok(entity),
            false => {
                Err(fault(number, format!("it is of type {}, where {what} ({kind}) is needed", entity.entry.kind)))
            }
        }
    }

    /// Counts so many control points or edges.
    pub fn spend(&self, number: u32, count: usize) -> Result<(), Fault> {
        let left = self.work.get().checked_sub(count);
        self.work.set(left.unwrap_or(0));
        left.map(|_| ())
            .ok_or_else(|| fault(number, "the file names its curves and surfaces so often that no more are made"))
    }

    /// What stands at a distance from something; how far it is off is kept.
    pub fn beside<T>(&self, number: u32, offset: Result<Offset<T>, OffsetError>) -> Result<T, Fault> {
        let Offset { made, off } = offset.map_err(|cause| fault(number, cause.to_string()))?;
        self.off.set(self.off.get().max(off));
        Ok(made)
    }

    /// A point (116), moved by its matrix.
    pub fn point(&self, number: u32) -> Result<DVec3, Fault> {
        let entity = self.get_of(number, 116, "a point")?;
        let point = DVec3::from_slice(&entity.parameters().numbers(1, 3)?);
        Ok(self.motion(entity.entry.matrix)?.point(point))
    }

    /// A direction (123), turned by its matrix.
    pub fn direction(&self, number: u32) -> Result<DVec3, Fault> {
        let entity = self.get_of(number, 123, "a direction")?;
        let direction = DVec3::from_slice(&entity.parameters().numbers(1, 3)?);
        Ok(self.motion(entity.entry.matrix)?.vector(direction))
    }

    /// The move of a matrix (124) and of the matrices that it has itself; none for 0.
    pub fn motion(&self, matrix: u32) -> Result<Motion, Fault> {
        let (mut motion, mut next) = (Motion::IDENTITY, matrix);
        for _ in 0..DEEPEST {
            if next == 0 {
                return Ok(motion);
            }
            let entity = self.get_of(next, 124, "a matrix")?;
            let r = entity.parameters().numbers(1, 12)?;
            let column = |k: usize| DVec3::new(r[k], r[4 + k], r[8 + k]);
            let own = Motion::new([column(0), column(1), column(2)], column(3));
            if own.factor() == 0.0 {
                return Err(fault(next, "the matrix flattens space"));
            }
            motion = own.after(&motion);
            next = entity.entry.matrix;
        }
        Err(fault(matrix, "matrices have matrices too deep"))
    }
}

/// A frame moved; `None` where the move is no rotation or reflection. Of a reflection x and y are the images, and z is
/// opposite to its own.
pub(super) fn moved_frame(frame: &Frame, motion: &Motion) -> Option<Frame> {
    if *motion == Motion::IDENTITY {
        return Some(*frame);
    }
    let [x, y, z] = [frame.x, frame.y, frame.z].map(|axis| motion.vector(axis));
    let is_unit = |v: &DVec3| (v.length() - 1.0).abs() <= PRINTED;
    let is_square = [x.dot(y), y.dot(z), z.dot(x)].iter().all(|dot| dot.abs() <= PRINTED);
    if !([x, y, z].iter().all(is_unit) && is_square) {
        return None;
    }
    Frame::new(motion.point(frame.origin), Some(x.cross(y)), Some(x))
}
