//! The split of the friction heat as an operator on the pressure.
//!
//! On the cells in contact
//!
//! ```text
//! (G_1 + G_2 + I/h_c) q_1 = b_2 - b_1 + (G_2 + I/(2 h_c)) Q,    q_2 = Q - q_1
//! q_1 = y + Y Q,    u_T = d_1 + d_2 + (D_1 - D_2) y + E_0 Q,    E_0 = (D_1 - D_2) Y + D_2
//! ```
//!
//! An insulator takes nothing. At h_c = 0 the surfaces do not exchange heat and share that of friction equally.
//!
//! Exact on whatever cells are in contact, at N^3 for each such set: a steady state is found once. The step, which goes on
//! with what it has, keeps operators of its own ([`crate::coupled::line::heat::split`]).

use crate::heat::line::Gains;
use nalgebra::DMatrix;

/// See the module. Nothing is allocated after construction.
#[derive(Clone, Debug)]
pub struct Split {
    resistance: Option<f64>,
    /// Step and velocities that the gains belong to, and the cells in contact, for which the factors were made.
    key: Option<(f64, [f64; 2])>,
    closed: Vec<bool>,
    indices: Vec<usize>,
    /// Factors of G_1 + G_2 + I/h_c on the cells in contact, by columns, with the rows exchanged at each pivot.
    factors: Vec<f64>,
    pivots: Vec<usize>,
    /// Y on the cells in contact, by columns.
    shares: Vec<f64>,
    /// E_0, m per W/m2; columns of open cells are 0.
    pub distortion: DMatrix<f64>,
    column: Vec<f64>,
}

impl Split {
    /// For `count` cells of the contact conductance `conductance` (W/(m2 K)).
    pub fn new(count: usize, conductance: f64) -> Split {
        Split {
            resistance: (conductance > 0.0).then(|| 1.0 / conductance),
            key: None,
            closed: vec![false; count],
            indices: Vec::with_capacity(count),
            factors: Vec::with_capacity(count * count),
            pivots: Vec::with_capacity(count),
            shares: Vec::with_capacity(count * count),
            distortion: DMatrix::zeros(count, count),
            column: vec![0.0; count],
        }
    }

    /// Makes the operator for the cells `closed`; `key` are step and velocities of the gains (`None`: an insulator).
    pub fn prepare(&mut self, key: (f64, [f64; 2]), gains: [Option<&Gains>; 2], closed: &[bool]) {
        if self.key == Some(key) && self.closed == closed {
            return;
        }
        self.key = Some(key);
        self.closed.copy_from_slice(closed);
        self.indices.clear();
        self.indices.extend((0..closed.len()).filter(|&i| closed[i]));
        self.distortion.fill(0.0);
        match gains {
            [Some(punch), Some(strip)] => {
                if let Some(resistance) = self.resistance {
                    self.factor(punch, strip, resistance);
                }
                self.distort(punch, strip);
            }
            [Some(only), None] | [None, Some(only)] => {
                for &j in &self.indices {
                    self.distortion.column_mut(j).copy_from(&only.distortion.column(j));
                }
            }
            [None, None] => {}
        }
    }

    fn factor(&mut self, punch: &Gains, strip: &Gains, resistance: f64) {
        let m = self.indices.len();
        self.factors.clear();
        self.shares.clear();
        for (column, &j) in self.indices.iter().enumerate() {
            for (row, &i) in self.indices.iter().enumerate() {
                let (own, both) = (strip.temperature[(i, j)], punch.temperature[(i, j)] + strip.temperature[(i, j)]);
                let diagonal = if row == column { resistance } else { 0.0 };
                self.factors.push(both + diagonal);
                self.shares.push(own + 0.5 * diagonal);
            }
        }
        self.pivots.clear();
        let a = &mut self.factors;
        for k in 0..m {
            let mut pivot = k;
            for i in k + 1..m {
                if a[k * m + i].abs() > a[k * m + pivot].abs() {
                    pivot = i;
                }
            }
            self.pivots.push(pivot);
            if pivot != k {
                for column in 0..m {
                    a.swap(column * m + k, column * m + pivot);
                }
            }
            let inverse = 1.0 / a[k * m + k];
            for entry in &mut a[k * m + k + 1..(k + 1) * m] {
                *entry *= inverse;
            }
            let (left, right) = a.split_at_mut((k + 1) * m);
            let lower = &left[k * m + k + 1..];
            for column in right.chunks_exact_mut(m) {
                let factor = column[k];
                column[k + 1..].iter_mut().zip(lower).for_each(|(entry, l)| *entry -= factor * l);
            }
        }
        for column in self.shares.chunks_exact_mut(m.max(1)) {
            solve(&self.factors, &self.pivots, column);
        }
    }

    /// E_0 of two conductors.
    fn distort(&mut self, punch: &Gains, strip: &Gains) {
        let m = self.indices.len();
        for (column, &j) in self.indices.iter().enumerate() {
            let mut target = self.distortion.column_mut(j);
            target.copy_from(&strip.distortion.column(j));
            for (row, &k) in self.indices.iter().enumerate() {
                let share = match self.resistance {
                    Some(_) => self.shares[column * m + row],
                    None if row == column => 0.5,
                    None => 0.0,
                };
                if share != 0.0 {
                    target.axpy(share, &punch.distortion.column(k), 1.0);
                    target.axpy(-share, &strip.distortion.column(k), 1.0);
                }
            }
        }
    }

    /// Flux into the punch: that of the temperatures `base` without flux, with the friction heat `friction` (W/m2).
    pub fn punch_flux(&mut self, conducts: [bool; 2], base: [&[f64]; 2], friction: &[f64], flux: &mut [f64]) {
        flux.fill(0.0);
        match conducts {
            [true, true] => {}
            [true, false] => return self.indices.iter().for_each(|&i| flux[i] = friction[i]),
            [false, _] => return,
        }
        let m = self.indices.len();
        if self.resistance.is_none() {
            return self.indices.iter().for_each(|&i| flux[i] = 0.5 * friction[i]);
        }
        for (row, &i) in self.indices.iter().enumerate() {
            self.column[row] = base[1][i] - base[0][i];
        }
        solve(&self.factors, &self.pivots, &mut self.column[..m]);
        for (column, &j) in self.indices.iter().enumerate() {
            let heat = friction[j];
            if heat != 0.0 {
                let shares = &self.shares[column * m..(column + 1) * m];
                self.column[..m].iter_mut().zip(shares).for_each(|(value, share)| *value += heat * share);
            }
        }
        for (row, &i) in self.indices.iter().enumerate() {
            flux[i] = self.column[row];
        }
    }
}

/// Solves with the factors by columns and the rows exchanged, in place.
fn solve(factors: &[f64], pivots: &[usize], values: &mut [f64]) {
    let m = pivots.len();
    for (k, &pivot) in pivots.iter().enumerate() {
        values.swap(k, pivot);
    }
    for k in 0..m {
        let value = values[k];
        let lower = &factors[k * m + k + 1..(k + 1) * m];
        values[k + 1..].iter_mut().zip(lower).for_each(|(entry, l)| *entry -= value * l);
    }
    for k in (0..m).rev() {
        values[k] /= factors[k * m + k];
        let value = values[k];
        let upper = &factors[k * m..k * m + k];
        values[..k].iter_mut().zip(upper).for_each(|(entry, u)| *entry -= value * u);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_laws_hold_on_the_cells_in_contact() {
        let count = 7;
        let gains = |scale: f64, skew: f64| Gains {
            temperature: DMatrix::from_fn(count, count, |i, j| {
                let distance = i as f64 - j as f64;
                scale * ((-0.7 * distance.abs()).exp() + if i == j { 0.1 } else { skew * distance.signum() })
            }),
            distortion: DMatrix::from_fn(count, count, |i, j| -scale * (1.0 + (i * j) as f64)),
        };
        let (punch, strip) = (gains(2.0, 0.0), gains(1.0, 0.05));
        let closed = [true, true, false, true, true, true, false];
        let (base, heat) =
            ([vec![3.0, 1.0, 9.0, 2.0, 0.0, -1.0, 5.0], vec![0.5; 7]], [4.0, 5.0, 0.0, 6.0, 1.0, 2.0, 0.0]);
        for conductance in [0.0, 0.3, 1e9] {
            let mut split = Split::new(count, conductance);
            split.prepare((1.0, [0.0; 2]), [Some(&punch), Some(&strip)], &closed);
            let mut q1 = vec![0.0; count];
            split.punch_flux([true; 2], [&base[0], &base[1]], &heat, &mut q1);
            let q2: Vec<f64> = (0..count).map(|i| if closed[i] { heat[i] - q1[i] } else { 0.0 }).collect();
            for i in 0..count {
                if !closed[i] {
                    assert_eq!(q1[i], 0.0);
                    continue;
                }
                let rise = |gains: &Gains, q: &[f64]| (0..count).map(|j| gains.temperature[(i, j)] * q[j]).sum::<f64>();
                let jump = base[0][i] + rise(&punch, &q1) - base[1][i] - rise(&strip, &q2);
                let residual =
                    if conductance > 0.0 { jump - 0.5 * (q2[i] - q1[i]) / conductance } else { q2[i] - q1[i] };
                assert!(residual.abs() < 1e-12, "{conductance} {i}: {residual}");
            }
            // The distortion of the friction heat alone.
            let zero = vec![0.0; count];
            split.punch_flux([true; 2], [&zero, &zero], &heat, &mut q1);
            for i in 0..count {
                let direct: f64 = (0..count)
                    .filter(|&j| closed[j])
                    .map(|j| punch.distortion[(i, j)] * q1[j] + strip.distortion[(i, j)] * (heat[j] - q1[j]))
                    .sum();
                let by_operator: f64 = (0..count).map(|j| split.distortion[(i, j)] * heat[j]).sum();
                assert!((direct - by_operator).abs() < 1e-10 * direct.abs(), "{conductance} {i}");
            }
        }
    }
}
