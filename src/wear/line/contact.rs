//! Contact whose cells wear: the implicit stage equation.

use super::rate::{CellRate, LocalState};
use crate::contact::{ContactError, ContactSolver, ContactState, Normal, Tilt, WorkCounter};
use crate::elastic::Cells;
use nalgebra::{DMatrix, DVector};
use std::fmt;

/// Direction of sliding. It decides the side to which friction shifts the pressure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// v > 0: the punch moves in +x over the strip.
    Forward,
    /// v < 0.
    Backward,
}

/// What acts on the contact at one time.
#[derive(Clone, Debug, PartialEq)]
pub struct Conditions {
    /// Direction of sliding; at rest the last one, whose friction stays.
    pub direction: Direction,
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

/// Contact line that wears, one solver per direction of sliding.
#[derive(Clone, Debug)]
pub struct WearingContact {
    cells: Cells,
    weights: Vec<f64>,
    initial_gap: Vec<f64>,
    branches: [Branch; 2],
    /// Worn depth of the cells per `tau f`; none: the identity.
    operator: Option<DMatrix<f64>>,
    newton_iterations: u64,
}

#[derive(Clone, Debug)]
struct Branch {
    compliance: DMatrix<f64>,
    /// Elastic scale of the local displacement, m/Pa.
    alpha: f64,
    /// Contact without a wear diagonal, so that asking for the pressure leaves the other's factorisation alone.
    elastic: ContactSolver,
    /// Contact with the wear diagonal of the last stage.
    solver: ContactSolver,
    diagonal: Vec<f64>,
    /// Pressure of the last stage, where the next Newton iteration starts.
    pressure: Vec<f64>,
}

impl WearingContact {
    /// Contact of the given compliance forward (`C + mu S`) and backward (`C - mu S`), N x N, with the gap of the
    /// unworn bodies (N cell means, m).
    pub fn new(
        cells: &Cells,
        forward: DMatrix<f64>,
        backward: DMatrix<f64>,
        initial_gap: Vec<f64>,
    ) -> Result<Self, ContactError> {
        Self::with_weights(cells, cells.widths(), forward, backward, initial_gap)
    }

    /// The same with weights of the load integral other than the cell widths (annular contact), in m.
    pub fn with_weights(
        cells: &Cells,
        weights: &[f64],
        forward: DMatrix<f64>,
        backward: DMatrix<f64>,
        initial_gap: Vec<f64>,
    ) -> Result<Self, ContactError> {
        assert_eq!(initial_gap.len(), cells.count(), "one gap per cell");
        let branch = |compliance: DMatrix<f64>| {
            let solver = ContactSolver::with_weights(cells, weights, compliance.clone())?;
            let (alpha, count) = (compliance.diagonal().amax(), cells.count());
            let pressure = vec![0.0; count];
            let elastic = solver.clone();
            Ok(Branch { compliance, alpha, elastic, solver, diagonal: vec![0.0; count], pressure })
        };
        Ok(Self {
            cells: cells.clone(),
            weights: weights.to_vec(),
            initial_gap,
            branches: [branch(forward)?, branch(backward)?],
            operator: None,
            newton_iterations: 0,
        })
    }

    /// Lets a stage wear the shape by `T tau f(p)` instead of `tau f(p)`, T an N x N matrix: what the strip of a
    /// straight path brings along is worn by all cells ahead.
    pub fn with_operator(mut self, operator: DMatrix<f64>) -> Self {
        assert_eq!(operator.shape(), (self.cells.count(), self.cells.count()), "the operator is N x N");
        self.operator = Some(operator);
        self
    }

    /// The cells.
    pub fn cells(&self) -> &Cells {
        &self.cells
    }

    /// Weights of the load integral, in m.
    pub fn weights(&self) -> &[f64] {
        &self.weights
    }

    /// Compliance per pressure while sliding in a direction.
    pub fn compliance(&self, direction: Direction) -> &DMatrix<f64> {
        &self.branches[direction as usize].compliance
    }

    /// Work of all contact solvers.
    pub fn counter(&self) -> WorkCounter {
        self.branches
            .iter()
            .flat_map(|branch| [branch.elastic.counter(), branch.solver.counter()])
            .fold(WorkCounter::default(), |sum, counter| sum + counter)
    }

    /// Newton iterations of all stages so far.
    pub fn newton_iterations(&self) -> u64 {
        self.newton_iterations
    }

    /// Pressure on the worn shape as it is: a stage of length 0.
    pub fn pressure(&mut self, worn: &[f64], conditions: &Conditions) -> Result<ContactState, StageError> {
        self.stage(worn, 0.0, conditions)
    }

    /// Pressure `p` for which the shape after a stage is in equilibrium with it:
    ///
    /// ```text
    /// gap = g0 + w + tau f(p) + A p - delta - theta x >= 0,   p >= 0,   p gap = 0,   load and moment balance
    /// ```
    ///
    /// `worn` is w (N values, m), `tau` the stage length in s. The depth worn in the stage is `tau f(p)`.
    ///
    /// Linear rates (b = 1) take one contact solve with the diagonal `tau f'`. Others take Newton's method in the local
    /// displacement `t = alpha p + tau f<(p)`, f< the terms with exponents below 1, each iteration one contact solve in
    /// `z = (dp/dt) t`, with `dp/dt` from the last iterate; convergence when t changes by less than 1e-12 of its largest
    /// value, from the last pressure or, where that fails, from the elastic one.
    pub fn stage(&mut self, worn: &[f64], tau: f64, conditions: &Conditions) -> Result<ContactState, StageError> {
        let count = self.cells.count();
        assert_eq!(worn.len(), count, "one depth per cell");
        let branch = &mut self.branches[conditions.direction as usize];
        let rate = &conditions.rate;
        let gap: Vec<f64> = self.initial_gap.iter().zip(worn).map(|(g, w)| g + w).collect();
        if tau == 0.0 {
            return Ok(branch.elastic.solve(&gap, conditions.normal, conditions.tilt)?);
        }
        if rate.is_linear() {
            branch.set_diagonal((0..count).map(|i| tau * rate.slope(i, 1.0)).collect(), self.operator.as_ref())?;
            return Ok(branch.solver.solve(&gap, conditions.normal, conditions.tilt)?);
        }
        let fresh = branch.pressure.iter().all(|p| *p == 0.0);
        for restart in [fresh, true] {
            if restart {
                let branch = &mut self.branches[conditions.direction as usize];
                branch.pressure = branch.elastic.solve(&gap, conditions.normal, conditions.tilt)?.pressure;
            }
            if let Some(state) = self.newton(&gap, tau, conditions)? {
                return Ok(state);
            }
        }
        self.branches[conditions.direction as usize].pressure.fill(0.0);
        Err(StageError::NotConverged { stage: tau, iterations: NEWTON_LIMIT })
    }

    /// Newton's method from the branch's pressure; `None` where it does not converge from there.
    fn newton(&mut self, gap: &[f64], tau: f64, conditions: &Conditions) -> Result<Option<ContactState>, StageError> {
        let count = gap.len();
        let branch = &mut self.branches[conditions.direction as usize];
        let (rate, alpha) = (&conditions.rate, branch.alpha);
        for _ in 0..NEWTON_LIMIT {
            self.newton_iterations += 1;
            let local: Vec<LocalState> = (0..count).map(|i| rate.local(i, alpha, tau, branch.pressure[i])).collect();
            let slope: Vec<f64> = local.iter().map(|l| l.pressure_slope.max(LEAST_SLOPE / alpha)).collect();
            // p = kept + z and tau f = kept wear + diagonal z in the linearisation, z = slope t.
            let kept = DVector::from_fn(count, |i, _| local[i].pressure - slope[i] * local[i].displacement);
            let diagonal = (0..count).map(|i| local[i].wear_slope / slope[i]).collect();
            branch.set_diagonal(diagonal, self.operator.as_ref())?;
            let worn = |l: &LocalState| l.wear - l.wear_slope * l.displacement;
            let mut shape = DVector::from_iterator(count, local.iter().map(worn));
            if let Some(operator) = &self.operator {
                shape = operator * shape;
            }
            shape.gemv(1.0, &branch.compliance, &kept, 1.0);
            let linearised_gap: Vec<f64> = gap.iter().zip(&shape).map(|(g, s)| g + s).collect();
            let (normal, tilt) = without(&kept, &self.weights, self.cells.centres(), conditions);
            if matches!(normal, Normal::Load(load) if load < 0.0) {
                return Ok(None);
            }
            let state = branch.solver.solve(&linearised_gap, normal, tilt)?;
            let (mut largest, mut change): (f64, f64) = (0.0, 0.0);
            for i in 0..count {
                let t = state.pressure[i] / slope[i];
                largest = largest.max(t);
                change = change.max((t - local[i].displacement).abs());
                branch.pressure[i] = rate.invert(i, alpha, tau, t);
            }
            if change <= NEWTON_TOLERANCE * largest {
                return Ok(Some(ContactState { pressure: branch.pressure.clone(), ..state }));
            }
        }
        Ok(None)
    }
}

impl Branch {
    /// Puts wear per pressure, a diagonal or `T diagonal`, into the solver's matrix, unless it is there already.
    fn set_diagonal(&mut self, diagonal: Vec<f64>, operator: Option<&DMatrix<f64>>) -> Result<(), ContactError> {
        if diagonal != self.diagonal {
            let mut matrix = self.compliance.clone();
            for (j, value) in diagonal.iter().enumerate() {
                match operator {
                    None => matrix[(j, j)] += value,
                    Some(operator) => matrix.column_mut(j).axpy(*value, &operator.column(j), 1.0),
                }
            }
            self.solver.set_compliance(matrix)?;
            self.diagonal = diagonal;
        }
        Ok(())
    }
}

/// Load and moment balance of what is left when the pressure `kept` is taken out.
fn without(kept: &DVector<f64>, weights: &[f64], centres: &[f64], conditions: &Conditions) -> (Normal, Tilt) {
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
