//! Parameters that change during a run: wear coefficients, convection, heat paths and contact conductance, at both levels, against
//! closed forms and against scenes that have the values from the start.

use std::f64::consts::PI;
use test_support::{CONVECTING, Drive, INSULATED, LINE, LUMPED, reference};

const OUTSIDE: f64 = 300.0;
const HOT: f64 = 500.0;
const BODIES: [&str; 2] = ["punch", "strip"];

type Changes<'a> = &'a [(&'a str, f64)];

fn tune(drive: &mut Drive, name: &str, value: f64) {
    let change = (reference(name), value);
    drive.0.check_tuning([change].into_iter()).unwrap();
    drive.0.set_parameter(change.0, change.1);
}

/// Both bodies of the stock brake nearly without gradients, hot, without exchange and losses, and their capacities, J/K.
fn bodies(level: f64, far: f64, changes: Changes) -> (Drive, [f64; 2]) {
    let apart = [
        ("solver.fidelity", level),
        ("solver.cells", 5.0),
        ("solver.tolerance", 1e-6),
        ("ambient_temperature", OUTSIDE),
        ("contact.conductance", 0.0),
        ("contact.friction_coefficient", 0.0),
        ("strip.convection_forced", 0.0),
        ("strip.base_thermal", far),
        ("punch.top_thermal", far),
        ("*.conductivity", 1e5),
        ("*.convection", 0.0),
        ("*.initial_at_ambient", 0.0),
        ("*.initial_temperature", HOT),
        ("*.external_temperature", OUTSIDE),
    ];
    let mut drive = Drive::stock(&[&apart[..], changes].concat());
    let under = [drive.get("punch.width"), 2.0 * PI * drive.get("contact.mean_radius")];
    let capacities = std::array::from_fn(|body| {
        let [height, density, heat] =
            ["height", "density", "specific_heat"].map(|name| value_of(&mut drive, body, name));
        2.0 * under[body] * drive.get("depth") * height * density * heat
    });
    (drive, capacities)
}

fn value_of(drive: &mut Drive, body: usize, name: &str) -> f64 {
    drive.get(&format!("{}.{name}", BODIES[body]))
}

/// Tunes `name` of both bodies to each value, whose conductances to the outside are `per` times it, and compares the relaxation with
/// exponentials. All heat is accounted for.
fn relaxes(mut drive: Drive, capacities: [f64; 2], name: &str, values: &[f64], per: [f64; 2], bound: f64) {
    let mut exact = [HOT; 2];
    for &value in values {
        BODIES.iter().for_each(|body| tune(&mut drive, &format!("{body}.{name}"), value));
        for step in [0.5, 3.0, 8.0, 8.0] {
            drive.step(step);
            let flow = drive.get("heat_flow_strip_base");
            assert!(name == "convection" || (flow == 0.0) == (value == 0.0), "{name} = {value}: {flow}");
            for body in 0..2 {
                exact[body] = OUTSIDE + (exact[body] - OUTSIDE) * (-per[body] * value / capacities[body] * step).exp();
                let found = value_of(&mut drive, body, "mean_temperature");
                assert!((found - exact[body]).abs() < bound, "{name} = {value}: {found} {}", exact[body]);
            }
        }
        assert!(drive.imbalance() < 1e-9, "{name} = {value}: {}", drive.imbalance());
    }
    assert!(exact.iter().all(|t| (OUTSIDE + 2.0..HOT - 30.0).contains(t)), "{exact:?}");
}

#[test]
fn bodies_cool_by_the_convection_of_the_moment() {
    for (level, far, start) in [
        (LUMPED, CONVECTING, 0.0),
        (LUMPED, CONVECTING, 60.0),
        (LINE, INSULATED, 60.0),
        (LINE, CONVECTING, 0.0),
        (LINE, CONVECTING, 60.0),
    ] {
        let (mut drive, capacities) = bodies(level, far, &[("*.convection", start)]);
        let [width, depth, height] = ["punch.width", "depth", "punch.height"].map(|name| drive.get(name));
        let around = 2.0 * PI * drive.get("contact.mean_radius");
        let far = if far == CONVECTING { 1.0 } else { 0.0 };
        let areas = [2.0 * depth * (height + height + far * width), 2.0 * depth * (around - width + far * around)];
        relaxes(drive, capacities, "convection", &[200.0, 800.0, 0.0, 500.0], areas, 0.05);
    }
}

#[test]
fn bodies_cool_by_the_heat_path_of_the_moment() {
    for (level, start) in [(LUMPED, 0.0), (LUMPED, 2.0), (LINE, 0.0), (LINE, 2.0)] {
        let start = [("*.external_conductance", start)];
        let (drive, capacities) = bodies(level, INSULATED, &start);
        relaxes(drive, capacities, "external_conductance", &[2.0, 16.0, 0.0, 9.0], [1.0; 2], 0.02);
    }
}

#[test]
fn bodies_exchange_heat_by_the_conductance_of_the_moment() {
    for (level, start) in [(LUMPED, 0.0), (LUMPED, 500.0), (LINE, 0.0), (LINE, 500.0)] {
        let ring = [
            ("contact.geometry", 3.0),
            ("punch.width", 2.0 * PI * 0.1175),
            ("strip.initial_temperature", OUTSIDE),
            ("contact.conductance", start),
        ];
        let (mut drive, [first, second]) = bodies(level, INSULATED, &ring);
        let area = 2.0 * drive.area();
        let mut apart = HOT - OUTSIDE;
        drive.set("normal_load", 1e3);
        for conductance in [40.0, 0.0, 600.0, 300.0] {
            tune(&mut drive, "contact.conductance", conductance);
            for step in [0.5, 3.0, 8.0] {
                drive.step(step);
                apart *= (-conductance * area * (1.0 / first + 1.0 / second) * step).exp();
                let [punch, strip] = [0, 1].map(|body| value_of(&mut drive, body, "mean_temperature"));
                assert!((punch - strip - apart).abs() < 0.02, "{conductance}: {punch} {strip} {apart}");
            }
            assert!(drive.imbalance() < 1e-9, "{conductance}: {}", drive.imbalance());
        }
        assert!((2.0..110.0).contains(&apart), "{apart}");
    }
}

#[test]
fn bodies_wear_by_the_coefficients_of_the_moment() {
    const STRAIGHT: Changes = &[("strip.path", 1.0), ("strip.length", 0.3), ("nominal.stroke", 0.1)];
    const ANNULAR: Changes = &[("contact.geometry", 2.0), ("punch.width", 0.02)];
    let cases: [(f64, Changes, f64); 6] = [
        (LUMPED, &[], 0.0),
        (LUMPED, STRAIGHT, 1e-14),
        (LINE, &[], 0.0),
        (LINE, &[], 1e-14),
        (LINE, ANNULAR, 0.0),
        (LINE, STRAIGHT, 1e-14),
    ];
    for (level, changes, start) in cases {
        let own = [("solver.fidelity", level), ("solver.cells", 5.0), ("*.wear_coefficient", start)];
        let mut drive = Drive::stock(&[&own[..], changes].concat());
        drive.set("normal_load", 3e3);
        let friction = drive.get("contact.friction_coefficient");
        let (mut worn, mut speed) = ([0.0; 2], 2.0);
        for coefficients in [[2e-14, 1e-15], [0.0, 3e-15], [5e-14, 0.0], [0.0, 0.0], [1e-14, 1e-14]] {
            for (body, k) in BODIES.iter().zip(coefficients) {
                tune(&mut drive, &format!("{body}.wear_coefficient"), k);
            }
            for _ in 0..3 {
                speed = -speed;
                let before = drive.get("dissipated_energy");
                drive.set("sliding_velocity", speed).step(0.05);
                let work = drive.get("dissipated_energy") - before;
                (0..2).for_each(|body| worn[body] += coefficients[body] * work / friction);
                for body in 0..2 {
                    let found = drive.get(&format!("wear_volume_{}", BODIES[body]));
                    assert!((found - worn[body]).abs() <= 1e-9 * worn[body], "level {level}: {found} {}", worn[body]);
                }
            }
        }
    }
}

/// What is tuned all at once, from which and to which values.
const MOVED: [(&str, f64, f64); 7] = [
    ("punch.wear_coefficient", 1e-14, 4e-14),
    ("strip.wear_coefficient", 1e-15, 3e-15),
    ("punch.convection", 5.0, 80.0),
    ("strip.convection", 120.0, 15.0),
    ("punch.external_conductance", 0.0, 3.0),
    ("strip.external_conductance", 4.0, 1.0),
    ("contact.conductance", 5e4, 8e3),
];

/// The stock brake with these changes at the values before or after, behind heat paths at the ambient temperature.
fn brake_with(changes: Changes, value: impl Fn(f64, f64) -> f64) -> Drive {
    let moved = MOVED.map(|(name, from, to)| (name, value(from, to)));
    Drive::stock(&[&moved[..], &[("*.external_temperature", 293.15)], changes].concat())
}

fn brake(drive: &mut Drive) {
    drive.set("normal_load", 4e3).set("strip.external_temperature", 330.0).set("punch.external_temperature", 310.0);
    for step in 0..60 {
        drive.set("sliding_velocity", 12.0 - 0.05 * f64::from(step)).step(0.05);
    }
}

#[test]
fn a_scene_tuned_at_the_start_runs_as_one_that_has_the_values() {
    const COMPANION: Changes = &[("solver.error_estimate", 3.0)];
    const TABLE: Changes = &[("strip.property_table.points", 2.0), ("punch.property_table.points", 2.0)];
    // Without expansion: 50 times above the critical speed of this ring any difference grows.
    const ANNULAR: Changes =
        &[("contact.geometry", 2.0), ("punch.width", 0.04), ("depth", 0.1), ("*.thermal_expansion", 0.0)];
    for (level, changes) in
        [(LUMPED, &[][..]), (LUMPED, COMPANION), (LUMPED, TABLE), (LINE, &[]), (LINE, TABLE), (LINE, ANNULAR)]
    {
        let own =
            [&[("solver.fidelity", level), ("solver.cells", 9.0), ("solver.tolerance", 1e-5)][..], changes].concat();
        let mut tuned = brake_with(&own, |from, _| from);
        MOVED.iter().for_each(|&(name, _, value)| tune(&mut tuned, name, value));
        let mut direct = brake_with(&own, |_, to| to);
        [&mut tuned, &mut direct].into_iter().for_each(brake);
        for (name, bound) in [
            ("wear_depth_punch", 1e-4),
            ("wear_depth_strip", 1e-4),
            ("contact_temperature", 1e-4),
            ("punch.mean_temperature", 1e-4),
            ("strip.mean_temperature", 1e-4),
            ("heat_lost_ambient", 1e-2),
            ("heat_lost_punch_external", 1e-2),
            ("heat_lost_strip_external", 1e-2),
            ("heat_flow_ambient", 1e-2),
            ("critical_speed", 1e-12),
            ("friction_force", 1e-3),
        ] {
            let [found, expected] = [&mut tuned, &mut direct].map(|drive| drive.get(name));
            assert!((found - expected).abs() <= bound * expected.abs(), "{changes:?} {name}: {found} {expected}");
        }
        assert!(tuned.imbalance() < 1e-9);
    }
}

#[test]
fn what_the_states_or_the_rules_do_not_permit_is_refused_before_the_step() {
    let refusal = |changes: Changes, name: &str, value: f64| {
        Drive::stock(changes).0.check_tuning([(reference(name), value)].into_iter()).unwrap_err()
    };
    let track =
        [("solver.fidelity", LINE), ("strip.path", 1.0), ("strip.length", 0.3), ("strip.wear_coefficient", 0.0)];
    for (text, parts) in [
        (refusal(&track, "strip.wear_coefficient", 2e-15), ["strip.wear_coefficient = ", "above 0 at initialisation"]),
        (
            refusal(&[("punch.conductivity", 0.0)], "contact.conductance", 0.0),
            ["contact.conductance = 0", "must be > 0"],
        ),
        (
            refusal(&[("strip.base_thermal", 1.0)], "strip.external_conductance", 2.0),
            ["strip.external_conductance = 2 W/K", "is prescribed"],
        ),
    ] {
        parts.iter().for_each(|part| assert!(text.contains(part), "{text}"));
    }
}
