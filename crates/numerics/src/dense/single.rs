//! Matrix in single precision, stored in the order in which a product reads it: half of the memory traffic.
//!
//! Theory: docs/theory.md, section 6.4.

use pulp::{Arch, Simd, WithSimd};

/// Number of rows whose sums stay in registers over all columns.
const PANEL: usize = 32;
/// The last panel has a multiple of this number of rows.
const PART: usize = 8;

/// Matrix of f32 entries. Products are summed in double precision; the error is the rounding of the entries, 6e-8 of each.
#[derive(Clone, Debug)]
pub struct SingleMatrix {
    rows: usize,
    columns: usize,
    /// Panel after panel, each by columns.
    values: Vec<f32>,
}

/// Number of rows, padded to fill the last panel.
fn padded(rows: usize) -> usize {
    rows.div_ceil(PART) * PART
}

impl SingleMatrix {
    /// Matrix of zeros.
    pub fn zeros(rows: usize, columns: usize) -> SingleMatrix {
        SingleMatrix { rows, columns, values: vec![0.0; padded(rows) * columns] }
    }

    /// Converts a matrix of the same size, stored by columns.
    pub fn copy_from(&mut self, matrix: &[f64]) {
        assert_eq!(matrix.len(), self.rows * self.columns, "a matrix of the same size");
        let mut target = self.values.iter_mut();
        for first in (0..self.rows).step_by(PANEL) {
            let panel = PANEL.min(padded(self.rows) - first);
            for column in matrix.chunks_exact(self.rows) {
                let own = column[first..].iter().map(|value| *value as f32).chain(std::iter::repeat(0.0));
                target.by_ref().zip(own).take(panel).for_each(|(target, value)| *target = value);
            }
        }
    }

    /// `target += self x`.
    pub fn multiply_add(&self, x: &[f64], target: &mut [f64]) {
        struct Multiply<'a>(&'a SingleMatrix, &'a [f64], &'a mut [f64]);
        impl WithSimd for Multiply<'_> {
            type Output = ();

            #[inline(always)]
            fn with_simd<S: Simd>(self, _: S) {
                let Self(matrix, x, target) = self;
                let whole = matrix.rows / PANEL * PANEL;
                let (panels, rest) = matrix.values.split_at(whole * matrix.columns);
                let (head, tail) = target.split_at_mut(whole);
                let both = panels.chunks_exact((PANEL * matrix.columns).max(1)).zip(head.chunks_exact_mut(PANEL));
                both.for_each(|(panel, target)| pass::<PANEL>(panel, x, target));
                match padded(tail.len()) / PART {
                    0 => {}
                    1 => pass::<PART>(rest, x, tail),
                    2 => pass::<{ 2 * PART }>(rest, x, tail),
                    3 => pass::<{ 3 * PART }>(rest, x, tail),
                    _ => pass::<PANEL>(rest, x, tail),
                }
            }
        }
        assert!(x.len() == self.columns && target.len() == self.rows, "one x per column, one target per row");
        Arch::new().dispatch(Multiply(self, x, target));
    }
}

/// Product of a panel of R rows; targets exist for the first of them.
#[inline(always)]
fn pass<const R: usize>(panel: &[f32], x: &[f64], target: &mut [f64]) {
    let mut sums = [0.0; R];
    let (columns, _) = panel.as_chunks::<R>();
    for (column, factor) in columns.iter().zip(x) {
        for k in 0..R {
            sums[k] = f64::mul_add(*factor, f64::from(column[k]), sums[k]);
        }
    }
    target.iter_mut().zip(sums).for_each(|(target, sum)| *target += sum);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_of_every_size_lose_only_the_rounding_of_the_entries() {
        for (rows, columns) in [(1, 1), (7, 3), (8, 9), (9, 8), (31, 5), (32, 4), (33, 33), (57, 12), (129, 129)] {
            let entry = |k: usize| ((k * 7919) % 1009) as f64 / 1009.0 - 0.4;
            let matrix: Vec<f64> = (0..rows * columns).map(entry).collect();
            let x: Vec<f64> = (0..columns).map(|k| entry(3 * k + 1)).collect();
            let mut single = SingleMatrix::zeros(rows, columns);
            single.copy_from(&matrix);
            let mut target = vec![1.0; rows];
            single.multiply_add(&x, &mut target);
            for (i, value) in target.iter().enumerate() {
                let rounded = |j: usize| f64::from(matrix[j * rows + i] as f32) * x[j];
                let expected = 1.0 + (0..columns).map(rounded).sum::<f64>();
                assert!((value - expected).abs() < 1e-13, "{rows} x {columns}: {value} {expected}");
            }
        }
    }
}
