//! The bristle that holds at standstill, and the caliper between actuator and punch.

use test_support::Drive;

const STIFFNESS: f64 = 1e6;
/// mu F of both faces at 5 kN.
const LIMIT: f64 = 2.0 * 0.4 * 5e3;

fn bristle(damping: f64) -> Drive {
    let mut drive = Drive::stock(&[("contact.stick_stiffness", STIFFNESS), ("contact.stick_damping", damping)]);
    drive.set("normal_load", 5e3);
    drive
}

#[test]
fn a_bristle_holds_below_the_limit_without_creep_heat_or_wear() {
    let mut drive = bristle(0.0);
    drive.set("sliding_velocity", 1e-3).step(1.0).set("sliding_velocity", 0.0);
    assert!((drive.get("friction_force") - 1e-3 * STIFFNESS).abs() < 1e-9);
    drive.steps(1000, 1.0);
    assert!((drive.get("friction_force") - 1e-3 * STIFFNESS).abs() < 1e-9, "{}", drive.get("friction_force"));
    assert!((drive.get("bristle_energy") - 0.5 * STIFFNESS * 1e-6).abs() < 1e-12);
    for name in ["dissipated_energy", "wear_depth", "sliding_distance"] {
        assert_eq!(drive.get(name), 0.0, "{name}");
    }
    assert!((drive.get("friction_force_limit") - LIMIT).abs() < 1e-9);
}

#[test]
fn above_the_limit_it_slips_and_the_work_is_heat_or_kept() {
    for damping in [0.0, 2e4] {
        let mut drive = bristle(damping);
        let (mut work, step) = (0.0, 1e-3);
        for index in 0..4000 {
            // Reciprocating, past the limit in both directions.
            let v = if (index / 1000) % 2 == 0 { 0.01 } else { -0.02 };
            drive.set("sliding_velocity", v);
            let before = drive.get("friction_force");
            drive.step(step);
            let after = drive.get("friction_force");
            assert!(after.abs() <= LIMIT * (1.0 + 1e-12));
            work += 0.5 * step * v * (before + after);
        }
        let (heat, kept) = (drive.get("dissipated_energy"), drive.get("bristle_energy"));
        assert!((work - heat - kept).abs() < 2e-3 * work, "damping {damping}: {work} {heat} {kept}");
        assert!((drive.get("friction_force") + LIMIT).abs() < 1e-9);
        assert!(drive.imbalance() < 1e-9);
        // k F s over the distance that was slipped: all of it but what deflected the bristles.
        let slipped = drive.get("sliding_distance");
        assert!(slipped > 0.03 && slipped < 0.06, "{slipped}");
        let worn = drive.get("wear_volume_punch") / (2.0 * 2e-14 * 5e3 * slipped);
        assert!((worn - 1.0).abs() < 1e-6, "damping {damping}: {worn}");
    }
}

#[test]
fn one_long_step_of_a_bristle_is_many_short_ones() {
    for damping in [0.0, 2e4] {
        let end = |steps: u32| {
            let mut drive = bristle(damping);
            for v in [0.02, -0.01, 0.0] {
                for _ in 0..steps {
                    drive.set("sliding_velocity", v).step(2.0 / f64::from(steps));
                }
            }
            ["friction_force", "dissipated_energy", "sliding_distance", "bristle_energy"].map(|name| drive.get(name))
        };
        let (one, many) = (end(1), end(500));
        for (a, b) in one.iter().zip(&many) {
            assert!((a - b).abs() <= 1e-6 * b.abs() + 1e-12, "damping {damping}: {one:?} {many:?}");
        }
    }
}

/// Rigid bodies loaded through a caliper of 10 MN/m.
const CALIPER: &[(&str, f64)] = &[
    ("punch.body", 1.0),
    ("strip.body", 1.0),
    ("holder.stiffness", 1e7),
    ("solver.tolerance", 1e-5),
    ("strip.wear_coefficient", 0.0),
    ("punch.wear_coefficient", 1e-12),
];

#[test]
fn wear_relaxes_a_caliper_exponentially() {
    let cold = [CALIPER, &[("punch.thermal_expansion", 0.0), ("strip.thermal_expansion", 0.0)]].concat();
    for parts in [1, 7, 50] {
        let mut drive = Drive::stock(&cold);
        drive.set("normal_load", 5e3).set("sliding_velocity", 10.0);
        let area = drive.area();
        let p0 = drive.get("pressure_mean");
        assert!((p0 - 5e3 / area).abs() < 1e-6 * p0);
        drive.steps(parts, 100.0 / f64::from(parts));
        // dp/dt = -K k p v/A.
        let exponent: f64 = -1e7 * 1e-12 * 10.0 * 100.0 / area;
        let exact = exponent.exp();
        let ratio = drive.get("pressure_mean") / p0;
        assert!((ratio - exact).abs() < 5e-5, "{parts}: {ratio} {exact}");
        let depth = drive.get("wear_depth_punch");
        assert!((depth * 1e7 / 5e3 - (1.0 - exact)).abs() < 5e-5, "{parts}: {depth}");
    }
}

#[test]
fn expansion_loads_a_caliper() {
    let hot = [CALIPER, &[("punch.wear_coefficient", 0.0)]].concat();
    let mut drive = Drive::stock(&hot);
    drive.set("normal_load", 5e3).set("sliding_velocity", 10.0);
    let mut before = 5e3;
    for _ in 0..20 {
        drive.step(1.0);
        let load = drive.get("pressure_mean") * drive.area();
        assert!(load > before, "{load} {before}");
        before = load;
    }
    // Free sides: alpha (1 + nu) h; wide: alpha (1 + nu)/(1 - nu) h.
    let punch = 1.5e-5 * 1.25 * 0.012 * (drive.get("punch.mean_temperature") - 293.15);
    let strip = 1.1e-5 * 1.26 / 0.74 * 0.011 * (drive.get("strip.mean_temperature") - 293.15);
    let exact = 5e3 + 1e7 * (punch + strip);
    assert!((before / exact - 1.0).abs() < 1e-6, "{before} {exact}");
    assert!(drive.imbalance() < 1e-9);
}

/// Warm layers in full periodic contact behind a caliper, at both levels: without ends they cannot expand sideways, whatever their
/// base, so per kelvin they grow by alpha (1 + nu)/(1 - nu) of their height, and give way by their height over lambda + 2G.
#[test]
fn periodic_layers_load_a_caliper_alike_at_both_levels() {
    let (width, depth, stiffness, rise) = (0.5, 0.02, 3e8, 10.0);
    let punch = [1e9, 0.25, 0.012, 1.5e-5];
    let strip = [1.1e9, 0.3, 0.05, 1.1e-5];
    let layer = |[e, nu, height, alpha]: [f64; 4]| {
        let confined = height * (1.0 + nu) * (1.0 - 2.0 * nu) / (e * (1.0 - nu));
        [confined, alpha * (1.0 + nu) / (1.0 - nu) * height]
    };
    let [one, other] = [layer(punch), layer(strip)];
    let compliance = (one[0] + other[0]) / (width * depth);
    let exact = 4e3 + rise * (one[1] + other[1]) / (1.0 / stiffness + compliance);
    for base in [1.0, 2.0] {
        // Elastic layers have the closed form; the levels agree with every body.
        for body in [4.0, 3.0, 2.0] {
            let load = |level: f64| {
                let mut drive = Drive::stock(&[
                    ("solver.fidelity", level),
                    ("solver.cells", 9.0),
                    ("solver.tolerance", 1e-4),
                    ("contact.geometry", 3.0),
                    ("contact.faces", 1.0),
                    ("punch.width", width),
                    ("strip.path", 2.0),
                    ("strip.length", width),
                    ("depth", depth),
                    ("punch.body", body),
                    ("punch.youngs_modulus", punch[0]),
                    ("punch.poissons_ratio", punch[1]),
                    ("punch.height", punch[2]),
                    ("punch.thermal_expansion", punch[3]),
                    ("strip.body", 4.0),
                    ("strip.youngs_modulus", strip[0]),
                    ("strip.poissons_ratio", strip[1]),
                    ("strip.height", strip[2]),
                    ("strip.thermal_expansion", strip[3]),
                    ("strip.base", base),
                    ("punch.top_thermal", 3.0),
                    ("strip.base_thermal", 3.0),
                    ("punch.initial_at_ambient", 0.0),
                    ("strip.initial_at_ambient", 0.0),
                    ("punch.initial_temperature", 293.15 + rise),
                    ("strip.initial_temperature", 293.15 + rise),
                    ("holder.stiffness", stiffness),
                    ("punch.wear_coefficient", 0.0),
                    ("strip.wear_coefficient", 0.0),
                ]);
                drive.set("normal_load", 4e3).step(1.0);
                drive.get("pressure_mean") * width * depth
            };
            let [lumped, line] = [2.0, 3.0].map(load);
            println!("base {base}, punch {body}: {lumped} N, {line} N");
            assert!((line / lumped - 1.0).abs() < 1e-4, "base {base}, punch {body}: {lumped} {line}");
            assert!(body != 4.0 || (line / exact - 1.0).abs() < 1e-4, "base {base}: {line} {exact}");
        }
    }
}
