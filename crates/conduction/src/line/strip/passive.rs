//! Passive influence: the symmetric part of an influence per heat has no negative eigenvalue.
//!
//! The truncated part of a reduction at a frequency just beyond its range has a real part of either sign. A negative one
//! in the direct feedthrough lets two bodies in thermal contact raise each other's flux without bound in steps short
//! against the range; the part removed is below the reduction's own error.
//!
//! The response M c to a uniform flux, of heat c, is preserved where c'M c > 0: of
//!
//! ```text
//! M = u u'/(c'u) + S,    u = M c,    S c = 0
//! ```
//!
//! only S loses eigenvalues. The steady mean temperature stays exact, and smooth in the velocity. The weight of u u'
//! decreases to 0 as u turns away from c, where that term would be a large response to all other fluxes.
//!
//! The influence depends on the distance alone and the cells are symmetric about x = 0, so the symmetric part splits into
//! even response to even heat and odd to odd, of (N + 1)/2 rows each.
//!
//! Theory: docs/theory.md, section 4.10.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::evd::{ComputeEigenvectors, self_adjoint_evd, self_adjoint_evd_scratch};
use faer::{Col, Mat, Par};
use nalgebra::DMatrix;
use numerics::dense;
use numerics::factorization;
use numerics::maximum::maximum;
use std::fmt;

/// Workspace of the projection.
pub(crate) struct Passive {
    widths: Vec<f64>,
    /// Even part of the heat of a uniform flux, W/m.
    uniform: Vec<f64>,
    /// Symmetric part of one parity, by columns, and its change.
    part: Vec<f64>,
    before: Vec<f64>,
    matrix: Mat<f64>,
    vectors: Mat<f64>,
    values: Col<f64>,
    /// Response to a uniform flux.
    response: Vec<f64>,
    stack: MemBuffer,
}

impl fmt::Debug for Passive {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.debug_struct("Passive").field("size", &self.values.nrows()).finish()
    }
}

impl Passive {
    /// Workspace for cells of these widths (m), symmetric about x = 0.
    pub(crate) fn new(widths: &[f64]) -> Passive {
        let (count, size) = (widths.len(), widths.len().div_ceil(2));
        let eigenvectors = ComputeEigenvectors::Yes;
        let stack = self_adjoint_evd_scratch::<f64>(size, eigenvectors, Par::Seq, Default::default());
        let uniform = (0..size).map(|a| if count - 1 - a == a { widths[a] } else { 2.0 * widths[a] });
        Passive {
            widths: widths.to_vec(),
            uniform: uniform.collect(),
            part: vec![0.0; size * size],
            before: vec![0.0; size * size],
            matrix: Mat::zeros(size, size),
            vectors: Mat::zeros(size, size),
            values: Col::zeros(size),
            response: vec![0.0; size],
            stack: MemBuffer::new(stack),
        }
    }

    /// Symmetric part of an influence per heat, of one parity, into `part`.
    fn take_part(&mut self, influence: &DMatrix<f64>, parity: f64) {
        let (count, size) = (self.widths.len(), self.uniform.len());
        for b in 0..size {
            for a in 0..size {
                let per_heat = |i: usize, j: usize| influence[(i, j)] / self.widths[j];
                let direct = per_heat(a, b) + per_heat(b, a);
                let mirrored = per_heat(a, count - 1 - b) + per_heat(count - 1 - b, a);
                self.part[b * size + a] = 0.25 * (direct + parity * mirrored);
            }
        }
    }

    /// Whether the symmetric part of an influence per flux, N x N, has no negative eigenvalue.
    pub(crate) fn is_passive(&mut self, influence: &DMatrix<f64>) -> bool {
        [1.0, -1.0].into_iter().all(|parity| {
            self.take_part(influence, parity);
            self.has_factor()
        })
    }

    /// Removes the negative eigenvalues of the symmetric part of an influence per flux, N x N.
    pub(crate) fn make_passive(&mut self, influence: &mut DMatrix<f64>) {
        let (count, size) = (self.widths.len(), self.uniform.len());
        for parity in [1.0, -1.0] {
            self.take_part(influence, parity);
            if !self.has_factor() {
                let mut part = std::mem::take(&mut self.part);
                self.before.copy_from_slice(&part);
                self.project(&mut part, size, parity > 0.0);
                for b in 0..size {
                    for a in 0..size {
                        let change = part[b * size + a] - self.before[b * size + a];
                        let (far_a, far_b) = (count - 1 - a, count - 1 - b);
                        // The cell in the middle is its own mirror image.
                        influence[(a, b)] += change * self.widths[b];
                        if far_b != b {
                            influence[(a, far_b)] += parity * change * self.widths[far_b];
                        }
                        if far_a != a {
                            influence[(far_a, b)] += parity * change * self.widths[b];
                        }
                        if far_a != a && far_b != b {
                            influence[(far_a, far_b)] += change * self.widths[far_b];
                        }
                    }
                }
                self.part = part;
            }
        }
    }

    fn set(&mut self, values: &[f64], size: usize) {
        for j in 0..size {
            for i in 0..size {
                self.matrix[(i, j)] = 0.5 * (values[j * size + i] + values[i * size + j]);
            }
        }
    }

    /// Whether `part` has no eigenvalue below 0, but for rounding: its Cholesky factor exists.
    fn has_factor(&mut self) -> bool {
        let (part, size) = (std::mem::take(&mut self.part), self.uniform.len());
        self.set(&part, size);
        self.part = part;
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

    /// Subtracts u u'/(c'u) from the matrix, where c is the heat of a uniform flux and u its response; returns the factor
    /// 1/(c'u), reduced where u is far from c.
    fn split_uniform(&mut self) -> f64 {
        let uniform = &self.uniform[..];
        self.response.fill(0.0);
        for (j, heat) in uniform.iter().enumerate() {
            for (response, entry) in self.response.iter_mut().zip(self.matrix.col_as_slice(j)) {
                *response += entry * heat;
            }
        }
        let [given, square, own] =
            [[&self.response[..], uniform], [&self.response, &self.response], [uniform, uniform]]
                .map(|[l, r]| dense::dot(l, r));
        if given.is_nan() || given <= 0.0 {
            return 0.0;
        }
        // Square of the cosine between a uniform flux and its response above which the response is preserved.
        let share = (given * given / (0.25 * square * own)).min(1.0) / given;
        for j in 0..uniform.len() {
            for i in 0..uniform.len() {
                self.matrix[(i, j)] -= share * self.response[i] * self.response[j];
            }
        }
        share
    }

    /// Removes the negative eigenvalues of a symmetric matrix; `even`: the response to a uniform flux is preserved.
    fn project(&mut self, values: &mut [f64], size: usize, even: bool) {
        self.set(values, size);
        let share = if even { self.split_uniform() } else { 0.0 };
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
            for (column, part) in values.chunks_exact_mut(size).zip(&self.response) {
                let part = share * part;
                column.iter_mut().zip(&self.response).for_each(|(entry, other)| *entry = part * other);
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
