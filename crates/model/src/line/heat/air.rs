//! Cooling of the faces of a body beyond their constant heat transfer: forced convection and radiation.
//!
//! Theory: docs/theory.md, section 4.11.

use conduction::STEFAN_BOLTZMANN;
use scene::{Body, Scene};

/// Flux (W/m2 of cooled area) into a face of the temperature `t` by forced convection and radiation, and its decrease with t;
/// temperatures in K above the reference. `forced` is (v_c/v_0)^0.8.
pub fn cooling(body: &Body, reference: f64, t: f64, ambient: f64, forced: f64) -> [f64; 2] {
    // Below 0 K, which only an iterate can reach, radiation is 0; NaN stays NaN.
    let absolute = t + reference;
    let (hot, air) = (if absolute < 0.0 { 0.0 } else { absolute }, ambient + reference);
    let (moving, radiation) = (forced * body.convection_forced, STEFAN_BOLTZMANN * body.emissivity);
    [(ambient - t) * moving + radiation * (air.powi(4) - hot.powi(4)), moving + 4.0 * radiation * hot.powi(3)]
}

/// Heat transfer coefficient (W/(m2 K)) to the ambient at `speed` (m/s): `convection`, the forced one, and radiation at the ambient temperature.
pub fn transfer(convection: f64, body: &Body, scene: &Scene, speed: f64) -> f64 {
    let radiation = 4.0 * STEFAN_BOLTZMANN * body.emissivity * scene.ambient_temperature.powi(3);
    convection + body.convection_forced * speed.powf(0.8) + radiation
}
