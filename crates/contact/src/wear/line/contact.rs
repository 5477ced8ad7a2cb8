//! Contact with wearing cells: the implicit stage equation.
//!
//! Theory: docs/theory.md, sections 6.1, 6.7.

use super::rate::{CellRate, LocalState};
use super::warm_start::WarmStart;
use crate::{ContactError, ContactProblem, ContactSolver, ContactState, LowRankUpdate, Normal, Tilt, WorkCounter};
use elasticity::Cells;
use nalgebra::DMatrix;
use std::fmt;

/// Direction of sliding. It determines the side to which friction shifts the pressure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// v > 0: the punch moves in +x over the strip.
    Forward,
    /// v < 0: the punch moves in -x over the strip.
    Backward,
}

impl Direction {
    /// Signed friction s mu for a friction coefficient mu without regularisation.
    pub fn signed_friction(self, friction: f64) -> f64 {
        match self {
            Self::Forward => friction,
            Self::Backward => -friction,
        }
    }
}

/// Conditions of the contact at one time.
#[derive(Clone, Debug, PartialEq)]
pub struct Conditions {
    /// s mu, any number: the friction coefficient with the (possibly regularised) sign of the velocity, 0 without shear
    /// coupling; at rest the last value, because the traction persists.
    pub signed_friction: f64,
    /// Load, approach or spring.
    pub normal: Normal,
    /// Tilt, or the lever of the resultant.
    pub tilt: Tilt,
    /// Depth rate of wear per cell.
    pub rate: CellRate,
}

/// Reason why a stage has no solution.
#[derive(Clone, Debug, PartialEq)]
pub enum StageError {
    /// The contact problem itself has no solution.
    Contact(ContactError),
    /// Newton's method did not converge: a shorter step may.
    NotConverged {
        /// Length of the stage, in s.
        stage: f64,
        /// Number of iterations from each of two starting points.
        iterations: usize,
    },
}

impl From<ContactError> for StageError {
    fn from(error: ContactError) -> Self {
        Self::Contact(error)
    }
}

impl fmt::Display for StageError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Contact(error) => error.fmt(f),
            Self::NotConverged { stage, iterations } => {
                write!(f, "wear stage of {stage:e} s not converged in {iterations} Newton iterations")
            }
        }
    }
}

impl std::error::Error for StageError {}

/// Contact line with wearing cells.
///
/// A solution is a function of the matrices, of the stage problem and of the [`WarmStart`], to the last bit: cached factors
/// only save time. No allocation after construction, except in [`Self::stage`], [`Self::pressure`] and the first
/// [`Self::set_operator`].
#[derive(Clone, Debug)]
pub struct WearingContact {
    pub(super) cells: Cells,
    pub(super) weights: Vec<f64>,
    initial_gap: Vec<f64>,
    pub(super) solver: ContactSolver,
    /// Elastic scale of the local displacement, m/Pa.
    pub(super) alpha: f64,
    /// Elastic scale of the local displacement of every cell, m/Pa.
    pub(super) own_compliance: Vec<f64>,
    pub(super) status: WarmStart,
    pub(super) newton_iterations: u64,
    pub(super) local: Vec<LocalState>,
    pub(super) slope: Vec<f64>,
    pub(super) kept: Vec<f64>,
    pub(super) wear: Vec<f64>,
    pub(super) diagonal: Vec<f64>,
    pub(super) gap: Vec<f64>,
    pub(super) set: Vec<bool>,
}

impl WearingContact {
    /// Contact with the normal compliance C and the shear coupling S (strip less punch) of the pair, N x N, m/Pa, see
    /// [`pair_operators`](crate::pair_operators); with the weights of the load integral, the cell widths except
    /// on an annulus, in m; and with the gap of the unworn bodies (N cell means, m).
    pub fn new(
        cells: &Cells,
        weights: &[f64],
        normal: DMatrix<f64>,
        shear: DMatrix<f64>,
        initial_gap: Vec<f64>,
    ) -> Result<Self, ContactError> {
        let count = cells.count();
        assert_eq!(initial_gap.len(), count, "one gap per cell");
        let own_compliance = normal.diagonal().as_slice().to_vec();
        Ok(Self {
            cells: cells.clone(),
            weights: weights.to_vec(),
            initial_gap,
            solver: ContactSolver::with_operators(cells, weights, normal, shear)?,
            alpha: own_compliance.iter().copied().fold(0.0, f64::max),
            own_compliance,
            status: WarmStart::new(count),
            newton_iterations: 0,
            local: vec![LocalState::default(); count],
            slope: vec![0.0; count],
            kept: vec![0.0; count],
            wear: vec![0.0; count],
            diagonal: vec![0.0; count],
            gap: vec![0.0; count],
            set: vec![true; count],
        })
    }

    /// Sets or removes the low-rank update that is subtracted from the added compliance; [`Self::set_added_compliance`]
    /// removes it.
    pub fn set_low_rank_update(&mut self, low_rank_update: Option<LowRankUpdate<'_>>) {
        self.solver.set_low_rank_update(low_rank_update);
    }

    /// Sets or removes an added compliance (N x N, m/Pa) on top of that of the bodies, such as the thermal compliance:
    /// distortion by the friction heat of the pressure. Factors are cached for the last ones; no allocation.
    pub fn set_added_compliance(&mut self, added_compliance: Option<&DMatrix<f64>>) -> Result<(), ContactError> {
        self.solver.set_added_compliance(added_compliance)
    }

    /// Sets the wear operator: a stage wears the shape by `T tau f(p)` instead of `tau f(p)`, T an N x N matrix, because
    /// material of a straight strip is worn by all cells that it passes. Invalidates the cached factors; only the first
    /// operator allocates.
    pub fn set_operator(&mut self, operator: Option<&DMatrix<f64>>) {
        self.solver.set_operator(operator);
    }

    /// The cells.
    pub fn cells(&self) -> &Cells {
        &self.cells
    }

    /// Weights of the load integral, in m.
    pub fn weights(&self) -> &[f64] {
        &self.weights
    }

    /// Gap of the unworn bodies, N cell means, in m.
    pub fn initial_gap(&self) -> &[f64] {
        &self.initial_gap
    }

    /// Compliance per pressure `C + s mu S` with the added compliance, N x N.
    pub fn compliance(&mut self, signed_friction: f64) -> DMatrix<f64> {
        let count = self.cells.count();
        DMatrix::from_column_slice(count, count, self.solver.compliance(signed_friction))
    }

    /// [`Self::compliance`] by columns, without allocating.
    pub fn compliance_values(&mut self, signed_friction: f64) -> &[f64] {
        self.solver.compliance(signed_friction)
    }

    /// `target += S traction`, N values each: displacement by a friction traction without its pressure.
    pub fn add_shear_displacement(&self, traction: &[f64], target: &mut [f64]) {
        self.solver.add_shear_displacement(traction, target);
    }

    /// Work counters of the contact solver.
    pub fn counter(&self) -> WorkCounter {
        self.solver.counter()
    }

    /// Newton iterations of all stages so far.
    pub fn newton_iterations(&self) -> u64 {
        self.newton_iterations
    }

    /// Warm start of the next solution.
    pub fn status(&self) -> &WarmStart {
        &self.status
    }

    /// Restores the warm start of the next solution, without allocating.
    pub fn set_status(&mut self, status: &WarmStart) {
        self.status.copy_from(status);
    }

    /// Pressure on the present worn shape: a stage of length 0.
    pub fn pressure(&mut self, worn: &[f64], conditions: &Conditions) -> Result<ContactState, StageError> {
        self.stage(worn, 0.0, conditions)
    }

    /// Stage on the unworn gap plus the depth `worn` (N values, m); see [`Self::stage_into`].
    pub fn stage(&mut self, worn: &[f64], tau: f64, conditions: &Conditions) -> Result<ContactState, StageError> {
        assert_eq!(worn.len(), self.cells.count(), "one depth per cell");
        let gap: Vec<f64> = self.initial_gap.iter().zip(worn).map(|(g, w)| g + w).collect();
        let mut state = ContactState::new(worn.len());
        self.stage_into(&gap, tau, conditions, &mut state)?;
        Ok(state)
    }

    /// Pressure `p` in equilibrium with the shape after a stage:
    ///
    /// ```text
    /// gap = g + tau f(p) + A p - delta - theta x >= 0,   p >= 0,   p gap = 0,   load and moment balance
    /// ```
    ///
    /// `gap` is g, the gap of the undeformed bodies as worn so far (N cell means, m), `tau` the stage length in s, 0 for the
    /// pressure on the present shape. The depth worn in the stage is `tau f(p)`. On an error the state is unspecified.
    ///
    /// Linear rates (b = 1) need one contact solve with the diagonal `tau f'`. Others are solved by Newton's method, see
    /// `newton.rs`: with a frozen Jacobian (chord iteration), and where that does not converge with a new factorisation at
    /// every iteration.
    pub fn stage_into(
        &mut self,
        gap: &[f64],
        tau: f64,
        conditions: &Conditions,
        state: &mut ContactState,
    ) -> Result<(), StageError> {
        assert_eq!(gap.len(), self.cells.count(), "one gap per cell");
        let rate = &conditions.rate;
        if tau == 0.0 || rate.terms.iter().all(|term| term.coefficient.is_zero()) {
            return self.elastic(gap, conditions, state);
        }
        if rate.is_linear() {
            if rate.is_uniform() {
                self.diagonal.fill(tau * rate.slope(0, 1.0));
            } else {
                for (i, value) in self.diagonal.iter_mut().enumerate() {
                    *value = tau * rate.slope(i, 1.0);
                }
            }
            return Ok(self.solve(gap, conditions, conditions.normal, conditions.tilt, state)?);
        }
        self.nonlinear(gap, tau, conditions, state)
    }

    /// Contact without wear.
    pub(super) fn elastic(
        &mut self,
        gap: &[f64],
        conditions: &Conditions,
        state: &mut ContactState,
    ) -> Result<(), StageError> {
        self.diagonal.fill(0.0);
        Ok(self.solve(gap, conditions, conditions.normal, conditions.tilt, state)?)
    }

    /// Contact solve with the wear diagonal.
    pub(super) fn solve(
        &mut self,
        gap: &[f64],
        conditions: &Conditions,
        normal: Normal,
        tilt: Tilt,
        state: &mut ContactState,
    ) -> Result<(), ContactError> {
        let problem =
            ContactProblem { gap, signed_friction: conditions.signed_friction, diagonal: &self.diagonal, normal, tilt };
        self.solver.solve_into(&problem, &mut self.status.strokes[stroke(conditions)].active, state)
    }
}

/// Index of the stroke in the status to which the conditions belong.
pub(super) fn stroke(conditions: &Conditions) -> usize {
    usize::from(conditions.signed_friction < 0.0)
}
