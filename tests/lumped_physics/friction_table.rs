//! A friction coefficient over sliding speed as a table, at both levels, and the output that says whether the contact sticks.

use scene::Scene;
use scene::slot::Packaged;
use test_support::{Drive, LINE, LUMPED, changed, reference};

const POINTS: [(f64, f64); 4] = [(0.0, 0.5), (0.5, 0.4), (2.0, 0.32), (8.0, 0.36)];
const SPEED: [&str; 4] = ["[1]", "[2]", "[3]", "[4]"];

/// The names of the table's entries and their values.
fn table() -> Vec<(String, f64)> {
    let mut changes = vec![("contact.friction_table.points".to_owned(), 4.0)];
    for (index, (speed, coefficient)) in SPEED.iter().zip(POINTS) {
        changes.push((format!("contact.friction_table.speed{index}"), speed));
        changes.push((format!("contact.friction_table.coefficient{index}"), coefficient));
    }
    changes
}

fn with_table(level: f64, more: &[(&str, f64)]) -> Drive {
    let table = table();
    let mut changes: Vec<(&str, f64)> = table.iter().map(|(name, value)| (name.as_str(), *value)).collect();
    changes.extend([("solver.fidelity", level), ("solver.cells", 9.0)]);
    changes.extend(more);
    Drive::stock(&changes)
}

#[test]
fn the_force_follows_the_table_at_both_levels() {
    for level in [LUMPED, LINE] {
        let mut drive = with_table(level, &[]);
        drive.set("normal_load", 5e3);
        for (speed, coefficient) in [(0.5, 0.4), (-2.0, 0.32), (8.0, 0.36), (30.0, 0.36)] {
            drive.set("sliding_velocity", speed);
            let force = drive.get("friction_force");
            assert!((force / (2.0 * coefficient * 5e3 * f64::signum(speed)) - 1.0).abs() < 1e-9, "{speed}: {force}");
            assert!((drive.get("friction_coefficient") - coefficient).abs() < 1e-12);
            assert!((drive.get("friction_force_limit") / (2.0 * 0.5 * 5e3) - 1.0).abs() < 1e-9);
        }
        // The slope is that of the force, on both sides of a point.
        for speed in [0.5, 1.1, 2.0] {
            let mut force = |at: f64| drive.set("sliding_velocity", at).get("friction_force");
            let [below, middle, above] = [speed - 1e-6, speed, speed + 1e-6].map(&mut force);
            let slope = drive.set("sliding_velocity", speed).get("friction_slope");
            for difference in [(middle - below) / 1e-6, (above - middle) / 1e-6] {
                assert!((slope - difference).abs() < 1e-3 * slope.abs() + 1.0, "{speed}: {slope} {difference}");
            }
        }
        // The tunable coefficient scales the table.
        drive.0.set_parameter(reference("contact.friction_coefficient"), 0.2);
        drive.set("sliding_velocity", 2.0);
        assert!((drive.get("friction_force") / (2.0 * 0.16 * 5e3) - 1.0).abs() < 1e-9);
        drive.step(0.1);
    }
}

#[test]
fn a_table_with_a_fault_is_refused_by_name() {
    let refused = |more: &[(&str, f64)]| {
        let table = table();
        let mut changes: Vec<(&str, f64)> = table.iter().map(|(name, value)| (name.as_str(), *value)).collect();
        changes.extend(more);
        Scene::new(&changed(&Packaged::stock().starts, &changes), None).unwrap_err().to_string()
    };
    for (more, words) in [
        (vec![("contact.static_friction_ratio", 1.2)], vec!["contact.static_friction_ratio = 1.2", "both given"]),
        (
            vec![("contact.friction_table.speed[1]", 0.1)],
            vec!["contact.friction_table.speed[1] = 0.1 m/s must be 0 m/s"],
        ),
        (
            vec![("contact.friction_table.speed[3]", 0.5)],
            vec!["speed[3] = 0.5 m/s must be above", "speed[2] = 0.5 m/s"],
        ),
        (vec![("contact.friction_table.points", 1.0)], vec!["contact.friction_table.speed[2] = 0.5 has no effect"]),
        (vec![("contact.friction_table.points", 0.0)], vec!["contact.friction_table.speed[2] = 0.5 has no effect"]),
        (vec![("contact.friction_coefficient", 0.0)], vec!["contact.friction_coefficient = 0", "must be > 0"]),
    ] {
        let text = refused(&more);
        assert!(words.iter().all(|word| text.contains(word)), "{text}");
    }
}

#[test]
fn sticking_is_said_below_the_limit_of_a_bristle_and_at_standstill_without_one() {
    for level in [LUMPED, LINE] {
        for table in [false, true] {
            let stick = [("contact.stick_stiffness", 1e6), ("contact.stick_damping", 1e3)];
            let cells = [("solver.fidelity", level), ("solver.cells", 9.0)];
            let mut drive = if table { with_table(level, &stick) } else { Drive::stock(&[stick, cells].concat()) };
            drive.set("normal_load", 5e3).set("sliding_velocity", 1e-3).step(1.0);
            assert_eq!(drive.get("sticking"), 1.0);
            drive.set("sliding_velocity", 0.1).step(1.0);
            assert_eq!(drive.get("sticking"), 0.0);
            drive.set("sliding_velocity", 0.0);
            assert_eq!(drive.get("sticking"), 1.0);
            // An open contact does not stick.
            drive.set("normal_load", 0.0);
            assert_eq!(drive.get("sticking"), 0.0);
        }
        let mut drive = Drive::stock(&[("solver.fidelity", level), ("solver.cells", 9.0)]);
        drive.set("normal_load", 5e3);
        assert_eq!(drive.get("sticking"), 1.0);
        drive.set("sliding_velocity", 1e-9);
        assert_eq!(drive.get("sticking"), 0.0);
    }
}
