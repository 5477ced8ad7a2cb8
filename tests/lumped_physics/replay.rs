//! Replay from a saved state: bitwise identical, whatever was called before saving.

use scene::variables::COUNT;
use test_support::Drive;

fn bits(drive: &mut Drive) -> Vec<u64> {
    (0..COUNT as u32).map(|reference| drive.0.get(reference).to_bits()).collect()
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
            drive.assert_replay(Drive::stock(&[]), |drive| [0.1, 0.05, 0.1].map(|step| bits(drive.step(step))));
        }
    }
}

#[test]
fn a_step_of_0_uses_up_the_derivatives_and_moves_nothing() {
    let mut drive = sliding();
    let before = bits(&mut drive);
    drive.slope("sliding_velocity", 2.0).step(0.0);
    assert_eq!(before, bits(&mut drive));
    drive.step(0.5);
    assert_eq!(drive.get("sliding_velocity"), 10.0);
}
