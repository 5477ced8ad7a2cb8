//! Comparison of a plan's choice with every fixed setting, with a far finer run as the truth.
//!
//! Theory: docs/theory.md, section 8.2.

use super::runs::{Record, distance, processor_seconds, run, run_with};
use super::scenes::Generated;
use model::line::heat::bodies::can_be_resolved;
use model::plan::{self, Planned, model_level::ModelLevel};
use scene::{HeatResolution, Scene};

/// Numbers of cells of the competing fixed settings.
const FIXED: [usize; 3] = [9, 17, 33];

/// Tolerance of the truth, and of the coarser run with which it is compared.
const TRUTH: [f64; 2] = [1e-4, 2e-4];

/// Reference solution of the plans.
#[derive(Clone, Debug)]
pub struct Truth {
    /// A run far finer than all judged ones.
    pub record: Record,
    /// Its number of cells.
    pub cells: usize,
    /// Distance of wear depth, contact temperature and friction force from those of a run with half its cells and twice its
    /// tolerance: an upper estimate of its own error.
    pub errors: [f64; 3],
}

/// Far finer run of a scene, on `cells` cells, or on half as many where that many have no solution.
///
/// # Errors
/// A refused set-up or step.
pub fn truth(generated: &Generated, cells: usize) -> Result<Truth, String> {
    let of = |cells: usize, tolerance: f64| {
        let scene = generated.scene(tolerance)?;
        run(generated, &best(&scene, cells).apply(&scene))
    };
    let (record, cells) = match of(cells, TRUTH[0]) {
        Ok(record) => (record, cells),
        Err(_) => (of(cells / 2 + 1, TRUTH[0])?, cells / 2 + 1),
    };
    Ok(Truth { errors: distance(&of(cells / 2 + 1, TRUTH[1])?, &record), record, cells })
}

fn best(scene: &Scene, cells: usize) -> ModelLevel {
    let heat = if can_be_resolved(scene) { HeatResolution::Resolved } else { HeatResolution::Lumped };
    ModelLevel::Line { cells, heat }
}

/// Result of a setting.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Outcome {
    /// Model level.
    pub model_level: ModelLevel,
    /// Errors of wear depth, contact temperature and friction force against the truth.
    pub errors: [f64; 3],
    /// Expected cost of the run, microseconds.
    pub work: f64,
    /// Processor time of its steps, s.
    pub seconds: f64,
}

impl Outcome {
    /// The largest of the errors.
    pub fn error(&self) -> f64 {
        self.errors.iter().copied().fold(0.0, f64::max)
    }
}

/// Judged plan.
#[derive(Clone, PartialEq, Debug)]
pub struct Judged {
    /// Tolerance of the plan.
    pub tolerance: f64,
    /// The planned run.
    pub chosen: Outcome,
    /// Error that the plan predicts at its model level.
    pub planned_error: f64,
    /// `estimated_error` at the end of the planned run.
    pub estimated_error: f64,
    /// Processor time of planning without building the chosen model level, which costs as much at a fixed level; and of
    /// building it, s.
    pub planning_seconds: [f64; 2],
    /// Every fixed setting that ran.
    pub fixed: Vec<Outcome>,
}

impl Judged {
    /// The cheapest fixed setting that meets the tolerance.
    pub fn cheapest(&self) -> Option<&Outcome> {
        let good = self.fixed.iter().filter(|outcome| outcome.error() <= self.tolerance);
        good.min_by(|one, other| one.work.total_cmp(&other.work))
    }

    /// Whether planning is cheap: at most 20 ms, or a hundredth of the planned run.
    pub fn planning_is_cheap(&self) -> bool {
        self.planning_seconds[0] <= (0.01 * self.chosen.seconds).max(0.02)
    }

    /// Work of the plan over that of [`Judged::cheapest`].
    pub fn cost_ratio(&self) -> Option<f64> {
        self.cheapest().map(|cheapest| self.chosen.work / cheapest.work)
    }
}

/// Number of timed plannings of a scene.
const REPETITIONS: usize = 3;

/// Plans a scene at a tolerance; processor time of that without building the chosen model level, and of building it, s: the
/// least over repeated runs of the same work. Load by other threads on the same core or cache is included, so the machine
/// should be idle.
///
/// # Errors
/// The scene or the plan is refused.
pub fn timed_plan(generated: &Generated, tolerance: f64) -> Result<(Planned, [f64; 2]), String> {
    let scene = generated.scene(tolerance)?;
    let once = || -> Result<(Planned, [f64; 2]), String> {
        let begin = processor_seconds();
        let planned = plan::make(&scene, steady::run_in)?;
        Ok((planned, [processor_seconds() - begin, 0.0]))
    };
    let (planned, mut least) = once()?;
    for _ in 1..REPETITIONS {
        let (_, seconds) = once()?;
        least = [least[0].min(seconds[0]), least[1].min(seconds[1])];
    }
    Ok((planned, least))
}

/// Runs a plan and all fixed settings of a scene at a tolerance.
///
/// # Errors
/// The scene, the plan or its run is refused.
pub fn judge(generated: &Generated, tolerance: f64, truth: &Truth) -> Result<Judged, String> {
    let scene = generated.scene(tolerance)?;
    let (planned, planning_seconds) = timed_plan(generated, tolerance)?;
    let outcome = |model_level: ModelLevel, record: &Record| Outcome {
        model_level,
        errors: distance(record, &truth.record),
        work: record.work,
        seconds: record.seconds[0],
    };
    let record = run_with(generated, &planned.operators)?;
    let chosen = outcome(planned.plan.model_level, &record);
    let mut model_levels = vec![ModelLevel::Lumped];
    for cells in FIXED {
        model_levels.push(ModelLevel::Line { cells, heat: HeatResolution::Lumped });
        if can_be_resolved(&scene) {
            model_levels.push(ModelLevel::Line { cells, heat: HeatResolution::Resolved });
        }
    }
    let fixed = model_levels
        .into_iter()
        .filter_map(|model_level| Some(outcome(model_level, &run(generated, &model_level.apply(&scene)).ok()?)));
    Ok(Judged {
        tolerance,
        chosen,
        planned_error: planned.plan.estimated_error.unwrap_or(0.0),
        estimated_error: planned.plan.estimated_error.or(record.estimated.last().copied()).unwrap_or(plan::UNKNOWN),
        planning_seconds,
        fixed: fixed.collect(),
    })
}
