//! The component: parameters and inputs in, outputs out, one step after the other.
//!
//! This is what the C interface, the native host and the tests drive. It knows the variable table
//! but not FMI: phases, status codes and times are the importer's side ([`crate::fmi2`]).

mod derivative;
mod snapshot;

pub use snapshot::{Damaged, Snapshot};

use crate::coupled::{Inputs, Level, StepFailure};
use crate::scene::Scene;
use crate::variables::{self, COUNT, Causality, Refusal, ValueReference, Variability};
use std::sync::Arc;

/// Subject of a log message; the FMI categories are made from it.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Subject {
    /// What was chosen and why.
    Plan,
    /// A limit was reached, the model's validity was left, an input had to be clipped.
    Warning,
    /// A step or an initialisation failed.
    Error,
}

/// A message for the log.
#[derive(Clone, PartialEq, Debug)]
pub struct Message {
    /// What it is about.
    pub subject: Subject,
    /// One line of text.
    pub text: String,
}

/// Start values of a scene: one f64 for every value reference.
pub type Values = [f64; COUNT];
