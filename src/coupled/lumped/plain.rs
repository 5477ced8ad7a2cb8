//! The step in the regime that most drives are in, written out: both bodies conduct, dead load, constant
//! conditions, friction and temperature on one segment of the fade table, no bristle, everything at ambient temperature but
//! what friction has heated.
//!
//! The same equations as [`super::stages`], whose general form costs three times as much here. Nothing is solved
//! differently. A test runs both side by side.

use super::conditions::Conditions;
use super::operators::{BodyOperators, Operators};
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

type Pair = [f64; 2];

/// Product of a matrix with the values at both stages.
#[inline]
fn apply(matrix: &[Pair; 2], values: Pair) -> Pair {
    [matrix[0][0] * values[0] + matrix[0][1] * values[1], matrix[1][0] * values[0] + matrix[1][1] * values[1]]
}

/// Product of two matrices.
#[inline]
fn product(left: &[Pair; 2], right: &[Pair; 2]) -> [Pair; 2] {
    let columns = [apply(left, [right[0][0], right[1][0]]), apply(left, [right[0][1], right[1][1]])];
    [[columns[0][0], columns[1][0]], [columns[0][1], columns[1][1]]]
}

#[inline]
fn inverse(matrix: &[Pair; 2]) -> [Pair; 2] {
    let factor = 1.0 / (matrix[0][0] * matrix[1][1] - matrix[0][1] * matrix[1][0]);
    [[matrix[1][1] * factor, -matrix[0][1] * factor], [-matrix[1][0] * factor, matrix[0][0] * factor]]
}

/// Cooling of the strip's surface, linearised: the flux into it at both stages is `level + gain into`, with `into` the
/// contact's heat into the strip.
struct Air {
    level: Pair,
    gain: [Pair; 2],
}

impl Air {
    /// The law made straight at the temperatures that the heat `into` gives; `cooled` is the surface without contact and
    /// cooling flux, `contact` and `own` are its gains from both, `forced` as in [`Conditions`].
    #[inline]
    fn new(
        body: &BodyOperators,
        reference: f64,
        cooled: Pair,
        contact: &[Pair; 2],
        own: &[Pair; 2],
        into: Pair,
        forced: f64,
    ) -> Air {
        let heated = apply(contact, into);
        let (mut level, mut slope) = ([0.0; 2], [0.0; 2]);
        for i in 0..2 {
            let guess = cooled[i] + heated[i];
            slope[i] = cooling_slope(body, reference, guess, forced);
            let straight = cooling_flux(body, reference, guess, 0.0, forced) + slope[i] * guess;
            level[i] = straight - slope[i] * cooled[i];
        }
        let implicit = inverse(&[
            [1.0 + slope[0] * own[0][0], slope[0] * own[0][1]],
            [slope[1] * own[1][0], 1.0 + slope[1] * own[1][1]],
        ]);
        let driven = [
            [-slope[0] * contact[0][0], -slope[0] * contact[0][1]],
            [-slope[1] * contact[1][0], -slope[1] * contact[1][1]],
        ];
        Air { level: apply(&implicit, level), gain: product(&implicit, &driven) }
    }

    #[inline]
    fn flux(&self, into: Pair) -> Pair {
        let driven = apply(&self.gain, into);
        [self.level[0] + driven[0], self.level[1] + driven[1]]
    }
}

impl Stepper<'_> {
    /// Carries `state` over the step if the regime and the bound of the error allow it.
    #[inline]
    pub fn plain(&mut self, state: &mut State, now: &Conditions) -> Option<Attempt> {
        let operators = self.operators;
        if !operators.plain || now.ambient != 0.0 || now.punch_far != 0.0 || now.strip_far != 0.0 {
            return None;
        }
        let (punch, strip) = (self.propagators.punch.as_ref()?, self.propagators.strip.as_ref()?);
        let (punch_count, strip_count) = (operators.punch.heat.as_ref()?.count, operators.strip.heat.as_ref()?.count);
        let reference = state.reference;
        let punch_of = |point: usize| punch.contact.of_states(point, &state.punch.heat, punch_count);
        let strip_of = |point: usize| strip.contact.of_states(point, &state.strip.heat, strip_count);
        let punch_level = [punch_of(0), punch_of(2)];
        let cooled = [strip_of(0), strip_of(2)];
        let entry = strip_entry(operators, state);
        let mut strip_level = [cooled[0] + entry, cooled[1] + entry];
        let punch_gain = [punch.contact.gain[0][0], punch.contact.gain[0][2]];
        let own_gain = [strip.contact.gain[0][0], strip.contact.gain[0][2]];
        let mut strip_gain = own_gain;
        if operators.flash.is_some() {
            for (i, point) in [0, 2].into_iter().enumerate() {
                strip_level[i] += self.flash.homogeneous(point, &state.flash);
                strip_gain[i][0] += self.flash.gain[point][0];
                strip_gain[i][1] += self.flash.gain[point][1];
            }
        }
        let pressure = now.load / operators.area;
        // Friction on the segment of its table that the last step has left it on.
        let fade = self.friction.fade.line(state.end_temperature + reference);
        let driver = self.friction.coefficient * now.stribeck * now.slip * operators.power_factor * pressure;

        let cools = operators.strip.variable_cooling;
        let air_gain = [strip.contact.gain[COOLING][0], strip.contact.gain[COOLING][2]];
        let mut air = Air { level: [0.0; 2], gain: [[0.0; 2]; 2] };
        if cools {
            // Nearly all of the heat enters the better conductor.
            let guess = [driver * fade.factor(state.end_temperature + reference); 2];
            air = Air::new(&operators.strip, reference, cooled, &own_gain, &air_gain, guess, now.forced);
            let levels = apply(&air_gain, air.level);
            let gains = product(&air_gain, &air.gain);
            for i in 0..2 {
                strip_level[i] += levels[i];
                strip_gain[i][0] += gains[i][0];
                strip_gain[i][1] += gains[i][1];
            }
        }
        let half_resistance = operators.half_resistance;
        let (mut into_punch, mut into_strip, mut heat, mut error) = ([0.0; 2], [0.0; 2], [0.0; 2], 0.0);
        if pressure > 0.0 {
            let exchange = [
                [punch_gain[0][0] + strip_gain[0][0] + 2.0 * half_resistance, punch_gain[0][1] + strip_gain[0][1]],
                [punch_gain[1][0] + strip_gain[1][0], punch_gain[1][1] + strip_gain[1][1] + 2.0 * half_resistance],
            ];
            let split = inverse(&exchange);
            let between = [strip_level[0] - punch_level[0], strip_level[1] - punch_level[1]];
            heat = if fade.slope == 0.0 {
                [driver * fade.value; 2]
            } else {
                // Temperature over heat is affine too: friction and temperature agree by one more solution of two equations.
                let by_heat = [
                    [strip_gain[0][0] + half_resistance, strip_gain[0][1]],
                    [strip_gain[1][0], strip_gain[1][1] + half_resistance],
                ];
                let by_flux = [
                    [punch_gain[0][0] + half_resistance, punch_gain[0][1]],
                    [punch_gain[1][0], punch_gain[1][1] + half_resistance],
                ];
                let none = apply(&by_flux, apply(&split, between));
                let mut gain = product(&by_flux, &product(&split, &by_heat));
                gain[0][0] -= 0.5 * half_resistance;
                gain[1][1] -= 0.5 * half_resistance;
                let feedback = driver * fade.slope;
                // Friction that rises steeply with its own heat may have several solutions.
                if feedback * (gain[0][0].abs() + gain[0][1].abs()).max(gain[1][0].abs() + gain[1][1].abs()) > 0.5 {
                    return None;
                }
                let agree = inverse(&[
                    [1.0 - feedback * gain[0][0], -feedback * gain[0][1]],
                    [-feedback * gain[1][0], 1.0 - feedback * gain[1][1]],
                ]);
                let level = |i: usize| fade.factor(punch_level[i] + none[i] + reference);
                apply(&agree, [driver * level(0), driver * level(1)])
            };
            let kept = apply(&strip_gain, heat);
            into_punch = apply(
                &split,
                [between[0] + kept[0] + half_resistance * heat[0], between[1] + kept[1] + half_resistance * heat[1]],
            );
            into_strip = [heat[0] - into_punch[0], heat[1] - into_punch[1]];
            let scale = heat[0]
                .max(heat[1])
                .max(0.1 * into_punch[0].abs().max(into_punch[1].abs()))
                .max(0.02 * state.peak_flux)
                .max(operators.least_flux);
            let defect = 0.5 * (into_punch[1] - into_punch[0]).abs();
            // The resistance grows during the step: at its end it bounds that at the point 2/3.
            let resistance = exchange[1][0] + exchange[1][1];
            let allowed = 2.0 * operators.scene.tolerance * scale;
            error = (defect / layer_allowance(resistance, scale, state) + 0.5 * (heat[1] - heat[0]).abs()) / allowed;
            if error.is_nan() || error > 1.0 {
                // The bound is not enough: the residual of the contact conditions at the point 2/3 decides.
                self.flash.prepare_middle(operators);
                let mut gain = strip.contact.gain[0][1];
                let mut strip_middle = strip_of(1) + entry;
                if operators.flash.is_some() {
                    strip_middle += self.flash.homogeneous(1, &state.flash);
                    gain = [gain[0] + self.flash.gain[1][0], gain[1] + self.flash.gain[1][1]];
                }
                if cools {
                    strip_middle += strip.contact.of_flux(COOLING, 1, air.flux(into_strip));
                }
                let own = &punch.contact.gain[0][1];
                let punch_middle = punch_of(1) + own[0] * into_punch[0] + own[1] * into_punch[1];
                strip_middle += gain[0] * into_strip[0] + gain[1] * into_strip[1];
                let between = 0.5 * (into_strip[0] + into_strip[1] - into_punch[0] - into_punch[1]);
                let jump = punch_middle - strip_middle - half_resistance * between;
                let resistance = 2.0 * half_resistance + own[0] + own[1] + gain[0] + gain[1];
                let factor = fade.factor(0.5 * (punch_middle + strip_middle) + reference);
                let other_heat = (driver * factor - 0.5 * (heat[0] + heat[1])).abs();
                error = (jump.abs() / (resistance * layer_allowance(resistance, scale, state)) + other_heat) / allowed;
                if error.is_nan() || error > 1.0 {
                    return error.is_finite().then_some(Attempt { error, hottest: strip_level[1] });
                }
            }
        }
        let air_flux = air.flux(into_strip);
        if cools {
            // What the straight law leaves of the true one.
            let heated = apply(&own_gain, into_strip);
            let aired = apply(&air_gain, air_flux);
            let mut left: f64 = 0.0;
            for i in 0..2 {
                let t = cooled[i] + heated[i] + aired[i];
                let wanted = cooling_flux(&operators.strip, reference, t, 0.0, now.forced);
                left = left.max(((wanted - air_flux[i]) * air_gain[1][i]).abs());
            }
            if left > 1e-3 * operators.scene.tolerance * (1e-3 + state.peak_rise) {
                return None;
            }
        }
        let (punch_rise, strip_rise) = (apply(&punch_gain, into_punch), apply(&strip_gain, into_strip));
        let punch_surface = [punch_level[0] + punch_rise[0], punch_level[1] + punch_rise[1]];
        let strip_surface = [strip_level[0] + strip_rise[0], strip_level[1] + strip_rise[1]];
        let hottest = punch_surface[1].max(strip_surface[1]);
        if !hottest.is_finite() {
            return None;
        }
        let rises = [0.5 * (punch_surface[0] + strip_surface[0]), 0.5 * (punch_surface[1] + strip_surface[1])];
        if rises.iter().any(|rise| !fade.holds(rise + reference)) {
            return None;
        }
        let faded = rises.map(|rise| self.friction.coefficient * fade.factor(rise + reference));
        let mut rates = [[0.0; 2]; 2];
        for (body, rates) in [&operators.punch, &operators.strip].into_iter().zip(&mut rates) {
            let rate = |i: usize| {
                body.wear.rate(pressure, now.slip, faded[i], rises[i] + reference)
                    * (body.wear_factor * self.tunables.wear_acceleration)
            };
            rates[0] = rate(0);
            rates[1] = rates[0];
            if operators.wear_follows_temperature {
                rates[1] = rate(1);
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
        fluxes[COOLING] = air_flux;
        strip.advance(&mut state.strip.heat, strip_count, &fluxes, [true, cools, false, false]);
        if operators.flash.is_some() {
            self.flash.advance(&mut state.flash, into_strip);
        }
        let mean = |values: [f64; 2]| step * (QUADRATURE[0] * values[0] + QUADRATURE[1] * values[1]);
        state.punch.received[0] += mean(into_punch);
        state.strip.received[0] += mean(into_strip);
        state.strip.received[COOLING] += mean(air_flux);
        let travel = step * now.velocity;
        state.dissipated += mean(heat);
        state.distance += travel.abs();
        let worn = rates.map(mean);
        state.wear(operators, worn, travel);
        state.far = [0.0; 2];
        state.end_temperature = rises[1];
        state.end_force = faded[1] * now.stribeck * now.sign * pressure * operators.per_pressure;
        state.peak_rise = state.peak_rise.max(rises[0].abs()).max(rises[1].abs());
        state.peak_flux = state.peak_flux.max(heat[0]).max(heat[1]);
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
    use crate::variables::{STARTS, find, reference};
    use std::sync::Arc;

    #[test]
    fn the_plain_form_is_the_general_form() {
        for (path, stroke, fades) in [(2.0, 0.0, false), (1.0, 0.0, false), (1.0, 0.05, false), (2.0, 0.0, true)] {
            let mut values = STARTS;
            if fades {
                let first = find("contact.friction_fade.factor[1]").unwrap() as usize;
                values[first..first + 8].copy_from_slice(&[1.0, 0.9, 0.95, 0.6, 0.5, 0.45, 0.4, 0.35]);
                values[const { reference("strip.emissivity") } as usize] = 0.55;
            }
            // Where friction follows the temperature, so do heat and wear.
            let agreement = if fades { 3e-5 } else { 1e-12 };
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
                assert!((left.dissipated - right.dissipated).abs() <= agreement * right.dissipated);
                assert!((left.punch.depth - right.punch.depth).abs() <= agreement * right.punch.depth);
                let (one, other) = (left.punch.received[0], right.punch.received[0]);
                assert!((one - other).abs() <= 3e-4 * other.abs(), "second {second}: {one} {other}");
            }
        }
    }
}
