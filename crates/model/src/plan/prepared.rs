//! A scene made ready to run: its level, chosen by the user or by a plan, and what is known of its error.

use super::{Plan, UNKNOWN};
use crate::levels::ModelOperators;
use crate::line::operators::RunIn;
use scene::{Fidelity, Scene};

/// Load, speed and friction work over the nominal ones up to which a plan holds: more than the largest speed of a sinusoid over its mean.
const PLANNED: f64 = 2.0;

/// See the module. Built when initialisation ends.
#[derive(Clone, Debug)]
pub struct Prepared {
    /// The scene as the parameters describe it.
    pub requested: Scene,
    /// Where the level was chosen for the user.
    pub plan: Option<Plan>,
    /// Of the level.
    pub operators: ModelOperators,
}

impl Prepared {
    /// Builds what `scene` asks for.
    ///
    /// # Errors
    /// A text with the numbers where a body, or the run-in state, does not exist.
    pub fn new(scene: &Scene, run_in: RunIn) -> Result<Prepared, String> {
        let requested = scene.clone();
        if scene.fidelity != Fidelity::Auto {
            return Ok(Prepared { requested, plan: None, operators: ModelOperators::new(scene, run_in)? });
        }
        let planned = super::make(scene, run_in)?;
        Ok(Prepared { requested, plan: Some(planned.plan), operators: planned.operators })
    }

    /// Whether levels were compared over the nominal course.
    pub fn was_compared(&self) -> bool {
        self.plan.as_ref().is_some_and(|plan| plan.compared_steps > 0)
    }

    /// Friction work (J) of nominal load and velocity over the nominal duration.
    pub fn planned_work(&self) -> f64 {
        let scene = &self.requested;
        let force = scene.friction_coefficient * scene.nominal_load * scene.faces * self.operators.mean().power_factor;
        force * scene.nominal_velocity * scene.nominal_duration
    }

    /// Whether a speed (m/s), a load (N) or the friction work (J) so far is beyond twice the nominal one, so that the plan does not
    /// hold. The work stands for a run longer than planned: what an uneven temperature changes adds up with the heat.
    pub fn is_beyond(&self, speed: f64, load: f64, work: f64) -> bool {
        let scene = &self.requested;
        speed.abs() > PLANNED * scene.nominal_velocity
            || load > PLANNED * scene.nominal_load
            || work > PLANNED * self.planned_work()
    }

    /// The whole relative error of wear depth, temperature rise and friction force, or [`UNKNOWN`]; `step_error` is that of reduction
    /// and time steps. `beyond`: the run has left what was planned for.
    pub fn estimated_error(&self, step_error: f64, beyond: bool) -> f64 {
        match &self.plan {
            // A uniform pressure is exact.
            _ if self.requested.has_rigid_bodies() => step_error,
            Some(plan) if !beyond => {
                let level = plan.estimated_error.unwrap_or(0.0);
                level.hypot(plan.step_ratio * step_error).min(UNKNOWN)
            }
            _ => UNKNOWN,
        }
    }

    /// What was chosen, for the log: one line each.
    pub fn lines(&self) -> Vec<String> {
        match &self.plan {
            Some(plan) => plan.lines(),
            None => vec![self.operators.plan()],
        }
    }
}
