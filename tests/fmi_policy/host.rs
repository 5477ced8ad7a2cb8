//! Settings of the host's thread: floating-point traps, rounding, sticky flags and cancellation. A trap that fires inside a call, or a
//! cancellation that unwinds out of it, ends the process of this test.

use core::ffi::{c_char, c_int, c_void};
use std::ptr;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use sliding_contact::fmi2::exports::*;
use sliding_contact::fmi2::types::{self, CallbackFunctions, ComponentEnvironment, Status};
use test_support::importer::{Importer, as_logger, guid, references};

#[link(name = "m")]
unsafe extern "C" {
    fn feenableexcept(exceptions: c_int) -> c_int;
    fn fedisableexcept(exceptions: c_int) -> c_int;
    fn fegetexcept() -> c_int;
    fn fetestexcept(exceptions: c_int) -> c_int;
    fn feclearexcept(exceptions: c_int) -> c_int;
    fn feraiseexcept(exceptions: c_int) -> c_int;
    fn fesetround(mode: c_int) -> c_int;
    fn fegetround() -> c_int;
}

// Of <fenv.h>.
const DIVIDE_BY_ZERO: c_int = if cfg!(target_arch = "x86_64") { 4 } else { 2 };
const INVALID: c_int = 1;
const OVERFLOW: c_int = if cfg!(target_arch = "x86_64") { 8 } else { 4 };
const ALL: c_int = if cfg!(target_arch = "x86_64") { 0x3d } else { 0x1f };
const UPWARD: c_int = if cfg!(target_arch = "x86_64") { 0x800 } else { 0x40_0000 };

const LUMPED: i32 = 2;
const LINE: i32 = 3;

/// A life of a scene at a level: initialisation, slides, a stop and a released load, every variable read, a state saved, restored and
/// serialised, derivatives, a refused call. The bits of all that is read.
fn life(level: i32, between: &mut dyn FnMut()) -> Vec<u64> {
    let mut seen = Vec::new();
    let importer = Importer::new();
    between();
    assert_eq!(importer.set_integer("solver.fidelity", level), Status::Ok);
    if level == LINE {
        assert_eq!(importer.set_integer("solver.cells", 9), Status::Ok);
    }
    assert_eq!(importer.setup(None, 0.0, None), Status::Ok);
    assert_eq!(importer.enter(), Status::Ok);
    between();
    assert_eq!(importer.exit(), Status::Ok);
    between();
    let all: Vec<u32> = (0..20).collect();
    let outputs =
        references(&["contact_temperature", "wear_depth", "friction_force", "critical_speed", "pressure_max"]);
    let mut state = ptr::null_mut();
    for (index, (velocity, load)) in
        [(10.0, 2e3), (10.0, 1e3), (0.0, 1e3), (-1.0, 1e3), (5.0, 0.0)].into_iter().enumerate()
    {
        assert_eq!(importer.set_real(&["sliding_velocity", "normal_load"], &[velocity, load]), Status::Ok);
        assert_eq!(importer.step(index as f64 * 0.5, 0.5), Status::Ok);
        between();
        for references in [&all, &outputs] {
            seen.extend(importer.get_reals(references).unwrap().into_iter().map(f64::to_bits));
        }
        let _ = importer.directional_derivative("friction_force", "sliding_velocity", 1.0);
        if index == 1 {
            assert_eq!(importer.save(&mut state), Status::Ok);
        }
        between();
    }
    let bytes = importer.serialize(state).unwrap();
    let mut other = importer.deserialize(&bytes).unwrap();
    assert_eq!(importer.restore(other), Status::Ok);
    assert_eq!(importer.step(f64::NAN, 0.5), Status::Error);
    for state in [&mut state, &mut other] {
        assert_eq!(importer.free(state), Status::Ok);
    }
    assert_eq!(importer.reset(), Status::Ok);
    between();
    seen
}

/// Floating-point control and status register, for what <fenv.h> does not reach: subnormal numbers as 0.
#[cfg(target_arch = "x86_64")]
fn flush_subnormal_numbers(on: bool) {
    let mut register = 0_u32;
    // SAFETY: one word is stored and loaded, with two defined bits changed.
    unsafe {
        core::arch::asm!("stmxcsr [{}]", in(reg) &raw mut register);
        register = if on { register | 0x8040 } else { register & !0x8040 };
        core::arch::asm!("ldmxcsr [{}]", in(reg) &raw const register);
    }
}

#[test]
fn traps_of_the_host_neither_fire_inside_nor_are_changed() {
    for level in [LUMPED, LINE] {
        let plain = life(level, &mut || ());
        let traps = DIVIDE_BY_ZERO | INVALID | OVERFLOW;
        // SAFETY: functions of the C library on this thread.
        let trapped = unsafe {
            feclearexcept(ALL);
            feenableexcept(traps);
            let trapped = life(level, &mut || {
                assert_eq!(fegetexcept(), traps);
                // The test itself only compares and copies.
                assert_eq!(fetestexcept(traps), 0);
            });
            fedisableexcept(traps);
            trapped
        };
        assert!(plain == trapped, "level {level}");
    }
}

#[test]
fn rounding_and_flags_of_the_host_are_neither_used_nor_changed() {
    for level in [LUMPED, LINE] {
        let plain = life(level, &mut || ());
        // SAFETY: functions of the C library on this thread.
        let rounded = unsafe {
            feclearexcept(ALL);
            feraiseexcept(DIVIDE_BY_ZERO);
            fesetround(UPWARD);
            #[cfg(target_arch = "x86_64")]
            flush_subnormal_numbers(true);
            let rounded = life(level, &mut || {
                assert_eq!(fegetround(), UPWARD);
                assert_eq!(fetestexcept(DIVIDE_BY_ZERO | INVALID | OVERFLOW), DIVIDE_BY_ZERO);
            });
            #[cfg(target_arch = "x86_64")]
            flush_subnormal_numbers(false);
            fesetround(0);
            feclearexcept(ALL);
            rounded
        };
        assert!(plain == rounded, "level {level}");
    }
}

// `C-unwind`: a cancelled thread is unwound from here.
unsafe extern "C-unwind" {
    fn pthread_testcancel();
    fn usleep(microseconds: u32) -> c_int;
    fn pthread_cancel(thread: libc::pthread_t) -> c_int;
}

/// A logger with a cancellation point, as every one that prints has, and whether it came to its end.
unsafe extern "C" fn wait_in_logger(
    environment: ComponentEnvironment,
    _: types::String,
    _: Status,
    _: types::String,
    _: types::String,
    _: *const c_char,
) {
    // SAFETY: the environment is the flag of the test.
    unsafe {
        pthread_testcancel();
        (*environment.cast::<AtomicBool>()).store(true, Ordering::Release);
    }
}

unsafe extern "C-unwind" fn fail_with_a_message(component: *mut c_void) -> *mut c_void {
    // SAFETY: the caller waits for the end of this thread.
    unsafe {
        pthread_cancel(libc::pthread_self());
        fmi2DoStep(component, 0.0, 0.1, 0);
        loop {
            pthread_testcancel();
        }
    }
}

#[test]
fn a_host_thread_cancelled_before_it_is_told_of_an_error_ends_after_the_call() {
    let logged = AtomicBool::new(false);
    let callbacks = CallbackFunctions {
        logger: Some(as_logger(wait_in_logger)),
        allocate_memory: None,
        free_memory: None,
        step_finished: None,
        component_environment: ptr::from_ref(&logged).cast_mut().cast(),
    };
    // SAFETY: strings, structure and flag live through the calls.
    unsafe {
        let (name, guid) = (c"host".as_ptr(), guid());
        let component = fmi2Instantiate(name, types::CO_SIMULATION, guid.as_ptr(), ptr::null(), &callbacks, 0, 0);
        assert_eq!(run_cancelled(fail_with_a_message, component, |_| ()), CANCELLED);
        assert!(logged.load(Ordering::Acquire));
        assert_eq!(fmi2Reset(component), Status::Ok);
        fmi2FreeInstance(component);
    }
}

/// `PTHREAD_CANCELED`
const CANCELLED: isize = -1;

type Start = unsafe extern "C-unwind" fn(*mut c_void) -> *mut c_void;

/// Result of a thread of the system that was ended by `end`.
unsafe fn run_cancelled(start: Start, argument: *mut c_void, end: impl FnOnce(libc::pthread_t)) -> isize {
    let mut thread = core::mem::MaybeUninit::uninit();
    let mut result = ptr::null_mut();
    // SAFETY: the thread is joined; unwinding ends in the C library's start of the thread.
    unsafe {
        let start = core::mem::transmute::<Start, extern "C" fn(*mut c_void) -> *mut c_void>(start);
        assert_eq!(libc::pthread_create(thread.as_mut_ptr(), ptr::null(), start, argument), 0);
        end(thread.assume_init());
        assert_eq!(libc::pthread_join(thread.assume_init(), &raw mut result), 0);
    }
    result as isize
}

/// What a host thread shares with the one that cancels it.
struct Shared {
    component: *mut c_void,
    begun: AtomicBool,
    status: AtomicUsize,
}

/// Ends the initialisation of an instance, and waits to be cancelled. No value of this function has a destructor.
unsafe extern "C-unwind" fn initialise(shared: *mut c_void) -> *mut c_void {
    // SAFETY: the caller waits for the end of this thread.
    unsafe {
        let shared = &*shared.cast::<Shared>();
        shared.begun.store(true, Ordering::Release);
        let status = fmi2ExitInitializationMode(shared.component);
        shared.status.store(status as usize, Ordering::Release);
        loop {
            pthread_testcancel();
            usleep(1000);
        }
    }
}

#[test]
fn a_host_thread_cancelled_while_it_initialises_a_line_ends_after_the_call() {
    const PENDING: usize = usize::MAX;
    for delay in [0, 200, 2_000, 20_000] {
        let importer = Importer::new();
        assert_eq!(importer.set_integer("solver.fidelity", LINE), Status::Ok);
        assert_eq!(importer.set_integer("solver.cells", 33), Status::Ok);
        assert_eq!(importer.setup(None, 0.0, None), Status::Ok);
        assert_eq!(importer.enter(), Status::Ok);
        let shared =
            Shared { component: importer.component, begun: AtomicBool::new(false), status: AtomicUsize::new(PENDING) };
        let argument = ptr::from_ref(&shared).cast_mut().cast();
        // SAFETY: `shared` outlives the thread.
        let result = unsafe {
            run_cancelled(initialise, argument, |thread| {
                while !shared.begun.load(Ordering::Acquire) {
                    std::thread::yield_now();
                }
                usleep(delay);
                assert_eq!(pthread_cancel(thread), 0);
            })
        };
        assert_eq!(result, CANCELLED);
        assert_eq!(shared.status.load(Ordering::Acquire), Status::Ok as usize, "{delay} us");
        assert_eq!(importer.step(0.0, 0.1), Status::Ok);
    }
}
