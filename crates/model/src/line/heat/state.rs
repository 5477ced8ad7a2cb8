//! What heat along the contact line leaves behind; part of a saved state.

use super::bodies::Bodies;
use conduction::line::{Account, FACES, ThermalBody};
use numerics::maximum::all_finite;

/// Temperatures in K above the reference, at which nothing is distorted. Pairs: punch, strip.
#[derive(Clone, PartialEq, Debug)]
pub struct HeatState {
    /// States of the bodies; empty for an insulator.
    pub bodies: [Vec<f64>; 2],
    /// Fluxes into the cells at the end of the last step, W/m2.
    pub flux: [Vec<f64>; 2],
    /// Rates of these fluxes over the last step, W/(m2 s); 0 behind a jump.
    pub slope: [Vec<f64>; 2],
    /// Rate of the pressure over the last step, Pa/s; 0 behind a jump and behind a reversal.
    pub pressure_slope: Vec<f64>,
    /// Temperatures of the cells there.
    pub temperature: [Vec<f64>; 2],
    /// Displacement of both surfaces there, m into the bodies.
    pub distortion: Vec<f64>,
    /// Where the operators kept from step to step were made.
    pub reference: LinearizationPoint,
    /// Friction coefficient without Stribeck factor there, weighted with the pressure.
    pub kinetic_coefficient: f64,
    /// Friction heat of all steps, J per m of depth.
    pub dissipated: f64,
    /// Heat fluxes into the cooled faces of both bodies beyond the constant heat transfer at the end of the last step, W/m2.
    pub cooling: [[f64; FACES]; 2],
    /// Part of the temperature of the cooled surfaces that bodies do not look ahead for, at the start of the last step, K.
    pub lagging: [f64; 2],
    /// Length of the last step, s (0: none yet).
    pub last_step: f64,
    /// Length of the last step that was too long for what grows, s, and the number of steps for which none as long is tried.
    pub rejected_by_growth: [f64; 2],
    /// Accounts of the bodies at initialisation: entries of [`Account`] in their order.
    pub start: [[f64; 4]; 2],
}

/// Temperatures that are looked at together.
const ABREAST: usize = 8;

/// Relative difference of equal lengths of steps.
const ROUNDING: f64 = 1e-9;

/// Where the operators kept from step to step were made.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct LinearizationPoint {
    /// Sliding velocity, m/s.
    pub velocity: f64,
    /// Sliding velocity at the end of the last step, m/s.
    pub last: f64,
    /// Friction coefficient over that without fade.
    pub fade: f64,
    /// Part of the zone within which stages agree in few repetitions.
    pub radius_factor: f64,
}

/// Part by which the velocity may differ from that of the reference in any case.
const RELATIVE_RADIUS: f64 = 0.1;

/// Repetitions of a stage above which the zone is halved, down to this part, and up to which a new reference widens it again.
const MANY: usize = 6;
const FEW: usize = 3;
const LEAST_RADIUS_FACTOR: f64 = 0.01;
const RADIUS_GROWTH: f64 = 1.25;

impl LinearizationPoint {
    /// No reference yet.
    pub fn none() -> LinearizationPoint {
        LinearizationPoint { velocity: f64::NAN, last: f64::NAN, fade: 1.0, radius_factor: 1.0 }
    }

    /// Takes over the reference and the last velocity of a step whose stages were repeated up to `iterations` times.
    ///
    /// How far a reference serves depends on how strongly the contact answers its own heat, near the critical speed without bound.
    /// It is what repetition tells.
    pub fn follow(&mut self, velocity: f64, last: f64, iterations: usize) {
        if iterations > MANY && last != velocity {
            self.radius_factor = (0.5 * self.radius_factor).max(LEAST_RADIUS_FACTOR);
        } else if iterations <= FEW && velocity != self.velocity {
            self.radius_factor = (RADIUS_GROWTH * self.radius_factor).min(1.0);
        }
        (self.velocity, self.last) = (velocity, last);
    }

    /// Reference velocity for a step between two velocities: the last one within the zone (m/s) around it, the velocity itself
    /// where it stays, and otherwise one ahead.
    pub fn choose(&self, velocity: [f64; 2], validity_radius: f64) -> f64 {
        let [from, to] = velocity;
        if from == to && from == self.last {
            return from;
        }
        let middle = 0.5 * (from + to);
        let validity_radius = self.radius_factor * validity_radius.max(RELATIVE_RADIUS * middle.abs());
        if (middle - self.velocity).abs() <= validity_radius {
            return self.velocity;
        }
        if from == to { middle } else { middle + 0.8 * validity_radius.copysign(to - from) }
    }
}

/// The entries of an account in their order.
pub fn entries(account: Account) -> [f64; 4] {
    [account.received, account.stored, account.ambient, account.far]
}

impl HeatState {
    /// Bodies that are `rise` (K; punch, strip) above the reference everywhere.
    pub fn new(bodies: &Bodies, count: usize, rise: [f64; 2], kinetic_coefficient: f64) -> HeatState {
        let zeros = || vec![0.0; count];
        let copies = bodies.copies();
        let mut state = HeatState {
            bodies: bodies.states.map(|states| vec![0.0; states]),
            flux: [zeros(), zeros()],
            slope: [zeros(), zeros()],
            pressure_slope: zeros(),
            temperature: rise.map(|rise| vec![rise; count]),
            distortion: zeros(),
            reference: LinearizationPoint::none(),
            kinetic_coefficient,
            dissipated: 0.0,
            cooling: [[0.0; FACES]; 2],
            lagging: [0.0; 2],
            last_step: 0.0,
            rejected_by_growth: [0.0; 2],
            start: [[0.0; 4]; 2],
        };
        for body in 0..2 {
            if let Some(heat) = &copies[body] {
                heat.uniform(rise[body], &mut state.bodies[body]);
                state.start[body] = entries(heat.account(&state.bodies[body]));
                let mut moved = zeros();
                heat.distortion_at_frozen_state(
                    &state.bodies[body],
                    &Default::default(),
                    &state.flux[body],
                    0.0,
                    &mut moved,
                );
                state.distortion.iter_mut().zip(&moved).for_each(|(sum, value)| *sum += value);
            }
        }
        state
    }

    /// Forgets how the fluxes changed: what they follow has jumped.
    pub fn jump(&mut self) {
        self.slope.iter_mut().for_each(|slope| slope.fill(0.0));
        self.pressure_slope.fill(0.0);
    }

    /// Sliding has turned round: friction heat rises as fast as it fell, and friction loads the other edge.
    pub fn reverse(&mut self) {
        self.pressure_slope.fill(0.0);
        self.slope.iter_mut().flatten().for_each(|slope| *slope = -*slope);
    }

    /// Where the heat of a body went since initialisation, J per m of depth.
    pub fn account(&self, body: usize, heat: &dyn ThermalBody) -> Account {
        let now = entries(heat.account(&self.bodies[body]));
        let since = |entry: usize| now[entry] - self.start[body][entry];
        Account { received: since(0), stored: since(1), ambient: since(2), far: since(3) }
    }

    /// Mean over the contact, of cells of the areas `areas` (per depth, m), of the mean of both surfaces.
    pub fn mean(&self, areas: &[f64]) -> f64 {
        let total: f64 = areas.iter().sum();
        let [punch, strip] = &self.temperature;
        (0..areas.len()).map(|i| 0.5 * areas[i] * (punch[i] + strip[i])).sum::<f64>() / total
    }

    /// Lowest temperature of either surface; not a number where one is not.
    pub fn lowest(&self) -> f64 {
        let lower = |least: f64, t: f64| if t < least || t.is_nan() { t } else { least };
        let mut found = [f64::INFINITY; ABREAST];
        for side in &self.temperature {
            let (groups, rest) = side.as_chunks::<ABREAST>();
            for group in groups {
                for k in 0..ABREAST {
                    found[k] = lower(found[k], group[k]);
                }
            }
            found[0] = rest.iter().copied().fold(found[0], lower);
        }
        found.into_iter().fold(f64::INFINITY, lower)
    }

    /// What is not all finite numbers, if anything.
    pub fn not_finite(&self) -> Option<&'static str> {
        let [[a, b], [c, d]] = self.cooling;
        let others = [self.kinetic_coefficient, self.dissipated, a, b, c, d];
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

    fn numbers(&mut self) -> impl Iterator<Item = &mut f64> {
        let HeatState {
            bodies,
            flux,
            slope,
            pressure_slope,
            temperature,
            distortion,
            reference,
            kinetic_coefficient,
            dissipated,
            cooling,
            lagging,
            last_step,
            rejected_by_growth,
            start,
        } = self;
        let LinearizationPoint { velocity, last, fade, radius_factor } = reference;
        (bodies.iter_mut().chain(flux).chain(slope).chain(temperature).flatten())
            .chain(pressure_slope)
            .chain(distortion)
            .chain([velocity, last, fade, radius_factor, kinetic_coefficient, dissipated, last_step])
            .chain(cooling.iter_mut().flatten())
            .chain(lagging)
            .chain(rejected_by_growth)
            .chain(start.iter_mut().flatten())
    }

    /// Whether a step of this length (s) was just too long for what grows; counts a step that was not.
    pub fn was_rejected_by_growth(&mut self, step: f64) -> bool {
        let [refused, retry_delay] = &mut self.rejected_by_growth;
        *retry_delay = (*retry_delay - 1.0).max(0.0);
        *retry_delay > 0.0 && step >= *refused * (1.0 - ROUNDING)
    }

    /// Takes over `other`, of the same scene, without allocating.
    pub fn copy_from(&mut self, other: &HeatState) {
        self.copy_bodies_from(other);
        self.copy_contact_from(other);
    }

    /// Takes over the states of the bodies alone.
    pub fn copy_bodies_from(&mut self, other: &HeatState) {
        self.bodies.iter_mut().zip(&other.bodies).for_each(|(own, other)| own.copy_from_slice(other));
    }

    /// Takes over everything else.
    pub fn copy_contact_from(&mut self, other: &HeatState) {
        for body in 0..2 {
            self.flux[body].copy_from_slice(&other.flux[body]);
            self.slope[body].copy_from_slice(&other.slope[body]);
            self.temperature[body].copy_from_slice(&other.temperature[body]);
        }
        self.pressure_slope.copy_from_slice(&other.pressure_slope);
        self.distortion.copy_from_slice(&other.distortion);
        (self.kinetic_coefficient, self.dissipated, self.cooling) =
            (other.kinetic_coefficient, other.dissipated, other.cooling);
        (self.start, self.reference) = (other.start, other.reference);
        (self.lagging, self.last_step, self.rejected_by_growth) =
            (other.lagging, other.last_step, other.rejected_by_growth);
    }

    /// Appends all numbers.
    pub fn save(&self, out: &mut Vec<f64>) {
        let mut own = self.clone();
        out.extend(own.numbers().map(|number| *number));
    }

    /// Reads what [`HeatState::save`] wrote over a state of the same scene; `None` if there are too few numbers.
    pub fn load<'a>(&mut self, numbers: &mut impl Iterator<Item = &'a f64>) -> Option<()> {
        for slot in self.numbers() {
            *slot = *numbers.next()?;
        }
        Some(())
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
        // Within the zone it stays, beyond it goes ahead of the velocity.
        assert_eq!(place.choose([1.01, 1.02], 0.4), chosen);
        assert_eq!(place.choose([1.74, 1.76], 0.4), 1.75 + 0.8 * 0.4);
        assert_eq!(place.choose([0.92, 0.90], 0.4), 0.91 - 0.8 * 0.4);
        place.follow(chosen, 1.02, MANY + 1);
        assert_eq!(place.radius_factor, 0.5);
        assert_eq!(place.choose([1.02, 1.04], 0.4), 1.03 + 0.8 * 0.2);
        // Few repetitions by a new reference widen it again, by an old one they do not.
        place.follow(chosen, 1.03, FEW);
        assert_eq!(place.radius_factor, 0.5);
        place.follow(1.19, 1.04, FEW);
        assert_eq!(place.radius_factor, 0.5 * RADIUS_GROWTH);
        // Operators of the velocity itself are as near as can be.
        place.follow(1.04, 1.04, MANY + 1);
        assert_eq!(place.radius_factor, 0.5 * RADIUS_GROWTH);
        (0..40).for_each(|_| place.follow(1.19, 1.04, MANY + 1));
        assert_eq!(place.radius_factor, LEAST_RADIUS_FACTOR);
        (0..40).for_each(|k| place.follow(1.19 + f64::from(k), 1.04, FEW));
        assert_eq!(place.radius_factor, 1.0);
    }
}
