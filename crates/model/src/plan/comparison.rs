//! Comparison of the model levels: every level is run over the whole nominal trajectory, and its error estimated from the difference
//! to a finer one ([`super::estimates`]).
//!
//! The contact line is run on 9, 17, 33, ... cells with the bodies, steps and tolerance of the user's run, or with those of the nearest
//! tolerance within [`COMPARED`]: the error of the steps at a larger one would conceal the differences between cells, and at a
//! smaller one they are the same, at a cost that leaves room for fewer cells. Cells are doubled until the choice is certain: a level meets the tolerance, and no cheaper one would with the error `d(c, n) - e(n)`. They are
//! doubled once more where the error of the chosen level is mostly that of the comparison. No doubling is made that would cost more
//! than [`BUDGET`].
//!
//! The errors of model reduction and time steps are measured on the lumped level and on the coarsest line, by the difference d of
//! two runs, at the tolerance and at one that differs by a factor of two at least: they are proportional to it, so with q the ratio of the two
//! tolerances the error is `d/(1 - q)`. It is stated as a fraction of `estimated_step_error`, which is a bound for the steps of this
//! trajectory as for those of the user's run. A finer level does not reduce it, so it does not enter the choice.
//!
//! Theory: docs/theory.md, section 8.2.

use super::cost::{self, build_cost};
use super::distance::distance;
use super::estimates::{Certainty, Level, LevelRuns, kind};
use super::growth::Growth;
use super::model_level::{CELLS, ModelLevel};
use super::trajectory::{NominalTrajectory, Run};
use super::{Candidate, largest};
use crate::levels::ModelOperators;
use crate::line::heat::bodies::is_resolved;
use crate::line::operators::RunIn;
use numerics::maximum::maximum;
use scene::{HeatResolution, Scene};

/// Cost of a comparison beyond which cells are not doubled again, in the counted microseconds of [`cost`].
const BUDGET: f64 = 100e3;

/// Factor of the budget where the cells do not show whether they converge.
const UNKNOWN_FACTOR: f64 = 2.5;

/// Fraction of the budget for a doubling that makes the estimated error of the chosen level more accurate without changing the choice.
const ACCURACY_PART: f64 = 0.25;

/// Fraction of the budget for one run, and the least number of steps permitted to every run.
const RUN_PART: f64 = 0.4;
const LEAST_STEPS: f64 = 200.0;

/// Least fraction of a unidirectional trajectory that a line has to cover for an extrapolation to its end.
const LEAST_COVERED: f64 = 0.2;

/// Least and largest tolerance at which levels are compared.
const COMPARED: (f64, f64) = (0.005, 0.025);

/// Tolerance of a second run for the error of reduction and time steps, relative to the first.
const STRICTER: f64 = 0.5;

/// Least error of reduction and time steps over its bound: at the few instants of a trajectory their difference may be small by chance,
/// and an estimate of a tenth of a bound is too small by ten at most.
const LEAST_RATIO: f64 = 0.1;

/// Result of a comparison.
#[derive(Clone, Debug)]
pub struct Comparison {
    /// Every level with its error, by cost.
    pub candidates: Vec<Candidate>,
    /// Levels that were run, with the operators for the scene.
    pub operators: Vec<(ModelLevel, ModelOperators)>,
    /// Finest contact line that was run.
    pub finest: ModelLevel,
    /// Operators of the finest contact line.
    pub line: ModelOperators,
    /// Whether the error is known: the cells converge, and enough of the trajectory was run.
    pub is_known: bool,
    /// Peak rise of the contact temperature, K.
    pub rise: f64,
    /// Internal steps of all runs.
    pub steps: u64,
    /// Fraction of the nominal duration that the finest line covers.
    pub covered: f64,
    /// Cost of the comparison, counted microseconds.
    pub cost: f64,
}

/// State of a comparison.
struct Progress<'a> {
    /// Finds the shape of a run-in punch.
    run_in: RunIn,
    runs: LevelRuns<'a>,
    cost: f64,
    steps: u64,
}

/// Reason for which levels cannot be compared.
#[derive(Clone, Debug)]
pub struct Incomparable {
    /// The reason, with the numbers.
    pub reason: String,
    /// The comparison would take too many steps: the contact line has a solution.
    pub is_too_costly: bool,
}

impl From<String> for Incomparable {
    fn from(reason: String) -> Incomparable {
        Incomparable { reason, is_too_costly: false }
    }
}

/// Compares the levels of `scene` over `course` until one has an error of at most `enough`. `by_cells`: with resolved heat where
/// the contact line resolves it. `growth`: of perturbations over the nominal duration.
///
/// # Errors
/// Error of a level, or of a step of it; too many steps.
pub fn compare(
    scene: &Scene,
    course: &NominalTrajectory,
    enough: f64,
    by_cells: bool,
    growth: Growth,
    run_in: RunIn,
) -> Result<Comparison, Incomparable> {
    let first = if scene.cells > 0 { scene.cells } else { CELLS[0] };
    // Strokes are run with the wear of the whole duration, so their operators are not those of the user's run.
    let own_scene = course.scene(scene);
    let run_scene = &at_tolerance(&own_scene, scene.tolerance.clamp(COMPARED.0, COMPARED.1));
    let whole = ModelLevel::Line { cells: first, heat: HeatResolution::ResolvedWhereCoupled }.apply(run_scene);
    let heat = match by_cells && is_resolved(&whole) {
        true => HeatResolution::Resolved,
        false => HeatResolution::Lumped,
    };
    let runs = LevelRuns { course, heat, levels: Vec::new(), step_ratios: Default::default(), falls_short: false };
    let mut progress = Progress { run_in, runs, cost: 0.0, steps: 0 };
    let mean = progress.lumped(run_scene)?;
    progress.line(run_scene, first, &mean)?;
    progress.measure_steps(&own_scene, run_scene.tolerance, first)?;
    let mut cells = first;
    loop {
        cells = doubled(cells);
        match progress.line(run_scene, cells, &mean) {
            Err(reason) if progress.runs.lines().count() < 2 => return Err(reason),
            Err(_) => break,
            Ok(()) => {}
        }
        let judgement = progress.runs.judge(growth, enough)?;
        let budget = match judgement.certainty(enough) {
            Certainty::None if !judgement.is_known => UNKNOWN_FACTOR * BUDGET,
            Certainty::None => BUDGET,
            Certainty::Choice => ACCURACY_PART * BUDGET,
            Certainty::ChoiceAndError => 0.0,
        };
        let next = progress.cost + progress.runs.cost_of(doubled(cells));
        if scene.cells > 0 || next > budget || cells == CELLS[CELLS.len() - 1] {
            break;
        }
    }
    let judgement = progress.runs.judge(growth, enough)?;
    let is_known = judgement.is_known;
    let candidates = progress.runs.candidates(judgement, scene.cells);
    let finest = progress.runs.lines().next_back().ok_or_else(|| "no contact line could be compared".to_owned())?;
    let rise = finest.run.history.iter().map(|main| main[1].abs()).fold(0.0, maximum);
    let (line, covered) = (finest.operators.clone(), course.part(finest.run.history.len()));
    // With a number of cells set by the user, finer ones serve for comparison only.
    let finest = if scene.cells > 0 { ModelLevel::Line { cells: scene.cells, heat } } else { finest.model_level };
    let (steps, cost) = (progress.steps, progress.cost);
    let operators = match course.repeats > 1.0 || scene.tolerance != run_scene.tolerance {
        true => Vec::new(),
        false => progress.runs.levels.into_iter().map(|level| (level.model_level, level.operators)).collect(),
    };
    Ok(Comparison { candidates, operators, finest, line, is_known, rise, steps, covered, cost })
}

/// The scene at another tolerance.
fn at_tolerance(scene: &Scene, tolerance: f64) -> Scene {
    let mut scene = scene.clone();
    scene.tolerance = tolerance;
    scene
}

/// About twice the number of cells: the next entry of [`CELLS`].
fn doubled(cells: usize) -> usize {
    (2 * cells).saturating_sub(1).clamp(2, CELLS[CELLS.len() - 1])
}

impl Progress<'_> {
    /// Runs the trajectory on `operators`.
    fn run(&mut self, operators: &ModelOperators) -> Result<Run, Incomparable> {
        let per_step = cost::per_step(operators);
        let most = (RUN_PART * BUDGET / per_step).max(LEAST_STEPS);
        let run = self.runs.course.run(operators, most as u32)?;
        if run.history.len() < 2 {
            let reason = format!("{most:.0} internal steps do not reach a hundredth of the nominal duration");
            return Err(Incomparable { reason, is_too_costly: true });
        }
        self.cost += run.steps as f64 * per_step;
        self.steps += run.steps;
        Ok(run)
    }

    fn add(&mut self, model_level: ModelLevel, operators: ModelOperators) -> Result<(), Incomparable> {
        let run = self.run(&operators)?;
        self.runs.levels.push(Level { model_level, operators, run });
        Ok(())
    }

    fn lumped(&mut self, scene: &Scene) -> Result<ModelOperators, Incomparable> {
        let operators = ModelOperators::new(&ModelLevel::Lumped.apply(scene), self.run_in)?;
        self.cost += build_cost(&operators);
        self.add(ModelLevel::Lumped, operators.clone())?;
        Ok(operators)
    }

    /// Runs the contact line on `cells` cells beside the lumped level `mean`, and the same line with lumped heat.
    fn line(&mut self, scene: &Scene, cells: usize, mean: &ModelOperators) -> Result<(), Incomparable> {
        let model_level = ModelLevel::Line { cells, heat: self.runs.heat };
        let line = mean.line_beside(&model_level.apply(scene), self.run_in)?;
        self.cost += build_cost(&line);
        if self.runs.heat == HeatResolution::Resolved {
            self.add(ModelLevel::Line { cells, heat: HeatResolution::Lumped }, line.with_lumped_heat())?;
        }
        self.add(model_level, line)?;
        let told = self.runs.course.repeats > 1.0
            || self
                .runs
                .levels
                .last()
                .is_some_and(|level| self.runs.course.part(level.run.history.len()) >= LEAST_COVERED);
        if told {
            return Ok(());
        }
        if self.runs.lines().count() > 2 {
            self.runs.levels.pop();
            let reason = format!(
                "{cells} cells cover less than {LEAST_COVERED} of the nominal duration in the steps they may take"
            );
            return Err(Incomparable { reason, is_too_costly: true });
        }
        self.runs.falls_short = true;
        Ok(())
    }

    /// Measures the errors of reduction and time steps with a second run of the lumped level and of the coarsest line: at the tolerance
    /// of `scene` where that differs from that of the first run, `compared`, by a factor of two at least, else at half of it.
    fn measure_steps(&mut self, scene: &Scene, compared: f64, cells: usize) -> Result<(), Incomparable> {
        let own_is_second = scene.tolerance.min(compared) <= STRICTER * scene.tolerance.max(compared);
        let second = if own_is_second { scene.tolerance } else { STRICTER * compared };
        let stated = if own_is_second { second } else { compared };
        let runs = LevelRuns { levels: Vec::new(), ..self.runs };
        let mut other = Progress { runs, ..*self };
        let scene = at_tolerance(scene, second);
        let mean = other.lumped(&scene)?;
        other.line(&scene, cells, &mean)?;
        (self.cost, self.steps) = (other.cost, other.steps);
        for (first, other) in self.runs.levels.iter().zip(&other.runs.levels) {
            let runs = [&first.run, &other.run];
            let own = runs[usize::from(own_is_second)];
            let ratio = |most: usize, bound: f64| {
                let count = most.min(first.run.history.len()).min(other.run.history.len());
                let apart =
                    largest(distance(&own.history[..count], &runs[usize::from(!own_is_second)].history[..count]));
                let error = apart * stated / (compared - second).abs();
                if bound > 0.0 { (error / bound).clamp(LEAST_RATIO, 1.0) } else { 1.0 }
            };
            let [loaded, whole] =
                [ratio(self.runs.course.loaded, own.step_bounds[0]), ratio(usize::MAX, own.step_bounds[1])];
            // Runs of the same steps under load do not show their error.
            let shows = (other.run.loaded_steps > first.run.loaded_steps) == (second < compared)
                && other.run.loaded_steps != first.run.loaded_steps;
            self.runs.step_ratios[kind(first.model_level)] = [if shows { loaded } else { whole.max(loaded) }, whole];
        }
        Ok(())
    }
}
