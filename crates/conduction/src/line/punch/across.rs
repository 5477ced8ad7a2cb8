//! Transverse modes: eigenfunctions of conduction across the width of the punch, exact since a rectangle of one material
//! separates.
//!
//! ```text
//! X'' + xi^2 X = 0 on |x| < a,   -k X' n = h X on the sides (block),   or X periodic with 2 a (ring)
//! ```
//!
//! Even and odd modes alternate: `X = cos xi x` with `xi a tan xi a = Bi`, `X = sin xi x` with `-xi a cot xi a = Bi`,
//! `Bi = h a/k`. Both are `xi a = m pi/2 + delta`, `xi a tan delta = Bi`, `0 <= delta < pi/2`. On the ring
//! `xi a = pi, pi, 2 pi, 2 pi ...`. All modes have `integral X^2 dx = 1`, so that they are orthonormal over the contact.
//! Across the width of an annulus, its radius, they are Bessel functions ([`super::radial`]).
//!
//! Theory: docs/theory.md, section 4.6.

use super::radial::{RadialMode, Radii};
use elasticity::Cells;
use std::f64::consts::{FRAC_PI_2, PI};

/// Lateral boundary of the punch along x.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Sides {
    /// Two sides of a block.
    Free,
    /// None: a closed ring.
    Closed,
    /// Inner and outer side of an annulus of this mean radius, m.
    Radial(f64),
}

/// Width, cooling and conductivity, which determine the transverse modes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Across {
    /// Half-width a, m.
    pub half_width: f64,
    pub sides: Sides,
    /// Cooled surface per depth and per height: 2 where only the sides of the block are cooled. On the ring it is
    /// distributed over the volume.
    pub cooled: f64,
    /// Constant heat transfer coefficient of the cooled surface, W/(m2 K).
    pub transfer: f64,
    /// Conductivity k, W/(m K).
    pub conductivity: f64,
}

/// One transverse mode.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Wave {
    /// Wave number xi, 1/m.
    pub wave_number: f64,
    /// Decay of its steady field into a deep body, 1/m: xi, on the ring also with the heat loss from the volume.
    pub decay: f64,
    /// Integral of X over the width, m^(1/2).
    pub integral: f64,
    /// Sum of X over the cooled surface, per height, m^(-1/2).
    pub exposure: f64,
    form: Form,
}

/// Form of the eigenfunction X.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Form {
    Cosine(f64),
    Sine(f64),
    Radial(RadialMode),
}

impl Across {
    /// Mode number `m` in ascending order of the wave numbers.
    pub(crate) fn wave(&self, m: usize) -> Wave {
        match self.sides {
            Sides::Free => self.between_sides(m),
            Sides::Closed => self.around(m),
            Sides::Radial(mean) => self.along_radius(m, mean),
        }
    }

    /// Areas of the cells per depth, m: their widths, on an annulus times r/r_m.
    pub(crate) fn weights(&self, cells: &Cells) -> Vec<f64> {
        let ratio = |x: f64| match self.sides {
            Sides::Radial(mean) => 1.0 + x / mean,
            Sides::Free | Sides::Closed => 1.0,
        };
        cells.centres().iter().zip(cells.widths()).map(|(&x, width)| width * ratio(x)).collect()
    }

    fn along_radius(&self, m: usize, mean: f64) -> Wave {
        let loss = 0.5 * self.cooled * self.transfer / self.conductivity;
        let radii = Radii { inner: mean - self.half_width, outer: mean + self.half_width, mean, loss };
        let mode = radii.mode(m);
        let exposure = 0.5 * self.cooled * mode.at_sides(&radii);
        let wave_number = mode.wave_number;
        let integral = match (m, loss > 0.0) {
            (_, true) => self.transfer * exposure / (self.conductivity * wave_number * wave_number),
            (0, false) => (2.0 * self.half_width).sqrt(),
            (_, false) => 0.0,
        };
        Wave { wave_number, decay: wave_number, integral, exposure, form: Form::Radial(mode) }
    }

    fn between_sides(&self, m: usize) -> Wave {
        let a = self.half_width;
        let biot = 0.5 * self.cooled * self.transfer * a / self.conductivity;
        let (start, even) = (FRAC_PI_2 * m as f64, m.is_multiple_of(2));
        let delta = phase(start, biot);
        let angle = start + delta;
        let sign = if (m / 2).is_multiple_of(2) { 1.0 } else { -1.0 };
        // cos and sin of the angle of the even modes, from the small angle; for the odd ones only the product matters.
        let (cosine, sine) = (sign * delta.cos(), sign * delta.sin());
        let wave_number = angle / a;
        let product = if even { cosine * sine } else { -delta.cos() * delta.sin() };
        let norm = if angle < 1e-4 {
            2.0 * a
        } else if even {
            a * (1.0 + product / angle)
        } else {
            a * (1.0 - product / angle)
        };
        let amplitude = norm.sqrt().recip();
        let (mut integral, mut exposure) = (0.0, 0.0);
        if even {
            exposure = self.cooled * amplitude * cosine;
            integral = 2.0 * a * amplitude * if angle < 1e-4 { 1.0 - angle * angle / 6.0 } else { sine / angle };
        }
        let form = if even { Form::Cosine(amplitude) } else { Form::Sine(amplitude) };
        Wave { wave_number, decay: wave_number, integral, exposure, form }
    }

    fn around(&self, m: usize) -> Wave {
        let width = 2.0 * self.half_width;
        let order = m.div_ceil(2);
        let wave_number = 2.0 * PI * order as f64 / width;
        let amplitude = if m == 0 { width.recip().sqrt() } else { (2.0 / width).sqrt() };
        let integral = if m == 0 { width.sqrt() } else { 0.0 };
        let loss = self.cooled * self.transfer / (width * self.conductivity);
        Wave {
            wave_number,
            decay: (wave_number * wave_number + loss).sqrt(),
            integral,
            exposure: self.cooled * integral / width,
            form: if m == 0 || !m.is_multiple_of(2) { Form::Cosine(amplitude) } else { Form::Sine(amplitude) },
        }
    }
}

impl Wave {
    /// Eigenfunction X at `x`.
    pub(crate) fn value(&self, x: f64) -> f64 {
        match &self.form {
            Form::Cosine(amplitude) => amplitude * (self.wave_number * x).cos(),
            Form::Sine(amplitude) => amplitude * (self.wave_number * x).sin(),
            Form::Radial(mode) => mode.value(x),
        }
    }

    /// Parity of X: even (1) or odd (-1); None: neither.
    pub(crate) fn parity(&self) -> Option<f64> {
        match &self.form {
            Form::Cosine(_) => Some(1.0),
            Form::Sine(_) => Some(-1.0),
            Form::Radial(_) => None,
        }
    }

    /// [`Self::integrate`] into a new vector.
    #[cfg(test)]
    pub(crate) fn cell_integrals(&self, cells: &Cells) -> Vec<f64> {
        let mut integrals = vec![0.0; cells.count()];
        self.integrate(cells, &mut integrals);
        integrals
    }

    /// Integral of X over every cell, on an annulus of X r/r_m, m^(1/2); the cells are symmetric about x = 0.
    pub(crate) fn integrate(&self, cells: &Cells, integrals: &mut [f64]) {
        let (sign, amplitude) = match &self.form {
            Form::Radial(mode) => return integrals.copy_from_slice(&mode.integrals(cells.edges())),
            Form::Cosine(amplitude) => (1.0, amplitude),
            Form::Sine(amplitude) => (-1.0, amplitude),
        };
        let antiderivative = |x: &f64| match self.wave_number {
            0.0 => amplitude * x,
            number if sign > 0.0 => amplitude * (number * x).sin() / number,
            number => -amplitude * (number * x).cos() / number,
        };
        let count = cells.count();
        let mut left = antiderivative(&cells.edges()[0]);
        for (i, right) in cells.edges()[1..].iter().map(antiderivative).take(count.div_ceil(2)).enumerate() {
            integrals[count - 1 - i] = sign * (right - left);
            integrals[i] = right - left;
            left = right;
        }
    }
}

/// Solution `delta` in [0, pi/2) of (start + delta) tan delta = `biot`.
fn phase(start: f64, biot: f64) -> f64 {
    if biot == 0.0 {
        return 0.0;
    }
    // The residual is monotonic on the whole interval: Newton's method safeguarded by a shrinking bracket.
    let (mut low, mut high) = (0.0, FRAC_PI_2);
    let mut delta = if start > 0.0 { (biot / start).atan() } else { biot.sqrt().atan() };
    for _ in 0..100 {
        let (sine, cosine) = delta.sin_cos();
        let residual = (start + delta) * sine - biot * cosine;
        if residual > 0.0 {
            high = delta
        } else {
            low = delta
        }
        let slope = sine + (start + delta) * cosine + biot * sine;
        let mut next = delta - residual / slope;
        if !(next > low && next < high) {
            next = 0.5 * (low + high);
        }
        let moved = (next - delta).abs();
        delta = next;
        if moved <= 4.0 * f64::EPSILON * delta {
            break;
        }
    }
    delta
}

#[cfg(test)]
mod tests {
    use super::*;

    fn across(sides: Sides, transfer: f64) -> Across {
        Across { half_width: 0.03, sides, cooled: 2.0, transfer, conductivity: 55.0 }
    }

    #[test]
    fn modes_satisfy_the_sides_and_are_orthonormal() {
        let cells = Cells::uniform(0.03, 900).unwrap();
        for (sides, transfer) in
            [(Sides::Free, 0.0), (Sides::Free, 1e-6), (Sides::Free, 300.0), (Sides::Free, 1e5), (Sides::Closed, 300.0)]
        {
            let across = across(sides, transfer);
            let waves: Vec<Wave> = (0..7).map(|m| across.wave(m)).collect();
            for (m, wave) in waves.iter().enumerate() {
                if sides == Sides::Free {
                    // One-sided difference of the exact function.
                    let slope = (wave.value(0.03) - wave.value(0.03 - 1e-8)) / 1e-8;
                    let scale = wave.wave_number.max(1.0) * wave.value(0.0).abs().max(wave.value(0.0123).abs());
                    let residual = 55.0 * slope + transfer * wave.value(0.03);
                    assert!(residual.abs() < 1e-4 * (55.0 * scale).max(transfer), "{transfer} {m}: {residual}");
                }
                let total: f64 = wave.cell_integrals(&cells).iter().sum();
                assert!((total - wave.integral).abs() < 1e-9, "{m}: {total} {}", wave.integral);
                // The loss through the cooled surface balances the decay.
                let loss = transfer * wave.exposure;
                let expected = 55.0 * wave.decay.powi(2) * wave.integral;
                assert!((loss - expected).abs() < 1e-9 * loss.abs().max(1e-30) + 1e-12, "{m}: {loss} {expected}");
                for (n, other) in waves.iter().enumerate() {
                    let product: f64 = cells
                        .centres()
                        .iter()
                        .zip(cells.widths())
                        .map(|(&x, w)| w * wave.value(x) * other.value(x))
                        .sum();
                    let expected = if m == n { 1.0 } else { 0.0 };
                    assert!((product - expected).abs() < 2e-4, "{m} {n}: {product}");
                }
            }
        }
    }
}
