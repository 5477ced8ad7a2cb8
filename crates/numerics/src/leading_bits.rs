//! Numbers reduced to their leading bits: nearby arguments give the same operators, whatever the steps before.

/// `value` rounded towards zero to the leading bit of its significand and `more` after it; 0: the power of two below it.
#[inline(always)]
#[must_use]
pub fn leading_bits(value: f64, more: u32) -> f64 {
    f64::from_bits(value.to_bits() & !((1 << (f64::MANTISSA_DIGITS - 1 - more)) - 1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_left_is_below_by_less_than_the_last_bit() {
        assert_eq!([0.0, 0.3, 0.5, 0.999, 1.0, 7.9].map(|x| leading_bits(x, 0)), [0.0, 0.25, 0.5, 0.5, 1.0, 4.0]);
        for n in 1..1000 {
            let value = 1e-3 * f64::from(n).exp2().rem_euclid(97.3) + 1e-9 * f64::from(n);
            let rounded = leading_bits(value, 3);
            assert!(rounded <= value && value < 1.125 * rounded, "{value}");
            assert_eq!(leading_bits(-value, 3), -rounded);
        }
    }
}
