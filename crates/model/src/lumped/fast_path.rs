//! Fast path: the step specialised to the most common regime. Both bodies conduct; dead load; friction and temperature on one
//! segment of the fade table; no bristle; no temperature difference except by friction heat.
//!
//! The equations are those of [`super::stages`], whose general form takes three times as long here; their solution is the same. A
//! test compares both.
//!
//! Theory: docs/theory.md, sections 6.8, 5.4.

#[cfg(test)]
mod tests;

use super::air::{Air, BESIDE, FACES, PORTS_OF_FACES};
use super::conditions::Conditions;
use super::estimate::{LEAST_RISE, cooling_error, layer_allowance};
use super::operators::BodyOperators;
use super::point::{air_flux, cooling_slope, strip_entry};
use super::stage::{BASIS, Observed, QUADRATURE};
use numerics::maximum::{all_finite, maximum};

use super::state::LumpedState;
use super::stepper::{Attempt, Stepper};
use conduction::reduced::Port;

const COOLING: usize = Port::Cooling as usize;

type Pair = [f64; 2];
/// Matrix between the values at both stages, by rows.
type Matrix = [Pair; 2];

/// Product of a matrix with the values at both stages.
#[inline(always)]
fn apply(matrix: &Matrix, values: Pair) -> Pair {
    [matrix[0][0] * values[0] + matrix[0][1] * values[1], matrix[1][0] * values[0] + matrix[1][1] * values[1]]
}

/// Product of two matrices.
#[inline(always)]
fn product(left: &Matrix, right: &Matrix) -> Matrix {
    let columns = [apply(left, [right[0][0], right[1][0]]), apply(left, [right[0][1], right[1][1]])];
    [[columns[0][0], columns[1][0]], [columns[0][1], columns[1][1]]]
}

#[inline(always)]
fn inverse(matrix: &Matrix) -> Matrix {
    let factor = 1.0 / (matrix[0][0] * matrix[1][1] - matrix[0][1] * matrix[1][0]);
    [[matrix[1][1] * factor, -matrix[0][1] * factor], [-matrix[1][0] * factor, matrix[0][0] * factor]]
}

#[inline(always)]
fn sum(left: Pair, right: Pair) -> Pair {
    [left[0] + right[0], left[1] + right[1]]
}

/// Function of the conditions at both stages, evaluated once where they are equal.
#[inline(always)]
fn both<const SAME: bool>(at: [&Conditions; 2], of: impl Fn(&Conditions) -> f64) -> Pair {
    if SAME { [of(at[0]); 2] } else { at.map(of) }
}

/// Gain matrix from the stage fluxes of `port` to an observation at the stages.
#[inline(always)]
fn gain_at_stages(observed: &Observed, port: usize) -> Matrix {
    [observed.gain[port][0], observed.gain[port][2]]
}

/// Surface of the strip with its cooling eliminated: at both stages its temperature without the moving source is
/// `level + gain into`, with `into` the contact's heat into the strip, and the cooling flux into it is `offset - slope T` of that
/// temperature T.
struct Surface {
    level: Pair,
    gain: Matrix,
    offset: Pair,
    slope: Pair,
}

impl Surface {
    /// Eliminates the cooling of a surface with the temperatures `level` without contact and cooling flux; `forced` as in
    /// [`Conditions`]. Radiation is linearised at the temperatures of the heat `guess`; forced convection is linear.
    #[inline(always)]
    fn new(air_law: &Air, strip: &Observed, reference: f64, level: Pair, guess: Pair, forced: Pair) -> Surface {
        let (contact, air) = (gain_at_stages(strip, 0), gain_at_stages(strip, COOLING));
        let mut surface = Surface {
            level,
            gain: contact,
            offset: [0.0; 2],
            slope: forced.map(|forced| forced * air_law.forced + air_law.rest),
        };
        if air_law.emissivity > 0.0 {
            let heated = apply(&contact, guess);
            for i in 0..2 {
                let t = level[i] + heated[i];
                surface.slope[i] = cooling_slope(air_law, reference, t, forced[i]);
                surface.offset[i] = air_flux(air_law, reference, t, 0.0, forced[i]) + surface.slope[i] * t;
            }
            surface.level = sum(level, apply(&air, surface.offset));
        }
        let slope = surface.slope;
        let settle = inverse(&[
            [1.0 + air[0][0] * slope[0], air[0][1] * slope[1]],
            [air[1][0] * slope[0], 1.0 + air[1][1] * slope[1]],
        ]);
        surface.level = apply(&settle, surface.level);
        surface.gain = product(&settle, &contact);
        surface
    }

    #[inline(always)]
    fn temperature(&self, into: Pair) -> Pair {
        sum(self.level, apply(&self.gain, into))
    }

    #[inline(always)]
    fn flux(&self, into: Pair) -> Pair {
        let t = self.temperature(into);
        [self.offset[0] - self.slope[0] * t[0], self.offset[1] - self.slope[1] * t[1]]
    }

    /// Largest linearisation error of the cooling at either stage, as the temperature (K) that it causes at the end of the step.
    fn left(&self, air: &Air, strip: &Observed, reference: f64, into: Pair, forced: Pair) -> f64 {
        let (t, flux, gain) = (self.temperature(into), self.flux(into), strip.gain[COOLING][2]);
        let left = |i: usize| ((air_flux(air, reference, t[i], 0.0, forced[i]) - flux[i]) * gain[i]).abs();
        maximum(left(0), left(1))
    }
}

/// Arguments of the wear laws: conditions at the start and the three points, and pressure, friction coefficient and temperature
/// (K) at both stages.
struct Wearing<'a> {
    at: [&'a Conditions; 4],
    pressure: Pair,
    kinetic_coefficient: Pair,
    temperature: Pair,
}

impl Wearing<'_> {
    /// Wear rates of a body at both stages, m/s.
    #[inline(always)]
    fn rates<const CONSTANT: bool>(&self, stepper: &Stepper, body: &BodyOperators) -> Pair {
        let factor = body.wear_factor * stepper.tunables.wear_acceleration;
        let [_, first, _, last] = self.at;
        let rate = |now: &Conditions, i: usize| {
            body.wear.rate(self.pressure[i], now.slip, self.kinetic_coefficient[i], self.temperature[i]) * factor
        };
        let before = rate(first, 0);
        if CONSTANT && !stepper.operators.wear_follows_temperature { [before; 2] } else { [before, rate(last, 1)] }
    }

    /// See [`Stepper::wear_error`].
    #[inline(always)]
    fn error(&self, stepper: &Stepper, body: &BodyOperators, rates: &Pair, peak: f64) -> f64 {
        // A product of a linear pressure and a linear speed has no third difference.
        let is_quadratic =
            stepper.friction.regularization_velocity == 0.0 && body.wear.is_archard(self.kinetic_coefficient);
        if is_quadratic || !body.wear.active() {
            return 0.0;
        }
        self.general_error(stepper, body, rates, peak)
    }

    #[inline(never)]
    fn general_error(&self, stepper: &Stepper, body: &BodyOperators, rates: &Pair, peak: f64) -> f64 {
        let factor = body.wear_factor * stepper.tunables.wear_acceleration;
        let [start, _, middle, _] = self.at;
        // Linear extrapolation of the stage values.
        let rate = |now: &Conditions, stages: Pair| {
            let between = |values: Pair| stages[0] * values[0] + stages[1] * values[1];
            let pressure = now.load / stepper.operators.area;
            body.wear.rate(pressure, now.slip, between(self.kinetic_coefficient), between(self.temperature)) * factor
        };
        let others = [rate(start, [1.5, -0.5]), rate(middle, BASIS[1])];
        stepper.wear_error(body, rates, others, 0.0, (self.kinetic_coefficient[1], self.temperature[1]), peak)
    }
}

impl Stepper<'_> {
    /// Advances `state` over the step if regime and error permit; conditions `at` the start and the three points, all the same if
    /// `CONSTANT`. The moving source is prepared. Unless the error is at most 1, the state is unchanged.
    #[inline(always)]
    pub fn fast_path<const CONSTANT: bool>(
        &mut self,
        state: &mut LumpedState,
        at: [&Conditions; 4],
    ) -> Option<Attempt> {
        let operators = self.operators;
        // Makes their equality known to the compiler.
        let at = if CONSTANT { [at[0]; 4] } else { at };
        let [start, first, middle, last] = at;
        let elsewhere = |now: &Conditions| now.ambient != 0.0 || now.punch_far != 0.0 || now.strip_far != 0.0;
        // A linear function that is 0 at two points is 0 everywhere.
        if !operators.fast_path || elsewhere(first) || !CONSTANT && elsewhere(last) {
            return None;
        }
        let (punch, strip) = (self.propagators.punch?, self.propagators.strip?);
        let ([punch_contact, punch_mean], [strip_contact, strip_mean]) = (&punch.fast, &strip.fast);
        let (punch_count, strip_count) = (operators.punch.heat.as_ref()?.count, operators.strip.heat.as_ref()?.count);
        let reference = state.reference;
        // The load does not change its sign within a piece: its middle determines whether the contact is closed.
        let closed = middle.load > 0.0;
        let pressure_at = |now: &Conditions| if closed { now.load / operators.area } else { 0.0 };
        let pressure = both::<CONSTANT>([first, last], pressure_at);
        // Fade table linearised on the segment of the last temperature.
        let fade = self.friction.fade.line(state.end_temperature + reference);
        let scaled_friction = self.friction.coefficient * operators.power_factor;
        let driver_at = |now: &Conditions, pressure: f64| scaled_friction * now.stribeck * now.slip * pressure;
        let driver = if CONSTANT {
            [driver_at(first, pressure[0]); 2]
        } else {
            [driver_at(first, pressure[0]), driver_at(last, pressure[1])]
        };
        let forced = both::<CONSTANT>([first, last], |now| now.forced);

        let punch_level = punch.contact_at_stages(&state.punch.heat, punch_count);
        let punch_gain = gain_at_stages(punch_contact, 0);
        let uncooled = strip.contact_at_stages(&state.strip.heat, strip_count);
        let cools = operators.strip.cools_beside();
        let surface = if cools {
            // Nearly all of the heat enters the better conductor.
            let factor = fade.factor(state.end_temperature + reference);
            let guess = driver.map(|driver| driver * factor);
            Surface::new(&strip.air[BESIDE], strip_contact, reference, uncooled, guess, forced)
        } else {
            let gain = gain_at_stages(strip_contact, 0);
            Surface { level: uncooled, gain, offset: [0.0; 2], slope: [0.0; 2] }
        };
        let entry = strip_entry(operators, state);
        let mut strip_level = [surface.level[0] + entry, surface.level[1] + entry];
        let mut strip_gain = surface.gain;
        if operators.flash.is_some() {
            strip_level = sum(strip_level, self.flash.homogeneous_at_stages(&state.flash));
            strip_gain = [sum(strip_gain[0], self.flash.gain[0]), sum(strip_gain[1], self.flash.gain[2])];
        }
        let half_resistance = operators.half_resistance;
        let (mut into_punch, mut into_strip, mut heat, mut error) = ([0.0; 2], [0.0; 2], [0.0; 2], 0.0);
        if closed {
            let exchange = [
                [punch_gain[0][0] + strip_gain[0][0] + 2.0 * half_resistance, punch_gain[0][1] + strip_gain[0][1]],
                [punch_gain[1][0] + strip_gain[1][0], punch_gain[1][1] + strip_gain[1][1] + 2.0 * half_resistance],
            ];
            let partition = inverse(&exchange);
            let between = [strip_level[0] - punch_level[0], strip_level[1] - punch_level[1]];
            heat = if fade.slope == 0.0 {
                driver.map(|driver| driver * fade.value)
            } else {
                // The temperature is affine in the heat: a further system of two equations makes friction and temperature
                // consistent.
                let by_heat = [
                    [strip_gain[0][0] + half_resistance, strip_gain[0][1]],
                    [strip_gain[1][0], strip_gain[1][1] + half_resistance],
                ];
                let by_flux = [
                    [punch_gain[0][0] + half_resistance, punch_gain[0][1]],
                    [punch_gain[1][0], punch_gain[1][1] + half_resistance],
                ];
                let none = apply(&by_flux, apply(&partition, between));
                let mut gain = product(&by_flux, &product(&partition, &by_heat));
                gain[0][0] -= 0.5 * half_resistance;
                gain[1][1] -= 0.5 * half_resistance;
                let feedback = driver.map(|driver| driver * fade.slope);
                // Friction that rises steeply with its own heat may have several solutions.
                if (0..2).any(|i| feedback[i] * (gain[i][0].abs() + gain[i][1].abs()) > 0.5) {
                    return None;
                }
                let agree = inverse(&[
                    [1.0 - feedback[0] * gain[0][0], -feedback[0] * gain[0][1]],
                    [-feedback[1] * gain[1][0], 1.0 - feedback[1] * gain[1][1]],
                ]);
                let level = |i: usize| fade.factor(punch_level[i] + none[i] + reference);
                apply(&agree, [driver[0] * level(0), driver[1] * level(1)])
            };
            let kept = apply(&strip_gain, heat);
            into_punch = apply(
                &partition,
                [between[0] + kept[0] + half_resistance * heat[0], between[1] + kept[1] + half_resistance * heat[1]],
            );
            into_strip = [heat[0] - into_punch[0], heat[1] - into_punch[1]];
            let scale = heat[0]
                .max(heat[1])
                .max(0.1 * into_punch[0].abs().max(into_punch[1].abs()))
                .max(0.02 * state.peak_flux)
                .max(operators.least_flux);
            let allowed = operators.budget.steps.lumped_flux * scale;
            error = f64::INFINITY;
            if CONSTANT {
                let defect = 0.5 * (into_punch[1] - into_punch[0]).abs();
                // The resistance increases during the step: at its end it bounds that at the point 2/3.
                let resistance = exchange[1][0] + exchange[1][1];
                error =
                    (defect / layer_allowance(resistance, scale, state) + 0.5 * (heat[1] - heat[0]).abs()) / allowed;
            }
            if error.is_nan() || error > 1.0 {
                // No bound, or the bound is too large: the residual of the contact conditions at the point 2/3 is evaluated.
                self.flash.prepare_middle(operators);
                let mut gain = strip_contact.gain[0][1];
                let mut strip_middle = strip.contact_at_middle(&state.strip.heat, strip_count) + entry;
                if operators.flash.is_some() {
                    strip_middle += self.flash.homogeneous(1, &state.flash);
                    gain = sum(gain, self.flash.gain[1]);
                }
                if cools {
                    strip_middle += strip_contact.of_flux(COOLING, 1, surface.flux(into_strip));
                }
                let own = &punch_contact.gain[0][1];
                let punch_middle = punch.contact_at_middle(&state.punch.heat, punch_count)
                    + own[0] * into_punch[0]
                    + own[1] * into_punch[1];
                strip_middle += gain[0] * into_strip[0] + gain[1] * into_strip[1];
                let between = 0.5 * (into_strip[0] + into_strip[1] - into_punch[0] - into_punch[1]);
                let jump = punch_middle - strip_middle - half_resistance * between;
                let resistance = 2.0 * half_resistance + own[0] + own[1] + gain[0] + gain[1];
                let factor = fade.factor(0.5 * (punch_middle + strip_middle) + reference);
                let driver_in_middle = if CONSTANT { driver[0] } else { driver_at(middle, pressure_at(middle)) };
                let other_heat = (driver_in_middle * factor - 0.5 * (heat[0] + heat[1])).abs();
                let allowance =
                    if !CONSTANT && self.touches_down() { 0.5 } else { layer_allowance(resistance, scale, state) };
                let exchange = jump.abs() / (resistance * allowance);
                error = if CONSTANT { exchange + other_heat } else { 2.0 * exchange + 4.0 * other_heat } / allowed;
                if !CONSTANT && operators.flash.is_some() {
                    error = maximum(error, self.flash.error(into_strip, operators.budget.steps.whole, state.peak_rise));
                }
                if error.is_nan() || error > 1.0 {
                    return error.is_finite().then_some(Attempt { error, hottest: strip_level[1] });
                }
            }
        }
        if cools && operators.strip.air[BESIDE].emissivity > 0.0 {
            let left = surface.left(&strip.air[BESIDE], strip_contact, reference, into_strip, forced);
            if left.is_nan() || left > operators.budget.iteration.lumped_radiation * (1e-3 + state.peak_rise) {
                return None;
            }
        }
        if cools {
            // Residual of the law of cooling at the point 2/3.
            let (air, flux) = (&strip.air[BESIDE], surface.flux(into_strip));
            let t = strip.contact_at_middle(&state.strip.heat, strip_count)
                + strip_contact.of_flux(0, 1, into_strip)
                + strip_contact.of_flux(COOLING, 1, flux);
            let residual = air_flux(air, reference, t, 0.0, middle.forced) - 0.5 * (flux[0] + flux[1]);
            let [own, mean] =
                [strip_contact, strip_mean].map(|observed| observed.gain[COOLING][2][0] + observed.gain[COOLING][2][1]);
            let slope = cooling_slope(air, reference, t, middle.forced);
            let hot = surface.temperature(into_strip);
            let rise = state.peak_rise.max(LEAST_RISE).max(hot[0].abs()).max(hot[1].abs());
            let own_error = cooling_error(residual, slope, own, [own, mean]) / (operators.budget.steps.whole * rise);
            error = maximum(error, own_error);
            if error.is_nan() || error > 1.0 {
                return error.is_finite().then_some(Attempt { error, hottest: strip_level[1] });
            }
        }
        let (mut punch_faces, mut strip_faces) = ([None; FACES], [None; FACES]);
        let air_flux = if cools { surface.flux(into_strip) } else { [0.0; 2] };
        if operators.has_linear_faces {
            let into = [[into_punch, [0.0; 2]], [into_strip, air_flux]];
            punch_faces = punch.linear_fluxes(&state.punch.heat, punch_count, into[0]);
            strip_faces = strip.linear_fluxes(&state.strip.heat, strip_count, into[1]);
            let allowed = operators.budget.steps.whole * state.peak_rise.max(LEAST_RISE);
            let mut wrong = punch.bound_of_linear(&punch_faces) + strip.bound_of_linear(&strip_faces);
            if !CONSTANT || wrong > allowed {
                wrong = punch.linear_error(&state.punch.heat, punch_count, into[0], &punch_faces)
                    + strip.linear_error(&state.strip.heat, strip_count, into[1], &strip_faces);
            }
            error = maximum(error, wrong / allowed);
        }
        if cools {
            strip_faces[BESIDE] = Some(air_flux);
        }
        let punch_surface = sum(punch_level, apply(&punch_gain, into_punch));
        let strip_surface = sum(strip_level, apply(&strip_gain, into_strip));
        let hottest = maximum(punch_surface[1], strip_surface[1]);
        if !hottest.is_finite() {
            return None;
        }
        let rises = [0.5 * (punch_surface[0] + strip_surface[0]), 0.5 * (punch_surface[1] + strip_surface[1])];
        // Temperatures below 0 K are left to the general form.
        if rises.iter().any(|rise| rise + reference < 0.0 || !fade.holds(rise + reference)) {
            return None;
        }
        let kinetic_coefficient = rises.map(|rise| self.friction.coefficient * fade.factor(rise + reference));
        let wearing = Wearing { at, pressure, kinetic_coefficient, temperature: rises.map(|rise| rise + reference) };
        let rates =
            [wearing.rates::<CONSTANT>(self, &operators.punch), wearing.rates::<CONSTANT>(self, &operators.strip)];
        if CONSTANT && operators.wear_follows_temperature {
            for (body, [first, last]) in [(&operators.punch, rates[0]), (&operators.strip, rates[1])] {
                // Twice the change bounds the third difference evaluated in the general form.
                let scale = first.max(last).max(0.02 * state.peak_wear).max(body.least_wear);
                if 2.0 * (last - first).abs() > 2.0 * operators.budget.steps.lumped_wear * scale {
                    return None;
                }
            }
        }
        if !CONSTANT && closed {
            error = maximum(error, wearing.error(self, &operators.punch, &rates[0], state.peak_wear));
            error = maximum(error, wearing.error(self, &operators.strip, &rates[1], state.peak_wear));
        }
        if error.is_nan() || error > 1.0 {
            return error.is_finite().then_some(Attempt { error, hottest });
        }
        if let Some(properties) = self.properties.as_deref_mut() {
            let mut ends = [0.0; 2];
            if operators.punch.properties.is_some() {
                ends[0] =
                    punch_mean.of_states(2, &state.punch.heat, punch_count) + punch_mean.of_flux(0, 2, into_punch);
            }
            if operators.strip.properties.is_some() {
                ends[1] = strip_mean.of_states(2, &state.strip.heat, strip_count)
                    + strip_mean.of_flux(0, 2, into_strip)
                    + strip_mean.of_flux(COOLING, 2, air_flux);
            }
            let contact = rises[1] + reference;
            let of_properties =
                properties.error(operators, ends.map(|rise| rise + reference), contact, state.peak_rise);
            error = maximum(error, of_properties);
            if error.is_nan() || error > 1.0 {
                return error.is_finite().then_some(Attempt { error, hottest });
            }
        }
        let step = self.propagators.step;
        let mean = |values: Pair| step * (QUADRATURE[0] * values[0] + QUADRATURE[1] * values[1]);
        let worn = rates.map(mean);
        let room = &operators.fast_path_bounds.depth_before_step;
        if state.punch.depth + worn[0] > room[0] || state.strip.depth + worn[1] > room[1] {
            return None;
        }

        let travel = if CONSTANT { step * first.velocity } else { 0.5 * step * (start.velocity + last.velocity) };
        let end_force = kinetic_coefficient[1] * last.stribeck * last.sign * pressure[1] * operators.per_pressure;
        // The states enter the temperatures tested above, and their new values are linear in them and in these fluxes: this test
        // replaces one of every number and a copy of the states, which would take a quarter of the step.
        let fluxes = [into_punch[0], into_punch[1], into_strip[0], into_strip[1], heat[0], heat[1], rises[0], rises[1]];
        if !all_finite(&fluxes) || !all_finite(&[worn[0], worn[1], travel, end_force]) {
            return None;
        }
        punch.advance_surface(&mut state.punch.heat, punch_count, into_punch, punch_faces);
        strip.advance_surface(&mut state.strip.heat, strip_count, into_strip, strip_faces);
        if operators.flash.is_some() {
            state.flash = self.flash.advanced(&state.flash, into_strip);
        }
        state.punch.received[0] += mean(into_punch);
        state.strip.received[0] += mean(into_strip);
        for (received, faces) in [(&mut state.punch.received, punch_faces), (&mut state.strip.received, strip_faces)] {
            for (port, flux) in PORTS_OF_FACES.into_iter().zip(faces) {
                received[port] += flux.map_or(0.0, mean);
            }
        }
        state.dissipated += mean(heat);
        state.distance += travel.abs();
        state.wear(operators, worn, travel);
        state.end_temperature = rises[1];
        state.end_force = end_force;
        state.far = [0.0; 2];
        state.peak_rise = state.peak_rise.max(rises[0].abs()).max(rises[1].abs());
        state.peak_flux = state.peak_flux.max(heat[0]).max(heat[1]);
        state.peak_wear = state.peak_wear.max(rates[0][1].max(rates[1][1]));
        Some(Attempt { error, hottest })
    }
}
