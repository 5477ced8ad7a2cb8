//! Local heating of the strip under the contact relative to its mean temperature: exact moving-source kernels.
//!
//! A uniform flux over |x| < a that moves at velocity v over a layer heats it in Fourier modes along the path. In the
//! punch's frame the response of a mode of wave number q at the complex frequency `s` is the layer's impedance
//! `Z(q, s + i q v)` (see [`Slab::impedance`]); projected on the mean over the contact,
//!
//! ```text
//! R(s; v) = sum over q != 0 of  w_q Re Z(q, s + i q v),     w_q = (2a/L) sinc^2(q a)
//! ```
//!
//! on a closed path of length L (the mean mode q = 0 is the slab's), and the integral over q on an endless one. On a
//! reciprocating stroke the fraction `|c_q|^2 = sinc^2(q stroke/2)` of every mode acts repeatedly on the same material: it
//! belongs to the track and not to the moving source.
//!
//! Source: J. C. Jaeger, "Moving sources of heat and the temperature at sliding contacts" (1942); checked against the band
//! on a half-plane. Error of the sums below 1e-6 of the value.
//!
//! Theory: docs/theory.md, section 4.3.

use super::lateral::{Lateral, spread};
use super::slab::Slab;
use nalgebra::Complex;
use numerics::quadrature::GAUSS_5;
use scene::FarBoundary;
use std::f64::consts::PI;

/// Part of the heating that a sum represents.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Part {
    /// Part that moves with the contact.
    Flash,
    /// Part that stays in the track of a stroke.
    Track,
}

/// Path of the contact on the strip.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Path {
    /// A closed path, or the cell of an open one, of this length, m.
    Closed(f64),
    /// Reciprocating with this stroke, m, in a cell of this length, m.
    Stroke {
        /// Length of one stroke.
        stroke: f64,
        /// Length of the cell, large enough that its periodic images do not matter.
        cell: f64,
    },
    /// Unidirectional over material never visited before.
    Endless,
}

/// Fourier modes of a uniform source of half-length a on a layer.
#[derive(Clone, PartialEq, Debug)]
pub struct MovingSource {
    slab: Slab,
    half_length: f64,
    path: Path,
    /// Conduction out of the plane.
    lateral: Option<Lateral>,
    /// Wave number, weight of the moving part, weight of the track's part.
    modes: Vec<(f64, f64, f64)>,
}

/// sin(x)/x squared.
fn sinc_squared(x: f64) -> f64 {
    if x.abs() < 1e-4 { 1.0 - x * x / 3.0 } else { (x.sin() / x).powi(2) }
}

/// Number of zeros of sinc(q a) over which the sum extends; beyond, its mean square is integrated.
const ZEROS: f64 = 20.0;

impl MovingSource {
    /// Source of half-length `half_length` (m) on `slab` along `path`. The slab's heat transfer on the contact face is
    /// omitted: under the contact there is none.
    pub fn new(slab: Slab, half_length: f64, path: Path) -> MovingSource {
        let slab = Slab { surface_transfer: 0.0, volume_transfer: 0.0, ..slab };
        let mut source = MovingSource { slab, half_length, path, lateral: None, modes: Vec::new() };
        match path {
            Path::Closed(length) => source.periodic(length, 0.0),
            Path::Stroke { stroke, cell } => source.periodic(cell, stroke),
            Path::Endless => source.endless(),
        }
        source
    }

    fn push(&mut self, q: f64, weight: f64, stroke: f64) {
        let stays = if stroke > 0.0 { sinc_squared(0.5 * q * stroke) } else { 0.0 };
        self.modes.push((q, weight * (1.0 - stays), weight * stays));
    }

    /// Both signs of every harmonic; the high ones, where the sum is close to an integral, by quadrature.
    fn periodic(&mut self, length: f64, stroke: f64) {
        let a = self.half_length;
        let spacing = 2.0 * PI / length;
        let density = 2.0 * (2.0 * a / length);
        let last = (ZEROS * PI / (a * spacing)).ceil().max(128.0);
        let discrete = last.min(128.0);
        let mut harmonic = 1.0;
        while harmonic <= discrete {
            let q = harmonic * spacing;
            self.push(q, density * sinc_squared(q * a), stroke);
            harmonic += 1.0;
        }
        let from = (discrete + 0.5) * spacing;
        let to = if last > discrete { (ZEROS * PI / a).max(2.0 * from) } else { from };
        self.integrate(from, to, density / spacing, stroke);
        self.tail(to, density / spacing, stroke);
    }

    fn endless(&mut self) {
        let a = self.half_length;
        let density = 2.0 * a / PI;
        // Slow modes in geometric panels: fast sliding concentrates their contribution at small q.
        let (mut from, first) = (1e-8 / a, 0.5 * PI / a);
        // Below: Z grows like q^(-1/2) down to the wave number at which the layer's height matters, so the contribution of
        // the lowest part of the integral is proportional to the square root of its length. q = from y^2 makes it smooth.
        for (node, weight) in GAUSS_5 {
            let y = 0.5 * (1.0 + node);
            self.push(from * y * y, density * from * y * weight, 0.0);
        }
        let ratio = 2.5;
        while from < first {
            let to = (from * ratio).min(first);
            self.panel(from, to, density, 0.0);
            from = to;
        }
        self.integrate(first, ZEROS * PI / a, density, 0.0);
        self.tail(ZEROS * PI / a, density, 0.0);
    }

    fn panel(&mut self, from: f64, to: f64, density: f64, stroke: f64) {
        let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
        for (node, weight) in GAUSS_5 {
            let q = middle + half * node;
            self.push(q, density * half * weight * sinc_squared(q * self.half_length), stroke);
        }
    }

    fn integrate(&mut self, from: f64, to: f64, density: f64, stroke: f64) {
        if to <= from {
            return;
        }
        let shortest = PI / (2.0 * self.half_length.max(0.25 * stroke));
        let panels = ((to - from) / shortest).ceil().min(400.0);
        let mut index = 0.0;
        while index < panels {
            let edge = |i: f64| from + (to - from) * i / panels;
            self.panel(edge(index), edge(index + 1.0), density, stroke);
            index += 1.0;
        }
    }

    /// Integral from `from` to infinity with sinc^2 replaced by its mean 1/(2 q^2 a^2): q = from/y^2.
    fn tail(&mut self, from: f64, density: f64, stroke: f64) {
        for half in [0.0, 0.5] {
            for (node, weight) in GAUSS_5 {
                let y: f64 = half + 0.25 * (1.0 + node);
                let q = from / (y * y);
                let jacobian = 2.0 * from / y.powi(3);
                self.push(q, density * 0.25 * weight * jacobian / (2.0 * (q * self.half_length).powi(2)), stroke);
            }
        }
    }

    /// The source on a layer that extends laterally beyond it.
    pub fn spreading(self, lateral: Option<Lateral>) -> MovingSource {
        MovingSource { lateral, ..self }
    }

    /// Whether heat spreads out of the plane.
    pub(crate) fn spreads(&self) -> bool {
        self.lateral.is_some()
    }

    /// R(s; v), K m2/W: mean temperature over the contact per uniform flux. While sliding its real part, at a real s: one sign of q
    /// stands for both.
    pub fn response(&self, part: Part, s: Complex<f64>, velocity: f64) -> Complex<f64> {
        spread(self.lateral.as_ref(), s, |s| self.response_in_plane(part, s, velocity))
    }

    fn response_in_plane(&self, part: Part, s: Complex<f64>, velocity: f64) -> Complex<f64> {
        let mut sum = Complex::from(0.0);
        for &(q, flash, track) in &self.modes {
            let weight = if part == Part::Flash { flash } else { track };
            if weight != 0.0 {
                sum += self.slab.impedance(s + Complex::new(0.0, q * velocity), q) * weight;
            }
        }
        let steady = self.lateral.is_none() && velocity > 0.0;
        if part == Part::Flash && self.path == Path::Endless && self.slab.base == FarBoundary::Insulated && steady {
            // Mean heating left behind: half of it acts under the contact. It is the residue at q = 0 that the principal
            // value of the integral omits.
            sum += self.half_length / (self.slab.areal_capacity() * velocity);
        }
        sum
    }

    /// Quasi-steady R(0; v) for v > 0, real by symmetry.
    pub fn resistance(&self, velocity: f64) -> f64 {
        self.response(Part::Flash, Complex::from(0.0), velocity).re
    }

    /// Half-length a of the source, m.
    pub(crate) fn half_length(&self) -> f64 {
        self.half_length
    }

    /// The layer under the source.
    pub(crate) fn slab(&self) -> &Slab {
        &self.slab
    }

    /// Whether the source has a track of its own (a stroke).
    pub fn has_track(&self) -> bool {
        matches!(self.path, Path::Stroke { .. })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// l = K = kd = 1 on a layer so high that it is a half-plane at these velocities.
    fn layer(height: f64, base: FarBoundary) -> Slab {
        Slab::bare(height, [1.0, 1.0], base)
    }

    #[test]
    fn a_long_closed_path_is_an_endless_one() {
        let slab = layer(2.0, FarBoundary::Held);
        let closed = MovingSource::new(slab, 1.0, Path::Closed(2000.0));
        let endless = MovingSource::new(slab, 1.0, Path::Endless);
        // The closed path's mean mode, q = 0, is not in the sum: (2a/L) h/K.
        for velocity in [0.1, 1.0, 30.0] {
            let (left, right) = (closed.resistance(velocity) + 2.0 / 2000.0 * 2.0, endless.resistance(velocity));
            assert!((left / right - 1.0).abs() < 3e-5, "{left} {right}");
        }
    }

    #[test]
    fn a_stroke_splits_into_track_and_flash() {
        let slab = layer(1.0, FarBoundary::Held);
        let whole = MovingSource::new(slab, 1.0, Path::Closed(40.0));
        let split = MovingSource::new(slab, 1.0, Path::Stroke { stroke: 3.0, cell: 40.0 });
        let s = Complex::from(0.7);
        let sum = split.response(Part::Flash, s, 0.0) + split.response(Part::Track, s, 0.0);
        let exact = whole.response(Part::Flash, s, 0.0);
        assert!((sum - exact).norm() < 1e-6 * exact.norm(), "{sum} {exact}");
        assert!(split.response(Part::Track, s, 0.0).re > 0.1 * exact.re);
    }
}
