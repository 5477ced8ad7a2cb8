//! The moving source over one step, at a velocity that may change during it.

use super::operators::Operators;
use super::stage::{POINTS, weights};
use super::state::State;
use crate::heat::flash::MAX_FLASH_STATES;

/// The moving source over one step.
pub struct FlashStep {
    /// Decay of every state over the step.
    pub decay: [f64; MAX_FLASH_STATES],
    /// Gain from the stage fluxes to every state.
    pub update: [[f64; MAX_FLASH_STATES]; 2],
    /// Contact temperature at the three points from the initial states, K.
    pub homogeneous: [f64; 3],
    /// Gain from the stage fluxes to the contact temperature at the three points, K m2/W.
    pub gain: [[f64; 2]; 3],
}

impl FlashStep {
    /// Weights for `speeds` (m/s) at the start and at the three points of the step `step` (s); `None`
    /// without a moving source.
    pub fn new(operators: &Operators, state: &State, speeds: [f64; 4], step: f64) -> Option<FlashStep> {
        let flash = operators.flash.as_ref()?;
        let steady = speeds[1] == speeds[0] && speeds[2] == speeds[0] && speeds[3] == speeds[0];
        let first = flash.sliding_rate(speeds[0]);
        let rates = if steady { [first; 4] } else { speeds.map(|speed| flash.sliding_rate(speed)) };
        let mut out = FlashStep {
            decay: [0.0; MAX_FLASH_STATES],
            update: [[0.0; MAX_FLASH_STATES]; 2],
            homogeneous: [0.0; 3],
            gain: [[0.0; 2]; 3],
        };
        // Integral of sigma from the start to every point: exact for a rate cubic in time.
        let passed = if steady {
            POINTS.map(|c| first * c * step)
        } else {
            let [r0, r1, r2, r3] = rates;
            [
                step * (9.0 * r0 + 19.0 * r1 - 5.0 * r2 + r3) / 72.0,
                step * (r0 + 4.0 * r1 + r2) / 9.0,
                step * (r0 + 3.0 * r1 + 3.0 * r2 + r3) / 8.0,
            ]
        };
        for (point, &c) in POINTS.iter().enumerate() {
            let along = rates[point + 1];
            for (k, (&rate, &residue)) in flash.decays.rate.iter().zip(&flash.decays.residue).enumerate() {
                let homogeneous = (-rate * c * step - passed[point].max(0.0)).exp();
                let local = if steady { homogeneous } else { (-(rate + along) * c * step).exp() };
                let weight = weights(rate + along, local, c, step);
                out.homogeneous[point] += homogeneous * state.flash[k];
                out.gain[point][0] += residue * weight[0];
                out.gain[point][1] += residue * weight[1];
                if point == 2 {
                    out.decay[k] = homogeneous;
                    out.update[0][k] = residue * weight[0];
                    out.update[1][k] = residue * weight[1];
                }
            }
        }
        Some(out)
    }
}
