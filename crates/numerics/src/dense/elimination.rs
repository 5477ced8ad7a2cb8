//! LU factorisation of a dense matrix with row exchanges, and substitution.

use super::GROUP;
use super::products::{accumulate, accumulate_pair};
use crate::interruption::checkpoint;
use pulp::{Arch, Simd, WithSimd};

/// Number of columns eliminated together: the rows below them stay in the first-level cache while the rest is updated.
const PANEL: usize = 8;

/// Solves with an upper triangle that holds the reciprocals of its diagonal, in place.
#[inline(always)]
fn upper<const K: usize>(triangle: &[[f64; K]; K], x: &mut [f64; K]) {
    for i in (0..K).rev() {
        x[i] *= triangle[i][i];
        for k in 0..i {
            x[k] -= triangle[i][k] * x[i];
        }
    }
}

/// Both triangles on the diagonal of a panel's first K columns, by columns.
#[inline(always)]
fn triangle<const K: usize>(matrix: &[f64], rows: usize, start: usize) -> [[f64; K]; K] {
    let mut triangle = [[0.0; K]; K];
    for i in 0..K {
        triangle[i].copy_from_slice(&matrix[(start + i) * rows + start..][..K]);
    }
    triangle
}

/// Solves with a unit lower triangle in place.
#[inline(always)]
fn lower<const K: usize>(triangle: &[[f64; K]; K], x: &mut [f64; K]) {
    for i in 0..K {
        for k in i + 1..K {
            x[k] -= triangle[i][k] * x[i];
        }
    }
}

/// The first K values with the opposite sign.
#[inline(always)]
fn negated<const K: usize>(values: &[f64]) -> [f64; K] {
    let mut result = [0.0; K];
    for k in 0..K {
        result[k] = -values[k];
    }
    result
}

/// Eliminates from a column the contributions of the K columns left of it in its panel.
#[inline(always)]
fn eliminate<S: Simd, const K: usize>(simd: S, column: &mut [f64], left: &[f64], start: usize) {
    let rows = column.len();
    let (upper, below) = column.split_at_mut(start + K);
    let mut x = [0.0; K];
    x.copy_from_slice(&upper[start..]);
    lower(&triangle(left, rows, start), &mut x);
    upper[start..].copy_from_slice(&x);
    accumulate(simd, below, left, rows, start + K, start, negated::<K>(&x));
}

/// Largest absolute value; 0 for an empty slice.
#[inline(always)]
fn largest<S: Simd>(simd: S, values: &[f64]) -> f64 {
    let (head, tail) = S::as_simd_f64s(values);
    let mut most = simd.splat_f64s(0.0);
    for value in head {
        most = simd.max_f64s(most, simd.abs_f64s(*value));
    }
    if !tail.is_empty() {
        most = simd.max_f64s(most, simd.abs_f64s(simd.partial_load_f64s(tail)));
    }
    simd.reduce_max_f64s(most)
}

/// Replaces the n x n matrix by its factors `P A = L U`, L with a unit diagonal, U with the reciprocals of its diagonal in
/// place of that. `exchanged[k]` is the row that row k was exchanged for at step k.
///
/// Threshold pivoting with 0.1: growth stays bounded, and the nearly symmetric matrices of contact are hardly ever
/// permuted.
/// `false` where a pivot is 0 or infinite; a NaN propagates to the solution.
pub fn factorise(matrix: &mut [f64], n: usize, exchanged: &mut [usize]) -> bool {
    struct Factorise<'a>(&'a mut [f64], usize, &'a mut [usize]);
    impl WithSimd for Factorise<'_> {
        type Output = bool;

        #[inline(always)]
        fn with_simd<S: Simd>(self, simd: S) -> bool {
            let Self(matrix, n, exchanged) = self;
            let mut start = 0;
            while start < n {
                let width = PANEL.min(n - start);
                for j in start..start + width {
                    let (left, right) = matrix.split_at_mut(j * n);
                    let column = &mut right[..n];
                    match j - start {
                        1 => eliminate::<S, 1>(simd, column, left, start),
                        2 => eliminate::<S, 2>(simd, column, left, start),
                        3 => eliminate::<S, 3>(simd, column, left, start),
                        4 => eliminate::<S, 4>(simd, column, left, start),
                        5 => eliminate::<S, 5>(simd, column, left, start),
                        6 => eliminate::<S, 6>(simd, column, left, start),
                        7 => eliminate::<S, 7>(simd, column, left, start),
                        _ => {}
                    }
                    let most = largest(simd, &column[j..]);
                    if !(most > 0.0 && most < f64::INFINITY) {
                        return false;
                    }
                    let mut pivot = j;
                    // Threshold of pivoting: a diagonal entry smaller than this times the largest below it is exchanged for that one.
                    if column[j].abs() < 0.1 * most {
                        pivot = (j..n).find(|&i| column[i].abs() == most).unwrap_or(j);
                    }
                    exchanged[j] = pivot;
                    if pivot != j {
                        for k in 0..n {
                            matrix.swap(j + k * n, pivot + k * n);
                        }
                    }
                    let column = &mut matrix[j * n..(j + 1) * n];
                    let reciprocal = 1.0 / column[j];
                    column[j] = reciprocal;
                    for value in &mut column[j + 1..] {
                        *value *= reciprocal;
                    }
                }
                let end = start + width;
                if end < n {
                    let (left, right) = matrix.split_at_mut(end * n);
                    let triangle = triangle::<PANEL>(left, n, start);
                    let mut pairs = right.chunks_exact_mut(2 * n);
                    for pair in pairs.by_ref() {
                        let (one, other) = pair.split_at_mut(n);
                        let ((one, one_below), (other, other_below)) = (one.split_at_mut(end), other.split_at_mut(end));
                        let (mut x, mut y) = ([0.0; PANEL], [0.0; PANEL]);
                        x.copy_from_slice(&one[start..]);
                        y.copy_from_slice(&other[start..]);
                        lower(&triangle, &mut x);
                        lower(&triangle, &mut y);
                        one[start..].copy_from_slice(&x);
                        other[start..].copy_from_slice(&y);
                        // In two halves: the factors of all columns would not fit the registers.
                        for half in [0, GROUP] {
                            let factors = [negated::<GROUP>(&x[half..]), negated::<GROUP>(&y[half..])];
                            let (targets, first) = ([&mut *one_below, &mut *other_below], start + half);
                            accumulate_pair(simd, targets, left, n, end, first, factors);
                        }
                    }
                    let last = pairs.into_remainder();
                    if !last.is_empty() {
                        eliminate::<S, PANEL>(simd, last, left, start);
                    }
                }
                start = end;
            }
            true
        }
    }
    assert!(matrix.len() == n * n && exchanged.len() == n, "n x n matrix, n exchanges");
    checkpoint();
    Arch::new().dispatch(Factorise(matrix, n, exchanged))
}

/// Solves `A x = right` in place with the factors of [`factorise`].
pub fn substitute(factors: &[f64], n: usize, exchanged: &[usize], right: &mut [f64]) {
    struct Substitute<'a>(&'a [f64], usize, &'a mut [f64]);
    impl WithSimd for Substitute<'_> {
        type Output = ();

        #[inline(always)]
        fn with_simd<S: Simd>(self, simd: S) {
            let Self(factors, n, x) = self;
            // The first few rows singly, so that all others come in whole groups.
            let odd = n % GROUP;
            for i in 0..odd {
                let (done, rest) = x.split_at_mut(i + 1);
                accumulate(simd, rest, factors, n, i + 1, i, [-done[i]]);
            }
            for start in (odd..n).step_by(GROUP) {
                let (done, rest) = x.split_at_mut(start + GROUP);
                let own = &mut done[start..];
                let mut solved = [0.0; GROUP];
                solved.copy_from_slice(own);
                lower(&triangle(factors, n, start), &mut solved);
                own.copy_from_slice(&solved);
                accumulate(simd, rest, factors, n, start + GROUP, start, negated::<GROUP>(&solved));
            }
            for start in (odd..n).step_by(GROUP).rev() {
                let (rest, own) = x[..start + GROUP].split_at_mut(start);
                let mut solved = [0.0; GROUP];
                solved.copy_from_slice(own);
                upper(&triangle(factors, n, start), &mut solved);
                own.copy_from_slice(&solved);
                accumulate(simd, rest, factors, n, 0, start, negated::<GROUP>(&solved));
            }
            for i in (0..odd).rev() {
                x[i] *= factors[i * n + i];
                for k in 0..i {
                    x[k] -= factors[i * n + k] * x[i];
                }
            }
        }
    }
    assert!(factors.len() == n * n && exchanged.len() == n && right.len() == n, "n x n factors, n values");
    for (k, &row) in exchanged.iter().enumerate() {
        if row != k {
            right.swap(k, row);
        }
    }
    Arch::new().dispatch(Substitute(factors, n, right));
}
