//! Mate of an annular contact that covers a part of the circle: a ring at the circumferential mean temperature, plus the
//! local excess temperature under the contact.
//!
//! ```text
//! T_i = (ring)_i + sum_k x_ik,    dx_ik/dt = -[lambda_k + sigma(rho_i^2 v)]/rho_i^2 x_ik + r_k/rho_i q_i,   rho_i = r_i/r_m
//! ```
//!
//! The ring ([`super::punch::mate`]) conducts along the radius. The moving source acts at each radius independently, with
//! the decays of the lumped level at the mean radius ([`Flash`]), by similarity: a contact on an arc of rho times the
//! length, at rho times the speed, heats a half-space like the one at the mean radius at rho^2 times the speed, with rho
//! times the temperature per flux and rho^2 times the time scale. Exact at the mean radius; elsewhere where the heat under
//! the contact does not reach the base during the transit of the contact.
//!
//! Over a stage of the length L in which the speed changes, the initial state decays by the mean of its rate, and the flux
//! is weighted as at the constant rate `rate(end) - 1/2 (change of the rate) m_2/m_1` with the moments `m_n` of
//! `y^n exp(-rate L y)` from 0 to 1: second order in steps that are short against the decay time as well as in long ones.
//!
//! The excess temperature does not distort the surface: along the circumference the material expands where it is heated and
//! contracts where it is not, and the mean of that over the contact is the mean over the circle.
//!
//! Theory: docs/theory.md, section 4.7.

use super::reduced::{ReducedHeat, first_moment, mean_decay};
use super::{
    Account, End, FACES, FaceInfluence, First, FrozenState, GAMMA, Observed, Stage, Step, SurfaceInfluence,
    Surroundings, ThermalBody, Workspace,
};
use crate::flash::{Flash, MAX_FLASH_STATES};
use nalgebra::DMatrix;
use numerics::cache::KeyedCache;
use std::sync::Arc;

/// Moving source of a scene at every cell.
#[derive(Debug)]
struct Source {
    flash: Flash,
    /// rho, relative radius of the cells.
    ratio: Vec<f64>,
}

/// Weights of one state at a stage; see [`super::reduced`].
#[derive(Clone, Copy, Debug, Default)]
struct Weights {
    decay: f64,
    /// Weight of the known flux times the residue, K m2/W.
    known: f64,
    own: f64,
}

/// Mate of an annular contact, with the weights of the prepared step.
#[derive(Clone, Debug)]
pub struct DiscHeat {
    ring: ReducedHeat,
    source: Arc<Source>,
    /// Of the states of the source at both stages, by the bits of step and velocities.
    stages: KeyedCache<[u64; 3], [Vec<Weights>; 2]>,
    /// Memory for surface influence matrices.
    influence: SurfaceInfluence,
}

impl DiscHeat {
    /// The ring, and the moving source at cells of the relative radii `ratio`.
    pub fn new(ring: ReducedHeat, flash: Flash, ratio: Vec<f64>) -> DiscHeat {
        let count = ratio.len();
        let zeros = || DMatrix::zeros(count, count);
        let stage = || vec![Weights::default(); count * MAX_FLASH_STATES];
        DiscHeat {
            ring,
            source: Arc::new(Source { flash, ratio }),
            stages: KeyedCache::new([[stage(), stage()]]),
            influence: SurfaceInfluence { temperature: zeros(), distortion: zeros() },
        }
    }

    fn weights(&self, stage: Stage) -> &[Weights] {
        &self.stages.latest().expect("prepare comes before any step")[stage as usize]
    }

    /// State of the ring with its heat account, and state of the source, which is stored first.
    fn split<'a>(&self, state: &'a [f64]) -> (&'a [f64], &'a [f64]) {
        let (source, ring) = state.split_at(self.source_states());
        (ring, source)
    }

    /// Temperature of a cell by the flux of `stage` into it, through the source, K m2/W.
    fn own(&self, stage: Stage, cell: usize) -> f64 {
        let weights = &self.weights(stage)[cell * MAX_FLASH_STATES..(cell + 1) * MAX_FLASH_STATES];
        weights.iter().map(|weights| weights.own).sum()
    }

    fn source_states(&self) -> usize {
        self.source.ratio.len() * MAX_FLASH_STATES
    }

    /// Adds the temperatures of the source's states to those of the cells.
    fn add(temperature: &mut [f64], values: impl Iterator<Item = f64>) {
        for (i, value) in values.enumerate() {
            temperature[i / MAX_FLASH_STATES] += value;
        }
    }
}

/// Weights of both stages of a step.
fn fill(stages: &mut [Vec<Weights>; 2], source: &Source, step: f64, velocity: [f64; 2]) {
    let at = |part: f64| velocity[0] + (velocity[1] - velocity[0]) * part;
    for (stage, end) in [(Stage::First, GAMMA), (Stage::End, 1.0)] {
        let weights = &mut stages[stage as usize];
        for (ratio, own) in source.ratio.iter().zip(weights.chunks_exact_mut(MAX_FLASH_STATES)) {
            let square = ratio * ratio;
            let rate = |part: f64| source.flash.sliding_rate(square * at(part).abs()) / square;
            let sliding = match velocity[0] == velocity[1] {
                true => Sliding::constant(rate(1.0)),
                false => Sliding::new(rate(0.0), rate(0.5 * end), rate(end)),
            };
            for (k, weights) in own.iter_mut().enumerate() {
                let at_rest = source.flash.rates[k] / square;
                let residue = source.flash.residues[k] / ratio;
                *weights = match stage {
                    Stage::First => Weights::first(at_rest, &sliding, residue, step),
                    Stage::End => Weights::end(at_rest, &sliding, residue, step),
                };
            }
        }
    }
}

/// Rate that sliding adds to every decay over a stage, 1/s.
struct Sliding {
    start: f64,
    mean: f64,
    end: f64,
}

impl Sliding {
    fn constant(rate: f64) -> Sliding {
        Sliding { start: rate, mean: rate, end: rate }
    }

    /// From the rates at the start, in the middle and at the end of the stage; the mean by Simpson's rule.
    fn new(start: f64, middle: f64, end: f64) -> Sliding {
        Sliding { start, mean: (start + 4.0 * middle + end) / 6.0, end }
    }

    /// Dimensionless equivalent constant rate (rate times `length`, s) that gives the flux the same weight as the changing rate.
    fn keeping(&self, at_rest: f64, length: f64) -> f64 {
        let last = (at_rest + self.end) * length;
        if self.start == self.end {
            return last;
        }
        last - 0.5 * (self.end - self.start) * length * moment_ratio(last)
    }
}

/// Ratio m_2/m_1 of the moments of y^n exp(-x y) from 0 to 1, in [0, 2/3].
fn moment_ratio(x: f64) -> f64 {
    if x < 0.5 {
        let first = 0.5 - x * (1.0 / 3.0 - x * (1.0 / 8.0 - x / 30.0));
        return (1.0 / 3.0 - x * (1.0 / 4.0 - x * (1.0 / 10.0 - x / 36.0))) / first;
    }
    let first = first_moment(x);
    (2.0 * first - (-x).exp()) / (x * first)
}

impl Weights {
    /// Weights at the first stage; the fluxes of both stages are those of [`super::reduced`].
    fn first(at_rest: f64, sliding: &Sliding, residue: f64, step: f64) -> Weights {
        let length = GAMMA * step;
        let kept = sliding.keeping(at_rest, length);
        Weights {
            decay: (-(at_rest + sliding.mean) * length).exp(),
            known: residue * length * first_moment(kept),
            own: residue * length * mean_decay(kept),
        }
    }

    fn end(at_rest: f64, sliding: &Sliding, residue: f64, step: f64) -> Weights {
        let kept = sliding.keeping(at_rest, step);
        let known = step * first_moment(kept) / (1.0 - GAMMA);
        let decay = (-(at_rest + sliding.mean) * step).exp();
        Weights { decay, known: residue * known, own: residue * (step * mean_decay(kept) - known) }
    }
}

impl DiscHeat {
    /// Adds the free response of the source at a stage to the temperatures of the cells.
    fn add_source(&self, source: &[f64], stage: Stage, known: &[f64], temperature: &mut [f64]) {
        let left = source.iter().zip(self.weights(stage)).enumerate();
        Self::add(
            temperature,
            left.map(|(k, (state, weights))| weights.decay * state + weights.known * known[k / MAX_FLASH_STATES]),
        );
    }
}

impl ThermalBody for DiscHeat {
    fn prepare(&mut self, step: &Step<'_>) {
        let Step { length, velocity, .. } = *step;
        self.ring.prepare(step);
        let key = [length, velocity[0], velocity[1]].map(f64::to_bits);
        let Self { source, stages, .. } = self;
        stages.get_or_compute(key, |stages| fill(stages, source, length, velocity));
    }

    fn influence(&mut self, stage: Stage) -> &SurfaceInfluence {
        let of_ring = self.ring.influence(stage);
        self.influence.temperature.copy_from(&of_ring.temperature);
        self.influence.distortion.copy_from(&of_ring.distortion);
        for cell in 0..self.source.ratio.len() {
            self.influence.temperature[(cell, cell)] += self.own(stage, cell);
        }
        &self.influence
    }

    fn respond(&self, stage: Stage, flux: &[f64], [mut warm, moved]: [Option<&mut [f64]>; 2], work: &mut Workspace) {
        self.ring.respond(stage, flux, [warm.as_deref_mut(), moved], work);
        if let Some(temperature) = warm {
            let cells = temperature.iter_mut().zip(flux).enumerate();
            cells.for_each(|(cell, (temperature, flux))| *temperature += self.own(stage, cell) * flux);
        }
    }

    fn face_influence(&self, stage: Stage, face: usize, influence: &mut FaceInfluence, work: &mut Workspace) {
        self.ring.face_influence(stage, face, influence, work);
    }

    fn first(
        &self,
        state: &[f64],
        surroundings: &Surroundings,
        deviation: &[f64],
        [temperature, distortion]: [&mut [f64]; 2],
        work: &mut Workspace,
    ) -> First {
        let (ring, source) = self.split(state);
        let first = self.ring.first(ring, surroundings, deviation, [&mut *temperature, distortion], work);
        self.add_source(source, Stage::First, deviation, temperature);
        first
    }

    fn end(
        &self,
        first: First,
        state: &[f64],
        surroundings: &Surroundings,
        flux: &[f64],
        [temperature, distortion]: [&mut [f64]; 2],
        work: &mut Workspace,
    ) -> End {
        let (ring, source) = self.split(state);
        let end = self.ring.end(first, ring, surroundings, flux, [&mut *temperature, distortion], work);
        self.add_source(source, Stage::End, flux, temperature);
        end
    }

    fn advance(
        &self,
        end: End,
        (before, after): (&[f64], &mut [f64]),
        surroundings: &Surroundings,
        flux: [&[f64]; 2],
        work: &mut Workspace,
    ) {
        let (ring_before, source_before) = self.split(before);
        let (source, ring) = after.split_at_mut(self.source_states());
        self.ring.advance(end, (ring_before, ring), surroundings, flux, work);
        let states = source.iter_mut().zip(source_before).zip(self.weights(Stage::End));
        for (k, ((state, before), weights)) in states.enumerate() {
            let i = k / MAX_FLASH_STATES;
            *state = weights.decay * before + weights.known * flux[0][i] + weights.own * flux[1][i];
        }
    }

    fn boxed(&self) -> Box<dyn ThermalBody> {
        Box::new(self.clone())
    }
}

impl Observed for DiscHeat {
    fn cells(&self) -> usize {
        self.source.ratio.len()
    }

    fn states(&self) -> usize {
        self.source_states() + self.ring.states()
    }

    fn workspace(&self) -> Workspace {
        self.ring.workspace()
    }

    fn uniform(&self, rise: f64, state: &mut [f64]) {
        let (source, ring) = state.split_at_mut(self.source_states());
        self.ring.uniform(rise, ring);
        source.fill(0.0);
    }

    fn decay_rates(&self, velocity: f64) -> Vec<f64> {
        let Source { flash, ratio } = &*self.source;
        let of_the_cell = |ratio: &f64| {
            let square = ratio * ratio;
            let sliding = flash.sliding_rate(square * velocity.abs());
            std::array::from_fn::<f64, MAX_FLASH_STATES, _>(|k| (flash.rates[k] + sliding) / square)
        };
        ratio.iter().flat_map(of_the_cell).chain(self.ring.decay_rates(velocity)).collect()
    }

    fn temperature_at_frozen_state(&self, at: &FrozenState, temperature: &mut [f64], work: &mut Workspace) {
        let (ring, source) = self.split(at.state);
        self.ring.temperature_at_frozen_state(&FrozenState { state: ring, ..*at }, temperature, work);
        Self::add(temperature, source.iter().copied());
    }

    fn distortion_at_frozen_state(&self, at: &FrozenState, distortion: &mut [f64], work: &mut Workspace) {
        self.ring.distortion_at_frozen_state(&FrozenState { state: self.split(at.state).0, ..*at }, distortion, work);
    }

    fn cooled_temperature(&self, at: &FrozenState, work: &mut Workspace) -> [f64; FACES] {
        self.ring.cooled_temperature(&FrozenState { state: self.split(at.state).0, ..*at }, work)
    }

    fn far_temperature(&self, state: &[f64], surroundings: &Surroundings, flux: &[f64]) -> f64 {
        self.ring.far_temperature(self.split(state).0, surroundings, flux)
    }

    fn flows(&self, state: &[f64], surroundings: &Surroundings, flux: &[f64]) -> [f64; 2] {
        self.ring.flows(self.split(state).0, surroundings, flux)
    }

    fn mean_temperature(&self, state: &[f64]) -> f64 {
        self.ring.mean_temperature(self.split(state).0)
    }

    fn account(&self, state: &[f64]) -> Account {
        self.ring.account(self.split(state).0)
    }

    fn error_of_the_mean(&self) -> f64 {
        self.ring.error_of_the_mean()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lateral::Lateral;
    use crate::line::SingleStep;
    use crate::line::punch::mate::reduce_mate;
    use crate::line::tests::at_stage;
    use crate::moving_source::{MovingSource, Path};
    use crate::slab::Slab;
    use elasticity::Cells;
    use elasticity::discretization::relative_radii;
    use scene::Scene;
    use scene::variables::{STARTS, changed};

    /// Two pads on a disc of 12 mm.
    fn disc() -> (DiscHeat, Flash, Vec<f64>) {
        let changes = [
            ("contact.geometry", 2.0),
            ("contact.mean_radius", 0.1),
            ("punch.width", 0.04),
            ("depth", 0.08),
            ("punch.count", 2.0),
            ("strip.path", 2.0),
            ("strip.length", 0.0),
            ("strip.height", 0.012),
            ("strip.base_thermal", 1.0),
        ];
        let scene = Scene::new(&changed(&STARTS, &changes).unwrap(), None).unwrap();
        let cells = Cells::graded(0.02, 5).unwrap();
        let ring = reduce_mate(&scene, &cells, 1e-3, 100.0).unwrap().unwrap();
        let source = MovingSource::new(
            Slab::of(&scene.strip),
            0.5 * scene.sliding_extent(),
            Path::Closed(scene.length / scene.count),
        );
        let flash = Flash::new(&source.spreading(Lateral::of(&scene)), scene.nominal_duration, scene.tolerance);
        let ratio = relative_radii(&scene, &cells);
        (DiscHeat::new(ring, flash.clone(), ratio.clone()), flash, ratio)
    }

    fn step(disc: &mut DiscHeat, state: &mut [f64], step: f64, velocity: [f64; 2], flux: &[f64]) -> Vec<f64> {
        let around = Surroundings::default();
        disc.prepare(&Step::new(step, velocity));
        let (temperature, ..) = at_stage(disc, state, &around, (Stage::End, true), [flux, flux]);
        disc.step(state, &around, flux, flux);
        temperature
    }

    #[test]
    fn steady_sliding_heats_every_radius_by_its_own_resistance() {
        let (mut disc, flash, ratio) = disc();
        let flux = [1.0, 2.0, 1.5, 0.5, 1.0];
        for velocity in [0.3, -12.0] {
            let mut state = vec![0.0; disc.states()];
            let all = step(&mut disc, &mut state, 1e7, [velocity; 2], &flux);
            let at = FrozenState { state: &state, surroundings: &Surroundings::default(), flux: &flux, velocity };
            let ring = FrozenState { state: disc.split(&state).0, ..at }.temperature(&disc.ring);
            let held = at.temperature(&disc);
            for i in 0..5 {
                let own = ratio[i] * flash.resistance(ratio[i] * ratio[i] * f64::abs(velocity)) * flux[i];
                assert!((all[i] - ring[i] - own).abs() < 1e-9 * all[i], "{velocity} {i}");
                assert!((held[i] - all[i]).abs() < 1e-9 * all[i]);
            }
        }
        // Similarity: half the length at twice the speed, on a half-space.
        assert!((ratio[2] - 1.0).abs() < 1e-12);
    }

    #[test]
    fn steps_of_a_constant_flux_are_exact_and_those_of_a_changing_speed_at_least_of_second_order() {
        let (mut disc, ..) = disc();
        let flux = [1.0, 2.0, 1.5, 0.5, 1.0];
        let mut run = |parts: u32, last: f64| {
            let mut state = vec![0.0; disc.states()];
            let mut temperature = Vec::new();
            for part in 0..parts {
                let at = |part: u32| 2.0 + (last - 2.0) * f64::from(part) / f64::from(parts);
                let velocity = [at(part), at(part + 1)];
                temperature = step(&mut disc, &mut state, 0.2 / f64::from(parts), velocity, &flux);
            }
            temperature
        };
        let (one, many) = (run(1, 2.0), run(7, 2.0));
        assert!(one.iter().zip(&many).all(|(one, many)| (one / many - 1.0).abs() < 1e-12), "{one:?} {many:?}");
        let exact = run(2560, 6.0);
        let error = |values: Vec<f64>| values.iter().zip(&exact).map(|(a, b)| (a - b).abs()).sum::<f64>();
        let order = (error(run(40, 6.0)) / error(run(160, 6.0))).log2() / 2.0;
        assert!(order > 1.9, "{order}");
    }
}
