//! Heat partition with cells partly in contact, from that of whole cells by a low-rank update.
//!
//! Heat that enters the punch through a part of cell k heats that part more: the diagonal entry of its temperature matrix grows, and the
//! resistance of the cell. With the sum d_k of both, and half the change of the resistance b_k, on the set K of these cells
//!
//! ```text
//! M' = M + sum d_k e_k e_k',    P' = P - P_:K S^-1 P_K:,    S = D^-1 + P_KK
//! Y' = Y - P_:K S^-1 Y_K: + sum b_k P' e_k e_k',    E' = E + (D_1 - D_2)(Y' - Y)
//! ```
//!
//! (Sherman-Morrison-Woodbury) with the inverse P of M, the partition matrix Y and the distortion E of [`HeatPartition`]. What cell k does
//! to others is left to the iteration of the stage. It starts from whole cells every time, so the result is a function of step, velocity
//! and parts alone. Both bodies conduct, and exchange heat.
//!
//! Theory: docs/theory.md, section 6.5.

use super::{HeatPartition, Operators, PartitionKey, WholeCells};
use conduction::line::SurfaceInfluence;
use conduction::line::contact_parts::ContactParts;
use contact::largest_update_rank;
use numerics::dense;
use numerics::maximum::maximum;

impl HeatPartition {
    /// The same with memory for cells partly in contact.
    pub(crate) fn with_parts(mut self) -> HeatPartition {
        let count = self.closed.len();
        let self_influence = vec![0.0; count];
        self.of_whole = Some(WholeCells { operators: Operators::new(count), self_influence });
        self
    }

    /// Builds the operators of whole cells and keeps them for [`HeatPartition::set_parts`].
    pub(crate) fn build_whole(&mut self, key: PartitionKey, influence: [Option<&SurfaceInfluence>; 2]) {
        self.contact_parts.make_whole();
        self.assemble(key, influence);
        if let (Some(of_whole), Some(punch)) = (&mut self.of_whole, influence[0]) {
            of_whole.operators.copy_from(&self.operators);
            (of_whole.self_influence.iter_mut().enumerate()).for_each(|(k, own)| *own = punch.temperature[(k, k)]);
        }
    }

    /// Updates the operators of whole cells to these parts in contact. `punch`: its influence matrices through them. False where that
    /// would cost as much as operators built anew.
    pub(crate) fn set_parts(&mut self, contact_parts: &ContactParts, punch: &SurfaceInfluence) -> bool {
        let (Some(of_whole), Some(resistance)) = (&self.of_whole, self.resistance) else { return false };
        let count = self.closed.len();
        let cells = || (0..count).filter(|&cell| contact_parts.is_partial(cell));
        let m = cells().count();
        if m > largest_update_rank(count) {
            return false;
        }
        self.contact_parts.copy_from(contact_parts);
        self.known = false;
        self.per_pressure = f64::NAN;
        self.operators.copy_from(&of_whole.operators);
        if m == 0 {
            return true;
        }
        let Operators { inverse, shares, relative_distortion, distortion } = &mut self.operators;
        let (less, moved) = (&mut self.left[..m * count], &mut self.removed[..m * count]);
        let (s, exchanged, rows) = (&mut self.factors[..m * m], &mut self.exchanged[..m], &mut self.right[..m * count]);
        let extra = |cell: usize| resistance / contact_parts.fraction(cell) - resistance;
        for (a, k) in cells().enumerate() {
            let column = &inverse[k * count..][..count];
            less[a * count..][..count].iter_mut().zip(column).for_each(|(less, entry)| *less = -entry);
            s[a * m..][..m].iter_mut().zip(cells()).for_each(|(entry, i)| *entry = column[i]);
            let heated = punch.temperature[(k, k)] - of_whole.self_influence[k];
            s[a * m + a] += 1.0 / (maximum(heated, 0.0) + extra(k));
        }
        moved.fill(0.0);
        dense::multiply_add_columns(relative_distortion, less, moved, count);
        dense::factorise(s, m, exchanged);
        for (matrix, distorts) in [(&mut *inverse, false), (&mut *shares, true)] {
            for (row, column) in rows.chunks_exact_mut(m).zip(matrix.chunks_exact(count)) {
                row.iter_mut().zip(cells()).for_each(|(entry, k)| *entry = column[k]);
                dense::substitute(s, m, exchanged, row);
            }
            dense::multiply_add_columns(less, rows, matrix, count);
            if distorts {
                dense::multiply_add_columns(moved, rows, distortion, count);
            }
        }
        let column = &mut self.column;
        for k in cells() {
            let of_cell = k * count..(k + 1) * count;
            column.fill(0.0);
            dense::multiply_add(&inverse[of_cell.clone()], &[0.5 * extra(k)], column);
            dense::multiply_add(relative_distortion, column, &mut distortion[of_cell.clone()]);
            shares[of_cell].iter_mut().zip(&*column).for_each(|(share, more)| *share += more);
        }
        true
    }
}
