//! Processor time, for the charts and benchmarks.

/// Processor time of this thread, s; wall time where the system does not provide it.
pub fn processor_seconds() -> f64 {
    seconds(Clock::Thread)
}

/// Processor time of all threads, s: what an initialisation takes, which runs on a thread of its own; wall time where the system
/// does not provide it.
pub fn process_seconds() -> f64 {
    seconds(Clock::Process)
}

#[derive(Clone, Copy)]
enum Clock {
    Thread,
    Process,
}

#[cfg(unix)]
fn seconds(clock: Clock) -> f64 {
    let clock = match clock {
        Clock::Thread => libc::CLOCK_THREAD_CPUTIME_ID,
        Clock::Process => libc::CLOCK_PROCESS_CPUTIME_ID,
    };
    let mut time = libc::timespec { tv_sec: 0, tv_nsec: 0 };
    // SAFETY: the clock writes the structure, which outlives the call.
    unsafe { libc::clock_gettime(clock, &mut time) };
    time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64
}

#[cfg(not(unix))]
fn seconds(_: Clock) -> f64 {
    static BEGIN: std::sync::OnceLock<std::time::Instant> = std::sync::OnceLock::new();
    BEGIN.get_or_init(std::time::Instant::now).elapsed().as_secs_f64()
}
