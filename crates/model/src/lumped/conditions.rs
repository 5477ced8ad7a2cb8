//! Conditions of the contact at one instant, as functions of the inputs.
//!
//! Theory: docs/theory.md, sections 1.3, 2.2.

use super::air::FAR;
use super::operators::{BodyOperators, LumpedOperators};
use crate::Inputs;
use crate::events::load_on_contact;
use numerics::scalar::Scalar;
use scene::{Body, Scene, ThermalBoundary};

/// Parameters that may change between steps. A model takes the first three from here. The others are in its operators, which are
/// made anew from the same reduced bodies when one changes: states keep their meaning.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Tunables {
    /// mu_0.
    pub friction_coefficient: f64,
    /// K.
    pub ambient_temperature: f64,
    /// Multiplies wear.
    pub wear_acceleration: f64,
    /// Wear coefficients of punch and strip, m2/N.
    pub wear_coefficient: [f64; 2],
    /// Constant heat transfer coefficients of punch and strip, W/(m2 K).
    pub convection: [f64; 2],
    /// Conductances of the heat paths of punch and strip, W/K.
    pub external_conductance: [f64; 2],
    /// Thermal contact conductance, W/(m2 K).
    pub conductance: f64,
}

impl Tunables {
    /// Names of the variables, in the order of [`Tunables::from_array`].
    pub const NAMES: [&str; 10] = [
        "contact.friction_coefficient",
        "ambient_temperature",
        "wear_acceleration",
        "punch.wear_coefficient",
        "strip.wear_coefficient",
        "punch.convection",
        "strip.convection",
        "punch.external_conductance",
        "strip.external_conductance",
        "contact.conductance",
    ];

    /// From the values of [`Tunables::NAMES`].
    pub fn from_array(values: [f64; 10]) -> Tunables {
        let [friction_coefficient, ambient_temperature, wear_acceleration, k1, k2, h1, h2, g1, g2, conductance] =
            values;
        Tunables {
            friction_coefficient,
            ambient_temperature,
            wear_acceleration,
            wear_coefficient: [k1, k2],
            convection: [h1, h2],
            external_conductance: [g1, g2],
            conductance,
        }
    }

    /// Values of [`Tunables::NAMES`].
    pub fn to_array(&self) -> [f64; 10] {
        let Tunables { wear_coefficient: [k1, k2], convection: [h1, h2], external_conductance: [g1, g2], .. } = *self;
        let [friction, ambient, acceleration] =
            [self.friction_coefficient, self.ambient_temperature, self.wear_acceleration];
        [friction, ambient, acceleration, k1, k2, h1, h2, g1, g2, self.conductance]
    }

    /// Those of a scene before any is tuned.
    pub fn of(scene: &Scene) -> Tunables {
        let bodies = [&scene.punch, &scene.strip];
        Tunables {
            friction_coefficient: scene.friction_coefficient,
            ambient_temperature: scene.ambient_temperature,
            wear_acceleration: scene.wear_acceleration,
            wear_coefficient: bodies.map(|body| body.wear_coefficient),
            convection: bodies.map(|body| body.convection),
            external_conductance: bodies.map(|body| body.external_conductance),
            conductance: scene.conductance,
        }
    }

    /// `scene` with those that are in the operators; `None` where it has them already. The friction coefficient stays that to
    /// which the wear laws refer.
    pub(crate) fn tuned(&self, scene: &Scene) -> Option<Scene> {
        let Tunables { friction_coefficient, ambient_temperature, wear_acceleration, .. } = Tunables::of(scene);
        if Tunables::of(scene) == (Tunables { friction_coefficient, ambient_temperature, wear_acceleration, ..*self }) {
            return None;
        }
        let mut scene = scene.clone();
        for (side, body) in [&mut scene.punch, &mut scene.strip].into_iter().enumerate() {
            body.wear_coefficient = self.wear_coefficient[side];
            body.convection = self.convection[side];
            body.external_conductance = self.external_conductance[side];
        }
        scene.conductance = self.conductance;
        Some(scene)
    }
}

/// Conditions of the contact at one instant.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) struct Conditions<S = f64> {
    /// Velocity of the punch over the strip, m/s.
    pub velocity: S,
    /// Load per face by the actuator, N, >= 0.
    pub load: S,
    /// s v >= 0 with the regularised sign s, m/s.
    pub slip: S,
    /// s.
    pub sign: S,
    /// Stribeck factor under the actuator's load.
    pub stribeck: S,
    /// Ambient temperature, K above the reference.
    pub ambient: S,
    /// Prescribed temperature of the punch's top, K above the reference.
    pub punch_far: S,
    /// Prescribed temperature of the strip's base, K above the reference.
    pub strip_far: S,
    /// Temperatures of the neighbours of punch and strip behind their heat paths, K above the reference; 0 without a path.
    pub neighbours: [S; 2],
    /// Forced convection's velocity factor (v_c/v0)^0.8.
    pub forced: S,
}

impl<S: Scalar> Conditions<S> {
    /// Conditions of `inputs`; temperatures are relative to `reference` (K).
    #[inline]
    pub(crate) fn new(operators: &LumpedOperators, tunables: &Tunables, reference: f64, inputs: &Inputs<S>) -> Self {
        let operating_point = operators.operating_point(inputs);
        let velocity = operating_point.velocity;
        let sign = operators.friction.sign(velocity);
        let ambient = inputs.ambient_temperature_offset + S::from(tunables.ambient_temperature - reference);
        let far = |body: &Body, external: S| match body.far_thermal {
            ThermalBoundary::Held if body.far_temperature > 0.0 => S::from(body.far_temperature - reference),
            ThermalBoundary::Held => ambient,
            ThermalBoundary::External => external - S::from(reference),
            ThermalBoundary::Convecting | ThermalBoundary::Insulated => S::from(0.0),
        };
        let behind = |body: &BodyOperators, external: S| {
            if body.air[FAR].path > 0.0 { external - S::from(reference) } else { S::from(0.0) }
        };
        let mut faces = operators.punch.air.iter().chain(&operators.strip.air);
        let cools = faces.any(|face| face.forced > 0.0);
        let forced = if cools {
            let air = (velocity.abs() + inputs.cooling_velocity).positive();
            if air.value() > 0.0 { air.four_fifths() } else { S::from(0.0) }
        } else {
            S::from(0.0)
        };
        Conditions {
            velocity,
            load: load_on_contact(inputs.normal_load, operators.scene.nominal_load),
            slip: sign * velocity,
            sign,
            stribeck: operators.friction.stribeck(operating_point),
            ambient,
            punch_far: far(&operators.scene.punch, inputs.punch_external_temperature),
            strip_far: far(&operators.scene.strip, inputs.strip_external_temperature),
            neighbours: [
                behind(&operators.punch, inputs.punch_external_temperature),
                behind(&operators.strip, inputs.strip_external_temperature),
            ],
            forced,
        }
    }
}
