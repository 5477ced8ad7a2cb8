//! Relaxation of the pressure under a wearing flat punch on the half-plane.
//!
//! Theory: docs/theory.md, section 10.

use nalgebra::{DMatrix, DVector};
use numerics::factorization;
use std::f64::consts::PI;

/// Pressure under a flat rigid punch whose contact wears in proportion to pressure and sliding distance, starting from the
/// unworn punch `p = 2 pm/(pi sqrt(1 - x^2))`:
///
/// ```text
/// p(x, tau)/pm = 1 + sum_n c_n phi_n(x) exp(-tau/lambda_n),   tau = k s E*/a,
/// -(2/pi) integral phi(t) ln|x - t| dt = lambda phi(x) + constant,   integral phi dx = 0,   x in half-widths
/// ```
///
/// Galerkin with Legendre polynomials, for which the logarithm has the closed form
/// `-(2/pi) iint P_m P_n ln|x - t| = (16/pi)/[(1 - (m-n)^2)(m+n)(m+n+2)]` for even m + n > 0, else 0 (from
/// `PV int P_n/(x-t) dt = 2 Q_n` and the integrals of `P_m Q_n`). The mean constraint leaves out P_0. Eigenfunctions
/// have `r ln r` terms at the edges, so eigenvalues converge like order^-6 or so; the relaxed pressure at
/// `tau >= 0.1` to 1e-6 with 150 even polynomials.
///
/// Source of the problem: L. A. Galin, I. G. Goryacheva, Axisymmetric contact problem of the theory of elasticity in
/// the presence of wear, J. Appl. Math. Mech. 41 (1977); this plane case by the same argument.
#[derive(Clone, Debug)]
pub struct GalinRelaxation {
    /// Eigenvalues of the even modes, descending.
    even: Vec<f64>,
    /// Eigenvalues of the odd modes, descending.
    odd: Vec<f64>,
    /// Column i: Legendre coefficients (P_2, P_4, ...) of the even mode i times its amplitude at tau = 0.
    modes: DMatrix<f64>,
}

impl GalinRelaxation {
    /// Solution with the given number of polynomials of each parity.
    pub fn new(polynomials: usize) -> Self {
        let (even, vectors) = eigen(polynomials, 2);
        let (odd, _) = eigen(polynomials, 1);
        // Moments of the unworn pressure: (2/pi) int P_2k/sqrt(1-x^2) dx = 2 [(2k over k)/4^k]^2.
        let mut central = 1.0;
        let moments = DVector::from_fn(polynomials, |i, _| {
            let k = (i + 1) as f64;
            central *= (2.0 * k - 1.0) / (2.0 * k);
            2.0 * central * central * norm(2 * (i + 1))
        });
        let amplitudes = vectors.transpose() * moments;
        let mut modes = vectors;
        for (mut column, amplitude) in modes.column_iter_mut().zip(amplitudes.iter()) {
            column *= *amplitude;
        }
        // From normalised to plain Legendre coefficients.
        for (i, mut row) in modes.row_iter_mut().enumerate() {
            row *= norm(2 * (i + 1));
        }
        Self { even, odd, modes }
    }

    /// The given number of largest eigenvalues `lambda = Lambda E*/a`, odd and even modes, descending.
    pub fn eigenvalues(&self, count: usize) -> Vec<f64> {
        let mut all: Vec<f64> = self.even.iter().chain(&self.odd).copied().collect();
        all.sort_by(|a, b| b.total_cmp(a));
        all.truncate(count);
        all
    }

    /// `p(x, tau)/pm`, x in half-widths, tau > 0.
    pub fn pressure(&self, tau: f64, x: f64) -> f64 {
        let coefficients = self.coefficients(tau);
        let legendre = legendre(x, 2 * coefficients.len());
        1.0 + coefficients.iter().enumerate().map(|(i, c)| c * legendre[2 * i + 2]).sum::<f64>()
    }

    /// Mean of `p/pm` over `left <= x <= right`, in half-widths.
    pub fn mean_pressure(&self, tau: f64, left: f64, right: f64) -> f64 {
        let coefficients = self.coefficients(tau);
        let (l, r) = (legendre(left, 2 * coefficients.len() + 1), legendre(right, 2 * coefficients.len() + 1));
        // (2n+1) P_n is the derivative of P_{n+1} - P_{n-1}.
        let primitive = |p: &[f64], n: usize| (p[n + 1] - p[n - 1]) / (2 * n + 1) as f64;
        let integral: f64 = coefficients
            .iter()
            .enumerate()
            .map(|(i, c)| c * (primitive(&r, 2 * i + 2) - primitive(&l, 2 * i + 2)))
            .sum();
        1.0 + integral / (right - left)
    }

    fn coefficients(&self, tau: f64) -> Vec<f64> {
        let decay = DVector::from_iterator(self.even.len(), self.even.iter().map(|l| (-tau / l).exp()));
        (&self.modes * decay).as_slice().to_vec()
    }
}

/// `sqrt((2n+1)/2)`: factor that normalises P_n.
fn norm(n: usize) -> f64 {
    (n as f64 + 0.5).sqrt()
}

/// Eigenvalues, descending, and normalised coefficient vectors for P_first, P_(first+2), ...
fn eigen(polynomials: usize, first: usize) -> (Vec<f64>, DMatrix<f64>) {
    let matrix = DMatrix::from_fn(polynomials, polynomials, |i, j| {
        let (m, n) = ((first + 2 * i) as f64, (first + 2 * j) as f64);
        let kernel = 16.0 / PI / ((1.0 - (m - n).powi(2)) * (m + n) * (m + n + 2.0));
        kernel * norm(first + 2 * i) * norm(first + 2 * j)
    });
    let eigen = factorization::symmetric_eigen(matrix).expect("a function of the number of polynomials alone");
    let mut order: Vec<usize> = (0..polynomials).collect();
    order.sort_by(|&a, &b| eigen.eigenvalues[b].total_cmp(&eigen.eigenvalues[a]));
    (order.iter().map(|&i| eigen.eigenvalues[i]).collect(), eigen.eigenvectors.select_columns(&order))
}

/// Legendre polynomials P_0 ... P_n at x.
fn legendre(x: f64, n: usize) -> Vec<f64> {
    let mut values = vec![1.0, x];
    for k in 1..n {
        let k_real = k as f64;
        values.push(((2.0 * k_real + 1.0) * x * values[k] - k_real * values[k - 1]) / (k_real + 1.0));
    }
    values
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn published_eigenvalues() {
        let computed = GalinRelaxation::new(60).eigenvalues(6);
        for (value, published) in computed.iter().zip([0.99695, 0.57915, 0.39022, 0.30172, 0.24213, 0.20442]) {
            assert!((value - published).abs() < 6e-6, "{value} {published}");
        }
    }

    #[test]
    fn published_relaxation() {
        let galin = GalinRelaxation::new(150);
        for (tau, published) in [
            (0.1, [0.68955, 0.80728, 1.6754]),
            (0.5, [0.82042, 0.94553, 1.2791]),
            (1.0, [0.91408, 0.99292, 1.0931]),
            (3.0, [0.99692, 1.00022, 1.0025]),
        ] {
            for (x, value) in [0.0, 0.5, 0.9].into_iter().zip(published) {
                let digits = if x == 0.9 { 6e-5 } else { 6e-6 };
                let computed = galin.pressure(tau, x);
                assert!((computed - value).abs() < digits, "tau {tau} x {x}: {computed} {value}");
            }
        }
    }
}
