//! All roots of two bivariate Bézier polynomials over the unit square.
//!
//! The polynomials are the distances, times weight, of a piece to two planes through the ray; their common roots are
//! the ray's hits. A box of parameters is taken apart until it is proven to hold no root, proven to hold at most one
//! that Newton's method then finds, or cannot be told from a tangent by f64: nothing is dropped without a proof.
//! The method is that of Bézier clipping (Nishita, Sederberg & Kakimoto 1990, doi:10.1145/97880.97916) with the sign
//! tests in directions taken from the Jacobian, and Krawczyk's operator instead of the clipping of hulls.
//!
//! Rounding. A [`Net`] carries a bound `error` of each coefficient's error in either polynomial. Subdivision forms
//! convex combinations, which do not amplify it, and adds at most p (halving) or 6 p (a range) roundings of the
//! greatest coefficient. A combination x f1 + y f2 is off by (|x| + |y|) (error + 2 u max |f|) (u = 2⁻⁵³; two products
//! and a sum). Signs count only beyond these bounds.

use crate::pieces::UNIT;
use nurbs::MAX_ORDER;

/// Most boxes that are examined in one piece. A curve of hits (a ray inside a curved ruled surface, say) has no end
/// of boxes; the cap ends it, and what is left is reported as [`Found::Unresolved`].
pub(crate) const MAX_BOXES: u32 = 4096;

/// Most halvings of a box, both directions counted. 2⁻⁵² of a piece in both is where parameters end.
const MAX_DEPTH: u32 = 104;

/// Most roots and tangents of one piece. Bézout allows 2 p q ≤ 450, and no real piece has 64.
const MAX_FOUND: usize = 64;

/// Rows of |I − Y J| must sum to less than this for "at most one root" and for a contraction.
///
/// Below 1 is enough for exactly the box; the rest of the way to 1 pays for [`BESIDE`].
const CONTRACTION: f64 = 0.9;

/// A root this far outside its box, in sizes of the box, is still the one root that the box can have.
const BESIDE: f64 = 1e-6;

/// A contraction keeps at least this share of a side, so that no box gets an empty side at its border.
const NARROWEST: f64 = 1.0 / 1048576.0;

/// Newton's method inside a piece stops at steps below this; the surface's own evaluation finishes the root, and
/// squares the error twice while it does.
const CLOSE: f64 = 1e-6;

/// Most Newton steps inside a piece. Under [`CONTRACTION`] it converges in at most five; more means it does not.
const NEWTON_MAX_STEPS: u32 = 12;

/// A polynomial whose coefficients are all below this many times their error is indistinguishable from zero.
const INDISTINCT: f64 = 2.0;

/// What the search in a piece came to, for one box. Parameters are local to the piece, 0 to 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Found {
    /// The only root of a box, to about 1e-12.
    Root([f64; 2]),
    /// A box in which one combination of the polynomials is zero to rounding: a tangent, a pole, or a ray that runs
    /// inside the surface. `along` is the other combination, a unit vector in the two planes' distances.
    Tangent {
        /// Least parameters.
        low: [f64; 2],
        /// Extent.
        size: [f64; 2],
        /// Direction in (f1, f2) in which the box still has an extent.
        along: [f64; 2],
    },
    /// A box that a cap left undecided.
    Unresolved {
        /// Least parameters.
        low: [f64; 2],
        /// Extent.
        size: [f64; 2],
        /// Whether it was the cap of halvings (else of boxes).
        deepest: bool,
    },
}

/// Two polynomials of degree p × q over a box of the piece. `C` is at least (p + 1) (q + 1).
#[derive(Debug, Clone, Copy)]
pub(crate) struct Net<const C: usize> {
    /// Least parameters of the box.
    pub low: [f64; 2],
    /// Extent of the box.
    pub size: [f64; 2],
    /// Bound of every coefficient's error.
    pub error: f64,
    /// Halvings so far.
    pub depth: u32,
    /// Coefficients (f1, f2), row-major in u.
    pub f: [[f64; 2]; C],
}

/// Memory that a search reuses.
#[derive(Debug, Default)]
pub(crate) struct Search {
    small: Vec<Net<16>>,
    medium: Vec<Net<64>>,
    large: Vec<Net<{ MAX_ORDER * MAX_ORDER }>>,
    /// What was found in the piece searched last.
    pub found: Vec<Found>,
    /// Boxes examined since the start.
    pub boxes: u64,
}

/// What one box came to.
enum Step {
    Empty,
    Root([f64; 2]),
    Tangent([f64; 2]),
    Shrink([[f64; 2]; 2]),
    Split,
}

impl Search {
    /// Searches the piece of degree p × q whose coefficients `coefficient` yields by index, each within `error`.
    #[inline]
    pub fn search(&mut self, [p, q]: [usize; 2], error: f64, coefficient: impl Fn(usize) -> [f64; 2]) {
        self.found.clear();
        let Self { small, medium, large, found, boxes } = self;
        match [p, q] {
            [3, 3] => search(3, 3, error, coefficient, small, found, boxes),
            [2, 2] => search(2, 2, error, coefficient, small, found, boxes),
            [0..=3, 0..=3] => search(p, q, error, coefficient, small, found, boxes),
            [0..=7, 0..=7] => search(p, q, error, coefficient, medium, found, boxes),
            _ => search(p, q, error, coefficient, large, found, boxes),
        }
    }
}

#[inline(always)]
fn search<const C: usize>(
    p: usize,
    q: usize,
    error: f64,
    coefficient: impl Fn(usize) -> [f64; 2],
    stack: &mut Vec<Net<C>>,
    found: &mut Vec<Found>,
    boxes: &mut u64,
) {
    let mut net = Net { low: [0.0; 2], size: [1.0; 2], error, depth: 0, f: [[0.0; 2]; C] };
    for k in 0..(p + 1) * (q + 1) {
        net.f[k] = coefficient(k);
    }
    *boxes += 1;
    if excluded_by_planes(p, q, &net) {
        return;
    }
    stack.clear();
    refine(p, q, net, stack, found, boxes);
}

/// Takes boxes apart until none is left.
#[inline(always)]
fn refine<const C: usize>(
    p: usize,
    q: usize,
    mut net: Net<C>,
    stack: &mut Vec<Net<C>>,
    found: &mut Vec<Found>,
    boxes: &mut u64,
) {
    let mut examined = 1;
    loop {
        let exhausted = examined >= MAX_BOXES || found.len() >= MAX_FOUND;
        let deepest = net.depth >= MAX_DEPTH;
        match examine(p, q, &net) {
            Step::Empty => {}
            Step::Root(x) => found.push(Found::Root([0, 1].map(|k| net.low[k] + net.size[k] * x[k]))),
            Step::Tangent(along) => found.push(Found::Tangent { low: net.low, size: net.size, along }),
            _ if exhausted || deepest => found.push(Found::Unresolved { low: net.low, size: net.size, deepest }),
            Step::Shrink(range) => {
                net = net.restricted(p, q, range);
                examined += 1;
                *boxes += 1;
                continue;
            }
            Step::Split => {
                let [low, high] = net.halves(p, q);
                stack.push(high);
                net = low;
                examined += 1;
                *boxes += 1;
                continue;
            }
        }
        let Some(next) = stack.pop() else { return };
        net = next;
        examined += 1;
        *boxes += 1;
    }
}

#[inline(always)]
fn lesser(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

#[inline(always)]
fn greater(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// Componentwise least and greatest of the first `count` entries.
#[inline(always)]
fn range(f: &[[f64; 2]], count: usize) -> ([f64; 2], [f64; 2]) {
    let (mut low, mut high) = (f[0], f[0]);
    for x in &f[1..count] {
        for k in 0..2 {
            low[k] = lesser(x[k], low[k]);
            high[k] = greater(x[k], high[k]);
        }
    }
    (low, high)
}

/// Whether one of two polynomials keeps its sign, each beyond its own error.
#[inline(always)]
fn one_sided((low, high): ([f64; 2], [f64; 2]), error: [f64; 2]) -> bool {
    low[0] > error[0] || low[1] > error[1] || high[0] < -error[0] || high[1] < -error[1]
}

#[inline(always)]
fn excluded_by_planes<const C: usize>(p: usize, q: usize, net: &Net<C>) -> bool {
    one_sided(range(&net.f, (p + 1) * (q + 1)), [net.error; 2])
}

/// Decides a box, or says how to go on.
#[inline(always)]
fn examine<const C: usize>(p: usize, q: usize, net: &Net<C>) -> Step {
    let (m, count) = (q + 1, (p + 1) * (q + 1));
    let f = &net.f;
    let planes = range(f, count);
    if one_sided(planes, [net.error; 2]) {
        return Step::Empty;
    }
    let size = planes.0.into_iter().chain(planes.1).fold(0.0, |s: f64, x| greater(s, x.abs()));
    let error = net.error + 2.0 * UNIT * size;

    // Mean derivatives: differences telescope to those of opposite sides.
    let (mut a, mut b) = ([0.0; 2], [0.0; 2]);
    for k in 0..2 {
        for j in 0..m {
            a[k] += f[p * m + j][k] - f[j][k];
        }
        for i in 0..=p {
            b[k] += f[i * m + q][k] - f[i * m][k];
        }
        a[k] /= m as f64;
        b[k] /= (p + 1) as f64;
    }

    // The adjugate of the mean Jacobian makes g1 depend on u and g2 on v alone, up to bending.
    let mut g = [[0.0; 2]; C];
    for (g, f) in g[..count].iter_mut().zip(&f[..count]) {
        *g = [b[1] * f[0] - b[0] * f[1], a[0] * f[1] - a[1] * f[0]];
    }
    let norms = [b[0].abs() + b[1].abs(), a[0].abs() + a[1].abs()];
    let errors = norms.map(|n| n * error);
    let turned = range(&g, count);
    if one_sided(turned, errors) {
        return Step::Empty;
    }

    // Bounds of I − Y J over the box, Y = adjugate / determinant, from first differences.
    let mut det = a[0] * b[1] - a[1] * b[0];
    // Determinant by its own error: if it may be zero, nothing below holds.
    let det_error = 4.0 * UNIT * (a[0] * b[1]).abs().max((a[1] * b[0]).abs());
    if det.abs() <= det_error {
        det = 0.0;
    }
    if det != 0.0 {
        let r = 1.0 / det;
        let (mut u_low, mut u_high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        let (mut v_low, mut v_high) = (u_low, u_high);
        for i in 0..p {
            for j in 0..m {
                for k in 0..2 {
                    let d = g[(i + 1) * m + j][k] - g[i * m + j][k];
                    u_low[k] = lesser(d, u_low[k]);
                    u_high[k] = greater(d, u_high[k]);
                }
            }
        }
        for i in 0..=p {
            for j in 0..q {
                for k in 0..2 {
                    let d = g[i * m + j + 1][k] - g[i * m + j][k];
                    v_low[k] = lesser(d, v_low[k]);
                    v_high[k] = greater(d, v_high[k]);
                }
            }
        }
        let (ru, rv) = (p as f64 * r, q as f64 * r);
        let off = |low: f64, high: f64, scale: f64, unity: f64| {
            greater((low * scale - unity).abs(), (high * scale - unity).abs())
        };
        let noise = [errors[0] * r.abs(), errors[1] * r.abs()];
        let slack = 2.0 * (p + q) as f64;
        let row = [
            off(u_low[0], u_high[0], ru, 1.0) + off(v_low[0], v_high[0], rv, 0.0) + slack * noise[0],
            off(u_low[1], u_high[1], ru, 0.0) + off(v_low[1], v_high[1], rv, 1.0) + slack * noise[1],
        ];
        if row[0] < CONTRACTION && row[1] < CONTRACTION {
            // Krawczyk's operator about the middle.
            let (bu, bv) = (&MIDDLE[p], &MIDDLE[q]);
            let mut middle = [0.0; 2];
            for i in 0..=p {
                let mut line = [0.0; 2];
                for j in 0..m {
                    for k in 0..2 {
                        line[k] += bv[j] * g[i * m + j][k];
                    }
                }
                for k in 0..2 {
                    middle[k] += bu[i] * line[k];
                }
            }
            let center = [0.5 - middle[0] * r, 0.5 - middle[1] * r];
            // The sum for the middle has p + q roundings more.
            let radius = [0, 1].map(|k| 0.5 * row[k] + noise[k] * (2 + p + q) as f64);
            let krawczyk = [0, 1].map(|k| [center[k] - radius[k], center[k] + radius[k]]);
            if krawczyk.iter().any(|&[low, high]| high < 0.0 || low > 1.0) {
                return Step::Empty;
            }
            let start = center.map(|c| c.clamp(0.0, 1.0));
            if let Some(x) = newton(p, q, f, start) {
                let inside = |x: f64| (-BESIDE..=1.0 + BESIDE).contains(&x);
                if inside(x[0]) && inside(x[1]) {
                    return Step::Root(x);
                }
            }
            let range = krawczyk.map(|[low, high]| [low.clamp(0.0, 1.0 - NARROWEST), high.clamp(NARROWEST, 1.0)]);
            if (range[0][1] - range[0][0]) * (range[1][1] - range[1][0]) < 0.5 {
                return Step::Shrink(range);
            }
            return Step::Split;
        }
    }

    // The principal direction of the image, and the one across: near a tangent the box is a thin curve.
    let (aa, ab, bb) = (a[0] * a[0] + b[0] * b[0], a[0] * a[1] + b[0] * b[1], a[1] * a[1] + b[1] * b[1]);
    let root = (0.25 * (aa - bb) * (aa - bb) + ab * ab).sqrt();
    let eigenvalue = 0.5 * (aa + bb) + root;
    let along = if aa >= bb { [eigenvalue - bb, ab] } else { [ab, eigenvalue - aa] };
    let length = (along[0] * along[0] + along[1] * along[1]).sqrt();
    let along = if length > 0.0 { along.map(|x| x / length) } else { [1.0, 0.0] };
    for (g, f) in g[..count].iter_mut().zip(&f[..count]) {
        *g = [along[0] * f[0] + along[1] * f[1], along[0] * f[1] - along[1] * f[0]];
    }
    let (low, high) = range(&g, count);
    let error = error * (along[0].abs() + along[1].abs());
    if one_sided((low, high), [error; 2]) {
        return Step::Empty;
    }
    if greater(high[1], -low[1]) <= INDISTINCT * error {
        return Step::Tangent(along);
    }
    Step::Split
}

/// Newton's method on the polynomials from `start` in the unit square; `None` where it does not converge near it.
#[inline(always)]
fn newton<const C: usize>(p: usize, q: usize, f: &[[f64; 2]; C], start: [f64; 2]) -> Option<[f64; 2]> {
    let mut x = start;
    for _ in 0..NEWTON_MAX_STEPS {
        let [s, s_u, s_v] = evaluate(p, q, f, x);
        let det = s_u[0] * s_v[1] - s_u[1] * s_v[0];
        let step = [(s[0] * s_v[1] - s[1] * s_v[0]) / det, (s[1] * s_u[0] - s[0] * s_u[1]) / det];
        x = [x[0] - step[0], x[1] - step[1]];
        // Also false for what is not a number.
        if !(x[0].abs() <= 2.0 && x[1].abs() <= 2.0) {
            return None;
        }
        if step[0].abs() <= CLOSE && step[1].abs() <= CLOSE {
            return Some(x);
        }
    }
    None
}

/// Value and first derivatives at x, by de Casteljau's algorithm in v and then in u.
#[inline(always)]
fn evaluate<const C: usize>(p: usize, q: usize, f: &[[f64; 2]; C], x: [f64; 2]) -> [[f64; 2]; 3] {
    let m = q + 1;
    let (mut value, mut by_v) = ([[0.0; 2]; MAX_ORDER], [[0.0; 2]; MAX_ORDER]);
    for i in 0..=p {
        let mut line = [[0.0; 2]; MAX_ORDER];
        line[..m].copy_from_slice(&f[i * m..i * m + m]);
        (value[i], by_v[i]) = de_casteljau(q, &mut line, x[1]);
    }
    let (s, s_u) = de_casteljau(p, &mut value, x[0]);
    let (s_v, _) = de_casteljau(p, &mut by_v, x[0]);
    [s, s_u, s_v]
}

/// Value and derivative of a curve at t; overwrites the coefficients.
#[inline(always)]
fn de_casteljau(p: usize, line: &mut [[f64; 2]; MAX_ORDER], t: f64) -> ([f64; 2], [f64; 2]) {
    let s = 1.0 - t;
    for r in 1..p {
        for i in 0..=p - r {
            for k in 0..2 {
                line[i][k] = line[i][k] * s + line[i + 1][k] * t;
            }
        }
    }
    let value = [0, 1].map(|k| line[0][k] * s + line[1][k] * t);
    let derivative = [0, 1].map(|k| (line[1][k] - line[0][k]) * p as f64);
    (value, derivative)
}

impl<const C: usize> Net<C> {
    /// The greatest size of a coefficient.
    #[inline(always)]
    fn greatest(&self, p: usize, q: usize) -> f64 {
        self.f[..(p + 1) * (q + 1)].iter().flatten().fold(0.0, |s: f64, x| greater(s, x.abs()))
    }

    /// The two halves of the box, across the direction in which the image is longer.
    #[inline(always)]
    fn halves(&self, p: usize, q: usize) -> [Self; 2] {
        let m = q + 1;
        let (mut by_u, mut by_v) = (0.0, 0.0);
        let length = |x: [f64; 2], y: [f64; 2]| (x[0] - y[0]).abs() + (x[1] - y[1]).abs();
        for i in 0..p {
            for j in 0..m {
                by_u = greater(by_u, length(self.f[(i + 1) * m + j], self.f[i * m + j]));
            }
        }
        for i in 0..=p {
            for j in 0..q {
                by_v = greater(by_v, length(self.f[i * m + j + 1], self.f[i * m + j]));
            }
        }
        let axis = usize::from(by_u * (p as f64) < by_v * q as f64);
        let error = self.error + [p, q][axis] as f64 * UNIT * self.greatest(p, q);
        let [mut low, mut high] = [Self { error, depth: self.depth + 1, ..*self }; 2];
        for half in [&mut low, &mut high] {
            half.size[axis] *= 0.5;
        }
        high.low[axis] += high.size[axis];
        let (lines, degree, line_step, step) = if axis == 0 { (m, p, 1, m) } else { (p + 1, q, m, 1) };
        for line in 0..lines {
            let at = |i: usize| line * line_step + i * step;
            let mut d = [[0.0; 2]; MAX_ORDER];
            for i in 0..=degree {
                d[i] = self.f[at(i)];
            }
            for r in 0..=degree {
                low.f[at(r)] = d[0];
                high.f[at(degree - r)] = d[degree - r];
                for i in 0..degree - r {
                    for k in 0..2 {
                        d[i][k] = 0.5 * (d[i][k] + d[i + 1][k]);
                    }
                }
            }
        }
        [low, high]
    }

    /// The part over `range`, in sizes of this box.
    #[inline(always)]
    fn restricted(&self, p: usize, q: usize, range: [[f64; 2]; 2]) -> Self {
        let m = q + 1;
        let mut part = *self;
        part.depth += 1;
        part.error += 6.0 * (p + q) as f64 * UNIT * self.greatest(p, q);
        for axis in 0..2 {
            let [start, end] = range[axis];
            part.low[axis] += part.size[axis] * start;
            part.size[axis] *= end - start;
            let (lines, degree, line_step, step) = if axis == 0 { (m, p, 1, m) } else { (p + 1, q, m, 1) };
            for line in 0..lines {
                let at = |i: usize| line * line_step + i * step;
                let mut d = [[0.0; 2]; MAX_ORDER];
                for i in 0..=degree {
                    d[i] = part.f[at(i)];
                }
                cut(degree, &mut d, end, start / end);
                for i in 0..=degree {
                    part.f[at(i)] = d[i];
                }
            }
        }
        part
    }
}

/// The coefficients over \[end · start, end\]: first the part below `end`, then of that the part above `start`.
#[inline(always)]
fn cut(p: usize, d: &mut [[f64; 2]; MAX_ORDER], end: f64, start: f64) {
    let lerp = |x: [f64; 2], y: [f64; 2], t: f64| [0, 1].map(|k| x[k] * (1.0 - t) + y[k] * t);
    for r in 1..=p {
        for i in (r..=p).rev() {
            d[i] = lerp(d[i - 1], d[i], end);
        }
    }
    for r in 1..=p {
        for i in 0..=p - r {
            d[i] = lerp(d[i], d[i + 1], start);
        }
    }
}

/// Bernstein polynomials at ½ by degree: binomials over 2^p.
const MIDDLE: [[f64; MAX_ORDER]; MAX_ORDER] = {
    let mut table = [[0.0; MAX_ORDER]; MAX_ORDER];
    table[0][0] = 1.0;
    let mut p = 1;
    while p < MAX_ORDER {
        let mut i = 0;
        while i <= p {
            table[p][i] = 0.5 * (table[p - 1][i] + if i > 0 { table[p - 1][i - 1] } else { 0.0 });
            i += 1;
        }
        p += 1;
    }
    table
};
