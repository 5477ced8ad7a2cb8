//! Wave of pressure in full contact with heat, distortion and wear.
//!
//! Theory: docs/theory.md, section 10.

use super::special::complementary_error;
use std::f64::consts::PI;

/// A wave `p_1(t) cos(m x)` of the contact pressure between a conductor at rest in the frame of the wave and an
/// insulator that slides over it, both high against the wave length, without shear coupling.
///
/// Full contact keeps the gap closed: with the wave `g_1` of the unworn gap, worn depth `w_1`, elastic approach `C p_1`
/// and distortion,
///
/// ```text
/// g_1 + w_1 + C p_1 = D M,   dw_1/dt = k |v| p_1,   C = C_1 + C_2,   C_i = 2 (1 - nu_i^2)/(E_i m),   D = 2 (1 + nu) alpha,
/// M(t) = integral of the wave of temperature over the depth, weighted with exp(-m z)
///      = (kd/K) integral_0^t erfc(m sqrt(kd (t - s))) mu |v(s)| p_1(s) ds.
/// ```
///
/// The kernel is the inverse Laplace transform of `1/(lambda (lambda + m))`, `lambda^2 = m^2 + s/kd`: the dispersion
/// relation of thermoelastic instability (R. A. Burton, V. Nerlikar, S. R. Kilaparti, Wear 24 (1973)) is its pole for a
/// constant speed. Product integration with linear flux: second order in the step, and exact in the kernel.
#[derive(Clone, Copy, Debug)]
pub struct PressureWave {
    /// Wave number m, 1/m.
    pub wave_number: f64,
    /// Compliance C, m/Pa.
    pub compliance: f64,
    /// Distortion factor D of the conductor, 1/K.
    pub distortion: f64,
    /// Conductivity K of the conductor, W/(m K).
    pub conductivity: f64,
    /// Diffusivity kd of the conductor, m2/s.
    pub diffusivity: f64,
    /// Friction coefficient mu.
    pub friction: f64,
    /// Wear coefficient k of the bodies whose wear follows the wave, m2/N.
    pub wear: f64,
}

impl PressureWave {
    /// `p_1` (Pa) at the times `n duration/steps`, n = 0 to `steps`, from cold unworn bodies whose gap has the wave
    /// `gap` (m), at the speed `velocity` (m/s) of the time (s).
    pub fn course(&self, gap: f64, duration: f64, steps: usize, velocity: impl Fn(f64) -> f64) -> Vec<f64> {
        let step = duration / steps as f64;
        let weights: Vec<[f64; 2]> = (0..steps).map(|lag| self.weights(lag, step)).collect();
        let factor = self.diffusivity / self.conductivity;
        let mut pressure = Vec::with_capacity(steps + 1);
        let (mut flux, mut worn, mut wearing) = (Vec::with_capacity(steps + 1), 0.0, 0.0);
        for n in 0..=steps {
            let speed = velocity(n as f64 * step).abs();
            let half = if n == 0 { 0.0 } else { 0.5 * step };
            worn += half * wearing;
            // M by the past fluxes, and the contribution of the present flux.
            let past: f64 = (1..n).map(|k| flux[k] * (weights[n - k][0] + weights[n - k - 1][1])).sum();
            let first = if n > 0 { flux[0] * weights[n - 1][1] } else { 0.0 };
            let present = if n > 0 { weights[0][0] } else { 0.0 };
            let stiffness =
                self.compliance + half * self.wear * speed - self.distortion * factor * present * self.friction * speed;
            let amplitude = (self.distortion * factor * (past + first) - worn - gap) / stiffness;
            wearing = self.wear * speed * amplitude;
            worn += half * wearing;
            flux.push(self.friction * speed * amplitude);
            pressure.push(amplitude);
        }
        pressure
    }

    /// Weights of the flux at the recent and at the old end of the step that is `lag` steps back.
    fn weights(&self, lag: usize, step: f64) -> [f64; 2] {
        let (from, to) = (lag as f64 * step, (lag + 1) as f64 * step);
        let [first, last] = [from, to].map(|age| self.moments(age));
        let (whole, weighted) = (last[0] - first[0], last[1] - first[1]);
        let old = (weighted - from * whole) / step;
        [whole - old, old]
    }

    /// Integrals of the kernel and of age times kernel from 0 to `age`, `c = m^2 kd`, by parts from
    /// `integral sqrt(a) exp(-c a) = sqrt(pi/c) erf(sqrt(c a))/(2 c) - sqrt(a) exp(-c a)/c`.
    fn moments(&self, age: f64) -> [f64; 2] {
        let rate = self.wave_number.powi(2) * self.diffusivity;
        let (root, decay) = (age.sqrt(), (-rate * age).exp());
        let left = complementary_error((rate * age).sqrt());
        let half = 0.5 * (PI / rate).sqrt() * (1.0 - left) / rate - root * decay / rate;
        let three_halves = 1.5 * half / rate - age * root * decay / rate;
        let slope = (rate / PI).sqrt();
        [age * left + slope * half, 0.5 * (age * age * left + slope * three_halves)]
    }
}
