//! Wear and heat in a sliding contact, as a co-simulation FMU (FMI 2.0).
//!
//! See ARCHITECTURE.md for the invariants and the flow of data.

// Small fixed-size numerics read as the formulas they are when they are written with indices.
#![allow(clippy::needless_range_loop)]

pub mod component;
pub mod fmi2;
