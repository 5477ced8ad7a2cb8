//! The C interface of the host library, for Python's ctypes and the like.
//!
//! ```c
//! typedef struct Worker Worker;
//! uint32_t host_interface_version(void);
//! Worker  *host_open(const char *folder, char *message, size_t capacity);   // NULL: message says why
//! void     host_close(Worker *worker);
//! int32_t  host_unit(const Worker *worker, const char *name, char *message, size_t capacity);
//! int32_t  run_schedule(Worker *worker, const Request *request, double *outputs, const bool *stop, char *message, size_t capacity);
//! ```
//!
//! Texts are UTF-8 and end with a zero. `message` takes a text of at most `capacity` bytes, its zero included; it may
//! be NULL. A run ends after its communication step where another thread sets `stop`, which may be NULL. Results: 0 success, else the number of a [`Stage`]; then nothing in `outputs` is meant. A worker must not
//! be used by two threads concurrently, and not in a process forked from the one that opened it.

use crate::error::{Failure, Stage};
use crate::scene::{Scene, Span};
use crate::schedule::{Interpolation, Schedule};
use crate::worker::Worker;
use std::ffi::{CStr, c_char};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::{ptr, slice};

/// Changes with the layout of [`Request`] and the meaning of any argument.
pub(crate) const INTERFACE_VERSION: u32 = 2;

/// A scene in C layout. Arrays of length 0 may be NULL.
#[repr(C)]
pub struct Request {
    /// Number of parameters that are set.
    pub parameter_count: usize,
    /// Their names.
    pub parameter_names: *const *const c_char,
    /// Their values; items of enumerations and Booleans as numbers.
    pub parameter_values: *const f64,
    /// Number of inputs that the schedule drives.
    pub input_count: usize,
    /// Their names.
    pub input_names: *const *const c_char,
    /// Factors on their columns; NULL: 1.
    pub input_factors: *const f64,
    /// Rows of the schedule.
    pub row_count: usize,
    /// Their times, s, increasing.
    pub times: *const f64,
    /// `row_count` rows of `input_count` values.
    pub values: *const f64,
    /// 0 hold, 1 sample, 2 linear: see [`Interpolation`].
    pub interpolation: u32,
    /// First communication point, s.
    pub start: f64,
    /// Last communication point, s.
    pub stop: f64,
    /// Communication step, s.
    pub step: f64,
    /// Relative tolerance for the FMU; 0: its own.
    pub tolerance: f64,
    /// Number of variables that are recorded.
    pub output_count: usize,
    /// Their names.
    pub output_names: *const *const c_char,
    /// Number of communication points to record at.
    pub point_count: usize,
    /// Their times, s, increasing.
    pub points: *const f64,
}

/// `INTERFACE_VERSION`, for the caller to compare with its own.
#[unsafe(no_mangle)]
pub extern "C" fn host_interface_version() -> u32 {
    INTERFACE_VERSION
}

/// Loads the FMU unpacked into `folder`; NULL where that fails.
///
/// # Safety
/// `folder` is a text; `message` has room for `capacity` bytes or is NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn host_open(folder: *const c_char, message: *mut c_char, capacity: usize) -> *mut Worker {
    let mut opened = ptr::null_mut();
    // SAFETY: as the caller promises.
    let work = || {
        let folder = unsafe { text(folder, "folder") }?;
        opened = Box::into_raw(Box::new(Worker::open(Path::new(folder))?));
        Ok(())
    };
    // SAFETY: as the caller promises.
    unsafe { answer(message, capacity, work) };
    opened
}

/// Frees a worker of [`host_open`]; NULL is ignored.
///
/// # Safety
/// `worker` came from [`host_open`] and is not used any more.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn host_close(worker: *mut Worker) {
    if !worker.is_null() {
        // A panic in a destructor cannot be reported.
        // SAFETY: as the caller promises.
        let _ = catch_unwind(AssertUnwindSafe(|| drop(unsafe { Box::from_raw(worker) })));
    }
}

/// Writes the unit of a variable to `message`: `1` where it has none.
///
/// # Safety
/// `worker` came from [`host_open`]; `name` is a text; `message` has room for `capacity` bytes or is NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn host_unit(
    worker: *const Worker,
    name: *const c_char,
    message: *mut c_char,
    capacity: usize,
) -> i32 {
    let mut unit = String::new();
    let work = || {
        // SAFETY: as the caller promises; so below.
        let worker = unsafe { worker.as_ref() }.ok_or_else(|| Failure::request("worker is NULL"))?;
        let variable = worker.description().find(unsafe { text(name, "name") }?)?;
        unit = if variable.unit.is_empty() { "1".to_owned() } else { variable.unit.clone() };
        Ok(())
    };
    // SAFETY: as the caller promises.
    unsafe {
        let result = answer(message, capacity, work);
        if result == 0 {
            write(message, capacity, &unit);
        }
        result
    }
}

/// Runs one scene. `outputs` takes `point_count` rows of `output_count` values.
///
/// # Safety
/// `worker` came from [`host_open`]; all arrays have the lengths that `request` gives; `outputs` has room for the
/// result; `stop` is there meanwhile or is NULL; `message` has room for `capacity` bytes or is NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn run_schedule(
    worker: *mut Worker,
    request: *const Request,
    outputs: *mut f64,
    stop: *const AtomicBool,
    message: *mut c_char,
    capacity: usize,
) -> i32 {
    let work = || {
        // SAFETY: as the caller promises; so below.
        let worker = unsafe { worker.as_mut() }.ok_or_else(|| Failure::request("worker is NULL"))?;
        let request = unsafe { request.as_ref() }.ok_or_else(|| Failure::request("request is NULL"))?;
        let stop = unsafe { stop.as_ref() };
        let recorded = unsafe { run(worker, request, stop) }?;
        if !recorded.is_empty() {
            if outputs.is_null() {
                return Err(Failure::request("outputs is NULL"));
            }
            // SAFETY: as the caller promises, for as many numbers as the request records.
            unsafe { ptr::copy_nonoverlapping(recorded.as_ptr(), outputs, recorded.len()) };
        }
        Ok(())
    };
    // SAFETY: as the caller promises.
    unsafe { answer(message, capacity, work) }
}

/// # Safety
/// As [`run_schedule`].
unsafe fn run(worker: &mut Worker, request: &Request, stop: Option<&AtomicBool>) -> Result<Vec<f64>, Failure> {
    // SAFETY: as the caller promises.
    unsafe {
        let names = texts(request.parameter_names, request.parameter_count, "parameter_names")?;
        let values = array(request.parameter_values, request.parameter_count, "parameter_values")?;
        let parameters: Vec<(&str, f64)> = names.into_iter().zip(values.iter().copied()).collect();
        let inputs = texts(request.input_names, request.input_count, "input_names")?;
        let factors = match request.input_factors.is_null() {
            true => &[],
            false => array(request.input_factors, request.input_count, "input_factors")?,
        };
        let times = array(request.times, request.row_count, "times")?;
        let count = request.row_count.checked_mul(request.input_count);
        let count = count.ok_or_else(|| Failure::request("row_count times input_count is too large"))?;
        let interpolation = Interpolation::of_number(request.interpolation)
            .ok_or_else(|| Failure::request(format!("interpolation = {} must be 0, 1 or 2", request.interpolation)))?;
        let scene = Scene {
            parameters: &parameters,
            schedule: Schedule::new(times, array(request.values, count, "values")?, inputs.len())?,
            inputs: &inputs,
            factors,
            interpolation,
            span: Span { start: request.start, stop: request.stop, step: request.step },
            tolerance: (request.tolerance != 0.0).then_some(request.tolerance),
            outputs: &texts(request.output_names, request.output_count, "output_names")?,
            points: array(request.points, request.point_count, "points")?,
        };
        worker.run_until(&scene, stop)
    }
}

/// Does the work, converts a panic into a failure and writes the reason.
///
/// # Safety
/// `message` has room for `capacity` bytes or is NULL.
unsafe fn answer(message: *mut c_char, capacity: usize, work: impl FnOnce() -> Result<(), Failure>) -> i32 {
    let result = catch_unwind(AssertUnwindSafe(work))
        .unwrap_or_else(|_| Err(Failure::new(Stage::Library, "the host itself failed; please report this scene")));
    match result {
        Ok(()) => 0,
        Err(failure) => {
            // SAFETY: as the caller promises.
            unsafe { write(message, capacity, &failure.reason) };
            failure.stage as i32
        }
    }
}

/// Copies a text, cut at a character where it is too long.
///
/// # Safety
/// `to` has room for `capacity` bytes or is NULL.
unsafe fn write(to: *mut c_char, capacity: usize, text: &str) {
    if to.is_null() || capacity == 0 {
        return;
    }
    let text = &text[..text.floor_char_boundary(capacity - 1)];
    // SAFETY: one byte is left for the zero.
    unsafe {
        ptr::copy_nonoverlapping(text.as_ptr(), to.cast::<u8>(), text.len());
        *to.add(text.len()) = 0;
    }
}

/// # Safety
/// `from` is a text or NULL.
unsafe fn text<'a>(from: *const c_char, what: &str) -> Result<&'a str, Failure> {
    if from.is_null() {
        return Err(Failure::request(format!("{what} is NULL")));
    }
    // SAFETY: as the caller promises.
    let text = unsafe { CStr::from_ptr(from) };
    text.to_str().map_err(|_| Failure::request(format!("{what} {text:?} is not UTF-8")))
}

/// # Safety
/// `from` is an array of `count` or NULL.
unsafe fn array<'a, T>(from: *const T, count: usize, what: &str) -> Result<&'a [T], Failure> {
    match (count, from.is_null()) {
        (0, _) => Ok(&[]),
        (_, true) => Err(Failure::request(format!("{what} is NULL"))),
        // SAFETY: as the caller promises.
        (_, false) => Ok(unsafe { slice::from_raw_parts(from, count) }),
    }
}

/// # Safety
/// `from` is an array of `count` texts or NULL.
unsafe fn texts<'a>(from: *const *const c_char, count: usize, what: &str) -> Result<Vec<&'a str>, Failure> {
    // SAFETY: as the caller promises.
    unsafe { array(from, count, what)?.iter().map(|&entry| text(entry, what)).collect() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn told(buffer: &[c_char]) -> String {
        // SAFETY: every text written ends with a zero.
        unsafe { CStr::from_ptr(buffer.as_ptr()) }.to_str().unwrap().to_owned()
    }

    #[test]
    fn what_cannot_be_opened_says_why() {
        let mut message = [1; 200];
        // SAFETY: the buffer has the length given.
        let opened = unsafe { host_open(c"/nonexistent".as_ptr(), message.as_mut_ptr(), message.len()) };
        assert!(opened.is_null());
        assert!(told(&message).contains("/nonexistent/modelDescription.xml"), "{}", told(&message));
        // SAFETY: NULL is allowed for both.
        assert!(unsafe { host_open(ptr::null(), ptr::null_mut(), 0) }.is_null());
    }

    #[test]
    fn null_workers_are_refused() {
        let mut message = [1; 20];
        // SAFETY: NULL is allowed for the worker.
        let status = unsafe {
            run_schedule(
                ptr::null_mut(),
                ptr::null(),
                ptr::null_mut(),
                ptr::null(),
                message.as_mut_ptr(),
                message.len(),
            )
        };
        assert_eq!((status, told(&message).as_str()), (Stage::Request as i32, "worker is NULL"));
        // SAFETY: NULL is allowed.
        unsafe { host_close(ptr::null_mut()) };
    }

    #[test]
    fn messages_are_cut_to_their_room() {
        let mut message = [1; 4];
        // SAFETY: the buffer has the length given.
        unsafe { write(message.as_mut_ptr(), message.len(), "aéé") };
        assert_eq!(told(&message), "aé");
    }

    #[test]
    fn a_panic_is_a_failure() {
        let mut message = [1; 80];
        // SAFETY: the buffer has the length given.
        let status = unsafe { answer(message.as_mut_ptr(), message.len(), || panic!("on purpose")) };
        assert_eq!(status, Stage::Library as i32);
    }
}
