//! Steady states of the worn contact line, without time integration.
//!
//! A contact is run in when wear no longer changes the pressure: the worn depth then grows like a rigid motion of the
//! punch. That fixes the pressure, and elasticity the shape. To-and-fro sliding has two pressures, one per direction,
//! over one common shape.
//!
//! Theory: docs/theory.md, section 9.

mod box_programme;
mod cycle;
mod reciprocating;
pub mod relative_velocity;
pub mod states;
pub mod thermal;
mod unidirectional;

pub use box_programme::{BoxProgramme, BoxSolution, ProgrammeError};
pub use cycle::{Cycle, CycleProblem};
pub use reciprocating::{Reciprocating, ReciprocatingProblem};
pub use thermal::run_in;
pub use unidirectional::{Unidirectional, groove, groove_operator, punch_run_in};

use contact::ContactError;
use contact::wear::line::StageError;
use std::fmt;

/// Why there is no steady state.
#[derive(Clone, Debug, PartialEq)]
pub enum SteadyError {
    /// A value outside its range.
    Invalid {
        /// What the value stands for.
        quantity: &'static str,
        /// The value found.
        value: f64,
        /// What it has to be.
        requirement: &'static str,
    },
    /// One-way sliding: the resultant `mu H` lies outside the contact.
    Tipping {
        /// Lever mu H of the resultant, in m.
        lever: f64,
        /// The largest that the contact can balance, in m.
        limit: f64,
    },
    /// To-and-fro sliding with a punch free to rotate: it rocks itself round.
    RocksItselfRound {
        /// Lever mu H of the resultant, in m.
        lever: f64,
        /// The lever that no pair of pressures which wear evenly balances, in m; see [`rocking_limit`](contact::wear::rocking::rocking_limit).
        limit: f64,
        /// Pressure exponent b of the wear that it belongs to.
        exponent: f64,
    },
    /// To-and-fro sliding with a general wear law: the iteration found no steady cycle.
    NoCycle {
        /// Lever mu H of the resultant, in m.
        lever: f64,
        /// Half-width of the contact, in m.
        half_width: f64,
        /// Newton iterations tried.
        iterations: usize,
    },
    /// Nothing that could reshape the contact wears, so it does not run in.
    NothingWears,
    /// A run-in punch is asked for, but only the strip wears: the punch keeps its shape.
    OnlyStripWears,
    /// A strip that wears on a straight to-and-fro track: its ends are hardly visited and never run in.
    WearingStripReciprocating,
    /// With heat: nothing takes away what friction gives.
    NoHeatLeaves {
        /// Where heat could leave and does not.
        closed: &'static str,
    },
    /// With heat: temperatures and pressure of one-way sliding that agree were not found.
    NotSettled {
        /// Iterations done.
        iterations: usize,
        /// Last change of the temperature, in K.
        change: f64,
    },
    /// With heat: the bodies, or a cycle of the contact line.
    Heat(String),
    /// The pressure of a stage could not be found.
    Stage(StageError),
    /// The quadratic programme has no solution.
    Programme(ProgrammeError),
}

impl From<StageError> for SteadyError {
    fn from(error: StageError) -> Self {
        Self::Stage(error)
    }
}

impl From<ContactError> for SteadyError {
    fn from(error: ContactError) -> Self {
        Self::Stage(StageError::Contact(error))
    }
}

impl From<ProgrammeError> for SteadyError {
    fn from(error: ProgrammeError) -> Self {
        Self::Programme(error)
    }
}

impl fmt::Display for SteadyError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Invalid { quantity, value, requirement } => {
                write!(f, "{quantity} = {value} is out of range: must be {requirement}")
            }
            Self::Tipping { lever, limit } => {
                write!(f, "no steady state: the punch tips over, mu H = {lever} m is not below {limit} m")
            }
            Self::RocksItselfRound { lever, limit, exponent } => write!(
                f,
                "no steady state: sliding to and fro, the punch rocks itself round, mu H = {lever} m is not below \
                 {limit} m, the limit for wear with the pressure exponent {exponent}"
            ),
            Self::NoCycle { lever, half_width, iterations } => write!(
                f,
                "no steady state found in {iterations} iterations: with mu H = {lever} m on a half-width of \
                 {half_width} m the punch may rock itself round"
            ),
            Self::NothingWears => write!(f, "no run-in state: nothing wears that could reshape the contact"),
            Self::OnlyStripWears => write!(
                f,
                "no run-in shape: only the strip wears, evenly on a closed path or as a groove that stays behind on a \
                 straight one, and the punch keeps its shape"
            ),
            Self::WearingStripReciprocating => write!(
                f,
                "no steady state: the strip wears on a straight to-and-fro track, whose ends are hardly visited"
            ),
            Self::NoHeatLeaves { closed } => write!(f, "no steady state with heat: no heat can leave, since {closed}"),
            Self::NotSettled { iterations, change } => write!(
                f,
                "no steady state with heat found in {iterations} iterations: the last one changed the temperature by \
                 {change:.1e} K"
            ),
            Self::Heat(text) => write!(f, "with heat: {text}"),
            Self::Stage(error) => error.fmt(f),
            Self::Programme(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for SteadyError {}

/// Whether to-and-fro sliding can run in at all, by which bodies wear.
///
/// A strip that wears on a straight track never does: the ends of the track are hardly visited. On a closed path its wear
/// is even along it and reshapes nothing, so the punch has to wear.
pub fn can_run_in_reciprocating(punch_wears: bool, strip_wears: bool, closed_path: bool) -> Result<(), SteadyError> {
    if strip_wears && !closed_path {
        return Err(SteadyError::WearingStripReciprocating);
    }
    if punch_wears { Ok(()) } else { Err(SteadyError::NothingWears) }
}

/// A value that must be finite and positive.
fn positive(quantity: &'static str, value: f64) -> Result<(), SteadyError> {
    if value.is_finite() && value > 0.0 {
        return Ok(());
    }
    Err(SteadyError::Invalid { quantity, value, requirement: "finite and positive" })
}

/// A value that must be finite and not negative.
fn not_negative(quantity: &'static str, value: f64) -> Result<(), SteadyError> {
    if value.is_finite() && value >= 0.0 {
        return Ok(());
    }
    Err(SteadyError::Invalid { quantity, value, requirement: "finite and not negative" })
}
