//! Common interface of the model levels, as the component uses it.
//!
//! Theory: docs/theory.md, section 8.1.

use super::line::operators::{RunIn, Shared};
use super::line::{self, Line};
use super::lumped::conditions::Tunables;
use super::lumped::{self, Lumped};
use super::tolerance::ToleranceBudget;
use super::{Inputs, StepFailure};
use contact::WorkCounter;
use scene::variables::COUNT;
use scene::{Fidelity, Scene};
use std::borrow::Cow;
use std::fmt;
use std::sync::Arc;

/// Operators of a level, shared by all states of a scene.
#[derive(Clone, Debug)]
pub enum ModelOperators {
    /// Lumped level: uniform pressure.
    Lumped(Arc<lumped::operators::LumpedOperators>),
    /// Line level: pressure on cells.
    Line(Arc<line::operators::LineOperators>),
}

/// State of a level.
#[derive(Clone, PartialEq, Debug)]
pub struct ModelState {
    /// State of the lumped level, which is part of every level.
    pub mean: lumped::state::LumpedState,
    /// The contact line; `None` at the lumped level.
    pub line: Option<SavedLine>,
}

/// State of a contact line.
#[derive(Clone, PartialEq, Debug)]
pub enum SavedLine {
    /// As it is.
    State(Box<line::state::LineState>),
    /// Its numbers, before the operators are known to which it belongs.
    Numbers(Vec<f64>),
}

impl SavedLine {
    /// All numbers; their count depends on the scene.
    pub fn numbers(&self) -> Cow<'_, [f64]> {
        match self {
            SavedLine::State(line) => line.numbers().into(),
            SavedLine::Numbers(numbers) => numbers.into(),
        }
    }
}

impl ModelState {
    /// Name and value of a number larger than `most` in magnitude, if any.
    pub fn larger_than(&self, most: f64) -> Option<(&'static str, f64)> {
        let of_line = || self.line.as_ref().and_then(|line| line::saved::larger_than(&line.numbers(), most));
        self.mean.larger_than(most).or_else(of_line)
    }

    /// The state as one of `operators`, made in `place` from numbers; `None` where it is not one.
    pub fn of<'a>(&'a self, operators: &ModelOperators, place: &'a mut Option<ModelState>) -> Option<&'a ModelState> {
        let state = match (&self.line, operators) {
            (None, ModelOperators::Lumped(_)) => self,
            (Some(SavedLine::State(line)), ModelOperators::Line(operators)) if line.fits(operators) => self,
            (Some(SavedLine::Numbers(numbers)), ModelOperators::Line(operators)) => {
                let line = SavedLine::State(Box::new(line::state::LineState::load(operators, numbers)?));
                place.insert(ModelState { mean: self.mean.clone(), line: Some(line) })
            }
            _ => return None,
        };
        self.mean.fits(operators.mean()).then_some(state)
    }
}

/// Instance of a scene at its level. The lumped level, the more frequent one, is stored in place, so that its step follows no
/// pointer.
#[derive(Clone, Debug)]
#[allow(clippy::large_enum_variant, reason = "see above")]
pub enum Model {
    /// Lumped level: uniform pressure.
    Lumped(Lumped),
    /// Line level: pressure on cells.
    Line(Box<Line>),
}

impl ModelOperators {
    /// Builds the operators of the scene's level.
    ///
    /// # Errors
    /// A text with the numbers where a body, or the run-in state, does not exist.
    pub fn new(scene: &Scene, run_in: RunIn) -> Result<ModelOperators, String> {
        Self::sharing(scene, None, &mut Shared::default(), run_in).map(ModelOperators::ready)
    }

    /// Builds the operators of the level of `scene`, which has the same bodies, contact and nominal conditions as theirs, and shares what
    /// [`lumped::operators::LumpedOperators::beside`] does.
    pub fn beside(&self, scene: &Scene, run_in: RunIn) -> Result<ModelOperators, String> {
        Self::sharing(scene, Some(self), &mut Shared::default(), run_in).map(ModelOperators::ready)
    }

    /// These operators with the responses of their bodies computed for the velocities of a run.
    pub(crate) fn ready(self) -> ModelOperators {
        if let ModelOperators::Line(line) = &self {
            let bodies = line.heat.iter().flat_map(|bodies| bodies.prototypes.iter().flatten());
            // Up to half more than the nominal velocity.
            bodies.for_each(|body| body.expect(1.5 * line.scene.nominal_velocity));
        }
        self
    }

    /// [`ModelOperators::new`] or, with `known`, [`ModelOperators::beside`], with what contact lines share, not yet
    /// [`ModelOperators::ready`].
    pub(crate) fn sharing(
        scene: &Scene,
        known: Option<&ModelOperators>,
        shared: &mut Shared,
        run_in: RunIn,
    ) -> Result<ModelOperators, String> {
        let known = known.map(ModelOperators::mean);
        Ok(match (scene.fidelity, known) {
            (Fidelity::Line, _) => {
                ModelOperators::Line(Arc::new(line::operators::LineOperators::beside(scene, known, shared, run_in)?))
            }
            (_, Some(known)) => {
                ModelOperators::Lumped(Arc::new(lumped::operators::LumpedOperators::beside(scene, known)))
            }
            (_, None) => ModelOperators::Lumped(Arc::new(lumped::operators::LumpedOperators::new(scene))),
        })
    }

    /// Operators with the tunable parameters that they contain; `None` where they have them.
    fn tuned(&self, tunables: &Tunables) -> Option<ModelOperators> {
        let scene = tunables.tuned(self.scene())?;
        Some(match self {
            ModelOperators::Lumped(operators) => ModelOperators::Lumped(Arc::new(operators.tuned(scene))),
            ModelOperators::Line(operators) => ModelOperators::Line(Arc::new(operators.tuned(scene))),
        })
    }

    /// Checks tunable parameters that are to hold from here on.
    ///
    /// # Errors
    /// A text with variable, value and limit, where the model refuses a step with them.
    pub fn check_tunables(&self, tunables: &Tunables) -> Result<(), String> {
        if let Some(scene) = tunables.tuned(self.scene()) {
            scene.check_heat().map_err(|broken| broken.to_string())?;
        }
        let ModelOperators::Line(line) = self else { return Ok(()) };
        let (friction, acceleration) = (tunables.friction_coefficient, tunables.wear_acceleration);
        // Growth is set against wear alone.
        let of_wear = Tunables { wear_coefficient: tunables.wear_coefficient, ..Tunables::of(&line.scene) };
        let Some(scene) = of_wear.tuned(&line.scene) else { return line.check_acceleration(friction, acceleration) };
        line.check_tuned(&scene)?;
        line.tuned(scene).check_acceleration(friction, acceleration)
    }

    /// Operators of the lumped level, which are part of every level.
    pub fn mean(&self) -> &lumped::operators::LumpedOperators {
        match self {
            ModelOperators::Lumped(operators) => operators,
            ModelOperators::Line(operators) => &operators.mean,
        }
    }

    /// Scene from which the operators were built.
    pub fn scene(&self) -> &Scene {
        match self {
            ModelOperators::Lumped(operators) => &operators.scene,
            ModelOperators::Line(operators) => &operators.scene,
        }
    }

    /// Number of cells of the contact; 1 at the lumped level.
    pub fn cells(&self) -> usize {
        match self {
            ModelOperators::Lumped(_) => 1,
            ModelOperators::Line(operators) => operators.count(),
        }
    }

    /// Level, cells and states, for the log.
    pub fn description(&self) -> String {
        let mean = self.mean();
        let states = |body: &lumped::operators::BodyOperators| body.heat.as_ref().map_or(0, |heat| heat.count);
        let heat = format!(
            "thermal states: punch {}, strip {}, moving source {}",
            states(&mean.punch),
            states(&mean.strip),
            mean.flash.as_ref().map_or(0, |flash| flash.decays.rate.len())
        );
        match self {
            ModelOperators::Lumped(_) => format!("lumped; {heat}"),
            ModelOperators::Line(operators) => format!("line, {}", operators.description()),
        }
    }

    /// Part of a nominal stroke by which the slip is too long because elastic displacement along the sliding direction is neglected,
    /// `2 mu F n_f/(k s)`, and that length (m). Nothing without strokes, with elastic slip, and up to a tenth of the tolerance.
    pub(crate) fn neglected_slip(&self) -> Option<(f64, f64)> {
        let scene = self.scene();
        if scene.elastic_slip || scene.nominal_stroke == 0.0 {
            return None;
        }
        let lost = self.mean().deformation_at_reversal();
        let share = lost / scene.nominal_stroke;
        (share > ToleranceBudget::of(scene).unstated_slip).then_some((share, lost))
    }

    /// Warnings about the scene, before it runs.
    pub fn warnings(&self) -> Vec<String> {
        let mut warnings = match self {
            ModelOperators::Lumped(_) => Vec::new(),
            ModelOperators::Line(operators) => operators.warnings(),
        };
        let scene = self.scene();
        if self.mean().has_bristle() && scene.regularization_velocity > 0.0 {
            let cause = match scene.stick_stiffness {
                0.0 => "contact.tangential_compliance = elastic".to_owned(),
                stiffness => format!("contact.stick_stiffness = {stiffness} N/m"),
            };
            warnings.push(format!(
                "{cause} activates the bristle model, so contact.regularization_velocity = {} m/s has no effect",
                scene.regularization_velocity
            ));
        }
        warnings
    }
}

macro_rules! each {
    ($self:expr, $model:ident => $value:expr) => {
        match $self {
            Model::Lumped($model) => $value,
            Model::Line($model) => $value,
        }
    };
}

impl Model {
    /// Initial state at rest at the given inputs.
    pub fn new(operators: &ModelOperators, tunables: Tunables, inputs: &Inputs) -> Model {
        match operators.tuned(&tunables).as_ref().unwrap_or(operators) {
            ModelOperators::Lumped(operators) => Model::Lumped(Lumped::new(operators.clone(), tunables, inputs)),
            ModelOperators::Line(operators) => Model::Line(Box::new(Line::new(operators.clone(), tunables, inputs))),
        }
    }

    /// Operators built from the scene.
    pub fn operators(&self) -> ModelOperators {
        match self {
            Model::Lumped(model) => ModelOperators::Lumped(model.operators().clone()),
            Model::Line(model) => ModelOperators::Line(model.operators().clone()),
        }
    }

    /// Scene of the operators.
    #[inline]
    pub fn scene(&self) -> &Scene {
        each!(self, model => &model.operators().scene)
    }

    /// Copy of the whole state.
    pub fn save(&self) -> ModelState {
        match self {
            Model::Lumped(model) => ModelState { mean: model.state().clone(), line: None },
            Model::Line(model) => {
                let line = SavedLine::State(Box::new(model.save()));
                ModelState { mean: model.mean_state().clone(), line: Some(line) }
            }
        }
    }

    /// Replaces the whole state by one of its operators ([`ModelState::of`]).
    pub fn set_state(&mut self, state: &ModelState) {
        match (self, &state.line) {
            (Model::Lumped(model), None) => model.set_state(&state.mean),
            (Model::Line(model), Some(SavedLine::State(line))) => model.set_state(&state.mean, line),
            _ => unreachable!("the state is one of the operators"),
        }
    }

    /// Work (J) of the friction force on all faces since initialisation.
    #[inline]
    pub(crate) fn friction_work(&self) -> f64 {
        each!(self, model => model.friction_work())
    }

    /// Sets the parameters that may change between steps.
    pub fn set_tunables(&mut self, tunables: Tunables) {
        let operators = self.operators().tuned(&tunables);
        match (&mut *self, operators) {
            (Model::Lumped(model), Some(ModelOperators::Lumped(operators))) => model.set_operators(operators),
            (Model::Line(model), Some(ModelOperators::Line(operators))) => model.set_operators(operators),
            _ => {}
        }
        each!(self, model => model.set_tunables(tunables));
    }

    /// See [`Line::limit_attempts`]; without effect at the lumped level.
    pub(crate) fn limit_attempts(&mut self, most: u32, recurring: Option<usize>) {
        if let Model::Line(line) = self {
            line.limit_attempts(most, recurring);
        }
    }

    /// Whether a bristle models the friction force at standstill.
    #[inline]
    pub fn has_bristle(&self) -> bool {
        each!(self, model => model.has_bristle())
    }

    /// Limits reached so far; see [`lumped::limit`].
    #[inline]
    pub fn limits(&self) -> u8 {
        each!(self, model => model.limits())
    }

    /// Writes the message of a limit bit that contains numbers.
    pub fn write_warning(&self, bit: u8, inputs: &Inputs, text: &mut String) -> fmt::Result {
        each!(self, model => model.write_warning(bit, inputs, text))
    }

    /// Work counters of the contact solver; zero at the lumped level.
    pub fn contact_work(&self) -> WorkCounter {
        match self {
            Model::Lumped(_) => WorkCounter::default(),
            Model::Line(model) => model.contact_work(),
        }
    }

    /// Accepted and rejected internal steps.
    pub fn work(&self) -> (u64, u64) {
        match self {
            Model::Lumped(model) => (model.state().steps, model.state().rejected),
            Model::Line(model) => {
                let (mean, line) = (model.mean_state(), model.state());
                (mean.steps + line.steps, mean.rejected + line.rejected)
            }
        }
    }

    /// Advances the scene by `step` (s, > 0); on failure the state is unchanged.
    ///
    /// # Errors
    /// [`StepFailure`] names the quantity without a solution.
    #[inline]
    pub fn step(&mut self, inputs: &Inputs, slopes: Option<&Inputs>, step: f64) -> Result<(), StepFailure> {
        each!(self, model => model.step(inputs, slopes, step))
    }

    /// Writes the outputs with direct feedthrough (except `friction_slope`), and the worn depths.
    pub fn write_contact(&mut self, inputs: &Inputs, values: &mut [f64; COUNT]) {
        each!(self, model => model.write_contact(inputs, values));
    }

    /// Writes the main outputs at the end of the last step, valid for its final inputs only.
    #[inline]
    pub fn write_end(&self, values: &mut [f64; COUNT]) {
        each!(self, model => model.write_end(values));
    }

    /// Writes the outputs that depend on the states only.
    pub fn write_account(&self, values: &mut [f64; COUNT]) {
        each!(self, model => model.write_account(values));
    }

    /// Writes `friction_slope` and the profiles.
    pub fn write_rest(&mut self, inputs: &Inputs, values: &mut [f64; COUNT]) {
        each!(self, model => model.write_rest(inputs, values));
    }

    /// Derivatives of every output in the direction `seed` of the inputs, at frozen states.
    pub fn write_derivatives(&mut self, inputs: &Inputs, seed: &Inputs, derivatives: &mut [f64; COUNT]) {
        each!(self, model => model.write_derivatives(inputs, seed, derivatives));
    }
}
