//! Generated scenes for planning, and the quality of the plans.
//!
//! Theory: docs/theory.md, section 8.2.

pub mod judge;
pub mod runs;
pub mod scenes;
