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

use super::stage_response::{Parts, RANK, StageResponse};
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
    /// V'W of the shape of every mode with the weight of its amplitude, and the amplitude of every mode in the polynomials; even
    /// degrees have real parts alone, odd ones imaginary parts.
    waves: Vec<[f64; RANK]>,
    heat: Vec<[f64; RANK]>,
    /// V'W G V by the real and by the imaginary parts of the modes' responses: a column for each mode of the products of even and of
    /// odd degrees, and of odd with even ones.
    by_real: Vec<f64>,
    by_imaginary: Vec<f64>,
}

/// Half of the degrees, even or odd, and number of their products.
const HALF: usize = RANK / 2;
const PRODUCTS: usize = HALF * HALF;

/// Workspace of the influence with the Robin correction: temperature response to the polynomials V, and what it gives back for a flux
/// into each cell.
#[derive(Clone, Debug)]
pub(crate) struct RobinWorkspace {
    lifted: Vec<f64>,
    returned: Vec<f64>,
}

impl RobinWorkspace {
    /// For `count` cells and `rank` polynomials.
    pub(crate) fn new(count: usize, rank: usize) -> RobinWorkspace {
        let zeros = || vec![0.0; rank * count];
        RobinWorkspace { lifted: zeros(), returned: zeros() }
    }
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
        let heat: Vec<_> = (0..weight.len())
            .map(|wave| {
                let mut row = [0.0; RANK];
                for (degree, polynomial) in polynomials.iter().enumerate() {
                    let (even, odd) = over_cells(wave, polynomial);
                    row[degree] = if degree % 2 == 0 { even } else { -odd };
                }
                row
            })
            .collect();
        let waves: Vec<_> = heat.iter().zip(weight).map(|(row, weight)| row.map(|part| weight * part)).collect();
        let products = |parity: [usize; 2]| {
            let of_mode = move |(row, heat): (&[f64; RANK], &[f64; RANK])| -> [f64; PRODUCTS] {
                std::array::from_fn(|k| row[2 * (k % HALF) + parity[0]] * heat[2 * (k / HALF) + parity[1]])
            };
            waves.iter().zip(&heat).map(of_mode)
        };
        let by_real = products([0, 0]).zip(products([1, 1])).flat_map(|(even, odd)| [even, odd].concat()).collect();
        let by_imaginary = products([1, 0]).flatten().collect();
        let weigh =
            |polynomial: &Vec<f64>| polynomial.iter().zip(&widths).map(|(p, width)| p * width).collect::<Vec<_>>();
        let weighted = polynomials.iter().flat_map(weigh).collect::<Vec<_>>();
        let mut unit = [0.0; RANK];
        unit[0] = weighted[..count].iter().sum();
        RobinCorrection {
            transfer,
            rank,
            polynomials: polynomials.concat(),
            weighted,
            unit,
            widths,
            waves,
            heat,
            by_real,
            by_imaginary,
        }
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

    /// Polynomial coefficients (W/m2) by the projected temperature that drives the correction.
    pub(crate) fn solution(&self, response: &StageResponse, driving: &[f64; RANK]) -> [f64; RANK] {
        let mut amounts = [0.0; RANK];
        dense::multiply_add(response.robin()[1], &driving[..self.rank], &mut amounts[..self.rank]);
        amounts
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
        dense::multiply_add(response.robin()[0], flux, &mut driving[..self.rank]);
        self.solution(response, &driving)
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

    /// Amplitudes of the modes in the polynomials with the coefficients `amounts`.
    pub(crate) fn amplitudes(&self, amounts: &[f64; RANK], [re, im]: &mut [Vec<f64>; 2]) {
        for (row, (re, im)) in self.heat.iter().zip(re.iter_mut().zip(im)) {
            let part = |first: usize| (first..RANK).step_by(2).map(|degree| row[degree] * amounts[degree]).sum();
            (*re, *im) = (part(0), part(1));
        }
    }

    /// Computes the solution of a stage, and V'W G for even fluxes, from the response of the modes to its own flux and the direct
    /// feedthrough; `level`: of the mean mode, per heat.
    pub(crate) fn solve(&self, level: f64, parts: Parts<'_>) {
        let Parts { own: [own_re, own_im, ..], response, solution, direct, .. } = parts;
        let (mut same, mut mixed) = ([0.0; 2 * PRODUCTS], [0.0; PRODUCTS]);
        dense::multiply_add(&self.by_real, own_re, &mut same);
        dense::multiply_add(&self.by_imaginary, own_im, &mut mixed);
        same[0] += level * self.unit[0] * self.unit[0];
        // V'W G V; without a polynomial of a degree its row and column are 0.
        let mut gain = [[0.0; RANK]; RANK];
        for (b, column) in direct.chunks_exact(self.widths.len()).enumerate() {
            gain.iter_mut().zip(self.project_cells(column)).for_each(|(row, projected)| row[b] = projected);
        }
        for (k, (even, (odd, mixed))) in same[..PRODUCTS].iter().zip(same[PRODUCTS..].iter().zip(&mixed)).enumerate() {
            let (a, b) = (2 * (k % HALF), 2 * (k / HALF));
            gain[a][b] += even;
            gain[a + 1][b + 1] += odd;
            // A polynomial of odd degree gives an imaginary amplitude.
            gain[a + 1][b] += mixed;
            gain[b][a + 1] -= mixed;
        }
        // Where no cell exchanges heat, the flux into the cells is even.
        for (column, even) in response.chunks_exact_mut(self.rank).zip(&self.weighted) {
            column.iter_mut().zip(&gain).for_each(|(value, row)| *value = even * row[0]);
        }
        self.set_solution(&gain, solution);
    }

    /// Sets `lifted` to the responses to the polynomials V by an influence matrix, N x N.
    pub(crate) fn lift_by(&self, influence: &[f64], lifted: &mut [f64]) {
        lifted.fill(0.0);
        dense::multiply_add_columns(influence, &self.polynomials, lifted, self.widths.len());
    }

    /// V'W of values on the cells.
    pub(crate) fn project_cells(&self, values: &[f64]) -> [f64; RANK] {
        let mut projected = [0.0; RANK];
        dense::multiply_transposed_add(&self.weighted, values, &mut projected[..self.rank]);
        projected
    }

    /// Computes V'W G and the solution of a stage from its responses to the polynomials, and adds the response by way of the
    /// correction to `influence` (N x N: temperature, distortion; the latter may be empty), which has the direct feedthrough.
    ///
    /// The strip is homogeneous along the path and the cells are symmetric about x = 0: G_jl/w_l is the same for a pair of
    /// cells and its mirror image, so V'W G follows from G V.
    pub(crate) fn close(&self, influence: [&mut [f64]; 2], parts: Parts<'_>, workspace: &mut RobinWorkspace) {
        let count = self.widths.len();
        let Parts { response, solution, by_modes: [warm, moved], direct, .. } = parts;
        let RobinWorkspace { lifted, returned } = workspace;
        dense::combine(lifted, [&*warm, &*direct], [1.0; 2]);
        for ((l, column), width) in response.chunks_exact_mut(self.rank).enumerate().zip(&self.widths) {
            for (a, value) in column.iter_mut().enumerate() {
                let mirrored = lifted[a * count + count - 1 - l];
                *value = if a % 2 == 0 { width * mirrored } else { -width * mirrored };
            }
        }
        let mut gain = [[0.0; RANK]; RANK];
        for (b, column) in lifted.chunks_exact(count).enumerate() {
            gain.iter_mut().zip(self.project_cells(column)).for_each(|(row, projected)| row[b] = projected);
        }
        self.set_solution(&gain, solution);
        returned.fill(0.0);
        dense::multiply_add_columns(solution, response, returned, self.rank);
        let lifted = [&lifted[..], &moved[..]];
        for (influence, lifted) in influence.into_iter().zip(lifted).filter(|(influence, _)| !influence.is_empty()) {
            dense::multiply_add_columns(lifted, returned, influence, count);
        }
    }

    /// Sets the solution `(1 - H0 gain)^-1 H0`, by columns.
    fn set_solution(&self, gain: &[[f64; RANK]; RANK], solution: &mut [f64]) {
        let inverse =
            inverse(std::array::from_fn(|a| std::array::from_fn(|b| IDENTITY[a][b] - self.transfer * gain[a][b])));
        for (b, column) in solution.chunks_exact_mut(self.rank).enumerate() {
            column.iter_mut().zip(&inverse).for_each(|(target, row)| *target = self.transfer * row[b]);
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
            let mut response = StageResponse::new(Layout { count, states: 0, waves: numbers.len(), rank, lagged: 0 });
            let Parts { by_modes, direct, .. } = response.parts();
            for (slow, lifted) in slow.iter().zip(by_modes) {
                robin.lift_by(slow.as_slice(), lifted);
            }
            robin.lift_by(fast.as_slice(), direct);
            let mut found = [total, slow[1].clone()];
            let [temperature, distortion] = &mut found;
            robin.close(
                [temperature.as_mut_slice(), distortion.as_mut_slice()],
                response.parts(),
                &mut RobinWorkspace::new(count, rank),
            );
            let [re, im, ..] = response.parts().own;
            for (wave, own) in own.iter().enumerate() {
                [re[wave], im[wave]] = *own;
            }
            robin.solve(level, response.parts());
            // An open contact has it from the modes.
            let solved = DMatrix::from_column_slice(rank, rank, response.robin()[1]);
            assert!((solved - transfer * &closed).amax() < 1e-11 * transfer, "{count}");
            for (found, expected) in found.iter().zip(&expected) {
                assert!((found - expected).amax() < 1e-12 * expected.amax(), "{count}");
            }
        }
    }
}
