//! A friction coefficient over sliding speed as a table, at both levels, and the output that says whether the contact sticks.

use test_support::{Drive, LINE, LUMPED, reference};

const TABLE: &[(&str, f64)] = &[
    ("contact.friction_table.points", 4.0),
    ("contact.friction_table.coefficient[1]", 0.5),
    ("contact.friction_table.speed[2]", 0.5),
    ("contact.friction_table.coefficient[2]", 0.4),
    ("contact.friction_table.speed[3]", 2.0),
    ("contact.friction_table.coefficient[3]", 0.32),
    ("contact.friction_table.speed[4]", 8.0),
    ("contact.friction_table.coefficient[4]", 0.36),
];

fn at_level(level: f64, changes: &[&[(&str, f64)]]) -> Drive {
    Drive::stock(&[&[("solver.fidelity", level), ("solver.cells", 9.0)], &changes.concat()[..]].concat())
}

#[test]
fn the_force_follows_the_table_at_both_levels() {
    for level in [LUMPED, LINE] {
        let mut drive = at_level(level, &[TABLE]);
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
fn sticking_is_said_below_the_limit_of_a_bristle_and_at_standstill_without_one() {
    for level in [LUMPED, LINE] {
        for table in [&[][..], TABLE] {
            let stick = [("contact.stick_stiffness", 1e6), ("contact.stick_damping", 1e3)];
            let mut drive = at_level(level, &[table, &stick]);
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
        let mut drive = at_level(level, &[]);
        drive.set("normal_load", 5e3);
        assert_eq!(drive.get("sticking"), 1.0);
        drive.set("sliding_velocity", 1e-9);
        assert_eq!(drive.get("sticking"), 0.0);
    }
}
