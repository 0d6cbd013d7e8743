//! Changing the degree of a plane Bézier curve: up exactly, down with a bound on the error.

use crate::bezier_curve::BezierCurve;
use crate::{MAX_DEGREE, NurbsError};
use glam::DVec3;

/// Halvings before a bound is given up: pieces then are a millionth of the curve, and rounding is what is left.
const HALVINGS: u32 = 20;

/// A curve of lower degree, and how far it is from the one that it stands for.
#[derive(Debug, Clone, PartialEq)]
pub struct Reduced {
    /// The curve; its ends are those of the original, weights and all.
    pub curve: BezierCurve,
    /// The greatest distance, at equal parameters, between the two, at most; in units of u and v.
    pub error: f64,
}

impl BezierCurve {
    /// The same curve with the degree raised by one, to 2 ulp (Piegl & Tiller, Eq. 5.36).
    ///
    /// # Errors
    /// [`NurbsError::Degree`] at the cap.
    pub fn elevated(&self) -> Result<Self, NurbsError> {
        let p = self.degree();
        if p == MAX_DEGREE {
            return Err(NurbsError::Degree { degree: p + 1 });
        }
        Ok(Self { control: raised(&self.control) })
    }

    /// The curve of a degree lower by one that keeps the ends, with as many derivatives there as it can; `None` for a
    /// straight segment.
    ///
    /// Half of the points come from the left, half from the right (Piegl & Tiller, Eqs. 5.41 and 5.42). Their bounds
    /// (5.43 to 5.46) are for polynomial curves; here the difference d of the homogeneous curves is taken in Bernstein
    /// form. As C̃ − C = (d − C d_w) / w̃, the error is at most (max |d| + max |C − m| max |d_w|) / min w̃, with points
    /// counted from the middle m of the control box. Rounding is not counted: 8 p ε of the largest coordinate.
    pub fn reduced_once(&self) -> Option<Reduced> {
        let p = self.degree();
        if p == 1 {
            return None;
        }
        let middle = self.hull().min.midpoint(self.hull().max);
        let q: Vec<DVec3> = self.control.iter().map(|c| *c - (middle * c.z).extend(0.0)).collect();
        let mut control = vec![DVec3::ZERO; p];
        let r = (p - 1) / 2;
        let alpha = |i: usize| i as f64 / p as f64;
        control[0] = q[0];
        for i in 1..=r {
            control[i] = (q[i] - control[i - 1] * alpha(i)) / (1.0 - alpha(i));
        }
        control[p - 1] = q[p];
        let from_right = |next: DVec3, i: usize| (q[i + 1] - next * (1.0 - alpha(i + 1))) / alpha(i + 1);
        for i in (r + 1..p - 1).rev() {
            control[i] = from_right(control[i + 1], i);
        }
        if p % 2 == 1 && 1 <= r {
            control[r] = 0.5 * (control[r] + from_right(control[r + 1], r));
        }
        // Weights may come out of range where they vary much: then there is no such curve.
        let lightest = control.iter().map(|c| c.z).fold(f64::INFINITY, f64::min);
        if lightest <= 0.0 {
            return None;
        }
        let difference: Vec<DVec3> = raised(&control).iter().zip(&q).map(|(a, b)| *a - *b).collect();
        let reach = q.iter().map(|c| c.truncate().length() / c.z).fold(0.0, f64::max);
        let offset = bernstein_bound(difference.iter().map(|d| d.truncate().length()));
        let weight = bernstein_bound(difference.iter().map(|d| d.z.abs()));
        let error = (offset + reach * weight) / lightest;
        let mut curve = Self { control: control.iter().map(|c| *c + (middle * c.z).extend(0.0)).collect() };
        (curve.control[0], curve.control[p - 1]) = (self.control[0], self.control[p]);
        Some(Reduced { curve, error })
    }

    /// Curves of at most `degree`, in order, that stand for this one within `bound` of u and v: halves of it, halved
    /// until each one's error is within the bound (Geiger 2015, Sec. 3.2.1, after Guthe 2005).
    ///
    /// Neighbours share their end to the bit, and each `error` is the part's own.
    ///
    /// # Errors
    /// [`NurbsError::Degree`] for degree 0; [`NurbsError::ReductionBound`] where 20 halvings do not reach the bound,
    /// as when it is below rounding.
    pub fn reduced(&self, degree: usize, bound: f64) -> Result<Vec<Reduced>, NurbsError> {
        if degree == 0 {
            return Err(NurbsError::Degree { degree });
        }
        let mut parts = vec![];
        self.reduce_into(degree, bound, HALVINGS, &mut parts)?;
        Ok(parts)
    }

    fn reduce_into(
        &self,
        degree: usize,
        bound: f64,
        halvings: u32,
        parts: &mut Vec<Reduced>,
    ) -> Result<(), NurbsError> {
        let whole = self.reduced_to(degree);
        if let Some(whole) = whole.as_ref().filter(|w| w.error <= bound) {
            parts.push(whole.clone());
            return Ok(());
        }
        if halvings == 0 {
            let reached = whole.map_or(f64::INFINITY, |w| w.error);
            return Err(NurbsError::ReductionBound { degree, bound, reached });
        }
        let [low, high] = self.split(0.5);
        low.reduce_into(degree, bound, halvings - 1, parts)?;
        high.reduce_into(degree, bound, halvings - 1, parts)
    }

    /// One step after the other; their errors add.
    fn reduced_to(&self, degree: usize) -> Option<Reduced> {
        let mut whole = Reduced { curve: self.clone(), error: 0.0 };
        while degree < whole.curve.degree() {
            let step = whole.curve.reduced_once()?;
            whole = Reduced { error: whole.error + step.error, ..step };
        }
        Some(whole)
    }
}

/// The control points of the same curve one degree higher.
fn raised(control: &[DVec3]) -> Vec<DVec3> {
    let order = control.len();
    let share = |i: usize| i as f64 / order as f64;
    let inner = (1..order).map(|i| control[i - 1] * share(i) + control[i] * (1.0 - share(i)));
    [control[0]].into_iter().chain(inner).chain([control[order - 1]]).collect()
}

/// A bound on Σ B_i(t) s_i for sizes s_i: each basis function's own greatest value, or their sum's, which is 1.
fn bernstein_bound(sizes: impl ExactSizeIterator<Item = f64>) -> f64 {
    let p = sizes.len() - 1;
    let (mut greatest, mut sum) = (0.0f64, 0.0);
    for (i, size) in sizes.enumerate() {
        greatest = greatest.max(size);
        sum += size * bernstein_peak(i, p);
    }
    greatest.min(sum)
}

/// The greatest value of B_{i,p}, at t = i / p.
fn bernstein_peak(i: usize, p: usize) -> f64 {
    let t = i as f64 / p as f64;
    crate::basis::binomial(p, i) * t.powi(i as i32) * (1.0 - t).powi((p - i) as i32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn curve(points: Vec<(f64, f64, f64)>) -> BezierCurve {
        let lift = |(x, y, w): (f64, f64, f64)| DVec3::new(x * w, y * w, w);
        BezierCurve::new(points.into_iter().map(lift).collect()).unwrap()
    }

    fn farthest(a: &BezierCurve, b: &BezierCurve) -> f64 {
        (0..=200).map(|i| f64::from(i) / 200.0).map(|t| a.point(t).distance(b.point(t))).fold(0.0, f64::max)
    }

    proptest! {
        #[test]
        fn a_raised_curve_is_the_same_and_comes_down_again(
            points in prop::collection::vec((-9.0f64..9.0, -9.0f64..9.0, 0.5f64..2.0), 2..15),
        ) {
            let curve = curve(points);
            let raised = curve.elevated().unwrap();
            prop_assert!(farthest(&curve, &raised) <= 1e-13);
            let reduced = raised.reduced_once().unwrap();
            prop_assert!(reduced.error <= 1e-6 && farthest(&reduced.curve, &curve) <= 1e-6, "{:e}", reduced.error);
        }

        #[test]
        fn the_bound_of_a_reduction_holds_and_is_near_the_error(
            points in prop::collection::vec((-9.0f64..9.0, -9.0f64..9.0, 0.7f64..1.4), 3..10),
            rational: bool,
        ) {
            let points = points.into_iter().map(|(x, y, w)| (x, y, if rational { w } else { 1.0 })).collect();
            let curve = curve(points);
            if let Some(reduced) = curve.reduced_once() {
                let error = farthest(&reduced.curve, &curve);
                prop_assert!(error <= reduced.error * (1.0 + 1e-12) + 1e-13, "{error:e} above {:e}", reduced.error);
                prop_assert!(reduced.error <= 50.0 * error + 1e-12, "{:e} far above {error:e}", reduced.error);
            }
        }

        #[test]
        fn parts_of_lower_degree_keep_to_the_bound_and_join(
            points in prop::collection::vec((-9.0f64..9.0, -9.0f64..9.0, 0.5f64..2.0), 5..10),
            degree in 1usize..4,
        ) {
            let curve = curve(points).standardised();
            let parts = curve.reduced(degree, 1e-3).unwrap();
            prop_assert_eq!(parts[0].curve.start(), curve.start());
            prop_assert_eq!(parts[parts.len() - 1].curve.end(), curve.end());
            for pair in parts.windows(2) {
                prop_assert_eq!(pair[0].curve.end(), pair[1].curve.start());
            }
            let mut rest = &parts[..];
            near(&curve, &mut rest)?;
            prop_assert!(rest.is_empty());
            prop_assert!(parts.iter().all(|part| part.error <= 1e-3 && part.curve.degree() <= degree));
        }
    }

    /// Takes the parts that stand for a curve: one that has its end, or those of its halves.
    fn near(curve: &BezierCurve, parts: &mut &[Reduced]) -> Result<(), TestCaseError> {
        let (part, rest) = parts.split_first().expect("a part for every half");
        if part.curve.end() == curve.end() {
            *parts = rest;
            let error = farthest(&part.curve, curve);
            prop_assert!(error <= part.error * (1.0 + 1e-12) + 1e-13, "{error:e} above {:e}", part.error);
            return Ok(());
        }
        curve.split(0.5).iter().try_for_each(|half| near(half, parts))
    }

    #[test]
    fn a_bound_that_cannot_be_met_is_an_error() {
        let arc = curve(vec![(1.0, 0.0, 1.0), (1.0, 1.0, 0.5f64.sqrt()), (0.0, 1.0, 1.0)]);
        assert!(matches!(arc.reduced(1, 0.0), Err(NurbsError::ReductionBound { degree: 1, .. })));
        assert!(matches!(arc.reduced(0, 1.0), Err(NurbsError::Degree { degree: 0 })));
        let at_cap = BezierCurve::new((0..=15).map(|i| DVec3::new(f64::from(i), 0.0, 1.0)).collect()).unwrap();
        assert!(matches!(at_cap.elevated(), Err(NurbsError::Degree { degree: 16 })));
    }
}
