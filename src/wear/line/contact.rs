//! Contact whose cells wear: the implicit stage equation.

use super::rate::{CellRate, LocalState};
use super::status::Status;
use crate::contact::{ContactError, ContactProblem, ContactSolver, ContactState, Normal, Tilt, WorkCounter};
use crate::elastic::Cells;
use nalgebra::DMatrix;
use std::fmt;

/// Direction of sliding. It decides the side to which friction shifts the pressure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// v > 0: the punch moves in +x over the strip.
    Forward,
    /// v < 0.
    Backward,
}

impl Direction {
    /// s mu for a friction coefficient mu without regularisation.
    pub fn signed_friction(self, friction: f64) -> f64 {
        match self {
            Self::Forward => friction,
            Self::Backward => -friction,
        }
    }
}

/// What acts on the contact at one time.
#[derive(Clone, Debug, PartialEq)]
pub struct Conditions {
    /// s mu, any number: the friction coefficient with the (perhaps regularised) sign of the velocity, 0 without shear
    /// coupling; at rest the last one, whose traction stays.
    pub signed_friction: f64,
    /// Load, approach or spring.
    pub normal: Normal,
    /// Tilt, or the lever of the resultant.
    pub tilt: Tilt,
    /// Depth rate of wear per cell.
    pub rate: CellRate,
}

/// Why a stage has no solution.
#[derive(Clone, Debug, PartialEq)]
pub enum StageError {
    /// The contact problem itself has none.
    Contact(ContactError),
    /// Newton's method did not converge: a shorter step may help.
    NotConverged {
        /// Length of the stage, in s.
        stage: f64,
        /// Iterations done from each of two starting points.
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

const NEWTON_LIMIT: usize = 60;
const NEWTON_TOLERANCE: f64 = 1e-12;
/// Least dp/dt times alpha: a cell at p = 0 with an infinite slope of the rate gets a finite, harmlessly large diagonal.
const LEAST_SLOPE: f64 = 1e-12;

/// Contact line that wears.
///
/// A solution is a function of the matrices, of what is asked and of the [`Status`], to the last bit: the factors kept
/// from earlier solutions only save time. After construction nothing is allocated, except by [`Self::stage`],
/// [`Self::pressure`] and the first [`Self::set_operator`].
#[derive(Clone, Debug)]
pub struct WearingContact {
    cells: Cells,
    weights: Vec<f64>,
    initial_gap: Vec<f64>,
    pub(super) solver: ContactSolver,
    /// Elastic scale of the local displacement, m/Pa.
    alpha: f64,
    status: Status,
    newton_iterations: u64,
    local: Vec<LocalState>,
    slope: Vec<f64>,
    kept: Vec<f64>,
    pub(super) wear: Vec<f64>,
    pub(super) diagonal: Vec<f64>,
    pub(super) gap: Vec<f64>,
    pub(super) set: Vec<bool>,
}

impl WearingContact {
    /// Contact with the normal compliance C and the shear coupling S (strip less punch) of the pair, N x N, m/Pa, see
    /// [`pair_operators`](crate::contact::pair_operators); with the weights of the load integral, the cell widths except
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
        let alpha = normal.diagonal().amax();
        Ok(Self {
            cells: cells.clone(),
            weights: weights.to_vec(),
            initial_gap,
            solver: ContactSolver::with_operators(cells, weights, normal, shear)?,
            alpha,
            status: Status::new(count),
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

    /// Puts an extra compliance (N x N, m/Pa) on top of that of the bodies, as distortion by the heat of the pressure
    /// is, or takes it away. Kept factors go; nothing is allocated.
    pub fn set_extra(&mut self, extra: Option<&DMatrix<f64>>) -> Result<(), ContactError> {
        self.solver.set_extra(extra)
    }

    /// Lets a stage wear the shape by `T tau f(p)` instead of `tau f(p)`, T an N x N matrix: what the strip of a
    /// straight path brings along is worn by all cells ahead. Kept factors go; only the first operator allocates.
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

    /// Compliance per pressure `C + s mu S`, with the extra one, N x N.
    pub fn compliance(&mut self, signed_friction: f64) -> DMatrix<f64> {
        let count = self.cells.count();
        DMatrix::from_column_slice(count, count, self.solver.compliance(signed_friction))
    }

    /// `target += (C + s mu S) pressure`, with the extra compliance, N values each.
    pub fn add_displacement(&mut self, signed_friction: f64, pressure: &[f64], target: &mut [f64]) {
        self.solver.add_displacement(signed_friction, pressure, target);
    }

    /// Work of the contact solver.
    pub fn counter(&self) -> WorkCounter {
        self.solver.counter()
    }

    /// Newton iterations of all stages so far.
    pub fn newton_iterations(&self) -> u64 {
        self.newton_iterations
    }

    /// What the next solution starts from.
    pub fn status(&self) -> &Status {
        &self.status
    }

    /// Restores what the next solution starts from, without allocating.
    pub fn set_status(&mut self, status: &Status) {
        self.status.copy_from(status);
    }

    /// Pressure on the worn shape as it is: a stage of length 0.
    pub fn pressure(&mut self, worn: &[f64], conditions: &Conditions) -> Result<ContactState, StageError> {
        self.stage(worn, 0.0, conditions)
    }

    /// A stage on the unworn gap with the depth `worn` (N values, m) taken off; see [`Self::stage_into`].
    pub fn stage(&mut self, worn: &[f64], tau: f64, conditions: &Conditions) -> Result<ContactState, StageError> {
        assert_eq!(worn.len(), self.cells.count(), "one depth per cell");
        let gap: Vec<f64> = self.initial_gap.iter().zip(worn).map(|(g, w)| g + w).collect();
        let mut state = ContactState::new(worn.len());
        self.stage_into(&gap, tau, conditions, &mut state)?;
        Ok(state)
    }

    /// Pressure `p` for which the shape after a stage is in equilibrium with it:
    ///
    /// ```text
    /// gap = g + tau f(p) + A p - delta - theta x >= 0,   p >= 0,   p gap = 0,   load and moment balance
    /// ```
    ///
    /// `gap` is g, the gap of the undeformed bodies as worn so far (N cell means, m), `tau` the stage length in s, 0 for
    /// the pressure as it is. The depth worn in the stage is `tau f(p)`. On an error the state is unspecified.
    ///
    /// Linear rates (b = 1) take one contact solve with the diagonal `tau f'`. Others take Newton's method in the local
    /// displacement `t = alpha p + tau f<(p)`, f< the terms with exponents below 1, each iteration one contact solve in
    /// `z = (dp/dt) t`, with `dp/dt` from the last iterate; convergence when t changes by less than 1e-12 of its largest
    /// value, from the last pressure or, where that fails, from the elastic one.
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
            for (i, value) in self.diagonal.iter_mut().enumerate() {
                *value = tau * rate.slope(i, 1.0);
            }
            return Ok(self.solve(gap, conditions, conditions.normal, conditions.tilt, state)?);
        }
        let side = stroke(conditions);
        let fresh = self.status.strokes[side].pressure.iter().all(|p| *p == 0.0);
        for restart in [fresh, true] {
            if restart {
                self.elastic(gap, conditions, state)?;
                self.status.strokes[side].pressure.copy_from_slice(&state.pressure);
            }
            if self.newton(gap, tau, conditions, state)? {
                return Ok(());
            }
        }
        self.status.strokes[side].pressure.fill(0.0);
        Err(StageError::NotConverged { stage: tau, iterations: NEWTON_LIMIT })
    }

    /// Contact without wear.
    fn elastic(&mut self, gap: &[f64], conditions: &Conditions, state: &mut ContactState) -> Result<(), StageError> {
        self.diagonal.fill(0.0);
        Ok(self.solve(gap, conditions, conditions.normal, conditions.tilt, state)?)
    }

    /// Contact with the wear diagonal.
    fn solve(
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

    /// Newton's method from the status's pressure; `false` where it does not converge from there.
    fn newton(
        &mut self,
        gap: &[f64],
        tau: f64,
        conditions: &Conditions,
        state: &mut ContactState,
    ) -> Result<bool, StageError> {
        let (count, side) = (gap.len(), stroke(conditions));
        let (rate, alpha) = (&conditions.rate, self.alpha);
        let mut linearised_gap = std::mem::take(&mut self.gap);
        let mut converged = Ok(false);
        for _ in 0..NEWTON_LIMIT {
            self.newton_iterations += 1;
            for i in 0..count {
                let local = rate.local(i, alpha, tau, self.status.strokes[side].pressure[i]);
                let slope = local.pressure_slope.max(LEAST_SLOPE / alpha);
                // p = kept + z and tau f = kept wear + diagonal z in the linearisation, z = slope t.
                self.kept[i] = local.pressure - slope * local.displacement;
                self.diagonal[i] = local.wear_slope / slope;
                self.wear[i] = local.wear - local.wear_slope * local.displacement;
                self.slope[i] = slope;
                self.local[i] = local;
            }
            linearised_gap.copy_from_slice(gap);
            self.solver.add_worn(&self.wear, &mut linearised_gap);
            self.solver.add_displacement(conditions.signed_friction, &self.kept, &mut linearised_gap);
            let (normal, tilt) = without(&self.kept, &self.weights, self.cells.centres(), conditions);
            if matches!(normal, Normal::Load(load) if load < 0.0) {
                break;
            }
            if let Err(error) = self.solve(&linearised_gap, conditions, normal, tilt, state) {
                converged = Err(error.into());
                break;
            }
            let (mut largest, mut change): (f64, f64) = (0.0, 0.0);
            for i in 0..count {
                let t = state.pressure[i] / self.slope[i];
                largest = largest.max(t);
                change = change.max((t - self.local[i].displacement).abs());
                state.pressure[i] = rate.invert(i, alpha, tau, t);
            }
            self.status.strokes[side].pressure.copy_from_slice(&state.pressure);
            if change <= NEWTON_TOLERANCE * largest {
                converged = Ok(true);
                break;
            }
        }
        self.gap = linearised_gap;
        converged
    }
}

/// Which stroke's status conditions belong to.
fn stroke(conditions: &Conditions) -> usize {
    usize::from(conditions.signed_friction < 0.0)
}

/// Load and moment balance of what is left when the pressure `kept` is taken out.
fn without(kept: &[f64], weights: &[f64], centres: &[f64], conditions: &Conditions) -> (Normal, Tilt) {
    let sum = |lever: f64, order: i32| -> f64 {
        (0..weights.len()).map(|i| weights[i] * kept[i] * (centres[i] - lever).powi(order)).sum()
    };
    let normal = match conditions.normal {
        Normal::Load(load) => Normal::Load(load - sum(0.0, 0)),
        Normal::Spring { load, stiffness } => Normal::Spring { load: load - sum(0.0, 0), stiffness },
        Normal::Approach(approach) => Normal::Approach(approach),
    };
    let tilt = match conditions.tilt {
        Tilt::Fixed(tilt) => Tilt::Fixed(tilt),
        Tilt::ResultantAt(lever) => Tilt::Moment { lever, moment: -sum(lever, 1) },
        Tilt::Moment { lever, moment } => Tilt::Moment { lever, moment: moment - sum(lever, 1) },
    };
    (normal, tilt)
}
