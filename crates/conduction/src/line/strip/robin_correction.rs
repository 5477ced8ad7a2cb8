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
use elasticity::Cells;
use numerics::dense;

/// Polynomials orthonormal on the cells, and the projections of the modes on them.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct RobinCorrection {
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
    pub(crate) fn new(
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
    pub(crate) fn project(&self, amplitude: &[Vec<f64>; 2]) -> [f64; RANK] {
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
    pub(crate) fn amounts(
        &self,
        response: &StageResponse,
        level: &[f64; RANK],
        ambient: f64,
        flux: &[f64],
    ) -> [f64; RANK] {
        let mut driving = *level;
        driving.iter_mut().zip(&self.unit).for_each(|(driving, unit)| *driving -= unit * ambient);
        dense::multiply_add(response.response(), flux, &mut driving);
        let mut amounts = [0.0; RANK];
        dense::multiply_add(response.solution(), &driving, &mut amounts);
        amounts
    }

    /// Coefficient of the constant polynomial under a unit flux into cell `cell`.
    pub(crate) fn constant_by_cell(&self, response: &StageResponse, cell: usize) -> f64 {
        let driving = &response.response()[cell * RANK..(cell + 1) * RANK];
        response.solution().chunks_exact(RANK).zip(driving).map(|(column, driving)| column[0] * driving).sum()
    }

    /// Adds the fluxes of the Robin correction to `flux` and returns their coefficients; see
    /// [`RobinCorrection::amounts`].
    pub(crate) fn add(
        &self,
        response: &StageResponse,
        level: &[f64; RANK],
        ambient: f64,
        flux: &mut [f64],
    ) -> [f64; RANK] {
        let amounts = self.amounts(response, level, ambient, flux);
        self.lift(&amounts, flux);
        amounts
    }

    /// Adds the polynomials with the coefficients `amounts` to `flux` (W/m2).
    pub(crate) fn lift(&self, amounts: &[f64; RANK], flux: &mut [f64]) {
        dense::multiply_add(&self.polynomials, &amounts[..self.rank], flux);
    }

    /// Computes the operators of the Robin correction for a stage whose modes have the influence matrices `slow` (N x N:
    /// temperature, distortion; the latter may be empty), and adds the response by way of the correction to `influence`.
    /// `returned` is workspace of [`RANK`] N numbers.
    ///
    /// The strip is homogeneous along the path and the cells are symmetric about x = 0: G_jl/w_l is the same for a pair of
    /// cells and its mirror image, so V'W G follows from G V.
    pub(crate) fn close(&self, slow: [&[f64]; 2], influence: [&mut [f64]; 2], parts: Parts<'_>, returned: &mut [f64]) {
        let count = self.widths.len();
        let Parts { response, mut lifted, solution, .. } = parts;
        for (slow, lifted) in slow.iter().zip(&mut lifted) {
            lifted.fill(0.0);
            if !slow.is_empty() {
                dense::multiply_add_columns(slow, &self.polynomials, &mut lifted[..self.polynomials.len()], count);
            }
        }
        let (columns, _) = response.as_chunks_mut::<RANK>();
        for ((l, column), width) in columns.iter_mut().enumerate().zip(&self.widths) {
            let mirrored = |a: usize| lifted[0][a * count + count - 1 - l];
            *column = std::array::from_fn(|a| if a % 2 == 0 { width * mirrored(a) } else { -width * mirrored(a) });
        }
        let mut projected = [0.0; RANK * RANK];
        let polynomials = &self.polynomials[..];
        dense::multiply_add_columns(response, polynomials, &mut projected[..RANK * self.rank], RANK);
        // Without a polynomial of a degree its row and column are those of the unit matrix.
        let mut matrix = IDENTITY;
        for (b, column) in projected.chunks_exact(RANK).enumerate() {
            for a in 0..RANK {
                matrix[a][b] -= self.transfer * column[a];
            }
        }
        let inverse = inverse(matrix);
        for (b, column) in solution.chunks_exact_mut(RANK).enumerate() {
            column.iter_mut().zip(&inverse).for_each(|(target, row)| *target = self.transfer * row[b]);
        }
        returned.fill(0.0);
        dense::multiply_add_columns(solution, response, returned, RANK);
        for (influence, lifted) in influence.into_iter().zip(&lifted).filter(|(influence, _)| !influence.is_empty()) {
            dense::multiply_add_columns(lifted, returned, influence, count);
        }
    }
}

const IDENTITY: [[f64; RANK]; RANK] = {
    let mut matrix = [[0.0; RANK]; RANK];
    let mut i = 0;
    while i < RANK {
        matrix[i][i] = 1.0;
        i += 1;
    }
    matrix
};

/// Inverse by Gauss-Jordan elimination with partial pivoting.
fn inverse(mut matrix: [[f64; RANK]; RANK]) -> [[f64; RANK]; RANK] {
    let mut result = IDENTITY;
    for column in 0..RANK {
        let mut pivot = column;
        for row in column + 1..RANK {
            if matrix[row][column].abs() > matrix[pivot][column].abs() {
                pivot = row;
            }
        }
        matrix.swap(column, pivot);
        result.swap(column, pivot);
        let scale = 1.0 / matrix[column][column];
        let (eliminated, inverted) =
            (matrix[column].map(|value| scale * value), result[column].map(|value| scale * value));
        for row in 0..RANK {
            let factor = matrix[row][column];
            for k in 0..RANK {
                matrix[row][k] -= factor * eliminated[k];
                result[row][k] -= factor * inverted[k];
            }
        }
        (matrix[column], result[column]) = (eliminated, inverted);
    }
    result
}

#[cfg(test)]
mod tests {
    use super::super::stage_response::Layout;
    use super::*;
    use nalgebra::{DMatrix, DVector};

    /// With the polynomials V and the widths W, the influence with the correction is `G + G V (1 - H0 V'W G V)^-1 H0 V'W G`.
    #[test]
    fn the_closed_influence_is_that_of_the_definition() {
        for count in [1, 2, 7, 8, 17, 30] {
            let cells = Cells::graded(0.02, count).unwrap();
            let transfer = 40.0;
            let robin = RobinCorrection::new(&cells, transfer, &[], |_, _| (0.0, 0.0));
            let (x, widths) = (cells.centres(), cells.widths());
            let influence = |scale: f64| {
                // Warmer behind the source than ahead of it.
                let kernel = |r: f64| scale * (-40.0 * r.abs() - 30.0 * r).exp();
                DMatrix::from_fn(count, count, |j, l| widths[l] * kernel(x[j] - x[l]))
            };
            let slow = [influence(0.5), influence(-1e-7)];
            let rank = robin.rank;
            let v = DMatrix::from_column_slice(count, rank, &robin.polynomials);
            let projection = v.transpose() * DMatrix::from_diagonal(&DVector::from_column_slice(widths));
            let identity = DMatrix::identity(rank, rank);
            let closed = (identity - transfer * &projection * &slow[0] * &v).try_inverse().unwrap();
            let returned = transfer * &v * &closed * &projection * &slow[0];
            let expected = slow.each_ref().map(|slow| slow + slow * &returned);
            let mut response = StageResponse::new(Layout { count, states: 0, waves: 0, rank: RANK });
            let mut found = slow.clone();
            let [temperature, distortion] = &mut found;
            robin.close(
                slow.each_ref().map(|slow| slow.as_slice()),
                [temperature.as_mut_slice(), distortion.as_mut_slice()],
                response.parts(),
                &mut vec![0.0; RANK * count],
            );
            for (found, expected) in found.iter().zip(&expected) {
                assert!((found - expected).amax() < 1e-12 * expected.amax(), "{count}");
            }
        }
    }
}
