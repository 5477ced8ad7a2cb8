//! Lemke's complementary pivoting with the lexicographic rule.
//!
//! Theory: docs/theory.md, section 6.6.

use nalgebra::{DMatrix, DVector};
use numerics::dense;

/// Reason why Lemke's algorithm found no solution.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LemkeError {
    /// Termination on a ray. For a positive semidefinite matrix this proves that no feasible point exists.
    Ray,
    /// The pivot limit was reached, which rounding alone can cause.
    PivotLimit,
}

/// Solution of a linear complementarity problem.
#[derive(Clone, Debug)]
pub struct LemkeSolution {
    /// For every index whether `z` (true) or `w` (false) is basic.
    pub basic: Vec<bool>,
    /// Number of pivots taken.
    pub pivots: usize,
}

/// Solves for `z >= 0` with `w = M z + q >= 0` and `z_i w_i = 0`, n x n matrix `M`, with free unknowns `first`; see
/// [`Pivoting::solve`].
pub fn solve_mixed(matrix: &DMatrix<f64>, q: &DVector<f64>, first: &[usize]) -> Result<LemkeSolution, LemkeError> {
    let order = q.len() - first.len();
    let mut basic = vec![false; order];
    let pivots = Pivoting::new(order).solve(matrix.as_slice(), q.as_slice(), first, &mut basic)?;
    Ok(LemkeSolution { basic, pivots })
}

/// Largest number of free unknowns beside the complementary ones.
const FREE_UNKNOWNS: usize = 2;
/// Largest order of the block that is solved with a pivot: they and their conditions.
const BLOCK: usize = 2 * FREE_UNKNOWNS;

/// Workspace of Lemke's algorithm for problems with n complementary unknowns: n (2 n + 2) numbers.
///
/// The tableau holds `w - M z - z0 = q` in the current basis. Columns: w (n), z (n), z0, right-hand side.
#[derive(Clone, Debug)]
pub(crate) struct Pivoting {
    columns: DMatrix<f64>,
    basis: Vec<usize>,
    factors: Vec<f64>,
    /// Candidate rows of a ratio test.
    rows: Vec<usize>,
    /// Indices of the cells in the order of the rows.
    order: Vec<usize>,
}

impl Pivoting {
    /// Memory for `order` complementary unknowns.
    pub(crate) fn new(order: usize) -> Self {
        Self {
            // Untouched zeros cost no physical memory while no contact needs pivoting.
            columns: DMatrix::from_vec(order, 2 * order + 2, vec![0.0; order * (2 * order + 2)]),
            basis: vec![0; order],
            factors: vec![0.0; order],
            rows: Vec::with_capacity(order),
            order: Vec::with_capacity(order),
        }
    }

    /// Solves for `z >= 0` with complementary `w >= 0` and free unknowns `y` in `(w, 0) = M (z, y) + q`.
    ///
    /// `M` (by columns) is of order n + f, the free unknowns last, positive semidefinite, f at most [`FREE_UNKNOWNS`]. One
    /// block pivot on the cells `first` (as many as there are free unknowns, and such that the pivot block is regular) and
    /// the free unknowns brings these into the basis, where the free ones stay. The rest is a linear complementarity problem
    /// of order n, whose matrix is positive semidefinite because principal pivots preserve that. Sets for every index
    /// whether `z` is `basic`, and returns the number of pivots.
    ///
    /// With the lexicographic ratio test no basis recurs, so the algorithm terminates after finitely many pivots, whatever
    /// the degeneracy. For a positive semidefinite `M`, symmetric or not, it terminates in a solution if the inequalities
    /// have a feasible point. One pivot costs `2 n (2n + 2)` operations, a solution typically n to 3 n pivots. No
    /// allocation.
    ///
    /// Source: R. W. Cottle, J.-S. Pang, R. E. Stone, The Linear Complementarity Problem, algorithm 4.4.5 and theorem
    /// 4.4.13.
    pub(crate) fn solve(
        &mut self,
        matrix: &[f64],
        q: &[f64],
        first: &[usize],
        basic: &mut [bool],
    ) -> Result<usize, LemkeError> {
        let (n, free) = (self.basis.len(), first.len());
        assert!(free <= FREE_UNKNOWNS, "at most {FREE_UNKNOWNS} free unknowns");
        assert!(matrix.len() == (n + free) * (n + free) && q.len() == n + free && basic.len() == n, "order n + f");
        self.reduce(matrix, q, first)?;
        let pivots = self.pivot_to_the_end()?;
        basic.fill(false);
        for &variable in &self.basis {
            if variable >= n {
                basic[self.order[variable - n]] = true;
            }
        }
        // The roles of the first cells are exchanged: their z is basic at the start.
        for &cell in first {
            basic[cell] = !basic[cell];
        }
        Ok(pivots)
    }

    /// Fills the tableau with the problem that remains after the block pivot on `first` and the free unknowns.
    fn reduce(&mut self, matrix: &[f64], q: &[f64], first: &[usize]) -> Result<(), LemkeError> {
        let (n, free) = (self.basis.len(), first.len());
        let size = 2 * free;
        let at = |i: usize, j: usize| matrix[i + j * (n + free)];
        let pivot_active_set = |k: usize| if k < free { first[k] } else { n + k - free };
        self.order.clear();
        self.order.extend(first);
        self.order.extend((0..n).filter(|i| !first.contains(i)));
        let mut block = [0.0; BLOCK * BLOCK];
        for l in 0..size {
            for k in 0..size {
                block[k + l * size] = at(pivot_active_set(k), pivot_active_set(l));
            }
        }
        let mut exchanged = [0; BLOCK];
        if !dense::factorise(&mut block[..size * size], size, &mut exchanged[..size]) {
            return Err(LemkeError::Ray);
        }
        let solve = |mut right: [f64; BLOCK]| {
            dense::substitute(&block[..size * size], size, &exchanged[..size], &mut right[..size]);
            right
        };
        self.columns.fill(0.0);
        for i in 0..n {
            self.basis[i] = i;
            self.columns[(i, i)] = 1.0;
            self.columns[(i, 2 * n)] = -1.0;
        }
        for c in 0..n {
            // Values of the pivoted unknowns for a unit of this column's unknown.
            let mut unit = [0.0; BLOCK];
            if c < free {
                unit[c] = 1.0;
            } else {
                unit = std::array::from_fn(|k| if k < size { -at(pivot_active_set(k), self.order[c]) } else { 0.0 });
            }
            let taken = solve(unit);
            for (r, &cell) in self.order.iter().enumerate() {
                let own = if c < free || r < free { 0.0 } else { at(cell, self.order[c]) };
                let shared = (0..size).map(|k| at(cell, pivot_active_set(k)) * taken[k]).sum::<f64>();
                self.columns[(r, n + c)] = -if r < free { taken[r] } else { own + shared };
            }
        }
        let taken = solve(std::array::from_fn(|k| if k < size { -q[pivot_active_set(k)] } else { 0.0 }));
        for (r, &cell) in self.order.iter().enumerate() {
            let shared = (0..size).map(|k| at(cell, pivot_active_set(k)) * taken[k]).sum::<f64>();
            self.columns[(r, 2 * n + 1)] = if r < free { taken[r] } else { q[cell] + shared };
        }
        Ok(())
    }

    fn pivot_to_the_end(&mut self) -> Result<usize, LemkeError> {
        let n = self.basis.len();
        if self.columns.column(2 * n + 1).iter().all(|q| *q >= 0.0) {
            return Ok(0);
        }
        let artificial = 2 * n;
        // The first pivot makes all right-hand sides positive: the lexicographically most negative row leaves.
        self.rows.clear();
        self.rows.extend(0..n);
        self.factors.fill(1.0);
        let mut row = self.lexicographic_first();
        let mut entering = artificial;
        let limit = 50 * n + 100;
        for pivots in 1..=limit {
            let leaving = self.pivot(row, entering);
            if leaving == artificial {
                return Ok(pivots);
            }
            entering = if leaving < n { leaving + n } else { leaving - n };
            self.factors.copy_from_slice(self.columns.column(entering).as_slice());
            let most = self.factors.iter().fold(1e-300, |most: f64, value| most.max(value.abs()));
            self.rows.clear();
            self.rows.extend((0..n).filter(|&i| self.factors[i] > 1e-12 * most));
            if self.rows.is_empty() {
                return Err(LemkeError::Ray);
            }
            row = self.lexicographic_first();
        }
        Err(LemkeError::PivotLimit)
    }

    /// Row among `rows` with the lexicographically smallest `(right-hand side, inverse basis)/factor`.
    fn lexicographic_first(&mut self) -> usize {
        let n = self.basis.len();
        let (columns, factors, rows) = (&self.columns, &self.factors, &mut self.rows);
        for column in std::iter::once(2 * n + 1).chain(0..n) {
            let ratio = |i: usize| columns[(i, column)] / factors[i];
            let least = rows.iter().map(|&i| ratio(i)).fold(f64::INFINITY, f64::min);
            let tie = 1e-13 * least.abs();
            rows.retain(|&i| ratio(i) <= least + tie);
            if rows.len() == 1 {
                break;
            }
        }
        // The artificial variable leaves wherever it ties, which gives the solution.
        rows.iter().copied().find(|&i| self.basis[i] == 2 * n).unwrap_or(rows[0])
    }

    /// Exchanges the basic variable of `row` for `entering` and returns the one that leaves.
    fn pivot(&mut self, row: usize, entering: usize) -> usize {
        self.factors.copy_from_slice(self.columns.column(entering).as_slice());
        let pivot = self.factors[row];
        self.factors[row] = 0.0;
        for mut column in self.columns.column_iter_mut() {
            let value = column[row] / pivot;
            if value != 0.0 {
                for (entry, factor) in column.iter_mut().zip(&self.factors) {
                    *entry -= value * factor;
                }
            }
            column[row] = value;
        }
        std::mem::replace(&mut self.basis[row], entering)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(matrix: &DMatrix<f64>, q: &DVector<f64>) -> LemkeSolution {
        let solution = solve_mixed(matrix, q, &[]).unwrap();
        let active: Vec<usize> = (0..q.len()).filter(|&i| solution.basic[i]).collect();
        let block = matrix.select_rows(&active).select_columns(&active);
        let values =
            if active.is_empty() { DVector::zeros(0) } else { block.lu().solve(&-q.select_rows(&active)).unwrap() };
        let mut z = DVector::zeros(q.len());
        for (k, &i) in active.iter().enumerate() {
            z[i] = values[k];
        }
        let w = matrix * &z + q;
        assert!(z.min() >= -1e-12 && w.min() >= -1e-11, "{z} {w}");
        solution
    }

    #[test]
    fn cycling_example_of_a_p_matrix_ends() {
        // Murty's matrix, on which principal pivoting of the most negative index cycles.
        let matrix = DMatrix::from_row_slice(3, 3, &[1.0, 2.0, 0.0, 0.0, 1.0, 2.0, 2.0, 0.0, 1.0]);
        let solution = check(&matrix, &DVector::from_vec(vec![-1.0, -1.0, -1.0]));
        assert_eq!(solution.basic, [true, true, true]);
    }

    #[test]
    fn degenerate_problem_ends() {
        // All ratios tie: equal rows, zero right-hand sides among them.
        let n = 12;
        let matrix = DMatrix::from_fn(n, n, |i, j| if i == j { 2.0 } else { 1.0 });
        let q = DVector::from_fn(n, |i, _| if i % 3 == 0 { 0.0 } else { -1.0 });
        check(&matrix, &q);
    }

    #[test]
    fn infeasible_problem_ends_on_a_ray() {
        let matrix = DMatrix::from_row_slice(2, 2, &[0.0, 1.0, -1.0, 0.0]);
        assert_eq!(solve_mixed(&matrix, &DVector::from_vec(vec![1.0, -1.0]), &[]).unwrap_err(), LemkeError::Ray);
    }

    #[test]
    fn random_problems_are_solved() {
        let mut numbers = test_support::Random(12345);
        let mut random = || numbers.next() - 0.5;
        for n in [1, 2, 5, 20, 60] {
            let factor = DMatrix::from_fn(n, n, |_, _| random());
            let skew = DMatrix::from_fn(n, n, |_, _| random());
            let matrix = &factor * factor.transpose() + 0.01 * DMatrix::identity(n, n) + &skew - skew.transpose();
            let q = DVector::from_fn(n, |_, _| random());
            let solution = check(&matrix, &q);
            assert!(solution.pivots <= 10 * n + 2);
        }
    }
}
