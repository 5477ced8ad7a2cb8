//! Friction law: coefficient as a function of temperature and operating point, and the sign of the velocity.
//!
//! Theory: docs/theory.md, section 2.2.

use crate::friction_curve::FrictionCurve;
use numerics::scalar::Scalar;
use scene::{FadeTable, Scene};
use std::sync::Arc;

/// What the Stribeck factor may depend on, the same for the whole contact.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct OperatingPoint<S = f64> {
    /// Sliding velocity at the mean radius, m/s, signed.
    pub velocity: S,
    /// Mean apparent pressure, Pa, >= 0: carried load over nominal contact area.
    pub pressure: S,
}

/// Stribeck factor: friction coefficient at a velocity over that without dependence on the velocity.
#[derive(Clone, PartialEq, Debug)]
pub enum StribeckFactor {
    /// 1 at every velocity.
    One,
    /// 1 + (r - 1) exp(-|v|/v_s)
    Exponential {
        /// Ratio r of static to kinetic friction.
        static_ratio: f64,
        /// Stribeck velocity v_s, m/s.
        velocity: f64,
    },
    /// Measured coefficients over mu_0 at initialisation; shared, so that a copy of the law allocates nothing.
    Measured(Arc<FrictionCurve>),
}

impl StribeckFactor {
    fn new(scene: &Scene) -> StribeckFactor {
        match &scene.friction_table {
            Some(table) => StribeckFactor::Measured(Arc::new(FrictionCurve::new(table, scene.friction_coefficient))),
            None if scene.static_friction_ratio == 1.0 => StribeckFactor::One,
            None => StribeckFactor::Exponential {
                static_ratio: scene.static_friction_ratio,
                velocity: scene.stribeck_velocity,
            },
        }
    }
}

/// mu(T, v) = mu_0 fade(T) f(v) with the Stribeck factor f, and s = sign(v) or v/sqrt(v^2 + v_reg^2).
#[derive(Clone, PartialEq, Debug)]
pub struct FrictionLaw {
    /// Coefficient before fade and Stribeck effect (tunable).
    pub coefficient: f64,
    /// Fade table over the contact temperature.
    pub fade: FadeTable,
    /// Stribeck factor f.
    pub stribeck_factor: StribeckFactor,
    /// Regularisation velocity v_reg, m/s; 0: exact sign.
    pub regularization_velocity: f64,
}

impl FrictionLaw {
    /// Friction law of a scene.
    pub fn new(scene: &Scene) -> FrictionLaw {
        FrictionLaw {
            coefficient: scene.friction_coefficient,
            fade: scene.friction_fade,
            stribeck_factor: StribeckFactor::new(scene),
            regularization_velocity: scene.regularization_velocity,
        }
    }

    /// Stribeck factor at this operating point; at standstill the ratio of static to kinetic friction.
    #[inline]
    pub fn stribeck<S: Scalar>(&self, operating_point: OperatingPoint<S>) -> S {
        let speed = operating_point.velocity.abs();
        match &self.stribeck_factor {
            StribeckFactor::One => S::from(1.0),
            StribeckFactor::Exponential { static_ratio, velocity } => {
                S::from(1.0) + (speed * (-1.0 / velocity)).exp() * (static_ratio - 1.0)
            }
            StribeckFactor::Measured(curve) => curve.at(speed),
        }
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
