//! x^(4/5), the velocity law of forced convection, at a fifth of the cost of a general power.
//!
//! `x = m 2^s 2^(5 q)` with `1 <= m < 2` and `0 <= s < 5`, so `x^(4/5) = 2^(4 q) (m 2^s)^(4/5)`. The factor `m 2^s` lies between
//! 1 and 32 and is referred to the nearest of tabulated numbers `t^5`, where t has so few digits that `t^4` and `t^5` are exact:
//!
//! ```text
//! (m 2^s)^(4/5) = t^4 (1 + r)^(4/5),     r = (m 2^s - t^5)/t^5,  |r| < 0.03
//! ```
//!
//! and the binomial series of the last factor is truncated below rounding.
//!
//! Theory: docs/theory.md, section 4.11.

/// Pieces per octave, by the leading bits of the fraction.
const PIECES: usize = 32;
/// Their number, bits of the fraction of a double, and the bias of its exponent.
const PIECE_BITS: u32 = PIECES.trailing_zeros();
const FRACTION_BITS: u32 = f64::MANTISSA_DIGITS - 1;
const BIAS: u64 = 1023;

/// t^4, t^5 and 1/t^5 for every piece of five octaves.
static NODES: [[f64; 3]; 5 * PIECES] = {
    let mut nodes = [[0.0; 3]; 5 * PIECES];
    let mut index = 0;
    while index < nodes.len() {
        let octave = (1_u32 << (index / PIECES)) as f64;
        let middle = octave * (1.0 + ((index % PIECES) as f64 + 0.5) / PIECES as f64);
        // Newton's method from above.
        let mut root: f64 = 2.0;
        let mut pass = 0;
        while pass < 40 {
            root -= (root - middle / (root * root * root * root)) / 5.0;
            pass += 1;
        }
        // Ten digits, so that t^5 has fifty.
        let t = ((root * 512.0 + 0.5) as u32) as f64 / 512.0;
        let fourth = t * t * t * t;
        nodes[index] = [fourth, fourth * t, 1.0 / (fourth * t)];
        index += 1;
    }
    nodes
};

/// Binomial coefficients of (1 + r)^(4/5), from that of r.
const SERIES: [f64; 9] = {
    let mut series = [0.8; 9];
    let mut k = 1;
    while k < series.len() {
        series[k] = series[k - 1] * (0.8 - k as f64) / (k + 1) as f64;
        k += 1;
    }
    series
};

/// x^(4/5) for x >= 0, to less than one unit in the last place; NaN for x < 0.
#[inline]
pub(crate) fn four_fifths(x: f64) -> f64 {
    let bits = x.to_bits();
    let exponent = bits >> FRACTION_BITS;
    // Zero, subnormal, infinite, negative or NaN.
    if exponent.wrapping_sub(1) >= 2 * BIAS {
        return if x == 0.0 { 0.0 } else { x.powf(0.8) };
    }
    // 1025 is the multiple of 5 that keeps the quotient positive.
    let shifted = exponent + 1025 - BIAS;
    let (quotient, octave) = (shifted / 5, shifted % 5);
    let fraction = bits & ((1 << FRACTION_BITS) - 1);
    let piece = (fraction >> (FRACTION_BITS - PIECE_BITS)) as usize;
    let [fourth, fifth, reciprocal] = NODES[octave as usize * PIECES + piece];
    let r = (f64::from_bits(fraction | (octave + BIAS) << FRACTION_BITS) - fifth) * reciprocal;
    let [c1, c2, c3, c4, c5, c6, c7, c8, c9] = SERIES;
    // Evaluated in pairs: the chain of dependent operations is half as long as Horner's.
    let square = r * r;
    let tail = (c6 + r * c7) + square * (c8 + r * c9);
    let series = (c1 + r * c2) + square * ((c3 + r * c4) + square * (c5 + r * tail));
    let scale = f64::from_bits((4 * quotient + BIAS - 4 * 205) << FRACTION_BITS);
    (fourth + fourth * (r * series)) * scale
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn less_than_one_unit_in_the_last_place() {
        // Exact to 2^-53 of the result: y^5 against x^4, each split into two numbers without rounding.
        let product = |a: f64, b: f64| {
            let high = a * b;
            (high, a.mul_add(b, -high))
        };
        let times = |(high, low): (f64, f64), b: f64| {
            let (first, second) = product(high, b);
            (first, low.mul_add(b, second))
        };
        let mut worst: f64 = 0.0;
        let mut word = 0x9e37_79b9_7f4a_7c15_u64;
        for _ in 0..400_000 {
            word ^= word << 13;
            word ^= word >> 7;
            word ^= word << 17;
            // Every octave between 2^-100 and 2^100, where no power is rounded away.
            let x = f64::from_bits((word >> 12) | (BIAS - 100 + (word & 0xfff) % 200) << FRACTION_BITS);
            let y = four_fifths(x);
            let fourth = times(times(product(x, x), x), x);
            let fifth = times(times(times(product(y, y), y), y), y);
            let relative = ((fifth.0 - fourth.0) + (fifth.1 - fourth.1)) / (5.0 * fourth.0);
            let unit = f64::from_bits(y.to_bits() + 1) - y;
            worst = worst.max((relative * y / unit).abs());
        }
        assert!(worst < 0.6, "{worst}");
    }

    #[test]
    fn agrees_with_the_general_power_everywhere() {
        for exponent in -1074..1024 {
            for part in [1.0, 1.0 + f64::EPSILON, 1.3, 1.984_375, 2.0 - f64::EPSILON] {
                let x = part * 2f64.powi(exponent.max(-1022)) * 2f64.powi(exponent - exponent.max(-1022));
                let (own, general) = (four_fifths(x), x.powf(0.8));
                // 0.8 itself is rounded: 2^-54 of the logarithm.
                assert!((own / general - 1.0).abs() < 1e-13, "{x:e}: {own:e} {general:e}");
            }
        }
        assert_eq!(four_fifths(0.0), 0.0);
        assert_eq!(four_fifths(-0.0), 0.0);
        assert_eq!(four_fifths(1.0), 1.0);
        assert_eq!(four_fifths(32.0), 16.0);
        assert_eq!(four_fifths(f64::INFINITY), f64::INFINITY);
        assert!(four_fifths(-1.0).is_nan() && four_fifths(f64::NAN).is_nan());
    }
}
