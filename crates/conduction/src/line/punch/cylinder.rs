//! Bessel functions of order 0 and 1, of both kinds together.
//!
//! From x = 25 on by Hankel's expansion
//!
//! ```text
//! J_n + i Y_n = sqrt(2/(pi x)) exp(i (x - n pi/2 - pi/4)) sum i^k a_k(n)/x^k
//! a_k(n) = a_(k-1)(n) (4 n^2 - (2k-1)^2)/(8 k)
//! ```
//!
//! whose terms fall below rounding there before they grow: one sine and one cosine serve all four. Below, by the
//! approximations of the C library. Source: NIST Digital Library of Mathematical Functions, 10.17.
//!
//! Theory: docs/theory.md, section 4.7.

use std::f64::consts::FRAC_1_PI;

/// Least x at which the expansion is exact to rounding.
const FAR: f64 = 25.0;

/// Largest number of terms of the expansion; x = 25 needs all of them.
const TERMS: usize = 24;

/// `((2k-1)^2, 1/(8k))` of the terms k = 1, 2, ...
static FACTORS: [(f64, f64); TERMS] = {
    let mut factors = [(0.0, 0.0); TERMS];
    let mut k = 1;
    while k <= TERMS {
        let odd = (2 * k - 1) as f64;
        factors[k - 1] = (odd * odd, 1.0 / (8.0 * k as f64));
        k += 1;
    }
    factors
};

/// Values at one argument.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cylinder {
    /// J0 and Y0 at the argument.
    pub zero: (f64, f64),
    /// J1 and Y1 at the argument.
    pub one: (f64, f64),
}

impl Cylinder {
    /// Values at x > 0.
    pub(crate) fn at(x: f64) -> Cylinder {
        if x < FAR {
            return Cylinder { zero: (libm::j0(x), libm::y0(x)), one: (libm::j1(x), libm::y1(x)) };
        }
        let inverse = 1.0 / x;
        // Sums of both orders, real and imaginary parts.
        let (mut term_zero, mut term_one) = (1.0, 1.0);
        let (mut zero, mut one) = ([1.0, 0.0], [1.0, 0.0]);
        for (k, (square, eighth)) in FACTORS.iter().copied().enumerate() {
            let step = eighth * inverse;
            term_zero *= -square * step;
            term_one *= (4.0 - square) * step;
            // i^(k+1): imaginary, then -1, -i, 1.
            let (part, sign) = ((k + 1) & 1, if (k + 1) & 2 == 0 { 1.0 } else { -1.0 });
            zero[part] += sign * term_zero;
            one[part] += sign * term_one;
            if term_zero.abs() + term_one.abs() < 0.1 * f64::EPSILON {
                break;
            }
        }
        let (sine, cosine) = x.sin_cos();
        // sqrt(1/2) of the phase of pi/4, and sqrt(2/(pi x)).
        let scale = (FRAC_1_PI * inverse).sqrt();
        let (turned, ahead) = (scale * (cosine + sine), scale * (sine - cosine));
        Cylinder {
            zero: (zero[0] * turned - zero[1] * ahead, zero[0] * ahead + zero[1] * turned),
            // Phase lag of pi/2.
            one: (one[0] * ahead + one[1] * turned, one[1] * ahead - one[0] * turned),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_kinds_agree_with_the_approximations_and_their_wronskian() {
        for x in [1e-3, 0.7, 24.9, 25.0, 25.1, 31.4, 77.7, 400.0, 3.2e3, 8.1e4] {
            let Cylinder { zero, one } = Cylinder::at(x);
            let scale = (2.0 * FRAC_1_PI / x).sqrt();
            for (value, expected) in
                [(zero.0, libm::j0(x)), (zero.1, libm::y0(x)), (one.0, libm::j1(x)), (one.1, libm::y1(x))]
            {
                assert!((value - expected).abs() < 2e-15 * expected.abs().max(scale), "{x}: {value} {expected}");
            }
            // J1 Y0 - J0 Y1 = 2/(pi x)
            let wronskian = (one.0 * zero.1 - zero.0 * one.1) / (2.0 * FRAC_1_PI / x);
            assert!((wronskian - 1.0).abs() < 1e-14, "{x}: {wronskian}");
        }
    }
}
