//! Mean compliance of a body under uniform pressure, for the lumped level.
//!
//! Theory: docs/theory.md, section 3.7.

use scene::{Body, MechanicalBody};
use std::f64::consts::PI;

/// Mean normal displacement per uniform pressure over the contact width, m/Pa, and mean displacement out of the body per
/// kelvin of uniform temperature, m/K.
///
/// Winkler: 1/k_w, by default h/(lambda + 2G). Elastic block (sides free): h (1 - nu^2)/E. Elastic layer (`wide`: much
/// longer than the contact): between h/(lambda + 2G) for thin layers and the half-plane for thick ones: the smaller
/// compliance of both limits. Half-plane: the approach is defined up to a constant; with the logarithm scaled with the
/// contact width the mean over a uniform pressure p on the width W is 3 p W/(pi E*). Expansion: alpha (1 + nu) h for a block
/// free at its sides, alpha (1 + nu)/(1 - nu) h for a layer.
pub fn mean_compliance(body: &Body, width: f64, wide: bool) -> (f64, f64) {
    let (e, nu, h) = (body.youngs_modulus, body.poissons_ratio, body.height);
    let plane = e / (1.0 - nu * nu);
    let confined = h * (1.0 + nu) * (1.0 - 2.0 * nu) / (e * (1.0 - nu));
    let half_plane = 3.0 * width / (PI * plane);
    let expansion = body.thermal_expansion * (1.0 + nu) * h / if wide { 1.0 - nu } else { 1.0 };
    let compliance = match body.mechanical {
        MechanicalBody::Rigid => 0.0,
        MechanicalBody::Winkler if body.foundation_stiffness > 0.0 => 1.0 / body.foundation_stiffness,
        MechanicalBody::Winkler => confined,
        MechanicalBody::HalfPlane => half_plane,
        MechanicalBody::Elastic if wide => confined.min(half_plane),
        MechanicalBody::Elastic => h / plane,
    };
    (compliance, expansion)
}
