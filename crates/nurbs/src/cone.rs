//! Cones that hold all normals of a Bézier patch.
//!
//! S_u and S_v of a rational patch are, up to a positive factor, polynomials whose Bézier coefficients are products of those
//! of the numerator and the weight. All directions of such a polynomial lie in any cone that holds its coefficients, so that two
//! cones hold the tangents, and a third one, by their cross product, the normals (after Sederberg & Meyers, *Loop detection in
//! surface patch intersections*, 1988).

use crate::BezierPatch;
use crate::hull::Hull;
use glam::{DVec3, DVec4};

/// A coefficient below this share of the products that it is a sum of is zero, and has no direction.
const NOTHING: f64 = 256.0 * f64::EPSILON;

/// Directions about an axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cone {
    /// The middle direction, of unit length.
    pub axis: DVec3,
    /// The sine of the greatest angle from it, below 1: the cone is narrower than a half-space.
    pub sine: f64,
}

impl BezierPatch {
    /// The part of the patch over a rectangle of the parent's parameters, which is inside the patch's own.
    pub fn part(&self, [[u0, u1], [v0, v1]]: [[f64; 2]; 2]) -> Self {
        let mut part = self.clone();
        if u1 < part.domain[0][1] {
            [part, _] = part.split_u(u1);
        }
        if u0 > part.domain[0][0] {
            [_, part] = part.split_u(u0);
        }
        if v1 < part.domain[1][1] {
            [part, _] = part.split_v(v1);
        }
        if v0 > part.domain[1][0] {
            [_, part] = part.split_v(v0);
        }
        part
    }

    /// A cone that holds the direction of S_u × S_v wherever the patch has one, and so all that is interpolated between such normals
    /// and made a unit vector again; `None` where these bounds show none below a right angle.
    ///
    /// A side that is a point does no harm: its tangents are zero, and the cone is that of the fan beside it. Within 2⁻⁴⁴ of
    /// such a side rounding decides the direction, and nothing is said.
    pub fn normal_cone(&self) -> Option<Cone> {
        let (along_u, distance_u) = directions(&self.tangents())?;
        let (along_v, distance_v) = directions(&self.transposed().tangents())?;
        let across = along_u.cross(along_v);
        // Unit tangents are off their axes by so much at most, and their cross product by this.
        let off = distance_u + distance_v + distance_u * distance_v;
        let sine = off / across.length();
        (sine < 1.0).then(|| Cone { axis: across.normalize(), sine })
    }

    /// Coefficients of A_u w − A w_u, which S_u is, but for a positive factor each.
    fn tangents(&self) -> Vec<(DVec3, f64)> {
        let [p, q] = self.degree;
        let center = Hull::of(self.control.iter().map(|c| c.truncate() / c.w)).center();
        let about: Vec<DVec4> = self.control.iter().map(|c| (c.truncate() - center * c.w).extend(c.w)).collect();
        let at = |i: usize, j: usize| about[i * (q + 1) + j];
        if self.weight_ratio() == 1.0 {
            let difference = |i: usize, j: usize| {
                let (a, b) = (at(i, j).truncate(), at(i + 1, j).truncate());
                (b - a, a.length() + b.length())
            };
            return (0..p).flat_map(|i| (0..=q).map(move |j| (i, j))).map(|(i, j)| difference(i, j)).collect();
        }
        let mut sums = vec![(DVec3::ZERO, 0.0); 2 * p * (2 * q + 1)];
        for (i, j) in (0..p).flat_map(|i| (0..=q).map(move |j| (i, j))) {
            let (low, high) = (at(i, j), at(i + 1, j));
            for (k, l) in (0..=p).flat_map(|k| (0..=q).map(move |l| (k, l))) {
                let other = at(k, l);
                let factor = binomial(p - 1, i) * binomial(p, k) * binomial(q, j) * binomial(q, l);
                let (a, w) = ((high - low).truncate(), high.w - low.w);
                let sum = &mut sums[(i + k) * (2 * q + 1) + j + l];
                sum.0 += (a * other.w - other.truncate() * w) * factor;
                let size = (high.truncate().length() + low.truncate().length()) * other.w;
                sum.1 += (size + other.truncate().length() * (high.w + low.w)) * factor;
            }
        }
        sums
    }
}

/// The middle direction of vectors, and how far their unit vectors are from it at most; each has the size of what it is a sum of.
fn directions(vectors: &[(DVec3, f64)]) -> Option<(DVec3, f64)> {
    let units: Vec<DVec3> =
        vectors.iter().filter(|(v, size)| v.length() > NOTHING * size).filter_map(|(v, _)| v.try_normalize()).collect();
    let axis = units.iter().sum::<DVec3>().try_normalize()?;
    let distance = units.iter().fold(0.0, |most: f64, unit| most.max(unit.distance(axis)));
    Some((axis, distance + NOTHING))
}

/// n over k.
fn binomial(n: usize, k: usize) -> f64 {
    (0..k).fold(1.0, |product, i| product * (n - i) as f64 / (i + 1) as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Whether the patch's normals at a grid of places, and their mixtures, are in its cone.
    fn holds(patch: &BezierPatch, cone: Cone) -> bool {
        let [[u0, u1], [v0, v1]] = patch.domain;
        let normals: Vec<DVec3> = (0..=6)
            .flat_map(|i| (0..=6).map(move |j| (f64::from(i) / 6.0, f64::from(j) / 6.0)))
            .filter_map(|(s, t)| {
                let d = patch.first_derivatives(u0 + (u1 - u0) * s, v0 + (v1 - v0) * t);
                let is_a_side = d.su.length().min(d.sv.length()) < 1e-9;
                d.su.cross(d.sv).try_normalize().filter(|_| !is_a_side)
            })
            .collect();
        let inside = |n: DVec3| n.dot(cone.axis) > 0.0 && n.cross(cone.axis).length() <= cone.sine + 1e-9;
        let mixed = normals.windows(9).all(|n| inside((n[0] * 0.3 + n[4] * 0.2 + n[8] * 0.5).normalize()));
        mixed && normals.into_iter().all(inside)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2000))]
        #[test]
        fn a_cone_holds_all_normals(
            degree in (1usize..5, 1usize..5),
            bumps in prop::collection::vec((-0.3f64..0.3, -0.3f64..0.3, -0.6f64..0.6, 0.5f64..2.0), 25),
            collapsed in any::<bool>(),
            rational in any::<bool>(),
            corner in (0.0f64..0.8, 0.0f64..0.8, 0.02f64..0.2),
        ) {
            let (p, q) = degree;
            let point = |i: usize, j: usize| {
                let (x, y, z, w) = bumps[i * (q + 1) + j];
                // With one side a point, where a row has no length.
                let across = if collapsed { i as f64 * (j as f64 - 0.5) } else { j as f64 };
                let w = if rational { w } else { 1.0 };
                let shift = if collapsed && i == 0 { DVec3::ZERO } else { DVec3::new(x, y, z) };
                ((DVec3::new(i as f64, across, 0.0) + shift) * w).extend(w)
            };
            let control = (0..=p).flat_map(|i| (0..=q).map(move |j| (i, j))).map(|(i, j)| point(i, j)).collect();
            let patch = BezierPatch { degree: [p, q], domain: [[0.0, 1.0], [0.0, 1.0]], origin: DVec3::splat(7.0), control };
            if let Some(cone) = patch.normal_cone() {
                prop_assert!(holds(&patch, cone), "{cone:?}");
            }
            let (u, v, size) = corner;
            let part = patch.part([[u, u + size], [v, v + size]]);
            if let Some(cone) = part.normal_cone() {
                prop_assert!(holds(&part, cone), "part {cone:?}");
            }
        }
    }

    #[test]
    fn a_small_part_has_a_narrow_cone_and_a_pole_does_no_harm() {
        // An eighth of the unit sphere, with the pole at u = 1, as a product of two quarter circles.
        let h = 0.5f64.sqrt();
        let arc = [(1.0, 0.0, 1.0), (1.0, 1.0, h), (0.0, 1.0, 1.0)];
        let point = |(r, z, w): (f64, f64, f64), (x, y, v): (f64, f64, f64)| DVec4::new(r * x, r * y, z, 1.0) * (w * v);
        let control = arc.iter().flat_map(|&a| arc.map(|b| point(a, b))).collect();
        let sphere = BezierPatch { degree: [2, 2], domain: [[0.0, 1.0], [0.0, 1.0]], origin: DVec3::ZERO, control };
        for (rectangle, most) in
            [([[0.4, 0.45], [0.4, 0.45]], 0.15), ([[0.9, 1.0], [0.4, 0.5]], 0.5), ([[0.99, 1.0], [0.4, 0.42]], 0.1)]
        {
            let part = sphere.part(rectangle);
            let cone = part.normal_cone().expect("it is narrow");
            assert!(holds(&part, cone) && cone.sine < most, "{rectangle:?}: {cone:?}");
        }
        assert_eq!(sphere.normal_cone(), None);
    }
}
