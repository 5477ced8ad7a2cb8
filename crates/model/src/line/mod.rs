//! Line level: pressure, wear and shape on the cells of the contact line.
//!
//! Lumped heat, friction coefficient, distance and bristle depend on the mean pressure and follow the equations of the lumped
//! level ([`Lumped`], without wear and holder); the contact line adds the quantities that vary along the contact. The two are
//! coupled once per piece of a communication step: the contact line takes the temperature where tables or the bristle depend on
//! it, the lumped level takes the load where a caliper or an annulus lets the contact determine it. With resolved heat the lumped
//! level has only distance and bristle left to follow.
//!
//! Theory: docs/theory.md, sections 8.1, 5.1.

mod coupling;
pub mod cycle;
mod growth;
pub mod heat;
mod heat_outputs;
pub mod hottest;
pub mod operators;
mod outputs;
pub mod profile;
pub(crate) mod saved;
mod stages;
pub(crate) mod state;
mod step;
mod trajectory;
mod wear_rates;

use crate::events::{AT_END, edges, load_is_negative};
use crate::lumped::conditions::Tunables;
use crate::lumped::{self, Lumped, limit};
use crate::{Inputs, StepFailure};
use conduction::line::FACES;
use contact::friction::FrictionLaw;
use contact::wear::line::WearingContact;
use contact::{ContactState, WorkCounter};
use coupling::ThermalCoupling;
use coupling::accept::LEAST_LINE_RISE;
use numerics::maximum::maximum;
use operators::LineOperators;
use scene::message::Number;
use stages::{ContactStages, StepData};
use state::LineState;
use std::sync::Arc;
use trajectory::{InputTrajectory, LumpedTemperature, Slipped};

/// Whether an input has jumped: it differs from its value at the end of the last step by more than rounding, on the scale of its
/// values in this step and the last.
fn jumps(before: f64, now: f64, scale: f64) -> bool {
    // Before the first step the value is NaN.
    before.is_nan() || (now - before).abs() > 1e-6 * scale
}

/// Largest difference of slip and travel, relative to the travel, with which a bristle counts as slipping throughout a piece.
const SLIPS_THROUGHOUT: f64 = 1e-2;

/// Instance of a scene at the line level.
#[derive(Clone, Debug)]
pub struct Line {
    operators: Arc<LineOperators>,
    mean: Lumped,
    friction: FrictionLaw,
    tunables: Tunables,
    state: LineState,
    /// State before the step under way.
    backup: (lumped::state::LumpedState, LineState),
    /// The backup holds the body temperatures at the start of the step; where it does not, they have not changed.
    bodies_kept: bool,
    /// Contact problem of the stages, and workspace.
    stages: ContactStages,
    /// Resolved heat, where its distribution feeds back.
    heat: Option<Box<ThermalCoupling>>,
    /// State before a piece that may be cut.
    uncut: (lumped::state::LumpedState, LineState),
    /// Internal steps that may still be tried, where they are limited.
    attempts_left: Option<u32>,
    /// Equilibrium last evaluated for outputs, and its inputs.
    shown: (Inputs, ContactState),
}

impl Line {
    /// Initial state at rest at the given inputs (which give the ambient temperature of initialisation).
    pub fn new(operators: Arc<LineOperators>, tunables: Tunables, inputs: &Inputs) -> Line {
        let mut mean = Lumped::new(operators.mean.clone(), tunables, inputs);
        let mut friction = FrictionLaw::new(&operators.scene);
        friction.coefficient = tunables.friction_coefficient;
        let mut state = LineState::new(&operators);
        if let (Some(bodies), Some(heat)) = (&operators.heat, &mut state.heat) {
            let scene = &operators.scene;
            let reference = mean.state().reference;
            let rise = [&scene.punch, &scene.strip]
                .map(|body| if body.initial_temperature > 0.0 { body.initial_temperature - reference } else { 0.0 });
            // An insulator is assigned the temperature of the surface in contact with it.
            let rise = match [scene.punch.conductivity > 0.0, scene.strip.conductivity > 0.0] {
                [true, false] => [rise[0]; 2],
                [false, true] => [rise[1]; 2],
                _ => rise,
            };
            let kinetic_coefficient = friction.kinetic_coefficient(reference + 0.5 * (rise[0] + rise[1]));
            mean.set_friction_coefficient(kinetic_coefficient);
            heat.kinetic_coefficient = kinetic_coefficient;
            heat.warm(bodies, rise);
        }
        Line {
            backup: (mean.state().clone(), state.clone()),
            bodies_kept: true,
            stages: ContactStages::new(&operators),
            heat: operators.heat.as_ref().map(|bodies| Box::new(ThermalCoupling::new(&operators, bodies))),
            uncut: (mean.state().clone(), state.clone()),
            attempts_left: None,
            shown: (Inputs::constant(f64::NAN), ContactState::new(operators.count())),
            mean,
            friction,
            tunables,
            state,
            operators,
        }
    }

    /// Operators built from the scene.
    pub fn operators(&self) -> &Arc<LineOperators> {
        &self.operators
    }

    /// Whether a bristle models the friction force at standstill.
    pub(crate) fn has_bristle(&self) -> bool {
        self.mean.has_bristle()
    }

    /// State of the contact line.
    pub fn state(&self) -> &LineState {
        &self.state
    }

    /// State of the lumped level.
    pub(crate) fn mean_state(&self) -> &lumped::state::LumpedState {
        self.mean.state()
    }

    /// Work (J) of the friction force on all faces since initialisation.
    pub(crate) fn friction_work(&self) -> f64 {
        self.mean.friction_work()
    }

    /// A copy of the state of the contact line.
    pub(crate) fn save(&self) -> LineState {
        let mut state = self.state.clone();
        state.status.copy_from(self.stages.contact.status());
        state
    }

    /// Replaces the whole state.
    pub(crate) fn set_state(&mut self, mean: &lumped::state::LumpedState, line: &LineState) {
        self.mean.set_state(mean);
        self.state.copy_from(line);
        self.stages.contact.set_status(&self.state.status);
        self.pass_friction_to_lumped();
        self.invalidate_equilibrium();
    }

    /// Work counters of the contact solver.
    pub(crate) fn contact_work(&self) -> WorkCounter {
        let heat = self.heat.iter().flat_map(|heat| &heat.contacts).map(WearingContact::counter);
        heat.fold(self.stages.contact.counter(), |sum, counter| sum + counter)
    }

    /// Limits the internal steps tried from here on: a step that needs more than `most` fails. Operators of the last `recurring` steps
    /// are kept, for a run that repeats them.
    pub(crate) fn limit_attempts(&mut self, most: u32, recurring: Option<usize>) {
        self.attempts_left = Some(most);
        if let (Some(heat), Some(steps)) = (&mut self.heat, recurring) {
            heat.bodies.iter_mut().flatten().for_each(|body| body.recur(steps));
        }
    }

    /// Takes `operators`, those of [`LineOperators::tuned`], before [`Line::set_tunables`]; the state stays. A face without flux has none of
    /// the last step.
    pub(crate) fn set_operators(&mut self, operators: Arc<LineOperators>) {
        self.mean.set_operators(operators.mean.clone());
        self.stages.set_operators(&operators);
        if let (Some(coupling), Some(heat)) = (&mut self.heat, &mut self.state.heat) {
            coupling.set_operators(&operators);
            for (side, body) in operators.mean.bodies().into_iter().enumerate() {
                for face in (0..FACES).filter(|&face| !body.air[face].acts()) {
                    (heat.cooling[side][face], heat.cooling_slope[side][face]) = (0.0, 0.0);
                }
            }
        }
        self.operators = operators;
    }

    /// Sets the parameters that may change between steps, without those of the operators.
    pub(crate) fn set_tunables(&mut self, tunables: Tunables) {
        if let Some(heat) = &mut self.state.heat
            && self.friction.coefficient > 0.0
        {
            heat.kinetic_coefficient *= tunables.friction_coefficient / self.friction.coefficient;
        }
        self.friction.coefficient = tunables.friction_coefficient;
        self.tunables = tunables;
        self.mean.set_tunables(tunables);
        self.pass_friction_to_lumped();
        self.state.end_inputs = Inputs::constant(f64::NAN);
        self.invalidate_equilibrium();
    }

    /// Passes the friction coefficient of the contact line, at its temperatures, to the lumped level.
    fn pass_friction_to_lumped(&mut self) {
        if let Some(heat) = &self.state.heat {
            self.mean.set_friction_coefficient(heat.kinetic_coefficient);
        }
    }

    fn invalidate_equilibrium(&mut self) {
        self.shown.0 = Inputs::constant(f64::NAN);
    }

    /// Data that are given while the stages of a step are solved, and their solver.
    fn parts(&mut self) -> (StepData<'_>, &mut ContactStages, Option<&mut ThermalCoupling>) {
        let Line { operators, friction, tunables, state, mean, stages, heat, .. } = self;
        let given = StepData { operators, friction, tunables, state, reference: mean.state().reference };
        (given, stages, heat.as_deref_mut())
    }

    /// Limits reached so far; see [`limit`].
    pub(crate) fn limits(&self) -> u8 {
        self.state.limits | self.mean.limits()
    }

    /// Advances the scene by `step` (s, > 0) with inputs that start at `inputs` and change at the rates `slopes`, or are
    /// constant. On failure the state is the one before the step.
    ///
    /// # Errors
    /// [`StepFailure`] where the contact has no equilibrium, no step size gives a solution, or a body is worn through.
    pub fn step(&mut self, inputs: &Inputs, slopes: Option<&Inputs>, step: f64) -> Result<(), StepFailure> {
        self.backup.0.clone_from(self.mean.state());
        self.state.status.copy_from(self.stages.contact.status());
        self.backup.1.copy_contact_from(&self.state);
        self.bodies_kept = false;
        self.stages.budget.start();
        let outcome = self.watch_growth().and_then(|()| self.pieces(inputs, slopes, step));
        if outcome.is_err() {
            self.mean.set_state(&self.backup.0);
            self.state.copy_contact_from(&self.backup.1);
            if let (true, Some(own), Some(before)) = (self.bodies_kept, &mut self.state.heat, &self.backup.1.heat) {
                own.copy_bodies_from(before);
            }
            self.stages.contact.set_status(&self.state.status);
            self.pass_friction_to_lumped();
        }
        self.invalidate_equilibrium();
        outcome
    }

    /// Advances in pieces between sign changes of velocity and load.
    fn pieces(&mut self, inputs: &Inputs, slopes: Option<&Inputs>, step: f64) -> Result<(), StepFailure> {
        let end = inputs.after(slopes, step);
        if load_is_negative(inputs, &end, self.operators.scene.nominal_load) {
            self.state.limits |= limit::NEGATIVE_LOAD;
        }
        let (edges, count) = edges(inputs, slopes, step, self.operators.scene.mean_radius);
        let radius = self.operators.scene.mean_radius;
        let speed = |inputs: &Inputs| inputs.velocity(radius).abs();
        self.state.fastest = self.state.fastest.max(speed(inputs)).max(speed(&end));
        let driving = |inputs: &Inputs| [inputs.sliding_velocity, inputs.normal_load, inputs.angular_velocity];
        let [before, now, last] = [&self.state.end_inputs, inputs, &end].map(driving);
        let scales: [f64; 3] = std::array::from_fn(|k| now[k].abs().max(last[k].abs()));
        let jumped = (0..3).any(|k| jumps(before[k], now[k], scales[k].max(self.state.scales[k])));
        if let Some(heat) = &mut self.state.heat
            && jumped
        {
            heat.jump();
        }
        for piece in edges[..=count].windows(2) {
            let length = piece[1] - piece[0];
            if length > 0.0 {
                // Sliding direction from the velocity in the middle: at the ends it is 0 to rounding.
                let middle = 0.5 * (piece[0] + piece[1]);
                let velocity = inputs.after(slopes, middle).velocity(radius);
                if let Some(heat) = &mut self.state.heat
                    && velocity * self.state.direction < 0.0
                {
                    heat.reverse();
                }
                self.state.direction = if velocity == 0.0 { 0.0 } else { velocity.signum() };
                let start = inputs.after(slopes, piece[0]);
                let onset = self.onset_of_slip(&start, slopes, length);
                let first = onset.unwrap_or(length);
                self.piece(&start, slopes, first, first / step)?;
                if let Some(onset) = onset {
                    let rest = length - onset;
                    self.piece(&start.after(slopes, onset), slopes, rest, rest / step)?;
                }
            }
        }
        (self.state.end_inputs, self.state.scales) = (end, scales);
        Ok(())
    }

    /// Time (s) at which a bristle begins to slip within a piece of `length` (s).
    fn onset_of_slip(&mut self, inputs: &Inputs, slopes: Option<&Inputs>, length: f64) -> Option<f64> {
        if !self.mean.has_bristle() {
            return None;
        }
        self.follow_elastic_slip(inputs);
        let loaded = self.loaded(inputs);
        let onset = self.mean.sticks_for(&loaded, slopes, length);
        (onset > AT_END * length && onset < (1.0 - AT_END) * length).then_some(onset)
    }

    /// Advances over a piece without events, of `share` of the communication step. It is halved until the lumped temperature is the
    /// straight line that the contact follows, within the tolerance as a mean over the communication step.
    fn piece(&mut self, inputs: &Inputs, slopes: Option<&Inputs>, length: f64, share: f64) -> Result<(), StepFailure> {
        self.follow_elastic_slip(inputs);
        if self.heat.is_some() {
            return self.piece_with_resolved_heat(inputs, slopes, length);
        }
        if !self.operators.follows_heat() {
            return self.attempt_piece(inputs, slopes, length, share).map(|_| ());
        }
        self.uncut.0.clone_from(self.mean.state());
        self.state.status.copy_from(self.stages.contact.status());
        self.uncut.1.copy_contact_from(&self.state);
        if self.attempt_piece(inputs, slopes, length, share)? {
            return Ok(());
        }
        self.mean.set_state(&self.uncut.0);
        self.state.copy_contact_from(&self.uncut.1);
        self.stages.contact.set_status(&self.state.status);
        self.invalidate_equilibrium();
        let half = 0.5 * length;
        self.piece(inputs, slopes, half, 0.5 * share)?;
        self.piece(&inputs.after(slopes, half), slopes, half, 0.5 * share)
    }

    /// Advances lumped level and contact line in the order of their dependence; `false` where the piece is to be cut.
    fn attempt_piece(
        &mut self,
        inputs: &Inputs,
        slopes: Option<&Inputs>,
        length: f64,
        share: f64,
    ) -> Result<bool, StepFailure> {
        let operators = self.operators.clone();
        let bends = |mean: &Lumped, off: f64| {
            let allowed = operators.budget.steps.whole * maximum(mean.state().peak_rise, LEAST_LINE_RISE);
            operators.follows_temperature() && share * off.abs() > allowed
        };
        // Load carried by the contact at the start. Where load, tables or a bristle follow the lumped level, a first pass of it at
        // this load predicts temperature and slip.
        let loaded = self.loaded(inputs);
        let mut heat = LumpedTemperature::constant(self.mean.state().reference, 0.0);
        if operators.follows_heat() {
            let rates = self.rates_of_carried(inputs, slopes, loaded.normal_load);
            self.mean.step(&loaded, rates.as_ref(), 0.5 * length)?;
            let (temperature, expansion) = (self.mean.end_temperature(), self.expansion());
            self.mean.set_state(&self.uncut.0);
            heat = self.step_mean(&loaded, rates.as_ref(), length)?;
            (heat.temperature[1], heat.expansion[1]) = (temperature, expansion);
            let [start, middle, end] = heat.temperature;
            if bends(&self.mean, middle - 0.5 * (start + end)) {
                return Ok(false);
            }
            self.mean.set_state(&self.uncut.0);
        }
        let path = InputTrajectory::new(self, inputs, slopes, loaded.normal_load, length, heat);
        self.step_line(&path, length)?;
        if !operators.decides_load() {
            self.mean.step(inputs, slopes, length)?;
            return Ok(true);
        }
        self.follow_carried(&loaded, slopes, length)?;
        Ok(!bends(&self.mean, self.mean.end_temperature() - heat.temperature[2]))
    }

    /// Advances over a piece with resolved heat: the lumped level only integrates distance and a bristle.
    fn piece_with_resolved_heat(
        &mut self,
        inputs: &Inputs,
        slopes: Option<&Inputs>,
        length: f64,
    ) -> Result<(), StepFailure> {
        let loaded = self.loaded(inputs);
        let has_bristle = self.mean.has_bristle();
        let heat = if has_bristle {
            // The heat of a bristle is the work of the mean force, so the lumped level is advanced first.
            let rates = self.rates_of_carried(inputs, slopes, loaded.normal_load);
            self.step_mean(&loaded, rates.as_ref(), length)?
        } else {
            LumpedTemperature::constant(self.mean.state().reference, 0.0)
        };
        let path = InputTrajectory::new(self, inputs, slopes, loaded.normal_load, length, heat);
        self.step_line(&path, length)?;
        self.pass_friction_to_lumped();
        match (has_bristle, self.operators.decides_load()) {
            (true, _) => Ok(()),
            (false, true) => self.follow_carried(&loaded, slopes, length),
            (false, false) => self.mean.step(inputs, slopes, length),
        }
    }

    /// Advances the lumped level from the inputs `loaded` to the load that the contact carries at the end of the piece.
    fn follow_carried(&mut self, loaded: &Inputs, slopes: Option<&Inputs>, length: f64) -> Result<(), StepFailure> {
        let last = self.state.carried;
        let mut rates = slopes.copied().unwrap_or(Inputs::constant(0.0));
        rates.normal_load = (last - loaded.normal_load) / length;
        let sloped = slopes.is_some() || last != loaded.normal_load;
        self.mean.step(loaded, sloped.then_some(&rates), length)
    }

    /// Rates of the inputs of the lumped level where the contact carries `carried` (N): without a caliper it follows the load.
    fn rates_of_carried(&self, inputs: &Inputs, slopes: Option<&Inputs>, carried: f64) -> Option<Inputs> {
        let mut rates = *slopes?;
        if self.operators.decides_load() {
            let follows = self.operators.scene.holder_stiffness == 0.0;
            let ratio = if inputs.normal_load > 0.0 { carried / inputs.normal_load } else { 1.0 };
            rates.normal_load *= if follows { ratio } else { 0.0 };
        }
        Some(rates)
    }

    /// Advances the lumped level over the piece; returns the courses of temperature and expansion.
    fn step_mean(
        &mut self,
        inputs: &Inputs,
        slopes: Option<&Inputs>,
        length: f64,
    ) -> Result<LumpedTemperature, StepFailure> {
        let (temperature, expansion) = (self.temperature(inputs), self.expansion());
        let (distance, dissipated) = (self.mean.state().distance, self.mean.state().dissipated);
        self.mean.step(inputs, slopes, length)?;
        let state = self.mean.state();
        let slipped = self.mean.has_bristle().then(|| {
            let carried = inputs.normal_load.max(0.0) + slopes.map_or(0.0, |slopes| slopes.normal_load * length);
            let full = carried * self.operators.mean.scene.faces * self.operators.mean.power_factor;
            let ratio = if full > 0.0 { state.end_force / full } else { 0.0 };
            let work = state.dissipated - dissipated;
            let distance = state.distance - distance;
            let radius = self.operators.scene.mean_radius;
            let travel = (length * inputs.after(slopes, 0.5 * length).velocity(radius)).abs();
            let plain = LumpedTemperature::constant(temperature, expansion);
            let path = InputTrajectory::new(self, inputs, slopes, inputs.normal_load, length, plain);
            let torque = path.impulse() * self.operators.mean.power_factor;
            let (heat_per_pressure, released) = match torque > 0.0 {
                true => (work * self.operators.mean.area / torque, 0.0),
                false => (0.0, work / length),
            };
            let coefficient = self.mean.kinetic_coefficient();
            let throughout = coefficient * torque > 0.0 && (distance - travel).abs() < SLIPS_THROUGHOUT * travel;
            // Where friction is that of the law, the speed at which its work is that of the bristle.
            let works = throughout && self.heat.is_some();
            let speed = if works { heat_per_pressure / coefficient } else { distance / length };
            Slipped { speed, throughout, ratio, heat_per_pressure, released }
        });
        let course = |start: f64, end: f64| [start, 0.5 * (start + end), end];
        Ok(LumpedTemperature {
            temperature: course(temperature, self.mean.end_temperature()),
            expansion: course(expansion, self.expansion()),
            slipped,
        })
    }

    /// Contact temperature (K) for these inputs at frozen states.
    fn temperature(&mut self, inputs: &Inputs) -> f64 {
        self.mean.point(inputs).contact_temperature + self.mean.state().reference
    }

    /// Displacement of both surfaces by the lumped temperature of the bodies, m into them.
    fn expansion(&self) -> f64 {
        if self.operators.scene.holder_stiffness > 0.0 && self.heat.is_none() {
            -self.mean.expansion_of_bodies()
        } else {
            0.0
        }
    }

    /// Sets limit bits and checks validity after an internal step.
    fn watch(&mut self) -> Result<(), StepFailure> {
        if let Some(name) = self.state.not_finite() {
            return Err(StepFailure(format!(
                "{name} along the contact line is not finite after the step: no solution was found"
            )));
        }
        let scene = &self.operators.scene;
        let deepest = |depths: &[f64]| depths.iter().copied().fold(0.0, maximum);
        self.state.limits |= lumped::limits_of_wear(scene, [deepest(&self.state.punch), deepest(&self.state.strip)])?;
        if let Some(heat) = &self.state.heat {
            let lowest = heat.lowest() + self.mean.state().reference;
            let highest = heat.temperature.iter().flatten().copied().fold(f64::NEG_INFINITY, maximum)
                + self.mean.state().reference;
            if lowest.is_nan() || lowest < 0.0 {
                let count = self.state.pressure.len();
                let carrying = self.state.pressure.iter().filter(|&&p| p > 0.0).count();
                return Err(StepFailure(format!(
                    "the surface temperatures are not resolved: {lowest} to {highest} K, with {carrying} of {count} cells in \
                     contact, at punch.conductivity = {}, strip.conductivity = {} W/(m.K) and solver.tolerance = {}",
                    Number(scene.punch.conductivity),
                    Number(scene.strip.conductivity),
                    Number(scene.tolerance),
                    lowest = Number(lowest),
                    highest = Number(highest)
                )));
            }
            // Means over a length are below the hottest cell.
            if lumped::limits_of_temperature(scene, highest) != 0 {
                let hottest = self.operators.hottest.of(&heat.temperature) + self.mean.state().reference;
                self.state.limits |= lumped::limits_of_temperature(scene, hottest);
            }
        }
        if self.state.track.as_ref().is_some_and(|track| track.revisited()) {
            self.state.limits |= limit::VALIDITY;
        }
        Ok(())
    }
}
