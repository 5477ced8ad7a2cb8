//! First-order dynamics of the quasi-static modes, those that carry no states of their own.
//!
//! Fourier modes of short wavelength and the fastest shapes have no states. If their steady distortion were a direct
//! feedthrough, then above the critical speed of a mode it would raise the pressure that heats it instantaneously, and the
//! coupled problem would be ill-posed for every step size. Physically the heat has to be conducted in first, and the mode
//! grows at a finite rate. The temperature needs dynamics as well: with a direct feedthrough, a flux that is discontinuous
//! between cells would produce temperatures outside the physical range.
//!
//! On the N cells the steady temperature of all these modes and the first moment of their distortion over time are given by
//! two symmetric matrices (modes F_m on the cells, steady impedance z_m, time constant tau_m of the distortion)
//!
//! ```text
//! X_0 = sum z_m F_m F_m',    X_1 = sum tau_m z_m F_m F_m'
//! ```
//!
//! and `X_1 phi = tau X_0 phi`, `phi' X_0 phi = 1` gives N shapes, each with one state that follows the flux with its own
//! time constant. Steady responses are exact. The temperature follows through the same shapes, although its time constant is
//! only 2/3 of that of the distortion: `1/(1 + 3/2 x)` for `1/sqrt(1 + 2 x)`, x = s times its own time constant, differs by
//! 0.29 of the steady response at most. One third as a direct feedthrough and the rest through the shapes would have
//! the exact first moment, but differs by 0.33, and the feedthrough part would exclude the long modes, whose states
//! follow with their own time constants: after a jump of the flux on few cells, the other cells would cool below their
//! surroundings.
//!
//! Theory: docs/theory.md, section 4.10.

use super::SUMMED_MODES;
use super::assembly::Assembly;
use super::steady::SteadyBeyond;
use super::waves::Waves;
use crate::line::contact_parts::PARTS;
use crate::line::reduced::{ModeStates, ReducedOperators};
use elasticity::Cells;
use nalgebra::{Complex, DMatrix, DVectorView};
use numerics::factorization;
use numerics::maximum::{self, maximum};
use std::ops::Range;

/// Ratio of the time constants of distortion and temperature: with `lambda^2 = m^2 + s/kd` the derivatives of
/// `1/(lambda (lambda + m))` and `1/lambda` at s = 0.
const DISTORTION_OVER_TEMPERATURE: f64 = 1.5;

/// Bases of the vectors on the cells by parity (1 even, -1 odd) where the cells are symmetric about the middle; else one of
/// all vectors.
fn parities(matrix: &DMatrix<f64>) -> Vec<(Option<f64>, DMatrix<f64>)> {
    let count = matrix.nrows();
    let (largest, last) = (matrix.amax(), count.saturating_sub(1));
    let mirrored = DMatrix::from_fn(count, count, |i, j| matrix[(last - i, last - j)]);
    // Relative difference of mirrored entries up to which cells are symmetric about the middle.
    if (matrix - mirrored).amax() > 1e-9 * largest {
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

/// Projects values on symmetric cells on their parity.
fn keep_parity(sign: f64, values: &mut [f64]) {
    let last = values.len().saturating_sub(1);
    for i in 0..values.len().div_ceil(2) {
        let own = 0.5 * (values[i] + sign * values[last - i]);
        (values[last - i], values[i]) = (sign * own, own);
    }
}

/// Adds `gain` times the products of the integrals over the parts of every cell to its block.
fn add_within(blocks: &mut [f64], gain: f64, integrals: &[f64]) {
    for (block, own) in blocks.chunks_exact_mut(PARTS * PARTS).zip(integrals.chunks_exact(PARTS)) {
        for (row, left) in block.chunks_exact_mut(PARTS).zip(own) {
            row.iter_mut().zip(own).for_each(|(entry, right)| *entry += gain * left * right);
        }
    }
}

impl Assembly<'_> {
    /// Replaces the direct feedthrough by first-order states; called when all other operators are complete.
    pub(super) fn give_first_order_dynamics(&self, operators: &mut ReducedOperators) {
        let count = self.cells.count();
        // Integrals of the temperature; all of it, so that no feedthrough remains, which the sum of a series would leave with either sign.
        let mut steady = operators.temperature_by_flux.clone();
        for (mut row, width) in steady.row_iter_mut().zip(&operators.widths) {
            row *= *width;
        }
        let steady = 0.5 * (&steady + steady.transpose());
        let mut moment = self.waves.sum(self.quasi_static_modes(), |_, wave| {
            self.time_constant(wave.decay) * self.depth.steady_impedance(wave.decay)
        });
        for (m, mode) in self.modes.iter().enumerate() {
            if let Some(shape) = &mode.feedthrough {
                let gain = shape.contact * shape.contact / shape.rate;
                let integrals = DVectorView::from_slice(self.waves.integrals(m), count);
                moment.ger(gain * DISTORTION_OVER_TEMPERATURE / shape.rate, &integrals, &integrals, 1.0);
            }
        }
        // Symmetric and scaled to a unit diagonal; the widths of the cells differ by orders of magnitude.
        let scale: Vec<f64> = (0..count).map(|i| steady[(i, i)].max(f64::MIN_POSITIVE).sqrt().recip()).collect();
        let scaled =
            |matrix: &DMatrix<f64>| DMatrix::from_fn(count, count, |i, j| scale[i] * scale[j] * matrix[(i, j)]);
        let (all, all_moments) = (scaled(&steady), scaled(&moment));
        // On symmetric cells, shapes of nearly equal time constants are separated by parity.
        let found: Vec<_> = (parities(&all).into_iter())
            .map(|(sign, basis)| {
                (sign, factorization::symmetric_eigen_or_nan(basis.transpose() * &all * &basis), basis)
            })
            .collect();
        let largest = found.iter().flat_map(|(_, own, _)| own.eigenvalues.iter()).copied();
        let largest = maximum::largest(largest.map(|value| maximum(value, 0.0)));
        let (mut shapes, mut times) = (DMatrix::zeros(count, 0), Vec::new());
        for (sign, own, basis) in found {
            // Shapes whose contribution to the steady response, relative to the largest, is smaller than this stay a direct feedthrough.
            let kept: Vec<usize> = (0..basis.ncols()).filter(|&k| own.eigenvalues[k] > 1e-10 * largest).collect();
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
        let by_part = self.divided.as_ref().map(|divided| self.steady_of_parts(divided));
        let integrals_of_parts = by_part.as_ref().map(|(steady, _)| steady * &shapes);
        if let Some((_, within)) = by_part {
            operators.remainder = within;
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
            let by_part: Vec<f64> =
                integrals_of_parts.as_ref().map_or(Vec::new(), |all| all.column(k).iter().copied().collect());
            add_within(&mut operators.remainder, -1.0, &by_part);
            // Its stored heat is accounted for at the input.
            operators.modes.push(ModeStates { states: state..state + 1, integrals, means, by_part });
            operators.uniform.push(0.0);
            operators.stored.push(0.0);
            operators.input.iter_mut().for_each(|input| input.push(0.0));
            let ReducedOperators { cooled, far_face, ambient_flow, far_flow, .. } = &mut *operators;
            for observed in [cooled, far_face, ambient_flow, far_flow] {
                observed.states.push(0.0);
            }
        }
    }

    /// Modes without states.
    fn quasi_static_modes(&self) -> Range<usize> {
        self.modes.len().max(1)..SUMMED_MODES.max(self.modes.len())
    }

    /// X_0 with the parts of the cells in the rows, and its blocks of the parts of every cell, cell by cell.
    fn steady_of_parts(&self, (parts, waves): &(Cells, Waves)) -> (DMatrix<f64>, Vec<f64>) {
        let beyond = SteadyBeyond::new(&self.across, &self.depth, self.modes.len());
        let [divided, whole] =
            [(parts, waves), (self.cells, &self.waves)].map(|(cells, waves)| beyond.over(cells, waves));
        let mut steady = beyond.between((&divided, 0..parts.count()), (&whole, 0..self.cells.count()));
        let of_cell = |cell: usize| (&divided, cell * PARTS..(cell + 1) * PARTS);
        let blocks = (0..self.cells.count()).map(|cell| beyond.between(of_cell(cell), of_cell(cell)));
        let mut within: Vec<f64> = blocks.flat_map(|block| block.as_slice().to_vec()).collect();
        for (m, mode) in self.modes.iter().enumerate() {
            if let Some(shape) = &mode.feedthrough {
                let gain = shape.contact * shape.contact / shape.rate;
                let [parts, cells] = [waves, &self.waves].map(|waves| waves.integrals(m));
                steady.ger(
                    gain,
                    &DVectorView::from_slice(parts, parts.len()),
                    &DVectorView::from_slice(cells, cells.len()),
                    1.0,
                );
                add_within(&mut within, gain, parts);
            }
        }
        (steady, within)
    }

    /// Time constant (s) with which the steady distortion of a mode without states follows its flux: `3/(4 kd m^2)` of a
    /// deep body.
    fn time_constant(&self, decay: f64) -> f64 {
        let diffusivity = self.depth.diffusivity();
        // Complex-step derivative: free of cancellation.
        let step = 1e-20 * diffusivity * decay * decay;
        let impedance = self.depth.impedance(Complex::new(decay * decay, step / diffusivity).sqrt());
        -DISTORTION_OVER_TEMPERATURE * impedance.im / (step * impedance.re)
    }
}
