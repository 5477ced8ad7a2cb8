//! A stage of the step with heat: pressure, heat split, wear and rigid motion at once.

use super::bodies::cooled_part;
use super::{Heat, Reference};
use crate::contact::dense;
use crate::contact::friction::FrictionLaw;
use crate::coupled::Inputs;
use crate::coupled::line::Line;
use crate::coupled::line::path::{Moment, Path};
use crate::coupled::lumped::conditions::Conditions;
use crate::coupled::lumped::operators::BodyOperators;
use crate::heat::STEFAN_BOLTZMANN;
use crate::heat::line::{GAMMA, Stage, Surroundings};
use crate::scene::{Body, Scheme};
use crate::wear::line::{Coefficient, StageError, WearTerm};

/// Repetitions until contact and temperature agree; then a shorter step has to help.
const MOST_REPETITIONS: usize = 80;

/// Difference (relative) at which the friction coefficient agrees with the temperature.
const AGREEMENT: f64 = 1e-10;

/// Differences (relative to the largest) at which pressure and heat, and the temperatures of both surfaces agree.
const SAME_PRESSURE: f64 = 1e-9;
const SAME_TEMPERATURE: f64 = 1e-8;

/// Repetition from which on the operators are those of the stage instead of the reference.
const EXACT_FROM: usize = 12;

/// Ratio of successive changes, and repetition, from which on friction that follows the temperature takes its derivative along
/// instead of going on like a geometric series.
const SLOW: f64 = 0.4;
const SLOW_FROM: usize = 3;

/// Part by which velocity or fade may differ from the reference.
const ZONE: f64 = 0.1;

/// Travel within which heat under the contact answers as at the reference, in lengths of diffusion over the step.
const REACH: f64 = 0.25;

/// Changes of the pressure from repetition to repetition.
#[derive(Clone, Copy, Debug, Default)]
struct Convergence {
    last: Option<f64>,
    slow: bool,
}

impl Convergence {
    /// Whether the last change (relative) leaves an error below what counts: the changes fall like a geometric series.
    fn reached(&mut self, change: f64) -> bool {
        let last = self.last.replace(change);
        self.slow = last.is_some_and(|last| change > SLOW * last);
        let error = match last {
            Some(last) if change < 0.5 * last => change * change / (last - change),
            _ => change,
        };
        error <= SAME_PRESSURE
    }
}

impl Line {
    /// Makes the bodies ready for a part of `step` (s) that begins at `start` (s from the start of the piece).
    pub(in crate::coupled::line) fn prepare_heat(&mut self, path: &Path, start: f64, step: f64) {
        let (Some(heat), Some(state)) = (&mut self.heat, &self.state.heat) else { return };
        let velocity = [path.velocity(start), path.velocity(start + step)];
        let operators = &self.operators;
        let reference_velocity = state.reference.choose(velocity, heat.zone(step));
        let key = (step, reference_velocity);
        let monolithic = operators.scene.scheme == Scheme::Monolithic;
        if monolithic && !heat.splits.iter().all(|split| split.is_for(key)) {
            heat.bodies.iter_mut().flatten().for_each(|own| own.prepare(step, [reference_velocity; 2]));
            for stage in [Stage::First, Stage::End] {
                let gains = heat.bodies.each_ref().map(|body| body.as_ref().map(|own| own.gains(stage)));
                heat.splits[stage as usize].build(key, gains);
            }
        }
        heat.renewed = [false; 2];
        let flat = operators.scene.friction_fade.flat;
        let faded = if flat { self.friction.faded(0.0) } else { self.friction.coefficient * state.reference.fade };
        let (stribeck, sign) = (self.friction.stribeck(reference_velocity), self.friction.sign(reference_velocity));
        heat.reference = Reference {
            velocity: reference_velocity,
            exact: flat && velocity == [reference_velocity; 2],
            per_pressure: faded * (stribeck * (sign * reference_velocity)),
            friction: sign.abs() * faded * stribeck,
            speed: sign * reference_velocity,
            faded,
        };
        let reference = self.mean.state().reference;
        let inputs = Inputs::from_array(path.inputs(start + 0.5 * step));
        let conditions = Conditions::new(&operators.mean, &self.tunables, reference, &inputs);
        let scene = &operators.scene;
        (heat.step, heat.velocity) = (step, velocity);
        let far = [conditions.punch_far, conditions.strip_far];
        let each: [(&BodyOperators, &Body, f64); 2] =
            [(&operators.mean.punch, &scene.punch, 1.0), (&operators.mean.strip, &scene.strip, cooled_part(scene))];
        for (side, (mean, body, part)) in each.into_iter().enumerate() {
            let ambient = conditions.ambient;
            let mut around = Surroundings { cooling: state.cooling[side], ambient, far: far[side] };
            if let Some(own) = &mut heat.bodies[side] {
                match monolithic {
                    true => own.prepare(step, velocity),
                    false => own.prepare_euler(step, velocity),
                }
                if mean.variable_cooling {
                    let now = own.cooled_temperature(&state.bodies[side], &around, &state.flux[side]);
                    heat.cooled[side] = now;
                    // The flux of the whole step is that of its middle: as the temperature goes on.
                    let rate = if state.last_step > 0.0 { (now - state.cooled[side]) / state.last_step } else { 0.0 };
                    let t = now + 0.5 * step * rate;
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
        let (start, earlier) = match stage {
            Stage::First => {
                let untouched = self.state.pressure.iter().all(|p| *p == 0.0);
                for (closed, p) in heat.closed.iter_mut().zip(&self.state.pressure) {
                    *closed = *p > 0.0 || untouched;
                }
                heat.flux[s][0].copy_from_slice(&state.flux[0]);
                (&self.state.pressure, &state.temperature)
            }
            Stage::End => {
                let [first, end] = &mut heat.flux;
                end[0].copy_from_slice(&first[0]);
                (&self.work.first.pressure, &heat.temperature[0])
            }
        };
        let status = match stage {
            Stage::First => self.contact.status(),
            Stage::End => heat.contacts[0].status(),
        };
        if moment.load == 0.0 {
            heat.closed.fill(false);
        }
        self.work.status.copy_from(status);
        heat.contacts[s].set_status(&self.work.status);
        heat.pressure.copy_from_slice(start);
        let reference = self.mean.state().reference;
        let stribeck = self.friction.stribeck(velocity);
        let sign = self.friction.sign(velocity);
        let fades = !operators.scene.friction_fade.flat;
        let by_cell = operators.wears_by_cell();
        for i in 0..count {
            heat.felt[i] = 0.5 * (earlier[0][i] + earlier[1][i]) + reference;
            heat.faded[i] = self.friction.faded(heat.felt[i]);
        }
        heat.linearised = false;
        let mut slip = moment.slip(stribeck);
        let mut convergence = Convergence::default();
        for repetition in 0..MOST_REPETITIONS {
            if fades {
                moment.faded = weighted(&heat.faded, &heat.pressure, &operators.weights);
                moment.follow(sign * stribeck);
                slip = moment.slip(stribeck);
            }
            let slow = fades && repetition >= SLOW_FROM && convergence.slow;
            if !heat.renewed[s] && (repetition == EXACT_FROM || slow) {
                heat.renew(stage, slip);
                convergence = Convergence::default();
            }
            heat.operator(stage)?;
            if heat.renewed[s] && fades {
                heat.linearise(stage, slip, &self.friction)?;
            }
            self.set_conditions(moment, tau);
            self.set_laws(heat, moment, by_cell);
            heat.supply(stage, slip, repetition == 0 || fades);
            heat.undeformed(stage, &self.work.gap);
            let uniform = |term: &WearTerm| matches!(term.coefficient, Coefficient::Uniform(_));
            if !heat.exact[s] && self.work.track.is_none() && self.conditions.rate.terms.iter().all(uniform) {
                self.wear_at_reference(heat, moment, tau);
            }
            if !heat.exact[s] && self.conditions.signed_friction != 0.0 && heat.reference.friction != 0.0 {
                // The contact's matrix has the friction coefficient of the reference, every cell its own.
                let known = heat.reference.friction.copysign(self.conditions.signed_friction);
                for i in 0..count {
                    heat.difference[i] = (sign * heat.faded[i] * stribeck - known) * heat.pressure[i];
                }
                heat.contacts[s].add_shear_displacement(&heat.difference, &mut heat.gap);
                self.conditions.signed_friction = known;
            }
            let found = match stage {
                Stage::First => &mut self.work.first,
                Stage::End => &mut self.work.end,
            };
            heat.contacts[s].stage_into(&heat.gap, tau, &self.conditions, found)?;
            let change = heat.take(stage, &found.pressure);
            let mut unlike: f64 = 0.0;
            heat.warm(stage);
            if by_cell || fades {
                for i in 0..count {
                    let [punch, strip] = &heat.temperature[s];
                    let felt = 0.5 * (punch[i] + strip[i]) + reference;
                    unlike = unlike.max((felt - heat.felt[i]).abs() / felt.abs().max(1.0));
                    heat.felt[i] = felt;
                    heat.faded[i] = self.friction.faded(felt);
                }
            }
            let settled = heat.settle(&found.pressure);
            if settled
                && unlike <= AGREEMENT
                && (heat.exact[s] || (convergence.reached(change) && heat.lacks(stage) <= SAME_TEMPERATURE))
            {
                self.finish_stage(heat, stage);
                return Ok(());
            }
        }
        Err(StageError::NotConverged { stage: tau, iterations: MOST_REPETITIONS })
    }

    /// Gives the contact the wear of the reference, whose factors are kept, and the gap what it lacks.
    fn wear_at_reference(&mut self, heat: &mut Heat, moment: &Moment, tau: f64) {
        let operators = &self.operators;
        let acceleration = self.tunables.wear_acceleration;
        let reference =
            operators.coefficients(heat.reference.speed, heat.reference.faded, moment.temperature, acceleration);
        let reshaping = (0..2).filter(|&body| operators.reshapes(body));
        for (term, body) in self.conditions.rate.terms.iter_mut().zip(reshaping) {
            let lacking = tau * (heat.laws[body][0] - reference[body]);
            for (i, gap) in heat.gap.iter_mut().enumerate() {
                *gap += lacking * operators.relative_rate(body, i, heat.pressure[i]);
            }
            term.coefficient = Coefficient::Uniform(reference[body]);
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
            dense::multiply_add(gains.temperature.as_slice(), &heat.difference, &mut heat.sums[0]);
            if heat.expands[side] {
                dense::multiply_add(gains.distortion.as_slice(), &heat.difference, &mut heat.sums[1]);
            }
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

    /// Takes the heat of the part that was tried, of `step` s, with the sliding velocity at its end.
    pub(in crate::coupled::line) fn accept_heat(&mut self, step: f64, velocity: f64) {
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
            for i in 0..heat.closed.len() {
                // No rate where the cell exchanges no heat, or has just begun to.
                let lasting = state.flux[side][i] != 0.0 && heat.flux[1][side][i] != 0.0;
                let change = heat.flux[1][side][i] - heat.flux[0][side][i];
                state.slope[side][i] = if lasting { change / ((1.0 - GAMMA) * step) } else { 0.0 };
            }
            state.flux[side].copy_from_slice(&heat.flux[1][side]);
            state.temperature[side].copy_from_slice(&heat.temperature[1][side]);
            state.cooling[side] = heat.surroundings[side].cooling;
        }
        (state.cooled, state.last_step) = (heat.cooled, step);
        state.distortion.copy_from_slice(&heat.distortion);
        state.faded = weighted(&heat.faded, &self.work.end.pressure, &operators.weights);
        (state.reference.velocity, state.reference.last) = (heat.reference.velocity, velocity);
        let fade = if self.friction.coefficient > 0.0 { state.faded / self.friction.coefficient } else { 1.0 };
        if (fade / state.reference.fade - 1.0).abs() > ZONE {
            state.reference.fade = fade;
        }
    }
}

impl Heat {
    /// Difference of velocity (m/s) that hardly changes how a step of `step` s answers heat.
    fn zone(&self, step: f64) -> f64 {
        REACH * (self.diffusivity / step).sqrt()
    }

    /// Temperature and distortion of both bodies at the stage if no heat came in it.
    pub(super) fn begin(&mut self, stage: Stage, state: &super::state::HeatState) {
        for side in 0..2 {
            let (base, distortion) = (&mut self.base[side], &mut self.base_distortion[side]);
            match &self.bodies[side] {
                Some(own) => {
                    let around = &self.surroundings[side];
                    let known = &mut self.flux[0][side];
                    if stage == Stage::First {
                        let back = -GAMMA * self.step;
                        known.iter_mut().zip(&state.slope[side]).for_each(|(value, slope)| *value = back * slope);
                    }
                    own.base(&state.bodies[side], around, stage, known, base, distortion);
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

    /// Puts the distortion by the stage's own heat, at the reference, on the contact's compliance.
    fn operator(&mut self, stage: Stage) -> Result<(), StageError> {
        let s = stage as usize;
        self.splits[s].close(&self.closed);
        let per_pressure = self.reference.per_pressure;
        if !self.renewed[s]
            && let Some(extra) = self.splits[s].extra(per_pressure)
        {
            self.contacts[s].set_extra(Some(extra))?;
        }
        Ok(())
    }

    /// Makes the operators of the stage's own gains and friction, where those of the reference do not converge.
    fn renew(&mut self, stage: Stage, slip: f64) {
        let s = stage as usize;
        let gains = self.bodies.each_ref().map(|body| body.as_ref().map(|own| own.gains(stage)));
        self.splits[s].build((f64::NAN, f64::NAN), gains);
        if let Some(fading) = &mut self.fading {
            fading.build(&self.splits[s], gains, self.half_resistance);
        }
        let mean = self.faded.iter().sum::<f64>() / self.faded.len() as f64;
        if let Some(extra) = self.splits[s].extra(mean * slip) {
            // Gains are finite, and so is their product with a velocity.
            let _ = self.contacts[s].set_extra(Some(extra));
        }
        self.renewed[s] = true;
    }

    /// Takes into the operators of the stage that friction follows the temperature.
    fn linearise(&mut self, stage: Stage, slip: f64, friction: &FrictionLaw) -> Result<(), StageError> {
        let s = stage as usize;
        let Some(fading) = &mut self.fading else { return Ok(()) };
        let (closed, pressure) = (&self.closed, &self.pressure);
        let (faded, felt) = (&self.faded, &self.felt);
        let heat = fading.linearise(
            |i| if closed[i] { slip * faded[i] } else { 0.0 },
            |i| if closed[i] { slip * pressure[i] * friction.fall(felt[i]) } else { 0.0 },
        );
        self.contacts[s].set_extra(Some(self.splits[s].extra_by(heat)))?;
        self.linearised = true;
        Ok(())
    }

    /// Friction heat of the stage with the pressure known so far, and the split of it in which both surfaces agree; `fresh`
    /// where the temperatures are not those of these fluxes.
    pub(super) fn supply(&mut self, stage: Stage, slip: f64, fresh: bool) {
        let s = stage as usize;
        let conducts = self.conducts();
        self.exact[s] = self.reference.exact && !self.renewed[s];
        for i in 0..self.closed.len() {
            self.per_pressure[i] = self.faded[i] * slip;
            self.exact[s] &= self.closed[i] && self.per_pressure[i] == self.reference.per_pressure;
            self.friction[s][i] = if self.closed[i] { self.per_pressure[i] * self.pressure[i] } else { 0.0 };
        }
        let [punch, strip] = &mut self.flux[s];
        for i in 0..self.closed.len() {
            let heat = self.friction[s][i];
            punch[i] = match conducts {
                _ if !self.closed[i] => 0.0,
                [true, true] if self.half_resistance > 0.0 => punch[i],
                [true, true] => 0.5 * heat,
                [true, false] => heat,
                [false, _] => 0.0,
            };
            strip[i] = if conducts[1] { heat - punch[i] } else { 0.0 };
        }
        if conducts == [true, true] && self.half_resistance > 0.0 {
            if fresh {
                self.warm(stage);
            }
            self.lacking(stage);
            let [punch, strip] = &mut self.flux[s];
            self.splits[s].exchange(&self.difference, punch);
            for i in 0..self.closed.len() {
                strip[i] = self.friction[s][i] - punch[i];
            }
        }
    }

    /// Temperature by which the punch's surface is too cold for its flux, cell by cell, in `difference`.
    fn lacking(&mut self, stage: Stage) {
        let s = stage as usize;
        let ([punch, strip], [punch_flux, strip_flux]) = (&self.temperature[s], &self.flux[s]);
        for i in 0..self.closed.len() {
            self.difference[i] = if self.closed[i] {
                strip[i] - punch[i] + self.half_resistance * (strip_flux[i] - punch_flux[i])
            } else {
                0.0
            };
        }
    }

    /// How far the surfaces are from the law of the interface, relative to the largest rise and jump of temperature.
    fn lacks(&mut self, stage: Stage) -> f64 {
        let s = stage as usize;
        if self.conducts() != [true, true] || self.half_resistance == 0.0 {
            return 0.0;
        }
        self.lacking(stage);
        let largest = |values: &[f64]| values.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
        let scale = (largest(&self.temperature[s][0]).max(largest(&self.temperature[s][1])))
            .max(self.half_resistance * largest(&self.friction[s]));
        if scale > 0.0 { largest(&self.difference) / scale } else { 0.0 }
    }

    /// The gap with everything that moves it, less what the pressure known so far does through the contact's extra
    /// compliance.
    fn undeformed(&mut self, stage: Stage, gap: &[f64]) {
        let s = stage as usize;
        for (i, target) in self.gap.iter_mut().enumerate() {
            *target = gap[i] + self.base_distortion[0][i] + self.base_distortion[1][i];
            self.difference[i] = -self.pressure[i];
        }
        dense::multiply_add(self.splits[s].extra_values(), &self.difference, &mut self.gap);
        for side in 0..2 {
            if let (Some(own), true) = (&self.bodies[side], self.expands[side]) {
                dense::multiply_add(own.gains(stage).distortion.as_slice(), &self.flux[s][side], &mut self.gap);
            }
        }
    }

    /// Takes the pressure found, with its share of heat; returns how much it differs from the one known before, relative to
    /// the largest.
    fn take(&mut self, stage: Stage, pressure: &[f64]) -> f64 {
        let s = stage as usize;
        let (mut change, mut largest): (f64, f64) = (0.0, 0.0);
        for i in 0..pressure.len() {
            let difference = pressure[i] - self.pressure[i];
            change = change.max(difference.abs());
            largest = largest.max(pressure[i]).max(self.pressure[i]);
            let heat = if self.closed[i] { self.per_pressure[i] * pressure[i] } else { 0.0 };
            self.gap[i] = difference;
            self.difference[i] = heat - self.friction[s][i];
            self.pressure[i] = pressure[i];
        }
        if let (Some(fading), true) = (&self.fading, self.linearised) {
            // The temperature that follows is that of the friction at that temperature.
            self.difference.fill(0.0);
            fading.add_heat(&self.gap, &mut self.difference);
        }
        for (friction, more) in self.friction[s].iter_mut().zip(&self.difference) {
            *friction += more;
        }
        let conducts = self.conducts();
        let [punch, strip] = &mut self.flux[s];
        match conducts {
            [true, true] => self.splits[s].share(&self.difference, punch),
            [true, false] => punch.copy_from_slice(&self.friction[s]),
            [false, _] => {}
        }
        for i in 0..pressure.len() {
            strip[i] = if conducts[1] { self.friction[s][i] - punch[i] } else { 0.0 };
        }
        if largest > 0.0 { change / largest } else { 0.0 }
    }

    /// Temperatures of both surfaces by their fluxes.
    pub(super) fn warm(&mut self, stage: Stage) {
        let s = stage as usize;
        for side in 0..2 {
            let temperature = &mut self.temperature[s][side];
            temperature.copy_from_slice(&self.base[side]);
            if let Some(own) = &self.bodies[side] {
                dense::multiply_add(own.gains(stage).temperature.as_slice(), &self.flux[s][side], temperature);
            }
        }
        // An insulator's surface follows from the second law of the interface.
        let conducts = self.conducts();
        if let [true, false] | [false, true] = conducts {
            let own = usize::from(!conducts[1]);
            for i in 0..self.closed.len() {
                if self.closed[i] && self.half_resistance > 0.0 {
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
            if let (Some(own), true) = (&self.bodies[side], self.expands[side]) {
                dense::multiply_add(
                    own.gains(Stage::End).distortion.as_slice(),
                    &self.flux[1][side],
                    &mut self.distortion,
                );
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

/// Flux (W/m2 of cooled area) into a surface of the temperature `t` by moving air and radiation; K above the reference.
fn cooling(body: &Body, reference: f64, t: f64, ambient: f64, forced: f64) -> f64 {
    let fourth = |t: f64| (t + reference).powi(4);
    (ambient - t) * forced * body.convection_forced + STEFAN_BOLTZMANN * body.emissivity * (fourth(ambient) - fourth(t))
}
