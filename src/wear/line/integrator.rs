//! Time stepping of the worn shape.

use super::{Conditions, StageError, WearingContact, explicit_limit};
use crate::contact::ContactState;
use std::f64::consts::SQRT_2;
use std::fmt;

/// Time stepping scheme.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scheme {
    /// Singly diagonally implicit Runge-Kutta method of two stages, gamma = 1 - 1/sqrt 2: second order, L-stable,
    /// stiffly accurate. The embedded solution with the weights (1/2, 1/2) estimates the error.
    Sdirk2,
    /// Implicit Euler: first order, L-stable.
    ImplicitEuler,
    /// Explicit Euler, for comparison: refused beyond its stability bound.
    ExplicitEuler,
}

/// Why a step was not done.
#[derive(Clone, Debug, PartialEq)]
pub enum StepError {
    /// A stage has no solution.
    Stage(StageError),
    /// An explicit step beyond the stability bound.
    Unstable {
        /// The step asked for.
        step: f64,
        /// The longest stable one.
        limit: f64,
    },
    /// The error control needs steps shorter than rounding allows.
    StepTooShort {
        /// Time reached.
        time: f64,
        /// Step refused.
        step: f64,
    },
}

impl From<StageError> for StepError {
    fn from(error: StageError) -> Self {
        Self::Stage(error)
    }
}

impl fmt::Display for StepError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Stage(error) => error.fmt(f),
            Self::Unstable { step, limit } => {
                write!(f, "explicit wear step {step:e} s is beyond the stability bound of {limit:e} s")
            }
            Self::StepTooShort { time, step } => write!(f, "wear step control failed at {time} s with step {step:e} s"),
        }
    }
}

impl std::error::Error for StepError {}

/// What an integration took.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    /// Pressure, gap, approach and tilt at the end.
    pub state: ContactState,
    /// Steps accepted.
    pub steps: usize,
    /// Steps rejected and repeated shorter.
    pub rejected: usize,
}

const GAMMA: f64 = 1.0 - 0.5 * SQRT_2;

/// Integrator of the worn depths `dw/dt = f(p(w, t))`, N cells.
///
/// Conditions are asked for at the times of the stages, so load and speed may vary within a step; the direction must
/// not change within one: end a step at every reversal.
#[derive(Clone, Debug)]
pub struct Integrator {
    /// The scheme.
    pub scheme: Scheme,
    /// Bound of the error of one step, relative to the elastic displacement scale; see [`Integrator::advance`].
    pub tolerance: f64,
    /// Step proposed for the next call of [`Integrator::advance`], in s; 0: none yet.
    pub next_step: f64,
}

impl Integrator {
    /// Integrator with a tolerance for adaptive steps.
    pub fn new(scheme: Scheme, tolerance: f64) -> Self {
        Self { scheme, tolerance, next_step: 0.0 }
    }

    /// One step of the given length from `time`, in place. Returns the state at its end and the error estimate of the
    /// worn depth (N values, m; zero for the first-order schemes).
    ///
    /// On an error `worn` is unchanged.
    pub fn step(
        &self,
        contact: &mut WearingContact,
        worn: &mut [f64],
        time: f64,
        step: f64,
        conditions: &dyn Fn(f64) -> Conditions,
    ) -> Result<(ContactState, Vec<f64>), StepError> {
        let count = worn.len();
        let rates = |c: &Conditions, p: &[f64]| -> Vec<f64> { (0..count).map(|i| c.rate.rate(i, p[i])).collect() };
        match self.scheme {
            Scheme::Sdirk2 => {
                let at_first = conditions(time + GAMMA * step);
                let first = contact.stage(worn, GAMMA * step, &at_first)?;
                let k1 = rates(&at_first, &first.pressure);
                let base: Vec<f64> = (0..count).map(|i| worn[i] + (1.0 - GAMMA) * step * k1[i]).collect();
                let at_end = conditions(time + step);
                let state = contact.stage(&base, GAMMA * step, &at_end)?;
                let k2 = rates(&at_end, &state.pressure);
                let error = (0..count).map(|i| (0.5 - GAMMA) * step * (k1[i] - k2[i])).collect();
                for i in 0..count {
                    worn[i] = base[i] + GAMMA * step * k2[i];
                }
                Ok((state, error))
            }
            Scheme::ImplicitEuler => {
                let at_end = conditions(time + step);
                let state = contact.stage(worn, step, &at_end)?;
                for (w, k) in worn.iter_mut().zip(rates(&at_end, &state.pressure)) {
                    *w += step * k;
                }
                Ok((state, vec![0.0; count]))
            }
            Scheme::ExplicitEuler => {
                let at_start = conditions(time);
                let start = contact.pressure(worn, &at_start)?;
                let limit = explicit_limit(contact, &at_start, &start.pressure);
                if step >= limit {
                    return Err(StepError::Unstable { step, limit });
                }
                let mut next = worn.to_vec();
                for (w, k) in next.iter_mut().zip(rates(&at_start, &start.pressure)) {
                    *w += step * k;
                }
                let state = contact.pressure(&next, &conditions(time + step))?;
                worn.copy_from_slice(&next);
                Ok((state, vec![0.0; count]))
            }
        }
    }

    /// Advances by `duration` with steps chosen by the embedded error estimate (the second-order scheme only; the
    /// others take one step).
    ///
    /// The estimate is first order, so its root mean square over the zone is of the size of the step's curvature
    /// `h^2 w''/5`; it is held below `tolerance` times the displacement of the cells under a pressure that varies linearly
    /// across the zone by the mean pressure, the elastic scale of the shape. The solution itself is second order: its
    /// error falls in proportion to the tolerance. Step lengths are the duration divided by powers of two, so that a
    /// factorisation serves many steps.
    pub fn advance(
        &mut self,
        contact: &mut WearingContact,
        worn: &mut [f64],
        time: f64,
        duration: f64,
        conditions: &dyn Fn(f64) -> Conditions,
    ) -> Result<Report, StepError> {
        if self.scheme != Scheme::Sdirk2 {
            let (state, _) = self.step(contact, worn, time, duration, conditions)?;
            return Ok(Report { state, steps: 1, rejected: 0 });
        }
        let scale = displacement_scale(contact, worn, &conditions(time))?;
        let width: f64 = contact.cells().widths().iter().sum();
        let (mut done, mut rejected, mut steps) = (0u64, 0, 0);
        let mut level = self.starting_level(duration);
        loop {
            let step = duration / (1u64 << level) as f64;
            let ticks = 1u64 << (DEEPEST - level);
            let before = worn.to_vec();
            let now = time + duration * (done as f64 / (1u64 << DEEPEST) as f64);
            let outcome = self.step(contact, worn, now, step, conditions);
            let error = match &outcome {
                Ok((_, error)) => {
                    (contact.cells().integral(&error.iter().map(|e| e * e).collect::<Vec<_>>()) / width).sqrt()
                }
                Err(StepError::Stage(StageError::NotConverged { .. })) => f64::INFINITY,
                Err(failure) => return Err(failure.clone()),
            };
            let bound = self.tolerance * scale;
            if error > bound {
                worn.copy_from_slice(&before);
                rejected += 1;
                if level == DEEPEST {
                    return Err(StepError::StepTooShort { time: now, step });
                }
                // Error ~ h^2: at least one halving.
                let halvings = if error.is_finite() { (0.5 * (error / bound).log2()).ceil().max(1.0) } else { 2.0 };
                level = (level + halvings as u32).min(DEEPEST);
                continue;
            }
            let (state, _) = outcome?;
            steps += 1;
            done += ticks;
            if done == 1 << DEEPEST {
                self.next_step = step;
                return Ok(Report { state, steps, rejected });
            }
            // Twice the step where it fits the binary grid and the estimate, four times this one, leaves a margin.
            while level > 0 && error * 4.0 < 0.7 * bound && done.is_multiple_of(1 << (DEEPEST - level + 1)) {
                level -= 1;
                if error * 16.0 > 0.7 * bound {
                    break;
                }
            }
        }
    }

    fn starting_level(&self, duration: f64) -> u32 {
        if self.next_step <= 0.0 {
            return 10;
        }
        (duration / self.next_step).log2().ceil().clamp(0.0, f64::from(DEEPEST)) as u32
    }
}

/// Finest step: the duration over two to this power.
const DEEPEST: u32 = 40;

/// Root mean square displacement of the cells under a pressure `p_m x/a` (one cell: under p_m).
fn displacement_scale(contact: &mut WearingContact, worn: &[f64], conditions: &Conditions) -> Result<f64, StepError> {
    let state = contact.pressure(worn, conditions)?;
    let cells = contact.cells();
    let width = 2.0 * cells.half_width();
    let mean = cells.integral(&state.pressure) / width;
    let compliance = contact.compliance(conditions.direction);
    let profile = nalgebra::DVector::from_fn(cells.count(), |i, _| match cells.count() {
        1 => mean,
        _ => mean * cells.centres()[i] / cells.half_width(),
    });
    let displacement = compliance * profile;
    let square: Vec<f64> = displacement.iter().map(|u| u * u).collect();
    let scale = (cells.integral(&square) / width).sqrt();
    // Out of contact nothing wears, and any positive scale will do.
    Ok(if scale > 0.0 { scale } else { f64::INFINITY })
}
