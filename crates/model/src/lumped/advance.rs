//! One communication step of the lumped level: a single-step attempt in the common form where possible, otherwise pieces between
//! events, subdivided by error control.
//!
//! Theory: docs/theory.md, sections 5.1, 7.3.

use super::conditions::Conditions;
use super::property_step::{ATTEMPTS, PropertyStep};
use super::state::LumpedState;
use super::stepper::{Attempt, Stepper};
use super::{Lumped, NEAR_END, NOMINAL_MARGIN, limit, limits_of_temperature, limits_of_wear};
use crate::budget::WorkBudget;
use crate::events::{edges, load_is_negative, load_on_contact};
use crate::growth;
use crate::step_control::{FINEST, StepController};
use crate::{Inputs, StepFailure};
use contact::friction::OperatingPoint;
use pulp::NullaryFnOnce;
use scene::message::Number;
use std::fmt;

/// Error below which the step is doubled: it falls by about eight when the step is halved.
const LUMPED_DOUBLING: f64 = 0.3;

/// Single-step attempt in the common form, compiled for every vector unit; no operation is fused, so all give the same bits.
struct SingleStepAttempt<'a, const CONSTANT: bool> {
    stepper: Stepper<'a>,
    state: &'a mut LumpedState,
    /// Conditions at the start and at the three points.
    at: [&'a Conditions; 4],
}

impl<const CONSTANT: bool> NullaryFnOnce for SingleStepAttempt<'_, CONSTANT> {
    type Output = Option<Attempt>;

    #[inline(always)]
    fn call(mut self) -> Option<Attempt> {
        let (operators, propagators) = (self.stepper.operators, &self.stepper.propagators);
        if CONSTANT {
            let speed = self.at[0].velocity.abs();
            self.stepper.flash.prepare_steady(operators, propagators, speed);
        }
        self.stepper.attempt::<true>(self.state, self.at, CONSTANT)
    }
}

impl Lumped {
    /// Advances the scene by `step` (s, > 0) with inputs that start at `inputs` and change at the rates `slopes`, or are
    /// constant. On failure the state is the one before the step.
    ///
    /// # Errors
    /// [`StepFailure`] where no step size gives a solution, or a body is worn through.
    pub(crate) fn step(&mut self, inputs: &Inputs, slopes: Option<&Inputs>, step: f64) -> Result<(), StepFailure> {
        self.frozen = None;
        let mut is_too_long = false;
        if slopes.is_none() && self.state.refinement == 0 && self.operators.has_common_form {
            match self.attempt_single_step(inputs, step) {
                Some(attempt) if attempt.error <= 1.0 => return self.conclude(inputs, step, &attempt),
                attempt => is_too_long = attempt.is_some(),
            }
        }
        self.general_step(inputs, slopes, step, is_too_long)
    }

    /// Tries the whole communication step at constant inputs in the common form; `None` where that does not apply. Unless the error
    /// of the attempt is at most 1, the state is unchanged.
    #[inline]
    fn attempt_single_step(&mut self, inputs: &Inputs, step: f64) -> Option<Attempt> {
        self.update_conditions(inputs);
        let mut attempt = 0;
        loop {
            let temperatures = self.predict(step, attempt);
            let stepper = Stepper {
                flash: &mut self.flash,
                cut: 1.0,
                left: 1.0,
                ends: None,
                operators: &self.operators,
                friction: &self.friction,
                tunables: &self.tunables,
                propagators: self.propagators.get(&self.operators, step, temperatures),
                properties: self.property_step.as_mut(),
            };
            let single = SingleStepAttempt::<true> { stepper, state: &mut self.state, at: [&self.known.1; 4] };
            let outcome = self.arch.dispatch(single);
            attempt += 1;
            if attempt < ATTEMPTS && self.repeats() {
                continue;
            }
            return outcome;
        }
    }

    /// Temperatures (K) of whose properties a step of `step` (s) is computed. `attempt`: number of attempts of the same step before.
    #[inline(always)]
    fn predict(&mut self, step: f64, attempt: usize) -> [f64; 2] {
        match &mut self.property_step {
            None => [0.0; 2],
            Some(own) if attempt == 0 => own.predict(&self.operators, &self.state, step),
            Some(own) => own.correct(&self.operators),
        }
    }

    /// Whether the last attempt is to be repeated at other properties.
    fn repeats(&self) -> bool {
        self.property_step.as_ref().is_some_and(PropertyStep::repeats)
    }

    /// Completes a step taken in the common form.
    #[inline]
    fn conclude(&mut self, inputs: &Inputs, step: f64, attempt: &Attempt) -> Result<(), StepFailure> {
        let (state, within) = (&mut self.state, &self.operators.common_bounds);
        state.steps += 1;
        state.error = state.error.max(attempt.error * self.operators.scene.tolerance);
        let velocity = inputs.velocity(self.operators.scene.mean_radius);
        let is_unremarkable = state.punch.depth < within.depth[0]
            && state.strip.depth < within.depth[1]
            && velocity.abs() <= within.speed
            && (0.0..=within.load).contains(&inputs.normal_load)
            && attempt.hottest + state.reference <= within.temperature;
        if is_unremarkable {
            self.grow([velocity; 2], inputs.normal_load, step);
            return Ok(());
        }
        if load_is_negative(inputs, inputs, self.operators.scene.nominal_load) {
            self.state.limits |= limit::NEGATIVE_LOAD;
        }
        self.judge_temperature(attempt.hottest);
        self.watch(inputs, None, step)
    }

    /// General form of the step; `is_too_long` if a single step over the whole of it has been rejected.
    #[inline(never)]
    fn general_step(
        &mut self,
        inputs: &Inputs,
        slopes: Option<&Inputs>,
        step: f64,
        is_too_long: bool,
    ) -> Result<(), StepFailure> {
        let mut backup = None;
        // Both may change before the state is saved, which it is only once a part of the step is accepted.
        let (limits, rejected) = (self.state.limits, self.state.rejected);
        let outcome =
            self.pieces(inputs, slopes, step, is_too_long, &mut backup).and_then(|()| self.watch(inputs, slopes, step));
        if outcome.is_err() {
            if let Some(backup) = backup {
                self.state = backup;
            }
            (self.state.limits, self.state.rejected) = (limits, rejected);
        }
        outcome
    }

    /// Advances in pieces between sign changes of velocity and load.
    fn pieces(
        &mut self,
        inputs: &Inputs,
        slopes: Option<&Inputs>,
        step: f64,
        is_too_long: bool,
        backup: &mut Option<LumpedState>,
    ) -> Result<(), StepFailure> {
        if self.near_end_of_body(inputs, slopes, step) {
            *backup = Some(self.state.clone());
        }
        if load_is_negative(inputs, &inputs.after(slopes, step), self.operators.scene.nominal_load) {
            self.state.limits |= limit::NEGATIVE_LOAD;
        }
        let mut budget = WorkBudget::new(1, 0);
        let (edges, count) = edges(inputs, slopes, step, self.operators.scene.mean_radius);
        if count > 1 && backup.is_none() {
            *backup = Some(self.state.clone());
        }
        let constant = slopes.is_none().then(|| {
            self.update_conditions(inputs);
            self.known.1
        });
        let (operators, tunables, reference) = (self.operators.clone(), self.tunables, self.state.reference);
        for piece in edges[..=count].windows(2).filter(|piece| piece[1] > piece[0]) {
            let varying =
                |time: f64| Conditions::new(&operators, &tunables, reference, &inputs.after(slopes, piece[0] + time));
            let at = |time: f64| constant.unwrap_or_else(|| varying(time));
            self.piece(&at, constant.is_some(), piece[1] - piece[0], is_too_long, backup, &mut budget)?;
        }
        Ok(())
    }

    /// Advances over a piece without events, of the length `length` (s), under the conditions `at` a time (s) since its start, all the
    /// same where `constant`. It is divided into 2^n equal parts by error control; `is_too_long` if a single step over the whole of it
    /// has been rejected.
    fn piece(
        &mut self,
        at: &dyn Fn(f64) -> Conditions,
        constant: bool,
        length: f64,
        is_too_long: bool,
        backup: &mut Option<LumpedState>,
        budget: &mut WorkBudget,
    ) -> Result<(), StepFailure> {
        let mut control = StepController::new(length, self.state.refinement + u8::from(is_too_long), LUMPED_DOUBLING);
        self.state.rejected += u64::from(is_too_long);
        // Conditions at the ends of the piece, once it is cut: until then they are those of the only part.
        let mut whole = None;
        while !control.is_done() {
            let (parts, done) = control.parts();
            let tolerance = self.operators.scene.tolerance;
            budget.spend(|| {
                let [start, end] = [at(0.0), at(length)];
                format!(
                    "{done} of 2^{} parts of {length} s are done at solver.tolerance = {tolerance}; sliding velocity {} to {} m/s, \
                     normal load {} to {} N", control.level(), Number(start.velocity), Number(end.velocity), Number(start.load), Number(end.load), length = Number(length))
            })?;
            let (start, step) = (control.start(), control.step());
            if parts > 1 && backup.is_none() {
                *backup = Some(self.state.clone());
            }
            let points =
                if constant { [at(start); 4] } else { [0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0].map(|c| at(start + c * step)) };
            let ends =
                &*whole.get_or_insert_with(|| if parts == 1 { [points[0], points[3]] } else { [at(0.0), at(length)] });
            // A transition between sticking and slipping is not polynomial at any step size.
            let ends = (!constant || self.has_bristle()).then_some(ends);
            let (speeds, at_points) = (points.map(|now| now.velocity.abs()), points.each_ref());
            let mut repeated = 0;
            let attempt = loop {
                let temperatures = self.predict(step, repeated);
                let propagators = self.propagators.get(&self.operators, step, temperatures);
                self.flash.prepare(&self.operators, &propagators, speeds);
                let mut attempt = None;
                for common in [true, false] {
                    if common && !self.operators.has_common_form {
                        continue;
                    }
                    let mut stepper = Stepper {
                        flash: &mut self.flash,
                        cut: parts as f64,
                        left: (parts - done) as f64,
                        ends,
                        operators: &self.operators,
                        friction: &self.friction,
                        tunables: &self.tunables,
                        propagators,
                        properties: self.property_step.as_mut(),
                    };
                    let state = &mut self.state;
                    attempt = match (common, constant) {
                        (true, true) => self.arch.dispatch(SingleStepAttempt::<true> { stepper, state, at: at_points }),
                        (true, false) => {
                            self.arch.dispatch(SingleStepAttempt::<false> { stepper, state, at: at_points })
                        }
                        (false, _) => Some(stepper.attempt_any(state, at_points, constant)),
                    };
                    if attempt.is_some() {
                        break;
                    }
                }
                repeated += 1;
                if repeated == ATTEMPTS || !self.repeats() {
                    break attempt.expect("the general form always has an outcome");
                }
            };
            if attempt.error <= 1.0 {
                self.state.steps += 1;
                self.state.error = self.state.error.max(attempt.error * self.operators.scene.tolerance);
                self.judge_temperature(attempt.hottest);
                control.accept(attempt.error, true);
                continue;
            }
            self.state.rejected += 1;
            if !control.halve(1) {
                let last = points[3];
                return Err(StepFailure(format!(
                    "no solution of heat, friction and wear in a step of {step} s (communication step cut by 2^{FINEST}); \
                     contact temperature {} K, sliding velocity {} m/s, normal load {} N",
                    Number(self.state.end_temperature + self.state.reference),
                    Number(last.velocity),
                    Number(last.load),
                    step = Number(step)
                )));
            }
        }
        self.state.refinement = control.level();
        Ok(())
    }

    /// Whether the step could wear a body through: only then is the initial state saved.
    fn near_end_of_body(&self, inputs: &Inputs, slopes: Option<&Inputs>, step: f64) -> bool {
        let operators = &self.operators;
        let scene = &operators.scene;
        let largest = inputs.zip(&inputs.after(slopes, step), |first: f64, last: f64| first.abs().max(last.abs()));
        let speed = largest.velocity(scene.mean_radius);
        let pressure = largest.normal_load / operators.area;
        let bodies = [
            (&operators.punch, &scene.punch, self.state.punch.depth),
            (&operators.strip, &scene.strip, self.state.strip.depth),
        ];
        // Behind a caliper the load may rise above that of the actuator.
        operators.series_stiffness > 0.0
            || bodies.into_iter().any(|(body, given, depth)| {
                let rate = body.wear.highest_rate(pressure, speed, self.tunables.friction_coefficient)
                    * (body.wear_factor * self.tunables.wear_acceleration);
                depth + given.initial_wear + step * rate > NEAR_END * given.height
            })
    }

    fn judge_temperature(&mut self, hottest: f64) {
        self.state.limits |= limits_of_temperature(&self.operators.scene, hottest + self.state.reference);
    }

    /// Sets limit bits and checks validity after a step.
    fn watch(&mut self, inputs: &Inputs, slopes: Option<&Inputs>, step: f64) -> Result<(), StepFailure> {
        let scene = &self.operators.scene;
        self.state.limits |= limits_of_wear(scene, [self.state.punch.depth, self.state.strip.depth])?;
        if let Some(track) = &self.state.track {
            if track.revisited() {
                self.state.limits |= limit::VALIDITY;
            }
            // Not only where the contact is when the step ends.
            let most = scene.strip.wear_limit;
            if most > 0.0 && track.deepest() + scene.strip.initial_wear >= most {
                self.state.limits |= limit::WEAR;
            }
        }
        // Inputs are linear within a step: the largest are at one of its ends.
        let last = inputs.after(slopes, step);
        let velocities = [inputs, &last].map(|inputs| inputs.velocity(scene.mean_radius));
        let speed = velocities[0].abs().max(velocities[1].abs());
        let load = inputs.normal_load.max(last.normal_load);
        let beyond = |value: f64, nominal: f64| nominal > 0.0 && value > NOMINAL_MARGIN * nominal;
        if beyond(speed, scene.nominal_velocity) || beyond(load, scene.nominal_load) {
            self.state.limits |= limit::VALIDITY;
        }
        self.grow(velocities, load, step);
        Ok(())
    }

    /// Counts the growth of pressure perturbations in a step between these velocities, m/s, under at most this load, N.
    #[inline]
    fn grow(&mut self, velocities: [f64; 2], load: f64, step: f64) {
        let operators = &self.operators;
        if load_on_contact(load, operators.scene.nominal_load) == 0.0 || self.state.limits & limit::UNSTABLE != 0 {
            return;
        }
        let speed = velocities[0].abs().max(velocities[1].abs());
        let friction = self.end_friction(OperatingPoint { velocity: speed, pressure: load / operators.area });
        self.state.growth += operators.growth.over(friction, velocities, step);
        if self.state.growth >= growth::noticeable(operators.scene.tolerance) {
            self.state.limits |= limit::UNSTABLE;
        }
    }

    /// Friction coefficient at the temperature of the end of the last step, at this operating point.
    pub(crate) fn end_friction(&self, operating_point: OperatingPoint) -> f64 {
        self.kinetic_coefficient() * self.friction.stribeck(operating_point)
    }

    /// Writes the message of a bit of [`limit`] that contains numbers.
    pub(crate) fn write_warning(&self, bit: u8, inputs: &Inputs, text: &mut String) -> fmt::Result {
        if bit != limit::UNSTABLE {
            return Ok(());
        }
        let operators = &self.operators;
        let operating_point = operators.operating_point(inputs);
        let (growth, friction) = (self.state.growth, self.end_friction(operating_point));
        operators.growth.critical.write_message(text, growth, friction, operating_point.velocity.abs(), false)
    }
}
