//! Growth guard: rejects steps too long to resolve thermoelastic growth.
//!
//! Above the critical speed pressure waves grow by friction heat. An L-stable step that is too long damps them instead, without
//! any indication. So the step h is limited by the fastest growth rate b, `b h <= 0.3`.
//!
//! The bound of b by [`crate::fastest_growth`], for layers without wear, accepts most steps. Where it does not, the matrix of a stage
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

use super::stage::Solved;
use super::{Iterate, ThermalCoupling};
use crate::line::heat::partition::{HeatPartition, PartitionKey};
use crate::line::operators::LineOperators;
use crate::line::stages::ContactStages;
use conduction::line::contact_parts::ContactParts;
use conduction::line::{Exchange, GAMMA, Stage};
use numerics::dense;
use numerics::leading_bits;
use numerics::maximum::maximum;

/// Largest b h.
const GROWTH: f64 = 0.3;

impl Solved<'_> {
    /// Whether the length of the step resolves the growth at the speed `speed` (m/s).
    pub(crate) fn passes_growth_guard(
        &mut self,
        operators: &LineOperators,
        stages: &ContactStages,
        speed: f64,
        friction: f64,
    ) -> bool {
        let heat = &mut *self.0;
        let step = heat.step;
        let critical = &operators.mean.growth.critical;
        // Without pressure nothing grows.
        let is_open = stages.end.pressure.iter().all(|pressure| *pressure == 0.0);
        // Fraction of the critical speed of the layers that the line resolves below which nothing grows, whatever the layer formula
        // neglects: a factor of two for edges.
        if is_open
            || speed * friction <= 0.0
            || speed <= critical.stable_speed(friction).max(0.5 * critical.modelled(friction))
        {
            return true;
        }
        if operators.growth_bound.of_body(1, friction, speed) * step > GROWTH {
            return false;
        }
        if operators.growth_bound.of_body(0, friction, speed) * step <= GROWTH {
            return true;
        }
        let (conditions, pressure) = (&stages.conditions, &stages.end.pressure);
        let slope = |i: usize| step / GROWTH * conditions.rate.slope(i, pressure[i].max(1.0));
        heat.definite(step, conditions.signed_friction, &operators.weights, slope)
    }
}

/// The last definiteness test of a stage matrix: contact, friction and wear change less often than a step is taken.
#[derive(Clone, Debug)]
pub(super) struct GrowthGuard {
    /// Heat partition of the stage under test, and workspace for its matrix, N x N.
    partition: HeatPartition,
    matrix: Vec<f64>,
    /// Step (s), reference velocity (m/s), signed friction coefficient and mu s v (m/s) of the last test.
    arguments: [f64; 8],
    /// Cells that carry pressure, and rounded parts of the cells in contact.
    closed: Vec<bool>,
    contact_parts: ContactParts,
    /// Slope of wear depth with pressure, m/Pa, rounded down: wear only reduces growth, so this is conservative.
    slopes: Vec<f64>,
    answer: bool,
}

/// Bits of the significand of a slope that are left: a relative resolution of a sixteenth.
const SLOPE_BITS: u32 = 4;

impl GrowthGuard {
    /// Guard of `count` cells.
    pub fn new(partition: HeatPartition, count: usize) -> GrowthGuard {
        GrowthGuard {
            partition,
            matrix: vec![0.0; count * count],
            arguments: [f64::NAN; 8],
            closed: vec![false; count],
            contact_parts: ContactParts::whole(count),
            slopes: vec![0.0; count],
            answer: false,
        }
    }

    /// Stores the arguments of a test; returns whether they equal those of the stored result.
    fn store_arguments(
        &mut self,
        arguments: [f64; 8],
        closed: impl Fn(usize) -> bool,
        contact_parts: &ContactParts,
        slope: impl Fn(usize) -> f64,
    ) -> bool {
        let mut same = self.arguments == arguments && self.contact_parts == *contact_parts;
        self.arguments = arguments;
        self.contact_parts.copy_from(contact_parts);
        for (i, (own, carries)) in self.slopes.iter_mut().zip(&mut self.closed).enumerate() {
            same &= *carries == closed(i);
            *carries = closed(i);
            let rounded = leading_bits(slope(i), SLOPE_BITS);
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
        let [punch, strip] = self.frozen.scales;
        let key = (step, self.reference.velocity, self.frozen.scales);
        let arguments = [
            step,
            self.reference.velocity,
            friction,
            self.reference.per_pressure,
            punch.flux,
            punch.pace,
            strip.flux,
            strip.pace,
        ];
        // A cell that is partly in contact may exchange heat without pressure.
        let Iterate { closed, pressure, .. } = &self.iterate;
        let carries = |i: usize| closed[i] && (pressure[i] > 0.0 || !self.rounded_parts[0].is_partial(i));
        if !self.growth.store_arguments(arguments, carries, &self.rounded_parts[0], slope) {
            self.growth.answer = self.is_definite(key, friction, weights);
        }
        self.growth.answer
    }

    fn is_definite(&mut self, key: PartitionKey, friction: f64, weights: &[f64]) -> bool {
        let (count, step) = (weights.len(), key.0);
        if !self.growth.partition.is_for(key, &self.rounded_parts[0]) {
            // The first stage of a step of `step`/(gamma 0.3) has that length. The response of the strip, which slides under the
            // waves, hardly depends on it.
            let [rounded, own] = [&self.rounded_parts, &self.contact_parts].map(|[first, end]| [first, end]);
            let of_punch = |length: f64, parts| self.frozen.step(0, length, self.velocity, Exchange::Parts(parts));
            self.bodies[0].iter_mut().for_each(|punch| punch.prepare(&of_punch(step / (GAMMA * GROWTH), rounded)));
            let [punch, strip] = &mut self.bodies;
            let influence = [
                punch.as_mut().map(|own| own.influence(Stage::First)),
                strip.as_mut().map(|own| own.influence(Stage::End)),
            ];
            self.growth.partition.build(key, &self.rounded_parts[0], influence);
            self.bodies[0].iter_mut().for_each(|punch| punch.prepare(&of_punch(step, own)));
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
        for j in (0..count).filter(|&j| self.growth.closed[j]) {
            for i in (j..count).filter(|&i| self.growth.closed[i]) {
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
            if !self.growth.closed[j] {
                self.growth.matrix[j * count + j] = 1.0;
                continue;
            }
            for i in (j..count).filter(|&i| self.growth.closed[i]) {
                // Penalty on a change of the load, relative to the largest diagonal entry.
                self.growth.matrix[j * count + i] += 1e4 * largest * weights[i] * weights[j];
            }
        }
        dense::cholesky(&mut self.growth.matrix, count)
    }
}
