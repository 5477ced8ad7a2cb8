//! Validated balance equations of a contact problem, and the problems with zero pressure.
//!
//! Theory: docs/theory.md, section 2.5.

use super::{ContactProblem, ContactSolver};
use crate::problem::{ContactError, ContactState, Normal, Tilt};

/// Load and moment balance: free unknowns and the right-hand sides of their rows.
#[derive(Clone, Copy, Default, Debug)]
pub(super) struct Balance {
    pub approach_free: bool,
    pub tilt_free: bool,
    /// Prescribed approach and tilt; 0 where free.
    pub approach: f64,
    pub tilt: f64,
    pub load: f64,
    pub stiffness: f64,
    pub lever: f64,
    pub moment: f64,
}

impl Balance {
    #[inline]
    pub(crate) fn count(&self) -> usize {
        usize::from(self.approach_free) + usize::from(self.tilt_free)
    }
}

fn finite(quantity: &'static str, value: f64) -> Result<f64, ContactError> {
    if value.is_finite() { Ok(value) } else { Err(ContactError::Invalid { quantity, value }) }
}

impl ContactSolver {
    pub(super) fn balance(&self, problem: &ContactProblem<'_>) -> Result<Balance, ContactError> {
        for &value in problem.gap {
            finite("initial gap", value)?;
        }
        finite("signed friction coefficient", problem.signed_friction)?;
        for &value in problem.diagonal {
            if finite("wear per pressure", value)? < 0.0 {
                return Err(ContactError::Invalid { quantity: "wear per pressure", value });
            }
        }
        let mut balance = Balance { approach_free: true, ..Balance::default() };
        match problem.normal {
            Normal::Load(value) => {
                if finite("load", value)? < 0.0 {
                    return Err(ContactError::Invalid { quantity: "load", value });
                }
                balance.load = value;
            }
            Normal::Approach(value) => {
                balance.approach_free = false;
                balance.approach = finite("approach", value)?;
            }
            Normal::Spring { load, stiffness } => {
                balance.load = finite("load", load)?;
                if finite("holder stiffness", stiffness)? < 0.0 {
                    return Err(ContactError::Invalid { quantity: "holder stiffness", value: stiffness });
                }
                balance.stiffness = stiffness;
            }
        }
        match problem.tilt {
            Tilt::Fixed(value) => balance.tilt = finite("tilt", value)?,
            Tilt::ResultantAt(value) => {
                let limit = self.positions[self.positions.len() - 1];
                balance.tilt_free = true;
                balance.lever = finite("lever", value)?;
                if value.abs() >= limit {
                    return Err(ContactError::Tipping { lever: value, limit });
                }
            }
            Tilt::Moment { lever, moment } => {
                balance.tilt_free = true;
                balance.lever = finite("lever", lever)?;
                balance.moment = finite("moment", moment)?;
            }
        }
        Ok(balance)
    }

    /// Whether the load or the spring leaves no pressure, and the state in that case: without load the punch stands at first
    /// contact, a spring is relaxed. A free tilt is then undefined and taken as 0.
    pub(super) fn apart(&self, problem: &ContactProblem<'_>, state: &mut ContactState) -> bool {
        let tilt = match problem.tilt {
            Tilt::Fixed(value) => value,
            Tilt::ResultantAt(_) | Tilt::Moment { .. } => 0.0,
        };
        let distance = |i: usize| problem.gap[i] - tilt * self.positions[i];
        let touching = || (0..self.positions.len()).map(distance).fold(f64::INFINITY, f64::min);
        let approach = match problem.normal {
            Normal::Load(0.0) => touching(),
            Normal::Spring { load, stiffness } if load <= stiffness * touching() => {
                if stiffness > 0.0 {
                    load / stiffness
                } else {
                    touching()
                }
            }
            _ => return false,
        };
        for i in 0..self.positions.len() {
            state.pressure[i] = 0.0;
            state.gap[i] = distance(i) - approach;
        }
        (state.approach, state.tilt) = (approach, tilt);
        true
    }
}
