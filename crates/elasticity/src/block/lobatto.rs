//! Hierarchical shape functions of one variable on the reference interval [-1, 1], and their exact integrals.
//!
//! The functions are the two linear vertex functions and the integrated Legendre polynomials (Lobatto functions)
//!
//! ```text
//! N_0 = (1 - xi)/2,   N_1 = (1 + xi)/2,   N_k = sqrt((2k - 1)/2) int_{-1}^{xi} P_{k-1},   k = 2 .. order
//! ```
//!
//! N_k vanishes at both ends for k >= 2, and the N_k' with k >= 2 are orthonormal. A space of higher order contains
//! every function of a lower one, so the matrices of a lower order are the leading blocks of those of a higher one.
//! Source: B. Szabo, I. Babuska, Finite Element Analysis, Wiley 1991, chapter 6.
//!
//! Theory: docs/theory.md, section 3.4.

use nalgebra::DMatrix;

/// Highest polynomial order of a shape function that the block accepts. Order 8 is the practical limit; the orders
/// above it exist for reference solutions.
pub(crate) const MAXIMUM_ORDER: usize = 12;

/// Exact matrices of one variable on [-1, 1], all (order + 1) x (order + 1), rows and columns in the order of the
/// shape functions.
#[derive(Clone, Debug)]
pub(crate) struct ReferenceMatrices {
    /// Mass matrix, int N_i N_j.
    pub mass: DMatrix<f64>,
    /// Stiffness matrix, int N_i' N_j'.
    pub stiffness: DMatrix<f64>,
    /// Mixed matrix, int N_i' N_j.
    pub mixed: DMatrix<f64>,
}

/// Shape function k as at most two Legendre polynomials (degree, coefficient).
fn legendre_terms(k: usize) -> [(usize, f64); 2] {
    match k {
        0 => [(0, 0.5), (1, -0.5)],
        1 => [(0, 0.5), (1, 0.5)],
        _ => {
            let scale = 1.0 / (2.0 * (2 * k - 1) as f64).sqrt();
            [(k, scale), (k - 2, -scale)]
        }
    }
}

/// Derivative of shape function k, a single Legendre polynomial (degree, coefficient).
fn derivative_term(k: usize) -> (usize, f64) {
    match k {
        0 => (0, -0.5),
        1 => (0, 0.5),
        _ => (k - 1, ((2 * k - 1) as f64 / 2.0).sqrt()),
    }
}

/// int P_m P_n over [-1, 1].
fn legendre_product(m: usize, n: usize) -> f64 {
    if m == n { 2.0 / (2 * m + 1) as f64 } else { 0.0 }
}

impl ReferenceMatrices {
    /// The matrices up to `order`, from the orthogonality of the Legendre polynomials: no quadrature.
    pub(crate) fn new(order: usize) -> Self {
        let n = order + 1;
        let mass = DMatrix::from_fn(n, n, |i, j| {
            let mut sum = 0.0;
            for (m, a) in legendre_terms(i) {
                for (l, b) in legendre_terms(j) {
                    sum += a * b * legendre_product(m, l);
                }
            }
            sum
        });
        let stiffness = DMatrix::from_fn(n, n, |i, j| {
            let ((m, a), (l, b)) = (derivative_term(i), derivative_term(j));
            a * b * legendre_product(m, l)
        });
        let mixed = DMatrix::from_fn(n, n, |i, j| {
            let (m, a) = derivative_term(i);
            legendre_terms(j).iter().map(|&(l, b)| a * b * legendre_product(m, l)).sum()
        });
        Self { mass, stiffness, mixed }
    }
}

/// Legendre polynomials P_0 .. P_{values.len() - 1} at `xi`.
fn legendre(xi: f64, values: &mut [f64]) {
    let mut before = 0.0;
    let mut current = 1.0;
    for (n, value) in values.iter_mut().enumerate() {
        *value = current;
        let next = ((2 * n + 1) as f64 * xi * current - n as f64 * before) / (n + 1) as f64;
        before = current;
        current = next;
    }
}

/// Values of the shape functions 0 .. values.len() - 1 at `xi`.
pub(crate) fn shape_values(xi: f64, values: &mut [f64]) {
    let mut polynomials = [0.0; MAXIMUM_ORDER + 1];
    legendre(xi, &mut polynomials[..values.len().max(2)]);
    for (k, value) in values.iter_mut().enumerate() {
        *value = legendre_terms(k).iter().map(|&(degree, coefficient)| coefficient * polynomials[degree]).sum();
    }
}

/// Derivatives with respect to `xi` of the shape functions 0 .. values.len() - 1 at `xi`.
pub(crate) fn shape_derivatives(xi: f64, values: &mut [f64]) {
    let mut polynomials = [0.0; MAXIMUM_ORDER + 1];
    legendre(xi, &mut polynomials[..values.len().max(2)]);
    for (k, value) in values.iter_mut().enumerate() {
        let (degree, coefficient) = derivative_term(k);
        *value = coefficient * polynomials[degree];
    }
}
