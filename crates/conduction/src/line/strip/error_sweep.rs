//! Reduction error sweep: exact impedance of every mode at a set of frequencies, to which reductions are compared.
//!
//! Theory: docs/theory.md, sections 4.5, 4.12.

use super::depth::{Depth, DepthModes};
use super::properties::Resolution;
use super::waves::Wave;
use crate::reduced::ReducedBody;
use crate::slab::Slab;
use nalgebra::Complex;
use numerics::maximum::maximum;

/// Exact impedances and weights of the sweep.
#[derive(Debug)]
pub(crate) struct ErrorSweep {
    frequencies: Vec<f64>,
    /// Weight of each mode in the mean contact temperature per flux.
    weights: Vec<f64>,
    /// Exact impedances, one row per frequency.
    exact: Vec<Complex<f64>>,
    /// Exact stationary impedances.
    stationary: Vec<f64>,
    /// Reduction error of the mean mode at each frequency.
    mean: Vec<Complex<f64>>,
    scale: f64,
}

impl ErrorSweep {
    /// Sweep for these modes and their layers under a contact of the width `width`, m.
    pub(crate) fn new(
        width: f64,
        slab: &Slab,
        mean: Option<&ReducedBody>,
        period: f64,
        (waves, layers): (&[Wave], &[Depth]),
        resolution: &Resolution,
    ) -> ErrorSweep {
        let weights: Vec<f64> = waves
            .iter()
            .map(|wave| {
                // Integral of the mode over the contact.
                let heat = 2.0 * (0.5 * wave.number * width).sin() / wave.number;
                2.0 * wave.count / period * heat * heat / width
            })
            .collect();
        let (slow, fast) = (0.3 / resolution.duration, 1.0 / resolution.shortest);
        let points = 16;
        let frequencies: Vec<f64> =
            (0..=points).map(|i| slow * (fast / slow).powf(f64::from(i) / f64::from(points))).collect();
        let stationary = layers.iter().map(|layer| layer.impedance(Complex::default()).re).collect();
        let mut error_sweep =
            ErrorSweep { frequencies, weights, exact: Vec::new(), stationary, mean: Vec::new(), scale: 0.0 };
        for &frequency in &error_sweep.frequencies {
            let s = Complex::new(0.0, frequency);
            error_sweep.exact.extend(layers.iter().map(|layer| layer.impedance(s)));
            let error = mean.map(|mean| (mean.impedance(s) - slab.impedance(s, 0.0)) * (width / period));
            error_sweep.mean.push(error.unwrap_or_default());
        }
        let s = Complex::new(0.0, 1.0 / resolution.duration);
        let parts = layers.iter().zip(&error_sweep.weights).map(|(layer, weight)| layer.impedance(s) * *weight);
        let uniform = mean.map(|_| slab.impedance(s, 0.0) * (width / period)).unwrap_or_default();
        error_sweep.scale = (uniform + parts.sum::<Complex<f64>>()).norm();
        error_sweep
    }

    /// Largest error of the mean contact temperature per flux over the frequencies from the duration's to the shortest
    /// step's, relative to its value at the duration's, from the depth modes of every `step`th Fourier mode with their static
    /// correction, by which the stationary response is exact.
    pub(crate) fn largest_error(&self, modes: &[DepthModes], step: usize) -> f64 {
        let count = self.weights.len();
        let mut largest: f64 = 0.0;
        for (row, &frequency) in self.frequencies.iter().enumerate() {
            let s = Complex::new(0.0, frequency);
            let mut error = self.mean[row];
            for (index, modes) in modes.iter().enumerate() {
                let wave = index * step;
                let correction = self.stationary[wave] - modes.impedance(Complex::default());
                error += (modes.impedance(s) + correction - self.exact[row * count + wave])
                    * (self.weights[wave] * step as f64);
            }
            largest = maximum(largest, error.norm_sqr().sqrt() / self.scale);
        }
        largest
    }
}
