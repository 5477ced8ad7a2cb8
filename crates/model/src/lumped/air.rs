//! Cooled faces of a body: forced convection and radiation beyond the constant heat transfer, and the heat path to a neighbour.
//!
//! A constant heat transfer coefficient H0 is within the states of the reduced body. Where the conductivity K of the body follows its
//! temperature, it acts there as H0 K/K0. The rest of the coefficient H that acts, `H - H0 K/K0`, is a flux like the forced part; H
//! differs from H0 where it has been tuned since the initialisation.
//!
//! Theory: docs/theory.md, section 4.11.

pub(crate) use conduction::line::{BESIDE, FACES, FAR};
use conduction::properties::Scales;
use conduction::reduced::Port;
use scene::{Body, ThermalBoundary};

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
    pub(crate) fn of(body: &Body, within: f64, part: f64, area: f64) -> [Air; FACES] {
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
}
