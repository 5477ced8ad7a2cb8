//! Friction law: coefficient as a function of temperature and velocity, and the sign of the velocity.
//!
//! Theory: docs/theory.md, section 2.2.

use numerics::scalar::Scalar;
use scene::{FadeTable, Scene};

/// mu(T, v) = mu_0 fade(T) [1 + (r - 1) exp(-|v|/v_s)], and s = sign(v) or v/sqrt(v^2 + v_reg^2).
#[derive(Clone, PartialEq, Debug)]
pub struct FrictionLaw {
    /// Coefficient before fade and Stribeck effect (tunable).
    pub coefficient: f64,
    /// Fade table over the contact temperature.
    pub fade: FadeTable,
    /// Ratio r of static to kinetic friction.
    pub static_ratio: f64,
    /// Stribeck velocity v_s, m/s.
    pub stribeck_velocity: f64,
    /// Regularisation velocity v_reg, m/s; 0: exact sign.
    pub regularization_velocity: f64,
}

impl FrictionLaw {
    /// Friction law of a scene.
    pub fn new(scene: &Scene) -> FrictionLaw {
        FrictionLaw {
            coefficient: scene.friction_coefficient,
            fade: scene.friction_fade,
            static_ratio: scene.static_friction_ratio,
            stribeck_velocity: scene.stribeck_velocity,
            regularization_velocity: scene.regularization_velocity,
        }
    }

    /// Stribeck factor at the velocity `v` (m/s).
    #[inline]
    pub fn stribeck<S: Scalar>(&self, v: S) -> S {
        if self.static_ratio == 1.0 {
            return S::from(1.0);
        }
        S::from(1.0) + (v.abs() * (-1.0 / self.stribeck_velocity)).exp() * (self.static_ratio - 1.0)
    }

    /// s: sign of the velocity, regularised if the law has a regularisation velocity; 0 at v = 0.
    #[inline]
    pub fn sign<S: Scalar>(&self, v: S) -> S {
        let regularization = self.regularization_velocity;
        if regularization == 0.0 {
            return S::from(if v.value() == 0.0 { 0.0 } else { v.value().signum() });
        }
        v / (v * v + S::from(regularization * regularization)).sqrt()
    }

    /// Kinetic friction coefficient at temperature, mu_0 fade(T), at `t` (K): without the Stribeck factor, as in the wear law.
    #[inline]
    pub fn kinetic_coefficient<S: Scalar>(&self, t: S) -> S {
        if self.fade.flat {
            return S::from(self.coefficient * self.fade.factor[0]);
        }
        let (factor, slope) = self.fade.at(t.value());
        (S::from(factor) + (t - S::from(t.value())) * slope) * self.coefficient
    }
}
