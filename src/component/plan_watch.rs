//! Validity of the plan during a run: beyond the nominal conditions the level is unchanged, the log receives one message, and the
//! error follows the distance from the lumped level in parallel with a contact line, or is extrapolated; above the critical speed with the growth
//! of perturbations.
//!
//! Theory: docs/theory.md, section 8.2.

use super::{Component, Subject, inputs_of};
use model::INPUTS;
use scene::message::Number;
use scene::value;

impl Component {
    /// Compares the step that ended with the nominal conditions, and with the critical speed where the plan was below it. `began`:
    /// inputs at its beginning.
    pub(super) fn watch_plan(&mut self, began: &[f64; INPUTS]) {
        let (Some(prepared), Some(model)) = (&self.prepared, &self.model) else { return };
        let inputs: [f64; INPUTS] = inputs_of(&self.values);
        let before = self.course;
        let course = &mut self.course;
        let scene = &prepared.requested;
        let work = model.friction_work();
        // Inputs are finite, and linear within a step: the largest are at one of its ends.
        let ends = [began, &inputs];
        let speeds = ends.map(|inputs| (inputs[0] + scene.mean_radius * inputs[2]).abs());
        let (speed, load) = (speeds[0].max(speeds[1]), began[1].max(inputs[1]));
        ends.into_iter().for_each(|inputs| course.follow_load(inputs[1]));
        course.severity = before.severity.max(prepared.severity(speed, load, work));
        let end = inputs[1];
        if end > 0.0 && !course.releases(end) {
            course.relative_bow = before.relative_bow.max(prepared.relative_bow(model.end_rise(), end));
        }
        if load > 0.0 {
            course.growth += self.last_step * prepared.growth_rate(model.friction_at(speed), speed);
        }
        let planned = prepared.planned_growth();
        if before.is_beyond(planned) || !course.is_beyond(planned) {
            return;
        }
        let (planned_speed, planned_load, duration) =
            (scene.nominal_velocity, scene.nominal_load, scene.planned_duration);
        let planned_work = prepared.planned_work();
        let beyond = format_args!(
            "the run exceeds the conditions planned for solver.fidelity = auto: {speed} m/s, {load} N and {work} J of friction, \
             planned for nominal.velocity = {planned_speed} m/s, nominal.load = {planned_load} N and {planned_work} J in {duration} s; the level is unchanged, and estimated_error {error} from here on",
            speed = Number(speed),
            load = Number(load),
            work = Number(work),
            planned_speed = Number(planned_speed),
            planned_load = Number(planned_load),
            planned_work = Number(planned_work),
            duration = Number(duration),
            error = match course.distance {
                _ if !course.is_known(planned) => "is 1",
                Some(_) => "still follows the run",
                None => "is extrapolated",
            },
        );
        self.messages.add(Subject::Warning, beyond);
    }

    /// Replaces the error of reduction and time steps in the account by the total error.
    pub(super) fn add_estimated_error(&mut self) {
        if let Some(prepared) = &self.prepared {
            let steps = value!(self.values, "estimated_step_error");
            value!(self.values, "estimated_error") = prepared.estimated_error(steps, &self.course);
        }
    }
}
