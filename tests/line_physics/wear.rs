//! Worn shapes: volumes, time steps, the run-in state, strokes.

use super::contact::{line, trapezoid};
use exact::{CyclicHalfPlane, HolderKind};
use test_support::{Drive, scene};

/// Mean pressure under 10 kN, Pa.
const MEAN: f64 = 1e4 / 6e-4;

fn drive_reciprocating(drive: &mut Drive, half_strokes: u32, parts: u32, velocity: f64, stroke: f64) {
    for half in 0..half_strokes {
        drive.set("sliding_velocity", if half % 2 == 0 { velocity } else { -velocity });
        drive.steps(parts, stroke / velocity / f64::from(parts));
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

/// The first rate of wear under a sharp flat punch, p = P/(pi sqrt(a2 - x2)): over the mean pressure's it is
/// (1/2) (2/pi)^b B(1/2, 1 - b/2), and for b = 1.5 cells come near it with order 1/2. A run that measures its error says so.
#[test]
fn an_unworn_sharp_edge_wears_with_the_order_and_the_error_that_are_stated() {
    // B(1/2, 1/4) and B(1/2, 3/4).
    for (exponent, beta, order) in [(1.5, 5.244_115_108_584_24, 0.5), (0.5, 2.396_280_469_471_18, 1.5)] {
        let exact = 0.5 * f64::powf(2.0 / std::f64::consts::PI, exponent) * beta;
        let found = [33.0, 129.0].map(|cells| {
            let mut drive = line(&[
                ("solver.cells", cells),
                ("solver.tolerance", 1e-4),
                ("solver.error_estimate", 3.0),
                ("solver.heat", 1.0),
                ("contact.shear_coupling", 0.0),
                ("punch.wear_pressure_exponent", exponent),
                ("punch.wear_coefficient", 1e-20),
            ]);
            drive.set("normal_load", 1e4).set("sliding_velocity", 0.01).step(1.0);
            let mean = 1e-20 * 0.01 * 1e6 * f64::powf(MEAN / 1e6, exponent);
            (drive.get("wear_depth") / mean / exact - 1.0, drive.get("estimated_error"))
        });
        println!("b = {exponent}: {found:?}");
        let [(coarse, stated), (fine, _)] = found;
        let observed = (coarse / fine).ln() / (129.0_f64 / 33.0).ln();
        assert!((observed - order).abs() < 0.1, "b = {exponent}: order {observed}, {found:?}");
        assert!((0.2..5.0).contains(&(stated / coarse.abs())), "b = {exponent}: {found:?}");
    }
}

#[test]
fn the_taper_is_that_of_the_profile() {
    // Sliding one way, from the flat shape: uneven pressure wears a wedge.
    let mut drive = line(&[("solver.cells", 33.0), ("contact.friction_coefficient", 0.6)]);
    assert_eq!(drive.get("wear_taper_punch"), 0.0);
    drive.set("sliding_velocity", 0.02).set("normal_load", 8e3).step(200.0);
    let (x, worn) = (drive.profile("x"), drive.profile("wear_punch"));
    // Line of least squares through the stations, those at the edges with half of the weight.
    let weight = |station: usize| if station == 0 || station == 32 { 0.5 } else { 1.0 };
    let sum = |of: &dyn Fn(usize) -> f64| (0..33).map(|station| weight(station) * of(station)).sum::<f64>();
    let mean = sum(&|i| worn[i]) / 32.0;
    let slope = sum(&|i| x[i] * (worn[i] - mean)) / sum(&|i| x[i] * x[i]);
    let (taper, expected) = (drive.get("wear_taper_punch"), 0.06 * slope);
    assert!((taper / expected - 1.0).abs() < 0.01 && expected.abs() > 0.01 * mean, "{taper} {expected} of {mean}");
    // The trailing edge, at -x, is loaded more and wears more.
    assert!(taper < 0.0, "{taper}");
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
                drive.steps(parts, 6.0 / f64::from(parts));
                drive.profile("pressure")
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
        let start = drive.profile("pressure");
        drive.steps(20, 100.0);
        let end = drive.profile("pressure");
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
        let worn = drive.profile("wear_punch");
        drive.set("sliding_velocity", velocity);
        let start = drive.profile("pressure");
        assert_eq!(worn, drive.profile("wear_punch"), "the worn shape does not jump");
        drive.step(0.3);
        let end = drive.profile("pressure");
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
        drive.steps(50, 1.0);
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
        drive.set("normal_load", 5e3).set("sliding_velocity", 3.0).steps(30, 0.5);
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
    let pressure = drive.profile("pressure");
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
            let worn = drive.profile("wear_punch");
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

/// A rigid punch on a Winkler foundation of this stiffness, Pa/m.
const FOUNDATION: f64 = 1e13;
const WINKLER: [(&str, f64); 2] = [("strip.body", 2.0), ("strip.foundation_stiffness", FOUNDATION)];

/// 10 kN on 600 mm2 are 16.7 MPa.
#[test]
fn uniform_pressure_wears_by_what_is_above_the_threshold_at_both_levels() {
    let (load, speed, time) = (1e4, 0.1, 140.0);
    for exponent in [0.6, 1.0, 1.8] {
        for threshold in [0.0, 0.5e6, 0.9e6, 2e6, 16.6e6, 17e6] {
            let laws = [
                ("punch.wear_coefficient", 2e-14),
                ("punch.wear_pressure_exponent", exponent),
                ("punch.wear_threshold", threshold),
                ("strip.wear_coefficient", 1e-14),
                ("strip.wear_threshold", 0.5 * threshold),
            ];
            let above = |threshold: f64| (MEAN - threshold).max(0.0) / 1e6;
            let punch = 2e-14 * 1e6 * above(threshold).powf(exponent) * speed * time;
            // The strip wears along all of its path, 2 m.
            let strip = 1e-14 * 1e6 * above(0.5 * threshold) * speed * time * 0.06 / 2.0;
            for level in [1.0, 3.0] {
                let mut drive = line(&[&WINKLER[..], &laws, &[("solver.fidelity", level)]].concat());
                drive.set("normal_load", load).set("sliding_velocity", speed).steps(7, time / 7.0);
                for (name, exact) in [("wear_depth_punch", punch), ("wear_depth_strip", strip)] {
                    let found = drive.get(name);
                    let case = format!("level {level}, b = {exponent}, threshold {threshold}: {name}");
                    assert!((found - exact).abs() <= 1e-9 * exact, "{case} {found:e}, exact {exact:e}");
                }
            }
        }
    }
    // Without an exponent the volume is that of the load above the threshold, whatever the pressure does above it.
    for (threshold, depth) in [(0.5e6, 4.53e-6), (0.9e6, 4.41e-6), (2e6, 4.11e-6)] {
        let mut drive = line(&[("punch.wear_coefficient", 2e-14), ("punch.wear_threshold", threshold)]);
        drive.set("normal_load", load).set("sliding_velocity", speed).step(time);
        let found = drive.get("wear_depth_punch");
        assert!((found - depth).abs() < 0.005e-6, "{threshold}: {found:e}, {depth:e}");
        let exact = 2e-14 * (MEAN - threshold) * speed * time;
        assert!((found / exact - 1.0).abs() < 1e-9, "{threshold}: {found:e}, {exact:e}");
    }
}

/// Pressure on a Winkler foundation follows from its own place and one approach: a fine explicit integration of a parabolic
/// punch, with ends that do not wear at first.
#[test]
fn uneven_pressure_wears_above_the_threshold() {
    const POINTS: usize = 640;
    let (radius, threshold, speed) = (200.0, 9e6, 0.1);
    let loads = [8e3, 1.4e4, 3e3, 1e4];
    let duration = 20.0;
    for exponent in [0.6, 1.0, 1.8] {
        // The same rate at the mean pressure.
        let coefficient = 2e-14 * ((MEAN - threshold) / 1e6).powf(1.0 - exponent);
        let mut drive = line(
            &[
                &WINKLER[..],
                &[
                    ("contact.initial_shape", 2.0),
                    ("contact.initial_radius", radius),
                    ("punch.wear_coefficient", coefficient),
                    ("punch.wear_pressure_exponent", exponent),
                    ("punch.wear_threshold", threshold),
                    ("solver.tolerance", 1e-4),
                ],
            ]
            .concat(),
        );
        let x = |i: usize| 0.06 * ((i as f64 + 0.5) / POINTS as f64 - 0.5);
        let shape: Vec<f64> = (0..POINTS).map(|i| x(i) * x(i) / (2.0 * radius)).collect();
        let mut worn = vec![0.0; POINTS];
        let pressure = |worn: &[f64], load: f64| -> Vec<f64> {
            let at = |approach: f64| -> Vec<f64> {
                worn.iter().zip(&shape).map(|(w, g)| (FOUNDATION * (approach - g - w)).max(0.0)).collect()
            };
            let (mut low, mut high) = (0.0, 1e-4);
            for _ in 0..50 {
                let middle = 0.5 * (low + high);
                let carried = at(middle).iter().sum::<f64>() * 0.06 / POINTS as f64 * 0.01;
                (low, high) = if carried < load { (middle, high) } else { (low, middle) };
            }
            at(0.5 * (low + high))
        };
        let rates = |pressure: &[f64]| -> Vec<f64> {
            let above = |p: &f64| ((p - threshold).max(0.0) / 1e6).powf(exponent);
            pressure.iter().map(|p| coefficient * 1e6 * above(p) * speed).collect()
        };
        drive.set("sliding_velocity", speed);
        let mut unworn = 0;
        for load in loads {
            drive.set("normal_load", load).step(duration);
            let parts = 400;
            let h = duration / f64::from(parts);
            for _ in 0..parts {
                // The midpoint rule.
                let first = rates(&pressure(&worn, load));
                let middle: Vec<f64> = worn.iter().zip(&first).map(|(w, rate)| w + 0.5 * h * rate).collect();
                let rate = rates(&pressure(&middle, load));
                worn.iter_mut().zip(&rate).for_each(|(w, rate)| *w += h * rate);
            }
            let pressure = pressure(&worn, load);
            let (own, own_worn) = (drive.profile("pressure"), drive.profile("wear_punch"));
            let most = worn.iter().copied().fold(0.0, f64::max);
            for station in 1..32 {
                // Means over the interval of the station, of 1/32 of the width.
                let first = (f64::from(station) - 0.5) / 32.0 * POINTS as f64;
                let range = first.round() as usize..(first + POINTS as f64 / 32.0).round() as usize;
                let mean = |values: &[f64]| values[range.clone()].iter().sum::<f64>() / range.len() as f64;
                let case = format!("b = {exponent}, {load} N, station {station}");
                let difference = (own[station as usize] - mean(&pressure)).abs() / MEAN;
                assert!(difference < 3e-3, "{case}: pressure {difference:e}");
                let difference = (own_worn[station as usize] - mean(&worn)).abs() / most;
                assert!(difference < 3e-3, "{case}: worn {difference:e}");
            }
            unworn = unworn.max(worn.iter().filter(|depth| **depth == 0.0).count());
            let depth = worn.iter().sum::<f64>() / POINTS as f64;
            let found = drive.get("wear_depth_punch");
            assert!((found / depth - 1.0).abs() < 5e-4, "b = {exponent}, {load} N: {found:e} {depth:e}");
        }
        assert!(unworn > POINTS / 50, "b = {exponent}: {unworn}");
    }
}

/// Load and speed fall together within one communication step: with constant friction work and worn volume follow from the integral
/// of their product, v F t (1/2 - 0.7/6). The bodies are hot, so that the heat of the friction does not shorten the steps.
#[test]
fn work_and_wear_under_falling_load_and_speed_do_not_depend_on_the_cuts() {
    let (velocity, load, duration) = (0.05, 130.0, 0.013);
    for (heat, expansion) in [(1.0, 0.0), (1.0, 1e-5), (2.0, 1e-5)] {
        for tolerance in [1e-2, 1e-3, 1e-4] {
            for cuts in [1, 10] {
                let mut drive = Drive::from_starts(
                    &scene("hot_spots"),
                    &[
                        ("solver.fidelity", 3.0),
                        ("solver.cells", 9.0),
                        ("solver.heat", heat),
                        ("solver.tolerance", tolerance),
                        ("punch.initial_at_ambient", 0.0),
                        ("punch.initial_temperature", 500.0),
                        ("punch.thermal_expansion", expansion),
                        ("strip.initial_at_ambient", 0.0),
                        ("strip.initial_temperature", 500.0),
                        ("strip.thermal_expansion", expansion),
                    ],
                );
                for cut in 0..cuts {
                    let (part, length) = (f64::from(cut) / f64::from(cuts), duration / f64::from(cuts));
                    drive.set("sliding_velocity", velocity * (1.0 - 0.7 * part));
                    drive.slope("sliding_velocity", -0.7 * velocity / duration);
                    drive.set("normal_load", load * (1.0 - part)).slope("normal_load", -load / duration);
                    drive.step(length);
                }
                let exact = velocity * load * duration * (0.5 - 0.7 / 6.0);
                let work = 0.3 * exact;
                let volume = drive.get("punch.wear_coefficient") * exact;
                for (name, exact) in [("dissipated_energy", work), ("wear_volume_punch", volume)] {
                    let error = drive.get(name) / exact - 1.0;
                    assert!(error.abs() <= tolerance, "{heat} {expansion} {tolerance:e} {cuts}: {name} {error:e}");
                }
            }
        }
    }
}
