//! Friction-temperature Jacobian in the Newton step of a stage.
//!
//! Friction heat `Q_i = mu(T_i) s v p_i` heats the contact by `T = b + H Q`, H the mean of both surface influence matrices of
//! temperature with their heat partition, and the temperature changes the friction. A small change of the pressure therefore
//! changes the heat by
//!
//! ```text
//! (I - diag(s v p mu') H) dQ = diag(s v mu) dp
//! ```
//!
//! and the surface by `E_0 dQ`. Fixed-point iteration, with the friction coefficient of the previous iterate, alternates instead,
//! because less friction is less heat; the closer a pressure wave is to instantaneous growth, the larger the change of pressure
//! from that difference, and beyond some speed the iteration diverges at any step size.
//!
//! Theory: docs/theory.md, section 6.3.

use super::partition::HeatPartition;
use conduction::line::SurfaceInfluence;
use numerics::dense;

/// Friction-temperature Jacobian at the pressure and temperature of the previous iterate. Nothing is allocated after
/// construction.
#[derive(Clone, Debug)]
pub struct FrictionJacobian {
    /// H, by columns, K per W/m2.
    rise: Vec<f64>,
    /// I - diag(s v p mu') H and its factors.
    matrix: Vec<f64>,
    exchanged: Vec<usize>,
    /// dQ/dp, by columns, m/s.
    heat: Vec<f64>,
    column: Vec<f64>,
}

impl FrictionJacobian {
    /// Jacobian for `count` cells.
    pub fn new(count: usize) -> FrictionJacobian {
        let square = || vec![0.0; count * count];
        FrictionJacobian {
            rise: square(),
            matrix: square(),
            exchanged: vec![0; count],
            heat: square(),
            column: vec![0.0; count],
        }
    }

    /// Builds H from the surface influence matrices (`None`: an insulator) and the heat partition; `half_resistance`: 1/(2 h_c),
    /// 0 without exchange.
    pub fn build(
        &mut self,
        partition: &HeatPartition,
        influence: [Option<&SurfaceInfluence>; 2],
        half_resistance: f64,
    ) {
        let count = self.column.len();
        match influence {
            [Some(punch), Some(strip)] => {
                // (G_1 Y + G_2 (I - Y))/2
                let (own, other) = (punch.temperature.as_slice(), strip.temperature.as_slice());
                for (entry, (own, other)) in self.matrix.iter_mut().zip(own.iter().zip(other)) {
                    *entry = 0.5 * (own - other);
                }
                for (entry, other) in self.rise.iter_mut().zip(other) {
                    *entry = 0.5 * other;
                }
                let shares = partition.shares().chunks_exact(count);
                for (target, share) in self.rise.chunks_exact_mut(count).zip(shares) {
                    dense::multiply_add(&self.matrix, share, target);
                }
            }
            [Some(only), None] | [None, Some(only)] => {
                // The insulator is warmer by Q/(2 h_c); without exchange its temperature does not change.
                let part = if half_resistance > 0.0 { 1.0 } else { 0.5 };
                for (entry, own) in self.rise.iter_mut().zip(only.temperature.as_slice()) {
                    *entry = part * own;
                }
                (0..count).for_each(|i| self.rise[i * count + i] += 0.5 * half_resistance);
            }
            [None, None] => self.rise.fill(0.0),
        }
    }

    /// dQ/dp (by columns, m/s) of cells with friction heat per pressure `per_pressure` (m/s) and derivative `slope` (W/(m2 K)) of
    /// the friction heat with temperature; both are 0 on cells without friction heat.
    pub fn linearize(&mut self, per_pressure: impl Fn(usize) -> f64, slope: impl Fn(usize) -> f64) -> &[f64] {
        let count = self.column.len();
        for (i, slope) in (0..count).map(|i| (i, slope(i))) {
            for j in 0..count {
                let unit = if i == j { 1.0 } else { 0.0 };
                self.matrix[j * count + i] = unit - slope * self.rise[j * count + i];
            }
        }
        dense::factorise(&mut self.matrix, count, &mut self.exchanged);
        self.heat.fill(0.0);
        for (j, column) in self.heat.chunks_exact_mut(count).enumerate() {
            column[j] = per_pressure(j);
            if column[j] != 0.0 {
                dense::substitute(&self.matrix, count, &self.exchanged, column);
            }
        }
        &self.heat
    }

    /// `heat += dQ/dp change`, W/m2 for Pa.
    pub fn add_heat(&self, change: &[f64], heat: &mut [f64]) {
        dense::multiply_add(&self.heat, change, heat);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::DMatrix;

    #[test]
    fn heat_changes_as_the_law_of_friction_says() {
        let count = 6;
        // Asymmetric as for a moving source: the influence is stronger downstream than upstream.
        let influence = |scale: f64| SurfaceInfluence {
            temperature: DMatrix::from_fn(count, count, |i, j| {
                scale * (1.0 + 0.1 * j as f64) / (1.0 + i.abs_diff(j) as f64)
            }),
            distortion: DMatrix::zeros(count, count),
        };
        let (punch, strip) = (influence(2.0), influence(0.5));
        // mu decreases by a thousandth per kelvin from the temperature 0 on.
        let (slip, coefficient, fall) = (3.0, 0.4, 1e-3);
        let pressure: Vec<f64> = (0..count).map(|i| 10.0 + 3.0 * i as f64).collect();
        for pair in [[Some(&punch), Some(&strip)], [Some(&punch), None], [None, Some(&strip)]] {
            let mut partition = HeatPartition::new(&vec![1.0; count], &vec![1.0; count], 4.0);
            partition.build((1.0, 0.0), pair);
            partition.set_active_set(&[true; 6]);
            let mut friction_jacobian = FrictionJacobian::new(count);
            friction_jacobian.build(&partition, pair, 0.125);
            // Temperatures of both surfaces by the laws of the heat partition alone.
            let contact_temperature = |heat: &[f64]| -> Vec<f64> {
                let mut own = vec![0.0; count];
                match pair {
                    [Some(_), Some(_)] => partition.clone().add_punch_flux(heat, &mut own),
                    [Some(_), None] => own.copy_from_slice(heat),
                    _ => {}
                }
                let other: Vec<f64> = (0..count).map(|i| heat[i] - own[i]).collect();
                let rise = |influence: Option<&SurfaceInfluence>, flux: &[f64], i: usize| {
                    influence.map(|influence| (0..count).map(|j| influence.temperature[(i, j)] * flux[j]).sum::<f64>())
                };
                (0..count)
                    .map(|i| match (rise(pair[0], &own, i), rise(pair[1], &other, i)) {
                        (Some(one), Some(two)) => 0.5 * (one + two),
                        (Some(only), None) | (None, Some(only)) => only + 0.5 * 0.125 * heat[i],
                        (None, None) => 0.0,
                    })
                    .collect()
            };
            let solve = |pressure: &[f64]| -> Vec<f64> {
                let mut heat = vec![0.0; count];
                for _ in 0..400 {
                    let contact_temperature = contact_temperature(&heat);
                    heat = (0..count)
                        .map(|i| slip * coefficient * (1.0 - fall * contact_temperature[i]) * pressure[i])
                        .collect();
                }
                heat
            };
            let heat = solve(&pressure);
            let now = contact_temperature(&heat);
            let mu = |i: usize| coefficient * (1.0 - fall * now[i]);
            friction_jacobian.linearize(|i| slip * mu(i), |i| -slip * pressure[i] * coefficient * fall);
            let change: Vec<f64> = (0..count).map(|i| 1e-4 * (1.0 - 0.5 * i as f64)).collect();
            let mut predicted = vec![0.0; count];
            friction_jacobian.add_heat(&change, &mut predicted);
            let moved: Vec<f64> = pressure.iter().zip(&change).map(|(p, more)| p + more).collect();
            for (i, (after, before)) in solve(&moved).iter().zip(&heat).enumerate() {
                let found = after - before;
                assert!((found - predicted[i]).abs() < 1e-3 * predicted[0].abs(), "{i}: {found} {}", predicted[i]);
            }
        }
    }
}
