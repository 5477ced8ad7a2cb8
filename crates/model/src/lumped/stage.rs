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
//! At other properties than the constants of the body it is the propagator of its own time, with fluxes that weigh more or less
//! ([`conduction::properties`]).
//!
//! Theory: docs/theory.md, section 5.3.

use super::air::{Air, BESIDE, FACES, FAR, PORTS_OF_FACES};
use super::operators::BodyOperators;
use conduction::properties::Scales;
use conduction::reduced::{MAX_STATES, Observation, PORTS, Port, ReducedBody};
use nalgebra::{SMatrix, SVector};
use numerics::factorization;
use numerics::subnormal::flushed;
use scene::ThermalBoundary;

/// Points of the step at which the contact is solved (0 and 2) or checked (1).
pub(crate) const POINTS: [f64; 3] = [1.0 / 3.0, 2.0 / 3.0, 1.0];

/// L_1 and L_2 at these points.
pub(crate) const BASIS: [[f64; 2]; 3] = [[1.0, 0.0], [0.5, 0.5], [0.0, 1.0]];

/// Weights of the two stages in the integral over the step.
pub(crate) const QUADRATURE: [f64; 2] = [0.75, 0.25];

/// Values at both stages.
pub(crate) type Pair = [f64; 2];

/// Matrix between values at both stages, by rows.
pub(crate) type Matrix = [Pair; 2];

/// Product of a matrix with the values at both stages.
#[inline(always)]
pub(crate) fn apply(matrix: &Matrix, values: Pair) -> Pair {
    [matrix[0][0] * values[0] + matrix[0][1] * values[1], matrix[1][0] * values[0] + matrix[1][1] * values[1]]
}

/// Product of two matrices.
#[inline(always)]
pub(crate) fn product(left: &Matrix, right: &Matrix) -> Matrix {
    let columns = [apply(left, [right[0][0], right[1][0]]), apply(left, [right[0][1], right[1][1]])];
    [[columns[0][0], columns[1][0]], [columns[0][1], columns[1][1]]]
}

/// Inverse of a matrix.
#[inline(always)]
pub(crate) fn inverse(matrix: &Matrix) -> Matrix {
    let factor = 1.0 / (matrix[0][0] * matrix[1][1] - matrix[0][1] * matrix[1][0]);
    [[matrix[1][1] * factor, -matrix[0][1] * factor], [-matrix[1][0] * factor, matrix[0][0] * factor]]
}

/// Sum of the values at both stages.
#[inline(always)]
pub(crate) fn sum(left: Pair, right: Pair) -> Pair {
    [left[0] + right[0], left[1] + right[1]]
}

/// (1 - exp(-z))/z and one minus that, over z, given `decay` = exp(-z).
#[inline]
pub(crate) fn averages(z: f64, decay: f64) -> (f64, f64) {
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
pub(crate) fn weights(rate: f64, decay: f64, c: f64, length: f64) -> [f64; 2] {
    let (first, second) = averages(rate * length, decay);
    let (flat, ramp) = (length * first, c * length * second);
    [1.5 * (flat - ramp), 0.5 * (3.0 * ramp - flat)]
}

/// Dot products of `rows` with the first `count` states. Later entries are zero, so whole groups of four are added, which the compiler
/// vectorises in an order that does not depend on the machine.
#[inline(always)]
fn dots<const N: usize>(rows: [&[f64; MAX_STATES]; N], states: &[f64; MAX_STATES], count: usize) -> [f64; N] {
    let mut sums = [[0.0; LANES]; N];
    for (group, states) in states.as_chunks::<LANES>().0.iter().enumerate().take(count.div_ceil(LANES)) {
        for n in 0..N {
            accumulate(&mut sums[n], &rows[n].as_chunks::<LANES>().0[group], states);
        }
    }
    totals(sums)
}

/// Observed temperature over a step: free response of the initial states, and gains from the stage fluxes.
#[derive(Clone, Default, Debug)]
pub(crate) struct Observed {
    /// Weight of the initial states at every point.
    pub homogeneous: [[f64; MAX_STATES]; 3],
    /// Gain from stage flux j of a port to the observation at point i: `gain[port][i][j]`.
    pub gain: [[[f64; 2]; 3]; PORTS],
}

impl Observed {
    /// `weight`: factors of the fluxes, by port.
    fn new(
        body: &ReducedBody,
        observation: &Observation,
        decay: &Decay,
        driven: &Driven,
        weight: &[f64; PORTS],
    ) -> Observed {
        let mut observed = Observed::default();
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
                    let gain = &mut observed.gain[port][point][stage];
                    *gain = (*gain + observation.direct[port] * BASIS[point][stage]) * weight[port];
                }
            }
        }
        observed
    }

    /// Observation at `point` from the initial states alone.
    #[inline(always)]
    pub(crate) fn of_states(&self, point: usize, states: &[f64; MAX_STATES], count: usize) -> f64 {
        let [sum] = dots([&self.homogeneous[point]], states, count);
        sum
    }

    /// Gain matrix from the stage fluxes of `port` to the observation at the stages.
    #[inline(always)]
    pub(crate) fn gain_at_stages(&self, port: usize) -> Matrix {
        [self.gain[port][0], self.gain[port][2]]
    }

    /// Response to the stage fluxes `u` of `port` at `point`.
    #[inline(always)]
    pub(crate) fn of_flux(&self, port: usize, point: usize, u: [f64; 2]) -> f64 {
        self.gain[port][point][0] * u[0] + self.gain[port][point][1] * u[1]
    }
}

type Decay = [[f64; MAX_STATES]; 3];

/// Weights of the stage fluxes in every state at the three points.
type Driven = [[[f64; 2]; MAX_STATES]; 3];

/// Faces whose fluxes are linear in their temperatures ([`Air::is_linear`]), eliminated from a step.
#[derive(Clone, Debug)]
struct LinearFaces {
    acts: [bool; FACES],
    /// Stage fluxes per initial state: `[face][stage][state]`.
    by_state: [[[f64; MAX_STATES]; 2]; FACES],
    /// Stage fluxes per stage value of every other port: `[port][face][stage][stage]`.
    by_port: [[Matrix; FACES]; PORTS],
}

impl LinearFaces {
    fn new(cooled: &[Observed; FACES], air: &[Air; FACES]) -> LinearFaces {
        const UNKNOWNS: usize = 2 * FACES;
        let acts = air.each_ref().map(Air::is_linear);
        let mut faces =
            LinearFaces { acts, by_state: [[[0.0; MAX_STATES]; 2]; FACES], by_port: [[[[0.0; 2]; 2]; FACES]; PORTS] };
        if acts == [false; FACES] {
            return faces;
        }
        let unknowns = || (0..UNKNOWNS).map(|k| (k, k / 2, k % 2)).filter(|(_, face, _)| acts[*face]);
        let mut matrix = SMatrix::<f64, UNKNOWNS, UNKNOWNS>::identity();
        for (k, face, stage) in unknowns() {
            for (l, other, at) in unknowns() {
                matrix[(k, l)] += air[face].rest * cooled[face].gain[PORTS_OF_FACES[other]][2 * stage][at];
            }
        }
        let driven = |port: usize| PORTS_OF_FACES.iter().zip(acts).all(|(own, acts)| !acts || *own != port);
        for (k, face, stage) in unknowns() {
            let unit = SVector::<f64, UNKNOWNS>::from_fn(|l, _| if l == k { 1.0 } else { 0.0 });
            let column = factorization::solve(&matrix, &unit).unwrap_or_else(|_| SVector::repeat(f64::NAN));
            let (observed, point) = (&cooled[face], 2 * stage);
            for (l, to, at) in unknowns() {
                let weight = -column[l] * air[face].rest;
                for (flux, state) in faces.by_state[to][at].iter_mut().zip(&observed.homogeneous[point]) {
                    *flux += weight * state;
                }
                for port in (0..PORTS).filter(|&port| driven(port)) {
                    for driver in 0..2 {
                        // The law is that of the temperature above the ambient.
                        let ambient = f64::from(u8::from(port == Port::Ambient as usize && driver == stage));
                        faces.by_port[port][to][at][driver] += weight * (observed.gain[port][point][driver] - ambient);
                    }
                }
            }
        }
        faces
    }

    /// Eliminates these faces from what is observed.
    fn eliminate(&self, observed: &mut Observed) {
        for face in (0..FACES).filter(|&face| self.acts[face]) {
            let gains = std::mem::take(&mut observed.gain[PORTS_OF_FACES[face]]);
            for (point, gain) in gains.iter().enumerate() {
                for (stage, gain) in gain.iter().enumerate() {
                    for (with, flux) in observed.homogeneous[point].iter_mut().zip(&self.by_state[face][stage]) {
                        *with += gain * flux;
                    }
                    for port in 0..PORTS {
                        for at in 0..2 {
                            observed.gain[port][point][at] += gain * self.by_port[port][face][stage][at];
                        }
                    }
                }
            }
        }
    }
}

/// Exact propagator of a reduced body over one step size, with its linear faces eliminated.
#[derive(Clone, Debug)]
pub(crate) struct Propagator {
    /// Temperature of the contact surface.
    pub contact: Observed,
    /// Temperatures of the cooled faces: beside the contact, far face.
    pub cooled: [Observed; FACES],
    /// Mean temperature of the body.
    pub mean: Observed,
    /// Temperatures of the face itself, of the contact and of the body's mean at the end, per flux into a face that is constant over the
    /// step, K m2/W.
    pub by_face: [[f64; 3]; FACES],
    /// Direct feedthrough of every port to the temperatures of the cooled faces.
    pub direct: [[f64; PORTS]; FACES],
    linear: LinearFaces,
    /// Heat (J/m2) that leaves by the constant heat transfer over the step, per initial state and per stage value of every port.
    lost: ([f64; MAX_STATES], [Pair; PORTS]),
    /// Cooling of the faces beyond the heat transfer within the states.
    pub air: [Air; FACES],
    groups: [Group; MAX_STATES / LANES],
    /// Gain of the states from the stage values of the ports beyond contact and cooling.
    update: [[[f64; MAX_STATES]; 2]; PORTS - 2],
}

/// Number of states per vector.
const LANES: usize = 4;

/// Entries of every step for some neighbouring states, contiguous in memory.
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

/// [`total`] of each.
#[inline(always)]
fn totals<const N: usize>(sums: [[f64; LANES]; N]) -> [f64; N] {
    // Not by `map`, which is compiled without the vector unit.
    let mut found = [0.0; N];
    for n in 0..N {
        found[n] = total(sums[n]);
    }
    found
}

impl Propagator {
    /// Propagator of the body `of` over the step `step` (s) at the properties `scales`; `None` for an insulator. The temperature of a face
    /// is observed where its cooling acts.
    pub(crate) fn new(of: &BodyOperators, step: f64, scales: Scales) -> Option<Propagator> {
        let body = of.heat.as_ref()?;
        let duration = step;
        let step = step * scales.pace;
        let air = of.air.each_ref().map(|air| air.at(scales));
        let cools = air.each_ref().map(Air::acts);
        // A prescribed temperature does not weigh more where the body conducts less.
        let mut weight = [scales.flux; PORTS];
        weight[Port::Ambient as usize] = 1.0;
        if matches!(of.far, ThermalBoundary::Held | ThermalBoundary::External) {
            weight[Port::Base as usize] = 1.0;
        }
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
        let observed = |observation: &Observation| Observed::new(body, observation, &decay, &driven, &weight);
        let [mut contact, mut mean] = [&body.contact_temperature, &body.mean_temperature].map(observed);
        let mut cooled = [(&body.cooled_temperature, cools[BESIDE]), (&body.base_temperature, cools[FAR])]
            .map(|(observation, asked)| if asked { observed(observation) } else { Observed::default() });
        let by_face = [BESIDE, FAR].map(|face| {
            [&cooled[face], &contact, &mean].map(|one| one.gain[PORTS_OF_FACES[face]][2].iter().sum::<f64>())
        });
        let direct = [&body.cooled_temperature, &body.base_temperature]
            .map(|observation| std::array::from_fn(|port| observation.direct[port] * weight[port]));
        let linear = LinearFaces::new(&cooled, &air);
        let [beside, far] = &mut cooled;
        for observed in [&mut contact, &mut mean, beside, far] {
            linear.eliminate(observed);
        }
        let update = |port: usize, stage: usize, k: usize| body.input[port][k] * driven[2][k][stage] * weight[port];
        // The flow of a state is (input - gain of the state)/rate, as the propagation is exact.
        let (by_state, by_port) = &of.lost_over_step;
        let by_state: [f64; MAX_STATES] = std::array::from_fn(|k| scales.capacity() * by_state[k]);
        let lost_by = |port: usize, stage: usize| {
            let kept: f64 = (0..body.count).map(|k| by_state[k] * update(port, stage, k)).sum();
            by_port[port] * (weight[port] / scales.flux) * (duration * QUADRATURE[stage]) - kept
        };
        let lost = (
            std::array::from_fn(|k| by_state[k] * (1.0 - decay[2][k])),
            std::array::from_fn(|port| [lost_by(port, 0), lost_by(port, 1)]),
        );
        let groups = std::array::from_fn(|group| {
            let of = |row: &[f64; MAX_STATES]| std::array::from_fn(|lane| row[LANES * group + lane]);
            let by = |port: Port| {
                [0, 1].map(|stage| std::array::from_fn(|lane| update(port as usize, stage, LANES * group + lane)))
            };
            Group {
                contact: contact.homogeneous.each_ref().map(of),
                decay: of(&decay[2]),
                update: by(Port::Contact),
                cooling: by(Port::Cooling),
            }
        });
        let update = [Port::Ambient, Port::Base]
            .map(|port| [0, 1].map(|stage| std::array::from_fn(|k| update(port as usize, stage, k))));
        Some(Propagator { contact, cooled, mean, by_face, direct, linear, lost, air, groups, update })
    }

    /// Whether a face is linear.
    #[inline(always)]
    pub(crate) fn is_linear(&self, face: usize) -> bool {
        self.linear.acts[face]
    }

    /// Stage fluxes into a linear face from the initial states and the stage values of the other ports.
    #[inline(always)]
    pub(crate) fn linear_flux(&self, face: usize, states: &[f64; MAX_STATES], count: usize, values: &[Pair]) -> Pair {
        let LinearFaces { by_state, by_port, .. } = &self.linear;
        let mut flux = dots(by_state[face].each_ref(), states, count);
        for (value, by) in values.iter().zip(by_port) {
            flux = sum(flux, apply(&by[face], *value));
        }
        flux
    }

    /// Heat that leaves by the constant heat transfer over the step, J/m2.
    #[inline(always)]
    pub(crate) fn lost(&self, states: &[f64; MAX_STATES], count: usize, values: &[Pair; PORTS]) -> f64 {
        let (by_state, by_port) = &self.lost;
        let driven = |port: usize| by_port[port][0] * values[port][0] + by_port[port][1] * values[port][1];
        let [stored] = dots([by_state], states, count);
        stored + ((driven(0) + driven(1)) + (driven(2) + driven(3)))
    }

    /// Temperature of the contact surface at `points` from the initial states alone.
    #[inline(always)]
    pub(crate) fn contact_at<const N: usize>(
        &self,
        points: [usize; N],
        states: &[f64; MAX_STATES],
        count: usize,
    ) -> [f64; N] {
        let mut sums = [[0.0; LANES]; N];
        for (weights, states) in self.groups.iter().zip(states.as_chunks::<LANES>().0).take(count.div_ceil(LANES)) {
            let states = *states;
            for n in 0..N {
                accumulate(&mut sums[n], &weights.contact[points[n]], &states);
            }
        }
        totals(sums)
    }

    /// Advances `states` over the step under the stage fluxes of the contact and of the cooling.
    #[inline(always)]
    pub(crate) fn advance(&self, states: &mut [f64; MAX_STATES], count: usize, contact: Pair, cooling: Option<Pair>) {
        for (weights, states) in self.groups.iter().zip(states.as_chunks_mut::<LANES>().0).take(count.div_ceil(LANES)) {
            // In a local copy, stored at the end: the compiler then need not prove that nothing overlaps.
            let mut new = *states;
            for lane in 0..LANES {
                new[lane] = weights.decay[lane] * new[lane]
                    + weights.update[0][lane] * contact[0]
                    + weights.update[1][lane] * contact[1];
            }
            if let Some([first, last]) = cooling {
                accumulate(&mut new, &weights.cooling[0], &[first; LANES]);
                accumulate(&mut new, &weights.cooling[1], &[last; LANES]);
            }
            *states = new.map(flushed);
        }
    }

    /// Adds to advanced `states` what the stage fluxes of another port bring.
    #[inline(always)]
    pub(crate) fn add(&self, states: &mut [f64; MAX_STATES], count: usize, port: usize, [left, right]: Pair) {
        let [first, second] = &self.update[port - 2];
        let rows = first.as_chunks::<LANES>().0.iter().zip(second.as_chunks::<LANES>().0);
        let groups = states.as_chunks_mut::<LANES>().0.iter_mut().zip(rows);
        for (states, (first, second)) in groups.take(count.div_ceil(LANES)) {
            accumulate(states, first, &[left; LANES]);
            accumulate(states, second, &[right; LANES]);
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
