//! The C types of FMI 2.0 (`fmi2TypesPlatform.h` and `fmi2FunctionTypes.h`), platform `default`.
//!
//! Enumerations of the standard arrive as plain integers: a Rust enumeration holding a number that an
//! importer made up would be undefined behaviour.

use core::ffi::{c_char, c_int, c_uint, c_void};

/// `fmi2Component`: here a handle, never dereferenced; see `registry`.
pub type Component = *mut c_void;
/// `fmi2ComponentEnvironment`: the importer's own, passed back to its logger.
pub type ComponentEnvironment = *mut c_void;
/// `fmi2FMUstate`: here a handle, as [`Component`].
pub type FmuState = *mut c_void;
/// `fmi2ValueReference`
pub type ValueReference = c_uint;
/// `fmi2Real`
pub type Real = f64;
/// `fmi2Integer`
pub type Integer = c_int;
/// `fmi2Boolean`: 0 is false, 1 is true.
pub type Boolean = c_int;
/// `fmi2String`: UTF-8, ends with a zero.
pub type String = *const c_char;
/// `fmi2Byte`
pub type Byte = c_char;
/// `fmi2EventInfo`, of model exchange: never read or written.
#[repr(C)]
pub struct EventInfo {
    opaque: [u8; 0],
}

/// `fmi2Type`: see [`CO_SIMULATION`].
pub type FmuType = c_uint;
/// `fmi2StatusKind`: see [`DO_STEP_STATUS`] and those that follow it.
pub type StatusKind = c_uint;

/// `fmi2CoSimulation`
pub const CO_SIMULATION: FmuType = 1;
/// `fmi2True`
pub const TRUE: Boolean = 1;
/// `fmi2False`
pub const FALSE: Boolean = 0;
/// `fmi2DoStepStatus`
pub const DO_STEP_STATUS: StatusKind = 0;
/// `fmi2PendingStatus`
pub const PENDING_STATUS: StatusKind = 1;
/// `fmi2LastSuccessfulTime`
pub const LAST_SUCCESSFUL_TIME: StatusKind = 2;
/// `fmi2Terminated`
pub const TERMINATED: StatusKind = 3;

/// `fmi2Status`. Only handed out, never taken from an importer.
#[repr(u32)]
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Status {
    /// `fmi2OK`
    Ok = 0,
    /// `fmi2Warning`; only as the status of a message, never returned.
    Warning = 1,
    /// `fmi2Discard`
    Discard = 2,
    /// `fmi2Error`
    Error = 3,
}

/// `fmi2CallbackLogger`: environment, instance name, status, category, format, arguments.
pub type Logger = unsafe extern "C" fn(ComponentEnvironment, String, Status, String, String, ...);
/// `fmi2CallbackAllocateMemory`
type AllocateMemory = unsafe extern "C" fn(usize, usize) -> *mut c_void;
/// `fmi2CallbackFreeMemory`
type FreeMemory = unsafe extern "C" fn(*mut c_void);
/// `fmi2StepFinished`
type StepFinished = unsafe extern "C" fn(ComponentEnvironment, Status);

/// `fmi2CallbackFunctions`. Every function may be NULL here; memory comes from Rust's own allocator
/// and steps are synchronous, so only the logger is ever called.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct CallbackFunctions {
    /// Takes log messages.
    pub logger: Option<Logger>,
    /// Not used.
    pub allocate_memory: Option<AllocateMemory>,
    /// Not used.
    pub free_memory: Option<FreeMemory>,
    /// Not used.
    pub step_finished: Option<StepFinished>,
    /// Passed back to the logger.
    pub component_environment: ComponentEnvironment,
}
