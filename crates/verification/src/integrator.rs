//! Steps of the worn shape of a given length by two methods, to compare them. The component chooses its steps itself
//! (`model::line`).
//!
//! Theory: docs/theory.md, section 5.2.

use contact::wear::line::{CellRate, Conditions, StageError, WearingContact};
use contact::{ContactState, Normal, Tilt};
use numerics::sdirk::GAMMA;

/// Time stepping scheme.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scheme {
    /// Singly diagonally implicit Runge-Kutta method of two stages, gamma = 1 - 1/sqrt 2: second order, L-stable,
    /// stiffly accurate.
    Sdirk2,
    /// Implicit Euler: first order, L-stable.
    ImplicitEuler,
}

/// Callback that overwrites the conditions with those of a time.
type ConditionsAt<'a> = &'a mut dyn FnMut(f64, &mut Conditions);

/// Integrator of the worn depths `dw/dt = f(p(w, t))`, N cells.
///
/// Conditions are evaluated at the stage times, so load and speed may vary within a step; the direction must not change
/// within one: a step ends at every reversal. They are written into the integrator's memory, which is the same at every
/// call, so that unchanged entries need not be written again. No allocation after construction.
#[derive(Clone, Debug)]
pub struct Integrator {
    /// The scheme.
    pub scheme: Scheme,
    conditions: Conditions,
    base: Vec<f64>,
    gap: Vec<f64>,
}

impl Integrator {
    /// Integrator for N cells.
    pub fn new(scheme: Scheme, count: usize) -> Self {
        let conditions = Conditions {
            signed_friction: 0.0,
            normal: Normal::Load(0.0),
            tilt: Tilt::Fixed(0.0),
            rate: CellRate { reference_pressure: 1.0, terms: Vec::with_capacity(2) },
        };
        let zeros = vec![0.0; count];
        Self { scheme, conditions, base: zeros.clone(), gap: zeros }
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
    ) -> Result<(), StageError> {
        match self.scheme {
            Scheme::Sdirk2 => {
                conditions(time + GAMMA * step, &mut self.conditions);
                self.stage(contact, worn, GAMMA * step, state)?;
                for i in 0..worn.len() {
                    let rate = self.conditions.rate.rate(i, state.pressure[i]);
                    self.base[i] = worn[i] + (1.0 - GAMMA) * step * rate;
                }
                conditions(time + step, &mut self.conditions);
                let base = std::mem::take(&mut self.base);
                let outcome = self.stage(contact, &base, GAMMA * step, state);
                self.base = base;
                outcome?;
                for i in 0..worn.len() {
                    let rate = self.conditions.rate.rate(i, state.pressure[i]);
                    worn[i] = self.base[i] + GAMMA * step * rate;
                }
            }
            Scheme::ImplicitEuler => {
                conditions(time + step, &mut self.conditions);
                self.stage(contact, worn, step, state)?;
                for (i, w) in worn.iter_mut().enumerate() {
                    *w += step * self.conditions.rate.rate(i, state.pressure[i]);
                }
            }
        }
        Ok(())
    }

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
}
