//! Anderson acceleration of a fixed-point iteration `z <- z + d(z)`.
//!
//! D. G. Anderson, Iterative procedures for nonlinear integral equations, J. ACM 12 (1965) 547, undamped and of type II: the next
//! iterate is the affine combination of the last ones that minimises the step d, taken as linear in between, plus that step. For
//! linear d it is equivalent to GMRES.

use crate::factorization;
use nalgebra::{DMatrix, DVector};

/// Depth: number of differences stored.
const DEPTH: usize = 12;

/// Relative size below which a direction is linearly dependent on the others.
const REPETITION: f64 = 1e-12;

/// Differences of the last iterates and of their steps.
#[derive(Clone, Debug, Default)]
pub struct Acceleration {
    last: Option<(Vec<f64>, Vec<f64>)>,
    /// Differences of iterates, and of their steps.
    moved: Vec<Vec<f64>>,
    turned: Vec<Vec<f64>>,
}

impl Acceleration {
    /// Discards all differences because the step function has changed.
    pub fn clear(&mut self) {
        *self = Acceleration::default();
    }

    /// Next iterate after `iterate` with the step `step`; `weights` scale the entries of a step.
    pub fn next(&mut self, iterate: Vec<f64>, step: Vec<f64>, weights: &[f64]) -> Vec<f64> {
        if let Some((earlier, its_step)) = self.last.take() {
            if self.moved.len() == DEPTH {
                self.moved.remove(0);
                self.turned.remove(0);
            }
            let difference = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a - b).collect::<Vec<f64>>();
            self.moved.push(difference(&iterate, &earlier));
            self.turned.push(difference(&step, &its_step));
        }
        let mut next: Vec<f64> = iterate.iter().zip(&step).map(|(z, d)| z + d).collect();
        if let Some(shares) = self.shares(&step, weights) {
            for ((moved, turned), share) in self.moved.iter().zip(&self.turned).zip(shares) {
                for ((value, moved), turned) in next.iter_mut().zip(moved).zip(turned) {
                    *value -= share * (moved + turned);
                }
            }
        }
        self.last = Some((iterate, step));
        next
    }

    /// Coefficients of the differences that minimise the step.
    fn shares(&self, step: &[f64], weights: &[f64]) -> Option<Vec<f64>> {
        let depth = self.turned.len();
        if depth == 0 {
            return None;
        }
        let dot =
            |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).zip(weights).map(|((a, b), w)| (a * w) * (b * w)).sum() };
        let lengths: Vec<f64> = self.turned.iter().map(|turned| dot(turned, turned).sqrt()).collect();
        if lengths.contains(&0.0) {
            return None;
        }
        let between = |a: usize, b: usize| dot(&self.turned[a], &self.turned[b]) / (lengths[a] * lengths[b]);
        let normal = DMatrix::from_fn(depth, depth, between);
        let projected = DVector::from_fn(depth, |a, _| dot(&self.turned[a], step) / lengths[a]);
        let shares = factorization::least_squares(normal, &projected, REPETITION).ok()?;
        Some(shares.iter().zip(lengths).map(|(share, length)| share / length).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A linear map for which the plain iteration diverges.
    #[test]
    fn a_linear_iteration_ends_after_as_many_steps_as_it_has_directions() {
        let matrix = DMatrix::from_fn(5, 5, |i, j| if i == j { -1.6 } else { 0.3 * ((i + 2 * j) as f64).sin() });
        let right = DVector::from_fn(5, |i, _| 1.0 + i as f64);
        let exact = (DMatrix::identity(5, 5) - &matrix).lu().solve(&right).unwrap();
        let mut acceleration = Acceleration::default();
        let mut iterate = vec![0.0; 5];
        for _ in 0..7 {
            let z = DVector::from_vec(iterate.clone());
            let step = &matrix * &z + &right - &z;
            iterate = acceleration.next(iterate, step.as_slice().to_vec(), &[1.0, 2.0, 0.5, 1.0, 1.0]);
        }
        let error = (DVector::from_vec(iterate) - exact).amax();
        assert!(error < 1e-9, "{error:e}");
    }
}
