//! The implicit step by itself, to show what the control around it is for.

use super::Line;
use super::path::{Heat, Path};
use super::step::Outcome;
use crate::coupled::{INPUTS, StepFailure};

impl Line {
    /// One implicit step of `length` (s) at constant inputs whatever its error, and however fast the pressure grows that
    /// it may hide. Only pressure, wear and heat of the contact line move on; distance and mean stay.
    ///
    /// # Errors
    /// [`StepFailure`] where a stage has no solution; the state is the one before.
    pub fn unguarded_step(&mut self, inputs: &[f64; INPUTS], length: f64) -> Result<(), StepFailure> {
        let heat = Heat::constant(self.mean.state().reference, 0.0);
        let path = Path::new(self, inputs, None, length, heat);
        match self.attempt(&path, 0.0, length) {
            Outcome::Tried(_) => {
                self.accept(&path, 0.0, length);
                self.forget_shown();
                Ok(())
            }
            Outcome::Failed(error) => Err(self.failure(&path, 0.0, &error)),
        }
    }
}
