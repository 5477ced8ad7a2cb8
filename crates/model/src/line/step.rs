//! Time stepping of the worn shape within a piece of a communication step.
//!
//! SDIRK2, `gamma = 1 - 1/sqrt 2`: second order, L-stable, stiffly accurate, so the pressure of the last stage is the
//! pressure on the shape at the end. With the depth rates `f` of the wear law on the cells,
//!
//! ```text
//! gap_1 = g0 + w + gamma h f(p_1) + A p_1 - ...            at gamma h
//! gap_2 = g0 + w + (1 - gamma) h f(p_1) + gamma h f(p_2) + A p_2 - ...     at h
//! w    <- w + h [(1 - gamma) f(p_1) + gamma f(p_2)]
//! ```
//!
//! The embedded first-order solution gives the error estimate; the piece is divided into 2^n equal parts accordingly.
//!
//! Theory: docs/theory.md, sections 5.2, 7.1, 7.3.

use super::Line;
use super::operators::StripWear;
use super::stages::ContactStages;
use super::trajectory::{InputTrajectory, StageMotion};
use crate::StepFailure;
use crate::step_control::{FINEST, StepController, halvings};
use conduction::line::{GAMMA, Stage};
use contact::wear::line::{StageError, WearingContact};
use numerics::interruption::checkpoint;
use numerics::maximum::maximum;
use scene::message::Number;
use std::fmt;

/// Order of the error of wear; that of heat is up to a half higher, and where heat begins to flow 1.
const ORDER: u8 = 2;

/// Error below which the step is doubled, with a margin for errors of the order 2.5.
const LINE_DOUBLING: f64 = 0.12;

/// Number of steps before a step size rejected by the growth guard is tried again.
const RETRY_DELAY: u8 = 32;

/// Largest number of bisections of a step whose stage has no solution, before the reason is reported.
const CUTS_WITHOUT_SOLUTION: u8 = 20;

/// Outcome of a trial step over a part of a piece.
enum Outcome {
    /// Error in units of the tolerance, and its order.
    Tried(f64, u8),
    /// Rejected by the growth guard.
    RejectedByGrowthGuard,
    /// No solution.
    Failed(StageError),
}

impl Outcome {
    /// With an error of at least `error`.
    fn at_least(self, error: f64) -> Outcome {
        match self {
            Outcome::Tried(own, order) => Outcome::Tried(maximum(own, error), order),
            other => other,
        }
    }
}

impl Line {
    /// Advances the worn shape over a piece.
    pub(super) fn step_line(&mut self, path: &InputTrajectory, length: f64) -> Result<(), StepFailure> {
        let operators = self.operators.clone();
        if self.heat.is_none() && (!operators.wears() || path.idle()) {
            return self.advance_without_wear(path, length);
        }
        let mut control = StepController::new(length, self.state.refinement, LINE_DOUBLING);
        let mut failures = 0;
        let of_work = path.error_of_work() / operators.budget.steps.whole;
        while !control.is_done() {
            let (start, step) = (control.start(), control.step());
            if self.exceeds_travel_limit(path, start, step) && control.halve(1) {
                continue;
            }
            match &mut self.attempts_left {
                Some(0) => return Err(StepFailure("the allowed number of internal steps is exhausted".into())),
                Some(left) => *left -= 1,
                None => {}
            }
            self.spend(path, start)?;
            let newton = self.newton_iterations();
            let outcome = self.attempt(path, start, step).at_least(of_work * (step / length).powi(2));
            self.stages.budget.solutions += self.newton_iterations() - newton;
            let halvings = match outcome {
                Outcome::Tried(error, _) if error <= 1.0 => {
                    self.accept(path, start, step)?;
                    self.state.steps += 1;
                    self.state.error = self.state.error.max(error.powi(2) * operators.scene.tolerance);
                    failures = 0;
                    let rejected_by_growth =
                        self.state.heat.as_mut().is_some_and(|heat| heat.was_rejected_by_growth(2.0 * step));
                    control.accept(error, !rejected_by_growth);
                    continue;
                }
                Outcome::Tried(error, order) => halvings(error, order),
                Outcome::RejectedByGrowthGuard => {
                    if let Some(heat) = &mut self.state.heat {
                        heat.rejected_by_growth = [step, f64::from(RETRY_DELAY)];
                    }
                    1
                }
                Outcome::Failed(error) => {
                    failures += 1;
                    // With heat the pressure may diverge in a long step and not in a short one.
                    let curable = self.heat.is_some() || matches!(error, StageError::NotConverged { .. });
                    if failures > CUTS_WITHOUT_SOLUTION || !curable {
                        return Err(self.failure(path, start, &error));
                    }
                    if let Some(heat) = &mut self.state.heat {
                        heat.reference.narrow();
                    }
                    2
                }
            };
            self.state.rejected += 1;
            if !control.halve(halvings) {
                let (step, length) = (Number(step), Number(length));
                let what = format_args!(
                    "no solution of pressure and wear in a step of {step} s (piece of {length} s cut by 2^{FINEST})"
                );
                return Err(self.failure(path, start, &what));
            }
        }
        self.state.refinement = control.level();
        Ok(())
    }

    /// Counts an internal step that is about to be tried at `start` (s from the start of the piece).
    pub(super) fn spend(&mut self, path: &InputTrajectory, start: f64) -> Result<(), StepFailure> {
        let (scene, length) = (&self.operators.scene, path.length());
        self.stages.budget.spend(|| {
            format!(
                "{start} s of a piece of {length} s are done on {} cells at solver.tolerance = {}; sliding velocity {} to {} m/s, \
                 normal load {} to {} N", self.operators.count(), scene.tolerance, Number(path.velocity(0.0)), Number(path.velocity(length)), Number(path.at(0.0).load), Number(path.at(length).load), start = Number(start), length = Number(length))
        })
    }

    /// Solutions of the contact required by wear rates nonlinear in the pressure, so far.
    fn newton_iterations(&self) -> u64 {
        let heat = self.heat.iter().flat_map(|heat| &heat.contacts).map(WearingContact::newton_iterations);
        self.stages.contact.newton_iterations() + heat.sum::<u64>()
    }

    pub(super) fn failure(&self, path: &InputTrajectory, time: f64, error: &dyn fmt::Display) -> StepFailure {
        let now = path.at(time);
        StepFailure(format!(
            "{error}; sliding velocity {} m/s, normal load {} N, friction coefficient {}",
            Number(path.velocity(time)),
            Number(now.load),
            Number(now.signed_friction.abs())
        ))
    }

    /// Whether the travel exceeds its limit: with a worn track in the strip, a quarter of the half-width in one step.
    fn exceeds_travel_limit(&self, path: &InputTrajectory, start: f64, step: f64) -> bool {
        let travel = step * path.velocity(start + 0.5 * step).abs();
        self.state.track.as_ref().is_some_and(|track| travel > track.longest_travel())
    }

    /// Advances a piece without wear: only the position on a track and the load change.
    fn advance_without_wear(&mut self, path: &InputTrajectory, length: f64) -> Result<(), StepFailure> {
        let travel = length * path.velocity(0.5 * length);
        self.state.position += travel;
        if travel != 0.0
            && let Some(track) = &self.state.track
        {
            track.depth_under(self.state.position, &mut self.state.strip);
        }
        if !self.operators.decides_load() {
            self.state.current = false;
            return self.watch();
        }
        let now = path.at(length);
        let (given, stages, _) = self.parts();
        stages.set_gap(&given, now.expansion);
        stages.solve_without_wear(&given, &now).map_err(|error| self.failure(path, length, &error))?;
        self.keep_end();
        self.watch()
    }

    /// Trial step over a part; both stages are left in `stages`.
    fn attempt(&mut self, path: &InputTrajectory, start: f64, step: f64) -> Outcome {
        checkpoint();
        let (given, stages, heat) = self.parts();
        let operators = given.operators;
        let (count, widths) = (operators.count(), operators.cells.widths());
        let [mut early, mut late] = [path.at(start + GAMMA * step), path.at(start + step)];
        let (tau, rest) = (GAMMA * step, (1.0 - GAMMA) * step);
        let travel = step * path.velocity(start + 0.5 * step);
        let early_travel = GAMMA * travel;
        stages.begin(&given);
        stages.set_gap(&given, early.expansion);
        stages.meet_track(&given, early_travel);
        let first = match heat {
            Some(heat) => {
                let prepared = heat.prepare(&given, path, start, step);
                let course = StageMotion { tau, travel: early_travel };
                prepared.solve_first(&given, stages, &mut early, course).map(Some)
            }
            None => {
                stages.set_operator(&given, early_travel, &early);
                stages.solve(Stage::First, &given, &early, tau).map(|()| None)
            }
        };
        let first = match first {
            Ok(first) => first,
            Err(error) => return Outcome::Failed(error),
        };
        if operators.strip_wear == StripWear::Track {
            stages.leave_first_stage(&given, (1.0 - GAMMA) * travel, rest);
            stages.set_gap(&given, late.expansion);
            stages.meet_track(&given, travel);
            for i in 0..count {
                stages.gap[i] += rest * stages.rates[0][0][i];
            }
        } else {
            let even = if operators.strip_wear == StripWear::Even {
                operators.cells.integral(&stages.rates[0][1]) / (2.0 * operators.cells.half_width())
            } else {
                0.0
            };
            let shift = late.expansion - early.expansion;
            for i in 0..count {
                stages.gap[i] += rest * (stages.reshaping(operators, 0, i) + even) + shift;
            }
        }
        let solved = match first {
            Some(first) => {
                let course = StageMotion { tau, travel: early_travel };
                first.solve_end(&given, stages, &mut late, course).map(Some)
            }
            None => stages.solve(Stage::End, &given, &late, tau).map(|()| None),
        };
        let solved = match solved {
            Ok(solved) => solved,
            Err(error) => return Outcome::Failed(error),
        };
        let (mut square, mut load) = (0.0, 0.0);
        for i in 0..count {
            let difference = stages.reshaping(operators, 0, i) - stages.reshaping(operators, 1, i);
            square += widths[i] * difference * difference;
            load += operators.weights[i] * stages.first.pressure[i].max(stages.end.pressure[i]);
        }
        let width = 2.0 * operators.cells.half_width();
        let estimate = (0.5 - GAMMA) * step * (square / width).sqrt();
        let scene = &operators.scene;
        let mean = (load / width).max(1e-6 * scene.nominal_load / scene.contact_area());
        let bound = operators.budget.steps.whole * operators.displacement_scale * mean;
        let wear = if estimate == 0.0 { 0.0 } else { estimate / bound };
        match solved {
            Some(mut solved) if solved.is_controlled(scene.tolerance * stages.budget.relaxation()) => {
                let coefficient = late.kinetic_coefficient * late.stribeck;
                if !solved.passes_growth_guard(operators, stages, early.speed.max(late.speed), coefficient) {
                    return Outcome::RejectedByGrowthGuard;
                }
                let of_properties = solved.error_of_properties(&given);
                let heat = solved.error(&given, bound);
                let order = if heat > wear && solved.begins(&given) { 1 } else { ORDER };
                Outcome::Tried(maximum(wear, heat).max(of_properties), order)
            }
            _ => Outcome::Tried(wear, ORDER),
        }
    }

    /// Accepts the trial step and compares it with the limits.
    ///
    /// # Errors
    /// Those of [`Line::watch`].
    pub(super) fn accept(&mut self, path: &InputTrajectory, start: f64, step: f64) -> Result<(), StepFailure> {
        let operators = self.operators.clone();
        let count = operators.count();
        let travel = step * path.velocity(start + 0.5 * step);
        let weights = [(1.0 - GAMMA) * step, GAMMA * step];
        let worn = |body: usize, i: usize, stages: &ContactStages| {
            weights[0] * stages.rates[0][body][i] + weights[1] * stages.rates[1][body][i]
        };
        let mut even = 0.0;
        for i in 0..count {
            let depth = worn(0, i, &self.stages);
            self.state.punch[i] += depth;
            self.state.volume[0] += operators.weights[i] * depth;
            let depth = worn(1, i, &self.stages);
            self.stages.deposit[i] = depth;
            self.state.volume[1] += operators.weights[i] * depth / operators.wear[1].1;
            even += operators.cells.widths()[i] * depth;
        }
        match operators.strip_wear {
            StripWear::None => {}
            StripWear::Even => {
                let depth = even / (2.0 * operators.cells.half_width());
                self.state.strip.iter_mut().for_each(|worn| *worn += depth);
                // The last stage was solved on the strip before its own wear.
                let last = operators.cells.integral(&self.stages.rates[1][1]) / (2.0 * operators.cells.half_width());
                self.stages.end.approach += weights[1] * last;
            }
            StripWear::ByRadius => {
                for (worn, depth) in self.state.strip.iter_mut().zip(&self.stages.deposit) {
                    *worn += depth;
                }
            }
            StripWear::Track => {
                let (state, stages) = (&mut self.state, &mut self.stages);
                if let (Some(track), Some(own)) = (&mut state.track, &mut stages.track) {
                    for (deposit, rate) in stages.deposit.iter_mut().zip(&stages.rates[1][1]) {
                        *deposit = weights[1] * rate;
                    }
                    let end = state.position + travel;
                    own.deposit(end - GAMMA * travel, end, &stages.deposit);
                    own.depth_under(end, &mut state.strip);
                    track.copy_from(own);
                }
            }
        }
        self.state.position += travel;
        self.accept_heat(path.velocity(start + step));
        self.keep_end();
        self.watch()
    }

    /// Updates the thermal state by the step just accepted.
    fn accept_heat(&mut self, velocity: f64) {
        let Line { operators, friction, stages, state, heat, backup, bodies_kept, .. } = self;
        let Some(heat) = heat else { return };
        let kept = backup.1.heat.as_mut().filter(|_| !std::mem::replace(bodies_kept, true));
        heat.accept(operators, friction, stages, state, kept, velocity);
    }

    /// Copies the last stage into the state as its equilibrium.
    fn keep_end(&mut self) {
        let (state, end) = (&mut self.state, &self.stages.end);
        state.pressure.copy_from_slice(&end.pressure);
        (state.approach, state.tilt) = (end.approach, end.tilt);
        state.current = true;
        state.carried = self.operators.carried(&state.pressure);
        self.invalidate_equilibrium();
    }
}
