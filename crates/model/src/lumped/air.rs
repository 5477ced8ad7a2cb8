//! Cooled faces of a body: forced convection and radiation beyond the constant heat transfer, and the heat path to a neighbour.
//!
//! A constant heat transfer coefficient H0 is within the states of the reduced body. Where the conductivity K of the body follows its
//! temperature, it acts there as H0 K/K0. The rest of the coefficient H that acts, `H - H0 K/K0`, is a flux like the forced part; H
//! differs from H0 where it has been tuned since the initialisation.
//!
//! Theory: docs/theory.md, section 4.11.

use conduction::STEFAN_BOLTZMANN;
pub(crate) use conduction::line::{BESIDE, FACES, FAR};
use conduction::properties::Scales;
use conduction::reduced::Port;
use numerics::scalar::Scalar;
use scene::{Body, Scene, ThermalBoundary};

/// Ports of the heat fluxes through the faces.
pub(crate) const PORTS_OF_FACES: [usize; FACES] = [Port::Cooling as usize, Port::Base as usize];

/// Fluxes of one face beyond its constant heat transfer: the flux into it at the temperature T is
/// `(forced (v_c/v_0)^0.8 + rest) (T_ambient - T) + emissivity sigma (T_ambient^4 - T^4) + path (T_neighbour - T)`.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct Air {
    /// Forced heat transfer coefficient at 1 m/s per reference area, W/(m2 K).
    pub forced: f64,
    /// Emissivity per reference area.
    pub emissivity: f64,
    /// Conductance of the heat path to the neighbour per reference area, W/(m2 K): at the far face only.
    pub path: f64,
    /// H0 where the conductivity of the body follows its temperature, W/(m2 K) per reference area; 0 elsewhere.
    pub within: f64,
    /// H - H0, W/(m2 K) per reference area.
    pub tuned: f64,
    /// Part of H that is not within the states at the present conductivity, W/(m2 K).
    pub rest: f64,
}

impl Air {
    /// Fluxes of the faces of `body`, whose states have the heat transfer coefficient `within` (H0), with the reference area `area`
    /// (m2, all faces); the free surface beside the contact is `part` of it.
    pub fn of(body: &Body, within: f64, part: f64, area: f64) -> [Air; FACES] {
        let over = |part: f64| match body.conductivity > 0.0 && part > 0.0 {
            true => Air {
                forced: body.convection_forced * part,
                emissivity: body.emissivity * part,
                within: if body.properties.is_some() { within * part } else { 0.0 },
                tuned: (body.convection - within) * part,
                ..Air::default()
            }
            .at(Scales::ONE),
            false => Air::default(),
        };
        let far = over(if body.far_thermal == ThermalBoundary::Convecting { 1.0 } else { 0.0 });
        let path = if body.conductivity > 0.0 { body.external_conductance / area } else { 0.0 };
        [over(part), Air { path, ..far }]
    }

    /// The same at properties with these factors.
    pub(crate) fn at(&self, scales: Scales) -> Air {
        Air { rest: self.within * (1.0 - 1.0 / scales.flux) + self.tuned, ..*self }
    }

    /// Whether there is any flux beyond the constant heat transfer.
    #[inline]
    pub(crate) fn acts(&self) -> bool {
        self.is_cooled() || self.path > 0.0
    }

    /// Whether there is a flux, in proportion to the temperature above the ambient and to nothing that changes from step to step.
    #[inline]
    pub(crate) fn is_linear(&self) -> bool {
        self.acts() && self.forced == 0.0 && self.emissivity == 0.0 && self.path == 0.0
    }

    /// Whether there is a flux that the stages are solved for.
    #[inline]
    pub(crate) fn is_nonlinear(&self) -> bool {
        self.acts() && !self.is_linear()
    }

    /// Whether the air takes more than by the heat transfer within the states.
    #[inline]
    pub(crate) fn is_cooled(&self) -> bool {
        self.forced > 0.0 || self.emissivity > 0.0 || self.within > 0.0 || self.tuned != 0.0
    }

    /// Whether the flux is not linear in the temperature of the face.
    #[inline]
    pub(crate) fn is_curved(&self) -> bool {
        self.emissivity > 0.0
    }

    /// Flux into the face at its temperature `t`; temperatures in K above the reference.
    #[inline]
    pub(crate) fn flux<S: Scalar>(&self, reference: f64, t: S, ambient: S, forced: S, neighbour: S) -> S {
        let flux = self.flux_by_air(reference, t, ambient, forced);
        if self.path > 0.0 { flux + (neighbour - t) * self.path } else { flux }
    }

    /// Part of [`Air::flux`] that comes from the air.
    #[inline]
    pub(crate) fn flux_by_air<S: Scalar>(&self, reference: f64, t: S, ambient: S, forced: S) -> S {
        let mut flux = (ambient - t) * forced * self.forced;
        if self.rest != 0.0 {
            flux = flux + (ambient - t) * self.rest;
        }
        if self.emissivity > 0.0 {
            // Below 0 K, which only an iterate can reach, radiation is 0: the flux then decreases with temperature everywhere, and
            // the slope of [`Air::law`] is its derivative.
            let fourth = |t: S| {
                let absolute = (t + S::from(reference)).positive();
                (absolute * absolute) * (absolute * absolute)
            };
            flux = flux + (fourth(ambient) - fourth(t)) * (STEFAN_BOLTZMANN * self.emissivity);
        }
        flux
    }

    /// [`Air::flux`], and its decrease with the temperature of the face, W/(m2 K), for implicit solutions.
    #[inline]
    pub fn law(&self, reference: f64, t: f64, ambient: f64, forced: f64, neighbour: f64) -> [f64; 2] {
        let mut by_air = forced * self.forced + self.rest;
        if self.emissivity > 0.0 {
            by_air += 4.0 * STEFAN_BOLTZMANN * self.emissivity * (t + reference).max(0.0).powi(3);
        }
        let fall = if self.path > 0.0 { by_air + self.path } else { by_air };
        [self.flux(reference, t, ambient, forced, neighbour), fall]
    }

    /// Heat transfer coefficient, W/(m2 K), at which convection alone gives [`Air::flux_by_air`]: radiation as (a^2 + b^2)(a + b).
    pub(crate) fn transfer<S: Scalar>(&self, reference: f64, t: S, ambient: S, forced: S) -> S {
        let [air_side, face] = [ambient, t].map(|rise| (rise + S::from(reference)).positive());
        let radiation = (air_side * air_side + face * face) * (air_side + face) * (STEFAN_BOLTZMANN * self.emissivity);
        forced * self.forced + S::from(self.rest) + radiation
    }
}

/// Heat transfer coefficient (W/(m2 K)) to the ambient at `speed` (m/s): `convection`, the forced one, and radiation at the ambient temperature.
pub fn transfer(convection: f64, body: &Body, scene: &Scene, speed: f64) -> f64 {
    let radiation = 4.0 * STEFAN_BOLTZMANN * body.emissivity * scene.ambient_temperature.powi(3);
    convection + body.convection_forced * speed.powf(0.8) + radiation
}
