//! What a brake leaves behind decays to zero, and a step costs the same at any time after it.

use super::LEVELS;
use crate::cuts::SCENES;
use sliding_contact::component::Snapshot;
use test_support::{Drive, scene};

/// Subnormal numbers take up to a hundred times as long: coasting had become four times dearer within some minutes.
#[test]
fn states_are_not_subnormal_while_the_contact_coasts() {
    for (level, changes) in LEVELS {
        for name in SCENES {
            // Two rigid bodies have no line.
            let Ok(mut drive) = Drive::attempt(&scene(name), changes) else { continue };
            let nominal = ["velocity", "load", "duration"].map(|of| drive.get(&format!("nominal.{of}")));
            let [velocity, load, duration] = nominal;
            drive.set("sliding_velocity", velocity).set("normal_load", load).steps(10, 0.01 * duration);
            drive.set("normal_load", 0.0);
            for _ in 0..40 {
                drive.steps(100, 1e-3 * duration);
                let (mut saved, mut bytes) = (Snapshot::default(), Vec::new());
                drive.0.snapshot(&mut saved);
                saved.encode(&mut bytes);
                let numbers = bytes.as_chunks().0.iter().map(|bytes| f64::from_le_bytes(*bytes));
                let subnormal: Vec<_> = numbers.enumerate().filter(|(_, number)| number.is_subnormal()).collect();
                // The temperature of the end of one step may be.
                assert!(subnormal.len() <= 1, "{name}, {level}: {subnormal:?} by place in the state");
            }
        }
    }
}
