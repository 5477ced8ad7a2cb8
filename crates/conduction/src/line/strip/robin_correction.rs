//! Robin correction of the strip under the contact.
//!
//! The modes have the convection of the free surface on the whole top. Under the contact there is none: fluxes
//! `H0 (T - T_ambient)` into the cells cancel it, T being the whole temperature, G the response of modes and direct feedthrough
//! together. They are taken in a space of polynomials over the contact, which resolves both the smooth temperatures of a wide
//! zone and the heat itself; the linear system per stage has the dimension of that space:
//!
//! ```text
//! y = H0 V'W (T - T_ambient),   T = B + G (q + V y)   =>   (1 - H0 V'W G V) y = H0 V'W (B + G q - T_ambient)
//! ```
//!
//! Theory: docs/theory.md, section 4.5.

use super::feedthrough::Feedthrough;
use super::mirrored::MirroredInfluence;
use super::stage_response::{RANK, StageResponse};
use crate::line::SurfaceInfluence;
use elasticity::Cells;
use numerics::dense;

/// Polynomials orthonormal on the cells, and the projections of the modes on them.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct RobinCorrection {
    transfer: f64,
    /// Number of polynomials.
    pub rank: usize,
    /// V: N x rank, by columns; even and odd degrees alternate.
    polynomials: Vec<f64>,
    /// WV, by columns.
    weighted: Vec<f64>,
    /// V'W of a uniform temperature.
    pub unit: [f64; RANK],
    widths: Vec<f64>,
    /// V'W of the shape of every mode with the weight of its amplitude; even degrees have real parts alone, odd ones imaginary parts.
    waves: Vec<[f64; RANK]>,
}

impl RobinCorrection {
    /// Number of polynomials for a contact of this Biot number H w/k, w its width, and a relative error of the temperature. Half of them
    /// leave up to 1.8e-3 of it per Biot number, in the steady state at rest; all of them 1e-4.
    pub(crate) fn rank(biot: f64, tolerance: f64) -> usize {
        if 2e-3 * biot < tolerance { RANK / 2 } else { RANK }
    }

    /// The space of up to `rank` polynomials on `cells` for the heat transfer coefficient `transfer`. `weight`: of every mode's amplitude in the temperature;
    /// `over_cells`: integrals over the cells of the even and odd part of a mode times the values of a polynomial.
    pub(crate) fn new(
        cells: &Cells,
        transfer: f64,
        rank: usize,
        weight: &[f64],
        over_cells: impl Fn(usize, &[f64]) -> (f64, f64),
    ) -> RobinCorrection {
        let (count, widths) = (cells.count(), cells.widths().to_vec());
        let rank = rank.min(count);
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
        let of_wave = |(wave, weight): (usize, &f64)| {
            let mut row = [0.0; RANK];
            for (degree, polynomial) in polynomials.iter().enumerate() {
                let (even, odd) = over_cells(wave, polynomial);
                row[degree] = weight * if degree % 2 == 0 { even } else { -odd };
            }
            row
        };
        let waves = weight.iter().enumerate().map(of_wave).collect();
        let weigh =
            |polynomial: &Vec<f64>| polynomial.iter().zip(&widths).map(|(p, width)| p * width).collect::<Vec<_>>();
        let weighted = polynomials.iter().flat_map(weigh).collect::<Vec<_>>();
        let mut unit = [0.0; RANK];
        unit[0] = weighted[..count].iter().sum();
        RobinCorrection { transfer, rank, polynomials: polynomials.concat(), weighted, unit, widths, waves }
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

    /// Projected temperature raised by a uniform `level`, K.
    pub(crate) fn above(&self, projected: &[f64; RANK], level: f64) -> [f64; RANK] {
        std::array::from_fn(|degree| projected[degree] + self.unit[degree] * level)
    }

    /// Polynomial coefficients (W/m2) of the Robin correction at a stage by the projected temperature `known` (K) that the free response
    /// gives, and the heat (W/m) of the stage into the cells, in reverse order.
    ///
    /// G_jl/w_l is the same for a pair of cells and its mirror image ([`MirroredInfluence`]), so V'W G follows from G V.
    pub(crate) fn amounts(&self, response: &StageResponse, known: &[f64; RANK], mirrored_heat: &[f64]) -> [f64; RANK] {
        let mut driving = [0.0; RANK];
        dense::multiply_transposed_add(response.lifted()[0], mirrored_heat, &mut driving[..self.rank]);
        let signed = known.iter().zip(driving).enumerate();
        self.solution(response, signed.map(|(a, (known, driving))| known + sign(a) * driving))
    }

    /// The same without heat of the stage, by the projected temperature `driving`.
    pub(crate) fn solution(&self, response: &StageResponse, driving: impl Iterator<Item = f64>) -> [f64; RANK] {
        let mut amounts = [0.0; RANK];
        for (column, driving) in response.solution.chunks_exact(self.rank.max(1)).zip(driving) {
            amounts.iter_mut().zip(column).for_each(|(amount, part)| *amount += part * driving);
        }
        amounts
    }

    /// Adds the polynomials with the coefficients `amounts` to `flux` (W/m2).
    pub(crate) fn lift(&self, amounts: &[f64; RANK], flux: &mut [f64]) {
        dense::multiply_add(&self.polynomials, &amounts[..self.rank], flux);
    }

    /// Sets `lifted` to the responses to the polynomials V by an influence.
    pub(crate) fn lift_by(&self, influence: &MirroredInfluence, lifted: &mut [f64]) {
        lifted.fill(0.0);
        let count = self.widths.len();
        for (degree, (heat, lifted)) in
            self.weighted.chunks_exact(count).zip(lifted.chunks_exact_mut(count)).enumerate()
        {
            // The heat of a polynomial in reverse order is that of it or of its opposite.
            influence.respond(heat, lifted);
            lifted.iter_mut().for_each(|value| *value *= sign(degree));
        }
    }

    /// V'W of values on the cells.
    pub(crate) fn project_cells(&self, values: &[f64]) -> [f64; RANK] {
        let mut projected = [0.0; RANK];
        dense::multiply_transposed_add(&self.weighted, values, &mut projected[..self.rank]);
        projected
    }

    /// Completes a response by its direct feedthrough, and computes the solution of the stage.
    pub(crate) fn complete(&self, feedthrough: &Feedthrough, response: &mut StageResponse) {
        let [lifted, _] = response.parts().lifted;
        dense::multiply_add(&feedthrough.lifted, &[1.0], lifted);
        let mut system = IDENTITY;
        for (b, column) in lifted.chunks_exact(self.widths.len()).enumerate() {
            let rows = system.iter_mut().zip(self.project_cells(column));
            rows.for_each(|(row, projected)| row[b] -= self.transfer * projected);
        }
        let inverse = inverse(system, self.rank);
        for (b, column) in response.solution.chunks_exact_mut(self.rank).enumerate() {
            column.iter_mut().zip(&inverse).for_each(|(target, row)| *target = self.transfer * row[b]);
        }
    }

    /// Adds the response by way of the correction to the influence matrices.
    pub(crate) fn close(&self, response: &StageResponse, influence: &mut SurfaceInfluence) {
        let count = self.widths.len();
        let SurfaceInfluence { temperature, distortion } = influence;
        let [own, _] = response.lifted();
        for (l, width) in self.widths.iter().enumerate() {
            let driving =
                own.chunks_exact(count).enumerate().map(|(a, column)| sign(a) * width * column[count - 1 - l]);
            let amounts = self.solution(response, driving);
            for (influence, lifted) in [&mut *temperature, &mut *distortion].into_iter().zip(response.lifted()) {
                dense::multiply_add(lifted, &amounts[..self.rank], &mut influence.as_mut_slice()[l * count..][..count]);
            }
        }
    }
}

/// 1 for a polynomial of even degree, -1 for an odd one.
fn sign(degree: usize) -> f64 {
    if degree.is_multiple_of(2) { 1.0 } else { -1.0 }
}

/// Identity matrix.
const IDENTITY: [[f64; RANK]; RANK] = {
    let mut matrix = [[0.0; RANK]; RANK];
    let mut i = 0;
    while i < RANK {
        matrix[i][i] = 1.0;
        i += 1;
    }
    matrix
};

/// Inverse of the first `size` rows and columns, by Gauss-Jordan elimination with partial pivoting.
fn inverse(mut matrix: [[f64; RANK]; RANK], size: usize) -> [[f64; RANK]; RANK] {
    let mut result = IDENTITY;
    for column in 0..size {
        let mut pivot = column;
        for row in column + 1..size {
            if matrix[row][column].abs() > matrix[pivot][column].abs() {
                pivot = row;
            }
        }
        matrix.swap(column, pivot);
        result.swap(column, pivot);
        let scale = 1.0 / matrix[column][column];
        let (eliminated, inverted) =
            (matrix[column].map(|value| scale * value), result[column].map(|value| scale * value));
        for row in 0..size {
            let factor = matrix[row][column];
            for k in 0..size {
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

    /// With the polynomials V and the widths W, the influence with the correction is `G + G V (1 - H0 V'W G V)^-1 H0 V'W G`; G by its
    /// definition as a sum over modes and the mean mode, and a direct feedthrough, which the distortion leaves out of G V.
    #[test]
    fn the_closed_influence_is_that_of_the_definition() {
        let (transfer, level) = (40.0, 0.3);
        let numbers: Vec<f64> = (1..40).map(|n| 60.0 * f64::from(n)).collect();
        let weight: Vec<f64> = numbers.iter().map(|q| 2.0 / (1.0 + 1e-3 * q)).collect();
        // Warmer behind the source than ahead of it.
        let own: Vec<[f64; 2]> =
            numbers.iter().map(|q| [0.3 / (1.0 + 0.01 * q), 1e-3 * q / (1.0 + 1e-4 * q * q)]).collect();
        for (count, asked) in [(1, RANK), (2, RANK), (7, RANK), (8, RANK), (17, RANK), (30, RANK), (7, 4), (30, 4)] {
            let cells = Cells::graded(0.02, count).unwrap();
            let (x, widths) = (cells.centres(), cells.widths());
            let shape = |wave: usize, i: usize| (numbers[wave] * x[i]).sin_cos();
            let robin = RobinCorrection::new(&cells, transfer, asked, &weight, |wave, polynomial| {
                (0..count).fold((0.0, 0.0), |(even, odd), i| {
                    let (sine, cosine) = shape(wave, i);
                    (even + widths[i] * polynomial[i] * cosine, odd + widths[i] * polynomial[i] * sine)
                })
            });
            let influence = |scale: f64| {
                DMatrix::from_fn(count, count, |j, l| {
                    let by_modes: f64 = (0..numbers.len())
                        .map(|wave| {
                            let turned = numbers[wave] * (x[j] - x[l]);
                            weight[wave] * (own[wave][0] * turned.cos() - own[wave][1] * turned.sin())
                        })
                        .sum();
                    scale * widths[l] * (by_modes + level)
                })
            };
            let slow = [influence(1.0), influence(-1e-7)];
            let fast = DMatrix::from_fn(count, count, |j, l| widths[l] * 0.2 / (1.0 + 900.0 * (x[j] - x[l]).abs()));
            let total = &slow[0] + &fast;
            let rank = robin.rank;
            let v = DMatrix::from_column_slice(count, rank, &robin.polynomials);
            let projection = v.transpose() * DMatrix::from_diagonal(&DVector::from_column_slice(widths));
            let identity = DMatrix::identity(rank, rank);
            let closed = (identity - transfer * &projection * &total * &v).try_inverse().unwrap();
            let returned = transfer * &v * &closed * &projection * &total;
            let expected = [&total, &slow[1]].map(|gain| gain + gain * &returned);
            let mirrored = |influence: &DMatrix<f64>| {
                let mut mirrored = MirroredInfluence::new(count);
                mirrored.take(influence.as_slice(), widths);
                mirrored
            };
            let mut feedthrough = Feedthrough {
                influence: [mirrored(&fast), MirroredInfluence::new(0)],
                lifted: vec![0.0; rank * count],
                uniform: [Vec::new(), Vec::new()],
            };
            robin.lift_by(&feedthrough.influence[0], &mut feedthrough.lifted);
            let waves = numbers.len();
            let mut response = StageResponse::new(Layout { count, distorted: count, states: 0, waves, rank });
            for (slow, lifted) in slow.iter().zip(response.parts().lifted) {
                robin.lift_by(&mirrored(slow), lifted);
            }
            robin.complete(&feedthrough, &mut response);
            let solved = DMatrix::from_column_slice(rank, rank, &response.solution);
            assert!((solved - transfer * &closed).amax() < 1e-11 * transfer, "{count}");
            let mut influence = SurfaceInfluence { temperature: total, distortion: slow[1].clone() };
            robin.close(&response, &mut influence);
            let found = [influence.temperature, influence.distortion];
            for (found, expected) in found.iter().zip(&expected) {
                assert!((found - expected).amax() < 1e-12 * expected.amax(), "{count}");
            }
        }
    }
}
