//! Failures of a scene and the stages in which they occur.

use std::fmt;

/// Stage in which a scene failed. The numbers are those of the C interface; 0 stands for success.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[repr(i32)]
pub enum Stage {
    /// The request itself is wrong: an unknown name, a span that is no whole number of steps. Nothing was run.
    Request = 1,
    /// The FMU refused a parameter, or could not be initialised with all of them.
    Initialisation = 2,
    /// The FMU failed on the way.
    Stepping = 3,
    /// The library is unusable: it cannot be loaded or instantiated, or has reported a fatal error.
    Library = 4,
}

impl Stage {
    /// One word for tables.
    pub fn name(self) -> &'static str {
        match self {
            Stage::Request => "request",
            Stage::Initialisation => "initialisation",
            Stage::Stepping => "stepping",
            Stage::Library => "library",
        }
    }
}

/// A failure: stage and reason.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Failure {
    /// Stage of the failure.
    pub stage: Stage,
    /// Reason, with names, values and the FMU's own log messages.
    pub reason: String,
}

impl Failure {
    pub(crate) fn new(stage: Stage, reason: impl Into<String>) -> Self {
        Self { stage, reason: reason.into() }
    }

    pub(crate) fn request(reason: impl Into<String>) -> Self {
        Self::new(Stage::Request, reason)
    }

    pub(crate) fn library(reason: impl Into<String>) -> Self {
        Self::new(Stage::Library, reason)
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{}: {}", self.stage.name(), self.reason)
    }
}

impl std::error::Error for Failure {}
