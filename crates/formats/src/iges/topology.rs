//! Faces of the file, as the boundary representation takes them: bounded and trimmed surfaces (143, 144), and faces of
//! shells (510).

use super::curve::{Space, chained, pieces};
use super::edges::{Edges, Pieces, on_surface};
use super::fault::{Fault, fault};
use super::geometry::Geometry;
use super::sheet::Sheet;
use super::value::Parameters;
use crate::brep::frame::Motion;
use crate::brep::path::Piece;
use crate::brep::source::{Bound, Source};

/// A face ready to be made.
pub(super) struct Read {
    pub source: Source,
    /// How it is moved afterwards: the matrix of the face itself.
    pub motion: Motion,
    /// What is not quite what the file says.
    pub remark: Option<String>,
}

/// Reads faces; edges and vertices of shells are read once.
pub(super) struct Faces<'g, 'f, 'b> {
    geometry: &'g Geometry<'f, 'b>,
    edges: Edges,
}

impl<'g, 'f, 'b> Faces<'g, 'f, 'b> {
    pub fn new(geometry: &'g Geometry<'f, 'b>) -> Self {
        Self { geometry, edges: Edges::default() }
    }

    /// A face, or a surface that stands by itself.
    ///
    /// # Errors
    /// With the entity that is at fault: the face itself, or one that it is made of.
    pub fn read(&mut self, number: u32) -> Result<Read, Fault> {
        let entity = self.geometry.get(number)?;
        let own = entity.parameters();
        let motion = self.geometry.motion(entity.entry.matrix)?;
        match entity.entry.kind {
            144 => self.trimmed(own, motion),
            143 => self.bounded(own, motion),
            510 => self.face(own, motion),
            kind => {
                // A surface has its own matrix in it.
                let sheet = Sheet::read(self.geometry, number)?;
                let bounds = match own.optional_pointer(5)? {
                    Some(curve) if kind == 108 && entity.entry.form == 1 => vec![self.of_space(curve, true)?],
                    _ if kind == 108 && entity.entry.form == -1 => {
                        return Err(fault(number, "it is a hole of a plane, and names no plane"));
                    }
                    _ => whole(&sheet, number)?,
                };
                Ok(self.source(sheet, bounds, Motion::IDENTITY))
            }
        }
    }

    fn source(&self, sheet: Sheet, bounds: Vec<Bound>, motion: Motion) -> Read {
        let same_sense = sheet.has_own_normal();
        let source = Source {
            shape: sheet.shape,
            same_sense,
            bounds,
            tolerance: self.geometry.tolerance,
            off: self.geometry.off.take(),
        };
        Read { source, motion, remark: sheet.remark }
    }

    /// A trimmed surface (144): an outer boundary, or none where it is the surface's own, and inner ones.
    fn trimmed(&self, own: Parameters, motion: Motion) -> Result<Read, Fault> {
        let sheet = Sheet::read(self.geometry, own.pointer(1)?)?;
        let has_outer = own.flag(2)?;
        let inner = own.count(3, 1)?;
        let mut bounds = vec![];
        match own.optional_pointer(4)?.filter(|_| has_outer) {
            Some(outer) => bounds.push(self.curve_on_surface(outer, &sheet, true)?),
            None if has_outer => {
                return Err(fault(own.number, "it has no outer boundary where it says that it has one"));
            }
            None if inner == 0 => bounds = whole(&sheet, own.number)?,
            None => bounds.extend(sheet.border(true).map_err(|why| fault(own.number, why))?),
        }
        for curve in own.pointers(5, inner)? {
            bounds.push(self.curve_on_surface(curve, &sheet, false)?);
        }
        Ok(self.source(sheet, bounds, motion))
    }

    /// A bounded surface (143): boundaries of which none is named the outer one.
    fn bounded(&self, own: Parameters, motion: Motion) -> Result<Read, Fault> {
        let sheet = Sheet::read(self.geometry, own.pointer(2)?)?;
        let mut bounds = vec![];
        for boundary in own.pointers(4, own.count(3, 1)?)? {
            bounds.push(self.boundary(boundary, &sheet)?);
        }
        if bounds.is_empty() {
            bounds = whole(&sheet, own.number)?;
        }
        Ok(self.source(sheet, bounds, motion))
    }

    /// A curve on a surface (142), by its curve in (u, v), or else by the one in space.
    fn curve_on_surface(&self, number: u32, sheet: &Sheet, outer: bool) -> Result<Bound, Fault> {
        let entity = self.geometry.get_of(number, 142, "a curve on a surface")?;
        let own = entity.parameters();
        let plane = own.optional_pointer(3)?.map(|curve| self.of_plane(curve, sheet));
        let space = own.optional_pointer(4)?.map(|curve| pieces(self.geometry, curve, Space::Model));
        // 1: the file prefers the curve in (u, v).
        let is_preferred = own.whole(5).is_ok_and(|preferred| preferred == 1);
        let pieces = match (plane, space) {
            (Some(Ok(plane)), Some(Ok(space))) => {
                let is_right = is_preferred || on_surface(&sheet.shape, &plane, &space, self.geometry.tolerance);
                if is_right { Pieces::Plane(chained(plane)) } else { Pieces::Space(space) }
            }
            (Some(Ok(plane)), _) => Pieces::Plane(chained(plane)),
            (_, Some(Ok(space))) => Pieces::Space(space),
            (Some(Err(cause)), _) | (None, Some(Err(cause))) => return Err(cause),
            (None, None) => return Err(fault(number, "it has no curve")),
        };
        Ok(Bound { outer, uses: pieces.uses(None) })
    }

    /// A boundary (141): curves in space in order, each with curves in (u, v).
    fn boundary(&self, number: u32, sheet: &Sheet) -> Result<Bound, Fault> {
        let entity = self.geometry.get_of(number, 141, "a boundary")?;
        let own = entity.parameters();
        let mut uses = vec![];
        let mut at = 5;
        for _ in 0..own.count(4, 3)? {
            let curve = own.pointer(at)?;
            let is_reversed = own.whole(at + 1)? == 2;
            let count = own.count(at + 2, 1)?;
            let space = pieces(self.geometry, curve, Space::Model)?;
            let plane = own.pointers(at + 3, count)?.into_iter().map(|curve| self.of_plane(curve, sheet));
            let plane: Option<Vec<Piece>> =
                plane.collect::<Result<Vec<_>, _>>().ok().map(|parts| parts.concat()).filter(|parts| !parts.is_empty());
            at += 3 + count;
            match plane.filter(|plane| on_surface(&sheet.shape, plane, &space, self.geometry.tolerance)) {
                // The curves in (u, v) run as the boundary does.
                Some(plane) => uses.extend(Pieces::Plane(plane).uses(None)),
                None => {
                    let mut own = Pieces::Space(space).uses(None);
                    if is_reversed {
                        own.reverse();
                        own.iter_mut().for_each(|u| u.reversed = true);
                    }
                    uses.extend(own);
                }
            }
        }
        Ok(Bound { outer: false, uses })
    }

    /// A loop of a curve in space.
    fn of_space(&self, curve: u32, outer: bool) -> Result<Bound, Fault> {
        let pieces = Pieces::Space(pieces(self.geometry, curve, Space::Model)?);
        Ok(Bound { outer, uses: pieces.uses(None) })
    }

    /// A curve in the parameters of a surface, in those of its shape.
    fn of_plane(&self, curve: u32, sheet: &Sheet) -> Result<Vec<Piece>, Fault> {
        let pieces = pieces(self.geometry, curve, Space::Parameters)?;
        let mapped = pieces.iter().map(|piece| sheet.plane_piece(piece)).collect::<Option<Vec<_>>>();
        mapped.ok_or_else(|| fault(curve, "it lies in parameters that its surface does not have"))
    }

    /// A face of a shell (510).
    fn face(&mut self, own: Parameters, motion: Motion) -> Result<Read, Fault> {
        let sheet = Sheet::read(self.geometry, own.pointer(1)?)?;
        let count = own.whole(2)?;
        let has_outer = own.flag(3)?;
        let mut bounds = vec![];
        let there = own.values.len().saturating_sub(4);
        if there < count {
            return Err(fault(own.number, format!("it counts {count} loops, of which there are {there}")));
        }
        for (k, number) in own.pointers(4, count)?.into_iter().enumerate() {
            let uses = self.edges.uses(self.geometry, number, &sheet)?;
            bounds.push(Bound { outer: has_outer && k == 0, uses });
        }
        if bounds.iter().all(|bound| bound.uses.is_empty()) {
            bounds = whole(&sheet, own.number)?;
        }
        Ok(self.source(sheet, bounds, motion))
    }
}

/// The bounds of a whole surface: none where its shape ends by itself.
fn whole(sheet: &Sheet, number: u32) -> Result<Vec<Bound>, Fault> {
    Ok(sheet.border(false).map_err(|why| fault(number, why))?.into_iter().collect())
}
