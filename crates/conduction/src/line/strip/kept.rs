//! Cache of stage responses by step: for probes of two model levels that take the same steps with the same strip.
//!
//! A response is a function of step length and velocities alone, so a cached one equals a computed one to the bit.
//! Responses of forward sliding are cached; those of backward sliding are their mirror images.
//!
//! Theory: docs/theory.md, section 6.4.

use super::answer::Answer;
use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

/// Cache capacity in numbers: 16 MB.
const MOST: usize = 2_000_000;

/// Responses of both stages of a step.
pub type Both = Arc<[Answer; 2]>;

/// Cache of stage responses, shared by the copies of a strip.
#[derive(Debug, Default)]
pub struct Kept(Mutex<Known>);

#[derive(Debug, Default)]
struct Known {
    answers: HashMap<[u64; 3], Both>,
    numbers: usize,
}

impl Kept {
    /// Cached responses of a step of this length between these velocities.
    pub fn get(&self, length: f64, velocity: [f64; 2]) -> Option<Both> {
        // Every entry is complete, even after a panic.
        let known = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        known.answers.get(&key(length, velocity)).cloned()
    }

    /// Number of cached steps.
    #[cfg(test)]
    pub fn count(&self) -> usize {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).answers.len()
    }

    /// Stores responses while the capacity suffices.
    pub fn keep(&self, length: f64, velocity: [f64; 2], answers: [&Answer; 2]) {
        let mut known = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let numbers = known.numbers + answers.iter().map(|answer| answer.length()).sum::<usize>();
        if numbers <= MOST {
            known.numbers = numbers;
            known.answers.insert(key(length, velocity), Arc::new(answers.map(Answer::clone)));
        }
    }
}

fn key(length: f64, [from, to]: [f64; 2]) -> [u64; 3] {
    [length, from, to].map(f64::to_bits)
}
