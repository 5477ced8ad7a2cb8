//! Which states the punch needs: modes across the width, and for each the decaying shapes through the height.
//!
//! The impedance of the contact is diagonal in the modes across, `q = X_m q_m` gives `T = X_m z_m(s) q_m`, and the
//! reduced one is so too. The largest error of the temperature in the mean square over the contact, by any flux whose
//! mean square and that of `width/pi` times its slope sum to 1, is therefore
//!
//! ```text
//! max over m and frequencies of |z_m - z_m,reduced| / sqrt(1 + (xi_m width/pi)^2)
//! ```
//!
//! and the norm of the operator from such fluxes to temperatures needs no matrix. It is taken relative to the impedance
//! to a uniform flux at 1/duration, the rise of the whole duration. The worst mode gets one more response to a real rate
//! (rational Krylov) until the error is met: a greedy choice of the rates.

use super::across::{Across, Sides, Wave};
use super::depth::{Basis, Depth, Points};
use crate::slab::principal_root;
use nalgebra::Complex;
use numerics::maximum::maximum;
use std::f64::consts::PI;

/// Frequencies at which the error is looked for, per mode.
const FREQUENCIES: usize = 64;

/// Modes that get their states before all others: the uniform one, and those that tilt and bend.
const LONGEST: usize = 3;

/// A constant flux has content below its own frequency: the slowest looked at, over 1/duration.
const SLOWEST: f64 = 0.03;

/// One mode across with the trial functions that it has so far.
#[derive(Clone, Debug)]
pub(super) struct Mode {
    pub wave: Wave,
    pub basis: Basis,
    /// The fastest shape acts without delay and is no state.
    pub fastest_is_steady: bool,
    /// Error over the scale and the weight of the mode.
    pub error: f64,
    /// What it should be below.
    tolerance: f64,
    /// Heat can leave, so there is a steady response; it is the last of the frequencies, 0.
    steady: bool,
    /// 1 over scale and weight.
    share: f64,
    frequency: Vec<f64>,
    /// Exact impedance over scale and weight.
    exact: Vec<Complex<f64>>,
    used: Vec<bool>,
    exhausted: bool,
}

/// What the modes are judged by.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scale {
    /// Impedance to a uniform flux at 1/duration, K m2/W.
    pub impedance: f64,
    /// Time over which temperatures are of interest, s.
    pub duration: f64,
    pub tolerance: f64,
    /// Part of it that the first mode may take.
    mean: f64,
}

/// The first mode of a ring, which is all that the lumped level has of the body, is followed as closely as there.
const MEAN_OF_RING: f64 = 0.1;

impl Scale {
    /// For a tolerance of every mode and one of the uniform one.
    pub fn new(across: &Across, depth: &Depth, duration: f64, [tolerance, of_the_mean]: [f64; 2]) -> Scale {
        let kappa = kappa(depth, across.wave(0).decay, 1.0 / duration);
        let mean = match across.sides {
            Sides::Radial(_) => MEAN_OF_RING,
            Sides::Free | Sides::Closed => 1.0,
        };
        let mean = mean.min(of_the_mean / tolerance);
        Scale { impedance: depth.impedance(kappa).norm(), duration, tolerance, mean }
    }

    /// Tolerance of the mode number `m`.
    fn of_mode(&self, m: usize) -> f64 {
        if m < LONGEST { self.mean * self.tolerance } else { self.tolerance }
    }

    /// Decay beyond which even a uniform flux has no impedance above the tolerance, 1/m.
    pub fn steepest(&self, depth: &Depth) -> f64 {
        self.steepest_of(depth, self.of_mode(0))
    }

    fn steepest_of(&self, depth: &Depth, tolerance: f64) -> f64 {
        let slow = (SLOWEST.recip() / (depth.diffusivity() * self.duration)).sqrt();
        (1.0 / (depth.conductivity * tolerance * self.impedance)).max(slow)
    }
}

fn kappa(depth: &Depth, decay: f64, frequency: f64) -> Complex<f64> {
    principal_root(Complex::new(decay * decay, frequency / depth.diffusivity()))
}

impl Mode {
    fn new(wave: Wave, m: usize, width: f64, depth: &Depth, scale: &Scale) -> Mode {
        let tolerance = scale.of_mode(m);
        let weight = 1.0f64.hypot(wave.wave_number * width / PI);
        let slowest = SLOWEST / scale.duration;
        // Above this frequency the mode's impedance has fallen to the tolerance.
        let steepest = scale.steepest_of(depth, tolerance) / weight;
        let fastest = (depth.diffusivity() * steepest * steepest).max(3.0 / scale.duration);
        let ratio = (fastest / slowest).powf(1.0 / (FREQUENCIES - 1) as f64);
        let mut frequency: Vec<f64> = (0..FREQUENCIES).map(|i| slowest * ratio.powi(i as i32)).collect();
        let share = 1.0 / (weight * scale.impedance);
        let mut exact: Vec<Complex<f64>> =
            frequency.iter().map(|&f| depth.impedance(kappa(depth, wave.decay, f)) * share).collect();
        let steady = depth.has_steady_state(wave.decay);
        if steady {
            frequency.push(0.0);
            exact.push(Complex::from(depth.steady_impedance(wave.decay) * share));
        }
        let used = vec![false; frequency.len()];
        let basis = Basis::new(*depth, wave.decay);
        let mut mode = Mode {
            wave,
            basis,
            fastest_is_steady: false,
            error: f64::INFINITY,
            tolerance,
            steady,
            share,
            frequency,
            exact,
            used,
            exhausted: false,
        };
        mode.judge();
        mode
    }

    /// Number of states.
    pub fn states(&self) -> usize {
        self.basis.count() - usize::from(self.fastest_is_steady)
    }

    /// Adds a trial function: the steady response first, so that steady states are exact, then the response at the rate
    /// where the error is largest.
    fn improve(&mut self, points: &Points) {
        let last = self.frequency.len() - 1;
        if self.steady && !self.used[last] {
            self.used[last] = true;
            self.basis.add_response(points, 0.0);
        } else {
            let errors = self.errors(false);
            loop {
                let unused = (0..errors.len()).filter(|&i| !self.used[i]);
                let Some(worst) = unused.max_by(|&i, &j| errors[i].total_cmp(&errors[j])) else {
                    self.exhausted = true;
                    return;
                };
                self.used[worst] = true;
                if self.basis.add_response(points, self.frequency[worst]) {
                    break;
                }
            }
        }
        self.judge();
    }

    /// The error, and whether the fastest shape can do without a state.
    fn judge(&mut self) {
        let largest = |errors: Vec<f64>| errors.into_iter().fold(0.0, maximum);
        self.fastest_is_steady = false;
        self.error = largest(self.errors(false));
        let uniform_alone = !self.steady && self.basis.count() == 1;
        if self.basis.count() > 0 && !uniform_alone {
            let error = largest(self.errors(true));
            if error <= self.tolerance {
                self.fastest_is_steady = true;
                self.error = error;
            }
        }
    }

    /// Errors over scale and weight at every frequency, with the fastest shape as a state or acting without delay.
    fn errors(&self, fastest_is_steady: bool) -> Vec<f64> {
        let residues: Vec<(f64, f64)> = self.basis.residues().map(|(rate, z)| (rate, z * z * self.share)).collect();
        if residues.is_empty() {
            // All of the mode acts without delay, where it has a steady state at all.
            let steady = if self.steady { self.exact[FREQUENCIES] } else { Complex::from(0.0) };
            return self.exact.iter().map(|exact| (exact - steady).norm_sqr().sqrt()).collect();
        }
        let states = residues.len() - usize::from(fastest_is_steady);
        let direct: f64 = residues[states..].iter().map(|(rate, residue)| residue / rate).sum();
        (self.frequency.iter().zip(&self.exact))
            .map(|(&frequency, exact)| {
                let (mut real, mut imaginary) = (direct, 0.0);
                for &(rate, residue) in &residues[..states] {
                    let part = residue / (rate * rate + frequency * frequency);
                    real += part * rate;
                    imaginary -= part * frequency;
                }
                (exact - Complex::new(real, imaginary)).norm_sqr().sqrt()
            })
            .collect()
    }
}

/// Modes that together meet the tolerance with at most `most_states` states, or come as close as they can.
pub(super) struct Selection {
    /// In ascending order; some of the last may have no state.
    pub modes: Vec<Mode>,
    /// Largest error that is left.
    pub error: f64,
    /// What it does to the mean temperature of the contact: of the mode number m the 1/m^2-th part. Of a flux that jumps a mode has
    /// 1/m, and its temperature changes the mean only by the heat that goes into the other body instead, which is another 1/m.
    pub mean_error: f64,
}

impl Selection {
    pub fn new(across: &Across, depth: &Depth, points: &Points, scale: &Scale, most_states: usize) -> Selection {
        let width = 2.0 * across.half_width;
        let mut modes = vec![Mode::new(across.wave(0), 0, width, depth, scale)];
        modes[0].basis.add_means(points);
        modes[0].judge();
        let mut states = modes[0].states();
        loop {
            // Errors of untouched modes fall with their number, so one of them is enough to compare with.
            if modes.last().is_some_and(|mode| mode.basis.count() > 0) {
                modes.push(Mode::new(across.wave(modes.len()), modes.len(), width, depth, scale));
            }
            let open = || (0..modes.len()).filter(|&m| !modes[m].exhausted);
            // The longest carry the mean: they come first, so that it is right even where the states do not suffice for all.
            let long = open().find(|&m| m < LONGEST && modes[m].error > modes[m].tolerance);
            let worst = long.or_else(|| open().max_by(|&m, &n| modes[m].error.total_cmp(&modes[n].error)));
            let Some(worst) = worst.filter(|&m| modes[m].error > modes[m].tolerance && states < most_states) else {
                break;
            };
            states -= modes[worst].states();
            modes[worst].improve(points);
            states += modes[worst].states();
        }
        let error = modes.iter().map(|mode| mode.error).fold(0.0, maximum);
        let part = |m: usize| 1.0 / (m.max(1) as f64).powi(2);
        let mean_error = modes.iter().enumerate().map(|(m, mode)| mode.error * part(m)).fold(0.0, maximum);
        Selection { modes, error, mean_error }
    }
}
