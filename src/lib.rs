//! Wear and heat in a sliding contact, as a co-simulation FMU (FMI 2.0).
//!
//! See ARCHITECTURE.md for the invariants and the flow of data.

pub mod component;
pub mod fmi2;
