//! Propagation weights and influence matrices of one step.
//!
//! Theory: docs/theory.md, sections 5.3, 4.1.

pub mod stage;

pub use super::interval::{OWN, Workspace};
pub use stage::StageWeights;

use super::operators::StripOperators;
use super::steady::SteadySteps;
use crate::line::{GAMMA, Stage, SurfaceInfluence, cache_capacity};
use nalgebra::DMatrix;
use numerics::dense;

/// Relative change of the velocity over a step up to which the direct feedthrough is linear in time.
const LINEAR: f64 = 0.1;

/// The prepared step.
#[derive(Clone, Debug)]
pub struct Step {
    /// Length, s, and velocities, m/s; not a number before the first step.
    pub length: f64,
    pub velocity: [f64; 2],
    /// One implicit Euler step.
    euler: bool,
    pub first: StageWeights,
    pub end: StageWeights,
    /// Index of the cached responses after the first.
    steady: SteadySteps,
    workspace: Workspace,
    immediate: DirectFeedthrough,
}

/// A velocity rounded in the last twelve bits of its significand: the end of one step and the start of the next differ
/// by rounding.
fn rounded(velocity: f64) -> f64 {
    f64::from_bits((velocity.to_bits() + 0x800) & !0xfff)
}

/// Direct feedthrough on the cells at the velocities last used: the end of a step is the start of the next.
#[derive(Clone, Debug)]
struct DirectFeedthrough {
    known: [(f64, u64, [DMatrix<f64>; 2]); 3],
    clock: u64,
}

impl DirectFeedthrough {
    fn new(operators: &StripOperators) -> DirectFeedthrough {
        let count = operators.widths.len();
        let moving = if operators.expands { count } else { 0 };
        let matrices = || (f64::NAN, 0, [DMatrix::zeros(count, count), DMatrix::zeros(moving, moving)]);
        DirectFeedthrough { known: [matrices(), matrices(), matrices()], clock: 0 }
    }

    /// Cache slot of the influence matrices at a velocity.
    fn find(&mut self, operators: &StripOperators, velocity: f64) -> usize {
        let velocity = rounded(velocity);
        self.clock += 1;
        let found = self.known.iter().position(|known| known.0 == velocity);
        let place = found.unwrap_or_else(|| (0..3).min_by_key(|&place| self.known[place].1).unwrap_or(0));
        let (of, used, matrices) = &mut self.known[place];
        *used = self.clock;
        if found.is_none() {
            *of = velocity;
            for (moving, matrix) in matrices.iter_mut().enumerate() {
                if matrix.ncols() == 0 {
                    continue;
                }
                operators.table.respond(moving, velocity, matrix);
            }
        }
        place
    }

    /// Influence matrices in a cache slot.
    fn at(&self, place: usize) -> &[DMatrix<f64>; 2] {
        &self.known[place].2
    }
}

/// Adds a multiple of the direct feedthrough to the influence matrices.
fn add([warm, moved]: &[DMatrix<f64>; 2], part: f64, influence: &mut SurfaceInfluence) {
    for (matrix, gain) in [(warm, &mut influence.temperature), (moved, &mut influence.distortion)] {
        if !matrix.is_empty() {
            dense::multiply_add(matrix.as_slice(), &[part], gain.as_mut_slice());
        }
    }
}

/// Velocities from the start of a step to its first stage.
fn to_first_stage([from, to]: [f64; 2]) -> [f64; 2] {
    [from, from + GAMMA * (to - from)]
}

impl Step {
    pub fn new(operators: &StripOperators) -> Step {
        let cached = cache_capacity(operators.widths.len());
        Step {
            length: f64::NAN,
            velocity: [f64::NAN; 2],
            euler: false,
            first: StageWeights::new(operators, false, cached),
            end: StageWeights::new(operators, true, cached),
            steady: SteadySteps::new(cached),
            workspace: Workspace::new(operators),
            immediate: DirectFeedthrough::new(operators),
        }
    }

    pub fn stage(&self, stage: Stage) -> &StageWeights {
        match stage {
            Stage::First => &self.first,
            Stage::End => &self.end,
        }
    }

    pub fn prepare(&mut self, operators: &StripOperators, length: f64, velocity: [f64; 2]) {
        if self.length == length && self.velocity == velocity && !self.euler {
            return;
        }
        (self.length, self.velocity, self.euler) = (length, velocity, false);
        let (place, known) = self.steady.take(length, velocity);
        (self.first.current, self.end.current) = (place, place);
        if known {
            self.first.resume(operators, GAMMA * length, to_first_stage(velocity));
            self.end.resume(operators, length, velocity);
        } else {
            self.find(operators, length, velocity);
        }
    }

    /// Computes the responses of both stages.
    fn find(&mut self, operators: &StripOperators, length: f64, velocity: [f64; 2]) {
        let [_, middle] = to_first_stage(velocity);
        let Step { first, end, workspace, immediate, .. } = self;
        let last = immediate.find(operators, velocity[1]);
        let straight = (velocity[1] - velocity[0]).abs() <= LINEAR * operators.table.scale().hypot(middle);
        if straight && velocity[0] != velocity[1] {
            let start = immediate.find(operators, velocity[0]);
            let both = [(immediate.at(start), 1.0 - GAMMA), (immediate.at(last), GAMMA)];
            first.prepare(operators, GAMMA * length, [velocity[0], middle], &both, workspace);
        } else {
            let between = immediate.find(operators, middle);
            let one = [(immediate.at(between), 1.0)];
            first.prepare(operators, GAMMA * length, [velocity[0], middle], &one, workspace);
        }
        end.prepare(operators, length, velocity, &[(immediate.at(last), 1.0)], workspace);
    }

    /// Prepares one implicit Euler step: both stages are its end.
    pub fn prepare_euler(&mut self, operators: &StripOperators, length: f64, velocity: [f64; 2]) {
        if self.length == length && self.velocity == velocity && self.euler {
            return;
        }
        (self.length, self.velocity, self.euler) = (length, velocity, true);
        (self.first.current, self.end.current) = (0, 0);
        for stage in [&mut self.first, &mut self.end] {
            stage.prepare_euler(operators, length, velocity, &mut self.workspace);
        }
        let end = self.immediate.find(operators, velocity[1]);
        for stage in [&mut self.first, &mut self.end] {
            add(self.immediate.at(end), 1.0, &mut stage.responses[0].influence);
        }
    }
}
