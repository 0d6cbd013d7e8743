//! Curves interpolated by quintic Bézier pieces, within a distance that is measured.
//!
//! Each part of a curve is interpolated at Lobatto's six nodes, which is nearly as good as the best of its degree, and
//! measured between them; where it is too far off, the part is halved. Parts meet with their ends, and no smoother.

use std::iter::Sum;
use std::ops::{Add, Mul, Sub};
use std::sync::LazyLock;

/// Degree of the interpolation.
pub const QUINTIC: usize = 5;

/// Lobatto's nodes on 0 to 1, ½ − ½ cos(k π / 5).
pub const NODES: [f64; 6] = [0.0, 0.095491502812526, 0.345491502812526, 0.654508497187474, 0.904508497187474, 1.0];

/// What is interpolated: [`glam::DVec2`], [`glam::DVec3`].
pub trait Vector: Copy + Add<Output = Self> + Sub<Output = Self> + Mul<f64, Output = Self> + Sum {}

impl<V: Copy + Add<Output = V> + Sub<Output = V> + Mul<f64, Output = V> + Sum> Vector for V {}

/// A quintic on 0 to 1, by its Bézier points.
#[derive(Debug, Clone, Copy)]
pub struct Quintic<V>([V; 6]);

impl<V: Vector> Quintic<V> {
    /// The one that has these values at [`NODES`].
    pub fn through(values: [V; 6]) -> Self {
        // About the first value, so that what is far from the origin keeps its digits.
        let about = values[0];
        let to_bezier = &*TO_BEZIER;
        let inner = |i: usize| about + (0..=QUINTIC).map(|j| (values[j] - about) * to_bezier[i][j]).sum::<V>();
        Self(std::array::from_fn(|i| if i % QUINTIC == 0 { values[i] } else { inner(i) }))
    }

    /// Its Bézier points.
    pub fn points(&self) -> &[V; 6] {
        &self.0
    }

    /// The value at `x`, by de Casteljau.
    pub fn at(&self, x: f64) -> V {
        let mut d = self.0;
        for r in 1..=QUINTIC {
            for i in 0..=QUINTIC - r {
                d[i] = d[i] * (1.0 - x) + d[i + 1] * x;
            }
        }
        d[0]
    }
}

/// Places on 0 to 1 between the nodes, where a quintic is measured.
pub fn between_nodes() -> impl Iterator<Item = f64> {
    NODES.windows(2).map(|pair| 0.5 * (pair[0] + pair[1]))
}

/// How far parts are halved.
#[derive(Debug, Clone, Copy)]
pub struct Halving {
    /// The distance under which a part is kept.
    pub tolerance: f64,
    /// Halvings of one part at most; what is still too far off then is taken as it is.
    pub depth: u32,
    /// Parts of the whole curve at most.
    pub parts: usize,
}

/// A curve of quintic pieces.
#[derive(Debug, Clone)]
pub struct Quintics<V> {
    /// Clamped; each inner knot five times.
    pub knots: Vec<f64>,
    /// Control points: five a piece, and the last.
    pub points: Vec<V>,
    /// The farthest that it was measured to be off.
    pub error: f64,
}

/// Interpolates `at` over the parts between `breaks`, ascending and at least two; `off` measures how far a place of the
/// interpolation, the first, is from the curve's own at the same parameter.
pub fn quintics<V: Vector>(
    breaks: &[f64],
    at: impl Fn(f64) -> V,
    off: impl Fn(V, V) -> f64,
    Halving { tolerance, depth, parts }: Halving,
) -> Quintics<V> {
    let (mut knots, mut points, mut error) = (vec![breaks[0]; QUINTIC + 1], vec![], 0.0f64);
    let mut waiting: Vec<(f64, f64, u32)> = breaks.windows(2).rev().map(|w| (w[0], w[1], depth)).collect();
    while let Some((a, b, halvings)) = waiting.pop() {
        let values = NODES.map(|x| at(if x == 1.0 { b } else { a + (b - a) * x }));
        let own = Quintic::through(values);
        let worst = between_nodes().map(|x| off(own.at(x), at(a + (b - a) * x))).fold(0.0, f64::max);
        let middle = 0.5 * (a + b);
        let room = knots.len() / QUINTIC + waiting.len() < parts;
        if tolerance < worst && 0 < halvings && room && a < middle && middle < b {
            waiting.extend([(middle, b, halvings - 1), (a, middle, halvings - 1)]);
            continue;
        }
        error = error.max(worst);
        points.pop();
        points.extend(own.points());
        knots.extend([b; QUINTIC]);
    }
    knots.extend(knots.last().copied());
    Quintics { knots, points, error }
}

/// The matrix from values at [`NODES`] to Bézier points: the inverse of Bernstein's polynomials there.
static TO_BEZIER: LazyLock<[[f64; 6]; 6]> = LazyLock::new(to_bezier);

fn to_bezier() -> [[f64; 6]; 6] {
    const BINOMIAL: [f64; 6] = [1.0, 5.0, 10.0, 10.0, 5.0, 1.0];
    let basis = |x: f64, i: usize| BINOMIAL[i] * x.powi(i as i32) * (1.0 - x).powi((QUINTIC - i) as i32);
    // Gauss and Jordan, with the unit matrix beside; Bernstein's matrix is totally positive, so that no pivot is zero.
    let mut rows: [[f64; 12]; 6] = std::array::from_fn(|j| {
        std::array::from_fn(|i| if i < 6 { basis(NODES[j], i) } else { f64::from(u8::from(i == j + 6)) })
    });
    for k in 0..6 {
        let pivot = rows[k][k];
        rows[k].iter_mut().for_each(|x| *x /= pivot);
        for j in 0..6 {
            if j != k {
                let factor = rows[j][k];
                let row = rows[k];
                rows[j].iter_mut().zip(row).for_each(|(x, y)| *x -= factor * y);
            }
        }
    }
    rows.map(|row| std::array::from_fn(|i| row[i + 6]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DVec2, DVec3};

    #[test]
    fn a_quintic_is_interpolated_by_itself() {
        let control =
            [[0.0, 1.0], [2.0, -1.0], [0.5, 0.25], [3.0, 7.0], [-1.0, 0.0], [1.0, 1.0]].map(DVec2::from_array);
        let again = Quintic::through(NODES.map(|x| Quintic(control).at(x)));
        for (found, expected) in again.points().iter().zip(control) {
            assert!(found.distance(expected) < 1e-13, "{found} {expected}");
        }
    }

    #[test]
    fn a_quintic_in_space_is_interpolated_by_itself() {
        let control: [DVec3; 6] = std::array::from_fn(|k| DVec3::new(k as f64, (k * k % 7) as f64, (k % 3) as f64));
        let again = Quintic::through(NODES.map(|x| Quintic(control).at(x)));
        for (found, expected) in again.points().iter().zip(control) {
            assert!(found.distance(expected) < 1e-12, "{found} {expected}");
        }
    }
}
