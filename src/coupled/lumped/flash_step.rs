//! The moving source over one step, at a velocity that may change during it.

use super::operators::Operators;
use super::stage::{POINTS, weights};
use crate::heat::flash::{Flash, MAX_FLASH_STATES};

/// Weights of the moving source for one step size and one course of the speed.
#[derive(Clone, Debug)]
pub struct FlashStep {
    /// The speeds (m/s) at the start and at the three points, and the step size (s) they hold for.
    key: ([f64; 4], f64),
    /// Decay of every state up to the three points.
    pub decay: [[f64; MAX_FLASH_STATES]; 3],
    /// Gain from the stage fluxes to every state.
    pub update: [[f64; MAX_FLASH_STATES]; 2],
    /// Gain from the stage fluxes to the contact temperature at the three points, K m2/W.
    pub gain: [[f64; 2]; 3],
    /// Decays at rest up to the point 1/3, for the step size of the key.
    at_rest: [f64; MAX_FLASH_STATES],
    /// Rate that constant sliding adds, 1/s, and its decay up to the point 1/3.
    sliding: f64,
    common: f64,
    /// Sliding rates at the start and at the three points where the speed changes, 1/s.
    rates: [f64; 4],
    /// Reciprocal of the rate under constant sliding times the step size, by state.
    memory: [f64; MAX_FLASH_STATES],
    /// Whether the weights of the point 2/3 are made as well.
    has_middle: bool,
}

/// Rate times time below which the difference quotients of the weights lose digits.
const CANCELLING: f64 = 0.06;

/// Decays of a moving source at rest up to the point 1/3 of the step `step` (s).
pub fn decays_at_rest(flash: &Flash, step: f64) -> [f64; MAX_FLASH_STATES] {
    flash.rates.map(|rate| (-rate * POINTS[0] * step).exp())
}

/// Sum over the states, in an order that is the same everywhere.
#[inline]
fn total(values: &[f64; MAX_FLASH_STATES]) -> f64 {
    let pair = |k: usize| values[k] + values[k + 4];
    (pair(0) + pair(1)) + (pair(2) + pair(3))
}

impl FlashStep {
    /// Weights for no step at all; the first [`FlashStep::prepare`] fills them.
    pub fn empty() -> FlashStep {
        FlashStep {
            key: ([f64::NAN; 4], f64::NAN),
            decay: [[0.0; MAX_FLASH_STATES]; 3],
            update: [[0.0; MAX_FLASH_STATES]; 2],
            gain: [[0.0; 2]; 3],
            at_rest: [0.0; MAX_FLASH_STATES],
            sliding: 0.0,
            rates: [0.0; 4],
            memory: [0.0; MAX_FLASH_STATES],
            common: 1.0,
            has_middle: false,
        }
    }

    /// Makes the weights those for `speeds` (m/s) at the start and at the three points of the step
    /// `step` (s), with the decays `at_rest` of [`decays_at_rest`]. A function of these alone, so that a replay gives the same bits.
    pub fn prepare(&mut self, operators: &Operators, at_rest: &[f64; MAX_FLASH_STATES], speeds: [f64; 4], step: f64) {
        let Some(flash) = &operators.flash else { return };
        if self.key == (speeds, step) {
            return;
        }
        if self.key.1 != step {
            self.at_rest = *at_rest;
        }
        self.key = (speeds, step);
        self.gain = [[0.0; 2]; 3];
        self.has_middle = false;
        self.make::<0>(flash);
        self.make::<2>(flash);
    }

    /// Makes the weights of the point 2/3, which only the error estimate needs.
    pub fn prepare_middle(&mut self, operators: &Operators) {
        if let Some(flash) = &operators.flash
            && !self.has_middle
        {
            self.make::<1>(flash);
            self.has_middle = true;
        }
    }

    /// Weights of a point, an index of [`POINTS`].
    #[inline]
    fn make<const POINT: usize>(&mut self, flash: &Flash) {
        let (speeds, step) = self.key;
        if speeds[1] == speeds[0] && speeds[2] == speeds[0] && speeds[3] == speeds[0] {
            self.steady::<POINT>(flash, speeds[0], step);
        } else {
            self.varying(flash, speeds, step, POINT);
        }
    }

    /// Constant speed: the decay to the points 2/3 and 1 is that to 1/3 squared and cubed.
    #[inline]
    fn steady<const POINT: usize>(&mut self, flash: &Flash, speed: f64, step: f64) {
        if POINT == 0 {
            self.sliding = flash.sliding_rate(speed);
            self.rates = [self.sliding; 4];
            self.common = (-self.sliding * POINTS[0] * step).exp();
            self.memory = flash.rates.map(|rate| 1.0 / ((rate + self.sliding) * step));
        }
        let length = POINTS[POINT] * step;
        let third = self.at_rest.map(|decay| decay * self.common);
        let decay = match POINT {
            0 => third,
            1 => third.map(|third| third * third),
            _ => third.map(|third| third * third * third),
        };
        let mut first = [0.0; MAX_FLASH_STATES];
        let mut second = [0.0; MAX_FLASH_STATES];
        if self.sliding * length < CANCELLING {
            for k in 0..MAX_FLASH_STATES {
                let weight = weights(flash.rates[k] + self.sliding, decay[k], POINTS[POINT], length);
                first[k] = flash.residues[k] * weight[0];
                second[k] = flash.residues[k] * weight[1];
            }
        } else {
            // Without a branch inside and in numbers of its own: several states at a time.
            let (c, inverse) = (POINTS[POINT], 1.0 / POINTS[POINT]);
            let (memory, residues) = (self.memory, flash.residues);
            for k in 0..MAX_FLASH_STATES {
                let memory = memory[k] * inverse;
                let flat = (1.0 - decay[k]) * memory;
                let ramp = c * (1.0 - flat) * memory;
                let residue = residues[k] * length;
                first[k] = residue * (1.5 * (flat - ramp));
                second[k] = residue * (1.5 * ramp - 0.5 * flat);
            }
        }
        self.decay[POINT] = decay;
        self.gain[POINT] = [total(&first), total(&second)];
        if POINT == 2 {
            self.update = [first, second];
        }
    }

    /// Relative error of the moving source's temperature from a sliding rate that changes during the step:
    /// its relative change, where memory and change meet (sigma h near 1); states that forget at once or
    /// not at all do not mind.
    pub fn unsteadiness(&self) -> f64 {
        let (first, last, step) = (self.rates[0], self.rates[3], self.key.1);
        let sum = first + last;
        if sum == 0.0 {
            return 0.0;
        }
        let memory = 0.5 * sum * step;
        0.25 * (last - first).abs() / sum * memory.min(1.0 / memory)
    }

    fn varying(&mut self, flash: &Flash, speeds: [f64; 4], step: f64, point: usize) {
        if point == 0 {
            self.rates = speeds.map(|speed| flash.sliding_rate(speed));
        }
        let rates = self.rates;
        let [r0, r1, r2, r3] = rates;
        // Integral of sigma from the start to every point, exact for a rate cubic in time.
        let passed = [
            step * (9.0 * r0 + 19.0 * r1 - 5.0 * r2 + r3) / 72.0,
            step * (r0 + 4.0 * r1 + r2) / 9.0,
            step * (r0 + 3.0 * r1 + 3.0 * r2 + r3) / 8.0,
        ];
        let length = POINTS[point] * step;
        let at_rest = match point {
            0 => self.at_rest,
            1 => self.at_rest.map(|third| third * third),
            _ => self.at_rest.map(|third| third * third * third),
        };
        // Fast states follow the speed of the moment, so it is theirs that weighs the flux.
        let sliding = rates[point + 1];
        let (common, local) = ((-passed[point].max(0.0)).exp(), (-sliding * length).exp());
        let mut first = [0.0; MAX_FLASH_STATES];
        let mut second = [0.0; MAX_FLASH_STATES];
        for k in 0..MAX_FLASH_STATES {
            self.decay[point][k] = at_rest[k] * common;
            let weight = weights(flash.rates[k] + sliding, at_rest[k] * local, POINTS[point], length);
            first[k] = flash.residues[k] * weight[0];
            second[k] = flash.residues[k] * weight[1];
        }
        self.gain[point] = [total(&first), total(&second)];
        if point == 2 {
            self.update = [first, second];
        }
    }

    /// What the initial states leave at `point`, K.
    #[inline]
    pub fn homogeneous(&self, point: usize, states: &[f64; MAX_FLASH_STATES]) -> f64 {
        total(&std::array::from_fn(|k| self.decay[point][k] * states[k]))
    }

    /// Carries the states over the step under the stage fluxes `flux` into the strip.
    #[inline]
    pub fn advance(&self, states: &mut [f64; MAX_FLASH_STATES], flux: [f64; 2]) {
        for k in 0..MAX_FLASH_STATES {
            states[k] = self.decay[2][k] * states[k] + self.update[0][k] * flux[0] + self.update[1][k] * flux[1];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::operators::Operators;
    use super::*;
    use crate::scene::Scene;
    use crate::variables::STARTS;

    #[test]
    fn a_steady_speed_gives_the_weights_of_its_rates() {
        let operators = Operators::new(&Scene::new(&STARTS, None).unwrap());
        let flash = operators.flash.as_ref().unwrap();
        for step in [1e-5, 1e-3, 0.1, 20.0] {
            let at_rest = decays_at_rest(flash, step);
            for speed in [0.0, 1e-6, 1e-3, 0.1, 4.0, 90.0] {
                let mut made = FlashStep::empty();
                made.prepare(&operators, &at_rest, [speed; 4], step);
                made.prepare_middle(&operators);
                let sliding = flash.sliding_rate(speed);
                for (point, c) in POINTS.into_iter().enumerate() {
                    let mut gain = [0.0; 2];
                    for (k, (rate, residue)) in flash.rates.iter().zip(&flash.residues).enumerate() {
                        let decay = (-(rate + sliding) * c * step).exp();
                        assert!((made.decay[point][k] - decay).abs() < 1e-13, "{step} {speed} {point} {k}");
                        let weight = weights(rate + sliding, decay, c, c * step).map(|weight| residue * weight);
                        for stage in 0..2 {
                            gain[stage] += weight[stage];
                            let size = weight[0].abs() + weight[1].abs();
                            let close = |value: f64| (value - weight[stage]).abs() <= 1e-11 * size;
                            assert!(point != 2 || close(made.update[stage][k]), "{step} {speed} {k} {stage}");
                        }
                    }
                    for stage in 0..2 {
                        let error = (made.gain[point][stage] - gain[stage]).abs();
                        assert!(error <= 1e-11 * (gain[0].abs() + gain[1].abs()), "{step} {speed} {point} {stage}");
                    }
                }
            }
        }
    }
}
