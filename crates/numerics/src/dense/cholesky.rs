//! Cholesky factors of a symmetric dense matrix.

/// Factors the lower triangle in place, by columns; false where the matrix is not positive definite.
pub fn cholesky(matrix: &mut [f64], count: usize) -> bool {
    for k in 0..count {
        let (done, rest) = matrix.split_at_mut((k + 1) * count);
        let column = &mut done[k * count..];
        if column[k] <= 0.0 || column[k].is_nan() {
            return false;
        }
        let root = column[k].sqrt();
        column[k..].iter_mut().for_each(|entry| *entry /= root);
        for (offset, target) in rest.chunks_exact_mut(count).enumerate() {
            let j = k + 1 + offset;
            let factor = column[j];
            if factor != 0.0 {
                target[j..].iter_mut().zip(&column[j..]).for_each(|(entry, value)| *entry -= factor * value);
            }
        }
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn factors_give_the_matrix_back_and_an_indefinite_one_has_none() {
        let count = 7;
        let entry = |i: usize, j: usize| if i == j { 3.0 } else { 1.0 / (1.0 + i.abs_diff(j) as f64) };
        let matrix: Vec<f64> = (0..count * count).map(|k| entry(k % count, k / count)).collect();
        let mut factors = matrix.clone();
        assert!(cholesky(&mut factors, count));
        for j in 0..count {
            for i in j..count {
                let product: f64 = (0..=j).map(|k| factors[k * count + i] * factors[k * count + j]).sum();
                assert!((product - matrix[j * count + i]).abs() < 1e-14, "{i} {j}");
            }
        }
        let changed = |value: f64| {
            let mut matrix = matrix.clone();
            matrix[3 * count + 3] = value;
            cholesky(&mut matrix, count)
        };
        assert!(changed(2.0) && !changed(0.1) && !changed(-1.0) && !changed(f64::NAN));
    }
}
