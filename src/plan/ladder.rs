//! The rungs that a component may stand on.

use super::Plan;
use super::rung::Rung;
use crate::coupled::model::Operators;
use crate::scene::{Escalation, Fidelity, Scene};

/// Load, speed and friction work over the nominal ones, and rise of the contact temperature over the planned one, up to which a
/// plan holds: more than the largest speed of a sinusoid over its mean.
const PLANNED: f64 = 2.0;

/// See the module. Built when initialisation ends.
#[derive(Clone, Debug)]
pub struct Ladder {
    /// The scene as the parameters describe it.
    pub requested: Scene,
    /// Where the level was chosen for the user.
    pub plan: Option<Plan>,
    /// The rung that a run starts on.
    pub first: Operators,
    /// The rung that it may go on with, where it is prepared.
    pub next: Option<Operators>,
}

impl Ladder {
    /// Builds what `scene` asks for.
    ///
    /// # Errors
    /// A text with the numbers where a body, or the run-in state, does not exist.
    pub fn new(scene: &Scene) -> Result<Ladder, String> {
        let requested = scene.clone();
        if scene.fidelity != Fidelity::Auto {
            return Ok(Ladder { requested, plan: None, first: Operators::new(scene)?, next: None });
        }
        let planned = super::make(scene)?;
        Ok(Ladder { requested, plan: Some(planned.plan), first: planned.operators, next: planned.prepared })
    }

    /// Operators of the first rung (`escalated`: of the next), built where they are not there yet.
    ///
    /// # Errors
    /// Where there is no next rung, or it cannot be built.
    pub fn rung(&self, escalated: bool) -> Result<Operators, String> {
        if !escalated {
            return Ok(self.first.clone());
        }
        if let Some(next) = &self.next {
            return Ok(next.clone());
        }
        let rung = self.above().ok_or("there is no rung above the one that was planned")?;
        Operators::new(&rung.apply(&self.requested))
    }

    /// The rung above the planned one.
    pub fn above(&self) -> Option<Rung> {
        self.plan.as_ref().and_then(|plan| plan.next)
    }

    /// What is to be done when the plan no longer holds.
    pub fn escalation(&self) -> Escalation {
        self.requested.escalation
    }

    /// Friction work (J) of nominal load and velocity over the nominal duration.
    pub fn planned_work(&self) -> f64 {
        let scene = &self.requested;
        let force = scene.friction_coefficient * scene.nominal_load * scene.faces * self.first.mean().power_factor;
        force * scene.nominal_velocity * scene.nominal_duration
    }

    /// How far speed (m/s), load (N), rise of the contact temperature (K) and friction work (J) are beyond what was planned
    /// for: 1 at its limit. 0 without a plan that compared levels. The work stands for a run longer than planned: what the
    /// heat's distribution changes adds up with the heat.
    pub fn excess(&self, speed: f64, load: f64, rise: f64, work: f64) -> f64 {
        let Some(plan) = self.plan.as_ref().filter(|plan| plan.probe_steps > 0) else { return 0.0 };
        let scene = &self.requested;
        let over = |value: f64, planned: f64| if planned > 0.0 { value.abs() / (PLANNED * planned) } else { 0.0 };
        over(speed, scene.nominal_velocity)
            .max(over(load, scene.nominal_load))
            .max(over(rise, plan.rise))
            .max(over(work, self.planned_work()))
    }

    /// Estimated relative error of the level a run stands on.
    pub fn level_error(&self, escalated: bool) -> f64 {
        let Some(plan) = &self.plan else { return 0.0 };
        let error = plan.estimated_error;
        match plan.next.filter(|_| escalated) {
            Some(next) => {
                plan.candidates.iter().find(|known| known.rung == next).map_or(error, |known| known.error().min(error))
            }
            None => error,
        }
    }

    /// What was chosen, for the log: one line each.
    pub fn lines(&self) -> Vec<String> {
        match &self.plan {
            Some(plan) => plan.lines(),
            None => vec![self.first.plan()],
        }
    }
}
