//! Wear and heat in a sliding contact, as a co-simulation FMU (FMI 2.0).
//!
//! See ARCHITECTURE.md for the invariants and the flow of data.

// Small fixed-size numerics read as the formulas they are when they are written with indices.
#![allow(clippy::needless_range_loop)]

pub mod component;
pub mod contact;
pub mod coupled;
pub mod elastic;
pub mod exact;
pub mod fmi2;
pub mod heat;
pub mod numerics;
pub mod plan;
pub mod scene;
pub mod slot;
pub mod steady;
pub mod variables;
pub mod verification;
pub mod wear;
