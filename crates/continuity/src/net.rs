//! A control net evaluated at functions instead of numbers: positions and derivatives along a curve, with a proof.
//!
//! A [`Net`] is a Bézier patch or, of one row, a Bézier curve. At (u(τ), v(τ)) its polynomial is expanded about the middles of
//! u and v, where the expansion is finite and exact; the rest is arithmetic of [`Taylor`].
//!
//! **Rounding.** With M the greatest control coordinate and 2⁻⁵³ = ε: the net itself is off by [`Net::error`]; de Casteljau's
//! algorithm in both directions by 3 (p + q) ε M, as its steps are convex; k-th differences by (k + 1) ε of 2^k M. A coefficient
//! of degree k is a k-th difference times a binomial, on a half that is at least half as long: so an error e of the points
//! becomes at most C(n, k) 4^k e, and Σ C(n, k) 4^k h^k = (1 + 4 h)^n where |u − u_0| ≤ h.

use crate::taylor::{Sum, Taylor, UNIT, Vector, cross, difference, dot, sum, times};
use nurbs::MAX_DEGREE;

/// A parameter may leave 0 … 1 by this much, as curves along a border do by rounding: the polynomial goes on there.
const BEYOND: f64 = 1e-3;

/// A term below this share of what rounding leaves anyway is counted as an error: 256 of them make it four times as large.
const SMALL: f64 = 1.0 / 64.0;

/// A Bézier patch, or curve, on 0 … 1.
#[derive(Debug, Clone)]
pub struct Net {
    degree: [usize; 2],
    control: Vec<[f64; 4]>,
    error: [f64; 4],
    is_rational: bool,
}

/// Position and derivatives by u and v as functions of τ.
#[derive(Debug, Clone, Copy)]
pub struct Jet {
    /// S.
    pub s: Vector,
    /// S_u.
    pub su: Vector,
    /// S_v.
    pub sv: Vector,
    /// S_uu.
    pub suu: Vector,
    /// S_uv.
    pub suv: Vector,
    /// S_vv.
    pub svv: Vector,
}

/// The orders by u and v of the six homogeneous derivatives.
const ORDERS: [[usize; 2]; 6] = [[0, 0], [1, 0], [0, 1], [2, 0], [1, 1], [0, 2]];

impl Net {
    /// A net of (p + 1)(q + 1) homogeneous points (w x, w y, w z, w), row-major in u. Each coordinate is within `error` of
    /// the one that is meant.
    pub fn new(degree: [usize; 2], control: Vec<[f64; 4]>, error: [f64; 4]) -> Self {
        let is_rational = control.iter().any(|c| c[3] != 1.0);
        let count = degree.iter().sum::<usize>() as f64;
        let error = std::array::from_fn(|axis| {
            let most = control.iter().fold(0.0, |most: f64, c| most.max(c[axis].abs()));
            (error[axis] + (5.0 * count + 8.0) * UNIT * most) * (1.0 + 1e-12)
        });
        Self { degree, control, error, is_rational }
    }

    /// Position and derivatives to the second order at (u(τ), v(τ)); `None` where a parameter is far from 0 … 1 or a weight's
    /// bound reaches nought.
    pub fn jet(&self, u: Taylor, v: Taylor) -> Option<Jet> {
        let [p, q] = self.degree;
        let at = [u.middle(), v.middle()];
        let beyond = at.map(|t| (-t).max(t - 1.0).max(0.0));
        let is_near = beyond.iter().all(|b| *b <= BEYOND);
        if !is_near {
            return None;
        }
        let steps = [u.plus(-at[0]), v.plus(-at[1])];
        let reach = steps.map(|step| step.magnitude());
        let expansion = self.expansion(at, reach);
        let powers = [powers(steps[0], reach[0], p), powers(steps[1], reach[1], q)];
        // What does not move has the nought-th power alone.
        let count = [0, 1].map(|axis| if reach[axis] <= f64::MIN_POSITIVE { 1 } else { self.degree[axis] + 1 });
        let mut products = [[Taylor::ZERO; MAX_DEGREE + 1]; MAX_DEGREE + 1];
        let mut sizes = [[0.0; MAX_DEGREE + 1]; MAX_DEGREE + 1];
        for i in 0..count[0] {
            for j in 0..count[1] {
                products[i][j] = match (i, j) {
                    (0, _) => powers[1][j],
                    (_, 0) => powers[0][i],
                    _ => powers[0][i] * powers[1][j],
                };
                sizes[i][j] = products[i][j].magnitude();
            }
        }
        let axes = if self.is_rational { 4 } else { 3 };
        let mut found = [[Taylor::ZERO; 4]; 6];
        for (order, sums) in ORDERS.into_iter().zip(&mut found) {
            let [a, b] = order;
            let mut running = [Sum::EMPTY; 4];
            for i in a..(a + count[0]).min(p + 1) {
                for j in b..(b + count[1]).min(q + 1) {
                    let factor = falling(i, a) * falling(j, b);
                    let c = &expansion[i * (q + 1) + j];
                    let size = sizes[i - a][j - b];
                    for axis in 0..axes {
                        let factor = factor * c[axis];
                        if (factor * size).abs() <= SMALL * self.error[axis] {
                            running[axis].add_small(factor, size);
                        } else {
                            running[axis].add(factor, &products[i - a][j - b], size);
                        }
                    }
                }
            }
            let growth = growth(p, a, reach[0], beyond[0]) * growth(q, b, reach[1], beyond[1]);
            for axis in 0..axes {
                sums[axis] = running[axis].done(self.error[axis] * growth);
            }
        }
        if self.is_rational { quotient(&found) } else { Some(polynomial(&found)) }
    }

    /// The coefficients of (u − u_0)^i (v − v_0)^j; of what does not move only those to the second order.
    fn expansion(&self, at: [f64; 2], reach: [f64; 2]) -> Vec<[f64; 4]> {
        let [p, q] = self.degree;
        let mut points = self.control.clone();
        let mut line = [[0.0; 4]; MAX_DEGREE + 1];
        for i in 0..=p {
            let row = &mut points[i * (q + 1)..][..q + 1];
            expand(row, at[1], if reach[1] <= f64::MIN_POSITIVE { 2 } else { q });
        }
        for j in 0..=q {
            for i in 0..=p {
                line[i] = points[i * (q + 1) + j];
            }
            expand(&mut line[..=p], at[0], if reach[0] <= f64::MIN_POSITIVE { 2 } else { p });
            for i in 0..=p {
                points[i * (q + 1) + j] = line[i];
            }
        }
        points
    }
}

/// Bernstein points become coefficients about `at`: of the longer part on either side of it, whose points de Casteljau's
/// algorithm gives, the differences. Those above degree `most` are left as they are.
fn expand(points: &mut [[f64; 4]], at: f64, most: usize) {
    let n = points.len() - 1;
    let is_above = at <= 0.5;
    let length = if is_above { 1.0 - at } else { -at };
    // Part above: the last point of each column stays; part below, read backwards: the first.
    for r in 1..=n {
        for i in 0..=n - r {
            let k = if is_above { i } else { n - i };
            let (a, b) = if is_above { (points[k], points[k + 1]) } else { (points[k - 1], points[k]) };
            points[k] = std::array::from_fn(|axis| a[axis] * (1.0 - at) + b[axis] * at);
        }
    }
    if !is_above {
        points.reverse();
    }
    for k in 1..=most.min(n) {
        for i in (k..=n).rev() {
            points[i] = std::array::from_fn(|axis| points[i][axis] - points[i - 1][axis]);
        }
    }
    let mut factor = 1.0;
    for k in 1..=most.min(n) {
        factor *= (n + 1 - k) as f64 / (k as f64 * length);
        points[k].iter_mut().for_each(|c| *c *= factor);
    }
}

/// f⁰ … f^n, of |f| ≤ `reach`.
fn powers(f: Taylor, reach: f64, n: usize) -> [Taylor; MAX_DEGREE + 1] {
    let mut powers = [Taylor::ZERO; MAX_DEGREE + 1];
    powers[0] = Taylor::constant(1.0);
    if f64::MIN_POSITIVE < reach {
        for k in 1..=n {
            powers[k] = if k == 1 { f } else { powers[k - 1] * f };
        }
    }
    powers
}

/// n (n − 1) … to `k` factors.
fn falling(n: usize, k: usize) -> f64 {
    (0..k).map(|i| (n - i) as f64).product()
}

/// What an error of the points becomes in the derivative of order `k`: that of (1 + 4 h)^n, and more where the parameter is
/// beyond 0 … 1 so that no step is convex.
fn growth(n: usize, k: usize, reach: f64, beyond: f64) -> f64 {
    if n < k {
        return 0.0;
    }
    falling(n, k) * 4f64.powi(k as i32) * (1.0 + 4.0 * reach).powi((n - k) as i32) * (1.0 + 2.0 * beyond).powi(n as i32)
}

fn polynomial(a: &[[Taylor; 4]; 6]) -> Jet {
    let [s, su, sv, suu, suv, svv] = a.map(|[x, y, z, _]| [x, y, z]);
    Jet { s, su, sv, suu, suv, svv }
}

/// Piegl & Tiller, Eq. (4.20).
fn quotient(a: &[[Taylor; 4]; 6]) -> Option<Jet> {
    let [w, wu, wv, wuu, wuv, wvv] = a.map(|[_, _, _, w]| w);
    let Jet { s, su, sv, suu, suv, svv } = polynomial(a);
    let inverse = w.reciprocal()?;
    let s = times(&s, inverse);
    let su = times(&difference(&su, &times(&s, wu)), inverse);
    let sv = times(&difference(&sv, &times(&s, wv)), inverse);
    let second = |a: &Vector, rest: [(&Vector, Taylor); 3]| {
        let rest = rest.map(|(s, w)| times(s, w));
        times(&difference(a, &sum(&sum(&rest[0], &rest[1]), &rest[2])), inverse)
    };
    let suu = second(&suu, [(&su, wu), (&su, wu), (&s, wuu)]);
    let suv = second(&suv, [(&su, wv), (&sv, wu), (&s, wuv)]);
    let svv = second(&svv, [(&sv, wv), (&sv, wv), (&s, wvv)]);
    Some(Jet { s, su, sv, suu, suv, svv })
}

impl Jet {
    /// Velocity and acceleration of the curve (u(τ), v(τ)) with the derivatives given, by its own parameter.
    pub fn along(&self, [du, dv]: [Taylor; 2], [ddu, ddv]: [Taylor; 2]) -> [Vector; 2] {
        let velocity = sum(&times(&self.su, du), &times(&self.sv, dv));
        let turning = sum(&times(&self.suu, du * du), &times(&self.svv, dv * dv));
        let mixed = times(&self.suv, (du * dv).scaled(2.0));
        let driven = sum(&times(&self.su, ddu), &times(&self.sv, ddv));
        [velocity, sum(&sum(&turning, &mixed), &driven)]
    }

    /// S_u × S_v at unit length, and 1 / |S_u × S_v|; `None` where it may vanish.
    pub fn normal(&self) -> Option<(Vector, Taylor)> {
        let product = cross(&self.su, &self.sv);
        let inverse = dot(&product, &product).inverse_root()?;
        Some((times(&product, inverse), inverse))
    }

    /// The normal curvature across the curve of direction (`du`, `dv`): at right angles to it in the tangent plane.
    ///
    /// The direction (a, b) with a = −(F u' + G v'), b = E u' + F v' is at right angles to (u', v'), and has the length
    /// |S_u × S_v| |C'|. `normal` is what [`Self::normal`] says. `None` where |C'| may vanish.
    pub fn curvature_across(&self, [du, dv]: [Taylor; 2], (normal, inverse): &(Vector, Taylor)) -> Option<Taylor> {
        let [e, f, g] = [dot(&self.su, &self.su), dot(&self.su, &self.sv), dot(&self.sv, &self.sv)];
        let (by_v, by_u) = (f * du + g * dv, e * du + f * dv);
        let scale = *inverse * (du * by_u + dv * by_v).inverse_root()?;
        let (a, b) = (-(by_v * scale), by_u * scale);
        let [l, m, n] = [&self.suu, &self.suv, &self.svv].map(|s| dot(s, normal));
        Some(l * a * a + (m * a * b).scaled(2.0) + n * b * b)
    }
}
