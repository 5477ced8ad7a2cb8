//! Newton's method for stages whose depth rate is not linear in the pressure.
//!
//! In the local displacement `t = alpha p + tau f<(p)`, f< the concave terms of the rate, pressure and wear are Lipschitz
//! continuous for every law, which Newton's method needs where a cell touches down or lifts off. Each iteration is one
//! contact solve in `z = (dp/dt) t` with the wear diagonal `d = tau f'(p)` of the last iterate, and thus one factorisation.
//!
//! Otherwise, where the contact set is unchanged and the slopes differ little from those of an earlier stage, the Jacobian
//! of that stage is kept frozen: the chord iteration (simplified Newton method) solves
//!
//! ```text
//! (A + D) p' - delta - theta x = -(g + tau f(p) - D p)
//! ```
//!
//! with the frozen diagonal D. It converges at a rate of about `|D - tau f'|/(A + D)`, and its error is bounded by the last
//! change and that rate. D is part of the [`WarmStart`](super::WarmStart), so that the result never depends on which factors
//! happen to be cached.
//!
//! Theory: docs/theory.md, section 6.7.

use super::contact::stroke;
use super::{Conditions, StageError, WearingContact};
use crate::{ContactState, Normal, Tilt};
use numerics::maximum::maximum;

/// Iterations of Newton's method after which a stage has no solution and its step is halved.
const NEWTON_LIMIT: usize = 60;
/// Tolerance of Newton's method: the last change relative to the largest local displacement.
const NEWTON_TOLERANCE: f64 = 1e-12;
/// Change, relative to the largest local displacement, below which an iteration that no longer halves it has converged to
/// the rounding of the linear solutions, which with many cells and thermal compliance exceeds the tolerance of Newton's
/// method.
const ROUNDED_CHANGE: f64 = 1e-9;
/// Lower bound of dp/dt times alpha: a cell at p = 0 with an infinite slope of the rate gets a finite, harmlessly large diagonal.
const LEAST_SLOPE: f64 = 1e-12;
/// Limit of chord iterations, after which Newton's method with new factors is used.
const CHORD_LIMIT: usize = 14;
/// Number of chord iterations above which the next stage refactors.
const CHORD_ENOUGH: usize = 6;
/// Validity radius of the frozen diagonal: deviation of the slopes, relative to the cell's own compliance and wear, beyond
/// which the Jacobian is refactored.
const CHORD_DEVIATION: f64 = 0.3;

impl WearingContact {
    /// Solves a stage with a nonlinear rate.
    pub(super) fn nonlinear(
        &mut self,
        gap: &[f64],
        tau: f64,
        conditions: &Conditions,
        state: &mut ContactState,
    ) -> Result<(), StageError> {
        let side = stroke(conditions);
        self.status.strokes[side].started = true;
        let fresh = self.status.strokes[side].pressure.iter().all(|p| *p == 0.0);
        if !fresh && self.chord(gap, tau, conditions, state)? {
            return Ok(());
        }
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

    /// Chord iteration from the pressure of the status with its frozen diagonal; `false` where it does not apply or
    /// converge. The pressure of the status is then unchanged.
    fn chord(
        &mut self,
        gap: &[f64],
        tau: f64,
        conditions: &Conditions,
        state: &mut ContactState,
    ) -> Result<bool, StageError> {
        let (count, side) = (gap.len(), stroke(conditions));
        let concave = conditions.rate.is_concave();
        self.kept.copy_from_slice(&self.status.strokes[side].pressure);
        let deviation = self.slopes_at_iterate(tau, conditions, side);
        let mut refactored = deviation > CHORD_DEVIATION;
        if refactored {
            self.refactor(side);
        }
        let mut linearised_gap = std::mem::take(&mut self.gap);
        let mut last = f64::INFINITY;
        let mut converged = Ok(false);
        for iteration in 1..=CHORD_LIMIT {
            self.newton_iterations += 1;
            for i in 0..count {
                self.diagonal[i] = self.status.strokes[side].diagonal[i];
                self.wear[i] -= self.diagonal[i] * self.kept[i];
            }
            linearised_gap.copy_from_slice(gap);
            self.solver.add_worn(&self.wear, &mut linearised_gap);
            if let Err(error) = self.solve(&linearised_gap, conditions, conditions.normal, conditions.tilt, state) {
                converged = Err(error.into());
                break;
            }
            let (mut largest, mut change): (f64, f64) = (0.0, 0.0);
            let mut touched_down = false;
            for i in 0..count {
                let local = self.own_compliance[i] + self.diagonal[i];
                largest = largest.max(local * state.pressure[i]);
                change = maximum(change, local * (state.pressure[i] - self.kept[i]).abs());
                touched_down |= self.kept[i] == 0.0 && state.pressure[i] > 0.0;
            }
            if touched_down && concave {
                break;
            }
            let ratio = change / last;
            last = change;
            self.kept.copy_from_slice(&state.pressure);
            let deviation = self.slopes_at_iterate(tau, conditions, side);
            let settles = iteration > 1 && ratio < 0.5;
            let error = if settles { change * ratio / (1.0 - ratio) } else { change };
            let close = deviation <= CHORD_DEVIATION;
            if close && error <= NEWTON_TOLERANCE * largest {
                self.status.strokes[side].pressure.copy_from_slice(&state.pressure);
                if iteration > CHORD_ENOUGH {
                    self.refactor(side);
                }
                converged = Ok(true);
                break;
            }
            // Ratio of successive changes beyond which the Jacobian is refactored.
            if !close || (ratio > 0.3 && iteration > 1) {
                if refactored {
                    break;
                }
                refactored = true;
                self.refactor(side);
                last = f64::INFINITY;
            }
        }
        self.gap = linearised_gap;
        converged
    }

    /// Evaluates `tau f` and `tau f'` at the current iterate `kept`, into wear and slope; returns the deviation of the
    /// slopes from the frozen diagonal.
    fn slopes_at_iterate(&mut self, tau: f64, conditions: &Conditions, side: usize) -> f64 {
        let diagonal = &self.status.strokes[side].diagonal;
        let mut deviation: f64 = 0.0;
        for i in 0..self.kept.len() {
            let (rate, slope) = conditions.rate.rate_and_slope(i, self.kept[i]);
            self.wear[i] = tau * rate;
            self.slope[i] = (tau * slope).min(self.alpha / LEAST_SLOPE);
            // A cell that touches down under a rate with an infinite slope ends the chord iteration in any case.
            if self.kept[i] > 0.0 || slope.is_finite() {
                let scale = self.own_compliance[i] + self.slope[i].min(diagonal[i]);
                deviation = maximum(deviation, (self.slope[i] - diagonal[i]).abs() / scale);
            }
        }
        deviation
    }

    /// Replaces the frozen diagonal by the current slopes.
    fn refactor(&mut self, side: usize) {
        self.status.strokes[side].diagonal.copy_from_slice(&self.slope);
    }

    /// Newton's method with a new factorisation at every iteration, from the pressure of the status; `false` where it does
    /// not converge from there.
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
        let mut last = f64::INFINITY;
        for _ in 0..NEWTON_LIMIT {
            self.newton_iterations += 1;
            for i in 0..count {
                let local = rate.local(i, alpha, tau, self.status.strokes[side].pressure[i]);
                let slope = local.pressure_slope.max(LEAST_SLOPE / alpha);
                // Linearisation p = kept + z and tau f = wear + diagonal z, with z = slope t.
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
            let mut widest: f64 = 0.0;
            for i in 0..count {
                let t = state.pressure[i] / self.slope[i];
                if t > 0.0 {
                    widest = widest.max(gap[i].abs());
                }
                largest = largest.max(t);
                change = maximum(change, (t - self.local[i].displacement).abs());
                state.pressure[i] = rate.invert(i, alpha, tau, t);
            }
            self.status.strokes[side].pressure.copy_from_slice(&state.pressure);
            // Rounding relative to the largest gap of the cells in contact: under a light load the displacements are small against the
            // gap of the worn and thermally distorted shape.
            let rounding = (ROUNDED_CHANGE * largest).max(1e-12 * widest);
            let rounded = change <= rounding && change > 0.5 * last;
            last = change;
            if rounded || change <= NEWTON_TOLERANCE * largest {
                converged = Ok(true);
                self.status.strokes[side].diagonal.copy_from_slice(&self.diagonal);
                break;
            }
        }
        self.gap = linearised_gap;
        converged
    }
}

/// Load and moment balance of the increment z, with the resultant of the pressure `kept` subtracted.
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
