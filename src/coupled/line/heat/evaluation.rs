//! What one repetition of a stage evaluates: friction heat and its split, temperatures of both surfaces, the gap.

use super::Heat;
use crate::contact::dense;
use crate::contact::friction::FrictionLaw;
use crate::heat::line::{GAMMA, Stage};
use crate::wear::line::StageError;

impl Heat {
    /// Temperature and distortion of both bodies at the stage if no heat came in it.
    pub(super) fn begin(&mut self, stage: Stage, state: &super::state::HeatState) {
        for side in 0..2 {
            let (base, distortion) = (&mut self.base[side], &mut self.base_distortion[side]);
            match &self.bodies[side] {
                Some(own) => {
                    let around = &self.surroundings[side];
                    let known = &mut self.flux[0][side];
                    if stage == Stage::First {
                        let back = -GAMMA * self.step;
                        known.iter_mut().zip(&state.slope[side]).for_each(|(value, slope)| *value = back * slope);
                    }
                    match (stage, self.staggered) {
                        (Stage::End, false) => own.base_of_end(&state.bodies[side], around, known, base, distortion),
                        _ => own.base(&state.bodies[side], around, stage, known, base, distortion),
                    }
                }
                None => {
                    base.fill(self.surroundings[side].ambient);
                    distortion.fill(0.0);
                }
            }
        }
    }

    pub(super) fn conducts(&self) -> [bool; 2] {
        self.bodies.each_ref().map(Option::is_some)
    }

    /// Puts the distortion by the stage's own heat, at the reference, on the contact's compliance.
    pub(super) fn operator(&mut self, stage: Stage) -> Result<(), StageError> {
        let s = stage as usize;
        self.splits[s].close(&self.closed);
        let per_pressure = self.reference.per_pressure;
        if !self.renewed[s]
            && let Some(extra) = self.splits[s].extra(per_pressure)
        {
            self.contacts[s].set_extra(Some(extra))?;
        }
        Ok(())
    }

    /// Makes the operators of the stage's own gains and friction, where those of the reference do not converge.
    pub(super) fn renew(&mut self, stage: Stage, slip: f64) {
        let s = stage as usize;
        let gains = self.bodies.each_ref().map(|body| body.as_ref().map(|own| own.gains(stage)));
        self.splits[s].build((f64::NAN, f64::NAN), gains);
        if let Some(fading) = &mut self.fading {
            fading.build(&self.splits[s], gains, self.half_resistance);
        }
        let mean = self.faded.iter().sum::<f64>() / self.faded.len() as f64;
        if let Some(extra) = self.splits[s].extra(mean * slip) {
            // Gains are finite, and so is their product with a velocity.
            let _ = self.contacts[s].set_extra(Some(extra));
        }
        self.renewed[s] = true;
    }

    /// Takes into the operators of the stage that friction follows the temperature.
    pub(super) fn linearise(&mut self, stage: Stage, slip: f64, friction: &FrictionLaw) -> Result<(), StageError> {
        let s = stage as usize;
        let Some(fading) = &mut self.fading else { return Ok(()) };
        let (closed, pressure) = (&self.closed, &self.pressure);
        let (faded, felt) = (&self.faded, &self.felt);
        let heat = fading.linearise(
            |i| if closed[i] { slip * faded[i] } else { 0.0 },
            |i| if closed[i] { slip * pressure[i] * friction.fall(felt[i]) } else { 0.0 },
        );
        self.contacts[s].set_extra(Some(self.splits[s].extra_by(heat)))?;
        self.linearised = true;
        Ok(())
    }

    /// Friction heat of the stage with the pressure known so far, and the split of it in which both surfaces agree; returns
    /// how far they were from that, see [`Heat::lacks`].
    pub(super) fn supply(&mut self, stage: Stage, slip: f64) -> f64 {
        let s = stage as usize;
        let conducts = self.conducts();
        self.exact[s] = self.reference.exact && !self.renewed[s];
        for i in 0..self.closed.len() {
            self.per_pressure[i] = self.faded[i] * slip;
            self.exact[s] &= self.closed[i] && self.per_pressure[i] == self.reference.per_pressure;
            self.friction[s][i] = if self.closed[i] { self.per_pressure[i] * self.pressure[i] } else { 0.0 };
        }
        let [punch, strip] = &mut self.flux[s];
        for i in 0..self.closed.len() {
            let heat = self.friction[s][i];
            punch[i] = match conducts {
                _ if !self.closed[i] => 0.0,
                [true, true] if self.half_resistance > 0.0 => punch[i],
                [true, true] => 0.5 * heat,
                [true, false] => heat,
                [false, _] => 0.0,
            };
            strip[i] = if conducts[1] { heat - punch[i] } else { 0.0 };
        }
        if conducts != [true, true] || self.half_resistance == 0.0 {
            return 0.0;
        }
        if !self.warmed {
            self.warm(stage);
        }
        let lacks = self.lacks(stage);
        self.warmed = false;
        let [punch, strip] = &mut self.flux[s];
        self.splits[s].exchange(&self.difference, punch);
        for i in 0..self.closed.len() {
            strip[i] = self.friction[s][i] - punch[i];
        }
        lacks
    }

    /// Temperature by which the punch's surface is too cold for its flux, cell by cell, in `difference`.
    fn lacking(&mut self, stage: Stage) {
        let s = stage as usize;
        let ([punch, strip], [punch_flux, strip_flux]) = (&self.temperature[s], &self.flux[s]);
        for i in 0..self.closed.len() {
            self.difference[i] = if self.closed[i] {
                strip[i] - punch[i] + self.half_resistance * (strip_flux[i] - punch_flux[i])
            } else {
                0.0
            };
        }
    }

    /// How far the surfaces are from the law of the interface, relative to the largest rise and jump of temperature; cell by
    /// cell, in K, in `difference`.
    fn lacks(&mut self, stage: Stage) -> f64 {
        let s = stage as usize;
        self.lacking(stage);
        let largest = |values: &[f64]| values.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
        let scale = (largest(&self.temperature[s][0]).max(largest(&self.temperature[s][1])))
            .max(self.half_resistance * largest(&self.friction[s]));
        if scale > 0.0 { largest(&self.difference) / scale } else { 0.0 }
    }

    /// The gap with everything that moves it, less what the pressure known so far does through the contact's extra
    /// compliance.
    pub(super) fn undeformed(&mut self, stage: Stage, gap: &[f64]) {
        let s = stage as usize;
        for (i, target) in self.gap.iter_mut().enumerate() {
            *target = gap[i] + self.base_distortion[0][i] + self.base_distortion[1][i];
            self.difference[i] = -self.pressure[i];
        }
        dense::multiply_add(self.splits[s].extra_values(), &self.difference, &mut self.gap);
        for side in 0..2 {
            if let (Some(own), true) = (&self.bodies[side], self.expands[side]) {
                dense::multiply_add(own.gains(stage).distortion.as_slice(), &self.flux[s][side], &mut self.gap);
            }
        }
    }

    /// Takes the pressure found, with its share of heat; returns how much it differs from the one known before, relative to
    /// the largest. A difference of no more than `enough` leaves the split as it is.
    pub(super) fn take(&mut self, stage: Stage, pressure: &[f64], enough: f64) -> f64 {
        let s = stage as usize;
        let (mut change, mut largest): (f64, f64) = (0.0, 0.0);
        for i in 0..pressure.len() {
            let difference = pressure[i] - self.pressure[i];
            change = change.max(difference.abs());
            largest = largest.max(pressure[i]).max(self.pressure[i]);
            let heat = if self.closed[i] { self.per_pressure[i] * pressure[i] } else { 0.0 };
            self.gap[i] = difference;
            self.difference[i] = heat - self.friction[s][i];
            self.pressure[i] = pressure[i];
        }
        if let (Some(fading), true) = (&self.fading, self.linearised) {
            // The temperature that follows is that of the friction at that temperature.
            self.difference.fill(0.0);
            fading.add_heat(&self.gap, &mut self.difference);
        }
        for (friction, more) in self.friction[s].iter_mut().zip(&self.difference) {
            *friction += more;
        }
        let change = if largest > 0.0 { change / largest } else { 0.0 };
        self.warmed = false;
        let conducts = self.conducts();
        let [punch, strip] = &mut self.flux[s];
        match conducts {
            [true, true] if change <= enough => {}
            [true, true] => self.splits[s].share(&self.difference, punch),
            [true, false] => punch.copy_from_slice(&self.friction[s]),
            [false, _] => {}
        }
        for i in 0..pressure.len() {
            strip[i] = if conducts[1] { self.friction[s][i] - punch[i] } else { 0.0 };
        }
        change
    }

    /// Temperatures of both surfaces by their fluxes.
    pub(super) fn warm(&mut self, stage: Stage) {
        let s = stage as usize;
        self.warmed = true;
        for side in 0..2 {
            let temperature = &mut self.temperature[s][side];
            temperature.copy_from_slice(&self.base[side]);
            if let Some(own) = &self.bodies[side] {
                dense::multiply_add(own.gains(stage).temperature.as_slice(), &self.flux[s][side], temperature);
            }
        }
        // An insulator's surface follows from the second law of the interface.
        let conducts = self.conducts();
        if let [true, false] | [false, true] = conducts {
            let own = usize::from(!conducts[1]);
            for i in 0..self.closed.len() {
                if self.closed[i] && self.half_resistance > 0.0 {
                    self.temperature[s][own][i] =
                        self.temperature[s][1 - own][i] + self.friction[s][i] * self.half_resistance;
                }
            }
        }
    }

    /// Whether all cells that carry pressure exchange heat; if not, they do from now on.
    pub(super) fn settle(&mut self, pressure: &[f64]) -> bool {
        let mut settled = true;
        for (closed, p) in self.closed.iter_mut().zip(pressure) {
            if *p > 0.0 && !*closed {
                *closed = true;
                settled = false;
                self.warmed = false;
            }
        }
        settled
    }

    /// Displacement of both surfaces by heat at the end of the step.
    pub(super) fn distort(&mut self) {
        for (i, moved) in self.distortion.iter_mut().enumerate() {
            *moved = self.base_distortion[0][i] + self.base_distortion[1][i];
        }
        for side in 0..2 {
            if let (Some(own), true) = (&self.bodies[side], self.expands[side]) {
                dense::multiply_add(
                    own.gains(Stage::End).distortion.as_slice(),
                    &self.flux[1][side],
                    &mut self.distortion,
                );
            }
        }
    }
}
