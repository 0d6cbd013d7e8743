//! How far a point of one border is from all of another, bounded from below.

use crate::border::Border;
use crate::taylor::{Taylor, UNIT, dot};

/// Pieces of the other border that are looked at before the bound is taken as it is.
const MOST: usize = 4_000;

/// A bound this near below the distance to a point is close enough.
const CLOSE: f64 = 1e-3;

/// Halvings of a piece.
const HALVINGS: u32 = 30;

/// The distance from the point of `from` at `s` to every point of `to` is at least this, model units. Nought says nothing.
///
/// Branch and bound over the pieces of `to`, the nearest first left whole where they are far.
pub fn distance_at_least(from: &Border, s: f64, to: &Border) -> f64 {
    let index = from.index(s);
    let Some(here) = from.along(index, Taylor::constant(s - index as f64)) else { return 0.0 };
    let squared = |index: usize, x: [f64; 2]| {
        let side = to.along(index, Taylor::between(x[0], x[1]))?;
        let offset = here.origin - side.origin;
        let apart = [0, 1, 2].map(|axis| {
            let shift = here.surface.s[axis] - side.surface.s[axis];
            shift.plus(offset[axis]).widened(UNIT * offset[axis].abs())
        });
        Some(dot(&apart, &apart))
    };
    // The negative's greatest value is the least distance.
    let bounded = |index: usize, x: [f64; 2]| {
        squared(index, x).map_or((0.0, f64::INFINITY), |f| {
            let peak = (-f).peak();
            ((-peak.upper).max(0.0), -peak.lower)
        })
    };
    let mut open: Vec<(usize, [f64; 2], u32)> = (0..to.count()).map(|i| (i, [0.0, 1.0], 0)).collect();
    let (mut nearest, mut least, mut looked) = (f64::INFINITY, f64::INFINITY, 0);
    // A first pass over the pieces, so that most need no halving.
    for (index, x, _) in &open {
        nearest = nearest.min(bounded(*index, *x).1);
    }
    while let Some((index, [from, to], halvings)) = open.pop() {
        looked += 1;
        let (lower, upper) = bounded(index, [from, to]);
        nearest = nearest.min(upper);
        if nearest * (1.0 - CLOSE) <= lower || halvings == HALVINGS || MOST <= looked {
            least = least.min(lower);
            continue;
        }
        let middle = 0.5 * (from + to);
        open.push((index, [middle, to], halvings + 1));
        open.push((index, [from, middle], halvings + 1));
    }
    least.max(0.0).sqrt() * (1.0 - 4.0 * UNIT)
}
