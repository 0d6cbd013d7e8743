//! A few floating-point values that go through the same operations together, on vectors as wide as the processor has.
//!
//! Each lane does exactly what a single value would: IEEE `+ − × ÷ √`, never fused, in the order of the source. So one
//! source serves one point and eight. The bits depend neither on how many go together nor on the processor: a [`Kernel`]
//! is compiled once for each [`Level`], and [`run`] takes the best one that is there.
//!
//! # Examples
//! ```
//! use lanes::Lanes;
//!
//! let four = Lanes([1.0f32, 4.0, 9.0, 16.0]);
//! assert_eq!((four + Lanes::splat(0.0)).sqrt(), Lanes([1.0, 2.0, 3.0, 4.0]));
//! ```

pub use fearless_simd::Level;

#[cfg(target_arch = "x86_64")]
use fearless_simd::Simd;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// `N` values in step.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(align(16))]
pub struct Lanes<T, const N: usize>(pub [T; N]);

impl<T: Copy, const N: usize> Lanes<T, N> {
    /// The same value in all lanes.
    #[inline(always)]
    pub fn splat(x: T) -> Self {
        Self([x; N])
    }
}

macro_rules! real {
    ($real:ty) => {
        impl<const N: usize> Lanes<$real, N> {
            /// All lanes zero.
            pub const ZERO: Self = Self([0.0; N]);

            /// Square root of each lane.
            #[inline(always)]
            pub fn sqrt(self) -> Self {
                let mut out = self;
                for i in 0..N {
                    out.0[i] = self.0[i].sqrt();
                }
                out
            }
        }
    };
}

real!(f32);
real!(f64);

macro_rules! by_lane {
    ($trait:ident, $method:ident, $operator:tt) => {
        impl<T: Copy + $trait<Output = T>, const N: usize> $trait for Lanes<T, N> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                let mut out = self;
                for i in 0..N {
                    out.0[i] = self.0[i] $operator other.0[i];
                }
                out
            }
        }
        impl<T: Copy + $trait<Output = T>, const N: usize> $trait<T> for Lanes<T, N> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: T) -> Self {
                self $operator Self::splat(other)
            }
        }
    };
}

by_lane!(Add, add, +);
by_lane!(Sub, sub, -);
by_lane!(Mul, mul, *);
by_lane!(Div, div, /);

impl<T: Copy + Neg<Output = T>, const N: usize> Neg for Lanes<T, N> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        let mut out = self;
        for i in 0..N {
            out.0[i] = -self.0[i];
        }
        out
    }
}

/// A program over lanes. What it calls is compiled for wide vectors only where it is inlined: mark it `#[inline(always)]`.
pub trait Kernel {
    /// What it returns.
    type Output;

    /// Runs it.
    fn run(self) -> Self::Output;
}

/// Runs a kernel as compiled for AVX-512, for AVX2 or for what every processor of the target has, as `level` allows.
///
/// The answers are the same to the bit. `Level::new()` is the best of this processor; tests pass others.
#[inline(always)]
pub fn run<K: Kernel>(level: Level, kernel: K) -> K::Output {
    #[cfg(target_arch = "x86_64")]
    if let Some(avx512) = level.as_avx512() {
        return avx512.vectorize(
            #[inline(always)]
            || kernel.run(),
        );
    } else if let Some(avx2) = level.as_avx2() {
        return avx2.vectorize(
            #[inline(always)]
            || kernel.run(),
        );
    }
    let _ = level;
    kernel.run()
}

/// The levels that this processor has, each of which [`run`] treats differently; the best last.
pub fn levels() -> Vec<Level> {
    #[cfg(target_arch = "x86_64")]
    let wider = {
        let best = Level::new();
        [best.as_avx2().map(|avx2| avx2.level()), best.as_avx512().map(|avx512| avx512.level())]
    };
    #[cfg(not(target_arch = "x86_64"))]
    let wider = [None; 2];
    [Some(Level::baseline())].into_iter().chain(wider).flatten().collect()
}
