//! The unit in which steps of the contact line are timed: one solution of a dense system with cached LU factors, by faer.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::lu::partial_pivoting as lu;
use faer::perm::PermRef;
use faer::{Mat, Par};
use std::time::Instant;

/// One dense system with cached factors.
pub struct DenseSolution {
    factors: Mat<f64>,
    forward: Vec<usize>,
    inverse: Vec<usize>,
    right: Mat<f64>,
    memory: MemBuffer,
}

impl DenseSolution {
    /// Factors of a diagonally dominant matrix of `count` unknowns.
    pub fn new(count: usize) -> Self {
        let entry = |i: usize, j: usize| if i == j { 4.0 } else { 1.0 / (1.0 + i.abs_diff(j) as f64) };
        let mut factors = Mat::from_fn(count, count, entry);
        let (mut forward, mut inverse) = (vec![0; count], vec![0; count]);
        let parameters = Default::default();
        let mut memory = MemBuffer::new(
            lu::factor::lu_in_place_scratch::<usize, f64>(count, count, Par::Seq, parameters)
                .or(lu::solve::solve_in_place_scratch::<usize, f64>(count, 1, Par::Seq)),
        );
        lu::factor::lu_in_place(
            factors.as_mut(),
            &mut forward,
            &mut inverse,
            Par::Seq,
            MemStack::new(&mut memory),
            parameters,
        );
        Self { factors, forward, inverse, right: Mat::from_fn(count, 1, |i, _| i as f64), memory }
    }

    /// Seconds per solution, of so many one after the other.
    pub fn seconds(&mut self, solutions: usize) -> f64 {
        let count = self.factors.nrows();
        let exchange = PermRef::new_checked(&self.forward, &self.inverse, count);
        let begin = Instant::now();
        for _ in 0..solutions {
            for i in 0..count {
                self.right[(i, 0)] = i as f64;
            }
            lu::solve::solve_in_place(
                self.factors.as_ref(),
                self.factors.as_ref(),
                exchange,
                self.right.as_mut(),
                Par::Seq,
                MemStack::new(&mut self.memory),
            );
        }
        begin.elapsed().as_secs_f64() / solutions as f64
    }
}
