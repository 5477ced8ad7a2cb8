//! Answers of steps that were prepared before: probes of two levels that take the same steps with the same strip.
//!
//! An answer is a function of the step and of the velocities alone, so a kept one is that which would be found, to the bit. Kept
//! are those of sliding forwards; the way back has them mirrored.
//!
//! Theory: docs/theory.md, section 6.4.

use super::answer::Answer;
use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

/// Most numbers that are kept: 16 MB.
const MOST: usize = 2_000_000;

/// Answers of both stages of a step.
pub type Both = Arc<[Answer; 2]>;

/// See the module.
#[derive(Debug, Default)]
pub struct Kept(Mutex<Known>);

#[derive(Debug, Default)]
struct Known {
    answers: HashMap<[u64; 3], Both>,
    numbers: usize,
}

impl Kept {
    /// What was found for a step of this length between these velocities.
    pub fn get(&self, length: f64, velocity: [f64; 2]) -> Option<Both> {
        // Every entry is complete, whatever a panic has interrupted.
        let known = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        known.answers.get(&key(length, velocity)).cloned()
    }

    /// Number of steps whose answers are kept.
    #[cfg(test)]
    pub fn count(&self) -> usize {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).answers.len()
    }

    /// Keeps what was found, while there is room.
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
