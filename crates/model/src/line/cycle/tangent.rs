//! How the wear of a cycle follows the gap, and what solves with it.
//!
//! With the temperatures held, a change `dg` of the gap changes the pressure of a half-stroke by `K dg`, where K is the
//! response of the cells in contact under the balance of the holder. The wear of a cycle changes by `-J dg`,
//!
//! ```text
//! J = - sum over the half-strokes of (duration) diag(df/dp) K
//! ```

use crate::StepFailure;
use crate::line::Line;
use contact::{Normal, Tilt};
use nalgebra::{DMatrix, DVector, Dyn, LU};
use numerics::factorization;

/// J of both bodies, and the cells in contact in either half-stroke.
#[derive(Clone, Debug)]
pub struct Tangent {
    /// Punch and strip; dimensionless.
    bodies: [DMatrix<f64>; 2],
    pub(super) touching: Vec<bool>,
    /// A cell that never touches is moved towards contact as if it wore like this per gap.
    least: f64,
    rotates: bool,
}

impl Tangent {
    pub fn new(count: usize) -> Tangent {
        let zeros = || DMatrix::zeros(count, count);
        Tangent { bodies: [zeros(), zeros()], touching: Vec::new(), least: 0.0, rotates: false }
    }

    /// Adds a half-stroke of `duration` (s) that the line has just finished.
    pub fn add(&mut self, line: &mut Line, duration: f64) -> Result<(), StepFailure> {
        let operators = line.operators.clone();
        let count = operators.count();
        let conditions = &line.conditions;
        let contact = match &mut line.heat {
            Some(heat) => &mut heat.contacts[1],
            None => &mut line.contact,
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
        // Displacements in units of the scale: a spring gives way by its stiffness times them.
        system[(m, m)] = stiffness * scale;
        let inverse = factorization::inverse(system).map_err(|reason| {
            StepFailure(format!("cycle: the {m} cells in contact do not determine the pressure: {reason}"))
        })?;
        for body in 0..2 {
            if !operators.reshapes(body) {
                continue;
            }
            let exponent = operators.wear[body].0.pressure_exponent;
            for (a, &i) in active.iter().enumerate() {
                let slope = duration * exponent * line.work.rates[1][body][i] / pressure[i] / scale;
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

    /// What a cell that never touches wears per gap in [`Self::implicit`] and [`Self::steady`], dimensionless.
    pub fn least(&self) -> f64 {
        self.least
    }

    /// Number of rigid motions that the holder leaves free.
    pub fn balances(&self) -> usize {
        1 + usize::from(self.rotates)
    }

    /// `-J dg` of a body.
    pub fn wear_by_gap(&self, body: usize, gap: &DVector<f64>) -> DVector<f64> {
        -(&self.bodies[body] * gap)
    }

    /// Solver of `(I + h J) g = r`.
    ///
    /// # Errors
    /// A wear Jacobian that is not finite.
    pub fn implicit(&self, jump: f64) -> Result<LU<f64, Dyn, Dyn>, StepFailure> {
        let total = self.total();
        factors(DMatrix::identity(total.nrows(), total.nrows()) + total * jump)
    }

    /// Solver of `J g + lambda0 (+ lambda1 x) = r`, g without a rigid motion: the unknowns and r are followed by lambda.
    ///
    /// # Errors
    /// A wear Jacobian that is not finite.
    pub fn steady(&self, x: &[f64], widths: &[f64]) -> Result<LU<f64, Dyn, Dyn>, StepFailure> {
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
