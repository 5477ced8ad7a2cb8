//! Two half-spaces in contact through a conductance, heated by friction at constant speed: closed form, and the component's
//! line level.
//!
//! Theory: docs/theory.md, section 2.4.

use crate::Fallible;
use crate::driver::Driven;
use exact::reference::integral_from_singularity;
use std::f64::consts::PI;

/// Conductivity and heat capacity of the strip: grey cast iron.
const CONDUCTIVITY: f64 = 54.0;
const DENSITY: f64 = 7200.0;
const SPECIFIC_HEAT: f64 = 460.0;

/// Two half-spaces of equal heat capacity per volume.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) struct HalfSpaces {
    /// Conductivity of the punch over that of the strip.
    pub ratio: f64,
    /// Contact conductance, W/(m2 K).
    pub conductance: f64,
}

/// exp(x^2) erfc(x) for x >= 0.
fn scaled_complementary_error(x: f64) -> f64 {
    2.0 / PI.sqrt() * integral_from_singularity(9.0, |t| (-t * t - 2.0 * x * t).exp())
}

impl HalfSpaces {
    /// Fraction of the friction heat that is in the punch after `time` (s).
    ///
    /// With the effusivities e, `E = e1 e2/(e1 + e2)` and `k = h_c/E` the flux into the punch is
    /// `Q [e1/(e1+e2) + (e2-e1)/(2 (e1+e2)) exp(k^2 t) erfc(k sqrt t)]`: half of the heat initially, the fraction of the
    /// effusivities finally.
    pub(crate) fn share(&self, time: f64) -> f64 {
        if self.conductance == 0.0 {
            return 0.5;
        }
        let strip = (CONDUCTIVITY * DENSITY * SPECIFIC_HEAT).sqrt();
        let punch = strip * self.ratio.sqrt();
        let part = punch / (punch + strip);
        if punch == 0.0 {
            return 0.0;
        }
        let rate = self.conductance * (1.0 / punch + 1.0 / strip);
        let x = rate * time.sqrt();
        // Mean over time of exp(k^2 t) erfc(k sqrt t), x = k sqrt t.
        let mean = if x < 1e-3 {
            1.0 - 4.0 * x / (3.0 * PI.sqrt())
        } else {
            (scaled_complementary_error(x) - 1.0 + 2.0 * x / PI.sqrt()) / (x * x)
        };
        part + 0.5 * (1.0 - 2.0 * part) * mean
    }

    /// The same fraction by the component at its line level, after `count` communication steps of `step` (s), and the
    /// imbalance of the heat. The thermal expansion, which selects resolved heat, is too small to affect the contact.
    pub(crate) fn stepped(&self, step: f64, count: u32) -> Fallible<(f64, f64)> {
        let duration = step * f64::from(count);
        // Deep enough that no heat returns, and no deeper, so that both bodies are resolved near the contact.
        let depth = |ratio: f64| {
            let diffusivity = ratio * CONDUCTIVITY / (DENSITY * SPECIFIC_HEAT);
            (12.0 * (diffusivity * duration).sqrt()).clamp(1e-6, 10.0)
        };
        let changes = [
            ("solver.fidelity", 3.0),
            ("solver.cells", 3.0),
            ("solver.tolerance", 1e-3),
            ("contact.geometry", 3.0),
            ("contact.faces", 1.0),
            ("contact.friction_coefficient", 0.5),
            ("contact.conductance", self.conductance),
            ("strip.path", 2.0),
            ("strip.length", depth(1.0)),
            ("punch.width", depth(1.0)),
            ("depth", 0.1),
            ("punch.body", 3.0),
            ("strip.body", 3.0),
            ("punch.height", depth(self.ratio.max(1e-9))),
            ("strip.height", depth(1.0)),
            ("punch.conductivity", self.ratio * CONDUCTIVITY),
            ("strip.conductivity", CONDUCTIVITY),
            ("punch.density", DENSITY),
            ("strip.density", DENSITY),
            ("punch.specific_heat", SPECIFIC_HEAT),
            ("strip.specific_heat", SPECIFIC_HEAT),
            ("punch.thermal_expansion", 1e-30),
            ("strip.thermal_expansion", 1e-30),
            ("punch.convection", 0.0),
            ("strip.convection", 0.0),
            ("strip.convection_forced", 0.0),
            ("punch.top_thermal", 3.0),
            ("strip.base_thermal", 3.0),
            ("punch.wear_coefficient", 0.0),
            ("strip.wear_coefficient", 0.0),
            ("nominal.load", 1e3),
            ("nominal.velocity", 1.0),
            ("nominal.duration", duration),
        ];
        let mut driven = Driven::new(&changes)?;
        driven.set("normal_load", 1e3)?;
        driven.set("sliding_velocity", 1.0)?;
        driven.steps(step, count)?;
        let work = driven.get("dissipated_energy")?;
        let (punch, strip) = (driven.get("heat_received_punch")?, driven.get("heat_received_strip")?);
        Ok((punch / work, ((punch + strip) / work - 1.0).abs()))
    }
}
