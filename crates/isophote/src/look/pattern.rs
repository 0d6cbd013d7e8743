//! What a zebra mirrors in the place of stripes: squares or dots, which tell of both directions at once.
//!
//! Places are the components of the mirrored view along the stripes' axis and across it, as stripes are counted.

use clap::ValueEnum;
use glam::{DVec2, DVec3, Vec3};

/// Tones of the zebra.
const LIGHT: Vec3 = Vec3::new(0.965, 0.961, 0.945);
const DARK: Vec3 = Vec3::new(0.141, 0.208, 0.345);

/// The radius of a dot, in stripes.
const DOT: f64 = 0.62;

/// A pattern, by name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Pattern {
    /// Light and dark stripes
    Stripes,
    /// Light and dark squares
    Checker,
    /// Dark dots
    Dots,
}

/// A pattern in its place about a camera.
#[derive(Debug, Clone, Copy)]
pub struct Placed {
    pub pattern: Pattern,
    /// Across the stripes and along them, world, of unit length.
    pub axes: [DVec3; 2],
    /// Stripes, light and dark, over all directions.
    pub count: f64,
}

impl Placed {
    /// The colour in a direction of unit length, each part 0 to 1.
    pub fn colour(&self, toward: DVec3) -> [f32; 3] {
        let [across, along] = self.axes.map(|axis| (0.5 * toward.dot(axis) + 0.5) * self.count);
        let is_dark = match self.pattern {
            Pattern::Stripes => is_odd(across),
            Pattern::Checker => is_odd(across) != is_odd(along),
            // One for every two stripes each way, beside each other in every second row.
            Pattern::Dots => {
                let row = (0.5 * along).floor();
                let shift = if is_odd(row) { 1.0 } else { 0.0 };
                let place = DVec2::new(across + shift, along).rem_euclid(DVec2::splat(2.0));
                place.distance(DVec2::ONE) < DOT
            }
        };
        (if is_dark { DARK } else { LIGHT }).to_array()
    }
}

fn is_odd(x: f64) -> bool {
    x.floor().rem_euclid(2.0) == 1.0
}

#[cfg(test)]
mod tests {
    use super::*;

    fn dark(pattern: Pattern, x: f64, y: f64) -> bool {
        let placed = Placed { pattern, axes: [DVec3::X, DVec3::Y], count: 10.0 };
        // Components that fall on so many stripes.
        placed.colour(DVec3::new(x / 5.0 - 1.0, y / 5.0 - 1.0, 0.0)) == DARK.to_array()
    }

    #[test]
    fn squares_change_both_ways_stripes_one_way_and_dots_stand_apart() {
        for (x, y) in (0..10).flat_map(|x| (0..10).map(move |y| (x, y))) {
            let (u, v) = (f64::from(x) + 0.5, f64::from(y) + 0.5);
            assert_eq!(dark(Pattern::Stripes, u, v), x % 2 == 1);
            assert_eq!(dark(Pattern::Checker, u, v), (x + y) % 2 == 1);
        }
        let count =
            (0..10_000).filter(|k| dark(Pattern::Dots, f64::from(k % 100) / 10.0, f64::from(k / 100) / 10.0)).count();
        let share = count as f64 / 10_000.0;
        let disc = std::f64::consts::PI * DOT * DOT / 4.0;
        assert!((share - disc).abs() < 0.02, "{share} where discs cover {disc}");
        assert!(dark(Pattern::Dots, 1.0, 1.0) && !dark(Pattern::Dots, 2.0, 1.0) && dark(Pattern::Dots, 2.0, 3.0));
    }
}
