//! Lemke's complementary pivoting with the lexicographic rule.

use nalgebra::{DMatrix, DVector};

/// Why Lemke's algorithm found no solution.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LemkeError {
    /// It ended on a ray. For a positive semidefinite matrix this proves that no feasible point exists.
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

/// Finds `z >= 0` with `w = M z + q >= 0` and `z_i w_i = 0`, n x n matrix `M`.
///
/// With the lexicographic ratio test no basis returns, so the algorithm ends after finitely many pivots, whatever the
/// degeneracy. For a positive semidefinite `M`, symmetric or not, it ends in a solution if the inequalities have a
/// feasible point at all. One pivot costs `2 n (2n + 2)` operations, a solution typically n to 3 n pivots.
///
/// Source: R. W. Cottle, J.-S. Pang, R. E. Stone, The Linear Complementarity Problem, algorithm 4.4.5 and theorem 4.4.13.
pub fn solve(matrix: &DMatrix<f64>, q: &DVector<f64>) -> Result<LemkeSolution, LemkeError> {
    let n = q.len();
    let most_negative = q.iter().copied().fold(0.0, f64::min);
    if most_negative >= 0.0 {
        return Ok(LemkeSolution { basic: vec![false; n], pivots: 0 });
    }
    let mut tableau = Tableau::new(matrix, q);
    let artificial = 2 * n;
    // The first pivot makes all right-hand sides positive: the lexicographically most negative row leaves.
    let mut row = tableau.lexicographic_first(0..n, |_| 1.0);
    let mut entering = artificial;
    let limit = 50 * n + 100;
    for pivots in 1..=limit {
        let leaving = tableau.pivot(row, entering);
        if leaving == artificial {
            let mut basic = vec![false; n];
            for &variable in &tableau.basis {
                if variable >= n {
                    basic[variable - n] = true;
                }
            }
            return Ok(LemkeSolution { basic, pivots });
        }
        entering = if leaving < n { leaving + n } else { leaving - n };
        let column = tableau.columns.column(entering).clone_owned();
        let threshold = 1e-12 * column.amax().max(1e-300);
        let candidates: Vec<usize> = (0..n).filter(|&i| column[i] > threshold).collect();
        if candidates.is_empty() {
            return Err(LemkeError::Ray);
        }
        row = tableau.lexicographic_first(candidates.into_iter(), |i| column[i]);
    }
    Err(LemkeError::PivotLimit)
}

/// Finds `z >= 0` with complementary `w >= 0` and free unknowns `y` in `(w, 0) = M (z, y) + q`.
///
/// `M` is of order n + f, the free unknowns last, positive semidefinite. One block pivot on the cells `first` (as many
/// as there are free unknowns, and such that the pivot block is regular) and the free unknowns brings these into the
/// basis, where the free ones stay; what is left is a linear complementarity problem of order n, whose matrix is
/// positive semidefinite as principal pivots keep it. Returns for every index whether `z` is basic.
pub fn solve_mixed(matrix: &DMatrix<f64>, q: &DVector<f64>, first: &[usize]) -> Result<LemkeSolution, LemkeError> {
    let free = first.len();
    let n = q.len() - free;
    let rest: Vec<usize> = (0..n).filter(|i| !first.contains(i)).collect();
    let pivoted: Vec<usize> = first.iter().copied().chain(n..n + free).collect();
    let block = |rows: &[usize], columns: &[usize]| matrix.select_rows(rows).select_columns(columns);
    let inverse = if free == 0 {
        DMatrix::zeros(0, 0)
    } else {
        block(&pivoted, &pivoted).try_inverse().ok_or(LemkeError::Ray)?
    };
    let upper = -&inverse * block(&pivoted, &rest);
    let lower = block(&rest, &pivoted) * &inverse;
    let corner = block(&rest, &rest) + block(&rest, &pivoted) * &upper;
    let q_pivoted = q.select_rows(&pivoted);
    let (m, k) = (free, rest.len());
    let mut reduced = DMatrix::zeros(n, n);
    reduced.view_mut((0, 0), (m, m)).copy_from(&inverse.view((0, 0), (m, m)));
    reduced.view_mut((0, m), (m, k)).copy_from(&upper.rows(0, m));
    reduced.view_mut((m, 0), (k, m)).copy_from(&lower.columns(0, m));
    reduced.view_mut((m, m), (k, k)).copy_from(&corner);
    let mut constant = DVector::zeros(n);
    constant.rows_mut(0, m).copy_from(&(-&inverse * &q_pivoted).rows(0, m));
    constant.rows_mut(m, k).copy_from(&(q.select_rows(&rest) - &lower * &q_pivoted));
    let solution = solve(&reduced, &constant)?;
    let mut basic = vec![false; n];
    for (position, &i) in first.iter().chain(&rest).enumerate() {
        // For the first cells the roles are exchanged: there z is the basic variable at the start.
        basic[i] = solution.basic[position] != (position < m);
    }
    Ok(LemkeSolution { basic, pivots: solution.pivots })
}

/// `w - M z - z0 = q` in the current basis. Columns: w (n), z (n), z0, right-hand side.
struct Tableau {
    columns: DMatrix<f64>,
    basis: Vec<usize>,
}

impl Tableau {
    fn new(matrix: &DMatrix<f64>, q: &DVector<f64>) -> Self {
        let n = q.len();
        let mut columns = DMatrix::zeros(n, 2 * n + 2);
        for i in 0..n {
            columns[(i, i)] = 1.0;
            columns[(i, 2 * n)] = -1.0;
            columns[(i, 2 * n + 1)] = q[i];
            for j in 0..n {
                columns[(i, n + j)] = -matrix[(i, j)];
            }
        }
        Self { columns, basis: (0..n).collect() }
    }

    /// Among the rows the one with the lexicographically smallest `(right-hand side, inverse basis)/divisor`.
    fn lexicographic_first(&self, rows: impl Iterator<Item = usize>, divisor: impl Fn(usize) -> f64) -> usize {
        let n = self.basis.len();
        let mut rows: Vec<usize> = rows.collect();
        for column in std::iter::once(2 * n + 1).chain(0..n) {
            let ratio = |i: usize| self.columns[(i, column)] / divisor(i);
            let least = rows.iter().map(|&i| ratio(i)).fold(f64::INFINITY, f64::min);
            let tie = 1e-13 * least.abs();
            rows.retain(|&i| ratio(i) <= least + tie);
            if rows.len() == 1 {
                break;
            }
        }
        // The artificial variable leaves wherever it ties: that is the solution.
        rows.iter().copied().find(|&i| self.basis[i] == 2 * n).unwrap_or(rows[0])
    }

    /// Exchanges the basic variable of `row` for `entering` and returns the one that leaves.
    fn pivot(&mut self, row: usize, entering: usize) -> usize {
        let mut factors = self.columns.column(entering).clone_owned();
        let pivot = factors[row];
        factors[row] = 0.0;
        for mut column in self.columns.column_iter_mut() {
            let value = column[row] / pivot;
            if value != 0.0 {
                column.axpy(-value, &factors, 1.0);
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
        let solution = solve(matrix, q).unwrap();
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
    fn small_problem_with_known_solution() {
        let matrix = DMatrix::from_row_slice(2, 2, &[2.0, 1.0, 1.0, 2.0]);
        let solution = check(&matrix, &DVector::from_vec(vec![-5.0, -6.0]));
        assert_eq!(solution.basic, [true, true]);
        let solution = check(&matrix, &DVector::from_vec(vec![-5.0, 1.0]));
        assert_eq!(solution.basic, [true, false]);
    }

    #[test]
    fn cycling_example_of_a_p_matrix_ends() {
        // Murty's matrix, on which principal pivoting of the most negative index runs in a circle.
        let matrix = DMatrix::from_row_slice(3, 3, &[1.0, 2.0, 0.0, 0.0, 1.0, 2.0, 2.0, 0.0, 1.0]);
        let solution = check(&matrix, &DVector::from_vec(vec![-1.0, -1.0, -1.0]));
        assert_eq!(solution.basic, [true, true, true]);
    }

    #[test]
    fn degenerate_problem_ends() {
        // Every ratio ties: equal rows, zero right-hand sides among them.
        let n = 12;
        let matrix = DMatrix::from_fn(n, n, |i, j| if i == j { 2.0 } else { 1.0 });
        let q = DVector::from_fn(n, |i, _| if i % 3 == 0 { 0.0 } else { -1.0 });
        check(&matrix, &q);
    }

    #[test]
    fn infeasible_problem_ends_on_a_ray() {
        let matrix = DMatrix::from_row_slice(2, 2, &[0.0, 1.0, -1.0, 0.0]);
        assert_eq!(solve(&matrix, &DVector::from_vec(vec![1.0, -1.0])).unwrap_err(), LemkeError::Ray);
    }

    #[test]
    fn random_problems_are_solved() {
        let mut state = 12345u64;
        let mut random = || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5
        };
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
