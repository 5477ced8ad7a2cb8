//! The line level through the component alone: pressure, wear, holder, saved states and derivatives, against closed
//! forms, the direct steady states and finer steps.

// The example scenes are files.
// Stations and cells read as the formulas they are when they are written with indices.
#![allow(clippy::needless_range_loop)]

#[path = "../lumped_physics/drive.rs"]
#[allow(dead_code, reason = "shared with the tests of the lumped level, which use all of it")]
mod drive;

mod contact;
mod derivatives;
mod hard;
mod states;
mod wear;
