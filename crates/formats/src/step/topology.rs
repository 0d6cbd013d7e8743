//! Faces, loops and edges of ISO 10303-42, as the boundary representation takes them.

use super::fault::{Fault, fault};
use super::geometry::Geometry;
use crate::brep::curve::Curve;
use crate::brep::path::{Piece, Use};
use crate::brep::shape::{Profile, Shape};
use crate::brep::source::{Bound, Source};
use glam::DVec3;
use nurbs::SpaceCurve;

/// What an edge takes beside its control points, as so many of these.
const EDGE: usize = 16;

/// A face of the file, ready to be made.
///
/// # Errors
/// With the instance that is at fault: the face itself, or one that it is made of.
pub(super) fn face(geometry: &Geometry, number: u64) -> Result<Source, Fault> {
    let entity = geometry.get(number)?;
    let own = entity.parameters();
    let (surface, same_sense) = (own.reference(2)?, own.flag(3)?);
    let shape = geometry.surface(surface)?;
    let mut bounds = vec![];
    for bound in own.references(1)? {
        let entity = geometry.get(bound)?;
        let own = entity.parameters();
        let mut uses = edge_loop(geometry, own.reference(1)?, surface, &shape)?;
        if !own.flag(2)? {
            uses.reverse();
            uses.iter_mut().for_each(|u| u.reversed = !u.reversed);
        }
        bounds.push(Bound { outer: entity.keyword() == "FACE_OUTER_BOUND", uses });
    }
    Ok(Source { shape, same_sense, bounds, tolerance: geometry.tolerance, off: geometry.off.get() })
}

/// A surface that stands by itself: whole, over the rectangle that trims it, or within curves.
pub(super) fn surface(geometry: &Geometry, number: u64) -> Result<Source, Fault> {
    let entity = geometry.get(number)?;
    let own = entity.parameters();
    let shape = geometry.surface(number)?;
    match entity.keyword() {
        "RECTANGULAR_TRIMMED_SURFACE" => {}
        "CURVE_BOUNDED_SURFACE" => {
            let bounds =
                own.references(2)?.into_iter().map(|curve| boundary(geometry, curve)).collect::<Result<_, _>>()?;
            return Ok(Source {
                shape,
                same_sense: true,
                bounds,
                tolerance: geometry.tolerance,
                off: geometry.off.get(),
            });
        }
        _ => {
            return Ok(Source {
                shape,
                same_sense: true,
                bounds: vec![],
                tolerance: geometry.tolerance,
                off: geometry.off.get(),
            });
        }
    }
    let scale = scale(&shape, geometry.angle);
    let (senses, periods) = ([own.flag(6)?, own.flag(7)?], cyclic(&shape));
    let side = |axis: usize| -> Result<[f64; 2], Fault> {
        let ends = [own.number(2 + 2 * axis)? * scale[axis], own.number(3 + 2 * axis)? * scale[axis]];
        run(ends, senses[axis], periods[axis]).ok_or_else(|| fault(number, "it is trimmed to nothing"))
    };
    let (u, v) = (side(0)?, side(1)?);
    let corner = |k: usize| DVec3::new(u[usize::from(k % 4 == 1 || k % 4 == 2)], v[usize::from(k % 4 >= 2)], 0.0);
    let side = |k: usize| {
        let (a, b) = (corner(k), corner(k + 1));
        let plane = Piece { curve: Curve::Line { origin: a, direction: b - a }, range: [0.0, 1.0] };
        Use { space: None, plane: Some(plane), reversed: false, edge: None, vertices: [0.0; 2] }
    };
    let bounds = vec![Bound { outer: true, uses: (0..4).map(side).collect() }];
    // A parameter that opposes the surface's own turns the normal.
    Ok(Source {
        shape,
        same_sense: senses[0] == senses[1],
        bounds,
        tolerance: geometry.tolerance,
        off: geometry.off.get(),
    })
}

/// The periods of a surface's parameters where ISO 10303-42 lets a rectangle run on across a seam: a turn about an axis, and
/// around a torus.
fn cyclic(shape: &Shape) -> [Option<f64>; 2] {
    match shape {
        Shape::Revolved { profile: Profile::Arc { .. }, .. } => shape.periods(),
        Shape::Revolved { .. } => [shape.periods()[0], None],
        _ => [None; 2],
    }
}

/// The range, ascending, from the first of two parameters to the second, in the sense of the surface or against it; `None` where
/// they are one. Where the parameter is cyclic, it may run across the seam.
fn run([from, to]: [f64; 2], with: bool, period: Option<f64>) -> Option<[f64; 2]> {
    let [from, to] = if with || period.is_none() { [from, to] } else { [to, from] };
    match period {
        _ if from == to => None,
        Some(period) if to < from => Some([from, to + ((from - to) / period).ceil() * period]),
        Some(_) => Some([from, to]),
        None => Some([from.min(to), from.max(to)]),
    }
}

/// A curve that bounds a surface.
fn boundary(geometry: &Geometry, number: u64) -> Result<Bound, Fault> {
    let pieces = geometry.pieces(number)?;
    let side = |(space, reversed): (Piece, bool)| Use {
        space: Some(space),
        plane: None,
        reversed,
        edge: None,
        vertices: [0.0; 2],
    };
    let outer = geometry.get(number)?.is("OUTER_BOUNDARY_CURVE");
    Ok(Bound { outer, uses: pieces.into_iter().map(side).collect() })
}

fn edge_loop(geometry: &Geometry, number: u64, surface: u64, shape: &Shape) -> Result<Vec<Use>, Fault> {
    let entity = geometry.get(number)?;
    let own = entity.parameters();
    match entity.keyword() {
        "VERTEX_LOOP" => Ok(vec![]),
        "POLY_LOOP" => {
            let points = own.references(1)?;
            geometry.spend(number, EDGE * points.len())?;
            let points = points.into_iter().map(|p| geometry.point(p)).collect::<Result<Vec<_>, _>>()?;
            let side = |k: usize| {
                let (a, b) = (points[k], points[(k + 1) % points.len()]);
                let space = Piece { curve: Curve::Line { origin: a, direction: b - a }, range: [0.0, 1.0] };
                (a != b).then_some(Use {
                    space: Some(space),
                    plane: None,
                    reversed: false,
                    edge: None,
                    vertices: [0.0; 2],
                })
            };
            Ok((0..points.len()).filter_map(side).collect())
        }
        "EDGE_LOOP" => {
            let edges = own.references(1)?.into_iter().map(|edge| oriented_edge(geometry, edge, surface, shape));
            Ok(edges.collect::<Result<Vec<_>, _>>()?.concat())
        }
        _ => Err(fault(number, "a loop of this kind is not read")),
    }
}

/// An edge as a loop uses it: one use, or for a composite curve one for each of its pieces.
fn oriented_edge(geometry: &Geometry, number: u64, surface: u64, shape: &Shape) -> Result<Vec<Use>, Fault> {
    geometry.spend(number, EDGE)?;
    let oriented = geometry.get(number)?;
    let (edge_number, runs_with) = match oriented.keyword() {
        "EDGE_CURVE" => (number, true),
        _ => (oriented.parameters().reference(3)?, oriented.parameters().flag(4)?),
    };
    let edge = geometry.get(edge_number)?;
    let edge = edge.part("EDGE_CURVE").ok_or_else(|| fault(edge_number, "it is no EDGE_CURVE"))?;
    let vertex = |at: usize| {
        let entity = geometry.get(edge.reference(at)?)?;
        geometry.point(entity.parameters().reference(1)?)
    };
    let ends = [vertex(1)?, vertex(2)?];
    let curve_number = edge.reference(3)?;
    let edge_id = i64::try_from(edge_number).ok();
    if geometry.is_composite(curve_number) {
        let with = edge.flag(4)? == runs_with;
        let piece = |(space, reversed): (Piece, bool)| Use {
            space: Some(space),
            plane: None,
            reversed: reversed == with,
            edge: edge_id,
            vertices: [0.0; 2],
        };
        let mut uses: Vec<Use> = geometry.pieces(curve_number)?.into_iter().map(piece).collect();
        if !with {
            uses.reverse();
        }
        return Ok(uses);
    }
    let curve = geometry.curve(curve_number)?;
    let (range, runs_against) = curve.range(ends, edge.flag(4)?, geometry.tolerance);
    let plane = pcurve(geometry, curve_number, surface, shape).map(|curve| Piece { curve, range });
    let space = Piece { curve, range };
    if !(range[0] < range[1] && range[0].is_finite() && range[1].is_finite()) {
        return Err(fault(edge_number, "its vertices bound no part of its curve"));
    }
    let [from, to] = if runs_against { [ends[1], ends[0]] } else { ends };
    let vertices = [space.point(0.0).distance(from), space.point(1.0).distance(to)];
    Ok(vec![Use { space: Some(space), plane, reversed: runs_against == runs_with, edge: edge_id, vertices }])
}

/// The curve in a surface's parameters that an edge's curve names; the first one of a seam, which is a period from the
/// other. What cannot be read of it is no loss: the edge in space says the same.
fn pcurve(geometry: &Geometry, curve: u64, surface: u64, shape: &Shape) -> Option<Curve> {
    let entity = geometry.get(curve).ok()?;
    let associated =
        match entity.part("SURFACE_CURVE").or(entity.part("SEAM_CURVE")).or(entity.part("INTERSECTION_CURVE")) {
            Some(part) if entity.parts.len() == 1 => part.references(2),
            Some(part) => part.references(1),
            None => return None,
        };
    let on_surface = |number: u64| {
        let entity = geometry.get(number).ok()?;
        let part = entity.part("PCURVE")?;
        let own = if entity.parts.len() == 1 { part.from(1) } else { part };
        if own.reference(0).ok()? != surface {
            return None;
        }
        let definition = geometry.get(own.reference(1).ok()?).ok()?;
        let curve = *definition.parameters().references(1).ok()?.first()?;
        scaled(geometry.curve(curve).ok()?, scale(shape, geometry.angle))
    };
    associated.ok()?.into_iter().find_map(on_surface)
}

/// What the file's parameters of a surface are multiplied by: its angles are radians here.
fn scale(shape: &Shape, angle: f64) -> glam::DVec2 {
    let is_angle = match shape {
        Shape::Revolved { profile: Profile::Arc { .. } | Profile::Curve(Curve::Ellipse { .. }), .. } => [true, true],
        Shape::Revolved { .. } => [true, false],
        Shape::Extruded { curve: Curve::Ellipse { .. }, .. } => [true, false],
        _ => [false; 2],
    };
    let factor = |is_angle: bool| if is_angle { angle } else { 1.0 };
    glam::DVec2::new(factor(is_angle[0]), factor(is_angle[1]))
}

/// A curve with its coordinates multiplied; `None` for a conic, which would be another one.
fn scaled(curve: Curve, by: glam::DVec2) -> Option<Curve> {
    if by == glam::DVec2::ONE {
        return Some(curve);
    }
    let by = by.extend(1.0);
    match curve {
        Curve::Line { origin, direction } => Some(Curve::Line { origin: origin * by, direction: direction * by }),
        Curve::Spline { spline, is_closed } => {
            let points: Vec<DVec3> = spline.points().map(|p| p * by).collect();
            let spline = SpaceCurve::new(spline.knots().clone(), &points, spline.weights().as_deref()).ok()?;
            Some(Curve::Spline { spline, is_closed })
        }
        _ => None,
    }
}
