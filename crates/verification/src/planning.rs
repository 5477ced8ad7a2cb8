//! Generated scenes for planning, and the quality of the plans.

pub mod judge;
pub mod runs;
pub mod scenes;
