//! Greedy shift selection: transverse modes with states, and the rational Krylov shifts of each.
//!
//! The impedance of the contact is diagonal in the transverse modes, `q = X_m q_m` gives `T = X_m z_m(s) q_m`, and so is the
//! reduced one. The largest error of the temperature in the root mean square over the contact, for any flux whose mean
//! square and that of `width/(8 pi)` times its slope sum to 1, is therefore
//!
//! ```text
//! max over m and frequencies of |z_m - z_m,reduced| / sqrt(1 + [xi_m width/(8 pi)]^2)
//! ```
//!
//! so that the norm of the operator from such fluxes to temperatures needs no matrix. Modes down to an eighth of the contact count
//! alike: a light contact shrinks to patches. It is relative to the impedance to a
//! uniform flux at 1/duration, the temperature rise over the whole duration. The mode with the largest error gets one more
//! response at a real rate (rational Krylov shift) until the tolerance is met.
//!
//! Theory: docs/theory.md, sections 4.6, 4.12.

use super::across::{Across, Sides, Wave};
use super::bands::Spread;
use super::depth::Depth;
use super::galerkin::Basis;
use crate::slab::principal_root;
use crate::trial_functions::Points;
use nalgebra::Complex;
use numerics::maximum::maximum;
use scene::FarBoundary;
use std::f64::consts::PI;

/// Number of frequencies of the error sweep, per mode.
const FREQUENCIES: usize = 64;

/// Number of modes that get their states before all others: the uniform one, tilt and curvature.
const LONGEST: usize = 3;

/// Half-waves across the contact up to which a flux may be as large as a uniform one.
const PATCHES: f64 = 8.0;

/// Lowest frequency that counts in full over 1/duration: the spectrum of a constant flux lies below its own frequency.
const SLOWEST: f64 = 0.03;

/// Lowest frequency of the error sweep over that: what is slower counts in proportion to its frequency. Without slower shifts the error
/// at the lowest frequency falls by less than a tenth per state, where the body itself is slower still.
const SLOWER: f64 = 0.01;

/// One transverse mode with its current trial functions.
#[derive(Clone, Debug)]
pub(super) struct Mode {
    pub wave: Wave,
    pub basis: Basis,
    /// A uniform temperature has so much heat in this mode that it is a trial function: see [`super::bands`].
    has_own_uniform: bool,
    /// The fastest shape is quasi-static and has no state.
    pub fastest_is_steady: bool,
    /// Error over the scale and the weight of the mode.
    pub error: f64,
    /// Tolerance of `error`.
    tolerance: f64,
    /// Heat can leave, so a steady response exists; it is the last of the frequencies, 0.
    steady: bool,
    frequency: Vec<f64>,
    /// Part of an error of the impedance that counts, over scale and weight.
    share: Vec<f64>,
    /// Exact impedance.
    exact: Vec<Complex<f64>>,
    used: Vec<bool>,
    exhausted: bool,
}

/// Reference of the errors.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scale {
    /// Impedance to a uniform flux at 1/duration, K m2/W.
    pub impedance: f64,
    /// Time over which temperatures are of interest, s.
    pub duration: f64,
    pub tolerance: f64,
    /// Tolerance ratio of the longest modes.
    mean: f64,
}

impl Scale {
    /// Scale for a tolerance of every mode and one of the longest modes.
    pub(crate) fn new(across: &Across, depth: &Depth, duration: f64, [tolerance, of_the_mean]: [f64; 2]) -> Scale {
        let kappa = kappa(depth, across.wave(0).decay, 1.0 / duration);
        let mean = match across.sides {
            // Tolerance ratio of the longest modes of a ring: as accurate as the uniform one, which is the only one there, at the lumped
            // level.
            Sides::Radial(_) => 0.1_f64,
            Sides::Free | Sides::Closed => 1.0,
        };
        let mean = mean.min(of_the_mean / tolerance);
        Scale { impedance: depth.impedance(kappa).norm(), duration, tolerance, mean }
    }

    /// Tolerance of the mode number `m`.
    fn of_mode(&self, m: usize) -> f64 {
        if m < LONGEST { self.mean * self.tolerance } else { self.tolerance }
    }

    /// Decay beyond which even the impedance to a uniform flux is below the tolerance, 1/m.
    pub(crate) fn steepest(&self, depth: &Depth) -> f64 {
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
        let weight = 1.0f64.hypot(wave.wave_number * width / (PATCHES * PI));
        let slowest = SLOWEST / scale.duration;
        // Above this frequency the mode's impedance is below the tolerance.
        let steepest = scale.steepest_of(depth, tolerance) / weight;
        let fastest = (depth.diffusivity() * steepest * steepest).max(3.0 / scale.duration);
        let own = depth.diffusivity() * (wave.decay.powi(2) + depth.height.powi(-2));
        let lowest = (SLOWER * slowest).max(own).min(slowest);
        let ratio = (fastest / lowest).powf(1.0 / (FREQUENCIES - 1) as f64);
        let mut frequency: Vec<f64> = (0..FREQUENCIES).map(|i| lowest * ratio.powi(i as i32)).collect();
        let whole = 1.0 / (weight * scale.impedance);
        let mut share: Vec<f64> = frequency.iter().map(|f| whole * (f / slowest).min(1.0)).collect();
        let mut exact: Vec<Complex<f64>> =
            frequency.iter().map(|&f| depth.impedance(kappa(depth, wave.decay, f))).collect();
        let steady = depth.has_steady_state(wave.decay);
        if steady {
            frequency.push(0.0);
            share.push(whole);
            exact.push(Complex::from(depth.steady_impedance(wave.decay)));
        }
        let used = vec![false; frequency.len()];
        let basis = Basis::new(*depth, wave.decay);
        let mut mode = Mode {
            wave,
            basis,
            has_own_uniform: false,
            fastest_is_steady: false,
            error: f64::INFINITY,
            tolerance,
            steady,
            frequency,
            share,
            exact,
            used,
            exhausted: false,
        };
        mode.judge();
        mode
    }

    /// Number of states, but for a uniform temperature that the heat of the body needs and not its contact.
    pub(crate) fn states(&self) -> usize {
        let own = self.has_own_uniform && self.basis.has_uniform();
        self.basis.count() - usize::from(self.fastest_is_steady) - usize::from(own)
    }

    /// Adds a trial function: the steady response first, so that steady states are exact, then the response at the rate of
    /// the largest error.
    fn improve(&mut self, points: &Points) {
        let last = self.frequency.len() - 1;
        if self.has_own_uniform && self.basis.count() == 0 {
            self.basis.add_uniform(points);
        }
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

    /// Computes the error, and decides whether the fastest shape can be quasi-static.
    fn judge(&mut self) {
        let largest = |errors: Vec<f64>| errors.into_iter().fold(0.0, maximum);
        self.fastest_is_steady = false;
        self.error = largest(self.errors(false));
        let uniform_alone = self.basis.count() == 1 && (self.has_own_uniform || !self.steady);
        if self.basis.count() > 0 && !uniform_alone {
            let error = largest(self.errors(true));
            if error <= self.tolerance {
                self.fastest_is_steady = true;
                self.error = error;
            }
        }
    }

    /// Errors over scale and weight at every frequency, with the fastest shape as a state or quasi-static.
    fn errors(&self, fastest_is_steady: bool) -> Vec<f64> {
        let residues: Vec<(f64, f64)> = self.basis.residues().map(|(rate, z)| (rate, z * z)).collect();
        if residues.is_empty() {
            // The whole mode is quasi-static, where it has a steady state.
            let steady = if self.steady { self.exact[FREQUENCIES] } else { Complex::from(0.0) };
            let parts = self.exact.iter().zip(&self.share);
            return parts.map(|(exact, share)| share * (exact - steady).norm_sqr().sqrt()).collect();
        }
        let states = residues.len() - usize::from(fastest_is_steady);
        let direct: f64 = residues[states..].iter().map(|(rate, residue)| residue / rate).sum();
        (self.frequency.iter().zip(self.exact.iter().zip(&self.share)))
            .map(|(&frequency, (exact, share))| {
                let (mut real, mut imaginary) = (direct, 0.0);
                for &(rate, residue) in &residues[..states] {
                    let part = residue / (rate * rate + frequency * frequency);
                    real += part * rate;
                    imaginary -= part * frequency;
                }
                share * (exact - Complex::new(real, imaginary)).norm_sqr().sqrt()
            })
            .collect()
    }
}

/// Modes that together meet the tolerance with at most `most_states` states, or as nearly as these allow.
pub(super) struct Selection {
    pub tolerance: f64,
    /// Modes in ascending order; some of the last may have no state.
    pub modes: Vec<Mode>,
    /// Largest remaining error.
    pub error: f64,
    /// Its effect on the mean temperature of the contact: for the mode number m a fraction of 1/m^2. A discontinuous flux
    /// has a component of 1/m in a mode, and the temperature of the mode affects the mean only by the heat it diverts into
    /// the other body, another 1/m.
    pub mean_error: f64,
}

impl Selection {
    pub(crate) fn new(across: &Across, depth: &Depth, points: &Points, scale: &Scale, most_states: usize) -> Selection {
        let width = 2.0 * across.half_width;
        let mode = |m: usize| {
            // Alone it would be a band: without the next mode of its parity.
            let both = [m, m + 2].map(|m| across.wave(m)).iter().fold(Spread::default(), |both, wave| {
                both.and(wave.integral * wave.integral / width, wave.decay * wave.decay)
            });
            let own = m > 0 && depth.top == FarBoundary::Insulated && !both.is_one(scale.tolerance);
            Mode { has_own_uniform: own, ..Mode::new(across.wave(m), m, width, depth, scale) }
        };
        let mut modes = vec![mode(0)];
        modes[0].basis.add_means(points);
        modes[0].judge();
        let mut states = modes[0].states();
        loop {
            // Errors of modes without states fall with their number, so one of them suffices for the comparison.
            if modes.last().is_some_and(|mode| mode.basis.count() > 0) {
                modes.push(mode(modes.len()));
            }
            let open = || (0..modes.len()).filter(|&m| !modes[m].exhausted);
            // The longest carry the mean: they come first, so that it is accurate even where the states do not suffice for all.
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
        Selection { tolerance: scale.tolerance, modes, error, mean_error }
    }
}

#[cfg(test)]
mod tests {
    use super::super::galerkin::points;
    use super::*;

    #[test]
    fn a_body_slow_against_the_duration_takes_a_few_states_for_each_decade() {
        let depth = Depth {
            height: 0.1,
            conductivity: 55.0,
            capacity: 3.6e6,
            top: FarBoundary::Insulated,
            face: 0.0,
            driven_top: false,
        };
        let across = Across { half_width: 0.03, sides: Sides::Free, cooled: 0.0, transfer: 0.0, conductivity: 55.0 };
        // The body takes 650 s to warm through.
        let scale = Scale::new(&across, &depth, 0.04, [2e-5; 2]);
        let selection = Selection::new(&across, &depth, &points(0.1, scale.steepest(&depth), &[]), &scale, 150);
        for mode in &selection.modes[..LONGEST] {
            assert!(mode.error <= 2e-5 && mode.states() <= 36, "{} states, error {:.1e}", mode.states(), mode.error);
        }
    }
}
