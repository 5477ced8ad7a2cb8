//! Component: parameters and inputs in, outputs out, step by step.
//!
//! It is driven by the C interface, the native host and the tests. It implements the variable table but not FMI: phases, status
//! codes and times belong to the FMI layer.

mod inputs;
mod messages;
mod outputs;
mod rates;
mod reports;
mod snapshot;

pub use inputs::LARGEST_INPUT;
pub(crate) use inputs::{LONGEST_STEP, SHORTEST_STEP};
pub(crate) use messages::Messages;
pub use snapshot::Snapshot;

use crate::panics::on_own_thread;
use contact::WorkCounter;
use model::levels::{Model, ModelOperators};
use model::lumped::conditions::Tunables;
use model::plan::BuiltModel;
use model::run_error::RunError;
use model::{INPUTS, Inputs};
use numerics::interruption;
use outputs::group;
use reports::{BOTH_VELOCITIES, WITHOUT_RADIUS};
use scene::message::Number;
use scene::variables::{COUNT, ValueReference, reference};
use scene::{Scene, value};
use std::sync::Arc;

/// Subject of a log message, from which the FMI categories are derived.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Subject {
    /// Chosen level, and the basis of the choice.
    Plan,
    /// A limit was reached, the model's validity was left, an input was replaced.
    Warning,
    /// A step or an initialisation failed.
    Error,
}

/// Log message.
#[derive(Clone, PartialEq, Debug)]
pub struct Message {
    /// Subject of the message.
    pub subject: Subject,
    /// One line of text.
    pub text: String,
}

/// One value for every value reference.
pub type Values = [f64; COUNT];

const FIRST_OUTPUT: usize = reference("wear_depth") as usize;
const FIRST_PARAMETER: usize = reference("punch.height") as usize;
/// Relative difference up to which steps have one length. Importers compute lengths as differences of times, and operators are found
/// again by the bits of the length. What is left is carried on, and made up for when it exceeds this.
const SAME_STEP: f64 = 1e-9;

/// Whether a step counts as long as another one.
fn is_as_long(step: f64, other: f64) -> bool {
    (step - other).abs() <= SAME_STEP * other
}

const _: () = assert!(FIRST_OUTPUT == INPUTS, "the inputs are the first rows of the variable table");

#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
enum Phase {
    #[default]
    Instantiated,
    Initializing,
    Running,
}

/// What the continuation of a run depends on beside values and model.
#[derive(Clone, PartialEq, Default, Debug)]
struct Run {
    /// Time derivatives of the inputs for the next step.
    slopes: [f64; INPUTS],
    phase: Phase,
    /// Tolerance given by the importer.
    tolerance: Option<f64>,
    /// Limits already logged.
    reported: u8,
    /// Inputs and tunable parameters are those of the end of the last step.
    at_end: bool,
    /// Length of the last step, s; 0: none yet.
    last_step: f64,
    /// Time by which the model is behind the importer, s: see [`SAME_STEP`].
    behind: f64,
}

/// Component: values, model and phase.
#[derive(Debug)]
pub struct Component {
    starts: Arc<Values>,
    values: Box<Values>,
    /// An input may be out of range, and has to be checked before the next step.
    suspect: bool,
    run: Run,
    /// An input derivative differs from 0: a cached property of the slopes, needed in every step.
    sloped: bool,
    model: Option<Model>,
    /// Groups of outputs that are up to date.
    current: u8,
    /// The model must be rebuilt before outputs are read (while initialising).
    stale: bool,
    /// Tolerance of the scene's default experiment: used where neither the importer nor `solver.tolerance` gives one.
    declared_tolerance: Option<f64>,
    /// Scene prepared last: reused for the same scene.
    prepared: Option<Arc<BuiltModel>>,
    /// Error of the run, once there is a model.
    run_error: Option<RunError>,
    messages: Messages,
}

impl Component {
    /// Component with these start values.
    pub fn new(starts: Arc<Values>) -> Component {
        let values = Box::new(*starts);
        Component {
            starts,
            values,
            suspect: false,
            run: Run::default(),
            sloped: false,
            model: None,
            current: 0,
            stale: true,
            declared_tolerance: None,
            prepared: None,
            run_error: None,
            messages: Messages::default(),
        }
    }

    /// Component with the tolerance declared by the scene's default experiment.
    pub fn declaring(self, tolerance: f64) -> Component {
        Component { declared_tolerance: Some(tolerance), ..self }
    }

    /// The scene of these values; `tolerance` of the importer, where `solver.tolerance` is 0.
    fn scene_of(&self, values: &Values, tolerance: Option<f64>) -> Result<Scene, String> {
        Scene::new(values, tolerance.or(self.declared_tolerance)).map_err(|broken| broken.to_string())
    }

    /// Resets to the state of [`Component::new`]; the prepared scene is kept for reuse.
    pub fn reset(&mut self) {
        let (prepared, messages) = (self.prepared.take(), std::mem::take(&mut self.messages));
        let declared_tolerance = self.declared_tolerance;
        *self = Component { declared_tolerance, ..Component::new(self.starts.clone()) };
        (self.prepared, self.messages) = (prepared, messages);
        let _ = self.messages.take();
    }

    fn build(&mut self, scene: &Scene) -> Result<(), String> {
        let known = self.prepared.take().filter(|prepared| prepared.requested == *scene);
        let prepared = match known {
            Some(prepared) => prepared,
            None => prepare(scene)?,
        };
        let inputs = inputs_of(&self.values);
        let tunables = tunables_of(&self.values);
        self.model = Some(Model::new(&prepared.operators, tunables, &inputs));
        self.run_error = Some(RunError::new(&prepared, tunables, &inputs));
        self.prepared = Some(prepared);
        self.current = 0;
        self.run.at_end = false;
        Ok(())
    }

    /// Stores a parameter accepted by [`scene::variables::check_parameter`]. A tunable parameter takes effect immediately.
    pub fn set_parameter(&mut self, reference: ValueReference, value: f64) {
        self.values[reference as usize] = value;
        // The ambient temperature and its offset are checked together.
        self.suspect = true;
        self.current = 0;
        self.run.at_end = false;
        self.stale = true;
        if self.run.phase == Phase::Running {
            let tunables = tunables_of(&self.values);
            if let Some(model) = &mut self.model {
                model.set_tunables(tunables);
            }
            if let Some(run_error) = &mut self.run_error {
                run_error.set_tunables(tunables);
            }
        }
    }

    /// Stores an input unchecked, and sets its derivative to 0.
    #[inline]
    pub fn set_input(&mut self, reference: ValueReference, value: f64) {
        let index = reference as usize;
        if self.sloped {
            self.run.slopes[index] = 0.0;
            self.sloped = is_sloped(&self.run.slopes);
        }
        if self.values[index].to_bits() != value.to_bits() {
            self.values[index] = value;
            self.suspect |= inputs::needs_check(index, value);
            self.current &= group::ACCOUNT;
            self.run.at_end = false;
            self.stale = true;
        }
    }

    /// Stores the time derivative of an input for the next step.
    pub fn set_input_derivative(&mut self, reference: ValueReference, value: f64) {
        self.run.slopes[reference as usize] = value;
        self.sloped = is_sloped(&self.run.slopes);
    }

    /// Sets the tolerance given by the importer for the run, which also applies to outputs while initialising.
    pub(crate) fn set_importer_tolerance(&mut self, tolerance: Option<f64>) {
        self.run.tolerance = tolerance;
    }

    /// Enters initialisation: from here on outputs are those of the current inputs.
    pub fn enter_initialization(&mut self) {
        self.run.phase = Phase::Initializing;
        self.stale = true;
        self.current = 0;
    }

    /// Ends initialisation: checks the rules between parameters and builds the model.
    ///
    /// # Errors
    /// A text that names the variables, their values and the limit; the component is unchanged.
    pub fn initialise(&mut self, tolerance: Option<f64>) -> Result<(), String> {
        self.run.tolerance = tolerance;
        self.check_inputs(0.0)?;
        let scene = self.scene_of(&self.values, self.run.tolerance)?;
        self.build(&scene)?;
        self.check_outputs()?;
        self.run.phase = Phase::Running;
        self.announce(&scene);
        self.messages.reserve();
        Ok(())
    }

    /// Advances by one communication step of `step` seconds (>= 0).
    ///
    /// # Errors
    /// A text that names the cause; the state is then that before the step.
    pub fn step(&mut self, step: f64) -> Result<(), String> {
        interruption::checkpoint();
        if step == 0.0 {
            // Input derivatives are valid for one step, also for one of length 0.
            self.run.slopes = [0.0; INPUTS];
            self.sloped = false;
            return Ok(());
        }
        let [shortest, longest] = [SHORTEST_STEP, LONGEST_STEP].map(Number);
        if step < SHORTEST_STEP {
            return Err(format!("the step of {} s is shorter than {shortest} s and not 0", Number(step)));
        }
        if step > LONGEST_STEP {
            return Err(format!("the step of {} s is longer than {longest} s", Number(step)));
        }
        if self.suspect || self.sloped {
            self.check_inputs(step)?;
            self.suspect = false;
        }
        let Some(model) = &mut self.model else { return Err("the component is not initialised".into()) };
        let (began, slopes) = (inputs_of(&self.values), self.sloped.then(|| Inputs::from_array(self.run.slopes)));
        let due = step + self.run.behind;
        let (unit, length) = match is_as_long(step, self.run.last_step) {
            true if is_as_long(due, self.run.last_step) => (self.run.last_step, self.run.last_step),
            true => (self.run.last_step, due),
            false if due > 0.0 => (step, due),
            false => (self.run.last_step, 0.0),
        };
        if length > 0.0 {
            model.step(&began, slopes.as_ref(), length).map_err(|failure| failure.to_string())?;
            if let (Some(run_error), Some(prepared)) = (&mut self.run_error, &self.prepared)
                && let Some(notice) = run_error.follow(prepared, model, &began, slopes.as_ref(), length)
            {
                self.messages.add(Subject::Warning, format_args!("{notice}"));
            }
        }
        (self.run.last_step, self.run.behind) = (unit, due - length);
        self.run.at_end = !self.sloped && !model.has_bristle();
        if self.sloped {
            for (value, slope) in self.values.iter_mut().zip(&mut self.run.slopes) {
                *value += *slope * step;
                *slope = 0.0;
            }
            self.sloped = false;
        }
        self.current = 0;
        if self.run.at_end {
            model.write_end(&mut self.values);
            self.current = group::MAIN;
        }
        let mut limits = model.limits();
        if began.sliding_velocity != 0.0 && began.angular_velocity != 0.0 {
            limits |= BOTH_VELOCITIES;
        }
        if began.angular_velocity != 0.0 && value!(self.values, "contact.mean_radius") == 0.0 {
            limits |= WITHOUT_RADIUS;
        }
        if limits & !self.run.reported != 0 {
            self.report(limits, &began);
        }
        Ok(())
    }

    /// Derivatives of `unknowns` (outputs) in the direction `seed` of `knowns` (inputs), at frozen states.
    ///
    /// # Errors
    /// If a known is not an input or an unknown not an output, an input is one that a step refuses, or the component has no model
    /// yet.
    pub fn directional_derivative(
        &mut self,
        unknowns: &[ValueReference],
        knowns: &[ValueReference],
        seed: &[f64],
        result: &mut [f64],
    ) -> Result<(), String> {
        let mut direction = [0.0; INPUTS];
        for (&known, &part) in knowns.iter().zip(seed) {
            let Some(slot) = direction.get_mut(known as usize) else {
                return Err(format!("value reference {known} is not an input"));
            };
            *slot += part;
        }
        check_unknowns(unknowns)?;
        if unknowns.is_empty() {
            return Ok(());
        }
        if self.suspect {
            self.check_inputs(0.0)?;
        }
        // Builds the model if initialisation has not ended yet.
        self.get(FIRST_OUTPUT as ValueReference);
        let inputs = inputs_of(&self.values);
        let Some(model) = &mut self.model else {
            return Err("no derivatives before the parameters join to a scene".into());
        };
        let mut derivatives = [0.0; COUNT];
        model.write_derivatives(&inputs, &Inputs::from_array(direction), &mut derivatives);
        for (slot, &unknown) in result.iter_mut().zip(unknowns) {
            *slot = derivatives[unknown as usize];
        }
        Ok(())
    }

    /// Ends the run: logs advice where its error is above the tolerance.
    pub fn conclude(&mut self) {
        if self.run.last_step == 0.0 {
            return;
        }
        let steps = self.get(reference("estimated_step_error"));
        if let (Some(run_error), Some(prepared)) = (&self.run_error, &self.prepared) {
            self.messages.compose(Subject::Warning, |text| run_error.write_advice(prepared, steps, text));
        }
    }

    /// Messages since the last call.
    pub fn messages(&mut self) -> std::slice::Iter<'_, Message> {
        self.messages.take()
    }

    /// Whether there is a message.
    #[inline]
    pub fn has_messages(&self) -> bool {
        !self.messages.is_empty()
    }
}

/// Prepares a scene on a thread of its own, see [`on_own_thread`].
fn prepare(scene: &Scene) -> Result<Arc<BuiltModel>, String> {
    let flag = interruption::current();
    on_own_thread(move || interruption::within(flag, || BuiltModel::new(scene, steady::run_in).map(Arc::new)))
}

/// Checks that all of these are outputs.
fn check_unknowns(unknowns: &[ValueReference]) -> Result<(), String> {
    let unknown = unknowns.iter().find(|&&unknown| !(FIRST_OUTPUT..FIRST_PARAMETER).contains(&(unknown as usize)));
    unknown.map_or(Ok(()), |unknown| Err(format!("value reference {unknown} is not an output")))
}

/// Whether a derivative differs from 0; by the bits, as [`inputs::needs_check`].
fn is_sloped(slopes: &[f64; INPUTS]) -> bool {
    slopes.iter().any(|slope| slope.abs().to_bits() != 0)
}

fn inputs_of(values: &Values) -> Inputs {
    Inputs::from_array(std::array::from_fn(|index| values[index]))
}

/// Value references of [`Tunables::NAMES`].
const TUNABLES: [usize; Tunables::NAMES.len()] = {
    let mut references = [0; Tunables::NAMES.len()];
    let mut index = 0;
    while index < references.len() {
        references[index] = reference(Tunables::NAMES[index]) as usize;
        index += 1;
    }
    references
};

fn tunables_of(values: &Values) -> Tunables {
    Tunables::from_array(TUNABLES.map(|index| values[index]))
}

impl Component {
    /// Accepted and rejected internal steps since initialisation: the work counters of the charts.
    pub fn work(&self) -> (u64, u64) {
        self.model.as_ref().map_or((0, 0), Model::work)
    }

    /// Work counters of the contact solver since initialisation; zero at the lumped level.
    pub fn contact_work(&self) -> WorkCounter {
        self.model.as_ref().map_or_else(WorkCounter::default, Model::contact_work)
    }

    /// Operators of the current level; `None` before initialisation.
    pub fn operators(&self) -> Option<ModelOperators> {
        self.model.as_ref().map(Model::operators)
    }
}
