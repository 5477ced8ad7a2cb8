//! The modes across as matrices, so that all of them are taken together: what fluxes give to each, what they show on the cells.

use super::{ModeStates, PORTS, StageWeights};
use crate::contact::dense;
use pulp::{Arch, Simd, WithSimd};
use std::ops::Range;

/// M modes on N cells.
#[derive(Clone, PartialEq, Debug)]
pub struct Modes {
    /// States of each mode; they follow each other.
    states: Vec<Range<usize>>,
    /// Mode of each state.
    mode: Vec<usize>,
    /// Integrals of the modes over the cells, m^(1/2): M x N, by columns.
    integrals: Vec<f64>,
    /// What of the modes is felt as temperature, m^(-1/2): N x M, by columns.
    means: Vec<f64>,
}

/// Memory that a body works in.
#[derive(Clone, Debug)]
pub struct Scratch {
    /// Heat into every mode, W/m^(1/2).
    pub heat: Vec<f64>,
    /// Surface amplitude of every mode.
    surface: Vec<f64>,
    /// Values of the states.
    pub values: Vec<f64>,
    /// A column for every mode, N x M.
    columns: Vec<f64>,
}

impl Modes {
    /// The matrices of these modes.
    pub fn new(modes: &[ModeStates]) -> Modes {
        let cells = modes.first().map_or(0, |mode| mode.integrals.len());
        Modes {
            states: modes.iter().map(|mode| mode.states.clone()).collect(),
            mode: modes.iter().enumerate().flat_map(|(m, mode)| mode.states.clone().map(move |_| m)).collect(),
            integrals: (0..cells).flat_map(|j| modes.iter().map(move |mode| mode.integrals[j])).collect(),
            means: modes.iter().flat_map(|mode| mode.means.iter().copied()).collect(),
        }
    }

    /// Room for `states` states on `cells` cells.
    pub fn scratch(&self, states: usize, cells: usize) -> Scratch {
        let zeros = |count: usize| vec![0.0; count];
        let modes = self.states.len();
        Scratch { heat: zeros(modes), surface: zeros(modes), values: zeros(states), columns: zeros(modes * cells) }
    }

    /// Heat that the fluxes `flux` into the cells give to every mode.
    pub fn heat(&self, flux: &[f64], heat: &mut [f64]) {
        heat.fill(0.0);
        dense::multiply_add(&self.integrals, flux, heat);
    }

    /// Adds to every state's value the heat of its mode times its weight.
    pub fn add_heat(&self, heat: &[f64], weights: &[f64], values: &mut [f64]) {
        for ((value, weight), mode) in values.iter_mut().zip(weights).zip(&self.mode) {
            *value += weight * heat[*mode];
        }
    }

    /// Adds to the cells' temperatures those of the states in the scratch, which `contact` weighs at the surface.
    pub fn show(&self, contact: &[f64], scratch: &mut Scratch, temperature: &mut [f64]) {
        let Scratch { surface, values, .. } = scratch;
        surface.fill(0.0);
        for ((contact, value), mode) in contact.iter().zip(&*values).zip(&self.mode) {
            surface[*mode] += contact * value;
        }
        dense::multiply_add(&self.means, surface, temperature);
    }

    /// Adds what the states show of a stage's own fluxes to its gains.
    pub fn add_gains(&self, stage: &mut StageWeights, contact: &[f64], distortion: &[f64], scratch: &mut Scratch) {
        let (modes, cells) = (self.states.len(), stage.gains.temperature.ncols());
        if modes == 0 {
            return;
        }
        let Scratch { heat, surface, columns, .. } = scratch;
        for (surface, states) in surface.iter_mut().zip(&self.states) {
            *surface = states.clone().map(|k| contact[k] * stage.own[k]).sum();
        }
        columns.fill(0.0);
        if !distortion.is_empty() {
            for (column, states) in columns.chunks_exact_mut(cells).zip(&self.states) {
                let of_states = states.start * cells..states.end * cells;
                dense::multiply_add(&distortion[of_states], &stage.own[states.clone()], column);
            }
        }
        for (j, integrals) in self.integrals.chunks_exact(modes).enumerate() {
            heat.iter_mut()
                .zip(integrals.iter().zip(&*surface))
                .for_each(|(heat, (own, surface))| *heat = own * surface);
            let column = j * cells..(j + 1) * cells;
            dense::multiply_add(&self.means, heat, &mut stage.gains.temperature.as_mut_slice()[column.clone()]);
            if !distortion.is_empty() {
                dense::multiply_add(columns, integrals, &mut stage.gains.distortion.as_mut_slice()[column]);
            }
        }
    }
}

/// What decay leaves of states and constant inputs by the ports add to them. Nothing is fused, so every machine gives the same bits.
pub fn decay(
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
