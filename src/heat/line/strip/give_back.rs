//! Heat transfer of the top given back to the contact zone.
//!
//! The waves are cooled on the whole surface. Under the contact there is no air: fluxes `H0 (T - T_ambient)` into the
//! cells undo it there, with T the temperature of the waves that are cooled. They are taken in the space of polynomials
//! over the contact, which holds the smooth temperatures of a wide zone as well as the heat itself, so that a stage's
//! equation for them is as small as that space:
//!
//! ```text
//! y = H0 V'W (T - T_ambient),   T = B + G (q + V y)   =>   (1 - H0 V'W G V) y = H0 V'W (B + G q - T_ambient)
//! ```

use super::operators::Operators;
use crate::elastic::{Cells, MAXIMUM_CELLS};
use nalgebra::DMatrix;

/// Largest dimension of the space.
pub const RANK: usize = 8;

/// Polynomials orthonormal on the cells, and what the waves give for them.
#[derive(Clone, PartialEq, Debug)]
pub struct GiveBack {
    transfer: f64,
    rank: usize,
    /// V, one row of N values per polynomial; even and odd by turns.
    polynomials: Vec<Vec<f64>>,
    /// V'W of a uniform temperature.
    pub unit: [f64; RANK],
    widths: Vec<f64>,
    /// V'W of every wave's shape.
    waves: Vec<[f64; RANK]>,
}

/// A stage's solution for the fluxes given back.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Closure {
    /// `(1 - H0 V'W G V)^-1 H0`.
    solution: [[f64; RANK]; RANK],
    /// V'W G, one row of N per polynomial.
    response: Vec<Vec<f64>>,
}

impl GiveBack {
    /// The space on `cells` for the heat transfer coefficient `transfer`.
    pub fn new(cells: &Cells, transfer: f64, operators: &Operators) -> GiveBack {
        let (count, widths) = (cells.count(), cells.widths().to_vec());
        let rank = RANK.min(count);
        let mut polynomials: Vec<Vec<f64>> = Vec::new();
        for degree in 0..rank {
            // x times the last one, orthogonalised twice.
            let mut next: Vec<f64> = match polynomials.last() {
                None => vec![1.0; count],
                Some(last) => cells.centres().iter().zip(last).map(|(x, p)| x / cells.half_width() * p).collect(),
            };
            for _ in 0..2 {
                for known in polynomials.iter().skip(degree % 2).step_by(2) {
                    let part: f64 = (0..count).map(|i| widths[i] * known[i] * next[i]).sum();
                    next.iter_mut().zip(known).for_each(|(value, other)| *value -= part * other);
                }
            }
            let norm = (0..count).map(|i| widths[i] * next[i] * next[i]).sum::<f64>().sqrt();
            next.iter_mut().for_each(|value| *value /= norm);
            polynomials.push(next);
        }
        let waves = (0..operators.waves.len())
            .map(|wave| {
                let mut row = [0.0; RANK];
                for (degree, polynomial) in polynomials.iter().enumerate() {
                    let (even, odd) = operators.over_cells(wave, |i| polynomial[i]);
                    row[degree] = operators.weight[wave] * if degree % 2 == 0 { even } else { -odd };
                }
                row
            })
            .collect();
        let mut unit = [0.0; RANK];
        unit[0] = (0..count).map(|i| widths[i] * polynomials[0][i]).sum();
        GiveBack { transfer, rank, polynomials, unit, widths, waves }
    }

    /// V'W of the temperature that waves of these amplitudes give.
    pub fn project(&self, operators: &Operators, amplitude: &[[f64; 2]]) -> [f64; RANK] {
        debug_assert_eq!(amplitude.len(), operators.waves.len());
        let mut level = [0.0; RANK];
        for (row, value) in self.waves.iter().zip(amplitude) {
            for (degree, entry) in row.iter().enumerate() {
                level[degree] += entry * value[degree % 2];
            }
        }
        level
    }

    /// Adds the fluxes given back to `flux`, where the waves have the projected temperature `level` without `flux`.
    pub fn add(&self, closure: &Closure, level: &[f64; RANK], ambient: f64, flux: &mut [f64]) {
        let mut driving = [0.0; RANK];
        for degree in 0..self.rank {
            let response = &closure.response[degree];
            let answer: f64 = response.iter().zip(flux.iter()).map(|(entry, q)| entry * q).sum();
            driving[degree] = level[degree] - self.unit[degree] * ambient + answer;
        }
        for degree in 0..self.rank {
            let amount: f64 = (0..self.rank).map(|other| closure.solution[degree][other] * driving[other]).sum();
            let polynomial = &self.polynomials[degree];
            flux.iter_mut().zip(polynomial).for_each(|(value, shape)| *value += amount * shape);
        }
    }

    /// An empty closure with its space.
    pub fn closure(&self) -> Closure {
        Closure { solution: [[0.0; RANK]; RANK], response: vec![vec![0.0; self.widths.len()]; self.rank] }
    }

    /// Solves a stage whose waves answer fluxes by `slow` (N x N).
    pub fn close(&self, slow: &DMatrix<f64>, closure: &mut Closure) {
        let count = self.widths.len();
        for degree in 0..self.rank {
            let polynomial = &self.polynomials[degree];
            for j in 0..count {
                closure.response[degree][j] = (0..count).map(|i| self.widths[i] * polynomial[i] * slow[(i, j)]).sum();
            }
        }
        let mut matrix = [[0.0; RANK]; RANK];
        for a in 0..self.rank {
            for b in 0..self.rank {
                let answer: f64 = closure.response[a].iter().zip(&self.polynomials[b]).map(|(g, v)| g * v).sum();
                matrix[a][b] = f64::from(u8::from(a == b)) - self.transfer * answer;
            }
        }
        closure.solution = inverse(matrix, self.rank);
        closure.solution.iter_mut().flatten().for_each(|value| *value *= self.transfer);
    }

    /// Adds to `gains` (N x N) the response by way of the fluxes given back, `response V solution V'W G`.
    pub fn add_gains(&self, closure: &Closure, response: &DMatrix<f64>, gains: &mut DMatrix<f64>) {
        let count = self.widths.len();
        // Column by column, as the matrices lie in memory.
        let mut lifted = [[0.0; RANK]; MAXIMUM_CELLS];
        let lifted = &mut lifted[..count];
        for j in 0..count {
            let shape: [f64; RANK] = std::array::from_fn(|a| self.polynomials.get(a).map_or(0.0, |row| row[j]));
            for (row, entry) in lifted.iter_mut().zip(response.column(j).iter()) {
                row.iter_mut().zip(&shape).for_each(|(value, v)| *value += entry * v);
            }
        }
        for j in 0..count {
            let answer: [f64; RANK] = std::array::from_fn(|b| closure.response.get(b).map_or(0.0, |row| row[j]));
            let returned: [f64; RANK] =
                std::array::from_fn(|a| (0..RANK).map(|b| closure.solution[a][b] * answer[b]).sum());
            for (gain, row) in gains.column_mut(j).iter_mut().zip(lifted.iter()) {
                *gain += row.iter().zip(&returned).map(|(l, r)| l * r).sum::<f64>();
            }
        }
    }
}

/// Inverse of the leading block, by elimination with pivots.
fn inverse(mut matrix: [[f64; RANK]; RANK], rank: usize) -> [[f64; RANK]; RANK] {
    let mut result = [[0.0; RANK]; RANK];
    for (i, row) in result.iter_mut().enumerate().take(rank) {
        row[i] = 1.0;
    }
    for column in 0..rank {
        let pivot = (column..rank)
            .max_by(|&i, &j| matrix[i][column].abs().total_cmp(&matrix[j][column].abs()))
            .unwrap_or(column);
        matrix.swap(column, pivot);
        result.swap(column, pivot);
        let scale = 1.0 / matrix[column][column];
        for k in 0..rank {
            matrix[column][k] *= scale;
            result[column][k] *= scale;
        }
        for row in 0..rank {
            if row != column {
                let factor = matrix[row][column];
                for k in 0..rank {
                    matrix[row][k] -= factor * matrix[column][k];
                    result[row][k] -= factor * result[column][k];
                }
            }
        }
    }
    result
}
