//! Panics: caught, kept off the error stream, and told with their place; work on a thread of its own, and code of the importer.
//!
//! A panic is a defect of this library. Panics are kept off stderr by a hook that reads a thread-local flag, set only here, and
//! passes every other panic on to the previous hook. (Inside an importer the library has a standard library, and so a hook, of its
//! own; in a Rust program that links the crate the hook is shared.)

use core::cell::Cell;
use std::io::Write;
use std::panic::{self, AssertUnwindSafe, PanicHookInfo};
use std::sync::OnceLock;

/// Source location of the last panic: bytes of text and their number. Not a `String`, because a thread-local
/// value with a destructor would keep the library from being unloaded before the thread ends.
type PanicLocation = ([u8; 120], usize);

const NOWHERE: PanicLocation = ([0; 120], 0);

thread_local! {
    static INSIDE: Cell<bool> = const { Cell::new(false) };
    static PLACE: Cell<PanicLocation> = const { Cell::new(NOWHERE) };
}

type Hook = Box<dyn Fn(&PanicHookInfo<'_>) + Send + Sync>;

/// A panic hook that keeps this library's own panics quiet and leaves all others to `previous`.
fn quiet(previous: impl Fn(&PanicHookInfo<'_>)) -> impl Fn(&PanicHookInfo<'_>) {
    move |info| {
        if !INSIDE.get() {
            return previous(info);
        }
        let mut text = [0; 120];
        let mut rest = &mut text[..];
        if let Some(location) = info.location() {
            // Cut off where the buffer ends.
            let _ = write!(rest, " ({location})");
        }
        let free = rest.len();
        PLACE.set((text, text.len() - free));
    }
}

/// Installs the hook, once. It captures nothing: memory that a hook holds is lost when an importer unloads the library.
pub(crate) fn install_hook() {
    static PREVIOUS: OnceLock<Hook> = OnceLock::new();
    PREVIOUS.get_or_init(|| {
        let previous = panic::take_hook();
        panic::set_hook(Box::new(quiet(|info| {
            if let Some(previous) = PREVIOUS.get() {
                previous(info);
            }
        })));
        previous
    });
}

/// Runs `body`; a panic in it becomes an `Err` with its message and place.
#[inline(always)]
pub(crate) fn catch<T>(body: impl FnOnce() -> T) -> Result<T, String> {
    let before = INSIDE.replace(true);
    let result = panic::catch_unwind(AssertUnwindSafe(body));
    INSIDE.set(before);
    result.map_err(|payload| {
        let message = match (payload.downcast_ref::<&str>(), payload.downcast_ref::<String>()) {
            (Some(text), _) => text,
            (_, Some(text)) => text.as_str(),
            _ => "no message",
        };
        let (place, length) = PLACE.replace(NOWHERE);
        format!("defect of this FMU, please report: {message}{}", String::from_utf8_lossy(&place[..length]))
    })
}

/// Runs code of the importer. Panics in it, if it is written in Rust, are not silenced. A cancellation acts after the call: a thread that
/// is unwound out of it would leave an instance half changed.
pub(crate) fn outside(body: impl FnOnce()) {
    let _uncancelled = cancellation::Disabled::new();
    let before = INSIDE.replace(false);
    body();
    INSIDE.set(before);
}

/// Runs `body` on a thread that has ended when this returns; in place where the system gives none. A panic goes on here, a
/// cancellation does not act before the end: the other thread writes to the stack of this one.
///
/// The dense products of the operators keep buffers in thread-local values with destructors. As long as such a value lives in a
/// thread of the importer, the library stays mapped although it was unloaded. (`std::thread` leaves such values in the thread that
/// calls it, too, hence the thread of the system.) Elsewhere than on Unix they are lost with the library.
pub(crate) fn on_own_thread<T: Send>(body: impl FnOnce() -> T + Send) -> T {
    let _uncancelled = cancellation::Disabled::new();
    let is_inside = INSIDE.get();
    let outcome = system::run(move || {
        INSIDE.set(is_inside);
        let result = panic::catch_unwind(AssertUnwindSafe(body));
        (result, PLACE.replace(NOWHERE))
    });
    match outcome {
        (Ok(value), _) => value,
        (Err(payload), place) => {
            PLACE.set(place);
            panic::resume_unwind(payload)
        }
    }
}

#[cfg(any(target_os = "linux", target_vendor = "apple", target_os = "freebsd"))]
mod cancellation {
    use core::ffi::c_int;

    unsafe extern "C" {
        fn pthread_setcancelstate(state: c_int, old: *mut c_int) -> c_int;
    }

    /// `PTHREAD_CANCEL_DISABLE`
    const DISABLE: c_int = if cfg!(target_vendor = "apple") { 0 } else { 1 };

    /// While this lives `pthread_cancel` of this thread does not act. What may wait stands behind it: the importer's functions, and the
    /// end of another thread.
    pub(crate) struct Disabled(c_int);

    impl Disabled {
        pub(crate) fn new() -> Disabled {
            let mut before = DISABLE;
            // SAFETY: the value of the platform, and a place for the old one.
            unsafe { pthread_setcancelstate(DISABLE, &raw mut before) };
            Disabled(before)
        }
    }

    impl Drop for Disabled {
        fn drop(&mut self) {
            // SAFETY: the state was given by this function, which is no cancellation point.
            unsafe { pthread_setcancelstate(self.0, &raw mut self.0) };
        }
    }
}

#[cfg(not(any(target_os = "linux", target_vendor = "apple", target_os = "freebsd")))]
mod cancellation {
    /// Threads of these platforms cannot be cancelled.
    struct Disabled;

    impl Disabled {
        pub(crate) fn new() -> Disabled {
            Disabled
        }
    }
}

#[cfg(unix)]
mod system {
    use core::ffi::c_void;
    use core::ptr;

    /// Work of the thread, and its result.
    struct Work<F, T> {
        body: Option<F>,
        result: Option<T>,
    }

    impl<F: FnOnce() -> T, T> Work<F, T> {
        fn perform(&mut self) {
            self.result = self.body.take().map(|body| body());
        }
    }

    extern "C" fn perform<F: FnOnce() -> T, T>(work: *mut c_void) -> *mut c_void {
        // SAFETY: `run` gives a `Work` of these types, which nothing else uses until this thread has ended.
        unsafe { &mut *work.cast::<Work<F, T>>() }.perform();
        ptr::null_mut()
    }

    /// Runs `body`, which does not panic, on a thread of its own.
    pub(crate) fn run<F: FnOnce() -> T + Send, T: Send>(body: F) -> T {
        let mut work = Work { body: Some(body), result: None };
        let mut thread = core::mem::MaybeUninit::uninit();
        // SAFETY: `work` is there until the thread has ended, and is not used by this one before. Both of its parts may move between
        // threads. The thread is joined where, and only where, it was created.
        unsafe {
            let argument = ptr::from_mut(&mut work).cast::<c_void>();
            if libc::pthread_create(thread.as_mut_ptr(), ptr::null(), perform::<F, T>, argument) == 0 {
                libc::pthread_join(thread.assume_init(), ptr::null_mut());
            }
        }
        if work.result.is_none() {
            work.perform();
        }
        work.result.expect("the work is done")
    }
}

#[cfg(not(unix))]
mod system {
    pub(crate) fn run<T>(body: impl FnOnce() -> T) -> T {
        body()
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use std::sync::atomic::{AtomicUsize, Ordering};
    use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

    /// The hook belongs to the whole process: tests that panic take turns.
    pub(crate) fn turn() -> MutexGuard<'static, ()> {
        static TURN: Mutex<()> = Mutex::new(());
        install_hook();
        TURN.lock().unwrap_or_else(PoisonError::into_inner)
    }

    #[test]
    fn the_hook_is_quiet_inside_and_passes_on_what_happens_outside() {
        let _turn = turn();
        let heard = Arc::new(AtomicUsize::new(0));
        let (counter, here) = (heard.clone(), std::thread::current().id());
        let before = panic::take_hook();
        panic::set_hook(Box::new(quiet(move |_| {
            if std::thread::current().id() == here {
                counter.fetch_add(1, Ordering::Relaxed);
            }
        })));
        assert!(catch(|| panic!("inside")).unwrap_err().contains("inside"));
        assert_eq!(heard.load(Ordering::Relaxed), 0);
        // An importer's callback that panics is not ours.
        assert!(catch(|| outside(|| panic!("callback"))).is_err());
        assert_eq!(heard.load(Ordering::Relaxed), 1);
        assert!(!INSIDE.get());
        assert!(panic::catch_unwind(|| panic!("outside")).is_err());
        assert_eq!(heard.load(Ordering::Relaxed), 2);
        panic::set_hook(before);
    }

    #[test]
    fn work_is_done_on_a_thread_that_has_ended() {
        let here = std::thread::current().id();
        let (there, value) = on_own_thread(|| (std::thread::current().id(), 6 * 7));
        assert_eq!(value, 42);
        assert_eq!(there != here, cfg!(unix));
        let borrowed = [1, 2, 3];
        assert_eq!(on_own_thread(|| borrowed.iter().sum::<i32>()), 6);
    }

    #[test]
    fn a_panic_on_the_other_thread_is_told_with_its_place() {
        let _turn = turn();
        let text = catch(|| on_own_thread(|| panic!("over there"))).unwrap_err();
        assert!(text.contains("please report: over there") && text.contains("panics.rs:"), "{text}");
        assert_eq!(catch(|| on_own_thread(|| INSIDE.get())), Ok(true), "quiet there as here");
        assert!(!on_own_thread(|| INSIDE.get()));
    }
}
