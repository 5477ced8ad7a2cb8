//! Flat rigid punch on the half-plane, at rest and sliding.
//!
//! Theory: docs/theory.md, section 10.

use super::special::incomplete_beta_half;
use std::f64::consts::PI;

/// Exponent eta of a sliding contact, `tan(pi eta) = mu (1-2nu)/(2 (1-nu))`.
pub fn friction_exponent(friction: f64, poissons_ratio: f64) -> f64 {
    (friction * (1.0 - 2.0 * poissons_ratio) / (2.0 * (1.0 - poissons_ratio))).atan() / PI
}

/// Flat rigid punch without tilt, with the load P per depth:
/// `p = P cos(pi eta)/(pi sqrt(a^2 - x^2)) ((a + x)/(a - x))^(-s eta)`.
///
/// Friction loads the trailing edge; the resultant acts at `x = -2 s eta a`. Source: K. L. Johnson, Contact Mechanics,
/// section 2.8.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlatPunch {
    /// Load per depth P, in N/m.
    pub load: f64,
    /// Half-width a, in m.
    pub half_width: f64,
    /// `s eta`: signed exponent, 0 without friction, see [`friction_exponent`].
    pub signed_exponent: f64,
}

impl FlatPunch {
    /// Load per depth carried by the part of the contact left of x.
    pub fn carried(&self, x: f64) -> f64 {
        self.load * incomplete_beta_half(self.signed_exponent, 0.5 * (1.0 + x / self.half_width))
    }

    /// Point of action of the resultant, in m.
    pub fn eccentricity(&self) -> f64 {
        -2.0 * self.signed_exponent * self.half_width
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn published_exponent() {
        assert!((friction_exponent(0.5, 0.3) - 0.045167).abs() < 5e-7);
    }
}
