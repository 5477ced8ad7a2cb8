//! GMRES: linear equations by products with the matrix.
//!
//! Y. Saad, M. H. Schultz, GMRES: a generalized minimal residual algorithm for solving nonsymmetric linear systems, SIAM J. Sci.
//! Stat. Comput. 7 (1986) 856: the combination of `r, A r, A^2 r, ...` with the smallest residual.
//!
//! Theory: docs/theory.md, section 9.5.

use crate::factorization;
use nalgebra::{DMatrix, DVector};

/// Solution with its residual.
#[derive(Clone, Debug)]
pub struct Solved {
    /// x.
    pub solution: Vec<f64>,
    /// `|r - A x| / |r|`; NaN, as the solution is, where a product was not finite.
    pub residual: f64,
    /// Products with A.
    pub products: usize,
}

/// Solves `A x = right` to a residual of `tolerance` relative to `right`, with at most `most` products; norms are those of the
/// vectors times `weights`.
pub fn gmres<E>(
    mut product: impl FnMut(&[f64]) -> Result<Vec<f64>, E>,
    right: &[f64],
    weights: &[f64],
    tolerance: f64,
    most: usize,
) -> Result<Solved, E> {
    let dot = |a: &[f64], b: &[f64]| -> f64 { (0..a.len()).map(|i| (a[i] * weights[i]) * (b[i] * weights[i])).sum() };
    let length = dot(right, right).sqrt();
    let mut solved = Solved { solution: vec![0.0; right.len()], residual: 1.0, products: 0 };
    if length == 0.0 {
        return Ok(Solved { residual: 0.0, ..solved });
    }
    let mut basis: Vec<Vec<f64>> = vec![right.iter().map(|r| r / length).collect()];
    let mut hessenberg = DMatrix::<f64>::zeros(most + 1, most);
    let mut shares = DVector::zeros(0);
    while solved.products < most && solved.residual > tolerance {
        let k = solved.products;
        let mut next = product(&basis[k])?;
        solved.products += 1;
        // Two Gram-Schmidt passes orthogonalise to rounding.
        for _ in 0..2 {
            for (j, direction) in basis.iter().enumerate() {
                let share = dot(&next, direction);
                hessenberg[(j, k)] += share;
                next.iter_mut().zip(direction).for_each(|(n, d)| *n -= share * d);
            }
        }
        let rest = dot(&next, &next).sqrt();
        hessenberg[(k + 1, k)] = rest;
        let small = hessenberg.view((0, 0), (k + 2, k + 1)).into_owned();
        let mut first = DVector::zeros(k + 2);
        first[0] = 1.0;
        let Ok(found) = factorization::least_squares(small.clone(), &first, 1e-14) else {
            // A product that is not finite: no solution.
            return Ok(Solved { solution: vec![f64::NAN; right.len()], residual: f64::NAN, ..solved });
        };
        solved.residual = (first - small * &found).norm();
        shares = found;
        if rest <= 1e-14 * hessenberg.column(k).norm() {
            break;
        }
        basis.push(next.iter().map(|n| n / rest).collect());
    }
    for (direction, share) in basis.iter().zip(shares.iter()) {
        solved.solution.iter_mut().zip(direction).for_each(|(x, d)| *x += length * share * d);
    }
    Ok(solved)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::convert::Infallible;

    fn matrix(size: usize) -> DMatrix<f64> {
        DMatrix::from_fn(size, size, |i, j| if i == j { 1.0 + i as f64 } else { 0.4 * ((2 * i + 3 * j) as f64).sin() })
    }

    #[test]
    fn an_equation_is_solved_in_as_many_products_as_it_has_unknowns() {
        let a = matrix(9);
        let right: Vec<f64> = (0..9).map(|i| (1.3 * f64::from(i)).cos()).collect();
        let weights: Vec<f64> = (1..=9).map(|i| 1.0 / f64::from(i)).collect();
        let product = |x: &[f64]| Ok::<_, Infallible>((&a * DVector::from_column_slice(x)).as_slice().to_vec());
        let Ok(solved) = gmres(product, &right, &weights, 1e-12, 9);
        let exact = a.clone().lu().solve(&DVector::from_vec(right)).unwrap();
        let error = (DVector::from_vec(solved.solution) - exact).amax();
        assert!(error < 1e-10 && solved.products == 9 && solved.residual < 1e-10, "{error:e} {}", solved.products);
    }

    /// I + a matrix of rank 2: three products.
    #[test]
    fn few_directions_take_few_products() {
        let (u, v) = (
            DMatrix::from_fn(40, 2, |i, j| ((i + 7 * j) as f64).sin()),
            DMatrix::from_fn(40, 2, |i, j| ((3 * i + j) as f64).cos()),
        );
        let product = |x: &[f64]| {
            let x = DVector::from_column_slice(x);
            Ok::<_, Infallible>((&x + &u * (v.transpose() * &x)).as_slice().to_vec())
        };
        let right: Vec<f64> = (0..40).map(f64::from).collect();
        let Ok(solved) = gmres(product, &right, &[1.0; 40], 1e-10, 20);
        assert!(solved.products == 3, "{} products, {:e}", solved.products, solved.residual);
        assert!(gmres(product, &[0.0; 40], &[1.0; 40], 1e-10, 20).is_ok_and(|zero| zero.products == 0));
    }
}
