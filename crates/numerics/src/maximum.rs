//! Maxima that propagate NaN.
//!
//! `f64::max` ignores a NaN argument, so a norm built with it takes an iteration that has produced a NaN for converged.
//! Every residual, error and convergence norm is built with these functions instead.

/// The larger of two numbers; NaN if either is.
#[inline(always)]
#[must_use]
pub fn maximum(left: f64, right: f64) -> f64 {
    // Both comparisons are false where `right` is NaN.
    if left > right || left.is_nan() { left } else { right }
}

/// Maximum norm of the non-negative `values`; 0 if empty, NaN if one of them is.
#[inline]
#[must_use]
pub fn largest(values: impl IntoIterator<Item = f64>) -> f64 {
    values.into_iter().fold(0.0, maximum)
}

/// Whether all numbers are finite, by one sum of products with 0, which are NaN for infinite or NaN numbers: branch-free.
#[inline(always)]
#[must_use]
pub fn all_finite(values: &[f64]) -> bool {
    let mut sum = [0.0; 4];
    let (groups, rest) = values.as_chunks::<4>();
    for group in groups {
        for (sum, value) in sum.iter_mut().zip(group) {
            *sum += 0.0 * value;
        }
    }
    let rest: f64 = rest.iter().map(|value| 0.0 * value).sum();
    (sum[0] + sum[2]) + (sum[1] + sum[3]) + rest == 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_maximum_keeps_a_nan_wherever_it_stands() {
        assert_eq!((maximum(1.0, 2.0), maximum(2.0, 1.0), maximum(-1.0, -2.0)), (2.0, 2.0, -1.0));
        assert!(maximum(f64::NAN, 1.0).is_nan() && maximum(1.0, f64::NAN).is_nan());
        assert_eq!(largest([]), 0.0);
        assert_eq!(largest([0.5, 3.0, 2.0]), 3.0);
        for place in 0..3 {
            let mut values = [0.5, 3.0, 2.0];
            values[place] = f64::NAN;
            assert!(largest(values).is_nan(), "{place}");
        }
    }

    #[test]
    fn one_number_that_is_not_finite_is_found_wherever_it_stands() {
        for count in 0..10 {
            let mut values = vec![f64::MAX; count];
            assert!(all_finite(&values));
            for place in 0..count {
                for wrong in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
                    let right = std::mem::replace(&mut values[place], wrong);
                    assert!(!all_finite(&values), "{wrong} at {place} of {count}");
                    values[place] = right;
                }
            }
        }
    }
}
