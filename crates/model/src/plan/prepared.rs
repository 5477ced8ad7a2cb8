//! Prepared scene: its level, chosen by the user or by a plan, and its error.
//!
//! Theory: docs/theory.md, section 8.2.

use super::{Plan, UNKNOWN};
use crate::levels::ModelOperators;
use crate::line::operators::RunIn;
use numerics::maximum::maximum;
use scene::{Fidelity, Scene};

/// Ratio of load, speed and friction work to the nominal ones up to which the error of the nominal trajectory is that of the run:
/// more than the largest speed of a sinusoid over its mean.
const PLANNED: f64 = 2.0;

/// Ratio up to which the error is known. From [`PLANNED`] on it is extrapolated in proportion: the levels differ by the uneven pressure
/// that the heat causes, which to first order is proportional to the heat.
const KNOWN: f64 = 10.0;

/// Fraction of the largest load so far below which the load counts as released.
const RELEASED: f64 = 0.5;

/// Prepared scene, built at the end of initialisation.
#[derive(Clone, Debug)]
pub struct Prepared {
    /// Scene as given by the parameters.
    pub requested: Scene,
    /// Plan, where the level was chosen automatically.
    pub plan: Option<Plan>,
    /// Operators of the level.
    pub operators: ModelOperators,
}

impl Prepared {
    /// Builds the level of `scene`, by a plan if `auto`.
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

    /// Largest ratio of a speed (m/s), a load (N) and the friction work (J) so far to the nominal ones. The work represents a run
    /// longer than planned: the effects of a nonuniform temperature accumulate with the heat.
    pub fn severity(&self, speed: f64, load: f64, work: f64) -> f64 {
        let scene = &self.requested;
        let ratio = |value: f64, nominal: f64| if value > 0.0 { value / nominal } else { 0.0 };
        [ratio(load, scene.nominal_load), ratio(work, self.planned_work())]
            .into_iter()
            .fold(ratio(speed.abs(), scene.nominal_velocity), maximum)
    }

    /// Whether the error of a run of this [`Prepared::severity`] is known.
    pub fn is_known(severity: f64) -> bool {
        severity <= KNOWN
    }

    /// Whether a run of this [`Prepared::severity`] exceeds the conditions of the plan.
    pub fn is_beyond(severity: f64) -> bool {
        severity > PLANNED
    }

    /// Whether a load counts as released: below half of the largest one so far (N).
    pub fn is_released(load: f64, largest: f64) -> bool {
        load < RELEASED * largest
    }

    /// Total relative error of wear depth, temperature rise and friction force, or [`UNKNOWN`]; `step_error` is that of model
    /// reduction and time steps. `severity`: the largest [`Prepared::severity`] of the run so far, infinite where it is unstable
    /// against the plan. `released`: its load has been released.
    pub fn estimated_error(&self, step_error: f64, severity: f64, released: bool) -> f64 {
        match &self.plan {
            // Between rigid bodies a uniform pressure is exact.
            _ if self.requested.has_rigid_bodies() => step_error,
            Some(plan) if Prepared::is_known(severity) => {
                let [under_load, with_release] = plan.step_ratios;
                let (level, step_ratio) = match released {
                    true => (plan.released_error, with_release),
                    false => (plan.estimated_error, under_load),
                };
                let level = level.unwrap_or(0.0) * (severity / PLANNED).max(1.0);
                level.hypot(step_ratio * step_error).min(UNKNOWN)
            }
            _ => UNKNOWN,
        }
    }

    /// Description of the choice for the log, line by line.
    pub fn lines(&self) -> Vec<String> {
        match &self.plan {
            Some(plan) => plan.lines(),
            None => vec![self.operators.plan()],
        }
    }
}
