//! A rectangle of a surface as an exact rational spline, and the way from the surface's parameters to the spline's.

use super::arc::Arcs;
use super::curve::Curve;
use super::shape::{Profile, Shape};
use glam::{DVec2, DVec3};
use nurbs::{KnotVector, NurbsError, SpaceCurve, Surface};

/// A spline over a rectangle of a surface's own parameters.
#[derive(Debug)]
pub(crate) struct Patch {
    pub surface: Surface,
    maps: [Map; 2],
}

/// How a parameter of a surface becomes one of its spline.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Map {
    /// They are equal.
    Same,
    /// An angle.
    Angle(Arcs),
    /// The parameter of a hyperbola, over this range.
    Hyperbolic([f64; 2]),
}

impl Map {
    fn of(&self, t: f64) -> f64 {
        match self {
            Self::Same => t,
            Self::Angle(arcs) => arcs.parameter(t),
            Self::Hyperbolic([start, end]) => {
                // As for an arc, with tanh for tan.
                let (half, phi) = (0.5 * (end - start), t - 0.5 * (start + end));
                0.5 * (start + end) + half * (0.5 * phi).tanh() / (0.5 * half).tanh()
            }
        }
    }

    /// That of a curve over a range.
    fn along(curve: &Curve, range: [f64; 2]) -> Self {
        match curve {
            Curve::Ellipse { .. } => Self::Angle(Arcs::new(range)),
            Curve::Hyperbola { .. } => Self::Hyperbolic(range),
            _ => Self::Same,
        }
    }
}

impl Patch {
    /// The spline over a rectangle of `shape`'s parameters, \[\[u0, u1\], \[v0, v1\]\]; a spline is kept whole.
    ///
    /// # Errors
    /// Where the rectangle is empty, or coordinates are too large.
    pub fn new(shape: &Shape, [range_u, range_v]: [[f64; 2]; 2]) -> Result<Self, NurbsError> {
        match shape {
            Shape::Plane(frame) => {
                let corner = |u: f64, v: f64| frame.point(DVec3::new(u, v, 0.0));
                let points = range_u.iter().flat_map(|u| range_v.iter().map(|v| corner(*u, *v))).collect();
                let [u, v] = [range_u, range_v].map(|range| super::arc::bezier_knots(1, range));
                Ok(Self { surface: Surface::new(u?, v?, points, None)?, maps: [Map::Same; 2] })
            }
            Shape::Spline { surface, .. } => Ok(Self { surface: surface.clone(), maps: [Map::Same; 2] }),
            Shape::Extruded { curve, vector } => {
                let spline = whole(curve, range_u)?;
                let row = |p: DVec3| range_v.map(|v| p + *vector * v);
                let points = spline.points().flat_map(row).collect();
                let weights = spline.weights().map(|w| w.into_iter().flat_map(|w| [w; 2]).collect());
                let v = super::arc::bezier_knots(1, range_v)?;
                let surface = Surface::new(spline.knots().clone(), v, points, weights)?;
                Ok(Self { surface, maps: [Map::along(curve, range_u), Map::Same] })
            }
            Shape::Revolved { frame, profile } => {
                let half_plane = super::frame::Frame { y: frame.z, z: -frame.y, ..*frame };
                let (spline, map) = match profile {
                    Profile::Line { .. } => {
                        let ends = range_v.map(|v| shape.point(DVec2::new(0.0, v)));
                        (SpaceCurve::new(super::arc::bezier_knots(1, range_v)?, &ends, None)?, Map::Same)
                    }
                    Profile::Arc { major, minor, .. } => {
                        let origin = half_plane.point(DVec3::new(*major, 0.0, 0.0));
                        let frame = super::frame::Frame { origin, ..half_plane };
                        let arc = Curve::Ellipse { frame, radii: DVec2::splat(*minor) };
                        (whole(&arc, range_v)?, Map::along(&arc, range_v))
                    }
                    Profile::Curve(curve) => (whole(curve, range_v)?, Map::along(curve, range_v)),
                };
                // Piegl & Tiller, A8.1: each control point of the profile on an arc of its own.
                let arcs = Arcs::new(range_u);
                let own: Vec<(DVec3, f64)> = match spline.weights() {
                    Some(weights) => spline.points().zip(weights).collect(),
                    None => spline.points().map(|p| (p, 1.0)).collect(),
                };
                let mut points = Vec::with_capacity((2 * arcs.count + 1) * own.len());
                let mut weights = Vec::with_capacity(points.capacity());
                for (angle, reach) in arcs.controls() {
                    let turn = DVec2::from_angle(angle) * reach;
                    for (point, weight) in &own {
                        let local = frame.local(*point);
                        points.push(frame.point(turn.rotate(local.truncate()).extend(local.z)));
                        weights.push(weight / reach);
                    }
                }
                let u = KnotVector::new(2, arcs.knots())?;
                let surface = Surface::new(u, spline.knots().clone(), points, Some(weights))?;
                Ok(Self { surface, maps: [Map::Angle(arcs), map] })
            }
        }
    }

    /// The spline's parameters at the surface's.
    pub fn parameters(&self, uv: DVec2) -> DVec2 {
        DVec2::new(self.maps[0].of(uv.x), self.maps[1].of(uv.y))
    }

    /// Whether the spline has the surface's own parameters.
    pub fn is_same(&self) -> bool {
        self.maps == [Map::Same; 2]
    }
}

/// A part of a curve as one spline: of a closed one that begins anywhere, too.
fn whole(curve: &Curve, range: [f64; 2]) -> Result<SpaceCurve, NurbsError> {
    let mut splines = curve.splines(range)?;
    if splines.len() == 1 {
        return Ok(splines.remove(0));
    }
    // Both parts are clamped: the second one's knots follow the first one's, and the point between them is one.
    let (first, second) = (&splines[0], &splines[1]);
    let p = first.knots().degree();
    let joint = first.knots().domain().1;
    let shift = joint - second.knots().domain().0;
    let (a, b) = (first.knots().knots(), second.knots().knots());
    let knots = a[..a.len() - 1].iter().copied().chain(b[p + 1..].iter().map(|k| k + shift)).collect();
    let points: Vec<DVec3> = first.points().chain(second.points().skip(1)).collect();
    let weights = first.weights().zip(second.weights()).map(|(a, b)| [&a[..], &b[1..]].concat());
    SpaceCurve::new(KnotVector::new(p, knots)?, &points, weights.as_deref())
}
