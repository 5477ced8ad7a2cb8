//! Worn shapes: volumes, time steps, the run-in state, strokes, the stability bound of the explicit scheme.

use super::contact::{BASE, line, stations, trapezoid};
use exact::{CyclicHalfPlane, HolderKind};
use scene::variables::STARTS;
use test_support::{Drive, scene};

/// Mean pressure under 10 kN, Pa.
const MEAN: f64 = 1e4 / 6e-4;

fn drive_reciprocating(drive: &mut Drive, half_strokes: u32, parts: u32, velocity: f64, stroke: f64) {
    for half in 0..half_strokes {
        drive.set("sliding_velocity", if half % 2 == 0 { velocity } else { -velocity });
        for _ in 0..parts {
            drive.step(stroke / velocity / f64::from(parts));
        }
    }
}

#[test]
fn worn_volume_is_the_integral_of_the_law() {
    // b = 1: k F s whatever the pressure does.
    let paths: [&[(&str, f64)]; 3] = [
        &[("strip.wear_coefficient", 2e-14)],
        &[("strip.path", 1.0), ("strip.length", 0.0), ("strip.wear_coefficient", 2e-14), ("nominal.stroke", 0.02)],
        &[
            ("strip.path", 1.0),
            ("strip.length", 0.0),
            ("strip.wear_coefficient", 5e-13),
            ("punch.wear_coefficient", 0.0),
        ],
    ];
    for changes in paths {
        let mut drive = line(&[changes, &[("solver.cells", 33.0)]].concat());
        let (mut force_way, mut way): (f64, f64) = (0.0, 0.0);
        for step in 0..60 {
            let phase = f64::from(step) * 0.7;
            let (velocity, load) = (0.02 * phase.sin(), 8e3 * (1.0 + 0.5 * (1.7 * phase).cos()));
            drive.set("sliding_velocity", velocity).set("normal_load", load).step(0.11);
            force_way += load * velocity.abs() * 0.11;
            way += velocity.abs() * 0.11;
        }
        for (name, key) in
            [("wear_volume_punch", "punch.wear_coefficient"), ("wear_volume_strip", "strip.wear_coefficient")]
        {
            let (volume, exact) = (drive.get(name), drive.get(key) * force_way);
            assert!((volume - exact).abs() <= 1e-9 * exact, "{changes:?} {name}: {volume} {exact}");
        }
        assert!((drive.get("sliding_distance") / way - 1.0).abs() < 1e-12);
        let depth = drive.get("wear_depth_punch") * 6e-4;
        assert!((depth - drive.get("wear_volume_punch")).abs() <= 1e-12 * depth);
    }
}

#[test]
fn cutting_a_communication_step_stays_within_the_tolerance() {
    for (tolerance, exponent) in [(1e-2, 1.0), (1e-3, 1.0), (1e-3, 0.5), (1e-3, 2.0), (1e-4, 1.0)] {
        let results: Vec<Vec<f64>> = [1, 7, 60]
            .iter()
            .map(|&parts| {
                let mut drive = line(&[
                    ("solver.tolerance", tolerance),
                    ("punch.wear_pressure_exponent", exponent),
                    ("solver.cells", 33.0),
                ]);
                drive.set("normal_load", 1e4).set("sliding_velocity", 0.5);
                // A third of the relaxation of the slowest mode.
                for _ in 0..parts {
                    drive.step(6.0 / f64::from(parts));
                }
                stations(&mut drive, "profile.pressure")
            })
            .collect();
        let mean = 1e4 / 6e-4;
        for other in &results[1..] {
            for station in 2..31 {
                let difference = (results[0][station] - other[station]).abs() / mean;
                assert!(difference < tolerance, "{tolerance} b = {exponent}, station {station}: {difference:e}");
            }
        }
    }
}

#[test]
fn run_in_starts_in_the_steady_state() {
    for changes in [
        &[("holder.constraint", 1.0)][..],
        &[("holder.constraint", 2.0), ("holder.pivot_height", 0.02)],
        &[("punch.wear_pressure_exponent", 0.5)],
    ] {
        let mut drive = line(&[changes, &[("contact.initial_shape", 3.0), ("solver.cells", 33.0)]].concat());
        drive.set("normal_load", 1e4).set("sliding_velocity", 0.01);
        let start = stations(&mut drive, "profile.pressure");
        for _ in 0..20 {
            drive.step(100.0);
        }
        let end = stations(&mut drive, "profile.pressure");
        let mean = 1e4 / 6e-4;
        for station in 0..33 {
            assert!((start[station] - end[station]).abs() < 1e-6 * mean, "{changes:?} {station}");
        }
        // The mean of the pressure everywhere, or linear with a rotating punch.
        if changes[0].1 == 1.0 {
            assert!(start.iter().all(|p| (p / mean - 1.0).abs() < 1e-6));
        }
        assert!(drive.get("wear_depth") > 0.0);
    }
}

#[test]
fn strokes_end_in_the_two_pressures_of_the_paper() {
    // Half-plane, translation: p+ = pm [1 - (2/pi) arctan(...)], 0 at the leading edge and 2 pm at the trailing one.
    let mut drive = line(&[
        ("strip.path", 1.0),
        ("strip.length", 0.0),
        ("nominal.stroke", 3e-3),
        ("punch.wear_coefficient", 3.9e-13),
        ("solver.cells", 65.0),
        ("solver.tolerance", 1e-4),
    ]);
    drive.set("normal_load", 1e4);
    drive_reciprocating(&mut drive, 3000, 1, 0.01, 3e-3);
    let mean = 1e4 / 6e-4;
    // Mean over a half-stroke from its beginning and its end.
    let half_stroke = |drive: &mut Drive, velocity: f64| -> Vec<f64> {
        let worn = stations(drive, "profile.wear_punch");
        drive.set("sliding_velocity", velocity);
        let start = stations(drive, "profile.pressure");
        assert_eq!(worn, stations(drive, "profile.wear_punch"), "the worn shape does not jump");
        drive.step(0.3);
        let end = stations(drive, "profile.pressure");
        start.iter().zip(&end).map(|(a, b)| 0.5 * (a + b)).collect()
    };
    let forward = half_stroke(&mut drive, 0.01);
    let backward = half_stroke(&mut drive, -0.01);
    let exact = CyclicHalfPlane::new(0.25, HolderKind::Translate { poissons_ratio: 0.3 }).unwrap();
    let spacing = 0.06 / 32.0;
    for station in 4..29 {
        let x = spacing * station as f64 - 0.03;
        let primitive = |x: f64| exact.forward_primitive((x / 0.03).clamp(-1.0, 1.0)) * 0.03;
        let mean_exact = mean * (primitive(x + 0.5 * spacing) - primitive(x - 0.5 * spacing)) / spacing;
        assert!((forward[station] - mean_exact).abs() < 2e-3 * mean, "{x}: {} {mean_exact}", forward[station]);
        assert!((forward[station] + backward[station] - 2.0 * mean).abs() < 2e-3 * mean, "{x}");
    }
    // Trailing edge loaded.
    assert!(forward[0] > 1.5 * mean && forward[32] < 0.5 * mean);
}

#[test]
fn explicit_wear_says_where_it_ends() {
    let mut drive = line(&[("solver.scheme", 3.0), ("solver.cells", 33.0), ("punch.wear_coefficient", 1e-11)]);
    drive.set("normal_load", 1e4).set("sliding_velocity", 0.1);
    let text = drive.0.step(10.0).unwrap_err();
    assert!(text.contains("solver.scheme = explicit") && text.contains("stable only"), "{text}");
    let limit: f64 = text.split("below ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
    assert!(drive.0.step(1.02 * limit).is_err());
    let before = drive.get("pressure_max");
    // The edges relax within the bound.
    for _ in 0..200 {
        drive.step(0.9 * limit);
    }
    assert!(drive.get("pressure_max") < 0.9 * before);
    let coarse = Drive::attempt(&STARTS, &[BASE, &[("solver.scheme", 3.0), ("solver.fidelity", 2.0)]].concat());
    assert!(coarse.err().unwrap().contains("solver.fidelity = line"));
}

#[test]
fn caliper_relaxes_as_the_contact_wears() {
    let stiffness = 1e8;
    for strip in [0.0, 4e-13] {
        let mut drive = line(&[
            ("holder.stiffness", stiffness),
            ("solver.cells", 17.0),
            ("punch.wear_coefficient", 4e-13),
            ("strip.wear_coefficient", strip),
            ("contact.initial_shape", 3.0),
        ]);
        drive.set("normal_load", 1e4).set("sliding_velocity", 0.1);
        assert!((drive.get("pressure_mean") * 6e-4 / 1e4 - 1.0).abs() < 1e-9);
        let start = drive.get("approach");
        for _ in 0..50 {
            drive.step(1.0);
        }
        let load = drive.get("pressure_mean") * 6e-4;
        assert!(load < 0.99e4 && load > 0.0, "{load}");
        // The loss of load is the caliper's stiffness times the displacement of the punch.
        let sunk = drive.get("approach") - start;
        assert!((1e4 - load - stiffness * sunk).abs() < 1e-6 * 1e4, "{load} {sunk}");
        assert!((drive.get("friction_force") / (0.25 * load) - 1.0).abs() < 1e-9);
        assert!(drive.imbalance() < 1e-9);
    }
}

#[test]
fn heat_is_that_of_the_mean() {
    // Without thermal feedback, temperature and energy are those of the lumped level.
    let run = |fidelity: f64| {
        let mut drive = line(&[("solver.fidelity", fidelity), ("strip.wear_coefficient", 1e-14)]);
        drive.set("normal_load", 5e3).set("sliding_velocity", 3.0);
        for _ in 0..30 {
            drive.step(0.5);
        }
        let names = ["contact_temperature", "dissipated_energy", "stored_heat", "friction_force", "wear_depth"];
        names.map(|name| drive.get(name))
    };
    let (line, lumped) = (run(3.0), run(2.0));
    for (a, b) in line.iter().zip(lumped) {
        assert!((a / b - 1.0).abs() < 1e-9, "{line:?} {lumped:?}");
    }
}

#[test]
fn example_wears_towards_its_steady_cycle() {
    let mut starts = scene("reciprocating_punch");
    starts[scene::variables::find("solver.fidelity").unwrap() as usize] = 3.0;
    let mut drive = Drive::from_starts(&starts, &[("solver.cells", 17.0)]);
    drive.set("normal_load", 1e4);
    let mut first = f64::NAN;
    for step in 0..2000 {
        let velocity = 0.015 * (10.0 * 0.01 * (f64::from(step) + 0.5)).cos();
        drive.set("sliding_velocity", velocity).step(0.01);
        if step == 10 {
            first = drive.get("pressure_max");
        }
    }
    assert!(drive.get("pressure_max") < first, "edges relax");
    let pressure = stations(&mut drive, "profile.pressure");
    assert!((trapezoid(&pressure, 0.06) * 0.01 / 1e4 - 1.0).abs() < 1e-12);
}

#[test]
fn the_error_follows_the_tolerance_where_edges_lift_off_and_touch_down() {
    // A parabola wears into contact while the load falls and rises: a cell's wear rate begins or ends like the power b of time.
    // The estimate is that of the method of first order, so that an error of second order is proportional to the tolerance.
    for exponent in [0.3, 0.5, 1.0, 2.0] {
        let run = |tolerance: f64| {
            let mut drive = line(&[
                ("solver.cells", 33.0),
                ("solver.tolerance", tolerance),
                ("contact.initial_shape", 2.0),
                ("contact.initial_radius", 164.0),
                ("punch.wear_pressure_exponent", exponent),
                // The same rate at the mean pressure: 1e-6 m/s.
                ("punch.wear_coefficient", 1e-6 / 1e6 * (MEAN / 1e6).powf(-exponent)),
            ]);
            drive.set("sliding_velocity", 1.0);
            let load = |step: u32| 5e3 * (1.0 + 0.8 * (0.4 * f64::from(step)).sin());
            for step in 0..20 {
                drive.set("normal_load", load(step)).slope("normal_load", (load(step + 1) - load(step)) / 0.25);
                drive.step(0.25);
            }
            let worn = stations(&mut drive, "profile.wear_punch");
            (worn, drive.0.work().0)
        };
        let (truth, _) = run(1e-8);
        let scale = truth.iter().fold(0.0, |most: f64, depth| most.max(*depth));
        let at = |tolerance: f64| {
            let (worn, steps) = run(tolerance);
            let square: f64 = worn.iter().zip(&truth).map(|(a, b)| (a - b).powi(2)).sum();
            ((square / 33.0).sqrt() / scale, steps)
        };
        let results: Vec<(f64, u64)> = (0..5).map(|k| at(1e-2 * 0.1f64.powi(k))).collect();
        for (k, (error, steps)) in results.iter().enumerate() {
            let tolerance = 1e-2 * 0.1f64.powi(k as i32);
            assert!(*error < tolerance, "b = {exponent}, {tolerance:e}: {error:e} in {steps} steps");
        }
        // Two decades of the tolerance: ten times the steps, a hundredth of the error.
        let ratio = (results[4].1 - 20) as f64 / (results[2].1 - 20) as f64;
        assert!((7.0..13.0).contains(&ratio), "b = {exponent}: {results:?}");
    }
}
