//! Conduction in a strip under a sliding contact: Fourier modes along the path, each reduced through the depth.
//!
//! On a closed path, or in a cell around the stroke of a straight one, the temperature is a sum over wave numbers
//! `q = 2 pi n/L` in the punch's frame. Each Fourier mode is a one-dimensional conduction problem ([`depth`]) whose
//! states decay and rotate in phase,
//!
//! ```text
//! dx_k/dt = (-rate_k + i q v) x_k + b_k f_q(t),     T_i = sum over q of weight_q Re [exp(iq x_i) sum b_k x_k]
//! ```
//!
//! There is no advection to stabilise at any Peclet number, and for fluxes and velocities linear in time the states are
//! propagated exactly ([`propagate`]). Only modes whose decay is slow against the shortest resolved step have states;
//! fast phase rotation is not decay. The rest is direct feedthrough, a matrix that depends on the velocity
//! ([`static_correction`]), so that steady sliding is exact for every velocity and every cell, however small. What it adds to the
//! distortion acts on a flux with a lag: heat has to enter before it expands.
//!
//! On an open path, or one too long for its harmonics, the contact meets fresh material: the wave numbers are the odd
//! multiples of pi/L, heat left behind is dropped before it returns with a periodic image ([`fresh`]), and the direct
//! feedthrough makes the steady response that of the endless path, from the moving source in real space.
//!
//! Heat transfer on the top acts on the whole surface in the modes; the Robin correction under the contact cancels it
//! there by fluxes ([`robin_correction`]).
//!
//! Theory: docs/theory.md, section 4.5.

mod account;
mod amplitudes;
mod depth;
mod distance;
mod error_sweep;
mod feedthrough;
mod fresh;
mod interval;
mod mirrored;
mod moving_kernel;
mod nodes;
mod operators;
mod passive;
mod propagate;
mod properties;
mod reduction;
mod robin_correction;
mod scratch;
mod stage_response;
mod state_layout;
mod static_correction;
mod step;
#[cfg(test)]
pub(super) mod tests;
mod velocity_table;
mod waves;

pub use depth::dilatation;
pub use depth::{Depth, Expansion};
pub use properties::{Resolution, SlidingPath, StripProperties};
pub use reduction::Reductions;

use super::workspace::Memory;
use super::{
    Account, End, FACES, FaceInfluence, First, FrozenState, Observed, Stage, Step, SurfaceInfluence, Surroundings,
    ThermalBody, Workspace,
};
use crate::reduced::{MAX_STATES, Observation, Port};
use elasticity::{Cells, OutOfRange};
use numerics::dense;
use operators::StripOperators;
pub(super) use scratch::Scratch;
use stage_response::RANK;
use std::sync::Arc;
use step::{OWN, PreparedStep, StageWeights};

const CONTACT: usize = Port::Contact as usize;
const AMBIENT: usize = Port::Ambient as usize;
const BASE: usize = Port::Base as usize;

/// State entries after those of the modes: heat received, lost to the air, lost through the base (J/m), temperature of
/// the base.
const TAIL: usize = 4;

/// Thermal body of a strip, on the cells of the contact.
#[derive(Debug)]
pub struct StripHeat {
    operators: Arc<StripOperators>,
    step: PreparedStep,
}

impl Clone for StripHeat {
    fn clone(&self) -> Self {
        // Before the first step there is nothing to copy: zero pages of the operating system are not touched until they
        // are used.
        let step = if self.step.length.is_nan() { PreparedStep::new(&self.operators) } else { self.step.clone() };
        StripHeat { operators: self.operators.clone(), step }
    }
}

impl StripHeat {
    /// Builds the strip under the given cells.
    ///
    /// # Errors
    /// A property outside its range, named with its limit.
    pub fn new(properties: &StripProperties, cells: &Cells, resolution: &Resolution) -> Result<Self, OutOfRange> {
        Self::among(&mut Reductions::default(), properties, cells, resolution)
    }

    /// [`Self::new`], whose reduction is one of those `known`, which it joins.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn among(
        known: &mut Reductions,
        properties: &StripProperties,
        cells: &Cells,
        resolution: &Resolution,
    ) -> Result<Self, OutOfRange> {
        let operators = StripOperators::new(properties, cells, resolution, known)?;
        let step = PreparedStep::new(&operators);
        Ok(StripHeat { operators: Arc::new(operators), step })
    }

    /// Place of the lagged fluxes in the state.
    fn lagged(&self) -> std::ops::Range<usize> {
        let first = self.operators.mean_states() + self.operators.stretches();
        first..first + self.operators.lagged()
    }

    /// Adds the distortion that the modes leave out at a stage without its own flux; `known`: the flux before the stage.
    fn add_lagged(&self, stage: Stage, state: &[f64], known: &[f64], scratch: &mut Scratch, distortion: &mut [f64]) {
        if !self.operators.expands {
            return;
        }
        let [factor, known_weight, _] = self.step.stage(stage).lag;
        let fluxes = state[self.lagged()].iter().zip(known);
        for (lagged, (before, known)) in scratch.seen.iter_mut().zip(fluxes) {
            *lagged = factor * before + known_weight * known;
        }
        self.operators.mirror(&scratch.seen, &mut scratch.mirrored);
        let [_, influence] = &self.step.feedthrough.at(stage).influence;
        influence.respond(&scratch.mirrored, distortion);
    }

    /// Place of the Robin correction in the state: its rates of change over the last step, W/(m2 s) by polynomial, and the
    /// projected temperature that drives it.
    fn given_back(&self) -> std::ops::Range<usize> {
        let first = self.lagged().end;
        first..first + self.operators.robin_correction.as_ref().map_or(0, |_| 2 * RANK)
    }

    /// Number of Fourier modes, and of interpolation nodes in the velocity table.
    pub fn size(&self) -> (usize, usize) {
        (self.operators.waves.len(), self.operators.table.nodes())
    }

    /// Length of the path, or of the period of an open one, m.
    pub fn length(&self) -> f64 {
        self.operators.length
    }

    /// Mean flux over the path, W/m2, from fluxes into the cells and a cooling flux on the whole surface.
    fn mean_flux(&self, flux: &[f64], cooling: f64) -> f64 {
        let operators = &*self.operators;
        dense::dot(flux, &operators.widths) / operators.length + cooling
    }

    /// Surface temperature of the mean mode, and its mean temperature through the depth, at a stage with the means of
    /// the known flux and of the stage's own.
    fn mean_levels(
        &self,
        state: &[f64],
        surroundings: &Surroundings,
        weights: &StageWeights,
        fluxes: [f64; 2],
    ) -> [f64; 2] {
        let mean = &self.operators.mean;
        let fluxes = fluxes.map(|flux| self.operators.remembered() * flux);
        let states = self.mean_states(self.operators.background(state), surroundings, weights, fluxes);
        let around = surroundings.at(weights.stage());
        [&mean.contact_temperature, &mean.mean_temperature].map(|observed| {
            observed.of_states(&states, mean.count)
                + observed.direct[CONTACT] * (fluxes[OWN] + around.cooling)
                + observed.direct[AMBIENT] * around.ambient
                + observed.direct[BASE] * around.far
        })
    }

    /// States of the mean mode at a stage.
    fn mean_states(
        &self,
        state: &[f64],
        surroundings: &Surroundings,
        weights: &StageWeights,
        fluxes: [f64; 2],
    ) -> [f64; MAX_STATES] {
        let mean = &self.operators.mean;
        let (before, now) = (surroundings.known(weights.stage()), surroundings.at(weights.stage()));
        let mut states = [0.0; MAX_STATES];
        for (k, value) in states.iter_mut().enumerate().take(mean.count) {
            let [known, own] = weights.mean_weight[k];
            *value = weights.mean_factor[k] * state[k]
                + mean.input[CONTACT][k] * (known * (fluxes[0] + before.cooling) + own * (fluxes[1] + now.cooling))
                + mean.input[AMBIENT][k] * (known * before.ambient + own * now.ambient)
                + mean.input[BASE][k] * (known * before.far + own * now.far);
        }
        states
    }

    /// Mean flux into the surface of the period at frozen state (contact, cooling beside it, Robin correction), and the
    /// Robin correction alone, W/m2 of contact.
    fn held_fluxes(&self, state: &[f64], surroundings: &Surroundings, flux: &[f64]) -> [f64; 2] {
        let operators = &*self.operators;
        let given = self.mean_flux(flux, self.free_cooling(surroundings));
        let Some(robin_correction) = &operators.robin_correction else { return [given, 0.0] };
        let covered = 1.0 - operators.free_length / operators.length;
        let returned = self.held_amounts(state, surroundings)[0] / robin_correction.unit[0];
        [given + covered * returned, returned]
    }

    /// Polynomial coefficients of the Robin correction at frozen state, W/m2.
    fn held_amounts(&self, state: &[f64], surroundings: &Surroundings) -> [f64; RANK] {
        let mut amounts = [0.0; RANK];
        if let Some(robin_correction) = &self.operators.robin_correction {
            let levels = state[self.given_back()][RANK..].iter().zip(&robin_correction.unit);
            for (amount, (level, unit)) in amounts.iter_mut().zip(levels) {
                *amount = self.operators.convection * (level - unit * surroundings.end.ambient);
            }
        }
        amounts
    }

    /// Observation of the mean mode under the contact at frozen state: on an open path without the heat that the
    /// contact left behind.
    fn held_background(&self, observed: &Observation, state: &[f64], surroundings: &Surroundings, flux: f64) -> f64 {
        let seen = if self.operators.remembers { flux } else { surroundings.end.cooling };
        self.held_observation(observed, self.operators.background(state), surroundings, seen)
    }

    /// An observation of the mean mode at frozen state and a given mean flux.
    fn held_observation(&self, observed: &Observation, state: &[f64], surroundings: &Surroundings, flux: f64) -> f64 {
        let count = self.operators.mean.count;
        observed.of_states(&padded(state, count), count)
            + observed.direct[CONTACT] * flux
            + observed.direct[AMBIENT] * surroundings.end.ambient
            + observed.direct[BASE] * surroundings.end.far
    }

    /// Cooling flux on the free surface as a mean over the period.
    fn free_cooling(&self, surroundings: &Surroundings) -> f64 {
        surroundings.end.cooling * self.operators.free_length / self.operators.length
    }
}

/// States of the mean mode, padded to the size that the observations of reduced bodies take.
fn padded(state: &[f64], count: usize) -> [f64; MAX_STATES] {
    let mut states = [0.0; MAX_STATES];
    states[..count].copy_from_slice(&state[..count]);
    states
}

impl ThermalBody for StripHeat {
    fn prepare(&mut self, step: &Step<'_>) {
        self.step.prepare(&self.operators, step.length, step.velocity);
    }

    fn influence(&mut self, stage: Stage) -> &SurfaceInfluence {
        self.step.influence(&self.operators, stage)
    }

    fn respond(&self, stage: Stage, flux: &[f64], response: [Option<&mut [f64]>; 2], work: &mut Workspace) {
        self.respond_to_flux(stage, flux, response, work.strip());
    }

    fn face_influence(&self, stage: Stage, face: usize, influence: &mut FaceInfluence, work: &mut Workspace) {
        self.respond_to_face(stage, face, influence, work.strip());
    }

    fn first(
        &self,
        state: &[f64],
        surroundings: &Surroundings,
        deviation: &[f64],
        [temperature, distortion]: [&mut [f64]; 2],
        work: &mut Workspace,
    ) -> First {
        let (scratch, cooling) = (work.strip(), surroundings.deviation.cooling);
        scratch.first.iter_mut().zip(deviation).for_each(|(value, deviation)| *value = deviation - cooling);
        self.deviate_given_back(scratch, state);
        let around = surroundings.without_fluxes_at(Stage::First, self.operators.held);
        let faces = self.base_from(scratch, state, &around, Stage::First, [temperature, &mut *distortion]);
        self.add_lagged(Stage::First, state, deviation, scratch, distortion);
        First { faces }
    }

    fn end(
        &self,
        _first: First,
        state: &[f64],
        surroundings: &Surroundings,
        flux: &[f64],
        [temperature, distortion]: [&mut [f64]; 2],
        work: &mut Workspace,
    ) -> End {
        let scratch = work.strip();
        self.effective(scratch, surroundings, Stage::First, flux);
        let around = surroundings.without_fluxes_at(Stage::End, self.operators.held);
        let faces = self.base_from(scratch, state, &around, Stage::End, [temperature, &mut *distortion]);
        self.add_lagged(Stage::End, state, flux, scratch, distortion);
        End { faces }
    }

    fn advance(
        &self,
        _end: End,
        (before, after): (&[f64], &mut [f64]),
        surroundings: &Surroundings,
        flux: [&[f64]; 2],
        work: &mut Workspace,
    ) {
        let operators = &*self.operators;
        let (mean, tail) = (operators.mean_states(), self.given_back().start);
        after[..mean].copy_from_slice(&before[..mean]);
        after[tail..].copy_from_slice(&before[tail..]);
        let (re, im) = operators.wave_states(before);
        self.advance_by(work.strip(), [re, im], after, surroundings, flux);
        let ([factor, known, own], lagged) = (self.step.end.lag, self.lagged());
        let fluxes = before[lagged.clone()].iter().zip(flux[0].iter().zip(flux[1]));
        for (after, (before, (first, end))) in after[lagged].iter_mut().zip(fluxes) {
            *after = factor * before + known * first + own * end;
        }
        self.leave_behind(before, after);
    }

    fn expect(&self, velocity: f64) {
        self.operators.table.expect(velocity);
    }

    fn recur(&mut self, steps: usize) {
        self.step = PreparedStep::keeping(&self.operators, steps, true);
    }

    fn boxed(&self) -> Box<dyn ThermalBody> {
        Box::new(self.clone())
    }
}

impl Observed for StripHeat {
    fn cells(&self) -> usize {
        self.operators.widths.len()
    }

    fn states(&self) -> usize {
        self.given_back().end + TAIL
    }

    fn workspace(&self) -> Workspace {
        Workspace(Memory::Strip(Box::new(Scratch::new(&self.operators))))
    }

    fn uniform(&self, rise: f64, state: &mut [f64]) {
        state.fill(0.0);
        let mean = &self.operators.mean;
        for k in 0..self.operators.mean_states() {
            state[k] = mean.uniform[k % mean.count] * rise;
        }
        // The heat balance starts from states of 0, so the initial heat is booked as received through the contact.
        if let Some(robin_correction) = &self.operators.robin_correction {
            let levels = state[self.given_back()][RANK..].iter_mut().zip(&robin_correction.unit);
            levels.for_each(|(level, unit)| *level = unit * rise);
        }
        let tail = state.len() - TAIL;
        if self.operators.held {
            state[tail + 3] = rise;
        }
        state[tail] = self.account(state).stored;
    }

    fn decay_rates(&self, _velocity: f64) -> Vec<f64> {
        let operators = &*self.operators;
        let mean = (0..operators.mean_states()).map(|k| operators.mean.rate[k % operators.mean.count]);
        mean.chain(operators.rate.iter().chain(&operators.rate).copied()).collect()
    }

    fn velocity_validity(&self) -> f64 {
        let operators = &*self.operators;
        // Feedthrough of the modes without states: q v against diffusivity q^2.
        let shortest = operators.numbers.last().copied().unwrap_or(f64::INFINITY);
        // Peclet number v/(kd q) of the largest wave number with states up to which the direct feedthrough is nearly independent of the
        // velocity.
        10.0 * operators.diffusivity * shortest
    }

    fn temperature_at_frozen_state(&self, at: &FrozenState, temperature: &mut [f64], work: &mut Workspace) {
        let FrozenState { state, surroundings, flux, velocity } = *at;
        let operators = &*self.operators;
        let scratch = work.strip();
        self.held_amplitudes(scratch, state, false);
        let [entering, _] = self.held_fluxes(state, surroundings, flux);
        let level = self.held_background(&operators.mean.contact_temperature, state, surroundings, entering);
        let Scratch { amplitude, response, total, mirrored, frozen: [frozen, _], .. } = &mut *scratch;
        temperature.fill(level);
        operators.add_modes(amplitude, &mut response[0], temperature);
        operators.table.respond(0, velocity, frozen);
        total.iter_mut().zip(flux).for_each(|(total, flux)| *total = flux - surroundings.end.cooling);
        if let Some(robin_correction) = &operators.robin_correction {
            robin_correction.lift(&self.held_amounts(state, surroundings), total);
        }
        operators.mirror(total, mirrored);
        frozen.respond(mirrored, temperature);
    }

    fn distortion_at_frozen_state(&self, at: &FrozenState, distortion: &mut [f64], work: &mut Workspace) {
        let FrozenState { state, surroundings, flux, velocity } = *at;
        let operators = &*self.operators;
        distortion.fill(0.0);
        if !operators.expands {
            return;
        }
        let scratch = work.strip();
        self.held_amplitudes(scratch, state, true);
        let [entering, _] = self.held_fluxes(state, surroundings, flux);
        let level = self.held_background(&operators.mean.mean_temperature, state, surroundings, entering);
        let Scratch { moved, response, mirrored, frozen: [_, frozen], .. } = &mut *scratch;
        distortion.fill(operators.mean_distortion * level);
        operators.add_modes(moved, &mut response[0], distortion);
        operators.table.respond(1, velocity, frozen);
        operators.mirror(&state[self.lagged()], mirrored);
        frozen.respond(mirrored, distortion);
    }

    fn cooled_temperature(&self, at: &FrozenState, work: &mut Workspace) -> [f64; FACES] {
        let FrozenState { state, surroundings, flux, .. } = *at;
        let [entering, _] = self.held_fluxes(state, surroundings, flux);
        let surface = &self.operators.mean.contact_temperature;
        let everywhere = self.held_background(surface, state, surroundings, entering);
        let mut seen = std::mem::take(&mut work.strip().seen);
        self.temperature_at_frozen_state(at, &mut seen, work);
        let beside = self.beside(everywhere, dense::dot(&self.operators.widths, &seen));
        work.strip().seen = seen;
        [beside, self.far_temperature(state, surroundings, flux)]
    }

    fn far_temperature(&self, state: &[f64], surroundings: &Surroundings, flux: &[f64]) -> f64 {
        let [entering, _] = self.held_fluxes(state, surroundings, flux);
        self.held_background(&self.operators.mean.base_temperature, state, surroundings, entering)
    }

    fn flows(&self, state: &[f64], surroundings: &Surroundings, flux: &[f64]) -> [f64; 2] {
        let operators = &*self.operators;
        let mean = &operators.mean;
        let [entering, returned] = self.held_fluxes(state, surroundings, flux);
        let flow = |observed| operators.length * self.held_observation(observed, state, surroundings, entering);
        let width = operators.length - operators.free_length;
        [flow(&mean.ambient_flow) - width * returned, flow(&mean.base_flow)]
    }

    fn mean_temperature(&self, state: &[f64]) -> f64 {
        let mean = &self.operators.mean;
        mean.mean_temperature.of_states(&padded(state, mean.count), mean.count)
            + mean.mean_temperature.direct[BASE] * state[state.len() - TAIL + 3]
    }

    fn account(&self, state: &[f64]) -> Account {
        let mean = &self.operators.mean;
        let tail = &state[state.len() - TAIL..];
        let by_base = mean.stored.direct[BASE] * tail[3];
        let stored = self.operators.length * (mean.stored.of_states(&padded(state, mean.count), mean.count) + by_base);
        Account { received: tail[0], stored, ambient: tail[1], far: tail[2] }
    }

    fn error_of_the_mean(&self) -> f64 {
        self.operators.error
    }
}
