//! Dense kernels of the contact line: LU factors, substitution, matrix times vector, all in caller-owned memory.
//!
//! Matrices are stored by columns without gaps, entry (i, j) of n rows at `i + j n`. The sizes are those of a contact
//! line, some tens to hundreds, where what a general library spends on a call is as long as the arithmetic itself:
//! `cargo fmu bench --line` shows both. The widest vector unit that the machine has and the build of `pulp` knows is
//! chosen at run time.

use pulp::{Arch, Simd, WithSimd};

/// Columns eliminated together: the rows below them stay in the first-level cache while the rest is updated.
const PANEL: usize = 8;
/// Columns substituted together.
const GROUP: usize = 4;
/// A diagonal entry this small against the largest below it is exchanged for that one.
const PIVOT_THRESHOLD: f64 = 0.1;

/// `target += sum_k factors[k] column_k`, the columns `first, first + 1, ...` of the matrix from row `row` on.
#[inline(always)]
fn accumulate<S: Simd, const K: usize>(
    simd: S,
    target: &mut [f64],
    matrix: &[f64],
    rows: usize,
    row: usize,
    first: usize,
    factors: [f64; K],
) {
    let length = target.len();
    // Loops instead of array maps throughout: calls inside those would not be compiled for the vector unit.
    let mut parts: [(&[S::f64s], &[f64]); K] = [(&[], &[]); K];
    for k in 0..K {
        let start = (first + k) * rows + row;
        parts[k] = S::as_simd_f64s(&matrix[start..start + length]);
    }
    let (head, tail) = S::as_mut_simd_f64s(target);
    let mut splat = [simd.splat_f64s(0.0); K];
    for k in 0..K {
        splat[k] = simd.splat_f64s(factors[k]);
    }
    for (i, value) in head.iter_mut().enumerate() {
        let mut sum = *value;
        for k in 0..K {
            sum = simd.mul_add_f64s(splat[k], parts[k].0[i], sum);
        }
        *value = sum;
    }
    if !tail.is_empty() {
        let mut sum = simd.partial_load_f64s(tail);
        for k in 0..K {
            sum = simd.mul_add_f64s(splat[k], simd.partial_load_f64s(parts[k].1), sum);
        }
        simd.partial_store_f64s(tail, sum);
    }
}

/// The same for two targets with one reading of the columns.
#[inline(always)]
fn accumulate_pair<S: Simd, const K: usize>(
    simd: S,
    targets: [&mut [f64]; 2],
    matrix: &[f64],
    rows: usize,
    row: usize,
    first: usize,
    factors: [[f64; K]; 2],
) {
    let length = targets[0].len();
    let mut parts: [(&[S::f64s], &[f64]); K] = [(&[], &[]); K];
    for k in 0..K {
        let start = (first + k) * rows + row;
        parts[k] = S::as_simd_f64s(&matrix[start..start + length]);
    }
    let [one, other] = targets;
    let (one, one_tail) = S::as_mut_simd_f64s(one);
    let (other, other_tail) = S::as_mut_simd_f64s(&mut other[..length]);
    let mut splat = [[simd.splat_f64s(0.0); K]; 2];
    for k in 0..K {
        splat[0][k] = simd.splat_f64s(factors[0][k]);
        splat[1][k] = simd.splat_f64s(factors[1][k]);
    }
    for (i, (one, other)) in one.iter_mut().zip(other).enumerate() {
        let mut sums = [*one, *other];
        for k in 0..K {
            let column = parts[k].0[i];
            sums[0] = simd.mul_add_f64s(splat[0][k], column, sums[0]);
            sums[1] = simd.mul_add_f64s(splat[1][k], column, sums[1]);
        }
        [*one, *other] = sums;
    }
    if !one_tail.is_empty() {
        let mut sums = [simd.partial_load_f64s(one_tail), simd.partial_load_f64s(other_tail)];
        for k in 0..K {
            let column = simd.partial_load_f64s(parts[k].1);
            sums[0] = simd.mul_add_f64s(splat[0][k], column, sums[0]);
            sums[1] = simd.mul_add_f64s(splat[1][k], column, sums[1]);
        }
        simd.partial_store_f64s(one_tail, sums[0]);
        simd.partial_store_f64s(other_tail, sums[1]);
    }
}

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

/// Takes from a column what the K columns left of it in its panel eliminate.
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

/// Largest absolute value, and 0 for nothing.
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

/// Replaces the n x n matrix by its factors `P A = L U`, L with a unit diagonal, U with the reciprocals of its
/// diagonal in place of that. `exchanged[k]` is the row that row k was exchanged for at step k.
///
/// Pivots are chosen among the rows with a threshold of .1: growth stays bounded, and the nearly symmetric matrices of
/// contact are hardly ever rearranged. `false` where a pivot is 0 or infinite; what is not a number shows in the solution.
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
                    if column[j].abs() < PIVOT_THRESHOLD * most {
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
    Arch::new().dispatch(Factorise(matrix, n, exchanged))
}

/// Solves `A x = right` in place with the factors that [`factorise`] left.
pub fn substitute(factors: &[f64], n: usize, exchanged: &[usize], right: &mut [f64]) {
    struct Substitute<'a>(&'a [f64], usize, &'a mut [f64]);
    impl WithSimd for Substitute<'_> {
        type Output = ();

        #[inline(always)]
        fn with_simd<S: Simd>(self, simd: S) {
            let Self(factors, n, x) = self;
            // The first few rows by themselves, so that all others come in whole groups.
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

/// Rows up to which a product keeps its sums in registers while the columns pass: then it reads nothing twice. More rows are
/// read column after column, as they lie.
const NARROW: usize = 72;
/// Most numbers in a vector.
const MOST_LANES: usize = 8;

/// Adds the products of some rows, V vectors of them from row `row` on, with K columns of factors; with `REST` also the rows
/// behind these, fewer than a vector, which reaches back over rows that are done.
#[inline(always)]
fn pass<S: Simd, const K: usize, const V: usize, const REST: bool>(
    simd: S,
    matrix: &[f64],
    factors: impl Iterator<Item = [f64; K]>,
    targets: &mut [&mut [f64]; K],
    row: usize,
) {
    let rows = targets[0].len();
    let (end, back) = (row + V * S::F64_LANES, rows.max(S::F64_LANES) - S::F64_LANES);
    let mut sums = [[simd.splat_f64s(0.0); V]; K];
    let mut rest = [simd.splat_f64s(0.0); K];
    for (column, factors) in matrix.chunks_exact(rows).zip(factors) {
        if let Some(part) = S::as_simd_f64s(&column[row..end]).0.first_chunk::<V>() {
            for n in 0..K {
                let factor = simd.splat_f64s(factors[n]);
                for k in 0..V {
                    sums[n][k] = simd.mul_add_f64s(factor, part[k], sums[n][k]);
                }
            }
        }
        if REST && let Some(part) = S::as_simd_f64s(&column[back..]).0.first() {
            for n in 0..K {
                rest[n] = simd.mul_add_f64s(simd.splat_f64s(factors[n]), *part, rest[n]);
            }
        }
    }
    for n in 0..K {
        if let Some(part) = S::as_mut_simd_f64s(&mut targets[n][row..end]).0.first_chunk_mut::<V>() {
            for k in 0..V {
                part[k] = simd.add_f64s(part[k], sums[n][k]);
            }
        }
        if REST {
            let mut values = [0.0; MOST_LANES];
            if let Some(part) = S::as_mut_simd_f64s(&mut values).0.first_mut() {
                *part = rest[n];
            }
            for i in end..rows {
                targets[n][i] += values[i - back];
            }
        }
    }
}

/// `target += matrix x` of few rows, at least a vector of them, for K pairs of x and target.
#[inline(always)]
fn multiply_narrow<S: Simd, const K: usize>(
    simd: S,
    matrix: &[f64],
    factors: impl Iterator<Item = [f64; K]> + Clone,
    mut targets: [&mut [f64]; K],
) {
    let rows = targets[0].len();
    let mut row = 0;
    macro_rules! passes {
        ($abreast:literal: $($vectors:literal)*) => {{
            while rows - row >= ($abreast + 1) * S::F64_LANES {
                pass::<S, K, $abreast, false>(simd, matrix, factors.clone(), &mut targets, row);
                row += $abreast * S::F64_LANES;
            }
            match ((rows - row) / S::F64_LANES, rows % S::F64_LANES != 0) {
                $(($vectors, false) => pass::<S, K, $vectors, false>(simd, matrix, factors, &mut targets, row),
                ($vectors, true) => pass::<S, K, $vectors, true>(simd, matrix, factors, &mut targets, row),)*
                _ => unreachable!("at least one vector is left, and no more than pass together"),
            }
        }};
    }
    // The sums of all have to fit the registers.
    if K == 1 { passes!(8: 1 2 3 4 5 6 7 8) } else { passes!(4: 1 2 3 4) }
}

/// Whether [`multiply_narrow`] takes a matrix.
#[inline(always)]
fn is_narrow<S: Simd>(rows: usize, columns: usize) -> bool {
    (2 * S::F64_LANES..=NARROW).contains(&rows) && columns >= GROUP
}

/// `target += matrix x`, column after column as they lie.
#[inline(always)]
fn multiply_wide<S: Simd>(simd: S, matrix: &[f64], x: &[f64], target: &mut [f64]) {
    let rows = target.len();
    let full = x.len() - x.len() % GROUP;
    for start in (0..full).step_by(GROUP) {
        let factors = [x[start], x[start + 1], x[start + 2], x[start + 3]];
        accumulate(simd, target, matrix, rows, 0, start, factors);
    }
    for j in full..x.len() {
        accumulate(simd, target, matrix, rows, 0, j, [x[j]]);
    }
}

/// `target += matrix x`, with as many rows as `target` and columns as `x` is long.
pub fn multiply_add(matrix: &[f64], x: &[f64], target: &mut [f64]) {
    struct Multiply<'a>(&'a [f64], &'a [f64], &'a mut [f64]);
    impl WithSimd for Multiply<'_> {
        type Output = ();

        #[inline(always)]
        fn with_simd<S: Simd>(self, simd: S) {
            let Self(matrix, x, target) = self;
            if is_narrow::<S>(target.len(), x.len()) {
                return multiply_narrow(simd, matrix, x.iter().map(|x| [*x]), [target]);
            }
            multiply_wide(simd, matrix, x, target);
        }
    }
    assert_eq!(matrix.len(), x.len() * target.len(), "one column per x, one row per target");
    Arch::new().dispatch(Multiply(matrix, x, target));
}

/// [`multiply_add`] for two x and targets of the same lengths at once: a matrix of few rows is read once.
pub fn multiply_add_pair(matrix: &[f64], x: [&[f64]; 2], targets: [&mut [f64]; 2]) {
    struct Multiply<'a>(&'a [f64], [&'a [f64]; 2], [&'a mut [f64]; 2]);
    impl WithSimd for Multiply<'_> {
        type Output = ();

        #[inline(always)]
        fn with_simd<S: Simd>(self, simd: S) {
            let Self(matrix, [x, y], targets) = self;
            if is_narrow::<S>(targets[0].len(), x.len()) {
                return multiply_narrow(simd, matrix, x.iter().zip(y).map(|(x, y)| [*x, *y]), targets);
            }
            let [one, other] = targets;
            multiply_wide(simd, matrix, x, one);
            multiply_wide(simd, matrix, y, other);
        }
    }
    assert!(matrix.len() == x[0].len() * targets[0].len(), "one column per x, one row per target");
    assert!(x[0].len() == x[1].len() && targets[0].len() == targets[1].len(), "pairs of the same lengths");
    Arch::new().dispatch(Multiply(matrix, x, targets));
}

/// `target = sum_k factors[k] sources[k]`, all of one length.
pub fn combine<const K: usize>(target: &mut [f64], sources: [&[f64]; K], factors: [f64; K]) {
    struct Combine<'a, const K: usize>(&'a mut [f64], [&'a [f64]; K], [f64; K]);
    impl<const K: usize> WithSimd for Combine<'_, K> {
        type Output = ();

        #[inline(always)]
        fn with_simd<S: Simd>(self, simd: S) {
            let Self(target, sources, factors) = self;
            let mut parts: [(&[S::f64s], &[f64]); K] = [(&[], &[]); K];
            let mut splat = [simd.splat_f64s(0.0); K];
            for k in 0..K {
                parts[k] = S::as_simd_f64s(&sources[k][..target.len()]);
                splat[k] = simd.splat_f64s(factors[k]);
            }
            let (head, tail) = S::as_mut_simd_f64s(target);
            for (i, value) in head.iter_mut().enumerate() {
                let mut sum = simd.splat_f64s(0.0);
                for k in 0..K {
                    sum = simd.mul_add_f64s(splat[k], parts[k].0[i], sum);
                }
                *value = sum;
            }
            for (i, value) in tail.iter_mut().enumerate() {
                *value = 0.0;
                for k in 0..K {
                    *value += factors[k] * parts[k].1[i];
                }
            }
        }
    }
    Arch::new().dispatch(Combine(target, sources, factors));
}

/// `sum_i a_i b_i`.
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    // Four sums side by side: the additions of one would wait for each other.
    let (a_groups, a_rest) = a.as_chunks::<GROUP>();
    let (b_groups, b_rest) = b.as_chunks::<GROUP>();
    let mut sums = [0.0; GROUP];
    for (a, b) in a_groups.iter().zip(b_groups) {
        for k in 0..GROUP {
            sums[k] += a[k] * b[k];
        }
    }
    let rest: f64 = a_rest.iter().zip(b_rest).map(|(a, b)| a * b).sum();
    (sums[0] + sums[1]) + (sums[2] + sums[3]) + rest
}

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
        // Random matrices need exchanges of rows.
        assert!(exchanges > 100, "{exchanges}");
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
        assert!(!factorise(&mut [1.0, f64::INFINITY, 3.0, 0.0, 1.0, 0.0, 1.0, 5.0, 3.0], 3, &mut exchanged));
    }
}
