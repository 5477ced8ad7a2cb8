//! Thermal state of the contact line; part of a saved state.
//!
//! Theory: docs/theory.md, sections 1.3, 6.4.

use super::bodies::Bodies;
use super::edges::EdgeState;
use conduction::line::{Account, FACES, FrozenState, ThermalBody};
use numerics::maximum::all_finite;

/// Thermal state. Temperatures in K above the reference temperature, at which there is no distortion. Pairs: punch, strip.
#[derive(Clone, PartialEq, Debug)]
pub struct HeatState {
    /// States of the bodies; empty for an insulator.
    pub bodies: [Vec<f64>; 2],
    /// Fluxes into the cells at the end of the last step, W/m2.
    pub flux: [Vec<f64>; 2],
    /// Rates of these fluxes over the last step, W/(m2 s); 0 after a jump.
    pub slope: [Vec<f64>; 2],
    /// Rate of the pressure over the last step, Pa/s; 0 after a jump and after a reversal.
    pub pressure_slope: Vec<f64>,
    /// State from which the edges of the contact are found.
    pub edges: EdgeState,
    /// Temperatures of the cells at the end of the last step: means of whole cells.
    pub temperature: [Vec<f64>; 2],
    /// Thermal distortion at the end of the last step: displacement of both surfaces, m into the bodies.
    pub distortion: Vec<f64>,
    /// Linearization point of the operators reused from step to step.
    pub reference: LinearizationPoint,
    /// Kinetic friction coefficient (without Stribeck factor) at the end of the last step, weighted by pressure.
    pub kinetic_coefficient: f64,
    /// Friction heat of all steps, J per m of depth.
    pub dissipated: f64,
    /// Heat fluxes into the cooled faces of both bodies beyond the constant heat transfer at the end of the last step, W/m2.
    pub cooling: [[f64; FACES]; 2],
    /// Rates of these fluxes over the last step, W/(m2 s); 0 after a jump and after a reversal.
    pub cooling_slope: [[f64; FACES]; 2],
    /// Heat paths to the neighbours of both bodies: flow out at the end of the last step, W/m2 of the far face, and its integral, J/m2.
    pub external: [[f64; 2]; 2],
    /// Rates of the mean temperatures of both bodies over the last step, K/s, where their properties follow them.
    pub trend: [f64; 2],
    /// Length of the last step, s (0: none yet).
    pub last_step: f64,
    /// Length of the last step rejected by the growth guard, s, and the number of steps before one as long is tried again.
    pub rejected_by_growth: [f64; 2],
    /// Heat accounts of the bodies at initialisation: entries of [`Account`] in their order.
    pub start: [[f64; 4]; 2],
}

/// Cells compared at once for the largest or lowest value.
pub(crate) const CELL_LANES: usize = 8;

/// Linearization point of the operators reused from step to step, with its validity radius.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct LinearizationPoint {
    /// Sliding velocity, m/s.
    pub velocity: f64,
    /// Sliding velocity at the end of the last step, m/s.
    pub last: f64,
    /// Friction coefficient over that at the temperature without fade.
    pub fade: f64,
    /// Factor of the validity radius by which stages converge in few iterations.
    pub radius_factor: f64,
    /// Ratio of the second change of the pressure to the first to be expected in the iteration of a stage; 1: not known.
    pub contraction: f64,
}

/// Numbers of iterations of a stage above which the validity radius is halved, and up to which a new linearization point enlarges
/// it; least factor, with which the Peclet number of the shortest wave with states differs by a thousandth, and factor of enlargement.
const MANY: usize = 6;
const FEW: usize = 3;
const LEAST_RADIUS_FACTOR: f64 = 1e-4;
const RADIUS_GROWTH: f64 = 1.25;

impl LinearizationPoint {
    /// No linearization point yet.
    pub(crate) fn none() -> LinearizationPoint {
        LinearizationPoint { velocity: f64::NAN, last: f64::NAN, fade: 1.0, radius_factor: 1.0, contraction: 1.0 }
    }

    /// Stores the linearization point and the final velocity of a step whose stages took up to `iterations` iterations, and
    /// adapts the validity radius.
    ///
    /// The range of validity depends on the feedback of pressure through its own heat, which is unbounded near the critical
    /// speed; the number of iterations measures it.
    pub(crate) fn follow(&mut self, velocity: f64, last: f64, iterations: usize) {
        if iterations > MANY && last != velocity {
            self.shrink(0.5);
        } else if iterations <= FEW && velocity != self.velocity {
            self.radius_factor = (RADIUS_GROWTH * self.radius_factor).min(1.0);
        }
        (self.velocity, self.last) = (velocity, last);
    }

    /// Narrows the validity radius after a step without solution, as far as the step is shortened.
    pub(crate) fn narrow(&mut self) {
        self.shrink(0.25);
        self.contraction = 1.0;
    }

    fn shrink(&mut self, factor: f64) {
        self.radius_factor = (factor * self.radius_factor).max(LEAST_RADIUS_FACTOR);
    }

    /// Reference velocity (m/s) for a step between two velocities: the last one within its validity radius (m/s), the velocity
    /// itself where it is constant, and otherwise one ahead of it.
    pub(crate) fn choose(&self, velocity: [f64; 2], validity_radius: f64) -> f64 {
        let [from, to] = velocity;
        if from == to && from == self.last {
            return from;
        }
        let middle = 0.5 * (from + to);
        // Relative validity radius: change of velocity for which the operators are reused in any case.
        let validity_radius = self.radius_factor * validity_radius.max(0.1 * middle.abs());
        if (middle - self.velocity).abs() <= validity_radius {
            return self.velocity;
        }
        if from == to { middle } else { middle + 0.8 * validity_radius.copysign(to - from) }
    }
}

/// Entries of an account in their order.
pub(crate) fn entries(account: Account) -> [f64; 4] {
    [account.received, account.stored, account.ambient, account.far]
}

impl HeatState {
    /// State of bodies at the reference temperature, in friction at the coefficient 0.
    pub(crate) fn new(bodies: &Bodies, count: usize) -> HeatState {
        let zeros = || vec![0.0; count];
        HeatState {
            bodies: bodies.states.map(|states| vec![0.0; states]),
            flux: [zeros(), zeros()],
            slope: [zeros(), zeros()],
            pressure_slope: zeros(),
            edges: EdgeState::new(count),
            temperature: [zeros(), zeros()],
            distortion: zeros(),
            reference: LinearizationPoint::none(),
            kinetic_coefficient: 0.0,
            dissipated: 0.0,
            cooling: [[0.0; FACES]; 2],
            cooling_slope: [[0.0; FACES]; 2],
            external: [[0.0; 2]; 2],
            trend: [0.0; 2],
            last_step: 0.0,
            rejected_by_growth: [0.0; 2],
            start: [[0.0; 4]; 2],
        }
    }

    /// Warms the bodies to the uniform temperature `rise` (K; punch, strip) above the reference.
    pub(crate) fn warm(&mut self, bodies: &Bodies, rise: [f64; 2]) {
        self.temperature.iter_mut().zip(rise).for_each(|(cells, rise)| cells.fill(rise));
        for (body, heat) in bodies.prototypes.iter().enumerate() {
            let Some(heat) = heat else { continue };
            heat.uniform(rise[body], &mut self.bodies[body]);
            self.start[body] = entries(heat.account(&self.bodies[body]));
            let (own, surroundings) = (&self.bodies[body], &Default::default());
            let moved = FrozenState { state: own, surroundings, flux: &self.flux[body], velocity: 0.0 };
            let moved = moved.distortion(&**heat);
            self.distortion.iter_mut().zip(&moved).for_each(|(sum, value)| *sum += value);
        }
    }

    /// Sets the rates of flux and pressure to 0 after a jump.
    pub(crate) fn jump(&mut self) {
        self.slope.iter_mut().for_each(|slope| slope.fill(0.0));
        self.pressure_slope.fill(0.0);
        self.cooling_slope = [[0.0; FACES]; 2];
        self.edges.rate.fill(0.0);
    }

    /// Reversal of the sliding direction: friction heat rises as fast as it fell, and the shear coupling loads the other edge.
    pub(crate) fn reverse(&mut self) {
        self.pressure_slope.fill(0.0);
        self.cooling_slope = [[0.0; FACES]; 2];
        self.edges.rate.fill(0.0);
        self.slope.iter_mut().flatten().for_each(|slope| *slope = -*slope);
    }

    /// Longest time within `length` (s) over which rates of the last step extrapolate. Step control doubles a step at most; where a step
    /// is longer, perhaps after microseconds up to an event, a rate over the last step says nothing about it.
    pub(crate) fn ahead(&self, length: f64) -> f64 {
        length.min(2.0 * self.last_step)
    }

    /// Heat balance of a body since initialisation, J per m of depth.
    pub(crate) fn account(&self, body: usize, heat: &dyn ThermalBody) -> Account {
        let now = entries(heat.account(&self.bodies[body]));
        let since = |entry: usize| now[entry] - self.start[body][entry];
        Account { received: since(0), stored: since(1), ambient: since(2), far: since(3) }
    }

    /// Mean over the contact of the mean temperature of both surfaces, for cells of the areas `areas` (per depth, m).
    pub(crate) fn mean(&self, areas: &[f64]) -> f64 {
        let total: f64 = areas.iter().sum();
        let [punch, strip] = &self.temperature;
        (0..areas.len()).map(|i| 0.5 * areas[i] * (punch[i] + strip[i])).sum::<f64>() / total
    }

    /// Lowest temperature of either surface; NaN where one is NaN.
    pub fn lowest(&self) -> f64 {
        let lower = |least: f64, t: f64| if t < least || t.is_nan() { t } else { least };
        let mut found = [f64::INFINITY; CELL_LANES];
        for side in &self.temperature {
            let (groups, rest) = side.as_chunks::<CELL_LANES>();
            for group in groups {
                for k in 0..CELL_LANES {
                    found[k] = lower(found[k], group[k]);
                }
            }
            found[0] = rest.iter().copied().fold(found[0], lower);
        }
        found.into_iter().fold(f64::INFINITY, lower)
    }

    /// Name of a quantity that is not finite, if any.
    pub(crate) fn not_finite(&self) -> Option<&'static str> {
        let [[a, b], [c, d]] = self.cooling;
        let [[e, f], [g, h]] = self.external;
        let others = [self.kinetic_coefficient, self.dissipated, a, b, c, d, e, f, g, h];
        let rows = [
            ("heat in the punch", &self.bodies[0][..]),
            ("heat in the strip", &self.bodies[1]),
            ("the flux into the punch", &self.flux[0]),
            ("the flux into the strip", &self.flux[1]),
            ("the temperature of the punch", &self.temperature[0]),
            ("the temperature of the strip", &self.temperature[1]),
            ("the distortion", &self.distortion),
            ("friction, its heat or cooling", &others),
        ];
        rows.into_iter().find(|(_, numbers)| !all_finite(numbers)).map(|(name, _)| name)
    }

    /// All numbers, in the order in which they are saved.
    fn parts(&mut self) -> impl Iterator<Item = &mut [f64]> {
        let HeatState {
            bodies,
            flux,
            slope,
            pressure_slope,
            edges,
            temperature,
            distortion,
            reference,
            kinetic_coefficient,
            dissipated,
            cooling,
            cooling_slope,
            external,
            trend,
            last_step,
            rejected_by_growth,
            start,
        } = self;
        let LinearizationPoint { velocity, last, fade, radius_factor, contraction } = reference;
        let scalars = [velocity, last, fade, radius_factor, contraction, kinetic_coefficient, dissipated, last_step];
        let faces = [cooling, cooling_slope, external].map(|of| of.as_flattened_mut());
        (bodies.iter_mut().chain(flux).chain(slope).chain(temperature))
            .chain([pressure_slope, distortion])
            .chain(edges.vectors())
            .map(Vec::as_mut_slice)
            .chain(scalars.map(std::slice::from_mut))
            .chain(faces)
            .chain([start.as_flattened_mut(), trend, rejected_by_growth])
    }

    /// Whether the growth guard recently rejected a step of this length (s); counts down the retry delay.
    pub(crate) fn was_rejected_by_growth(&mut self, step: f64) -> bool {
        let [refused, retry_delay] = &mut self.rejected_by_growth;
        *retry_delay = (*retry_delay - 1.0).max(0.0);
        // Relative difference below which step lengths are equal.
        *retry_delay > 0.0 && step >= *refused * (1.0 - 1e-9)
    }

    /// Copies the states of the bodies alone.
    pub(crate) fn copy_bodies_from(&mut self, other: &HeatState) {
        self.bodies.iter_mut().zip(&other.bodies).for_each(|(own, other)| own.copy_from_slice(other));
    }

    /// Copies everything except the states of the bodies.
    pub(crate) fn copy_contact_from(&mut self, other: &HeatState) {
        for body in 0..2 {
            self.flux[body].copy_from_slice(&other.flux[body]);
            self.slope[body].copy_from_slice(&other.slope[body]);
            self.temperature[body].copy_from_slice(&other.temperature[body]);
        }
        self.pressure_slope.copy_from_slice(&other.pressure_slope);
        self.edges.copy_from(&other.edges);
        self.distortion.copy_from_slice(&other.distortion);
        (self.kinetic_coefficient, self.dissipated, self.cooling) =
            (other.kinetic_coefficient, other.dissipated, other.cooling);
        (self.start, self.reference, self.external) = (other.start, other.reference, other.external);
        (self.cooling_slope, self.trend) = (other.cooling_slope, other.trend);
        (self.last_step, self.rejected_by_growth) = (other.last_step, other.rejected_by_growth);
    }

    /// Appends all numbers.
    pub(crate) fn save(&self, out: &mut Vec<f64>) {
        self.clone().parts().for_each(|part| out.extend_from_slice(part));
    }

    /// Whether all numbers but the linearization point, which may not be known yet, are finite.
    pub(crate) fn is_finite(&self) -> bool {
        let known = LinearizationPoint { velocity: 0.0, last: 0.0, ..LinearizationPoint::none() };
        HeatState { reference: known, ..self.clone() }.parts().all(|part| all_finite(part))
    }

    /// Reads what [`HeatState::save`] wrote over a state of the same scene; `None` if there are too few numbers.
    pub(crate) fn load(&mut self, numbers: &mut std::slice::Iter<'_, f64>) -> Option<()> {
        self.parts().try_for_each(|part| {
            let (own, rest) = numbers.as_slice().split_at_checked(part.len())?;
            part.copy_from_slice(own);
            *numbers = rest.iter();
            Some(())
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_reference_that_struggles_is_followed_by_nearer_ones() {
        let mut place = LinearizationPoint::none();
        let chosen = place.choose([1.0, 1.01], 0.4);
        assert_eq!(chosen, 1.005 + 0.8 * 0.4);
        place.follow(chosen, 1.01, MANY);
        // Within the validity radius the linearization point stays, beyond it is set ahead of the velocity.
        assert_eq!(place.choose([1.01, 1.02], 0.4), chosen);
        assert_eq!(place.choose([1.74, 1.76], 0.4), 1.75 + 0.8 * 0.4);
        assert_eq!(place.choose([0.92, 0.90], 0.4), 0.91 - 0.8 * 0.4);
        place.follow(chosen, 1.02, MANY + 1);
        assert_eq!(place.radius_factor, 0.5);
        assert_eq!(place.choose([1.02, 1.04], 0.4), 1.03 + 0.8 * 0.2);
        // Few iterations at a new linearization point enlarge the radius again, at an old one they do not.
        place.follow(chosen, 1.03, FEW);
        assert_eq!(place.radius_factor, 0.5);
        place.follow(1.19, 1.04, FEW);
        assert_eq!(place.radius_factor, 0.5 * RADIUS_GROWTH);
        // Operators at the velocity itself cannot be closer.
        place.follow(1.04, 1.04, MANY + 1);
        assert_eq!(place.radius_factor, 0.5 * RADIUS_GROWTH);
        (0..40).for_each(|_| place.follow(1.19, 1.04, MANY + 1));
        assert_eq!(place.radius_factor, LEAST_RADIUS_FACTOR);
        place.radius_factor = 0.5;
        place.narrow();
        assert_eq!(place.radius_factor, 0.125);
        (0..60).for_each(|k| place.follow(1.19 + f64::from(k), 1.04, FEW));
        assert_eq!(place.radius_factor, 1.0);
    }
}
