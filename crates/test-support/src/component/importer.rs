//! A small importer: one instance, its log, and the C functions with Rust arguments.

#![allow(
    clippy::not_unsafe_ptr_arg_deref,
    reason = "the library never dereferences what an importer holds, a state's handle too"
)]

use core::ffi::{CStr, c_char, c_void};
use std::ffi::CString;
use std::ptr;
use std::sync::Mutex;

use scene::{slot, variables};
use sliding_contact::fmi2::exports::*;
use sliding_contact::fmi2::types::{self, CallbackFunctions, ComponentEnvironment, FmuState, Logger, Status};

/// A phase of the state machine, and how an importer gets there.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Stage {
    /// Instantiated or reset.
    Instantiated,
    /// Initialization mode.
    Initialization,
    /// After initialization.
    Stepping,
    /// After `fmi2Terminate`.
    Terminated,
    /// After a step that ended in an error.
    Failed,
}

/// Phases and their letters in tables of calls.
pub const STAGES: [(Stage, char); 5] = [
    (Stage::Instantiated, 'i'),
    (Stage::Initialization, 'n'),
    (Stage::Stepping, 's'),
    (Stage::Terminated, 't'),
    (Stage::Failed, 'e'),
];

/// A message: status, category, text.
pub type Entry = (Status, String, String);

/// One instance and its log.
pub struct Importer {
    /// Handle of the instance.
    pub component: *mut c_void,
    log: Box<Mutex<Vec<Entry>>>,
}

// SAFETY: the library promises that any thread may call; the log is locked.
unsafe impl Send for Importer {}
// SAFETY: as above.
unsafe impl Sync for Importer {}

/// Not variadic, as Rust cannot define such functions: see [`as_logger`].
unsafe extern "C" fn note(
    environment: ComponentEnvironment,
    name: types::String,
    status: Status,
    category: types::String,
    format: types::String,
    text: *const c_char,
) {
    // SAFETY: the environment is an importer's log; a NULL here is a failure of the test by itself.
    unsafe {
        assert_eq!(CStr::from_ptr(format), c"%s");
        assert_eq!(CStr::from_ptr(name), c"importer");
        let owned = |text| CStr::from_ptr(text).to_str().unwrap().to_owned();
        let log = &*environment.cast::<Mutex<Vec<Entry>>>();
        log.lock().unwrap().push((status, owned(category), owned(text)));
    }
}

/// A logger without its variable arguments but one.
type Fixed =
    unsafe extern "C" fn(ComponentEnvironment, types::String, Status, types::String, types::String, *const c_char);

/// A logger with the variadic type of the standard. On the platforms of these tests a variadic function
/// takes a pointer as any other does; real variadic loggers are those of C and Python.
pub fn as_logger(function: Fixed) -> Logger {
    // SAFETY: see above.
    unsafe { core::mem::transmute::<Fixed, Logger>(function) }
}

/// The logger that notes into the log that is its environment.
pub fn logger() -> Logger {
    as_logger(note)
}

/// Value reference of a name.
pub fn reference(name: &str) -> u32 {
    variables::find(name).unwrap_or_else(|| panic!("no variable {name}"))
}

/// Value references of names.
pub fn references(names: &[&str]) -> Vec<u32> {
    names.iter().map(|name| reference(name)).collect()
}

/// GUID of this library.
pub fn guid() -> CString {
    CString::new(slot::current().unwrap().guid()).unwrap()
}

pub(crate) fn instantiate(log: &Mutex<Vec<Entry>>, debug: bool) -> *mut c_void {
    let callbacks = CallbackFunctions {
        logger: Some(logger()),
        allocate_memory: None,
        free_memory: None,
        step_finished: None,
        component_environment: ptr::from_ref(log).cast_mut().cast(),
    };
    // SAFETY: strings and structure live through the call.
    unsafe {
        let guid = guid();
        fmi2Instantiate(
            c"importer".as_ptr(),
            types::CO_SIMULATION,
            guid.as_ptr(),
            ptr::null(),
            &callbacks,
            0,
            debug.into(),
        )
    }
}

impl Default for Importer {
    fn default() -> Importer {
        Importer::new()
    }
}

impl Importer {
    /// An instance without debug logging.
    pub fn new() -> Importer {
        Importer::with_logging(false)
    }

    /// An instance, with debug logging or without.
    pub fn with_logging(debug: bool) -> Importer {
        let log = Box::new(Mutex::new(Vec::new()));
        let component = instantiate(&log, debug);
        assert!(!component.is_null(), "{:?}", log.lock().unwrap());
        Importer { component, log }
    }

    /// Sets the lumped level: tests of calls and states need no plan.
    fn choose_level(&self) {
        assert_eq!(self.set_integer("solver.fidelity", 2), Status::Ok);
    }

    /// An instance in a phase, with nothing in its log.
    pub fn at(stage: Stage) -> Importer {
        let importer = Importer::new();
        importer.go(stage);
        importer.take_log();
        importer
    }

    /// From a fresh or reset instance to a phase.
    pub fn go(&self, stage: Stage) {
        if stage == Stage::Instantiated {
            return;
        }
        self.choose_level();
        assert_eq!(self.setup(None, 0.0, Some(100.0)), Status::Ok);
        assert_eq!(self.enter(), Status::Ok);
        if stage == Stage::Initialization {
            return;
        }
        assert_eq!(self.exit(), Status::Ok);
        match stage {
            Stage::Terminated => assert_eq!(self.terminate(), Status::Ok),
            Stage::Failed => {
                assert_eq!(self.set_real(&["sliding_velocity"], &[f64::NAN]), Status::Ok);
                assert_eq!(self.step(0.0, 0.1), Status::Error);
            }
            _ => {}
        }
    }

    /// Messages since the last call.
    pub fn take_log(&self) -> Vec<Entry> {
        std::mem::take(&mut self.log.lock().unwrap())
    }

    /// `fmi2SetupExperiment`; times in s.
    pub fn setup(&self, tolerance: Option<f64>, start: f64, stop: Option<f64>) -> Status {
        let (has_tolerance, has_stop) = (tolerance.is_some().into(), stop.is_some().into());
        let (tolerance, stop) = (tolerance.unwrap_or(f64::NAN), stop.unwrap_or(f64::NAN));
        // SAFETY: no pointers.
        unsafe { fmi2SetupExperiment(self.component, has_tolerance, tolerance, start, has_stop, stop) }
    }

    /// `fmi2EnterInitializationMode`.
    pub fn enter(&self) -> Status {
        // SAFETY: no pointers, here and below.
        unsafe { fmi2EnterInitializationMode(self.component) }
    }

    /// `fmi2ExitInitializationMode`.
    pub fn exit(&self) -> Status {
        // SAFETY: as above.
        unsafe { fmi2ExitInitializationMode(self.component) }
    }

    /// `fmi2Terminate`.
    pub fn terminate(&self) -> Status {
        // SAFETY: as above.
        unsafe { fmi2Terminate(self.component) }
    }

    /// `fmi2Reset`.
    pub fn reset(&self) -> Status {
        // SAFETY: as above.
        unsafe { fmi2Reset(self.component) }
    }

    /// `fmi2DoStep`, s.
    pub fn step(&self, from: f64, step: f64) -> Status {
        // SAFETY: as above.
        unsafe { fmi2DoStep(self.component, from, step, 1) }
    }

    /// `fmi2SetReal` by names, SI units.
    pub fn set_real(&self, names: &[&str], values: &[f64]) -> Status {
        self.set_reals(&references(names), values)
    }

    /// `fmi2SetReal`, SI units.
    pub fn set_reals(&self, references: &[u32], values: &[f64]) -> Status {
        assert_eq!(references.len(), values.len());
        // SAFETY: the arrays are as long as told, here and below.
        unsafe { fmi2SetReal(self.component, references.as_ptr(), references.len(), values.as_ptr()) }
    }

    /// `fmi2SetInteger`.
    pub fn set_integer(&self, name: &str, value: i32) -> Status {
        // SAFETY: as above.
        unsafe { fmi2SetInteger(self.component, &reference(name), 1, &value) }
    }

    /// `fmi2SetBoolean`.
    pub fn set_boolean(&self, name: &str, value: i32) -> Status {
        // SAFETY: as above.
        unsafe { fmi2SetBoolean(self.component, &reference(name), 1, &value) }
    }

    /// `fmi2GetReal`, SI units.
    pub fn get_reals(&self, references: &[u32]) -> Result<Vec<f64>, Status> {
        let mut values = vec![f64::NAN; references.len()];
        // SAFETY: as above.
        let status = unsafe { fmi2GetReal(self.component, references.as_ptr(), references.len(), values.as_mut_ptr()) };
        if status == Status::Ok { Ok(values) } else { Err(status) }
    }

    /// Value of a variable, SI units; panics where it is refused.
    pub fn get_real(&self, name: &str) -> f64 {
        self.get_reals(&[reference(name)]).unwrap()[0]
    }

    /// `fmi2GetInteger`.
    pub fn get_integer(&self, name: &str) -> Result<i32, Status> {
        let mut value = -1;
        // SAFETY: as above.
        let status = unsafe { fmi2GetInteger(self.component, &reference(name), 1, &mut value) };
        if status == Status::Ok { Ok(value) } else { Err(status) }
    }

    /// `fmi2GetBoolean`.
    pub fn get_boolean(&self, name: &str) -> Result<i32, Status> {
        let mut value = -1;
        // SAFETY: as above.
        let status = unsafe { fmi2GetBoolean(self.component, &reference(name), 1, &mut value) };
        if status == Status::Ok { Ok(value) } else { Err(status) }
    }

    /// `fmi2SetRealInputDerivatives`, per s.
    pub fn set_derivative(&self, name: &str, order: i32, value: f64) -> Status {
        // SAFETY: as above.
        unsafe { fmi2SetRealInputDerivatives(self.component, &reference(name), 1, &order, &value) }
    }

    /// `fmi2GetRealOutputDerivatives`.
    pub fn output_derivative(&self, name: &str, order: i32) -> Status {
        let mut value = 0.0;
        // SAFETY: as above.
        unsafe { fmi2GetRealOutputDerivatives(self.component, &reference(name), 1, &order, &mut value) }
    }

    /// `fmi2GetDirectionalDerivative`.
    pub fn directional_derivative(&self, unknown: &str, known: &str, seed: f64) -> Result<f64, Status> {
        let mut result = f64::NAN;
        // SAFETY: as above.
        let status = unsafe {
            fmi2GetDirectionalDerivative(
                self.component,
                &reference(unknown),
                1,
                &reference(known),
                1,
                &seed,
                &mut result,
            )
        };
        if status == Status::Ok { Ok(result) } else { Err(status) }
    }

    /// `fmi2SetDebugLogging`.
    pub fn debug(&self, on: bool, categories: &[&CStr]) -> Status {
        let names: Vec<_> = categories.iter().map(|name| name.as_ptr()).collect();
        // SAFETY: as above.
        unsafe { fmi2SetDebugLogging(self.component, on.into(), names.len(), names.as_ptr()) }
    }

    /// `fmi2GetFMUstate`.
    pub fn save(&self, state: &mut FmuState) -> Status {
        // SAFETY: the place is there, here and below.
        unsafe { fmi2GetFMUstate(self.component, state) }
    }

    /// `fmi2SetFMUstate`.
    pub fn restore(&self, state: FmuState) -> Status {
        // SAFETY: as above.
        unsafe { fmi2SetFMUstate(self.component, state) }
    }

    /// `fmi2FreeFMUstate`.
    pub fn free(&self, state: &mut FmuState) -> Status {
        // SAFETY: as above.
        unsafe { fmi2FreeFMUstate(self.component, state) }
    }

    /// `fmi2SerializeFMUstate`.
    pub fn serialize(&self, state: FmuState) -> Result<Vec<u8>, Status> {
        let mut size = 0;
        // SAFETY: as above.
        let status = unsafe { fmi2SerializedFMUstateSize(self.component, state, &mut size) };
        if status != Status::Ok {
            return Err(status);
        }
        let mut bytes = vec![0_u8; size];
        // SAFETY: the array is as long as told.
        let status = unsafe { fmi2SerializeFMUstate(self.component, state, bytes.as_mut_ptr().cast(), size) };
        if status == Status::Ok { Ok(bytes) } else { Err(status) }
    }

    /// `fmi2DeSerializeFMUstate`.
    pub fn deserialize(&self, bytes: &[u8]) -> Result<FmuState, Status> {
        let mut state = ptr::null_mut();
        // SAFETY: the array is as long as told, the place is there.
        let status = unsafe { fmi2DeSerializeFMUstate(self.component, bytes.as_ptr().cast(), bytes.len(), &mut state) };
        if status == Status::Ok { Ok(state) } else { Err(status) }
    }

    /// Serialised state of the instance, for comparison.
    pub fn bytes(&self) -> Vec<u8> {
        let mut state = ptr::null_mut();
        assert_eq!(self.save(&mut state), Status::Ok);
        let bytes = self.serialize(state).unwrap();
        assert_eq!(self.free(&mut state), Status::Ok);
        bytes
    }
}

impl Drop for Importer {
    fn drop(&mut self) {
        fmi2FreeInstance(self.component);
    }
}
