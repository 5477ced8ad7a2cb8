//! How fast the contact answers what no mode with states carries.
//!
//! Short waves and the fastest shapes have no state of their own. Were their steady distortion there at once, it would raise the
//! pressure that heats it above the critical speed of a wave, and so itself, in no time, and no step would be short enough for
//! that. In truth its heat has to flow in first, and the wave grows at a finite rate. The temperature comes with a delay as well:
//! at once, a flux that jumps from cell to cell would leave temperatures that no body has.
//!
//! On the N cells the steady temperature of all these waves and the first moment of their distortion over time are given by
//! two symmetric matrices (waves F_m on the cells, steady impedance z_m, time tau_m in which the distortion follows)
//!
//! ```text
//! X_0 = sum z_m F_m F_m',    X_1 = sum tau_m z_m F_m F_m'
//! ```
//!
//! and `X_1 phi = tau X_0 phi`, `phi' X_0 phi = 1` gives N shapes that follow the flux each in its own time, one state each.
//! Steady answers are those of the waves. The temperature comes with the shapes too, although it takes 2/3 of the time of the
//! distortion only: `1/(1 + 3/2 x)` for `1/sqrt(1 + 2 x)`, x = s times its own time, which is .29 of the steady answer off at most. A
//! third of it at once and the rest with the shapes has the right first moment, is .33 off, and what is at once has lost the long
//! waves, whose states follow in their own time: behind a jump of a flux on few cells, the others cool below what is around them.

use super::SUMMED_MODES;
use super::across::Wave;
use super::assembly::Assembly;
use crate::line::reduced::{ModeStates, ReducedOperators};
use nalgebra::{Complex, DMatrix, DVectorView};
use numerics::factorization;
use numerics::maximum::{self, maximum};

/// Shapes whose part in the steady answer is smaller than this, relative to the largest, are left to answer at once.
const SMALLEST: f64 = 1e-10;

/// Relative difference of mirrored entries up to which cells are symmetric about the middle.
const SYMMETRIC: f64 = 1e-9;

/// Time in which the distortion follows over that of the temperature: with `lambda^2 = m^2 + s/kd` the derivatives of
/// `1/(lambda (lambda + m))` and `1/lambda` at s = 0.
const DISTORTION_OVER_TEMPERATURE: f64 = 1.5;

/// Bases of the vectors on the cells by parity (1 even, -1 odd), where the cells do not tell left from right; else of all vectors.
fn parities(matrix: &DMatrix<f64>) -> Vec<(Option<f64>, DMatrix<f64>)> {
    let count = matrix.nrows();
    let (largest, last) = (matrix.amax(), count.saturating_sub(1));
    let mirrored = DMatrix::from_fn(count, count, |i, j| matrix[(last - i, last - j)]);
    if (matrix - mirrored).amax() > SYMMETRIC * largest {
        return vec![(None, DMatrix::identity(count, count))];
    }
    let basis = |sign: f64, size: usize| {
        let mut basis = DMatrix::zeros(count, size);
        for k in 0..size {
            let part = if last - k == k { 1.0 } else { std::f64::consts::FRAC_1_SQRT_2 };
            (basis[(last - k, k)], basis[(k, k)]) = (sign * part, part);
        }
        (Some(sign), basis)
    };
    vec![basis(1.0, count.div_ceil(2)), basis(-1.0, count / 2)]
}

/// Takes from values on symmetric cells what is not of their parity.
fn keep_parity(sign: f64, values: &mut [f64]) {
    let last = values.len().saturating_sub(1);
    for i in 0..values.len().div_ceil(2) {
        let own = 0.5 * (values[i] + sign * values[last - i]);
        (values[last - i], values[i]) = (sign * own, own);
    }
}

impl Assembly<'_> {
    /// Gives what answers at once states of its own; call it when all other operators are complete.
    pub(super) fn give_first_order_dynamics(&self, operators: &mut ReducedOperators) {
        let count = self.cells.count();
        let beyond = self.modes.len().max(1)..SUMMED_MODES.max(self.modes.len());
        let impedance = |wave: &Wave| self.depth.steady_impedance(wave.decay);
        let mut steady = self.waves.sum(beyond.clone(), |_, wave| impedance(wave));
        let mut moment = self.waves.sum(beyond, |_, wave| self.time_to_follow(wave.decay) * impedance(wave));
        for (m, mode) in self.modes.iter().enumerate() {
            if let Some(shape) = &mode.immediate {
                let gain = shape.contact * shape.contact / shape.rate;
                let integrals = DVectorView::from_slice(self.waves.integrals(m), count);
                steady.ger(gain, &integrals, &integrals, 1.0);
                moment.ger(gain * DISTORTION_OVER_TEMPERATURE / shape.rate, &integrals, &integrals, 1.0);
            }
        }
        // Symmetric and scaled to a unit diagonal; the widths of the cells differ by orders of magnitude.
        let scale: Vec<f64> = (0..count).map(|i| steady[(i, i)].max(f64::MIN_POSITIVE).sqrt().recip()).collect();
        let scaled =
            |matrix: &DMatrix<f64>| DMatrix::from_fn(count, count, |i, j| scale[i] * scale[j] * matrix[(i, j)]);
        let (all, all_moments) = (scaled(&steady), scaled(&moment));
        // Shapes of nearly the same time come even and odd where the cells are symmetric, not mixed.
        let found: Vec<_> = (parities(&all).into_iter())
            .map(|(sign, basis)| {
                (sign, factorization::symmetric_eigen_or_nan(basis.transpose() * &all * &basis), basis)
            })
            .collect();
        let largest = found.iter().flat_map(|(_, own, _)| own.eigenvalues.iter()).copied();
        let largest = maximum::largest(largest.map(|value| maximum(value, 0.0)));
        let (mut shapes, mut times) = (DMatrix::zeros(count, 0), Vec::new());
        for (sign, own, basis) in found {
            let kept: Vec<usize> = (0..basis.ncols()).filter(|&k| own.eigenvalues[k] > SMALLEST * largest).collect();
            let whitened = basis
                * DMatrix::from_fn(own.eigenvectors.nrows(), kept.len(), |i, k| {
                    own.eigenvectors[(i, kept[k])] / own.eigenvalues[kept[k]].sqrt()
                });
            let own = factorization::symmetric_eigen_or_nan(whitened.transpose() * &all_moments * &whitened);
            let first = shapes.ncols();
            shapes = shapes.insert_columns(first, kept.len(), 0.0);
            shapes.columns_mut(first, kept.len()).copy_from(&(whitened * own.eigenvectors));
            times.extend(own.eigenvalues.iter().map(|&time| (time, sign)));
        }
        for (i, mut row) in shapes.row_iter_mut().enumerate() {
            row *= scale[i];
        }
        let distorts = !operators.distortion.is_empty();
        operators.own = operators.rate.len();
        let mut integrals = &steady * &shapes;
        let mut displacements = &operators.distortion_by_flux * &shapes;
        for (k, (_, sign)) in times.iter().enumerate() {
            if let Some(sign) = sign {
                for matrix in [&mut integrals, &mut displacements] {
                    keep_parity(*sign, matrix.column_mut(k).as_mut_slice());
                }
            }
        }
        for (k, &(time, _)) in times.iter().enumerate() {
            if time <= 0.0 {
                continue;
            }
            let rate = time.recip();
            let state = operators.rate.len();
            let integrals: Vec<f64> = integrals.column(k).iter().copied().collect();
            operators.rate.push(rate);
            operators.contact.push(rate.sqrt());
            let means: Vec<f64> =
                (integrals.iter().zip(&operators.widths)).map(|(integral, area)| integral / area).collect();
            for (j, integral) in integrals.iter().enumerate() {
                for (entry, mean) in operators.temperature_by_flux.column_mut(j).iter_mut().zip(&means) {
                    *entry -= mean * integral;
                }
            }
            if distorts {
                operators.distortion.extend(displacements.column(k).iter().map(|moved| moved * rate.sqrt()));
                for (j, integral) in integrals.iter().enumerate() {
                    operators.distortion_by_flux.column_mut(j).axpy(-integral, &displacements.column(k), 1.0);
                }
            }
            // The heat that it holds is counted as it enters.
            operators.modes.push(ModeStates { states: state..state + 1, integrals, means });
            operators.uniform.push(0.0);
            operators.stored.push(0.0);
            operators.input.iter_mut().for_each(|input| input.push(0.0));
            let ReducedOperators { cooled, far_face, ambient_flow, far_flow, .. } = &mut *operators;
            for observed in [cooled, far_face, ambient_flow, far_flow] {
                observed.states.push(0.0);
            }
        }
    }

    /// Time (s) in which the steady distortion of a wave without states follows its flux: `3/(4 kd m^2)` of a deep body.
    fn time_to_follow(&self, decay: f64) -> f64 {
        let diffusivity = self.depth.diffusivity();
        // A complex step gives the derivative without cancellation.
        let step = 1e-20 * diffusivity * decay * decay;
        let impedance = self.depth.impedance(Complex::new(decay * decay, step / diffusivity).sqrt());
        -DISTORTION_OVER_TEMPERATURE * impedance.im / (step * impedance.re)
    }
}
