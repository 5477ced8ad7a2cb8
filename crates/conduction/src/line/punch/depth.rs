//! Conduction of one transverse mode through the height: exact impedance and steady profiles.
//!
//! A mode `X(x) Z(z, t)` with the static decay `kappa_0` obeys
//!
//! ```text
//! C dZ/dt = k Z'' - k kappa_0^2 Z,   -k Z'(0) = q,   Z(h) = 0  or  -k Z'(h) = h_top Z(h)
//! ```
//!
//! At the real rate s its response to q decays with `kappa = sqrt(kappa_0^2 + s C/k)`. A face that also loses H Z(0)
//! receives `q - H Z(0)`: its response is that without loss over `1 + H Z(0)`.
//!
//! Theory: docs/theory.md, sections 4.6, 4.2.

use crate::slab::Slab;
use nalgebra::Complex;
use scene::{Body, FarBoundary};

/// Height and material of the body, with its conditions at both faces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Depth {
    /// Height h, m.
    pub height: f64,
    /// Conductivity k, W/(m K).
    pub conductivity: f64,
    /// Heat capacity C by volume, J/(m3 K).
    pub capacity: f64,
    pub top: FarBoundary,
    /// Heat transfer coefficient H beside the contact as a mean over the contact's face, W/(m2 K).
    pub face: f64,
    /// Whether a flux beyond the constant heat transfer acts on the top: the space then contains responses to it.
    pub driven_top: bool,
}

impl Depth {
    /// The height of a body over `spread` times the area of the contact, without loss at the face.
    pub(super) fn new(body: &Body, spread: f64) -> Depth {
        let Slab { height, conductivity, capacity, base, .. } = Slab::of(body);
        Depth {
            height,
            conductivity: spread * conductivity,
            capacity: spread * capacity,
            top: base.scaled(spread),
            face: 0.0,
            driven_top: base != FarBoundary::Held,
        }
    }

    pub(crate) fn diffusivity(&self) -> f64 {
        self.conductivity / self.capacity
    }

    /// h_top/k, 1/m; None where the temperature of the top is prescribed.
    pub(super) fn top_ratio(&self) -> Option<f64> {
        (self.top != FarBoundary::Held).then(|| self.top.transfer() / self.conductivity)
    }

    /// Whether a field that decays with `decay` has a steady state: heat leaves through the top or the sides.
    pub(crate) fn has_steady_state(&self, decay: f64) -> bool {
        decay > 0.0 || self.top != FarBoundary::Insulated || self.face > 0.0
    }

    /// Ratio of the response with loss at the face to that without, whose value there is `contact`.
    fn kept(&self, contact: f64) -> f64 {
        1.0 / (1.0 + self.face * contact)
    }

    /// Exact Z(0) per unit q for the complex decay `kappa`, Re > 0, K m2/W.
    pub(crate) fn impedance(&self, kappa: Complex<f64>) -> Complex<f64> {
        if kappa.re * self.height > 20.0 && self.face == 0.0 {
            // The top has no effect to rounding.
            return (kappa * self.conductivity).inv();
        }
        let fall = (kappa * (-2.0 * self.height)).exp();
        let reflection = match self.top_ratio() {
            None => Complex::from(-1.0),
            Some(ratio) => (kappa - ratio) / (kappa + ratio),
        };
        let closed = (reflection * fall + 1.0) / ((-reflection * fall + 1.0) * kappa * self.conductivity);
        closed / (closed * self.face + 1.0)
    }

    /// Exact steady Z(0) per unit q, K m2/W, where it exists.
    pub(crate) fn steady_impedance(&self, decay: f64) -> f64 {
        self.response(decay, 0.0).0
    }

    /// Z and dZ/dz at `z` per unit q for the real decay `kappa` (0 only where heat leaves through the top or the face).
    pub(crate) fn response(&self, kappa: f64, z: f64) -> (f64, f64) {
        self.profile(kappa)(z)
    }

    /// [`Self::response`] as a function of z.
    pub(crate) fn profile(&self, kappa: f64) -> impl Fn(f64) -> (f64, f64) {
        let closed = self.closed_profile(kappa);
        let lost_by_face = self.face > 0.0 && kappa * self.height < 1e-9 && self.top == FarBoundary::Insulated;
        let level = lost_by_face.then(|| 1.0 / self.face);
        let kept = if self.face == 0.0 || lost_by_face { 1.0 } else { self.kept(closed(0.0).0) };
        move |z| match level {
            Some(level) => (level, 0.0),
            None => {
                let (value, slope) = closed(z);
                (kept * value, kept * slope)
            }
        }
    }

    /// [`Self::profile`] without loss at the face.
    fn closed_profile(&self, kappa: f64) -> impl Fn(f64) -> (f64, f64) {
        let (k, h) = (self.conductivity, self.height);
        let top = self.top_ratio();
        let straight = kappa * h < 1e-9 && self.top != FarBoundary::Insulated;
        // 1 + r and 1 - r of the reflection r, each without cancellation.
        let (reflection, sum, difference) = match top {
            None => (-1.0, 0.0, 2.0),
            Some(ratio) => {
                ((kappa - ratio) / (kappa + ratio), 2.0 * kappa / (kappa + ratio), 2.0 * ratio / (kappa + ratio))
            }
        };
        let entering = difference - reflection * (-2.0 * kappa * h).exp_m1();
        move |z| {
            let distance = h - z;
            if straight {
                return match top {
                    None => (distance / k, -1.0 / k),
                    Some(ratio) => ((1.0 + ratio * distance) / (ratio * k), -1.0 / k),
                };
            }
            let scale = (-kappa * z).exp() / entering;
            // The reflection is below rounding over a longer path: exp(-40) = 4e-18.
            let way = 2.0 * kappa * distance;
            let back = if way > 40.0 { -reflection } else { reflection * (-way).exp_m1() };
            (scale * (sum + back) / (kappa * k), -scale * (difference - back) / k)
        }
    }

    /// Integral over the height of the steady response to unit q, K m3/W: by reciprocity the temperature of the contact by a
    /// uniform source.
    pub(crate) fn steady_integral(&self, decay: f64) -> f64 {
        if self.face == 0.0 {
            return self.sourced(decay, 0.0);
        }
        if decay * self.height < 1e-9 && self.top == FarBoundary::Insulated {
            return self.height / self.face;
        }
        self.kept(self.closed_profile(decay)(0.0).0) * self.sourced(decay, 0.0)
    }

    /// Steady Z(z) of a uniform heat source of 1 W/m3 (the cooled surface), without loss at the face, K m3/W.
    pub(crate) fn sourced(&self, decay: f64, z: f64) -> f64 {
        let (k, h) = (self.conductivity, self.height);
        if decay * h < 1.0 {
            // [r (cosh decay h - cosh decay z) + decay sinh decay h]/(r cosh decay h + decay sinh decay h)/(k decay^2),
            // with r = h_top/k, without cancellation.
            let sine = |x: f64| if decay * x < 1e-6 { x } else { (decay * x).sinh() / decay };
            let rise = 2.0 * sine(0.5 * (h + z)) * sine(0.5 * (h - z));
            let cosine = (decay * h).cosh();
            return match self.top_ratio() {
                None => rise / (k * cosine),
                Some(ratio) => (ratio * rise + sine(h)) / (k * (ratio * cosine + decay * decay * sine(h))),
            };
        }
        let fall = (-2.0 * decay * h).exp();
        let rise = (decay * (z - h)).exp() + (-decay * (z + h)).exp();
        let at_top = match self.top_ratio() {
            None => rise / (1.0 + fall),
            Some(ratio) => rise * ratio / (ratio * (1.0 + fall) + decay * (1.0 - fall)),
        };
        (1.0 - at_top) / (k * decay * decay)
    }

    /// Integral of [`Self::sourced`] over the height, K m4/W.
    pub(crate) fn sourced_integral(&self, decay: f64) -> f64 {
        let (k, h) = (self.conductivity, self.height);
        let square = (decay * h).powi(2);
        // tanh(decay h)/decay, and its difference from h over decay^2.
        let (tangent, deficit) = if square < 1e-3 {
            let deficit = h.powi(3) * (1.0 / 3.0 - square * (2.0 / 15.0 - square * 17.0 / 315.0));
            (h - decay * decay * deficit, deficit)
        } else {
            let tangent = (decay * h).tanh() / decay;
            (tangent, (h - tangent) / (decay * decay))
        };
        match self.top_ratio() {
            None => deficit / k,
            Some(ratio) => (h * tangent + ratio * deficit) / (k * (ratio + decay * decay * tangent)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steady_profiles_satisfy_their_equations() {
        for top in
            [FarBoundary::Held, FarBoundary::Insulated, FarBoundary::Convecting(1e-3), FarBoundary::Convecting(500.0)]
        {
            let depth = Depth { height: 0.1, conductivity: 55.0, capacity: 3.6e6, top, face: 0.0, driven_top: false };
            for decay in [0.0, 1e-4, 0.3, 9.9, 10.1, 300.0] {
                if !depth.has_steady_state(decay) {
                    continue;
                }
                let rule = numerics::quadrature::gauss_legendre(40);
                let edges = [0.0, 1e-4, 1e-3, 0.01, 0.05, 0.1];
                let integral = |f: &dyn Fn(f64) -> f64| -> f64 {
                    (edges.windows(2))
                        .flat_map(|pair| {
                            let (middle, half) = (0.5 * (pair[0] + pair[1]), 0.5 * (pair[1] - pair[0]));
                            rule.iter().map(move |&(node, weight)| half * weight * f(middle + half * node))
                        })
                        .sum()
                };
                // Heat balance of the response to the contact: the input is lost through the height or leaves at the top.
                let response = integral(&|z| depth.response(decay, z).0);
                let loss = 55.0 * decay * decay * response - 55.0 * depth.response(decay, 0.1).1;
                assert!((loss - 1.0).abs() < 1e-9, "{top:?} {decay}: {loss}");
                assert!((response / depth.steady_integral(decay) - 1.0).abs() < 1e-9, "{top:?} {decay}");
                let sourced = integral(&|z| depth.sourced(decay, z));
                assert!((sourced / depth.sourced_integral(decay) - 1.0).abs() < 1e-9, "{top:?} {decay}");
                if decay > 1e-3 {
                    let exact = depth.impedance(Complex::from(decay)).re;
                    assert!((depth.steady_impedance(decay) / exact - 1.0).abs() < 1e-9, "{top:?} {decay}");
                }
            }
        }
    }
}
