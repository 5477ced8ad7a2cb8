//! Anderson acceleration of the fixed-point iteration of a stage.
//!
//! A stage whose operators were built at another velocity or friction is iterated: `x <- G(x)`, x the pressure, the flux into the
//! punch and, where friction or wear depend on it, the contact temperature.
//! The error is multiplied by `(1 - M)^-1 (M' - M)` in each iteration, M the feedback of pressure through its own friction heat
//! at the linearization point and M' at the stage. Near the critical speed one or two eigenvalues of M are close to 1, and the
//! iteration converges slowly along their modes or diverges. From the last residuals `f = G(x) - x` and their differences the
//! next x is the one that would minimise the residual if G were affine (Anderson 1965, of small depth): the few slow modes are
//! solved for, the others converge as before.
//!
//! Theory: docs/theory.md, section 6.4.

use super::evaluation::largest;
use numerics::dense;
use numerics::maximum::maximum;

/// Depth: number of differences stored.
const DEPTH: usize = 8;

/// Pressure, flux, temperature.
const PARTS: usize = 3;

/// Least part of a difference, squared, that must be linearly independent of the others for it to be used.
const INDEPENDENT: f64 = 1e-12;

/// Anderson acceleration. The parts of x are stored one behind the other, each scaled by its own magnitude.
#[derive(Clone, Debug)]
pub(super) struct Acceleration {
    /// Length of each part.
    count: usize,
    /// Scale factors of the parts, 1/Pa, m2/W and 1/K; 0: no iterate stored yet.
    units: [f64; PARTS],
    start: Vec<f64>,
    value: Vec<f64>,
    residual: Vec<f64>,
    /// Differences of residuals and of values, newest first.
    residuals: [Vec<f64>; DEPTH],
    values: [Vec<f64>; DEPTH],
    kept: usize,
    /// The last residual and value are valid for a difference with the next ones.
    compares: bool,
}

impl Acceleration {
    pub fn new(count: usize) -> Acceleration {
        let zeros = || vec![0.0; PARTS * count];
        Acceleration {
            count,
            units: [0.0; PARTS],
            start: zeros(),
            value: zeros(),
            residual: zeros(),
            residuals: std::array::from_fn(|_| zeros()),
            values: std::array::from_fn(|_| zeros()),
            kept: 0,
            compares: false,
        }
    }

    /// Discards all differences because G has changed.
    pub fn clear(&mut self) {
        (self.units, self.kept, self.compares) = ([0.0; PARTS], 0, false);
    }

    /// Stores x before an iteration.
    pub fn begin(&mut self, parts: [&[f64]; PARTS]) {
        for (own, part) in self.start.chunks_exact_mut(self.count).zip(parts) {
            own.copy_from_slice(part);
        }
    }

    /// Replaces G(x) by the accelerated next x. Returns the largest change of the pressure by this, in Pa; `None` where no
    /// difference is available yet.
    pub fn accelerate(&mut self, parts: [&mut [f64]; PARTS]) -> Option<f64> {
        let count = self.count;
        if self.units[0] == 0.0 {
            self.units = parts.each_ref().map(|part| {
                let largest = largest(part);
                if largest > 0.0 { largest.recip() } else { 0.0 }
            });
        }
        self.residuals.rotate_right(1);
        self.values.rotate_right(1);
        for (part, (unit, found)) in self.units.iter().zip(&parts).enumerate() {
            for (i, value) in (part * count..).zip(&**found) {
                let residual = unit * (value - self.start[i]);
                self.residuals[0][i] = residual - self.residual[i];
                self.values[0][i] = value - self.value[i];
                (self.residual[i], self.value[i]) = (residual, *value);
            }
        }
        if !std::mem::replace(&mut self.compares, true) {
            // Without a previous residual the newest entry is no difference: the rotation is undone.
            self.residuals.rotate_left(1);
            self.values.rotate_left(1);
            return None;
        }
        self.kept = (self.kept + 1).min(DEPTH);
        let factors = self.least();
        let mut most: f64 = 0.0;
        for (part, found) in parts.into_iter().enumerate() {
            for (i, value) in (part * count..).zip(found) {
                let change: f64 = factors.iter().zip(&self.values).map(|(factor, values)| factor * values[i]).sum();
                *value -= change;
                if part == 0 {
                    most = maximum(most, change.abs());
                }
            }
        }
        Some(most)
    }

    /// Coefficients of the differences that minimise the residual, by Gram-Schmidt orthogonalisation, newest first.
    fn least(&self) -> [f64; DEPTH] {
        let mut products = [[0.0; DEPTH]; DEPTH];
        let mut parts = [0.0; DEPTH];
        for k in 0..self.kept {
            parts[k] = dense::dot(&self.residuals[k], &self.residual);
            for j in 0..=k {
                products[k][j] = dense::dot(&self.residuals[k], &self.residuals[j]);
                products[j][k] = products[k][j];
            }
        }
        let product = |one: &[f64; DEPTH], other: &[f64; DEPTH]| -> f64 {
            one.iter().zip(&products).map(|(factor, row)| factor * multiply(row, other)).sum()
        };
        let mut factors = [0.0; DEPTH];
        // Orthonormal directions as coefficients of the differences.
        let mut directions = [[0.0; DEPTH]; DEPTH];
        for k in 0..self.kept {
            let mut own = [0.0; DEPTH];
            own[k] = 1.0;
            // A second pass removes what rounding leaves of the other directions.
            for _ in 0..2 {
                for direction in &directions[..k] {
                    let shared = product(&own, direction);
                    own.iter_mut().zip(direction).for_each(|(own, other)| *own -= shared * other);
                }
            }
            let square = product(&own, &own);
            if square > INDEPENDENT * products[k][k] {
                let norm = square.sqrt().recip();
                directions[k] = own.map(|value| value * norm);
                let part = multiply(&directions[k], &parts);
                factors.iter_mut().zip(&directions[k]).for_each(|(factor, own)| *factor += part * own);
            }
        }
        factors
    }
}

fn multiply(a: &[f64; DEPTH], b: &[f64; DEPTH]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Number of iterations until x = Ax + b is satisfied to 1e-9, at most 60; A has the given eigenvalues.
    fn iterations(eigenvalues: &[f64], accelerated: bool) -> usize {
        let count = eigenvalues.len() / PARTS;
        let mut acceleration = Acceleration::new(count);
        let mut x = vec![0.0; PARTS * count];
        // A Householder reflection makes A a full matrix.
        let normal: Vec<f64> = (0..PARTS * count).map(|i| (1.0 + i as f64).sin()).collect();
        let square = dense::dot(&normal, &normal);
        let reflect = |x: &[f64]| -> Vec<f64> {
            let part = 2.0 * dense::dot(&normal, x) / square;
            x.iter().zip(&normal).map(|(x, n)| x - part * n).collect()
        };
        for iteration in 0..60 {
            let mut next = reflect(&x);
            next.iter_mut().zip(eigenvalues).for_each(|(x, eigenvalue)| *x *= eigenvalue);
            next = reflect(&next);
            next.iter_mut().for_each(|x| *x += 1.0);
            let change = next.iter().zip(&x).fold(0.0_f64, |most, (a, b)| most.max((a - b).abs()));
            if change < 1e-9 {
                return iteration;
            }
            if accelerated {
                acceleration.begin([&x[..count], &x[count..2 * count], &x[2 * count..]]);
                let (pressure, rest) = next.split_at_mut(count);
                let (flux, temperature) = rest.split_at_mut(count);
                acceleration.accelerate([pressure, flux, temperature]);
            }
            x = next;
        }
        60
    }

    #[test]
    fn a_few_modes_that_crawl_or_run_away_are_solved_for() {
        let mut eigenvalues = [0.02, -0.03, 0.01, 0.0, 0.03, -0.01, 0.02, 0.01, -0.02, 0.0, 0.01, -0.01];
        let plain = iterations(&eigenvalues, false);
        assert!(plain <= 8 && iterations(&eigenvalues, true) <= plain);
        for one in [0.9, 0.99, -0.95, -3.0, 1.5] {
            eigenvalues[3] = one;
            assert_eq!(iterations(&eigenvalues, false), 60, "{one}");
            let found = iterations(&eigenvalues, true);
            assert!(found <= 10, "{one}: {found}");
            eigenvalues[8] = -0.8;
            let found = iterations(&eigenvalues, true);
            assert!(found <= 13, "{one} and another: {found}");
            eigenvalues[8] = -0.02;
        }
    }
}
