//! f32 as an adapter may have it: each operation answers with any of the values that WGSL leaves to it, chosen by a seed.
//!
//! The accuracy is that of the specification (WGSL, Sec. 15.7.4): `+ − ×` give either neighbour of what is not exact, a
//! division is off by up to 2.5 ulp, inverseSqrt by 2 ulp and sqrt is 1 / inverseSqrt, a product may be fused into a sum, and
//! subnormal numbers may be taken and returned as zero.

use crate::random::Random;
use clap::ValueEnum;

/// Which of the values an adapter takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Direction {
    /// Any, by chance.
    Random,
    /// Away from zero: relative errors of products add up.
    Outward,
    /// Toward zero.
    Inward,
    /// The greater.
    Up,
    /// The lesser.
    Down,
    /// The nearest, never fused, in the order of the text, subnormal numbers kept: what the CPU rasterizer does.
    Strict,
}

impl Direction {
    /// Of a seed: two of six go by chance.
    pub fn of_seed(seed: u64) -> Self {
        [Self::Random, Self::Outward, Self::Inward, Self::Random, Self::Up, Self::Down][(seed % 6) as usize]
    }
}

/// What WGSL does not permit, to see that it is noticed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Fault {
    /// Division is off by up to 4 ulp
    Division,
    /// A product is off by up to 2 ulp
    Product,
    /// A sum is off by up to 2 ulp
    Sum,
    /// A square root is off by up to 8 ulp
    Root,
}

/// An adapter's arithmetic.
#[derive(Debug, Clone)]
pub struct Arithmetic {
    /// Where its choices come from.
    pub random: Random,
    direction: Direction,
    fault: Option<Fault>,
}

impl Arithmetic {
    /// With choices by a seed.
    pub fn new(seed: u64, direction: Direction, fault: Option<Fault>) -> Self {
        Self { random: Random::new(seed), direction, fault }
    }

    /// Whether nothing is left to it.
    pub fn is_strict(&self) -> bool {
        self.direction == Direction::Strict
    }

    /// Whether it makes use of a freedom, this time.
    pub fn is_free(&mut self) -> bool {
        !self.is_strict() && self.random.coin()
    }

    /// Whether it has a fault.
    fn has(&self, fault: Fault) -> bool {
        self.fault == Some(fault)
    }

    /// A number as an operation takes or returns it.
    pub fn flushed(&mut self, x: f32) -> f32 {
        if x.is_subnormal() && self.is_free() { 0.0 } else { x }
    }

    /// One of two neighbours of s + rest, where |rest| is far below an ulp of s in f32.
    fn neighbour(&mut self, s: f64, rest: f64) -> f32 {
        let nearest = s as f32;
        let off = (s - f64::from(nearest)) + rest;
        if off == 0.0 || !nearest.is_finite() {
            return self.flushed(nearest);
        }
        if self.is_strict() {
            return nearest;
        }
        let (low, high) = if off > 0.0 { (nearest, nearest.next_up()) } else { (nearest.next_down(), nearest) };
        let chosen = self.chosen(s, low, high);
        self.flushed(chosen)
    }

    /// The end of a range, or anything between by chance, that lies in the direction.
    fn chosen(&mut self, x: f64, low: f32, high: f32) -> f32 {
        match self.direction {
            Direction::Random => {
                let steps = (ordered(high) - ordered(low)) as usize;
                unordered(ordered(low) + self.random.below(steps + 1) as i64)
            }
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

    /// A number within some ulp of x.
    fn within(&mut self, x: f64, ulps: f64) -> f32 {
        let nearest = x as f32;
        if self.is_strict() || !nearest.is_finite() || x == 0.0 {
            return nearest;
        }
        // A hair short of it, as x itself has been rounded.
        let reach = 0.999_999_9 * ulps * ulp(x);
        let (mut low, mut high) = ((x - reach) as f32, (x + reach) as f32);
        if f64::from(low) < x - reach {
            low = low.next_up();
        }
        if f64::from(high) > x + reach {
            high = high.next_down();
        }
        let chosen = self.chosen(x, low, high);
        self.flushed(chosen)
    }

    /// a + b.
    pub fn add(&mut self, a: f32, b: f32) -> f32 {
        let (a, b) = (f64::from(self.flushed(a)), f64::from(self.flushed(b)));
        let (sum, rest) = two_sum(a, b);
        if self.has(Fault::Sum) { self.within(sum, 2.0) } else { self.neighbour(sum, rest) }
    }

    /// a b.
    pub fn multiply(&mut self, a: f32, b: f32) -> f32 {
        let product = f64::from(self.flushed(a)) * f64::from(self.flushed(b));
        if self.has(Fault::Product) { self.within(product, 2.0) } else { self.neighbour(product, 0.0) }
    }

    /// a b + c, rounded once.
    pub fn fused(&mut self, a: f32, b: f32, c: f32) -> f32 {
        let product = f64::from(self.flushed(a)) * f64::from(self.flushed(b));
        let (sum, rest) = two_sum(product, f64::from(self.flushed(c)));
        self.neighbour(sum, rest)
    }

    /// a / b: the accuracy is stated for divisors from 2⁻¹²⁶ to 2¹²⁶ alone, so that a smaller one is not flushed.
    pub fn divide(&mut self, a: f32, b: f32) -> f32 {
        let quotient = f64::from(self.flushed(a)) / f64::from(b);
        self.within(quotient, if self.has(Fault::Division) { 4.0 } else { 2.5 })
    }

    /// √x: to nearest, or 1 / inverseSqrt.
    pub fn root(&mut self, x: f32) -> f32 {
        if x == 0.0 || !x.is_finite() || x < 0.0 || self.is_strict() {
            return x.sqrt();
        }
        if self.has(Fault::Root) {
            return self.within(f64::from(x).sqrt(), 8.0);
        }
        if self.random.below(4) == 0 {
            return x.sqrt();
        }
        let inverse = self.within(1.0 / f64::from(x).sqrt(), 2.0);
        self.divide(1.0, inverse)
    }
}

/// a + b and what f64 loses of it (Knuth, TAOCP 4.2.2, Theorem B).
fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let part = sum - a;
    (sum, (a - (sum - part)) + (b - part))
}

/// The spacing of f32 about x: that of the binade of |x|.
fn ulp(x: f64) -> f64 {
    let exponent = ((x.abs().to_bits() >> 52) as i32 - 1023).max(-126);
    f64::from_bits(((exponent - 23 + 1023) as u64) << 52)
}

/// The number of an f32 among all in their order; both zeros are 0.
fn ordered(x: f32) -> i64 {
    let size = i64::from(x.to_bits() & 0x7fff_ffff);
    if x.is_sign_negative() { -size } else { size }
}

fn unordered(n: i64) -> f32 {
    let size = f32::from_bits(n.unsigned_abs() as u32);
    if n < 0 { -size } else { size }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DIRECTIONS: [Direction; 6] =
        [Direction::Random, Direction::Outward, Direction::Inward, Direction::Up, Direction::Down, Direction::Strict];

    /// A number of any size that an operation takes often.
    fn number(random: &mut Random) -> f32 {
        let size = 2f64.powf(40.0 * random.unit() - 20.0);
        (if random.coin() { size } else { -size }) as f32
    }

    /// Every answer is one that the specification permits, and every direction but the strict one finds both ends.
    #[test]
    fn each_operation_answers_with_what_it_may_and_with_the_worst_of_it() {
        let mut random = Random::new(1);
        for direction in DIRECTIONS {
            let mut machine = Arithmetic::new(2, direction, None);
            let mut most = [0.0f64; 4];
            for _ in 0..20_000 {
                let [a, b] = [(); 2].map(|()| number(&mut random));
                let [x, y] = [a, b].map(f64::from);
                let neighbour = |found: f32, exact: f64| {
                    assert!((f64::from(found) - exact).abs() < ulp(exact), "{found} for {exact}");
                    (f64::from(found) - exact).abs() / ulp(exact)
                };
                // Sums of numbers of like size are exact in f64.
                most[0] =
                    most[0].max(neighbour(machine.add(a, a * 0.75 + b * 1e-5), x + f64::from(a * 0.75 + b * 1e-5)));
                most[1] = most[1].max(neighbour(machine.multiply(a, b), x * y));
                let off = (f64::from(machine.divide(a, b)) - x / y).abs() / ulp(x / y);
                assert!(off <= 2.5, "{a} / {b} is off by {off} ulp");
                most[2] = most[2].max(off);
                let root = (x * x).sqrt().sqrt();
                let off = (f64::from(machine.root(a.abs())) - root).abs() / ulp(root);
                // 2 ulp of an inverse below a power of two are 4 of the root above; so are 2.5 of the division.
                assert!(off <= 9.0, "√{a} is off by {off} ulp");
                most[3] = most[3].max(off);
            }
            if direction == Direction::Strict {
                assert!(most.iter().all(|&x| x <= 0.5), "{most:?}");
            } else {
                assert!(most[0] > 0.9 && most[1] > 0.99 && most[2] > 2.4 && most[3] > 2.3, "{direction:?}: {most:?}");
            }
        }
    }

    #[test]
    fn subnormal_numbers_are_kept_or_flushed() {
        let mut machine = Arithmetic::new(3, Direction::Random, None);
        let found: Vec<f32> = (0..100).map(|_| machine.multiply(1e-30, 1e-10)).collect();
        assert!(found.contains(&0.0) && found.iter().any(|&x| x > 0.0));
    }
}
