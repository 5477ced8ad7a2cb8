//! Model selection of `solver.fidelity = auto`: the cheapest level whose error is below the tolerance.
//!
//! # Method
//!
//! Every level is run over the whole nominal trajectory ([`trajectory`]) with the bodies, steps and tolerance of the user's run, or of the
//! nearest tolerance from .005 to .025.
//! The trajectory ends with a release of the load; the errors under load and with the release are kept apart.
//! Its error is measured against finer cells and a stricter tolerance ([`comparison`]), and comprises the level, the cells, the
//! model reduction of the bodies and the time steps. The reference is the contact line as `solver.fidelity = line` runs it: with
//! resolved heat where its distribution feeds back on the pressure, and lumped heat elsewhere.
//!
//! The plan depends on computed numbers alone, never on timings: the same scene has the same plan on every machine.
//!
//! # Cost
//!
//! None where dimensionless groups are sufficient: two rigid bodies have a uniform pressure. Otherwise some runs of the nominal
//! trajectory, mostly below 100 ms of processor time, up to 600 ms at most ([`cost`]). A level whose run was that of the user is not built again.
//!
//! # Limits
//!
//! - The trajectory is that of `nominal.*`. In a run the error of a contact line follows its distance from the lumped level in parallel
//!   ([`parallel`]); that of the lumped level is extrapolated: [`prepared::Prepared::severity`], [`prepared::Prepared::relative_bow`].
//! - The error is unknown, and stated as 1, where there is nothing to compare (nominal values of 0, no solution on the cells),
//!   and where the cells do not converge, as mostly well above the critical speed of thermoelastic instability.
//! - Reciprocating sliding is run over at most 24 half-strokes, with the wear of the whole duration.
//!
//! Theory: docs/theory.md, section 8.2.

pub mod comparison;
pub mod cost;
pub mod course;
pub mod distance;
pub mod effects;
mod estimates;
pub mod groups;
pub mod growth;
pub mod model_level;
pub mod parallel;
pub mod prepared;
mod text;
pub mod trajectory;

use crate::growth::PerturbationGrowth;
use crate::levels::ModelOperators;
use crate::line::operators::RunIn;
use comparison::{Comparison, compare};
use effects::Effect;
use groups::Groups;
use growth::Growth;
use model_level::ModelLevel;
use numerics::maximum::maximum;
use scene::{HeatResolution, Scene};
use trajectory::NominalTrajectory;

/// Part of the tolerance for the error of the level and its cells.
const SAFETY: f64 = 0.9;

/// Admissible error after a release of the load relative to that under load. A release is one transient of a run, and not of every
/// run: a level that is finer for its sake costs up to a few hundred times as much. Runs that unload have a third to a fifteenth of the error
/// of the planned release.
const RELEASED: f64 = 4.0;

/// Stated error where it is unknown.
pub const UNKNOWN: f64 = 1.0;

/// Largest number of cells chosen where no level is expected to meet the tolerance.
const MOST_IN_VAIN: usize = 129;

/// Model level with its error.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Candidate {
    /// Model level.
    pub model_level: ModelLevel,
    /// Relative errors of wear depth, contact temperature and friction force by the level and its cells, under the nominal load.
    pub errors: [f64; 3],
    /// Largest of them where the load is also released; see [`trajectory`].
    pub released: f64,
    /// Error of model reduction and time steps over `estimated_step_error`, under the nominal load and with the release.
    pub step_ratios: [f64; 2],
    /// Expected cost of an internal step, microseconds; see [`cost`].
    pub cost: f64,
    /// Expected cost of the nominal duration, microseconds; see [`cost`].
    pub run_cost: f64,
}

impl Candidate {
    /// Largest error of the level and its cells under the nominal load.
    pub fn error(&self) -> f64 {
        largest(self.errors)
    }

    /// Whether the error is at most `enough`, and [`RELEASED`] times as large after a release.
    pub fn meets(&self, enough: f64) -> bool {
        self.error() <= enough && self.released <= RELEASED * enough
    }
}

/// Chosen level, and the basis of the choice.
#[derive(Clone, PartialEq, Debug)]
pub struct Plan {
    /// Tolerance of the plan.
    pub tolerance: f64,
    /// Duration for which it is made, s.
    pub duration: f64,
    /// Chosen level.
    pub model_level: ModelLevel,
    /// Whether its estimated error is below the tolerance.
    pub meets: bool,
    /// Reason for the choice.
    pub reason: String,
    /// Effects, the quantities on which they are included or neglected, and their errors.
    pub effects: Vec<Effect>,
    /// Dimensionless groups at nominal conditions.
    pub groups: Groups,
    /// Levels considered, by cost; empty without a choice.
    pub candidates: Vec<Candidate>,
    /// Thermal states of punch, strip and moving source.
    pub states: [usize; 3],
    /// Order of the time steps.
    pub order: u8,
    /// Relative error of the level and its cells over the nominal trajectory, the largest of the three main outputs; [`UNKNOWN`]
    /// where it is not known. `None` where the only errors are those of model reduction and steps: both bodies are rigid.
    pub estimated_error: Option<f64>,
    /// The same once the load has been released; see [`course::Course`].
    pub released_error: Option<f64>,
    /// The same two errors of the lumped level, where those of the chosen one are known.
    pub lumped_errors: Option<[f64; 2]>,
    /// Exponents of the growth of perturbations: the one that the comparison contains, and that over the nominal duration; see
    /// [`growth::over`].
    pub growth: [f64; 2],
    /// See [`Candidate::step_ratios`].
    pub step_ratios: [f64; 2],
    /// Relative error of the reduced thermal bodies.
    pub reduction_error: f64,
    /// Expected cost of an internal step, microseconds.
    pub cost_per_step: f64,
    /// Expected cost of the nominal duration, microseconds.
    pub run_cost: f64,
    /// Internal steps of the comparison.
    pub compared_steps: u64,
    /// Fraction of the nominal duration covered by the comparison.
    pub covered: f64,
    /// Cost of the comparison, microseconds.
    pub planning_cost: f64,
    /// Peak rise of the contact temperature at nominal conditions, K; 0 where nothing was compared.
    pub rise: f64,
}

/// Plan and operators of its level.
#[derive(Clone, Debug)]
pub struct Planned {
    /// Chosen level with its basis.
    pub plan: Plan,
    /// Operators of the chosen level.
    pub operators: ModelOperators,
    /// Operators of the lumped level, where a contact line of known error was chosen: it is advanced in parallel.
    pub lumped: Option<ModelOperators>,
    /// Growth of perturbations above the critical speed; none between rigid bodies.
    pub growth: Option<PerturbationGrowth>,
}

/// Plans `scene`.
///
/// # Errors
/// A text with the numbers where the chosen level cannot be built.
pub fn make(scene: &Scene, run_in: RunIn) -> Result<Planned, String> {
    let lumped = |reason: String, error: Option<f64>| uncompared(scene, ModelLevel::Lumped, reason, error, run_in);
    if scene.has_rigid_bodies() {
        return lumped("both bodies are rigid".into(), None);
    }
    let Some(course) = NominalTrajectory::new(scene) else {
        let reason = format!(
            "nominal.load = {} N, nominal.velocity = {} m/s and nominal.duration = {} s leave nothing to compare levels with",
            scene.nominal_load, scene.nominal_velocity, scene.nominal_duration
        );
        return lumped(reason, Some(UNKNOWN));
    };
    let growth = PerturbationGrowth::new(scene);
    let exponents = growth::over(&growth, &course, scene);
    let planned = choose(scene, &course, Growth::by(exponents[1]), run_in)?;
    Ok(Planned { plan: Plan { growth: exponents, ..planned.plan }, growth: Some(growth), ..planned })
}

/// Compares the levels over `course` and chooses one; `growth` of perturbations over the nominal duration.
fn choose(scene: &Scene, course: &NominalTrajectory, growth: Growth, run_in: RunIn) -> Result<Planned, String> {
    let enough = SAFETY * scene.tolerance;
    let failure = match compare(scene, course, enough, true, growth, run_in) {
        Ok(comparison) => return decide(scene, comparison, None, run_in),
        Err(failure) => failure,
    };
    let reason = failure.reason;
    // A tolerance at which even a coarse line is costly calls for the level that neglects least.
    if failure.is_too_costly {
        let cells = if scene.cells > 0 { scene.cells } else { MOST_IN_VAIN };
        let finest = ModelLevel::Line { cells, heat: HeatResolution::ResolvedWhereCoupled };
        return uncompared(scene, finest, format!("too costly to compare: {reason}"), Some(UNKNOWN), run_in);
    }
    // Where resolved heat has no solution (thermal runaway by friction, instability), lumped heat still has one.
    if let Ok(comparison) = compare(scene, course, enough, false, growth, run_in) {
        return decide(scene, comparison, Some(format!("nothing to compare the mean heat with: {reason}")), run_in);
    }
    // The lumped level does not reproduce the failure of the contact line.
    let reason = format!("no contact line to compare with: {reason}");
    uncompared(scene, ModelLevel::Lumped, reason, Some(UNKNOWN), run_in)
}

/// Chooses a level. `doubt`: reason for which its error is not known.
fn decide(scene: &Scene, comparison: Comparison, doubt: Option<String>, run_in: RunIn) -> Result<Planned, String> {
    let enough = SAFETY * scene.tolerance;
    let candidates = &comparison.candidates;
    let known = doubt.is_none() && comparison.is_known;
    let good = candidates.iter().find(|candidate| known && candidate.meets(enough));
    let chosen = good.or_else(|| match known {
        true => {
            let within = candidates.iter().filter(|candidate| candidate.model_level.cells() <= MOST_IN_VAIN);
            within.min_by(|one, other| one.released.total_cmp(&other.released))
        }
        // Without known errors: the level that neglects least.
        false => {
            let alike = candidates.iter().filter(|candidate| candidate.model_level.heat() == comparison.finest.heat());
            let within = alike.filter(|candidate| candidate.model_level.cells() <= MOST_IN_VAIN.max(scene.cells));
            within.max_by_key(|candidate| candidate.model_level.cells())
        }
    });
    let Some(&chosen) = chosen else { return Err("a plan without candidates".into()) };
    let lumped = candidates.iter().find(|candidate| candidate.model_level == ModelLevel::Lumped).copied();
    let reason = match (good, doubt) {
        (_, Some(reason)) => reason,
        _ if !comparison.is_known => {
            "the cells do not converge over the nominal duration: its error is unknown".to_owned()
        }
        (Some(_), _) => "the cheapest whose estimated error is below the tolerance".to_owned(),
        (None, _) => {
            format!("no level has an estimated error below the tolerance; this one has {:.1e}", chosen.error())
        }
    };
    let run =
        |wanted: ModelLevel| comparison.operators.iter().find(|(own, _)| *own == wanted).map(|(_, own)| own.clone());
    let uniform = match run(ModelLevel::Lumped) {
        Some(operators) => operators,
        None => ModelOperators::new(&ModelLevel::Lumped.apply(scene), run_in)?,
    };
    let operators = match chosen.model_level {
        ModelLevel::Lumped => uniform.clone(),
        line => run(line).map_or_else(|| uniform.line_beside(&line.apply(scene), run_in), Ok)?,
    };
    let groups = Groups::new(scene, &operators.mean().growth.critical, comparison.rise);
    let effects = effects::judge(scene, &groups, &comparison.line, candidates, chosen.model_level);
    let (states, order, reduction_error) = composition(&operators);
    let plan = Plan {
        tolerance: scene.tolerance,
        duration: scene.planned_duration,
        model_level: chosen.model_level,
        meets: good.is_some(),
        reason,
        effects,
        groups,
        candidates: comparison.candidates,
        states,
        order,
        estimated_error: Some(if known { chosen.error().min(UNKNOWN) } else { UNKNOWN }),
        released_error: Some(if known { chosen.released.min(UNKNOWN) } else { UNKNOWN }),
        lumped_errors: lumped.filter(|_| known).map(|lumped| [lumped.error(), lumped.released]),
        growth: [0.0; 2],
        step_ratios: chosen.step_ratios,
        reduction_error,
        cost_per_step: chosen.cost,
        run_cost: chosen.run_cost,
        compared_steps: comparison.steps,
        covered: comparison.covered,
        planning_cost: comparison.cost,
        rise: comparison.rise,
    };
    let is_parallel = known && chosen.model_level != ModelLevel::Lumped;
    Ok(Planned { plan, operators, lumped: is_parallel.then_some(uniform), growth: None })
}

/// A level without a comparison.
fn uncompared(
    scene: &Scene,
    model_level: ModelLevel,
    reason: String,
    estimated_error: Option<f64>,
    run_in: RunIn,
) -> Result<Planned, String> {
    let operators = ModelOperators::new(&model_level.apply(scene), run_in)?;
    let (states, order, reduction_error) = composition(&operators);
    let plan = Plan {
        tolerance: scene.tolerance,
        duration: scene.planned_duration,
        model_level,
        meets: estimated_error.is_none(),
        reason,
        effects: Vec::new(),
        groups: Groups::new(scene, &operators.mean().growth.critical, 0.0),
        candidates: Vec::new(),
        states,
        order,
        estimated_error,
        released_error: estimated_error,
        lumped_errors: None,
        growth: [0.0; 2],
        step_ratios: [1.0; 2],
        reduction_error,
        cost_per_step: cost::per_step(&operators),
        run_cost: 0.0,
        compared_steps: 0,
        covered: 0.0,
        planning_cost: cost::build_cost(&operators),
        rise: 0.0,
    };
    Ok(Planned { plan, operators, lumped: None, growth: None })
}

/// Largest error; infinite where one is NaN.
pub fn largest(errors: [f64; 3]) -> f64 {
    errors.into_iter().fold(0.0, |most, error| if error.is_nan() { f64::INFINITY } else { error.max(most) })
}

/// Thermal states of punch, strip and moving source, order of the time steps, error of the reduced bodies.
fn composition(operators: &ModelOperators) -> ([usize; 3], u8, f64) {
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
