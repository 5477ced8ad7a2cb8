//! Robin correction of the strip under the contact.
//!
//! The modes have the convection of the free surface on the whole top. Under the contact there is none: fluxes
//! `H0 (T - T_ambient)` into the cells cancel it, T being the temperature of the modes. They are taken in a space of
//! polynomials over the contact, which resolves both the smooth temperatures of a wide zone and the heat itself; the
//! linear system per stage has the dimension of that space:
//!
//! ```text
//! y = H0 V'W (T - T_ambient),   T = B + G (q + V y)   =>   (1 - H0 V'W G V) y = H0 V'W (B + G q - T_ambient)
//! ```
//!
//! Theory: docs/theory.md, section 4.5.

use super::stage_response::{Parts, RANK, StageResponse};
use elasticity::{Cells, MAXIMUM_CELLS};
use nalgebra::DMatrix;
use numerics::dense;

/// Polynomials orthonormal on the cells, and the projections of the modes on them.
#[derive(Clone, PartialEq, Debug)]
pub struct RobinCorrection {
    transfer: f64,
    rank: usize,
    /// V: N x rank, by columns; even and odd degrees alternate.
    polynomials: Vec<f64>,
    /// V'W of a uniform temperature.
    pub unit: [f64; RANK],
    widths: Vec<f64>,
    /// V'W of the shape of every mode.
    waves: Vec<[f64; RANK]>,
}

impl RobinCorrection {
    /// The space on `cells` for the heat transfer coefficient `transfer`. `weight`: of every mode's amplitude in the temperature;
    /// `over_cells`: integrals over the cells of the even and odd part of a mode times the values of a polynomial.
    pub fn new(
        cells: &Cells,
        transfer: f64,
        weight: &[f64],
        over_cells: impl Fn(usize, &[f64]) -> (f64, f64),
    ) -> RobinCorrection {
        let (count, widths) = (cells.count(), cells.widths().to_vec());
        let rank = RANK.min(count);
        let mut polynomials: Vec<Vec<f64>> = Vec::new();
        for degree in 0..rank {
            // x times the polynomial before, orthogonalised twice.
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
        let waves = (0..weight.len())
            .map(|wave| {
                let mut row = [0.0; RANK];
                for (degree, polynomial) in polynomials.iter().enumerate() {
                    let (even, odd) = over_cells(wave, polynomial);
                    row[degree] = weight[wave] * if degree % 2 == 0 { even } else { -odd };
                }
                row
            })
            .collect();
        let mut unit = [0.0; RANK];
        unit[0] = (0..count).map(|i| widths[i] * polynomials[0][i]).sum();
        RobinCorrection { transfer, rank, polynomials: polynomials.concat(), unit, widths, waves }
    }

    /// V'W of the temperature given by mode amplitudes (real and imaginary parts).
    pub fn project(&self, amplitude: &[Vec<f64>; 2]) -> [f64; RANK] {
        // Two interleaved sums break the dependency chain of the additions.
        let mut partial_sums = [[0.0; RANK]; 2];
        for (wave, (row, (re, im))) in self.waves.iter().zip(amplitude[0].iter().zip(&amplitude[1])).enumerate() {
            let level = &mut partial_sums[wave % 2];
            for degree in 0..RANK / 2 {
                level[2 * degree] += row[2 * degree] * re;
                level[2 * degree + 1] += row[2 * degree + 1] * im;
            }
        }
        std::array::from_fn(|degree| partial_sums[0][degree] + partial_sums[1][degree])
    }

    /// Polynomial coefficients (W/m2) of the Robin correction under the contact flux `flux` (W/m2), `level` being the
    /// projected temperature of the free response.
    pub fn amounts(&self, response: &StageResponse, level: &[f64; RANK], ambient: f64, flux: &[f64]) -> [f64; RANK] {
        let mut driving = *level;
        driving.iter_mut().zip(&self.unit).for_each(|(driving, unit)| *driving -= unit * ambient);
        dense::multiply_add(response.response(), flux, &mut driving);
        let mut amounts = [0.0; RANK];
        dense::multiply_add(response.solution(), &driving, &mut amounts);
        amounts
    }

    /// Coefficient of the constant polynomial under a unit flux into cell `cell`.
    pub fn constant_by_cell(&self, response: &StageResponse, cell: usize) -> f64 {
        let driving = &response.response()[cell * RANK..(cell + 1) * RANK];
        response.solution().chunks_exact(RANK).zip(driving).map(|(column, driving)| column[0] * driving).sum()
    }

    /// Adds the fluxes of the Robin correction to `flux` and returns their coefficients; see
    /// [`RobinCorrection::amounts`].
    pub fn add(&self, response: &StageResponse, level: &[f64; RANK], ambient: f64, flux: &mut [f64]) -> [f64; RANK] {
        let amounts = self.amounts(response, level, ambient, flux);
        self.lift(&amounts, flux);
        amounts
    }

    /// Adds the polynomials with the coefficients `amounts` to `flux` (W/m2).
    pub fn lift(&self, amounts: &[f64; RANK], flux: &mut [f64]) {
        dense::multiply_add(&self.polynomials, &amounts[..self.rank], flux);
    }

    /// Computes the operators of the Robin correction for a stage whose modes have the influence matrices `slow` (N x
    /// N: temperature, distortion).
    pub fn close(&self, slow: &[DMatrix<f64>; 2], parts: Parts<'_>) {
        let count = self.widths.len();
        let Parts { response, lifted, solution, .. } = parts;
        for (slow, lifted) in slow.iter().zip(lifted) {
            lifted.fill(0.0);
            if slow.ncols() > 0 {
                for (target, polynomial) in lifted.chunks_exact_mut(count).zip(self.polynomials.chunks_exact(count)) {
                    dense::multiply_add(slow.as_slice(), polynomial, target);
                }
            }
        }
        let mut weighted = [0.0; MAXIMUM_CELLS];
        response.fill(0.0);
        for (a, polynomial) in self.polynomials.chunks_exact(count).enumerate() {
            let weighted = &mut weighted[..count];
            for (value, (width, shape)) in weighted.iter_mut().zip(self.widths.iter().zip(polynomial)) {
                *value = width * shape;
            }
            for (target, column) in response.chunks_exact_mut(RANK).zip(slow[0].as_slice().chunks_exact(count)) {
                target[a] = dense::dot(weighted, column);
            }
        }
        let mut matrix = [[0.0; RANK]; RANK];
        for (b, polynomial) in self.polynomials.chunks_exact(count).enumerate() {
            let mut column = [0.0; RANK];
            dense::multiply_add(response, polynomial, &mut column);
            for (a, (row, value)) in matrix.iter_mut().zip(column).enumerate() {
                row[b] = f64::from(u8::from(a == b)) - self.transfer * value;
            }
        }
        let inverse = inverse(matrix, self.rank);
        for (b, column) in solution.chunks_exact_mut(RANK).enumerate() {
            column.iter_mut().zip(&inverse).for_each(|(target, row)| *target = self.transfer * row[b]);
        }
    }

    /// Adds to `influence` (N x N; temperature or distortion) the response by way of the Robin correction.
    pub fn add_influence(&self, parts: &Parts<'_>, moving: usize, influence: &mut DMatrix<f64>) {
        let count = self.widths.len();
        for (gain, response) in influence.as_mut_slice().chunks_exact_mut(count).zip(parts.response.chunks_exact(RANK))
        {
            let mut returned = [0.0; RANK];
            dense::multiply_add(parts.solution, response, &mut returned);
            dense::multiply_add(parts.lifted[moving], &returned, gain);
        }
    }
}

/// Inverse of the leading block by Gauss-Jordan elimination with partial pivoting.
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
