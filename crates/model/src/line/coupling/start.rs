//! Predictor of a stage iteration: extrapolation of fluxes and pressure.
//!
//! At the first stage a value is extrapolated linearly through the last two stages, at the end by the parabola through these and
//! the first stage; after a jump (slope 0) it is kept constant. A better initial iterate saves iterations and does not affect the
//! result otherwise.
//!
//! Theory: docs/theory.md, section 6.4.

use super::ThermalCoupling;
use crate::line::heat::state::HeatState;
use conduction::line::GAMMA;

/// Linear extrapolation to gamma h from value and slope at 0.
fn extrapolate_linearly(start: f64, slope: f64, step: f64) -> f64 {
    start + GAMMA * step * slope
}

/// Quadratic extrapolation to h from the values at 0 and gamma h, and the slope of the secant to the value at 0 from (1 - gamma)
/// `last` before.
fn extrapolate_quadratically(start: f64, first: f64, slope: f64, step: f64, last: f64) -> f64 {
    if slope == 0.0 {
        return first;
    }
    let rate = (first - start) / (GAMMA * step);
    let bend = (rate - slope) / (GAMMA * step + (1.0 - GAMMA) * last);
    first + (1.0 - GAMMA) * step * (rate + step * bend)
}

impl ThermalCoupling {
    /// Whether the stage is solved directly, without iteration, so that the initial iterate does not matter.
    fn needs_no_start(&self, s: usize) -> bool {
        let open = self.iterate.closed.iter().filter(|closed| !**closed).count();
        self.is_solved_directly(open) && self.contact_parts[s].is_whole()
    }

    /// Zero initial iterate, independent of history, in case an iteration turns out to be needed after all.
    fn start_from_zero(&mut self, s: usize) {
        self.flux[s][0].fill(0.0);
        self.iterate.pressure.fill(0.0);
    }

    /// Predicts the punch's flux and the pressure at the first stage.
    pub(super) fn predict_first(&mut self, state: &HeatState, pressure: &[f64]) {
        if self.needs_no_start(0) {
            return self.start_from_zero(0);
        }
        let ahead = state.ahead(self.step);
        for i in 0..pressure.len() {
            self.flux[0][0][i] = extrapolate_linearly(state.flux[0][i], state.slope[0][i], ahead);
            self.iterate.pressure[i] = extrapolate_linearly(pressure[i], state.pressure_slope[i], ahead).max(0.0);
        }
    }

    /// Predicts the punch's flux and the pressure at the end; `pressure` is that of the start and of the first stage.
    pub(super) fn predict_end(&mut self, state: &HeatState, pressure: [&[f64]; 2]) {
        if self.needs_no_start(1) {
            return self.start_from_zero(1);
        }
        let (step, last) = (state.ahead(self.step), state.last_step);
        let [first, end] = &mut self.flux;
        for i in 0..pressure[0].len() {
            end[0][i] = extrapolate_quadratically(state.flux[0][i], first[0][i], state.slope[0][i], step, last);
            let expected =
                extrapolate_quadratically(pressure[0][i], pressure[1][i], state.pressure_slope[i], step, last);
            self.iterate.pressure[i] = expected.max(0.0);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_and_parabolas_go_on() {
        let (step, last) = (0.7, 0.4);
        let value = |t: f64| 3.0 - 2.0 * t + 5.0 * t * t;
        let before = -(1.0 - GAMMA) * last;
        let slope = (value(0.0) - value(before)) / -before;
        let end = extrapolate_quadratically(value(0.0), value(GAMMA * step), slope, step, last);
        assert!((end - value(step)).abs() < 1e-13, "{end} {}", value(step));
        let line = |t: f64| 3.0 - 2.0 * t;
        assert!((extrapolate_linearly(line(0.0), -2.0, step) - line(GAMMA * step)).abs() < 1e-14);
        assert_eq!(extrapolate_quadratically(1.0, 2.0, 0.0, step, last), 2.0);
    }
}
