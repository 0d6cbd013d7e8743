//! How far f32 evaluation at a given (u, v) may lie from f64: a running bound for the fragment program.
//!
//! Until intervals are proven this is a bound to first order. With ε = 2⁻²⁴ and A_{ab} = Σ |N⁽ᵃ⁾_i| |N⁽ᵇ⁾_j| |P_ij|
//! (f64, about the face's own origin, where the program works), a sum X_{ab} = Σ N⁽ᵃ⁾_i N⁽ᵇ⁾_j P_ij is off by at most
//!
//! E_{ab} = ε (c A_{ab} + p κ_u A_{a+1,b} + q κ_v A_{a,b+1}).
//!
//! c counts the roundings of the longest chain (control point, p + q columns of the inverse triangle with four each,
//! p + q + 2 products and sums); the other two terms are what moving each of the p + q active knots by half an ulp of
//! κ = max(1, |knot|) does (nothing, where f32 holds them exactly): the surface then is that of a parameter moved by as
//! much. Quotient, cross product,
//! normalisation and curvature carry these errors on by the product rule. The result is doubled for the second order.

use glam::{DVec3, DVec4};
use nurbs::{Curvature, Direction, MAX_DEGREE, SecondDerivatives, Surface, basis_derivatives};

/// Unit roundoff of f32.
const EPSILON: f64 = 1.0 / (1u64 << 24) as f64;

/// Allowance for the second order of all products of errors, and for WGSL's 2.5 ulp division against our half.
const SAFETY: f64 = 2.0;

/// A normal whose tolerance exceeds this (as the sine of an angle) is not judged: a pole is near.
const USELESS: f64 = 0.25;

/// What f32 may differ by at one point, in model units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tolerance {
    /// Length of the error of S.
    pub position: f64,
    /// Length of the error of the unit normal; `None` where there is no useful bound.
    pub normal: Option<f64>,
    /// Error of either principal curvature; `None` with the normal, or where it exceeds the curvature radius itself.
    pub curvature: Option<f64>,
}

/// The tolerances of one surface's program.
#[derive(Debug, Clone)]
pub struct ToleranceModel<'s> {
    surface: &'s Surface,
    /// Roundings in the longest chain.
    chain: f64,
    /// max(1, |knot|) over local knots, in both directions; 0 where f32 holds them all exactly.
    kappa: [f64; 2],
    /// Half the diagonal of the control box: what narrowing of the control points is relative to.
    radius: f64,
}

impl<'s> ToleranceModel<'s> {
    /// The model for `surface`, whose degrees a specialised program may have raised to the next odd one.
    pub fn new(surface: &'s Surface) -> Self {
        let raised = (surface.degree().into_iter().max().expect("two degrees").max(3) | 1).min(MAX_DEGREE) as f64;
        let kappa = [Direction::U, Direction::V].map(|direction| {
            let knots = surface.knots(direction);
            let (low, length) = (knots.domain().0, knots.length());
            let local = || knots.knots().iter().map(|k| (k - low) / length);
            // Knots that f32 holds exactly do not move: those of a Bézier patch, and other dyadic ones.
            let exact = local().all(|k| f64::from(k as f32) == k);
            if exact { 0.0 } else { local().fold(1.0, |most: f64, k| most.max(k.abs())) }
        });
        Self {
            surface,
            chain: 1.0 + 4.0 * 2.0 * raised + 2.0 * raised + 2.0,
            kappa,
            radius: surface.hull().diagonal() / 2.0,
        }
    }

    /// How far, in parameters, rounding may move a knot: two parameters closer than this to a knot are on either span.
    pub fn knot_slack(&self, direction: Direction) -> f64 {
        2.0 * EPSILON * self.kappa[direction as usize] * self.surface.knots(direction).length()
    }

    /// The tolerance at (u, v), on the polynomial of the given spans, whose derivatives are `d`.
    pub fn at(
        &self,
        span: [usize; 2],
        u: f64,
        v: f64,
        d: &SecondDerivatives,
        curvature: Option<&Curvature>,
    ) -> Tolerance {
        let [ku, kv] = [Direction::U, Direction::V].map(|direction| self.surface.knots(direction));
        let (p, q) = (ku.degree(), kv.degree());
        let nu = basis_derivatives(ku, span[0], u, 3);
        let nv = basis_derivatives(kv, span[1], v, 3);
        let columns = kv.control_count();
        // A_{ab}: lengths of the spatial parts in xyz added up in x, sizes of the weights in w; W_{ab} signed, in y.
        let mut sums = [[DVec4::ZERO; 4]; 4];
        for i in 0..=p {
            for j in 0..=q {
                let c = self.surface.homogeneous()[(span[0] - p + i) * columns + span[1] - q + j];
                let length = DVec3::new(c[0], c[1], c[2]).length().max(EPSILON * self.radius * c[3]);
                for a in 0..4 {
                    for b in 0..4 - a {
                        let n = nu[a][i] * nv[b][j];
                        sums[a][b] += DVec4::new(n.abs() * length, n * c[3], 0.0, n.abs() * c[3]);
                    }
                }
            }
        }
        let rational = self.surface.weights().is_some();
        let knot = [p as f64 * self.kappa[0] * ku.length(), q as f64 * self.kappa[1] * kv.length()];
        // E_{ab} of the spatial part (x) and of the weight (w, zero for a polynomial surface).
        let error = |a: usize, b: usize| {
            let at = |a: usize, b: usize| if a + b < 4 { sums[a][b] } else { DVec4::ZERO };
            let e = EPSILON * (self.chain * at(a, b) + knot[0] * at(a + 1, b) + knot[1] * at(a, b + 1));
            (e.x, if rational { e.w } else { 0.0 })
        };
        let weight = |a: usize, b: usize| if rational { sums[a][b].y } else { f64::from(u8::from(a + b == 0)) };
        let w = weight(0, 0);
        let s = (d.s - self.surface.origin()).length();
        let (su, sv) = (d.su.length(), d.sv.length());
        let quotient = |(spatial, by_weight): (f64, f64), carried: f64| (spatial + by_weight * s + carried) / w;
        let e_s = quotient(error(0, 0), 0.0) + EPSILON * s;
        let first = |e: (f64, f64), w_x: f64, length: f64| {
            quotient(e, w_x.abs() * e_s + error(0, 0).1 * length) + 3.0 * EPSILON * (length + w_x.abs() * s / w)
        };
        let e_su = first(error(1, 0), weight(1, 0), su);
        let e_sv = first(error(0, 1), weight(0, 1), sv);
        let cross = d.su.cross(d.sv).length();
        let e_n = SAFETY * ((e_su * sv + e_sv * su + 2.0 * EPSILON * su * sv) / cross + 3.0 * EPSILON);
        let normal = (e_n < USELESS).then_some(e_n);
        let curvature = curvature.filter(|_| normal.is_some()).map(|k| {
            let (suu, suv, svv) = (d.suu.length(), d.suv.length(), d.svv.length());
            let (e_wu, e_wv) = (error(1, 0).1, error(0, 1).1);
            let (w_u, w_v) = (weight(1, 0).abs(), weight(0, 1).abs());
            let second = |e: (f64, f64), carried: f64, w_xx: f64, length: f64, terms: f64| {
                quotient(e, carried + w_xx.abs() * e_s + error(0, 0).1 * length)
                    + 5.0 * EPSILON * (length + terms / w + w_xx.abs() * s / w)
            };
            let e_suu = second(error(2, 0), 2.0 * (w_u * e_su + e_wu * su), weight(2, 0), suu, 2.0 * w_u * su);
            let e_suv = second(
                error(1, 1),
                w_u * e_sv + e_wu * sv + w_v * e_su + e_wv * su,
                weight(1, 1),
                suv,
                w_u * sv + w_v * su,
            );
            let e_svv = second(error(0, 2), 2.0 * (w_v * e_sv + e_wv * sv), weight(0, 2), svv, 2.0 * w_v * sv);
            // In the frame e1 = S_u / |S_u|, e2 = n × e1: S_v = f e1 + g e2.
            let (g, shear) = (cross / su, d.sv.dot(d.su).abs() / (su * su));
            let (e_g, e_shear) = (e_sv + sv * e_n, (e_sv + shear * e_su) / su + shear * e_n);
            let form = |e: f64, length: f64| e + length * (e_n + 3.0 * EPSILON);
            let (l, m, nn) = (form(e_suu, suu), form(e_suv, suv), form(e_svv, svv));
            let (e_a, a) = (l / (su * su), suu / (su * su));
            let (e_b, b) = ((m + shear * l + e_shear * suu) / (su * g), (suv + shear * suu) / (su * g));
            let (e_c, c) = (
                (nn + 2.0 * shear * m + shear * shear * l + 2.0 * e_shear * (suv + shear * suu)) / (g * g),
                (svv + 2.0 * shear * suv + shear * shear * suu) / (g * g),
            );
            let relative = 2.0 * (e_su / su + e_g / g) + 6.0 * EPSILON;
            let largest = k.k1.abs().max(k.k2.abs());
            SAFETY * (e_a + 2.0 * e_b + e_c + relative * (a + 2.0 * b + c) + 4.0 * EPSILON * largest)
        });
        Tolerance { position: SAFETY * e_s, normal, curvature: curvature.filter(|e| e.is_finite()) }
    }
}
