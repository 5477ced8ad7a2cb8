//! Nonlinear solver of a stage with resolved heat: pressure, heat partition, wear and rigid motion together.
//!
//! Theory: docs/theory.md, sections 6.1, 6.4.

use super::ThermalCoupling;
use super::evaluation::largest;
use crate::line::Line;
use crate::line::trajectory::StageConditions;
use conduction::line::Stage;
use contact::wear::line::{Coefficient, StageError, WearTerm};
use numerics::maximum::maximum;

/// Largest number of iterations until contact and temperature agree; beyond it the step is shortened.
const MAXIMUM_ITERATIONS: usize = 80;

/// Remaining error of the pressure, relative to the largest, and of the absolute contact temperature, on which friction and wear
/// depend, at which the iteration ends: as a part of the step's tolerance, and its bounds. Fluxes and heat balance are exact at
/// any remaining error.
const PART: f64 = 1e-3;
const LEAST: f64 = 1e-9;
const MOST: f64 = 1e-6;

/// Admissible relative error of the temperatures of both surfaces over that of the pressure.
const TEMPERATURE: f64 = 10.0;

/// Iteration from which on Anderson acceleration is used.
const ACCELERATED_FROM: usize = 1;

/// Convergence history of a stage iteration.
#[derive(Clone, Copy, Debug, Default)]
struct Convergence {
    last: Option<f64>,
}

impl Convergence {
    /// Remaining error after a `change`, for changes that decrease as a geometric series.
    fn remaining_error(&mut self, change: f64) -> f64 {
        let last = self.last.replace(change);
        match last {
            Some(last) if change < 0.5 * last => change * change / (last - change),
            _ => change,
        }
    }
}

impl Line {
    /// Solves a stage of length `tau` (s) on the gap in `work`; the friction coefficient is written to `moment`.
    pub(in crate::line) fn solve_with_heat(
        &mut self,
        stage: Stage,
        moment: &mut StageConditions,
        velocity: f64,
        tau: f64,
        travel: f64,
    ) -> Result<(), StageError> {
        let Some(mut heat) = self.heat.take() else { unreachable!("only scenes with heat along the line come here") };
        let outcome = self.solve_both(&mut heat, stage, moment, velocity, tau, travel);
        self.heat = Some(heat);
        outcome
    }

    fn solve_both(
        &mut self,
        heat: &mut ThermalCoupling,
        stage: Stage,
        moment: &mut StageConditions,
        velocity: f64,
        tau: f64,
        travel: f64,
    ) -> Result<(), StageError> {
        let operators = self.operators.clone();
        let count = operators.count();
        let s = stage as usize;
        if self.work.track.is_some() {
            self.work.carried_over = None;
            std::mem::swap(&mut self.contact, &mut heat.contacts[s]);
            self.set_operator(travel, moment);
            std::mem::swap(&mut self.contact, &mut heat.contacts[s]);
        }
        let Some(state) = &self.state.heat else { unreachable!("a scene with heat along the line has its state") };
        heat.begin(stage, state);
        // A cell in contact at the start of the step exchanges heat throughout it, one that closes within the step from then on.
        // So the iteration only enlarges the active set, and ends; a cell that opens with heat and closes without it, which has
        // no consistent state, changes from step to step instead of preventing convergence.
        let follows = operators.wears_by_cell() || !operators.scene.friction_fade.flat;
        let earlier = match stage {
            Stage::First => {
                let untouched = self.state.pressure.iter().all(|p| *p == 0.0);
                for (closed, p) in heat.iterate.closed.iter_mut().zip(&self.state.pressure) {
                    *closed = *p > 0.0 || untouched;
                }
                heat.predict_first(state, &self.state.pressure);
                &state.temperature
            }
            Stage::End => {
                heat.predict_end(state, [&self.state.pressure, &self.work.first.pressure]);
                // Where nothing depends on the temperature it is not evaluated at the first stage.
                if follows { &heat.temperature[0] } else { &state.temperature }
            }
        };
        if moment.load == 0.0 {
            heat.iterate.closed.fill(false);
        }
        let [first, end] = &mut heat.contacts;
        match stage {
            Stage::First => first.set_status(self.contact.status()),
            Stage::End => end.set_status(first.status()),
        }
        let reference = self.mean.state().reference;
        let stribeck = self.friction.stribeck(velocity);
        let sign = moment.sign;
        let fades = !operators.scene.friction_fade.flat;
        let by_cell = operators.wears_by_cell();
        for (contact_temperature, (punch, strip)) in
            heat.iterate.contact_temperature.iter_mut().zip(earlier[0].iter().zip(&earlier[1]))
        {
            *contact_temperature = 0.5 * (punch + strip) + reference;
        }
        match fades {
            true => {
                let cells = heat.kinetic_coefficient.iter_mut().zip(&heat.iterate.contact_temperature);
                cells.for_each(|(kinetic_coefficient, contact_temperature)| {
                    *kinetic_coefficient = self.friction.kinetic_coefficient(*contact_temperature)
                });
            }
            false => heat.kinetic_coefficient.fill(self.friction.kinetic_coefficient(0.0)),
        }
        let mut slip = moment.slip(stribeck);
        let enough = (PART * operators.scene.tolerance).clamp(LEAST, MOST);
        let [mut pressures, mut temperatures, mut contact_temperatures] = [Convergence::default(); 3];
        heat.iterate.temperatures_current = false;
        heat.iterate.anderson.clear();
        // Ratio of residual to change of an accelerated iteration.
        let mut residual_norm: Option<f64> = None;
        for iteration in 0..MAXIMUM_ITERATIONS {
            if fades {
                moment.kinetic_coefficient =
                    weighted(&heat.kinetic_coefficient, &heat.iterate.pressure, &operators.torque_weights);
                moment.follow(sign * stribeck);
                slip = moment.slip(stribeck);
                heat.iterate.temperatures_current = false;
            }
            heat.install_thermal_compliance(stage, slip)?;
            self.work.budget.solutions += 1;
            self.set_conditions(moment, tau);
            self.set_laws(heat, moment, by_cell);
            let compared = !heat.exact[s] && iteration >= ACCELERATED_FROM;
            if compared {
                heat.iterate.anderson.begin(&[
                    &heat.iterate.pressure,
                    &heat.flux[s][0],
                    &heat.iterate.contact_temperature,
                ]);
            }
            let residual = heat.assemble_fluxes(stage, slip);
            heat.assemble_gap(stage, &self.work.gap);
            let uniform = |term: &WearTerm| matches!(term.coefficient, Coefficient::Uniform(_));
            if !heat.exact[s] && self.work.track.is_none() && self.conditions.rate.terms.iter().all(uniform) {
                self.wear_at_reference(heat, moment, tau);
            }
            if !heat.exact[s] && self.conditions.signed_friction != 0.0 && heat.reference.friction != 0.0 {
                // The matrix of the contact holds the friction coefficient of the linearization point; the difference to that of
                // each cell is moved to the gap.
                let known = heat.reference.friction.copysign(self.conditions.signed_friction);
                let cells =
                    heat.iterate.difference.iter_mut().zip(heat.kinetic_coefficient.iter().zip(&heat.iterate.pressure));
                for (difference, (kinetic_coefficient, pressure)) in cells {
                    *difference = (sign * kinetic_coefficient * stribeck - known) * pressure;
                }
                if largest(&heat.iterate.difference) > 0.0 {
                    heat.contacts[s].add_shear_displacement(&heat.iterate.difference, &mut heat.iterate.gap);
                }
                self.conditions.signed_friction = known;
            }
            let found = match stage {
                Stage::First => &mut self.work.first,
                Stage::End => &mut self.work.end,
            };
            heat.contacts[s].stage_into(&heat.iterate.gap, tau, &self.conditions, found)?;
            let change = heat.update_pressure(stage, &found.pressure, enough);
            let mut temperature_change: f64 = 0.0;
            if follows {
                heat.update_temperatures(stage);
                for i in 0..count {
                    let [punch, strip] = &heat.temperature[s];
                    let contact_temperature = 0.5 * (punch[i] + strip[i]) + reference;
                    temperature_change = maximum(
                        temperature_change,
                        (contact_temperature - heat.iterate.contact_temperature[i]).abs()
                            / contact_temperature.abs().max(1.0),
                    );
                    heat.iterate.contact_temperature[i] = contact_temperature;
                    heat.kinetic_coefficient[i] = self.friction.kinetic_coefficient(contact_temperature);
                }
            }
            let active_set_settled = heat.update_active_set(&found.pressure);
            let of_series = [pressures.remaining_error(change), temperatures.remaining_error(residual)];
            // Changes under acceleration do not form a geometric series.
            let [remaining_error, unlike_surfaces] =
                residual_norm.map_or(of_series, |residual_norm| [residual_norm.max(1.0) * change, residual]);
            let remaining_error = maximum(remaining_error, unlike_surfaces / TEMPERATURE);
            let consistent = contact_temperatures.remaining_error(temperature_change) <= enough;
            if active_set_settled && consistent && (heat.exact[s] || remaining_error <= enough) {
                heat.iterations = heat.iterations.max(iteration);
                self.finish_stage(heat, stage);
                return Ok(());
            }
            if !active_set_settled {
                heat.iterate.anderson.clear();
                residual_norm = None;
            } else if compared {
                let most = largest(&heat.iterate.pressure);
                let parts =
                    [&mut heat.iterate.pressure[..], &mut heat.flux[s][0], &mut heat.iterate.contact_temperature];
                if heat.iterate.anderson.is_clear() {
                    heat.iterate.acceleration_scale = parts.each_ref().map(|part| {
                        let most = largest(part);
                        if most > 0.0 { most.recip() } else { 0.0 }
                    });
                }
                let scale = heat.iterate.acceleration_scale;
                let moved =
                    heat.iterate.anderson.accelerate(parts, |i| scale[i / count]).map(|[pressure, ..]| pressure);
                residual_norm = moved.map(|moved| if change > 0.0 { moved / (most * change) } else { 1.0 });
                if follows && moved.is_some() {
                    heat.iterate.temperatures_current = false;
                    let cells = heat.kinetic_coefficient.iter_mut().zip(&heat.iterate.contact_temperature);
                    cells.for_each(|(coefficient, temperature)| {
                        *coefficient = self.friction.kinetic_coefficient(*temperature)
                    });
                }
            }
        }
        Err(StageError::NotConverged { stage: tau, iterations: MAXIMUM_ITERATIONS })
    }

    /// Uses the frozen wear Jacobian (its factors are cached) and moves the difference to the gap.
    fn wear_at_reference(&mut self, heat: &mut ThermalCoupling, moment: &StageConditions, tau: f64) {
        let operators = &self.operators;
        let acceleration = self.tunables.wear_acceleration;
        let reference = operators.coefficients(
            heat.reference.speed,
            heat.reference.kinetic_coefficient,
            moment.temperature,
            acceleration,
        );
        let reshaping = (0..2).filter(|&body| operators.reshapes(body));
        for (term, body) in self.conditions.rate.terms.iter_mut().zip(reshaping) {
            let residual = tau * (heat.reference_wear_rates[body][0] - reference[body]);
            heat.iterate.difference.fill(residual);
            operators.scale_by_relative_rates(body, &heat.iterate.pressure, &mut heat.iterate.difference);
            heat.iterate.gap.iter_mut().zip(&heat.iterate.difference).for_each(|(gap, worn)| *gap += worn);
            term.coefficient = Coefficient::Uniform(reference[body]);
        }
    }

    /// Wear depth rates at the reference pressure, by temperature and friction of each cell.
    pub(super) fn set_laws(&mut self, heat: &mut ThermalCoupling, moment: &StageConditions, by_cell: bool) {
        let operators = &self.operators;
        let acceleration = self.tunables.wear_acceleration;
        if !by_cell {
            let uniform = operators.coefficients(
                moment.speed,
                heat.kinetic_coefficient[0],
                heat.iterate.contact_temperature[0],
                acceleration,
            );
            heat.reference_wear_rates
                .iter_mut()
                .zip(uniform)
                .for_each(|(reference_wear_rates, own)| reference_wear_rates.fill(own));
            return;
        }
        for i in 0..heat.iterate.contact_temperature.len() {
            let own = operators.coefficients(
                moment.speed,
                heat.kinetic_coefficient[i],
                heat.iterate.contact_temperature[i],
                acceleration,
            );
            (heat.reference_wear_rates[0][i], heat.reference_wear_rates[1][i]) = (own[0], own[1]);
        }
        let reshaping = (0..2).filter(|&body| operators.reshapes(body));
        for (term, body) in self.conditions.rate.terms.iter_mut().zip(reshaping) {
            if let Coefficient::PerCell(values) = &mut term.coefficient {
                let rates = heat.reference_wear_rates[body].iter().zip(&operators.radial[body]);
                values.iter_mut().zip(rates).for_each(|(value, (law, radial))| *value = law * radial);
            }
        }
    }

    /// Evaluates wear depth rates, temperatures and distortion of the converged stage.
    fn finish_stage(&mut self, heat: &mut ThermalCoupling, stage: Stage) {
        let s = stage as usize;
        let pressure = match stage {
            Stage::First => &self.work.first.pressure,
            Stage::End => &self.work.end.pressure,
        };
        for body in 0..2 {
            let rates = &mut self.work.rates[s][body];
            rates.copy_from_slice(&heat.reference_wear_rates[body]);
            if largest(rates) > 0.0 {
                self.operators.scale_by_relative_rates(body, pressure, rates);
            }
        }
        if stage == Stage::End {
            self.contact.set_status(heat.contacts[s].status());
            if !heat.iterate.temperatures_current {
                heat.update_temperatures(stage);
            }
            heat.distort_by_contact();
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
