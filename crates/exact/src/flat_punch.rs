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

    impl FlatPunch {
        /// Pressure at |x| < a, in Pa.
        fn pressure(&self, x: f64) -> f64 {
            let (a, e) = (self.half_width, self.signed_exponent);
            self.load * (PI * e).cos() / (PI * (a * a - x * x).sqrt()) * ((a + x) / (a - x)).powf(-e)
        }
    }

    #[test]
    fn published_exponent() {
        assert!((friction_exponent(0.5, 0.3) - 0.045167).abs() < 5e-7);
    }

    #[test]
    fn carried_load_is_the_integral_and_its_centre_the_eccentricity() {
        let punch = FlatPunch { load: 2.0, half_width: 0.5, signed_exponent: 0.045167 };
        let n = 20_000;
        let edge = |i: usize| -0.5 * (PI * i as f64 / n as f64).cos();
        let centre: f64 = (0..n)
            .map(|i| (punch.carried(edge(i + 1)) - punch.carried(edge(i))) * 0.5 * (edge(i) + edge(i + 1)))
            .sum::<f64>()
            / 2.0;
        assert!((centre - punch.eccentricity()).abs() < 1e-8, "{centre}");
        assert!(punch.eccentricity() < 0.0);
        let slope = (punch.carried(0.2 + 1e-6) - punch.carried(0.2 - 1e-6)) / 2e-6;
        assert!((slope - punch.pressure(0.2)).abs() < 1e-7);
    }

    #[test]
    fn surface_under_the_sliding_punch_is_flat() {
        // Slope of the half-plane: -(2/(pi E*)) PV integral p/(x-s) ds + mu (1-2nu)/(2G) p = 0, that is
        // PV integral p/(x-s) ds = pi tan(pi eta) p. Checked with s = cos-like substitution on both sides of x.
        let eta = friction_exponent(0.9, 0.1);
        let punch = FlatPunch { load: 1.0, half_width: 1.0, signed_exponent: eta };
        let x = 0.35;
        // Integrate by parts with the carried load: PV integral p/(x-s) = integral (p(s) - p(x) ...) on fine cells.
        let n = 400_000;
        let edge = |i: i32| -(PI * f64::from(i) / f64::from(n)).cos();
        let mut value = 0.0;
        for i in 0..n {
            let (l, r) = (edge(i), edge(i + 1));
            let middle = 0.5 * (l + r);
            if (middle - x).abs() > 0.1 {
                value += (punch.carried(r) - punch.carried(l)) / (x - middle);
            }
        }
        let m = 20_000;
        for i in 0..m {
            let t = 0.1 * (f64::from(i) + 0.5) / f64::from(m);
            value += (punch.pressure(x - t) - punch.pressure(x + t)) / t * 0.1 / f64::from(m);
        }
        assert!((value - PI * (PI * eta).tan() * punch.pressure(x)).abs() < 1e-4, "{value}");
    }
}
