//! Amplitudes of the Fourier modes from states and fluxes, their values on the cells, and the propagation of the states
//! over a step.
//!
//! Theory: docs/theory.md, section 4.5.

use super::scratch::Scratch;
use super::stage_response::RANK;
use super::state_layout::{Carrier, Parts, add_products, carry, observe};
use super::step::StageWeights;
use super::{StripHeat, TAIL};
use crate::line::{GAMMA, Stage, Surroundings};
use numerics::dense;

impl StripHeat {
    /// Stores the projected temperature that drives the Robin correction of the first stage: that of the free response
    /// of the states and of the known part of the Robin correction, without the fluxes of the contact.
    pub(super) fn project_first(&self, scratch: &mut Scratch, state: &[f64], surroundings: &Surroundings) {
        if self.operators.robin_correction.is_none() {
            return;
        }
        scratch.first.fill(0.0);
        self.deviate_given_back(scratch, state);
        self.known_levels(scratch, state, surroundings, Stage::First);
    }

    /// Adds to the fluxes in `scratch.first` the deviation of the Robin correction at the start of the step from that
    /// of the first stage: it is linear in time like the fluxes of the contact, with the slope of the step before.
    pub(super) fn deviate_given_back(&self, scratch: &mut Scratch, state: &[f64]) {
        if let Some(robin_correction) = &self.operators.robin_correction {
            let rates = &state[state.len() - TAIL - RANK..state.len() - TAIL];
            let back = -GAMMA * self.step.length;
            robin_correction.lift(&std::array::from_fn(|degree| back * rates[degree]), &mut scratch.first);
        }
    }

    /// Amplitudes of the modes at a stage without its own flux, from the state and the known flux in `scratch.first`.
    /// Returns surface temperature and mean temperature of the mean mode, and stores the projected temperature that
    /// drives the Robin correction.
    fn known_levels(
        &self,
        scratch: &mut Scratch,
        state: &[f64],
        surroundings: &Surroundings,
        stage: Stage,
    ) -> [f64; 2] {
        let weights = self.step.stage(stage);
        self.wave_amplitudes(scratch, state, weights);
        self.operators.transform(&scratch.first, &mut scratch.fold, &mut scratch.heat);
        self.add_known_flux(scratch, weights);
        let fluxes = [self.mean_flux(&scratch.first, 0.0), 0.0];
        let levels = self.mean_levels(state, surroundings, weights, fluxes);
        self.project(scratch, stage, levels[0]);
        levels
    }

    /// Stores the projected temperature that drives the Robin correction of a stage, from the amplitudes in the
    /// workspace and the temperature of the mean mode.
    pub(super) fn project(&self, scratch: &mut Scratch, stage: Stage, level: f64) {
        if let Some(robin_correction) = &self.operators.robin_correction {
            let mut projected = robin_correction.project(&scratch.amplitude);
            projected[0] += robin_correction.unit[0] * level;
            scratch.projected[stage as usize] = projected;
        }
    }

    /// Fills the workspace with the total fluxes into the cells in the first stage: those of the contact, less the
    /// cooling that does not act there, plus the Robin correction from its stored projected temperature.
    pub(super) fn effective_first(&self, scratch: &mut Scratch, surroundings: &Surroundings, flux: &[f64]) {
        let cooling = surroundings.until(Stage::First).cooling;
        scratch.first.iter_mut().zip(flux).for_each(|(value, q)| *value = q - cooling);
        if let Some(robin_correction) = &self.operators.robin_correction {
            let level = scratch.projected[Stage::First as usize];
            scratch.returned[Stage::First as usize] = robin_correction.add(
                self.step.first.current_response(),
                &level,
                surroundings.ambient,
                &mut scratch.first,
            );
        }
    }

    /// The same at the end of the step.
    fn effective_end(&self, scratch: &mut Scratch, surroundings: &Surroundings, flux: &[f64]) {
        scratch.end.iter_mut().zip(flux).for_each(|(value, q)| *value = q - surroundings.cooling);
        if let Some(robin_correction) = &self.operators.robin_correction {
            let level = scratch.projected[Stage::End as usize];
            scratch.returned[Stage::End as usize] =
                robin_correction.add(self.step.end.current_response(), &level, surroundings.ambient, &mut scratch.end);
        }
    }

    /// Free response (temperature and distortion) of a stage; the flux known before it is in `scratch.first`.
    pub(super) fn base_from(
        &self,
        scratch: &mut Scratch,
        state: &[f64],
        surroundings: &Surroundings,
        stage: Stage,
        [temperature, distortion]: [&mut [f64]; 2],
    ) {
        let operators = &*self.operators;
        let weights = self.step.stage(stage);
        let [level, through_depth] = self.known_levels(scratch, state, surroundings, stage);
        let Scratch { amplitude, moved, response, .. } = &mut *scratch;
        if operators.expands {
            let levels = [level, operators.mean_distortion * through_depth];
            operators.observe([amplitude, moved], response, levels, [temperature, distortion]);
        } else {
            operators.observe_one(amplitude, &mut response[0], level, temperature);
            distortion.fill(0.0);
        }
        // Fluxes of this stage other than those of the contact: the cooling that does not act there, and the Robin
        // correction.
        let cooling = surroundings.until(stage).cooling;
        if cooling == 0.0 && operators.robin_correction.is_none() {
            return;
        }
        scratch.end.fill(-cooling);
        let mut amounts = [0.0; RANK];
        if let Some(robin_correction) = &operators.robin_correction {
            let projected = &scratch.projected[stage as usize];
            amounts =
                robin_correction.amounts(weights.current_response(), projected, surroundings.ambient, &scratch.end);
        }
        for (moving, values) in [temperature, distortion].into_iter().enumerate() {
            if moving == 1 && !operators.expands {
                continue;
            }
            let uniform = weights.current_response().uniform(moving);
            values.iter_mut().zip(uniform).for_each(|(value, rise)| *value -= cooling * rise);
            if operators.robin_correction.is_some() {
                dense::multiply_add(weights.current_response().lifted(moving), &amounts, values);
            }
        }
    }

    /// [`StripHeat::advance_by`] in place.
    pub(super) fn advance_in_place(
        &self,
        scratch: &mut Scratch,
        state: &mut [f64],
        surroundings: &Surroundings,
        contact: [&[f64]; 2],
    ) {
        let mut before = std::mem::take(&mut scratch.before);
        let (re, im) = self.operators.wave_states(state);
        before[0].copy_from_slice(re);
        before[1].copy_from_slice(im);
        self.advance_by(scratch, [&before[0], &before[1]], state, surroundings, contact);
        scratch.before = before;
    }

    /// Advances the state over the step with the contact's fluxes of both stages. The total fluxes of the first stage,
    /// their amplitudes and the projected temperature of the Robin correction at the end are in the workspace; `before`
    /// holds the states of the modes at the start of the step, all other states are in `state`.
    pub(super) fn advance_by(
        &self,
        scratch: &mut Scratch,
        before: Parts<'_>,
        state: &mut [f64],
        surroundings: &Surroundings,
        contact: [&[f64]; 2],
    ) {
        let operators = &*self.operators;
        self.effective_end(scratch, surroundings, contact[1]);
        let fluxes = [self.mean_flux(&scratch.first, 0.0), self.mean_flux(&scratch.end, 0.0)];
        self.keep_account(scratch, state, surroundings, contact, fluxes);
        if operators.robin_correction.is_some() {
            let ([first, end], tail) = (&scratch.returned, state.len() - TAIL);
            let per_change = 1.0 / ((1.0 - GAMMA) * self.step.length);
            let rates = state[tail - RANK..tail].iter_mut().zip(first.iter().zip(end));
            rates.for_each(|(rate, (first, end))| *rate = per_change * (end - first));
        }
        operators.transform(&scratch.end, &mut scratch.fold, &mut scratch.heat_end);
        let weights = &self.step.end;
        let ([re, im], [known_re, known_im, own_re, own_im]) = (&weights.factor, weights.current_response().weights());
        let carrier = Carrier { factors: [re, im], known: [known_re, known_im], own: [own_re, own_im] };
        let heat = [&scratch.heat, &scratch.heat_end].map(|heat| [&heat[0][..], &heat[1][..]]);
        let (re, im) = operators.wave_states_mut(state);
        carry(&operators.state_layout, before, [re, im], carrier, heat);
    }

    /// Surface amplitude of every mode at a stage, from the state alone.
    pub(super) fn wave_amplitudes(&self, scratch: &mut Scratch, state: &[f64], weights: &StageWeights) {
        let operators = &*self.operators;
        let (re, im) = operators.wave_states(state);
        let [factor_re, factor_im] = &weights.factor;
        let seen = [&operators.temperature[..], &operators.distortion[..]];
        let sums = [&mut scratch.amplitude, &mut scratch.moved];
        observe(&operators.state_layout, [re, im], [factor_re, factor_im], seen, sums);
    }

    /// Adds the response of the modes to the flux known before the stage, its amplitudes in `scratch.heat`.
    pub(super) fn add_known_flux(&self, scratch: &mut Scratch, weights: &StageWeights) {
        let operators = &*self.operators;
        let [re, im, moved_re, moved_im] = weights.current_response().carried();
        let Scratch { heat: [heat_re, heat_im], amplitude, moved, .. } = scratch;
        add_products(amplitude, [re, im], [heat_re, heat_im]);
        if operators.expands {
            add_products(moved, [moved_re, moved_im], [heat_re, heat_im]);
        }
    }

    /// Amplitudes of the modes at frozen state; of temperature, and of distortion where requested.
    pub(super) fn held_amplitudes(&self, scratch: &mut Scratch, state: &[f64], distortion: bool) {
        let operators = &*self.operators;
        let (re, im) = operators.wave_states(state);
        let seen = [(&operators.temperature, &mut scratch.amplitude), (&operators.distortion, &mut scratch.moved)];
        for (weights, sums) in seen.into_iter().take(1 + usize::from(distortion)) {
            for (part, sums) in [re, im].into_iter().zip(sums) {
                sums.fill(0.0);
                for level in &operators.state_layout {
                    let states = weights[level.clone()].iter().zip(&part[level.clone()]);
                    sums.iter_mut().zip(states).for_each(|(sum, (weight, x))| *sum += weight * x);
                }
            }
        }
    }
}
