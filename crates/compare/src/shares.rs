//! How much of their intervals the values of a candidate use.

use crate::Unbounded;
use serde::Serialize;

/// Bins of a histogram over 0 … 1.
pub const BINS: usize = 20;

/// What one pixel's values use of their intervals: the largest |value − middle| / half-width of the coordinates.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Shares {
    /// Of S; `None` where it has no bound.
    pub position: Option<f64>,
    /// Of the unit normal; `None` where it has no bound, or there is none.
    pub normal: Option<f64>,
    /// Of k1 and k2; `None` where they have no bound, or were not returned.
    pub curvature: Option<f64>,
    /// The value that was returned and has no bound.
    pub unbounded: Option<Unbounded>,
    /// Whether f32 leaves a decision open there: on which span the parameters lie, or whether there is a normal.
    pub ambiguous: bool,
}

/// How many values use a share from k / 20 to (k + 1) / 20.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
#[serde(transparent)]
pub struct Histogram(pub [usize; BINS]);

impl Histogram {
    /// How many values there are.
    pub fn count(&self) -> usize {
        self.0.iter().sum()
    }

    fn add(&mut self, share: f64) {
        self.0[((share * BINS as f64) as usize).min(BINS - 1)] += 1;
    }

    fn merge(&mut self, other: &Self) {
        self.0.iter_mut().zip(other.0).for_each(|(a, b)| *a += b);
    }
}

/// A histogram for each quantity.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct Histograms {
    /// Of S.
    pub position: Histogram,
    /// Of the unit normal.
    pub normal: Histogram,
    /// Of k1 and k2.
    pub curvature: Histogram,
}

impl Histograms {
    /// Counts a pixel.
    pub fn add(&mut self, shares: &Shares) {
        let Self { position, normal, curvature } = self;
        for (histogram, share) in [(position, shares.position), (normal, shares.normal), (curvature, shares.curvature)]
        {
            if let Some(share) = share {
                histogram.add(share);
            }
        }
    }

    /// Adds another part of the picture.
    pub fn merge(&mut self, other: &Self) {
        self.position.merge(&other.position);
        self.normal.merge(&other.normal);
        self.curvature.merge(&other.curvature);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_share_falls_into_its_bin_and_all_of_the_half_width_into_the_last() {
        let mut histogram = Histogram::default();
        [0.0, 0.049, 0.05, 0.999, 1.0].into_iter().for_each(|share| histogram.add(share));
        let mut merged = histogram;
        merged.merge(&histogram);
        assert_eq!((merged.0[0], merged.0[1], merged.0[19]), (4, 2, 4));
    }
}
