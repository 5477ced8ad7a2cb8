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

use super::workspace::{Memory, Workspace};
use super::{
    Account, Boundary, End, FACES, FaceInfluence, First, FrozenState, Observed, Stage, Step, SurfaceInfluence,
    Surroundings, ThermalBody,
};
use crate::properties::{Properties, Scales};
use nalgebra::DMatrix;
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

/// Number of these entries.
const ENTRIES: usize = Entry::Far as usize + 1;

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
    /// Memory for surface influence matrices.
    influence: SurfaceInfluence,
    /// Zero fluxes into the cells.
    no_flux: Vec<f64>,
}

/// The flux of the body of constants, in `own`.
fn scaled<'a>(own: &'a mut [f64], flux: &[f64], factor: f64) -> &'a [f64] {
    own.iter_mut().zip(flux).for_each(|(own, flux)| *own = factor * flux);
    own
}

impl PropertyBody {
    /// The body of constants `constant` with the properties `properties`; `held`: the temperature of its far face is prescribed.
    pub fn new(constant: Box<dyn ThermalBody>, properties: Properties, held: bool) -> PropertyBody {
        let (cells, states) = (constant.cells(), constant.states());
        let (mut uniform, nothing) = (vec![0.0; states], vec![0.0; states]);
        constant.uniform(1.0, &mut uniform);
        let capacity = constant.account(&uniform).stored - constant.account(&nothing).stored;
        uniform[constant.decay_rates(0.0).len()..].fill(0.0);
        let uniform_mean = constant.mean_temperature(&uniform);
        let zeros = || DMatrix::zeros(cells, cells);
        PropertyBody {
            properties: Arc::new(properties),
            capacity,
            uniform: Arc::new(uniform),
            uniform_mean,
            held,
            scales: Scales::ONE,
            reference: 0.0,
            influence: SurfaceInfluence { temperature: zeros(), distortion: zeros() },
            no_flux: vec![0.0; cells],
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

    /// An observation of the body of constants, in its own time.
    fn seen<T>(
        &self,
        at: &FrozenState,
        work: &mut Workspace,
        observe: impl FnOnce(&FrozenState, &mut Workspace) -> T,
    ) -> T {
        let (work, [own, _]) = work.scaled();
        let Scales { flux: factor, pace } = self.scales_of(at.state);
        let surroundings = &self.around(at.surroundings, factor);
        let (state, flux) = (self.split(at.state).0, scaled(own, at.flux, factor));
        observe(&FrozenState { state, surroundings, flux, velocity: at.velocity / pace }, work)
    }

    /// Properties at the mean temperature of a state; the constants before any step.
    fn scales_of(&self, state: &[f64]) -> Scales {
        let (own, behind) = self.split(state);
        let reference = behind[Entry::Reference as usize];
        if reference == 0.0 {
            return Scales::ONE;
        }
        self.scales_at(reference + self.constant.mean_temperature(own))
    }

    /// Completes a step from the temperature and the account before it.
    fn settle(&self, state: &mut [f64], before: Account, mean: f64) {
        let count = state.len() - ENTRIES;
        let (own, behind) = state.split_at_mut(count);
        let factor = self.scales.capacity();
        let after = self.constant.account(own);
        let (start, linear) = (self.reference + mean, self.constant.mean_temperature(own) - mean);
        // Beside a held face the account of constants counts part of the heat of a state as gone through that face at once
        // ([`crate::reduced::lagging`]): the temperature says what is stored, and the rest has passed the face.
        let taken = self.capacity * linear;
        let passed = (after.far - before.far) + (after.stored - before.stored - taken);
        let mass = self.capacity / self.properties.specific_heat();
        let more = (self.properties.table.rise_by(start, factor * taken / mass) - linear) / self.uniform_mean;
        own.iter_mut().zip(&*self.uniform).for_each(|(state, uniform)| *state += more * uniform);
        let rise = self.constant.mean_temperature(own) - mean;
        behind[Entry::Reference as usize] = self.reference;
        behind[Entry::Received as usize] += factor * (after.received - before.received);
        behind[Entry::Stored as usize] += mass * self.properties.table.heat_of_rise(start, rise);
        behind[Entry::Ambient as usize] += factor * (after.ambient - before.ambient);
        behind[Entry::Far as usize] += factor * passed;
    }
}

impl ThermalBody for PropertyBody {
    fn prepare(&mut self, step: &Step<'_>) {
        (self.scales, self.reference) = (step.scales, step.reference);
        let pace = self.scales.pace;
        let (length, velocity) = (step.length * pace, step.velocity.map(|velocity| velocity / pace));
        self.constant.prepare(&Step { length, velocity, ..*step });
    }

    fn influence(&mut self, stage: Stage) -> &SurfaceInfluence {
        let (of_constants, factor) = (self.constant.influence(stage), self.scales.flux);
        let SurfaceInfluence { temperature, distortion } = &mut self.influence;
        for (own, constant) in [(temperature, &of_constants.temperature), (distortion, &of_constants.distortion)] {
            own.iter_mut().zip(constant).for_each(|(own, constant)| *own = factor * constant);
        }
        &self.influence
    }

    fn respond(&self, stage: Stage, flux: &[f64], response: [Option<&mut [f64]>; 2], work: &mut Workspace) {
        let (work, [own, _]) = work.scaled();
        self.constant.respond(stage, scaled(own, flux, self.scales.flux), response, work);
    }

    fn face_influence(&self, stage: Stage, face: usize, influence: &mut FaceInfluence, work: &mut Workspace) {
        self.constant.face_influence(stage, face, influence, work.scaled().0);
        let factor = self.scales.flux;
        let FaceInfluence { temperature, distortion, faces, mean, by_cell } = influence;
        let numbers = temperature.iter_mut().chain(distortion).chain(faces).chain(by_cell).chain([mean]);
        numbers.for_each(|number| *number *= factor);
    }

    fn first(
        &self,
        state: &[f64],
        surroundings: &Surroundings,
        deviation: &[f64],
        response: [&mut [f64]; 2],
        work: &mut Workspace,
    ) -> First {
        let (work, [own, _]) = work.scaled();
        let factor = self.scales.flux;
        let around = self.around(surroundings, factor);
        self.constant.first(self.split(state).0, &around, scaled(own, deviation, factor), response, work)
    }

    fn end(
        &self,
        first: First,
        state: &[f64],
        surroundings: &Surroundings,
        flux: &[f64],
        response: [&mut [f64]; 2],
        work: &mut Workspace,
    ) -> End {
        let (work, [own, _]) = work.scaled();
        let factor = self.scales.flux;
        let around = self.around(surroundings, factor);
        self.constant.end(first, self.split(state).0, &around, scaled(own, flux, factor), response, work)
    }

    fn advance(
        &self,
        end: End,
        (before, after): (&[f64], &mut [f64]),
        surroundings: &Surroundings,
        [first, last]: [&[f64]; 2],
        work: &mut Workspace,
    ) {
        let (work, [of_first, of_end]) = work.scaled();
        let (own, behind) = self.split(before);
        let (account, mean) = (self.constant.account(own), self.constant.mean_temperature(own));
        let factor = self.scales.flux;
        let flux = [scaled(of_first, first, factor), scaled(of_end, last, factor)];
        let count = own.len();
        after[count..].copy_from_slice(behind);
        self.constant.advance(end, (own, &mut after[..count]), &self.around(surroundings, factor), flux, work);
        self.settle(after, account, mean);
    }

    fn expect(&self, velocity: f64) {
        self.constant.expect(velocity);
    }

    fn recur(&mut self, steps: usize) {
        self.constant.recur(steps);
    }

    fn boxed(&self) -> Box<dyn ThermalBody> {
        Box::new(self.clone())
    }
}

impl Observed for PropertyBody {
    fn cells(&self) -> usize {
        self.constant.cells()
    }

    fn states(&self) -> usize {
        self.constant.states() + ENTRIES
    }

    fn workspace(&self) -> Workspace {
        let zeros = || vec![0.0; self.constant.cells()];
        Workspace(Memory::Scaled(Box::new((self.constant.workspace(), [zeros(), zeros()]))))
    }

    fn uniform(&self, rise: f64, state: &mut [f64]) {
        let count = state.len() - ENTRIES;
        let (own, behind) = state.split_at_mut(count);
        self.constant.uniform(rise, own);
        behind.fill(0.0);
    }

    fn decay_rates(&self, velocity: f64) -> Vec<f64> {
        self.constant.decay_rates(velocity)
    }

    fn scales_at(&self, mean: f64) -> Scales {
        self.properties.at(self.properties.part(mean).0)
    }

    fn velocity_validity(&self) -> f64 {
        self.constant.velocity_validity()
    }

    fn divides_cells(&self) -> bool {
        self.constant.divides_cells()
    }

    fn temperature_at_frozen_state(&self, at: &FrozenState, temperature: &mut [f64], work: &mut Workspace) {
        self.seen(at, work, |at, work| self.constant.temperature_at_frozen_state(at, temperature, work));
    }

    fn distortion_at_frozen_state(&self, at: &FrozenState, distortion: &mut [f64], work: &mut Workspace) {
        self.seen(at, work, |at, work| self.constant.distortion_at_frozen_state(at, distortion, work));
    }

    fn cooled_temperature(&self, at: &FrozenState, work: &mut Workspace) -> [f64; FACES] {
        self.seen(at, work, |at, work| self.constant.cooled_temperature(at, work))
    }

    fn far_temperature(&self, state: &[f64], surroundings: &Surroundings, flux: &[f64]) -> f64 {
        let factor = self.scales_of(state).flux;
        let (own, around) = (self.split(state).0, self.around(surroundings, factor));
        // Linear in the flux.
        let [without, with] = [&self.no_flux, flux].map(|flux| self.constant.far_temperature(own, &around, flux));
        without + factor * (with - without)
    }

    fn flows(&self, state: &[f64], surroundings: &Surroundings, flux: &[f64]) -> [f64; 2] {
        let factor = self.scales_of(state).flux;
        let (own, around) = (self.split(state).0, self.around(surroundings, factor));
        let [without, with] = [&self.no_flux, flux].map(|flux| self.constant.flows(own, &around, flux));
        std::array::from_fn(|k| without[k] / factor + (with[k] - without[k]))
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

    fn error_of_the_mean(&self) -> f64 {
        self.constant.error_of_the_mean()
    }
}

#[cfg(test)]
mod tests {
    use super::super::strip::{Expansion, Resolution, SlidingPath, StripHeat, StripProperties};
    use super::super::tests::at_stage;
    use super::super::{GAMMA, SingleStep};
    use super::*;
    use crate::slab::Slab;
    use elasticity::{Base, Cells, Material};
    use scene::FarBoundary;

    const DENSITY: f64 = 7850.0;
    const HOT: [f64; 2] = [34.0, 690.0];
    const COLD: [f64; 2] = [53.0, 440.0];

    fn strip([conductivity, specific_heat]: [f64; 2], base: FarBoundary, cells: &Cells) -> Box<dyn ThermalBody> {
        let material = Material::new(2e11, 0.3).unwrap();
        let properties = StripProperties {
            expansion: Some(Expansion { material, coefficient: 1.2e-5, base: Base::Bonded }),
            ..StripProperties::bare(
                Slab::bare(0.01, [conductivity, DENSITY * specific_heat], base),
                SlidingPath::Closed(0.3),
            )
        };
        let resolution = Resolution { duration: 50.0, shortest: 0.05, travel: f64::INFINITY, tolerance: 1e-4 };
        Box::new(StripHeat::new(&properties, cells, &resolution).unwrap())
    }

    /// Under a moving contact: a strip with the properties of hot steel, and one of cold steel in its own time.
    #[test]
    fn in_its_own_time_a_body_is_the_one_with_these_properties() {
        let cells = Cells::uniform(0.02, 9).unwrap();
        for base in [FarBoundary::Insulated, FarBoundary::Held] {
            let held = base == FarBoundary::Held;
            let mut hot = strip(HOT, base, &cells);
            let uniform = Properties::uniform(HOT[0], HOT[1], COLD);
            let mut cold = PropertyBody::new(strip(COLD, base, &cells), uniform, held);
            cold.recur(4);
            let scales = cold.scales_at(500.0);
            let mut states = [vec![0.0; hot.states()], vec![0.0; cold.states()]];
            let around = Surroundings::default();
            for step in 0..40 {
                let length = [0.05, 0.2, 1.0][step % 3];
                let velocity = [0.3 + 0.01 * step as f64, 0.31 + 0.01 * step as f64];
                let flux = |part: f64| -> Vec<f64> {
                    let shape = |x: &f64| 1e6 * (1.0 + 30.0 * x + 0.02 * (step as f64 + part));
                    cells.centres().iter().map(shape).collect()
                };
                let [first, end] = [flux(GAMMA), flux(1.0)];
                let found = [hot.as_mut(), &mut cold as &mut dyn ThermalBody].into_iter().zip(&mut states).map(
                    |(body, state)| {
                        body.prepare(&Step { scales, reference: 300.0, ..Step::new(length, velocity) });
                        let found = at_stage(body, state, &around, (Stage::End, held), [&first, &end]);
                        body.step(state, &around, &first, &end);
                        found
                    },
                );
                let found: Vec<_> = found.collect();
                let most = |values: &[f64]| values.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
                for (one, other) in [(&found[0].0, &found[1].0), (&found[0].1, &found[1].1)] {
                    let error = one.iter().zip(other).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / most(one);
                    // Both are reduced to 1e-4 of the rise over the whole duration.
                    assert!(error < if step < 10 { 1e-2 } else { 1e-3 }, "{base:?} step {step}: {error:e}");
                }
                let [hot, cold] = [hot.mean_temperature(&states[0]), cold.mean_temperature(&states[1])];
                // Beside a held face the heat of a state counts as stored but for a part of 1e-4, see [`crate::reduced::lagging`].
                assert!(
                    (hot / cold - 1.0).abs() < if held { 1e-4 } else { 1e-6 },
                    "{base:?} step {step}: {hot} {cold}"
                );
            }
            let [one, other] = [hot.account(&states[0]), cold.account(&states[1])];
            for (one, other) in [(one.received, other.received), (one.stored, other.stored), (one.far, other.far)] {
                assert!(
                    (one - other).abs() < if held { 1e-4 } else { 1e-6 } * one.abs().max(1e-9 * other.abs()) + 1e-3,
                    "{base:?}: {one} {other}"
                );
            }
            let balance = other.received - other.stored - other.ambient - other.far;
            assert!(balance.abs() < 1e-12 * other.received, "{base:?}: {balance:e}");
            // What is seen between steps, under the flux and at the velocity of the last one.
            let flux: Vec<f64> = cells.centres().iter().map(|x| 1e6 * (1.0 + 30.0 * x + 0.02 * 40.0)).collect();
            let seen = |body: &dyn ThermalBody, state: &[f64]| {
                FrozenState { state, surroundings: &around, flux: &flux, velocity: 0.7 }.temperature(body)
            };
            let [one, other] = [seen(hot.as_ref(), &states[0]), seen(&cold, &states[1])];
            let error = one.iter().zip(&other).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / one[0];
            assert!(error < 1e-3, "{base:?}: {error:e}");
            let [one, other] = [hot.flows(&states[0], &around, &flux), cold.flows(&states[1], &around, &flux)];
            assert!((one[1] - other[1]).abs() < 1e-3 * one[1].abs() + 1e-3, "{base:?}: {one:?} {other:?}");
        }
    }
}
