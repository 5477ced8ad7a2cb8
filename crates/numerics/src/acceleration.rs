//! Anderson acceleration of a fixed-point iteration `x <- G(x)`.
//!
//! D. G. Anderson, Iterative procedures for nonlinear integral equations, J. ACM 12 (1965) 547, undamped and of type II: from the last
//! residuals `f = G(x) - x` and their differences the next x is the one that would minimise the residual if G were affine. For
//! affine G it is equivalent to GMRES: the few modes along which the iteration converges slowly or diverges are solved for, the
//! others converge as before.
//!
//! Theory: docs/theory.md, section 6.4.

use crate::dense;
use crate::maximum::maximum;

/// Anderson acceleration with at most `DEPTH` stored differences. It allocates nothing after construction.
#[derive(Clone, Debug)]
pub struct Anderson<const DEPTH: usize> {
    start: Vec<f64>,
    value: Vec<f64>,
    residual: Vec<f64>,
    /// Differences of scaled residuals and of values, newest first.
    residuals: [Vec<f64>; DEPTH],
    values: [Vec<f64>; DEPTH],
    stored: usize,
    /// The last residual and value are valid for a difference with the next ones.
    compares: bool,
}

impl<const DEPTH: usize> Anderson<DEPTH> {
    /// For x of `count` entries.
    pub fn new(count: usize) -> Self {
        let zeros = || vec![0.0; count];
        Self {
            start: zeros(),
            value: zeros(),
            residual: zeros(),
            residuals: std::array::from_fn(|_| zeros()),
            values: std::array::from_fn(|_| zeros()),
            stored: 0,
            compares: false,
        }
    }

    /// Discards all differences because G has changed.
    pub fn clear(&mut self) {
        (self.stored, self.compares) = (0, false);
    }

    /// Whether nothing is stored: the scale may change then.
    pub fn is_clear(&self) -> bool {
        !self.compares
    }

    /// Stores x before an iteration; its parts follow one another.
    pub fn begin(&mut self, parts: &[&[f64]]) {
        let entries = parts.iter().flat_map(|part| part.iter());
        self.start.iter_mut().zip(entries).for_each(|(own, entry)| *own = *entry);
    }

    /// Replaces G(x) by the accelerated next x. `scale` weights entry i of a residual; it must stay the same until
    /// [`Self::clear`]. Returns the largest change of each part by this; `None` where no difference is available yet.
    pub fn accelerate<const PARTS: usize>(
        &mut self,
        parts: [&mut [f64]; PARTS],
        scale: impl Fn(usize) -> f64,
    ) -> Option<[f64; PARTS]> {
        self.residuals.rotate_right(1);
        self.values.rotate_right(1);
        for (i, value) in parts.iter().flat_map(|part| part.iter()).enumerate() {
            let residual = scale(i) * (value - self.start[i]);
            self.residuals[0][i] = residual - self.residual[i];
            self.values[0][i] = value - self.value[i];
            (self.residual[i], self.value[i]) = (residual, *value);
        }
        if !std::mem::replace(&mut self.compares, true) {
            // Without a previous residual the newest entry is no difference: the rotation is undone.
            self.residuals.rotate_left(1);
            self.values.rotate_left(1);
            return None;
        }
        self.stored = (self.stored + 1).min(DEPTH);
        let factors = self.least();
        let mut first = 0;
        Some(parts.map(|part| {
            let mut most = 0.0;
            for (i, value) in (first..).zip(part.iter_mut()) {
                let change: f64 = factors.iter().zip(&self.values).map(|(factor, values)| factor * values[i]).sum();
                *value -= change;
                most = maximum(most, change.abs());
            }
            first += part.len();
            most
        }))
    }

    /// Coefficients of the differences that minimise the residual, by Gram-Schmidt orthogonalisation, newest first.
    fn least(&self) -> [f64; DEPTH] {
        let mut products = [[0.0; DEPTH]; DEPTH];
        let mut parts = [0.0; DEPTH];
        for k in 0..self.stored {
            parts[k] = dense::dot(&self.residuals[k], &self.residual);
            for j in 0..=k {
                products[k][j] = dense::dot(&self.residuals[k], &self.residuals[j]);
                products[j][k] = products[k][j];
            }
        }
        let product = |one: &[f64; DEPTH], other: &[f64; DEPTH]| -> f64 {
            one.iter().zip(&products).map(|(factor, row)| factor * multiply(row, other)).sum()
        };
        let mut factors = [0.0; DEPTH];
        // Orthonormal directions as coefficients of the differences.
        let mut directions = [[0.0; DEPTH]; DEPTH];
        for k in 0..self.stored {
            let mut own = [0.0; DEPTH];
            own[k] = 1.0;
            // A second pass removes what rounding leaves of the other directions.
            for _ in 0..2 {
                for direction in &directions[..k] {
                    let shared = product(&own, direction);
                    own.iter_mut().zip(direction).for_each(|(own, other)| *own -= shared * other);
                }
            }
            let square = product(&own, &own);
            // Least part of a difference, squared, that must be linearly independent of the others for it to be used.
            if square > 1e-9 * products[k][k] {
                let norm = square.sqrt().recip();
                directions[k] = own.map(|value| value * norm);
                let part = multiply(&directions[k], &parts);
                factors.iter_mut().zip(&directions[k]).for_each(|(factor, own)| *factor += part * own);
            }
        }
        factors
    }
}

fn multiply<const DEPTH: usize>(a: &[f64; DEPTH], b: &[f64; DEPTH]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, DVector};

    /// Number of iterations until x = Ax + b is satisfied to 1e-9, at most 60; A has the given eigenvalues.
    fn iterations(eigenvalues: &[f64], accelerated: bool) -> usize {
        let count = eigenvalues.len();
        let mut anderson = Anderson::<8>::new(count);
        let mut x = vec![0.0; count];
        // A Householder reflection makes A a full matrix.
        let normal: Vec<f64> = (0..count).map(|i| (1.0 + i as f64).sin()).collect();
        let square = dense::dot(&normal, &normal);
        let reflect = |x: &[f64]| -> Vec<f64> {
            let part = 2.0 * dense::dot(&normal, x) / square;
            x.iter().zip(&normal).map(|(x, n)| x - part * n).collect()
        };
        for iteration in 0..60 {
            let mut next = reflect(&x);
            next.iter_mut().zip(eigenvalues).for_each(|(x, eigenvalue)| *x *= eigenvalue);
            next = reflect(&next);
            next.iter_mut().for_each(|x| *x += 1.0);
            let change = next.iter().zip(&x).fold(0.0_f64, |most, (a, b)| most.max((a - b).abs()));
            if change < 1e-9 {
                return iteration;
            }
            if accelerated {
                let (one, other) = x.split_at(count / 3);
                anderson.begin(&[one, other]);
                let (one, other) = next.split_at_mut(count / 3);
                anderson.accelerate([one, other], |i| if i < count / 3 { 1.0 } else { 2.0 });
            }
            x = next;
        }
        60
    }

    #[test]
    fn a_stored_difference_fixes_the_scale_until_it_is_discarded() {
        let mut anderson = Anderson::<2>::new(1);
        assert!(anderson.is_clear());
        anderson.begin(&[&[1.0]]);
        assert!(anderson.accelerate([&mut [0.5]], |_| 1.0).is_none() && !anderson.is_clear());
        anderson.clear();
        assert!(anderson.is_clear());
    }

    #[test]
    fn a_few_modes_that_converge_slowly_or_diverge_are_solved_for() {
        let mut eigenvalues = [0.02, -0.03, 0.01, 0.0, 0.03, -0.01, 0.02, 0.01, -0.02, 0.0, 0.01, -0.01];
        let plain = iterations(&eigenvalues, false);
        assert!(plain <= 8 && iterations(&eigenvalues, true) <= plain);
        for one in [0.9, 0.99, -0.95, -3.0, 1.5] {
            eigenvalues[3] = one;
            assert_eq!(iterations(&eigenvalues, false), 60, "{one}");
            let found = iterations(&eigenvalues, true);
            assert!(found <= 10, "{one}: {found}");
            eigenvalues[8] = -0.8;
            let found = iterations(&eigenvalues, true);
            assert!(found <= 13, "{one} and another: {found}");
            eigenvalues[8] = -0.02;
        }
    }

    /// A linear map for which the plain iteration diverges.
    #[test]
    fn a_linear_iteration_ends_after_as_many_steps_as_it_has_directions() {
        let matrix = DMatrix::from_fn(5, 5, |i, j| if i == j { -1.6 } else { 0.3 * ((i + 2 * j) as f64).sin() });
        let right = DVector::from_fn(5, |i, _| 1.0 + i as f64);
        let exact = (DMatrix::identity(5, 5) - &matrix).lu().solve(&right).unwrap();
        let mut anderson = Anderson::<12>::new(5);
        let mut x = DVector::zeros(5);
        for _ in 0..7 {
            anderson.begin(&[x.as_slice()]);
            x = &matrix * &x + &right;
            anderson.accelerate([x.as_mut_slice()], |i| [1.0, 2.0, 0.5, 1.0, 1.0][i]);
        }
        let error = (x - exact).amax();
        assert!(error < 1e-9, "{error:e}");
    }
}
