//! Wear and heat in a sliding contact, as a co-simulation FMU (FMI 2.0).
//!
//! docs/architecture.md has the layers, the invariants and one step; docs/theory.md the equations.

pub mod component;
pub mod fmi2;
mod panics;
