//! Native host that runs a co-simulation FMU (FMI 2.0) over schedules of inputs, for batches of thousands of scenes.
//!
//! A [`Worker`] loads the library of an unpacked FMU, keeps one instance and reuses it for every [`Scene`] through
//! `fmi2Reset`. A scene sets parameters, initialises, steps with one constant communication step over a [`Schedule`]
//! and records chosen outputs at chosen communication points. A scene that fails returns its reason and leaves the worker
//! ready for the next one; nothing is ever printed.
//!
//! A worker belongs to one thread at a time. Several workers in one process are independent of each other as far as
//! the FMU's instances are; batches use one process for each, to isolate the scenes from each other.
//!
//! The C interface of the same is in [`c_interface`].

pub mod c_interface;
mod description;
mod error;
mod functions;
mod scene;
mod schedule;
pub mod timing;
mod worker;

pub use description::{Causality, Description, Kind, Variable};
pub use error::{Failure, Stage};
pub use scene::{Scene, Span};
pub use schedule::{Interpolation, Schedule};
pub use worker::{Worker, platform};
