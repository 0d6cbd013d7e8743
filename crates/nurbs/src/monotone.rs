//! Cutting a plane Bézier curve where u or v turns back, so that no piece meets a line of either direction twice.

use crate::bezier_curve::BezierCurve;
use crate::{MAX_DEGREE, MAX_ORDER};
use glam::DVec3;

/// Coefficients of the derivative's numerator below this share of the products that they are made of are rounding.
///
/// A coefficient is a sum of at most p + 1 products of two control coordinates, each off by a few ulp.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// Halvings of a parameter interval in which more than one turn may still lie: then it is narrower than its rounding.
const HALVINGS: u32 = 48;

/// Bisections of an interval with one turn: enough for every bit of a parameter below 1.
const BISECTIONS: u32 = 60;

/// Order of the numerator of a rational curve's derivative, at most.
const NUMERATOR_ORDER: usize = 2 * MAX_DEGREE;

/// The numerator, or a part of it, in Bernstein form.
type Numerator = [f64; NUMERATOR_ORDER];

impl BezierCurve {
    /// The curve cut at the extrema of u and of v, in order, each piece in standard form.
    ///
    /// On each piece u and v are monotone up to rounding: a step back is at most 8 p ε of the largest coordinate.
    /// The last point of a piece is to the bit the first of the next, the outer ends are those of the curve. A
    /// coordinate that is constant up to rounding has no extrema. A curve without turns is one piece.
    pub fn monotone_pieces(&self) -> Vec<BezierCurve> {
        let mut turns = self.extrema(0);
        turns.extend(self.extrema(1));
        turns.sort_by(f64::total_cmp);
        turns.dedup();
        let mut pieces = Vec::with_capacity(turns.len() + 1);
        let (mut rest, mut from) = (self.clone(), 0.0);
        let last = self.end();
        let mut joint = self.start();
        for t in turns {
            let local = (t - from) / (1.0 - from);
            if !(0.0 < local && local < 1.0) {
                continue;
            }
            let [low, high] = rest.split(local);
            let mut piece = low.standardised();
            let end = piece.end();
            piece.set_ends(joint, end);
            pieces.push(piece);
            (rest, from, joint) = (high, t, end);
        }
        let mut piece = rest.standardised();
        piece.set_ends(joint, last);
        pieces.push(piece);
        pieces
    }

    /// The parameters inside 0 to 1 at which coordinate `axis` (0 = u, 1 = v) turns back, ascending.
    ///
    /// Each within the rounding of the derivative's numerator. Roots where the derivative only touches zero may or may
    /// not be among them.
    pub fn extrema(&self, axis: usize) -> Vec<f64> {
        let p = self.degree();
        let hull = self.hull();
        let coordinate = |c: &DVec3| if axis == 0 { c.x } else { c.y };
        let (low, high) = if axis == 0 { (hull.min.x, hull.max.x) } else { (hull.min.y, hull.max.y) };
        // About the middle of the control points: a curve far from the origin loses nothing in its differences.
        let middle = 0.5 * (low + high);
        let mut x = [0.0; MAX_ORDER];
        for (x, c) in x.iter_mut().zip(&self.control) {
            *x = coordinate(c) - middle * c.z;
        }
        let weight = self.control.iter().map(|c| c.z).fold(0.0, f64::max);
        // The coordinates themselves carry half an ulp of their distance from the origin.
        let size = (high - low).max(low.abs().max(high.abs()) * ROUNDING);
        let mut numerator: Numerator = [0.0; NUMERATOR_ORDER];
        let order = if self.is_rational() {
            let mut w = [0.0; MAX_ORDER];
            for (w, c) in w.iter_mut().zip(&self.control) {
                *w = c.z;
            }
            quotient_numerator(&x[..=p], &w[..=p], &mut numerator)
        } else {
            for i in 0..p {
                numerator[i] = (x[i + 1] - x[i]) * weight;
            }
            p
        };
        let rounding = low.abs().max(high.abs()) * f64::EPSILON * 8.0;
        let noise = (ROUNDING * size + rounding) * weight * weight;
        let mut found = vec![];
        isolate(&numerator, order, noise, [0.0, 1.0], HALVINGS, &mut found);
        // A turn from which the curve does not come back by more than rounding is none.
        let ends = [self.start(), self.end()];
        let steps_back = |t: f64| {
            let at = self.point(t);
            ends.iter().all(|end| rounding * p as f64 <= (at[axis] - end[axis]).abs())
        };
        found.retain(|&t| 0.0 < t && t < 1.0 && steps_back(t));
        found
    }
}

/// Bernstein coefficients of (x' w − x w') / p, of degree 2 p − 2; returns their number.
///
/// With x = Σ x_i B_i, the sum over i, j of (x_{i+1} − x_i) w_j and x_j (w_{i+1} − w_i), products of degrees p − 1 and
/// p; written over pairs i < j as (x_j w_i − x_i w_j) it is at once of its true degree 2 p − 2 (Floater 1992, Eq. 8).
fn quotient_numerator(x: &[f64], w: &[f64], numerator: &mut Numerator) -> usize {
    let p = x.len() - 1;
    let binomials = binomial_row(p);
    let wide = binomial_row(2 * p - 2);
    for i in 0..p {
        for j in i + 1..=p {
            // B_i B_j' − B_i' B_j = C(p,i) C(p,j) (j − i) t^{i+j−1} (1 − t)^{2p−i−j−1}
            let cross = w[i] * x[j] - x[i] * w[j];
            let k = i + j - 1;
            numerator[k] += cross * binomials[i] * binomials[j] * (j - i) as f64 / (wide[k] * p as f64);
        }
    }
    2 * p - 1
}

/// The binomials n over 0 … n; exact, as all are below 2⁵³.
fn binomial_row(n: usize) -> [f64; NUMERATOR_ORDER] {
    let mut row = [0.0; NUMERATOR_ORDER];
    row[0] = 1.0;
    for k in 1..=n {
        row[k] = row[k - 1] * (n + 1 - k) as f64 / k as f64;
    }
    row
}

/// Adds the parameters at which the polynomial of the first `order` coefficients changes its sign.
fn isolate(c: &Numerator, order: usize, noise: f64, [a, b]: [f64; 2], halvings: u32, found: &mut Vec<f64>) {
    match sign_changes(&c[..order], noise) {
        0 => {}
        1 => found.push(a + (b - a) * bisect(c, order, noise)),
        // Turns closer together than parameters can tell: one cut among them does for all.
        _ if halvings == 0 => found.push(0.5 * (a + b)),
        _ => {
            let (low, high) = halves(c, order, 0.5);
            let middle = 0.5 * (a + b);
            let ends = [low[0], low[order - 1], high[order - 1]].map(|x| if x.abs() <= noise { 0.0 } else { x });
            isolate(&low, order, noise, [a, middle], halvings - 1, found);
            // A root just at the cut has no sign change on either side of it.
            if ends[1] == 0.0 && found.last().is_none_or(|t| *t < middle) {
                found.push(middle);
            }
            isolate(&high, order, noise, [middle, b], halvings - 1, found);
        }
    }
}

fn sign_changes(c: &[f64], noise: f64) -> usize {
    let mut previous = 0.0;
    let mut changes = 0;
    for &x in c.iter().filter(|x| x.abs() > noise) {
        changes += usize::from(previous * x < 0.0);
        previous = x.signum();
    }
    changes
}

/// The root in 0 to 1 of a polynomial whose coefficients change sign once.
fn bisect(c: &Numerator, order: usize, noise: f64) -> f64 {
    let rises = c[..order].iter().find(|x| x.abs() > noise).is_some_and(|x| *x < 0.0);
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            break;
        }
        if (value(c, order, middle) < 0.0) == rises { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

fn value(c: &Numerator, order: usize, t: f64) -> f64 {
    let mut d = *c;
    for r in 1..order {
        for i in 0..order - r {
            d[i] = d[i] * (1.0 - t) + d[i + 1] * t;
        }
    }
    d[0]
}

fn halves(c: &Numerator, order: usize, t: f64) -> (Numerator, Numerator) {
    let mut d = *c;
    let (mut low, mut high) = ([0.0; NUMERATOR_ORDER], [0.0; NUMERATOR_ORDER]);
    for r in 0..order {
        low[r] = d[0];
        high[order - 1 - r] = d[order - 1 - r];
        for i in 0..order - 1 - r {
            d[i] = d[i] * (1.0 - t) + d[i + 1] * t;
        }
    }
    (low, high)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Curve, KnotVector};
    use glam::DVec2;
    use proptest::prelude::*;

    fn curve(points: Vec<(f64, f64, f64)>, offset: f64) -> BezierCurve {
        let lift = |(x, y, w): (f64, f64, f64)| DVec3::new((x + offset) * w, (y - offset) * w, w);
        BezierCurve::new(points.into_iter().map(lift).collect()).unwrap().standardised()
    }

    fn steps_back(piece: &BezierCurve, axis: usize) -> f64 {
        let (a, b) = (piece.start()[axis], piece.end()[axis]);
        let sign = if a <= b { 1.0 } else { -1.0 };
        let values: Vec<f64> = (0..=500).map(|i| sign * piece.point(f64::from(i) / 500.0)[axis]).collect();
        values.windows(2).map(|w| w[0] - w[1]).fold(0.0, f64::max)
    }

    proptest! {
        #[test]
        fn pieces_are_monotone_join_and_are_the_curve(
            points in prop::collection::vec((-1.0f64..1.0, -1.0f64..1.0, 0.05f64..20.0), 2..=16),
            rational: bool,
            offset in prop::sample::select(vec![0.0, 1e3, -1e7]),
        ) {
            let points = points.into_iter().map(|(x, y, w)| (x, y, if rational { w } else { 1.0 })).collect();
            let curve = curve(points, offset);
            let pieces = curve.monotone_pieces();
            prop_assert_eq!(pieces[0].start(), curve.start());
            prop_assert_eq!(pieces[pieces.len() - 1].end(), curve.end());
            let allowed = 256.0 * f64::EPSILON * (2.0 + offset.abs());
            for piece in &pieces {
                prop_assert!(steps_back(piece, 0).max(steps_back(piece, 1)) <= allowed);
            }
            for pair in pieces.windows(2) {
                prop_assert_eq!(pair[0].end(), pair[1].start());
            }
            // The pieces sweep the area of the curve, and each of its points lies on one of them, found by
            // bisection as pieces are monotone.
            let middle = curve.hull().min.midpoint(curve.hull().max);
            let area: f64 = pieces.iter().map(|p| p.area(middle)).sum();
            prop_assert!((area - curve.area(middle)).abs() <= 1e-12 + 8.0 * allowed);
            for i in 0..=50 {
                let point = curve.point(f64::from(i) / 50.0);
                let nearest = pieces.iter().map(|p| distance_to_monotone(p, point)).fold(f64::INFINITY, f64::min);
                prop_assert!(nearest <= 1e-12 + 4.0 * allowed, "point {i} is {nearest:e} off");
            }
        }
    }

    fn distance_to_monotone(piece: &BezierCurve, point: DVec2) -> f64 {
        // By either coordinate: where one turns, its rounding is the root of itself along the curve.
        let at = |axis: usize| {
            let rises = piece.start()[axis] < piece.end()[axis];
            let (mut low, mut high) = (0.0, 1.0);
            for _ in 0..BISECTIONS {
                let middle = 0.5 * (low + high);
                if (piece.point(middle)[axis] < point[axis]) == rises { low = middle } else { high = middle }
            }
            low
        };
        [0.0, at(0), at(1), 1.0].into_iter().map(|t| piece.point(t).distance(point)).fold(f64::INFINITY, f64::min)
    }

    #[test]
    fn a_circle_of_one_segment_is_cut_at_its_four_extremes() {
        // The full circle as one rational quintic (Chou 1995): weights 1, 1/5, 1/5, 1/5, 1/5, 1.
        let points = [
            (0.0, -1.0, 5.0),
            (4.0, -1.0, 1.0),
            (2.0, 3.0, 1.0),
            (-2.0, 3.0, 1.0),
            (-4.0, -1.0, 1.0),
            (0.0, -1.0, 5.0),
        ];
        let circle = curve(points.to_vec(), 0.0);
        let pieces = circle.monotone_pieces();
        assert!((0..=20).all(|i| (circle.point(f64::from(i) / 20.0).length() - 1.0).abs() < 1e-15));
        let joints: Vec<DVec2> = pieces.iter().map(BezierCurve::start).collect();
        let expected = [DVec2::NEG_Y, DVec2::X, DVec2::Y, DVec2::NEG_X];
        assert_eq!(joints.len(), 4, "{joints:?}");
        assert!(joints.iter().zip(expected).all(|(a, b)| a.distance(b) < 1e-15), "{joints:?}");
        let area: f64 = pieces.iter().map(|p| p.area(DVec2::ZERO)).sum();
        assert!((area - std::f64::consts::PI).abs() < 1e-14, "{area}");
    }

    #[test]
    fn lines_along_an_axis_and_lines_with_rounding_stay_one_piece() {
        let vertical = curve(vec![(4.0, 0.0, 1.0), (4.0 + 1e-15, 0.4, 2.0), (4.0 - 1e-15, 1.0, 1.0)], 0.0);
        assert_eq!(vertical.monotone_pieces().len(), 1);
        // An arc that ends at its extreme, but for a turn that is rounding.
        let arc = curve(vec![(1.0, -1.0, 1.0), (1.0 + 2e-16, 0.0, 0.5f64.sqrt()), (0.0, 0.0, 1.0)], 30.0);
        assert_eq!(arc.monotone_pieces().len(), 1);
    }

    #[test]
    fn a_cusp_and_a_loop_are_cut_at_each_turn() {
        // (t², t³) about t = 0: u turns in the cusp, v does not.
        let cusp = curve(vec![(1.0, -1.0, 1.0), (-1.0, 1.0, 1.0), (-1.0, -1.0, 1.0), (1.0, 1.0, 1.0)], 0.0);
        let pieces = cusp.monotone_pieces();
        assert_eq!(pieces.len(), 2);
        assert!(pieces[0].end().distance(DVec2::new(-0.5, 0.0)) < 1e-15, "{pieces:?}");
    }

    #[test]
    fn segments_of_a_curve_are_the_curve_and_join() {
        let knots = KnotVector::new(3, vec![-2.0, -1.0, 0.0, 0.5, 1.0, 1.0, 2.0, 3.0, 3.5, 4.0]).unwrap();
        let points: Vec<DVec2> = (0..6).map(|i| DVec2::new(f64::from(i), f64::from(i * i % 5))).collect();
        let curve = Curve::new(knots.clone(), &points, None).unwrap();
        let segments = curve.bezier_segments();
        let spans: Vec<usize> = knots.spans().collect();
        assert_eq!(segments.len(), spans.len());
        for (segment, k) in segments.iter().zip(spans) {
            let (a, b) = (knots.knots()[k], knots.knots()[k + 1]);
            for i in 0..=10 {
                let t = f64::from(i) / 10.0;
                assert!(segment.point(t).distance(curve.point(a + (b - a) * t)) < 1e-14);
            }
        }
        assert!(segments.windows(2).all(|pair| pair[0].end() == pair[1].start()));
        // Rational: in standard form the parameter moves, the points do not.
        let weights = [1.0, 2.0, 0.5, 4.0, 1.0, 3.0];
        let rational = Curve::new(knots.clone(), &points, Some(&weights)).unwrap();
        let segment = &rational.bezier_segments()[0];
        let (a, b) = (knots.knots()[3], knots.knots()[4]);
        assert!(
            segment.start().distance(rational.point(a)) < 1e-14 && segment.end().distance(rational.point(b)) < 1e-14
        );
        assert_eq!((segment.control()[0].z, segment.control()[3].z), (1.0, 1.0));
        for i in 1..10 {
            let point = segment.point(f64::from(i) / 10.0);
            let off = (0..=20_000).map(|k| rational.point(a + (b - a) * f64::from(k) / 2e4).distance(point));
            assert!(off.fold(f64::INFINITY, f64::min) < 2e-4);
        }
    }
}
