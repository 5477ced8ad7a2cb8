//! Neighbours and air whose temperature jumps, with and without load.

use super::{LEVELS, temperatures};
use test_support::{CONVECTING, Drive, EXTERNAL, HELD, INSULATED, reference, scene};

/// Movement of both mean temperatures and of the contact within a microsecond after everything around has jumped, in `steps`, relative
/// to the jump.
fn moved_at_once(name: &str, far: f64, level: &[(&str, f64)], steps: &[f64]) -> [f64; 3] {
    let own = [
        ("punch.top_thermal", far),
        ("strip.base_thermal", far),
        ("*.emissivity", 0.5),
        ("strip.convection_forced", 20.0),
    ];
    let mut drive = Drive::from_starts(&scene(name), &[level, &own].concat());
    drive.set("normal_load", 10.0).step(1.0);
    let before = temperatures(&mut drive);
    drive.set("ambient_temperature_offset", 100.0).set("cooling_velocity", 30.0);
    for step in steps {
        drive.step(*step);
    }
    let after = temperatures(&mut drive);
    std::array::from_fn(|k| (after[k] - before[k]) / 100.0)
}

#[test]
fn air_that_jumps_moves_nothing_at_once() {
    for name in ["pin_on_disk", "disc_brake"] {
        for ((level, changes), steps) in LEVELS.iter().flat_map(|level| [(level, &[1e-6][..]), (level, &[3e-9; 3])]) {
            // Within the tolerance of the reductions.
            let moved = moved_at_once(name, CONVECTING, changes, steps);
            assert!(moved.iter().all(|moved| moved.abs() < 2e-3), "{name}, {level}: {moved:?}");
            // A face that is held takes the layer with it that the states do not resolve: a fortieth of the height, not the contact.
            let [punch, strip, contact] = moved_at_once(name, HELD, changes, steps);
            assert!(contact.abs() < 2e-3, "{name}, {level}, held: contact {contact}");
            assert!(punch.abs() < 3e-2 && strip.abs() < 3e-2, "{name}, {level}, held: means {punch} and {strip}");
        }
    }
}

/// A punch of 800 K whose top has a stiff heat path to 293 K: the contact feels it by diffusion, and in the limit as a prescribed
/// temperature.
#[test]
fn a_stiff_path_is_a_prescribed_temperature() {
    for name in ["pin_on_disk", "disc_brake"] {
        for (level, changes) in LEVELS {
            let run = |far: f64, conductance: f64| {
                let own = [
                    ("punch.top_thermal", far),
                    ("punch.external_conductance", conductance),
                    ("punch.external_temperature", 293.15),
                    ("punch.initial_at_ambient", 0.0),
                    ("punch.initial_temperature", 800.0),
                    ("*.thermal_expansion", 0.0),
                ];
                let mut drive = Drive::from_starts(&scene(name), &[changes, &own].concat());
                drive.set("normal_load", 100.0);
                let mut seen = vec![drive.get("contact_temperature")];
                for step in [1e-6, 1e-4, 1e-2, 1.0, 10.0] {
                    drive.step(step);
                    seen.extend([drive.get("contact_temperature"), drive.get("punch.mean_temperature")]);
                }
                seen
            };
            let (apart, held) = (run(INSULATED, 1e-9), run(EXTERNAL, 0.0));
            for conductance in [1.0, 1e3, 1e6, 1e9] {
                let seen = run(INSULATED, conductance);
                let jump = (seen[0] - apart[0]).abs().max((seen[1] - apart[1]).abs());
                assert!(jump < 0.5, "{name}, {level}, {conductance} W/K: the contact moves by {jump} K at once");
                if conductance > 1e5 {
                    for (own, held) in seen.iter().zip(&held).skip(7) {
                        assert!((own - held).abs() < 3.0, "{name}, {level}, {conductance} W/K: {seen:?} for {held:?}");
                    }
                }
            }
        }
    }
}

#[test]
fn a_path_that_opens_is_the_path_from_the_start() {
    // The space of the states is the same, whatever the conductance at initialisation.
    for (name, body, far) in [
        ("pin_on_disk", "punch", "punch.top_thermal"),
        ("disc_brake", "punch", "punch.top_thermal"),
        ("pin_on_disk", "strip", "strip.base_thermal"),
        ("disc_brake", "strip", "strip.base_thermal"),
    ] {
        let [conductance, outside, mean] =
            ["external_conductance", "external_temperature", "mean_temperature"].map(|what| format!("{body}.{what}"));
        for (level, changes) in LEVELS {
            for opened in [1.0, 1e3, 1e9] {
                let run = |start: f64| {
                    let own = [
                        (far, INSULATED),
                        (&conductance[..], start),
                        (&outside[..], 293.15),
                        ("*.initial_at_ambient", 0.0),
                        ("*.initial_temperature", 800.0),
                        ("*.thermal_expansion", 0.0),
                    ];
                    let mut drive = Drive::from_starts(&scene(name), &[changes, &own].concat());
                    drive.set("normal_load", 100.0).step(0.1);
                    let change = (reference(&conductance), opened);
                    drive.0.check_tuning([change].into_iter()).unwrap();
                    drive.0.set_parameter(change.0, change.1);
                    let seen = [1e-6, 1e-4, 1e-2, 1.0, 10.0].map(|step| {
                        drive.step(step);
                        [drive.get("contact_temperature"), drive.get(&mean)]
                    });
                    seen.concat()
                };
                for (opens, open) in run(0.0).into_iter().zip(run(1e-9)) {
                    let text = format!("{name}, {body}, {level}, {opened} W/K: {opens} K for {open} K");
                    assert!((opens - open).abs() < 1e-3, "{text}");
                }
            }
        }
    }
}

/// Heat from a far face takes milliseconds to the contact of a pin and of a pad, however far the air has jumped.
#[test]
fn air_a_million_kelvin_hotter_moves_no_contact_at_once() {
    for name in ["pin_on_disk", "disc_brake"] {
        for (level, changes) in LEVELS {
            for (far, jump) in [(CONVECTING, 1e6), (HELD, 1e5)] {
                let own = [
                    ("punch.top_thermal", far),
                    ("strip.base_thermal", far),
                    ("*.emissivity", 0.0),
                    ("strip.property_table.points", 0.0),
                ];
                let mut drive = Drive::from_starts(&scene(name), &[changes, &own].concat());
                drive.set("normal_load", 10.0).step(1.0);
                let before = drive.get("contact_temperature");
                drive.set("ambient_temperature_offset", jump).step(1e-6);
                let moved = (drive.get("contact_temperature") - before) / jump;
                assert!(moved.abs() < 1e-4, "{name}, {level}, face {far}: {moved}");
            }
        }
    }
}
