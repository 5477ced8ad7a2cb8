//! The weights of [`PhaseRate::weights`](super::PhaseRate::weights) for the states of many modes, vectorised over the modes.
//!
//! For a phase rotation of a radian or more the recurrence of the parent module may run upwards from its closed forms
//!
//! ```text
//! T_0 = (e^z - 1)/z,    T_1 = [e^z (z - 2) + z + 2]/z^3,    T_(m+1) = [T_(m-1) - 2 (2m+1) T_m]/z^2
//! ```
//!
//! whatever |z|: the cancellation error of T_(m+1), `2 (2m+1)/|z|^2` times that of T_m, enters with another factor eta,
//! and `2 (2m+1) eta/|z|^2 <= 2 (2m+1) eps/theta` with the rotation theta = |Im z| and `eps = |v1 - v0|/|v0 + v1|`. All
//! lanes therefore use the same formula. Modes with a drift that counts and less rotation, or a large drift, are evaluated by the
//! scalar form. No multiply-add is fused, so every machine gives the same bits.
//!
//! Theory: docs/theory.md, section 5.3.

use super::{FALLING, LARGEST_DRIFT, LEAST_DRIFT, NEAR, PhaseRate, terms};
use nalgebra::Complex;
use pulp::{Arch, Simd, WithSimd};
use std::ops::Range;

/// Modes per vector.
const MODE_LANES: usize = 8;

/// Phase rotation of all modes over an interval.
#[derive(Clone, Copy)]
pub(crate) struct PhaseRotation<'a> {
    /// Velocities at its ends, m/s, and its length, s.
    pub velocity: [f64; 2],
    pub step: f64,
    /// Wave numbers q, 1/m, in ascending order, and the phase factor of each mode, real and imaginary parts.
    pub numbers: &'a [f64],
    pub phases: [&'a [f64]; 2],
}

/// One value per lane.
type Lanes = [f64; MODE_LANES];

#[inline(always)]
fn each(value: impl Fn(usize) -> f64) -> Lanes {
    std::array::from_fn(value)
}

/// Product of complex numbers.
#[inline(always)]
fn product([a, b]: [Lanes; 2], [c, d]: [Lanes; 2]) -> [Lanes; 2] {
    [each(|l| a[l] * c[l] - b[l] * d[l]), each(|l| a[l] * d[l] + b[l] * c[l])]
}

impl PhaseRotation<'_> {
    /// Weights (s) in the states of one level, for the first of the modes, of a flux falling from 1 to 0 and of one
    /// rising from 0 to 1: real and imaginary parts of both alternate. `rates` and `decays` belong to the states.
    pub(crate) fn weights(&self, rates: &[f64], decays: &[f64], weights: [&mut [f64]; 4]) {
        let count = rates.len();
        let [from, to] = self.velocity;
        let (turn, drift) = (0.5 * self.step * (from + to).abs(), 0.125 * self.step * (to - from).abs());
        // Least phase rotation (rad) for the upward recurrence: each of up to twelve terms at most doubles the error of the one before.
        let least = f64::max(1.0, 25.0 * (to - from).abs() / (from + to).abs());
        let numbers = &self.numbers[..count];
        let constant = numbers.partition_point(|number| number * drift < LEAST_DRIFT);
        let begin = constant.max(numbers.partition_point(|number| number * turn < least));
        let end = begin.max(numbers.partition_point(|number| number * drift <= LARGEST_DRIFT));
        // The scalar form also serves fewer modes than lanes.
        let enough = |range: Range<usize>| if range.len() < MODE_LANES { range.start..range.start } else { range };
        let (constant, turning) = (enough(0..constant), enough(begin..end));
        let [a, b, c, d] = weights;
        Arch::new().dispatch(Abreast {
            rotation: self,
            constant: constant.clone(),
            turning: turning.clone(),
            states: [rates, decays],
            weights: [&mut *a, &mut *b, &mut *c, &mut *d],
        });
        for w in (constant.end..turning.start).chain(turning.end..count) {
            let motion = PhaseRate { turning: self.velocity.map(|v| numbers[w] * v), step: self.step };
            let phase = Complex::new(self.phases[0][w], self.phases[1][w]);
            let (_, falling, rising) = motion.weights_of_decay(rates[w], decays[w], phase);
            (a[w], b[w], c[w], d[w]) = (falling.re, falling.im, rising.re, rising.im);
        }
    }
}

struct Abreast<'a> {
    rotation: &'a PhaseRotation<'a>,
    /// Modes at a constant velocity, and those of the upward recurrence.
    constant: Range<usize>,
    turning: Range<usize>,
    states: [&'a [f64]; 2],
    weights: [&'a mut [f64]; 4],
}

/// Vectors that cover a range of at least their length, or of none; the last overlaps the one before.
fn vectors(range: &Range<usize>) -> impl Iterator<Item = Range<usize>> + use<> {
    let end = range.end;
    range
        .clone()
        .step_by(MODE_LANES)
        .map(move |first| first.min(end - MODE_LANES))
        .map(|first| first..first + MODE_LANES)
}

/// States of some modes: propagation factor e^z and z.
#[derive(Clone, Copy)]
struct Exponent {
    factor: [Lanes; 2],
    z: [Lanes; 2],
}

impl Exponent {
    #[inline(always)]
    fn inverse(&self) -> [Lanes; 2] {
        let z = self.z;
        let scale = each(|l| 1.0 / (z[0][l] * z[0][l] + z[1][l] * z[1][l]));
        [each(|l| z[0][l] * scale[l]), each(|l| -z[1][l] * scale[l])]
    }

    /// `integral exp(z u) {1, u} du`: of the second, g, by its power series or from the first, `e^z = integral + z g`.
    #[inline(always)]
    fn integrals(&self) -> [[Lanes; 2]; 2] {
        let (z, factor) = (self.z, self.factor);
        let near = each(|l| if z[0][l].abs() + z[1][l].abs() < NEAR { 1.0 } else { 0.0 });
        let mut series = [[0.0; MODE_LANES]; 2];
        for coefficient in FALLING.iter().rev() {
            series = product(series, z);
            series[0] = each(|l| series[0][l] + coefficient);
        }
        let inverse = self.inverse();
        let all = product([each(|l| factor[0][l] - 1.0), factor[1]], inverse);
        let falling = product([each(|l| factor[0][l] - all[0][l]), each(|l| factor[1][l] - all[1][l])], inverse);
        let falling = [0, 1].map(|part| each(|l| if near[l] == 1.0 { series[part][l] } else { falling[part][l] }));
        let less = product(falling, z);
        [[0, 1].map(|part| each(|l| factor[part][l] - less[part][l])), falling]
    }
}

impl WithSimd for Abreast<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { rotation, constant, turning, states: [rates, decays], weights: [a, b, c, d] } = self;
        let (step, [from, to]) = (rotation.step, rotation.velocity);
        let (middle, change, drift) =
            (0.5 * step * (from + to), 0.5 * step * (to - from), 0.125 * step * (to - from).abs());
        let exponent = |at: &Range<usize>| {
            let read = |values: &[f64]| -> Lanes { std::array::from_fn(|l| values[at.clone()][l]) };
            let (q, rates, decays) = (read(rotation.numbers), read(rates), read(decays));
            let (cosine, sine) = (read(rotation.phases[0]), read(rotation.phases[1]));
            let factor = [each(|l| cosine[l] * decays[l]), each(|l| sine[l] * decays[l])];
            Exponent { factor, z: [each(|l| -rates[l] * step), each(|l| q[l] * middle)] }
        };
        for at in vectors(&constant) {
            let [all, falling] = exponent(&at).integrals();
            for (part, [of_falling, of_rising]) in [[&mut *a, &mut *c], [&mut *b, &mut *d]].into_iter().enumerate() {
                let (of_falling, of_rising) = (&mut of_falling[at.clone()], &mut of_rising[at.clone()]);
                for l in 0..MODE_LANES {
                    of_falling[l] = step * falling[part][l];
                    of_rising[l] = step * (all[part][l] - falling[part][l]);
                }
            }
        }
        for at in vectors(&turning) {
            let exponent = exponent(&at);
            let (Exponent { factor, z }, inverse) = (exponent, exponent.inverse());
            let square = product(inverse, inverse);
            // T_0 and T_1.
            let mut lower = product([each(|l| factor[0][l] - 1.0), factor[1]], inverse);
            let ends = product(factor, [each(|l| z[0][l] - 2.0), z[1]]);
            let ends = [each(|l| ends[0][l] + z[0][l] + 2.0), each(|l| ends[1][l] + z[1][l])];
            let mut upper = product(product(ends, square), inverse);
            let (mut all, mut tilt) = (lower, upper);
            let eta = each(|l| rotation.numbers[at.clone()][l] * change);
            let mut weight = [[1.0; MODE_LANES], [0.0; MODE_LANES]];
            let count = terms(drift * rotation.numbers[at.end - 1]);
            for m in 1..=count {
                let multiple = 2.0 * (2 * m + 1) as f64;
                let rest =
                    [each(|l| lower[0][l] - multiple * upper[0][l]), each(|l| lower[1][l] - multiple * upper[1][l])];
                (lower, upper) = (upper, product(rest, square));
                weight = [each(|l| -eta[l] * weight[1][l]), each(|l| eta[l] * weight[0][l])];
                let (own, next) = (product(weight, lower), product(weight, upper));
                for part in 0..2 {
                    all[part] = each(|l| all[part][l] + own[part][l]);
                    tilt[part] = each(|l| tilt[part][l] + next[part][l]);
                }
            }
            let tilt = product(tilt, z);
            for (part, [falling, rising]) in [[&mut *a, &mut *c], [&mut *b, &mut *d]].into_iter().enumerate() {
                let (falling, rising) = (&mut falling[at.clone()], &mut rising[at.clone()]);
                for l in 0..MODE_LANES {
                    falling[l] = 0.5 * step * (all[part][l] + tilt[part][l]);
                    rising[l] = 0.5 * step * (all[part][l] - tilt[part][l]);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against the scalar form, at rates and velocities on both sides of the vectorised range.
    #[test]
    fn weights_are_those_of_single_states() {
        let numbers: Vec<f64> = (1..=61).map(|n| 9.0 * f64::from(n)).collect();
        let step = 5e-3;
        for velocity in
            [[10.0, 9.985], [10.0, 10.0], [-2.0, -2.3], [0.4, 0.39], [0.1, -0.1], [0.0, 3.0], [40.0, 10.0], [0.0, 0.0]]
        {
            let rates: Vec<f64> = numbers.iter().map(|q| 1.6e-5 * q * q + 0.1 * q).collect();
            let decays: Vec<f64> = rates.iter().map(|rate| (-rate * step).exp()).collect();
            let motion = |q: f64| PhaseRate { turning: velocity.map(|v| q * v), step };
            let phases: Vec<Complex<f64>> = numbers.iter().map(|q| motion(*q).phase()).collect();
            let parts = [phases.iter().map(|z| z.re).collect::<Vec<_>>(), phases.iter().map(|z| z.im).collect()];
            let turning = PhaseRotation { velocity, step, numbers: &numbers, phases: [&parts[0], &parts[1]] };
            // Fewer states than modes.
            let count = 59;
            let mut found = [0; 4].map(|_| vec![0.0; count]);
            turning.weights(&rates[..count], &decays[..count], found.each_mut().map(|part| &mut part[..]));
            for w in 0..count {
                let (_, falling, rising) = motion(numbers[w]).weights(rates[w], phases[w]);
                let scale = falling.norm() + rising.norm();
                let apart = (falling - Complex::new(found[0][w], found[1][w])).norm()
                    + (rising - Complex::new(found[2][w], found[3][w])).norm();
                // At small drifts the scalar form omits terms that are kept beside modes of larger drifts.
                let allowed = if motion(numbers[w]).drift() < LEAST_DRIFT { LEAST_DRIFT } else { 1e-7 };
                assert!(apart < allowed * scale.max(1e-3 * step), "{velocity:?} {w}: {apart:e} of {scale:e}");
            }
        }
    }
}
