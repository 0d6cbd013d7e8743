//! Point inversion: the parameters of the surface point nearest to a point in space.

use crate::{Direction, Surface};
use glam::{DVec2, DVec3};

/// Samples along each direction of a knot span, per degree: enough that one falls near each bend.
const SAMPLES_A_DEGREE: usize = 2;

/// How many of the nearest samples are followed; more than one, for a nearest sample may stand on the wrong sheet.
const SEEDS: usize = 6;

/// Steps of one search. Newton needs about six; damped steps along a valley need the rest.
const STEPS: usize = 60;

/// Samples where a derivative times the domain's length is below this share of the control box are poles.
const COLLAPSED: f64 = 1e-9;

/// What damping is multiplied by after a step that does not come nearer, and divided by after one that does.
const DAMPING_FACTOR: f64 = 8.0;

/// A surface made ready for many points.
#[derive(Debug, Clone)]
pub struct Projector<'s> {
    surface: &'s Surface,
    samples: Vec<(DVec2, DVec3)>,
}

/// The nearest point that was found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Projection {
    /// Its parameters, in the surface's domain.
    pub uv: DVec2,
    /// Its distance, model units.
    pub distance: f64,
}

impl<'s> Projector<'s> {
    /// Samples the surface: (2 p)(2 q) points a span, and the far borders, without poles.
    pub fn new(surface: &'s Surface) -> Self {
        let along = |direction: Direction| {
            let knots = surface.knots(direction);
            let count = SAMPLES_A_DEGREE * knots.degree();
            let (u, end) = (knots.knots(), knots.domain().1);
            let span = |k: usize| (0..count).map(move |i| u[k] + (u[k + 1] - u[k]) * (i as f64 / count as f64));
            knots.spans().flat_map(span).chain([end]).collect::<Vec<f64>>()
        };
        let (us, vs) = (along(Direction::U), along(Direction::V));
        let least = surface.hull().diagonal() * COLLAPSED;
        let [length_u, length_v] = [Direction::U, Direction::V].map(|d| surface.knots(d).length());
        let sample = |(&u, &v): (&f64, &f64)| {
            let d = surface.first_derivatives(u, v);
            // From a pole a search knows no direction, and all of a pole's samples are equally near.
            let moves = least < d.su.length() * length_u && least < d.sv.length() * length_v;
            moves.then(|| (DVec2::new(u, v), d.s))
        };
        let samples = us.iter().flat_map(|u| vs.iter().map(move |v| (u, v))).filter_map(sample).collect();
        Self { surface, samples }
    }

    /// How many samples a search looks through that does not begin at a place near enough.
    pub fn samples(&self) -> usize {
        self.samples.len()
    }

    /// The surface point nearest to `point`, as far as searches from `near` and from the nearest samples find it.
    ///
    /// A search from `near` that ends within `enough` (model units) is taken at once, so that points in a row stay on
    /// one sheet. Each search is [`Surface::nearest_in`] over the whole domain. No bound says that a
    /// nearer point does not exist; for a point on the surface the distance is its own proof.
    pub fn nearest(&self, point: DVec3, near: Option<DVec2>, enough: f64) -> Projection {
        let mut best = Projection { uv: DVec2::ZERO, distance: f64::INFINITY };
        if let Some(uv) = near {
            best = self.surface.nearest_in(point, self.surface.domain(), uv);
            if best.distance <= enough {
                return best;
            }
        }
        let mut seeds: Vec<(f64, DVec2)> = vec![];
        for (uv, sample) in &self.samples {
            let distance = sample.distance_squared(point);
            let place = seeds.partition_point(|(other, _)| *other <= distance);
            if place < SEEDS {
                seeds.insert(place, (distance, *uv));
                seeds.truncate(SEEDS);
            }
        }
        for (_, seed) in seeds {
            let found = self.surface.nearest_in(point, self.surface.domain(), seed);
            if found.distance < best.distance {
                best = found;
            }
        }
        best
    }
}

impl Surface {
    /// The nearest point to `point` that a search from `seed` finds over the part \[\[u0, u1\], \[v0, v1\]\] of the domain.
    ///
    /// Newton's method on the squared distance (Piegl & Tiller, Sec. 6.1), damped as Levenberg and Marquardt do where that does not
    /// come nearer; at most 60 steps. No bound says that a nearer point does not exist.
    pub fn nearest_in(&self, point: DVec3, [[u0, u1], [v0, v1]]: [[f64; 2]; 2], seed: DVec2) -> Projection {
        let (min, max) = (DVec2::new(u0, v0), DVec2::new(u1, v1));
        let mut uv = seed.clamp(min, max);
        let mut d = self.second_derivatives(uv.x, uv.y);
        let mut distance = d.s.distance(point);
        let mut damping = 0.0;
        for _ in 0..STEPS {
            let r = d.s - point;
            let gradient = DVec2::new(r.dot(d.su), r.dot(d.sv));
            // A direction that is blocked by the domain's border is left out.
            let blocked = |x: f64, low: f64, high: f64, g: f64| (x <= low && 0.0 < g) || (high <= x && g < 0.0);
            let free = [!blocked(uv.x, u0, u1, gradient.x), !blocked(uv.y, v0, v1, gradient.y)];
            let (uu, vv) = (d.su.length_squared(), d.sv.length_squared());
            let full = [uu + r.dot(d.suu), d.su.dot(d.sv) + r.dot(d.suv), vv + r.dot(d.svv)];
            let is_valley = 0.0 < full[0] && full[1] * full[1] < full[0] * full[2];
            let [a, b, c] = if is_valley { full } else { [uu, d.su.dot(d.sv), vv] };
            let (a, c) = (a + damping * uu.max(f64::MIN_POSITIVE), c + damping * vv.max(f64::MIN_POSITIVE));
            let step = match free {
                [true, true] => {
                    let determinant = a * c - b * b;
                    let newton = DVec2::new(b * gradient.y - c * gradient.x, b * gradient.x - a * gradient.y);
                    // Parallel or vanishing derivatives, as at a pole: each direction for itself.
                    if f64::EPSILON * a * c < determinant { newton / determinant } else { alone(gradient, a, c) }
                }
                [true, false] => alone(DVec2::new(gradient.x, 0.0), a, c),
                [false, true] => alone(DVec2::new(0.0, gradient.y), a, c),
                [false, false] => break,
            };
            let next = (uv + step).clamp(min, max);
            if next == uv {
                break;
            }
            let there = self.second_derivatives(next.x, next.y);
            let to_go = there.s.distance(point);
            if to_go < distance {
                (uv, d, distance) = (next, there, to_go);
                damping /= DAMPING_FACTOR;
            } else if there.s.distance(d.s) <= f64::EPSILON * (d.s.length() + point.length()) {
                break;
            } else {
                damping = (damping * DAMPING_FACTOR).max(f64::EPSILON.sqrt());
            }
        }
        Projection { uv, distance }
    }
}

/// The step of each direction alone; none where the surface does not move.
fn alone(gradient: DVec2, a: f64, c: f64) -> DVec2 {
    let one = |g: f64, h: f64| if 0.0 < h { -g / h } else { 0.0 };
    let step = DVec2::new(one(gradient.x, a), one(gradient.y, c));
    if step.is_finite() { step } else { DVec2::ZERO }
}
