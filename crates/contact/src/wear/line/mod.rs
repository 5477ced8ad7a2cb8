//! Wear of the contact line without heat: coupled integration of pressure, shape and approach.
//!
//! The worn depth `w` of every cell grows with a rate `f(p)` of the local pressure, and the pressure follows from the worn
//! shape by the contact problem: a differential-algebraic system of index 1 whose stiffness is inversely proportional to the
//! smallest eigenvalue of the compliance.
//!
//! Theory: docs/theory.md, sections 5.2, 6.7.

mod contact;
mod newton;
mod rate;
mod response;
mod track;
mod warm_start;

pub use contact::{Conditions, Direction, StageError, WearingContact};
pub use rate::{CellRate, Coefficient, WearTerm};
pub use response::{ContactRate, Disturbance};
pub use track::{AVERAGED_STROKE, LineTrack};
pub use warm_start::{StrokeWarmStart, WarmStart};
