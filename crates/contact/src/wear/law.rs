//! Wear law of one body, eq. (1) of Paczelt and Mroz (2015), normalised so that units do not depend on the exponents:
//!
//! ```text
//! dw/dt = k p0 v0 (p/p0)^b (|v|/v0)^a (mu/mu_ref)^b fade(T),      p0 = 1 MPa, v0 = 1 m/s; 0 where v = 0
//! ```
//!
//! k in m2/N: worn depth per pressure and sliding distance for a = b = 1. mu is the friction coefficient
//! without its Stribeck factor: the driver is the shear traction mu p.
//!
//! Theory: docs/theory.md, section 2.3.

use numerics::scalar::Scalar;
use scene::{Body, FadeTable};

/// Reference pressure p0, Pa.
pub const REFERENCE_PRESSURE: f64 = 1e6;
/// Reference velocity v0, m/s.
pub const REFERENCE_VELOCITY: f64 = 1.0;

/// Wear law of one body; equation in the module documentation.
#[derive(Clone, PartialEq, Debug)]
pub struct WearLaw {
    /// Wear coefficient k, m2/N.
    pub coefficient: f64,
    /// Pressure exponent b.
    pub pressure_exponent: f64,
    /// Velocity exponent a.
    pub velocity_exponent: f64,
    /// Factor over the contact temperature.
    pub fade: FadeTable,
    /// Friction coefficient mu_ref at which k is given.
    pub reference_friction: f64,
    /// a = b = 1 and a constant fade factor.
    plain: bool,
    /// k times the fade factor where that is constant: the rate is this times p v for a = b = 1.
    archard: f64,
    /// k times the largest factors of both tables over temperature.
    highest_coefficient: f64,
}

impl WearLaw {
    /// Wear law of `body`, with the friction coefficient at which its k was given.
    pub fn new(body: &Body, reference_friction: f64, friction_fade: &FadeTable) -> WearLaw {
        let largest = |table: &FadeTable| table.factor.iter().copied().fold(0.0, f64::max);
        WearLaw {
            coefficient: body.wear_coefficient,
            pressure_exponent: body.wear_pressure_exponent,
            velocity_exponent: body.wear_velocity_exponent,
            fade: body.wear_fade,
            reference_friction,
            plain: body.wear_pressure_exponent == 1.0 && body.wear_velocity_exponent == 1.0 && body.wear_fade.flat,
            archard: body.wear_coefficient * body.wear_fade.factor[0],
            highest_coefficient: body.wear_coefficient
                * largest(&body.wear_fade)
                * largest(friction_fade).max(1.0).powf(body.wear_pressure_exponent),
        }
    }

    /// Whether the body wears at all.
    pub fn active(&self) -> bool {
        self.coefficient > 0.0
    }

    /// Whether the rate is the coefficient times pressure and speed at all of these friction coefficients.
    #[inline]
    pub fn is_archard(&self, friction: [f64; 2]) -> bool {
        self.plain && friction == [self.reference_friction; 2]
    }

    /// Whether the rate depends on the temperature, through its own table or through mu.
    pub fn follows_temperature(&self, friction_fades: bool) -> bool {
        !self.fade.flat || friction_fades
    }

    /// Upper bound of the depth rate (m/s) over all temperatures, at pressure `p` (Pa), speed `v` (m/s) and friction coefficient
    /// `friction` at the reference temperature.
    pub fn highest_rate(&self, p: f64, v: f64, friction: f64) -> f64 {
        let p = if self.reference_friction > 0.0 { p * friction / self.reference_friction } else { p };
        if self.pressure_exponent == 1.0 && self.velocity_exponent == 1.0 {
            return self.highest_coefficient * p * v;
        }
        self.highest_coefficient
            * REFERENCE_PRESSURE
            * REFERENCE_VELOCITY
            * (p / REFERENCE_PRESSURE).powf(self.pressure_exponent)
            * (v / REFERENCE_VELOCITY).powf(self.velocity_exponent)
    }

    /// Depth rate dw/dt (m/s) at pressure `p` (Pa, >= 0), speed `v` = |v| (m/s), friction coefficient
    /// without Stribeck factor `mu` and contact temperature `t` (K).
    #[inline]
    pub fn rate<S: Scalar>(&self, p: S, v: S, mu: S, t: S) -> S {
        if p.value() <= 0.0 || v.value() == 0.0 {
            return S::from(0.0);
        }
        if self.plain && mu.value() == self.reference_friction {
            return p * v * self.archard;
        }
        self.general_rate(p, v, mu, t)
    }

    #[inline(never)]
    fn general_rate<S: Scalar>(&self, p: S, v: S, mu: S, t: S) -> S {
        if self.coefficient == 0.0 {
            return S::from(0.0);
        }
        let pressure = p * (1.0 / REFERENCE_PRESSURE);
        let speed = v * (1.0 / REFERENCE_VELOCITY);
        let mut driver = pressure;
        if mu.value() != self.reference_friction && self.reference_friction > 0.0 {
            driver = driver * mu * (1.0 / self.reference_friction);
        }
        let driver = if self.pressure_exponent == 1.0 { driver } else { driver.powf(self.pressure_exponent) };
        let speed = if self.velocity_exponent == 1.0 { speed } else { speed.powf(self.velocity_exponent) };
        let rate = driver * speed * (self.coefficient * REFERENCE_PRESSURE * REFERENCE_VELOCITY);
        if self.fade.flat {
            return rate * self.fade.factor[0];
        }
        let (factor, slope) = self.fade.at(t.value());
        rate * (S::from(factor) + (t - S::from(t.value())) * slope)
    }
}
