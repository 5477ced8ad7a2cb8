//! Heat partition: the division of the friction heat between the bodies, and the thermal distortion by it, as operators on the
//! pressure.
//!
//! On the cells in contact
//!
//! ```text
//! (G_1 + G_2 + I/h_c) q_1 = b_2 - b_1 + (G_2 + I/(2 h_c)) Q,    q_2 = Q - q_1
//! q_1 = y + Y Q,    u_T = d_1 + d_2 + (D_1 - D_2) y + E_0 Q,    E_0 = (D_1 - D_2) Y + D_2
//! ```
//!
//! On cells partly in contact h_c is multiplied by the fraction in contact. Cells that do not exchange heat have zero flux, with a jump of temperature as its multiplier. With the inverse P of the first
//! matrix and o the set of these cells
//!
//! ```text
//! q_1 = (I - P_:o P_oo^-1 I_o:) (y + Y Q),    E_0 less (D_1 - D_2) P_:o P_oo^-1 Y_o:
//! ```
//!
//! An insulator receives no heat. At h_c = 0 the surfaces do not exchange heat, and each receives half of the friction heat.
//!
//! Building these operators costs N^3, and the strip's influence matrices change with the velocity. So they are built at a
//! linearization point and reused within its validity radius; a stage iterates with them on the residual of its own influence
//! matrices, at N^2 per iteration. Those of cells partly in contact follow from those of whole cells by a low-rank update for
//! rounded parts, since edges move from step to step.
//!
//! Theory: docs/theory.md, sections 6.2, 6.5.

mod parts;
#[cfg(test)]
mod tests;

use conduction::line::SurfaceInfluence;
use conduction::line::contact_parts::ContactParts;
use conduction::properties::Scales;
use contact::{LowRankUpdate, largest_update_rank};
use nalgebra::DMatrix;
use numerics::dense;

/// Operators on all cells, by columns.
#[derive(Clone, Debug)]
struct Operators {
    /// Inverse of G_1 + G_2 + I/h_c: one product is faster than two substitutions, whose operations depend on each other. Iteration
    /// removes the error from its rounding.
    inverse: Vec<f64>,
    /// Partition matrix Y.
    shares: Vec<f64>,
    /// Relative distortion D_1 - D_2, m per W/m2.
    relative_distortion: Vec<f64>,
    /// E_0, m per W/m2.
    distortion: Vec<f64>,
}

impl Operators {
    fn new(count: usize) -> Operators {
        let square = || vec![0.0; count * count];
        Operators { inverse: square(), shares: square(), relative_distortion: square(), distortion: square() }
    }

    fn copy_from(&mut self, other: &Operators) {
        self.inverse.copy_from_slice(&other.inverse);
        self.shares.copy_from_slice(&other.shares);
        self.relative_distortion.copy_from_slice(&other.relative_distortion);
        self.distortion.copy_from_slice(&other.distortion);
    }
}

/// Operators of whole cells with the same step and velocity, and the influence of every cell of the punch on itself.
#[derive(Clone, Debug)]
struct WholeCells {
    operators: Operators,
    self_influence: Vec<f64>,
}

/// Step (s), reference velocity (m/s), and properties of punch and strip, of which the operators are a function.
pub(crate) type PartitionKey = (f64, f64, [Scales; 2]);

/// Heat partition operators of a stage. Nothing is allocated after construction.
#[derive(Clone, Debug)]
pub struct HeatPartition {
    resistance: Option<f64>,
    /// Step (s) and velocity (m/s) for which the operators were built.
    key: Option<PartitionKey>,
    /// Parts in contact for which they were built.
    contact_parts: ContactParts,
    operators: Operators,
    /// Where cells may be partly in contact.
    of_whole: Option<WholeCells>,
    /// Cells that exchange heat; the others, and the factors of their block of the inverse.
    closed: Vec<bool>,
    open: Vec<usize>,
    known: bool,
    factors: Vec<f64>,
    /// P_:o P_oo^-1 by columns, for up to as many open cells as a [`LowRankUpdate`] holds.
    removed: Vec<f64>,
    exchanged: Vec<usize>,
    /// Thermal compliance E_0 dQ/dp, m/Pa, added to the compliance of the contact, and dQ/dp = mu s v at the mean radius where mu
    /// is the same for all cells.
    thermal_compliance: DMatrix<f64>,
    per_pressure: f64,
    /// Sliding velocity of the cells over that at the mean radius.
    ratio: Vec<f64>,
    /// Low-rank update of the thermal compliance by open cells, for the heat per pressure `reduced_by`; see [`LowRankUpdate`].
    left: Vec<f64>,
    right: Vec<f64>,
    reduced_by: f64,
    column: Vec<f64>,
    multipliers: Vec<f64>,
    /// See [`HeatPartition::open_temperature_jump`].
    open_temperature_jump: Vec<f64>,
}

impl HeatPartition {
    /// Workspace for cells that slide at `ratio` times the velocity at the mean radius, with the contact
    /// conductance `conductance` (W/(m2 K)).
    pub fn new(ratio: &[f64], conductance: f64) -> HeatPartition {
        let count = ratio.len();
        HeatPartition {
            resistance: (conductance > 0.0).then(|| 1.0 / conductance),
            key: None,
            contact_parts: ContactParts::whole(count),
            operators: Operators::new(count),
            of_whole: None,
            closed: vec![false; count],
            open: Vec::with_capacity(count),
            known: false,
            factors: vec![0.0; count * count],
            removed: vec![0.0; count * largest_update_rank(count)],
            exchanged: vec![0; count],
            thermal_compliance: dense::untouched(count),
            per_pressure: f64::NAN,
            ratio: ratio.to_vec(),
            left: vec![0.0; count * largest_update_rank(count)],
            right: vec![0.0; count * largest_update_rank(count)],
            reduced_by: f64::NAN,
            column: vec![0.0; count],
            multipliers: vec![0.0; count],
            open_temperature_jump: vec![0.0; count],
        }
    }

    /// Workspace for another heat partition of these cells.
    pub(crate) fn like(&self) -> HeatPartition {
        let conductance = self.resistance.map_or(0.0, f64::recip);
        let partition = HeatPartition { resistance: self.resistance, ..HeatPartition::new(&self.ratio, conductance) };
        if self.of_whole.is_some() { partition.with_parts() } else { partition }
    }

    /// Whether the operators were built for this key and these parts in contact.
    pub(crate) fn is_for(&self, key: PartitionKey, contact_parts: &ContactParts) -> bool {
        self.key == Some(key) && self.contact_parts == *contact_parts
    }

    /// Builds the operators from the surface influence matrices (`None`: an insulator) with these parts in contact.
    pub fn build(
        &mut self,
        key: PartitionKey,
        contact_parts: &ContactParts,
        influence: [Option<&SurfaceInfluence>; 2],
    ) {
        self.contact_parts.copy_from(contact_parts);
        self.assemble(key, influence);
    }

    /// Builds the operators with the current parts in contact.
    fn assemble(&mut self, key: PartitionKey, influence: [Option<&SurfaceInfluence>; 2]) {
        let HeatPartition { operators, contact_parts, .. } = self;
        let count = self.closed.len();
        self.key = Some(key);
        self.known = false;
        self.per_pressure = f64::NAN;
        match influence {
            [Some(punch), Some(strip)] => {
                let (own, other) = (strip.temperature.as_slice(), punch.temperature.as_slice());
                operators.shares.fill(0.0);
                operators.inverse.fill(0.0);
                for (entry, (own, other)) in self.factors.iter_mut().zip(own.iter().zip(other)) {
                    *entry = own + other;
                }
                if let Some(resistance) = self.resistance {
                    for i in 0..count {
                        self.factors[i * count + i] += resistance / contact_parts.fraction(i);
                        operators.inverse[i * count + i] = 1.0;
                    }
                    dense::factorise(&mut self.factors, count, &mut self.exchanged);
                    for column in operators.inverse.chunks_exact_mut(count) {
                        dense::substitute(&self.factors, count, &self.exchanged, column);
                    }
                    let columns = operators.shares.chunks_exact_mut(count).zip(own.chunks_exact(count));
                    for (i, (share, own)) in columns.enumerate() {
                        self.column.copy_from_slice(own);
                        self.column[i] += 0.5 * resistance / contact_parts.fraction(i);
                        dense::multiply_add(&operators.inverse, &self.column, share);
                    }
                } else {
                    (0..count).for_each(|i| operators.shares[i * count + i] = 0.5);
                }
                let (own, other) = (strip.distortion.as_slice(), punch.distortion.as_slice());
                for (entry, (own, other)) in operators.relative_distortion.iter_mut().zip(own.iter().zip(other)) {
                    *entry = other - own;
                }
                operators.distortion.copy_from_slice(strip.distortion.as_slice());
                let Operators { shares, relative_distortion, distortion, .. } = operators;
                dense::multiply_add_columns(relative_distortion, shares, distortion, count);
            }
            [Some(only), None] | [None, Some(only)] => operators.distortion.copy_from_slice(only.distortion.as_slice()),
            [None, None] => operators.distortion.fill(0.0),
        }
    }

    /// Which cells exchange heat.
    pub(crate) fn closed(&self) -> &[bool] {
        &self.closed
    }

    /// Sets the active set of cells that exchange heat, and factors the block of the others.
    pub fn set_active_set(&mut self, closed: &[bool]) {
        if self.known && self.closed == closed {
            return;
        }
        self.known = true;
        self.reduced_by = f64::NAN;
        self.closed.copy_from_slice(closed);
        self.open.clear();
        self.open.extend((0..closed.len()).filter(|&i| !closed[i]));
        let (count, m) = (closed.len(), self.open.len());
        if m == 0 || m == count || self.resistance.is_none() {
            return;
        }
        for (target, &j) in self.factors.chunks_exact_mut(m).zip(&self.open) {
            let column = &self.operators.inverse[j * count..(j + 1) * count];
            target.iter_mut().zip(&self.open).for_each(|(entry, &i)| *entry = column[i]);
        }
        dense::factorise(&mut self.factors[..m * m], m, &mut self.exchanged[..m]);
        if m > largest_update_rank(count) {
            return;
        }
        for k in 0..m {
            let solution = &mut self.multipliers[..m];
            solution.fill(0.0);
            solution[k] = 1.0;
            dense::substitute(&self.factors[..m * m], m, &self.exchanged[..m], solution);
            let column = &mut self.removed[k * count..(k + 1) * count];
            column.fill(0.0);
            for (value, &j) in solution.iter().zip(&self.open) {
                dense::multiply_add(&self.operators.inverse[j * count..(j + 1) * count], &[*value], column);
            }
        }
    }

    /// Adds to the punch's flux the correction that removes the temperature difference `residual` (strip above punch, interface
    /// resistance included, K) on the cells that exchange heat; on the others it is 0.
    ///
    /// Multipliers `y` on the open cells that keep their fluxes at 0, `P_oo y = (P residual)_o` with the inverse P, solve the
    /// equations of the closed ones: for few open cells this costs hardly more than the product.
    pub fn exchange(&mut self, residual: &[f64], flux: &mut [f64]) {
        let (count, m) = (self.closed.len(), self.open.len());
        if m == count {
            return;
        }
        self.open_temperature_jump[..m].fill(0.0);
        self.column.fill(0.0);
        dense::multiply_add(&self.operators.inverse, residual, &mut self.column);
        self.constrain_open_cells();
        flux.iter_mut().zip(&self.column).for_each(|(flux, more)| *flux += more);
    }

    /// Constrains the fluxes in `column` to zero on open cells, by jumps of temperature there.
    fn constrain_open_cells(&mut self) {
        let (count, m) = (self.closed.len(), self.open.len());
        if m == 0 {
            return;
        }
        let multipliers = &mut self.multipliers[..m];
        multipliers.iter_mut().zip(&self.open).for_each(|(value, &i)| *value = -self.column[i]);
        let few = m <= largest_update_rank(count);
        if few {
            dense::multiply_add(&self.removed[..count * m], multipliers, &mut self.column);
        }
        dense::substitute(&self.factors[..m * m], m, &self.exchanged[..m], multipliers);
        for ((value, &j), open_temperature_jump) in
            multipliers.iter().zip(&self.open).zip(&mut self.open_temperature_jump)
        {
            if !few {
                dense::multiply_add(&self.operators.inverse[j * count..(j + 1) * count], &[*value], &mut self.column);
            }
            *open_temperature_jump += value;
        }
        self.open.iter().for_each(|&i| self.column[i] = 0.0);
    }

    /// Whether the thermal compliance of two conducting bodies is exact at `open` open cells: with its low-rank update, whose
    /// rank is limited.
    pub(crate) fn is_exact_with(&self, open: usize) -> bool {
        open <= largest_update_rank(self.closed.len()) || open == self.closed.len() || self.resistance.is_none()
    }

    /// Low-rank update by open cells of the current thermal compliance, for two conducting bodies.
    pub(crate) fn low_rank_update(&mut self) -> Option<LowRankUpdate<'_>> {
        let (count, m) = (self.closed.len(), self.open.len());
        if m == 0 || m > largest_update_rank(count) || m == count || self.resistance.is_none() {
            return None;
        }
        let (left, right) = (&mut self.left[..count * m], &mut self.right[..m * count]);
        if self.reduced_by != self.per_pressure {
            self.reduced_by = self.per_pressure;
            left.fill(0.0);
            for (target, &j) in left.chunks_exact_mut(count).zip(&self.open) {
                dense::multiply_add(
                    &self.operators.relative_distortion,
                    &self.operators.inverse[j * count..(j + 1) * count],
                    target,
                );
            }
            let columns = right.chunks_exact_mut(m).zip(self.operators.shares.chunks_exact(count)).zip(&self.ratio);
            for ((target, share), ratio) in columns {
                let heat = self.per_pressure * ratio;
                target.iter_mut().zip(&self.open).for_each(|(value, &i)| *value = heat * share[i]);
                dense::substitute(&self.factors[..m * m], m, &self.exchanged[..m], target);
            }
        }
        Some(LowRankUpdate { acting: &self.closed, left, right })
    }

    /// Adds the displacement by `pressure` through the current thermal compliance, with the low-rank update where it is
    /// `reduced`.
    pub(crate) fn add_displacement(&mut self, reduced: bool, pressure: &[f64], moved: &mut [f64]) {
        dense::multiply_add(self.thermal_compliance.as_slice(), pressure, moved);
        if !reduced {
            return;
        }
        let mut room = std::mem::take(&mut self.multipliers);
        if let Some(LowRankUpdate { left, right, .. }) = self.low_rank_update() {
            let weights = &mut room[..left.len() / moved.len()];
            weights.fill(0.0);
            dense::multiply_add(right, pressure, weights);
            weights.iter_mut().for_each(|weight| *weight = -*weight);
            dense::multiply_add(left, weights, moved);
        }
        self.multipliers = room;
    }

    /// Temperature of the punch above the strip (K) on the cells that do not exchange heat, in their order, by the fluxes of the
    /// last [`HeatPartition::exchange`] and later additions of [`HeatPartition::add_punch_flux_exactly`]; valid while other cells exchange
    /// heat.
    pub(crate) fn open_temperature_jump(&self) -> &[f64] {
        &self.open_temperature_jump[..self.open.len()]
    }

    /// Cells that do not exchange heat.
    pub(crate) fn open(&self) -> &[usize] {
        &self.open
    }

    /// Leaves the punch's part of the friction heat (W/m2) in `column`, for all cells in contact.
    fn share_on_all(&mut self, heat: &[f64]) {
        self.column.fill(0.0);
        dense::multiply_add(&self.operators.shares, heat, &mut self.column);
    }

    /// Adds to the punch's flux its part of additional friction heat (W/m2), which is 0 on open cells.
    pub(crate) fn add_punch_flux(&mut self, heat: &[f64], flux: &mut [f64]) {
        self.share_on_all(heat);
        self.open.iter().for_each(|&i| self.column[i] = 0.0);
        flux.iter_mut().zip(&self.column).for_each(|(flux, more)| *flux += more);
    }

    /// Adds to the punch's flux its part of all friction heat (W/m2), which is 0 on open cells, with the multipliers that keep
    /// the flux at 0 there.
    pub fn add_punch_flux_exactly(&mut self, heat: &[f64], flux: &mut [f64]) {
        if self.resistance.is_none() || self.open.len() == self.closed.len() {
            return self.add_punch_flux(heat, flux);
        }
        self.share_on_all(heat);
        self.constrain_open_cells();
        flux.iter_mut().zip(&self.column).for_each(|(flux, more)| *flux += more);
    }

    /// Adds the distortion of two conducting bodies, m, by a flux (W/m2) from the strip into the punch.
    pub fn distort_relatively(&self, flux: &[f64], moved: &mut [f64]) {
        dense::multiply_add(&self.operators.relative_distortion, flux, moved);
    }

    /// Current thermal compliance, by columns, m/Pa.
    pub(crate) fn thermal_compliance_values(&self) -> &[f64] {
        self.thermal_compliance.as_slice()
    }

    /// Partition matrix Y on all cells, by columns: fraction of the friction heat that enters the punch where both bodies
    /// conduct.
    #[cfg(test)]
    pub(crate) fn shares(&self) -> &[f64] {
        &self.operators.shares
    }

    /// Current thermal compliance, m/Pa.
    pub(crate) fn thermal_compliance_matrix(&self) -> &DMatrix<f64> {
        &self.thermal_compliance
    }

    /// Builds the thermal compliance for the friction heat `per_pressure` (m/s: mu s v at the mean radius); false where it is the
    /// current one.
    pub(crate) fn thermal_compliance(&mut self, per_pressure: f64) -> bool {
        if self.per_pressure == per_pressure {
            return false;
        }
        self.per_pressure = per_pressure;
        self.thermal_compliance.as_mut_slice().copy_from_slice(&self.operators.distortion);
        for (mut column, ratio) in self.thermal_compliance.column_iter_mut().zip(&self.ratio) {
            column *= per_pressure * ratio;
        }
        true
    }
}
