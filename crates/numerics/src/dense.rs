//! Dense kernels of the contact line: LU factors, substitution, matrix-vector products, all in caller-owned memory.
//!
//! Matrices are stored by columns without gaps, entry (i, j) of n rows at `i + j n`. The sizes are those of a contact line,
//! tens to hundreds, for which the call overhead of a general library is comparable to the arithmetic:
//! `cargo fmu bench --line` shows both. The widest vector unit of the machine that the build of `pulp` supports is selected
//! at run time.

mod cholesky;
mod elimination;
mod products;

pub use cholesky::cholesky;
pub use elimination::{factorise, substitute};
pub use products::{
    combine, dot, multiply_add, multiply_add_columns, multiply_add_each, multiply_add_pair, multiply_add_symmetric,
    multiply_transposed_add,
};

use nalgebra::DMatrix;

/// Square matrix of zeros in untouched pages, which cost no physical memory until written.
pub fn untouched(count: usize) -> DMatrix<f64> {
    DMatrix::from_vec(count, count, vec![0.0; count * count])
}

/// Number of columns processed together in a substitution and in a product.
const GROUP: usize = 4;

#[cfg(test)]
mod tests {
    use super::*;

    fn noise(count: usize, seed: u64) -> Vec<f64> {
        let mut state = seed;
        let mut next = || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5
        };
        (0..count).map(|_| next()).collect()
    }

    #[test]
    fn every_size_is_solved_and_multiplied() {
        let mut exchanges = 0;
        for n in (1..40).chain([63, 64, 65, 129]) {
            let matrix = noise(n * n, n as u64);
            let exact = noise(n, 99);
            let mut right = vec![0.0; n];
            multiply_add(&matrix, &exact, &mut right);
            let second = noise(n, 98);
            let (mut one, mut other) = (vec![1.0; n], vec![0.0; n]);
            multiply_add_pair(&matrix, [&exact, &second], [&mut one, &mut other]);
            let (mut third, mut last) = (vec![1.0; n], vec![0.0; n]);
            multiply_add_each([(&matrix, &exact, &mut third), (&matrix, &second, &mut last)]);
            assert!(third == one && last == other, "n {n}");
            let mut columns = [vec![1.0; n], vec![0.0; n]].concat();
            multiply_add_columns(&matrix, &[&exact[..], &second].concat(), &mut columns, n);
            assert!(columns == [&one[..], &other].concat(), "n {n}");
            for i in 0..n {
                let sum = |x: &[f64]| (0..n).map(|j| matrix[i + j * n] * x[j]).sum::<f64>();
                assert!((right[i] - sum(&exact)).abs() < 1e-13 * n as f64);
                assert!((one[i] - 1.0 - sum(&exact)).abs() < 1e-13 * n as f64);
                assert!((other[i] - sum(&second)).abs() < 1e-13 * n as f64);
            }
            let (mut factors, mut exchanged) = (matrix.clone(), vec![0; n]);
            assert!(factorise(&mut factors, n, &mut exchanged));
            exchanges += exchanged.iter().enumerate().filter(|(k, row)| k != *row).count();
            let product = right.clone();
            substitute(&factors, n, &exchanged, &mut right);
            let mut residual: Vec<f64> = product.iter().map(|value| -value).collect();
            multiply_add(&matrix, &right, &mut residual);
            let size = right.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
            assert!(residual.iter().all(|r| r.abs() < 1e-12 * (1.0 + size) * n as f64), "n {n}: {residual:?}");
        }
        // Random matrices need row exchanges.
        assert!(exchanges > 100, "{exchanges}");
    }

    #[test]
    fn few_long_columns_are_multiplied_from_the_left() {
        for (rows, columns) in [(0, 3), (1, 1), (5, 4), (37, 5), (64, 9), (131, 2)] {
            let (matrix, x) = (noise(rows * columns, 7), noise(rows, 8));
            let mut target = vec![1.0; columns];
            multiply_transposed_add(&matrix, &x, &mut target);
            for (j, value) in target.iter().enumerate() {
                let expected = 1.0 + (0..rows).map(|i| matrix[i + j * rows] * x[i]).sum::<f64>();
                assert!((value - expected).abs() < 1e-12, "{rows} x {columns}: {value} {expected}");
            }
        }
    }

    #[test]
    fn a_lower_triangle_is_multiplied_as_the_symmetric_matrix() {
        for n in (1..20).chain([33, 64, 129]) {
            let (triangle, x) = (noise(n * (n + 1) / 2, 5), noise(n, 6));
            let mut target = vec![1.0; n];
            multiply_add_symmetric(&triangle, &x, &mut target);
            let entry = |i: usize, j: usize| {
                let (row, column) = (i.max(j), i.min(j));
                triangle[column * (2 * n - column - 1) / 2 + row]
            };
            for (i, value) in target.iter().enumerate() {
                let expected = 1.0 + (0..n).map(|j| entry(i, j) * x[j]).sum::<f64>();
                assert!((value - expected).abs() < 1e-13 * n as f64, "{n}, row {i}: {value} {expected}");
            }
        }
    }

    #[test]
    fn sums_of_vectors_of_every_length() {
        for n in [0, 1, 5, 16, 37] {
            let sources = [1, 2, 3].map(|seed| noise(n, seed));
            let mut sum = vec![f64::NAN; n];
            combine(&mut sum, sources.each_ref().map(|s| &s[..]), [2.0, -1.0, 0.5]);
            for i in 0..n {
                let expected = 2.0 * sources[0][i] - sources[1][i] + 0.5 * sources[2][i];
                assert!((sum[i] - expected).abs() < 1e-14);
            }
        }
    }

    #[test]
    fn singular_and_infinite_matrices_are_told() {
        let mut exchanged = [0; 3];
        assert!(!factorise(&mut [1.0, 2.0, 3.0, 0.0, 0.0, 0.0, 1.0, 5.0, 3.0], 3, &mut exchanged));
        assert!(!factorise(&mut [f64::INFINITY], 1, &mut exchanged[..1]));
        assert!(!factorise(&mut [1.0, f64::INFINITY, 3.0, 0.0, 1.0, 0.0, 1.0, 5.0, 3.0], 3, &mut exchanged));
    }
}
