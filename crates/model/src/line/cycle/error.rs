//! Reasons why a cycle cannot be computed.
//!
//! Theory: docs/theory.md, section 9.5.

use crate::StepFailure;
use std::fmt;

/// Reason for which a cycle cannot be computed.
#[derive(Clone, PartialEq, Debug)]
pub enum CycleError {
    /// The scene has a property that cycles do not support.
    Unsuitable(String),
    /// A step of the cycle failed.
    Step(StepFailure),
    /// The iteration did not converge.
    NotConverged {
        /// Cycles computed.
        cycles: usize,
        /// Change of the shape in the last iteration over the elastic displacement under the mean pressure.
        shape: f64,
        /// Change of the heat in the last iteration over the heat.
        heat: f64,
    },
    /// The iteration did not converge, and the contact slides close to its critical speed or above, where hot spots grow.
    Unstable {
        /// Mean sliding speed, m/s.
        speed: f64,
        /// Critical speed of thermoelastic instability, m/s.
        critical_speed: f64,
        /// Error at the end of the iteration.
        reason: Box<CycleError>,
    },
}

impl fmt::Display for CycleError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unsuitable(text) => f.write_str(text),
            Self::Step(failure) => failure.fmt(f),
            Self::NotConverged { cycles, shape, heat } => write!(
                f,
                "no steady cycle found in {cycles} cycles: the last one changed the shape by {shape:.1e} of the elastic \
                 displacement and the heat by {heat:.1e} of itself"
            ),
            Self::Unstable { speed, critical_speed, reason } => {
                let ratio = speed / critical_speed;
                let growth = if ratio > 1.0 { ", and hot spots grow within a half-stroke" } else { "" };
                write!(
                    f,
                    "{reason}; the speed {speed:.4} m/s is {ratio:.2} of the critical speed of thermoelastic instability, \
                     {critical_speed:.4} m/s{growth}"
                )
            }
        }
    }
}

impl std::error::Error for CycleError {}

impl From<StepFailure> for CycleError {
    fn from(failure: StepFailure) -> Self {
        Self::Step(failure)
    }
}
