//! Tunable parameters between steps: after a change nothing is stale.

use model::lumped::conditions::Tunables;
use test_support::{CONVECTING, Drive, INSULATED, LINE, LUMPED, real_outputs, reference, scene, scenes};

const TOP: &str = "punch.top_thermal";
const BASE: &str = "strip.base_thermal";
const COMPANION: (&str, f64) = ("solver.error_estimate", 3.0);
const WORN_TRACK: (&str, f64) = ("strip.wear_coefficient", 1e-16);

/// Example scenes with changes: cooled and insulated faces, no wear and no conductance at first, a worn track with either heat.
const SCENES: [(&str, &[(&str, f64)]); 6] = [
    ("disc_brake", &[(TOP, INSULATED), (BASE, CONVECTING), ("punch.emissivity", 0.5), ("holder.stiffness", 1e7)]),
    ("disc_brake", &[("*.wear_coefficient", 0.0), ("contact.conductance", 0.0)]),
    ("pin_on_disk", &[(TOP, CONVECTING), ("strip.convection_forced", 20.0)]),
    ("reciprocating_punch", &[(TOP, CONVECTING), (BASE, INSULATED), WORN_TRACK]),
    ("reciprocating_punch", &[WORN_TRACK, ("solver.heat", 2.0)]),
    ("clutch", &[(TOP, CONVECTING), ("punch.wear_threshold", 1e4)]),
];

/// Values of the tunable parameters, in the order of their names.
const VALUES: [[f64; 3]; Tunables::NAMES.len()] = [
    [0.3, 0.0, 0.2],
    [350.0, 280.0, 290.0],
    [3.0, 1.0, 2.0],
    [1e-14, 0.0, 2e-14],
    [1e-15, 0.0, 2e-15],
    [40.0, 0.0, 20.0],
    [40.0, 0.0, 20.0],
    [0.5, 0.0, 1.0],
    [0.5, 0.0, 1.0],
    [5e3, 0.0, 6e3],
];

fn initialised(name: &str, changes: &[(&str, f64)]) -> Drive {
    let mut drive = Drive::from_starts(&scene(name), changes);
    drive.set("punch.external_temperature", 350.0).set("strip.external_temperature", 320.0);
    drive
}

/// Steps of three lengths with velocities that stay, change and return; the bits of all outputs.
fn run(drive: &mut Drive, speed: f64, load: f64) -> Vec<u64> {
    let outputs = |drive: &mut Drive| real_outputs().into_iter().map(|output| drive.0.get(output).to_bits()).collect();
    let mut bits: Vec<u64> = outputs(drive);
    for (part, length) in [(1.0, 1.0), (1.0, 1.0), (1.0, 0.5), (0.9, 0.5), (1.0, 1.0)] {
        drive.set("sliding_velocity", part * speed).set("normal_load", part * load).step(1e-3 * length / speed);
        bits.append(&mut outputs(drive));
    }
    bits
}

#[test]
fn a_step_after_a_change_is_that_of_a_new_instance_in_the_same_state() {
    let mut changed = 0;
    for (level, (name, own)) in [LUMPED, LINE].into_iter().flat_map(|level| SCENES.map(|scene| (level, scene))) {
        let (_, load, speed) = scenes().into_iter().find(|known| known.0 == name).unwrap();
        let changes = [own, &[("solver.fidelity", level), ("solver.cells", 9.0), COMPANION]].concat();
        let mut drive = initialised(name, &changes);
        run(&mut drive, speed, load);
        for (tunable, values) in Tunables::NAMES.map(reference).into_iter().zip(VALUES).rev() {
            for value in values {
                if drive.0.check_tuning([(tunable, value)].into_iter()).is_ok() {
                    drive.0.set_parameter(tunable, value);
                    drive.assert_replay(initialised(name, &changes), |drive| run(drive, speed, load));
                    run(&mut drive, speed, load);
                    changed += 1;
                }
            }
        }
    }
    assert!(changed > 300, "{changed}");
}
