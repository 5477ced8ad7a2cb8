//! Projection of symmetric matrices on positive semidefinite ones, by removal of the negative eigenvalues.
//!
//! Theory: docs/theory.md, section 4.10.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::evd::{ComputeEigenvectors, self_adjoint_evd, self_adjoint_evd_scratch};
use faer::{Col, Mat, Par};
use numerics::dense;
use numerics::factorization;
use numerics::maximum::maximum;
use std::fmt;

/// Square of the cosine between a uniform flux and its response above which the response is preserved.
const TURNED: f64 = 0.25;

/// Workspace of the projection.
pub struct Passive {
    matrix: Mat<f64>,
    vectors: Mat<f64>,
    values: Col<f64>,
    /// Response to a uniform flux.
    answer: Vec<f64>,
    stack: MemBuffer,
}

impl fmt::Debug for Passive {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.debug_struct("Passive").field("size", &self.values.nrows()).finish()
    }
}

impl Passive {
    /// Workspace for matrices of this size.
    pub fn new(size: usize) -> Passive {
        let eigenvectors = ComputeEigenvectors::Yes;
        let stack = self_adjoint_evd_scratch::<f64>(size, eigenvectors, Par::Seq, Default::default());
        Passive {
            matrix: Mat::zeros(size, size),
            vectors: Mat::zeros(size, size),
            values: Col::zeros(size),
            answer: vec![0.0; size],
            stack: MemBuffer::new(stack),
        }
    }

    fn set(&mut self, values: &[f64], size: usize) {
        for j in 0..size {
            for i in 0..size {
                self.matrix[(i, j)] = 0.5 * (values[j * size + i] + values[i * size + j]);
            }
        }
    }

    /// Whether the symmetric part has no eigenvalue below 0, but for rounding: its Cholesky factor exists.
    pub fn is_passive(&mut self, values: &[f64], size: usize) -> bool {
        self.set(values, size);
        let matrix = &mut self.matrix;
        let shift = 1e-12 * (0..size).map(|i| matrix[(i, i)].abs()).fold(0.0, maximum);
        for k in 0..size {
            let mut pivot = matrix[(k, k)] + shift;
            for i in 0..k {
                pivot -= matrix[(i, k)] * matrix[(i, k)];
            }
            if pivot.is_nan() || pivot <= 0.0 {
                return false;
            }
            let root = pivot.sqrt();
            // Upper factor by columns: both inner products run down a column.
            for j in k + 1..size {
                let mut entry = matrix[(k, j)];
                for i in 0..k {
                    entry -= matrix[(i, k)] * matrix[(i, j)];
                }
                matrix[(k, j)] = entry / root;
            }
        }
        true
    }

    /// Subtracts u u'/(c'u) from the matrix, where c = `uniform` and u is its response; returns the factor 1/(c'u),
    /// reduced where u is far from c.
    fn split_uniform(&mut self, uniform: &[f64]) -> f64 {
        self.answer.fill(0.0);
        for (j, heat) in uniform.iter().enumerate() {
            for (answer, entry) in self.answer.iter_mut().zip(self.matrix.col_as_slice(j)) {
                *answer += entry * heat;
            }
        }
        let [given, square, own] = [[&self.answer[..], uniform], [&self.answer, &self.answer], [uniform, uniform]]
            .map(|[l, r]| dense::dot(l, r));
        if given.is_nan() || given <= 0.0 {
            return 0.0;
        }
        let share = (given * given / (TURNED * square * own)).min(1.0) / given;
        for j in 0..uniform.len() {
            for i in 0..uniform.len() {
                self.matrix[(i, j)] -= share * self.answer[i] * self.answer[j];
            }
        }
        share
    }

    /// Sets the matrix to its symmetric part without the negative eigenvalues; the response to `uniform` is preserved
    /// unless that is empty.
    pub fn project(&mut self, values: &mut [f64], size: usize, uniform: &[f64]) {
        self.set(values, size);
        let share = if uniform.is_empty() { 0.0 } else { self.split_uniform(uniform) };
        if factorization::check(values, size).is_err() {
            return;
        }
        let stack = MemStack::new(&mut self.stack);
        let (diagonal, vectors) = (self.values.as_diagonal_mut(), self.vectors.as_mut());
        let found =
            self_adjoint_evd(self.matrix.as_ref(), diagonal, Some(vectors), Par::Seq, stack, Default::default());
        if found.is_err() {
            // The eigenvalue iteration did not converge: the matrix is left unchanged.
            return;
        }
        values.fill(0.0);
        if share > 0.0 {
            for (column, part) in values.chunks_exact_mut(size).zip(&self.answer) {
                let part = share * part;
                column.iter_mut().zip(&self.answer).for_each(|(entry, other)| *entry = part * other);
            }
        }
        for k in 0..size {
            let eigenvalue = self.values[k].max(0.0);
            let vector = self.vectors.col_as_slice(k);
            for (column, part) in values.chunks_exact_mut(size).zip(vector) {
                let part = eigenvalue * part;
                column.iter_mut().zip(vector).for_each(|(entry, other)| *entry += part * other);
            }
        }
    }
}
