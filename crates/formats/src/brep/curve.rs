//! Curves with the parameters that files give them: lines, conics and splines, in space or, with z = 0, in (u, v).

use super::arc::{Arcs, bezier_knots};
use super::frame::{Frame, Motion};
use glam::{DVec2, DVec3};
use nurbs::{KnotVector, NurbsError, SpaceCurve};
use std::f64::consts::TAU;

/// Samples of a span when a point's parameter is looked for, per degree.
const SAMPLES_A_DEGREE: usize = 4;

/// The nearest samples from which it is looked for.
const SEEDS: usize = 3;

/// Steps of one search.
const STEPS: usize = 30;

/// A curve; angles are radians.
#[derive(Debug, Clone)]
pub(crate) enum Curve {
    /// origin + t direction.
    Line { origin: DVec3, direction: DVec3 },
    /// x = a cos t, y = b sin t.
    Ellipse { frame: Frame, radii: DVec2 },
    /// x = f t², y = 2 f t.
    Parabola { frame: Frame, focal: f64 },
    /// x = a cosh t, y = b sinh t.
    Hyperbola { frame: Frame, radii: DVec2 },
    /// A spline; whether it ends where it begins.
    Spline { spline: SpaceCurve, is_closed: bool },
}

impl Curve {
    /// A spline, closed where its ends are within `tolerance`.
    pub fn spline(spline: SpaceCurve, tolerance: f64) -> Self {
        let (start, end) = spline.knots().domain();
        let ends = [start, end].map(|t| spline.first_derivative(t)[0]);
        let is_closed = ends[0].distance(ends[1]) <= tolerance;
        Self::Spline { spline, is_closed }
    }

    /// Straight pieces from point to point, at t = 0, 1, 2 …
    pub fn polyline(points: &[DVec3], tolerance: f64) -> Result<Self, NurbsError> {
        let last = points.len().saturating_sub(1);
        let knots = std::iter::once(0).chain(0..=last).chain(std::iter::once(last)).map(|k| k as f64).collect();
        Ok(Self::spline(SpaceCurve::new(KnotVector::new(1, knots)?, points, None)?, tolerance))
    }

    /// The curve elsewhere, with the same parameters.
    ///
    /// # Errors
    /// Where points of a spline are moved too far.
    pub fn moved(&self, motion: &Motion) -> Result<Self, NurbsError> {
        let factor = motion.factor();
        Ok(match self {
            Self::Line { origin, direction } => {
                Self::Line { origin: motion.point(*origin), direction: motion.vector(*direction) }
            }
            Self::Ellipse { frame, radii } => Self::Ellipse { frame: frame.moved(motion), radii: *radii * factor },
            Self::Parabola { frame, focal } => Self::Parabola { frame: frame.moved(motion), focal: focal * factor },
            Self::Hyperbola { frame, radii } => Self::Hyperbola { frame: frame.moved(motion), radii: *radii * factor },
            Self::Spline { spline, is_closed } => {
                let points: Vec<DVec3> = spline.points().map(|p| motion.point(p)).collect();
                let spline = SpaceCurve::new(spline.knots().clone(), &points, spline.weights().as_deref())?;
                Self::Spline { spline, is_closed: *is_closed }
            }
        })
    }

    pub fn point(&self, t: f64) -> DVec3 {
        match self {
            Self::Line { origin, direction } => *origin + *direction * t,
            Self::Ellipse { frame, radii } => {
                frame.point(DVec3::new(radii.x * libm::cos(t), radii.y * libm::sin(t), 0.0))
            }
            Self::Parabola { frame, focal } => frame.point(DVec3::new(focal * t * t, 2.0 * focal * t, 0.0)),
            Self::Hyperbola { frame, radii } => frame.point(DVec3::new(radii.x * t.cosh(), radii.y * t.sinh(), 0.0)),
            Self::Spline { spline, is_closed } => {
                let (start, end) = spline.knots().domain();
                let is_beyond = *is_closed && !(start <= t && t <= end);
                spline.first_derivative(if is_beyond { start + (t - start).rem_euclid(end - start) } else { t })[0]
            }
        }
    }

    /// Its derivative by the parameter.
    pub fn tangent(&self, t: f64) -> DVec3 {
        let turned = |frame: &Frame, x: f64, y: f64| frame.x * x + frame.y * y;
        match self {
            Self::Line { direction, .. } => *direction,
            Self::Ellipse { frame, radii } => turned(frame, -radii.x * libm::sin(t), radii.y * libm::cos(t)),
            Self::Parabola { frame, focal } => turned(frame, 2.0 * focal * t, 2.0 * focal),
            Self::Hyperbola { frame, radii } => turned(frame, radii.x * t.sinh(), radii.y * t.cosh()),
            Self::Spline { spline, .. } => spline.first_derivative(t)[1],
        }
    }

    /// After which parameter it comes back to where it was.
    pub fn period(&self) -> Option<f64> {
        match self {
            Self::Ellipse { .. } => Some(TAU),
            Self::Spline { spline, is_closed: true } => Some(spline.knots().length()),
            _ => None,
        }
    }

    /// The parameters between which it is given; `None` where that is from −∞ to ∞, or around and around.
    pub fn domain(&self) -> Option<[f64; 2]> {
        match self {
            Self::Spline { spline, .. } => Some(spline.knots().domain().into()),
            _ => None,
        }
    }

    /// The parameter of the point of the curve nearest to `point`, as far as searches from samples find it; exact for
    /// points on the curve.
    pub fn parameter(&self, point: DVec3) -> f64 {
        match self {
            Self::Line { origin, direction } => (point - *origin).dot(*direction) / direction.length_squared(),
            Self::Ellipse { frame, radii } => {
                let local = frame.local(point);
                libm::atan2(local.y / radii.y, local.x / radii.x)
            }
            Self::Parabola { frame, focal } => frame.local(point).y / (2.0 * focal),
            Self::Hyperbola { frame, radii } => (frame.local(point).y / radii.y).asinh(),
            Self::Spline { spline, .. } => nearest(spline, point),
        }
    }

    /// The part of the curve that runs from `start` to `end`, two points on it, as a range of parameters that ascends, and
    /// whether the curve runs through it from `end` to `start`.
    ///
    /// `is_forward` says which way the curve is said to run; on a curve that is not closed the points decide. Points that
    /// are within `tolerance` of a spline's ends are these ends. Equal points mean a whole turn.
    pub fn range(&self, [start, end]: [DVec3; 2], is_forward: bool, tolerance: f64) -> ([f64; 2], bool) {
        let [from, to] = if is_forward { [start, end] } else { [end, start] };
        let at_end = |point: DVec3, side: usize| {
            let t = self.domain()?[side];
            (self.point(t).distance(point) <= tolerance).then_some(t)
        };
        let mut a = at_end(from, 0).unwrap_or_else(|| self.parameter(from));
        let mut b = at_end(to, 1).unwrap_or_else(|| self.parameter(to));
        match self.period() {
            Some(period) => {
                let least = if start.distance(end) <= tolerance { 0.5 * period } else { 0.0 };
                // Both parameters are within one period of each other, but for rounding.
                if b <= a + least {
                    b += period;
                }
                if b <= a + least {
                    b += period;
                }
                ([a, b], !is_forward)
            }
            None if b < a => {
                std::mem::swap(&mut a, &mut b);
                ([a, b], is_forward)
            }
            None => ([a, b], !is_forward),
        }
    }

    /// The part over a range as splines of the same parameter at each of their knots, in order: one, but two where the
    /// range runs over the end of a closed spline.
    ///
    /// # Errors
    /// Where the range is empty or beyond the spline.
    pub fn splines(&self, [start, end]: [f64; 2]) -> Result<Vec<SpaceCurve>, NurbsError> {
        Ok(match self {
            Self::Line { .. } => {
                let points = [start, end].map(|t| self.point(t));
                vec![SpaceCurve::new(bezier_knots(1, [start, end])?, &points, None)?]
            }
            Self::Ellipse { frame, radii } => {
                let arcs = Arcs::new([start, end]);
                let point =
                    |(angle, reach): (f64, f64)| frame.point((*radii * DVec2::from_angle(angle) * reach).extend(0.0));
                let points: Vec<DVec3> = arcs.controls().map(point).collect();
                let weights: Vec<f64> = arcs.controls().map(|(_, reach)| reach.recip()).collect();
                vec![SpaceCurve::new(KnotVector::new(2, arcs.knots())?, &points, Some(&weights))?]
            }
            Self::Parabola { frame, focal } => {
                // The blossom of (f t², 2 f t).
                let middle = DVec3::new(focal * start * end, focal * (start + end), 0.0);
                let points = [self.point(start), frame.point(middle), self.point(end)];
                vec![SpaceCurve::new(bezier_knots(2, [start, end])?, &points, None)?]
            }
            Self::Hyperbola { frame, radii } => {
                // As an arc, with cosh for cos.
                let (middle, weight) = (0.5 * (start + end), (0.5 * (end - start)).cosh());
                let apex = DVec3::new(radii.x * middle.cosh(), radii.y * middle.sinh(), 0.0) / weight;
                let points = [self.point(start), frame.point(apex), self.point(end)];
                vec![SpaceCurve::new(bezier_knots(2, [start, end])?, &points, Some(&[1.0, weight, 1.0]))?]
            }
            Self::Spline { spline, is_closed } => {
                let (first, last) = spline.knots().domain();
                let period = last - first;
                let (mut start, mut end) = (start, end);
                if *is_closed {
                    let turns = ((start - first) / period).floor() * period;
                    (start, end) = (start - turns, end - turns);
                }
                if *is_closed && last < end {
                    vec![spline.restricted([start, last])?, spline.restricted([first, (end - period).min(last)])?]
                } else {
                    vec![spline.restricted([start.max(first), end.min(last)])?]
                }
            }
        })
    }

    /// The parameters inside a range at which the curve may bend sharply, and those that cut it into parts along which it
    /// turns by less than half a turn.
    pub fn breaks(&self, [start, end]: [f64; 2]) -> Vec<f64> {
        let inside = |t: &f64| start < *t && *t < end;
        match self {
            Self::Line { .. } => vec![],
            Self::Parabola { .. } | Self::Hyperbola { .. } => vec![0.5 * (start + end)],
            Self::Ellipse { .. } => {
                let arcs = Arcs::new([start, end]);
                (1..arcs.count).map(|k| arcs.start + arcs.step * k as f64).collect()
            }
            Self::Spline { spline, is_closed } => {
                let knots = spline.knots();
                let u = knots.knots();
                let own = knots.spans().map(|k| u[k]);
                let shifts = if *is_closed { [0.0, knots.length()].to_vec() } else { vec![0.0] };
                let mut all: Vec<f64> = own.flat_map(|t| shifts.iter().map(move |s| t + s)).filter(inside).collect();
                all.sort_by(f64::total_cmp);
                all
            }
        }
    }
}

/// The parameter of the nearest point of a spline: Newton's method on the distance from the nearest samples, with the
/// curvature left out, which is exact where the distance is zero.
fn nearest(spline: &SpaceCurve, point: DVec3) -> f64 {
    let knots = spline.knots();
    let (start, end) = knots.domain();
    let count = SAMPLES_A_DEGREE * knots.degree();
    let u = knots.knots();
    let samples =
        knots.spans().flat_map(|k| (0..count).map(move |i| u[k] + (u[k + 1] - u[k]) * (i as f64 / count as f64)));
    let mut seeds: Vec<(f64, f64)> = vec![];
    for t in samples.chain([end]) {
        let distance = spline.first_derivative(t)[0].distance_squared(point);
        let place = seeds.partition_point(|(other, _)| *other <= distance);
        if place < SEEDS {
            seeds.insert(place, (distance, t));
            seeds.truncate(SEEDS);
        }
    }
    let mut best = seeds[0];
    for (mut distance, mut t) in seeds {
        for _ in 0..STEPS {
            let [c, c_t] = spline.first_derivative(t);
            let step = (point - c).dot(c_t) / c_t.length_squared();
            let next = (t + step).clamp(start, end);
            let there = spline.first_derivative(next)[0].distance_squared(point);
            let is_nearer = there < distance;
            if !is_nearer {
                break;
            }
            (distance, t) = (there, next);
        }
        if distance < best.0 {
            best = (distance, t);
        }
    }
    best.1
}
