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
use super::estimate::cooling_error;
use super::operators::BodyOperators;
use conduction::properties::Scales;
use conduction::reduced::{MAX_STATES, Observation, PORTS, Port, ReducedBody};
use nalgebra::{SMatrix, SVector};
use numerics::factorization;
use scene::ThermalBoundary;

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
#[inline(always)]
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

    /// `weight`: factors of the fluxes, by port.
    fn new(
        body: &ReducedBody,
        observation: &Observation,
        decay: &Decay,
        driven: &Driven,
        weight: &[f64; PORTS],
    ) -> Observed {
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
                    let gain = &mut observed.gain[port][point][stage];
                    *gain = (*gain + observation.direct[port] * BASIS[point][stage]) * weight[port];
                }
            }
        }
        observed
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

/// Faces whose fluxes are linear in their temperatures and in nothing else ([`Air::is_linear`]), eliminated from a step whose only other
/// fluxes are those of contact and cooling, at no ambient temperature.
#[derive(Clone, Debug)]
struct LinearFaces {
    acts: [bool; FACES],
    /// Stage fluxes per initial state: `[face][stage][state]`.
    by_state: [[[f64; MAX_STATES]; 2]; FACES],
    /// Stage fluxes per stage flux of contact and cooling: `[port][face][stage][stage]`.
    by_flux: [[[[f64; 2]; 2]; FACES]; 2],
}

impl LinearFaces {
    fn new(cooled: &[Observed; FACES], air: &[Air; FACES]) -> LinearFaces {
        const UNKNOWNS: usize = 2 * FACES;
        let acts = air.each_ref().map(Air::is_linear);
        let mut faces =
            LinearFaces { acts, by_state: [[[0.0; MAX_STATES]; 2]; FACES], by_flux: [[[[0.0; 2]; 2]; FACES]; 2] };
        if acts == [false; FACES] {
            return faces;
        }
        let unknowns = || (0..UNKNOWNS).map(|k| (k, k / 2, k % 2));
        let mut matrix = SMatrix::<f64, UNKNOWNS, UNKNOWNS>::identity();
        for (k, face, stage) in unknowns().filter(|(_, face, _)| acts[*face]) {
            for (l, other, at) in unknowns().filter(|(_, face, _)| acts[*face]) {
                matrix[(k, l)] += air[face].rest * cooled[face].gain[PORTS_OF_FACES[other]][2 * stage][at];
            }
        }
        // Columns of the inverse.
        let columns: [SVector<f64, UNKNOWNS>; UNKNOWNS] = std::array::from_fn(|k| {
            let unit = SVector::from_fn(|l, _| if l == k { 1.0 } else { 0.0 });
            factorization::solve(&matrix, &unit).unwrap_or_else(|_| SVector::repeat(f64::NAN))
        });
        for (k, face, stage) in unknowns().filter(|(_, face, _)| acts[*face]) {
            let (rest, observed, point) = (-air[face].rest, &cooled[face], 2 * stage);
            for (l, to, at) in unknowns().filter(|(_, face, _)| acts[*face]) {
                let weight = columns[k][l] * rest;
                for (flux, state) in faces.by_state[to][at].iter_mut().zip(&observed.homogeneous[point]) {
                    *flux += weight * state;
                }
                for port in 0..2 {
                    for driver in 0..2 {
                        faces.by_flux[port][to][at][driver] += weight * observed.gain[port][point][driver];
                    }
                }
            }
        }
        faces
    }

    /// What is observed with these faces.
    fn observed(&self, without: &Observed) -> Observed {
        let mut with = without.clone();
        for face in (0..FACES).filter(|&face| self.acts[face]) {
            for (point, gain) in without.gain[PORTS_OF_FACES[face]].iter().enumerate() {
                for (stage, gain) in gain.iter().enumerate() {
                    for (with, flux) in with.homogeneous[point].iter_mut().zip(&self.by_state[face][stage]) {
                        *with += gain * flux;
                    }
                    for port in 0..2 {
                        for at in 0..2 {
                            with.gain[port][point][at] += gain * self.by_flux[port][face][stage][at];
                        }
                    }
                }
            }
        }
        with
    }
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
    /// Contact and mean temperature for the fast path: with the linear faces.
    pub fast: [Observed; 2],
    linear: LinearFaces,
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
    /// Propagator of the body `of` over the step `step` (s) at the properties `scales`; `None` for an insulator. The temperature of a face
    /// is observed where its cooling acts.
    pub fn new(of: &BodyOperators, step: f64, scales: Scales) -> Option<Propagator> {
        let body = of.heat.as_ref()?;
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
        let mut update = [[[0.0; MAX_STATES]; 2]; PORTS];
        for k in 0..body.count {
            let by_stage = driven[2][k];
            for port in 0..PORTS {
                for stage in 0..2 {
                    update[port][stage][k] = body.input[port][k] * by_stage[stage] * weight[port];
                }
            }
        }
        let observed = |observation: &Observation| Observed::new(body, observation, &decay, &driven, &weight);
        let [contact, mean] = [&body.contact_temperature, &body.mean_temperature].map(observed);
        let cooled = [(&body.cooled_temperature, cools[BESIDE]), (&body.base_temperature, cools[FAR])]
            .map(|(observation, asked)| if asked { observed(observation) } else { Observed::none() });
        let linear = LinearFaces::new(&cooled, &air);
        let fast = [&contact, &mean].map(|without| linear.observed(without));
        let surface = std::array::from_fn(|group| {
            let of = |row: &[f64; MAX_STATES]| std::array::from_fn(|lane| row[LANES * group + lane]);
            Group {
                contact: fast[0].homogeneous.each_ref().map(of),
                decay: of(&decay[2]),
                update: update[Port::Contact as usize].each_ref().map(of),
                cooling: update[Port::Cooling as usize].each_ref().map(of),
            }
        });
        Some(Propagator { contact, cooled, mean, fast, linear, air, decay: decay[2], update, surface })
    }

    /// Stage fluxes into the linear faces from the initial states and the stage fluxes of contact and cooling; `None` where there are no
    /// such faces.
    #[inline(always)]
    pub fn linear_fluxes(
        &self,
        states: &[f64; MAX_STATES],
        count: usize,
        fluxes: [[f64; 2]; 2],
    ) -> [Option<[f64; 2]>; FACES] {
        let LinearFaces { acts, by_state, by_flux } = &self.linear;
        let flux = |face: usize, stage: usize| {
            let driven = |port: usize| {
                let gain = &by_flux[port][face][stage];
                gain[0] * fluxes[port][0] + gain[1] * fluxes[port][1]
            };
            dot(&by_state[face][stage], states, count) + (driven(0) + driven(1))
        };
        [BESIDE, FAR].map(|face| acts[face].then(|| [flux(face, 0), flux(face, 1)]))
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

    /// Bound of [`Propagator::linear_error`] at constant conditions, where a flux relaxes: it deviates from the line through both stages by
    /// at most half their difference.
    #[inline(always)]
    pub fn bound_of_linear(&self, faces: &[Option<[f64; 2]>; FACES]) -> f64 {
        let mut bound = 0.0;
        for (face, port) in PORTS_OF_FACES.into_iter().enumerate() {
            if let Some(flux) = faces[face] {
                bound += self.error_of(face, port, 0.5 * (flux[1] - flux[0]));
            }
        }
        bound
    }

    /// Error of the temperatures at the end of the step by a `residual` of a linear face, K.
    #[inline(always)]
    fn error_of(&self, face: usize, port: usize, residual: f64) -> f64 {
        let [own, contact, mean] =
            [&self.cooled[face], &self.contact, &self.mean].map(|one| one.gain[port][2][0] + one.gain[port][2][1]);
        cooling_error(residual, self.air[face].rest, own, [contact, mean])
    }

    /// Error of the temperatures at the end of the step by the linear faces, K: see [`cooling_error`]. `fluxes` as in
    /// [`Propagator::linear_fluxes`], which gives `faces`.
    #[inline(never)]
    pub fn linear_error(
        &self,
        states: &[f64; MAX_STATES],
        count: usize,
        fluxes: [[f64; 2]; 2],
        faces: &[Option<[f64; 2]>; FACES],
    ) -> f64 {
        let mut error = 0.0;
        for (face, port) in PORTS_OF_FACES.into_iter().enumerate() {
            let (Some(flux), observed, rest) = (faces[face], &self.cooled[face], self.air[face].rest) else { continue };
            let by_faces = PORTS_OF_FACES.into_iter().zip(faces).filter_map(|(port, flux)| Some((port, (*flux)?)));
            let driven =
                fluxes.into_iter().enumerate().chain(by_faces).map(|(port, flux)| observed.of_flux(port, 1, flux));
            let t = observed.of_states(1, states, count) + driven.sum::<f64>();
            let residual = -rest * t - (BASIS[1][0] * flux[0] + BASIS[1][1] * flux[1]);
            error += self.error_of(face, port, residual);
        }
        error
    }

    /// [`Propagator::advance`] where only the contact and the faces `faces` have fluxes.
    #[inline(always)]
    pub fn advance_surface(
        &self,
        states: &mut [f64; MAX_STATES],
        count: usize,
        contact: [f64; 2],
        [cooling, far]: [Option<[f64; 2]>; FACES],
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
        if let Some(far) = far {
            let [first, last] = &self.update[PORTS_OF_FACES[FAR]];
            for k in 0..LANES * count.div_ceil(LANES) {
                states[k] += first[k] * far[0] + last[k] * far[1];
            }
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
