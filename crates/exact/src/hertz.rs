//! Hertz line contact.
//!
//! Theory: docs/theory.md, section 10.

use std::f64::consts::PI;

/// Parabolic punch (cylinder) of radius R pressed on a half-plane with the load P per depth:
/// `p = 2 P/(pi a^2) sqrt(a^2 - x^2)`, `a = sqrt(4 P R/(pi E*))`.
///
/// Source: K. L. Johnson, Contact Mechanics, section 4.2(c).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HertzLine {
    /// Load per depth P, in N/m.
    pub load: f64,
    /// Half-width a of the contact, in m.
    pub half_width: f64,
}

impl HertzLine {
    /// Solution for a load per depth, a radius and the plane strain modulus `E*` of the pair.
    pub fn new(load: f64, radius: f64, plane_strain_modulus: f64) -> Self {
        Self { load, half_width: (4.0 * load * radius / (PI * plane_strain_modulus)).sqrt() }
    }

    /// Pressure at x, in Pa; 0 outside the contact.
    pub fn pressure(&self, x: f64) -> f64 {
        let a = self.half_width;
        2.0 * self.load / (PI * a * a) * (a * a - x * x).max(0.0).sqrt()
    }

    /// Load per depth carried by the part of the contact left of x.
    pub fn carried(&self, x: f64) -> f64 {
        let y = (x / self.half_width).clamp(-1.0, 1.0);
        self.load * (0.5 + (y * (1.0 - y * y).sqrt() + y.asin()) / PI)
    }
}
