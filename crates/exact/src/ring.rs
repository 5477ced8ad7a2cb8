//! Rings: steady conduction along the radius, and thermoelastic instability of radial pressure bands.
//!
//! Theory: docs/theory.md, sections 10, 4.7.

/// Steady rise of the mean temperature through the height between two radii, in K, of a ring insulated except for a flux
/// `flux` (W/m2) into its face inside of the radius `parting` and the balancing flux outside.
///
/// `(r T')' = -r q/(K h)` without slope at both sides,
///
/// ```text
/// T = -q_1/(2 K h) (r^2/2 - r_i^2 ln r) + const inside,   T = -q_2/(2 K h) (r^2/2 - r_o^2 ln r) + const outside
/// ```
#[derive(Clone, Copy, Debug)]
pub struct PartedRing {
    /// Inner, parting and outer radius, m.
    pub radii: [f64; 3],
    /// Conductance K h, W/K.
    pub conductance: f64,
    /// Flux into the inner part, W/m2.
    pub flux: f64,
}

impl PartedRing {
    /// Flux into the outer part, W/m2.
    pub fn outer_flux(&self) -> f64 {
        let [inner, parting, outer] = self.radii.map(|radius| radius * radius);
        -self.flux * (parting - inner) / (outer - parting)
    }

    /// Mean over the area between two radii of one part, of the temperature above that at the parting radius, K.
    pub fn rise(&self, from: f64, to: f64) -> f64 {
        let [inner, parting, outer] = self.radii;
        let (flux, side) = if to <= parting { (self.flux, inner) } else { (self.outer_flux(), outer) };
        let factor = -flux / (2.0 * self.conductance);
        let at_parting = 0.5 * parting * parting - side * side * parting.ln();
        // Integrals of r times r^2/2 and ln r.
        let primitive = |r: f64| r.powi(4) / 8.0 - side * side * 0.5 * r * r * (r.ln() - 0.5);
        let area = 0.5 * (to * to - from * from);
        factor * ((primitive(to) - primitive(from)) / area - at_parting)
    }
}

/// Growing pressure bands across a ring of independent elastic columns that slides on a rigid insulator.
///
/// The columns, insulated except at the contact, receive all friction heat and lengthen by alpha (1 + nu) times the integral
/// of the temperature over their height, theta, whatever its profile. Pressure deviates from the mean by
///
/// ```text
/// p' = k alpha (1 + nu) (theta' - c),   integral p' r dr = 0,   d theta'/dt = kd (r theta'_r)_r/r + G r/r_m (theta' - c)
/// ```
///
/// with `G = mu v k alpha (1 + nu)/(rho c)`, v at the mean radius, and no slope at both sides.
#[derive(Clone, Copy, Debug)]
pub struct RadialBands {
    /// Inner and outer radius, m; r_m is their mean.
    pub radii: [f64; 2],
    /// Diffusivity kd, m2/s.
    pub diffusivity: f64,
    /// Drive G, the growth rate by friction heat without conduction, 1/s.
    pub drive: f64,
}

/// Steps of the classical Runge-Kutta method across the ring: relative error below 1e-9.
const STEPS: u32 = 1000;

impl RadialBands {
    /// Growth rate of the longest band, 1/s: the largest root of the determinant of both conditions at the outer side.
    pub fn growth(&self) -> f64 {
        let width = self.radii[1] - self.radii[0];
        let decay = self.diffusivity * (std::f64::consts::PI / width).powi(2);
        let fastest = self.drive * 2.0 * self.radii[1] / (self.radii[0] + self.radii[1]);
        // Search downwards from an upper bound; the uniform temperature, which causes no pressure, has the rate 0.
        let step = 0.05 * decay;
        let (mut high, mut at_high) = (fastest, self.determinant(fastest));
        loop {
            let low = high - step;
            let at_low = self.determinant(low);
            if at_low * at_high <= 0.0 {
                break;
            }
            (high, at_high) = (low, at_low);
        }
        let mut low = high - step;
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if self.determinant(middle) * at_high <= 0.0 {
                low = middle;
            } else {
                high = middle;
            }
        }
        0.5 * (low + high)
    }

    /// Determinant of the slope at the outer side and the load, by the value at the inner side and c.
    fn determinant(&self, rate: f64) -> f64 {
        let [inner, outer] = self.radii;
        let mean = 0.5 * (inner + outer);
        let own = self.integrate(rate, 1.0, 0.0);
        let shifted = self.integrate(rate, 0.0, 1.0);
        let area = 0.5 * (outer * outer - inner * inner) / mean;
        own[1] * (shifted[2] - area) - shifted[1] * own[2]
    }

    /// theta, its slope and the integral of theta r/r_m at the outer side for theta at the inner side and c.
    fn integrate(&self, rate: f64, start: f64, shift: f64) -> [f64; 3] {
        let [inner, outer] = self.radii;
        let mean = 0.5 * (inner + outer);
        let derivative = |r: f64, y: [f64; 3]| {
            let ratio = r / mean;
            let bend = (rate * y[0] - self.drive * ratio * (y[0] - shift)) / self.diffusivity;
            [y[1], bend - y[1] / r, ratio * y[0]]
        };
        let step = (outer - inner) / f64::from(STEPS);
        let mut y = [start, 0.0, 0.0];
        for k in 0..STEPS {
            let r = inner + step * f64::from(k);
            let moved = |k: [f64; 3], part: f64| std::array::from_fn(|i| y[i] + part * step * k[i]);
            let k1 = derivative(r, y);
            let k2 = derivative(r + 0.5 * step, moved(k1, 0.5));
            let k3 = derivative(r + 0.5 * step, moved(k2, 0.5));
            let k4 = derivative(r + step, moved(k3, 1.0));
            for i in 0..3 {
                y[i] += step / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]);
            }
        }
        y
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn the_rate_is_that_of_finite_volumes() {
        // 400 volumes, r_m = 50 and 160 mm, W = 40 mm, kd = 54/3.312e6, G twice and 1.5 times kd (pi/W)^2.
        let diffusivity = 54.0 / (7200.0 * 460.0);
        let decay = diffusivity * (PI / 0.04f64).powi(2);
        for (mean, ratio, expected) in [(0.05, 2.0, 9.372_603e-2), (0.16, 1.5, 4.957_242e-2)] {
            let bands = RadialBands { radii: [mean - 0.02, mean + 0.02], diffusivity, drive: ratio * decay };
            assert!((bands.growth() / expected - 1.0).abs() < 1e-4, "{mean}: {} {expected}", bands.growth());
        }
    }
}
