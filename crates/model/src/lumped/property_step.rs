//! Conductivity and specific heat over temperature in a step of the lumped level.
//!
//! During a step the properties of a body are those at a mean temperature in its middle: the mean at the start plus half a step at
//! the rate of the last one, so that the step is of second order. The step tells the mean at its end before it is accepted; where
//! the middle of both differs too much, it is repeated with that.
//!
//! Properties are constant over parts of the temperature ([`conduction::properties::Properties::part`]), so that the propagators of a step
//! stay cached.
//!
//! After the step the mean temperature is set to that by its enthalpy, with a uniform change of temperature that is of third order in the
//! step: the body has taken up exactly the heat of its fluxes.
//!
//! Theory: docs/theory.md, section 4.15.

use super::estimate::LEAST_LUMPED_RISE;
use super::operators::{BodyOperators, LumpedOperators};
use super::state::{BodyState, LumpedState};
use crate::tolerance::enough_of_property;
use conduction::properties::{Scales, middle_of_step};
use conduction::reduced::{PORTS, Port};
use numerics::maximum::maximum;

/// Attempts of a step with other temperatures in its middle.
pub(crate) const ATTEMPTS: usize = 3;

/// Bodies during a step.
#[derive(Clone, Debug)]
pub(crate) struct PropertyStep {
    /// Mean temperatures in the middle of the step, K: those with which it is computed, and those that it leads to.
    middle: [f64; 2],
    found: [f64; 2],
    /// Temperatures of the properties during the step, K, the ends of the part for which they stand, and factors of the properties.
    part: [f64; 2],
    within: [[f64; 2]; 2],
    scales: [Scales; 2],
    /// The step is to be repeated with the temperatures that it leads to.
    repeats: bool,
    /// Mean temperatures at its start, K.
    start: [f64; 2],
    /// Mean temperatures at its end by the equations of the step, K.
    ends: [f64; 2],
    /// Its length, s.
    step: f64,
    tolerance: f64,
}

impl PropertyStep {
    /// Before any step; `None` where all properties are constants.
    pub(crate) fn of(operators: &LumpedOperators) -> Option<PropertyStep> {
        operators.bodies().iter().any(|body| body.properties.is_some()).then_some(PropertyStep {
            middle: [0.0; 2],
            found: [0.0; 2],
            part: [0.0; 2],
            within: [[f64::INFINITY, 0.0]; 2],
            ends: [0.0; 2],
            step: 0.0,
            scales: [Scales::ONE; 2],
            repeats: false,
            start: [0.0; 2],
            tolerance: operators.scene.tolerance,
        })
    }

    /// Predicts the temperatures in the middle of a step of `step` (s) from `state`; returns those of its properties.
    pub(crate) fn predict(&mut self, operators: &LumpedOperators, state: &LumpedState, step: f64) -> [f64; 2] {
        self.step = step;
        for (side, (body, own)) in operators.bodies().into_iter().zip([&state.punch, &state.strip]).enumerate() {
            if let (Some(_), Some(heat)) = (&body.properties, &body.heat) {
                let start = state.reference + body.mean_rise(heat, &own.heat, state.far[side]);
                self.start[side] = start;
                self.middle[side] = middle_of_step(start, own.trend, step);
            }
        }
        self.freeze(operators)
    }

    /// Temperatures of the properties of a repeated step.
    pub(crate) fn correct(&mut self, operators: &LumpedOperators) -> [f64; 2] {
        self.middle = self.found;
        self.freeze(operators)
    }

    fn freeze(&mut self, operators: &LumpedOperators) -> [f64; 2] {
        self.repeats = false;
        for (side, body) in operators.bodies().into_iter().enumerate() {
            let Some(properties) = &body.properties else { continue };
            let [low, high] = self.within[side];
            if !(low..high).contains(&self.middle[side]) {
                (self.part[side], self.within[side]) = properties.part(self.middle[side]);
                self.scales[side] = properties.at(self.part[side]);
            }
        }
        self.part
    }

    /// Whether the last attempt is to be repeated with [`PropertyStep::correct`].
    pub(crate) fn repeats(&self) -> bool {
        self.repeats
    }

    /// Error of the step by properties that are constant during it, in units of the tolerance: their difference from those at the temperatures
    /// which the step leads to, and a twelfth of the square of their change, each times the deviation of the contact temperature from
    /// the mean; and, where heat leaves, a twelfth of their change times that of the mean, which settles at the slowest rate. `ends`: mean temperatures (K) at the end of the step; `contact`: the contact temperature there; `peak_rise` as in the
    /// state.
    pub(crate) fn error(&mut self, operators: &LumpedOperators, ends: [f64; 2], contact: f64, peak_rise: f64) -> f64 {
        let (mut missed, mut curved) = (0.0, 0.0);
        self.ends = ends;
        for (side, body) in operators.bodies().into_iter().enumerate() {
            let (Some(properties), Some(heat)) = (&body.properties, &body.heat) else { continue };
            let found = 0.5 * (self.start[side] + ends[side]);
            self.found[side] = found;
            let deviation = (contact - found).abs();
            let allowed = self.tolerance * maximum(peak_rise, deviation).max(LEAST_LUMPED_RISE);
            let [low, high] = self.within[side];
            let inside = |temperature: f64| low <= temperature && temperature < high;
            if inside(found) && inside(self.start[side]) && inside(ends[side]) {
                // Within a part of the temperature properties are constants.
                continue;
            }
            let enough = enough_of_property(allowed, deviation);
            let miss = properties.change([self.middle[side], found], enough);
            if miss > enough && !inside(found) {
                missed += miss * deviation / allowed;
            }
            let change = properties.change([self.start[side], ends[side]], enough.sqrt());
            let settled = heat.rate[0] * self.scales[side].pace * self.step * (ends[side] - self.start[side]).abs();
            curved += change * (change * deviation + settled) / 12.0 / allowed;
        }
        self.repeats = missed > 1.0 && curved <= 1.0;
        maximum(missed, curved)
    }

    /// After an accepted step of `step` (s): sets the mean temperature of a body with a table to that by enthalpy. `passed`: heat through
    /// the ports, J/m2.
    #[inline(always)]
    pub(crate) fn settle(
        &self,
        side: usize,
        body: &BodyOperators,
        state: &mut BodyState,
        passed: &[f64; PORTS],
        step: f64,
    ) {
        let (Some(properties), Some(heat)) = (&body.properties, &body.heat) else { return };
        let (scales, start, mean) = (self.scales[side], self.start[side], self.ends[side]);
        let taken = if body.passes_heat {
            scales.capacity() * body.heat_capacity * (mean - start)
        } else {
            body.coverage * passed[Port::Contact as usize]
                + passed[Port::Cooling as usize]
                + passed[Port::Base as usize]
        };
        let mass = body.heat_capacity / properties.specific_heat();
        let rise = properties.table.rise_by(start, taken / mass);
        let uniform = (rise - (mean - start)) / body.uniform_mean;
        for (state, stored) in state.heat.iter_mut().zip(&heat.stored.states).take(heat.count) {
            *state += stored * uniform;
        }
        state.trend = rise / step;
    }
}
