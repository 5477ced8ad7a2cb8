//! Special functions of the exact solutions.
//!
//! Theory: docs/theory.md, section 10.

use std::f64::consts::PI;

/// `I_t(1/2 - e, 1/2 + e)`, regularised incomplete beta function for |e| < 1/2 and 0 <= t <= 1.
///
/// Its complete beta function is `pi/cos(pi e)`. Continued fraction of DLMF 8.17.22, to rounding.
pub(crate) fn incomplete_beta_half(e: f64, t: f64) -> f64 {
    if t <= 0.0 {
        return 0.0;
    }
    if t >= 1.0 {
        return 1.0;
    }
    if t > 0.5 {
        return 1.0 - incomplete_beta_half(-e, 1.0 - t);
    }
    let (alpha, beta) = (0.5 - e, 0.5 + e);
    let front = t.powf(alpha) * (1.0 - t).powf(beta) * (PI * e).cos() / (PI * alpha);
    // Modified Lentz evaluation of 1/(1 + d1/(1 + d2/(1 + ...))).
    let (mut c, mut d) = (1.0, 1.0 / (1.0 - (alpha + beta) * t / (alpha + 1.0)));
    let mut fraction = d;
    for m in 1..200 {
        let m = f64::from(m);
        let even = m * (beta - m) * t / ((alpha + 2.0 * m - 1.0) * (alpha + 2.0 * m));
        d = 1.0 / (1.0 + even * d);
        c = 1.0 + even / c;
        fraction *= d * c;
        let odd = -(alpha + m) * (alpha + beta + m) * t / ((alpha + 2.0 * m) * (alpha + 2.0 * m + 1.0));
        d = 1.0 / (1.0 + odd * d);
        c = 1.0 + odd / c;
        fraction *= d * c;
        if (d * c - 1.0).abs() < 1e-16 {
            break;
        }
    }
    front * fraction
}

/// `erfc(x)`
pub use libm::erfc as complementary_error;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arcsine_distribution() {
        for t in [1e-9, 0.1, 0.5, 0.77, 0.99] {
            let exact = 2.0 / PI * f64::sqrt(t).asin();
            assert!((incomplete_beta_half(0.0, t) - exact).abs() < 1e-14, "{t}");
        }
    }
}
