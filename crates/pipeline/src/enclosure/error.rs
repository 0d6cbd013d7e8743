//! Accuracy of f32 operations in WGSL, and errors that are carried for several results at once.
//!
//! All bounds of roundings are relative to the exact result, not to its binade: a factor that a compiler pulls out of
//! a sum, or a product that it takes in another order, then changes no bound.

use std::ops::{Add, AddAssign, Mul};

/// `+ − ×`: either neighbour of the exact result, so less than one ulp, relative to it.
pub(super) const NEIGHBOUR: f64 = 1.0 / (1u64 << 23) as f64;

/// Division: 2.5 ulp.
pub(super) const DIVISION: f64 = 2.5 * NEIGHBOUR;

/// sqrt as 1 / inverseSqrt: 2 ulp of the inverse, then a division; the second order stands in the last digit.
pub(super) const ROOT: f64 = 4.50001 * NEIGHBOUR;

/// What flushing a subnormal input or output changes.
pub(super) const FLUSH: f64 = f32::MIN_POSITIVE as f64;

/// The divisors for which WGSL states the accuracy of division.
pub(super) const DIVISORS: [f64; 2] = [f32::MIN_POSITIVE as f64, 1.0 / f32::MIN_POSITIVE as f64];

/// Half an ulp, relative: what narrowing to f32 moves a number by.
pub(super) const NARROWING: f64 = NEIGHBOUR / 2.0;

/// How many results are bounded together.
pub(super) const OUTPUTS: usize = 8;

/// An error by its origin: the program's roundings, or the narrowing of its inputs.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Error {
    pub rounding: f64,
    pub packing: f64,
}

impl Error {
    pub const ZERO: Self = Self { rounding: 0.0, packing: 0.0 };

    pub fn rounding(rounding: f64) -> Self {
        Self { rounding, packing: 0.0 }
    }

    /// An error of second order, that either origin may have alone.
    pub fn both(error: f64) -> Self {
        Self { rounding: error, packing: error }
    }

    pub fn total(self) -> f64 {
        self.rounding + self.packing
    }
}

impl Add for Error {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self { rounding: self.rounding + other.rounding, packing: self.packing + other.packing }
    }
}

impl AddAssign for Error {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl Mul<f64> for Error {
    type Output = Self;
    #[inline(always)]
    fn mul(self, factor: f64) -> Self {
        Self { rounding: self.rounding * factor, packing: self.packing * factor }
    }
}

/// One number a result: the derivatives of all results by one intermediate value.
#[derive(Debug, Clone, Copy)]
pub(super) struct Adjoint(pub [f64; OUTPUTS]);

impl Adjoint {
    pub const ZERO: Self = Self([0.0; OUTPUTS]);

    /// self += other × factor.
    #[inline(always)]
    pub fn add(&mut self, other: &Self, factor: f64) {
        for k in 0..OUTPUTS {
            self.0[k] += other.0[k] * factor;
        }
    }

    /// a x − b y of two.
    #[inline(always)]
    pub fn combined(a: &Self, x: f64, b: &Self, y: f64) -> Self {
        let mut sum = Self::ZERO;
        sum.add(a, x);
        sum.add(b, y);
        sum
    }
}

/// Σ |derivative| × local error, a sum for each result.
#[derive(Debug, Clone, Copy)]
pub(super) struct Budget {
    rounding: Adjoint,
    packing: Adjoint,
}

impl Budget {
    pub const ZERO: Self = Self { rounding: Adjoint::ZERO, packing: Adjoint::ZERO };

    /// Charges a local error of a value to all results that depend on it.
    #[inline(always)]
    pub fn charge(&mut self, adjoint: &Adjoint, error: Error) {
        for k in 0..OUTPUTS {
            let size = adjoint.0[k].abs();
            self.rounding.0[k] += size * error.rounding;
            self.packing.0[k] += size * error.packing;
        }
    }

    pub fn of(&self, output: usize) -> Error {
        Error { rounding: self.rounding.0[output], packing: self.packing.0[output] }
    }
}
