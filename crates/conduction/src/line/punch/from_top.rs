//! Steady field of one transverse mode by a flux into the top.
//!
//! ```text
//! Z'' = kappa^2 Z,   k Z'(0) = H Z(0),   k Z'(h) = 1 - h_top Z(h):   Z = A [cosh kappa z + H/(k kappa) sinh kappa z]
//! ```
//!
//! By reciprocity it also gives the temperature of the top per unit flux into the contact (Z(0)) and per uniform source (its
//! integral).
//!
//! Theory: docs/theory.md, section 4.6.

use super::depth::Depth;

/// Steady field of a unit flux into a top without prescribed temperature.
pub(super) struct FromTop {
    decay: f64,
    height: f64,
    /// H/k of the face at the contact, 1/m.
    face: f64,
    /// Value at the contact over exp(-decay h), K m2/W.
    scale: f64,
}

impl FromTop {
    /// exp(-decay h) cosh(decay z) and exp(-decay h) sinh(decay z)/decay.
    fn waves(decay: f64, height: f64, z: f64) -> (f64, f64) {
        let (back, twice) = ((-decay * (height - z)).exp(), 2.0 * decay * z);
        let sine = if twice < 1e-9 { z } else { -(-twice).exp_m1() / (2.0 * decay) };
        (0.5 * back * (1.0 + (-twice).exp()), back * sine)
    }

    /// Z and dZ/dz at `z`, K m2/W.
    pub(crate) fn at(&self, z: f64) -> (f64, f64) {
        let (cosine, sine) = Self::waves(self.decay, self.height, z);
        let slope = self.decay * self.decay * sine + self.face * cosine;
        (self.scale * (cosine + self.face * sine), self.scale * slope)
    }

    /// Integral of Z over the height, K m3/W.
    pub(crate) fn integral(&self) -> f64 {
        let (_, sine) = Self::waves(self.decay, self.height, self.height);
        let (_, half) = Self::waves(self.decay, 0.5 * self.height, 0.5 * self.height);
        self.scale * (sine + 2.0 * self.face * half * half)
    }
}

impl Depth {
    /// Steady field of a unit flux into the top, which has no prescribed temperature, where it exists.
    pub(crate) fn driven_from_top(&self, decay: f64) -> FromTop {
        let (k, h) = (self.conductivity, self.height);
        let (face, top) = (self.face / k, self.top_ratio().unwrap_or(0.0));
        let (cosine, sine) = FromTop::waves(decay, h, h);
        let flux = k * (decay * decay * sine + face * cosine + top * (cosine + face * sine));
        FromTop { decay, height: h, face, scale: 1.0 / flux }
    }
}
