//! Linear equations of one active set.
//!
//! Theory: docs/theory.md, section 6.6.

use super::balance::Balance;
use super::{ContactProblem, ContactSolver, Memory};
use crate::factors::Key;

impl ContactSolver {
    /// Pressure, gap of the open cells, approach and tilt for the active set of the workspace, and the cache position of its
    /// factors; `None` where its equations have no solution.
    ///
    /// With `xi = (x - x_c)/L`, x_c the mean position of the cells in contact, their pressures are `q + y0 X0 + y1 X1`: q by
    /// the gap alone, X0 and X1 per approach and per `L theta`. The balances are two equations for y.
    pub(super) fn solve_on(
        &mut self,
        problem: &ContactProblem<'_>,
        balance: &Balance,
        memory: &mut Memory,
    ) -> Option<usize> {
        self.counter.iterations += 1;
        let shifted = balance.approach_free;
        let key =
            Key { signed_friction: problem.signed_friction, shifted, diagonal: problem.diagonal, active: &memory.set };
        let position = self.factors.find(key)?;
        let shift = if shifted { self.factors.shift() } else { 0.0 };
        let entry = self.factors.with_columns(position, [balance.count() > 0, balance.tilt_free]);
        let m = entry.index.len();
        if m < balance.count() {
            return None;
        }
        let compact = &mut memory.compact[..m];
        if m == self.positions.len() {
            compact.iter_mut().zip(&memory.gap).for_each(|(q, gap)| *q = -gap);
        } else {
            compact.iter_mut().zip(&entry.index).for_each(|(q, &i)| *q = -memory.gap[i]);
        }
        entry.substitute(compact);
        let centre = entry.centre;
        let [uniform, linear] = entry.columns.each_ref().map(|column| &column[..m]);
        // Resultants and moments about the centre of q, X0 and X1.
        let ([force, moment], [[force0, moment0], [force1, moment1]]) = (entry.resultant(compact), entry.sums);
        let relative = centre / self.length;
        let (k, c) = (balance.stiffness, 1.0 - balance.stiffness * shift);
        let arm = (centre - balance.lever) / self.length;
        let (y0, y1) = match (balance.approach_free, balance.tilt_free) {
            (false, false) => (0.0, 0.0),
            (true, false) => ((balance.load - c * force) / (c * force0 + k), 0.0),
            (false, true) => {
                // The punch rotates about x = 0, where the approach is prescribed.
                let column = moment1 + arm * force1 + relative * (moment0 + arm * force0);
                let tilt = (balance.moment / self.length - moment - arm * force) / column;
                (relative * tilt, tilt)
            }
            (true, true) => {
                let first = [c * force0 + k, c * force1 - k * relative];
                let first_right = balance.load - c * force;
                let mut second = [moment0, moment1];
                let mut second_right = balance.moment / self.length - moment;
                if c > 0.1 {
                    // Resultant from the first balance: its lever about x_c may be long against the contact.
                    second[0] -= arm * k / c;
                    second[1] += arm * k / c * relative;
                    second_right -= arm * balance.load / c;
                } else {
                    second[0] += arm * force0;
                    second[1] += arm * force1;
                    second_right -= arm * force;
                }
                solve_pair(first, second, [first_right, second_right])
            }
        };
        if y1 != 0.0 {
            for ((q, u), l) in compact.iter_mut().zip(uniform).zip(linear) {
                *q += y0 * u + y1 * l;
            }
        } else if y0 != 0.0 {
            compact.iter_mut().zip(uniform).for_each(|(q, u)| *q += y0 * u);
        }
        if compact.iter().any(|q| !q.is_finite()) || !y0.is_finite() || !y1.is_finite() {
            return None;
        }
        // The shift of the matrix contains beta P/W of the approach.
        let at_centre = y0 - shift * entry.resultant(compact)[0];
        memory.tilt = if balance.tilt_free { y1 / self.length } else { balance.tilt };
        memory.approach = if balance.approach_free { at_centre - y1 * relative } else { balance.approach };
        // In full contact every gap is zero; the product, half of the work, is skipped.
        if m == self.positions.len() {
            memory.pressure.copy_from_slice(compact);
            memory.open_gap.fill(0.0);
            return Some(position);
        }
        memory.pressure.fill(0.0);
        for (q, &i) in compact.iter().zip(&entry.index) {
            memory.pressure[i] = *q;
        }
        let approach_in_gap = if balance.approach_free { memory.approach } else { 0.0 };
        let tilt_in_gap = if balance.tilt_free { memory.tilt } else { 0.0 };
        let entry = self.factors.with_open_rows(position);
        let gaps = &mut memory.worn[..entry.open.len()];
        for (gap, &i) in gaps.iter_mut().zip(&entry.open) {
            *gap = memory.gap[i] - approach_in_gap - tilt_in_gap * self.positions[i];
        }
        entry.add_to_open(&memory.compact[..m], gaps);
        memory.open_gap.fill(0.0);
        for (gap, &i) in gaps.iter().zip(&entry.open) {
            memory.open_gap[i] = *gap;
        }
        Some(position)
    }
}

/// Solves two equations by elimination with the larger pivot.
fn solve_pair(first: [f64; 2], second: [f64; 2], right: [f64; 2]) -> (f64, f64) {
    let (a, b, r, s) = if first[0].abs() >= second[0].abs() {
        (first, second, right[0], right[1])
    } else {
        (second, first, right[1], right[0])
    };
    let factor = b[0] / a[0];
    let y1 = (s - factor * r) / (b[1] - factor * a[1]);
    ((r - a[1] * y1) / a[0], y1)
}
