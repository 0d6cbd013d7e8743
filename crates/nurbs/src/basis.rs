//! B-spline basis functions and their derivatives on one knot span.
//!
//! Two ways to the same numbers: the inverse triangle with the derivative rows read from its last columns (fast,
//! to second order, what the renderers mirror), and the general algorithm for any order.

use crate::{KnotVector, MAX_ORDER};
use lanes::Lanes;
use std::ops::{Add, Mul, Neg, Sub};

/// A parameter and what is made of it: one, or several in lanes.
pub(crate) trait Number:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Mul<f64, Output = Self> + Neg<Output = Self>
{
    /// The same value in all lanes.
    fn splat(x: f64) -> Self;
}

impl Number for f64 {
    #[inline(always)]
    fn splat(x: f64) -> Self {
        x
    }
}

impl<const N: usize> Number for Lanes<f64, N> {
    #[inline(always)]
    fn splat(x: f64) -> Self {
        Self([x; N])
    }
}

/// Values and first two derivatives of the p + 1 basis functions that are not zero on a span.
///
/// `CAPACITY` is at least p + 1; entries from p + 1 on are zero.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Basis<const CAPACITY: usize, T = f64> {
    pub value: [T; CAPACITY],
    pub first: [T; CAPACITY],
    pub second: [T; CAPACITY],
}

/// Values, first and (where `SECOND`) second derivatives by the inverse triangle.
///
/// Each value is within 3 p ulp of the exact value for these knots, relative to itself (sums of positive terms).
#[inline(always)]
pub(crate) fn basis<const CAPACITY: usize, const SECOND: bool, T: Number>(
    knots: &KnotVector,
    p: usize,
    span: usize,
    t: T,
) -> Basis<CAPACITY, T> {
    debug_assert!(p < CAPACITY && p == knots.degree());
    let u = &knots.knots()[span + 1 - p..=span + p];
    let reciprocal = knots.span_reciprocals(span);
    triangle::<CAPACITY, SECOND, T>(p, |i| T::splat(u[i]) - t, |i| reciprocal[i])
}

/// As [`basis`], at `t` in 0 to 1 of the span: derivatives are by the knots' own parameter all the same.
///
/// Knots count from the span's first and in units of its length, so that neither a domain far from zero nor a short span
/// takes a digit from `t`: a knot difference is rounded three times, to half an ulp of itself. Each value is within 5 p ulp.
#[inline(always)]
pub(crate) fn basis_local<const CAPACITY: usize, const SECOND: bool>(
    knots: &KnotVector,
    p: usize,
    span: usize,
    t: f64,
) -> Basis<CAPACITY> {
    debug_assert!(p < CAPACITY && p == knots.degree());
    let (start, length) = knots.span(span);
    let u = &knots.knots()[span + 1 - p..=span + p];
    let reciprocal = knots.span_reciprocals(span);
    // Column 1 of the triangle has one difference, the span's own length.
    let inverse = reciprocal[0];
    let mut basis = triangle::<CAPACITY, SECOND, f64>(p, |i| (u[i] - start) * inverse - t, |i| reciprocal[i] * length);
    for r in 0..p + 1 {
        basis.first[r] *= inverse;
        if SECOND {
            // Not by the square, which may leave f64 where the product does not.
            basis.second[r] = basis.second[r] * inverse * inverse;
        }
    }
    basis
}

/// The inverse triangle: `ahead` is by how much each of the 2 p knots about the span exceeds the parameter, `reciprocal`
/// those of the knot differences, by column and row, in the same unit.
///
/// Piegl & Tiller, A2.2, with reciprocals of the knot differences from the knot vector. The terms N / (U − U) of
/// column p are the terms of their Eq. (2.7), so N' costs one subtraction; column p − 1 gives N'' likewise.
/// (Kanai's English Eq. (6) prints a plus sign between the two terms; the Japanese text has the minus.)
///
/// Ranges here and in the sums of `surface` are half-open: of a constant degree such loops are unrolled, others are not.
#[inline(always)]
fn triangle<const CAPACITY: usize, const SECOND: bool, T: Number>(
    p: usize,
    ahead: impl Fn(usize) -> T,
    reciprocal: impl Fn(usize) -> f64,
) -> Basis<CAPACITY, T> {
    let zero = T::splat(0.0);
    let mut value = [zero; CAPACITY];
    let mut first = [zero; CAPACITY];
    let mut second = [zero; CAPACITY];
    let mut term = [zero; CAPACITY];
    value[0] = T::splat(1.0);
    let mut column = 0;
    for j in 1..p + 1 {
        let mut saved = zero;
        for r in 0..j {
            // right[r+1] = U[span+r+1] − t, left[j−r] = t − U[span+1−j+r]
            term[r] = value[r] * reciprocal(column + r);
            value[r] = saved + ahead(p + r) * term[r];
            saved = -ahead(p + r - j) * term[r];
        }
        value[j] = saved;
        column += j;
        if SECOND && j + 1 == p {
            differences(&term, j, &mut second);
        }
    }
    differences(&term, p, &mut first);
    if SECOND && p >= 2 {
        // second holds N' of degree p − 1; apply Eq. (2.7) once more, with the reciprocals of the last column.
        let last = column - p;
        let mut carried = zero;
        for r in 0..p {
            let scaled = second[r] * reciprocal(last + r);
            second[r] = (carried - scaled) * p as f64;
            carried = scaled;
        }
        second[p] = carried * p as f64;
    }
    Basis { value, first, second }
}

/// N'_{r} = p (term_{r−1} − term_r) for r = 0..=p (Piegl & Tiller, Eq. 2.7).
#[inline(always)]
fn differences<const CAPACITY: usize, T: Number>(term: &[T; CAPACITY], p: usize, out: &mut [T; CAPACITY]) {
    let scale = p as f64;
    out[0] = term[0] * -scale;
    for r in 1..p {
        out[r] = (term[r - 1] - term[r]) * scale;
    }
    out[p] = term[p - 1] * scale;
}

/// All derivatives to `order` of the p + 1 basis functions of `span` at `t`: `result[k][r]`.
///
/// Piegl & Tiller, A2.3. Rows above p are zero. Independent of the inverse triangle, which it checks.
pub fn basis_derivatives(knots: &KnotVector, span: usize, t: f64, order: usize) -> Vec<[f64; MAX_ORDER]> {
    let u = knots.knots();
    general(knots.degree(), span, order, |i| u[i] - t, |i, j| u[j] - u[i])
}

/// As [`basis_derivatives`], at `t` in 0 to 1 of the span and by that parameter: the k-th derivatives are those by the
/// knots' own parameter times the k-th power of the span's length.
pub(crate) fn basis_derivatives_local(knots: &KnotVector, span: usize, t: f64, order: usize) -> Vec<[f64; MAX_ORDER]> {
    let u = knots.knots();
    let (start, length) = knots.span(span);
    general(knots.degree(), span, order, |i| (u[i] - start) / length - t, |i, j| (u[j] - u[i]) / length)
}

/// The general algorithm: `ahead` is by how much knot i exceeds the parameter, `between` how far knot j is from knot i.
fn general(
    p: usize,
    span: usize,
    order: usize,
    ahead: impl Fn(usize) -> f64,
    between: impl Fn(usize, usize) -> f64,
) -> Vec<[f64; MAX_ORDER]> {
    let mut left = [0.0; MAX_ORDER];
    let mut right = [0.0; MAX_ORDER];
    let mut ndu = [[0.0; MAX_ORDER]; MAX_ORDER];
    ndu[0][0] = 1.0;
    for j in 1..=p {
        left[j] = -ahead(span + 1 - j);
        right[j] = ahead(span + j);
        let mut saved = 0.0;
        for r in 0..j {
            ndu[j][r] = between(span + 1 + r - j, span + r + 1);
            let term = ndu[r][j - 1] / ndu[j][r];
            ndu[r][j] = saved + right[r + 1] * term;
            saved = left[j - r] * term;
        }
        ndu[j][j] = saved;
    }
    let mut ders = vec![[0.0; MAX_ORDER]; order + 1];
    for (r, row) in ndu.iter().enumerate().take(p + 1) {
        ders[0][r] = row[p];
    }
    for r in 0..=p {
        let mut a = [[0.0; MAX_ORDER]; 2];
        let (mut s1, mut s2) = (0, 1);
        a[0][0] = 1.0;
        for k in 1..=order.min(p) {
            let mut d = 0.0;
            let pk = p - k;
            if r >= k {
                a[s2][0] = a[s1][0] / ndu[pk + 1][r - k];
                d = a[s2][0] * ndu[r - k][pk];
            }
            let j1 = if r + 1 >= k { 1 } else { k - r };
            let j2 = if r <= pk + 1 { k - 1 } else { p - r };
            for j in j1..=j2 {
                a[s2][j] = (a[s1][j] - a[s1][j - 1]) / ndu[pk + 1][r + j - k];
                d += a[s2][j] * ndu[r + j - k][pk];
            }
            if r <= pk {
                a[s2][k] = -a[s1][k - 1] / ndu[pk + 1][r];
                d += a[s2][k] * ndu[r][pk];
            }
            ders[k][r] = d;
            std::mem::swap(&mut s1, &mut s2);
        }
    }
    let mut factor = 1.0;
    for (k, row) in ders.iter_mut().enumerate().skip(1).take(p) {
        factor *= (p + 1 - k) as f64;
        row.iter_mut().for_each(|d| *d *= factor);
    }
    ders
}

/// n over k, exact for the small orders of derivatives.
pub(crate) fn binomial(n: usize, k: usize) -> f64 {
    (0..k).fold(1.0, |b, i| b * (n - i) as f64 / (i + 1) as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// A legal knot vector of degree `p` from span lengths and multiplicities.
    fn knots(p: usize, steps: &[(f64, usize)], clamped: bool) -> KnotVector {
        let mut u = vec![];
        let mut t = -1.0;
        for i in 0..=p {
            u.push(if clamped { t } else { t - (p - i) as f64 * 0.3 });
        }
        for &(step, multiplicity) in steps {
            t += step;
            u.extend(std::iter::repeat_n(t, multiplicity.clamp(1, p)));
        }
        t += 0.7;
        for i in 0..=p {
            u.push(if clamped { t } else { t + i as f64 * 0.9 });
        }
        KnotVector::new(p, u).unwrap()
    }

    proptest! {
        #[test]
        fn inverse_triangle_agrees_with_the_general_algorithm(
            p in 1usize..=15,
            steps in prop::collection::vec((0.01f64..2.0, 1usize..16), 0..6),
            clamped: bool,
            x in 0.0f64..=1.0,
        ) {
            let knots = knots(p, &steps, clamped);
            let (start, end) = knots.domain();
            let t = start + (end - start) * x;
            let span = knots.find_span(t);
            let fast = basis::<MAX_ORDER, true, f64>(&knots, p, span, t);
            let general = basis_derivatives(&knots, span, t, 2);
            let rows = [fast.value, fast.first, fast.second];
            for k in 0..3 {
                let scale = general[k].iter().fold(1.0, |m: f64, d| m.max(d.abs()));
                for r in 0..=p {
                    prop_assert!((rows[k][r] - general[k][r]).abs() <= 1e-12 * scale, "order {k}, function {r}");
                }
                let sum: f64 = rows[k][..=p].iter().sum();
                let unity = f64::from(u8::from(k == 0));
                prop_assert!((sum - unity).abs() <= 1e-12 * scale);
            }
        }
    }
}
