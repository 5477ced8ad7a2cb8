//! Neighbours and air whose temperature jumps, with and without load.

use super::{LEVELS, temperatures};
use test_support::{CONVECTING, Drive, HELD, INSULATED, scene};

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

/// Movement of both mean temperatures and of the contact a microsecond after everything around has jumped, relative to the jump.
fn moved_at_once(name: &str, far: f64, level: &[(&str, f64)]) -> [f64; 3] {
    let own = [
        ("punch.top_thermal", far),
        ("strip.base_thermal", far),
        ("punch.emissivity", 0.5),
        ("strip.emissivity", 0.5),
        ("strip.convection_forced", 20.0),
    ];
    let mut drive = Drive::from_starts(&scene(name), &[level, &own].concat());
    drive.set("normal_load", 10.0).step(1.0);
    let before = temperatures(&mut drive);
    drive.set("ambient_temperature_offset", 100.0).set("cooling_velocity", 30.0).step(1e-6);
    let after = temperatures(&mut drive);
    std::array::from_fn(|k| (after[k] - before[k]) / 100.0)
}

#[test]
fn air_that_jumps_moves_nothing_at_once() {
    for name in ["pin_on_disk", "disc_brake"] {
        for (level, changes) in LEVELS {
            // Within the tolerance of the reductions.
            let moved = moved_at_once(name, CONVECTING, changes);
            assert!(moved.iter().all(|moved| moved.abs() < 2e-3), "{name}, {level}: {moved:?}");
            // A face that is held takes the layer with it that the states do not resolve: a fortieth of the height, not the contact.
            let [punch, strip, contact] = moved_at_once(name, HELD, changes);
            assert!(contact.abs() < 2e-3, "{name}, {level}, held: contact {contact}");
            assert!(punch.abs() < 3e-2 && strip.abs() < 3e-2, "{name}, {level}, held: means {punch} and {strip}");
            println!("{name}, {level}, held: {punch} {strip} {contact}");
        }
    }
}
