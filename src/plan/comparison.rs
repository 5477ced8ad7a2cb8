//! Errors of the levels, measured: every level takes the whole nominal course, and so does a finer reference.
//!
//! The reference is the contact line on twice the cells of the finest candidate, with a quarter of the tolerance in its bodies and its
//! steps: what a candidate differs from it by holds its level, its cells, the reduction of its bodies and its time steps together. With
//! `d(c)` that difference, over the largest value of the reference, and `r` the ratio by which the differences of successive
//! references fall, the reference itself is off by
//!
//! ```text
//! e = d/(r - 1)      d the difference of the last two references
//! ```
//!
//! and a candidate by `d(c) + e`. Before there are two references `d` is that of the finest candidate, and `r` is taken as 2: first
//! order in the cells. Cells are doubled until a candidate meets the tolerance or the next reference would cost more than
//! [`BUDGET`]; finer cells than were run are extrapolated with `r`.
//!
//! Reciprocating courses are shorter than the nominal duration. Their errors of temperature and force are carried on by the factor
//! that they have grown with from half of what was run to all of it, per doubling of the time.

use super::cost::{self, build_cost};
use super::course::{Course, Run, distance};
use super::rung::{CELLS, Rung};
use super::Candidate;
use crate::coupled::line::heat::bodies::on_the_cells;
use crate::coupled::model::Operators;
use crate::scene::{HeatAlongContact, Scene};

/// Cost of a comparison beyond which no finer reference is run, microseconds of a core of 3 GHz; see [`cost`].
const BUDGET: f64 = 100e3;

/// Part of the budget that one run may take, and the least steps that every run may take.
const RUN_PART: f64 = 0.4;
const LEAST_STEPS: f64 = 200.0;

/// Tolerance of a reference over that of the scene, and the finest of one.
const REFERENCE_TOLERANCE: (f64, f64) = (0.25, 2e-5);

/// Ratio by which the error falls when the cells are doubled, before it is measured, and bounds of the measured one. The lower bound is
/// that of a temperature under a pressure that is singular at the edge.
const ASSUMED_RATIO: f64 = 2.0;
const RATIO: (f64, f64) = (1.5, 4.0);

/// Ratio of successive differences below which cells are taken not to converge, where the last difference is above this.
const CONVERGING: (f64, f64) = (1.1, 0.05);

/// Bounds of the growth of an error with every doubling of the time.
const GROWTH: (f64, f64) = (0.8, 1.4);

/// What was found.
#[derive(Clone, Debug)]
pub struct Comparison {
    /// Every level with its error, by cost.
    pub candidates: Vec<Candidate>,
    /// The levels that were run, as they are for the scene.
    pub operators: Vec<(Rung, Operators)>,
    /// A contact line of the scene.
    pub line: Operators,
    /// Whether the references converge as their cells are doubled, to a part of the tolerance where heat may grow.
    pub converges: bool,
    /// Cells of the finest level that was run as a candidate.
    pub finest: usize,
    /// Peak rise of the contact temperature, K.
    pub rise: f64,
    /// Internal steps of all runs.
    pub steps: u64,
    /// Part of the nominal duration that the reference covers.
    pub covered: f64,
    /// Cost of the comparison, microseconds.
    pub cost: f64,
}

/// Runs of a comparison so far.
struct Progress<'a> {
    scene: &'a Scene,
    course: &'a Course,
    /// Heat of the contact line.
    heat: HeatAlongContact,
    cost: f64,
    steps: u64,
    runs: Vec<(Rung, Operators, Run)>,
}

impl Progress<'_> {
    fn run(&mut self, operators: &Operators) -> Result<Run, String> {
        let per_step = cost::per_step(operators);
        let most = (RUN_PART * BUDGET / per_step).max(LEAST_STEPS);
        let run = self.course.run(operators, most as u32)?;
        if run.history.is_empty() {
            return Err(format!("{most} internal steps do not reach a thousandth of the nominal duration"));
        }
        self.cost += run.steps as f64 * per_step;
        self.steps += run.steps;
        Ok(run)
    }

    fn built(&mut self, operators: Operators) -> Operators {
        self.cost += build_cost(&operators);
        operators
    }

    fn candidate(&mut self, rung: Rung, operators: Operators) -> Result<(), String> {
        let run = self.run(&operators)?;
        self.runs.push((rung, operators, run));
        Ok(())
    }

    /// The contact line on `cells` cells as a candidate, and the same with its heat by the mean.
    fn line(&mut self, cells: usize, mean: &Operators) -> Result<(), String> {
        let heat = self.heat;
        let rung = Rung::Line { cells, heat };
        let line = mean.line_beside(&rung.apply(self.scene))?;
        let line = self.built(line);
        if heat == HeatAlongContact::OnTheCells {
            let rung = Rung::Line { cells, heat: HeatAlongContact::ByItsMean };
            self.candidate(rung, line.with_mean_heat())?;
        }
        self.candidate(rung, line)
    }
}

/// Compares the levels of `scene` over `course` until one has an error of at most `enough`. `by_cells`: heat is on the cells where the
/// contact line has it there.
///
/// # Errors
/// What a level or a step of it refuses.
pub fn compare(scene: &Scene, course: &Course, enough: f64, by_cells: bool, may_grow: bool) -> Result<Comparison, String> {
    let first = if scene.cells > 0 { scene.cells } else { CELLS[0] };
    let mut probe = Rung::Line { cells: first, heat: HeatAlongContact::WhereItFeedsBack }.apply(scene);
    let heat = match by_cells && on_the_cells(&probe) {
        true => HeatAlongContact::OnTheCells,
        false => HeatAlongContact::ByItsMean,
    };
    probe.tolerance = (REFERENCE_TOLERANCE.0 * scene.tolerance).max(REFERENCE_TOLERANCE.1).min(scene.tolerance);
    let mut progress = Progress { scene, course, heat, cost: 0.0, steps: 0, runs: Vec::new() };
    let mean = Operators::new(&Rung::Lumped.apply(scene))?;
    let mean = progress.built(mean);
    progress.candidate(Rung::Lumped, mean.clone())?;
    let mut references: Vec<(usize, Run)> = Vec::new();
    let mut last_cost = 0.0;
    let mut cells = first;
    loop {
        let before = progress.cost;
        if let Err(reason) = progress.line(cells, &mean) {
            if references.is_empty() {
                return Err(reason);
            }
            break;
        }
        let twice = doubled(cells);
        let reference = Operators::new(&Rung::Line { cells: twice, heat }.apply(&probe));
        let reference = reference.and_then(|operators| {
            let operators = progress.built(operators);
            progress.run(&operators)
        });
        match reference {
            Ok(run) => references.push((twice, run)),
            Err(reason) if references.is_empty() => return Err(reason),
            Err(_) => break,
        }
        last_cost = (progress.cost - before).max(last_cost);
        let found = judge(&progress, &references, may_grow.then_some(enough));
        let met = found.0.iter().any(|candidate| candidate.error() <= enough) && (found.2 || references.len() > 1);
        // The work of twice the cells: their pairs, and more of the bodies' states.
        if met || scene.cells > 0 || progress.cost + 2.5 * last_cost > BUDGET || twice >= 129 {
            break;
        }
        cells = twice;
    }
    let (mut candidates, ratio, converges) = judge(&progress, &references, may_grow.then_some(enough));
    if scene.cells == 0 {
        extrapolate(&mut candidates, &progress, ratio);
    }
    candidates.sort_by(|one, other| one.run_cost.total_cmp(&other.run_cost));
    let reference = references.last().map(|(_, run)| run).ok_or("no level could be compared")?;
    let rise = reference.history.iter().map(|main| main[1].abs()).fold(0.0, f64::max);
    let covered = course.part(reference.history.len());
    let finest = progress.runs.iter().map(|(rung, ..)| rung.cells()).max().unwrap_or(1);
    let line = progress.runs.iter().rev().find(|(rung, ..)| *rung != Rung::Lumped).map(|(_, operators, _)| operators);
    Ok(Comparison {
        candidates,
        line: line.ok_or("no contact line could be compared")?.clone(),
        converges,
        finest,
        rise,
        steps: progress.steps,
        covered,
        cost: progress.cost,
        operators: progress.runs.into_iter().map(|(rung, operators, _)| (rung, operators)).collect(),
    })
}

/// About twice as many cells: those of the next entry of [`CELLS`].
fn doubled(cells: usize) -> usize {
    (2 * cells).saturating_sub(1).clamp(2, CELLS[CELLS.len() - 1])
}

/// Errors of all candidates, the ratio by which those of the cells fall, and whether the references converge. `agreed`: they have to
/// agree to this.
fn judge(progress: &Progress, references: &[(usize, Run)], agreed: Option<f64>) -> (Vec<Candidate>, f64, bool) {
    let last = &references[references.len() - 1].1;
    let course = progress.course;
    let finest = progress.runs.iter().rev().find(|(rung, ..)| rung.heat() == Some(progress.heat));
    let finest = finest.map_or([0.0; 3], |(.., run)| carried_on(course, run, last));
    let between = match references.len().checked_sub(2) {
        Some(before) => carried_on(course, &references[before].1, last),
        None => finest,
    };
    let earlier = match references.len().checked_sub(3) {
        Some(first) => Some(carried_on(course, &references[first].1, &references[first + 1].1)),
        // The coarsest cells against the first reference stand for the difference before.
        None if references.len() == 2 => {
            let coarse = progress.runs.iter().find(|(rung, ..)| rung.heat() == Some(progress.heat));
            coarse.map(|(.., run)| carried_on(course, run, &references[0].1))
        }
        None => None,
    };
    let ratio = earlier.map_or(ASSUMED_RATIO, |earlier| largest(earlier) / largest(between));
    let ratio = if ratio.is_nan() { RATIO.1 } else { ratio };
    let bounded = ratio.clamp(RATIO.0, RATIO.1);
    let own = between.map(|apart| apart / (bounded - 1.0));
    let converges = match agreed {
        Some(agreed) => largest(between) <= agreed,
        None => ratio >= CONVERGING.0 || largest(between) <= CONVERGING.1,
    };
    let candidates = progress.runs.iter().map(|(rung, operators, run)| {
        let apart = carried_on(course, run, last);
        let whole = run.steps as f64 / course.part(run.history.len());
        Candidate {
            rung: *rung,
            errors: std::array::from_fn(|output| apart[output] + own[output]),
            cost: cost::per_step(operators),
            run_cost: cost::per_step(operators) * whole,
        }
    });
    (candidates.collect(), bounded, converges)
}

/// Difference of two runs over what both cover, temperature and force carried on to the whole nominal duration.
fn carried_on(course: &Course, run: &Run, reference: &Run) -> [f64; 3] {
    let count = run.history.len().min(reference.history.len());
    let apart = distance(&run.history[..count], &reference.history[..count]);
    let part = course.part(count);
    let half = count / 2;
    if part >= 0.99 || half == 0 {
        return apart;
    }
    let before = distance(&run.history[..half], &reference.history[..half]);
    let doublings = (1.0 / part).log2();
    std::array::from_fn(|output| match output {
        // Wear is accelerated: its end has been seen.
        0 => apart[0],
        _ if apart[output] > 0.0 => {
            apart[output] * (apart[output] / before[output]).clamp(GROWTH.0, GROWTH.1).powf(doublings)
        }
        _ => 0.0,
    })
}

/// Adds finer cells than were run. Heat by the mean beside cells that carry it has an error that finer cells leave.
fn extrapolate(candidates: &mut Vec<Candidate>, progress: &Progress, ratio: f64) {
    let finest = candidates.iter().rev().find(|candidate| candidate.rung.heat() == Some(progress.heat)).copied();
    let run = progress.runs.iter().rev().find(|(rung, ..)| rung.heat() == Some(progress.heat));
    let (Some(finest), Some((_, operators, run))) = (finest, run) else { return };
    let whole = run.steps as f64 / progress.course.part(run.history.len());
    let cells = finest.rung.cells();
    for count in CELLS.into_iter().filter(|&count| count > cells) {
        let factor = (cells as f64 / count as f64).powf(ratio.log2());
        let cost = cost::per_step_of(count, cost::states(operators));
        candidates.push(Candidate {
            rung: Rung::Line { cells: count, heat: progress.heat },
            errors: finest.errors.map(|error| error * factor),
            cost,
            run_cost: cost * whole,
        });
    }
}

/// The largest; infinite where one is no number.
pub fn largest(errors: [f64; 3]) -> f64 {
    errors.into_iter().fold(0.0, |most, error| if error.is_nan() { f64::INFINITY } else { error.max(most) })
}
