//! Estimated errors of the model levels: every level is run over the whole nominal trajectory and compared with a finer one.
//!
//! The contact line is run on 9, 17, 33, ... cells with the bodies, steps and tolerance of the user's run, or with those of the
//! tolerance [`COARSEST`] where that of the user is larger: the error of its steps would conceal the differences. With d the largest
//! difference of an output between two runs, relative to the largest value of the finer one, and r the ratio of the differences
//! of successive refinements, the error on the finest cells n is about
//!
//! ```text
//! e(n) = d(n/2, n)/(r - 1),
//! ```
//!
//! and that of every other level c is `e(c) = d(c, n) + e(n)`. With two lines only, and where a part of the zone is not in
//! contact, r is taken as 2: first order in the cell size. The errors of model reduction and time steps are measured on the
//! lumped level and on the coarsest line, by the difference d of two runs, at the tolerance and at a smaller one, at most half: they
//! are proportional to it, so with q the ratio of the two tolerances the error is `d/(1 - q)`. It is stated as a fraction of `estimated_step_error`, which is a bound for the steps of this
//! trajectory as for those of the user's run. A finer level does not reduce it, so it does not enter the choice.
//!
//! Cells are doubled until the choice is certain: a level meets the tolerance, and no cheaper one would with the error
//! `d(c, n) - e(n)`. They are doubled once more where the error of the chosen level is mostly that of the comparison. No doubling is
//! made that would cost more than [`BUDGET`]; more doublings are extrapolated with r, from the second on by r = 2 at most. Between two
//! numbers of cells, one has the mean of their errors.
//!
//! A reciprocating trajectory is shorter than the nominal duration, and a run may end early where it requires more steps than the
//! budget permits. Errors of temperature and force are then extrapolated with the power of time by which they grew over the last
//! half of the run, to four times its length at most: slower heating of thick bodies is the same at all levels.
//!
//! Theory: docs/theory.md, section 8.2.

use super::cost::{self, build_cost};
use super::model_level::{CELLS, ModelLevel};
use super::trajectory::{NominalTrajectory, Run, distance};
use super::{Candidate, MOST_IN_VAIN, RELEASED};
use crate::levels::ModelOperators;
use crate::line::heat::bodies::is_resolved;
use crate::line::operators::RunIn;
use numerics::maximum::maximum;
use scene::{HeatResolution, Scene};

/// Cost of a comparison beyond which cells are not doubled again, in the counted microseconds of [`cost`], which assume new
/// operators in every step: some 100 ms.
const BUDGET: f64 = 400e3;

/// Fraction of the budget for a doubling that makes the estimated error of the chosen level more accurate without changing the choice,
/// and the fraction of that error due to the finest line from which on there is one.
const ACCURACY_PART: f64 = 0.25;
const ACCURATE: f64 = 0.5;

/// Fraction of the budget for one run, and the least number of steps permitted to every run.
const RUN_PART: f64 = 0.4;
const LEAST_STEPS: f64 = 200.0;

/// Expected cost of the next doubling relative to the last.
const DEARER: f64 = 2.5;

/// Ratio by which the error falls when the cells are doubled, before it is measured, and bounds of the measured one. The lower
/// bound is that of a temperature under a pressure that is singular at the edge, the upper one is second order. Where a part of the
/// zone is not in contact, cells open one by one: the error is of first order in their size and varies from one number of cells to
/// the next, so that a ratio of two differences is chance, and the assumed one is taken.
const ASSUMED_RATIO: f64 = 2.0;
const RATIO: (f64, f64) = (1.5, 4.0);

/// Number of doublings that are extrapolated in any case.
const LEAST_DOUBLINGS: usize = 2;

/// Ratio of successive differences below which cells do not converge, where the last difference is above the second number.
const CONVERGING: (f64, f64) = (1.1, 0.05);

/// Least fraction of a unidirectional trajectory that a line has to cover for an extrapolation to its end.
const LEAST_COVERED: f64 = 0.2;

/// Bounds of the power of time by which an error is extrapolated, and largest extrapolation in lengths of the run.
const GROWTH: (f64, f64) = (0.0, 0.5);
const CARRIED_ON: f64 = 4.0;

/// Largest tolerance at which levels are compared.
const COARSEST: f64 = 0.025;

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

/// Model level that was run.
struct Level {
    model_level: ModelLevel,
    operators: ModelOperators,
    run: Run,
}

/// State of a comparison.
struct Progress<'a> {
    /// Finds the shape of a run-in punch.
    run_in: RunIn,
    course: &'a NominalTrajectory,
    /// Choice between lumped and resolved heat on the contact line.
    heat: HeatResolution,
    levels: Vec<Level>,
    /// Error of reduction and time steps over `estimated_step_error`, under load and with the release: of the lumped level, of a line
    /// with lumped heat, and of one with resolved heat.
    step_ratios: [[f64; 2]; 3],
    /// Even coarse lines cover too little of the trajectory.
    falls_short: bool,
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
/// the contact line resolves it. `may_grow`: cells that neither agree to `enough` nor show a ratio of convergence are taken not
/// to converge.
///
/// # Errors
/// Error of a level, or of a step of it; too many steps.
pub fn compare(
    scene: &Scene,
    course: &NominalTrajectory,
    enough: f64,
    by_cells: bool,
    may_grow: bool,
    run_in: RunIn,
) -> Result<Comparison, Incomparable> {
    let first = if scene.cells > 0 { scene.cells } else { CELLS[0] };
    // Strokes are run with the wear of the whole duration, so their operators are not those of the user's run.
    let own_scene = course.scene(scene);
    let run_scene = &at_tolerance(&own_scene, scene.tolerance.min(COARSEST));
    let whole = ModelLevel::Line { cells: first, heat: HeatResolution::ResolvedWhereCoupled }.apply(run_scene);
    let heat = match by_cells && is_resolved(&whole) {
        true => HeatResolution::Resolved,
        false => HeatResolution::Lumped,
    };
    let mut progress = Progress {
        course,
        heat,
        run_in,
        levels: Vec::new(),
        step_ratios: [[1.0; 2]; 3],
        falls_short: false,
        cost: 0.0,
        steps: 0,
    };
    let mean = progress.lumped(run_scene)?;
    progress.line(run_scene, first, &mean)?;
    progress.measure_steps(&own_scene, run_scene.tolerance, first)?;
    let mut cells = first;
    loop {
        let before = progress.cost;
        cells = doubled(cells);
        match progress.line(run_scene, cells, &mean) {
            Err(reason) if progress.lines().count() < 2 => return Err(reason),
            Err(_) => break,
            Ok(()) => {}
        }
        let judgement = progress.judge(may_grow.then_some(enough))?;
        let budget = match judgement.certainty(enough) {
            Certainty::None => BUDGET,
            Certainty::Choice => ACCURACY_PART * BUDGET,
            Certainty::ChoiceAndError => 0.0,
        };
        let next = progress.cost + DEARER * (progress.cost - before);
        if scene.cells > 0 || next > budget || cells == CELLS[CELLS.len() - 1] {
            break;
        }
    }
    let Judgement { mut candidates, ratio, is_known, .. } = progress.judge(may_grow.then_some(enough))?;
    match scene.cells {
        0 => {
            progress.extrapolate(&mut candidates, ratio, is_known);
            progress.interpolate(&mut candidates);
        }
        own => candidates
            .retain(|candidate| candidate.model_level == ModelLevel::Lumped || candidate.model_level.cells() == own),
    }
    candidates.sort_by(|one, other| one.run_cost.total_cmp(&other.run_cost));
    let finest = progress.lines().next_back().ok_or_else(|| "no contact line could be compared".to_owned())?;
    let rise = finest.run.history.iter().map(|main| main[1].abs()).fold(0.0, maximum);
    let (line, covered) = (finest.operators.clone(), course.part(finest.run.history.len()));
    // With a number of cells set by the user, finer ones serve for comparison only.
    let finest = if scene.cells > 0 { ModelLevel::Line { cells: scene.cells, heat } } else { finest.model_level };
    let (steps, cost) = (progress.steps, progress.cost);
    let operators = match course.repeats > 1.0 || scene.tolerance > COARSEST {
        true => Vec::new(),
        false => progress.levels.into_iter().map(|level| (level.model_level, level.operators)).collect(),
    };
    Ok(Comparison { candidates, operators, finest, line, is_known, rise, steps, covered, cost })
}

/// Estimated errors of the levels.
struct Judgement {
    candidates: Vec<Candidate>,
    /// Error of the finest line under load, and with the release: the uncertainty of those of the other levels.
    finest_errors: [f64; 2],
    /// Ratio by which the error falls when the cells are doubled.
    ratio: f64,
    is_known: bool,
}

/// Part of the result that finer cells would not change.
#[derive(Clone, Copy, PartialEq, Debug)]
enum Certainty {
    None,
    /// The chosen level.
    Choice,
    /// And its error, within a factor of three.
    ChoiceAndError,
}

impl Judgement {
    fn certainty(&self, enough: f64) -> Certainty {
        let meeting = self.candidates.iter().filter(|candidate| candidate.meets(enough));
        let chosen = meeting.min_by(|one, other| one.run_cost.total_cmp(&other.run_cost));
        let Some(chosen) = chosen.filter(|_| self.is_known) else { return Certainty::None };
        let [loaded, released] = self.finest_errors;
        let may_meet = |candidate: &Candidate| {
            let least = [candidate.error() - 2.0 * loaded, candidate.released - 2.0 * released];
            candidate.run_cost < chosen.run_cost && least[0] <= enough && least[1] <= RELEASED * enough
        };
        if self.candidates.iter().any(may_meet) {
            Certainty::None
        } else if loaded <= ACCURATE * chosen.error() {
            Certainty::ChoiceAndError
        } else {
            Certainty::Choice
        }
    }
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
        let run = self.course.run(operators, most as u32)?;
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
        self.levels.push(Level { model_level, operators, run });
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
        let model_level = ModelLevel::Line { cells, heat: self.heat };
        let line = mean.line_beside(&model_level.apply(scene), self.run_in)?;
        self.cost += build_cost(&line);
        if self.heat == HeatResolution::Resolved {
            self.add(ModelLevel::Line { cells, heat: HeatResolution::Lumped }, line.with_lumped_heat())?;
        }
        self.add(model_level, line)?;
        let told = self.course.repeats > 1.0
            || self.levels.last().is_some_and(|level| self.course.part(level.run.history.len()) >= LEAST_COVERED);
        if told {
            return Ok(());
        }
        if self.lines().count() > 2 {
            self.levels.pop();
            let reason = format!(
                "{cells} cells cover less than {LEAST_COVERED} of the nominal duration in the steps they may take"
            );
            return Err(Incomparable { reason, is_too_costly: true });
        }
        self.falls_short = true;
        Ok(())
    }

    /// Measures the errors of reduction and time steps with a second run of the lumped level and of the coarsest line: at the tolerance
    /// of `scene` where that is at least twice that of the first run, `compared`, else at half of it.
    fn measure_steps(&mut self, scene: &Scene, compared: f64, cells: usize) -> Result<(), Incomparable> {
        let second = if STRICTER * scene.tolerance >= compared { scene.tolerance } else { STRICTER * compared };
        let smaller = (compared / second).min(second / compared);
        let scene = at_tolerance(scene, second);
        let mut other = Progress { levels: Vec::new(), ..*self };
        let mean = other.lumped(&scene)?;
        other.line(&scene, cells, &mean)?;
        (self.cost, self.steps) = (other.cost, other.steps);
        for (first, second) in self.levels.iter().zip(&other.levels) {
            let runs = (&first.run, &second.run);
            let (own, strict) = if scene.tolerance > compared { (runs.1, runs.0) } else { runs };
            let counts = [self.course.loaded.min(strict.history.len()), strict.history.len()];
            let ratio = |count: usize, bound: f64| {
                let error =
                    largest(distance(&own.history[..count.min(own.history.len())], &strict.history)) / (1.0 - smaller);
                if bound > 0.0 { (error / bound).clamp(LEAST_RATIO, 1.0) } else { 1.0 }
            };
            let [loaded, whole] = std::array::from_fn(|phase| ratio(counts[phase], own.step_bounds[phase]));
            // Runs of the same steps under load do not show their error.
            let shows = strict.loaded_steps > own.loaded_steps;
            self.step_ratios[kind(first.model_level)] = [if shows { loaded } else { whole.max(loaded) }, whole];
        }
        Ok(())
    }

    /// Contact lines with resolved heat, from coarse to fine.
    fn lines(&self) -> impl DoubleEndedIterator<Item = &Level> {
        self.levels.iter().filter(|level| level.model_level.heat() == Some(self.heat))
    }

    /// Estimates the errors of all levels. `agreed`: the difference of the finest lines accepted where their ratio is not known.
    fn judge(&self, agreed: Option<f64>) -> Result<Judgement, String> {
        let mut lines = self.lines().rev();
        let (Some(finest), Some(before)) = (lines.next(), lines.next()) else {
            return Err("one contact line has nothing to be compared with".into());
        };
        let earlier = lines.next();
        let measured = |difference: &dyn Fn(&Run, &Run) -> [f64; 3], segments: usize| {
            let between = difference(&before.run, &finest.run);
            let ratio = earlier.map(|earlier| largest(difference(&earlier.run, &before.run)) / largest(between));
            // Equality to the last bit counts as the best ratio.
            let ratio = ratio.map(|ratio| if ratio.is_nan() { RATIO.1 } else { ratio });
            // A difference within the error of the time steps does not show how fast the cells converge.
            let least = if largest(between) <= self.error_of_steps(finest) { ASSUMED_RATIO } else { RATIO.0 };
            let parted = [&before.run, &finest.run].iter().any(|run| run.parted.is_some_and(|first| first < segments));
            let bounded = ratio.filter(|_| !parted).map_or(ASSUMED_RATIO, |ratio| ratio.clamp(least, RATIO.1));
            (between, ratio, bounded)
        };
        let errors = |difference: &dyn Fn(&Run, &Run) -> [f64; 3], segments: usize, run: &Run| {
            let (between, _, ratio) = measured(difference, segments);
            let own = 1.0 / (ratio - 1.0);
            let apart = difference(run, &finest.run);
            std::array::from_fn(|output| apart[output] + own * between[output])
        };
        let loaded = |run: &Run, finer: &Run| self.extrapolated_difference(run, finer);
        let whole = |run: &Run, finer: &Run| distance(&run.history, &finer.history);
        let (under_load, all) = (self.course.loaded, self.course.segments.len());
        let (between, ratio, bounded) = measured(&loaded, under_load);
        let converges = match agreed {
            Some(agreed) => largest(between) <= agreed || ratio.is_some_and(|ratio| ratio >= RATIO.0),
            None => ratio.is_none_or(|ratio| ratio >= CONVERGING.0) || largest(between) <= CONVERGING.1,
        };
        let finest_errors =
            [largest(errors(&loaded, under_load, &finest.run)), largest(errors(&whole, all, &finest.run))];
        let candidates = self.levels.iter().map(|level| {
            let errors_of_load = errors(&loaded, under_load, &level.run);
            Candidate {
                model_level: level.model_level,
                errors: errors_of_load,
                released: largest(errors(&whole, all, &level.run)).max(largest(errors_of_load)),
                step_ratios: self.step_ratios[kind(level.model_level)],
                cost: cost::per_step(&level.operators),
                run_cost: cost::per_step(&level.operators) * self.steps_of(&level.run),
            }
        });
        let candidates = candidates.collect();
        Ok(Judgement { candidates, finest_errors, ratio: bounded, is_known: converges && !self.falls_short })
    }

    /// Error of reduction and time steps of a run.
    fn error_of_steps(&self, level: &Level) -> f64 {
        self.step_ratios[kind(level.model_level)][1] * level.run.step_bounds[1]
    }

    /// Expected internal steps of the nominal duration.
    fn steps_of(&self, run: &Run) -> f64 {
        run.loaded_steps as f64 / self.course.part(run.history.len())
    }

    /// Difference of two runs over their common part before the release, for temperature and force extrapolated to the nominal
    /// duration.
    fn extrapolated_difference(&self, run: &Run, finer: &Run) -> [f64; 3] {
        let count = run.history.len().min(finer.history.len()).min(self.course.loaded);
        let apart = distance(&run.history[..count], &finer.history[..count]);
        let (part, half) = (self.course.part(count), count / 2);
        if part > 0.99 || half == 0 {
            return apart;
        }
        let before = distance(&run.history[..half], &finer.history[..half]);
        let doublings = (part / self.course.part(half)).log2();
        std::array::from_fn(|output| {
            // Wear is accelerated: the run covers its final value.
            if output == 0 || apart[output] == 0.0 {
                return apart[output];
            }
            let power = ((apart[output] / before[output]).log2() / doublings).clamp(GROWTH.0, GROWTH.1);
            apart[output] * part.recip().min(CARRIED_ON).powf(power)
        })
    }

    /// Adds levels with finer cells than were run: [`LEAST_DOUBLINGS`] doublings, and more where the errors are known, up to the number of
    /// cells that is taken where no level is good enough. The error of lumped heat, where heat feeds back, does not decrease with finer
    /// cells.
    fn extrapolate(&self, candidates: &mut Vec<Candidate>, ratio: f64, is_known: bool) {
        let finest = candidates.iter().rev().find(|candidate| candidate.model_level.heat() == Some(self.heat)).copied();
        let (Some(finest), Some(level)) = (finest, self.lines().next_back()) else { return };
        let (cells, mut factor, mut last) = (finest.model_level.cells(), 1.0, finest.model_level.cells());
        // All but the first doubling at most by first order: they are further from where the ratio was measured.
        let ratios = std::iter::once(ratio).chain(std::iter::repeat(ratio.min(ASSUMED_RATIO)));
        let finer = CELLS.into_iter().filter(|&count| count > cells).enumerate();
        let finer = finer.filter(|&(before, count)| before < LEAST_DOUBLINGS || is_known && count <= MOST_IN_VAIN);
        for ((_, count), ratio) in finer.zip(ratios) {
            factor *= (last as f64 / count as f64).powf(ratio.log2());
            last = count;
            let cost = cost::per_step_of(count, cost::states(&level.operators));
            candidates.push(Candidate {
                model_level: ModelLevel::Line { cells: count, heat: self.heat },
                errors: finest.errors.map(|error| error * factor),
                released: finest.released * factor,
                step_ratios: finest.step_ratios,
                cost,
                run_cost: cost * self.steps_of(&level.run),
            });
        }
    }

    /// Adds the number of cells midway between two that differ by a doubling, with the mean of their errors.
    fn interpolate(&self, candidates: &mut Vec<Candidate>) {
        let of = |cells| ModelLevel::Line { cells, heat: self.heat };
        let between = CELLS.windows(2).filter_map(|pair| {
            let find = |cells| candidates.iter().find(|candidate| candidate.model_level == of(cells));
            let (coarse, fine) = (find(pair[0])?, find(pair[1])?);
            let mean = f64::midpoint;
            Some(Candidate {
                model_level: of(usize::midpoint(pair[0], pair[1])),
                errors: std::array::from_fn(|output| mean(coarse.errors[output], fine.errors[output])),
                released: mean(coarse.released, fine.released),
                step_ratios: fine.step_ratios,
                cost: mean(coarse.cost, fine.cost),
                run_cost: mean(coarse.run_cost, fine.run_cost),
            })
        });
        let between: Vec<_> = between.collect();
        candidates.extend(between);
    }
}

/// Index of a level's step ratio.
fn kind(model_level: ModelLevel) -> usize {
    match model_level.heat() {
        None => 0,
        Some(HeatResolution::Lumped) => 1,
        Some(_) => 2,
    }
}

/// Largest error; infinite where one is NaN.
pub fn largest(errors: [f64; 3]) -> f64 {
    errors.into_iter().fold(0.0, |most, error| if error.is_nan() { f64::INFINITY } else { error.max(most) })
}
