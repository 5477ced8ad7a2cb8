//! Unknowns of both stages of a step: heat, its partition, friction, pressure and wear.
//!
//! Theory: docs/theory.md, sections 6.8, 7.2.

use super::bristle::{Bristle, Line, Moved};
use super::conditions::Conditions;
use super::estimate::layer_allowance;
use super::interface::agree;
use super::operators::BodyOperators;
use super::stage::{BASIS, Pair, QUADRATURE, apply, inverse};
use super::stage_body::StageBody;
use super::stage_partition::{Response, StageHeatPartition};
use super::state::LumpedState;
use super::stepper::Stepper;
use contact::friction::OperatingPoint;
use numerics::maximum::maximum;
use scene::FadeLine;

/// Unknowns of the two stages; `COMMON` as in [`Stepper::attempt`].
#[derive(Clone, Copy)]
pub(crate) struct Stages<const COMMON: bool> {
    pub pressure: Pair,
    /// Friction heat flux.
    pub heat: Pair,
    /// Mean contact temperature, K above the reference.
    pub temperature: Pair,
    pub kinetic_coefficient: Pair,
    /// Wear rates of punch and strip at the stages.
    pub rates: [Pair; 2],
    /// Wear depths by the slip that a bristle without damper releases at the start of the step, m.
    pub released_wear: [f64; 2],
    /// Surface temperatures of punch and strip at the stages, K above the reference.
    pub surfaces: [Pair; 2],
    pub closed: bool,
    partition: StageHeatPartition,
    /// Fade table on the piece of the last temperature.
    fade: FadeLine,
    /// s v Stribeck at the stages: heat per kinetic friction coefficient and pressure.
    driver: Pair,
    /// Sliding speed in the wear law, without what a bristle releases.
    speed: Pair,
    pub bristle: Option<Bristle>,
    deflection_at_start: f64,
    /// Result of the bristle over the step.
    pub moved: Moved,
    velocity: Line,
    pub stribeck: Pair,
    given_load: Pair,
    reference: f64,
}

impl<const COMMON: bool> Stages<COMMON> {
    #[inline(always)]
    pub(crate) fn new(stepper: &Stepper, state: &LumpedState, conditions: [&Conditions; 4]) -> Self {
        let operators = stepper.operators;
        let [start, first, middle, last] = conditions;
        // The load does not change its sign within a piece: its middle determines whether the contact is closed.
        let closed = middle.load > 0.0;
        let loads = [first.load, last.load];
        let power = operators.power_factor;
        let temperature = state.end_temperature + state.reference;
        let fade = stepper.friction.fade.line(temperature);
        let open = Response { level: [0.0; 2], gain: [[0.0; 2]; 2] };
        Stages {
            pressure: if closed { [loads[0] / operators.area, loads[1] / operators.area] } else { [0.0; 2] },
            heat: [0.0; 2],
            temperature: [0.0; 2],
            kinetic_coefficient: [stepper.friction.coefficient * fade.factor(temperature); 2],
            rates: [[0.0; 2]; 2],
            released_wear: [0.0; 2],
            surfaces: [[0.0; 2]; 2],
            closed,
            partition: StageHeatPartition::new([open; 2], [false; 2], 0.0, false),
            fade,
            driver: [first.stribeck * first.slip * power, last.stribeck * last.slip * power],
            speed: [first.slip, last.slip],
            bristle: if COMMON { None } else { operators.bristle(state.stiffness) },
            deflection_at_start: state.bristle,
            moved: Moved::none(state.bristle),
            velocity: Line {
                start: start.velocity,
                rate: if COMMON { 0.0 } else { (last.velocity - start.velocity) / stepper.propagators.step },
            },
            stribeck: [first.stribeck, last.stribeck],
            given_load: if closed { loads } else { [0.0; 2] },
            reference: state.reference,
        }
    }

    /// Whether wear and expansion change the load.
    #[inline(always)]
    pub(crate) fn has_caliper(stepper: &Stepper) -> bool {
        !COMMON && stepper.operators.series_stiffness > 0.0
    }

    /// Whether there is a bristle; a constant in the common form, in which the compiler then keeps no unknown in memory.
    #[inline(always)]
    pub(crate) fn has_bristle(&self) -> bool {
        !COMMON && self.bristle.is_some()
    }

    /// Friction heats (W/m2) at the friction coefficients known so far.
    #[inline(always)]
    pub(crate) fn expected_heat(&self) -> Pair {
        let at = |stage: usize| self.kinetic_coefficient[stage] * self.driver[stage] * self.pressure[stage];
        [at(0), at(1)]
    }

    /// Contact load behind a caliper: wear reduces it, expansion increases it. Friction follows it.
    #[inline(never)]
    pub(crate) fn loads(
        &mut self,
        stepper: &Stepper,
        state: &LumpedState,
        stages: [&Conditions; 2],
        punch: &StageBody<COMMON>,
        strip: &StageBody<COMMON>,
    ) {
        self.pressure =
            [0, 2].map(|point| self.behind_caliper(stepper, state, [punch, strip], point, self.given_load[point / 2]));
        let operators = stepper.operators;
        self.stribeck = [0, 1].map(|stage| operators.stribeck(stages[stage], self.pressure[stage]));
        self.driver = [0, 1].map(|stage| self.stribeck[stage] * stages[stage].slip * operators.power_factor);
    }

    /// Pressure (Pa) behind a caliper at a point (1/3, 2/3, 1) where the actuator gives the load `given`, N.
    fn behind_caliper(
        &self,
        stepper: &Stepper,
        state: &LumpedState,
        [punch, strip]: [&StageBody<COMMON>; 2],
        point: usize,
        given: f64,
    ) -> f64 {
        let (operators, step) = (stepper.operators, stepper.propagators.step);
        // Radau IIA coefficients: integrals of the stage rates up to the points.
        const STAGE: [Pair; 3] = [[5.0 / 12.0, -1.0 / 12.0], [2.0 / 3.0, 0.0], [0.75, 0.25]];
        let worn = |body: usize| {
            step * (STAGE[point][0] * self.rates[body][0] + STAGE[point][1] * self.rates[body][1])
                + self.released_wear[body]
        };
        let closed = state.punch.depth + worn(0) + state.strip.depth + operators.strip_coverage * worn(1)
            - punch.expansion(&state.punch, point)
            - strip.expansion(&state.strip, point);
        let load = if given > 0.0 { (given - operators.series_stiffness * closed).max(0.0) } else { 0.0 };
        load / operators.area
    }

    /// One iteration of heat, its partition and friction at both stages for the current cooling and pressure; returns the largest
    /// change of temperature, 0 where no further iteration is needed. In the common form NaN where friction leaves the piece of its
    /// fade table.
    #[inline(always)]
    pub(crate) fn solve(
        &mut self,
        stepper: &Stepper,
        punch: &mut StageBody<COMMON>,
        strip: &mut StageBody<COMMON>,
    ) -> f64 {
        let caliper = Self::has_caliper(stepper);
        if caliper {
            self.closed = self.pressure[0] + self.pressure[1] > 0.0;
        }
        let before = self.temperature;
        let conducts = [punch.conducts(), strip.conducts()];
        let half_resistance = stepper.operators.half_resistance;
        self.partition =
            StageHeatPartition::new([punch.contact, strip.contact], conducts, half_resistance, self.closed);
        let fades = !stepper.friction.fade.flat;
        if self.has_bristle() {
            self.slide_bristle(stepper);
            self.exchange(punch, strip);
        } else {
            let is_linear = self.heat_on_piece(stepper);
            self.exchange(punch, strip);
            let temperature = [self.temperature[0] + self.reference, self.temperature[1] + self.reference];
            let holds = is_linear && self.fade.holds(temperature[0]) && self.fade.holds(temperature[1]);
            if holds {
                let at = |t: f64| stepper.friction.coefficient * self.fade.factor(t);
                self.kinetic_coefficient = [at(temperature[0]), at(temperature[1])];
            } else if COMMON {
                return f64::NAN;
            } else if fades {
                self.sweep(stepper);
                self.exchange(punch, strip);
            }
        }
        if self.has_bristle() && fades {
            // In slip the heat of a stage is proportional to its friction coefficient: the consistent one of both is the next iterate.
            let by_heat = self.partition.temperature_by_heat();
            for stage in 0..2 {
                let gain = by_heat.gain[stage][stage].max(0.0);
                let (heat, coefficient) = (self.heat[stage], self.kinetic_coefficient[stage]);
                let per_coefficient = if coefficient > 0.0 { gain * heat / coefficient } else { 0.0 };
                let level = self.temperature[stage] + self.reference - per_coefficient * coefficient;
                let temperature = agree(stepper.friction, level, per_coefficient);
                self.kinetic_coefficient[stage] = stepper.friction.kinetic_coefficient(temperature);
            }
        }
        if caliper {
            self.wear(stepper, false);
        }
        // The change by cooling is returned separately; caliper and bristle depend on this solution.
        let feeds_back = caliper || self.has_bristle() && fades;
        if !feeds_back {
            return 0.0;
        }
        maximum((self.temperature[0] - before[0]).abs(), (self.temperature[1] - before[1]).abs())
    }

    /// Fluxes into both bodies and temperatures under the heats.
    #[inline(always)]
    fn exchange(&mut self, punch: &mut StageBody<COMMON>, strip: &mut StageBody<COMMON>) {
        let fluxes = self.partition.fluxes(self.heat);
        self.surfaces = self.partition.surfaces(&fluxes);
        let [of_punch, of_strip] = self.surfaces;
        self.temperature = [0.5 * (of_punch[0] + of_strip[0]), 0.5 * (of_punch[1] + of_strip[1])];
        punch.take(fluxes[0]);
        strip.take(fluxes[1]);
    }

    /// Heats on one piece of the fade table, where temperature and friction coefficient are linear in them: `h = P mu(T(h))`. `false`
    /// where friction rises so steeply with its own heat that there may be several solutions.
    #[inline(always)]
    fn heat_on_piece(&mut self, stepper: &Stepper) -> bool {
        let (coefficient, fade) = (stepper.friction.coefficient, &self.fade);
        let power = |stage: usize| self.driver[stage] * coefficient * self.pressure[stage];
        let power = [power(0), power(1)];
        if fade.slope == 0.0 {
            self.heat = [power[0] * fade.value, power[1] * fade.value];
            return true;
        }
        let Response { level, gain } = self.partition.temperature_by_heat();
        let feedback = [power[0] * fade.slope, power[1] * fade.slope];
        let steepness = |i: usize| feedback[i] * (gain[i][0].abs() + gain[i][1].abs());
        if steepness(0) > 0.5 || steepness(1) > 0.5 {
            return false;
        }
        let agree = inverse(&[
            [1.0 - feedback[0] * gain[0][0], -feedback[0] * gain[0][1]],
            [-feedback[1] * gain[1][0], 1.0 - feedback[1] * gain[1][1]],
        ]);
        let alone = |i: usize| power[i] * fade.factor(level[i] + self.reference);
        self.heat = apply(&agree, [alone(0), alone(1)]);
        true
    }

    /// Heats over the whole fade table, stage by stage.
    #[inline(never)]
    fn sweep(&mut self, stepper: &Stepper) {
        let Response { level, gain } = self.partition.temperature_by_heat();
        self.heat = [0.0; 2];
        for _ in 0..60 {
            let old = self.heat;
            for stage in 0..2 {
                let other = 1 - stage;
                let power = self.driver[stage] * self.pressure[stage];
                let level = level[stage] + gain[stage][other] * self.heat[other];
                let gain = gain[stage][stage].max(0.0) * power;
                let temperature = agree(stepper.friction, level + self.reference, gain);
                self.kinetic_coefficient[stage] = stepper.friction.kinetic_coefficient(temperature);
                self.heat[stage] = self.kinetic_coefficient[stage] * power;
            }
            if (0..2).all(|stage| (self.heat[stage] - old[stage]).abs() <= 1e-13 * self.heat[stage].abs()) {
                break;
            }
        }
    }

    /// Kinetic friction coefficient at a temperature, K.
    #[inline(always)]
    fn kinetic_coefficient_at(&self, stepper: &Stepper, temperature: f64) -> f64 {
        let friction = stepper.friction;
        if self.fade.holds(temperature) {
            friction.coefficient * self.fade.factor(temperature)
        } else {
            friction.kinetic_coefficient(temperature)
        }
    }

    /// Advances the bristle over the whole step, with its limit linear through both stages: in continuous sliding its heat equals
    /// that of the friction law without a bristle. Heat and slip speed at the stages are those of the instants, scaled to the
    /// heat and the slip over the step; what is released at once is spread over the step.
    #[inline(never)]
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
    #[inline(always)]
    fn unevenness(&self, stepper: &Stepper) -> [f64; 2] {
        let (false, Some(bristle)) = (COMMON, &self.bristle) else { return [0.0; 2] };
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
    #[inline(always)]
    pub(crate) fn largest_heat(&self, stepper: &Stepper) -> f64 {
        let largest = maximum(self.heat[0].abs(), self.heat[1].abs());
        if !self.has_bristle() {
            return largest;
        }
        let [_, released] = self.unevenness(stepper);
        largest - released + released / stepper.cut
    }

    /// Wear rates at the stages. The slip that a bristle releases at once wears as if it took the whole piece: the law knows no wear
    /// at infinite speed. Under `constant` conditions one rate is valid for both stages unless the law depends on the temperature.
    #[inline(always)]
    pub(crate) fn wear(&mut self, stepper: &Stepper, constant: bool) {
        let operators = stepper.operators;
        let bodies = [&operators.punch, &operators.strip];
        if self.has_bristle() {
            let length = stepper.cut * stepper.propagators.step;
            let speed = self.moved.released.slipped / length;
            let pressure = (1.5 * self.pressure[0] - 0.5 * self.pressure[1]).max(0.0);
            let temperature = self.temperature[0] + self.reference;
            self.released_wear = bodies.map(|body| {
                length * stepper.wear_rate(body, pressure, speed, self.kinetic_coefficient[0], temperature)
            });
        }
        let same = constant && !self.has_bristle() && !operators.wear_follows_temperature;
        self.rates = [self.wear_rates(stepper, bodies[0], same), self.wear_rates(stepper, bodies[1], same)];
    }

    /// Wear rates of a body at both stages, m/s, the `same` or not.
    #[inline(always)]
    fn wear_rates(&self, stepper: &Stepper, body: &BodyOperators, same: bool) -> Pair {
        let Stages { pressure, speed, kinetic_coefficient: friction, temperature, reference, .. } = *self;
        let first = stepper.wear_rate(body, pressure[0], speed[0], friction[0], temperature[0] + reference);
        if same {
            return [first; 2];
        }
        [first, stepper.wear_rate(body, pressure[1], speed[1], friction[1], temperature[1] + reference)]
    }

    /// Whether a wear rate that follows the temperature changes so much that its error may exceed the tolerance: twice the change
    /// bounds the third difference.
    #[inline(always)]
    pub(crate) fn may_err_in_wear(&self, stepper: &Stepper, peak: f64) -> bool {
        let operators = stepper.operators;
        let may_err = |body: &BodyOperators, [first, last]: Pair| {
            let scale = first.max(last).max(0.02 * peak).max(body.least_wear);
            (last - first).abs() > operators.budget.steps.lumped_wear * scale
        };
        operators.wear_follows_temperature
            && (may_err(&operators.punch, self.rates[0]) || may_err(&operators.strip, self.rates[1]))
    }

    /// Upper bound of [`Stages::error`] without a third point: at constant conditions the fluxes relax, and the deviation of a
    /// relaxing flux from the line through both stages is at most half their difference. Infinite where that does not hold.
    #[inline(always)]
    pub(crate) fn bound(
        &self,
        stepper: &Stepper,
        state: &LumpedState,
        constant: bool,
        punch: &StageBody<COMMON>,
        strip: &StageBody<COMMON>,
    ) -> f64 {
        let operators = stepper.operators;
        if !constant || Self::has_caliper(stepper) || !COMMON && operators.wear_follows_temperature {
            return f64::INFINITY;
        }
        let [first, last] = punch.flux[0];
        let partition = (last - first).abs();
        let mut heat = (self.heat[1] - self.heat[0]).abs();
        if self.has_bristle() {
            let [transitions, released] = self.unevenness(stepper);
            heat += 2.0 * (transitions + released);
        }
        let scale = self.flux_scale(stepper, state, punch);
        let exchange = if self.closed && operators.half_resistance > 0.0 {
            // The resistance increases during the step: at its end it bounds that at the point 2/3.
            let (gain, strip_gain) = (punch.contact.gain[1], strip.contact.gain[1]);
            let bodies = (gain[0] + strip_gain[0]) + (gain[1] + strip_gain[1] + 2.0 * operators.half_resistance);
            partition / layer_allowance(bodies, scale, state)
        } else {
            partition
        };
        let defect = 0.5 * (exchange + heat);
        defect / (operators.budget.steps.lumped_flux * scale)
    }

    /// Scale of errors of the flux, W/m2.
    #[inline(always)]
    fn flux_scale(&self, stepper: &Stepper, state: &LumpedState, punch: &StageBody<COMMON>) -> f64 {
        let heat = self.largest_heat(stepper);
        let exchanged = 0.1 * maximum(punch.flux[0][0].abs(), punch.flux[0][1].abs());
        maximum(heat, exchanged).max(0.02 * state.peak_flux).max(stepper.operators.least_flux)
    }

    /// Error of the step in units of the tolerance, from the residual of the contact conditions at the point 2/3; contact temperatures
    /// of punch and strip there, and their gains.
    #[inline(always)]
    pub(crate) fn error(
        &self,
        stepper: &Stepper,
        state: &LumpedState,
        conditions: [&Conditions; 4],
        [punch, strip]: [&StageBody<COMMON>; 2],
        [in_punch, in_strip]: [(f64, Pair); 2],
        constant: bool,
    ) -> f64 {
        let operators = stepper.operators;
        let steps = &operators.budget.steps;
        let middle = conditions[2];
        let between = |values: Pair| BASIS[1][0] * values[0] + BASIS[1][1] * values[1];
        let pressure = if Self::has_caliper(stepper) {
            self.behind_caliper(stepper, state, [punch, strip], 1, if self.closed { middle.load } else { 0.0 })
        } else {
            middle.load / operators.area
        };
        let stribeck = operators.stribeck(middle, pressure);
        let heats = between(self.heat);
        let into = [between(punch.flux[0]), between(strip.flux[0])];
        let surfaces = self.partition.beside_insulator([in_punch.0, in_strip.0], into);
        let temperature = 0.5 * (surfaces[0] + surfaces[1]);
        let scale = self.flux_scale(stepper, state, punch);
        let (mut exchange, mut defect, mut held) = (0.0, 0.0, 0.0);
        let half_resistance = operators.half_resistance;
        if punch.conducts() && strip.conducts() && half_resistance > 0.0 && self.closed {
            let ((_, gain), (_, strip_gain)) = (in_punch, in_strip);
            let resistance = 2.0 * half_resistance + gain[0] + gain[1] + strip_gain[0] + strip_gain[1];
            let jump = in_punch.0 - in_strip.0 - half_resistance * (into[1] - into[0]);
            // Transitions between sticking and slipping cause thermal layers in the middle of a step.
            let is_layer = constant || !self.has_bristle() && !stepper.touches_down();
            let allowance = if is_layer { layer_allowance(resistance, scale, state) } else { 0.5 };
            // What a layer errs by fades like the root of time until the piece ends, but for what the means of the bodies keep.
            let kept = ((punch.kept() + strip.kept()) / resistance).min(1.0);
            let fade = if is_layer { kept.max(stepper.left.sqrt().recip()) } else { 1.0 };
            exchange = fade * jump.abs() / (resistance * allowance);
        }
        let kinetic_coefficient = self.kinetic_coefficient_at(stepper, temperature + self.reference);
        if self.has_bristle() {
            let limit = |kinetic_coefficient: f64, stribeck: f64, pressure: f64| {
                self.limit(stepper, kinetic_coefficient, stribeck, pressure)
            };
            let straight = between(
                [0, 1].map(|stage| limit(self.kinetic_coefficient[stage], self.stribeck[stage], self.pressure[stage])),
            );
            let excess = (limit(kinetic_coefficient, stribeck, pressure) - straight) * self.moved.speed[1];
            let power = self.moved.power;
            let bent = (power[1] + excess - between([power[0], power[2]])) / (operators.scene.faces * operators.area);
            // A transition between sticking and slipping only affects its own part: relative to the heat of the whole piece, it
            // is weighted by duration. A release has the same heat in a part of any duration, and is displaced within it.
            let [transitions, released] = self.unevenness(stepper);
            defect += (bent.abs() + transitions + released / stepper.cut) / stepper.cut;
            held = self.stuck_force_error(stepper, conditions[0].stribeck);
        } else {
            let heat = kinetic_coefficient * stribeck * middle.slip * operators.power_factor * pressure;
            defect += (heat - heats).abs();
        }
        // The residual overestimates the error of the mean flux, for which the Radau quadrature has two orders more. Changes
        // during the step persist after it, hence the larger factor.
        let defect = if constant { exchange + defect } else { 2.0 * exchange + 4.0 * defect };
        let mut error = maximum(defect / (steps.lumped_flux * scale), held);
        if !constant && operators.flash.is_some() {
            error = maximum(error, stepper.flash.error(strip.flux[0], steps.whole, state.peak_rise));
        }
        // At constant conditions only the temperature can change the wear rate.
        let changes = !constant || Self::has_caliper(stepper) || !COMMON && operators.wear_follows_temperature;
        if self.has_bristle() || changes {
            // A product of a linear pressure and a linear speed has no third difference.
            let linear =
                stepper.friction.regularization_velocity == 0.0 && !self.has_bristle() && !Self::has_caliper(stepper);
            let (own, peak) = (*self, state.peak_wear);
            let of = |body: &BodyOperators, rates: &Pair| {
                let is_exact = !body.wear.active() || linear && body.wear.is_archard(own.kinetic_coefficient);
                if is_exact { 0.0 } else { own.wear_error(stepper, conditions, pressure, body, rates, peak) }
            };
            error = maximum(error, of(&operators.punch, &own.rates[0]));
            error = maximum(error, of(&operators.strip, &own.rates[1]));
        }
        error
    }

    /// Error of the force in which the bristle is left, in units of the tolerance: where it sticks before the end of the step, that force
    /// stays. The limit is a line through the stages, but the Stribeck factor, `start` at the start, is steep near standstill.
    #[inline(never)]
    fn stuck_force_error(&self, stepper: &Stepper, start: f64) -> f64 {
        let Some(bristle) = self.bristle.filter(|_| [start; 2] != self.stribeck) else { return 0.0 };
        let (operators, friction, step) = (stepper.operators, stepper.friction, stepper.propagators.step);
        let plain = [0, 1].map(|stage| self.limit(stepper, self.kinetic_coefficient[stage], 1.0, self.pressure[stage]));
        let [limit, pressure] = [plain, self.pressure].map(|values| Line::through_stages(values, step));
        let factor = |time: f64| {
            friction.stribeck(OperatingPoint { velocity: self.velocity.at(time), pressure: pressure.at(time).max(0.0) })
        };
        let exact = bristle.deflection_by_parts(self.deflection_at_start, self.velocity, limit, step, factor);
        // A slipping bristle forgets within c/k: the errors of the steps add up to that of a step over 1 - exp(-h k/c).
        let forgotten =
            if bristle.damping > 0.0 { -(-step * bristle.stiffness / bristle.damping).exp_m1() } else { 1.0 };
        let rounding = 16.0 * f64::EPSILON * exact.abs();
        let apart = bristle.stiffness * ((self.moved.deflection - exact).abs() - rounding).max(0.0) / forgotten;
        // The largest force of the whole piece.
        let load = stepper.ends.map_or(0.0, |ends| maximum(ends[0].load, ends[1].load));
        let most = self.limit(stepper, self.kinetic_coefficient[1], 1.0, load / operators.area);
        let scale = maximum(maximum(most, maximum(plain[0], plain[1])), bristle.stiffness * exact.abs());
        if apart > 0.0 { apart / (operators.budget.steps.whole * scale) } else { 0.0 }
    }

    /// Third difference of the wear rate, which is the quadrature error, in units of the tolerance.
    #[inline(never)]
    fn wear_error(
        &self,
        stepper: &Stepper,
        conditions: [&Conditions; 4],
        pressure_in_middle: f64,
        body: &BodyOperators,
        rates: &Pair,
        peak: f64,
    ) -> f64 {
        let operators = stepper.operators;
        let mut speeds = conditions.map(|now| now.slip);
        let mut uneven = 0.0;
        if self.has_bristle() {
            let [first, second, last] = self.moved.speed;
            speeds = [(2.0 * first - second).max(0.0), self.speed[0], second, self.speed[1]];
            let mean = (self.moved.slipped - self.moved.released.slipped) / stepper.propagators.step;
            let left = (QUADRATURE[0] * first + QUADRATURE[1] * last - mean).abs();
            uneven = left / mean.max(first).max(last).max(f64::MIN_POSITIVE) * rates[0].max(rates[1]);
        }
        // Linear extrapolation of the stage values to the start and to the point 2/3.
        let [start, middle] = [(0, [1.5, -0.5]), (2, BASIS[1])].map(|(index, stages): (usize, Pair)| {
            let between = |values: Pair| stages[0] * values[0] + stages[1] * values[1];
            let pressure = if Self::has_caliper(stepper) {
                if index == 2 { pressure_in_middle } else { between(self.pressure).max(0.0) }
            } else if self.closed {
                conditions[index].load / operators.area
            } else {
                0.0
            };
            let temperature = between(self.temperature) + self.reference;
            stepper.wear_rate(body, pressure, speeds[index], between(self.kinetic_coefficient), temperature)
        });
        let slip = maximum(self.speed[0], self.speed[1]);
        let end = [self.kinetic_coefficient[1], self.temperature[1] + self.reference, slip];
        stepper.wear_error(body, rates, [start, middle], uneven, end, peak)
    }
}

/// Stage values proportional to `values`, with the mean `mean` over the step.
fn scaled(values: [f64; 2], mean: f64) -> [f64; 2] {
    let own = QUADRATURE[0] * values[0] + QUADRATURE[1] * values[1];
    if own > 0.0 { values.map(|value| value * (mean / own)) } else { [mean; 2] }
}
