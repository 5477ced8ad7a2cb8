//! Transverse modes as matrices: projection of the fluxes on all modes, and their observation on the cells.
//!
//! Where the cells are symmetric about the middle and every mode is even or odd, its values on one half of them suffice:
//! even modes are projected from and observed as the sums of opposite cells, odd ones as their differences, at half of the
//! work.
//!
//! Theory: docs/theory.md, section 4.6.

use super::{PORTS, ReducedOperators, StageWeights};
use nalgebra::DMatrix;
use numerics::dense;
use pulp::{Arch, Simd, WithSimd};
use std::ops::Range;

/// M modes on N cells, the even ones first.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct Modes {
    /// States of each mode, contiguous.
    states: Vec<Range<usize>>,
    /// Mode of each state.
    mode: Vec<usize>,
    cells: usize,
    /// Even and odd modes; only the first without symmetry.
    parts: [Part; 2],
    /// Integrals of all modes over the parts of the cells, part by part; empty where no cell is covered in part.
    by_part: Vec<f64>,
}

/// Modes of one parity on the h cells on which they are stored.
#[derive(Clone, PartialEq, Debug, Default)]
struct Part {
    /// h: half of the cells with the middle one, without it, or all of them.
    cells: usize,
    modes: Range<usize>,
    states: Range<usize>,
    /// Integrals of the modes over the cells, m^(1/2): M x h, by columns.
    integrals: Vec<f64>,
    /// Observation of the modes as cell temperatures, m^(-1/2): h x M, by columns.
    means: Vec<f64>,
    /// Distortion of the cells by each state, h x states, by columns; empty: nothing expands.
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
    /// One column per mode.
    columns: Vec<f64>,
    /// Fluxes and responses by parity.
    folded: [Vec<f64>; 2],
    shown: [Vec<f64>; 2],
}

/// Parity of values on symmetric cells: 1 even, -1 odd.
fn parity(values: &[f64]) -> Option<f64> {
    let largest = values.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
    let is = |sign: f64| {
        let mirrored = values.iter().zip(values.iter().rev());
        // Relative tolerance within which a mode is even or odd.
        mirrored.into_iter().all(|(value, other)| (value - sign * other).abs() <= 1e-9 * largest)
    };
    [1.0, -1.0].into_iter().find(|&sign| is(sign))
}

/// Sorts the modes of the operators so that the even ones come first, with their states, and returns the numbers of even
/// modes and of their states; all of them where one mode is neither even nor odd.
pub(crate) fn sort(operators: &mut ReducedOperators) -> [usize; 2] {
    let count = operators.widths.len();
    let distortion = |state: usize| operators.distortion.get(state * count..(state + 1) * count);
    let signs: Option<Vec<f64>> = (operators.modes.iter())
        .map(|mode| {
            let sign = parity(&mode.integrals)?;
            let agrees =
                |values: &[f64]| parity(values).is_some_and(|own| own == sign || values.iter().all(|x| *x == 0.0));
            let shown = mode.states.clone().filter_map(distortion).all(agrees);
            (agrees(&mode.means) && shown).then_some(sign)
        })
        .collect();
    let all = [operators.modes.len(), operators.rate.len()];
    let Some(signs) = signs.filter(|_| parity(&operators.widths) == Some(1.0)) else { return all };
    let order = |sign: f64| (0..signs.len()).filter(|&mode| signs[mode] == sign).collect::<Vec<_>>();
    let [even, odd] = [1.0, -1.0].map(order);
    let states: Vec<usize> = even.iter().chain(&odd).flat_map(|&mode| operators.modes[mode].states.clone()).collect();
    let first = even.iter().map(|&mode| operators.modes[mode].states.len()).sum();
    let sorted = |values: &mut Vec<f64>| *values = states.iter().map(|&state| values[state]).collect();
    sorted(&mut operators.rate);
    sorted(&mut operators.contact);
    sorted(&mut operators.stored);
    sorted(&mut operators.uniform);
    operators.input.iter_mut().for_each(sorted);
    let observed =
        [&mut operators.cooled, &mut operators.far_face, &mut operators.ambient_flow, &mut operators.far_flow];
    for observed in observed {
        sorted(&mut observed.states);
    }
    if !operators.distortion.is_empty() {
        let columns = states.iter().flat_map(|&state| &operators.distortion[state * count..(state + 1) * count]);
        operators.distortion = columns.copied().collect();
    }
    let mut next = 0;
    operators.modes = (even.iter().chain(&odd))
        .map(|&mode| {
            let mut mode = operators.modes[mode].clone();
            let states = next..next + mode.states.len();
            next = states.end;
            mode.states = states;
            mode
        })
        .collect();
    [even.len(), first]
}

impl Modes {
    /// Moves modes and distortion out of the operators, which [`sort`] has sorted with this result.
    pub(crate) fn new(operators: &mut ReducedOperators, [even_modes, even_states]: [usize; 2]) -> Modes {
        let (cells, modes) = (operators.widths.len(), std::mem::take(&mut operators.modes));
        let distortion = std::mem::take(&mut operators.distortion);
        // No separation without modes or without odd ones.
        let halved = even_modes < modes.len();
        let part = |parity: usize| {
            let (modes_of, states_of, seen) = match (halved, parity) {
                (false, 0) => (0..modes.len(), 0..operators.rate.len(), cells),
                (false, _) => return Part::default(),
                (true, 0) => (0..even_modes, 0..even_states, cells.div_ceil(2)),
                (true, _) => (even_modes..modes.len(), even_states..operators.rate.len(), cells / 2),
            };
            let own = &modes[modes_of.clone()];
            let shown = states_of.clone().filter(|_| !distortion.is_empty());
            Part {
                cells: seen,
                integrals: (0..seen).flat_map(|j| own.iter().map(move |mode| mode.integrals[j])).collect(),
                means: own.iter().flat_map(|mode| mode.means[..seen].iter().copied()).collect(),
                distortion: shown.flat_map(|k| &distortion[k * cells..k * cells + seen]).copied().collect(),
                modes: modes_of,
                states: states_of,
            }
        };
        Modes {
            parts: [part(0), part(1)],
            by_part: (0..operators.part_areas.len())
                .flat_map(|j| modes.iter().map(move |mode| mode.by_part[j]))
                .collect(),
            states: modes.iter().map(|mode| mode.states.clone()).collect(),
            mode: modes.iter().enumerate().flat_map(|(m, mode)| mode.states.clone().map(move |_| m)).collect(),
            cells,
        }
    }

    /// Whether even and odd modes are stored on half of the cells.
    pub(crate) fn is_halved(&self) -> bool {
        self.parts[0].cells < self.cells
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
        let parts = || self.parts.each_ref().map(|part| vec![0.0; part.cells]);
        Scratch {
            heat: zeros(modes),
            surface: zeros(modes),
            values: zeros(self.mode.len()),
            columns: zeros(modes * self.parts[0].cells),
            folded: parts(),
            shown: parts(),
        }
    }

    /// Sums and differences of opposite cells; the middle one is unchanged.
    fn fold(&self, flux: &[f64], [even, odd]: &mut [Vec<f64>; 2]) {
        let half = odd.len();
        let seen = even.len();
        even.copy_from_slice(&flux[..seen]);
        let opposite = flux.iter().rev();
        for ((even, odd), opposite) in even[..half].iter_mut().zip(odd).zip(opposite) {
            *odd = *even - opposite;
            *even += opposite;
        }
    }

    /// Adds even and odd parts to values on all cells.
    fn unfold_onto(&self, [even, odd]: &[Vec<f64>; 2], values: &mut [f64]) {
        let (left, right) = values.split_at_mut(even.len());
        left.iter_mut().zip(even).for_each(|(value, even)| *value += even);
        left.iter_mut().zip(odd).for_each(|(value, odd)| *value += odd);
        let both = even.iter().zip(odd);
        right.iter_mut().rev().zip(both).for_each(|(value, (even, odd))| *value += even - odd);
    }

    /// Projects the fluxes `flux` into the cells on the modes: heat into every mode, into the scratch.
    pub(crate) fn heat(&self, flux: &[f64], scratch: &mut Scratch) {
        let Scratch { heat, folded, .. } = scratch;
        self.fold(flux, folded);
        heat.fill(0.0);
        let [even, odd] = &self.parts;
        let (even_heat, odd_heat) = heat.split_at_mut(even.modes.len());
        let [even_flux, odd_flux] = folded;
        dense::multiply_add_each([(&even.integrals, even_flux, even_heat), (&odd.integrals, odd_flux, odd_heat)]);
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
        for (sign, part) in [1.0, -1.0].into_iter().zip(&self.parts).filter(|(_, part)| !part.modes.is_empty()) {
            let own = &sums[part.modes.clone()];
            for (j, integrals) in part.integrals.chunks_exact(own.len()).enumerate() {
                let value = dense::dot(integrals, own);
                values[j] += value;
                let opposite = self.cells - 1 - j;
                if self.is_halved() && opposite != j {
                    values[opposite] += sign * value;
                }
            }
        }
    }

    /// Adds to the cells' temperatures those of the states in the scratch, weighted by `contact` at the surface.
    pub(crate) fn show(&self, contact: &[f64], scratch: &mut Scratch, temperature: &mut [f64]) {
        let Scratch { surface, values, shown, .. } = scratch;
        surface.fill(0.0);
        for ((contact, value), mode) in contact.iter().zip(&*values).zip(&self.mode) {
            surface[*mode] += contact * value;
        }
        shown.iter_mut().for_each(|shown| shown.fill(0.0));
        let [even, odd] = &self.parts;
        let [even_shown, odd_shown] = &mut *shown;
        dense::multiply_add_each([
            (&even.means, &surface[even.modes.clone()], even_shown),
            (&odd.means, &surface[odd.modes.clone()], odd_shown),
        ]);
        self.unfold_onto(shown, temperature);
    }

    /// Sets the states in the scratch to those by the heat `heat` into every mode with the weights `weights`.
    pub(crate) fn respond(&self, heat: &[f64], weights: &[f64], scratch: &mut Scratch) {
        for ((value, weight), mode) in scratch.values.iter_mut().zip(weights).zip(&self.mode) {
            *value = weight * heat[*mode];
        }
    }

    /// Whether the states distort the contact line.
    pub(crate) fn distorts(&self) -> bool {
        self.parts.iter().any(|part| !part.distortion.is_empty())
    }

    /// Adds the distortion by the states in the scratch to that of the cells.
    pub(crate) fn distort(&self, scratch: &mut Scratch, distortion: &mut [f64]) {
        let Scratch { values, shown, .. } = scratch;
        shown.iter_mut().for_each(|shown| shown.fill(0.0));
        let [even, odd] = &self.parts;
        let [even_shown, odd_shown] = &mut *shown;
        dense::multiply_add_each([
            (&even.distortion, &values[even.states.clone()], even_shown),
            (&odd.distortion, &values[odd.states.clone()], odd_shown),
        ]);
        self.unfold_onto(shown, distortion);
    }

    /// Adds the responses of the states to a stage's own fluxes to its surface influence matrices.
    pub(crate) fn add_influence(&self, stage: &mut StageWeights, contact: &[f64], scratch: &mut Scratch) {
        let Scratch { heat, surface, columns, shown, .. } = scratch;
        for (surface, states) in surface.iter_mut().zip(&self.states) {
            *surface = states.clone().map(|k| contact[k] * stage.own[k]).sum();
        }
        for (sign, part) in [1.0, -1.0].into_iter().zip(&self.parts).filter(|(_, part)| !part.modes.is_empty()) {
            let (modes, seen) = (part.modes.len(), part.cells);
            let columns = &mut columns[..modes * seen];
            columns.fill(0.0);
            let shown = &mut shown[usize::from(sign < 0.0)];
            if !part.distortion.is_empty() {
                for (column, states) in columns.chunks_exact_mut(seen).zip(&self.states[part.modes.clone()]) {
                    let of_states = (states.start - part.states.start) * seen..(states.end - part.states.start) * seen;
                    dense::multiply_add(&part.distortion[of_states], &stage.own[states.clone()], column);
                }
            }
            for (j, integrals) in part.integrals.chunks_exact(modes).enumerate() {
                let amplitudes = integrals.iter().zip(&surface[part.modes.clone()]);
                let heat = &mut heat[..modes];
                heat.iter_mut().zip(amplitudes).for_each(|(heat, (own, surface))| *heat = own * surface);
                shown.fill(0.0);
                dense::multiply_add(&part.means, heat, shown);
                self.add_response(j, sign, shown, &mut stage.influence.temperature);
                if !part.distortion.is_empty() {
                    shown.fill(0.0);
                    dense::multiply_add(columns, integrals, shown);
                    self.add_response(j, sign, shown, &mut stage.influence.distortion);
                }
            }
        }
    }

    /// Adds the response `shown` of one parity to a flux into cell `j`, and to the same or opposite flux into the opposite cell.
    fn add_response(&self, j: usize, sign: f64, shown: &[f64], influence: &mut DMatrix<f64>) {
        let halved = self.is_halved();
        let opposite = self.cells - 1 - j;
        let columns =
            if halved && opposite != j { [Some((j, 1.0)), Some((opposite, sign))] } else { [Some((j, 1.0)), None] };
        for (column, part) in columns.into_iter().flatten() {
            let column = &mut influence.as_mut_slice()[column * self.cells..(column + 1) * self.cells];
            column.iter_mut().zip(shown).for_each(|(gain, value)| *gain += part * value);
            if halved {
                let behind = column[self.cells.div_ceil(2)..].iter_mut().rev();
                behind.zip(shown).for_each(|(gain, value)| *gain += part * sign * value);
            }
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
