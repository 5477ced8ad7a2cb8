//! Elastic strip of finite height.
//!
//! Theory: docs/theory.md, section 3.3.

use super::half_plane::scale_columns;
use super::{Base, Cells, Compliance, ElasticBody, Material, OutOfRange, StripKernel, fill, mean_logarithm};
use nalgebra::DMatrix;
use numerics::quadrature::gauss_legendre;
use std::f64::consts::PI;

/// Length of the strip along the sliding direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Extent {
    /// Straight and long: tractions act on the contact zone alone.
    Straight,
    /// Closed on itself after this length, in m: at least the width of the contact zone, which it may equal (full periodic
    /// contact). A net shear on a smooth base is balanced by a traction distributed uniformly along the strip.
    Closed(f64),
}

/// Strip of height `h` on a rigid base, translation-invariant along x and so exact in Fourier space.
///
/// With the kernels of [`StripKernel`], `q_k = 2 pi k/P` on a closed strip of length P,
///
/// ```text
/// u(x) = integral p(s) N(x - s) ds + integral q(s) T(x - s) ds
/// N(r) = (1-nu)/(pi G) [ pi h Phi'(0)/P + sum_k Phi(q_k h)/k cos q_k r ]
/// T(r) = 1/(2 pi G) sum_k (1-2nu) Psi(q_k h)/k sin q_k r
/// ```
///
/// The half-plane's part of both sums is taken in closed form, `-ln(2 sin(pi |r|/P))` and `(pi - 2 pi r/P)/2`, and
/// integrated over pairs of cells exactly; the remainder decays like `exp(-2 q h)`. The straight strip is the limit P ->
/// infinity: N, and T less its constant far field `-nu sign(r)/(4 G)` on a smooth base, decay at least like
/// `exp(-0.739 |r|/h)` (the root of cos y = y, bonded and incompressible; faster otherwise), so that a period of the contact
/// width plus 40 h approximates it to 1e-12 of the half-plane's compliance. So does it for a longer closed strip, whose T has
/// the far field of its own length.
///
/// Unlike that of the half-plane, the displacement is absolute: relative to the held base.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Strip {
    material: Material,
    height: f64,
    base: Base,
    extent: Extent,
}

/// Largest contact width over the height; below it the strip needs a hundred thousand Fourier modes.
pub(super) const FLATTEST_ELASTIC: f64 = 2e4;
/// Fourier modes taken together in one matrix product.
const MODES_AT_ONCE: usize = 512;

impl Strip {
    /// Strip of the given height in m, positive.
    pub fn new(material: Material, height: f64, base: Base, extent: Extent) -> Result<Self, OutOfRange> {
        OutOfRange::unless(height.is_finite() && height > 0.0, "strip height", height, "positive, in m")?;
        if let Extent::Closed(length) = extent {
            OutOfRange::unless(length.is_finite() && length > 0.0, "strip length", length, "positive, in m")?;
        }
        Ok(Self { material, height, base, extent })
    }

    /// Compliance on the given cells; an error where the strip is shorter than the contact zone
    /// or too flat.
    pub(crate) fn try_compliance(&self, cells: &Cells) -> Result<Compliance, OutOfRange> {
        let width = 2.0 * cells.half_width();
        OutOfRange::unless(
            self.height * FLATTEST_ELASTIC >= width,
            "strip height",
            self.height,
            "at least a twenty thousandth of the contact's width",
        )?;
        let length = match self.extent {
            Extent::Straight => f64::INFINITY,
            Extent::Closed(length) => length,
        };
        // Rounding of the width must not refuse full periodic contact.
        let requirement = "at least the width of the contact zone";
        OutOfRange::unless(length >= width * (1.0 - 1e-12), "strip length", length, requirement)?;
        // Length of unloaded strip, in heights, after which its surface no longer responds to the load.
        Ok(self.on_period(cells, length.max(width), (width + 40.0 * self.height).min(length.max(width))))
    }

    /// Compliance of a strip that is closed after `length` m, from the Fourier sum with the period `period` m.
    fn on_period(&self, cells: &Cells, length: f64, period: f64) -> Compliance {
        let (x, c) = (cells.centres(), cells.widths());
        let (g, nu) = (self.material.shear_modulus(), self.material.poissons_ratio());
        let kernel = StripKernel::new(self.base, nu);
        let logarithm = PeriodicLogarithm::new(cells, period);
        // Long waves let a layer on a smooth base expand sideways; all round it cannot on the mean.
        let sideways = kernel.normal_at_zero() - StripKernel::new(Base::Bonded, nu).normal_at_zero();
        let uniform = PI * self.height / period * kernel.normal_at_zero() - PI * self.height / length * sideways;
        let mut normal = fill(cells.count(), 1.0, |i, j| uniform + logarithm.mean(i, j));
        // Mean of (sign(r) - 2 r/P)/2, and the far field that the period cuts off.
        let far_field = kernel.shear_at_zero() * (1.0 - period / length);
        let squeezed = 1.0 - 2.0 * nu;
        let mut shear = fill(cells.count(), -1.0, |i, j| {
            let sign = if i == j { 0.0 } else { 1.0 };
            PI * (0.5 * squeezed * sign - (squeezed - far_field) * (x[i] - x[j]) / period)
        });
        self.add_remainder(cells, period, &kernel, &mut normal, &mut shear);
        Compliance {
            normal: scale_columns(normal, (1.0 - nu) / (PI * g), c),
            shear: scale_columns(shear, 1.0 / (2.0 * PI * g), c),
        }
    }

    /// Adds the sums over `(Phi - 1) cos(q_k r)/k` and `(1-2nu) (Psi - 1) sin(q_k r)/k`, cell means, in blocks of modes: a
    /// product of two N x (2 modes) matrices each.
    fn add_remainder(
        &self,
        cells: &Cells,
        period: f64,
        kernel: &StripKernel,
        normal: &mut DMatrix<f64>,
        shear: &mut DMatrix<f64>,
    ) {
        let count = cells.count();
        // Value of `q h` beyond which `Phi - 1` is below 1e-16.
        let last = (23.0 * period / (2.0 * PI * self.height)).ceil() as usize;
        let mut first = 1;
        while first <= last {
            let modes = MODES_AT_ONCE.min(last + 1 - first);
            // Columns: cosines, then sines, of the modes of this block, averaged over the cells.
            let mut wave = DMatrix::zeros(count, 2 * modes);
            let mut normal_wave = DMatrix::zeros(2 * modes, count);
            let mut shear_wave = DMatrix::zeros(2 * modes, count);
            for m in 0..modes {
                let k = (first + m) as f64;
                let q = 2.0 * PI * k / period;
                let normal_weight = kernel.normal_remainder(q * self.height) / k;
                let shear_weight = kernel.shear_remainder(q * self.height) / k;
                for (i, (&x, &c)) in cells.centres().iter().zip(cells.widths()).enumerate() {
                    let (sine, cosine) = (q * x).sin_cos();
                    let mean = sinc(0.5 * q * c);
                    let (sine, cosine) = (mean * sine, mean * cosine);
                    wave[(i, m)] = cosine;
                    wave[(i, modes + m)] = sine;
                    normal_wave[(m, i)] = normal_weight * cosine;
                    normal_wave[(modes + m, i)] = normal_weight * sine;
                    // sin(q (x_i - x_j)) = sin_i cos_j - cos_i sin_j
                    shear_wave[(m, i)] = -shear_weight * sine;
                    shear_wave[(modes + m, i)] = shear_weight * cosine;
                }
            }
            normal.gemm(1.0, &wave, &normal_wave, 1.0);
            shear.gemm(1.0, &wave, &shear_wave, 1.0);
            first += modes;
        }
    }
}

impl ElasticBody for Strip {
    /// # Panics
    /// Where [`Strip::try_compliance`] reports an error.
    fn compliance(&self, cells: &Cells) -> Compliance {
        self.try_compliance(cells).expect("a strip neither too flat nor too short")
    }
}

fn sinc(x: f64) -> f64 {
    if x.abs() < 1e-4 { 1.0 - x * x / 6.0 } else { x.sin() / x }
}

/// Mean over pairs of cells of `-ln(2 sin(pi |r|/P)) = sum_k cos(2 pi k r/P)/k`, |r| <= P.
///
/// `-ln` of the distance to the load and to its two nearest images in closed form; the images beyond are the smooth
/// series `sum_k (zeta(2k) - 1) (r/P)^2k/k`, taken by Gauss quadrature on each cell.
struct PeriodicLogarithm<'a> {
    cells: &'a Cells,
    period: f64,
    nodes: Vec<(f64, f64)>,
    series: Vec<f64>,
}

impl<'a> PeriodicLogarithm<'a> {
    fn new(cells: &'a Cells, period: f64) -> Self {
        let widest = cells.widths().iter().copied().fold(0.0, f64::max);
        // The series is singular at |r| = 2P, one period outside the range: with n nodes on a cell of width c the
        // quadrature error is of order (c/(8P))^2n for small cells, 6^-2n for one cell of length P.
        let nodes = gauss_legendre(if 16.0 * widest < period { 4 } else { 12 });
        // The terms fall like (r/2P)^2k: 28 of them in full periodic contact, few where the period is long.
        let terms = (40.0 / (period / cells.half_width()).powi(2).ln()).ceil() as i32;
        let series = (1..=terms).map(|k| zeta_less_one(2 * k) / f64::from(k)).collect();
        Self { cells, period, nodes, series }
    }

    fn mean(&self, i: usize, j: usize) -> f64 {
        let (x, c) = (self.cells.centres(), self.cells.widths());
        let (alpha, beta) = (0.5 * c[i], 0.5 * c[j]);
        let r = x[i] - x[j];
        let period = self.period;
        let singular = mean_logarithm(r, alpha, beta)
            + mean_logarithm(period - r, alpha, beta)
            + mean_logarithm(period + r, alpha, beta);
        let mut smooth = 0.0;
        for &(node_i, weight_i) in &self.nodes {
            for &(node_j, weight_j) in &self.nodes {
                let y = ((r + alpha * node_i - beta * node_j) / period).powi(2);
                let tail = self.series.iter().rev().fold(0.0, |sum, coefficient| (sum + coefficient) * y);
                smooth += 0.25 * weight_i * weight_j * tail;
            }
        }
        singular + 3.0 * period.ln() - (2.0 * PI).ln() + smooth
    }
}

/// `zeta(s) - 1` for s >= 2, by the sum to 49 and Euler-Maclaurin beyond; error below 1e-16.
fn zeta_less_one(s: i32) -> f64 {
    let cut: f64 = 50.0;
    let real = f64::from(s);
    let power = cut.powi(-s);
    // B_2/2!, B_4/4!, B_6/6! with the derivatives of x^-s.
    let third = real * (real + 1.0) * (real + 2.0);
    let fifth = third * (real + 3.0) * (real + 4.0);
    let corrections = real / (12.0 * cut) - third / (720.0 * cut.powi(3)) + fifth / (30240.0 * cut.powi(5));
    let tail = power * (cut / (real - 1.0) + 0.5 + corrections);
    (2..50).rev().map(|n| f64::from(n).powi(-s)).sum::<f64>() + tail
}

#[cfg(test)]
mod tests;
