//! Exact propagation of a reduced body over a step under fluxes linear in time.
//!
//! A flux that is linear between its values at the Radau points c = 1/3 and c = 1 of the step,
//! `u(x) = u_1 L_1(x) + u_2 L_2(x)`, `L_1 = 3(1 - x)/2`, `L_2 = (3x - 1)/2`, drives a state of rate r to
//!
//! ```text
//! a(c h) = exp(-r c h) a(0) + input (w_1 u_1 + w_2 u_2),   w_j = integral_0^{ch} exp(-r (ch - t)) L_j(t/h) dt
//! ```
//!
//! without error at any r h. [`Propagator`] holds these weights for one step size at the three points at which the contact is
//! solved (1/3, 1) or checked (2/3), and the gains from fluxes to observed temperatures.
//!
//! Theory: docs/theory.md, section 5.3.

use super::air::{Air, BESIDE, FACES, FAR};
use conduction::properties::Scales;
use conduction::reduced::{MAX_STATES, Observation, PORTS, Port, ReducedBody};

/// Points of the step at which the contact is solved (0 and 2) or checked (1).
pub const POINTS: [f64; 3] = [1.0 / 3.0, 2.0 / 3.0, 1.0];

/// L_1 and L_2 at these points.
pub const BASIS: [[f64; 2]; 3] = [[1.0, 0.0], [0.5, 0.5], [0.0, 1.0]];

/// Weights of the two stages in the integral over the step.
pub const QUADRATURE: [f64; 2] = [0.75, 0.25];

/// (1 - exp(-z))/z and one minus that, over z, given `decay` = exp(-z).
#[inline]
pub fn averages(z: f64, decay: f64) -> (f64, f64) {
    if z < 0.06 {
        let first =
            1.0 - z * (0.5 - z * (1.0 / 6.0 - z * (1.0 / 24.0 - z * (1.0 / 120.0 - z * (1.0 / 720.0 - z / 5040.0)))));
        let second = 0.5
            - z * (1.0 / 6.0
                - z * (1.0 / 24.0 - z * (1.0 / 120.0 - z * (1.0 / 720.0 - z * (1.0 / 5040.0 - z / 40320.0)))));
        return (first, second);
    }
    let inverse = 1.0 / z;
    let first = (1.0 - decay) * inverse;
    (first, (1.0 - first) * inverse)
}

/// w_1 and w_2 at the point `c`, which is `length` = c h away from the start (s), for a state of rate
/// `rate`, given `decay` = exp(-rate c h).
#[inline]
pub fn weights(rate: f64, decay: f64, c: f64, length: f64) -> [f64; 2] {
    let (first, second) = averages(rate * length, decay);
    let (flat, ramp) = (length * first, c * length * second);
    [1.5 * (flat - ramp), 0.5 * (3.0 * ramp - flat)]
}

/// Dot product of the first `count` entries. Later entries are zero, so whole groups of four are added, which the compiler
/// vectorises in an order that does not depend on the machine.
#[inline]
fn dot(left: &[f64; MAX_STATES], right: &[f64; MAX_STATES], count: usize) -> f64 {
    let mut sum = [0.0; LANES];
    for (left, right) in
        left.as_chunks::<LANES>().0.iter().zip(right.as_chunks::<LANES>().0).take(count.div_ceil(LANES))
    {
        accumulate(&mut sum, left, right);
    }
    total(sum)
}

/// Observed temperature over a step: free response of the initial states, and gains from the stage fluxes.
#[derive(Clone, Debug)]
pub struct Observed {
    /// Weight of the initial states at every point.
    pub homogeneous: [[f64; MAX_STATES]; 3],
    /// Gain from stage flux j of a port to the observation at point i: `gain[port][i][j]`.
    pub gain: [[[f64; 2]; 3]; PORTS],
}

impl Observed {
    fn none() -> Observed {
        Observed { homogeneous: [[0.0; MAX_STATES]; 3], gain: [[[0.0; 2]; 3]; PORTS] }
    }

    fn new(body: &ReducedBody, observation: &Observation, decay: &Decay, driven: &Driven) -> Observed {
        let mut observed = Observed::none();
        for point in 0..3 {
            for k in 0..body.count {
                observed.homogeneous[point][k] = observation.states[k] * decay[point][k];
                let weight = driven[point][k];
                for port in 0..PORTS {
                    for stage in 0..2 {
                        observed.gain[port][point][stage] +=
                            observation.states[k] * body.input[port][k] * weight[stage];
                    }
                }
            }
            for port in 0..PORTS {
                for stage in 0..2 {
                    observed.gain[port][point][stage] += observation.direct[port] * BASIS[point][stage];
                }
            }
        }
        observed
    }

    /// Interpolates the gains of this observation.
    #[inline(always)]
    fn mix_gains(&mut self, of: [&Observed; 4], between: &Between) {
        for port in 0..PORTS {
            let weights = between.plain.map(|weight| weight * between.scale(port));
            for point in 0..3 {
                for stage in 0..2 {
                    self.gain[port][point][stage] = combined(&weights, of.map(|one| one.gain[port][point][stage]));
                }
            }
        }
    }

    /// Interpolates the weights of the first `count` states.
    #[inline(always)]
    fn mix_states(&mut self, of: [&Observed; 4], between: &Between, count: usize) {
        for point in 0..3 {
            for k in 0..count {
                self.homogeneous[point][k] = between.of(of.map(|one| one.homogeneous[point][k]));
            }
        }
    }

    /// Observation at `point` from the initial states alone.
    #[inline]
    pub fn of_states(&self, point: usize, states: &[f64; MAX_STATES], count: usize) -> f64 {
        dot(&self.homogeneous[point], states, count)
    }

    /// Response to the stage fluxes `u` of `port` at `point`.
    #[inline]
    pub fn of_flux(&self, port: usize, point: usize, u: [f64; 2]) -> f64 {
        self.gain[port][point][0] * u[0] + self.gain[port][point][1] * u[1]
    }
}

type Decay = [[f64; MAX_STATES]; 3];

/// Weights of the stage fluxes in every state at the three points.
type Driven = [[[f64; 2]; MAX_STATES]; 3];

/// Cubic interpolation between four step sizes in a row.
#[derive(Clone, Copy, Debug)]
pub struct Between {
    /// Weights of the four.
    pub plain: [f64; 4],
    /// The same times the step size over that of each: what is in proportion to the step is interpolated exactly.
    pub by_step: [f64; 4],
    /// Properties during the step.
    pub scales: Scales,
    /// Ports of fluxes, whose effect on temperatures is in proportion to K0/K.
    pub is_flux: [bool; PORTS],
}

impl Between {
    /// Combination of four numbers.
    #[inline(always)]
    pub fn of(&self, values: [f64; 4]) -> f64 {
        combined(&self.plain, values)
    }

    fn scale(&self, port: usize) -> f64 {
        if self.is_flux[port] { self.scales.flux } else { 1.0 }
    }
}

#[inline(always)]
fn combined(weights: &[f64; 4], values: [f64; 4]) -> f64 {
    (weights[0] * values[0] + weights[1] * values[1]) + (weights[2] * values[2] + weights[3] * values[3])
}

/// Exact propagator of a reduced body over one step size.
#[derive(Clone, Debug)]
pub struct Propagator {
    /// Temperature of the contact surface.
    pub contact: Observed,
    /// Temperatures of the cooled faces: beside the contact, far face.
    pub cooled: [Observed; FACES],
    /// Mean temperature of the body.
    pub mean: Observed,
    /// Cooling of the faces beyond the heat transfer within the states.
    pub air: [Air; FACES],
    decay: [f64; MAX_STATES],
    update: [[[f64; MAX_STATES]; 2]; PORTS],
    surface: [Group; MAX_STATES / LANES],
}

/// Number of states per vector.
const LANES: usize = 4;

/// Entries of the fast path for some neighbouring states, contiguous in memory: the same numbers as in the rows above.
#[derive(Clone, Copy, Debug)]
#[repr(align(32))]
struct Group {
    /// Weights of the contact temperature at every point.
    contact: [[f64; LANES]; 3],
    decay: [f64; LANES],
    /// Gain from the stage fluxes of the contact.
    update: [[f64; LANES]; 2],
    /// Gain from the stage fluxes of the cooling.
    cooling: [[f64; LANES]; 2],
}

#[inline(always)]
fn accumulate(sum: &mut [f64; LANES], left: &[f64; LANES], right: &[f64; LANES]) {
    for lane in 0..LANES {
        sum[lane] += left[lane] * right[lane];
    }
}

/// Sum over the lanes, in an order that does not depend on the machine.
#[inline(always)]
fn total(sum: [f64; LANES]) -> f64 {
    (sum[0] + sum[2]) + (sum[1] + sum[3])
}

impl Propagator {
    /// Propagator of `body` over the step `step` (s); `air`: the cooling of its faces, whose temperature is observed where it acts.
    pub fn new(body: &ReducedBody, step: f64, air: &[Air; FACES]) -> Propagator {
        let cools = air.each_ref().map(Air::acts);
        let mut decay = [[1.0; MAX_STATES]; 3];
        for (point, row) in decay.iter_mut().enumerate() {
            for (value, rate) in row.iter_mut().zip(&body.rate[..body.count]) {
                *value = (-rate * POINTS[point] * step).exp();
            }
        }
        let mut driven = [[[0.0; 2]; MAX_STATES]; 3];
        for (point, row) in driven.iter_mut().enumerate() {
            for (k, weight) in row[..body.count].iter_mut().enumerate() {
                *weight = weights(body.rate[k], decay[point][k], POINTS[point], POINTS[point] * step);
            }
        }
        let mut update = [[[0.0; MAX_STATES]; 2]; PORTS];
        for k in 0..body.count {
            let weight = driven[2][k];
            for port in 0..PORTS {
                for stage in 0..2 {
                    update[port][stage][k] = body.input[port][k] * weight[stage];
                }
            }
        }
        let contact = Observed::new(body, &body.contact_temperature, &decay, &driven);
        let surface = std::array::from_fn(|group| {
            let of = |row: &[f64; MAX_STATES]| std::array::from_fn(|lane| row[LANES * group + lane]);
            Group {
                contact: contact.homogeneous.each_ref().map(of),
                decay: of(&decay[2]),
                update: update[Port::Contact as usize].each_ref().map(of),
                cooling: update[Port::Cooling as usize].each_ref().map(of),
            }
        });
        Propagator {
            contact,
            cooled: [(&body.cooled_temperature, cools[BESIDE]), (&body.base_temperature, cools[FAR])].map(
                |(observation, asked)| match asked {
                    true => Observed::new(body, observation, &decay, &driven),
                    false => Observed::none(),
                },
            ),
            mean: Observed::new(body, &body.mean_temperature, &decay, &driven),
            air: *air,
            decay: decay[2],
            update,
            surface,
        }
    }

    /// Interpolates the entries of the fast path for `count` states: those of contact, cooling and mean temperature.
    #[inline(always)]
    pub fn mix_surface(&mut self, of: [&Propagator; 4], between: &Between, count: usize) {
        let by_flux = between.by_step.map(|weight| weight * between.scales.flux);
        for group in 0..count.div_ceil(LANES) {
            let (new, of) = (&mut self.surface[group], of.map(|one| &one.surface[group]));
            for point in 0..3 {
                for lane in 0..LANES {
                    new.contact[point][lane] = between.of(of.map(|one| one.contact[point][lane]));
                }
            }
            for lane in 0..LANES {
                new.decay[lane] = between.of(of.map(|one| one.decay[lane]));
            }
            for stage in 0..2 {
                for lane in 0..LANES {
                    new.update[stage][lane] = combined(&by_flux, of.map(|one| one.update[stage][lane]));
                    new.cooling[stage][lane] = combined(&by_flux, of.map(|one| one.cooling[stage][lane]));
                }
            }
        }
        let whole = LANES * count.div_ceil(LANES);
        for k in 0..whole {
            self.mean.homogeneous[2][k] = between.of(of.map(|one| one.mean.homogeneous[2][k]));
        }
        self.contact.mix_gains(of.map(|one| &one.contact), between);
        self.mean.mix_gains(of.map(|one| &one.mean), between);
        self.air = of[1].air.map(|air| air.at(between.scales));
    }

    /// Interpolates the other entries, which the general form of a step has in addition.
    pub fn mix_rest(&mut self, of: [&Propagator; 4], between: &Between, count: usize) {
        let whole = LANES * count.div_ceil(LANES);
        self.contact.mix_states(of.map(|one| &one.contact), between, whole);
        self.mean.mix_states(of.map(|one| &one.mean), between, whole);
        for face in 0..FACES {
            let (own, of) = (&mut self.cooled[face], of.map(|one| &one.cooled[face]));
            own.mix_states(of, between, whole);
            own.mix_gains(of, between);
        }
        for k in 0..whole {
            self.decay[k] = between.of(of.map(|one| one.decay[k]));
        }
        for port in 0..PORTS {
            let weights = between.by_step.map(|weight| weight * between.scale(port));
            for stage in 0..2 {
                for k in 0..whole {
                    self.update[port][stage][k] = combined(&weights, of.map(|one| one.update[port][stage][k]));
                }
            }
        }
    }

    /// Temperature of the contact surface at both stages from the initial states alone.
    #[inline(always)]
    pub fn contact_at_stages(&self, states: &[f64; MAX_STATES], count: usize) -> [f64; 2] {
        let (mut first, mut last) = ([0.0; LANES], [0.0; LANES]);
        let groups = self.surface.iter().zip(states.as_chunks::<LANES>().0).take(count.div_ceil(LANES));
        for (weights, states) in groups {
            let states = *states;
            accumulate(&mut first, &weights.contact[0], &states);
            accumulate(&mut last, &weights.contact[2], &states);
        }
        [total(first), total(last)]
    }

    /// Temperature of the contact surface at the point 2/3 from the initial states alone.
    #[inline(always)]
    pub fn contact_at_middle(&self, states: &[f64; MAX_STATES], count: usize) -> f64 {
        let mut sum = [0.0; LANES];
        for (weights, states) in self.surface.iter().zip(states.as_chunks::<LANES>().0).take(count.div_ceil(LANES)) {
            accumulate(&mut sum, &weights.contact[1], states);
        }
        total(sum)
    }

    /// [`Propagator::advance`] where only contact and cooling have fluxes.
    #[inline(always)]
    pub fn advance_surface(
        &self,
        states: &mut [f64; MAX_STATES],
        count: usize,
        contact: [f64; 2],
        cooling: Option<[f64; 2]>,
    ) {
        for (weights, states) in self.surface.iter().zip(states.as_chunks_mut::<LANES>().0).take(count.div_ceil(LANES))
        {
            // In a local copy, stored at the end: the compiler then need not prove that nothing overlaps.
            let mut new = *states;
            for lane in 0..LANES {
                new[lane] = weights.decay[lane] * new[lane]
                    + weights.update[0][lane] * contact[0]
                    + weights.update[1][lane] * contact[1];
            }
            if let Some(cooling) = cooling {
                accumulate(&mut new, &weights.cooling[0], &[cooling[0]; LANES]);
                accumulate(&mut new, &weights.cooling[1], &[cooling[1]; LANES]);
            }
            *states = new;
        }
    }

    /// Advances `states` over the step under the stage fluxes of every port.
    #[inline]
    pub fn advance(
        &self,
        states: &mut [f64; MAX_STATES],
        count: usize,
        fluxes: &[[f64; 2]; PORTS],
        active: [bool; PORTS],
    ) {
        // Whole groups of four, as in `dot`: entries beyond the last state stay 0.
        let count = 4 * count.div_ceil(4);
        let states = &mut states[..count];
        let row = |port: usize, stage: usize| &self.update[port][stage][..count];
        let contact = row(0, 0).iter().zip(row(0, 1));
        for ((state, decay), (first, second)) in states.iter_mut().zip(&self.decay[..count]).zip(contact) {
            *state = decay * *state + first * fluxes[0][0] + second * fluxes[0][1];
        }
        for port in 1..PORTS {
            if active[port] {
                for (state, (first, second)) in states.iter_mut().zip(row(port, 0).iter().zip(row(port, 1))) {
                    *state += first * fluxes[port][0] + second * fluxes[port][1];
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_are_the_integrals() {
        for rate in [0.0, 1e-6, 0.01, 0.2, 3.0, 400.0] {
            for c in POINTS {
                let step = 0.7;
                let decay = (-rate * c * step).exp();
                let computed = weights(rate, decay, c, c * step);
                // The midpoint rule in a stretched variable is accurate enough at this number of points.
                let points = 200_000;
                let mut exact = [0.0; 2];
                for i in 0..points {
                    let t = c * step * (f64::from(i) + 0.5) / f64::from(points);
                    let x = t / step;
                    let factor = (-rate * (c * step - t)).exp() * c * step / f64::from(points);
                    exact[0] += factor * 1.5 * (1.0 - x);
                    exact[1] += factor * 0.5 * (3.0 * x - 1.0);
                }
                for stage in 0..2 {
                    let scale = exact[0].abs() + exact[1].abs();
                    assert!((computed[stage] - exact[stage]).abs() < 1e-7 * scale, "{rate} {c} {stage}");
                }
            }
        }
    }
}
