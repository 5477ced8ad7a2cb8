//! Nonlinear solver of a stage with resolved heat: pressure, heat partition, wear and rigid motion together.
//!
//! Simplified Newton iteration: the residual is that of the stage, the Jacobian that of `ThermalCoupling::reference`, which many
//! steps share. Unilateral contact stays exact: each iteration solves the complementarity problem with the frozen thermal
//! compliance. What frozen compliance, friction and wear miss is moved to the gap.
//!
//! A step is prepared, its first stage solved, then its last; the types of these three states admit no other order.
//!
//! Theory: docs/theory.md, sections 6.1, 6.4.

use super::evaluation::largest;
use super::{Iterate, ThermalCoupling};
use crate::line::heat::state::HeatState;
use crate::line::operators::LineOperators;
use crate::line::stages::{ContactStages, StepData};
use crate::line::trajectory::{StageConditions, StageMotion};
use conduction::line::{First, Stage};
use contact::wear::line::{Coefficient, StageError};
use numerics::leading_bits;
use numerics::maximum::maximum;

/// Bits of the significand that are left of a rounded wear rate: the iteration gains a factor of eight at least.
const RATE_BITS: u32 = 3;

/// Largest number of iterations until contact and temperature agree; beyond it the step is shortened.
const MAXIMUM_ITERATIONS: usize = 80;

/// Admissible residual of the interface law, relative to the rise, over the admissible relative error of the pressure.
const INTERFACE_OVER_PRESSURE: f64 = 10.0;

/// Step whose bodies and operators are prepared ([`ThermalCoupling::prepare`]).
pub struct Prepared<'a>(pub(super) &'a mut ThermalCoupling);

/// Step whose first stage is solved.
pub(crate) struct FirstSolved<'a>(&'a mut ThermalCoupling, [Option<First>; 2]);

/// Step both of whose stages are solved.
pub struct Solved<'a>(pub(super) &'a mut ThermalCoupling);

impl<'a> Prepared<'a> {
    /// Solves the first stage on the gap in `stages`; the friction coefficient is written to `now`.
    ///
    /// # Errors
    /// The contact has no equilibrium, or the iteration does not converge.
    pub(crate) fn solve_first(
        self,
        given: &StepData<'_>,
        stages: &mut ContactStages,
        now: &mut StageConditions,
        motion: StageMotion,
    ) -> Result<FirstSolved<'a>, StageError> {
        let (heat, state, pressure) = (self.0, state_of(given), &given.state.pressure);
        let firsts = heat.begin_first(state);
        heat.iterate.contraction = state.reference.contraction;
        if heat.open {
            heat.leave_open(Stage::First, given, stages, now)?;
            return Ok(FirstSolved(heat, firsts));
        }
        // The active set is first that of the start of the step, then that of the iterates.
        let untouched = pressure.iter().all(|p| *p == 0.0);
        for (i, (closed, p)) in heat.iterate.closed.iter_mut().zip(pressure).enumerate() {
            *closed = *p > 0.0 || untouched || heat.contact_parts[0].is_partial(i);
        }
        heat.predict_first(state, pressure);
        heat.contacts[0].set_status(stages.contact.status());
        heat.iterate.take_mean_temperature(&state.temperature, given.reference);
        heat.solve_stage(Stage::First, given, stages, now, motion)?;
        Ok(FirstSolved(heat, firsts))
    }
}

impl<'a> FirstSolved<'a> {
    /// Solves the last stage, as [`Prepared::solve_first`].
    ///
    /// # Errors
    /// As [`Prepared::solve_first`].
    pub(crate) fn solve_end(
        self,
        given: &StepData<'_>,
        stages: &mut ContactStages,
        now: &mut StageConditions,
        motion: StageMotion,
    ) -> Result<Solved<'a>, StageError> {
        let (heat, state) = (self.0, state_of(given));
        heat.begin_end(self.1, state);
        if heat.open {
            heat.leave_open(Stage::End, given, stages, now)?;
            return Ok(Solved(heat));
        }
        heat.predict_end(state, [&given.state.pressure, &stages.first.pressure]);
        let [first, end] = &mut heat.contacts;
        end.set_status(first.status());
        // Where nothing depends on the temperature it is not evaluated at the first stage.
        if needs_cell_temperatures(given.operators) {
            heat.iterate.take_mean_temperature(&heat.temperature[0], given.reference);
        } else {
            heat.iterate.take_mean_temperature(&state.temperature, given.reference);
        }
        heat.solve_stage(Stage::End, given, stages, now, motion)?;
        stages.contact.set_status(heat.contacts[1].status());
        if !heat.iterate.temperatures_current {
            heat.update_temperatures(Stage::End);
        }
        heat.distort_by_contact();
        Ok(Solved(heat))
    }
}

/// Thermal state at the start of the step.
pub(super) fn state_of<'a>(given: &StepData<'a>) -> &'a HeatState {
    let Some(state) = &given.state.heat else { unreachable!("a scene with heat along the line has its state") };
    state
}

/// Whether friction depends on the temperature.
fn fades(operators: &LineOperators) -> bool {
    !operators.scene.friction_fade.flat
}

/// Whether friction or wear depends on the temperature of the cells.
fn needs_cell_temperatures(operators: &LineOperators) -> bool {
    operators.wears_by_cell() || fades(operators)
}

/// Remaining error of a quantity under iteration, relative.
#[derive(Clone, Copy, Debug)]
struct RemainingError {
    /// Ratio of the second change to the first: as expected from the stages before, until it is known.
    contraction: f64,
    last: Option<f64>,
    is_known: bool,
}

impl RemainingError {
    fn new(contraction: f64) -> RemainingError {
        RemainingError { contraction, last: None, is_known: false }
    }

    /// Remaining error after a `change` c: of a geometric series with the ratio r the rest is c r/(1 - r). Where the changes do not at
    /// least halve, c itself.
    fn after(&mut self, change: f64) -> f64 {
        let last = self.last.replace(change);
        let ratio = match last {
            Some(last) if last > 0.0 => change / last,
            Some(_) => 1.0,
            None => self.contraction,
        };
        if !self.is_known && last.is_some() {
            (self.contraction, self.is_known) = (ratio.min(1.0), true);
        }
        if ratio < 0.5 { change * ratio / (1.0 - ratio) } else { change }
    }

    /// Contraction that the next stage may expect: E. Hairer and G. Wanner, Solving Ordinary Differential Equations II, IV.8.
    fn expected(&self) -> f64 {
        self.contraction.max(f64::EPSILON).powf(0.8)
    }
}

/// Relative changes of an iteration.
#[derive(Clone, Copy, Debug)]
struct Change {
    pressure: f64,
    contact_temperature: f64,
    /// Residual of the interface law before the iteration.
    interface: f64,
    /// Of the temperatures, by the fluxes into the cooled faces.
    faces: f64,
}

/// Convergence of a stage.
#[derive(Clone, Copy, Debug)]
struct Convergence {
    /// Admissible remaining error of the pressure, relative to the largest, and of the absolute contact temperature, on which
    /// friction and wear depend. Fluxes and heat balance are exact at any remaining error.
    enough: f64,
    pressure: RemainingError,
    contact_temperature: RemainingError,
    /// Ratio of residual to change of an accelerated iteration, whose changes do not form a geometric series.
    accelerated: Option<f64>,
}

impl Convergence {
    fn new(enough: f64, contraction: f64) -> Convergence {
        // The laws of an iteration are those of the temperature before it: nothing is expected of that.
        let [pressure, contact_temperature] = [contraction, 1.0].map(RemainingError::new);
        Convergence { enough, pressure, contact_temperature, accelerated: None }
    }

    /// Whether the remaining errors are small enough; the contact of an `exact` stage is solved without iteration. `residual`: of the
    /// interface law after the iteration, evaluated where that before it is too large.
    fn reached(&mut self, change: Change, exact: bool, residual: impl FnOnce() -> f64) -> bool {
        let of_series = self.pressure.after(change.pressure);
        let pressure = self.accelerated.map_or(of_series, |ratio| ratio.max(1.0) * change.pressure);
        let contact_temperature = self.contact_temperature.after(change.contact_temperature);
        let least = INTERFACE_OVER_PRESSURE * self.enough;
        maximum(contact_temperature, change.faces) <= self.enough
            && (exact || pressure <= self.enough && (change.interface <= least || residual() <= least))
    }
}

impl ThermalCoupling {
    /// Sets the friction coefficient of the cells at their contact temperature.
    pub(super) fn update_friction(&mut self, given: &StepData<'_>) {
        let cells = self.kinetic_coefficient.iter_mut().zip(&self.iterate.contact_temperature);
        cells.for_each(|(coefficient, temperature)| *coefficient = given.friction.kinetic_coefficient(*temperature));
    }

    /// Solves a stage from the predicted iterate. An iteration takes friction, wear and operators at the iterate, solves the contact
    /// for the pressure, then sets fluxes and temperatures. Where the frozen operators are exact one suffices.
    fn solve_stage(
        &mut self,
        stage: Stage,
        given: &StepData<'_>,
        stages: &mut ContactStages,
        now: &mut StageConditions,
        motion: StageMotion,
    ) -> Result<(), StageError> {
        let (operators, s) = (given.operators, stage as usize);
        if stages.track.is_some() {
            stages.set_operator_of(&mut self.contacts[s], given, motion.travel, now);
        }
        if now.load == 0.0 {
            self.iterate.closed.fill(false);
        }
        match fades(operators) {
            true => self.update_friction(given),
            // The same at every temperature.
            false => self.kinetic_coefficient.fill(given.friction.kinetic_coefficient(0.0)),
        }
        let mut slip = now.slip();
        let mut convergence = Convergence::new(operators.budget.iteration.line_stage, self.iterate.contraction);
        self.iterate.temperatures_current = false;
        self.iterate.anderson.clear();
        self.iterate.added.fill(false);
        for iteration in 0..MAXIMUM_ITERATIONS {
            if fades(operators) {
                now.set_kinetic_coefficient(weighted(
                    &self.kinetic_coefficient,
                    &self.iterate.pressure,
                    &operators.torque_weights,
                ));
                slip = now.slip();
                self.iterate.temperatures_current = false;
            }
            self.install_thermal_compliance(stage, slip)?;
            self.couple_faces(stage);
            stages.budget.solutions += 1;
            stages.set_conditions(given, now, motion.tau);
            self.set_laws(given, stages, now);
            // The first iteration starts from the predictor: there is no difference yet to accelerate with.
            let accelerated = !self.exact[s] && iteration > 0;
            if accelerated {
                let Iterate { anderson, pressure, contact_temperature, .. } = &mut self.iterate;
                anderson.begin(&[pressure, &self.flux[s][0], contact_temperature]);
            }
            let interface = self.assemble_fluxes(stage, slip);
            self.assemble_gap(stage, &stages.gap);
            if !self.exact[s] {
                self.linearise_wear(given, stages, now, motion.tau);
                self.linearise_friction(stage, stages, now);
            }
            let found = match stage {
                Stage::First => &mut stages.first,
                Stage::End => &mut stages.end,
            };
            self.contacts[s].stage_into(&self.iterate.gap, motion.tau, &stages.conditions, found)?;
            let pressure = self.update_pressure(stage, &found.pressure, convergence.enough);
            let contact_temperature = match needs_cell_temperatures(operators) {
                true => self.update_contact_temperature(stage, given),
                false => 0.0,
            };
            let settled = self.update_active_set(stage, &found.pressure);
            let faces = self.solve_faces(stage);
            let change = Change { pressure, contact_temperature, interface, faces };
            if settled && convergence.reached(change, self.exact[s], || self.residual_after(stage)) {
                self.iterate.contraction = convergence.pressure.expected();
                self.iterations = self.iterations.max(iteration);
                if now.released > 0.0 {
                    self.release(stage, now.released);
                }
                self.write_wear_rates(stage, given, stages);
                self.surround_by_faces(stage);
                return Ok(());
            }
            if !settled {
                self.iterate.anderson.clear();
                convergence = Convergence::new(convergence.enough, 1.0);
            } else if accelerated {
                convergence.accelerated = self.accelerate(stage, given, pressure);
            }
        }
        Err(StageError::NotConverged { stage: motion.tau, iterations: MAXIMUM_ITERATIONS })
    }

    /// A stage in which nothing touches: no cell has pressure or exchanges heat, and the temperatures are the free response.
    fn leave_open(
        &mut self,
        stage: Stage,
        given: &StepData<'_>,
        stages: &mut ContactStages,
        now: &StageConditions,
    ) -> Result<(), StageError> {
        let s = stage as usize;
        (self.exact[s], self.reduced[s]) = (false, false);
        self.iterate.closed.fill(false);
        let [punch, strip] = &mut self.flux[s];
        [punch, strip, &mut self.friction[s], &mut self.iterate.pressure]
            .into_iter()
            .for_each(|values| values.fill(0.0));
        self.couple_faces(stage);
        self.solve_faces(stage);
        self.surround_by_faces(stage);
        self.update_contact_temperature(stage, given);
        let [punch, strip] = &self.iterate.free_distortion;
        let cells =
            self.distortion.iter_mut().zip(punch.iter().zip(strip)).zip(self.iterate.gap.iter_mut().zip(&stages.gap));
        for ((moved, (punch, strip)), (gap, worn)) in cells {
            *moved = punch + strip;
            *gap = worn + *moved;
        }
        stages.budget.solutions += 1;
        stages.leave_open(stage, given, now, &self.iterate.gap)
    }

    /// Gives the open surfaces the heat of a bristle that the contact no longer holds, W/m2, half to each body that conducts.
    fn release(&mut self, stage: Stage, heat: f64) {
        let conducts = self.conducts();
        let s = stage as usize;
        self.friction[s].fill(heat);
        let part = if conducts == [true, true] { 0.5 * heat } else { heat };
        for (flux, conducts) in self.flux[s].iter_mut().zip(conducts) {
            flux.fill(if conducts { part } else { 0.0 });
        }
        self.iterate.temperatures_current = false;
    }

    /// Sets contact temperature and friction of the cells by the surface temperatures of the iterate; returns the largest relative
    /// change.
    fn update_contact_temperature(&mut self, stage: Stage, given: &StepData<'_>) -> f64 {
        self.update_temperatures(stage);
        let [punch, strip] = &self.temperature[stage as usize];
        let mut most: f64 = 0.0;
        for (own, (punch, strip)) in self.iterate.contact_temperature.iter_mut().zip(punch.iter().zip(strip)) {
            let new = 0.5 * (punch + strip) + given.reference;
            most = maximum(most, (new - *own).abs() / new.abs().max(1.0));
            *own = new;
        }
        self.update_friction(given);
        most
    }

    /// Anderson acceleration of pressure, flux and contact temperature after an iteration that changed the pressure by `change`,
    /// relative; returns the ratio of residual to change.
    fn accelerate(&mut self, stage: Stage, given: &StepData<'_>, change: f64) -> Option<f64> {
        let count = given.operators.count();
        let Iterate { anderson, pressure, contact_temperature, acceleration_scale, .. } = &mut self.iterate;
        let most = largest(pressure);
        let parts = [&mut pressure[..], &mut self.flux[stage as usize][0], contact_temperature];
        if anderson.is_clear() {
            *acceleration_scale = parts.each_ref().map(|part| {
                let most = largest(part);
                if most > 0.0 { most.recip() } else { 0.0 }
            });
        }
        let scale = *acceleration_scale;
        let [moved, ..] = anderson.accelerate(parts, |i| scale[i / count])?;
        self.iterate.temperatures_current = false;
        if needs_cell_temperatures(given.operators) {
            self.update_friction(given);
        }
        Some(if change > 0.0 { moved / (most * change) } else { 1.0 })
    }

    /// Takes the wear rates of the linearization point into the matrix of the contact, whose factors are cached, and moves the
    /// difference to those of the iterate to the gap. Rates that follow the temperature of the cells are rounded instead.
    fn linearise_wear(&mut self, given: &StepData<'_>, stages: &mut ContactStages, now: &StageConditions, tau: f64) {
        if stages.track.is_some() {
            return;
        }
        let operators = given.operators;
        let reference = operators.coefficients(
            self.reference.speed,
            self.reference.kinetic_coefficient,
            now.temperature,
            given.tunables.wear_acceleration,
        );
        let by_cell = operators.wears_by_cell();
        let reshaping = (0..2).filter(|&body| operators.reshapes(body));
        for (term, body) in stages.conditions.rate.terms.iter_mut().zip(reshaping) {
            let frozen = |rate: f64| if by_cell { leading_bits(rate, RATE_BITS) } else { reference[body] };
            let rates = &self.reference_wear_rates[body];
            match &mut term.coefficient {
                Coefficient::Uniform(value) => *value = frozen(*value),
                Coefficient::PerCell(values) => {
                    let cells = values.iter_mut().zip(rates.iter().zip(&operators.radial[body]));
                    cells.for_each(|(value, (rate, radial))| *value = frozen(*rate) * radial);
                }
            }
            let missed = self.iterate.difference.iter_mut().zip(rates);
            missed.for_each(|(missed, rate)| *missed = tau * (rate - frozen(*rate)));
            operators.scale_by_relative_rates(body, &self.iterate.pressure, &mut self.iterate.difference);
            self.iterate.gap.iter_mut().zip(&self.iterate.difference).for_each(|(gap, worn)| *gap += worn);
        }
    }

    /// The same for the friction coefficient of the shear coupling.
    fn linearise_friction(&mut self, stage: Stage, stages: &mut ContactStages, now: &StageConditions) {
        let signed_friction = &mut stages.conditions.signed_friction;
        if *signed_friction == 0.0 || self.reference.friction == 0.0 {
            return;
        }
        let known = self.reference.friction.copysign(*signed_friction);
        let cells = self.kinetic_coefficient.iter().zip(&self.iterate.pressure);
        for (difference, (kinetic_coefficient, pressure)) in self.iterate.difference.iter_mut().zip(cells) {
            *difference = (now.sign * kinetic_coefficient * now.stribeck - known) * pressure;
        }
        if largest(&self.iterate.difference) != 0.0 {
            self.contacts[stage as usize].add_shear_displacement(&self.iterate.difference, &mut self.iterate.gap);
        }
        *signed_friction = known;
    }

    /// Wear depth rates at the reference pressure, by temperature and friction of each cell.
    pub(super) fn set_laws(&mut self, given: &StepData<'_>, stages: &mut ContactStages, now: &StageConditions) {
        let operators = given.operators;
        let (cells, acceleration) = (&self.iterate.contact_temperature, given.tunables.wear_acceleration);
        let law = |i: usize| operators.coefficients(now.speed, self.kinetic_coefficient[i], cells[i], acceleration);
        let [punch, strip] = &mut self.reference_wear_rates;
        if !operators.wears_by_cell() {
            let [of_punch, of_strip] = law(0);
            punch.fill(of_punch);
            strip.fill(of_strip);
            return;
        }
        for (i, rates) in punch.iter_mut().zip(strip).enumerate() {
            [*rates.0, *rates.1] = law(i);
        }
        let reshaping = (0..2).filter(|&body| operators.reshapes(body));
        for (term, body) in stages.conditions.rate.terms.iter_mut().zip(reshaping) {
            if let Coefficient::PerCell(values) = &mut term.coefficient {
                let rates = self.reference_wear_rates[body].iter().zip(&operators.radial[body]);
                values.iter_mut().zip(rates).for_each(|(value, (law, radial))| *value = law * radial);
            }
        }
    }

    /// Writes the wear depth rates of the converged stage.
    fn write_wear_rates(&self, stage: Stage, given: &StepData<'_>, stages: &mut ContactStages) {
        let pressure = [&stages.first.pressure, &stages.end.pressure][stage as usize];
        for (body, rates) in stages.rates[stage as usize].iter_mut().enumerate() {
            rates.copy_from_slice(&self.reference_wear_rates[body]);
            if largest(rates) != 0.0 {
                given.operators.scale_by_relative_rates(body, pressure, rates);
            }
        }
    }
}

/// Mean of `values` weighted by pressure, or over the contact where the pressure is zero.
pub(super) fn weighted(values: &[f64], pressure: &[f64], weights: &[f64]) -> f64 {
    let (mut sum, mut load, mut plain, mut total) = (0.0, 0.0, 0.0, 0.0);
    for i in 0..values.len() {
        sum += weights[i] * pressure[i] * values[i];
        load += weights[i] * pressure[i];
        plain += weights[i] * values[i];
        total += weights[i];
    }
    if load > 0.0 { sum / load } else { plain / total }
}
