//! Elastic bodies.

pub mod mean;
