//! The contact: friction law, and at the line pressure, gap, approach and tilt.

pub mod complementarity;
pub mod friction;
pub mod lemke;
pub mod problem;

pub use complementarity::{ContactSolver, pair_compliance};
pub use problem::{ContactError, ContactState, Normal, Tilt, WorkCounter};
