//! The highest temperature of the contact, and surfaces beside an insulator.

use test_support::{Drive, INSULATED};

const CELLS: [f64; 6] = [9.0, 17.0, 33.0, 65.0, 129.0, 257.0];

/// Stock brake without wear: its pressure is singular at the edges, and so is the heat flux. With refinement the highest pressure
/// diverges and the highest temperature converges.
#[test]
fn the_highest_temperature_converges_with_the_cells() {
    let found = CELLS.map(|cells| {
        let mut drive = Drive::stock(&[
            ("solver.fidelity", 3.0),
            ("solver.cells", cells),
            ("solver.tolerance", 1e-5),
            ("punch.wear_coefficient", 0.0),
            ("strip.wear_coefficient", 0.0),
        ]);
        drive.set("sliding_velocity", 3.0).set("normal_load", 5e3);
        drive.step(0.25).step(0.25);
        ["contact_temperature_max", "pressure_max"].map(|name| drive.get(name))
    });
    let highest = found.map(|[t, _]| t);
    let changes: Vec<f64> = highest.windows(2).map(|pair| (pair[1] - pair[0]).abs()).collect();
    println!("{found:?} {changes:?}");
    // Down to the error of the time steps and of the most states that a punch has.
    let rise = highest[5] - 293.15;
    assert!(changes.windows(2).all(|pair| pair[1] < pair[0].max(2e-4 * rise)), "{highest:?} {changes:?}");
    assert!(changes[4] < 2e-4 * rise, "{highest:?} {changes:?}");
    assert!(found[5][1] > 2.0 * found[3][1], "{found:?}");
}

/// `contact.temperature_limit` is compared with the same output.
#[test]
fn the_temperature_limit_is_that_of_the_highest_temperature() {
    let run = |limit: f64| {
        let mut drive = Drive::stock(&[
            ("solver.fidelity", 3.0),
            ("solver.cells", 65.0),
            ("solver.tolerance", 1e-2),
            ("punch.wear_coefficient", 0.0),
            ("strip.wear_coefficient", 0.0),
            ("contact.temperature_limited", 1.0),
            ("contact.temperature_limit", limit),
        ]);
        drive.set("sliding_velocity", 10.0).set("normal_load", 5e3).step(0.5);
        (drive.get("contact_temperature_max"), drive.get("limit_reached") as u8 & 2)
    };
    let (highest, _) = run(2000.0);
    assert_eq!(run(highest + 1e-6).1, 0);
    assert_eq!(run(highest - 1e-6).1, 2);
}

/// A stop within one communication step: the contact is hottest half-way, and cooler than its limit when the step ends. The limit is
/// one of the temperature of the level that runs.
#[test]
fn a_peak_within_a_communication_step_exceeds_the_limit() {
    let stop = |level: f64, limit: f64, parts: u32| {
        let mut drive = Drive::stock(&[
            ("solver.fidelity", level),
            ("solver.cells", 17.0),
            ("solver.tolerance", 1e-3),
            ("contact.temperature_limited", 1.0),
            ("contact.temperature_limit", limit),
        ]);
        let (speed, duration) = (15.0, 6.0);
        drive.set("normal_load", 5e3).set("sliding_velocity", speed);
        let mut highest: f64 = 0.0;
        for _ in 0..parts {
            drive.slope("sliding_velocity", -speed / duration).step(duration / f64::from(parts));
            highest = highest.max(drive.get("contact_temperature_max"));
        }
        (highest, drive.get("contact_temperature_max"), drive.get("limit_reached") as u8 & 2)
    };
    let both = [2.0, 3.0].map(|level| (level, stop(level, 2000.0, 600)));
    let between = 0.5 * (both[0].1.0 + both[1].1.0);
    for (level, (highest, last, _)) in both {
        assert!(highest > last + 10.0 && (highest - between).abs() > 1.0, "{highest} {last} {between}");
        let beyond = highest + 0.02 * (highest - 293.15);
        for limit in [0.3 * last + 0.7 * highest, beyond, between] {
            let reached = if highest > limit { 2 } else { 0 };
            for parts in [1, 2, 600] {
                assert_eq!(
                    stop(level, limit, parts).2,
                    reached,
                    "level {level}, {parts} steps, {limit} K, {highest} K"
                );
            }
        }
    }
}

/// A body of uniform temperature on an insulator, in partial contact or in none: the contact temperature is that of the body, as
/// an insulator has no temperature field of its own.
#[test]
fn beside_an_insulator_open_cells_have_the_temperature_of_the_conductor() {
    for body in ["punch", "strip"] {
        let other = if body == "punch" { "strip" } else { "punch" };
        let insulator = format!("{other}.conductivity");
        let (own, air) = (format!("{body}.conductivity"), format!("{body}.convection"));
        for level in [2.0, 3.0] {
            let mut drive = Drive::stock(&[
                ("solver.fidelity", level),
                ("solver.cells", 17.0),
                (&insulator, 0.0),
                (&own, 400.0),
                (&air, 0.0),
                ("strip.convection_forced", 0.0),
                ("punch.top_thermal", INSULATED),
                ("strip.base_thermal", INSULATED),
                ("strip.length", 0.2),
                ("punch.height", 0.01),
                ("contact.initial_shape", 2.0),
                ("contact.initial_radius", 2.0),
                ("punch.wear_coefficient", 0.0),
                ("strip.wear_coefficient", 0.0),
                ("nominal.duration", 100.0),
                ("solver.tolerance", 1e-3),
            ]);
            drive.set("sliding_velocity", 5.0).set("normal_load", 200.0).steps(10, 1.0);
            drive.set("sliding_velocity", 0.0);
            for load in [200.0, 0.0] {
                drive.set("normal_load", load).steps(10, 30.0);
                let mean = drive.get(&format!("{body}.mean_temperature"));
                let (contact, highest) = (drive.get("contact_temperature"), drive.get("contact_temperature_max"));
                let edge = drive.get("profile.temperature[1]");
                let open = 1.0 - drive.get("contact_fraction");
                println!("{body} {level} {load}: open {open}, {mean} {contact} {highest} {edge}");
                assert!(mean > 294.15 && (level == 2.0 || open > 0.2), "{body} {level} {load}: {mean} {open}");
                for value in [contact, highest, edge] {
                    assert!((value - mean).abs() < 5e-3 * (mean - 293.15), "{body} {level} {load}: {value} {mean}");
                }
            }
        }
    }
}
