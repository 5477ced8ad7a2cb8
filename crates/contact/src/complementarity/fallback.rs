//! Complementary pivoting where active sets cycle: the problem scaled for [`lemke`](crate::lemke).
//!
//! Theory: docs/theory.md, section 6.6.

use super::balance::Balance;
use super::{ContactProblem, ContactSolver, Memory};
use crate::problem::ContactError;

impl ContactSolver {
    /// Determines the active set by complementary pivoting, into the workspace. Rows are weighted with w, so that the
    /// bordered matrix is positive semidefinite. The first pivot is on the outermost cells; under a load it eliminates a
    /// uniform displacement of all cells, however large thermal distortion makes it. Lengths along x in half-widths,
    /// pressure in metres of displacement.
    pub(super) fn pivot_active_set(
        &mut self,
        problem: &ContactProblem<'_>,
        balance: &Balance,
        memory: &mut Memory,
    ) -> Result<(), ContactError> {
        let (count, free) = (self.positions.len(), balance.count());
        let size = count + free;
        // Scale of the stiffest cell: a few may be softened by orders of magnitude (fast wear).
        let own = |i: usize| self.factors.own(i) + problem.diagonal[i];
        let scale = (0..count).map(own).fold(f64::INFINITY, f64::min);
        let (matrix, right) = (&mut memory.pivoted_matrix[..size * size], &mut memory.pivoted_right[..size]);
        matrix.fill(0.0);
        let x = |i: usize| self.positions[i] / self.length;
        let lever = balance.lever / self.length;
        let weight = |i: usize| self.weights[i] / self.total_weight;
        for j in 0..count {
            for i in 0..count {
                let wear = match self.factors.operator() {
                    None if i == j => problem.diagonal[j],
                    None => 0.0,
                    Some(operator) => problem.diagonal[j] * operator[i + j * count],
                };
                matrix[i + j * size] = wear;
            }
        }
        let compliance = self.factors.compliance(problem.signed_friction);
        for j in 0..count {
            for i in 0..count {
                let entry = &mut matrix[i + j * size];
                *entry = (*entry + compliance[i + j * count]) / scale * weight(i);
            }
        }
        let to_mean = scale / self.total_weight;
        let spring = balance.stiffness * to_mean;
        for i in 0..count {
            right[i] = memory.gap[i] * weight(i);
            if balance.approach_free {
                matrix[i + count * size] = -weight(i);
                matrix[count + i * size] = weight(i);
            }
            if balance.tilt_free {
                let centre = if balance.approach_free { lever } else { 0.0 };
                matrix[i + (size - 1) * size] = (centre - x(i)) * weight(i);
                matrix[size - 1 + i * size] = (x(i) - lever) * weight(i);
            }
        }
        if balance.approach_free {
            // The spring is compressed at x = 0; the unknown is the approach at the lever.
            matrix[count + count * size] = spring;
            right[count] = -balance.load * to_mean;
            if balance.tilt_free {
                matrix[count + (count + 1) * size] = -spring * lever;
            }
        }
        if balance.tilt_free {
            right[size - 1] = -balance.moment * to_mean / self.length;
        }
        let pivoting = memory.pivoting.as_mut().expect("allocated at construction");
        let first = &[0, count - 1][..free];
        let pivots = pivoting.solve(matrix, right, first, &mut memory.set).map_err(|_| ContactError::NoEquilibrium)?;
        self.counter.pivots += pivots as u64;
        Ok(())
    }
}
