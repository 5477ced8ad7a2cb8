//! Thermoelastic growth under the operator split, in full periodic contact of one conducting half-plane with a rigid
//! insulator.
//!
//! With the distortion delayed by one step of tau, a pressure wave of wave number m grows by `g = exp(b tau)` per step with
//! `z (1 + z) = 2 R/g`, `z^2 = 1 + (1 - 1/g)/(tau kd m^2)`, R the speed over `2 K m (1 - nu)/(mu E alpha)`: more slowly than
//! the exact `z (1 + z) = 2 R`, `z^2 = 1 + b/(kd m^2)`, at first order in tau.
//!
//! Theory: docs/theory.md, section 5.6.

use super::wave::{SplitWave, WaveScene, amplification, unit};
use super::{Fallible, Problem, known};

const RATIO: f64 = 5.0;

/// Growth rate in 1/s of the longest wave in steps of `step` s: number of steps, and number of those that are evaluated.
fn growth(step: f64, [steps, counted]: [usize; 2]) -> Fallible<f64> {
    let mut wave = SplitWave::new(WaveScene::new(32).build()?.linear_wave(RATIO)?);
    let amplitudes: Vec<_> = (0..steps)
        .map(|_| {
            wave.step(step * unit());
            wave.amplitude()
        })
        .collect();
    Ok(amplification(&amplitudes, counted, false).re.ln() / step)
}

pub(super) fn problems() -> Vec<Problem> {
    [(0.05, 14.515, [16, 6]), (0.01, 24.943, [50, 20])]
        .into_iter()
        .map(|(step, exact, samples)| Problem {
            name: format!("thermoelastic growth at 5 critical speeds, heat split off the contact, steps of {step} s"),
            quantity: "growth rate of the longest wave, 1/s",
            exact: known(exact),
            scale: None,
            compute: Box::new(move || growth(step, samples)),
            bound: 1e-3,
            reason: "cells of a wave, and the reduction of the punch",
        })
        .collect()
}
