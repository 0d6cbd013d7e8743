//! Power series whose coefficients are intervals: what a function's derivatives are at all places of a stretch at once.
//!
//! Coefficient k of a [`Series`] holds f⁽ᵏ⁾(x) / k! for every x of 0 to 1, and, where the function has more parameters, for all
//! of these. Sums, products, quotients and roots follow from those of power series (Moore, *Methods and Applications of Interval
//! Analysis*, 1979, Sec. 3.4). Every operation rounds outward.

use std::ops::{Add, Mul, Neg, Sub};

/// Coefficients: derivatives to the seventh. An operation on the first k of them gives the first k of its result.
pub(super) const TERMS: usize = 8;

/// All numbers from `low` to `high`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Interval {
    pub low: f64,
    pub high: f64,
}

impl Interval {
    pub const ZERO: Self = Self { low: 0.0, high: 0.0 };

    pub fn of(x: f64) -> Self {
        Self { low: x, high: x }
    }

    /// The least that holds these numbers, widened by `more`.
    pub fn around(numbers: impl Iterator<Item = f64>, more: f64) -> Self {
        let empty = Self { low: f64::INFINITY, high: f64::NEG_INFINITY };
        let hull = numbers.fold(empty, |hull, x| Self { low: hull.low.min(x), high: hull.high.max(x) });
        Self { low: (hull.low - more).next_down(), high: (hull.high + more).next_up() }
    }

    /// No number of it is farther from nought.
    pub fn magnitude(self) -> f64 {
        self.low.abs().max(self.high.abs())
    }
}

impl Add for Interval {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self { low: (self.low + other.low).next_down(), high: (self.high + other.high).next_up() }
    }
}

impl Neg for Interval {
    type Output = Self;

    fn neg(self) -> Self {
        Self { low: -self.high, high: -self.low }
    }
}

impl Mul for Interval {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        let [a, b] = [self.low, self.high].map(|x| [x * other.low, x * other.high]);
        Self { low: a[0].min(a[1]).min(b[0].min(b[1])).next_down(), high: a[0].max(a[1]).max(b[0].max(b[1])).next_up() }
    }
}

/// A function by intervals of its derivatives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Series(pub [Interval; TERMS]);

impl Series {
    pub const ZERO: Self = Self([Interval::ZERO; TERMS]);

    pub fn constant(x: f64) -> Self {
        let mut series = Self::ZERO;
        series.0[0] = Interval::of(x);
        series
    }

    /// The derivative; its last coefficient says nothing.
    pub fn derivative(self) -> Self {
        let mut series = Self::ZERO;
        for k in 1..TERMS {
            series.0[k - 1] = self.0[k] * Interval::of(k as f64);
        }
        series
    }

    /// 1 / f; `None` where f may be nought.
    pub fn reciprocal(self) -> Option<Self> {
        let Interval { low, high } = self.0[0];
        if !(0.0 < low || high < 0.0) {
            return None;
        }
        let first = Interval { low: high.recip().next_down(), high: low.recip().next_up() };
        let mut series = Self::ZERO;
        series.0[0] = first;
        for k in 1..TERMS {
            let sum = (1..=k).fold(Interval::ZERO, |sum, j| sum + self.0[j] * series.0[k - j]);
            series.0[k] = -(first * sum);
        }
        Some(series)
    }

    /// √f; `None` where f may be nought.
    pub fn root(self) -> Option<Self> {
        let Interval { low, high } = self.0[0];
        if !(0.0 < low && high.is_finite()) {
            return None;
        }
        let (low, high) = (low.sqrt().next_down(), high.sqrt().next_up());
        let mut series = Self::ZERO;
        series.0[0] = Interval { low, high };
        let half = Interval { low: (0.5 / high).next_down(), high: (0.5 / low).next_up() };
        for k in 1..TERMS {
            let sum = (1..k).fold(Interval::ZERO, |sum, j| sum + series.0[j] * series.0[k - j]);
            series.0[k] = half * (self.0[k] + -sum);
        }
        Some(series)
    }
}

impl Add for Series {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self(std::array::from_fn(|k| self.0[k] + other.0[k]))
    }
}

impl Sub for Series {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self(std::array::from_fn(|k| self.0[k] + -other.0[k]))
    }
}

impl Mul for Series {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        Self(std::array::from_fn(|k| (0..=k).fold(Interval::ZERO, |sum, j| sum + self.0[j] * other.0[k - j])))
    }
}

/// A function whose values are vectors.
pub(super) type Vector = [Series; 3];

pub(super) fn scaled(a: Vector, by: Series) -> Vector {
    a.map(|x| x * by)
}

pub(super) fn sum(a: Vector, b: Vector) -> Vector {
    std::array::from_fn(|i| a[i] + b[i])
}

pub(super) fn cross([ax, ay, az]: Vector, [bx, by, bz]: Vector) -> Vector {
    [ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx]
}

/// The vector of length 1 in its direction; `None` where it may be nought.
pub(super) fn unit(a: Vector) -> Option<Vector> {
    let length = a.map(|x| x * x).into_iter().fold(Series::ZERO, |sum, square| sum + square).root()?;
    Some(scaled(a, length.reciprocal()?))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of sin x² + 2, its root, and its reciprocal, against derivatives by hand at the ends and in the middle.
    #[test]
    fn series_hold_the_derivatives_of_what_they_stand_for() {
        // (1 + x)², and what comes of it, has derivatives that are known: those of powers of 1 + x.
        let exact = |power: f64, x: f64, k: usize| {
            (0..k).fold((1.0 + x).powf(power - k as f64), |value, j| value * (power - j as f64) / (j + 1) as f64)
        };
        let mut line = Series::ZERO;
        (line.0[0], line.0[1]) = (Interval { low: 1.0, high: 2.0 }, Interval::of(1.0));
        let square = line * line;
        let cases = [
            (2.0, square),
            (4.0, square * square),
            (-2.0, square.reciprocal().unwrap()),
            (1.0, square.root().unwrap()),
            (0.5, line.root().unwrap()),
            (-0.5, line.root().unwrap().reciprocal().unwrap()),
            (3.0, square * line + Series::ZERO - Series::ZERO),
        ];
        for (power, series) in cases {
            for k in 0..TERMS {
                let Interval { low, high } = series.0[k];
                for x in [0.0, 0.3, 1.0] {
                    let value = exact(power, x, k);
                    assert!(low <= value + 1e-12 && value - 1e-12 <= high, "{power} {k} {x}: {low} {value} {high}");
                }
            }
        }
        assert_eq!((square - square.root().unwrap()).derivative().0[7], Interval::ZERO);
        assert_eq!((line - Series::constant(1.5)).reciprocal(), None);
        assert_eq!((line - Series::constant(1.0)).root(), None);
    }
}
