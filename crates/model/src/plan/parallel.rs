//! The lumped level in parallel with a contact line, on the inputs of the run: how far both are apart shows how uneven the pressure of
//! this run is, and with it how far the errors of the plan apply.
//!
//! Both the error of the cells and the distance of the lumped level come from the uneven pressure. With e the error of the chosen line and u
//! that of the lumped level over the nominal trajectory, and d the largest distance of both levels in the run so far, the error of the run
//! is about `e d/u`, under load and with the load released apart: nothing is assumed of how it depends on load, speed and duration.
//!
//! Theory: docs/theory.md, section 8.2.

use super::distance::{LevelDistance, Main};
use crate::INPUTS;
use crate::levels::{Model, ModelOperators, ModelState};
use crate::lumped::conditions::Tunables;
use crate::lumped::state::LumpedState;
use scene::value;
use scene::variables::COUNT;

/// The lumped level of a scene, advanced in parallel with its contact line.
#[derive(Clone, Debug)]
pub struct ParallelLumped {
    model: Model,
    /// Ambient temperature, K.
    ambient: f64,
    /// Outputs of either level: workspace.
    values: Box<[f64; COUNT]>,
}

impl ParallelLumped {
    /// At rest at the given inputs; `operators` are those of the lumped level.
    pub fn new(operators: &ModelOperators, tunables: Tunables, inputs: &[f64; INPUTS]) -> ParallelLumped {
        let model = Model::new(operators, tunables, inputs);
        ParallelLumped { model, ambient: tunables.ambient_temperature, values: Box::new([0.0; COUNT]) }
    }

    /// Sets the parameters that may change between steps.
    pub fn set_tunables(&mut self, tunables: Tunables) {
        self.model.set_tunables(tunables);
        self.ambient = tunables.ambient_temperature;
    }

    /// Copy of the state.
    pub fn save(&self) -> Option<LumpedState> {
        match self.model.save() {
            ModelState::Lumped(state) => Some(state),
            ModelState::Line(..) => None,
        }
    }

    /// Replaces the state by one of the same operators.
    pub fn set_state(&mut self, state: LumpedState) {
        self.model.set_state(&ModelState::Lumped(state));
    }

    /// Makes the step that `line` has just made, and adds the distance of both at its end, where the load may be released. `None` where the lumped level has no
    /// solution: from there on nothing is known of the distance.
    pub fn follow(
        &mut self,
        line: &Model,
        inputs: &[f64; INPUTS],
        slopes: Option<&[f64; INPUTS]>,
        step: f64,
        is_released: bool,
        so_far: &LevelDistance,
    ) -> Option<LevelDistance> {
        self.model.step(inputs, slopes, step).ok()?;
        line.write_end(&mut self.values);
        let first = self.main();
        self.model.write_end(&mut self.values);
        let other = self.main();
        let mut distance = *so_far;
        distance.follow(first, other, is_released);
        distance.apart.iter().flatten().all(|apart| apart.is_finite()).then_some(distance)
    }

    /// Main outputs among those written last.
    fn main(&self) -> Main {
        let values = &self.values;
        [
            value!(values, "wear_depth"),
            value!(values, "contact_temperature") - self.ambient,
            value!(values, "friction_force"),
        ]
    }
}
