//! Surfaces of the file with the way from its own parameters to those of their shapes.

use super::curve::{axis, mapped, moved, whole};
use super::entities::Entity;
use super::fault::{Fault, fault};
use super::geometry::{DEEPEST, Geometry, moved_frame};
use super::ruled::ruled;
use super::spline::{cubic_surface, spline_surface};
use super::value::Parameters;
use crate::brep::curve::Curve;
use crate::brep::frame::{Frame, Motion};
use crate::brep::offset::size;
use crate::brep::path::{Piece, Use};
use crate::brep::shape::{Profile, Shape};
use crate::brep::source::Bound;
use glam::{DAffine2, DMat2, DVec2, DVec3};
use nurbs::{Direction, NurbsError, Surface};
use std::f64::consts::{FRAC_PI_2, TAU};

/// Types of surfaces.
pub(super) const SURFACES: [u16; 12] = [108, 114, 118, 120, 122, 128, 140, 190, 192, 194, 196, 198];

/// A share of the size of a side below which it is a point.
const POINT: f64 = 1e-9;

/// At how many places of a side that is asked.
const PLACES: usize = 8;

/// A surface of the file.
#[derive(Debug, Clone)]
pub(super) struct Sheet {
    pub shape: Shape,
    /// From the file's parameters to the shape's; `None` where those of the file are not known.
    map: Option<DAffine2>,
    /// The rectangle of the shape's parameters that the surface is; `None` where it is all of the shape.
    ends: Option<[[f64; 2]; 2]>,
    /// What its reader has to tell: it is not quite what the file says.
    pub remark: Option<String>,
}

impl Sheet {
    /// A surface of the file.
    pub fn read(geometry: &Geometry, number: u32) -> Result<Self, Fault> {
        Self::read_within(geometry, number, 0)
    }

    fn read_within(geometry: &Geometry, number: u32, depth: usize) -> Result<Self, Fault> {
        if DEEPEST < depth {
            return Err(fault(number, "it is made of surfaces too deep"));
        }
        let entity = geometry.get(number)?;
        let motion = geometry.motion(entity.entry.matrix)?;
        let sheet = match entity.entry.kind {
            140 => offset(geometry, entity.parameters(), depth)?,
            _ => own(geometry, &entity)?,
        };
        let turned = sheet.moved(&motion);
        turned.ok_or_else(|| fault(number, "its matrix is no rotation, and it is no spline"))
    }

    /// A surface with the parameters that the file gives it.
    fn spline(surface: Surface, tolerance: f64) -> Self {
        let shape = Shape::spline(surface, tolerance);
        Self { shape, map: Some(DAffine2::IDENTITY), ends: None, remark: None }
    }

    /// A surface whose parameters in the file are not used.
    fn bare(shape: Shape) -> Self {
        Self { shape, map: None, ends: None, remark: None }
    }

    /// Whether the shape's normal, S_u × S_v, is that of the file.
    pub fn has_own_normal(&self) -> bool {
        self.map.is_none_or(|map| 0.0 < map.matrix2.determinant())
    }

    /// A curve in the file's parameters as one in the shape's.
    pub fn plane_piece(&self, piece: &Piece) -> Option<Piece> {
        mapped(piece, &self.map?)
    }

    /// The border of the surface where no curve bounds it; `None` where it is the whole of its shape, which `natural` says
    /// to give all the same.
    ///
    /// # Errors
    /// With the reason, where the surface is endless.
    pub fn border(&self, natural: bool) -> Result<Option<Bound>, &'static str> {
        let rectangle = match (self.ends, natural) {
            (Some(ends), _) => ends,
            (None, true) => self.shape.natural(),
            (None, false) if self.shape.natural().iter().flatten().all(|end| end.is_finite()) => return Ok(None),
            (None, false) => return Err("it is endless, and nothing bounds it"),
        };
        if !rectangle.iter().flatten().all(|end| end.is_finite()) {
            return Err("it is endless, and nothing bounds it");
        }
        let [[u0, u1], [v0, v1]] = rectangle;
        let corners = [DVec2::new(u0, v0), DVec2::new(u1, v0), DVec2::new(u1, v1), DVec2::new(u0, v1)];
        let size = nurbs::Hull::of(corners.iter().map(|uv| self.shape.point(*uv))).diagonal();
        let side = |k: usize| {
            let (a, b) = (corners[k], corners[(k + 1) % 4]);
            let places = (0..=PLACES).map(|i| self.shape.point(a.lerp(b, i as f64 / PLACES as f64)));
            // At a pole a loop goes on by itself.
            let is_point = nurbs::Hull::of(places).diagonal() <= POINT * size;
            let line = Curve::Line { origin: a.extend(0.0), direction: (b - a).extend(0.0) };
            let plane = Piece { curve: line, range: [0.0, 1.0] };
            (!is_point).then_some(Use {
                space: None,
                plane: Some(plane),
                reversed: false,
                edge: None,
                vertices: [0.0; 2],
            })
        };
        let mut uses: Vec<Use> = (0..4).filter_map(side).collect();
        // With the shape's normal the other way round, the loop is, too.
        if !self.has_own_normal() {
            uses.reverse();
            uses.iter_mut().for_each(|u| u.reversed = true);
        }
        Ok(Some(Bound { outer: true, uses }))
    }

    fn moved(self, motion: &Motion) -> Option<Self> {
        if *motion == Motion::IDENTITY {
            return Some(self);
        }
        let shape = match self.shape {
            Shape::Plane(frame) => {
                let turned = moved_frame(&frame, motion)?;
                // Of a reflection the normal is the image's, too.
                let flips = turned.z.dot(motion.vector(frame.z)) < 0.0;
                Shape::Plane(if flips { Frame { y: -turned.y, z: -turned.z, ..turned } } else { turned })
            }
            Shape::Spline { surface, closed } => {
                let [u, v] = [Direction::U, Direction::V].map(|direction| surface.knots(direction).clone());
                let points = surface.points().iter().map(|p| motion.point(*p)).collect();
                let weights = surface.weights().map(<[f64]>::to_vec);
                Shape::Spline { surface: Surface::new(u, v, points, weights).ok()?, closed }
            }
            Shape::Extruded { curve, vector } => {
                Shape::Extruded { curve: moved_curve(&curve, motion)?, vector: motion.vector(vector) }
            }
            Shape::Revolved { frame, profile } => {
                let profile = match profile {
                    Profile::Curve(curve) => Profile::Curve(moved_curve(&curve, motion)?),
                    // The image's heights are counted downward.
                    Profile::Line { radius, slope } if motion.mirrors() => Profile::Line { radius, slope: -slope },
                    other => other,
                };
                Shape::Revolved { frame: moved_frame(&frame, motion)?, profile }
            }
        };
        Some(Self { shape, ..self })
    }
}

fn moved_curve(curve: &Curve, motion: &Motion) -> Option<Curve> {
    moved(&Piece { curve: curve.clone(), range: [0.0, 1.0] }, motion).map(|piece| piece.curve)
}

/// A surface that is made of numbers and curves, without its matrix.
fn own(geometry: &Geometry, entity: &Entity) -> Result<Sheet, Fault> {
    let own = entity.parameters();
    let number = entity.entry.number;
    match entity.entry.kind {
        108 => {
            let v = own.numbers(1, 4)?;
            let normal = DVec3::from_slice(&v);
            let frame = Frame::new(normal * (v[3] / normal.length_squared()), Some(normal), None);
            Ok(Sheet::bare(Shape::Plane(frame.ok_or_else(|| fault(number, "the plane has no normal"))?)))
        }
        114 => Ok(Sheet::spline(cubic_surface(geometry, own)?, geometry.tolerance)),
        118 => {
            let (surface, remark) = ruled(geometry, entity)?;
            Ok(Sheet { remark, ..Sheet::spline(surface, geometry.tolerance) })
        }
        120 => revolution(geometry, own),
        122 => cylinder(geometry, own),
        128 => Ok(Sheet::spline(spline_surface(geometry, own)?, geometry.tolerance)),
        190..=198 => analytic(geometry, entity),
        kind => Err(fault(number, format!("surfaces of type {kind} are not read"))),
    }
}

/// A surface of revolution (120): in the file the curve's parameter comes first, and the angle after it.
fn revolution(geometry: &Geometry, own: Parameters) -> Result<Sheet, Fault> {
    let [from, to] = axis(geometry, own.pointer(1)?)?;
    let piece = whole(geometry, own.pointer(2)?)?;
    let (start, end) = (own.number(3)?, own.number(4)?);
    if !(start < end && end - start <= TAU * (1.0 + POINT)) {
        return Err(fault(own.number, format!("it turns from {start} to {end}")));
    }
    let size = nurbs::Hull::of((0..=PLACES).map(|k| piece.point(k as f64 / PLACES as f64))).diagonal();
    let toward = axis_x(&piece, from, to, size);
    let frame =
        Frame::new(from, Some(to - from), toward).ok_or_else(|| fault(own.number, "its axis has no direction"))?;
    let wrong = |cause: NurbsError| fault(own.number, cause.to_string());
    // A line has ends here, and any closed curve begins where its piece does.
    let (curve, range) = match piece.curve {
        Curve::Line { .. } => {
            let mut splines = piece.curve.splines(piece.range).map_err(wrong)?;
            (Curve::Spline { spline: splines.remove(0), is_closed: false }, piece.range)
        }
        curve => (curve, piece.range),
    };
    let shape = Shape::Revolved { frame, profile: Profile::Curve(curve) };
    let map = DAffine2::from_mat2(DMat2::from_cols(DVec2::Y, DVec2::X));
    Ok(Sheet { shape, map: Some(map), ends: Some([[start, end.min(start + TAU)], range]), remark: None })
}

/// A direction from the axis to the curve, so that the frame is where the curve is; `None` where the curve is on the axis.
fn axis_x(piece: &Piece, from: DVec3, to: DVec3, size: f64) -> Option<DVec3> {
    let z = (to - from).try_normalize()?;
    let arm = |k: usize| {
        let d = piece.point(k as f64 / PLACES as f64) - from;
        d - z * d.dot(z)
    };
    (0..=PLACES).map(arm).find(|arm| POINT * size < arm.length())
}

/// A tabulated cylinder (122): in the file both parameters run from 0 to 1.
fn cylinder(geometry: &Geometry, own: Parameters) -> Result<Sheet, Fault> {
    let Piece { curve, range: [a, b] } = whole(geometry, own.pointer(1)?)?;
    let vector = DVec3::from_slice(&own.numbers(2, 3)?) - curve.point(a);
    if vector.length() == 0.0 {
        return Err(fault(own.number, "it has no height"));
    }
    let map = DAffine2::from_scale_angle_translation(DVec2::new(b - a, 1.0), 0.0, DVec2::new(a, 0.0));
    let ends = [[a, b], [0.0, 1.0]];
    Ok(Sheet { shape: Shape::Extruded { curve, vector }, map: Some(map), ends: Some(ends), remark: None })
}

/// An offset surface (140).
fn offset(geometry: &Geometry, own: Parameters, depth: usize) -> Result<Sheet, Fault> {
    let indicator = DVec3::from_slice(&own.numbers(1, 3)?);
    let distance = own.number(4)?;
    let sheet = Sheet::read_within(geometry, own.pointer(5)?, depth + 1)?;
    // The indicator says on which side the surface is, at the middle of its parameters.
    let [u, v] = sheet.ends.unwrap_or(sheet.shape.natural()).map(|[a, b]| {
        let middle = 0.5 * (a + b);
        if middle.is_finite() { middle } else { 0.0 }
    });
    const STEP: f64 = 1e-5;
    let d = |du: f64, dv: f64| sheet.shape.point(DVec2::new(u + du, v + dv));
    let normal = (d(STEP, 0.0) - d(-STEP, 0.0)).cross(d(0.0, STEP) - d(0.0, -STEP));
    let distance = if normal.dot(indicator) < 0.0 { -distance } else { distance };
    let offset = crate::brep::offset::offset(&sheet.shape, distance, sheet.ends, geometry.tolerance, geometry.effort);
    let shape = geometry.beside(own.number, offset)?;
    geometry.spend(own.number, size(&shape))?;
    Ok(Sheet { shape, ..sheet })
}

/// Planes, cylinders, cones, spheres and tori (190 to 198); their angles are degrees.
fn analytic(geometry: &Geometry, entity: &Entity) -> Result<Sheet, Fault> {
    let own = entity.parameters();
    let number = entity.entry.number;
    let has_reference = entity.entry.form == 1;
    let origin = geometry.point(own.pointer(1)?)?;
    let frame = |axis: usize, reference: usize| {
        let direction = |at: usize| own.optional_pointer(at)?.map(|d| geometry.direction(d)).transpose();
        let x = if has_reference { direction(reference)? } else { None };
        Frame::new(origin, direction(axis)?, x).ok_or_else(|| fault(number, "its axis has no direction"))
    };
    let radius = |at: usize| {
        let radius = own.number(at)?;
        if 0.0 < radius { Ok(radius) } else { Err(fault(number, "a radius is not above 0")) }
    };
    let shape = match entity.entry.kind {
        190 => Shape::Plane(frame(2, 3)?),
        192 => Shape::Revolved { frame: frame(2, 4)?, profile: Profile::Line { radius: radius(3)?, slope: 0.0 } },
        194 => {
            let (radius, angle) = (own.number(3)?, own.number(4)?.to_radians());
            if !(0.0 <= radius && angle != 0.0 && angle.abs() < FRAC_PI_2) {
                return Err(fault(number, "it is no cone"));
            }
            Shape::Revolved { frame: frame(2, 5)?, profile: Profile::Line { radius, slope: libm::tan(angle) } }
        }
        196 => Shape::Revolved { frame: frame(3, 4)?, profile: Profile::sphere(radius(2)?) },
        198 => Shape::Revolved { frame: frame(2, 5)?, profile: Profile::torus(radius(3)?, radius(4)?, true) },
        kind => return Err(fault(number, format!("surfaces of type {kind} are not read"))),
    };
    Ok(Sheet::bare(shape))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::brep::inverse::Inverter;

    fn sheets() -> Vec<Sheet> {
        let frame = Frame::new(DVec3::new(1.0, 2.0, 3.0), Some(DVec3::new(1.0, 1.0, 2.0)), Some(DVec3::Y)).unwrap();
        let revolved = |profile| Shape::Revolved { frame, profile };
        let line = Curve::Line { origin: DVec3::new(5.0, 2.0, 3.0), direction: DVec3::new(0.2, 0.3, 1.0) };
        let ellipse = Curve::Ellipse { frame, radii: DVec2::new(2.0, 1.0) };
        let map = Some(DAffine2::IDENTITY);
        let mapped = |shape| Sheet { shape, map, ends: None, remark: None };
        let bare = [Profile::Line { radius: 2.0, slope: 0.0 }, Profile::Line { radius: 2.0, slope: -0.5 }];
        let round = [Profile::sphere(2.0), Profile::torus(3.0, 1.0, true)];
        let bare = bare.into_iter().chain(round).map(revolved).chain([Shape::Plane(frame)]).map(Sheet::bare);
        let swept =
            [revolved(Profile::Curve(line)), Shape::Extruded { curve: ellipse, vector: DVec3::new(1.0, 0.0, 3.0) }];
        bare.chain(swept.map(mapped)).collect()
    }

    fn normal(shape: &Shape, uv: DVec2) -> DVec3 {
        const STEP: f64 = 1e-5;
        let d = |du: f64, dv: f64| shape.point(uv + DVec2::new(du, dv));
        (d(STEP, 0.0) - d(-STEP, 0.0)).cross(d(0.0, STEP) - d(0.0, -STEP)).normalize()
    }

    /// Of a reflection, too: a surface that has no parameters in the file keeps the side that is out, and one that has
    /// them keeps these.
    #[test]
    fn a_moved_surface_is_the_image_of_the_surface() {
        let turn = Frame::new(DVec3::new(-3.0, 0.5, 8.0), Some(DVec3::new(0.3, -0.2, 1.0)), None).unwrap();
        for mirror in [1.0, -1.0] {
            let motion = Motion::new([turn.x, turn.y * mirror, turn.z], turn.origin);
            for sheet in sheets() {
                let moved = sheet.clone().moved(&motion).unwrap();
                let inverter = Inverter::new(&moved.shape, 10.0);
                for k in 0..40 {
                    let uv = DVec2::new(0.1 + 0.07 * f64::from(k), -0.9 + 0.03 * f64::from(k));
                    let image = motion.point(sheet.shape.point(uv));
                    let expected = motion.vector(normal(&sheet.shape, uv));
                    if sheet.map.is_some() {
                        assert!(moved.shape.point(uv).distance(image) < 1e-12, "{sheet:?}");
                        assert!(normal(&moved.shape, uv).distance(expected * mirror) < 1e-8, "{sheet:?}");
                    } else {
                        let found = inverter.parameters(image, None, 1e-12).uv;
                        assert!(moved.shape.point(found).distance(image) < 1e-12, "{sheet:?}");
                        assert!(normal(&moved.shape, found).distance(expected) < 1e-8, "{sheet:?}");
                    }
                }
            }
        }
    }
}
