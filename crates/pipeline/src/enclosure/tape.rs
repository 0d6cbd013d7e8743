//! A program without loops, recorded with the local error of each operation, and read backwards.
//!
//! For z = f(x, y) let x + dx and y + dy be what the program holds. Then dz = f_x dx + f_y dy + e, where e is the
//! operation's own rounding and the remainder of f beyond first order, both bounded when the operation is recorded:
//! the remainder by the radii of x and y, which naive ball arithmetic carries along. With e taken as a local error
//! the linear recurrence is exact, so that |d result| ≤ Σ |∂ result / ∂ z| e over all operations, with the
//! derivatives taken at the exact values: no variable that occurs twice is counted twice.

use super::error::{Adjoint, Budget, DIVISION, DIVISORS, Error, FLUSH, NEIGHBOUR, OUTPUTS, ROOT};

/// The longest program recorded (rational, with curvatures) has 97 operations and 239 operands.
pub(super) const NODES: usize = 112;
const EDGES: usize = 256;

/// The derivatives of the results by each node.
pub(super) type Adjoints = [Adjoint; NODES];

/// A recorded value: exact, and how far from it the program may be.
#[derive(Debug, Clone, Copy)]
pub(super) struct Number {
    pub index: usize,
    pub value: f64,
    /// Coarse; for remainders and decisions only.
    pub radius: f64,
}

impl Number {
    #[inline]
    fn largest(self) -> f64 {
        self.value.abs() + self.radius
    }
}

/// One term of a sum: ± a, or ± a b with a number of roundings.
#[derive(Debug, Clone, Copy)]
pub(super) struct Term {
    factor: f64,
    a: Number,
    b: Option<Number>,
    /// Roundings of the product; where a factor is a product itself and may be multiplied in another order, one more.
    roundings: f64,
}

/// a.
pub(super) fn plain(a: Number) -> Term {
    Term { factor: 1.0, a, b: None, roundings: 0.0 }
}

/// a b.
pub(super) fn product(a: Number, b: Number) -> Term {
    Term { factor: 1.0, a, b: Some(b), roundings: 1.0 }
}

impl Term {
    /// The term times a constant whose products with f32 numbers are exact: a sign, a power of two.
    pub fn times(self, factor: f64) -> Self {
        Self { factor: self.factor * factor, ..self }
    }

    /// A factor of the product is a product itself.
    pub fn of_three(self) -> Self {
        Self { roundings: self.roundings + 1.0, ..self }
    }
}

/// The record.
pub(super) struct Tape {
    local: [Error; NODES],
    /// Where a node's operands end in `edges`; they start where those of the node before end.
    end: [u16; NODES],
    edges: [(u16, f64); EDGES],
    nodes: usize,
    used: usize,
}

impl Tape {
    pub fn new() -> Self {
        Self { local: [Error::ZERO; NODES], end: [0; NODES], edges: [(0, 0.0); EDGES], nodes: 0, used: 0 }
    }

    fn edge(&mut self, of: Number, partial: f64) {
        self.edges[self.used] = (of.index as u16, partial);
        self.used += 1;
    }

    /// Ends a node; `None` where f32 may overflow, after which nothing is known.
    #[inline]
    fn node(&mut self, value: f64, radius: f64, local: Error) -> Option<Number> {
        let index = self.nodes;
        self.local[index] = local;
        self.end[index] = self.used as u16;
        self.nodes += 1;
        // Not `>`: a NaN is no bound.
        (value.abs() + radius <= f64::from(f32::MAX)).then_some(Number { index, value, radius })
    }

    /// A value from outside the tape, whose error is charged there.
    pub fn leaf(&mut self, value: f64, radius: f64) -> Option<Number> {
        self.node(value, radius, Error::ZERO)
    }

    /// A sum of terms in any order, products fused or not.
    #[inline]
    pub fn sum(&mut self, terms: &[Term]) -> Option<Number> {
        let (mut value, mut size, mut radius, mut own, mut remainder) = (0.0, 0.0, 0.0, 0.0, 0.0);
        for term in terms {
            let (a, factor) = (term.a, term.factor);
            let (x, r) = match term.b {
                None => {
                    self.edge(a, factor);
                    own += FLUSH;
                    (a.value, a.radius)
                }
                Some(b) => {
                    self.edge(a, factor * b.value);
                    self.edge(b, factor * a.value);
                    let beyond = a.radius * b.radius;
                    let x = a.value * b.value;
                    let r = a.value.abs() * b.radius + b.value.abs() * a.radius + beyond;
                    let rounding = term.roundings * (NEIGHBOUR * (x.abs() + r) + FLUSH)
                        + FLUSH * (1.0 + a.largest() + b.largest());
                    remainder += factor.abs() * beyond;
                    own += factor.abs() * rounding;
                    (x, r + rounding)
                }
            };
            value += factor * x;
            size += factor.abs() * (x.abs() + r);
            radius += factor.abs() * r;
        }
        // No partial sum of any order exceeds the greater of the positive and the negative part.
        let additions = (terms.len() - 1) as f64 * (NEIGHBOUR * 0.5 * (size + value.abs() + radius) + FLUSH);
        own += additions;
        self.node(value, radius + additions, Error::rounding(own) + Error::both(remainder))
    }

    /// a × factor, exact in f32.
    pub fn scaled(&mut self, a: Number, factor: f64) -> Option<Number> {
        self.sum(&[plain(a).times(factor)])
    }

    /// a · b.
    pub fn dot(&mut self, a: [Number; 3], b: [Number; 3]) -> Option<Number> {
        self.sum(&[product(a[0], b[0]), product(a[1], b[1]), product(a[2], b[2])])
    }

    /// a × b.
    pub fn cross(&mut self, a: [Number; 3], b: [Number; 3]) -> Option<[Number; 3]> {
        let mut one = |i: usize, j: usize| self.sum(&[product(a[i], b[j]), product(a[j], b[i]).times(-1.0)]);
        Some([one(1, 2)?, one(2, 0)?, one(0, 1)?])
    }

    /// a / b; `None` where b may be outside the range for which WGSL states an accuracy, zero above all.
    pub fn quotient(&mut self, a: Number, b: Number) -> Option<Number> {
        let least = b.value.abs() - b.radius;
        if !(least >= DIVISORS[0] && b.largest() <= DIVISORS[1]) {
            return None;
        }
        let value = a.value / b.value;
        self.edge(a, 1.0 / b.value);
        self.edge(b, -value / b.value);
        let linear = (a.radius + value.abs() * b.radius) / b.value.abs();
        let beyond = linear * b.radius / least;
        let radius = linear + beyond;
        let own = DIVISION * (value.abs() + radius) + FLUSH * (1.0 + (1.0 + value.abs() + radius) / least);
        self.node(value, radius + own, Error::rounding(own) + Error::both(beyond))
    }

    /// 1 / a.
    pub fn reciprocal(&mut self, a: Number) -> Option<Number> {
        let one = self.leaf(1.0, 0.0)?;
        self.quotient(one, a)
    }

    /// √a; `None` where a may be zero.
    pub fn root(&mut self, a: Number) -> Option<Number> {
        let least = a.value - a.radius;
        if least.is_nan() || least < DIVISORS[0] {
            return None;
        }
        let value = a.value.sqrt();
        self.edge(a, 0.5 / value);
        let beyond = a.radius * a.radius / (8.0 * least * least.sqrt());
        let radius = 0.5 * a.radius / value + beyond;
        let own = ROOT * (value + radius);
        self.node(value, radius + own, Error::rounding(own) + Error::both(beyond))
    }

    /// √(a² + b²), where that is clearly not zero; `None` elsewhere.
    pub fn hypotenuse(&mut self, a: Number, b: Number) -> Option<Number> {
        let value = a.value.hypot(b.value);
        let error = a.radius.hypot(b.radius);
        if !(4.0 * error <= value && value > 0.0) {
            return None;
        }
        self.edge(a, a.value / value);
        self.edge(b, b.value / value);
        // The second derivative of a distance is at most 1 / distance.
        let beyond = 0.5 * error * error / (value - error);
        let radius = error + beyond;
        let own = hypotenuse_rounding(value + radius);
        self.node(value, radius + own, Error::rounding(own) + Error::both(beyond))
    }

    /// Charges every local error to the results, and leaves the derivatives of the results by all nodes in `adjoints`.
    pub fn sweep(&self, results: &[Option<Number>; OUTPUTS], budget: &mut Budget, adjoints: &mut Adjoints) {
        adjoints[..self.nodes].fill(Adjoint::ZERO);
        for (k, result) in results.iter().enumerate() {
            if let Some(number) = result {
                adjoints[number.index].0[k] = 1.0;
            }
        }
        for index in (0..self.nodes).rev() {
            let adjoint = adjoints[index];
            budget.charge(&adjoint, self.local[index]);
            let start = if index == 0 { 0 } else { self.end[index - 1] };
            for &(of, partial) in &self.edges[usize::from(start)..usize::from(self.end[index])] {
                adjoints[usize::from(of)].add(&adjoint, partial);
            }
        }
    }
}

/// Roundings of √(a² + b²) up to `largest`: two squares and their sum under the root, and the root.
pub(super) fn hypotenuse_rounding(largest: f64) -> f64 {
    (NEIGHBOUR * 1.00001 + ROOT) * largest + 2.0 * FLUSH.sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers in −1 … 1 that look random (Weyl's sequence), but the same on each run.
    fn numbers() -> impl Iterator<Item = f64> {
        (1..).map(|k| 2.0 * ((k as f64) * 0.618_033_988_749_894_9).fract() - 1.0)
    }

    /// Bound of one result of two or three operands of given radii, from the tape alone, and the operands' share.
    fn bound(
        of: impl Fn(&mut Tape, [Number; 3]) -> Option<Number>,
        x: [f64; 3],
        radii: [f64; 3],
    ) -> Option<(f64, f64)> {
        let mut tape = Tape::new();
        let leaves = [0, 1, 2].map(|k| tape.leaf(x[k], radii[k]).expect("small"));
        let result = of(&mut tape, leaves)?;
        let mut results = [None; OUTPUTS];
        results[0] = Some(result);
        let mut budget = Budget::ZERO;
        let mut adjoints = [Adjoint::ZERO; NODES];
        tape.sweep(&results, &mut budget, &mut adjoints);
        let linear: f64 = leaves.iter().zip(radii).map(|(leaf, r)| adjoints[leaf.index].0[0].abs() * r).sum();
        Some((result.value, linear + budget.of(0).rounding))
    }

    /// Every operation with every operand anywhere in its ball, and every rounding at its worst, stays inside; a bound
    /// half as wide would not.
    #[test]
    fn operations_on_balls_hold_by_brute_force() {
        type Operation = (&'static str, fn(&mut Tape, [Number; 3]) -> Option<Number>, fn([f64; 3]) -> f64, f64);
        let operations: [Operation; 5] = [
            ("a b + c", |t, [a, b, c]| t.sum(&[product(a, b), plain(c)]), |[a, b, c]| a * b + c, NEIGHBOUR),
            ("a b", |t, [a, b, _]| t.sum(&[product(a, b)]), |[a, b, _]| a * b, NEIGHBOUR),
            ("a / b", |t, [a, b, _]| t.quotient(a, b), |[a, b, _]| a / b, DIVISION),
            ("√a", |t, [a, _, _]| t.root(a), |[a, _, _]| a.sqrt(), ROOT * 0.9999),
            ("√(a² + b²)", |t, [a, b, _]| t.hypotenuse(a, b), |[a, b, _]| a.hypot(b), ROOT),
        ];
        for (name, record, exact, accuracy) in operations {
            let mut random = numbers();
            let (mut tried, mut closest) = (0, 0.0f64);
            for scale in [0.0, 1e-7, 1e-3, 0.1] {
                for _ in 0..500 {
                    let x: [f64; 3] = std::array::from_fn(|_| random.next().expect("endless"));
                    let radii = x.map(|x| scale * x.abs());
                    let Some((middle, half_width)) = bound(record, x, radii) else { continue };
                    for corner in 0..27 {
                        let sign = |k: u32| f64::from(corner / 3u32.pow(k) % 3) - 1.0;
                        let moved: [f64; 3] = std::array::from_fn(|k| x[k] + sign(k as u32) * radii[k]);
                        // Short of the worst by what f64 loses of these sums here.
                        for rounding in [-accuracy, accuracy].map(|x| x * 0.999_999) {
                            let share = (exact(moved) * (1.0 + rounding) - middle).abs() / half_width;
                            assert!(share <= 1.0, "{name} at {x:?} ± {radii:?}: {share} of {half_width}");
                            closest = closest.max(share);
                            tried += 1;
                        }
                    }
                }
            }
            assert!(tried > 10_000 && closest > 0.5, "{name}: {tried} tried, the closest at {closest}");
        }
    }

    #[test]
    fn nothing_is_claimed_of_a_quotient_by_what_may_be_zero_nor_of_an_overflow() {
        let mut tape = Tape::new();
        let one = tape.leaf(1.0, 0.0).expect("small");
        let near_zero = tape.leaf(1e-3, 1e-3).expect("small");
        assert!(tape.quotient(one, near_zero).is_none() && tape.root(near_zero).is_none());
        let large = tape.leaf(1e30, 0.0).expect("an f32");
        assert!(tape.sum(&[product(large, large)]).is_none());
        assert!(tape.leaf(f64::NAN, 0.0).is_none());
    }
}
