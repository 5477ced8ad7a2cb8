//! Processor time, for the charts and benchmarks.

/// Processor time of all threads, s: what an initialisation takes, which runs on a thread of its own; wall time where the system
/// does not provide it.
#[cfg(unix)]
pub fn process_seconds() -> f64 {
    let mut time = libc::timespec { tv_sec: 0, tv_nsec: 0 };
    // SAFETY: the clock writes the structure, which outlives the call.
    unsafe { libc::clock_gettime(libc::CLOCK_PROCESS_CPUTIME_ID, &mut time) };
    time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64
}

/// Processor time of all threads, s.
#[cfg(not(unix))]
pub(crate) fn process_seconds() -> f64 {
    static BEGIN: std::sync::OnceLock<std::time::Instant> = std::sync::OnceLock::new();
    BEGIN.get_or_init(std::time::Instant::now).elapsed().as_secs_f64()
}
