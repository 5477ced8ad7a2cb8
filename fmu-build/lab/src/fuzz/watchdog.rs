//! Time limit of a call, and the place where a call that never returns is told from.

use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// Running call: function and since when.
static RUNNING: Mutex<Option<(&'static str, Instant)>> = Mutex::new(None);
static CALLS: AtomicU64 = AtomicU64::new(0);
/// Whether every call is printed.
static TRACED: AtomicBool = AtomicBool::new(false);
/// How often the running call is looked at.
const PERIOD: Duration = Duration::from_millis(200);

/// Notes that `function` begins, and that the one before it has ended.
pub(crate) fn enter(function: &'static str) {
    CALLS.fetch_add(1, Ordering::Relaxed);
    if let Ok(mut running) = RUNNING.lock() {
        *running = Some((function, Instant::now()));
    }
    if TRACED.load(Ordering::Relaxed) {
        eprintln!("  {function}");
    }
}

/// Calls a function of the library, having noted its name.
macro_rules! call {
    ($function:ident($($argument:expr),* $(,)?)) => {{
        $crate::fuzz::watchdog::enter(stringify!($function));
        $function($($argument),*)
    }};
}
pub(crate) use call;

pub(crate) fn calls() -> u64 {
    CALLS.load(Ordering::Relaxed)
}

/// The function that runs, or ran last.
pub(crate) fn last() -> &'static str {
    RUNNING.lock().ok().and_then(|running| *running).map_or("", |(function, _)| function)
}

/// Prints every call from here on.
pub(crate) fn trace() {
    TRACED.store(true, Ordering::Relaxed);
}

/// Prints what a call is given, where every call is printed.
pub(crate) fn tell(text: impl Fn() -> String) {
    if TRACED.load(Ordering::Relaxed) {
        eprintln!("    {}", text());
    }
}

/// Watches from a thread of its own; `overdue` is called with the function that has run for longer than `limit`.
pub(crate) fn start(limit: Duration, overdue: impl Fn(&'static str) + Send + 'static) {
    std::thread::spawn(move || {
        loop {
            std::thread::sleep(PERIOD);
            let running = RUNNING.lock().ok().and_then(|running| *running);
            if let Some((function, since)) = running
                && since.elapsed() > limit
            {
                overdue(function);
            }
        }
    });
}
