//! Unknowns of both stages of a step: heat, its partition, friction, pressure and wear.
//!
//! Theory: docs/theory.md, sections 6.8, 7.2.

use super::bristle::{Bristle, Line, Moved};
use super::conditions::Conditions;
use super::estimate::layer_allowance;
use super::flash_step::FlashStep;
use super::interface::agree;
use super::operators::BodyOperators;
use super::stage::{BASIS, QUADRATURE};
use super::stage_body::StageBody;
use super::stage_partition::StageHeatPartition;
use super::state::{BodyState, LumpedState};
use super::stepper::Stepper;
use numerics::maximum::maximum;

/// Unknowns of the two stages.
pub struct Stages {
    pub pressure: [f64; 2],
    /// Friction heat flux.
    pub heat: [f64; 2],
    /// Mean contact temperature, K above the reference.
    pub temperature: [f64; 2],
    pub kinetic_coefficient: [f64; 2],
    /// Wear rates of punch and strip at the stages.
    pub rates: [[f64; 2]; 2],
    /// Wear depths by the slip that a bristle without damper releases at the start of the step, m.
    pub released_wear: [f64; 2],
    /// Gain of the strip's contact temperature including its moving source.
    strip_gain: [[f64; 2]; 3],
    pub partition: StageHeatPartition,
    /// s v Stribeck at the stages: heat per kinetic friction coefficient and pressure.
    driver: [f64; 2],
    /// Sliding speed in the wear law, without what a bristle releases.
    speed: [f64; 2],
    pub bristle: Option<Bristle>,
    deflection_at_start: f64,
    /// Result of the bristle over the step.
    pub moved: Moved,
    velocity: Line,
    stribeck: [f64; 2],
    given_load: [f64; 2],
    reference: f64,
}

impl Stages {
    pub fn new(
        stepper: &Stepper,
        state: &LumpedState,
        conditions: &[Conditions; 4],
        punch: &StageBody,
        strip: &StageBody,
    ) -> Stages {
        let operators = stepper.operators;
        let mut strip_gain = stepper.propagators.strip.map_or([[0.0; 2]; 3], |propagator| propagator.contact.gain[0]);
        if operators.flash.is_some() {
            for (gain, extra) in strip_gain.iter_mut().zip(&stepper.flash.gain) {
                gain[0] += extra[0];
                gain[1] += extra[1];
            }
        }
        let (first, last) = (&conditions[1], &conditions[3]);
        // The load does not change its sign within a piece: its middle determines whether the contact is closed.
        let closed = conditions[2].load > 0.0;
        let partition = StageHeatPartition::new(punch, strip, &strip_gain, operators.scene.conductance, closed);
        let loads = [first.load, last.load];
        let power = operators.power_factor;
        Stages {
            pressure: if closed { loads.map(|load| load / operators.area) } else { [0.0; 2] },
            heat: [0.0; 2],
            temperature: [0.0; 2],
            kinetic_coefficient: [stepper.friction.kinetic_coefficient(state.end_temperature + state.reference); 2],
            rates: [[0.0; 2]; 2],
            released_wear: [0.0; 2],
            strip_gain,
            partition,
            driver: [first.stribeck * first.slip * power, last.stribeck * last.slip * power],
            speed: [first.slip, last.slip],
            bristle: operators.bristle(state.stiffness),
            deflection_at_start: state.bristle,
            moved: Moved::none(state.bristle),
            velocity: Line {
                start: conditions[0].velocity,
                rate: (conditions[3].velocity - conditions[0].velocity) / stepper.propagators.step,
            },
            stribeck: [first.stribeck, last.stribeck],
            given_load: if closed { loads } else { [0.0; 2] },
            reference: state.reference,
        }
    }

    /// Contact load behind a caliper: wear reduces it, expansion increases it.
    pub fn loads(&mut self, stepper: &Stepper, state: &LumpedState, punch: &StageBody, strip: &StageBody) {
        let operators = stepper.operators;
        if operators.series_stiffness == 0.0 {
            return;
        }
        let step = stepper.propagators.step;
        // Radau IIA coefficients: integrals of the stage rates up to the stage points.
        const STAGE: [[f64; 2]; 2] = [[5.0 / 12.0, -1.0 / 12.0], [0.75, 0.25]];
        let coverage = operators.scene.coverage();
        for stage in 0..2 {
            let worn = |body: usize| {
                step * (STAGE[stage][0] * self.rates[body][0] + STAGE[stage][1] * self.rates[body][1])
                    + self.released_wear[body]
            };
            let expansion = |body: &StageBody, state: &BodyState| match (body.propagator, &body.body.heat) {
                (Some(propagator), Some(heat)) => {
                    body.body.expansion
                        * (propagator.mean.of_states(2 * stage, &state.heat, heat.count)
                            + body.add(|propagator| &propagator.mean, 2 * stage))
                }
                _ => 0.0,
            };
            let closed = state.punch.depth + worn(0) + state.strip.depth + coverage * worn(1)
                - expansion(punch, &state.punch)
                - expansion(strip, &state.strip);
            let load = if self.given_load[stage] > 0.0 {
                (self.given_load[stage] - operators.series_stiffness * closed).max(0.0)
            } else {
                0.0
            };
            self.pressure[stage] = load / operators.area;
        }
    }

    /// One iteration of heat, its partition and friction at both stages for the current cooling and pressure; returns the largest
    /// change of temperature, 0 where no further iteration is needed.
    pub fn solve(&mut self, stepper: &Stepper, punch: &mut StageBody, strip: &mut StageBody) -> f64 {
        let conductance = stepper.operators.scene.conductance;
        let closed = if stepper.operators.series_stiffness > 0.0 {
            self.pressure[0] + self.pressure[1] > 0.0
        } else {
            self.partition.closed
        };
        let before = self.temperature;
        if closed != self.partition.closed {
            self.partition = StageHeatPartition::new(punch, strip, &self.strip_gain, conductance, closed);
        }
        self.partition.levels(punch, strip);
        if self.bristle.is_some() {
            self.slide_bristle(stepper);
        } else if stepper.friction.fade.flat {
            for stage in 0..2 {
                self.heat[stage] = self.kinetic_coefficient[stage] * self.driver[stage] * self.pressure[stage];
            }
        } else {
            let none = self.partition.temperatures(&self.partition.fluxes([0.0; 2]));
            // The temperature is affine in the heats: columns of its gain, then the consistent friction stage by stage.
            let columns =
                [[1.0, 0.0], [0.0, 1.0]].map(|unit| self.partition.temperatures(&self.partition.fluxes(unit)));
            for _ in 0..60 {
                let old = self.heat;
                for stage in 0..2 {
                    let other = 1 - stage;
                    let power = self.driver[stage] * self.pressure[stage];
                    let level = none[stage] + (columns[other][stage] - none[stage]) * self.heat[other];
                    let gain = (columns[stage][stage] - none[stage]).max(0.0) * power;
                    let temperature = agree(stepper.friction, level + self.reference, gain);
                    self.kinetic_coefficient[stage] = stepper.friction.kinetic_coefficient(temperature);
                    self.heat[stage] = self.kinetic_coefficient[stage] * power;
                }
                if (0..2).all(|stage| (self.heat[stage] - old[stage]).abs() <= 1e-13 * self.heat[stage].abs()) {
                    break;
                }
            }
        }
        let fluxes = self.partition.fluxes(self.heat);
        self.temperature = self.partition.temperatures(&fluxes);
        punch.flux[0] = fluxes.map(|flux| flux.0);
        strip.flux[0] = fluxes.map(|flux| flux.1);
        let fades = !stepper.friction.fade.flat;
        if self.bristle.is_some() && fades {
            // In slip the heat of a stage is proportional to its friction coefficient: the consistent one of both is the next iterate.
            let none = self.partition.temperatures(&self.partition.fluxes([0.0; 2]));
            for stage in 0..2 {
                let unit = [0, 1].map(|other| f64::from(u8::from(other == stage)));
                let gain = (self.partition.temperatures(&self.partition.fluxes(unit))[stage] - none[stage]).max(0.0);
                let (heat, coefficient) = (self.heat[stage], self.kinetic_coefficient[stage]);
                let per_coefficient = if coefficient > 0.0 { gain * heat / coefficient } else { 0.0 };
                let level = self.temperature[stage] + self.reference - per_coefficient * coefficient;
                let temperature = agree(stepper.friction, level, per_coefficient);
                self.kinetic_coefficient[stage] = stepper.friction.kinetic_coefficient(temperature);
            }
        }
        let caliper = stepper.operators.series_stiffness > 0.0;
        if caliper {
            self.wear(stepper);
        }
        // The change by cooling is returned separately; caliper and bristle depend on this solution.
        let feeds_back = caliper || self.bristle.is_some() && fades;
        if !feeds_back {
            return 0.0;
        }
        maximum((self.temperature[0] - before[0]).abs(), (self.temperature[1] - before[1]).abs())
    }

    /// Advances the bristle over the whole step, with its limit linear through both stages: in continuous sliding its heat equals
    /// that of the friction law without a bristle. Heat and slip speed at the stages are those of the instants, scaled to the
    /// heat and the slip over the step; what is released at once is spread over the step.
    fn slide_bristle(&mut self, stepper: &Stepper) {
        let Some(bristle) = self.bristle else { return };
        let (operators, step) = (stepper.operators, stepper.propagators.step);
        let limits = [0, 1].map(|stage| {
            self.limit(stepper, self.kinetic_coefficient[stage], self.stribeck[stage], self.pressure[stage])
        });
        let limit = Line::through_stages(limits, step);
        self.moved = bristle.advance(self.deflection_at_start, self.velocity, limit, step);
        let (moved, released) = (&self.moved, &self.moved.released);
        let flux = 1.0 / (operators.scene.faces * operators.area);
        self.heat = scaled([moved.power[0], moved.power[2]], (moved.heat - released.heat).max(0.0) / step)
            .map(|power| (power + released.heat / step) * flux);
        self.speed = scaled([moved.speed[0], moved.speed[2]], (moved.slipped - released.slipped).max(0.0) / step);
    }

    /// Limit force of the bristle, N, all faces together.
    fn limit(&self, stepper: &Stepper, kinetic_coefficient: f64, stribeck: f64, pressure: f64) -> f64 {
        let operators = stepper.operators;
        kinetic_coefficient * stribeck * pressure * operators.power_factor * operators.scene.faces * operators.area
    }

    /// Deviation of the bristle's heat from the quadrature of its powers at the stages, as a flux (W/m2): by transitions between
    /// sticking and slipping, and by what is released at the start of the step.
    fn unevenness(&self, stepper: &Stepper) -> [f64; 2] {
        let Some(bristle) = &self.bristle else { return [0.0; 2] };
        let operators = stepper.operators;
        let (moved, step) = (&self.moved, stepper.propagators.step);
        let mean = (moved.heat - moved.released.heat) / step;
        // The heat is a difference of stored energies, which in a short step is that of their rounding.
        let rounding = 4.0 * f64::EPSILON * bristle.stiffness * self.deflection_at_start.powi(2) / step;
        let transitions = (QUADRATURE[0] * moved.power[0] + QUADRATURE[1] * moved.power[2] - mean).abs();
        let transitions = (transitions - rounding).max(0.0);
        [transitions, moved.released.heat / step].map(|power| power / (operators.scene.faces * operators.area))
    }

    /// Largest friction heat flux of the stages, W/m2. What is released at the start counts as spread over the whole piece: in a short
    /// step its flux is large, and says nothing about the heat of the piece.
    pub fn largest_heat(&self, stepper: &Stepper) -> f64 {
        let [_, released] = self.unevenness(stepper);
        let largest = maximum(self.heat[0].abs(), self.heat[1].abs());
        largest - released + released / stepper.cut
    }

    /// Wear rates at the stages. The slip that a bristle releases at once wears as if it took the whole piece: the law knows no wear
    /// at infinite speed.
    pub fn wear(&mut self, stepper: &Stepper) {
        let operators = stepper.operators;
        let released = self.moved.released.slipped;
        if self.bristle.is_some() {
            let length = stepper.cut * stepper.propagators.step;
            let pressure = (1.5 * self.pressure[0] - 0.5 * self.pressure[1]).max(0.0);
            self.released_wear = [&operators.punch, &operators.strip].map(|body| {
                let temperature = self.temperature[0] + self.reference;
                let rate = body.wear.rate(pressure, released / length, self.kinetic_coefficient[0], temperature);
                length * rate * (body.wear_factor * stepper.tunables.wear_acceleration)
            });
        }
        // Where all arguments agree one rate is valid for both stages.
        let same = self.pressure[0] == self.pressure[1]
            && self.speed[0] == self.speed[1]
            && self.kinetic_coefficient[0] == self.kinetic_coefficient[1]
            && !operators.wear_follows_temperature;
        for stage in 0..2 {
            if stage == 1 && same {
                for rates in &mut self.rates {
                    rates[1] = rates[0];
                }
                return;
            }
            for (body, rates) in [&operators.punch, &operators.strip].into_iter().zip(&mut self.rates) {
                rates[stage] = body.wear.rate(
                    self.pressure[stage],
                    self.speed[stage],
                    self.kinetic_coefficient[stage],
                    self.temperature[stage] + self.reference,
                ) * (body.wear_factor * stepper.tunables.wear_acceleration);
            }
        }
    }

    /// Adds the moving source to the strip's gain at the point 2/3, which [`Stages::error`] needs.
    pub fn take_middle(&mut self, strip: &StageBody, flash: &FlashStep) {
        let own = strip.gain(1);
        self.strip_gain[1] = [own[0] + flash.gain[1][0], own[1] + flash.gain[1][1]];
    }

    /// Upper bound of [`Stages::error`] without a third point: at constant conditions the fluxes relax, and the deviation of a
    /// relaxing flux from the line through both stages is at most half their difference. Infinite where that does not hold.
    pub fn bound(&self, stepper: &Stepper, state: &LumpedState, constant: bool, punch: &StageBody) -> f64 {
        let operators = stepper.operators;
        if !constant || operators.series_stiffness > 0.0 || operators.wear_follows_temperature {
            return f64::INFINITY;
        }
        let partition = (punch.flux[0][1] - punch.flux[0][0]).abs();
        let heat = (self.heat[1] - self.heat[0]).abs() + 2.0 * self.unevenness(stepper).iter().sum::<f64>();
        let scale = self.flux_scale(stepper, state, punch);
        let exchange = if self.partition.closed && operators.scene.conductance > 0.0 {
            // The resistance increases during the step: at its end it bounds that at the point 2/3.
            let (gain, strip_gain) = (punch.gain(2), self.strip_gain[2]);
            partition
                / layer_allowance(
                    1.0 / operators.scene.conductance + gain[0] + gain[1] + strip_gain[0] + strip_gain[1],
                    scale,
                    state,
                )
        } else {
            partition
        };
        let defect = 0.5 * (exchange + heat);
        defect / (operators.budget.steps.lumped_flux * scale)
    }

    /// Scale of errors of the flux, W/m2.
    fn flux_scale(&self, stepper: &Stepper, state: &LumpedState, punch: &StageBody) -> f64 {
        let heat = self.largest_heat(stepper);
        let exchanged = 0.1 * maximum(punch.flux[0][0].abs(), punch.flux[0][1].abs());
        maximum(heat, exchanged).max(0.02 * state.peak_flux).max(stepper.operators.least_flux)
    }

    /// Error of the step in units of the tolerance, from the residual of the contact conditions at the point 2/3.
    pub fn error(
        &self,
        stepper: &Stepper,
        state: &LumpedState,
        conditions: &[Conditions; 4],
        punch: &StageBody,
        strip: &StageBody,
        constant: bool,
    ) -> f64 {
        let operators = stepper.operators;
        let steps = &stepper.operators.budget.steps;
        let middle = &conditions[2];
        let between = |values: [f64; 2]| BASIS[1][0] * values[0] + BASIS[1][1] * values[1];
        let pressure =
            if operators.series_stiffness > 0.0 { between(self.pressure) } else { middle.load / operators.area };
        let heats = between(self.heat);
        let into_punch = between(punch.flux[0]);
        let into_strip = between(strip.flux[0]);
        let punch_temperature = punch.contact(1);
        let strip_temperature = strip.contact_level(1)
            + self.strip_gain[1][0] * strip.flux[0][0]
            + self.strip_gain[1][1] * strip.flux[0][1];
        let temperature = {
            let surfaces = [punch_temperature, strip_temperature];
            let [punch, strip] = self.partition.beside_insulator(surfaces, (into_punch, into_strip));
            0.5 * (punch + strip)
        };
        let scale = self.flux_scale(stepper, state, punch);
        let (mut exchange, mut defect) = (0.0, 0.0);
        let conductance = operators.scene.conductance;
        let both = punch.propagator.is_some() && strip.propagator.is_some();
        if both && conductance > 0.0 && self.partition.closed {
            let gain = punch.gain(1);
            let strip_gain = self.strip_gain[1];
            let resistance = 1.0 / conductance + gain[0] + gain[1] + strip_gain[0] + strip_gain[1];
            let jump = punch_temperature - strip_temperature - 0.5 * (into_strip - into_punch) / conductance;
            // Transitions between sticking and slipping cause thermal layers in the middle of a step.
            let is_layer = constant || self.bristle.is_none() && !stepper.touches_down();
            let allowance = if is_layer { layer_allowance(resistance, scale, state) } else { 0.5 };
            exchange = jump.abs() / (resistance * allowance);
        }
        let kinetic_coefficient = stepper.friction.kinetic_coefficient(temperature + self.reference);
        if self.bristle.is_some() {
            let limit = |kinetic_coefficient: f64, stribeck: f64, pressure: f64| {
                self.limit(stepper, kinetic_coefficient, stribeck, pressure)
            };
            let straight = between(
                [0, 1].map(|stage| limit(self.kinetic_coefficient[stage], self.stribeck[stage], self.pressure[stage])),
            );
            let excess = (limit(kinetic_coefficient, middle.stribeck, pressure) - straight) * self.moved.speed[1];
            let power = self.moved.power;
            let bent = (power[1] + excess - between([power[0], power[2]])) / (operators.scene.faces * operators.area);
            // A transition between sticking and slipping only affects its own part: relative to the heat of the whole piece, it
            // is weighted by duration. A release has the same heat in a part of any duration, and is displaced within it.
            let [transitions, released] = self.unevenness(stepper);
            defect += (bent.abs() + transitions + released / stepper.cut) / stepper.cut;
        } else {
            let heat = kinetic_coefficient * middle.stribeck * middle.slip * operators.power_factor * pressure;
            defect += (heat - heats).abs();
        }
        // The residual overestimates the error of the mean flux, for which the Radau quadrature has two orders more. Changes
        // during the step persist after it, hence the larger factor.
        let defect = if constant { exchange + defect } else { 2.0 * exchange + 4.0 * defect };
        let mut error = defect / (steps.lumped_flux * scale);
        if !constant && operators.flash.is_some() {
            error = maximum(error, stepper.flash.error(strip.flux[0], steps.whole, state.peak_rise));
        }
        // At constant conditions only the temperature can change the wear rate.
        let changes = !constant || operators.series_stiffness > 0.0 || operators.wear_follows_temperature;
        if self.bristle.is_some() || changes {
            for (body, rates) in [&operators.punch, &operators.strip].into_iter().zip(&self.rates) {
                if body.wear.active() {
                    error = maximum(error, self.wear_error(stepper, conditions, body, rates, state.peak_wear));
                }
            }
        }
        error
    }

    /// Third difference of the wear rate, which is the quadrature error, in units of the tolerance.
    fn wear_error(
        &self,
        stepper: &Stepper,
        conditions: &[Conditions; 4],
        body: &BodyOperators,
        rates: &[f64; 2],
        peak: f64,
    ) -> f64 {
        let operators = stepper.operators;
        let mut speeds = [0, 1, 2, 3].map(|index: usize| conditions[index].slip);
        let mut uneven = 0.0;
        if self.bristle.is_some() {
            let [first, second, last] = self.moved.speed;
            speeds = [(2.0 * first - second).max(0.0), self.speed[0], second, self.speed[1]];
            let mean = (self.moved.slipped - self.moved.released.slipped) / stepper.propagators.step;
            let left = (QUADRATURE[0] * first + QUADRATURE[1] * last - mean).abs();
            uneven = left / mean.max(first).max(last).max(f64::MIN_POSITIVE) * rates[0].max(rates[1]);
        }
        let rate = |index: usize, pressure: f64, stages: [f64; 2]| {
            let between = |values: [f64; 2]| stages[0] * values[0] + stages[1] * values[1];
            body.wear.rate(
                pressure,
                speeds[index],
                between(self.kinetic_coefficient),
                between(self.temperature) + self.reference,
            ) * (body.wear_factor * stepper.tunables.wear_acceleration)
        };
        let caliper = operators.series_stiffness > 0.0;
        let pressure = |index: usize, stages: [f64; 2]| {
            if caliper {
                (stages[0] * self.pressure[0] + stages[1] * self.pressure[1]).max(0.0)
            } else {
                if self.partition.closed { conditions[index].load / operators.area } else { 0.0 }
            }
        };
        // Linear extrapolation of the stage values to the start and to the point 2/3.
        let (start, middle) = ([1.5, -0.5], BASIS[1]);
        let others = [rate(0, pressure(0, start), start), rate(2, pressure(2, middle), middle)];
        let end = (self.kinetic_coefficient[1], self.temperature[1] + self.reference);
        stepper.wear_error(body, rates, others, uneven, end, peak)
    }

    /// Highest surface temperature at the end of the step, K above the reference.
    pub fn hottest(&self, punch: &StageBody, strip: &StageBody) -> f64 {
        let strip_temperature = strip.contact_level(2)
            + self.strip_gain[2][0] * strip.flux[0][0]
            + self.strip_gain[2][1] * strip.flux[0][1];
        let into = (punch.flux[0][1], strip.flux[0][1]);
        let [punch, strip] = self.partition.beside_insulator([punch.contact(2), strip_temperature], into);
        maximum(punch, strip)
    }
}

/// Stage values proportional to `values`, with the mean `mean` over the step.
fn scaled(values: [f64; 2], mean: f64) -> [f64; 2] {
    let own = QUADRATURE[0] * values[0] + QUADRATURE[1] * values[1];
    if own > 0.0 { values.map(|value| value * (mean / own)) } else { [mean; 2] }
}
