//! Subdivided communication steps where a bristle carries the friction force: results in slip, stick and at
//! transitions are independent of the subdivision.

use test_support::{Drive, LINE, LUMPED, scene};

const OUTPUTS: [&str; 7] = [
    "dissipated_energy",
    "wear_volume_punch",
    "wear_volume_strip",
    "sliding_distance",
    "heat_received_punch",
    "contact_temperature",
    "friction_force",
];

/// Ramps of `velocity` between the speeds and loads given (from, to) over one second each, cut into `parts`; after every
/// ramp the outputs, and the largest force limit.
fn ramps(drive: &mut Drive, velocity: &str, ramps: &[[f64; 4]], parts: u32) -> (Vec<[f64; 7]>, f64) {
    let mut outcomes = Vec::new();
    let mut limit: f64 = 0.0;
    for [v0, v1, f0, f1] in ramps {
        for part in 0..parts {
            let done = f64::from(part) / f64::from(parts);
            drive.set(velocity, v0 + (v1 - v0) * done).set("normal_load", f0 + (f1 - f0) * done);
            drive.slope(velocity, v1 - v0).slope("normal_load", f1 - f0);
            drive.step(1.0 / f64::from(parts));
        }
        drive.set(velocity, *v1).set("normal_load", *f1);
        limit = limit.max(drive.get("friction_force_limit"));
        outcomes.push(OUTPUTS.map(|name| drive.get(name)));
    }
    assert!(drive.imbalance() < 1e-12, "{}", drive.imbalance());
    (outcomes, limit)
}

/// Largest relative difference: energies relative to the dissipated one at the end, temperature to the largest rise, force to the
/// largest limit.
fn difference(one: &[[f64; 7]], other: &[[f64; 7]], start: f64, limit: f64) -> [f64; 7] {
    let last = other.last().unwrap();
    let rise = other.iter().map(|outcome| outcome[5] - start).fold(0.0, f64::max);
    let scale = [last[0], last[1], last[2], last[3], last[0], rise, limit];
    let mut worst = [0.0_f64; 7];
    for (a, b) in one.iter().zip(other) {
        for index in 0..7 {
            worst[index] = worst[index].max((a[index] - b[index]).abs() / scale[index]);
        }
    }
    worst
}

fn cutting(name: &str, changes: &[(&str, f64)], velocity: &str, courses: &[(&str, &[[f64; 4]])], tolerances: &[f64]) {
    let mut failed = Vec::new();
    for (what, course) in courses {
        for &tolerance in tolerances {
            let changes = [changes, &[("solver.tolerance", tolerance)]].concat();
            let run = |parts: u32| {
                let mut drive = Drive::from_starts(&scene(name), &changes);
                let start = drive.get("contact_temperature");
                let (outcomes, limit) = ramps(&mut drive, velocity, course, parts);
                (outcomes, limit, start, drive.0.work())
            };
            let (fine, limit, start, _) = run(1000);
            for parts in [1, 3, 10] {
                let (coarse, _, _, work) = run(parts);
                let worst = difference(&coarse, &fine, start, limit).map(|difference| difference / tolerance);
                let text = format!("{name} {what} {tolerance:e}, {parts} parts: {worst:.3?} of it, {work:?} steps");
                if worst.iter().any(|difference| *difference > 1.0 || difference.is_nan()) {
                    failed.push(text);
                }
            }
        }
    }
    assert!(failed.is_empty(), "{}", failed.join("\n"));
}

#[test]
fn cutting_the_engagement_of_a_clutch_changes_at_most_the_tolerance() {
    let courses: &[(&str, &[[f64; 4]])] = &[
        ("engagement", &[[300.0, 0.0, 0.0, 5e3]]),
        ("constant slip", &[[100.0, 100.0, 5e3, 5e3]]),
        ("engagement, hold, release", &[[300.0, 0.0, 0.0, 5e3], [0.0, 0.0, 5e3, 5e3], [0.0, 200.0, 5e3, 1e3]]),
    ];
    for ratio in [1.0, 1.17] {
        let changes = [("contact.static_friction_ratio", ratio)];
        cutting("clutch", &changes, "angular_velocity", courses, &[1e-3, 1e-4]);
    }
}

#[test]
fn cutting_reversals_and_changes_between_sticking_and_slipping_changes_at_most_the_tolerance() {
    let courses: &[(&str, &[[f64; 4]])] = &[
        ("reciprocating", &[[0.5, -0.5, 2e3, 2e3], [-0.5, 0.8, 2e3, 2e3]]),
        ("break-away by a falling load", &[[0.5, 0.0, 2e3, 2e3], [0.0, 0.002, 2e3, 0.0]]),
        ("break-away by speed", &[[0.0, 0.0, 2e3, 2e3], [0.0, 0.02, 2e3, 2e3], [0.02, 0.02, 2e3, 2e3]]),
        ("load rises faster than it slips", &[[0.02, 0.02, 2e2, 2e2], [0.02, 0.0, 2e2, 4e4], [0.05, 0.1, 4e4, 1e4]]),
        ("touch-down", &[[0.5, 0.2, -1e3, 2e3], [0.2, -0.3, 2e3, -1e3]]),
    ];
    for damping in [0.0, 2e4] {
        let changes = [("contact.stick_stiffness", 1e6), ("contact.stick_damping", damping)];
        cutting("disc_brake", &changes, "sliding_velocity", courses, &[1e-3, 1e-4]);
    }
}

const STIFFNESS: f64 = 5e6;
const RATIO: f64 = 1.15;
const STRIBECK: f64 = 0.05;

/// Force (N) of the bristle at the end of a stop from 12 m/s in 0.35 s under the kinetic friction force `kinetic` (N),
/// by small steps.
fn held(kinetic: f64, damping: f64) -> f64 {
    let (deceleration, step) = (12.0 / 0.35, 1e-7);
    let mut z = kinetic / STIFFNESS;
    for index in (0..200_000).rev() {
        let v = deceleration * step * (f64::from(index) + 0.5);
        let limit = kinetic * (1.0 + (RATIO - 1.0) * (-v / STRIBECK).exp());
        if STIFFNESS * z + damping * v <= limit {
            z += v * step;
        } else {
            let goal = limit / STIFFNESS;
            z = if damping > 0.0 { goal + (z - goal) * (-STIFFNESS * step / damping).exp() } else { goal };
        }
    }
    STIFFNESS * z
}

#[test]
fn a_stop_leaves_the_force_that_the_bristle_had_when_it_stuck() {
    let bristle = [
        ("contact.stick_stiffness", STIFFNESS),
        ("contact.static_friction_ratio", RATIO),
        ("contact.stribeck_velocity", STRIBECK),
        ("solver.cells", 9.0),
    ];
    let mut failed = Vec::new();
    for (level, tolerance) in [(LUMPED, 1e-2), (LUMPED, 1e-3), (LUMPED, 1e-4), (LINE, 1e-2), (LINE, 1e-3)] {
        for damping in [0.0, 2e3, 1e4] {
            let own = [("solver.fidelity", level), ("solver.tolerance", tolerance), ("contact.stick_damping", damping)];
            let exact = held(2.0 * 0.4 * 350.0, damping);
            for parts in [1, 28] {
                let mut drive = Drive::stock(&[&bristle[..], &own].concat());
                drive.set("normal_load", 350.0);
                for part in 0..parts {
                    let left = 1.0 - f64::from(part) / f64::from(parts);
                    drive.set("sliding_velocity", 12.0 * left).slope("sliding_velocity", -12.0 / 0.35);
                    drive.step(0.35 / f64::from(parts));
                }
                drive.set("sliding_velocity", 0.0);
                let force = drive.get("friction_force");
                let error = (force - exact).abs() / (tolerance * exact);
                if error.is_nan() || error > 1.0 {
                    let text = format!("level {level}, {tolerance:e}, damping {damping}, {parts} parts");
                    failed.push(format!("{text}: {force} N instead of {exact} N, {:?} steps", drive.0.work()));
                }
            }
        }
    }
    assert!(failed.is_empty(), "{}", failed.join("\n"));
}

/// The slip begins from rest, as the limit falls below the force; and it never wore before.
#[test]
fn a_strained_bristle_is_unloaded_at_rest_at_any_tolerance() {
    for damping in [0.0, 2e3] {
        let end = |tolerance: f64| {
            let own = [("solver.tolerance", tolerance), ("contact.stick_damping", damping)];
            let mut drive = Drive::stock(&[&[("contact.stick_stiffness", STIFFNESS)], &own[..]].concat());
            drive.set("normal_load", 350.0).set("sliding_velocity", 1e-4).step(0.5).set("sliding_velocity", 0.0);
            assert!((drive.get("friction_force") - 250.0).abs() < 1e-9);
            drive.slope("normal_load", -35_000.0).step(0.01).set("normal_load", 0.0).step(0.1);
            ["dissipated_energy", "wear_volume_punch", "sliding_distance"].map(|name| drive.get(name))
        };
        let [coarse, fine, finest] = [1e-3, 1e-6, 1e-9].map(end);
        // Stored energy and the heat of the damper before, wear, slip.
        let heat = 0.5 * 250.0_f64.powi(2) / STIFFNESS + 0.5 * damping * 1e-8;
        for (index, value) in [heat, finest[1], 250.0 / STIFFNESS].into_iter().enumerate() {
            assert!((coarse[index] - value).abs() <= 1e-3 * value, "{damping}: {coarse:?}, {value}");
            assert!((fine[index] - value).abs() <= 1e-6 * value, "{damping}: {fine:?}, {value}");
        }
    }
}
