//! The functions of FMI 2.0, and no other symbol: those of co-simulation here, those of model exchange, which are all
//! refused, in `model_exchange`.
//!
//! Each converts its raw arguments into safe ones and makes one call into the instance. The admissible call
//! sequences are in [`super::policy`], the implementation in `instance`. The documentation here states where this
//! slave goes beyond the standard's text or narrows it.
//!
//! # Safety
//! The same contract for all: a string is NULL or ends with a zero, an array is NULL or has as many
//! elements as its count says, the callback structure is NULL or one. Components and FMU states may be
//! anything.

#![allow(non_snake_case, reason = "the names are the standard's")]
#![allow(clippy::missing_safety_doc, reason = "one contract, at the top")]

mod model_exchange;

use core::ffi::{CStr, c_char};
use core::ptr;

use super::arguments::{MOST_VARIABLES, Sink, Source};
use super::floating_point::Environment;
use super::gate;
use super::instance::{Instance, free};
use super::log::Category;
use super::policy::{Fault, Function, Type};
use super::problem::{Outcome, Problem};
use super::types::{
    self, Boolean, Byte, CallbackFunctions, Component, FALSE, FmuState, Integer, Real, Status, StatusKind, TRUE,
    ValueReference,
};
use crate::panics;
pub use model_exchange::*;

/// Exports functions of an instance: `fn NAME [FUNCTION] (arguments) |instance| body`.
macro_rules! export {
    ($( $(#[$doc:meta])* fn $name:ident [$function:ident] ($($argument:ident: $kind:ty),* $(,)?)
        |$instance:ident| $body:block )*) => { $(
        $(#[$doc])*
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $name(component: Component, $($argument: $kind),*) -> Status {
            gate::call(component, Function::$function, |$instance: &mut Instance| $body)
        }
    )* };
}
use export;

/// An input array: values or references read from the importer's memory.
///
/// # Safety
/// See [`Source::new`].
#[inline(always)]
unsafe fn given<'a, T: Copy>(what: &str, start: *const T, count: usize) -> Result<Source<'a, T>, Problem> {
    // SAFETY: passed on.
    unsafe { Source::new(what, start, count, MOST_VARIABLES) }
}

/// An output array: values written to the importer's memory.
///
/// # Safety
/// See [`Sink::new`].
#[inline(always)]
unsafe fn wanted<'a, T: Copy>(what: &str, start: *mut T, count: usize) -> Result<Sink<'a, T>, Problem> {
    // SAFETY: passed on.
    unsafe { Sink::new(what, start, count, MOST_VARIABLES) }
}

/// Writes a single result after checking that its destination is not NULL.
///
/// # Safety
/// `place` is NULL or can be written.
unsafe fn answer<T>(what: &str, place: *mut T, result: impl FnOnce() -> Result<T, Problem>) -> Outcome {
    if place.is_null() {
        return Err(Problem { fault: Fault::Argument, text: format!("{what} is NULL") });
    }
    let value = result()?;
    // SAFETY: not NULL, so the caller vouches for it.
    unsafe { place.write_unaligned(value) };
    Ok(())
}

/// A string of the importer.
///
/// # Safety
/// `text` is NULL, or ends with a zero and lives as long as the result is used.
unsafe fn string<'a>(text: types::String) -> Option<&'a CStr> {
    // SAFETY: not NULL, so the caller vouches for it.
    (!text.is_null()).then(|| unsafe { CStr::from_ptr(text) })
}

/// `"default"`
#[unsafe(no_mangle)]
pub extern "C" fn fmi2GetTypesPlatform() -> *const c_char {
    c"default".as_ptr()
}

/// `"2.0"`
#[unsafe(no_mangle)]
pub extern "C" fn fmi2GetVersion() -> *const c_char {
    c"2.0".as_ptr()
}

/// Returns NULL with a message (if there is a logger) for a type other than co-simulation, a GUID other than
/// that of this FMU, or a missing name; NULL without a message where the callbacks are missing. The callback structure
/// is copied, need not outlive the call, and may be full of NULL. The resource location is ignored: no file is needed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2Instantiate(
    instanceName: types::String,
    fmuType: types::FmuType,
    fmuGUID: types::String,
    _fmuResourceLocation: types::String,
    functions: *const CallbackFunctions,
    _visible: Boolean,
    loggingOn: Boolean,
) -> Component {
    if functions.is_null() {
        return ptr::null_mut();
    }
    let _environment = Environment::enter();
    panics::install_hook();
    let instance = panics::catch(|| {
        // SAFETY: not NULL, so the importer vouches for the structure; it vouches for the strings.
        let (callbacks, name, guid) = unsafe { (functions.read_unaligned(), string(instanceName), string(fmuGUID)) };
        Instance::instantiate(&callbacks, name, fmuType, guid, loggingOn != FALSE)
    });
    instance.ok().flatten().and_then(|instance| gate::INSTANCES.insert(instance)).unwrap_or(ptr::null_mut())
}

/// Allowed in every phase. NULL, a freed instance and one in use by another call are ignored.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2FreeInstance(component: Component) {
    let _environment = Environment::enter();
    if let Ok(instance) = gate::INSTANCES.remove(component) {
        free(instance);
    }
}

export! {
    /// Switches `logEvents` and `logStatusWarning`; `logStatusError` is always sent. No categories mean
    /// all of them; unknown ones are ignored.
    fn fmi2SetDebugLogging [SetDebugLogging] (
        loggingOn: Boolean, nCategories: usize, categories: *const types::String
    ) |instance| {
        // SAFETY: the importer vouches for the array and its strings.
        let names = unsafe { given("categories", categories, nCategories)? };
        let mut known = Vec::new();
        for index in 0..names.count() {
            // SAFETY: as above.
            let Some(name) = (unsafe { string(names.at(index)) }) else {
                return Err(Problem { fault: Fault::Argument, text: format!("category {index} is NULL") });
            };
            known.extend(Category::from_name(name));
        }
        instance.set_debug_logging(loggingOn != FALSE, (nCategories > 0).then_some(&known))
    }

    /// The tolerance must be > 0, the stop time not before the start time, everything finite.
    fn fmi2SetupExperiment [SetupExperiment] (
        toleranceDefined: Boolean, tolerance: Real, startTime: Real, stopTimeDefined: Boolean, stopTime: Real
    ) |instance| {
        instance.setup_experiment(
            (toleranceDefined != FALSE).then_some(tolerance),
            startTime,
            (stopTimeDefined != FALSE).then_some(stopTime),
        )
    }

    /// From here on outputs follow the inputs that are set.
    fn fmi2EnterInitializationMode [EnterInitializationMode] () |instance| {
        instance.enter_initialization_mode()
    }

    /// Checks the rules that join parameters, and builds the model.
    fn fmi2ExitInitializationMode [ExitInitializationMode] () |instance| {
        instance.exit_initialization_mode()
    }

    /// Allowed after an error too.
    fn fmi2Terminate [Terminate] () |instance| {
        instance.terminate()
    }

    /// Restores a fresh instance; the logging settings are unchanged.
    fn fmi2Reset [Reset] () |instance| {
        instance.reset()
    }

    /// In every phase.
    fn fmi2GetReal [GetReal] (vr: *const ValueReference, nvr: usize, value: *mut Real) |instance| {
        // SAFETY: the importer vouches for the arrays.
        let (references, values) = unsafe { (given("vr", vr, nvr)?, wanted("value", value, nvr)?) };
        instance.get(Type::Real, references, values, |value| value)
    }

    /// In every phase. Enumerations too: the number of the item, from 1.
    fn fmi2GetInteger [GetInteger] (vr: *const ValueReference, nvr: usize, value: *mut Integer) |instance| {
        // SAFETY: the importer vouches for the arrays.
        let (references, values) = unsafe { (given("vr", vr, nvr)?, wanted("value", value, nvr)?) };
        instance.get(Type::Integer, references, values, |value| value as Integer)
    }

    /// In every phase.
    fn fmi2GetBoolean [GetBoolean] (vr: *const ValueReference, nvr: usize, value: *mut Boolean) |instance| {
        // SAFETY: the importer vouches for the arrays.
        let (references, values) = unsafe { (given("vr", vr, nvr)?, wanted("value", value, nvr)?) };
        instance.get(Type::Boolean, references, values, |value| if value == 0.0 { FALSE } else { TRUE })
    }

    /// There are no string variables: only an empty vector is fine.
    fn fmi2GetString [GetString] (vr: *const ValueReference, nvr: usize, value: *mut types::String) |instance| {
        // SAFETY: the importer vouches for the arrays.
        let (references, _) = unsafe { (given("vr", vr, nvr)?, wanted("value", value, nvr)?) };
        instance.no_strings(references)
    }

    /// The whole vector is checked before any of it is stored. A parameter outside its bounds returns
    /// `fmi2Discard`; an input takes any value, and the next step refuses one that is not finite.
    fn fmi2SetReal [SetReal] (vr: *const ValueReference, nvr: usize, value: *const Real) |instance| {
        // SAFETY: the importer vouches for the arrays.
        let (references, values) = unsafe { (given("vr", vr, nvr)?, given("value", value, nvr)?) };
        instance.set(Type::Real, references, values)
    }

    /// As [`fmi2SetReal`]. Enumerations too.
    fn fmi2SetInteger [SetInteger] (vr: *const ValueReference, nvr: usize, value: *const Integer) |instance| {
        // SAFETY: the importer vouches for the arrays.
        let (references, values) = unsafe { (given("vr", vr, nvr)?, given("value", value, nvr)?) };
        instance.set(Type::Integer, references, values)
    }

    /// As [`fmi2SetReal`]. Anything but 0 and 1 is refused.
    fn fmi2SetBoolean [SetBoolean] (vr: *const ValueReference, nvr: usize, value: *const Boolean) |instance| {
        // SAFETY: the importer vouches for the arrays.
        let (references, values) = unsafe { (given("vr", vr, nvr)?, given("value", value, nvr)?) };
        instance.set(Type::Boolean, references, values)
    }

    /// There are no string variables: only an empty vector is fine.
    fn fmi2SetString [SetString] (vr: *const ValueReference, nvr: usize, value: *const types::String) |instance| {
        // SAFETY: the importer vouches for the arrays.
        let (references, _) = unsafe { (given("vr", vr, nvr)?, given("value", value, nvr)?) };
        instance.no_strings(references)
    }

    /// Overwrites an existing state; NULL allocates a new one.
    fn fmi2GetFMUstate [GetFmuState] (FMUstate: *mut FmuState) |instance| {
        // SAFETY: not NULL when `answer` evaluates it, so the importer vouches for it.
        unsafe { answer("FMUstate", FMUstate, || instance.get_fmu_state(FMUstate.read_unaligned())) }
    }

    /// Restores everything bit for bit, including the phase and the times, also after an error.
    fn fmi2SetFMUstate [SetFmuState] (FMUstate: FmuState) |instance| {
        instance.set_fmu_state(FMUstate)
    }

    /// NULL is ignored; the pointer is set to NULL.
    fn fmi2FreeFMUstate [FreeFmuState] (FMUstate: *mut FmuState) |instance| {
        if FMUstate.is_null() {
            return Ok(());
        }
        // SAFETY: not NULL, so the importer vouches for it.
        unsafe {
            instance.free_fmu_state(FMUstate.read_unaligned())?;
            FMUstate.write_unaligned(ptr::null_mut());
        }
        Ok(())
    }

    /// The number of bytes that [`fmi2SerializeFMUstate`] writes.
    fn fmi2SerializedFMUstateSize [SerializedFmuStateSize] (FMUstate: FmuState, size: *mut usize) |instance| {
        // SAFETY: the importer vouches for the place.
        unsafe { answer("size", size, || instance.serialized_size(FMUstate)) }
    }

    /// `size` must be the result of [`fmi2SerializedFMUstateSize`].
    fn fmi2SerializeFMUstate [SerializeFmuState] (
        FMUstate: FmuState, serializedState: *mut Byte, size: usize
    ) |instance| {
        // SAFETY: the importer vouches for the array.
        let bytes = unsafe { Sink::new("serializedState", serializedState.cast(), size, usize::MAX)? };
        instance.serialize(FMUstate, bytes)
    }

    /// Always a new state. Damaged bytes, or those of another FMU, are refused.
    fn fmi2DeSerializeFMUstate [DeSerializeFmuState] (
        serializedState: *const Byte, size: usize, FMUstate: *mut FmuState
    ) |instance| {
        // SAFETY: the importer vouches for the array and the place.
        unsafe {
            let bytes = Source::new("serializedState", serializedState.cast(), size, usize::MAX)?;
            answer("FMUstate", FMUstate, || instance.deserialize(bytes))
        }
    }

    /// Partial derivatives of Real outputs by inputs at frozen states.
    fn fmi2GetDirectionalDerivative [GetDirectionalDerivative] (
        vUnknown_ref: *const ValueReference,
        nUnknown: usize,
        vKnown_ref: *const ValueReference,
        nKnown: usize,
        dvKnown: *const Real,
        dvUnknown: *mut Real,
    ) |instance| {
        // SAFETY: the importer vouches for the arrays.
        let (unknowns, knowns, seed, result) = unsafe {(
            given("vUnknown_ref", vUnknown_ref, nUnknown)?,
            given("vKnown_ref", vKnown_ref, nKnown)?,
            given("dvKnown", dvKnown, nKnown)?,
            wanted("dvUnknown", dvUnknown, nUnknown)?,
        )};
        instance.get_directional_derivative(unknowns, knowns, seed, result)
    }

    /// Order 1; valid for the next step, cleared by setting the input.
    fn fmi2SetRealInputDerivatives [SetRealInputDerivatives] (
        vr: *const ValueReference, nvr: usize, order: *const Integer, value: *const Real
    ) |instance| {
        // SAFETY: the importer vouches for the arrays.
        let (references, orders, values) =
            unsafe { (given("vr", vr, nvr)?, given("order", order, nvr)?, given("value", value, nvr)?) };
        instance.set_real_input_derivatives(references, orders, values)
    }

    /// Order 1 (`maxOutputDerivativeOrder`): right-sided derivatives at the end of the last step, at the present inputs.
    fn fmi2GetRealOutputDerivatives [GetRealOutputDerivatives] (
        vr: *const ValueReference, nvr: usize, order: *const Integer, value: *mut Real
    ) |instance| {
        // SAFETY: the importer vouches for the arrays.
        let (references, orders, values) =
            unsafe { (given("vr", vr, nvr)?, given("order", order, nvr)?, wanted("value", value, nvr)?) };
        instance.get_real_output_derivatives(references, orders, values)
    }

    /// Never returns `fmi2Warning` or `fmi2Discard`. A step of length 0 changes no state.
    fn fmi2DoStep [DoStep] (
        currentCommunicationPoint: Real,
        communicationStepSize: Real,
        _noSetFMUStatePriorToCurrentPoint: Boolean,
    ) |instance| {
        instance.do_step(currentCommunicationPoint, communicationStepSize)
    }

    /// There is never a step to cancel.
    fn fmi2CancelStep [CancelStep] () |_instance| {
        Ok(())
    }

    /// Steps are synchronous: `fmi2Discard`.
    fn fmi2GetStatus [GetStatus] (s: StatusKind, value: *mut Status) |instance| {
        // SAFETY: the importer vouches for the place.
        unsafe { answer("value", value, || instance.no_status(s)) }
    }

    /// `fmi2LastSuccessfulTime`; anything else: `fmi2Discard`.
    fn fmi2GetRealStatus [GetRealStatus] (s: StatusKind, value: *mut Real) |instance| {
        // SAFETY: the importer vouches for the place.
        unsafe { answer("value", value, || instance.real_status(s)) }
    }

    /// `fmi2Discard`
    fn fmi2GetIntegerStatus [GetIntegerStatus] (s: StatusKind, value: *mut Integer) |instance| {
        // SAFETY: the importer vouches for the place.
        unsafe { answer("value", value, || instance.no_status(s)) }
    }

    /// `fmi2Terminated`, which is false; anything else: `fmi2Discard`.
    fn fmi2GetBooleanStatus [GetBooleanStatus] (s: StatusKind, value: *mut Boolean) |instance| {
        // SAFETY: the importer vouches for the place.
        unsafe { answer("value", value, || instance.boolean_status(s)) }
    }

    /// `fmi2Discard`
    fn fmi2GetStringStatus [GetStringStatus] (s: StatusKind, value: *mut types::String) |instance| {
        // SAFETY: the importer vouches for the place.
        unsafe { answer("value", value, || instance.no_status(s)) }
    }
}
