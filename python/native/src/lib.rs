//! The native library of the Python package: analyses of a scene, and the host that runs FMUs ([`fmu_host::c_interface`]).
//!
//! ```c
//! typedef struct Answer Answer;
//! typedef struct { bool stop; double part; } Control;
//! uint32_t      native_interface_version(void);
//! Answer       *native_analyse(const char *request, const Answer *run, Control *control);
//! uint32_t      native_status(const Answer *answer);   // 0 success, 1 refused, 2 a step failed, 3 stopped
//! const char   *native_text(const Answer *answer);     // JSON; of status 1 the reason; of status 3 what was done, or null
//! size_t        native_arrays(const Answer *answer);
//! const double *native_array(const Answer *answer, size_t index, size_t *length);
//! void          native_free(Answer *answer);
//! ```
//!
//! A request is a JSON object whose `analysis` names one of [`Request`]. What is long comes as arrays of double, which live as long as
//! the answer. `run` is the answer of a simulation, for what follows from it, else NULL. While the call lasts another thread may read in
//! `control` the part that is done, and end the work within about a second by setting `stop`; it may be NULL. Functions may be called from
//! any number of threads; an answer must not be freed while another thread reads it.

mod request;

pub use fmu_host::c_interface;
use numerics::interruption::interruptible;
use request::{Request, Run};
use std::ffi::{CStr, CString, c_char};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::ptr;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// Changes with the meaning of any argument, request or result.
pub(crate) const INTERFACE_VERSION: u32 = 3;

/// What another thread shares with the work of a request.
#[repr(C)]
#[derive(Default, Debug)]
pub struct Control {
    /// Whether the work is to end.
    stop: AtomicBool,
    /// Bits of the part that is done, from 0 to 1.
    part: AtomicU64,
}

impl Control {
    /// Notes the part that is done.
    fn reached(&self, part: f64) {
        self.part.store(part.clamp(0.0, 1.0).to_bits(), Ordering::Relaxed);
    }
}

/// Status of an answer.
#[repr(u32)]
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Status {
    /// The result is complete.
    Success = 0,
    /// Nothing was computed; the text is the reason.
    Refused = 1,
    /// A run up to the step that failed.
    StepFailed = 2,
    /// The work was ended as [`Control`] requests it; what it had done is kept where it goes on in steps, levels or jumps.
    Stopped = 3,
}

/// Result of a request.
pub struct Answer {
    status: Status,
    text: CString,
    arrays: Vec<Vec<f64>>,
    run: Option<Run>,
}

impl Answer {
    fn refused(reason: &str) -> Self {
        Self { status: Status::Refused, text: c_text(reason), arrays: Vec::new(), run: None }
    }
}

/// A text without zeros within.
fn c_text(text: &str) -> CString {
    CString::new(text.replace('\0', " ")).unwrap_or_default()
}

/// [`INTERFACE_VERSION`], for the caller to compare with its own.
#[unsafe(no_mangle)]
pub extern "C" fn native_interface_version() -> u32 {
    INTERFACE_VERSION
}

/// Does what the request says. The answer is never NULL and is freed by [`native_free`].
///
/// # Safety
/// `request` is a text or NULL; `run` came from this function and is not freed meanwhile, or is NULL; so is `control` there meanwhile.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn native_analyse(
    request: *const c_char,
    run: *const Answer,
    control: *const Control,
) -> *mut Answer {
    let unused = Control::default();
    // SAFETY: the caller's promise; the work and its threads have ended when this function returns, and nothing keeps the reference.
    let control: &'static Control = unsafe { control.as_ref().unwrap_or(&*ptr::from_ref(&unused)) };
    let work = || {
        if request.is_null() {
            return Answer::refused("request is NULL");
        }
        // SAFETY: the caller's promise about its arguments.
        let text = unsafe { CStr::from_ptr(request) }.to_string_lossy();
        let run = unsafe { run.as_ref() }.and_then(|answer| answer.run.as_ref());
        let parsed: Result<Request, _> = serde_json::from_str(&text);
        match parsed.map_err(anyhow::Error::from).and_then(|request| request.answer(run, control)) {
            Ok(answer) => answer,
            Err(reason) => Answer::refused(&format!("{reason:#}")),
        }
    };
    let stopped = || Answer { status: Status::Stopped, ..Answer::refused("null") };
    let answer = catch_unwind(AssertUnwindSafe(|| interruptible(&control.stop, work).unwrap_or_else(stopped)))
        .unwrap_or_else(|_| Answer::refused("the library itself failed; please report this scene"));
    Box::into_raw(Box::new(answer))
}

/// Status of an answer: a number of [`Status`].
///
/// # Safety
/// `answer` came from [`native_analyse`] or is NULL; so below.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn native_status(answer: *const Answer) -> u32 {
    // SAFETY: the caller's promise that it is null or an answer that was not freed.
    unsafe { answer.as_ref() }.map_or(Status::Refused, |answer| answer.status) as u32
}

/// Text of an answer.
///
/// # Safety
/// As [`native_status`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn native_text(answer: *const Answer) -> *const c_char {
    // SAFETY: the caller's promise that it is null or an answer that was not freed.
    unsafe { answer.as_ref() }.map_or(ptr::null(), |answer| answer.text.as_ptr())
}

/// Number of arrays of an answer.
///
/// # Safety
/// As [`native_status`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn native_arrays(answer: *const Answer) -> usize {
    // SAFETY: the caller's promise that it is null or an answer that was not freed.
    unsafe { answer.as_ref() }.map_or(0, |answer| answer.arrays.len())
}

/// An array of an answer, and its length; NULL where there is none of this index.
///
/// # Safety
/// As [`native_status`]; `length` is a place for a number or NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn native_array(answer: *const Answer, index: usize, length: *mut usize) -> *const f64 {
    // SAFETY: the caller's promises about both pointers.
    let array = unsafe { answer.as_ref() }.and_then(|answer| answer.arrays.get(index));
    if let Some(length) = unsafe { length.as_mut() } {
        *length = array.map_or(0, Vec::len);
    }
    array.map_or(ptr::null(), |array| array.as_ptr())
}

/// Frees an answer; NULL is ignored.
///
/// # Safety
/// `answer` came from [`native_analyse`] and is not used any more.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn native_free(answer: *mut Answer) {
    if !answer.is_null() {
        // A panic in a destructor cannot be reported.
        // SAFETY: the caller's promise that it came from native_analyse and is not used any more.
        let _ = catch_unwind(AssertUnwindSafe(|| drop(unsafe { Box::from_raw(answer) })));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::{Duration, Instant};

    /// Status, text and arrays of a request about a shipped scene.
    fn asked(request: &str, control: Option<&Control>) -> (u32, String, Vec<Vec<f64>>) {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples");
        let request = CString::new(request.replace("FOLDER", folder)).unwrap();
        // SAFETY: texts and answers are those of these functions.
        unsafe {
            let answer = native_analyse(request.as_ptr(), ptr::null(), control.map_or(ptr::null(), ptr::from_ref));
            let text = CStr::from_ptr(native_text(answer)).to_str().unwrap().to_owned();
            let array = |index| {
                let mut length = 0;
                let first = native_array(answer, index, &raw mut length);
                std::slice::from_raw_parts(first, length).to_vec()
            };
            let arrays = (0..native_arrays(answer)).map(array).collect();
            let status = native_status(answer);
            native_free(answer);
            (status, text, arrays)
        }
    }

    const SIMULATE: &str = r#"{"analysis": "simulate", "scene": "disc_brake", "scenes": "FOLDER", "set": ["nominal.duration=1 s"],
        "inputs": null, "measured": null, "step": null, "at": []}"#;

    #[test]
    fn a_simulation_has_an_array_for_the_time_and_every_variable() {
        let (status, text, arrays) = asked(SIMULATE, None);
        assert_eq!(status, 0, "{text}");
        let record: serde_json::Value = serde_json::from_str(&text).unwrap();
        let names = record["channels"].as_array().unwrap();
        assert_eq!(arrays.len(), 1 + names.len() + 5);
        let position = names.iter().position(|channel| channel["name"] == "contact_temperature").unwrap();
        let rows = arrays[0].len();
        assert!(rows > 5 && arrays[1..=names.len()].iter().all(|array| array.len() == rows));
        assert_eq!(arrays[1 + position].last().copied(), record["variables"]["contact_temperature"]["end"].as_f64());
    }

    #[test]
    fn every_long_request_ends_soon_after_it_is_told_to() {
        let long = SIMULATE.replace("1 s\"", "20000 s\", \"solver.fidelity=line\", \"solver.cells=257\"");
        let scene = r#""scene": "reciprocating_punch", "scenes": "FOLDER", "set": []"#;
        let steady = format!(r#"{{"analysis": "steady", {scene}, "cells": 513, "return_speed": null, "cold": false}}"#);
        let cycles = format!(
            r#"{{"analysis": "cycles", {scene}, "cycles": 1e9, "tolerance": 1e-6, "cells": 257, "cold": false}}"#
        );
        let text = r#"{"text": "time [s],sliding_velocity [m/s],normal_load [N]\n0,10,4000\n1000,0,4000\n", "path": "stop", "columns": [], "strict": false}"#;
        let plan = format!(r#"{{"analysis": "plan", {scene}, "inputs": {text}, "tolerance": 1e-4}}"#)
            .replace("reciprocating_punch", "disc_brake");
        for request in [long, steady, cycles, plan] {
            let control = Control::default();
            let (told, status) = std::thread::scope(|scope| {
                let work = scope.spawn(|| {
                    let (status, ..) = asked(&request, Some(&control));
                    (Instant::now(), status)
                });
                std::thread::sleep(Duration::from_secs(1));
                assert!((0.0..1.0).contains(&f64::from_bits(control.part.load(Ordering::Relaxed))));
                let told = Instant::now();
                control.stop.store(true, Ordering::Relaxed);
                let (ended, status) = work.join().unwrap();
                (ended - told, status)
            });
            assert_eq!(status, Status::Stopped as u32, "{request}");
            assert!(told < Duration::from_secs(2), "{told:?}: {request}");
        }
    }

    #[test]
    fn what_is_refused_says_why() {
        for (request, reason) in [
            ("{}", "missing field `analysis`"),
            (r#"{"analysis": "names", "scenes": "FOLDER", "other": 1}"#, "other"),
            (
                r#"{"analysis": "scene", "scene": "disc_break", "scenes": "FOLDER", "set": []}"#,
                "one of clutch, disc_brake",
            ),
            (
                r#"{"analysis": "scene", "scene": "disc_brake", "scenes": "FOLDER", "set": ["punch.widht=1"]}"#,
                "punch.width",
            ),
            (r#"{"analysis": "figure", "measured": null}"#, "no simulation"),
        ] {
            let (status, text, _) = asked(request, None);
            assert_eq!(status, Status::Refused as u32, "{text}");
            assert!(text.contains(reason), "{text}");
        }
        // SAFETY: NULL is allowed.
        unsafe {
            let answer = native_analyse(ptr::null(), ptr::null(), ptr::null());
            assert_eq!(native_status(answer), 1);
            native_free(answer);
            native_free(ptr::null_mut());
            assert!(native_text(ptr::null()).is_null() && native_arrays(ptr::null()) == 0);
        }
    }
}
