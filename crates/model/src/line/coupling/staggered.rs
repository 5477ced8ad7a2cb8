//! Operator split between contact and heat, for comparison with the monolithic step.
//!
//! A step of h first solves for pressure, wear and rigid motion, with the distortion and the temperatures at its start, then
//! heats the bodies by the pressure found, both by implicit Euler:
//!
//! ```text
//! g0 + w + h f(p) + A p + u_T - delta - theta x >= 0,  p >= 0,  ...     u_T, mu, k at the start of the step
//! w <- w + h f(p),    T <- implicit Euler step of both bodies with q_1 + q_2 = mu s v p
//! ```
//!
//! The scheme is consistent and of first order: the distortion is one step old. A pressure wave of wave number m with the growth
//! rate b is amplified in a step by g = exp(b h), where
//!
//! ```text
//! z (1 + z) = 2 R/g,    z^2 = 1 + (1 - 1/g)/(h kd m^2)
//! ```
//!
//! on one conducting half-plane, which is slower than the exact growth.
//!
//! # Stability limit
//!
//! The heat of one step changes the friction heat of the next: a linear map from flux to flux, by distortion and pressure and by
//! temperature and friction coefficient (its steepest change per kelvin over the step). An eigenvalue of this map on the positive
//! axis above 1 is an instability of the scene itself. Any other eigenvalue of modulus above 1 is caused by the splitting: where
//! friction decreases with temperature, less heat is returned one step too late, so that steps alternate between hot and cold. An
//! alternating perturbation, g = -1, corresponds to implicit Euler steps of half the length, wear included:
//!
//! ```text
//! x = x/g + h (b q - lambda x)  =>  x = b q/(lambda + 2/h)
//! ```
//!
//! so it grows where the map of half the step has an eigenvalue below -1. Such a step is rejected.
//!
//! Theory: docs/theory.md, section 5.6.

use super::ThermalCoupling;
use super::stage::{Prepared, state_of, weighted};
use crate::line::heat::state::HeatState;
use crate::line::operators::StripWear;
use crate::line::stages::{ContactStages, StepData};
use crate::line::trajectory::{InputTrajectory, StageConditions};
use conduction::line::{GAMMA, Stage};
use contact::friction::FrictionLaw;
use contact::wear::line::{Disturbance, StageError};
use numerics::dense;
use numerics::scalar::Dual;

/// Number of power iterations, and of the last ones over which the growth factor is averaged.
const APPLICATIONS: usize = 32;
const OBSERVED: usize = 8;

/// Cosine between the dominant direction and its image above which the dominant eigenvalue is taken as positive: the scene itself
/// is unstable.
const SAME_DIRECTION: f64 = 0.5;

/// Iterations between the fluxes into cells and cooled faces, and the relative change of temperature at which they end.
const MOST_EXCHANGES: usize = 40;
const AGREEMENT: f64 = 1e-9;

/// Bisections, in the logarithm, for the stability limit of a rejected step.
const BISECTIONS: u32 = 30;

/// Reason for which a part of the step fails.
pub enum Refusal {
    /// The contact has no solution.
    Stage(StageError),
    /// The step is above this stability limit, s.
    Diverges(f64),
}

impl From<StageError> for Refusal {
    fn from(error: StageError) -> Refusal {
        Refusal::Stage(error)
    }
}

impl Prepared<'_> {
    /// One step of the operator split: pressure and wear, then heat; results are left in `stages` and in the coupling.
    ///
    /// # Errors
    /// The contact has no solution, or the step is above the stability limit.
    pub fn split(
        self,
        given: &StepData<'_>,
        stages: &mut ContactStages,
        path: &InputTrajectory,
        start: f64,
    ) -> Result<(), Refusal> {
        let (heat, operators) = (self.0, given.operators);
        let step = heat.step;
        let mut moment = path.at(start + step);
        let velocity = path.velocity(start + step);
        let travel = step * path.velocity(start + 0.5 * step);
        let slip = heat.friction_at_start(given, &mut moment, velocity);
        stages.begin(given);
        stages.set_gap(given, moment.expansion);
        stages.add_held_distortion(given);
        stages.meet_track(given, travel);
        stages.set_operator(given, travel, &moment);
        stages.set_conditions(given, &moment, step);
        heat.set_laws(given, stages, &moment);
        stages.contact.stage_into(&stages.gap, step, &stages.conditions, &mut stages.end)?;
        let pressure = &stages.end.pressure;
        for body in 0..2 {
            for (i, p) in pressure.iter().enumerate() {
                let law = heat.reference_wear_rates[body][i];
                let rate = if law == 0.0 { 0.0 } else { law * operators.relative_rate(body, i, *p) };
                stages.rates[0][body][i] = rate;
                stages.rates[1][body][i] = rate;
            }
        }
        stages.leave_first_stage(given, (1.0 - GAMMA) * travel, (1.0 - GAMMA) * step);
        if operators.strip_wear == StripWear::Even {
            // The contact was solved on the strip without the last part of its wear, which is added where the step is accepted.
            let mean = operators.cells.integral(&stages.rates[1][1]) / (2.0 * operators.cells.half_width());
            stages.end.approach += (1.0 - GAMMA) * step * mean;
        }
        heat.take_pressure(state_of(given), &stages.end.pressure, slip);
        // A factor below 1 in one step excludes growth; the exact criterion is only evaluated otherwise.
        if heat.splitting_unstable(given, stages, step, slip) {
            heat.change_step(0.5 * step);
            if heat.splitting_unstable(given, stages, 0.5 * step, slip) {
                return Err(Refusal::Diverges(heat.longest_stable(given, stages, step, slip)));
            }
            heat.change_step(step);
        }
        Ok(())
    }
}

impl ThermalCoupling {
    /// Whether the map of a step of `step` s has a dominant eigenvalue of modulus 1 or more off the positive axis.
    fn splitting_unstable(&mut self, given: &StepData<'_>, stages: &mut ContactStages, step: f64, slip: f64) -> bool {
        let (growth, along) = self.lag(given, stages, step, slip);
        growth >= 1.0 && along < SAME_DIRECTION
    }

    /// Kinetic friction coefficient of the cells at the initial temperatures; returns s v with the Stribeck factor.
    fn friction_at_start(&mut self, given: &StepData<'_>, moment: &mut StageConditions, velocity: f64) -> f64 {
        let (operators, state) = (given.operators, state_of(given));
        self.iterate.take_mean_temperature(&state.temperature, given.reference);
        self.update_friction(given);
        let stribeck = given.friction.stribeck(velocity);
        if !operators.scene.friction_fade.flat {
            moment.kinetic_coefficient =
                weighted(&self.kinetic_coefficient, &given.state.pressure, &operators.torque_weights);
            moment.follow(moment.sign * stribeck);
        }
        moment.slip(stribeck)
    }

    /// Dominant growth factor of the map from the heat of one step of `step` s to that of the next, by power iteration, and the
    /// cosine between the last flux and its image.
    fn lag(&mut self, given: &StepData<'_>, stages: &mut ContactStages, step: f64, slip: f64) -> (f64, f64) {
        let count = self.iterate.gap.len();
        let fades = !given.operators.scene.friction_fade.flat;
        let reference = given.reference;
        let (mut product, mut along) = (1.0, 1.0);
        // Start vector not orthogonal to the dominant direction.
        for (i, flux) in self.iterate.gap.iter_mut().enumerate() {
            let closed = if self.iterate.closed[i] { 1.0 } else { 0.0 };
            *flux = closed * ((0.618_033_988_75 * i as f64).fract() - 0.4);
        }
        normalise(&mut self.iterate.gap);
        for application in 0..APPLICATIONS {
            self.respond();
            let gap = &self.iterate.free_response[1];
            let disturbance = Disturbance { gap, normal: 0.0, tilt: 0.0, moment: 0.0, signed_friction: 0.0 };
            let (state, rate) = (&stages.end, &mut stages.rate);
            if stages.contact.stage_response_into(step, &stages.conditions, state, &disturbance, rate).is_err() {
                return (0.0, 1.0);
            }
            let returned = &mut self.iterate.sums[0];
            for i in 0..count {
                let slip = slip * self.parameters.ratio[i];
                returned[i] = slip * self.kinetic_coefficient[i] * rate.pressure[i];
                if fades {
                    let end = 0.5 * (self.temperature[1][0][i] + self.temperature[1][1][i]) + reference;
                    let slope = slope_over(given.friction, self.iterate.contact_temperature[i], end);
                    returned[i] += slip * slope * self.iterate.free_response[0][i] * state.pressure[i];
                }
            }
            along = self.iterate.gap.iter().zip(&*returned).map(|(out, back)| out * back).sum();
            let factor = normalise(returned);
            if factor == 0.0 {
                return (0.0, 1.0);
            }
            along /= factor;
            if application >= APPLICATIONS - OBSERVED {
                product *= factor;
            }
            std::mem::swap(&mut self.iterate.gap, &mut self.iterate.sums[0]);
        }
        (product.powf(1.0 / OBSERVED as f64), along)
    }

    /// Longest step (s) below `step` at which the splitting is stable, at the pressure of the step tried.
    fn longest_stable(&mut self, given: &StepData<'_>, stages: &mut ContactStages, step: f64, slip: f64) -> f64 {
        let (mut stable, mut unstable) = ((1e-9 * step).ln(), step.ln());
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (stable + unstable);
            let half = 0.5 * middle.exp();
            self.change_step(half);
            *(if self.splitting_unstable(given, stages, half, slip) { &mut unstable } else { &mut stable }) = middle;
        }
        stable.exp()
    }

    /// Surface influence matrices and heat partition of an implicit Euler step of another length.
    fn change_step(&mut self, step: f64) {
        let velocity = self.velocity;
        self.bodies.iter_mut().flatten().for_each(|body| body.prepare_euler(step, velocity));
        self.step = step;
        self.build_end_partition();
    }

    /// Builds the heat partition at the end of the step for the cells in contact.
    fn build_end_partition(&mut self) {
        let steady = self.velocity[0] == self.velocity[1];
        let key = (self.step, if steady { self.velocity[1] } else { f64::NAN }, self.frozen.scales);
        // The operators of a changing velocity share a slot and are built anew.
        if !(self.partitions.take(key) && steady) {
            let influence = self.bodies.each_ref().map(|body| body.as_ref().map(|own| own.influence(Stage::End)));
            self.partitions[1].build(key, &self.contact_parts[1], influence);
        }
        self.partitions[1].set_active_set(&self.iterate.closed);
    }

    /// Heats both bodies over the step by the friction heat of `pressure`.
    fn take_pressure(&mut self, state: &HeatState, pressure: &[f64], slip: f64) {
        for (closed, p) in self.iterate.closed.iter_mut().zip(pressure) {
            *closed = *p > 0.0;
        }
        self.iterate.pressure.copy_from_slice(pressure);
        // Warm start from the saved state, so that a replay is identical to the bit.
        self.flux[1][0].copy_from_slice(&state.flux[0]);
        self.begin(Stage::End, state);
        self.build_end_partition();
        self.couple_faces(Stage::End);
        for _ in 0..MOST_EXCHANGES {
            self.iterate.temperatures_current = false;
            self.assemble_fluxes(Stage::End, slip);
            if self.solve_faces(Stage::End) <= AGREEMENT {
                break;
            }
        }
        self.surround_constantly();
        self.update_temperatures(Stage::End);
        let [first, end] = &mut self.flux;
        for (first, end) in first.iter_mut().zip(end) {
            first.copy_from_slice(end);
        }
        let [first, end] = &mut self.friction;
        first.copy_from_slice(end);
        self.distort();
    }

    /// Mean temperature of both surfaces, in `free_response[0]`, and displacement, in `free_response[1]`, by the friction heat in
    /// `gap` alone.
    fn respond(&mut self) {
        let conducts = self.conducts();
        let influence = self.bodies.each_ref().map(|body| body.as_ref().map(|own| own.influence(Stage::End)));
        let count = self.iterate.gap.len();
        let [punch, strip] = [&mut self.iterate.free_distortion[1], &mut self.iterate.sums[1]];
        punch.fill(0.0);
        match (influence, self.parameters.half_resistance > 0.0) {
            ([Some(_), Some(own)], true) => {
                let residual = &mut self.iterate.difference;
                residual
                    .iter_mut()
                    .zip(&self.iterate.gap)
                    .for_each(|(residual, flux)| *residual = self.parameters.half_resistance * flux);
                dense::multiply_add(own.temperature.as_slice(), &self.iterate.gap, residual);
                self.partitions[1].exchange(residual, punch);
            }
            ([Some(_), Some(_)], false) => {
                punch.iter_mut().zip(&self.iterate.gap).for_each(|(own, flux)| *own = 0.5 * flux)
            }
            ([Some(_), None], _) => punch.copy_from_slice(&self.iterate.gap),
            _ => {}
        }
        for i in 0..count {
            strip[i] = if conducts[1] { self.iterate.gap[i] - punch[i] } else { 0.0 };
        }
        let [temperature, moved] = &mut self.iterate.free_response;
        temperature.fill(0.0);
        moved.fill(0.0);
        for (influence, flux) in influence.into_iter().zip([&*punch, &*strip]) {
            if let Some(influence) = influence {
                dense::multiply_add(influence.temperature.as_slice(), flux, temperature);
                dense::multiply_add(influence.distortion.as_slice(), flux, moved);
            }
        }
        if conducts == [true, true] {
            temperature.iter_mut().for_each(|t| *t *= 0.5);
        } else {
            temperature
                .iter_mut()
                .zip(&self.iterate.gap)
                .for_each(|(t, q)| *t += 0.5 * self.parameters.half_resistance * q);
        }
    }
}

/// Derivative of the friction coefficient at the first temperature, 1/K, or the secant to the other where that is steeper: a
/// tangent misses the corners of tables.
fn slope_over(friction: &FrictionLaw, start: f64, end: f64) -> f64 {
    let tangent = friction.kinetic_coefficient(Dual { value: start, derivative: 1.0 }).derivative;
    let chord = (friction.kinetic_coefficient(end) - friction.kinetic_coefficient(start)) / (end - start);
    if chord.abs() > tangent.abs() { chord } else { tangent }
}

/// Normalises to length 1; returns the previous length.
fn normalise(values: &mut [f64]) -> f64 {
    let length = values.iter().map(|value| value * value).sum::<f64>().sqrt();
    if length > 0.0 && length.is_finite() {
        values.iter_mut().for_each(|value| *value /= length);
        length
    } else {
        0.0
    }
}
