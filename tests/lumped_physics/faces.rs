//! Heat loss of convecting tops and bases: constant and forced convection and radiation, as on every free face.

use crate::slab::Slab;
use test_support::{CONVECTING, Drive, HELD, INSULATED};

const AREA: f64 = 0.1;
const AMBIENT: f64 = 300.0;
const CONVECTION: f64 = 12.0;
const FORCED: f64 = 40.0;
const EMISSIVITY: f64 = 0.8;

/// A one-dimensional scene: punch and strip cover each other entirely, and their sides are not cooled.
const COVERED: &[(&str, f64)] = &[
    ("contact.geometry", 3.0),
    ("punch.width", 1.0),
    ("strip.length", 1.0),
    ("depth", 0.1),
    ("contact.faces", 1.0),
    ("contact.friction_coefficient", 1.0),
    ("contact.conductance", 1e9),
    ("punch.cooled_area", 1e-12),
    ("punch.wear_coefficient", 0.0),
    ("strip.wear_coefficient", 0.0),
    ("punch.top_thermal", INSULATED),
    ("strip.base_thermal", INSULATED),
    ("ambient_temperature", AMBIENT),
    ("nominal.velocity", 0.0),
    ("nominal.load", 0.0),
    ("nominal.duration", 400.0),
    // Heat is on the cells of the line, and moves nothing.
    ("punch.thermal_expansion", 1e-10),
    ("strip.thermal_expansion", 1e-10),
    ("solver.tolerance", 1e-4),
];

/// The scene in which only `body` conducts, and the equivalent slab: 10 mm of iron, or of a poorly conducting lining.
fn alone(body: &str, conductivity: f64, more: &[(&str, f64)]) -> (Drive, Slab) {
    let (other, face) = if body == "punch" { ("strip", "punch.top_thermal") } else { ("punch", "strip.base_thermal") };
    let mut changes: Vec<(String, f64)> = COVERED.iter().map(|(name, value)| ((*name).to_owned(), *value)).collect();
    let own = [
        ("conductivity", conductivity),
        ("height", 0.01),
        ("density", 7200.0),
        ("specific_heat", 460.0),
        ("convection", CONVECTION),
        ("convection_forced", FORCED),
        ("emissivity", EMISSIVITY),
    ];
    changes.extend(own.map(|(name, value)| (format!("{body}.{name}"), value)));
    changes.extend([(format!("{other}.conductivity"), 0.0), (face.to_owned(), CONVECTING)]);
    changes.extend(more.iter().map(|(name, value)| ((*name).to_owned(), *value)));
    let changes: Vec<(&str, f64)> = changes.iter().map(|(name, value)| (name.as_str(), *value)).collect();
    let slab = Slab {
        height: 0.01,
        conductivity,
        capacity: 7200.0 * 460.0,
        convection: CONVECTION,
        convection_forced: FORCED,
        emissivity: EMISSIVITY,
        ambient: AMBIENT,
    };
    (Drive::stock(&changes), slab)
}

/// Heats with 3e4 W/m2, raises the air speed, then cools, in steps of `step` s: contact and mean temperature, heat lost per area.
fn course(drive: &mut Drive, body: &str, step: f64) -> [f64; 3] {
    for (velocity, cooling, load) in [(2.0, 0.0, 1.5e3), (2.0, 6.0, 1.5e3), (2.0, 6.0, 0.0)] {
        drive.set("sliding_velocity", velocity).set("cooling_velocity", cooling).set("normal_load", load);
        drive.steps((100.0 / step) as u32, step);
    }
    let lost = if body == "punch" { "heat_lost_punch_top" } else { "heat_lost_strip_base" };
    ["contact_temperature", &format!("{body}.mean_temperature"), lost].map(|name| drive.get(name))
}

const PHASES: [(f64, f64, f64); 3] = [(3e4, 2.0, 100.0), (3e4, 8.0, 100.0), (0.0, 8.0, 100.0)];

/// At every level and for either body, temperatures and heat lost equal those of an independent finite-volume solution.
#[test]
fn a_convecting_far_face_cools_as_a_slab_of_finite_volumes() {
    let line = [("solver.fidelity", 3.0), ("solver.cells", 9.0)];
    for (level, more) in [("lumped", &[][..]), ("line", &line[..])] {
        for body in ["punch", "strip"] {
            for conductivity in [54.0, 1.0] {
                let (mut drive, slab) = alone(body, conductivity, more);
                let found = course(&mut drive, body, 1.0);
                let exact = slab.run(&PHASES);
                let rise = 3e4 * 100.0 / (slab.capacity * slab.height);
                println!("{level} {body} {conductivity}: {found:?} {exact:?}");
                assert!(
                    (found[0] - exact.face).abs() < 1.5e-3 * rise,
                    "{level} {body} {conductivity}: {found:?} {exact:?}"
                );
                assert!(
                    (found[1] - exact.mean).abs() < 1e-3 * rise,
                    "{level} {body} {conductivity}: {found:?} {exact:?}"
                );
                assert!((found[2] / AREA / exact.lost - 1.0).abs() < 2e-3, "{level} {body}: {found:?} {exact:?}");
                assert!(exact.lost > 0.4 * 3e4 * 200.0 * conductivity / 54.0, "{exact:?}");
                assert!(drive.imbalance() < 1e-9, "{level} {body}: {:e}", drive.imbalance());
            }
        }
    }
}

/// Steady state: the heat flux through the slab equals the loss of the far face at its temperature, and conduction gives the
/// rise.
#[test]
fn a_steady_far_face_gives_off_what_enters() {
    let line = [("solver.fidelity", 3.0), ("solver.cells", 9.0)];
    for more in [&[][..], &line] {
        for body in ["punch", "strip"] {
            let (mut drive, slab) = alone(body, 54.0, more);
            drive.set("sliding_velocity", 3.0).set("normal_load", 1e3).steps(200, 20.0);
            let flux = 3e4;
            let mut t = AMBIENT;
            for _ in 0..60 {
                let [lost, slope] = slab.loss(t, 3.0);
                t -= (lost - flux) / slope;
            }
            let expected = t + flux * slab.height / slab.conductivity;
            let found = drive.get("contact_temperature");
            assert!((found - expected).abs() < 1e-4 * (expected - AMBIENT), "{body}: {found} {expected}");
            let flow = drive.get(if body == "punch" { "heat_flow_punch_top" } else { "heat_flow_strip_base" });
            let (air, power) = (drive.get("heat_flow_ambient"), drive.get("friction_power"));
            assert!((flow / power - 1.0).abs() < 1e-4 && air.abs() < 1e-4 * power, "{body}: {flow} {air} {power}");
            assert!(drive.imbalance() < 1e-9, "{body}: {:e}", drive.imbalance());
        }
    }
}

/// Second order in time: half the step, a quarter of the error.
#[test]
fn cooling_of_the_far_face_is_of_second_order_in_time() {
    for (body, level) in [("punch", 2.0), ("strip", 2.0), ("punch", 3.0), ("strip", 3.0)] {
        let run = |parts: u32| {
            // A tolerance at which no step is cut, and strong cooling.
            let forced = format!("{body}.convection_forced");
            let more = [
                (forced.as_str(), 400.0),
                ("solver.fidelity", level),
                ("solver.cells", 9.0),
                ("solver.tolerance", 0.1),
            ];
            let (mut drive, _) = alone(body, 54.0, &more);
            drive.set("normal_load", 1e3);
            let (duration, velocity) = (100.0, |time: f64| 3.0 * (time / 100.0_f64).powi(3));
            let step = duration / f64::from(parts);
            for part in 0..parts {
                let time = step * f64::from(part);
                let (from, to) = (velocity(time), velocity(time + step));
                drive.set("sliding_velocity", from).slope("sliding_velocity", (to - from) / step);
                drive.step(step);
            }
            drive.get("contact_temperature")
        };
        let values = [40, 80, 160, 320].map(run);
        let changes = [0, 1, 2].map(|k| (values[k + 1] - values[k]).abs());
        let order = (changes[0] / changes[2]).log2() / 2.0;
        println!("{body} {level}: order {order}, {values:?}");
        assert!(order > 1.85 && changes[2] < 1e-2, "{body} {level}: {order} {values:?}");
    }
}

/// A hot punch out of contact, its top insulated: all round it has no sides and keeps its heat; the given area cools it at
/// `h A/(rho c V)`, and of the two sides of a block it is 2 height x depth.
#[test]
fn a_punch_all_round_has_no_sides_to_cool() {
    let (width, height, depth) = (0.2, 0.01, 0.05);
    for level in [2.0, 3.0] {
        for (geometry, given, area) in
            [(3.0, 0.0, 0.0), (3.0, 2e-3, 2e-3), (1.0, 0.0, 2.0 * height * depth), (1.0, 2e-3, 2e-3)]
        {
            let mut drive = Drive::stock(&[
                ("solver.fidelity", level),
                ("solver.cells", 9.0),
                ("solver.tolerance", 1e-4),
                ("contact.geometry", geometry),
                ("punch.width", width),
                ("punch.height", height),
                ("depth", depth),
                ("strip.path", 2.0),
                ("strip.length", if geometry == 3.0 { width } else { 1.0 }),
                ("punch.conductivity", 400.0),
                ("punch.density", 8000.0),
                ("punch.specific_heat", 400.0),
                ("punch.convection", 20.0),
                ("punch.convection_forced", 0.0),
                ("punch.emissivity", 0.0),
                ("punch.cooled_area", given),
                ("punch.top_thermal", INSULATED),
                ("punch.initial_at_ambient", 0.0),
                ("punch.initial_temperature", AMBIENT + 100.0),
                ("ambient_temperature", AMBIENT),
                ("nominal.duration", 1000.0),
            ]);
            drive.set("sliding_velocity", 1.0).step(1000.0);
            let exact = 100.0 * f64::exp(-20.0 * area * 1000.0 / (8000.0 * 400.0 * width * height * depth));
            let found = drive.get("punch.mean_temperature") - AMBIENT;
            // The block is not quite uniform across.
            assert!(
                (found - exact).abs() < 5e-3 * 100.0,
                "level {level}, geometry {geometry}, {given} m2: {found} {exact}"
            );
            assert!(given > 0.0 || geometry == 1.0 || (found - 100.0).abs() < 1e-9, "{found}");
        }
    }
}

/// Bodies as warm as the faces that are held, in surroundings as warm: nothing flows, and every temperature stays.
#[test]
fn a_body_as_warm_as_its_held_face_has_that_mean_temperature() {
    for level in [2.0, 3.0] {
        let hot = AMBIENT + 350.0;
        let mut drive = Drive::stock(&[
            ("solver.fidelity", level),
            ("solver.cells", 9.0),
            ("punch.top_thermal", HELD),
            ("punch.top_at_ambient", 0.0),
            ("punch.top_temperature", hot),
            ("punch.initial_at_ambient", 0.0),
            ("punch.initial_temperature", hot),
            ("strip.base_thermal", HELD),
            ("strip.base_at_ambient", 0.0),
            ("strip.base_temperature", hot),
            ("strip.initial_at_ambient", 0.0),
            ("strip.initial_temperature", hot),
            ("punch.convection", 0.0),
            ("strip.convection", 0.0),
            ("strip.convection_forced", 0.0),
            ("strip.emissivity", 0.0),
            ("ambient_temperature", AMBIENT),
        ]);
        drive.set("normal_load", 1e3);
        for _ in 0..3 {
            for body in ["punch.mean_temperature", "strip.mean_temperature", "contact_temperature"] {
                let found = drive.get(body);
                assert!((found - hot).abs() < 1e-6 * 350.0, "level {level}: {body} {found}");
            }
            drive.step(100.0);
        }
    }
}
