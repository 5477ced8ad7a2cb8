//! The line level through the component alone: pressure, wear, holder, saved states and derivatives, against closed
//! forms, the direct steady states and finer steps.

// Stations and cells read as the formulas they are when they are written with indices.
#![allow(clippy::needless_range_loop)]

mod contact;
mod derivatives;
mod elastic_slip;
mod hard;
mod states;
mod wear;
