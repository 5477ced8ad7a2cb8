//! The levels behind one face: what the component talks to.
//!
//! Theory: docs/theory.md, section 8.1.

use super::line::operators::RunIn;
use super::line::{self, Line};
use super::lumped::conditions::Tunables;
use super::lumped::{self, Lumped};
use super::{INPUTS, StepFailure};
use contact::WorkCounter;
use scene::variables::COUNT;
use scene::{Fidelity, Scene};
use std::fmt;
use std::sync::Arc;

/// What a level is made of, shared by every state of a scene.
#[derive(Clone, Debug)]
pub enum ModelOperators {
    /// Uniform pressure.
    Lumped(Arc<lumped::operators::LumpedOperators>),
    /// Cells.
    Line(Arc<line::operators::LineOperators>),
}

/// Everything that changes.
#[derive(Clone, PartialEq, Debug)]
pub enum ModelState {
    /// Of the lumped level.
    Lumped(lumped::state::LumpedState),
    /// Of the line level: mean, and the contact as numbers whose count the scene decides.
    Line(lumped::state::LumpedState, Vec<f64>),
}

/// A scene at its level. The common one is stored in place, so that its step follows no pointer.
#[derive(Clone, Debug)]
#[allow(clippy::large_enum_variant, reason = "see above")]
pub enum Model {
    /// Uniform pressure.
    Lumped(Lumped),
    /// Cells.
    Line(Box<Line>),
}

impl ModelOperators {
    /// Builds the level that the scene asks for.
    ///
    /// # Errors
    /// A text with the numbers where a body, or the run-in state, does not exist.
    pub fn new(scene: &Scene, run_in: RunIn) -> Result<ModelOperators, String> {
        Ok(match scene.fidelity {
            Fidelity::Line | Fidelity::Field => {
                ModelOperators::Line(Arc::new(line::operators::LineOperators::new(scene, run_in)?))
            }
            _ => ModelOperators::Lumped(Arc::new(lumped::operators::LumpedOperators::new(scene))),
        })
    }

    /// Builds the contact line of `scene`, whose lumped level these are, with their reduced bodies for its mean.
    ///
    /// # Errors
    /// As [`ModelOperators::new`].
    pub fn line_beside(&self, scene: &Scene, run_in: RunIn) -> Result<ModelOperators, String> {
        Ok(ModelOperators::Line(Arc::new(line::operators::LineOperators::beside(scene, self.mean(), run_in)?)))
    }

    /// Those of the mean, which every level has.
    pub fn mean(&self) -> &lumped::operators::LumpedOperators {
        match self {
            ModelOperators::Lumped(operators) => operators,
            ModelOperators::Line(operators) => &operators.mean,
        }
    }

    /// The scene they were built from.
    pub fn scene(&self) -> &Scene {
        match self {
            ModelOperators::Lumped(operators) => &operators.scene,
            ModelOperators::Line(operators) => &operators.scene,
        }
    }

    /// Cells of the contact; 1 at the lumped level.
    pub fn cells(&self) -> usize {
        match self {
            ModelOperators::Lumped(_) => 1,
            ModelOperators::Line(operators) => operators.count(),
        }
    }

    /// The same contact line with its heat by the mean: no elastic body is built anew. The lumped level is what it is.
    pub fn with_mean_heat(&self) -> ModelOperators {
        match self {
            ModelOperators::Lumped(_) => self.clone(),
            ModelOperators::Line(operators) => ModelOperators::Line(Arc::new(operators.with_heat_by_its_mean())),
        }
    }

    /// What was chosen, for the log.
    pub fn plan(&self) -> String {
        let mean = match self {
            ModelOperators::Lumped(operators) => operators,
            ModelOperators::Line(operators) => &operators.mean,
        };
        let states = |body: &lumped::operators::BodyOperators| body.heat.as_ref().map_or(0, |heat| heat.count);
        let heat = format!(
            "thermal states: punch {}, strip {}, moving source {}",
            states(&mean.punch),
            states(&mean.strip),
            mean.flash.as_ref().map_or(0, |flash| flash.decays.rate.len())
        );
        match self {
            ModelOperators::Lumped(_) => format!("level lumped; {heat}"),
            ModelOperators::Line(operators) => format!("level line; {}; {heat}", operators.plan()),
        }
    }

    /// What a user should know about the scene before it runs.
    pub fn warnings(&self) -> Vec<String> {
        let mut warnings = match self {
            ModelOperators::Lumped(_) => Vec::new(),
            ModelOperators::Line(operators) => operators.warnings(),
        };
        let scene = self.scene();
        if scene.stick_stiffness > 0.0 && scene.regularization_velocity > 0.0 {
            warnings.push(format!(
                "contact.stick_stiffness = {} N/m carries the force at standstill, so contact.regularization_velocity = {} m/s \
                 has no effect",
                scene.stick_stiffness, scene.regularization_velocity
            ));
        }
        warnings
    }
}

impl ModelState {
    /// Whether the state can belong to `operators`.
    pub fn fits(&self, operators: &ModelOperators) -> bool {
        match (self, operators) {
            (ModelState::Lumped(state), ModelOperators::Lumped(operators)) => state.fits(operators),
            (ModelState::Line(mean, numbers), ModelOperators::Line(operators)) => {
                mean.fits(&operators.mean) && line::state::LineState::load(operators, numbers).is_some()
            }
            _ => false,
        }
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
    /// Starts from rest at the given inputs.
    pub fn new(operators: &ModelOperators, tunables: Tunables, inputs: &[f64; INPUTS]) -> Model {
        match operators {
            ModelOperators::Lumped(operators) => Model::Lumped(Lumped::new(operators.clone(), tunables, inputs)),
            ModelOperators::Line(operators) => Model::Line(Box::new(Line::new(operators.clone(), tunables, inputs))),
        }
    }

    /// What the scene was made into.
    pub fn operators(&self) -> ModelOperators {
        match self {
            Model::Lumped(model) => ModelOperators::Lumped(model.operators().clone()),
            Model::Line(model) => ModelOperators::Line(model.operators().clone()),
        }
    }

    /// The scene.
    #[inline]
    pub fn scene(&self) -> &Scene {
        each!(self, model => &model.operators().scene)
    }

    /// Everything that changes, copied.
    pub fn save(&self) -> ModelState {
        match self {
            Model::Lumped(model) => ModelState::Lumped(model.state().clone()),
            Model::Line(model) => {
                let mut numbers = Vec::with_capacity(8 * model.operators().count() + 64);
                model.save(&mut numbers);
                ModelState::Line(model.mean_state().clone(), numbers)
            }
        }
    }

    /// Replaces everything that changes with a state that fits.
    pub fn set_state(&mut self, state: &ModelState) {
        match (self, state) {
            (Model::Lumped(model), ModelState::Lumped(state)) => model.set_state(state),
            (Model::Line(model), ModelState::Line(mean, numbers)) => {
                if let Some(line) = line::state::LineState::load(model.operators(), numbers) {
                    model.set_state(mean, &line);
                }
            }
            _ => unreachable!("State::fits was asked before"),
        }
    }

    /// Work (J) of the friction force on all faces since initialisation.
    #[inline]
    pub fn friction_work(&self) -> f64 {
        match self {
            Model::Lumped(model) => model.friction_work(),
            Model::Line(model) => model.friction_work(),
        }
    }

    /// Parameters that may change between steps.
    pub fn set_tunables(&mut self, tunables: Tunables) {
        each!(self, model => model.set_tunables(tunables));
    }

    /// From here on a contact line tries at most `most` internal steps: a step that would need more fails.
    pub fn limit_attempts(&mut self, most: u32) {
        if let Model::Line(line) = self {
            line.limit_attempts(most);
        }
    }

    /// Whether all internal steps that were allowed are used up.
    pub fn out_of_attempts(&self) -> bool {
        matches!(self, Model::Line(line) if line.attempts_left() == Some(0))
    }

    /// Whether a bristle carries the force at standstill.
    #[inline]
    pub fn has_bristle(&self) -> bool {
        each!(self, model => model.has_bristle())
    }

    /// Limits reached so far; see [`lumped::limit`].
    #[inline]
    pub fn limits(&self) -> u8 {
        each!(self, model => model.limits())
    }

    /// Writes what a bit of the limits says where its text depends on numbers.
    ///
    /// # Errors
    /// Those of `text`.
    pub fn write_warning(&self, bit: u8, inputs: &[f64; INPUTS], text: &mut String) -> fmt::Result {
        match self {
            Model::Lumped(_) => Ok(()),
            Model::Line(model) => model.write_warning(bit, inputs, text),
        }
    }

    /// What the contact solver has done so far; nothing at the lumped level.
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

    /// Carries the scene over `step` (s, > 0); on failure it is as before.
    ///
    /// # Errors
    /// [`StepFailure`] names what has no solution.
    #[inline]
    pub fn step(
        &mut self,
        inputs: &[f64; INPUTS],
        slopes: Option<&[f64; INPUTS]>,
        step: f64,
    ) -> Result<(), StepFailure> {
        each!(self, model => model.step(inputs, slopes, step))
    }

    /// Writes the outputs that answer the inputs (but `friction_slope`), and the worn depths.
    pub fn write_contact(&mut self, inputs: &[f64; INPUTS], values: &mut [f64; COUNT]) {
        each!(self, model => model.write_contact(inputs, values));
    }

    /// Writes the main outputs as the last step left them; for the inputs of its end only.
    #[inline]
    pub fn write_end(&self, values: &mut [f64; COUNT]) {
        each!(self, model => model.write_end(values));
    }

    /// Writes the outputs that only the states give.
    pub fn write_account(&self, values: &mut [f64; COUNT]) {
        each!(self, model => model.write_account(values));
    }

    /// Writes `friction_slope` and the profiles.
    pub fn write_rest(&mut self, inputs: &[f64; INPUTS], values: &mut [f64; COUNT]) {
        each!(self, model => model.write_rest(inputs, values));
    }

    /// Derivatives of every output in the direction `seed` of the inputs, with the states held.
    pub fn write_derivatives(&mut self, inputs: &[f64; INPUTS], seed: &[f64; INPUTS], derivatives: &mut [f64; COUNT]) {
        each!(self, model => model.write_derivatives(inputs, seed, derivatives));
    }
}
