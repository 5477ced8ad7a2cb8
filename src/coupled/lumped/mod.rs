//! The lumped level: uniform pressure, a few thermal states per body, a moving source.

pub mod bristle;
pub mod conditions;
mod flash_step;
pub mod interface;
pub mod operators;
pub mod outputs;
mod plain;
pub mod point;
pub mod stage;
mod stage_body;
mod stages;
pub mod state;
pub mod step;

use crate::contact::friction::FrictionLaw;
use crate::coupled::scalar::Dual;
use crate::coupled::{INPUTS, Inputs, StepFailure};
use crate::scene::Scene;
use conditions::{Conditions, Tunables};
use flash_step::FlashStep;
use operators::Operators;
use point::{Frozen, Point};
use state::State;
use std::sync::Arc;
use step::{Propagators, Stepper};

/// Bits of [`State::limits`].
pub mod limit {
    /// A wear limit is reached.
    pub const WEAR: u8 = 1;
    /// The temperature limit is exceeded.
    pub const TEMPERATURE: u8 = 2;
    /// The scene has left the model's validity.
    pub const VALIDITY: u8 = 4;
    /// The load was below zero (not shown in the output).
    pub const NEGATIVE_LOAD: u8 = 8;
}

/// Temperature (K) above which constant material properties mean nothing any more.
const HIGHEST_VALID_TEMPERATURE: f64 = 2500.0;

/// Part of a body's height that may be worn off before conduction and compliance must be rebuilt.
const HIGHEST_VALID_WEAR: f64 = 0.5;

/// Finest subdivision of a communication step: 2^-40 of it.
const FINEST: u8 = 40;

/// Most attempts for one piece of a communication step: a step always ends.
const MOST_ATTEMPTS: u32 = 200_000;

/// Step sizes whose weights are kept.
const KEPT_STEPS: usize = 12;

/// Load and speed that a run may exceed the nominal by before the plan no longer holds.
const NOMINAL_MARGIN: f64 = 10.0;

/// Limits that a contact temperature (K) reaches.
pub fn limits_of_temperature(scene: &Scene, hottest: f64) -> u8 {
    let exceeded = scene.temperature_limit > 0.0 && hottest > scene.temperature_limit;
    let invalid = hottest > HIGHEST_VALID_TEMPERATURE;
    (if exceeded { limit::TEMPERATURE } else { 0 }) | (if invalid { limit::VALIDITY } else { 0 })
}

/// Conditions during a piece of a communication step.
enum Course<'a> {
    /// The same all along.
    Constant(Conditions),
    /// By the time since the start of the piece, s.
    Varying(&'a dyn Fn(f64) -> Conditions),
}

impl Course<'_> {
    fn at(&self, time: f64) -> Conditions {
        match self {
            Course::Constant(conditions) => *conditions,
            Course::Varying(conditions) => conditions(time),
        }
    }
}

/// A scene at the lumped level.
#[derive(Clone, Debug)]
pub struct Lumped {
    operators: Arc<Operators>,
    friction: FrictionLaw,
    tunables: Tunables,
    state: State,
    frozen: Frozen,
    frozen_is_current: bool,
    /// Weights of recent step sizes; never part of the state, always rebuilt to the same bits.
    propagators: Vec<Propagators>,
    oldest: usize,
    flash: FlashStep,
    /// Conditions last computed, with the inputs they belong to.
    known: ([f64; INPUTS], Conditions),
}

impl Lumped {
    /// Starts from rest at the given inputs (which give the ambient temperature of initialisation).
    pub fn new(operators: Arc<Operators>, tunables: Tunables, inputs: &[f64; INPUTS]) -> Lumped {
        let ambient = tunables.ambient_temperature + Inputs::from_array(*inputs).ambient_temperature_offset;
        let mut state = State::new(&operators, ambient);
        let mut friction = operators.friction.clone();
        friction.coefficient = tunables.friction_coefficient;
        let known = (*inputs, Conditions::new(&operators, &tunables, state.reference, &Inputs::from_array(*inputs)));
        state.far_start = [known.1.punch_far, known.1.strip_far];
        state.far = state.far_start;
        Lumped {
            frozen: Frozen::default(),
            frozen_is_current: false,
            friction,
            tunables,
            state,
            propagators: Vec::with_capacity(KEPT_STEPS),
            oldest: 0,
            flash: FlashStep::empty(),
            known,
            operators,
        }
    }

    /// What the scene was made into.
    pub fn operators(&self) -> &Arc<Operators> {
        &self.operators
    }

    /// Whether a bristle carries the force at standstill.
    pub fn has_bristle(&self) -> bool {
        self.operators.scene.stick_stiffness > 0.0
    }

    /// Everything that changes.
    pub fn state(&self) -> &State {
        &self.state
    }

    /// Replaces everything that changes.
    pub fn set_state(&mut self, state: &State) {
        self.state.clone_from(state);
        self.frozen_is_current = false;
        self.forget_conditions();
    }

    /// Parameters that may change between steps.
    pub fn set_tunables(&mut self, tunables: Tunables) {
        self.friction.coefficient = tunables.friction_coefficient;
        self.tunables = tunables;
        self.forget_conditions();
    }

    /// Sets the friction coefficient that somebody knows better than the tunable parameter.
    pub fn set_friction_coefficient(&mut self, coefficient: f64) {
        self.friction.coefficient = coefficient;
    }

    /// Inputs that no inputs are equal to: the next conditions are computed anew.
    fn forget_conditions(&mut self) {
        self.known.0 = [f64::NAN; INPUTS];
    }

    fn refresh(&mut self) {
        if !self.frozen_is_current {
            self.frozen = Frozen::new(&self.operators, &self.state);
            self.frozen_is_current = true;
        }
    }

    /// The contact now, for these inputs and with the states held.
    pub fn point(&mut self, inputs: &[f64; INPUTS]) -> Point {
        self.refresh();
        let conditions = self.conditions(inputs);
        point::evaluate(&self.operators, &self.friction, &self.state, &self.frozen, &self.tunables, &conditions)
    }

    /// The contact now in dual numbers, with the states held.
    pub fn dual_point(&mut self, inputs: &Inputs<Dual>) -> Point<Dual> {
        self.refresh();
        let conditions = Conditions::new(&self.operators, &self.tunables, self.state.reference, inputs);
        point::evaluate(&self.operators, &self.friction, &self.state, &self.frozen, &self.tunables, &conditions)
    }

    /// Mean outward displacement of both contact surfaces by the bodies' mean temperatures, m.
    pub fn expansion_of_bodies(&self) -> f64 {
        self.expansion(&self.operators.punch, &self.state.punch)
            + self.expansion(&self.operators.strip, &self.state.strip)
    }

    fn conditions(&mut self, inputs: &[f64; INPUTS]) -> Conditions {
        if self.known.0 != *inputs {
            let inputs_now = Inputs::from_array(*inputs);
            self.known = (*inputs, Conditions::new(&self.operators, &self.tunables, self.state.reference, &inputs_now));
        }
        self.known.1
    }

    /// Carries the scene over `step` (s, > 0) with inputs that start at `inputs` and change at the rates
    /// `slopes`, or not at all. On failure the state is the one before the step.
    ///
    /// # Errors
    /// [`StepFailure`] where no step size gives a solution, or a body is worn through.
    pub fn step(
        &mut self,
        inputs: &[f64; INPUTS],
        slopes: Option<&[f64; INPUTS]>,
        step: f64,
    ) -> Result<(), StepFailure> {
        let mut backup = None;
        let outcome = self.pieces(inputs, slopes, step, &mut backup).and_then(|()| self.watch(inputs, slopes, step));
        if outcome.is_err()
            && let Some(backup) = backup
        {
            self.state = backup;
        }
        self.frozen_is_current = false;
        outcome
    }

    /// The step in pieces between sign changes of the velocity and of the load.
    fn pieces(
        &mut self,
        inputs: &[f64; INPUTS],
        slopes: Option<&[f64; INPUTS]>,
        step: f64,
        backup: &mut Option<State>,
    ) -> Result<(), StepFailure> {
        if self.near_end_of_body(inputs, slopes, step) {
            *backup = Some(self.state.clone());
        }
        let last_load = inputs[1] + slopes.map_or(0.0, |slopes| slopes[1] * step);
        if inputs[1] < 0.0 || last_load < 0.0 {
            self.state.limits |= limit::NEGATIVE_LOAD;
        }
        let Some(slopes) = slopes else {
            let constant = self.conditions(inputs);
            return self.piece(&Course::Constant(constant), step, backup);
        };
        let radius = self.operators.scene.mean_radius;
        let crossings = [(inputs[0] + radius * inputs[2], slopes[0] + radius * slopes[2]), (inputs[1], slopes[1])];
        let mut edges = [0.0, step, step, step];
        let mut count = 1;
        for (value, slope) in crossings {
            let time = -value / slope;
            // A crossing at the very edge is no event: its piece would have no length.
            if slope != 0.0 && time > 1e-12 * step && time < (1.0 - 1e-12) * step {
                edges[count] = time;
                count += 1;
            }
        }
        edges[1..count].sort_by(f64::total_cmp);
        edges[count] = step;
        if count > 1 && backup.is_none() {
            *backup = Some(self.state.clone());
        }
        let (operators, tunables, reference) = (self.operators.clone(), self.tunables, self.state.reference);
        for piece in edges[..=count].windows(2) {
            let at = |time: f64| {
                let mut now = *inputs;
                for (value, slope) in now.iter_mut().zip(slopes) {
                    *value += slope * (piece[0] + time);
                }
                Conditions::new(&operators, &tunables, reference, &Inputs::from_array(now))
            };
            if piece[1] > piece[0] {
                self.piece(&Course::Varying(&at), piece[1] - piece[0], backup)?;
            }
        }
        Ok(())
    }

    /// A piece without events, cut into 2^n equal parts where its error asks for it.
    fn piece(&mut self, course: &Course, length: f64, backup: &mut Option<State>) -> Result<(), StepFailure> {
        let mut level = self.state.refinement;
        let mut part: u64 = 0;
        let mut attempts = 0;
        // Conditions at the ends of the piece, once it is cut: until then they are those of the only part.
        let mut whole = None;
        while part < 1_u64 << level {
            attempts += 1;
            if attempts > MOST_ATTEMPTS {
                let [start, end] = [course.at(0.0), course.at(length)];
                return Err(StepFailure(format!(
                    "a communication step of {length} s needs more than {MOST_ATTEMPTS} internal steps at solver.tolerance = {}; \
                     sliding velocity {} to {} m/s, normal load {} to {} N",
                    self.operators.scene.tolerance, start.velocity, end.velocity, start.load, end.load
                )));
            }
            let step = length / (1_u64 << level) as f64;
            let start = part as f64 * step;
            if level > 0 && backup.is_none() {
                *backup = Some(self.state.clone());
            }
            let index = self.propagators_of(step);
            let varying = match course {
                Course::Constant(_) => None,
                Course::Varying(conditions) => {
                    Some([0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0].map(|c| conditions(start + c * step)))
                }
            };
            let now = match (course, &varying) {
                (Course::Constant(now), _) => *now,
                (_, Some(at)) => at[0],
                _ => course.at(start),
            };
            if let Some(at) = &varying
                && whole.is_none()
            {
                whole = Some(if level == 0 { [at[0], at[3]] } else { [course.at(0.0), course.at(length)] });
            } else if varying.is_none() && self.has_bristle() {
                // A change between sticking and slipping is no polynomial at any step.
                whole = Some([now; 2]);
            }
            let speeds = match &varying {
                Some(at) => at.each_ref().map(|conditions| conditions.velocity.abs()),
                None => [now.velocity.abs(); 4],
            };
            self.flash.prepare(&self.operators, &self.propagators[index].flash, speeds, step);
            let mut stepper = Stepper {
                flash: &mut self.flash,
                cut: (1_u64 << level) as f64,
                ends: whole.as_ref(),
                operators: &self.operators,
                friction: &self.friction,
                tunables: &self.tunables,
                propagators: &self.propagators[index],
            };
            let attempt = match &varying {
                Some(at) => stepper.attempt(&mut self.state, at, false),
                None => match stepper.plain(&mut self.state, &now) {
                    Some(attempt) => attempt,
                    None => stepper.attempt(&mut self.state, &[now; 4], true),
                },
            };
            if attempt.error <= 1.0 {
                self.state.steps += 1;
                self.judge_temperature(attempt.hottest);
                self.state.error = self.state.error.max(attempt.error * self.operators.scene.tolerance);
                part += 1;
                // The error falls by about eight when the step is halved: room for doubling it.
                if level > 0 && part.is_multiple_of(2) && attempt.error < 0.3 {
                    level -= 1;
                    part /= 2;
                }
                continue;
            }
            self.state.rejected += 1;
            if level >= FINEST {
                let last = course.at(start + step);
                return Err(StepFailure(format!(
                    "no solution of heat, friction and wear in a step of {step} s (communication step cut by 2^{FINEST}); \
                     contact temperature {} K, sliding velocity {} m/s, normal load {} N",
                    attempt.hottest + self.state.reference,
                    last.velocity,
                    last.load
                )));
            }
            level += 1;
            part *= 2;
        }
        self.state.refinement = level;
        Ok(())
    }

    /// Index of the weights for this step size, made if they are not among the recent ones.
    fn propagators_of(&mut self, step: f64) -> usize {
        if let Some(index) = self.propagators.iter().position(|known| known.step == step) {
            return index;
        }
        let made = Propagators::new(&self.operators, step);
        if self.propagators.len() < KEPT_STEPS {
            self.propagators.push(made);
            return self.propagators.len() - 1;
        }
        let index = self.oldest;
        self.propagators[index] = made;
        self.oldest = (self.oldest + 1) % KEPT_STEPS;
        index
    }

    /// Whether the step could wear a body through: only then is the state before it kept.
    fn near_end_of_body(&self, inputs: &[f64; INPUTS], slopes: Option<&[f64; INPUTS]>, step: f64) -> bool {
        let operators = &self.operators;
        let scene = &operators.scene;
        let largest = |index: usize| {
            let change = slopes.map_or(0.0, |slopes| slopes[index] * step);
            inputs[index].abs().max((inputs[index] + change).abs())
        };
        let speed = largest(0) + scene.mean_radius * largest(2);
        // Behind a caliper the load may rise above what the actuator gives.
        let caliper = operators.series_stiffness > 0.0;
        let pressure = largest(1) / operators.area;
        let worn = |depth: f64, initial: f64, height: f64, body: &operators::BodyOperators| {
            let rate = body.wear.highest_rate(pressure, speed) * (body.wear_factor * self.tunables.wear_acceleration);
            depth + initial + step * rate > 0.9 * height
        };
        caliper
            || worn(self.state.punch.depth, scene.punch.initial_wear, scene.punch.height, &operators.punch)
            || worn(self.state.strip.depth, scene.strip.initial_wear, scene.strip.height, &operators.strip)
    }

    fn judge_temperature(&mut self, hottest: f64) {
        self.state.limits |= limits_of_temperature(&self.operators.scene, hottest + self.state.reference);
    }

    /// Limits and validity after a step.
    fn watch(&mut self, inputs: &[f64; INPUTS], slopes: Option<&[f64; INPUTS]>, step: f64) -> Result<(), StepFailure> {
        let scene = &self.operators.scene;
        for (name, depth, body) in
            [("punch", self.state.punch.depth, &scene.punch), ("strip", self.state.strip.depth, &scene.strip)]
        {
            let worn = depth + body.initial_wear;
            if worn >= body.height {
                return Err(StepFailure(format!(
                    "the {name} is worn through: worn depth {worn} m reaches {name}.height = {} m",
                    body.height
                )));
            }
            if worn > HIGHEST_VALID_WEAR * body.height {
                self.state.limits |= limit::VALIDITY;
            }
            if body.wear_limit > 0.0 && worn >= body.wear_limit {
                self.state.limits |= limit::WEAR;
            }
        }
        if let Some(track) = &self.state.track {
            if track.revisited() {
                self.state.limits |= limit::VALIDITY;
            }
            let depth = track.under(self.state.position) + scene.strip.initial_wear;
            if scene.strip.wear_limit > 0.0 && depth >= scene.strip.wear_limit {
                self.state.limits |= limit::WEAR;
            }
        }
        let last = |index: usize| inputs[index] + slopes.map_or(0.0, |slopes| slopes[index] * step);
        let (speed, load) = (last(0).abs(), last(1));
        let beyond = |value: f64, nominal: f64| nominal > 0.0 && value > NOMINAL_MARGIN * nominal;
        if beyond(speed, scene.nominal_velocity) || beyond(load, scene.nominal_load) {
            self.state.limits |= limit::VALIDITY;
        }
        Ok(())
    }
}
