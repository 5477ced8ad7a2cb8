//! A repetition that goes on along what its last steps have in common.
//!
//! A stage whose operators are those of another velocity is repeated: `x <- G(x)`, x the pressure and the flux into the punch. What
//! remains falls by `(1 - M)^-1 (M' - M)`, M what the contact makes of its own heat at the reference and M' at the stage. Near the
//! critical speed a mode or two of M are close to 1, and the repetition crawls along these or runs away. With the last residuals
//! `f = G(x) - x` and their differences the next x is the one whose residual would be least if G were affine (Anderson 1965, of small
//! depth): the few modes are solved for, the others fall as before.

use numerics::dense;
use numerics::maximum::maximum;

/// Differences that are kept.
const DEPTH: usize = 4;

/// Part of a difference, squared, that has to be new for it to count.
const INDEPENDENT: f64 = 1e-12;

/// See the module. The two parts of x stand one behind the other, both in units of their size.
#[derive(Clone, Debug)]
pub(super) struct Acceleration {
    /// Numbers of either part.
    count: usize,
    /// Units of both parts, 1/Pa and m2/W; 0: nothing has been seen yet.
    units: [f64; 2],
    start: Vec<f64>,
    value: Vec<f64>,
    residual: Vec<f64>,
    /// Differences of residual and of value, from the newest on.
    residuals: [Vec<f64>; DEPTH],
    values: [Vec<f64>; DEPTH],
    kept: usize,
    /// The last residual and value can be compared with.
    compares: bool,
}

impl Acceleration {
    pub fn new(count: usize) -> Acceleration {
        let zeros = || vec![0.0; 2 * count];
        Acceleration {
            count,
            units: [0.0; 2],
            start: zeros(),
            value: zeros(),
            residual: zeros(),
            residuals: std::array::from_fn(|_| zeros()),
            values: std::array::from_fn(|_| zeros()),
            kept: 0,
            compares: false,
        }
    }

    /// Forgets everything: G is another one.
    pub fn forget(&mut self) {
        (self.units, self.kept, self.compares) = ([0.0; 2], 0, false);
    }

    /// Notes x before it is repeated.
    pub fn begin(&mut self, pressure: &[f64], flux: &[f64]) {
        let (own_pressure, own_flux) = self.start.split_at_mut(self.count);
        own_pressure.copy_from_slice(pressure);
        own_flux.copy_from_slice(flux);
    }

    /// Takes G(x) and puts the next x in its place. Returns by how much the pressure has moved, in Pa; `None` where there was nothing
    /// to compare with.
    pub fn improve(&mut self, pressure: &mut [f64], flux: &mut [f64]) -> Option<f64> {
        let count = self.count;
        if self.units[0] == 0.0 {
            let unit = |values: &[f64]| {
                let largest = values.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
                if largest > 0.0 { largest.recip() } else { 0.0 }
            };
            self.units = [unit(pressure), unit(flux)];
        }
        self.residuals.rotate_right(1);
        self.values.rotate_right(1);
        let found = pressure.iter().chain(&*flux);
        for (i, value) in found.enumerate() {
            let residual = self.units[usize::from(i >= count)] * (value - self.start[i]);
            self.residuals[0][i] = residual - self.residual[i];
            self.values[0][i] = value - self.value[i];
            (self.residual[i], self.value[i]) = (residual, *value);
        }
        if !std::mem::replace(&mut self.compares, true) {
            // What was rotated to the front is no difference.
            self.residuals.rotate_left(1);
            self.values.rotate_left(1);
            return None;
        }
        self.kept = (self.kept + 1).min(DEPTH);
        let factors = self.least();
        let mut most: f64 = 0.0;
        for (i, value) in pressure.iter_mut().chain(flux).enumerate() {
            let change: f64 = factors.iter().zip(&self.values).map(|(factor, values)| factor * values[i]).sum();
            *value -= change;
            if i < count {
                most = maximum(most, change.abs());
            }
        }
        Some(most)
    }

    /// Factors of the differences that bring the residual to its least, by Gram and Schmidt from the newest on.
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
        // Directions by their factors of the differences.
        let mut directions = [[0.0; DEPTH]; DEPTH];
        for k in 0..self.kept {
            let mut own = [0.0; DEPTH];
            own[k] = 1.0;
            // What rounding leaves of the other directions goes the second time.
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

    /// Repetitions until x = Ax + b is met to 1e-9, at most 60; A has the given eigenvalues.
    fn iterations(eigenvalues: &[f64], accelerated: bool) -> usize {
        let count = eigenvalues.len() / 2;
        let mut acceleration = Acceleration::new(count);
        let mut x = vec![0.0; 2 * count];
        // A reflection turns the eigenvectors away from the entries.
        let normal: Vec<f64> = (0..2 * count).map(|i| (1.0 + i as f64).sin()).collect();
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
                acceleration.begin(&x[..count], &x[count..]);
                let (pressure, flux) = next.split_at_mut(count);
                acceleration.improve(pressure, flux);
            }
            x = next;
        }
        60
    }

    #[test]
    fn a_few_modes_that_crawl_or_run_away_are_solved_for() {
        let mut eigenvalues = [0.02, -0.03, 0.01, 0.0, 0.03, -0.01, 0.02, 0.01, -0.02, 0.0];
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
