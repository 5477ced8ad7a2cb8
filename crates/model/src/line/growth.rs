//! Thermoelastic growth during a run: what the line reports of sliding above the critical speed and of wear accelerated against
//! growth.
//!
//! Theory: docs/theory.md, section 7.6.

use super::Line;
use super::operators::LineOperators;
use crate::instability::driving_body;
use crate::lumped::limit;
use crate::{Inputs, StepFailure};
use contact::friction::OperatingPoint;
use scene::message::Number;
use std::fmt::{self, Write};

/// Largest w by accelerated wear that is accepted without a warning, and that is accepted at all.
const UNNOTICED_WEAR: f64 = 0.05;
const LARGEST_WEAR: f64 = 0.5;

impl LineOperators {
    /// w = k K/(mu alpha (1 + nu) kd): ratio of the decay of a pressure wave by wear to its growth by heat, k the wear depth of
    /// both bodies per pressure and distance at nominal load and speed, times `acceleration`. For the body whose waves become
    /// unstable first. 0 where nothing grows.
    fn wear_against_growth(&self, friction: f64, acceleration: f64) -> f64 {
        let scene = &self.scene;
        let Some(body) = driving_body(scene).filter(|_| self.heat.is_some() && friction > 0.0) else { return 0.0 };
        let (load, speed) = (scene.nominal_load, scene.nominal_velocity);
        let pressure = load / (self.shared_depth * self.weights.iter().sum::<f64>());
        if load == 0.0 || speed == 0.0 {
            return 0.0;
        }
        let wear = (0..2).filter(|&side| self.reshapes(side)).map(|side| {
            let (law, factor) = &self.wear[side];
            law.logarithmic_slope(pressure) * law.rate(pressure, speed, friction, scene.ambient_temperature) * factor
        });
        let depth = acceleration * wear.sum::<f64>() / (pressure * speed);
        depth * body.capacity() / (friction * body.thermal_expansion * (1.0 + body.poissons_ratio))
    }

    /// Rejects a wear acceleration by which wear would suppress thermoelastic growth.
    ///
    /// # Errors
    /// A text with variable, value and limit.
    pub(crate) fn check_acceleration(&self, friction: f64, acceleration: f64) -> Result<(), String> {
        let w = self.wear_against_growth(friction, acceleration);
        if acceleration > 1.0 && w > LARGEST_WEAR {
            return Err(format!(
                "wear_acceleration = {} hides thermoelastic instability: k K/(mu alpha (1 + nu) kd) = {} with it, the limit is \
                 {LARGEST_WEAR}",
                Number(acceleration),
                Number(w)
            ));
        }
        Ok(())
    }
}

impl Line {
    /// Writes the message of a bit of [`limit`] that contains numbers.
    ///
    /// # Errors
    /// Those of `text`.
    pub(crate) fn write_warning(&self, bit: u8, inputs: &Inputs, text: &mut String) -> fmt::Result {
        match bit {
            limit::ACCELERATED => {
                let (friction, acceleration) = (self.tunables.friction_coefficient, self.tunables.wear_acceleration);
                let w = self.operators.wear_against_growth(friction, acceleration);
                write!(
                    text,
                    "wear_acceleration = {} suppresses thermoelastic instability: k K/(mu alpha (1 + nu) kd) = {} with it is above \
                     {UNNOTICED_WEAR}",
                    Number(acceleration),
                    Number(w)
                )
            }
            limit::UNSTABLE => {
                let operating_point = self.operators.mean.operating_point(inputs);
                let friction = self.end_friction(operating_point);
                let (critical, growth) = (&self.operators.mean.growth.critical, self.mean.state().growth);
                critical.write_message(text, growth, friction, operating_point.velocity.abs(), self.heat.is_some())
            }
            _ => Ok(()),
        }
    }

    /// Friction coefficient at the temperatures of the end of the last step, at this operating point.
    fn end_friction(&self, operating_point: OperatingPoint) -> f64 {
        let kinetic_coefficient =
            self.state.heat.as_ref().map_or(self.friction.coefficient, |heat| heat.kinetic_coefficient);
        kinetic_coefficient * self.friction.stribeck(operating_point)
    }

    /// Sets the warning bit of [`limit`] of accelerated wear.
    ///
    /// # Errors
    /// Wear accelerated too much.
    pub(super) fn watch_growth(&mut self) -> Result<(), StepFailure> {
        let (operators, tunables) = (&self.operators, &self.tunables);
        if self.heat.is_none() {
            return Ok(());
        }
        let acceleration = tunables.wear_acceleration;
        if acceleration > 1.0 {
            operators.check_acceleration(tunables.friction_coefficient, acceleration).map_err(StepFailure)?;
            if operators.wear_against_growth(tunables.friction_coefficient, acceleration) > UNNOTICED_WEAR {
                self.state.limits |= limit::ACCELERATED;
            }
        }
        Ok(())
    }
}
