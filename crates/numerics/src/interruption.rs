//! Ends long work on request.
//!
//! Whoever may want to end work runs it in [`interruptible`] with a flag that another thread sets. Work asks for it at
//! [`checkpoint`]s, at least once in every step and every factorisation, and is unwound there. Elsewhere a checkpoint does nothing.

use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::atomic::{AtomicBool, Ordering};

/// The flag of the work of a thread. A reference, as a thread-local value with a destructor would keep the library from being unloaded.
type Flag = &'static AtomicBool;

thread_local! {
    static FLAG: Cell<Option<Flag>> = const { Cell::new(None) };
}

/// Payload of the unwinding.
struct Interrupted;

/// The flag of the work that this thread does, to be passed on to a thread that does a part of it: `within(current(), part)`.
pub fn current() -> Option<Flag> {
    FLAG.get()
}

/// Does work that ends at checkpoints where `flag` is set.
pub fn within<T>(flag: Option<Flag>, work: impl FnOnce() -> T) -> T {
    struct Restore(Option<Flag>);
    impl Drop for Restore {
        fn drop(&mut self) {
            FLAG.set(self.0);
        }
    }
    let _restore = Restore(FLAG.replace(flag));
    work()
}

/// Result of the work; `None` where it was ended because `flag` was set.
pub fn interruptible<T>(flag: Flag, work: impl FnOnce() -> T) -> Option<T> {
    match catch_unwind(AssertUnwindSafe(|| within(Some(flag), work))) {
        Ok(value) => Some(value),
        Err(payload) if payload.is::<Interrupted>() => None,
        Err(payload) => resume_unwind(payload),
    }
}

/// Result of a part of this thread's work; `None` where the work is to end within it: the caller ends it with the parts before.
pub fn part<T>(work: impl FnOnce() -> T) -> Option<T> {
    match current() {
        Some(flag) => interruptible(flag, work),
        None => Some(work()),
    }
}

/// Ends the work here if that was requested.
#[inline]
pub fn checkpoint() {
    if FLAG.get().is_some_and(|flag| flag.load(Ordering::Relaxed)) {
        // Not a panic: no hook, no message.
        resume_unwind(Box::new(Interrupted));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn work_ends_at_the_first_checkpoint_after_the_request_and_only_there() {
        static FLAG: AtomicBool = AtomicBool::new(false);
        let count = |most: usize| {
            let mut counted = 0;
            let done = interruptible(&FLAG, || {
                for _ in 0..most {
                    counted += 1;
                    FLAG.store(counted == 5, Ordering::Relaxed);
                    checkpoint();
                }
            });
            (counted, done.is_some())
        };
        assert_eq!([count(4), count(10)], [(4, true), (5, false)]);
        // Work in parts keeps those before the request.
        let mut kept = 0;
        let done = interruptible(&FLAG, || {
            let ended = (1..9).find(|&number| {
                FLAG.store(number == 5, Ordering::Relaxed);
                part(checkpoint).map(|()| kept = number).is_none()
            });
            (ended, kept)
        });
        assert_eq!(done, Some((Some(5), 4)));
        assert_eq!(part(|| 7), Some(7));
        // Outside the flag is nobody's, and a panic of the work stays one.
        FLAG.store(true, Ordering::Relaxed);
        checkpoint();
        assert!(current().is_none());
        let failed = catch_unwind(|| interruptible(&FLAG, || resume_unwind(Box::new("defect"))));
        assert!(failed.is_err_and(|payload| payload.is::<&str>()) && current().is_none());
        // A thread that does a part of the work has the flag of the whole.
        let ended = interruptible(&FLAG, || {
            let flag = current();
            let part = std::thread::spawn(move || within(flag, checkpoint));
            part.join().unwrap_or_else(|payload| resume_unwind(payload));
        });
        assert!(ended.is_none());
    }
}
