//! Surfaces in other parametrizations: what tests of seams share.
#![allow(dead_code, reason = "each test uses its own share")]

use glam::DVec3;
use nurbs::{Direction, KnotVector, Surface};

/// A surface with u and v exchanged.
pub fn transposed(surface: &Surface) -> Surface {
    let [rows, columns] = surface.control_counts();
    let order: Vec<usize> = (0..columns).flat_map(|j| (0..rows).map(move |i| i * columns + j)).collect();
    let [u, v] = [Direction::U, Direction::V].map(|direction| surface.knots(direction).clone());
    rebuilt(surface, [v, u], &order)
}

/// A surface with one parameter run backwards.
pub fn flipped(surface: &Surface, direction: Direction) -> Surface {
    let [rows, columns] = surface.control_counts();
    let index = |i: usize, j: usize| match direction {
        Direction::U => (rows - 1 - i) * columns + j,
        Direction::V => i * columns + columns - 1 - j,
    };
    let order: Vec<usize> =
        (0..rows).flat_map(|i| (0..columns).map(move |j| (i, j))).map(|(i, j)| index(i, j)).collect();
    let mut knots = [Direction::U, Direction::V].map(|direction| surface.knots(direction).clone());
    let turned = &mut knots[direction as usize];
    let (start, end) = turned.domain();
    let backwards = turned.knots().iter().rev().map(|k| start + end - k).collect();
    *turned = KnotVector::new(turned.degree(), backwards).expect("the same knots");
    rebuilt(surface, knots, &order)
}

fn rebuilt(surface: &Surface, [u, v]: [KnotVector; 2], order: &[usize]) -> Surface {
    let points: Vec<DVec3> = order.iter().map(|&k| surface.points()[k]).collect();
    let weights = surface.weights().map(|weights| order.iter().map(|&k| weights[k]).collect());
    Surface::new(u, v, points, weights).expect("the same surface")
}

/// A generator of numbers: SplitMix64.
pub struct Random(pub u64);

impl Random {
    /// From 0 to 1.
    pub fn share(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    /// From `low` to `high`.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.share()
    }

    /// A whole number from `low` to `high`, both among them.
    pub fn whole(&mut self, low: usize, high: usize) -> usize {
        low + (self.share() * (high - low + 1) as f64) as usize
    }

    /// Whether a coin of this share says yes.
    pub fn is(&mut self, share: f64) -> bool {
        self.share() < share
    }
}
