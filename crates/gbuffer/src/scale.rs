//! Which colour a number has: a range, and whether nought stands between two hues; and the legend that says so.

use crate::legend::number;
use crate::shade::diverging_colour;
use crate::{Picture, unorm8};
use colorous::VIRIDIS;

/// The shares of the values below the ends of a range that is found: single wild ones do not stretch it.
const PERCENTILES: [f64; 2] = [0.05, 0.95];

/// Values that differ by less than this share of their size are one, as a sphere's; a range then reaches a tenth of it further.
const ALIKE: f64 = 1e-5;

/// The colours of numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scale {
    /// The numbers of the lowest colour and of the highest, the first below the second; what is beyond has the nearer one.
    pub range: [f64; 2],
    /// Whether a sign has a meaning, so that nought is white between two hues.
    pub is_signed: bool,
}

impl Scale {
    /// From the 5th percentile of the finite values to their 95th, and as far below nought as above it where the sign has a
    /// meaning. Of one value, or none, a range about it.
    pub fn of(values: impl Iterator<Item = f64>, is_signed: bool) -> Self {
        let mut values: Vec<f64> = values.filter(|x| x.is_finite()).collect();
        values.sort_by(f64::total_cmp);
        let at =
            |share: f64| values.get(((values.len() as f64 - 1.0) * share).round() as usize).copied().unwrap_or(0.0);
        Self::about(PERCENTILES.map(at), is_signed)
    }

    /// From the first of two numbers to the second, widened where that is no range: where both are one, or where the sign has a
    /// meaning and nought is not in the middle.
    pub fn about([low, high]: [f64; 2], is_signed: bool) -> Self {
        let size = low.abs().max(high.abs());
        let range = match (size, is_signed) {
            (0.0, true) => [-1.0, 1.0],
            (0.0, false) => [0.0, 1.0],
            (size, true) => [-size, size],
            (size, false) if high - low <= ALIKE * size => [low - 0.1 * size, high + 0.1 * size],
            (_, false) => [low, high],
        };
        Self { range, is_signed }
    }

    /// The colour of a value; beyond the ends of the range that of the nearer one.
    pub(crate) fn colour(self, value: f64) -> [u8; 3] {
        let [low, high] = self.range;
        if self.is_signed && low < 0.0 && high > 0.0 {
            let x = if value < 0.0 { -(value / low) } else { value / high };
            return unorm8(diverging_colour(x.clamp(-1.0, 1.0) as f32));
        }
        VIRIDIS.eval_continuous(((value - low) / (high - low)).clamp(0.0, 1.0)).into_array()
    }

    /// The legend, as high as a picture: numbers, with the unit above them.
    pub fn legend(self, unit: &str, height: usize) -> Picture {
        let [low, high] = self.range;
        let at = |t: f64| low + (high - low) * t;
        let ticks = [0.0, 0.25, 0.5, 0.75, 1.0].map(|t| (t, number(at(t))));
        Picture::numbered_legend(height, unit, &ticks, |t| self.colour(at(t)))
    }
}
