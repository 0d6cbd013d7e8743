//! Vectors of three coordinates in f32, several in step.

use lanes::Lanes;
use std::array::from_fn;

/// Three coordinates, `N` at a time.
pub type Vec3<const N: usize> = [Lanes<f32, N>; 3];

/// a − b.
#[inline(always)]
pub fn subtract<const N: usize>(a: Vec3<N>, b: Vec3<N>) -> Vec3<N> {
    from_fn(|c| a[c] - b[c])
}

/// a s.
#[inline(always)]
pub fn scale<const N: usize>(a: Vec3<N>, s: Lanes<f32, N>) -> Vec3<N> {
    from_fn(|c| a[c] * s)
}

/// a · b, summed from x to z.
#[inline(always)]
pub fn dot<const N: usize>(a: Vec3<N>, b: Vec3<N>) -> Lanes<f32, N> {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// a × b.
#[inline(always)]
pub fn cross<const N: usize>(a: Vec3<N>, b: Vec3<N>) -> Vec3<N> {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
