//! Matrix-vector products and linear combinations of vectors.

use super::GROUP;
use pulp::{Arch, Simd, WithSimd};

/// `target += sum_k factors[k] column_k`, the columns `first, first + 1, ...` of the matrix from row `row` on.
#[inline(always)]
pub(super) fn accumulate<S: Simd, const K: usize>(
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

/// [`accumulate`] for two targets with one pass over the columns.
#[inline(always)]
pub(super) fn accumulate_pair<S: Simd, const K: usize>(
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
/// Number of rows up to which a product keeps its sums in registers over all columns, so that nothing is read twice. Larger
/// matrices are read column by column.
const NARROW: usize = 72;
/// Largest number of values in a vector register.
const MOST_LANES: usize = 8;

/// Adds the products of some rows, V vectors of them from row `row` on, with K columns of factors; with `REST` also the
/// remaining rows, fewer than a vector, by a vector that overlaps rows already done.
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

/// `target += matrix x` for few rows, at least a vector of them, for K pairs of x and target.
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
    // The sums of all pairs have to fit the registers.
    if K == 1 { passes!(8: 1 2 3 4 5 6 7 8) } else { passes!(4: 1 2 3 4) }
}

/// Whether [`multiply_narrow`] applies to a matrix.
#[inline(always)]
fn is_narrow<S: Simd>(rows: usize, columns: usize) -> bool {
    (2 * S::F64_LANES..=NARROW).contains(&rows) && columns >= GROUP
}

/// `target += matrix x`, column by column.
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

/// `targets += matrix xs`, product of matrices: `targets` have `rows` rows, `xs` as many as the matrix has columns. Each column is
/// that of [`multiply_add`].
pub fn multiply_add_columns(matrix: &[f64], xs: &[f64], targets: &mut [f64], rows: usize) {
    struct Multiply<'a>(&'a [f64], &'a [f64], &'a mut [f64], usize);
    impl WithSimd for Multiply<'_> {
        type Output = ();

        #[inline(always)]
        fn with_simd<S: Simd>(self, simd: S) {
            let Self(matrix, xs, targets, rows) = self;
            let inner = matrix.len() / rows;
            let narrow = is_narrow::<S>(rows, inner);
            for (x, target) in xs.chunks_exact(inner).zip(targets.chunks_exact_mut(rows)) {
                if narrow {
                    multiply_narrow(simd, matrix, x.iter().map(|x| [*x]), [target]);
                } else {
                    multiply_wide(simd, matrix, x, target);
                }
            }
        }
    }
    if rows == 0 || matrix.is_empty() {
        return;
    }
    assert_eq!(xs.len() * rows * rows, matrix.len() * targets.len(), "one column of targets per column of xs");
    Arch::new().dispatch(Multiply(matrix, xs, targets, rows));
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

/// [`multiply_add`] for several matrices, each with its x and target; small ones in one pass.
pub fn multiply_add_each<const K: usize>(products: [(&[f64], &[f64], &mut [f64]); K]) {
    struct Multiply<'a, const K: usize>([(&'a [f64], &'a [f64], &'a mut [f64]); K]);
    impl<const K: usize> WithSimd for Multiply<'_, K> {
        type Output = ();

        #[inline(always)]
        fn with_simd<S: Simd>(self, simd: S) {
            for (matrix, x, target) in self.0 {
                if is_narrow::<S>(target.len(), x.len()) {
                    multiply_narrow(simd, matrix, x.iter().map(|x| [*x]), [target]);
                } else {
                    multiply_wide(simd, matrix, x, target);
                }
            }
        }
    }
    for (matrix, x, target) in &products {
        assert_eq!(matrix.len(), x.len() * target.len(), "one column per x, one row per target");
    }
    Arch::new().dispatch(Multiply(products));
}

/// [`multiply_add`] for two x and targets of the same lengths: a matrix of few rows is read once.
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

/// `target += matrix' x`, with as many columns as `target` and rows as `x` is long: for a matrix of few and long columns.
pub fn multiply_transposed_add(matrix: &[f64], x: &[f64], target: &mut [f64]) {
    struct Multiply<'a>(&'a [f64], &'a [f64], &'a mut [f64]);
    impl WithSimd for Multiply<'_> {
        type Output = ();

        #[inline(always)]
        fn with_simd<S: Simd>(self, simd: S) {
            let Self(matrix, x, target) = self;
            let full = target.len() - target.len() % GROUP;
            for first in (0..full).step_by(GROUP) {
                let sums = dots::<S, GROUP>(simd, matrix, x, first);
                for (k, sum) in sums.into_iter().enumerate() {
                    target[first + k] += sum;
                }
            }
            for (column, value) in target.iter_mut().enumerate().skip(full) {
                *value += dots::<S, 1>(simd, matrix, x, column)[0];
            }
        }
    }
    assert_eq!(matrix.len(), x.len() * target.len(), "one row per x, one column per target");
    Arch::new().dispatch(Multiply(matrix, x, target));
}

/// Products of the columns `first, first + 1, ...` with `x`.
#[inline(always)]
fn dots<S: Simd, const K: usize>(simd: S, matrix: &[f64], x: &[f64], first: usize) -> [f64; K] {
    let rows = x.len();
    let (head, tail) = S::as_simd_f64s(x);
    let mut parts: [(&[S::f64s], &[f64]); K] = [(&[], &[]); K];
    for k in 0..K {
        parts[k] = S::as_simd_f64s(&matrix[(first + k) * rows..(first + k + 1) * rows]);
    }
    let mut sums = [simd.splat_f64s(0.0); K];
    for (i, value) in head.iter().enumerate() {
        for k in 0..K {
            sums[k] = simd.mul_add_f64s(parts[k].0[i], *value, sums[k]);
        }
    }
    let rest = simd.partial_load_f64s(tail);
    let mut products = [0.0; K];
    for k in 0..K {
        let sum = simd.mul_add_f64s(simd.partial_load_f64s(parts[k].1), rest, sums[k]);
        products[k] = simd.reduce_sum_f64s(sum);
    }
    products
}

/// `target += matrix x` for a symmetric matrix of which `triangle` is the lower triangle, by columns.
pub fn multiply_add_symmetric(triangle: &[f64], x: &[f64], target: &mut [f64]) {
    struct Multiply<'a>(&'a [f64], &'a [f64], &'a mut [f64]);
    impl WithSimd for Multiply<'_> {
        type Output = ();

        #[inline(always)]
        fn with_simd<S: Simd>(self, simd: S) {
            let Self(triangle, x, target) = self;
            // The few columns first: then the groups have whole vectors of rows.
            let (few, mut begin) = (x.len() % GROUP, 0);
            for first in 0..few {
                begin = mirror::<S, 1>(simd, triangle, (begin, first), x, target);
            }
            for first in (few..x.len()).step_by(GROUP) {
                begin = mirror::<S, GROUP>(simd, triangle, (begin, first), x, target);
            }
        }
    }
    assert!(x.len() == target.len() && triangle.len() == x.len() * (x.len() + 1) / 2, "a triangle of as many rows");
    Arch::new().dispatch(Multiply(triangle, x, target));
}

/// Adds the products with the columns `first, first + 1, ...` of a lower triangle, which begin at `begin`, and with the rows that mirror
/// them; returns where the next column begins.
#[inline(always)]
fn mirror<S: Simd, const K: usize>(
    simd: S,
    triangle: &[f64],
    (mut begin, first): (usize, usize),
    x: &[f64],
    target: &mut [f64],
) -> usize {
    let mut parts: [(&[S::f64s], &[f64]); K] = [(&[], &[]); K];
    let mut factors = [simd.splat_f64s(0.0); K];
    // By the entries of these columns among each other: sums in registers, since sums in memory would wait for each other.
    let mut own = [0.0; K];
    for k in 0..K {
        let column = &triangle[begin..begin + x.len() - first - k];
        begin += column.len();
        own[k] += column[0] * x[first + k];
        for l in 1..K - k {
            own[k + l] += column[l] * x[first + k];
            own[k] += column[l] * x[first + k + l];
        }
        parts[k] = S::as_simd_f64s(&column[K - k..]);
        factors[k] = simd.splat_f64s(x[first + k]);
    }
    let (head, tail) = S::as_simd_f64s(&x[first + K..]);
    let (before, below) = target.split_at_mut(first + K);
    let (rows, last) = S::as_mut_simd_f64s(below);
    let mut sums = [simd.splat_f64s(0.0); K];
    for (i, (row, value)) in rows.iter_mut().zip(head).enumerate() {
        let mut sum = *row;
        for k in 0..K {
            let entry = parts[k].0[i];
            sum = simd.mul_add_f64s(factors[k], entry, sum);
            sums[k] = simd.mul_add_f64s(entry, *value, sums[k]);
        }
        *row = sum;
    }
    for k in 0..K {
        own[k] += simd.reduce_sum_f64s(sums[k]);
        for (i, (row, value)) in last.iter_mut().zip(tail).enumerate() {
            let entry = parts[k].1[i];
            *row += entry * x[first + k];
            own[k] += entry * value;
        }
        before[first + k] += own[k];
    }
    begin
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

/// Dot product `sum_i a_i b_i`.
#[inline]
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    // Four independent sums, so that additions do not wait for each other.
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
