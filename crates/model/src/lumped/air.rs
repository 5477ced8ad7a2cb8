//! Cooled faces of a body: forced convection and radiation beyond the constant heat transfer.
//!
//! Theory: docs/theory.md, section 4.11.

pub use conduction::line::{BESIDE, FACES, FAR};
use conduction::reduced::Port;
use scene::{Body, ThermalBoundary};

/// Ports of the heat fluxes through the faces.
pub const PORTS_OF_FACES: [usize; FACES] = [Port::Cooling as usize, Port::Base as usize];

/// Forced convection and radiation of one face: the flux into it at the temperature T is
/// `forced (v_c/v_0)^0.8 (T_ambient - T) + emissivity sigma (T_ambient^4 - T^4)`.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct Air {
    /// Forced heat transfer coefficient at 1 m/s per reference area, W/(m2 K).
    pub forced: f64,
    /// Emissivity per reference area.
    pub emissivity: f64,
}

impl Air {
    /// Cooling of the faces of `body`; the free surface beside the contact is `part` of the reference area.
    pub fn of(body: &Body, part: f64) -> [Air; FACES] {
        let over = |part: f64| match body.conductivity > 0.0 && part > 0.0 {
            true => Air { forced: body.convection_forced * part, emissivity: body.emissivity * part },
            false => Air::default(),
        };
        [over(part), over(if body.far_thermal == ThermalBoundary::Convecting { 1.0 } else { 0.0 })]
    }

    /// Whether there is any cooling beyond the constant heat transfer.
    #[inline]
    pub fn acts(&self) -> bool {
        self.forced > 0.0 || self.emissivity > 0.0
    }
}
