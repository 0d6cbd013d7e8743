//! Points, placements, curves and surfaces of ISO 10303-42, each looked up when it is asked for.

use super::fault::{Fault, fault};
use super::p21::{Instances, MISSING};
use super::spline::spline_parameters;
use super::value::{Entity, Value};
use crate::brep::across::Ramp;
use crate::brep::curve::Curve;
use crate::brep::effort::Effort;
use crate::brep::frame::{Frame, Motion};
use crate::brep::off::Off;
use crate::brep::offset::{offset, size};
use crate::brep::parallel::{Offset, OffsetError, sideways};
use crate::brep::path::Piece;
use crate::brep::shape::{Profile, Shape};
use crate::document::SurfaceKind;
use glam::{DVec2, DVec3};
use nurbs::{KnotVector, NurbsError, SpaceCurve, Surface};
use std::cell::{Cell, RefCell};
use std::collections::BTreeSet;

/// How deep curves and surfaces may be made of others.
const DEEPEST: usize = 16;

/// The most pieces of one composite curve.
const MOST_PIECES: usize = 1 << 16;

/// Keywords of curves that are made of segments.
const COMPOSITES: [&str; 4] =
    ["COMPOSITE_CURVE", "COMPOSITE_CURVE_ON_SURFACE", "BOUNDARY_CURVE", "OUTER_BOUNDARY_CURVE"];

/// What kind the surface of a face is, or a surface itself: that which is trimmed, where it is a trimmed one.
pub(super) fn kind(instances: &Instances, number: u64) -> SurfaceKind {
    let mut number = number;
    for _ in 0..DEEPEST {
        let at = match instances.keyword(number) {
            "ADVANCED_FACE" | "FACE_SURFACE" => 2,
            "RECTANGULAR_TRIMMED_SURFACE" | "CURVE_BOUNDED_SURFACE" | "SURFACE_REPLICA" => 1,
            "PLANE" => return SurfaceKind::Plane,
            "CYLINDRICAL_SURFACE" => return SurfaceKind::Cylinder,
            "CONICAL_SURFACE" => return SurfaceKind::Cone,
            "SPHERICAL_SURFACE" => return SurfaceKind::Sphere,
            "TOROIDAL_SURFACE" | "DEGENERATE_TOROIDAL_SURFACE" => return SurfaceKind::Torus,
            "SURFACE_OF_REVOLUTION" => return SurfaceKind::Revolution,
            "SURFACE_OF_LINEAR_EXTRUSION" => return SurfaceKind::Extrusion,
            "OFFSET_SURFACE" => return SurfaceKind::Offset,
            _ => break,
        };
        match instances.get(number).and_then(|entity| entity.parameters().reference(at).ok()) {
            Some(basis) => number = basis,
            None => break,
        }
    }
    SurfaceKind::Spline
}

/// The geometry of a file, in the units of one representation context.
#[derive(Debug, Clone, Copy)]
pub(super) struct Geometry<'f, 'b> {
    pub instances: &'f Instances<'b>,
    /// The unit of plane angles, radians.
    pub angle: f64,
    /// The uncertainty of lengths, model units.
    pub tolerance: f64,
    /// How far anything that was made is from what the file says, at most, as measured, model units.
    pub off: &'f Cell<Off>,
    /// How many control points and edges may still be read: a few bytes may name the same large curve again and again.
    pub work: &'f Cell<usize>,
    /// How much offsets may still cost.
    pub effort: &'f Effort,
    /// Placements whose second direction makes no sense: ISO 10303-42's own is taken, as if they had none.
    pub turned: &'f RefCell<BTreeSet<u64>>,
}

impl<'b> Geometry<'_, 'b> {
    pub fn get(&self, number: u64) -> Result<Entity<'b>, Fault> {
        self.instances.get(number).ok_or_else(|| fault(number, MISSING))
    }

    /// Counts so many control points or edges.
    pub fn spend(&self, number: u64, count: usize) -> Result<(), Fault> {
        let left = self.work.get().checked_sub(count);
        self.work.set(left.unwrap_or(0));
        left.map(|_| ())
            .ok_or_else(|| fault(number, "the file names its curves and surfaces so often that no more are read"))
    }

    /// A CARTESIAN_POINT; z is 0 where it has two coordinates.
    pub fn point(&self, number: u64) -> Result<DVec3, Fault> {
        self.coordinates(number, "CARTESIAN_POINT")
    }

    /// What stands at a distance from something; how far it is off is kept.
    fn beside<T>(&self, number: u64, offset: Result<Offset<T>, OffsetError>) -> Result<T, Fault> {
        let Offset { made, off } = offset.map_err(|cause| fault(number, cause.to_string()))?;
        self.off.set(self.off.get().max(off));
        Ok(made)
    }

    fn direction(&self, number: u64) -> Result<DVec3, Fault> {
        self.coordinates(number, "DIRECTION")
    }

    fn coordinates(&self, number: u64, keyword: &str) -> Result<DVec3, Fault> {
        let entity = self.get(number)?;
        let part = entity.part(keyword).ok_or_else(|| fault(number, format!("it is no {keyword}")))?;
        let list = part.list(1)?;
        let mut point = DVec3::ZERO;
        if !(1..=3).contains(&list.len()) {
            return Err(fault(number, format!("it has {} coordinates", list.len())));
        }
        for (axis, value) in list.iter().enumerate() {
            point[axis] = value.as_number().ok_or_else(|| fault(number, "a coordinate is no number"))?;
        }
        Ok(point)
    }

    fn points(&self, numbers: &[u64]) -> Result<Vec<DVec3>, Fault> {
        if let Some(first) = numbers.first() {
            self.spend(*first, numbers.len())?;
        }
        numbers.iter().map(|number| self.point(*number)).collect()
    }

    /// A VECTOR: a direction of length 1 times a magnitude.
    fn vector(&self, number: u64) -> Result<DVec3, Fault> {
        let entity = self.get(number)?;
        let vector = entity.parameters();
        let direction = self.direction(vector.reference(1)?)?.try_normalize();
        let vector = direction.ok_or_else(|| fault(number, "it has no direction"))? * vector.number(2)?;
        if vector == DVec3::ZERO { Err(fault(number, "it has no length")) } else { Ok(vector) }
    }

    /// An AXIS2_PLACEMENT_3D, or one of two axes in the plane, or an AXIS1_PLACEMENT. A second direction that makes no sense is
    /// as if it were not there, and is kept to be told.
    fn placement(&self, number: u64) -> Result<Frame, Fault> {
        let (frame, is_turned) = self.axes(number)?;
        if is_turned {
            self.turned.borrow_mut().insert(number);
        }
        Ok(frame)
    }

    /// A placement that moves a part: all of it has to make sense.
    pub fn place(&self, number: u64) -> Result<Frame, Fault> {
        match self.axes(number)? {
            (frame, false) => Ok(frame),
            (_, true) => Err(fault(number, "its second direction has no length, or is that of its axis")),
        }
    }

    /// A placement, and whether it has a second direction that has no length, or is that of its axis.
    fn axes(&self, number: u64) -> Result<(Frame, bool), Fault> {
        let entity = self.get(number)?;
        let placement = entity.parameters();
        let origin = self.point(placement.reference(1)?)?;
        let optional = |at: usize| placement.optional_reference(at)?.map(|number| self.direction(number)).transpose();
        let (axis, reference) = match entity.keyword() {
            "AXIS2_PLACEMENT_2D" => (None, optional(2)?),
            _ => (optional(2)?, optional(3)?),
        };
        let frame = Frame::new(origin, axis, reference).ok_or_else(|| fault(number, "its axis has no direction"))?;
        Ok((frame, reference.is_some_and(|reference| frame.across(reference).is_none())))
    }

    /// A CARTESIAN_TRANSFORMATION_OPERATOR_3D, or a placement: what it moves the origin and the axes to.
    pub fn motion(&self, number: u64) -> Result<Motion, Fault> {
        let entity = self.get(number)?;
        let Some(operator) =
            entity.part("CARTESIAN_TRANSFORMATION_OPERATOR_3D").or(entity.part("CARTESIAN_TRANSFORMATION_OPERATOR"))
        else {
            let frame = self.place(number)?;
            return Ok(Motion::new([frame.x, frame.y, frame.z], frame.origin));
        };
        // Simple instances inherit a name, and complex ones spread their parameters over parts.
        let whole = if entity.parts.len() == 1 { operator.from(1) } else { operator };
        let axis = |at: usize| whole.optional_reference(at)?.map(|number| self.direction(number)).transpose();
        let third = entity.part("CARTESIAN_TRANSFORMATION_OPERATOR_3D").filter(|_| entity.parts.len() > 1);
        let third = match third {
            Some(part) => part.optional_reference(0)?.map(|number| self.direction(number)).transpose()?,
            None => axis(4)?,
        };
        let (first, second) = (axis(0)?, axis(1)?);
        let origin = self.point(whole.reference(2)?)?;
        // ISO 10303-42: an absent scale is 1.
        let scale = whole.optional_number(3)?.unwrap_or(1.0);
        let frame = Frame::new(origin, third, first).ok_or_else(|| fault(number, "its axes have no direction"))?;
        if [first, second].into_iter().flatten().any(|axis| frame.across(axis).is_none()) {
            return Err(fault(number, "an axis has no length, or is that of the third"));
        }
        let y = if second.is_some_and(|second| second.dot(frame.y) < 0.0) { -frame.y } else { frame.y };
        if !(0.0 < scale && scale.is_finite()) {
            return Err(fault(number, "its scale is not above 0"));
        }
        Ok(Motion::new([frame.x * scale, y * scale, frame.z * scale], origin))
    }

    /// A curve in space, or in the plane of a surface's parameters.
    pub fn curve(&self, number: u64) -> Result<Curve, Fault> {
        self.curve_within(number, 0)
    }

    fn curve_within(&self, number: u64, depth: usize) -> Result<Curve, Fault> {
        if DEEPEST < depth {
            return Err(fault(number, "it is made of curves too deep"));
        }
        let entity = self.get(number)?;
        let own = entity.parameters();
        let wrong = |cause: NurbsError| fault(number, cause.to_string());
        let positive = |at: usize| {
            let length = own.number(at)?;
            if 0.0 < length { Ok(length) } else { Err(fault(number, "a radius is not above 0")) }
        };
        match entity.keyword() {
            "LINE" => {
                Ok(Curve::Line { origin: self.point(own.reference(1)?)?, direction: self.vector(own.reference(2)?)? })
            }
            "CIRCLE" => {
                Ok(Curve::Ellipse { frame: self.placement(own.reference(1)?)?, radii: DVec2::splat(positive(2)?) })
            }
            "ELLIPSE" => Ok(Curve::Ellipse {
                frame: self.placement(own.reference(1)?)?,
                radii: DVec2::new(positive(2)?, positive(3)?),
            }),
            "HYPERBOLA" => Ok(Curve::Hyperbola {
                frame: self.placement(own.reference(1)?)?,
                radii: DVec2::new(positive(2)?, positive(3)?),
            }),
            "PARABOLA" => Ok(Curve::Parabola { frame: self.placement(own.reference(1)?)?, focal: positive(2)? }),
            "POLYLINE" => Curve::polyline(&self.points(&own.references(1)?)?, self.tolerance).map_err(wrong),
            "TRIMMED_CURVE" | "SURFACE_CURVE" | "SEAM_CURVE" | "INTERSECTION_CURVE" => {
                self.curve_within(own.reference(1)?, depth + 1)
            }
            "OFFSET_CURVE_3D" => {
                let curve = self.curve_within(own.reference(1)?, depth + 1)?;
                let (distance, reference) = (own.number(2)?, self.direction(own.reference(4)?)?);
                self.beside(
                    number,
                    sideways(&curve, reference, Ramp::even(distance), None, self.tolerance, self.effort),
                )
            }
            "CURVE_REPLICA" => {
                let curve = self.curve_within(own.reference(1)?, depth + 1)?;
                curve.moved(&self.motion(own.reference(2)?)?).map_err(wrong)
            }
            _ if entity.is("BOUNDED_SURFACE_CURVE") || entity.is("SURFACE_CURVE") => {
                let part = entity.part("SURFACE_CURVE").ok_or_else(|| fault(number, "it has no curve in space"))?;
                self.curve_within(part.reference(0)?, depth + 1)
            }
            _ => match spline_parameters(&entity, "CURVE") {
                Some(spline) => {
                    let degree = spline.base.count(0)?;
                    let points = self.points(&spline.base.references(1)?)?;
                    let knots = spline.knots(0, degree, points.len())?;
                    let weights = spline.weights.map(|weights| weights.numbers(0)).transpose()?;
                    let knots = KnotVector::new(degree, knots).map_err(wrong)?;
                    let spline = SpaceCurve::new(knots, &points, weights.as_deref()).map_err(wrong)?;
                    Ok(Curve::spline(spline, self.tolerance))
                }
                None => Err(fault(number, "a curve of this kind is not read")),
            },
        }
    }

    /// Whether a curve is made of segments.
    pub fn is_composite(&self, number: u64) -> bool {
        let Some(entity) = self.instances.get(number) else { return false };
        match entity.keyword() {
            "SURFACE_CURVE" | "SEAM_CURVE" | "INTERSECTION_CURVE" | "CURVE_REPLICA" => {
                let inner = entity.parameters().reference(1);
                inner.is_ok_and(|inner| COMPOSITES.contains(&self.instances.keyword(inner)))
            }
            keyword => COMPOSITES.contains(&keyword) || (1 < entity.parts.len() && entity.is("COMPOSITE_CURVE")),
        }
    }

    /// A curve that has ends, as pieces in order, each with whether it is run backwards.
    pub fn pieces(&self, number: u64) -> Result<Vec<(Piece, bool)>, Fault> {
        self.pieces_within(number, 0)
    }

    fn pieces_within(&self, number: u64, depth: usize) -> Result<Vec<(Piece, bool)>, Fault> {
        if DEEPEST < depth {
            return Err(fault(number, "it is made of curves too deep"));
        }
        let entity = self.get(number)?;
        let own = entity.parameters();
        let segments = match entity.part("COMPOSITE_CURVE") {
            Some(part) if 1 < entity.parts.len() => Some(part.references(0)?),
            _ if COMPOSITES.contains(&entity.keyword()) => Some(own.references(1)?),
            _ => None,
        };
        if let Some(segments) = segments {
            let mut pieces = vec![];
            for segment in segments {
                let segment = self.get(segment)?;
                let segment = segment.parameters();
                let mut part = self.pieces_within(segment.reference(2)?, depth + 1)?;
                if !segment.flag(1)? {
                    part.reverse();
                    part.iter_mut().for_each(|(_, reversed)| *reversed = !*reversed);
                }
                if MOST_PIECES < pieces.len() + part.len() {
                    return Err(fault(number, "it has too many pieces"));
                }
                pieces.append(&mut part);
            }
            return Ok(pieces);
        }
        match entity.keyword() {
            "TRIMMED_CURVE" => {
                let curve = self.curve_within(own.reference(1)?, depth + 1)?;
                let same = own.flag(4)?;
                let angle = if matches!(curve, Curve::Ellipse { .. }) { self.angle } else { 1.0 };
                let trim = |at: usize| {
                    let list = own.list(at)?;
                    let point = list.iter().find_map(Value::as_reference).map(|point| self.point(point)).transpose()?;
                    let value = list.iter().find_map(Value::as_number).map(|value| value * angle);
                    let point = point.or(value.map(|value| curve.point(value)));
                    point.ok_or_else(|| fault(number, format!("parameter {} trims nothing", at + 1)))
                };
                let (range, reversed) = curve.range([trim(2)?, trim(3)?], same, self.tolerance);
                Ok(vec![(Piece { curve, range }, reversed)])
            }
            "SURFACE_CURVE" | "SEAM_CURVE" | "INTERSECTION_CURVE" => self.pieces_within(own.reference(1)?, depth + 1),
            "CURVE_REPLICA" => {
                let motion = self.motion(own.reference(2)?)?;
                let moved = |(piece, reversed): (Piece, bool)| {
                    let curve = piece.curve.moved(&motion).map_err(|cause| fault(number, cause.to_string()))?;
                    Ok((Piece { curve, ..piece }, reversed))
                };
                self.pieces_within(own.reference(1)?, depth + 1)?.into_iter().map(moved).collect()
            }
            _ => {
                let curve = self.curve_within(number, depth)?;
                let range = curve.domain().or(curve.period().map(|period| [0.0, period]));
                let range = range.ok_or_else(|| fault(number, "it has no ends"))?;
                Ok(vec![(Piece { curve, range }, false)])
            }
        }
    }

    /// A surface with its own parameters.
    pub fn surface(&self, number: u64) -> Result<Shape, Fault> {
        self.surface_within(number, 0)
    }

    fn surface_within(&self, number: u64, depth: usize) -> Result<Shape, Fault> {
        if DEEPEST < depth {
            return Err(fault(number, "it is made of surfaces too deep"));
        }
        let entity = self.get(number)?;
        let own = entity.parameters();
        let wrong = |cause: NurbsError| fault(number, cause.to_string());
        let frame = || self.placement(own.reference(1)?);
        let radius = |at: usize| {
            let radius = own.number(at)?;
            if 0.0 < radius { Ok(radius) } else { Err(fault(number, "a radius is not above 0")) }
        };
        let revolved = |profile: Profile| Ok(Shape::Revolved { frame: frame()?, profile });
        match entity.keyword() {
            "PLANE" => Ok(Shape::Plane(frame()?)),
            "CYLINDRICAL_SURFACE" => revolved(Profile::Line { radius: radius(2)?, slope: 0.0 }),
            "CONICAL_SURFACE" => {
                let (radius, angle) = (own.number(2)?, own.number(3)? * self.angle);
                let is_legal = 0.0 <= radius && angle != 0.0 && angle.abs() < std::f64::consts::FRAC_PI_2;
                if is_legal {
                    revolved(Profile::Line { radius, slope: libm::tan(angle) })
                } else {
                    Err(fault(number, "it is no cone"))
                }
            }
            "SPHERICAL_SURFACE" => revolved(Profile::sphere(radius(2)?)),
            "TOROIDAL_SURFACE" => revolved(Profile::torus(radius(2)?, radius(3)?, true)),
            "DEGENERATE_TOROIDAL_SURFACE" => {
                let major = own.number(2)?;
                if major < 0.0 {
                    return Err(fault(number, "a radius is below 0"));
                }
                revolved(Profile::torus(major, radius(3)?, own.flag(4)?))
            }
            "SURFACE_OF_REVOLUTION" => {
                let profile = self.curve_within(own.reference(1)?, depth + 1)?;
                let axis = self.placement(own.reference(2)?)?;
                Ok(Shape::Revolved { frame: axis, profile: Profile::Curve(profile) })
            }
            "SURFACE_OF_LINEAR_EXTRUSION" => {
                let curve = self.curve_within(own.reference(1)?, depth + 1)?;
                Ok(Shape::Extruded { curve, vector: self.vector(own.reference(2)?)? })
            }
            "OFFSET_SURFACE" => {
                let basis = self.surface_within(own.reference(1)?, depth + 1)?;
                let shape = self.beside(number, offset(&basis, own.number(2)?, None, self.tolerance, self.effort))?;
                self.spend(number, size(&shape))?;
                Ok(shape)
            }
            "SURFACE_REPLICA" => {
                let parent = own.reference(1)?;
                if ["RECTANGULAR_TRIMMED_SURFACE", "CURVE_BOUNDED_SURFACE"].contains(&self.instances.keyword(parent)) {
                    return Err(fault(number, "the replica of a trimmed surface is not read"));
                }
                let moved = self.surface_within(parent, depth + 1)?.moved(&self.motion(own.reference(2)?)?);
                let moved = moved.map_err(wrong)?;
                moved.ok_or_else(|| fault(number, "the mirrored replica of a surface of this kind is not read"))
            }
            "RECTANGULAR_TRIMMED_SURFACE" | "CURVE_BOUNDED_SURFACE" => {
                self.surface_within(own.reference(1)?, depth + 1)
            }
            _ => match spline_parameters(&entity, "SURFACE") {
                Some(spline) => {
                    let degree = [spline.base.count(0)?, spline.base.count(1)?];
                    let rows: Vec<Vec<u64>> = spline.base.rows(2, Value::as_reference)?;
                    let counts = [rows.len(), rows.first().map_or(0, Vec::len)];
                    if rows.iter().any(|row| row.len() != counts[1]) {
                        return Err(fault(number, "its rows of control points differ in length"));
                    }
                    let points = self.points(&rows.concat())?;
                    let weights = spline.weights.map(|weights| weights.rows(0, Value::as_number)).transpose()?;
                    let knots = |axis: usize| {
                        KnotVector::new(degree[axis], spline.knots(axis, degree[axis], counts[axis])?).map_err(wrong)
                    };
                    let surface =
                        Surface::new(knots(0)?, knots(1)?, points, weights.map(|w| w.concat())).map_err(wrong)?;
                    Ok(Shape::spline(surface, self.tolerance))
                }
                None => Err(fault(number, "a surface of this kind is not read")),
            },
        }
    }
}
