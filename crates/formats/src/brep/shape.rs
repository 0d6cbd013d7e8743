//! Surfaces with the parameters that files give them: from (u, v) to space, and back.

use super::curve::Curve;
use super::frame::Frame;
use glam::{DVec2, DVec3};
use nurbs::{Projector, Surface};
use std::cell::Cell;
use std::f64::consts::{FRAC_PI_2, TAU};

/// Steps of a search for the parameters of a point.
const STEPS: usize = 30;

/// Samples of a profile's or a directrix's span from which a point is looked for.
const SAMPLES: usize = 8;

/// A share of a surface's size: nearer than this to an axis or to a collapsed side, a point has no angle.
const POLE: f64 = 1e-9;

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
        let at_axis = (-major / minor).acos();
        let range = if is_outside { [-at_axis, at_axis] } else { [at_axis, TAU - at_axis] };
        Self::Arc { major, minor, range, is_closed: false }
    }

    /// Distance from the axis, negative across it, and height.
    fn at(&self, v: f64) -> DVec2 {
        match self {
            Self::Line { radius, slope } => DVec2::new(radius + slope * v, v),
            Self::Arc { major, minor, .. } => DVec2::new(major + minor * v.cos(), minor * v.sin()),
            Self::Curve(_) => unreachable!("a curve in space has no such coordinates"),
        }
    }
}

/// Parameters of a point.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Inverse {
    pub uv: DVec2,
    /// The parameter (0 = u, 1 = v) that says nothing here: all its values are this point.
    pub free: Option<usize>,
}

/// A surface made ready for many points.
pub(crate) struct Inverter<'s> {
    shape: &'s Shape,
    projector: Option<Projector<'s>>,
    /// Parameters of the curve of a swept surface, where searches begin.
    seeds: Vec<f64>,
    /// Lengths below it are nothing, model units.
    nothing: f64,
    /// How many samples of a spline may still be looked through, in all searches of a face.
    looks: Cell<usize>,
}

/// The most samples of a spline that are looked through for one face: a second's work.
const MOST_LOOKS: usize = 1 << 27;

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

    /// The surface at a distance along S_u × S_v, with the same parameters; `None` where that is no surface of these kinds.
    pub fn offset(&self, distance: f64) -> Option<Self> {
        match self {
            Self::Plane(frame) => Some(Self::Plane(Frame { origin: frame.origin + frame.z * distance, ..*frame })),
            Self::Revolved { frame, profile: Profile::Line { radius, slope } } => {
                // The normal is across the line, outward: (cos φ, −sin φ) for slope tan φ.
                let [sin, cos] = [slope / slope.hypot(1.0), slope.hypot(1.0).recip()];
                let frame = Frame { origin: frame.origin - frame.z * (distance * sin), ..*frame };
                let radius = radius + distance * cos;
                let profile = Profile::Line { radius, slope: *slope };
                (0.0 < radius || *slope != 0.0).then_some(Self::Revolved { frame, profile })
            }
            Self::Revolved { frame, profile: Profile::Arc { major, minor, is_closed, .. } }
                if *is_closed || *major == 0.0 =>
            {
                let minor = minor + distance;
                let profile = if *is_closed { Profile::torus(*major, minor, true) } else { Profile::sphere(minor) };
                (0.0 < minor && (minor < *major || !is_closed)).then_some(Self::Revolved { frame: *frame, profile })
            }
            _ => None,
        }
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

impl<'s> Inverter<'s> {
    /// `size` is how large the face is, model units.
    pub fn new(shape: &'s Shape, size: f64) -> Self {
        let projector = match shape {
            Shape::Spline { surface, .. } => Some(Projector::new(surface)),
            _ => None,
        };
        let curve = match shape {
            Shape::Extruded { curve, .. } | Shape::Revolved { profile: Profile::Curve(curve), .. } => Some(curve),
            _ => None,
        };
        let seeds = curve.map_or(vec![], |curve| {
            let range = curve.domain().or(curve.period().map(|period| [0.0, period])).unwrap_or([-size, size]);
            let ends: Vec<f64> = [range[0]].into_iter().chain(curve.breaks(range)).chain([range[1]]).collect();
            let between = |pair: &[f64]| {
                let (a, b) = (pair[0], pair[1]);
                (0..SAMPLES).map(move |i| a + (b - a) * (i as f64 / SAMPLES as f64))
            };
            ends.windows(2).flat_map(between).chain([range[1]]).collect()
        });
        Self { shape, projector, seeds, nothing: POLE * size, looks: Cell::new(MOST_LOOKS) }
    }

    /// The parameters of the point of the surface nearest to `point`, or of one beside it where that is not on the
    /// surface; in closed directions the value nearest to that of `near`.
    ///
    /// A search that starts at `near` and comes within `enough` of the point, model units, is taken at once.
    pub fn parameters(&self, point: DVec3, near: Option<DVec2>, enough: f64) -> Inverse {
        let mut inverse = self.any_parameters(point, near, enough);
        let Some(near) = near else { return inverse };
        for (axis, period) in self.shape.periods().into_iter().enumerate() {
            if let Some(period) = period {
                inverse.uv[axis] += ((near[axis] - inverse.uv[axis]) / period).round() * period;
            }
        }
        inverse
    }

    fn any_parameters(&self, point: DVec3, near: Option<DVec2>, enough: f64) -> Inverse {
        match self.shape {
            Shape::Plane(frame) => Inverse { uv: frame.local(point).truncate(), free: None },
            Shape::Revolved { frame, profile } => {
                let local = frame.local(point);
                let (across, distance) = (local.truncate(), local.truncate().length());
                let free = (distance <= self.nothing).then_some(0);
                let angle = across.y.atan2(across.x);
                let opposite = angle + std::f64::consts::PI;
                match profile {
                    Profile::Line { radius, slope } => {
                        // Of both sides of the axis the one on which the line is nearer.
                        let at = |side: f64| {
                            let v = ((side - radius) * slope + local.z) / (1.0 + slope * slope);
                            (v, (DVec2::new(side, local.z) - profile.at(v)).length())
                        };
                        let ([v, near_side], [other, far_side]) = (at(distance).into(), at(-distance).into());
                        let is_across = far_side < near_side;
                        let uv = if is_across { DVec2::new(opposite, other) } else { DVec2::new(angle, v) };
                        Inverse { uv, free }
                    }
                    Profile::Arc { major, range, is_closed, .. } => {
                        let side = |distance: f64| {
                            let v = local.z.atan2(distance - major);
                            let turns =
                                if *is_closed { 0.0 } else { ((0.5 * (range[0] + range[1]) - v) / TAU).round() };
                            let v = v + turns * TAU;
                            let v = if *is_closed { v } else { v.clamp(range[0], range[1]) };
                            (v, (DVec2::new(distance, local.z) - profile.at(v)).length())
                        };
                        let ([v, near_side], [other, far_side]) = (side(distance).into(), side(-distance).into());
                        let is_across = far_side < near_side && free.is_none();
                        let uv = if is_across { DVec2::new(opposite, other) } else { DVec2::new(angle, v) };
                        Inverse { uv, free }
                    }
                    Profile::Curve(curve) => {
                        let flat = |t: f64| {
                            let local = frame.local(curve.point(t));
                            DVec2::new(local.truncate().length(), local.z)
                        };
                        let v = self.along(flat, DVec2::new(distance, local.z), near.map(|near| near.y));
                        let own = frame.local(curve.point(v)).truncate();
                        Inverse { uv: DVec2::new(angle - own.y.atan2(own.x), v), free }
                    }
                }
            }
            Shape::Extruded { curve, vector } => {
                let along = *vector / vector.length_squared();
                let across = vector.normalize().any_orthonormal_pair();
                let flat = |point: DVec3| DVec2::new(point.dot(across.0), point.dot(across.1));
                let u = match curve {
                    Curve::Line { .. } => {
                        let (origin, direction) =
                            (flat(curve.point(0.0)), flat(curve.point(1.0)) - flat(curve.point(0.0)));
                        (flat(point) - origin).dot(direction) / direction.length_squared()
                    }
                    _ => self.along(|t| flat(curve.point(t)), flat(point), near.map(|near| near.x)),
                };
                Inverse { uv: DVec2::new(u, (point - curve.point(u)).dot(along)), free: None }
            }
            Shape::Spline { surface, .. } => {
                let projector = self.projector.as_ref().expect("made for a spline");
                let near = near.map(|near| self.wrapped(near));
                let found = if self.looks.get() == 0 {
                    // One search from where the last one ended, or from anywhere: what it misses is said to be off the surface.
                    let [[u0, u1], [v0, v1]] = surface.domain();
                    let middle = DVec2::new(0.5 * (u0 + u1), 0.5 * (v0 + v1));
                    projector.nearest(point, near.or(Some(middle)), f64::INFINITY)
                } else {
                    projector.nearest(point, near, enough)
                };
                if near.is_none() || enough < found.distance {
                    self.looks.set(self.looks.get().saturating_sub(projector.samples()));
                }
                let d = surface.first_derivatives(found.uv.x, found.uv.y);
                let [[u0, u1], [v0, v1]] = surface.domain();
                let collapsed = [d.su.length() * (u1 - u0), d.sv.length() * (v1 - v0)].map(|l| l <= self.nothing);
                let free = [0, 1].into_iter().find(|axis: &usize| collapsed[*axis] && !collapsed[1 - *axis]);
                Inverse { uv: found.uv, free }
            }
        }
    }

    /// Parameters moved by whole periods into the domain of a spline.
    fn wrapped(&self, mut uv: DVec2) -> DVec2 {
        let natural = self.shape.natural();
        for (axis, period) in self.shape.periods().into_iter().enumerate() {
            let [start, end] = natural[axis];
            if let Some(period) = period.filter(|_| !(start <= uv[axis] && uv[axis] <= end)) {
                uv[axis] = start + (uv[axis] - start).rem_euclid(period);
            }
        }
        uv
    }

    /// The parameter at which a plane curve is nearest to a point: Newton's method with differences for derivatives, from
    /// `near` and from the nearest samples.
    fn along(&self, curve: impl Fn(f64) -> DVec2, point: DVec2, near: Option<f64>) -> f64 {
        let distance = |t: f64| curve(t).distance_squared(point);
        let nearest = self.seeds.iter().copied().min_by(|a, b| distance(*a).total_cmp(&distance(*b)));
        let step = self.seeds.windows(2).map(|pair| pair[1] - pair[0]).fold(f64::INFINITY, f64::min);
        let h = 1e-5 * step;
        let mut best = (f64::INFINITY, 0.0);
        for seed in near.into_iter().chain(nearest) {
            let (mut t, mut d) = (seed, distance(seed));
            for _ in 0..STEPS {
                let tangent = (curve(t + h) - curve(t - h)) / (2.0 * h);
                let next = t + (point - curve(t)).dot(tangent) / tangent.length_squared();
                let there = distance(next);
                let is_nearer = there < d;
                if !is_nearer {
                    break;
                }
                (t, d) = (next, there);
            }
            if d < best.0 {
                best = (d, t);
            }
            if d <= self.nothing * self.nothing {
                break;
            }
        }
        best.1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shapes() -> Vec<Shape> {
        let frame = Frame::new(DVec3::new(1.0, 2.0, 3.0), Some(DVec3::new(1.0, 1.0, 2.0)), Some(DVec3::Y)).unwrap();
        let revolved = |profile| Shape::Revolved { frame, profile };
        let curve = Curve::Ellipse { frame: Frame { origin: DVec3::ZERO, ..frame }, radii: DVec2::new(2.0, 1.0) };
        vec![
            Shape::Plane(frame),
            revolved(Profile::Line { radius: 2.0, slope: 0.0 }),
            revolved(Profile::Line { radius: 2.0, slope: -0.5 }),
            revolved(Profile::sphere(2.0)),
            revolved(Profile::torus(3.0, 1.0, true)),
            revolved(Profile::torus(1.0, 2.0, true)),
            revolved(Profile::torus(1.0, 2.0, false)),
            revolved(Profile::Curve(Curve::Line {
                origin: DVec3::new(5.0, 2.0, 3.0),
                direction: DVec3::new(0.2, 0.3, 1.0),
            })),
            Shape::Extruded { curve, vector: DVec3::new(1.0, 0.0, 3.0) },
        ]
    }

    #[test]
    fn parameters_of_a_point_are_found_again() {
        for shape in shapes() {
            let inverter = Inverter::new(&shape, 5.0);
            let [_, [v0, v1]] = shape.natural();
            let (v0, v1) = (v0.max(-1.0), v1.min(2.0 + v0.max(-1.0)));
            for k in 0..100 {
                let uv = DVec2::new(0.1 + 0.061 * f64::from(k), v0 + (v1 - v0) * (0.05 + 0.009 * f64::from(k)));
                let near = uv + DVec2::new(0.3, -0.1);
                let found = inverter.parameters(shape.point(uv), Some(near), 1e-12).uv;
                assert!(found.distance(uv) < 1e-8, "{shape:?}: {found} for {uv}");
                assert!(shape.point(found).distance(shape.point(uv)) < 1e-12, "{shape:?}: {found} for {uv}");
            }
        }
    }

    #[test]
    fn an_offset_is_that_far_along_the_normal() {
        for shape in &shapes()[..5] {
            let offset = shape.offset(0.25).unwrap();
            for k in 0..50 {
                let uv = DVec2::new(0.1 + 0.1 * f64::from(k), -0.9 + 0.03 * f64::from(k));
                let d = |du: f64, dv: f64| shape.point(uv + DVec2::new(du, dv));
                const H: f64 = 1e-5;
                let normal = (d(H, 0.0) - d(-H, 0.0)).cross(d(0.0, H) - d(0.0, -H)).normalize();
                let expected = shape.point(uv) + 0.25 * normal;
                assert!(offset.point(uv).distance(expected) < 1e-9, "{shape:?} {uv}");
            }
        }
    }
}
