//! Limits, life, parameters that may change during a run, and bodies worn through.

use sliding_contact::component::Snapshot;
use test_support::{Drive, LUMPED, reference};

#[test]
fn life_and_the_wear_limit() {
    let mut drive =
        Drive::stock(&[("punch.wear_limit", 1e-5), ("punch.initial_wear", 2e-6), ("strip.wear_limit", 1.0)]);
    assert!((drive.get("remaining_life") - 0.8).abs() < 1e-12);
    drive.set("normal_load", 5e3).set("sliding_velocity", 10.0);
    let rate = 2e-14 * 5e3 / drive.area() * 10.0;
    let half = 4e-6 / rate;
    drive.step(half);
    assert!((drive.get("remaining_life") - 0.4).abs() < 1e-9, "{}", drive.get("remaining_life"));
    assert_eq!(drive.get("limit_reached"), 0.0);
    drive.step(1.01 * half);
    assert_eq!((drive.get("remaining_life"), drive.get("limit_reached")), (0.0, 1.0));
    let count = |drive: &mut Drive| drive.0.messages().filter(|m| m.text.contains("wear limit")).count();
    assert_eq!(count(&mut drive), 1);
    drive.step(1.0);
    assert_eq!(count(&mut drive), 0);
    // Worn depth counts from 0, not from the initial wear.
    assert!((drive.get("wear_depth_punch") / (rate * (2.01 * half + 1.0)) - 1.0).abs() < 1e-9);
}

#[test]
fn the_temperature_limit_stays_reached() {
    let mut drive = Drive::stock(&[("contact.temperature_limited", 1.0), ("contact.temperature_limit", 350.0)]);
    drive.set("normal_load", 5e3).set("sliding_velocity", 10.0);
    let mut crossed = 0.0;
    for _ in 0..100 {
        let flag = drive.get("limit_reached");
        assert_eq!(flag == 2.0, crossed > 350.0, "{flag} {crossed}");
        drive.step(0.05);
        crossed = drive.get("contact_temperature_max").max(crossed);
    }
    assert!(crossed > 350.0);
    drive.set("sliding_velocity", 0.0).steps(100, 100.0);
    assert!(drive.get("contact_temperature_max") < 320.0);
    assert_eq!(drive.get("limit_reached"), 2.0);
}

/// The middle of a stroke wears most, and a communication step of half a stroke ends where it wears least: every pass of the whole
/// contact takes k p W.
#[test]
fn the_limit_of_a_worn_track_is_that_of_its_deepest_place() {
    let (stroke, speed) = (0.3, 0.1);
    let wear = 1e-12;
    for level in [LUMPED, 3.0] {
        for parts in [1, 40] {
            let changes = |limit: f64| {
                [
                    ("solver.fidelity", level),
                    ("solver.cells", 9.0),
                    ("solver.tolerance", 1e-2),
                    ("contact.geometry", 1.0),
                    ("strip.path", 1.0),
                    ("nominal.stroke", stroke),
                    ("punch.width", 0.06),
                    ("strip.body", 1.0),
                    ("punch.body", 2.0),
                    ("contact.friction_coefficient", 1e-6),
                    ("*.thermal_expansion", 0.0),
                    ("punch.wear_coefficient", 0.0),
                    ("strip.wear_coefficient", wear),
                    ("strip.wear_limit", limit),
                ]
            };
            let mut drive = Drive::stock(&changes(1.0));
            let pass = wear * 5e3 / drive.area() * 0.06;
            let mut drive = Drive::stock(&changes(4.5 * pass));
            drive.set("normal_load", 5e3);
            for number in 1..=6 {
                let velocity = if number % 2 == 1 { speed } else { -speed };
                drive.set("sliding_velocity", velocity).steps(parts, stroke / speed / f64::from(parts));
                assert_eq!(drive.get("limit_reached") as u8 & 1, u8::from(number >= 5), "{level} {parts} {number}");
            }
        }
    }
}

#[test]
fn a_load_far_above_nominal_counts_where_a_step_begins_too() {
    let mut drive = Drive::stock(&[("nominal.load", 5e3), ("nominal.velocity", 10.0)]);
    drive.set("normal_load", 51e3).slope("normal_load", -50e3 / 0.1).set("sliding_velocity", 0.1).step(0.1);
    assert_eq!(drive.get("limit_reached"), 4.0);
}

/// The text of a step that fails and leaves the state as it was.
fn failure(drive: &mut Drive, step: f64) -> Option<String> {
    let [mut before, mut after] = [Snapshot::default(), Snapshot::default()];
    drive.0.snapshot(&mut before);
    let text = drive.0.step(step).err()?;
    drive.0.snapshot(&mut after);
    assert_eq!(before, after, "{text}");
    Some(text)
}

#[test]
fn a_body_worn_through_is_an_error_and_nothing_has_moved() {
    for body in ["punch", "strip"] {
        let mut drive = Drive::stock(&[
            (&format!("{body}.wear_coefficient"), 1e-9),
            (&format!("{body}.initial_wear"), 0.005),
            ("contact.friction_coefficient", 0.01),
        ]);
        drive.set("normal_load", 5e3).set("sliding_velocity", 10.0);
        failure(&mut drive, 1e6).expect("worn through in one long step");
        let text = (0..10_000).find_map(|_| failure(&mut drive, 0.1)).expect("worn through after some seconds");
        assert!(
            text.contains(&format!("{body} is worn through")) && text.contains(&format!("{body}.height")),
            "{text}"
        );
        // A step that is short enough still succeeds, and leaves the validity behind.
        drive.step(1e-6);
        assert_eq!(drive.get("limit_reached") as i32 & 4, 4);
    }
}

/// Wear follows the friction coefficient, which is tunable: more friction than at initialisation wears a body through within a
/// step that would otherwise have been far from it.
#[test]
fn a_step_that_wears_the_punch_through_by_tuned_friction_changes_nothing() {
    let mut refused = 0;
    for exponent in 0..60 {
        let wear = 1e-11 * 10f64.powf(0.1 * f64::from(exponent));
        let changes = [("punch.wear_coefficient", wear), ("contact.friction_coefficient", 0.1), ("punch.height", 1e-6)];
        let mut drive = Drive::stock(&changes);
        drive.0.set_parameter(reference("contact.friction_coefficient"), 0.9);
        drive.set("sliding_velocity", 10.0).set("normal_load", 5e3).slope("sliding_velocity", 1e-3);
        if let Some(text) = failure(&mut drive, 1e-6) {
            assert!(text.contains("worn through"), "{wear:e}: {text}");
            refused += 1;
        }
    }
    assert!((10..50).contains(&refused), "{refused}");
}

#[test]
fn friction_may_be_tuned_and_wear_follows_its_shear() {
    let mut drive = Drive::stock(&[("punch.wear_pressure_exponent", 0.7), ("strip.wear_coefficient", 0.0)]);
    drive.set("normal_load", 5e3).set("sliding_velocity", 10.0).step(1.0);
    let first = drive.get("wear_volume_punch");
    assert!((drive.get("friction_force") - 2.0 * 0.4 * 5e3).abs() < 1e-9);
    drive.0.set_parameter(reference("contact.friction_coefficient"), 0.3);
    assert!((drive.get("friction_force") - 2.0 * 0.3 * 5e3).abs() < 1e-9);
    drive.step(1.0);
    let second = drive.get("wear_volume_punch") - first;
    // mu_ref stays what it was when initialisation ended.
    assert!((second / first - 0.75_f64.powf(0.7)).abs() < 1e-9, "{}", second / first);
    assert!((drive.get("dissipated_energy") / (2.0 * 5e3 * 10.0 * 0.7) - 1.0).abs() < 1e-12);
}

#[test]
fn wear_acceleration_multiplies_wear_only() {
    let run = |acceleration: f64| {
        let mut drive = Drive::stock(&[]);
        drive.0.set_parameter(reference("wear_acceleration"), acceleration);
        drive.set("normal_load", 5e3).set("sliding_velocity", 10.0).steps(10, 1.0);
        ["wear_depth", "wear_volume_strip", "sliding_distance", "dissipated_energy", "contact_temperature"]
            .map(|name| drive.get(name))
    };
    let plain = run(1.0);
    for factor in [50.0, 0.5] {
        let other = run(factor);
        for index in 0..2 {
            assert!((other[index] / plain[index] / factor - 1.0).abs() < 1e-9, "{factor}: {other:?}");
        }
        assert_eq!(plain[2..], other[2..]);
    }
}
