//! Steady states of the worn contact line, without time integration.
//!
//! A contact is run in when wear no longer changes the pressure: the worn depth then grows as a rigid motion of the punch. This
//! determines the pressure, and elasticity the shape. Reciprocating sliding has two pressures, one per direction, over one common
//! shape.
//!
//! Theory: docs/theory.md, section 9.

#![warn(missing_docs)]
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
pub use unidirectional::{Unidirectional, groove, groove_operator, punch_run_in};

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
    /// Unidirectional sliding: the resultant `mu H` lies outside the contact.
    Tipping {
        /// Lever mu H of the resultant, in m.
        lever: f64,
        /// Largest lever at which the contact can be in equilibrium, in m.
        limit: f64,
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
    /// A run-in state of a wear law that is not a power of the pressure.
    NotAPower {
        /// Body, as in the names of variables.
        body: &'static str,
        /// Parameter of the body by which the law is none.
        parameter: &'static str,
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
    /// With heat: the iteration for conductivity and specific heat over temperature did not converge.
    PropertiesNotSettled {
        /// Iterations done.
        iterations: usize,
        /// Last change of a property over itself.
        change: f64,
    },
    /// With heat: the iteration for temperatures and pressure of unidirectional sliding did not converge.
    NotSettled {
        /// Iterations done.
        iterations: usize,
        /// Last change of the temperature, in K.
        change: f64,
    },
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
            Self::Tipping { lever, limit } => {
                write!(f, "no steady state: the punch tips over, mu H = {lever} m is not below {limit} m")
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
            Self::NotAPower { body, parameter } => write!(
                f,
                "no run-in state with {body}.{parameter}: it is known for wear by a power of the pressure alone"
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
            Self::PropertiesNotSettled { iterations, change } => write!(
                f,
                "no steady state with heat found in {iterations} iterations for the properties: the last one changed conductivity or \
                 specific heat by {change:.1e} of itself; simulate the scene to its steady state"
            ),
            Self::NotSettled { iterations, change } if !change.is_finite() => {
                write!(
                    f,
                    "no steady state with heat found: temperatures grew beyond all numbers in {iterations} iterations"
                )
            }
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

/// Whether reciprocating sliding can run in at all, by which bodies wear.
///
/// A strip that wears on a straight track of this `stroke` (m) never runs in under a contact of this `width` (m): the ends of the track are
/// rarely in contact. On a closed path its wear is
/// uniform along the path and does not reshape the contact, so the punch has to wear.
pub fn can_run_in_reciprocating(
    punch_wears: bool,
    strip_wears: bool,
    closed_path: bool,
    [stroke, width]: [f64; 2],
) -> Result<(), SteadyError> {
    if strip_wears && !closed_path {
        return Err(SteadyError::WearingStripReciprocating { stroke, width });
    }
    if punch_wears { Ok(()) } else { Err(SteadyError::NothingWears) }
}

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
