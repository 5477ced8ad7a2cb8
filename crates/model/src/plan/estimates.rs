//! Estimated errors of the levels that were run over the nominal trajectory, from the differences of their histories.
//!
//! With d the largest difference of an output between two runs, relative to the largest value of the finer one, and r the ratio of
//! the differences of successive refinements, the error on the finest cells n is about
//!
//! ```text
//! e(n) = d(n/2, n)/(r - 1),
//! ```
//!
//! and that of every other level c is `e(c) = d(c, n) + e(n)`. With two lines only r is taken as 2, first order in the cell size,
//! with more as 2.4 where a part of the zone is not in contact. More doublings are extrapolated with r, from the second on by r = 2 at
//! most. Between two numbers of cells, one has the mean of their errors.
//!
//! A reciprocating trajectory is shorter than the nominal duration, and a run may end early where it requires more steps than the
//! budget permits. Errors of temperature and force are then extrapolated with the power of time by which they grew over the last
//! half of the run, to four times its length at most: slower heating of thick bodies is the same at all levels.
//!
//! Theory: docs/theory.md, section 8.2.

use super::cost;
use super::distance::distance;
use super::growth::Growth;
use super::model_level::{CELLS, ModelLevel};
use super::trajectory::{NominalTrajectory, Run};
use super::{Candidate, MOST_IN_VAIN, RELEASED, largest};
use crate::levels::ModelOperators;
use scene::HeatResolution;

/// Ratio by which the error falls when the cells are doubled, before it is measured, and bounds of the measured one. The lower
/// bound is that of a temperature under a pressure that is singular at the edge, the upper one is second order. Where a part of the
/// zone is not in contact, the edge is known to a part of a cell, which varies from one number of cells to the next: a ratio of two
/// differences may be chance, and an assumed one is taken, between first and second order.
const ASSUMED_RATIO: f64 = 2.0;
const PARTED_RATIO: f64 = 2.4;
const RATIO: (f64, f64) = (1.5, 4.0);

/// Number of doublings that are extrapolated in any case.
const LEAST_DOUBLINGS: usize = 2;

/// Ratio of successive differences below which cells do not converge, where the last difference is above the second number.
const CONVERGING: (f64, f64) = (1.1, 0.05);

/// Bounds of the power of time by which an error is extrapolated, and largest extrapolation in lengths of the run.
const GROWTH: (f64, f64) = (0.0, 0.5);
const CARRIED_ON: f64 = 4.0;

/// Fraction of the error of the chosen level due to the finest line up to which that error is accurate.
const ACCURATE: f64 = 0.5;

/// Model level that was run.
pub struct Level {
    /// The level.
    pub model_level: ModelLevel,
    /// Its operators, for the nominal trajectory.
    pub operators: ModelOperators,
    /// Its run.
    pub run: Run,
}

/// Levels that were run over a trajectory.
pub struct LevelRuns<'a> {
    /// The trajectory.
    pub course: &'a NominalTrajectory,
    /// Lumped or resolved heat of the contact lines that serve as reference.
    pub heat: HeatResolution,
    /// The levels, the lumped one first, lines from coarse to fine.
    pub levels: Vec<Level>,
    /// Error of reduction and time steps over `estimated_step_error`, under load and with the release; by [`kind`].
    pub step_ratios: [[f64; 2]; KINDS],
    /// Even coarse lines cover too little of the trajectory.
    pub falls_short: bool,
}

/// Estimated errors of the levels.
pub struct Judgement {
    /// Levels that were run.
    pub candidates: Vec<Candidate>,
    /// Error of the finest line under load, and with the release: the uncertainty of those of the other levels.
    finest_errors: [f64; 2],
    /// Ratio by which the error falls when the cells are doubled.
    ratio: f64,
    /// Whether the errors are known.
    pub is_known: bool,
}

/// Part of the result that finer cells would not change.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Certainty {
    /// Nothing.
    None,
    /// The chosen level.
    Choice,
    /// And its error, within a factor of three.
    ChoiceAndError,
}

impl Judgement {
    /// What finer cells would not change, where errors up to `enough` are admitted.
    pub fn certainty(&self, enough: f64) -> Certainty {
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

impl LevelRuns<'_> {
    /// Contact lines with resolved heat, from coarse to fine.
    pub fn lines(&self) -> impl DoubleEndedIterator<Item = &Level> {
        self.levels.iter().filter(|level| level.model_level.heat() == Some(self.heat))
    }

    /// Expected cost of a line on `cells` cells, with the thermal states and steps of the finest one.
    pub fn cost_of(&self, cells: usize) -> f64 {
        let of = |level: &Level| {
            let states = cost::states(&level.operators);
            cost::build_cost_of(cells, states) + level.run.steps as f64 * cost::per_step_of(cells, states)
        };
        self.lines().next_back().map_or(0.0, of)
    }

    /// Estimates the errors of all levels; `growth` of perturbations over the nominal duration. Errors up to `enough` are admitted.
    ///
    /// # Errors
    /// There is only one contact line.
    pub fn judge(&self, growth: Growth, enough: f64) -> Result<Judgement, String> {
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
            let bounded = match ratio {
                None => ASSUMED_RATIO,
                Some(_) if parted => PARTED_RATIO,
                Some(ratio) => ratio.clamp(least, RATIO.1),
            };
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
        let (agree, approach) = (largest(between) <= enough, ratio.is_some_and(|ratio| ratio >= RATIO.0));
        let converges = match growth {
            Growth::FromRounding => agree && approach,
            Growth::Noticeable => agree || approach,
            Growth::Little => ratio.is_none_or(|ratio| ratio >= CONVERGING.0) || largest(between) <= CONVERGING.1,
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

    /// All levels with their errors, by cost. `cells`: the number set by the user, or 0.
    pub fn candidates(&self, judgement: Judgement, cells: usize) -> Vec<Candidate> {
        let Judgement { mut candidates, ratio, is_known, .. } = judgement;
        match cells {
            0 => {
                self.extrapolate(&mut candidates, ratio, is_known);
                self.interpolate(&mut candidates);
            }
            own => candidates.retain(|candidate| {
                candidate.model_level == ModelLevel::Lumped || candidate.model_level.cells() == own
            }),
        }
        candidates.sort_by(|one, other| one.run_cost.total_cmp(&other.run_cost));
        candidates
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

/// Number of kinds of levels whose steps have errors of their own.
const KINDS: usize = 3;

/// Kind of a level: lumped, a line with lumped heat, one with resolved heat.
pub fn kind(model_level: ModelLevel) -> usize {
    match model_level.heat() {
        None => 0,
        Some(HeatResolution::Lumped) => 1,
        Some(_) => 2,
    }
}
