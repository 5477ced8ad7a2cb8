//! The C functions of a loaded FMU.

use crate::error::Failure;
use libloading::Library;
use std::ffi::{CStr, c_char, c_double, c_int, c_uint, c_void};
use std::path::Path;

/// `fmi2Component`
pub(crate) type Handle = *mut c_void;
/// `fmi2Status`, as the plain number that it is in C.
pub(crate) type Status = c_uint;

/// `fmi2Warning`: still a success.
pub(crate) const WARNING: Status = 1;
/// `fmi2Fatal`: no instance may be touched any more.
pub(crate) const FATAL: Status = 4;

pub(crate) fn status_name(status: Status) -> &'static str {
    match status {
        0 => "fmi2OK",
        WARNING => "fmi2Warning",
        2 => "fmi2Discard",
        3 => "fmi2Error",
        FATAL => "fmi2Fatal",
        5 => "fmi2Pending",
        _ => "a status that FMI 2.0 does not define",
    }
}

/// `fmi2CallbackLogger` is variadic, which a Rust function cannot be on a stable compiler. It is declared here with
/// the first of its further arguments, which arrives in the same register either way on every platform but Apple's on
/// ARM; there the argument is not looked at.
pub type Logger = unsafe extern "C" fn(
    environment: *mut c_void,
    instance: *const c_char,
    status: Status,
    category: *const c_char,
    format: *const c_char,
    argument: *const c_char,
);

/// `fmi2CallbackFunctions`
#[repr(C)]
pub(crate) struct Callbacks {
    pub logger: Option<Logger>,
    pub allocate: unsafe extern "C" fn(usize, usize) -> *mut c_void,
    pub free: unsafe extern "C" fn(*mut c_void),
    pub step_finished: Option<unsafe extern "C" fn(*mut c_void, Status)>,
    pub environment: *mut c_void,
}

unsafe extern "C" {
    pub(crate) fn calloc(count: usize, size: usize) -> *mut c_void;
    pub(crate) fn free(memory: *mut c_void);
}

/// Functions of a library by the names that FMI 2.0 has for them.
macro_rules! functions {
    ($(#[$doc:meta])* $table:ident: $($field:ident = $symbol:literal ($($argument:ty),*) -> $result:ty;)*) => {
        $(#[$doc])*
        pub(crate) struct $table { $(pub $field: unsafe extern "C" fn($($argument),*) -> $result,)* }

        impl $table {
            fn find(library: &libloading::Library) -> Result<Self, String> {
                $(
                    // SAFETY: the signature is the one that FMI 2.0 fixes for this name.
                    let $field = *unsafe { library.get($symbol.to_bytes()) }
                        .map_err(|_| format!("it has no function {}", $symbol.to_string_lossy()))?;
                )*
                Ok(Self { $($field,)* })
            }
        }
    };
}
pub(crate) use functions;

functions! {
    /// The functions that the host calls.
    Functions:
    types_platform = c"fmi2GetTypesPlatform" () -> *const c_char;
    version = c"fmi2GetVersion" () -> *const c_char;
    instantiate = c"fmi2Instantiate" (*const c_char, c_uint, *const c_char, *const c_char, *const Callbacks, c_int, c_int) -> Handle;
    free_instance = c"fmi2FreeInstance" (Handle) -> ();
    setup_experiment = c"fmi2SetupExperiment" (Handle, c_int, c_double, c_double, c_int, c_double) -> Status;
    enter_initialization_mode = c"fmi2EnterInitializationMode" (Handle) -> Status;
    exit_initialization_mode = c"fmi2ExitInitializationMode" (Handle) -> Status;
    reset = c"fmi2Reset" (Handle) -> Status;
    set_real = c"fmi2SetReal" (Handle, *const c_uint, usize, *const c_double) -> Status;
    set_integer = c"fmi2SetInteger" (Handle, *const c_uint, usize, *const c_int) -> Status;
    set_boolean = c"fmi2SetBoolean" (Handle, *const c_uint, usize, *const c_int) -> Status;
    get_real = c"fmi2GetReal" (Handle, *const c_uint, usize, *mut c_double) -> Status;
    get_integer = c"fmi2GetInteger" (Handle, *const c_uint, usize, *mut c_int) -> Status;
    get_boolean = c"fmi2GetBoolean" (Handle, *const c_uint, usize, *mut c_int) -> Status;
    set_input_derivatives = c"fmi2SetRealInputDerivatives" (Handle, *const c_uint, usize, *const c_int, *const c_double) -> Status;
    step = c"fmi2DoStep" (Handle, c_double, c_double, c_int) -> Status;
}

impl Functions {
    /// Loads a library and finds its functions. They must not be called after the library is dropped.
    pub(crate) fn load(path: &Path) -> Result<(Self, Library), Failure> {
        let failed = |reason: String| Failure::library(format!("loading {}: {reason}", path.display()));
        // SAFETY: loading runs the library's initialisers; that is what loading an FMU means.
        let library = unsafe { Library::new(path) }.map_err(|error| failed(error.to_string()))?;
        let functions = Self::find(&library).map_err(failed)?;
        // SAFETY: both return constant strings that end with a zero.
        let (version, platform) =
            unsafe { (CStr::from_ptr((functions.version)()), CStr::from_ptr((functions.types_platform)())) };
        if version != c"2.0" || platform != c"default" {
            return Err(failed(format!(
                "it is of version {version:?} and type platform {platform:?}, this host runs \"2.0\" and \"default\""
            )));
        }
        Ok((functions, library))
    }
}
