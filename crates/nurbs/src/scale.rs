//! Scaling without rounding, by powers of two, so that sums of squares and products stay in f64.

/// The greatest power of two that is at most `x`, which is not negative; at least the smallest normal number.
///
/// Its reciprocal is exact, so that the product with that has the bits of the quotient.
pub fn power_of_two(x: f64) -> f64 {
    f64::from_bits(x.max(f64::MIN_POSITIVE).to_bits() & 0x7ff0_0000_0000_0000)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_power_of_two_is_found_at_or_below() {
        for (x, below) in [(1.0, 1.0), (1.9, 1.0), (0.75, 0.5), (1e6, 524288.0), (f64::MAX, 2f64.powi(1023))] {
            assert_eq!(power_of_two(x), below);
        }
        assert_eq!(power_of_two(0.0), f64::MIN_POSITIVE);
    }
}
