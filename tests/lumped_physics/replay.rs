//! Replay from a saved state: bitwise identical, whatever was called before saving.

use scene::variables::{COUNT, STARTS};
use sliding_contact::component::{Component, Snapshot};
use std::sync::Arc;
use test_support::{Drive, LUMPED, Random, changed};

const INPUTS: [&str; 3] = ["sliding_velocity", "normal_load", "ambient_temperature_offset"];

fn bits(component: &mut Component) -> Vec<u64> {
    (0..COUNT as u32).map(|reference| component.get(reference).to_bits()).collect()
}

/// The names of the variables that differ.
fn differing(left: &[u64], right: &[u64]) -> Vec<String> {
    let name = |reference: usize| {
        let (row, element) = scene::variables::lookup(reference as u32).unwrap();
        row.element_name(element)
    };
    (0..COUNT).filter(|&i| left[i] != right[i]).map(name).collect()
}

/// Steps, then goes back to the state before as it was saved, and as its bytes were read into a new component, and steps again.
fn replay(drive: &mut Drive, changes: &[(&str, f64)], steps: &[f64]) {
    let mut saved = Snapshot::default();
    drive.0.snapshot(&mut saved);
    let mut bytes = Vec::new();
    saved.encode(&mut bytes);
    let run = |component: &mut Component| -> Vec<Vec<u64>> {
        let step = |step: &f64| {
            component.step(*step).unwrap();
            bits(component)
        };
        steps.iter().map(step).collect()
    };
    let first = run(&mut drive.0);
    drive.0.restore(&saved).unwrap();
    let again = run(&mut drive.0);
    let starts = changed(&changed(&STARTS, &[("solver.fidelity", LUMPED)]), changes);
    let mut fresh = Component::new(Arc::new(starts));
    fresh.restore(&Snapshot::decode(&bytes).unwrap()).unwrap();
    let elsewhere = run(&mut fresh);
    for (number, before) in first.iter().enumerate() {
        for (which, other) in [("the same", &again[number]), ("another", &elsewhere[number])] {
            let names = differing(before, other);
            assert!(names.is_empty(), "{} outputs of step {number} in {which} component: {names:?}", names.len());
        }
    }
}

fn sliding() -> Drive {
    let mut drive = Drive::stock(&[]);
    drive.set("sliding_velocity", 10.0).set("normal_load", 4e3).step(0.1).step(0.1);
    drive
}

#[test]
fn a_derivative_that_was_taken_back_leaves_nothing_behind() {
    for derivative in [0.0, -0.0, 3.0] {
        // Set alone; set, and taken back by setting the input; the same on another input; with a step of 0 between.
        for variant in 0..4 {
            let mut drive = sliding();
            drive.set("sliding_velocity", 12.0).slope("sliding_velocity", derivative);
            match variant {
                0 if derivative != 0.0 => continue,
                0 => {}
                1 => _ = drive.set("sliding_velocity", 12.0),
                2 => _ = drive.slope("normal_load", derivative).set("normal_load", 3e3).set("sliding_velocity", 12.0),
                _ => _ = drive.step(0.0).set("sliding_velocity", 11.0),
            }
            replay(&mut drive, &[], &[0.1, 0.05, 0.1]);
        }
    }
}

#[test]
fn a_step_of_0_uses_up_the_derivatives_and_moves_nothing() {
    let mut drive = sliding();
    let before = bits(&mut drive.0);
    drive.slope("sliding_velocity", 2.0).step(0.0);
    assert_eq!(differing(&before, &bits(&mut drive.0)), Vec::<String>::new());
    drive.step(0.5);
    assert_eq!(drive.get("sliding_velocity"), 10.0);
}

#[test]
fn random_calls_replay_to_the_last_bit() {
    let mut random = Random(16);
    for _ in 0..20 {
        let changes = [("solver.tolerance", 10_f64.powf(random.between(-4.0, -1.0)))];
        let mut drive = Drive::stock(&changes);
        for _ in 0..12 {
            for _ in 0..random.between(0.0, 6.0) as usize {
                let input = random.between(0.0, 3.0) as usize;
                let scale = [10.0, 3e3, 20.0][input];
                let value = if random.next() < 0.3 { 0.0 } else { scale * random.between(-1.0, 2.0) };
                match random.between(0.0, 5.0) as usize {
                    0 | 1 => _ = drive.set(INPUTS[input], value),
                    2 => _ = drive.slope(INPUTS[input], value),
                    3 => _ = drive.step(0.0),
                    _ => _ = drive.get(["contact_temperature", "stored_heat", "friction_slope"][input]),
                }
            }
            let step = [1e-12, 1e-3, 0.1, 2.0][random.between(0.0, 4.0) as usize];
            replay(&mut drive, &changes, &[step, 0.1]);
        }
    }
}
