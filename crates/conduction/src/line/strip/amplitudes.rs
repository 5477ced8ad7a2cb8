//! Amplitudes of the Fourier modes from states and fluxes, their values on the cells, and the propagation of the states
//! over a step.
//!
//! Theory: docs/theory.md, section 4.5.

use super::operators::StripOperators;
use super::robin_correction::RobinCorrection;
use super::scratch::Scratch;
use super::stage_response::RANK;
use super::state_layout::{Carrier, Parts, add_products, carry, observe};
use super::step::OWN;
use super::step::StageWeights;
use super::{AMBIENT, BASE, CONTACT, StripHeat};
use crate::line::{BESIDE, Boundary, FACES, FaceInfluence, GAMMA, Stage, Surroundings};
use crate::reduced::Observation;
use numerics::dense;

impl StripHeat {
    /// Adds to the fluxes in `scratch.first` the deviation of the Robin correction at the start of the step from that
    /// of the first stage: it is linear in time like the fluxes of the contact, with the slope of the step before.
    pub(super) fn deviate_given_back(&self, scratch: &mut Scratch, state: &[f64]) {
        if let Some(robin_correction) = &self.operators.robin_correction {
            let (rates, _) = state[self.given_back()].split_at(RANK);
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
        if let Some(robin_correction) = &self.operators.robin_correction {
            scratch.projected[stage as usize] = self.project(robin_correction, scratch, levels[0]);
        }
        levels
    }

    /// Projected temperature that drives the Robin correction, from the amplitudes in the workspace and the temperature of the mean
    /// mode.
    fn project(&self, robin_correction: &RobinCorrection, scratch: &Scratch, level: f64) -> [f64; RANK] {
        let mut projected = robin_correction.project(&scratch.amplitude);
        projected[0] += robin_correction.unit[0] * level;
        projected
    }

    /// Adds the response of temperature and distortion to the fluxes `flux` of `stage` into the cells, with the Robin correction that they
    /// cause.
    pub(super) fn respond_to_flux(
        &self,
        stage: Stage,
        flux: &[f64],
        target: [Option<&mut [f64]>; 2],
        scratch: &mut Scratch,
    ) {
        let (operators, response) = (&*self.operators, self.step.stage(stage).current_response());
        operators.mirror(flux, &mut scratch.mirrored);
        let amounts = match &operators.robin_correction {
            Some(robin_correction) => robin_correction.amounts(response, &[0.0; RANK], &scratch.mirrored),
            None => [0.0; RANK],
        };
        for ((influence, lifted), target) in response.influence.iter().zip(response.lifted()).zip(target) {
            if let (Some(target), false) = (target, influence.is_empty()) {
                influence.respond(&scratch.mirrored, target);
                dense::multiply_add(lifted, &amounts[..operators.rank()], target);
            }
        }
    }

    /// Temperature and distortion on the cells by the amplitudes in the workspace and the levels of the mean mode.
    fn observe(
        &self,
        scratch: &mut Scratch,
        [level, through_depth]: [f64; 2],
        [temperature, distortion]: [&mut [f64]; 2],
    ) {
        let operators = &*self.operators;
        let Scratch { amplitude, moved, response, .. } = scratch;
        if operators.expands {
            let levels = [level, operators.mean_distortion * through_depth];
            operators.observe([amplitude, moved], response, levels, [temperature, distortion]);
        } else {
            temperature.fill(level);
            operators.add_modes(amplitude, &mut response[0], temperature);
            distortion.fill(0.0);
        }
    }

    /// Fills the workspace with the total fluxes into the cells at a stage: those of the contact, less the cooling that does not
    /// act there, plus the Robin correction from its stored projected temperature and the stage's own fluxes into the faces.
    pub(super) fn effective(&self, scratch: &mut Scratch, surroundings: &Surroundings, stage: Stage, flux: &[f64]) {
        let around = surroundings.at(stage);
        let Scratch { first, end, projected, returned, mirrored, .. } = scratch;
        let total = if stage == Stage::First { first } else { end };
        total.iter_mut().zip(flux).for_each(|(value, q)| *value = q - around.cooling);
        if let Some(robin_correction) = &self.operators.robin_correction {
            let level = self.level_by_faces(stage, around) - around.ambient;
            let known = robin_correction.above(&projected[stage as usize], level);
            self.operators.mirror(total, mirrored);
            let amounts = robin_correction.amounts(self.step.stage(stage).current_response(), &known, mirrored);
            robin_correction.lift(&amounts, total);
            returned[stage as usize] = amounts;
        }
    }

    /// Free response (temperature and distortion) of a stage, and the mean temperatures of the cooled faces; the flux known before
    /// the stage is in `scratch.first`, and the surroundings have no fluxes into the faces at the stage.
    pub(super) fn base_from(
        &self,
        scratch: &mut Scratch,
        state: &[f64],
        surroundings: &Surroundings,
        stage: Stage,
        [temperature, distortion]: [&mut [f64]; 2],
    ) -> [f64; FACES] {
        let operators = &*self.operators;
        let weights = self.step.stage(stage);
        let levels = self.known_levels(scratch, state, surroundings, stage);
        self.observe(scratch, levels, [&mut *temperature, &mut *distortion]);
        let mut own = 0.0;
        if let Some(robin_correction) = &operators.robin_correction {
            let known = robin_correction.above(&scratch.projected[stage as usize], -surroundings.at(stage).ambient);
            let response = weights.current_response();
            let amounts = robin_correction.solution(response, known.into_iter());
            own = robin_correction.unit[0] * amounts[0] / operators.length;
            for (lifted, target) in response.lifted().into_iter().zip([&mut *temperature, distortion]) {
                dense::multiply_add(lifted, &amounts[..robin_correction.rank], target);
            }
        }
        // On an open path the air acts on the material that arrives: the heat left behind does not return.
        let fluxes = [self.mean_flux(&scratch.first, 0.0), own].map(|flux| operators.remembered() * flux);
        let mean = &operators.mean;
        let states = self.mean_states(operators.background(state), surroundings, weights, fluxes);
        let around = surroundings.at(stage);
        let [everywhere, base] = [&mean.contact_temperature, &mean.base_temperature].map(|observed| {
            observed.of_states(&states, mean.count)
                + observed.direct[CONTACT] * fluxes[OWN]
                + observed.direct[AMBIENT] * around.ambient
                + observed.direct[BASE] * around.far
        });
        [self.beside(everywhere, dense::dot(&operators.widths, temperature)), base]
    }

    /// Mean temperature of the surface beside the contact, from that of the whole surface and the integral over the contact, K m.
    pub(super) fn beside(&self, everywhere: f64, under: f64) -> f64 {
        let operators = &*self.operators;
        let StripOperators { length, free_length, .. } = *operators;
        if operators.fresh.is_some() || free_length <= 1e-9 * length {
            return everywhere;
        }
        (length * everywhere - under) / free_length
    }

    /// Response of an observation of the mean mode to a unit flux of `stage` through a port.
    fn mean_response(&self, observed: &Observation, stage: Stage, port: usize) -> f64 {
        let (mean, weights) = (&self.operators.mean, &self.step.stage(stage).mean_weight);
        let by_states = (0..mean.count).map(|k| observed.states[k] * mean.input[port][k] * weights[k][OWN]);
        observed.direct[port] + by_states.sum::<f64>()
    }

    /// Temperature of the mean mode's surface by the fluxes of `stage` into the cooled faces.
    fn level_by_faces(&self, stage: Stage, around: &Boundary) -> f64 {
        let fluxes = [(CONTACT, around.cooling), (BASE, if self.operators.held { 0.0 } else { around.far })];
        let observed = &self.operators.mean.contact_temperature;
        let acting = fluxes.into_iter().filter(|(_, flux)| *flux != 0.0);
        acting.map(|(port, flux)| flux * self.mean_response(observed, stage, port)).sum()
    }

    /// See [`ThermalBody::face_influence`](crate::line::ThermalBody::face_influence). A flux into a face raises the whole surface, and acts
    /// on the cells by the flux that undoes the convection of this rise under the contact.
    pub(super) fn respond_to_face(
        &self,
        stage: Stage,
        face: usize,
        influence: &mut FaceInfluence,
        scratch: &mut Scratch,
    ) {
        let operators = &*self.operators;
        let (mean, convection) = (&operators.mean, operators.convection);
        let port = [CONTACT, BASE][face];
        let [level, through_depth] =
            [&mean.contact_temperature, &mean.mean_temperature].map(|seen| self.mean_response(seen, stage, port));
        // The cooling of the whole surface less that under the contact.
        let covered = if face == BESIDE { -1.0 } else { 0.0 };
        let FaceInfluence { temperature, distortion, by_cell, .. } = influence;
        // The response to a uniform unit flux into the cells, without its lagged part.
        by_cell.fill(1.0);
        temperature.fill(0.0);
        distortion.fill(0.0);
        self.respond_to_flux(stage, by_cell, [Some(temperature), Some(distortion)], scratch);
        let ([_, lagged], [.., own]) = (&self.step.feedthrough.at(stage).uniform, self.step.stage(stage).lag);
        distortion.iter_mut().zip(lagged).for_each(|(value, lagged)| *value -= own * lagged);
        let mut under = covered * self.mean_flux(by_cell, 0.0);
        let seen = [&mean.contact_temperature, &mean.base_temperature];
        let per_flux = operators.remembered() * self.mean_response(seen[face], stage, CONTACT) / operators.length;
        let mirrored = temperature.iter().rev().zip(&operators.widths);
        for (value, (response, width)) in by_cell.iter_mut().zip(mirrored) {
            // The integral over the contact of the response to this cell, by symmetry: see [`RobinCorrection::add_directly`].
            let integral = width * response;
            let rise = per_flux * (width + convection * integral);
            *value = if face == BESIDE { self.beside(rise, integral) } else { rise };
        }
        let by_level = covered + convection * level;
        let moved = if operators.expands { operators.mean_distortion * through_depth } else { 0.0 };
        temperature.iter_mut().for_each(|value| *value = level + by_level * *value);
        distortion.iter_mut().for_each(|value| *value = moved + by_level * *value);
        under += convection * self.mean_flux(temperature, 0.0);
        let entering = operators.remembered() * under;
        let whole = |observed| {
            self.mean_response(observed, stage, port) + entering * self.mean_response(observed, stage, CONTACT)
        };
        let [everywhere, base] = seen.map(whole);
        influence.mean = whole(&mean.mean_temperature);
        influence.faces = [self.beside(everywhere, dense::dot(&operators.widths, temperature)), base];
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
        self.effective(scratch, surroundings, Stage::End, contact[1]);
        let fluxes = [self.mean_flux(&scratch.first, 0.0), self.mean_flux(&scratch.end, 0.0)];
        self.keep_account(scratch, state, surroundings, contact, fluxes);
        if let Some(robin_correction) = &operators.robin_correction {
            let [first, end] = &scratch.returned;
            let (rates, levels) = state[self.given_back()].split_at_mut(RANK);
            let per_change = 1.0 / ((1.0 - GAMMA) * self.step.length);
            let changes = rates.iter_mut().zip(first.iter().zip(end));
            changes.for_each(|(rate, (first, end))| *rate = per_change * (end - first));
            let (ambient, levels) =
                (surroundings.end.ambient, levels.iter_mut().zip(end.iter().zip(&robin_correction.unit)));
            levels.for_each(|(level, (end, unit))| *level = end / operators.convection + unit * ambient);
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
    fn wave_amplitudes(&self, scratch: &mut Scratch, state: &[f64], weights: &StageWeights) {
        let operators = &*self.operators;
        let (re, im) = operators.wave_states(state);
        let [factor_re, factor_im] = &weights.factor;
        let seen = [&operators.temperature[..], &operators.distortion[..]];
        let sums = [&mut scratch.amplitude, &mut scratch.moved];
        observe(&operators.state_layout, [re, im], [factor_re, factor_im], seen, sums);
    }

    /// Adds the response of the modes to the flux known before the stage, its amplitudes in `scratch.heat`.
    fn add_known_flux(&self, scratch: &mut Scratch, weights: &StageWeights) {
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
