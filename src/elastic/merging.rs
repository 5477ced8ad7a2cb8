//! Cells merged to larger ones: what a coarser contact line is made of without building its bodies anew.

use super::Cells;
use nalgebra::DMatrix;
use std::ops::Range;

/// Groups of neighbouring cells, from the -x to the +x edge, with the widths of the cells as weights.
#[derive(Clone, PartialEq, Debug)]
pub struct Merging {
    groups: Vec<Range<usize>>,
    /// Part of its group's width that a cell has.
    share: Vec<f64>,
}

impl Merging {
    /// Pairs from both edges inwards: about half as many cells, symmetric as before. A cell that is left over stands alone.
    pub fn pairs(cells: &Cells) -> Merging {
        let count = cells.count();
        let half = count / 2;
        let left: Vec<Range<usize>> = (0..half).step_by(2).map(|first| first..(first + 2).min(half)).collect();
        let right = left.iter().rev().map(|group| count - group.end..count - group.start);
        let middle = (count % 2 == 1).then_some(half..half + 1);
        let groups: Vec<Range<usize>> = left.iter().cloned().chain(middle).chain(right).collect();
        let mut share = vec![0.0; count];
        for group in &groups {
            let width: f64 = cells.widths()[group.clone()].iter().sum();
            group.clone().for_each(|cell| share[cell] = cells.widths()[cell] / width);
        }
        Merging { groups, share }
    }

    /// Number of groups.
    pub fn count(&self) -> usize {
        self.groups.len()
    }

    /// The groups as cells.
    pub fn cells(&self, cells: &Cells) -> Cells {
        let edges = cells.edges();
        let first = self.groups.iter().map(|group| edges[group.start]);
        Cells::from_edges(first.chain([edges[cells.count()]]).collect())
    }

    /// Means over the groups of values on the cells.
    pub fn means_into(&self, values: &[f64], means: &mut [f64]) {
        for (mean, group) in means.iter_mut().zip(&self.groups) {
            *mean = group.clone().map(|cell| self.share[cell] * values[cell]).sum();
        }
    }

    /// Means over the groups of values on the cells.
    pub fn means(&self, values: &[f64]) -> Vec<f64> {
        let mut means = vec![0.0; self.count()];
        self.means_into(values, &mut means);
        means
    }

    /// Sums over the groups of values on the cells.
    pub fn sums(&self, values: &[f64]) -> Vec<f64> {
        self.groups.iter().map(|group| values[group.clone()].iter().sum()).collect()
    }

    /// The value of its group for every cell.
    pub fn spread(&self, means: &[f64], values: &mut [f64]) {
        for (mean, group) in means.iter().zip(&self.groups) {
            values[group.clone()].fill(*mean);
        }
    }

    /// Mean answer of the groups (rows) to one unit on all cells of a group (columns), from that of the cells.
    pub fn matrix_into(&self, matrix: &DMatrix<f64>, merged: &mut DMatrix<f64>) {
        for (j, loaded) in self.groups.iter().enumerate() {
            for (i, group) in self.groups.iter().enumerate() {
                let answer = |cell: usize| loaded.clone().map(|from| matrix[(cell, from)]).sum::<f64>();
                merged[(i, j)] = group.clone().map(|cell| self.share[cell] * answer(cell)).sum();
            }
        }
    }

    /// See [`Merging::matrix_into`].
    pub fn matrix(&self, matrix: &DMatrix<f64>) -> DMatrix<f64> {
        let mut merged = DMatrix::zeros(self.count(), self.count());
        self.matrix_into(matrix, &mut merged);
        merged
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::elastic::{ElasticBody, HalfPlane, Material};

    #[test]
    fn merged_cells_answer_like_cells_of_their_size() {
        let material = Material::new(2e11, 0.3).unwrap();
        for (count, groups) in [(9, 5), (17, 9), (16, 8), (7, 5), (6, 4), (2, 2), (1, 1)] {
            let cells = Cells::graded(0.03, count).unwrap();
            let merging = Merging::pairs(&cells);
            assert_eq!(merging.count(), groups, "{count}");
            let merged = merging.cells(&cells);
            assert!((merged.widths().iter().sum::<f64>() - 0.06).abs() < 1e-15);
            assert!((0..groups).all(|i| (merged.centres()[i] + merged.centres()[groups - 1 - i]).abs() < 1e-15));
            let body = HalfPlane { material };
            let (fine, coarse) = (body.compliance(&cells).normal, body.compliance(&merged).normal);
            let scale = coarse.amax();
            assert!((merging.matrix(&fine) - coarse).amax() < 1e-12 * scale, "{count}");
            let values: Vec<f64> = cells.centres().iter().map(|x| 1.0 + 20.0 * x * x).collect();
            let means = merging.means(&values);
            assert!((cells.integral(&values) - merged.integral(&means)).abs() < 1e-15);
            let loads: Vec<f64> = values.iter().zip(cells.widths()).map(|(value, width)| value * width).collect();
            for ((sum, mean), width) in merging.sums(&loads).iter().zip(&means).zip(merged.widths()) {
                assert!((sum - mean * width).abs() < 1e-15, "{count}");
            }
            let mut spread = vec![0.0; count];
            merging.spread(&means, &mut spread);
            assert!((cells.integral(&spread) - cells.integral(&values)).abs() < 1e-15);
        }
    }
}
