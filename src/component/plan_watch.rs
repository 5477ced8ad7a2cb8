//! Validity of the plan during a run: beyond the nominal conditions the level is unchanged, the log receives one message, and the
//! error is extrapolated; above the critical speed of a scene planned as stable it is unknown.
//!
//! Theory: docs/theory.md, section 8.2.

use super::{Component, Subject, inputs_of};
use model::INPUTS;
use model::lumped::limit;
use model::plan::prepared::Prepared;
use scene::message::Number;
use scene::value;

/// History of a run on which the error of its plan depends.
#[derive(Clone, Copy, PartialEq, Default, Debug)]
pub(super) struct Course {
    /// Largest ratio of speed, load and friction work so far to the nominal ones; infinite once a scene planned as stable was above
    /// its critical speed.
    pub(super) severity: f64,
    /// The load has been released: the levels differ more then than under load.
    pub(super) is_released: bool,
    /// Largest load so far, N.
    pub(super) largest_load: f64,
}

impl Component {
    /// Compares the step that ended with the nominal conditions, and with the critical speed where the plan was below it. `began`:
    /// inputs at its beginning.
    pub(super) fn watch_plan(&mut self, began: &[f64; INPUTS]) {
        let (Some(prepared), Some(model)) = (&self.prepared, &self.model) else { return };
        let inputs: [f64; INPUTS] = inputs_of(&self.values);
        let course = &mut self.course;
        for load in [began[1], inputs[1]] {
            course.is_released |= Prepared::is_released(load, course.largest_load);
            course.largest_load = course.largest_load.max(load);
        }
        let before = course.severity;
        let scene = &prepared.requested;
        let work = model.friction_work();
        // Inputs are finite, and linear within a step: the largest are at one of its ends.
        let speed_of = |inputs: &[f64; INPUTS]| (inputs[0] + scene.mean_radius * inputs[2]).abs();
        let speed = speed_of(began).max(speed_of(&inputs));
        let load = began[1].max(inputs[1]);
        let is_unstable = model.limits() & limit::UNSTABLE != 0;
        let severity = if is_unstable { f64::INFINITY } else { prepared.severity(speed, load, work) };
        course.severity = before.max(severity);
        if Prepared::is_beyond(before) || !Prepared::is_beyond(severity) {
            return;
        }
        let (planned_speed, planned_load, duration) =
            (scene.nominal_velocity, scene.nominal_load, scene.nominal_duration);
        let planned_work = prepared.planned_work();
        let beyond = format_args!(
            "the run exceeds the conditions planned for solver.fidelity = auto: {speed} m/s, {load} N and {work} J of friction, \
             planned for nominal.velocity = {planned_speed} m/s, nominal.load = {planned_load} N and {planned_work} J in nominal.duration = \
             {duration} s; the level is unchanged, and estimated_error {error} from here on",
            speed = Number(speed),
            load = Number(load),
            work = Number(work),
            planned_speed = Number(planned_speed),
            planned_load = Number(planned_load),
            planned_work = Number(planned_work),
            duration = Number(duration),
            error = if Prepared::is_known(severity) { "is extrapolated" } else { "is 1" },
        );
        self.messages.add(Subject::Warning, beyond);
    }

    /// Replaces the error of reduction and time steps in the account by the total error.
    pub(super) fn add_estimated_error(&mut self) {
        if let Some(prepared) = &self.prepared {
            let steps = value!(self.values, "estimated_step_error");
            value!(self.values, "estimated_error") =
                prepared.estimated_error(steps, self.course.severity, self.course.is_released);
        }
    }
}
