//! The lumped level beside a contact line, on the inputs of the run: how far both are apart shows how uneven the pressure of this run
//! is, and with it how far the errors of the plan apply.
//!
//! Both the error of the cells and the distance of the lumped level come from the uneven pressure. With e the error of the chosen line and u
//! that of the lumped level over the nominal trajectory, and d the largest distance of both levels in the run so far, the error of the run
//! is about `e d/u`: nothing is assumed of how it depends on load, speed and duration.
//!
//! Theory: docs/theory.md, section 8.2.

use crate::INPUTS;
use crate::levels::{Model, ModelOperators, ModelState};
use crate::lumped::conditions::Tunables;
use crate::lumped::state::LumpedState;
use numerics::maximum::maximum;
use scene::value;
use scene::variables::COUNT;

/// Wear depth, rise of the contact temperature and friction force.
type Main = [f64; 3];

/// Largest distance of two levels so far, and the largest values of the first.
#[derive(Clone, Copy, PartialEq, Default, Debug)]
pub struct LevelDistance {
    /// Largest differences of wear depth (m), temperature rise (K) and friction force (N).
    pub apart: Main,
    /// Largest magnitudes at the first level.
    pub largest: Main,
}

impl LevelDistance {
    /// Takes the main outputs of both levels at an instant.
    pub fn follow(&mut self, one: Main, other: Main) {
        for output in 0..3 {
            self.apart[output] = maximum(self.apart[output], (one[output] - other[output]).abs());
            self.largest[output] = maximum(self.largest[output], one[output].abs());
        }
    }

    /// The largest relative difference: each output relative to its largest value. Infinite where that is 0 at the first level alone.
    pub fn relative(&self) -> f64 {
        let ratios = self.apart.iter().zip(self.largest);
        ratios.map(|(apart, largest)| if *apart == 0.0 { 0.0 } else { apart / largest }).fold(0.0, maximum)
    }
}

/// The lumped level of a scene, advanced beside its contact line.
#[derive(Clone, Debug)]
pub struct Companion {
    lumped: Model,
    ambient: f64,
    values: Box<[f64; COUNT]>,
}

impl Companion {
    /// At rest at the given inputs; `operators` are those of the lumped level.
    pub fn new(operators: &ModelOperators, tunables: Tunables, inputs: &[f64; INPUTS]) -> Companion {
        let lumped = Model::new(operators, tunables, inputs);
        Companion { lumped, ambient: tunables.ambient_temperature, values: Box::new([0.0; COUNT]) }
    }

    /// Sets the parameters that may change between steps.
    pub fn set_tunables(&mut self, tunables: Tunables) {
        self.lumped.set_tunables(tunables);
        self.ambient = tunables.ambient_temperature;
    }

    /// Copy of the state.
    pub fn save(&self) -> Option<LumpedState> {
        match self.lumped.save() {
            ModelState::Lumped(state) => Some(state),
            ModelState::Line(..) => None,
        }
    }

    /// Replaces the state by one of the same operators.
    pub fn set_state(&mut self, state: LumpedState) {
        self.lumped.set_state(&ModelState::Lumped(state));
    }

    /// Makes the step that `line` has just made, and adds the distance of both at its end. `None` where the lumped level has no
    /// solution: from there on nothing is known of the distance.
    pub fn follow(
        &mut self,
        line: &Model,
        inputs: &[f64; INPUTS],
        slopes: Option<&[f64; INPUTS]>,
        step: f64,
        so_far: &LevelDistance,
    ) -> Option<LevelDistance> {
        self.lumped.step(inputs, slopes, step).ok()?;
        let other = self.main_of(None);
        let one = self.main_of(Some(line));
        let mut distance = *so_far;
        distance.follow(one, other);
        distance.apart.iter().all(|apart| apart.is_finite()).then_some(distance)
    }

    /// Main outputs at the end of the last step of `model`, or of the lumped level.
    fn main_of(&mut self, model: Option<&Model>) -> Main {
        model.unwrap_or(&self.lumped).write_end(&mut self.values);
        let values = &self.values;
        [
            value!(values, "wear_depth"),
            value!(values, "contact_temperature") - self.ambient,
            value!(values, "friction_force"),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_distance_is_relative_to_the_largest_value_of_each_output() {
        let mut distance = LevelDistance::default();
        assert_eq!(distance.relative(), 0.0);
        distance.follow([1.0, 10.0, 0.0], [1.0, 11.0, 0.0]);
        assert_eq!(distance.relative(), 0.1);
        // A peak that both levels have makes what went before less.
        distance.follow([1.0, -50.0, 4.0], [1.0, -50.0, 4.0]);
        assert_eq!(distance.relative(), 0.02);
        distance.follow([1.0, 0.0, 4.0], [1.0, 0.0, 6.0]);
        assert_eq!(distance.relative(), 0.5);
        let mut without = LevelDistance::default();
        without.follow([0.0; 3], [0.0, 1.0, 0.0]);
        assert_eq!(without.relative(), f64::INFINITY);
        distance.follow([f64::NAN, 0.0, 4.0], [1.0, 0.0, 6.0]);
        assert!(distance.relative().is_nan());
    }
}
