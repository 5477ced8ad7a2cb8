//! Whether a step is short enough for what grows.
//!
//! Above the critical speed friction heat makes pressure waves grow. An L-stable step that is too long damps them instead,
//! and says nothing. So the step h must follow the fastest growth b, `b h <= 0.3`.
//!
//! Where [`FastestGrowth`] bounds b well enough for that, there is nothing to do. It knows layers without wear; where it
//! does not let the step pass, the matrix of a stage tells more. Let the pressure at t follow from the distortion by what was
//! heated before, `p(t) = integral k(s) p(t - s) ds`, k >= 0 and falling, as heat fades. Growth at b means
//!
//! ```text
//! 1 = integral_0^inf k(s) exp(-b s) ds = integral_0^inf b exp(-b s) g(s) ds,    g(s) = integral_0^s k
//! ```
//!
//! a mean of g over times whose mean is 1/b. g is concave, so `g(1/b) >= 1`: the matrix of a stage of the length 1/b,
//!
//! ```text
//! C + s mu S + (wear and distortion of a stage),
//! ```
//!
//! is not positive definite. Turned round, where that of the length h/0.3 is, on the pressures that load and contact allow, b is
//! below 0.3/h. This is about what rests in the punch; waves that rest in the strip pass by in a stage's matrix, and are bounded
//! by the first rule alone.

use super::ThermalCoupling;
use crate::instability::driving_body;
use crate::line::Line;
use crate::line::operators::LineOperators;
use crate::lumped::limit;
use crate::{INPUTS, StepFailure};
use conduction::line::{GAMMA, Stage};
use numerics::dense;
use numerics::maximum::maximum;
use scene::Fidelity;
use std::fmt::{self, Write};

/// Largest b h.
const GROWTH: f64 = 0.3;

/// Largest w by accelerated wear that goes without a warning, and that is accepted.
const UNNOTICED_WEAR: f64 = 0.05;
const LARGEST_WEAR: f64 = 0.5;

/// Part of the critical speed of what the line models below which nothing grows, whatever the layers of its formula leave out: a
/// factor of two for edges.
const SURELY_STABLE: f64 = 0.5;

/// Penalty on a change of the load against the largest diagonal entry.
const PENALTY: f64 = 1e4;

impl LineOperators {
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
                let grows = self.operators.mean.critical_speed.what_grows(self.friction_at(inputs), speed);
                write!(text, "thermoelastically unstable: sliding at {speed} m/s is above {critical} m/s, {grows}")
            }
            _ => Ok(()),
        }
    }

    /// Sliding speed and the critical one, m/s; 0: nothing grows.
    fn speeds(&self, inputs: &[f64; INPUTS]) -> (f64, f64) {
        let velocity = inputs[0] + self.operators.scene.mean_radius * inputs[2];
        (velocity.abs(), self.operators.mean.critical_speed.at(self.friction_at(inputs)))
    }

    fn friction_at(&self, inputs: &[f64; INPUTS]) -> f64 {
        let velocity = inputs[0] + self.operators.scene.mean_radius * inputs[2];
        let kinetic_coefficient =
            self.state.heat.as_ref().map_or(self.friction.coefficient, |heat| heat.kinetic_coefficient);
        kinetic_coefficient * self.friction.stribeck(velocity)
    }

    /// Notes what a user should know about the step that begins at `inputs`.
    ///
    /// # Errors
    /// Wear accelerated too much.
    pub(in crate::line) fn watch_growth(&mut self, inputs: &[f64; INPUTS]) -> Result<(), StepFailure> {
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
    pub(in crate::line) fn follows_growth(&mut self, speed: f64, friction: f64, step: f64) -> bool {
        let Some(heat) = &mut self.heat else { return true };
        let critical = &self.operators.mean.critical_speed;
        if speed * friction <= 0.0
            || speed <= critical.harmless(friction).max(SURELY_STABLE * critical.modelled(friction))
        {
            return true;
        }
        if heat.growth.of_body(1, friction, speed) * step > GROWTH {
            return false;
        }
        if heat.growth.of_body(0, friction, speed) * step <= GROWTH {
            return true;
        }
        // The unreduced punch would have to be factored for the other step.
        if self.operators.scene.fidelity == Fidelity::Field {
            return false;
        }
        let (operators, conditions, pressure) = (&self.operators, &self.conditions, &self.work.end.pressure);
        let slope = |i: usize| step / GROWTH * conditions.rate.slope(i, pressure[i].max(1.0));
        heat.definite(step, conditions.signed_friction, &operators.weights, slope)
    }
}

/// What was last asked of a matrix of a stage, and the answer: contact, friction and wear change less often than a step is taken.
#[derive(Clone, Debug)]
pub(super) struct GrowthGuard {
    /// Step (s), reference velocity (m/s), signed friction coefficient and mu s v (m/s).
    asked: [f64; 4],
    closed: Vec<bool>,
    /// Wear per pressure, m/Pa, rounded down: wear only holds growth back.
    slopes: Vec<f64>,
    answer: bool,
}

/// Bits of a slope's mantissa that are dropped: what is left is a sixteenth apart.
const DROPPED: u64 = (1 << 48) - 1;

impl GrowthGuard {
    pub fn new(count: usize) -> GrowthGuard {
        GrowthGuard { asked: [f64::NAN; 4], closed: vec![false; count], slopes: vec![0.0; count], answer: false }
    }

    /// Takes a question; whether it is the one that has been answered.
    fn ask(&mut self, asked: [f64; 4], closed: &[bool], slope: impl Fn(usize) -> f64) -> bool {
        let mut same = self.asked == asked && self.closed == closed;
        self.asked = asked;
        self.closed.copy_from_slice(closed);
        for (i, own) in self.slopes.iter_mut().enumerate() {
            let rounded = f64::from_bits(slope(i).to_bits() & !DROPPED);
            same &= *own == rounded;
            *own = rounded;
        }
        same
    }
}

impl ThermalCoupling {
    /// Whether the matrix of a stage of the length `step`/0.3 is positive definite on the cells in contact; `slope`: its wear per
    /// pressure, m/Pa.
    fn definite(&mut self, step: f64, friction: f64, weights: &[f64], slope: impl Fn(usize) -> f64) -> bool {
        let key = (step, self.reference.velocity);
        let asked = [step, self.reference.velocity, friction, self.reference.per_pressure];
        if !self.growth_guard.ask(asked, &self.closed, slope) {
            self.growth_guard.answer = self.is_definite(key, friction, weights);
        }
        self.growth_guard.answer
    }

    fn is_definite(&mut self, key: (f64, f64), friction: f64, weights: &[f64]) -> bool {
        let (count, step) = (weights.len(), key.0);
        if !self.watched.is_for(key) {
            // The first stage of a longer step is of that length. What slides under the waves hardly depends on it.
            if let Some(punch) = &mut self.bodies[0] {
                punch.prepare(step / (GAMMA * GROWTH), self.velocity);
            }
            let [punch, strip] = &self.bodies;
            let influence = [
                punch.as_ref().map(|own| own.influence(Stage::First)),
                strip.as_ref().map(|own| own.influence(Stage::End)),
            ];
            self.watched.build(key, influence);
            if let Some(punch) = &mut self.bodies[0] {
                punch.prepare(step, self.velocity);
            }
        }
        // Friction that falls with the temperature only holds growth back.
        self.watched.thermal_compliance(self.reference.per_pressure);
        self.contacts[1].set_low_rank_update(None);
        let compliance = self.contacts[1].compliance_values(friction);
        let own = self.partitions[1].thermal_compliance_values();
        let entry = |i: usize, j: usize| {
            let at = j * count + i;
            compliance[at] - own[at] + self.watched.thermal_compliance_values()[at]
        };
        self.matrix.fill(0.0);
        let mut largest: f64 = 0.0;
        for j in (0..count).filter(|&j| self.closed[j]) {
            for i in (j..count).filter(|&i| self.closed[i]) {
                let mut value = 0.5 * (weights[i] * entry(i, j) + weights[j] * entry(j, i));
                if i == j {
                    value += weights[i] * self.growth_guard.slopes[i];
                    largest = maximum(largest, value.abs() / (weights[i] * weights[i]));
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
        dense::cholesky(&mut self.matrix, count)
    }
}
