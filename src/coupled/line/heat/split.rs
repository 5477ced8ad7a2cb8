//! The split of the friction heat between the bodies, and the distortion by it, as operators on the pressure.
//!
//! On the cells in contact
//!
//! ```text
//! (G_1 + G_2 + I/h_c) q_1 = b_2 - b_1 + (G_2 + I/(2 h_c)) Q,    q_2 = Q - q_1
//! q_1 = y + Y Q,    u_T = d_1 + d_2 + (D_1 - D_2) y + E_0 Q,    E_0 = (D_1 - D_2) Y + D_2
//! ```
//!
//! Cells that do not exchange heat keep their fluxes at 0 by differences of temperature of their own, so with the inverse P of
//! the first matrix and o these cells
//!
//! ```text
//! q_1 = (I - P_:o P_oo^-1 I_o:) (y + Y Q),    E_0 less (D_1 - D_2) P_:o P_oo^-1 Y_o:
//! ```
//!
//! An insulator takes nothing. At h_c = 0 the surfaces do not exchange heat and share that of friction equally.
//!
//! These operators cost N^3, and the strip's gains change with the velocity. So they are made at a reference velocity and
//! kept while the velocity stays near it; a stage repeats their solution on the residual of its own gains, at N^2 each.

use crate::contact::{Reduction, dense, largest_reduction};
use crate::elastic::MAXIMUM_CELLS;
use crate::heat::line::Gains;
use nalgebra::DMatrix;

/// See the module. Nothing is allocated after construction.
#[derive(Clone, Debug)]
pub struct Split {
    resistance: Option<f64>,
    /// Step and velocity that the operators were made for.
    key: Option<(f64, f64)>,
    /// Inverse of G_1 + G_2 + I/h_c on all cells, by columns: one product instead of two substitutions that wait for their
    /// own results. What it lacks in precision the repetition makes up for.
    inverse: Vec<f64>,
    /// Cells that exchange heat; those that do not, and the factors of their part of the inverse.
    closed: Vec<bool>,
    open: Vec<usize>,
    known: bool,
    factors: Vec<f64>,
    exchanged: Vec<usize>,
    /// Y on all cells, by columns.
    shares: Vec<f64>,
    /// D_1 - D_2 on all cells, by columns, m per W/m2.
    across: Vec<f64>,
    /// E_0 of all cells, m per W/m2.
    distortion: DMatrix<f64>,
    /// E_0 dQ/dp, m/Pa: what the contact has on top of its compliance, and dQ/dp = mu s v at the mean radius where mu is that of all
    /// cells.
    extra: DMatrix<f64>,
    per_pressure: f64,
    /// Sliding velocity of the cells over that at the mean radius.
    ratio: Vec<f64>,
    /// Largest row sums of the gains of both bodies: of temperature, K per W/m2, and of distortion, m per W/m2.
    norms: [[f64; 2]; 2],
    /// What open cells take off the extra compliance, for the heat per pressure `reduced_by`; see [`Reduction`].
    left: Vec<f64>,
    right: Vec<f64>,
    reduced_by: f64,
    column: Vec<f64>,
    needed: Vec<f64>,
}

impl Split {
    /// For cells that slide at `ratio` times the velocity at the mean radius, with the contact conductance `conductance`
    /// (W/(m2 K)).
    pub fn new(ratio: &[f64], conductance: f64) -> Split {
        let count = ratio.len();
        let square = || vec![0.0; count * count];
        Split {
            resistance: (conductance > 0.0).then(|| 1.0 / conductance),
            key: None,
            inverse: square(),
            closed: vec![false; count],
            open: Vec::with_capacity(count),
            known: false,
            factors: square(),
            exchanged: vec![0; count],
            shares: square(),
            across: square(),
            distortion: DMatrix::zeros(count, count),
            extra: DMatrix::zeros(count, count),
            per_pressure: f64::NAN,
            ratio: ratio.to_vec(),
            norms: [[0.0; 2]; 2],
            left: vec![0.0; count * largest_reduction(count)],
            right: vec![0.0; count * largest_reduction(count)],
            reduced_by: f64::NAN,
            column: vec![0.0; count],
            needed: vec![0.0; count],
        }
    }

    /// Whether the operators are those of this step (s) and reference velocity (m/s).
    pub fn is_for(&self, key: (f64, f64)) -> bool {
        self.key == Some(key)
    }

    /// Makes the operators of the given gains (`None`: an insulator).
    pub fn build(&mut self, key: (f64, f64), gains: [Option<&Gains>; 2]) {
        let count = self.closed.len();
        self.key = Some(key);
        self.known = false;
        self.per_pressure = f64::NAN;
        for (norms, gains) in self.norms.iter_mut().zip(gains) {
            *norms = gains.map_or([0.0; 2], |gains| {
                [&gains.temperature, &gains.distortion].map(|matrix| largest_row_sum(matrix, &mut self.column))
            });
        }
        match gains {
            [Some(punch), Some(strip)] => {
                let (own, other) = (strip.temperature.as_slice(), punch.temperature.as_slice());
                self.shares.fill(0.0);
                self.inverse.fill(0.0);
                for (entry, (own, other)) in self.factors.iter_mut().zip(own.iter().zip(other)) {
                    *entry = own + other;
                }
                if let Some(resistance) = self.resistance {
                    for i in 0..count {
                        self.factors[i * count + i] += resistance;
                        self.inverse[i * count + i] = 1.0;
                    }
                    dense::factorise(&mut self.factors, count, &mut self.exchanged);
                    for column in self.inverse.chunks_exact_mut(count) {
                        dense::substitute(&self.factors, count, &self.exchanged, column);
                    }
                    let columns = self.shares.chunks_exact_mut(count).zip(own.chunks_exact(count));
                    for (i, (share, own)) in columns.enumerate() {
                        self.column.copy_from_slice(own);
                        self.column[i] += 0.5 * resistance;
                        dense::multiply_add(&self.inverse, &self.column, share);
                    }
                } else {
                    (0..count).for_each(|i| self.shares[i * count + i] = 0.5);
                }
                let (own, other) = (strip.distortion.as_slice(), punch.distortion.as_slice());
                for (entry, (own, other)) in self.across.iter_mut().zip(own.iter().zip(other)) {
                    *entry = other - own;
                }
                self.distortion.copy_from(&strip.distortion);
                for (target, share) in
                    self.distortion.as_mut_slice().chunks_exact_mut(count).zip(self.shares.chunks_exact(count))
                {
                    dense::multiply_add(&self.across, share, target);
                }
            }
            [Some(only), None] | [None, Some(only)] => self.distortion.copy_from(&only.distortion),
            [None, None] => self.distortion.fill(0.0),
        }
    }

    /// Takes the cells `closed` for those that exchange heat.
    pub fn close(&mut self, closed: &[bool]) {
        if self.known && self.closed == closed {
            return;
        }
        self.known = true;
        self.reduced_by = f64::NAN;
        self.closed.copy_from_slice(closed);
        self.open.clear();
        self.open.extend((0..closed.len()).filter(|&i| !closed[i]));
        let (count, m) = (closed.len(), self.open.len());
        if m == 0 || m == count || self.resistance.is_none() {
            return;
        }
        for (target, &j) in self.factors.chunks_exact_mut(m).zip(&self.open) {
            let column = &self.inverse[j * count..(j + 1) * count];
            target.iter_mut().zip(&self.open).for_each(|(entry, &i)| *entry = column[i]);
        }
        dense::factorise(&mut self.factors[..m * m], m, &mut self.exchanged[..m]);
    }

    /// Adds to the punch's flux what takes the temperature difference `lacking` (strip above punch, resistance of the
    /// interface included, K) away on the cells that exchange heat; on the others it is 0.
    ///
    /// Differences `y` on the open cells that keep their fluxes at 0, `P_oo y = (P lacking)_o` with the inverse P, solve the
    /// equations of the closed ones: as long as few cells are open that is hardly more than the product.
    pub fn exchange(&mut self, lacking: &[f64], flux: &mut [f64]) {
        let (count, m) = (self.closed.len(), self.open.len());
        if m == 0 {
            return dense::multiply_add(&self.inverse, lacking, flux);
        }
        if m == count {
            return;
        }
        self.column.fill(0.0);
        dense::multiply_add(&self.inverse, lacking, &mut self.column);
        self.keep_from_open();
        flux.iter_mut().zip(&self.column).for_each(|(flux, more)| *flux += more);
    }

    /// Takes from the fluxes in `column` what the differences of temperature take that keep those of open cells at 0.
    fn keep_from_open(&mut self) {
        let (count, m) = (self.closed.len(), self.open.len());
        let needed = &mut self.needed[..m];
        needed.iter_mut().zip(&self.open).for_each(|(value, &i)| *value = -self.column[i]);
        dense::substitute(&self.factors[..m * m], m, &self.exchanged[..m], needed);
        for (value, &j) in needed.iter().zip(&self.open) {
            dense::multiply_add(&self.inverse[j * count..(j + 1) * count], &[*value], &mut self.column);
        }
        self.open.iter().for_each(|&i| self.column[i] = 0.0);
    }

    /// Whether the extra compliance of bodies that both conduct is exact with `open` open cells: with its reduction, which does
    /// not hold many.
    pub fn is_exact_with(&self, open: usize) -> bool {
        open <= largest_reduction(self.closed.len()) || open == self.closed.len() || self.resistance.is_none()
    }

    /// What open cells take off the extra compliance last made, of bodies that both conduct.
    pub fn reduction(&mut self) -> Option<Reduction<'_>> {
        let (count, m) = (self.closed.len(), self.open.len());
        if m == 0 || m > largest_reduction(count) || m == count || self.resistance.is_none() {
            return None;
        }
        let (left, right) = (&mut self.left[..count * m], &mut self.right[..m * count]);
        if self.reduced_by != self.per_pressure {
            self.reduced_by = self.per_pressure;
            left.fill(0.0);
            for (target, &j) in left.chunks_exact_mut(count).zip(&self.open) {
                dense::multiply_add(&self.across, &self.inverse[j * count..(j + 1) * count], target);
            }
            let columns = right.chunks_exact_mut(m).zip(self.shares.chunks_exact(count)).zip(&self.ratio);
            for ((target, share), ratio) in columns {
                let heat = self.per_pressure * ratio;
                target.iter_mut().zip(&self.open).for_each(|(value, &i)| *value = heat * share[i]);
                dense::substitute(&self.factors[..m * m], m, &self.exchanged[..m], target);
            }
        }
        Some(Reduction { acting: &self.closed, left, right })
    }

    /// Adds the displacement by `pressure` through the extra compliance last made, less its reduction where it is `reduced`.
    pub fn add_displacement(&mut self, reduced: bool, pressure: &[f64], moved: &mut [f64]) {
        dense::multiply_add(self.extra.as_slice(), pressure, moved);
        if !reduced {
            return;
        }
        let Some(Reduction { left, right, .. }) = self.reduction() else { return };
        let mut weights = [0.0; MAXIMUM_CELLS];
        let weights = &mut weights[..left.len() / moved.len()];
        dense::multiply_add(right, pressure, weights);
        weights.iter_mut().for_each(|weight| *weight = -*weight);
        dense::multiply_add(left, weights, moved);
    }

    /// Cells that do not exchange heat.
    pub fn open(&self) -> &[usize] {
        &self.open
    }

    /// Adds to the punch's flux its share of additional friction heat (W/m2), which is 0 on open cells.
    pub fn share(&mut self, heat: &[f64], flux: &mut [f64]) {
        self.column.fill(0.0);
        dense::multiply_add(&self.shares, heat, &mut self.column);
        self.open.iter().for_each(|&i| self.column[i] = 0.0);
        flux.iter_mut().zip(&self.column).for_each(|(flux, more)| *flux += more);
    }

    /// Adds to the punch's flux its share of all friction heat (W/m2), which is 0 on open cells as it is, and what keeps it at 0
    /// there.
    pub fn share_all(&mut self, heat: &[f64], flux: &mut [f64]) {
        if self.open.is_empty() {
            return dense::multiply_add(&self.shares, heat, flux);
        }
        if self.resistance.is_none() || self.open.len() == self.closed.len() {
            return self.share(heat, flux);
        }
        self.column.fill(0.0);
        dense::multiply_add(&self.shares, heat, &mut self.column);
        self.keep_from_open();
        flux.iter_mut().zip(&self.column).for_each(|(flux, more)| *flux += more);
    }

    /// D_1 - D_2 of two conducting bodies, by columns, m per W/m2.
    pub fn across(&self) -> &[f64] {
        &self.across
    }

    /// Largest rise of temperature (K) and displacement (m) of each body by fluxes of 1 W/m2 of any signs.
    pub fn norms(&self) -> &[[f64; 2]; 2] {
        &self.norms
    }

    /// The extra compliance last made, by columns, m/Pa.
    pub fn extra_values(&self) -> &[f64] {
        self.extra.as_slice()
    }

    /// Y on all cells, by columns: part of the friction heat that enters the punch where both bodies conduct.
    pub fn shares(&self) -> &[f64] {
        &self.shares
    }

    /// The extra compliance for pressures that change the heat by `heat` (N x N by columns, m/s).
    pub fn extra_by(&mut self, heat: &[f64]) -> &DMatrix<f64> {
        let count = self.closed.len();
        self.per_pressure = f64::NAN;
        self.extra.fill(0.0);
        for (target, column) in self.extra.as_mut_slice().chunks_exact_mut(count).zip(heat.chunks_exact(count)) {
            dense::multiply_add(self.distortion.as_slice(), column, target);
        }
        &self.extra
    }

    /// The extra compliance for the heat `per_pressure` (m/s: mu s v at the mean radius); `None` where it is the last one.
    pub fn extra(&mut self, per_pressure: f64) -> Option<&DMatrix<f64>> {
        if self.per_pressure == per_pressure {
            return None;
        }
        self.per_pressure = per_pressure;
        self.extra.copy_from(&self.distortion);
        for (mut column, ratio) in self.extra.column_iter_mut().zip(&self.ratio) {
            column *= per_pressure * ratio;
        }
        Some(&self.extra)
    }
}

/// Largest sum of the absolute values of a row; `sums` is room for a number each.
fn largest_row_sum(matrix: &DMatrix<f64>, sums: &mut [f64]) -> f64 {
    sums.fill(0.0);
    for column in matrix.as_slice().chunks_exact(sums.len().max(1)) {
        sums.iter_mut().zip(column).for_each(|(sum, entry)| *sum += entry.abs());
    }
    sums.iter().copied().fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Punch and strip, the second with a direction of sliding.
    fn bodies(count: usize) -> [Gains; 2] {
        [(2.0, 0.0), (1.0, 0.05)].map(|(scale, skew)| Gains {
            temperature: DMatrix::from_fn(count, count, |i, j| {
                let distance = i as f64 - j as f64;
                scale * ((-0.7 * distance.abs()).exp() + if i == j { 0.1 } else { skew * distance.signum() })
            }),
            distortion: DMatrix::from_fn(count, count, |i, j| -scale * (1.0 + (i * j) as f64)),
        })
    }

    #[test]
    fn both_laws_hold_on_the_cells_in_contact() {
        let count = 7;
        let [punch, strip] = bodies(count);
        let rise =
            |gains: &Gains, q: &[f64], i: usize| (0..count).map(|j| gains.temperature[(i, j)] * q[j]).sum::<f64>();
        let base = [[3.0, 1.0, 9.0, 2.0, 0.0, -1.0, 5.0], [0.5; 7]];
        for closed in [[true; 7], [true, true, false, true, true, true, false]] {
            let heat: Vec<f64> = (0..7).map(|i| if closed[i] { 4.0 + i as f64 } else { 0.0 }).collect();
            for conductance in [0.3, 1e9] {
                let mut split = Split::new(&vec![1.0; count], conductance);
                split.build((1.0, 0.0), [Some(&punch), Some(&strip)]);
                split.close(&closed);
                // From any guess the laws' residual leads to the solution at once.
                let mut q1: Vec<f64> = (0..7).map(|i| if closed[i] { 1.0 - i as f64 } else { 0.0 }).collect();
                let lacking = |q1: &[f64]| -> Vec<f64> {
                    let q2: Vec<f64> = (0..7).map(|i| heat[i] - q1[i]).collect();
                    (0..7)
                        .map(|i| {
                            let jump = base[1][i] + rise(&strip, &q2, i) - base[0][i] - rise(&punch, q1, i);
                            jump + 0.5 * (q2[i] - q1[i]) / conductance
                        })
                        .collect()
                };
                let residual = lacking(&q1);
                split.exchange(&residual, &mut q1);
                let residual = lacking(&q1);
                for i in 0..7 {
                    assert!(if closed[i] { residual[i].abs() < 1e-12 } else { q1[i] == 0.0 }, "{conductance} {i}");
                }
            }
        }
    }

    #[test]
    fn the_reduction_makes_the_extra_compliance_that_of_cells_which_exchange_no_heat() {
        let count = 9;
        let [punch, strip] = bodies(count);
        let ratio: Vec<f64> = (0..count).map(|i| 1.0 + 0.1 * i as f64).collect();
        let per_pressure = 0.7;
        for open in [vec![], vec![8], vec![0, 3, 8]] {
            let closed: Vec<bool> = (0..count).map(|i| !open.contains(&i)).collect();
            let pressure: Vec<f64> = (0..count).map(|i| if closed[i] { 2.0 + i as f64 } else { 0.0 }).collect();
            let heat: Vec<f64> = (0..count).map(|i| per_pressure * ratio[i] * pressure[i]).collect();
            for conductance in [0.3, 1e9] {
                let mut split = Split::new(&ratio, conductance);
                split.build((1.0, 0.0), [Some(&punch), Some(&strip)]);
                split.close(&closed);
                assert!(split.is_exact_with(open.len()));
                assert!(split.extra(per_pressure).is_some());
                let mut q1 = vec![0.0; count];
                split.share_all(&heat, &mut q1);
                // Both laws of the interface, and no flux elsewhere.
                let sum =
                    |gains: &DMatrix<f64>, q: &[f64], i: usize| (0..count).map(|j| gains[(i, j)] * q[j]).sum::<f64>();
                let q2: Vec<f64> = heat.iter().zip(&q1).map(|(heat, q)| heat - q).collect();
                for i in 0..count {
                    if !closed[i] {
                        assert_eq!([q1[i], q2[i]], [0.0; 2]);
                        continue;
                    }
                    let jump = sum(&punch.temperature, &q1, i) - sum(&strip.temperature, &q2, i);
                    assert!((jump - 0.5 * (q2[i] - q1[i]) / conductance).abs() < 1e-12, "{open:?} {conductance} {i}");
                }
                let mut moved = vec![0.0; count];
                split.add_displacement(true, &pressure, &mut moved);
                for i in 0..count {
                    let direct = sum(&punch.distortion, &q1, i) + sum(&strip.distortion, &q2, i);
                    assert!(
                        (moved[i] / direct - 1.0).abs() < 1e-12,
                        "{open:?} {conductance} {i}: {} {direct}",
                        moved[i]
                    );
                }
            }
        }
    }

    #[test]
    fn distortion_is_that_of_the_shared_heat() {
        let count = 5;
        let gains = |scale: f64| Gains {
            temperature: DMatrix::from_fn(count, count, |i, j| scale / (1.0 + i.abs_diff(j) as f64)),
            distortion: DMatrix::from_fn(count, count, |i, j| -scale * (1.0 + (i * j) as f64)),
        };
        let (punch, strip) = (gains(2.0), gains(1.0));
        for conductance in [0.0, 0.3, 1e9] {
            let mut split = Split::new(&vec![1.0; count], conductance);
            split.build((1.0, 0.0), [Some(&punch), Some(&strip)]);
            split.close(&[true; 5]);
            let heat = [4.0, 5.0, 0.0, 6.0, 1.0];
            let mut q1 = vec![0.0; count];
            split.share(&heat, &mut q1);
            for i in 0..count {
                let direct: f64 = (0..count)
                    .map(|j| punch.distortion[(i, j)] * q1[j] + strip.distortion[(i, j)] * (heat[j] - q1[j]))
                    .sum();
                let by_operator: f64 = (0..count).map(|j| split.distortion[(i, j)] * heat[j]).sum();
                assert!((direct - by_operator).abs() < 1e-12 * direct.abs(), "{conductance} {i}");
            }
        }
    }
}
