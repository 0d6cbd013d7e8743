//! Tensor-product NURBS surfaces: construction, evaluation, refinement.

use crate::basis::{Basis, basis, basis_derivatives_local, basis_local, binomial};
use crate::blossom::{bezier_points, reexpress};
use crate::hull::Hull;
use crate::weights::checked_weights;
use crate::{BezierPatch, FirstDerivatives, KnotVector, MAX_ORDER, NurbsError, SecondDerivatives, basis_derivatives};
use glam::{DVec2, DVec3, DVec4};

/// The largest coordinate that is accepted, in model units: squares and products of four stay finite.
const GREATEST_COORDINATE: f64 = 1e60;

/// One of the two parameter directions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Direction {
    /// The first parameter.
    U,
    /// The second parameter.
    V,
}

/// A NURBS surface of degree p × q over n_u × n_v control points.
///
/// Points are Euclidean and row-major in u: index `i * n_v + j`. Evaluation works about the surface's own origin
/// (the centre of its control box), so that a surface far from the world's origin loses nothing in its derivatives.
#[derive(Debug, Clone, PartialEq)]
pub struct Surface {
    knots: [KnotVector; 2],
    points: Vec<DVec3>,
    weights: Option<Vec<f64>>,
    hull: Hull,
    origin: DVec3,
    /// (w (P − origin), w).
    local: Vec<[f64; 4]>,
}

impl Surface {
    /// Builds a surface from Euclidean points and, where it is rational, their weights.
    ///
    /// # Errors
    /// [`NurbsError::PointCount`], [`NurbsError::PointNotFinite`], [`NurbsError::WeightCount`], [`NurbsError::Weight`].
    pub fn new(
        knots_u: KnotVector,
        knots_v: KnotVector,
        points: Vec<DVec3>,
        weights: Option<Vec<f64>>,
    ) -> Result<Self, NurbsError> {
        let expected = knots_u.control_count() * knots_v.control_count();
        if points.len() != expected {
            return Err(NurbsError::PointCount { expected, found: points.len() });
        }
        if let Some(index) = points.iter().position(|p| !p.to_array().into_iter().all(usable)) {
            let value = points[index].to_array().into_iter().find(|&x| !usable(x)).expect("one is not usable");
            return Err(NurbsError::PointNotFinite { index, value });
        }
        let weights = weights.map(|weights| checked_weights(weights, expected)).transpose()?;
        let hull = Hull::of(points.iter().copied());
        let center = hull.center();
        let local = points
            .iter()
            .enumerate()
            .map(|(i, &p)| {
                let w = weights.as_ref().map_or(1.0, |w| w[i]);
                ((p - center) * w).extend(w).to_array()
            })
            .collect();
        Ok(Self { knots: [knots_u, knots_v], points, weights, hull, origin: center, local })
    }

    /// The part of it over a range of one parameter, with the same parameters, clamped at both ends of that: see
    /// [`restricted`](crate::restricted).
    ///
    /// # Errors
    /// [`NurbsError::EmptyDomain`], [`NurbsError::OutsideDomain`].
    pub fn restricted(&self, direction: Direction, range: [f64; 2]) -> Result<Self, NurbsError> {
        let [rows, columns] = self.control_counts();
        let weight = |i: usize| self.weights.as_ref().map_or(1.0, |w| w[i]);
        let point = |i: usize| (self.points[i] * weight(i)).extend(weight(i));
        let lines: Vec<Vec<DVec4>> = match direction {
            Direction::U => (0..columns).map(|j| (0..rows).map(|i| point(i * columns + j)).collect()).collect(),
            Direction::V => (0..rows).map(|i| (0..columns).map(|j| point(i * columns + j)).collect()).collect(),
        };
        let mut knots = self.knots.clone();
        let own = &mut knots[direction as usize];
        let parts = lines.iter().map(|line| crate::restricted(self.knots(direction), line, range));
        let parts = parts.collect::<Result<Vec<_>, _>>()?;
        *own = parts[0].0.clone();
        let along = own.control_count();
        let at = |i: usize, j: usize| match direction {
            Direction::U => parts[j].1[i],
            Direction::V => parts[i].1[j],
        };
        let [rows, columns] = if direction == Direction::U { [along, columns] } else { [rows, along] };
        let all = (0..rows).flat_map(|i| (0..columns).map(move |j| [i, j])).map(|[i, j]| at(i, j));
        let (points, weights) = all.map(|a| (a.truncate() / a.w, a.w)).unzip();
        let [u, v] = knots;
        Self::new(u, v, points, self.weights.as_ref().map(|_| weights))
    }

    /// The same surface with control point (i, j) at `point`; its weight stays.
    ///
    /// # Errors
    /// [`NurbsError::PointNotFinite`].
    ///
    /// # Panics
    /// Where there is no such control point.
    pub fn with_point(&self, [i, j]: [usize; 2], point: DVec3) -> Result<Self, NurbsError> {
        let [rows, columns] = self.control_counts();
        assert!(i < rows && j < columns, "control point ({i}, {j}) of {rows} × {columns}");
        let mut points = self.points.clone();
        points[i * columns + j] = point;
        let [u, v] = self.knots.clone();
        Self::new(u, v, points, self.weights.clone())
    }

    /// The knot vector of a direction.
    pub fn knots(&self, direction: Direction) -> &KnotVector {
        &self.knots[direction as usize]
    }

    /// Degrees in u and v.
    pub fn degree(&self) -> [usize; 2] {
        [self.knots[0].degree(), self.knots[1].degree()]
    }

    /// Numbers of control points in u and v.
    pub fn control_counts(&self) -> [usize; 2] {
        [self.knots[0].control_count(), self.knots[1].control_count()]
    }

    /// Euclidean control points, row-major in u.
    pub fn points(&self) -> &[DVec3] {
        &self.points
    }

    /// Weights, in the order of the points; `None` for a polynomial surface.
    ///
    /// Where the greatest given one was above 2¹⁰⁰ or below 2⁻¹⁰⁰ all are divided by a power of two that makes it 1 to 2.
    pub fn weights(&self) -> Option<&[f64]> {
        self.weights.as_deref()
    }

    /// The domain \[\[u0, u1\], \[v0, v1\]\].
    pub fn domain(&self) -> [[f64; 2]; 2] {
        [&self.knots[0], &self.knots[1]].map(|k| [k.domain().0, k.domain().1])
    }

    /// The world position about which evaluation works: the centre of the control points' box.
    pub fn origin(&self) -> DVec3 {
        self.origin
    }

    /// Homogeneous control points about [`Self::origin`], (w x, w y, w z, w), row-major in u.
    pub fn homogeneous(&self) -> &[[f64; 4]] {
        &self.local
    }

    /// The box of the control points, which holds the surface.
    pub fn hull(&self) -> Hull {
        self.hull
    }

    /// S(u, v). Outside the domain the outermost polynomial is extrapolated.
    pub fn point(&self, u: f64, v: f64) -> DVec3 {
        self.first_derivatives(u, v).s
    }

    /// S, S_u and S_v (Piegl & Tiller, A3.6 and A4.4 to first order).
    ///
    /// At a knot the limit from above, at the end of the domain from below. Error: S within 1e-15 of the size of
    /// the control box plus half an ulp of its own coordinates, the derivatives within 1e-13 of the largest
    /// derivative of the net (measured against 50-digit arithmetic: `tests/conformance/evaluation.rs`).
    #[inline]
    pub fn first_derivatives(&self, u: f64, v: f64) -> FirstDerivatives {
        let (span_u, span_v) = (self.knots[0].find_span(u), self.knots[1].find_span(v));
        self.first_derivatives_on(span_u, span_v, u, v)
    }

    /// As [`Self::first_derivatives`], with the polynomial of a given nonempty span instead of the parameter's own.
    #[inline]
    pub fn first_derivatives_on(&self, span_u: usize, span_v: usize, u: f64, v: f64) -> FirstDerivatives {
        match self.degree() {
            [3, 3] => self.first_at::<4>(3, 3, [span_u, span_v], [u, v]),
            [2, 2] => self.first_at::<3>(2, 2, [span_u, span_v], [u, v]),
            [p, q] => self.first_at::<MAX_ORDER>(p, q, [span_u, span_v], [u, v]),
        }
    }

    /// S at `t` in 0 to 1 of a nonempty span in each direction, as [`Self::first_derivatives_local`].
    pub fn point_local(&self, span: [usize; 2], t: DVec2) -> DVec3 {
        self.first_derivatives_local(span, t).s
    }

    /// As [`Self::first_derivatives_on`] at u = U\[k\] + t (U\[k+1\] − U\[k\]), k the span, and v likewise, but u is
    /// never formed: knots count from U\[k\] in units of the span's length.
    ///
    /// So nothing is lost where the domain is far from zero (knots from 1e9 to 1e9 + 1e-3) or a span is short. The
    /// derivatives are by u and v all the same. Error as [`Self::first_derivatives`], at every `t` exactly.
    #[inline]
    pub fn first_derivatives_local(&self, span: [usize; 2], t: DVec2) -> FirstDerivatives {
        match self.degree() {
            [3, 3] => self.first_local::<4>(3, 3, span, t),
            [2, 2] => self.first_local::<3>(2, 2, span, t),
            [p, q] => self.first_local::<MAX_ORDER>(p, q, span, t),
        }
    }

    /// S and all derivatives to second order. Conventions and error as [`Self::first_derivatives`].
    pub fn second_derivatives(&self, u: f64, v: f64) -> SecondDerivatives {
        let (span_u, span_v) = (self.knots[0].find_span(u), self.knots[1].find_span(v));
        self.second_derivatives_on(span_u, span_v, u, v)
    }

    /// As [`Self::second_derivatives`], with the polynomial of a given nonempty span.
    pub fn second_derivatives_on(&self, span_u: usize, span_v: usize, u: f64, v: f64) -> SecondDerivatives {
        match self.degree() {
            [3, 3] => self.second_at::<4>(3, 3, [span_u, span_v], [u, v]),
            [p, q] => self.second_at::<MAX_ORDER>(p, q, [span_u, span_v], [u, v]),
        }
    }

    /// S and all derivatives to second order, by u and v, at `t` in 0 to 1 of a nonempty span in each direction, without
    /// forming u and v: see [`Self::first_derivatives_local`].
    pub fn second_derivatives_local(&self, span: [usize; 2], t: DVec2) -> SecondDerivatives {
        match self.degree() {
            [3, 3] => self.second_local::<4>(3, 3, span, t),
            [p, q] => self.second_local::<MAX_ORDER>(p, q, span, t),
        }
    }

    #[inline(always)]
    fn first_at<const C: usize>(&self, p: usize, q: usize, span: [usize; 2], [u, v]: [f64; 2]) -> FirstDerivatives {
        let nu = basis::<C, false, f64>(&self.knots[0], p, span[0], u);
        let nv = basis::<C, false, f64>(&self.knots[1], q, span[1], v);
        self.first_order(p, q, span, &nu, &nv)
    }

    #[inline(always)]
    fn first_local<const C: usize>(&self, p: usize, q: usize, span: [usize; 2], t: DVec2) -> FirstDerivatives {
        let nu = basis_local::<C, false>(&self.knots[0], p, span[0], t.x);
        let nv = basis_local::<C, false>(&self.knots[1], q, span[1], t.y);
        self.first_order(p, q, span, &nu, &nv)
    }

    #[inline(always)]
    fn second_at<const C: usize>(&self, p: usize, q: usize, span: [usize; 2], [u, v]: [f64; 2]) -> SecondDerivatives {
        let nu = basis::<C, true, f64>(&self.knots[0], p, span[0], u);
        let nv = basis::<C, true, f64>(&self.knots[1], q, span[1], v);
        self.second_order(p, q, span, &nu, &nv)
    }

    #[inline(always)]
    fn second_local<const C: usize>(&self, p: usize, q: usize, span: [usize; 2], t: DVec2) -> SecondDerivatives {
        let nu = basis_local::<C, true>(&self.knots[0], p, span[0], t.x);
        let nv = basis_local::<C, true>(&self.knots[1], q, span[1], t.y);
        self.second_order(p, q, span, &nu, &nv)
    }

    #[inline(always)]
    fn first_order<const C: usize>(
        &self,
        p: usize,
        q: usize,
        [span_u, span_v]: [usize; 2],
        nu: &Basis<C>,
        nv: &Basis<C>,
    ) -> FirstDerivatives {
        let [mut a, mut a_u, mut a_v] = [[0.0; 4]; 3];
        let columns = self.knots[1].control_count();
        let first = (span_u - p) * columns + span_v - q;
        let net = &self.local[first..first + p * columns + q + 1];
        // Two components at a time, so that all running sums stay in registers.
        for half in [0, 2] {
            let [mut sum, mut sum_u, mut sum_v] = [[0.0; 2]; 3];
            for i in 0..p + 1 {
                let points = &net[i * columns..][..q + 1];
                let [mut row, mut row_v] = [[0.0; 2]; 2];
                for j in 0..q + 1 {
                    let c = [points[j][half], points[j][half + 1]];
                    add_scaled(&mut row, nv.value[j], &c);
                    add_scaled(&mut row_v, nv.first[j], &c);
                }
                add_scaled(&mut sum, nu.value[i], &row);
                add_scaled(&mut sum_u, nu.first[i], &row);
                add_scaled(&mut sum_v, nu.value[i], &row_v);
            }
            a[half..half + 2].copy_from_slice(&sum);
            a_u[half..half + 2].copy_from_slice(&sum_u);
            a_v[half..half + 2].copy_from_slice(&sum_v);
        }
        let [a, a_u, a_v] = [a, a_u, a_v].map(DVec4::from_array);
        if self.weights.is_none() {
            return FirstDerivatives { s: self.origin + a.truncate(), su: a_u.truncate(), sv: a_v.truncate() };
        }
        FirstDerivatives::from_homogeneous(self.origin, a, a_u, a_v)
    }

    #[inline(always)]
    fn second_order<const C: usize>(
        &self,
        p: usize,
        q: usize,
        [span_u, span_v]: [usize; 2],
        nu: &Basis<C>,
        nv: &Basis<C>,
    ) -> SecondDerivatives {
        let mut sums = [[0.0; 4]; 6];
        let columns = self.knots[1].control_count();
        let first = (span_u - p) * columns + span_v - q;
        let net = &self.local[first..first + p * columns + q + 1];
        // As in [`Self::first_order`].
        for half in [0, 2] {
            let [mut sum, mut sum_u, mut sum_v, mut sum_uu, mut sum_uv, mut sum_vv] = [[0.0; 2]; 6];
            for i in 0..p + 1 {
                let points = &net[i * columns..][..q + 1];
                let [mut row, mut row_v, mut row_vv] = [[0.0; 2]; 3];
                for j in 0..q + 1 {
                    let c = [points[j][half], points[j][half + 1]];
                    add_scaled(&mut row, nv.value[j], &c);
                    add_scaled(&mut row_v, nv.first[j], &c);
                    add_scaled(&mut row_vv, nv.second[j], &c);
                }
                add_scaled(&mut sum, nu.value[i], &row);
                add_scaled(&mut sum_u, nu.first[i], &row);
                add_scaled(&mut sum_v, nu.value[i], &row_v);
                add_scaled(&mut sum_uu, nu.second[i], &row);
                add_scaled(&mut sum_uv, nu.first[i], &row_v);
                add_scaled(&mut sum_vv, nu.value[i], &row_vv);
            }
            for (all, part) in sums.iter_mut().zip([sum, sum_u, sum_v, sum_uu, sum_uv, sum_vv]) {
                all[half..half + 2].copy_from_slice(&part);
            }
        }
        let [a, a_u, a_v, a_uu, a_uv, a_vv] = sums.map(DVec4::from_array);
        // Piegl & Tiller, Eq. (4.20).
        let w = 1.0 / a.w;
        let s = a.truncate() * w;
        let su = (a_u.truncate() - s * a_u.w) * w;
        let sv = (a_v.truncate() - s * a_v.w) * w;
        let suu = (a_uu.truncate() - 2.0 * a_u.w * su - a_uu.w * s) * w;
        let suv = (a_uv.truncate() - a_u.w * sv - a_v.w * su - a_uv.w * s) * w;
        let svv = (a_vv.truncate() - 2.0 * a_v.w * sv - a_vv.w * s) * w;
        SecondDerivatives { s: self.origin + s, su, sv, suu, suv, svv }
    }

    /// All mixed derivatives to `order` in total: `result[k][l]` = ∂^{k+l} S / ∂u^k ∂v^l for k + l ≤ `order`.
    ///
    /// Piegl & Tiller, A3.6 with A2.3, then A4.4. Independent of the second-order evaluators, which it checks.
    pub fn derivatives(&self, u: f64, v: f64, order: usize) -> Vec<Vec<DVec3>> {
        let (span_u, span_v) = (self.knots[0].find_span(u), self.knots[1].find_span(v));
        let nu = basis_derivatives(&self.knots[0], span_u, u, order);
        let nv = basis_derivatives(&self.knots[1], span_v, v, order);
        self.mixed([span_u, span_v], [&nu, &nv], order)
    }

    /// As [`Self::derivatives`] at `t` in 0 to 1 of a nonempty span in each direction, and by `t`.
    pub(crate) fn derivatives_by_local(&self, span: [usize; 2], t: DVec2, order: usize) -> Vec<Vec<DVec3>> {
        let nu = basis_derivatives_local(&self.knots[0], span[0], t.x, order);
        let nv = basis_derivatives_local(&self.knots[1], span[1], t.y, order);
        self.mixed(span, [&nu, &nv], order)
    }

    fn mixed(&self, [span_u, span_v]: [usize; 2], [nu, nv]: [&[[f64; MAX_ORDER]]; 2], order: usize) -> Vec<Vec<DVec3>> {
        let [p, q] = self.degree();
        let homogeneous = |k: usize, l: usize| {
            let mut sum = [0.0; 4];
            for (i, &by_u) in nu[k].iter().enumerate().take(p + 1) {
                for (j, c) in self.row(span_u - p + i, span_v - q, q).iter().enumerate() {
                    add_scaled(&mut sum, by_u * nv[l][j], c);
                }
            }
            DVec4::from_array(sum)
        };
        let mut table = vec![vec![DVec3::ZERO; order + 1]; order + 1];
        let numerators: Vec<Vec<DVec4>> =
            (0..=order).map(|k| (0..=order - k).map(|l| homogeneous(k, l)).collect()).collect();
        for k in 0..=order {
            for l in 0..=order - k {
                let mut x = numerators[k][l].truncate();
                for i in 0..=k {
                    for j in 0..=l {
                        if i + j > 0 {
                            x -= binomial(k, i) * binomial(l, j) * numerators[i][j].w * table[k - i][l - j];
                        }
                    }
                }
                table[k][l] = x / numerators[0][0].w;
            }
        }
        table[0][0] += self.origin;
        table
    }

    #[inline(always)]
    fn row(&self, i: usize, j: usize, q: usize) -> &[[f64; 4]] {
        let start = i * self.knots[1].control_count() + j;
        &self.local[start..=start + q]
    }

    /// The Bézier patches of all nonempty spans, u outer, v inner.
    pub fn bezier_patches(&self) -> Vec<BezierPatch> {
        let [ku, kv] = &self.knots;
        ku.spans().flat_map(|k| kv.spans().map(move |l| self.bezier_patch([k, l]))).collect()
    }

    /// The Bézier patch of a nonempty span (Piegl & Tiller, Sec. 5.3, here by blossoms).
    pub fn bezier_patch(&self, [k, l]: [usize; 2]) -> BezierPatch {
        let [p, q] = self.degree();
        let [ku, kv] = &self.knots;
        let [u, v] = [[ku.knots()[k], ku.knots()[k + 1]], [kv.knots()[l], kv.knots()[l + 1]]];
        // First along v in each of the p + 1 rows, then along u.
        let rows: Vec<Vec<DVec4>> = (0..=p)
            .map(|i| {
                let row: Vec<DVec4> = self.row(k - p + i, l - q, q).iter().map(|&c| DVec4::from_array(c)).collect();
                bezier_points(kv, l, &row, v)
            })
            .collect();
        let mut control = vec![DVec4::ZERO; (p + 1) * (q + 1)];
        for j in 0..=q {
            let column: Vec<DVec4> = rows.iter().map(|row| row[j]).collect();
            for (i, point) in bezier_points(ku, k, &column, u).into_iter().enumerate() {
                control[i * (q + 1) + j] = point;
            }
        }
        BezierPatch { degree: [p, q], domain: [u, v], origin: self.origin, control }
    }

    /// The box of the control points of a span, which holds the surface there.
    pub fn span_hull(&self, [k, l]: [usize; 2]) -> Hull {
        let [p, q] = self.degree();
        let columns = self.knots[1].control_count();
        Hull::of((k - p..=k).flat_map(|i| &self.points[i * columns + l - q..=i * columns + l]).copied())
    }

    /// The same surface with `values` inserted as knots (Piegl & Tiller, A5.4 by blossoms).
    ///
    /// # Errors
    /// [`NurbsError::OutsideDomain`]; [`NurbsError::Multiplicity`] where a knot would exceed multiplicity p.
    pub fn refined(&self, direction: Direction, values: &[f64]) -> Result<Self, NurbsError> {
        let knots = self.knots(direction);
        let (start, end) = knots.domain();
        if let Some(&value) = values.iter().find(|&&t| !(start < t && t < end)) {
            return Err(NurbsError::OutsideDomain { value, start, end });
        }
        let mut finer = [knots.knots(), values].concat();
        finer.sort_by(f64::total_cmp);
        Ok(self.reexpressed(direction, KnotVector::new(knots.degree(), finer)?))
    }

    /// The same surface with the degree of one direction raised by one (Piegl & Tiller, A5.9 by blossoms).
    ///
    /// # Errors
    /// [`NurbsError::Degree`] at the cap.
    pub fn elevated(&self, direction: Direction) -> Result<Self, NurbsError> {
        let knots = self.knots(direction);
        let mut raised = Vec::with_capacity(knots.knots().len() * 2);
        let (start, end) = knots.domain();
        for run in knots.knots().chunk_by(|a, b| a == b) {
            raised.extend_from_slice(run);
            raised.push(run[0]);
        }
        // An unclamped vector gains more than one knot outside each end of the domain: drop what is superfluous.
        let p = knots.degree() + 1;
        let first = raised.iter().rposition(|&k| k <= start).expect("the domain starts at a knot") - p;
        let last = raised.iter().position(|&k| k >= end).expect("the domain ends at a knot") + p;
        Ok(self.reexpressed(direction, KnotVector::new(p, raised[first..=last].to_vec())?))
    }

    fn reexpressed(&self, direction: Direction, finer: KnotVector) -> Self {
        let [nu, nv] = self.control_counts();
        let knots = self.knots(direction);
        let at = |i: usize, j: usize| DVec4::from_array(self.local[i * nv + j]);
        let mut lines: Vec<Vec<DVec4>> = match direction {
            Direction::U => (0..nv).map(|j| (0..nu).map(|i| at(i, j)).collect()).collect(),
            Direction::V => (0..nu).map(|i| (0..nv).map(|j| at(i, j)).collect()).collect(),
        };
        for line in &mut lines {
            *line = reexpress(knots, line, &finer);
        }
        let count = finer.control_count();
        let homogeneous: Vec<DVec4> = match direction {
            Direction::U => (0..count).flat_map(|i| lines.iter().map(move |line| line[i])).collect(),
            Direction::V => lines.into_iter().flatten().collect(),
        };
        let mut vectors = self.knots.clone();
        vectors[direction as usize] = finer;
        self.with_control(vectors, &homogeneous)
    }

    fn with_control(&self, knots: [KnotVector; 2], homogeneous: &[DVec4]) -> Self {
        let points: Vec<DVec3> = homogeneous.iter().map(|c| self.origin + c.truncate() / c.w).collect();
        let weights = self.weights.as_ref().map(|_| homogeneous.iter().map(|c| c.w).collect());
        let local = homogeneous.iter().map(|c| c.to_array()).collect();
        let hull = Hull::of(points.iter().copied());
        Self { knots, points, weights, hull, origin: self.origin, local }
    }

    /// The two parts of the surface below and above parameter `t` of a direction.
    ///
    /// # Errors
    /// [`NurbsError::OutsideDomain`] unless `t` lies inside the open domain.
    pub fn split(&self, direction: Direction, t: f64) -> Result<[Self; 2], NurbsError> {
        let p = self.knots(direction).degree();
        let missing = p - self.knots(direction).multiplicity(t).min(p);
        let full = self.refined(direction, &vec![t; missing])?;
        let (start, end) = full.knots(direction).domain();
        if !(start < t && t < end) {
            return Err(NurbsError::OutsideDomain { value: t, start, end });
        }
        let knots = full.knots(direction).knots();
        let first = knots.partition_point(|&k| k < t);
        let low = [&knots[..first + p], &[t]].concat();
        let high = [&[t], &knots[first..]].concat();
        let [nu, nv] = full.control_counts();
        let part = |knots: Vec<f64>, keep: std::ops::Range<usize>| {
            let mut vectors = full.knots.clone();
            vectors[direction as usize] = KnotVector::new(p, knots)?;
            let mut control = vec![];
            for i in 0..nu {
                for j in 0..nv {
                    if keep.contains(&if direction == Direction::U { i } else { j }) {
                        control.push(DVec4::from_array(full.local[i * nv + j]));
                    }
                }
            }
            Ok(full.with_control(vectors, &control))
        };
        let count = full.knots(direction).control_count();
        // The control point on the cut, interpolated because its p knots are all t.
        let shared = first - 1;
        Ok([part(low, 0..shared + 1)?, part(high, shared..count)?])
    }
}

/// Whether a coordinate is finite and small enough for products of four.
pub(crate) fn usable(x: f64) -> bool {
    x.abs() <= GREATEST_COORDINATE
}

#[inline(always)]
fn add_scaled<const N: usize>(sum: &mut [f64; N], scale: f64, x: &[f64; N]) {
    for c in 0..N {
        sum[c] += scale * x[c];
    }
}
