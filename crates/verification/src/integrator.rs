//! Time integration of the worn shape.
//!
//! Theory: docs/theory.md, section 5.2.

use contact::wear::line::{CellRate, Conditions, StageError, WearingContact, explicit_limit};
use contact::{ContactState, Normal, Tilt};
use numerics::sdirk::GAMMA;
use std::fmt;

/// Time stepping scheme.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scheme {
    /// Singly diagonally implicit Runge-Kutta method of two stages, gamma = 1 - 1/sqrt 2: second order, L-stable,
    /// stiffly accurate. The embedded solution with the weights (1/2, 1/2) estimates the error.
    Sdirk2,
    /// Implicit Euler: first order, L-stable.
    ImplicitEuler,
    /// Explicit Euler, for comparison: an error beyond its stability bound.
    ExplicitEuler,
}

/// Reason why a step failed.
#[derive(Clone, Debug, PartialEq)]
pub enum StepError {
    /// A stage has no solution.
    Stage(StageError),
    /// An explicit step beyond the stability bound.
    Unstable {
        /// The requested step.
        step: f64,
        /// The longest stable step.
        limit: f64,
    },
    /// The error control needs steps below rounding of the time.
    StepTooShort {
        /// Time reached.
        time: f64,
        /// Rejected step.
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

/// Work of an integration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Report {
    /// Steps accepted.
    pub steps: usize,
    /// Steps rejected and repeated shorter.
    pub rejected: usize,
}

/// Callback that overwrites the conditions with those of a time.
pub type ConditionsAt<'a> = &'a mut dyn FnMut(f64, &mut Conditions);

/// Integrator of the worn depths `dw/dt = f(p(w, t))`, N cells.
///
/// Conditions are evaluated at the stage times, so load and speed may vary within a step; the direction must not change
/// within one: a step ends at every reversal. They are written into the integrator's memory, which is the same at every
/// call, so that unchanged entries need not be written again. No allocation after construction, except for the stability
/// bound of explicit steps.
#[derive(Clone, Debug)]
pub struct Integrator {
    /// The scheme.
    pub scheme: Scheme,
    /// Tolerance of the error of one step, relative to the elastic displacement scale; see [`Integrator::advance`].
    pub tolerance: f64,
    /// Step size proposed for the next call of [`Integrator::advance`], in s; 0: none yet.
    pub next_step: f64,
    conditions: Conditions,
    error: Vec<f64>,
    base: Vec<f64>,
    before: Vec<f64>,
    gap: Vec<f64>,
}

impl Integrator {
    /// Integrator for N cells with a tolerance for adaptive steps.
    pub fn new(scheme: Scheme, tolerance: f64, count: usize) -> Self {
        let conditions = Conditions {
            signed_friction: 0.0,
            normal: Normal::Load(0.0),
            tilt: Tilt::Fixed(0.0),
            rate: CellRate { reference_pressure: 1.0, terms: Vec::with_capacity(2) },
        };
        let zeros = vec![0.0; count];
        Self {
            scheme,
            tolerance,
            next_step: 0.0,
            conditions,
            error: zeros.clone(),
            base: zeros.clone(),
            before: zeros.clone(),
            gap: zeros,
        }
    }

    /// Error estimate of the worn depth in the last step: N values, m; zero for the first-order schemes.
    pub fn error(&self) -> &[f64] {
        &self.error
    }

    /// One step of the given length from `time`, in place; `state` is that at its end.
    ///
    /// On an error `worn` is unchanged and the state unspecified.
    pub fn step(
        &mut self,
        contact: &mut WearingContact,
        worn: &mut [f64],
        time: f64,
        step: f64,
        conditions: ConditionsAt<'_>,
        state: &mut ContactState,
    ) -> Result<(), StepError> {
        match self.scheme {
            Scheme::Sdirk2 => {
                conditions(time + GAMMA * step, &mut self.conditions);
                self.stage(contact, worn, GAMMA * step, state)?;
                for i in 0..worn.len() {
                    let rate = self.conditions.rate.rate(i, state.pressure[i]);
                    self.base[i] = worn[i] + (1.0 - GAMMA) * step * rate;
                    self.error[i] = rate;
                }
                conditions(time + step, &mut self.conditions);
                let base = std::mem::take(&mut self.base);
                let outcome = self.stage(contact, &base, GAMMA * step, state);
                self.base = base;
                outcome?;
                for i in 0..worn.len() {
                    let rate = self.conditions.rate.rate(i, state.pressure[i]);
                    self.error[i] = (0.5 - GAMMA) * step * (self.error[i] - rate);
                    worn[i] = self.base[i] + GAMMA * step * rate;
                }
            }
            Scheme::ImplicitEuler => {
                conditions(time + step, &mut self.conditions);
                self.stage(contact, worn, step, state)?;
                for (i, w) in worn.iter_mut().enumerate() {
                    *w += step * self.conditions.rate.rate(i, state.pressure[i]);
                }
                self.error.fill(0.0);
            }
            Scheme::ExplicitEuler => {
                conditions(time, &mut self.conditions);
                self.stage(contact, worn, 0.0, state)?;
                let limit = explicit_limit(contact, &self.conditions, &state.pressure);
                if step >= limit {
                    return Err(StepError::Unstable { step, limit });
                }
                for (i, w) in worn.iter().enumerate() {
                    self.base[i] = w + step * self.conditions.rate.rate(i, state.pressure[i]);
                }
                conditions(time + step, &mut self.conditions);
                let base = std::mem::take(&mut self.base);
                let outcome = self.stage(contact, &base, 0.0, state);
                self.base = base;
                outcome?;
                worn.copy_from_slice(&self.base);
                self.error.fill(0.0);
            }
        }
        Ok(())
    }

    /// A stage under the present conditions from the worn depth.
    fn stage(
        &mut self,
        contact: &mut WearingContact,
        worn: &[f64],
        tau: f64,
        state: &mut ContactState,
    ) -> Result<(), StageError> {
        for ((gap, initial), worn) in self.gap.iter_mut().zip(contact.initial_gap()).zip(worn) {
            *gap = initial + worn;
        }
        contact.stage_into(&self.gap, tau, &self.conditions, state)
    }

    /// Advances by `duration` with steps chosen by the embedded error estimate (the second-order scheme only; the others
    /// take one step).
    ///
    /// The estimate is first order, so its root mean square over the zone is of the size of the step's curvature
    /// `h^2 w''/5`. It is held below `tolerance` times the elastic scale of the shape, the displacement of the cells under a
    /// pressure that varies linearly across the zone by the mean pressure. The solution itself is second order: its error is
    /// proportional to the tolerance. Step sizes are the duration divided by powers of two, so that a factorisation serves
    /// many steps.
    pub fn advance(
        &mut self,
        contact: &mut WearingContact,
        worn: &mut [f64],
        time: f64,
        duration: f64,
        conditions: ConditionsAt<'_>,
        state: &mut ContactState,
    ) -> Result<Report, StepError> {
        if self.scheme != Scheme::Sdirk2 {
            self.step(contact, worn, time, duration, conditions, state)?;
            return Ok(Report { steps: 1, rejected: 0 });
        }
        conditions(time, &mut self.conditions);
        let bound = self.tolerance * self.displacement_scale(contact, worn, state)?;
        let width: f64 = contact.cells().widths().iter().sum();
        let (mut done, mut rejected, mut steps) = (0u64, 0, 0);
        let mut level = self.starting_level(duration);
        loop {
            let step = duration / (1u64 << level) as f64;
            let ticks = 1u64 << (DEEPEST - level);
            self.before.copy_from_slice(worn);
            let now = time + duration * (done as f64 / (1u64 << DEEPEST) as f64);
            let error = match self.step(contact, worn, now, step, conditions, state) {
                Ok(()) => {
                    let square: f64 = self.error.iter().zip(contact.cells().widths()).map(|(e, c)| e * e * c).sum();
                    (square / width).sqrt()
                }
                Err(StepError::Stage(StageError::NotConverged { .. })) => f64::INFINITY,
                Err(failure) => return Err(failure),
            };
            if error.is_nan() || error > bound {
                worn.copy_from_slice(&self.before);
                rejected += 1;
                if level == DEEPEST {
                    return Err(StepError::StepTooShort { time: now, step });
                }
                // Error ~ h^2: at least one halving.
                let halvings = if error.is_finite() { (0.5 * (error / bound).log2()).ceil().max(1.0) } else { 2.0 };
                level = (level + halvings as u32).min(DEEPEST);
                continue;
            }
            steps += 1;
            done += ticks;
            if done == 1 << DEEPEST {
                self.next_step = step;
                return Ok(Report { steps, rejected });
            }
            // The step is doubled where it fits the binary grid and the estimate, which quadruples, leaves a margin.
            while level > 0 && error * 4.0 < 0.7 * bound && done.is_multiple_of(1 << (DEEPEST - level + 1)) {
                level -= 1;
                if error * 16.0 > 0.7 * bound {
                    break;
                }
            }
        }
    }

    /// Root mean square displacement of the cells under a pressure `p_m x/a` (one cell: under p_m).
    fn displacement_scale(
        &mut self,
        contact: &mut WearingContact,
        worn: &[f64],
        state: &mut ContactState,
    ) -> Result<f64, StepError> {
        self.stage(contact, worn, 0.0, state)?;
        let cells = contact.cells();
        let (count, half_width) = (cells.count(), cells.half_width());
        let mean = cells.integral(&state.pressure) / (2.0 * half_width);
        for (value, x) in self.base.iter_mut().zip(cells.centres()) {
            *value = if count == 1 { mean } else { mean * x / half_width };
        }
        self.error.fill(0.0);
        contact.add_displacement(self.conditions.signed_friction, &self.base, &mut self.error);
        let square: f64 = self.error.iter().zip(contact.cells().widths()).map(|(u, c)| u * u * c).sum();
        let scale = (square / (2.0 * half_width)).sqrt();
        // Nothing wears out of contact, so any positive scale is valid.
        Ok(if scale > 0.0 { scale } else { f64::INFINITY })
    }

    fn starting_level(&self, duration: f64) -> u32 {
        if self.next_step <= 0.0 {
            return 10;
        }
        (duration / self.next_step).log2().ceil().clamp(0.0, f64::from(DEEPEST)) as u32
    }
}

/// Exponent of the finest step: the duration over two to this power.
const DEEPEST: u32 = 40;
