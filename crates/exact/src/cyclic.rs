//! Steady reciprocating sliding on the half-plane.
//!
//! Theory: docs/theory.md, sections 10, 9.2.

use std::f64::consts::PI;

/// Kinematics of the punch holder.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum HolderKind {
    /// Translation only: the pressures differ by the half-plane's own shear coupling.
    Translate {
        /// Poisson's ratio of the half-plane.
        poissons_ratio: f64,
    },
    /// Free to rotate about a pivot at height H. The half-plane's shear coupling then has no effect: its displacement under
    /// the uniform mean pressure is a tilt.
    Rotate {
        /// H/a, pivot height over half-width.
        relative_height: f64,
    },
}

/// Steady pressures of a flat punch that wears (b = 1) in reciprocating sliding on a half-plane:
///
/// ```text
/// p+-/pm = 1 +- sgn (2/pi) arctan[ m x/sqrt(a^2 (1 - m^2) - x^2) ],   0 or 2 beyond a sqrt(1 - m^2)
/// ```
///
/// `m = 2 mu H/a`, sgn = +1 where the punch can rotate; `m = tanh(pi c/4)`, `c = mu (1-2nu)/(1-nu)`, sgn = -1 where it
/// can only translate. p+ belongs to v > 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CyclicHalfPlane {
    /// Parameter m, from 0 to below 1.
    pub m: f64,
    /// Sign of the pressure difference at the +x edge.
    pub sign: f64,
}

impl CyclicHalfPlane {
    /// Solution for a friction coefficient and a holder; `None` where no steady cycle exists because wear increases the
    /// tilt without bound (m >= 1).
    pub fn new(friction: f64, holder: HolderKind) -> Option<Self> {
        let (m, sign) = match holder {
            HolderKind::Translate { poissons_ratio } => {
                let c = friction * (1.0 - 2.0 * poissons_ratio) / (1.0 - poissons_ratio);
                ((PI * c / 4.0).tanh(), -1.0)
            }
            HolderKind::Rotate { relative_height } => (2.0 * friction * relative_height, 1.0),
        };
        (m < 1.0).then_some(Self { m, sign })
    }

    /// Half-width, in units of a, within which both pressures are positive.
    pub fn inner_half_width(&self) -> f64 {
        (1.0 - self.m * self.m).sqrt()
    }

    /// Width of each clipped edge, in units of a.
    #[cfg(test)]
    fn clipped_width(&self) -> f64 {
        1.0 - self.inner_half_width()
    }

    /// `p+/pm` at x in units of a; `p-` is 2 less that.
    #[cfg(test)]
    fn forward_pressure(&self, x: f64) -> f64 {
        let root = (1.0 - self.m * self.m - x * x).max(0.0).sqrt();
        if self.m == 0.0 { 1.0 } else { 1.0 + self.sign * 2.0 / PI * (self.m * x).atan2(root) }
    }

    /// Primitive of `p+/pm`, x in units of a.
    pub fn forward_primitive(&self, x: f64) -> f64 {
        if self.m == 0.0 {
            return x;
        }
        let root = (1.0 - self.m * self.m - x * x).max(0.0).sqrt();
        x + self.sign * 2.0 / PI * (x * (self.m * x).atan2(root) + root.atan2(self.m))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn published_values() {
        let rotating = CyclicHalfPlane::new(0.25, HolderKind::Rotate { relative_height: 1.0 }).unwrap();
        assert_eq!((rotating.m, rotating.sign), (0.5, 1.0));
        assert!((rotating.clipped_width() - 0.13397).abs() < 5e-6);
        assert!((rotating.forward_pressure(0.5) - 1.21635).abs() < 5e-6);
        assert!((rotating.forward_pressure(0.8) - 1.55929).abs() < 5e-6);
        let held = CyclicHalfPlane::new(0.25, HolderKind::Translate { poissons_ratio: 0.3 }).unwrap();
        assert!((held.m - 0.11173).abs() < 5e-6);
        assert!((held.clipped_width() - 0.00626).abs() < 5e-6);
        assert!((held.forward_pressure(0.8) - 0.90420).abs() < 5e-6);
    }

    #[test]
    fn rocking_has_no_steady_state() {
        assert_eq!(CyclicHalfPlane::new(0.5, HolderKind::Rotate { relative_height: 1.0 }), None);
    }
}
