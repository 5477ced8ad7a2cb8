//! Unilateral contact on the cells: complementarity problem in pressure and gap, with approach and tilt.
//!
//! Theory: docs/theory.md, section 6.6.

mod active_set;
mod balance;
mod fallback;

use super::factors::{Factors, LowRankUpdate};
use super::lemke::Pivoting;
use super::problem::{ContactError, ContactState, Normal, Tilt, WorkCounter};
use balance::Balance;
use elasticity::{Cells, Compliance};
use nalgebra::DMatrix;
use numerics::dense;
use numerics::maximum::maximum;

/// Compliance of the pair of bodies per pressure, `C + s mu S`: friction acts with `s mu p` on the strip and with
/// `-s mu p` on the punch. `signed_friction` is `s mu`, 0 without shear coupling.
pub fn pair_compliance(punch: &Compliance, strip: &Compliance, signed_friction: f64) -> DMatrix<f64> {
    let mut matrix = &punch.normal + &strip.normal;
    if signed_friction != 0.0 {
        matrix += (&strip.shear - &punch.shear) * signed_friction;
    }
    matrix
}

/// Normal compliance C of the pair per pressure, and the displacement S per friction traction `s mu p`: N x N, m/Pa.
pub fn pair_operators(punch: &Compliance, strip: &Compliance) -> (DMatrix<f64>, DMatrix<f64>) {
    (&punch.normal + &strip.normal, &strip.shear - &punch.shear)
}

/// Number of active sets tried before complementary pivoting. Contacts met so far need at most 12.
const ITERATION_LIMIT: usize = 40;

/// One contact problem for the [`ContactSolver`].
#[derive(Clone, Copy, Debug)]
pub struct ContactProblem<'a> {
    /// Gap of the undeformed bodies at zero approach and tilt, N cell means, in m.
    pub gap: &'a [f64],
    /// s mu, which selects the compliance `C + s mu S`.
    pub signed_friction: f64,
    /// Diagonal wear compliance, wear depth per pressure, N values, m/Pa, >= 0.
    pub diagonal: &'a [f64],
    /// Load, approach or spring.
    pub normal: Normal,
    /// Tilt, or the lever of the resultant.
    pub tilt: Tilt,
}

/// Solver of
///
/// ```text
/// gap = g + A p - delta - theta x >= 0,   p >= 0,   p gap = 0,   sum w p = P,   sum w (x - e) p = 0
/// ```
///
/// on N cells, `A = C + s mu S + E + T diag(d)` the compliance (N x N, not symmetric with friction; E an added compliance, d
/// wear, T its operator, the identity unless set), `w` the cell widths (times `r/r_m` on an annulus), P the load per depth,
/// e the lever; or with prescribed approach and tilt.
///
/// Primal-dual active set method (a semismooth Newton method): the equations of the cells assumed in contact are solved
/// exactly, then cells in tension leave the set and cells that penetrate enter it, until the set is unchanged. Newton steps
/// between finitely many sets may cycle, so when a set recurs (or after 40 sets) the problem is passed to Lemke's algorithm
/// with the lexicographic rule, which terminates, see [`lemke`](super::lemke). `w_i A_ij` is positive definite for elastic
/// bodies whose shear coupling is antisymmetric (half-plane, strip), so there it terminates in the solution, which is
/// unique. That does not cover a spring or a prescribed approach together with a lever other than 0: there friction can make
/// the equilibrium unstable, and the result may be [`ContactError::NoEquilibrium`].
///
/// A solution depends on the problem, the matrices and the first active set alone, to the last bit. Factors of the last few
/// compliances and contact sets are cached, so that an unchanged contact set costs one substitution, `2 N^2` operations,
/// also when strokes alternate. No allocation after construction, except in the convenience method [`Self::solve`].
#[derive(Clone, Debug)]
pub struct ContactSolver {
    positions: Vec<f64>,
    weights: Vec<f64>,
    length: f64,
    total_weight: f64,
    factors: Factors,
    /// First active set of [`Self::solve`].
    active: Vec<bool>,
    memory: Memory,
    counter: WorkCounter,
}

/// Workspace: unknowns of an active set, and memory for the sets tried and for pivoting.
#[derive(Clone, Debug, Default)]
struct Memory {
    /// Gap less the prescribed approach and tilt.
    gap: Vec<f64>,
    /// Pressures of the cells in contact, in the order of the cells.
    compact: Vec<f64>,
    pressure: Vec<f64>,
    open_gap: Vec<f64>,
    worn: Vec<f64>,
    set: Vec<bool>,
    next: Vec<bool>,
    tried: Vec<bool>,
    pivoting: Option<Box<Pivoting>>,
    pivoted_matrix: Vec<f64>,
    pivoted_right: Vec<f64>,
    /// Approach at x = 0 and tilt.
    approach: f64,
    tilt: f64,
}

impl Memory {
    fn start(&mut self, problem: &ContactProblem<'_>, balance: &Balance, positions: &[f64], active: &[bool]) {
        self.set.copy_from_slice(active);
        for i in 0..active.len() {
            self.gap[i] = problem.gap[i] - balance.approach - balance.tilt * positions[i];
        }
    }
}

impl ContactSolver {
    /// Solver for a compliance on the cells, all cells in contact at the start.
    pub fn new(cells: &Cells, compliance: DMatrix<f64>) -> Result<Self, ContactError> {
        Self::with_weights(cells, cells.widths(), compliance)
    }

    /// [`Self::new`] with weights of the load integral other than the cell widths, in m (annular contact).
    pub fn with_weights(cells: &Cells, weights: &[f64], compliance: DMatrix<f64>) -> Result<Self, ContactError> {
        let shear = DMatrix::zeros(cells.count(), cells.count());
        Self::with_operators(cells, weights, compliance, shear)
    }

    /// [`Self::with_weights`] with the normal compliance C and the shear coupling S of the pair, N x N, m/Pa, for any
    /// friction; see [`pair_operators`].
    pub(crate) fn with_operators(
        cells: &Cells,
        weights: &[f64],
        normal: DMatrix<f64>,
        shear: DMatrix<f64>,
    ) -> Result<Self, ContactError> {
        let count = cells.count();
        assert_eq!(weights.len(), count, "one weight per cell");
        let memory = Memory {
            gap: vec![0.0; count],
            compact: vec![0.0; count],
            pressure: vec![0.0; count],
            open_gap: vec![0.0; count],
            worn: vec![0.0; count],
            set: vec![true; count],
            next: vec![true; count],
            tried: vec![false; count * ITERATION_LIMIT],
            pivoting: Some(Box::new(Pivoting::new(count))),
            pivoted_matrix: vec![0.0; (count + 2) * (count + 2)],
            pivoted_right: vec![0.0; count + 2],
            approach: 0.0,
            tilt: 0.0,
        };
        Ok(Self {
            positions: cells.centres().to_vec(),
            weights: weights.to_vec(),
            length: cells.half_width(),
            total_weight: weights.iter().sum(),
            factors: Factors::new(cells, weights, normal, shear)?,
            active: vec![true; count],
            memory,
            counter: WorkCounter::default(),
        })
    }

    /// Sets or removes the added compliance E (N x N, m/Pa). Factors are cached for the last ones; no allocation.
    pub(crate) fn set_added_compliance(&mut self, added_compliance: Option<&DMatrix<f64>>) -> Result<(), ContactError> {
        self.factors.set_added_compliance(added_compliance)
    }

    /// Sets or removes a low-rank update that is subtracted from the added compliance; [`Self::set_added_compliance`]
    /// removes it. Factors are cached for every set of acting cells; no allocation.
    pub(crate) fn set_low_rank_update(&mut self, low_rank_update: Option<LowRankUpdate<'_>>) {
        self.factors.set_low_rank_update(low_rank_update);
    }

    /// Sets the operator T (N x N) of the wear `T diag(d) p`, or the identity. Invalidates the cached factors; only the
    /// first operator allocates.
    pub(crate) fn set_operator(&mut self, operator: Option<&DMatrix<f64>>) {
        self.factors.set_operator(operator);
    }

    /// Work counters.
    pub(crate) fn counter(&self) -> WorkCounter {
        WorkCounter { factorisations: self.factors.factorisations, ..self.counter }
    }

    /// Sets the cells that the next [`Self::solve`] initially assumes in contact.
    #[cfg(test)]
    pub(crate) fn set_active(&mut self, active: &[bool]) {
        assert_eq!(active.len(), self.active.len(), "one status per cell");
        self.active.copy_from_slice(active);
    }

    /// `C + s mu S + E`, N x N by columns, m/Pa.
    pub(crate) fn compliance(&mut self, signed_friction: f64) -> &[f64] {
        self.factors.compliance(signed_friction)
    }

    /// `target += (C + s mu S + E) pressure`, N values each.
    pub(crate) fn add_displacement(&mut self, signed_friction: f64, pressure: &[f64], target: &mut [f64]) {
        dense::multiply_add(self.factors.compliance(signed_friction), pressure, target);
    }

    /// `target += S traction`, N values each: displacement by a friction traction without its pressure.
    pub(crate) fn add_shear_displacement(&self, traction: &[f64], target: &mut [f64]) {
        dense::multiply_add(self.factors.shear(), traction, target);
    }

    /// `target += T worn`, N values each.
    pub(crate) fn add_worn(&self, worn: &[f64], target: &mut [f64]) {
        match self.factors.operator() {
            Some(operator) => dense::multiply_add(operator, worn, target),
            None => target.iter_mut().zip(worn).for_each(|(t, w)| *t += w),
        }
    }

    /// Solves for the pressure given the gap of the undeformed bodies at zero approach and tilt (N cell means, in m),
    /// without friction or wear, starting from the last active set.
    ///
    /// A load of 0 gives zero pressure, and the approach of first contact.
    pub fn solve(&mut self, initial_gap: &[f64], normal: Normal, tilt: Tilt) -> Result<ContactState, ContactError> {
        let diagonal = vec![0.0; self.active.len()];
        let mut state = ContactState::new(self.active.len());
        let mut active = std::mem::take(&mut self.active);
        let problem = ContactProblem { gap: initial_gap, signed_friction: 0.0, diagonal: &diagonal, normal, tilt };
        let outcome = self.solve_into(&problem, &mut active, &mut state);
        self.active = active;
        outcome.map(|()| state)
    }

    /// Solves a problem from the initial active set in `active`, and stores the final set there.
    ///
    /// On an error the active set is unchanged and the state unspecified.
    pub(crate) fn solve_into(
        &mut self,
        problem: &ContactProblem<'_>,
        active: &mut [bool],
        state: &mut ContactState,
    ) -> Result<(), ContactError> {
        assert_eq!(problem.gap.len(), self.positions.len(), "one gap per cell");
        assert_eq!(active.len(), self.positions.len(), "one status per cell");
        self.counter.solves += 1;
        let balance = self.balance(problem)?;
        if self.apart(problem, state) {
            return Ok(());
        }
        let mut memory = std::mem::take(&mut self.memory);
        let outcome = self.search(problem, &balance, active, &mut memory);
        if outcome.is_ok() {
            active.copy_from_slice(&memory.set);
            for i in 0..active.len() {
                state.pressure[i] = if active[i] { memory.pressure[i].max(0.0) } else { 0.0 };
                state.gap[i] = if active[i] { 0.0 } else { memory.open_gap[i].max(0.0) };
            }
            (state.approach, state.tilt) = (memory.approach, memory.tilt);
        }
        self.memory = memory;
        outcome
    }

    /// Solves the equations of the cells in `active` whatever the signs of their pressures, N values; returns approach and tilt.
    pub(crate) fn solve_for_set(
        &mut self,
        problem: &ContactProblem<'_>,
        active: &[bool],
        pressure: &mut [f64],
    ) -> Result<(f64, f64), ContactError> {
        let balance = self.balance(problem)?;
        let mut memory = std::mem::take(&mut self.memory);
        memory.start(problem, &balance, &self.positions, active);
        let solved = self.solve_on(problem, &balance, &mut memory).is_some();
        pressure.copy_from_slice(&memory.pressure);
        let place = (memory.approach, memory.tilt);
        self.memory = memory;
        if solved { Ok(place) } else { Err(ContactError::NoEquilibrium) }
    }

    fn search(
        &mut self,
        problem: &ContactProblem<'_>,
        balance: &Balance,
        active: &[bool],
        memory: &mut Memory,
    ) -> Result<(), ContactError> {
        let count = active.len();
        memory.start(problem, balance, &self.positions, active);
        let in_contact = |set: &[bool]| set.iter().filter(|a| **a).count();
        if in_contact(&memory.set) < balance.count() {
            memory.set.fill(true);
        }
        let mut tried = 0;
        while let Some(entry) = self.solve_on(problem, balance, memory) {
            let changed = self.next_active(entry, memory);
            if !changed {
                return Ok(());
            }
            memory.tried[tried * count..(tried + 1) * count].copy_from_slice(&memory.set);
            tried += 1;
            std::mem::swap(&mut memory.set, &mut memory.next);
            let returns = memory.tried[..tried * count].chunks_exact(count).any(|set| set == memory.set);
            if in_contact(&memory.set) < balance.count() || tried >= ITERATION_LIMIT || returns {
                break;
            }
        }
        self.counter.fallbacks += 1;
        self.pivot_active_set(problem, balance, memory)?;
        self.solve_on(problem, balance, memory).map(|_| ()).ok_or(ContactError::NoEquilibrium)
    }

    /// Updates the active set: cells in tension leave, cells that penetrate enter; returns whether it changed. Pressure is
    /// compared with the gap as the displacement `A_ii p_i`.
    fn next_active(&mut self, position: usize, memory: &mut Memory) -> bool {
        let count = self.positions.len();
        let own = &self.factors.entry(position).own;
        let mut largest: f64 = 0.0;
        for i in 0..count {
            memory.worn[i] = own[i] * memory.pressure[i];
            largest = maximum(largest, maximum(memory.worn[i].abs(), memory.open_gap[i].abs()));
        }
        // Pressure and gap of the wrong sign that count as zero, relative to the largest of the solution.
        let tolerance = 1e-12 * largest;
        let mut changed = false;
        for i in 0..count {
            memory.next[i] = if memory.set[i] { memory.worn[i] >= -tolerance } else { memory.open_gap[i] < -tolerance };
            changed |= memory.next[i] != memory.set[i];
        }
        changed
    }
}

#[cfg(test)]
mod tests;
