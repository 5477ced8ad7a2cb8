//! Contact at one instant at frozen states: basis of the outputs and directional derivatives.
//!
//! Theory: docs/theory.md, section 6.8.

use super::air::{Air, BESIDE, FACES, FAR, PORTS_OF_FACES};
use super::bristle::Bristle;
use super::conditions::{Conditions, Tunables};
use super::interface::{InterfaceFluxes, Side, agree, partition, separated};
use super::operators::{BodyOperators, LumpedOperators};
use super::state::{BodyState, LumpedState};
use conduction::properties::Scales;
use conduction::reduced::{Observation, Port, ReducedBody};
use contact::friction::FrictionLaw;
use numerics::scalar::Scalar;
use scene::ThermalBoundary;

/// Free responses of the observations: sums over the states.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) struct Frozen {
    /// Of punch and strip.
    bodies: [FrozenBody; 2],
    flash: f64,
    /// Approach by wear less thermal expansion, by which a caliper unloads, m.
    closed: f64,
}

#[derive(Clone, Copy, PartialEq, Debug)]
struct FrozenBody {
    contact: f64,
    /// Cooled faces.
    cooled: [f64; FACES],
    ambient_flow: f64,
    base_flow: f64,
    /// Properties at the mean temperature, and the cooling of the faces there.
    scales: Scales,
    air: [Air; FACES],
}

impl FrozenBody {
    fn new(body: &BodyOperators, state: &BodyState, reference: f64, far: f64) -> FrozenBody {
        let properties = body.properties.as_ref().zip(body.heat.as_ref());
        let scales = properties.map_or(Scales::ONE, |(properties, heat)| {
            properties.at(reference + body.mean_rise(heat, &state.heat, far))
        });
        let of = |observation: fn(&ReducedBody) -> &Observation| {
            body.heat.as_ref().map_or(0.0, |heat| observation(heat).of_states(&state.heat, heat.count))
        };
        FrozenBody {
            contact: of(|heat| &heat.contact_temperature),
            cooled: [of(|heat| &heat.cooled_temperature), of(|heat| &heat.base_temperature)],
            ambient_flow: of(|heat| &heat.ambient_flow),
            base_flow: of(|heat| &heat.base_flow),
            scales,
            air: body.air.map(|air| air.at(scales)),
        }
    }

    /// Direct feedthrough of a flux to an observed temperature.
    #[inline]
    fn direct(&self, observation: &Observation, port: usize) -> f64 {
        self.scales.flux * observation.direct[port]
    }
}

impl Frozen {
    /// Free responses of `state`.
    pub(crate) fn new(operators: &LumpedOperators, state: &LumpedState) -> Frozen {
        let (bodies, states) = (operators.bodies(), [&state.punch, &state.strip]);
        let closed = if operators.series_stiffness > 0.0 {
            state.punch.depth + state.strip.depth
                - bodies[0].expansion_at(&state.punch.heat, state.far[0])
                - bodies[1].expansion_at(&state.strip.heat, state.far[1])
        } else {
            0.0
        };
        let frozen = |side: usize| FrozenBody::new(bodies[side], states[side], state.reference, state.far[side]);
        Frozen { bodies: [frozen(0), frozen(1)], flash: state.flash.iter().sum(), closed }
    }
}

/// Contact at one instant. Temperatures in K above the reference.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) struct Point<S = f64> {
    /// Load per face carried by the contact, N.
    pub load: S,
    /// Mean pressure, Pa.
    pub pressure: S,
    /// Friction coefficient with Stribeck factor.
    pub friction_coefficient: S,
    /// Kinetic friction coefficient (without Stribeck factor).
    pub kinetic_coefficient: S,
    /// Friction force of all faces, N, signed.
    pub force: S,
    /// The contact sticks: it is closed, and a bristle is below its sliding limit; without one, the velocity is 0.
    pub sticking: bool,
    /// Friction heat flux, W/m2.
    pub flux: S,
    /// Heat partition and surface temperatures.
    pub partition: InterfaceFluxes<S>,
    /// Mean of both surfaces.
    pub contact_temperature: S,
    /// Heat flow to ambient, all faces, W: punch, strip.
    pub ambient_flow: [S; 2],
    /// Heat flow out of the far faces, all faces, W: punch, strip.
    pub far_flow: [S; 2],
    /// Part of it that flows to the neighbours.
    pub external_flow: [S; 2],
    /// Sliding speed in the wear law, m/s.
    pub wearing_speed: S,
    /// Wear rates of punch and strip under the contact, m/s.
    pub wear_rate: [S; 2],
}

/// Contribution of prescribed temperatures to an observation.
#[inline]
fn prescribed<S: Scalar>(observation: &Observation, ambient: S, far: S) -> S {
    ambient * observation.direct[Port::Ambient as usize] + far * observation.direct[Port::Base as usize]
}

/// Observations of the cooled faces.
fn cooled_faces(heat: &ReducedBody) -> [&Observation; FACES] {
    [&heat.cooled_temperature, &heat.base_temperature]
}

/// Cooling fluxes of a body at frozen states: the direct feedthrough from flux to face temperature is the static correction of
/// truncated modes. The pair is the prescribed temperature of the far face and that of the neighbour.
fn frozen_cooling<S: Scalar>(
    body: &BodyOperators,
    heat: &ReducedBody,
    frozen: &FrozenBody,
    reference: f64,
    conditions: &Conditions<S>,
    [far, neighbour]: [S; 2],
    into: S,
) -> [S; FACES] {
    let mut flux = [S::from(0.0); FACES];
    if !body.air.iter().any(Air::acts) {
        return flux;
    }
    let faces = cooled_faces(heat);
    let level: [S; FACES] = std::array::from_fn(|face| {
        prescribed(faces[face], conditions.ambient, far)
            + into * frozen.direct(faces[face], Port::Contact as usize)
            + S::from(frozen.cooled[face])
    });
    // Each face lies between the air and its level: with the transfer coefficient at its temperature the flux through both in series.
    // The coefficient depends on it by radiation alone, and the faces of a body hardly on each other.
    for _ in 0..MOST_ROUNDS {
        let before = flux;
        for face in 0..FACES {
            let air = &frozen.air[face];
            if air.acts() {
                let correction = frozen.direct(faces[face], PORTS_OF_FACES[face]);
                let t = level[face] + raised(faces[face], &flux) * frozen.scales.flux;
                let without = t - flux[face] * correction;
                let transfer = air.transfer(reference, t, conditions.ambient, conditions.forced);
                let by_air = (conditions.ambient - without) * transfer;
                flux[face] = if air.path > 0.0 {
                    (by_air + (neighbour - without) * air.path)
                        / ((transfer + S::from(air.path)) * correction + S::from(1.0))
                } else {
                    by_air / (transfer * correction + S::from(1.0))
                };
            }
        }
        if flux == before {
            break;
        }
    }
    flux
}

/// Most rounds over the cooled faces of a body.
const MOST_ROUNDS: usize = 8;

/// Direct feedthrough of the cooling fluxes to an observation.
#[inline]
fn raised<S: Scalar>(observation: &Observation, cooling: &[S; FACES]) -> S {
    cooling[BESIDE] * observation.direct[PORTS_OF_FACES[BESIDE]]
        + cooling[FAR] * observation.direct[PORTS_OF_FACES[FAR]]
}

/// Evaluates the contact at frozen states.
pub(crate) fn evaluate<S: Scalar>(
    operators: &LumpedOperators,
    friction: &FrictionLaw,
    state: &LumpedState,
    frozen: &Frozen,
    tunables: &Tunables,
    conditions: &Conditions<S>,
) -> Point<S> {
    let scene = &operators.scene;
    let load = if operators.series_stiffness > 0.0 && conditions.load.value() > 0.0 {
        (conditions.load - S::from(frozen.closed * operators.series_stiffness)).positive()
    } else {
        conditions.load
    };
    let pressure = load * (1.0 / operators.area);
    let closed = pressure.value() > 0.0;
    let (bodies, frozen_bodies) = (operators.bodies(), &frozen.bodies);
    let (far, neighbours) = ([conditions.punch_far, conditions.strip_far], conditions.neighbours);
    let cooled = |side: usize, into: S| match &bodies[side].heat {
        Some(heat) => {
            let around = [far[side], neighbours[side]];
            frozen_cooling(bodies[side], heat, &frozen_bodies[side], state.reference, conditions, around, into)
        }
        None => [S::from(0.0); FACES],
    };
    let beyond = [0.0, frozen.flash + strip_entry(operators, state)];
    let sides = [0, 1].map(|side| match &bodies[side].heat {
        Some(heat) => {
            let (own, observation) = (&frozen_bodies[side], &heat.contact_temperature);
            let level = prescribed(observation, conditions.ambient, far[side])
                + raised(observation, &cooled(side, S::from(0.0))) * own.scales.flux
                + S::from(own.contact + beyond[side]);
            Side { level, gain: Some(own.direct(observation, Port::Contact as usize)) }
        }
        None => Side { level: conditions.ambient, gain: None },
    });
    let bristle = operators.bristle(state.stiffness);
    let faces = scene.faces;
    let stribeck = operators.stribeck(conditions, pressure);
    // Friction heat per unit of the kinetic friction coefficient at temperature.
    let driver = stribeck * conditions.slip * pressure * operators.power_factor;
    let solve = |flux: S| {
        if closed { partition(sides[0], sides[1], flux, scene.conductance) } else { separated(sides[0], sides[1]) }
    };
    let mean = |partition: &InterfaceFluxes<S>| (partition.punch_temperature + partition.strip_temperature) * 0.5;
    let reference = S::from(state.reference);
    let none = solve(S::from(0.0));
    let level = mean(&none) + reference;
    let (mut temperature, mut flux) = (level, S::from(0.0));
    if closed && driver.value() > 0.0 {
        // The temperature is affine in the heat: two evaluations give its gain.
        let gain = mean(&solve(driver)) + reference - level;
        temperature = agree(friction, level, gain);
        flux = friction.kinetic_coefficient(temperature) * driver;
    }
    let kinetic_at =
        |temperature: S| friction.kinetic_coefficient(temperature) * stribeck * load * (faces * operators.power_factor);
    // Only slip generates heat: a bristle sticks where it is below its sliding limit.
    if let Some(bristle) = bristle
        && !bristle.force(state.bristle, conditions.velocity.value(), kinetic_at(temperature).value()).1
    {
        temperature = level;
    }
    let kinetic_coefficient = friction.kinetic_coefficient(temperature);
    let mu = kinetic_coefficient * stribeck;
    let kinetic = mu * load * (faces * operators.power_factor);
    let mut force = kinetic * conditions.sign;
    let mut wearing_speed = conditions.slip;
    let mut sticking = closed && conditions.velocity.value() == 0.0;
    if let Some(bristle) = bristle {
        let (held, slips) = bristle.force(state.bristle, conditions.velocity.value(), kinetic.value());
        sticking = closed && !slips;
        let v = conditions.velocity;
        force = if slips {
            kinetic * held.signum()
        } else {
            S::from(bristle.stiffness * state.bristle) + v * bristle.damping
        };
        let deflecting = match (slips, bristle.damping > 0.0) {
            (true, true) => (force - S::from(bristle.stiffness * state.bristle)) * (1.0 / bristle.damping),
            (true, false) => S::from(0.0),
            (false, _) => v,
        };
        wearing_speed = if slips { (v - deflecting).abs() } else { S::from(0.0) };
        // Heat: the work of the slider and of the damper.
        let power = force * v - deflecting * (bristle.stiffness * state.bristle);
        flux = if closed { power.positive() * (1.0 / (faces * operators.area)) } else { S::from(0.0) };
    }
    let partition = solve(flux);
    let contact_temperature = mean(&partition);
    // Heat flows to ambient, out of the far face, and of that to the neighbour. The contact's heat changes the temperature of the cooled
    // surface; the feedback of its flux on the contact, by another static correction, is neglected.
    let flows = [(0, partition.punch), (1, partition.strip)].map(|(side, into)| {
        let (body, own, far) = (bodies[side], &frozen_bodies[side], far[side]);
        let Some(heat) = &body.heat else { return [S::from(0.0); 3] };
        let (cooling, all) = (cooled(side, into), body.area * faces);
        let observe = |observation: &Observation, states: f64| {
            // The states are those of the conductivity K0.
            (S::from(states) * (1.0 / own.scales.flux)
                + into * observation.direct[Port::Contact as usize]
                + raised(observation, &cooling)
                + prescribed(observation, conditions.ambient, far) * (1.0 / own.scales.flux))
                * all
        };
        let out = observe(&heat.base_flow, own.base_flow);
        let mut path = S::from(0.0);
        if body.air[FAR].path > 0.0 {
            let t = S::from(own.cooled[FAR])
                + into * own.direct(&heat.base_temperature, Port::Contact as usize)
                + raised(&heat.base_temperature, &cooling) * own.scales.flux
                + prescribed(&heat.base_temperature, conditions.ambient, far);
            let by_air = own.air[FAR].flux_by_air(state.reference, t, conditions.ambient, conditions.forced);
            path = (by_air - cooling[FAR]) * all;
        }
        [observe(&heat.ambient_flow, own.ambient_flow) - cooling[BESIDE] * all, out, external_flow(body, out, path)]
    });
    let wear = |body: &BodyOperators| {
        body.wear.rate(pressure, wearing_speed, kinetic_coefficient, contact_temperature + reference)
            * (body.wear_factor * tunables.wear_acceleration)
    };
    Point {
        load,
        pressure,
        friction_coefficient: mu,
        kinetic_coefficient,
        force,
        sticking,
        flux,
        partition,
        contact_temperature,
        ambient_flow: flows.map(|[ambient, ..]| ambient),
        far_flow: flows.map(|[_, far, _]| far),
        external_flow: flows.map(|[.., external]| external),
        wearing_speed,
        wear_rate: bodies.map(wear),
    }
}

/// Heat flow to the neighbour of a body: all of that out of its far face where the input prescribes the temperature there,
/// otherwise that by the heat path.
pub(crate) fn external_flow<T>(body: &BodyOperators, far: T, path: T) -> T {
    if body.far == ThermalBoundary::External { far } else { path }
}

/// Temperature (K above the reference) at which fresh material arrives in unidirectional sliding on a straight path.
pub(crate) fn strip_entry(operators: &LumpedOperators, state: &LumpedState) -> f64 {
    let initial = operators.scene.strip.initial_temperature;
    if operators.strip_remembers || initial == 0.0 { 0.0 } else { initial - state.reference }
}

impl LumpedOperators {
    /// Bristle of this stiffness (N/m), which is 0 where there is none.
    pub(crate) fn bristle(&self, stiffness: f64) -> Option<Bristle> {
        (stiffness > 0.0).then_some(Bristle { stiffness, damping: self.scene.stick_damping })
    }

    /// Stiffness (N/m) of the bristle, all faces together: `contact.stick_stiffness` in series with the bodies, whose friction force
    /// over elastic displacement is `elastic`; 0: no bristle.
    pub(crate) fn stick_stiffness(&self, elastic: f64) -> f64 {
        let given = if self.scene.stick_stiffness > 0.0 { self.scene.stick_stiffness.recip() } else { 0.0 };
        let own = if self.scene.elastic_slip { elastic.recip() } else { 0.0 };
        let sum = given + own;
        if sum > 0.0 { sum.recip() } else { 0.0 }
    }

    /// Elastic displacement of the faces against each other between full slip to one side and to the other, at nominal load, m.
    pub fn deformation_at_reversal(&self) -> f64 {
        let scene = &self.scene;
        let force = scene.friction_coefficient * scene.nominal_load * scene.faces * self.power_factor;
        2.0 * force / self.tangential_stiffness
    }

    /// Whether there is a bristle.
    pub(crate) fn has_bristle(&self) -> bool {
        self.stick_stiffness(self.tangential_stiffness) > 0.0
    }
}
