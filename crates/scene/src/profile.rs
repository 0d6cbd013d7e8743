//! Profiles in space made into trim loops: Wildcat's way of trimming a surface.
//!
//! A profile is a closed chain of curves on, or near, the surface. Points of it are brought to the surface's parameters
//! by point inversion ([`nurbs::Projector`]); between two of them stands a cubic with the slopes that the curve's tangent
//! has in (u, v), halved until it keeps to the tolerance in space. What comes out is what a file would have
//! given: loops for [`Region`](crate::Region), which closes them across seams and along poles.

use crate::{Loop, SceneError, Trim};
use glam::{DVec2, DVec3};
use nurbs::{Direction, KnotVector, Projector, SpaceCurve, Surface};

/// Inner points of a cubic at which its distance in space is measured.
const CHECKS: usize = 7;

/// The share of the tolerance that a cubic may use at those points: what it does between them has the rest.
const SHARE: f64 = 0.5;

/// Halvings of a span before a cubic is taken as it is: its ends are then closer than any tolerance that f64 carries,
/// save where the curve passes a pole, which this brings within a millionth of the curve.
const HALVINGS: u32 = 20;

/// Below this sine S_u and S_v span no plane in which a tangent could be taken apart.
const PARALLEL: f64 = 1e-9;

/// A closed chain of curves in space.
#[derive(Debug, Clone, PartialEq)]
pub struct Profile {
    /// Whether it is the outer boundary; otherwise a hole.
    pub outer: bool,
    /// The curves, each beginning where the one before ends.
    pub curves: Vec<SpaceCurve>,
}

/// The loops in the parameters of `surface` that `profiles` are, within `tolerance` in model units.
///
/// Each point of a loop's curves is, on the surface, within the tolerance of the profile's point at the same parameter:
/// measured at seven points of each cubic, which may use half of it; no bound is proven between them.
///
/// # Errors
/// [`SceneError::ProfilePoint`] where a point of a profile is farther than the tolerance from the surface.
pub fn loops_from_profiles(surface: &Surface, profiles: &[Profile], tolerance: f64) -> Result<Vec<Loop>, SceneError> {
    let projector = Projector::new(surface);
    let mut loops = vec![];
    for (index, profile) in profiles.iter().enumerate() {
        let mut trims = vec![];
        let mut near = None;
        for (k, curve) in profile.curves.iter().enumerate() {
            let mut walk =
                Walk { surface, projector: &projector, curve, profile: index, index: k, tolerance, trims: vec![] };
            near = Some(walk.along(near)?);
            trims.append(&mut walk.trims);
        }
        loops.push(Loop { outer: profile.outer, trims });
    }
    Ok(loops)
}

/// One curve on its way to the parameters of a surface.
struct Walk<'a> {
    surface: &'a Surface,
    projector: &'a Projector<'a>,
    curve: &'a SpaceCurve,
    profile: usize,
    index: usize,
    tolerance: f64,
    trims: Vec<Trim>,
}

/// A place on the curve: its parameter, and where it lies on the surface, perhaps whole periods outside the domain.
#[derive(Clone, Copy)]
struct Place {
    t: f64,
    uv: DVec2,
}

impl Walk<'_> {
    /// Adds the trims of the whole curve, begun near `near`; returns its end.
    fn along(&mut self, near: Option<DVec2>) -> Result<DVec2, SceneError> {
        let knots = self.curve.knots();
        let breaks: Vec<f64> = knots.spans().map(|k| knots.knots()[k]).chain([knots.domain().1]).collect();
        let mut from = self.place(breaks[0], near)?;
        for &t in &breaks[1..] {
            from = self.between(from, t, HALVINGS)?;
        }
        Ok(from.uv)
    }

    /// Adds the trims from `from` to the parameter `t`, and returns the place there.
    fn between(&mut self, from: Place, t: f64, halvings: u32) -> Result<Place, SceneError> {
        let to = self.place(t, Some(from.uv))?;
        let control = self.cubic(from, to);
        if halvings == 0 || self.deviation(&control, from.t, t) <= SHARE * self.tolerance {
            let knots = KnotVector::new(3, vec![0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0]).expect("one span");
            let points = control.to_vec();
            self.trims.push(Trim::new(knots, points, None));
            return Ok(to);
        }
        let middle = self.between(from, 0.5 * (from.t + t), halvings - 1)?;
        self.between(middle, t, halvings - 1)
    }

    /// The surface point of the curve at `t`, in the period nearest to `near`.
    fn place(&self, t: f64, near: Option<DVec2>) -> Result<Place, SceneError> {
        let [point, _] = self.curve.first_derivative(t);
        let [[u0, u1], [v0, v1]] = self.surface.domain();
        let (min, size) = (DVec2::new(u0, v0), DVec2::new(u1 - u0, v1 - v0));
        let inside = near.map(|uv| uv - ((uv - min) / size).floor() * size);
        let found = self.projector.nearest(point, inside, SHARE * self.tolerance);
        if self.tolerance < found.distance {
            let (profile, curve, distance, tolerance) = (self.profile, self.index, found.distance, self.tolerance);
            return Err(SceneError::ProfilePoint { profile, curve, t, distance, tolerance });
        }
        let mut uv = found.uv;
        if let Some(near) = near {
            for axis in [0, 1] {
                if self.is_closed_at(uv, axis) {
                    uv[axis] += ((near[axis] - uv[axis]) / size[axis]).round() * size[axis];
                }
                // Along a pole the parameter is free: it stays where the curve came from.
                if self.is_pole(uv, axis) {
                    uv[axis] = near[axis];
                }
            }
        }
        Ok(Place { t, uv })
    }

    /// Whether the surface meets itself across `axis` at the other parameter of `uv`.
    fn is_closed_at(&self, uv: DVec2, axis: usize) -> bool {
        let domain = self.surface.domain()[axis];
        let [a, b] =
            domain.map(|end| if axis == 0 { self.surface.point(end, uv.y) } else { self.surface.point(uv.x, end) });
        a.distance(b) <= self.tolerance
    }

    /// Whether the parameter of `axis` moves nothing at `uv`.
    fn is_pole(&self, uv: DVec2, axis: usize) -> bool {
        let d = self.surface.first_derivatives(uv.x, uv.y);
        let direction = [Direction::U, Direction::V][axis];
        let speed = [d.su, d.sv][axis].length();
        speed * self.surface.knots(direction).length() <= SHARE * self.tolerance
    }

    /// The Bézier points of the cubic with the curve's ends and tangents.
    fn cubic(&self, from: Place, to: Place) -> [DVec2; 4] {
        let third = (to.t - from.t) / 3.0;
        let chord = (to.uv - from.uv) / 3.0;
        // Tangents inside the span: at a crease the curve leaves as this span does.
        let nudge = 1e-9 * (to.t - from.t);
        let slope = |place: Place, t: f64| {
            let [_, tangent] = self.curve.first_derivative(t);
            self.slope(place.uv, tangent).map_or(chord, |slope| slope * third)
        };
        [from.uv, from.uv + slope(from, from.t + nudge), to.uv - slope(to, to.t - nudge), to.uv]
    }

    /// (u', v') of a tangent at `uv`; `None` where S_u and S_v span no plane.
    fn slope(&self, uv: DVec2, tangent: DVec3) -> Option<DVec2> {
        let uv = self.in_domain(uv);
        let d = self.surface.first_derivatives(uv.x, uv.y);
        let (a, b, c) = (d.su.length_squared(), d.su.dot(d.sv), d.sv.length_squared());
        let determinant = a * c - b * b;
        let (f, g) = (tangent.dot(d.su), tangent.dot(d.sv));
        let slope = DVec2::new(c * f - b * g, a * g - b * f) / determinant;
        (PARALLEL * PARALLEL * a * c < determinant && slope.is_finite()).then_some(slope)
    }

    /// The greatest distance in space between a cubic and the curve, at equal parameters.
    fn deviation(&self, control: &[DVec2; 4], start: f64, end: f64) -> f64 {
        let at = |i: usize| {
            let x = i as f64 / (CHECKS + 1) as f64;
            let [a, b, c, d] = control;
            let uv =
                (*a * (1.0 - x) + *b * (3.0 * x)) * (1.0 - x) * (1.0 - x) + (*c * (3.0 * (1.0 - x)) + *d * x) * x * x;
            let uv = self.in_domain(uv);
            self.surface.point(uv.x, uv.y).distance(self.curve.first_derivative(start + (end - start) * x)[0])
        };
        (1..=CHECKS).map(at).fold(0.0, f64::max)
    }

    /// The point moved by whole periods into the domain, and held to it where the surface is open.
    fn in_domain(&self, mut uv: DVec2) -> DVec2 {
        for (axis, [low, high]) in self.surface.domain().into_iter().enumerate() {
            if !(low <= uv[axis] && uv[axis] <= high) {
                let moved = uv[axis] - ((uv[axis] - low) / (high - low)).floor() * (high - low);
                uv[axis] = if self.is_closed_at(uv, axis) { moved } else { uv[axis].clamp(low, high) };
            }
        }
        uv
    }
}
