//! Decayed values become 0 before they are subnormal.
//!
//! A value that is multiplied by a factor between 1/2 and 1 at every step ends at the smallest subnormal number and stays there, as
//! the product rounds back to it. Arithmetic with subnormal numbers takes up to a hundred times as long.

/// Magnitude below which a decayed value is 0, in any unit: its products with weights of the size 1e-100 are still normal numbers.
const NEGLIGIBLE: f64 = 1e-200;

/// The value, or 0 where it has decayed.
#[inline(always)]
#[must_use]
pub fn flushed(value: f64) -> f64 {
    if value.abs() < NEGLIGIBLE { 0.0 } else { value }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_decaying_value_ends_at_zero() {
        let mut value = 1.0;
        let steps = (0..10_000).find(|_| {
            value = flushed(0.9 * value);
            value == 0.0 || value.is_subnormal()
        });
        assert_eq!((value, steps), (0.0, Some(4370)));
        assert!(flushed(f64::NAN).is_nan());
        assert_eq!([1e-199, -1e-199, -1e-201].map(flushed), [1e-199, -1e-199, 0.0]);
    }
}
