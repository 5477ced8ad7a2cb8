//! Neighbours and air whose temperature jumps, with and without load.

use super::{LEVELS, temperatures};
use test_support::{CONVECTING, Drive, INSULATED, scene};

#[test]
fn a_neighbour_that_jumps_draws_bodies_towards_it() {
    // Pin on disk with and without load; the top of the pin is 5 mm from the contact.
    for (level, changes) in LEVELS {
        for load in [0.0, 10.0] {
            for conductance in [0.01, 1.0, 100.0, 1e6] {
                for step in [0.01, 1.0, 10.0, 1000.0] {
                    let own = [
                        ("punch.top_thermal", INSULATED),
                        ("punch.external_conductance", conductance),
                        ("punch.external_temperature", 296.0),
                        ("ambient_temperature", 296.0),
                    ];
                    let mut drive = Drive::from_starts(&scene("pin_on_disk"), &[changes, &own].concat());
                    drive.set("normal_load", load).step(1.0);
                    drive.set("punch.external_temperature", 396.0).step(step);
                    for t in temperatures(&mut drive) {
                        let text = format!("{level}, {load} N, {conductance} W/K, {step} s: {t} K");
                        assert!((295.5..396.5).contains(&t), "{text}");
                    }
                }
            }
        }
    }
}

#[test]
fn air_that_jumps_moves_nothing_at_once() {
    // Within the tolerance of the reductions, 1e-3.
    for name in ["pin_on_disk", "disc_brake"] {
        for (level, changes) in LEVELS {
            let own = [
                ("punch.top_thermal", CONVECTING),
                ("strip.base_thermal", CONVECTING),
                ("punch.emissivity", 0.5),
                ("strip.emissivity", 0.5),
                ("strip.convection_forced", 20.0),
            ];
            let mut drive = Drive::from_starts(&scene(name), &[changes, &own].concat());
            drive.set("normal_load", 10.0).step(1.0);
            let before = temperatures(&mut drive);
            drive.set("ambient_temperature_offset", 100.0).set("cooling_velocity", 30.0).step(1e-6);
            for (before, after) in before.into_iter().zip(temperatures(&mut drive)) {
                let moved = (after - before) / 100.0;
                assert!((-2e-3..2e-3).contains(&moved), "{name}, {level}: {before} to {after} K");
            }
        }
    }
}
