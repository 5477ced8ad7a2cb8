//! Conductivity and specific heat over temperature in a step with resolved heat.
//!
//! The properties of a body are those of its mean temperature in the middle of the step, predicted by the rate over the last step. The
//! error of a step by them is estimated as at the lumped level, with the mean temperature at its end by the change of the heat flux into
//! the body.
//!
//! Theory: docs/theory.md, section 4.15.

use super::stage::{Solved, state_of};
use super::{ThermalCoupling, evaluation::largest};
use crate::line::stages::StepData;
use crate::tolerance::enough_of_property;
use conduction::line::{Exchange, GAMMA, Step, ThermalBody};
use conduction::properties::{Scales, middle_of_step};
use numerics::dense;
use numerics::maximum::maximum;

use super::accept::LEAST_LINE_RISE;

/// Properties of both bodies during the step under way.
#[derive(Clone, Debug)]
pub(crate) struct FrozenProperties {
    /// Factors of the properties.
    pub(super) scales: [Scales; 2],
    /// Mean temperatures at the start and, as predicted, in the middle of the step, K.
    start: [f64; 2],
    middle: [f64; 2],
    reference: f64,
}

impl FrozenProperties {
    pub(super) fn new() -> FrozenProperties {
        FrozenProperties { scales: [Scales::ONE; 2], start: [0.0; 2], middle: [0.0; 2], reference: 0.0 }
    }

    /// A step of a body with them.
    pub(crate) fn step<'a>(&self, side: usize, length: f64, velocity: [f64; 2], exchange: Exchange<'a>) -> Step<'a> {
        Step { length, velocity, exchange, scales: self.scales[side], reference: self.reference }
    }

    /// Rate of the mean temperature of a body over a step (s) to the state `state`, K/s; 0 for constants.
    pub(super) fn trend(&self, side: usize, body: Option<&dyn ThermalBody>, state: &[f64], step: f64) -> f64 {
        match body {
            Some(body) if self.start[side] > 0.0 => {
                (self.reference + body.mean_temperature(state) - self.start[side]) / step
            }
            _ => 0.0,
        }
    }
}

impl ThermalCoupling {
    /// Sets the properties of the bodies for a step of `step` (s).
    pub(super) fn freeze_properties(&mut self, given: &StepData<'_>, step: f64) {
        let (mean, state) = (&given.operators.mean, state_of(given));
        self.frozen.reference = given.reference;
        for (side, body) in [&mean.punch, &mean.strip].into_iter().enumerate() {
            if let (Some(_), Some(own)) = (&body.properties, &mut self.bodies[side]) {
                let start = given.reference + own.mean_temperature(&state.bodies[side]);
                let middle = middle_of_step(start, state.trend[side], step);
                (self.frozen.start[side], self.frozen.middle[side]) = (start, middle);
                self.frozen.scales[side] = own.scales_at(middle);
            }
        }
    }
}

impl Solved<'_> {
    /// Error of the step by properties that are constant during it, in units of the tolerance; see
    /// [`crate::lumped::Lumped`].
    pub(crate) fn error_of_properties(&self, given: &StepData<'_>) -> f64 {
        let (heat, operators, state) = (&*self.0, given.operators, state_of(given));
        let (mean, tolerance) = (&operators.mean, operators.scene.tolerance);
        let mut error: f64 = 0.0;
        for (side, body) in [&mean.punch, &mean.strip].into_iter().enumerate() {
            let Some(properties) = &body.properties else { continue };
            let (start, middle) = (heat.frozen.start[side], heat.frozen.middle[side]);
            let weights = &operators.weights;
            let into = |flux: &[f64]| dense::dot(flux, weights) / weights.iter().sum::<f64>();
            let flux = (1.0 - GAMMA) * into(&heat.flux[0][side]) + GAMMA * into(&heat.flux[1][side]);
            let capacity = heat.frozen.scales[side].capacity() * body.heat_capacity * body.area / mean.area;
            let end = start + heat.step * (state.trend[side] + (flux - into(&state.flux[side])) / capacity);
            let hottest = largest(&heat.temperature[1][side]);
            let deviation = (hottest + given.reference - middle).abs();
            let allowed = tolerance * maximum(hottest, maximum(deviation, LEAST_LINE_RISE));
            let enough = enough_of_property(allowed, deviation);
            let missed = properties.change([middle, 0.5 * (start + end)], enough);
            let change = properties.change([start, end], enough.sqrt());
            error = maximum(error, maximum(missed, change * change / 12.0) * deviation / allowed);
        }
        error
    }
}
