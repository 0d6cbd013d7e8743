//! From space back to the parameters of a surface.

use super::curve::Curve;
use super::shape::{Profile, Shape};
use glam::{DVec2, DVec3};
use nurbs::Projector;
use std::cell::Cell;
use std::f64::consts::{PI, TAU};

/// Steps of a search for the parameters of a point.
const STEPS: usize = 30;

/// Samples of a profile's or a directrix's span from which a point is looked for.
const SAMPLES: usize = 8;

/// A share of a surface's size: nearer than this to an axis or to a collapsed side, a point has no angle.
const POLE: f64 = 1e-9;

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
                let angle = libm::atan2(across.y, across.x);
                let opposite = angle + PI;
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
                            let v = libm::atan2(local.z, distance - major);
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
                        Inverse { uv: DVec2::new(angle - libm::atan2(own.y, own.x), v), free }
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
    use crate::brep::frame::Frame;

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
}
