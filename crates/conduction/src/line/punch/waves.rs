//! Transverse modes with their integrals over the cells, computed once for all sums over them.
//!
//! Theory: docs/theory.md, section 4.6.

use super::across::{Across, Wave};
use elasticity::Cells;
use nalgebra::DMatrix;
use std::ops::Range;

/// Transverse modes with their cell integrals.
pub(super) struct Waves {
    waves: Vec<Wave>,
    /// Integrals over the cells, m^(1/2): N x modes.
    integrals: DMatrix<f64>,
}

impl Waves {
    /// The first `count` modes.
    pub(crate) fn new(across: &Across, cells: &Cells, count: usize) -> Waves {
        Waves::integrated((0..count).map(|m| across.wave(m)).collect(), cells)
    }

    /// The first `count` of these modes over other cells.
    pub(crate) fn over(&self, cells: &Cells, count: usize) -> Waves {
        Waves::integrated(self.waves[..count].to_vec(), cells)
    }

    fn integrated(waves: Vec<Wave>, cells: &Cells) -> Waves {
        let count = waves.len();
        let mut integrals = DMatrix::zeros(cells.count(), count);
        for (wave, column) in waves.iter().zip(integrals.as_mut_slice().chunks_exact_mut(cells.count())) {
            wave.integrate(cells, column);
        }
        Waves { waves, integrals }
    }

    /// Number of modes.
    pub(crate) fn count(&self) -> usize {
        self.waves.len()
    }

    /// Mode number m.
    pub(crate) fn wave(&self, m: usize) -> &Wave {
        &self.waves[m]
    }

    /// Integral of mode number m over every cell, m^(1/2).
    pub(crate) fn integrals(&self, m: usize) -> &[f64] {
        let cells = self.integrals.nrows();
        &self.integrals.as_slice()[m * cells..(m + 1) * cells]
    }

    /// Sum over some modes of a weight times the product of their integrals over two cells, N x N.
    pub(crate) fn sum(&self, modes: Range<usize>, weight: impl Fn(usize, &Wave) -> f64) -> DMatrix<f64> {
        let all = 0..self.integrals.nrows();
        self.sum_between(self, [all.clone(), all], modes, weight)
    }

    /// [`Self::sum`] over some of the cells in the rows, and some of other cells in the columns.
    pub(crate) fn sum_between(
        &self,
        other: &Waves,
        [rows, columns]: [Range<usize>; 2],
        modes: Range<usize>,
        weight: impl Fn(usize, &Wave) -> f64,
    ) -> DMatrix<f64> {
        let integrals = other.integrals.columns_range(modes.clone());
        let mut weighted = self.integrals.columns_range(modes.clone()).rows_range(rows).into_owned();
        for (m, mut column) in modes.zip(weighted.column_iter_mut()) {
            column *= weight(m, &self.waves[m]);
        }
        weighted * integrals.rows_range(columns).transpose()
    }
}
