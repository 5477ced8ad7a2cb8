//! The contact problem of a stage: gap of the worn bodies, operator from wear to gap, wear coefficients and equilibrium of the
//! holder.
//!
//! Theory: docs/theory.md, sections 6.1, 2.5, 5.5.

use super::Line;
use super::operators::StripWear;
use super::trajectory::StageConditions;
use contact::Normal;
use contact::wear::law::REFERENCE_PRESSURE;
use contact::wear::line::Coefficient;

impl Line {
    /// Gap of the worn bodies before they deform: `g0 + w + u_T`.
    pub(super) fn set_gap(&mut self, expansion: f64) {
        let (operators, state) = (&self.operators, &self.state);
        for i in 0..operators.count() {
            self.work.gap[i] = operators.initial_gap[i] + state.punch[i] + state.strip[i] + expansion;
        }
    }

    /// Adds the thermal distortion at the end of the last step to the gap.
    pub(super) fn add_held_distortion(&mut self) {
        if let Some(heat) = &self.state.heat {
            self.work.gap.iter_mut().zip(&heat.distortion).for_each(|(gap, moved)| *gap += moved);
        }
    }

    /// Sets wear coefficients and holder equilibrium at `moment`.
    pub(super) fn set_conditions(&mut self, moment: &StageConditions, tau: f64) {
        let (signed, normal, tilt) = self.balance(moment);
        let operators = &self.operators;
        self.conditions.signed_friction = signed;
        (self.conditions.normal, self.conditions.tilt) = (normal, tilt);
        let coefficients = operators.coefficients(
            moment.speed,
            moment.kinetic_coefficient,
            moment.temperature,
            self.tunables.wear_acceleration,
        );
        let mut term = 0;
        for body in 0..2 {
            if operators.reshapes(body) {
                match &mut self.conditions.rate.terms[term].coefficient {
                    Coefficient::Uniform(value) => *value = coefficients[body],
                    Coefficient::PerCell(values) => {
                        for (value, radial) in values.iter_mut().zip(&operators.radial[body]) {
                            *value = coefficients[body] * radial;
                        }
                    }
                }
                term += 1;
            }
        }
        // Uniform wear of the strip unloads a caliper within the stage.
        if operators.strip_wear == StripWear::Even
            && let Normal::Spring { load, stiffness } = &mut self.conditions.normal
        {
            let pressure = &self.state.pressure;
            let rate = operators.even_rate(coefficients[1], pressure);
            let carried: f64 = pressure.iter().zip(&operators.weights).map(|(p, w)| p * w).sum();
            let exponent = operators.wear[1].0.pressure_exponent;
            let slope = if carried > 0.0 { tau * exponent * rate / carried } else { 0.0 };
            let softened = 1.0 + *stiffness * slope;
            *load = (*load - *stiffness * tau * (1.0 - exponent) * rate) / softened;
            *stiffness /= softened;
        }
    }

    /// Adds the strip's depth under the cells after `travel` (m) to the gap, from the track of the step.
    pub(super) fn meet_track(&mut self, travel: f64) {
        let (state, work) = (&self.state, &mut self.work);
        let Some(track) = &work.track else { return };
        track.depth_under(state.position + travel, &mut work.strip);
        for i in 0..work.gap.len() {
            work.gap[i] += work.strip[i] - state.strip[i];
        }
    }

    /// Deposits the first stage's wear of `duration` (s) along the first `travel` (m) on the step's track.
    pub(super) fn leave_first_stage(&mut self, travel: f64, duration: f64) {
        let (state, work) = (&self.state, &mut self.work);
        let Some(track) = &mut work.track else { return };
        for (deposit, rate) in work.deposit.iter_mut().zip(&work.rates[0][1]) {
            *deposit = duration * rate;
        }
        track.deposit(state.position, state.position + travel, &work.deposit);
    }

    /// Sets the operator from the wear of a stage to the gap: the punch's wear stays under its cell, the strip's is carried along
    /// by `travel` (m). Where both wear, the depth of each cell is divided in the ratio of the wear rates at the pressure of the
    /// last step.
    pub(super) fn set_operator(&mut self, travel: f64, moment: &StageConditions) {
        let Some(track) = &self.work.track else { return };
        let operators = &self.operators;
        let known = self.work.carried_over == Some(travel);
        if !known {
            track.operator(travel, &mut self.work.carry);
            self.work.carried_over = Some(travel);
        }
        if !operators.reshapes(0) {
            if !known {
                self.contact.set_operator(Some(&self.work.carry));
            }
            return;
        }
        let laws = operators.coefficients(
            moment.speed,
            moment.kinetic_coefficient,
            moment.temperature,
            self.tunables.wear_acceleration,
        );
        for j in 0..operators.count() {
            let pressure = self.state.pressure[j].max(1e-3 * REFERENCE_PRESSURE);
            let [punch, strip] = std::array::from_fn(|body| laws[body] * operators.relative_rate(body, j, pressure));
            let share = if strip > 0.0 { strip / (punch + strip) } else { 0.0 };
            for i in 0..operators.count() {
                let own = if i == j { 1.0 - share } else { 0.0 };
                self.work.operator[(i, j)] = own + share * self.work.carry[(i, j)];
            }
        }
        self.contact.set_operator(Some(&self.work.operator));
    }

    /// Rate (m/s) of the gap of cell `i` by wear at a stage.
    pub(super) fn reshaping(&self, stage: usize, i: usize) -> f64 {
        let [punch, strip] = &self.work.rates[stage];
        if self.operators.reshapes(1) { punch[i] + strip[i] } else { punch[i] }
    }
}
