//! One implicit step of the lumped level: pressure, heat partition, cooling, friction and wear together.
//!
//! Fluxes are linear between the Radau points 1/3 and 1 of the step; both stages are solved as one system (two-stage Radau IIA in
//! the fluxes, L-stable, third order on smooth histories), the states are propagated exactly ([`super::stage`]). The fluxes at
//! the start of the step do not enter, so the thermal layer after a jump of the inputs in the fast states does not reduce the
//! accuracy. The residual of the contact conditions at the point 2/3 is the error estimate.
//!
//! Theory: docs/theory.md, sections 5.4, 7.2.

use super::conditions::Conditions;
use super::cooled_faces::cool;
use super::estimate::LEAST_RISE;
use super::point::strip_entry;
use super::stage::QUADRATURE;
use super::stage_body::{Around, StageBody};
use super::stages::Stages;
use super::state::{LumpedState, NewState};
use super::stepper::{Attempt, Stepper};
use numerics::maximum::{all_finite, maximum};

impl Stepper<'_> {
    /// Tries the step from `state`; `conditions` at the start and at the three points, all the same where `constant`. An accepted
    /// step (error at most 1) is written to `state`, otherwise the state is unchanged.
    pub fn attempt(&mut self, state: &mut LumpedState, conditions: &[Conditions; 4], constant: bool) -> Attempt {
        let operators = self.operators;
        let step = self.propagators.step;
        let (first, last) = (&conditions[1], &conditions[3]);
        let ambient = [first.ambient, last.ambient];
        let forced = [first.forced, last.forced];
        let around =
            [0, 1].map(|side| Around { ambient, forced, neighbour: [first.neighbours[side], last.neighbours[side]] });
        let mut punch = StageBody::new(
            &operators.punch,
            self.propagators.punch,
            &state.punch,
            ambient,
            [first.punch_far, last.punch_far],
        );
        let mut strip = StageBody::new(
            &operators.strip,
            self.propagators.strip,
            &state.strip,
            ambient,
            [first.strip_far, last.strip_far],
        );
        let entry = strip_entry(operators, state);
        for point in [0, 2] {
            strip.level[point] += entry;
            if operators.flash.is_some() {
                strip.level[point] += self.flash.homogeneous(point, &state.flash);
            }
        }
        let mut stages = Stages::new(self, state, conditions, &punch, &strip);
        // Far below the resolution of the error estimate across the small resistance of the interface.
        let enough = operators.budget.iteration.lumped_stage * (1e-3 + state.peak_rise);
        let mut converged = false;
        let cools = punch.cools() || strip.cools();
        if cools {
            cool([&mut punch, &mut strip], None, state.reference, &around);
        }
        for _ in 0..40 {
            stages.loads(self, state, &punch, &strip);
            let mut change = stages.solve(self, &mut punch, &mut strip);
            if cools {
                let exchange = stages.partition.exchange();
                change = maximum(change, cool([&mut punch, &mut strip], exchange, state.reference, &around));
            }
            if change <= enough {
                converged = true;
                break;
            }
        }
        let hottest = stages.hottest(&punch, &strip);
        let is_absolute = stages.temperature.iter().all(|rise| rise + state.reference >= 0.0);
        if !converged || !hottest.is_finite() || !is_absolute {
            return Attempt { error: f64::INFINITY, hottest };
        }
        if operators.series_stiffness == 0.0 {
            stages.wear(self);
        }
        let mut error = stages.bound(self, state, constant, &punch);
        if error.is_nan() || error > 1.0 || state.refinement > 0 {
            self.flash.prepare_middle(operators);
            punch.level[1] = punch.middle_level(&state.punch);
            strip.level[1] = strip.middle_level(&state.strip) + entry;
            if operators.flash.is_some() {
                strip.level[1] += self.flash.homogeneous(1, &state.flash);
                stages.take_middle(&strip, self.flash);
            }
            error = stages.error(self, state, conditions, &punch, &strip, constant);
        }
        if cools {
            let middle = &conditions[2];
            let mut rise = stages.temperature.iter().fold(state.peak_rise.max(LEAST_RISE), |most, t| most.max(t.abs()));
            let mut wrong = 0.0;
            for (side, (body, own)) in [(&punch, &state.punch), (&strip, &state.strip)].into_iter().enumerate() {
                let around = Around {
                    ambient: [middle.ambient; 2],
                    forced: [middle.forced; 2],
                    neighbour: [middle.neighbours[side]; 2],
                };
                let [own, face] = body.cooling_error(own, state.reference, &around);
                (wrong, rise) = (wrong + own, maximum(rise, face));
            }
            error = maximum(error, wrong / (operators.budget.steps.whole * rise));
        }
        if let Some(properties) = self.properties.as_deref_mut() {
            let ends = [punch.mean_at_end(&state.punch), strip.mean_at_end(&state.strip)];
            let [ends, [contact, _]] =
                [ends, [stages.temperature[1]; 2]].map(|rises| rises.map(|t| t + state.reference));
            error = maximum(error, properties.error(operators, ends, contact, state.peak_rise));
        }
        if error.is_nan() || error > 1.0 {
            return Attempt { error, hottest };
        }
        let travel = 0.5 * step * (conditions[0].velocity + conditions[3].velocity);
        let mean = |values: [f64; 2]| QUADRATURE[0] * values[0] + QUADRATURE[1] * values[1];
        let new = NewState {
            punch: punch.advanced(&state.punch, state.reference, &around[0], step),
            strip: strip.advanced(&state.strip, state.reference, &around[1], step),
            flash: match operators.flash {
                Some(_) => self.flash.advanced(&state.flash, strip.flux[0]),
                None => state.flash,
            },
            travel,
            dissipated: state.dissipated + step * mean(stages.heat),
            distance: state.distance + if stages.bristle.is_some() { stages.moved.slipped } else { travel.abs() },
            worn: [0, 1].map(|body| step * mean(stages.rates[body]) + stages.released_wear[body]),
            end_temperature: stages.temperature[1],
            end_force: stages.kinetic_coefficient[1]
                * last.stribeck
                * last.sign
                * stages.pressure[1]
                * operators.per_pressure,
        };
        let is_below_zero = stages.temperature.iter().any(|rise| rise + state.reference < 0.0);
        if is_below_zero || !new.is_finite() || !all_finite(&[stages.moved.deflection, last.punch_far, last.strip_far])
        {
            return Attempt { error: f64::INFINITY, hottest };
        }
        // Accepted: update the state.
        new.commit(operators, state);
        state.bristle = stages.moved.deflection;
        state.far = [last.punch_far, last.strip_far];
        for rise in stages.temperature {
            state.peak_rise = state.peak_rise.max(rise.abs());
        }
        state.peak_flux = state.peak_flux.max(stages.largest_heat(self));
        state.peak_wear = state.peak_wear.max(stages.rates[0][1].max(stages.rates[1][1]));
        Attempt { error, hottest }
    }
}
