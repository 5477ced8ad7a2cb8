//! What `solver.fidelity = auto` chooses: the cheapest level whose error is below the tolerance.
//!
//! # How
//!
//! Every level takes the whole nominal course ([`course`]) as it would be run: with its own bodies, steps and tolerance. Its error is
//! measured against finer cells and a stricter tolerance ([`comparison`]), and holds the level, the cells, the reduction of the bodies
//! and the time steps together. Levels are judged by the contact line as `solver.fidelity = line` runs it: with heat on its cells where that feeds back on
//! the pressure, and by its mean elsewhere.
//!
//! The plan depends on computed numbers alone, never on timings: the same scene has the same plan on every machine.
//!
//! # What it costs
//!
//! Nothing where groups decide: two rigid bodies have a uniform pressure. Else some runs of the nominal course, at most about 100 ms in
//! counted work ([`cost`]). A level that was run as the user runs it is not built again.
//!
//! # Limits
//!
//! - The course is that of `nominal.*`. A run beyond it is no longer planned for: [`prepared::Prepared::is_beyond`].
//! - The error is unknown, and stated as 1, where nothing can be compared (nominal values of 0, no solution on the cells), and where the
//!   cells do not converge, as above the critical speed of thermoelastic instability.
//! - Reciprocating sliding is run over at most 24 half-strokes, with the wear of the whole duration.

pub mod comparison;
pub mod cost;
pub mod effects;
pub mod groups;
pub mod model_level;
pub mod prepared;
mod text;
pub mod trajectory;

use crate::levels::ModelOperators;
use crate::line::operators::RunIn;
use comparison::{Comparison, compare};
use effects::Effect;
use groups::Groups;
use model_level::ModelLevel;
use numerics::maximum::maximum;
use scene::Scene;
use trajectory::NominalTrajectory;

/// Part of the tolerance that the error of the level and its cells may take.
const SAFETY: f64 = 0.9;

/// Error that is not known.
pub const UNKNOWN: f64 = 1.0;

/// Most cells that are taken where no level is expected to meet the tolerance.
const MOST_IN_VAIN: usize = 65;

/// A level with its error.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Candidate {
    /// The level.
    pub model_level: ModelLevel,
    /// Relative errors of wear depth, contact temperature and friction force by the level and its cells.
    pub errors: [f64; 3],
    /// Error by the reduction of its bodies and its time steps over `estimated_step_error`.
    pub step_ratio: f64,
    /// Expected cost of an internal step, and of the nominal duration, microseconds; see [`cost`].
    pub cost: f64,
    /// See `cost`.
    pub run_cost: f64,
}

impl Candidate {
    /// The largest of the errors by the level and its cells.
    pub fn error(&self) -> f64 {
        comparison::largest(self.errors)
    }
}

/// What was chosen, and why.
#[derive(Clone, PartialEq, Debug)]
pub struct Plan {
    /// The tolerance it was made for.
    pub tolerance: f64,
    /// The level.
    pub model_level: ModelLevel,
    /// Whether its estimated error is below the tolerance.
    pub meets: bool,
    /// Why it is this level.
    pub reason: String,
    /// Effects, what decided on them, and what they cost.
    pub effects: Vec<Effect>,
    /// Dimensionless groups at nominal conditions.
    pub groups: Groups,
    /// Every level that was looked at, by cost; empty where there was nothing to choose.
    pub candidates: Vec<Candidate>,
    /// Thermal states of punch, strip and moving source.
    pub states: [usize; 3],
    /// Order of the time steps.
    pub order: u8,
    /// Relative error of the level and its cells over the nominal course, the largest of the three main outputs; [`UNKNOWN`] where it is
    /// not known. `None` where the level has no error but that of its reduction and its steps: both bodies are rigid.
    pub estimated_error: Option<f64>,
    /// See [`Candidate::step_ratio`].
    pub step_ratio: f64,
    /// Relative error of the reduced thermal bodies.
    pub reduction_error: f64,
    /// Expected cost of an internal step and of the nominal duration, microseconds.
    pub cost_per_step: f64,
    /// See `cost_per_step`.
    pub run_cost: f64,
    /// Internal steps of the comparison, the part of the nominal duration that it covers, and its cost, microseconds.
    pub compared_steps: u64,
    /// See `compared_steps`.
    pub covered: f64,
    /// See `compared_steps`.
    pub planning_cost: f64,
    /// Peak rise of the contact temperature at nominal conditions, K; 0 where nothing was compared.
    pub rise: f64,
}

/// A plan and the operators of its level.
#[derive(Clone, Debug)]
pub struct Planned {
    /// The plan.
    pub plan: Plan,
    /// Of the chosen level.
    pub operators: ModelOperators,
}

/// Plans `scene`.
///
/// # Errors
/// A text with the numbers where the chosen level cannot be built.
pub fn make(scene: &Scene, run_in: RunIn) -> Result<Planned, String> {
    if scene.has_rigid_bodies() {
        return only_lumped(scene, "both bodies are rigid".into(), None, run_in);
    }
    let Some(course) = NominalTrajectory::new(scene) else {
        let reason = format!(
            "nominal.load = {} N, nominal.velocity = {} m/s and nominal.duration = {} s leave nothing to compare levels with",
            scene.nominal_load, scene.nominal_velocity, scene.nominal_duration
        );
        return only_lumped(scene, reason, Some(UNKNOWN), run_in);
    };
    let groups = Groups::new(scene, 0.0);
    let enough = SAFETY * scene.tolerance;
    let may_grow = groups.speed_over_critical >= 1.0;
    let reason = match compare(scene, &course, enough, true, may_grow, run_in) {
        Ok(comparison) => return decide(scene, comparison, None, run_in),
        Err(reason) => reason,
    };
    // Where heat on the cells has no solution (friction that runs away, instability), its mean still has one.
    if let Ok(comparison) = compare(scene, &course, enough, false, may_grow, run_in) {
        return decide(scene, comparison, Some(format!("nothing to compare the mean heat with: {reason}")), run_in);
    }
    // The lumped level knows nothing of what the contact line refuses.
    only_lumped(scene, format!("no contact line to compare with: {reason}"), Some(UNKNOWN), run_in)
}

/// Chooses a level. `doubt`: why its error is not known.
fn decide(scene: &Scene, comparison: Comparison, doubt: Option<String>, run_in: RunIn) -> Result<Planned, String> {
    let enough = SAFETY * scene.tolerance;
    let candidates = &comparison.candidates;
    let known = doubt.is_none() && comparison.is_known;
    let good = candidates.iter().find(|candidate| known && candidate.error() <= enough);
    let chosen = good.or_else(|| match known {
        true => {
            let within = candidates.iter().filter(|candidate| candidate.model_level.cells() <= MOST_IN_VAIN);
            within.min_by(|one, other| one.error().total_cmp(&other.error()))
        }
        // Nothing tells the levels apart: the one that leaves out least.
        false => {
            let alike = candidates.iter().filter(|candidate| candidate.model_level.heat() == comparison.finest.heat());
            let within = alike.filter(|candidate| candidate.model_level.cells() <= MOST_IN_VAIN.max(scene.cells));
            within.max_by_key(|candidate| candidate.model_level.cells())
        }
    });
    let Some(&chosen) = chosen else { return Err("a plan without candidates".into()) };
    let reason = match (good, doubt) {
        (_, Some(reason)) => reason,
        _ if !comparison.is_known => {
            "the cells do not converge over the nominal duration: its error is not known".to_owned()
        }
        (Some(_), _) => "the cheapest whose estimated error is below the tolerance".to_owned(),
        (None, _) => {
            format!("no level has an estimated error below the tolerance; this one has {:.1e}", chosen.error())
        }
    };
    let run = comparison.operators.into_iter().find(|(model_level, _)| *model_level == chosen.model_level);
    let operators = match run {
        Some((_, operators)) => operators,
        None => ModelOperators::new(&chosen.model_level.apply(scene), run_in)?,
    };
    let groups = Groups::new(scene, comparison.rise);
    let effects = effects::judge(scene, &groups, &comparison.line, candidates, chosen.model_level);
    let (states, order, reduction_error) = made_of(&operators);
    let plan = Plan {
        tolerance: scene.tolerance,
        model_level: chosen.model_level,
        meets: good.is_some(),
        reason,
        effects,
        groups,
        candidates: comparison.candidates,
        states,
        order,
        estimated_error: Some(if known { chosen.error().min(UNKNOWN) } else { UNKNOWN }),
        step_ratio: chosen.step_ratio,
        reduction_error,
        cost_per_step: chosen.cost,
        run_cost: chosen.run_cost,
        compared_steps: comparison.steps,
        covered: comparison.covered,
        planning_cost: comparison.cost,
        rise: comparison.rise,
    };
    Ok(Planned { plan, operators })
}

fn only_lumped(scene: &Scene, reason: String, estimated_error: Option<f64>, run_in: RunIn) -> Result<Planned, String> {
    let operators = ModelOperators::new(&ModelLevel::Lumped.apply(scene), run_in)?;
    let (states, order, reduction_error) = made_of(&operators);
    let plan = Plan {
        tolerance: scene.tolerance,
        model_level: ModelLevel::Lumped,
        meets: estimated_error.is_none(),
        reason,
        effects: Vec::new(),
        groups: Groups::new(scene, 0.0),
        candidates: Vec::new(),
        states,
        order,
        estimated_error,
        step_ratio: 1.0,
        reduction_error,
        cost_per_step: cost::per_step(&operators),
        run_cost: 0.0,
        compared_steps: 0,
        covered: 0.0,
        planning_cost: cost::build_cost(&operators),
        rise: 0.0,
    };
    Ok(Planned { plan, operators })
}

/// Thermal states of punch, strip and moving source, order of the time steps, error of the reduced bodies.
fn made_of(operators: &ModelOperators) -> ([usize; 3], u8, f64) {
    let (mean, line, order) = match operators {
        ModelOperators::Lumped(mean) => (mean, None, 3),
        ModelOperators::Line(line) => (&line.mean, line.heat.as_ref(), 2),
    };
    if let Some(bodies) = line {
        return ([bodies.states[0], bodies.states[1], 0], order, bodies.error);
    }
    let bodies = [&mean.punch, &mean.strip].map(|body| body.heat.as_ref());
    let [punch, strip] = bodies.map(|heat| heat.map_or(0, |heat| heat.count));
    let source = mean.flash.as_ref().map_or(0, |flash| flash.decays.rate.len());
    let error = bodies.into_iter().flatten().map(|heat| heat.error).fold(0.0, maximum);
    ([punch, strip, source], order, error)
}
