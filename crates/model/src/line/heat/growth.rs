//! Growth guard: rejects steps too long to resolve thermoelastic growth.
//!
//! Above the critical speed pressure waves grow by friction heat. An L-stable step that is too long damps them instead, without
//! any indication. So the step h is limited by the fastest growth rate b, `b h <= 0.3`.
//!
//! The bound of b by [`FastestGrowth`], for layers without wear, accepts most steps. Where it does not, the matrix of a stage
//! gives a sharper criterion. Let the pressure at t follow from the distortion by earlier heating,
//! `p(t) = integral k(s) p(t - s) ds`, k >= 0 and decreasing, as heat diffuses. Growth at the rate b means
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
//! is not positive definite. Conversely, where the matrix of a stage of the length h/0.3 is positive definite on the pressures
//! that load and contact admit, b is below 0.3/h. This holds for waves at rest in the punch; waves at rest in the strip slide
//! past the contact, are not represented in the matrix of a stage, and are bounded by the first criterion alone.
//!
//! Theory: docs/theory.md, section 7.6.

use super::ThermalCoupling;
use super::partition::HeatPartition;
use crate::fastest_growth::FastestGrowth;
use crate::instability::driving_body;
use crate::line::Line;
use crate::line::operators::LineOperators;
use crate::lumped::limit;
use crate::{INPUTS, StepFailure};
use conduction::line::{GAMMA, Stage};
use numerics::dense;
use numerics::maximum::maximum;
use scene::Fidelity;
use scene::message::Number;
use std::fmt::{self, Write};

/// Largest b h.
const GROWTH: f64 = 0.3;

/// Largest w by accelerated wear that is accepted without a warning, and that is accepted at all.
const UNNOTICED_WEAR: f64 = 0.05;
const LARGEST_WEAR: f64 = 0.5;

/// Fraction of the critical speed of the layers that the line resolves below which nothing grows, whatever the layer formula
/// neglects: a factor of two for edges.
const SURELY_STABLE: f64 = 0.5;

/// Penalty on a change of the load, relative to the largest diagonal entry.
const PENALTY: f64 = 1e4;

impl LineOperators {
    /// w = k K/(mu alpha (1 + nu) kd): ratio of the decay of a pressure wave by wear to its growth by heat, k the wear depth of
    /// both bodies per pressure and distance at nominal load and speed, times `acceleration`. For the body whose waves become
    /// unstable first. 0 where nothing grows.
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

    /// Rejects a wear acceleration by which wear would suppress thermoelastic growth.
    ///
    /// # Errors
    /// A text with variable, value and limit.
    pub fn check_acceleration(&self, friction: f64, acceleration: f64) -> Result<(), String> {
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
    pub fn write_warning(&self, bit: u8, inputs: &[f64; INPUTS], text: &mut String) -> fmt::Result {
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
                let (speed, critical) = self.speeds(inputs);
                let grows = self.operators.mean.critical_speed.what_grows(self.friction_at(inputs), speed);
                let (speed, critical) = (Number(speed), Number(critical));
                write!(text, "thermoelastically unstable: sliding at {speed} m/s is above {critical} m/s, {grows}")
            }
            _ => Ok(()),
        }
    }

    /// Sliding speed and critical speed, m/s; 0: nothing grows.
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

    /// Sets the warning bits of [`limit`] for the step that begins at `inputs`.
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
        // Not set where the nominal velocity itself is above the critical speed: that is reported at initialisation.
        if critical > 0.0 && speed > critical && inputs[1] > 0.0 && self.operators.scene.nominal_velocity <= critical {
            self.state.limits |= limit::UNSTABLE;
        }
        Ok(())
    }

    /// Growth guard of the part just tried, of `step` s at the speed `speed` (m/s): whether its length resolves the growth.
    pub(in crate::line) fn passes_growth_guard(&mut self, speed: f64, friction: f64, step: f64) -> bool {
        let Some(heat) = &mut self.heat else { return true };
        let critical = &self.operators.mean.critical_speed;
        if speed * friction <= 0.0
            || speed <= critical.stable_speed(friction).max(SURELY_STABLE * critical.modelled(friction))
        {
            return true;
        }
        if heat.growth.bound.of_body(1, friction, speed) * step > GROWTH {
            return false;
        }
        if heat.growth.bound.of_body(0, friction, speed) * step <= GROWTH {
            return true;
        }
        // With the unreduced punch this would require a factorisation for the other step.
        if self.operators.scene.fidelity == Fidelity::Field {
            return false;
        }
        let (operators, conditions, pressure) = (&self.operators, &self.conditions, &self.work.end.pressure);
        let slope = |i: usize| step / GROWTH * conditions.rate.slope(i, pressure[i].max(1.0));
        heat.definite(step, conditions.signed_friction, &operators.weights, slope)
    }
}

/// Bound of the growth rate, and the last definiteness test of a stage matrix: contact, friction and wear change less often than a
/// step is taken.
#[derive(Clone, Debug)]
pub(super) struct GrowthGuard {
    /// Bound of the growth rate of thermoelastic waves.
    bound: FastestGrowth,
    /// Heat partition of the stage under test, and workspace for its matrix, N x N.
    partition: HeatPartition,
    matrix: Vec<f64>,
    /// Step (s), reference velocity (m/s), signed friction coefficient and mu s v (m/s) of the last test.
    arguments: [f64; 4],
    closed: Vec<bool>,
    /// Slope of wear depth with pressure, m/Pa, rounded down: wear only reduces growth, so this is conservative.
    slopes: Vec<f64>,
    answer: bool,
}

/// Bits of a slope's mantissa that are dropped, which leaves a relative resolution of a sixteenth.
const DROPPED: u64 = (1 << 48) - 1;

impl GrowthGuard {
    /// Guard of `count` cells.
    pub fn new(bound: FastestGrowth, partition: HeatPartition, count: usize) -> GrowthGuard {
        GrowthGuard {
            bound,
            partition,
            matrix: vec![0.0; count * count],
            arguments: [f64::NAN; 4],
            closed: vec![false; count],
            slopes: vec![0.0; count],
            answer: false,
        }
    }

    /// Stores the arguments of a test; returns whether they equal those of the stored result.
    fn store_arguments(&mut self, arguments: [f64; 4], closed: &[bool], slope: impl Fn(usize) -> f64) -> bool {
        let mut same = self.arguments == arguments && self.closed == closed;
        self.arguments = arguments;
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
    /// Whether the matrix of a stage of the length `step`/0.3 is positive definite on the cells in contact; `slope`: wear depth
    /// per pressure, m/Pa.
    fn definite(&mut self, step: f64, friction: f64, weights: &[f64], slope: impl Fn(usize) -> f64) -> bool {
        let key = (step, self.reference.velocity);
        let arguments = [step, self.reference.velocity, friction, self.reference.per_pressure];
        if !self.growth.store_arguments(arguments, &self.iterate.closed, slope) {
            self.growth.answer = self.is_definite(key, friction, weights);
        }
        self.growth.answer
    }

    fn is_definite(&mut self, key: (f64, f64), friction: f64, weights: &[f64]) -> bool {
        let (count, step) = (weights.len(), key.0);
        if !self.growth.partition.is_for(key) {
            // The first stage of a step of `step`/(gamma 0.3) has that length. The response of the strip, which slides under the
            // waves, hardly depends on it.
            if let Some(punch) = &mut self.bodies[0] {
                punch.prepare(step / (GAMMA * GROWTH), self.velocity);
            }
            let [punch, strip] = &self.bodies;
            let influence = [
                punch.as_ref().map(|own| own.influence(Stage::First)),
                strip.as_ref().map(|own| own.influence(Stage::End)),
            ];
            self.growth.partition.build(key, influence);
            if let Some(punch) = &mut self.bodies[0] {
                punch.prepare(step, self.velocity);
            }
        }
        // Friction that decreases with temperature only reduces growth.
        self.growth.partition.thermal_compliance(self.reference.per_pressure);
        self.contacts[1].set_low_rank_update(None);
        let compliance = self.contacts[1].compliance_values(friction);
        let own = self.partitions[1].thermal_compliance_values();
        let entry = |i: usize, j: usize| {
            let at = j * count + i;
            compliance[at] - own[at] + self.growth.partition.thermal_compliance_values()[at]
        };
        self.growth.matrix.fill(0.0);
        let mut largest: f64 = 0.0;
        for j in (0..count).filter(|&j| self.iterate.closed[j]) {
            for i in (j..count).filter(|&i| self.iterate.closed[i]) {
                let mut value = 0.5 * (weights[i] * entry(i, j) + weights[j] * entry(j, i));
                if i == j {
                    value += weights[i] * self.growth.slopes[i];
                    largest = maximum(largest, value.abs() / (weights[i] * weights[i]));
                }
                self.growth.matrix[j * count + i] = value;
            }
        }
        // Changes of the load are penalised; the matrix has to be definite on the remaining pressures.
        for j in 0..count {
            if !self.iterate.closed[j] {
                self.growth.matrix[j * count + j] = 1.0;
                continue;
            }
            for i in (j..count).filter(|&i| self.iterate.closed[i]) {
                self.growth.matrix[j * count + i] += PENALTY * largest * weights[i] * weights[j];
            }
        }
        dense::cholesky(&mut self.growth.matrix, count)
    }
}
