//! Steady states of the worn contact line, without time integration.
//!
//! A contact is run in when wear no longer changes the pressure: the worn depth then grows as a rigid motion of the punch. This
//! determines the pressure, and elasticity the shape. Reciprocating sliding has two pressures, one per direction, over one common
//! shape.
//!
//! Theory: docs/theory.md, section 9.

#![forbid(unsafe_code)]

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
pub(crate) use unidirectional::groove_operator;
pub use unidirectional::{Unidirectional, groove, punch_run_in};

use contact::ContactError;
use contact::wear::line::StageError;
use std::fmt;

/// Reason for which there is no steady state.
#[derive(Clone, Debug, PartialEq)]
pub enum SteadyError {
    /// A value outside its range.
    Invalid {
        /// Name of the quantity.
        quantity: &'static str,
        /// Its value.
        value: f64,
        /// Required range.
        requirement: &'static str,
    },
    /// Reciprocating sliding with a punch free to rotate: wear rounds the contact and increases the tilt without bound.
    RocksItselfRound {
        /// Lever mu H of the resultant, in m.
        lever: f64,
        /// Lever in m above which no pair of pressures with uniform wear is in equilibrium; see
        /// [`contact::wear::rocking::rocking_limit`].
        limit: f64,
        /// Pressure exponent b of the wear law of this limit.
        exponent: f64,
    },
    /// Reciprocating sliding with a general wear law: the iteration found no steady cycle.
    NoCycle {
        /// Lever mu H of the resultant, in m.
        lever: f64,
        /// Half-width of the contact, in m.
        half_width: f64,
        /// Newton iterations tried.
        iterations: usize,
    },
    /// No wear reshapes the contact, so it does not run in.
    NothingWears,
    /// A run-in punch is requested, but only the strip wears: the punch keeps its shape.
    OnlyStripWears,
    /// A strip that wears on a straight reciprocating track: its ends are rarely in contact and never run in.
    WearingStripReciprocating {
        /// m.
        stroke: f64,
        /// Of the contact, m.
        width: f64,
    },
    /// With heat: the bodies lose no heat.
    NoHeatLeaves {
        /// Path by which heat could leave, which is closed.
        closed: &'static str,
    },
    /// Another reason, in words.
    Other(String),
    /// With heat: error of the bodies, or of a cycle of the contact line.
    Heat(String),
    /// The contact problem of a stage has no solution.
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
            Self::RocksItselfRound { lever, limit, exponent } => write!(
                f,
                "no steady cycle in reciprocating sliding: wear rounds the contact and increases the tilt without bound, \
                 mu H = {lever} m is not below {limit} m, the limit for wear with the pressure exponent {exponent}"
            ),
            Self::NoCycle { lever, half_width, iterations } => write!(
                f,
                "no steady state found in {iterations} iterations: with mu H = {lever} m on a half-width of \
                 {half_width} m the tilt may grow without bound"
            ),
            Self::NothingWears => write!(f, "no run-in state: no wear reshapes the contact"),
            Self::OnlyStripWears => write!(
                f,
                "no run-in shape: only the strip wears, evenly on a closed path or as a groove that stays behind on a \
                 straight one, and the punch keeps its shape"
            ),
            Self::WearingStripReciprocating { stroke, width } => {
                write!(
                    f,
                    "no steady state: the strip wears on a straight reciprocating track, whose ends are rarely in contact, "
                )?;
                if stroke > width {
                    write!(
                        f,
                        "up to {width} m from each of them; the middle {middle} m, which all of the punch passes, have one, that of \
                         strip.path = closed",
                        middle = stroke - width
                    )?;
                } else {
                    write!(
                        f,
                        "and no part of the track has one, since none is passed by all of the punch: stroke {stroke} m, width {width} m"
                    )?;
                }
                f.write_str("; cargo fmu cycles follows the wear of both bodies")
            }
            Self::NoHeatLeaves { closed } => {
                write!(f, "no steady state with heat: the bodies lose no heat, since {closed}")
            }
            Self::Other(text) => f.write_str(text),
            Self::Heat(text) => write!(f, "with heat: {text}"),
            Self::Stage(error) => error.fmt(f),
            Self::Programme(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for SteadyError {}

/// Checks that a value is finite and positive.
fn positive(quantity: &'static str, value: f64) -> Result<(), SteadyError> {
    if value.is_finite() && value > 0.0 {
        return Ok(());
    }
    Err(SteadyError::Invalid { quantity, value, requirement: "finite and positive" })
}

/// Checks that a value is finite and not negative.
fn not_negative(quantity: &'static str, value: f64) -> Result<(), SteadyError> {
    if value.is_finite() && value >= 0.0 {
        return Ok(());
    }
    Err(SteadyError::Invalid { quantity, value, requirement: "finite and not negative" })
}
