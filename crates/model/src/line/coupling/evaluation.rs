//! Evaluations of one stage iteration: friction heat and its partition, temperatures of both surfaces, the gap.
//!
//! Theory: docs/theory.md, sections 6.1, 6.4.

use super::ThermalCoupling;
use crate::line::heat::state::{CELL_LANES, HeatState};
use conduction::line::{First, GAMMA, Stage};
use contact::wear::line::StageError;
use numerics::maximum::maximum;

impl ThermalCoupling {
    /// Free response of both bodies at the first stage: temperature and distortion for zero flux into its cells.
    pub(super) fn begin_first(&mut self, state: &HeatState) -> [Option<First>; 2] {
        self.deviate_faces(state);
        let back = -GAMMA * state.ahead(self.step);
        let firsts = [0, 1].map(|side| {
            let response = [&mut self.iterate.free_response[side][..], &mut self.iterate.free_distortion[side]];
            let around = &self.surroundings[side];
            let (Some(own), Some(work)) = (&self.bodies[side], &mut self.work[side]) else {
                follow_ambient(around.first.ambient, response);
                return None;
            };
            let deviation = &mut self.flux[0][side];
            deviation.iter_mut().zip(&state.slope[side]).for_each(|(value, slope)| *value = back * slope);
            let first = own.first(&state.bodies[side], around, deviation, response, work);
            self.faces.set_free(side, first.faces);
            Some(first)
        });
        if !self.faces.is_empty() {
            self.begin_faces(Stage::First, state);
        }
        firsts
    }

    /// The same at the end of the step, after the first stage. The bodies may advance from it.
    pub(super) fn begin_end(&mut self, mut firsts: [Option<First>; 2], state: &HeatState) {
        self.ends = [0, 1].map(|side| {
            let response = [&mut self.iterate.free_response[side][..], &mut self.iterate.free_distortion[side]];
            let around = &self.surroundings[side];
            let (Some(own), Some(first), Some(work)) = (&self.bodies[side], firsts[side].take(), &mut self.work[side])
            else {
                follow_ambient(around.end.ambient, response);
                return None;
            };
            let end = own.end(first, &state.bodies[side], around, &self.flux[0][side], response, work);
            self.faces.set_free(side, end.faces);
            Some(end)
        });
        if !self.faces.is_empty() {
            self.begin_faces(Stage::End, state);
        }
    }

    pub(super) fn conducts(&self) -> [bool; 2] {
        self.bodies.each_ref().map(Option::is_some)
    }

    /// Adds the thermal compliance at the linearization point to the compliance of the contact, and determines whether it is
    /// exact: at the velocity and friction of the stage, and with its parts in contact.
    pub(super) fn install_thermal_compliance(&mut self, stage: Stage, slip: f64) -> Result<(), StageError> {
        let s = stage as usize;
        self.partitions[s].set_active_set(&self.iterate.closed);
        let known = self.is_solved_directly(self.partitions[s].open().len());
        let per_pressure = self.reference.per_pressure;
        let same_friction = |coefficient: &f64| coefficient * slip == per_pressure;
        let near = known && self.kinetic_coefficient.iter().all(same_friction);
        self.exact[s] = near && self.contact_parts[s].is_whole();
        let (slot, built) = (self.partitions.slot(), self.partitions[s].thermal_compliance(per_pressure));
        if built || self.installed[s] != slot {
            self.installed[s] = usize::MAX;
            self.contacts[s].set_added_compliance(Some(self.partitions[s].thermal_compliance_matrix()))?;
            self.installed[s] = slot;
        }
        self.reduced[s] = near && self.conducts() == [true, true];
        self.contacts[s].set_low_rank_update(if self.reduced[s] { self.partitions[s].low_rank_update() } else { None });
        Ok(())
    }

    /// Whether the frozen operators are exact while `open` cells exchange no heat, provided that friction is that of the
    /// linearization point.
    pub(super) fn is_solved_directly(&self, open: usize) -> bool {
        let partition = self.conducts() != [true, true] || self.partitions[0].is_exact_with(open);
        self.reference.exact && partition
    }

    /// Friction heat of the stage at the current pressure, and its partition by which the surface temperatures satisfy the
    /// interface law; returns the residual before this correction, see [`ThermalCoupling::residual_norm`].
    ///
    /// Where the operators of the stage are exact no iterate is needed: the pressure is set to 0, and the partition is that
    /// without friction heat.
    pub(super) fn assemble_fluxes(&mut self, stage: Stage, slip: f64) -> f64 {
        let s = stage as usize;
        let conducts = self.conducts();
        let exchanges = conducts == [true, true] && self.parameters.half_resistance > 0.0;
        for ((per_pressure, kinetic_coefficient), ratio) in
            self.iterate.per_pressure.iter_mut().zip(&self.kinetic_coefficient).zip(&self.parameters.ratio)
        {
            *per_pressure = kinetic_coefficient * slip * ratio;
        }
        let (friction, [punch, strip]) = (&mut self.friction[s], &mut self.flux[s]);
        if self.exact[s] {
            self.iterate.pressure.fill(0.0);
            friction.fill(0.0);
            punch.fill(0.0);
            strip.fill(0.0);
            if exchanges {
                let [of_punch, of_strip] = &self.iterate.free_response;
                self.iterate
                    .difference
                    .iter_mut()
                    .zip(of_strip.iter().zip(of_punch))
                    .for_each(|(residual, (strip, punch))| *residual = strip - punch);
                self.partitions[s].exchange(&self.iterate.difference, punch);
                strip.iter_mut().zip(&*punch).for_each(|(strip, punch)| *strip = -punch);
            }
            self.iterate.temperatures_current = false;
            return 0.0;
        }
        let known = self.iterate.pressure.iter().zip(&self.iterate.per_pressure);
        for (heat, (pressure, per_pressure)) in friction.iter_mut().zip(known) {
            *heat = per_pressure * pressure;
        }
        let open = self.partitions[s].open();
        open.iter().for_each(|&i| (friction[i], punch[i]) = (0.0, 0.0));
        match conducts {
            [true, true] if exchanges => {}
            [true, true] => punch.iter_mut().zip(&*friction).for_each(|(punch, heat)| *punch = 0.5 * heat),
            [true, false] => punch.copy_from_slice(friction),
            [false, _] => punch.fill(0.0),
        }
        rest(strip, friction, punch, conducts[1]);
        if !exchanges {
            return 0.0;
        }
        if !self.iterate.temperatures_current {
            self.update_temperatures(stage);
        }
        let residual_norm = self.residual_norm(stage);
        self.iterate.temperatures_current = false;
        let (friction, [punch, strip]) = (&self.friction[s], &mut self.flux[s]);
        self.partitions[s].exchange(&self.iterate.difference, punch);
        rest(strip, friction, punch, true);
        residual_norm
    }

    /// Residual of the interface law: deficit of the punch's surface temperature for its flux, cell by cell, in `difference`.
    fn residual(&mut self, stage: Stage) {
        let s = stage as usize;
        let ([punch, strip], [punch_flux, strip_flux]) = (&self.temperature[s], &self.flux[s]);
        let (surfaces, fluxes) = (strip.iter().zip(punch), strip_flux.iter().zip(punch_flux));
        let cells = surfaces.zip(fluxes).zip(&self.half_resistance[s]);
        for (residual, (((strip, punch), (given, taken)), half)) in self.iterate.difference.iter_mut().zip(cells) {
            *residual = strip - punch + half * (given - taken);
        }
        self.partitions[s].open().iter().for_each(|&i| self.iterate.difference[i] = 0.0);
    }

    /// Largest residual of the interface law, relative to the largest rise and jump of temperature; the residuals of the cells,
    /// in K, are left in `difference`.
    fn residual_norm(&mut self, stage: Stage) -> f64 {
        let s = stage as usize;
        self.residual(stage);
        let [punch, strip] = self.temperature[s].each_ref().map(|surface| largest(surface));
        let jump = self.parameters.half_resistance * largest(&self.friction[s]);
        let scale = maximum(maximum(punch, strip), jump);
        if scale == 0.0 { 0.0 } else { largest(&self.iterate.difference) / scale }
    }

    /// [`ThermalCoupling::residual_norm`] at the present fluxes.
    pub(super) fn residual_after(&mut self, stage: Stage) -> f64 {
        if self.conducts() != [true, true] || self.parameters.half_resistance == 0.0 {
            return 0.0;
        }
        if !self.iterate.temperatures_current {
            self.update_temperatures(stage);
        }
        self.residual_norm(stage)
    }

    /// Gap before the deformation by the pressure: with wear and distortion, less the displacement of the current pressure
    /// through the thermal compliance. The part that is thermal distortion is left in `distortion`.
    pub(super) fn assemble_gap(&mut self, stage: Stage, gap: &[f64]) {
        let s = stage as usize;
        let moved = &mut self.distortion;
        let [punch, strip] = &self.iterate.free_distortion;
        moved.iter_mut().zip(punch.iter().zip(strip)).for_each(|(moved, (punch, strip))| *moved = punch + strip);
        if self.exact[s] {
            // The fluxes into strip and punch are opposite.
            if self.bodies.iter().all(Option::is_some) && self.parameters.expands.contains(&true) {
                self.partitions[s].distort_relatively(&self.flux[s][0], moved);
            }
        } else {
            self.iterate
                .difference
                .iter_mut()
                .zip(&self.iterate.pressure)
                .for_each(|(less, pressure)| *less = -pressure);
            self.partitions[s].add_displacement(self.reduced[s], &self.iterate.difference, moved);
            for side in 0..2 {
                if let (Some(own), Some(work), true) =
                    (&self.bodies[side], &mut self.work[side], self.parameters.expands[side])
                {
                    own.respond(stage, &self.flux[s][side], [None, Some(moved)], work);
                }
            }
        }
        self.iterate
            .gap
            .iter_mut()
            .zip(gap.iter().zip(&*moved))
            .for_each(|(target, (gap, moved))| *target = gap + moved);
    }

    /// Sets the pressure found and updates the friction heat; returns the change of the pressure, relative to the largest. At a
    /// change of at most `enough` the heat partition stays as it is.
    pub(super) fn update_pressure(&mut self, stage: Stage, pressure: &[f64], enough: f64) -> f64 {
        let s = stage as usize;
        if self.exact[s] {
            return self.update_pressure_exactly(stage, pressure);
        }
        let most = maximum(largest(pressure), largest(&self.iterate.pressure));
        for ((own, new), moved) in self.iterate.pressure.iter_mut().zip(pressure).zip(&mut self.iterate.gap) {
            *moved = new - *own;
            *own = *new;
        }
        let change = largest(&self.iterate.gap);
        let known = self.iterate.pressure.iter().zip(&self.iterate.per_pressure);
        for ((own, difference), (pressure, per_pressure)) in
            self.friction[s].iter().zip(&mut self.iterate.difference).zip(known)
        {
            *difference = per_pressure * pressure - own;
        }
        // Open cells have no friction heat.
        self.partitions[s].open().iter().for_each(|&i| self.iterate.difference[i] = 0.0);
        for (friction, more) in self.friction[s].iter_mut().zip(&self.iterate.difference) {
            *friction += more;
        }
        let change = if most == 0.0 { 0.0 } else { change / most };
        self.iterate.temperatures_current = false;
        let conducts = self.conducts();
        let [punch, strip] = &mut self.flux[s];
        match conducts {
            [true, true] if change <= enough => {}
            [true, true] => self.partitions[s].add_punch_flux(&self.iterate.difference, punch),
            [true, false] => punch.copy_from_slice(&self.friction[s]),
            [false, _] => {}
        }
        rest(strip, &self.friction[s], punch, conducts[1]);
        change
    }

    /// [`ThermalCoupling::update_pressure`] with exact operators: from zero pressure, without iteration.
    fn update_pressure_exactly(&mut self, stage: Stage, pressure: &[f64]) -> f64 {
        let s = stage as usize;
        self.iterate.pressure.copy_from_slice(pressure);
        for ((heat, pressure), per_pressure) in
            self.friction[s].iter_mut().zip(pressure).zip(&self.iterate.per_pressure)
        {
            *heat = per_pressure * pressure;
        }
        let conducts = self.conducts();
        let (friction, [punch, strip]) = (&self.friction[s], &mut self.flux[s]);
        match conducts {
            [true, true] => self.partitions[s].add_punch_flux_exactly(friction, punch),
            [true, false] => punch.copy_from_slice(friction),
            [false, _] => {}
        }
        rest(strip, friction, punch, conducts[1]);
        0.0
    }

    /// Temperatures of both surfaces by their fluxes.
    pub(super) fn update_temperatures(&mut self, stage: Stage) {
        let s = stage as usize;
        self.iterate.temperatures_current = true;
        if self.exact[s] && self.parameters.half_resistance > 0.0 && self.bodies.iter().all(Option::is_some) {
            // The temperature of the strip's surface follows from the interface law.
            let [punch, strip] = &mut self.temperature[s];
            punch.copy_from_slice(&self.iterate.free_response[0]);
            if let (Some(own), Some(work)) = (&self.bodies[0], &mut self.work[0]) {
                own.respond(stage, &self.flux[s][0], [Some(punch), None], work);
            }
            let [taken, given] = &self.flux[s];
            let fluxes = taken.iter().zip(given).zip(&self.half_resistance[s]);
            for ((strip, punch), ((taken, given), half)) in strip.iter_mut().zip(&*punch).zip(fluxes) {
                *strip = punch - half * (given - taken);
            }
            // The law does not hold on open cells, whose surfaces are separated.
            let open = self.partitions[s].open();
            if open.len() == strip.len() {
                strip.copy_from_slice(&self.iterate.free_response[1]);
            } else {
                open.iter()
                    .zip(self.partitions[s].open_temperature_jump())
                    .for_each(|(&i, open_temperature_jump)| strip[i] = punch[i] - open_temperature_jump);
            }
            return;
        }
        for side in 0..2 {
            let temperature = &mut self.temperature[s][side];
            temperature.copy_from_slice(&self.iterate.free_response[side]);
            if let (Some(own), Some(work), false) = (&self.bodies[side], &mut self.work[side], self.open) {
                own.respond(stage, &self.flux[s][side], [Some(temperature), None], work);
            }
        }
        // The surface temperature of an insulator follows from the second interface law; a cell without contact is given the
        // temperature of the other body.
        let conducts = self.conducts();
        if let [true, false] | [false, true] = conducts {
            let own = usize::from(!conducts[1]);
            for i in 0..self.iterate.closed.len() {
                let open_temperature_jump =
                    if self.iterate.closed[i] { self.friction[s][i] * self.parameters.half_resistance } else { 0.0 };
                self.temperature[s][own][i] = self.temperature[s][1 - own][i] + open_temperature_jump;
            }
        }
    }

    /// Adds the cells that carry pressure, or are partly in contact, to the active set of heat exchange, and removes those that do
    /// not, but for cells that have been added in this stage; returns whether the set stays as it was. Without any pressure no
    /// cell exchanges heat.
    ///
    /// So the iteration ends, and a cell that opens with heat and closes without it, which has no consistent state, exchanges heat.
    pub(super) fn update_active_set(&mut self, stage: Stage, pressure: &[f64]) -> bool {
        let contact_parts = &self.contact_parts[stage as usize];
        let mut settled = true;
        let touches = !contact_parts.is_whole() && pressure.iter().any(|p| *p > 0.0);
        let cells = self.iterate.closed.iter_mut().zip(&mut self.iterate.added);
        for (i, ((closed, added), p)) in cells.zip(pressure).enumerate() {
            let carries = *p > 0.0 || touches && contact_parts.is_partial(i);
            if carries != *closed && (carries || !*added) {
                (*closed, *added) = (carries, *added || carries);
                settled = false;
                self.iterate.temperatures_current = false;
            }
        }
        settled
    }

    /// Thermal distortion of both surfaces at the end of the step: that of the last iteration plus the displacement of the
    /// pressure found through the thermal compliance.
    pub(super) fn distort_by_contact(&mut self) {
        self.partitions[1].add_displacement(self.reduced[1], &self.iterate.pressure, &mut self.distortion);
    }
}

/// Free response of an insulator.
fn follow_ambient(ambient: f64, [temperature, distortion]: [&mut [f64]; 2]) {
    temperature.fill(ambient);
    distortion.fill(0.0);
}

/// Largest absolute value; NaN if a value is not finite.
pub(super) fn largest(values: &[f64]) -> f64 {
    let more = |most: f64, value: f64| if value.abs() > most { value.abs() } else { most };
    let (groups, rest) = values.as_chunks::<CELL_LANES>();
    // A product with 0 is NaN where the comparison would pass over a number that is not finite.
    let (mut most, mut nothing) = ([0.0; CELL_LANES], [0.0; CELL_LANES]);
    for group in groups {
        for k in 0..CELL_LANES {
            most[k] = more(most[k], group[k]);
            nothing[k] += 0.0 * group[k];
        }
    }
    let nothing = nothing.iter().sum::<f64>() + rest.iter().map(|value| 0.0 * value).sum::<f64>();
    most.into_iter().chain(rest.iter().copied()).fold(0.0, more) + nothing
}

/// Flux into the strip: the friction heat less the flux into the punch; 0 for an insulator.
fn rest(strip: &mut [f64], friction: &[f64], punch: &[f64], conducts: bool) {
    if conducts {
        strip.iter_mut().zip(friction.iter().zip(punch)).for_each(|(strip, (heat, punch))| *strip = heat - punch);
    } else {
        strip.fill(0.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_that_is_not_finite_is_not_passed_over() {
        for count in [1, 7, 8, 9, 33] {
            let mut values: Vec<f64> = (0..count).map(|i| -0.5 - f64::from(i)).collect();
            assert_eq!(largest(&values), 0.5 + f64::from(count - 1));
            for place in 0..count as usize {
                for wrong in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
                    let right = std::mem::replace(&mut values[place], wrong);
                    assert!(largest(&values).is_nan(), "{wrong} at {place} of {count}");
                    values[place] = right;
                }
            }
        }
        assert_eq!(largest(&[]), 0.0);
    }
}
