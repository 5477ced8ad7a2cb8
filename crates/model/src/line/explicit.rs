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
        let operators = self.operators.clone();
        let moment = path.at(0.0);
        self.set_gap(moment.expansion);
        self.set_conditions(&moment, 0.0);
        self.contact
            .stage_into(&self.work.gap, 0.0, &self.conditions, &mut self.work.end)
            .map_err(|error| self.failure(path, 0.0, &error))?;
        let limit = explicit_limit(&mut self.contact, &self.conditions, &self.work.end.pressure);
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
        operators.rates(&moment, self.tunables.wear_acceleration, &self.work.end.pressure, &mut self.work.rates[0]);
        for body in 0..2 {
            let [first, end] = &mut self.work.rates;
            end[body].copy_from_slice(&first[body]);
        }
        if let (Some(own), Some(track)) = (&mut self.work.track, &self.state.track) {
            own.copy_from(track);
        }
        self.leave_first_stage((1.0 - GAMMA) * length * path.velocity(0.5 * length), (1.0 - GAMMA) * length);
        self.accept(path, 0.0, length);
        self.state.steps += 1;
        // Pressure on the new shape.
        let last = path.at(length);
        self.set_gap(last.expansion);
        self.set_conditions(&last, 0.0);
        self.contact
            .stage_into(&self.work.gap, 0.0, &self.conditions, &mut self.work.end)
            .map_err(|error| self.failure(path, length, &error))?;
        self.keep_end();
        Ok(())
    }
}
