//! Propagation of the moving source over one step, at a velocity that may change during it.
//!
//! Theory: docs/theory.md, sections 4.3, 5.3.

use super::operators::LumpedOperators;
use super::stage::{POINTS, averages};
use super::stepper::Propagators;
use conduction::flash::{Flash, MAX_FLASH_STATES};
use conduction::properties::Scales;
use numerics::subnormal::flushed;

/// Weights of the moving source for one step size and one course of the speed.
#[derive(Clone, Debug)]
pub(crate) struct FlashStep {
    /// Speeds (m/s) at the start and at the three points, step size (s) and properties of these weights.
    key: ([f64; 4], f64, Scales),
    /// Length of the step in the time of the strip's constants: see [`Scales`].
    length: f64,
    /// The speed is the same at all points.
    steady: bool,
    /// Decay of every state up to the three points.
    pub decay: [Row; 3],
    /// Gain to every state at the end of the step from a constant flux, and from one that rises from 0 to 1 W/m2 during the step.
    update: [Row; 2],
    /// Gain from the stage fluxes to the contact temperature at the three points, K m2/W.
    pub gain: [[f64; 2]; 3],
    /// Decays at rest up to the point 1/3, for the step size of the key.
    at_rest: Row,
    /// Decay rate added by constant sliding, 1/s, and its decay factor up to the point 1/3.
    sliding: f64,
    common: f64,
    /// Sliding rates at the start and at the three points where the speed changes, 1/s.
    rates: [f64; 4],
    /// Reciprocal of the rate under constant sliding times the step size, by state.
    memory: Row,
    /// Estimated relative error of the heating by the flux of the step, where the speed changes.
    unsteadiness: f64,
    /// The weights of the point 2/3 are up to date.
    has_middle: bool,
}

type Row = [f64; MAX_FLASH_STATES];

/// Rate times time below which the difference quotients of the weights suffer from cancellation.
const CANCELLING: f64 = 0.06;

/// Decay factors of a moving source at rest up to the point 1/3 of the step `step` (s).
pub(crate) fn decays_at_rest(flash: &Flash, step: f64) -> Row {
    flash.rates.map(|rate| (-rate * POINTS[0] * step).exp())
}

/// Exponent below which [`recursion`] suffers from cancellation.
const SERIES_BELOW: f64 = 0.1;

/// Integrals of x^n exp(-z x) from 0 to 1 for n = 0 to 3, given `decay` = exp(-z).
#[inline(always)]
fn moments(z: f64, decay: f64) -> [f64; 4] {
    if z >= SERIES_BELOW {
        return recursion(z, decay);
    }
    std::array::from_fn(|n| {
        // Terms (-z)^j/(j! (n + 1 + j)): the ninth is below 1e-13.
        let mut sum = 0.0;
        for j in (0..8).rev() {
            sum = 1.0 / (n + 1 + j) as f64 - z / (j + 1) as f64 * sum;
        }
        sum
    })
}

/// [`moments`] for z > 0.1, by integration by parts.
#[inline(always)]
fn recursion(z: f64, decay: f64) -> [f64; 4] {
    let inverse = 1.0 / z;
    let m0 = (1.0 - decay) * inverse;
    let m1 = (m0 - decay) * inverse;
    let m2 = (2.0 * m1 - decay) * inverse;
    [m0, m1, m2, (3.0 * m2 - decay) * inverse]
}

/// Sum over the states, in an order that does not depend on the machine.
#[inline(always)]
fn total(values: &Row) -> f64 {
    let pair = |k: usize| values[k] + values[k + 4];
    (pair(0) + pair(1)) + (pair(2) + pair(3))
}

impl FlashStep {
    /// Placeholder weights, set by the first [`FlashStep::prepare`].
    pub(crate) fn empty() -> FlashStep {
        const NONE: Row = [0.0; MAX_FLASH_STATES];
        FlashStep {
            key: ([f64::NAN; 4], f64::NAN, Scales::ONE),
            length: f64::NAN,
            steady: false,
            decay: [NONE; 3],
            update: [NONE; 2],
            gain: [[0.0; 2]; 3],
            at_rest: NONE,
            sliding: 0.0,
            rates: [0.0; 4],
            memory: NONE,
            common: 1.0,
            unsteadiness: 0.0,
            has_middle: false,
        }
    }

    /// Computes the weights for `speeds` (m/s) at the start and at the three points of the step `step` (s), with the decays
    /// at rest of [`decays_at_rest`] and the properties of `propagators`. They are a function of these alone, so that a replay gives the
    /// same bits.
    pub(crate) fn prepare(&mut self, operators: &LumpedOperators, propagators: &Propagators<'_>, speeds: [f64; 4]) {
        let [speed, ..] = speeds;
        if speeds == [speed; 4] {
            return self.prepare_steady(operators, propagators, speed);
        }
        let Some(flash) = &operators.flash else { return };
        let key = (speeds, propagators.step, propagators.scales);
        if self.key == key {
            return;
        }
        self.begin(propagators, key);
        self.steady = false;
        // In the time of the constants the contact slides faster by as much as that runs slower.
        self.rates = speeds.map(|speed| flash.sliding_rate(speed / key.2.pace));
        self.varying(flash, 0);
        self.varying(flash, 2);
    }

    /// [`FlashStep::prepare`] at the constant speed `speed` (m/s).
    #[inline(always)]
    pub(crate) fn prepare_steady(&mut self, operators: &LumpedOperators, propagators: &Propagators<'_>, speed: f64) {
        let Some(flash) = &operators.flash else { return };
        let key = ([speed; 4], propagators.step, propagators.scales);
        if self.steady && self.key.0[0] == speed && self.key.1 == key.1 && self.key.2 == key.2 {
            return;
        }
        self.begin(propagators, key);
        let step = self.length;
        self.steady = true;
        self.sliding = flash.sliding_rate(speed / key.2.pace);
        self.rates = [self.sliding; 4];
        self.common = (-self.sliding * POINTS[0] * step).exp();
        let (rates, sliding, mut memory) = (flash.rates, self.sliding, [0.0; MAX_FLASH_STATES]);
        for k in 0..MAX_FLASH_STATES {
            memory[k] = 1.0 / ((rates[k] + sliding) * step);
        }
        self.memory = memory;
        self.constant::<0>(flash);
        self.constant::<2>(flash);
    }

    #[inline(always)]
    fn begin(&mut self, propagators: &Propagators<'_>, key: ([f64; 4], f64, Scales)) {
        if self.key.1 != key.1 || self.key.2 != key.2 {
            self.at_rest = *propagators.at_rest;
            self.length = key.1 * key.2.pace;
        }
        self.key = key;
        self.has_middle = false;
    }

    /// Computes the weights of the point 2/3, which are for the error estimate only.
    #[inline(always)]
    pub(crate) fn prepare_middle(&mut self, operators: &LumpedOperators) {
        if let Some(flash) = &operators.flash
            && !self.has_middle
        {
            if self.steady {
                self.constant::<1>(flash);
            } else {
                self.varying(flash, 1);
            }
            self.has_middle = true;
        }
    }

    /// Weights of a point, an index of [`POINTS`], at constant speed: the decay to the points 2/3 and 1 is that to 1/3
    /// squared and cubed.
    #[inline(always)]
    fn constant<const POINT: usize>(&mut self, flash: &Flash) {
        let length = POINTS[POINT] * self.length;
        let (at_rest, common) = (self.at_rest, self.common);
        let mut decay = [0.0; MAX_FLASH_STATES];
        for k in 0..MAX_FLASH_STATES {
            let third = at_rest[k] * common;
            decay[k] = match POINT {
                0 => third,
                1 => third * third,
                _ => third * third * third,
            };
        }
        let (mut flat, mut ramp) = ([0.0; MAX_FLASH_STATES], [0.0; MAX_FLASH_STATES]);
        if self.sliding * length < CANCELLING {
            for k in 0..MAX_FLASH_STATES {
                let averages = averages((flash.rates[k] + self.sliding) * length, decay[k]);
                let residue = flash.residues[k] * length;
                (flat[k], ramp[k]) = (residue * averages.0, residue * POINTS[POINT] * averages.1);
            }
        } else {
            // Without branches, in local arrays: vectorised over the states.
            let inverse = 1.0 / POINTS[POINT];
            let (memory, residues) = (self.memory, flash.residues);
            for k in 0..MAX_FLASH_STATES {
                let residue = residues[k] * length;
                let average = (1.0 - decay[k]) * (inverse * memory[k]);
                flat[k] = residue * average;
                ramp[k] = residue * ((1.0 - average) * memory[k]);
            }
        }
        self.keep(POINT, decay, flat, ramp);
    }

    /// Stores the weights of a point: decays, and gains from a constant flux and from one that rises from 0 at the start to 1 at
    /// the end of the step.
    #[inline(always)]
    fn keep(&mut self, point: usize, decay: Row, flat: Row, ramp: Row) {
        let (flat, ramp) = (flat.map(|flat| flat * self.key.2.flux), ramp.map(|ramp| ramp * self.key.2.flux));
        let (all_flat, all_ramp) = (total(&flat), total(&ramp));
        self.decay[point] = decay;
        // L_1 = 3/2 - 3/2 x, L_2 = 3/2 x - 1/2
        self.gain[point] = [1.5 * (all_flat - all_ramp), 1.5 * all_ramp - 0.5 * all_flat];
        if point == 2 {
            self.update = [flat, ramp];
        }
    }

    /// Error of the temperature at the point 2/3 from a sliding rate that changes during the step, under the stage fluxes `flux`
    /// into the strip, in units of the tolerance of the largest rise so far. Requires the weights of that point.
    #[inline]
    pub(crate) fn error(&self, flux: [f64; 2], tolerance: f64, peak_rise: f64) -> f64 {
        if self.steady {
            return 0.0;
        }
        let heated = (self.gain[1][0] * flux[0] + self.gain[1][1] * flux[1]).abs();
        self.unsteadiness * heated / (tolerance * (1e-3 + peak_rise.max(heated)))
    }

    fn varying(&mut self, flash: &Flash, point: usize) {
        let step = self.length;
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
        // The response to a flux at the time tau before the point decays as exp(-r tau + slope tau^2/2) = exp(-r tau) (1 + slope
        // tau^2/2 + ...), r and slope those at the point.
        let (sliding, slope) = (rates[point + 1], (rates[point + 1] - rates[point]) * (3.0 / step));
        let bend = 0.5 * slope * length * length;
        let (common, local) = ((-passed[point].max(0.0)).exp(), (-sliding * length).exp());
        let (mut flat, mut ramp) = ([0.0; MAX_FLASH_STATES], [0.0; MAX_FLASH_STATES]);
        let (mut sums, residues) = ([[0.0; MAX_FLASH_STATES]; 4], flash.residues);
        if (flash.rates[0] + sliding) * length < SERIES_BELOW {
            for k in 0..MAX_FLASH_STATES {
                let all = moments((flash.rates[k] + sliding) * length, at_rest[k] * local);
                for n in 0..4 {
                    sums[n][k] = all[n];
                }
            }
        } else {
            // Without branches: vectorised over the states.
            let [m0, m1, m2, m3] = &mut sums;
            for k in 0..MAX_FLASH_STATES {
                [m0[k], m1[k], m2[k], m3[k]] = recursion((flash.rates[k] + sliding) * length, at_rest[k] * local);
            }
        }
        let [m0, m1, m2, m3] = sums;
        for k in 0..MAX_FLASH_STATES {
            let residue = residues[k] * length;
            flat[k] = residue * (m0[k] + bend * m2[k]);
            ramp[k] = residue * POINTS[point] * ((m0[k] - m1[k]) + bend * (m2[k] - m3[k]));
        }
        if point == 2 {
            // The slowest state is the most sensitive. The series above is truncated after its first term, and the slope is that
            // between two points.
            let (first, second) = (r3 - r2, r3 - 2.0 * r2 + r1);
            let curvature = (bend * m2[0] / m0[0]).abs();
            let bent = if first == 0.0 { 0.0 } else { (second / first).abs() };
            self.unsteadiness = curvature * (3.0 * curvature + 0.5 * bent);
        }
        self.keep(point, at_rest.map(|decay| decay * common), flat, ramp);
    }

    /// Free response of the initial states at `point`, K.
    #[inline(always)]
    pub(crate) fn homogeneous(&self, point: usize, states: &Row) -> f64 {
        let (decay, mut left) = (self.decay[point], *states);
        for k in 0..MAX_FLASH_STATES {
            left[k] *= decay[k];
        }
        total(&left)
    }

    /// States at the end of the step under the stage fluxes `flux` into the strip.
    #[inline(always)]
    pub(crate) fn advanced(&self, states: &Row, flux: [f64; 2]) -> Row {
        let (start, rise) = (1.5 * flux[0] - 0.5 * flux[1], 1.5 * (flux[1] - flux[0]));
        let ([flat, ramp], decay, mut new) = (self.update, self.decay[2], *states);
        for k in 0..MAX_FLASH_STATES {
            new[k] = flushed(decay[k] * new[k] + flat[k] * start + ramp[k] * rise);
        }
        new
    }
}

#[cfg(test)]
mod tests {
    use super::super::operators::LumpedOperators;
    use super::super::stage::weights;
    use super::*;
    use scene::Scene;
    use scene::variables::STARTS;

    #[test]
    fn a_steady_speed_gives_the_weights_of_its_rates() {
        let operators = LumpedOperators::new(&Scene::new(&STARTS, None).unwrap());
        let flash = operators.flash.as_ref().unwrap();
        for step in [1e-5, 1e-3, 0.1, 20.0] {
            let at_rest = decays_at_rest(flash, step);
            let at_rest = Propagators { step, punch: None, strip: None, at_rest: &at_rest, scales: Scales::ONE };
            for speed in [0.0, 1e-6, 1e-3, 0.1, 4.0, 90.0] {
                let mut made = FlashStep::empty();
                made.prepare(&operators, &at_rest, [speed; 4]);
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
                            let [flat, ramp] = made.update.map(|row| row[k]);
                            let update = [1.5 * (flat - ramp), 1.5 * ramp - 0.5 * flat][stage];
                            assert!(
                                point != 2 || (update - weight[stage]).abs() <= 1e-11 * size,
                                "{step} {speed} {k} {stage}"
                            );
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

    #[test]
    fn a_changing_speed_is_followed_within_the_estimate() {
        let operators = LumpedOperators::new(&Scene::new(&STARTS, None).unwrap());
        let flash = operators.flash.as_ref().unwrap();
        for step in [1e-3, 0.01, 0.1] {
            let at_rest = decays_at_rest(flash, step);
            let at_rest = Propagators { step, punch: None, strip: None, at_rest: &at_rest, scales: Scales::ONE };
            for [first, last] in [[10.0, 10.5], [10.5, 10.0], [2.0, 2.1], [0.2, 0.19], [3.0, 2.0], [1.0, 2.0]] {
                let speed = |x: f64| first + (last - first) * x;
                let mut made = FlashStep::empty();
                made.prepare(&operators, &at_rest, [0.0, POINTS[0], POINTS[1], 1.0].map(speed));
                made.prepare_middle(&operators);
                let flux = [1e5, 1.2e5];
                // Many short steps, each at the speed and the flux of its midpoint.
                let parts = 4000;
                let mut states = [0.01; MAX_FLASH_STATES];
                let mut followed = states;
                for part in 0..parts {
                    let x = (f64::from(part) + 0.5) / f64::from(parts);
                    let (sliding, length) = (flash.sliding_rate(speed(x)), step / f64::from(parts));
                    let now = flux[0] * 1.5 * (1.0 - x) + flux[1] * 0.5 * (3.0 * x - 1.0);
                    for k in 0..MAX_FLASH_STATES {
                        let decay = (-(flash.rates[k] + sliding) * length).exp();
                        let driven = averages((flash.rates[k] + sliding) * length, decay).0 * length;
                        states[k] = states[k] * decay + flash.residues[k] * driven * now;
                    }
                }
                followed = made.advanced(&followed, flux);
                let (exact, computed) = (total(&states), total(&followed));
                let error = (computed / exact - 1.0).abs();
                assert!(error < 1e-5 + made.unsteadiness, "{step} {first} {last}: {error:e} {:e}", made.unsteadiness);
                let change = (last / first - 1.0).abs();
                assert!(error < 1e-5 + 0.5 * change * change, "{step} {first} {last}: {error:e}");
            }
        }
    }
}
