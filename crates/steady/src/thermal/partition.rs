//! Heat partition of the steady state, as an operator on the pressure.
//!
//! On the cells in contact
//!
//! ```text
//! (G_1 + G_2 + I/h_c) q_1 = b_2 - b_1 + (G_2 + I/(2 h_c)) Q,    q_2 = Q - q_1
//! q_1 = y + Y Q,    u_T = d_1 + d_2 + (D_1 - D_2) y + E_0 Q,    E_0 = (D_1 - D_2) Y + D_2
//! ```
//!
//! An insulator receives no heat. At h_c = 0 the surfaces do not exchange heat, and each receives half of the friction heat.
//!
//! Exact for any active set, at N^3 each: a steady state is computed once. The time step uses cached operators
//! ([`model::line::heat::partition`]).

use conduction::line::SurfaceInfluence;
use nalgebra::{DMatrix, DVector, Dyn, LU};
use numerics::factorization;

/// Heat partition operator of an active set.
#[derive(Clone, Debug)]
pub struct HeatPartition {
    resistance: Option<f64>,
    /// Step and velocities of the surface influence matrices, and active set, for which the factors were computed.
    key: Option<(f64, [f64; 2])>,
    closed: Vec<bool>,
    indices: Vec<usize>,
    /// Factors of G_1 + G_2 + I/h_c on the cells in contact, for two bodies that exchange heat.
    factors: Option<LU<f64, Dyn, Dyn>>,
    /// Partition matrix Y on the cells in contact.
    shares: DMatrix<f64>,
    /// E_0, m per W/m2; columns of open cells are 0.
    pub distortion: DMatrix<f64>,
}

impl HeatPartition {
    /// Heat partition for `count` cells with the contact conductance `conductance` (W/(m2 K)).
    pub fn new(count: usize, conductance: f64) -> HeatPartition {
        HeatPartition {
            resistance: (conductance > 0.0).then(|| 1.0 / conductance),
            key: None,
            closed: vec![false; count],
            indices: Vec::new(),
            factors: None,
            shares: DMatrix::zeros(0, 0),
            distortion: DMatrix::zeros(count, count),
        }
    }

    /// Builds the operator for the active set `closed`; `key`: step and velocities of the influence matrices (`None`: an
    /// insulator).
    pub fn prepare(&mut self, key: (f64, [f64; 2]), influence: [Option<&SurfaceInfluence>; 2], closed: &[bool]) {
        if self.key == Some(key) && self.closed == closed {
            return;
        }
        self.key = Some(key);
        self.closed.copy_from_slice(closed);
        self.indices.clear();
        self.indices.extend((0..closed.len()).filter(|&i| closed[i]));
        self.distortion.fill(0.0);
        self.factors = None;
        match influence {
            [Some(punch), Some(strip)] => {
                self.share(punch, strip);
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

    /// Computes Y for two conductors.
    fn share(&mut self, punch: &SurfaceInfluence, strip: &SurfaceInfluence) {
        let (m, indices) = (self.indices.len(), &self.indices);
        let Some(resistance) = self.resistance else {
            self.shares = DMatrix::from_diagonal_element(m, m, 0.5);
            return;
        };
        let part =
            |matrix: &DMatrix<f64>| DMatrix::from_fn(m, m, |row, column| matrix[(indices[row], indices[column])]);
        let own = part(&strip.temperature);
        let across = part(&punch.temperature) + &own + DMatrix::from_diagonal_element(m, m, resistance);
        let Ok(factors) = factorization::lu(across) else {
            self.shares = DMatrix::from_element(m, m, f64::NAN);
            return;
        };
        self.shares = own + DMatrix::from_diagonal_element(m, m, 0.5 * resistance);
        factors.solve_mut(&mut self.shares);
        self.factors = Some(factors);
    }

    /// Computes E_0 for two conductors.
    fn distort(&mut self, punch: &SurfaceInfluence, strip: &SurfaceInfluence) {
        let across = (&punch.distortion - &strip.distortion).select_columns(&self.indices) * &self.shares;
        for (column, &j) in self.indices.iter().enumerate() {
            self.distortion.column_mut(j).copy_from(&(strip.distortion.column(j) + across.column(column)));
        }
    }

    /// Flux into the punch, for the free response `base` (K) of both surfaces and the friction heat `friction` (W/m2).
    pub fn punch_flux(&self, conducts: [bool; 2], base: [&[f64]; 2], friction: &[f64], flux: &mut [f64]) {
        flux.fill(0.0);
        match conducts {
            [true, true] => {}
            [true, false] => return self.indices.iter().for_each(|&i| flux[i] = friction[i]),
            [false, _] => return,
        }
        let entries =
            |of: &dyn Fn(usize) -> f64| DVector::from_iterator(self.indices.len(), self.indices.iter().map(|&i| of(i)));
        let mut found = &self.shares * entries(&|i| friction[i]);
        if let Some(factors) = &self.factors {
            let mut exchanged = entries(&|i| base[1][i] - base[0][i]);
            factors.solve_mut(&mut exchanged);
            found += exchanged;
        }
        for (value, &i) in found.iter().zip(&self.indices) {
            flux[i] = *value;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_laws_hold_on_the_cells_in_contact() {
        let count = 7;
        let influence = |scale: f64, skew: f64| SurfaceInfluence {
            temperature: DMatrix::from_fn(count, count, |i, j| {
                let distance = i as f64 - j as f64;
                scale * ((-0.7 * distance.abs()).exp() + if i == j { 0.1 } else { skew * distance.signum() })
            }),
            distortion: DMatrix::from_fn(count, count, |i, j| -scale * (1.0 + (i * j) as f64)),
        };
        let (punch, strip) = (influence(2.0, 0.0), influence(1.0, 0.05));
        let closed = [true, true, false, true, true, true, false];
        let (base, heat) =
            ([vec![3.0, 1.0, 9.0, 2.0, 0.0, -1.0, 5.0], vec![0.5; 7]], [4.0, 5.0, 0.0, 6.0, 1.0, 2.0, 0.0]);
        for conductance in [0.0, 0.3, 1e9] {
            let mut partition = HeatPartition::new(count, conductance);
            partition.prepare((1.0, [0.0; 2]), [Some(&punch), Some(&strip)], &closed);
            let mut q1 = vec![0.0; count];
            partition.punch_flux([true; 2], [&base[0], &base[1]], &heat, &mut q1);
            let q2: Vec<f64> = (0..count).map(|i| if closed[i] { heat[i] - q1[i] } else { 0.0 }).collect();
            for i in 0..count {
                if !closed[i] {
                    assert_eq!(q1[i], 0.0);
                    continue;
                }
                let rise = |influence: &SurfaceInfluence, q: &[f64]| {
                    (0..count).map(|j| influence.temperature[(i, j)] * q[j]).sum::<f64>()
                };
                let jump = base[0][i] + rise(&punch, &q1) - base[1][i] - rise(&strip, &q2);
                let residual =
                    if conductance > 0.0 { jump - 0.5 * (q2[i] - q1[i]) / conductance } else { q2[i] - q1[i] };
                assert!(residual.abs() < 1e-12, "{conductance} {i}: {residual}");
            }
            // Distortion by the friction heat alone.
            let zero = vec![0.0; count];
            partition.punch_flux([true; 2], [&zero, &zero], &heat, &mut q1);
            for i in 0..count {
                let direct: f64 = (0..count)
                    .filter(|&j| closed[j])
                    .map(|j| punch.distortion[(i, j)] * q1[j] + strip.distortion[(i, j)] * (heat[j] - q1[j]))
                    .sum();
                let by_operator: f64 = (0..count).map(|j| partition.distortion[(i, j)] * heat[j]).sum();
                assert!((direct - by_operator).abs() < 1e-10 * direct.abs(), "{conductance} {i}");
            }
        }
    }
}
