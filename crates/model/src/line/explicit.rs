//! Explicit Euler scheme, for comparison: its step is limited by stability.
//!
//! Theory: docs/theory.md, section 5.6.

use super::Line;
use super::trajectory::InputTrajectory;
use crate::StepFailure;
use conduction::line::GAMMA;
use contact::wear::line::explicit_limit;
use scene::message::Number;

impl Line {
    /// One explicit Euler step over the piece, rejected beyond its stability limit.
    pub(super) fn explicit(&mut self, path: &InputTrajectory, length: f64) -> Result<(), StepFailure> {
        let moment = path.at(0.0);
        let (given, stages, _) = self.parts();
        stages.set_gap(&given, moment.expansion);
        stages.set_conditions(&given, &moment, 0.0);
        let outcome = stages.contact.stage_into(&stages.gap, 0.0, &stages.conditions, &mut stages.end);
        outcome.map_err(|error| self.failure(path, 0.0, &error))?;
        let (given, stages, _) = self.parts();
        let limit = explicit_limit(&mut stages.contact, &stages.conditions, &stages.end.pressure);
        if length >= limit {
            return Err(StepFailure(format!(
                "solver.scheme = explicit is stable only for steps below {limit} s here (sliding velocity {} m/s, normal \
                 load {} N); the step is {length} s",
                Number(path.velocity(0.0)),
                Number(moment.load),
                limit = Number(limit),
                length = Number(length)
            )));
        }
        let acceleration = given.tunables.wear_acceleration;
        given.operators.rates(&moment, acceleration, &stages.end.pressure, &mut stages.rates[0]);
        let [first, end] = &mut stages.rates;
        end.clone_from_slice(first);
        stages.begin(&given);
        stages.leave_first_stage(&given, (1.0 - GAMMA) * length * path.velocity(0.5 * length), (1.0 - GAMMA) * length);
        self.accept(path, 0.0, length)?;
        self.state.steps += 1;
        // Pressure on the new shape.
        let last = path.at(length);
        let (given, stages, _) = self.parts();
        stages.set_gap(&given, last.expansion);
        stages.solve_without_wear(&given, &last).map_err(|error| self.failure(path, length, &error))?;
        self.keep_end();
        self.watch()
    }
}
