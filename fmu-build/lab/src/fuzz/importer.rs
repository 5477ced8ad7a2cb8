//! One instance behind the C functions, and its log.

use core::ffi::{CStr, c_char, c_void};
use std::cell::RefCell;
use std::ffi::CString;
use std::ptr;

use scene::slot;
use scene::variables::{COUNT, ValueReference, lookup, reference};
use sliding_contact::fmi2::exports::*;
use sliding_contact::fmi2::types::{self, CallbackFunctions, ComponentEnvironment, FmuState, Logger, Status};

use super::invariants::name_of;
use super::watchdog::{call, enter, tell};

/// Messages: status and text.
pub(crate) type Log = Vec<(Status, String)>;

pub(crate) struct Importer {
    pub component: *mut c_void,
    log: Box<RefCell<Log>>,
}

/// Not variadic, as Rust cannot define such functions: see [`logger`].
unsafe extern "C" fn note(
    environment: ComponentEnvironment,
    _name: types::String,
    status: Status,
    _category: types::String,
    _format: types::String,
    text: *const c_char,
) {
    // SAFETY: the environment is an importer's log, the text ends with a zero.
    unsafe {
        let text = CStr::from_ptr(text).to_string_lossy().into_owned();
        tell(|| format!("{status:?}: {text}"));
        (*environment.cast::<RefCell<Log>>()).borrow_mut().push((status, text));
    }
}

type Fixed =
    unsafe extern "C" fn(ComponentEnvironment, types::String, Status, types::String, types::String, *const c_char);

/// The logger with the variadic type of the standard: where this command runs, a variadic function takes a pointer as any
/// other does.
fn logger() -> Logger {
    // SAFETY: see above.
    unsafe { core::mem::transmute::<Fixed, Logger>(note) }
}

/// The GUID of this library's scene.
pub(crate) fn guid() -> CString {
    let guid = slot::current().map(|scene| scene.guid()).unwrap_or_default();
    CString::new(guid).unwrap_or_default()
}

impl Importer {
    /// A new instance; `None` where the library gives none.
    pub(crate) fn new(debug: bool) -> Option<Self> {
        let log: Box<RefCell<Log>> = Box::default();
        let callbacks = CallbackFunctions {
            logger: Some(logger()),
            allocate_memory: None,
            free_memory: None,
            step_finished: None,
            component_environment: ptr::from_ref(&*log).cast_mut().cast(),
        };
        let guid = guid();
        // SAFETY: the strings and the structure live through the call.
        let component = unsafe {
            let name = c"fuzz".as_ptr();
            call!(fmi2Instantiate(name, types::CO_SIMULATION, guid.as_ptr(), ptr::null(), &callbacks, 0, debug.into()))
        };
        (!component.is_null()).then_some(Self { component, log })
    }

    /// The messages since the last call.
    pub(crate) fn take_log(&self) -> Log {
        std::mem::take(&mut self.log.borrow_mut())
    }

    /// Whether there are messages of refusals.
    pub(crate) fn has_refused(&self) -> bool {
        self.log.borrow().iter().any(|(status, _)| matches!(status, Status::Error | Status::Discard))
    }

    /// Puts messages back before those that came since.
    pub(crate) fn put_back(&self, mut log: Log) {
        let mut current = self.log.borrow_mut();
        log.append(&mut current);
        *current = log;
    }

    /// Whether the last message refuses an output and names an input, or the derivative of an input, as the cause.
    pub(crate) fn has_named_an_input(&self) -> bool {
        let log = self.log.borrow();
        let Some((_, text)) = log.last() else { return false };
        let Some((_, cause)) = text.split_once("is not a finite number: ") else { return false };
        let cause = cause.strip_prefix("the derivative of ").unwrap_or(cause);
        (0..model::INPUTS).any(|at| lookup(at as ValueReference).is_some_and(|(row, _)| cause.starts_with(row.name)))
    }

    pub(crate) fn setup(&self, tolerance: Option<f64>, start: f64, stop: Option<f64>) -> Status {
        let (with_tolerance, with_stop) = (tolerance.is_some().into(), stop.is_some().into());
        // SAFETY: no pointers.
        unsafe {
            let (tolerance, stop) = (tolerance.unwrap_or(f64::NAN), stop.unwrap_or(f64::NAN));
            call!(fmi2SetupExperiment(self.component, with_tolerance, tolerance, start, with_stop, stop))
        }
    }

    pub(crate) fn enter(&self) -> Status {
        // SAFETY: no pointers, here and below.
        unsafe { call!(fmi2EnterInitializationMode(self.component)) }
    }

    pub(crate) fn exit(&self) -> Status {
        // SAFETY: as above.
        unsafe { call!(fmi2ExitInitializationMode(self.component)) }
    }

    pub(crate) fn terminate(&self) -> Status {
        // SAFETY: as above.
        unsafe { call!(fmi2Terminate(self.component)) }
    }

    pub(crate) fn reset(&self) -> Status {
        // SAFETY: as above.
        unsafe { call!(fmi2Reset(self.component)) }
    }

    pub(crate) fn step(&self, from: f64, step: f64) -> Status {
        enter("fmi2DoStep");
        tell(|| format!("{step:e} s from {from:e} s"));
        // SAFETY: as above.
        unsafe { fmi2DoStep(self.component, from, step, 1) }
    }

    /// Communication point.
    pub(crate) fn time(&self) -> f64 {
        let mut time = f64::NAN;
        // SAFETY: the place is there.
        let _ = unsafe { fmi2GetRealStatus(self.component, types::LAST_SUCCESSFUL_TIME, &mut time) };
        time
    }

    /// `fmi2SetReal`; the arrays are as long as each other.
    pub(crate) fn set_reals(&self, references: &[ValueReference], values: &[f64]) -> Status {
        enter("fmi2SetReal");
        for (reference, value) in references.iter().zip(values) {
            tell(|| format!("{} = {value:e}", name_of(*reference)));
        }
        let count = references.len().min(values.len());
        // SAFETY: the arrays are as long as told, here and below.
        unsafe { fmi2SetReal(self.component, references.as_ptr(), count, values.as_ptr()) }
    }

    pub(crate) fn set_integer(&self, reference: ValueReference, value: i32) -> Status {
        enter("fmi2SetInteger");
        tell(|| format!("{} = {value}", name_of(reference)));
        // SAFETY: as above.
        unsafe { fmi2SetInteger(self.component, &reference, 1, &value) }
    }

    pub(crate) fn set_boolean(&self, reference: ValueReference, value: i32) -> Status {
        enter("fmi2SetBoolean");
        tell(|| format!("{} = {value}", name_of(reference)));
        // SAFETY: as above.
        unsafe { fmi2SetBoolean(self.component, &reference, 1, &value) }
    }

    /// `fmi2GetReal` into an array of exactly as many elements.
    pub(crate) fn get_reals(&self, references: &[ValueReference]) -> Result<Vec<f64>, Status> {
        debug_assert!(references.len() <= COUNT);
        let mut values = vec![f64::NAN; references.len()];
        // SAFETY: as above.
        let status =
            unsafe { call!(fmi2GetReal(self.component, references.as_ptr(), references.len(), values.as_mut_ptr())) };
        if status == Status::Ok { Ok(values) } else { Err(status) }
    }

    pub(crate) fn limits(&self) -> i32 {
        let mut limits = 0;
        // SAFETY: as above.
        let _ = unsafe { fmi2GetInteger(self.component, &reference("limit_reached"), 1, &mut limits) };
        limits
    }

    pub(crate) fn save(&self, state: &mut FmuState) -> Status {
        // SAFETY: the place is there, here and below.
        unsafe { call!(fmi2GetFMUstate(self.component, state)) }
    }

    pub(crate) fn restore(&self, state: FmuState) -> Status {
        // SAFETY: as above.
        unsafe { call!(fmi2SetFMUstate(self.component, state)) }
    }

    pub(crate) fn free(&self, state: &mut FmuState) -> Status {
        // SAFETY: as above.
        unsafe { call!(fmi2FreeFMUstate(self.component, state)) }
    }

    pub(crate) fn serialize(&self, state: FmuState) -> Result<Vec<u8>, Status> {
        enter("fmi2SerializeFMUstate");
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

    pub(crate) fn deserialize(&self, bytes: &[u8]) -> Result<FmuState, Status> {
        let mut state = ptr::null_mut();
        // SAFETY: the array is as long as told, the place is there.
        let status =
            unsafe { call!(fmi2DeSerializeFMUstate(self.component, bytes.as_ptr().cast(), bytes.len(), &mut state)) };
        if status == Status::Ok { Ok(state) } else { Err(status) }
    }

    /// The instance's state as bytes; empty where it gives none.
    pub(crate) fn bytes(&self) -> Vec<u8> {
        let mut state = ptr::null_mut();
        if self.save(&mut state) != Status::Ok {
            return Vec::new();
        }
        let bytes = self.serialize(state).unwrap_or_default();
        let _ = self.free(&mut state);
        bytes
    }
}

impl Drop for Importer {
    fn drop(&mut self) {
        call!(fmi2FreeInstance(self.component));
    }
}

/// Bytes of a serialised state before the GUID; the layout stands in the library's module on states.
const HEADER: usize = 20;
const CHECKSUM: core::ops::Range<usize> = 12..20;

/// The bytes without the phase and the checksum, which a failed step changes.
pub(crate) fn without_phase(mut bytes: Vec<u8>) -> Vec<u8> {
    let phase = HEADER + guid_length(&bytes);
    if phase < bytes.len() {
        bytes[phase] = 0;
        bytes[CHECKSUM].fill(0);
    }
    bytes
}

/// Length of the GUID in the bytes of a state.
pub(crate) fn guid_length(bytes: &[u8]) -> usize {
    bytes.get(6..8).map_or(0, |length| usize::from(u16::from_le_bytes([length[0], length[1]])))
}

/// Makes length and checksum of the header fit the bytes, so that a damaged state passes for a whole one.
pub(crate) fn forge(bytes: &mut [u8]) {
    if bytes.len() < HEADER {
        return;
    }
    let payload = bytes.len().saturating_sub(HEADER + guid_length(bytes)) as u32;
    bytes[8..12].copy_from_slice(&payload.to_le_bytes());
    let covered = bytes[..CHECKSUM.start].iter().chain(&bytes[CHECKSUM.end..]).copied();
    let sum = scene::fnv::Fnv::of(covered).0;
    bytes[CHECKSUM].copy_from_slice(&sum.to_le_bytes());
}
