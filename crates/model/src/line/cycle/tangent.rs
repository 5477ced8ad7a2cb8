//! Wear Jacobian of a cycle: derivative of the wear with respect to the gap.
//!
//! At frozen temperatures, a change `dg` of the gap changes the pressure of a half-stroke by `K dg`, where K is the response of
//! the cells in contact under the equilibrium of the holder. The wear of a cycle changes by `-J dg`,
//!
//! ```text
//! J = - sum over the half-strokes of (duration) diag(df/dp) K
//! ```
//!
//! Theory: docs/theory.md, section 9.5.

use crate::StepFailure;
use crate::line::Line;
use contact::{Normal, Tilt};
use nalgebra::{DMatrix, DVector, Dyn, LU};
use numerics::factorization;

/// Wear Jacobian J of both bodies, and the cells in contact in either half-stroke.
#[derive(Clone, Debug)]
pub(crate) struct WearJacobian {
    /// Punch and strip; dimensionless.
    bodies: [DMatrix<f64>; 2],
    pub(super) touching: Vec<bool>,
    /// Regularisation of cells that are never in contact: their wear per gap, dimensionless.
    least: f64,
    rotates: bool,
}

impl WearJacobian {
    pub(crate) fn new(count: usize) -> WearJacobian {
        let zeros = || DMatrix::zeros(count, count);
        WearJacobian { bodies: [zeros(), zeros()], touching: Vec::new(), least: 0.0, rotates: false }
    }

    /// Adds a half-stroke of `duration` (s), at whose end the line is.
    pub(crate) fn add(&mut self, line: &mut Line, duration: f64) -> Result<(), StepFailure> {
        let operators = line.operators.clone();
        let count = operators.count();
        let conditions = &line.stages.conditions;
        let contact = match &mut line.heat {
            Some(heat) => &mut heat.contacts[1],
            None => &mut line.stages.contact,
        };
        let compliance = contact.compliance(conditions.signed_friction);
        let pressure = &line.state.pressure;
        let active: Vec<usize> = (0..count).filter(|&i| pressure[i] > 0.0).collect();
        self.touching.extend(pressure.iter().map(|p| *p > 0.0));
        let lever = match conditions.tilt {
            Tilt::Fixed(_) => None,
            Tilt::ResultantAt(lever) | Tilt::Moment { lever, .. } => Some(lever),
        };
        self.rotates = lever.is_some();
        let stiffness = match conditions.normal {
            Normal::Spring { stiffness, .. } => stiffness,
            _ => 0.0,
        };
        let (m, x, weights) = (active.len(), operators.cells.centres(), &operators.weights);
        let free = 1 + usize::from(lever.is_some());
        let scale = compliance.diagonal().amax();
        let mut system = DMatrix::zeros(m + free, m + free);
        for (a, &i) in active.iter().enumerate() {
            for (b, &j) in active.iter().enumerate() {
                system[(a, b)] = compliance[(i, j)] / scale;
            }
            system[(a, m)] = -1.0;
            system[(m, a)] = weights[i];
            if let Some(lever) = lever {
                system[(a, m + 1)] = -x[i] / operators.cells.half_width();
                system[(m + 1, a)] = weights[i] * (x[i] - lever) / operators.cells.half_width();
            }
        }
        // Displacements are in units of the scale, so the load of a spring is its stiffness times the scale.
        system[(m, m)] = stiffness * scale;
        let inverse = factorization::inverse(system).map_err(|reason| {
            StepFailure(format!("cycle: the {m} cells in contact do not determine the pressure: {reason}"))
        })?;
        for body in 0..2 {
            if !operators.reshapes(body) {
                continue;
            }
            let law = &operators.wear[body].0;
            for (a, &i) in active.iter().enumerate() {
                let relative = law.logarithmic_slope(pressure[i]);
                let slope = duration * relative * line.stages.rates[1][body][i] / pressure[i] / scale;
                for (b, &j) in active.iter().enumerate() {
                    self.bodies[body][(i, j)] += slope * inverse[(a, b)];
                }
                self.least = self.least.max(slope);
            }
        }
        Ok(())
    }

    fn total(&self) -> DMatrix<f64> {
        let mut total = &self.bodies[0] + &self.bodies[1];
        for i in 0..total.nrows() {
            if total[(i, i)] <= 0.0 {
                total[(i, i)] = self.least;
            }
        }
        total
    }

    /// Wear per gap of a cell that is never in contact, in [`Self::implicit`] and [`Self::steady`]; dimensionless.
    pub(crate) fn least(&self) -> f64 {
        self.least
    }

    /// Number of rigid motions that the holder permits.
    pub(crate) fn balances(&self) -> usize {
        1 + usize::from(self.rotates)
    }

    /// Change of the wear `-J dg` of a body.
    pub(crate) fn wear_by_gap(&self, body: usize, gap: &DVector<f64>) -> DVector<f64> {
        -(&self.bodies[body] * gap)
    }

    /// Factors of `I + h J`.
    ///
    /// # Errors
    /// A wear Jacobian that is not finite.
    pub(crate) fn implicit(&self, jump: f64) -> Result<LU<f64, Dyn, Dyn>, StepFailure> {
        let total = self.total();
        factors(DMatrix::identity(total.nrows(), total.nrows()) + total * jump)
    }

    /// Factors of `J g + lambda0 (+ lambda1 x) = r`, g without a rigid motion: lambda follows the unknowns, its constraints
    /// follow r.
    ///
    /// # Errors
    /// A wear Jacobian that is not finite.
    pub(crate) fn steady(&self, x: &[f64], widths: &[f64]) -> Result<LU<f64, Dyn, Dyn>, StepFailure> {
        let total = self.total();
        let (count, free) = (total.nrows(), self.balances());
        let half_width = 0.5 * widths.iter().sum::<f64>();
        let scale = total.diagonal().amax();
        let mut system = DMatrix::zeros(count + free, count + free);
        system.view_mut((0, 0), (count, count)).copy_from(&total);
        for i in 0..count {
            for k in 0..free {
                let shift = if k == 0 { 1.0 } else { x[i] / half_width };
                system[(i, count + k)] = scale * shift;
                system[(count + k, i)] = scale * shift * widths[i] / half_width;
            }
        }
        factors(system)
    }
}

fn factors(system: DMatrix<f64>) -> Result<LU<f64, Dyn, Dyn>, StepFailure> {
    factorization::lu(system).map_err(|reason| StepFailure(format!("cycle: the wear by the gap is unknown: {reason}")))
}
