//! Convex quadratic programme with bounds on all unknowns and a few linear constraints.
//!
//! Theory: docs/theory.md, section 9.2.

use contact::lemke;
use nalgebra::{DMatrix, DVector};
use numerics::factorization;
use std::fmt;

/// Minimise `d'Q d/2 + c'd` subject to `B'd = r` and `lower <= d <= upper`.
///
/// Q is N x N, symmetric and positive definite on the d with `B'd = 0`; B has m columns, m at most 2 (force and moment
/// balance), regular on the first and last row.
#[derive(Clone, Debug)]
pub struct BoxProgramme {
    /// Q.
    pub quadratic: DMatrix<f64>,
    /// c.
    pub linear: DVector<f64>,
    /// B, N x m.
    pub constraints: DMatrix<f64>,
    /// r.
    pub right: DVector<f64>,
    /// Lower bounds.
    pub lower: DVector<f64>,
    /// Upper bounds, above the lower ones.
    pub upper: DVector<f64>,
}

/// Solution of a [`BoxProgramme`].
#[derive(Clone, Debug)]
pub struct BoxSolution {
    /// d.
    pub values: DVector<f64>,
    /// Multipliers of the constraints: `Q d + c = B multipliers` where d is between its bounds.
    pub multipliers: DVector<f64>,
}

/// Reason for which a programme has no solution.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ProgrammeError {
    /// No values within the bounds satisfy the constraints.
    Infeasible,
}

impl fmt::Display for ProgrammeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "quadratic programme: no pressures within their bounds balance force and moment")
    }
}

impl std::error::Error for ProgrammeError {}

#[derive(Clone, Copy, PartialEq, Eq)]
enum BoundStatus {
    Lower,
    Free,
    Upper,
}

/// Iterations that change many unknowns at once, after which pivots one at a time, which always end, take over.
const ITERATION_LIMIT: usize = 40;
/// Part of the largest pressure or gap that is rounding.
pub(crate) const ROUNDING: f64 = 1e-12;

impl BoxProgramme {
    /// Primal-dual active set method from all unknowns free; if an active set recurs, Lemke's algorithm, which is finite.
    pub fn solve(&self) -> Result<BoxSolution, ProgrammeError> {
        let count = self.linear.len();
        let mut statuses = vec![BoundStatus::Free; count];
        let mut tried: Vec<Vec<BoundStatus>> = Vec::new();
        while let Some((values, multipliers)) = self.solve_on(&statuses) {
            let next = self.next(&statuses, &values, &multipliers);
            if next == statuses {
                return Ok(BoxSolution { values, multipliers });
            }
            tried.push(std::mem::replace(&mut statuses, next));
            if tried.len() == ITERATION_LIMIT || tried.contains(&statuses) {
                break;
            }
        }
        let statuses = self.pivoted()?;
        let (values, multipliers) = self.solve_on(&statuses).ok_or(ProgrammeError::Infeasible)?;
        Ok(BoxSolution { values, multipliers })
    }

    fn solve_on(&self, statuses: &[BoundStatus]) -> Option<(DVector<f64>, DVector<f64>)> {
        let (count, m) = (statuses.len(), self.right.len());
        let free: Vec<usize> = (0..count).filter(|&i| statuses[i] == BoundStatus::Free).collect();
        let mut values = DVector::from_fn(count, |i, _| match statuses[i] {
            BoundStatus::Lower => self.lower[i],
            BoundStatus::Upper => self.upper[i],
            BoundStatus::Free => 0.0,
        });
        let n = free.len();
        let scale = self.quadratic.diagonal().amax();
        let bound = &self.quadratic * &values + &self.linear;
        let balance = &self.right - self.constraints.transpose() * &values;
        let mut system = DMatrix::zeros(n + m, n + m);
        let mut right = DVector::zeros(n + m);
        for (a, &i) in free.iter().enumerate() {
            for (b, &j) in free.iter().enumerate() {
                system[(a, b)] = self.quadratic[(i, j)] / scale;
            }
            for k in 0..m {
                system[(a, n + k)] = -self.constraints[(i, k)];
                system[(n + k, a)] = self.constraints[(i, k)];
            }
            right[a] = -bound[i] / scale;
        }
        right.rows_mut(n, m).copy_from(&balance);
        if n < m || factorization::solve_mut(system, &mut right).is_err() {
            return None;
        }
        for (a, &i) in free.iter().enumerate() {
            values[i] = right[a];
        }
        Some((values, right.rows(n, m) * scale))
    }

    fn next(&self, statuses: &[BoundStatus], values: &DVector<f64>, multipliers: &DVector<f64>) -> Vec<BoundStatus> {
        let gradient = &self.quadratic * values + &self.linear - &self.constraints * multipliers;
        let tolerance = ROUNDING * (&self.quadratic * values).amax().max(self.linear.amax());
        let place = |i: usize| {
            let slack = ROUNDING * (self.upper[i] - self.lower[i]);
            match statuses[i] {
                BoundStatus::Free if values[i] < self.lower[i] - slack => BoundStatus::Lower,
                BoundStatus::Free if values[i] > self.upper[i] + slack => BoundStatus::Upper,
                BoundStatus::Lower if gradient[i] < -tolerance => BoundStatus::Free,
                BoundStatus::Upper if gradient[i] > tolerance => BoundStatus::Free,
                same => same,
            }
        };
        (0..statuses.len()).map(place).collect()
    }

    /// `d = lower + z`, multipliers nu of the upper bounds: a mixed complementarity problem in (z, nu), positive
    /// semidefinite because Q is.
    fn pivoted(&self) -> Result<Vec<BoundStatus>, ProgrammeError> {
        let (count, m) = (self.linear.len(), self.right.len());
        let scale = self.quadratic.diagonal().amax();
        let mut matrix = DMatrix::zeros(2 * count + m, 2 * count + m);
        matrix.view_mut((0, 0), (count, count)).copy_from(&(&self.quadratic / scale));
        for i in 0..count {
            matrix[(i, count + i)] = 1.0;
            matrix[(count + i, i)] = -1.0;
            for k in 0..m {
                matrix[(i, 2 * count + k)] = -self.constraints[(i, k)];
                matrix[(2 * count + k, i)] = self.constraints[(i, k)];
            }
        }
        let mut q = DVector::zeros(2 * count + m);
        q.rows_mut(0, count).copy_from(&((&self.quadratic * &self.lower + &self.linear) / scale));
        q.rows_mut(count, count).copy_from(&(&self.upper - &self.lower));
        q.rows_mut(2 * count, m).copy_from(&(self.constraints.transpose() * &self.lower - &self.right));
        let first = &[0, count - 1][..m];
        let basic = lemke::solve_mixed(&matrix, &q, first).map_err(|_| ProgrammeError::Infeasible)?.basic;
        let place = |i: usize| match (basic[i], basic[count + i]) {
            (_, true) => BoundStatus::Upper,
            (true, false) => BoundStatus::Free,
            (false, false) => BoundStatus::Lower,
        };
        Ok((0..count).map(place).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn random_programme(seed: u64, count: usize) -> BoxProgramme {
        let mut numbers = test_support::Random(seed);
        let mut random = || numbers.next() - 0.5;
        let factor = DMatrix::from_fn(count, count, |_, _| random());
        BoxProgramme {
            quadratic: &factor * factor.transpose() + DMatrix::identity(count, count) * 0.01,
            linear: DVector::from_fn(count, |_, _| random()),
            constraints: DMatrix::from_fn(count, 2, |i, k| if k == 0 { 1.0 } else { i as f64 / count as f64 - 0.4 }),
            right: DVector::from_vec(vec![0.3, -0.1]),
            lower: DVector::repeat(count, -0.2),
            upper: DVector::from_fn(count, |_, _| 0.3 + 0.1 * random()),
        }
    }

    fn check(programme: &BoxProgramme, solution: &BoxSolution) {
        let d = &solution.values;
        let gradient = &programme.quadratic * d + &programme.linear - &programme.constraints * &solution.multipliers;
        assert!((programme.constraints.transpose() * d - &programme.right).amax() < 1e-12);
        for i in 0..d.len() {
            let (at_lower, at_upper) = (d[i] - programme.lower[i] < 1e-12, programme.upper[i] - d[i] < 1e-12);
            assert!(d[i] > programme.lower[i] - 1e-12 && d[i] < programme.upper[i] + 1e-12);
            assert!(gradient[i] < 1e-10 || at_lower, "{i}: {}", gradient[i]);
            assert!(gradient[i] > -1e-10 || at_upper, "{i}: {}", gradient[i]);
        }
    }

    #[test]
    fn optimality_conditions_hold() {
        for count in [3, 10, 50] {
            for seed in 0..20 {
                let programme = random_programme(seed, count);
                check(&programme, &programme.solve().unwrap());
            }
        }
    }

    #[test]
    fn pivoting_alone_finds_the_same_values() {
        for seed in 0..10 {
            let programme = random_programme(seed, 20);
            let (values, _) = programme.solve_on(&programme.pivoted().unwrap()).unwrap();
            assert!((values - programme.solve().unwrap().values).amax() < 1e-10);
        }
    }

    #[test]
    fn impossible_balance_is_refused() {
        let mut programme = random_programme(1, 10);
        programme.right[0] = 100.0;
        assert_eq!(programme.solve().unwrap_err(), ProgrammeError::Infeasible);
    }
}
