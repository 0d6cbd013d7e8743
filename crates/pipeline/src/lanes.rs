//! A few f32 values that go through the same operations together.
//!
//! Each lane does exactly what a single f32 would: IEEE `+ − × ÷ √`, never fused. So one source serves one pixel
//! and eight, and the bits do not depend on how many go together.

use std::array::from_fn;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// `N` values of f32 in step.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(align(16))]
pub struct Lanes<const N: usize>(pub [f32; N]);

impl<const N: usize> Lanes<N> {
    /// All lanes zero.
    pub const ZERO: Self = Self([0.0; N]);

    /// The same value in all lanes.
    #[inline(always)]
    pub fn splat(x: f32) -> Self {
        Self([x; N])
    }

    /// Square root of each lane.
    #[inline(always)]
    pub fn sqrt(self) -> Self {
        Self(self.0.map(f32::sqrt))
    }
}

macro_rules! by_lane {
    ($trait:ident, $method:ident, $operator:tt) => {
        impl<const N: usize> $trait for Lanes<N> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self(from_fn(|i| self.0[i] $operator other.0[i]))
            }
        }
        impl<const N: usize> $trait<f32> for Lanes<N> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: f32) -> Self {
                Self(from_fn(|i| self.0[i] $operator other))
            }
        }
    };
}

by_lane!(Add, add, +);
by_lane!(Sub, sub, -);
by_lane!(Mul, mul, *);
by_lane!(Div, div, /);

impl<const N: usize> Neg for Lanes<N> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(self.0.map(|x| -x))
    }
}

/// Three coordinates, `N` at a time.
pub type Vec3<const N: usize> = [Lanes<N>; 3];

/// a − b.
#[inline(always)]
pub fn subtract<const N: usize>(a: Vec3<N>, b: Vec3<N>) -> Vec3<N> {
    from_fn(|c| a[c] - b[c])
}

/// a s.
#[inline(always)]
pub fn scale<const N: usize>(a: Vec3<N>, s: Lanes<N>) -> Vec3<N> {
    from_fn(|c| a[c] * s)
}

/// a · b, summed from x to z.
#[inline(always)]
pub fn dot<const N: usize>(a: Vec3<N>, b: Vec3<N>) -> Lanes<N> {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// a × b.
#[inline(always)]
pub fn cross<const N: usize>(a: Vec3<N>, b: Vec3<N>) -> Vec3<N> {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
