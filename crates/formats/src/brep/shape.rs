//! Surfaces with the parameters that files give them: from (u, v) to space.

use super::curve::Curve;
use super::frame::{Frame, Motion};
use glam::{DVec2, DVec3};
use nurbs::{Direction, NurbsError, Surface};
use std::f64::consts::{FRAC_PI_2, TAU};

/// A surface; angles are radians.
#[derive(Debug, Clone)]
pub(crate) enum Shape {
    /// u along x, v along y.
    Plane(Frame),
    /// u turns about the frame's z, from x toward y; v runs along the profile.
    Revolved { frame: Frame, profile: Profile },
    /// u runs along the curve, v along the vector, 1 at its end.
    Extruded { curve: Curve, vector: DVec3 },
    /// A spline; whether its sides across u and across v are one curve.
    Spline { surface: Surface, closed: [bool; 2] },
}

/// What turns about an axis.
#[derive(Debug, Clone)]
pub(crate) enum Profile {
    /// Distance radius + slope v from the axis at height v: cylinders and cones.
    Line { radius: f64, slope: f64 },
    /// Distance major + minor cos v at height minor sin v, for v in `range`: spheres (major 0) and tori.
    Arc { major: f64, minor: f64, range: [f64; 2], is_closed: bool },
    /// A curve in space, where u = 0.
    Curve(Curve),
}

impl Profile {
    pub fn sphere(radius: f64) -> Self {
        Self::Arc { major: 0.0, minor: radius, range: [-FRAC_PI_2, FRAC_PI_2], is_closed: false }
    }

    /// A torus; where it meets its own axis, the part outside (apple) or inside (lemon).
    pub fn torus(major: f64, minor: f64, is_outside: bool) -> Self {
        if minor < major {
            return Self::Arc { major, minor, range: [0.0, TAU], is_closed: true };
        }
        let at_axis = libm::acos(-major / minor);
        let range = if is_outside { [-at_axis, at_axis] } else { [at_axis, TAU - at_axis] };
        Self::Arc { major, minor, range, is_closed: false }
    }

    /// Distance from the axis, negative across it, and height.
    pub(super) fn at(&self, v: f64) -> DVec2 {
        match self {
            Self::Line { radius, slope } => DVec2::new(radius + slope * v, v),
            Self::Arc { major, minor, .. } => DVec2::new(major + minor * libm::cos(v), minor * libm::sin(v)),
            Self::Curve(_) => unreachable!("a curve in space has no such coordinates"),
        }
    }
}

impl Shape {
    /// A spline surface, closed where two sides are within `tolerance` of each other, and of no length where they are not.
    pub fn spline(surface: Surface, tolerance: f64) -> Self {
        let [[u0, u1], [v0, v1]] = surface.domain();
        let closed = [0, 1].map(|axis: usize| {
            let mut widest: f64 = 0.0;
            let is_one = (0..=CLOSED_SAMPLES).all(|i| {
                let t = i as f64 / CLOSED_SAMPLES as f64;
                let at = |s: f64| {
                    let [a, b] = if axis == 0 { [s, t] } else { [t, s] };
                    surface.point(u0 + (u1 - u0) * a, v0 + (v1 - v0) * b)
                };
                widest = widest.max(at(0.5).distance(at(0.0)));
                at(0.0).distance(at(1.0)) <= tolerance
            });
            is_one && tolerance < widest
        });
        Self::Spline { surface, closed }
    }

    /// The surface elsewhere, with the parameters of each point but for lengths along lines and profiles; `None` where a
    /// mirrored one is no surface of these kinds.
    ///
    /// # Errors
    /// Where points of a spline are moved too far.
    pub fn moved(&self, motion: &Motion) -> Result<Option<Self>, NurbsError> {
        let factor = motion.factor();
        Ok(Some(match self {
            Self::Plane(frame) => Self::Plane(frame.moved(motion)),
            Self::Revolved { frame, profile } => {
                let profile = match profile {
                    Profile::Curve(curve) => Profile::Curve(curve.moved(motion)?),
                    // Heights count along the frame's z, which a mirror would turn.
                    _ if motion.mirrors() => return Ok(None),
                    Profile::Line { radius, slope } => Profile::Line { radius: radius * factor, slope: *slope },
                    Profile::Arc { major, minor, range, is_closed } => Profile::Arc {
                        major: major * factor,
                        minor: minor * factor,
                        range: *range,
                        is_closed: *is_closed,
                    },
                };
                Self::Revolved { frame: frame.moved(motion), profile }
            }
            Self::Extruded { curve, vector } => {
                Self::Extruded { curve: curve.moved(motion)?, vector: motion.vector(*vector) }
            }
            Self::Spline { surface, closed } => {
                let [u, v] = [Direction::U, Direction::V].map(|direction| surface.knots(direction).clone());
                let points = surface.points().iter().map(|p| motion.point(*p)).collect();
                let surface = Surface::new(u, v, points, surface.weights().map(<[f64]>::to_vec))?;
                Self::Spline { surface, closed: *closed }
            }
        }))
    }

    pub fn point(&self, uv: DVec2) -> DVec3 {
        match self {
            Self::Plane(frame) => frame.point(uv.extend(0.0)),
            Self::Revolved { frame, profile: Profile::Curve(curve) } => {
                let local = frame.local(curve.point(uv.y));
                frame.point(DVec2::from_angle(uv.x).rotate(local.truncate()).extend(local.z))
            }
            Self::Revolved { frame, profile } => {
                let at = profile.at(uv.y);
                frame.point((DVec2::from_angle(uv.x) * at.x).extend(at.y))
            }
            Self::Extruded { curve, vector } => curve.point(uv.x) + *vector * uv.y,
            Self::Spline { surface, closed } => {
                let mut uv = uv;
                for (axis, [start, end]) in surface.domain().into_iter().enumerate() {
                    if closed[axis] && !(start <= uv[axis] && uv[axis] <= end) {
                        uv[axis] = start + (uv[axis] - start).rem_euclid(end - start);
                    }
                }
                surface.point(uv.x, uv.y)
            }
        }
    }

    /// After which u, and after which v, the surface comes back to where it was.
    pub fn periods(&self) -> [Option<f64>; 2] {
        match self {
            Self::Plane(_) => [None; 2],
            Self::Revolved { profile, .. } => {
                let v = match profile {
                    Profile::Line { .. } => None,
                    Profile::Arc { is_closed, .. } => is_closed.then_some(TAU),
                    Profile::Curve(curve) => curve.period(),
                };
                [Some(TAU), v]
            }
            Self::Extruded { curve, .. } => [curve.period(), None],
            Self::Spline { surface, closed } => {
                let [[u0, u1], [v0, v1]] = surface.domain();
                [closed[0].then_some(u1 - u0), closed[1].then_some(v1 - v0)]
            }
        }
    }

    /// How far the surface reaches by itself: for each parameter the least and the greatest value, infinite where there
    /// is no end, and any whole period where it is closed.
    pub fn natural(&self) -> [[f64; 2]; 2] {
        let endless = [f64::NEG_INFINITY, f64::INFINITY];
        let along = |curve: &Curve| curve.domain().or(curve.period().map(|period| [0.0, period])).unwrap_or(endless);
        match self {
            Self::Plane(_) => [endless; 2],
            Self::Revolved { profile, .. } => {
                let v = match profile {
                    Profile::Line { .. } => endless,
                    Profile::Arc { range, .. } => *range,
                    Profile::Curve(curve) => along(curve),
                };
                [[0.0, TAU], v]
            }
            Self::Extruded { curve, .. } => [along(curve), endless],
            Self::Spline { surface, .. } => surface.domain(),
        }
    }

    /// The whole turns that bring an angle into the range in which an arc is given: files may name it a turn off.
    pub fn turns(&self, uv: DVec2) -> DVec2 {
        match self {
            Self::Revolved { profile: Profile::Arc { range, is_closed: false, .. }, .. } => {
                DVec2::new(0.0, ((0.5 * (range[0] + range[1]) - uv.y) / TAU).round() * TAU)
            }
            _ => DVec2::ZERO,
        }
    }

    /// The v at which a cone has its apex.
    pub fn apex(&self) -> Option<f64> {
        match self {
            Self::Revolved { profile: Profile::Line { radius, slope }, .. } if *slope != 0.0 => Some(-radius / slope),
            _ => None,
        }
    }
}

/// At how many places two sides of a spline are compared.
const CLOSED_SAMPLES: usize = 16;
