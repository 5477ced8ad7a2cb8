//! The C declarations of the FMU, which are written by hand, against the bindings made from the standard's headers.
//!
//! Most of it is checked by the compiler: a signature that differs does not build.

use fmi::fmi2::binding::{self, Fmi2Binding};
use sliding_contact::fmi2::exports;
use sliding_contact::fmi2::types::{self, CallbackFunctions, EventInfo, Status};
use std::mem::{align_of, offset_of, size_of};

/// A type that is passed to C as `Standard` is.
trait PassedAs<Standard> {}

impl<T> PassedAs<T> for T {}
impl PassedAs<binding::fmi2Status> for Status {}
impl PassedAs<*mut binding::fmi2Status> for *mut Status {}
impl PassedAs<*const binding::fmi2CallbackFunctions> for *const CallbackFunctions {}
impl PassedAs<*mut binding::fmi2EventInfo> for *mut EventInfo {}

/// A function pointer whose arguments and result are passed as those of `Standard`.
trait CalledAs<Standard> {}

macro_rules! called_as {
    ($($own:ident $standard:ident),*) => {
        impl<R, S, $($own, $standard),*> CalledAs<unsafe extern "C" fn($($standard),*) -> S> for unsafe extern "C" fn($($own),*) -> R
        where R: PassedAs<S>, $($own: PassedAs<$standard>),* {}
    };
}

called_as!();
called_as!(A B);
called_as!(A B, C D);
called_as!(A B, C D, E F);
called_as!(A B, C D, E F, G H);
called_as!(A B, C D, E F, G H, I J);
called_as!(A B, C D, E F, G H, I J, K L);
called_as!(A B, C D, E F, G H, I J, K L, M N);

/// Both functions have one signature; there is nothing left to do when this is called.
fn same<Own: CalledAs<Standard>, Standard, E>(_own: Own, _standard: fn(&Fmi2Binding) -> &Result<Standard, E>) {}

macro_rules! same {
    ($($name:ident($($argument:tt),*);)*) => {{
        $(same(exports::$name as unsafe extern "C" fn($($argument),*) -> _, |binding| &binding.$name);)*
        [$(stringify!($name)),*]
    }};
}

#[test]
fn functions_have_the_signatures_of_the_headers() {
    let checked = same! {
        fmi2GetTypesPlatform();
        fmi2GetVersion();
        fmi2SetDebugLogging(_, _, _, _);
        fmi2Instantiate(_, _, _, _, _, _, _);
        fmi2FreeInstance(_);
        fmi2SetupExperiment(_, _, _, _, _, _);
        fmi2EnterInitializationMode(_);
        fmi2ExitInitializationMode(_);
        fmi2Terminate(_);
        fmi2Reset(_);
        fmi2GetReal(_, _, _, _);
        fmi2GetInteger(_, _, _, _);
        fmi2GetBoolean(_, _, _, _);
        fmi2GetString(_, _, _, _);
        fmi2SetReal(_, _, _, _);
        fmi2SetInteger(_, _, _, _);
        fmi2SetBoolean(_, _, _, _);
        fmi2SetString(_, _, _, _);
        fmi2GetFMUstate(_, _);
        fmi2SetFMUstate(_, _);
        fmi2FreeFMUstate(_, _);
        fmi2SerializedFMUstateSize(_, _, _);
        fmi2SerializeFMUstate(_, _, _, _);
        fmi2DeSerializeFMUstate(_, _, _, _);
        fmi2GetDirectionalDerivative(_, _, _, _, _, _, _);
        fmi2SetRealInputDerivatives(_, _, _, _, _);
        fmi2GetRealOutputDerivatives(_, _, _, _, _);
        fmi2DoStep(_, _, _, _);
        fmi2CancelStep(_);
        fmi2GetStatus(_, _, _);
        fmi2GetRealStatus(_, _, _);
        fmi2GetIntegerStatus(_, _, _);
        fmi2GetBooleanStatus(_, _, _);
        fmi2GetStringStatus(_, _, _);
        fmi2EnterEventMode(_);
        fmi2NewDiscreteStates(_, _);
        fmi2EnterContinuousTimeMode(_);
        fmi2CompletedIntegratorStep(_, _, _, _);
        fmi2SetTime(_, _);
        fmi2SetContinuousStates(_, _, _);
        fmi2GetDerivatives(_, _, _);
        fmi2GetEventIndicators(_, _, _);
        fmi2GetContinuousStates(_, _, _);
        fmi2GetNominalsOfContinuousStates(_, _, _);
    };
    // Annex A.2 of FMI 2.0.4.
    assert_eq!(checked.len(), 44);
}

#[test]
fn types_have_the_sizes_of_the_headers() {
    macro_rules! sizes {
        ($($own:ty = $standard:ty;)*) => {
            $(assert_eq!((size_of::<$own>(), align_of::<$own>()), (size_of::<$standard>(), align_of::<$standard>()));)*
        };
    }
    sizes! {
        types::Component = binding::fmi2Component;
        types::ComponentEnvironment = binding::fmi2ComponentEnvironment;
        types::FmuState = binding::fmi2FMUstate;
        types::ValueReference = binding::fmi2ValueReference;
        types::Real = binding::fmi2Real;
        types::Integer = binding::fmi2Integer;
        types::Boolean = binding::fmi2Boolean;
        types::String = binding::fmi2String;
        types::Byte = binding::fmi2Byte;
        types::FmuType = binding::fmi2Type;
        types::StatusKind = binding::fmi2StatusKind;
        Status = binding::fmi2Status;
        CallbackFunctions = binding::fmi2CallbackFunctions;
    }
}

#[test]
fn callbacks_stand_where_the_headers_put_them() {
    macro_rules! offsets {
        ($($own:ident = $standard:ident;)*) => {
            $(assert_eq!(offset_of!(CallbackFunctions, $own), offset_of!(binding::fmi2CallbackFunctions, $standard));)*
        };
    }
    offsets! {
        logger = logger;
        allocate_memory = allocateMemory;
        free_memory = freeMemory;
        step_finished = stepFinished;
        component_environment = componentEnvironment;
    }
}

#[test]
fn numbers_are_those_of_the_headers() {
    assert_eq!(Status::Ok as binding::fmi2Status, binding::fmi2Status_fmi2OK);
    assert_eq!(Status::Warning as binding::fmi2Status, binding::fmi2Status_fmi2Warning);
    assert_eq!(Status::Discard as binding::fmi2Status, binding::fmi2Status_fmi2Discard);
    assert_eq!(Status::Error as binding::fmi2Status, binding::fmi2Status_fmi2Error);
    assert_eq!(types::CO_SIMULATION, binding::fmi2Type_fmi2CoSimulation);
    assert_eq!(types::DO_STEP_STATUS, binding::fmi2StatusKind_fmi2DoStepStatus);
    assert_eq!(types::PENDING_STATUS, binding::fmi2StatusKind_fmi2PendingStatus);
    assert_eq!(types::LAST_SUCCESSFUL_TIME, binding::fmi2StatusKind_fmi2LastSuccessfulTime);
    assert_eq!(types::TERMINATED, binding::fmi2StatusKind_fmi2Terminated);
    assert_eq!(types::TRUE, binding::fmi2True as types::Boolean);
    assert_eq!(types::FALSE, binding::fmi2False as types::Boolean);
}
