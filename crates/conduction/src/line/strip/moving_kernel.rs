//! Quasi-steady heating of a half-plane by moving sources, as means over pairs of cells.
//!
//! A line source of 1 W/m moving at V > 0 in +x over a half-plane heats its surface, at the distance r ahead of it, to
//! (Carslaw, Jaeger, "Conduction of Heat in Solids", 10.7; Jaeger 1942)
//!
//! ```text
//! k(r) = 1/(pi K) exp(-c r) K0(c |r|),     c = V/(2 kd)
//! ```
//!
//! Its second antiderivative is known in closed form: with u = c r, up to a linear function of u, the second
//! antiderivative of exp(-u) K0(|u|) is
//!
//! ```text
//! g(u) = exp(-u) [2/3 u^2 (K0(|u|) - sign(u) K1(|u|)) + |u| K1(|u|)/3]
//! ```
//!
//! so that means over cells are second differences of g. Where these cancel, for cells much shorter than 1/c, the
//! logarithm is integrated in closed form and the remainder by quadrature.
//!
//! Theory: docs/theory.md, sections 4.3, 4.5.

use elasticity::{Cells, mean_logarithm};
use numerics::quadrature::GAUSS_4;

/// Euler's constant.
const EULER: f64 = 0.577_215_664_901_532_9;

/// `(exp(x) K0(x), exp(x) K1(x))` for x > 0, to rounding: power series up to 2, Chebyshev series of their products with the
/// root of x beyond.
fn scaled_bessel_k(x: f64) -> (f64, f64) {
    if x <= 2.0 {
        // K0 = -(ln(x/2) + gamma) I0 + sum H_n (x/2)^2n/n!^2;  the Wronskian I0 K1 + I1 K0 = 1/x gives K1.
        let y = 0.25 * x * x;
        let (mut i0, mut i1, mut sum) = (0.0, 0.0, 0.0);
        for [square, product, harmonic] in SERIES.iter().rev() {
            i0 = i0 * y + square;
            i1 = i1 * y + product;
            sum = sum * y + harmonic;
        }
        i1 *= 0.5 * x;
        let k0 = -((0.5 * x).ln() + EULER) * i0 + sum;
        let k1 = (1.0 / x - i1 * k0) / i0;
        let scale = x.exp();
        return (scale * k0, scale * k1);
    }
    // Clenshaw's recurrence for both.
    let t = 8.0 / x - 2.0;
    let (mut last, mut before) = ([0.0; 2], [0.0; 2]);
    for pair in CHEBYSHEV.iter().rev() {
        let next = [t * last[0] - before[0] + pair[0], t * last[1] - before[1] + pair[1]];
        (before, last) = (last, next);
    }
    let root = x.sqrt();
    let value = |k: usize| (last[k] - 0.5 * t * before[k]) / root;
    (value(0), value(1))
}

/// Terms of the power series: at 2 the truncation error is below rounding.
const SERIES_TERMS: usize = 13;

/// `1/n!^2, 1/(n! (n+1)!), H_n/n!^2` for n = 0, 1, ...
const SERIES: [[f64; 3]; SERIES_TERMS] = {
    let mut series = [[1.0, 1.0, 0.0]; SERIES_TERMS];
    let (mut n, mut square, mut harmonic) = (1, 1.0, 0.0);
    while n < SERIES_TERMS {
        let order = n as f64;
        square /= order * order;
        harmonic += 1.0 / order;
        series[n] = [square, square / (order + 1.0), harmonic * square];
        n += 1;
    }
    series
};

/// Coefficients of the Chebyshev polynomials of 4/x - 1 in `sqrt(x) exp(x) K0(x)` and `sqrt(x) exp(x) K1(x)` on x >= 2, by
/// interpolation at 60 Chebyshev points in 40 digits; those left out are below 1e-17.
#[expect(clippy::excessive_precision, reason = "as computed")]
const CHEBYSHEV: [[f64; 2]; 23] = [
    [1.220_151_541_032_977_7, 1.360_313_095_242_221_3],
    [-3.144_810_131_196_450_2e-2, 1.039_237_365_768_172_4e-1],
    [1.569_883_885_730_053_3e-3, -2.857_816_859_622_779_2e-3],
    [-1.284_954_958_162_780_2e-4, 1.952_155_184_713_516_2e-4],
    [1.394_981_371_887_650_0e-5, -1.936_197_974_166_083_0e-5],
    [-1.831_755_522_719_119_5e-6, 2.406_484_947_837_217_0e-6],
    [2.766_813_639_445_014_9e-7, -3.501_960_603_087_812_6e-7],
    [-4.660_489_897_687_947_8e-8, 5.741_084_125_450_049_5e-8],
    [8.574_034_017_414_225_3e-9, -1.034_576_246_567_809_7e-8],
    [-1.697_534_509_389_061_4e-9, 2.015_049_755_197_034_7e-9],
    [3.577_397_281_400_328_3e-10, -4.190_354_759_341_925_4e-10],
    [-7.957_489_244_477_396_5e-11, 9.218_315_187_605_314_6e-11],
    [1.855_949_114_954_926_4e-11, -2.129_967_838_427_790_9e-11],
    [-4.514_597_883_374_519_3e-12, 5.139_639_673_482_343_2e-12],
    [1.140_340_588_207_344_1e-12, -1.289_173_960_949_822_9e-12],
    [-2.980_096_923_148_178_4e-13, 3.348_419_666_052_243_1e-13],
    [8.032_890_775_068_374_6e-14, -8.976_705_182_010_146_3e-14],
    [-2.227_513_326_746_296_5e-14, 2.477_154_424_219_598_8e-14],
    [6.340_076_476_276_646_1e-15, -7.019_837_089_214_768_5e-15],
    [-1.848_593_377_920_907_1e-15, 2.038_703_166_239_861_0e-15],
    [5.512_055_999_404_333_5e-16, -6.057_047_270_643_017_7e-16],
    [-1.678_231_125_754_900_6e-16, 1.838_093_575_243_045_5e-16],
    [5.210_391_777_643_554_3e-17, -5.689_462_849_193_648_4e-17],
];

/// Second antiderivatives g(u) and g(-u), u >= 0.
fn second_antiderivatives(u: f64) -> [f64; 2] {
    if u == 0.0 {
        return [1.0 / 3.0; 2];
    }
    let (k0, k1) = scaled_bessel_k(u);
    let (square, rest) = (2.0 / 3.0 * u * u, u * k1 / 3.0);
    [(-2.0 * u).exp() * (square * (k0 - k1) + rest), square * (k0 + k1) + rest]
}

/// Second antiderivative g(u) of exp(-u) K0(|u|).
fn second_antiderivative(u: f64) -> f64 {
    second_antiderivatives(u.abs())[usize::from(u < 0.0)]
}

/// `exp(-u) K0(|u|) + ln |u|`, continuous at 0.
fn less_logarithm(u: f64) -> f64 {
    let x = u.abs();
    if x < 1e-12 {
        return std::f64::consts::LN_2 - EULER;
    }
    let (k0, _) = scaled_bessel_k(x);
    (if u > 0.0 { (-2.0 * u).exp() * k0 } else { k0 }) + x.ln()
}

/// Mean of `exp(-c r) K0(c |r|)` over x in a cell of half-width `alpha` and s in a cell of half-width `beta`, r = x - s
/// with the mean `distance`; c > 0.
///
/// Error below 1e-7, relative to neighbouring values where the value itself vanishes ahead of a fast source.
fn mean_moving_source(distance: f64, alpha: f64, beta: f64, c: f64) -> f64 {
    let (d, a, b) = (c * distance, c * alpha, c * beta);
    if a * b > CLOSED_FORM {
        let g = second_antiderivative;
        return (g(d + a + b) - g(d + a - b) - g(d - a + b) + g(d - a - b)) / (4.0 * a * b);
    }
    let mut smooth = 0.0;
    for (node_a, weight_a) in GAUSS_4 {
        for (node_b, weight_b) in GAUSS_4 {
            smooth += 0.25 * weight_a * weight_b * less_logarithm(d + a * node_a - b * node_b);
        }
    }
    mean_logarithm(d, a, b) + smooth
}

/// Means of `exp(-c r) K0(c |r|)` over all pairs of cells that are symmetric about x = 0, with their workspace.
///
/// A pair and its mirror image have the same distance, so every mean belongs to two pairs; the second antiderivative is
/// evaluated once for all pairs of edges of the same distance, and without a shift for the opposite distance as well.
#[derive(Clone, Debug)]
pub(crate) struct MeanKernel {
    count: usize,
    /// g at the difference of edges i - j, row by row.
    corners: Vec<f64>,
    /// By observed and heated cell, row by row.
    means: Vec<f64>,
}

impl MeanKernel {
    /// Workspace for this number of cells.
    pub(crate) fn new(count: usize) -> MeanKernel {
        MeanKernel { count, corners: vec![0.0; (count + 1) * (count + 1)], means: vec![0.0; count * count] }
    }

    /// Computes the means; heated cells are shifted backwards by `shift` (m).
    pub(crate) fn find(&mut self, cells: &Cells, shift: f64, c: f64) {
        let count = self.count;
        let (edges, rows) = (cells.edges(), count + 1);
        for i in 0..rows {
            for j in 0..rows - i {
                let u = c * (edges[i] - edges[j] + shift);
                if shift != 0.0 {
                    let value = second_antiderivative(u);
                    self.corners[i * rows + j] = value;
                    self.corners[(count - j) * rows + count - i] = value;
                } else if j <= i {
                    let [value, opposite] = second_antiderivatives(u);
                    for (a, b, value) in [(i, j, value), (j, i, opposite)] {
                        self.corners[a * rows + b] = value;
                        self.corners[(count - b) * rows + count - a] = value;
                    }
                }
            }
        }
        for i in 0..count {
            for j in 0..count - i {
                let value = self.of_pair(cells, shift, c, i, j);
                self.means[i * count + j] = value;
                self.means[(count - 1 - j) * count + count - 1 - i] = value;
            }
        }
    }

    fn of_pair(&self, cells: &Cells, shift: f64, c: f64, i: usize, j: usize) -> f64 {
        let (x, widths) = (cells.centres(), cells.widths());
        let product = c * c * widths[i] * widths[j];
        if product <= 4.0 * CLOSED_FORM {
            return mean_moving_source(x[i] - x[j] + shift, 0.5 * widths[i], 0.5 * widths[j], c);
        }
        let corner = |i: usize, j: usize| self.corners[i * (self.count + 1) + j];
        (corner(i + 1, j) - corner(i + 1, j + 1) - corner(i, j) + corner(i, j + 1)) / product
    }

    /// Mean over cell i (observed) and cell j (heated), as last computed.
    pub(crate) fn mean(&self, i: usize, j: usize) -> f64 {
        self.means[i * self.count + j]
    }
}

/// Product of the half-widths in units of 1/c above which second differences retain sufficient digits.
const CLOSED_FORM: f64 = 1e-8;

#[cfg(test)]
mod tests {
    use super::*;
    use exact::reference::{integral_from_singularity, scaled_bessel_k0};
    use std::f64::consts::PI;

    #[test]
    fn bessel_functions_of_the_tables() {
        for x in [1e-9, 0.01, 0.7, 1.99, 2.0, 2.01, 5.0, 300.0] {
            let (k0, k1) = scaled_bessel_k(x);
            assert!((k0 / scaled_bessel_k0(x) - 1.0).abs() < 1e-12, "{x}");
            // K1 = -K0': from the integral of the definition by differences of the scaled function.
            let step = 1e-5 * x;
            let slope = (scaled_bessel_k0(x + step) - scaled_bessel_k0(x - step)) / (2.0 * step);
            assert!((k1 - (k0 - slope)).abs() < 1e-6 * k1, "{x}: {k1} {}", k0 - slope);
        }
        // Abramowitz, Stegun, 9.7.2.
        let (k0, k1) = scaled_bessel_k(1e7);
        let limit = (PI / 2e7).sqrt();
        assert!((k0 / limit - 1.0 + 0.125e-7).abs() < 1e-13 && (k1 / limit - 1.0 - 0.375e-7).abs() < 1e-13);
    }

    #[test]
    fn all_pairs_at_once_are_the_pairs() {
        let cells = Cells::graded(0.3, 12).unwrap();
        let mut source = MeanKernel::new(12);
        for c in [1e-3, 1.0, 50.0] {
            for shift in [0.0, 0.9, -0.9] {
                source.find(&cells, shift, c);
                for (i, j) in (0..12).flat_map(|i| (0..12).map(move |j| (i, j))) {
                    let distance = cells.centres()[i] - cells.centres()[j] + shift;
                    let exact = mean_moving_source(distance, 0.5 * cells.widths()[i], 0.5 * cells.widths()[j], c);
                    let error = (source.mean(i, j) - exact).abs();
                    assert!(error < 1e-7 * exact.abs().max(1e-3), "{c} {shift} {i} {j}: {error:e}");
                }
            }
        }
    }

    #[test]
    fn means_of_pairs_follow_the_kernel_whatever_the_form() {
        let kernel = |u: f64| (-u.abs() - u).exp() * scaled_bessel_k0(u.abs());
        // Cells on either side of the change of form, apart, touching and of very different widths.
        for scale in [1e-5, 0.9e-4, 1.1e-4, 0.03, 2.0] {
            for (distance, alpha, beta) in [(3.0, 1.0, 1.0), (-3.0, 1.0, 1.0), (-1.01, 1.0, 0.01), (40.0, 0.02, 1.0)] {
                // The density of r is a trapezium: integrate by the part of r on each side of its corners.
                let density = |r: f64| {
                    let overlap = (r + beta).min(alpha + distance) - (r - beta).max(distance - alpha);
                    overlap.max(0.0) / (4.0 * alpha * beta)
                };
                let (a, b) = (alpha + beta, (alpha - beta).abs());
                let corners = [distance - a, distance - b, distance + b, distance + a];
                let exact: f64 = corners
                    .windows(2)
                    .filter(|pair| pair[1] > pair[0])
                    .map(|pair| {
                        let half = 0.5 * (pair[1] - pair[0]);
                        integral_from_singularity(half, |y| density(pair[0] + y) * kernel(scale * (pair[0] + y)))
                            + integral_from_singularity(half, |y| density(pair[1] - y) * kernel(scale * (pair[1] - y)))
                    })
                    .sum();
                let computed = mean_moving_source(distance, alpha, beta, scale);
                assert!((computed / exact - 1.0).abs() < 1e-6, "{scale} {distance} {alpha} {beta}: {computed} {exact}");
            }
        }
    }
}
