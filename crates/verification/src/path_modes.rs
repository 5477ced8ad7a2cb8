//! Exact modes of the layer under a closed path: transients by plain sums, and the results of simple time schemes for them.
//!
//! In the punch's frame the temperature of a layer with a held base is a sum over Fourier modes `q = 2 pi n/L` and depth
//! modes `beta_k = (k + 1/2) pi/h`, each of which decays and rotates in phase independently,
//!
//! ```text
//! dx/dt = -lambda x + f(t),   lambda = kd (beta^2 + q^2) - i q v,   mean over the contact = sum of weight Re x
//! ```
//!
//! with the weights `(2a/L) 2/(h rho c)` for n = 0 and `(4a/L) (sin(qa)/(qa))^2 2/(h rho c)` for the others. A one-step
//! scheme multiplies a mode by R(lambda h) per step and has the same steady state.
//!
//! Theory: docs/theory.md, section 4.5.

use exact::reference::{ClosedPath, LayerBase};
use nalgebra::Complex;
use std::f64::consts::PI;

#[derive(Clone, Debug)]
pub(crate) struct PathModes {
    rate: Vec<Complex<f64>>,
    weight: Vec<f64>,
    /// Steady mean over the contact per flux, of all modes, K m2/W.
    steady: f64,
}

impl PathModes {
    /// Modes of `path`, whose base is held: `waves` Fourier modes and `depths` modes through the depth; those beyond are
    /// quasi-static.
    pub(crate) fn new(path: &ClosedPath, velocity: f64, waves: u32, depths: u32) -> PathModes {
        assert_eq!(path.base, LayerBase::Held, "the modes are those of a held base");
        let capacity = path.conductivity / path.diffusivity;
        let mut modes = PathModes { rate: Vec::new(), weight: Vec::new(), steady: 0.0 };
        for n in 0..=waves {
            let q = 2.0 * PI * f64::from(n) / path.length;
            let shape = if n == 0 { 0.5 } else { ((q * path.half_length).sin() / (q * path.half_length)).powi(2) };
            let weight = 4.0 * path.half_length / path.length * shape * 2.0 / (path.height * capacity);
            for k in 0..depths {
                let beta = (f64::from(k) + 0.5) * PI / path.height;
                modes.rate.push(Complex::new(path.diffusivity * (beta * beta + q * q), -q * velocity));
                modes.weight.push(weight);
            }
        }
        let uniform = 2.0 * path.half_length / path.length * path.height / path.conductivity;
        modes.steady = uniform + path.steady_mean(velocity, 20 * waves);
        modes
    }

    pub(crate) fn steady(&self) -> f64 {
        self.steady
    }

    /// Sum over the modes of weight times the real part of `value`.
    fn sum(&self, value: impl Fn(Complex<f64>) -> Complex<f64>) -> f64 {
        self.rate.iter().zip(&self.weight).map(|(&rate, weight)| weight * value(rate).re).sum()
    }

    /// Mean over the contact after `count` steps of `step` (s) with the flux `flux`, from rest or (`reversed`) from the
    /// steady state for a flux of 1 at the opposite velocity. A mode is multiplied by `factor(lambda h)` per step.
    pub(crate) fn after(
        &self,
        reversed: bool,
        flux: f64,
        step: f64,
        count: i32,
        factor: impl Fn(Complex<f64>) -> Complex<f64>,
    ) -> f64 {
        flux * self.steady
            + self.sum(|rate| {
                let start = if reversed { rate.conj().inv() } else { Complex::new(0.0, 0.0) };
                factor(rate * step).powi(count) * (start - flux / rate)
            })
    }
}

/// exp(-z): exact propagation.
pub(crate) fn exact(z: Complex<f64>) -> Complex<f64> {
    (-z).exp()
}

pub(crate) fn crank_nicolson(z: Complex<f64>) -> Complex<f64> {
    (1.0 - 0.5 * z) / (1.0 + 0.5 * z)
}

pub(crate) fn implicit_euler(z: Complex<f64>) -> Complex<f64> {
    (1.0 + z).inv()
}
