//! Wear law of one body, eq. (1) of Paczelt and Mroz (2015), normalised so that units do not depend on the exponents:
//!
//! ```text
//! dw/dt = c(v, mu, T) f(p/p0)
//! f(z)  = (z - z0)^b above z0 = p_th/p0, else 0
//! c     = k p0 v0 (|v|/v0)^a (mu/mu_ref)^b fade(T)      p0 = 1 MPa, v0 = 1 m/s; 0 where v = 0
//! ```
//!
//! k in m2/N: worn depth per pressure and sliding distance for a = b = 1 and p_th = 0. mu is the friction coefficient
//! without its Stribeck factor: the driver is the shear traction mu (p - p_th).
//!
//! p_th is a pressure up to which a polymer or a coating does not wear: its asperities carry it elastically. Of a higher
//! pressure the part p - p_th is carried by asperities that are loaded beyond their limit, and wears as all of p does
//! without one. So f is continuous at p_th. A law that jumps there, p^b above p_th, has pressures without a rate that is
//! determined, and a stage of the line no solution where a cell is at p_th.
//!
//! No other file knows f: lumped level, contact line, cycles and steady states ask [`PressureLaw`] for rate, slope and
//! inverse. The line needs the product of c, per stage or cell, and f, per pressure. What holds for powers alone asks
//! [`PressureLaw::as_power`].
//!
//! Theory: docs/theory.md, section 2.3.

use numerics::scalar::Scalar;
use scene::{Body, FadeTable};

/// Reference pressure p0, Pa.
pub(super) const REFERENCE_PRESSURE: f64 = 1e6;
/// Reference velocity v0, m/s.
const REFERENCE_VELOCITY: f64 = 1.0;

/// Factor f of the wear rate by the pressure z, relative to p0: nowhere decreasing. A coefficient c >= 0 multiplies it.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct PressureLaw {
    /// Exponent b > 0.
    exponent: f64,
    /// z0 >= 0, up to which nothing wears.
    threshold: f64,
}

impl PressureLaw {
    /// The power `z^b`, b > 0.
    pub fn power(exponent: f64) -> PressureLaw {
        PressureLaw { exponent, threshold: 0.0 }
    }

    /// The same law of what z is above `threshold`, >= 0.
    pub(crate) fn above(self, threshold: f64) -> PressureLaw {
        PressureLaw { threshold, ..self }
    }

    /// Base of the power.
    #[inline]
    fn excess(&self, z: f64) -> f64 {
        if z < self.threshold { 0.0 } else { z - self.threshold }
    }

    /// Exponent b of a power: rates at proportional pressures are proportional.
    ///
    /// # Errors
    /// Name of the parameter of a body by which the law is not a power.
    pub fn as_power(&self) -> Result<f64, &'static str> {
        if self.threshold > 0.0 { Err("wear_threshold") } else { Ok(self.exponent) }
    }

    /// Whether f is proportional to z.
    pub(crate) fn is_linear(&self) -> bool {
        self.exponent == 1.0 && self.threshold == 0.0
    }

    /// Whether f has an infinite slope where wear begins, and is concave from there.
    pub(super) fn is_concave(&self) -> bool {
        self.exponent < 1.0
    }

    /// Depth rate `c f(z)`.
    #[inline]
    pub(crate) fn rate(&self, coefficient: f64, z: f64) -> f64 {
        coefficient * power(self.excess(z), self.exponent)
    }

    /// Its slope `c f'(z)`; infinite for b < 1 where wear begins.
    #[inline]
    pub(crate) fn slope(&self, coefficient: f64, z: f64) -> f64 {
        if z < self.threshold {
            return 0.0;
        }
        coefficient * self.exponent * power(z - self.threshold, self.exponent - 1.0)
    }

    /// `z f'(z)/f(z)`: relative change of the rate with that of the pressure; 0 where nothing wears.
    #[inline]
    pub(crate) fn logarithmic_slope(&self, z: f64) -> f64 {
        if z > self.threshold { self.exponent * (z / (z - self.threshold)) } else { 0.0 }
    }

    /// Inverse of a sum of laws with an elastic part: z at which `e z + sum c_i f_i(z) = target`, e >= 0, all c_i > 0, to
    /// rounding; 0 for a target <= 0, infinite where nothing depends on z.
    ///
    /// Newton's method in `y = (z - z0)^beta`, z0 the largest threshold below the root, beta the smallest exponent, at most 1
    /// with an elastic part or thresholds. The sum is then convex and increasing, and the iterates fall monotonically to the
    /// root from a point above.
    pub(super) fn inverse(terms: impl Iterator<Item = (f64, PressureLaw)> + Clone, elastic: f64, target: f64) -> f64 {
        if target <= 0.0 {
            return 0.0;
        }
        let is_below = |z: f64| {
            elastic * z + terms.clone().map(|(coefficient, law)| law.rate(coefficient, z)).sum::<f64>() < target
        };
        let start = terms.clone().map(|(_, law)| law.threshold).filter(|&z| is_below(z)).fold(0.0, f64::max);
        let terms = terms.clone().filter(|(_, law)| law.threshold <= start);
        let target = target - elastic * start;
        let most = if elastic > 0.0 || start > 0.0 { 1.0 } else { f64::INFINITY };
        let beta = terms.clone().map(|(_, law)| law.exponent).fold(most, f64::min);
        let mut y = power(target / elastic, beta);
        for (coefficient, law) in terms.clone() {
            y = y.min(power(target / coefficient, beta / law.exponent));
        }
        if !y.is_finite() {
            return f64::INFINITY;
        }
        for _ in 0..60 {
            let z = power(y, 1.0 / beta);
            let (mut value, mut slope) = (elastic * z - target, elastic * z / (beta * y));
            for (coefficient, law) in terms.clone() {
                let (part, relative) = if law.threshold == start {
                    (coefficient * power(y, law.exponent / beta), 1.0)
                } else {
                    let excess = z + (start - law.threshold);
                    (coefficient * power(excess, law.exponent), z / excess)
                };
                value += part;
                slope += relative * part * law.exponent / (beta * y);
            }
            let next = y - value / slope;
            if next >= y * (1.0 - 4.0 * f64::EPSILON) {
                break;
            }
            y = next;
        }
        start + power(y, 1.0 / beta)
    }
}

/// `base^exponent`, base >= 0, by a root or a product where one suffices instead of the general power.
#[inline]
fn power(base: f64, exponent: f64) -> f64 {
    if exponent == 1.0 {
        base
    } else if exponent == 0.0 {
        1.0
    } else if exponent == 0.5 {
        base.sqrt()
    } else if exponent == 2.0 {
        base * base
    } else {
        base.powf(exponent)
    }
}

/// Wear law of one body; equation in the module documentation.
#[derive(Clone, PartialEq, Debug)]
pub struct WearLaw {
    /// Wear coefficient k, m2/N.
    wear_coefficient: f64,
    /// Factor f of the pressure.
    pub pressure: PressureLaw,
    /// Velocity exponent a.
    velocity_exponent: f64,
    /// Factor over the contact temperature.
    pub fade: FadeTable,
    /// Friction coefficient mu_ref at which k is given.
    pub reference_friction: f64,
    /// a = b = 1 without threshold, and a constant fade factor.
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
        let pressure = PressureLaw::power(body.wear_pressure_exponent).above(body.wear_threshold / REFERENCE_PRESSURE);
        WearLaw {
            wear_coefficient: body.wear_coefficient,
            pressure,
            velocity_exponent: body.wear_velocity_exponent,
            fade: body.wear_fade,
            reference_friction,
            plain: pressure.is_linear() && body.wear_velocity_exponent == 1.0 && body.wear_fade.flat,
            archard: body.wear_coefficient * body.wear_fade.factor[0],
            highest_coefficient: body.wear_coefficient
                * largest(&body.wear_fade)
                * largest(friction_fade).max(1.0).powf(body.wear_pressure_exponent),
        }
    }

    /// Whether the body wears at all.
    pub fn active(&self) -> bool {
        self.wear_coefficient > 0.0
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

    /// Relative change of the rate with that of the pressure `p` (Pa), `p/f df/dp`: b for a power.
    #[inline]
    pub fn logarithmic_slope(&self, p: f64) -> f64 {
        self.pressure.logarithmic_slope(p / REFERENCE_PRESSURE)
    }

    /// `c f(p/p0)` at the pressure `p` (Pa).
    #[inline]
    pub fn rate_of(&self, coefficient: f64, p: f64) -> f64 {
        self.pressure.rate(coefficient, p / REFERENCE_PRESSURE)
    }

    /// Pressure, Pa, hardly above that at which wear begins: stands for lower ones where the ratio of two rates is needed.
    pub fn least_wearing_pressure(&self) -> f64 {
        (self.pressure.threshold + 1e-3) * REFERENCE_PRESSURE
    }

    /// Factor of the rate at this radius over the mean radius, by the speed there.
    pub fn by_radius(&self, ratio: f64) -> f64 {
        ratio.powf(self.velocity_exponent)
    }

    /// Mean of [`Self::by_radius`] over a ring between the radii `1 - half` and `1 + half`, by area.
    pub fn annular_mean(&self, half: f64) -> f64 {
        let power = 1.0 + self.velocity_exponent;
        let (outer, inner) = (1.0 + half, 1.0 - half);
        (outer.powf(power + 1.0) - inner.powf(power + 1.0)) / ((power + 1.0) * 2.0 * half)
    }

    /// Upper bound of the depth rate (m/s) over all temperatures and thresholds, at pressure `p` (Pa), speed `v` (m/s) and
    /// friction coefficient `friction` at the reference temperature.
    pub fn highest_rate(&self, p: f64, v: f64, friction: f64) -> f64 {
        let p = if self.reference_friction > 0.0 { p * friction / self.reference_friction } else { p };
        if self.pressure.exponent == 1.0 && self.velocity_exponent == 1.0 {
            return self.highest_coefficient * p * v;
        }
        self.highest_coefficient
            * REFERENCE_PRESSURE
            * REFERENCE_VELOCITY
            * (p / REFERENCE_PRESSURE).powf(self.pressure.exponent)
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
        let excess = p * (1.0 / REFERENCE_PRESSURE) - S::from(self.pressure.threshold);
        if excess.value() <= 0.0 {
            return S::from(0.0);
        }
        self.general_rate(excess, v, mu, t)
    }

    /// Coefficient c (m/s) of f in the depth rate; arguments as those of [`Self::rate`].
    #[inline]
    pub fn coefficient<S: Scalar>(&self, v: S, mu: S, t: S) -> S {
        if v.value() == 0.0 {
            return S::from(0.0);
        }
        if self.plain && mu.value() == self.reference_friction {
            return S::from(REFERENCE_PRESSURE) * v * self.archard;
        }
        self.general_rate(S::from(1.0), v, mu, t)
    }

    /// [`Self::rate`] at the base `base` of the power f.
    #[inline(never)]
    fn general_rate<S: Scalar>(&self, base: S, v: S, mu: S, t: S) -> S {
        if self.wear_coefficient == 0.0 {
            return S::from(0.0);
        }
        let speed = v * (1.0 / REFERENCE_VELOCITY);
        let mut driver = base;
        if mu.value() != self.reference_friction && self.reference_friction > 0.0 {
            driver = driver * mu * (1.0 / self.reference_friction);
        }
        let driver = if self.pressure.exponent == 1.0 { driver } else { driver.powf(self.pressure.exponent) };
        let speed = if self.velocity_exponent == 1.0 { speed } else { speed.powf(self.velocity_exponent) };
        let rate = driver * speed * (self.wear_coefficient * REFERENCE_PRESSURE * REFERENCE_VELOCITY);
        if self.fade.flat {
            return rate * self.fade.factor[0];
        }
        let (factor, slope) = self.fade.at(t.value());
        rate * (S::from(factor) + (t - S::from(t.value())) * slope)
    }
}
