//! Utilities shared by the tests of several crates; never linked into the FMU.
//!
//! Layers below the component take random numbers and counted allocations alone, without the feature `component`: so their tests compile
//! no layer above them.

#[cfg(feature = "component")]
mod component;
pub mod counting;
mod random;

#[cfg(feature = "component")]
pub use component::*;
pub use random::Random;
