//! Contact: friction law, and the unilateral contact problem of the contact line in pressure, gap, approach and tilt.
//!
//! Theory: docs/theory.md, sections 2.1, 6.6.

#![forbid(unsafe_code)]

mod complementarity;
mod factors;
pub mod friction;
pub(crate) mod friction_curve;
pub mod lemke;
pub(crate) mod problem;
pub mod wear;

pub use complementarity::{ContactProblem, ContactSolver, pair_compliance, pair_operators};
pub use factors::{LowRankUpdate, check_operators, largest_update_rank};
pub use problem::{ContactError, ContactState, Normal, Tilt, WorkCounter};
