//! One implicit step of the lumped level: pressure, heat partition, cooling, friction and wear together.
//!
//! Fluxes are linear between the Radau points 1/3 and 1 of the step; both stages are solved as one system (two-stage Radau IIA in
//! the fluxes, L-stable, third order on smooth histories), the states are propagated exactly ([`super::stage`]). The fluxes at
//! the start of the step do not enter, so the thermal layer after a jump of the inputs in the fast states does not reduce the
//! accuracy. The residual of the contact conditions at the point 2/3 is the error estimate.
//!
//! Theory: docs/theory.md, sections 5.4, 7.2.

#[cfg(test)]
mod tests;

use super::air::{BESIDE, FAR};
use super::conditions::Conditions;
use super::estimate::LEAST_LUMPED_RISE;
use super::operators::BodyOperators;
use super::point::strip_entry;
use super::stage::{Pair, Propagator, QUADRATURE, sum};
use super::stage_body::{Around, NONE, StageBody};
use super::stage_partition::Response;
use super::stages::Stages;
use super::state::LumpedState;
use super::stepper::{Attempt, Stepper};
use numerics::maximum::{all_finite, maximum};

impl<'a> Stepper<'a> {
    /// [`Stepper::attempt`] in any regime.
    #[inline(never)]
    pub(crate) fn attempt_any(&mut self, state: &mut LumpedState, at: [&Conditions; 4], constant: bool) -> Attempt {
        self.attempt::<false>(state, at, constant).expect("the general form always has an outcome")
    }

    /// Tries the step from `state`; conditions `at` the start and the three points, all the same where `constant`. An accepted step
    /// (error at most 1) is written to `state`, otherwise the state is unchanged.
    ///
    /// `COMMON` specialises it to the most common regime: both bodies conduct; dead load; friction and temperature on one piece of the
    /// fade table; no bristle; no temperature difference except by friction heat; only the strip's surface beside the contact is
    /// cooled. `None` where the step leaves that. The moving source is prepared.
    #[inline(always)]
    pub(crate) fn attempt<const COMMON: bool>(
        &mut self,
        state: &mut LumpedState,
        at: [&Conditions; 4],
        constant: bool,
    ) -> Option<Attempt> {
        let operators = self.operators;
        // Makes their equality known to the compiler.
        let at = if constant { [at[0]; 4] } else { at };
        let [start, first, middle, last] = at;
        let elsewhere = |now: &Conditions| now.ambient != 0.0 || now.punch_far != 0.0 || now.strip_far != 0.0;
        // A linear function that is 0 at two points is 0 everywhere.
        if COMMON && (!operators.has_common_form || elsewhere(first) || !constant && elsewhere(last)) {
            return None;
        }
        let own = |body: &BodyOperators, propagator: Option<&'a Propagator>| {
            if let (Some(propagator), Some(heat)) = (propagator, &body.heat) {
                Some((propagator, heat.count))
            } else {
                None
            }
        };
        let of_punch = own(&operators.punch, self.propagators.punch);
        let of_strip = own(&operators.strip, self.propagators.strip);
        if COMMON && (of_punch.is_none() || of_strip.is_none()) {
            return None;
        }
        let (step, reference) = (self.propagators.step, state.reference);
        let prescribed = |values: Pair| if COMMON { [0.0; 2] } else { values };
        let ambient = prescribed([first.ambient, last.ambient]);
        let far = [prescribed([first.punch_far, last.punch_far]), prescribed([first.strip_far, last.strip_far])];
        let around_side = |from: &Conditions, to: &Conditions, side: usize| Around {
            ambient: prescribed([from.ambient, to.ambient]),
            forced: [from.forced, to.forced],
            neighbour: prescribed([from.neighbours[side], to.neighbours[side]]),
        };
        let around_both = |from: &Conditions, to: &Conditions| [around_side(from, to, 0), around_side(from, to, 1)];
        let around = around_both(first, last);
        let acts = |body: &BodyOperators, face: usize| body.air[face].is_nonlinear();
        let cools = if COMMON {
            [[false; 2], [acts(&operators.strip, BESIDE), false]]
        } else {
            let faces = |body: &BodyOperators| [acts(body, BESIDE), acts(body, FAR)];
            [faces(&operators.punch), faces(&operators.strip)]
        };
        let entry = strip_entry(operators, state);
        let mut source = Response { level: [entry; 2], gain: NONE.gain };
        if operators.flash.is_some() {
            let moving = [self.flash.homogeneous(0, &state.flash), self.flash.homogeneous(2, &state.flash)];
            source = Response { level: sum(source.level, moving), gain: [self.flash.gain[0], self.flash.gain[2]] };
        }
        let mut punch =
            StageBody::<COMMON>::new(&operators.punch, of_punch, &state.punch, ambient, far[0], cools[0], NONE);
        let mut strip =
            StageBody::<COMMON>::new(&operators.strip, of_strip, &state.strip, ambient, far[1], cools[1], source);
        let mut stages = Stages::<COMMON>::new(self, state, at);
        let cools = punch.cools() || strip.cools();
        let iteration = &operators.budget.iteration;
        let enough = if COMMON { iteration.lumped_radiation } else { iteration.lumped_stage }
            * (LEAST_LUMPED_RISE + state.peak_rise);
        if cools {
            // Nearly all of the heat enters the better conductor.
            strip.flux[0] = stages.expected_heat();
        }
        let mut converged = false;
        for _ in 0..if COMMON { 1 } else { 40 } {
            if Stages::<COMMON>::has_caliper(self) {
                stages.loads(self, state, [first, last], &punch, &strip);
            }
            if punch.cools() {
                punch.cool(reference, &around[0]);
            }
            if strip.cools() {
                strip.cool(reference, &around[1]);
            }
            let mut change = stages.solve(self, &mut punch, &mut strip);
            if cools {
                change = maximum(change, maximum(punch.left(reference, &around[0]), strip.left(reference, &around[1])));
            }
            if change <= enough {
                converged = true;
                break;
            }
        }
        let hottest = maximum(stages.surfaces[0][1], stages.surfaces[1][1]);
        let is_absolute = stages.temperature[0] + reference >= 0.0 && stages.temperature[1] + reference >= 0.0;
        let failure = (!COMMON).then_some(Attempt { error: f64::INFINITY, hottest });
        punch.take_linear(&state.punch);
        strip.take_linear(&state.strip);
        if !converged || !hottest.is_finite() || !is_absolute {
            return failure;
        }
        if !Stages::<COMMON>::has_caliper(self) {
            stages.wear(self, constant);
        }
        if COMMON && constant && stages.may_err_in_wear(self, state.peak_wear) {
            return None;
        }
        let mut error = 0.0;
        if !COMMON || stages.closed {
            error = stages.bound(self, state, constant, &punch, &strip);
            if error.is_nan() || error > 1.0 || !COMMON && state.refinement > 0 {
                self.flash.prepare_middle(operators);
                let mut source = (entry, [0.0; 2]);
                if operators.flash.is_some() {
                    source = (entry + self.flash.homogeneous(1, &state.flash), self.flash.gain[1]);
                }
                let of_punch = punch.contact_in_middle(&state.punch, (0.0, [0.0; 2]));
                let contact = [of_punch, strip.contact_in_middle(&state.strip, source)];
                error = stages.error(self, state, at, [&punch, &strip], contact, constant);
            }
        }
        if cools || punch.has_linear_faces() || strip.has_linear_faces() {
            let [first, last] = stages.temperature;
            let at_start = (!constant).then(|| around_both(start, start));
            let at_start = |side: usize| at_start.as_ref().map(|around| &around[side]);
            let around = around_both(middle, middle);
            let rise = state.peak_rise.max(LEAST_LUMPED_RISE).max(first.abs()).max(last.abs());
            let mut of_cooling = 0.0;
            for relaxes in [constant, false] {
                let of_punch = punch.cooling_error(&state.punch, reference, at_start(0), &around[0], relaxes);
                let of_strip = strip.cooling_error(&state.strip, reference, at_start(1), &around[1], relaxes);
                let rise = maximum(rise, maximum(of_punch[1], of_strip[1]));
                of_cooling = (of_punch[0] + of_strip[0]) / (operators.budget.steps.whole * rise);
                if !relaxes || of_cooling <= 1.0 {
                    break;
                }
            }
            error = maximum(error, of_cooling);
        }
        if let Some(properties) = self.properties.as_deref_mut() {
            let ends = [punch.mean_at_end(&state.punch) + reference, strip.mean_at_end(&state.strip) + reference];
            let contact = stages.temperature[1] + reference;
            error = maximum(error, properties.error(operators, ends, contact, state.peak_rise));
        }
        if error.is_nan() || error > 1.0 {
            return (!COMMON || error.is_finite()).then_some(Attempt { error, hottest });
        }
        let mean = |values: Pair| QUADRATURE[0] * values[0] + QUADRATURE[1] * values[1];
        let travel = if constant { step * first.velocity } else { 0.5 * step * (start.velocity + last.velocity) };
        let worn = |body: usize| step * mean(stages.rates[body]) + stages.released_wear[body];
        let worn = [worn(0), worn(1)];
        let room = &operators.common_bounds.depth_before_step;
        if COMMON && (state.punch.depth + worn[0] > room[0] || state.strip.depth + worn[1] > room[1]) {
            return None;
        }
        let per_coefficient = stages.stribeck[1] * last.sign * stages.pressure[1] * operators.per_pressure;
        let end_force = stages.kinetic_coefficient[1] * per_coefficient;
        // The states enter the temperatures tested above, and their new values are linear in them and in these fluxes: this test
        // replaces one of every number and a copy of the states, which would take a quarter of the step.
        let [heat, rises] = [stages.heat, stages.temperature];
        let moved = &stages.moved;
        let numbers = [heat[0], heat[1], rises[0], rises[1], worn[0], worn[1], travel, end_force];
        if !punch.is_finite() || !strip.is_finite() || !all_finite(&numbers) || !COMMON && !moved.deflection.is_finite()
        {
            return failure;
        }
        // Accepted: update the state.
        let table = self.properties.as_deref();
        punch.advance(&mut state.punch, reference, &around[0], step, table.map(|own| (own, 0)));
        strip.advance(&mut state.strip, reference, &around[1], step, table.map(|own| (own, 1)));
        if operators.flash.is_some() {
            state.flash = self.flash.advanced(&state.flash, strip.flux[0]);
        }
        state.dissipated += step * mean(heat);
        state.distance += if stages.has_bristle() { moved.slipped } else { travel.abs() };
        state.wear(operators, worn, travel);
        (state.end_temperature, state.end_force) = (rises[1], end_force);
        state.bristle = moved.deflection;
        state.far = [far[0][1], far[1][1]];
        state.peak_rise = state.peak_rise.max(rises[0].abs()).max(rises[1].abs());
        state.peak_flux = state.peak_flux.max(stages.largest_heat(self));
        state.peak_wear = state.peak_wear.max(stages.rates[0][1].max(stages.rates[1][1]));
        Some(Attempt { error, hottest })
    }
}
