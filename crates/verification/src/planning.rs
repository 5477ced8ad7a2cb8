//! Generated scenes that plans are tried on, and how good the plans are.

pub mod judge;
pub mod runs;
pub mod scenes;
