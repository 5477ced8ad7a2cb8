//! Quasi-steady heating of a half-plane by moving sources, as means over pairs of cells.
//!
//! A line source of 1 W/m that moves at V > 0 in +x over a half-plane heats its surface, at the distance r ahead of it,
//! by (Carslaw, Jaeger, "Conduction of Heat in Solids", 10.7; Jaeger 1942)
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
//! logarithm is integrated in closed form and the rest by quadrature.

use crate::elastic::{Cells, mean_logarithm};
use std::f64::consts::PI;

/// Euler's constant.
const EULER: f64 = 0.577_215_664_901_532_9;

/// `(exp(x) K0(x), exp(x) K1(x))` for x > 0, to rounding: power series up to 2, Steed's continued fraction beyond.
pub fn scaled_bessel_k(x: f64) -> (f64, f64) {
    if x <= 2.0 {
        // K0 = -(ln(x/2) + gamma) I0 + sum H_n (x/2)^2n/n!^2;  the Wronskian I0 K1 + I1 K0 = 1/x gives K1.
        let y = 0.25 * x * x;
        let (mut term, mut harmonic, mut i0, mut i1, mut sum) = (1.0, 0.0, 1.0, 1.0, 0.0);
        for n in 1..30 {
            let n = f64::from(n);
            term *= y / (n * n);
            harmonic += 1.0 / n;
            i0 += term;
            i1 += term / (n + 1.0);
            sum += harmonic * term;
            if term < 1e-18 {
                break;
            }
        }
        i1 *= 0.5 * x;
        let k0 = -((0.5 * x).ln() + EULER) * i0 + sum;
        let k1 = (1.0 / x - i1 * k0) / i0;
        let scale = x.exp();
        return (scale * k0, scale * k1);
    }
    // Numerical Recipes, section 6.7, for order 0.
    let mut b = 2.0 * (1.0 + x);
    let mut d = 1.0 / b;
    let (mut h, mut delta) = (d, d);
    let (mut q1, mut q2) = (0.0, 1.0);
    let a1 = 0.25;
    let mut c = a1;
    let mut q = c;
    let mut a = -a1;
    let mut s = 1.0 + q * delta;
    for i in 2..500 {
        a -= 2.0 * f64::from(i - 1);
        c = -a * c / f64::from(i);
        let next = (q1 - b * q2) / a;
        q1 = q2;
        q2 = next;
        q += c * next;
        b += 2.0;
        d = 1.0 / (b + a * d);
        delta *= b * d - 1.0;
        h += delta;
        let change = q * delta;
        s += change;
        if (change / s).abs() < 1e-17 {
            break;
        }
    }
    let k0 = (PI / (2.0 * x)).sqrt() / s;
    (k0, k0 * (x + 0.5 - a1 * h) / x)
}

/// g(u) of the module.
fn second_antiderivative(u: f64) -> f64 {
    let x = u.abs();
    if x == 0.0 {
        return 1.0 / 3.0;
    }
    let (k0, k1) = scaled_bessel_k(x);
    if u > 0.0 {
        (-2.0 * x).exp() * (2.0 / 3.0 * x * x * (k0 - k1) + x * k1 / 3.0)
    } else {
        2.0 / 3.0 * x * x * (k0 + k1) + x * k1 / 3.0
    }
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

/// Four-point Gauss-Legendre rule on [-1, 1].
const GAUSS: [(f64, f64); 4] = [
    (-0.861_136_311_594_052_6, 0.347_854_845_137_453_85),
    (-0.339_981_043_584_856_3, 0.652_145_154_862_546_1),
    (0.339_981_043_584_856_3, 0.652_145_154_862_546_1),
    (0.861_136_311_594_052_6, 0.347_854_845_137_453_85),
];

/// Mean of `exp(-c r) K0(c |r|)` over x in a cell of half-width `alpha` and s in a cell of half-width `beta`, r = x - s
/// with the mean `distance`; c > 0.
///
/// Relative error below 1e-7, of neighbouring values rather than of a value that vanishes ahead of a fast source.
pub fn mean_moving_source(distance: f64, alpha: f64, beta: f64, c: f64) -> f64 {
    let (d, a, b) = (c * distance, c * alpha, c * beta);
    if a * b > CLOSED_FORM {
        let g = second_antiderivative;
        return (g(d + a + b) - g(d + a - b) - g(d - a + b) + g(d - a - b)) / (4.0 * a * b);
    }
    let mut smooth = 0.0;
    for (node_a, weight_a) in GAUSS {
        for (node_b, weight_b) in GAUSS {
            smooth += 0.25 * weight_a * weight_b * less_logarithm(d + a * node_a - b * node_b);
        }
    }
    mean_logarithm(d, a, b) + smooth
}

/// Means over all pairs of cells at one velocity: the second antiderivative is evaluated once for every pair of edges.
pub struct MovingSource<'a> {
    cells: &'a Cells,
    shift: f64,
    c: f64,
    /// g at the difference of edges i - j, row by row.
    corners: Vec<f64>,
}

impl MovingSource<'_> {
    /// Heated cells stand `shift` behind their place.
    pub fn new(cells: &Cells, shift: f64, c: f64) -> MovingSource<'_> {
        let edges = cells.edges();
        let pairs = edges.iter().flat_map(|x| edges.iter().map(move |s| x - s));
        let corners = pairs.map(|r| second_antiderivative(c * (r + shift))).collect();
        MovingSource { cells, shift, c, corners }
    }

    /// Mean of `exp(-c r) K0(c |r|)` over cell i (answering) and cell j (heated).
    pub fn mean(&self, i: usize, j: usize) -> f64 {
        let (x, widths) = (self.cells.centres(), self.cells.widths());
        let product = self.c * self.c * widths[i] * widths[j];
        if product <= 4.0 * CLOSED_FORM {
            return mean_moving_source(x[i] - x[j] + self.shift, 0.5 * widths[i], 0.5 * widths[j], self.c);
        }
        let corner = |i: usize, j: usize| self.corners[i * (widths.len() + 1) + j];
        (corner(i + 1, j) - corner(i + 1, j + 1) - corner(i, j) + corner(i, j + 1)) / product
    }
}

/// Product of the half-widths in units of 1/c above which second differences have digits left.
const CLOSED_FORM: f64 = 1e-8;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::verification::reference::{band_mean, integral_from_singularity, scaled_bessel_k0};

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
    fn means_of_one_cell_are_the_band_of_jaeger() {
        for peclet in [1e-6, 1e-3, 0.1, 1.0, 10.0, 1e4] {
            let mean = 2.0 / PI * mean_moving_source(0.0, 1.0, 1.0, peclet);
            assert!((mean / band_mean(peclet, None) - 1.0).abs() < 1e-8, "{peclet}: {mean}");
        }
    }

    #[test]
    fn all_pairs_at_once_are_the_pairs() {
        let cells = Cells::graded(0.3, 12).unwrap();
        for c in [1e-3, 1.0, 50.0] {
            let source = MovingSource::new(&cells, 0.0, c);
            for (i, j) in [(0, 0), (0, 11), (11, 0), (3, 4), (7, 2)] {
                let distance = cells.centres()[i] - cells.centres()[j];
                let exact = mean_moving_source(distance, 0.5 * cells.widths()[i], 0.5 * cells.widths()[j], c);
                assert!((source.mean(i, j) - exact).abs() < 1e-7 * exact.abs().max(1e-3), "{c} {i} {j}");
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
