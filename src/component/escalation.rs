//! Leaving what was planned for: the next rung takes over, or the log says that it does not.

use super::{Component, Subject, inputs_of, tunables_of};
use crate::coupled::INPUTS;
use crate::coupled::model::Model;
use crate::plan::rung::Rung;
use crate::scene::{Escalation, value};
use std::borrow::Cow;

impl Component {
    /// Looks whether the step that ended still was what the plan is for.
    pub(super) fn watch_plan(&mut self) {
        let (Some(ladder), Some(model)) = (&self.ladder, &self.model) else { return };
        let inputs: [f64; INPUTS] = inputs_of(&self.values);
        let scene = &ladder.requested;
        let rise = model.contact_rise();
        let work = model.friction_work();
        let excess = ladder.excess(inputs[0] + scene.mean_radius * inputs[2], inputs[1], rise, work);
        self.excess = self.excess.max(excess);
        if excess <= 1.0 || self.left_plan {
            return;
        }
        self.left_plan = true;
        let planned = ladder.plan.as_ref().map_or(0.0, |plan| plan.rise);
        let (velocity, load) = (scene.nominal_velocity, scene.nominal_load);
        let planned_work = ladder.planned_work();
        let done = self.escalate();
        let beyond = format_args!(
            "the run leaves what was planned for: {} m/s, {} N, a contact {rise} K warmer and {work} J of friction, planned for \
             nominal.velocity = {} m/s, nominal.load = {} N, {} K and {} J in nominal.duration",
            inputs[0], inputs[1], velocity, load, planned, planned_work
        );
        match done {
            Ok(rung) => self.messages.add(Subject::Warning, format_args!("{beyond}; it goes on with {rung}")),
            Err(reason) => self.messages.add(Subject::Warning, format_args!("{beyond}; the level stays: {reason}")),
        }
    }

    fn escalate(&mut self) -> Result<Rung, Cow<'static, str>> {
        let Some(ladder) = &self.ladder else { return Err("nothing was planned".into()) };
        let rung = ladder.above().ok_or("no rung above can take its state over")?;
        let next = match ladder.escalation() {
            Escalation::Off => return Err("solver.escalation = off".into()),
            Escalation::Prepared => self.prepared.take().ok_or("it was not prepared")?,
            Escalation::NextCommunicationPoint => {
                let operators = ladder.rung(true)?;
                Box::new(Model::new(&operators, tunables_of(&self.values), &inputs_of(&self.values)))
            }
        };
        let mut next = next;
        let Some(model) = &mut self.model else { return Err("there is no model".into()) };
        next.set_tunables(tunables_of(&self.values));
        if !next.take_over(model, &inputs_of(&self.values)) {
            return Err("its state does not belong to the rung above".into());
        }
        std::mem::swap(model, &mut next);
        // What was left is kept: freeing it is not a step's business.
        self.prepared = Some(next);
        self.escalated = true;
        self.at_end = false;
        Ok(rung)
    }

    /// Adds what the plan knows of the level's error.
    pub(super) fn add_level_error(&mut self) {
        if let Some(ladder) = &self.ladder {
            value!(self.values, "estimated_error") += ladder.level_error(self.escalated) * self.excess.max(1.0);
        }
    }
}
