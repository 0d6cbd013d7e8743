//! Bounds that hold for a whole Bézier patch or curve: a close box, and the lengths of its derivatives.

use crate::hull::{Hull, OUTWARD};
use crate::{BezierCurve, BezierPatch};
use glam::{DVec2, DVec3, DVec4};

/// Upper bounds of the lengths of the partial derivatives over a patch, by the parent surface's parameters.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct DerivativeBounds {
    /// Greatest |S_u|, model units per unit of u.
    pub u: f64,
    /// Greatest |S_v|.
    pub v: f64,
    /// Greatest |S_uu|.
    pub uu: f64,
    /// Greatest |S_uv|.
    pub uv: f64,
    /// Greatest |S_vv|.
    pub vv: f64,
}

impl DerivativeBounds {
    /// The larger of each of the two.
    pub fn max(self, other: Self) -> Self {
        Self {
            u: self.u.max(other.u),
            v: self.v.max(other.v),
            uu: self.uu.max(other.uu),
            uv: self.uv.max(other.uv),
            vv: self.vv.max(other.vv),
        }
    }

    /// The greatest distance between the surface over a rectangle of `du` × `dv` and the two triangles over it
    /// (Filip, Magedson & Markot 1986, Theorem 1): (M_uu du² + 2 M_uv du dv + M_vv dv²) / 8.
    pub fn chord(&self, du: f64, dv: f64) -> f64 {
        (self.uu * du * du + 2.0 * self.uv * du * dv + self.vv * dv * dv) / 8.0
    }

    /// The fewest cells of a rectangle of `width` × `height`, from `least` on, that bring the chord bound of each under `allowed`:
    /// always the direction that gains more. Where more than `along` cells in one direction or `all` together would be needed, as
    /// many as there may be. From eight cells on they grow by an eighth, so that the number of steps is bounded by the number of
    /// bits of the count.
    pub fn cells(
        &self,
        [width, height]: [f64; 2],
        allowed: f64,
        least: [usize; 2],
        [along, all]: [usize; 2],
    ) -> [usize; 2] {
        let chord = |n: [usize; 2]| self.chord(width / n[0] as f64, height / n[1] as f64);
        let more = |n: usize| (n + (n / 8).max(1)).min(along);
        let mut n = least;
        while allowed < chord(n) && n[0] * n[1] < all {
            let grown = [[more(n[0]), n[1]], [n[0], more(n[1])]];
            // A cell more in u adds n[1] cells, one in v n[0]: compare what each buys.
            let gain = [0, 1].map(|k| (chord(n) - chord(grown[k])) / ((grown[k][k] - n[k]).max(1) * n[1 - k]) as f64);
            let next = if gain[0] >= gain[1] { grown[0] } else { grown[1] };
            if next == n {
                break;
            }
            n = next;
        }
        n
    }
}

/// A rational patch is bounded in this many parts along each parameter: the quotient rule multiplies bounds, and what
/// that gives away shrinks with the part.
const RATIONAL_PARTS: usize = 4;

/// A part whose weights vary by more than this is halved both ways, up to [`WEIGHT_HALVINGS`] times.
const WEIGHTS_VARY: f64 = 1.5;

/// See [`WEIGHTS_VARY`].
const WEIGHT_HALVINGS: u32 = 4;

impl BezierPatch {
    /// Bounds of all first and second derivatives over the patch.
    ///
    /// A polynomial patch is bounded by differences of its control points, exactly where they are extreme at corners;
    /// a rational one with varying weights in 4 × 4 parts, and in more where the weights of a part vary much.
    pub fn derivative_bounds(&self) -> DerivativeBounds {
        if self.weight_ratio() == 1.0 {
            return self.bounds_of_whole();
        }
        let cuts = |[start, end]: [f64; 2]| {
            (1..RATIONAL_PARTS).map(move |i| start + (end - start) * i as f64 / RATIONAL_PARTS as f64)
        };
        let of_part = |part: &Self| part.by_parts(WEIGHT_HALVINGS, &Self::bounds_of_whole, &DerivativeBounds::max);
        let mut bounds = DerivativeBounds::default();
        let mut rest = self.clone();
        let mut columns = vec![];
        for u in cuts(self.domain[0]) {
            let [low, high] = rest.split_u(u);
            columns.push(low);
            rest = high;
        }
        columns.push(rest);
        for mut column in columns {
            for v in cuts(self.domain[1]) {
                let [low, high] = column.split_v(v);
                bounds = bounds.max(of_part(&low));
                column = high;
            }
            bounds = bounds.max(of_part(&column));
        }
        bounds
    }

    /// A box that holds the patch, in world coordinates, rounded outward: that of the control points ([`Self::hull`]), or where
    /// weights vary much, of those of its parts. A heavy point draws the patch away from the others, which stay.
    pub fn close_hull(&self) -> Hull {
        self.by_parts(WEIGHT_HALVINGS, &Self::hull, &Hull::union)
    }

    /// What is found of a patch whose weights vary little, else what is found of its quarters, which may be quartered
    /// `halvings` times.
    fn by_parts<T>(&self, halvings: u32, of: &impl Fn(&Self) -> T, joined: &impl Fn(T, T) -> T) -> T {
        if halvings == 0 || self.weight_ratio() <= WEIGHTS_VARY {
            return of(self);
        }
        let quarters = self.quarters().map(|part| part.by_parts(halvings - 1, of, joined));
        quarters.into_iter().reduce(joined).expect("there are four")
    }

    /// Differences of control points bound the derivatives of a Bézier patch. For a rational one the quotient rule
    /// is applied to bounds: with A the numerator about the centre of the patch's box (so that |S| ≤ r there),
    /// |S_u| ≤ (|A_u| + |w_u| r) / w_min and so on for the second order (Piegl & Tiller, Eq. 4.20).
    fn bounds_of_whole(&self) -> DerivativeBounds {
        let [p, q] = self.degree;
        let [[u0, u1], [v0, v1]] = self.domain;
        let euclidean = || self.control.iter().map(|c| c.truncate() / c.w);
        let center = Hull::of(euclidean()).center();
        let radius = euclidean().fold(0.0, |r: f64, x| r.max(x.distance(center)));
        let weight = self.control.iter().fold(f64::INFINITY, |w: f64, c| w.min(c.w));
        // Numerator and denominator about the centre.
        let at = |i: usize, j: usize| {
            let c = self.control[i * (q + 1) + j];
            (c.truncate() - center * c.w).extend(c.w)
        };
        let (scale_u, scale_v) = (p as f64 / (u1 - u0), q as f64 / (v1 - v0));
        let scale_uu = scale_u * (p as f64 - 1.0) / (u1 - u0);
        let scale_vv = scale_v * (q as f64 - 1.0) / (v1 - v0);
        let u = greatest(p, q + 1, |i, j| (at(i + 1, j) - at(i, j)) * scale_u);
        let v = greatest(p + 1, q, |i, j| (at(i, j + 1) - at(i, j)) * scale_v);
        let uu = greatest(p.saturating_sub(1), q + 1, |i, j| (at(i + 2, j) - 2.0 * at(i + 1, j) + at(i, j)) * scale_uu);
        let vv = greatest(p + 1, q.saturating_sub(1), |i, j| (at(i, j + 2) - 2.0 * at(i, j + 1) + at(i, j)) * scale_vv);
        let uv =
            greatest(p, q, |i, j| (at(i + 1, j + 1) - at(i + 1, j) - at(i, j + 1) + at(i, j)) * (scale_u * scale_v));
        let outward = (1.0 + OUTWARD) / weight;
        let s_u = (u.0 + u.1 * radius) * outward;
        let s_v = (v.0 + v.1 * radius) * outward;
        DerivativeBounds {
            u: s_u,
            v: s_v,
            uu: (uu.0 + 2.0 * u.1 * s_u + uu.1 * radius) * outward,
            uv: (uv.0 + u.1 * s_v + v.1 * s_u + uv.1 * radius) * outward,
            vv: (vv.0 + 2.0 * v.1 * s_v + vv.1 * radius) * outward,
        }
    }
}

impl BezierCurve {
    /// Upper bounds of |u''| and |v''| by the curve's own parameter, 0 to 1.
    ///
    /// A polynomial curve is bounded by second differences of its control points; a rational one with varying weights in
    /// four parts, as patches are.
    pub fn second_derivative_bounds(&self) -> DVec2 {
        if !self.is_rational() {
            return self.second_derivative_of_whole();
        }
        let mut bounds = DVec2::ZERO;
        let mut rest = self.clone();
        for left in (2..=RATIONAL_PARTS).rev() {
            let [part, other] = rest.split(1.0 / left as f64);
            bounds = bounds.max(part.second_derivative_of_whole());
            rest = other;
        }
        // A part's parameter runs through a quarter of the curve's.
        bounds.max(rest.second_derivative_of_whole()) * (RATIONAL_PARTS * RATIONAL_PARTS) as f64
    }

    /// The quotient rule on the control polygon: C'' = (N'' − 2 C' w' − C w'') / w, about the middle of the hull.
    fn second_derivative_of_whole(&self) -> DVec2 {
        let p = self.degree() as f64;
        let hull = self.hull();
        let (middle, radius) = (0.5 * (hull.min + hull.max), 0.5 * hull.size());
        let about: Vec<DVec3> = self.control.iter().map(|c| (c.truncate() - middle * c.z).extend(c.z)).collect();
        let greatest = |differences: &mut dyn Iterator<Item = DVec3>| {
            differences.fold(DVec3::ZERO, |most: DVec3, difference| most.max(difference.abs()))
        };
        let first = p * greatest(&mut about.windows(2).map(|c| c[1] - c[0]));
        let second = p * (p - 1.0) * greatest(&mut about.windows(3).map(|c| c[2] - 2.0 * c[1] + c[0]));
        let weight = self.control.iter().fold(f64::INFINITY, |least: f64, c| least.min(c.z));
        let outward = (1.0 + OUTWARD) / weight;
        let c_t = (first.truncate() + radius * first.z) * outward;
        (second.truncate() + 2.0 * c_t * first.z + radius * second.z) * outward
    }
}

/// The greatest length of the spatial part and the greatest size of the weight part of `difference` over a grid.
fn greatest(rows: usize, columns: usize, difference: impl Fn(usize, usize) -> DVec4) -> (f64, f64) {
    let mut found = (0.0f64, 0.0f64);
    for i in 0..rows {
        for j in 0..columns {
            let d = difference(i, j);
            found = (found.0.max(d.truncate().length()), found.1.max(d.w.abs()));
        }
    }
    found
}
