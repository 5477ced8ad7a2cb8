//! Transverse modes as matrices: projection of the fluxes on all modes, and their observation on the cells.
//!
//! Theory: docs/theory.md, section 4.6.

use super::{ModeStates, PORTS, ReducedOperators, StageWeights};
use numerics::dense;
use pulp::{Arch, Simd, WithSimd};
use std::ops::Range;

/// M modes on N cells.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct Modes {
    /// States of each mode, contiguous.
    states: Vec<Range<usize>>,
    /// Mode of each state.
    mode: Vec<usize>,
    cells: usize,
    /// Integrals of the modes over the cells, m^(1/2): M x N, by columns.
    integrals: Vec<f64>,
    /// Observation of the modes as cell temperatures, m^(-1/2): N x M, by columns.
    means: Vec<f64>,
    /// Distortion of the cells by each state, N x states, by columns; empty: nothing expands.
    distortion: Vec<f64>,
    /// Integrals of all modes over the parts of the cells, part by part; empty where no cell is covered in part.
    by_part: Vec<f64>,
}

/// Responses of a stage to unit heat into every mode, W/m^(1/2): amplitudes at the surface, and distortions of the cells, one column
/// per mode.
#[derive(Clone, Debug)]
pub(crate) struct ModeResponses {
    surface: Vec<f64>,
    distortion: Vec<f64>,
}

/// Workspace of a body.
#[derive(Clone, Debug)]
pub(crate) struct Scratch {
    /// Heat into every mode, W/m^(1/2).
    pub heat: Vec<f64>,
    /// Surface amplitude of every mode.
    pub surface: Vec<f64>,
    /// Values of the states.
    pub values: Vec<f64>,
}

impl Modes {
    /// Moves modes and distortion out of the operators.
    pub(crate) fn new(operators: &mut ReducedOperators) -> Modes {
        let (cells, modes) = (operators.widths.len(), std::mem::take(&mut operators.modes));
        let by_columns = |count: usize, of: fn(&ModeStates) -> &Vec<f64>| {
            (0..count).flat_map(|j| modes.iter().map(move |mode| of(mode)[j])).collect()
        };
        Modes {
            integrals: by_columns(cells, |mode| &mode.integrals),
            means: modes.iter().flat_map(|mode| mode.means.iter().copied()).collect(),
            distortion: std::mem::take(&mut operators.distortion),
            by_part: by_columns(operators.part_areas.len(), |mode| &mode.by_part),
            states: modes.iter().map(|mode| mode.states.clone()).collect(),
            mode: modes.iter().enumerate().flat_map(|(m, mode)| mode.states.clone().map(move |_| m)).collect(),
            cells,
        }
    }

    /// Number of modes.
    pub(crate) fn count(&self) -> usize {
        self.states.len()
    }

    /// Integrals of all modes over a part of a cell, m^(1/2).
    pub(crate) fn over_part(&self, part: usize) -> &[f64] {
        &self.by_part[part * self.count()..(part + 1) * self.count()]
    }

    /// Workspace for the states on the cells.
    pub(crate) fn scratch(&self) -> Scratch {
        let zeros = |count: usize| vec![0.0; count];
        let modes = self.states.len();
        Scratch { heat: zeros(modes), surface: zeros(modes), values: zeros(self.mode.len()) }
    }

    /// Projects the fluxes `flux` into the cells on the modes: heat into every mode, into the scratch.
    pub(crate) fn heat(&self, flux: &[f64], scratch: &mut Scratch) {
        scratch.heat.fill(0.0);
        dense::multiply_add(&self.integrals, flux, &mut scratch.heat);
    }

    /// Adds to every state's value the heat of its mode times its weight.
    pub(crate) fn add_heat(&self, heat: &[f64], weights: &[f64], values: &mut [f64]) {
        for ((value, weight), mode) in values.iter_mut().zip(weights).zip(&self.mode) {
            *value += weight * heat[*mode];
        }
    }

    /// Sets `sums` to those over the states of every mode of `seen` times `weights`.
    pub(crate) fn sum_up(&self, seen: &[f64], weights: &[f64], sums: &mut [f64]) {
        sums.fill(0.0);
        for ((seen, weight), mode) in seen.iter().zip(weights).zip(&self.mode) {
            sums[*mode] += seen * weight;
        }
    }

    /// Adds to every cell's value the products of its integrals with the modes' `sums`.
    pub(crate) fn add_by_cell(&self, sums: &[f64], values: &mut [f64]) {
        if sums.is_empty() {
            return;
        }
        for (value, integrals) in values.iter_mut().zip(self.integrals.chunks_exact(sums.len())) {
            *value += dense::dot(integrals, sums);
        }
    }

    /// Adds to the cells' temperatures those of the states in the scratch, weighted by `contact` at the surface.
    pub(crate) fn show(&self, contact: &[f64], scratch: &mut Scratch, temperature: &mut [f64]) {
        let Scratch { surface, values, .. } = scratch;
        surface.fill(0.0);
        for ((contact, value), mode) in contact.iter().zip(&*values).zip(&self.mode) {
            surface[*mode] += contact * value;
        }
        dense::multiply_add(&self.means, surface, temperature);
    }

    /// Adds the responses of a stage to its own heat `heat` into every mode: surface amplitudes of the modes, which are left in
    /// `surface`, to the cells' temperatures, and to their distortions.
    pub(crate) fn respond(
        &self,
        heat: &[f64],
        by_heat: &ModeResponses,
        surface: &mut [f64],
        [temperature, distortion]: [&mut [f64]; 2],
    ) {
        let amplitudes = heat.iter().zip(&by_heat.surface);
        surface.iter_mut().zip(amplitudes).for_each(|(surface, (heat, own))| *surface = heat * own);
        dense::multiply_add(&self.means, surface, temperature);
        if self.distorts() {
            dense::multiply_add(&by_heat.distortion, heat, distortion);
        }
    }

    /// Whether the states distort the contact line.
    pub(crate) fn distorts(&self) -> bool {
        !self.distortion.is_empty()
    }

    /// Adds the distortion by the states in the scratch to that of the cells.
    pub(crate) fn distort(&self, scratch: &mut Scratch, distortion: &mut [f64]) {
        if self.distorts() {
            dense::multiply_add(&self.distortion, &scratch.values, distortion);
        }
    }

    /// Memory for the responses of a stage.
    pub(crate) fn responses(&self) -> ModeResponses {
        let modes = self.states.len();
        let distorted = if self.distorts() { modes * self.cells } else { 0 };
        ModeResponses { surface: vec![0.0; modes], distortion: vec![0.0; distorted] }
    }

    /// Sets the responses of a stage to its own heat into every mode, and adds those to its own fluxes to its surface influence
    /// matrices.
    pub(crate) fn add_influence(&self, stage: &mut StageWeights, contact: &[f64], scratch: &mut Scratch) {
        if self.states.is_empty() {
            return;
        }
        let StageWeights { own, by_heat, influence, .. } = stage;
        for (surface, states) in by_heat.surface.iter_mut().zip(&self.states) {
            *surface = states.clone().map(|k| contact[k] * own[k]).sum();
        }
        by_heat.distortion.fill(0.0);
        for (column, states) in by_heat.distortion.chunks_exact_mut(self.cells).zip(&self.states) {
            let of_states = states.start * self.cells..states.end * self.cells;
            dense::multiply_add(&self.distortion[of_states], &own[states.clone()], column);
        }
        let [temperatures, distortions] = [&mut influence.temperature, &mut influence.distortion]
            .map(|matrix| matrix.as_mut_slice().chunks_exact_mut(self.cells));
        let cells = self.integrals.chunks_exact(self.states.len()).zip(temperatures.zip(distortions));
        for (integrals, (temperature, distortion)) in cells {
            self.respond(integrals, by_heat, &mut scratch.surface, [temperature, distortion]);
        }
    }
}

/// States after decay, plus the effect of constant inputs by the ports. No fused multiply-add, so the result is the same to
/// the bit on every machine.
pub(crate) fn decay(
    state: &[f64],
    weights: &StageWeights,
    input: &[Vec<f64>; PORTS],
    ports: &[f64; PORTS],
    values: &mut [f64],
) {
    struct Decay<'a>(&'a [f64], &'a StageWeights, &'a [Vec<f64>; PORTS], &'a [f64; PORTS], &'a mut [f64]);
    impl WithSimd for Decay<'_> {
        type Output = ();

        #[inline(always)]
        fn with_simd<S: Simd>(self, _: S) {
            let Self(state, weights, [cooling, ambient, far], ports, values) = self;
            let count = values.len();
            let (decay, constant) = (&weights.decay[..count], &weights.constant[..count]);
            let (state, cooling, ambient, far) = (&state[..count], &cooling[..count], &ambient[..count], &far[..count]);
            for k in 0..count {
                let input = cooling[k] * ports[0] + ambient[k] * ports[1] + far[k] * ports[2];
                values[k] = decay[k] * state[k] + constant[k] * input;
            }
        }
    }
    Arch::new().dispatch(Decay(state, weights, input, ports, values));
}
