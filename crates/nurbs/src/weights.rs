//! Weights of control points: which are accepted, and how much they differ.

use crate::NurbsError;
use crate::scale::power_of_two;

/// The largest ratio of two weights of one surface. Beyond it f64 no longer carries the lighter points at all.
const GREATEST_WEIGHT_RATIO: f64 = 1e12;

/// A greatest weight within this factor of 1 is left as it is: 2¹⁰⁰.
const USUAL_WEIGHT: f64 = 1_267_650_600_228_229_401_496_703_205_376.0;

/// The weights of `expected` control points, checked; divided by a power of two where the greatest is very large or small.
///
/// A common factor changes no point, and a power of two no bit. So weights of 1e-300 or 1e308 mean what those of 1 mean,
/// though their products with coordinates would leave f64.
pub(crate) fn checked_weights(weights: Vec<f64>, expected: usize) -> Result<Vec<f64>, NurbsError> {
    if weights.len() != expected {
        return Err(NurbsError::WeightCount { expected, found: weights.len() });
    }
    let greatest = weights.iter().fold(0.0, |m: f64, w| m.max(*w));
    let legal = |w: f64| w > 0.0 && w.is_finite() && w * GREATEST_WEIGHT_RATIO >= greatest && w >= f64::MIN_POSITIVE;
    if let Some(index) = weights.iter().position(|&w| !legal(w)) {
        return Err(NurbsError::Weight { index, value: weights[index] });
    }
    if (1.0 / USUAL_WEIGHT..=USUAL_WEIGHT).contains(&greatest) {
        return Ok(weights);
    }
    let unit = power_of_two(greatest);
    Ok(weights.into_iter().map(|w| w / unit).collect())
}

/// The greatest of some weights over the least.
pub(crate) fn ratio(weights: impl Iterator<Item = f64>) -> f64 {
    let (least, most) = weights.fold((f64::INFINITY, 0.0f64), |(least, most), w| (least.min(w), most.max(w)));
    most / least
}
