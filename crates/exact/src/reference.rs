//! Exact and independently converged values: quadratures and sums that share no code with the model.
//!
//! Theory: docs/theory.md, section 10.

use crate::special::complementary_error;
use nalgebra::Complex;
use std::f64::consts::PI;

/// exp(x) K0(x), x > 0, from K0(x) = integral_0^inf exp(-x cosh t) dt. The trapezoidal rule converges
/// geometrically on this integrand; accurate to rounding.
pub fn scaled_bessel_k0(x: f64) -> f64 {
    let step = (0.5 / x.sqrt()).min(0.2);
    let mut sum = 0.5;
    let mut index = 1.0;
    loop {
        let exponent = x * ((index * step).cosh() - 1.0);
        if exponent > 45.0 {
            return step * sum;
        }
        sum += (-exponent).exp();
        index += 1.0;
    }
}

/// Integral of `f` over (0, length) by the double-exponential rule, which resolves singularities at 0 and structure near it
/// on any scale. `f` receives the distance from 0 without cancellation.
pub fn integral_from_singularity(length: f64, f: impl Fn(f64) -> f64) -> f64 {
    let step = 1.0 / 48.0;
    let sum: f64 = (-200..=200)
        .map(|index| {
            let t = f64::from(index) * step;
            let below = (-PI * t.sinh()).exp();
            let part = 1.0 / (1.0 + below);
            // d part/dt = pi cosh(t) part (1 - part).
            PI * t.cosh() * part * (below * part) * f(length * part)
        })
        .sum();
    length * step * sum
}

/// Thermal boundary condition under a layer.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum LayerBase {
    /// Temperature held: images of alternating sign.
    Held,
    /// Zero heat flux: images of equal sign.
    Insulated,
}

/// Mean over the band of the quasi-steady temperature of a uniform band source of half-width l, T k/(q l).
///
/// The temperature is the convolution of the flux with the moving line source (Carslaw, Jaeger,
/// "Conduction of Heat in Solids", 10.7), on a layer with its images at the depths 2 n h,
///
/// ```text
/// T(x) = (q/(pi k)) sum_n sigma_n integral exp(-V (x - s)/(2 kd)) K0(V r_n/(2 kd)) ds,  r_n^2 = (x - s)^2 + (2 n h)^2
/// ```
///
/// and its mean over the band, with lengths in l and Pe = V l/(2 kd),
///
/// ```text
/// (1/pi) integral_0^2 (2 - d) cosh(Pe d) sum_n sigma_n K0(Pe sqrt(d^2 + 4 n^2 h^2)) dd.
/// ```
///
/// `layer`: height over l and base; without it the half-plane.
pub fn band_mean(peclet: f64, layer: Option<(f64, LayerBase)>) -> f64 {
    let kernel = |d: f64, distance: f64| {
        0.5 * (1.0 + (-2.0 * peclet * d).exp()) * (peclet * (d - distance)).exp() * scaled_bessel_k0(peclet * distance)
    };
    integral_from_singularity(2.0, |d| (2.0 - d) * with_images(layer, d, |distance| kernel(d, distance))) / PI
}

/// Sum over a source and its images in a layer (height and base; none: the half-plane) of `kernel`, a positive function of
/// the distance r_n = sqrt(d^2 + (2 n h)^2).
fn with_images(layer: Option<(f64, LayerBase)>, d: f64, kernel: impl Fn(f64) -> f64) -> f64 {
    let mut sum = kernel(d);
    if let Some((height, base)) = layer {
        let mut index = 1.0;
        loop {
            let term = 2.0 * kernel(d.hypot(2.0 * index * height));
            let odd = index % 2.0 == 1.0;
            sum += if base == LayerBase::Held && odd { -term } else { term };
            if term < 1e-15 * sum.abs() {
                break;
            }
            index += 1.0;
        }
    }
    sum
}

/// Quasi-steady temperature T k/(q l) at `x` (over l, inside the band) under a uniform band source that moves at `peclet`
/// towards +x on a half-plane or a layer: the kernel of [`band_mean`] on both sides of x.
fn band_temperature(peclet: f64, x: f64, layer: Option<(f64, LayerBase)>) -> f64 {
    // exp(-+ Pe d) K0(Pe r): the same decay over the distance r >= d on both sides, except for a factor behind the source.
    let ahead = |d: f64| {
        with_images(layer, d, |distance| (peclet * (d - distance)).exp() * scaled_bessel_k0(peclet * distance))
    };
    let behind = |d: f64| (-2.0 * peclet * d).exp() * ahead(d);
    (integral_from_singularity(1.0 + x, behind) + integral_from_singularity(1.0 - x, ahead)) / PI
}

/// Largest temperature under that source, T k/(q l), and its position (over l).
pub fn band_maximum(peclet: f64, layer: Option<(f64, LayerBase)>) -> (f64, f64) {
    // Golden section: the temperature has one maximum.
    let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
    let (mut low, mut high) = (-1.0, 1.0);
    let mut inner = [high - golden * (high - low), low + golden * (high - low)];
    let mut values = inner.map(|x| band_temperature(peclet, x, layer));
    while high - low > 1e-6 {
        if values[0] > values[1] {
            high = inner[1];
            inner = [high - golden * (high - low), inner[0]];
            values = [band_temperature(peclet, inner[0], layer), values[0]];
        } else {
            low = inner[0];
            inner = [inner[1], low + golden * (high - low)];
            values = [values[1], band_temperature(peclet, inner[1], layer)];
        }
    }
    let x = 0.5 * (low + high);
    (band_temperature(peclet, x, layer), x)
}

/// A closed path along a layer.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct ClosedPath {
    /// Length of the path, m.
    pub length: f64,
    /// Half-length a of the source, m.
    pub half_length: f64,
    /// Height of the layer, m.
    pub height: f64,
    /// Conductivity, W/(m K).
    pub conductivity: f64,
    /// Diffusivity, m2/s.
    pub diffusivity: f64,
    /// Boundary condition under the layer.
    pub base: LayerBase,
}

impl ClosedPath {
    /// Quasi-steady mean temperature over the source per flux without the mean mode, K m2/W, at `velocity` (m/s): the plain
    /// sum over `harmonics` wave numbers q = 2 pi n/L of (4 a/L) (sin(q a)/(q a))^2 Re [tanh or coth(kappa h)/(K kappa)],
    /// kappa^2 = q^2 + i q v/kd. The truncation error falls with the square of the number of harmonics.
    pub fn steady_mean(&self, velocity: f64, harmonics: u32) -> f64 {
        let a = self.half_length;
        (1..=harmonics)
            .map(|n| {
                let q = 2.0 * PI * f64::from(n) / self.length;
                let kappa = Complex::new(q * q, q * velocity / self.diffusivity).sqrt();
                let decay = (-2.0 * self.height * kappa).exp();
                let ratio = match self.base {
                    LayerBase::Held => (1.0 - decay) / (1.0 + decay),
                    LayerBase::Insulated => (1.0 + decay) / (1.0 - decay),
                };
                let weight = 4.0 * a / self.length * ((q * a).sin() / (q * a)).powi(2);
                weight * (ratio / (kappa * self.conductivity)).re
            })
            .sum()
    }
}

/// Mean of T K/(q a) over a square 2a x 2a that slides along a side on a half-space at the Peclet number V a/(2 kd): the
/// integral over the history of the fractions of the instantaneous heat that remain under the square, along and across.
pub fn square_mean(peclet: f64) -> f64 {
    let (steps, low, high) = (4000, 1e-8_f64.ln(), 1e8_f64.ln());
    let step = (high - low) / f64::from(steps);
    let part = |time: f64| {
        let root = 2.0 * time.sqrt();
        // Second antiderivative of a diffused point source.
        let primitive = |u: f64| {
            let z = u / root;
            let tail = 0.5 * complementary_error(z.abs());
            u * if z < 0.0 { tail } else { 1.0 - tail } + 0.5 * root / PI.sqrt() * (-z * z).exp()
        };
        let overlap = |shift: f64| 0.5 * (primitive(shift + 2.0) - 2.0 * primitive(shift) + primitive(shift - 2.0));
        overlap(2.0 * peclet * time) * overlap(0.0)
    };
    (0..steps)
        .map(|k| {
            let time = (low + step * (f64::from(k) + 0.5)).exp();
            part(time) * (time / PI).sqrt() * step
        })
        .sum()
}

/// Smallest root x in (low, high) of an increasing function, by bisection to rounding.
pub fn root(low: f64, high: f64, f: impl Fn(f64) -> f64) -> f64 {
    let (mut low, mut high) = (low, high);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if f(middle) > 0.0 {
            high = middle;
        } else {
            low = middle;
        }
    }
    0.5 * (low + high)
}

/// Mean temperature of a band of the width 2 on a half-space of K = rho c = 1 that its flux heats from time 0 on, at the `time`: heat
/// spreads along the surface in Gaussians, and decays into the depth.
pub fn band_on_fresh_material(position: impl Fn(f64) -> f64, flux: impl Fn(f64) -> f64, time: f64) -> f64 {
    // Primitive of the normal distribution.
    let primitive = |z: f64, deviation: f64| {
        let u = z / deviation;
        z * 0.5 * complementary_error(-u / 2f64.sqrt()) + deviation * (-0.5 * u * u).exp() / (2.0 * PI).sqrt()
    };
    let (parts, end) = (8000, time.sqrt());
    let here = position(time);
    let part = |k: i32| {
        let root = end * (f64::from(k) + 0.5) / f64::from(parts);
        let age = root * root;
        let (away, deviation) = (here - position(time - age), (2.0 * age).sqrt());
        let [ahead, behind, own] = [away + 2.0, away - 2.0, away].map(|z| primitive(z, deviation));
        flux(time - age) * 0.5 * (ahead + behind - 2.0 * own)
    };
    2.0 / PI.sqrt() * end / f64::from(parts) * (0..parts).map(part).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bessel_values_of_the_tables() {
        // Abramowitz, Stegun, table 9.8: exp(x) K0(x), and K0(0.1) = 2.4270690247.
        for (x, value) in
            [(0.1, 2.427_069_024_702_017 * 0.1_f64.exp()), (1.0, 1.144_463_079_8), (10.0, 0.391_631_934_4)]
        {
            assert!((scaled_bessel_k0(x) / value - 1.0).abs() < 1e-9, "{x}: {}", scaled_bessel_k0(x));
        }
        // Limits: -ln(x/2) - gamma, and sqrt(pi/(2 x)).
        let small = scaled_bessel_k0(1e-8) + (0.5e-8_f64).ln() + 0.577_215_664_901_532_9;
        assert!(small.abs() < 1e-6, "{small}");
        let large = scaled_bessel_k0(1e7) / (PI / 2e7).sqrt() - 1.0;
        assert!(large.abs() < 1e-7, "{large}");
    }

    #[test]
    fn band_means_of_jaeger() {
        for (peclet, mean) in [(0.1, 2.0618), (1.0, 0.79986), (10.0, 0.24132)] {
            assert!((band_mean(peclet, None) - mean).abs() < 5e-5, "{peclet}: {}", band_mean(peclet, None));
        }
    }

    #[test]
    fn band_maxima_of_jaeger() {
        for (peclet, value, place) in [(0.1, 2.20033, -0.2435), (1.0, 0.99185, -0.6664), (10.0, 0.34850, -0.9244)] {
            let (found, at) = band_maximum(peclet, None);
            assert!((found - value).abs() < 5e-6 && (at - place).abs() < 5e-5, "{peclet}: {found} at {at}");
            // The mean of the temperature agrees with the formula for the mean.
            let mean =
                (0..200).map(|k| band_temperature(peclet, -0.995 + 0.01 * f64::from(k), None)).sum::<f64>() / 200.0;
            assert!((mean / band_mean(peclet, None) - 1.0).abs() < 1e-3, "{peclet}: {mean}");
        }
    }
}
