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
use glam::DVec2;
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
    Root(DVec2),
    /// A box in which one combination of the polynomials is zero to rounding: a tangent, a pole, or a ray that runs
    /// inside the surface.
    Tangent {
        /// Least parameters.
        low: DVec2,
        /// Greatest parameters.
        high: DVec2,
        /// The other combination, in which the box still has an extent: a unit vector in (f1, f2).
        along: DVec2,
    },
    /// A box that a cap left undecided.
    Unresolved {
        /// Least parameters.
        low: DVec2,
        /// Greatest parameters.
        high: DVec2,
        /// Whether it was the cap of halvings (else of boxes).
        deepest: bool,
    },
}

/// Two polynomials of degree p × q over a box of the piece. `C` is at least (p + 1) (q + 1).
#[derive(Debug, Clone, Copy)]
struct Net<const C: usize> {
    /// Least parameters of the box.
    low: DVec2,
    /// Extent of the box.
    size: DVec2,
    /// Bound of every coefficient's error.
    error: f64,
    /// Halvings so far.
    depth: u32,
    /// Coefficients (f1, f2), row-major in u.
    f: [DVec2; C],
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
    /// It holds no root.
    Empty,
    /// It holds no root but this one, in sizes of the box.
    Root(DVec2),
    /// See [`Found::Tangent`].
    Tangent(DVec2),
    /// Its roots are between these two, in sizes of the box.
    Shrink(DVec2, DVec2),
    /// Unknown.
    Split,
}

impl Search {
    /// Searches the piece of degree p × q whose coefficients `coefficient` yields by index, each within `error`.
    #[inline]
    pub fn search(&mut self, [p, q]: [usize; 2], error: f64, coefficient: impl Fn(usize) -> DVec2) {
        self.found.clear();
        let Self { small, medium, large, found, boxes } = self;
        // Constant degrees let the compiler unroll; these two are nearly all of the world's surfaces.
        match [p, q] {
            [3, 3] => search(3, 3, error, coefficient, small, found, boxes),
            [2, 2] => search(2, 2, error, coefficient, small, found, boxes),
            [0..=3, 0..=3] => search(p, q, error, coefficient, small, found, boxes),
            [0..=7, 0..=7] => search(p, q, error, coefficient, medium, found, boxes),
            _ => search(p, q, error, coefficient, large, found, boxes),
        }
    }
}

/// Takes boxes apart until none is left.
#[inline(always)]
fn search<const C: usize>(
    p: usize,
    q: usize,
    error: f64,
    coefficient: impl Fn(usize) -> DVec2,
    stack: &mut Vec<Net<C>>,
    found: &mut Vec<Found>,
    boxes: &mut u64,
) {
    let mut net = Net { low: DVec2::ZERO, size: DVec2::ONE, error, depth: 0, f: [DVec2::ZERO; C] };
    for k in 0..(p + 1) * (q + 1) {
        net.f[k] = coefficient(k);
    }
    stack.clear();
    let mut examined = 0;
    loop {
        examined += 1;
        let exhausted = examined >= MAX_BOXES || found.len() >= MAX_FOUND;
        let deepest = net.depth >= MAX_DEPTH;
        match examine(p, q, &net) {
            Step::Empty => {}
            Step::Root(x) => found.push(Found::Root(net.low + net.size * x)),
            Step::Tangent(along) => found.push(Found::Tangent { low: net.low, high: net.high(), along }),
            _ if exhausted || deepest => {
                found.push(Found::Unresolved { low: net.low, high: net.high(), deepest });
            }
            Step::Shrink(low, high) => {
                net.restrict(p, q, low, high);
                continue;
            }
            Step::Split => {
                stack.push(net);
                let high = stack.last_mut().expect("pushed just now");
                net.halve(p, q, high);
                continue;
            }
        }
        match stack.pop() {
            Some(next) => net = next,
            None => break,
        }
    }
    *boxes += u64::from(examined);
}

#[inline(always)]
fn lesser(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

#[inline(always)]
fn greater(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// Componentwise least and greatest.
#[derive(Clone, Copy)]
struct Range {
    low: DVec2,
    high: DVec2,
}

impl Range {
    const NONE: Self = Self { low: DVec2::INFINITY, high: DVec2::NEG_INFINITY };

    #[inline(always)]
    fn with(self, x: DVec2) -> Self {
        Self {
            low: DVec2::new(lesser(x.x, self.low.x), lesser(x.y, self.low.y)),
            high: DVec2::new(greater(x.x, self.high.x), greater(x.y, self.high.y)),
        }
    }

    #[inline(always)]
    fn of(f: &[DVec2]) -> Self {
        let mut range = Self::NONE;
        for &x in f {
            range = range.with(x);
        }
        range
    }

    /// Whether one of the two polynomials keeps its sign, beyond its own error.
    #[inline(always)]
    fn is_one_sided(self, error: DVec2) -> bool {
        self.low.x > error.x || self.low.y > error.y || self.high.x < -error.x || self.high.y < -error.y
    }

    /// The greatest size of either component.
    #[inline(always)]
    fn size(self) -> f64 {
        greater(greater(self.high.x, -self.low.x), greater(self.high.y, -self.low.y))
    }

    /// By component, the greatest distance of `scale` times an entry from `target`.
    #[inline(always)]
    fn off(self, scale: f64, target: DVec2) -> DVec2 {
        let (low, high) = ((self.low * scale - target).abs(), (self.high * scale - target).abs());
        DVec2::new(greater(low.x, high.x), greater(low.y, high.y))
    }
}

/// Decides a box, or says how to go on.
#[inline(always)]
fn examine<const C: usize>(p: usize, q: usize, net: &Net<C>) -> Step {
    let (m, count) = (q + 1, (p + 1) * (q + 1));
    let f = &net.f[..count];
    let planes = Range::of(f);
    if planes.is_one_sided(DVec2::splat(net.error)) {
        return Step::Empty;
    }
    let error = net.error + 2.0 * UNIT * planes.size();

    // Mean derivatives: differences telescope to those of opposite sides.
    let (mut a, mut b) = (DVec2::ZERO, DVec2::ZERO);
    for j in 0..m {
        a += f[p * m + j] - f[j];
    }
    for i in 0..p + 1 {
        b += f[i * m + q] - f[i * m];
    }
    a /= m as f64;
    b /= (p + 1) as f64;

    // The adjugate of the mean Jacobian makes g1 depend on u and g2 on v alone, up to bending.
    let mut g = [DVec2::ZERO; C];
    for k in 0..count {
        g[k] = DVec2::new(b.y * f[k].x - b.x * f[k].y, a.x * f[k].y - a.y * f[k].x);
    }
    let g = &mut g[..count];
    let errors = DVec2::new(b.x.abs() + b.y.abs(), a.x.abs() + a.y.abs()) * error;
    if Range::of(g).is_one_sided(errors) {
        return Step::Empty;
    }

    // Where rounding alone may make up the determinant, nothing that divides by it holds.
    let (one, other) = (a.x * b.y, a.y * b.x);
    let det = one - other;
    if det.abs() > 4.0 * UNIT * greater(one.abs(), other.abs()) {
        // Bounds of I − Y J over the box, Y = adjugate / determinant, from first differences.
        let r = 1.0 / det;
        let (mut by_u, mut by_v) = (Range::NONE, Range::NONE);
        for k in 0..p * m {
            by_u = by_u.with(g[k + m] - g[k]);
        }
        for i in 0..p + 1 {
            for j in 0..q {
                by_v = by_v.with(g[i * m + j + 1] - g[i * m + j]);
            }
        }
        let noise = errors * r.abs();
        let rows = by_u.off(p as f64 * r, DVec2::X) + by_v.off(q as f64 * r, DVec2::Y) + noise * (2 * (p + q)) as f64;
        if rows.x < CONTRACTION && rows.y < CONTRACTION {
            return contract(p, q, f, g, r, rows, noise);
        }
    }

    // The principal direction of the image, and the one across: near a tangent the box is a thin curve.
    let (xx, xy, yy) = (a.x * a.x + b.x * b.x, a.x * a.y + b.x * b.y, a.y * a.y + b.y * b.y);
    let root = (0.25 * (xx - yy) * (xx - yy) + xy * xy).sqrt();
    let eigenvalue = 0.5 * (xx + yy) + root;
    let along = if xx >= yy { DVec2::new(eigenvalue - yy, xy) } else { DVec2::new(xy, eigenvalue - xx) };
    let along = along.try_normalize().unwrap_or(DVec2::X);
    for k in 0..count {
        g[k] = DVec2::new(along.x * f[k].x + along.y * f[k].y, along.x * f[k].y - along.y * f[k].x);
    }
    let range = Range::of(g);
    let error = error * (along.x.abs() + along.y.abs());
    if range.is_one_sided(DVec2::splat(error)) {
        return Step::Empty;
    }
    if greater(range.high.y, -range.low.y) <= INDISTINCT * error {
        return Step::Tangent(along);
    }
    Step::Split
}

/// Goes on with a box that can hold one root at most: Krawczyk's operator about the middle, then Newton's method.
///
/// `g` is the adjugate of the mean Jacobian times `f`, `r` the reciprocal of its determinant, `rows` bounds the rows of
/// |I − Y J| and `noise` the error of r g.
#[inline(always)]
fn contract(p: usize, q: usize, f: &[DVec2], g: &[DVec2], r: f64, rows: DVec2, noise: DVec2) -> Step {
    let m = q + 1;
    let (bu, bv) = (&MIDDLE[p], &MIDDLE[q]);
    let mut middle = DVec2::ZERO;
    for i in 0..p + 1 {
        let mut line = DVec2::ZERO;
        for j in 0..m {
            line += g[i * m + j] * bv[j];
        }
        middle += line * bu[i];
    }
    let center = 0.5 - middle * r;
    // The sum for the middle has p + q roundings more.
    let radius = 0.5 * rows + noise * (2 + p + q) as f64;
    let (low, high) = (center - radius, center + radius);
    if high.x < 0.0 || high.y < 0.0 || low.x > 1.0 || low.y > 1.0 {
        return Step::Empty;
    }
    let (zero, one) = (DVec2::ZERO, DVec2::ONE);
    let beside = |x: &DVec2| x.cmpge(zero - BESIDE).all() && x.cmple(one + BESIDE).all();
    if let Some(x) = newton(p, q, f, center.clamp(zero, one)).filter(beside) {
        return Step::Root(x);
    }
    let (low, high) = (low.clamp(zero, one - NARROWEST), high.clamp(zero + NARROWEST, one));
    let kept = high - low;
    if kept.x * kept.y < 0.5 { Step::Shrink(low, high) } else { Step::Split }
}

/// Newton's method on the polynomials from `start` in the unit square; `None` where it does not converge near it.
#[inline(always)]
fn newton(p: usize, q: usize, f: &[DVec2], start: DVec2) -> Option<DVec2> {
    let mut x = start;
    for _ in 0..NEWTON_MAX_STEPS {
        let [s, s_u, s_v] = evaluate(p, q, f, x);
        let step = DVec2::new(s.perp_dot(s_v), s_u.perp_dot(s)) / s_u.perp_dot(s_v);
        x -= step;
        // Also false for what is not a number.
        if !(x.x.abs() <= 2.0 && x.y.abs() <= 2.0) {
            return None;
        }
        if step.x.abs() <= CLOSE && step.y.abs() <= CLOSE {
            return Some(x);
        }
    }
    None
}

/// Value and first derivatives at x, by de Casteljau's algorithm in v and then in u.
#[inline(always)]
fn evaluate(p: usize, q: usize, f: &[DVec2], x: DVec2) -> [DVec2; 3] {
    let m = q + 1;
    let (mut value, mut by_v) = ([DVec2::ZERO; MAX_ORDER], [DVec2::ZERO; MAX_ORDER]);
    for i in 0..p + 1 {
        let mut line = [DVec2::ZERO; MAX_ORDER];
        line[..m].copy_from_slice(&f[i * m..i * m + m]);
        (value[i], by_v[i]) = de_casteljau(q, &mut line, x.y);
    }
    let (s, s_u) = de_casteljau(p, &mut value, x.x);
    let (s_v, _) = de_casteljau(p, &mut by_v, x.x);
    [s, s_u, s_v]
}

/// Value and derivative of a curve at t; overwrites the coefficients.
#[inline(always)]
fn de_casteljau(p: usize, line: &mut [DVec2; MAX_ORDER], t: f64) -> (DVec2, DVec2) {
    let s = 1.0 - t;
    for r in 1..p {
        for i in 0..p - r + 1 {
            line[i] = line[i] * s + line[i + 1] * t;
        }
    }
    (line[0] * s + line[1] * t, (line[1] - line[0]) * p as f64)
}

impl<const C: usize> Net<C> {
    /// Greatest parameters of the box.
    fn high(&self) -> DVec2 {
        self.low + self.size
    }

    /// Becomes its lower half, across the direction in which the image is longer; the upper goes to `upper`.
    #[inline(always)]
    fn halve(&mut self, p: usize, q: usize, upper: &mut Self) {
        let m = q + 1;
        let length = |x: DVec2, y: DVec2| (x.x - y.x).abs() + (x.y - y.y).abs();
        let (mut by_u, mut by_v) = (0.0, 0.0);
        for k in 0..p * m {
            by_u = greater(by_u, length(self.f[k + m], self.f[k]));
        }
        for i in 0..p + 1 {
            for j in 0..q {
                by_v = greater(by_v, length(self.f[i * m + j + 1], self.f[i * m + j]));
            }
        }
        let across_u = by_u * p as f64 >= by_v * q as f64;
        let degree = if across_u { p } else { q };
        self.error += degree as f64 * UNIT * Range::of(&self.f[..(p + 1) * m]).size();
        self.depth += 1;
        let half = if across_u { DVec2::new(0.5, 1.0) } else { DVec2::new(1.0, 0.5) };
        self.size *= half;
        (upper.error, upper.depth, upper.size) = (self.error, self.depth, self.size);
        upper.low += self.size * (1.0 - half) * 2.0;
        if across_u {
            for j in 0..m {
                halve_line(p, j, m, &mut self.f, &mut upper.f);
            }
        } else {
            for i in 0..p + 1 {
                halve_line(q, i * m, 1, &mut self.f, &mut upper.f);
            }
        }
    }

    /// Becomes its part over `low` to `high`, in sizes of this box.
    #[inline(always)]
    fn restrict(&mut self, p: usize, q: usize, low: DVec2, high: DVec2) {
        let m = q + 1;
        self.error += 6.0 * (p + q) as f64 * UNIT * Range::of(&self.f[..(p + 1) * m]).size();
        self.depth += 1;
        self.low += self.size * low;
        self.size *= high - low;
        for j in 0..m {
            cut_line(p, j, m, &mut self.f, low.x, high.x);
        }
        for i in 0..p + 1 {
            cut_line(q, i * m, 1, &mut self.f, low.y, high.y);
        }
    }
}

/// De Casteljau's algorithm at ½ on the line of `p` + 1 coefficients from `start` in steps of `step`.
#[inline(always)]
fn halve_line(p: usize, start: usize, step: usize, lower: &mut [DVec2], upper: &mut [DVec2]) {
    let mut d = [DVec2::ZERO; MAX_ORDER];
    for i in 0..p + 1 {
        d[i] = lower[start + i * step];
    }
    for r in 0..p + 1 {
        lower[start + r * step] = d[0];
        upper[start + (p - r) * step] = d[p - r];
        for i in 0..p - r {
            d[i] = 0.5 * (d[i] + d[i + 1]);
        }
    }
}

/// The line's part over `low` to `high`: first what lies below `high`, then of that what lies above `low`.
#[inline(always)]
fn cut_line(p: usize, start: usize, step: usize, f: &mut [DVec2], low: f64, high: f64) {
    let mut d = [DVec2::ZERO; MAX_ORDER];
    for i in 0..p + 1 {
        d[i] = f[start + i * step];
    }
    for r in 1..p + 1 {
        for i in (r..p + 1).rev() {
            d[i] = d[i - 1] * (1.0 - high) + d[i] * high;
        }
    }
    let low = low / high;
    for r in 1..p + 1 {
        for i in 0..p - r + 1 {
            d[i] = d[i] * (1.0 - low) + d[i + 1] * low;
        }
    }
    for i in 0..p + 1 {
        f[start + i * step] = d[i];
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

#[cfg(test)]
mod tests {
    use super::*;

    /// A p × q net from f at the Greville points: exact where f is bilinear.
    fn bilinear(p: usize, q: usize, f: impl Fn(f64, f64) -> DVec2) -> Vec<DVec2> {
        (0..=p)
            .flat_map(|i| (0..=q).map(move |j| (i as f64 / p as f64, j as f64 / q as f64)))
            .map(|(u, v)| f(u, v))
            .collect()
    }

    fn found(degree: [usize; 2], error: f64, f: &[DVec2]) -> (Vec<Found>, u64) {
        let mut search = Search::default();
        search.search(degree, error, |k| f[k]);
        (search.found.clone(), search.boxes)
    }

    /// Some numbers in [-1, 1] that look random.
    fn noise(count: usize) -> Vec<DVec2> {
        (0..count).map(|k| DVec2::new((12.9898 * k as f64).sin(), (78.233 * k as f64 + 1.0).sin())).collect()
    }

    #[test]
    fn a_root_of_two_lines_is_found_in_one_box_at_every_degree() {
        for degree in [[1, 1], [2, 2], [3, 3], [2, 3], [5, 4], [7, 7], [8, 2], [15, 15]] {
            let f = bilinear(degree[0], degree[1], |u, v| DVec2::new(u + 0.1 * v - 0.3, 0.2 * u - v + 0.5));
            let (found, boxes) = found(degree, 1e-15, &f);
            let [Found::Root(x)] = found[..] else { panic!("{degree:?}: {found:?}") };
            assert!((x - DVec2::new(0.25, 0.56) / 1.02).length() < 1e-12, "{x:?}");
            assert_eq!(boxes, 1);
        }
    }

    #[test]
    fn a_sign_counts_only_beyond_the_error() {
        let f = |gap: f64| bilinear(3, 3, |u, v| DVec2::new(u + 0.5 * v - 0.7, (u + 0.5 * v - 0.7) * 2.0 + gap));
        let error = 1e-10;
        assert_eq!(found([3, 3], error, &f(1e-8)), (vec![], 1));
        let (near, _) = found([3, 3], error, &f(1e-11));
        assert!(matches!(near[..], [Found::Tangent { .. }]), "{near:?}");
    }

    #[test]
    fn two_roots_that_nearly_meet_are_told_apart() {
        // f1 = v − ½, f2 = (u − ½)² − gap: roots at ½ ± √gap.
        let squares = [0.25, -0.25, 0.25];
        let net = |gap: f64| -> Vec<DVec2> {
            (0..9).map(|k| DVec2::new(0.5 * f64::from(k % 3) - 0.5, squares[k as usize / 3] - gap)).collect()
        };
        for exponent in 2..14 {
            let gap = 10f64.powi(-exponent);
            let (two, boxes) = found([2, 2], 1e-16, &net(gap));
            let mut u: Vec<f64> =
                two.iter().map(|f| if let Found::Root(x) = f { x.x } else { panic!("{f:?}") }).collect();
            u.sort_by(f64::total_cmp);
            u.dedup_by(|a, b| (*a - *b).abs() < 1e-3 * gap.sqrt());
            assert_eq!(u.len(), 2, "1e-{exponent}: {two:?}");
            // Coefficients near ¼ are rounded by up to 2⁻⁵⁵, which moves a root by that over its slope.
            assert!((u[1] - u[0] - 2.0 * gap.sqrt()).abs() < 1e-6 * gap.sqrt() + 1e-16 / gap.sqrt());
            assert!(boxes < 45 * exponent as u64, "1e-{exponent}: {boxes}");
            let (none, boxes) = found([2, 2], 1e-16, &net(-gap));
            assert!(none.is_empty() && boxes < 45 * exponent as u64, "1e-{exponent}: {none:?} {boxes}");
        }
    }

    #[test]
    fn a_curve_of_roots_ends_at_the_cap_and_says_so() {
        // (u − v) times two different positive factors: every point of the diagonal is a root, no direction is flat.
        let blossom = |i: usize| [(0.0, 0.0), (0.0, 0.5), (1.0, 1.0)][i];
        let f: Vec<DVec2> = (0..9)
            .map(|k| {
                let ((uu, u), (vv, v)) = (blossom(k / 3), blossom(k % 3));
                DVec2::new(u - v + uu - u * v, u - v - (u * v - vv) * 0.5)
            })
            .collect();
        let (found, boxes) = found([2, 2], 1e-16, &f);
        assert!(boxes <= u64::from(MAX_BOXES) + 2 * u64::from(MAX_DEPTH), "{boxes}");
        assert!(found.iter().any(|f| matches!(f, Found::Unresolved { deepest: false, .. } | Found::Tangent { .. })));
        assert!(found.len() <= MAX_FOUND + MAX_DEPTH as usize, "{}", found.len());
    }

    #[test]
    fn parts_of_a_net_are_the_net_over_their_box() {
        for (p, q) in [(1, 2), (3, 3), (4, 6)] {
            let mut whole = Net { low: DVec2::ZERO, size: DVec2::ONE, error: 0.0, depth: 0, f: [DVec2::ZERO; 64] };
            whole.f[..(p + 1) * (q + 1)].copy_from_slice(&noise((p + 1) * (q + 1)));
            let mut part = whole;
            part.restrict(p, q, DVec2::new(0.2, 0.1), DVec2::new(0.9, 0.75));
            let mut upper = part;
            part.halve(p, q, &mut upper);
            let mut last = upper;
            upper.halve(p, q, &mut last);
            for net in [part, upper, last] {
                for (s, t) in [(0.0, 0.0), (0.3, 0.8), (1.0, 1.0)] {
                    let [inside, ..] = evaluate(p, q, &net.f, DVec2::new(s, t));
                    let [outside, ..] = evaluate(p, q, &whole.f, net.low + net.size * DVec2::new(s, t));
                    assert!(
                        (inside - outside).length() <= net.error * 4.0,
                        "{} {}",
                        (inside - outside).length(),
                        net.error
                    );
                }
            }
        }
    }

    #[test]
    fn weights_of_the_middle_sum_to_one() {
        for (p, row) in MIDDLE.iter().enumerate() {
            assert_eq!(row.iter().sum::<f64>(), 1.0);
            assert!(row[p + 1..].iter().all(|b| *b == 0.0));
        }
    }
}
