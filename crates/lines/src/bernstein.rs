//! Polynomials in two variables over the unit square, in Bernstein form, with a bound on what rounding has cost.
//!
//! The least and the greatest coefficient bound the polynomial (Farouki & Rajan 1987, doi:10.1016/0167-8396(87)90012-4), and those of
//! its derivatives bound them. Every operation here is a sum of convex combinations, so that one number bounds the error of all
//! coefficients. `equation` makes polynomials of Bézier patches, and `trace` halves them.

use std::array::from_fn;

/// What a product's or a sum's coefficient is rounded by, for each of its terms, as a share of the greatest.
const ROUNDING: f64 = 2.0 * f64::EPSILON;

/// Roundings of a coefficient that are not those of its terms: of binomials and their quotients.
const FACTORS: f64 = 8.0;

/// A polynomial of degree `degree[0]` in x and `degree[1]` in y, 0 to 1 each.
#[derive(Debug, Clone, PartialEq)]
pub struct Bernstein {
    degree: [usize; 2],
    /// Row-major in x.
    coefficients: Vec<f64>,
    /// No coefficient is farther from the true one.
    error: f64,
}

/// A vector of polynomials.
pub type Vector = [Bernstein; 3];

impl Bernstein {
    /// The polynomial of these coefficients, row-major in x, each off by `error` at most.
    pub fn new(degree: [usize; 2], coefficients: Vec<f64>, error: f64) -> Self {
        debug_assert_eq!(coefficients.len(), (degree[0] + 1) * (degree[1] + 1));
        Self { degree, coefficients, error }
    }

    /// A constant.
    pub fn constant(value: f64) -> Self {
        Self::new([0, 0], vec![value], 0.0)
    }

    /// The greatest absolute coefficient.
    fn size(&self) -> f64 {
        self.coefficients.iter().fold(0.0, |most: f64, c| most.max(c.abs()))
    }

    fn at(&self, i: usize, j: usize) -> f64 {
        self.coefficients[i * (self.degree[1] + 1) + j]
    }

    /// The product (Piegl & Tiller, *Symbolic operators for NURBS*, 1997).
    pub fn times(&self, other: &Self) -> Self {
        let [[p, q], [r, s]] = [self.degree, other.degree];
        let degree = [p + r, q + s];
        let mut coefficients = vec![0.0; (p + r + 1) * (q + s + 1)];
        let shares = |p: usize, r: usize| -> Vec<f64> {
            let share = |i: usize, k: usize| binomial(p, i) * (binomial(r, k) / binomial(p + r, i + k));
            (0..=p).flat_map(|i| (0..=r).map(move |k| share(i, k))).collect()
        };
        let (along_x, along_y) = (shares(p, r), shares(q, s));
        for (i, j) in (0..=p).flat_map(|i| (0..=q).map(move |j| (i, j))) {
            for k in 0..=r {
                let own = self.at(i, j) * along_x[i * (r + 1) + k];
                for l in 0..=s {
                    coefficients[(i + k) * (q + s + 1) + j + l] += own * along_y[j * (s + 1) + l] * other.at(k, l);
                }
            }
        }
        let terms = ((p.min(r) + 1) * (q.min(s) + 1)) as f64 + FACTORS;
        let [a, b] = [self.size(), other.size()];
        let error = self.error * b + other.error * a + self.error * other.error + terms * ROUNDING * a * b;
        Self { degree, coefficients, error }
    }

    /// The same polynomial of a degree that is no lower in either variable.
    fn raised(&self, degree: [usize; 2]) -> Self {
        let more = [degree[0] - self.degree[0], degree[1] - self.degree[1]];
        if more == [0, 0] {
            return self.clone();
        }
        self.times(&Self::new(more, vec![1.0; (more[0] + 1) * (more[1] + 1)], 0.0))
    }

    /// This and `factor` times another.
    pub fn plus(&self, factor: f64, other: &Self) -> Self {
        let degree = from_fn(|axis| self.degree[axis].max(other.degree[axis]));
        let (a, b) = (self.raised(degree), other.raised(degree));
        let error = a.error + factor.abs() * b.error + ROUNDING * (a.size() + factor.abs() * b.size());
        let coefficients = a.coefficients.iter().zip(&b.coefficients).map(|(a, b)| a + factor * b).collect();
        Self { degree, coefficients, error }
    }

    /// The derivative by x (axis 0) or y.
    pub fn derivative(&self, axis: usize) -> Self {
        let n = self.degree[axis];
        if n == 0 {
            return Self::constant(0.0);
        }
        let mut degree = self.degree;
        degree[axis] -= 1;
        let difference = |i: usize, j: usize| {
            let next = if axis == 0 { self.at(i + 1, j) } else { self.at(i, j + 1) };
            n as f64 * (next - self.at(i, j))
        };
        let coefficients = places(degree).map(|(i, j)| difference(i, j)).collect();
        Self { degree, coefficients, error: 2.0 * n as f64 * (self.error + ROUNDING * self.size()) }
    }

    /// The two halves across x (axis 0) or y, each over the unit square again (de Casteljau).
    pub fn halves(&self, axis: usize) -> [Self; 2] {
        let n = self.degree[axis];
        let stride = self.degree[1] + 1;
        let (step, lines, next) = if axis == 0 { (stride, stride, 1) } else { (1, self.degree[0] + 1, stride) };
        let error = self.error + n as f64 * ROUNDING * self.size();
        let [mut low, mut high] = [Self { error, ..self.clone() }, Self { error, ..self.clone() }];
        let mut line = vec![0.0; n + 1];
        for first in (0..lines).map(|k| k * next) {
            for i in 0..=n {
                line[i] = self.coefficients[first + i * step];
            }
            for r in 0..=n {
                low.coefficients[first + r * step] = line[0];
                high.coefficients[first + (n - r) * step] = line[n - r];
                for i in 0..n - r {
                    line[i] = 0.5 * (line[i] + line[i + 1]);
                }
            }
        }
        [low, high]
    }

    /// Numbers between which all values are.
    pub fn range(&self) -> [f64; 2] {
        let [low, high] = bounds(&self.coefficients);
        [low - self.error, high + self.error]
    }

    /// The coefficients along the side at which x (axis 0) or y is 0 (side 0) or 1.
    pub fn side(&self, axis: usize, side: usize) -> Vec<f64> {
        let last = side * self.degree[axis];
        (0..=self.degree[1 - axis]).map(|k| if axis == 0 { self.at(last, k) } else { self.at(k, last) }).collect()
    }

    /// No coefficient is farther from the true one.
    pub fn error(&self) -> f64 {
        self.error
    }

    /// Whether it is nought along a side, as far as rounding tells.
    fn vanishes(&self, axis: usize, side: usize) -> bool {
        self.side(axis, side).iter().all(|c| c.abs() <= self.error)
    }

    /// The quotient by x (axis 0) or y, or by 1 less it (side 1), of what [`Self::vanishes`] there.
    ///
    /// What is dropped along the side is at most the error of the quotient.
    fn divided(&self, axis: usize, side: usize) -> Self {
        let n = self.degree[axis];
        let mut degree = self.degree;
        degree[axis] -= 1;
        let quotient = |i: usize, j: usize| {
            let k = if axis == 0 { i } else { j };
            // x B(n − 1, k) = (k + 1) / n B(n, k + 1), and so on the other side.
            let (own, factor) = if side == 0 { (1, k + 1) } else { (0, n - k) };
            let c = if axis == 0 { self.at(i + own, j) } else { self.at(i, j + own) };
            c * n as f64 / factor as f64
        };
        let coefficients: Vec<f64> = places(degree).map(|(i, j)| quotient(i, j)).collect();
        let error = n as f64 * (self.error + ROUNDING * self.size());
        Self { degree, coefficients, error }
    }

    /// The polynomial and four times its error: what was nought along a side, by rounding, is above it by more than that.
    ///
    /// So a line that runs along the border of two patches is on one side of it, and is found once.
    pub fn lifted(mut self) -> Self {
        let lift = 4.0 * self.error;
        self.coefficients.iter_mut().for_each(|c| *c += lift);
        self.error += ROUNDING * (self.size() + lift);
        self
    }
}

/// The least and the greatest of some numbers.
fn bounds(numbers: &[f64]) -> [f64; 2] {
    numbers.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], c| [low.min(*c), high.max(*c)])
}

/// Rows and columns of the coefficients of a degree, in order.
fn places([p, q]: [usize; 2]) -> impl Iterator<Item = (usize, usize)> {
    (0..=p).flat_map(move |i| (0..=q).map(move |j| (i, j)))
}

/// n over k.
fn binomial(n: usize, k: usize) -> f64 {
    (0..k.min(n - k)).fold(1.0, |product, i| product * (n - i) as f64 / (i + 1) as f64)
}

/// The scalar product.
pub fn dot(a: &Vector, b: &Vector) -> Bernstein {
    a[0].times(&b[0]).plus(1.0, &a[1].times(&b[1])).plus(1.0, &a[2].times(&b[2]))
}

/// The scalar product with a constant vector.
pub fn along(a: &Vector, direction: [f64; 3]) -> Bernstein {
    let [x, y, z] = direction;
    Bernstein::constant(0.0).plus(x, &a[0]).plus(y, &a[1]).plus(z, &a[2])
}

/// The cross product.
pub fn cross(a: &Vector, b: &Vector) -> Vector {
    from_fn(|k| {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        a[i].times(&b[j]).plus(-1.0, &a[j].times(&b[i]))
    })
}

/// A vector that is nought along a side, divided by the distance from it, for as long as it is so: its direction stays, and is
/// known at the side, too.
pub fn without_sides(mut vector: Vector) -> Vector {
    for (axis, side) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
        while vector.iter().all(|c| 0 < c.degree[axis] && c.vanishes(axis, side)) {
            vector = vector.map(|c| c.divided(axis, side));
        }
    }
    vector
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The value by the definition.
    fn value(f: &Bernstein, x: f64, y: f64) -> f64 {
        let basis = |n: usize, i: usize, t: f64| binomial(n, i) * t.powi(i as i32) * (1.0 - t).powi((n - i) as i32);
        let [p, q] = f.degree;
        places(f.degree).map(|(i, j)| f.at(i, j) * basis(p, i, x) * basis(q, j, y)).sum()
    }

    proptest! {
        #[test]
        fn operations_do_to_values_what_they_say(
            numbers in prop::collection::vec(-2.0f64..2.0, 24), x in 0.0f64..1.0, y in 0.0f64..1.0, factor in -3.0f64..3.0,
        ) {
            let a = Bernstein::new([3, 2], numbers[..12].to_vec(), 0.0);
            let b = Bernstein::new([1, 5], numbers[12..].to_vec(), 0.0);
            let (va, vb) = (value(&a, x, y), value(&b, x, y));
            prop_assert!((value(&a.times(&b), x, y) - va * vb).abs() < 1e-13);
            prop_assert!((value(&a.plus(factor, &b), x, y) - (va + factor * vb)).abs() < 1e-13);
            let h = 1e-5;
            let slope = (value(&a, x + h, y) - value(&a, x - h, y)) / (2.0 * h);
            prop_assert!((value(&a.derivative(0), x, y) - slope).abs() < 1e-7);
            let [low, high] = a.halves(1);
            let half = if y < 0.5 { value(&low, x, 2.0 * y) } else { value(&high, x, 2.0 * y - 1.0) };
            prop_assert!((half - va).abs() < 1e-13);
            let [least, most] = a.range();
            prop_assert!(least <= va && va <= most);
            // x (1 − y) a, without the sides at which it is nought, is a.
            let x1 = Bernstein::new([1, 0], vec![0.0, 1.0], 0.0);
            let y1 = Bernstein::new([0, 1], vec![1.0, 0.0], 0.0);
            let product = a.times(&x1).times(&y1);
            let [found, ..] = without_sides([product.clone(), product.clone(), product]);
            prop_assert_eq!(found.degree, a.degree);
            prop_assert!((value(&found, x, y) - va).abs() < 1e-12);
        }
    }
}
