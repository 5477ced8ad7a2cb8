//! The steady cycle by a Newton-Krylov method with the full derivative of the cycle.
//!
//! The iteration of [`super::solve`] accelerates full steps of an incomplete derivative, without the feedback of the pressure on
//! the heat. Edge cells carry load in one sliding direction only. Where the heat of a long cycle decides which direction, a full
//! step opens and closes too many of them, and differences from one active set are wrong on the next. Here
//!
//! - the derivative is that of the whole cycle, with its feedback and on its own active set: products by differences of cycles,
//!   and GMRES, which requires two to five of them with the incomplete derivative as preconditioner;
//! - a step is halved until the preconditioned residual decreases (the natural monotonicity test; P. Deuflhard, Newton Methods
//!   for Nonlinear Problems, Springer 2004, section 3.3).
//!
//! A cell that opens between two steps of a cycle stops exchanging heat within that step, so that the cycle is a slightly
//! discontinuous function of its start. Where such a jump prevents an exact solution, the iteration ends beside it.
//!
//! Theory: docs/theory.md, section 9.5.

use super::error::CycleError;
use super::map::{CycleMap, Passage};
use super::solve::{Equation, Newton, Solution, SolveOptions};
use crate::line::state::LineState;
use numerics::krylov::gmres;
use numerics::maximum::maximum;

/// Change of the state, in the units of [`CycleMap::weights_of_both`], for the difference quotient: pressures are reproducible to
/// 1e-8.
const DIFFERENCE: f64 = 1e-4;

/// Relative tolerance of the linear solution for a step, and the largest number of products for it.
const EQUATION: f64 = 1e-2;
const MOST_PRODUCTS: usize = 60;

/// Residual at which a discontinuity of the cycle is accepted, as in [`SolveOptions::tolerance`], and number of steps that fail
/// to halve the residual before. The time-stepping errors of a cycle are of this size.
const JUMP: f64 = 1e-4;
const MOST_BESIDE: usize = 4;

/// Iterate of the Newton method.
struct Iterate {
    memory: Vec<f64>,
    /// State of the contact line at the start of the cycle: beyond the cycle state it holds the warm starts of its iterations.
    before: LineState,
}

impl CycleMap {
    /// The steady cycle, iterated from `start`.
    pub(super) fn newton_krylov(&mut self, start: &[f64], options: &SolveOptions) -> Result<Solution, CycleError> {
        let equation = Equation::Steady;
        let tilts = self.operators().rotates;
        let mut residual = [f64::INFINITY; 2];
        let mut best: Option<Solution> = None;
        let mut beside = 0;
        let (mut here, mut cycles) = self.first_iterate(start)?;
        while cycles < options.most_cycles {
            let passage = self.pass_from(&here.before, &here.memory)?;
            cycles += 1;
            let newton = self.newton(&passage, equation)?;
            let step = self.newton_step(&newton, &here.memory, &passage, equation);
            residual = self.sizes(&step, &here.memory, tilts);
            let weights = self.weights_of_both(&here.memory, &step);
            let left = maximum(residual[0], residual[1]);
            let least = best.as_ref().map_or(f64::INFINITY, |best| best.residual[0].max(best.residual[1]));
            beside = if left < 0.5 * least { 0 } else { beside + 1 };
            if left < least {
                best = Some(Solution { memory: here.memory.clone(), passage, cycles, residual });
            }
            // Ratio of the residual to the least one so far at which the iteration has diverged.
            if left.is_nan() || left > 1e4 * least {
                break;
            }
            if left <= options.tolerance || (left.min(least) <= JUMP && beside >= MOST_BESIDE) {
                break;
            }
            let whole = self.whole_step(&here, &newton, &step, &weights, &mut cycles)?;
            match self.part_of(&here, &newton, (&step, &whole), &weights, &mut cycles) {
                Some(next) => here = next,
                None => break,
            }
        }
        match best {
            Some(best) if best.residual[0].max(best.residual[1]) <= options.tolerance.max(JUMP) => {
                Ok(Solution { cycles, ..best })
            }
            _ => Err(CycleError::NotConverged { cycles, shape: residual[0], heat: residual[1] }),
        }
    }

    /// Iterate after one step of the incomplete derivative, which sets the heat, or `start` where no cycle can be computed from
    /// there; and the number of cycles used.
    fn first_iterate(&mut self, start: &[f64]) -> Result<(Iterate, usize), CycleError> {
        let passage = self.pass(start)?;
        let before = self.line.state.clone();
        let newton = self.newton(&passage, Equation::Steady)?;
        let memory = sum(start, 1.0, &self.newton_step(&newton, start, &passage, Equation::Steady));
        Ok(match self.pass(&memory) {
            Ok(_) => (Iterate { memory, before: self.line.state.clone() }, 2),
            Err(_) => (Iterate { memory: start.to_vec(), before }, 2),
        })
    }

    /// Newton step of the full derivative by GMRES; `step` is that of the incomplete one.
    fn whole_step(
        &mut self,
        here: &Iterate,
        newton: &Newton,
        step: &[f64],
        weights: &[f64],
        cycles: &mut usize,
    ) -> Result<Vec<f64>, CycleError> {
        let product = |direction: &[f64]| -> Result<Vec<f64>, CycleError> {
            let moved: Vec<f64> = direction.iter().map(|d| DIFFERENCE * d).collect();
            let there = sum(&here.memory, 1.0, &moved);
            let mut passage = self.pass_from(&here.before, &there)?;
            self.attract(newton, &moved, &mut passage);
            let next = self.newton_step(newton, &there, &passage, Equation::Steady);
            Ok(step.iter().zip(next).map(|(step, next)| (step - next) / DIFFERENCE).collect())
        };
        let solved = gmres(product, step, weights, EQUATION, MOST_PRODUCTS)?;
        *cycles += solved.products;
        Ok(solved.solution)
    }

    /// Damped Newton step: the iterate after the largest part of the step that reduces the residual, or after the part with the
    /// least residual. `None`: no cycle can be computed after any part.
    fn part_of(
        &mut self,
        here: &Iterate,
        newton: &Newton,
        (step, whole): (&[f64], &[f64]),
        weights: &[f64],
        cycles: &mut usize,
    ) -> Option<Iterate> {
        let length = |step: &[f64]| step.iter().zip(weights).map(|(s, w)| s * w * s * w).sum::<f64>().sqrt();
        let before = length(step);
        let mut best: Option<(f64, Iterate)> = None;
        let mut part = 1.0;
        // Shortest damping factor of a step.
        while part >= 1.0 / 64.0 {
            let memory = sum(&here.memory, part, whole);
            *cycles += 1;
            if let Ok(passage) = self.pass_from(&here.before, &memory) {
                let left = length(&self.newton_step(newton, &memory, &passage, Equation::Steady));
                if left.is_finite() && best.as_ref().is_none_or(|(least, _)| left < *least) {
                    best = Some((left, Iterate { memory, before: self.line.state.clone() }));
                }
                if left <= (1.0 - 0.25 * part) * before {
                    break;
                }
            }
            part *= 0.5;
        }
        best.map(|(_, next)| next)
    }

    /// Regularises cells that are not in contact at the end of either half-stroke, whose wear hardly depends on the gap: they
    /// wear with the gap as in the preconditioner, so that the equation stays regular and a step moves them moderately towards
    /// contact.
    fn attract(&self, newton: &Newton, moved: &[f64], passage: &mut Passage) {
        let count = self.operators().count();
        let mut gap = vec![0.0; count];
        self.displacement(&moved[..self.heat_entries()], &mut gap);
        let body = usize::from(!self.operators().reshapes(0));
        for (i, k) in self.worn_ranges()[body].clone().enumerate() {
            if !newton.touching[i] && !newton.touching[i + count] {
                passage.change[k] -= newton.tangent.least() * (gap[i] + moved[k]);
            }
        }
    }

    fn pass_from(&mut self, before: &LineState, memory: &[f64]) -> Result<Passage, CycleError> {
        self.line.state.clone_from(before);
        self.pass(memory)
    }
}

/// The values plus `factor` times the others.
pub(super) fn sum(values: &[f64], factor: f64, others: &[f64]) -> Vec<f64> {
    values.iter().zip(others).map(|(value, other)| value + factor * other).collect()
}
