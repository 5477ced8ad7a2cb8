//! Heat paths to neighbours: hub and caliper. Both levels, against closed forms, and as balances.

use scene::Scene;
use scene::slot::Packaged;
use test_support::{CONVECTING, Drive, HELD, INSULATED, LINE, LUMPED, changed};

const PATHS: [(&str, f64); 4] = [
    ("strip.external_conductance", 12.0),
    ("punch.external_conductance", 3.0),
    ("strip.external_temperature", 300.0),
    ("punch.external_temperature", 300.0),
];
/// Parameters by name.
type Changes = &'static [(&'static str, f64)];
/// Forced convection and radiation on every cooled surface.
const AIR: [(&str, f64); 4] = [
    ("punch.emissivity", 0.5),
    ("strip.emissivity", 0.8),
    ("punch.convection_forced", 20.0),
    ("strip.convection_forced", 20.0),
];

fn far(thermal: f64) -> [(&'static str, f64); 2] {
    [("strip.base_thermal", thermal), ("punch.top_thermal", thermal)]
}

/// The stock disc without any loss but by its path, nearly without gradients: capacity in J/K.
fn lone_disc(conductance: f64) -> (Drive, f64) {
    let mut drive = Drive::stock(&[
        ("strip.external_conductance", conductance),
        ("strip.external_temperature", 300.0),
        ("strip.conductivity", 1e5),
        ("strip.convection", 0.0),
        ("strip.convection_forced", 0.0),
        ("strip.initial_at_ambient", 0.0),
        ("strip.initial_temperature", 500.0),
        ("contact.conductance", 0.0),
        ("solver.tolerance", 1e-6),
    ]);
    let [height, depth, density, heat] =
        ["strip.height", "depth", "strip.density", "strip.specific_heat"].map(|name| drive.get(name));
    let around = 2.0 * std::f64::consts::PI * drive.get("contact.mean_radius");
    (drive, 2.0 * around * depth * height * density * heat)
}

#[test]
fn a_disc_relaxes_exponentially_towards_a_neighbour_of_constant_temperature() {
    let (conductance, outside) = (40.0, 300.0);
    for step in [1.0, 7.0] {
        let (mut drive, capacity) = lone_disc(conductance);
        drive.set("strip.external_temperature", outside);
        for index in 1..=30 {
            drive.step(step);
            let decay = (-conductance / capacity * step * f64::from(index)).exp();
            let exact = outside + (500.0 - outside) * decay;
            let found = drive.get("strip.mean_temperature");
            assert!((found - exact).abs() < 1e-4 * (500.0 - outside), "{step} {index}: {found} {exact}");
            let flow = drive.get("heat_flow_strip_external");
            assert!((flow - conductance * (exact - outside)).abs() < 1e-3 * conductance * 200.0, "{flow}");
            let lost = drive.get("heat_lost_strip_external");
            assert!((lost + drive.get("stored_heat")).abs() < 1e-9 * lost && lost > 0.0, "{lost}");
            assert!((lost - capacity * (500.0 - found)).abs() < 1e-4 * lost, "{lost}");
        }
    }
}

#[test]
fn two_capacities_and_a_conductance_exchange_heat_as_in_the_closed_form() {
    let (conductance, second) = (40.0, 1500.0);
    let error = |step: f64| {
        let (mut drive, first) = lone_disc(conductance);
        let (mut t, mut received) = (300.0, 0.0);
        let rate = conductance * (1.0 / first + 1.0 / second);
        let mut worst = 0.0_f64;
        for index in 1..=(60.0 / step) as i32 {
            // The neighbour's temperature at its present rate, then corrected by the heat that has flowed.
            let flow = drive.set("strip.external_temperature", t).get("heat_flow_strip_external");
            drive.slope("strip.external_temperature", flow / second).step(step);
            let lost = drive.get("heat_lost_strip_external");
            t += (lost - received) / second;
            received = lost;
            let difference = 200.0 * (-rate * step * f64::from(index)).exp();
            let end = (first * 500.0 + second * 300.0) / (first + second);
            let exact = [end + second / (first + second) * difference, end - first / (first + second) * difference];
            worst = worst.max((drive.get("strip.mean_temperature") - exact[0]).abs()).max((t - exact[1]).abs());
            // Energy over both, whatever the step.
            let stored = drive.get("stored_heat") + second * (t - 300.0);
            assert!(stored.abs() < 1e-9 * lost, "{stored} {lost}");
        }
        worst
    };
    let [coarse, fine] = [4.0, 2.0].map(error);
    assert!(fine < 0.1 && coarse > 3.0 * fine && coarse < 6.0 * fine, "of second order: {coarse} {fine}");
}

#[test]
fn the_balance_closes_with_the_heat_of_the_paths_at_every_level() {
    const ANNULAR: Changes = &[("contact.geometry", 2.0), ("strip.length", 0.0)];
    let (plain, cooled) = ((INSULATED, &[][..]), (CONVECTING, &AIR[..]));
    let all = [plain, (INSULATED, &AIR), (CONVECTING, &[]), cooled];
    let both = [plain, cooled];
    // Level, geometry, boundaries, steps and their length, s.
    let cases: [(f64, Changes, &[_], i32, f64); 4] = [
        (LUMPED, &[], &all, 40, 0.25),
        (LUMPED, ANNULAR, &all, 40, 0.25),
        (LINE, &[], &both, 8, 0.05),
        (LINE, ANNULAR, &both, 4, 0.05),
    ];
    for (level, geometry, boundaries, steps, length) in cases {
        for &(thermal, air) in boundaries {
            let cells = [("solver.fidelity", level), ("solver.cells", 5.0)];
            let mut drive = Drive::stock(&[&cells[..], &far(thermal), &PATHS, geometry, air].concat());
            let text = format!("level {level}, geometry {geometry:?}, thermal {thermal}, air {air:?}");
            drive.set("normal_load", 3e3).set("punch.external_temperature", 290.0);
            let mut flowed = [0.0; 2];
            let names = ["heat_flow_strip_external", "heat_flow_punch_external"];
            for step in 0..steps {
                let speed = 6.0 * (0.8 * length * f64::from(step)).cos();
                drive.set("sliding_velocity", speed).set("strip.external_temperature", 330.0 + 0.5 * f64::from(step));
                let before = names.map(|name| drive.get(name));
                drive.step(length);
                for (side, name) in names.iter().enumerate() {
                    flowed[side] += 0.5 * length * (before[side] + drive.get(name));
                }
            }
            let imbalance = drive.imbalance();
            assert!(imbalance < 1e-9, "{text}: {imbalance}");
            let bodies = [("strip_external", "strip_base"), ("punch_external", "punch_top")];
            for ((path, face), flowed) in bodies.into_iter().zip(flowed) {
                let [lost, left] = [path, face].map(|name| drive.get(&format!("heat_lost_{name}")));
                let [flow, out] = [path, face].map(|name| drive.get(&format!("heat_flow_{name}")));
                assert!(lost != 0.0 && (flowed - lost).abs() < 0.03 * lost.abs(), "{text}: {path} {flowed} {lost}");
                if thermal == INSULATED {
                    assert!((lost - left).abs() < 1e-9 * lost.abs(), "{text}: {path} {lost} {left}");
                    assert!((flow - out).abs() < 1e-6 * flow.abs() + 1e-9, "{text}: {path} {flow} {out}");
                }
            }
        }
    }
}

#[test]
fn both_levels_exchange_the_same_heat_with_their_neighbours() {
    let run = |level: f64| {
        let changes = [&[("solver.fidelity", level), ("solver.cells", 9.0)][..], &far(INSULATED), &PATHS].concat();
        let mut drive = Drive::stock(&changes);
        drive.set("normal_load", 3e3).set("sliding_velocity", 5.0);
        drive.set("strip.external_temperature", 300.0).set("punch.external_temperature", 300.0).steps(40, 0.5);
        ["strip", "punch"].map(|body| drive.get(&format!("heat_lost_{body}_external")))
    };
    for (lumped, line) in run(LUMPED).into_iter().zip(run(LINE)) {
        assert!((lumped / line - 1.0).abs() < 0.02, "{lumped} {line}");
    }
}

#[test]
fn a_prescribed_temperature_is_a_path_without_resistance() {
    for level in [LUMPED, LINE] {
        let external = [("strip.base_thermal", 4.0), ("strip.external_temperature", 300.0)];
        let mut drive = Drive::stock(&[external, [("solver.fidelity", level), ("solver.cells", 9.0)]].concat());
        drive.set("normal_load", 3e3).set("sliding_velocity", 5.0).set("strip.external_temperature", 320.0);
        drive.step(1.0).step(1.0);
        for kind in ["flow", "lost"] {
            let [port, face] = ["external", "base"].map(|name| drive.get(&format!("heat_{kind}_strip_{name}")));
            assert!(port != 0.0 && port == face, "{port} {face}");
        }
    }
}

#[test]
fn a_path_that_cannot_be_is_refused_and_a_neighbour_of_nothing_is_an_error() {
    let refused = |changes: &[(&str, f64)]| {
        Scene::new(&changed(&Packaged::stock().starts, changes), None).unwrap_err().to_string()
    };
    let held = refused(&[PATHS[0], ("strip.base_thermal", HELD)]);
    assert!(held.contains("strip.external_conductance = 12 W/K needs strip.base_thermal = insulated or"), "{held}");
    let insulator = refused(&[PATHS[1], ("punch.top_thermal", INSULATED), ("punch.conductivity", 0.0)]);
    assert!(insulator.contains("punch.conductivity > 0"), "{insulator}");
    let open = refused(&[PATHS[0], ("strip.path", 1.0)]);
    assert!(open.contains("needs strip.path = closed"), "{open}");
    let mut drive = Drive::stock(&[PATHS[0], PATHS[2]]);
    let error = drive.set("strip.external_temperature", 0.0).0.step(0.1).unwrap_err();
    assert_eq!(
        error,
        "strip.external_temperature = 0 K must be above 0 K, because strip.external_conductance = 12 W/K"
    );
}
