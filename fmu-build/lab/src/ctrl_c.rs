//! Ctrl-C ends work at its next checkpoint ([`numerics::interruption`]), so that what it has done is kept.

use anyhow::{Result, anyhow};
use fmu_build::output::{INTERRUPTED, Interrupted};
use numerics::interruption::interruptible;
use signal_hook::consts::SIGINT;
use signal_hook::flag::{register, register_conditional_shutdown};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// Does work that Ctrl-C ends; a second one ends the process.
pub(crate) fn attended<T>(work: impl FnOnce() -> Result<T>) -> Result<T> {
    // For the rest of the process: one command, one piece of work.
    let stop: &'static Arc<AtomicBool> = Box::leak(Box::default());
    // In this order: the first signal finds the flag not yet set.
    register_conditional_shutdown(SIGINT, i32::from(INTERRUPTED), stop.clone())?;
    register(SIGINT, stop.clone())?;
    let nothing = || Err(anyhow!(Interrupted("interrupted before there was a result".into())));
    interruptible(stop, work).unwrap_or_else(nothing)
}
