//! A stage of the step with heat: pressure, heat split, wear and rigid motion at once.

use super::Heat;
use super::bodies::cooled_part;
use crate::contact::ContactState;
use crate::coupled::Inputs;
use crate::coupled::line::Line;
use crate::coupled::line::path::{Moment, Path};
use crate::coupled::lumped::conditions::Conditions;
use crate::coupled::lumped::operators::BodyOperators;
use crate::heat::STEFAN_BOLTZMANN;
use crate::heat::line::{GAMMA, Stage, Surroundings};
use crate::scene::{Body, Scheme};
use crate::wear::line::{Coefficient, StageError};

/// Repetitions until contact and temperature agree; then a shorter step has to help.
const MOST_REPETITIONS: usize = 80;

/// Change of the friction coefficient (relative) at which it agrees with the temperature.
const AGREEMENT: f64 = 1e-10;

impl Line {
    /// Makes the bodies ready for a part of `step` (s) that begins at `start` (s from the start of the piece).
    pub(in crate::coupled::line) fn prepare_heat(&mut self, path: &Path, start: f64, step: f64) {
        let (Some(heat), Some(state)) = (&mut self.heat, &self.state.heat) else { return };
        let velocity = [path.velocity(start), path.velocity(start + step)];
        let operators = &self.operators;
        let reference = self.mean.state().reference;
        let inputs = Inputs::from_array(path.inputs(start + 0.5 * step));
        let conditions = Conditions::new(&operators.mean, &self.tunables, reference, &inputs);
        let scene = &operators.scene;
        heat.key = (step, velocity);
        let far = [conditions.punch_far, conditions.strip_far];
        let each: [(&BodyOperators, &Body, f64); 2] =
            [(&operators.mean.punch, &scene.punch, 1.0), (&operators.mean.strip, &scene.strip, cooled_part(scene))];
        for (side, (mean, body, part)) in each.into_iter().enumerate() {
            let ambient = conditions.ambient;
            let mut around = Surroundings { cooling: state.cooling[side], ambient, far: far[side] };
            if let Some(own) = &mut heat.bodies[side] {
                match scene.scheme {
                    Scheme::Staggered => own.prepare_euler(step, velocity),
                    _ => own.prepare(step, velocity),
                }
                if mean.variable_cooling {
                    let t = own.cooled_temperature(&state.bodies[side], &around, &state.flux[side]);
                    around.cooling = part * cooling(body, reference, t, ambient, conditions.forced);
                }
            }
            heat.surroundings[side] = around;
        }
    }

    /// Solves a stage of length `tau` (s) on the gap in `work`; `moment` takes the friction coefficient over.
    pub(in crate::coupled::line) fn solve_with_heat(
        &mut self,
        stage: Stage,
        moment: &mut Moment,
        velocity: f64,
        tau: f64,
        travel: f64,
    ) -> Result<(), StageError> {
        let Some(mut heat) = self.heat.take() else { unreachable!("only scenes with heat along the line come here") };
        let outcome = self.solve_both(&mut heat, stage, moment, velocity, tau, travel);
        self.heat = Some(heat);
        outcome
    }

    fn solve_both(
        &mut self,
        heat: &mut Heat,
        stage: Stage,
        moment: &mut Moment,
        velocity: f64,
        tau: f64,
        travel: f64,
    ) -> Result<(), StageError> {
        let operators = self.operators.clone();
        let count = operators.count();
        let s = stage as usize;
        if self.work.track.is_some() {
            self.work.carried_over = None;
            std::mem::swap(&mut self.contact, &mut heat.contacts[s]);
            self.set_operator(travel, moment);
            std::mem::swap(&mut self.contact, &mut heat.contacts[s]);
        }
        let Some(state) = &self.state.heat else { unreachable!("a scene with heat along the line has its state") };
        heat.begin(stage, state);
        // A cell that was in contact at the start of the step exchanges heat throughout it, one that closes within it from
        // then on. So the repetition only closes cells, and ends; and a cell that opens when it gets heat and closes when
        // it does not, which has no state of its own, changes from step to step instead of stopping them.
        let status = match stage {
            Stage::First => {
                let earlier = &self.state.pressure;
                let untouched = earlier.iter().all(|p| *p == 0.0);
                for (closed, p) in heat.closed.iter_mut().zip(earlier) {
                    *closed = *p > 0.0 || untouched;
                }
                self.contact.status()
            }
            Stage::End => heat.contacts[0].status(),
        };
        if moment.load == 0.0 {
            heat.closed.fill(false);
        }
        self.work.status.copy_from(status);
        heat.contacts[s].set_status(&self.work.status);
        let reference = self.mean.state().reference;
        let stribeck = self.friction.stribeck(velocity);
        let sign = self.friction.sign(velocity);
        let fades = !operators.scene.friction_fade.flat;
        let by_cell = operators.wears_by_cell();
        for i in 0..count {
            let [punch, strip] = match stage {
                Stage::First => &state.temperature,
                Stage::End => &heat.temperature[0],
            };
            heat.felt[i] = 0.5 * (punch[i] + strip[i]) + reference;
            heat.faded[i] = self.friction.faded(heat.felt[i]);
        }
        for repetition in 0..MOST_REPETITIONS {
            heat.operator(stage, stribeck * moment.speed)?;
            heat.undeformed(stage, &self.work.gap);
            if fades {
                let pressure = if repetition > 0 { &self.stage_state(stage).pressure } else { &self.state.pressure };
                moment.faded = weighted(&heat.faded, pressure, &operators.weights);
                moment.signed_friction = sign * moment.faded * stribeck;
            }
            self.set_conditions(moment, tau);
            self.set_laws(heat, moment, by_cell);
            let found = match stage {
                Stage::First => &mut self.work.first,
                Stage::End => &mut self.work.end,
            };
            heat.contacts[s].stage_into(&heat.gap, tau, &self.conditions, found)?;
            heat.distribute(stage, &found.pressure);
            let mut change: f64 = 0.0;
            for i in 0..count {
                let [punch, strip] = &heat.temperature[s];
                let felt = 0.5 * (punch[i] + strip[i]) + reference;
                if by_cell || fades {
                    change = change.max((felt - heat.felt[i]).abs() / felt.abs().max(1.0));
                    heat.felt[i] = felt;
                    heat.faded[i] = self.friction.faded(felt);
                }
            }
            let settled = heat.settle(&found.pressure);
            if settled && change <= AGREEMENT {
                self.finish_stage(heat, stage);
                return Ok(());
            }
        }
        Err(StageError::NotConverged { stage: tau, iterations: MOST_REPETITIONS })
    }

    fn stage_state(&self, stage: Stage) -> &ContactState {
        match stage {
            Stage::First => &self.work.first,
            Stage::End => &self.work.end,
        }
    }

    /// Depth rates at the reference pressure, with the temperature and the friction of every cell.
    pub(super) fn set_laws(&mut self, heat: &mut Heat, moment: &Moment, by_cell: bool) {
        let operators = &self.operators;
        let acceleration = self.tunables.wear_acceleration;
        let mut uniform = [0.0; 2];
        for i in 0..heat.felt.len() {
            if by_cell || i == 0 {
                uniform = operators.coefficients(moment.speed, heat.faded[i], heat.felt[i], acceleration);
            }
            heat.laws[0][i] = uniform[0];
            heat.laws[1][i] = uniform[1];
        }
        if !by_cell {
            return;
        }
        let reshaping = (0..2).filter(|&body| operators.reshapes(body));
        for (term, body) in self.conditions.rate.terms.iter_mut().zip(reshaping) {
            if let Coefficient::PerCell(values) = &mut term.coefficient {
                values.copy_from_slice(&heat.laws[body]);
            }
        }
    }

    /// Depth rates of the stage, and the way on.
    fn finish_stage(&mut self, heat: &mut Heat, stage: Stage) {
        let s = stage as usize;
        let pressure = match stage {
            Stage::First => &self.work.first.pressure,
            Stage::End => &self.work.end.pressure,
        };
        for body in 0..2 {
            for (i, rate) in self.work.rates[s][body].iter_mut().enumerate() {
                let law = heat.laws[body][i];
                *rate = if law == 0.0 { 0.0 } else { law * self.operators.relative_rate(body, i, pressure[i]) };
            }
        }
        if stage == Stage::End {
            self.contact.set_status(heat.contacts[s].status());
            heat.distort();
        }
    }

    /// Error of temperature and distortion by fluxes that are not linear over the step, in units of the tolerance; `bound` in
    /// m.
    pub(in crate::coupled::line) fn heat_error(&mut self, bound: f64) -> f64 {
        let Some(heat) = &mut self.heat else { return 0.0 };
        let operators = &self.operators;
        let widths = operators.cells.widths();
        let width = 2.0 * operators.cells.half_width();
        let mut moved_square = 0.0;
        let mut warmed: f64 = 0.0;
        let mut rise: f64 = 1.0;
        heat.sums[1].fill(0.0);
        for side in 0..2 {
            let Some(own) = &heat.bodies[side] else { continue };
            let gains = own.gains(Stage::End);
            for (i, difference) in heat.difference.iter_mut().enumerate() {
                *difference = heat.flux[1][side][i] - heat.flux[0][side][i];
            }
            heat.sums[0].fill(0.0);
            add_product(&gains.temperature, &heat.difference, 1.0, &mut heat.sums[0]);
            add_product(&gains.distortion, &heat.difference, 1.0, &mut heat.sums[1]);
            let square: f64 = heat.sums[0].iter().zip(widths).map(|(t, c)| c * t * t).sum();
            warmed = warmed.max((square / width).sqrt());
            rise = heat.temperature[1][side].iter().fold(rise, |highest, t| highest.max(t.abs()));
        }
        // A uniform displacement changes no pressure under a given load.
        let mean = operators.cells.integral(&heat.sums[1]) / width;
        for (moved, c) in heat.sums[1].iter().zip(widths) {
            moved_square += c * (moved - mean) * (moved - mean);
        }
        let share = 0.5 - GAMMA;
        let moved = share * (moved_square / width).sqrt();
        (moved / bound).max(share * warmed / (operators.scene.tolerance * rise))
    }

    /// Takes the heat of the part that was tried, of `step` s.
    pub(in crate::coupled::line) fn accept_heat(&mut self, step: f64) {
        let (Some(heat), Some(state)) = (&self.heat, &mut self.state.heat) else { return };
        let operators = &self.operators;
        let entered = |stage: usize| -> f64 {
            heat.friction[stage].iter().zip(operators.cells.widths()).map(|(q, c)| q * c).sum()
        };
        state.dissipated += step * ((1.0 - GAMMA) * entered(0) + GAMMA * entered(1));
        for side in 0..2 {
            if let Some(own) = &heat.bodies[side] {
                let [first, end] = [&heat.flux[0][side], &heat.flux[1][side]];
                own.advance(&mut state.bodies[side], &heat.surroundings[side], first, end);
            }
            state.flux[side].copy_from_slice(&heat.flux[1][side]);
            state.temperature[side].copy_from_slice(&heat.temperature[1][side]);
            state.cooling[side] = heat.surroundings[side].cooling;
        }
        state.distortion.copy_from_slice(&heat.distortion);
        state.faded = weighted(&heat.faded, &self.work.end.pressure, &operators.weights);
    }
}

impl Heat {
    /// Temperature and distortion of both bodies at the stage if no heat came in it.
    pub(super) fn begin(&mut self, stage: Stage, state: &super::state::HeatState) {
        for side in 0..2 {
            let (base, distortion) = (&mut self.base[side], &mut self.base_distortion[side]);
            match &self.bodies[side] {
                Some(own) => {
                    let around = &self.surroundings[side];
                    own.base(&state.bodies[side], around, stage, &self.flux[0][side], base, distortion);
                }
                None => {
                    base.fill(self.surroundings[side].ambient);
                    distortion.fill(0.0);
                }
            }
        }
    }

    pub(super) fn conducts(&self) -> [bool; 2] {
        self.bodies.each_ref().map(Option::is_some)
    }

    /// Puts the distortion by the stage's own heat on the contact's compliance; `slip` is s v with the Stribeck factor.
    fn operator(&mut self, stage: Stage, slip: f64) -> Result<(), StageError> {
        let s = stage as usize;
        let gains = self.bodies.each_ref().map(|body| body.as_ref().map(|own| own.gains(stage)));
        self.splits[s].prepare(self.key, gains, &self.closed);
        for (heat, faded) in self.difference.iter_mut().zip(&self.faded) {
            *heat = faded * slip;
        }
        if let Some(extra) = self.splits[s].extra(&self.difference) {
            self.contacts[s].set_extra(Some(extra))?;
        }
        Ok(())
    }

    /// The gap with everything that moves it but the stage's own pressure.
    fn undeformed(&mut self, stage: Stage, gap: &[f64]) {
        let s = stage as usize;
        let conducts = self.conducts();
        let base = [&self.base[0][..], &self.base[1][..]];
        let [zero, exchanged] = &mut self.sums;
        zero.fill(0.0);
        self.splits[s].punch_flux(conducts, base, zero, exchanged);
        for (i, target) in self.gap.iter_mut().enumerate() {
            *target = gap[i] + self.base_distortion[0][i] + self.base_distortion[1][i];
        }
        for (side, sign) in [(0, 1.0), (1, -1.0)] {
            if let (Some(own), [true, true]) = (&self.bodies[side], conducts) {
                add_product(&own.gains(stage).distortion, &self.sums[1], sign, &mut self.gap);
            }
        }
    }

    /// Heat and temperatures that the pressure makes. The coefficients of the operator are still in `difference`.
    pub(super) fn distribute(&mut self, stage: Stage, pressure: &[f64]) {
        let s = stage as usize;
        for (i, heat) in self.friction[s].iter_mut().enumerate() {
            *heat = self.difference[i] * pressure[i];
        }
        let conducts = self.conducts();
        let base = [&self.base[0][..], &self.base[1][..]];
        let [punch, strip] = &mut self.flux[s];
        self.splits[s].punch_flux(conducts, base, &self.friction[s], punch);
        let closed = self.splits[s].closed();
        for i in 0..punch.len() {
            strip[i] = if conducts[1] && closed[i] { self.friction[s][i] - punch[i] } else { 0.0 };
        }
        for side in 0..2 {
            let temperature = &mut self.temperature[s][side];
            temperature.copy_from_slice(&self.base[side]);
            if let Some(own) = &self.bodies[side] {
                add_product(&own.gains(stage).temperature, &self.flux[s][side], 1.0, temperature);
            }
        }
        // An insulator's surface follows from the second law of the interface.
        if let [true, false] | [false, true] = conducts {
            let own = usize::from(!conducts[1]);
            for i in 0..closed.len() {
                if closed[i] && self.half_resistance > 0.0 {
                    self.temperature[s][own][i] =
                        self.temperature[s][1 - own][i] + self.friction[s][i] * self.half_resistance;
                }
            }
        }
    }

    /// Whether all cells that carry pressure exchange heat; if not, they do from now on.
    fn settle(&mut self, pressure: &[f64]) -> bool {
        let mut settled = true;
        for (closed, p) in self.closed.iter_mut().zip(pressure) {
            if *p > 0.0 && !*closed {
                *closed = true;
                settled = false;
            }
        }
        settled
    }

    /// Displacement of both surfaces by heat at the end of the step.
    pub(super) fn distort(&mut self) {
        for (i, moved) in self.distortion.iter_mut().enumerate() {
            *moved = self.base_distortion[0][i] + self.base_distortion[1][i];
        }
        for side in 0..2 {
            if let Some(own) = &self.bodies[side] {
                add_product(&own.gains(Stage::End).distortion, &self.flux[1][side], 1.0, &mut self.distortion);
            }
        }
    }
}

/// Mean of `values` weighted with the pressure, or over the contact where there is none.
pub(super) fn weighted(values: &[f64], pressure: &[f64], weights: &[f64]) -> f64 {
    let (mut sum, mut load, mut plain, mut total) = (0.0, 0.0, 0.0, 0.0);
    for i in 0..values.len() {
        sum += weights[i] * pressure[i] * values[i];
        load += weights[i] * pressure[i];
        plain += weights[i] * values[i];
        total += weights[i];
    }
    if load > 0.0 { sum / load } else { plain / total }
}

/// `target += factor matrix values`.
pub(super) fn add_product(matrix: &nalgebra::DMatrix<f64>, values: &[f64], factor: f64, target: &mut [f64]) {
    for (j, value) in values.iter().enumerate() {
        let scaled = factor * value;
        if scaled != 0.0 {
            target.iter_mut().zip(matrix.column(j).iter()).for_each(|(sum, entry)| *sum += scaled * entry);
        }
    }
}

/// Flux (W/m2 of cooled area) into a surface of the temperature `t` by moving air and radiation; K above the reference.
fn cooling(body: &Body, reference: f64, t: f64, ambient: f64, forced: f64) -> f64 {
    let fourth = |t: f64| (t + reference).powi(4);
    (ambient - t) * forced * body.convection_forced + STEFAN_BOLTZMANN * body.emissivity * (fourth(ambient) - fourth(t))
}
