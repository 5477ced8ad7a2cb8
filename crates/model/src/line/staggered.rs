//! Operator split between contact and heat over a piece of a communication step.
//!
//! Theory: docs/theory.md, section 5.6.

use super::Line;
use super::coupling::Refusal;
use super::trajectory::InputTrajectory;
use crate::StepFailure;
use crate::budget::MOST_STEPS;
use scene::message::Number;

impl Line {
    /// Advances contact and heat over a piece by the operator split, in one step, or in as many as the worn track in the strip
    /// requires.
    pub(super) fn staggered(&mut self, path: &InputTrajectory, length: f64) -> Result<(), StepFailure> {
        let mut parts: u32 = 1;
        let far = |line: &Line, step: f64| {
            line.exceeds_travel_limit(path, 0.0, step) || line.exceeds_travel_limit(path, length - step, step)
        };
        // The step budget ends the loop below for more parts.
        while parts < MOST_STEPS && far(self, length / f64::from(parts)) {
            parts *= 2;
        }
        let step = length / f64::from(parts);
        for part in 0..parts {
            let start = f64::from(part) * step;
            self.spend(path, start)?;
            let (given, stages, Some(heat)) = self.parts() else {
                unreachable!("only scenes with heat along the line come here")
            };
            match heat.prepare(&given, path, start, step).split(&given, stages, path, start) {
                Ok(()) => {}
                Err(Refusal::Stage(error)) => return Err(self.failure(path, start, &error)),
                Err(Refusal::Diverges(limit)) => {
                    return Err(StepFailure(format!(
                        "solver.scheme = staggered is stable only for steps below {limit} s here (sliding velocity {} m/s, \
                         normal load {} N); the step is {step} s",
                        Number(path.velocity(start + step)),
                        Number(path.at(start + step).load),
                        limit = Number(limit),
                        step = Number(step)
                    )));
                }
            }
            self.accept(path, start, step)?;
            self.state.steps += 1;
        }
        Ok(())
    }
}
