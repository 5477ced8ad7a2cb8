//! Factorisations of nalgebra with checked entries and bounded iterations.
//!
//! The iterations behind singular values, eigenvalues and Schur forms may not terminate on a matrix with an entry that is
//! not finite. Every factorisation of the library is therefore called through this module (or, where it is one of faer in
//! place, after [`check`]): the entries are tested first, and the iterations are bounded.

use super::interruption::checkpoint;
use super::maximum::all_finite;
use nalgebra::linalg::{LU, SVD, Schur, SymmetricEigen};
use nalgebra::{Cholesky, Complex, Const, DMatrix, DVector, Dyn, OMatrix, SMatrix, SVector};
use nalgebra::{DefaultAllocator, Dim, DimMin, allocator::Allocator};
use std::fmt;

/// Limit of iterations of an eigenvalue or singular value problem per row; two or three are usual.
const ITERATIONS_PER_ROW: usize = 100;

/// Reason why a matrix has no factorisation.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Unfactorable {
    /// An entry is not finite.
    NotFinite {
        /// Its row.
        row: usize,
        /// Its column.
        column: usize,
        /// Its value.
        value: f64,
    },
    /// The matrix has no entries.
    Empty,
    /// The matrix is singular, or not positive definite.
    Singular,
    /// The eigenvalue iteration did not converge.
    NotConverged,
}

impl fmt::Display for Unfactorable {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Unfactorable::NotFinite { row, column, value } => {
                write!(formatter, "row {row}, column {column} of the matrix is {value}, no finite number")
            }
            Unfactorable::Empty => formatter.write_str("the matrix has no entries"),
            Unfactorable::Singular => formatter.write_str("the matrix is singular, or not positive definite"),
            Unfactorable::NotConverged => {
                write!(formatter, "the eigenvalue iteration did not end in {ITERATIONS_PER_ROW} iterations per row")
            }
        }
    }
}

impl std::error::Error for Unfactorable {}

/// Tests the entries of a matrix of `rows` rows, stored by columns.
///
/// # Errors
/// [`Unfactorable::NotFinite`] with the first entry that is not finite.
pub fn check(entries: &[f64], rows: usize) -> Result<(), Unfactorable> {
    checkpoint();
    if all_finite(entries) {
        return Ok(());
    }
    let index = entries.iter().position(|entry| !entry.is_finite()).unwrap_or(0);
    let rows = rows.max(1);
    Err(Unfactorable::NotFinite { row: index % rows, column: index / rows, value: entries[index] })
}

fn checked(matrix: DMatrix<f64>) -> Result<DMatrix<f64>, Unfactorable> {
    check(matrix.as_slice(), matrix.nrows()).map(|()| matrix)
}

/// [`checked`] for the iterations behind eigenvalues, which panic on an empty matrix.
fn checked_with_entries(matrix: DMatrix<f64>) -> Result<DMatrix<f64>, Unfactorable> {
    if matrix.is_empty() { Err(Unfactorable::Empty) } else { checked(matrix) }
}

/// LU factors with partial pivoting.
///
/// # Errors
/// [`Unfactorable::NotFinite`]; singularity is detected by `solve`.
pub fn lu(matrix: DMatrix<f64>) -> Result<LU<f64, Dyn, Dyn>, Unfactorable> {
    checked(matrix).map(LU::new)
}

/// Overwrites `right` with the solution of `matrix x = right`.
///
/// # Errors
/// A matrix that is not finite or singular, or a solution that is not finite.
pub fn solve_mut(matrix: DMatrix<f64>, right: &mut DVector<f64>) -> Result<(), Unfactorable> {
    let solved = lu(matrix)?.solve_mut(right);
    if solved && all_finite(right.as_slice()) { Ok(()) } else { Err(Unfactorable::Singular) }
}

/// Solution of a small system whose size is a constant.
pub fn solve<const N: usize>(
    matrix: &SMatrix<f64, N, N>,
    right: &SVector<f64, N>,
) -> Result<SVector<f64, N>, Unfactorable>
where
    Const<N>: DimMin<Const<N>, Output = Const<N>>,
{
    check(matrix.as_slice(), N)?;
    LU::new(*matrix).solve(right).filter(|solution| all_finite(solution.as_slice())).ok_or(Unfactorable::Singular)
}

/// Inverse.
pub fn inverse(matrix: DMatrix<f64>) -> Result<DMatrix<f64>, Unfactorable> {
    checked(matrix)?.try_inverse().ok_or(Unfactorable::Singular)
}

/// Lower Cholesky factor.
pub fn cholesky<D: Dim>(matrix: OMatrix<f64, D, D>) -> Result<Cholesky<f64, D>, Unfactorable>
where
    DefaultAllocator: Allocator<D, D>,
{
    check(matrix.as_slice(), matrix.nrows())?;
    Cholesky::new(matrix).ok_or(Unfactorable::Singular)
}

/// Least-squares solution of `matrix x = right` by singular values; those below `smallest` of the largest count as 0.
///
/// # Errors
/// A matrix or right-hand side that is not finite, or singular values that are not found.
pub(crate) fn least_squares(
    matrix: DMatrix<f64>,
    right: &DVector<f64>,
    smallest: f64,
) -> Result<DVector<f64>, Unfactorable> {
    check(right.as_slice(), right.nrows())?;
    let limit = limit(&matrix);
    let factors =
        SVD::try_new(checked(matrix)?, true, true, 5.0 * f64::EPSILON, limit).ok_or(Unfactorable::NotConverged)?;
    factors.solve(right, smallest).map_err(|_| Unfactorable::NotConverged)
}

/// Eigenvalues and eigenvectors of a symmetric matrix.
///
/// # Errors
/// A matrix without entries or not finite, or eigenvalues that are not found.
pub fn symmetric_eigen(matrix: DMatrix<f64>) -> Result<SymmetricEigen<f64, Dyn>, Unfactorable> {
    let limit = limit(&matrix);
    SymmetricEigen::try_new(checked_with_entries(matrix)?, f64::EPSILON, limit).ok_or(Unfactorable::NotConverged)
}

/// [`symmetric_eigen`], with NaN throughout on failure. For operators of a body that are built from many such problems: the
/// end of initialisation tests that a scene's outputs are finite.
pub fn symmetric_eigen_or_nan(matrix: DMatrix<f64>) -> SymmetricEigen<f64, Dyn> {
    let size = matrix.nrows();
    symmetric_eigen(matrix).unwrap_or_else(|_| SymmetricEigen {
        eigenvectors: DMatrix::from_element(size, size, f64::NAN),
        eigenvalues: DVector::from_element(size, f64::NAN),
    })
}

/// Eigenvalues of a real matrix.
///
/// # Errors
/// A matrix without entries or not finite, or eigenvalues that are not found.
pub fn eigenvalues(matrix: DMatrix<f64>) -> Result<DVector<Complex<f64>>, Unfactorable> {
    let limit = limit(&matrix);
    let schur = Schur::try_new(checked_with_entries(matrix)?, f64::EPSILON, limit).ok_or(Unfactorable::NotConverged)?;
    Ok(schur.complex_eigenvalues())
}

fn limit(matrix: &DMatrix<f64>) -> usize {
    ITERATIONS_PER_ROW * matrix.nrows().max(matrix.ncols()).max(1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Matrix2, Vector2};

    #[test]
    fn a_matrix_with_an_entry_that_is_no_number_is_refused_by_every_factorisation() {
        for wrong in [f64::NAN, f64::INFINITY] {
            let matrix = || {
                let mut matrix = DMatrix::from_fn(5, 5, |i, j| if i == j { 4.0 } else { 1.0 / (1 + i + j) as f64 });
                matrix[(3, 1)] = wrong;
                matrix
            };
            let outcomes = [
                lu(matrix()).err(),
                solve_mut(matrix(), &mut DVector::zeros(5)).err(),
                inverse(matrix()).err(),
                cholesky(matrix()).err(),
                least_squares(matrix(), &DVector::zeros(5), 1e-12).err(),
                symmetric_eigen(matrix()).err(),
                eigenvalues(matrix()).err(),
            ];
            for (number, outcome) in outcomes.into_iter().enumerate() {
                let Some(Unfactorable::NotFinite { row: 3, column: 1, value }) = outcome else {
                    panic!("factorisation {number}: {outcome:?}");
                };
                assert_eq!(value.to_bits(), wrong.to_bits());
            }
            assert!(solve(&Matrix2::new(1.0, 0.0, wrong, 1.0), &Vector2::zeros()).is_err());
            assert!(least_squares(DMatrix::identity(2, 2), &DVector::from_vec(vec![1.0, wrong]), 1e-12).is_err());
        }
    }

    #[test]
    fn what_is_finite_is_factorised() {
        let matrix = DMatrix::from_row_slice(2, 2, &[2.0, 1.0, 1.0, 2.0]);
        let mut right = DVector::from_vec(vec![3.0, 3.0]);
        let found = least_squares(matrix.clone(), &right, 1e-12).unwrap();
        solve_mut(matrix.clone(), &mut right).unwrap();
        assert!((found - &right).amax() < 1e-14 && (right - DVector::from_element(2, 1.0)).amax() < 1e-14);
        assert!((inverse(matrix.clone()).unwrap() * &matrix - DMatrix::identity(2, 2)).amax() < 1e-14);
        let mut values: Vec<f64> = symmetric_eigen(matrix.clone()).unwrap().eigenvalues.iter().copied().collect();
        values.sort_by(f64::total_cmp);
        assert!((values[0] - 1.0).abs() < 1e-14 && (values[1] - 3.0).abs() < 1e-14);
        assert!(eigenvalues(matrix).unwrap().iter().all(|value| value.im == 0.0));
        assert_eq!(solve_mut(DMatrix::zeros(2, 2), &mut DVector::zeros(2)), Err(Unfactorable::Singular));
    }
}
