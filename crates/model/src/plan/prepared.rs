//! Prepared scene: its level, chosen by the user or by a plan, and its error.
//!
//! Theory: docs/theory.md, section 8.2.

use super::course::Course;
use super::model_level::ModelLevel;
use super::parallel::ParallelLumped;
use super::{Plan, UNKNOWN};
use crate::INPUTS;
use crate::growth::PerturbationGrowth;
use crate::levels::ModelOperators;
use crate::line::heat::bodies::expands;
use crate::line::operators::RunIn;
use crate::lumped::conditions::Tunables;
use numerics::maximum::maximum;
use scene::{Fidelity, Scene};

/// Prepared scene, built at the end of initialisation.
#[derive(Clone, Debug)]
pub struct Prepared {
    /// Scene as given by the parameters.
    pub requested: Scene,
    /// Plan, where the level was chosen automatically.
    pub plan: Option<Plan>,
    /// Operators of the level.
    pub operators: ModelOperators,
    /// Operators of the lumped level, where it is advanced in parallel with a contact line.
    pub lumped: Option<ModelOperators>,
    /// Growth of perturbations above the critical speed, with a plan.
    pub growth: Option<PerturbationGrowth>,
}

impl Prepared {
    /// Builds the level of `scene`, by a plan if `auto`.
    ///
    /// # Errors
    /// A text with the numbers where a body, or the run-in state, does not exist.
    pub fn new(scene: &Scene, run_in: RunIn) -> Result<Prepared, String> {
        let requested = scene.clone();
        if scene.fidelity != Fidelity::Auto {
            return Ok(Prepared {
                requested,
                plan: None,
                operators: ModelOperators::new(scene, run_in)?,
                lumped: None,
                growth: None,
            });
        }
        let super::Planned { plan, operators, lumped, growth } = super::make(scene, run_in)?;
        Ok(Prepared { requested, plan: Some(plan), operators, lumped, growth })
    }

    /// The lumped level in parallel with a contact line, where it is advanced.
    pub fn parallel(&self, tunables: Tunables, inputs: &[f64; INPUTS]) -> Option<ParallelLumped> {
        self.lumped.as_ref().map(|operators| ParallelLumped::new(operators, tunables, inputs))
    }

    /// Whether levels were compared over the nominal course.
    pub fn was_compared(&self) -> bool {
        self.plan.as_ref().is_some_and(|plan| plan.compared_steps > 0)
    }

    /// Friction work (J) of nominal load and velocity over the planned duration.
    pub fn planned_work(&self) -> f64 {
        let scene = &self.requested;
        let force = scene.friction_coefficient * scene.nominal_load * scene.faces * self.operators.mean().power_factor;
        force * scene.nominal_velocity * scene.planned_duration
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

    /// Ratio of a temperature rise (K) to a load (N, > 0) over that of the nominal trajectory, 1 at most; 1 where levels were not compared.
    pub fn relative_bow(&self, rise: f64, load: f64) -> f64 {
        let nominal = self.plan.as_ref().map_or(0.0, |plan| plan.rise);
        if nominal > 0.0 { (rise / nominal * (self.requested.nominal_load / load)).clamp(0.0, 1.0) } else { 1.0 }
    }

    /// Exponent of growth that the plan contains.
    pub fn planned_growth(&self) -> f64 {
        self.plan.as_ref().map_or(0.0, |plan| plan.growth[0])
    }

    /// Upper bound of the rate (1/s) at which perturbations grow; see [`super::growth::rate`].
    pub fn growth_rate(&self, friction: f64, speed: f64) -> f64 {
        self.growth.as_ref().map_or(0.0, |growth| super::growth::rate(growth, friction, speed))
    }

    /// Total relative error of wear depth, temperature rise and friction force, or [`UNKNOWN`], after this `course`; `step_error` is
    /// that of model reduction and time steps.
    pub fn estimated_error(&self, step_error: f64, course: &Course) -> f64 {
        match &self.plan {
            // Between rigid bodies a uniform pressure is exact.
            _ if self.requested.has_rigid_bodies() => step_error,
            Some(plan) if course.is_known(plan.growth[0]) => {
                let planned = [plan.estimated_error, plan.released_error].map(|error| error.unwrap_or(0.0));
                // Errors by cells, and by wear alone, do not come from bowed bodies.
                let by_bow = plan.model_level == ModelLevel::Lumped && expands(&self.requested);
                let course = Course { relative_bow: if by_bow { course.relative_bow } else { 1.0 }, ..*course };
                let level = course.level_error(plan.growth[0], planned, plan.lumped_errors.unwrap_or([0.0; 2]));
                level.hypot(plan.step_ratios[usize::from(course.is_released)] * step_error).min(UNKNOWN)
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
