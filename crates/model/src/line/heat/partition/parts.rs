//! Heat partition with cells partly in contact, from that of whole cells by a low-rank update.
//!
//! Heat that enters the punch through a part of cell k alone changes column and row k of its temperature matrix and column k of its distortion
//! matrix, and the resistance of the cell. With the m cells partly in contact, columns c_k and rows r_k (without the entries that the columns
//! have),
//!
//! ```text
//! M' = M + sum c_k e_k' + sum e_k r_k' = M + U V',    P' = P - W S^-1 V' P,    W = P U,  S = I + V' W
//! Y' = P'(B + sum b_k e_k e_k') = Y - W S^-1 V' Y + sum b_k P' e_k e_k',    B = G_2 + I/(2 h_c)
//! E' = E + (D_1 - D_2)(Y' - Y) + sum d_k e_k' Y'
//! ```
//!
//! (Sherman-Morrison-Woodbury) with the inverse P of M, the partition matrix Y and the distortion E of
//! [`HeatPartition`], changes b_k of half the resistance and d_k of the distortion columns. It starts from whole cells every time, so the
//! result is a function of step, velocity and parts alone. Both bodies conduct, and exchange heat.
//!
//! Theory: docs/theory.md, section 6.5.

use super::{HeatPartition, Operators, PartitionKey};
use conduction::line::SurfaceInfluence;
use conduction::line::contact_parts::ContactParts;
use contact::largest_update_rank;
use numerics::dense;

/// Change of column `k` of a matrix.
fn column_change([original, changed]: [&[f64]; 2], k: usize, target: &mut [f64]) {
    let count = target.len();
    let columns = [original, changed].map(|matrix| &matrix[k * count..][..count]);
    for ((target, original), changed) in target.iter_mut().zip(columns[0]).zip(columns[1]) {
        *target = changed - original;
    }
}

/// Change of row `k` of a matrix.
fn row_change([original, changed]: [&[f64]; 2], k: usize, target: &mut [f64]) {
    let count = target.len();
    for (j, target) in target.iter_mut().enumerate() {
        *target = changed[j * count + k] - original[j * count + k];
    }
}

impl HeatPartition {
    /// The same with memory for cells partly in contact.
    pub(crate) fn with_parts(mut self) -> HeatPartition {
        let count = self.closed.len();
        self.of_whole = Some(Operators::new(count));
        self.in_part = Vec::with_capacity(count);
        self.rows = vec![0.0; count * largest_update_rank(count) / 2];
        self
    }

    /// Builds the operators of whole cells, as [`HeatPartition::build`], and keeps them for [`HeatPartition::set_parts`].
    pub(crate) fn build_whole(&mut self, key: PartitionKey, influence: [Option<&SurfaceInfluence>; 2]) {
        self.contact_parts.make_whole();
        self.assemble(key, influence);
        if let Some(of_whole) = &mut self.of_whole {
            of_whole.copy_from(&self.operators);
        }
    }

    /// Whether an update for these parts costs less than operators built anew.
    pub(crate) fn updates_for(&self, contact_parts: &ContactParts) -> bool {
        let count = self.closed.len();
        let in_part = (0..count).filter(|&cell| contact_parts.is_partial(cell)).count();
        self.of_whole.is_some() && 2 * in_part <= largest_update_rank(count)
    }

    /// Updates the operators of whole cells to these parts in contact. `punch`: its influence matrices through whole cells, and through the
    /// parts.
    pub(crate) fn set_parts(&mut self, contact_parts: &ContactParts, punch: [&SurfaceInfluence; 2]) {
        let (Some(of_whole), Some(resistance)) = (&self.of_whole, self.resistance) else { return };
        let count = self.closed.len();
        self.contact_parts.copy_from(contact_parts);
        self.known = false;
        self.per_pressure = f64::NAN;
        self.operators.copy_from(of_whole);
        self.in_part.clear();
        self.in_part.extend((0..count).filter(|&cell| contact_parts.is_partial(cell)));
        let m = self.in_part.len();
        if m == 0 {
            return;
        }
        let temperature = punch.map(|influence| influence.temperature.as_slice());
        let distorted = punch.map(|influence| influence.distortion.as_slice());
        let Operators { inverse, shares, relative_distortion, distortion } = &mut self.operators;
        let HeatPartition { in_part, rows, column, factors, exchanged, left, right, removed, .. } = self;
        let extra = |cell: usize| resistance / contact_parts.fraction(cell) - resistance;
        let rank = 2 * m;
        // W, and (D_1 - D_2) W.
        let (w, moved) = (&mut left[..rank * count], &mut removed[..rank * count]);
        w.fill(0.0);
        moved.fill(0.0);
        let (of_columns, of_rows) = w.split_at_mut(m * count);
        for ((of_column, of_row), &k) in
            of_columns.chunks_exact_mut(count).zip(of_rows.chunks_exact_mut(count)).zip(&*in_part)
        {
            column_change(temperature, k, column);
            column[k] += extra(k);
            dense::multiply_add(inverse, column, of_column);
            of_row.copy_from_slice(&inverse[k * count..][..count]);
        }
        dense::multiply_add_columns(relative_distortion, w, moved, count);
        for (row, &k) in rows.chunks_exact_mut(count).zip(&*in_part) {
            row_change(temperature, k, row);
            in_part.iter().for_each(|&other| row[other] = 0.0);
        }
        // `target = V' matrix`, by columns.
        let project = |matrix: &[f64], target: &mut [f64]| {
            for (target, column) in target.chunks_exact_mut(rank).zip(matrix.chunks_exact(count)) {
                for ((a, &k), row) in in_part.iter().enumerate().zip(rows.chunks_exact(count)) {
                    (target[a], target[m + a]) = (column[k], dense::dot(row, column));
                }
            }
        };
        let (s, solution) = factors[..2 * rank * rank].split_at_mut(rank * rank);
        project(w, s);
        (0..rank).for_each(|i| s[i * rank + i] += 1.0);
        dense::factorise(s, rank, &mut exchanged[..rank]);
        // -S^-1.
        for (k, column) in solution.chunks_exact_mut(rank).enumerate() {
            column.fill(0.0);
            column[k] = -1.0;
            dense::substitute(s, rank, &exchanged[..rank], column);
        }
        let (x, projected) = (&mut right[..rank * count], &mut column[..rank]);
        for (of_distortion, matrix) in [(false, &mut *inverse), (true, &mut *shares)] {
            project(matrix, x);
            for x in x.chunks_exact_mut(rank) {
                projected.copy_from_slice(x);
                x.fill(0.0);
                for (column, part) in solution.chunks_exact(rank).zip(&*projected) {
                    x.iter_mut().zip(column).for_each(|(x, entry)| *x += part * entry);
                }
            }
            dense::multiply_add_columns(w, x, matrix, count);
            if of_distortion {
                dense::multiply_add_columns(moved, x, distortion, count);
            }
        }
        for &k in &*in_part {
            let at = k * count..(k + 1) * count;
            column.fill(0.0);
            dense::multiply_add(&inverse[at.clone()], &[0.5 * extra(k)], column);
            dense::multiply_add(relative_distortion, column, &mut distortion[at.clone()]);
            shares[at].iter_mut().zip(&*column).for_each(|(share, more)| *share += more);
        }
        for &k in &*in_part {
            column_change(distorted, k, column);
            for (distortion, share) in distortion.chunks_exact_mut(count).zip(shares.chunks_exact(count)) {
                dense::multiply_add(column, &[share[k]], distortion);
            }
            let relative = &mut relative_distortion[k * count..(k + 1) * count];
            relative.iter_mut().zip(&*column).for_each(|(relative, more)| *relative += more);
        }
    }
}
