//! Exact propagation of a decaying and phase-rotating state over a step.
//!
//! ```text
//! dx/dt = (-lambda + i q v(t)) x + b f(t),    v and f linear over the step
//! ```
//!
//! With u = 1 - t/h, `z = -lambda h + i q h (v0 + v1)/2` and `eta = q h (v1 - v0)/2` the state at the end is
//!
//! ```text
//! x(h) = e^z x(0) + b h integral_0^1 exp(z u + i eta u (1 - u)) f du
//! ```
//!
//! and both integrals, of 1 and of u, follow from `T_m = integral exp(z u) [u (1-u)]^m du/m!` by the series in eta:
//!
//! ```text
//! integral exp(z u + i eta u (1-u)) du = sum (i eta)^m T_m
//! integral exp(z u + i eta u (1-u)) (2u - 1) du = z sum (i eta)^m T_(m+1)
//! T_(m-1) = z^2 T_(m+1) + 2 (2m+1) T_m
//! ```
//!
//! (modified spherical Bessel functions of z/2). The recurrence runs downwards from unnormalised values (J. C. P.
//! Miller; W. Gautschi, SIAM Review 9 (1967) 24-82), normalised by T_0 or T_1 in closed form, or upwards where |z| is
//! large; either direction is stable. Where eta/4 = q dv h/8 is large the integrals are differences of complex error
//! functions ([`chirp`]). The number of operations is bounded for every rate of phase rotation.
//!
//! Theory: docs/theory.md, section 5.3.

pub(crate) mod abreast;
mod chirp;

use nalgebra::Complex;

/// Largest `q dv h/8` for which the series is used.
pub(crate) const LARGEST_DRIFT: f64 = 1.5;
/// `q dv h/8` below which the velocity counts as constant: the relative error of the mode's amplitude. Modes for which
/// it is not much smaller are short, and contribute one in a hundred of the temperature.
pub(crate) const LEAST_DRIFT: f64 = 5e-4;
/// |Re z| + |Im z| below which the integrals at a constant velocity follow from the power series.
const NEAR: f64 = 0.5;
/// Terms of the series at the largest drift: 1.5^13/13! = 3e-8.
const MOST_TERMS: usize = 12;
/// Order at which the downward recurrence starts: this plus a multiple of |z|.
const FIRST_ORDER: usize = 7;
const ORDERS_PER_MODULUS: f64 = 0.75;

/// Phase rates of a mode over an interval.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PhaseRate {
    /// q v at the start and at the end of the interval, 1/s.
    pub turning: [f64; 2],
    /// Length of the interval, s.
    pub step: f64,
}

impl PhaseRate {
    /// Phase factor of the mode over the interval, without decay.
    #[cfg(test)]
    pub(crate) fn phase(&self) -> Complex<f64> {
        Complex::from_polar(1.0, 0.5 * self.step * (self.turning[0] + self.turning[1]))
    }

    /// `q dv h/8`: deviation from a uniform phase rate.
    pub(crate) fn drift(&self) -> f64 {
        0.125 * self.step * (self.turning[1] - self.turning[0]).abs()
    }

    /// Propagation factor of the state, and the weights (s) of a flux falling from 1 at the start to 0 at the end, and
    /// of the reverse.
    pub(crate) fn weights(&self, rate: f64, turn: Complex<f64>) -> (Complex<f64>, Complex<f64>, Complex<f64>) {
        self.weights_of_decay(rate, (-rate * self.step).exp(), turn)
    }

    /// The same with `decay = exp(-rate h)` known.
    #[inline]
    pub(crate) fn weights_of_decay(
        &self,
        rate: f64,
        decay: f64,
        turn: Complex<f64>,
    ) -> (Complex<f64>, Complex<f64>, Complex<f64>) {
        let middle = 0.5 * (self.turning[0] + self.turning[1]);
        let factor = turn * decay;
        let z = Complex::new(-rate * self.step, middle * self.step);
        let eta = 0.5 * self.step * (self.turning[1] - self.turning[0]);
        let (all, falling) =
            if self.drift() <= LARGEST_DRIFT { integrals(z, factor, eta) } else { chirp::integrals(z, factor, eta) };
        (factor, falling * self.step, (all - falling) * self.step)
    }
}

/// Terms of the series for `q dv h/8`: drift^m/m! below 1e-8 ends it.
#[inline]
fn terms(drift: f64) -> usize {
    let mut terms = 1;
    let mut size = drift;
    while size > 1e-8 && terms < MOST_TERMS {
        terms += 1;
        size *= drift / terms as f64;
    }
    terms
}

/// `integral exp(z u + i eta u (1-u)) {1, u} du` over (0, 1); `factor` = e^z.
#[inline]
fn integrals(z: Complex<f64>, factor: Complex<f64>, eta: f64) -> (Complex<f64>, Complex<f64>) {
    if 0.25 * eta.abs() < LEAST_DRIFT {
        if z.re.abs() + z.im.abs() < NEAR {
            let falling = power_series(z, &FALLING);
            return (factor - z * falling, falling);
        }
        let inverse = z.inv();
        let all = (factor - 1.0) * inverse;
        return (all, (factor - all) * inverse);
    }
    let terms = terms(0.25 * eta.abs());
    let turned = |value: Complex<f64>| Complex::new(-eta * value.im, eta * value.re);
    let square = z * z;
    let modulus = z.norm_sqr().sqrt();
    let (mut all, mut tilt);
    // Upwards the recurrence is stable for orders below |z|/2.
    if modulus > 3.0 * (terms + 2) as f64 {
        let inverse = z.inv();
        let inverse_square = inverse * inverse;
        let mut lower = (factor - 1.0) * inverse;
        let mut upper = (factor * (z - 2.0) + z + 2.0) * inverse * inverse_square;
        let mut weight = Complex::from(1.0);
        (all, tilt) = (lower, upper);
        for m in 1..=terms {
            (lower, upper) = (upper, (lower - upper * (2.0 * (2 * m + 1) as f64)) * inverse_square);
            weight = turned(weight);
            all += weight * lower;
            tilt += weight * upper;
        }
    } else {
        // From an order at which the error of the starting values has decayed to 1e-10 at m = 0.
        let highest = terms.max(FIRST_ORDER + (ORDERS_PER_MODULUS * modulus) as usize);
        let (mut above, mut value) = (Complex::from(0.0), Complex::from(1.0));
        (all, tilt) = (value, above);
        for m in (1..=highest).rev() {
            (above, value) = (value, square * above + value * (2.0 * (2 * m + 1) as f64));
            all = value + turned(all);
            tilt = above + turned(tilt);
        }
        // After whole turns without decay T_0 nearly vanishes; T_1 does not, but cancels for small z.
        let scale = if modulus > 3.0 && (factor - 1.0).norm_sqr() < 0.01 {
            (factor * (z - 2.0) + z + 2.0) / (square * z * above)
        } else {
            let first = if modulus < 0.5 { power_series(z, &ALL) } else { (factor - 1.0) / z };
            first / value
        };
        all *= scale;
        tilt *= scale;
    }
    tilt *= z;
    (all, (all + tilt) * 0.5)
}

/// Sum of the powers of z, |z| < 1, with these coefficients.
#[inline]
fn power_series(z: Complex<f64>, coefficients: &[f64; POWERS]) -> Complex<f64> {
    coefficients.iter().rev().fold(Complex::from(0.0), |sum, coefficient| sum * z + coefficient)
}

/// Powers of a series: 1/15! = 8e-13 times 2^-14 ends it.
const POWERS: usize = 14;

/// `integral exp(z u) du = sum z^n/(n+1)!`.
const ALL: [f64; POWERS] = {
    let mut coefficients = [1.0; POWERS];
    let mut n = 1;
    while n < POWERS {
        coefficients[n] = coefficients[n - 1] / (n + 1) as f64;
        n += 1;
    }
    coefficients
};

/// `integral exp(z u) u du = sum z^n/(n! (n+2))`.
const FALLING: [f64; POWERS] = {
    let mut coefficients = ALL;
    let mut n = 0;
    while n < POWERS {
        coefficients[n] *= (n + 1) as f64 / (n + 2) as f64;
        n += 1;
    }
    coefficients
};

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    /// Composite Simpson rule on the definition, with the variable velocity.
    fn by_quadrature(rate: f64, motion: &PhaseRate) -> (Complex<f64>, Complex<f64>) {
        let parts = 100_000;
        let (mut all, mut falling) = (Complex::from(0.0), Complex::from(0.0));
        for i in 0..=parts {
            let tau = f64::from(i) / f64::from(parts);
            let weight = if i == 0 || i == parts { 1.0 } else { f64::from(2 + 2 * (i % 2)) };
            let angle = |t: f64| t * motion.turning[0] + 0.5 * t * t * (motion.turning[1] - motion.turning[0]);
            let phase = motion.step * (angle(1.0) - angle(tau));
            let value = Complex::new(-rate * motion.step * (1.0 - tau), phase).exp() * weight;
            all += value;
            falling += value * (1.0 - tau);
        }
        let scale = motion.step / (3.0 * f64::from(parts));
        (all * scale, falling * scale)
    }

    #[test]
    fn weights_are_the_integrals_of_their_definition() {
        for rate in [0.0, 1e-3, 0.7, 40.0, 2e3] {
            for turning in [
                [0.0, 0.0],
                [3.0, 3.0],
                [-200.0, -200.0],
                [5.0, 5.4],
                [5.0, 5.01],
                [-3.0, 9.0],
                [300.0, 180.0],
                [-50.0, 400.0],
                [400.0, -50.0],
                [0.0, 2e3],
                [-2e3, 0.0],
                [3e3, 2e3],
                [1e3, -3e3],
                // About the largest drift of the series.
                [0.0, 13.3],
                [0.0, 13.4],
                // Whole turns.
                [2.0 / 0.9 * PI - 1.0, 2.0 / 0.9 * PI + 1.0],
                [8.0 / 0.9 * PI + 4.0, 8.0 / 0.9 * PI - 4.0],
            ] {
                let motion = PhaseRate { turning, step: 0.9 };
                let (factor, falling, rising) = motion.weights(rate, motion.phase());
                let (all, exact) = by_quadrature(rate, &motion);
                let scale = 1e-7 * all.norm().max(0.9 / (1.0 + 0.9 * rate + 0.9 * turning[0].abs()));
                assert!((falling - exact).norm() < scale, "{rate} {turning:?}: {falling} {exact}");
                assert!((falling + rising - all).norm() < scale, "{rate} {turning:?}: {} {all}", falling + rising);
                let angle = 0.45 * (turning[0] + turning[1]);
                let expected = Complex::from_polar((-0.9 * rate).exp(), angle);
                assert!((factor - expected).norm() < 1e-12, "{factor} {expected}");
            }
        }
    }

    /// `value` and its neighbours.
    fn about(value: f64) -> [f64; 3] {
        [value.next_down(), value, value.next_up()]
    }

    /// On both sides of every threshold the weights agree to the truncation error of the series: at the bounds of the
    /// drift, and at the |z| where the power series, the recurrences and their normalisations change.
    #[test]
    fn weights_are_continuous_over_every_threshold() {
        for (drift, moduli) in [
            (LARGEST_DRIFT, &[0.0, 0.3, 1.0, 5.0, 50.0, 1e4][..]),
            (LEAST_DRIFT, &[0.0, 0.3, 1.0, 5.0, 50.0, 1e4][..]),
            (1e-6, &[0.5, 1.0][..]),
            (1e-2, &[0.5, 3.0, 9.0, 12.0, 15.0, 18.0][..]),
            (1.0, &[0.5, 3.0, 30.0, 39.0, 42.0][..]),
            // |a| or |a1| at the root of 1000 eta, and a phase rate that vanishes at an end.
            (20.0, &[1e3_f64.sqrt() * 80_f64.sqrt() - 80.0, 1e3_f64.sqrt() * 80_f64.sqrt() + 80.0, 80.0][..]),
        ] {
            for &modulus in moduli {
                for part in [0.0, 0.6, 1.0] {
                    let (rate, middle) = (part * modulus, (1.0 - part * part).sqrt() * modulus);
                    let mut found: Vec<[Complex<f64>; 2]> = Vec::new();
                    for change in about(8.0 * drift) {
                        for middle in about(middle) {
                            for rate in [rate.next_up(), rate, rate.next_down().max(0.0)] {
                                let turning = [middle - 0.5 * change, middle + 0.5 * change];
                                let motion = PhaseRate { turning, step: 1.0 };
                                let (_, falling, rising) = motion.weights(rate, motion.phase());
                                found.push([falling, rising]);
                            }
                        }
                    }
                    let scale = found[0][0].norm() + found[0][1].norm();
                    for weights in &found {
                        let apart = (weights[0] - found[0][0]).norm() + (weights[1] - found[0][1]).norm();
                        // The error of a constant velocity at small drifts is of the order of the drift itself.
                        let allowed = if drift == LEAST_DRIFT { LEAST_DRIFT } else { 2e-7 };
                        assert!(
                            apart <= allowed * scale,
                            "drift {drift}, |z| {modulus}, {part}: {apart:e} of {scale:e}"
                        );
                    }
                }
            }
        }
    }

    /// However fast the velocity changes, a single evaluation suffices, and the weights are bounded by the length of
    /// the step.
    #[test]
    fn weights_are_finite_however_fast_the_turning_changes() {
        for exponent in 0..60 {
            let change = 12.0 * 10_f64.powi(exponent);
            for start in [-change, -0.5 * change, 0.0, change] {
                for rate in [0.0, 1.0, 1e9, change] {
                    for change in about(change) {
                        let motion = PhaseRate { turning: [start, start + change], step: 1.0 };
                        let (factor, falling, rising) = motion.weights(rate, motion.phase());
                        for weight in [factor, falling, rising] {
                            assert!(weight.norm() <= 1.0 + 1e-9, "{start} {rate} {change}: {weight}");
                        }
                    }
                }
            }
        }
    }
}
