//! The functions of model exchange, which this FMU for co-simulation does not implement.
//!
//! They exist because some importers look up every function of the standard when they load a library. Each one
//! returns `fmi2Error` with a message in every phase, reads and writes nothing through its arguments, and leaves the
//! instance unchanged.

use super::export;
use crate::fmi2::gate;
use crate::fmi2::instance::Instance;
use crate::fmi2::policy::{Fault, Function};
use crate::fmi2::problem::{Outcome, Problem};
use crate::fmi2::types::{Boolean, Component, EventInfo, Real, Status};

#[cold]
fn refuse() -> Outcome {
    let text = "a function of model exchange; this FMU is for co-simulation".into();
    Err(Problem { fault: Fault::ModelExchange, text })
}

export! {
    /// Refused.
    fn fmi2EnterEventMode [EnterEventMode] () |_instance| { refuse() }

    /// Refused.
    fn fmi2NewDiscreteStates [NewDiscreteStates] (_fmi2eventInfo: *mut EventInfo) |_instance| { refuse() }

    /// Refused.
    fn fmi2EnterContinuousTimeMode [EnterContinuousTimeMode] () |_instance| { refuse() }

    /// Refused.
    fn fmi2CompletedIntegratorStep [CompletedIntegratorStep] (
        _noSetFMUStatePriorToCurrentPoint: Boolean,
        _enterEventMode: *mut Boolean,
        _terminateSimulation: *mut Boolean,
    ) |_instance| { refuse() }

    /// Refused.
    fn fmi2SetTime [SetTime] (_time: Real) |_instance| { refuse() }

    /// Refused.
    fn fmi2SetContinuousStates [SetContinuousStates] (_x: *const Real, _nx: usize) |_instance| { refuse() }

    /// Refused.
    fn fmi2GetDerivatives [GetDerivatives] (_derivatives: *mut Real, _nx: usize) |_instance| { refuse() }

    /// Refused.
    fn fmi2GetEventIndicators [GetEventIndicators] (_eventIndicators: *mut Real, _ni: usize) |_instance| { refuse() }

    /// Refused.
    fn fmi2GetContinuousStates [GetContinuousStates] (_x: *mut Real, _nx: usize) |_instance| { refuse() }

    /// Refused.
    fn fmi2GetNominalsOfContinuousStates [GetNominalsOfContinuousStates] (
        _x_nominal: *mut Real, _nx: usize
    ) |_instance| { refuse() }
}
