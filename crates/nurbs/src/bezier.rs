//! Bézier patches: one polynomial (or rational) piece of a surface, for culling, bounding and root finding.

use crate::hull::Hull;
use crate::weights::ratio;
use crate::{FirstDerivatives, MAX_ORDER};
use glam::{DVec3, DVec4};

/// A rational Bézier patch over a rectangle of the parent surface's parameters.
///
/// Control points are homogeneous, (w x, w y, w z, w), relative to `origin` and row-major in u:
/// index `i * (degree_v + 1) + j`. All weights are positive.
#[derive(Debug, Clone, PartialEq)]
pub struct BezierPatch {
    /// Degrees in u and v.
    pub degree: [usize; 2],
    /// The rectangle \[\[u0, u1\], \[v0, v1\]\] of the parent's knot domain.
    pub domain: [[f64; 2]; 2],
    /// World position of the local coordinates' origin, in model units.
    pub origin: DVec3,
    /// (p + 1) (q + 1) homogeneous control points.
    pub control: Vec<DVec4>,
}

impl BezierPatch {
    /// Position and first derivatives by the parent's parameters, by de Casteljau's algorithm.
    ///
    /// Independent of the B-spline evaluators, which it checks. Parameters outside the rectangle extrapolate.
    pub fn first_derivatives(&self, u: f64, v: f64) -> FirstDerivatives {
        let [p, q] = self.degree;
        let [[u0, u1], [v0, v1]] = self.domain;
        let (s, t) = ((u - u0) / (u1 - u0), (v - v0) / (v1 - v0));
        let mut along_v = [DVec4::ZERO; MAX_ORDER];
        let mut by_v = [DVec4::ZERO; MAX_ORDER];
        for (i, row) in self.control.chunks(q + 1).enumerate() {
            (along_v[i], by_v[i]) = de_casteljau(row, t);
        }
        let (a, a_u) = de_casteljau(&along_v[..=p], s);
        let (a_v, _) = de_casteljau(&by_v[..=p], s);
        FirstDerivatives::from_homogeneous(self.origin, a, a_u / (u1 - u0), a_v / (v1 - v0))
    }

    /// The two halves at the parent's parameter `u`, inside the rectangle.
    pub fn split_u(&self, u: f64) -> [Self; 2] {
        let [p, q] = self.degree;
        let [[u0, u1], v] = self.domain;
        let [mut low, mut high] = self.split_lines((u - u0) / (u1 - u0), p, (0..=q).map(|j| (j, q + 1)));
        low.domain = [[u0, u], v];
        high.domain = [[u, u1], v];
        [low, high]
    }

    /// The two halves at the parent's parameter `v`, inside the rectangle.
    pub fn split_v(&self, v: f64) -> [Self; 2] {
        let [p, q] = self.degree;
        let [u, [v0, v1]] = self.domain;
        let [mut low, mut high] = self.split_lines((v - v0) / (v1 - v0), q, (0..=p).map(|i| (i * (q + 1), 1)));
        low.domain = [u, [v0, v]];
        high.domain = [u, [v, v1]];
        [low, high]
    }

    /// The four parts on either side of the middle in u and in v; those of the lower half in u come first.
    pub fn quarters(&self) -> [Self; 4] {
        let [u, v] = self.domain.map(|[start, end]| 0.5 * (start + end));
        let [low, high] = self.split_u(u);
        let ([a, b], [c, d]) = (low.split_v(v), high.split_v(v));
        [a, b, c, d]
    }

    /// De Casteljau's algorithm at `s` on lines of `p` + 1 control points, each told by its first and the step to the next.
    fn split_lines(&self, s: f64, p: usize, lines: impl Iterator<Item = (usize, usize)>) -> [Self; 2] {
        let [mut low, mut high] = [self.clone(), self.clone()];
        for (first, step) in lines {
            let mut line = [DVec4::ZERO; MAX_ORDER];
            for i in 0..=p {
                line[i] = self.control[first + i * step];
            }
            for r in 0..=p {
                low.control[first + r * step] = line[0];
                high.control[first + (p - r) * step] = line[p - r];
                for i in 0..p - r {
                    line[i] = line[i] * (1.0 - s) + line[i + 1] * s;
                }
            }
        }
        [low, high]
    }

    /// The same patch with u and v exchanged.
    pub fn transposed(&self) -> Self {
        let [p, q] = self.degree;
        let control = (0..=q).flat_map(|j| (0..=p).map(move |i| self.control[i * (q + 1) + j])).collect();
        Self { degree: [q, p], domain: [self.domain[1], self.domain[0]], origin: self.origin, control }
    }

    /// The greatest ratio of two weights: 1 for a polynomial patch.
    pub fn weight_ratio(&self) -> f64 {
        ratio(self.control.iter().map(|c| c.w))
    }

    /// The greatest ratio of two weights of one row along u, and of one along v.
    pub fn weight_ratios_along(&self) -> [f64; 2] {
        let [p, q] = self.degree;
        let weight = |i: usize, j: usize| self.control[i * (q + 1) + j].w;
        let along_u = (0..=q).map(|j| ratio((0..=p).map(|i| weight(i, j))));
        let along_v = (0..=p).map(|i| ratio((0..=q).map(|j| weight(i, j))));
        [along_u.fold(1.0, f64::max), along_v.fold(1.0, f64::max)]
    }

    /// The box of the control points, which holds the whole patch, in world coordinates, rounded outward.
    pub fn hull(&self) -> Hull {
        Hull::of(self.control.iter().map(|c| self.origin + c.truncate() / c.w))
    }
}

/// Value and derivative by the local parameter at `s`.
fn de_casteljau(control: &[DVec4], s: f64) -> (DVec4, DVec4) {
    let p = control.len() - 1;
    let mut d = [DVec4::ZERO; MAX_ORDER];
    d[..=p].copy_from_slice(control);
    for r in 1..p {
        for i in 0..=p - r {
            d[i] = d[i] * (1.0 - s) + d[i + 1] * s;
        }
    }
    (d[0] * (1.0 - s) + d[1] * s, (d[1] - d[0]) * p as f64)
}
