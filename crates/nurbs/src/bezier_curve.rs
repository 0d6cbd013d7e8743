//! Plane rational Bézier curves: evaluation, subdivision, and the area under them.

use crate::MAX_ORDER;
use crate::weights::ratio;
use glam::{DVec2, DVec3};

/// Halvings before an area stops being refined; each gains at least a factor 2³² on an analytic integrand.
const AREA_HALVINGS: u32 = 12;

/// The relative change, in units of the control polygon's own area scale, below which an area is accepted.
const AREA_AGREES: f64 = 1e-14;

/// A rectangle of the (u, v) plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rectangle {
    /// Least coordinates.
    pub min: DVec2,
    /// Greatest coordinates.
    pub max: DVec2,
}

impl Rectangle {
    /// The rectangle of no point: `min` = +∞, `max` = −∞.
    pub const EMPTY: Self = Self { min: DVec2::INFINITY, max: DVec2::NEG_INFINITY };

    /// The least rectangle that holds both.
    pub fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// Whether the closed rectangles have a point in common.
    pub fn meets(self, other: Self) -> bool {
        self.min.cmple(other.max).all() && other.min.cmple(self.max).all()
    }

    /// Sides.
    pub fn size(self) -> DVec2 {
        self.max - self.min
    }
}

/// A rational Bézier curve in the (u, v) plane, degree 1 to [`MAX_DEGREE`](crate::MAX_DEGREE), parameter 0 to 1.
///
/// Control points are homogeneous, (w u, w v, w), all weights positive.
#[derive(Debug, Clone, PartialEq)]
pub struct BezierCurve {
    pub(crate) control: Vec<DVec3>,
}

impl BezierCurve {
    /// The curve of the given homogeneous points; `None` unless they are 2 to [`MAX_ORDER`], finite, of positive weight.
    pub fn new(control: Vec<DVec3>) -> Option<Self> {
        let legal = control.iter().all(|c| c.is_finite() && c.z > 0.0);
        (legal && (2..=MAX_ORDER).contains(&control.len())).then_some(Self { control })
    }

    /// The straight segment from `start` to `end`.
    pub fn line(start: DVec2, end: DVec2) -> Self {
        Self { control: vec![start.extend(1.0), end.extend(1.0)] }
    }

    /// Degree p.
    pub fn degree(&self) -> usize {
        self.control.len() - 1
    }

    /// The p + 1 homogeneous control points (w u, w v, w).
    pub fn control(&self) -> &[DVec3] {
        &self.control
    }

    /// Whether the weights differ.
    pub fn is_rational(&self) -> bool {
        self.control.iter().any(|c| c.z != self.control[0].z)
    }

    /// The greatest ratio of two weights: 1 for a polynomial curve.
    pub fn weight_ratio(&self) -> f64 {
        ratio(self.control.iter().map(|c| c.z))
    }

    /// The first point; exact where the first weight is 1.
    pub fn start(&self) -> DVec2 {
        project(self.control[0])
    }

    /// The last point; exact where the last weight is 1.
    pub fn end(&self) -> DVec2 {
        project(self.control[self.degree()])
    }

    /// C(t) by de Casteljau's algorithm, within 2 p ulp of the largest control point for t in 0 to 1.
    pub fn point(&self, t: f64) -> DVec2 {
        project(self.homogeneous(t)[0])
    }

    /// The parameter at which coordinate `axis` of a monotone curve passes `value`, by bisection to the last bit; an end where
    /// it does not.
    pub fn crossing(&self, axis: usize, value: f64) -> f64 {
        let rises = self.start()[axis] < self.end()[axis];
        let (mut low, mut high) = (0.0, 1.0);
        loop {
            let middle = 0.5 * (low + high);
            if middle <= low || middle >= high {
                return middle;
            }
            if (self.point(middle)[axis] < value) == rises { low = middle } else { high = middle }
        }
    }

    /// C(t) and C'(t).
    pub fn first_derivative(&self, t: f64) -> [DVec2; 2] {
        let [a, a_t] = self.homogeneous(t);
        let c = project(a);
        [c, (a_t.truncate() - c * a_t.z) / a.z]
    }

    /// The homogeneous point and its derivative at `t`.
    #[inline(always)]
    fn homogeneous(&self, t: f64) -> [DVec3; 2] {
        // To clear an array for the greatest degree takes longer than the sums of a usual one.
        match self.control.len() {
            2 => de_casteljau::<2>(&self.control[..2], t),
            3 => de_casteljau::<3>(&self.control[..3], t),
            4 => de_casteljau::<4>(&self.control[..4], t),
            _ => de_casteljau::<MAX_ORDER>(&self.control, t),
        }
    }

    /// The two parts below and above `t`, in 0 to 1. They share the control point in the middle, weight and all.
    pub fn split(&self, t: f64) -> [Self; 2] {
        let p = self.degree();
        let mut low = Vec::with_capacity(p + 1);
        // What is done with in a row of the triangle is a point of the part above.
        let mut high = self.control.clone();
        for r in 0..p + 1 {
            low.push(high[0]);
            for i in 0..p - r {
                high[i] = high[i] * (1.0 - t) + high[i + 1] * t;
            }
        }
        [Self { control: low }, Self { control: high }]
    }

    /// The same curve run backwards.
    pub fn reversed(&self) -> Self {
        Self { control: self.control.iter().rev().copied().collect() }
    }

    /// The curve moved by `offset`.
    pub fn translated(&self, offset: DVec2) -> Self {
        Self { control: self.control.iter().map(|c| *c + (offset * c.z).extend(0.0)).collect() }
    }

    /// The box of the Euclidean control points, which holds the curve up to 2 ulp of its coordinates.
    pub fn hull(&self) -> Rectangle {
        let grow = |hull: Rectangle, c: &DVec3| {
            let p = project(*c);
            Rectangle { min: hull.min.min(p), max: hull.max.max(p) }
        };
        self.control.iter().fold(Rectangle::EMPTY, grow)
    }

    /// The same points with first and last weight 1, so that the ends are to the bit their own control points.
    ///
    /// All weights are scaled by a geometric sequence, which moves the parameter and not the curve (Farin, *Curves
    /// and Surfaces for CAGD*, Sec. 13.5).
    pub fn standardised(mut self) -> Self {
        let p = self.degree();
        let (first, last) = (self.control[0].z, self.control[p].z);
        if first == 1.0 && last == 1.0 {
            return self;
        }
        let (start, end) = (self.start(), self.end());
        if first == last {
            self.control.iter_mut().for_each(|c| *c /= first);
        } else {
            // Not `powf`: that is the platform's. A p-th root to the last bit is not needed: the ends are set below.
            let ratio = root(first / last, p);
            let mut factor = 1.0 / first;
            for c in &mut self.control {
                *c *= factor;
                factor *= ratio;
            }
        }
        self.set_ends(start, end);
        self
    }

    /// Puts the first and the last control point, with weight 1: for ends moved by no more than rounding or a gap.
    pub fn set_ends(&mut self, start: DVec2, end: DVec2) {
        let p = self.degree();
        self.control[0] = start.extend(1.0);
        self.control[p] = end.extend(1.0);
    }

    /// The signed area swept by the ray from `about` to the curve: ½ ∫ (C − about) × C' dt.
    ///
    /// Over a closed chain these sum to the area inside, positive counter-clockwise (Green). Gauss–Legendre of 16
    /// points, exact for polynomial curves up to degree 16, and halved for rational ones until the halves agree with
    /// the whole to 1e-14 of the control polygon's extent about `about`.
    pub fn area(&self, about: DVec2) -> f64 {
        let moved = self.translated(-about);
        let hull = moved.hull();
        let reach = hull.min.abs().max(hull.max.abs());
        // Beside the agreement that is asked for, what the coordinates' own rounding leaves.
        let enough = AREA_AGREES * reach.x * reach.y + 8.0 * f64::EPSILON * reach.length_squared();
        let whole = moved.quadrature(0.0, 1.0);
        if self.is_rational() { moved.refined_area([0.0, 1.0], whole, enough, AREA_HALVINGS) } else { whole }
    }

    fn refined_area(&self, [a, b]: [f64; 2], whole: f64, enough: f64, halvings: u32) -> f64 {
        let middle = 0.5 * (a + b);
        let (low, high) = (self.quadrature(a, middle), self.quadrature(middle, b));
        if halvings == 0 || (low + high - whole).abs() <= enough {
            return low + high;
        }
        self.refined_area([a, middle], low, enough, halvings - 1)
            + self.refined_area([middle, b], high, enough, halvings - 1)
    }

    /// The area swept about the origin between two parameters.
    fn quadrature(&self, a: f64, b: f64) -> f64 {
        let (middle, half) = (0.5 * (a + b), 0.5 * (b - a));
        let swept = |t: f64| {
            let [c, c_t] = self.first_derivative(t);
            c.perp_dot(c_t)
        };
        let sum: f64 =
            GAUSS_LEGENDRE.iter().map(|&[x, w]| w * (swept(middle - half * x) + swept(middle + half * x))).sum();
        0.5 * half * sum
    }
}

/// Abscissae and weights of the 16-point rule on −1 to 1, the positive half (Abramowitz & Stegun, Table 25.4).
const GAUSS_LEGENDRE: [[f64; 2]; 8] = [
    [0.095_012_509_837_637_44, 0.189_450_610_455_068_5],
    [0.281_603_550_779_258_9, 0.182_603_415_044_923_6],
    [0.458_016_777_657_227_4, 0.169_156_519_395_002_54],
    [0.617_876_244_402_643_7, 0.149_595_988_816_576_74],
    [0.755_404_408_355_003, 0.124_628_971_255_533_87],
    [0.865_631_202_387_831_7, 0.095_158_511_682_492_78],
    [0.944_575_023_073_232_6, 0.062_253_523_938_647_89],
    [0.989_400_934_991_649_9, 0.027_152_459_411_754_095],
];

/// The point and its derivative at `t` of at most `C` homogeneous points.
#[inline(always)]
fn de_casteljau<const C: usize>(control: &[DVec3], t: f64) -> [DVec3; 2] {
    let p = control.len() - 1;
    let mut d = [DVec3::ZERO; C];
    d[..p + 1].copy_from_slice(control);
    for r in 1..p {
        for i in 0..p - r + 1 {
            d[i] = d[i] * (1.0 - t) + d[i + 1] * t;
        }
    }
    [d[0] * (1.0 - t) + d[1] * t, (d[1] - d[0]) * p as f64]
}

fn project(c: DVec3) -> DVec2 {
    c.truncate() / c.z
}

/// The positive p-th root of `x`, by Newton's method from above: monotone, so that it ends where it stops falling.
fn root(x: f64, p: usize) -> f64 {
    let n = p as f64;
    let mut y = x.max(1.0);
    loop {
        let next = y - (y - x / y.powi(p as i32 - 1)) / n;
        if next < y {
            y = next;
        } else {
            return y;
        }
    }
}
