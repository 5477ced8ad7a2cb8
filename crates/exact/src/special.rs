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

/// `erfc(x)`, x >= 0, to 1e-13 of its value.
///
/// Below 2 from `erf x = (2/sqrt pi) exp(-x^2) sum_n 2^n x^(2n+1)/(2n+1)!!`, whose terms are all positive; above by the
/// continued fraction of DLMF 7.9.2, which converges fast there.
pub fn complementary_error(x: f64) -> f64 {
    let square = x * x;
    if x < 2.0 {
        let (mut term, mut sum, mut order) = (x, x, 1.0);
        while term > 1e-17 * sum {
            order += 2.0;
            term *= 2.0 * square / order;
            sum += term;
        }
        return 1.0 - 2.0 / PI.sqrt() * (-square).exp() * sum;
    }
    let fraction = (1..=60).rev().fold(x, |below, n| x + 0.5 * f64::from(n) / below);
    (-square).exp() / (PI.sqrt() * fraction)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn complementary_error_of_the_tables() {
        // DLMF 7.23: erfc at points on both sides of the change of method.
        for (x, value) in [
            (0.0, 1.0),
            (0.5, 0.479_500_122_186_953_5),
            (1.9, 0.007_209_570_764_742_532_5),
            (2.0, 0.004_677_734_981_047_265),
            (3.0, 2.209_049_699_858_544e-5),
            (5.0, 1.537_459_794_428_035e-12),
        ] {
            assert!((complementary_error(x) / value - 1.0).abs() < 1e-13, "{x}: {}", complementary_error(x));
        }
    }

    #[test]
    fn arcsine_distribution() {
        for t in [1e-9, 0.1, 0.5, 0.77, 0.99] {
            let exact = 2.0 / PI * f64::sqrt(t).asin();
            assert!((incomplete_beta_half(0.0, t) - exact).abs() < 1e-14, "{t}");
        }
    }

    #[test]
    fn derivative_is_the_density() {
        for e in [-0.3, 0.045, 0.2] {
            for t in [0.05, 0.3, 0.49, 0.51, 0.9] {
                let h = 1e-4;
                let slope = (incomplete_beta_half(e, t + h) - incomplete_beta_half(e, t - h)) / (2.0 * h);
                let density = t.powf(-0.5 - e) * (1.0 - t).powf(-0.5 + e) * (PI * e).cos() / PI;
                assert!((slope / density - 1.0).abs() < 2e-5, "{e} {t}: {slope} {density}");
            }
        }
    }
}
