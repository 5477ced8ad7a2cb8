//! A body whose conductivity and heat capacity follow its mean temperature, by a body of constants in a time of its own.
//!
//! See [`crate::properties`]: the step is multiplied by kd/kd0, the sliding velocity divided by it, and every flux multiplied by
//! K0/K, so that operators, states and their propagation are those of the constants. Properties are constant over parts of the temperature
//! between which neither changes by more than a hundredth ([`Properties::part`]), so that the operators of a step stay cached.
//!
//! The heat account is in joules: what the body of constants counts in its own time, times C/C0. The mean temperature after a step is
//! set to that by its enthalpy, with a uniform change of temperature. Stored is the enthalpy, so that the account closes to rounding
//! only if this has been done.
//!
//! Theory: docs/theory.md, section 4.15.

use super::contact_parts::ContactParts;
use super::{Account, Boundary, FACES, FaceInfluence, Stage, SurfaceInfluence, Surroundings, ThermalBody};
use crate::properties::{Properties, Scales};
use nalgebra::DMatrix;
use std::cell::RefCell;
use std::sync::Arc;

/// Entries of the state vector behind those of the body of constants: the absolute temperature of the reference (K; 0 before any step), and
/// the heat account, J/m.
#[derive(Clone, Copy)]
enum Entry {
    Reference,
    Received,
    Stored,
    Ambient,
    Far,
}

const ENTRIES: usize = 5;

/// See the module.
#[derive(Clone, Debug)]
pub struct PropertyBody {
    constant: Box<dyn ThermalBody>,
    properties: Arc<Properties>,
    /// Heat capacity of the whole body with the constants, J/(m K).
    capacity: f64,
    /// State of the body of constants at 1 K throughout, without account, and its mean temperature.
    uniform: Arc<Vec<f64>>,
    uniform_mean: f64,
    /// The temperature of the far face is prescribed.
    held: bool,
    /// Properties of the prepared step, and absolute temperature of the reference, K.
    scales: Scales,
    reference: f64,
    /// Surface influence matrices of both stages, through the parts in contact and through whole cells.
    influence: [SurfaceInfluence; 2],
    of_whole: [SurfaceInfluence; 2],
    /// Scaled fluxes.
    scratch: RefCell<[Vec<f64>; 2]>,
}

impl PropertyBody {
    /// The body of constants `constant` with the properties `properties`; `held`: the temperature of its far face is prescribed.
    pub fn new(constant: Box<dyn ThermalBody>, properties: Properties, held: bool) -> PropertyBody {
        let (cells, states) = (constant.cells(), constant.states());
        let (mut uniform, nothing) = (vec![0.0; states], vec![0.0; states]);
        constant.uniform(1.0, &mut uniform);
        let capacity = constant.account(&uniform).stored - constant.account(&nothing).stored;
        uniform[constant.decay_rates().len()..].fill(0.0);
        let uniform_mean = constant.mean_temperature(&uniform);
        let matrices = |count: usize| {
            let zeros = || DMatrix::zeros(count, count);
            SurfaceInfluence { temperature: zeros(), distortion: zeros() }
        };
        let divided = if constant.divides_cells() { cells } else { 0 };
        PropertyBody {
            properties: Arc::new(properties),
            capacity,
            uniform: Arc::new(uniform),
            uniform_mean,
            held,
            scales: Scales::ONE,
            reference: 0.0,
            influence: [matrices(cells), matrices(cells)],
            of_whole: [matrices(divided), matrices(divided)],
            scratch: RefCell::new([vec![0.0; cells], vec![0.0; cells]]),
            constant,
        }
    }

    /// Entries of the body of constants, and those behind them.
    fn split<'a>(&self, state: &'a [f64]) -> (&'a [f64], &'a [f64]) {
        state.split_at(state.len() - ENTRIES)
    }

    /// Boundary values in the time of the constants.
    fn boundary(&self, of: &Boundary, flux: f64) -> Boundary {
        Boundary {
            cooling: flux * of.cooling,
            ambient: of.ambient,
            far: if self.held { of.far } else { flux * of.far },
        }
    }

    fn around(&self, of: &Surroundings, flux: f64) -> Surroundings {
        Surroundings {
            deviation: self.boundary(&of.deviation, flux),
            first: self.boundary(&of.first, flux),
            end: self.boundary(&of.end, flux),
        }
    }

    fn scaled<'a>(&self, own: &'a mut Vec<f64>, flux: &[f64], factor: f64) -> &'a [f64] {
        own.iter_mut().zip(flux).for_each(|(own, flux)| *own = factor * flux);
        own
    }

    /// Properties at the mean temperature of a state; the constants before any step.
    fn scales_of(&self, state: &[f64]) -> Scales {
        let (own, behind) = self.split(state);
        let reference = behind[Entry::Reference as usize];
        if reference == 0.0 {
            return Scales::ONE;
        }
        self.properties.at(self.properties.part(reference + self.constant.mean_temperature(own)))
    }

    /// Scales the matrices of the prepared step.
    fn take_influence(&mut self) {
        let (factor, constant) = (self.scales.flux, &self.constant);
        let scale = |from: &SurfaceInfluence, to: &mut SurfaceInfluence| {
            for (from, to) in [(&from.temperature, &mut to.temperature), (&from.distortion, &mut to.distortion)] {
                to.as_mut_slice().iter_mut().zip(from.as_slice()).for_each(|(to, from)| *to = factor * from);
            }
        };
        for stage in [Stage::First, Stage::End] {
            scale(constant.influence(stage), &mut self.influence[stage as usize]);
            if constant.divides_cells() {
                scale(constant.influence_of_whole(stage), &mut self.of_whole[stage as usize]);
            }
        }
    }

    /// Completes a step from the temperature and the account before it.
    fn settle(&self, state: &mut [f64], before: Account, mean: f64) {
        let count = state.len() - ENTRIES;
        let (own, behind) = state.split_at_mut(count);
        let factor = self.scales.capacity();
        let after = self.constant.account(own);
        let (start, linear) = (self.reference + mean, self.reference + self.constant.mean_temperature(own));
        let taken = factor * (after.stored - before.stored);
        let mass = self.capacity / self.properties.specific_heat();
        let end = self.properties.table.after(start, taken / mass);
        let rise = (end - linear) / self.uniform_mean;
        own.iter_mut().zip(&*self.uniform).for_each(|(state, uniform)| *state += rise * uniform);
        let found = self.reference + self.constant.mean_temperature(own);
        behind[Entry::Reference as usize] = self.reference;
        behind[Entry::Received as usize] += factor * (after.received - before.received);
        behind[Entry::Stored as usize] += mass * self.properties.table.heat_between(start, found);
        behind[Entry::Ambient as usize] += factor * (after.ambient - before.ambient);
        behind[Entry::Far as usize] += factor * (after.far - before.far);
    }
}

impl ThermalBody for PropertyBody {
    fn cells(&self) -> usize {
        self.constant.cells()
    }

    fn states(&self) -> usize {
        self.constant.states() + ENTRIES
    }

    fn uniform(&self, rise: f64, state: &mut [f64]) {
        let count = state.len() - ENTRIES;
        let (own, behind) = state.split_at_mut(count);
        self.constant.uniform(rise, own);
        behind.fill(0.0);
    }

    fn decay_rates(&self) -> Vec<f64> {
        self.constant.decay_rates()
    }

    fn decay_rates_while_sliding(&self, velocity: f64) -> Vec<f64> {
        self.constant.decay_rates_while_sliding(velocity)
    }

    fn velocity_validity(&self) -> f64 {
        self.scales.pace * self.constant.velocity_validity()
    }

    fn divides_cells(&self) -> bool {
        self.constant.divides_cells()
    }

    fn set_contact_parts(&mut self, contact_parts: [&ContactParts; 2]) {
        self.constant.set_contact_parts(contact_parts);
    }

    fn set_temperature(&mut self, mean: f64, reference: f64) -> Scales {
        self.reference = reference;
        self.scales = self.properties.at(self.properties.part(mean));
        self.scales
    }

    fn prepare(&mut self, step: f64, velocity: [f64; 2]) {
        let pace = self.scales.pace;
        self.constant.prepare(step * pace, velocity.map(|velocity| velocity / pace));
        self.take_influence();
    }

    fn influence(&self, stage: Stage) -> &SurfaceInfluence {
        &self.influence[stage as usize]
    }

    fn influence_of_whole(&self, stage: Stage) -> &SurfaceInfluence {
        if self.constant.divides_cells() { &self.of_whole[stage as usize] } else { self.influence(stage) }
    }

    fn face_influence(&self, stage: Stage, face: usize, influence: &mut FaceInfluence) {
        self.constant.face_influence(stage, face, influence);
        let factor = self.scales.flux;
        let FaceInfluence { temperature, distortion, faces, mean, by_cell } = influence;
        let numbers = temperature.iter_mut().chain(distortion).chain(faces).chain(by_cell).chain([mean]);
        numbers.for_each(|number| *number *= factor);
    }

    fn free_response(
        &self,
        state: &[f64],
        surroundings: &Surroundings,
        stage: Stage,
        known: &[f64],
        temperature: &mut [f64],
        distortion: &mut [f64],
    ) -> [f64; FACES] {
        let [own, _] = &mut *self.scratch.borrow_mut();
        let (factor, state) = (self.scales.flux, self.split(state).0);
        let known = self.scaled(own, known, factor);
        self.constant.free_response(state, &self.around(surroundings, factor), stage, known, temperature, distortion)
    }

    fn free_response_at_end(
        &self,
        state: &[f64],
        surroundings: &Surroundings,
        known: &[f64],
        temperature: &mut [f64],
        distortion: &mut [f64],
    ) -> [f64; FACES] {
        let [own, _] = &mut *self.scratch.borrow_mut();
        let (factor, state) = (self.scales.flux, self.split(state).0);
        let known = self.scaled(own, known, factor);
        self.constant.free_response_at_end(state, &self.around(surroundings, factor), known, temperature, distortion)
    }

    fn advance(&self, state: &mut [f64], surroundings: &Surroundings, first: &[f64], end: &[f64]) {
        let count = state.len() - ENTRIES;
        let (before, mean) = (self.constant.account(&state[..count]), self.constant.mean_temperature(&state[..count]));
        {
            let [own_first, own_end] = &mut *self.scratch.borrow_mut();
            let factor = self.scales.flux;
            let around = self.around(surroundings, factor);
            let fluxes = (self.scaled(own_first, first, factor), self.scaled(own_end, end, factor));
            self.constant.advance(&mut state[..count], &around, fluxes.0, fluxes.1);
        }
        self.settle(state, before, mean);
    }

    fn advance_from_end(&self, state: &mut [f64], surroundings: &Surroundings, first: &[f64], end: &[f64]) {
        let count = state.len() - ENTRIES;
        let (before, mean) = (self.constant.account(&state[..count]), self.constant.mean_temperature(&state[..count]));
        {
            let [own_first, own_end] = &mut *self.scratch.borrow_mut();
            let factor = self.scales.flux;
            let around = self.around(surroundings, factor);
            let fluxes = (self.scaled(own_first, first, factor), self.scaled(own_end, end, factor));
            self.constant.advance_from_end(&mut state[..count], &around, fluxes.0, fluxes.1);
        }
        self.settle(state, before, mean);
    }

    fn advance_to(&self, before: &[f64], after: &mut [f64], surroundings: &Surroundings, first: &[f64], end: &[f64]) {
        let count = before.len() - ENTRIES;
        let (account, mean) =
            (self.constant.account(&before[..count]), self.constant.mean_temperature(&before[..count]));
        after[count..].copy_from_slice(&before[count..]);
        {
            let [own_first, own_end] = &mut *self.scratch.borrow_mut();
            let factor = self.scales.flux;
            let around = self.around(surroundings, factor);
            let fluxes = (self.scaled(own_first, first, factor), self.scaled(own_end, end, factor));
            self.constant.advance_to(&before[..count], &mut after[..count], &around, fluxes.0, fluxes.1);
        }
        self.settle(after, account, mean);
    }

    fn temperature_at_frozen_state(
        &self,
        state: &[f64],
        surroundings: &Surroundings,
        flux: &[f64],
        velocity: f64,
        temperature: &mut [f64],
    ) {
        let [own, _] = &mut *self.scratch.borrow_mut();
        let Scales { flux: factor, pace } = self.scales_of(state);
        let (around, flux) = (self.around(surroundings, factor), self.scaled(own, flux, factor));
        self.constant.temperature_at_frozen_state(self.split(state).0, &around, flux, velocity / pace, temperature);
    }

    fn distortion_at_frozen_state(
        &self,
        state: &[f64],
        surroundings: &Surroundings,
        flux: &[f64],
        velocity: f64,
        distortion: &mut [f64],
    ) {
        let [own, _] = &mut *self.scratch.borrow_mut();
        let Scales { flux: factor, pace } = self.scales_of(state);
        let (around, flux) = (self.around(surroundings, factor), self.scaled(own, flux, factor));
        self.constant.distortion_at_frozen_state(self.split(state).0, &around, flux, velocity / pace, distortion);
    }

    fn cooled_temperature(
        &self,
        state: &[f64],
        surroundings: &Surroundings,
        flux: &[f64],
        velocity: f64,
    ) -> [f64; FACES] {
        let [own, _] = &mut *self.scratch.borrow_mut();
        let Scales { flux: factor, pace } = self.scales_of(state);
        let (around, flux) = (self.around(surroundings, factor), self.scaled(own, flux, factor));
        self.constant.cooled_temperature(self.split(state).0, &around, flux, velocity / pace)
    }

    fn flows(&self, state: &[f64], surroundings: &Surroundings, flux: &[f64]) -> [f64; 2] {
        let [own, _] = &mut *self.scratch.borrow_mut();
        let factor = self.scales_of(state).flux;
        let (around, flux) = (self.around(surroundings, factor), self.scaled(own, flux, factor));
        self.constant.flows(self.split(state).0, &around, flux).map(|flow| flow / factor)
    }

    fn mean_temperature(&self, state: &[f64]) -> f64 {
        self.constant.mean_temperature(self.split(state).0)
    }

    fn account(&self, state: &[f64]) -> Account {
        let behind = self.split(state).1;
        let [received, stored, ambient, far] =
            [Entry::Received, Entry::Stored, Entry::Ambient, Entry::Far].map(|entry| behind[entry as usize]);
        Account { received, stored, ambient, far }
    }

    fn error(&self) -> f64 {
        self.constant.error()
    }

    fn error_of_the_mean(&self) -> f64 {
        self.constant.error_of_the_mean()
    }

    fn boxed(&self) -> Box<dyn ThermalBody> {
        Box::new(self.clone())
    }
}
