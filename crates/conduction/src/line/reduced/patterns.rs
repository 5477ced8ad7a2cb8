//! Flux through the parts in contact of cells partly in contact: that through the whole cell, evenly, plus a pattern without heat.
//!
//! With the areas c_s of the parts of cell k, their fractions in contact v_s, the area c_k of all and c' = sum v_s c_s of those in
//! contact, the pattern is
//!
//! ```text
//! delta_s = v_s c_k/c' - 1,    sum c_s delta_s = 0
//! ```
//!
//! per unit of the cell's flux. It heats the modes by `sum_s delta_s F_ms`, F_ms the integral of mode m over part s, and by
//! reciprocity the mean temperature of what is in contact differs by `(1/c_k) sum_s delta_s F_ms` times the mode's amplitude from
//! that of the whole cell. Modes without states act on parts through the same first-order shapes as on the cells, and what
//! these do not contain, within the cell, by a direct feedthrough.
//!
//! Theory: docs/theory.md, section 6.5.

use super::modes::{ModeResponses, Modes, Scratch};
use super::{ReducedOperators, dot};
use crate::line::SurfaceInfluence;
use crate::line::contact_parts::{ContactParts, PARTS};
use numerics::dense;

/// Patterns of the cells partly in contact at a stage, and their responses. Their vectors have memory for all cells, so that no step
/// allocates.
#[derive(Debug)]
pub(crate) struct Patterns {
    contact_parts: ContactParts,
    /// Areas of the cells per depth, m.
    areas: Vec<f64>,
    /// The cells partly in contact, in their order.
    cells: Vec<usize>,
    /// Heat into every mode, m^(1/2), pattern by pattern.
    integrals: Vec<f64>,
    modes: usize,
    /// Feedthrough to the temperature integral of each pattern, K m3/W.
    feedthrough: Vec<f64>,
    /// Heat to the air and out of the far face in the long run, m.
    passed: [Vec<f64>; 2],
    /// Step of the responses, s; not a number before they are known.
    step: f64,
    /// Responses of temperature and distortion of all cells to a unit flux into the cell of each pattern, pattern by pattern, beyond those
    /// of the whole cell.
    responses: [Vec<f64>; 2],
    /// Temperature of what is in contact of the cell of each pattern, above that of the whole cell, by unit fluxes into all whole cells.
    seen: Vec<f64>,
}

impl Clone for Patterns {
    fn clone(&self) -> Patterns {
        let copy = |own: &Vec<f64>| with_room(own, own.capacity());
        Patterns {
            contact_parts: self.contact_parts.clone(),
            areas: self.areas.clone(),
            cells: with_room(&self.cells, self.cells.capacity()),
            integrals: copy(&self.integrals),
            modes: self.modes,
            feedthrough: copy(&self.feedthrough),
            passed: self.passed.each_ref().map(copy),
            step: self.step,
            responses: self.responses.each_ref().map(copy),
            seen: copy(&self.seen),
        }
    }
}

/// A copy with memory for `most` values.
fn with_room<T: Copy>(values: &[T], most: usize) -> Vec<T> {
    let mut copy = Vec::with_capacity(most);
    copy.extend_from_slice(values);
    copy
}

impl Patterns {
    /// None yet, with memory for all cells.
    pub(crate) fn new(operators: &ReducedOperators, modes: &Modes) -> Patterns {
        let count = operators.widths.len();
        let most = if operators.part_areas.is_empty() { 0 } else { count };
        let room = |size: usize| Vec::with_capacity(size);
        Patterns {
            contact_parts: ContactParts::whole(count),
            areas: operators.widths.clone(),
            cells: Vec::with_capacity(most),
            integrals: room(most * modes.count()),
            modes: modes.count(),
            feedthrough: room(most),
            passed: [room(most), room(most)],
            step: f64::NAN,
            responses: [room(most * most), room(most * most)],
            seen: room(most * most),
        }
    }

    /// Whether all cells are whole.
    pub(crate) fn is_empty(&self) -> bool {
        self.cells.is_empty()
    }

    /// Makes the patterns of these parts in contact; `None`: whole cells.
    pub(crate) fn set_contact_parts(
        &mut self,
        contact_parts: Option<&ContactParts>,
        operators: &ReducedOperators,
        modes: &Modes,
    ) {
        if contact_parts.map_or(self.is_empty(), |parts| self.contact_parts == *parts)
            || operators.part_areas.is_empty()
        {
            return;
        }
        match contact_parts {
            Some(parts) => self.contact_parts.copy_from(parts),
            None => self.contact_parts.make_whole(),
        }
        let contact_parts = &self.contact_parts;
        self.step = f64::NAN;
        self.cells.clear();
        self.integrals.clear();
        self.feedthrough.clear();
        self.passed.iter_mut().for_each(Vec::clear);
        for cell in (0..operators.widths.len()).filter(|&cell| contact_parts.is_partial(cell)) {
            let parts = cell * PARTS..(cell + 1) * PARTS;
            let areas = &operators.part_areas[parts.clone()];
            let fractions: [f64; PARTS] = std::array::from_fn(|part| contact_parts.of_part(cell, part));
            let touching = dot(areas, &fractions);
            let whole: f64 = areas.iter().sum();
            let pattern = fractions.map(|fraction| fraction * whole / touching - 1.0);
            self.cells.push(cell);
            let first = self.integrals.len();
            self.integrals.resize(first + modes.count(), 0.0);
            for (part, weight) in parts.clone().zip(pattern) {
                let sum = self.integrals[first..].iter_mut().zip(modes.over_part(part));
                sum.for_each(|(sum, integral)| *sum += weight * integral);
            }
            let block = &operators.remainder[cell * PARTS * PARTS..(cell + 1) * PARTS * PARTS];
            let rows = block.chunks_exact(PARTS).zip(pattern);
            self.feedthrough.push(rows.map(|(row, weight)| weight * dot(row, &pattern)).sum());
            for (passed, flow) in self.passed.iter_mut().zip(&operators.passed) {
                passed.push(dot(&flow.by_part[parts.clone()], &pattern));
            }
        }
    }

    /// Cells with their patterns.
    fn all(&self) -> impl Iterator<Item = (usize, &[f64])> {
        self.cells.iter().copied().zip(self.integrals.chunks_exact(self.modes.max(1)))
    }

    /// Adds the heat of the fluxes `flux` into every mode.
    pub(crate) fn heat(&self, flux: &[f64], heat: &mut [f64]) {
        for (cell, integrals) in self.all() {
            heat.iter_mut().zip(integrals).for_each(|(heat, integral)| *heat += flux[cell] * integral);
        }
    }

    /// Adds to the values of the cells the products of their patterns with the modes' `sums`.
    pub(crate) fn add_by_cell(&self, sums: &[f64], values: &mut [f64]) {
        self.all().for_each(|(cell, integrals)| values[cell] += dot(integrals, sums));
    }

    /// Turns the mean temperatures of whole cells into those of the parts in contact; `surface`: amplitudes of the modes.
    pub(crate) fn show(&self, surface: &[f64], temperature: &mut [f64]) {
        for (cell, integrals) in self.all() {
            temperature[cell] += dot(integrals, surface) / self.areas[cell];
        }
    }

    /// Heat flow to the air (0) or out of the far face (1) in the long run, W/m, by the fluxes.
    pub(crate) fn passed(&self, place: usize, flux: &[f64]) -> f64 {
        self.cells.iter().zip(&self.passed[place]).map(|(&cell, passed)| passed * flux[cell]).sum()
    }

    /// Computes the responses at a stage of a step of `step` s, unless they are known.
    pub(crate) fn prepare(&mut self, step: f64, modes: &Modes, by_heat: &ModeResponses, scratch: &mut Scratch) {
        if self.is_empty() || self.step == step {
            return;
        }
        self.step = step;
        let Patterns { cells, integrals, areas, feedthrough, responses: [warm, moved], seen, .. } = self;
        let (count, modes_count) = (areas.len(), self.modes.max(1));
        for values in [&mut *warm, &mut *moved, &mut *seen] {
            values.clear();
            values.resize(cells.len() * count, 0.0);
        }
        let responses =
            warm.chunks_exact_mut(count).zip(moved.chunks_exact_mut(count)).zip(seen.chunks_exact_mut(count));
        let patterns = integrals.chunks_exact(modes_count).zip(&*feedthrough).zip(&*cells);
        for (((own, feedthrough), &cell), ((warm, moved), seen)) in patterns.zip(responses) {
            modes.respond(own, by_heat, &mut scratch.surface, [&mut *warm, moved]);
            for ((seen, rise), area) in seen.iter_mut().zip(&*warm).zip(&*areas) {
                *seen = rise * area / areas[cell];
            }
            for (&other, integrals) in cells.iter().zip(integrals.chunks_exact(modes_count)) {
                warm[other] += dot(integrals, &scratch.surface) / areas[other];
            }
            warm[cell] += feedthrough / areas[cell];
        }
    }

    /// Cells with the responses of their patterns: of temperature, of distortion, and of their own temperature.
    fn responding(&self) -> impl Iterator<Item = (usize, [&[f64]; 3])> {
        let [warm, moved, seen] =
            [&self.responses[0], &self.responses[1], &self.seen].map(|values| values.chunks_exact(self.areas.len()));
        let responses = warm.zip(moved).zip(seen).map(|((warm, moved), seen)| [warm, moved, seen]);
        self.cells.iter().copied().zip(responses)
    }

    /// Adds the responses to fluxes into the cells, beyond those of whole cells.
    pub(crate) fn respond(&self, flux: &[f64], [mut temperature, mut distortion]: [Option<&mut [f64]>; 2]) {
        for (cell, [warm, moved, seen]) in self.responding() {
            if let Some(temperature) = &mut temperature {
                dense::multiply_add(warm, &flux[cell..=cell], temperature);
                temperature[cell] += dot(seen, flux);
            }
            if let Some(distortion) = &mut distortion {
                dense::multiply_add(moved, &flux[cell..=cell], distortion);
            }
        }
    }

    /// Adds the responses to the surface influence matrices of whole cells.
    pub(crate) fn add_influence(&self, influence: &mut SurfaceInfluence) {
        for (cell, [warm, moved, seen]) in self.responding() {
            for i in 0..warm.len() {
                influence.temperature[(i, cell)] += warm[i];
                influence.temperature[(cell, i)] += seen[i];
                influence.distortion[(i, cell)] += moved[i];
            }
        }
    }
}
