//! Error estimate of a step with resolved heat, and update of the state by an accepted step.
//!
//! Theory: docs/theory.md, sections 7.1, 5.3.

use super::evaluation::largest;
use super::stage::{Solved, state_of, weighted};
use super::{Iterate, ThermalCoupling};
use crate::line::heat::state::HeatState;
use crate::line::operators::LineOperators;
use crate::line::stages::{ContactStages, StepData};
use crate::line::state::LineState;
use conduction::line::{FrozenState, GAMMA, Stage};
use contact::friction::FrictionLaw;
use numerics::dense;
use numerics::maximum::maximum;
use numerics::subnormal::flushed;

/// Least temperature rise to which the error of the temperature is relative, K: a run begins with none, and slow pins rise by
/// a tenth of a kelvin.
pub(in crate::line) const LEAST_LINE_RISE: f64 = 0.1;

/// Part of a jump of the flux through a cell at the start of a step that counts as its deviation at least: a transient between the bodies
/// that has passed at the first stage does not show in the change between the stages. Without it the first step of random scenes missed
/// 1e-2 by up to seven times; with a fifth machine elements take a tenth more steps and gain nothing.
const HIDDEN: f64 = 0.05;

/// Deviation of a flux from the straight line through both stages of a step, from its values `before` the step, at its first stage and
/// at its end, where the stages do not see `hidden` of a jump.
///
/// That of a smooth flux is largest at the start of the step, `gamma h^2 q''/2`. A flux that jumps there and changes little afterwards,
/// as by inputs that are held, deviates by no more than `(1/2 - gamma)` of its change, by which the embedded first-order solution differs,
/// or by what is hidden.
pub(super) fn deviation_from_line([before, first, end]: [f64; 3], hidden: f64) -> f64 {
    let change = end - first;
    let at_start = before - first + GAMMA / (1.0 - GAMMA) * change;
    let embedded = (0.5 - GAMMA) * change;
    if at_start.abs() < embedded.abs() {
        at_start
    } else if hidden * at_start.abs() > embedded.abs() {
        hidden * at_start
    } else {
        embedded
    }
}

/// [`deviation_from_line`] of the fluxes of a body before the step, at its first stage and at its end, W/m2, by cells.
///
/// A cell that opens between the stages exchanges heat for up to (1 - 2 gamma) of the step more or less than it should, and deviates by
/// half of its flux. Where the flux has jumped, as in a cell that closes, `hidden` of a jump is not seen, and `part` of the deviation lasts.
fn flux_defect(
    closed: [&[bool]; 2],
    flux: [&Vec<f64>; 3],
    jumped: impl Fn(usize) -> bool,
    [hidden, part]: [f64; 2],
    defect: &mut [f64],
) {
    for (i, defect) in defect.iter_mut().enumerate() {
        let [before, first, end] = flux.map(|flux| flux[i]);
        let opens = closed[0][i] && !closed[1][i];
        *defect = match (opens, jumped(i)) {
            (true, _) => 0.5 * (end - first),
            (false, true) => part * deviation_from_line([before, first, end], hidden),
            (false, false) => deviation_from_line([before, first, end], 0.0),
        };
    }
}

impl Solved<'_> {
    /// Whether the step is long enough for its thermal error to be controlled: longer than a tolerance of the shortest time to be resolved.
    pub(crate) fn is_controlled(&self, tolerance: f64) -> bool {
        self.0.step > tolerance * self.0.parameters.times[0]
    }

    /// Part of the error by a flux that jumps at the start of the step that lasts for the shortest time to be resolved, and where a cell closes
    /// beside others for the time of diffusion across it.
    ///
    /// A flux that jumps, or begins as `t^(-1/2)` where bodies of two temperatures meet, has the same error in a first step of any length,
    /// relative to the rise since then; what it has heated decays as `h t^(-1/2)`.
    fn lasting(&self, state: &HeatState) -> f64 {
        let [shortest, across] = self.0.parameters.times;
        let time = if self.closes(state) { maximum(shortest, across) } else { shortest };
        (self.0.step / time).sqrt().min(1.0)
    }

    /// Whether the bodies begin to receive heat with the step, but for what rounding of a velocity of 0 leaves. The error is of first order.
    pub(crate) fn begins(&self, given: &StepData<'_>) -> bool {
        let before_and_end = state_of(given).flux.iter().zip(&self.0.flux[1]);
        let [before, end] = before_and_end.fold([0.0; 2], |[before, end], (own, later)| {
            [maximum(before, largest(own)), maximum(end, largest(later))]
        });
        end > 0.0 && before <= 1e-12 * end
    }

    /// Whether a cell that exchanged no heat at the start of the step, where others did, does so at one of its stages.
    fn closes(&self, state: &HeatState) -> bool {
        let before = &state.flux[0];
        let [first, end] = self.0.flux.each_ref().map(|flux| &flux[0]);
        let mut cells = before.iter().zip(first.iter().zip(end));
        cells.any(|(before, (first, end))| *before == 0.0 && (*first != 0.0 || *end != 0.0))
            && before.iter().any(|before| *before != 0.0)
    }

    /// Error of temperature and distortion from fluxes that are not linear over the step, in units of their part of the tolerance;
    /// `bound` is that of the displacement, in m.
    pub(crate) fn error(&mut self, given: &StepData<'_>, bound: f64) -> f64 {
        let operators = given.operators;
        let state = state_of(given);
        let (lasting, begins) = (self.lasting(state), self.begins(given));
        let faces = self.error_of_faces(operators, state, bound);
        if self.0.open {
            return faces;
        }
        let heat = &mut *self.0;
        let widths = operators.cells.widths();
        let width = 2.0 * operators.cells.half_width();
        let mut moved_square = 0.0;
        let mut temperature_error: f64 = 0.0;
        let [mut rise, mut before] = [LEAST_LINE_RISE; 2];
        heat.iterate.sums[1].fill(0.0);
        let closed = [0, 1].map(|stage| heat.partitions[stage].closed());
        // A body alone takes all the heat at once.
        let hidden = if heat.bodies.iter().all(Option::is_some) { HIDDEN } else { 0.0 };
        for side in 0..2 {
            let (Some(own), Some(work)) = (&heat.bodies[side], &mut heat.work[side]) else { continue };
            let flux = [&state.flux[side], &heat.flux[0][side], &heat.flux[1][side]];
            // The slope is 0 after a jump.
            let jumped = |i: usize| state.slope[side][i] == 0.0;
            let Iterate { difference, sums: [warm, moved], .. } = &mut heat.iterate;
            flux_defect(closed, flux, jumped, [hidden, lasting], difference);
            warm.fill(0.0);
            own.respond(Stage::End, difference, [Some(warm), heat.parameters.expands[side].then_some(moved)], work);
            let square: f64 = heat.iterate.sums[0].iter().zip(widths).map(|(t, c)| c * t * t).sum();
            temperature_error = maximum(temperature_error, (square / width).sqrt());
            rise = maximum(rise, largest(&heat.temperature[1][side]));
            before = maximum(before, largest(&state.temperature[side]));
        }
        if begins {
            // By the end of the time that `lasting` is for, the rise has grown with its root.
            rise = maximum(rise, before + (rise - before) / lasting);
        }
        // Under a given load a uniform displacement does not change the pressure.
        let mean = operators.cells.integral(&heat.iterate.sums[1]) / width;
        for (moved, c) in heat.iterate.sums[1].iter().zip(widths) {
            moved_square += c * (moved - mean) * (moved - mean);
        }
        let moved = (moved_square / width).sqrt();
        let cells = maximum(moved / bound, temperature_error / (operators.budget.steps.whole * rise));
        maximum(cells, faces)
    }

    /// The same from the fluxes into the cooled faces, whether or not there is contact.
    fn error_of_faces(&self, operators: &LineOperators, state: &HeatState, bound: f64) -> f64 {
        let heat = &*self.0;
        let touch =
            !heat.open && heat.partitions[0].closed().iter().chain(heat.partitions[1].closed()).any(|closed| *closed);
        let [error, of_faces, moved] = heat.errors_of_faces(state, touch);
        let cells = heat.temperature[1].iter().map(|surface| largest(surface));
        let rise = cells.fold(maximum(of_faces, LEAST_LINE_RISE), maximum);
        maximum(moved / bound, error / (operators.budget.steps.whole * rise))
    }
}

impl ThermalCoupling {
    /// Updates the thermal state by the step whose stages are solved; `velocity` is the sliding velocity at its end, m/s. The
    /// first part of a communication step leaves its initial body states in `kept`, from which they can be restored.
    pub(crate) fn accept(
        &mut self,
        operators: &LineOperators,
        friction: &FrictionLaw,
        stages: &ContactStages,
        line: &mut LineState,
        kept: Option<&mut HeatState>,
        velocity: f64,
    ) {
        let (step, heat) = (self.step, self);
        let Some(state) = &mut line.heat else { return };
        let entered = |stage: usize| dense::dot(&heat.friction[stage], &operators.weights);
        let (per_rise, per_change) = (1.0 / (GAMMA * step), 1.0 / ((1.0 - GAMMA) * step));
        state.dissipated += step * ((1.0 - GAMMA) * entered(0) + GAMMA * entered(1));
        let before = kept.map_or(&mut heat.before, |kept| &mut kept.bodies);
        std::mem::swap(before, &mut state.bodies);
        for side in 0..2 {
            let flux = [0, 1].map(|stage| &heat.flux[stage][side][..]);
            let around = &heat.surroundings[side];
            let (own, work) = (heat.bodies[side].as_ref(), heat.work[side].as_mut());
            if let (Some(own), Some(work)) = (own, work) {
                let Some(end) = heat.ends[side].take() else { unreachable!("a step that is accepted is solved") };
                own.advance(end, (&before[side], &mut state.bodies[side]), around, flux, work);
                state.bodies[side].iter_mut().for_each(|value| *value = flushed(*value));
            }
            state.trend[side] = heat.frozen.trend(side, heat.bodies[side].as_deref(), &state.bodies[side], step);
            let fluxes = heat.flux[0][side].iter().zip(&heat.flux[1][side]).zip(&state.flux[side]);
            for (slope, ((first, end), before)) in state.slope[side].iter_mut().zip(fluxes) {
                *slope = slope_over_step(*slope, [*before, *first, *end], [per_rise, per_change]);
            }
            state.flux[side].copy_from_slice(&heat.flux[1][side]);
            state.temperature[side].copy_from_slice(&heat.temperature[1][side]);
            if let (0, false, Some(own), Some(work)) =
                (side, heat.contact_parts[1].is_whole(), &heat.bodies[side], &mut heat.work[side])
            {
                // The mean of whole cells, not of their parts in contact.
                let body = &state.bodies[side];
                own.temperature_at_frozen_state(
                    &FrozenState { state: body, surroundings: around, flux: &state.flux[side], velocity },
                    &mut state.temperature[side],
                    work,
                );
            }
        }
        heat.accept_faces(state);
        state.last_step = step;
        let pressures = stages.first.pressure.iter().zip(&stages.end.pressure).zip(&line.pressure);
        for (slope, ((first, end), before)) in state.pressure_slope.iter_mut().zip(pressures) {
            let lasting = (*before > 0.0) & (*first > 0.0) & (*end > 0.0);
            *slope = if lasting { (end - first) * per_change } else { 0.0 };
        }
        if let Some(edges) = &heat.edges {
            let worn = operators.shaping(&line.punch, &line.strip);
            edges.follow([&stages.first, &stages.end], (1.0 - GAMMA) * step, worn, &mut state.edges);
        }
        state.distortion.copy_from_slice(&heat.distortion);
        state.kinetic_coefficient = match operators.scene.friction_fade.flat {
            true => heat.kinetic_coefficient[0],
            false => weighted(&heat.kinetic_coefficient, &stages.end.pressure, &operators.torque_weights),
        };
        state.reference.follow(heat.reference.velocity, velocity, heat.iterations);
        state.reference.contraction = heat.iterate.contraction;
        let fade = if friction.coefficient > 0.0 { state.kinetic_coefficient / friction.coefficient } else { 1.0 };
        // Relative change of the temperature-dependent factor of the friction coefficient beyond which its linearization point is updated.
        if (fade / state.reference.fade - 1.0).abs() > 0.1 {
            state.reference.fade = fade;
        }
    }
}

/// Largest ratio of successive rates of a flux that counts as smooth. For a smooth flux successive rates differ by O(h); for an
/// exponentially decaying one this ratio is reached at a step of over three time constants.
const SMOOTH: f64 = 3.0;

/// Least ratio of found to predicted rate: a rate of 0 is reserved for "none".
const LEAST_RATIO: f64 = 1e-3;

/// Rate of a flux over a step from the one before, from its values at the start, at the first stage and at the end, which are
/// 1/`per_length` apart (1/s); 0 where a cell or face exchanges no heat, or has just begun to.
pub(super) fn slope_over_step(predicted: f64, [before, first, end]: [f64; 3], per_length: [f64; 2]) -> f64 {
    // Rounding of a velocity of 0 leaves a flux that is none.
    let lasting = (before.abs() > 1e-12 * end.abs()) & (end != 0.0);
    let rates = [(first - before) * per_length[0], (end - first) * per_length[1]];
    if lasting { slope_limited(predicted, rates) } else { 0.0 }
}

/// Slope limiter: the rate by which the predictor extrapolates a flux beyond a step, from the rate predicted for that step (0:
/// none) and the rates found in its first stage and behind it.
///
/// A flux that settles within a step does not continue at its last rate: a first stage linear at that rate would start from a
/// transient that has long decayed, and the next rate would be an artefact of this start. The error of a settled flux then decays
/// as `0.06^n` instead of `0.0008^n` in steps of ten times the mode's time constant. There are two indicators: the rate
/// drops to a fraction within the step, or the predicted rate is not met. Where neither holds the rate is returned
/// unchanged, to the last bit, so the order of convergence for smooth fluxes is preserved; beyond, the rate is reduced
/// with the fourth power.
fn slope_limited(predicted: f64, [early, late]: [f64; 2]) -> f64 {
    let lasting = (SMOOTH * late / early).abs().min(1.0);
    let met = if predicted == 0.0 { 1.0 } else { (SMOOTH * early / predicted).clamp(LEAST_RATIO, 1.0) };
    let square = (lasting * met).powi(2);
    square * square * late
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rates in the first stage of a step of length 1, and behind it.
    fn rates(flux: impl Fn(f64) -> f64) -> [f64; 2] {
        [(flux(GAMMA) - flux(0.0)) / GAMMA, (flux(1.0) - flux(GAMMA)) / (1.0 - GAMMA)]
    }

    #[test]
    fn a_flux_deviates_from_the_line_through_the_stages_by_its_curvature_or_by_its_change() {
        let of = |flux: fn(f64) -> f64| deviation_from_line([0.0, GAMMA, 1.0].map(flux), HIDDEN);
        assert!(of(|t| 3.0 - 2.0 * t).abs() < 1e-15);
        // q'' = 0.2: gamma q''/2 at the start, where (t - gamma)(t - 1) is largest.
        assert!((of(|t| 3.0 - 2.0 * t + 0.1 * t * t) - 0.1 * GAMMA).abs() < 1e-15);
        // Held inputs jump before the first stage, by little and by much.
        assert!((of(|t| if t == 0.0 { 3.5 } else { 3.0 - t }) + (0.5 - GAMMA) * (1.0 - GAMMA)).abs() < 1e-15);
        assert!((of(|t| if t == 0.0 { 12.0 } else { 3.0 - t }) - HIDDEN * 9.0).abs() < 1e-14);
    }

    #[test]
    fn smooth_fluxes_keep_their_rates_and_settled_ones_lose_them() {
        for decay in [0.1, 0.5, 1.0, 1.5, -1.0] {
            let predicted = rates(|t| (-decay * (t - 1.0)).exp())[1];
            let now = rates(|t| (-decay * t).exp());
            assert_eq!(slope_limited(predicted, now), now[1], "{decay}");
        }
        let now = rates(|t| (-6.0 * t).exp());
        assert!(slope_limited(0.0, now).abs() < 0.01 * now[1].abs());
        assert!(slope_limited(now[1], now).abs() < 0.01 * now[1].abs());
        // Rest of a wrong start: the flux hardly changes in the first stage, whatever was predicted.
        let left = slope_limited(-1.0, [-0.02, -0.06]);
        assert!(left != 0.0 && left.abs() < 1e-5, "{left}");
        // Steady to rounding, and steady to the last bit.
        assert_eq!(slope_limited(0.0, [0.0, 0.0]), 0.0);
        assert_eq!(slope_limited(0.0, [0.0, 1e-9]), 1e-9);
    }
}
