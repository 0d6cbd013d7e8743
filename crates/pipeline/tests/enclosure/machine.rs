//! The fragment program on an adapter that uses every freedom WGSL gives it, drawn at random.

use nurbs::MAX_ORDER;
use pipeline::eval::{Span, is_regular};
use pipeline::{PackedScene, Parameters, RATIONAL, REVERSED};

/// SplitMix64 (Steele, Lea & Flood 2014, doi 10.1145/2714064.2660195).
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Uniform in 0 … n − 1.
    pub fn below(&mut self, n: usize) -> usize {
        (self.next() % n as u64) as usize
    }

    /// Uniform in 0 … 1.
    pub fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1u64 << 53) as f64
    }

    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    pub fn coin(&mut self) -> bool {
        self.next() & 1 == 1
    }
}

/// Which neighbour a machine takes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Direction {
    /// Either, by chance.
    Random,
    /// Away from zero: relative errors of products add up.
    Outward,
    /// Towards zero.
    Inward,
    Up,
    Down,
    /// To nearest, never fused, in the order of the text: what the rasterizer does.
    Strict,
}

pub const DIRECTIONS: [Direction; 6] =
    [Direction::Random, Direction::Outward, Direction::Inward, Direction::Up, Direction::Down, Direction::Strict];

/// An adapter.
pub struct Machine {
    pub random: Random,
    pub direction: Direction,
}

/// What it returned, in local units.
#[derive(Debug, Clone, Copy)]
pub struct Returned {
    pub position: [f32; 3],
    pub regular: bool,
    pub normal: [f32; 3],
    pub curvature: [f32; 2],
}

/// A signed product of some factors.
type Term<'a> = (f32, &'a [f32]);

impl Machine {
    fn is_strict(&self) -> bool {
        self.direction == Direction::Strict
    }

    /// One of two neighbours of s + rest, where |rest| is far below an ulp of s in f32.
    pub fn neighbour(&mut self, s: f64, rest: f64) -> f32 {
        let nearest = s as f32;
        let off = (s - f64::from(nearest)) + rest;
        if off == 0.0 {
            return self.flushed(nearest);
        }
        let (low, high) = if off > 0.0 { (nearest, nearest.next_up()) } else { (nearest.next_down(), nearest) };
        let up = match self.direction {
            Direction::Random => self.random.coin(),
            Direction::Outward => s > 0.0,
            Direction::Inward => s < 0.0,
            Direction::Up => true,
            Direction::Down => false,
            Direction::Strict => return nearest,
        };
        self.flushed(if up { high } else { low })
    }

    fn flushed(&mut self, x: f32) -> f32 {
        if x.is_subnormal() && !self.is_strict() && self.random.coin() { 0.0 } else { x }
    }

    pub fn add(&mut self, a: f32, b: f32) -> f32 {
        let (a, b) = (f64::from(self.flushed(a)), f64::from(self.flushed(b)));
        let (sum, rest) = two_sum(a, b);
        self.neighbour(sum, rest)
    }

    pub fn multiply(&mut self, a: f32, b: f32) -> f32 {
        let product = f64::from(self.flushed(a)) * f64::from(self.flushed(b));
        self.neighbour(product, 0.0)
    }

    pub fn fused(&mut self, a: f32, b: f32, c: f32) -> f32 {
        let product = f64::from(self.flushed(a)) * f64::from(self.flushed(b));
        let (sum, rest) = two_sum(product, f64::from(self.flushed(c)));
        self.neighbour(sum, rest)
    }

    /// An f32 within some ulp of x.
    fn within(&mut self, x: f64, ulps: f64) -> f32 {
        let reach = 0.999_999_9 * ulps * ulp(x);
        let (mut low, mut high) = ((x - reach) as f32, (x + reach) as f32);
        if f64::from(low) < x - reach {
            low = low.next_up();
        }
        if f64::from(high) > x + reach {
            high = high.next_down();
        }
        match self.direction {
            Direction::Random => self.random.between(f64::from(low), f64::from(high)) as f32,
            Direction::Outward => {
                if x > 0.0 {
                    high
                } else {
                    low
                }
            }
            Direction::Inward => {
                if x > 0.0 {
                    low
                } else {
                    high
                }
            }
            Direction::Up => high,
            Direction::Down => low,
            Direction::Strict => x as f32,
        }
    }

    pub fn divide(&mut self, a: f32, b: f32) -> f32 {
        let x = f64::from(self.flushed(a)) / f64::from(b);
        self.within(x, 2.5)
    }

    pub fn root(&mut self, x: f32) -> f32 {
        if x == 0.0 {
            return 0.0;
        }
        if self.is_strict() || self.random.below(4) == 0 {
            return x.sqrt();
        }
        let inverse = self.within(1.0 / f64::from(x).sqrt(), 2.0);
        self.divide(1.0, inverse)
    }

    /// A product in any order.
    fn product(&mut self, factors: &[f32]) -> f32 {
        let mut order = [0usize, 1, 2, 3];
        if !self.is_strict() {
            for k in (1..factors.len()).rev() {
                order.swap(k, self.random.below(k + 1));
            }
        }
        let [first, rest @ ..] = &order[..factors.len()] else { return 1.0 };
        rest.iter().fold(factors[*first], |product, &k| self.multiply(product, factors[k]))
    }

    /// A sum of products in any order, each product fused or not.
    pub fn sum(&mut self, terms: &[Term]) -> f32 {
        let mut order = [0usize; MAX_ORDER];
        for (k, at) in order.iter_mut().enumerate().take(terms.len()) {
            *at = k;
        }
        let strict = self.is_strict();
        if !strict {
            for k in (1..terms.len()).rev() {
                order.swap(k, self.random.below(k + 1));
            }
            if terms.len() > 3 && self.random.below(4) == 0 {
                // Two partial sums.
                let half = terms.len() / 2;
                let pick = |range: std::ops::Range<usize>| range.map(|k| terms[order[k]]).collect::<Vec<_>>();
                let (a, b) = (pick(0..half), pick(half..terms.len()));
                let (a, b) = (self.sum(&a), self.sum(&b));
                return self.add(a, b);
            }
        }
        let mut sum = None;
        for &at in &order[..terms.len()] {
            let (sign, factors) = terms[at];
            sum = Some(match sum {
                None => sign * self.product(factors),
                Some(sum) if factors.len() > 1 && !strict && self.random.coin() => {
                    let (last, rest) = factors.split_last().expect("two factors");
                    let rest = self.product(rest);
                    self.fused(sign * rest, *last, sum)
                }
                Some(sum) => {
                    let product = self.product(factors);
                    self.add(sum, sign * product)
                }
            });
        }
        sum.expect("a term")
    }

    fn dot(&mut self, a: [f32; 3], b: [f32; 3]) -> f32 {
        self.sum(&[(1.0, &[a[0], b[0]]), (1.0, &[a[1], b[1]]), (1.0, &[a[2], b[2]])])
    }

    fn cross(&mut self, a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
        [(1, 2), (2, 0), (0, 1)].map(|(i, j)| self.sum(&[(1.0, &[a[i], b[j]]), (-1.0, &[a[j], b[i]])]))
    }

    /// N, N', N''. With `late`, N' lacks its factor p times the gain: it was pulled out of the sums.
    fn basis(&mut self, span: &Span, degree: usize, t: f32, late: bool) -> [[f32; MAX_ORDER]; 3] {
        let (knots, gain) = (span.knots, span.gain);
        let mut value = [0.0f32; MAX_ORDER];
        let mut below = value;
        let mut lower = value;
        let mut reciprocal = value;
        value[0] = 1.0;
        for j in 1..=degree {
            below = value;
            let (mut right, mut left) = ([0.0f32; MAX_ORDER], [0.0f32; MAX_ORDER]);
            for r in 0..j {
                let (a, b) = (knots[degree + r], knots[degree + r - j]);
                let width = self.add(a, -b);
                reciprocal[r] = self.divide(1.0, width);
                right[r] = self.add(a, -t);
                left[r] = self.add(t, -b);
            }
            for r in 0..=j {
                let ahead = |r: usize| [below[r], reciprocal[r], right[r]];
                let behind = |r: usize| [below[r], reciprocal[r], left[r]];
                value[r] = match r {
                    0 => self.product(&ahead(0)),
                    _ if r == j => self.product(&behind(r - 1)),
                    _ => self.sum(&[(1.0, &behind(r - 1)), (1.0, &ahead(r))]),
                };
            }
            if j + 1 == degree {
                lower = self.differences(&below, &reciprocal, j, gain, false);
            }
        }
        let first = self.differences(&below, &reciprocal, degree, gain, late);
        let second =
            if degree > 1 { self.differences(&lower, &reciprocal, degree, gain, false) } else { [0.0; MAX_ORDER] };
        [value, first, second]
    }

    fn differences(&mut self, below: &[f32], reciprocal: &[f32], p: usize, gain: f32, late: bool) -> [f32; MAX_ORDER] {
        let mut d = [0.0f32; MAX_ORDER];
        for r in 0..=p {
            let term = |r: usize| [below[r], reciprocal[r]];
            let difference = match r {
                0 => -self.product(&term(0)),
                _ if r == p => self.product(&term(r - 1)),
                // A factor that both share may be pulled out.
                _ if !self.is_strict() && reciprocal[r] == reciprocal[r - 1] && self.random.coin() => {
                    let inner = self.add(below[r - 1], -below[r]);
                    self.multiply(inner, reciprocal[r])
                }
                _ => self.sum(&[(1.0, &term(r - 1)), (-1.0, &term(r))]),
            };
            d[r] = if late { difference } else { self.multiply(difference, p as f32 * gain) };
        }
        d
    }

    /// The program.
    pub fn fragment(&mut self, scene: &PackedScene, face: usize, at: Parameters) -> Returned {
        let f = &scene.faces()[face];
        let [p, q] = [f.degree_u as usize, f.degree_v as usize];
        let ([u, v], [span_u, span_v]) = (at.uv, scene.spans(f, at.span));
        let late = !self.is_strict() && self.random.coin();
        let nu = self.basis(&span_u, p, u, late);
        let nv = self.basis(&span_v, q, v, late);
        let rational = f.flags & RATIONAL != 0;
        let mut a = [[0.0f32; 4]; 6];
        for c in 0..if rational { 4 } else { 3 } {
            let mut rows = [[0.0f32; MAX_ORDER]; 3];
            for i in 0..=p {
                let first = f.points as usize + (span_u.first + i) * f.count_v as usize + span_v.first;
                for b in 0..3 {
                    let pairs: [[f32; 2]; MAX_ORDER] =
                        std::array::from_fn(
                            |j| if j <= q { [nv[b][j], scene.points()[first + j][c]] } else { [0.0; 2] },
                        );
                    rows[b][i] = self.sum_pairs(&pairs[..=q]);
                    if b == 1 && late {
                        rows[b][i] = self.multiply(rows[b][i], q as f32 * span_v.gain);
                    }
                }
            }
            for (order, [x, y]) in [[0, 0], [1, 0], [0, 1], [2, 0], [1, 1], [0, 2]].into_iter().enumerate() {
                let pairs: [[f32; 2]; MAX_ORDER] = std::array::from_fn(|i| [nu[x][i], rows[y][i]]);
                a[order][c] = self.sum_pairs(&pairs[..=p]);
                if x == 1 && late {
                    a[order][c] = self.multiply(a[order][c], p as f32 * span_u.gain);
                }
            }
        }
        let xyz = |x: [f32; 4]| [x[0], x[1], x[2]];
        let [mut s, mut su, mut sv, mut suu, mut suv, mut svv] = a.map(xyz);
        if rational {
            let [w, wu, wv, wuu, wuv, wvv] = a.map(|x| x[3]);
            let w = self.divide(1.0, w);
            for c in 0..3 {
                let numerator = s[c];
                s[c] = self.multiply(numerator, w);
                // S W_u is numerator × w × W_u in any order.
                let weighted = |x: f32| [numerator, w, x];
                let d = self.sum(&[(1.0, &[su[c]]), (-1.0, &weighted(wu))]);
                su[c] = self.multiply(d, w);
                let d = self.sum(&[(1.0, &[sv[c]]), (-1.0, &weighted(wv))]);
                sv[c] = self.multiply(d, w);
                let d = self.sum(&[(1.0, &[suu[c]]), (-2.0, &[su[c], wu]), (-1.0, &weighted(wuu))]);
                suu[c] = self.multiply(d, w);
                let d =
                    self.sum(&[(1.0, &[suv[c]]), (-1.0, &[sv[c], wu]), (-1.0, &[su[c], wv]), (-1.0, &weighted(wuv))]);
                suv[c] = self.multiply(d, w);
                let d = self.sum(&[(1.0, &[svv[c]]), (-2.0, &[sv[c], wv]), (-1.0, &weighted(wvv))]);
                svv[c] = self.multiply(d, w);
            }
        }
        let n = self.cross(su, sv);
        let (n_squared, su_squared, sv_squared) = (self.dot(n, n), self.dot(su, su), self.dot(sv, sv));
        if !is_regular(n_squared, su_squared, sv_squared) {
            return Returned { position: s, regular: false, normal: [0.0; 3], curvature: [0.0; 2] };
        }
        let length = self.root(n_squared);
        let n = n.map(|x| self.divide(x, length));
        let curvature = self.curvature([su, sv, suu, suv, svv], n, su_squared);
        let (mut normal, mut k) = (n, curvature);
        if f.flags & REVERSED != 0 {
            (normal, k) = (n.map(|x| -x), [-k[1], -k[0]]);
        }
        Returned { position: s, regular: true, normal, curvature: k }
    }

    fn curvature(&mut self, [su, sv, suu, suv, svv]: [[f32; 3]; 5], n: [f32; 3], su_squared: f32) -> [f32; 2] {
        let length = self.root(su_squared);
        let e1 = su.map(|x| self.divide(x, length));
        let e2 = self.cross(n, e1);
        let g = self.dot(sv, e2);
        let across = self.dot(sv, e1);
        let shear = self.divide(across, length);
        let (l, m, nn) = (self.dot(suu, n), self.dot(suv, n), self.dot(svv, n));
        let a = self.divide(l, su_squared);
        let above = self.sum(&[(1.0, &[m]), (-1.0, &[shear, l])]);
        let below = self.multiply(length, g);
        let b = self.divide(above, below);
        let above = self.sum(&[(1.0, &[nn]), (-2.0, &[shear, m]), (1.0, &[shear, shear, l])]);
        let below = self.multiply(g, g);
        let c = self.divide(above, below);
        let mean = self.add(a, c) * 0.5;
        let x = self.add(a, -c) * 0.5;
        let squares = self.sum(&[(1.0, &[x, x]), (1.0, &[b, b])]);
        let half = self.root(squares);
        [self.add(mean, half), self.add(mean, -half)]
    }

    fn sum_pairs(&mut self, pairs: &[[f32; 2]]) -> f32 {
        let terms: [Term; MAX_ORDER] =
            std::array::from_fn(|k| if k < pairs.len() { (1.0, &pairs[k][..]) } else { (1.0, &[][..]) });
        self.sum(&terms[..pairs.len()])
    }
}

/// a + b and what f64 loses of it (Knuth, TAOCP 4.2.2).
fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let part = sum - a;
    (sum, (a - (sum - part)) + (b - part))
}

/// The least distance of two f32 around x, as WGSL defines it.
pub fn ulp(x: f64) -> f64 {
    let x = x.abs().max(f64::from(f32::MIN_POSITIVE));
    let nearest = x as f32;
    let gap = |a: f32, b: f32| f64::from(b) - f64::from(a);
    if f64::from(nearest) == x {
        gap(nearest.next_down(), nearest).min(gap(nearest, nearest.next_up()))
    } else if f64::from(nearest) < x {
        gap(nearest, nearest.next_up())
    } else {
        gap(nearest.next_down(), nearest)
    }
}
