//! Exact propagation of a decaying, turning state over a step.
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
//! and both integrals, of 1 and of u, follow from `S_m = integral exp(z u) [u (1-u)]^m du` by the series in eta.
//! `S_m = S_(m-1) m r_m` with `r_m = 1/(2 (2m+1) + z^2 r_(m+1))` (modified spherical Bessel functions of z/2: the
//! recurrence runs downwards, or upwards where |z| is large, as is stable). Where eta/4 = q dv h/8 is large the step is cut.

use nalgebra::Complex;

/// Largest `q dv h/8` that the series takes; larger ones cut the step.
const LARGEST_DRIFT: f64 = 1.5;
/// Below this `q dv h/8` the velocity counts as constant: its part of the wave's own amplitude. The waves for which it is
/// not much smaller are short, and one in a hundred of the temperature.
const LEAST_DRIFT: f64 = 5e-4;
/// Terms of the series at the largest drift: 1.5^13/13! = 3e-8.
const MOST_TERMS: usize = 12;

/// What acts on a wave over a step.
#[derive(Clone, Copy, Debug)]
pub struct Motion {
    /// q v at the start and at the end of the interval, 1/s.
    pub turning: [f64; 2],
    /// Length of the interval, s.
    pub step: f64,
}

impl Motion {
    /// Factor by which the wave turns over the interval, without decay.
    pub fn turn(&self) -> Complex<f64> {
        Complex::from_polar(1.0, 0.5 * self.step * (self.turning[0] + self.turning[1]))
    }

    /// `q dv h/8`: how far the wave is from turning evenly.
    pub fn drift(&self) -> f64 {
        0.125 * self.step * (self.turning[1] - self.turning[0]).abs()
    }

    /// Factor of the state and weight (s) of the flux in one implicit Euler step.
    pub fn euler(&self, rate: f64) -> (Complex<f64>, Complex<f64>) {
        let turned = 0.5 * self.step * (self.turning[0] + self.turning[1]);
        let factor = Complex::new(1.0 + rate * self.step, -turned).inv();
        (factor, factor * self.step)
    }

    /// Factor of the state, and the weights (s) of a flux of 1 at the start falling to 0 at the end, and of the reverse.
    pub fn weights(&self, rate: f64, turn: Complex<f64>) -> (Complex<f64>, Complex<f64>, Complex<f64>) {
        self.weights_of_decay(rate, (-rate * self.step).exp(), turn)
    }

    /// The same with `decay = exp(-rate h)` known.
    #[inline]
    pub fn weights_of_decay(
        &self,
        rate: f64,
        decay: f64,
        turn: Complex<f64>,
    ) -> (Complex<f64>, Complex<f64>, Complex<f64>) {
        let drift = self.drift();
        if drift <= LARGEST_DRIFT {
            let middle = 0.5 * (self.turning[0] + self.turning[1]);
            let factor = turn * decay;
            let z = Complex::new(-rate * self.step, middle * self.step);
            let eta = 0.5 * self.step * (self.turning[1] - self.turning[0]);
            let (all, falling) = integrals(z, factor, eta);
            return (factor, falling * self.step, (all - falling) * self.step);
        }
        let parts = (drift / LARGEST_DRIFT).sqrt().ceil();
        let (mut factor, mut falling, mut rising) = (Complex::from(1.0), Complex::from(0.0), Complex::from(0.0));
        let mut part = 0.0;
        while part < parts {
            let (from, to) = (part / parts, (part + 1.0) / parts);
            let at = |t: f64| self.turning[0] + t * (self.turning[1] - self.turning[0]);
            let motion = Motion { turning: [at(from), at(to)], step: self.step / parts };
            let (f, first, last) = motion.weights(rate, motion.turn());
            factor *= f;
            falling = f * falling + first * (1.0 - from) + last * (1.0 - to);
            rising = f * rising + first * from + last * to;
            part += 1.0;
        }
        (factor, falling, rising)
    }
}

/// `integral exp(z u + i eta u (1-u)) {1, u} du` over (0, 1); `factor` = e^z.
#[inline]
fn integrals(z: Complex<f64>, factor: Complex<f64>, eta: f64) -> (Complex<f64>, Complex<f64>) {
    if 0.25 * eta.abs() < LEAST_DRIFT {
        if z.re.abs() + z.im.abs() < 0.5 {
            return horner(z);
        }
        let inverse = z.inv();
        let all = (factor - 1.0) * inverse;
        return (all, (factor - all) * inverse);
    }
    let drift = 0.25 * eta.abs();
    // (drift)^m/m! below 1e-8 ends the series.
    let mut terms = 1;
    let mut size = drift;
    while size > 1e-8 && terms < MOST_TERMS {
        terms += 1;
        size *= drift / terms as f64;
    }
    let square = z * z;
    let mut ratio = [Complex::from(0.0); MOST_TERMS + 2];
    let modulus = z.norm();
    // Upwards the recurrence is stable for orders below |z|/2.
    let upwards = modulus > 3.0 * (terms + 2) as f64;
    if !upwards {
        // Started beyond |z|/2, where the ratios have become small.
        let beyond = terms + 10 + (0.6 * modulus) as usize;
        let mut below = Complex::from(0.0);
        for m in (1..=beyond).rev() {
            below = (square * below + 2.0 * (2 * m + 1) as f64).inv();
            if m <= terms + 1 {
                ratio[m] = below;
            }
        }
    }
    let first = if modulus < 0.5 { horner(z).0 } else { (factor - 1.0) / z };
    let (mut before, mut moment, mut weight) = (Complex::from(0.0), first, Complex::from(1.0));
    let (mut all, mut tilt) = (Complex::from(0.0), Complex::from(0.0));
    for m in 0..=terms {
        let next = if !upwards {
            moment * (m + 1) as f64 * ratio[m + 1]
        } else if m == 0 {
            (factor * (z - 2.0) + z + 2.0) / (square * z)
        } else {
            (before * m as f64 - moment * 2.0 * (2 * m + 1) as f64) * (m + 1) as f64 / square
        };
        all += weight * moment;
        // integral exp(zu) [u(1-u)]^m (2u - 1) du = z/(m+1) S_(m+1)
        tilt += weight * next * z / (m + 1) as f64;
        weight *= Complex::new(0.0, eta / (m + 1) as f64);
        (before, moment) = (moment, next);
    }
    (all, (all + tilt) * 0.5)
}

/// `integral exp(z u) {1, u} du` by the power series, |z| < 1.
#[inline]
fn horner(z: Complex<f64>) -> (Complex<f64>, Complex<f64>) {
    // all = sum z^n/(n+1)!, and falling = integral u e^(zu) = (e^z - all)/z = sum z^n/(n! (n+2)).
    let (mut all, mut falling) = (Complex::from(0.0), Complex::from(0.0));
    for n in (0..14).rev() {
        all = all * z + INVERSE_FACTORIAL[n + 1];
        falling = falling * z + INVERSE_FACTORIAL[n] / (n + 2) as f64;
    }
    (all, falling)
}

const INVERSE_FACTORIAL: [f64; 15] = {
    let mut table = [1.0; 15];
    let mut n = 1;
    while n < 15 {
        table[n] = table[n - 1] / n as f64;
        n += 1;
    }
    table
};

#[cfg(test)]
mod tests {
    use super::*;

    /// Composite Simpson rule with the variable velocity, from the definition.
    fn by_quadrature(rate: f64, motion: &Motion) -> (Complex<f64>, Complex<f64>) {
        let parts = 40_000;
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
            ] {
                let motion = Motion { turning, step: 0.9 };
                let (factor, falling, rising) = motion.weights(rate, motion.turn());
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
}
