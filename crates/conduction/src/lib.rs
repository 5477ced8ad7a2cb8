//! Heat conduction in the two bodies, each reduced to its response at the contact.
//!
//! Each body is a thermal impedance: temperature at the contact per heat flux into it. [`slab`] is the exact one-dimensional
//! conduction problem through the height and its reduction to a few states, [`moving_source`] the exact kernel of the
//! strip's local (flash) heating under the sliding contact, [`flash`] its reduction to a few states whose decay rates depend
//! on the velocity.
//!
//! Theory: docs/theory.md, section 4.1.

#![forbid(unsafe_code)]

pub mod flash;
pub mod lateral;
pub mod line;
pub mod moving_source;
pub mod properties;
pub mod reduced;
mod shares;
pub mod slab;
mod trial_functions;

/// Stefan-Boltzmann constant, W/(m2 K4).
pub const STEFAN_BOLTZMANN: f64 = 5.670_374_419e-8;
