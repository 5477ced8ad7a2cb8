//! Modal reduction of a body at rest under the contact: states that decay independently.
//!
//! Temperatures are sums of products `X_m(x) Z_k(z)` with one state `a_k` each:
//!
//! ```text
//! da_k/dt = -rate_k a_k + Z_k(0) sum_j F_mj q_j + sum_p input_pk u_p,   F_mj = integral of X_m over cell j
//! T_i = sum_k (F_mi/c_i) Z_k(0) a_k + (D q)_i + (d_p u_p)_i,              c_i: width of cell i
//! ```
//!
//! with the fluxes q, the surroundings u (cooling, ambient, far) and the static corrections D and d. Distortions, flows and
//! the stored heat are sums over the same states. The propagation of each state is exact for its fluxes at any rate and step
//! size, so the response of a stage is one weight per state: N^2 products per transverse mode for a new step size.
//!
//! Theory: docs/theory.md, sections 4.1, 4.6.

mod modes;
mod patterns;
mod weights;

pub(super) use weights::{first_moment, mean_decay};

use super::workspace::Memory;
use super::{
    Account, Boundary, End, Exchange, FACES, FaceInfluence, First, FrozenState, GAMMA, Observed, Stage, Step,
    SurfaceInfluence, Surroundings, ThermalBody, Workspace, cache_capacity,
};
use modes::{Modes, Scratch};
use nalgebra::DMatrix;
use numerics::cache::KeyedCache;
use numerics::dense;
use patterns::Patterns;
use std::ops::Range;
use std::sync::Arc;
use weights::{StageWeights, Weights};

/// Number of inputs besides the fluxes.
pub(super) const PORTS: usize = 3;

/// Indices of the fluxes by the air among the ports.
const COOLING: usize = 0;
const FAR: usize = 2;

impl Boundary {
    /// Values of the ports in their order: cooling, ambient, far.
    fn ports(&self) -> [f64; PORTS] {
        [self.cooling, self.ambient, self.far]
    }
}

/// Linear observation: weights of the states, of the N fluxes and of the ports.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Observation {
    pub states: Vec<f64>,
    pub fluxes: Vec<f64>,
    pub ports: [f64; PORTS],
    /// Weights of fluxes through parts of the cells, where they differ from those of the whole cells; empty: nowhere.
    pub by_part: Vec<f64>,
}

impl Observation {
    /// Zero observation of `states` states and `cells` fluxes.
    pub(crate) fn none(states: usize, cells: usize) -> Self {
        Self { states: vec![0.0; states], fluxes: vec![0.0; cells], ports: [0.0; PORTS], by_part: Vec::new() }
    }

    fn of(&self, states: &[f64], fluxes: &[f64], ports: &[f64; PORTS]) -> f64 {
        dot(&self.states, states) + dot(&self.fluxes, fluxes) + dot(&self.ports, ports)
    }
}

/// A transverse mode and the states that share it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ModeStates {
    pub states: Range<usize>,
    /// F: integrals of the mode over the cells, m^(1/2).
    pub integrals: Vec<f64>,
    /// F over the widths of the cells: the observed cell temperatures, or the observed part of them.
    pub means: Vec<f64>,
    /// Integrals over the parts of the cells; empty where all cells are whole.
    pub by_part: Vec<f64>,
}

/// Operators of a reduced body. Vectors are by state unless stated otherwise.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ReducedOperators {
    /// Widths of the N cells, m.
    pub widths: Vec<f64>,
    pub modes: Vec<ModeStates>,
    /// Areas of the parts of the cells per depth, m; empty where all cells are whole.
    pub part_areas: Vec<f64>,
    /// Steady temperature integrals of the parts of every cell by the fluxes through them that no state follows: its P x P blocks.
    pub remainder: Vec<f64>,
    /// Decay rates, 1/s, >= 0.
    pub rate: Vec<f64>,
    /// Z at the contact.
    pub contact: Vec<f64>,
    /// Distortion of the N cells by each state, state by state.
    pub distortion: Vec<f64>,
    /// Input weights by port.
    pub input: [Vec<f64>; PORTS],
    /// D, direct feedthrough from the fluxes to the temperatures of the cells, N x N, K m2/W.
    pub temperature_by_flux: DMatrix<f64>,
    /// d: temperatures of the cells by port.
    pub temperature_by_port: [Vec<f64>; PORTS],
    /// Direct feedthrough to the distortion by fluxes and ports, m3/W and m per unit of the port.
    pub distortion_by_flux: DMatrix<f64>,
    pub distortion_by_port: [Vec<f64>; PORTS],
    /// Mean temperature of the cooled surface beside the contact, and of the far face.
    pub cooled: Observation,
    pub far_face: Observation,
    /// Heat flow to the air by the constant convection, W/m.
    pub ambient_flow: Observation,
    /// Total heat flow out of the far face, W/m.
    pub far_flow: Observation,
    /// Linear forms of the time integrals of ambient and far flow, see `ReducedOperators::passed`.
    pub passed: [Observation; 2],
    /// The temperature of the far face is prescribed.
    pub held: bool,
    /// Heat flow that enters through the cooled surface per unit of `cooling`, m.
    pub cooled_length: f64,
    /// Heat stored, J/m.
    pub stored: Vec<f64>,
    /// Heat stored beyond the states per kelvin of the far face, J/(m K).
    pub stored_by_far: f64,
    /// States at the uniform temperature 1 K.
    pub uniform: Vec<f64>,
    /// Heat capacity of the whole body, J/(m K).
    pub heat_capacity: f64,
    /// Number of leading states that belong to modes; the others give the quasi-static modes first-order dynamics.
    pub own: usize,
    /// See [`ReducedHeat::error`].
    pub error: f64,
    /// See [`Observed::error_of_the_mean`].
    pub mean_error: f64,
}

/// Memory of the steps of a reduced body.
#[derive(Clone, Debug)]
pub(crate) struct StepMemory {
    scratch: Scratch,
    /// States at the end of the step without its own fluxes, which the free response there leaves for the propagation.
    carried: Vec<f64>,
}

/// A reduced body with the weights of its last step sizes.
#[derive(Clone, Debug)]
pub struct ReducedHeat {
    operators: Arc<ReducedOperators>,
    modes: Arc<Modes>,
    /// For preparations.
    scratch: Scratch,
    /// By the bits of the step. It has no memory until the first step.
    weights: KeyedCache<u64, Weights>,
    /// Of both stages.
    patterns: [Patterns; 2],
    /// Memory for influence matrices through parts of the cells.
    through_parts: SurfaceInfluence,
}

impl ReducedHeat {
    pub(super) fn new(mut operators: ReducedOperators) -> Self {
        operators.passed = [&operators.ambient_flow, &operators.far_flow].map(|flow| operators.passed(flow));
        let modes = Modes::new(&mut operators);
        let scratch = modes.scratch();
        let patterns = [Patterns::new(&operators, &modes), Patterns::new(&operators, &modes)];
        let divided = if operators.part_areas.is_empty() { 0 } else { operators.widths.len() };
        let through_parts =
            SurfaceInfluence { temperature: dense::untouched(divided), distortion: dense::untouched(divided) };
        let (operators, modes) = (Arc::new(operators), Arc::new(modes));
        Self { operators, modes, scratch, weights: KeyedCache::new([]), patterns, through_parts }
    }

    /// Number of states that belong to modes. The state vector also has the first-order states of the quasi-static modes, at
    /// most one per cell, and four entries for the heat account.
    #[cfg(test)]
    pub(crate) fn own_states(&self) -> usize {
        self.operators.own
    }

    /// Relative error of the reduction at the contact line, computed when the body was made.
    pub fn error(&self) -> f64 {
        self.operators.error
    }

    /// Whether the temperature of the far face is prescribed.
    #[cfg(test)]
    pub(crate) fn holds_far_face(&self) -> bool {
        self.operators.held
    }

    /// Selects the weights of a step size, from the cache or computed.
    fn select(&mut self, step: f64) {
        let Self { operators, modes, scratch, weights, patterns, .. } = self;
        if weights.capacity() == 0 {
            // The longer step by which growth is looked for is one more.
            let capacity = cache_capacity(operators.widths.len()) + 1;
            *weights = KeyedCache::new((0..capacity).map(|_| operators.allocate(modes)));
        }
        let slot = weights.get_or_compute(step.to_bits(), |weights| {
            operators.fill(modes, weights, step, scratch);
        });
        for (patterns, stage) in patterns.iter_mut().zip(&weights[slot].stages) {
            patterns.prepare(step, modes, &stage.by_heat, scratch);
        }
    }

    fn weights(&self) -> &Weights {
        self.weights.latest().expect("prepare comes before any step")
    }

    fn stage(&self, stage: Stage) -> &StageWeights {
        &self.weights().stages[stage as usize]
    }

    /// Propagates the states into the scratch up to a stage without its own fluxes into the cells.
    fn carry(&self, scratch: &mut Scratch, state: &[f64], around: &Surroundings, stage: Stage, known: &[f64]) {
        let (operators, weights) = (&*self.operators, self.stage(stage));
        modes::decay(state, weights, &operators.input, &around.at(stage).ports(), &mut scratch.values);
        for (input, fall) in operators.input.iter().zip(around.fall(stage).ports()) {
            if fall != 0.0 {
                let values = scratch.values.iter_mut().zip(weights.falling.iter().zip(input));
                values.for_each(|(value, (falling, input))| *value += falling * input * fall);
            }
        }
        self.heat(known, Stage::First, scratch);
        self.modes.add_heat(&scratch.heat, &weights.known, &mut scratch.values);
    }

    /// Heat into every mode by the fluxes `flux` of a stage through the parts in contact of the cells, into the scratch.
    fn heat(&self, flux: &[f64], stage: Stage, scratch: &mut Scratch) {
        self.modes.heat(flux, scratch);
        self.patterns[stage as usize].heat(flux, &mut scratch.heat);
    }

    /// Temperatures or distortions, or both, of the cells by the ports and the states in the scratch.
    fn observe(
        &self,
        scratch: &mut Scratch,
        ports: &[f64; PORTS],
        temperature: Option<&mut [f64]>,
        distortion: Option<&mut [f64]>,
    ) {
        let operators = &*self.operators;
        if let Some(temperature) = temperature {
            combine(&operators.temperature_by_port, ports, temperature);
            self.modes.show(&operators.contact, scratch, temperature);
        }
        if let Some(distortion) = distortion {
            if !self.modes.distorts() {
                return distortion.fill(0.0);
            }
            combine(&operators.distortion_by_port, ports, distortion);
            self.modes.distort(scratch, distortion);
        }
    }
}

/// Entries of the state vector behind the decaying states: heat received and lost so far, J/m, and the temperature of the
/// far face that the stored heat includes.
#[derive(Clone, Copy)]
enum Tally {
    Received,
    Ambient,
    Far,
    FarTemperature,
}

/// Number of these entries.
const TALLIES: usize = Tally::FarTemperature as usize + 1;

impl ReducedOperators {
    fn states(&self) -> usize {
        self.rate.len()
    }

    /// Mean temperatures of the faces cooled by the air.
    fn faces(&self) -> [&Observation; FACES] {
        [&self.cooled, &self.far_face]
    }

    /// Time integral of a flow as a linear form: weights of the integrated inputs (steady gain), and of the states, whose
    /// integral is (their input less their gain) over their decay rate.
    fn passed(&self, flow: &Observation) -> Observation {
        let over_rate = |(flow, &rate): (&f64, &f64)| if rate > 0.0 { flow / rate } else { 0.0 };
        let states: Vec<f64> = flow.states.iter().zip(&self.rate).map(over_rate).collect();
        let mut passed = Observation { states, ..flow.clone() };
        for mode in &self.modes {
            let weight: f64 = mode.states.clone().map(|k| passed.states[k] * self.contact[k]).sum();
            add(&mut passed.fluxes, weight, &mode.integrals);
            add(&mut passed.by_part, weight, &mode.by_part);
        }
        for (port, input) in passed.ports.iter_mut().zip(&self.input) {
            *port += dot(&passed.states, input);
        }
        passed
    }
}

impl ReducedHeat {
    /// Free response of a stage from the fluxes `known` before it; leaves the states in the scratch.
    fn respond(
        &self,
        state: &[f64],
        surroundings: &Surroundings,
        (stage, known): (Stage, &[f64]),
        [temperature, distortion]: [&mut [f64]; 2],
        scratch: &mut Scratch,
    ) -> [f64; FACES] {
        let operators = &*self.operators;
        let around = surroundings.without_fluxes_at(stage, operators.held);
        self.carry(scratch, state, &around, stage, known);
        let ports = around.at(stage).ports();
        let faces = operators.faces().map(|face| dot(&face.states, &scratch.values) + dot(&face.ports, &ports));
        self.observe(scratch, &ports, Some(&mut *temperature), Some(distortion));
        self.patterns[stage as usize].show(&scratch.surface, temperature);
        faces
    }
}

impl ThermalBody for ReducedHeat {
    fn prepare(&mut self, step: &Step<'_>) {
        for (stage, patterns) in self.patterns.iter_mut().enumerate() {
            let parts = if let Exchange::Parts(parts) = step.exchange { Some(parts[stage]) } else { None };
            patterns.set_contact_parts(parts, &self.operators, &self.modes);
        }
        self.select(step.length);
    }

    fn influence(&mut self, stage: Stage) -> &SurfaceInfluence {
        let patterns = &self.patterns[stage as usize];
        if patterns.is_empty() {
            return &self.stage(stage).influence;
        }
        let Self { weights, through_parts, .. } = self;
        let whole = &weights.latest().expect("prepare comes before any step").stages[stage as usize].influence;
        through_parts.temperature.copy_from(&whole.temperature);
        through_parts.distortion.copy_from(&whole.distortion);
        patterns.add_influence(through_parts);
        through_parts
    }

    fn respond(&self, stage: Stage, flux: &[f64], response: [Option<&mut [f64]>; 2], _work: &mut Workspace) {
        let SurfaceInfluence { temperature, distortion } = &self.stage(stage).influence;
        let [mut warm, mut moved] = response;
        for (matrix, response) in [(temperature, &mut warm), (distortion, &mut moved)] {
            response.iter_mut().for_each(|response| dense::multiply_add(matrix.as_slice(), flux, response));
        }
        self.patterns[stage as usize].respond(flux, [warm, moved]);
    }

    fn face_influence(&self, stage: Stage, face: usize, influence: &mut FaceInfluence, work: &mut Workspace) {
        let (operators, weights, patterns) = (&*self.operators, self.stage(stage), &self.patterns[stage as usize]);
        let (scratch, port) = (&mut work.reduced().scratch, [COOLING, FAR][face]);
        for ((value, input), own) in scratch.values.iter_mut().zip(&operators.input[port]).zip(&weights.by_face) {
            *value = input * own;
        }
        influence.faces = operators.faces().map(|other| dot(&other.states, &scratch.values) + other.ports[port]);
        influence.mean = dot(&operators.stored, &scratch.values) / operators.heat_capacity;
        let mut ports = [0.0; PORTS];
        ports[port] = 1.0;
        self.observe(scratch, &ports, Some(&mut influence.temperature), Some(&mut influence.distortion));
        patterns.show(&scratch.surface, &mut influence.temperature);
        let seen = operators.faces()[face];
        influence.by_cell.copy_from_slice(&seen.fluxes);
        self.modes.sum_up(&seen.states, &weights.own, &mut scratch.heat);
        self.modes.add_by_cell(&scratch.heat, &mut influence.by_cell);
        patterns.add_by_cell(&scratch.heat, &mut influence.by_cell);
    }

    fn first(
        &self,
        state: &[f64],
        surroundings: &Surroundings,
        deviation: &[f64],
        response: [&mut [f64]; 2],
        work: &mut Workspace,
    ) -> First {
        let scratch = &mut work.reduced().scratch;
        First { faces: self.respond(state, surroundings, (Stage::First, deviation), response, scratch) }
    }

    fn end(
        &self,
        _first: First,
        state: &[f64],
        surroundings: &Surroundings,
        flux: &[f64],
        response: [&mut [f64]; 2],
        work: &mut Workspace,
    ) -> End {
        let StepMemory { scratch, carried } = work.reduced();
        let faces = self.respond(state, surroundings, (Stage::End, flux), response, scratch);
        std::mem::swap(&mut scratch.values, carried);
        End { faces }
    }

    fn advance(
        &self,
        _end: End,
        (before, after): (&[f64], &mut [f64]),
        surroundings: &Surroundings,
        [first, end]: [&[f64]; 2],
        work: &mut Workspace,
    ) {
        let (operators, step) = (&*self.operators, self.weights().step);
        let (mean, last) = (surroundings.mean(), surroundings.end);
        let ports = mean.ports();
        let (states, tallies) = after.split_at_mut(operators.states());
        tallies.copy_from_slice(&before[operators.states()..]);
        let (StepMemory { scratch, carried }, weights) = (work.reduced(), self.stage(Stage::End));
        self.heat(end, Stage::End, scratch);
        states.copy_from_slice(carried);
        self.modes.add_heat(&scratch.heat, &weights.own, states);
        let far = if operators.held { 0.0 } else { last.far };
        for (input, flux) in [(&operators.input[COOLING], last.cooling), (&operators.input[FAR], far)] {
            if flux != 0.0 {
                let inputs = states.iter_mut().zip(weights.by_face.iter().zip(input));
                inputs.for_each(|(state, (own, input))| *state += own * input * flux);
            }
        }
        // Heat input over the step with the weights of both stages.
        let over_step = |weights: &[f64]| (1.0 - GAMMA) * dot(weights, first) + GAMMA * dot(weights, end);
        tallies[Tally::Received as usize] += step * over_step(&operators.widths);
        for (tally, passed) in [Tally::Ambient, Tally::Far].into_iter().zip(&operators.passed) {
            tallies[tally as usize] += step * (over_step(&passed.fluxes) + dot(&passed.ports, &ports));
        }
        for (place, tally) in [Tally::Ambient, Tally::Far].into_iter().enumerate() {
            let [of_first, of_end] = &self.patterns;
            let passed = (1.0 - GAMMA) * of_first.passed(place, first) + GAMMA * of_end.passed(place, end);
            tallies[tally as usize] += step * passed;
        }
        // The flux into the cooled surface is heat from the air.
        tallies[Tally::Ambient as usize] -= step * operators.cooled_length * mean.cooling;
        tallies[Tally::FarTemperature as usize] = last.far;
    }

    fn boxed(&self) -> Box<dyn ThermalBody> {
        Box::new(self.clone())
    }
}

impl Observed for ReducedHeat {
    fn cells(&self) -> usize {
        self.operators.widths.len()
    }

    fn states(&self) -> usize {
        self.operators.states() + TALLIES
    }

    fn workspace(&self) -> Workspace {
        let carried = vec![0.0; self.operators.states()];
        Workspace(Memory::Reduced(Box::new(StepMemory { scratch: self.modes.scratch(), carried })))
    }

    fn uniform(&self, rise: f64, state: &mut [f64]) {
        let (states, tallies) = state.split_at_mut(self.operators.states());
        for (state, uniform) in states.iter_mut().zip(&self.operators.uniform) {
            *state = rise * uniform;
        }
        tallies.fill(0.0);
        tallies[Tally::FarTemperature as usize] = rise;
    }

    fn decay_rates(&self, _velocity: f64) -> Vec<f64> {
        self.operators.rate.clone()
    }

    fn divides_cells(&self) -> bool {
        !self.operators.part_areas.is_empty()
    }

    fn temperature_at_frozen_state(&self, at: &FrozenState, temperature: &mut [f64], work: &mut Workspace) {
        let FrozenState { state, surroundings, flux, .. } = *at;
        let (operators, scratch) = (&*self.operators, &mut work.reduced().scratch);
        scratch.values.copy_from_slice(&state[..operators.states()]);
        self.observe(scratch, &surroundings.end.ports(), Some(temperature), None);
        dense::multiply_add(operators.temperature_by_flux.as_slice(), flux, temperature);
    }

    fn distortion_at_frozen_state(&self, at: &FrozenState, distortion: &mut [f64], work: &mut Workspace) {
        let FrozenState { state, surroundings, flux, .. } = *at;
        let (operators, scratch) = (&*self.operators, &mut work.reduced().scratch);
        scratch.values.copy_from_slice(&state[..operators.states()]);
        self.observe(scratch, &surroundings.end.ports(), None, Some(distortion));
        if self.modes.distorts() {
            dense::multiply_add(operators.distortion_by_flux.as_slice(), flux, distortion);
        }
    }

    fn cooled_temperature(&self, at: &FrozenState, _work: &mut Workspace) -> [f64; FACES] {
        let FrozenState { state, surroundings, flux, .. } = *at;
        let (operators, ports) = (&*self.operators, surroundings.end.ports());
        operators.faces().map(|face| face.of(&state[..operators.states()], flux, &ports))
    }

    fn far_temperature(&self, state: &[f64], surroundings: &Surroundings, flux: &[f64]) -> f64 {
        let operators = &*self.operators;
        operators.far_face.of(&state[..operators.states()], flux, &surroundings.end.ports())
    }

    fn flows(&self, state: &[f64], surroundings: &Surroundings, flux: &[f64]) -> [f64; 2] {
        let (operators, ports) = (&*self.operators, surroundings.end.ports());
        let states = &state[..operators.states()];
        [operators.ambient_flow.of(states, flux, &ports), operators.far_flow.of(states, flux, &ports)]
    }

    fn mean_temperature(&self, state: &[f64]) -> f64 {
        let operators = &*self.operators;
        let (states, tallies) = state.split_at(operators.states());
        let beyond = operators.stored_by_far * tallies[Tally::FarTemperature as usize];
        (dot(&operators.stored, states) + beyond) / operators.heat_capacity
    }

    fn account(&self, state: &[f64]) -> Account {
        let operators = &*self.operators;
        let (states, tallies) = state.split_at(operators.states());
        // Heat of the far face's field beyond the states has passed through that face.
        let beyond = operators.stored_by_far * tallies[Tally::FarTemperature as usize];
        Account {
            received: tallies[Tally::Received as usize],
            stored: dot(&operators.stored, states) + beyond,
            ambient: tallies[Tally::Ambient as usize] - dot(&operators.passed[0].states, states),
            far: tallies[Tally::Far as usize] - dot(&operators.passed[1].states, states) - beyond,
        }
    }

    fn error_of_the_mean(&self) -> f64 {
        self.operators.mean_error
    }
}

/// Dot product with a summation order that is the same on every machine.
fn dot(left: &[f64], right: &[f64]) -> f64 {
    let (left_fours, left_rest) = left.as_chunks::<4>();
    let (right_fours, right_rest) = right.as_chunks::<4>();
    let mut sum = [0.0; 4];
    for (left, right) in left_fours.iter().zip(right_fours) {
        for lane in 0..4 {
            sum[lane] += left[lane] * right[lane];
        }
    }
    let rest: f64 = left_rest.iter().zip(right_rest).map(|(left, right)| left * right).sum();
    (sum[0] + sum[2]) + (sum[1] + sum[3]) + rest
}

fn add(sum: &mut [f64], factor: f64, vector: &[f64]) {
    for (sum, value) in sum.iter_mut().zip(vector) {
        *sum += factor * value;
    }
}

fn combine(vectors: &[Vec<f64>; PORTS], factors: &[f64; PORTS], sum: &mut [f64]) {
    sum.fill(0.0);
    for (vector, &factor) in vectors.iter().zip(factors) {
        if factor != 0.0 {
            add(sum, factor, vector);
        }
    }
}
