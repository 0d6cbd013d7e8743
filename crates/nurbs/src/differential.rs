//! What a surface looks like at a point: its normal, with how far to trust it, and its curvatures.

use crate::basis::binomial;
use crate::scale::power_of_two;
use crate::{Direction, SecondDerivatives, Surface};
use glam::{DVec2, DVec3};

/// A point counts as collapsed in a direction when the domain's length times the derivative is below this share of
/// the control box: control points that should coincide agree to a few ulp of their coordinates, not exactly.
const COLLAPSED: f64 = 1e-12;

/// S_u and S_v count as parallel below this sine: their cross product then is rounding error.
pub(crate) const PARALLEL: f64 = 1e-12;

/// Orders of the expansion along which a limit normal is sought before it is called undefined.
const LIMIT_ORDERS: usize = 4;

/// Terms of the expansion below this share of their summands are cancellation, not a direction.
const CANCELLED: f64 = 1e-9;

/// Directions along which a limit normal is sought, in lengths of the span: it exists where all agree.
const LIMIT_SLOPES: [[f64; 2]; 3] = [[1.0, 1.0], [1.0, 0.25], [0.25, 1.0]];

/// Limits along two directions within this distance are one. The terms that they are made of are exact to 1e-9 of
/// themselves ([`CANCELLED`] of 1e-16 is 1e-7).
const ONE_LIMIT: f64 = 1e-6;

/// How a normal was found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum NormalStatus {
    /// S_u × S_v, normalised.
    Regular = 0,
    /// S_u × S_v vanishes; the direction that it tends to, the same from all sides in the span.
    Limit = 1,
    /// No direction: no limit was found in the first orders, or it depends on the side that one comes from.
    Undefined = 2,
}

/// A unit normal with its status.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Normal {
    /// S_u × S_v, normalised.
    Regular(DVec3),
    /// The limit at a degenerate point, from all sides in the span.
    Limit(DVec3),
    /// No direction.
    Undefined,
}

impl Normal {
    /// The direction, where there is one.
    pub fn unit(self) -> Option<DVec3> {
        match self {
            Normal::Regular(n) | Normal::Limit(n) => Some(n),
            Normal::Undefined => None,
        }
    }

    /// The status alone.
    pub fn status(self) -> NormalStatus {
        match self {
            Normal::Regular(_) => NormalStatus::Regular,
            Normal::Limit(_) => NormalStatus::Limit,
            Normal::Undefined => NormalStatus::Undefined,
        }
    }
}

/// Curvatures, signed with the normal S_u × S_v: a sphere whose normal points outward has mean curvature −1 / R.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Curvature {
    /// K = k1 k2, 1 / units².
    pub gaussian: f64,
    /// H = (k1 + k2) / 2, 1 / units.
    pub mean: f64,
    /// The greater principal curvature.
    pub k1: f64,
    /// The lesser principal curvature.
    pub k2: f64,
}

/// Everything that is known of a surface at one parameter pair.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfacePoint {
    /// Position and derivatives.
    pub derivatives: SecondDerivatives,
    /// Unit normal along S_u × S_v.
    pub normal: Normal,
    /// Curvatures; `None` unless the normal is regular.
    pub curvature: Option<Curvature>,
}

impl Surface {
    /// Position, derivatives, normal and curvatures at (u, v).
    ///
    /// A normal is regular unless a side collapses there or S_u and S_v are parallel. Then the first term that does
    /// not vanish of S_u × S_v, expanded along a direction into the span, gives the limit along it; where all directions
    /// that are tried have one limit, that is the normal.
    pub fn inspect(&self, u: f64, v: f64) -> SurfacePoint {
        let [span_u, span_v] = [self.knots(Direction::U).find_span(u), self.knots(Direction::V).find_span(v)];
        self.inspect_on(span_u, span_v, u, v)
    }

    /// As [`Self::inspect`], with the polynomial of a given nonempty span: the other side of a crease, at its knot.
    pub fn inspect_on(&self, span_u: usize, span_v: usize, u: f64, v: f64) -> SurfacePoint {
        let share = |direction, span, t: f64| {
            let (start, length) = self.knots(direction).span(span);
            (t - start) / length
        };
        let t = || DVec2::new(share(Direction::U, span_u, u), share(Direction::V, span_v, v));
        self.interrogate(self.second_derivatives_on(span_u, span_v, u, v), [span_u, span_v], t)
    }

    /// As [`Self::inspect_on`], at `t` in 0 to 1 of the span, as [`Surface::second_derivatives_local`].
    pub fn inspect_local(&self, span: [usize; 2], t: DVec2) -> SurfacePoint {
        self.interrogate(self.second_derivatives_local(span, t), span, || t)
    }

    fn interrogate(&self, d: SecondDerivatives, span: [usize; 2], t: impl FnOnce() -> DVec2) -> SurfacePoint {
        let tangents = [d.su, d.sv].map(Tangent::new);
        let flat = self.collapsed(&tangents);
        let [u, v] = &tangents;
        let cross = u.scaled.cross(v.scaled);
        if flat == [false; 2] && cross.length() > PARALLEL * u.length * v.length {
            let n = cross.normalize();
            let curvature = curvature(&d, &tangents, n);
            return SurfacePoint { derivatives: d, normal: Normal::Regular(n), curvature: Some(curvature) };
        }
        SurfacePoint { derivatives: d, normal: self.limit_normal(span, t(), flat), curvature: None }
    }

    /// Whether S_u and S_v are zero to what the control points can tell.
    fn collapsed(&self, tangents: &[Tangent; 2]) -> [bool; 2] {
        let least = self.collapsed_below();
        [Direction::U, Direction::V].map(|direction| {
            let Tangent { length, unit, .. } = tangents[direction as usize];
            length * unit * self.knots(direction).length() <= least
        })
    }

    /// A derivative times the length of the domain counts as zero up to this, model units.
    pub(crate) fn collapsed_below(&self) -> f64 {
        let hull = self.hull();
        let farthest = hull.min.abs().max(hull.max.abs()).max_element();
        hull.diagonal() * COLLAPSED + farthest * 2.0 * f64::EPSILON
    }

    /// The limit of the normal at `t` of a span, if it is the same from every side in the span.
    fn limit_normal(&self, span: [usize; 2], t: DVec2, flat: [bool; 2]) -> Normal {
        let table = self.derivatives_by_local(span, t, LIMIT_ORDERS + 1);
        // Toward the span's middle first; away from it only where that is in the span, too.
        let signs = |t: f64| {
            let inward = if t < 0.5 { 1.0 } else { -1.0 };
            let both = 0.0 < t && t < 1.0;
            [inward, -inward].into_iter().take(1 + usize::from(both))
        };
        let mut limits = signs(t.x).flat_map(|du| signs(t.y).map(move |dv| [du, dv])).flat_map(|[du, dv]| {
            // Not along a side, where a side that is a point leaves nothing but rounding.
            LIMIT_SLOPES.map(|[a, b]| limit_along(&table, [a * du, b * dv], flat)).into_iter().flatten()
        });
        let Some(first) = limits.next() else { return Normal::Undefined };
        if limits.all(|other| first.distance(other) <= ONE_LIMIT) { Normal::Limit(first) } else { Normal::Undefined }
    }
}

/// S_u or S_v in a unit near its length: no square of it leaves f64.
struct Tangent {
    /// In that unit.
    scaled: DVec3,
    /// In that unit: 1 to 4, or less where it is below the smallest normal number.
    length: f64,
    /// A power of two, model units per unit of the parameter.
    unit: f64,
    /// 1 / `unit`, exact.
    scale: f64,
}

impl Tangent {
    fn new(derivative: DVec3) -> Self {
        let unit = power_of_two(derivative.abs().max_element());
        let scale = unit.recip();
        let scaled = derivative * scale;
        Self { scaled, length: scaled.length(), unit, scale }
    }
}

/// The limit of the normal along (du, dv), from a table of mixed derivatives to one order above [`LIMIT_ORDERS`].
fn limit_along(table: &[Vec<DVec3>], [du, dv]: [f64; 2], [flat_u, flat_v]: [bool; 2]) -> Option<DVec3> {
    // The k-th Taylor coefficient of the derivative (a, b).
    let taylor = |k: usize, a: usize, b: usize| {
        let mut sum = DVec3::ZERO;
        for i in 0..=k {
            let power = du.powi(i as i32) * dv.powi((k - i) as i32);
            sum += binomial(k, i) * power * table[a + i][b + k - i];
        }
        sum / (1..=k).map(|i| i as f64).product::<f64>()
    };
    let su = |k: usize| if k == 0 && flat_u { DVec3::ZERO } else { taylor(k, 1, 0) };
    let sv = |k: usize| if k == 0 && flat_v { DVec3::ZERO } else { taylor(k, 0, 1) };
    (1..=LIMIT_ORDERS).find_map(|m| {
        let terms: Vec<(DVec3, DVec3)> = (0..=m).map(|k| (su(k), sv(m - k))).collect();
        let sum: DVec3 = terms.iter().map(|(a, b)| a.cross(*b)).sum();
        let summands: f64 = terms.iter().map(|(a, b)| a.length() * b.length()).sum();
        (sum.length() > CANCELLED * summands).then(|| sum.normalize())
    })
}

/// Curvatures from the second fundamental form in the orthonormal frame e1 = S_u / |S_u|, e2 = n × e1.
///
/// There the shape operator is symmetric, so k1 − k2 = 2 √(((a − c) / 2)² + b²) has no cancellation at umbilics,
/// which the textbook √(H² − K) has. Of the two the one that is smaller in size is K over the other, for in H ∓ the root it
/// cancels: where one is 1e10 times the other nothing would be left.
///
/// The parameters are counted in units in which the tangents are about 1 long: then no square leaves f64.
fn curvature(d: &SecondDerivatives, [u, v]: &[Tangent; 2], n: DVec3) -> Curvature {
    let length = u.length;
    let e1 = u.scaled / length;
    let e2 = n.cross(e1);
    // S_v = f e1 + g e2; the inverse of that change of basis is applied to L, M, N.
    let (f, g) = (v.scaled.dot(e1), v.scaled.dot(e2));
    let l = (d.suu * u.scale * u.scale).dot(n);
    let m = (d.suv * u.scale * v.scale).dot(n);
    let nn = (d.svv * v.scale * v.scale).dot(n);
    let shear = f / length;
    let a = l / (length * length);
    let b = (m - shear * l) / (length * g);
    let c = (nn - 2.0 * shear * m + shear * shear * l) / (g * g);
    // In units of a power of two, in which K does not leave f64.
    let unit = power_of_two(a.abs().max(b.abs()).max(c.abs()));
    let scale = unit.recip();
    let (a, b, c) = (a * scale, b * scale, c * scale);
    let mean = 0.5 * (a + c);
    let x = 0.5 * (a - c);
    // Not `hypot`: that is the platform's, and this must be the same everywhere.
    let half = (x * x + b * b).sqrt();
    let gaussian = a * c - b * b;
    let larger = if mean < 0.0 { mean - half } else { mean + half };
    let smaller = if larger == 0.0 { 0.0 } else { gaussian / larger };
    let [k1, k2] = if mean < 0.0 { [smaller, larger] } else { [larger, smaller] };
    // An umbilic's two may come out in the wrong order by an ulp.
    let (k1, k2) = (k1.max(k2) * unit, k1.min(k2) * unit);
    Curvature { gaussian: gaussian * unit * unit, mean: mean * unit, k1, k2 }
}
