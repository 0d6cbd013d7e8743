//! A ray as two planes in a body's frame, and what the body's own surface says about a root on it.
//!
//! The root finder works on extracted pieces; here its findings meet the un-extracted surface: a root is finished by
//! Newton's method on `Surface::first_derivatives_on`, a tangent is looked for by minimisation, and only a point whose
//! distance to the ray is within rounding counts.

use crate::pieces::{Body, Piece, UNIT};
use crate::roots::{Found, Search};
use glam::{DVec2, DVec3};
use nurbs::Direction;
use scene::Ray;

/// A point counts as on the ray below this many times the bound of the root finder's rounding errors.
///
/// Two pieces' ideas of their common border differ by two bounds, and a box is called a tangent below
/// `roots::INDISTINCT` (2) of them in one direction: 3 cover either with what the surface's evaluation adds.
const ON_RAY: f64 = 3.0;

/// Residuals below this share of what counts as on the ray are within the noise of evaluation: no step betters them.
const QUIET: f64 = 1.0 / 64.0;

/// Most Newton steps on the surface. It starts within 1e-12 of a piece, so two are usual.
const POLISH_MAX_STEPS: u32 = 8;

/// Most steps of a minimisation.
const MINIMISE_MAX_STEPS: u32 = 40;

/// Most steps toward a zero on an edge of a box.
const EDGE_MAX_STEPS: u32 = 60;

/// Least damping of a minimisation, as a share of the Jacobian's size squared; it grows by [`DAMPING_STEP`] after a
/// step that did not help.
const DAMPING: f64 = 1e-14;

/// See [`DAMPING`].
const DAMPING_STEP: f64 = 100.0;

/// At this damping steps are far below the parameters' resolution, and the minimisation ends.
const DAMPING_MAX: f64 = 1e12;

/// A ray in a body's frame.
pub(crate) struct Line {
    /// Orthogonal unit normals of two planes through the ray.
    normals: [DVec3; 2],
    direction: DVec3,
    /// The point of the ray nearest to the frame's origin.
    foot: DVec3,
    /// The ray's origin about the frame's origin, model units.
    origin: DVec3,
    /// Distance between the two in the frame.
    distance: f64,
    /// Distance below which a surface point counts as on the ray, in the frame.
    pub tolerance: f64,
}

/// A point of a body's surface beside a line.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Point {
    /// Parameters in the knot domain, as well as f64 holds them there.
    pub uv: DVec2,
    /// The knot span of the body's surface.
    pub span: [usize; 2],
    /// The place in the span, 0 to 1 across it.
    pub local: DVec2,
    /// Distance along the ray, model units.
    pub t: f64,
    /// Distance from the ray, in the body's frame.
    pub residual: f64,
    /// Whether it counts as on the ray.
    pub on_ray: bool,
    /// Where the surface runs along the ray to rounding: the distance at which it was last found on it.
    pub leaves: Option<f64>,
}

/// Two unit vectors across `d`, by Duff et al. 2017 (JCGT 6-1), without a branch and within a few ulp.
pub(crate) fn normals(d: DVec3) -> [DVec3; 2] {
    let sign = 1.0f64.copysign(d.z);
    let a = -1.0 / (sign + d.z);
    let b = d.x * d.y * a;
    [DVec3::new(1.0 + sign * d.x * d.x * a, sign * b, -sign * d.x), DVec3::new(b, sign + d.y * d.y * a, -d.y)]
}

impl Line {
    #[inline]
    pub fn new(ray: &Ray, normals: [DVec3; 2], body: &Body) -> Self {
        let origin = ray.origin - body.origin;
        let local = origin / body.scale;
        let foot = local - ray.direction * local.dot(ray.direction);
        let mut line =
            Self { normals, direction: ray.direction, foot, origin, distance: local.length(), tolerance: 0.0 };
        line.tolerance = ON_RAY * line.error(body.growth, body.radius);
        line
    }

    /// Bound of the error of f = n · (w x) − w (n · foot), over w, for control points in a ball of `radius` with
    /// relative errors `growth`.
    ///
    /// Three products, their sums and the difference are 6 roundings; the foot is off across the ray by at most 6
    /// roundings of the eye's distance (subtraction, division by a power of two, dot product, step back). 6 more are
    /// for the ray itself: an origin and a direction computed so as to aim at a point miss it by as much.
    #[inline(always)]
    fn error(&self, growth: f64, radius: f64) -> f64 {
        (growth + 6.0 * UNIT) * (radius + self.foot.length()) + 12.0 * UNIT * self.distance
    }

    /// Runs the root finder on a piece.
    #[inline]
    pub fn search(&self, body: &Body, piece: &Piece, control: &[[f64; 4]], search: &mut Search) {
        let foot = self.foot - body.surface.origin();
        let [n1, n2] = self.normals;
        let (s1, s2) = (n1.dot(foot), n2.dot(foot));
        let error = piece.weight * self.error(piece.growth, body.radius);
        search.search(body.surface.degree(), error, |k| {
            let [x, y, z, w] = control[k];
            DVec2::new(n1.x * x + n1.y * y + n1.z * z - s1 * w, n2.x * x + n2.y * y + n2.z * z - s2 * w)
        });
    }

    /// What the surface is at `x` (0 to 1 over the piece): the point, its distances to the planes, their derivatives.
    #[inline]
    fn look(&self, body: &Body, piece: &Piece, x: DVec2) -> Look {
        let [[u0, u1], [v0, v1]] = piece.domain;
        // Exact: pieces are halves of halves of a span.
        let local = DVec2::new(u0 + (u1 - u0) * x.x, v0 + (v1 - v0) * x.y);
        let d = body.surface.first_derivatives_local(piece.span, local);
        let [n1, n2] = self.normals;
        let planes = |v: DVec3| DVec2::new(n1.dot(v), n2.dot(v));
        let f = planes(d.s - self.foot);
        let length = |direction, span| body.surface.knots(direction).span(span).1;
        let f_u = planes(d.su) * (length(Direction::U, piece.span[0]) * (u1 - u0));
        let f_v = planes(d.sv) * (length(Direction::V, piece.span[1]) * (v1 - v0));
        let residual = f.length();
        // What rounding of the parameters (half an ulp, and twice that of the way from the piece's nearer end) moves
        // the point by, across the ray.
        let grain = |a: f64, b: f64, at: f64, f: DVec2| {
            UNIT * (at.abs() + 2.0 * (at - a).min(b - at)) / (b - a) * (f.x.abs() + f.y.abs())
        };
        let allowed = self.tolerance + 2.0 * (grain(u0, u1, local.x, f_u) + grain(v0, v1, local.y, f_v));
        let t = (d.s * body.scale - self.origin).dot(self.direction);
        let uv = body.parameters(piece.span, local);
        let point = Point { uv, span: piece.span, local, t, residual, on_ray: residual <= allowed, leaves: None };
        Look { point, f, f_u, f_v, allowed }
    }

    /// Finishes a root by Newton's method on the surface; parameters outside the piece are clamped to it.
    ///
    /// `None` where the piece's nearest point is on its border and not on the ray: the root lies in the neighbour, or
    /// beyond the surface. `Err` where a root inside cannot be confirmed.
    fn polish(&self, body: &Body, piece: &Piece, x: DVec2) -> Option<Result<Point, Point>> {
        let mut x = x.clamp(DVec2::ZERO, DVec2::ONE);
        let mut look = self.look(body, piece, x);
        for _ in 0..POLISH_MAX_STEPS {
            if look.point.residual <= QUIET * look.allowed {
                break;
            }
            let step = DVec2::new(look.f.perp_dot(look.f_v), look.f_u.perp_dot(look.f)) / look.f_u.perp_dot(look.f_v);
            let next = (x - step).clamp(DVec2::ZERO, DVec2::ONE);
            // Not a number (a singular Jacobian), or no step that parameters can show.
            if !next.is_finite() || next == x {
                break;
            }
            let better = self.look(body, piece, next);
            if better.point.residual >= look.point.residual {
                break;
            }
            (x, look) = (next, better);
        }
        if look.point.on_ray {
            return Some(Ok(look.point));
        }
        // A root beyond the border: clamped Newton steps do not slide along it to the point nearest to the ray, which
        // at a grazing angle lies elsewhere and may be on the ray.
        if x.cmpgt(DVec2::ZERO).all() && x.cmplt(DVec2::ONE).all() {
            return Some(Err(look.point));
        }
        let nearest = self.minimise(body, piece, DVec2::ZERO, DVec2::ONE, x);
        nearest.on_ray.then_some(Ok(nearest))
    }

    /// The point of a box nearest to the ray from `start` downhill: damped Gauss–Newton (Levenberg 1944) with clamping.
    fn minimise(&self, body: &Body, piece: &Piece, low: DVec2, high: DVec2, start: DVec2) -> Point {
        let mut x = start;
        let mut look = self.look(body, piece, x);
        let mut damping = DAMPING;
        for _ in 0..MINIMISE_MAX_STEPS {
            if look.point.residual <= QUIET * look.allowed || damping > DAMPING_MAX {
                break;
            }
            let (f, a, b) = (look.f, look.f_u, look.f_v);
            let extra = damping * (a.length_squared() + b.length_squared());
            let (uu, uv, vv) = (a.length_squared() + extra, a.dot(b), b.length_squared() + extra);
            let (ru, rv) = (a.dot(f), b.dot(f));
            let mut step = DVec2::new(ru * vv - rv * uv, rv * uu - ru * uv) / (uu * vv - uv * uv);
            // A parameter that would leave the box stays, and the other one alone is solved for.
            let outward = (x.cmple(low) & step.cmpgt(DVec2::ZERO)) | (x.cmpge(high) & step.cmplt(DVec2::ZERO));
            match (outward.test(0), outward.test(1)) {
                (true, false) => step = DVec2::new(0.0, rv / vv),
                (false, true) => step = DVec2::new(ru / uu, 0.0),
                _ => {}
            }
            let next = x - step;
            if !next.is_finite() {
                damping *= DAMPING_STEP;
                continue;
            }
            let next = next.clamp(low, high);
            if next == x {
                break;
            }
            let better = self.look(body, piece, next);
            if better.point.residual < look.point.residual {
                (x, look) = (next, better);
                damping = (damping / DAMPING_STEP).max(DAMPING);
            } else {
                damping *= DAMPING_STEP;
            }
        }
        look.point
    }

    /// The nearest point on the ray, from `near` on, of a box that the root finder could not take apart further; or
    /// the point with the least distance that was found.
    ///
    /// Tried are the box's middle and, for a ray that runs along the surface, the ends of its way through the box:
    /// zeros along the box's edges of the one distance that still varies.
    fn touch(
        &self,
        body: &Body,
        piece: &Piece,
        [low, high]: [DVec2; 2],
        along: Option<DVec2>,
        near: f64,
    ) -> Result<Point, Point> {
        let high = high.min(DVec2::ONE);
        let first = self.minimise(body, piece, low, high, 0.5 * (low + high));
        let seen = |point: &Point| point.on_ray && point.t >= near;
        let mut leaves = if first.on_ray { first.t } else { f64::NEG_INFINITY };
        let mut best = if seen(&first) { Ok(first) } else { Err(first) };
        let mut consider = |point: Point| {
            if point.on_ray {
                leaves = leaves.max(point.t);
            }
            best = match best {
                Ok(old) if seen(&point) && point.t < old.t => Ok(point),
                Err(_) if seen(&point) => Ok(point),
                Err(old) if !old.on_ray && point.residual < old.residual => Err(point),
                kept => kept,
            };
        };
        if let Some(along) = along {
            let corners = [low, DVec2::new(high.x, low.y), high, DVec2::new(low.x, high.y)];
            for k in 0..4 {
                if let Some(x) = self.zero_between(body, piece, [corners[k], corners[(k + 1) % 4]], along) {
                    consider(self.look(body, piece, x).point);
                }
            }
        }
        best.map(|point| Point { leaves: Some(leaves), ..point })
    }

    /// A zero of one combination of the distances between two points of the piece, by the Illinois method (Dowell &
    /// Jarratt 1971); after [`EDGE_MAX_STEPS`] the last estimate, whose own distance then decides.
    fn zero_between(&self, body: &Body, piece: &Piece, [start, end]: [DVec2; 2], along: DVec2) -> Option<DVec2> {
        let value = |s: f64| {
            let look = self.look(body, piece, start.lerp(end, s));
            (along.dot(look.f), QUIET * look.allowed)
        };
        let (mut a, mut b) = (0.0, 1.0);
        let ((mut fa, quiet), (mut fb, _)) = (value(a), value(b));
        if fa.abs() <= quiet {
            return Some(start);
        }
        if fb.abs() <= quiet {
            return Some(end);
        }
        if (fa > 0.0) == (fb > 0.0) {
            return None;
        }
        for _ in 0..EDGE_MAX_STEPS {
            let s = b - fb * (b - a) / (fb - fa);
            let (f, quiet) = value(s);
            if f.abs() <= quiet {
                return Some(start.lerp(end, s));
            }
            if (f > 0.0) == (fb > 0.0) {
                fa *= 0.5;
            } else {
                (a, fa) = (b, fb);
            }
            (b, fb) = (s, f);
        }
        Some(start.lerp(end, b))
    }

    /// Resolves a finding of the root finder: a point on the ray, or the nearest that is not.
    #[inline]
    pub fn resolve(&self, body: &Body, piece: &Piece, found: &Found, near: f64) -> Option<Result<Point, Point>> {
        match *found {
            Found::Root(x) => self.polish(body, piece, x),
            Found::Tangent { low, high, along } => Some(self.touch(body, piece, [low, high], Some(along), near)),
            Found::Unresolved { low, high, .. } => Some(self.touch(body, piece, [low, high], None, near)),
        }
    }

    /// Whether all of the surface between two parameters lies on the ray, to rounding: then two roots there are one.
    pub fn joined(&self, body: &Body, a: DVec2, b: DVec2) -> bool {
        // Not in ratios that a regular row of roots could meet.
        [0.5, 0.2861, 0.8093].into_iter().all(|s| {
            let uv = a + (b - a) * s;
            let d = body.surface.first_derivatives(uv.x, uv.y);
            let [n1, n2] = self.normals;
            let across = d.s - self.foot;
            let grain = (d.su.length() * uv.x.abs() + d.sv.length() * uv.y.abs()) * f64::EPSILON;
            DVec2::new(n1.dot(across), n2.dot(across)).length() <= self.tolerance + grain
        })
    }
}

/// What the surface is at a parameter, as a ray sees it.
struct Look {
    point: Point,
    /// Distances to the two planes.
    f: DVec2,
    /// Their derivatives across the piece in u.
    f_u: DVec2,
    /// And in v.
    f_v: DVec2,
    /// The residual up to which the point counts as on the ray.
    allowed: f64,
}
