//! Functions of one parameter with a proof: a polynomial, and how far the function is from it at most.
//!
//! A [`Taylor`] stands for every function f on −1 ≤ τ ≤ 1 with |f(τ) − Σ c_k τ^k| ≤ r (Makino & Berz, *Taylor models and
//! other validated functional inclusion methods*, Int. J. Pure Appl. Math. 4, 2003). Each operation gives one that holds all
//! results. What it drops goes into r: terms above [`ORDER`], and the rounding of each coefficient, by the standard model
//! of f64 (every operation is off by at most 2⁻⁵³ of its result). r itself is rounded upward. So whatever is computed with
//! these needs no allowance for rounding afterwards.

use std::ops::{Add, Mul, Neg, Sub};

/// The degree of the polynomials. Halving a stretch of an edge divides what they leave by 2⁷.
pub const ORDER: usize = 6;

/// Coefficients.
const TERMS: usize = ORDER + 1;

/// The greatest relative error of one operation of f64.
pub const UNIT: f64 = f64::EPSILON / 2.0;

/// Sums and products of at most 60 numbers that are not negative, rounded upward by this, are not too small.
const UPWARD: f64 = 1.0 + 64.0 * f64::EPSILON;

/// A power series is used up to this share of its constant term; what it leaves out is then at most 0.28 of the value.
const CONVERGES: f64 = 0.7;

/// Halvings of −1 … 1 in the search for a polynomial's greatest value.
const HALVINGS: u32 = 7;

/// What the change to Bernstein form and the halvings lose, of the coefficients' absolute sum: under 64 operations on the
/// way to any point.
const RANGE_ROUNDING: f64 = 128.0 * UNIT;

/// The search ends where the bound is this near to a value that is taken.
const CLOSE: f64 = 1e-3;

/// A polynomial on −1 ≤ τ ≤ 1 and the greatest distance of the function from it.
///
/// Where an operation has no answer, as the quotient by a function with a zero, it gives `None`. A radius that is not a
/// number, as after an overflow, is no bound: [`Taylor::peak`] says infinity then.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Taylor {
    coefficients: [f64; TERMS],
    radius: f64,
}

/// The greatest value of a function on −1 ≤ τ ≤ 1, from above and from below.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Peak {
    /// No value is greater. Infinite where nothing is known.
    pub upper: f64,
    /// The value at [`Self::at`] is at least this.
    pub lower: f64,
    /// Where the greatest value was seen.
    pub at: f64,
}

/// Which power of a function is taken.
#[derive(Clone, Copy, PartialEq)]
enum Power {
    Reciprocal,
    InverseRoot,
}

fn up(x: f64) -> f64 {
    x * UPWARD + f64::MIN_POSITIVE
}

impl Taylor {
    /// The constant nought.
    pub const ZERO: Self = Self { coefficients: [0.0; TERMS], radius: 0.0 };

    /// The constant `value`.
    pub fn constant(value: f64) -> Self {
        Self::ball(value, 0.0)
    }

    /// Every function within `radius` of `value`.
    pub fn ball(value: f64, radius: f64) -> Self {
        let mut coefficients = [0.0; TERMS];
        coefficients[0] = value;
        Self { coefficients, radius }
    }

    /// The polynomial with these coefficients, and every function within `radius` of it.
    pub fn new(coefficients: [f64; TERMS], radius: f64) -> Self {
        Self { coefficients, radius }
    }

    /// The function that runs from `start` to `end`.
    pub fn between(start: f64, end: f64) -> Self {
        let mut line = Self::constant(0.5 * (start + end));
        line.coefficients[1] = 0.5 * (end - start);
        line.radius = up(2.0 * UNIT * (start.abs() + end.abs()));
        line
    }

    /// The coefficient of τ⁰.
    pub fn middle(&self) -> f64 {
        self.coefficients[0]
    }

    /// How far the function may be from the polynomial.
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// No value is farther from nought. Quick, and not close: [`Self::peak`] is.
    pub fn magnitude(&self) -> f64 {
        up(self.size() + self.radius)
    }

    fn size(&self) -> f64 {
        self.coefficients.iter().map(|c| c.abs()).sum()
    }

    /// The same with every function within `more` of these.
    pub fn widened(mut self, more: f64) -> Self {
        self.radius = up(self.radius + more);
        self
    }

    /// The function times an exact number.
    pub fn scaled(mut self, factor: f64) -> Self {
        self.coefficients.iter_mut().for_each(|c| *c *= factor);
        self.radius = up(self.radius * factor.abs() + UNIT * self.size());
        self
    }

    /// The function plus an exact number.
    pub fn plus(mut self, offset: f64) -> Self {
        self.coefficients[0] += offset;
        self.radius = up(self.radius + UNIT * self.coefficients[0].abs());
        self
    }

    /// The polynomial's value at `at`, and how far the function may be from it there.
    pub fn value(&self, at: f64) -> (f64, f64) {
        let value = self.coefficients.iter().rev().fold(0.0, |sum, c| sum * at + c);
        (value, up(self.radius + 2.0 * TERMS as f64 * UNIT * self.size()))
    }

    /// 1 / f; `None` where f is not known to keep away from nought.
    pub fn reciprocal(&self) -> Option<Self> {
        self.power(Power::Reciprocal)
    }

    /// 1 / √f; `None` where f is not known to be positive.
    pub fn inverse_root(&self) -> Option<Self> {
        self.power(Power::InverseRoot)
    }

    /// Σ b_k x^k with x = f / c_0 − 1. The b_k are at most 1, so that the rest is at most m^(ORDER+1) / (1 − m), m = max |x|.
    fn power(&self, power: Power) -> Option<Self> {
        let constant = self.coefficients[0];
        let (factor, exponent) = match power {
            Power::Reciprocal => (1.0 / constant, -1.0),
            Power::InverseRoot => (1.0 / constant.sqrt(), -0.5),
        };
        let mut rest = *self;
        rest.coefficients[0] = 0.0;
        // The quotient by c_0 is off by its own rounding twice: that of 1 / c_0, and that of the product.
        let x = rest.scaled(1.0 / constant);
        let x = x.widened(2.0 * UNIT * x.magnitude());
        let most = x.magnitude();
        let is_known = most <= CONVERGES && factor.is_finite() && (power == Power::Reciprocal || 0.0 < constant);
        if !is_known {
            return None;
        }
        let mut binomials = [1.0; TERMS];
        for k in 1..TERMS {
            binomials[k] = binomials[k - 1] * (exponent - (k - 1) as f64) / k as f64;
        }
        let mut series = Self::constant(binomials[ORDER]);
        for k in (0..ORDER).rev() {
            series = (series * x).plus(binomials[k]).widened(4.0 * TERMS as f64 * UNIT);
        }
        let tail = up(up(most.powi(TERMS as i32)) / (1.0 - most));
        let scaled = series.widened(tail).scaled(factor);
        Some(scaled.widened(4.0 * UNIT * scaled.magnitude()))
    }

    /// The greatest value, by halving the Bernstein form of the polynomial.
    pub fn peak(&self) -> Peak {
        let rounding = up(self.radius + RANGE_ROUNDING * self.size());
        if !rounding.is_finite() {
            return Peak { upper: f64::INFINITY, lower: f64::NEG_INFINITY, at: 0.0 };
        }
        let whole: [f64; TERMS] = std::array::from_fn(|j| {
            let row = &TO_BERNSTEIN[j];
            self.coefficients.iter().zip(row).map(|(c, m)| c * m).sum()
        });
        let (mut seen, mut at) = (whole[0], -1.0);
        if seen < whole[ORDER] {
            (seen, at) = (whole[ORDER], 1.0);
        }
        let mut upper = f64::NEG_INFINITY;
        let mut stack = vec![(whole, -1.0, 2.0, HALVINGS)];
        while let Some((points, start, length, halvings)) = stack.pop() {
            let most = points.iter().fold(f64::NEG_INFINITY, |most: f64, p| most.max(*p));
            if halvings == 0 || most <= seen + CLOSE * most.abs() + self.radius {
                upper = upper.max(most);
                continue;
            }
            let (low, high) = halves(points);
            let middle = start + 0.5 * length;
            if seen < high[0] {
                (seen, at) = (high[0], middle);
            }
            stack.push((low, start, 0.5 * length, halvings - 1));
            stack.push((high, middle, 0.5 * length, halvings - 1));
        }
        let upper = upper.max(seen) + rounding;
        Peak { upper: upper + RANGE_ROUNDING * upper.abs(), lower: self.value(at).0 - rounding, at }
    }
}

impl Peak {
    /// The peak of |f|, of those of f and −f.
    pub fn of_either(self, other: Self) -> Self {
        let (better, upper) = (if self.lower < other.lower { other } else { self }, self.upper.max(other.upper));
        Self { upper, ..better }
    }
}

/// De Casteljau's algorithm at the middle.
fn halves(mut points: [f64; TERMS]) -> ([f64; TERMS], [f64; TERMS]) {
    let mut low = [0.0; TERMS];
    for r in 0..TERMS {
        low[r] = points[0];
        for i in 0..ORDER - r {
            points[i] = 0.5 * (points[i] + points[i + 1]);
        }
    }
    (low, points)
}

/// Bernstein coefficient j of τ^k on −1 … 1: the polar form at j ones and the rest minus ones, which is the coefficient of
/// x^k in (1 + x)^j (1 − x)^(ORDER − j) over the binomial of ORDER and k.
const TO_BERNSTEIN: [[f64; TERMS]; TERMS] = to_bernstein();

const fn to_bernstein() -> [[f64; TERMS]; TERMS] {
    let mut table = [[0.0; TERMS]; TERMS];
    let mut j = 0;
    while j < TERMS {
        let mut product = [0.0; TERMS];
        product[0] = 1.0;
        let mut factor = 0;
        while factor < ORDER {
            let sign = if factor < j { 1.0 } else { -1.0 };
            let mut k = ORDER;
            while 0 < k {
                product[k] += sign * product[k - 1];
                k -= 1;
            }
            factor += 1;
        }
        let (mut k, mut binomial) = (0, 1.0);
        while k < TERMS {
            table[j][k] = product[k] / binomial;
            binomial = binomial * (ORDER - k) as f64 / (k + 1) as f64;
            k += 1;
        }
        j += 1;
    }
    table
}

/// A sum of multiples of functions by exact numbers, whose rounding is counted once.
#[derive(Clone, Copy)]
pub struct Sum {
    coefficients: [f64; TERMS],
    radius: f64,
    size: f64,
    count: f64,
}

impl Sum {
    /// Of no terms.
    pub const EMPTY: Self = Self { coefficients: [0.0; TERMS], radius: 0.0, size: 0.0, count: 2.0 };

    /// Adds `factor` times `f`, whose coefficients have the absolute sum `size`.
    pub fn add(&mut self, factor: f64, f: &Taylor, size: f64) {
        for (sum, c) in self.coefficients.iter_mut().zip(&f.coefficients) {
            *sum += factor * c;
        }
        self.radius += factor.abs() * f.radius;
        self.size += factor.abs() * size;
        self.count += 1.0;
    }

    /// Adds what is at most `factor` times `size`, and too small to be worth its coefficients.
    pub fn add_small(&mut self, factor: f64, size: f64) {
        self.radius += factor.abs() * size;
    }

    /// The sum, with every function within `error` of it.
    pub fn done(self, error: f64) -> Taylor {
        // Up to 256 terms: what the sums of radii and sizes lose is far below 1e-12 of them.
        let rounding = (self.radius + (self.count + 2.0) * UNIT * self.size + error) * (1.0 + 1e-12);
        Taylor { coefficients: self.coefficients, radius: up(rounding) }
    }
}

impl Add for Taylor {
    type Output = Self;
    fn add(mut self, other: Self) -> Self {
        self.coefficients.iter_mut().zip(other.coefficients).for_each(|(c, d)| *c += d);
        self.radius = up(self.radius + other.radius + UNIT * self.size());
        self
    }
}

impl Neg for Taylor {
    type Output = Self;
    fn neg(mut self) -> Self {
        self.coefficients.iter_mut().for_each(|c| *c = -*c);
        self
    }
}

impl Sub for Taylor {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Taylor {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let mut product = [0.0; 2 * ORDER + 1];
        for (i, c) in self.coefficients.iter().enumerate() {
            for (j, d) in other.coefficients.iter().enumerate() {
                product[i + j] += c * d;
            }
        }
        let (a, b) = (self.size(), other.size());
        let dropped: f64 = product[TERMS..].iter().map(|c| c.abs()).sum();
        let rounding = (TERMS as f64 + 1.0) * UNIT * a * b;
        let radius = up(dropped + rounding + a * other.radius + b * self.radius + self.radius * other.radius);
        let mut coefficients = [0.0; TERMS];
        coefficients.copy_from_slice(&product[..TERMS]);
        Self { coefficients, radius }
    }
}

/// A vector of three functions.
pub type Vector = [Taylor; 3];

/// a · b.
pub fn dot(a: &Vector, b: &Vector) -> Taylor {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// a × b.
pub fn cross(a: &Vector, b: &Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// a, each component by `f`.
pub fn times(a: &Vector, f: Taylor) -> Vector {
    a.map(|x| x * f)
}

/// a + b.
pub fn sum(a: &Vector, b: &Vector) -> Vector {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// a − b.
pub fn difference(a: &Vector, b: &Vector) -> Vector {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Coefficients that are whole numbers of `unit`, up to 2⁵³ of them: products are exact in i128.
    fn whole(seed: &mut u64, bits: u32) -> [i64; TERMS] {
        std::array::from_fn(|_| {
            *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (*seed >> (64 - bits)) as i64 - (1 << (bits - 1))
        })
    }

    fn of(whole: &[i64; TERMS]) -> Taylor {
        Taylor::new(whole.map(|c| c as f64), 0.0)
    }

    /// The product in whole numbers, against the coefficients and the radius: all that is lost is in the radius.
    #[test]
    fn a_product_holds_the_exact_one() {
        let mut seed = 1;
        for _ in 0..2_000 {
            let (a, b) = (whole(&mut seed, 53), whole(&mut seed, 53));
            let mut exact = [0i128; 2 * ORDER + 1];
            for i in 0..TERMS {
                for j in 0..TERMS {
                    exact[i + j] += i128::from(a[i]) * i128::from(b[j]);
                }
            }
            let product = of(&a) * of(&b);
            // The coefficients are whole numbers again, so that their differences are exact.
            let kept = (0..TERMS).map(|k| (exact[k] - product.coefficients[k] as i128).unsigned_abs()).sum::<u128>();
            let dropped: u128 = exact[TERMS..].iter().map(|c| c.unsigned_abs()).sum();
            assert!((kept + dropped) as f64 <= product.radius * (1.0 + 1e-15), "seed {seed}");
            assert!(0 < kept, "something is rounded");
            // Without the radius the answer would be wrong.
            assert!(product.radius < 2.0 * (kept + dropped) as f64 + 1e-10 * product.size() * 1e2, "seed {seed}");
        }
    }

    #[test]
    fn reciprocal_and_inverse_root_hold_the_functions() {
        let mut seed = 7;
        for _ in 0..500 {
            let mut f = of(&whole(&mut seed, 20)).scaled(1e-7);
            f.coefficients[0] = 1.0 + f.coefficients[0].abs();
            let f = f.widened(1e-9);
            let (inverse, root) = (f.reciprocal().expect("away from nought"), f.inverse_root().expect("positive"));
            for i in -20..=20 {
                let at = f64::from(i) / 20.0;
                for end in [-1e-9, 0.0, 1e-9] {
                    let value = f.coefficients.iter().rev().fold(0.0, |sum, c| sum * at + c) + end;
                    for (power, exact) in [(&inverse, 1.0 / value), (&root, 1.0 / value.sqrt())] {
                        let (found, radius) = power.value(at);
                        assert!((found - exact).abs() <= radius + 4.0 * UNIT, "{found} {exact} {radius}, seed {seed}");
                    }
                }
            }
        }
        assert_eq!(Taylor::between(-1.0, 1.0).reciprocal(), None);
        assert_eq!(Taylor::constant(-1.0).inverse_root(), None);
        assert_eq!(Taylor::constant(f64::NAN).reciprocal(), None);
    }

    #[test]
    fn a_peak_is_above_all_values_and_near_one() {
        let mut seed = 3;
        for _ in 0..500 {
            let f = of(&whole(&mut seed, 30));
            let peak = f.peak();
            let most = (-2_000..=2_000).map(|i| f.value(f64::from(i) / 2_000.0).0).fold(f64::NEG_INFINITY, f64::max);
            assert!(most <= peak.upper && peak.lower <= most + 1e-5 * f.size(), "{peak:?} {most}, seed {seed}");
            assert!(peak.upper - peak.lower <= 4e-3 * f.size(), "{peak:?}, seed {seed}");
        }
        assert_eq!(Taylor::constant(f64::NAN).peak().upper, f64::INFINITY);
        assert_eq!(Taylor::ball(0.0, f64::INFINITY).peak().upper, f64::INFINITY);
    }
}
