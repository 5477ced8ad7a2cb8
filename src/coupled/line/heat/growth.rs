//! Whether a step is short enough for what grows.
//!
//! Above the critical speed friction heat makes pressure waves grow. An L-stable step that is too long damps them instead,
//! and says nothing. A wave that grows at the rate b makes the matrix of a stage,
//!
//! ```text
//! C + s mu S + (wear and distortion of a stage),
//! ```
//!
//! singular when its length is about 1/b, for wear and distortion grow in proportion to a short stage. So the step is
//! short enough, `b h <= 0.3`, where the matrix with both as large as in a stage of length h/0.3 is still positive definite on
//! the pressures that load and contact allow.

use super::Heat;
use crate::coupled::line::Line;
use crate::heat::line::GAMMA;

/// Largest b h.
const GROWTH: f64 = 0.3;

/// Penalty on a change of the load against the largest diagonal entry.
const PENALTY: f64 = 1e4;

impl Line {
    /// Whether the part just tried, of `step` s at the speed `speed` (m/s), follows what grows.
    pub(in crate::coupled::line) fn follows_growth(&mut self, speed: f64, friction: f64, step: f64) -> bool {
        let Some(heat) = &mut self.heat else { return true };
        if speed * friction <= 0.0 || speed <= self.operators.mean.critical_speed.harmless(friction) {
            return true;
        }
        let (operators, conditions, pressure) = (&self.operators, &self.conditions, &self.work.end.pressure);
        let slope = |i: usize| GAMMA * step * conditions.rate.slope(i, pressure[i].max(1.0));
        heat.definite(1.0 / (GAMMA * GROWTH), conditions.signed_friction, &operators.weights, slope)
    }
}

impl Heat {
    /// Whether the matrix of the last stage, with wear and distortion `factor` times as large, is positive definite.
    fn definite(&mut self, factor: f64, friction: f64, weights: &[f64], slope: impl Fn(usize) -> f64) -> bool {
        let count = weights.len();
        let split = &self.splits[1];
        self.matrix.fill(0.0);
        let with_extra = self.contacts[1].compliance_values(friction);
        let entry = |i: usize, j: usize| with_extra[j * count + i] + (factor - 1.0) * split.extra_at(i, j);
        let mut largest: f64 = 0.0;
        for j in (0..count).filter(|&j| self.closed[j]) {
            for i in (j..count).filter(|&i| self.closed[i]) {
                let mut value = 0.5 * (weights[i] * entry(i, j) + weights[j] * entry(j, i));
                if i == j {
                    value += factor * weights[i] * slope(i);
                    largest = largest.max(value.abs() / (weights[i] * weights[i]));
                }
                self.matrix[j * count + i] = value;
            }
        }
        // Pressures that change the load are made stiff; what is left has to be definite by itself.
        for j in 0..count {
            if !self.closed[j] {
                self.matrix[j * count + j] = 1.0;
                continue;
            }
            for i in (j..count).filter(|&i| self.closed[i]) {
                self.matrix[j * count + i] += PENALTY * largest * weights[i] * weights[j];
            }
        }
        cholesky(&mut self.matrix, count)
    }
}

/// Factors the lower triangle in place, by columns; false where the matrix is not positive definite.
fn cholesky(matrix: &mut [f64], count: usize) -> bool {
    for k in 0..count {
        let (done, rest) = matrix.split_at_mut((k + 1) * count);
        let column = &mut done[k * count..];
        if column[k] <= 0.0 || column[k].is_nan() {
            return false;
        }
        let root = column[k].sqrt();
        column[k..].iter_mut().for_each(|entry| *entry /= root);
        for (offset, target) in rest.chunks_exact_mut(count).enumerate() {
            let j = k + 1 + offset;
            let factor = column[j];
            if factor != 0.0 {
                target[j..].iter_mut().zip(&column[j..]).for_each(|(entry, value)| *entry -= factor * value);
            }
        }
    }
    true
}
