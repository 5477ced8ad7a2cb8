//! The step in the regime that most drives are in, written out: both bodies conduct, dead load, constant
//! conditions, a friction coefficient that does not change meanwhile, no bristle, everything at ambient temperature but what friction has heated.
//!
//! The same equations as [`super::stages`], whose general form costs twice as much here. Nothing is solved
//! differently. A test runs both side by side.

use super::conditions::Conditions;
use super::operators::Operators;
use super::point::{cooling_flux, cooling_slope, strip_entry};
use super::stage::QUADRATURE;
use super::stages::layer_allowance;
use super::state::State;
use super::step::{Attempt, Stepper};
use crate::heat::reduced::{PORTS, Port};

const COOLING: usize = Port::Cooling as usize;

/// Whether a scene can ever be in this regime.
pub fn possible(operators: &Operators) -> bool {
    let scene = &operators.scene;
    operators.punch.heat.is_some()
        && operators.strip.heat.is_some()
        && scene.conductance > 0.0
        && operators.series_stiffness == 0.0
        && operators.bristle().is_none()
        && !operators.punch.variable_cooling
        && (!operators.strip.variable_cooling || operators.strip.cooled_is_contact)
}

impl Stepper<'_> {
    /// Carries `state` over the step if the regime and the bound of the error allow it.
    #[inline]
    pub fn plain(&mut self, state: &mut State, now: &Conditions) -> Option<Attempt> {
        let operators = self.operators;
        // Steps cut small ask for cooling solved finer than two passes give.
        if !operators.plain || self.cut > 8.0 || now.ambient != 0.0 || now.punch_far != 0.0 || now.strip_far != 0.0 {
            return None;
        }
        let (punch, strip) = (self.propagators.punch.as_ref()?, self.propagators.strip.as_ref()?);
        let (punch_count, strip_count) = (operators.punch.heat.as_ref()?.count, operators.strip.heat.as_ref()?.count);
        let observed = |point: usize| {
            (
                punch.contact.of_states(point, &state.punch.heat, punch_count),
                strip.contact.of_states(point, &state.strip.heat, strip_count),
            )
        };
        let (first, last) = (observed(0), observed(2));
        let cooled = [first.1, last.1];
        let entry = strip_entry(operators, state);
        let mut moving = [entry; 2];
        let mut strip_gain = [strip.contact.gain[0][0], strip.contact.gain[0][2]];
        if operators.flash.is_some() {
            for (i, point) in [0, 2].into_iter().enumerate() {
                moving[i] += self.flash.homogeneous(point, &state.flash);
                strip_gain[i][0] += self.flash.gain[point][0];
                strip_gain[i][1] += self.flash.gain[point][1];
            }
        }
        let punch_level = [first.0, last.0];
        let punch_gain = [punch.contact.gain[0][0], punch.contact.gain[0][2]];
        let pressure = now.load / operators.area;
        let reference = state.reference;
        let (factor, slope) = self.friction.fade.at(state.end_temperature + reference);
        if slope != 0.0 {
            return None;
        }
        let faded = self.friction.coefficient * factor;
        let heat = faded * now.stribeck * now.slip * operators.power_factor * pressure;
        let half_resistance = operators.half_resistance;

        // Cooling of the strip's surface, first with a guess of the contact's heat, then with what it is.
        let mut air = [0.0; 2];
        let cools = operators.strip.variable_cooling;
        let breathe = |air: &mut [f64; 2], into: [f64; 2]| {
            let mut change: f64 = 0.0;
            for i in 0..2 {
                let contact = &strip.contact.gain[0][2 * i];
                let own = &strip.contact.gain[COOLING][2 * i];
                let t = cooled[i] + contact[0] * into[0] + contact[1] * into[1] + own[0] * air[0] + own[1] * air[1];
                let wanted = cooling_flux(&operators.strip, state.reference, t, 0.0, now.forced);
                let slope = cooling_slope(&operators.strip, state.reference, t, now.forced);
                let step = (wanted - air[i]) / (1.0 + slope * own[i]);
                air[i] += step;
                change = change.max((step * strip.contact.gain[COOLING][2][i]).abs());
            }
            change
        };
        if cools {
            // Nearly all of the heat enters the better conductor.
            breathe(&mut air, [heat; 2]);
        }
        let mut strip_level = [0.0; 2];
        for i in 0..2 {
            let own = &strip.contact.gain[COOLING][2 * i];
            strip_level[i] = cooled[i] + moving[i] + own[0] * air[0] + own[1] * air[1];
        }
        let (mut into_punch, mut into_strip, mut error) = ([0.0; 2], [0.0; 2], 0.0);
        if pressure > 0.0 {
            let m = [
                [punch_gain[0][0] + strip_gain[0][0] + 2.0 * half_resistance, punch_gain[0][1] + strip_gain[0][1]],
                [punch_gain[1][0] + strip_gain[1][0], punch_gain[1][1] + strip_gain[1][1] + 2.0 * half_resistance],
            ];
            let inverse = 1.0 / (m[0][0] * m[1][1] - m[0][1] * m[1][0]);
            let right = [0, 1].map(|i| {
                strip_level[i] - punch_level[i] + (strip_gain[i][0] + strip_gain[i][1] + half_resistance) * heat
            });
            into_punch = [
                (m[1][1] * right[0] - m[0][1] * right[1]) * inverse,
                (m[0][0] * right[1] - m[1][0] * right[0]) * inverse,
            ];
            into_strip = [heat - into_punch[0], heat - into_punch[1]];
            let scale = heat
                .max(0.1 * into_punch[0].abs().max(into_punch[1].abs()))
                .max(0.02 * state.peak_flux)
                .max(operators.least_flux);
            let defect = 0.5 * (into_punch[1] - into_punch[0]).abs();
            // The resistance grows during the step: at its end it bounds that at the point 2/3.
            let resistance = m[1][0] + m[1][1];
            let allowed = 2.0 * operators.scene.tolerance * scale;
            error = defect / (allowed * layer_allowance(resistance, scale, state));
            if error.is_nan() || error > 1.0 {
                // The bound is not enough: the residual of the contact conditions at the point 2/3 decides.
                self.flash.prepare_middle(operators);
                let middle = observed(1);
                let mut gain = strip.contact.gain[0][1];
                let mut moved = entry;
                if operators.flash.is_some() {
                    moved += self.flash.homogeneous(1, &state.flash);
                    gain = [gain[0] + self.flash.gain[1][0], gain[1] + self.flash.gain[1][1]];
                }
                let own = &punch.contact.gain[0][1];
                let punch_middle = middle.0 + own[0] * into_punch[0] + own[1] * into_punch[1];
                let strip_middle = middle.1
                    + moved
                    + strip.contact.of_flux(COOLING, 1, air)
                    + gain[0] * into_strip[0]
                    + gain[1] * into_strip[1];
                let between = 0.5 * (into_strip[0] + into_strip[1] - into_punch[0] - into_punch[1]);
                let jump = punch_middle - strip_middle - half_resistance * between;
                let resistance = 2.0 * half_resistance + own[0] + own[1] + gain[0] + gain[1];
                error = jump.abs() / (resistance * allowed * layer_allowance(resistance, scale, state));
                if error.is_nan() || error > 1.0 {
                    return error.is_finite().then_some(Attempt { error, hottest: strip_level[1] });
                }
            }
        }
        let enough = 1e-3 * operators.scene.tolerance * (1e-3 + state.peak_rise);
        if cools && breathe(&mut air, into_strip) > enough {
            return None;
        }
        let temperature = |i: usize| {
            let punch = punch_level[i] + punch_gain[i][0] * into_punch[0] + punch_gain[i][1] * into_punch[1];
            let strip = strip_level[i] + strip_gain[i][0] * into_strip[0] + strip_gain[i][1] * into_strip[1];
            (punch, strip)
        };
        let ((punch_first, strip_first), (punch_last, strip_last)) = (temperature(0), temperature(1));
        let hottest = punch_last.max(strip_last);
        if !hottest.is_finite() {
            return None;
        }
        let rises = [0.5 * (punch_first + strip_first), 0.5 * (punch_last + strip_last)];
        if !self.friction.fade.flat && rises.iter().any(|rise| self.friction.fade.at(rise + reference) != (factor, 0.0))
        {
            return None;
        }
        let mut rates = [[0.0; 2]; 2];
        for (body, rates) in [&operators.punch, &operators.strip].into_iter().zip(&mut rates) {
            let rate = |rise: f64| {
                body.wear.rate(pressure, now.slip, faded, rise + reference)
                    * (body.wear_factor * self.tunables.wear_acceleration)
            };
            rates[0] = rate(rises[0]);
            rates[1] = rates[0];
            if operators.wear_follows_temperature {
                rates[1] = rate(rises[1]);
                // Twice the change bounds the third difference that the general form measures.
                let scale = rates[0].max(rates[1]).max(0.02 * state.peak_wear).max(body.least_wear);
                if 2.0 * (rates[1] - rates[0]).abs() > 10.0 * operators.scene.tolerance * scale {
                    return None;
                }
            }
        }

        let step = self.propagators.step;
        let mut fluxes = [[0.0; 2]; PORTS];
        fluxes[0] = into_punch;
        punch.advance(&mut state.punch.heat, punch_count, &fluxes, [true, false, false, false]);
        fluxes[0] = into_strip;
        fluxes[COOLING] = air;
        strip.advance(&mut state.strip.heat, strip_count, &fluxes, [true, cools, false, false]);
        if operators.flash.is_some() {
            self.flash.advance(&mut state.flash, into_strip);
        }
        let mean = |values: [f64; 2]| step * (QUADRATURE[0] * values[0] + QUADRATURE[1] * values[1]);
        state.punch.received[0] += mean(into_punch);
        state.strip.received[0] += mean(into_strip);
        state.strip.received[COOLING] += mean(air);
        let travel = step * now.velocity;
        state.dissipated += step * heat;
        state.distance += travel.abs();
        let worn = rates.map(mean);
        state.wear(operators, worn, travel);
        state.far = [0.0; 2];
        state.end_temperature = rises[1];
        state.end_force = faded * now.stribeck * now.sign * pressure * operators.per_pressure;
        state.peak_rise = state.peak_rise.max(rises[0].abs()).max(rises[1].abs());
        state.peak_flux = state.peak_flux.max(heat);
        state.peak_wear = state.peak_wear.max(rates[0][1].max(rates[1][1]));
        Some(Attempt { error, hottest })
    }
}

#[cfg(test)]
mod tests {
    use super::super::Lumped;
    use super::super::conditions::Tunables;
    use super::super::operators::Operators;
    use crate::scene::Scene;
    use crate::variables::{STARTS, reference};
    use std::sync::Arc;

    #[test]
    fn the_plain_form_is_the_general_form() {
        for (path, stroke) in [(2.0, 0.0), (1.0, 0.0), (1.0, 0.05)] {
            let mut values = STARTS;
            values[const { reference("strip.path") } as usize] = path;
            values[const { reference("nominal.stroke") } as usize] = stroke;
            if path == 1.0 {
                // Elsewhere than on a closed path, variable cooling needs the general form.
                values[const { reference("strip.convection_forced") } as usize] = 0.0;
            }
            let scene = Scene::new(&values, None).unwrap();
            let plain = Operators::new(&scene);
            assert!(plain.plain);
            let general = Operators { plain: false, ..plain.clone() };
            let tunables = Tunables {
                friction_coefficient: scene.friction_coefficient,
                ambient_temperature: scene.ambient_temperature,
                wear_acceleration: 1.0,
            };
            let mut runs = [plain, general].map(|operators| Lumped::new(Arc::new(operators), tunables, &[0.0; 7]));
            for second in 0..40 {
                let speed = if second % 7 == 5 { 0.0 } else { 12.0 - 0.5 * f64::from(second % 20) };
                let load = if second % 5 == 3 { 0.0 } else { 700.0 * f64::from(second % 5) };
                for run in &mut runs {
                    for _ in 0..10 {
                        run.step(&[speed, load, 0.0, 0.0, 0.0, 0.0, 0.0], None, 0.1).unwrap();
                    }
                }
                let [plain, general] = &runs;
                let (left, right) = (plain.state(), general.state());
                let scale = right.peak_rise + 1e-9;
                // The two may cut a step differently, so they agree as two accurate solutions do.
                assert!((left.end_temperature - right.end_temperature).abs() < 5e-4 * scale, "second {second}");
                assert!((left.dissipated - right.dissipated).abs() <= 1e-12 * right.dissipated);
                assert!((left.punch.depth - right.punch.depth).abs() <= 1e-12 * right.punch.depth);
                let (one, other) = (left.punch.received[0], right.punch.received[0]);
                assert!((one - other).abs() <= 3e-4 * other.abs(), "second {second}: {one} {other}");
            }
        }
    }
}
