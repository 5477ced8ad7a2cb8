//! Whether a step is short enough for what grows.
//!
//! Above the critical speed friction heat makes pressure waves grow. An L-stable step that is too long damps them instead,
//! and says nothing. A wave that grows at the rate b makes the matrix of a stage,
//!
//! ```text
//! C + s mu S + (wear and distortion of a stage),
//! ```
//!
//! singular when its length is about 1/b, for wear and distortion grow in proportion to a short stage. So the step is
//! short enough, `b h <= 0.3`, where the matrix with both as large as in a stage of length h/0.3 is still positive definite on
//! the pressures that load and contact allow.

use super::Heat;
use crate::coupled::instability::{driving_body, fastest_growth};
use crate::coupled::line::Line;
use crate::coupled::line::operators::Operators;
use crate::coupled::lumped::limit;
use crate::coupled::{INPUTS, StepFailure};
use crate::heat::line::GAMMA;
use std::fmt::{self, Write};

/// Largest b h.
const GROWTH: f64 = 0.3;

/// Largest w by accelerated wear that goes without a warning, and that is accepted.
const UNNOTICED_WEAR: f64 = 0.05;
const LARGEST_WEAR: f64 = 0.5;

/// Part of the critical speed below which nothing grows, whatever the half-planes of its formula leave out: a factor of two
/// for edges, and for bodies thinner than the wave.
const SURELY_STABLE: f64 = 0.5;

/// Penalty on a change of the load against the largest diagonal entry.
const PENALTY: f64 = 1e4;

impl Operators {
    /// w = k K/(mu alpha (1 + nu) kd): what wear takes off a growing pressure wave against what heat adds to it, k the depth
    /// that both bodies lose per pressure and distance at nominal load and speed, `acceleration` times as fast as in truth. Of
    /// the body whose waves grow first. 0 where nothing grows.
    pub fn wear_against_growth(&self, friction: f64, acceleration: f64) -> f64 {
        let scene = &self.scene;
        let Some(body) = driving_body(scene).filter(|_| self.heat.is_some() && friction > 0.0) else { return 0.0 };
        let (load, speed) = (scene.nominal_load, scene.nominal_velocity);
        let pressure = load / (self.shared_depth * self.weights.iter().sum::<f64>());
        if load == 0.0 || speed == 0.0 {
            return 0.0;
        }
        let wear = (0..2).filter(|&side| self.reshapes(side)).map(|side| {
            let (law, factor) = &self.wear[side];
            law.pressure_exponent * law.rate(pressure, speed, friction, scene.ambient_temperature) * factor
        });
        let depth = acceleration * wear.sum::<f64>() / (pressure * speed);
        depth * body.capacity() / (friction * body.thermal_expansion * (1.0 + body.poissons_ratio))
    }

    /// Refuses wear that is accelerated until it hides what grows.
    ///
    /// # Errors
    /// A text with variable, value and limit.
    pub fn check_acceleration(&self, friction: f64, acceleration: f64) -> Result<(), String> {
        let w = self.wear_against_growth(friction, acceleration);
        if acceleration > 1.0 && w > LARGEST_WEAR {
            return Err(format!(
                "wear_acceleration = {acceleration} hides thermoelastic instability: k K/(mu alpha (1 + nu) kd) = {w} with it, \
                 the limit is {LARGEST_WEAR}"
            ));
        }
        Ok(())
    }
}

impl Line {
    /// Writes what a bit of [`limit`] that depends on numbers says.
    ///
    /// # Errors
    /// Those of `text`.
    pub fn write_warning(&self, bit: u8, inputs: &[f64; INPUTS], text: &mut String) -> fmt::Result {
        match bit {
            limit::ACCELERATED => {
                let (friction, acceleration) = (self.tunables.friction_coefficient, self.tunables.wear_acceleration);
                let w = self.operators.wear_against_growth(friction, acceleration);
                write!(
                    text,
                    "wear_acceleration = {acceleration} holds thermoelastic instability back: k K/(mu alpha (1 + nu) kd) = {w} \
                     with it is above {UNNOTICED_WEAR}"
                )
            }
            limit::UNSTABLE => {
                let (speed, critical) = self.speeds(inputs);
                write!(
                    text,
                    "thermoelastically unstable: sliding at {speed} m/s is above {critical} m/s, from which on the contact's \
                     longest pressure wave grows"
                )
            }
            _ => Ok(()),
        }
    }

    /// Sliding speed and the critical one, m/s; 0: nothing grows.
    fn speeds(&self, inputs: &[f64; INPUTS]) -> (f64, f64) {
        let velocity = inputs[0] + self.operators.scene.mean_radius * inputs[2];
        let faded = self.state.heat.as_ref().map_or(self.friction.coefficient, |heat| heat.faded);
        (velocity.abs(), self.operators.mean.critical_speed.at(faded * self.friction.stribeck(velocity)))
    }

    /// Notes what a user should know about the step that begins at `inputs`.
    ///
    /// # Errors
    /// Wear accelerated too much.
    pub(in crate::coupled::line) fn watch_growth(&mut self, inputs: &[f64; INPUTS]) -> Result<(), StepFailure> {
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
        let (speed, critical) = self.speeds(inputs);
        // A scene that is made for such speeds has said so from the start.
        if critical > 0.0 && speed > critical && inputs[1] > 0.0 && self.operators.scene.nominal_velocity <= critical {
            self.state.limits |= limit::UNSTABLE;
        }
        Ok(())
    }

    /// Whether the part just tried, of `step` s at the speed `speed` (m/s), follows what grows.
    pub(in crate::coupled::line) fn follows_growth(&mut self, speed: f64, friction: f64, step: f64) -> bool {
        let Some(heat) = &mut self.heat else { return true };
        let critical = &self.operators.mean.critical_speed;
        if speed * friction <= 0.0 || speed <= critical.harmless(friction).max(SURELY_STABLE * critical.at(friction)) {
            return true;
        }
        // What the matrix says of a body that slides under the waves is far too strict: most of its answer does not grow with
        // the step. No step needs to be shorter than the fastest growth there can be.
        if step * fastest_growth(&self.operators.scene, friction, speed) <= GROWTH {
            return true;
        }
        let (operators, conditions, pressure) = (&self.operators, &self.conditions, &self.work.end.pressure);
        let slope = |i: usize| GAMMA * step * conditions.rate.slope(i, pressure[i].max(1.0));
        heat.definite(1.0 / (GAMMA * GROWTH), conditions.signed_friction, &operators.weights, slope)
    }
}

impl Heat {
    /// Whether the matrix of the last stage, with wear and distortion `factor` times as large, is positive definite.
    fn definite(&mut self, factor: f64, friction: f64, weights: &[f64], slope: impl Fn(usize) -> f64) -> bool {
        let count = weights.len();
        let split = &self.splits[1];
        self.matrix.fill(0.0);
        let with_extra = self.contacts[1].compliance_values(friction);
        let entry = |i: usize, j: usize| with_extra[j * count + i] + (factor - 1.0) * split.extra_at(i, j);
        let mut largest: f64 = 0.0;
        for j in (0..count).filter(|&j| self.closed[j]) {
            for i in (j..count).filter(|&i| self.closed[i]) {
                let mut value = 0.5 * (weights[i] * entry(i, j) + weights[j] * entry(j, i));
                if i == j {
                    value += factor * weights[i] * slope(i);
                    largest = largest.max(value.abs() / (weights[i] * weights[i]));
                }
                self.matrix[j * count + i] = value;
            }
        }
        // Pressures that change the load are made stiff; what is left has to be definite by itself.
        for j in 0..count {
            if !self.closed[j] {
                self.matrix[j * count + j] = 1.0;
                continue;
            }
            for i in (j..count).filter(|&i| self.closed[i]) {
                self.matrix[j * count + i] += PENALTY * largest * weights[i] * weights[j];
            }
        }
        cholesky(&mut self.matrix, count)
    }
}

/// Factors the lower triangle in place, by columns; false where the matrix is not positive definite.
fn cholesky(matrix: &mut [f64], count: usize) -> bool {
    for k in 0..count {
        let (done, rest) = matrix.split_at_mut((k + 1) * count);
        let column = &mut done[k * count..];
        if column[k] <= 0.0 || column[k].is_nan() {
            return false;
        }
        let root = column[k].sqrt();
        column[k..].iter_mut().for_each(|entry| *entry /= root);
        for (offset, target) in rest.chunks_exact_mut(count).enumerate() {
            let j = k + 1 + offset;
            let factor = column[j];
            if factor != 0.0 {
                target[j..].iter_mut().zip(&column[j..]).for_each(|(entry, value)| *entry -= factor * value);
            }
        }
    }
    true
}
