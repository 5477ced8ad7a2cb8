//! How fast the distortion answers that no mode with states carries.
//!
//! Short waves and the fastest shapes have no state: their steady answer is at hand at once. For the temperature that is
//! harmless, what answers at once only takes. A distortion that answers at once is not: above the critical speed of a wave it
//! would raise the pressure that heats it, and so itself, in no time, and no step would be short enough for that. In truth
//! its heat has to flow in first, and the wave grows at a finite rate.
//!
//! On the N cells the steady answer `D` of all these waves and their first moment over time are given by two symmetric
//! matrices (waves F_m on the cells, weights d_m of their distortion, times tau_m in which it follows)
//!
//! ```text
//! X_0 = sum d_m F_m F_m',    X_1 = sum d_m tau_m F_m F_m'
//! ```
//!
//! and `X_1 phi = tau X_0 phi`, `phi' X_0 phi = 1` gives N shapes that follow the flux each in its own time: steady answer and
//! first moment are those of the waves. One state each.

use super::Assembly;
use crate::heat::line::reduced::{ModeStates, Operators};
use nalgebra::{Complex, DMatrix, SymmetricEigen};

/// Modes across that are summed.
const SUMMED: usize = 1000;

/// Shapes whose part in the steady answer is smaller than this, relative to the largest, are left to answer at once.
const SMALLEST: f64 = 1e-10;

/// Time in which the distortion follows over that of the temperature: with `lambda^2 = m^2 + s/kd` the derivatives of
/// `1/(lambda (lambda + m))` and `1/lambda` at s = 0.
const DISTORTION_OVER_TEMPERATURE: f64 = 1.5;

impl Assembly<'_> {
    /// Gives the distortion that answers at once states of its own; call it when all other operators are complete.
    pub(super) fn delay_distortion(&self, operators: &mut Operators) {
        let count = self.cells.count();
        let mut steady = DMatrix::<f64>::zeros(count, count);
        let mut moment = steady.clone();
        let mut add = |integrals: &[f64], weight: f64, time: f64| {
            for (j, right) in integrals.iter().enumerate() {
                for (i, left) in integrals.iter().enumerate() {
                    let product = weight * left * right;
                    steady[(i, j)] += product;
                    moment[(i, j)] += time * product;
                }
            }
        };
        for mode in &self.modes {
            if let Some(shape) = &mode.immediate {
                let gain = shape.contact * shape.contact / shape.rate;
                // Its own depth matters little for the weight; the uniform mode may not decay at all.
                let decay = mode.wave.decay.max(self.depth.height.recip());
                add(&mode.wave.cell_integrals(self.cells), gain / decay, shape.rate.recip());
            }
        }
        for m in self.modes.len().max(1)..SUMMED {
            let wave = self.across.wave(m);
            let impedance = self.depth.steady_impedance(wave.decay);
            add(&wave.cell_integrals(self.cells), impedance / wave.decay, self.time_to_follow(wave.decay));
        }
        // Symmetric and scaled to a unit diagonal; the widths of the cells differ by orders of magnitude.
        let scale: Vec<f64> = (0..count).map(|i| steady[(i, i)].max(f64::MIN_POSITIVE).sqrt().recip()).collect();
        let scaled =
            |matrix: &DMatrix<f64>| DMatrix::from_fn(count, count, |i, j| scale[i] * scale[j] * matrix[(i, j)]);
        let own = SymmetricEigen::new(scaled(&steady));
        let largest = own.eigenvalues.iter().copied().fold(0.0, f64::max);
        let kept: Vec<usize> = (0..count).filter(|&k| own.eigenvalues[k] > SMALLEST * largest).collect();
        let whitened = DMatrix::from_fn(count, kept.len(), |i, k| {
            own.eigenvectors[(i, kept[k])] / own.eigenvalues[kept[k]].sqrt()
        });
        let times = SymmetricEigen::new(whitened.transpose() * scaled(&moment) * &whitened);
        let mut shapes = whitened * times.eigenvectors;
        for (i, mut row) in shapes.row_iter_mut().enumerate() {
            row *= scale[i];
        }
        let integrals = &steady * &shapes;
        let displacements = &operators.distortion_by_flux * &shapes;
        for (k, &time) in times.eigenvalues.iter().enumerate() {
            if time <= 0.0 {
                continue;
            }
            let rate = time.recip();
            let state = operators.rate.len();
            let integrals: Vec<f64> = integrals.column(k).iter().copied().collect();
            operators.rate.push(rate);
            operators.contact.push(rate.sqrt());
            operators.distortion.extend(displacements.column(k).iter().map(|moved| moved * rate.sqrt()));
            for (j, integral) in integrals.iter().enumerate() {
                operators.distortion_by_flux.column_mut(j).axpy(-integral, &displacements.column(k), 1.0);
            }
            // It moves the surface and holds no heat that is not counted already.
            operators.modes.push(ModeStates { states: state..state + 1, integrals, means: Vec::new() });
            operators.uniform.push(0.0);
            operators.stored.push(0.0);
            operators.input.iter_mut().for_each(|input| input.push(0.0));
            for flow in [&mut operators.cooled, &mut operators.ambient_flow, &mut operators.far_flow] {
                flow.states.push(0.0);
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
