//! Resolved heat through the component alone: energy balance, distortion, order, states.

#![allow(clippy::needless_range_loop, reason = "stations read as the formulas they are when they are indexed")]

mod annulus;
mod edges;
mod estimates;
mod extremes;
mod growth;
mod hottest;
mod steps;
mod stop;
mod unloading;
