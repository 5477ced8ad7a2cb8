//! Resolved heat through the component alone: energy balance, distortion, order, states.

// The example scenes are files.
#![allow(clippy::needless_range_loop, reason = "stations read as the formulas they are when they are indexed")]

#[path = "../lumped_physics/drive.rs"]
#[allow(dead_code, reason = "shared with the tests of the lumped level, which use all of it")]
mod drive;

mod account;
mod annulus;
mod cycles;
mod extremes;
mod field;
mod growth;
mod hottest;
mod plans;
mod split;
mod steps;
mod stop;
mod work;
