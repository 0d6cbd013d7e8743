//! Rational curves as readers handle them: cut, raised, joined, and made into trims.
//!
//! A point is homogeneous, (w x, w y, w z, w); a curve in (u, v) has z = 0. All of it is exact but for rounding.

use glam::{DVec2, DVec4};
use nurbs::{Curve, KnotVector, NurbsError};
use scene::Trim;

/// A rational spline curve whose weights are finite and above 0.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Spline {
    knots: KnotVector,
    points: Vec<DVec4>,
}

impl Spline {
    /// A curve of as many homogeneous points as the knots ask for.
    ///
    /// # Errors
    /// Those of [`KnotVector::new`], [`NurbsError::PointCount`], [`NurbsError::PointNotFinite`], [`NurbsError::Weight`].
    pub fn new(degree: usize, knots: Vec<f64>, points: Vec<DVec4>) -> Result<Self, NurbsError> {
        let knots = KnotVector::new(degree, knots)?;
        let (expected, found) = (knots.control_count(), points.len());
        if found != expected {
            return Err(NurbsError::PointCount { expected, found });
        }
        for (index, point) in points.iter().enumerate() {
            if !(point.w > 0.0 && point.w.is_finite()) {
                return Err(NurbsError::Weight { index, value: point.w });
            }
            if let Some(value) = point.truncate().to_array().into_iter().find(|x| !x.is_finite()) {
                return Err(NurbsError::PointNotFinite { index, value });
            }
        }
        Ok(Self { knots, points })
    }

    /// One Bézier curve, of degree 1 or more, over a range of parameters.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn bezier(points: Vec<DVec4>, [start, end]: [f64; 2]) -> Result<Self, NurbsError> {
        let order = points.len();
        Self::new(order.saturating_sub(1), [vec![start; order], vec![end; order]].concat(), points)
    }

    pub fn knots(&self) -> &KnotVector {
        &self.knots
    }

    pub fn points(&self) -> &[DVec4] {
        &self.points
    }

    /// Where its parameter begins and ends.
    pub fn domain(&self) -> [f64; 2] {
        self.knots.domain().into()
    }

    /// The point at `t`, homogeneous (Piegl & Tiller, A4.1).
    pub fn point(&self, t: f64) -> DVec4 {
        self.blossom(self.knots.find_span(t), |_| t)
    }

    /// The blossom of the polynomial of span `span` at p arguments (Piegl & Tiller, A4.1, with an argument a step).
    fn blossom(&self, span: usize, argument: impl Fn(usize) -> f64) -> DVec4 {
        let (p, u) = (self.knots.degree(), self.knots.knots());
        let mut d = self.points[span - p..=span].to_vec();
        for r in 1..=p {
            let t = argument(r - 1);
            for j in (r..=p).rev() {
                let (low, high) = (u[span - p + j], u[span + 1 + j - r]);
                let share = (t - low) / (high - low);
                d[j] = d[j - 1] * (1.0 - share) + d[j] * share;
            }
        }
        d[p]
    }

    /// The part over a range of the domain, with the same parameter, clamped at both ends.
    ///
    /// # Errors
    /// Those of [`nurbs::restricted`].
    pub fn restricted(&self, range: [f64; 2]) -> Result<Self, NurbsError> {
        let (knots, points) = nurbs::restricted(&self.knots, &self.points, range)?;
        Ok(Self { knots, points })
    }

    /// The same curve of a degree that is not lower, by Bézier pieces (Piegl & Tiller, Eq. 5.36).
    ///
    /// # Errors
    /// [`NurbsError::Degree`].
    pub fn raised(&self, degree: usize) -> Result<Self, NurbsError> {
        let (p, u) = (self.knots.degree(), self.knots.knots());
        if degree == p {
            return Ok(self.clone());
        }
        let mut knots = vec![self.domain()[0]; degree + 1];
        let mut points: Vec<DVec4> = vec![];
        for k in self.knots.spans() {
            let [a, b] = [u[k], u[k + 1]];
            let mut piece: Vec<DVec4> = (0..=p).map(|i| self.blossom(k, |r| if r < p - i { a } else { b })).collect();
            for q in p..degree {
                let share = |i: usize| i as f64 / (q + 1) as f64;
                let inside = (1..=q).map(|i| piece[i - 1] * share(i) + piece[i] * (1.0 - share(i)));
                piece = std::iter::once(piece[0]).chain(inside).chain([piece[q]]).collect();
            }
            points.extend(piece.into_iter().skip(usize::from(!points.is_empty())));
            knots.extend(vec![b; degree]);
        }
        knots.push(self.domain()[1]);
        Self::new(degree, knots, points)
    }

    /// One curve of several that follow each other in parameter, and how far the widest gap is between two of them.
    ///
    /// Where they meet, the end of the earlier one is taken.
    ///
    /// # Errors
    /// Those of [`Self::new`]; [`NurbsError::TooFewKnots`] where there is none.
    pub fn joined(parts: &[Self]) -> Result<(Self, f64), NurbsError> {
        let degree = parts.iter().map(|part| part.knots.degree()).max().unwrap_or(1);
        let (mut knots, mut points, mut gap): (Vec<f64>, Vec<DVec4>, f64) = (vec![], vec![], 0.0);
        for part in parts {
            let part = part.restricted(part.domain())?.raised(degree)?;
            let Some(last) = points.last().copied() else {
                (knots, points) = (part.knots.knots().to_vec(), part.points);
                continue;
            };
            let first = part.points[0];
            gap = gap.max((last.truncate() / last.w).distance(first.truncate() / first.w));
            knots.pop();
            knots.extend(&part.knots.knots()[degree + 1..]);
            points.extend(part.points[1..].iter().map(|p| *p * (last.w / first.w)));
        }
        Ok((Self::new(degree, knots, points)?, gap))
    }

    /// The same curve with its domain mapped to another.
    ///
    /// # Errors
    /// Those of [`KnotVector::new`].
    pub fn over(&self, [start, end]: [f64; 2]) -> Result<Self, NurbsError> {
        let [first, last] = self.domain();
        if [start, end] == [first, last] {
            return Ok(self.clone());
        }
        // Both ends are exact.
        let place = |t: f64| (start * (last - t) + end * (t - first)) / (last - first);
        let map = |t: &f64| {
            if *t == first {
                start
            } else if *t == last {
                end
            } else {
                place(*t)
            }
        };
        Self::new(self.knots.degree(), self.knots.knots().iter().map(map).collect(), self.points.clone())
    }

    /// The curve of the points moved by `f`, which must keep weights.
    pub fn mapped(&self, f: impl Fn(DVec4) -> DVec4) -> Self {
        Self { knots: self.knots.clone(), points: self.points.iter().copied().map(f).collect() }
    }

    /// Its Euclidean control points (u, v).
    pub fn plane_points(&self) -> impl Iterator<Item = DVec2> + '_ {
        self.points.iter().map(|p| DVec2::new(p.x, p.y) / p.w)
    }

    /// The trim that runs along it.
    pub fn trim(&self) -> Trim {
        Trim::new(self.knots.clone(), self.plane_points().collect(), weights(&self.points))
    }
}

/// The signed area inside a loop of curves, by their control points (u, v): above 0 where it runs counter-clockwise.
///
/// # Errors
/// Those of [`Curve::new`].
pub(crate) fn area<'a>(curves: impl IntoIterator<Item = &'a Trim>) -> Result<f64, NurbsError> {
    let mut sum = 0.0;
    let mut about = None;
    for trim in curves {
        let about = *about.get_or_insert(trim.points[0]);
        let curve = Curve::new(trim.knots.clone(), &trim.points, trim.weights.as_deref())?;
        let swept: f64 = curve.bezier_segments().iter().map(|segment| segment.area(about)).sum();
        sum += if trim.reversed { -swept } else { swept };
    }
    Ok(sum)
}

/// The weights of homogeneous points; `None` where all are equal.
pub(crate) fn weights(points: &[DVec4]) -> Option<Vec<f64>> {
    points.iter().any(|p| p.w != points[0].w).then(|| points.iter().map(|p| p.w).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    fn curve() -> Spline {
        let knots = vec![0.0, 0.5, 1.0, 2.0, 3.0, 3.5, 3.5, 5.0, 6.0, 6.5, 7.0];
        let weights = [1.0, 2.0, 0.5, 1.0, 3.0, 1.0, 0.7];
        let point = |k: usize| DVec3::new(k as f64, (k * k % 5) as f64, (k % 3) as f64);
        Spline::new(3, knots, (0..7).map(|k| (point(k) * weights[k]).extend(weights[k])).collect()).unwrap()
    }

    fn place(curve: &Spline, t: f64) -> DVec3 {
        let p = curve.point(t);
        p.truncate() / p.w
    }

    fn distance(a: &Spline, b: &Spline, [start, end]: [f64; 2]) -> f64 {
        let t = |k: i32| start + (end - start) * f64::from(k) / 64.0;
        (0..=64).map(|k| place(a, t(k)).distance(place(b, t(k)))).fold(0.0, f64::max)
    }

    #[test]
    fn a_part_is_the_same_curve_of_the_same_parameter() {
        let curve = curve();
        for range in [[2.0, 5.0], [2.25, 4.0], [3.0, 3.5], [3.1, 3.2]] {
            let part = curve.restricted(range).unwrap();
            assert_eq!(part.domain(), range);
            assert!(distance(&curve, &part, range) < 1e-13, "{range:?}");
        }
        assert!(matches!(curve.restricted([1.0, 3.0]), Err(NurbsError::OutsideDomain { .. })));
    }

    #[test]
    fn a_raised_curve_is_the_same_curve() {
        let curve = curve();
        let raised = curve.raised(5).unwrap();
        assert_eq!(raised.knots().degree(), 5);
        assert!(distance(&curve, &raised, [2.0, 5.0]) < 1e-13);
    }

    #[test]
    fn parts_joined_are_the_whole_again() {
        let curve = curve();
        let parts = [[2.0, 2.5], [2.5, 3.5], [3.5, 5.0]].map(|range| curve.restricted(range).unwrap());
        let raised = [parts[0].clone(), parts[1].raised(4).unwrap(), parts[2].clone()];
        let (whole, gap) = Spline::joined(&raised).unwrap();
        assert!(gap < 1e-14);
        assert!(distance(&curve, &whole, [2.0, 5.0]) < 1e-13);
        let shifted = parts[2].mapped(|p| p + DVec4::new(0.25 * p.w, 0.0, 0.0, 0.0));
        let (_, gap) = Spline::joined(&[parts[1].clone(), shifted]).unwrap();
        assert!((gap - 0.25).abs() < 1e-14, "a gap is measured: {gap}");
    }
}
